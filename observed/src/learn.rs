//! A machine learnt by asking: what it answers to words of inputs, each from its start.
//!
//! Two words lead to the same state until a word behind them tells them apart: that is the observation table of L* with the
//! counterexamples of Rivest and Schapire. The machine found so is then tested with `access · inputs^(k + 1) · separating words`,
//! which finds everything that `k` states more than it has could hide. Before that it is asked where it differs from a machine that is
//! expected, if there is one: most products are nearly that, and what is told of a difference has then been seen. Nothing is asked
//! twice for an answer that is known, but each word repeats the beginning of others: a DUT that does not always answer alike
//! contradicts itself soon.

use crate::{Difference, Edge, Mealy, compared};
use std::collections::HashMap;
use std::hash::Hash;

/// What can be asked.
pub trait Teacher {
    /// What is seen of one input.
    type Output: Copy + Eq + Hash;
    /// Why there is no answer.
    type Error;

    /// Restarts the machine and gives it these inputs, by their numbers; what is seen of each.
    ///
    /// # Errors
    /// When the word could not be asked to its end.
    fn ask(&mut self, word: &[usize]) -> Result<Vec<Self::Output>, Self::Error>;
}

/// How far the learner goes.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Bounds {
    /// States that the machine may have beyond those found: with no more than these it is found exactly.
    pub extra: usize,
    /// States found at the most.
    pub most_states: usize,
    /// Inputs given at the most, restarts apart.
    pub most_inputs: u64,
}

/// A bound that ended the learning.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Bound {
    /// [`Bounds::most_states`].
    States,
    /// [`Bounds::most_inputs`].
    Inputs,
}

/// What has been asked so far.
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq)]
pub struct Asked {
    /// Words, a restart each.
    pub words: u64,
    /// Inputs in them.
    pub inputs: u64,
}

/// What was learnt.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Learned<O> {
    /// The machine; with a bound hit the latest that explained what was seen until then, or none.
    pub machine: Option<Mealy<O>>,
    /// The bound that was hit; `None`: learnt to the end.
    pub bound: Option<Bound>,
    /// What it took.
    pub asked: Asked,
}

/// Why nothing was learnt.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Failure<O, E> {
    /// The teacher gave no answer to a word.
    Teacher(E),
    /// The same word was answered in two ways: no deterministic machine under these inputs.
    Contradiction {
        /// The word.
        word: Vec<usize>,
        /// What was seen first.
        before: Vec<O>,
        /// What was seen later.
        after: Vec<O>,
    },
}

/// What came of learning from a teacher.
pub type Outcome<T> = Result<Learned<<T as Teacher>::Output>, Failure<<T as Teacher>::Output, <T as Teacher>::Error>>;

/// Learns the machine behind a teacher, which takes the inputs `0..inputs`. Where a machine is `expected`, every difference from it
/// in what is learnt to the end has been seen.
///
/// # Errors
/// [`Failure`]; a bound that was hit is none.
pub fn learn<T: Teacher>(
    teacher: &mut T,
    inputs: usize,
    bounds: Bounds,
    expected: Option<&Mealy<T::Output>>,
) -> Outcome<T> {
    let single = (0..inputs).map(|input| vec![input]).collect();
    let memory = Memory::new(teacher, bounds.most_inputs);
    let mut learner = Learner { memory, inputs, bounds, expected, suffixes: single };
    let mut latest = None;
    let bound = loop {
        let found = match learner.hypothesis() {
            Ok(found) => found,
            Err(Halt::Bound(bound)) => break Some(bound),
            Err(Halt::Failure(failure)) => return Err(failure),
        };
        let counterexample = learner.counterexample(&found);
        let refined = match counterexample {
            Ok(None) => {
                latest = Some(found.machine);
                break None;
            }
            Ok(Some(word)) => learner.refine(&found, &word),
            Err(halt) => Err(halt),
        };
        latest = Some(found.machine);
        match refined {
            Ok(()) => {}
            Err(Halt::Bound(bound)) => break Some(bound),
            Err(Halt::Failure(failure)) => return Err(failure),
        }
    };
    Ok(Learned { machine: latest, bound, asked: learner.memory.asked })
}

