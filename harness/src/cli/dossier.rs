//! `fsct dossier`: what records of one product have to show an assessor, as one page to be printed.

use super::{Cases, RIG, Side, USAGE, fail, print};
use crate::dossier::tool;
use fsct_reports::dossier::{Dossier, read, render};
use std::path::PathBuf;

/// Arguments of `fsct dossier`.
#[derive(clap::Args, Debug)]
#[command(
    after_help = "In a folder are looked for: run.jsonl, campaign.json, gauntlet.json, prove.json, residual.json. Exit codes: 0 the dossier is \
                  written, whatever the records say; 2 usage, or a record that is missing, damaged or about another product; 3 it cannot be written"
)]
pub struct Args {
    /// Folders and files that fsct has written
    #[arg(value_name = "RUN", required = true)]
    records: Vec<PathBuf>,
    /// The side the dossier is about, where records hold both: device or master
    #[arg(long, value_name = "ROLE")]
    role: Option<Side>,
    /// Printed as the date, as it is given: no record holds one
    #[arg(long, value_name = "TEXT")]
    date: Option<String>,
    /// The page
    #[arg(long, value_name = "FILE", default_value = "fsct-dossier.html")]
    out: PathBuf,
    #[command(flatten)]
    cases: Cases,
}

/// Runs the command; the result is the exit code.
pub fn run(args: &Args) -> u8 {
    execute(args).unwrap_or_else(|code| code)
}

fn execute(args: &Args) -> Result<u8, u8> {
    let sources = read(&args.records).map_err(|error| fail(USAGE, error))?;
    let library = args.cases.load()?;
    let tool = tool(&library);
    let role = args.role.map(|side| side.role().to_string());
    let dossier = Dossier::assemble(&tool, sources, role.as_deref(), args.date.clone());
    let dossier = dossier.map_err(|error| fail(USAGE, error))?;
    let out = args.out.display();
    std::fs::write(&args.out, render(&dossier))
        .map_err(|error| fail(RIG, format!("{out} cannot be written: {error}")))?;
    print(fsct_reports::visible(&dossier.told()));
    print(format!(
        "dossier: {out}; to print it: chromium --headless --no-pdf-header-footer --print-to-pdf=FILE.pdf {out}"
    ));
    Ok(0)
}
