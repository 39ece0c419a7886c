//! The SCL of the FS-Master: the sequence charts of 11.5.4 from its side, one line an exchange - answer, SPDU behind it, what
//! the gateway gets - then Table 38 transition by transition, then MTimer.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod master_common;

use fsct_adapters::{Observation, Octets, Seen, Service, Stimulus};
use fsct_protocol::Edition;
use fsct_protocol::ProtMode::{self, Crc16, Crc32};
use fsct_reference::MasterOptions;
use master_common::*;
use rstest::rstest;

/// 11.5.4.1: both power ON. MCount wraps from 7 to 1.
#[rstest]
fn start_up(
    #[values(Edition::V1_1, Edition::Iec2022)] edition: Edition,
    #[values((Crc16, 0), (Crc16, 3), (Crc32, 0), (Crc32, 25))] size: (ProtMode, u8),
) {
    let mut chart = Bench::waiting_first(variant(edition, size.0, size.1));
    chart.sends(m(0).sd(), SDin);
    chart.row(d(7).sd_set(), m(1), SDin);
    chart.row(d(6).sd_set(), m(2), SDin);
    chart.row(d(5).sd_set(), m(3), SDin);
    chart.row(d(4), m(4), PDin);
    chart.row(d(3), m(5), PDin);
    chart.row(d(2), m(6), PDin);
    chart.row(d(1), m(7), PDin);
    chart.row(d(0), m(1), PDin);
    chart.row(d(6), m(2), PDin);
    chart.row(d(5), m(3), PDin);
    assert!(!chart.bit(Service::FaultsS));
}

/// 11.5.4.2: FS-Master power OFF then ON.
#[rstest]
fn master_off_and_on(#[values(Edition::V1_1, Edition::Iec2022)] edition: Edition) {
    let mut chart = Bench::operate(of(edition));
    chart.power(false);
    chart.answer(d(4).sd_set().timeout());
    assert_eq!(chart.image, None);
    chart.power(true);
    chart.start();
    chart.set(Service::PdoutM, &[PD_OUT; 3]);
    chart.sends(m(0).sd(), SDin);
    chart.row(d(7).sd_set(), m(1), SDin);
    chart.row(d(6).sd_set(), m(2), SDin);
    chart.row(d(5).sd_set(), m(3), SDin);
    chart.row(d(4), m(4), PDin);
    chart.row(d(3), m(5), PDin);
}

/// 11.5.4.3: FS-Device with delayed SCL start. It is waited for without time limit.
#[test]
fn delayed_start() {
    let mut chart = Bench::waiting_first(plain());
    for _ in 0..4 {
        chart.receive(Some(Octets::zero(7)));
        chart.expect(m(0).sd(), SDin);
        chart.advance(2 * WATCHDOG);
        assert_eq!(chart.last, []);
    }
    chart.row(d(7).sd_set(), m(1), SDin);
    chart.row(d(6).sd_set(), m(2), SDin);
    chart.row(d(5).sd_set(), m(3), SDin);
    chart.row(d(4), m(4), PDin);
}

/// 11.5.4.4: FS-Device power OFF then ON.
#[test]
fn device_off_and_on() {
    let mut chart = Bench::operate(plain());
    chart.row(d(3), m(5), PDin);
    chart.advance(WATCHDOG);
    chart.sends(m(0).sd(), SDin);
    chart.advance(WATCHDOG);
    chart.sends(m(0).sd(), SDin);
    chart.row(d(7).sd_set(), m(1).sd().ack_req(), SDin);
    chart.row(d(6).sd_set(), m(2).sd().ack_req(), SDin);
    chart.row(d(5).sd_set(), m(3).sd().ack_req(), SDin);
    chart.ack(1);
    chart.row(d(4), m(4), PDin);
    chart.row(d(3), m(5), PDin);
}

/// v1.1 11.5.4.6, iec2022 11.5.4.5: the FS-Master detects a CRC error. The counter goes on.
#[rstest]
fn master_detects_crc_error(
    #[values(Edition::V1_1, Edition::Iec2022)] edition: Edition,
    #[values((Crc16, 3), (Crc32, 25))] size: (ProtMode, u8),
) {
    let mut chart = Bench::operate(variant(edition, size.0, size.1));
    chart.row(d(3).bad(), m(5).sd(), SDin);
    chart.row(d(2), m(6).sd().ack_req(), SDin);
    chart.row(d(1), m(7).sd().ack_req(), SDin);
    chart.row(d(0), m(1).sd().ack_req(), SDin);
    chart.ack(1);
    chart.row(d(6), m(2), PDin);
    chart.row(d(5), m(3), PDin);
}

