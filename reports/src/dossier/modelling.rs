//! The tables as a model beside the product: which transitions, sequences and conditions were seen.

use super::page::{cite_all, number};
use super::{Dossier, Gap, Kind, Section};
use crate::asked_html;
use crate::coverage::Coverage;
use crate::coverage_html;
use crate::decode::Side;
use crate::machine::Machine;
use crate::text::short;
use maud::{Markup, html};

/// Characters of a name.
const NAME: usize = 120;
/// Names listed.
const LISTED: usize = 40;
/// The command that leads a product through everything that can be walked.
const TOURS: &str = "fsct run --dut URL --out DIR";

pub fn section(dossier: &Dossier<'_>) -> Section {
    let side = Side::of(&dossier.product.role);
    let machines = Machine::ALL.into_iter().filter(|machine| machine.side() == side);
    let mut gaps = Vec::new();
    let parts: Vec<Markup> = machines.map(|machine| machine_of(machine, dossier, &mut gaps)).collect();
    let body = html! {
        p {
            "The rows of the tables of the standard are a model that runs beside the product: in every exchange the oracle compares what "
            "the product presents with every configuration the tables allow, and follows which transitions it took. "
            "Records: " (cite_all(dossier.runs()))
        }
        @for part in parts { (part) }
        (crate::complete::claims(&dossier.summary))
    };
    Section { body, gaps }
}

fn machine_of(machine: Machine, dossier: &Dossier<'_>, gaps: &mut Vec<Gap>) -> Markup {
    let taken = &dossier.summary.transitions;
    let count = |name: &String| taken.get(name).copied();
    let names = machine.transitions();
    let never: Vec<&str> = names.iter().filter(|name| count(name).unwrap_or(0) == 0).map(String::as_str).collect();
    if !never.is_empty() {
        let what = format!(
            "{} of {} transitions of the {} were never taken: {}",
            never.len(),
            names.len(),
            machine.title(),
            never.join(", ")
        );
        gaps.push(Gap::closed_by(Kind::NotRun, what, TOURS));
    }
    let reached = dossier.summary.coverage.iter().find(|one| machine.walks(&one.role));
    html! {
        h3 { (machine.title()) ": " (names.len() - never.len()) " of " (names.len()) " transitions taken" }
        table.counts {
            thead { tr { th scope="col" { "Transition" } @for name in &names { th.number scope="col" { (name.trim_start_matches("OSSDe ")) } } } }
            tr { th scope="row" { "taken" } @for name in &names { td.number { @match count(name).unwrap_or(0) { 0 => "never", count => (number(count)) } } } }
        }
        div.figure { (coverage_html::diagram(machine, count)) }
        @if let Some(reached) = reached { (sequences(reached, dossier, gaps)) }
    }
}

fn sequences(reached: &Coverage, dossier: &Dossier<'_>, gaps: &mut Vec<Gap>) -> Markup {
    let machine = dossier.run.header.machines.iter().find(|machine| machine.role == reached.role);
    let kinds = reached.kinds();
    for (kind, one) in kinds {
        if !one.missing.is_empty() {
            let what = format!(
                "{} of {} {kind} that can be walked were not: {}",
                one.missing.len(),
                one.feasible,
                listed(&one.missing)
            );
            gaps.push(Gap::closed_by(Kind::NotRun, what, TOURS));
        }
        for (name, said) in one.contradicting.iter().take(LISTED) {
            let what = format!(
                "`{}` of the {kind} was taken although it cannot be, {}",
                short(name, NAME),
                short(said, 2 * NAME)
            );
            gaps.push(Gap::new(Kind::Inconclusive, what));
        }
    }
    for (kind, one) in reached.asked.iter().flat_map(|asked| asked.kinds()) {
        if !one.missing.is_empty() {
            let what =
                format!("{} sides of {kind} were not seen to decide: {}", one.missing.len(), listed(&one.missing));
            gaps.push(Gap::closed_by(Kind::NotRun, what, TOURS));
        }
    }
    html! {
        h3 { "Sequences" }
        table {
            thead { tr { th scope="col" { "Sequences of" } th.number scope="col" { "Can be walked" } th.number scope="col" { "Taken" } th scope="col" { "Not taken" } } }
            @for (kind, one) in kinds {
                tr { th scope="row" { (kind) } td.number { (one.feasible) } td.number { (one.taken) } td { @if one.missing.is_empty() { "none" } @else { (listed(&one.missing)) } } }
            }
        }
        @if let Some(machine) = machine {
            h3 { "Pairs of steps, with the number of cases that took them" }
            (coverage_html::pairs_of_steps(reached, &machine.steps))
            @if let Some(asked) = &reached.asked {
                h3 { "Guards and timers, with the number of cases that saw them decide" }
                p { (asked.said()) " · a side counts where it alone decided what was to be seen outside." }
                (asked_html::conditions(asked, machine))
            }
        }
    }
}

fn listed(names: &[String]) -> String {
    let first = names.iter().take(LISTED).map(|name| short(name, NAME)).collect::<Vec<_>>().join(", ");
    if names.len() > LISTED { format!("{first} and {} more", names.len() - LISTED) } else { first }
}
