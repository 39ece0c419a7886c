//! Tours as a file of cases.

use super::{device, master};
use crate::coverage::Coverage;
use crate::walk::Graph;
use fsct_adapters::Role;
use fsct_protocol::scl::{Path, T};
use std::fmt::Write as _;

/// Columns of a line.
const WIDTH: usize = 140;

/// A step of a tour, as it stands in a case.
pub struct Told {
    /// Steps before it that only set something.
    pub before: Vec<String>,
    /// What is done.
    pub action: String,
    /// What is expected.
    pub expect: Vec<String>,
    /// The transitions it leads to.
    pub path: Path,
    /// Whether the SPDU was in error.
    pub error: bool,
}

/// A wait until the timer has expired this many times.
pub fn wait(expiries: usize, link: &str) -> String {
    let until = match expiries {
        1 => "FSP_Watchdog + margin".to_owned(),
        more => format!("{more} FSP_Watchdog + {more} margin"),
    };
    format!("wait: {{until: {until}, link: {link}}}")
}

/// The suite of tours for a role, as `testcases/suites` holds it.
pub fn emit(coverage: &Coverage) -> String {
    let (tours, prefix, table, opening) = match coverage.role {
        Role::Device => (device::tours(), "FSD", 40, "20"),
        Role::Master => (master::tours(), "FSM", 38, "1 2"),
    };
    let opening: Vec<T> = opening.split(' ').filter_map(|number| number.parse().ok().map(T)).collect();
    let role = coverage.role;
    let mut text = format!(
        "# Made by `fsct tours {role}` from the rows of the machine; a test compares. Not to be changed by hand.\n\
         suite: {role}-tours\n\
         group: scl-{role}\n\
         about: Tours through Table {table} that together take everything of testcases/coverage/{role}.yaml\n\
         cases:\n"
    );
    for (number, tour) in (1..).zip(&tours) {
        let taken = covered(&opening, tour);
        let covers: Vec<String> = taken.iter().map(T::to_string).collect();
        let mut case = format!(
            "  - id: {prefix}-{}\n    title: Tour {number} through Table {table}, {} steps from power-on\n",
            1600 + number,
            tour.len()
        );
        list(&mut case, "    requirements: ", &requirements(coverage, &taken));
        let _ = write!(case, "    dut: {role}\n    start: waiting\n    steps:\n");
        for told in tour {
            step(&mut case, coverage, told);
        }
        let covers: Vec<&str> = covers.iter().map(String::as_str).collect();
        list(&mut case, "    covers: ", &covers);
        if number > 1 {
            text.push('\n');
        }
        text += &case;
    }
    text
}

/// What is taken, in order: this and then the steps.
pub fn covered(opening: &[T], steps: &[Told]) -> Vec<T> {
    let mut covers = opening.to_vec();
    for t in steps.iter().flat_map(|told| told.path.iter()) {
        if !covers.contains(&t) {
            covers.push(t);
        }
    }
    covers.sort();
    covers
}

/// The requirements that taking these judges.
pub fn requirements<'c>(coverage: &'c Coverage, taken: &[T]) -> Vec<&'c str> {
    let mut requirements: Vec<&str> = Vec::new();
    for id in taken.iter().filter_map(|t| coverage.requirements.get(t)) {
        if !requirements.contains(&id.as_str()) {
            requirements.push(id);
        }
    }
    requirements
}

/// A step with its name, where it takes transitions.
pub fn step(text: &mut String, coverage: &Coverage, told: &Told) {
    for step in &told.before {
        let _ = writeln!(text, "      - {step}");
    }
    let _ = writeln!(text, "      - {}", told.action);
    let step = Graph::role(coverage.role).step(told.path, told.error);
    if let Some(name) = step.and_then(|place| coverage.steps.get(usize::from(place))) {
        let _ = writeln!(text, "        note: {name}");
    }
    if !told.expect.is_empty() {
        let _ = writeln!(text, "        expect: {{{}}}", told.expect.join(", "));
    }
}

/// A list on as many lines as it needs.
pub fn list(text: &mut String, key: &str, items: &[&str]) {
    let mut line = format!("{key}[");
    let indent = " ".repeat(key.len() - key.trim_start().len() + 2);
    for (place, item) in items.iter().enumerate() {
        let end = if place + 1 < items.len() { "," } else { "]" };
        if line.len() + item.len() + 2 > WIDTH {
            let _ = writeln!(text, "{}", line.trim_end());
            line = indent.clone();
        }
        let _ = write!(line, "{item}{end} ");
    }
    let _ = writeln!(text, "{}", line.trim_end());
}
