//! What the standard says of its two codes, and the assumptions it says it under (11.4.7, Table 41, Annex D).

use crate::code::{CRC_16, CRC_32, Code};
use crate::proper::Properness;
use crate::weights::Weights;

/// Steps in which the worst bit error probability is looked for.
const STEPS: u32 = 200;

/// The bit error probability to reckon with (11.4.7).
pub const BIT_ERROR: f64 = 1e-2;
/// SPDUs an hour, at most: 1000 a second (11.4.7).
pub const PER_HOUR: f64 = 1000.0 * 3600.0;
/// Hours in which one detected error is permitted (11.4.7; PFH-Monitor time, Table 41, the same for both modes).
pub const MONITOR_HOURS: f64 = 10.0;
/// Transfers of the FSP parameters an hour: one a day (11.5.6.2).
pub const BLOCKS_PER_HOUR: f64 = 1.0 / 24.0;
/// Residual errors an hour that a logical connection may have: 1 % of the 1E-7 of SIL 3 (11.4.7).
pub const SHARE: f64 = 1e-9;

/// What Annex D states of a code.
#[derive(Copy, Clone, Debug, PartialEq)]
pub struct Claim {
    /// Hamming distance of words of up to so many bits (Table D.1).
    pub distance: (u32, usize),
    /// Bound on Rp for words of up to so many octets and bit error probabilities up to [`BIT_ERROR`] (D.2).
    pub residual: (usize, f64),
    /// Proper up to so many octets (Table D.1).
    pub proper: usize,
}

/// A statement of the standard beside what was computed.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// Stated and true.
    Holds,
    /// Stated and not true.
    Broken,
    /// Not stated of this length, and true.
    Within,
    /// Not stated of this length, and not true.
    Beyond,
    /// Not told within bounded time.
    Undecided,
}

impl Verdict {
    const fn of(stated: bool, is_true: bool) -> Verdict {
        match (stated, is_true) {
            (true, true) => Verdict::Holds,
            (true, false) => Verdict::Broken,
            (false, true) => Verdict::Within,
            (false, false) => Verdict::Beyond,
        }
    }

    /// In a few words.
    pub const fn name(self) -> &'static str {
        match self {
            Verdict::Holds => "holds",
            Verdict::Broken => "stated, but false",
            Verdict::Within => "true, not stated",
            Verdict::Beyond => "not stated, not so",
            Verdict::Undecided => "not decided",
        }
    }
}

impl Code {
    /// What the standard states of this code; `None` of one that is not its own.
    ///
    /// The exponents of D.2 are lost in the scans: -9 and -10 are read, which both hold.
    pub fn claim(self) -> Option<Claim> {
        match self {
            CRC_16 => Some(Claim { distance: (128, 6), residual: (7, 0.9e-9), proper: 7 }),
            CRC_32 => Some(Claim { distance: (32_768, 6), residual: (26, 0.5e-10), proper: 128 }),
            _ => None,
        }
    }
}

impl Claim {
    /// The Hamming distance.
    pub fn of_distance(self, weights: &Weights) -> Verdict {
        let (bits, distance) = self.distance;
        Verdict::of(weights.bits() <= bits, weights.distance().0 >= distance)
    }

    /// The bound on Rp.
    pub fn of_residual(self, weights: &Weights) -> Verdict {
        let (octets, bound) = self.residual;
        Verdict::of(weights.octets() <= octets, weights.worst(|p| weights.residual(p)) < bound)
    }

    /// Properness.
    pub fn of_properness(self, octets: usize, properness: Properness) -> Verdict {
        match properness {
            Properness::Undecided => Verdict::Undecided,
            _ => Verdict::of(octets <= self.proper, properness == Properness::Proper),
        }
    }
}

impl Weights {
    /// Undetected errors an hour if 1000 SPDU/s met the worst p up to [`BIT_ERROR`] and the safety function went on in spite of the
    /// errors that are detected. It does not, see [`Weights::monitored_rate`].
    pub fn unmonitored_rate(&self) -> f64 {
        self.worst(|p| self.residual(p)) * PER_HOUR
    }

    /// Undetected errors an hour when one detected error is permitted in [`MONITOR_HOURS`], at the worst p up to [`BIT_ERROR`]: for
    /// each detected error there are `Rp / detected` undetected ones, whatever the rate of SPDUs is.
    pub fn monitored_rate(&self) -> f64 {
        self.worst(|p| self.residual(p) / self.detected(p)) / MONITOR_HOURS
    }

    /// Undetected errors an hour of a parameter block, at [`BLOCKS_PER_HOUR`] and the worst p up to [`BIT_ERROR`].
    pub fn block_rate(&self) -> f64 {
        self.worst(|p| self.residual(p)) * BLOCKS_PER_HOUR
    }

    /// The largest value up to [`BIT_ERROR`]: that at [`BIT_ERROR`] for all SPDUs, an earlier one for long words with few bits of
    /// signature.
    fn worst(&self, of: impl Fn(f64) -> f64) -> f64 {
        (1..=STEPS).map(|step| of(BIT_ERROR * f64::from(step) / f64::from(STEPS))).fold(0.0, f64::max)
    }
}
