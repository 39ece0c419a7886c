//! What `fsct prove` found about the tables themselves.

use super::document::{Asked, Proof};
use super::page::{NAME, TEXT, absent, cite, number};
use super::{Dossier, Gap, Kind, Piece, Section};
use crate::text::short;
use maud::{Markup, html};

/// Explorations shown.
const SHOWN: usize = 24;
const COMMAND: &str = "fsct prove --json > DIR/prove.json";

pub fn section(dossier: &Dossier<'_>) -> Section {
    let proofs: Vec<(usize, &Proof)> = dossier
        .pieces(|piece| match piece {
            Piece::Proof(proofs) => Some(proofs),
            _ => None,
        })
        .flat_map(|(number, proofs)| proofs.iter().map(move |proof| (number, proof)))
        .collect();
    let mut gaps = Vec::new();
    let (nothing, gap) = absent("the exploration of both machines with the black channel", COMMAND);
    if proofs.is_empty() {
        gaps.push(gap);
    }
    let lacks = |edition: &String| !proofs.iter().any(|(_, proof)| proof.edition == *edition);
    for edition in dossier.editions.iter().filter(|edition| !proofs.is_empty() && lacks(edition)) {
        gaps.push(Gap::closed_by(
            Kind::NotRun,
            format!("The tables of edition {edition}, which the product offers, were not explored"),
            format!("fsct prove --edition {edition} --json > DIR/prove.json"),
        ));
    }
    gaps.extend(proofs.iter().flat_map(|(_, proof)| proof.properties.iter().filter_map(|one| gap_of(one, proof))));
    let body = html! {
        p {
            "Both machines of the safety communication layer are explored together, with a black channel that may deliver, lose or falsify "
            "anything in either direction, with power and operator free. It is the tables of the standard that are explored, by the "
            "interpreter the oracle judges with; that the product follows these tables is what chapters 3 and 5 and Annex A show."
        }
        @if proofs.is_empty() { (nothing) }
        @for (source, proof) in proofs.iter().take(SHOWN) { (explored(*source, proof)) }
        @if proofs.len() > SHOWN { p.soft { (proofs.len() - SHOWN) " more explorations are in the record." } }
    };
    Section { body, gaps }
}

fn gap_of(one: &Asked, proof: &Proof) -> Option<Gap> {
    let (name, edition) = (short(&one.property, NAME), short(&proof.edition, NAME));
    let with = if proof.readings.is_empty() {
        String::new()
    } else {
        format!(" read as {}", short(&proof.readings.join(", "), NAME))
    };
    match one.verdict.as_str() {
        "holds" => None,
        "tables" => Some(Gap::new(
            Kind::Reading,
            format!(
                "{name} goes beyond its bound by the tables of the standard themselves ({edition}{with}): {}",
                short(one.tables.as_deref().unwrap_or_default(), TEXT)
            ),
        )),
        "unknown" => Some(Gap::closed_by(
            Kind::Inconclusive,
            format!("{name} is not known ({edition}{with}): the search had to stop"),
            "fsct prove --most-states N --json",
        )),
        verdict => {
            Some(Gap::new(Kind::Failure, format!("{name} is {} in the model ({edition}{with})", short(verdict, NAME))))
        }
    }
}

/// A verdict with its sign.
fn signed(verdict: &str) -> String {
    let sign = match verdict {
        "holds" => "✓",
        "tables" => "●",
        "unknown" => "?",
        _ => "✗",
    };
    format!("{sign} {}", short(verdict, NAME))
}

fn explored(source: usize, proof: &Proof) -> Markup {
    let readings =
        if proof.readings.is_empty() { "default readings".to_owned() } else { short(&proof.readings.join(", "), NAME) };
    html! {
        h3 { "Edition " (short(&proof.edition, NAME)) ", " (readings) " " (cite(source)) }
        p {
            "FSP_Watchdog of " (proof.watchdog) " exchanges; answers " @if proof.timing == "I" { "in the same exchange" } @else { "in the next exchange" } "; "
            @match proof.faults { None => "any number of disturbed exchanges", Some(faults) => { (faults) " disturbed exchanges at most" } } "; "
            @if proof.power_cycles { "power cycles of the FS-Device" } @else { "no power cycles" } ". " (number(proof.states)) " states, all of them explored."
        }
        table {
            thead { tr { th scope="col" { "Property" } th scope="col" { "Says" } th scope="col" { "Clause" } th scope="col" { "Verdict" } th.number scope="col" { "Found" } th.number scope="col" { "Bound" } th.number scope="col" { "States" } th.number scope="col" { "Depth" } } }
            @for one in proof.properties.iter().take(SHOWN) {
                tr {
                    th scope="row" { (short(&one.property, NAME)) }
                    td { (short(&one.about, TEXT)) " " span.soft { "(" (short(&one.measures, NAME)) ")" } }
                    td { (short(&one.clause, NAME)) }
                    td { (signed(&one.verdict)) }
                    td.number { @if one.found >= 255 { "no end" } @else { (one.found) } }
                    td.number { @match one.bound { None => "–", Some(bound) => (bound) } }
                    td.number { (number(one.states)) }
                    td.number { (one.depth) }
                }
            }
        }
        p.soft { "✓ holds for everything reachable. ● the tables of both editions allow it as they stand; no product is failed for it." }
    }
}
