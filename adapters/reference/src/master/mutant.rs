//! The faults the reference FS-Master can be given on purpose, to prove that the suites find them. Each is a small switch at
//! the spot it concerns; this file only names them.

use std::fmt;

/// One deliberate fault.
#[derive(Copy, Clone, Debug, PartialEq, Eq, Hash)]
pub enum MasterMutant {
    /// T11 needs no acknowledgment.
    RestartWithoutAcknowledgment,
    /// ChFAck_C acts as a level.
    AcknowledgmentAsLevel,
    /// MCount goes on counting after a timeout.
    McountNotReset,
    /// Any SPDU received restarts MTimer.
    MTimerRestartedByRepetitions,
    /// Answers with FSP_Port itself are taken too.
    PlainPortNumAccepted,
    /// DTimeout of the answer is no fault.
    DTimeoutIgnored,
    /// PDin_M carries process data while SDset_S is 1.
    PdinLiveWhileSdset,
    /// The qualifier is GOOD with the first good answer after a fault.
    QualifierReleasedEarly,
    /// ChFAckReq is 1 in the first SPDU after a fault.
    ChFAckReqEarly,
    /// MCount wraps from 7 to 0.
    Counter7To0,
    /// The verify record is written after OPERATE.
    RecordAfterOperate,
    /// In iec2022 the verify record is taken from the offset of v1.1.
    WrongArgBlockOffset,
}

impl MasterMutant {
    /// All of them.
    pub const ALL: [MasterMutant; 12] = [
        MasterMutant::RestartWithoutAcknowledgment,
        MasterMutant::AcknowledgmentAsLevel,
        MasterMutant::McountNotReset,
        MasterMutant::MTimerRestartedByRepetitions,
        MasterMutant::PlainPortNumAccepted,
        MasterMutant::DTimeoutIgnored,
        MasterMutant::PdinLiveWhileSdset,
        MasterMutant::QualifierReleasedEarly,
        MasterMutant::ChFAckReqEarly,
        MasterMutant::Counter7To0,
        MasterMutant::RecordAfterOperate,
        MasterMutant::WrongArgBlockOffset,
    ];

    /// The name used in addresses: `inproc:reference-master?mutant=NAME`.
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
    pub fn from_name(name: &str) -> Option<MasterMutant> {
        MasterMutant::ALL.into_iter().find(|mutant| mutant.name() == name)
    }

    const fn facts(self) -> (&'static str, &'static str, &'static str) {
        const TABLE: &str = "11.5.2 Table 38";
        match self {
            MasterMutant::RestartWithoutAcknowledgment => (
                "restart-without-acknowledgment",
                "11.5.2 Table 38 T13",
                "After a fault the first good answer leads back to regular operation without any acknowledgment.",
            ),
            MasterMutant::AcknowledgmentAsLevel => (
                "acknowledgment-as-level",
                "11.5.2 Table 38 T13",
                "ChFAck_C at 1 acknowledges although no change from 0 to 1 was seen.",
            ),
            MasterMutant::McountNotReset => (
                "mcount-not-reset",
                "11.5.2 Table 38 T8",
                "After a timeout MCount goes on counting instead of being 0.",
            ),
            MasterMutant::MTimerRestartedByRepetitions => (
                "m-timer-restarted-by-repetitions",
                "11.5.5",
                "Every SPDU received restarts MTimer, repetitions and ignored ones included.",
            ),
            MasterMutant::PlainPortNumAccepted => {
                ("plain-port-num-accepted", TABLE, "An answer with PortNum not inverted is taken as good.")
            }
            MasterMutant::DTimeoutIgnored => (
                "d-timeout-ignored",
                "11.5.2 Table 38 T7",
                "DTimeout reported by the FS-Device is not treated as a fault.",
            ),
            MasterMutant::PdinLiveWhileSdset => {
                ("pdin-live-while-sdset", "11.3.2 Table 28", "PDin_M carries process data while SDset_S is 1.")
            }
            MasterMutant::QualifierReleasedEarly => (
                "qualifier-released-early",
                "11.11.4 Table 42",
                "The qualifier is GOOD from the first good answer after a fault on, before the acknowledgment.",
            ),
            MasterMutant::ChFAckReqEarly => (
                "ch-f-ack-req-early",
                "11.5.2 Table 38 T7",
                "ChFAckReq is 1 already in the first SPDU after a fault, before a good answer has come.",
            ),
            MasterMutant::Counter7To0 => ("counter-7-to-0", "11.4.6", "MCount wraps from 7 to 0 instead of 1."),
            MasterMutant::RecordAfterOperate => {
                ("record-after-operate", "10.4.3.6", "The verify record is written in OPERATE instead of PREOPERATE.")
            }
            MasterMutant::WrongArgBlockOffset => (
                "wrong-arg-block-offset",
                "10.3.4",
                "In iec2022 the verify record is taken from the offset it has in the FSPortConfigList of v1.1.",
            ),
        }
    }
}

impl fmt::Display for MasterMutant {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}
