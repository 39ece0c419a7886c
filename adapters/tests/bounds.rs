//! Bounds somebody states are kept: the time-out of an address, the limits of a DUT, what is remembered of a program.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod common;

use common::*;
use fsct_adapters::frame::{Decoder, Frame, MAX_PAYLOAD, encode};
use fsct_adapters::message::*;
use fsct_adapters::{
    Address, Description, Dut, DutError, Entry, Happened, Keep, Observation, Recorder, Seen, SmiRequest, SmiService,
    Stimulus, connect_within,
};
use rstest::rstest;
use std::io::{Read, Write};
use std::net::TcpStream;
use std::sync::mpsc::channel;

/// Answers every request of a connection and gives each to `look`, until the harness leaves.
fn answer_all(mut socket: TcpStream, mut answer: impl FnMut(&Frame) -> (u8, Vec<u8>)) {
    let mut decoder = Decoder::new();
    let mut buffer = [0; 4096];
    while let Ok(count @ 1..) = socket.read(&mut buffer) {
        decoder.push(&buffer[..count]);
        while let Some(frame) = decoder.next_frame() {
            let (kind, payload) = answer(&frame);
            // A harness that leaves early shows in what it sent.
            let _ = socket.write_all(&encode(kind, frame.sequence, &payload).unwrap());
        }
    }
}

#[test]
fn the_time_out_of_the_address_outranks_the_default() {
    let silent = peer(|mut socket| while matches!(socket.read(&mut [0; 64]), Ok(1..)) {});
    let Address::Tcp { host, port, .. } = silent else { panic!("it is a socket") };
    let address = Address::Tcp { host, port, timeout: Some(SHORT) };
    let error = connect_within(&address, PATIENT).unwrap().hello().unwrap_err();
    assert_eq!(error, DutError::Timeout { after: SHORT });
}

#[rstest]
#[case::nothing_at_all(&[0, 0, 0], Limits::LEAST)]
#[case::one_octet_less_than_the_least(&[0x01, 0xFF, 1], Limits::LEAST)]
#[case::the_least(&[0x02, 0x00, 1], Limits::LEAST)]
#[case::one_octet_more(&[0x02, 0x01, 0], Limits { payload: 513, requests: 1 })]
#[case::the_most(&[0xFF, 0xFF, 255], Limits { payload: 0xFFFF, requests: 255 })]
fn limits_below_the_least_are_the_least(#[case] value: &[u8], #[case] limits: Limits) {
    let mut payload = pack_description(&description(), Limits::LEAST);
    let value_at = payload.len() - value.len();
    payload[value_at..].copy_from_slice(value);
    assert_eq!(unpack_description(&payload), Ok(Described::As(description(), limits)));
}

/// Exchanges of four octets have nine with their TLV: 56 fit into 512 octets behind their number, 66 into 600.
#[rstest]
#[case::least(512, 56)]
#[case::more(600, 66)]
#[case::most(0xFFFF, MAX_STIMULI)]
fn no_request_is_longer_than_the_dut_takes(#[case] limit: usize, #[case] at_once: usize) {
    let (to_test, requests) = channel();
    let address = peer(move |socket| {
        answer_all(socket, |frame| {
            if frame.kind == HELLO {
                return (DESCRIPTION, pack_description(&description(), Limits { payload: limit, requests: 1 }));
            }
            let stimuli = unpack_apply(&frame.payload).unwrap();
            to_test.send((frame.payload.len(), stimuli.len())).unwrap();
            let image = |position| seen(position, 0, Seen::Image { port: 1, octets: None });
            let images: Vec<_> = (0..).take(stimuli.len()).map(image).collect();
            let mut payload = Vec::new();
            pack_observed(&images, 0xFFFF, &mut payload);
            (OBSERVED, payload)
        });
    });
    let mut dut = connect_within(&address, PATIENT).unwrap();
    dut.hello().unwrap();
    let mut observed = Vec::new();
    dut.apply(&vec![exchange(&[1, 2, 3, 4]); 3 * at_once], &mut observed).unwrap();
    drop(dut);
    assert_eq!(observed.len(), 3 * at_once);
    let requests: Vec<_> = requests.iter().collect();
    assert!(requests.iter().all(|(octets, _)| *octets <= limit));
    assert_eq!(requests.iter().map(|(_, stimuli)| *stimuli).collect::<Vec<_>>(), [at_once; 3]);
}

/// Of 512 octets, 2 are the number of stimuli, 3 head of the TLV and 6 what stands before the ArgBlock.
#[rstest]
#[case::fits(501, true)]
#[case::one_octet_more(502, false)]
fn an_arg_block_is_bounded_by_what_the_dut_takes(#[case] octets: usize, #[case] fits: bool) {
    let request =
        SmiRequest { service: SmiService::ParServToDs, port: 1, client_id: 0, expected: 0, octets: vec![1; octets] };
    let stimuli = [Stimulus::Smi(Box::new(request))];
    let mut payload = Vec::new();
    assert_eq!(pack_apply(&stimuli, MIN_PAYLOAD, MAX_STIMULI, &mut payload), usize::from(fits));
    assert_eq!(unpack_apply(&payload), Ok(stimuli[..usize::from(fits)].to_vec()));
}

/// The longest there is by the standard: FSPortStatusList with 255 diagnoses.
#[test]
fn a_result_is_bounded_by_the_frame_alone() {
    let result = status(1, 2);
    assert_eq!(result.octets.len(), 16 + 3 * 255);
    let observations = [seen(0, 0, Seen::Smi(Box::new(result)))];
    let mut payload = Vec::new();
    assert_eq!(pack_observed(&observations, MAX_PAYLOAD, &mut payload), 1);
    let mut unpacked = Vec::new();
    assert_eq!(unpack_observed(&payload, &mut unpacked), Ok(false));
    assert_eq!(unpacked, observations);
}

#[cfg(unix)]
#[test]
fn old_words_of_a_program_are_forgotten() {
    let command = r#"exec:sh -c 'echo early >&2; printf "%5000s\n" "" >&2; exit 3'"#;
    let error = connect_within(&command.parse().unwrap(), PATIENT).unwrap().hello().unwrap_err();
    assert_eq!(error, DutError::Closed { how: " (exit status: 3)".to_owned() });
}

/// A DUT whose clock runs by itself: nobody advances it.
struct RealTime(u64);

impl Dut for RealTime {
    fn hello(&mut self) -> Result<Description, DutError> {
        Ok(description())
    }

    fn apply(&mut self, stimuli: &[Stimulus], observed: &mut Vec<Observation>) -> Result<(), DutError> {
        for (position, stimulus) in (0..).zip(stimuli) {
            self.0 += 1000;
            if let Stimulus::Exchange { port, octets } = stimulus {
                observed.push(seen(position, self.0, Seen::Image { port: *port, octets: *octets }));
            }
        }
        Ok(())
    }
}

#[test]
fn a_recorder_follows_a_clock_that_runs_by_itself() {
    let mut recorder = Recorder::new(RealTime(0), Keep::default());
    recorder.apply(&[exchange(&[1]), exchange(&[2]), Stimulus::Power(false)], &mut Vec::new()).unwrap();
    let last = recorder.take().head.pop();
    assert_eq!(last, Some(Entry { at: 2000, count: 1, what: Happened::Power(false) }));
}
