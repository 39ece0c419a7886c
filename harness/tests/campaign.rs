//! `fsct campaign`: the references pass, mutants are found, shrunk and replayed octet by octet, and a DUT that does nothing
//! earns no pass.

use assert_cmd::Command;
use rstest::rstest;
use std::path::{Path, PathBuf};

/// Exit code, stdout and stderr of `fsct campaign`.
fn campaign(args: &[&str], out: &Path) -> (i32, String, String) {
    let mut command = Command::cargo_bin("fsct").expect("the binary is built");
    let output = command.arg("campaign").args(args).arg("--out").arg(out).output().expect("it runs");
    let text = |octets: Vec<u8>| String::from_utf8(octets).expect("UTF-8");
    (output.status.code().unwrap_or(-1), text(output.stdout), text(output.stderr))
}

fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("campaign").join(name);
    let _ = std::fs::remove_dir_all(&folder);
    folder
}

fn file(folder: &Path, name: &str) -> String {
    std::fs::read_to_string(folder.join(name)).expect("it was written")
}

#[rstest]
#[case("device", "v1.1")]
#[case("device", "iec2022")]
#[case("master", "v1.1")]
#[case("master", "iec2022")]
fn the_references_pass_random_faults(#[case] role: &str, #[case] edition: &str) {
    let dut = format!("inproc:reference-{role}");
    let args =
        ["random", "--exchanges", "20000", "--faults", "3000", "--seed", "7", "--edition", edition, "--dut", &dut];
    let (code, told, errors) = campaign(&args, &folder(&format!("random-{role}-{edition}")));
    assert_eq!(code, 0, "{told}{errors}");
    assert!(told.contains("pass: "), "{told}");
}

#[rstest]
#[case("device", "4", "1..3")]
#[case("device", "7", "1..2")]
#[case("master", "4", "1..3")]
#[case("master", "7", "1..2")]
#[case("master", "31", "1")]
fn the_references_detect_every_corruption(#[case] role: &str, #[case] length: &str, #[case] flips: &str) {
    let dut = format!("inproc:reference-{role}");
    let args = ["bits", "--flips", flips, "--length", length, "--dut", &dut];
    let (code, told, errors) = campaign(&args, &folder(&format!("bits-{role}-{length}")));
    assert_eq!(code, 0, "{told}{errors}");
    assert!(told.contains("none undetected"), "{told}");
}

/// Six bits are the Hamming distance of the CRC-16: some corruptions carry the right signature again, which no receiver can tell.
#[test]
fn what_the_signature_cannot_detect_is_no_fault_of_the_dut() {
    let out = folder("bursts");
    let (code, told, errors) = campaign(&["bits", "--bursts", "17", "--length", "4", "--mode", "crc16"], &out);
    assert_eq!(code, 0, "{told}{errors}");
    assert!(told.contains("carry the right signature again"), "{told}");
    assert!(file(&out, "campaign.json").contains("\"failed\": 0"));
}

/// Bursts no longer than the signature never repair it, so every one of them has to be detected.
#[rstest]
#[case("crc16", "16")]
#[case("crc32", "32")]
fn the_references_detect_every_burst_that_the_signature_does(
    #[case] mode: &str,
    #[case] longest: &str,
    #[values("device", "master")] role: &str,
) {
    let dut = format!("inproc:reference-{role}");
    let out = folder(&format!("bursts-{mode}-{role}"));
    let args = ["bits", "--bursts", longest, "--sample", "20", "--mode", mode, "--dut", &dut];
    let (code, told, errors) = campaign(&args, &out);
    assert_eq!(code, 0, "{told}{errors}");
    assert!(told.contains("none undetected"), "{told}");
    let report = file(&out, "campaign.json");
    assert!(report.contains(&format!("\"burst {longest}\"")) && report.contains("\"iec2022\""), "{report}");
    assert!(!told.contains("carry the right signature again"), "{told}");
}

/// The profile says how late a DUT may answer; one that is as late is not failed for it.
#[rstest]
fn a_late_dut_passes_with_the_profile_for_it(
    #[values("device", "master")] role: &str,
    #[values("1", "3")] latency: &str,
) {
    let dut = format!("inproc:reference-{role}?latency={latency}");
    let profile = format!("{role}-late-{latency}");
    let random: &[&str] = &["random", "--exchanges", "10000", "--faults", "1500"];
    for what in [random, &["bits", "--flips", "1..2", "--length", "5"], &["bits", "--flips", "1", "--length", "31"]] {
        let args = [what, &["--dut", &dut, "--profile", &profile]].concat();
        let (code, told, errors) = campaign(&args, &folder(&format!("late-{role}-{latency}")));
        assert_eq!(code, 0, "{what:?}: {told}{errors}");
    }
}

/// A DUT that is later than the profile says has not been tested; that says nothing against it.
#[rstest]
fn a_late_dut_with_another_profile_is_not_failed(
    #[values("device", "master")] role: &str,
    #[values("random", "bits")] what: &str,
) {
    let dut = format!("inproc:reference-{role}?latency=2");
    let (code, told, errors) = campaign(&[what, "--dut", &dut], &folder(&format!("later-{role}-{what}")));
    assert_eq!(code, 5, "{told}{errors}");
    assert!(!told.contains("pass"), "{told}");
}

