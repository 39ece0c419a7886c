//! Reports made from records: journal, JUnit, HTML, summary and exit code, with hostile text and cut-off files.

use fsct_reports::record::*;
use fsct_reports::{FILE, Journal, Run, Summary, read, render};
use insta::assert_snapshot;
use rstest::rstest;
use std::collections::BTreeMap;
use std::path::PathBuf;

const HOSTILE: &str = "<script>alert(1)</script> ]]> \u{0} \u{1b}[31m \u{fffe} \u{202e}gpj.exe \"quoted\" & 'more'";

fn header(planned: usize) -> Header {
    Header {
        schema: SCHEMA.into(),
        fsct: "0.0.0".into(),
        seed: 7,
        dut: DutInfo {
            url: "tcp://192.0.2.1:7000".into(),
            role: "device".into(),
            vendor: "ACME".into(),
            product: "Curtain 3000".into(),
            version: "hw 1 sw 2".into(),
            pcos: vec!["power".into(), "link".into()],
            clock: "virtual".into(),
            resolution_ns: 1,
            ..DutInfo::default()
        },
        profile: "curtain".into(),
        planned,
        not_applicable: vec![("FSD-0999[edition=v1.1]".into(), "the DUT does not serve `app`".into())],
        tolerances: BTreeMap::from([("A19".into(), "T29 read sequentially (tolerated)".into())]),
    }
}

fn exchange(at_ms: u64, sent: &str, got: &str, via: &[&str], note: &str) -> Entry {
    Entry {
        at: at_ms * 1_000_000,
        count: 1,
        what: What::Exchange { port: 1, sent: Some(sent.into()), got: Some(got.into()) },
        via: via.iter().map(|t| (*t).to_owned()).collect(),
        note: note.into(),
    }
}

/// A case that passed: start-up of SEQ-POWERON, two exchanges.
fn passed(number: usize) -> CaseRecord {
    CaseRecord {
        key: format!("FSD-{number:04}[edition=iec2022,mode=crc16,pd=1]"),
        id: format!("FSD-{number:04}"),
        suite: "device-startup".into(),
        title: "Start-up of both sides".into(),
        place: "testcases/suites/device-startup.yaml:4".into(),
        sweep: vec![("edition".into(), "iec2022".into()), ("mode".into(), "crc16".into()), ("pd".into(), "1".into())],
        variant: VariantInfo {
            edition: "iec2022".into(),
            mode: "crc16".into(),
            pd_out: 1,
            pd_in: 1,
            leading_octet: false,
        },
        requirements: vec![RequirementRef {
            id: "R-11.5.4.1-01".into(),
            clause: "11.5.4.1".into(),
            level: "shall".into(),
        }],
        verdict: Verdict::Pass,
        execution: Execution::Ok,
        reasons: Vec::new(),
        tolerances: BTreeMap::new(),
        transitions: BTreeMap::from([("T21".into(), 1), ("T22".into(), 2)]),
        start: "waiting".into(),
        steps: vec![
            StepRecord { text: "start: waiting".into(), executed: true, entries: (0, 1), checks: Vec::new() },
            StepRecord {
                text: "exchange: {MCount: 1}".into(),
                executed: true,
                entries: (1, 3),
                checks: vec![Check { key: "DCount_i".into(), expected: "6".into(), observed: "6".into(), met: true }],
            },
        ],
        trace: vec![
            Entry { at: 0, count: 1, what: What::Power { on: true }, via: Vec::new(), note: String::new() },
            exchange(1, "0001029D56", "A5FEE46AF6", &["T20", "T21", "T22", "T23"], ""),
            exchange(2, "5A01205727", "A5FEC41933", &["T24", "T22", "T23"], ""),
        ],
        elided: 0,
        duration_ns: 2_000_000,
        replay: "fsct run --seed 7 --filter 'FSD-0001[..]'".into(),
    }
}

