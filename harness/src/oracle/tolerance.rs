//! Tolerances A01..A38: where the standard is silent or contradicts itself, what is judged and what is let pass.
//!
//! The table is data: `testcases/tolerances.yaml`. What it lets pass is held against what was proven ([`super::readings`]).

use super::readings::key;
use crate::problem::{Problem, Source};
use crate::tree::{self, Placed};
use crate::yaml;
use fsct_proof::Machine;
use std::collections::BTreeMap;
use std::fmt;
use std::ops::Range;
use std::sync::Arc;

/// What is done with a DUT that follows another reading than the default.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Stance {
    /// Let pass, and shown as a remark.
    Tolerated,
    /// Let pass, and shown as a finding with its consequence.
    Finding,
    /// No reading is the default; nothing to show.
    Open,
    /// Failed. `--tolerate` may change that.
    Refused,
    /// The other reading is recognised and leads to inconclusive.
    Recognised,
    /// Nothing to judge at run time: documentation.
    Settled,
}

impl Stance {
    const ALL: [(Stance, &'static str); 6] = [
        (Stance::Tolerated, "tolerated"),
        (Stance::Finding, "finding"),
        (Stance::Open, "open"),
        (Stance::Refused, "refused"),
        (Stance::Recognised, "recognised"),
        (Stance::Settled, "settled"),
    ];
}

impl fmt::Display for Stance {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(Stance::ALL.iter().find(|entry| entry.0 == *self).map_or("", |entry| entry.1))
    }
}

/// A set of tolerances: bit n for A-n.
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq, Hash)]
pub struct Mask(u64);

impl Mask {
    /// No tolerance.
    pub const NONE: Mask = Mask(0);

    /// Whether A-`number` is in the set.
    pub const fn has(self, number: u8) -> bool {
        self.0 >> number & 1 == 1
    }

    /// The set with A-`number`.
    #[must_use]
    pub const fn with(self, number: u8) -> Mask {
        Mask(self.0 | 1 << number)
    }

    /// The set without A-`number`.
    #[must_use]
    pub const fn without(self, number: u8) -> Mask {
        Mask(self.0 & !(1 << number))
    }

    /// Both sets together.
    #[must_use]
    pub const fn union(self, other: Mask) -> Mask {
        Mask(self.0 | other.0)
    }

    /// Number of tolerances in the set.
    pub const fn len(self) -> u32 {
        self.0.count_ones()
    }

    /// Whether the set is empty.
    pub const fn is_empty(self) -> bool {
        self.0 == 0
    }

    /// The numbers, ascending.
    pub fn iter(self) -> impl Iterator<Item = u8> {
        (0..64).filter(move |number| self.has(*number))
    }
}

/// One entry of the table.
#[derive(Clone, Debug)]
pub struct Tolerance {
    /// Its number: 19 for A19.
    pub number: u8,
    /// Short name.
    pub name: String,
    /// What is open, the default, and what else is let pass.
    pub text: String,
    /// What is done.
    pub stance: Stance,
    /// The readings of the SCL that are let pass or recognised, as `fsct prove --tolerances` calls them.
    pub readings: Vec<(Machine, Placed)>,
    /// Where it stands.
    pub at: Range<usize>,
}

/// The table.
#[derive(Clone, Debug)]
pub struct Tolerances(BTreeMap<u8, Tolerance>);

impl Tolerances {
    /// Reads the table.
    ///
    /// # Errors
    /// Every problem of the file.
    pub fn parse(source: &Arc<Source>) -> Result<Tolerances, Vec<Problem>> {
        let root = yaml::parse(source).map_err(|problem| vec![problem])?;
        let mut problems = Vec::new();
        let mut table = BTreeMap::new();
        for entry in tree::list(source, &root, "the list of tolerances", &mut problems) {
            let mut fields = tree::Fields::new(source, entry, "a tolerance", &mut problems);
            let id = fields.text("id");
            let name = fields.text("name");
            let text = fields.text("text");
            let stance = fields.word("stance", &Stance::ALL);
            let mut readings = Vec::new();
            for machine in Machine::ALL {
                readings.extend(fields.texts(key(machine)).into_iter().map(|placed| (machine, placed)));
            }
            fields.finish(&mut problems);
            let (Some((id, at)), Some((name, _)), Some((text, _)), Some(stance)) = (id, name, text, stance) else {
                continue;
            };
            match Tolerances::number(&id) {
                Some(number) => {
                    table.insert(number, Tolerance { number, name, text, stance, readings, at });
                }
                None => problems.push(Problem::new(source, at, format!("`{id}` is no tolerance, A01 to A38 are"))),
            }
        }
        if problems.is_empty() { Ok(Tolerances(table)) } else { Err(problems) }
    }

    /// The number of an id such as `A19`.
    pub fn number(id: &str) -> Option<u8> {
        let digits = id.strip_prefix('A').filter(|digits| digits.len() == 2)?;
        digits.parse().ok().filter(|number| (1..=38).contains(number))
    }

    /// The entry of a number.
    pub fn get(&self, number: u8) -> Option<&Tolerance> {
        self.0.get(&number)
    }

    /// All entries, ascending.
    pub fn iter(&self) -> impl Iterator<Item = &Tolerance> {
        self.0.values()
    }

    /// Those in force unless the user says otherwise.
    pub fn in_force(&self) -> Mask {
        self.0
            .values()
            .filter(|entry| matches!(entry.stance, Stance::Tolerated | Stance::Finding | Stance::Open))
            .fold(Mask::NONE, |mask, entry| mask.with(entry.number))
    }

    /// Those whose use is shown as a remark.
    pub fn shown(&self) -> Mask {
        self.0
            .values()
            .filter(|entry| !matches!(entry.stance, Stance::Open))
            .fold(Mask::NONE, |mask, entry| mask.with(entry.number))
    }
}
