//! `fsct tours`: writes the cases of a role's tours to stdout, as `testcases/suites` holds them.

use super::{Cases, USAGE, fail};
use crate::tours::emit;
use std::io::Write as _;

/// Name of the command.
pub const NAME: &str = "tours";

/// Arguments of `fsct tours`.
#[derive(clap::Args, Debug)]
pub struct Args {
    /// device or master
    role: String,
    #[command(flatten)]
    cases: Cases,
}

/// Runs the command; the result is the exit code.
pub fn run(args: &Args) -> u8 {
    let library = match args.cases.load() {
        Ok(library) => library,
        Err(code) => return code,
    };
    match library.coverage.get(&args.role) {
        Some(coverage) => {
            let _ = std::io::stdout().write_all(emit(coverage).as_bytes());
            0
        }
        None => fail(USAGE, format!("there are no goals for a `{}`; device and master are known", args.role)),
    }
}
