//! The `fsct` command.

use std::process::ExitCode;

fn main() -> ExitCode {
    fsct_harness::cli::main()
}
