//! The example stacks in C and in Python: a third and a fourth reading of the tables, judged as any product is.
#![cfg(unix)]

mod cli;

use cli::{Folder, fsct};
use fsct_c::{CLIENT, DEVICE, Kind, MASTER, build};
use rstest::rstest;

/// Stops a program at the first access or calculation that is not sound.
const SANITIZED: &[&str] = &["-fsanitize=address,undefined", "-fno-sanitize-recover=all"];

/// The whole suite of the role passes, as far as it applies to this profile, and every transition is taken.
fn conforms(url: &str, name: &str, profile: &str) {
    let out = Folder::new(name);
    let outcome = fsct(&["run", "--dut", url, "--profile", profile, "--out", &out.out()]);
    assert_eq!(outcome.code, 0, "{outcome:?}");
    let cases = out.planned();
    let told = format!("conformant: {cases} cases, {cases} pass · every transition taken");
    assert!(outcome.out.contains(&told), "{}", outcome.out);
}

#[rstest]
#[case::device("device", DEVICE, "reference-device")]
#[case::master("master", MASTER, "master-without-storage")]
fn a_stack_in_c_conforms_as_a_library(#[case] name: &str, #[case] sources: &[&str], #[case] profile: &str) {
    let Some(library) = build(Kind::Library, sources, &[]) else { return };
    conforms(&format!("lib:{}", library.display()), &format!("c-lib-{name}"), profile);
}

#[rstest]
#[case::device("device", DEVICE, "reference-device")]
#[case::master("master", MASTER, "master-without-storage")]
fn a_stack_in_c_conforms_as_a_program_and_keeps_to_its_memory(
    #[case] name: &str,
    #[case] sources: &[&str],
    #[case] profile: &str,
) {
    let Some(program) = build(Kind::Program, &[CLIENT, sources].concat(), SANITIZED) else { return };
    conforms(&format!("exec:{}", program.display()), &format!("c-exec-{name}"), profile);
}

/// Errors by the thousand: random ones, and every corruption of up to two bits of an SPDU.
#[rstest]
#[case::device("device", DEVICE)]
#[case::master("master", MASTER)]
fn a_stack_in_c_passes_campaigns(#[case] name: &str, #[case] sources: &[&str]) {
    let Some(library) = build(Kind::Library, sources, &[]) else { return };
    let Some(program) = build(Kind::Program, &[CLIENT, sources].concat(), SANITIZED) else { return };
    for dut in [format!("lib:{}", library.display()), format!("exec:{}", program.display())] {
        let out = Folder::new(&format!("c-campaign-{name}"));
        let random: &[&str] = &["random", "--exchanges", "10000", "--faults", "1500"];
        for what in [random, &["bits", "--flips", "1..2", "--length", "6"], &["bits", "--flips", "1", "--length", "31"]]
        {
            let outcome = fsct(&[&["campaign"], what, &["--dut", &dut, "--out", &out.out()]].concat());
            assert_eq!(outcome.code, 0, "{dut} {what:?}: {outcome:?}");
        }
    }
}

#[rstest]
#[case::counter_check_missing(1, "11.5.3 Table 40 T25")]
#[case::two_sd_cycles(2, "11.5.3 Table 40 T29")]
#[case::watchdog_doubled(3, "11.5.5")]
fn a_mistake_compiled_in_is_found_with_its_clause(#[case] fault: u8, #[case] clause: &str) {
    let Some(library) = build(Kind::Library, DEVICE, &[&format!("-DFAULT={fault}")]) else { return };
    let out = Folder::new(&format!("c-fault-{fault}"));
    let outcome = fsct(&["run", "--dut", &format!("lib:{}", library.display()), "--out", &out.out()]);
    assert_eq!(outcome.code, 1, "{outcome:?}");
    let first = outcome.err.lines().find(|line| line.trim_start().starts_with("clause")).unwrap_or_default();
    assert!(first.contains(clause), "the first failure names another clause:\n{}", outcome.err);
}

#[test]
fn a_stack_in_python_conforms() {
    if fsct_c::there("python3") {
        let script = concat!(env!("CARGO_MANIFEST_DIR"), "/../adapters/python/fs_device.py");
        conforms(&format!("exec:python3 '{script}'"), "python", "reference-device");
    }
}

#[test]
fn the_python_client_passes_its_own_tests() {
    if fsct_c::there("python3") {
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../adapters/python");
        let mut command = std::process::Command::new("python3");
        command.args(["-B", "-m", "unittest", "-q", "test_client"]).current_dir(folder);
        let output = command.output().expect("it was there a moment ago");
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    }
}

#[test]
fn several_duts_are_compared_case_by_case() {
    let Some(sound) = build(Kind::Library, DEVICE, &[]) else { return };
    let Some(faulty) = build(Kind::Library, DEVICE, &["-DFAULT=1"]) else { return };
    let (sound, faulty) = (format!("lib:{}", sound.display()), format!("lib:{}", faulty.display()));
    let out = Folder::new("c-compared");
    let run = |duts: &[&str]| {
        let duts = duts.iter().flat_map(|dut| ["--dut", dut]);
        fsct(&[vec!["run", "--filter", "FSD-02", "--out", &out.out()], duts.collect()].concat())
    };
    let alike = run(&["inproc:reference-device", &sound, "inproc:reference-master"]);
    assert_eq!(alike.code, 0, "{alike:?}");
    assert!(alike.out.contains("192 cases came to the same on every DUT"), "{}", alike.out);
    let unlike = run(&["inproc:reference-device", &faulty]);
    assert_eq!(unlike.code, 1, "{unlike:?}");
    assert!(unlike.out.contains("122 of 192 cases did not come to the same on every DUT"), "{}", unlike.out);
    assert!(unlike.out.contains(&format!(": pass on inproc:reference-device, fail on {faulty}")), "{}", unlike.out);
    assert!(out.text("report.html").contains("122 of 192 cases did not come to the same"));
    assert!(out.text("summary.json").contains(r#""compared": 192"#));
}
