//! The faults the reference FS-Master can be given on purpose, to prove that the suites find them. Each is a small switch at
//! the spot it concerns; this file only lists them.

use crate::catalogue::catalogue;

catalogue! {
    /// One deliberate fault of the reference FS-Master.
    pub enum MasterMutant {
        RestartWithoutAcknowledgment "restart-without-acknowledgment", "11.5.2 Table 38 T13":
            "After a fault the first good answer leads back to regular operation without any acknowledgment."
        AcknowledgmentAsLevel "acknowledgment-as-level", "11.5.2 Table 38 T13":
            "ChFAck_C at 1 acknowledges although no change from 0 to 1 was seen."
        McountNotReset "mcount-not-reset", "11.5.2 Table 38 T8":
            "After a timeout MCount goes on counting instead of being 0."
        MTimerRestartedByRepetitions "m-timer-restarted-by-repetitions", "11.5.5":
            "Every SPDU received restarts MTimer, repetitions and ignored ones included."
        PlainPortNumAccepted "plain-port-num-accepted", "11.5.2 Table 38":
            "An answer with PortNum not inverted is taken as good."
        DTimeoutIgnored "d-timeout-ignored", "11.5.2 Table 38 T7":
            "DTimeout reported by the FS-Device is not treated as a fault."
        PdinLiveWhileSdset "pdin-live-while-sdset", "11.3.2 Table 28":
            "PDin_M carries process data while SDset_S is 1."
        QualifierReleasedEarly "qualifier-released-early", "11.11.4 Table 42":
            "The qualifier is GOOD from the first good answer after a fault on, before the acknowledgment."
        ChFAckReqEarly "ch-f-ack-req-early", "11.5.2 Table 38 T7":
            "ChFAckReq is 1 already in the first SPDU after a fault, before a good answer has come."
        Counter7To0 "counter-7-to-0", "11.4.6":
            "MCount wraps from 7 to 0 instead of 1."
        RecordAfterOperate "record-after-operate", "10.4.3.6":
            "The verify record is written in OPERATE instead of PREOPERATE."
        WrongArgBlockOffset "wrong-arg-block-offset", "10.3.4":
            "In iec2022 the verify record is taken from the offset it has in the FSPortConfigList of v1.1."
    }
}
