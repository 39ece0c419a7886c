//! `fsct iodd` as a user runs it.

mod cli;

use cli::{Folder, fsct};
use rstest::rstest;

const IEC: &str = include_str!("../../iodd/tests/sound-iec2022.xml");
const V1_1: &str = include_str!("../../iodd/tests/sound-v1.1.xml");

#[test]
fn a_sound_iodd_tells_its_edition_its_signatures_and_what_it_declares() {
    let folder = Folder::new("iodd-sound");
    let file = folder.file("sound.xml", IEC);
    let run = fsct(&["iodd", &file, "--octets"]);
    assert_eq!(run.code, 0, "{run:?}");
    insta::assert_snapshot!(run.out.replace(&file, "sound.xml"));
}

#[test]
fn a_warning_leaves_it_sound() {
    let folder = Folder::new("iodd-warning");
    let file = folder.file("sound.xml", V1_1);
    let run = fsct(&["iodd", &file]);
    assert_eq!(run.code, 0, "{run:?}");
    assert!(run.out.contains("warning IODD-45"), "{}", run.out);
    assert!(run.out.contains("13807 (0x35EF) computed, 13807 declared"), "{}", run.out);
}

#[test]
fn a_broken_rule_is_told_with_its_place_and_fails() {
    let folder = Folder::new("iodd-broken");
    let file = folder.file("broken.xml", &IEC.replacen("upperValue=\"5000\"", "upperValue=\"70000\"", 1));
    let run = fsct(&["iodd", &file]);
    assert_eq!(run.code, 1, "{run:?}");
    insta::assert_snapshot!(run.out.replace(&file, "broken.xml"));
    let json: serde_json::Value = serde_json::from_str(&fsct(&["iodd", &file, "--json"]).out).expect("JSON");
    assert_eq!((&json["sound"], &json["findings"][0]["rule"]), (&false.into(), &"IODD-23".into()));
}

#[test]
fn what_cannot_be_judged_is_invalid_input() {
    let folder = Folder::new("iodd-unreadable");
    let missing = folder.0.join("missing.xml").display().to_string();
    for (file, sentence) in [
        (missing, "there is no such file"),
        (folder.file("empty.xml", ""), "an IODD is well-formed XML"),
        (folder.file("bomb.xml", "<!DOCTYPE a [<!ENTITY a 'x'>]><a>&a;</a>"), "DOCTYPE"),
        (folder.out(), "it is no file"),
    ] {
        let run = fsct(&["iodd", &file]);
        assert_eq!(run.code, 2, "{run:?}");
        assert!(run.err.contains(sentence) && run.err.trim_end().lines().count() == 1, "{}", run.err);
    }
}

#[test]
fn text_of_the_file_reaches_no_terminal_as_it_is() {
    let folder = Folder::new("iodd-hostile");
    let file =
        folder.file("hostile.xml", &IEC.replacen("id=\"P_ProcessData\"", "id=\"&#x9b;2J&#xA;forged: sound\"", 1));
    let run = fsct(&["iodd", &file]);
    assert_eq!(run.code, 1, "{run:?}");
    let json = fsct(&["iodd", &file, "--json"]).out;
    assert!(json.is_ascii(), "{json}");
    let json: serde_json::Value = serde_json::from_str(&json).expect("JSON");
    assert_eq!(json["findings"][0]["found"], "id `\u{9b}2J\nforged: sound`");
    assert!(!run.out.contains('\u{9b}') && !run.out.lines().any(|line| line.starts_with("forged")), "{}", run.out);
}

#[test]
fn a_rule_is_explained() {
    let run = fsct(&["explain", "IODD-24"]);
    assert_eq!(run.code, 0, "{run:?}");
    assert!(run.out.contains("FSP_IO_StructCRC") && run.out.contains("v1.1: warning"), "{}", run.out);
}

const REFERENCE: &str = include_str!("../../iodd/tests/reference-device.xml");

