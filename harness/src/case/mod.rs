//! The case language: suites of cases as YAML, read, checked and turned into typed steps.

mod decode;
pub mod model;
mod sweep;

pub use decode::steps as decode_steps;
pub use sweep::{Axis, Binding, Expansion};

use crate::complete::{Complete, MOST};
use crate::oracle::{Mask, Tolerances};
use crate::problem::{Problem, Source, suggestion};
use crate::tree::{self, Fields};
use crate::yaml::{self, Node, Value};
use fsct_adapters::{Pco, Role};
use model::Step;
use std::collections::BTreeSet;
use std::ops::Range;
use std::sync::Arc;

const ROLES: &[(Role, &str)] = &[(Role::Device, "device"), (Role::Master, "master")];

/// A file of cases.
#[derive(Clone, Debug)]
pub struct Suite {
    /// Its name, unique.
    pub name: String,
    /// Group of suites it belongs to: a name to run them all by.
    pub group: Option<String>,
    /// What it is about.
    pub about: String,
    /// Its cases, in the order of the file.
    pub cases: Vec<Case>,
}

/// A case before its sweep is expanded.
#[derive(Clone, Debug)]
pub struct Case {
    /// Stable id without meaning.
    pub id: String,
    /// What it shows.
    pub title: String,
    /// Suite it stands in.
    pub suite: String,
    /// Group of that suite.
    pub group: Option<String>,
    /// Features a product has to list for it.
    pub features: Vec<String>,
    /// Requirement records it judges.
    pub requirements: Vec<String>,
    /// The scenario of Annex G it leads the DUT through, with the place of the name.
    pub scenario: Option<(String, Range<usize>)>,
    /// Which side it is for.
    pub role: Role,
    /// Points of control and observation it cannot do without.
    pub needs: Vec<Pco>,
    /// Tolerances that do not excuse a DUT in it.
    pub strict: Mask,
    /// Its sweep, in the order of the file.
    pub sweep: Vec<Axis>,
    /// The complete suite whose sequences are its points.
    pub complete: Option<Complete>,
    /// The depth of a run from which on it belongs to it.
    pub depth: u8,
    /// Start condition, reached and verified first.
    pub start: String,
    /// Transitions that have to happen.
    pub covers: Vec<Covered>,
    /// Its steps as they stand in the file.
    steps: Node,
    /// File.
    pub source: Arc<Source>,
    /// Place of the id.
    pub at: Range<usize>,
}

/// A transition that has to happen.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Covered {
    /// Of the SCL: T1..T14 or T20..T31.
    Scl(u8),
    /// Of the OSSDe qualifier handler: T1..T6 (Table 43).
    Ossde(u8),
    /// Of the DL-mode handler: T13 of an FS-Device (Table 11), T20..T22 of an FS-Master (Table 10).
    Dl(u8),
}

impl std::fmt::Display for Covered {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Covered::Scl(number) => write!(f, "T{number}"),
            Covered::Ossde(number) => write!(f, "OSSDe T{number}"),
            Covered::Dl(number) => write!(f, "DL T{number}"),
        }
    }
}

/// A start condition.
#[derive(Clone, Debug)]
pub struct Start {
    /// Its name, unique for its side.
    pub name: String,
    /// Which side it is for.
    pub role: Role,
    /// What it means.
    pub about: String,
    /// The start condition it goes on from.
    pub after: Option<String>,
    steps: Node,
    source: Arc<Source>,
}

/// Reads a suite.
///
/// # Errors
/// Every problem of the file that can be told without knowing other files.
pub fn suite(source: &Arc<Source>) -> Result<Suite, Vec<Problem>> {
    let root = yaml::parse(source).map_err(|problem| vec![problem])?;
    let mut problems = Vec::new();
    let mut fields = Fields::new(source, &root, "a suite", &mut problems);
    let name = fields.text("suite").map(|placed| placed.0).unwrap_or_default();
    let group = fields.optional("group").map(|placed| placed.0);
    let about = fields.text("about").map(|placed| placed.0).unwrap_or_default();
    let cases = fields.get("cases");
    fields.finish(&mut problems);
    let items = match cases {
        Some(node) => tree::list(source, node, "`cases`", &mut problems),
        None => {
            problems.push(Problem::new(source, root.at.clone(), "a suite needs `cases`"));
            &[]
        }
    };
    let cases = items.iter().filter_map(|item| case(source, (&name, group.as_ref()), item, &mut problems)).collect();
    if problems.is_empty() { Ok(Suite { name, group, about, cases }) } else { Err(problems) }
}

