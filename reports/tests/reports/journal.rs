//! Journals that are whole, cut off, damaged or foreign.

use crate::common::*;
use fsct_reports::record::{Footer, LatencyInfo};
use fsct_reports::{FILE, Journal, Reader, Run, Summary, read, render};
use rstest::rstest;

#[rstest]
#[case::of_an_fs_device("device", everything())]
#[case::of_an_fs_device_and_an_fs_master("both", both())]
fn a_journal_reads_back_as_it_was_written(#[case] name: &str, #[case] run: Run) {
    assert_eq!(read(&Folder::with(&format!("round-{name}"), &run).0).expect("it is sound"), run);
}

#[test]
fn a_journal_begun_anew_holds_nothing_of_the_old_one_and_makes_its_folder() {
    let parent = Folder::new("anew");
    let folder = parent.0.join("runs").join("1");
    for cases in [vec![passed(1), failed(2)], vec![passed(3)]] {
        let mut journal = Journal::create(&folder).expect("it can be written");
        journal.header(&header(cases.len())).expect("it can be written");
        cases.iter().for_each(|case| journal.case(case).expect("it can be written"));
    }
    assert_eq!(read(&folder).expect("it is sound").cases, [passed(3)]);
}

#[test]
fn what_is_recorded_can_be_read_while_the_journal_is_open() {
    let folder = Folder::new("open");
    let mut journal = Journal::create(&folder.0).expect("it can be written");
    journal.header(&header(2)).expect("it can be written");
    assert_eq!(read(&folder.0).expect("the header is there").cases, []);
    journal.case(&passed(1)).expect("it can be written");
    assert_eq!(read(&folder.0).expect("the case is there").cases, [passed(1)]);
}

/// Only the end of the line may be missing for the line to count: nothing of what it says is lost then.
#[rstest]
#[case::a_case(None)]
#[case::the_footer(Some(Footer { cases: 2, interrupted: false }))]
fn a_journal_cut_off_anywhere_in_its_last_line_keeps_all_before_it(#[case] footer: Option<Footer>) {
    let footed = footer.is_some();
    let mut last_case = hostile(2);
    last_case.place = "é€😀".into();
    let run = Run { footer, ..run(vec![passed(1), last_case]) };
    let folder = Folder::with(if footed { "cut-footer" } else { "cut-case" }, &run);
    let whole = std::fs::read(folder.0.join(FILE)).expect("it was written");
    let (_, lines) = whole.split_last().expect("it ends with a line end");
    let begin = lines.iter().rposition(|octet| *octet == b'\n').expect("three lines") + 1;
    for cut in begin..=whole.len() {
        std::fs::write(folder.0.join(FILE), &whole[..cut]).expect("it can be written");
        let back = read(&folder.0).expect("all but the last line is sound");
        let complete = cut >= lines.len();
        let damage = format!("line {} was cut off after {} octets", if footed { 4 } else { 3 }, cut - begin);
        assert_eq!(back.damaged, (cut > begin && !complete).then_some(damage));
        assert_eq!(back.cases, run.cases[..if footed || complete { 2 } else { 1 }], "cut at {cut}");
        assert_eq!(Summary::of(&back).partial, !(footed && complete), "cut at {cut}");
    }
}

#[rstest]
#[case::empty("", "the first line is missing")]
#[case::no_json("hello\n", "no line of a record")]
#[case::the_schema_of_before(r#"{"header":{"schema":"fsct-run/1","fsct":"9","seed":1,"dut":{"url":"","role":"device","vendor":"","product":"","version":"","pcos":[],"clock":"virtual","resolution_ns":1,"uncertainty_ns":0,"offers":[]},"profile":"","planned":0,"not_applicable":[],"tolerances":{}}}"#, "run.jsonl: the record has schema `fsct-run/1`, this fsct reads `fsct-run/2`; use the version of fsct that wrote it")]
#[case::cut_in_its_header(r#"{"header":{"schema":"fsct-ru"#, "run.jsonl:1:")]
#[case::no_header(r#"{"footer":{"cases":0,"interrupted":false}}"#, "not where it belongs")]
#[case::another_shape(r#"{"header":{"schema":"fsct-run/9","who":"knows"}}"#, "has schema `fsct-run/9`, this")]
#[case::this_schema_in_another_shape(
    r#"{"header":{"schema":"fsct-run/2","who":"knows"}}"#,
    "run.jsonl:1: the line is no line of a record"
)]
fn a_file_that_is_no_record_gets_one_clear_sentence(#[case] text: &str, #[case] says: &str) {
    let folder = Folder::new(&format!("bad-{}-{}", text.len(), says.len()));
    std::fs::write(folder.0.join(FILE), text).expect("it can be written");
    let error = read(&folder.0).expect_err("it is no record").to_string();
    assert!(error.contains(says) && !error.contains('\n'), "{error}");
}

