//! Edges and where they come from.

use fsct_adapters::Line;

/// A line has changed its level.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Edge {
    /// When, in nanoseconds on the clock of the recording.
    pub at: u64,
    /// Which line.
    pub line: Line,
    /// The level from now on.
    pub level: bool,
}

/// The levels a recording begins with; `None`: the line is not in it.
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq)]
pub struct Levels {
    /// L+, pin 1.
    pub power: Option<bool>,
    /// C/Q, pin 4.
    pub cq: Option<bool>,
    /// I/Q, pin 2.
    pub iq: Option<bool>,
}

impl Levels {
    /// The level of a line; [`Line::WakeUp`] is a pulse on C/Q and has none of its own.
    pub fn of(&self, line: Line) -> Option<bool> {
        match line {
            Line::Power => self.power,
            Line::Cq => self.cq,
            Line::Iq => self.iq,
            Line::WakeUp => None,
        }
    }
}

/// Edges in the order of time, one after the other.
pub trait Recording {
    /// The levels before the first edge.
    fn levels(&self) -> Levels;

    /// How far the time of an edge may be off, in nanoseconds, either way.
    fn uncertainty_ns(&self) -> u64;

    /// The next edge; `None` at the end.
    ///
    /// # Errors
    /// [`RecordingError`] when the rest cannot be read; what came before stands.
    fn next_edge(&mut self) -> Result<Option<Edge>, RecordingError>;

    /// Until when the levels are known, in nanoseconds; final once [`Recording::next_edge`] has given `None`.
    fn end(&self) -> u64;
}

/// A recording that cannot be read. Each text is one sentence that says where and what to do.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{what}")]
pub struct RecordingError {
    /// The sentence.
    pub what: String,
}
