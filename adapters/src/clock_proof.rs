//! What a DUT states of its clock, held against a loop-back: made-up stimuli go there and back, and the stamps of their answers
//! have to lie where they can lie.
//!
//! A stamp belongs to a moment between sending and receiving. Of a real clock nothing but its offset to ours is unknown, so each
//! round trip bounds the offset from both sides, as in NTP; when the bounds of all round trips, widened by what the DUT states,
//! have nothing in common, the statement is wrong.

use crate::{Clock, ClockKind, Dut, DutError, MADE_UP, Observation, Seen, Stimulus};

/// Round trips before the pause and after it.
const TRIPS: usize = 16;
/// How long a real clock runs between the two: long enough for a drift to show.
pub const PAUSE_NS: u64 = 100_000_000;
/// What a virtual clock is moved by.
const STEPS_NS: [u64; 4] = [1_000, 1_000_000, 20_000_000, 100_000_000];

/// Whose time a real clock is held against.
pub trait Watch {
    /// Nanoseconds on a clock that never goes back.
    fn now_ns(&mut self) -> u64;
    /// Lets this much time pass.
    fn pause(&mut self, ns: u64);
}

/// The monotonic clock of this machine.
pub struct Monotonic(std::time::Instant);

impl Default for Monotonic {
    fn default() -> Monotonic {
        Monotonic(std::time::Instant::now())
    }
}

impl Watch for Monotonic {
    fn now_ns(&mut self) -> u64 {
        u64::try_from(self.0.elapsed().as_nanos()).unwrap_or(u64::MAX)
    }

    fn pause(&mut self, ns: u64) {
        std::thread::sleep(std::time::Duration::from_nanos(ns));
    }
}

/// One round trip, in nanoseconds: two times of ours and the stamp between them.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Trip {
    /// When the stimulus was sent.
    pub sent: u64,
    /// The stamp of the answer, on the clock of the DUT.
    pub stamp: u64,
    /// When the answer was there.
    pub received: u64,
}

/// What came of the loop-back.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Finding {
    /// Stamps are shown to be as exact as stated.
    Proved,
    /// Nothing speaks against the statement, but the way is too long or too uneven to show it.
    Unproved,
    /// Stamps cannot be what is stated.
    Contradicted,
}

/// The clock of a DUT, held against a loop-back.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct ClockProof {
    /// What came of it.
    pub finding: Finding,
    /// Stamps looked at.
    pub stamps: usize,
    /// What the DUT states, either way.
    pub stated_ns: u64,
    /// How far off a stamp can have been, either way, in half of the round trips.
    pub shown_ns: u64,
    /// How far off a stamp was at least; 0 when nothing shows that any was.
    pub off_ns: u64,
    /// The greatest number of nanoseconds all steps between stamps are multiples of; 0 when there was no step.
    pub step_ns: u64,
    /// Least and greatest drift that explains the stamps, in millionths, leaving out what is stated; none of a virtual clock.
    pub drift_ppm: Option<(i64, i64)>,
}

impl ClockProof {
    /// Sends made-up stimuli to a DUT without supply that has said hello.
    ///
    /// # Errors
    /// [`DutError`] of a round trip that fails, and [`DutError::Contract`] when an answer has no stamp.
    pub fn measure(dut: &mut dyn Dut, clock: Clock, watch: &mut dyn Watch) -> Result<ClockProof, DutError> {
        match clock.kind {
            ClockKind::Virtual => virtual_clock(dut, clock),
            ClockKind::Real => {
                let mut trips = Vec::with_capacity(2 * TRIPS);
                for trip in 0..2 * TRIPS {
                    if trip == TRIPS {
                        watch.pause(PAUSE_NS);
                    }
                    let sent = watch.now_ns();
                    let stamps = stamps(dut, &[made_up()])?;
                    trips.push(Trip { sent, stamp: stamps[0], received: watch.now_ns() });
                }
                Ok(ClockProof::of(&trips, clock))
            }
        }
    }

    /// Of round trips to a real clock, in their order.
    pub fn of(trips: &[Trip], clock: Clock) -> ClockProof {
        let offset = |stamp: u64, ours: u64| i128::from(stamp) - i128::from(ours);
        // The offset of the clock lies between these.
        let least = trips.iter().map(|trip| offset(trip.stamp, trip.received)).max().unwrap_or(0);
        let most = trips.iter().map(|trip| offset(trip.stamp, trip.sent)).min().unwrap_or(0);
        let backwards = trips.windows(2).map(|two| two[0].stamp.saturating_sub(two[1].stamp)).max().unwrap_or(0);
        let apart = u64::try_from((least - most).max(0)).unwrap_or(u64::MAX);
        let off_ns = apart.div_ceil(2).max(backwards);
        let step_ns = step(trips.iter().map(|trip| trip.stamp));
        let mut far: Vec<u64> = trips
            .iter()
            .map(|trip| {
                // Seen from either end of what the offset can be, the stamp is at most so far from either end of its trip.
                let (low, high) = (least.min(most), least.max(most));
                let late = i128::from(trip.stamp) - low - i128::from(trip.sent);
                let early = i128::from(trip.received) - (i128::from(trip.stamp) - high);
                u64::try_from(late.max(early).max(0)).unwrap_or(u64::MAX)
            })
            .collect();
        far.sort_unstable();
        let half = far.get(far.len().div_ceil(2).saturating_sub(1)).copied().unwrap_or(u64::MAX);
        let coarse = if step_ns > clock.resolution_ns { step_ns } else { 0 };
        let shown_ns = half.max(coarse);
        let contradicted = off_ns > clock.uncertainty_ns.saturating_add(clock.resolution_ns) || backwards > 0;
        ClockProof {
            finding: match () {
                () if contradicted => Finding::Contradicted,
                () if shown_ns <= clock.uncertainty_ns => Finding::Proved,
                () => Finding::Unproved,
            },
            stamps: trips.len(),
            stated_ns: clock.uncertainty_ns,
            shown_ns,
            off_ns,
            step_ns,
            drift_ppm: drift(trips),
        }
    }

