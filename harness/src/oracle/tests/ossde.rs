//! Table 43 line by line.

use super::*;
use crate::oracle::OssdeOracle;
use rstest::rstest;

const RESPONSE: u64 = 10 * CYCLE;

/// A port, its lines and what it shows.
struct Port(OssdeOracle);

impl Port {
    fn new(edition: Edition) -> Port {
        Port(OssdeOracle::new(edition, RESPONSE))
    }

    /// In state 2 with both lines high since 10 ms.
    fn on(edition: Edition) -> Port {
        let mut port = Port::new(edition);
        port.0.lines(10 * CYCLE, true, true);
        assert_eq!(port.shows(11 * CYCLE, true, true, false), Ok(()));
        port
    }

    /// In state 4 at 40 ms: a fault from 20 to 30 ms, the request shown.
    fn requests() -> Port {
        let mut port = Port::on(Edition::V1_1);
        port.0.lines(20 * CYCLE, true, false);
        assert_eq!(port.shows(25 * CYCLE, false, false, false), Ok(()));
        port.0.lines(30 * CYCLE, true, true);
        assert_eq!(port.shows(40 * CYCLE, false, false, true), Ok(()));
        port
    }

    /// What the services have come to: PDin_M ON, GOOD, ChFAckReq_S.
    fn shows(&mut self, at: u64, on: bool, good: bool, request: bool) -> Result<(), Mismatch> {
        self.0.on(on);
        self.0.good(good);
        self.0.request(request);
        self.0.settle(at)
    }
}

#[test]
fn a_fault_is_left_by_an_acknowledgment() {
    let mut port = Port::requests();
    port.0.ack(true);
    assert_eq!(port.shows(41 * CYCLE, true, true, false), Ok(()));
    assert_eq!(port.0.taken(), [1, 0, 1, 1, 1, 0]);
    // The edge is used up.
    port.0.lines(50 * CYCLE, true, false);
    assert_eq!(port.shows(55 * CYCLE, false, false, false), Ok(()));
    port.0.lines(60 * CYCLE, true, true);
    assert_eq!(port.shows(61 * CYCLE, false, false, true), Ok(()));
    refused(port.shows(62 * CYCLE, true, true, false), "qualifier");
}

#[test]
fn no_restart_without_acknowledgment() {
    refused(Port::requests().shows(41 * CYCLE, true, true, false), "qualifier");
    // One that stands is no edge, and one from before the request is none.
    let mut port = Port::on(Edition::V1_1);
    port.0.lines(20 * CYCLE, true, false);
    assert_eq!(port.shows(25 * CYCLE, false, false, false), Ok(()));
    port.0.ack(true);
    refused(port.shows(26 * CYCLE, false, true, false), "qualifier");
    port.0.lines(30 * CYCLE, true, true);
    let mut port = Port::on(Edition::V1_1);
    port.0.ack(true);
    port.0.lines(20 * CYCLE, true, false);
    assert_eq!(port.shows(25 * CYCLE, false, false, false), Ok(()));
    port.0.lines(30 * CYCLE, true, true);
    assert_eq!(port.shows(40 * CYCLE, false, false, true), Ok(()));
    port.0.ack(true);
    refused(port.shows(41 * CYCLE, true, true, false), "qualifier");
    let mut port = Port::requests();
    port.0.ack(false);
    refused(port.shows(41 * CYCLE, true, true, false), "qualifier");
}

#[test]
fn a_fault_in_state_4_takes_the_request_back() {
    let mut port = Port::requests();
    port.0.lines(50 * CYCLE, false, true);
    assert_eq!(port.shows(55 * CYCLE, false, false, false), Ok(()));
    refused(port.shows(56 * CYCLE, false, false, true), "ChFAckReq_S");
    let mut port = Port::requests();
    assert_eq!(port.shows(50 * CYCLE, false, false, false), Ok(()));
    assert_eq!(port.shows(51 * CYCLE, false, false, true), Ok(()));
    assert_eq!(port.0.taken(), [1, 0, 1, 2, 0, 1]);
}

