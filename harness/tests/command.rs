//! The command line: exit codes, records, and DUTs that misbehave.

mod cli;

use cli::{Folder, fsct};
use rstest::rstest;
use std::io::{Read, Write};
use std::net::TcpListener;

#[test]
fn the_first_command_judges_the_references_and_says_what_comes_next() {
    let folder = Folder::new("first");
    let run = fsct(&["run", "--out", &folder.out()]);
    assert_eq!(run.code, 0, "{run:?}");
    assert!(run.out.contains("conformant") && run.out.contains("every transition taken"), "{}", run.out);
    assert!(run.out.trim_end().ends_with("fsct doctor --dut URL, then fsct run --dut URL"), "{}", run.out);
    let summary: serde_json::Value = serde_json::from_str(&folder.text("summary.json")).expect("JSON");
    for key in ["cases", "verdicts", "execution", "transitions", "tolerances", "seed", "dut"] {
        assert!(summary.get(key).is_some(), "summary.json has no `{key}`");
    }
    assert_eq!(summary["verdicts"]["fail"], 0);
    assert!(folder.text("junit.xml").contains("FSD-0001"));
    assert!(folder.text("report.html").contains("FSD-0001"));
}

#[test]
fn the_same_seed_gives_the_same_octets_and_another_does_not() {
    let (one, two, three) = (Folder::new("seed-1"), Folder::new("seed-2"), Folder::new("seed-3"));
    for (folder, seed) in [(&one, "7"), (&two, "7"), (&three, "8")] {
        assert_eq!(fsct(&["run", "device-signature", "--seed", seed, "--out", &folder.out()]).code, 0);
    }
    assert_eq!(one.text("run.jsonl"), two.text("run.jsonl"));
    assert_ne!(one.text("run.jsonl"), three.text("run.jsonl"));
}

#[test]
fn a_mutant_fails_with_the_clause_and_a_line_to_replay_it() {
    let folder = Folder::new("mutant");
    let args = ["run", "device-counter", "--dut", "inproc:reference-device?mutant=counter-check-missing"];
    let run = fsct(&[&args[..], &["--out", &folder.out()]].concat());
    assert_eq!(run.code, 1, "{run:?}");
    assert!(run.err.contains("11.5.3 Table 40 T25"), "{}", run.err);
    let line = run.err.lines().find(|line| line.contains("replay")).expect("a line to replay it");
    let words: Vec<&str> = line.split('\'').collect();
    let [_, dut, _, key, ..] = words.as_slice() else { panic!("{line}") };
    let again = fsct(&["run", "--dut", dut, "--filter", key, "--out", &folder.out()]);
    assert_eq!(again.code, 1);
    assert!(again.out.contains("1 cases"), "{}", again.out);
}

#[test]
fn a_filter_that_matches_nothing_is_no_success() {
    let folder = Folder::new("nothing");
    assert_eq!(fsct(&["run", "--filter", "nothing-matches", "--out", &folder.out()]).code, 4);
    assert_eq!(fsct(&["list", "--filter", "nothing-matches"]).code, 4);
}

#[test]
fn a_dead_port_is_a_fault_of_the_rig_and_no_pass() {
    let folder = Folder::new("dead-port");
    // Bound and dropped: nobody listens there.
    let port = TcpListener::bind("127.0.0.1:0").and_then(|socket| socket.local_addr()).expect("a port").port();
    let run =
        fsct(&["run", "--dut", &format!("tcp://127.0.0.1:{port}"), "--filter", "FSD-0001", "--out", &folder.out()]);
    assert_eq!(run.code, 3, "{run:?}");
    let summary: serde_json::Value = serde_json::from_str(&folder.text("summary.json")).expect("JSON");
    assert_eq!(summary["verdicts"]["pass"], 0);
    assert!(summary["execution"]["rig-error"].as_u64() > Some(0));
}

#[rstest]
#[case::unknown_scheme("tpc://127.0.0.1:1", "tcp")]
#[case::unknown_name("inproc:reference-devise", "reference-device")]
#[case::unknown_mutant("inproc:reference-device?mutant=wrong-sead", "wrong-seed")]
fn a_wrong_address_names_the_nearest(#[case] url: &str, #[case] nearest: &str) {
    let run = fsct(&["run", "--dut", url, "--out", "never-made"]);
    assert_eq!(run.code, 2, "{run:?}");
    assert!(run.err.contains(nearest), "{}", run.err);
}

