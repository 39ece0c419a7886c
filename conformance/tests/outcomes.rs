//! What a vendor sees: a good device passes, every other one fails with all that is needed to find the fault.

use fsct_adapters::{Description, Dut, DutError, Observation, Stimulus};
use fsct_conformance::{Outcome, Suite, Test};
use fsct_harness::library::Library;
use fsct_reference::{FsDevice, FsMaster, MasterOptions, Mutant, NullDevice, Options};
use std::sync::LazyLock;

static LIBRARY: LazyLock<Library> = LazyLock::new(|| match Library::embedded() {
    Ok(library) => library,
    Err(problems) => panic!("{problems:?}"),
});

fn tests(suite: Suite) -> Vec<Test> {
    suite.target("my-device", "conformance").tests(&LIBRARY, true)
}

fn outcomes(suite: Suite) -> Vec<(String, Outcome)> {
    tests(suite).into_iter().map(|test| (test.name.clone(), test.run())).collect()
}

/// Name and text of the only test, which fails.
fn failure(suite: Suite) -> (String, String) {
    match outcomes(suite).as_slice() {
        [(name, Outcome::Failed(text))] => (name.clone(), text.clone()),
        other => panic!("one failure is meant: {other:?}"),
    }
}

fn reference() -> FsDevice {
    FsDevice::new(Options::default())
}

fn mutant() -> FsDevice {
    FsDevice::new(Options { mutant: Some(Mutant::WrongSeed), ..Options::default() })
}

#[test]
fn a_good_device_and_a_good_master_pass() {
    for suite in [
        Suite::device(reference).suites(["device-counter"]),
        Suite::master(|| FsMaster::new(MasterOptions::default())).suites(["master-recovery"]).edition("iec2022"),
    ] {
        let outcomes = outcomes(suite);
        assert!(outcomes.len() > 5, "{outcomes:?}");
        assert!(outcomes.iter().all(|(_, outcome)| matches!(outcome, Outcome::Passed)), "{outcomes:?}");
    }
}

#[test]
fn a_failure_tells_clause_step_spdus_and_how_to_run_it_again() {
    let (_, text) = failure(Suite::device(mutant).filter(["FSD-0201[edition=iec2022,mode=crc16"]));
    insta::assert_snapshot!(text);
}

#[test]
fn a_null_device_passes_nothing() {
    let outcomes = outcomes(Suite::device(NullDevice::default));
    let failed = outcomes.iter().filter(|(_, outcome)| matches!(outcome, Outcome::Failed(_))).count();
    let left_out = outcomes.iter().filter(|(_, outcome)| matches!(outcome, Outcome::NotApplicable(_))).count();
    assert!(failed > 100);
    assert_eq!(failed + left_out, outcomes.len());
}

/// Panics when process data are lost.
struct Panicking(FsDevice);

impl Dut for Panicking {
    fn hello(&mut self) -> Result<Description, DutError> {
        self.0.hello()
    }

    fn apply(&mut self, stimuli: &[Stimulus], observed: &mut Vec<Observation>) -> Result<(), DutError> {
        if stimuli.iter().any(|stimulus| matches!(stimulus, Stimulus::Exchange { octets: None, .. })) {
            panic!("called `Option::unwrap()` on a `None` value");
        }
        self.0.apply(stimuli, observed)
    }
}

#[test]
fn a_panic_in_the_device_fails_its_case_as_an_error_of_the_dut_and_the_others_go_on() {
    let outcomes = outcomes(Suite::device(|| Panicking(reference())).suites(["device-watchdog"]));
    let panicked = |outcome: &Outcome| match outcome {
        Outcome::Failed(text) => {
            assert!(text.starts_with("dut-error: the DUT broke the contract of the adapter"), "{text}");
            text.contains("it panicked: called `Option::unwrap()` on a `None` value")
        }
        _ => false,
    };
    assert!(outcomes.iter().any(|(_, outcome)| panicked(outcome)), "{outcomes:?}");
    assert!(outcomes.iter().any(|(_, outcome)| *outcome == Outcome::Passed), "{outcomes:?}");
}

#[test]
fn a_device_that_cannot_be_made_is_told_once() {
    let (name, text) = failure(Suite::device(|| -> FsDevice { panic!("no such file: calibration.bin") }));
    assert_eq!(name, "fsct::hello");
    assert!(text.contains("it panicked: no such file: calibration.bin"), "{text}");
}

#[test]
fn a_selection_that_holds_nothing_fails() {
    for (suite, said) in [
        (Suite::device(reference).filter(["FSD-9999"]), "nothing applies: no case matches"),
        (Suite::device(reference).suites(["device-conter"]), "did you mean `device-counter`?"),
        (Suite::device(reference).edition("v1.2"), "`edition` is v1.1 or iec2022"),
        (Suite::device(reference).strict(["B07"]), "`B07` is no tolerance"),
    ] {
        let (name, text) = failure(suite);
        assert_eq!(name, "fsct::plan");
        assert!(text.contains(said), "{text}");
    }
}

#[test]
fn cases_that_do_not_apply_are_not_passed_and_alone_they_are_a_failure() {
    let outcomes = outcomes(Suite::device(reference).suites(["ossde-master"]));
    let [left_out @ .., (name, Outcome::Failed(text))] = outcomes.as_slice() else { panic!("{outcomes:?}") };
    assert_eq!(name, "fsct::plan");
    assert!(text.contains("cases: the case is for a master, the DUT is a device"), "{text}");
    let term = Outcome::NotApplicable("the case is for a master, the DUT is a device".to_owned());
    assert!(!left_out.is_empty() && left_out.iter().all(|(_, outcome)| *outcome == term), "{outcomes:?}");
}

#[test]
fn a_broken_profile_is_shown_with_its_place() {
    let text = "profile: mine\ndut: device\nFSP_Watchdog: 20\n";
    let (name, text) = failure(Suite::device(reference).profile("my-device.yaml", text));
    assert_eq!(name, "fsct::profile");
    insta::assert_snapshot!(text);
}

#[test]
fn a_master_behind_the_key_device_is_told() {
    let (name, text) = failure(Suite::device(|| FsMaster::new(MasterOptions::default())));
    assert_eq!(name, "fsct::hello");
    assert!(text.contains("the DUT says it is a master"), "{text}");
}

#[test]
fn a_process_for_one_case_judges_it_as_the_whole_library_does() {
    for id in ["FSD-0201", "FSD-0301"] {
        let part = Library::embedded_for(id).expect("no problems");
        assert_eq!(part.cases().filter(|case| case.id == id).count(), 1);
        let whole: Vec<_> =
            outcomes(Suite::device(mutant)).into_iter().filter(|(name, _)| name.starts_with(id)).collect();
        let suite = Suite::device(mutant).target("my-device", "conformance");
        let alone = suite.tests(Box::leak(Box::new(part)), false).into_iter();
        let alone: Vec<_> =
            alone.filter(|test| test.name.starts_with(id)).map(|test| (test.name.clone(), test.run())).collect();
        assert_eq!(whole, alone);
    }
}

#[test]
fn every_case_finds_its_requirements_in_its_part_of_the_library() {
    let mut seen = std::collections::BTreeSet::new();
    // One case of each suite is enough: the parts differ by suite.
    for case in LIBRARY.cases().filter(|case| seen.insert(case.suite.clone())) {
        let part = Library::embedded_for(&case.id).expect("no problems");
        let missing = case.requirements.iter().find(|id| part.ledger.get(id).is_none());
        assert_eq!(missing, None, "{}", case.id);
    }
}