    /// The uncertainty that stamps are judged with: never less than what was shown.
    pub fn uncertainty_ns(&self) -> u64 {
        self.stated_ns.max(self.off_ns).max(if self.finding == Finding::Proved { 0 } else { self.shown_ns })
    }
}

fn made_up() -> Stimulus {
    Stimulus::Other { kind: MADE_UP, octets: vec![0x5A] }
}

/// The stamps of the made-up ones among the stimuli.
fn stamps(dut: &mut dyn Dut, stimuli: &[Stimulus]) -> Result<Vec<u64>, DutError> {
    let mut observed: Vec<Observation> = Vec::new();
    dut.apply(stimuli, &mut observed)?;
    let stamp = |index: usize| {
        let own = observed.iter().filter(|one| usize::from(one.stimulus) == index);
        own.filter(|one| one.seen == Seen::Unsupported).map(|one| one.at).next()
    };
    let made_up = stimuli.iter().enumerate().filter(|(_, stimulus)| matches!(stimulus, Stimulus::Other { .. }));
    made_up.map(|(index, _)| stamp(index)).collect::<Option<Vec<u64>>>().ok_or_else(|| DutError::Contract {
        what: "a made-up stimulus was not answered `unsupported`, so there is no time stamp to prove the clock by"
            .to_owned(),
    })
}

/// Each stamp has to be the one before and the step, to what a stamp may be off twice over.
fn virtual_clock(dut: &mut dyn Dut, clock: Clock) -> Result<ClockProof, DutError> {
    let mut stimuli = vec![made_up()];
    stimuli.extend(STEPS_NS.into_iter().flat_map(|ns| [Stimulus::Advance { ns }, made_up()]));
    let stamps = stamps(dut, &stimuli)?;
    let (mut wanted, mut off_ns) = (stamps[0], 0);
    for (stamp, ns) in stamps[1..].iter().zip(STEPS_NS) {
        wanted += ns;
        off_ns = off_ns.max(stamp.abs_diff(wanted));
    }
    let may = clock.uncertainty_ns.saturating_mul(2).saturating_add(clock.resolution_ns.saturating_sub(1));
    Ok(ClockProof {
        finding: if off_ns > may { Finding::Contradicted } else { Finding::Proved },
        stamps: stamps.len(),
        stated_ns: clock.uncertainty_ns,
        shown_ns: off_ns,
        off_ns: if off_ns > may { off_ns } else { 0 },
        step_ns: step(stamps.iter().copied()),
        drift_ppm: None,
    })
}

/// The greatest common divisor of all steps.
fn step(stamps: impl Iterator<Item = u64>) -> u64 {
    let (mut last, mut common) = (None, 0_u64);
    for stamp in stamps {
        if let Some(last) = last {
            let (mut a, mut b) = (common, stamp.abs_diff(last));
            while b != 0 {
                (a, b) = (b, a % b);
            }
            common = a;
        }
        last = Some(stamp);
    }
    common
}

/// How much faster the clock of the DUT runs than ours: the tightest bounds any trip of the first half gives with any of the
/// second.
fn drift(trips: &[Trip]) -> Option<(i64, i64)> {
    let (first, second) = trips.split_at(trips.len() / 2);
    let ppm = |theirs: i128, ours: i128| i64::try_from((theirs - ours) * 1_000_000 / ours.max(1)).ok();
    let mut bounds: Option<(i64, i64)> = None;
    for (a, b) in first.iter().flat_map(|a| second.iter().map(move |b| (a, b))) {
        let theirs = i128::from(b.stamp) - i128::from(a.stamp);
        let longest = i128::from(b.received) - i128::from(a.sent);
        let shortest = i128::from(b.sent) - i128::from(a.received);
        let (low, high) = (ppm(theirs, longest)?, ppm(theirs, shortest)?);
        bounds = Some(bounds.map_or((low, high), |(l, h)| (l.max(low), h.min(high))));
    }
    // What jitters more than it drifts leaves bounds that cross.
    bounds.map(|(low, high)| (low.min(high), low.max(high)))
}
