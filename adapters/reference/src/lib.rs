//! The reference FS-Device, its mutants, and three devices that only look like one.
//!
//! Written by hand from Table 40 and Annex A of the standard. It shares with the harness that judges it the octet
//! codecs of `fsct-protocol` and nothing else, so that a wrong reading of the tables shows as a disagreement.

mod dead;
mod device;
mod mutant;
mod options;
pub mod parameters;
pub mod scl;

pub use dead::{ConstantDevice, EchoDevice, NullDevice};
pub use device::FsDevice;
pub use mutant::Mutant;
pub use options::{OptionError, Options};
