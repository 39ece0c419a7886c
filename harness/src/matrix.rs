//! The error matrix: every error class of Table 27 in every waiting state, in both directions, with the case that shows it
//! or the reason why there is none.
//!
//! Data: `testcases/error-matrix.yaml`. The cases stand in the suites of the group [`GROUP`].

use crate::case::{Case, Suite};
use crate::problem::{Problem, Source, suggestion};
use crate::tree::{self, Fields};
use crate::yaml::{self, Node, Value};
use fsct_adapters::Role;
use fsct_reports::record::{MatrixCell, MatrixInfo, MatrixRow};
use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::ops::Range;
use std::sync::Arc;

/// Group of the suites whose cases stand in the matrix.
pub const GROUP: &str = "error-matrix";

/// The error classes of IEC 61784-3, as Table 27 lists them.
pub const CLASSES: [&str; 9] = [
    "corruption",
    "unintended repetition",
    "incorrect sequence",
    "loss",
    "unacceptable delay",
    "insertion",
    "masquerade",
    "addressing",
    "loop-back",
];

const ROLES: &[(Role, &str)] = &[(Role::Device, "device"), (Role::Master, "master")];
/// Direction of what is disturbed, seen from the DUT.
const DIRECTIONS: [&str; 2] = ["to", "from"];

/// The waiting states of a machine: those in which an error can reach it.
pub const fn states(role: Role) -> [(u8, &'static str); 3] {
    match role {
        Role::Device => [(21, "21"), (24, "24"), (26, "26")],
        Role::Master => [(2, "2"), (5, "5"), (7, "7")],
    }
}

/// What stands in a cell.
#[derive(Clone, Debug, PartialEq, Eq)]
enum Entry {
    /// The cases that show it, with their places.
    Cases(Vec<(String, Range<usize>)>),
    /// Why there is none.
    None(String),
}

/// One cell; those of a class stand in the order of [`columns`].
#[derive(Clone, Debug)]
struct Cell {
    class: usize,
    entry: Entry,
}

/// The matrix.
#[derive(Debug)]
pub struct Matrix {
    source: Arc<Source>,
    /// The cells of each role, class by class.
    roles: Vec<(Role, Vec<Cell>)>,
}

impl Matrix {
    /// Reads the matrix.
    ///
    /// # Errors
    /// Every problem that can be told without knowing the cases; a hole is one.
    pub fn parse(source: &Arc<Source>) -> Result<Matrix, Vec<Problem>> {
        let root = yaml::parse(source).map_err(|problem| vec![problem])?;
        let mut problems = Vec::new();
        let mut roles = Vec::new();
        for item in tree::list(source, &root, "the error matrix", &mut problems) {
            let mut fields = Fields::new(source, item, "a role of the matrix", &mut problems);
            let role = fields.word("dut", ROLES);
            let classes = fields.get("classes");
            fields.finish(&mut problems);
            let (Some(role), Some(classes)) = (role, classes) else { continue };
            roles.push((role, Reader { source, role, problems: &mut problems }.classes(classes)));
        }
        for (role, name) in ROLES {
            if roles.iter().filter(|(known, _)| known == role).count() != 1 {
                let message = format!("the error matrix has to have one part with `dut: {name}`");
                problems.push(Problem::new(source, root.at.clone(), message));
            }
        }
        if problems.is_empty() { Ok(Matrix { source: source.clone(), roles }) } else { Err(problems) }
    }

    /// Checks the matrix against the cases: every case it names exists, and every case of its suites stands in it.
    pub fn check(&self, suites: &[Suite], problems: &mut Vec<Problem>) {
        let mut listed = BTreeSet::new();
        for (role, cells) in &self.roles {
            let known = || members(suites).filter(|case| case.role == *role).map(|case| case.id.as_str());
            for (id, at) in cells.iter().flat_map(Cell::cases) {
                listed.insert(id.as_str());
                if !known().any(|known| known == id) {
                    let message = format!("the error matrix names `{id}`, which is no case of `{GROUP}` for a {role}");
                    let help = suggestion(id, known().collect::<Vec<_>>());
                    problems.push(Problem::new(&self.source, at.clone(), message).help(help));
                }
            }
        }
        for case in members(suites).filter(|case| !listed.contains(case.id.as_str())) {
            let message = format!("case {} of `{GROUP}` stands in no cell of {}", case.id, self.source.name);
            problems.push(Problem::new(&case.source, case.at.clone(), message));
        }
    }

    /// What a record says of it: the parts for these roles.
    pub fn info(&self, roles: &[Role]) -> Vec<MatrixInfo> {
        let wanted = self.roles.iter().filter(|(role, _)| roles.contains(role));
        let row = |cells: &[Cell], class: usize, name: &str| MatrixRow {
            class: name.to_owned(),
            cells: cells.iter().filter(|cell| cell.class == class).map(Cell::info).collect(),
        };
        wanted
            .map(|(role, cells)| MatrixInfo {
                role: role.to_string(),
                columns: columns(*role).map(|(direction, state, _)| heading(direction, state)).collect(),
                rows: CLASSES.iter().enumerate().map(|(class, name)| row(cells, class, name)).collect(),
            })
            .collect()
    }

    /// The matrix as a text: one table a role, reasons below it by number.
    pub fn text(&self) -> String {
        let mut text = String::new();
        for info in self.info(&[Role::Device, Role::Master]) {
            let mut reasons: Vec<&str> = Vec::new();
            let mut rows = vec![std::iter::once(String::new()).chain(info.columns.iter().cloned()).collect::<Vec<_>>()];
            for row in &info.rows {
                let cells = row.cells.iter().map(|cell| match cell.cases.as_slice() {
                    [] => {
                        let known = reasons.iter().position(|reason| *reason == cell.none);
                        let number = known.unwrap_or(reasons.len());
                        if known.is_none() {
                            reasons.push(&cell.none);
                        }
                        format!("none ({})", number + 1)
                    }
                    cases => cases.join(" "),
                });
                rows.push(std::iter::once(row.class.clone()).chain(cells).collect());
            }
            let width =
                |column: usize| rows.iter().filter_map(|row| row.get(column)).map(String::len).max().unwrap_or(0);
            let _ = writeln!(text, "{}FS-{}", if text.is_empty() { "" } else { "\n" }, title(&info.role));
            for row in &rows {
                let line: Vec<String> =
                    (0..).zip(row).map(|(column, cell)| format!("{cell:<width$}", width = width(column))).collect();
                let _ = writeln!(text, "{}", line.join("  ").trim_end());
            }
            for (number, reason) in (1..).zip(reasons) {
                let _ = writeln!(text, "({number}) {reason}");
            }
        }
        text.truncate(text.trim_end().len());
        text
    }
}

/// The cases that belong into the matrix.
fn members(suites: &[Suite]) -> impl Iterator<Item = &Case> {
    suites.iter().filter(|suite| suite.group.as_deref() == Some(GROUP)).flat_map(|suite| &suite.cases)
}

/// Directions and states of a role, with the state as written.
fn columns(role: Role) -> impl Iterator<Item = (&'static str, u8, &'static str)> {
    DIRECTIONS.into_iter().flat_map(move |direction| states(role).map(|(state, text)| (direction, state, text)))
}

fn heading(direction: &str, state: u8) -> String {
    format!("{direction} DUT, state {state}")
}

fn title(role: &str) -> &str {
    if role == "master" { "Master" } else { "Device" }
}

impl Cell {
    fn cases(&self) -> &[(String, Range<usize>)] {
        match &self.entry {
            Entry::Cases(cases) => cases,
            Entry::None(_) => &[],
        }
    }

    fn info(&self) -> MatrixCell {
        let none = match &self.entry {
            Entry::Cases(_) => String::new(),
            Entry::None(reason) => reason.clone(),
        };
        MatrixCell { cases: self.cases().iter().map(|(id, _)| id.clone()).collect(), none }
    }
}

struct Reader<'a> {
    source: &'a Arc<Source>,
    role: Role,
    problems: &'a mut Vec<Problem>,
}

