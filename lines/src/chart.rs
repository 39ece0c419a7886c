//! Lines drawn as text, for tests and examples that read like the figures of the standard.
//!
//! ```text
//! L+      _10ms ~7s
//! C/Q     _2.01s ~700us _1.1s ( ~99ms _1ms )x30 ~1s
//! I/Q     _3.1107s ~3s
//! wake-up _2.0108s !
//! ```
//! `_` is low and `~` high for the time that follows; `( ... )x30` repeats; `!` is a wake-up. A line keeps its last level.

use crate::{Edge, Levels, Recording, RecordingError};
use fsct_adapters::Line;

/// A text that is no chart.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct ChartError(String);

/// A recording written as text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Chart {
    levels: Levels,
    edges: Vec<Edge>,
    next: usize,
    end: u64,
    uncertainty: u64,
}

impl Chart {
    /// Reads the lines of a text; one that is not drawn is not in the recording. The longest line is the end.
    ///
    /// # Errors
    /// [`ChartError`] with the word that is not understood.
    pub fn parse(text: &str) -> Result<Chart, ChartError> {
        let mut chart = Chart { levels: Levels::default(), edges: Vec::new(), next: 0, end: 0, uncertainty: 0 };
        for row in text.lines().map(str::trim).filter(|row| !row.is_empty()) {
            let (name, waves) = row.split_once(char::is_whitespace).unwrap_or((row, ""));
            let line = Line::ALL.into_iter().find(|entry| entry.2 == name);
            let Some((line, ..)) = line else { return Err(ChartError(format!("`{name}` is no line"))) };
            chart.row(line, waves)?;
        }
        chart.edges.sort_by_key(|edge| edge.at);
        Ok(chart)
    }

    /// The same with an uncertainty of every edge, in nanoseconds either way.
    #[must_use]
    pub fn uncertain(mut self, nanoseconds: u64) -> Chart {
        self.uncertainty = nanoseconds;
        self
    }

    /// All edges, in the order of time.
    pub fn edges(&self) -> &[Edge] {
        &self.edges
    }

    fn row(&mut self, line: Line, waves: &str) -> Result<(), ChartError> {
        let mut words = Vec::new();
        let mut group = None;
        for word in waves.split_whitespace() {
            match (word, word.strip_prefix(")x")) {
                ("(", _) => group = Some(words.len()),
                (_, Some(times)) => {
                    let times: usize = times.parse().map_err(|_| ChartError(format!("`{word}` is no repetition")))?;
                    let group = words.split_off(group.take().unwrap_or(words.len()));
                    words.extend(std::iter::repeat_n(group, times).flatten());
                }
                _ => words.push(word),
            }
        }
        let mut now = 0u64;
        let mut level = None;
        for word in words {
            let (next, length) = match word.split_at_checked(1) {
                Some(("_", length)) => (false, length),
                Some(("~", length)) => (true, length),
                Some(("!", "")) => {
                    self.edges.push(Edge { at: now, line, level: true });
                    continue;
                }
                _ => return Err(ChartError(format!("`{word}` is no piece of a line"))),
            };
            match level {
                None => self.set(line, next),
                Some(level) if level != next => self.edges.push(Edge { at: now, line, level: next }),
                Some(_) => {}
            }
            level = Some(next);
            now = now.saturating_add(time(length).ok_or_else(|| ChartError(format!("`{length}` is no time")))?);
        }
        self.end = self.end.max(now);
        Ok(())
    }

    fn set(&mut self, line: Line, level: bool) {
        match line {
            Line::Power => self.levels.power = Some(level),
            Line::Cq => self.levels.cq = Some(level),
            Line::Iq => self.levels.iq = Some(level),
            Line::WakeUp => {}
        }
    }
}

impl Recording for Chart {
    fn levels(&self) -> Levels {
        self.levels
    }

    fn uncertainty_ns(&self) -> u64 {
        self.uncertainty
    }

    fn next_edge(&mut self) -> Result<Option<Edge>, RecordingError> {
        let edge = self.edges.get(self.next).copied();
        self.next += usize::from(edge.is_some());
        Ok(edge)
    }

    fn end(&self) -> u64 {
        self.end
    }
}

/// `1.1s`, `700us`, `20ns`: nanoseconds, exact.
fn time(text: &str) -> Option<u64> {
    let (number, nano) = [("ns", 1), ("us", 1_000), ("ms", 1_000_000), ("s", 1_000_000_000)]
        .into_iter()
        .find_map(|(unit, nano): (&str, u64)| text.strip_suffix(unit).map(|number| (number, nano)))?;
    let (whole, part) = number.split_once('.').unwrap_or((number, ""));
    let mut value = whole.parse::<u64>().ok()?.checked_mul(nano)?;
    let mut scale = nano;
    for digit in part.chars() {
        scale /= 10;
        value = value.checked_add(u64::from(digit.to_digit(10)?) * scale)?;
    }
    Some(value)
}
