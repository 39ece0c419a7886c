//! `lib:`: shared libraries in C, and what becomes of a run when they misbehave.
#![cfg(unix)]

mod cli;

use cli::{Folder, Outcome, fsct};
use fsct_c::{DEVICE, Kind};
use rstest::rstest;

const MISBEHAVING: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/c/misbehaving.c");
/// Cases enough for the exchange that is meant to come in the middle, and once in the life of a process.
const SOME: [&str; 2] = ["--filter", "FSD-01"];

/// The example FS-Device inside a library that misbehaves so.
fn misbehaving(options: &[&str]) -> Option<String> {
    let options = [&["-Dfsct_dut=example_dut"], options].concat();
    let sources = [&[MISBEHAVING], DEVICE].concat();
    Some(format!("lib:{}", fsct_c::build(Kind::Library, &sources, &options)?.display()))
}

fn run(url: &str, out: &Folder) -> Outcome {
    fsct(&[&["run", "--dut", url, "--out", &out.out()], &SOME[..]].concat())
}

/// Cases of the record with this execution.
fn executed(out: &Folder, execution: &str) -> usize {
    out.text("run.jsonl").matches(&format!(r#""execution":"{execution}""#)).count()
}

#[rstest]
#[case::aborts("ABORT", "dut-error", "signal: 6 (SIGABRT)")]
#[case::crashes("CRASH", "dut-error", "signal: 11 (SIGSEGV)")]
#[case::is_killed("KILL", "dut-error", "signal: 9 (SIGKILL)")]
#[case::ends("EXIT", "dut-error", "exit status: 7")]
#[case::loops("LOOP", "timeout", "no complete answer within 500ms")]
#[case::floods("FLOOD", "timeout", "no complete answer within 500ms")]
#[case::sees_nothing("NULL_OBSERVATION", "dut-error", "an observation is a null pointer")]
#[case::points_to_nothing("NULL_OCTETS", "dut-error", "what octets of an observation points to is missing")]
#[case::makes_up_a_kind("UNKNOWN_KIND", "dut-error", "the kind of an observation is 99")]
fn a_library_that_misbehaves_costs_one_case(#[case] fault: &str, #[case] execution: &str, #[case] told: &str) {
    let Some(url) = misbehaving(&[&format!("-DFAULT={fault}"), "-DAT=700"]) else { return };
    let out = Folder::new(&format!("lib-{fault}"));
    let outcome = run(&format!("{url}?timeout=500ms"), &out);
    assert_eq!(outcome.code, 3, "{outcome:?}");
    assert!(outcome.err.contains(told), "{}", outcome.err);
    assert!(outcome.err.contains(&format!("{execution} FSD-01")), "the case is named: {}", outcome.err);
    assert_eq!(executed(&out, execution), 1, "one case is lost");
    assert!(executed(&out, "ok") > 50, "the others are judged");
    assert!(!out.text("run.jsonl").contains(r#""verdict":"fail""#), "nothing is held against the product");
}

#[test]
fn a_program_that_is_killed_costs_one_case() {
    let sources = [&[MISBEHAVING, "fsct_client.c"], DEVICE].concat();
    let options = ["-Dfsct_dut=example_dut", "-DFAULT=KILL", "-DAT=700", "-DPROGRAM", "-D_POSIX_C_SOURCE=200809L"];
    let Some(program) = fsct_c::build(Kind::Program, &sources, &options) else { return };
    let out = Folder::new("exec-kill");
    let outcome = run(&format!("exec:{}", program.display()), &out);
    assert_eq!(outcome.code, 3, "{outcome:?}");
    assert!(outcome.err.contains("dut-error FSD-01") && outcome.err.contains("signal: 9 (SIGKILL)"), "{}", outcome.err);
    assert_eq!((executed(&out, "dut-error"), executed(&out, "ok") > 50), (1, true));
}

#[test]
fn what_a_library_prints_is_no_frame() {
    let Some(url) = misbehaving(&["-DFAULT=PRINT", "-DAT=3"]) else { return };
    let out = Folder::new("lib-print");
    let outcome = run(&url, &out);
    assert_eq!(outcome.code, 0, "{outcome:?}");
}

#[rstest]
#[case::another_version(&["-DOTHER_ABI"], "was made for version 2 of fsct_dut.h, this fsct has version 1")]
#[case::no_apply(&["-DNO_APPLY"], "apply of its struct fsct_dut is a null pointer")]
fn a_library_that_is_no_dut(#[case] options: &[&str], #[case] told: &str) {
    let Some(url) = misbehaving(&[options, &["-DFAULT=NONE", "-DAT=0"]].concat()) else { return };
    refused(&url, told);
}

#[test]
fn a_library_without_the_function() {
    let Some(library) = fsct_c::build(Kind::Library, &["fs_crc.c"], &[]) else { return };
    refused(&format!("lib:{}", library.display()), "exports no function fsct_dut");
}

#[test]
fn a_file_that_is_no_library() {
    refused(&format!("lib:{MISBEHAVING}"), "cannot be loaded");
}

/// Nothing runs, and the axis says that it is the DUT's fault.
fn refused(url: &str, told: &str) {
    let out = Folder::new(&format!("lib-{}", told.len()));
    let outcome = run(url, &out);
    assert_eq!(outcome.code, 3, "{outcome:?}");
    assert!(outcome.err.contains(told), "{}", outcome.err);
    assert_eq!((executed(&out, "dut-error"), executed(&out, "ok")), (3, 0), "three tries, then given up");
}

#[test]
fn a_path_without_a_file_is_a_fault_of_the_rig() {
    let out = Folder::new("lib-nowhere");
    let outcome = run("lib:./no-such-library.so", &out);
    assert_eq!(outcome.code, 3, "{outcome:?}");
    assert!(outcome.err.contains("lib:./no-such-library.so cannot be reached: No such file"), "{}", outcome.err);
    assert_eq!(executed(&out, "rig-error"), 3);
}
