//! How far the machines of the DUTs have been led beyond single transitions, against what can be walked.

use crate::asked::Asked;
use crate::record::{CaseRecord, Goal, Header, MachineInfo};
use serde::Serialize;
use std::collections::BTreeMap;

/// The DUTs of one role, together.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Coverage {
    /// `device` or `master`.
    pub role: String,
    /// Pairs of transitions.
    pub pairs: Reached,
    /// Triples of transitions.
    pub triples: Reached,
    /// Pairs of steps, a step being everything between two waiting states.
    pub step_pairs: Reached,
    /// Conditions and timers; `None` for a record that has no goals for them.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub asked: Option<Asked>,
}

/// What was taken of what is feasible, of one kind.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Reached {
    /// How many can be walked.
    pub feasible: usize,
    /// How many of them were.
    pub taken: usize,
    /// Those that were not.
    pub missing: Vec<String>,
    /// What was taken although the goals call it infeasible or do not know it, with what they say of it: either they are wrong
    /// or what was observed is.
    pub contradicting: BTreeMap<String, String>,
    /// In how many cases each feasible one was taken.
    pub cases: BTreeMap<String, usize>,
}

impl Coverage {
    /// Nothing taken yet, for every machine a header has goals for.
    pub fn begin(header: &Header) -> Vec<Coverage> {
        let begin = |machine: &MachineInfo| Coverage {
            role: machine.role.clone(),
            pairs: Reached::begin(&machine.pairs),
            triples: Reached::begin(&machine.triples),
            step_pairs: Reached::begin(&machine.step_pairs),
            asked: Asked::begin(machine),
        };
        header.machines.iter().map(begin).collect()
    }

    /// Adds a case of this role.
    pub fn add(&mut self, case: &CaseRecord) {
        self.pairs.add(&case.walked.pairs);
        self.triples.add(&case.walked.triples);
        self.step_pairs.add(&case.walked.step_pairs);
        if let Some(asked) = &mut self.asked {
            asked.add(case);
        }
    }

    /// All cases are in.
    pub fn end(&mut self, header: &Header) {
        if let Some(machine) = header.machines.iter().find(|machine| machine.role == self.role) {
            self.pairs.end(&machine.pairs);
            self.triples.end(&machine.triples);
            self.step_pairs.end(&machine.step_pairs);
            if let Some(asked) = &mut self.asked {
                asked.end(machine);
            }
        }
    }

    /// Its three kinds by name.
    pub fn kinds(&self) -> [(&'static str, &Reached); 3] {
        [("pairs", &self.pairs), ("triples", &self.triples), ("step pairs", &self.step_pairs)]
    }
}

impl Reached {
    pub(crate) fn begin(goal: &Goal) -> Reached {
        Reached {
            feasible: goal.feasible.len(),
            taken: 0,
            missing: Vec::new(),
            contradicting: BTreeMap::new(),
            cases: goal.feasible.iter().map(|name| (name.clone(), 0)).collect(),
        }
    }

    pub(crate) fn add(&mut self, names: &[String]) {
        for name in names {
            match self.cases.get_mut(name) {
                Some(count) => *count += 1,
                None => drop(self.contradicting.insert(name.clone(), String::new())),
            }
        }
    }

    pub(crate) fn end(&mut self, goal: &Goal) {
        let taken = |name: &&String| self.cases.get(*name).is_some_and(|count| *count > 0);
        self.taken = goal.feasible.iter().filter(taken).count();
        self.missing = goal.feasible.iter().filter(|name| !taken(name)).cloned().collect();
        for (name, said) in &mut self.contradicting {
            let reason = goal.infeasible.iter().find(|(infeasible, _)| infeasible == name).map(|(_, reason)| reason);
            *said =
                reason.map_or_else(|| "not known to the goals".to_owned(), |reason| format!("infeasible: {reason}"));
        }
    }

    /// `30 of 30`.
    pub fn said(&self) -> String {
        format!("{} of {}", self.taken, self.feasible)
    }
}
