//! How long a DUT takes to answer: round trips measured, and what they say about the times of stimuli.

use crate::{Dut, DutError, Observation, Seen, Stimulus};
use std::fmt;
use std::time::{Duration, Instant};

/// A kind of stimulus nobody knows. It makes no DUT do anything, so it may be sent at any time and again.
pub const MADE_UP: u8 = 0xEE;

/// How long round trips to a DUT took, from the request to its whole answer, this program's own share included.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Latency {
    /// The shortest.
    pub min: Duration,
    /// Half of them took no longer.
    pub median: Duration,
    /// 99 of 100 took no longer; of fewer than 100 this is the longest.
    pub p99: Duration,
    /// The longest.
    pub max: Duration,
}

impl Latency {
    /// Sends a made-up stimulus so many times, at least once, each when the one before has been answered. The DUT has
    /// said hello before.
    ///
    /// # Errors
    /// [`DutError`] of the first round trip that fails, and [`DutError::Contract`] when the answer is anything but
    /// `unsupported`.
    pub fn measure(dut: &mut dyn Dut, times: usize) -> Result<Latency, DutError> {
        let mut observed = Vec::new();
        let mut trips = Vec::with_capacity(times.max(1));
        for _ in 0..times.max(1) {
            observed.clear();
            let begin = Instant::now();
            dut.apply(&[Stimulus::Other { kind: MADE_UP, octets: vec![0x5A] }], &mut observed)?;
            trips.push(begin.elapsed());
            if !matches!(observed.as_slice(), [Observation { seen: Seen::Unsupported, .. }]) {
                let what = "a made-up stimulus was not answered `unsupported`, so its round trip means nothing";
                return Err(DutError::Contract { what: what.to_owned() });
            }
        }
        Ok(Latency::of(trips).unwrap_or_default())
    }

    /// Of round trips measured elsewhere; `None` of none.
    pub fn of(mut trips: Vec<Duration>) -> Option<Latency> {
        trips.sort_unstable();
        // The smallest of them that this part of all does not exceed.
        let rank = |percent: usize| trips.get((trips.len() * percent).div_ceil(100).saturating_sub(1)).copied();
        Some(Latency { min: *trips.first()?, median: rank(50)?, p99: rank(99)?, max: *trips.last()? })
    }

    /// How far the time at which a stimulus reaches the DUT is off, either way, when all that is known is when it was
    /// sent.
    ///
    /// What every round trip takes shifts all stimuli alike and cancels out between two of them; what is left is how
    /// much the way there varies. The round trips do not say which of both ways varied, so it may have been that one
    /// alone: all of `max - min`, half of it on either side of the middle. The longest counts and not a percentile,
    /// for what happens once in a measurement happens many times in a run.
    pub fn uncertainty(&self) -> Duration {
        self.max.saturating_sub(self.min) / 2
    }
}

impl Default for Latency {
    /// A DUT that answers at once.
    fn default() -> Latency {
        Latency { min: Duration::ZERO, median: Duration::ZERO, p99: Duration::ZERO, max: Duration::ZERO }
    }
}

impl fmt::Display for Latency {
    /// `median 1.2ms, 0.9ms to 3.4ms`, in microseconds below a millisecond.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "median {:.1?}, {:.1?} to {:.1?}", self.median, self.min, self.max)
    }
}
