//! DTimer on the virtual clock, to the nanosecond: T30, T31, and what restarts it.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod common;

use common::*;
use fsct_adapters::{Observation, Octets, Seen, Service, Stimulus};
use fsct_reference::Options;
use rstest::rstest;

#[rstest]
#[case::under(WATCHDOG - 1, false)]
#[case::at(WATCHDOG, true)]
#[case::over(WATCHDOG + 1, true)]
fn t31_expires_at_fsp_watchdog(#[case] waited: u64, #[case] expired: bool) {
    let mut bench = Bench::operating(plain());
    bench.advance(waited);
    bench.receive(None);
    match expired {
        false => bench.expect(d(4), PDout),
        true => bench.expect(d(4).sd_set().timeout(), SDout),
    }
}

/// An SPDU at the very instant of the expiry comes after it.
#[rstest]
#[case::under(WATCHDOG - 1, d(3), PDout)]
#[case::at(WATCHDOG, d(3).sd_set().timeout(), SDout)]
fn an_spdu_in_time(#[case] waited: u64, #[case] answer: fsct_protocol::spdu::Status, #[case] device_out: Use) {
    let mut bench = Bench::operating(plain());
    bench.advance(waited);
    bench.row(m(4), answer, device_out);
}

#[test]
fn the_services_change_at_the_instant_of_the_expiry() {
    let mut bench = Bench::operating(plain());
    bench.advance(7);
    bench.exchange(m(4));
    bench.apply(&[Stimulus::Advance { ns: 1 }, Stimulus::Advance { ns: 3 * WATCHDOG }]);
    let service = |service, value: &[u8]| Observation {
        stimulus: 1,
        at: 7 + WATCHDOG,
        seen: Seen::Service { port: 1, service, value: Octets::new(value).unwrap() },
    };
    assert_eq!(bench.last, [service(Service::PdoutD, &[0; 3]), service(Service::SetsdDc, &[1])]);
}

/// T30 expires at whole multiples of FSP_Watchdog and takes PDin_D of that moment.
#[rstest]
#[case(WATCHDOG - 7 * MS - 1, 0x1B)]
#[case(WATCHDOG - 7 * MS, 0x2C)]
fn t30_repeats_the_answer_with_the_process_data_of_then(#[case] waited: u64, #[case] sent: u8) {
    let mut bench = Bench::operating(plain());
    bench.advance(2 * WATCHDOG + 7 * MS);
    bench.set(Service::PdinD, &[0x2C; 3]);
    bench.advance(waited);
    bench.receive(None);
    assert_eq!(bench.image.unwrap().as_slice()[0], sent);
}

#[rstest]
#[case::t22(Bench::operating(plain()), m(4), d(3))]
#[case::t25(Bench::operating(plain()), m(4).bad(), d(3).sd_set().comm_err())]
#[case::t29(Bench::after_comm_err(plain()), m(5), d(2).sd_set().comm_err())]
fn restarted_by(#[case] mut bench: Bench, #[case] spdu: Out, #[case] answer: fsct_protocol::spdu::Status) {
    bench.advance(WATCHDOG - 1);
    bench.exchange(spdu);
    bench.advance(WATCHDOG - 1);
    bench.receive(None);
    assert_eq!(bench.answer(), Some(answer));
    bench.advance(1);
    bench.receive(None);
    assert!(bench.answer().unwrap().d_timeout);
}

#[test]
fn restarted_by_t28() {
    let mut bench = Bench::after_comm_err(plain());
    (5..=7).for_each(|count| bench.exchange(m(count)));
    bench.advance(WATCHDOG - 1);
    bench.row(m(1), d(6), SDout);
    bench.advance(WATCHDOG - 1);
    bench.receive(None);
    assert_eq!(bench.answer(), Some(d(6)));
    bench.advance(1);
    bench.receive(None);
    assert_eq!(bench.answer(), Some(d(6).sd_set().timeout()));
}

#[rstest]
#[case::lost(None)]
#[case::old(Some(m(3).octets(plain())))]
#[case::old_and_bad(Some(m(3).bad().octets(plain())))]
#[case::all_zero(Some(Octets::zero(7)))]
fn not_restarted_by(#[case] octets: Option<Octets>) {
    let mut bench = Bench::operating(plain());
    for _ in 0..4 {
        bench.advance(WATCHDOG / 4);
        bench.receive(octets);
    }
    bench.expect(d(4).sd_set().timeout(), SDout);
}

#[test]
fn no_batch_of_expiries_is_too_long() {
    let mut bench = Bench::operating(plain());
    bench.advance(u64::MAX / 2);
    bench.advance(u64::MAX);
    bench.receive(None);
    bench.expect(d(4).sd_set().timeout(), SDout);
}

#[test]
fn power_off_stops_it() {
    let mut bench = Bench::operating(plain());
    bench.power(false);
    bench.advance(2 * WATCHDOG);
    assert_eq!(bench.last, []);
}

/// Answers wait in the image, services do not.
#[rstest]
fn latency_delays_the_image_alone(#[values(0, 1, 2, 8)] latency: u8) {
    let mut bench = Bench::waiting_first_with(plain(), Options { latency, ..Options::default() });
    let mut images = Vec::new();
    for count in [0, 1, 2, 3, 4, 5, 6, 7, 1, 2, 3, 4] {
        bench.exchange(m(count));
        images.push(bench.answer().map(|status| status.dcount_i));
        let live = bench.service(Service::PdoutD) == Octets::new(&[0x50 + count; 3]);
        assert_eq!(live, images.len() > 3);
    }
    let answered = [7, 6, 5, 4, 3, 2, 1, 0, 6, 5, 4, 3].map(Some);
    let expected: Vec<_> = [None; 8][..latency.into()].iter().chain(&answered).take(12).copied().collect();
    assert_eq!(images, expected);
}
