//! The product in its own words, how it was reached, and what it declares.

use super::page::{NAME, TEXT, cite};
use super::{Dossier, Gap, Kind, Section};
use crate::html::role;
use crate::record::DutInfo;
use crate::text::short;
use maud::{Markup, html};

/// DUTs shown.
const SHOWN: usize = 12;

/// The product in one line.
pub fn name(dossier: &Dossier<'_>) -> String {
    let product = &dossier.product;
    let words = [&product.vendor, &product.product, &product.version].map(|text| short(text, NAME));
    let said = words.into_iter().filter(|text| !text.is_empty()).collect::<Vec<_>>().join(" ");
    if said.is_empty() { format!("an {} without a name", role(&product.role)) } else { said }
}

pub fn section(dossier: &Dossier<'_>) -> Section {
    let duts = &dossier.run.header.duts;
    let mut gaps = vec![Gap::new(
        Kind::Elsewhere,
        "Product, maker and version are what the product says of itself; nothing ties them to the sample that was tested",
    )];
    for (number, dut) in (1..).zip(duts).filter(|(_, dut)| dut.clock.is_empty()) {
        gaps.push(Gap::closed_by(
            Kind::Inconclusive,
            format!("DUT {number} at {} was not reached; its cases are counted as not executed", short(&dut.url, NAME)),
            "fsct doctor --dut URL",
        ));
    }
    for (number, dut) in (1..).zip(duts).filter(|(_, dut)| dut.clock == "recorded") {
        gaps.push(Gap::new(
            Kind::Elsewhere,
            format!(
                "DUT {number} is a recording ({}); that it was taken from this product is the word of whoever took it",
                short(&dut.url, NAME)
            ),
        ));
    }
    if duts.iter().all(|dut| dut.url.starts_with("inproc:")) {
        gaps.push(Gap::new(
            Kind::Elsewhere,
            "What was judged is a program in the process of fsct: no hardware, no line and no clock of a product had a part in it",
        ));
    } else if duts.iter().all(|dut| dut.clock == "virtual") {
        gaps.push(Gap::new(
            Kind::Elsewhere,
            "The clock of the DUT is virtual: what real hardware does with time is not shown",
        ));
    }
    Section { body: body(dossier, duts), gaps }
}

fn body(dossier: &Dossier<'_>, duts: &[DutInfo]) -> Markup {
    html! {
        p { "The " (role(&dossier.product.role)) " as it named itself when it was reached, and the profile (PICS and PIXIT) it was judged by." }
        @for ((number, dut), seat) in (1..).zip(duts).zip(&dossier.seats).take(SHOWN) {
            h3 { "DUT " (number) " " (cite(seat.source + 1)) }
            (facts(dut))
        }
        @if duts.len() > SHOWN { p.soft { (duts.len() - SHOWN) " more DUTs of the same product are in the records." } }
        @if let Some(table) = others(dossier) {
            h3 { "Records about others" }
            p { "Given with the records of the product and named here alone; nothing in this dossier rests on them." }
            (table)
        }
    }
}

fn facts(dut: &DutInfo) -> Markup {
    let or = |text: &str, none: &str| if text.is_empty() { none.to_owned() } else { short(text, TEXT) };
    html! {
        table.facts {
            tr { th scope="row" { "Maker, product, version" } td { (or(&dut.vendor, "not told")) " · " (or(&dut.product, "not told")) " · " (or(&dut.version, "not told")) } }
            tr { th scope="row" { "Address" } td { code { (short(&dut.url, TEXT)) } } }
            tr { th scope="row" { "Offers" } td { @if dut.offers.is_empty() { "not told" } @for offer in dut.offers.iter().take(SHOWN) { div { (short(offer, NAME)) } } } }
            tr { th scope="row" { "Serves" } td { (or(&dut.pcos.join(", "), "not told")) } }
            tr { th scope="row" { "Clock" } td { (or(&dut.clock, "not reached")) ", resolution " (dut.resolution_ns) " ns, uncertainty ± " (dut.uncertainty_ns) " ns" @if let Some(proof) = &dut.clock_proof { "; " (short(&proof.said(), TEXT)) } } }
            tr { th scope="row" { "Profile" } td { (or(&dut.profile, "not told")) } }
            @for (name, value) in dut.declared.iter().take(SHOWN * 4) {
                tr { th scope="row" { (short(name, NAME)) } td { (short(value, TEXT)) } }
            }
        }
    }
}

/// DUTs of the records that are not the product.
fn others(dossier: &Dossier<'_>) -> Option<Markup> {
    let others = (1..).zip(&dossier.sources).flat_map(|(number, source)| {
        super::assembly::duts(source).iter().filter(|dut| !dossier.is_product(dut)).map(move |dut| (number, dut))
    });
    let others: Vec<_> = others.take(SHOWN).collect();
    (!others.is_empty()).then(|| html! {
        table {
            thead { tr { th scope="col" { "Record" } th scope="col" { "Role" } th scope="col" { "Product" } th scope="col" { "Address" } } }
            @for (number, dut) in others {
                tr { td { (cite(number)) } td { (role(&dut.role)) } td { (short(&dut.vendor, NAME)) " " (short(&dut.product, NAME)) " " (short(&dut.version, NAME)) } td { code { (short(&dut.url, NAME)) } } }
            }
        }
    })
}
