//! What the figures rest on: the assumptions of the standard with what supports each, and the readings in force and made use of.

use super::page::{TEXT, cite, cite_all};
use super::{Dossier, Gap, Kind, Piece, Section};
use crate::text::{short, visible as clean};
use maud::{Markup, html};
use std::collections::BTreeSet;

pub fn section(dossier: &Dossier<'_>) -> Section {
    let assumptions = assumptions(dossier);
    let mut gaps: Vec<Gap> =
        assumptions.iter().map(|one| Gap::new(Kind::Elsewhere, format!("{}: {}", one.what, one.gap))).collect();
    for (id, count) in &dossier.summary.tolerances {
        let name = dossier.tool.readings.get(id).map_or("", |reading| reading.name.as_str());
        gaps.push(Gap::closed_by(
            Kind::Reading,
            format!("The product made use of {} ({name}), cases: {count}; whether that reading is acceptable is for the assessor", clean(id)),
            format!("fsct explain {}", clean(id)),
        ));
    }
    let body = html! {
        h3 { "Assumptions" }
        p { "What the residual error rates and the design of the protocol assume. No run of a product can prove them; what these records have to say to each stands beside it." }
        table.assumptions {
            thead { tr { th scope="col" { "Assumption" } th scope="col" { "Clause" } th scope="col" { "What supports it here" } th scope="col" { "What does not" } } }
            @for one in &assumptions {
                tr { th scope="row" { (one.what) } td { (one.clause) } td { (one.support) } td { (one.gap) } }
            }
        }
        (readings(dossier))
    };
    Section { body, gaps }
}

/// An assumption of the standard.
struct Assumption {
    what: &'static str,
    clause: &'static str,
    support: Markup,
    gap: &'static str,
}

fn assumptions(dossier: &Dossier<'_>) -> Vec<Assumption> {
    let residual: Vec<usize> = dossier
        .pieces(|piece| if let Piece::Residual(one) = piece { Some(one) } else { None })
        .map(|(number, _)| number)
        .collect();
    let computed = |what: &str| {
        html! {
            @if residual.is_empty() { "No computation of residual error is in these records." }
            @else { "The rates of chapter 7 " (cite_all(residual.iter().copied())) " are computed for it" (what) }
        }
    };
    let campaigns = dossier.pieces(|piece| matches!(piece, Piece::Bits(_) | Piece::Random(_)).then_some(piece));
    let campaigns: Vec<usize> = campaigns.map(|(number, _)| number).collect();
    vec![
        Assumption {
            what: "At most 1 000 SPDUs a second",
            clause: "11.4.7",
            support: html! { (computed("; monitored rates do not depend on it.")) " " (fastest(dossier)) },
            gap: "The cycle time in the field is set by the FS-Master and its user",
        },
        Assumption {
            what: "Bit error probability of 1E-2 at most, errors independent",
            clause: "11.4.7, Annex D",
            support: html! {
                (computed(", and at smaller and larger ones."))
                @if !campaigns.is_empty() { " What the product makes of falsified bits is in the campaigns of chapter 5 " (cite_all(campaigns)) }
            },
            gap: "The line in the field: EMC, cables and installation are tests of their own",
        },
        Assumption {
            what: "No storing element between FS-Master and FS-Device",
            clause: "11.4.8",
            support: cases_of(dossier, &["unintended repetition", "unacceptable delay", "insertion"]),
            gap: "Repeated and late SPDUs are detected within the counter alone; that nothing on the line keeps and delivers them is a matter of installation and of the safety manual",
        },
        Assumption {
            what: "One detected error in 10 h at most (PFH-Monitor)",
            clause: "Table 41, 11.4.7",
            support: computed(": undetected errors for each detected one, a tenth of that an hour."),
            gap: "The user has to be told by the safety manual, and to act on it",
        },
    ]
}

/// The cycle that the first run was made with, as far as it is declared.
fn fastest(dossier: &Dossier<'_>) -> Markup {
    let cycles = (0_usize..).zip(&dossier.run.header.duts).filter_map(|(number, dut)| {
        let (_, value) = dut.declared.iter().find(|(name, _)| name == "MasterCycleTime")?;
        Some((number, value))
    });
    html! {
        @for (number, value) in cycles.take(1) {
            "The product was run with a MasterCycleTime of " (short(value, TEXT))
            @if let Some(seat) = dossier.seats.get(number) { " " (cite(seat.source + 1)) } "."
        }
    }
}

/// What the cases of these error classes of the matrix came to.
fn cases_of(dossier: &Dossier<'_>, classes: &[&str]) -> Markup {
    let rows = dossier.run.header.matrix.iter().flat_map(|part| &part.rows);
    let rows = rows.filter(|row| classes.contains(&row.class.as_str()));
    let ids: BTreeSet<&str> =
        rows.flat_map(|row| &row.cells).flat_map(|cell| &cell.cases).map(String::as_str).collect();
    let counts = crate::html::counted(dossier.run.cases.iter().filter(|case| ids.contains(case.id.as_str())));
    html! {
        @if counts.is_empty() { "The error matrix is not in these records." }
        @else {
            "The cases of the error matrix about " (classes.join(", ")) ":"
            @for ((said, _), count) in counts { " " (said) " × " (count) } " " (cite_all(dossier.runs()))
        }
    }
}

fn readings(dossier: &Dossier<'_>) -> Markup {
    let used = &dossier.summary.tolerances;
    let in_force = &dossier.run.header.tolerances;
    html! {
        h3 { "Readings made use of" }
        p { "Where the standard is silent or contradicts itself another reading than the default is let pass: " (in_force.len()) " such readings were in force, the product made use of " (used.len()) "." }
        @if !used.is_empty() {
            table {
                thead { tr { th scope="col" { "Reading" } th scope="col" { "What is judged by, and what is let pass" } th.number scope="col" { "Cases" } } }
                @for (id, count) in used {
                    tr { th scope="row" { "● " (clean(id)) } td { (of(dossier, id)) } td.number { (count) } }
                }
            }
        }
        h3 { "Readings in force" }
        @if in_force.is_empty() { p { "None." } } @else {
            table.readings {
                thead { tr { th scope="col" { "Reading" } th scope="col" { "Stance" } th scope="col" { "What is judged by, and what is let pass" } } }
                @for (id, text) in in_force {
                    @let known = dossier.tool.readings.get(id);
                    tr {
                        th scope="row" { (clean(id)) }
                        td { (known.map_or("", |known| known.stance.as_str())) }
                        td { @match known { Some(_) => (of(dossier, id)), None => (short(text, TEXT)) } }
                    }
                }
            }
        }
    }
}

/// A reading by name and in full.
fn of(dossier: &Dossier<'_>, id: &str) -> Markup {
    html! {
        @match dossier.tool.readings.get(id) {
            Some(reading) => { b { (reading.name) } ". " (reading.text) }
            None => { "not known to this fsct" }
        }
    }
}
