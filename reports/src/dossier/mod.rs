//! The dossier: what the records of one product have to show an assessor, along Annex I.4 of v1.1, as one page to be printed.
//!
//! It reads records and judges nothing. Every figure names the record it comes from by a number in brackets; what no record shows is
//! a gap with the command that closes it. Each chapter is a file, [`CHAPTERS`] is their order; a new kind of record gets a
//! [`Piece`], and a chapter shows it.

mod assembly;
mod checking;
pub mod document;
mod documents;
mod gap;
mod gaps;
mod injection;
mod management;
mod modelling;
mod noise;
mod page;
mod product;
mod residual;
mod source;
mod specification;
mod tool;
mod tools;
pub mod trace;
mod tracing;

pub use assembly::{AssemblyError, Dossier, Identity, Seat};
pub use document::{PROOF, RESIDUAL};
pub use gap::{Gap, Kind};
pub use source::{Piece, Recorded, Source, SourceError, read};
pub use tool::{KnownCase, Reading, SelfTest, Statement, Tool};

use maud::Markup;

/// What a chapter prints, and what it found missing.
#[derive(Debug)]
pub struct Section {
    /// Below the heading.
    pub body: Markup,
    /// Gaps, which the chapter on gaps collects.
    pub gaps: Vec<Gap>,
}

/// A chapter that answers items of Annex I.
#[derive(Copy, Clone, Debug)]
pub struct Chapter {
    /// Its key, by which an item of Annex I names it; the anchor as well.
    pub key: &'static str,
    /// Heading.
    pub title: &'static str,
    /// Fills it.
    pub section: fn(&Dossier<'_>) -> Section,
}

/// The chapters in the order of Annex I: the product (I.1 to I.3), then what a concept approval rests on (I.4).
pub const CHAPTERS: [Chapter; 9] = [
    Chapter { key: "product", title: "Product under assessment", section: product::section },
    Chapter { key: "specification", title: "Specification and requirements", section: specification::section },
    Chapter { key: "modelling", title: "Modelling of the safety communication layer", section: modelling::section },
    Chapter { key: "checking", title: "Model checking", section: checking::section },
    Chapter { key: "injection", title: "Simulation with fault injection", section: injection::section },
    Chapter {
        key: "management",
        title: "Safety considerations: management, assumptions, readings",
        section: management::section,
    },
    Chapter { key: "residual", title: "Safety considerations: residual error rates", section: residual::section },
    Chapter { key: "tools", title: "Safety considerations: tool chain", section: tools::section },
    Chapter { key: "documents", title: "Documents and records", section: documents::section },
];

/// The dossier as one HTML page, without script, without network, laid out for A4.
pub fn render(dossier: &Dossier<'_>) -> String {
    page::page(dossier).into_string()
}
