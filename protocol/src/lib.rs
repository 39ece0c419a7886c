//! IO-Link Safety (SDCI-FS) as code: editions, signatures, SPDUs, FSP records and the two SCL machines as rows of data.
//!
//! No I/O, no clock, no allocation; no function here panics on any octets.
#![no_std]

pub mod crc;
mod edition;
pub mod fsp;
pub mod io;
pub mod scl;
pub mod smi;
pub mod spdu;

pub use edition::{Edition, ProtMode, UnknownName};
