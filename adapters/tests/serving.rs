//! A served DUT is the DUT itself, whatever carries it and whoever else calls.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod common;

use common::*;
use fsct_adapters::frame::{Decoder, Frame, encode};
use fsct_adapters::message::*;
use fsct_adapters::{
    Address, Dut, DutError, Line, Listener, MAX_BATCH, MAX_CONNECTIONS, Observation, Response, SmiService, Stimulus,
    connect, serve_stream,
};
use proptest::collection::vec;
use proptest::prelude::*;
use rstest::rstest;
use std::collections::VecDeque;
use std::io::{ErrorKind, Read, Write};
use std::net::TcpStream;

fn socket_path(name: &str) -> std::path::PathBuf {
    std::env::temp_dir().join(format!("fsct-{name}-{}.sock", std::process::id()))
}

fn address(kind: &str, name: &str) -> String {
    match kind {
        "tcp" => "tcp://127.0.0.1:0".to_owned(),
        "tcp6" => "tcp://[::1]:0".to_owned(),
        _ => format!("unix:{}", socket_path(name).display()),
    }
}

fn apply(dut: &mut dyn Dut, stimuli: &[Stimulus]) -> Vec<Observation> {
    let mut observed = Vec::new();
    dut.apply(stimuli, &mut observed).unwrap();
    observed
}

fn one_of_each() -> Vec<Stimulus> {
    vec![
        Stimulus::Configure(variant()),
        Stimulus::Power(true),
        Stimulus::Advance { ns: 7 },
        exchange(&[1, 2, 3]),
        Stimulus::Exchange { port: 1, octets: None },
        Stimulus::Read { index: 0x10, subindex: 0 },
        Stimulus::Read { index: 0x11, subindex: 0 },
        Stimulus::Write { index: 0x10, subindex: 1, data: vec![9; 232] },
        Stimulus::Set { port: 1, service: fsct_adapters::Service::PdinD, value: octets(&[1]) },
        Stimulus::Plug { port: 2, device: Some(identity()) },
        Stimulus::Drive { port: 2, line: Line::Cq, level: true },
        Stimulus::Drive { port: 2, line: Line::Cq, level: false },
        Stimulus::Respond { port: 2, response: Response::Written },
        Stimulus::Raise { port: 2, code: 0xB002, qualifier: 0x74 },
        smi(SmiService::PortStatus),
        smi(SmiService::PdOutIq),
        Stimulus::Plug { port: 2, device: None },
        Stimulus::Other { kind: 200, octets: vec![1; 255] },
    ]
}

#[rstest]
#[case("tcp")]
#[case("unix")]
fn a_served_dut_answers_as_it_does_in_place(#[case] kind: &str) {
    let server = served(&address(kind, "same"));
    let mut dut = connect(&server.address).unwrap();
    assert_eq!(dut.hello(), Ok(description()));
    assert_eq!(apply(&mut dut, &one_of_each()), apply(&mut Mirror::default(), &one_of_each()));
    assert_eq!(apply(&mut dut, &[]), []);
    assert_eq!(dut.hello(), Ok(description()));
}

#[rstest]
#[case("tcp")]
#[case("unix")]
fn a_hundred_thousand_exchanges_in_one_go(#[case] kind: &str) {
    let server = served(&address(kind, "many"));
    let mut dut = connect(&server.address).unwrap();
    dut.hello().unwrap();
    let stimuli: Vec<_> = (0..100_000u32).map(|number| exchange(&number.to_be_bytes())).collect();
    let observed = apply(&mut dut, &stimuli);
    assert_eq!(observed, apply(&mut Mirror::default(), &stimuli));
    assert_eq!(usize::from(observed.last().unwrap().stimulus), 99_999 - MAX_BATCH);
}

#[test]
fn each_connection_has_a_fresh_dut() {
    let server = served("tcp://127.0.0.1:0");
    let mut observed = Vec::new();
    for _ in 0..2 {
        let mut dut = connect(&server.address).unwrap();
        dut.hello().unwrap();
        observed.push(apply(&mut dut, &[Stimulus::Advance { ns: 5 }, exchange(&[2])]));
    }
    assert_eq!(observed[0], observed[1]);
}

