//! Each transition of Table 40, and the guards between them.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod common;

use common::*;
use fsct_adapters::{Octets, Service};
use fsct_protocol::{Edition, ProtMode};
use fsct_reference::scl::{Config, Inputs, Scl, State};
use rstest::rstest;

#[test]
fn t20_ends_system_start() {
    let port = fsct_protocol::spdu::Port::ONE;
    let mut scl = Scl::new(Config { mode: ProtMode::Crc16, pd_out: 1, port, watchdog_ms: 1, mutant: None });
    let inputs = Inputs { pd_in: fsct_protocol::spdu::Pd::safe(1), sd_set_ds: false };
    let first = m(0).port(1).octets(variant(Edition::V1_1, ProtMode::Crc16, 1));

    scl.received(0, first.as_slice(), &inputs);
    assert_eq!((scl.state(), scl.answer()), (State::SystemStart20, None));
    scl.system_start_ok(0);
    assert_eq!(scl.state(), State::WaitOnSpdu21);
    scl.received(0, first.as_slice(), &inputs);
    assert_eq!((scl.state(), scl.answer().is_some()), (State::WaitOnSpdu24, true));
}

#[test]
fn state_21_waits_without_time_limit() {
    let mut bench = Bench::waiting_first(plain());
    bench.advance(10 * WATCHDOG);
    assert_eq!(bench.last, []);
    bench.receive(None);
    bench.expect_silence();
    bench.row(m(0).sd(), d(7).sd_set(), SDout);
}

#[rstest]
fn t21_t22_first_spdu_is_0(#[values(Edition::V1_1, Edition::Iec2022)] edition: Edition) {
    let mut bench = Bench::waiting_first(variant(edition, ProtMode::Crc32, 4));
    bench.row(m(0).sd(), d(7).sd_set(), SDout);
    bench.expect_service(Service::SetsdDc, &[1]);
}

/// A device power cycle shorter than the watchdog would pass unnoticed if 1 were taken, in v1.1 as well.
#[rstest]
fn t21_t25_first_spdu_is_not_0(
    #[values(Edition::V1_1, Edition::Iec2022)] edition: Edition,
    #[values(1, 2, 3, 4, 5, 6, 7)] first: u8,
) {
    let mut bench = Bench::waiting_first(variant(edition, ProtMode::Crc16, 3));
    // The initial DTimeout is still there.
    bench.row(m(first), d(7 - first).sd_set().comm_err().timeout(), SDout);
}

#[test]
fn t22_set_sd_keeps_process_data_back_and_leaves_sd_set_alone() {
    let mut bench = Bench::operating(plain());
    bench.row(m(4).set_sd(), d(3), SDout);
    bench.expect_service(Service::SetsdDc, &[1]);
    bench.row(m(5), d(2), PDout);
    bench.expect_service(Service::SetsdDc, &[0]);
}

#[test]
fn t22_sends_pdin_d_as_it_is_then() {
    let mut bench = Bench::operating(plain());
    bench.set(Service::PdinD, &[1, 2, 3]);
    bench.receive(None);
    assert_eq!(bench.image.unwrap().as_slice()[..3], [0x1B; 3], "an answer that stands is not touched");
    bench.exchange(m(4));
    assert_eq!(bench.image.unwrap().as_slice()[..3], [1, 2, 3]);
}

#[test]
fn t23_sd_set_ds_sets_sd_set_in_the_next_answer() {
    let mut bench = Bench::operating(plain());
    bench.set(Service::SdsetDs, &[1]);
    bench.row(m(4), d(3).sd_set(), PDout);
    bench.set(Service::SdsetDs, &[0]);
    bench.row(m(5), d(2), PDout);
}

#[test]
fn t24_old_and_all_zero_spdus_change_nothing() {
    let mut bench = Bench::operating(plain());
    let variant = bench.variant;
    bench.expect_ignored(None);
    bench.expect_ignored(Some(Octets::zero(7)));
    bench.expect_ignored(Some(m(3).octets(variant)));
    bench.expect_ignored(Some(m(3).data(0x77).octets(variant)));
    bench.expect_ignored(Some(m(3).bad().octets(variant)));
    bench.expect_ignored(Octets::new(&m(4).octets(variant).as_slice()[..6]));
    bench.row(m(4), d(3), PDout);
}

#[test]
fn t24_octets_behind_the_spdu_are_non_safety_data() {
    let mut bench = Bench::operating(plain());
    let longer = [m(4).octets(plain()).as_slice(), &[0xEE; 4]].concat();
    bench.receive(Octets::new(&longer));
    assert_eq!(bench.answer(), Some(d(3)));
}

#[test]
fn t24_m_count_0_is_taken_at_any_time_but_not_twice() {
    let mut bench = Bench::operating(plain());
    bench.row(m(0), d(7), PDout);
    let variant = bench.variant;
    bench.expect_ignored(Some(m(0).data(0x77).octets(variant)));
    bench.row(m(1), d(6), PDout);
}

#[rstest]
#[case::signature(m(4).bad(), d(3))]
#[case::port(m(4).port(PORT + 1), d(3))]
#[case::port_inverted(m(4).port(!PORT), d(3))]
#[case::jump(m(5), d(2))]
#[case::backwards(m(2), d(5))]
fn t25_comm_err_in_operation(#[case] spdu: Out, #[case] answer: fsct_protocol::spdu::Status) {
    let mut bench = Bench::operating(plain());
    bench.row(spdu, answer.sd_set().comm_err(), SDout);
    bench.expect_service(Service::SetsdDc, &[1]);
}

