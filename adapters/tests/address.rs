//! Addresses as a command line gives them.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

use fsct_adapters::Address;
use proptest::prelude::*;
use rstest::rstest;
use std::path::PathBuf;
use std::time::Duration;

fn tcp(host: &str, port: u16, timeout: Option<u64>) -> Address {
    Address::Tcp { host: host.to_owned(), port, timeout: timeout.map(Duration::from_millis) }
}

fn inproc(name: &str, query: &[(&str, &str)]) -> Address {
    let owned = |(key, value): &(&str, &str)| (key.to_string(), value.to_string());
    Address::Inproc { name: name.to_owned(), query: query.iter().map(owned).collect() }
}

fn exec(program: &str, args: &[&str]) -> Address {
    Address::Exec { program: program.to_owned(), args: args.iter().map(|arg| arg.to_string()).collect() }
}

fn lib(path: &str, timeout: Option<u64>) -> Address {
    Address::Lib { path: PathBuf::from(path), timeout: timeout.map(Duration::from_millis) }
}

fn unix(path: &str, timeout: Option<u64>) -> Address {
    Address::Unix { path: PathBuf::from(path), timeout: timeout.map(Duration::from_millis) }
}

#[rstest]
#[case("inproc:reference-device", inproc("reference-device", &[]))]
#[case("inproc:x?mutant=a=b&latency=", inproc("x", &[("mutant", "a=b"), ("latency", "")]))]
#[case("exec:./simulator --flag", exec("./simulator", &["--flag"]))]
#[case("exec:  a \t b\n", exec("a", &["b"]))]
#[case("exec:'my sim' \"it's\" '' a'b c'd", exec("my sim", &["it's", "", "ab cd"]))]
#[case("tcp://localhost:5061", tcp("localhost", 5061, None))]
#[case("tcp://[::1]:0?timeout=500ms", tcp("::1", 0, Some(500)))]
#[case("tcp://h:1?timeout=2s", tcp("h", 1, Some(2000)))]
#[case("lib:./libvendor.so?timeout=3s", lib("./libvendor.so", Some(3000)))]
#[case("unix:/run/dut.sock", unix("/run/dut.sock", None))]
#[case("unix:dut.sock?timeout=1ms", unix("dut.sock", Some(1)))]
fn addresses(#[case] text: &str, #[case] address: Address) {
    assert_eq!(text.parse(), Ok(address.clone()));
    assert_eq!(address.to_string().parse(), Ok(address));
}

#[rstest]
#[case("", r#""" begins with no way to reach a DUT (inproc:, lib:, exec:, tcp:// or unix:), did you mean lib:?"#)]
#[case(
    "tpc://h:1",
    r#""tpc://h:1" begins with no way to reach a DUT (inproc:, lib:, exec:, tcp:// or unix:), did you mean tcp://?"#
)]
#[case(
    "tcp:h:1",
    r#""tcp:h:1" begins with no way to reach a DUT (inproc:, lib:, exec:, tcp:// or unix:), did you mean tcp://?"#
)]
#[case(
    "inprog:x",
    r#""inprog:x" begins with no way to reach a DUT (inproc:, lib:, exec:, tcp:// or unix:), did you mean inproc:?"#
)]
#[case(
    "unix//x\n",
    r#""unix//x\n" begins with no way to reach a DUT (inproc:, lib:, exec:, tcp:// or unix:), did you mean unix:?"#
)]
#[case("lib:?timeout=1s", r#""lib:?timeout=1s" lacks a path"#)]
#[case(
    "serial:/dev/ttyACM0",
    "serial: is not in this version; the ways to reach a DUT are inproc:, lib:, exec:, tcp:// and unix:"
)]
#[case("inproc:?a=b", r#""inproc:?a=b" lacks the name of a DUT"#)]
#[case("exec: ", r#""exec: " lacks a program"#)]
#[case("exec:'' x", r#""exec:'' x" lacks a program"#)]
#[case("exec:a 'b", r#""exec:a 'b" has a quotation mark ' without its partner"#)]
#[case("tcp://localhost", r#""tcp://localhost" lacks a port"#)]
#[case("tcp://[::1]", r#""tcp://[::1]" lacks a port"#)]
#[case("tcp://:80", r#""tcp://:80" lacks a host"#)]
#[case("tcp://h:65536", r#""65536" is no port from 0 to 65535"#)]
#[case("unix:", r#""unix:" lacks a path"#)]
#[case("tcp://h:1?timeout", r#""timeout" is no option of this address, which has only timeout=.."#)]
#[case("tcp://h:1?baud=9600", r#""baud=9600" is no option of this address, which has only timeout=.."#)]
#[case("unix:x?timeout=1s&timeout=2s", r#""timeout=2s" is no option of this address, which has only timeout=.."#)]
#[case("tcp://h:1?timeout=5", r#""5" is no time-out; write it as 500ms or 2s, from 1ms to 3600s"#)]
#[case("tcp://h:1?timeout=0s", r#""0s" is no time-out; write it as 500ms or 2s, from 1ms to 3600s"#)]
#[case("tcp://h:1?timeout=3601s", r#""3601s" is no time-out; write it as 500ms or 2s, from 1ms to 3600s"#)]
fn faults(#[case] text: &str, #[case] sentence: &str) {
    assert_eq!(text.parse::<Address>().unwrap_err().to_string(), sentence);
}

proptest! {
    #[test]
    fn a_command_line_comes_back(program in "[a-z '\"]{0,8}x", args in prop::collection::vec("[a-z '\"\t\\\\?]{0,8}", 0..5)) {
        let address = Address::Exec { program, args };
        prop_assert_eq!(address.to_string().parse(), Ok(address));
    }

    #[test]
    fn no_text_is_too_wild(text in "((inproc|exec|unix):|tcp://)?\\PC{0,30}") {
        let _ = text.parse::<Address>();
    }
}
