//! What a DUT can be led through beyond single transitions, and what it cannot: `testcases/coverage/*.yaml`.

mod asked;

use crate::conditions::{Sides, is_timer};
use crate::problem::{Problem, Source};
use crate::tree::{self, Fields, Placed};
use crate::walk::{Graph, Step, Walked, places};
use crate::yaml;
use asked::Asked;
use fsct_adapters::Role;
use fsct_protocol::scl::T;
use fsct_reports::record::{self, Goal, MachineInfo};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// The goals of one machine.
#[derive(Clone, Debug)]
pub struct Coverage {
    /// The side that has it.
    pub role: Role,
    /// The requirement a transition is judged by.
    pub requirements: BTreeMap<T, String>,
    /// Names of the steps, in the order of [`Graph::steps`].
    pub steps: Vec<String>,
    /// Everything that can be walked.
    pub feasible: Walked,
    /// Pairs of steps that cannot, by their names, with the reason.
    pub infeasible: Vec<(String, String)>,
    /// The conditions of guards and the timers.
    pub asked: Asked,
}

impl Coverage {
    /// Reads the goals of a machine. Everything the rows allow has to be called feasible or infeasible, once.
    ///
    /// # Errors
    /// Every problem of the file.
    pub fn parse(source: &Arc<Source>) -> Result<Coverage, Vec<Problem>> {
        let root = yaml::parse(source).map_err(|problem| vec![problem])?;
        let mut problems = Vec::new();
        let mut fields = Fields::new(source, &root, "the goals of a machine", &mut problems);
        let role = fields.word("machine", &[(Role::Device, "device"), (Role::Master, "master")]);
        let nodes = ["transitions", "steps", "infeasible"].map(|key| fields.get(key));
        let lists = ["pairs", "triples", "step_pairs"].map(|key| fields.texts(key));
        let conditions = ["guards", "timers"].map(|key| fields.get(key));
        fields.finish(&mut problems);
        let Some(role) = role else { return Err(problems) };
        let asked = Asked::parse(source, role, conditions, &mut problems);
        let graph = Graph::role(role);
        let [transitions, steps, infeasible] = nodes;
        let mut items = |node: Option<&yaml::Node>, what: &'static str, keys: [&'static str; 3]| {
            let Some(node) = node else { return Vec::new() };
            let mut read = Vec::new();
            let nodes: Vec<yaml::Node> = tree::list(source, node, what, &mut problems).to_vec();
            for node in &nodes {
                let mut fields = Fields::new(source, node, what, &mut problems);
                let values = keys.map(|key| fields.texts(key));
                fields.finish(&mut problems);
                read.push((node.at.clone(), values));
            }
            read
        };
        let transitions = items(transitions, "a transition with its requirement", ["id", "requirement", ""]);
        let steps = items(steps, "a step", ["name", "taken", "error"]);
        let infeasible = items(infeasible, "what cannot be walked", ["step_pair", "reason", ""]);
        let mut problem = |at, message: String| problems.push(Problem::new(source, at, message));
        let mut requirements = BTreeMap::new();
        for (at, [id, requirement, _]) in transitions {
            match (id.first().and_then(|id| number(&id.0)), requirement.first()) {
                (Some(id), Some((requirement, _))) => drop(requirements.insert(id, requirement.clone())),
                _ => problem(at, "a transition such as T25 needs `id` and `requirement`".to_owned()),
            }
        }
        let mut named: Vec<Option<String>> = vec![None; graph.steps.len()];
        for (at, [name, taken, error]) in steps {
            let taken = taken.iter().filter_map(|taken| number(&taken.0)).collect();
            let step = Step { taken, error: error.first().map(|error| error.0 == "1") };
            match (graph.steps.iter().position(|own| *own == step), name.first()) {
                (Some(place), Some((name, _))) if named[place].is_none() => named[place] = Some(name.clone()),
                (Some(_), Some((name, _))) => problem(at, format!("the step `{name}` has a name already")),
                _ => problem(at, "the rows of the machine have no such step".to_owned()),
            }
        }
        for step in graph.steps.iter().zip(&named).filter(|(_, name)| name.is_none()).map(|(step, _)| step) {
            problem(0..0, format!("the step {} has no name", joined(&step.taken)));
        }
        let names: Vec<String> = named.into_iter().map(Option::unwrap_or_default).collect();
        let known = Names::of(graph, &names);
        let mut found = [0u64; 3];
        for ((bits, list), known) in found.iter_mut().zip(&lists).zip([&known.pairs, &known.triples, &known.step_pairs])
        {
            gather(list, known, bits, &mut problem);
        }
        let mut never = 0;
        let mut reasons = Vec::new();
        for (at, [pair, reason, _]) in infeasible {
            let (Some(pair), Some((reason, _))) = (pair.first(), reason.first()) else {
                problem(at, "what is infeasible needs `step_pair` and `reason`".to_owned());
                continue;
            };
            gather(std::slice::from_ref(pair), &known.step_pairs, &mut never, &mut problem);
            reasons.push((pair.0.clone(), reason.clone()));
        }
        let [pairs, triples, step_pairs] = found;
        let said = [(pairs, &known.pairs), (triples, &known.triples), (step_pairs | never, &known.step_pairs)];
        for (bits, known) in said {
            for name in known.iter().enumerate().filter(|(place, _)| bits >> place & 1 == 0).map(|(_, name)| name) {
                problem(0..0, format!("`{name}` is called neither feasible nor infeasible"));
            }
        }
        for place in places(step_pairs & never) {
            problem(0..0, format!("`{}` is called feasible and infeasible", known.step_pairs[place]));
        }
        let feasible = Walked { pairs, triples, step_pairs };
        let coverage = Coverage { role, requirements, steps: names, feasible, infeasible: reasons, asked };
        if problems.is_empty() { Ok(coverage) } else { Err(problems) }
    }

    /// The names of what has been walked and of what has decided on the way, for the record.
    pub fn names(&self, walked: Walked, sides: Sides) -> record::Walked {
        let known = Names::of(Graph::role(self.role), &self.steps);
        let pick = |bits, names: &[String]| places(bits).filter_map(|place| names.get(place).cloned()).collect();
        let (timers, guards) = sides.names(self.role).partition(|side| is_timer(side));
        record::Walked {
            guards,
            timers,
            pairs: pick(walked.pairs, &known.pairs),
            triples: pick(walked.triples, &known.triples),
            step_pairs: pick(walked.step_pairs, &known.step_pairs),
        }
    }

    /// The goals, for the header of a record.
    pub fn info(&self) -> MachineInfo {
        let goals = self.names(self.feasible, Sides::NONE);
        let steps = self.steps.iter().zip(&Graph::role(self.role).steps);
        let goal = |feasible, infeasible| Goal { feasible, infeasible };
        MachineInfo {
            role: self.role.to_string(),
            steps: steps.map(|(name, step)| (name.clone(), joined(&step.taken))).collect(),
            pairs: goal(goals.pairs, Vec::new()),
            triples: goal(goals.triples, Vec::new()),
            step_pairs: goal(goals.step_pairs, self.infeasible.clone()),
            conditions: self.asked.conditions.clone(),
            guards: self.asked.guards.clone(),
            timers: self.asked.timers.clone(),
        }
    }
}

