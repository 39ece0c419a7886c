//! Residual error rates, as `fsct crc --residual` computed them.

use super::document::{Code, Length, Residual};
use super::page::{NAME, absent, cite};
use super::{Dossier, Gap, Kind, Piece, Section};
use crate::plot::{Bound, Curve, Plot, plots};
use crate::text::short;
use fsct_protocol::ProtMode;
use maud::{Markup, html};
use std::collections::BTreeSet;
use std::fmt::Write as _;

const COMMAND: &str = "fsct crc --residual --json > DIR/residual.json";
/// The longest table of lengths.
const LENGTHS: usize = 64;

pub fn section(dossier: &Dossier<'_>) -> Section {
    let found: Vec<(usize, &Residual)> =
        dossier.pieces(|piece| if let Piece::Residual(one) = piece { Some(one) } else { None }).collect();
    let mut gaps = Vec::new();
    let (nothing, gap) = absent("the residual error of the signatures", COMMAND);
    if found.is_empty() {
        gaps.push(gap);
    }
    for mode in [ProtMode::Crc16, ProtMode::Crc32].into_iter().filter(|_| !found.is_empty()) {
        let there = |octets: u64| {
            let mut codes = found.iter().flat_map(|(_, one)| &one.codes);
            codes.any(|code| mode_of(code) == Some(mode) && code.lengths.iter().any(|one| one.octets == octets))
        };
        let lacking: Vec<String> = used(dossier)
            .into_iter()
            .filter(|(used, octets)| *used == mode && !there(*octets))
            .map(|(_, octets)| octets.to_string())
            .collect();
        if !lacking.is_empty() {
            let lacking = lacking.join(", ");
            gaps.push(Gap::closed_by(
                Kind::NotRun,
                format!("The product was run with {mode} and SPDUs of {lacking} octets, for which no residual error is in these records"),
                format!("fsct crc --residual --mode {mode} --json > DIR/residual.json"),
            ));
        }
    }
    gaps.extend(found.iter().flat_map(|(_, one)| &one.codes).flat_map(broken));
    let body = html! {
        p {
            "The probability Rp that errors turn an SPDU into another one that is accepted, from the exact number of code words of each weight. "
            "Lengths are those of the word with its signature; ■ marks those the product was run with. Words longer than an SPDU can be are parameter blocks; hourly figures are for SPDUs."
        }
        @if found.is_empty() { (nothing) }
        @for (source, one) in &found { (rates(*source, one, &used(dossier))) }
    };
    Section { body, gaps }
}

/// Mode and length of every SPDU the cases of the product used, both ways.
fn used(dossier: &Dossier<'_>) -> BTreeSet<(ProtMode, u64)> {
    let lengths = dossier.run.cases.iter().filter_map(|case| {
        let mode: ProtMode = case.variant.mode.parse().ok()?;
        Some([case.variant.pd_out, case.variant.pd_in].map(|octets| (mode, mode.spdu_octets(octets.into()) as u64)))
    });
    lengths.flatten().collect()
}

/// The mode that a code serves.
fn mode_of(code: &Code) -> Option<ProtMode> {
    [ProtMode::Crc16, ProtMode::Crc32].into_iter().find(|mode| 8 * mode.signature_octets() == code.width as usize)
}

/// What Annex D states and is not so: a remark on the standard.
fn broken(code: &Code) -> Vec<Gap> {
    let of = |pick: fn(&super::document::Verdicts) -> &String| {
        let lengths =
            code.lengths.iter().filter(|one| one.verdicts.as_ref().is_some_and(|verdicts| pick(verdicts) == BROKEN));
        lengths.map(|one| one.octets.to_string()).collect::<Vec<_>>()
    };
    let said = [
        ("the Hamming distance", of(|one| &one.distance)),
        ("the bound on Rp", of(|one| &one.residual)),
        ("properness", of(|one| &one.proper)),
    ];
    let said = said.into_iter().filter(|(_, lengths)| !lengths.is_empty());
    said.map(|(what, lengths)| {
        let lengths = lengths.join(", ");
        Gap::new(Kind::Reading, format!("Annex D states {what} of CRC-{} at {lengths} octets, and it is not so; a remark on the standard, which no product can help", code.width))
    })
    .collect()
}

/// How `fsct crc --residual` names a statement that is not true.
const BROKEN: &str = "stated, but false";

