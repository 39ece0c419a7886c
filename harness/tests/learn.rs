//! `fsct learn` and what `fsct prove` makes of it, as a user runs them.

mod cli;

use cli::{Folder, Outcome, fsct};
use rstest::rstest;
use serde_json::Value;
use std::sync::LazyLock;

fn learned(dut: &str, out: &Folder, more: &[&str]) -> Outcome {
    fsct(&[&["learn", "--dut", dut, "--out", &out.out()], more].concat())
}

fn file(out: &Folder) -> Value {
    serde_json::from_str(&out.text("learned.json")).expect("JSON")
}

fn states(machine: &Value) -> usize {
    machine["states"].as_array().map_or(0, Vec::len)
}

#[rstest]
#[case::device("inproc:reference-device", 14)]
#[case::device_of_v1_1("inproc:reference-device --edition v1.1 --mode crc32", 14)]
#[case::late_device("inproc:reference-device?latency=1 --profile device-late-1", 14)]
#[case::master("inproc:reference-master", 4)]
fn a_reference_has_the_machine_of_the_tables(#[case] line: &str, #[case] expected: usize) {
    let mut words = line.split(' ');
    let out = Folder::new(&format!("learn-{expected}-{}", line.len()));
    let dut = words.next().unwrap_or_default();
    let run = learned(dut, &out, &words.chain(["--extra", "0"]).collect::<Vec<_>>());
    assert_eq!(run.code, 0, "{run:?}");
    assert!(run.out.contains(&format!("learnt    {expected} states; the tables have {expected}")), "{}", run.out);
    let file = file(&out);
    assert_eq!((states(&file["machine"]), &file["machine"]), (expected, &file["table"]));
    assert_eq!((&file["schema"], &file["bound"]), (&"fsct-learned/1".into(), &Value::Null));
    assert!(out.text("learned.html").contains("✓ The machine of the tables"));
}

/// One difference of each: the inputs from the start, what the tables and what the DUT answer.
#[rstest]
#[case::sd_cycles(
    "inproc:reference-device?mutant=sd-cycles-2",
    "NEXT behind NEXT, NEXT\n   \
     tables  answer: SDset 1, DCommErr 0, DTimeout 0; PDout_D safe, setSD_DC 1\n   \
     DUT     answer: SDset 0, DCommErr 0, DTimeout 0; PDout_D live, setSD_DC 0\n"
)]
#[case::d_timeout(
    "inproc:reference-device?mutant=d-timeout-never-cleared",
    "NEXT behind NEXT, TIMEOUT, NEXT\n   \
     tables  answer: SDset 1, DCommErr 0, DTimeout 0; PDout_D safe, setSD_DC 1\n   \
     DUT     answer: SDset 1, DCommErr 0, DTimeout 1; PDout_D safe, setSD_DC 1\n"
)]
#[case::mirror(
    "inproc:reference-device?mutant=d-count-plain",
    "NEXT behind the start\n   \
     tables  answer: SDset 1, DCommErr 0, DTimeout 0; PDout_D safe, setSD_DC 1\n   \
     DUT     answer with another counter: SDset 1, DCommErr 0, DTimeout 0; PDout_D safe, setSD_DC 1\n"
)]
#[case::old_data(
    "inproc:reference-device?mutant=old-changes-pdout",
    "DUT     no new answer, but PDout_D live, setSD_DC 0\n"
)]
#[case::signature("inproc:reference-device?mutant=wrong-seed", "PDout_D safe, setSD_DC 1; not intact\n")]
#[case::pdin("inproc:reference-device?mutant=pdin-late", "; other data\n")]
#[case::restart(
    "inproc:reference-master?mutant=restart-without-acknowledgment",
    "GOOD behind DTO\n   \
     tables  SPDU: setSD 1, ChFAckReq 1, PDout safe; PDin_M safe\n   \
     DUT     SPDU: setSD 0, ChFAckReq 0, PDout live; PDin_M live\n"
)]
#[case::nothing("inproc:null-device", "DUT     nothing new\n")]
#[case::mcount("inproc:reference-master?mutant=fault-keeps-mcount", "DUT     ")]
fn a_mutant_shows_where_it_differs(#[case] dut: &str, #[case] told: &str) {
    let out = Folder::new(&format!("learn-{}", dut.len()));
    let run = learned(dut, &out, &["--extra", "0"]);
    assert_eq!(run.code, 1, "{run:?}");
    assert!(run.out.contains(told), "{}", run.out);
    assert!(run.out.contains("differs in "), "{}", run.out);
    assert!(out.text("learned.html").contains("✗ Differs in "));
}

#[test]
fn a_bound_that_was_hit_is_said() {
    let out = Folder::new("learn-bound");
    let run = learned("inproc:reference-device", &out, &["--most-inputs", "300"]);
    assert_eq!(run.code, 5, "{run:?}");
    assert!(run.err.contains("more than 300 inputs (--most-inputs)"), "{}", run.err);
    let run = learned("inproc:reference-device", &out, &["--most-states", "5"]);
    assert_eq!(run.code, 5, "{run:?}");
    assert!(run.err.contains("more than 5 states (--most-states)"), "{}", run.err);
}

