//! The SCL of the FS-Master: the charts of 11.5.4 from its side, each transition of Table 38, and MTimer.

use crate::bench::*;
use fsct_adapters::{Octets, Seen, Service, Stimulus};
use rstest::rstest;

// --- charts ---

#[rstest]
fn chart_startup(#[values(V1_1, Iec2022)] edition: fsct_protocol::Edition) {
    let mut bench = Bench::waiting_first(edition, None);
    bench.row(d(7).sd_set(), m(1), SDin);
    bench.row(d(6).sd_set(), m(2), SDin);
    bench.row(d(5).sd_set(), m(3), SDin);
    bench.row(d(4), m(4), PDin);
    bench.row(d(3), m(5), PDin);
    bench.row(d(2), m(6), PDin);
    bench.row(d(1), m(7), PDin);
    bench.row(d(0), m(1), PDin);
    bench.row(d(6), m(2), PDin);
}

/// What was exchanged before the FS-Master was off counts for nothing.
#[test]
fn chart_master_off_on() {
    let mut bench = Bench::operate(3);
    bench.apply(Stimulus::Power(false));
    bench.apply(Stimulus::Power(true));
    bench.connect();
    bench.set(Service::PdoutM, &[LIVE_OUT]);
    bench.expect_out(None, m(0).sd());
    bench.row(d(7).sd_set(), m(1), SDin);
    bench.row(d(6).sd_set(), m(2), SDin);
    bench.row(d(5).sd_set(), m(3), SDin);
    bench.row(d(4), m(4), PDin);
    bench.row(d(3), m(5), PDin);
}

#[test]
fn chart_delayed_device() {
    let mut bench = Bench::waiting_first(Iec2022, None);
    for _ in 0..4 {
        bench.advance(WATCHDOG);
        bench.exchange(Some(Octets::zero(5)));
        assert_eq!(bench.image(), Some(m(0).sd().octets()));
    }
    bench.row(d(7).sd_set(), m(1), SDin);
    bench.row(d(6).sd_set(), m(2), SDin);
    bench.row(d(5).sd_set(), m(3), SDin);
    bench.row(d(4), m(4), PDin);
}

#[test]
fn chart_device_off_on() {
    let mut bench = Bench::operate(5);
    bench.advance(WATCHDOG);
    assert_eq!((bench.services.qualifier, bench.services.faults_s), (false, true), "T8");
    bench.expect_out(None, m(0).sd());
    bench.advance(WATCHDOG);
    bench.expect_out(None, m(0).sd());
    bench.row(d(7).sd_set(), m(1).sd().ack_req(), SDin);
    bench.row(d(6).sd_set(), m(2).sd().ack_req(), SDin);
    bench.row(d(5).sd_set(), m(3).sd().ack_req(), SDin);
    bench.press();
    bench.row(d(4), m(4), PDin);
    bench.row(d(3), m(5), PDin);
    bench.row(d(2), m(6), PDin);
}

#[test]
fn chart_master_crc() {
    let mut bench = Bench::operate(3);
    bench.row(d(4).bad(), m(4).sd(), SDin);
    bench.row(d(3), m(5).sd().ack_req(), SDin);
    bench.row(d(2), m(6).sd().ack_req(), SDin);
    bench.row(d(1), m(7).sd().ack_req(), SDin);
    bench.press();
    bench.row(d(0), m(1), PDin);
    bench.row(d(6), m(2), PDin);
}

#[test]
fn chart_device_crc() {
    let mut bench = Bench::operate(2);
    bench.row(d(5), m(3), PDin);
    bench.row(d(4).comm_err(), m(4).sd(), SDin);
    bench.row(d(3).comm_err(), m(5).sd(), SDin);
    bench.row(d(2).sd_set(), m(6).sd().ack_req(), SDin);
    bench.row(d(1).sd_set(), m(7).sd().ack_req(), SDin);
    bench.press();
    // The chart prints SDin here; by T11 it is PDin, as in the two charts before.
    bench.row(d(0), m(1), PDin);
    bench.row(d(6), m(2), PDin);
}