const MISSPELT: &str = "suite: mine
about: One case with a misspelt key
cases:
  - id: MY-0001
    title: Mine
    requirements: [R-11.5.3-09]
    dut: device
    start: operate
    steps:
      - exchange: {MCount: next, corupt: data}
        expect: {DCommErr: 1}
";

#[test]
fn a_misspelt_key_is_found_with_file_line_and_nearest_name() {
    let folder = Folder::new("misspelt");
    let file = folder.file("mine.yaml", MISSPELT);
    let check = fsct(&["check", &file]);
    assert_eq!(check.code, 2, "{check:?}");
    assert!(check.err.contains(&format!("{file}:10:34")) && check.err.contains("`corrupt`"), "{}", check.err);
    let run = fsct(&["run", &file, "--out", &folder.out()]);
    assert_eq!(run.code, 2, "{run:?}");
}

#[test]
fn a_case_of_ones_own_runs() {
    let folder = Folder::new("own");
    let file = folder.file("mine.yaml", &MISSPELT.replace("corupt", "corrupt"));
    assert_eq!(fsct(&["check", &file]).code, 0);
    let run = fsct(&["run", &file, "--out", &folder.out()]);
    assert_eq!(run.code, 0, "{run:?}");
    assert!(run.out.contains("4 cases"), "{}", run.out);
}

#[test]
fn a_case_of_ones_own_that_fails_can_be_run_again_by_its_line() {
    let folder = Folder::new("own-replay");
    let file = folder.file("mine.yaml", &MISSPELT.replace("corupt", "corrupt").replace("DCommErr: 1", "DCommErr: 0"));
    let run = fsct(&["run", &file, "--edition", "v1.1", "--filter", "crc32", "--out", &folder.out()]);
    assert_eq!(run.code, 1, "{run:?}");
    let line = run.err.lines().find(|line| line.contains("replay")).expect("a line to replay it");
    assert!(line.contains(&format!("fsct run '{file}' --dut")), "{line}");
}

#[cfg(unix)]
#[test]
fn a_run_stopped_by_the_user_leaves_a_valid_partial_record() {
    let folder = Folder::new("stopped");
    let endless = MISSPELT.replace("corupt: data", "times: 10000000");
    let file = folder.file("mine.yaml", &endless);
    let mut run = std::process::Command::new(assert_cmd::cargo::cargo_bin("fsct"))
        .args(["run", &file, "--out", &folder.out()])
        .stdout(std::process::Stdio::piped())
        .stderr(std::process::Stdio::null())
        .spawn()
        .expect("it runs");
    // The header is written when the signals are taken care of.
    while !folder.0.join("run.jsonl").metadata().is_ok_and(|data| data.len() > 0) {
        std::thread::yield_now();
    }
    let stop = std::process::Command::new("kill").args(["-INT", &run.id().to_string()]).status();
    assert!(stop.expect("kill is there").success());
    let status = run.wait().expect("it ends");
    let mut said = String::new();
    run.stdout.take().expect("it is piped").read_to_string(&mut said).expect("text");
    assert_eq!(status.code(), Some(3));
    assert!(said.contains("valid and partial"), "{said}");
    let record = folder.text("run.jsonl");
    let last: serde_json::Value = serde_json::from_str(record.lines().last().expect("lines")).expect("JSON");
    assert_eq!(last["footer"]["interrupted"], true);
    let report = fsct(&["report", &folder.out()]);
    assert_eq!(report.code, 3, "{report:?}");
}

