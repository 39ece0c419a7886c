//! The conditions that a machine is to be seen to decide, both ways: `guards` and `timers` of `testcases/coverage/*.yaml`.

use crate::conditions::{ids, is_timer, sides};
use crate::problem::{Problem, Source};
use crate::tree::{self, Fields, Placed};
use crate::yaml::Node;
use fsct_adapters::Role;
use fsct_reports::record::{ConditionInfo, Goal};
use std::collections::BTreeSet;
use std::sync::Arc;

/// Guard conditions and timers of one machine.
#[derive(Clone, Debug, Default)]
pub struct Asked {
    /// Each of them.
    pub conditions: Vec<ConditionInfo>,
    /// Sides of the guard conditions.
    pub guards: Goal,
    /// Sides of the timers.
    pub timers: Goal,
}

impl Asked {
    /// Reads both lists. Every condition that the oracle knows has to stand there, once.
    pub(super) fn parse(
        source: &Arc<Source>,
        role: Role,
        [guards, timers]: [Option<&Node>; 2],
        problems: &mut Vec<Problem>,
    ) -> Asked {
        let mut asked = Asked::default();
        let mut left: BTreeSet<&str> = ids(role).iter().copied().collect();
        let mut both = Vec::new();
        for (node, timer) in [(guards, false), (timers, true)] {
            let Some(node) = node else { continue };
            let entries = tree::list(source, node, "the list of conditions", problems);
            both.extend(entries.iter().map(|entry| (entry, timer)));
        }
        for (node, timer) in both {
            let words = if timer { ["never_expired", "never_restarted"] } else { ["never_true", "never_false"] };
            let mut fields = Fields::new(source, node, "a condition", problems);
            let read = ["id", "state", "rows", "asks", "clause"].map(|key| fields.text(key));
            let never = words.map(|key| fields.optional(key));
            fields.finish(problems);
            let [Some((id, at)), Some(state), Some(rows), Some(asks), Some(clause)] = read else { continue };
            if is_timer(&id) != timer || !left.remove(id.as_str()) {
                problems.push(Problem::new(source, at, format!("the oracle has no `{id}` here, or it stands twice")));
                continue;
            }
            let goal = if timer { &mut asked.timers } else { &mut asked.guards };
            goal.add(sides(&id), never);
            let [state, rows, asks, clause] = [state, rows, asks, clause].map(|(text, _)| text);
            asked.conditions.push(ConditionInfo { id, state, rows, asks, clause });
        }
        for id in left {
            problems.push(Problem::new(source, 0..0, format!("the condition `{id}` is missing")));
        }
        asked
    }
}

trait Add {
    fn add(&mut self, sides: [String; 2], never: [Option<Placed>; 2]);
}

impl Add for Goal {
    fn add(&mut self, sides: [String; 2], never: [Option<Placed>; 2]) {
        for (side, never) in sides.into_iter().zip(never) {
            match never {
                None => self.feasible.push(side),
                Some((reason, _)) => self.infeasible.push((side, reason)),
            }
        }
    }
}
