//! The lines of a link while a case runs: what a DUT and the tester do to them goes into the decoder of `fsct-lines`, and
//! comes out as measured values.

use fsct_adapters::Line;
use fsct_lines::{Decoder, Edge, Episode, Levels, Measured, Quantity, WakeUps, measure};

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
            woken_at: None,
        }
    }
}

impl Lines {
    /// A line has changed, in nanoseconds from the beginning of the case.
    pub fn edge(&mut self, at: u64, line: Line, level: bool) {
        match line {
            Line::Cq => self.cq = level,
            Line::WakeUp => self.woken_at = Some(at),
            Line::Power | Line::Iq => {}
        }
        self.ended.extend(self.decoder.edge(Edge { at, line, level }));
    }

    /// Whether C/Q is high.
    pub fn cq(&self) -> bool {
        self.cq
    }

    /// When the latest wake-up was.
    pub fn woken_at(&self) -> Option<u64> {
        self.woken_at
    }

    /// Notes that the tester woke the DUT up this long after the Ready pulse, and whether it answered.
    pub fn woken(&mut self, at: u64, after_ns: u64, answered: bool, uncertainty_ns: u64) {
        let (low, high) = if answered { (0, after_ns) } else { (after_ns + 1, u64::MAX) };
        let uncertainty = 2 * uncertainty_ns;
        let episode = self.ended.len() as u64;
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

    /// Everything the lines have shown of a quantity so far.
    pub fn measured(&mut self, quantity: Quantity, now: u64, uncertainty_ns: u64) -> Vec<Measured> {
        let episodes = self.episodes(now);
        let all = episodes.iter().flat_map(|episode| measure(episode, uncertainty_ns));
        all.chain(self.woken.iter().copied()).filter(|measured| measured.quantity == quantity).collect()
    }
}
