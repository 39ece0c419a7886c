//! Round trips: what is made of them, and that only the right answer counts as one.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod common;

use common::*;
use fsct_adapters::{Description, Dut, DutError, Latency, Observation, Seen, Stimulus, connect};
use std::time::Duration;

fn ms(ms: u64) -> Duration {
    Duration::from_millis(ms)
}

#[test]
fn round_trips_are_ranked() {
    let hundred = Latency::of((1..=100).rev().map(ms).collect()).unwrap();
    assert_eq!(hundred, Latency { min: ms(1), median: ms(50), p99: ms(99), max: ms(100) });
    let few = Latency::of(vec![ms(4), ms(2), ms(9)]).unwrap();
    assert_eq!(few, Latency { min: ms(2), median: ms(4), p99: ms(9), max: ms(9) });
    assert_eq!(Latency::of(vec![ms(3)]), Some(Latency { min: ms(3), median: ms(3), p99: ms(3), max: ms(3) }));
    assert_eq!(Latency::of(vec![]), None);
}

#[test]
fn what_varies_is_uncertain_and_what_is_constant_is_not() {
    assert_eq!(Latency::of(vec![ms(10), ms(10)]).unwrap().uncertainty(), ms(0));
    assert_eq!(Latency::of(vec![ms(16), ms(10), ms(11)]).unwrap().uncertainty(), ms(3));
    assert_eq!(Latency::of(vec![ms(16), ms(10), ms(11)]).unwrap().to_string(), "median 11.0ms, 10.0ms to 16.0ms");
}

/// Counts the batches, and answers them like this.
struct Answering(Option<Seen>, usize);

impl Dut for Answering {
    fn hello(&mut self) -> Result<Description, DutError> {
        Ok(description())
    }

    fn apply(&mut self, _: &[Stimulus], observed: &mut Vec<Observation>) -> Result<(), DutError> {
        self.1 += 1;
        observed.extend(self.0.clone().map(|answer| seen(0, 0, answer)));
        Ok(())
    }
}

#[test]
fn it_is_measured_as_often_as_asked_and_at_least_once() {
    for (times, trips) in [(0, 1), (1, 1), (32, 32)] {
        let mut dut = Answering(Some(Seen::Unsupported), 0);
        Latency::measure(&mut dut, times).unwrap();
        assert_eq!(dut.1, trips);
    }
}

#[test]
fn another_answer_is_no_round_trip() {
    for answer in [None, Some(Seen::Written)] {
        let error = Latency::measure(&mut Answering(answer, 0), 9).unwrap_err();
        assert!(matches!(error, DutError::Contract { .. }), "{error}");
    }
}

#[test]
fn a_dut_behind_a_socket_is_measured() {
    let server = served("tcp://127.0.0.1:0");
    let mut dut = connect(&server.address).unwrap();
    dut.hello().unwrap();
    let latency = Latency::measure(dut.as_mut(), 8).unwrap();
    assert!(latency.min <= latency.median && latency.median <= latency.p99 && latency.p99 <= latency.max);
    assert!(latency.min > Duration::ZERO);
}
