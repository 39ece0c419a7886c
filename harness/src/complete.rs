//! Complete suites as cases: a case says `complete: {extra: 1}`, its points are the sequences of `fsct_observed::suite`.
//!
//! Nothing of them is written down: a sequence is made to steps when its case runs.

use crate::case::Binding;
use crate::case::model::Step;
use crate::case::{Expansion, decode_steps};
use crate::plan::{Plan, Planned};
use crate::problem::{Problem, Source};
use crate::tours::{Told, device as to_device, master as to_master};
use crate::yaml;
use fsct_adapters::{Offer, Role};
use fsct_observed::suite::{Suite, hsi};
use fsct_observed::{Absolute, Subject, device, master, observed};
use fsct_protocol::scl::device::Readings;
use fsct_reports::record::CompleteInfo;
use std::collections::HashMap;
use std::ops::Range;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

/// Name of the group of the complete suites.
pub const GROUP: &str = "complete";
/// What names the sequence in the key of a point.
pub const SEQUENCE: &str = "sequence";
/// The most extra states there are sequences for: with three there are a hundred thousands.
pub const MOST: usize = 2;
/// What stands between two inputs of a sequence.
const BETWEEN: char = '.';

/// A complete suite.
#[derive(Copy, Clone, Debug, PartialEq, Eq, Hash)]
pub struct Complete {
    /// The side the DUT is on.
    pub role: Role,
    /// The states that a DUT may have beyond those of the table, 0 to [`MOST`].
    pub extra: usize,
    /// Counters as numbers, and not as "the next" and "the mirrored one".
    pub absolute: bool,
}

/// A suite, and of how many states of the table it was made.
#[derive(Debug)]
pub struct Made {
    /// States of the table that can be told apart.
    pub states: usize,
    /// The sequences.
    pub suite: Suite,
}

fn made<S: Subject>(start: S, extra: usize) -> Made {
    let machine = observed(start);
    Made { states: machine.states.len(), suite: hsi(&machine, extra) }
}

impl Complete {
    /// The sequences, made when they are asked for first.
    pub fn made(self) -> &'static Made {
        static KNOWN: [OnceLock<Made>; 4 * (MOST + 1)] = [const { OnceLock::new() }; 4 * (MOST + 1)];
        let extra = self.extra.min(MOST);
        let kind = 2 * usize::from(self.role == Role::Master) + usize::from(self.absolute);
        KNOWN[4 * extra + kind].get_or_init(|| {
            let device = || device::Bench::waiting(Readings::default());
            match (self.role, self.absolute) {
                (Role::Device, false) => made(device(), extra),
                (Role::Device, true) => made(Absolute(device()), extra),
                (Role::Master, false) => made(master::Bench::waiting(), extra),
                (Role::Master, true) => made(Absolute(master::Bench::waiting()), extra),
            }
        })
    }

    /// Names of the inputs.
    pub fn inputs(self) -> Vec<&'static str> {
        match self.role {
            Role::Device => device::Bench::INPUTS.iter().map(|input| input.0).collect(),
            Role::Master => master::Bench::INPUTS.iter().map(|input| input.0).collect(),
        }
    }

    /// A point for each sequence. The machine is the same in all editions and modes, so that one variant is enough: of the newest
    /// edition the first that is offered.
    pub fn expand(
        self,
        offers: &[Offer],
        variant: impl Fn(&[Offer]) -> Result<Expansion, Problem>,
    ) -> Result<Expansion, Problem> {
        let newest = offers.iter().map(|offer| offer.edition).max();
        let one = offers.iter().find(|offer| Some(offer.edition) == newest);
        let of_the_dut = variant(one.map(std::slice::from_ref).unwrap_or_default())?;
        let Some(point) = of_the_dut.points.first() else { return Ok(of_the_dut) };
        let names = self.inputs();
        let points = self.made().suite.sequences.iter().map(|sequence| {
            let words: Vec<&str> = sequence.iter().filter_map(|input| names.get(*input).copied()).collect();
            point.with(SEQUENCE, words.join(&BETWEEN.to_string()))
        });
        Ok(Expansion { points: points.collect(), excluded: Vec::new() })
    }

    /// The steps of a point.
    pub fn steps(
        self,
        source: &Arc<Source>,
        at: &Range<usize>,
        binding: &Binding,
        problems: &mut Vec<Problem>,
    ) -> Vec<Step> {
        let words: Vec<&str> = binding.value(SEQUENCE).unwrap_or_default().split(BETWEEN).collect();
        let told = match self.role {
            Role::Device => {
                inputs::<device::Bench>(&words).map(|inputs| to_device::steps(&as_device(&inputs), self.absolute))
            }
            Role::Master => {
                inputs::<master::Bench>(&words).map(|inputs| to_master::steps(&as_master(&inputs), self.absolute))
            }
        };
        let Some(told) = told else {
            let message = format!("`{}` is no sequence of inputs", words.join(&BETWEEN.to_string()));
            problems.push(Problem::new(source, at.clone(), message));
            return Vec::new();
        };
        let texts = told.iter().zip(&words).flat_map(|(told, word)| texts(told, word));
        texts.filter_map(|text| step(self.role, &text, at, problems)).collect()
    }
}