#[test]
fn a_bad_line_in_the_middle_is_named() {
    let folder = Folder::with("middle", &everything());
    let text = folder.text(FILE).replacen("\"case\"", "\"cake\"", 1);
    std::fs::write(folder.0.join(FILE), text).expect("it can be written");
    assert!(read(&folder.0).expect_err("line 2 is bad").to_string().contains("run.jsonl:2:"));
}

#[rstest]
#[case::a_case(1)]
#[case::another_footer(2)]
fn nothing_may_follow_the_footer(#[case] line: usize) {
    let folder = Folder::with(&format!("behind-{line}"), &run(vec![passed(1)]));
    let text = folder.text(FILE);
    let again = text.lines().nth(line).expect("header, case, footer");
    std::fs::write(folder.0.join(FILE), format!("{text}{again}\n")).expect("it can be written");
    let error = read(&folder.0).expect_err("a line after the footer").to_string();
    assert!(error.contains("run.jsonl:4: the line is not where it belongs"), "{error}");
}

#[test]
fn a_line_without_end_is_refused_before_it_fills_the_memory() {
    let folder = Folder::with("endless", &Run { footer: None, ..run(vec![passed(1)]) });
    let file = std::fs::OpenOptions::new().write(true).open(folder.0.join(FILE)).expect("it is there");
    file.set_len(80 << 20).expect("it can grow");
    let error = read(&folder.0).expect_err("80 MiB in one line").to_string();
    assert!(error.contains("run.jsonl:3: the line is longer than"), "{error}");
}

#[test]
fn cases_are_read_one_at_a_time_and_the_footer_is_known_at_the_end() {
    let run = everything();
    let mut reader = Reader::open(&Folder::with("stream", &run).0).expect("it is sound");
    assert_eq!(*reader.header(), run.header);
    for case in &run.cases {
        assert_eq!(reader.footer(), None);
        assert_eq!(reader.next().expect("one more").expect("it is sound"), *case);
    }
    assert!(reader.next().is_none() && reader.next().is_none());
    assert_eq!(reader.footer(), run.footer.as_ref());
}

#[test]
fn reading_ends_at_the_first_error() {
    let folder = Folder::with("fused", &everything());
    let text = folder.text(FILE).replacen("\"case\"", "\"cake\"", 1);
    std::fs::write(folder.0.join(FILE), text).expect("it can be written");
    let mut reader = Reader::open(&folder.0).expect("the header is sound");
    assert!(reader.next().is_some_and(|case| case.is_err()));
    assert!(reader.next().is_none());
}

#[test]
fn a_measured_round_trip_is_shown_and_one_that_was_not_leaves_no_trace() {
    let unmeasured = run(vec![passed(1)]);
    let mut measured = unmeasured.clone();
    let trip = LatencyInfo { min_ns: 900_000, median_ns: 1_100_000, p99_ns: 2_000_000, max_ns: 3_400_000 };
    measured.header.duts[0].round_trip = Some(trip);
    let written = |name: &str, run: &Run| {
        let folder = Folder::with(name, run);
        render(&folder.0).expect("the record is sound");
        assert_eq!(read(&folder.0).expect("the record is sound").header, run.header);
        (folder.text("run.jsonl"), folder.text("report.html"))
    };
    let (_, shown) = written("measured", &measured);
    assert!(shown.contains("<dt>Round trip</dt><dd>median 1100 µs, 900 µs to 3400 µs</dd>"));
    let (record, shown) = written("unmeasured", &unmeasured);
    assert!(!record.contains("round_trip") && !shown.contains("Round trip"));
}
