//! Which product a dossier is about, and everything the records say of it put together. One product a dossier: an assessor
//! signs for one.

use super::CHAPTERS;
use super::page::filled;
use super::source::{Piece, Source};
use super::tool::Tool;
use super::trace::Trace;
use crate::journal::Run;
use crate::record::{CaseRecord, CompleteInfo, DutInfo, Footer, Header, SCHEMA};
use crate::summary::Summary;
use crate::text::short;
use std::collections::BTreeSet;

/// Characters of a name in a sentence.
const NAME: usize = 80;

/// What a product calls itself.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Identity {
    /// `device` or `master`.
    pub role: String,
    /// Maker.
    pub vendor: String,
    /// Product.
    pub product: String,
    /// Versions.
    pub version: String,
}

impl Identity {
    /// That of a DUT which told it; a recording of lines tells none, nor does a DUT that was not reached.
    fn of(dut: &DutInfo) -> Option<Identity> {
        let text = |text: &String| text.clone();
        matches!(dut.clock.as_str(), "virtual" | "real").then(|| Identity {
            role: text(&dut.role),
            vendor: text(&dut.vendor),
            product: text(&dut.product),
            version: text(&dut.version),
        })
    }

    fn said(&self) -> String {
        format!("`{} {}` ({})", short(&self.product, NAME), short(&self.version, NAME), short(&self.role, NAME))
    }
}

/// Why records make no dossier.
#[derive(Debug, thiserror::Error)]
pub enum AssemblyError {
    /// Nothing was run.
    #[error("none of these records is one of `fsct run`; a dossier begins with `fsct run --dut URL --out DIR`")]
    NoRun,
    /// No DUT told what it is.
    #[error(
        "no record{role} is of a DUT that was reached, so nothing names the product; run it again with `fsct run --dut URL --out DIR`"
    )]
    Nobody {
        /// ` of a device`, when that was asked for.
        role: String,
    },
    /// Both sides of a link.
    #[error(
        "these records are about {products}; a dossier is about one product: add `--role device` or `--role master`"
    )]
    Roles {
        /// What they call themselves.
        products: String,
    },
    /// Several products of one role.
    #[error("these records are about {products}; a dossier is about one product: give the records of one")]
    Products {
        /// What they call themselves.
        products: String,
    },
}

/// A DUT of the product with the record it stands in.
#[derive(Copy, Clone, Debug)]
pub struct Seat {
    /// Number of the source, from 0.
    pub source: usize,
    /// Number of the DUT in that record, from 0.
    pub dut: usize,
}

/// Everything there is to print.
#[derive(Debug)]
pub struct Dossier<'t> {
    /// What made it.
    pub tool: &'t Tool,
    /// Its records; a number in brackets is a place in this list, from 1.
    pub sources: Vec<Source>,
    /// The product.
    pub product: Identity,
    /// Where each DUT of [`Dossier::run`] comes from.
    pub seats: Vec<Seat>,
    /// All runs of the product as one, without traces.
    pub run: Run,
    /// The same in numbers.
    pub summary: Summary,
    /// Editions its cases ran in, and those it offers.
    pub editions: BTreeSet<String>,
    /// Statements and cases, both ways.
    pub trace: Trace,
    /// What the user wants printed beside the title, such as a date.
    pub dated: Option<String>,
}

impl<'t> Dossier<'t> {
    /// Puts records together; `role` chooses a side where records hold both.
    ///
    /// # Errors
    /// [`AssemblyError`].
    pub fn assemble(
        tool: &'t Tool,
        sources: Vec<Source>,
        role: Option<&str>,
        dated: Option<String>,
    ) -> Result<Dossier<'t>, AssemblyError> {
        let product = product(&sources, role)?;
        let (run, seats) = together(tool, &sources, &product);
        let summary = Summary::of(&run);
        let editions = editions(&run);
        let trace = Trace::of(tool, &product.role, &editions, &run);
        Ok(Dossier { tool, sources, product, seats, run, summary, editions, trace, dated })
    }

    /// Pieces of one kind about the product or about no product, with the number of their record, from 1.
    pub fn pieces<'d, T: 'd>(
        &'d self,
        of: impl Fn(&'d Piece) -> Option<&'d T> + 'd,
    ) -> impl Iterator<Item = (usize, &'d T)> {
        (1..)
            .zip(&self.sources)
            .filter(|(_, source)| self.concerns(source))
            .filter_map(move |(number, source)| Some((number, of(&source.piece)?)))
    }

    /// Whether a record is about the product, or about no product at all.
    pub fn concerns(&self, source: &Source) -> bool {
        let duts = duts(source);
        duts.is_empty() || duts.iter().any(|dut| self.is_product(dut))
    }

    /// Whether a DUT is the product. One that told nothing of itself is taken for it when it has the role.
    pub fn is_product(&self, dut: &DutInfo) -> bool {
        belongs(dut, &self.product)
    }

    /// Product, records and gaps in one line.
    pub fn told(&self) -> String {
        let gaps: usize = CHAPTERS.iter().map(|chapter| filled(*chapter, self).gaps.len()).sum();
        format!("{}: {} records, {} cases, {gaps} gaps", self.product.said(), self.sources.len(), self.summary.cases)
    }

    /// The numbers, from 1, of the records that hold runs of the product.
    pub fn runs(&self) -> BTreeSet<usize> {
        self.seats.iter().map(|seat| seat.source + 1).collect()
    }
}

