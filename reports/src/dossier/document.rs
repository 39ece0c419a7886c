//! The documents that `fsct prove --json` and `fsct crc --residual --json` print, as far as a dossier reads them.

use serde::Deserialize;

/// Schema of [`Proof`].
pub const PROOF: &str = "fsct-prove/1";
/// Schema of [`Residual`].
pub const RESIDUAL: &str = "fsct-residual/1";

/// Both machines of the tables, explored under one reading; a document holds a list of these.
#[derive(Clone, Debug, Deserialize)]
pub struct Proof {
    /// Version of fsct.
    pub fsct: String,
    /// Edition of the tables.
    pub edition: String,
    /// Readings other than the default.
    pub readings: Vec<String>,
    /// FSP_Watchdog in exchanges.
    pub watchdog: u64,
    /// `P` or `I`.
    pub timing: String,
    /// Most disturbed exchanges; `None`: any number.
    pub faults: Option<u64>,
    /// Whether the FS-Device may lose its power.
    pub power_cycles: bool,
    /// Reachable states.
    pub states: u64,
    /// What was asked.
    pub properties: Vec<Asked>,
}

/// A property with what became of it.
#[derive(Clone, Debug, Deserialize)]
pub struct Asked {
    /// Its name.
    pub property: String,
    /// What it says.
    pub about: String,
    /// Clause.
    pub clause: String,
    /// `holds`, `violated`, `tables`, `lock-up` or `unknown`.
    pub verdict: String,
    /// Why the tables themselves allow it.
    pub tables: Option<String>,
    /// The measure, with its unit.
    pub measures: String,
    /// The largest measure met.
    pub found: u64,
    /// The largest allowed.
    pub bound: Option<u64>,
    /// States kept.
    pub states: u64,
    /// Most exchanges on a shortest way to a state.
    pub depth: u64,
}

/// What the signatures are worth.
#[derive(Clone, Debug, Deserialize)]
pub struct Residual {
    /// Version of fsct.
    pub fsct: String,
    /// What it was computed under.
    pub assumed: Assumed,
    /// The codes.
    pub codes: Vec<Code>,
}

/// The assumptions of the standard (11.4.7, Table 41).
#[derive(Clone, Debug, Deserialize)]
pub struct Assumed {
    /// Worst bit error probability.
    pub bit_error_probability: f64,
    /// SPDUs an hour.
    pub spdus_per_hour: f64,
    /// Hours in which one detected error is permitted.
    pub hours_per_detected_error: f64,
    /// Undetected errors an hour that a logical connection may have.
    pub share_per_hour: f64,
}

/// A code.
#[derive(Clone, Debug, Deserialize)]
pub struct Code {
    /// Bits of its signature.
    pub width: u32,
    /// Generator polynomial, highest term left out.
    pub polynomial: String,
    /// What the standard states of it.
    pub stated: Option<Stated>,
    /// Lengths that were looked at.
    pub lengths: Vec<Length>,
}

/// What Annex D states of a code.
#[derive(Clone, Debug, Deserialize)]
pub struct Stated {
    /// Bound on Rp.
    pub residual: Bound,
}

/// A bound on Rp up to a length.
#[derive(Clone, Debug, Deserialize)]
pub struct Bound {
    /// Up to so many octets.
    pub octets: u64,
    /// Rp is below this.
    pub below: f64,
}

/// A code at one length.
#[derive(Clone, Debug, Deserialize)]
pub struct Length {
    /// Octets with the signature.
    pub octets: u64,
    /// Hamming distance.
    pub distance: u64,
    /// Bit error probability, then Rp.
    pub residual: Vec<(f64, f64)>,
    /// Whether Rp never falls; `None`: undecided.
    pub proper: Option<bool>,
    /// Undetected errors an hour while one detected error in so many hours is permitted.
    pub monitored_per_hour: f64,
    /// The same when nobody minds detected errors.
    pub unmonitored_per_hour: f64,
    /// What the standard states beside what was computed.
    pub verdicts: Option<Verdicts>,
}

/// Whether what is stated holds.
#[derive(Clone, Debug, Deserialize)]
pub struct Verdicts {
    /// Of the distance.
    pub distance: String,
    /// Of Rp.
    pub residual: String,
    /// Of properness.
    pub proper: String,
}
