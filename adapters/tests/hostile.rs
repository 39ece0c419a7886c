//! DUTs that mean harm: sound frames at the wrong time, a drip, and no end.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod common;

use common::*;
use fsct_adapters::frame::{MAX_GARBAGE, MAX_PAYLOAD, encode};
use fsct_adapters::message::*;
use fsct_adapters::{Dut, DutError, FLOOD_PER_STIMULUS, FLOOD_SLACK, Observation, Peer, Seen, Stimulus, StreamDut};
use rstest::rstest;
use std::io::{self, Read, sink};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::time::Duration;

/// A description in answer to the hello; `requests`: what it takes at once.
fn described(requests: u8) -> Vec<u8> {
    let limits = Limits { payload: MIN_PAYLOAD, requests };
    encode(DESCRIPTION, 0, &pack_description(&description(), limits)).unwrap()
}

/// `count` images in answer to as many exchanges.
fn images(sequence: u8, count: u16) -> Vec<u8> {
    let images: Vec<_> = (0..count).map(image).collect();
    let mut payload = Vec::new();
    pack_observed(&images, MAX_PAYLOAD, &mut payload);
    encode(OBSERVED, sequence, &payload).unwrap()
}

fn image(stimulus: u16) -> Observation {
    seen(stimulus, 0, Seen::Image { port: 1, octets: None })
}

fn wrong_number(answered: u8, due: u8) -> DutError {
    DutError::Contract { what: format!("it answered sequence number {answered} where {due} is due") }
}

#[test]
fn it_replays_an_earlier_answer() {
    let mut dut = says([described(1), images(1, 1), images(1, 1)].concat());
    dut.hello().unwrap();
    let mut observed = Vec::new();
    assert_eq!(dut.apply(&[exchange(&[1])], &mut observed), Ok(()));
    assert_eq!(dut.apply(&[exchange(&[2])], &mut observed), Err(wrong_number(1, 2)));
    assert_eq!(observed, [image(0)]);
}

#[test]
fn it_replays_its_description() {
    let mut dut = says([described(1), described(1)].concat());
    dut.hello().unwrap();
    let another = DutError::Contract { what: "it answered message 81 where 82 is due".to_owned() };
    assert_eq!(dut.apply(&[exchange(&[1])], &mut Vec::new()), Err(another));
}

/// Of exchanges of 32 octets 13 fit into one request.
#[rstest]
#[case::in_order([1, 2], Ok(()), 26)]
#[case::out_of_order([2, 1], Err(wrong_number(2, 1)), 0)]
#[case::the_first_twice([1, 1], Err(wrong_number(1, 2)), 13)]
#[case::the_second_twice([2, 2], Err(wrong_number(2, 1)), 0)]
fn two_requests_are_answered_in_order(
    #[case] answers: [u8; 2],
    #[case] outcome: Result<(), DutError>,
    #[case] taken: usize,
) {
    let [one, other] = answers.map(|sequence| images(sequence, 13));
    let mut dut = says([described(2), one, other].concat());
    dut.hello().unwrap();
    let mut observed = Vec::new();
    assert_eq!(dut.apply(&vec![exchange(&[0; 32]); 26], &mut observed), outcome);
    assert_eq!(observed, (0..26).map(image).take(taken).collect::<Vec<_>>());
}

/// The answer to the next request, before it is asked.
#[test]
fn it_answers_before_it_is_asked() {
    // Nothing tells it from an answer that comes very soon.
    let mut dut = says([described(1), images(1, 1), images(2, 1)].concat());
    dut.hello().unwrap();
    for _ in 0..2 {
        assert_eq!(dut.apply(&[exchange(&[1])], &mut Vec::new()), Ok(()));
    }
    assert_eq!(dut.hello(), Err(DutError::Closed { how: String::new() }));
}

/// Gives one octet at a time, and a moment passes before each, until the harness hangs up.
struct Drip {
    octets: std::vec::IntoIter<u8>,
    hung_up: Receiver<()>,
}

