//! Both machines of the SCL (11.5.2, 11.5.3) with the black channel, the power and the operator between them, explored to the end.
//!
//! The machines are the rows of `fsct_protocol::scl`, the very rows the oracle interprets. One step is one exchange: what the
//! FS-Master presents goes to the FS-Device and the other way round, the channel may do to both what it likes, and each machine runs
//! to its next waiting state. [`prove`] asks a [`Property`] of everything that can then happen; docs/proof.md explains the answers.

mod chart;
mod cores;
mod exchange;
mod learned;
mod machine;
mod model;
mod property;
mod reading;
mod recovery;
mod replay;
mod search;
mod tolerance;

pub use chart::{Line, Turn, text};
pub use exchange::{Around, Fate, Joint, Leg, Step, World, image};
pub use learned::{Device, Gateway, Master, Product, can_stand_in};
pub use model::{Model, Timers, Timing};
pub use property::{PROPERTIES, Property, Seen, Watch, Watched};
pub use reading::{Machine, Reading};
pub use replay::replay;
pub use tolerance::{
    Failing, Judged, Refused, Tolerances, demanded, failing, failing_each, mixtures, read, tolerances,
};

use cores::on_all_cores;
use search::End;
use std::time::{Duration, Instant};

/// What became of a property.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// It holds for everything reachable.
    Holds,
    /// It does not, and this is a shortest way to see it.
    Violated(Vec<Line>),
    /// It does not hold of the tables of either edition as they are read by default either ([`Property::tables`]).
    Tables(Vec<Line>),
    /// Operation may never return: a way there, of which so many exchanges repeat at the end.
    LockUp(Vec<Line>, usize),
    /// More states than the model allows to keep: nothing is known.
    Unknown,
}

/// What was found about a property.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// The property.
    pub property: &'static Property,
    /// What became of it.
    pub verdict: Verdict,
    /// The largest measure met.
    pub worst: u8,
    /// The largest allowed; `None` where no number is demanded.
    pub bound: Option<u8>,
    /// States kept, monitor included.
    pub states: usize,
    /// Exchanges tried.
    pub steps: u64,
    /// Most exchanges on a shortest way to a state.
    pub depth: usize,
    /// Octets the search took for its states.
    pub octets: usize,
}

/// Asks a property of a model.
///
/// # Errors
/// As [`Model::check`], and where the property is not asked of such a model ([`Property::not_asked`]).
pub fn prove(model: &Model, property: &'static Property) -> Result<Outcome, String> {
    check(model, &[property])?;
    Ok(asked(&mut World::new(model), property))
}

fn check(model: &Model, properties: &[&'static Property]) -> Result<(), String> {
    model.check()?;
    let not_asked =
        |property: &&&Property| property.not_asked(model).map(|why| format!("{} is not asked: {why}", property.name));
    properties.iter().find_map(|property| not_asked(&property)).map_or(Ok(()), Err)
}

/// A world that other properties have been asked of already knows more of its exchanges; the answer is the same.
fn asked(world: &mut World, property: &'static Property) -> Outcome {
    let (found, for_ever) = match property.watch {
        Some(_) => (search::search(world, Some(property)), None),
        None => {
            let recovery = recovery::recovery(world);
            (recovery.found, recovery.for_ever)
        }
    };
    let verdict = match (found.end, for_ever) {
        (End::Complete, _) => Verdict::Holds,
        (End::TooMany, _) => Verdict::Unknown,
        (End::Beyond(steps), Some(repeats)) => Verdict::LockUp(chart::lines(world, &steps), repeats),
        (End::Beyond(steps), None) => {
            let lines = chart::lines(world, &steps);
            if property.tables.is_some() { Verdict::Tables(lines) } else { Verdict::Violated(lines) }
        }
    };
    let bound = property.watch.map(|_| (property.bound)(world.model()));
    let (states, steps, depth, octets) = (found.states, found.steps, found.depth, found.octets);
    Outcome { property, verdict, worst: found.worst, bound, states, steps, depth, octets }
}

/// How many states there are: everything reachable, whatever is asked.
///
/// # Errors
/// As [`Model::check`].
pub fn reachable(model: &Model) -> Result<usize, String> {
    model.check()?;
    Ok(search::search(&mut World::new(model), None).states)
}

/// Asks several properties of a model, on all cores; the outcomes come in their order, each with how long it took.
///
/// # Errors
/// As [`prove`].
pub fn prove_all(model: &Model, properties: &[&'static Property]) -> Result<Vec<(Outcome, Duration)>, String> {
    check(model, properties)?;
    on_all_cores(
        properties,
        || World::new(model),
        |world, property| {
            let started = Instant::now();
            (asked(world, property), started.elapsed())
        },
    )
}
