//! The command line that cargo test and nextest speak, on the example with a faulty device.

use std::path::PathBuf;
use std::process::Command;

const CASE: &str = "FSD-0201[edition=iec2022,mode=crc16,pd=2]";

/// Exit code and what was printed on stdout.
fn faulty(arguments: &[&str]) -> (Option<i32>, String) {
    let mut program: PathBuf = std::env::current_exe().expect("a test has a path");
    program.pop();
    program.pop();
    let program = program.join("examples").join(format!("faulty{}", std::env::consts::EXE_SUFFIX));
    let output = Command::new(&program).args(arguments).output();
    let output = output.unwrap_or_else(|error| panic!("{error}; `cargo test` without --test builds {program:?}"));
    (output.status.code(), String::from_utf8(output.stdout).expect("UTF-8"))
}

#[test]
fn a_list_names_every_case_and_marks_those_that_do_not_apply() {
    let (code, all) = faulty(&["--list", "--format", "terse"]);
    assert_eq!(code, Some(0));
    assert!(all.lines().any(|line| line == format!("{CASE}: test")), "{all}");
    let (_, ignored) = faulty(&["--list", "--format", "terse", "--ignored"]);
    assert!(ignored.lines().all(|line| line.starts_with("FSM-")) && !ignored.is_empty(), "{ignored}");
    assert!(ignored.lines().all(|line| all.contains(line)));
}

#[test]
fn an_exact_name_runs_one_case_and_fails_the_process() {
    let (code, text) = faulty(&[CASE, "--exact", "--nocapture"]);
    assert_eq!(code, Some(101));
    assert!(text.contains("running 1 test\n") && text.contains("expected signature B773"), "{text}");
}

#[test]
fn an_id_is_a_filter() {
    let (code, text) = faulty(&["FSD-0201"]);
    assert_eq!(code, Some(101));
    assert!(text.contains("running 2 tests\n"), "{text}");
}

#[test]
fn what_does_not_apply_is_ignored_with_the_term_and_never_passed() {
    let (_, text) = faulty(&["FSM-"]);
    assert!(text.contains("ignored (not applicable: the case is for a master, the DUT is a device)"), "{text}");
    assert!(text.contains(" 0 passed; 0 failed;"), "{text}");
    let (_, text) = faulty(&["FSM-", "--ignored"]);
    assert!(text.contains(" 0 passed;") && !text.contains(" 0 failed;"), "{text}");
}
