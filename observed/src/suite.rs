//! Complete suites: sequences from the start that no machine passes which differs from the table and has at most so many
//! states more.
//!
//! Every state is reached, from it every input is given, and `extra` further ones in every order; then it is shown which state
//! this led to. A machine with at most `extra` more states than the table that answers every sequence as the table does is
//! equivalent to it (Chow 1978 for W, Petrenko 1991 and Luo 1994 for HSI).

use crate::identify::{Sequence, characterisation, identifiers};
use crate::{Edge, Mealy};
use std::hash::Hash;

/// Sequences, none the beginning of another, in the order of inputs.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Suite {
    /// Each from the start of the machine.
    pub sequences: Vec<Sequence>,
}

impl Suite {
    fn new(mut sequences: Vec<Sequence>) -> Suite {
        sequences.sort();
        sequences.dedup();
        // In this order what a sequence begins stands right behind it.
        let mut kept: Vec<Sequence> = Vec::with_capacity(sequences.len());
        for sequence in sequences {
            if kept.last().is_some_and(|last| sequence.starts_with(last)) {
                kept.pop();
            }
            kept.push(sequence);
        }
        Suite { sequences: kept }
    }

    /// Inputs of all sequences together.
    pub fn inputs(&self) -> usize {
        self.sequences.iter().map(Vec::len).sum()
    }

    /// Whether a machine answers every sequence as the other does.
    pub fn passes<O: Copy + Eq + Hash>(&self, machine: &Mealy<O>, table: &Mealy<O>) -> bool {
        self.sequences.iter().all(|sequence| machine.run(0, sequence).0 == table.run(0, sequence).0)
    }
}

/// The W method: behind each sequence the whole characterisation set.
pub fn w_method<O: Copy + Eq + Hash>(machine: &Mealy<O>, extra: usize) -> Suite {
    let w = characterisation(machine);
    suite(machine, extra, |_| w.as_slice())
}

/// The HSI method: behind each sequence the identifiers of the state it leads to.
pub fn hsi<O: Copy + Eq + Hash>(machine: &Mealy<O>, extra: usize) -> Suite {
    let identifiers = identifiers(machine);
    suite(machine, extra, |state| identifiers[state].as_slice())
}

fn suite<'i, O: Copy + Eq + Hash>(
    machine: &Mealy<O>,
    extra: usize,
    identify: impl Fn(usize) -> &'i [Sequence] + Copy,
) -> Suite {
    let mut sequences = Vec::new();
    let mut level: Vec<(usize, Sequence)> = (0..).zip(machine.access()).collect();
    for further in 0..=extra + 1 {
        for (state, way) in &level {
            sequences.extend(identify(*state).iter().map(|end| [way.as_slice(), end].concat()));
        }
        if further <= extra {
            level = level.iter().flat_map(|(state, way)| longer(machine, *state, way)).collect();
        }
    }
    Suite::new(sequences)
}

fn longer<O: Copy + Eq + Hash>(machine: &Mealy<O>, state: usize, way: &[usize]) -> Vec<(usize, Sequence)> {
    (0..machine.inputs())
        .map(|input| {
            let Edge { next, .. } = machine.edge(state, input);
            (next, [way, &[input]].concat())
        })
        .collect()
}
