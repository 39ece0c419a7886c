//! Rp over the bit error probability.

use crate::weights::Weights;
use num_bigint::BigUint;

/// What rounding may add to Rp, as a part of it.
const ROUNDING: f64 = 1e-12;
/// Steps in which the maximum of Rp is looked for, and halvings that make it exact.
const STEPS: u32 = 1000;
const HALVINGS: u32 = 60;

/// Where Rp lies above 2^-width, which a proper code never does.
#[derive(Copy, Clone, Debug, PartialEq)]
pub struct Hump {
    /// Bit error probability of the highest Rp.
    pub at: f64,
    /// Rp there.
    pub highest: f64,
    /// The least bit error probability from which on Rp is above 2^-width.
    pub from: f64,
}

impl Weights {
    /// Rp: the probability that errors, each bit wrong with the probability `p`, turn a word into another one that is accepted.
    ///
    /// A sum of positive terms: some 12 digits at least. NaN outside of 0 to 1.
    pub fn residual(&self, p: f64) -> f64 {
        if !(0.0..=1.0).contains(&p) {
            return f64::NAN;
        }
        let (bits, right) = (self.bits() as i32, 1.0 - p);
        let words = (0..).zip(self.code_weights()).skip(1);
        // In this order, the large count first, no product leaves the range of f64 that counts in the sum.
        words.map(|(ones, words)| float(words) * p.powi(ones) * right.powi(bits - ones)).sum()
    }

    /// The probability that errors are seen: something is wrong, and it is not accepted.
    pub fn detected(&self, p: f64) -> f64 {
        // 1 - (1-p)^N without the loss of digits for small p.
        -(f64::from(self.bits()) * (-p).ln_1p()).exp_m1() - self.residual(p)
    }

    /// 2^-width, which Annex D takes for the limit of Rp.
    pub fn limit(&self) -> f64 {
        (-f64::from(self.code().width())).exp2()
    }

    /// Where Rp is above 2^-width for p up to 0.5, looked for in steps of 0.0005; `None` when it is not.
    pub fn hump(&self) -> Option<Hump> {
        let step = 0.5 / f64::from(STEPS);
        let value = |number: u32| self.residual(f64::from(number) * step);
        let values: Vec<f64> = (0..=STEPS).map(value).collect();
        let highest = (0..=STEPS).zip(&values).max_by(|one, other| one.1.total_cmp(other.1))?.0;
        let at = self.peak(f64::from(highest.saturating_sub(1)) * step, (f64::from(highest + 1) * step).min(0.5));
        let limit = self.limit() * (1.0 + ROUNDING);
        let highest = self.residual(at);
        if highest <= limit {
            return None;
        }
        let first = values.iter().take_while(|value| **value <= limit).count() as u32;
        let (mut low, mut high) = (f64::from(first.saturating_sub(1)) * step, (f64::from(first) * step).min(at));
        for _ in 0..HALVINGS {
            let middle = low.midpoint(high);
            if self.residual(middle) > limit { high = middle } else { low = middle }
        }
        Some(Hump { at, highest, from: high })
    }

    /// The highest place of a stretch that rises before it and falls after it.
    fn peak(&self, mut low: f64, mut high: f64) -> f64 {
        for _ in 0..HALVINGS {
            let third = (high - low) / 3.0;
            if self.residual(low + third) < self.residual(high - third) { low += third } else { high -= third }
        }
        low.midpoint(high)
    }
}

/// The nearest f64, or infinity.
fn float(count: &BigUint) -> f64 {
    // Sixty-four bits and what they are shifted by: the digits below do not reach a f64.
    let down = count.bits().saturating_sub(64);
    let high = (count >> down).iter_u64_digits().next().unwrap_or(0);
    high as f64 * (down as f64).exp2()
}