// --- transitions ---

#[rstest]
fn t1_t2_the_first_spdu_is_safe_and_counts_0(#[values(V1_1, Iec2022)] edition: fsct_protocol::Edition) {
    let mut bench = Bench::waiting_first(edition, None);
    let services = Services { pdin_m: vec![0], sdset_s: true, ..Services::default() };
    assert_eq!(bench.services, services);
    bench.advance(1_000 * WATCHDOG);
    assert_eq!(bench.last, [], "no timer runs in state 2");
    bench.expect_out(None, m(0).sd());
}

#[rstest]
#[case::all_zero(Octets::zero(5))]
#[case::too_short(Octets::zero(4))]
#[case::too_long(Octets::zero(6))]
#[case::nothing(Octets::default())]
fn t3_no_spdu_is_no_reception(#[case] octets: Octets) {
    let mut bench = Bench::waiting_first(Iec2022, None);
    bench.exchange(Some(octets));
    assert_eq!(bench.image(), Some(m(0).sd().octets()));
    assert!(!bench.services.faults_s);
}

/// State 2 has no guard on the counter.
#[rstest]
fn t3_t7_a_foreign_counter_at_the_start_is_a_fault(#[values(0, 1, 2, 3, 4, 5, 6)] foreign: u8) {
    let mut bench = Bench::waiting_first(Iec2022, None);
    bench.row(d(foreign), m(1).sd(), SDin);
    assert!(bench.services.faults_s);
}

#[test]
fn t4_sd_set_passes_without_acknowledgment() {
    let mut bench = Bench::operate(4);
    bench.row(d(3).sd_set(), m(5), SDin);
    assert!(!bench.services.faults_s && !bench.services.chfackreq_s);
    bench.row(d(2), m(6), PDin);
}

#[test]
fn t4_set_sd_c_passes_without_acknowledgment() {
    let mut bench = Bench::operate(4);
    bench.set(Service::SetsdC, &[1]);
    bench.row(d(3), m(5).sd(), SDin);
    bench.set(Service::SetsdC, &[0]);
    bench.row(d(2), m(6), PDin);
}

#[test]
fn t5_pdout_m_is_taken_when_the_spdu_is_built() {
    let mut bench = Bench::operate(4);
    bench.set(Service::PdoutM, &[0x77]);
    bench.expect_out(None, m(4));
    bench.row(d(3), Out { data: 0x77, ..m(5) }, PDin);
}

#[rstest]
#[case::good(d(4))]
#[case::bad(d(4).bad())]
#[case::with_a_fault(d(4).comm_err())]
#[case::with_another_port(d(4).port_num(PORT))]
fn t6_an_answer_with_the_counter_before_is_old(#[case] old: In) {
    Bench::operate(4).expect_still(old, m(4));
}

#[rstest]
#[case::crc(d(3).bad())]
#[case::port_not_inverted(d(3).port_num(PORT))]
#[case::other_port(d(3).port_num(!3))]
#[case::counter(d(2))]
#[case::d_comm_err(d(3).comm_err())]
#[case::d_timeout(d(3).timeout())]
fn t7_a_fault_leads_to_safe_data_and_goes_on_counting(#[case] answer: In) {
    let mut bench = Bench::operate(4);
    bench.row(answer, m(5).sd(), SDin);
    assert!(bench.services.faults_s && !bench.services.chfackreq_s);
}

#[test]
fn t8_t9_a_timeout_starts_again_at_0() {
    let mut bench = Bench::after_timeout(None);
    bench.expect_out(None, m(0).sd());
    let services = Services { pdin_m: vec![0], sdset_s: true, faults_s: true, ..Services::default() };
    assert_eq!(bench.services, services);
}