/// However many DUTs are reached at a time, the result is the same, found or not found.
#[rstest]
#[case("device", "reference-device", 0)]
#[case("master", "reference-master", 0)]
#[case("mutant", "reference-device?mutant=d-comm-err-never-reported", 1)]
fn the_number_of_jobs_does_not_change_the_result(#[case] name: &str, #[case] dut: &str, #[case] expected: i32) {
    let dut = format!("inproc:{dut}");
    let run = |jobs: &str| {
        let out = folder(&format!("jobs-{name}-{jobs}"));
        let args = ["bits", "--flips", "1..2", "--mode", "crc16", "--dut", &dut, "--jobs", jobs];
        let (code, told, errors) = campaign(&args, &out);
        assert_eq!(code, expected, "{told}{errors}");
        let lengths = told.lines().filter(|line| line.starts_with("v1.1") || line.starts_with("iec2022")).count();
        (file(&out, "campaign.json"), lengths)
    };
    let (report, lengths) = run("1");
    assert_eq!((report.clone(), lengths), run("4"));
    if expected == 0 {
        assert_eq!(lengths, 8, "SPDUs of 4 to 7 octets in both editions");
        assert!(report.contains("\"undetected_fraction_at_most_95\""), "{report}");
    }
}

#[rstest]
#[case("reference-device?mutant=sd-cycles-2")]
#[case("reference-device?mutant=counter-check-missing")]
#[case("reference-device?mutant=watchdog-doubled")]
#[case("reference-master?mutant=counter-7-to-0")]
fn a_failure_is_shrunk_and_its_replay_gives_the_same_record(#[case] mutant: &str) {
    let dut = format!("inproc:{mutant}");
    let out = folder(&mutant.replace(['?', '='], "-"));
    let (code, told, errors) = campaign(&["random", "--exchanges", "20000", "--faults", "2000", "--dut", &dut], &out);
    assert_eq!(code, 1, "{told}{errors}");
    assert!(told.contains("  replay   fsct campaign replay "), "{told}");
    let list = out.join("actions.jsonl");
    assert!(file(&out, "actions.jsonl").lines().count() <= 6, "a head and five actions at the most: {told}");
    let list = list.to_str().expect("UTF-8");
    let again = out.join("again");
    let (code, told, errors) = campaign(&["replay", list, "--dut", &dut], &again);
    assert_eq!(code, 1, "{told}{errors}");
    assert_eq!(file(&out, "failure.json"), file(&again, "failure.json"));
    let good = if mutant.contains("device") { "inproc:reference-device" } else { "inproc:reference-master" };
    let (code, told, errors) = campaign(&["replay", list, "--dut", good], &again);
    assert_eq!(code, 0, "{told}{errors}");
}

#[test]
fn a_corruption_that_is_not_reported_is_told_with_its_octets_and_a_replay() {
    let out = folder("d-comm-err");
    let dut = "inproc:reference-device?mutant=d-comm-err-never-reported";
    let (code, told, errors) = campaign(&["bits", "--flips", "1", "--length", "4", "--dut", dut], &out);
    assert_eq!(code, 1, "{told}{errors}");
    assert!(told.contains("undetected: "), "{told}");
    let list = out.join("actions.jsonl");
    let (code, told, errors) = campaign(&["replay", list.to_str().expect("UTF-8"), "--dut", dut], &out.join("again"));
    assert_eq!(code, 1, "{told}{errors}");
    assert_eq!(file(&out, "failure.json"), file(&out.join("again"), "failure.json"));
}

#[rstest]
#[case("null-device")]
#[case("echo-device")]
#[case("null-master")]
#[case("echo-master")]
#[case("constant-master")]
fn a_dut_that_never_operates_earns_no_pass(#[case] name: &str, #[values("random", "bits")] what: &str) {
    let dut = format!("inproc:{name}");
    let (code, told, errors) = campaign(&[what, "--dut", &dut], &folder(&format!("{name}-{what}")));
    assert!(matches!(code, 3 | 5), "{code}: {told}{errors}");
    assert!(!told.contains("pass"), "{told}");
    assert_eq!(errors.lines().count(), 1, "{errors}");
}

/// It presents a good SPDU, the wrong one: that is a failure of the product already at the start.
#[rstest]
fn a_device_that_repeats_one_spdu_fails(#[values("random", "bits")] what: &str) {
    let (code, told, errors) =
        campaign(&[what, "--dut", "inproc:constant-device"], &folder(&format!("constant-device-{what}")));
    assert_eq!(code, 1, "{told}{errors}");
    assert!(!told.contains("pass"), "{told}");
}

