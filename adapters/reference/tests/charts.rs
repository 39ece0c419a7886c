//! The sequence charts of 11.5.4 from the side of the FS-Device: one line an exchange, SPDU out, answer, and what the
//! technology gets.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod common;

use common::*;
use fsct_adapters::Octets;
use fsct_protocol::Edition;
use fsct_protocol::ProtMode::{self, Crc16, Crc32};
use rstest::rstest;

/// 11.5.4.1: both power ON. SD for three cycles, MCount wraps from 7 to 1.
#[rstest]
fn start_up(
    #[values(Edition::V1_1, Edition::Iec2022)] edition: Edition,
    #[values((Crc16, 0), (Crc16, 3), (Crc32, 0), (Crc32, 25))] size: (ProtMode, u8),
) {
    let mut chart = Bench::waiting_first(variant(edition, size.0, size.1));
    chart.row(m(0).sd(), d(7).sd_set(), SDout);
    chart.row(m(1), d(6).sd_set(), SDout);
    chart.row(m(2), d(5).sd_set(), SDout);
    chart.row(m(3), d(4), PDout);
    chart.row(m(4), d(3), PDout);
    chart.row(m(5), d(2), PDout);
    chart.row(m(6), d(1), PDout);
    chart.row(m(7), d(0), PDout);
    chart.row(m(1), d(6), PDout);
    chart.row(m(2), d(5), PDout);
}

/// 11.5.4.2: FS-Master power OFF then ON. The device reports its time-out with the old counter, then starts anew.
#[test]
fn master_off_and_on() {
    let mut chart = Bench::operating(plain());
    chart.advance(WATCHDOG);
    chart.receive(None);
    chart.expect(d(4).sd_set().timeout(), SDout);

    chart.power(false);
    chart.power(true);
    chart.verify();
    chart.set(fsct_adapters::Service::PdinD, &[0x1B; 3]);
    chart.row(m(0).sd(), d(7).sd_set(), SDout);
    chart.row(m(1), d(6).sd_set(), SDout);
    chart.row(m(2), d(5).sd_set(), SDout);
    chart.row(m(3), d(4), PDout);
    chart.row(m(4), d(3), PDout);
    chart.row(m(5), d(2), PDout);
}

/// 11.5.4.3: FS-Device with delayed SCL start. All octets are 0 until it answers.
#[test]
fn delayed_start() {
    let mut chart = Bench::waiting_first(plain());
    let silent = Octets::zero(7);
    for _ in 0..4 {
        chart.receive(Some(silent));
        chart.expect_silence();
        chart.advance(WATCHDOG);
    }
    chart.row(m(0).sd(), d(7).sd_set(), SDout);
    chart.row(m(1), d(6).sd_set(), SDout);
    chart.row(m(2), d(5).sd_set(), SDout);
    chart.row(m(3), d(4), PDout);
}

/// 11.5.4.4: FS-Device power OFF then ON. SDset ends with its SDcycles although the FS-Master still sends setSD.
#[test]
fn device_off_and_on() {
    let mut chart = Bench::operating(plain());
    chart.row(m(4), d(3), PDout);
    chart.power(false);
    chart.exchange(m(5));
    assert_eq!(chart.image, None);
    chart.exchange(m(0).sd());
    assert_eq!(chart.image, None);

    chart.power(true);
    chart.verify();
    chart.set(fsct_adapters::Service::PdinD, &[0x1B; 3]);
    chart.row(m(0).sd(), d(7).sd_set(), SDout);
    chart.row(m(1).sd().ack_req(), d(6).sd_set(), SDout);
    chart.row(m(2).sd().ack_req(), d(5).sd_set(), SDout);
    chart.row(m(3).sd().ack_req(), d(4), SDout);
    chart.row(m(4), d(3), PDout);
    chart.row(m(5), d(2), PDout);
}

/// v1.1 11.5.4.6, iec2022 11.5.4.5: the FS-Master detects a CRC error. No SDcycles run in the device.
#[test]
fn master_detects_crc_error() {
    let mut chart = Bench::operating(plain());
    chart.row(m(4).sd(), d(3), SDout);
    chart.row(m(5).sd().ack_req(), d(2), SDout);
    chart.row(m(6).sd().ack_req(), d(1), SDout);
    chart.row(m(7).sd().ack_req(), d(0), SDout);
    chart.row(m(1), d(6), PDout);
    chart.row(m(2), d(5), PDout);
}

/// v1.1 11.5.4.7, iec2022 11.5.4.6: the FS-Device detects a CRC error. DCommErr in two answers, SDset in four, SDout in five.
#[rstest]
fn device_detects_crc_error(
    #[values(Edition::V1_1, Edition::Iec2022)] edition: Edition,
    #[values((Crc16, 3), (Crc32, 25))] size: (ProtMode, u8),
) {
    let mut chart = Bench::operating(variant(edition, size.0, size.1));
    (4..=7).for_each(|count| chart.row(m(count), d(7 - count), PDout));
    chart.row(m(1), d(6), PDout);
    chart.row(m(2), d(5), PDout);
    chart.row(m(3).bad(), d(4).sd_set().comm_err(), SDout);
    chart.row(m(4).sd(), d(3).sd_set().comm_err(), SDout);
    chart.row(m(5).sd(), d(2).sd_set(), SDout);
    chart.row(m(6).sd().ack_req(), d(1).sd_set(), SDout);
    chart.row(m(7).sd().ack_req(), d(0), SDout);
    chart.row(m(1), d(6), PDout);
    chart.row(m(2), d(5), PDout);
}

/// No chart of the standard; the answers Table 40 gives after an expiry of DTimer.
#[test]
fn device_times_out() {
    let mut chart = Bench::operating(plain());
    chart.advance(WATCHDOG);
    chart.receive(None);
    chart.expect(d(4).sd_set().timeout(), SDout);
    chart.row(m(0).sd(), d(7).sd_set().timeout(), SDout);
    chart.row(m(1).sd(), d(6).sd_set(), SDout);
    chart.row(m(2).sd().ack_req(), d(5).sd_set(), SDout);
    chart.row(m(3).sd().ack_req(), d(4), SDout);
    chart.row(m(4), d(3), PDout);
}
