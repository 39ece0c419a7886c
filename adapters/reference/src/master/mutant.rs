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
        FirstSpduWithoutSetSd "first-spdu-without-set-sd", "11.5.2 Table 38 T1":
            "setSD is 0 in the first SPDU."
        FirstMcount1 "first-mcount-1", "11.5.2 Table 38 T1":
            "The first SPDU carries MCount 1 instead of 0."
        MTimerFromStart "m-timer-from-start", "11.5.2 Table 38 T2":
            "MTimer runs while the first answer is waited for."
        AllZeroFirstAnswerChecked "all-zero-first-answer-checked", "11.5.2 Table 38 T3":
            "An answer of all zeros is checked in state 2 instead of being ignored."
        McountStandsWhileSdset "mcount-stands-while-sdset", "11.5.2 Table 38 T4":
            "MCount is not incremented while the answers carry SDset."
        SdsetIsFault "sdset-is-fault", "11.5.2 Table 38 T4":
            "SDset alone counts as a fault of the FS-Device."
        SdsetInOperationIsFault "sdset-in-operation-is-fault", "11.5.2 Table 38 T4":
            "SDset is let pass at the start, and counts as a fault once process data have been passed on."
        MTimerStartedOnce "m-timer-started-once", "11.5.2 Table 38 T5":
            "A new regular SPDU does not restart an MTimer that runs already."
        AllZeroAnswerChecked "all-zero-answer-checked", "11.5.2 Table 38 T6":
            "An answer of all zeros is checked in state 5 instead of being ignored."
        OldCounterChecked "old-counter-checked", "11.5.2 Table 38 T6":
            "An answer with the previous counter is checked instead of being left alone."
        RepeatedDataPassedOn "repeated-data-passed-on", "11.5.2 Table 38 T6":
            "The process data of an answer that is left alone, for its counter is the previous one, reach PDin_M."
        ForeignCounterWaitedOut "foreign-counter-waited-out", "11.5.2 Table 38 T6":
            "In state 5 a counter that is neither old nor mirrored is ignored instead of being a fault."
        FaultKeepsMcount "fault-keeps-mcount", "11.5.2 Table 38 T7":
            "MCount stays as it is at a fault."
        FaultResetsMcount "fault-resets-mcount", "11.5.2 Table 38 T7":
            "A fault sets MCount to 0 as a timeout does."
        FaultKeepsPdin "fault-keeps-pdin", "11.5.2 Table 38 T7":
            "PDin_M keeps its process data at a fault."
        SetSdMissingAfterFault "set-sd-missing-after-fault", "11.5.2 Table 38 T7":
            "setSD is 0 in the first SPDU after a fault."
        DCommErrIgnored "d-comm-err-ignored", "11.5.2 Table 38 T7":
            "DCommErr reported by the FS-Device is not treated as a fault."
        DCommErrNeedsSdset "d-comm-err-needs-sdset", "11.5.2 Table 38 T7":
            "DCommErr is a fault only if SDset is 1 too."
        TimeoutKeepsPdin "timeout-keeps-pdin", "11.5.2 Table 38 T8":
            "PDin_M keeps its process data at a timeout."
        ExceptionalSpduWithData "exceptional-spdu-with-data", "11.5.2 Table 38 T9":
            "The exceptional SPDU repeats the process data of the SPDU before."
        ExceptionalSpduCountsOn "exceptional-spdu-counts-on", "11.5.2 Table 38 T9":
            "Each exchange without an answer sends the exceptional SPDU with the next MCount instead of the same one."
        MTimerStoppedAfterFault "m-timer-stopped-after-fault", "11.5.2 Table 38 T9":
            "An exceptional SPDU stops MTimer."
        OnlyNewCounterAfterFault "only-new-counter-after-fault", "11.5.2 Table 38 T10":
            "In state 7 the mirrored answer is ignored if its counter is the previous one."
        NotOld "A06-not-old", "11.5.2 Table 38 T10":
            "In state 7 any answer is checked whose counter is not the previous one, and none with the previous one."
        AcknowledgmentResetsMcount "acknowledgment-resets-mcount", "11.5.2 Table 38 T11":
            "The acknowledgment sets MCount to 1 instead of incrementing it."
        ArmedAfterAcknowledgment "armed-after-acknowledgment", "11.5.2 Table 38 T11":
            "ChFAck_C_e stays 1 after an acknowledgment."
        AskedAfterAcknowledgment "asked-after-acknowledgment", "11.5.2 Table 38 T11":
            "ChFAckReq stays 1 after an acknowledgment."
        PressInOperationKept "press-in-operation-kept", "11.5.2 Table 38 T11":
            "ChFAck_C at 1 in regular operation is kept, and acknowledges the next fault."
        ArmedAfterFault "armed-after-fault", "11.5.2 Table 38 T12":
            "ChFAck_C_e stays 1 at a fault in state 8."
        AskedAfterFault "asked-after-fault", "11.5.2 Table 38 T12":
            "ChFAckReq stays 1 at a fault in state 8."
        ChFAckReqBlinks "ch-f-ack-req-blinks", "11.5.2 Table 38 T13":
            "ChFAckReq is inverted by each good answer instead of being set."
        AcknowledgmentOnFallingEdge "acknowledgment-on-falling-edge", "11.5.2 Table 38 T13":
            "The change of ChFAck_C from 1 to 0 acknowledges."
        SetSdMissingWhileAsked "set-sd-missing-while-asked", "11.5.2 Table 38 T13":
            "setSD is 0 while the acknowledgment is asked for."
        ArmedAfterTimeout "armed-after-timeout", "11.5.2 Table 38 T14":
            "ChFAck_C_e stays 1 at a timeout in state 7."
        AskedAfterTimeout "asked-after-timeout", "11.5.2 Table 38 T14":
            "ChFAckReq stays 1 at a timeout in state 7."
        SetSdAndChFAckReqSwapped "set-sd-and-ch-f-ack-req-swapped", "11.4.6 Table 31":
            "setSD and ChFAckReq stand at each other's bit."
        McountBitsReversed "mcount-bits-reversed", "11.4.6 Table 31":
            "The three bits of MCount stand in reverse order."
        ReservedBitSent "reserved-bit-sent", "11.4.6":
            "Bit 2 of Control&MCnt, reserved, is sent as 1."
        DcountNotInverted "dcount-not-inverted", "11.5.2 Table 38":
            "DCount_i is compared with MCount instead of its inverse."
        CounterNotChecked "counter-not-checked", "11.5.2 Table 38 T7":
            "An answer to another SPDU is taken as good."
        PortNumInvertedSent "port-num-inverted-sent", "11.4.5":
            "The SPDU carries PortNum inverted."
        PortNumAlways1 "port-num-always-1", "11.4.5":
            "The SPDU of every port carries PortNum 1."
        PortNumNotChecked "port-num-not-checked", "11.5.2 Table 38 T7":
            "PortNum of the answer is not looked at."
        PortNumLowBits "port-num-low-bits", "11.5.2 Table 38 T7":
            "Only the low four bits of PortNum are compared."
        SignatureSeed0 "signature-seed-0", "11.4.7":
            "The signature starts with 0 instead of the seed."
        ZeroSignatureKept "zero-signature-kept", "11.4.7":
            "A computed signature of 0 is not replaced by 1."
        SignatureOctetsSwapped "signature-octets-swapped", "11.4.7":
            "The signature of the CRC-16 mode stands low octet first."
        SignatureLow16Bits "signature-low-16bits", "11.4.7":
            "In the CRC-32 mode only the low 16 bits of the signature are compared."
        LongestPdUnchecked "longest-pd-unchecked", "11.4.7":
            "The signature is not checked where the process data have their greatest length."
        PdinCutAt16 "pdin-cut-at-16", "11.4.4":
            "Of PDin_M only the first 16 octets are delivered, the others stay 0."
        PdinOfPdoutLength "pdin-of-pdout-length", "11.4.4":
            "PDin_M is delivered with as many octets as PDout_M has."
        ReservedBitsUnsigned "reserved-bits-unsigned", "11.4.3":
            "The signature of an answer is calculated over the Status&DCnt octet with its reserved bits 0."
        WatchdogEarly "watchdog-early", "11.5.5":
            "MTimer expires after three quarters of FSP_Watchdog."
        WatchdogLate "watchdog-late", "11.5.5":
            "MTimer expires a quarter of FSP_Watchdog late."
        WatchdogOctetsSwapped "watchdog-octets-swapped", "11.5.5":
            "The two octets of FSP_Watchdog are swapped."
        SdsetIgnored "sdset-ignored", "11.3.2 Table 28":
            "SDset of the answer neither makes PDin_M safe nor shows in SDset_S."
        SdsetNotReported "sdset-not-reported", "11.3.2 Table 28":
            "SDset_S stays 0 while SDset keeps PDin_M safe."
        SetSdBitMissing "set-sd-bit-missing", "11.3.2 Table 28":
            "setSD_C forces safe data without setting setSD."
        PdoutLiveWhileSetSd "pdout-live-while-set-sd", "11.3.2 Table 28":
            "PDout carries process data while setSD_C is 1."
        PdoutReversed "pdout-reversed", "11.3.2 Table 28":
            "The octets of PDout_M are sent in reverse order."
        ChFAckReqSMissing "ch-f-ack-req-s-missing", "11.3.2 Table 28":
            "ChFAckReq_S is never 1."
        ChFAckReqBitMissing "ch-f-ack-req-bit-missing", "11.5.2 Table 38 T13":
            "The bit ChFAckReq is never 1."
        QualifierGoodAtStart "qualifier-good-at-start", "11.11.4 Table 42":
            "The qualifier is GOOD from the start of the SCL on, before any answer."
        QualifierIgnoresSdset "qualifier-ignores-sdset", "11.11.4 Table 42":
            "SDset_S does not make the qualifier BAD."
        RecordMissing "record-missing", "10.4.3.6":
            "No verify record is sent."
        RecordAtFirstStartOnly "record-at-first-start-only", "10.4.3.6":
            "The verify record is sent at the first start after a configuration only."
        RecordInStartup "record-in-startup", "10.4.3.6":
            "The verify record is sent in STARTUP, PREOPERATE is passed over."
        RecordToAuthenticity "record-to-authenticity", "10.4.3.6":
            "The verify record is written to index 0x4200."
        RecordAuthenticityZero "record-authenticity-zero", "10.4.3.6":
            "The verify record carries FSP_Authenticity 0."
        RecordPortZero "record-port-zero", "10.4.3.6":
            "The verify record carries FSP_Port 0."
        RecordWatchdogSwapped "record-watchdog-swapped", "10.4.3.6":
            "The verify record carries FSP_Watchdog low octet first."
        RecordTechParCrcZero "record-tech-par-crc-zero", "10.4.3.6":
            "The verify record carries FSP_TechParCRC 0."
        WakeUpBeforeReadyPulse "wake-up-before-ready-pulse", "5.1":
            "The wake-up follows the supply and does not wait for the Ready pulse."
        WakeUpForEver "wake-up-for-ever", "7.2":
            "When nobody answers the wake-up it is repeated without limit."
        WaitsOnPlainPort "waits-on-a-plain-port", "7.2":
            "A port without safety waits for a Ready pulse as well."
        NoSecondSupplyCycle "no-second-supply-cycle", "5.1":
            "A port whose Ready pulse did not come in time is given up for good."
        TimeToReadyTooShort "time-to-ready-too-short", "5.1":
            "The Ready pulse is waited for a tenth of its time."
        ComlostUnnoticed "comlost-unnoticed", "9.1.2":
            "Loss of communication leaves the port in OPERATE."
        SclAnewAfterComlost "scl-anew-after-comlost", "11.5.4.4":
            "The SCL starts anew after loss of communication and wants no acknowledgment."
        VendorIdNotCompared "vendor-id-not-compared", "10.3.4":
            "A Device of another VendorID is taken."
        CycleTimeNotCompared "cycle-time-not-compared", "10.3.3 (v1.1), 10.3.4 (iec2022)":
            "A PortCycleTime below the MinCycleTime of the Device is taken."
        UnknownPortModeIsSafetycom "unknown-port-mode-is-safetycom", "10.3.4":
            "A PortMode that is reserved or not for the edition is taken for SAFETYCOM."
        NsrLimit31 "nsr-limit-31", "10.3.3 (v1.1)":
            "In v1.1 an SPDU and the data without safety relevance beside it may have 31 octets at most."
        ConfigLengthOfOtherEdition "config-length-of-other-edition", "10.3.4":
            "FSPortConfigList is taken with the length it has in the other edition only."
        AuthentCrcNotChecked "authent-crc-not-checked", "B.2":
            "FSP_AuthentCRC is not checked before the start of the SCL."
        ProtParCrcNotChecked "prot-par-crc-not-checked", "B.2":
            "FSP_ProtParCRC is not checked before the start of the SCL."
        Watchdog0Accepted "watchdog-0-accepted", "B.2":
            "The SCL starts with FSP_Watchdog 0."
        Authenticity2NotCompared "authenticity-2-not-compared", "B.2":
            "FSP_Authenticity2 is not compared with the upper-level system."
        ArmedNotCompared "armed-not-compared", "10.4.3.1":
            "The authenticity is compared for commissioning only, not with FSP_TechParCRC other than 0."
        FspPortNotCompared "fsp-port-not-compared", "B.2":
            "In v1.1 FSP_Port is not compared with the number of the port."
        ProtVersionNotChecked "prot-version-not-checked", "11.5.2":
            "The SCL starts with an unknown FSP_ProtVersion."
        VerifyEventMissing "verify-event-missing", "B.2":
            "A deviating parameter keeps the SCL from starting without any Event."
        VerifyEventOfV11 "verify-event-of-v1-1", "B.2":
            "In iec2022 the Events of the verification have the codes of v1.1."
        NsrBeforeSpdu "nsr-before-spdu", "10.5":
            "The data without safety relevance stand before the SPDU."
        FsPdInOutSwapped "fs-pd-in-out-swapped", "10.2.5":
            "SMI_FSPDInOut delivers output before input."
        MasterTypeOfBase "master-type-of-base", "10.2.1":
            "SMI_MasterIdentification says Master instead of FS-Master."
        PortStatusOfPort1 "port-status-of-port-1", "10.2.1":
            "SMI_PortStatus reports port 1 whatever port is asked for."
        SclStatusOperate "scl-status-operate", "10.3.5":
            "PortStatusInfo stays at OPERATE while the SCL runs."
        DeviceEventDropped "device-event-dropped", "10.2.1":
            "Events of the Device are not passed on."
        ReservedEventEvaluated "reserved-event-evaluated", "B.1":
            "An Event of the FS-Device with a reserved code leads the port back to PREOPERATE."
        ReservedEventUsed "reserved-event-used", "B.2":
            "A fault of the SCL is told by an Event with a reserved code."
        DiagNotListed "diag-not-listed", "10.3.5":
            "What is pending is missing in the DiagEntries."
        ArgBlockLengthUnchecked "arg-block-length-unchecked", "10.2.5":
            "In iec2022 the length of an ArgBlock is not checked."
        ArgBlockIdUnchecked "arg-block-id-unchecked", "10.2.5":
            "In iec2022 the ID of an ArgBlock is not checked."
        LengthBeforeArgBlockId "length-before-arg-block-id", "10.2.5":
            "In iec2022 the length of an ArgBlock is checked before its ID."
        ExpectedBlockUnchecked "expected-block-unchecked", "10.2.2":
            "In iec2022 ExpArgBlockID is not checked."
        RefArgBlockIdMissing "ref-arg-block-id-missing", "10.2.5":
            "RefArgBlockID is 0."
        WrongPortToldOtherwise "wrong-port-told-otherwise", "10.2.5":
            "A port that does not exist is told as ARGBLOCK_INCONSISTENT."
        ClientIdNotReturned "client-id-not-returned", "10.2.1":
            "A result carries ClientID 0."
        ResultOfPort1 "result-of-port-1", "10.2.1":
            "A result carries PortNumber 1."
        ArgBlockLengthWithoutId "arg-block-length-without-id", "10.2.1":
            "ArgBlockLength of a result does not count the ArgBlockID."
        AuthenticitySwapped "authenticity-swapped", "10.3.3":
            "The two words of the authenticity stand in reverse order."
        ReadbackOfFactory "readback-of-factory", "10.2.1":
            "SMI_ReadbackPortConfiguration delivers a configuration of zeros."
        SupplyStaysOn "supply-stays-on", "10.2.1":
            "SMI_PortPowerOffOn ends communication and leaves the supply on."
        PowerOffForGood "power-off-for-good", "10.2.1":
            "The supply does not come back by itself after PowerOffTime."
        NoComToldOtherwise "no-com-told-otherwise", "10.2.3":
            "In v1.1 a port without communication is told as OUT_OF_RANGE."
        ErrorInfoOfIec2022 "error-info-of-iec2022", "10.2.2":
            "In v1.1 a Result(-) carries the ErrorTypes of iec2022."
        PowerOffTimeSigned "power-off-time-signed", "10.2.1":
            "A PowerOffTime above 32767 ms is taken for a negative one and refused."
        PowerOffOnOfOtherEdition "power-off-on-of-other-edition", "10.2.1":
            "SMI_PortPowerOffOn knows the ArgBlockID of the other edition only."
        OssdeStartWantsAcknowledgment "ossde-start-wants-acknowledgment", "11.11.5 Table 43 T1":
            "A healthy start of an OSSDe port asks for the acknowledgment."
        OssdeAskedWhileFault "ossde-asked-while-fault", "11.11.5 Table 43 T2":
            "A fault at the start asks for the acknowledgment while it lasts."
        OssdeFaultMissed "ossde-fault-missed", "11.11.5 Table 43 T3":
            "A discrepancy in operation is no fault."
        OssdeRestartByItself "ossde-restart-by-itself", "11.11.5 Table 43 T4":
            "The qualifier is GOOD as soon as the fault has gone."
        OssdeAcknowledgmentAsLevel "ossde-acknowledgment-as-level", "11.11.5 Table 43 T5":
            "AckQ at 1 acknowledges although no change from 0 to 1 was seen."
        OssdeRequestStands "ossde-request-stands", "11.11.5 Table 43 T6":
            "A fault while the acknowledgment is asked for does not withdraw the request."
        OssdeOneLineIsOn "ossde-one-line-is-on", "5.3.2.1":
            "One line high is ON."
        OssdeNoFilter "ossde-no-filter", "5.3.2.1":
            "Test pulses are not filtered."
        OssdeDiscrepancyTooShort "ossde-discrepancy-too-short", "5.4 (v1.1), 5.5 (iec2022)":
            "A skew of 1 ms is a fault already, in v1.1 too."
        RecordBeforeDataStorage "record-before-data-storage", "8":
            "The verify record is sent before Data Storage begins."
        DataStorageFaultIgnored "data-storage-fault-ignored", "8":
            "A Data Storage that the Device fails for good keeps neither the record nor OPERATE from following."
        DataStorageInCommissioning "data-storage-in-commissioning", "G.1":
            "Data Storage works with FSP_TechParCRC 0 as well."
        DataStorageWithoutBackup "data-storage-without-backup", "9.4.3.2 (v1.1)":
            "Data Storage works at levels of Validation&Backup that have no backup."
        UploadAtRestore "upload-at-restore", "9.4.5.5 (v1.1)":
            "With restore alone the upload flag of the Device leads to an upload."
        NothingUploaded "nothing-uploaded", "G.2":
            "The parameters of an armed FS-Device are never uploaded."
        NothingDownloaded "nothing-downloaded", "G.3":
            "A spare FS-Device gets no parameters."
        RefusedDownloadWithoutRecord "refused-download-without-record", "G.4":
            "After a refused download the port goes to OPERATE without the verify record."
        SetKeptForOtherDevice "set-kept-for-other-device", "9.4.5.4 (v1.1)":
            "The set is kept when another VendorID or DeviceID is configured, and downloaded into that Device."
        CommissioningKept "commissioning-kept", "G.1":
            "In iec2022 a configuration with FSP_TechParCRC 0 outlives a power cycle of the FS-Master."
        SclStatusInPreoperate "scl-status-in-preoperate", "10.3.5":
            "PortStatusInfo is that of a running SCL in PREOPERATE already."
    }
}
