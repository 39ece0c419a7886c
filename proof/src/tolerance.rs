//! Which readings a product may follow: those with which P1 to P5 hold against every partner that may be met.
//!
//! A partner that may be met is the default, and whatever else is found here. The readings that fail against the default go first.
//! What is left is asked as a mixture, in which either machine follows any of its readings or none, anew in each exchange: every
//! pair and every combination of readings is among its ways, so what holds for it holds for each of them. Only where it does not
//! are the pairs asked one by one; of two that fail together the one that fails with more partners goes, both if neither does.

use crate::cores::on_all_cores;
use crate::exchange::World;
use crate::model::{Model, Timing};
use crate::property::{PROPERTIES, Property};
use crate::reading::{Machine, Reading};
use crate::{Verdict, asked};
use core::fmt;
use fsct_protocol::Edition;

/// One machine read one way; `None`: as the tables are read by default.
type Way = Option<Reading>;

/// What a composition was found to do.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Failing {
    /// In which timing.
    pub timing: Timing,
    /// The first property that does not hold.
    pub property: &'static str,
    /// Exchanges to see it.
    pub exchanges: usize,
}

/// Why a reading is refused.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Refused {
    /// What the partner follows; `None`: the default.
    pub partner: Option<Reading>,
    /// What fails, at most once a timing.
    pub failing: Vec<Failing>,
}

impl fmt::Display for Refused {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (at, Failing { timing, property, exchanges }) in self.failing.iter().enumerate() {
            let comma = if at == 0 { "" } else { ", " };
            write!(f, "{comma}{property} after {exchanges} exchanges in timing {timing}")?;
        }
        match self.partner {
            Some(partner) => write!(f, " against {partner}"),
            None => write!(f, " against the default"),
        }
    }
}

/// A reading of a machine, and what was found about it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Judged {
    /// The machine that follows it.
    pub machine: Machine,
    /// The reading.
    pub reading: Reading,
    /// Why no product may follow it; `None`: one may.
    pub refused: Option<Refused>,
}

/// All that was found.
#[derive(Clone, Debug)]
pub struct Tolerances {
    /// Every reading of either machine, in order.
    pub judged: Vec<Judged>,
    /// Compositions that were asked, both timings counted.
    pub compositions: usize,
    /// What fails in a mixture of the readings that may be followed; empty: nothing.
    pub mixed: Vec<Failing>,
}

impl Tolerances {
    /// The readings of a machine that a product may follow.
    pub fn of(&self, machine: Machine) -> Vec<Reading> {
        let may = |judged: &&Judged| judged.machine == machine && judged.refused.is_none();
        self.judged.iter().filter(may).map(|judged| judged.reading).collect()
    }

    fn ask_mixtures(&mut self, watchdog: u8) -> Result<(), String> {
        let may = Machine::ALL.map(|machine| self.of(machine));
        let both = [Timing::Pipelined, Timing::Immediate].into_iter();
        let mixtures: Vec<Model> = both.flat_map(|timing| mixtures([&may[0], &may[1]], watchdog, timing)).collect();
        self.compositions += mixtures.len();
        self.mixed = failing_each(&mixtures)?.into_iter().flatten().collect();
        Ok(())
    }
}

/// The properties asked of a product: P1 to P5, but for what the tables themselves allow.
pub fn demanded(model: &Model) -> Vec<&'static Property> {
    let asked = |property: &&Property| {
        let among = ["P1", "P2", "P3", "P4", "P5"].iter().any(|name| property.name.starts_with(name));
        // FSP_Watchdog has to be longer than an SCL cycle (11.5.5): where it is not, operation is not to be expected.
        let runs = model.watchdog > model.scl_cycle() || property.name != "P5";
        among && property.tables.is_none() && runs && property.not_asked(model).is_none()
    };
    PROPERTIES.iter().filter(asked).collect()
}

