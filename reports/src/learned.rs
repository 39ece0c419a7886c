//! `learned.json`: the machine of a DUT as `fsct learn` found it, beside that of the tables. docs/learn.md describes it.

use crate::record::{DutInfo, VariantInfo};
use serde::{Deserialize, Serialize};

/// Version of the file.
pub const SCHEMA: &str = "fsct-learned/1";

/// The file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Learned {
    /// [`SCHEMA`].
    pub schema: String,
    /// The DUT.
    pub dut: DutInfo,
    /// What it was configured as.
    pub variant: VariantInfo,
    /// Seed of the process data.
    pub seed: u64,
    /// States the DUT may have beyond those found, for the machine to be exact.
    pub extra_states: usize,
    /// The bound that ended the learning; `None`: learnt to the end.
    pub bound: Option<String>,
    /// Words asked, a restart each.
    pub words: u64,
    /// Inputs in them.
    pub inputs_given: u64,
    /// Names of the inputs, in the order of the edges.
    pub inputs: Vec<String>,
    /// Names of what can be shown.
    pub outputs: Vec<String>,
    /// The machine of the DUT.
    pub machine: Machine,
    /// The machine of the tables.
    pub table: Machine,
    /// Where they differ, the shortest words first.
    pub differences: Vec<Difference>,
}

/// A machine; state 0 is the start.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Machine {
    /// By state, then by input.
    pub states: Vec<Vec<Edge>>,
}

/// What an input leads to.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Edge {
    /// What becomes of the SPDU of the DUT.
    pub spdu: Spdu,
    /// What is shown with it; `None`: nothing new.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub shows: Option<Vec<String>>,
    /// The state behind it.
    pub next: usize,
}

/// What becomes of the SPDU of the DUT.
#[derive(Copy, Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Spdu {
    /// It stays.
    Same,
    /// A new one with the counter that has to follow.
    New,
    /// A new one with another counter.
    OtherCounter,
}

/// A place where the DUT differs from the tables, with nothing different before it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Difference {
    /// Inputs from the start; the last one shows it.
    pub word: Vec<String>,
    /// States before the last input: of the DUT, of the tables.
    pub states: (usize, usize),
    /// What the tables answer.
    pub table: String,
    /// What the DUT answers.
    pub dut: String,
}
