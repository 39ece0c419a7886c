//! What a clock is made of by its stamps: scripted round trips, no time passes.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod common;

use common::*;
use fsct_adapters::{Clock, ClockKind, ClockProof, Finding, Trip};

/// Round trips every millisecond of 40 us, stamped in the middle by a clock that is 7 s ahead and this much faster.
fn trips(faster_ppm: u64) -> Vec<Trip> {
    let stamp = |ours: u64| 7_000_000_000 + ours + ours * faster_ppm / 1_000_000;
    let sent = (0..32).map(|trip| trip * 1_000_003 + trip * trip * 7);
    sent.map(|sent| Trip { sent, stamp: stamp(sent + 20_000), received: sent + 40_000 }).collect()
}

fn real(uncertainty_ns: u64) -> Clock {
    Clock { kind: ClockKind::Real, resolution_ns: 1, uncertainty_ns }
}

#[test]
fn a_right_clock_is_proved_as_far_as_the_way_is_short() {
    let proved = ClockProof::of(&trips(0), real(100_000));
    assert_eq!((proved.finding, proved.off_ns, proved.shown_ns), (Finding::Proved, 0, 40_000));
    let finer = ClockProof::of(&trips(0), real(10_000));
    assert_eq!((finer.finding, finer.uncertainty_ns()), (Finding::Unproved, 40_000));
}

#[test]
fn a_clock_that_runs_too_fast_jumps_or_goes_back_is_contradicted() {
    assert_eq!(ClockProof::of(&trips(20_000), real(100_000)).finding, Finding::Contradicted);
    let mut jumped = trips(0);
    jumped[20].stamp += 300_000;
    assert_eq!(ClockProof::of(&jumped, real(100_000)).finding, Finding::Contradicted);
    let mut back = trips(0);
    back[8].stamp = back[7].stamp - 1;
    assert_eq!(ClockProof::of(&back, real(100_000_000)).finding, Finding::Contradicted);
}

#[test]
fn a_coarse_clock_is_trusted_no_further_than_its_steps() {
    let mut coarse = trips(0);
    coarse.iter_mut().for_each(|trip| trip.stamp -= trip.stamp % 50_000);
    let proof = ClockProof::of(&coarse, real(10_000));
    assert!(proof.uncertainty_ns() >= 50_000, "{proof:?}");
}

#[test]
fn a_virtual_clock_follows_every_advance() {
    let clock = description().clock;
    let proof = ClockProof::measure(&mut Mirror::default(), clock, &mut fsct_adapters::Monotonic::default()).unwrap();
    assert_eq!((proof.finding, proof.shown_ns), (Finding::Proved, 0));
}
