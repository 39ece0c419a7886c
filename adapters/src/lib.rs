//! The contract with a device under test and every way to reach one.
//!
//! This crate moves octets. It knows frames, processes and sockets; it does not know what an SPDU is.

mod contract;
mod error;

pub use contract::{
    Clock, ClockKind, Description, Dut, Observation, Octets, Offer, Pco, Role, Seen, Service, Stimulus, Variant,
};
pub use error::{DutError, Fault};