impl Reader<'_> {
    fn problem(&mut self, at: &Range<usize>, message: String) {
        self.problems.push(Problem::new(self.source, at.clone(), message));
    }

    fn classes(&mut self, node: &Node) -> Vec<Cell> {
        let mut fields = Fields::new(self.source, node, "`classes`", self.problems);
        let rows: Vec<_> = CLASSES.iter().map(|class| fields.get(class)).collect();
        fields.finish(self.problems);
        let mut cells = Vec::new();
        for ((class, name), row) in CLASSES.iter().enumerate().zip(rows) {
            let Some(row) = row else {
                self.problem(&node.at, format!("the error matrix for a {} has no row `{name}`", self.role));
                continue;
            };
            let mut fields = Fields::new(self.source, row, "a row of the matrix", self.problems);
            let directions = DIRECTIONS.map(|direction| (direction, fields.get(direction)));
            fields.finish(self.problems);
            for (direction, node) in directions {
                let mut by_state = node.map(|node| Fields::new(self.source, node, "a direction", self.problems));
                let found = states(self.role).map(|(state, text)| (state, by_state.as_mut().and_then(|f| f.get(text))));
                if let Some(fields) = by_state {
                    fields.finish(self.problems);
                }
                for (state, entry) in found {
                    let Some(entry) = entry else {
                        let message = format!("the error matrix has a hole: {name}, {}", heading(direction, state));
                        let remedy = "name the case, such as `24: FSD-1501`, or say `24: {none: why}`";
                        self.problems.push(Problem::new(self.source, row.at.clone(), message).help(remedy));
                        continue;
                    };
                    cells.extend(self.entry(entry).map(|entry| Cell { class, entry }));
                }
            }
        }
        cells
    }

    fn entry(&mut self, node: &Node) -> Option<Entry> {
        match &node.value {
            Value::Map(_) => {
                let mut fields = Fields::new(self.source, node, "an empty cell", self.problems);
                let reason = fields.text("none").map(|placed| placed.0);
                fields.finish(self.problems);
                reason.map(Entry::None)
            }
            Value::Scalar(text) => Some(Entry::Cases(vec![(text.clone(), node.at.clone())])),
            Value::List(items) if !items.is_empty() => {
                Some(Entry::Cases(items.iter().filter_map(tree::scalar).collect()))
            }
            _ => {
                self.problem(&node.at, "a cell names its cases, or says `none` and why".to_owned());
                None
            }
        }
    }
}
