//! The faults the reference FS-Device can be given on purpose, to prove that the suites find them. Each is a small
//! switch at the spot it concerns; this file only lists them.

use crate::catalogue::catalogue;

catalogue! {
    /// One deliberate fault of the reference FS-Device.
    pub enum Mutant {
        WrongSeed "wrong-seed", "D.3.6":
            "SPDU signatures are computed and checked with the start value 0 instead of 1."
        ZeroNotReplaced "zero-not-replaced", "11.4.7":
            "A computed signature of 0 is sent and expected as 0 instead of 1."
        PortNotInverted "port-not-inverted", "11.4.5":
            "Answers carry FSP_Port instead of its bitwise inverse."
        CounterCheckMissing "counter-check-missing", "11.5.3 Table 40":
            "An SPDU with any MCount other than the previous one is taken as good."
        SdCycles2 "sd-cycles-2", "11.5.3 Table 40":
            "SDcycles is loaded with 2 instead of 3 at the start and after a fault."
        DTimeoutNeverCleared "d-timeout-never-cleared", "11.5.3 Table 40":
            "Once set, DTimeout stays set in every later answer until power-off."
        PdoutLiveDuringSdCycles "pdout-live-during-sd-cycles", "11.5.3 Table 40":
            "Received process data reach the technology while SDcycles is still running down."
        WatchdogDoubled "watchdog-doubled", "11.5.5":
            "DTimer expires only after twice FSP_Watchdog."
        DCommErrNeverReported "d-comm-err-never-reported", "11.5.3 Table 40":
            "The bit DCommErr is never set in an answer."
        SetSdIgnored "set-sd-ignored", "11.5.3 Table 40 T22":
            "A received setSD neither sets setSD_DC nor keeps process data from the technology."
    }
}
