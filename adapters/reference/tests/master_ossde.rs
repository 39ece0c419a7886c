//! A port in OSSDe mode: the qualifier handler of Table 43 transition by transition, filter, discrepancy.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod master_common;

use fsct_adapters::{Line, Octets, Seen, Service, SmiService, Source, Stimulus};
use fsct_protocol::Edition;
use fsct_reference::MasterOptions;
use master_common::*;
use rstest::rstest;

const LOCKED: u16 = 0x20F0;

/// Put into OSSDe mode with these levels, nothing checked yet: state 1.
fn checking(edition: Edition, cq: bool, iq: bool) -> Bench {
    let mut bench = Bench::off(of(edition), MasterOptions::default());
    bench.power(true);
    bench.drive(Line::Cq, cq);
    bench.drive(Line::Iq, iq);
    bench.configure(&List { port_mode: 51, spdu_in: 1, ..list(of(edition)) });
    assert!(bench.seen().contains(&l_plus(true)));
    bench
}

/// State 2, both lines on.
fn good() -> Bench {
    let mut bench = checking(Edition::Iec2022, true, true);
    bench.advance(5 * MS);
    expect(&bench, 0x03, true, false);
    bench
}

/// State 3: C/Q is off, I/Q is on, for too long.
fn bad() -> Bench {
    let mut bench = good();
    bench.drive(Line::Cq, false);
    bench.advance(4 * MS);
    expect(&bench, 0, false, false);
    bench
}

/// State 4: the fault has gone, both lines are on.
fn awaiting() -> Bench {
    let mut bench = bad();
    bench.drive(Line::Cq, true);
    bench.advance(MS);
    expect(&bench, 0, false, true);
    bench
}

#[track_caller]
fn expect(bench: &Bench, pd_in: u8, qualifier: bool, ack_req: bool) {
    bench.expect_service(Service::PdinM, &[pd_in]);
    bench.expect_service(Service::Qualifier, &[u8::from(qualifier)]);
    bench.expect_service(Service::ChfackreqS, &[u8::from(ack_req)]);
    bench.expect_service(Service::SdsetS, &[u8::from(!qualifier)]);
}

#[rstest]
#[case(true, 0x03)]
#[case(false, 0)]
fn t1_good_after_the_first_check(
    #[values(Edition::V1_1, Edition::Iec2022)] edition: Edition,
    #[case] level: bool,
    #[case] pd_in: u8,
) {
    let mut bench = checking(edition, level, level);
    bench.advance(5 * MS - 1);
    expect(&bench, 0, false, false);
    bench.advance(1);
    expect(&bench, pd_in, true, false);
    assert_eq!(bench.info(), 7);
}

#[rstest]
#[case(Edition::V1_1, &[])]
#[case(Edition::Iec2022, &[LOCKED])]
fn t2_a_fault_at_the_first_check_needs_an_acknowledgment(#[case] edition: Edition, #[case] events: &[u16]) {
    let mut bench = checking(edition, true, false);
    bench.advance(5 * MS - 1);
    assert_eq!(bench.last, []);
    bench.advance(1);
    assert_eq!(bench.events(), events);
    expect(&bench, 0, false, false);
    bench.drive(Line::Iq, true);
    bench.advance(MS);
    expect(&bench, 0, false, true);
    bench.ack(1);
    expect(&bench, 0x03, true, false);
}

/// A discrepancy that runs when the check is due is awaited.
#[test]
fn t1_waits_for_the_end_of_a_discrepancy() {
    let mut bench = checking(Edition::Iec2022, true, true);
    bench.advance(3 * MS);
    bench.drive(Line::Cq, false);
    bench.advance(2 * MS);
    expect(&bench, 0, false, false);
    bench.drive(Line::Iq, false);
    bench.advance(MS);
    expect(&bench, 0, true, false);
}

#[rstest]
#[case(Edition::V1_1, 0)]
#[case(Edition::Iec2022, 1)]
fn t3_a_fault_in_operation(#[case] edition: Edition, #[case] events: usize) {
    let mut bench = checking(edition, true, true);
    bench.advance(5 * MS);
    bench.drive(Line::Iq, false);
    bench.advance(4 * MS - 1);
    assert!(bench.bit(Service::Qualifier));
    bench.advance(1);
    expect(&bench, 0, false, false);
    let event = Seen::Indication { port: PORT, source: Source::Port, qualifier: 0xFC, code: LOCKED };
    assert_eq!(bench.seen().iter().filter(|seen| **seen == event).count(), events);
    assert!(bench.last.iter().all(|observation| observation.at == 9 * MS));
    assert_eq!(bench.diags().len(), events);
}

#[test]
fn t4_t5_gone_and_acknowledged() {
    let mut bench = awaiting();
    bench.ack(1);
    expect(&bench, 0x03, true, false);
}

#[test]
fn t6_the_fault_comes_back() {
    let mut bench = awaiting();
    bench.drive(Line::Iq, false);
    bench.advance(4 * MS);
    expect(&bench, 0, false, false);
    assert_eq!(bench.events(), [LOCKED]);
    bench.drive(Line::Iq, true);
    bench.advance(MS);
    expect(&bench, 0, false, true);
    bench.ack(1);
    expect(&bench, 0x03, true, false);
}

