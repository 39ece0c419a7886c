//! Glitches left out.

use crate::{Edge, Levels, Recording, RecordingError};
use fsct_adapters::Line;
use std::collections::VecDeque;

/// How many edges may wait for the one before them. Only wake-ups can be so many: a line has one edge at a time that may be
/// that of a glitch.
const WAITING: usize = 1024;

/// A recording without its pulses shorter than a duration.
///
/// Two edges of a line nearer to each other than [`Filter::min_ns`] are both left out, from the earliest on; so of a line
/// that bounces, its last edge remains. What comes before the first edge and what the end of the recording cuts off are no
/// pulses, and wake-ups are none either.
#[derive(Debug)]
pub struct Filter<R> {
    recording: R,
    min_ns: u64,
    /// Edges that may be those of a glitch, and those behind them.
    waiting: VecDeque<Edge>,
    removed: u64,
    ended: bool,
}

impl<R: Recording> Filter<R> {
    /// Leaves out pulses shorter than `min_ns`; 0 leaves out none.
    pub fn new(recording: R, min_ns: u64) -> Filter<R> {
        Filter { recording, min_ns, waiting: VecDeque::new(), removed: 0, ended: false }
    }

    /// The shortest pulse that stays, in nanoseconds.
    pub fn min_ns(&self) -> u64 {
        self.min_ns
    }

    /// How many pulses were left out so far.
    pub fn removed(&self) -> u64 {
        self.removed
    }

    /// What was left out, for a report.
    pub fn stated(&self) -> String {
        format!("pulses shorter than {} ns are left out: {} so far", self.min_ns, self.removed)
    }

    /// The recording within.
    pub fn into_inner(self) -> R {
        self.recording
    }

    fn push(&mut self, edge: Edge) -> Result<(), RecordingError> {
        let before = self.waiting.iter().rposition(|before| before.line == edge.line);
        if let Some(place) = before.filter(|_| edge.line != Line::WakeUp)
            && edge.at.saturating_sub(self.waiting[place].at) < self.min_ns
        {
            self.waiting.remove(place);
            self.removed += 1;
            return Ok(());
        }
        if self.waiting.len() >= WAITING {
            let what = format!("there are more than {WAITING} wake-ups within {} ns at {} ns", self.min_ns, edge.at);
            return Err(RecordingError { what });
        }
        self.waiting.push_back(edge);
        Ok(())
    }

    /// Whether nothing at or after `now` can make the first edge that waits a glitch.
    fn is_settled(&self, now: u64) -> bool {
        self.waiting.front().is_some_and(|edge| edge.line == Line::WakeUp || now.saturating_sub(edge.at) >= self.min_ns)
    }
}

impl<R: Recording> Recording for Filter<R> {
    fn levels(&self) -> Levels {
        self.recording.levels()
    }

    fn uncertainty_ns(&self) -> u64 {
        self.recording.uncertainty_ns()
    }

    fn next_edge(&mut self) -> Result<Option<Edge>, RecordingError> {
        let mut now = self.waiting.back().map_or(0, |edge| edge.at);
        loop {
            if self.ended || self.is_settled(now) {
                return Ok(self.waiting.pop_front());
            }
            match self.recording.next_edge()? {
                Some(edge) => {
                    now = edge.at;
                    self.push(edge)?;
                }
                None => self.ended = true,
            }
        }
    }

    fn end(&self) -> u64 {
        self.recording.end()
    }
}
