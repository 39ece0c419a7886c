//! The composition as a model of stateright, so that somebody else's search goes over the same exchanges.
//!
//! The states are those of our search, and what follows a state is asked of the same [`World`]: compared is the search, not the machines.

use fsct_proof::{Around, Joint, Model, World};
use stateright::{Checker, Model as _, Property};
use std::sync::Mutex;

/// A world behind a lock, for stateright asks from threads of its own; with one thread nobody waits for it.
struct Exchanges(Mutex<World>);

impl Exchanges {
    fn with<R>(&self, ask: impl FnOnce(&mut World) -> R) -> R {
        ask(&mut self.0.lock().expect("no thread has panicked"))
    }
}

impl stateright::Model for Exchanges {
    type State = Joint;
    type Action = Joint;

    fn init_states(&self) -> Vec<Joint> {
        vec![self.with(World::start)]
    }

    fn actions(&self, from: &Joint, actions: &mut Vec<Joint>) {
        self.with(|world| actions.extend(world.steps(*from, Around::Free).iter().map(|step| step.to)));
    }

    fn next_state(&self, _: &Joint, to: Joint) -> Option<Joint> {
        Some(to)
    }

    /// Without a property stateright stops at once.
    fn properties(&self) -> Vec<Property<Self>> {
        vec![Property::always("goes on", |_, _| true)]
    }
}

/// What stateright has found.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Explored {
    pub states: usize,
    pub steps: u64,
    pub depth: usize,
}

/// Explores a model to the end, breadth first on one thread.
pub fn explore(model: &Model) -> Explored {
    let checker = Exchanges(Mutex::new(World::new(model))).checker().threads(1).spawn_bfs().join();
    // It counts the start as a step and as a layer.
    let (steps, depth) = (checker.state_count() as u64 - 1, checker.max_depth() - 1);
    Explored { states: checker.unique_state_count(), steps, depth }
}
