//! Which readings of the SCL a product may follow: what `fsct prove --tolerances` has found, as data.
//!
//! The table is `testcases/readings.yaml`. It is what [`Tolerances`] are held against: nothing that was refused there is let pass.

use super::tolerance::{Stance, Tolerance, Tolerances};
use crate::problem::{Problem, Source};
use crate::tree;
use crate::yaml;
use fsct_proof::{Machine, Reading};
use std::sync::Arc;

/// P1 to P5 hold against every partner that may be met.
pub const HOLDS: &str = "holds";
/// They do not.
pub const REFUSED: &str = "refused";

/// A reading and what was found about it.
#[derive(Clone, Debug)]
pub struct Row {
    /// The machine that follows it.
    pub machine: Machine,
    /// The reading.
    pub reading: Reading,
    /// Why no product may follow it; `None`: one may.
    pub refused: Option<String>,
}

/// The table.
#[derive(Clone, Debug)]
pub struct Readings(Vec<Row>);

impl Readings {
    /// Reads the table.
    ///
    /// # Errors
    /// Every problem of the file.
    pub fn parse(source: &Arc<Source>) -> Result<Readings, Vec<Problem>> {
        let root = yaml::parse(source).map_err(|problem| vec![problem])?;
        let mut problems = Vec::new();
        let mut rows = Vec::new();
        for entry in tree::list(source, &root, "the list of readings", &mut problems) {
            let mut fields = tree::Fields::new(source, entry, "a reading", &mut problems);
            let machine = fields.word("machine", &Machine::ALL.map(|machine| (machine, name(machine))));
            let reading = fields.text("reading");
            let verdict = fields.word("verdict", &[(true, HOLDS), (false, REFUSED)]);
            let why = fields.optional("why");
            let reading = reading.and_then(|(text, at)| match text.parse::<Reading>() {
                Ok(reading) => Some(reading),
                Err(sentence) => {
                    fields.problem(at, sentence);
                    None
                }
            });
            fields.finish(&mut problems);
            let (Some(machine), Some(reading), Some(holds)) = (machine, reading, verdict) else { continue };
            let refused = (!holds).then(|| why.map(|(why, _)| why).unwrap_or_default());
            rows.push(Row { machine, reading, refused });
        }
        if problems.is_empty() { Ok(Readings(rows)) } else { Err(problems) }
    }

    /// The readings of a tolerance.
    pub fn of(&self, number: u8) -> impl Iterator<Item = &Row> {
        let id = format!("A{number:02}");
        self.0.iter().filter(move |row| about(row.reading, &id))
    }

    /// All rows.
    pub fn iter(&self) -> impl Iterator<Item = &Row> {
        self.0.iter()
    }

    /// The readings of a machine that a product may follow.
    pub fn of_product(&self, machine: Machine) -> Vec<Reading> {
        let may = |row: &&Row| row.machine == machine && row.refused.is_none();
        self.0.iter().filter(may).map(|row| row.reading).collect()
    }

    /// Holds the tolerances against the table. What comes back are the problems: a tolerance that lets a refused reading pass, names
    /// one that is not its own, or names none where there are some.
    pub fn check(&self, source: &Arc<Source>, tolerances: &Tolerances) -> Vec<Problem> {
        tolerances.iter().flat_map(|tolerance| self.check_one(source, tolerance)).collect()
    }

    fn check_one(&self, source: &Arc<Source>, tolerance: &Tolerance) -> Vec<Problem> {
        let Tolerance { number, stance, readings, at, .. } = tolerance;
        let id = format!("A{number:02}");
        let lets_pass = matches!(stance, Stance::Tolerated | Stance::Open | Stance::Finding);
        let mut problems = Vec::new();
        if lets_pass && readings.is_empty() && self.of(*number).next().is_some() {
            let known: Vec<_> = self.of(*number).map(|row| format!("{}: {}", key(row.machine), row.reading)).collect();
            let message =
                format!("{id} is {stance} and does not say which of its readings is let pass: {}", known.join(", "));
            problems.push(Problem::new(source, at.clone(), message));
        }
        for (machine, (text, at)) in readings {
            let row = self.of(*number).find(|row| row.machine == *machine && row.reading.name() == text);
            let message = match row.map(|row| &row.refused) {
                None => format!("`{text}` is no reading of {id} for an {machine}; see `fsct prove --tolerances`"),
                Some(Some(why)) if matches!(stance, Stance::Tolerated | Stance::Open) => {
                    format!(
                        "{text} cannot be {stance}, no product may follow it: {why}; `finding` and `refused` remain"
                    )
                }
                Some(_) => continue,
            };
            problems.push(Problem::new(source, at.clone(), message));
        }
        problems
    }
}

/// `A08+A16=last-valid` is about A08 and A16.
fn about(reading: Reading, id: &str) -> bool {
    reading.name().split('=').next().is_some_and(|ids| ids.split('+').any(|one| one == id))
}

fn name(machine: Machine) -> &'static str {
    match machine {
        Machine::Master => "FS-Master",
        Machine::Device => "FS-Device",
    }
}

/// The key in a tolerance under which its readings stand.
pub(super) const fn key(machine: Machine) -> &'static str {
    match machine {
        Machine::Master => "master",
        Machine::Device => "device",
    }
}
