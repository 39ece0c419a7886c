//! Values measured in a case, with the limits they were held against and what is uncertain.

use crate::record::Verdict;
use serde::{Deserialize, Serialize};

/// What a value is counted in.
#[derive(Copy, Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Counted {
    /// A time in nanoseconds.
    Nanoseconds,
    /// A ratio, in parts of 1e9.
    PartsPerBillion,
}

/// One measured value. All numbers are counted as `counted` says.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Measurement {
    /// Symbol of the limit: `t_RP`.
    pub symbol: String,
    /// What it is, in words.
    pub about: String,
    /// Clause and table of the limit.
    pub clause: String,
    /// Number of the step, 0 for the start condition.
    pub step: usize,
    /// Where the measured time begins, in nanoseconds from the beginning of the case or recording.
    pub at_ns: u64,
    /// What the numbers are.
    pub counted: Counted,
    /// The value is this at least, not counting the uncertainty.
    pub low: u64,
    /// The value is this at most, not counting the uncertainty; equal to `low` for a plain value, `None`: not known.
    pub high: Option<u64>,
    /// How far either may be off, either way.
    pub uncertainty: u64,
    /// The smallest value permitted.
    pub min: Option<u64>,
    /// The largest value permitted.
    pub max: Option<u64>,
    /// Distance to the nearest limit, negative outside; `None` without a limit.
    pub margin: Option<i64>,
    /// What follows: `pass` and `fail` only outside the guard band.
    pub verdict: Verdict,
}

impl Measurement {
    /// A number with a unit that suits it: `750 us`, `1.2 s`, `0.005`.
    pub fn show(&self, value: u64) -> String {
        match self.counted {
            Counted::Nanoseconds => time(value),
            Counted::PartsPerBillion => trimmed(format!("{:.6}", value as f64 / 1e9)),
        }
    }

    /// The value: `750 us`, `19 ms to 20 ms`, `more than 5.01 s`.
    pub fn plain(&self) -> String {
        match self.high {
            Some(high) if high == self.low => self.show(self.low),
            Some(high) => format!("{} to {}", self.show(self.low), self.show(high)),
            None => format!("more than {}", self.show(self.low)),
        }
    }

    /// The value with the uncertainty where there is one.
    pub fn value(&self) -> String {
        let plain = self.plain();
        match self.uncertainty {
            0 => plain,
            off => format!("{plain} ± {}", self.show(off)),
        }
    }

    /// Distance to the nearest limit with its sign: `250 us`, `-1 us`.
    pub fn margin(&self) -> Option<String> {
        let margin = self.margin?;
        Some(format!("{}{}", if margin < 0 { "-" } else { "" }, self.show(margin.unsigned_abs())))
    }

    /// The limits: `500 us to 1000 us`, `at most 5 s`, `no limit`.
    pub fn limits(&self) -> String {
        match (self.min, self.max) {
            (Some(min), Some(max)) => format!("{} to {}", self.show(min), self.show(max)),
            (Some(min), None) => format!("at least {}", self.show(min)),
            (None, Some(max)) => format!("at most {}", self.show(max)),
            (None, None) => "no limit".to_owned(),
        }
    }
}

/// A time in the unit that reads best, exact to the nanosecond.
pub fn time(ns: u64) -> String {
    let (unit, scale) = match ns {
        0 => return "0 s".to_owned(),
        1..1_000 => ("ns", 1),
        1_000..2_000_000 => ("us", 1_000),
        2_000_000..1_100_000_000 => ("ms", 1_000_000),
        _ => ("s", 1_000_000_000u64),
    };
    let digits = scale.ilog10() as usize;
    let text = match digits {
        0 => ns.to_string(),
        _ => trimmed(format!("{}.{:0digits$}", ns / scale, ns % scale)),
    };
    format!("{text} {unit}")
}

fn trimmed(number: String) -> String {
    number.trim_end_matches('0').trim_end_matches('.').to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;
    use rstest::rstest;

    #[rstest]
    #[case(0, "0 s")]
    #[case(999, "999 ns")]
    #[case(50_000, "50 us")]
    #[case(499_000, "499 us")]
    #[case(1_000_000, "1000 us")]
    #[case(20_000_001, "20.000001 ms")]
    #[case(1_000_000_000, "1000 ms")]
    #[case(5_001_000_000, "5.001 s")]
    fn times_read_exactly(#[case] ns: u64, #[case] text: &str) {
        assert_eq!(time(ns), text);
    }
}
