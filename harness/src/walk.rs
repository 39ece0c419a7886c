//! Ways through a machine beyond single transitions, as its rows allow them: what may follow what, and what one SCL has walked.
//!
//! A *step* is everything between two waiting states. Rows say what fits together; guards may still rule it out, which is
//! a matter of `coverage`.

use fsct_adapters::Role;
use fsct_protocol::scl::{Path, Row, State, T, Trigger, device, master};
use std::sync::LazyLock;

/// Numbers of transitions end below this.
const NUMBERS: usize = 32;
/// The one transition whose row holds two behaviours, told apart by whether the SPDU was in error.
const TWOFOLD: T = T(29);
/// No place in a list.
const NOWHERE: u8 = u8::MAX;

/// A step.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Step {
    /// Its transitions.
    pub taken: Vec<T>,
    /// Whether the SPDU was in error, where the transitions do not tell.
    pub error: Option<bool>,
}

/// What the rows of a machine allow to follow each other. Places in these lists are the bits of a [`Walked`].
#[derive(Debug)]
pub struct Graph {
    /// Pairs of transitions.
    pub pairs: Vec<[T; 2]>,
    /// Triples of transitions.
    pub triples: Vec<[T; 3]>,
    /// Steps.
    pub steps: Vec<Step>,
    /// Pairs of steps, by their places in `steps`.
    pub step_pairs: Vec<[u8; 2]>,
    pair_at: [[u8; NUMBERS]; NUMBERS],
    triple_at: Vec<[u8; NUMBERS]>,
}

static DEVICE: LazyLock<Graph> = LazyLock::new(|| Graph::of(&device::ROWS));
static MASTER: LazyLock<Graph> = LazyLock::new(|| Graph::of(&master::ROWS));

impl Graph {
    /// That of the SCL of a role.
    pub fn role(role: Role) -> &'static Graph {
        match role {
            Role::Device => &DEVICE,
            Role::Master => &MASTER,
        }
    }

    fn of(rows: &'static [Row]) -> Graph {
        let mut pairs = Vec::new();
        let mut triples = Vec::new();
        for first in rows {
            for second in rows.iter().filter(|row| row.source == first.target) {
                pairs.push([first.id, second.id]);
                let thirds = rows.iter().filter(|row| row.source == second.target);
                triples.extend(thirds.map(|third| [first.id, second.id, third.id]));
            }
        }
        sort(&mut pairs);
        sort(&mut triples);
        let waits = |state| rows.iter().any(|row| row.source == state && is_input(row.trigger));
        let mut open: Vec<(Vec<T>, State)> = Vec::new();
        let begins = |row: &&Row| is_input(row.trigger) || row.trigger == Trigger::Start;
        open.extend(rows.iter().filter(begins).map(|row| (vec![row.id], row.target)));
        let mut steps = Vec::new();
        while let Some((taken, state)) = open.pop() {
            if waits(state) {
                let twofold = taken.contains(&TWOFOLD);
                let errors = if twofold { vec![Some(false), Some(true)] } else { vec![None] };
                steps.extend(errors.into_iter().map(|error| Step { taken: taken.clone(), error }));
                continue;
            }
            let next = rows.iter().filter(|row| row.source == state);
            open.extend(next.map(|row| ([taken.as_slice(), &[row.id]].concat(), row.target)));
        }
        sort(&mut steps);
        let end = |step: &Step| rows.iter().find(|row| Some(&row.id) == step.taken.last()).map(|row| row.target);
        let begin = |step: &Step| rows.iter().find(|row| Some(&row.id) == step.taken.first()).map(|row| row.source);
        let places = 0..steps.len() as u8;
        let all = places.clone().flat_map(|first| places.clone().map(move |second| [first, second]));
        let follow =
            |[first, second]: &[u8; 2]| end(&steps[usize::from(*first)]) == begin(&steps[usize::from(*second)]);
        let step_pairs: Vec<[u8; 2]> = all.filter(follow).collect();
        let mut pair_at = [[NOWHERE; NUMBERS]; NUMBERS];
        for (place, [first, second]) in (0..).zip(&pairs) {
            pair_at[usize::from(first.0)][usize::from(second.0)] = place;
        }
        let mut triple_at = vec![[NOWHERE; NUMBERS]; pairs.len()];
        for (place, [first, second, third]) in (0..).zip(&triples) {
            let pair = pair_at[usize::from(first.0)][usize::from(second.0)];
            triple_at[usize::from(pair)][usize::from(third.0)] = place;
        }
        Graph { pairs, triples, steps, step_pairs, pair_at, triple_at }
    }

    /// The place of a step; `error` is looked at where the transitions do not tell.
    pub fn step(&self, path: Path, error: bool) -> Option<u8> {
        let is = |step: &Step| step.taken.iter().copied().eq(path.iter()) && step.error.is_none_or(|own| own == error);
        self.steps.iter().position(is).map(|place| place as u8)
    }
}

