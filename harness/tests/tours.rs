//! What a DUT is led through beyond single transitions: the goals, the tours that are made for them, and what a run says of it.

mod cli;
mod common;

use cli::{Folder, fsct};
use common::{library, run_with};
use fsct_adapters::{Dut, Role};
use fsct_harness::complete::GROUP;
use fsct_harness::conditions::Sides;
use fsct_harness::library::Library;
use fsct_harness::plan::Selection;
use fsct_harness::tours::{emit, feasible_for};
use fsct_harness::walk::{Graph, places};
use fsct_reference::{FsDevice, FsMaster, MasterOptions, Options};
use fsct_reports::record::CaseRecord;
use rstest::rstest;
use std::collections::BTreeSet;

const DEVICE: &str = "device";
const MASTER: &str = "master";

/// What cases were seen to decide of what is asked, and what they were not.
fn not_decided(library: &Library, role: &str, cases: &[CaseRecord]) -> Vec<String> {
    let asked = &library.coverage[role].asked;
    let seen: BTreeSet<&String> =
        cases.iter().flat_map(|case| case.walked.guards.iter().chain(&case.walked.timers)).collect();
    let never = asked.guards.infeasible.iter().chain(&asked.timers.infeasible);
    assert_eq!(never.filter(|(side, _)| seen.contains(side)).count(), 0, "it cannot be, and was");
    asked.guards.feasible.iter().chain(&asked.timers.feasible).filter(|side| !seen.contains(side)).cloned().collect()
}

/// What cases took of the goals, and what they did not.
fn not_taken(library: &Library, role: &str, cases: &[CaseRecord]) -> Vec<String> {
    let coverage = &library.coverage[role];
    let goals = coverage.names(coverage.feasible, Sides::NONE);
    let taken: BTreeSet<&String> =
        cases.iter().flat_map(|case| case.walked.triples.iter().chain(&case.walked.step_pairs)).collect();
    goals.triples.iter().chain(&goals.step_pairs).filter(|goal| !taken.contains(goal)).cloned().collect()
}

/// Complete suites take nearly everything once more, whatever else is missing.
fn without_complete_suites() -> Library {
    let mut library = library();
    library.suites.retain(|suite| suite.group.as_deref() != Some(GROUP));
    library
}

fn cases(library: &Library, role: &str) -> Vec<CaseRecord> {
    let make = || -> Box<dyn Dut> {
        if role == DEVICE {
            Box::new(FsDevice::new(Options::default()))
        } else {
            Box::new(FsMaster::new(MasterOptions::default()))
        }
    };
    run_with(library, &Selection::default(), &format!("reference-{role}"), make)
}

#[rstest]
#[case(Role::Device)]
#[case(Role::Master)]
fn what_the_search_finds_feasible_is_what_the_goals_call_feasible(#[case] role: Role) {
    let library = library();
    let coverage = &library.coverage[&role.to_string()];
    let found = coverage.names(feasible_for(role), Sides::NONE);
    assert_eq!(found, coverage.names(coverage.feasible, Sides::NONE));
    let all = Graph::role(role).step_pairs.len();
    assert_eq!(found.step_pairs.len() + coverage.infeasible.len(), all, "every other pair of steps has its reason");
    assert_eq!((found.step_pairs.len(), all), (30, 35));
    assert_eq!(places(coverage.feasible.triples).count(), Graph::role(role).triples.len());
}

#[rstest]
#[case(DEVICE, include_str!("../../testcases/suites/device-tours.yaml"))]
#[case(MASTER, include_str!("../../testcases/suites/master-tours.yaml"))]
fn the_tours_are_those_of_the_rows(#[case] role: &str, #[case] committed: &str) {
    let made = emit(&library().coverage[role]);
    let differs = committed.lines().zip(made.lines()).position(|(old, new)| old != new);
    assert!(made == committed, "make them again: fsct tours {role}; line {differs:?} differs");
}

#[rstest]
#[case(DEVICE, "FSD-1604", &["D-FIRST-ERR D-ERR-AGAIN"])]
#[case(DEVICE, "FSD-1605", &["D-FIRST-ERR D-TIMEOUT-AGAIN"])]
#[case(MASTER, "FSM-1601", &["M-FIRST-GOOD M-FAULT", "M-ACK M-FAULT"])]
#[case(MASTER, "FSM-1604", &["M-FIRST-FAULT M-TIMEOUT-AGAIN"])]
fn without_a_tour_its_goal_is_named(#[case] role: &str, #[case] id: &str, #[case] missing: &[&str]) {
    let mut library = without_complete_suites();
    assert_eq!(not_taken(&library, role, &cases(&library, role)), [""; 0], "the whole suite takes everything");
    // The chart of the proof happens to take one of them as well.
    library.suites.retain(|suite| suite.name != "proof");
    for suite in &mut library.suites {
        suite.cases.retain(|case| case.id != id);
    }
    assert_eq!(not_taken(&library, role, &cases(&library, role)), missing);
}

#[rstest]
#[case(DEVICE, &["FSD-0631", "FSD-0632"], &["D27-PORTNUM false", "D27-MCOUNT-0 false", "D27-MCOUNT-NEXT false"])]
#[case(MASTER, &["FSM-0731"], &["M7-NOT-ZERO false"])]
fn without_its_case_a_condition_goes_one_way_only(#[case] role: &str, #[case] ids: &[&str], #[case] missing: &[&str]) {
    let mut library = without_complete_suites();
    assert_eq!(not_decided(&library, role, &cases(&library, role)), [""; 0], "the whole suite decides everything");
    for suite in &mut library.suites {
        suite.cases.retain(|case| !ids.contains(&case.id.as_str()));
    }
    assert_eq!(not_decided(&library, role, &cases(&library, role)), missing);
}

#[test]
fn a_run_says_how_much_was_taken_and_names_the_rest() {
    let out = Folder::new("tours");
    let outcome = fsct(&["run", "device-tours", "--filter", "FSD-1602", "--filter", "FSD-1603", "--out", &out.out()]);
    assert_eq!(outcome.code, 4, "two filters exclude each other: {outcome:?}");
    let outcome = fsct(&["run", "device-tours", "--out", &out.out()]);
    assert_eq!(outcome.code, 0, "{outcome:?}");
    assert!(outcome.out.contains(" · device: 26 of 26 triples, 30 of 30 step pairs, guards "), "{}", outcome.out);
    assert!(
        outcome.out.contains("\nnot seen of the device: DTIMER-24 restarted; nearest is FSD-16"),
        "{}",
        outcome.out
    );
    assert!(!outcome.out.contains("CONTRADICTION") && !outcome.out.contains("not taken by"), "{}", outcome.out);
    let outcome = fsct(&[
        "run",
        "device-startup",
        "device-transitions",
        "device-watchdog",
        "device-recovery",
        "--out",
        &out.out(),
    ]);
    assert!(outcome.out.contains("step pairs not taken by the device: "), "{}", outcome.out);
    assert!(outcome.out.contains("D-FIRST-ERR D-ERR-AGAIN"), "{}", outcome.out);
}
