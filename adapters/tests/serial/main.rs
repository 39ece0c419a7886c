//! DUTs behind a serial line, on pseudo-terminals: boards that boot, babble, hang and go away, and lines that lose octets.
#![cfg(unix)]
#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod ailing;
mod board;
#[path = "../common/mod.rs"]
mod common;
mod port;
mod pty;

use board::*;
use common::*;
use fsct_adapters::frame::encode;
use fsct_adapters::message::*;
use fsct_adapters::{Dut, DutError, Fault, Observation, Seen, Stimulus, connect};
use rstest::rstest;
use std::io::Write;
use std::time::Duration;

/// Time-outs of a board that never answers, of one that answers some requests, and of one that answers each.
const HASTY: &str = "timeout=250ms";
const BRISK: &str = "timeout=1s";
const LENIENT: &str = "timeout=20s";

/// Octets that look like the beginning of a frame of 65535 octets.
const TRAP: [u8; 6] = [0xF5, 0xC7, 0x82, 0x00, 0xFF, 0xFF];

fn apply(dut: &mut dyn Dut, stimuli: &[Stimulus]) -> Result<Vec<Observation>, DutError> {
    let mut observed = Vec::new();
    dut.apply(stimuli, &mut observed).map(|()| observed)
}

fn power() -> [Stimulus; 1] {
    [Stimulus::Power(true)]
}

#[rstest]
#[case::a_boot_message(b"\r\nbootloader 1.0\r\nloading ... done\r\n")]
#[case::what_looks_like_a_frame(&TRAP)]
#[case::noise(&[0x00, 0xF5, 0xFF, 0xF5, 0xC7])]
fn what_is_no_frame_costs_nothing_but_itself(#[case] noise: &'static [u8]) {
    let (port, path) = line();
    let board = board(port, |board| {
        let hello = board.next();
        board.raw(noise);
        board.describe(&hello);
        for _ in 0..2 {
            let request = board.next();
            board.raw(noise);
            board.nothing(&request);
        }
    });
    let mut dut = connect(&address(&path, LENIENT)).unwrap();
    assert_eq!(dut.hello(), Ok(description()));
    assert_eq!(apply(dut.as_mut(), &power()), Ok(vec![]));
    assert_eq!(apply(dut.as_mut(), &power()), Ok(vec![]));
    board.join().unwrap();
}

#[test]
fn what_came_before_the_connection_is_forgotten() {
    let (mut port, path) = line();
    port.write_all(&[b'y'; 3_000]).unwrap();
    // The board is silent now: it is that and not garbage that the connection fails of.
    let error = connect(&address(&path, HASTY)).unwrap().hello().unwrap_err();
    assert_eq!(error, DutError::Timeout { after: Duration::from_millis(250) });
}

#[test]
fn a_hello_without_answer_is_repeated() {
    let (port, path) = line();
    let board = board(port, |board| {
        assert_eq!(board.next().kind, HELLO);
        board.raw(b"still booting");
        let again = board.next();
        board.describe(&again);
        let request = board.next();
        board.nothing(&request);
    });
    let mut dut = connect(&address(&path, BRISK)).unwrap();
    assert_eq!(dut.hello(), Ok(description()));
    assert_eq!(apply(dut.as_mut(), &power()), Ok(vec![]));
    board.join().unwrap();
}

#[test]
fn answers_to_older_requests_are_not_taken_for_new_ones() {
    let (port, path) = line();
    let board = board(port, |board| {
        let hello = board.next();
        let older = hello.sequence.wrapping_sub(1);
        board.send(OBSERVED, older, &[0]);
        board.send(OBSERVED, hello.sequence, &[1]);
        board.send(ERROR, older, b"stimuli came before a hello");
        board.send(DESCRIPTION, older, &[9]);
        board.describe(&hello);
        let request = board.next();
        board.nothing(&request);
    });
    let mut dut = connect(&address(&path, LENIENT)).unwrap();
    assert_eq!(dut.hello(), Ok(description()));
    assert_eq!(apply(dut.as_mut(), &power()), Ok(vec![]));
    board.join().unwrap();
}

#[test]
fn a_repeated_hello_that_is_answered_twice_confuses_nothing() {
    let (port, path) = line();
    let board = board(port, |board| {
        let hellos = [board.next(), board.next()];
        hellos.iter().for_each(|hello| board.describe(hello));
        let request = board.next();
        board.nothing(&request);
    });
    let mut dut = connect(&address(&path, BRISK)).unwrap();
    assert_eq!(dut.hello(), Ok(description()));
    assert_eq!(apply(dut.as_mut(), &power()), Ok(vec![]));
    board.join().unwrap();
}

