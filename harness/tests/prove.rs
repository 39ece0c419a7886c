//! `fsct prove` as a user runs it.

mod cli;

use cli::fsct;
use rstest::rstest;
use serde_json::Value;

#[test]
fn what_the_tables_allow_is_named_and_fails_nothing() {
    let run = fsct(&["prove", "--faults", "3", "--no-power-cycles", "--property", "P2", "--property", "P6-timeout"]);
    assert_eq!(run.code, 0, "{run:?}");
    let row =
        |name: &str| run.out.lines().find(|line| line.starts_with(&format!("{name} "))).unwrap_or_default().to_owned();
    assert!(row("P2").contains("holds") && row("P6-timeout").contains("tables"), "{}", run.out);
    assert!(run.out.contains("Allowed by the tables of both editions: T29 leaves DTimeout"), "{}", run.out);
}

#[test]
fn a_violation_is_shown_exchange_by_exchange() {
    let run = fsct(&["prove", "--reading", "A19=sequential", "--property", "P2d"]);
    assert_eq!(run.code, 1, "{run:?}");
    let chart = run.out.split_once("Violated.\n").map(|(_, chart)| chart).unwrap_or_default();
    insta::assert_snapshot!(chart);
}

#[test]
fn a_lock_up_says_what_repeats() {
    let run = fsct(&["prove", "--reading", "A09=exactly-next", "--property", "P5", "--json"]);
    assert_eq!(run.code, 1, "{run:?}");
    let json: Value = serde_json::from_str(&run.out).expect("JSON");
    let outcome = &json[0]["properties"][0];
    assert_eq!((&outcome["verdict"], &outcome["repeats"]), (&"lock-up".into(), &4.into()));
    assert_eq!(outcome["chart"].as_array().map(Vec::len), Some(11));
}

#[test]
fn a_search_that_had_to_stop_proves_nothing() {
    let run = fsct(&["prove", "--most-states", "500", "--property", "P2"]);
    assert_eq!(run.code, 5, "{run:?}");
    assert!(run.out.contains("unknown") && run.out.contains("more states than --most-states allows"), "{}", run.out);
}

#[rstest]
#[case::watchdog(&["--watchdog", "1"], "a watchdog of 1 exchanges; 2 to 15 can be explored")]
#[case::faults(&["--faults", "15"], "more than 14 disturbed exchanges are not counted")]
#[case::no_number(&["--faults", "many"], "a number from 0 to 14 or `unlimited` is expected")]
#[case::timing(&["--timing", "X"], "`X` is no timing; P (pipelined) and I (immediate answers) are")]
#[case::reading(&["--reading", "A99"], "`A99` is no reading; these are: A05=judged")]
#[case::property(&["--property", "P99"], "`P99` is no property; these are: P1-taken")]
#[case::edition(&["--reading", "A31=0-or-1"], "is a reading of v1.1 alone")]
#[case::both(&["--reading", "A37=timer-first", "--reading", "A37=reception-first"], "answer the same question; take one")]
fn what_cannot_be_explored_is_said(#[case] args: &[&str], #[case] sentence: &str) {
    let run = fsct(&[&["prove"], args].concat());
    assert_eq!(run.code, 2, "{run:?}");
    assert!(run.err.contains(sentence), "{}", run.err);
}

/// The table that the tolerances are held against is what the command finds.
#[test]
fn which_readings_a_product_may_follow_is_what_was_found() {
    let run = fsct(&["prove", "--tolerances", "--yaml"]);
    assert_eq!(run.code, 0, "{run:?}");
    assert_eq!(run.out, include_str!("../../testcases/readings.yaml"));
}

#[test]
fn a_reading_is_given_to_one_machine() {
    let run = fsct(&["prove", "--device-reading", "A20=kept", "--faults", "1", "--property", "P2", "--json"]);
    assert_eq!(run.code, 0, "{run:?}");
    let json: Value = serde_json::from_str(&run.out).expect("JSON");
    assert_eq!(json[0]["readings"][0], "FS-Device A20=kept");
}

#[test]
fn a_delay_across_a_resynchronisation_is_shown() {
    let run = fsct(&["prove", "--storing", "2", "--watchdog", "3", "--faults", "3", "--property", "P7-order"]);
    assert_eq!(run.code, 1, "{run:?}");
    assert!(
        run.out.contains("SPDUs stored for 2 exchanges") && run.out.contains("STORED(1 of 2 before)"),
        "{}",
        run.out
    );
}

#[rstest]
#[case::other_machine(&["--master-reading", "A19=sequential"], "A19=sequential is no reading of an FS-Master")]
#[case::stored(&["--storing", "16"], "images are stored for 15 exchanges at most")]
#[case::age(&["--storing", "1", "--property", "P1-live"], "P1-live is not asked: the age of a stored image is not followed")]
#[case::timers(&["--timers", "nd", "--property", "P4"], "P4 is not asked: it counts exchanges")]
#[case::kind(&["--timers", "none"], "`none` is no kind of timers; counted and nd")]
#[case::tolerances(&["--tolerances", "--storing", "2"], "cannot be used with")]
fn what_is_not_asked_is_said(#[case] args: &[&str], #[case] sentence: &str) {
    let run = fsct(&[&["prove"], args].concat());
    assert_eq!(run.code, 2, "{run:?}");
    assert!(run.err.contains(sentence), "{}", run.err);
}