fn case(
    source: &Arc<Source>,
    (suite, group): (&str, Option<&String>),
    node: &Node,
    problems: &mut Vec<Problem>,
) -> Option<Case> {
    let mut fields = Fields::new(source, node, "a case", problems);
    let id = fields.text("id");
    let title = fields.text("title");
    let _about = fields.optional("about");
    let requirements = fields.texts("requirements");
    let scenario = fields.optional("scenario");
    let role = fields.word("dut", ROLES);
    let needs = fields.texts("needs");
    let features = fields.texts("features");
    let excuses = fields.texts("strict");
    let axes = fields.get("sweep");
    let complete = fields.get("complete");
    let depth = fields.optional_number("depth", 0..=9).unwrap_or(0) as u8;
    let start = fields.text("start");
    let steps = fields.get("steps");
    let covers = fields.texts("covers");
    fields.finish(problems);
    let mut problem = |at: &Range<usize>, message: String| problems.push(Problem::new(source, at.clone(), message));
    if let Some((id, at)) = &id
        && !is_case_id(id)
    {
        problem(at, format!("`{id}` is no case id: letters, a hyphen and four digits, such as FSD-0231"));
    }
    if requirements.is_empty() {
        problem(&node.at, "a case judges at least one requirement: add `requirements: [R-...]`".into());
    }
    let mut wanted = Vec::new();
    for (text, at) in needs {
        match Pco::ALL.into_iter().find(|pco| pco.name() == text) {
            Some(pco) => wanted.push(pco),
            None => {
                problem(&at, format!("`{text}` is no point of control; {}", suggestion(&text, Pco::ALL.map(Pco::name))))
            }
        }
    }
    let mut strict = Mask::NONE;
    for (text, at) in excuses {
        match Tolerances::number(&text) {
            Some(number) => strict = strict.with(number),
            None => problem(&at, format!("`{text}` is no tolerance, A01 to A38 are: `fsct explain A19`")),
        }
    }
    let mut transitions = Vec::new();
    for (text, at) in covers {
        let number = |prefix: &str| text.strip_prefix(prefix).and_then(|number| number.parse().ok());
        match (number("T"), number("OSSDe T"), number("DL T")) {
            (Some(number @ (1..=14 | 20..=31)), _, _) => transitions.push(Covered::Scl(number)),
            (_, Some(number @ 1..=6), _) => transitions.push(Covered::Ossde(number)),
            (_, _, Some(number @ (13 | 20..=22))) => transitions.push(Covered::Dl(number)),
            _ => problem(
                &at,
                format!(
                    "`{text}` is no transition: T1 to T14, T20 to T31, OSSDe T1 to OSSDe T6, DL T13 and DL T20 to DL T22 are"
                ),
            ),
        }
    }
    let sweep = axes.map(|node| sweep::axes(source, node, problems)).unwrap_or_default();
    let complete = complete.map(|node| (node, role.map(|role| self::complete(source, role, node, problems))));
    let steps = match (steps, &complete) {
        (Some(steps), None) => steps.clone(),
        (None, Some(_)) if axes.is_none() => Node { at: node.at.clone(), value: Value::Null },
        (_, Some((node, _))) => {
            let message =
                "the sequences of `complete` are all points and steps there are: no `sweep` and no `steps` beside it";
            problems.push(Problem::new(source, node.at.clone(), message));
            return None;
        }
        (None, None) => {
            problems.push(Problem::new(source, node.at.clone(), "a case needs `steps`"));
            return None;
        }
    };
    let (id, at) = id?;
    Some(Case {
        id,
        title: title?.0,
        suite: suite.to_owned(),
        group: group.cloned(),
        features: features.into_iter().map(|placed| placed.0).collect(),
        requirements: requirements.into_iter().map(|placed| placed.0).collect(),
        scenario,
        role: role?,
        needs: wanted,
        strict,
        sweep,
        complete: complete.and_then(|(_, complete)| complete),
        depth,
        start: start?.0,
        covers: transitions,
        steps,
        source: source.clone(),
        at,
    })
}

const COUNTERS: &[(bool, &str)] = &[(false, "relative"), (true, "absolute")];

/// `{extra: 1, counters: absolute}`.
fn complete(source: &Arc<Source>, role: Role, node: &Node, problems: &mut Vec<Problem>) -> Complete {
    let mut fields = Fields::new(source, node, "`complete`", problems);
    let extra = fields.optional_number("extra", 0..=MOST as u64).unwrap_or(0) as usize;
    let absolute = fields.optional_word("counters", COUNTERS).unwrap_or(false);
    fields.finish(problems);
    Complete { role, extra, absolute }
}

fn is_case_id(id: &str) -> bool {
    id.split_once('-').is_some_and(|(letters, digits)| {
        (2..=5).contains(&letters.len())
            && letters.bytes().all(|octet| octet.is_ascii_uppercase())
            && digits.len() == 4
            && digits.bytes().all(|octet| octet.is_ascii_digit())
    })
}

