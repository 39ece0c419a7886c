//! `summary.json`: the run in a few numbers, and the exit code.

use crate::journal::Run;
use crate::record::{DutInfo, Execution, Verdict};
use serde::Serialize;
use std::collections::BTreeMap;

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
    /// Tolerances made use of, with the number of cases.
    pub tolerances: BTreeMap<String, usize>,
    /// Seed.
    pub seed: u64,
    /// The device under test, in its own words.
    pub dut: DutInfo,
    /// Expanded cases planned.
    pub planned: usize,
    /// Cases left out because they do not apply.
    pub not_applicable: usize,
    /// The run did not come to its end: cut off, interrupted, or fewer cases than planned.
    pub partial: bool,
}

impl Summary {
    /// Sums up a run.
    pub fn of(run: &Run) -> Summary {
        let verdicts = [Verdict::NotApplicable, Verdict::Pass, Verdict::Remark, Verdict::Inconclusive, Verdict::Fail]
            .map(verdict_name);
        let executions = [
            Execution::Ok,
            Execution::Timeout,
            Execution::DutError,
            Execution::RigError,
            Execution::ToolError,
            Execution::Aborted,
        ];
        let machine = if run.header.dut.role == "master" { 1..=14 } else { 20..=31 };
        let mut summary = Summary {
            cases: run.cases.len(),
            verdicts: verdicts.iter().map(|name| ((*name).to_owned(), 0)).collect(),
            execution: executions.map(execution_name).iter().map(|name| ((*name).to_owned(), 0)).collect(),
            transitions: machine.map(|number| (format!("T{number}"), 0)).collect(),
            tolerances: BTreeMap::new(),
            seed: run.header.seed,
            dut: run.header.dut.clone(),
            planned: run.header.planned,
            not_applicable: run.header.not_applicable.len(),
            partial: run.footer.as_ref().is_none_or(|footer| footer.interrupted)
                || run.damaged.is_some()
                || run.cases.len() < run.header.planned,
        };
        for case in &run.cases {
            *summary.verdicts.entry(verdict_name(case.verdict).to_owned()).or_default() += 1;
            *summary.execution.entry(execution_name(case.execution).to_owned()).or_default() += 1;
            for (transition, count) in &case.transitions {
                *summary.transitions.entry(transition.clone()).or_default() += count;
            }
            for tolerance in case.tolerances.keys() {
                *summary.tolerances.entry(tolerance.clone()).or_default() += 1;
            }
        }
        summary
    }

    /// Cases with this verdict.
    pub fn count(&self, verdict: Verdict) -> usize {
        self.verdicts.get(verdict_name(verdict)).copied().unwrap_or(0)
    }

    /// The exit code of the run. These never change:
    ///
    /// | code | when, the first that holds |
    /// |---|---|
    /// | 4 | nothing ran: no case is recorded |
    /// | 1 | a case failed |
    /// | 3 | a case was not executed as meant, or the run did not come to its end |
    /// | 5 | a case is inconclusive |
    /// | 0 | conformant |
    pub fn exit_code(&self) -> u8 {
        let executed = self.execution.get(execution_name(Execution::Ok)).copied().unwrap_or(0);
        match () {
            () if self.cases == 0 && !self.partial => 4,
            () if self.count(Verdict::Fail) > 0 => 1,
            () if self.partial || executed < self.cases => 3,
            () if self.count(Verdict::Inconclusive) > 0 => 5,
            () => 0,
        }
    }
}

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
