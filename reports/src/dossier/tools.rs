//! What the tool itself is worth: its self-test, its mutants, and where in the tool chain a mistake is found.

use super::page::{NAME, TEXT, absent, cite, cite_all};
use super::{Dossier, Gap, Kind, Piece, Section};
use crate::gauntlet::{Gauntlet, Matrix, Mutant};
use crate::html::role;
use crate::text::short;
use maud::{Markup, html};

/// Cases named beside a mutant.
const NAMED: usize = 4;

pub fn section(dossier: &Dossier<'_>) -> Section {
    let gauntlets: Vec<(usize, &Gauntlet)> =
        dossier.pieces(|piece| if let Piece::Gauntlet(one) = piece { Some(one) } else { None }).collect();
    let mut gaps = Vec::new();
    let (nothing, gap) = absent("the kill matrix: what the cases are worth", "fsct gauntlet --out DIR");
    if gauntlets.is_empty() {
        gaps.push(gap);
    }
    for one in dossier.tool.self_test.iter().filter(|one| !one.passed) {
        gaps.push(Gap::closed_by(
            Kind::Failure,
            format!("The self-test of the tool failed: {}: {}", one.what, one.outcome),
            one.command.clone(),
        ));
    }
    for (source, matrix) in
        gauntlets.iter().flat_map(|(source, one)| one.roles.iter().map(move |matrix| (source, matrix)))
    {
        let (survivors, idle) = (matrix.survivors().count(), matrix.idle().count());
        if survivors > 0 {
            gaps.push(Gap::new(
                Kind::Inconclusive,
                format!(
                    "{survivors} mutants of the reference {} survive all cases, record [{source}]",
                    role(&matrix.role)
                ),
            ));
        }
        if idle > 0 {
            gaps.push(Gap::new(
                Kind::Inconclusive,
                format!("{idle} cases for an {} kill no mutant, record [{source}]", role(&matrix.role)),
            ));
        }
    }
    if !gauntlets.is_empty()
        && !gauntlets.iter().any(|(_, one)| one.roles.iter().any(|matrix| matrix.role == dossier.product.role))
    {
        gaps.push(Gap::closed_by(
            Kind::NotRun,
            format!("The kill matrix is not of the cases for an {}", role(&dossier.product.role)),
            "fsct gauntlet --out DIR",
        ));
    }
    for (number, source) in (1..).zip(&dossier.sources).filter(|(_, source)| source.fsct != dossier.tool.version) {
        gaps.push(Gap::closed_by(
            Kind::Inconclusive,
            format!(
                "Record [{number}] was made by fsct {}, this dossier by fsct {}: the self-test below is of the latter",
                short(&source.fsct, NAME),
                dossier.tool.version
            ),
            "fsct dossier, of the version that made the records",
        ));
    }
    let body = html! {
        h3 { "Self-test" }
        p { "Made by the program that made this dossier (fsct " (dossier.tool.version) "), while it did." }
        table {
            thead { tr { th scope="col" { "What" } th scope="col" { "Outcome" } th scope="col" { "Again" } } }
            @for one in &dossier.tool.self_test {
                tr { th scope="row" { @if one.passed { "✓ " } @else { "✗ " } (one.what) } td { (one.outcome) } td { code { (one.command) } } }
            }
        }
        (chain(dossier, &gauntlets))
        h3 { "Mutants" }
        p {
            "Each mutant is a reference DUT with one deliberate fault. A case kills it when an expectation of the case itself fails; the oracle has no "
            "say in that. A mutant counts as killed when a case that judges the clause it violates kills it."
        }
        @if gauntlets.is_empty() { (nothing) }
        @for (source, one) in &gauntlets { @for matrix in &one.roles { (killed(*source, matrix, dossier)) } }
    };
    Section { body, gaps }
}