/// v1.1 11.5.4.7, iec2022 11.5.4.6: the FS-Device detects a CRC error. No request while it still reports it.
#[test]
fn device_detects_crc_error() {
    let mut chart = Bench::operate(plain());
    chart.row(d(3), m(5), PDin);
    chart.row(d(2).sd_set().comm_err(), m(6).sd(), SDin);
    chart.row(d(1).sd_set().comm_err(), m(7).sd(), SDin);
    chart.row(d(0).sd_set(), m(1).sd().ack_req(), SDin);
    chart.row(d(6).sd_set(), m(2).sd().ack_req(), SDin);
    chart.ack(1);
    chart.row(d(5), m(3), PDin);
    chart.row(d(4), m(4), PDin);
}

/// No chart of the standard: the FS-Device reports its time-out in the next answers.
#[test]
fn device_times_out() {
    let mut chart = Bench::operate(plain());
    chart.row(d(3).sd_set().timeout(), m(5).sd(), SDin);
    chart.row(d(2).sd_set().timeout(), m(6).sd(), SDin);
    chart.row(d(1).sd_set(), m(7).sd().ack_req(), SDin);
    chart.ack(1);
    chart.row(d(0), m(1), PDin);
}

#[rstest]
fn t1_t2_the_first_spdu_stands_with_safe_data(#[values(Edition::V1_1, Edition::Iec2022)] edition: Edition) {
    let mut bench = Bench::waiting_first(of(edition));
    bench.set(Service::SetsdC, &[0]);
    bench.ack(1);
    bench.sends(m(0).sd(), SDin);
    assert!(!bench.bit(Service::FaultsS));
}

/// T3 has no guard but the zeros: any counter is checked.
#[rstest]
#[case::of_an_earlier_connection(d(3))]
#[case::bad(d(7).bad())]
fn t3_t7_a_wrong_first_answer(#[case] answer: Answer) {
    let mut bench = Bench::waiting_first(plain());
    bench.row(answer, m(1).sd(), SDin);
    assert!(bench.bit(Service::FaultsS));
    bench.row(d(6), m(2).sd().ack_req(), SDin);
}

/// setSD_C forces safe data both ways and needs no acknowledgment; a fault it is not.
#[test]
fn t4_t5_set_sd_c() {
    let mut bench = Bench::operate(plain());
    bench.set(Service::SetsdC, &[1]);
    assert_eq!(bench.last, []);
    bench.row(d(3), m(5).sd(), SDin);
    bench.set(Service::SetsdC, &[0]);
    bench.row(d(2), m(6), PDin);
    assert!(!bench.bit(Service::FaultsS));
}

/// SDset of the answer is safe data, no fault.
#[test]
fn t4_t5_sd_set() {
    let mut bench = Bench::operate(plain());
    bench.row(d(3).sd_set(), m(5), SDin);
    assert!(!bench.bit(Service::FaultsS));
    bench.row(d(2), m(6), PDin);
}

/// The previous counter is old, whatever else the answer says.
#[rstest]
#[case::lost(None)]
#[case::old(Some(d(4).octets(plain())))]
#[case::old_and_bad(Some(d(4).bad().octets(plain())))]
#[case::old_with_timeout(Some(d(4).sd_set().timeout().octets(plain())))]
#[case::all_zero(Some(Octets::zero(7)))]
#[case::too_short(Some(Octets::zero(6)))]
#[case::too_long(Octets::new(&[d(3).octets(plain()).as_slice(), &[0]].concat()))]
#[case::empty(Some(Octets::default()))]
fn t6_is_not_taken_with(#[case] octets: Option<Octets>) {
    Bench::operate(plain()).expect_ignored(octets);
}

#[rstest]
#[case::crc(d(3).bad())]
#[case::counter(d(1))]
#[case::port_num_not_inverted(d(3).port(PORT))]
#[case::port_num_of_another(d(3).port(!1))]
#[case::d_comm_err(d(3).comm_err())]
#[case::d_timeout(d(3).timeout())]
fn t6_t7_t9_every_fault(#[case] answer: Answer) {
    let mut bench = Bench::operate(plain());
    bench.row(answer, m(5).sd(), SDin);
    assert!(bench.bit(Service::FaultsS));
}

#[test]
fn t8_counts_from_0() {
    let mut bench = Bench::operate(plain());
    bench.advance(WATCHDOG);
    bench.sends(m(0).sd(), SDin);
    assert!(bench.bit(Service::FaultsS));
    bench.row(d(7), m(1).sd().ack_req(), SDin);
}

