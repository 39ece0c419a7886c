//! Simulation with fault injection: the error matrix of a run, and campaigns.

use super::noise;
use super::page::{NAME, absent, cite, cite_all, number};
use super::{Dossier, Gap, Kind, Piece, Section};
use crate::campaign::{Bits, Counts, Head, Noise, Random, Records};
use crate::matrix_html;
use crate::text::short;
use maud::{Markup, html};

/// Rows of a campaign shown.
const ROWS: usize = 160;
/// Octets of a finding shown.
const FOUND: usize = 8;

pub fn section(dossier: &Dossier<'_>) -> Section {
    let mut gaps = Vec::new();
    let bits: Vec<(usize, &Bits)> =
        dossier.pieces(|piece| if let Piece::Bits(one) = piece { Some(one) } else { None }).collect();
    let random: Vec<(usize, &Random)> =
        dossier.pieces(|piece| if let Piece::Random(one) = piece { Some(one) } else { None }).collect();
    let records: Vec<(usize, &Records)> =
        dossier.pieces(|piece| if let Piece::Records(one) = piece { Some(one) } else { None }).collect();
    let noise: Vec<(usize, &Noise)> =
        dossier.pieces(|piece| if let Piece::Noise(one) = piece { Some(one) } else { None }).collect();
    let mut missing = |is: bool, what: &str, command: &str| {
        let (markup, gap) = absent(what, command);
        if is {
            gaps.push(gap);
        }
        html! { @if is { (markup) } }
    };
    let device = dossier.product.role == "device";
    let no_matrix = missing(
        dossier.run.header.matrix.is_empty(),
        "the error matrix, every error class of Table 27 in every waiting state",
        "fsct run error-matrix --dut URL --out DIR",
    );
    let no_random = missing(
        random.is_empty(),
        "a campaign of random faults of all classes",
        "fsct campaign random --dut URL --out DIR",
    );
    let no_bits = missing(
        bits.is_empty(),
        "a campaign of every corruption of so many bits",
        "fsct campaign bits --dut URL --out DIR",
    );
    let no_records = missing(
        device && records.is_empty(),
        "a campaign on FSP_VerifyRecord",
        "fsct campaign record --dut URL --out DIR",
    );
    let no_noise = missing(
        noise.is_empty(),
        "a campaign of bits wrong by chance beside the exact residual error",
        "fsct campaign noise --dut URL --out DIR",
    );
    bits.iter().for_each(|(source, one)| gaps.extend(gaps_of_bits(*source, one)));
    random.iter().for_each(|(source, one)| gaps.extend(gaps_of_random(*source, one)));
    records.iter().for_each(|(source, one)| gaps.extend(gaps_of_records(*source, one)));
    noise.iter().for_each(|(source, one)| gaps.extend(noise::gaps(*source, one)));
    let body = html! {
        p {
            "Errors are brought in on the line between the product and a conformant partner, with the oracle on every exchange. "
            "“At most” is the upper bound, with 95 % confidence (Clopper-Pearson), of the fraction of such errors that go undetected, in states and with data "
            "like those of the campaign. “Valid” are falsified SPDUs that carry the right signature again, which no receiver can tell."
        }
        div.matrix {
            @if !dossier.run.header.matrix.is_empty() { p { "The error matrix is of the records " (cite_all(dossier.runs())) } }
            (matrix_html::section(&dossier.run, &dossier.summary)) (no_matrix)
        }
        h3 { "Random faults of all classes" }
        (no_random)
        @for (source, one) in &random { (random_of(*source, one)) }
        h3 { "Every corruption of so many bits" }
        (no_bits)
        @for (source, one) in &bits { (bits_of(*source, one)) }
        h3 { "Bits wrong by chance" }
        (no_noise)
        @for (source, one) in &noise { (told(*source, &one.head)) (noise::shown(one)) }
        @if device {
            h3 { "Every corruption of FSP_VerifyRecord" }
            (no_records)
            @for (source, one) in &records { (records_of(*source, one)) }
        }
    };
    Section { body, gaps }
}

fn gaps_of_bits(source: usize, one: &Bits) -> Vec<Gap> {
    let mut gaps = Vec::new();
    if !one.undetected.is_empty() {
        gaps.push(Gap::new(
            Kind::Failure,
            format!("{} corrupted SPDUs were not detected, record [{source}]", one.undetected.len()),
        ));
    }
    if one.rows.iter().any(|row| !row.complete) {
        gaps.push(Gap::closed_by(
            Kind::Inconclusive,
            format!("The campaign of record [{source}] did not try all corruptions it began with"),
            "fsct campaign bits --dut URL --out DIR",
        ));
    }
    if one.had_to_be_detected == 0 {
        gaps.push(Gap::new(
            Kind::Inconclusive,
            format!("The campaign of record [{source}] brought nothing in that has to be detected"),
        ));
    }
    gaps
}

