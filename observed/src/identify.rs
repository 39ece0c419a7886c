//! Which sequences tell the states of a machine apart.
//!
//! The machine has to be minimal: of two states that nothing tells apart neither can be identified.

use crate::Mealy;
use std::collections::HashSet;
use std::hash::Hash;

/// A sequence of inputs, each by its number.
pub type Sequence = Vec<usize>;

/// A characterisation set W: few sequences that together tell every state from every other, of as few the shortest.
pub fn characterisation<O: Copy + Eq + Hash>(machine: &Mealy<O>) -> Vec<Sequence> {
    let pairs = pairs(machine.states.len());
    let candidates = candidates(machine, &pairs);
    (1..=pairs.len())
        .find_map(|count| smallest(&candidates, count, &vec![true; pairs.len()]))
        .map(|(_, chosen)| chosen.into_iter().map(|place| candidates[place].0.clone()).collect())
        .unwrap_or_default()
}

/// Harmonised state identifiers: for each state the sequences that tell it from the others. Those of two states have a
/// beginning in common that tells the two apart.
///
/// Each state begins with the characterisation set; what is not needed is taken out, and then the ends that are not, of the
/// state that most inputs lead to first, because its identifiers are given most often.
pub fn identifiers<O: Copy + Eq + Hash>(machine: &Mealy<O>) -> Vec<Vec<Sequence>> {
    let mut sets = vec![characterisation(machine); machine.states.len()];
    for state in by_use(machine) {
        let mut place = 0;
        while let Some(sequence) = sets[state].get(place).cloned() {
            sets[state].remove(place);
            if !harmonised(machine, state, &sets) {
                sets[state].insert(place, sequence);
                place += 1;
            }
        }
    }
    for state in by_use(machine) {
        for place in 0..sets[state].len() {
            while sets[state][place].len() > 1 {
                let Some(end) = sets[state][place].pop() else { break };
                if !harmonised(machine, state, &sets) {
                    sets[state][place].push(end);
                    break;
                }
            }
        }
    }
    sets
}

/// The states, that which most inputs lead to first.
fn by_use<O: Copy + Eq + Hash>(machine: &Mealy<O>) -> Vec<usize> {
    let led_to = |state: usize| machine.states.iter().flatten().filter(|edge| edge.next == state).count();
    let mut states: Vec<usize> = (0..machine.states.len()).collect();
    states.sort_by_key(|state| std::cmp::Reverse(led_to(*state)));
    states
}

/// Whether a state has with every other a common beginning that tells the two apart.
fn harmonised<O: Copy + Eq + Hash>(machine: &Mealy<O>, state: usize, sets: &[Vec<Sequence>]) -> bool {
    (0..machine.states.len()).filter(|other| *other != state).all(|other| shared(machine, (state, other), sets))
}

fn pairs(states: usize) -> Vec<(usize, usize)> {
    (0..states).flat_map(|one| (one + 1..states).map(move |two| (one, two))).collect()
}

/// Whether a beginning common to sequences of both tells the two apart.
fn shared<O: Copy + Eq + Hash>(machine: &Mealy<O>, (one, two): (usize, usize), sets: &[Vec<Sequence>]) -> bool {
    let common = |own: &Sequence, other: &Sequence| {
        let length = own.iter().zip(other).take_while(|(a, b)| a == b).count();
        tells(machine, (one, two), &own[..length])
    };
    sets[one].iter().any(|own| sets[two].iter().any(|other| common(own, other)))
}

/// Whether a sequence tells two states apart.
pub fn tells<O: Copy + Eq + Hash>(machine: &Mealy<O>, (one, two): (usize, usize), sequence: &[usize]) -> bool {
    machine.run(one, sequence).0 != machine.run(two, sequence).0
}

/// Sequences with the pairs each tells apart, shortest first; of those that tell the same pairs the first alone, and none that
/// a sequence before it makes superfluous.
fn candidates<O: Copy + Eq + Hash>(machine: &Mealy<O>, pairs: &[(usize, usize)]) -> Vec<(Sequence, Vec<bool>)> {
    let longest = pairs.iter().filter_map(|(one, two)| Some(machine.difference(*one, machine, *two)?.len())).max();
    let mut found: Vec<(Sequence, Vec<bool>)> = Vec::new();
    let mut known = HashSet::new();
    let mut level = vec![Vec::new()];
    // One more than the pair that takes most: a longer sequence may stand for two.
    for _ in 0..longest.unwrap_or(0).max(1) + 1 {
        let longer = |way: &Sequence| -> Vec<Sequence> {
            (0..machine.inputs()).map(|input| [way.as_slice(), &[input]].concat()).collect()
        };
        level = level.iter().flat_map(longer).collect();
        for way in &level {
            let told: Vec<bool> = pairs.iter().map(|pair| tells(machine, *pair, way)).collect();
            let within = |other: &Vec<bool>| told.iter().zip(other).all(|(own, other)| *other || !own);
            if known.insert(told.clone()) && !found.iter().any(|(_, other)| within(other)) {
                found.push((way.clone(), told));
            }
        }
    }
    found
}

/// As few candidates as `count` that tell what is open, the shortest of them, by their places; and how long they are together.
fn smallest(candidates: &[(Sequence, Vec<bool>)], count: usize, open: &[bool]) -> Option<(usize, Vec<usize>)> {
    let Some(first) = open.iter().position(|open| *open) else { return Some((0, Vec::new())) };
    if count == 0 {
        return None;
    }
    let mut best: Option<(usize, Vec<usize>)> = None;
    for (place, (way, told)) in (0..).zip(candidates).filter(|(_, (_, told))| told[first]) {
        let left: Vec<bool> = open.iter().zip(told).map(|(open, told)| *open && !told).collect();
        if let Some((length, mut chosen)) = smallest(candidates, count - 1, &left)
            && best.as_ref().is_none_or(|(least, _)| length + way.len() < *least)
        {
            chosen.insert(0, place);
            best = Some((length + way.len(), chosen));
        }
    }
    best
}
