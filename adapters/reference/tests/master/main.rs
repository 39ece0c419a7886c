//! The reference FS-Master: charts and transitions, ports, SMI, OSSDe, mutants, and that nothing makes it fail.

mod bench;
mod ossde;
mod ports;
mod properties;
mod scl;
mod smi;
