//! What is missing, said by the chapter that misses it.

/// Something the records do not show.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Gap {
    /// What kind of gap.
    pub kind: Kind,
    /// What is missing. Not escaped.
    pub what: String,
    /// The command that closes it; empty: none does.
    pub command: String,
}

/// Kinds of gaps, the most urgent first.
#[derive(Copy, Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Kind {
    /// The product did something else than the standard asks.
    Failure,
    /// Something ran and came to no conclusion, or was not executed as meant, or a record is not whole.
    Inconclusive,
    /// It could have been run and is not in the records.
    NotRun,
    /// The product follows another reading than the default, or there is one to be settled.
    Reading,
    /// Nobody has done anything about it in fsct yet.
    Open,
    /// Needs instruments or a person.
    ByHand,
    /// The maker or a third party has to bring it.
    Elsewhere,
}

impl Kind {
    /// All kinds, in order.
    pub const ALL: [Kind; 7] =
        [Kind::Failure, Kind::Inconclusive, Kind::NotRun, Kind::Reading, Kind::Open, Kind::ByHand, Kind::Elsewhere];

    /// Heading in the chapter on gaps.
    pub const fn title(self) -> &'static str {
        match self {
            Kind::Failure => "✗ Failures",
            Kind::Inconclusive => "? Inconclusive, or not executed as meant",
            Kind::NotRun => "○ Not in these records",
            Kind::Reading => "● Readings of the standard",
            Kind::Open => "○ Not covered by fsct",
            Kind::ByHand => "□ For instruments or a person",
            Kind::Elsewhere => "□ To be brought by the maker or a third party",
        }
    }
}

impl Gap {
    /// A gap that a command closes.
    pub fn closed_by(kind: Kind, what: impl Into<String>, command: impl Into<String>) -> Gap {
        Gap { kind, what: what.into(), command: command.into() }
    }

    /// A gap that no command closes.
    pub fn new(kind: Kind, what: impl Into<String>) -> Gap {
        Gap::closed_by(kind, what, "")
    }
}
