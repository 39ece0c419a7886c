//! A machine whose counters are looked at as numbers, not only as "the next" or "the mirrored one".

use crate::Subject;
use std::fmt::Debug;
use std::hash::Hash;

/// A machine that shows a counter.
pub trait Counted: Subject<Output = Option<Self::Seen>> {
    /// What is seen beside the counter.
    type Seen: Copy + Eq + Hash + Debug;

    /// MCount or DCount_i of the SPDU that stands.
    fn counter(&self) -> u8;
}

/// The same machine; with what comes back its counter is seen, 0 to 7.
#[derive(Copy, Clone, Debug, PartialEq, Eq, Hash)]
pub struct Absolute<S>(pub S);

impl<S: Counted> Subject for Absolute<S> {
    type Input = S::Input;
    type Output = Option<(u8, S::Seen)>;

    const INPUTS: &'static [(&'static str, S::Input)] = S::INPUTS;

    fn apply(&mut self, input: S::Input) -> Self::Output {
        let seen = self.0.apply(input)?;
        Some((self.0.counter(), seen))
    }
}
