//! The always-on oracle: beside a case's own expectations every exchange is compared with the tables of the standard.
//!
//! It keeps the *set* of configurations a conformant DUT may be in: races within the uncertainty of time stamps, answers that
//! take some exchanges to appear, readings that a tolerance allows. An exchange that no configuration explains is a
//! mismatch, told against the configuration that came closest.

mod config;
mod device;
mod explain;
mod setup;
mod tolerance;

pub use device::DeviceOracle;
pub use explain::Mismatch;
pub use setup::{App, Setup};
pub use tolerance::{Mask, Stance, Tolerance, Tolerances};
