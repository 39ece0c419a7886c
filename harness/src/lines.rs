//! The lines of a link while a case runs: what a DUT and the tester do to them goes into the decoder of `fsct-lines`, and
//! comes out as measured values.

use fsct_adapters::{Line, Role};
use fsct_lines::{Decoder, Edge, Episode, Levels, Measured, Quantity, WakeUps, measure};
use std::collections::BTreeMap;

/// The lines.
#[derive(Debug)]
pub struct Lines {
    decoder: Decoder,
    /// Episodes of the case that are over.
    ended: Vec<Episode>,
    /// What a wake-up by the tester has shown.
    woken: Vec<Measured>,
    /// Level of C/Q.
    cq: bool,
    /// When C/Q rose last.
    cq_rise: u64,
    /// Width of the latest pulse on C/Q, in nanoseconds.
    pulse: Option<u64>,
    /// Level of I/Q.
    iq: bool,
    /// The latest wake-up.
    woken_at: Option<u64>,
}

impl Default for Lines {
    fn default() -> Lines {
        let low = Levels { power: Some(false), cq: Some(false), iq: Some(false) };
        Lines {
            decoder: Decoder::new(0, low, WakeUps::Told),
            ended: Vec::new(),
            woken: Vec::new(),
            cq: false,
            cq_rise: 0,
            pulse: None,
            iq: false,
            woken_at: None,
        }
    }
}

impl Lines {
    /// A line has changed, in nanoseconds from the beginning of the case.
    pub fn edge(&mut self, at: u64, line: Line, level: bool) {
        match line {
            Line::Cq => {
                match (self.cq, level) {
                    (false, true) => self.cq_rise = at,
                    (true, false) => self.pulse = Some(at.saturating_sub(self.cq_rise)),
                    _ => {}
                }
                self.cq = level;
            }
            Line::WakeUp => self.woken_at = Some(at),
            Line::Iq => self.iq = level,
            Line::Power => {}
        }
        self.ended.extend(self.decoder.edge(Edge { at, line, level }));
    }

    /// Whether C/Q is high.
    pub fn cq(&self) -> bool {
        self.cq
    }

    /// Width of the latest pulse on C/Q, in nanoseconds.
    pub fn pulse(&self) -> Option<u64> {
        self.pulse
    }

    /// Whether I/Q is high.
    pub fn iq(&self) -> bool {
        self.iq
    }

    /// When the latest wake-up was.
    pub fn woken_at(&self) -> Option<u64> {
        self.woken_at
    }

    /// Notes that the tester woke the DUT up this long after the Ready pulse, and whether it answered.
    pub fn woken(&mut self, at: u64, after_ns: u64, answered: bool, uncertainty_ns: u64) {
        let (low, high) = if answered { (0, after_ns) } else { (after_ns + 1, u64::MAX) };
        let uncertainty = 2 * uncertainty_ns;
        let (episode, at) = (self.ended.len() as u64, at.saturating_sub(after_ns));
        self.woken.push(Measured { quantity: Quantity::ReadyForWakeUp, low, high, uncertainty, at, episode });
    }

    /// The end of the Ready pulse of the supply that is on, once it is over.
    pub fn ready(&self) -> Option<u64> {
        self.decoder.current()?.ready?.fall
    }

    /// When both outputs were ON first, with the supply that is on.
    pub fn both_on(&mut self, now: u64) -> Option<u64> {
        self.decoder.advance(now);
        self.decoder.ossd()?.both_on
    }

    /// The episodes of the case, the one that is going on as far as `now`.
    pub fn episodes(&mut self, now: u64) -> Vec<Episode> {
        self.decoder.advance(now);
        let mut current = self.decoder.current().cloned();
        if let Some(episode) = &mut current {
            episode.ossd = self.decoder.ossd().copied();
        }
        self.ended.iter().cloned().chain(current).collect()
    }

    /// How often each transition of the DL-mode handlers was taken that the lines show: T13 of an FS-Device (Table 11), T20
    /// to T22 of an FS-Master port with safety (Table 10).
    pub fn taken(&mut self, role: Role, now: u64) -> impl Iterator<Item = (u8, u64)> {
        let mut counts = BTreeMap::new();
        let mut add = |number: u8, times: bool| *counts.entry(number).or_insert(0) += u64::from(times);
        for episode in self.episodes(now) {
            let ready = episode.ready.is_some_and(|pulse| pulse.fall.is_some());
            match role {
                Role::Device => add(13, ready),
                Role::Master => {
                    add(20, episode.on.is_some());
                    add(21, ready && episode.wake_ups.count > 0);
                    add(22, !ready && episode.wake_ups.count == 0 && episode.next_on.is_some());
                }
            }
        }
        counts.into_iter().filter(|(_, count)| *count > 0)
    }

    /// Everything the lines have shown of a quantity so far.
    pub fn measured(&mut self, quantity: Quantity, now: u64, uncertainty_ns: u64) -> Vec<Measured> {
        let episodes = self.episodes(now);
        let all = episodes.iter().flat_map(|episode| measure(episode, uncertainty_ns));
        all.chain(self.woken.iter().copied()).filter(|measured| measured.quantity == quantity).collect()
    }
}
