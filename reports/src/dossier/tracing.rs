//! Annexes: statements with their cases, cases with their statements, and what does not apply.

use super::Dossier;
use super::page::{NAME, TEXT, cite_all};
use super::trace::{State, Traced};
use crate::case_html::anchor;
use crate::text::short;
use maud::{Markup, html};
use std::collections::{BTreeMap, BTreeSet};

/// Ids of cases beside a statement.
const IDS: usize = 40;

/// An annex.
pub struct Annex {
    /// Anchor.
    pub key: &'static str,
    /// Heading.
    pub title: &'static str,
    /// Below it.
    pub body: Markup,
}

pub fn annexes(dossier: &Dossier<'_>) -> [Annex; 3] {
    [
        Annex {
            key: "requirements",
            title: "Annex A: statements, their cases, their verdicts",
            body: statements(dossier),
        },
        Annex { key: "cases", title: "Annex B: cases and the statements they judge", body: cases(dossier) },
        Annex { key: "not-applicable", title: "Annex C: cases that do not apply", body: not_applicable(dossier) },
    ]
}

fn statements(dossier: &Dossier<'_>) -> Markup {
    html! {
        p { "Statements of the standard in the words of fsct, with the clause in V1.1 and in IEC 61139-2:2022. Records: " (cite_all(dossier.runs())) }
        table.trace {
            thead { tr { th scope="col" { "Statement" } th scope="col" { "V1.1" } th scope="col" { "IEC" } th scope="col" { "Says" } th scope="col" { "State" } th scope="col" { "Cases" } } }
            @for one in &dossier.trace.statements { (statement(one)) }
        }
    }
}

fn statement(one: &Traced) -> Markup {
    let statement = &one.statement;
    let clause =
        |edition: &str| statement.clauses.get(edition).map_or_else(|| "–".to_owned(), |clause| short(clause, NAME));
    html! {
        tr id=(anchor(&statement.id, 0)) {
            th scope="row" { (short(&statement.id, NAME)) br; span.soft { (short(&statement.level, NAME)) } }
            td { (clause("v1.1")) }
            td { (clause("iec2022")) }
            td { (short(&statement.text, TEXT)) @if !one.state.is_judged() && !statement.why.is_empty() { br; i { (if one.state == State::Iodd { "How: " } else { "Why not: " }) (short(&statement.why, TEXT)) } } }
            td { (one.state.said()) }
            td {
                @for id in one.cases.iter().take(IDS) { a href={ "#" (anchor(id, 0)) } { (short(id, NAME)) } " " }
                @if one.cases.len() > IDS { "and " (one.cases.len() - IDS) " more " }
                @if one.points > 0 { span.soft { "(" (one.points) " points) " } }
                @if !one.absent.is_empty() { span.soft { "not in the records: " (short(&one.absent.iter().take(IDS).cloned().collect::<Vec<_>>().join(" "), TEXT)) } }
            }
        }
    }
}

fn cases(dossier: &Dossier<'_>) -> Markup {
    let known: BTreeSet<&str> = dossier.trace.statements.iter().map(|one| one.statement.id.as_str()).collect();
    html! {
        p { "Cases of the records " (cite_all(dossier.runs())) ", with how many of their points came to what." }
        table.trace.cases {
            thead { tr { th scope="col" { "Case" } th scope="col" { "Shows" } th scope="col" { "Verdicts" } th scope="col" { "Statements" } } }
            @for (id, case) in &dossier.trace.cases {
                tr id=(anchor(id, 0)) {
                    th scope="row" { (short(id, NAME)) br; span.soft { (short(&case.suite, NAME)) } }
                    td { (short(&case.title, TEXT)) }
                    td { @for (said, count) in &case.verdicts { div { (said) " × " (count) } } }
                    td {
                        @if case.requirements.is_empty() { "none" }
                        @for id in &case.requirements {
                            @if known.contains(id.as_str()) { a href={ "#" (anchor(id, 0)) } { (short(id, NAME)) } } @else { (short(id, NAME)) } " "
                        }
                    }
                }
            }
        }
    }
}

fn not_applicable(dossier: &Dossier<'_>) -> Markup {
    let mut terms: BTreeMap<&str, BTreeMap<&str, usize>> = BTreeMap::new();
    for (key, term) in &dossier.run.header.not_applicable {
        *terms.entry(term).or_default().entry(key.split('[').next().unwrap_or_default()).or_default() += 1;
    }
    html! {
        @if terms.is_empty() { p { "Every case of these runs applies." } } @else {
            p { "Left out before the run, with the reason; a case that is left out passes nothing." }
            table.trace {
                thead { tr { th scope="col" { "Why" } th scope="col" { "Cases, with how many of their points" } } }
                @for (term, ids) in &terms {
                    tr { td { (short(term, TEXT)) } td { @for (id, count) in ids { (short(id, NAME)) " × " (count) " " } } }
                }
            }
        }
    }
}
