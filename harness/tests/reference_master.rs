//! The embedded reference FS-Master conforms, at every latency; its mutants and dead masters do not.

mod common;
mod references;

use common::{library, run, run_with, story};
use fsct_adapters::Dut;
use fsct_harness::ledger::Class;
use fsct_harness::library::Library;
use fsct_harness::plan::Selection;
use fsct_reference::{
    ConstantMaster, EchoMaster, FsDevice, FsMaster, MasterMutant, MasterOptions, NullMaster, Options,
};
use fsct_reports::record::{CaseRecord, Verdict};
use references::{first_failure, not_passed};
use rstest::rstest;

fn reference(options: MasterOptions) -> Box<dyn Dut> {
    Box::new(FsMaster::new(options))
}

fn judged(library: &Library, profile: &str, options: MasterOptions) -> Vec<CaseRecord> {
    run_with(library, &Selection::default(), profile, || reference(options))
}

#[test]
fn the_reference_master_conforms_and_takes_every_transition_in_both_editions() {
    let cases = judged(&library(), "reference-master", MasterOptions::default());
    for edition in ["v1.1", "iec2022"] {
        let scl = (1..=14).map(|number| format!("T{number}"));
        for transition in scl.chain((1..=6).map(|number| format!("OSSDe T{number}"))) {
            let taken =
                |case: &CaseRecord| case.variant.edition == edition && case.transitions.contains_key(&transition);
            assert!(cases.iter().any(taken), "{transition} was never taken in {edition}");
        }
    }
    let others = not_passed(cases);
    assert!(others.is_empty(), "{}", story(&others));
}

#[rstest]
#[case("master-late-1", 1)]
#[case("master-late-3", 3)]
fn a_new_spdu_may_take_some_exchanges(#[case] profile: &str, #[case] latency: u8) {
    let others = not_passed(judged(&library(), profile, MasterOptions { latency, ..MasterOptions::default() }));
    assert!(others.is_empty(), "{}", story(&others));
}

#[test]
fn a_master_with_passwords_keeps_who_has_none_out() {
    let library = library();
    let profile = &library.profiles["reference-master"];
    let mut with_passwords = profile.clone();
    with_passwords.features.push("password".into());
    (with_passwords.password, with_passwords.reset_password) = (0x1122_3344, 0x5566_7788);
    let mut library = Library::embedded().expect("it is sound");
    library.profiles.insert("with-passwords".into(), with_passwords);
    let options = MasterOptions { password: 0x1122_3344, reset_password: 0x5566_7788, ..MasterOptions::default() };
    let selection = Selection { filter: vec!["assword".into()], ..Selection::default() };
    let cases = run_with(&library, &selection, "with-passwords", || reference(options));
    assert_eq!(cases.len(), 2);
    assert!(cases.iter().all(|case| case.verdict == Verdict::Pass), "{}", story(&cases));
    // Without a password nothing is kept out, and the case says so.
    let open = run_with(&library, &selection, "with-passwords", || reference(MasterOptions::default()));
    assert!(open.iter().all(|case| case.verdict == Verdict::Fail), "{}", story(&open));
}

#[rstest]
#[case(MasterMutant::RestartWithoutAcknowledgment, "11.5.2 Table 38 T13")]
#[case(MasterMutant::AcknowledgmentAsLevel, "11.5.2 Table 38 T13")]
#[case(MasterMutant::McountNotReset, "11.5.2 Table 38 T8")]
#[case(MasterMutant::MTimerRestartedByRepetitions, "11.5.5")]
#[case(MasterMutant::PlainPortNumAccepted, "11.5.2 Table 38 T7")]
#[case(MasterMutant::DTimeoutIgnored, "11.5.2 Table 38 T7")]
#[case(MasterMutant::PdinLiveWhileSdset, "11.3.2 Table 28")]
#[case(MasterMutant::QualifierReleasedEarly, "11.11.4 Table 42")]
#[case(MasterMutant::ChFAckReqEarly, "11.11.2, 11.5.2 Table 38 T7")]
#[case(MasterMutant::Counter7To0, "11.4.6 Table 31, 11.5.2 Table 38")]
#[case(MasterMutant::RecordAfterOperate, "10.4.3.6")]
#[case(MasterMutant::WrongArgBlockOffset, "10.4.3.6")]
fn each_mutant_fails_and_the_clause_is_named(#[case] mutant: MasterMutant, #[case] clause: &str) {
    let cases =
        judged(&library(), "reference-master", MasterOptions { mutant: Some(mutant), ..MasterOptions::default() });
    let failed: Vec<CaseRecord> = cases.into_iter().filter(|case| case.verdict == Verdict::Fail).collect();
    assert!(!failed.is_empty(), "{mutant} fails no case");
    let first = failed.first().and_then(|case| case.reasons.first()).expect("with a reason");
    assert!(first.clause.contains(clause), "{mutant}: {}", story(&failed[..failed.len().min(20)]));
    if mutant == MasterMutant::WrongArgBlockOffset {
        assert!(failed.iter().all(|case| case.variant.edition == "iec2022"), "v1.1 is right: {}", story(&failed));
    }
}

#[test]
fn a_failure_of_a_master_tells_what_the_matter_is() {
    let library = library();
    // A few stand for all of them.
    let told: Vec<String> = MasterMutant::ALL
        .iter()
        .take(12)
        .copied()
        .map(|mutant| {
            let options = MasterOptions { mutant: Some(mutant), ..MasterOptions::default() };
            let cases = judged(&library, "reference-master", options);
            first_failure(mutant.name(), &cases)
        })
        .collect();
    insta::assert_snapshot!(told.join("\n"));
}

#[rstest]
#[case::null(|| Box::<NullMaster>::default() as Box<dyn Dut>)]
#[case::echo(|| Box::<EchoMaster>::default() as Box<dyn Dut>)]
#[case::constant(|| Box::<ConstantMaster>::default() as Box<dyn Dut>)]
fn a_dead_master_passes_no_case(#[case] make: fn() -> Box<dyn Dut>) {
    let cases = run_with(&library(), &Selection::default(), "reference-master", make);
    assert!(!cases.is_empty());
    let passed: Vec<CaseRecord> = cases.into_iter().filter(|case| case.verdict <= Verdict::Remark).collect();
    assert!(passed.is_empty(), "{}", story(&passed));
}

#[test]
fn nothing_of_a_master_is_applicable_to_a_device_and_the_other_way_round() {
    let library = library();
    let named = |suite: &str| Selection { suites: vec![suite.into()], ..Selection::default() };
    let master = || reference(MasterOptions::default());
    let device = || Box::new(FsDevice::new(Options::default())) as Box<dyn Dut>;
    let cases = run_with(&library, &named("scl-device"), "reference-master", master);
    assert!(cases.is_empty(), "{}", story(&cases));
    let cases = run(&library, &named("scl-master"), device);
    assert!(cases.is_empty(), "{}", story(&cases));
    assert!(!run_with(&library, &named("scl-master"), "reference-master", master).is_empty());
    assert!(!run(&library, &named("scl-device"), device).is_empty());
}

#[test]
fn every_record_of_the_scl_and_of_the_fs_master_is_tested_or_says_why_not() {
    let library = library();
    let silent: Vec<&str> = library
        .ledger
        .iter()
        .filter(|record| {
            record.place.contains("requirements/scl.yaml") || record.place.contains("requirements/master.yaml")
        })
        .filter(|record| record.class == Class::Open && record.why.as_deref().unwrap_or_default().is_empty())
        .map(|record| record.id.as_str())
        .collect();
    assert!(silent.is_empty(), "{silent:?}");
}
