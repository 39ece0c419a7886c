//! The residual error as it was measured, beside the exact one.

use super::page::{NAME, number};
use super::{Gap, Kind};
use crate::campaign::Noise;
use crate::text::short;
use maud::{Markup, html};

/// Rows shown.
const ROWS: usize = 60;

/// What a campaign leaves open.
pub fn gaps(source: usize, one: &Noise) -> Vec<Gap> {
    let undetected: u64 = one.rows.iter().map(|row| row.undetected).sum();
    let outside = one.rows.iter().filter(|row| !row.agrees()).count();
    let mut gaps = Vec::new();
    if one.failed.is_some() {
        let what = format!("A noisy SPDU was not judged by its signature, record [{source}]");
        gaps.push(Gap::new(Kind::Failure, what));
    }
    if outside > 0 {
        let what = format!("{outside} exact values lie outside the interval of what was measured, record [{source}]");
        gaps.push(Gap::closed_by(Kind::Inconclusive, what, "fsct campaign noise --seed 2 --dut URL --out DIR"));
    }
    if undetected == 0 {
        let what = format!("The campaign of record [{source}] saw no undetected SPDU, so it measured nothing");
        gaps.push(Gap::closed_by(Kind::Inconclusive, what, "fsct campaign noise --dut URL --out DIR"));
    }
    gaps
}

/// The table.
pub fn shown(one: &Noise) -> Markup {
    html! {
        p {
            "Each bit is wrong with the probability p; PortNum, counter and flags arrive as expected, so that CRC-16 alone decides. "
            @match &one.failed {
                None => "✓ Every SPDU was judged by its signature.",
                Some(found) => { "✗ " (short(found, 2 * NAME)) }
            }
            " Undetected are those that carry a right signature again by chance; the interval holds the true fraction with "
            (100.0 * one.confidence) " % confidence (Clopper-Pearson)."
        }
        table {
            thead { tr {
                @for name in ["Octets", "p", "SPDUs", "Undetected", "Measured", "Interval", "Exact"] { th.number scope="col" { (name) } }
                th scope="col" { "Agrees" }
            } }
            @for row in one.rows.iter().take(ROWS) {
                tr {
                    td.number { (row.octets) } td.number { (row.bit_error_probability) } td.number { (number(row.spdus)) }
                    td.number { (number(row.undetected)) } td.number { (format!("{:.2E}", row.measured)) }
                    td.number { (format!("{:.2E} to {:.2E}", row.interval.0, row.interval.1)) }
                    td.number { (format!("{:.3E}", row.exact)) } td { @if row.agrees() { "✓" } @else { "? outside" } }
                }
            }
        }
    }
}
