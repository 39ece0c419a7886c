//! The ledger: every normative or testable statement of both editions, with what is done about it.
//!
//! Data: `testcases/requirements/*.yaml`. What stands behind `remark:` in `expect` is inferred or undecided and is shown,
//! never failed; `base:` names a part only the base standard prints; `applies:` limits a record to some products.

use crate::mapping::Relation;
use crate::problem::{Problem, Source};
use crate::tree::{self, Fields};
use crate::yaml::{self, Node, Value};
use fsct_protocol::Edition;
use std::collections::BTreeMap;
use std::sync::Arc;

/// What is done about a statement.
#[derive(Copy, Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Class {
    /// At least one case judges it.
    Tested,
    /// The oracle judges it at every exchange, `fsct iodd` in every IODD.
    Implicit,
    /// Needs instruments.
    Bench,
    /// A person reads documents.
    Inspection,
    /// Cannot be judged from outside.
    Untestable,
    /// Nothing is done yet.
    Open,
}

impl Class {
    /// All classes as written in the ledger.
    pub const ALL: [(Class, &'static str); 6] = [
        (Class::Tested, "tested"),
        (Class::Implicit, "implicit"),
        (Class::Bench, "bench"),
        (Class::Inspection, "inspection"),
        (Class::Untestable, "untestable"),
        (Class::Open, "open"),
    ];

    /// As written in the ledger.
    pub fn name(self) -> &'static str {
        Class::ALL.iter().find(|entry| entry.0 == self).map_or("", |entry| entry.1)
    }
}

/// What the text really says.
#[derive(Copy, Clone, Debug, PartialEq, Eq, Hash)]
pub enum Level {
    /// A must, or a printed normative table or machine.
    Shall,
    /// A recommendation.
    Should,
    /// A permission.
    May,
    /// A declarative sentence.
    Fact,
}

impl Level {
    const ALL: [(Level, &'static str); 4] =
        [(Level::Shall, "shall"), (Level::Should, "should"), (Level::May, "may"), (Level::Fact, "fact")];

    /// As written in the ledger.
    pub fn name(self) -> &'static str {
        Level::ALL.iter().find(|entry| entry.0 == self).map_or("", |entry| entry.1)
    }
}

/// One record.
#[derive(Clone, Debug)]
pub struct Requirement {
    /// Its id: `R-11.5.3-09`.
    pub id: String,
    /// Clause in v1.1 and in iec2022 (or the handbook), where the edition has it.
    pub clauses: BTreeMap<String, String>,
    /// `device`, `master`, `both`, `iodd` or `tool`.
    pub dut: String,
    /// Weight.
    pub level: Level,
    /// What is done about it.
    pub class: Class,
    /// The statement in our words.
    pub text: String,
    /// How it is stimulated.
    pub stimulus: String,
    /// What a harness checks, without what stands behind `remark:`.
    pub expect: String,
    /// What is inferred or undecided: shown, never failed.
    pub remark: Option<String>,
    /// The part only the base standard prints: recorded, not judged.
    pub base: Option<String>,
    /// Limited to products with this feature, such as `ossde`.
    pub applies: Option<String>,
    /// What is doubtful.
    pub doubt: Option<String>,
    /// How the editions differ.
    pub differs: Option<String>,
    /// Why it is untestable, or why nothing is done about it yet.
    pub why: Option<String>,
    /// What it is to SDCI-FS, for a statement about a product that does not claim it.
    pub relation: Option<Relation>,
    /// File and line.
    pub place: String,
}

impl Requirement {
    /// The clause in an edition; that of the other where this one has none.
    pub fn clause(&self, edition: Edition) -> &str {
        self.clauses.get(edition.name()).or_else(|| self.clauses.values().next()).map_or("", String::as_str)
    }

    /// Whether the statement exists in an edition.
    pub fn exists_in(&self, edition: Edition) -> bool {
        self.clauses.contains_key(edition.name()) || self.clauses.contains_key("lion")
    }

    /// Whether a deviation can fail a product: only what the documents demand, and only what they print themselves.
    pub fn can_fail(&self) -> bool {
        matches!(self.level, Level::Shall | Level::Fact) && self.base.is_none()
    }
}

/// All records by id.
#[derive(Clone, Debug, Default)]
pub struct Ledger(BTreeMap<String, Requirement>);

impl Ledger {
    /// Adds the records of one file.
    pub fn read(&mut self, source: &Arc<Source>, problems: &mut Vec<Problem>) {
        let root = match yaml::parse(source) {
            Ok(root) => root,
            Err(problem) => return problems.push(problem),
        };
        for item in tree::list(source, &root, "the ledger", problems) {
            let Some((record, at)) = record(source, item, problems) else { continue };
            if let Some(before) = self.0.get(&record.id) {
                let message = format!("`{}` stands already at {}", record.id, before.place);
                problems.push(Problem::new(source, at, message));
                continue;
            }
            self.0.insert(record.id.clone(), record);
        }
    }

    /// The record of an id.
    pub fn get(&self, id: &str) -> Option<&Requirement> {
        self.0.get(id)
    }

    /// All records by id.
    pub fn iter(&self) -> impl Iterator<Item = &Requirement> {
        self.0.values()
    }

    /// All ids.
    pub fn ids(&self) -> impl Iterator<Item = &str> + Clone {
        self.0.keys().map(String::as_str)
    }
}

fn record(
    source: &Arc<Source>,
    item: &Node,
    problems: &mut Vec<Problem>,
) -> Option<(Requirement, std::ops::Range<usize>)> {
    let mut fields = Fields::new(source, item, "a requirement", problems);
    let id = fields.text("id");
    let clauses = fields.get("clause").map(|node| match &node.value {
        Value::Map(entries) => {
            entries.iter().filter_map(|(key, node)| Some((key.text.clone(), tree::scalar(node)?.0))).collect()
        }
        _ => BTreeMap::new(),
    });
    let dut = fields.text("dut");
    let level = fields.word("level", &Level::ALL);
    let class = fields.word("class", &Class::ALL);
    let text = fields.text("text");
    let stimulus = fields.text("stimulus");
    let expect = fields.text("expect");
    let mut optional = |key: &'static str| fields.optional(key).map(|placed| placed.0);
    let (base, applies, doubt, differs, why) =
        (optional("base"), optional("applies"), optional("doubt"), optional("differs"), optional("why"));
    let relation = fields.get("sdci_fs");
    for key in ["verify", "reviewed", "variant", "derived", "bench"] {
        let _ = fields.get(key);
    }
    if class == Some(Class::Untestable) && why.is_none() {
        fields.problem(item.at.clone(), "an untestable requirement says `why`");
    }
    fields.finish(problems);
    let relation = relation.and_then(|node| Relation::read(source, node, problems));
    let (id, at) = id?;
    let expect = expect?.0;
    let (expect, remark) = match expect.split_once("remark:") {
        Some((expect, remark)) => (expect.trim().trim_end_matches(';').to_owned(), Some(remark.trim().to_owned())),
        None => (expect, None),
    };
    let record = Requirement {
        id,
        clauses: clauses?,
        dut: dut?.0,
        level: level?,
        class: class?,
        text: text?.0,
        stimulus: stimulus?.0,
        expect,
        remark,
        base,
        applies,
        doubt,
        differs,
        why,
        relation,
        place: format!("{}:{}", source.name, source.line_column(at.start).0),
    };
    Some((record, at))
}
