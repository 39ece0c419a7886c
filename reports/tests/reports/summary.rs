//! The numbers of a run and its exit code.

use crate::common::*;
use fsct_reports::record::*;
use fsct_reports::{Run, Summary};
use rstest::rstest;

#[rstest]
#[case::nothing_ran(run(Vec::new()), 4)]
#[case::conformant(run(vec![passed(1)]), 0)]
#[case::remarks_only(run(vec![passed(1), remarked(2)]), 0)]
#[case::a_failure(run(vec![passed(1), failed(2)]), 1)]
#[case::a_failure_outranks_a_lost_dut(run(vec![failed(1), lost(2, Execution::DutError)]), 1)]
#[case::a_lost_dut(run(vec![passed(1), lost(2, Execution::RigError)]), 3)]
#[case::inconclusive(run(vec![passed(1), inconclusive(2)]), 5)]
#[case::cut_off(Run { footer: None, ..run(vec![passed(1)]) }, 3)]
#[case::interrupted(Run { footer: Some(Footer { cases: 1, interrupted: true }), ..run(vec![passed(1)]) }, 3)]
#[case::fewer_than_planned(Run { header: header(2), ..run(vec![passed(1)]) }, 3)]
#[case::fewer_than_counted(Run { footer: Some(Footer { cases: 2, interrupted: false }), ..run(vec![passed(1)]) }, 3)]
#[case::nothing_ran_before_the_cut(Run { footer: None, header: header(9), ..run(Vec::new()) }, 4)]
#[case::nothing_that_applies(run(vec![not_applicable(1)]), 4)]
#[case::something_that_applies(run(vec![not_applicable(1), passed(2)]), 0)]
#[case::inconclusive_only(run(vec![inconclusive(1)]), 5)]
#[case::aborted(run(vec![passed(1), lost(2, Execution::Aborted)]), 3)]
fn exit_codes(#[case] run: Run, #[case] code: u8) {
    assert_eq!(Summary::of(&run).exit_code(), code);
}

#[test]
fn a_journal_is_summed_up_case_by_case_with_the_same_result() {
    let run = everything();
    assert_eq!(Summary::read(&Folder::with("sum", &run).0).expect("it is sound"), Summary::of(&run));
}

#[test]
fn a_record_with_a_damaged_end_is_partial_whatever_its_footer_says() {
    let whole = run(vec![passed(1)]);
    assert!(!Summary::of(&whole).partial);
    assert!(Summary::of(&Run { damaged: Some("line 4 was cut off after 3 octets".into()), ..whole }).partial);
}

#[test]
fn an_fs_master_has_transitions_of_its_own() {
    let mut run = run(Vec::new());
    run.header.duts = vec![gateway()];
    let summary = Summary::of(&run);
    let scl = (1..=14).map(|number| format!("T{number}"));
    let ossde = (1..=6).map(|number| format!("OSSDe T{number}"));
    assert_eq!(summary.transitions, scl.chain(ossde).map(|name| (name, 0)).collect());
}
