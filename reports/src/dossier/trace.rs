//! Traceability both ways: what was concluded on each statement, from which cases, and which statements a case judges. Verdicts are
//! taken from the records as they stand; a statement is as bad as the worst case that judges it.

use super::tool::{Statement, Tool};
use crate::html::word;
use crate::journal::Run;
use crate::record::CaseRecord;
use std::collections::{BTreeMap, BTreeSet};

/// What can be said of a statement, worst first.
#[derive(Copy, Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum State {
    /// A case that judges it failed.
    Failed,
    /// A case that judges it was not executed as meant, and none failed.
    NotExecuted,
    /// A case that judges it came to no conclusion.
    Inconclusive,
    /// Every case that judges it passed, one with a remark at least.
    Remark,
    /// Every case that judges it passed.
    Passed,
    /// The oracle judges it in every exchange, and no case failed.
    ByOracle,
    /// The cases for it do not apply to this product.
    NotApplicable,
    /// There are cases, none of them is in the records.
    NotRun,
    /// `fsct iodd` judges it, which leaves no record.
    Iodd,
    /// Needs instruments.
    Bench,
    /// A person reads documents.
    Inspection,
    /// Cannot be judged from outside.
    Untestable,
    /// Its cases are for the other side of the link.
    OtherSide,
    /// Nothing is done about it yet.
    Open,
}

impl State {
    /// All of them, in the order they are told.
    pub const ALL: [State; 14] = [
        State::Failed,
        State::NotExecuted,
        State::Inconclusive,
        State::Remark,
        State::Passed,
        State::ByOracle,
        State::NotApplicable,
        State::NotRun,
        State::Iodd,
        State::Bench,
        State::Inspection,
        State::Untestable,
        State::OtherSide,
        State::Open,
    ];

    /// In a word, with a sign, so that no colour is needed.
    pub const fn said(self) -> &'static str {
        match self {
            State::Failed => "✗ failed",
            State::NotExecuted => "! not executed as meant",
            State::Inconclusive => "? inconclusive",
            State::Remark => "● passed with remarks",
            State::Passed => "✓ passed",
            State::ByOracle => "✓ by the oracle",
            State::NotApplicable => "– does not apply",
            State::NotRun => "○ not run",
            State::Iodd => "○ by fsct iodd",
            State::Bench => "□ bench",
            State::Inspection => "□ inspection",
            State::Untestable => "□ untestable",
            State::OtherSide => "○ other side",
            State::Open => "○ open",
        }
    }

    /// What it means, for the legend.
    pub const fn means(self) -> &'static str {
        match self {
            State::Failed => "a case that judges it failed",
            State::NotExecuted => "a case that judges it was not executed as meant",
            State::Inconclusive => "a case that judges it came to no conclusion",
            State::Remark => {
                "all cases that judge it passed, with a remark at least once: a reading let pass, or a recommendation not followed"
            }
            State::Passed => "all cases that judge it passed",
            State::ByOracle => "compared with the tables in every exchange of every case, and no case failed",
            State::NotApplicable => "its cases do not apply to this product; the reason is in Annex C",
            State::NotRun => "there are cases, and none of them is in these records",
            State::Iodd => "judged in the IODD by fsct iodd, whose outcome is no record",
            State::Bench => "needs instruments",
            State::Inspection => "a person has to read documents or look at the product",
            State::Untestable => "cannot be judged from outside",
            State::OtherSide => "concerns both sides, and its cases are for the other side of the link",
            State::Open => "nothing is done about it yet; why is in Annex A",
        }
    }

    /// Whether something has been concluded on it.
    pub const fn is_judged(self) -> bool {
        matches!(self, State::Failed | State::Inconclusive | State::Remark | State::Passed | State::ByOracle)
    }
}

/// A statement with what is known of it.
#[derive(Clone, Debug)]
pub struct Traced {
    /// The statement.
    pub statement: Statement,
    /// What can be said.
    pub state: State,
    /// Ids of the cases that judge it and are in the records.
    pub cases: BTreeSet<String>,
    /// Points of them.
    pub points: usize,
    /// Ids of cases for this role that judge it and are not in the records.
    pub absent: BTreeSet<String>,
}

/// A case with what it came to.
#[derive(Clone, Debug, Default)]
pub struct Judged {
    /// What it shows.
    pub title: String,
    /// Its suite.
    pub suite: String,
    /// Verdicts with signs, and how many of its points came to each.
    pub verdicts: BTreeMap<&'static str, usize>,
    /// Statements it judges.
    pub requirements: BTreeSet<String>,
}

