//! `fsct vectors`: the known answers, proven.

use super::{RIG, fail, print};

/// Arguments of `fsct vectors`.
#[derive(clap::Args, Debug)]
pub struct Args {}

/// Runs the command; the result is the exit code.
pub fn run(_: &Args) -> u8 {
    match fsct_vectors::load() {
        Ok(vectors) => {
            let score = fsct_vectors::prove(&vectors);
            print(&score);
            if score.is_proven() { 0 } else { 1 }
        }
        Err(error) => fail(RIG, error),
    }
}
