//! A port in OSSDe mode: the filter, the discrepancy, and the qualifier handler of 11.11.5 (Table 43).

use crate::bench::*;
use fsct_adapters::{Line, Seen, SmiService};
use fsct_protocol::Edition;
use fsct_reference::MasterOptions;
use rstest::rstest;

const FILTER: u64 = MS;
const DISCREPANCY: u64 = 3 * MS;
const FIRST_CHECK: u64 = 5 * MS;

/// State 1, with these levels.
fn checking(edition: Edition, cq: bool, iq: bool) -> Bench {
    let mut bench = Bench::idle(edition, MasterOptions::default());
    bench.list.port_mode = 51;
    bench.list.spdu.0 = 1;
    levels(&mut bench, cq, iq);
    bench.configure();
    bench
}

/// State 2, both lines on.
fn good() -> Bench {
    let mut bench = checking(Iec2022, true, true);
    bench.advance(FIRST_CHECK);
    expect(&bench, GOOD_ON);
    bench
}

/// State 3: I/Q has dropped and stays so.
fn faulty() -> Bench {
    let mut bench = good();
    bench.drive(Line::Iq, false);
    bench.advance(FILTER + DISCREPANCY);
    expect(&bench, BAD);
    bench
}

/// State 4, both lines on.
fn awaiting() -> Bench {
    let mut bench = faulty();
    bench.drive(Line::Iq, true);
    bench.advance(FILTER);
    expect(&bench, ASKING);
    bench
}

fn levels(bench: &mut Bench, cq: bool, iq: bool) {
    bench.drive(Line::Cq, cq);
    bench.drive(Line::Iq, iq);
}

/// PDin_M, qualifier, ChFAckReq_S.
type Shown = (u8, bool, bool);
const GOOD_ON: Shown = (0x03, true, false);
const GOOD_OFF: Shown = (0x00, true, false);
const BAD: Shown = (0x00, false, false);
const ASKING: Shown = (0x00, false, true);

#[track_caller]
fn expect(bench: &Bench, shown: Shown) {
    let Services { pdin_m, qualifier, chfackreq_s, .. } = &bench.services;
    assert_eq!((pdin_m.as_slice(), *qualifier, *chfackreq_s), ([shown.0].as_slice(), shown.1, shown.2));
}

#[rstest]
#[case::on(true, GOOD_ON)]
#[case::off(false, GOOD_OFF)]
fn t1_no_faults(#[case] level: bool, #[case] shown: Shown) {
    let mut bench = checking(Iec2022, level, level);
    expect(&bench, BAD);
    bench.advance(FIRST_CHECK - 1);
    expect(&bench, BAD);
    bench.advance(1);
    expect(&bench, shown);
    assert_eq!((bench.modes(), bench.line(Line::WakeUp), bench.port_status_info()), (vec![], vec![], 7));
}

#[test]
fn t2_t4_t5_a_fault_at_the_start_is_acknowledged_when_it_has_gone() {
    let mut bench = checking(Iec2022, true, false);
    bench.advance(FIRST_CHECK);
    expect(&bench, BAD);
    bench.drive(Line::Iq, true);
    bench.advance(FILTER);
    expect(&bench, ASKING);
    bench.press();
    expect(&bench, GOOD_ON);
}

#[test]
fn t3_faults_appeared() {
    let mut bench = good();
    bench.drive(Line::Iq, false);
    bench.advance(FILTER + DISCREPANCY - 1);
    expect(&bench, GOOD_OFF);
    bench.advance(1);
    expect(&bench, BAD);
}

#[test]
fn t4_t6_the_request_is_withdrawn_and_raised_again() {
    let mut bench = awaiting();
    bench.drive(Line::Cq, false);
    bench.advance(FILTER + DISCREPANCY);
    expect(&bench, BAD);
    bench.drive(Line::Cq, true);
    bench.advance(FILTER);
    expect(&bench, ASKING);
    bench.press();
    expect(&bench, GOOD_ON);
}

/// OQ-04: the edge came while the fault was there.
#[test]
fn ack_q_in_state_3_releases_nothing_later() {
    let mut bench = faulty();
    bench.press();
    expect(&bench, BAD);
    bench.drive(Line::Iq, true);
    bench.advance(100 * MS);
    expect(&bench, ASKING);
}

