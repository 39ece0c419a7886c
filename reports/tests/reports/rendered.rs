//! JUnit and HTML: what they look like, hostile text, size.

use crate::common::*;
use fsct_reports::record::*;
use fsct_reports::{Run, Summary, render, visible};
use insta::assert_snapshot;
use rstest::rstest;

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
    assert_snapshot!("chart", svg(&folder.text("report.html")).replace("><", ">\n<"));
}

#[test]
fn the_chart_and_the_story_of_an_fs_master_look_like_this() {
    let folder = Folder::with("master-chart", &Run { header: both().header, ..run(vec![mastered(3)]) });
    render(&folder.0).expect("the record is sound");
    assert_snapshot!("master_chart", svg(&folder.text("report.html")).replace("><", ">\n<"));
    assert_snapshot!("master_junit", folder.text("junit.xml"));
}

#[test]
fn items_of_annex_i_show_what_supports_them_and_what_does_not() {
    let mut run = run(vec![passed(1), failed(2)]);
    let supported = EvidenceItem {
        clause: "I.2".into(),
        asks: "The layer is right".into(),
        cases: vec![
            ("scl-device".into(), vec!["device-startup".into()]),
            ("timing".into(), vec!["device-lines".into()]),
        ],
        documents: vec![("docs/assurance.md".into(), HOSTILE.into())],
        ..EvidenceItem::default()
    };
    let open = EvidenceItem { clause: "I.4".into(), gaps: vec!["The calculation".into()], ..EvidenceItem::default() };
    let classes = [("tested".to_owned(), 3), ("open".to_owned(), 1)].into();
    run.header.evidence = Some(Evidence { items: vec![supported, open], classes });
    let folder = Folder::with("annex-i", &run);
    render(&folder.0).expect("the record is sound");
    let html = folder.text("report.html");
    let table = html.split("<h2>Annex I</h2>").nth(1).and_then(|rest| rest.split("<h2>").next()).expect("a section");
    assert_snapshot!("annex_i", table.replace("><", ">\n<"));
    assert!(!table.contains("<script"));
}

