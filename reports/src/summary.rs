//! `summary.json`: the run in a few numbers, and the exit code.

use crate::compare::{Comparison, Differing};
use crate::complete::Complete;
use crate::coverage::Coverage;
use crate::decode::Side;
use crate::journal::{ReadError, Reader, Run};
use crate::machine::Machine;
use crate::record::{CaseRecord, DutInfo, Execution, Footer, Header, Verdict};
use serde::Serialize;
use std::collections::BTreeMap;
use std::path::Path;

/// The run in a few numbers.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Summary {
    /// Expanded cases recorded.
    pub cases: usize,
    /// Cases per verdict, all verdicts named.
    pub verdicts: BTreeMap<String, usize>,
    /// Cases per outcome of the execution, all named.
    pub execution: BTreeMap<String, usize>,
    /// How often each transition of the DUT's machine was taken, over all cases.
    pub transitions: BTreeMap<String, u64>,
    /// How far each machine was led beyond single transitions; empty for a record without goals.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub coverage: Vec<Coverage>,
    /// What complete suites showed.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub complete: Vec<Complete>,
    /// Tolerances made use of, with the number of cases.
    pub tolerances: BTreeMap<String, usize>,
    /// Seed.
    pub seed: u64,
    /// The devices under test, in their own words.
    #[serde(rename = "dut")]
    pub duts: Vec<DutInfo>,
    /// Expanded cases planned.
    pub planned: usize,
    /// Cases left out because they do not apply.
    pub not_applicable: usize,
    /// The run did not come to its end: cut off, interrupted, or with fewer cases than planned or counted at the end.
    pub partial: bool,
    /// Cases that ran on more than one DUT; `null` when no role has several.
    pub compared: Option<usize>,
    /// Those that did not come to the same everywhere.
    pub differing: Vec<Differing>,
}

impl Summary {
    /// Sums up a run.
    pub fn of(run: &Run) -> Summary {
        let mut summary = Summary::begin(&run.header);
        let mut comparison = Comparison::of(&run.header.duts);
        run.cases.iter().for_each(|case| {
            summary.add(case);
            comparison.add(case);
        });
        summary.end(&run.header, run.footer.as_ref(), run.damaged.is_some(), comparison);
        summary
    }

    /// Sums up the journal of a folder, one case at a time: flat in memory however long the run was, but for the keys where
    /// several DUTs are compared.
    ///
    /// # Errors
    /// [`ReadError`].
    pub fn read(folder: &Path) -> Result<Summary, ReadError> {
        let mut reader = Reader::open(folder)?;
        let mut summary = Summary::begin(reader.header());
        let mut comparison = Comparison::of(&reader.header().duts);
        for case in reader.by_ref() {
            let case = case?;
            summary.add(&case);
            comparison.add(&case);
        }
        summary.end(reader.header(), reader.footer(), reader.damaged().is_some(), comparison);
        Ok(summary)
    }

    fn begin(header: &Header) -> Summary {
        let roles: Vec<Side> = header.duts.iter().map(|dut| Side::of(&dut.role)).collect();
        Summary {
            cases: 0,
            verdicts: VERDICTS.map(|verdict| (verdict_name(verdict).to_owned(), 0)).into(),
            execution: EXECUTIONS.map(|execution| (execution_name(execution).to_owned(), 0)).into(),
            transitions: roles.iter().flat_map(|side| side.transitions()).map(|name| (name, 0)).collect(),
            coverage: Coverage::begin(header),
            complete: Complete::begin(header),
            tolerances: BTreeMap::new(),
            seed: header.seed,
            duts: header.duts.clone(),
            planned: header.planned,
            not_applicable: header.not_applicable.len(),
            partial: true,
            compared: None,
            differing: Vec::new(),
        }
    }

    fn add(&mut self, case: &CaseRecord) {
        self.cases += 1;
        *self.verdicts.entry(verdict_name(case.verdict).to_owned()).or_default() += 1;
        *self.execution.entry(execution_name(case.execution).to_owned()).or_default() += 1;
        for (transition, count) in &case.transitions {
            let sum = self.transitions.entry(transition.clone()).or_default();
            *sum = sum.saturating_add(*count);
        }
        if let Some(machine) = self.coverage.iter_mut().find(|machine| machine.role == case.role) {
            machine.add(case);
        }
        self.complete.iter_mut().for_each(|suite| suite.add(case));
        for tolerance in case.tolerances.keys() {
            *self.tolerances.entry(tolerance.clone()).or_default() += 1;
        }
    }

    fn end(&mut self, header: &Header, footer: Option<&Footer>, damaged: bool, comparison: Comparison) {
        self.coverage.iter_mut().for_each(|machine| machine.end(header));
        self.complete.iter_mut().for_each(Complete::end);
        if let Some((compared, differing)) = comparison.end() {
            self.compared = Some(compared);
            self.differing = differing;
        }
        let complete = footer.is_some_and(|footer| !footer.interrupted && footer.cases == self.cases);
        self.partial = damaged || !complete || self.cases < self.planned;
    }

    /// Cases with this verdict.
    pub fn count(&self, verdict: Verdict) -> usize {
        self.verdicts.get(verdict_name(verdict)).copied().unwrap_or(0)
    }

    /// The transitions that no case took, in the order of the standard's tables.
    pub fn not_taken(&self) -> Vec<String> {
        let all = Machine::ALL.into_iter().flat_map(Machine::transitions);
        all.filter(|name| self.transitions.get(name) == Some(&0)).collect()
    }

    /// The exit code of the run. These never change:
    ///
    /// | code | when, the first that holds |
    /// |---|---|
    /// | 4 | nothing ran: no case is recorded, or none that applies |
    /// | 1 | a case failed |
    /// | 3 | a case was not executed as meant, or the run did not come to its end |
    /// | 5 | a case is inconclusive, also beside passes: a gate must not be green while something is open |
    /// | 0 | conformant: passes and remarks |
    pub fn exit_code(&self) -> u8 {
        let executed = self.execution.get(execution_name(Execution::Ok)).copied().unwrap_or(0);
        match () {
            () if self.cases == self.count(Verdict::NotApplicable) => 4,
            () if self.count(Verdict::Fail) > 0 => 1,
            () if self.partial || executed < self.cases => 3,
            () if self.count(Verdict::Inconclusive) > 0 => 5,
            () => 0,
        }
    }
}

const VERDICTS: [Verdict; 5] =
    [Verdict::NotApplicable, Verdict::Pass, Verdict::Remark, Verdict::Inconclusive, Verdict::Fail];

const EXECUTIONS: [Execution; 6] = [
    Execution::Ok,
    Execution::Timeout,
    Execution::DutError,
    Execution::RigError,
    Execution::ToolError,
    Execution::Aborted,
];

/// A verdict as written in records.
pub const fn verdict_name(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::NotApplicable => "not-applicable",
        Verdict::Pass => "pass",
        Verdict::Remark => "remark",
        Verdict::Inconclusive => "inconclusive",
        Verdict::Fail => "fail",
    }
}

/// An outcome of the execution as written in records.
pub const fn execution_name(execution: Execution) -> &'static str {
    match execution {
        Execution::Ok => "ok",
        Execution::Timeout => "timeout",
        Execution::DutError => "dut-error",
        Execution::RigError => "rig-error",
        Execution::ToolError => "tool-error",
        Execution::Aborted => "aborted",
    }
}
