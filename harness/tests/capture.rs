//! `fsct capture`: what a recording shows is judged as it was live.

mod cli;

use cli::{Folder, Outcome, fsct};
use rstest::rstest;
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};

/// Runs the line cases on a simulator that writes its lines; the record, and the file.
fn live(name: &str, mutant: Option<&str>) -> (Folder, String, Outcome) {
    let folder = Folder::new(&format!("capture-live-{name}"));
    let vcd = folder.0.join("lines.vcd").display().to_string();
    let binary = assert_cmd::cargo::cargo_bin("fsct");
    let mutant = mutant.map(|name| format!("--mutant {name} ")).unwrap_or_default();
    let url = format!("exec:{} simulate device {mutant}--listen stdio --vcd {vcd}", binary.display());
    let run = fsct(&["run", "device-lines", "--edition", "iec2022", "--dut", &url, "--out", &folder.out()]);
    (folder, vcd, run)
}

fn capture(folder: &Folder, file: &str, more: &[&str]) -> Outcome {
    let out = folder.0.join("capture").display().to_string();
    let args = ["capture", file, "--profile", "reference-device", "--edition", "iec2022", "--out", &out];
    fsct(&[&args[..], more].concat())
}

fn cases(folder: &std::path::Path) -> BTreeMap<String, Value> {
    let text = std::fs::read_to_string(folder.join("run.jsonl")).expect("there is a record");
    let lines = text.lines().filter_map(|line| serde_json::from_str::<Value>(line).ok());
    let cases = lines.filter_map(|line| line.get("case").cloned());
    cases.map(|case| (case["id"].as_str().unwrap_or_default().to_owned(), case)).collect()
}

/// Symbol, value and verdict of everything measured in a case.
fn measured(case: &Value) -> BTreeSet<String> {
    let list = case["measurements"].as_array().cloned().unwrap_or_default();
    list.iter().map(|one| format!("{} {} {} {}", one["symbol"], one["low"], one["high"], one["verdict"])).collect()
}

#[rstest]
#[case::right(None, 0)]
#[case::short(Some("ready-pulse-499-us"), 1)]
#[case::wide(Some("ready-pulse-1001-us"), 1)]
#[case::on_pin_2(Some("ready-pulse-on-pin-2"), 1)]
#[case::test_pulse(Some("test-pulse-1001-us"), 1)]
#[case::early(Some("ossde-early"), 1)]
fn a_recording_is_judged_as_it_was_live(#[case] mutant: Option<&str>, #[case] code: i32) {
    let (folder, vcd, run) = live(mutant.unwrap_or("right"), mutant);
    assert_eq!(run.code, code, "{}{}", run.out, run.err);
    let told = capture(&folder, &vcd, &[]);
    assert_eq!(told.code, code, "{}{}", told.out, told.err);
    let (live, recorded) = (cases(&folder.0), cases(&folder.0.join("capture")));
    assert!(recorded.keys().filter(|id| live.contains_key(*id)).count() >= 4, "{:?}", recorded.keys());
    for (id, case) in recorded.iter().filter(|(id, _)| live.contains_key(*id)) {
        assert_eq!(case["verdict"], live[id]["verdict"], "{id}");
        // The recording holds the same moments, in other episodes as well.
        let (seen, known) = (measured(case), measured(&live[id]));
        assert!(known.is_subset(&seen), "{id}: {known:?} is not all in {seen:?}");
    }
}

/// The sample period decides what can be said: 499 us at 1 MHz may be 501 us.
#[test]
fn a_coarse_recording_is_inconclusive_where_the_exact_one_fails() {
    if !fsct_c::there("sigrok-cli") {
        return;
    }
    let (folder, vcd, _) = live("sigrok", Some("ready-pulse-499-us"));
    let session = folder.0.join("lines.sr").display().to_string();
    let sigrok = std::process::Command::new("sigrok-cli")
        .args(["-I", "vcd:downsample=1000", "-i", &vcd, "-o", &session])
        .status()
        .expect("it runs");
    assert!(sigrok.success());
    assert_eq!(capture(&folder, &vcd, &[]).code, 1);
    let told = capture(&folder, &session, &[]);
    assert_eq!(told.code, 5, "{}", told.out);
    assert!(told.out.contains("sampled at 1 MHz") && told.out.contains("499 us ± 2 us"), "{}", told.out);
}

#[rstest]
#[case::empty("")]
#[case::no_recording("this is no recording\n")]
#[case::cut("$timescale 1 ns $end\n$scope module port $end\n$var wire 1 ! L+ $e")]
fn a_file_that_is_none_is_told_in_one_sentence(#[case] text: &str) {
    let folder = Folder::new(&format!("capture-bad-{}", text.len()));
    let file = folder.file("bench.vcd", text);
    let told = capture(&folder, &file, &[]);
    assert_eq!(told.code, 2, "{}", told.err);
    assert!(told.err.contains("bench.vcd") && told.err.trim().lines().count() == 1, "{}", told.err);
}

#[test]
fn a_channel_that_is_not_there_is_told_with_those_that_are() {
    let folder = Folder::new("capture-channel");
    let text = "$timescale 1 us $end\n$scope module m $end\n$var wire 1 ! D0 $end\n$upscope $end\n$enddefinitions $end\n#0\n0!\n#9\n";
    let told = capture(&folder, &folder.file("bench.vcd", text), &["--channels", "C/Q=D7"]);
    assert_eq!(told.code, 2);
    assert!(told.err.contains("D7") && told.err.contains("D0"), "{}", told.err);
}
