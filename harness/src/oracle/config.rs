//! One configuration a DUT may be in: its machine, its timer, and the SPDUs it has made but may not show yet.

use super::Mask;
use crate::conditions::{Sides, timer};
use crate::walk::{Graph, Trail};
use fsct_adapters::Role;
use fsct_protocol::scl::{Path, State, T};
use fsct_protocol::spdu::Pd;

/// The longest answer latency that can be followed, in exchanges.
pub const MAX_LATENCY: usize = 8;

/// Transitions of one machine, T1..T14 or T20..T31, at the most.
pub const TRANSITIONS: usize = 14;

/// A machine of the tables with everything that decides how it goes on.
pub trait Machine: Copy + PartialEq {
    /// Number of its first transition.
    const FIRST: u8;

    /// The state before its first transition.
    const START: State;

    /// The side that has it.
    const ROLE: Role;

    /// The state it is in.
    fn state(&self) -> State;

    /// Whether the SPDU processed last was in error.
    fn erred(&self) -> bool;
}

/// What a DUT shows from a certain exchange on: its SPDU and its application services.
pub trait Snapshot: Copy {
    /// Exchange in which it was made.
    fn made(&self) -> u64;
    /// Sets the exchange in which it was made.
    fn set_made(&mut self, exchange: u64);
    /// Transitions that made it.
    fn path(&self) -> Path;
    /// Whether no observer can tell the two apart.
    fn looks_like(&self, other: &Self) -> bool;
    /// Takes a later one that looks alike in.
    fn renew(&mut self, later: &Self);
}

/// When a timer expires at the earliest and at the latest, in nanoseconds.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Window {
    /// Not before this.
    pub earliest: u64,
    /// Visible at the latest by the first exchange after this.
    pub latest: u64,
}

/// One configuration.
#[derive(Copy, Clone, Debug)]
pub struct Config<M, S> {
    /// The machine of the tables.
    pub machine: M,
    /// MTimer or DTimer while it runs.
    pub timer: Option<Window>,
    /// Process data of the SPDU processed last.
    pub received: Pd,
    /// Answers made and not superseded for longer than the latency, oldest first.
    snapshots: [S; MAX_LATENCY + 1],
    count: usize,
    /// Which of them the link showed last.
    shown: usize,
    /// Which of them the application services showed last.
    reported: usize,
    /// Tolerances needed to get here.
    pub used: Mask,
    /// Readings decided on the way, as tolerances: A08, A09, A19.
    pub decided: Mask,
    /// How often each transition was taken, from the first of the machine on.
    pub taken: [u32; TRANSITIONS],
    /// Transitions of this exchange: an expiry, a reception.
    pub via: [Path; 2],
    /// What followed what since the SCL began.
    pub trail: Trail,
    /// Which way conditions have decided since the SCL began.
    pub sides: Sides,
    /// A timer that was restarted, and until when it would have expired otherwise.
    restarted: Option<(u8, u64)>,
}

impl<M: Machine, S: Snapshot> Config<M, S> {
    /// A machine that has sent nothing yet and shows this.
    pub fn new(machine: M, idle: S, received: Pd) -> Config<M, S> {
        Config {
            machine,
            timer: None,
            received,
            snapshots: [idle; MAX_LATENCY + 1],
            count: 1,
            shown: 0,
            reported: 0,
            used: Mask::NONE,
            decided: Mask::NONE,
            taken: [0; TRANSITIONS],
            via: [Path::default(); 2],
            trail: Trail::default(),
            sides: Sides::NONE,
            restarted: None,
        }
    }

    /// The answers that may be seen now, oldest first.
    pub fn snapshots(&self) -> &[S] {
        &self.snapshots[..self.count]
    }

    /// The answers that may be seen in this exchange: from the last one that is due on.
    pub fn visible(&self, exchange: u64, latency: u64) -> &[S] {
        self.snapshots().get(self.oldest(exchange, latency)..).unwrap_or_default()
    }

    /// The last answer made so long ago that it has to be visible by now.
    fn oldest(&self, exchange: u64, latency: u64) -> usize {
        let due = exchange.saturating_sub(latency);
        self.snapshots().iter().rposition(|snapshot| snapshot.made() <= due).unwrap_or(0)
    }

    /// The newest answer.
    pub fn newest(&self) -> &S {
        &self.snapshots[self.count - 1]
    }

    /// Adds an answer. One that looks like the newest cannot be told from it and takes no room of its own. When more
    /// are waiting than the latency allows, the oldest is forgotten.
    pub fn push(&mut self, snapshot: S) {
        let newest = &mut self.snapshots[self.count - 1];
        if newest.looks_like(&snapshot) {
            return newest.renew(&snapshot);
        }
        if self.count == self.snapshots.len() {
            self.snapshots.copy_within(1.., 0);
            self.count -= 1;
            self.shown = self.shown.saturating_sub(1);
            self.reported = self.reported.saturating_sub(1);
        }
        self.snapshots[self.count] = snapshot;
        self.count += 1;
    }