fn reason(verdict: Verdict, kind: &str, observed: &str) -> Reason {
    Reason {
        verdict,
        kind: kind.into(),
        clause: "11.5.3 Table 40 T25".into(),
        step: 1,
        entry: Some(2),
        expected: "DCommErr 1 (after T24 T25 T26)".into(),
        observed: observed.into(),
    }
}

fn failed(number: usize) -> CaseRecord {
    let mut case = passed(number);
    case.verdict = Verdict::Fail;
    case.reasons.push(reason(Verdict::Fail, "oracle/DCommErr", "DCommErr 0"));
    case.trace[2] = exchange(2, "5A01205726", "A5FEC41933", &["T24", "T25", "T26"], "bit 39 inverted");
    case.steps[1].checks[0] = Check { key: "DCommErr".into(), expected: "1".into(), observed: "0".into(), met: false };
    case
}

fn remarked(number: usize) -> CaseRecord {
    let mut case = passed(number);
    case.verdict = Verdict::Remark;
    case.tolerances.insert("A19".into(), "tolerated: T29 read sequentially".into());
    case
}

fn inconclusive(number: usize) -> CaseRecord {
    let mut case = passed(number);
    case.verdict = Verdict::Inconclusive;
    case.reasons.push(reason(Verdict::Inconclusive, "oracle/signature/A02", "signature CC6D"));
    case
}

fn lost(number: usize, execution: Execution) -> CaseRecord {
    let mut case = inconclusive(number);
    case.execution = execution;
    case.reasons = vec![reason(Verdict::Inconclusive, "dut/timeout", "the DUT gave no complete answer within 2s")];
    case
}

fn hostile(number: usize) -> CaseRecord {
    let mut case = failed(number);
    case.reasons[0].observed = HOSTILE.into();
    case.title = HOSTILE.into();
    case.steps[1].text = HOSTILE.into();
    case
}

fn run(cases: Vec<CaseRecord>) -> Run {
    let footer = Footer { cases: cases.len(), interrupted: false };
    Run { header: header(cases.len()), cases, footer: Some(footer), damaged: None }
}