fn gaps_of_random(source: usize, one: &Random) -> Vec<Gap> {
    let mut gaps = Vec::new();
    if one.undetected > 0 {
        gaps.push(Gap::new(
            Kind::Failure,
            format!("A fault of the random campaign was not dealt with as the tables ask, record [{source}]"),
        ));
    } else if !one.complete {
        gaps.push(Gap::closed_by(
            Kind::Inconclusive,
            format!("The random campaign of record [{source}] did not come to its end"),
            "fsct campaign random --dut URL --out DIR",
        ));
    }
    if one.had_to_be_detected == 0 {
        gaps.push(Gap::new(
            Kind::Inconclusive,
            format!("The campaign of record [{source}] brought nothing in that has to be detected"),
        ));
    }
    gaps
}

fn gaps_of_records(source: usize, one: &Records) -> Vec<Gap> {
    let started = one.rows.iter().filter(|row| row.failed.is_some()).count();
    let mut gaps = Vec::new();
    if started > 0 {
        gaps.push(Gap::new(
            Kind::Failure,
            format!("A falsified FSP_VerifyRecord started the safety communication layer, record [{source}]"),
        ));
    } else if !one.complete || one.rows.iter().all(|row| row.records == 0) {
        gaps.push(Gap::closed_by(
            Kind::Inconclusive,
            format!("The campaign on FSP_VerifyRecord of record [{source}] did not come to its end"),
            "fsct campaign record --dut URL --out DIR",
        ));
    }
    gaps
}

fn told(source: usize, head: &Head) -> Markup {
    html! { "Record " (cite(source)) ", seed " (head.seed) ", profile " (short(&head.dut.profile, NAME)) ". " }
}

fn random_of(source: usize, one: &Random) -> Markup {
    let mut sum = Counts::default();
    one.faults.values().for_each(|counts| sum.add(*counts));
    html! {
        p {
            (told(source, &one.head)) (number(one.exchanges)) " exchanges over " (number(one.episodes)) " starts. "
            @if one.undetected == 0 && one.complete { "✓ " (number(one.had_to_be_detected)) " faults had to be detected, and were." }
            @else if one.undetected > 0 { "✗ " (one.undetected) " of " (number(one.had_to_be_detected)) " faults that had to be detected was not dealt with; it ended there." }
            @else { "? It did not come to its end." }
            " At most " (small(one.undetected_fraction_at_most_95)) "."
        }
        table {
            thead { (head("Fault", "")) }
            @for (class, counts) in one.faults.iter().take(ROWS) { tr { th scope="row" { (short(class, NAME)) } (counted(*counts)) } }
            tr.sum { th scope="row" { "all" } (counted(sum)) }
        }
    }
}

fn bits_of(source: usize, one: &Bits) -> Markup {
    html! {
        p {
            (told(source, &one.head))
            @if one.undetected.is_empty() { "✓ " (number(one.had_to_be_detected)) " corruptions had to be detected, none was undetected." }
            @else { "✗ " (one.undetected.len()) " undetected: " @for octets in one.undetected.iter().take(FOUND) { code { (short(octets, NAME)) } " " } }
            " At most " (small(one.undetected_fraction_at_most_95)) "."
        }
        table {
            thead { (head("Edition, mode, octets of the SPDU, bits", "At most")) }
            @for row in one.rows.iter().take(ROWS) {
                tr {
                    th scope="row" { (short(&row.edition, NAME)) " " (short(&row.mode, NAME)) ", " (row.length) " octets, " (short(&row.bits, NAME)) @if !row.complete { " ? not all" } }
                    (counted(row.counts)) td.number { (small(row.undetected_fraction_at_most_95)) }
                }
            }
        }
        @if one.rows.len() > ROWS { p.soft { (one.rows.len() - ROWS) " more rows are in the record." } }
    }
}

fn records_of(source: usize, one: &Records) -> Markup {
    let all: u64 = one.rows.iter().map(|row| row.records).sum();
    html! {
        p {
            (told(source, &one.head)) "Each falsified record is written at a start-up of an armed FS-Device. "
            @if one.rows.iter().any(|row| row.failed.is_some()) { "✗ One of them started the safety communication layer." }
            @else if one.complete && all > 0 { "✓ " (number(all)) " falsified records, none started it; the right one does." }
            @else { "? It did not come to its end." }
        }
        table {
            thead { tr { th scope="col" { "Variant" } th.number scope="col" { "Records" } th.number scope="col" { "Refused" } th scope="col" { "Started it" } } }
            @for row in one.rows.iter().take(ROWS) {
                tr { th scope="row" { (short(&row.variant, NAME)) } td.number { (number(row.records)) } td.number { (number(row.refused)) } td { @match &row.failed { None => "none", Some(octets) => { "✗ " code { (short(octets, NAME)) } } } } }
            }
        }
    }
}

fn head(first: &str, last: &str) -> Markup {
    html! {
        tr {
            th scope="col" { (first) }
            @for name in ["Injected", "Detected", "Ignored", "Valid", "Failed"] { th.number scope="col" { (name) } }
            @if !last.is_empty() { th.number scope="col" { (last) } }
        }
    }
}

fn counted(counts: Counts) -> Markup {
    let Counts { injected, detected, dropped, valid, failed } = counts;
    html! { @for count in [injected, detected, dropped, valid, failed] { td.number { (number(count)) } } }
}

/// `3.0E-4`.
fn small(value: f64) -> String {
    format!("{value:.1E}")
}
