//! Several DUTs of one role: which cases did not come to the same on all of them.

use crate::common::*;
use fsct_reports::record::*;
use fsct_reports::{Differing, Run, Summary};
use rstest::rstest;

/// A case with the key of its number on a DUT.
fn on(dut: usize, case: CaseRecord) -> CaseRecord {
    CaseRecord { dut, ..case }
}

/// The cases on two FS-Devices and, to be left alone, an FS-Master.
fn compared(cases: Vec<CaseRecord>) -> Run {
    let mut run = run(cases);
    run.header.duts = vec![curtain(), gateway(), DutInfo { product: "Curtain 3001".into(), ..curtain() }];
    run
}

fn differing(number: usize, first: &'static str, other: &'static str) -> Differing {
    Differing { key: passed(number).key, outcomes: vec![(0, first), (2, other)] }
}

#[rstest]
#[case::alike(vec![on(0, passed(1)), on(2, passed(1)), on(0, failed(2)), on(2, failed(2))], 2, vec![])]
#[case::verdicts(vec![on(0, passed(1)), on(2, remarked(1))], 1, vec![differing(1, "pass", "remark")])]
#[case::executions(
    vec![on(0, lost(1, Execution::RigError)), on(2, inconclusive(1))],
    1,
    vec![differing(1, "rig-error", "inconclusive")]
)]
#[case::on_one_alone(vec![on(0, passed(1)), on(2, passed(1)), on(2, passed(2))], 2, vec![differing(2, "not run", "pass")])]
#[case::the_other_role(vec![on(0, passed(1)), on(1, mastered(1)), on(2, passed(1))], 1, vec![])]
fn cases_on_two_duts(#[case] cases: Vec<CaseRecord>, #[case] number: usize, #[case] told: Vec<Differing>) {
    let run = compared(cases);
    let summary = Summary::of(&run);
    assert_eq!((summary.compared, &summary.differing), (Some(number), &told));
    assert_eq!(
        Summary::read(&Folder::with(&format!("compare-{number}-{}", told.len()), &run).0).expect("it is sound"),
        summary
    );
}

#[test]
fn one_dut_a_role_is_compared_with_nobody() {
    assert_eq!(Summary::of(&both()).compared, None);
}

#[test]
fn the_page_names_the_cases_and_the_duts() {
    let page = |cases| {
        let folder = Folder::with("compare-page", &compared(cases));
        fsct_reports::render(&folder.0).expect("it can be rendered");
        folder.text("report.html")
    };
    let differing = page(vec![on(0, passed(1)), on(2, failed(1))]);
    for text in
        ["1 of 1 cases did not come to the same", "pass on DUT 1 (Curtain 3000)", "fail on DUT 3 (Curtain 3001)"]
    {
        assert!(differing.contains(text), "{text}");
    }
    assert!(
        page(vec![on(0, passed(1)), on(2, passed(1))]).contains("Each of the 1 cases came to the same on every DUT")
    );
}