/// Both directions.
#[derive(Clone, Debug, Default)]
pub struct Trace {
    /// Statements that concern the product, in the order of the ledger.
    pub statements: Vec<Traced>,
    /// How many concern others: the other role, a tool, another edition.
    pub others: usize,
    /// Cases by id.
    pub cases: BTreeMap<String, Judged>,
}

impl Trace {
    /// Follows every statement to its cases and every case to its statements.
    pub fn of(tool: &Tool, role: &str, editions: &BTreeSet<String>, run: &Run) -> Trace {
        let mut judging: BTreeMap<&str, Vec<&CaseRecord>> = BTreeMap::new();
        let mut cases: BTreeMap<String, Judged> = BTreeMap::new();
        for case in &run.cases {
            case.requirements.iter().for_each(|one| judging.entry(&one.id).or_default().push(case));
            let judged = cases.entry(case.id.clone()).or_default();
            judged.title.clone_from(&case.title);
            judged.suite.clone_from(&case.suite);
            *judged.verdicts.entry(word(case).0).or_default() += 1;
            judged.requirements.extend(case.requirements.iter().map(|one| one.id.clone()));
        }
        let left_out: BTreeSet<&str> =
            run.header.not_applicable.iter().filter_map(|(key, _)| key.split('[').next()).collect();
        let concerns = |one: &&Statement| {
            let role_fits = one.dut == role || one.dut == "both" || one.dut == "iodd" && role == "device";
            judging.contains_key(one.id.as_str())
                || role_fits && editions.iter().any(|edition| one.clauses.contains_key(edition))
        };
        let mut known: BTreeMap<&str, Vec<&str>> = BTreeMap::new();
        for case in tool.cases.iter().filter(|case| case.role == role) {
            case.requirements.iter().for_each(|id| known.entry(id).or_default().push(&case.id));
        }
        let trace = |statement: &Statement| {
            let judges = judging.get(statement.id.as_str()).map_or(&[][..], Vec::as_slice);
            let ids: BTreeSet<String> = judges.iter().map(|case| case.id.clone()).collect();
            let for_it = known.get(statement.id.as_str()).map_or(&[][..], Vec::as_slice);
            let absent: BTreeSet<String> =
                for_it.iter().filter(|id| !ids.contains(**id)).map(|id| (*id).to_owned()).collect();
            let state = match worst(judges) {
                Some(state) => state,
                None if !absent.is_empty() && absent.iter().all(|id| left_out.contains(id.as_str())) => {
                    State::NotApplicable
                }
                None if !absent.is_empty() => State::NotRun,
                None => unjudged(statement, run),
            };
            Traced { statement: statement.clone(), state, cases: ids, points: judges.len(), absent }
        };
        let statements: Vec<Traced> = tool.statements.iter().filter(concerns).map(trace).collect();
        Trace { others: tool.statements.len() - statements.len(), statements, cases }
    }

    /// Statements of a state.
    pub fn in_state(&self, state: State) -> impl Iterator<Item = &Traced> {
        self.statements.iter().filter(move |one| one.state == state)
    }
}

/// The worst that its cases came to; `None` where none has anything to say.
fn worst(cases: &[&CaseRecord]) -> Option<State> {
    let state = |case: &&CaseRecord| match word(case).1 {
        "fail" => State::Failed,
        "pass" => State::Passed,
        "soft" => State::NotApplicable,
        "remark" => State::Remark,
        "inconclusive" => State::Inconclusive,
        _ => State::NotExecuted,
    };
    cases.iter().map(state).min()
}

/// A statement that no case of the suites is about.
fn unjudged(statement: &Statement, run: &Run) -> State {
    let saw = |class| run.cases.iter().any(|case| word(case).1 == class);
    match statement.class.as_str() {
        "implicit" if statement.dut == "iodd" => State::Iodd,
        // A failure cannot be laid at the door of one of them.
        "implicit" if saw("fail") => State::Inconclusive,
        "implicit" if saw("pass") || saw("remark") => State::ByOracle,
        "implicit" => State::NotRun,
        "bench" => State::Bench,
        "inspection" => State::Inspection,
        "untestable" => State::Untestable,
        "tested" => State::OtherSide,
        _ => State::Open,
    }
}
