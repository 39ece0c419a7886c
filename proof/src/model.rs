//! What is explored: the edition, how the tables are read, the timers, and what may go wrong.

use core::fmt;
use core::str::FromStr;
use fsct_observed::{Mealy, Seen};
use fsct_protocol::Edition;
use std::sync::Arc;

/// How the image that an FS-Device returns in an exchange relates to the one it receives there.
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq)]
pub enum Timing {
    /// The image made before this exchange: an undisturbed SCL cycle takes two exchanges.
    #[default]
    Pipelined,
    /// The answer itself: an undisturbed SCL cycle takes one exchange.
    Immediate,
}

impl FromStr for Timing {
    type Err = String;

    fn from_str(text: &str) -> Result<Timing, String> {
        match text {
            "P" => Ok(Timing::Pipelined),
            "I" => Ok(Timing::Immediate),
            _ => Err(format!("`{text}` is no timing; P (pipelined) and I (immediate answers) are")),
        }
    }
}

impl fmt::Display for Timing {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Timing::Pipelined => "P",
            Timing::Immediate => "I",
        })
    }
}

/// A reading of the tables that departs from the default; the numbers are those of `docs/decisions.md` and `fsct explain`.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Reading {
    /// A05: an all-zero SPDU is checked, and found wrong, in states 7 and 24.
    ZeroJudged,
    /// A06: T10 takes any answer but the previous counter.
    NotOld,
    /// A06: T10 takes the expected counter, and any other but the previous.
    ExpectedOrNotOld,
    /// A06: T6 takes the expected counter alone.
    Expected,
    /// A08: "previous SPDU" is the last valid one.
    PreviousValid,
    /// A16: DCount_i is that of the last valid SPDU.
    MirrorValid,
    /// A08 and A16: "previous SPDU" and DCount_i are those of the last valid SPDU.
    LastValid,
    /// A09: T24 and T27 take the next counter alone.
    ExactlyNext,
    /// A09: T24 and T27 take the next counter or 0.
    NextOrZero,
    /// A19: T29 works off its counters in the error cycle too.
    Sequential,
    /// A29: a wrong SPDU trips either side although its counter is not one that is looked at.
    OldJudged,
    /// A30: T3 takes the expected counter alone.
    FirstExpected,
    /// A31: the first SPDU an FS-Device sees may carry 1.
    FirstOne,
    /// A37: a timer that expires in the exchange of a reception wins.
    TimerFirst,
    /// A37: a reception in the exchange in which the timer expires wins.
    ReceptionFirst,
}

impl Reading {
    /// Every reading there is.
    pub const ALL: [Reading; 15] = [
        Reading::ZeroJudged,
        Reading::NotOld,
        Reading::ExpectedOrNotOld,
        Reading::Expected,
        Reading::PreviousValid,
        Reading::MirrorValid,
        Reading::LastValid,
        Reading::ExactlyNext,
        Reading::NextOrZero,
        Reading::Sequential,
        Reading::OldJudged,
        Reading::FirstExpected,
        Reading::FirstOne,
        Reading::TimerFirst,
        Reading::ReceptionFirst,
    ];

    /// How it is called on the command line.
    pub const fn name(self) -> &'static str {
        match self {
            Reading::ZeroJudged => "A05=judged",
            Reading::NotOld => "A06=T10-not-old",
            Reading::ExpectedOrNotOld => "A06=T10-expected-or-not-old",
            Reading::Expected => "A06=T6-expected",
            Reading::PreviousValid => "A08=last-valid",
            Reading::MirrorValid => "A16=last-valid",
            Reading::LastValid => "A08+A16=last-valid",
            Reading::ExactlyNext => "A09=exactly-next",
            Reading::NextOrZero => "A09=next-or-0",
            Reading::Sequential => "A19=sequential",
            Reading::OldJudged => "A29=trips",
            Reading::FirstExpected => "A30=expected",
            Reading::FirstOne => "A31=0-or-1",
            Reading::TimerFirst => "A37=timer-first",
            Reading::ReceptionFirst => "A37=reception-first",
        }
    }

    /// Whether two readings answer the same question.
    fn excludes(self, other: Reading) -> bool {
        use Reading::{ExactlyNext, ExpectedOrNotOld, LastValid, MirrorValid, NextOrZero, NotOld};
        use Reading::{PreviousValid, ReceptionFirst, TimerFirst};
        let pairs = [
            [NotOld, ExpectedOrNotOld],
            [LastValid, PreviousValid],
            [LastValid, MirrorValid],
            [ExactlyNext, NextOrZero],
            [TimerFirst, ReceptionFirst],
        ];
        pairs.iter().any(|pair| self != other && pair.contains(&self) && pair.contains(&other))
    }
}