impl Read for Drip {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        let _ = self.hung_up.recv_timeout(Duration::from_millis(10));
        match (self.octets.next(), into.first_mut()) {
            (Some(octet), Some(place)) => {
                *place = octet;
                Ok(1)
            }
            _ => Ok(0),
        }
    }
}

/// The harness's hold on such a stream.
struct HangUp(Option<Sender<()>>);

impl Peer for HangUp {
    fn close(&mut self) -> String {
        self.0 = None;
        String::new()
    }
}

/// Were the limit one for each octet, the description would come in the end.
#[test]
fn it_drips() {
    let mut changed = description();
    changed.product = "slow".repeat(60);
    changed.vendor = "slow".repeat(60);
    let octets = encode(DESCRIPTION, 0, &pack_description(&changed, Limits::LEAST)).unwrap().into_iter();
    let (hold, hung_up) = channel();
    let mut dut = StreamDut::new(Drip { octets, hung_up }, sink(), Box::new(HangUp(Some(hold))), SHORT);
    assert_eq!(dut.hello(), Err(DutError::Timeout { after: SHORT }));
}

/// A stream without end, and how much of it has been taken.
struct Endless {
    start: io::Cursor<Vec<u8>>,
    again: Vec<u8>,
    at: usize,
    taken: Arc<AtomicUsize>,
}

impl Read for Endless {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        let count = match self.start.read(into)? {
            0 => {
                for place in into.iter_mut() {
                    *place = self.again[self.at];
                    self.at = (self.at + 1) % self.again.len();
                }
                into.len()
            }
            count => count,
        };
        self.taken.fetch_add(count, Ordering::Relaxed);
        Ok(count)
    }
}

/// A frame that says more will come.
fn more(seen_: Seen) -> Vec<u8> {
    let mut payload = Vec::new();
    pack_observed(&[seen(0, 0, seen_)], MAX_PAYLOAD, &mut payload);
    payload[0] = 1;
    encode(OBSERVED, 1, &payload).unwrap()
}

fn request(octets: usize) -> Seen {
    Seen::Request { port: 1, index: 0x4202, subindex: 0, data: Some(vec![0; octets]) }
}

/// However much a DUT would send, little is taken, and less is remembered.
#[rstest]
#[case::noise(vec![0x47], "octets that are no frame, beginning")]
#[case::sync(vec![0xF5], "octets that are no frame, beginning")]
#[case::headers(vec![0xF5, 0xC7, 0x82, 1, 0x70, 0], "octets that are no frame, beginning")]
#[case::the_longest_frame(encode(OBSERVED, 1, &[1; MAX_PAYLOAD]).unwrap(), "an image has 257 octets")]
#[case::a_frame_of_nothing(encode(OBSERVED, 1, &[1]).unwrap(), "announces more observations and holds none")]
#[case::descriptions(described(1), "it answered message 81 where 82 is due")]
#[case::events(more(Seen::Event { code: 1, qualifier: 2 }), "more than 1088 observations to one batch")]
#[case::the_longest_requests(more(request(232)), "more than 1088 observations to one batch")]
#[case::requests_longer_than_that(more(request(60_000)), "a write of on-request data has 60005 octets")]
fn it_sends_gigabytes(#[case] again: Vec<u8>, #[case] says: &str) {
    let taken = Arc::new(AtomicUsize::new(0));
    let stream = Endless { start: io::Cursor::new(described(1)), again, at: 0, taken: taken.clone() };
    let mut dut = StreamDut::new(stream, sink(), Box::new(Gone), PATIENT);
    dut.hello().unwrap();
    let mut observed = Vec::new();
    let error = dut.apply(&[Stimulus::Power(true)], &mut observed).unwrap_err();
    assert!(error.to_string().contains(says), "{error}");
    assert!(observed.len() <= FLOOD_PER_STIMULUS + FLOOD_SLACK);
    let taken = taken.load(Ordering::Relaxed);
    assert!(taken <= 16 * MAX_GARBAGE, "{taken} octets were taken");
}
