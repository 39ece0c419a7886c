//! What the records do not show, by kind, each with the command that closes it where there is one.

use super::Dossier;
use super::gap::{Gap, Kind};
use super::page::{NAME, TEXT};
use crate::html::word;
use crate::record::CaseRecord;
use crate::text::short;
use maud::{Markup, html};

/// Cases told of one kind.
const CASES: usize = 60;

pub fn body(dossier: &Dossier<'_>, gaps: &[&Gap]) -> Markup {
    html! {
        p { "What an assessor cannot take from this dossier. A gap is no failure, unless it stands under failures; it is work that is not done, or not shown." }
        @for kind in Kind::ALL {
            @let own: Vec<&&Gap> = gaps.iter().filter(|gap| gap.kind == kind).collect();
            @let cases = cases(dossier, kind);
            @if !own.is_empty() || !cases.is_empty() {
                h3 { (kind.title()) }
                @if own.iter().all(|gap| gap.command.is_empty()) {
                    ul { @for gap in own { li { (short(&gap.what, 3 * TEXT)) } } }
                } @else {
                    table.gaps {
                        thead { tr { th scope="col" { "Gap" } th scope="col" { "What closes it" } } }
                        @for gap in own { tr { td { (short(&gap.what, 3 * TEXT)) } td { @if gap.command.is_empty() { "–" } @else { code { (short(&gap.command, TEXT)) } } } } }
                    }
                }
                (told(&cases))
            }
        }
        @if gaps.is_empty() { p { "None." } }
    }
}

/// The cases behind a kind of gap.
fn cases<'d>(dossier: &'d Dossier<'_>, kind: Kind) -> Vec<&'d CaseRecord> {
    let classes: &[&str] = match kind {
        Kind::Failure => &["fail"],
        Kind::Inconclusive => &["inconclusive", "error", "not-begun"],
        _ => &[],
    };
    dossier.run.cases.iter().filter(|case| classes.contains(&word(case).1)).collect()
}

fn told(cases: &[&CaseRecord]) -> Markup {
    html! {
        @if !cases.is_empty() {
            table.findings {
                thead { tr { th scope="col" { "Case" } th scope="col" { "Clause" } th scope="col" { "Expected, observed" } } }
                @for case in cases.iter().take(CASES) {
                    @let reason = case.reasons.first();
                    tr {
                        th scope="row" { (word(case).0) " " (short(&case.key, NAME)) br; (short(&case.title, NAME)) }
                        td { (reason.map_or_else(String::new, |reason| short(&reason.clause, NAME))) }
                        td { @if let Some(reason) = reason { "expected " (short(&reason.expected, TEXT)) br; "observed " (short(&reason.observed, TEXT)) br; } code { (short(&case.replay, TEXT)) } }
                    }
                }
            }
            @if cases.len() > CASES { p { (cases.len() - CASES) " more such cases are in the records." } }
        }
    }
}
