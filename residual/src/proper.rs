//! Does Rp ever fall? Decided with integers.

use crate::weights::Weights;
use num_bigint::{BigInt, Sign};
use std::ops::AddAssign;

/// Pieces of the axis looked at before nothing is said.
const PIECES: usize = 400;

/// Whether Rp never falls for p from 0 to 0.5: what "proper" means of a code.
#[derive(Copy, Clone, Debug, PartialEq)]
pub enum Properness {
    /// It never does.
    Proper,
    /// It falls, at this bit error probability for one.
    Falls(f64),
    /// Too fine to be told within bounded time.
    Undecided,
}

impl Weights {
    /// Is the code proper at this length?
    ///
    /// With u = p / (1-p), from 0 to 1, the derivative of Rp has the sign of a polynomial with the integer coefficients
    /// `(j+1) A_(j+1) - (N-j) A_j`. On a piece of the axis it is not negative when none of its coefficients there is (Bernstein); else
    /// its value in the middle may be negative, and else the halves are looked at.
    pub fn properness(&self) -> Properness {
        let bits = self.bits() as usize;
        // The word 0 is no error.
        let word = |ones: usize| match (ones, self.code_weights().get(ones)) {
            (1.., Some(count)) => BigInt::from(count.clone()),
            _ => BigInt::ZERO,
        };
        let slope = (0..bits).map(|ones| word(ones + 1) * (ones + 1) - word(ones) * (bits - ones)).collect();
        // From u of 0 to 1 to the parameter of a piece, which runs from 0 to infinity.
        let mut whole: Vec<BigInt> = slope;
        whole.reverse();
        shift(&mut whole);
        whole.reverse();
        // Beginning of the piece and its width.
        let mut pieces = vec![(0.0, 1.0, whole)];
        for _ in 0..PIECES {
            let Some((begin, width, here)) = pieces.pop() else { return Properness::Proper };
            if here.iter().all(|coefficient| coefficient.sign() != Sign::Minus) {
                continue;
            }
            let middle = begin + width / 2.0;
            if here.iter().sum::<BigInt>().sign() == Sign::Minus {
                return Properness::Falls(middle / (1.0 + middle));
            }
            let (left, right) = halves(here);
            pieces.push((middle, width / 2.0, right));
            pieces.push((begin, width / 2.0, left));
        }
        Properness::Undecided
    }
}

/// The polynomial on both halves of its piece: `t = 2s + 1` on the right one, and the same from the other end on the left one.
fn halves(mut here: Vec<BigInt>) -> (Vec<BigInt>, Vec<BigInt>) {
    let mut other = here.clone();
    other.reverse();
    let half = |polynomial: &mut Vec<BigInt>| {
        shift(polynomial);
        (0usize..).zip(polynomial.iter_mut()).for_each(|(power, coefficient)| *coefficient <<= power);
    };
    half(&mut here);
    half(&mut other);
    other.reverse();
    (other, here)
}

/// The polynomial of x + 1 instead of x.
fn shift(polynomial: &mut [BigInt]) {
    for from in 0..polynomial.len() {
        for at in (from..polynomial.len().saturating_sub(1)).rev() {
            let (low, high) = polynomial.split_at_mut(at + 1);
            if let (Some(low), Some(high)) = (low.last_mut(), high.first()) {
                low.add_assign(high);
            }
        }
    }
}
