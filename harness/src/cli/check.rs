//! `fsct check`: is everything sound, without a DUT.

use super::{Cases, print, show};
use crate::ledger::Class;
use crate::library::{EVERYTHING, Library};
use fsct_adapters::Role;
use std::collections::BTreeMap;
use std::path::PathBuf;

/// Arguments of `fsct check`.
#[derive(clap::Args, Debug)]
pub struct Args {
    /// Files of cases to check against the rest; none: everything
    #[arg(value_name = "FILE")]
    files: Vec<PathBuf>,
    #[command(flatten)]
    cases: Cases,
}

/// Runs the command; the result is the exit code.
pub fn run(args: &Args) -> u8 {
    let mut library = match args.cases.load() {
        Ok(library) => library,
        Err(code) => return code,
    };
    let mut problems = Vec::new();
    for file in &args.files {
        if let Err(found) = library.add_suite(file) {
            problems.extend(found);
        }
    }
    if problems.is_empty() {
        problems = library.check();
    }
    if !args.files.is_empty() {
        // What the files do to the ledger of the whole is not their fault.
        let names: Vec<String> = args.files.iter().map(|file| file.display().to_string()).collect();
        problems.retain(|problem| names.iter().any(|name| problem.place().starts_with(name)));
    }
    if !problems.is_empty() {
        return show(&problems);
    }
    let cases = library.cases().count();
    // Sequences of complete suites are made, not written.
    let written = library.cases().filter(|case| case.complete.is_none());
    let points: usize = written.map(|case| case.expand(&EVERYTHING).map_or(0, |all| all.points.len())).sum();
    print(format!("{cases} cases, {points} points of their sweeps, {} start conditions: sound", library.starts.len()));
    print(format!("{} limits: sound", library.limits.limits.iter().count()));
    let records = library.ledger.iter().count();
    let classes: Vec<String> = Class::ALL
        .iter()
        .map(|(class, name)| {
            format!("{} {name}", library.ledger.iter().filter(|record| record.class == *class).count())
        })
        .collect();
    print(format!("{records} requirements: {}", classes.join(", ")));
    for file in open(&library) {
        print(file);
    }
    let judged = |id: &str, role| {
        library.cases().any(|case| case.role == role && case.requirements.iter().any(|requirement| requirement == id))
    };
    let both = || library.ledger.iter().filter(|record| record.dut == "both" && record.class == Class::Tested);
    let only = |role, other| both().filter(|record| judged(&record.id, role) && !judged(&record.id, other)).count();
    print(format!(
        "{} of those tested concern both roles; {} are judged on an FS-Device alone, {} on an FS-Master alone",
        both().count(),
        only(Role::Device, Role::Master),
        only(Role::Master, Role::Device)
    ));
    0
}

/// What nothing is done about yet, one line a file of the ledger.
fn open(library: &Library) -> Vec<String> {
    let mut files: BTreeMap<&str, Vec<&str>> = BTreeMap::new();
    for record in library.ledger.iter().filter(|record| record.class == Class::Open) {
        let file = record.place.rsplit_once(':').map_or(record.place.as_str(), |(file, _)| file);
        files.entry(file).or_default().push(&record.id);
    }
    files.into_iter().map(|(file, ids)| format!("open in {file}: {}", ids.join(" "))).collect()
}