/// At p = 0.5 one SPDU of 65536 carries a right signature again; the exact value lies in the interval of what is seen.
#[rstest]
fn so_many_noisy_spdus_are_taken_as_the_exact_residual_error_says(
    #[values("device", "master")] role: &str,
    #[values("1", "3")] jobs: &str,
) {
    let dut = format!("inproc:reference-{role}");
    let out = folder(&format!("noise-{role}-{jobs}"));
    let args = ["noise", "--ber", "0.1,0.5", "--length", "7", "--spdus", "200000", "--dut", &dut, "--jobs", jobs];
    let (code, told, errors) = campaign(&args, &out);
    assert_eq!(code, 0, "{told}{errors}");
    let report: serde_json::Value = serde_json::from_str(&file(&out, "campaign.json")).expect("JSON");
    let rows = report["rows"].as_array().expect("rows");
    assert_eq!(rows.len(), 2, "{report}");
    let half = &rows[1];
    let (low, high) = (half["interval"][0].as_f64(), half["interval"][1].as_f64());
    assert!(
        half["undetected"].as_u64() > Some(0) && low < half["exact"].as_f64() && half["exact"].as_f64() < high,
        "{half}"
    );
    assert_eq!(half["exact"].as_f64().map(|exact| (exact * 65536.0).round()), Some(1.0), "{half}");
    let other = folder(&format!("noise-{role}-{jobs}-again"));
    let (_, again, _) = campaign(&args[..args.len() - 2], &other);
    assert_eq!(told.lines().nth(2), again.lines().nth(2), "the same seed, the same noise");
    assert!(file(&out, "noise.svg").contains("class=\"measured\""));
}

#[test]
fn a_dut_that_takes_a_wrong_signature_is_not_excused_by_chance() {
    let out = folder("noise-unchecked");
    let dut = "inproc:reference-device?mutant=signature-unchecked-after-fault";
    let (code, told, errors) =
        campaign(&["noise", "--ber", "0.02", "--length", "5", "--spdus", "20000", "--dut", dut], &out);
    assert_eq!(code, 1, "{told}{errors}");
    assert!(told.contains("  clause   ") && told.contains("fail: a noisy SPDU"), "{told}");
    assert!(file(&out, "campaign.json").contains("\"failed\": \"expected DCommErr 1"));
}

/// Where nothing was taken nothing was measured.
#[test]
fn without_an_undetected_spdu_nothing_is_said() {
    let out = folder("noise-quiet");
    let (code, told, errors) = campaign(&["noise", "--ber", "0.001", "--length", "4", "--spdus", "500"], &out);
    assert_eq!(code, 5, "{told}{errors}");
    assert!(!told.contains("pass"), "{told}");
}

#[rstest]
#[case(&["--ber", "0.7"], "up to 0.5")]
#[case(&["--length", "9"], "4..=7")]
fn noise_that_cannot_be_is_refused(#[case] args: &[&str], #[case] why: &str) {
    let (code, told, errors) = campaign(&[&["noise"], args].concat(), &folder("noise-refused"));
    assert_eq!(code, 2, "{told}{errors}");
    assert!(errors.contains(why), "{errors}");
}

#[rstest]
#[case("inproc:reference-device", 0, "pass: 68080 falsified records, none starts the SCL")]
#[case("inproc:reference-device?mutant=record-bit-unchecked", 1, "fail: at record 88")]
#[case("inproc:null-device", 5, "")]
fn corruptions_of_the_verify_record(#[case] dut: &str, #[case] expected: i32, #[case] last: &str) {
    let (code, told, errors) = campaign(&["record", "--dut", dut], &folder(&format!("record-{expected}")));
    assert_eq!(code, expected, "{told}{errors}");
    assert!(told.lines().last().unwrap_or_default().starts_with(last), "{told}");
}

#[test]
fn one_seed_gives_one_result() {
    let run = |name: &str, seed: &str| {
        let out = folder(name);
        let args = ["random", "--exchanges", "5000", "--faults", "700", "--seed", seed];
        let (code, told, errors) = campaign(&args, &out);
        assert_eq!(code, 0, "{told}{errors}");
        (told, file(&out, "campaign.json"))
    };
    assert_eq!(run("seed-1", "42"), run("seed-2", "42"));
    assert_ne!(run("seed-3", "42"), run("seed-4", "43"));
}

#[rstest]
#[case(&["bits", "--flips", "0"], 2)]
#[case(&["bits", "--flips", "3..9"], 2)]
#[case(&["bits", "--length", "99"], 4)]
#[case(&["bits", "--bursts", "30"], 2)]
#[case(&["bits", "--sample", "30"], 2)]
#[case(&["bits", "--jobs", "0"], 2)]
#[case(&["random", "--pd", "77"], 4)]
#[case(&["random", "--faults", "0", "--exchanges", "1000"], 5)]
#[case(&["random", "--dut", "inproc:no-such"], 2)]
#[case(&["random", "--dut", "tcp://127.0.0.1:1"], 3)]
#[case(&["replay", "no/such/file"], 2)]
#[case(&["record", "--dut", "inproc:reference-master"], 2)]
#[case(&["record", "--flips", "0"], 2)]
fn exit_codes_are_those_of_every_command(#[case] args: &[&str], #[case] expected: i32) {
    let (code, told, errors) = campaign(args, &folder(&format!("codes-{}", args.join("-").replace(['/', ':'], "-"))));
    assert_eq!(code, expected, "{told}{errors}");
}