fn belongs(dut: &DutInfo, product: &Identity) -> bool {
    Identity::of(dut).map_or(dut.role == product.role, |identity| identity == *product)
}

/// The DUTs a record is about.
pub fn duts(source: &Source) -> &[DutInfo] {
    match &source.piece {
        Piece::Run(run) => &run.header.duts,
        Piece::Bits(bits) => std::slice::from_ref(&bits.head.dut),
        Piece::Random(random) => std::slice::from_ref(&random.head.dut),
        Piece::Records(records) => std::slice::from_ref(&records.head.dut),
        Piece::Noise(noise) => std::slice::from_ref(&noise.head.dut),
        Piece::Gauntlet(_) | Piece::Proof(_) | Piece::Residual(_) => &[],
    }
}

fn product(sources: &[Source], role: Option<&str>) -> Result<Identity, AssemblyError> {
    if !sources.iter().any(|source| matches!(source.piece, Piece::Run(_))) {
        return Err(AssemblyError::NoRun);
    }
    let found: BTreeSet<Identity> = sources.iter().flat_map(duts).filter_map(Identity::of).collect();
    let chosen: Vec<&Identity> = found.iter().filter(|one| role.is_none_or(|role| one.role == role)).collect();
    let in_a_run = |one: &Identity| {
        let runs = sources.iter().filter(|source| matches!(source.piece, Piece::Run(_)));
        runs.flat_map(duts).any(|dut| Identity::of(dut).as_ref() == Some(one))
    };
    match chosen.as_slice() {
        [] => Err(AssemblyError::Nobody { role: role.map_or_else(String::new, |role| format!(" of a {role}")) }),
        [one] if in_a_run(one) => Ok((*one).clone()),
        [_] => Err(AssemblyError::NoRun),
        several => {
            let products = several.iter().take(4).map(|one| one.said()).collect::<Vec<_>>().join(" and ");
            let roles: BTreeSet<&str> = several.iter().map(|one| one.role.as_str()).collect();
            let one_each = roles.len() == several.len();
            Err(if one_each { AssemblyError::Roles { products } } else { AssemblyError::Products { products } })
        }
    }
}

/// All runs of the product as one. A case says by the number of its DUT which record it comes from.
fn together(tool: &Tool, sources: &[Source], product: &Identity) -> (Run, Vec<Seat>) {
    let mut header = Header {
        schema: SCHEMA.to_owned(),
        fsct: tool.version.clone(),
        seed: 0,
        duts: Vec::new(),
        planned: 0,
        not_applicable: Vec::new(),
        tolerances: Default::default(),
        machines: Vec::new(),
        matrix: Vec::new(),
        evidence: None,
        scenarios: Vec::new(),
        complete: Vec::new(),
    };
    let (mut cases, mut seats): (Vec<CaseRecord>, Vec<Seat>) = Default::default();
    let of_role = |key: &str| {
        let id = key.split('[').next().unwrap_or_default();
        tool.cases.iter().find(|case| case.id == id).is_none_or(|case| case.role == product.role)
    };
    for (source, piece) in sources.iter().map(|source| &source.piece).enumerate() {
        let Piece::Run(run) = piece else { continue };
        let from = seats.len();
        for (dut, info) in run.header.duts.iter().enumerate().filter(|(_, dut)| belongs(dut, product)) {
            header.duts.push(info.clone());
            seats.push(Seat { source, dut });
        }
        let Some(own) = seats.get(from..).filter(|own| !own.is_empty()) else { continue };
        for case in &run.cases {
            if let Some(at) = own.iter().position(|seat| seat.dut == case.dut) {
                cases.push(CaseRecord { dut: from + at, ..case.clone() });
            }
        }
        let told = &run.header;
        let complete = told.complete.iter().filter_map(|suite| {
            let at = own.iter().position(|seat| seat.dut == suite.dut)?;
            Some(CompleteInfo { dut: from + at, ..suite.clone() })
        });
        header.complete.extend(complete);
        header.not_applicable.extend(told.not_applicable.iter().filter(|(key, _)| of_role(key)).cloned());
        header.tolerances.extend(told.tolerances.clone());
        let machines = told.machines.iter().filter(|machine| machine.role == product.role);
        header.machines.extend(machines.filter(|_| header.machines.is_empty()).cloned().collect::<Vec<_>>());
        let matrix = told.matrix.iter().filter(|part| part.role == product.role);
        header.matrix.extend(matrix.filter(|_| header.matrix.is_empty()).cloned().collect::<Vec<_>>());
        let known: Vec<String> = header.scenarios.iter().map(|one| one.id.clone()).collect();
        header.scenarios.extend(told.scenarios.iter().filter(|one| !known.contains(&one.id)).cloned());
    }
    header.planned = cases.len();
    let footer = Some(Footer { cases: cases.len(), interrupted: false });
    (Run { header, cases, footer, damaged: None }, seats)
}

/// An offer begins with its edition.
fn editions(run: &Run) -> BTreeSet<String> {
    let ran = run.cases.iter().map(|case| case.variant.edition.clone());
    let offered = run
        .header
        .duts
        .iter()
        .flat_map(|dut| &dut.offers)
        .filter_map(|offer| Some(offer.split(' ').next()?.to_owned()));
    ran.chain(offered).filter(|edition| ["v1.1", "iec2022"].contains(&edition.as_str())).collect()
}
