//! The reference FS-Master, row by row as the digests have it: SCL, ports, SMI, OSSDe, mutants, the contract, and what always holds.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod bench;
mod contract;
mod mutants;
mod ossde;
mod ports;
mod properties;
mod scl;
mod smi;