/// The names of everything the rows allow.
struct Names {
    pairs: Vec<String>,
    triples: Vec<String>,
    step_pairs: Vec<String>,
}

impl Names {
    fn of(graph: &Graph, steps: &[String]) -> Names {
        let step = |place: &u8| steps.get(usize::from(*place)).map_or("", String::as_str);
        Names {
            pairs: graph.pairs.iter().map(|pair| joined(pair)).collect(),
            triples: graph.triples.iter().map(|triple| joined(triple)).collect(),
            step_pairs: graph.step_pairs.iter().map(|[a, b]| format!("{} {}", step(a), step(b))).collect(),
        }
    }
}

fn gather(list: &[Placed], known: &[String], bits: &mut u64, problem: &mut impl FnMut(std::ops::Range<usize>, String)) {
    let mut seen = BTreeSet::new();
    for (name, at) in list {
        match known.iter().position(|known| known == name) {
            _ if !seen.insert(name) => problem(at.clone(), format!("`{name}` stands here twice")),
            Some(place) => *bits |= 1 << place,
            None => problem(at.clone(), format!("the rows of the machine have no `{name}`")),
        }
    }
}

fn joined(transitions: &[T]) -> String {
    transitions.iter().map(T::to_string).collect::<Vec<_>>().join(" ")
}

fn number(text: &str) -> Option<T> {
    text.strip_prefix('T')?.parse().ok().map(T)
}
