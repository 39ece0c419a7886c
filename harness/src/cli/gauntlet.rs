//! `fsct gauntlet`: every mutant of the reference DUTs against the suites.

use super::{Cases, RIG, Side, USAGE, fail, print, show};
use crate::gauntlet::{matrix, matrix_of};
use crate::problem::suggestion;
use fsct_adapters::Role;
use fsct_reports::gauntlet::{Gauntlet, Matrix};
use indicatif::ProgressBar;
use std::io::IsTerminal;
use std::path::PathBuf;
use std::time::Instant;

/// Exit code when a mutant survives or a case kills nothing.
const LACKING: u8 = 1;

/// Arguments of `fsct gauntlet`.
#[derive(clap::Args, Debug)]
pub struct Args {
    /// Only mutants of this role: device or master
    #[arg(long)]
    role: Option<Side>,
    /// Only cases of this suite or group; may be repeated. Without it all but the complete suites, which are worth a look by
    /// themselves: --suite complete
    #[arg(long, value_name = "NAME")]
    suite: Vec<String>,
    /// How deep, as for `fsct run`; with --suite
    #[arg(long, value_name = "N", default_value_t = 0, requires = "suite", value_parser = clap::value_parser!(u8).range(0..=2))]
    depth: u8,
    /// Print the matrix as JSON
    #[arg(long)]
    json: bool,
    /// Folder for gauntlet.json and gauntlet.html
    #[arg(long, value_name = "DIR", default_value = "fsct-out")]
    out: PathBuf,
    #[command(flatten)]
    cases: Cases,
}

/// Runs the command; the result is the exit code.
pub fn run(args: &Args) -> u8 {
    execute(args).unwrap_or_else(|code| code)
}

fn execute(args: &Args) -> Result<u8, u8> {
    let library = args.cases.load()?;
    if let Some(unknown) = args.suite.iter().find(|suite| library.names().all(|known| known != suite.as_str())) {
        let help = suggestion(unknown, library.names());
        return Err(fail(USAGE, format!("there is no suite `{unknown}`; {help}")));
    }
    let begin = Instant::now();
    let bar = if std::io::stderr().is_terminal() { ProgressBar::new_spinner() } else { ProgressBar::hidden() };
    let mut roles = Vec::new();
    for role in [Role::Device, Role::Master] {
        if args.role.is_none_or(|wanted| wanted.role() == role) {
            let done = || bar.inc(1);
            let made = match args.suite.as_slice() {
                [] => matrix(&library, role, &done),
                suites => matrix_of(&library, role, suites, args.depth, &done),
            };
            roles.push(made.map_err(|problem| show(&[problem]))?);
        }
    }
    bar.finish_and_clear();
    let gauntlet = Gauntlet::new(roles, begin.elapsed().as_secs_f64());
    gauntlet
        .write(&args.out)
        .map_err(|error| fail(RIG, format!("the matrix in {} cannot be written: {error}", args.out.display())))?;
    if args.json {
        print(gauntlet.json().trim_end());
    } else {
        gauntlet.roles.iter().for_each(if args.suite.is_empty() { tell } else { tell_killed });
        print(format!("{:.1} s · matrix: {}", gauntlet.seconds, args.out.join("gauntlet.html").display()));
    }
    Ok(if gauntlet.is_clean() { 0 } else { LACKING })
}

/// What suites kill by themselves, whatever clause they judge.
fn tell_killed(matrix: &Matrix) {
    let (killed, alive): (Vec<_>, Vec<_>) = matrix.mutants.iter().partition(|mutant| !mutant.killed_by.is_empty());
    print(format!("{}: {} of {} mutants killed", matrix.role, killed.len(), matrix.mutants.len()));
    for mutant in alive {
        print(format!("  not killed: {} ({})", mutant.name, mutant.clause));
    }
}

fn tell(matrix: &Matrix) {
    let (mutants, cases) = (matrix.mutants.len(), matrix.cases.len());
    let (survivors, idle) = (matrix.survivors().count(), matrix.idle().count());
    print(format!(
        "{}: {} of {mutants} mutants killed by a case that judges their clause, {} of {cases} cases kill",
        matrix.role,
        mutants - survivors,
        cases - idle
    ));
    for mutant in matrix.survivors() {
        let how = match (mutant.killed_by.keys().next(), mutant.oracle) {
            (Some(id), _) => format!("killed by {id}, which does not judge {}", mutant.clause),
            (None, Some(true)) => "found by the oracle alone".to_owned(),
            (None, _) => "found by nothing".to_owned(),
        };
        print(format!("  survives: {} ({}): {how}", mutant.name, mutant.clause));
    }
    for case in matrix.idle() {
        print(format!("  kills nothing: {} {}", case.id, case.title));
    }
}