#[rstest]
fn t10_only_the_mirrored_counter_is_expected(#[values(0, 1, 3, 4, 5, 6, 7)] foreign: u8) {
    let mut bench = Bench::after_fault(None);
    bench.expect_still(d(foreign), m(5).sd());
    bench.expect_still(d(foreign).bad(), m(5).sd());
    bench.row(d(2), m(6).sd().ack_req(), SDin);
}

/// T8 directly behind MCount 1: the last answer has DCount_i 7, and so has the one to MCount 0. A guard "not old" would never
/// leave state 7.
#[test]
fn t10_the_expected_counter_may_be_the_one_before() {
    let mut bench = Bench::waiting_first(Iec2022, None);
    bench.row(d(7), m(1), PDin);
    bench.advance(WATCHDOG);
    bench.row(d(7).sd_set(), m(1).sd().ack_req(), SDin);
}

#[test]
fn t10_an_spdu_of_zeros_is_not_the_mirror_of_7() {
    let mut bench = Bench::operate(6);
    bench.row(d(1).bad(), m(7).sd(), SDin);
    bench.exchange(Some(Octets::zero(5)));
    assert_eq!(bench.image(), Some(m(7).sd().octets()));
    bench.row(d(0), m(1).sd().ack_req(), SDin);
}

#[test]
fn t11_shows_safe_data_while_the_device_does() {
    let mut bench = Bench::after_fault(None);
    bench.row(d(2).sd_set(), m(6).sd().ack_req(), SDin);
    bench.press();
    bench.row(d(1).sd_set(), m(7), SDin);
    assert!(!bench.services.faults_s && !bench.services.chfackreq_s);
    bench.row(d(0), m(1), PDin);
}

#[test]
fn t11_obeys_set_sd_c() {
    let mut bench = Bench::after_fault(None);
    bench.row(d(2), m(6).sd().ack_req(), SDin);
    bench.press();
    bench.set(Service::SetsdC, &[1]);
    bench.row(d(1), m(7).sd(), SDin);
    bench.set(Service::SetsdC, &[0]);
    bench.row(d(0), m(1), PDin);
}

#[test]
fn t12_a_fault_withdraws_the_request_and_disarms() {
    let mut bench = Bench::after_fault(None);
    bench.row(d(2), m(6).sd().ack_req(), SDin);
    bench.press();
    bench.row(d(1).bad(), m(7).sd(), SDin);
    assert!(!bench.services.chfackreq_s && bench.services.faults_s);
    bench.row(d(0), m(1).sd().ack_req(), SDin);
    bench.row(d(6), m(2).sd().ack_req(), SDin);
}

#[test]
fn t13_an_acknowledgment_held_all_the_time_is_none() {
    let mut bench = Bench::operate(4);
    bench.press();
    bench.row(d(3).bad(), m(5).sd(), SDin);
    bench.row(d(2), m(6).sd().ack_req(), SDin);
    bench.row(d(1), m(7).sd().ack_req(), SDin);
    bench.release();
    bench.row(d(0), m(1).sd().ack_req(), SDin);
    bench.press();
    bench.row(d(6), m(2), PDin);
}

/// Released and pressed between two good answers: the level 0 was never looked at.
#[test]
fn t13_samples_chfack_c_when_a_good_answer_is_checked() {
    let mut bench = Bench::operate(4);
    bench.press();
    bench.row(d(3).bad(), m(5).sd(), SDin);
    bench.row(d(2), m(6).sd().ack_req(), SDin);
    bench.release();
    bench.press();
    bench.row(d(1), m(7).sd().ack_req(), SDin);
}

