//! `fsct prove` as a user runs it.

mod cli;

use cli::{Folder, fsct};
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

/// Each chart of a reading: the case, the DUT with that reading, the clause it fails by.
#[rstest]
#[case::c1(&["--reading", "A06=T10-not-old", "--property", "P5"], "PRM-0608", "reference-master?mutant=A06-not-old", "11.5.2")]
#[case::c2(&["--reading", "A09=exactly-next", "--property", "P5"], "PRD-0908", "reference-device?mutant=A09-exactly-one", "11.5.3")]
#[case::c3(&["--reading", "A08=last-valid", "--property", "P5"], "PRD-0808", "reference-device?mutant=A08-last-valid", "11.5.3")]
#[case::c5(&["--edition", "v1.1", "--reading", "A31=0-or-1", "--property", "P2d"], "PRD-3104", "reference-device?mutant=A31-one-first", "11.5.3 Table 40 T25")]
#[case::c6(&["--reading", "A19=sequential", "--property", "P2d"], "PRD-1904", "reference-device?mutant=A19-sequential", "11.5.3 Table 40 T29")]
#[case::c6_heard(&["--reading", "A19=sequential", "--property", "P6-further"], "PRD-1911", "reference-device?mutant=A19-sequential", "11.5.3 Table 40 T29")]
#[case::immediate(&["--reading", "A06=T10-not-old", "--property", "P5", "--timing", "I"], "PRM-0608", "reference-master?mutant=A06-not-old", "11.5.2")]
fn a_chart_is_a_case_that_the_reference_passes_and_the_reading_fails(
    #[case] args: &[&str],
    #[case] id: &str,
    #[case] mutant: &str,
    #[case] clause: &str,
) {
    let folder = Folder::new(&format!("prove-{}-{}", id, args.len()));
    let file = folder.0.join("chart.yaml").display().to_string();
    let run = fsct(&[&["prove"], args, &["--emit", &file]].concat());
    assert_eq!(run.code, 1, "the reading breaks it: {run:?}");
    let check = fsct(&["check", &file]);
    assert_eq!(check.code, 0, "{check:?}");
    let address = |options: &str| format!("inproc:{options}");
    let (reference, _) = mutant.split_once('?').expect("a mutant");
    let passes = fsct(&["run", &file, "--dut", &address(reference), "--out", &folder.out()]);
    assert_eq!(passes.code, 0, "{passes:?}");
    assert!(passes.out.contains("conformant: 2 cases, 2 pass"), "{}", passes.out);
    let fails = fsct(&["run", &file, "--dut", &address(mutant), "--out", &folder.out()]);
    assert_eq!(fails.code, 1, "{fails:?}");
    let told = fails.err.split_once(&format!("fail {id}[")).map(|(_, told)| told).unwrap_or_default();
    let by = told.lines().find(|line| line.trim_start().starts_with("clause")).unwrap_or_default();
    assert!(by.contains(clause), "{}", fails.err);
}

/// C4 has no DUT of its own; C7, C8 and C10 are about the tables, and a DUT that follows them passes.
#[rstest]
#[case::c4(&["--reading", "A16=last-valid", "--property", "P5"], 1, &["PRD-1608"])]
#[case::c7(&["--property", "P6-timeout"], 0, &["PRD-0010"])]
#[case::c8(&["--property", "P3-master"], 0, &["PRM-0006"])]
#[case::c10(&["--property", "P7-good"], 0, &["PRM-0013"])]
#[case::both_sides(&["--watchdog", "2", "--reading", "A37=timer-first", "--property", "P5"], 1, &["PRD-3708", "PRM-3708"])]
fn a_chart_that_no_dut_is_failed_for_is_passed(#[case] args: &[&str], #[case] code: i32, #[case] ids: &[&str]) {
    let folder = Folder::new(&format!("prove-{}", ids.concat()));
    let file = folder.0.join("chart.yaml").display().to_string();
    let run = fsct(&[&["prove"], args, &["--emit", &file]].concat());
    assert_eq!(run.code, code, "{run:?}");
    let text = folder.text("chart.yaml");
    assert_eq!(text.contains("no DUT is failed for that"), code == 0, "{text}");
    let passes = fsct(&["run", &file, "--out", &folder.out()]);
    assert_eq!(passes.code, 0, "{passes:?}");
    assert!(passes.out.contains(&format!("{0} cases, {0} pass", 2 * ids.len())), "{}", passes.out);
    assert!(ids.iter().all(|id| text.contains(&format!("id: {id}"))), "{text}");
}

