//! How statements about a gateway that is no FS-Master relate to IO-Link Safety: `sdci_fs` of the ledger's records.

use crate::ledger::{Ledger, Requirement};
use crate::problem::{Problem, Source};
use crate::tree::Fields;
use crate::yaml::Node;
use fsct_protocol::Edition;
use std::fmt::Write as _;
use std::sync::Arc;

/// What a statement is to SDCI-FS.
#[derive(Copy, Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Kind {
    /// Done otherwise than SDCI-FS wants it.
    Deviates,
    /// Not there.
    Absent,
    /// The handbook gives no figure.
    NotStated,
    /// For a test that something does not happen.
    Negative,
    /// More than SDCI-FS allows.
    Superset,
    /// The same purpose by other means.
    Analog,
    /// The same.
    Same,
    /// Plain IEC 61131-9.
    Base,
}

impl Kind {
    const ALL: [(Kind, &'static str); 8] = [
        (Kind::Deviates, "deviates"),
        (Kind::Absent, "absent"),
        (Kind::NotStated, "not_stated"),
        (Kind::Negative, "negative"),
        (Kind::Superset, "superset"),
        (Kind::Analog, "analog"),
        (Kind::Same, "same"),
        (Kind::Base, "base"),
    ];

    /// As written in the ledger.
    pub fn name(self) -> &'static str {
        Kind::ALL.iter().find(|entry| entry.0 == self).map_or("", |entry| entry.1)
    }

    /// Whether it is a finding on the mapping. It is no fault of the product, which does not claim SDCI-FS.
    pub const fn is_finding(self) -> bool {
        matches!(self, Kind::Deviates | Kind::Absent | Kind::NotStated)
    }
}

/// The relation of one statement.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Relation {
    /// What it is.
    pub kind: Kind,
    /// Clause of SDCI-FS in each edition; empty where it has none.
    pub clauses: [String; 2],
    /// What the difference is.
    pub note: Option<String>,
}

impl Relation {
    /// Reads `sdci_fs`.
    pub fn read(source: &Arc<Source>, node: &Node, problems: &mut Vec<Problem>) -> Option<Relation> {
        let mut fields = Fields::new(source, node, "`sdci_fs`", problems);
        let kind = fields.word("relation", &Kind::ALL);
        let clauses = Edition::ALL.map(|edition| fields.optional(edition.name()).map_or(String::new(), |text| text.0));
        let note = fields.optional("note").map(|text| text.0);
        fields.finish(problems);
        Some(Relation { kind: kind?, clauses, note })
    }
}

/// The whole table, findings first.
pub fn text(ledger: &Ledger) -> String {
    let mut rows: Vec<(&Relation, &Requirement)> =
        ledger.iter().filter_map(|record| Some((record.relation.as_ref()?, record))).collect();
    rows.sort_by_key(|(relation, record)| (relation.kind, &record.id));
    let findings = rows.iter().filter(|(relation, _)| relation.kind.is_finding()).count();
    let mut text =
        format!("{} statements of the handbook map to SDCI-FS, {findings} of them are findings\n", rows.len());
    for (relation, record) in rows {
        let [v1_1, iec2022] = relation.clauses.each_ref().map(|clause| if clause.is_empty() { "none" } else { clause });
        let finding = if relation.kind.is_finding() { "finding: " } else { "" };
        let note = relation.note.as_ref().map_or(String::new(), |note| format!(" - {note}"));
        let _ = writeln!(
            text,
            "{finding}{} {} ({}) -> v1.1 {v1_1}, iec2022 {iec2022}: {}{note}",
            relation.kind.name(),
            record.id,
            record.class.name(),
            record.text
        );
    }
    text.truncate(text.trim_end().len());
    text
}
