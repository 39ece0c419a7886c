//! Reads `testcases/limits.yaml`: times and electrical limits of both editions, by symbol.

use crate::ledger::Ledger;
use crate::problem::{Problem, Source, suggestion};
use crate::tree;
use crate::yaml::{self, Node};
use fsct_lines::{Limit, Limits, Outside, Quantity, Row, Subject, Unit, Verify};
use std::collections::BTreeSet;
use std::sync::Arc;

/// The limits, and where each names a requirement.
#[derive(Debug, Default)]
pub struct Table {
    /// The limits.
    pub limits: Limits,
    cited: Vec<(Arc<Source>, tree::Placed)>,
}

impl Table {
    /// Checks the limits against the ledger and against what is measured.
    pub fn check(&self, ledger: &Ledger, problems: &mut Vec<Problem>) {
        for (source, (id, at)) in self.cited.iter().filter(|(_, (id, _))| ledger.get(id).is_none()) {
            let message = format!("a limit names an unknown requirement `{id}`");
            problems.push(Problem::new(source, at.clone(), message).help(suggestion(id, ledger.ids())));
        }
        let Some((source, _)) = self.cited.first() else { return };
        for (quantity, symbol) in Quantity::ALL {
            let known = self
                .limits
                .get(symbol)
                .is_some_and(|limit| limit.unit.nano().is_some() && (limit.unit == Unit::One) == quantity.is_ratio());
            if !known {
                let message = format!("has no limit `{symbol}` in a unit it is measured in");
                problems.push(Problem::without_place(&source.name, message));
            }
        }
    }
}

/// Reads the file.
///
/// # Errors
/// Every problem of it.
pub fn parse(source: &Arc<Source>) -> Result<Table, Vec<Problem>> {
    let root = yaml::parse(source).map_err(|problem| vec![problem])?;
    let mut problems = Vec::new();
    let mut limits = Vec::new();
    let mut cited = Vec::new();
    let mut symbols = BTreeSet::new();
    for entry in tree::list(source, &root, "the list of limits", &mut problems) {
        let Some((limit, at)) = limit(source, entry, &mut cited, &mut problems) else { continue };
        if symbols.insert(limit.symbol.clone()) {
            limits.push(limit);
        } else {
            problems.push(Problem::new(source, at, format!("there is a limit `{}` already", limit.symbol)));
        }
    }
    if problems.is_empty() { Ok(Table { limits: Limits::new(limits), cited }) } else { Err(problems) }
}

fn limit(
    source: &Arc<Source>,
    entry: &Node,
    cited: &mut Vec<(Arc<Source>, tree::Placed)>,
    problems: &mut Vec<Problem>,
) -> Option<(Limit, std::ops::Range<usize>)> {
    let mut fields = tree::Fields::new(source, entry, "a limit", problems);
    let symbol = fields.text("symbol");
    let about = fields.text("about");
    let dut = fields.word("dut", &Subject::ALL);
    let unit = fields.word("unit", &Unit::ALL);
    let v1_1 = fields.get("v1.1");
    let iec2022 = fields.get("iec2022");
    let open = fields.texts("open");
    let why = fields.optional("why");
    let verify = fields.word("verify", &Verify::ALL);
    let requirements = fields.texts("requirements");
    let at = symbol.as_ref().map(|(_, at)| at.clone()).unwrap_or_default();
    if symbol.is_some() && v1_1.is_none() && iec2022.is_none() {
        fields.problem(at.clone(), "a limit needs the values of `v1.1`, of `iec2022` or of both");
    }
    if symbol.is_some() && requirements.is_empty() {
        fields.problem(at.clone(), "a limit needs `requirements`");
    }
    let name = |id: &str| id.len() == 3 && id.starts_with(['L', 'A']) && id[1..].bytes().all(|c| c.is_ascii_digit());
    for (id, at) in open.iter().filter(|(id, _)| !name(id)) {
        fields.problem(at.clone(), format!("`{id}` is no open point, L01 and A24 are"));
    }
    fields.finish(problems);
    let v1_1 = v1_1.and_then(|node| row(source, node, problems));
    let iec2022 = iec2022.and_then(|node| row(source, node, problems));
    cited.extend(requirements.iter().map(|placed| (source.clone(), placed.clone())));
    let texts = |placed: Vec<tree::Placed>| placed.into_iter().map(|(text, _)| text).collect();
    let limit = Limit {
        symbol: symbol?.0,
        about: about?.0,
        dut: dut?,
        unit: unit?,
        v1_1,
        iec2022,
        open: texts(open),
        why: why.map(|(text, _)| text),
        verify: verify?,
        requirements: texts(requirements),
    };
    Some((limit, at))
}

fn row(source: &Arc<Source>, node: &Node, problems: &mut Vec<Problem>) -> Option<Row> {
    let mut fields = tree::Fields::new(source, node, "the values of an edition", problems);
    let mut number = |key: &'static str| {
        let (text, at) = fields.optional(key)?;
        let value = text.parse::<f64>().ok().filter(|value| value.is_finite());
        if value.is_none() {
            fields.problem(at, format!("`{key}` has to be a number, not `{text}`"));
        }
        value
    };
    let (min, max) = (number("min"), number("max"));
    let min_from = fields.optional("min_from").map(|(text, _)| text);
    let max_from = fields.optional("max_from").map(|(text, _)| text);
    let clause = fields.text("clause");
    let base = fields.optional_word("base", &[(true, "true"), (false, "false")]).unwrap_or(false);
    let outside = fields.optional_word("outside", &Outside::ALL).unwrap_or(Outside::Fail);
    if let (Some(min), Some(max)) = (min, max)
        && min > max
    {
        let at = clause.as_ref().map(|(_, at)| at.clone()).unwrap_or_default();
        fields.problem(at, format!("the smallest value {min} exceeds the largest {max}"));
    }
    fields.finish(problems);
    Some(Row { min, max, min_from, max_from, clause: clause?.0, base, outside })
}
