//! Known answers for the CRC signatures of IO-Link Safety, and their proof.
//!
//! The answers are data: `data/crc-vectors.yaml` says of each whether a source document prints it or it was derived.
//! [`prove`] holds every one against `fsct-protocol`, through its codecs.

mod data;
mod proof;

pub use data::{
    Algorithm, Block, Crc, Direction, Expect, Fields, Hex, LoadError, Message, ParamDesc, Printed, Raw, Receive,
    Sequence, Spdu, Undetectable, Vectors, load, parse,
};
pub use proof::{Failure, Score, Section, prove};
