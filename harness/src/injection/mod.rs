//! Error injection by the million: every corruption of an SPDU ([`exhaustive`]) and random faults of all classes
//! ([`random`]), with the oracle on every exchange.
//!
//! What is done to a DUT is a list of [`Action`]s, each relative to what a conformant partner would send at that point. So a
//! list stays meaningful when actions are left out of it, and a failure can be shrunk ([`shrink`]) to the few that matter.

pub mod action;
pub mod bound;
pub mod corruption;
pub mod exhaustive;
pub mod finding;
pub mod noise;
pub mod random;
pub mod record;
pub mod shrink;
pub mod stage;

pub use action::{Action, Script};
pub use finding::{Finding, Halt};
pub use stage::{Ran, Tally, Target};
