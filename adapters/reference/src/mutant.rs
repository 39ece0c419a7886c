//! The faults the reference FS-Device can be given on purpose, to prove that the suites find them. Each is a small
//! switch at the spot it concerns; this file only names them.

use std::fmt;

/// One deliberate fault.
#[derive(Copy, Clone, Debug, PartialEq, Eq, Hash)]
pub enum Mutant {
    /// Signatures start at 0.
    WrongSeed,
    /// A computed signature of 0 stays 0.
    ZeroNotReplaced,
    /// Answers carry FSP_Port itself.
    PortNotInverted,
    /// Every MCount is taken.
    CounterCheckMissing,
    /// SDcycles is loaded with 2.
    SdCycles2,
    /// DTimeout stays set.
    DTimeoutNeverCleared,
    /// Process data reach the technology during SDcycles.
    PdoutLiveDuringSdCycles,
    /// DTimer runs for twice FSP_Watchdog.
    WatchdogDoubled,
    /// DCommErr is never sent.
    DCommErrNeverReported,
    /// The received setSD has no effect.
    SetSdIgnored,
}

impl Mutant {
    /// All of them.
    pub const ALL: [Mutant; 10] = [
        Mutant::WrongSeed,
        Mutant::ZeroNotReplaced,
        Mutant::PortNotInverted,
        Mutant::CounterCheckMissing,
        Mutant::SdCycles2,
        Mutant::DTimeoutNeverCleared,
        Mutant::PdoutLiveDuringSdCycles,
        Mutant::WatchdogDoubled,
        Mutant::DCommErrNeverReported,
        Mutant::SetSdIgnored,
    ];

    /// The name used in addresses: `inproc:reference-device?mutant=NAME`.
    pub const fn name(self) -> &'static str {
        self.facts().0
    }

    /// The clause it violates, equal in both editions.
    pub const fn clause(self) -> &'static str {
        self.facts().1
    }

    /// What is wrong, in one sentence.
    pub const fn about(self) -> &'static str {
        self.facts().2
    }

    /// The mutant of this name.
    pub fn from_name(name: &str) -> Option<Mutant> {
        Mutant::ALL.into_iter().find(|mutant| mutant.name() == name)
    }

    const fn facts(self) -> (&'static str, &'static str, &'static str) {
        match self {
            Mutant::WrongSeed => {
                ("wrong-seed", "D.3.6", "SPDU signatures are computed and checked with the start value 0 instead of 1.")
            }
            Mutant::ZeroNotReplaced => {
                ("zero-not-replaced", "11.4.7", "A computed signature of 0 is sent and expected as 0 instead of 1.")
            }
            Mutant::PortNotInverted => {
                ("port-not-inverted", "11.4.5", "Answers carry FSP_Port instead of its bitwise inverse.")
            }
            Mutant::CounterCheckMissing => (
                "counter-check-missing",
                "11.5.3 Table 40",
                "An SPDU with any MCount other than the previous one is taken as good.",
            ),
            Mutant::SdCycles2 => (
                "sd-cycles-2",
                "11.5.3 Table 40",
                "SDcycles is loaded with 2 instead of 3 at the start and after a fault.",
            ),
            Mutant::DTimeoutNeverCleared => (
                "d-timeout-never-cleared",
                "11.5.3 Table 40",
                "Once set, DTimeout stays set in every later answer until power-off.",
            ),
            Mutant::PdoutLiveDuringSdCycles => (
                "pdout-live-during-sd-cycles",
                "11.5.3 Table 40",
                "Received process data reach the technology while SDcycles is still running down.",
            ),
            Mutant::WatchdogDoubled => ("watchdog-doubled", "11.5.5", "DTimer expires only after twice FSP_Watchdog."),
            Mutant::DCommErrNeverReported => {
                ("d-comm-err-never-reported", "11.5.3 Table 40", "The bit DCommErr is never set in an answer.")
            }
            Mutant::SetSdIgnored => (
                "set-sd-ignored",
                "11.5.3 Table 40 T22",
                "A received setSD neither sets setSD_DC nor keeps process data from the technology.",
            ),
        }
    }
}

impl fmt::Display for Mutant {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}
