//! The page: title block, contents, chapters, gaps, annexes.

use super::gap::Gap;
use super::product::name;
use super::trace::State;
use super::{CHAPTERS, Chapter, Dossier, Section, gaps, tracing};
use crate::html::{head, role};
use crate::record::EvidenceItem;
use crate::text::{short, visible as clean};
use maud::{DOCTYPE, Markup, html};
use std::collections::BTreeSet;

const PRINT: &str = include_str!("dossier.css");
/// Characters of a name, and of a sentence.
pub const NAME: usize = 120;
pub const TEXT: usize = 600;

/// The whole page.
pub fn page(dossier: &Dossier<'_>) -> Markup {
    let sections: Vec<(Chapter, Section)> =
        CHAPTERS.into_iter().map(|chapter| (chapter, filled(chapter, dossier))).collect();
    let gaps: Vec<&Gap> = sections.iter().flat_map(|(_, section)| &section.gaps).collect();
    let annexes = tracing::annexes(dossier);
    html! {
        (DOCTYPE)
        html lang="en" {
            (head(&format!("Dossier: {}", name(dossier)), PRINT))
            body {
                main {
                    header {
                        p.kind { "IO-Link Safety · dossier for an assessment" }
                        h1 { (name(dossier)) }
                        p.notice { "This dossier is evidence for an assessment. It is no certificate, and nobody has approved it. It is put together from records, judges nothing itself, and says what they do not show." }
                        (title_block(dossier))
                        (result(dossier, &gaps))
                    }
                    nav.contents {
                        h2 { "Contents" }
                        ol {
                            @for (chapter, _) in &sections { li { a href={ "#" (chapter.key) } { (chapter.title) } } }
                            li { a href="#gaps" { "Gaps" } }
                        }
                        ul.annexes { @for annex in &annexes { li { a href={ "#" (annex.key) } { (annex.title) } } } }
                    }
                    @for (number, (chapter, section)) in (1..).zip(&sections) {
                        section.chapter id=(chapter.key) {
                            h2 { (number) " " (chapter.title) }
                            (asked(dossier, chapter.key))
                            (section.body)
                        }
                    }
                    section.chapter id="gaps" {
                        h2 { (CHAPTERS.len() + 1) " Gaps" }
                        (gaps::body(dossier, &gaps))
                    }
                    @for annex in annexes {
                        section.chapter.annex id=(annex.key) { h2 { (annex.title) } (annex.body) }
                    }
                }
            }
        }
    }
}

/// A chapter with what the items of Annex I say is missing.
pub fn filled(chapter: Chapter, dossier: &Dossier<'_>) -> Section {
    let mut section = (chapter.section)(dossier);
    let elsewhere = items(dossier, chapter.key).flat_map(|item| &item.gaps);
    section.gaps.extend(elsewhere.map(|gap| Gap::new(super::Kind::Elsewhere, gap.clone())));
    section
}

/// The items of Annex I that a chapter answers.
pub fn items<'d>(dossier: &'d Dossier<'_>, key: &'d str) -> impl Iterator<Item = &'d EvidenceItem> {
    dossier.tool.items.iter().filter(move |item| item.chapter == key)
}

/// What Annex I asks for in this chapter, with the cases and documents that bear on it.
fn asked(dossier: &Dossier<'_>, key: &str) -> Markup {
    html! {
        @for item in items(dossier, key) {
            div.asks {
                p { b { "Annex " (short(&item.clause, NAME)) } " (v1.1): " (short(&item.asks, TEXT)) "." }
                @let own: Vec<&str> = item.cases.iter().map(|(name, _)| name.as_str()).filter(|name| for_role(dossier, name)).collect();
                @if !own.is_empty() {
                    p { "Cases: " @for (place, name) in own.iter().enumerate() { @if place > 0 { "; " } (cases(dossier, name)) } "." }
                }
                @for (path, says) in &item.documents { p { "Document " code { (short(path, NAME)) } ": " (short(says, TEXT)) "." } }
            }
        }
    }
}

/// Whether a suite or group holds a case for the role of the product.
fn for_role(dossier: &Dossier<'_>, name: &str) -> bool {
    let suites = dossier.tool.members.get(name).map_or(&[][..], Vec::as_slice);
    dossier.tool.cases.iter().any(|case| case.role == dossier.product.role && suites.contains(&case.suite))
}

