//! The part of `report.html` on the error matrix.

use crate::decode::Side;
use crate::html::{LISTED, NAME, counted, role, together};
use crate::journal::Run;
use crate::record::{CaseRecord, MatrixCell, MatrixInfo};
use crate::summary::Summary;
use crate::text::short;
use maud::{Markup, html};
use std::collections::BTreeMap;

/// What became of each cell of the error matrix: its cases with the verdicts they came to, or why it has none.
pub fn section(run: &Run, summary: &Summary) -> Markup {
    html! {
        @if !run.header.matrix.is_empty() {
            h2 { "Error matrix" }
            p { "Every error class of Table 27 in every waiting state, on the way to the DUT and on the way from it." }
            @for part in &run.header.matrix { (matrix_of(part, run, summary)) }
        }
    }
}

fn matrix_of(part: &MatrixInfo, run: &Run, summary: &Summary) -> Markup {
    let mut reasons: Vec<&str> = Vec::new();
    let nones = part.rows.iter().flat_map(|row| &row.cells).map(|cell| cell.none.as_str());
    nones.filter(|none| !none.is_empty()).for_each(|none| {
        if !reasons.contains(&none) {
            reasons.push(none);
        }
    });
    let name = role(&part.role);
    let mut ran: BTreeMap<&str, Vec<&CaseRecord>> = BTreeMap::new();
    let of_role = run.cases.iter().filter(|case| case.role == part.role);
    of_role.for_each(|case| ran.entry(&case.id).or_default().push(case));
    html! {
        h3 { (name) (together(Side::of(&part.role), summary)) }
        div.scroll tabindex="0" role="group" aria-label={ "Error matrix of the " (name) } {
            table.matrix {
                thead { tr { th scope="col" { "Error" } @for column in part.columns.iter().take(LISTED) { th scope="col" { (short(column, NAME)) } } } }
                @for row in part.rows.iter().take(LISTED) {
                    tr {
                        th scope="row" { (short(&row.class, NAME)) }
                        @for cell in row.cells.iter().take(LISTED) { td { (matrix_cell(cell, &ran, &reasons)) } }
                    }
                }
            }
        }
        @if !reasons.is_empty() { ol.soft { @for reason in reasons.iter().take(LISTED) { li { (short(reason, 2 * NAME)) } } } }
    }
}

fn matrix_cell(cell: &MatrixCell, ran: &BTreeMap<&str, Vec<&CaseRecord>>, reasons: &[&str]) -> Markup {
    html! {
        @for id in cell.cases.iter().take(LISTED) {
            @let counts = counted(ran.get(id.as_str()).into_iter().flatten().copied());
            div {
                (short(id, NAME))
                @if counts.is_empty() { " " span.soft { "not run" } }
                @for ((said, class), count) in &counts { " " span class=(class) { (said) " × " (count) } }
            }
        }
        @if let Some(number) = reasons.iter().position(|reason| *reason == cell.none) {
            span.soft { "none, see " (number + 1) }
        }
    }
}