#[test]
fn t14_withdraws_the_request_disarms_and_starts_again_at_0() {
    let mut bench = Bench::after_fault(None);
    bench.row(d(2), m(6).sd().ack_req(), SDin);
    bench.press();
    bench.advance(WATCHDOG);
    assert!(!bench.services.chfackreq_s && bench.services.faults_s);
    bench.expect_out(None, m(0).sd());
    bench.row(d(7), m(1).sd().ack_req(), SDin);
    bench.row(d(6), m(2).sd().ack_req(), SDin);
    bench.release();
    bench.row(d(5), m(3).sd().ack_req(), SDin);
    bench.press();
    bench.row(d(4), m(4), PDin);
}

// --- MTimer ---

fn timed_out(bench: &Bench) -> bool {
    bench
        .last
        .iter()
        .any(|seen| matches!(seen.seen, Seen::Service { service: Service::FaultsS, value, .. } if value.is_set()))
}

#[rstest]
#[case::under(WATCHDOG - 1, false)]
#[case::at(WATCHDOG, true)]
#[case::over(WATCHDOG + 1, true)]
fn m_timer_expires_at_fsp_watchdog(#[case] ns: u64, #[case] expired: bool) {
    let mut bench = Bench::operate(4);
    bench.advance(ns);
    assert_eq!(timed_out(&bench), expired);
    bench.expect_out(None, if expired { m(0).sd() } else { m(4) });
}

#[test]
fn an_expiry_is_reported_when_it_happens() {
    let mut bench = Bench::operate(4);
    let began = bench.last.last().unwrap().at;
    bench.advance(WATCHDOG + 7 * MS);
    assert!(bench.last.iter().all(|seen| seen.at == began + WATCHDOG));
}

#[test]
fn an_answer_at_the_very_instant_of_the_expiry_comes_behind_it() {
    let mut bench = Bench::operate(4);
    bench.advance(WATCHDOG);
    bench.expect_out(Some(d(3)), m(0).sd());
}

#[rstest]
#[case::repetition(Some(d(4).octets()))]
#[case::zeros(Some(Octets::zero(5)))]
#[case::nothing(None)]
fn m_timer_of_state_5_is_restarted_by_a_new_spdu_alone(#[case] octets: Option<Octets>) {
    let mut bench = Bench::operate(4);
    for _ in 0..3 {
        bench.advance(WATCHDOG / 4);
        bench.exchange(octets);
        assert_eq!(bench.image(), Some(m(4).octets()));
    }
    bench.advance(WATCHDOG / 4 - 1);
    assert!(!timed_out(&bench));
    bench.advance(1);
    assert!(timed_out(&bench));
}

#[test]
fn m_timer_of_state_7_is_not_restarted_by_what_is_not_expected() {
    let mut bench = Bench::after_fault(None);
    bench.advance(WATCHDOG - MS);
    bench.exchange(Some(d(4).octets()));
    bench.advance(MS - 1);
    bench.expect_out(None, m(5).sd());
    bench.advance(1);
    bench.expect_out(None, m(0).sd());
}

#[test]
fn each_new_spdu_has_a_whole_fsp_watchdog() {
    let mut bench = Bench::operate(4);
    for (answer, out) in [(3, 5), (2, 6), (1, 7), (0, 1)] {
        bench.advance(WATCHDOG - MS - 1);
        bench.row(d(answer), m(out), PDin);
    }
}

// --- around the SCL ---

#[test]
fn latency_holds_back_images_and_not_services() {
    let options = fsct_reference::MasterOptions { latency: 2, ..Default::default() };
    let mut bench = Bench::configured(List::new(Iec2022), options);
    bench.connect();
    for _ in 0..2 {
        bench.exchange(None);
        assert_eq!(bench.image(), Some(Octets::zero(5)));
    }
    bench.exchange(Some(d(7).octets()));
    assert_eq!(bench.image(), Some(m(0).sd().octets()));
    assert!(bench.services.qualifier);
    bench.exchange(None);
    assert_eq!(bench.image(), Some(m(0).sd().octets()));
    bench.exchange(None);
    assert_eq!(bench.image(), Some(Out { data: 0, ..m(1) }.octets()));
}