/// State 7 takes the mirrored counter alone, even if the answer before had the same.
#[test]
fn t10_expected_answers_only() {
    let mut bench = Bench::after_fault(plain());
    for counter in [0, 1, 3, 4, 5, 6, 7] {
        bench.expect_ignored(Some(d(counter).octets(plain())));
    }
    bench.row(d(2), m(6).sd().ack_req(), SDin);

    let mut bench = Bench::waiting_first(plain());
    bench.row(d(7).sd_set(), m(1), SDin);
    bench.advance(WATCHDOG);
    bench.sends(m(0).sd(), SDin);
    bench.row(d(7).sd_set(), m(1).sd().ack_req(), SDin);
}

/// Zeros are ignored although their counter mirrors MCount 7.
#[test]
fn t10_not_with_zeros() {
    let mut bench = Bench::after_fault(plain());
    bench.row(d(2), m(6).sd().ack_req(), SDin);
    bench.row(d(1), m(7).sd().ack_req(), SDin);
    bench.expect_ignored(Some(Octets::zero(7)));
    bench.row(d(0), m(1).sd().ack_req(), SDin);
}

/// T11 with SDset or setSD_C: regular operation with safe data.
#[test]
fn t11_while_safe_data_are_asked_for() {
    let armed = || {
        let mut bench = Bench::after_fault(plain());
        bench.row(d(2), m(6).sd().ack_req(), SDin);
        bench.ack(1);
        bench
    };
    let mut bench = armed();
    bench.row(d(1).sd_set(), m(7), SDin);
    assert!(!bench.bit(Service::FaultsS));
    bench.row(d(0), m(1), PDin);

    let mut bench = armed();
    bench.set(Service::SetsdC, &[1]);
    bench.row(d(1), m(7).sd(), SDin);
    assert!(!bench.bit(Service::FaultsS));
}

/// T12 withdraws the request, and the acknowledgment has to be armed anew.
#[test]
fn t12_a_fault_while_an_acknowledgment_is_awaited() {
    let mut bench = Bench::after_fault(plain());
    bench.row(d(2), m(6).sd().ack_req(), SDin);
    bench.ack(1);
    bench.row(d(1).bad(), m(7).sd(), SDin);
    bench.row(d(0), m(1).sd().ack_req(), SDin);
    bench.row(d(6), m(2).sd().ack_req(), SDin);
    bench.ack(0);
    bench.row(d(5), m(3).sd().ack_req(), SDin);
    bench.ack(1);
    bench.row(d(4), m(4), PDin);
}

/// T13 until ChFAck_C has been 0 and then 1, looked at with good answers.
#[test]
fn t13_an_acknowledgment_is_an_edge() {
    let mut bench = Bench::operate(plain());
    bench.ack(1);
    bench.row(d(3).bad(), m(5).sd(), SDin);
    bench.row(d(2), m(6).sd().ack_req(), SDin);
    bench.row(d(1), m(7).sd().ack_req(), SDin);
    bench.ack(0);
    bench.ack(1);
    bench.row(d(0), m(1).sd().ack_req(), SDin);
    bench.ack(0);
    bench.row(d(6), m(2).sd().ack_req(), SDin);
    bench.ack(1);
    bench.row(d(5), m(3), PDin);
}

/// ChFAckReq stays on the SPDU of an answer that is awaited; MTimer withdraws it.
#[test]
fn t14_counts_from_0_and_disarms() {
    let mut bench = Bench::after_fault(plain());
    bench.row(d(2), m(6).sd().ack_req(), SDin);
    bench.advance(WATCHDOG);
    bench.sends(m(0).sd(), SDin);
    bench.ack(1);
    bench.row(d(7), m(1).sd().ack_req(), SDin);
    bench.row(d(6), m(2).sd().ack_req(), SDin);
    assert!(bench.bit(Service::FaultsS));
}

#[rstest]
#[case::under(WATCHDOG - 1, m(4), PDin)]
#[case::at(WATCHDOG, m(0).sd(), SDin)]
#[case::over(WATCHDOG + 1, m(0).sd(), SDin)]
fn m_timer_expires_at_fsp_watchdog(#[case] waited: u64, #[case] out: Out, #[case] gateway: Use) {
    let mut bench = Bench::operate(plain());
    bench.advance(waited);
    bench.sends(out, gateway);
}

/// An answer at the very instant of the expiry comes after it, and is then another than the expected one.
#[rstest]
#[case::under(WATCHDOG - 1, m(5), PDin)]
#[case::at(WATCHDOG, m(0).sd(), SDin)]
fn an_answer_in_time(#[case] waited: u64, #[case] out: Out, #[case] gateway: Use) {
    let mut bench = Bench::operate(plain());
    bench.advance(waited);
    bench.row(d(3), out, gateway);
}

