//! What the program that makes a dossier carries itself: the ledger, the cases, the readings, what Annex I asks for, and what its
//! self-test came to. Plain data, for this crate knows no case files.

use crate::record::EvidenceItem;
use std::collections::BTreeMap;

/// The tool.
#[derive(Clone, Debug, Default)]
pub struct Tool {
    /// Version of fsct.
    pub version: String,
    /// The ledger: every statement of both editions.
    pub statements: Vec<Statement>,
    /// Every case there is.
    pub cases: Vec<KnownCase>,
    /// Where the standard is silent or contradicts itself: id, then what is judged by and what is let pass.
    pub readings: BTreeMap<String, Reading>,
    /// What Annex I asks for, each item with the chapter that answers it.
    pub items: Vec<EvidenceItem>,
    /// Suites of a group or a suite: its name, then those.
    pub members: BTreeMap<String, Vec<String>>,
    /// What the self-test came to, made while the dossier was.
    pub self_test: Vec<SelfTest>,
}

/// A statement of the standard.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Statement {
    /// Its id in the ledger.
    pub id: String,
    /// Edition, then clause.
    pub clauses: BTreeMap<String, String>,
    /// `device`, `master`, `both`, `iodd` or `tool`.
    pub dut: String,
    /// `shall`, `should`, `may` or `fact`.
    pub level: String,
    /// `tested`, `implicit`, `bench`, `inspection`, `untestable` or `open`.
    pub class: String,
    /// What it says, in our words.
    pub text: String,
    /// Why nothing can be, or has been, done about it; empty: not said.
    pub why: String,
}

/// A case of the suites.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct KnownCase {
    /// Its id.
    pub id: String,
    /// Its suite.
    pub suite: String,
    /// `device` or `master`.
    pub role: String,
    /// Ids of the statements it judges.
    pub requirements: Vec<String>,
}

/// A reading of the standard.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Reading {
    /// In a few words.
    pub name: String,
    /// What is done with a product that reads otherwise: `tolerated`, `finding`, ...
    pub stance: String,
    /// In full.
    pub text: String,
}

/// A part of the self-test.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct SelfTest {
    /// What was looked at.
    pub what: String,
    /// What it came to.
    pub outcome: String,
    /// Whether it is as it has to be.
    pub passed: bool,
    /// The command that repeats it.
    pub command: String,
}