/// OQ-05 and OQ-06: held, released, pressed.
#[test]
fn only_a_rising_edge_of_ack_q_in_state_4_releases() {
    let mut bench = faulty();
    bench.press();
    bench.drive(Line::Iq, true);
    bench.advance(FILTER);
    bench.press();
    expect(&bench, ASKING);
    bench.release();
    expect(&bench, ASKING);
    bench.press();
    expect(&bench, GOOD_ON);
}

/// OQ-09.
#[test]
fn ack_q_in_state_2_is_of_no_effect() {
    let mut bench = good();
    bench.press();
    bench.release();
    expect(&bench, GOOD_ON);
}

#[rstest]
#[case::shorter(FILTER - 1, GOOD_ON)]
#[case::as_long(FILTER, GOOD_OFF)]
fn a_change_counts_when_it_has_been_stable(
    #[case] width: u64,
    #[case] shown: Shown,
    #[values(Line::Cq, Line::Iq)] line: Line,
) {
    let mut bench = good();
    bench.drive(line, false);
    bench.advance(width);
    expect(&bench, shown);
}

/// The period of test pulses is 10 ms at least (Table 8).
#[test]
fn test_pulses_are_ignored() {
    let mut bench = good();
    bench.seen.clear();
    for line in [Line::Cq, Line::Iq].into_iter().cycle().take(40) {
        bench.drive(line, false);
        bench.advance(FILTER - 1);
        bench.drive(line, true);
        bench.advance(9 * MS + 1);
    }
    assert_eq!(bench.seen, []);
}

#[test]
fn a_level_driven_again_is_no_change() {
    let mut bench = good();
    bench.drive(Line::Cq, false);
    bench.advance(FILTER / 2);
    bench.drive(Line::Cq, false);
    bench.advance(FILTER / 2);
    expect(&bench, GOOD_OFF);
}

#[test]
fn an_antivalence_within_its_tolerance_is_no_fault() {
    let mut bench = good();
    bench.drive(Line::Cq, false);
    bench.advance(DISCREPANCY);
    bench.drive(Line::Iq, false);
    bench.advance(100 * MS);
    expect(&bench, GOOD_OFF);
    levels(&mut bench, true, true);
    bench.advance(FILTER);
    expect(&bench, GOOD_ON);
}

#[rstest]
#[case::v1_1(V1_1, &[])]
#[case::iec2022(Iec2022, &[0x20F0])]
fn ossd_locked_has_an_event_in_iec2022(#[case] edition: Edition, #[case] events: &[u16]) {
    let mut bench = checking(edition, true, false);
    bench.advance(FIRST_CHECK);
    assert_eq!(bench.port_events(), events);
}

#[test]
fn other_ports_are_left_alone() {
    let mut bench = good();
    bench.seen.clear();
    for (line, level) in [(Line::Cq, false), (Line::Iq, true)] {
        bench.apply(fsct_adapters::Stimulus::Drive { port: 1, line, level });
    }
    bench.advance(100 * MS);
    assert_eq!(bench.seen, []);
}

#[rstest]
#[case(false, false, 0)]
#[case(true, false, 1)]
#[case(false, true, 2)]
#[case(true, true, 3)]
fn fs_in_buffer_shows_the_raw_levels(
    #[case] cq: bool,
    #[case] iq: bool,
    #[case] bits: u8,
    #[values(V1_1, Iec2022)] edition: Edition,
) {
    let mut bench = checking(edition, true, true);
    levels(&mut bench, cq, iq);
    if edition == V1_1 {
        assert_eq!(bench.smi(SmiService::SpduIn, PORT, 0, &[]).octets, [0x10, 0x04, bits]);
    } else {
        let block = bench.smi(SmiService::FsPdInOut, PORT, 0x1103, &VOID).octets;
        assert_eq!((block[4], block[5]), (1, bits));
    }
}

#[test]
fn there_is_no_process_data_exchange() {
    let mut bench = good();
    bench.exchange(None);
    assert_eq!(bench.last.last().unwrap().seen, Seen::Image { port: PORT, octets: None });
}
