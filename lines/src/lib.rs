//! Lines of a port over time: L+ (pin 1), C/Q (pin 4), I/Q (pin 2).
//!
//! A [`Recording`] gives [`Edge`]s in the order of time, whether it is a file of a logic analyser or a DUT that tells them
//! live; nothing here keeps them, so a recording may be longer than memory.

pub mod capture;
mod edge;
mod filter;
mod vcd_writer;

pub use edge::{Edge, Levels, Recording, RecordingError};
pub use filter::Filter;
pub use vcd_writer::VcdWriter;
