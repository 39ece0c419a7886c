//! Residual error probability of a CRC signature (11.4.7, Annex D), from its exact weight distribution.
//!
//! On a binary symmetric channel with bit error probability p, words of N bits, an error stays undetected when the corrupted bits are
//! themselves a code word: `Rp(p) = sum over w >= 1 of A_w p^w (1-p)^(N-w)`, A_w being the number of code words with w ones. They are
//! counted, not estimated: [`distributions`] enumerates the dual code, 2^width words whatever N is, for all lengths in one pass, and
//! [`macwilliams`] turns the counts into A_w with integers of any size. Rp is then a sum of positive terms, so nothing cancels; whether
//! it ever falls is decided with integers too ([`Weights::properness`]).
//!
//! A start value and the step from 0 to 1 are affine or touch one signature in 2^width, and are no part of these numbers.
//! No I/O, no clock.

mod claims;
mod code;
mod enumerate;
mod probability;
mod proper;
mod weights;

pub use claims::{BIT_ERROR, BLOCKS_PER_HOUR, Claim, MONITOR_HOURS, PER_HOUR, SHARE, Verdict};
pub use code::{CRC_16, CRC_32, Code, MOST_OCTETS, Unsuitable};
pub use enumerate::{Progress, distributions, dual_weights};
pub use probability::Hump;
pub use proper::Properness;
pub use weights::{Weights, macwilliams};
