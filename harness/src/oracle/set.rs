//! Everything a DUT may be doing, followed together: what the oracles of both roles have in common.

use super::config::{self, Config, Machine, Snapshot, TRANSITIONS, Window};
use super::{Mask, Mismatch};
use crate::conditions::Sides;
use crate::walk::Walked;
use fsct_protocol::scl::{State, T};
use fsct_protocol::spdu::Pd;
use fsct_reports::record::Verdict;

/// More configurations than this are not followed.
const MAX_SET: usize = 64;

/// Configurations side by side.
pub type Configs<M, S> = Vec<Config<M, S>>;

/// The configurations of one SCL, and what earlier instances in the same case have left.
#[derive(Debug)]
pub struct Set<M, S> {
    configs: Configs<M, S>,
    spare: Configs<M, S>,
    /// Exchanges so far.
    pub exchange: u64,
    /// Time of the exchange before this one.
    pub last_at: u64,
    taken_before: [u64; TRANSITIONS],
    used_before: Mask,
    walked_before: Walked,
    sides_before: Sides,
}

impl<M: Machine, S: Snapshot> Set<M, S> {
    /// No SCL.
    pub const fn new() -> Set<M, S> {
        Set {
            configs: Vec::new(),
            spare: Vec::new(),
            exchange: 0,
            last_at: 0,
            taken_before: [0; TRANSITIONS],
            used_before: Mask::NONE,
            walked_before: Walked { pairs: 0, triples: 0, step_pairs: 0 },
            sides_before: Sides::NONE,
        }
    }

    /// The SCL is gone; its transitions and tolerances stay counted.
    pub fn forget(&mut self) {
        self.taken_before = self.taken();
        self.used_before = self.used();
        self.walked_before = self.walked();
        self.sides_before = self.sides();
        self.configs.clear();
    }

    /// An SCL begins with this one configuration.
    pub fn begin(&mut self, machine: M, idle: S, received: Pd) {
        self.forget();
        self.configs = vec![Config::new(machine, idle, received)];
    }

    /// The machines, to tell them of an input.
    pub fn machines(&mut self) -> impl Iterator<Item = &mut M> {
        self.configs.iter_mut().map(|config| &mut config.machine)
    }

    /// Takes the configurations out to be stepped, with the room to step them into; [`Set::close`] puts them back.
    pub fn open(&mut self) -> (Configs<M, S>, Configs<M, S>) {
        let mut stepped = std::mem::take(&mut self.spare);
        stepped.clear();
        (std::mem::take(&mut self.configs), stepped)
    }

    /// What [`Set::open`] gave, drained and stepped.
    pub fn close(&mut self, drained: Configs<M, S>, stepped: Configs<M, S>) {
        self.spare = drained;
        self.configs = stepped;
    }

    /// Keeps the configurations that explain what was seen; `link` and `app` as for [`Config::observe`].
    ///
    /// # Errors
    /// The mismatch that `tell` makes when none is left, and an inconclusive one when there are too many to follow.
    pub fn observe(
        &self,
        stepped: &mut Configs<M, S>,
        latency: u64,
        link: impl Fn(&S) -> Option<Mask>,
        app: impl Fn(&S) -> Option<Mask>,
        tell: impl FnOnce(&[Config<M, S>]) -> Mismatch,
    ) -> Result<(), Mismatch> {
        if stepped.len() > MAX_SET {
            return Err(Mismatch {
                verdict: Verdict::Inconclusive,
                kind: "too-many-configurations".into(),
                clause: String::new(),
                expected: format!("at most {MAX_SET} configurations to follow"),
                observed: format!("{}", stepped.len()),
            });
        }
        let mut explained = 0u64;
        for (index, config) in stepped.iter_mut().enumerate() {
            if config.observe(self.exchange, latency, &link, &app) {
                explained |= 1 << index;
            }
        }
        if explained == 0 {
            return Err(tell(stepped));
        }
        let mut index = 0;
        stepped.retain(|_| {
            index += 1;
            explained >> (index - 1) & 1 == 1
        });
        config::merge(stepped);
        Ok(())
    }

    /// The configuration that needs the fewest tolerances.
    pub fn best(&self) -> Option<&Config<M, S>> {
        self.configs.iter().min_by_key(|config| config.used.len())
    }

    /// How often each transition was taken, from the first of the machine on, over the whole case.
    pub fn taken(&self) -> [u64; TRANSITIONS] {
        let mut taken = self.taken_before;
        if let Some(best) = self.best() {
            taken.iter_mut().zip(best.taken).for_each(|(sum, count)| *sum += u64::from(count));
        }
        taken
    }

    /// What followed what, over the whole case.
    pub fn walked(&self) -> Walked {
        self.best().map_or(self.walked_before, |best| self.walked_before.union(best.trail.walked))
    }

    /// Which way conditions decided, over the whole case.
    pub fn sides(&self) -> Sides {
        self.best().map_or(self.sides_before, |best| self.sides_before.union(best.sides))
    }

    /// Conditions decided while no SCL runs.
    pub const fn idle(&mut self, sides: Sides) {
        self.sides_before = self.sides_before.union(sides);
    }

    /// Tolerances the DUT made use of, over the whole case.
    pub fn used(&self) -> Mask {
        self.used_before.union(self.best().map_or(Mask::NONE, |config| config.used))
    }

    /// Transitions of the latest exchange.
    pub fn via(&self) -> impl Iterator<Item = T> + '_ {
        self.best().into_iter().flat_map(|config| config.via.iter().flat_map(|path| path.iter()))
    }

    /// Whether the machine may still be before its first transition.
    pub fn may_be_starting(&self) -> bool {
        self.configs.iter().any(|config| config.machine.state() == M::START)
    }

    /// The state the DUT is in as far as it can be told; `None` when no SCL runs.
    pub fn state(&self) -> Option<State> {
        self.best().map(|config| config.machine.state())
    }
}

/// One configuration at the time of an exchange: the timer may have expired by now, or not, or both are possible.
pub fn timed<M: Machine, S: Snapshot>(
    mut config: Config<M, S>,
    at: u64,
    expire: impl FnOnce(&mut Config<M, S>, Window),
    mut receive: impl FnMut(Config<M, S>),
) {
    config.via = Default::default();
    config.not_expired(at);
    if let Some(window) = config.timer.filter(|window| at >= window.earliest) {
        if at <= window.latest {
            receive(config);
        }
        expire(&mut config, window);
    }
    receive(config);
}
