//! `fsct report`: reports from a record, at any later time, on any machine.

use super::{USAGE, fail, print};
use std::path::PathBuf;

/// Arguments of `fsct report`.
#[derive(clap::Args, Debug)]
pub struct Args {
    /// Folder with run.jsonl
    folder: PathBuf,
}

/// Runs the command; the result is the exit code of the run that was recorded.
pub fn run(args: &Args) -> u8 {
    match fsct_reports::render(&args.folder) {
        Ok(summary) => {
            print(format!("{} cases; report: {}", summary.cases, args.folder.join("report.html").display()));
            summary.exit_code()
        }
        Err(error) => fail(USAGE, error),
    }
}
