//! A machine as a table: for each state and input an output and the next state.

use std::collections::{HashMap, VecDeque};
use std::hash::Hash;

/// What an input leads to in a state.
#[derive(Copy, Clone, Debug, PartialEq, Eq, Hash)]
pub struct Edge<O> {
    /// What is seen.
    pub output: O,
    /// The state behind it.
    pub next: usize,
}

/// A deterministic machine that takes every input in every state. States and inputs are numbers; state 0 is the start.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Mealy<O> {
    /// By state, then by input.
    pub states: Vec<Vec<Edge<O>>>,
}

impl<O: Copy + Eq + Hash> Mealy<O> {
    /// What can be reached from a start, in the order in which it is met: breadth first, inputs in their order.
    pub fn explored<S: Clone + Eq + Hash>(start: S, inputs: usize, apply: impl Fn(&S, usize) -> (O, S)) -> Mealy<O> {
        let mut numbers = HashMap::from([(start.clone(), 0)]);
        let mut met = vec![start];
        let mut states = Vec::new();
        while let Some(state) = met.get(states.len()).cloned() {
            let edges = (0..inputs).map(|input| {
                let (output, behind) = apply(&state, input);
                let next = *numbers.entry(behind.clone()).or_insert_with(|| {
                    met.push(behind);
                    met.len() - 1
                });
                Edge { output, next }
            });
            states.push(edges.collect());
        }
        Mealy { states }
    }

    /// How many inputs it takes.
    pub fn inputs(&self) -> usize {
        self.states.first().map_or(0, Vec::len)
    }

    /// What an input leads to.
    ///
    /// # Panics
    /// For a state or an input that the machine does not have.
    pub fn edge(&self, state: usize, input: usize) -> Edge<O> {
        self.states[state][input]
    }

    /// What is seen of a sequence, and the state behind it.
    pub fn run(&self, state: usize, inputs: &[usize]) -> (Vec<O>, usize) {
        let mut at = state;
        let outputs = inputs.iter().map(|input| {
            let Edge { output, next } = self.edge(at, *input);
            at = next;
            output
        });
        (outputs.collect(), at)
    }

    /// The block of each state: states are in one block when no sequence tells them apart.
    fn blocks(&self) -> Vec<usize> {
        let mut blocks = vec![0; self.states.len()];
        let mut count = 1;
        loop {
            let mut numbers = HashMap::new();
            let refined: Vec<usize> = (0..self.states.len())
                .map(|state| {
                    let shown: Vec<_> =
                        self.states[state].iter().map(|edge| (edge.output, blocks[edge.next])).collect();
                    let fresh = numbers.len();
                    *numbers.entry((blocks[state], shown)).or_insert(fresh)
                })
                .collect();
            if numbers.len() == count {
                return refined;
            }
            (blocks, count) = (refined, numbers.len());
        }
    }

    /// The same machine with states that no sequence tells apart merged, in the order in which they are met from the start.
    #[must_use]
    pub fn minimal(&self) -> Mealy<O> {
        let blocks = self.blocks();
        let one_of: HashMap<usize, usize> =
            blocks.iter().enumerate().rev().map(|(state, block)| (*block, state)).collect();
        Mealy::explored(blocks.first().copied().unwrap_or(0), self.inputs(), |block, input| {
            let Edge { output, next } = self.edge(one_of[block], input);
            (output, blocks[next])
        })
    }

    /// A shortest sequence to each state from the start, of equally long ones the first by the order of inputs.
    pub fn access(&self) -> Vec<Vec<usize>> {
        let mut ways: Vec<Option<Vec<usize>>> = vec![None; self.states.len()];
        ways[0] = Some(Vec::new());
        let mut open = VecDeque::from([(0, Vec::new())]);
        while let Some((state, way)) = open.pop_front() {
            for (input, edge) in self.states[state].iter().enumerate() {
                if ways[edge.next].is_none() {
                    let further = [way.as_slice(), &[input]].concat();
                    ways[edge.next] = Some(further.clone());
                    open.push_back((edge.next, further));
                }
            }
        }
        ways.into_iter().map(Option::unwrap_or_default).collect()
    }

    /// A shortest sequence that shows a state of this machine to differ from a state of another with the same inputs.
    pub fn difference(&self, own: usize, other: &Mealy<O>, others: usize) -> Option<Vec<usize>> {
        let mut known = HashMap::from([((own, others), ())]);
        let mut open = VecDeque::from([((own, others), Vec::new())]);
        while let Some(((one, two), way)) = open.pop_front() {
            for input in 0..self.inputs() {
                let (first, second) = (self.edge(one, input), other.edge(two, input));
                let further = [way.as_slice(), &[input]].concat();
                if first.output != second.output {
                    return Some(further);
                }
                let pair = (first.next, second.next);
                if known.insert(pair, ()).is_none() {
                    open.push_back((pair, further));
                }
            }
        }
        None
    }
}
