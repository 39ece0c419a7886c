//! Addresses as a command line gives them.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

use fsct_adapters::{Address, Flow, Reset, SerialOptions};
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

fn serial(path: &str, options: SerialOptions) -> Address {
    Address::Serial { path: PathBuf::from(path), options }
}

fn reset_by(program: &str, args: &[&str]) -> SerialOptions {
    let args = args.iter().map(|arg| arg.to_string()).collect();
    SerialOptions { reset: Some(Reset::Command { program: program.to_owned(), args }), ..SerialOptions::default() }
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
#[case("serial:/dev/ttyACM0", serial("/dev/ttyACM0", SerialOptions::default()))]
#[case("serial:COM3?baud=921600", serial("COM3", SerialOptions { baud: 921_600, ..SerialOptions::default() }))]
#[case("serial:x?flow=none&baud=115200", serial("x", SerialOptions::default()))]
#[case(
    "serial:x?flow=hardware&reset=dtr&wait=5s&timeout=500ms",
    serial("x", SerialOptions {
        baud: 115_200,
        flow: Flow::Hardware,
        reset: Some(Reset::Dtr),
        wait: Some(Duration::from_secs(5)),
        timeout: Some(Duration::from_millis(500)),
    })
)]
#[case("serial:x?reset=rts", serial("x", SerialOptions { reset: Some(Reset::Rts), ..SerialOptions::default() }))]
#[case("serial:x?reset-command=./reset --port=1 'a b' \"it's\"", serial("x", reset_by("./reset", &["--port=1", "a b", "it's"])))]
#[case(
    "serial:x?wait=2s&reset-command=sh -c 'reset 2>&1 || reset?a=b'",
    serial("x", SerialOptions {
        wait: Some(Duration::from_secs(2)),
        ..reset_by("sh", &["-c", "reset 2>&1 || reset?a=b"])
    })
)]
fn addresses(#[case] text: &str, #[case] address: Address) {
    assert_eq!(text.parse(), Ok(address.clone()));
    assert_eq!(address.to_string().parse(), Ok(address));
}

#[rstest]
#[case(
    "",
    r#""" begins with no way to reach a DUT (inproc:, lib:, exec:, tcp://, unix: or serial:), did you mean lib:?"#
)]
#[case(
    "tpc://h:1",
    r#""tpc://h:1" begins with no way to reach a DUT (inproc:, lib:, exec:, tcp://, unix: or serial:), did you mean tcp://?"#
)]
#[case(
    "tcp:h:1",
    r#""tcp:h:1" begins with no way to reach a DUT (inproc:, lib:, exec:, tcp://, unix: or serial:), did you mean tcp://?"#
)]
#[case(
    "inprog:x",
    r#""inprog:x" begins with no way to reach a DUT (inproc:, lib:, exec:, tcp://, unix: or serial:), did you mean inproc:?"#
)]
#[case(
    "unix//x\n",
    r#""unix//x\n" begins with no way to reach a DUT (inproc:, lib:, exec:, tcp://, unix: or serial:), did you mean unix:?"#
)]
#[case("lib:?timeout=1s", r#""lib:?timeout=1s" lacks a path"#)]
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
#[case("serial:", r#""serial:" lacks the path of a port"#)]
#[case("serial:?baud=9600", r#""serial:?baud=9600" lacks the path of a port"#)]
#[case(
    "serial:x?speed=9600",
    r#""speed=9600" is no option of a serial line, which has baud, flow, reset, reset-command, wait and timeout"#
)]
#[case(
    "serial:x?",
    r#""" is no option of a serial line, which has baud, flow, reset, reset-command, wait and timeout"#
)]
#[case(
    "serial:x?baud",
    r#""baud" is no option of a serial line, which has baud, flow, reset, reset-command, wait and timeout"#
)]
#[case("serial:x?baud=fast", r#""baud=fast" is not usable, write baud=115200, in bits a second"#)]
#[case("serial:x?baud=0", r#""baud=0" is not usable, write baud=115200, in bits a second"#)]
#[case(
    "serial:x?flow=software",
    r#""flow=software" is not usable, write flow=none or flow=hardware, for frames hold the octets of XON and XOFF"#
)]
#[case("serial:x?flow=rts", r#""flow=rts" is not usable, write flow=none or flow=hardware"#)]
#[case("serial:x?reset=yes", r#""reset=yes" is not usable, write reset=dtr, reset=rts or reset-command=PROGRAM ARGS"#)]
#[case(
    "serial:x?reset-command='a",
    r#""reset-command='a" is not usable, write reset-command=PROGRAM ARGS, each quotation mark with its partner"#
)]
#[case(
    "serial:x?reset-command=",
    r#""reset-command=" is not usable, write reset-command=PROGRAM ARGS, each quotation mark with its partner"#
)]
#[case(
    "serial:x?baud=1&baud=2",
    r#""baud=2" is one option too many, a serial line takes each once and one way to reset"#
)]
#[case(
    "serial:x?reset=dtr&reset-command=a",
    r#""reset-command=a" is one option too many, a serial line takes each once and one way to reset"#
)]
#[case(
    "serial:x?flow=hardware&reset=rts",
    r#""reset=rts" is not usable, write reset=dtr, for RTS belongs to flow=hardware"#
)]
#[case("serial:x?wait=forever", r#""forever" is no time-out; write it as 500ms or 2s, from 1ms to 3600s"#)]
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
    fn a_reset_by_a_command_comes_back(program in "[a-z '\"&]{0,8}x", args in prop::collection::vec("[a-z '\"\t&?=]{0,8}", 0..5)) {
        let args: Vec<&str> = args.iter().map(String::as_str).collect();
        let address = serial("x", SerialOptions { baud: 9600, ..reset_by(&program, &args) });
        prop_assert_eq!(address.to_string().parse(), Ok(address));
    }

    #[test]
    fn no_text_is_too_wild(text in "((inproc|exec|unix|serial):|tcp://)?\\PC{0,30}") {
        let _ = text.parse::<Address>();
    }
}
