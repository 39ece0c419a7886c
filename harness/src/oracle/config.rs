//! One configuration an FS-Device may be in: its machine, its timer, and the answers it has made but may not show yet.

use super::Mask;
use fsct_protocol::scl::{Device, Path, T};
use fsct_protocol::spdu::{Pd, Status};

/// The longest answer latency that can be followed, in exchanges.
pub const MAX_LATENCY: usize = 8;

/// Bits of the status octet that a tolerance leaves free, with the tolerance.
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq)]
pub struct Free {
    /// SDset.
    pub sd_set: u8,
    /// DCommErr.
    pub d_comm_err: u8,
    /// DTimeout.
    pub d_timeout: u8,
}

/// What the DUT shows from a certain exchange on: its answer and its application services.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Snapshot {
    /// Exchange in which it was made.
    pub made: u64,
    /// `None` before the first answer: the image is all zero.
    pub status: Option<Status>,
    /// Status bits not judged here, by the tolerance that says so (0: judged).
    pub free: Free,
    /// Generations of PDin_D of which the answer may carry one.
    pub pdin: (u32, u32),
    /// PDout_D expected.
    pub pdout: Pd,
    /// setSD_DC expected; `None` where it is not judged (A20).
    pub set_sd_dc: Option<bool>,
    /// ChFAckReq_DC expected; `None` where it is not judged (A27).
    pub ch_f_ack_req_dc: Option<bool>,
    /// Transitions that made it.
    pub path: Path,
}

impl Snapshot {
    /// Whether no observer can tell the two apart.
    fn looks_like(&self, other: &Snapshot) -> bool {
        self.status == other.status
            && self.free == other.free
            && (self.pdin == other.pdin || self.pdin.1 == other.pdin.0 && other.pdin.0 == other.pdin.1)
            && self.pdout == other.pdout
            && self.set_sd_dc == other.set_sd_dc
            && self.ch_f_ack_req_dc == other.ch_f_ack_req_dc
    }
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
pub struct Config {
    /// The machine of the tables.
    pub device: Device,
    /// DTimer while it runs.
    pub timer: Option<Window>,
    /// PDout of the SPDU processed last.
    pub received: Pd,
    /// Answers made and not superseded for longer than the latency, oldest first.
    snapshots: [Snapshot; MAX_LATENCY + 1],
    count: usize,
    /// Which of them the link showed last.
    shown: usize,
    /// Which of them the application services showed last.
    reported: usize,
    /// Tolerances needed to get here.
    pub used: Mask,
    /// Readings decided on the way, as tolerances: A08, A09, A19.
    pub decided: Mask,
    /// How often each of T20..T31 was taken.
    pub taken: [u32; 12],
    /// Transitions of this exchange: an expiry, a reception.
    pub via: [Path; 2],
}

impl Config {
    /// A machine that has not answered yet.
    pub fn new(device: Device, pd_out: usize, exchange: u64) -> Config {
        let idle = Snapshot {
            made: exchange,
            status: None,
            free: Free::default(),
            pdin: (0, 0),
            pdout: Pd::safe(pd_out),
            set_sd_dc: None,
            ch_f_ack_req_dc: None,
            path: Path::default(),
        };
        Config {
            device,
            timer: None,
            received: Pd::safe(pd_out),
            snapshots: [idle; MAX_LATENCY + 1],
            count: 1,
            shown: 0,
            reported: 0,
            used: Mask::NONE,
            decided: Mask::NONE,
            taken: [0; 12],
            via: [Path::default(); 2],
        }
    }

    /// The answers that may be seen now, oldest first.
    pub fn snapshots(&self) -> &[Snapshot] {
        &self.snapshots[..self.count]
    }

    /// The answers that may be seen in this exchange: from the last one that is due on.
    pub fn visible(&self, exchange: u64, latency: u64) -> &[Snapshot] {
        self.snapshots().get(self.oldest(exchange, latency)..).unwrap_or_default()
    }

    /// The last answer made so long ago that it has to be visible by now.
    fn oldest(&self, exchange: u64, latency: u64) -> usize {
        let due = exchange.saturating_sub(latency);
        self.snapshots().iter().rposition(|snapshot| snapshot.made <= due).unwrap_or(0)
    }

    /// The newest answer.
    pub fn newest(&self) -> &Snapshot {
        &self.snapshots[self.count - 1]
    }

    /// Adds an answer. One that looks like the newest cannot be told from it and takes no room of its own. When more
    /// are waiting than the latency allows, the oldest is forgotten.
    pub fn push(&mut self, snapshot: Snapshot) {
        let newest = &mut self.snapshots[self.count - 1];
        if newest.looks_like(&snapshot) {
            newest.pdin.1 = snapshot.pdin.1;
            newest.path = snapshot.path;
            return;
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
        for T(number) in path.iter() {
            if let Some(slot) = usize::from(number).checked_sub(20).and_then(|index| self.taken.get_mut(index)) {
                *slot += 1;
            }
        }
    }

    /// Accepts what was seen: `link` and `app` say whether an answer explains image and services, with the tolerances
    /// that takes. Each shows the earliest answer that explains it, never one older than before, never one that has been
    /// superseded for longer than `latency` exchanges. `false`: this configuration does not explain what was seen.
    pub fn observe(
        &mut self,
        exchange: u64,
        latency: u64,
        link: impl Fn(&Snapshot) -> Option<Mask>,
        app: impl Fn(&Snapshot) -> bool,
    ) -> bool {
        let oldest = self.oldest(exchange, latency);
        let seen = |from: usize, explains: &dyn Fn(&Snapshot) -> Option<Mask>| {
            (from.max(oldest)..self.count).find_map(|index| Some((index, explains(&self.snapshots[index])?)))
        };
        let Some((shown, used)) = seen(self.shown, &link) else { return false };
        let Some((reported, _)) = seen(self.reported, &|snapshot| app(snapshot).then_some(Mask::NONE)) else {
            return false;
        };
        self.used = self.used.union(used);
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
    pub fn absorb(&mut self, other: &Config) -> bool {
        let alike = self.device == other.device
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
            own.made = own.made.max(other.made);
        }
        true
    }
}
