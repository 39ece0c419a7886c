//! Whether several DUTs of one role fared alike: one case, every adapter.

use crate::record::{CaseRecord, DutInfo, Execution};
use crate::summary::{execution_name, verdict_name};
use serde::Serialize;
use std::collections::BTreeMap;

/// A case that did not come to the same on every DUT of its role.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Differing {
    /// Key of the case.
    pub key: String,
    /// Number of each DUT of the role, counted from 0 as in the header, with its verdict; the outcome of the execution where
    /// that is not `ok`, `not run` where the case did not run on this DUT.
    pub outcomes: Vec<(usize, &'static str)>,
}

/// Takes the cases of a run as they come.
#[derive(Debug)]
pub(crate) struct Comparison {
    /// The DUTs that are compared, by role; roles with a single DUT are left out, so that most runs keep nothing.
    duts: BTreeMap<String, Vec<usize>>,
    outcomes: BTreeMap<(String, String), BTreeMap<usize, &'static str>>,
}

impl Comparison {
    pub(crate) fn of(duts: &[DutInfo]) -> Comparison {
        let mut by_role: BTreeMap<String, Vec<usize>> = BTreeMap::new();
        duts.iter().enumerate().for_each(|(number, dut)| by_role.entry(dut.role.clone()).or_default().push(number));
        by_role.retain(|_, duts| duts.len() > 1);
        Comparison { duts: by_role, outcomes: BTreeMap::new() }
    }

    pub(crate) fn add(&mut self, case: &CaseRecord) {
        if !self.duts.contains_key(&case.role) {
            return;
        }
        let outcome = match case.execution {
            Execution::Ok => verdict_name(case.verdict),
            execution => execution_name(execution),
        };
        self.outcomes.entry((case.role.clone(), case.key.clone())).or_default().insert(case.dut, outcome);
    }

    /// The number of cases compared, and those that differ; `None` when there was nothing to compare.
    pub(crate) fn end(self) -> Option<(usize, Vec<Differing>)> {
        if self.duts.is_empty() {
            return None;
        }
        let compared = self.outcomes.len();
        let differing = self.outcomes.into_iter().filter_map(|((role, key), found)| {
            let duts = self.duts.get(&role)?;
            let outcomes: Vec<_> =
                duts.iter().map(|dut| (*dut, found.get(dut).copied().unwrap_or("not run"))).collect();
            let alike = outcomes.windows(2).all(|pair| matches!(pair, [(_, one), (_, other)] if one == other));
            (!alike).then_some(Differing { key, outcomes })
        });
        Some((compared, differing.collect()))
    }
}
