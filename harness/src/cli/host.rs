//! `fsct host-library`: the process that loads a library for `lib:` and serves it on standard input and output.

use super::{RIG, fail};
use fsct_adapters::{Description, Dut, DutError, Library, Observation, Stimulus, frames_apart, serve_stream};
use std::path::PathBuf;

/// Name of the command; nobody has to type it.
pub const NAME: &str = "host-library";

/// Arguments of `fsct host-library`.
#[derive(clap::Args, Debug)]
pub struct Args {
    /// The library
    path: PathBuf,
}

/// Runs the command; the result is the exit code.
pub fn run(args: &Args) -> u8 {
    let (reader, writer) = match frames_apart() {
        Ok(streams) => streams,
        Err(error) => return fail(RIG, error),
    };
    let dut: Box<dyn Dut> = match Library::load(&args.path) {
        Ok(library) => Box::new(library),
        Err(error) => Box::new(Unusable(error)),
    };
    match serve_stream(reader, writer, dut) {
        Ok(()) => 0,
        Err(error) => fail(RIG, error),
    }
}

/// Stands for a library that is none, so that whoever asks it is told why.
struct Unusable(DutError);

impl Dut for Unusable {
    fn hello(&mut self) -> Result<Description, DutError> {
        Err(self.0.clone())
    }

    fn apply(&mut self, _: &[Stimulus], _: &mut Vec<Observation>) -> Result<(), DutError> {
        Err(self.0.clone())
    }
}
