//! Which way the conditions of a machine have decided, and whether its timers were seen to expire and not to.

use crate::coverage::Reached;
use crate::record::{CaseRecord, ConditionInfo, MachineInfo};
use serde::Serialize;
use std::collections::BTreeMap;

/// The conditions of one machine, over all cases.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Asked {
    /// Sides of guard conditions: `D22-SIGNATURE false`.
    pub guards: Reached,
    /// Sides of timers: `DTIMER-24 expired`.
    pub timers: Reached,
    /// For a side that was not seen the case that came nearest: it had the other side, or at least took one of the transitions.
    pub nearest: BTreeMap<String, String>,
    #[serde(skip)]
    conditions: Vec<(ConditionInfo, Near)>,
}

/// The case that came nearest to the sides of a condition, by what it had of it.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
struct Near {
    sides: BTreeMap<String, String>,
    row: Option<String>,
}

impl Asked {
    pub(crate) fn begin(machine: &MachineInfo) -> Option<Asked> {
        (!machine.conditions.is_empty()).then(|| Asked {
            guards: Reached::begin(&machine.guards),
            timers: Reached::begin(&machine.timers),
            nearest: BTreeMap::new(),
            conditions: machine.conditions.iter().map(|condition| (condition.clone(), Near::default())).collect(),
        })
    }

    pub(crate) fn add(&mut self, case: &CaseRecord) {
        self.guards.add(&case.walked.guards);
        self.timers.add(&case.walked.timers);
        for (condition, near) in &mut self.conditions {
            for side in case.walked.guards.iter().chain(&case.walked.timers).filter(|side| of(side) == condition.id) {
                near.sides.entry(side.clone()).or_insert_with(|| case.key.clone());
            }
            if near.row.is_none() && condition.rows.split(' ').any(|row| case.transitions.contains_key(row)) {
                near.row = Some(case.key.clone());
            }
        }
    }

    pub(crate) fn end(&mut self, machine: &MachineInfo) {
        self.guards.end(&machine.guards);
        self.timers.end(&machine.timers);
        for side in self.guards.missing.iter().chain(&self.timers.missing) {
            let near = self.conditions.iter().find(|(condition, _)| condition.id == of(side)).map(|(_, near)| near);
            let other = near.and_then(|near| near.sides.values().next().or(near.row.as_ref()));
            if let Some(key) = other {
                self.nearest.insert(side.clone(), key.clone());
            }
        }
    }

    /// Both kinds by name.
    pub fn kinds(&self) -> [(&'static str, &Reached); 2] {
        [("guards", &self.guards), ("timers", &self.timers)]
    }

    /// `guards 22 of 22 both ways, timers 2 of 2`: of the conditions that can go both ways, and a condition of which one side
    /// is missing does not count.
    pub fn said(&self) -> String {
        let [guards, timers] = self.kinds().map(|(_, reached)| {
            let mut sides: BTreeMap<&str, Vec<bool>> = BTreeMap::new();
            for (side, count) in &reached.cases {
                sides.entry(of(side)).or_default().push(*count > 0);
            }
            let both = sides.values().filter(|sides| sides.len() == 2);
            (both.clone().filter(|sides| !sides.contains(&false)).count(), both.count())
        });
        format!("guards {} of {} both ways, timers {} of {}", guards.0, guards.1, timers.0, timers.1)
    }

    /// In how many cases a side was seen; `None` for one that cannot be.
    pub fn count(&self, side: &str) -> Option<usize> {
        self.guards.cases.get(side).or_else(|| self.timers.cases.get(side)).copied()
    }
}

/// The condition of a side.
fn of(side: &str) -> &str {
    side.split(' ').next().unwrap_or_default()
}
