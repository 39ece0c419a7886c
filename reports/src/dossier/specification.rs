//! Editions and corrigenda, the statements that concern the product, and what can be said of them.

use super::page::{cite_all, editions};
use super::trace::State;
use super::{Dossier, Gap, Kind, Section};
use maud::{Markup, html};
use std::collections::BTreeMap;

/// Ids listed in a gap.
const LISTED: usize = 12;

pub fn section(dossier: &Dossier<'_>) -> Section {
    let mut gaps = Vec::new();
    for (state, kind, what, command) in [
        (State::Failed, Kind::Failure, "Statements judged by a case that failed", ""),
        (State::NotExecuted, Kind::Inconclusive, "Statements judged by a case that was not executed as meant", ""),
        (State::Inconclusive, Kind::Inconclusive, "Statements judged by a case that stayed inconclusive", ""),
        (
            State::NotRun,
            Kind::NotRun,
            "Statements with cases that are not in these records",
            "fsct run annex-i --dut URL --out DIR",
        ),
        (
            State::Iodd,
            Kind::ByHand,
            "Statements about the IODD, which a command of its own judges, with an outcome that has to be attached",
            "fsct iodd FILE",
        ),
        (
            State::OtherSide,
            Kind::Open,
            "Statements about both sides of the link, with cases for the other side alone",
            "",
        ),
        (State::Open, Kind::Open, "Statements open in the ledger, which nothing is done about yet", ""),
        (State::Bench, Kind::ByHand, "Statements that need instruments", ""),
        (
            State::Inspection,
            Kind::ByHand,
            "Statements that need a person who reads documents or looks at the product",
            "",
        ),
        (State::Untestable, Kind::ByHand, "Statements that cannot be judged from outside", ""),
    ] {
        let ids: Vec<&str> = dossier.trace.in_state(state).map(|one| one.statement.id.as_str()).collect();
        if !ids.is_empty() {
            let more = if ids.len() > LISTED { format!(" and {} more", ids.len() - LISTED) } else { String::new() };
            let first = ids.iter().take(LISTED).copied().collect::<Vec<_>>().join(", ");
            gaps.push(Gap::closed_by(
                kind,
                format!("{what}: {} ({first}{more}); Annex A has each", ids.len()),
                command,
            ));
        }
    }
    for edition in ["v1.1", "iec2022"] {
        if !dossier.run.cases.iter().any(|case| case.variant.edition == edition) && dossier.editions.contains(edition) {
            gaps.push(Gap::closed_by(
                Kind::NotRun,
                format!("The product offers edition {edition}, and no case of these records ran in it"),
                format!("fsct run --edition {edition} --dut URL --out DIR"),
            ));
        }
    }
    Section { body: body(dossier), gaps }
}

fn body(dossier: &Dossier<'_>) -> Markup {
    let trace = &dossier.trace;
    html! {
        h3 { "Editions and corrigenda" }
        p { "Judged against: " (editions(dossier)) "." }
        table {
            thead { tr { th scope="col" { "Document" } th scope="col" { "As used here" } } }
            tr { td { "IO-Link Safety System Extensions with SMI, V1.1" } td { "as printed; no corrigendum and no change request is taken into account" } }
            tr { td { "IEC 61139-2:2022" } td { "as printed; no corrigendum is taken into account" } }
            tr { td { "IO-Link Interface and System (IEC 61131-9)" } td { "the base system: what it tests itself is not tested again" } }
        }
        h3 { "Statements" }
        p {
            "The ledger of fsct holds " (dossier.tool.statements.len()) " statements of both editions. " (trace.statements.len())
            " concern this product; " (trace.others) " concern the other side of the link, a tool, a gateway or an edition it does not offer. "
            "Verdicts are those of the records " (cite_all(dossier.runs())) "; a statement is as bad as the worst case that judges it. "
            "Each statement with its cases is in " a href="#requirements" { "Annex A" } ", each case with its statements in " a href="#cases" { "Annex B" } "."
        }
        table {
            thead { tr { th scope="col" { "State" } th.number scope="col" { "Statements" } @for level in LEVELS { th.number scope="col" { (level) } } th scope="col" { "Meaning" } } }
            @for state in State::ALL {
                @let levels = levels(dossier, state);
                @let all: usize = levels.values().sum();
                @if all > 0 {
                    tr {
                        th scope="row" { (state.said()) }
                        td.number { (all) }
                        @for level in LEVELS { td.number { (levels.get(level).copied().unwrap_or(0)) } }
                        td { (state.means()) }
                    }
                }
            }
        }
    }
}

const LEVELS: [&str; 4] = ["shall", "should", "may", "fact"];

fn levels<'d>(dossier: &'d Dossier<'_>, state: State) -> BTreeMap<&'d str, usize> {
    let mut levels = BTreeMap::new();
    dossier.trace.in_state(state).for_each(|one| *levels.entry(one.statement.level.as_str()).or_default() += 1);
    levels
}