#[rstest]
#[case::v1_1_none(Edition::V1_1, 0, false)]
#[case::v1_1_1_ms(Edition::V1_1, CYCLE, false)]
#[case::v1_1_3_ms(Edition::V1_1, 3 * CYCLE, false)]
#[case::v1_1_longer(Edition::V1_1, 3 * CYCLE + 1, true)]
#[case::iec2022_1_ms(Edition::Iec2022, CYCLE, false)]
#[case::iec2022_longer(Edition::Iec2022, CYCLE + 1, true)]
fn so_long_an_antivalence_is_a_fault(#[case] edition: Edition, #[case] length: u64, #[case] fault: bool) {
    // While it lasts, behind it, and as the longest of two.
    for (second, both) in [(None, false), (None, true), (Some(1), true)] {
        let mut port = Port::on(edition);
        if length > 0 {
            port.0.lines(20 * CYCLE, false, true);
        }
        let mut at = 20 * CYCLE + length;
        if both {
            port.0.lines(at, true, true);
            at += 5 * CYCLE;
        }
        if let Some(second) = second {
            port.0.lines(at, true, false);
            port.0.lines(at + second, true, true);
            at += second;
        }
        let verdict = port.shows(at, false, false, false);
        if fault {
            assert_eq!(verdict, Ok(()), "{length} {second:?} {both}");
        } else {
            refused(verdict, "qualifier");
        }
    }
}

#[test]
fn an_antivalence_that_was_answered_is_no_fault_once_more() {
    let mut port = Port::requests();
    port.0.ack(true);
    assert_eq!(port.shows(41 * CYCLE, true, true, false), Ok(()));
    refused(port.shows(50 * CYCLE, false, false, false), "qualifier");
}

#[test]
fn on_needs_both_lines_and_goes_off_within_the_response_time() {
    let low = |cq, iq| {
        let mut port = Port::on(Edition::V1_1);
        port.0.lines(20 * CYCLE, cq, iq);
        port
    };
    for (cq, iq) in [(false, false), (true, false), (false, true)] {
        assert_eq!(low(cq, iq).shows(20 * CYCLE + RESPONSE, true, true, false), Ok(()));
        refused(low(cq, iq).shows(20 * CYCLE + RESPONSE + 1, true, true, false), "OSSDe");
    }
    // It counts from when they were last both high.
    let mut port = low(false, false);
    port.0.lines(25 * CYCLE, true, false);
    refused(port.shows(20 * CYCLE + RESPONSE + 1, true, true, false), "OSSDe");
    assert_eq!(Port::on(Edition::V1_1).shows(1_000 * CYCLE, true, true, false), Ok(()));
}

#[test]
fn safe_data_while_bad_and_no_request_while_good() {
    refused(Port::on(Edition::V1_1).shows(12 * CYCLE, true, false, false), "PDin_M");
    refused(Port::on(Edition::V1_1).shows(12 * CYCLE, true, true, true), "ChFAckReq_S");
}

#[test]
fn a_start_with_a_fault() {
    let mut port = Port::new(Edition::V1_1);
    port.0.lines(0, true, false);
    assert_eq!(port.shows(5 * CYCLE, false, false, false), Ok(()));
    refused(port.shows(6 * CYCLE, false, true, false), "qualifier");
    // T2 shows by T4 alone.
    let mut port = Port::new(Edition::V1_1);
    port.0.lines(0, true, false);
    port.0.lines(5 * CYCLE, true, true);
    assert_eq!(port.shows(6 * CYCLE, false, false, true), Ok(()));
    assert_eq!(port.0.taken(), [0, 1, 0, 1, 0, 0]);
    // A short antivalence is none.
    let mut port = Port::new(Edition::V1_1);
    port.0.lines(0, true, false);
    assert_eq!(port.shows(3 * CYCLE, false, true, false), Ok(()));
    assert_eq!(port.0.taken(), [1, 0, 0, 0, 0, 0]);
}

#[test]
fn the_request_comes_when_the_fault_is_gone() {
    let mut port = Port::on(Edition::V1_1);
    port.0.lines(20 * CYCLE, true, false);
    assert_eq!(port.shows(25 * CYCLE, false, false, false), Ok(()));
    refused(port.shows(26 * CYCLE, false, false, true), "ChFAckReq_S");
    let mut port = Port::on(Edition::V1_1);
    let told = refused(port.shows(26 * CYCLE, false, false, true), "qualifier");
    assert_eq!((told.expected.as_str(), told.observed.as_str()), ("what state 2 shows", "BAD with ChFAckReq 1"));
    let mut start = Port::new(Edition::V1_1);
    start.0.good(false);
    assert_eq!(start.0.settle(CYCLE), Ok(()), "nothing has changed");
}