#[test]
fn a_silent_board_is_asked_three_times() {
    let (port, path) = line();
    let board = board(port, |board| {
        let hellos = [board.next(), board.next(), board.next()].map(|hello| hello.sequence);
        assert!(hellos[1] == hellos[0].wrapping_add(1) && hellos[2] == hellos[1].wrapping_add(1));
    });
    let error = connect(&address(&path, HASTY)).unwrap().hello().unwrap_err();
    assert_eq!(error, DutError::Timeout { after: Duration::from_millis(250) });
    board.join().unwrap();
}

/// As slow as a board can be: an octet of its answer for each time it is asked.
#[test]
fn a_board_that_dribbles_is_a_line_that_fails() {
    let (port, path) = line();
    let board = board(port, |board| {
        let mut octets = Vec::new();
        for position in 0..3 {
            let hello = board.next();
            if octets.is_empty() {
                octets = encode(DESCRIPTION, hello.sequence, &[1]).unwrap();
            }
            board.raw(&octets[position..=position]);
        }
    });
    let error = connect(&address(&path, HASTY)).unwrap().hello().unwrap_err();
    assert_eq!(error.fault(), Fault::Rig);
    assert!(error.to_string().contains("octets that are no frame, beginning \"\\xf5\\xc7\\x81\""), "{error}");
    board.join().unwrap();
}

#[test]
fn a_board_that_babbles_without_end_is_a_line_that_fails() {
    let (port, path) = line();
    board(port, |board| while board.port.write(&[b'y'; 1000]).is_ok() {});
    let error = connect(&address(&path, LENIENT)).unwrap().hello().unwrap_err();
    assert_eq!(error.fault(), Fault::Rig);
    assert!(error.to_string().ends_with("; are cable and baud rate right?"), "{error}");
}

#[test]
fn a_damaged_answer_is_a_fault_of_the_rig_and_stimuli_are_not_repeated() {
    let (port, path) = line();
    let playing = board(port, |board| {
        let hello = board.next();
        board.describe(&hello);
        let request = board.next();
        let mut answer = encode(OBSERVED, request.sequence, &[0]).unwrap();
        *answer.last_mut().unwrap() ^= 1;
        board.raw(&answer);
        // Whatever comes now is the next connection, and not the stimuli again.
        let hello = board.next();
        board.describe(&hello);
    });
    let mut dut = connect(&address(&path, BRISK)).unwrap();
    dut.hello().unwrap();
    let error = apply(dut.as_mut(), &power()).unwrap_err();
    assert!(matches!(error, DutError::Line { .. }) && error.fault() == Fault::Rig, "{error:?}");
    assert!(error.to_string().contains("a frame had the CRC"), "{error}");
    assert_eq!(apply(dut.as_mut(), &power()), Err(error));
    assert_eq!(connect(&address(&path, LENIENT)).unwrap().hello(), Ok(description()));
    playing.join().unwrap();
}

#[test]
fn an_answer_that_comes_too_late_is_not_taken_for_that_to_a_later_request() {
    let (port, path) = line();
    let playing = board(port, |board| {
        let hello = board.next();
        board.describe(&hello);
        let late = board.next();
        let hello = board.next();
        // Now that the next connection is there.
        board.send(OBSERVED, late.sequence, &[0]);
        board.describe(&hello);
        let request = board.next();
        let mut payload = Vec::new();
        pack_observed(&[seen(0, 7, Seen::Unsupported)], 0xFFFF, &mut payload);
        board.send(OBSERVED, request.sequence, &payload);
    });
    let mut dut = connect(&address(&path, BRISK)).unwrap();
    dut.hello().unwrap();
    let error = apply(dut.as_mut(), &power()).unwrap_err();
    assert_eq!(error, DutError::Timeout { after: Duration::from_secs(1) });
    let mut dut = connect(&address(&path, LENIENT)).unwrap();
    dut.hello().unwrap();
    assert_eq!(apply(dut.as_mut(), &power()), Ok(vec![seen(0, 7, Seen::Unsupported)]));
    playing.join().unwrap();
}

/// What only the DUT can have made is its own, line or not.
#[test]
fn a_whole_frame_that_breaks_the_contract_is_a_fault_of_the_dut() {
    let (port, path) = line();
    let board = board(port, |board| {
        let hello = board.next();
        board.describe(&hello);
        let request = board.next();
        board.send(OBSERVED, request.sequence.wrapping_add(1), &[0]);
    });
    let mut dut = connect(&address(&path, LENIENT)).unwrap();
    dut.hello().unwrap();
    let error = apply(dut.as_mut(), &power()).unwrap_err();
    assert!(matches!(error, DutError::Contract { .. }) && error.fault() == Fault::Dut, "{error:?}");
    board.join().unwrap();
}
