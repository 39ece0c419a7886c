//! Both machines of the SCL (11.5.2, 11.5.3) with the black channel, the power and the operator between them, explored to the end.
//!
//! The machines are the rows of `fsct_protocol::scl`, the very rows the oracle interprets. One step is one exchange: what the
//! FS-Master presents goes to the FS-Device and the other way round, the channel may do to both what it likes, and each machine runs
//! to its next waiting state. [`prove`] asks a [`Property`] of everything that can then happen; docs/proof.md explains the answers.

mod chart;
mod exchange;
mod learned;
mod model;
mod property;
mod recovery;
mod search;

pub use chart::{Line, text};
pub use exchange::{Around, Fate, Joint, Leg, Step, World, image};
pub use learned::{Device, Gateway, Master, Product, can_stand_in};
pub use model::{Model, Reading, Timing};
pub use property::{PROPERTIES, Property, Seen, Watch, Watched};

use search::End;
use std::sync::Mutex;
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
/// As [`Model::check`].
pub fn prove(model: &Model, property: &'static Property) -> Result<Outcome, String> {
    model.check()?;
    Ok(asked(&mut World::new(model), property))
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
/// As [`Model::check`].
pub fn prove_all(model: &Model, properties: &[&'static Property]) -> Result<Vec<(Outcome, Duration)>, String> {
    model.check()?;
    let cores = std::thread::available_parallelism().map_or(1, usize::from).min(properties.len());
    // The last of the list have the most states: they come first, so that no core waits for one of them alone.
    let next = Mutex::new(properties.iter().enumerate().rev());
    let work = || {
        let mut world = World::new(model);
        let mut done = Vec::new();
        loop {
            let Some((at, property)) = next.lock().ok().and_then(|mut next| next.next()) else { return done };
            let started = Instant::now();
            done.push((at, (asked(&mut world, property), started.elapsed())));
        }
    };
    let mut done: Vec<_> = std::thread::scope(|scope| {
        let workers: Vec<_> = (0..cores).map(|_| scope.spawn(work)).collect();
        workers.into_iter().flat_map(|worker| worker.join().unwrap_or_default()).collect()
    });
    done.sort_by_key(|(at, _)| *at);
    if done.len() != properties.len() {
        return Err("a search has failed".to_owned());
    }
    Ok(done.into_iter().map(|(_, outcome)| outcome).collect())
}
