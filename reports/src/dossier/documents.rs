//! The records this dossier is made of, each with what ties it to its file.

use super::page::NAME;
use super::source::Piece;
use super::{Dossier, Gap, Kind, Section, Source};
use crate::text::short;
use maud::{Markup, html};

pub fn section(dossier: &Dossier<'_>) -> Section {
    let mut gaps = Vec::new();
    for (number, source) in (1..).zip(&dossier.sources) {
        if let Piece::Run(run) = &source.piece
            && !run.partial.is_empty()
            && dossier.concerns(source)
        {
            gaps.push(Gap::closed_by(
                Kind::Inconclusive,
                format!("Record [{number}] is not whole: {}", short(&run.partial, NAME)),
                "fsct run --dut URL --out DIR",
            ));
        }
    }
    let body = html! {
        p {
            "A number in brackets anywhere in this dossier is a record of this list. Records hold no time of day, so that the same seed gives the same "
            "octets; the hash, SHA-256 of the file, says which one was read. Keep the files: verdicts can be looked into there, down to the octets."
        }
        table.records {
            thead { tr { th scope="col" { "Record" } th scope="col" { "File and hash" } th scope="col" { "Holds" } th scope="col" { "Tool" } th.number scope="col" { "Seed" } } }
            @for (number, source) in (1..).zip(&dossier.sources) {
                tr id={ "record-" (number) } {
                    th scope="row" { "[" (number) "]" }
                    td { code { (short(&source.path.display().to_string(), 2 * NAME)) } br; code.hash { (source.sha256) } }
                    td { (holds(source)) @if !dossier.concerns(source) { br; "Not about the product: named in chapter 1, not used." } }
                    td { "fsct " (short(&source.fsct, NAME)) br; code { (source.schema()) } }
                    td.number { @match source.seed { Some(seed) => (seed), None => "–" } }
                }
            }
        }
    };
    Section { body, gaps }
}

fn holds(source: &Source) -> Markup {
    html! {
        @match &source.piece {
            Piece::Run(run) => { "Run: " (run.cases.len()) " cases of " (run.header.planned) " planned, DUTs: " (run.header.duts.len()) @if !run.partial.is_empty() { ". ! Not whole: " (short(&run.partial, NAME)) } }
            Piece::Bits(one) => { "Campaign of corruptions, " (one.rows.len()) " rows" }
            Piece::Random(one) => { "Campaign of random faults, " (one.exchanges) " exchanges" }
            Piece::Records(one) => { "Campaign on FSP_VerifyRecord, " (one.rows.len()) " rows" }
            Piece::Noise(one) => { "Campaign of bits wrong by chance, " (one.rows.len()) " rows" }
            Piece::Gauntlet(one) => { "Kill matrix: " @for (place, matrix) in one.roles.iter().enumerate() { @if place > 0 { ", " } (matrix.mutants.len()) " mutants of the " (crate::html::role(&matrix.role)) } }
            Piece::Proof(one) => { "Explorations of the tables: " (one.len()) }
            Piece::Residual(one) => { "Residual error of " (one.codes.len()) " signatures" }
        }
    }
}