/// Why the learner stops.
enum Halt<O, E> {
    Bound(Bound),
    Failure(Failure<O, E>),
}

type Halted<T, R> = Result<R, Halt<<T as Teacher>::Output, <T as Teacher>::Error>>;

/// A machine that explains everything seen, with a word to each of its states.
struct Hypothesis<O> {
    machine: Mealy<O>,
    access: Vec<Vec<usize>>,
}

struct Learner<'t, T: Teacher> {
    memory: Memory<'t, T>,
    inputs: usize,
    bounds: Bounds,
    expected: Option<&'t Mealy<T::Output>>,
    /// Words that tell states apart; every single input is one.
    suffixes: Vec<Vec<usize>>,
}

impl<T: Teacher> Learner<'_, T> {
    /// What is seen of every suffix behind a word.
    fn row(&mut self, word: &[usize]) -> Halted<T, Vec<T::Output>> {
        let mut row = Vec::new();
        for suffix in &self.suffixes {
            row.extend(self.memory.behind(word, suffix)?);
        }
        Ok(row)
    }

    /// The machine whose states are the different rows, met breadth first.
    fn hypothesis(&mut self) -> Halted<T, Hypothesis<T::Output>> {
        let mut numbers = HashMap::from([(self.row(&[])?, 0)]);
        let mut access = vec![Vec::new()];
        let mut states = Vec::new();
        while let Some(word) = access.get(states.len()).cloned() {
            let mut edges = Vec::new();
            for input in 0..self.inputs {
                let further = [word.as_slice(), &[input]].concat();
                let output = self.memory.behind(&word, &[input])?[0];
                let fresh = numbers.len();
                let next = *numbers.entry(self.row(&further)?).or_insert(fresh);
                if next == fresh {
                    access.push(further);
                }
                edges.push(Edge { output, next });
            }
            states.push(edges);
            if access.len() > self.bounds.most_states {
                return Err(Halt::Bound(Bound::States));
            }
        }
        Ok(Hypothesis { machine: Mealy { states }, access })
    }

    /// A word on which the hypothesis is wrong, or none among all that `extra` more states could need.
    fn counterexample(&mut self, found: &Hypothesis<T::Output>) -> Halted<T, Option<Vec<usize>>> {
        let separating = separating(&found.machine, &self.suffixes);
        // What the hypothesis rests on is asked once more: a machine that varies has to show it.
        for access in &found.access {
            for word in &separating {
                self.memory.again(&[access.as_slice(), word].concat())?;
            }
        }
        let differences = self.expected.map(|expected| compared(&found.machine, expected)).unwrap_or_default();
        for Difference { word, .. } in differences {
            if let Some(wrong) = self.wrong(found, &word)? {
                return Ok(Some(wrong));
            }
        }
        for length in 0..=self.bounds.extra + 1 {
            for access in &found.access {
                let mut middle = vec![0; length];
                loop {
                    for word in &separating {
                        if let Some(wrong) = self.wrong(found, &[access, middle.as_slice(), word].concat())? {
                            return Ok(Some(wrong));
                        }
                    }
                    if !count_on(&mut middle, self.inputs) {
                        break;
                    }
                }
            }
        }
        Ok(None)
    }

    /// The beginning of a word up to where the hypothesis is wrong, if it is.
    fn wrong(&mut self, found: &Hypothesis<T::Output>, word: &[usize]) -> Halted<T, Option<Vec<usize>>> {
        let (seen, (told, _)) = (self.memory.behind(&[], word)?, found.machine.run(0, word));
        let wrong = seen.iter().zip(&told).position(|(seen, told)| seen != told);
        Ok(wrong.map(|at| word[..=at].to_vec()))
    }

    /// Takes up the end of a counterexample that tells apart what the hypothesis takes for one state.
    fn refine(&mut self, found: &Hypothesis<T::Output>, word: &[usize]) -> Halted<T, ()> {
        self.memory.again(word)?;
        // The hypothesis is right of what comes behind `high`, wrong behind `low`.
        let (mut low, mut high) = (0, word.len());
        while high - low > 1 {
            let middle = usize::midpoint(low, high);
            let (_, state) = found.machine.run(0, &word[..middle]);
            let seen = self.memory.behind(&found.access[state], &word[middle..])?;
            if seen == found.machine.run(state, &word[middle..]).0 {
                high = middle;
            } else {
                low = middle;
            }
        }
        self.suffixes.push(word[high..].to_vec());
        Ok(())
    }
}