/// Finds out which readings a product may follow, with a watchdog of so many exchanges.
///
/// # Errors
/// As [`Model::check`], and when a search has more states than [`Model::MOST_STATES`].
pub fn tolerances(watchdog: u8) -> Result<Tolerances, String> {
    let mut judged: Vec<Judged> = Machine::ALL
        .into_iter()
        .flat_map(|machine| Reading::ALL.into_iter().map(move |reading| (machine, reading)))
        .filter(|(machine, reading)| reading.concerns(*machine))
        .map(|(machine, reading)| Judged { machine, reading, refused: None })
        .collect();
    let pairs: Vec<[Way; 2]> = judged.iter().map(|judged| alone(judged.machine, judged.reading)).collect();
    let found = ask(&pairs, watchdog)?;
    for (judged, failing) in judged.iter_mut().zip(found) {
        judged.refused = (!failing.is_empty()).then_some(Refused { partner: None, failing });
    }
    let mut tolerances = Tolerances { judged, compositions: 2 * pairs.len(), mixed: Vec::new() };
    tolerances.ask_mixtures(watchdog)?;
    if !tolerances.mixed.is_empty() {
        let pairs = cross(&tolerances);
        refuse_pairs(&mut tolerances.judged, &pairs, ask(&pairs, watchdog)?);
        tolerances.compositions += 2 * pairs.len();
        tolerances.ask_mixtures(watchdog)?;
    }
    Ok(tolerances)
}

fn alone(machine: Machine, reading: Reading) -> [Way; 2] {
    match machine {
        Machine::Master => [Some(reading), None],
        Machine::Device => [None, Some(reading)],
    }
}

/// Every reading of an FS-Master that is left with every one of an FS-Device.
fn cross(tolerances: &Tolerances) -> Vec<[Way; 2]> {
    let devices = tolerances.of(Machine::Device);
    let masters = tolerances.of(Machine::Master).into_iter();
    masters.flat_map(|master| devices.iter().map(move |device| [Some(master), Some(*device)])).collect()
}

/// What each pair fails in, both timings.
fn ask(pairs: &[[Way; 2]], watchdog: u8) -> Result<Vec<Vec<Failing>>, String> {
    let both = |pair: &[Way; 2]| {
        let models = [Timing::Pipelined, Timing::Immediate].map(|timing| read(*pair, watchdog, timing));
        models.iter().filter_map(|model| failing(model).transpose()).collect::<Result<Vec<_>, String>>()
    };
    on_all_cores(pairs, || (), |(), pair| both(pair))?.into_iter().collect()
}

/// An FS-Master read one way with an FS-Device read one way; `None`: as by default.
pub fn read([master, device]: [Option<Reading>; 2], watchdog: u8, timing: Timing) -> Model {
    // v1.1 alone leaves A31 open; no other property tells the editions apart.
    let edition = if device == Some(Reading::FirstOne) { Edition::V1_1 } else { Edition::Iec2022 };
    Model {
        master_readings: master.into_iter().collect(),
        device_readings: device.into_iter().collect(),
        watchdog,
        timing,
        ..Model::new(edition)
    }
}

/// The first property that does not hold.
///
/// # Errors
/// As [`tolerances`].
pub fn failing(model: &Model) -> Result<Option<Failing>, String> {
    model.check()?;
    let mut world = World::lean(model);
    for property in demanded(model) {
        let exchanges = match asked(&mut world, property).verdict {
            Verdict::Holds => continue,
            Verdict::Violated(lines) | Verdict::Tables(lines) | Verdict::LockUp(lines, _) => lines.len(),
            Verdict::Unknown => return Err(format!("{} has more states than are kept", property.name)),
        };
        return Ok(Some(Failing { timing: model.timing, property: property.name, exchanges }));
    }
    Ok(None)
}

/// As [`failing`], for many models on all cores, in their order.
///
/// # Errors
/// As [`tolerances`].
pub fn failing_each(models: &[Model]) -> Result<Vec<Option<Failing>>, String> {
    on_all_cores(models, || (), |(), model| failing(model))?.into_iter().collect()
}