#[test]
fn the_suite_of_the_library_is_what_the_command_writes() {
    let folder = Folder::new("prove-suite");
    let file = folder.0.join("proof.yaml").display().to_string();
    let run = fsct(&["prove", "--reading", "A19=sequential", "--property", "P2d", "--emit", &file]);
    assert_eq!(run.code, 1, "{run:?}");
    let held = concat!(env!("CARGO_MANIFEST_DIR"), "/../testcases/suites/proof.yaml");
    assert_eq!(
        folder.text("proof.yaml"),
        std::fs::read_to_string(held).expect("it is there"),
        "made by the command in its first line"
    );
}

#[test]
fn charts_are_drawn_one_below_the_other() {
    let folder = Folder::new("prove-svg");
    let file = folder.0.join("charts.svg").display().to_string();
    let run =
        fsct(&["prove", "--reading", "A19=sequential", "--property", "P2d", "--property", "P3-master", "--svg", &file]);
    assert_eq!(run.code, 1, "{run:?}");
    let svg = folder.text("charts.svg");
    assert!(svg.starts_with("<svg xmlns=\"http://www.w3.org/2000/svg\"") && svg.ends_with("</svg>\n"), "{svg}");
    assert_eq!((svg.matches(">FS-Master<").count(), svg.matches(">FS-Device<").count()), (2, 2));
    for shown in [
        "P2d: behind a fault",
        "P3-master: behind a fault",
        "T21 T25 T26",
        "6 SDset DCommErr LOST",
        "BAD(1)",
        ">PDout_D<",
    ] {
        assert!(svg.contains(shown), "{shown}: {svg}");
    }
}

#[test]
fn without_a_chart_nothing_is_written() {
    let folder = Folder::new("prove-holds");
    let file = folder.0.join("none.yaml");
    let run = fsct(&["prove", "--faults", "1", "--property", "P2", "--emit", &file.display().to_string()]);
    assert_eq!(run.code, 0, "{run:?}");
    assert!(run.err.contains("there is no chart to write to") && !file.exists(), "{}", run.err);
}

#[rstest]
#[case("--emit")]
#[case("--svg")]
fn what_cannot_be_written_is_said(#[case] option: &str) {
    let folder = Folder::new(&format!("prove-unwritten{option}"));
    let file = folder.0.join("no/such/folder").display().to_string();
    let run = fsct(&["prove", "--faults", "2", "--property", "P3-master", option, &file]);
    assert_eq!(run.code, 3, "{run:?}");
    assert!(run.err.contains("cannot be written"), "{}", run.err);
}

#[test]
fn a_case_names_only_tolerances_that_exist() {
    let folder = Folder::new("prove-strict");
    let text = std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/../testcases/suites/proof.yaml"));
    let file = folder.file("mine.yaml", &text.expect("it is there").replace("strict: [A19]", "strict: [A99]"));
    let run = fsct(&["check", &file]);
    assert_eq!(run.code, 2, "{run:?}");
    assert!(run.err.contains("`A99` is no tolerance"), "{}", run.err);
    let told = fsct(&["explain", "PRD-1904"]);
    assert!(told.out.contains("not excused by A19"), "{}", told.out);
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
#[case::matrix(&["--matrix", "tolerated", "--watchdog", "3"], "cannot be used with")]
#[case::which(&["--matrix", "some"], "[possible values: tolerated, all]")]
#[case::no_case(&["--storing", "2", "--emit", "x.yaml"], "cannot be used with")]
fn what_is_not_asked_is_said(#[case] args: &[&str], #[case] sentence: &str) {
    let run = fsct(&[&["prove"], args].concat());
    assert_eq!(run.code, 2, "{run:?}");
    assert!(run.err.contains(sentence), "{}", run.err);
}