/// An edge while the fault is there, a level, a falling edge: no acknowledgment.
#[test]
fn t5_takes_a_rising_edge_in_state_4_alone() {
    let mut bench = bad();
    bench.ack(1);
    bench.drive(Line::Cq, true);
    bench.advance(MS);
    expect(&bench, 0, false, true);
    bench.ack(1);
    expect(&bench, 0, false, true);
    bench.ack(0);
    expect(&bench, 0, false, true);
    bench.ack(1);
    expect(&bench, 0x03, true, false);
}

#[test]
fn acknowledgments_without_fault_do_nothing() {
    let mut bench = good();
    for level in [1, 0, 1] {
        bench.ack(level);
        assert_eq!(bench.last, []);
    }
}

/// On is both lines on; a demand is no fault.
#[test]
fn a_demand_and_its_end() {
    let mut bench = good();
    bench.drive(Line::Cq, false);
    bench.drive(Line::Iq, false);
    bench.advance(MS - 1);
    assert_eq!(bench.last, []);
    bench.advance(1);
    expect(&bench, 0, true, false);
    bench.drive(Line::Cq, true);
    bench.drive(Line::Iq, true);
    bench.advance(MS);
    expect(&bench, 0x03, true, false);
}

#[rstest]
#[case::under(MS - 1, false)]
#[case::at(MS, true)]
fn test_pulses_are_ignored(#[case] width: u64, #[case] seen: bool) {
    let mut bench = good();
    let mut off = false;
    for _ in 0..5 {
        for line in [Line::Cq, Line::Iq] {
            bench.drive(line, false);
            bench.advance(width);
            off |= !bench.last.is_empty();
            bench.drive(line, true);
            bench.advance(10 * MS);
            off |= !bench.last.is_empty();
        }
    }
    assert_eq!(off, seen);
}

/// A level that is driven again is no change: the filter does not begin anew.
#[test]
fn the_same_level_again_changes_nothing() {
    let mut bench = good();
    bench.drive(Line::Cq, false);
    bench.drive(Line::Iq, false);
    bench.advance(MS / 2);
    bench.drive(Line::Cq, false);
    bench.drive(Line::Iq, false);
    bench.advance(MS / 2);
    expect(&bench, 0, true, false);
}

/// Filtered lines may differ for 3 ms and not longer.
#[rstest]
#[case::up_to(3 * MS, true)]
#[case::longer(3 * MS + 1, false)]
fn the_discrepancy_time(#[case] skew: u64, #[case] fine: bool) {
    let mut bench = good();
    bench.drive(Line::Cq, false);
    bench.advance(skew);
    bench.drive(Line::Iq, false);
    bench.advance(2 * MS);
    expect(&bench, 0, fine, !fine);
}

/// Each line by itself, as it is: bit 0 C/Q, bit 1 I/Q.
#[rstest]
fn the_raw_bits_are_in_the_fs_in_buffer(
    #[values(Edition::V1_1, Edition::Iec2022)] edition: Edition,
    #[values(0, 1, 2, 3)] bits: u8,
) {
    let mut bench = checking(edition, bits & 1 != 0, bits & 2 != 0);
    match edition {
        Edition::V1_1 => assert_eq!(bench.read(SmiService::SpduIn).octets, [0x10, 0x04, bits]),
        Edition::Iec2022 => {
            assert_eq!(bench.read(SmiService::FsPdInOut).octets, [0x11, 0x03, 0, 1, 1, bits, 0]);
        }
    }
}

/// Raw is what the line is at this moment, before its filter.
#[test]
fn a_test_pulse_is_seen_in_the_raw_bits() {
    let mut bench = good();
    bench.drive(Line::Iq, false);
    assert_eq!(bench.read(SmiService::FsPdInOut).octets[5], 1);
    expect(&bench, 0x03, true, false);
}

#[test]
fn there_is_no_communication() {
    let mut bench = good();
    bench.plug(Some(list(plain()).identity()));
    bench.start_up_to_record();
    assert!(!bench.seen().contains(&wake_up()));
    bench.receive(None);
    assert_eq!(bench.image, None);
}

/// A fault on one port is none of the other's business.
#[test]
fn ports_are_independent() {
    let mut bench = good();
    bench.smi(SmiService::PortConfiguration, 1, &List { port_mode: 51, spdu_in: 1, ..list(plain()) }.octets());
    bench.apply(&[Stimulus::Drive { port: 1, line: Line::Cq, level: true }, Stimulus::Advance { ns: 20 * MS }]);
    let locked = Seen::Indication { port: 1, source: Source::Port, qualifier: 0xFC, code: LOCKED };
    assert!(bench.seen().contains(&locked));
    expect(&bench, 0x03, true, false);
}

#[test]
fn a_configuration_anew_checks_anew() {
    let mut bench = bad();
    bench.configure(&List { port_mode: 51, spdu_in: 1, ..list(plain()) });
    bench.drive(Line::Cq, true);
    bench.advance(5 * MS);
    expect(&bench, 0x03, true, false);
    assert_eq!(bench.service(Service::PdinM), Octets::new(&[0x03]));
}