/// Takes readings away until no two of those left fail together.
fn refuse_pairs(judged: &mut [Judged], pairs: &[[Way; 2]], found: Vec<Vec<Failing>>) {
    let mut failing: Vec<_> = pairs.iter().zip(found).filter(|(_, failing)| !failing.is_empty()).collect();
    while !failing.is_empty() {
        let partners = |machine: Machine, reading: Reading| {
            failing.iter().filter(|(pair, _)| pair[machine as usize] == Some(reading)).count()
        };
        let most = judged.iter().map(|judged| partners(judged.machine, judged.reading)).max();
        let worst: Vec<usize> =
            (0..judged.len()).filter(|at| Some(partners(judged[*at].machine, judged[*at].reading)) == most).collect();
        for at in &worst {
            let Judged { machine, reading, .. } = judged[*at];
            let first = failing.iter().find(|(pair, _)| pair[machine as usize] == Some(reading));
            let partner = |pair: &[Way; 2]| pair[1 - machine as usize];
            judged[*at].refused =
                first.map(|(pair, failing)| Refused { partner: partner(pair), failing: failing.clone() });
        }
        let gone = |machine: Machine, way: Way| {
            worst.iter().any(|at| judged[*at].machine == machine && Some(judged[*at].reading) == way)
        };
        failing.retain(|([master, device], _)| !gone(Machine::Master, *master) && !gone(Machine::Device, *device));
    }
}

/// By default either may win, so a mixture has both without them.
const ORDER: [Reading; 2] = [Reading::TimerFirst, Reading::ReceptionFirst];

/// Mixtures of the readings an FS-Master may follow and of those an FS-Device may: with what says what is remembered, and without.
pub fn mixtures(may: [&[Reading]; 2], watchdog: u8, timing: Timing) -> Vec<Model> {
    let mixture = |kept: bool| {
        let [master_readings, device_readings] = may.map(|readings| -> Vec<Reading> {
            let readings = readings.iter().filter(|reading| !ORDER.contains(reading));
            readings.filter(|reading| kept || !reading.is_kept()).copied().collect()
        });
        Model { master_readings, device_readings, mixed: true, watchdog, timing, ..Model::new(Edition::Iec2022) }
    };
    let mut models = vec![mixture(false), mixture(true)];
    models.dedup();
    models
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of two readings that fail together the one with more partners against it goes, and the other may stay.
    #[test]
    fn a_reading_that_fails_with_more_partners_goes() {
        let judged = |machine, reading| Judged { machine, reading, refused: None };
        let (zero, old) = (Reading::ZeroJudged, Reading::OldJudged);
        let all = [(Machine::Master, zero), (Machine::Master, old), (Machine::Device, zero), (Machine::Device, old)];
        let failing = |fails: bool| -> Vec<Failing> {
            let failing = Failing { timing: Timing::Immediate, property: "P4", exchanges: 7 };
            if fails { vec![failing] } else { Vec::new() }
        };
        let pairs =
            [[Some(zero), Some(zero)], [Some(zero), Some(old)], [Some(old), Some(zero)], [Some(old), Some(old)]];
        let refused = |fails: [bool; 4]| {
            let mut found = all.map(|(machine, reading)| judged(machine, reading));
            refuse_pairs(&mut found, &pairs, fails.map(failing).to_vec());
            found.map(|judged| judged.refused.map(|refused| refused.to_string()))
        };
        let why = |partner: Reading| Some(format!("P4 after 7 exchanges in timing I against {partner}"));
        assert_eq!(refused([true, true, false, false]), [why(zero), None, None, None]);
        assert_eq!(refused([false, true, false, false]), [why(old), None, None, why(zero)]);
        assert_eq!(refused([false; 4]), [None, None, None, None]);
    }
}