#[test]
fn the_case_in_the_manual_is_sound_and_passes() {
    let page = include_str!("../../docs/cases.md");
    let (_, page) = page.split_once("## A file").expect("the section is there");
    let block =
        page.lines().skip_while(|line| line.is_empty()).take_while(|line| line.is_empty() || line.starts_with("    "));
    let text: String = block.map(|line| format!("{}\n", line.strip_prefix("    ").unwrap_or_default())).collect();
    let folder = Folder::new("manual");
    let file = folder.file("manual.yaml", &text);
    assert_eq!(fsct(&["check", &file]).code, 0);
    let run = fsct(&["run", &file, "--out", &folder.out()]);
    assert_eq!(run.code, 0, "{run:?}");
    assert!(run.out.contains("pass"), "{}", run.out);
}

#[test]
fn an_unknown_requirement_is_named() {
    let folder = Folder::new("requirement");
    let text = MISSPELT.replace("corupt", "corrupt").replace("R-11.5.3-09", "R-11.5.3-90");
    let check = fsct(&["check", &folder.file("mine.yaml", &text)]);
    assert_eq!(check.code, 2);
    assert!(
        check.err.contains("unknown requirement `R-11.5.3-90`") && check.err.contains("R-11.5.3-"),
        "{}",
        check.err
    );
}

#[rstest]
#[case("R-11.5.3-09", "T25")]
#[case("FSD-0125", "T25")]
#[case("A19", "sequential")]
#[case("t_RO", "iec2022: 1100 ms to data sheet")]
fn explain_knows_it(#[case] id: &str, #[case] says: &str) {
    let explain = fsct(&["explain", id]);
    assert_eq!(explain.code, 0);
    assert!(explain.out.contains(says), "{}", explain.out);
}

#[test]
fn known_answers_are_proven() {
    let vectors = fsct(&["vectors"]);
    assert_eq!(vectors.code, 0, "{vectors:?}");
    assert!(vectors.out.contains("0 failed"), "{}", vectors.out);
}

#[test]
fn a_signature_is_computed() {
    assert_eq!(fsct(&["crc", "00", "01", "02"]).out.trim(), "9D56");
    assert_eq!(fsct(&["crc", "--mode", "crc32", "000102"]).out.trim(), "B7B8B43E");
    assert_eq!(fsct(&["crc", "--block", "01 0A 0D 02 01 00 06 00 00 00 00"]).out.trim(), "9A28");
    assert_eq!(fsct(&["crc", "0G"]).code, 2);
}

/// A peer that does `with` for every connection, for as long as the test lives.
fn peer(with: impl Fn(std::net::TcpStream) + Send + 'static) -> String {
    let socket = TcpListener::bind("127.0.0.1:0").expect("a port");
    let address = socket.local_addr().expect("it is bound");
    std::thread::spawn(move || socket.incoming().flatten().for_each(&with));
    format!("tcp://{address}?timeout=200ms")
}

#[rstest]
#[case::closes(peer(drop), "dut-error")]
#[case::hangs(peer(|mut stream| { let _ = stream.read_to_end(&mut Vec::new()); }), "timeout")]
#[case::garbage(peer(|mut stream| { let _ = stream.write_all(&[0x47; 300_000]); }), "dut-error")]
#[case::echo(peer(|stream| { let mut from = stream.try_clone().expect("a clone"); let mut to = stream; let _ = std::io::copy(&mut from, &mut to); }), "dut-error")]
fn a_peer_that_misbehaves_ends_soon_and_passes_nothing(#[case] url: String, #[case] execution: &str) {
    let folder = Folder::new(&format!("peer-{execution}-{}", url.len() + url.bytes().map(usize::from).sum::<usize>()));
    let run = fsct(&["run", "--dut", &url, "--filter", "FSD-01", "--out", &folder.out()]);
    assert_eq!(run.code, 3, "{run:?}");
    let summary: serde_json::Value = serde_json::from_str(&folder.text("summary.json")).expect("JSON");
    assert_eq!(summary["verdicts"]["pass"], 0);
    assert!(summary["execution"][execution].as_u64() > Some(0), "{summary}");
    assert!(summary["execution"]["aborted"].as_u64() > Some(0), "the rest is not tried: {summary}");
}

