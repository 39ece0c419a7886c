//! The table of a survey, and what the standard states beside it.

use super::{Found, Survey, name};
use fsct_residual::{BIT_ERROR, Properness, SHARE, Verdict};
use std::collections::BTreeMap;

/// What the figures rest on.
const ASSUMED: &str = "\
Assumed (11.4.7): binary symmetric channel; p = 1E-2 at most, where Rp is taken; 1000 SPDU/s at most; one detected error in 10 h, since
each trips the safety function and more call for maintenance (Table 41). `unmonitored` is Rp at 1000 SPDU/s, every one of them at p = 1E-2 and
no trip: not how a system goes on, and above 1E-9 /h. `monitored` is Rp for each detected error, one in 10 h; `share` is its part of the
1E-9 /h, 1 % of SIL 3, that a connection may have. The step from 0 to 1 is not in the figures. docs/residual.md says more.";

pub fn table(surveys: &[Survey]) -> String {
    let mut blocks: Vec<String> = surveys.iter().map(block).collect();
    blocks.push(ASSUMED.to_owned());
    blocks.join("\n\n")
}

fn block(survey: &Survey) -> String {
    let mut lines = vec![
        name(survey.code),
        format!(
            "{:>6} {:>8} {:>12} {:>13} {:>14} {:>13} {:>9}  highest Rp for p up to 0.5",
            "octets", "distance", "by words", "Rp(1E-2)", "unmonitored/h", "monitored/h", "share"
        ),
    ];
    lines.extend(survey.found.iter().map(row));
    lines.extend(stated(survey));
    lines.join("\n")
}

fn row(found: &Found) -> String {
    let weights = &found.weights;
    let (distance, words) = weights.distance();
    let monitored = weights.monitored_rate();
    format!(
        "{:>6} {distance:>8} {:>12} {:>13.6E} {:>14.2E} {monitored:>13.2E} {:>9}  {}",
        weights.octets(),
        words.to_string(),
        weights.residual(BIT_ERROR),
        weights.unmonitored_rate(),
        percent(monitored / SHARE),
        highest(found),
    )
}

/// With three digits.
fn percent(part: f64) -> String {
    let percent = 100.0 * part;
    if (0.01..1000.0).contains(&percent) { format!("{percent:.2} %") } else { format!("{percent:.1E} %") }
}

fn highest(Found { weights, properness, hump }: &Found) -> String {
    let width = weights.code().width();
    match (hump, properness) {
        (Some(hump), _) => format!(
            "{:.6E} at p = {:.4}, {} above 2^-{width}; above it from p = {:.4} on",
            hump.highest,
            hump.at,
            percent(hump.highest / weights.limit() - 1.0),
            hump.from
        ),
        (None, Properness::Proper) => "at p = 0.5: proper".to_owned(),
        (None, Properness::Falls(at)) => format!("not above 2^-{width}, but falls at p = {at:.4}"),
        (None, Properness::Undecided) => format!("not above 2^-{width}; whether it ever falls is not decided"),
    }
}

/// Each statement of the standard, and at which lengths it is true; the share for every code.
fn stated(survey: &Survey) -> Vec<String> {
    let by = |verdict: &dyn Fn(&Found) -> &'static str| {
        let mut at: BTreeMap<&str, Vec<usize>> = BTreeMap::new();
        survey.found.iter().for_each(|found| at.entry(verdict(found)).or_default().push(found.weights.octets()));
        at.iter().map(|(verdict, octets)| format!("{verdict} at {}", runs(octets))).collect::<Vec<_>>().join("; ")
    };
    let mut lines = Vec::new();
    if let Some(claim) = survey.code.claim() {
        let ((bits, distance), (octets, bound)) = (claim.distance, claim.residual);
        let of_distance = |found: &Found| claim.of_distance(&found.weights).name();
        let of_residual = |found: &Found| claim.of_residual(&found.weights).name();
        let of_properness = |found: &Found| match claim.of_properness(found.weights.octets(), found.properness) {
            Verdict::Broken => "stated, but false (a remark on the standard)",
            verdict => verdict.name(),
        };
        lines.extend([
            format!("distance {distance} at least up to {bits} bits (Table D.1): {}", by(&of_distance)),
            format!("Rp below {bound:E} for p up to 1E-2 up to {octets} octets (D.2): {}", by(&of_residual)),
            format!("proper up to {} octets (Table D.1): {}", claim.proper, by(&of_properness)),
        ]);
    }
    let share = |found: &Found| if found.weights.monitored_rate() < SHARE { "kept" } else { "not kept" };
    lines.push(format!("1 % of SIL 3, 1E-9 /h (11.4.7), monitored: {}", by(&share)));
    lines
}

/// `4 to 7, 11 octets`.
fn runs(octets: &[usize]) -> String {
    let mut runs: Vec<(usize, usize)> = Vec::new();
    for &octets in octets {
        match runs.last_mut() {
            Some((_, last)) if *last + 1 == octets => *last = octets,
            _ => runs.push((octets, octets)),
        }
    }
    let run = |(from, upto): &(usize, usize)| match upto - from {
        0 => from.to_string(),
        1 => format!("{from}, {upto}"),
        _ => format!("{from} to {upto}"),
    };
    runs.iter().map(run).collect::<Vec<_>>().join(", ") + " octets"
}
