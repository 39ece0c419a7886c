//! `fsct doctor`: what a DUT is and which suites apply, or whose fault it is that nothing can be said.

mod cli;

use cli::{Folder, fsct};
use rstest::rstest;

#[rstest]
#[case("device", "FS-Device, 1 port\n", "suite     device-counter         192 cases apply\n", "is for a master")]
#[case("master", "FS-Master, 2 ports\n", "suite     master-tours           24 cases apply\n", "is for a device")]
fn it_tells_what_a_dut_is_and_what_applies(
    #[case] dut: &str,
    #[case] role: &str,
    #[case] suite: &str,
    #[case] left_out: &str,
) {
    let outcome = fsct(&["doctor", "--dut", &format!("inproc:reference-{dut}")]);
    assert_eq!((outcome.code, outcome.err.as_str()), (0, ""));
    for text in
        [role, suite, left_out, "clock     virtual, resolution 1 ns", "over 200 round trips", "answered `unsupported`"]
    {
        assert!(outcome.out.contains(text), "{text:?} is missing in\n{}", outcome.out);
    }
}

#[test]
fn a_program_reads_the_same() {
    let outcome = fsct(&["doctor", "--dut", "inproc:reference-device", "--json"]);
    let told: serde_json::Value = serde_json::from_str(&outcome.out).expect("it is JSON");
    assert_eq!(told["dut"]["role"], "device");
    assert_eq!(told["not_served"], serde_json::json!([]));
    assert!(told["latency_ns"]["p99"].as_u64() >= told["latency_ns"]["median"].as_u64());
    let suites = told["suites"].as_array().expect("a list");
    assert!(suites.iter().any(|suite| suite["suite"] == "device-counter" && suite["applies"] == 192));
}

#[rstest]
#[case::nobody_there("tcp://127.0.0.1:1", "cannot be reached", "look at the rig")]
#[case::ends_at_once("exec:false", "closed the connection (exit status: 1)", "look at the DUT")]
#[case::silent("exec:sleep 60", "no complete answer within 2s", "look at the DUT")]
#[case::echo("exec:cat", "which only a harness sends", "look at the DUT")]
#[cfg(unix)]
fn it_tells_whose_fault_it_is(#[case] url: &str, #[case] what: &str, #[case] whose: &str) {
    let outcome = fsct(&["doctor", "--dut", url]);
    assert_eq!(outcome.code, 3, "{outcome:?}");
    assert!(outcome.err.contains(what) && outcome.err.contains(whose), "{}", outcome.err);
}

#[test]
fn a_profile_for_the_other_role_is_a_mistake() {
    let outcome = fsct(&["doctor", "--dut", "inproc:reference-device", "--profile", "reference-master"]);
    assert_eq!(outcome.code, 2);
    assert!(outcome.err.contains("is for a master, the DUT says it is a device"), "{}", outcome.err);
}

#[test]
fn words_of_the_dut_are_shown_harmless() {
    let folder = Folder::new("doctor");
    // A description whose product would clear the screen.
    let product = "\x1b[2Jcurtain";
    let script = folder.file("dut.sh", &hostile(product));
    let outcome = fsct(&["doctor", "--dut", &format!("exec:sh {script}")]);
    assert!(!outcome.out.contains('\x1b') && !outcome.err.contains('\x1b'), "{outcome:?}");
}

/// A script that answers every hello with a description, and then ends.
fn hostile(product: &str) -> String {
    use fsct_adapters::{Clock, ClockKind, Description, Pco, Role, frame, message};
    let description = Description {
        role: Role::Device,
        ports: 1,
        pcos: vec![Pco::Power, Pco::Link],
        offers: fsct_harness::library::EVERYTHING.to_vec(),
        clock: Clock { kind: ClockKind::Virtual, resolution_ns: 1, uncertainty_ns: 0 },
        vendor: product.to_owned(),
        product: product.to_owned(),
        version: String::new(),
    };
    let payload = message::pack_description(&description, message::Limits::LEAST);
    let hello = frame::encode(message::DESCRIPTION, 0, &payload).expect("it fits");
    let mut refused = message::pack_error(product);
    refused = frame::encode(message::ERROR, 1, &refused).expect("it fits");
    let octal = |octets: &[u8]| octets.iter().map(|octet| format!("\\{octet:03o}")).collect::<String>();
    format!("printf '{}'\nprintf '{}'\ncat >/dev/null\n", octal(&hello), octal(&refused))
}
