//! OSSD mode: both outputs ON, test pulses, discrepancy, demand (5.3.2, Figures 18, 19 and 21; Table 7).
//!
//! Edges alone do not say why a line is low. What is low for a short time and comes back is a test pulse, what is low on both
//! lines for longer is OFF, what is low on one line for longer is a discrepancy. The times that part them stand here, far
//! enough above the limits that a value beyond its limit is still measured as what it is.

use fsct_adapters::Line;

/// Both lines low for longer than this is OFF, in nanoseconds. Test pulses last 1 ms at most (Table 7).
pub const OFF_AFTER: u64 = 1_500_000;

/// One line low for longer than this, while the other stays high, is a discrepancy and no test pulse, in nanoseconds. The
/// discrepancy permitted is 3 ms at most (Table 7 of v1.1).
pub const ALONE_AFTER: u64 = 10_000_000;

/// The widest test pulse permitted, in nanoseconds (Table 7): how long one may be running when nothing better is known.
const PULSE: u64 = 1_000_000;

/// A value and when it was seen, both in nanoseconds.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Seen {
    /// The value.
    pub value: u64,
    /// Where on the clock of the recording.
    pub at: u64,
}

/// The smallest and the largest of many values; the first of equal ones.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Extremes {
    /// How many there were.
    pub count: u64,
    /// The smallest.
    pub min: Seen,
    /// The largest.
    pub max: Seen,
}

impl Extremes {
    /// Takes one more value in.
    pub(crate) fn add(all: &mut Option<Extremes>, value: u64, at: u64) {
        let seen = Seen { value, at };
        let all = all.get_or_insert(Extremes { count: 0, min: seen, max: seen });
        all.count += 1;
        if value < all.min.value {
            all.min = seen;
        }
        if value > all.max.value {
            all.max = seen;
        }
    }
}

/// A pulse and the way to the next one.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Ratio {
    /// Width, in nanoseconds.
    pub width: u64,
    /// From its falling edge to the next falling edge of the line, in nanoseconds; not 0.
    pub period: u64,
    /// Its falling edge.
    pub at: u64,
}

/// The test pulses of one line (Figure 19): low while ON, times of the falling edges.
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq)]
pub struct TestPulses {
    /// Widths (t_i), in nanoseconds.
    pub width: Option<Extremes>,
    /// From one to the next with no OFF between (T_p), in nanoseconds.
    pub period: Option<Extremes>,
    /// The one that takes the largest part of its period (t_i/T_p).
    pub ratio: Option<Ratio>,
}

/// Both outputs at different levels while they change between ON and OFF, or for no reason.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Discrepancy {
    /// How long for certain, in nanoseconds: the longest, each without the test pulse that may have been running (L17).
    pub low: u64,
    /// How long at most, in nanoseconds: the longest as the edges show it.
    pub high: u64,
    /// Where `high` was seen.
    pub at: u64,
}

/// What the two outputs of an FS-Device did in OSSD mode.
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq)]
pub struct Ossd {
    /// Both lines ON for the first time; `None` as long as one has not come.
    pub both_on: Option<u64>,
    /// Test pulses of C/Q, OSSD1e.
    pub cq: TestPulses,
    /// Test pulses of I/Q, OSSD2e.
    pub iq: TestPulses,
    /// From a test pulse of C/Q to the nearest one of I/Q (Delta t), in nanoseconds.
    pub shift: Option<Extremes>,
    /// The longest discrepancy.
    pub discrepancy: Option<Discrepancy>,
    /// How often both went OFF.
    pub demands: u64,
    /// The first edge to OFF of the first and of the last of them.
    pub demand: Option<(u64, u64)>,
}

/// A line while it is being watched.
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq)]
struct Output {
    high: bool,
    /// Since when it is low; `None` when it is high.
    low_since: Option<u64>,
    /// Whether the other line was low at some time of this low phase.
    together: bool,
    /// The last test pulse since the outputs went ON: falling edge and width.
    last: Option<(u64, u64)>,
}

/// Watches two outputs in OSSD mode.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Watch {
    pub(crate) seen: Ossd,
    cq: Output,
    iq: Output,
    /// Both are in the recording.
    pair: bool,
    /// OFF, with the time since when exactly one is high.
    off: Option<Option<u64>>,
    /// A test pulse of C/Q that waits for its successor on I/Q: falling edge, distance to the one before.
    waiting: Option<(u64, Option<u64>)>,
}

impl Watch {
    /// Begins with the levels at `now`; `first` is since when one of the lines has been high.
    pub(crate) fn new(cq: bool, iq: Option<bool>, first: u64, now: u64) -> Watch {
        let output = |high: bool| Output { high, low_since: (!high).then_some(first), ..Output::default() };
        // A line that is not in the recording goes with the other one.
        let other = iq.unwrap_or(cq);
        let both = cq && other;
        let mut watch = Watch {
            seen: Ossd::default(),
            cq: output(cq),
            iq: output(other),
            pair: iq.is_some(),
            off: (!both).then_some((cq || other).then_some(first)),
            waiting: None,
        };
        if both {
            watch.seen.both_on = Some(now);
            if watch.pair {
                watch.discrepancy(now.saturating_sub(first), now.saturating_sub(first), first);
            }
        }
        watch
    }

