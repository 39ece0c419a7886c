//! Where two machines differ.

use crate::{Edge, Mealy};
use std::hash::Hash;

/// A place where two machines do not answer alike, reached without any such place before it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Difference {
    /// A shortest word that shows it, with its last input.
    pub word: Vec<usize>,
    /// The states before that input: of one machine, and of the other.
    pub at: (usize, usize),
}

/// Where two machines with the same inputs differ, the shortest words first.
pub fn compared<O: Copy + Eq + Hash>(one: &Mealy<O>, other: &Mealy<O>) -> Vec<Difference> {
    let mut differences = Vec::new();
    let mut met = vec![((0, 0), Vec::new())];
    let mut at = 0;
    while let Some(((first, second), way)) = met.get(at).cloned() {
        at += 1;
        for input in 0..one.inputs() {
            let word = [way.as_slice(), &[input]].concat();
            let (mine, theirs): (Edge<O>, Edge<O>) = (one.edge(first, input), other.edge(second, input));
            let pair = (mine.next, theirs.next);
            if mine.output != theirs.output {
                differences.push(Difference { word, at: (first, second) });
            } else if !met.iter().any(|(known, _)| *known == pair) {
                met.push((pair, word));
            }
        }
    }
    differences
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Seen, Side};

    #[test]
    fn a_machine_differs_from_itself_nowhere() {
        let table = Side::Device.table();
        assert_eq!(compared(&table, &table), []);
    }

    #[test]
    fn a_difference_is_shown_by_a_shortest_word() {
        let table = Side::Device.table();
        let timeout = Side::Device.inputs().iter().position(|name| *name == "TIMEOUT").expect("an input");
        let mut other = table.clone();
        let state = table.edge(0, 0).next;
        other.states[state][timeout].output = Seen::Silent;
        assert_eq!(compared(&other, &table).first(), Some(&Difference { word: vec![0, timeout], at: (state, state) }));
    }
}