/// The text with its FSP_ParamDescCRC put right after an edit.
fn signed(text: &str) -> String {
    let report = fsct_iodd::check(text.as_bytes(), None).expect("readable");
    let old = report.declaration.param_desc_crc.expect("declared");
    let new = report.param_desc.expect("serialised").computed;
    text.replacen(&format!("defaultValue=\"{old}\""), &format!("defaultValue=\"{new}\""), 1)
}

/// A run of the cases of an IODD on the reference FS-Device.
fn held_against(folder: &Folder, file: &str) -> cli::Outcome {
    fsct(&["run", "device-iodd", "--dut", "inproc:reference-device", "--iodd", file, "--out", &folder.out()])
}

#[test]
fn the_reference_device_is_what_its_iodd_declares() {
    let folder = Folder::new("iodd-run");
    let run = held_against(&folder, &folder.file("reference.xml", REFERENCE));
    assert_eq!(run.code, 0, "{run:?}");
    assert!(run.out.contains("conformant: 3 cases, 3 pass"), "{}", run.out);
}

#[rstest]
#[case::param_desc_crc("upperValue=\"65535\"", "upperValue=\"60000\"", "FSD-2201")]
#[case::structure("defaultValue=\"21088\"", "defaultValue=\"1234\"", "FSD-2202")]
#[case::time_to_ready(
    "index=\"16912\" accessRights=\"ro\" defaultValue=\"50\"",
    "index=\"16912\" accessRights=\"ro\" defaultValue=\"51\"",
    "FSD-2203"
)]
#[case::min_shut_down_time(
    "index=\"16913\" accessRights=\"ro\" defaultValue=\"100\"",
    "index=\"16913\" accessRights=\"ro\" defaultValue=\"101\"",
    "FSD-2203"
)]
fn a_product_that_is_not_what_its_iodd_declares_fails(#[case] from: &str, #[case] to: &str, #[case] case: &str) {
    let folder = Folder::new(&format!("iodd-other-{}", to.len()));
    assert!(REFERENCE.contains(from));
    let text = signed(&REFERENCE.replacen(from, to, 1));
    let run = held_against(&folder, &folder.file("other.xml", &text));
    assert_eq!(run.code, 1, "{run:?}");
    assert!(run.err.contains(&format!("fail {case}")) && run.err.contains("as the IODD declares"), "{}", run.err);
}

#[test]
fn a_delay_that_parameters_may_have_moved_is_a_remark() {
    let folder = Folder::new("iodd-delay");
    let text = REFERENCE.replacen(
        "index=\"16915\" accessRights=\"ro\" defaultValue=\"10\"",
        "index=\"16915\" accessRights=\"ro\" defaultValue=\"11\"",
        1,
    );
    let run = held_against(&folder, &folder.file("delay.xml", &text));
    assert_eq!(run.code, 0, "{run:?}");
    assert!(run.out.contains("1 remark"), "{}", run.out);
}

#[test]
fn an_iodd_that_is_not_sound_or_of_another_product_is_invalid_input() {
    let folder = Folder::new("iodd-refused");
    let unsound = REFERENCE.replacen("upperValue=\"65535\"", "upperValue=\"60000\"", 1);
    let run = held_against(&folder, &folder.file("unsound.xml", &unsound));
    assert!(run.code == 2 && run.err.contains("is not sound"), "{run:?}");
    let args = ["run", "device-iodd", "--dut", "inproc:reference-master", "--iodd"];
    let run = fsct(&[&args[..], &[&folder.file("reference.xml", REFERENCE)]].concat());
    assert!(run.code == 2 && run.err.contains("is for a device"), "{run:?}");
}

#[test]
fn without_an_iodd_its_cases_are_not_applicable() {
    let folder = Folder::new("iodd-without");
    let run = fsct(&["run", "device-iodd", "--dut", "inproc:reference-device", "--out", &folder.out()]);
    assert_eq!(run.code, 4, "{run:?}");
    assert!(run.out.contains("the profile does not list the feature `iodd`"), "{}", run.out);
}
