//! Limits of both editions, by symbol. The table is data: `testcases/limits.yaml`; the harness reads it.

use crate::judge::Bounds;
use fsct_protocol::Edition;

/// Who has to keep a limit.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Subject {
    /// FS-Device.
    Device,
    /// FS-Master port.
    Master,
    /// Either of them.
    Both,
    /// The cable between them.
    Line,
}

impl Subject {
    /// All of them with their names in the file.
    pub const ALL: [(Subject, &'static str); 4] =
        [(Subject::Device, "device"), (Subject::Master, "master"), (Subject::Both, "both"), (Subject::Line, "line")];

    /// Its name.
    pub fn name(self) -> &'static str {
        Subject::ALL.into_iter().find(|entry| entry.0 == self).map_or("", |entry| entry.1)
    }
}

/// Unit of the values of a limit.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Unit {
    /// Second.
    Second,
    /// Millisecond.
    Millisecond,
    /// Microsecond.
    Microsecond,
    /// Bit time of the transmission rate.
    BitTime,
    /// None: one value to another, or a number of times.
    One,
    /// Volt.
    Volt,
    /// Volt, peak to peak.
    VoltPeakToPeak,
    /// Milliampere.
    Milliampere,
    /// Milliampere second.
    MilliampereSecond,
    /// Nanofarad.
    Nanofarad,
    /// Ohm.
    Ohm,
    /// Metre.
    Metre,
}

impl Unit {
    /// All of them with their names in the file.
    pub const ALL: [(Unit, &'static str); 12] = [
        (Unit::Second, "s"),
        (Unit::Millisecond, "ms"),
        (Unit::Microsecond, "us"),
        (Unit::BitTime, "T_BIT"),
        (Unit::One, "1"),
        (Unit::Volt, "V"),
        (Unit::VoltPeakToPeak, "Vpp"),
        (Unit::Milliampere, "mA"),
        (Unit::MilliampereSecond, "mAs"),
        (Unit::Nanofarad, "nF"),
        (Unit::Ohm, "Ohm"),
        (Unit::Metre, "m"),
    ];

    /// Its name.
    pub fn name(self) -> &'static str {
        Unit::ALL.into_iter().find(|entry| entry.0 == self).map_or("", |entry| entry.1)
    }

    /// How many of what is measured make one: nanoseconds, or parts of 1e9; `None` for what lines do not show.
    pub fn nano(self) -> Option<f64> {
        match self {
            Unit::Second | Unit::One => Some(1e9),
            Unit::Millisecond => Some(1e6),
            Unit::Microsecond => Some(1e3),
            _ => None,
        }
    }
}

/// What it means when a value lies outside.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Outside {
    /// The DUT fails.
    Fail,
    /// It is shown as a remark.
    Remark,
    /// The value is recorded and nothing follows.
    Recorded,
}

impl Outside {
    /// All of them with their names in the file.
    pub const ALL: [(Outside, &'static str); 3] =
        [(Outside::Fail, "fail"), (Outside::Remark, "remark"), (Outside::Recorded, "recorded")];

    /// Its name.
    pub fn name(self) -> &'static str {
        Outside::ALL.into_iter().find(|entry| entry.0 == self).map_or("", |entry| entry.1)
    }
}

/// How a limit is verified.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Verify {
    /// By edges and exchanges.
    Measured,
    /// With sources, loads and instruments.
    Bench,
    /// By reading a parameter.
    Read,
}

impl Verify {
    /// All of them with their names in the file.
    pub const ALL: [(Verify, &'static str); 3] =
        [(Verify::Measured, "measured"), (Verify::Bench, "bench"), (Verify::Read, "read")];

    /// Its name.
    pub fn name(self) -> &'static str {
        Verify::ALL.into_iter().find(|entry| entry.0 == self).map_or("", |entry| entry.1)
    }
}

/// The values of one edition, in the unit of the limit.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// The smallest value permitted; with `min_from` the one without a declaration.
    pub min: Option<f64>,
    /// The largest value permitted; with `max_from` the one without a declaration.
    pub max: Option<f64>,
    /// Where the smallest value comes from, if not from the standard: a parameter or the data sheet.
    pub min_from: Option<String>,
    /// Where the largest value comes from, if not from the standard.
    pub max_from: Option<String>,
    /// Clause and table.
    pub clause: String,
    /// Printed by the base standard only: recorded, never judged.
    pub base: bool,
    /// What it means when a value lies outside.
    pub outside: Outside,
}

/// A limit in both editions.
#[derive(Clone, Debug, PartialEq)]
pub struct Limit {
    /// Its symbol.
    pub symbol: String,
    /// What it limits.
    pub about: String,
    /// Who has to keep it.
    pub dut: Subject,
    /// Unit of all its values.
    pub unit: Unit,
    /// V1.1; `None`: not in this edition.
    pub v1_1: Option<Row>,
    /// IEC 61139-2:2022; `None`: not in this edition.
    pub iec2022: Option<Row>,
    /// Open points whose reading is in force: L03.
    pub open: Vec<String>,
    /// Which value judges, and why, where that is not plain.
    pub why: Option<String>,
    /// How it is verified.
    pub verify: Verify,
    /// Records of the ledger.
    pub requirements: Vec<String>,
}

impl Limit {
    /// The values of an edition; `None`: it has no such limit.
    pub fn row(&self, edition: Edition) -> Option<&Row> {
        match edition {
            Edition::V1_1 => self.v1_1.as_ref(),
            Edition::Iec2022 => self.iec2022.as_ref(),
        }
    }

    /// What it means in an edition when a value lies outside; nothing follows from a value of the base standard, nor where
    /// the edition has no such limit.
    pub fn outside(&self, edition: Edition) -> Outside {
        self.row(edition).filter(|row| !row.base).map_or(Outside::Recorded, |row| row.outside)
    }

    /// The bounds of an edition for a measured value, in nanoseconds or parts of 1e9; `None` where lines do not show it or
    /// the edition does not have it. `declared` gives what a parameter or the data sheet says, in the unit of the limit; it
    /// takes the place of the printed value.
    pub fn bounds(&self, edition: Edition, declared: impl Fn(&str) -> Option<f64>) -> Option<Bounds> {
        let row = self.row(edition)?;
        let nano = self.unit.nano()?;
        let bound = |printed: Option<f64>, from: &Option<String>| {
            let value = from.as_deref().and_then(&declared).or(printed)?;
            Some((value * nano).round().max(0.0) as u64)
        };
        Some(Bounds { min: bound(row.min, &row.min_from), max: bound(row.max, &row.max_from) })
    }
}

/// All limits, in the order of the file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Limits(Vec<Limit>);

impl Limits {
    /// The limits of a list; of two with the same symbol the first counts.
    pub fn new(limits: Vec<Limit>) -> Limits {
        Limits(limits)
    }

    /// The limit with this symbol.
    pub fn get(&self, symbol: &str) -> Option<&Limit> {
        self.0.iter().find(|limit| limit.symbol == symbol)
    }

    /// All of them.
    pub fn iter(&self) -> impl Iterator<Item = &Limit> {
        self.0.iter()
    }
}