fn rates(source: usize, one: &Residual, used: &BTreeSet<(ProtMode, u64)>) -> Markup {
    let assumed = &one.assumed;
    html! {
        p {
            "Record " (cite(source)) ". Assumed: bit error probability " (small(assumed.bit_error_probability)) ", " (assumed.spdus_per_hour / 3600.0) " SPDUs a second, one detected error in "
            (assumed.hours_per_detected_error) " h; a logical connection may have " (small(assumed.share_per_hour)) " undetected errors an hour (1 % of SIL 3)."
        }
        @for code in &one.codes {
            h3 { "CRC-" (code.width) ", polynomial " (short(&code.polynomial, NAME)) }
            table.residual {
                thead {
                    tr {
                        th.number scope="col" { "Octets" } th.number scope="col" { "Distance" } th.number scope="col" { "Rp at " (small(assumed.bit_error_probability)) }
                        th.number scope="col" { "An hour, monitored" } th.number scope="col" { "Of the share" } th.number scope="col" { "An hour, not monitored" }
                        th scope="col" { "Proper" } th scope="col" { "Stated: distance, Rp, proper" }
                    }
                }
                @for length in code.lengths.iter().take(LENGTHS) { (row(length, code, one, used)) }
            }
            div.figure { (drawn(code)) }
        }
    }
}

fn row(length: &Length, code: &Code, one: &Residual, used: &BTreeSet<(ProtMode, u64)>) -> Markup {
    let at = one.assumed.bit_error_probability;
    let rp = length.residual.iter().find(|(p, _)| (p - at).abs() < at * 1e-9).map(|(_, rp)| *rp);
    let used = mode_of(code).is_some_and(|mode| used.contains(&(mode, length.octets)));
    // A longer word is a parameter block, which is not sent in every cycle.
    let is_spdu = mode_of(code).is_none_or(|mode| length.octets <= mode.spdu_octets(mode.max_pd()) as u64);
    let hourly = |said: String| if is_spdu { said } else { "–".to_owned() };
    let share = length.monitored_per_hour / one.assumed.share_per_hour * 100.0;
    html! {
        tr {
            th.number scope="row" { @if used { "■ " } (length.octets) }
            td.number { (length.distance) }
            td.number { @match rp { Some(rp) => (small(rp)), None => "–" } }
            td.number { (hourly(small(length.monitored_per_hour))) }
            td.number { (hourly(format!("{share:.2} %"))) }
            td.number { (hourly(small(length.unmonitored_per_hour))) }
            td { @match length.proper { Some(true) => "yes", Some(false) => "no", None => "undecided" } }
            td { @match &length.verdicts { None => "–", Some(said) => { (short(&said.distance, NAME)) ", " (short(&said.residual, NAME)) ", " (short(&said.proper, NAME)) } } }
        }
    }
}

/// The curves through the bit error probabilities of the record, as an image of its own so that its style stays with it.
fn drawn(code: &Code) -> Markup {
    let limit = (-f64::from(code.width)).exp2();
    let highest = 10f64.powf(limit.log10().ceil() + 1.0);
    let bounds = [Bound { label: format!("2^-{}", code.width), level: limit, upto: 0.5 }];
    let stated = code.stated.iter().map(|stated| Bound {
        label: format!("D.2: below {:E} up to {} octets", stated.residual.below, stated.residual.octets),
        level: stated.residual.below,
        upto: 1e-2,
    });
    let curve = |one: &Length| Curve {
        number: one.octets.to_string(),
        about: format!("{} octets", one.octets),
        points: one.residual.clone(),
        mark: None,
    };
    let plot = Plot {
        title: format!("CRC-{}: residual error probability", code.width),
        axes: ("bit error probability".to_owned(), "Rp; a number is the octets of a word".to_owned()),
        x: (1e-5, 0.5),
        y: (highest * 1e-16, highest),
        curves: code.lengths.iter().take(LENGTHS).map(curve).collect(),
        bounds: bounds.into_iter().chain(stated).collect(),
        measured: Vec::new(),
    };
    let alt = format!("Residual error probability of CRC-{} over the bit error probability", code.width);
    html! { img.plot alt=(alt) src=(format!("data:image/svg+xml,{}", escaped(&plots(&[plot])))); }
}

/// An address may not hold everything an image does.
fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len() * 3 / 2);
    for octet in text.bytes() {
        match octet {
            b'a'..=b'z' | b'A'..=b'Z' | b'0'..=b'9' | b'-' | b'.' | b' ' => out.push(octet.into()),
            _ => drop(write!(out, "%{octet:02X}")),
        }
    }
    out
}

/// `7.014E-10`.
fn small(value: f64) -> String {
    format!("{value:.3E}").replace(".000E", "E")
}
