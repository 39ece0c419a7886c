//! The part of `report.html` on Annex I of v1.1: what it asks for, what of this run supports it, and what is missing.

use crate::html::{LISTED, NAME, counted};
use crate::journal::Run;
use crate::record::{CaseRecord, Evidence, EvidenceItem};
use crate::text::short;
use maud::{Markup, html};
use std::collections::BTreeSet;

/// Characters of a sentence.
const SENTENCE: usize = 3 * NAME;

/// The items of Annex I, when the run was made to support them.
pub fn section(run: &Run) -> Markup {
    html! { @if let Some(evidence) = &run.header.evidence { (table(evidence, run)) } }
}

fn table(evidence: &Evidence, run: &Run) -> Markup {
    let judged: BTreeSet<&str> =
        run.cases.iter().flat_map(|case| &case.requirements).map(|requirement| requirement.id.as_str()).collect();
    let classes = evidence.classes.iter().take(LISTED);
    let classes: Vec<String> = classes.map(|(class, count)| format!("{count} {}", short(class, NAME))).collect();
    let open = evidence.items.iter().filter(|item| !item.gaps.is_empty()).count();
    html! {
        h2 { "Annex I" }
        p {
            "What v1.1 asks for before conformity is claimed, and what a concept approval rests on, beside what this run has to show. "
            "The test specification that v1.1 announced as its Annex K was never printed: this is evidence for an assessment and "
            "replaces none. " (open) " of " (evidence.items.len()) " items need something from elsewhere."
        }
        p {
            "Requirements: of the statements of both editions the cases of this run judged " (judged.len()) "; the ledger holds "
            (classes.join(", ")) "."
        }
        div.scroll tabindex="0" role="group" aria-label="Items of Annex I" {
            table.evidence {
                thead { tr { th scope="col" { "Clause" } th scope="col" { "Asks for" } th scope="col" { "Supported by" } th scope="col" { "Gaps" } } }
                @for item in evidence.items.iter().take(LISTED) { (row(item, run)) }
            }
        }
    }
}

fn row(item: &EvidenceItem, run: &Run) -> Markup {
    let supported = !(item.cases.is_empty() && item.figures.is_empty() && item.documents.is_empty());
    html! {
        tr {
            th scope="row" { (short(&item.clause, NAME)) }
            td { (short(&item.asks, SENTENCE)) }
            td {
                @if !supported { span.soft { "nothing here" } }
                @for (name, suites) in item.cases.iter().take(LISTED) { (cases(name, suites, run)) }
                @for figure in item.figures.iter().take(LISTED) { div { (short(figure, SENTENCE)) } }
                @for (path, says) in item.documents.iter().take(LISTED) {
                    div { code { (short(path, NAME)) } ": " (short(says, SENTENCE)) }
                }
            }
            td { @for gap in item.gaps.iter().take(LISTED) { div { (short(gap, SENTENCE)) } } }
        }
    }
}

/// A suite or group with what its cases came to.
fn cases(name: &str, suites: &[String], run: &Run) -> Markup {
    let of_it = |case: &&CaseRecord| suites.contains(&case.suite);
    let counts = counted(run.cases.iter().filter(of_it));
    html! {
        div {
            code { (short(name, NAME)) }
            @if counts.is_empty() { " " span.soft { "not run" } }
            @for ((said, class), count) in &counts { " · " span class=(class) { (said) " × " (count) } }
        }
    }
}
