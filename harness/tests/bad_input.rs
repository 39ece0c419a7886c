//! Bad files get one clear sentence with place and remedy, and several at once where the parser allows.

use fsct_harness::case;
use fsct_harness::library::Library;
use fsct_harness::matrix::Matrix;
use fsct_harness::problem::{Problem, Source};
use fsct_harness::profile::Profile;
use fsct_harness::yaml;
use insta::assert_snapshot;
use rstest::rstest;
use std::sync::Arc;

fn source(text: &str) -> Arc<Source> {
    Arc::new(Source { name: "my.yaml".into(), text: text.into() })
}

fn told(problems: Vec<Problem>) -> String {
    problems.iter().map(|problem| problem.render(false)).collect::<Vec<_>>().join("\n\n")
}

/// A sound case around the keys and steps under test.
fn suite(keys: &str, steps: &str) -> String {
    format!(
        "suite: my\nabout: mine\ncases:\n  - id: MY-0001\n    title: Mine\n    requirements: [R-11.5.3-09]\n    dut: device\n{keys}    start: operate\n    steps:\n{steps}"
    )
}

/// What reading and decoding a suite says.
fn problems(text: &str) -> Vec<Problem> {
    match case::suite(&source(text)) {
        Err(problems) => problems,
        Ok(suite) => {
            let case = suite.cases.first().expect("one case");
            let points = case.expand(&fsct_harness::library::EVERYTHING).expect("few points").points;
            let mut problems = Vec::new();
            case.steps(points.first().expect("a point"), &mut problems);
            problems
        }
    }
}

#[test]
fn a_misspelt_key_is_named_with_its_place() {
    assert_snapshot!(told(problems(&suite("    sweeps: {x: [1]}\n", "      - exchange: {}\n"))));
}

#[test]
fn a_misspelt_field_of_an_spdu_is_named_with_its_place() {
    assert_snapshot!(told(problems(&suite("", "      - exchange: {MCont: 3}\n        expect: {SDset: 1}\n"))));
}

#[test]
fn all_problems_of_a_file_come_at_once() {
    let steps = "      - exchange: {corrupt: dta, MCount: 9}\n        expect: {SDst: 1, DCount_i: 8}\n      - wait: {until: 3 parsecs}\n      - power: maybe\n      - exchange: {PDout: 5}\n        power: \"on\"\n";
    assert_snapshot!(told(problems(&suite("", steps))));
}

#[test]
fn a_duplicate_key_is_refused() {
    assert_snapshot!(told(problems(&suite("", "      - exchange: {}\n        expect: {SDset: 1, SDset: 0}\n"))));
}

#[test]
fn broken_yaml_is_refused_with_its_place() {
    assert_snapshot!(told(problems("suite: my\n  about: [mine\n")));
}

#[test]
fn an_unknown_sweep_variable_is_named() {
    assert_snapshot!(told(problems(&suite("    sweep: {flip: [1, 2]}\n", "      - exchange: {corrupt: $flop}\n"))));
}

#[test]
fn words_that_exclude_each_other_are_refused() {
    assert_snapshot!(told(problems(&suite(
        "",
        "      - exchange: {times: 3, repeat: 2}\n        expect: {SDset: 1}\n"
    ))));
}

#[test]
fn a_watchdog_shorter_than_a_cycle_is_refused() {
    let text = "profile: mine\ndut: device\nFSP_Watchdog_ms: 2\nMasterCycleTime_us: 5000\n";
    assert_snapshot!(told(Profile::parse(&source(text)).expect_err("it cannot run")));
}

#[test]
fn a_profile_says_what_it_does_not_know() {
    let text = "profile: mine\ndut: devize\nFSP_Port: 0\nFSP_Wachdog_ms: 20\nstrict: [A99]\n";
    assert_snapshot!(told(Profile::parse(&source(text)).expect_err("it is wrong")));
}

#[rstest]
#[case::aliases(&format!("a: &a [1,1,1,1,1,1,1,1,1]\n{}", ('b'..='j').map(|c| { let p = (c as u8 - 1) as char; format!("{c}: &{c} [*{p},*{p},*{p},*{p},*{p},*{p},*{p},*{p},*{p}]\n") }).collect::<String>()))]
#[case::brackets(&"[".repeat(20_000))]
#[case::braces(&"{a: ".repeat(20_000))]
#[case::nodes(&"- 1\n".repeat(500_000))]
#[case::nothing("")]
#[case::two_documents("a: 1\n---\nb: 2\n")]
#[case::a_number("5")]
fn a_hostile_file_is_an_error_and_not_memory(#[case] text: &str) {
    let told = match yaml::parse(&source(text)) {
        Err(problem) => vec![problem],
        Ok(_) => case::suite(&source(text)).expect_err("it is no suite"),
    };
    assert!(!told.is_empty());
    assert!(told.iter().all(|problem| problem.place().starts_with("my.yaml")));
}

#[test]
fn a_file_of_100_mb_is_not_read() {
    let path = std::env::temp_dir().join(format!("fsct-large-{}.yaml", std::process::id()));
    let file = std::fs::File::create(&path).expect("the folder for temporary files can be written");
    file.set_len(100 << 20).expect("a sparse file takes no room");
    let problem = yaml::load(&path).expect_err("too large");
    std::fs::remove_file(&path).expect("it was made above");
    assert!(problem.message().contains("104857600 octets"), "{problem}");
}