fn is_input(trigger: Trigger) -> bool {
    matches!(trigger, Trigger::Received | Trigger::Timeout)
}

fn sort<T: Ord>(list: &mut Vec<T>) {
    list.sort();
    list.dedup();
}

/// What has been walked: bits by the lists of a [`Graph`].
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq, Hash)]
pub struct Walked {
    /// Pairs of transitions.
    pub pairs: u64,
    /// Triples of transitions.
    pub triples: u64,
    /// Pairs of steps.
    pub step_pairs: u64,
}

impl Walked {
    /// Both together.
    #[must_use]
    pub const fn union(self, other: Walked) -> Walked {
        Walked {
            pairs: self.pairs | other.pairs,
            triples: self.triples | other.triples,
            step_pairs: self.step_pairs | other.step_pairs,
        }
    }

    /// What is here and not there.
    #[must_use]
    pub const fn without(self, other: Walked) -> Walked {
        Walked {
            pairs: self.pairs & !other.pairs,
            triples: self.triples & !other.triples,
            step_pairs: self.step_pairs & !other.step_pairs,
        }
    }

    /// Whether nothing has been walked.
    pub const fn is_empty(self) -> bool {
        self.pairs | self.triples | self.step_pairs == 0
    }
}

/// The places of the bits that are set.
pub fn places(bits: u64) -> impl Iterator<Item = usize> {
    (0..64).filter(move |place| bits >> place & 1 == 1)
}

/// One SCL on its way since its power-on.
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq, Hash)]
pub struct Trail {
    /// What it has walked.
    pub walked: Walked,
    /// The latest transition and the pair it ended, as far as there are any.
    at: Option<(u8, Option<u8>)>,
    /// The latest step.
    step: Option<u8>,
}

impl Trail {
    /// Goes on by one step; `error` is whether the SPDU was in error.
    pub fn went(&mut self, graph: &Graph, path: Path, error: bool) {
        for T(number) in path.iter() {
            let now = usize::from(number);
            let place =
                |list: Option<&[u8; NUMBERS]>| list.and_then(|list| list.get(now)).copied().filter(|at| *at != NOWHERE);
            let (pair, triple) = match self.at {
                None => (None, None),
                Some((last, before)) => (
                    place(graph.pair_at.get(usize::from(last))),
                    place(before.and_then(|pair| graph.triple_at.get(usize::from(pair)))),
                ),
            };
            self.walked.pairs |= bit(pair);
            self.walked.triples |= bit(triple);
            self.at = Some((number, pair));
        }
        let step = graph.step(path, error);
        if let (Some(first), Some(second)) = (self.step, step) {
            self.walked.step_pairs |=
                bit(graph.step_pairs.iter().position(|pair| *pair == [first, second]).map(|place| place as u8));
        }
        self.step = step;
    }

    /// The same way with nothing walked yet: how it goes on is all that is left of the past.
    #[must_use]
    pub const fn afresh(self) -> Trail {
        Trail { walked: Walked { pairs: 0, triples: 0, step_pairs: 0 }, ..self }
    }
}

fn bit(place: Option<u8>) -> u64 {
    place.map_or(0, |place| 1 << place)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rstest::rstest;

    #[rstest]
    #[case(Role::Device, (17, 26, 10, 35))]
    #[case(Role::Master, (20, 31, 10, 35))]
    fn the_rows_allow_so_many_in_a_row(#[case] role: Role, #[case] counts: (usize, usize, usize, usize)) {
        let graph = Graph::role(role);
        let found = (graph.pairs.len(), graph.triples.len(), graph.steps.len(), graph.step_pairs.len());
        assert_eq!(found, counts, "pairs, triples, steps, pairs of steps");
    }
}