/// The complete suites of which a plan has cases, on the DUT of this number.
pub fn planned(dut: usize, plan: &Plan<'_>) -> Vec<CompleteInfo> {
    let mut found: Vec<CompleteInfo> = Vec::new();
    for Planned { case, binding, .. } in &plan.cases {
        let Some(complete) = case.complete else { continue };
        if let Some(known) = found.iter_mut().find(|known| known.id == case.id) {
            known.planned += 1;
            continue;
        }
        let Made { states, suite } = complete.made();
        found.push(CompleteInfo {
            dut,
            role: case.role.to_string(),
            suite: case.suite.clone(),
            id: case.id.clone(),
            variant: format!("{} {}", binding.variant.edition, binding.variant.mode),
            absolute: complete.absolute,
            states: *states,
            extra: complete.extra,
            inputs: complete.inputs().len(),
            sequences: suite.sequences.len(),
            length: suite.inputs(),
            planned: 1,
        });
    }
    found
}

fn inputs<S: Subject>(words: &[&str]) -> Option<Vec<S::Input>> {
    words.iter().map(|word| S::INPUTS.iter().find(|input| input.0 == *word).map(|input| input.1)).collect()
}

/// What is done to an FS-Device, each stimulus with regard to the counters so far.
fn as_device(inputs: &[device::Input]) -> Vec<to_device::Stimulus> {
    use device::Input;
    use to_device::Stimulus;
    let mut bench = device::Bench::waiting(Readings::default());
    let mut stimuli = Vec::new();
    for input in inputs {
        let previous = bench.0.previous();
        stimuli.push(match *input {
            Input::Next { set_sd, sdset_ds } => Stimulus::Next { set_sd, ch_f_ack_req: false, sdset_ds },
            Input::Zero if previous == Some(0) => Stimulus::Next { set_sd: true, ch_f_ack_req: false, sdset_ds: false },
            Input::Zero => Stimulus::Zero,
            Input::Jump => Stimulus::Jump,
            Input::Corrupt => Stimulus::Corrupt("signature"),
            Input::Old if previous.is_none() => Stimulus::Nothing,
            Input::Old => Stimulus::Same,
            Input::AllZero => Stimulus::AllZero,
            Input::Timeout => Stimulus::Timeout("lost"),
        });
        bench.apply(*input);
    }
    stimuli
}

/// What is done to an FS-Master, each stimulus with regard to the counters so far.
fn as_master(inputs: &[master::Input]) -> Vec<to_master::Stimulus> {
    use fsct_protocol::spdu::inv3;
    use master::Input;
    use to_master::Stimulus;
    let mut bench = master::Bench::waiting();
    let mut stimuli = Vec::new();
    for input in inputs {
        let mirrored = inv3(bench.master.control().mcount);
        stimuli.push(match *input {
            Input::Good { sd_set, ack, set_sd } => Stimulus::Good { sd_set, ack, set_sd },
            Input::Dtimeout => Stimulus::Dtimeout,
            Input::DcommErr => Stimulus::DcommErr,
            Input::Corrupt => Stimulus::Corrupt("signature"),
            Input::Foreign => Stimulus::Foreign,
            Input::Old => match bench.given.filter(|dcount_i| *dcount_i != mirrored) {
                Some(dcount_i) => Stimulus::Again(dcount_i),
                None => Stimulus::Nothing,
            },
            Input::AllZero => Stimulus::AllZero,
            Input::Timeout => Stimulus::Timeout("lost"),
        });
        bench.apply(*input);
    }
    stimuli
}

/// A stimulus as steps of a case file: what is set before it, and itself.
fn texts(told: &Told, input: &str) -> Vec<String> {
    let before = told.before.iter().map(|step| format!("- {step}\n"));
    let own = format!("- {}\n  note: {input}\n  expect: {{{}}}\n", told.action, told.expect.join(", "));
    before.chain([own]).collect()
}

/// A step from its text. There are few different ones, so each is read once.
fn step(role: Role, text: &str, at: &Range<usize>, problems: &mut Vec<Problem>) -> Option<Step> {
    static KNOWN: OnceLock<Mutex<HashMap<(Role, String), Step>>> = OnceLock::new();
    let mut known = KNOWN.get_or_init(Mutex::default).lock().unwrap_or_else(PoisonError::into_inner);
    let key = (role, text.to_owned());
    if let Some(step) = known.get(&key) {
        return Some(Step { at: at.clone(), ..step.clone() });
    }
    let source = Arc::new(Source { name: "a sequence".to_owned(), text: text.to_owned() });
    match yaml::parse(&source) {
        Ok(node) => {
            let step = decode_steps(&source, role, &node, problems).pop()?;
            known.insert(key, step.clone());
            Some(Step { at: at.clone(), ..step })
        }
        Err(problem) => {
            problems.push(problem);
            None
        }
    }
}
