//! Table 38 from outside: the charts of 11.5.4 and the transitions they do not show.

use crate::bench::*;
use fsct_adapters::{Octets, Service};
use fsct_protocol::Edition;
use fsct_protocol::spdu::{Status, inv3};
use fsct_reference::{MasterMutant, MasterOptions};
use rstest::rstest;

const V: Edition = Edition::Iec2022;

fn options() -> MasterOptions {
    MasterOptions::default()
}

#[rstest]
fn start_up_counts_from_0_and_wraps_from_7_to_1(#[values(Edition::V1_1, Edition::Iec2022)] edition: Edition) {
    let mut bench = Bench::operate(edition, options());
    for mcount in [5, 6, 7, 1, 2] {
        let before = if mcount == 1 { 7 } else { mcount - 1 };
        assert_eq!(bench.answer(mirror(before)), shown(mcount, 0, 0));
    }
    assert_eq!(bench.pdin, [0xA5]);
}

#[test]
fn the_first_spdu_waits_without_time_limit_and_takes_any_answer() {
    let mut bench = Bench::waiting(V, options());
    assert_eq!(bench.silence(500), shown(0, 1, 0));
    assert_eq!(bench.exchange(Some(Octets::zero(5))), Some(shown(0, 1, 0)));
    assert_eq!(bench.answer(mirror(3)), shown(1, 1, 0), "T3, T7: a foreign counter is a fault");
}

#[test]
fn the_fs_master_finds_a_crc_error() {
    let mut bench = Bench::after_fault(V, options());
    assert!(!bench.good && bench.sd_set_s && bench.pdin == [0]);
    assert_eq!(bench.answer(mirror(5)), shown(6, 1, 1));
    assert!(bench.ch_f_ack_req_s && !bench.good);
    assert_eq!(bench.answer(mirror(6)), shown(7, 1, 1));
    bench.press(true);
    assert_eq!(bench.answer(mirror(7)), shown(1, 0, 0), "T11");
    assert!(bench.good && !bench.ch_f_ack_req_s && bench.pdin == [0xA5]);
}

#[test]
fn the_fs_device_finds_a_crc_error() {
    let mut bench = Bench::operate(V, options());
    let reported = |mcount| Status { sd_set: true, d_comm_err: true, ..mirror(mcount) };
    assert_eq!(bench.answer(reported(4)), shown(5, 1, 0), "T7");
    assert_eq!(bench.answer(reported(5)), shown(6, 1, 0), "T12");
    assert_eq!(bench.answer(Status { sd_set: true, ..mirror(6) }), shown(7, 1, 1), "T13");
}

#[test]
fn the_fs_device_is_switched_off_and_on() {
    let mut bench = Bench::operate(V, options());
    assert_eq!(bench.silence(18), shown(4, 0, 0), "not before FSP_Watchdog");
    assert!(bench.good);
    assert_eq!(bench.silence(2), shown(0, 1, 0), "T8");
    assert!(!bench.good && bench.pdin == [0]);
    assert_eq!(bench.answer(mirror(0)), shown(1, 1, 1), "T10, T13");
    assert_eq!(bench.silence(21), shown(0, 1, 0), "T14");
    assert!(!bench.ch_f_ack_req_s);
}

#[test]
fn m_timer_is_restarted_by_a_new_spdu_alone() {
    let mut bench = Bench::operate(V, options());
    for _ in 0..18 {
        assert_eq!(bench.answer(mirror(3)), shown(4, 0, 0), "a repetition is left alone");
    }
    bench.silence(1);
    assert_eq!(bench.silence(1), shown(0, 1, 0));
}

#[test]
fn state_7_takes_the_mirrored_counter_alone() {
    let mut bench = Bench::after_fault(V, options());
    for foreign in [0, 1, 2, 3, 4, 6, 7] {
        assert_eq!(bench.answer(Status { dcount_i: inv3(foreign), ..Status::default() }), shown(5, 1, 0));
    }
    assert_eq!(bench.answer(mirror(5)), shown(6, 1, 1));
}