    /// Counts the transitions of a step and keeps them for this exchange.
    pub fn took(&mut self, path: Path) {
        let [first, second] = &mut self.via;
        *(if first.is_empty() { first } else { second }) = path;
        self.trail.went(Graph::role(M::ROLE), path, self.machine.erred());
        for T(number) in path.iter() {
            if let Some(slot) =
                usize::from(number).checked_sub(M::FIRST.into()).and_then(|index| self.taken.get_mut(index))
            {
                *slot += 1;
            }
        }
    }

    /// An SPDU was taken in this state, and the timer runs anew.
    pub fn restart(&mut self, state: State, window: Option<Window>) {
        self.restarted = self.timer.and_then(|window| Some((timer(M::ROLE, state)?, window.latest)));
        self.timer = window;
    }

    /// The timer has expired in this state, and runs anew.
    pub fn expired(&mut self, state: State, window: Window) {
        if let Some(timer) = timer(M::ROLE, state) {
            self.sides.set(timer, true);
        }
        self.restarted = None;
        self.timer = Some(window);
    }

    /// This late, a timer that was restarted once would have expired, and has not.
    pub fn not_expired(&mut self, at: u64) {
        let early = self.timer.is_some_and(|window| at < window.earliest);
        if let Some((timer, _)) = self.restarted.filter(|(_, latest)| early && at > *latest) {
            self.sides.set(timer, false);
            self.restarted = None;
        }
    }

    /// Accepts what was seen: `link` and `app` say whether an answer explains image and services, with the tolerances
    /// that takes. Each shows the earliest answer that explains it, never one older than before, never one that has been
    /// superseded for longer than `latency` exchanges. `false`: this configuration does not explain what was seen.
    pub fn observe(
        &mut self,
        exchange: u64,
        latency: u64,
        link: impl Fn(&S) -> Option<Mask>,
        app: impl Fn(&S) -> Option<Mask>,
    ) -> bool {
        let oldest = self.oldest(exchange, latency);
        let seen = |from: usize, explains: &dyn Fn(&S) -> Option<Mask>| {
            let mut found = (from.max(oldest)..self.count).filter_map(|at| Some((at, explains(&self.snapshots[at])?)));
            let (index, used) = found.next()?;
            // A tolerance counts as used where nothing else explains what is seen.
            let plain = used.is_empty() || found.any(|(_, used)| used.is_empty());
            Some((index, if plain { Mask::NONE } else { used }))
        };
        let Some((shown, used)) = seen(self.shown, &link) else { return false };
        let Some((reported, other)) = seen(self.reported, &app) else { return false };
        self.used = self.used.union(used).union(other);
        let superseded = shown.min(reported);
        self.snapshots.copy_within(superseded..self.count, 0);
        self.count -= superseded;
        self.shown = shown - superseded;
        self.reported = reported - superseded;
        true
    }

    /// Takes the other configuration in when both go on alike from here: they differ in how they got here and in when their
    /// timers may expire. Windows that overlap become one, and so do those of errors found in repetitions (A29), any of
    /// which may have restarted the timer.
    pub fn absorb(&mut self, other: &Config<M, S>) -> bool {
        let alike = self.machine == other.machine
            && self.decided == other.decided
            && self.shown == other.shown
            && self.reported == other.reported
            && self.received == other.received
            && self.count == other.count
            && self.snapshots().iter().zip(other.snapshots()).all(|(own, other)| own.looks_like(other));
        if !alike {
            return false;
        }
        if self.timer == other.timer {
            return true;
        }
        let (Some(own), Some(others)) = (&mut self.timer, other.timer) else { return false };
        let overlap = own.earliest <= others.latest && others.earliest <= own.latest;
        if self.used != other.used || !(overlap || self.used.has(29)) {
            return false;
        }
        own.earliest = own.earliest.min(others.earliest);
        own.latest = own.latest.max(others.latest);
        for (own, other) in self.snapshots[..self.count].iter_mut().zip(other.snapshots()) {
            own.set_made(own.made().max(other.made()));
        }
        true
    }
}

/// Configurations with the same future are one; the one with fewer tolerances stays.
pub fn merge<M: Machine, S: Snapshot>(configs: &mut Vec<Config<M, S>>) {
    if configs.len() < 2 {
        return;
    }
    configs.sort_by_key(|config| config.used.len());
    let mut kept = 0;
    for index in 0..configs.len() {
        let config = configs[index];
        if !configs[..kept].iter_mut().any(|other| other.absorb(&config)) {
            configs[kept] = config;
            kept += 1;
        }
    }
    configs.truncate(kept);
}