#[test]
fn a_dut_that_panics_or_fails_ends_its_own_connection_only() {
    let server = served("tcp://127.0.0.1:0");
    let write = |data: &[u8]| [Stimulus::Write { index: 0, subindex: 0, data: data.to_vec() }];
    let mut other = connect(&server.address).unwrap();
    other.hello().unwrap();
    let mut panicking = connect(&server.address).unwrap();
    panicking.hello().unwrap();
    let closed = DutError::Closed { how: String::new() };
    assert_eq!(panicking.apply(&write(b"panic"), &mut Vec::new()), Err(closed));
    let mut failing = connect(&server.address).unwrap();
    failing.hello().unwrap();
    let what = r#"it reported "the DUT fails on demand""#.to_owned();
    assert_eq!(failing.apply(&write(b"fail"), &mut Vec::new()), Err(DutError::Contract { what }));
    assert_eq!(apply(&mut other, &[exchange(&[2])]).len(), 1);
}

#[test]
fn one_connection_too_many_is_told_so() {
    let server = served("tcp://127.0.0.1:0");
    let connections: Vec<_> = (0..MAX_CONNECTIONS).map(|_| connect(&server.address).unwrap()).collect();
    let what = r#"it reported "64 connections are open, which is the most""#.to_owned();
    let error = connect(&server.address).unwrap().hello().unwrap_err();
    // Closing may overtake the text when the greeting is on its way.
    assert!([DutError::Contract { what }, DutError::Closed { how: String::new() }].contains(&error), "{error}");
    drop(connections);
}

#[test]
fn a_stopped_server_ends_its_connections() {
    let server = served("tcp://127.0.0.1:0");
    let mut dut = connect(&server.address).unwrap();
    dut.hello().unwrap();
    server.stop.stop();
    server.stop.stop();
    let outcome = dut.apply(&[Stimulus::Power(true)], &mut Vec::new());
    assert_eq!(outcome, Err(DutError::Closed { how: String::new() }));
}

#[cfg(unix)]
#[test]
fn a_socket_left_over_is_replaced_and_nothing_else() {
    let path = socket_path("left");
    let address: Address = format!("unix:{}", path.display()).parse().unwrap();
    drop(std::os::unix::net::UnixListener::bind(&path).unwrap());
    assert!(path.exists());
    let listener = Listener::bind(&address).unwrap();
    let error = Listener::bind(&address).unwrap_err().to_string();
    assert!(error.starts_with(&format!("cannot listen at {address}: ")), "{error}");
    drop(listener);
    assert!(!path.exists());
    std::fs::write(&path, "precious").unwrap();
    Listener::bind(&address).unwrap_err();
    assert_eq!(std::fs::read_to_string(&path).unwrap(), "precious");
    std::fs::remove_file(&path).unwrap();
}

#[test]
fn some_addresses_are_no_place_to_listen_at() {
    for text in ["inproc:x", "exec:cat"] {
        let error = Listener::bind(&text.parse().unwrap()).unwrap_err();
        let expected = format!("{text} is no place to listen at; use tcp://HOST:PORT or unix:PATH");
        assert_eq!(error.to_string(), expected);
    }
    assert!(Listener::stdio().address().is_err());
}

/// What a mirror answers to this stream.
fn answered(input: &[u8]) -> Vec<Frame> {
    let mut output = Vec::new();
    serve_stream(input, &mut output, Box::<Mirror>::default()).unwrap();
    let mut decoder = Decoder::new();
    decoder.push(&output);
    std::iter::from_fn(|| decoder.next_frame()).collect()
}

fn request(kind: u8, sequence: u8, payload: &[u8]) -> Vec<u8> {
    encode(kind, sequence, payload).unwrap()
}

fn reported(sequence: u8, text: &str) -> Frame {
    Frame { kind: ERROR, sequence, payload: text.as_bytes().to_vec() }
}

#[test]
fn what_cannot_be_understood_is_reported() {
    let hello = request(HELLO, 1, &Hello::OURS.pack());
    assert_eq!(answered(&request(APPLY, 3, &[0, 0])), [reported(3, "stimuli came before a hello")]);
    assert_eq!(answered(&request(HELLO, 4, &[1])), [reported(4, "the payload ends within the versions")]);
    assert_eq!(answered(&request(0x44, 5, &[])), [reported(5, "unknown message 44")]);
    let frames = answered(&[hello, request(APPLY, 6, &[0, 1]), request(APPLY, 7, &[0, 0])].concat());
    assert_eq!(frames[1], reported(6, "1 stimuli are announced, 0 are there"));
    assert_eq!(frames[2], Frame { kind: OBSERVED, sequence: 7, payload: vec![0] });
}

