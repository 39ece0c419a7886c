//! Our search against that of stateright over the same exchanges: `cargo bench -p fsct-proof`.
//!
//! Both begin with a [`World`] that knows nothing and ask it alike, so both have that work in their times; what it takes by itself is
//! measured beside. Fails when they do not meet as many states.

#[path = "../tests/stateright/mod.rs"]
mod stateright;

use fsct_proof::{Around, Joint, Model, Timing, World, reachable};
use fsct_protocol::Edition;
use std::collections::HashSet;
use std::time::Duration;

/// In turn, so that whatever else the machine does hits both.
const ROUNDS: usize = 11;

fn main() {
    println!("Processor time, medians of {ROUNDS} rounds, one thread each\n");
    println!("                 states  exchanges       fsct  stateright  ratio");
    for watchdog in [4, 6] {
        for timing in [Timing::Pipelined, Timing::Immediate] {
            compare(&Model { watchdog, timing, ..Model::new(Edition::Iec2022) });
        }
    }
}

fn compare(model: &Model) {
    let name = format!("watchdog {}, {}", model.watchdog, model.timing);
    let (states, order) = (reachable(model).expect("a model that can be explored"), in_order(model));
    assert_eq!(states, order.len(), "{name}");
    let (mut common, mut ours, mut theirs) = (Vec::new(), Vec::new(), Vec::new());
    for _ in 0..ROUNDS {
        common.push(timed(|| ask(model, &order)).0);
        let (time, found) = timed(|| reachable(model));
        assert_eq!(found, Ok(states), "{name}");
        ours.push(time);
        let (time, explored) = timed(|| stateright::explore(model));
        assert_eq!(explored.states, states, "{name}");
        theirs.push(time);
    }
    let [common, ours, theirs] = [common, ours, theirs].map(median);
    let ratio = theirs / ours;
    let [common, ours, theirs] = [common, ours, theirs].map(|seconds| seconds * 1e3);
    println!("{name}  {states:>8}  {common:>6.1} ms  {ours:>6.1} ms   {theirs:>6.1} ms  {ratio:>5.1}");
}

/// The states in the order in which they are met.
fn in_order(model: &Model) -> Vec<Joint> {
    let mut world = World::new(model);
    let mut order = vec![world.start()];
    let mut met: HashSet<Joint> = order.iter().copied().collect();
    let mut at = 0;
    while let Some(from) = order.get(at).copied() {
        order.extend(world.steps(from, Around::Free).iter().map(|step| step.to).filter(|to| met.insert(*to)));
        at += 1;
    }
    order
}

/// What both searches have in common: asks a new world what follows each state. It gives the same numbers in the same order.
fn ask(model: &Model, order: &[Joint]) -> usize {
    let mut world = World::new(model);
    world.start();
    order.iter().map(|from| world.steps(*from, Around::Free).len()).sum()
}

fn median(mut times: Vec<Duration>) -> f64 {
    times.sort_unstable();
    times[times.len() / 2].as_secs_f64()
}

/// What the whole process took for it, threads included.
fn timed<R>(work: impl FnOnce() -> R) -> (Duration, R) {
    let begun = now();
    let done = work();
    (now().saturating_sub(begun), done)
}

#[cfg(unix)]
fn now() -> Duration {
    let time = rustix::time::clock_gettime(rustix::time::ClockId::ProcessCPUTime);
    Duration::new(time.tv_sec.unsigned_abs(), time.tv_nsec.unsigned_abs() as u32)
}

/// Wall time where there is no other.
#[cfg(not(unix))]
fn now() -> Duration {
    std::time::SystemTime::UNIX_EPOCH.elapsed().unwrap_or_default()
}