/// A folder of its own for a test, gone when the test ends.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Folder {
        let path = std::env::temp_dir().join(format!("fsct-reports-{}-{name}", std::process::id()));
        std::fs::create_dir_all(&path).expect("the folder for temporary files can be written");
        Folder(path)
    }

    fn with(name: &str, run: &Run) -> Folder {
        let folder = Folder::new(name);
        let mut journal = Journal::create(&folder.0).expect("it can be written");
        journal.header(&run.header).expect("it can be written");
        run.cases.iter().for_each(|case| journal.case(case).expect("it can be written"));
        if let Some(footer) = &run.footer {
            journal.footer(footer).expect("it can be written");
        }
        folder
    }

    fn text(&self, name: &str) -> String {
        std::fs::read_to_string(self.0.join(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

fn everything() -> Run {
    run(vec![passed(1), failed(2), remarked(3), inconclusive(4), lost(5, Execution::Timeout)])
}

#[test]
fn a_journal_reads_back_as_it_was_written() {
    let run = everything();
    assert_eq!(read(&Folder::with("round", &run).0).expect("it is sound"), run);
}

#[test]
fn a_journal_cut_off_anywhere_in_its_last_line_keeps_all_before_it() {
    let run = run(vec![passed(1), failed(2)]);
    let folder = Folder::with("cut", &Run { footer: None, ..run.clone() });
    let whole = folder.text(FILE);
    let last = whole.trim_end().rfind('\n').expect("three lines") + 1;
    for cut in (last + 1..whole.len() - 1).step_by(97) {
        std::fs::write(folder.0.join(FILE), &whole[..cut]).expect("it can be written");
        let back = read(&folder.0).expect("all but the last line is sound");
        assert_eq!(back.cases, run.cases[..1]);
        assert!(back.damaged.is_some() && Summary::of(&back).partial);
    }
}

#[rstest]
#[case::empty("", "the first line is missing")]
#[case::no_json("hello\n", "no line of a record")]
#[case::other_schema(r#"{"header":{"schema":"fsct-run/9","fsct":"9","seed":1,"dut":{"url":"","role":"device","vendor":"","product":"","version":"","pcos":[],"clock":"virtual","resolution_ns":1,"uncertainty_ns":0,"offers":[]},"profile":"","planned":0,"not_applicable":[],"tolerances":{}}}"#, "fsct-run/9")]
fn a_file_that_is_no_record_gets_one_clear_sentence(#[case] text: &str, #[case] says: &str) {
    let folder = Folder::new(&format!("bad-{}", says.len()));
    std::fs::write(folder.0.join(FILE), text).expect("it can be written");
    let error = read(&folder.0).expect_err("it is no record").to_string();
    assert!(error.contains(says), "{error}");
}

#[test]
fn a_bad_line_in_the_middle_is_named() {
    let folder = Folder::with("middle", &everything());
    let text = folder.text(FILE).replacen("\"case\"", "\"cake\"", 1);
    std::fs::write(folder.0.join(FILE), text).expect("it can be written");
    assert!(read(&folder.0).expect_err("line 2 is bad").to_string().contains("run.jsonl:2:"));
}

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
fn exit_codes(#[case] run: Run, #[case] code: u8) {
    assert_eq!(Summary::of(&run).exit_code(), code);
}

#[test]
fn junit_and_summary_look_like_this() {
    let folder = Folder::with("look", &everything());
    render(&folder.0).expect("the record is sound");
    assert_snapshot!("junit", folder.text("junit.xml"));
    assert_snapshot!("summary", folder.text("summary.json"));
}

#[test]
fn the_sequence_chart_looks_like_this() {
    let folder = Folder::with("chart", &run(vec![failed(2)]));
    render(&folder.0).expect("the record is sound");
    let html = folder.text("report.html");
    let (from, to) = (html.find("<svg").expect("a chart"), html.find("</svg>").expect("its end"));
    assert_snapshot!("chart", html[from..to + 6].replace("><", ">\n<"));
}

#[test]
fn text_from_a_dut_is_escaped_wherever_it_is_shown() {
    let mut run = run(vec![hostile(1)]);
    run.header.dut.product = HOSTILE.into();
    run.header.dut.vendor = HOSTILE.into();
    let folder = Folder::with("hostile", &run);
    render(&folder.0).expect("the record is sound");
    for name in ["report.html", "junit.xml"] {
        let text = folder.text(name);
        for hostile in ["<script", "\u{0}", "\u{1b}", "\u{fffe}", "\u{202e}"] {
            assert!(!text.contains(hostile), "{name} carries {hostile:?}");
        }
        assert!(text.contains("&lt;script&gt;alert(1)") && text.contains("\\u{202e}"), "{name} does not show it");
    }
    assert!(!folder.text("junit.xml").contains("]]>"));
}

#[test]
fn the_page_loads_nothing_and_runs_nothing() {
    let folder = Folder::with("page", &everything());
    render(&folder.0).expect("the record is sound");
    let html = folder.text("report.html");
    for word in ["<script", "http://", "https://", "<link", "<img", "url("] {
        assert!(!html.contains(word), "{word}");
    }
}

#[test]
fn ten_thousand_cases_are_less_than_five_megabytes() {
    let cases = (0..10_000)
        .map(|number| {
            // 400 ids with 25 points each; one in fifty failed.
            let mut case = if number % 50 == 7 { failed(number / 25) } else { passed(number / 25) };
            case.key = format!("{}[point={number}]", case.id);
            case.sweep.push(("point".into(), number.to_string()));
            case
        })
        .collect();
    let folder = Folder::with("large", &run(cases));
    render(&folder.0).expect("the record is sound");
    let size = folder.text("report.html").len();
    assert!(size < 5_000_000, "{size} octets");
}
