//! What DUTs took in a row: counted, missing named, and what cannot be told loudly.

use crate::common::*;
use fsct_reports::record::*;
use fsct_reports::{Run, Summary, render};

fn goals() -> MachineInfo {
    let texts = |texts: &[&str]| texts.iter().map(|text| (*text).to_owned()).collect();
    MachineInfo {
        role: "device".into(),
        steps: vec![("D-GOOD".into(), "T24 T22 T23".into())],
        pairs: Goal { feasible: texts(&["T24 T22", "T22 T23"]), infeasible: Vec::new() },
        triples: Goal { feasible: texts(&["T24 T22 T23"]), infeasible: Vec::new() },
        step_pairs: Goal {
            feasible: texts(&["D-GOOD D-GOOD", "D-GOOD D-ERR"]),
            infeasible: vec![("D-ERR D-LEAVE".into(), "SDcycles is 3".into())],
        },
        conditions: vec![condition("D22-PORTNUM", "T22 T25"), condition("DTIMER-21", "-")],
        guards: Goal { feasible: texts(&["D22-PORTNUM true", "D22-PORTNUM false"]), infeasible: Vec::new() },
        timers: Goal { feasible: Vec::new(), infeasible: vec![("DTIMER-21 expired".into(), "it does not run".into())] },
    }
}

fn condition(id: &str, rows: &str) -> ConditionInfo {
    ConditionInfo {
        id: id.into(),
        state: "22".into(),
        rows: rows.into(),
        asks: "PortNum".into(),
        clause: "11.5.3".into(),
    }
}

fn walked(step_pairs: &[&str]) -> Run {
    let mut case = passed(1);
    case.walked.pairs = vec!["T24 T22".into()];
    case.walked.step_pairs = step_pairs.iter().map(|name| (*name).to_owned()).collect();
    let mut run = run(vec![case, passed(2)]);
    run.header.machines = vec![goals()];
    run
}

fn page(name: &str, run: &Run) -> String {
    let folder = Folder::with(name, run);
    render(&folder.0).expect("the record is sound");
    folder.text("report.html")
}

#[test]
fn what_was_taken_is_counted_and_the_rest_is_named() {
    let run = walked(&["D-GOOD D-GOOD"]);
    let summary = Summary::of(&run);
    let [device] = summary.coverage.as_slice() else { panic!("one machine has goals") };
    assert_eq!((device.pairs.said(), device.step_pairs.said()), ("1 of 2".into(), "1 of 2".into()));
    assert_eq!(
        (device.pairs.missing.clone(), device.step_pairs.missing.clone()),
        (vec!["T22 T23".into()], vec!["D-GOOD D-ERR".into()])
    );
    assert_eq!(device.step_pairs.cases["D-GOOD D-GOOD"], 1);
    let html = page("walked", &run);
    assert!(html.contains("1 of 2 step pairs were taken; never: <code>D-GOOD D-ERR</code>"));
    assert!(html.contains("D-GOOD = T24 T22 T23") && !html.contains("although it cannot be"));
}

#[test]
fn a_condition_that_went_one_way_only_is_named_with_the_nearest_case() {
    let mut run = walked(&[]);
    let Some(case) = run.cases.first_mut() else { panic!("there is a case") };
    case.walked.guards = vec!["D22-PORTNUM true".into()];
    case.walked.timers = vec!["DTIMER-21 expired".into()];
    let key = case.key.clone();
    let summary = Summary::of(&run);
    let asked = summary.coverage[0].asked.as_ref().expect("there are goals");
    assert_eq!(asked.said(), "guards 0 of 1 both ways, timers 0 of 0");
    assert_eq!(asked.guards.missing, ["D22-PORTNUM false"]);
    assert_eq!(asked.nearest["D22-PORTNUM false"], key);
    assert_eq!(asked.timers.contradicting["DTIMER-21 expired"], "infeasible: it does not run");
    let html = page("asked", &run);
    let at = html.find("<details open><summary>Guards and timers").expect("the table stands open");
    let table = &html[at..at + html[at..].find("</details>").expect("it ends")];
    assert!(table.contains("never") && table.contains("nearest is") && table.contains("cannot be: it does not run"));
    assert!(html.contains("✗ Seen although it cannot be: </span><code>DTIMER-21 expired</code>"));
}

#[test]
fn what_cannot_be_and_was_taken_is_told_with_the_reason() {
    let run = walked(&["D-ERR D-LEAVE", HOSTILE]);
    let summary = Summary::of(&run);
    let contradicting = &summary.coverage[0].step_pairs.contradicting;
    assert_eq!(contradicting["D-ERR D-LEAVE"], "infeasible: SDcycles is 3");
    assert_eq!(contradicting[HOSTILE], "not known to the goals");
    let html = page("contradicting", &run);
    assert!(html.contains("✗ Taken although it cannot be: </span><code>D-ERR D-LEAVE</code>"));
    assert!(html.contains("infeasible: SDcycles is 3") && !html.contains("<script"));
}

#[test]
fn a_record_without_goals_is_read_as_before() {
    let old = Folder::with("old", &run(vec![passed(1)]));
    let text = old.text("run.jsonl");
    assert!(!text.contains("machines") && !text.contains("walked"));
    let summary = render(&old.0).expect("it is sound");
    assert!(summary.coverage.is_empty() && !old.text("summary.json").contains("coverage"));
    assert!(!old.text("report.html").contains("were taken; never"));
}

#[test]
fn each_machine_has_its_diagram_with_the_counts_on_the_edges() {
    let html = page("diagrams", &both());
    for (machine, edges, never) in [("FS-Device", 12, "T31 never"), ("FS-Master", 14, "T14 never")] {
        let at = html.find(&format!("<title>States of the {machine}")).expect("it is there");
        let svg = &html[at..at + html[at..].find("</svg>").expect("it ends")];
        assert_eq!(svg.matches("class=\"edge").count(), edges);
        assert!(svg.contains(&format!(">{never}</text>")), "a transition that was never taken says so");
        assert!(svg.contains("<desc>from ") && svg.contains(" never"));
    }
    assert!(html.contains(">T22 × 4</text>"), "two cases took it twice each");
}
