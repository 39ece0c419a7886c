//! The table of a survey, and what the standard states beside it.

use super::{Found, Survey, name};
use fsct_residual::{BIT_ERROR, Properness, SHARE};
use std::collections::BTreeMap;

/// What the figures rest on.
const ASSUMED: &str = "\
Rates are undetected errors an hour at the worst bit error probability p up to 1E-2 (11.4.7; binary symmetric channel):
  at 1000/s  1000 SPDU/s, the most there may be, without a trip at detected errors: no system goes on like that
  monitored  one detected error in 10 h, each of which trips (11.4.7, Table 41): Rp / detected / 10 h, our formula; share is its part
             of the 1E-9 /h that a connection may have, 1 % of SIL 3
  block      a parameter block, sent once a day (11.5.6.2)
The step from 0 to 1 is not in the figures. What is stated and false is a remark on the standard, no fault of a product.";

pub fn table(surveys: &[Survey]) -> String {
    let mut blocks: Vec<String> = surveys.iter().map(block).collect();
    blocks.push(ASSUMED.to_owned());
    blocks.join("\n\n")
}

fn block(survey: &Survey) -> String {
    let mut lines = vec![
        name(survey.code),
        format!(
            "{:>6} {:>8} {:>10} {:>13} {:>9} {:>9} {:>9} {:>9}  highest Rp for p up to 0.5",
            "octets", "distance", "by words", "Rp(1E-2)", "at 1000/s", "monitored", "share", "block"
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
        "{:>6} {distance:>8} {:>10} {:>13.6E} {:>9.2E} {monitored:>9.2E} {:>9} {:>9.2E}  {}",
        weights.octets(),
        words.to_string(),
        weights.residual(BIT_ERROR),
        weights.unmonitored_rate(),
        percent(monitored / SHARE),
        weights.block_rate(),
        highest(found),
    )
}

fn percent(part: f64) -> String {
    let percent = 100.0 * part;
    if (0.1..1000.0).contains(&percent) { format!("{percent:.1} %") } else { format!("{percent:.1E} %") }
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
        let of_properness = |found: &Found| claim.of_properness(found.weights.octets(), found.properness).name();
        lines.extend([
            format!("distance {distance} at least up to {bits} bits (Table D.1): {}", by(&of_distance)),
            format!("Rp below {bound:E} for p up to 1E-2 up to {octets} octets (D.2): {}", by(&of_residual)),
            format!("proper up to {} octets (Table D.1): {}", claim.proper, by(&of_properness)),
        ]);
    }
    let kept = |rate: f64| if rate < SHARE { "kept" } else { "not kept" };
    lines.push(format!("1E-9 /h by SPDUs, monitored (11.4.7): {}", by(&|found| kept(found.weights.monitored_rate()))));
    lines.push(format!("1E-9 /h by a block once a day: {}", by(&|found| kept(found.weights.block_rate()))));
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
