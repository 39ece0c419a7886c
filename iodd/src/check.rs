//! Holding a file against the rules: one file per subject, each finding with its rule, its place, what is there and what should be.

mod events;
mod general;
mod menus;
mod param_desc;
mod process_data;
mod variables;

use crate::declaration::Declaration;
use crate::model::{Iodd, ProcessData, Variable};
use crate::rules::{Severity, rule};
use crate::serialise;
use crate::text::Lines;
use fsct_protocol::fsp::param_desc_crc;
use fsct_protocol::{Edition, ProtMode};
use std::fmt::Display;

/// More findings than this help nobody; a file can be made to have millions.
const MOST_FINDINGS: usize = 1000;

/// A rule the file breaks.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Finding {
    /// `IODD-24`.
    pub rule: &'static str,
    /// Its weight here.
    pub severity: Severity,
    /// Where the standard says so.
    pub clause: &'static str,
    /// Line, from 1.
    pub line: usize,
    /// Column in characters, from 1.
    pub column: usize,
    /// What is there. Holds text of the file: escape it before it reaches a terminal.
    pub found: String,
    /// What should be there.
    pub expected: String,
}

/// A signature of the file, computed again.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Signature {
    /// The octets it secures.
    pub octets: Vec<u8>,
    /// Its value over these octets.
    pub computed: u32,
}

/// What a file turned out to be.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Report {
    /// The edition it was judged by.
    pub edition: Edition,
    /// Why by this one.
    pub because: String,
    /// What it declares.
    pub declaration: Declaration,
    /// FSP_ParamDescCRC, or what keeps it from being computed.
    pub param_desc: Result<Signature, String>,
    /// FSP_IO_StructCRC, or what keeps it from being computed.
    pub structure: Result<Signature, String>,
    /// The rules it breaks, by place; at most a thousand.
    pub findings: Vec<Finding>,
}

impl Report {
    /// Whether no finding is an error.
    pub fn is_sound(&self) -> bool {
        self.findings.iter().all(|finding| finding.severity < Severity::Error)
    }
}

/// All rules of an edition against a file.
pub(crate) fn all(text: &str, iodd: &Iodd<'_>, edition: Edition, because: String) -> Report {
    let declaration = Declaration::of(iodd, edition);
    let param_desc =
        serialise::param_desc(iodd).map(|octets| Signature { computed: param_desc_crc(edition, &octets), octets });
    let structure = serialise::structure(iodd.process_data.first(), declaration.mode).map(|structure| Signature {
        octets: serialise::structure_octets(&structure),
        computed: structure.signature().into(),
    });
    let mut check = Check { iodd, edition, mode: declaration.mode, found: Vec::new() };
    general::check(&mut check);
    variables::check(&mut check, &structure);
    process_data::check(&mut check);
    param_desc::check(&mut check, &param_desc);
    events::check(&mut check);
    menus::check(&mut check);
    let mut found = check.found;
    found.sort_by_key(|finding| finding.at);
    let lines = Lines::of(text);
    let findings = found.into_iter().map(|raw| {
        let (line, column) = lines.place(raw.at);
        let Raw { rule, severity, clause, found, expected, .. } = raw;
        Finding { rule, severity, clause, line, column, found, expected }
    });
    let findings = findings.collect();
    Report { edition, because, declaration, param_desc, structure, findings }
}

/// A finding before its place is looked up.
struct Raw {
    rule: &'static str,
    severity: Severity,
    clause: &'static str,
    at: usize,
    found: String,
    expected: String,
}

/// The file under check.
struct Check<'c, 'a> {
    iodd: &'c Iodd<'a>,
    edition: Edition,
    mode: Option<ProtMode>,
    found: Vec<Raw>,
}

impl<'c, 'a> Check<'c, 'a> {
    /// A rule is broken. Without effect where the edition has no such rule.
    fn broken(&mut self, id: &'static str, at: usize, found: impl Display, expected: impl Display) {
        self.add(id, Severity::Error, at, found, expected);
    }

    /// A rule is broken in a way that weighs no more than a warning.
    fn doubtful(&mut self, id: &'static str, at: usize, found: impl Display, expected: impl Display) {
        self.add(id, Severity::Warning, at, found, expected);
    }

    fn add(&mut self, id: &'static str, most: Severity, at: usize, found: impl Display, expected: impl Display) {
        let Some(rule) = rule(id) else { return };
        let Some(severity) = rule.severity(self.edition) else { return };
        if self.found.len() < MOST_FINDINGS {
            let severity = severity.min(most);
            let (found, expected) = (found.to_string(), expected.to_string());
            self.found.push(Raw { rule: rule.id, severity, clause: rule.clause, at, found, expected });
        }
    }

    fn is(&self, edition: Edition) -> bool {
        self.edition == edition
    }

    /// The variable at an Index.
    fn variable(&self, index: u64) -> Option<&'c Variable<'a>> {
        let iodd = self.iodd;
        iodd.variable(index)
    }

    /// The process data structure; with several the first.
    fn process_data(&self) -> Option<&'c ProcessData<'a>> {
        let iodd = self.iodd;
        iodd.process_data.first()
    }

    /// Whether the file has technology safety variables.
    fn has_fst(&self) -> bool {
        self.iodd.variables.iter().any(|variable| variable.id.starts_with("V_FST_"))
    }
}

/// A value of the file in a sentence: in back quotes, cut where it is longer than a name.
fn quoted(text: &str) -> String {
    const LONGEST: usize = 60;
    match text.char_indices().nth(LONGEST) {
        Some((at, _)) => format!("`{}...`", text.get(..at).unwrap_or_default()),
        None => format!("`{text}`"),
    }
}

/// A value that may be missing.
fn maybe(value: Option<&str>) -> String {
    value.map_or("nothing".to_owned(), quoted)
}

/// A number that may be missing.
fn counted(value: Option<u64>) -> String {
    value.map_or("none".to_owned(), |value| value.to_string())
}