/// Every bit of a new SPDU, unless the counter bits become those of the previous one.
#[rstest]
fn t25_every_single_bit(#[values((ProtMode::Crc16, 3), (ProtMode::Crc32, 25))] size: (ProtMode, u8)) {
    let variant = variant(Edition::Iec2022, size.0, size.1);
    // 5 follows 4; one flipped bit of 101 never gives 100 = 4 but for the lowest.
    let good = m(5).octets(variant);
    let control_bit_5 = (usize::from(size.1) + 1) * 8 + 2;
    for bit in 0..good.as_slice().len() * 8 {
        let mut bench = Bench::operating(variant);
        bench.row(m(4), d(3), PDout);
        let mut bad = good.as_slice().to_vec();
        bad[bit / 8] ^= 0x80 >> (bit % 8);
        bench.receive(Octets::new(&bad));
        let status = bench.answer().unwrap();
        assert_eq!(status.d_comm_err, bit != control_bit_5, "bit {bit}");
        assert_eq!(status.sd_set, bit != control_bit_5, "bit {bit}");
    }
}

#[test]
fn t27_old_and_all_zero_spdus_change_nothing() {
    let mut bench = Bench::after_comm_err(plain());
    let variant = bench.variant;
    bench.expect_ignored(Some(Octets::zero(7)));
    bench.expect_ignored(Some(m(4).octets(variant)));
    bench.row(m(5).sd(), d(2).sd_set().comm_err(), SDout);
}

/// The received setSD has no say in T28; process data come one cycle later.
#[rstest]
fn t28_ends_the_sd_cycles_with_sd_out(#[values(false, true)] set_sd: bool) {
    let mut bench = Bench::after_comm_err(plain());
    let spdu = |count| Out { set_sd, ..m(count) };
    bench.row(spdu(5), d(2).sd_set().comm_err(), SDout);
    bench.row(spdu(6), d(1).sd_set(), SDout);
    bench.row(spdu(7), d(0).sd_set(), SDout);
    bench.expect_service(Service::SetsdDc, &[1]);
    bench.row(spdu(1), d(6), SDout);
    bench.expect_service(Service::SetsdDc, &[0]);
    bench.row(spdu(2), d(5), if set_sd { SDout } else { PDout });
}

#[test]
fn t28_is_followed_by_t23() {
    let mut bench = Bench::after_comm_err(plain());
    bench.set(Service::SdsetDs, &[1]);
    (5..=7).for_each(|count| bench.exchange(m(count)));
    bench.row(m(1), d(6).sd_set(), SDout);
}

#[test]
fn t29_a_second_error_reloads_sd_cycles_and_is_reported_twice() {
    let mut bench = Bench::after_comm_err(plain());
    bench.row(m(5), d(2).sd_set().comm_err(), SDout);
    bench.row(m(6), d(1).sd_set(), SDout);
    bench.row(m(7).bad(), d(0).sd_set().comm_err(), SDout);
    bench.row(m(1), d(6).sd_set().comm_err(), SDout);
    bench.row(m(2), d(5).sd_set(), SDout);
    bench.row(m(3), d(4).sd_set(), SDout);
    bench.row(m(4), d(3), SDout);
    bench.row(m(5), d(2), PDout);
}

/// Nested reading of T29: an error does not use up the report of the one before, nor that of a time-out.
#[test]
fn t29_counters_are_worked_off_without_error_only() {
    let mut bench = Bench::after_timeout(plain());
    bench.row(m(4).bad(), d(3).sd_set().timeout().comm_err(), SDout);
    bench.row(m(5).bad(), d(2).sd_set().timeout().comm_err(), SDout);
    bench.row(m(6), d(1).sd_set().timeout().comm_err(), SDout);
    bench.row(m(7), d(0).sd_set(), SDout);
}

/// R-11.5.3-23: the report of the second error reaches an answer that the FS-Master can take.
#[test]
fn t29_an_error_behind_an_error_is_not_forgotten() {
    let mut bench = Bench::operating(plain());
    bench.row(m(4), d(3), PDout);
    bench.row(m(5).bad(), d(2).sd_set().comm_err(), SDout);
    bench.row(m(6), d(1).sd_set().comm_err(), SDout);
    bench.row(m(7), d(0).sd_set(), SDout);
    bench.row(m(0).bad(), d(7).sd_set().comm_err(), SDout);
    bench.row(m(1), d(6).sd_set().comm_err(), SDout);
    bench.row(m(2), d(5).sd_set(), SDout);
    bench.row(m(3), d(4).sd_set(), SDout);
}

/// The previous SPDU is the one checked last: a corrupted counter makes its correct repetition a second error.
#[test]
fn a_corrupted_counter_is_mirrored_as_received() {
    let mut bench = Bench::operating(plain());
    bench.row(m(6).bad(), d(1).sd_set().comm_err(), SDout);
    bench.row(m(4), d(3).sd_set().comm_err(), SDout);
    bench.row(m(5), d(2).sd_set().comm_err(), SDout);
    bench.row(m(6), d(1).sd_set(), SDout);
}

#[test]
fn ch_f_ack_req_dc_follows_the_control_octet() {
    let mut bench = Bench::operating(plain());
    bench.exchange(m(4).ack_req());
    bench.expect_service(Service::ChfackreqDc, &[1]);
    bench.exchange(m(5));
    bench.expect_service(Service::ChfackreqDc, &[0]);
}
