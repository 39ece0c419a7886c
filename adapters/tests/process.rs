//! DUTs that are programs, and programs that are no DUT.
#![cfg(unix)]
#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod common;

use common::*;
use fsct_adapters::{Dut, DutError, connect_within};
use rstest::rstest;
use std::io::Read;
use std::time::Duration;

fn greeted(command: &str) -> DutError {
    greeted_within(PATIENT, command)
}

fn greeted_within(timeout: Duration, command: &str) -> DutError {
    let address = format!("exec:{command}").parse().unwrap();
    connect_within(&address, timeout).unwrap().hello().unwrap_err()
}

fn closed(how: &str) -> DutError {
    DutError::Closed { how: how.to_owned() }
}

#[rstest]
#[case::ends_at_once("true", " (exit status: 0)")]
#[case::fails("sh -c 'exit 3'", " (exit status: 3)")]
#[case::is_killed("sh -c 'kill -TERM $$'", " (signal: 15 (SIGTERM))")]
fn a_program_that_ends(#[case] command: &str, #[case] how: &str) {
    assert_eq!(greeted(command), closed(how));
}

#[test]
fn a_program_is_quoted_with_its_last_words() {
    let error = greeted(r#"sh -c 'echo first >&2; printf "no \033[31mlicence\n\n" >&2; exit 3'"#);
    assert_eq!(error, closed(r#" (exit status: 3, its last words "no \u{1b}[31mlicence")"#));
}

#[test]
fn a_program_that_floods_its_standard_error_does_not_stop() {
    let error = greeted("sh -c 'head -c 1000000 /dev/zero | tr \"\\\\0\" x >&2; exit 4'");
    assert_eq!(error, closed(&format!(" (exit status: 4, its last words \"{}\")", "x".repeat(200))));
}

#[test]
fn a_program_that_closes_its_standard_output_and_stays() {
    assert_eq!(greeted("sh -c 'exec >&-; sleep 1000'"), closed(" (it was still running and has been killed)"));
}

#[test]
fn a_program_that_hangs() {
    assert_eq!(greeted_within(SHORT, "sleep 1000"), DutError::Timeout { after: SHORT });
}

#[test]
fn a_program_that_echoes() {
    assert_eq!(greeted("cat"), DutError::Garbage { what: "message 01, which only a harness sends".to_owned() });
}

#[test]
fn a_program_that_babbles() {
    let DutError::Garbage { what } = greeted("yes") else { panic!("it babbles") };
    assert!(what.ends_with("octets that are no frame, beginning \"y\\ny\\ny\\ny\\ny\\ny\\ny\\ny\\n\""), "{what}");
}

#[test]
fn a_program_that_prints_and_ends() {
    let what = "6 octets that are no frame, beginning \"usage\\n\", then the end of the connection (exit status: 1)";
    assert_eq!(greeted("sh -c 'echo usage; exit 1'"), DutError::Garbage { what: what.to_owned() });
}

/// Everything a program has started ends with it: nobody is left who holds the pipe.
#[test]
fn a_program_ends_with_all_it_started() {
    let folder = std::env::temp_dir().join(format!("fsct-process-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let fifo = folder.join("held");
    let made = std::process::Command::new("mkfifo").arg(&fifo).status().unwrap();
    assert!(made.success());
    let command = format!("exec:sh -c 'sleep 1000 >{0} 2>/dev/null & sleep 1000 >{0}'", fifo.display());
    let dut = connect_within(&command.parse().unwrap(), PATIENT).unwrap();
    // Opens once the program holds the other end, and is read to its end once nobody does.
    let mut held = std::fs::File::open(&fifo).unwrap();
    drop(dut);
    assert_eq!(held.read(&mut [0; 1]).unwrap(), 0);
    std::fs::remove_dir_all(&folder).unwrap();
}