/// Where a mistake of a tool would be found.
fn chain(dossier: &Dossier<'_>, gauntlets: &[(usize, &Gauntlet)]) -> Markup {
    let mutants: usize = gauntlets.iter().flat_map(|(_, one)| &one.roles).map(|matrix| matrix.mutants.len()).sum();
    let rows: [(&str, &str, Markup); 6] = [
        (
            "Signatures and octet codecs",
            "Judge and product share one wrong checksum and agree with each other",
            html! { "Known answers printed in the standard or derived from it, and a second, bitwise implementation in the tests" },
        ),
        (
            "Tables and oracle",
            "The judge has a row wrong",
            html! { "The reference DUTs and the stacks in C and Python are further readings of the tables that share no code with it; mutants of tables and oracle are in docs/assurance.md" },
        ),
        (
            "Cases",
            "A case looks at nothing",
            html! { @if mutants == 0 { "not shown: no kill matrix in these records" } @else { (mutants) " mutants, below " (cite_all(gauntlets.iter().map(|(source, _)| *source))) } },
        ),
        (
            "Adapter and rig",
            "A lost or late octet is taken for a fault of the product, or hides one",
            html! { "Frames carry a CRC; what the rig loses is told apart from verdicts (“not executed as meant”); a dead DUT passes nothing" },
        ),
        (
            "Clock",
            "Times are judged that were not measured so",
            html! { @for (number, proof) in (1..).zip(&dossier.run.header.duts).filter_map(|(number, dut)| Some((number, dut.clock_proof.as_ref()?))).take(NAMED) { "DUT " (number) ": " (short(&proof.said(), TEXT)) ". " } "A verdict on a time keeps a guard band of the stated uncertainty" },
        ),
        (
            "Records and this dossier",
            "A record is changed, or belongs to something else",
            html! { "Hash, version and seed of each record are in chapter 9; on a virtual clock the same seed gives the same octets" },
        ),
    ];
    html! {
        h3 { "Failure modes of the tool chain" }
        p { "A beginning of the analysis, for the steps fsct has a part in. IODD import, dedicated tools and the transfer of parameters by an FS-Master tool are the maker's." }
        table {
            thead { tr { th scope="col" { "Step" } th scope="col" { "Failure" } th scope="col" { "What finds it" } } }
            @for (step, failure, finds) in rows { tr { th scope="row" { (step) } td { (failure) } td { (finds) } } }
        }
    }
}

fn killed(source: usize, matrix: &Matrix, dossier: &Dossier<'_>) -> Markup {
    let survivors = matrix.survivors().count();
    html! {
        h3 { (role(&matrix.role)) " " (cite(source)) }
        p {
            @if survivors == 0 { "✓ " } @else { "✗ " } (matrix.mutants.len() - survivors) " of " (matrix.mutants.len()) " mutants are killed by a case that judges their clause; "
            (matrix.cases.len() - matrix.idle().count()) " of " (matrix.cases.len()) " cases kill."
        }
        @if matrix.role == dossier.product.role {
            table.mutants {
                thead { tr { th scope="col" { "Mutant" } th scope="col" { "Clause" } th scope="col" { "What is wrong" } th.number scope="col" { "Cases that kill it" } th scope="col" { "Of those that judge the clause" } } }
                @for mutant in &matrix.mutants { (of(mutant)) }
            }
        }
    }
}

fn of(mutant: &Mutant) -> Markup {
    let named = &mutant.named_by;
    html! {
        tr {
            th scope="row" { @if named.is_empty() { "✗ " } (short(&mutant.name, NAME)) }
            td { (short(&mutant.clause, NAME)) }
            td { (short(&mutant.about, TEXT)) }
            td.number { (mutant.killed_by.len()) }
            td {
                @if named.is_empty() { @if mutant.oracle == Some(true) { "found by the oracle alone" } @else { "none" } }
                (short(&named.iter().take(NAMED).cloned().collect::<Vec<_>>().join(", "), TEXT))
                @if named.len() > NAMED { " and " (named.len() - NAMED) " more" }
            }
        }
    }
}
