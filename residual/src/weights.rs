//! How many code words have how many ones.

use crate::code::Code;
use num_bigint::{BigInt, BigUint};

/// The exact weight distribution of a code at one length, and that of its dual.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Weights {
    code: Code,
    octets: usize,
    words: Vec<BigUint>,
    dual: Vec<BigUint>,
}

impl Weights {
    pub(crate) const fn new(code: Code, octets: usize, words: Vec<BigUint>, dual: Vec<BigUint>) -> Weights {
        Weights { code, octets, words, dual }
    }

    /// From the distribution of the dual code: `dual` holds how many of its words have 0, 1, .. 8 x `octets` ones. `None` when these are
    /// not 2^width words of that length.
    pub fn from_dual(code: Code, octets: usize, dual: Vec<u64>) -> Option<Weights> {
        let sum = dual.iter().try_fold(0u64, |sum, count| sum.checked_add(*count))?;
        if code.check(octets).is_err() || dual.len() != 8 * octets + 1 || sum != 1 << code.width() {
            return None;
        }
        let dual: Vec<BigUint> = dual.into_iter().map(BigUint::from).collect();
        let words = macwilliams(&dual, code.width());
        Some(Weights::new(code, octets, words, dual))
    }

    /// The code.
    pub const fn code(&self) -> Code {
        self.code
    }

    /// Octets of a word, signature included.
    pub const fn octets(&self) -> usize {
        self.octets
    }

    /// Bits of a word, signature included.
    pub const fn bits(&self) -> u32 {
        8 * self.octets as u32
    }

    /// A_w: code words with w ones, w = 0 to the bits of a word. 2^(bits - width) in all.
    pub fn code_weights(&self) -> &[BigUint] {
        &self.words
    }

    /// B_w: words of the dual code with w ones. 2^width in all.
    pub fn dual_weights(&self) -> &[BigUint] {
        &self.dual
    }

    /// The Hamming distance: how many bits have to be wrong, at least, for an error to stay undetected; and by how many patterns of so
    /// many bits it does.
    pub fn distance(&self) -> (usize, &BigUint) {
        const NONE: BigUint = BigUint::ZERO;
        let first = self.words.iter().enumerate().skip(1).find(|(_, count)| **count != NONE);
        // There is a word of data besides 0, so there is one.
        first.unwrap_or((0, &NONE))
    }
}

/// The weight distribution of the dual of a code (MacWilliams): `counts` of words by their ones, 2^`dimension` in all.
///
/// `B(z) = 2^-dimension * sum of A_i (1-z)^i (1+z)^(N-i)`, in integers throughout; the division leaves no remainder for the
/// distribution of a linear code.
pub fn macwilliams(counts: &[BigUint], dimension: u32) -> Vec<BigUint> {
    // Horner over i from N down: times (1 - z), plus the next count times the next power of (1 + z).
    let mut sum: Vec<BigInt> = Vec::with_capacity(counts.len());
    let mut power = vec![BigInt::from(1)];
    for count in counts.iter().rev() {
        sum.push(BigInt::ZERO);
        times(&mut sum, |above, below| *above -= below);
        let count = BigInt::from(count.clone());
        if count != BigInt::ZERO {
            sum.iter_mut().zip(&power).for_each(|(sum, binomial)| *sum += binomial * &count);
        }
        power.push(BigInt::ZERO);
        times(&mut power, |above, below| *above += below);
    }
    sum.into_iter().map(|count| (count >> dimension).magnitude().clone()).collect()
}

/// Times (1 + z) or (1 - z), in place; the highest coefficient has to be free.
fn times(polynomial: &mut [BigInt], add: impl Fn(&mut BigInt, &BigInt)) {
    for at in (1..polynomial.len()).rev() {
        let (below, above) = polynomial.split_at_mut(at);
        if let (Some(below), Some(above)) = (below.last(), above.first_mut()) {
            add(above, below);
        }
    }
}
