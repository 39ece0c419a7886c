//! The command line: one file per command, exit codes that never change.
//!
//! 0 conformant · 1 failures · 2 usage or invalid input · 3 rig or tool error · 4 nothing ran · 5 inconclusive only

mod bench;
mod campaign;
mod capture;
mod check;
mod crc;
mod doctor;
mod dossier;
mod explain;
mod gauntlet;
mod host;
mod iodd;
mod learn;
mod list;
mod prove;
mod report;
mod run;
mod simulate;
mod tours;
mod vectors;

use crate::library::Library;
use crate::problem::Problem;
use clap::{Parser, Subcommand};
use fsct_adapters::Role;
use fsct_reports::visible;
use std::io::{IsTerminal, Write as _};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

/// Exit code for wrong usage and invalid input.
pub const USAGE: u8 = 2;
/// Exit code for a fault of rig or tool.
pub const RIG: u8 = 3;
/// Exit code when nothing ran.
pub const NOTHING_RAN: u8 = 4;

/// Conformance tests for IO-Link Safety: judges FS-Devices and FS-Masters against the standard, case by case, with the clause and the
/// octets behind every verdict.
#[derive(Parser)]
#[command(
    name = "fsct",
    version,
    arg_required_else_help = true,
    after_help = "Exit codes: 0 conformant, 1 failures, 2 usage or invalid input, 3 rig or tool error, 4 nothing ran, 5 inconclusive"
)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Judge a DUT; without --dut the embedded reference FS-Device and FS-Master
    Run(run::Args),
    /// Reach a DUT, say what it is and which suites apply: the first command on a new bench
    Doctor(doctor::Args),
    /// Inject errors by the million: every corruption of an SPDU, or random faults; failures are shrunk to a few actions
    Campaign(campaign::Args),
    /// Judge the line cases by a recording: VCD, sigrok .sr, CSV of sigrok or Saleae Logic
    Capture(capture::Args),
    /// Judge the IODD of an FS-Device by the rules of Annex E, and say what it declares
    Iodd(iodd::Args),
    /// List the cases there are
    List(list::Args),
    /// Check cases, ledger and profiles without a DUT
    Check(check::Args),
    /// Explain a case, a requirement, a tolerance, a limit or a rule for IODDs
    Explain(explain::Args),
    /// Serve the reference FS-Device or FS-Master on a socket, a pseudo-terminal, or stdin and stdout
    Simulate(simulate::Args),
    /// Render reports from a record once more
    Report(report::Args),
    /// Put records of one product together for an assessor: one page to be printed, along Annex I.4 of v1.1
    Dossier(dossier::Args),
    /// Run every mutant of the reference DUTs against the suites: the kill matrix
    Gauntlet(gauntlet::Args),
    /// Learn the machine of a DUT as a tester sees it, and say where it is not that of the tables
    Learn(learn::Args),
    /// Explore both machines of the SCL, as the tables have them, with a black channel that does its worst
    Prove(prove::Args),
    /// Prove the known answers for the CRC signatures
    Vectors(vectors::Args),
    /// Compute the signature of octets
    Crc(crc::Args),
    /// Write the generated tours of a role: testcases/suites/ROLE-tours.yaml
    #[command(name = tours::NAME, hide = true)]
    Tours(tours::Args),
    /// Load a library and serve it: what `lib:` starts
    #[command(name = host::NAME, hide = true)]
    Host(host::Args),
}

/// A role on the command line.
#[derive(Copy, Clone, Debug, PartialEq, Eq, clap::ValueEnum)]
enum Side {
    Device,
    Master,
}

impl Side {
    const fn role(self) -> Role {
        match self {
            Side::Device => Role::Device,
            Side::Master => Role::Master,
        }
    }
}

/// Set once the user asks to stop; asked again, the process ends as usual.
fn interruption() -> Arc<AtomicBool> {
    let interrupted = Arc::new(AtomicBool::new(false));
    for signal in [signal_hook::consts::SIGINT, signal_hook::consts::SIGTERM] {
        let _ = signal_hook::flag::register_conditional_default(signal, interrupted.clone());
        let _ = signal_hook::flag::register(signal, interrupted.clone());
    }
    interrupted
}

/// Writes a file into a folder, which is made if it is not there; where it stands.
fn write(folder: &Path, name: &str, text: &str) -> Result<PathBuf, u8> {
    let path = folder.join(name);
    let written = std::fs::create_dir_all(folder).and_then(|()| std::fs::write(&path, text));
    written.map_err(|error| fail(RIG, format!("{} cannot be written: {error}", path.display())))?;
    Ok(path)
}

/// Runs the command of this process.
pub fn main() -> ExitCode {
    std::panic::set_hook(Box::new(|panic| {
        let place = panic.location().map(|place| format!(" ({}:{})", place.file(), place.line())).unwrap_or_default();
        eprintln!("fsct: a fault of fsct itself, please report it{place}");
    }));
    let cli = Cli::parse();
    let code = std::panic::catch_unwind(|| match cli.command {
        Command::Run(args) => run::run(&args),
        Command::Doctor(args) => doctor::run(&args),
        Command::Campaign(args) => campaign::run(&args),
        Command::Capture(args) => capture::run(&args),
        Command::Iodd(args) => iodd::run(&args),
        Command::List(args) => list::run(&args),
        Command::Check(args) => check::run(&args),
        Command::Explain(args) => explain::run(&args),
        Command::Simulate(args) => simulate::run(&args),
        Command::Report(args) => report::run(&args),
        Command::Dossier(args) => dossier::run(&args),
        Command::Gauntlet(args) => gauntlet::run(&args),
        Command::Learn(args) => learn::run(&args),
        Command::Prove(args) => prove::run(&args),
        Command::Vectors(args) => vectors::run(&args),
        Command::Crc(args) => crc::run(&args),
        Command::Tours(args) => tours::run(&args),
        Command::Host(args) => host::run(&args),
    });
    ExitCode::from(code.unwrap_or(RIG))
}

/// Where cases come from.
#[derive(clap::Args, Clone, Debug)]
struct Cases {
    /// Folder laid out like testcases/ [default: what the binary carries]
    #[arg(long = "cases", value_name = "DIR")]
    folder: Option<PathBuf>,
}

impl Cases {
    fn load(&self) -> Result<Library, u8> {
        let library = match &self.folder {
            Some(folder) => Library::from_folder(folder),
            None => Library::embedded(),
        };
        library.map_err(|problems| show(&problems))
    }
}

/// Shows problems on stderr; the result is the exit code for them.
fn show(problems: &[Problem]) -> u8 {
    let colour = colour(std::io::stderr().is_terminal());
    for problem in problems {
        eprintln!("{}\n", problem.render(colour));
    }
    USAGE
}

/// One sentence on stderr; the result is the exit code given.
fn fail(code: u8, sentence: impl std::fmt::Display) -> u8 {
    eprintln!("fsct: {}", visible(&sentence.to_string()));
    code
}

/// Prints to stdout; a reader that has gone is no fault.
fn print(text: impl std::fmt::Display) {
    let _ = writeln!(std::io::stdout(), "{text}");
}

/// Whether to colour, with NO_COLOR honoured.
fn colour(terminal: bool) -> bool {
    terminal && std::env::var_os("NO_COLOR").is_none_or(|value| value.is_empty())
}
