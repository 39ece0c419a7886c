//! What `fsct prove` found as cases: the tester plays the partner and the channel of a chart, and the DUT has to do what the
//! tables ask for when they are read by default.
//!
//! A case says what comes in which order. How many exchanges lie between two happenings is the matter of the chart alone: on a DUT
//! an expiry is waited for, whatever its FSP_Watchdog.

mod device;
mod drawn;
mod master;

use crate::coverage::Coverage;
use crate::oracle::Tolerances;
use crate::tours::emit::{Told, covered, list, requirements, step};
use fsct_adapters::Role;
use fsct_proof::{Line, Machine, Model, Outcome, PROPERTIES, Property, Reading, Turn, Verdict, replay};
use fsct_protocol::scl::T;
use fsct_reports::{Ladder, ladders};
use std::collections::BTreeMap;
use std::fmt::Write as _;

/// Name of the suite.
const SUITE: &str = "proof";

/// A chart that is worth a case.
struct Chart<'o> {
    model: &'o Model,
    outcome: &'o Outcome,
    /// The way there; of a lock-up without what repeats.
    lines: &'o [Line],
}

impl<'o> Chart<'o> {
    fn of(model: &'o Model, outcome: &'o Outcome) -> Option<Chart<'o>> {
        let lines = match &outcome.verdict {
            Verdict::Violated(lines) | Verdict::Tables(lines) => lines.as_slice(),
            Verdict::LockUp(lines, repeats) => lines.get(..lines.len().saturating_sub(*repeats))?,
            Verdict::Holds | Verdict::Unknown => return None,
        };
        Some(Chart { model, outcome, lines })
    }

    /// Whose doing it is: that of a reading that departs from the default, or what the property is about.
    fn sides(&self) -> &'static [Role] {
        let tables = matches!(self.outcome.verdict, Verdict::Tables(_)) || self.model.readings.is_empty();
        let concerned = |machine| match tables {
            true => self.outcome.property.machines.contains(&machine),
            false => self.model.readings.iter().any(|reading| reading.concerns(machine)),
        };
        let sides = [Machine::Device, Machine::Master].map(concerned);
        match sides {
            [true, true] => &[Role::Device, Role::Master],
            [_, true] => &[Role::Master],
            _ => &[Role::Device],
        }
    }

    fn locks_up(&self) -> bool {
        matches!(self.outcome.verdict, Verdict::LockUp(..))
    }

    /// The readings by their names.
    fn readings(&self) -> String {
        let Model { readings, master_readings, device_readings, .. } = self.model;
        let all = readings.iter().chain(master_readings).chain(device_readings);
        all.map(|reading| reading.name()).collect::<Vec<_>>().join(", ")
    }

    /// Two digits for the reading, two for the property; the first of several readings counts.
    fn number(&self) -> usize {
        let is = |known: &Property| known.name == self.outcome.property.name;
        let property = PROPERTIES.iter().position(is).unwrap_or(0) + 1;
        let Some(reading) = self.model.readings.first() else { return property };
        let number = numbers(*reading).next().unwrap_or(0);
        let alike = |other: &&Reading| numbers(**other).next() == Some(number);
        let which = Reading::ALL.iter().filter(alike).position(|other| other == reading).unwrap_or(0);
        100 * usize::from(number) + 20 * which + property
    }

    fn title(&self) -> String {
        let name = self.outcome.property.name;
        match &self.outcome.verdict {
            Verdict::Tables(_) => format!("Where the tables go beyond {name}; no DUT is failed for that"),
            Verdict::LockUp(..) => format!("Where {} locks up ({name})", self.readings()),
            _ => format!("Where {} breaks {name}", self.readings()),
        }
    }

    /// Tolerances by which the very thing that must not happen would be let pass. A lock-up shows in that nothing comes back.
    fn strict(&self) -> Vec<String> {
        let broken = matches!(self.outcome.verdict, Verdict::Violated(_));
        let of_order = |reading: &&Reading| matches!(reading, Reading::TimerFirst | Reading::ReceptionFirst);
        let readings = self.model.readings.iter().filter(|reading| broken && !of_order(reading));
        readings.flat_map(|reading| numbers(*reading)).map(|number| format!("A{number:02}")).collect()
    }
}