#[test]
fn only_a_change_from_0_to_1_acknowledges() {
    let mut bench = Bench::operate(V, options());
    bench.press(true);
    assert_eq!(bench.falsified(mirror(4)), shown(5, 1, 0));
    for mcount in [6, 7] {
        assert_eq!(bench.answer(mirror(mcount - 1)), shown(mcount, 1, 1), "held: no effect");
    }
    bench.press(false);
    assert_eq!(bench.answer(mirror(7)), shown(1, 1, 1), "armed by a good answer");
    bench.press(true);
    assert_eq!(bench.answer(mirror(1)), shown(2, 0, 0));
}

#[test]
fn sd_set_and_set_sd_c_pass_safe_data_without_acknowledgment() {
    let mut bench = Bench::operate(V, options());
    assert_eq!(bench.answer(Status { sd_set: true, ..mirror(4) }), shown(5, 0, 0));
    assert!(bench.sd_set_s && !bench.good && bench.pdin == [0]);
    assert_eq!(bench.answer(mirror(5)), shown(6, 0, 0));
    assert!(!bench.sd_set_s && bench.good && bench.pdin == [0xA5]);
    bench.set(Service::SetsdC, Octets::bit(true));
    assert_eq!(bench.answer(mirror(6)), shown(7, 1, 0));
    assert!(bench.sd_set_s && bench.pdin == [0]);
    bench.set(Service::SetsdC, Octets::bit(false));
    assert_eq!(bench.answer(mirror(7)), shown(1, 0, 0));
}

/// Each fault shows where it should, and nowhere before.
#[rstest]
#[case::t13(MasterMutant::RestartWithoutAcknowledgment, |b: &mut Bench| b.answer(mirror(5)), shown(6, 0, 0))]
#[case::early(MasterMutant::QualifierReleasedEarly, |b: &mut Bench| { b.answer(mirror(5)); Shown { safe: b.good, ..shown(6, 1, 1) } }, shown(6, 1, 1))]
#[case::plain_taken(MasterMutant::PlainPortNumAccepted, |b: &mut Bench| b.answer(mirror(5)), shown(6, 1, 1))]
fn mutants_after_a_fault(#[case] mutant: MasterMutant, #[case] act: fn(&mut Bench) -> Shown, #[case] wrong: Shown) {
    let mut bench = Bench::after_fault(V, MasterOptions { mutant: Some(mutant), ..options() });
    assert_eq!(act(&mut bench), wrong);
}

#[test]
fn mutants_of_the_counter_the_timer_and_the_request() {
    let mutant = |mutant| MasterOptions { mutant: Some(mutant), ..options() };
    let mut bench = Bench::operate(V, mutant(MasterMutant::McountNotReset));
    assert_eq!(bench.silence(20), shown(5, 1, 0));
    let mut bench = Bench::operate(V, mutant(MasterMutant::Counter7To0));
    for mcount in [5, 6, 7, 0] {
        assert_eq!(bench.answer(mirror(if mcount == 0 { 7 } else { mcount - 1 })), shown(mcount, 0, 0));
    }
    let mut bench = Bench::operate(V, mutant(MasterMutant::MTimerRestartedByRepetitions));
    for _ in 0..30 {
        assert_eq!(bench.answer(mirror(3)), shown(4, 0, 0));
    }
    let mut bench = Bench::operate(V, mutant(MasterMutant::ChFAckReqEarly));
    assert_eq!(bench.falsified(mirror(4)), shown(5, 1, 1));
    let mut bench = Bench::operate(V, mutant(MasterMutant::DTimeoutIgnored));
    assert_eq!(bench.answer(Status { d_timeout: true, ..mirror(4) }), shown(5, 0, 0));
    let mut bench = Bench::operate(V, mutant(MasterMutant::AcknowledgmentAsLevel));
    bench.press(true);
    bench.falsified(mirror(4));
    assert_eq!(bench.answer(mirror(5)), shown(6, 0, 0));
}

#[test]
fn an_spdu_may_take_some_exchanges_to_appear() {
    let mut bench = Bench::idle(V, MasterOptions { latency: 2, ..options() });
    bench.configure(bench.list());
    bench.connect();
    assert_eq!([bench.exchange(None), bench.exchange(None)], [None, None]);
    assert_eq!(bench.exchange(Some(spdu(mirror(0), 0xA5))), Some(shown(0, 1, 0)));
    assert!(bench.good, "services do not wait");
    assert_eq!([bench.exchange(None), bench.exchange(None)].map(|s| s.map(|s| s.mcount)), [Some(0), Some(1)]);
}
