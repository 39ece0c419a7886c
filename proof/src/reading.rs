//! Readings of the tables that depart from the default, and which machine each is about.

use core::fmt;
use core::str::FromStr;
use fsct_protocol::scl::State;

/// One of the two machines.
#[derive(Copy, Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Machine {
    /// The SCL of an FS-Master, Table 38.
    Master,
    /// The SCL of an FS-Device, Table 40.
    Device,
}

impl Machine {
    /// Both.
    pub const ALL: [Machine; 2] = [Machine::Master, Machine::Device];
}

impl fmt::Display for Machine {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Machine::Master => "FS-Master",
            Machine::Device => "FS-Device",
        })
    }
}

/// A reading of the tables that departs from the default; the numbers are those of `docs/decisions.md` and `fsct explain`.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Reading {
    /// A05: an all-zero SPDU is checked, and found wrong, in states 7 and 24.
    ZeroJudged,
    /// A06: T10 takes any answer but the previous counter.
    NotOld,
    /// A06: T10 takes the expected counter, and any other but the previous.
    ExpectedOrNotOld,
    /// A06: T10 takes the expected counter, and may take a foreign one once until T11.
    ForeignOnce,
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
    /// A09: as `NextOrZero`, but a falsified SPDU is a CommErr whatever its counter.
    JumpIgnored,
    /// A13: T11 waits until three SPDUs with SD have been answered.
    ThreeCycles,
    /// A19: T29 works off its counters in the error cycle too.
    Sequential,
    /// A20: T28 leaves setSD_DC at 1 while setSD is 1.
    SetSdDcKept,
    /// A23: MCount 0 loads SDcycles.
    ZeroReloads,
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
    pub const ALL: [Reading; 20] = [
        Reading::ZeroJudged,
        Reading::NotOld,
        Reading::ExpectedOrNotOld,
        Reading::ForeignOnce,
        Reading::Expected,
        Reading::PreviousValid,
        Reading::MirrorValid,
        Reading::LastValid,
        Reading::ExactlyNext,
        Reading::NextOrZero,
        Reading::JumpIgnored,
        Reading::ThreeCycles,
        Reading::Sequential,
        Reading::SetSdDcKept,
        Reading::ZeroReloads,
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
            Reading::ForeignOnce => "A06=T10-foreign-once",
            Reading::Expected => "A06=T6-expected",
            Reading::PreviousValid => "A08=last-valid",
            Reading::MirrorValid => "A16=last-valid",
            Reading::LastValid => "A08+A16=last-valid",
            Reading::ExactlyNext => "A09=exactly-next",
            Reading::NextOrZero => "A09=next-or-0",
            Reading::JumpIgnored => "A09=jump-ignored",
            Reading::ThreeCycles => "A13=three-cycles",
            Reading::Sequential => "A19=sequential",
            Reading::SetSdDcKept => "A20=kept",
            Reading::ZeroReloads => "A23=reloads",
            Reading::OldJudged => "A29=trips",
            Reading::FirstExpected => "A30=expected",
            Reading::FirstOne => "A31=0-or-1",
            Reading::TimerFirst => "A37=timer-first",
            Reading::ReceptionFirst => "A37=reception-first",
        }
    }

    /// Whether a machine can follow it.
    pub const fn concerns(self, machine: Machine) -> bool {
        use Reading::{
            Expected, ExpectedOrNotOld, FirstExpected, ForeignOnce, NotOld, OldJudged, ReceptionFirst, ThreeCycles,
            TimerFirst, ZeroJudged,
        };
        let both = matches!(self, ZeroJudged | OldJudged | TimerFirst | ReceptionFirst);
        let masters = matches!(self, NotOld | ExpectedOrNotOld | ForeignOnce | Expected | ThreeCycles | FirstExpected);
        match machine {
            Machine::Master => both || masters,
            Machine::Device => !masters,
        }
    }

    /// Whether two readings answer the same question.
    pub(crate) fn excludes(self, other: Reading) -> bool {
        use Reading::{ExactlyNext, ExpectedOrNotOld, ForeignOnce, JumpIgnored, LastValid, MirrorValid, NextOrZero};
        use Reading::{NotOld, PreviousValid, ReceptionFirst, TimerFirst};
        let questions: [&[Reading]; 5] = [
            &[NotOld, ExpectedOrNotOld, ForeignOnce],
            &[LastValid, PreviousValid],
            &[LastValid, MirrorValid],
            &[ExactlyNext, NextOrZero, JumpIgnored],
            &[TimerFirst, ReceptionFirst],
        ];
        questions.iter().any(|answers| self != other && answers.contains(&self) && answers.contains(&other))
    }

    /// Whether a machine that waits in this state behaves otherwise with it.
    fn matters_in(self, state: State) -> bool {
        let states: &[u8] = match self {
            Reading::FirstExpected => &[2],
            Reading::Expected => &[5],
            Reading::NotOld | Reading::ExpectedOrNotOld | Reading::ForeignOnce | Reading::ThreeCycles => &[7],
            Reading::ZeroJudged => &[7, 24],
            Reading::OldJudged | Reading::TimerFirst | Reading::ReceptionFirst => &[5, 7, 24, 26],
            Reading::FirstOne => &[21],
            Reading::ExactlyNext | Reading::NextOrZero | Reading::JumpIgnored | Reading::ZeroReloads => &[24, 26],
            Reading::Sequential | Reading::SetSdDcKept => &[26],
            Reading::PreviousValid | Reading::MirrorValid | Reading::LastValid => &[21, 24, 26],
        };
        states.contains(&state.0)
    }

    /// Whether it says what a machine remembers: such a reading is followed always or never.
    pub(crate) fn is_kept(self) -> bool {
        matches!(self, Reading::PreviousValid | Reading::MirrorValid | Reading::LastValid)
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

/// A set of readings that a machine follows in an exchange.
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Reads(u32);

impl Reads {
    pub(crate) fn with(self, reading: Reading) -> Reads {
        Reads(self.0 | 1 << reading as u8)
    }

    pub(crate) fn has(self, reading: Reading) -> bool {
        self.0 >> reading as u8 & 1 == 1
    }

    fn all(self) -> impl Iterator<Item = Reading> {
        Reading::ALL.into_iter().filter(move |reading| self.has(*reading))
    }

    /// Only those that say what is remembered.
    pub(crate) fn kept(self) -> Reads {
        self.all().filter(|reading| reading.is_kept()).fold(Reads::default(), Reads::with)
    }

    /// Whether each of them makes a difference in this state, or is followed always.
    pub(crate) fn matter_in(self, state: State) -> bool {
        self.all().all(|reading| reading.is_kept() || reading.matters_in(state))
    }

    /// Every set that a machine may follow which makes up its mind about each reading anew in each exchange.
    pub(crate) fn mixtures(self) -> Vec<Reads> {
        let mut sets = vec![self.kept()];
        for reading in self.all().filter(|reading| !reading.is_kept()) {
            let possible = sets.iter().filter(|set| !set.all().any(|other| reading.excludes(other)));
            let more: Vec<Reads> = possible.map(|set| set.with(reading)).collect();
            sets.extend(more);
        }
        sets
    }
}
