//! Every frame of `PROTOCOL.md` with any one bit flipped, or cut anywhere: nothing of it is taken, at either end of a
//! stream.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod common;

use common::says;
use fsct_adapters::frame::{Frame, encode};
use fsct_adapters::message::*;
use fsct_adapters::{Description, Dut, DutError, Fault, Observation, Stimulus, serve_stream};
use std::io::Cursor;
use std::sync::mpsc::{Sender, channel};

const PAGE: &str = include_str!("../PROTOCOL.md");
/// Sequence numbers of the first request and of the second.
const HELLO_SEQUENCE: u8 = 0;
const APPLY_SEQUENCE: u8 = 1;

/// The frames of the page, in order.
fn page() -> Vec<Frame> {
    let blocks = PAGE.split("```hex ").skip(1).map(|block| block.split("```").next().unwrap());
    let octets = blocks.map(|block| {
        let words = block.lines().skip(1).flat_map(|line| line.split('#').next().unwrap().split_whitespace());
        words.map(|word| u8::from_str_radix(word, 16).unwrap()).collect::<Vec<_>>()
    });
    octets.map(|it| Frame { kind: it[2], sequence: it[3], payload: it[6..it.len() - 4].to_vec() }).collect()
}

/// The requests of the page with their answers.
fn exchanges() -> Vec<(Vec<Stimulus>, Vec<u8>)> {
    let mut asked = Vec::new();
    let mut exchanges = Vec::new();
    for Frame { kind, payload, .. } in page() {
        match kind {
            APPLY => asked = unpack_apply(&payload).unwrap(),
            OBSERVED => exchanges.push((asked.clone(), payload)),
            _ => {}
        }
    }
    exchanges
}

/// All that can become of a frame by one bit or by its end.
fn damages(kind: u8, sequence: u8, payload: &[u8]) -> impl Iterator<Item = Vec<u8>> {
    let whole = encode(kind, sequence, payload).unwrap();
    let cuts = (0..whole.len()).map({
        let whole = whole.clone();
        move |end| whole[..end].to_vec()
    });
    let flips = (0..8 * whole.len()).map(move |bit| {
        let mut flipped = whole.clone();
        flipped[bit / 8] ^= 1 << (bit % 8);
        flipped
    });
    cuts.chain(flips)
}

fn is_to_blame(error: &DutError) {
    assert_eq!(error.fault(), Fault::Dut);
    assert!(matches!(error, DutError::Closed { .. } | DutError::Garbage { .. }), "{error}");
}

#[test]
fn a_damaged_description_is_none() {
    let descriptions: Vec<Frame> = page().into_iter().filter(|frame| frame.kind == DESCRIPTION).collect();
    assert_eq!(descriptions.len(), 3);
    for Frame { kind, payload, .. } in descriptions {
        for octets in damages(kind, HELLO_SEQUENCE, &payload) {
            is_to_blame(&says(octets).hello().unwrap_err());
        }
    }
}

#[test]
fn a_damaged_observation_is_none() {
    let description = page().into_iter().find(|frame| frame.kind == DESCRIPTION).unwrap();
    let greeting = encode(DESCRIPTION, HELLO_SEQUENCE, &description.payload).unwrap();
    let exchanges = exchanges();
    assert_eq!(exchanges.len(), 8);
    for (stimuli, payload) in exchanges {
        let greeted = |octets: Vec<u8>| {
            let mut dut = says([&greeting[..], &octets].concat());
            dut.hello().unwrap();
            let mut observed = Vec::new();
            (dut.apply(&stimuli, &mut observed), observed)
        };
        let mut expected = Vec::new();
        unpack_observed(&payload, &mut expected).unwrap();
        assert_eq!(greeted(encode(OBSERVED, APPLY_SEQUENCE, &payload).unwrap()), (Ok(()), expected));
        for octets in damages(OBSERVED, APPLY_SEQUENCE, &payload) {
            let (outcome, observed) = greeted(octets);
            is_to_blame(&outcome.unwrap_err());
            assert_eq!(observed, []);
        }
    }
}

/// What is no answer does not become one by a bit.
#[test]
fn a_damaged_request_is_no_answer() {
    for Frame { kind, payload, .. } in page().into_iter().filter(|frame| [HELLO, APPLY, ERROR].contains(&frame.kind)) {
        for octets in damages(kind, HELLO_SEQUENCE, &payload) {
            is_to_blame(&says(octets).hello().unwrap_err());
        }
    }
}

/// Hands on what it is asked to do.
struct Told(Sender<Vec<Stimulus>>);

impl Dut for Told {
    fn hello(&mut self) -> Result<Description, DutError> {
        let description = page().into_iter().find(|frame| frame.kind == DESCRIPTION).unwrap();
        let Described::As(description, _) = unpack_description(&description.payload).unwrap() else { panic!() };
        Ok(description)
    }

    fn apply(&mut self, stimuli: &[Stimulus], _: &mut Vec<Observation>) -> Result<(), DutError> {
        self.0.send(stimuli.to_vec()).unwrap();
        Ok(())
    }
}

/// Serves a DUT to these octets behind a hello: what it was asked to do, and how much was answered.
fn served(octets: &[u8]) -> (Vec<Vec<Stimulus>>, usize) {
    let hello = encode(HELLO, HELLO_SEQUENCE, &Hello::OURS.pack()).unwrap();
    let (to_test, told) = channel();
    let mut answers = Vec::new();
    serve_stream(Cursor::new([&hello[..], octets].concat()), &mut answers, Box::new(Told(to_test))).unwrap();
    (told.iter().collect(), answers.len())
}

#[test]
fn a_damaged_request_is_none() {
    let (nothing, greeted) = served(&[]);
    assert_eq!(nothing, [] as [Vec<Stimulus>; 0]);
    for Frame { kind, sequence, payload } in page().into_iter().filter(|frame| frame.kind == APPLY) {
        let (told, _) = served(&encode(kind, sequence, &payload).unwrap());
        assert_eq!(told, [unpack_apply(&payload).unwrap()]);
        for octets in damages(kind, sequence, &payload) {
            assert_eq!(served(&octets), (vec![], greeted));
        }
    }
}
