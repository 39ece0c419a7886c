//! The reference FS-Device and the reference FS-Master, their mutants, and three of each that only look like one.
//!
//! Written by hand from Tables 38 and 40, clauses 7 to 11 and Annex A of the standard. It shares with the harness that judges it the octet
//! codecs of `fsct-protocol` and nothing else, so that a wrong reading of the tables shows as a disagreement.

mod catalogue;
mod dead;
mod device;
mod gateway;
mod lines;
mod master;
mod mutant;
mod options;
pub mod parameters;
pub mod scl;
mod storage;
mod technology;

pub use dead::{ConstantDevice, EchoDevice, NullDevice};
pub use device::FsDevice;
pub use gateway::{Gateway, GatewayMutant, GatewayOptions};
pub use master::{ConstantMaster, EchoMaster, FsMaster, MasterMutant, MasterOptions, NullMaster};
pub use mutant::Mutant;
pub use options::{OptionError, Options};