    /// Draws what follows from no edge having come until `now`.
    pub(crate) fn settle(&mut self, now: u64) {
        if self.off.is_some() {
            return;
        }
        let (Some(cq), Some(iq)) = (self.cq.low_since, self.iq.low_since) else { return };
        let both = cq.max(iq);
        if now.saturating_sub(both) <= OFF_AFTER {
            return;
        }
        let first = cq.min(iq);
        if self.pair {
            let skew = both - first;
            let running = if cq < iq { pulse_running(&self.cq, &self.seen.cq, first) } else { 0 };
            let running = if iq < cq { pulse_running(&self.iq, &self.seen.iq, first) } else { running };
            self.discrepancy(skew.saturating_sub(running), skew, first);
        }
        self.seen.demands += 1;
        let begin = self.seen.demand.map_or(first, |(begin, _)| begin);
        self.seen.demand = Some((begin, first));
        self.off = Some(None);
        self.waiting = None;
        self.cq.last = None;
        self.iq.last = None;
    }

    /// A line changes its level; everything before `at` is settled.
    pub(crate) fn edge(&mut self, line: Line, level: bool, at: u64) {
        self.settle(at);
        if !self.pair {
            self.change(Line::Iq, level, at);
        }
        self.change(line, level, at);
    }

    fn change(&mut self, line: Line, level: bool, at: u64) {
        let (own, other) = match line {
            Line::Iq => (&mut self.iq, &mut self.cq),
            _ => (&mut self.cq, &mut self.iq),
        };
        if own.high == level {
            return;
        }
        own.high = level;
        let other_high = other.high;
        if let Some(alone) = self.off {
            own.low_since = (!level).then_some(at);
            match alone {
                Some(since) => {
                    if self.pair {
                        self.discrepancy(at.saturating_sub(since), at.saturating_sub(since), since);
                    }
                    if level {
                        self.seen.both_on.get_or_insert(at);
                        self.off = None;
                        self.cq.low_since = None;
                        self.iq.low_since = None;
                    } else {
                        self.off = Some(None);
                    }
                }
                None => self.off = Some(Some(at)),
            }
            return;
        }
        if !level {
            own.low_since = Some(at);
            own.together = !other_high;
            other.together |= !other_high;
            return;
        }
        let Some(fall) = own.low_since.take() else { return };
        let together = own.together;
        let width = at.saturating_sub(fall);
        let longest = if together { OFF_AFTER } else { ALONE_AFTER };
        if width <= longest {
            self.pulse(line, fall, width);
        } else if self.pair {
            // Of a low phase that met one of the other line, that one took at most OFF_AFTER away.
            let less = if together { OFF_AFTER } else { 0 };
            self.discrepancy(width.saturating_sub(less), width, fall);
        }
    }

    fn pulse(&mut self, line: Line, fall: u64, width: u64) {
        if line == Line::Iq && !self.pair {
            return;
        }
        let (own, seen, other) = match line {
            Line::Iq => (&mut self.iq, &mut self.seen.iq, &self.cq),
            _ => (&mut self.cq, &mut self.seen.cq, &self.iq),
        };
        Extremes::add(&mut seen.width, width, fall);
        if let Some((before, width)) = own.last {
            let period = fall.saturating_sub(before).max(1);
            Extremes::add(&mut seen.period, period, before);
            let ratio = Ratio { width, period, at: before };
            let larger = |known: &Ratio| {
                u128::from(width) * u128::from(known.period) > u128::from(known.width) * u128::from(period)
            };
            if seen.ratio.as_ref().is_none_or(larger) {
                seen.ratio = Some(ratio);
            }
        }
        own.last = Some((fall, width));
        if !self.pair {
            return;
        }
        match line {
            Line::Iq => {
                if let Some((cq, before)) = self.waiting.take() {
                    let after = fall.abs_diff(cq);
                    Extremes::add(&mut self.seen.shift, before.map_or(after, |before| before.min(after)), cq);
                }
            }
            _ => self.waiting = Some((fall, other.last.map(|(iq, _)| fall.abs_diff(iq)))),
        }
    }

    fn discrepancy(&mut self, low: u64, high: u64, at: u64) {
        match &mut self.seen.discrepancy {
            Some(known) => {
                known.low = known.low.max(low);
                if high > known.high {
                    (known.high, known.at) = (high, at);
                }
            }
            none => *none = Some(Discrepancy { low, high, at }),
        }
    }

    /// The recording or the power ends here.
    pub(crate) fn finish(&mut self, now: u64) {
        self.settle(now);
        let alone = match self.off {
            Some(alone) => alone,
            None => match (self.cq.low_since, self.iq.low_since) {
                (Some(since), None) | (None, Some(since)) => Some(since),
                _ => None,
            },
        };
        if let Some(since) = alone.filter(|since| self.pair && now.saturating_sub(*since) > ALONE_AFTER) {
            self.discrepancy(now - since, now - since, since);
        }
    }
}

/// How long a test pulse may have been running that began at `fall`, in nanoseconds; 0 when none was due.
fn pulse_running(output: &Output, seen: &TestPulses, fall: u64) -> u64 {
    let due = match (output.last, seen.period) {
        (Some((last, _)), Some(period)) => fall.saturating_sub(last) >= period.min.value / 10 * 9,
        _ => true,
    };
    if due { seen.width.map_or(PULSE, |width| width.max.value) } else { 0 }
}
