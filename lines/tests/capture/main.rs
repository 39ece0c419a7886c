//! Files of logic analysers, sound and bad; most are generated here, those of `sigrok-cli` by a program nobody here wrote.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod any;
mod csv;
mod filter;
mod sigrok;
mod sigrok_cli;
mod stream;
mod tools;
mod vcd;
mod vcd_writer;
