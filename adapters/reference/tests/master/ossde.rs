//! A port in OSSDe mode: filter, discrepancy, and Table 43.

use crate::bench::*;
use fsct_adapters::{Line, Seen, Source};
use fsct_protocol::Edition;
use fsct_reference::MasterOptions;

fn ossde(cq: bool, iq: bool) -> Bench {
    let mut bench = Bench::idle(Edition::Iec2022, MasterOptions::default());
    bench.drive(Line::Cq, cq);
    bench.drive(Line::Iq, iq);
    let mut list = bench.list();
    list[2] = 51;
    bench.configure(list);
    bench
}

fn state(bench: &Bench) -> (bool, bool, &[u8]) {
    (bench.good, bench.ch_f_ack_req_s, &bench.pdin)
}

#[test]
fn t1_a_healthy_start_is_good_after_the_first_diagnosis() {
    let mut bench = ossde(true, true);
    bench.pass(5 * MS - 1);
    assert_eq!(state(&bench), (false, false, &[0][..]));
    bench.pass(1);
    assert_eq!(state(&bench), (true, false, &[3][..]));
}

#[test]
fn t2_t4_t5_a_fault_at_the_start_needs_the_acknowledgment() {
    let mut bench = ossde(true, false);
    bench.pass(100 * MS);
    assert_eq!(state(&bench), (false, false, &[0][..]));
    assert!(bench.saw(&Seen::Indication { port: 1, source: Source::Port, qualifier: 0xFC, code: 0x20F0 }));
    bench.drive(Line::Iq, true);
    bench.pass(2 * MS);
    assert_eq!(state(&bench), (false, true, &[0][..]));
    bench.press(true);
    assert_eq!(state(&bench), (true, false, &[3][..]));
}

#[test]
fn t3_a_discrepancy_longer_than_its_tolerance_is_a_fault() {
    let mut bench = ossde(true, true);
    bench.pass(10 * MS);
    bench.drive(Line::Iq, false);
    bench.pass(4 * MS - 1);
    assert!(bench.good && bench.pdin == [0], "OFF behind the filter, no fault yet");
    bench.pass(1);
    assert_eq!(state(&bench), (false, false, &[0][..]));
}

#[test]
fn t6_a_fault_withdraws_the_request_and_a_held_ack_q_releases_nothing() {
    let mut bench = ossde(true, true);
    bench.pass(10 * MS);
    bench.press(true);
    bench.drive(Line::Iq, false);
    bench.pass(10 * MS);
    bench.drive(Line::Iq, true);
    bench.pass(500 * MS);
    assert_eq!(state(&bench), (false, true, &[0][..]), "held");
    bench.drive(Line::Cq, false);
    bench.pass(10 * MS);
    assert_eq!(state(&bench), (false, false, &[0][..]), "T6");
    bench.drive(Line::Cq, true);
    bench.pass(10 * MS);
    bench.press(false);
    bench.press(true);
    assert_eq!(state(&bench), (true, false, &[3][..]));
}

#[test]
fn test_pulses_are_filtered() {
    let mut bench = ossde(true, true);
    bench.pass(10 * MS);
    for _ in 0..20 {
        bench.drive(Line::Cq, false);
        bench.pass(MS - 1);
        bench.drive(Line::Cq, true);
        bench.pass(9 * MS);
        assert_eq!(state(&bench), (true, false, &[3][..]));
    }
}