#[rstest]
#[case("device")]
#[case("master")]
fn another_process_gets_the_same_verdicts(#[case] role: &str) {
    let (own, other) = (Folder::new(&format!("own-{role}")), Folder::new(&format!("other-{role}")));
    assert_eq!(fsct(&["run", "--dut", &format!("inproc:reference-{role}"), "--out", &own.out()]).code, 0);
    let binary = assert_cmd::cargo::cargo_bin("fsct");
    let url = format!("exec:{} simulate {role} --listen stdio", binary.display());
    assert_eq!(fsct(&["run", "--dut", &url, "--out", &other.out()]).code, 0);
    let verdicts = |folder: &Folder| -> Vec<String> {
        let text = folder.text("run.jsonl");
        let cases = text.lines().filter_map(|line| serde_json::from_str::<serde_json::Value>(line).ok());
        cases
            .filter_map(|line| Some(format!("{} {}", line["case"]["key"].as_str()?, line["case"]["verdict"])))
            .collect()
    };
    assert_eq!(verdicts(&own), verdicts(&other));
    assert!(verdicts(&own).len() > 1_000);
}

#[rstest]
#[case::both(&["--filter", "req:R-11.2-04"], &["device", "master"])]
#[case::device(&["scl-device", "--filter", "FSD-0001"], &["device"])]
#[case::master(&["--filter", "FSM-0201"], &["master"])]
fn without_a_dut_the_references_are_judged_that_a_chosen_case_is_for(#[case] chosen: &[&str], #[case] roles: &[&str]) {
    let folder = Folder::new(&format!("references-{}", roles.concat()));
    let out = folder.out();
    let run = fsct(&[&["run", "--out", &out], chosen].concat());
    assert_eq!(run.code, 0, "{run:?}");
    let summary: serde_json::Value = serde_json::from_str(&folder.text("summary.json")).expect("JSON");
    let judged: Vec<&str> =
        summary["dut"].as_array().expect("a list").iter().filter_map(|dut| dut["role"].as_str()).collect();
    assert_eq!(judged, roles);
    assert_eq!(summary["transitions"].get("T20").is_some(), roles.contains(&"device"));
}

#[test]
fn the_list_holds_the_cases_of_both_roles() {
    let all = fsct(&["list"]).out;
    assert!(all.contains("FSD-0001") && all.contains("FSM-0201"), "{all}");
    let one = fsct(&["list", "--filter", "suite:scl-master"]).out;
    assert!(!one.contains("FSD-") && one.contains("FSM-0201"), "{one}");
}

#[test]
fn suites_for_the_other_role_are_not_applicable_with_the_reason() {
    let folder = Folder::new("other-role");
    let run = fsct(&["run", "scl-device", "--dut", "inproc:reference-master", "--out", &folder.out()]);
    assert_eq!(run.code, 4, "{run:?}");
    assert!(run.out.contains("the case is for a device, the DUT is a master"), "{run:?}");
    let summary: serde_json::Value = serde_json::from_str(&folder.text("summary.json")).expect("JSON");
    assert_eq!((&summary["cases"], &summary["verdicts"]["pass"]), (&0.into(), &0.into()));
    assert!(summary["not_applicable"].as_u64() > Some(1_000));
}

/// Cases count in FSP_Watchdog and MasterCycleTime, not in the milliseconds of the reference profile.
#[rstest]
fn a_right_dut_passes_with_other_times(
    #[values("device", "master")] role: &str,
    #[values((400, 20), (5_000, 60), (1_000, 200))] (cycle_us, watchdog_ms): (u32, u32),
) {
    let folder = Folder::new(&format!("times-{role}-{cycle_us}-{watchdog_ms}"));
    let path = format!("{}/../testcases/profiles/reference-{role}.yaml", env!("CARGO_MANIFEST_DIR"));
    let own = std::fs::read_to_string(path).expect("it is there");
    let text = own
        .replace("MasterCycleTime_us: 1000", &format!("MasterCycleTime_us: {cycle_us}"))
        .replace("FSP_Watchdog_ms: 20", &format!("FSP_Watchdog_ms: {watchdog_ms}"));
    assert_ne!(text, own);
    let profile = folder.file("mine.yaml", &text);
    let dut = format!("inproc:reference-{role}");
    let run = fsct(&["run", "--dut", &dut, "--profile", &profile, "--out", &folder.out()]);
    assert_eq!(run.code, 0, "{}{}", run.out, run.err);
}