#[rstest]
#[case::lost(None)]
#[case::old(Some(d(4).octets(plain())))]
#[case::old_and_bad(Some(d(4).bad().octets(plain())))]
#[case::all_zero(Some(Octets::zero(7)))]
fn m_timer_is_not_restarted_by(#[case] octets: Option<Octets>) {
    let mut bench = Bench::operate(plain());
    for _ in 0..4 {
        bench.advance(WATCHDOG / 4);
        bench.receive(octets);
    }
    bench.expect(m(0).sd(), SDin);
}

/// T14 after T9: not restarted in state 7 either.
#[rstest]
#[case::repeated(d(4))]
#[case::foreign(d(6))]
fn m_timer_is_not_restarted_in_state_7_by(#[case] answer: Answer) {
    let mut bench = Bench::after_fault(plain());
    for _ in 0..4 {
        bench.sends(m(5).sd(), SDin);
        bench.advance(WATCHDOG / 4);
        bench.answer(answer);
    }
    bench.expect(m(0).sd(), SDin);
}

#[rstest]
#[case::t5(Bench::operate(plain()), d(3), m(5))]
#[case::t9_of_t7(Bench::operate(plain()), d(3).bad(), m(5).sd())]
#[case::t9_of_t13(Bench::after_fault(plain()), d(2), m(6).sd().ack_req())]
#[case::t9_of_t12(Bench::after_fault(plain()), d(2).bad(), m(6).sd())]
fn m_timer_is_restarted_by(#[case] mut bench: Bench, #[case] answer: Answer, #[case] out: Out) {
    bench.advance(WATCHDOG - 1);
    bench.answer(answer);
    bench.advance(WATCHDOG - 1);
    bench.receive(None);
    assert_eq!(bench.out(), Some(out));
    bench.advance(1);
    bench.sends(m(0).sd(), SDin);
}

#[test]
fn the_services_change_at_the_instant_of_the_expiry() {
    let mut bench = Bench::operate(plain());
    let sent = bench.last.last().unwrap().at;
    bench.apply(&[Stimulus::Advance { ns: 1 }, Stimulus::Advance { ns: 3 * WATCHDOG }]);
    let service = |service, value: &[u8]| Observation {
        stimulus: 1,
        at: sent + WATCHDOG,
        seen: Seen::Service { port: PORT, service, value: Octets::new(value).unwrap() },
    };
    let expected = [
        service(Service::PdinM, &[0; 3]),
        service(Service::SdsetS, &[1]),
        service(Service::FaultsS, &[1]),
        service(Service::Qualifier, &[0]),
    ];
    assert_eq!(bench.last, expected);
}

/// Expiries without effect are passed over, and the next one is still due when it would have been.
#[test]
fn a_day_of_expiries() {
    let mut bench = Bench::after_timeout(plain());
    bench.advance(86_400 * S - 1);
    assert_eq!(bench.last, []);
    bench.row(d(7), m(1).sd().ack_req(), SDin);
    bench.advance(WATCHDOG - 1);
    bench.sends(m(1).sd().ack_req(), SDin);
    bench.advance(1);
    bench.sends(m(0).sd(), SDin);
}

/// SPDUs wait in the image, services do not.
#[rstest]
fn latency_delays_the_image_alone(#[values(0, 1, 2, 8)] latency: u8) {
    let mut bench = Bench::waiting_first_with(plain(), MasterOptions { latency, ..MasterOptions::default() });
    let mut images = Vec::new();
    for (answer, live) in [(d(7).sd_set(), false), (d(6), true), (d(5), true), (d(4), true)] {
        bench.answer(answer);
        assert_eq!(bench.image.unwrap().as_slice().len(), 7);
        assert_eq!(bench.bit(Service::Qualifier), live);
        images.push(bench.out());
    }
    let mut expected = vec![None; latency.into()];
    expected.extend([m(1), m(2), m(3), m(4)].map(Some));
    expected.truncate(4);
    assert_eq!(images, expected);
}

/// PDin_M and PDout_M have the length that the configuration says.
#[rstest]
#[case(&[])]
#[case(&[1, 2])]
#[case(&[1, 2, 3, 4])]
fn pd_out_of_another_length_is_unsupported(#[case] value: &[u8]) {
    let mut bench = Bench::operate(plain());
    bench.set(Service::PdoutM, value);
    assert_eq!(bench.seen(), [Seen::Unsupported]);
    bench.row(d(3), m(5), PDin);
}