/// Reads the start conditions.
///
/// # Errors
/// Every problem of the file.
pub fn starts(source: &Arc<Source>) -> Result<Vec<Start>, Vec<Problem>> {
    let root = yaml::parse(source).map_err(|problem| vec![problem])?;
    let mut problems = Vec::new();
    let mut found: Vec<Start> = Vec::new();
    for item in tree::list(source, &root, "the list of start conditions", &mut problems) {
        let mut fields = Fields::new(source, item, "a start condition", &mut problems);
        let name = fields.text("name");
        let role = fields.word("dut", ROLES);
        let about = fields.text("about").map(|placed| placed.0).unwrap_or_default();
        let after = fields.optional("after");
        let steps = fields.get("steps").cloned();
        fields.finish(&mut problems);
        let (Some((name, _)), Some(role)) = (name, role) else { continue };
        let known = || found.iter().filter(|start| start.role == role).map(|start| start.name.as_str());
        if let Some((after, at)) = &after
            && !known().any(|name| name == after)
        {
            let help = suggestion(after, known());
            problems.push(Problem::new(source, at.clone(), format!("no start condition `{after}` above")).help(help));
        }
        let steps = steps.unwrap_or(Node { at: item.at.clone(), value: Value::List(Vec::new()) });
        found.push(Start { name, role, about, after: after.map(|placed| placed.0), steps, source: source.clone() });
    }
    if problems.is_empty() { Ok(found) } else { Err(problems) }
}

impl Start {
    /// The steps that lead here from the start condition before it.
    pub fn steps(&self, problems: &mut Vec<Problem>) -> Vec<Step> {
        decode::steps(&self.source, self.role, &self.steps, problems)
    }
}

impl Case {
    /// The typed steps for one point of the sweep.
    pub fn steps(&self, binding: &Binding, problems: &mut Vec<Problem>) -> Vec<Step> {
        if let Some(complete) = self.complete {
            return complete.steps(&self.source, &self.at, binding, problems);
        }
        let mut used = BTreeSet::new();
        let steps = self.substitute(&self.steps, binding, &mut used, problems);
        for axis in self.sweep.iter().filter(|axis| !axis.is_of_the_dut() && !used.contains(&axis.name)) {
            let message = format!("the sweep over `{0}` changes nothing: no step uses `${0}`", axis.name);
            problems.push(Problem::new(&self.source, axis.at.clone(), message));
        }
        decode::steps(&self.source, self.role, &steps, problems)
    }

    /// `file:line` of the case.
    pub fn place(&self) -> String {
        format!("{}:{}", self.source.name, self.source.line_column(self.at.start).0)
    }

    fn substitute(
        &self,
        node: &Node,
        binding: &Binding,
        used: &mut BTreeSet<String>,
        problems: &mut Vec<Problem>,
    ) -> Node {
        let value = match &node.value {
            Value::Scalar(text) => match text.strip_prefix('$') {
                None => Value::Scalar(text.clone()),
                Some(name) => match binding.value(name) {
                    Some(value) => {
                        used.insert(name.to_owned());
                        Value::Scalar(value.to_owned())
                    }
                    None => {
                        let help = suggestion(name, self.sweep.iter().map(|axis| axis.name.as_str()));
                        let message = format!("`${name}` is no variable of the sweep");
                        problems.push(Problem::new(&self.source, node.at.clone(), message).help(help));
                        Value::Scalar("0".to_owned())
                    }
                },
            },
            Value::Null => Value::Null,
            Value::List(items) => {
                Value::List(items.iter().map(|item| self.substitute(item, binding, used, problems)).collect())
            }
            Value::Map(entries) => Value::Map(
                entries.iter().map(|(key, n)| (key.clone(), self.substitute(n, binding, used, problems))).collect(),
            ),
        };
        Node { at: node.at.clone(), value }
    }
}

impl Case {
    /// The points of the sweep for a DUT that offers this.
    ///
    /// # Errors
    /// A [`Problem`] when the sweep is too large.
    pub fn expand(&self, offers: &[fsct_adapters::Offer]) -> Result<Expansion, Problem> {
        let of_the_sweep = |offers: &[fsct_adapters::Offer]| sweep::expand(&self.source, &self.sweep, offers);
        match self.complete {
            Some(complete) => complete.expand(offers, of_the_sweep),
            None => of_the_sweep(offers),
        }
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use model::{Action, Exchange};

    /// An exchange with an FS-Device as it stands in a case.
    pub(crate) fn exchange(text: &str) -> Exchange {
        let source = Arc::new(Source { name: "my.yaml".into(), text: format!("- exchange: {text}") });
        let mut problems = Vec::new();
        let node = yaml::parse(&source).expect("sound YAML");
        let step = decode::steps(&source, Role::Device, &node, &mut problems).into_iter().next();
        assert!(problems.is_empty(), "{problems:?}");
        match step.map(|step| step.action) {
            Some(Action::Exchange(exchange)) => *exchange,
            other => panic!("no exchange: {other:?}"),
        }
    }
}
