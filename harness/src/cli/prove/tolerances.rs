//! `fsct prove --tolerances`: which readings a product may follow, computed.

use super::VIOLATED;
use crate::cli::{USAGE, fail, print};
use crate::oracle::readings::{HOLDS, REFUSED};
use fsct_proof::{Failing, Judged, Machine, Tolerances, tolerances};
use serde_json::{Value, json};

/// How the findings are shown.
#[derive(Copy, Clone, Debug)]
pub enum Form {
    /// For a reader.
    Text,
    /// One document for a program.
    Json,
    /// As `testcases/readings.yaml` holds them.
    Yaml,
}

/// Runs the command; the result is the exit code: 0 even where readings are refused, for that is what is asked.
pub fn run(watchdog: u8, form: Form) -> u8 {
    let found = match tolerances(watchdog) {
        Ok(found) => found,
        Err(sentence) => return fail(USAGE, sentence),
    };
    match form {
        Form::Text => text(&found, watchdog),
        Form::Json => print(document(&found, watchdog)),
        Form::Yaml => yaml(&found, watchdog),
    }
    if found.mixed.is_empty() { 0 } else { VIOLATED }
}

fn word(judged: &Judged) -> &'static str {
    if judged.refused.is_none() { HOLDS } else { REFUSED }
}

fn why(judged: &Judged) -> String {
    judged.refused.as_ref().map(ToString::to_string).unwrap_or_default()
}

fn text(found: &Tolerances, watchdog: u8) {
    let Tolerances { judged, compositions, mixed } = found;
    print(format!("P1 to P5, FSP_Watchdog of {watchdog} exchanges, timings P and I: {compositions} compositions\n"));
    for one in judged {
        let row = format!("{:<9}  {:<27}  {:<7}  {}", one.machine, one.reading, word(one), why(one));
        print(row.trim_end());
    }
    print("");
    let verdict = if mixed.is_empty() { "P1 to P5 hold".to_owned() } else { failings(mixed) };
    print(format!("Any combination of those that hold, on both sides, changed in each exchange: {verdict}."));
}

fn failings(mixed: &[Failing]) -> String {
    let one = |Failing { timing, property, exchanges }: &Failing| {
        format!("{property} fails after {exchanges} exchanges in timing {timing}")
    };
    mixed.iter().map(one).collect::<Vec<_>>().join(", ")
}

fn document(found: &Tolerances, watchdog: u8) -> Value {
    let failing = |Failing { timing, property, exchanges }: &Failing| json!({"timing": timing.to_string(), "property": property, "exchanges": exchanges});
    let failings = |all: &[Failing]| all.iter().map(failing).collect::<Vec<_>>();
    let one = |judged: &Judged| {
        let partner =
            judged.refused.as_ref().map(|refused| refused.partner.map_or("default", |reading| reading.name()));
        let failing = judged.refused.as_ref().map(|refused| failings(&refused.failing)).unwrap_or_default();
        json!({
            "machine": judged.machine.to_string(), "reading": judged.reading.name(), "verdict": word(judged),
            "partner": partner, "failing": failing,
        })
    };
    json!({
        "watchdog": watchdog,
        "timings": ["P", "I"],
        "compositions": found.compositions,
        "readings": found.judged.iter().map(one).collect::<Vec<_>>(),
        "combinations": {"verdict": if found.mixed.is_empty() { HOLDS } else { REFUSED }, "failing": failings(&found.mixed)},
    })
}

fn yaml(found: &Tolerances, watchdog: u8) {
    print(
        "# Which readings of the SCL a product may follow: those with which P1 to P5 hold against every partner that may be met.",
    );
    print(format!(
        "# Found with a watchdog of {watchdog} exchanges in both timings (docs/proof.md); made by `fsct prove --tolerances --yaml`, and a test"
    ));
    print(
        "# compares. testcases/tolerances.yaml says which of them the oracle lets pass; none that is refused here can be.",
    );
    for machine in Machine::ALL {
        for one in found.judged.iter().filter(|one| one.machine == machine) {
            let why = if one.refused.is_some() { format!(", why: {:?}", why(one)) } else { String::new() };
            print(format!("- {{machine: {machine}, reading: {}, verdict: {}{why}}}", one.reading, word(one)));
        }
    }
}