/// The tolerances that a reading is about: 8 and 16 for `A08+A16=last-valid`.
fn numbers(reading: Reading) -> impl Iterator<Item = u8> {
    let ids = reading.name().split('=').next().unwrap_or_default();
    ids.split('+').filter_map(Tolerances::number)
}

/// The requirement that a case about a property judges beside those of its transitions.
fn requirement(property: &str, role: Role) -> Option<&'static str> {
    match (property, role) {
        ("P5", Role::Device) => Some("R-11.5.3-22"),
        ("P5", Role::Master) => Some("R-11.5.2-26"),
        ("P2d" | "P6-comm" | "P6-further", Role::Device) => Some("R-11.5.3-23"),
        ("P2", Role::Master) => Some("R-11.5.2-28"),
        _ => None,
    }
}

/// The charts of these outcomes as a suite; `None` when there is none. `command` is how it was made.
pub fn emit(outcomes: &[(&Model, &Outcome)], coverage: &BTreeMap<String, Coverage>, command: &str) -> Option<String> {
    let charts: Vec<Chart<'_>> = outcomes.iter().filter_map(|(model, outcome)| Chart::of(model, outcome)).collect();
    let mut cases = Vec::new();
    for chart in &charts {
        for role in chart.sides() {
            let coverage = coverage.get(&role.to_string())?;
            cases.push(case(chart, *role, coverage));
        }
    }
    let about = "Shortest ways to what a reading of the tables breaks, and to what the tables allow";
    let head = format!("# Made by `{command}`. Not to be changed by hand.\nsuite: {SUITE}\nabout: {about}\ncases:\n");
    (!cases.is_empty()).then(|| head + &cases.join("\n"))
}

/// The charts of these outcomes as a drawing, each with what was explored; `None` when there is none.
pub fn draw(outcomes: &[(&Model, &Outcome)], explored: impl Fn(&Model) -> String) -> Option<String> {
    let charts = outcomes.iter().filter_map(|(model, outcome)| Chart::of(model, outcome));
    let drawn: Vec<Ladder> = charts.map(|chart| drawn::ladder(&chart, &explored(chart.model))).collect();
    (!drawn.is_empty()).then(|| ladders(&drawn))
}

fn case(chart: &Chart<'_>, role: Role, coverage: &Coverage) -> String {
    let Chart { model, outcome, lines } = chart;
    let turns = replay(model, lines, !chart.locks_up());
    let (prefix, opening) = match role {
        Role::Device => ("PRD", [T(20)].as_slice()),
        Role::Master => ("PRM", [T(1), T(2)].as_slice()),
    };
    let steps = steps(&turns, role, chart.locks_up());
    let taken = covered(opening, &steps);
    let mut requirements = requirements(coverage, &taken);
    requirements.splice(0..0, requirement(outcome.property.name, role));
    let mut text = format!("  - id: {prefix}-{:04}\n    title: {}\n", chart.number(), chart.title());
    let about = outcome.property.about;
    let Model { edition, watchdog, timing, .. } = model;
    let _ =
        writeln!(text, "    about: \"{about}; {} exchanges, watchdog of {watchdog}, timing {timing}\"", lines.len());
    list(&mut text, "    requirements: ", &requirements);
    let _ = writeln!(text, "    dut: {role}\n    sweep: {{edition: [{edition}]}}");
    let strict = chart.strict();
    if !strict.is_empty() {
        let strict: Vec<&str> = strict.iter().map(String::as_str).collect();
        list(&mut text, "    strict: ", &strict);
    }
    let _ = writeln!(text, "    start: waiting\n    steps:");
    steps.iter().for_each(|told| step(&mut text, coverage, told));
    let covers: Vec<String> = taken.iter().map(T::to_string).collect();
    list(&mut text, "    covers: ", &covers.iter().map(String::as_str).collect::<Vec<_>>());
    text
}

fn steps(turns: &[Turn], role: Role, locks_up: bool) -> Vec<Told> {
    let mut steps = match role {
        Role::Device => device::steps(turns),
        Role::Master => master::steps(turns),
    };
    if locks_up {
        let from = if role == Role::Device { "next" } else { "regular" };
        steps.push(told(format!("partner: {{from: {from}}}"), Vec::new()));
    }
    steps
}

/// A step that no transition is told of.
fn told(action: String, expect: Vec<String>) -> Told {
    Told { before: Vec::new(), action, expect, path: Default::default(), error: false }
}