#[rstest]
#[case::nothing_there("tcp://127.0.0.1:1", 3, "127.0.0.1:1")]
#[case::no_dut("inproc:reference-divice", 2, "reference-device")]
#[case::no_such_mode("inproc:reference-device --profile reference-master", 2, "is for a master")]
fn what_cannot_be_learnt_is_said(#[case] line: &str, #[case] code: i32, #[case] sentence: &str) {
    let out = Folder::new(&format!("learn-not-{}", line.len()));
    let mut words = line.split(' ');
    let run = learned(words.next().unwrap_or_default(), &out, &words.collect::<Vec<_>>());
    assert_eq!(run.code, code, "{run:?}");
    assert!(run.err.contains(sentence), "{}", run.err);
}

/// The verdict of every property, by its name.
fn verdicts(args: &[&str]) -> (i32, Vec<(String, String)>) {
    let run = fsct(&[&["prove", "--json", "--watchdog", "3"], args].concat());
    let json: Value = serde_json::from_str(&run.out).unwrap_or_else(|_| panic!("{run:?}"));
    let text = |value: &Value| value.as_str().unwrap_or_default().to_owned();
    let properties = json[0]["properties"].as_array().cloned().unwrap_or_default();
    let found =
        |outcome: &Value| (text(&outcome["property"]), format!("{} {}", text(&outcome["verdict"]), outcome["found"]));
    (run.code, properties.iter().map(found).collect())
}

#[rstest]
#[case::device("device", "--device")]
#[case::master("master", "--master")]
fn what_was_learnt_of_a_reference_proves_what_the_tables_prove(#[case] role: &str, #[case] option: &str) {
    let out = Folder::new(&format!("learn-prove-{role}"));
    assert_eq!(learned(&format!("inproc:reference-{role}"), &out, &["--extra", "0"]).code, 0);
    let path = out.0.join("learned.json").display().to_string();
    let (code, proven) = verdicts(&[option, &path]);
    assert_eq!((code, proven), verdicts(&[]));
}

#[test]
fn the_machine_of_the_other_side_is_refused() {
    let out = Folder::new("learn-prove-side");
    assert_eq!(learned("inproc:reference-master", &out, &["--extra", "0"]).code, 0);
    let path = out.0.join("learned.json").display().to_string();
    let run = fsct(&["prove", "--device", &path]);
    assert_eq!(run.code, 2, "{run:?}");
    assert!(run.err.contains("it is not the machine of an FS-Device, as --device wants"), "{}", run.err);
}

#[test]
fn a_learnt_fs_master_without_acknowledgment_is_found_out() {
    let out = Folder::new("learn-prove-restart");
    let dut = "inproc:reference-master?mutant=restart-without-acknowledgment";
    assert_eq!(learned(dut, &out, &["--extra", "0"]).code, 1);
    let path = out.0.join("learned.json").display().to_string();
    let run = fsct(&["prove", "--master", &path, "--property", "P2"]);
    assert_eq!(run.code, 1, "{run:?}");
    assert!(run.out.starts_with("FS-Master as learnt: fsct reference FS-Master "), "{}", run.out);
    let chart = run.out.split_once("Violated.\n").map(|(_, chart)| chart).unwrap_or_default();
    insta::assert_snapshot!(chart, @r"
       x  SPDU           FS-Device       answer    FS-Master
       1  0 setSD SDout  T20 21          -         q0
       2  0 setSD SDout  T21 T22 T23 24  - BAD(0)  T3 T7 q2
       3  1 setSD SDout  T24 T22 T23 24  7 SDset   q2
       4  1 setSD SDout  24              6 SDset   T13 q1 ChFAck_C=0
    ");
}

#[rstest]
#[case::no_json("no JSON", "it is no learned.json as `fsct learn` writes it")]
#[case::role(r#""role": "master""#, "its inputs are not GOOD, ")]
#[case::schema(r#""schema": "fsct-learned/9""#, "its schema is `fsct-learned/9`")]
#[case::next(r#""next": 99"#, "leads to state 99, of 14 states")]
#[case::input(r#""NEXT","#, "its inputs are not NEXT, ")]
#[case::spdu(r#""spdu": "other-counter""#, "with what no partner takes (answer with another counter")]
#[case::bound(r#""bound": "more than 5 states""#, "it was not learnt to the end (more than 5 states)")]
fn a_file_that_does_not_fit_is_refused(#[case] other: &str, #[case] sentence: &str) {
    static DEVICE: LazyLock<String> = LazyLock::new(|| {
        let out = Folder::new("learn-file");
        assert_eq!(learned("inproc:reference-device", &out, &["--extra", "0"]).code, 0);
        out.text("learned.json")
    });
    let text = &*DEVICE;
    let out = Folder::new(&format!("learn-file-{}", sentence.len()));
    let text = match other.split_once(": ") {
        None if other == "no JSON" => "{".to_owned(),
        None => text.replacen(other, r#""NEWER","#, 1),
        Some(("\"role\"", _)) => text.replacen(r#""role": "device""#, other, 1),
        Some(("\"bound\"", _)) => text.replacen(r#""bound": null"#, other, 1),
        Some(("\"next\"", _)) => text.replacen(r#""next": 1"#, other, 1),
        Some(("\"spdu\"", _)) => text.replacen(r#""spdu": "new""#, other, 1),
        Some(_) => text.replacen(r#""schema": "fsct-learned/1""#, other, 1),
    };
    let path = out.file("other.json", &text);
    let run = fsct(&["prove", "--device", &path]);
    assert_eq!(run.code, 2, "{run:?}");
    assert!(run.err.contains(sentence), "{}", run.err);
}