/// A suite or group with what its cases came to in these records.
fn cases(dossier: &Dossier<'_>, name: &str) -> Markup {
    let suites = dossier.tool.members.get(name).map_or(&[][..], Vec::as_slice);
    let cases = dossier.run.cases.iter().filter(|case| suites.contains(&case.suite));
    let counts = crate::html::counted(cases);
    html! {
        code { (short(name, NAME)) }
        @if counts.is_empty() { " not in these records" }
        @for ((said, _), count) in counts { " " (said) " × " (count) }
    }
}

fn title_block(dossier: &Dossier<'_>) -> Markup {
    let product = &dossier.product;
    let text = |text: &str| if text.is_empty() { "not told".to_owned() } else { short(text, NAME) };
    let versions: BTreeSet<&str> = dossier.sources.iter().map(|source| source.fsct.as_str()).collect();
    html! {
        table.block {
            tr { th scope="row" { "Product" } td { (text(&product.product)) } th scope="row" { "Role" } td { (role(&product.role)) } }
            tr { th scope="row" { "Maker" } td { (text(&product.vendor)) } th scope="row" { "Version" } td { (text(&product.version)) } }
            tr { th scope="row" { "Editions" } td { (editions(dossier)) } th scope="row" { "Corrigenda" } td { "none taken into account, see chapter 2" } }
            tr { th scope="row" { "Records" } td { (dossier.sources.len()) ", see chapter 9" } th scope="row" { "Tool" } td { "fsct " (clean(&dossier.tool.version)) ", records of fsct " (short(&versions.into_iter().collect::<Vec<_>>().join(", "), NAME)) } }
            tr.fill { th scope="row" { "Date" } td { @if let Some(date) = &dossier.dated { (short(date, NAME)) } } th scope="row" { "Responsible" } td {} }
        }
    }
}

/// `IO-Link Safety V1.1, IEC 61139-2:2022`.
pub fn editions(dossier: &Dossier<'_>) -> String {
    let names = dossier.editions.iter().map(|edition| match edition.as_str() {
        "v1.1" => "IO-Link Safety System Extensions V1.1",
        "iec2022" => "IEC 61139-2:2022",
        _ => "",
    });
    let names = names.collect::<Vec<_>>().join("; ");
    if names.is_empty() { "none ran".to_owned() } else { names }
}

/// The result in a few numbers.
fn result(dossier: &Dossier<'_>, gaps: &[&Gap]) -> Markup {
    let summary = &dossier.summary;
    let statements = &dossier.trace.statements;
    let judged = statements.iter().filter(|one| one.state.is_judged()).count();
    let failed = dossier.trace.in_state(State::Failed).count();
    let said = match summary.exit_code() {
        0 => "✓ No case of these records failed or stayed open",
        1 => "✗ Not conformant: cases failed",
        3 => "! Not everything was executed as meant",
        4 => "! Nothing ran, so nothing is shown",
        _ => "? Something stayed inconclusive",
    };
    let verdicts = summary.verdicts.iter().filter(|(_, count)| **count > 0);
    html! {
        div.banner {
            strong { (said) }
            ul {
                li { (summary.cases) " cases: " @for (place, (name, count)) in verdicts.enumerate() { @if place > 0 { ", " } (count) " " (name) } ". " (summary.not_applicable) " more do not apply." }
                li { (statements.len()) " statements of the standard concern the product; something was concluded on " (judged) @if failed > 0 { ", " (failed) " of them failed" } "." }
                li { (gaps.len()) " gaps are listed in " a href="#gaps" { "chapter " (CHAPTERS.len() + 1) } "." }
            }
        }
    }
}

/// `[1]`, a link to the list of records.
pub fn cite(number: usize) -> Markup {
    html! { a.cite href={ "#record-" (number) } { "[" (number) "]" } }
}

/// `[1] [3]`.
pub fn cite_all(numbers: impl IntoIterator<Item = usize>) -> Markup {
    html! { @for number in numbers { (cite(number)) " " } }
}

/// Stands where no record was given.
pub fn absent(what: &str, command: &str) -> (Markup, Gap) {
    let markup = html! { p.gap { "○ Not in these records: " (what) ". " code { (command) } } };
    (markup, Gap::closed_by(super::Kind::NotRun, what, command))
}

/// A number as a reader expects it, thousands apart.
pub fn number(count: u64) -> String {
    let digits = count.to_string();
    let mut out = String::new();
    for (place, digit) in digits.chars().enumerate() {
        if place > 0 && (digits.len() - place).is_multiple_of(3) {
            out.push('\u{202f}');
        }
        out.push(digit);
    }
    out
}
