//! `fsct list`: the cases there are.

use super::{Cases, print, show};
use crate::library::EVERYTHING;
use crate::plan::{Selection, plan, unreached};
use crate::profile::default_profile;
use fsct_adapters::Role;

/// Arguments of `fsct list`.
#[derive(clap::Args, Debug)]
pub struct Args {
    /// Only cases that match, as for `fsct run`
    #[arg(long, value_name = "EXPR")]
    filter: Vec<String>,
    /// Every point of every sweep
    #[arg(long)]
    expanded: bool,
    /// How deep, as for `fsct run`
    #[arg(long, value_name = "N", default_value_t = 2, value_parser = clap::value_parser!(u8).range(0..=2))]
    depth: u8,
    #[command(flatten)]
    cases: Cases,
}

/// Runs the command; the result is the exit code.
pub fn run(args: &Args) -> u8 {
    let library = match args.cases.load() {
        Ok(library) => library,
        Err(code) => return code,
    };
    let selection = Selection { filter: args.filter.clone(), depth: args.depth, ..Selection::default() };
    let mut planned = Vec::new();
    for role in [Role::Device, Role::Master] {
        let Some(profile) = library.profiles.get(&default_profile(role)) else {
            return super::fail(super::USAGE, format!("the cases come without a profile for a {role}"));
        };
        match plan(&library, &selection, profile, &unreached(role)) {
            Ok(plan) => planned.extend(plan.cases),
            Err(problem) => return show(&[problem]),
        }
    }
    if args.expanded {
        planned.iter().for_each(|one| print(format!("{}  {}", one.key, one.case.title)));
    } else {
        for case in library.cases() {
            let selected = planned.iter().filter(|one| one.case.id == case.id).count();
            if selected > 0 {
                let points = case.expand(&EVERYTHING).map_or(0, |all| all.points.len());
                let depth = if case.depth > 1 { format!(" (--depth {})", case.depth) } else { String::new() };
                print(format!("{}  {points:>4} x  {:<20} {}{depth}", case.id, case.suite, case.title));
            }
        }
    }
    if planned.is_empty() { super::fail(super::NOTHING_RAN, "no case matches") } else { 0 }
}