/// Few of these words that together tell all states apart which they tell apart at all; one of them at least.
fn separating<O: Copy + Eq + Hash>(machine: &Mealy<O>, words: &[Vec<usize>]) -> Vec<Vec<usize>> {
    let states = machine.states.len();
    let shown: Vec<Vec<Vec<O>>> =
        words.iter().map(|word| (0..states).map(|state| machine.run(state, word).0).collect()).collect();
    let mut open: Vec<(usize, usize)> = (0..states).flat_map(|one| (0..one).map(move |two| (one, two))).collect();
    let mut chosen = Vec::new();
    loop {
        let tells = |word: usize, pair: &(usize, usize)| shown[word][pair.0] != shown[word][pair.1];
        let worth = |word: usize| open.iter().filter(|pair| tells(word, pair)).count();
        let Some(best) = (0..words.len()).rev().max_by_key(|word| worth(*word)) else { return chosen };
        if worth(best) == 0 && !chosen.is_empty() {
            return chosen;
        }
        open.retain(|pair| !tells(best, pair));
        chosen.push(words[best].clone());
        if open.is_empty() {
            return chosen;
        }
    }
}

/// The next word of the same length; `false` behind the last.
fn count_on(word: &mut [usize], inputs: usize) -> bool {
    for input in word.iter_mut().rev() {
        *input += 1;
        if *input < inputs {
            return true;
        }
        *input = 0;
    }
    false
}

/// Everything seen, as a tree: from each place, by input, what was seen and the place behind it.
struct Memory<'t, T: Teacher> {
    teacher: &'t mut T,
    places: Vec<HashMap<usize, (T::Output, usize)>>,
    asked: Asked,
    most_inputs: u64,
}

impl<'t, T: Teacher> Memory<'t, T> {
    fn new(teacher: &'t mut T, most_inputs: u64) -> Memory<'t, T> {
        Memory { teacher, places: vec![HashMap::new()], asked: Asked::default(), most_inputs }
    }

    /// What is seen of `suffix` behind `word`.
    fn behind(&mut self, word: &[usize], suffix: &[usize]) -> Halted<T, Vec<T::Output>> {
        let whole = [word, suffix].concat();
        let mut seen = self.known(&whole);
        if seen.len() < whole.len() {
            self.again(&whole)?;
            seen = self.known(&whole);
        }
        Ok(seen.split_off(word.len()))
    }

    /// What is known of a word: all of it, or its beginning.
    fn known(&self, word: &[usize]) -> Vec<T::Output> {
        let mut at = 0;
        word.iter()
            .map_while(|input| {
                let (output, next) = *self.places[at].get(input)?;
                at = next;
                Some(output)
            })
            .collect()
    }

    /// Asks, whatever is known, and keeps what is seen.
    fn again(&mut self, word: &[usize]) -> Halted<T, ()> {
        self.asked.inputs += word.len() as u64;
        if self.asked.inputs > self.most_inputs {
            self.asked.inputs -= word.len() as u64;
            return Err(Halt::Bound(Bound::Inputs));
        }
        self.asked.words += 1;
        let seen = self.teacher.ask(word).map_err(|error| Halt::Failure(Failure::Teacher(error)))?;
        let known = self.known(word);
        if let Some(wrong) = known.iter().zip(&seen).position(|(known, seen)| known != seen) {
            let (word, before) = (word[..=wrong].to_vec(), known[..=wrong].to_vec());
            let contradiction = Failure::Contradiction { word, before, after: seen[..=wrong].to_vec() };
            return Err(Halt::Failure(contradiction));
        }
        let mut at = 0;
        for (input, output) in word.iter().zip(seen) {
            let fresh = self.places.len();
            at = self.places[at].entry(*input).or_insert((output, fresh)).1;
            if at == fresh {
                self.places.push(HashMap::new());
            }
        }
        Ok(())
    }
}
