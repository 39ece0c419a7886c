//! A measured value against its limits: pass and fail only where the uncertainty cannot turn the one into the other.

/// Limits, both inclusive, in nanoseconds or, for a ratio, in parts of 1e9.
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq)]
pub struct Bounds {
    /// The smallest value permitted.
    pub min: Option<u64>,
    /// The largest value permitted.
    pub max: Option<u64>,
}

/// What a measurement says about its limits.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// Inside, whatever the error of measurement.
    Pass,
    /// Outside, whatever the error of measurement.
    Fail,
    /// One or the other: the value lies in the guard band, is not known well enough, or there is no limit.
    Inconclusive,
}

/// A verdict with its distance to the limits.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Judged {
    /// The verdict.
    pub verdict: Verdict,
    /// Distance to the nearest limit without the uncertainty, in the unit of the value: negative outside; `None` without limit.
    pub margin: Option<i64>,
}

/// Judges a value that lies in `low..=high`, each end known to `uncertainty` either way; equal ends for a plain value.
///
/// A value on the limit passes when it is exact. `high` may be [`u64::MAX`]: at least `low`.
pub fn judge(low: u64, high: u64, uncertainty: u64, bounds: Bounds) -> Judged {
    let (low, high) = (low.min(high), low.max(high));
    let (least, most) = (low.saturating_sub(uncertainty), high.saturating_add(uncertainty));
    let below = bounds.min.is_some_and(|min| high.saturating_add(uncertainty) < min);
    let above = bounds.max.is_some_and(|max| low.saturating_sub(uncertainty) > max);
    let inside = bounds.min.is_none_or(|min| least >= min) && bounds.max.is_none_or(|max| most <= max);
    let verdict = match (below || above, inside) {
        (true, _) => Verdict::Fail,
        (false, true) if bounds != Bounds::default() => Verdict::Pass,
        _ => Verdict::Inconclusive,
    };
    // What is certain counts: the end that is the nearer one to a limit it is beyond of, else the worse one.
    let over_min = bounds.min.map(|min| signed(if below { high } else { low }, min));
    let under_max = bounds.max.map(|max| signed(max, if above { low } else { high }));
    Judged { verdict, margin: over_min.into_iter().chain(under_max).min() }
}

/// Judges an event that was not there at `low` and was there at `high`, by looks that are `apart`: what the looks cannot
/// tell does not count against it. Fails like [`judge`]; passes when both ends lie within one distance of the limits.
pub fn judge_looks(low: u64, high: u64, uncertainty: u64, apart: u64, bounds: Bounds) -> Judged {
    let strict = judge(low, high, uncertainty, bounds);
    if strict.verdict != Verdict::Inconclusive {
        return strict;
    }
    let wide = Bounds {
        min: bounds.min.map(|min| min.saturating_sub(apart)),
        max: bounds.max.map(|max| max.saturating_add(apart)),
    };
    Judged { verdict: judge(low, high, uncertainty, wide).verdict, margin: strict.margin }
}

fn signed(a: u64, b: u64) -> i64 {
    i64::try_from(i128::from(a) - i128::from(b)).unwrap_or(if a > b { i64::MAX } else { i64::MIN })
}
