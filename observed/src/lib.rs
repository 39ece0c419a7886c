//! Both machines of the SCL (11.5.2, 11.5.3) as they look from outside.
//!
//! A tester does one thing after another to a machine, each told by what it saw last ("the next counter", "a counter that mirrors
//! nothing"), and sees what comes back on the link and application PCOs. What the rows of `fsct_protocol::scl` do under these inputs
//! is a [`Mealy`] machine with few states; two that cannot be told apart are one.

mod absolute;
mod compare;
pub mod device;
pub mod identify;
pub mod learn;
pub mod master;
mod mealy;
pub mod seen;
pub mod suite;

pub use absolute::{Absolute, Counted};
pub use compare::{Difference, compared};
pub use mealy::{Edge, Mealy};
pub use seen::{Seen, Shown, Side};

use std::fmt::Debug;
use std::hash::Hash;

/// A machine with the tester in front of it, in a waiting state.
pub trait Subject: Copy + Eq + Hash {
    /// What the tester can do.
    type Input: Copy + Eq + Debug + 'static;
    /// What it sees of it.
    type Output: Copy + Eq + Hash + Debug;

    /// Everything the tester can do, each by its name.
    const INPUTS: &'static [(&'static str, Self::Input)];

    /// Does it and sees what comes of it, until the machine waits again.
    fn apply(&mut self, input: Self::Input) -> Self::Output;
}

/// Everything a machine can do from here on, states that look alike merged. State 0 is the start.
pub fn observed<S: Subject>(start: S) -> Mealy<S::Output> {
    Mealy::explored(start, S::INPUTS.len(), |subject: &S, input| {
        let mut next = *subject;
        let output = next.apply(S::INPUTS[input].1);
        (output, next)
    })
    .minimal()
}