#[test]
fn a_harness_of_later_versions_learns_ours() {
    let described = |min, max| answered(&request(HELLO, 0, &Hello { min, max }.pack())).remove(0).payload;
    assert_eq!(described(2, 9), [VERSION]);
    assert_eq!(unpack_description(&described(1, 9)).unwrap(), unpack_description(&described(1, 1)).unwrap());
    assert!(described(0, 1).len() > 1);
}

#[test]
fn a_harness_that_babbles_without_end_is_told_so() {
    let frames = answered(&[b'?'; 200_000]);
    assert_eq!(frames.len(), 1);
    assert_eq!(frames[0].kind, ERROR);
}

#[test]
fn a_harness_that_babbles_or_leaves_harms_nobody() {
    let server = served("tcp://127.0.0.1:0");
    let Address::Tcp { host, port, .. } = &server.address else { panic!("it is a socket") };
    let mut babbling = TcpStream::connect((host.as_str(), *port)).unwrap();
    // The server may have had enough before all is written.
    let _ = babbling.write_all(&[b'?'; 200_000]);
    let _ = babbling.read_to_end(&mut Vec::new());
    let mut leaving = TcpStream::connect((host.as_str(), *port)).unwrap();
    leaving.write_all(&request(HELLO, 0, &[1, 1])[..5]).unwrap();
    drop(leaving);
    assert_eq!(connect(&server.address).unwrap().hello(), Ok(description()));
}

/// A line on which these pieces come with silence between them.
struct Wire(VecDeque<Vec<u8>>, bool);

impl Read for Wire {
    fn read(&mut self, octets: &mut [u8]) -> std::io::Result<usize> {
        self.1 = !self.1;
        if self.1 {
            return Err(ErrorKind::TimedOut.into());
        }
        let piece = self.0.pop_front().unwrap_or_default();
        octets[..piece.len()].copy_from_slice(&piece);
        Ok(piece.len())
    }
}

#[test]
fn on_a_line_an_unfinished_request_is_forgotten_and_what_it_swallowed_is_answered() {
    let hello = request(HELLO, 1, &Hello::OURS.pack());
    let pieces = [hello[..7].to_vec(), [&[0xF5, 0xC7, APPLY, 9, 0xFF, 0xFF][..], &hello].concat(), hello.clone()];
    let mut output = Vec::new();
    serve_stream(Wire(pieces.into(), false), &mut output, Box::<Mirror>::default()).unwrap();
    let mut decoder = Decoder::new();
    decoder.push(&output);
    assert_eq!(std::iter::from_fn(|| decoder.next_frame()).filter(|frame| frame.kind == DESCRIPTION).count(), 2);
}

#[test]
fn long_answers_come_in_several_frames() {
    let mut payload = Vec::new();
    let stimuli = vec![Stimulus::Read { index: 0x10, subindex: 0 }; 200];
    pack_apply(&stimuli, 0xFFFF, 200, &mut payload);
    let frames = answered(&[request(HELLO, 0, &[1, 1]), request(APPLY, 1, &payload)].concat());
    assert!(frames.len() > 2);
    let mut observed = Vec::new();
    let more: Vec<_> =
        frames[1..].iter().map(|frame| unpack_observed(&frame.payload, &mut observed).unwrap()).collect();
    assert_eq!(more.iter().filter(|more| !**more).count(), 1);
    assert_eq!(more.last(), Some(&false));
    assert_eq!(observed, apply(&mut Mirror::default(), &stimuli));
}

proptest! {
    #[test]
    fn no_stream_is_too_wild_for_a_server(
        requests in vec((prop::sample::select(&[HELLO, APPLY, 9][..]), any::<u8>(), vec(any::<u8>(), 0..40)), 0..10),
        garbage in vec(any::<u8>(), 0..20),
    ) {
        let hello = request(HELLO, 0, &[1, 1]);
        let wild = requests.iter().map(|(kind, sequence, payload)| request(*kind, *sequence, payload));
        let stream: Vec<u8> = std::iter::once(hello).chain(wild).flat_map(|r| [garbage.clone(), r].concat()).collect();
        answered(&stream);
    }
}