#[test]
fn text_from_a_dut_is_escaped_wherever_it_is_shown() {
    let mut run = run(vec![hostile(1)]);
    let dut = DutInfo { profile: HOSTILE.into(), vendor: HOSTILE.into(), product: HOSTILE.into(), ..curtain() };
    run.header.duts = vec![DutInfo { role: HOSTILE.into(), offers: vec![HOSTILE.into()], ..dut }; 2];
    run.header.not_applicable.push((HOSTILE.into(), HOSTILE.into()));
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
fn a_name_of_ten_thousand_characters_does_not_fill_the_page() {
    let mut run = run(vec![passed(1)]);
    let small = Folder::with("small", &run);
    render(&small.0).expect("the record is sound");
    run.header.duts[0].product = "x".repeat(10_000);
    run.header.duts[0].version = "y".repeat(10_000);
    let folder = Folder::with("name", &run);
    render(&folder.0).expect("the record is sound");
    assert!(folder.text("report.html").len() < small.text("report.html").len() + 2_000);
}

/// The part of a page that is the first chart.
fn svg(html: &str) -> &str {
    let (_, html) = html.split_once("aria-label=\"Sequence chart\"").expect("a chart");
    let (from, to) = (html.find("<svg").expect("a chart"), html.find("</svg>").expect("its end"));
    &html[from..to + 6]
}

fn page(name: &str, run: &Run) -> String {
    let folder = Folder::with(name, run);
    render(&folder.0).expect("the record is sound");
    folder.text("report.html")
}

#[test]
fn a_long_chart_keeps_its_beginning_and_the_finding_and_says_what_is_left_out() {
    let mut case = long(1, 500);
    case.elided = 1_000;
    let html = page("long", &run(vec![case]));
    let chart = svg(&html);
    let tips = chart.matches("-4v8z").count();
    assert!((100..=120).contains(&tips), "{tips}");
    assert!(chart.contains("> lost<") || chart.contains(">lost<"));
    assert!(chart.contains("x 12") && chart.contains(">finding<"));
    assert!(chart.contains("1442 lines left out"), "{chart}");
}

#[test]
fn the_finding_stays_in_sight_when_a_long_trace_goes_on_behind_it() {
    let mut case = long(1, 500);
    case.reasons[0].entry = Some(250);
    let html = page("behind-it", &run(vec![case]));
    let chart = svg(&html);
    assert!(chart.contains(">finding<") && chart.contains("250.000 ms") && !chart.contains("499.000 ms"));
    assert_eq!(chart.matches("lines left out").count(), 2);
}

#[test]
fn an_fs_master_under_test_stands_on_the_left_and_is_decoded_as_one() {
    let mut run = run(vec![passed(1)]);
    run.header.duts = vec![gateway()];
    run.cases[0].role = "master".into();
    run.cases[0].transitions = [("T1".into(), 1)].into();
    run.cases[0].trace[1] = exchange(1, "A5FEE46AF6", "0001029D56", &["T1"], "");
    let html = page("master", &run);
    let chart = svg(&html);
    assert!(chart.contains("FS-Master (DUT)") && chart.contains("FS-Device (tester)"));
    assert!(chart.contains("DCount_i 7 SDset 1 PD") && chart.contains("MCount 0 setSD 1 SD"));
    assert!(html.contains("1 of 14 were taken") && html.contains("0 of 6 were taken"));
}

#[test]
fn a_run_of_several_duts_tells_them_apart() {
    let html = page("both", &both());
    for text in [
        "<h1>IO-Link Safety conformance: Curtain 3000, Gateway 8</h1>",
        "<h2>DUT 1 (Curtain 3000): FS-Device</h2>",
        "<h2>DUT 2 (Gateway 8): FS-Master</h2>",
        "<code>unix:/run/gateway</code>",
        "<dd>gateway-of-8</dd>",
        "<p>On DUT 1 (Curtain 3000)</p>",
        "<p>On DUT 2 (Gateway 8)</p>",
        "FSM-0003</span> Start-up of both sides · DUT 2 (Gateway 8) · ",
        "<h3>FS-Device</h3><p>2 of 12 were taken",
        "<h3>FS-Master</h3><p>1 of 14 were taken",
        "<h3>OSSDe qualifier</h3><p>2 of 6 were taken",
        "OSSDe T3</span> × 2",
    ] {
        assert!(html.contains(text), "{text}");
    }
    let one = page("one", &everything());
    assert!(one.contains("<h2>Device under test: FS-Device</h2>") && one.contains("<h3>FS-Device</h3>"));
    assert!(!one.contains("DUT 1") && !one.contains("<p>On ") && !one.contains("<h3>FS-Master</h3>"));
}

#[test]
fn the_same_case_on_two_duts_is_not_one() {
    let mut cases: Vec<CaseRecord> = (0..10).map(|_| failed(2)).collect();
    cases[5..].iter_mut().for_each(|case| case.dut = 1);
    let mut again = run(cases);
    again.header.duts.push(DutInfo { product: String::new(), ..curtain() });
    let html = page("twice", &again);
    assert!(html.contains("FSD-0002</span> Start-up of both sides · DUT 1 (Curtain 3000) · "));
    assert!(html.contains("FSD-0002</span> Start-up of both sides · DUT 2 · "));
    assert!(html.contains("2 more of FSD-0002 like these · DUT 1 (Curtain 3000)"));
    assert!(html.contains("2 more of FSD-0002 like these · DUT 2<"));
    assert!(html.contains("<h3>FS-Device<span class=\"soft\"> · 2 DUTs together</span></h3>"));
}

#[test]
fn cases_not_begun_are_told_apart_by_dut() {
    let mut cases: Vec<CaseRecord> = (1..=3).map(|number| lost(number, Execution::Aborted)).collect();
    cases.iter_mut().for_each(|case| case.trace.clear());
    cases[2].dut = 1;
    let html = page("not-begun-both", &Run { header: both().header, ..run(cases) });
    assert!(html.contains("! 2 cases</span> · DUT 1 (Curtain 3000): ") && html.contains("! 1 cases</span> · DUT 2 ("));
}

#[test]
fn a_dut_the_header_does_not_name_is_said_to_be_unknown() {
    let unknown = CaseRecord { dut: usize::MAX, ..failed(2) };
    let folder = Folder::with("unknown", &run(vec![unknown]));
    render(&folder.0).expect("the record is sound");
    let says = format!("DUT {}, which the header does not name", usize::MAX);
    assert!(folder.text("report.html").contains(&says));
    assert!(folder.text("junit.xml").contains(&format!(r#"<property name="dut" value="{says}"/>"#)));
}

/// The values of a property of the suites and of the test cases of a report.
fn properties(xml: &str, name: &str) -> Vec<Vec<String>> {
    let begin = format!(r#"<property name="{name}" value=""#);
    let values =
        |text: &str| text.split(&begin).skip(1).map(|it| it[..it.find('"').expect("its end")].to_owned()).collect();
    xml.split("<testsuite ").skip(1).map(values).collect()
}

#[test]
fn a_suite_of_junit_names_the_duts_its_cases_are_about() {
    let mut mixed = mastered(4);
    mixed.suite = "device-startup".into();
    let mut several = both();
    several.cases.push(mixed);
    several.header.duts.push(curtain());
    let folder = Folder::with("properties", &several);
    render(&folder.0).expect("the record is sound");
    let xml = folder.text("junit.xml");
    let (curtain, gateway) = ("DUT 1: Curtain 3000 hw 1 sw 2", "DUT 2: Gateway 8 fw 9");
    // First what the suite says, then each of its cases.
    let device = [curtain, gateway, curtain, curtain, gateway].map(String::from).to_vec();
    assert_eq!(properties(&xml, "dut"), [device, [gateway; 2].map(String::from).to_vec(), vec![]]);
    let urls = |urls: &[&str]| urls.iter().map(|url| (*url).to_owned()).collect::<Vec<_>>();
    let (tcp, unix) = ("tcp://192.0.2.1:7000", "unix:/run/gateway");
    assert_eq!(properties(&xml, "url"), [urls(&[tcp, unix]), urls(&[unix]), vec![]]);
    assert_eq!(properties(&xml, "profile"), [urls(&["curtain", "gateway-of-8"]), urls(&["gateway-of-8"]), vec![]]);
}

#[test]
fn a_run_of_one_dut_names_it_once_a_suite() {
    let folder = Folder::with("property", &run(vec![passed(1), failed(2)]));
    render(&folder.0).expect("the record is sound");
    let curtain = vec!["Curtain 3000 hw 1 sw 2".to_owned()];
    assert_eq!(properties(&folder.text("junit.xml"), "dut"), [curtain.clone(), curtain]);
}

/// Left of the FS-Master there is room for 14 characters, twice.
#[rstest]
#[case::one(&["T1"], &["T1"])]
#[case::both_machines(&["T1", "OSSDe T1"], &["T1 OSSDe\u{A0}T1"])]
#[case::a_name_is_not_broken(&["T12", "T13", "OSSDe T1"], &["T12 T13", "OSSDe\u{A0}T1"])]
#[case::too_many(&["OSSDe T1", "OSSDe T2", "OSSDe T3", "OSSDe T4"], &["OSSDe\u{A0}T1", "OSSDe\u{A0}T2 OSSD…"])]
fn transitions_of_an_fs_master_stand_left_of_it(#[case] via: &[&str], #[case] lines: &[&str]) {
    let trace = vec![
        exchange(1, "A5FEE46AF6", "0001029D56", via, ""),
        Entry { at: 0, ..entry(1, What::Power { on: true }, via) },
    ];
    let case = CaseRecord { role: "master".into(), trace, steps: Vec::new(), ..passed(1) };
    let html = page(&format!("beside-{}-{}", via.len(), lines.concat().len()), &run(vec![case]));
    let shown = svg(&html).split(r#"text-anchor="end">"#).skip(1);
    let shown: Vec<&str> = shown.map(|text| &text[..text.find('<').expect("its end")]).collect();
    assert_eq!(shown, [lines, lines].concat());
}

/// A box stands at the lifeline of the side that acted: 190 is the FS-Master's, 640 the FS-Device's.
#[rstest]
#[case::by_an_fs_master_under_test("master", true, 190)]
#[case::by_the_tester_of_an_fs_master("master", false, 640)]
#[case::by_an_fs_device_under_test("device", true, 640)]
#[case::by_the_tester_of_an_fs_device("device", false, 190)]
fn a_box_stands_at_the_side_that_acted(#[case] role: &str, #[case] dut: bool, #[case] lifeline: i32) {
    let trace = vec![on_port(1, 1, dut, "L+ on")];
    let case = CaseRecord { role: role.into(), trace, steps: Vec::new(), ..passed(1) };
    let html = page(&format!("side-{role}-{dut}"), &run(vec![case]));
    let chart = svg(&html);
    assert!(chart.contains(&format!(r#"<rect x="{}""#, lifeline + 6)), "{chart}");
    assert!(chart.contains(&format!(r#"<text x="{}" y="60">L+ on</text>"#, lifeline + 12)), "{chart}");
}

/// A port is named when it is another than 1, or when the case uses several.
#[rstest]
#[case::port_1_alone(vec![exchange(1, "00", "00", &[], ""), on_port(2, 1, true, "L+ on")], &["L+ on"], "port")]
#[case::another_port_alone(vec![on_port(2, 3, true, "L+ on")], &["port 3 · L+ on"], "port 1")]
#[case::two_ports(vec![on_port(1, 1, true, "L+ on"), on_port(2, 2, true, "L+ on")], &["port 1 · L+ on", "port 2 · L+ on"], "port 3")]
#[case::exchange(vec![entry(1, What::Exchange { port: 2, sent: None, got: None }, &[])], &["port 2 · lost", "port 2 · no process data"], "port 1")]
#[case::service(vec![entry(1, What::Service { port: 2, service: "qualifier".into(), value: "01".into() }, &[])], &["port 2 · qualifier = 01"], "port 1")]
#[case::a_service_of_a_port_that_is_not_used(vec![entry(1, What::Service { port: 1, service: "SDset_S".into(), value: "01".into() }, &[]), entry(1, What::Service { port: 2, service: "FAULTS_S".into(), value: "00".into() }, &[]), on_port(2, 1, true, "L+ on")], &["SDset_S = 01", "port 2 · FAULTS_S = 00", "L+ on"], "port 1")]
#[case::the_whole_dut(vec![entry(1, What::Set { port: 0, service: "FSCP_Authenticity".into(), value: "01".into() }, &[]), on_port(2, 1, true, "L+ on")], &["whole DUT · FSCP_Authenticity := 0", "L+ on"], "port 1")]
fn a_port_is_named_where_it_says_something(#[case] trace: Vec<Entry>, #[case] says: &[&str], #[case] silent: &str) {
    let case = CaseRecord { role: "master".into(), trace, steps: Vec::new(), ..failed(1) };
    let folder = Folder::with(&format!("ports-{}", says.concat().len()), &run(vec![case]));
    render(&folder.0).expect("the record is sound");
    let html = folder.text("report.html");
    let xml = folder.text("junit.xml");
    let (_, story) = xml.split_once("entries 1 to ").expect("the trace is told");
    let (story, _) = story.split_once("replay").expect("its end");
    for text in [svg(&html), story] {
        assert!(says.iter().all(|says| text.contains(says)), "{text}");
        assert!(!text.contains(silent), "{text}");
    }
}

#[test]
fn a_long_request_through_the_smi_is_cut_in_the_chart_and_told_in_full() {
    let (request, result) = (format!("SMI_PortConfiguration port 1 {}", "81".repeat(200)), "90".repeat(25));
    let smi = What::Smi { request, result: format!("Result(+) {result}") };
    let case =
        CaseRecord { role: "master".into(), trace: vec![entry(1, smi, &["T1"])], steps: Vec::new(), ..failed(1) };
    let folder = Folder::with("smi", &run(vec![case]));
    render(&folder.0).expect("the record is sound");
    let html = folder.text("report.html");
    let chart = svg(&html);
    let lines: Vec<&str> = chart.split(r#"<text x="202""#).skip(1).collect();
    assert_eq!(lines.len(), 5, "{chart}");
    assert!(lines[0].contains(">SMI_PortConfiguration port 1</text>") && lines[2].contains("8…</text>"), "{chart}");
    assert!(lines[3].contains(">Result(+) 90") && lines[4].contains("90</text>"), "{chart}");
    assert!(
        folder
            .text("junit.xml")
            .contains(&format!("> SMI_PortConfiguration port 1 {}", "81".repeat(200)).replace('>', "&gt;"))
    );
}

#[test]
fn the_page_says_what_failed_where_and_how_to_run_it_again() {
    let html = page("tells", &everything());
    for text in [
        "Evidence for an assessment, not a certificate",
        "Not conformant",
        "R-11.5.4.1-01 (clause 11.5.4.1, shall)",
        "11.5.3 Table 40 T25",
        "DCommErr 1 (after T24 T25 T26)",
        "CRC wrong: 5726, computed 5727",
        "fsct run --seed 7 --filter 'FSD-0001[..]'",
        "tolerated: T29 read sequentially",
        "the DUT does not serve `app`",
        "</span> never",
        "2 of 12 were taken",
    ] {
        assert!(html.contains(text), "{text}");
    }
    let at = |title: &str| html.find(title).unwrap_or_else(|| panic!("{title}"));
    assert!(at("Failures (1)") < at("Not executed as meant (1)"));
    assert!(at("Not executed as meant (1)") < at("Inconclusive (1)") && at("Inconclusive (1)") < at("Remarks (1)"));
    assert!(at("Remarks (1)") < at("All cases"));
}

#[test]
fn cases_never_tried_take_one_line_a_reason() {
    let mut cases: Vec<CaseRecord> = (2..40).map(|number| lost(number, Execution::Aborted)).collect();
    cases.iter_mut().for_each(|case| case.trace.clear());
    cases.push(lost(1, Execution::Timeout));
    let html = page("not-begun", &run(cases));
    assert!(html.contains("Not begun (38)") && html.contains("Not executed as meant (1)"));
    assert_eq!(html.matches("<section class=\"case\"").count(), 1);
}

#[test]
fn a_partial_record_says_so() {
    let html = page("partial", &Run { footer: None, header: header(3), ..run(vec![passed(1)]) });
    assert!(html.contains("This record is partial") && html.contains("1 of 3 cases are in it"));
}

#[test]
fn test_cases_of_junit_are_unique_and_none_is_dropped() {
    let mut odd = passed(2);
    odd.suite = "not-applicable".into();
    let folder = Folder::with("unique", &run(vec![passed(1), passed(1), odd]));
    render(&folder.0).expect("the record is sound");
    let xml = folder.text("junit.xml");
    assert_eq!(xml.matches("<testcase ").count(), 4);
    assert!(xml.contains("pd=1] #2\""));
}

/// A gate that reads JUnit is green for a pass, a remark and what does not apply, and for nothing else.
#[rstest]
#[case::passed(Verdict::Pass, Execution::Ok, None)]
#[case::remarked(Verdict::Remark, Execution::Ok, None)]
#[case::left_out(Verdict::NotApplicable, Execution::Ok, Some("<skipped message="))]
#[case::failed(Verdict::Fail, Execution::Ok, Some(r#"type="oracle/DCommErr">"#))]
#[case::open(Verdict::Inconclusive, Execution::Ok, Some(r#"type="inconclusive">"#))]
#[case::passed_till_it_was_lost(Verdict::Pass, Execution::RigError, Some(r#"type="rig-error">"#))]
#[case::left_out_by_a_fault_of_the_tool(Verdict::NotApplicable, Execution::ToolError, Some(r#"type="tool-error">"#))]
#[case::broke_the_contract(Verdict::Inconclusive, Execution::DutError, Some(r#"type="dut-error">"#))]
#[case::failed_till_it_was_lost(Verdict::Fail, Execution::Timeout, Some(r#"type="timeout">"#))]
fn junit_has_one_outcome_a_verdict(#[case] verdict: Verdict, #[case] execution: Execution, #[case] says: Option<&str>) {
    let mut run = run(vec![CaseRecord { verdict, execution, ..failed(1) }]);
    run.header.not_applicable.clear();
    let folder = Folder::with(&format!("outcome-{verdict:?}-{execution:?}"), &run);
    render(&folder.0).expect("the record is sound");
    let xml = folder.text("junit.xml");
    let skipped = usize::from((verdict, execution) == (Verdict::NotApplicable, Execution::Ok));
    let failures = usize::from(verdict == Verdict::Fail);
    let errors = usize::from(says.is_some()) - skipped - failures;
    assert_eq!(xml.matches("<skipped").count(), skipped, "{xml}");
    assert_eq!(xml.matches("<failure ").count(), failures, "{xml}");
    assert_eq!(xml.matches("<error ").count(), errors, "{xml}");
    assert!(says.is_none_or(|says| xml.contains(says)), "{xml}");
}

#[test]
fn the_message_of_a_failure_is_short_and_its_body_has_it_all() {
    let mut case = failed(1);
    case.reasons[0].observed = "x".repeat(5_000);
    case.reasons[0].kind = HOSTILE.into();
    let folder = Folder::with("message", &run(vec![case]));
    render(&folder.0).expect("the record is sound");
    let xml = folder.text("junit.xml");
    let (_, message) = xml.split_once("<failure message=\"").expect("a failure");
    let (message, _) = message.split_once('"').expect("its end");
    assert_eq!(message.chars().count(), 300);
    assert!(message.ends_with("xxx…"));
    assert!(xml.contains(&"x".repeat(5_000)));
    assert!(xml.contains(r#"type="&lt;script"#) && !xml.contains(['\u{1b}', '\u{fffe}']));
}

#[test]
fn a_failure_is_told_with_what_came_before_and_after_it() {
    let mut case = long(1, 50);
    case.reasons[0].entry = Some(20);
    let folder = Folder::with("around", &run(vec![case]));
    render(&folder.0).expect("the record is sound");
    let xml = folder.text("junit.xml");
    assert!(xml.contains("entries 13 to 24 of 50") && xml.contains("=&gt;      20.000 ms"), "{xml}");
    assert!(xml.contains(" 12.000 ms") && xml.contains(" 23.000 ms"));
    assert!(!xml.contains(" 11.000 ms") && !xml.contains(" 24.000 ms"));
}

#[test]
fn reports_replace_those_of_before_and_leave_nothing_beside_them() {
    let folder = Folder::with("again", &everything());
    for _ in 0..2 {
        assert_eq!(render(&folder.0).expect("the record is sound"), Summary::of(&everything()));
    }
    let entries = std::fs::read_dir(&folder.0).expect("it is there");
    let mut names: Vec<_> = entries.map(|entry| entry.expect("it can be read").file_name()).collect();
    names.sort();
    assert_eq!(names, ["junit.xml", "report.html", "run.jsonl", "summary.json"]);
}

#[rstest]
fn characters_that_hide_reorder_or_break_are_shown_as_escapes(
    #[values(
        '\0',
        '\u{8}',
        '\r',
        '\u{1b}',
        '\u{7f}',
        '\u{9b}',
        '\u{61c}',
        '\u{200b}',
        '\u{200f}',
        '\u{2028}',
        '\u{202e}',
        '\u{2066}',
        '\u{feff}',
        '\u{e0001}',
        '\u{fffe}',
        '\u{ffff}'
    )]
    hostile: char,
) {
    assert_eq!(visible(&format!("a{hostile}b")), format!("a\\u{{{:x}}}b", u32::from(hostile)));
}

#[rstest]
fn other_characters_stay(#[values('\n', '\t', ' ', '<', 'é', '€', '\u{fffd}', '\u{fffc}', '😀')] harmless: char) {
    assert_eq!(visible(&harmless.to_string()), harmless.to_string());
}

#[test]
fn positions_a_record_cannot_mean_are_shown_without_harm() {
    let mut case = failed(1);
    case.reasons[0].entry = Some(usize::MAX);
    case.reasons[0].step = usize::MAX;
    case.steps[0].entries = (usize::MAX, 0);
    case.trace[0].at = u64::MAX;
    case.elided = u64::MAX;
    case.duration_ns = u64::MAX;
    case.transitions.insert("T22".into(), u64::MAX);
    case.variant = VariantInfo { mode: "crc99".into(), pd_out: 255, pd_in: 255, ..VariantInfo::default() };
    page("odd", &run(vec![case.clone(), case]));
}

#[rstest]
#[case::short_traces_of_400_ids(25, 3)]
#[case::long_traces_of_400_ids(25, 200)]
#[case::long_traces_each_an_id(1, 60)]
fn ten_thousand_cases_are_less_than_five_megabytes(#[case] points: usize, #[case] entries: u64) {
    let cases = (0..10_000)
        .map(|number| {
            // One case in fifty failed.
            let mut case = if number % 50 == 7 { long(number / points, entries) } else { passed(number / points) };
            case.trace = if entries > 3 { long(1, entries).trace } else { case.trace };
            case.key = format!("{}[point={number}]", case.id);
            case.sweep.push(("point".into(), number.to_string()));
            case
        })
        .collect();
    let html = page(&format!("large-{points}-{entries}"), &run(cases));
    assert!(html.len() < 5_000_000, "{} octets", html.len());
    assert!(html.contains("FSD-0000") && html.contains("Failures (200)"));
}

#[test]
fn ten_thousand_cases_of_two_duts_with_long_requests_are_less_than_five_megabytes() {
    let smi = What::Smi { request: "52".repeat(100), result: "61".repeat(100) };
    let cases = (0..10_000)
        .map(|number| {
            let mut case = if number % 50 == 7 { mastered(number / 25) } else { passed(number / 25) };
            case.dut = number % 2;
            case.trace = (0..20).map(|at| entry(at, smi.clone(), &["T1", "OSSDe T1"])).collect();
            case.key = format!("{}[point={number}]", case.id);
            case
        })
        .collect();
    let html = page("large-both", &Run { header: Header { planned: 10_000, ..both().header }, ..run(cases) });
    assert!(html.len() < 5_000_000, "{} octets", html.len());
    assert!(html.contains("Failures (200)") && html.contains("<p>On DUT 2 (Gateway 8)</p>"));
}

/// The matrix of an FS-Device with one class and two columns.
fn matrix(cases: &[&str], none: &str) -> Vec<MatrixInfo> {
    let shown = MatrixCell { cases: cases.iter().map(|id| (*id).to_owned()).collect(), none: String::new() };
    let empty = MatrixCell { cases: Vec::new(), none: none.to_owned() };
    let row = MatrixRow { class: "corruption".into(), cells: vec![shown, empty] };
    vec![MatrixInfo { role: "device".into(), columns: vec!["to DUT".into(), "from DUT".into()], rows: vec![row] }]
}

#[test]
fn a_cell_of_the_error_matrix_counts_the_verdicts_of_its_cases() {
    let mut run = run(vec![passed(1), passed(1), failed(1), mastered(1)]);
    let id = run.cases[0].id.clone();
    run.cases[3].id = id.clone();
    run.header.matrix = matrix(&[&id, "FSD-9999"], "nothing is sent");
    let html = page("matrix", &run);
    let cell = format!(r#"<div>{id} <span class="pass">✓ pass × 2</span> <span class="fail">✗ fail × 1</span></div>"#);
    assert!(html.contains(&cell), "{html}");
    assert!(html.contains(r#"<div>FSD-9999 <span class="soft">not run</span></div>"#));
    assert!(html.contains("none, see 1") && html.contains("<li>nothing is sent</li>"));
}

#[test]
fn the_error_matrix_stays_in_the_record_and_is_not_shown_where_there_is_none() {
    let mut run = run(vec![passed(1)]);
    assert!(!page("no-matrix", &run).contains("Error matrix"));
    assert!(!serde_json::to_string(&run.header).expect("it is plain").contains("matrix"));
    run.header.matrix = matrix(&[HOSTILE], HOSTILE);
    let text = serde_json::to_string(&run.header).expect("it is plain");
    assert_eq!(serde_json::from_str::<Header>(&text).expect("it was just written"), run.header);
    assert!(!page("hostile-matrix", &run).contains("<script>"));
}