#[test]
fn the_embedded_cases_are_sound() {
    let library = Library::embedded().unwrap_or_else(|problems| panic!("{}", told(problems)));
    let problems = library.check();
    assert!(problems.is_empty(), "{}", told(problems));
    assert_eq!(library.ledger.iter().count(), 1_139, "nothing of the ledger is dropped");
}

#[rstest]
#[case("{event: 0xB003 or B005}", "`0xB003 or B005` is no value of `event`: EventCodes such as `0xB003 or 0xB005`")]
#[case("{event.type: Error or Fatal}", "`Error or Fatal` is no value of `event.type`: Notification, Warning, Error")]
#[case("{reply: FSP_Prot 1 to 2}", "`FSP_Prot 1 to 2` is neither a known word")]
#[case("{reply: contains 4001x}", "`contains 4001x` is neither a known word")]
fn an_expectation_of_on_request_data_says_what_it_takes(#[case] expect: &str, #[case] sentence: &str) {
    let steps = format!("      - parameterize: {{corrupt: 184}}\n        expect: {expect}\n");
    let told = told(problems(&suite("", &steps)));
    assert!(told.contains(sentence), "{told}");
    assert!(told.contains("`184` is no bit of FSP_VerifyRecord, 0 to 183 are"), "{told}");
}

#[rstest]
#[case("", true)]
#[case("    sweep: {edition: [v1.1, iec2022]}\n", true)]
#[case("    sweep: {edition: [iec2022]}\n", false)]
fn no_case_writes_the_passwords_of_v1_1(#[case] keys: &str, #[case] refused: bool) {
    let mut library = Library::embedded().unwrap_or_else(|problems| panic!("{}", told(problems)));
    let steps = "      - write: {index: 0x4211, data: 00 64}\n        expect: {reply: refused}\n";
    library
        .suites
        .push(case::suite(&source(&suite(keys, steps))).unwrap_or_else(|problems| panic!("{}", told(problems))));
    assert_eq!(told(library.check()).contains("which are passwords in v1.1"), refused);
}

#[test]
fn a_misspelt_word_of_the_way_back_is_named_with_its_place() {
    let steps = "      - exchange: {image: 8 ago, MCount: bit 3}\n        expect: {SDset: 1}\n      - partner: {back: corupt}\n      - partner: {back: 0 ago, within: 3 parsecs}\n      - partner: {for: 20 ms}\n";
    assert_snapshot!(told(problems(&suite("", steps))));
}

/// The embedded matrix with one text replaced, checked against the embedded suites.
fn matrix(from: &str, to: &str) -> String {
    let library = Library::embedded().unwrap_or_else(|problems| panic!("{}", told(problems)));
    let text = include_str!("../../testcases/error-matrix.yaml");
    assert!(text.contains(from));
    let problems = match Matrix::parse(&source(&text.replacen(from, to, 1))) {
        Err(problems) => problems,
        Ok(matrix) => {
            let mut problems = Vec::new();
            matrix.check(&library.suites, &mut problems);
            problems
        }
    };
    told(problems)
}

#[test]
fn a_hole_in_the_error_matrix_is_named() {
    assert_snapshot!(matrix("        24: [FSD-1502, FSD-1503]\n", ""));
}

#[test]
fn a_case_that_is_not_there_and_one_that_stands_nowhere_are_named() {
    assert_snapshot!(matrix("21: FSD-1501", "21: FSD-1591"));
}

#[test]
fn an_empty_cell_of_the_error_matrix_says_why() {
    assert_snapshot!(matrix("21: FSD-1501", "21: {}"));
}

#[test]
fn a_class_that_the_error_matrix_lacks_is_named() {
    assert_snapshot!(matrix("    corruption:", "    corrosion:"));
}

#[test]
fn a_limit_says_what_is_wrong_with_it() {
    let text = "
- symbol: t_RP
  about: width of the Ready pulse
  dut: devise
  unit: mikro
  v1.1: {min: 1000, max: 500, clause: \"5.4\"}
  iec2022: {min: much, base: perhaps}
  open: L1
  verify: measured
- symbol: t_RW
  about: nothing said
  dut: device
  unit: us
  verify: measured
";
    let problems = fsct_harness::limits::parse(&source(text)).expect_err("it is full of mistakes");
    let told = told(problems);
    for what in
        ["devise", "mikro", "exceeds the largest", "`min` has to be a number", "perhaps", "`L1`", "needs the values"]
    {
        assert!(told.contains(what), "{what}: {told}");
    }
}

#[test]
fn a_limit_stands_once_and_names_what_there_is() {
    let limit = "
- symbol: t_RP
  about: width of the Ready pulse
  dut: device
  unit: V
  v1.1: {max: 1000, clause: \"5.4\"}
  verify: measured
  requirements: R-5.4-112
";
    let twice = fsct_harness::limits::parse(&source(&limit.repeat(2))).expect_err("it stands twice");
    let once = fsct_harness::limits::parse(&source(limit)).expect("it reads");
    let mut problems = Vec::new();
    once.check(&Library::embedded().expect("sound").ledger, &mut problems);
    let told = told(twice.into_iter().chain(problems).collect());
    for what in ["there is a limit `t_RP` already", "unknown requirement `R-5.4-112`", "has no limit `t_RP` in a unit"]
    {
        assert!(told.contains(what), "{what}: {told}");
    }
}
