//! The FS part of an IODD, judged by the rules of Annex E.
//!
//! [`check`] reads the octets of a file, holds it against the [rules](RULES) of one edition and computes FSP_ParamDescCRC (Figure E.1)
//! and FSP_IO_StructCRC (Table A.4) again. What the file says of its FS-Device is a [`Declaration`].
//!
//! The file is hostile until proven otherwise: bounded size, nesting and attributes, no document type declaration, so no entities,
//! and nothing is ever fetched. Whether it fits the IODD schema is not judged here.

mod check;
mod declaration;
mod edition;
mod model;
mod rules;
mod serialise;
mod text;

pub use check::{Finding, Report, Signature};
pub use declaration::Declaration;
pub use rules::{RULES, Reach, Rule, Severity, rule};
pub use text::{MOST_OCTETS, Unreadable, octets_of};

use fsct_protocol::Edition;

/// Judges the octets of an IODD by the rules of `edition`; without one, by those of the edition the file itself tells.
///
/// # Errors
/// [`Unreadable`]: no verdict about the device is possible.
pub fn check(octets: &[u8], edition: Option<Edition>) -> Result<Report, Unreadable> {
    let text = text::decode(octets)?;
    let document = text::parse(text)?;
    let iodd = model::Iodd::read(&document)?;
    let (edition, because) = match edition {
        Some(edition) => (edition, "asked for by --edition".to_owned()),
        None => edition::of(&iodd)?,
    };
    Ok(check::all(text, &iodd, edition, because))
}