impl fmt::Display for Reading {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for Reading {
    type Err = String;

    fn from_str(text: &str) -> Result<Reading, String> {
        Reading::ALL.into_iter().find(|reading| reading.name() == text).ok_or_else(|| {
            let names: Vec<_> = Reading::ALL.iter().map(|reading| reading.name()).collect();
            format!("`{text}` is no reading; these are: {}", names.join(", "))
        })
    }
}

/// What is explored. The default is that of the standard's tables with a watchdog of four exchanges and a channel that may do anything.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Model {
    /// Edition of the tables.
    pub edition: Edition,
    /// Readings that depart from the default.
    pub readings: Vec<Reading>,
    /// FSP_Watchdog in exchanges, [`Model::WATCHDOGS`].
    pub watchdog: u8,
    /// When answers come back.
    pub timing: Timing,
    /// Most disturbed exchanges, [`Model::FAULTS`]; `None`: any number. A power cycle of the FS-Device is not one of them.
    pub faults: Option<u8>,
    /// The FS-Device may lose its power at any time for any time.
    pub power_cycles: bool,
    /// The machine of a product in place of the FS-Device ([`crate::can_stand_in`]).
    pub device: Option<Arc<Mealy<Seen>>>,
    /// The machine of a product in place of the FS-Master.
    pub master: Option<Arc<Mealy<Seen>>>,
    /// Most states kept in one search, so that memory is bounded: a state takes some 60 octets.
    pub most_states: usize,
}

impl Model {
    /// Watchdogs that can be explored, in exchanges.
    pub const WATCHDOGS: core::ops::RangeInclusive<u8> = 2..=15;
    /// States kept at most unless told otherwise: some 300 MB.
    pub const MOST_STATES: usize = 5_000_000;
    /// Numbers of disturbed exchanges that can be counted.
    pub const FAULTS: core::ops::RangeInclusive<u8> = 0..=14;

    /// Both machines as the tables of an edition are read by default.
    pub fn new(edition: Edition) -> Model {
        Model {
            edition,
            readings: Vec::new(),
            watchdog: 4,
            timing: Timing::Pipelined,
            faults: None,
            power_cycles: true,
            device: None,
            master: None,
            most_states: Model::MOST_STATES,
        }
    }

    /// Whether a reading is followed.
    pub fn reads(&self, reading: Reading) -> bool {
        self.readings.contains(&reading)
    }

    /// Whether it can be explored.
    ///
    /// # Errors
    /// One sentence with what cannot and the remedy.
    pub fn check(&self) -> Result<(), String> {
        let (watchdogs, faults) = (Model::WATCHDOGS, Model::FAULTS);
        if !watchdogs.contains(&self.watchdog) {
            let (least, most) = (watchdogs.start(), watchdogs.end());
            return Err(format!("a watchdog of {} exchanges; {least} to {most} can be explored", self.watchdog));
        }
        if self.faults.is_some_and(|count| !faults.contains(&count)) {
            return Err(format!("more than {} disturbed exchanges are not counted; take `unlimited`", faults.end()));
        }
        if self.reads(Reading::FirstOne) && self.edition == Edition::Iec2022 {
            return Err(format!("{} is a reading of v1.1 alone (11.5.3): iec2022 demands 0", Reading::FirstOne));
        }
        for (at, reading) in self.readings.iter().enumerate() {
            if let Some(other) = self.readings.iter().skip(at + 1).find(|other| reading.excludes(**other)) {
                return Err(format!("{reading} and {other} answer the same question; take one"));
            }
        }
        Ok(())
    }
}
