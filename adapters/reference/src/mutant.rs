//! The faults the reference FS-Device can be given on purpose, to prove that the suites find them. Each is a small
//! switch at the spot it concerns; this file only lists them.

use crate::catalogue::catalogue;

catalogue! {
    /// One deliberate fault of the reference FS-Device.
    pub enum Mutant {
        WrongSeed "wrong-seed", "11.4.7, D.3.6":
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

        // The SPDU: signature, process data, port number
        ZeroKeptCrc32 "zero-kept-crc32", "11.4.7":
            "With CRC-32 alone a computed signature of 0 is sent and expected as 0."
        ZeroReceivedTaken "zero-received-taken", "11.4.7":
            "A received signature of 0 is taken where 0 is computed."
        Crc32HalfCompared "crc32-half-compared", "11.4.7":
            "Of a received CRC-32 the last two octets alone are compared."
        Crc16OctetsSwapped "crc16-octets-swapped", "11.4.3":
            "A CRC-16 is sent least significant octet first."
        ControlBeforePort "control-before-port", "11.4.7, D.3.7":
            "The counter octet goes into the signature before PortNum."
        SignatureUncheckedWithoutData "signature-unchecked-without-data", "11.4.7":
            "Without FS-PDout the signature of an SPDU is not checked."
        SignatureUncheckedAfterFault "signature-unchecked-after-fault", "11.5.3 Table 40 T29":
            "In state 27 the signature is not checked."
        PdoutTailLost "pdout-tail-lost", "11.4.4":
            "The last octet of PDout_D is 0 when FS-PDout has the greatest length of its mode."
        PdoutReversed "pdout-reversed", "11.4.3":
            "PDout_D is handed over last octet first."
        PdinReversed "pdin-reversed", "11.4.3":
            "FS-PDin is sent last octet first."
        PdinTailLost "pdin-tail-lost", "11.4.4":
            "The last octet of PDin_D is sent as 0 when FS-PDin has the greatest length of its mode."
        PdinLate "pdin-late", "11.5.3 Table 40 T22":
            "An answer carries the PDin_D that stood when the answer before it was made."
        CounterAloneChecked "counter-alone-checked", "11.5.6.8":
            "In regular operation the counter of an SPDU is checked, its signature and PortNum are not."
        PortUnchecked "port-unchecked", "11.5.3 Table 40 T25, 11.4.5":
            "PortNum of a received SPDU is not compared."
        PortInvertedTaken "port-inverted-taken", "11.5.6.10":
            "The inverse of FSP_Port is taken as well."
        PortUncheckedAfterFault "port-unchecked-after-fault", "11.5.3 Table 40 T29":
            "In state 27 PortNum is not compared."

        // Status&DCnt
        ErrorBitsSwapped "error-bits-swapped", "11.4.6 Table 32":
            "DCommErr and DTimeout are in each other's place."
        SdSetInBit3 "sd-set-in-bit-3", "11.4.6 Table 32":
            "SDset is sent in the reserved bit 3 instead of bit 2."
        ReservedBitsSet "reserved-bits-set", "11.4.6 Table 32":
            "The reserved bits 4 and 3 are sent as 1."
        DCountPlain "d-count-plain", "11.4.6 Table 33":
            "DCount_i is MCount itself instead of its inverse."
        DCountOffByOne "d-count-off-by-one", "11.4.6 Table 33":
            "DCount_i is 8 - MCount instead of 7 - MCount."
        DCountBitsReversed "d-count-bits-reversed", "11.4.6 Table 32":
            "The three bits of DCount_i are sent in reversed order."

        // Control&MCnt
        ControlBitsSwapped "control-bits-swapped", "11.5.3 Table 40 T22, 11.4.6 Table 31":
            "setSD and ChFAckReq are read in each other's place."
        AckReqIgnored "ack-req-ignored", "11.3.3 Table 29":
            "ChFAckReq_DC is never set."
        AckReqLatched "ack-req-latched", "11.3.3 Table 29":
            "ChFAckReq_DC stays set until power-off."
        AckReqInOperationOnly "ack-req-in-operation-only", "11.5.3 Table 40":
            "In state 27 ChFAckReq is not looked at."
        AckReqAsSetSd "ack-req-as-set-sd", "11.5.3 Table 40 T22, 11.11.2":
            "A received ChFAckReq has the effect of setSD as well."
        SetSdKeepsPdout "set-sd-keeps-pdout", "11.5.3 Table 40 T22":
            "A received setSD sets setSD_DC, but process data go on to the technology."
        SetSdDcMissing "set-sd-dc-missing", "11.3.3 Table 29":
            "A received setSD brings SDout without setSD_DC."
        SetSdLatched "set-sd-latched", "11.5.3 Table 40 T22":
            "A received setSD is in force until the next fault."
        SetSdLoadsSdCycles "set-sd-loads-sd-cycles", "11.5.3 Table 40 T22":
            "A received setSD loads SDcycles."

        // Which SPDUs are taken
        SkipTaken "skip-taken", "11.5.3 Table 40 T25":
            "One SPDU may be missing: MCount + 2 is taken as well."
        ZeroRefused "zero-refused", "11.5.3 Table 40":
            "MCount 0 is taken in the first SPDU alone."
        ZeroReloadsSdCycles "zero-reloads-sd-cycles", "11.5.3 Table 40 T22":
            "MCount 0 in operation loads SDcycles."
        ExactlyOne "A09-exactly-one", "11.5.3 Table 40 T24, T27":
            "An SPDU whose MCount is not the next one is left alone, MCount 0 included."
        WrapToZero "wrap-to-zero", "11.4.6":
            "After MCount 7 only 0 is taken."
        FirstCounterAny "first-counter-any", "11.5.3 Table 40 T21":
            "The first SPDU may carry any MCount."
        FirstCounterOne "first-counter-one" or "A31-one-first", "11.5.3 Table 40 T21, iec2022":
            "The first SPDU may carry MCount 1."
        FirstSpduUnchecked "first-spdu-unchecked", "11.5.3 Table 40 T21":
            "The first SPDU is taken without a check."
        PreviousIsLastGood "previous-is-last-good" or "A08-last-valid", "11.5.3 Table 40":
            "The counter of an SPDU with CommErr does not become the previous one."
        OldTakenInOperation "old-taken-in-operation", "11.5.3 Table 40 T24":
            "An SPDU with the previous counter is checked instead of ignored."
        OldTakenAfterFault "old-taken-after-fault", "11.5.3 Table 40 T27":
            "After a fault an SPDU with the previous counter is checked instead of ignored."
        ZeroOldAfterTimeout "zero-old-after-timeout", "11.5.3 Table 40 T27":
            "While DTimeout is reported MCount 0 is left alone, and an FS-Master that starts anew is never answered."
        OldCountsSdCycle "old-counts-sd-cycle", "11.5.3 Table 40 T27":
            "Repetitions of an SPDU after a fault run SDcycles down."
        OldChangesPdout "old-changes-pdout", "11.5.3 Table 40 T24":
            "An SPDU with the previous counter hands its process data over."
        OldChangesPdin "old-changes-pdin", "11.5.3 Table 40 T24":
            "An SPDU with the previous counter is answered anew, with the PDin_D of now."
        AllZeroFirst "all-zero-first", "11.5.3 Table 40":
            "An SPDU of all zeros is checked as the first one."
        AllZeroInOperation "all-zero-in-operation", "11.5.3 Table 40":
            "An SPDU of all zeros is checked in regular operation."
        AllZeroAfterFault "all-zero-after-fault", "11.5.3 Table 40":
            "An SPDU of all zeros is checked after a fault."

        // Start
        SdCycles4 "sd-cycles-4", "11.5.3 Table 40":
            "SDcycles is loaded with 4 instead of 3."
        SdCyclesStartAt0 "sd-cycles-start-at-0", "11.5.3 Table 40":
            "SDcycles is 0 at the start."
        CommErrCountStartsAt1 "comm-err-count-starts-at-1", "11.5.3 Table 40":
            "CommErrCount is 1 at the start."
        TimeoutCountStartsAt1 "timeout-count-starts-at-1", "11.5.3 Table 40":
            "TimeoutCount is 1 at the start."
        DTimerRunsFromT20 "d-timer-runs-from-t20", "11.5.3 Table 40 T20":
            "DTimer runs already while the first SPDU is awaited."
        DTimeoutInFirstAnswers "d-timeout-in-first-answers", "11.5.3 Table 40 T22":
            "DTimeout of the start stays until SDcycles has run down."

        // T22 and T23
        T22KeepsDTimer "t22-keeps-d-timer", "11.5.3 Table 40 T22":
            "A good SPDU in regular operation does not restart DTimer."
        T22KeepsSetSdDc "t22-keeps-set-sd-dc", "11.5.3 Table 40 T22":
            "While SDcycles runs down at the start setSD_DC is not set."
        T22KeepsSdSet "t22-keeps-sd-set", "11.5.3 Table 40 T22":
            "While SDcycles runs down at the start SDset is not set."
        FirstSpduStartsNoDTimer "first-spdu-starts-no-d-timer", "11.5.3 Table 40 T22":
            "The first SPDU does not start DTimer, the second does."
        SdSetDsIgnored "sd-set-ds-ignored", "11.5.3 Table 40 T23":
            "SDset_DS does not show in SDset."
        SdSetDsLatched "sd-set-ds-latched", "11.5.3 Table 40 T23":
            "Once SDset_DS was 1 SDset stays 1 until power-off."
        SdSetDsReplaces "sd-set-ds-replaces", "11.5.3 Table 40 T23":
            "SDset of a regular answer is SDset_DS alone."
        SdSetDsAsFault "sd-set-ds-as-fault", "11.5.3 Table 40 T23":
            "SDset_DS keeps process data from the technology."

        // T25 and T26
        T25KeepsPdout "t25-keeps-pdout", "11.5.3 Table 40 T25":
            "A CommErr leaves the process data of before with the technology."
        T25KeepsSetSdDc "t25-keeps-set-sd-dc", "11.5.3 Table 40 T25":
            "A CommErr does not set setSD_DC."
        T25KeepsSdSet "t25-keeps-sd-set", "11.5.3 Table 40 T25":
            "A CommErr does not set SDset."
        T25KeepsDCommErr "t25-keeps-d-comm-err", "11.5.3 Table 40 T25":
            "A CommErr is reported one answer late."
        T25KeepsCommErrCount "t25-keeps-comm-err-count", "11.5.3 Table 40 T25":
            "A CommErr is reported in one answer alone."
        T25KeepsDCount "t25-keeps-d-count", "11.5.3 Table 40 T25":
            "The answer to a CommErr carries DCount_i of before."
        T25KeepsSdCycles "t25-keeps-sd-cycles", "11.5.3 Table 40 T25":
            "A CommErr does not load SDcycles."
        T25KeepsDTimer "t25-keeps-d-timer", "11.5.3 Table 40 T25":
            "A CommErr does not restart DTimer."
        T25StopsDTimer "t25-stops-d-timer", "11.5.3 Table 40 T25":
            "A CommErr stops DTimer."
        T26ReturnsTo24 "t26-returns-to-24", "11.5.3 Table 40 T26":
            "After the answer to a CommErr the machine is back in regular operation."

        // T28 and T29
        T28PdoutLive "t28-pdout-live", "11.5.3 Table 40 T28":
            "The fourth good SPDU after a fault hands its process data over."
        T28OneEarly "t28-one-early", "11.5.3 Table 40 T28":
            "After a fault the third good SPDU ends it already."
        T28IgnoresCommErr "t28-ignores-comm-err", "11.5.3 Table 40 T28":
            "With SDcycles 0 in state 27 an SPDU with CommErr ends the fault."
        T28ReturnsTo26 "t28-returns-to-26", "11.5.3 Table 40 T28":
            "The end of a fault leads back to waiting after a fault."
        T28KeepsSdSet "t28-keeps-sd-set", "11.5.3 Table 40 T28":
            "The end of a fault does not clear SDset."
        T28KeepsDCount "t28-keeps-d-count", "11.5.3 Table 40 T28":
            "The answer at the end of a fault carries DCount_i of before."
        T28KeepsDTimer "t28-keeps-d-timer", "11.5.3 Table 40 T28":
            "The end of a fault does not restart DTimer."
        T29IgnoresCommErr "t29-ignores-comm-err", "11.5.3 Table 40 T29":
            "A CommErr while SDcycles runs down is not seen."
        T29KeepsCommErrCount "t29-keeps-comm-err-count", "11.5.3 Table 40 T29":
            "DCommErr is reported until the fault has ended."
        T29KeepsTimeoutCount "t29-keeps-timeout-count", "11.5.3 Table 40 T29":
            "DTimeout is reported until the fault has ended."
        T29ClearsSetSdDc "t29-clears-set-sd-dc", "11.5.3 Table 40 T29":
            "While SDcycles runs down after a fault setSD_DC is cleared."
        T29KeepsDCommErr "t29-keeps-d-comm-err", "11.5.3 Table 40 T29":
            "A CommErr while a fault is worked off does not set DCommErr in its own answer."
        Sequential "A19-sequential", "11.5.3 Table 40 T29":
            "A CommErr while a fault is worked off uses CommErrCount and TimeoutCount up at once."
        T29KeepsDCount "t29-keeps-d-count", "11.5.3 Table 40 T29":
            "Answers after a fault carry DCount_i of before."
        T29KeepsSdCycles "t29-keeps-sd-cycles", "11.5.3 Table 40 T29":
            "A CommErr while a fault is worked off does not load SDcycles."
        T29KeepsDTimer "t29-keeps-d-timer", "11.5.3 Table 40 T29":
            "SPDUs after a fault do not restart DTimer."

        // T30, T31 and DTimer
        T30Missing "t30-missing", "11.5.3 Table 40 T30":
            "After a fault an expiry of DTimer is not seen."
        T30KeepsDTimeout "t30-keeps-d-timeout", "11.5.3 Table 40 T30":
            "An expiry after a fault does not set DTimeout in the answer that stands."
        T30KeepsTimeoutCount "t30-keeps-timeout-count", "11.5.3 Table 40 T30":
            "DTimeout of an expiry after a fault is gone with the next SPDU."
        T30KeepsSdCycles "t30-keeps-sd-cycles", "11.5.3 Table 40 T30":
            "An expiry after a fault does not load SDcycles."
        T31Missing "t31-missing", "11.5.3 Table 40 T31":
            "In regular operation an expiry of DTimer is not seen."
        T31KeepsPdout "t31-keeps-pdout", "11.5.3 Table 40 T31":
            "An expiry leaves the process data of before with the technology."
        T31KeepsSetSdDc "t31-keeps-set-sd-dc", "11.5.3 Table 40 T31":
            "An expiry does not set setSD_DC."
        T31KeepsSdSet "t31-keeps-sd-set", "11.5.3 Table 40 T31":
            "An expiry does not set SDset."
        T31KeepsDTimeout "t31-keeps-d-timeout", "11.5.3 Table 40 T31":
            "An expiry is reported one answer late."
        T31KeepsTimeoutCount "t31-keeps-timeout-count", "11.5.3 Table 40 T31":
            "DTimeout of an expiry is gone with the next SPDU."
        T31KeepsSdCycles "t31-keeps-sd-cycles", "11.5.3 Table 40 T31":
            "An expiry does not load SDcycles."
        TimeoutResetsDCount "timeout-resets-d-count", "11.5.3 Table 40 T31":
            "An expiry sets DCount_i to 7."
        TimeoutForgetsCounter "timeout-forgets-counter", "11.5.3 Table 40 T31":
            "After an expiry MCount has to start from 0 again."
        OldRestartsDTimer "old-restarts-d-timer", "11.5.3 Table 40 T24":
            "Repetitions of an SPDU restart DTimer."
        AllZeroRestartsDTimer "all-zero-restarts-d-timer", "11.5.3 Table 40":
            "An SPDU of all zeros restarts DTimer."
        WatchdogEarly "watchdog-early", "11.5.5":
            "DTimer expires one millisecond early."
        WatchdogOneCycleLate "watchdog-1-cycle-late", "11.5.5":
            "DTimer expires one millisecond late."
        WatchdogLate "watchdog-late", "11.5.5":
            "DTimer expires five milliseconds late."
        WatchdogOctetsSwapped "watchdog-octets-swapped", "11.5.5, A.2.6":
            "FSP_Watchdog is read least significant octet first."
        WatchdogOfFactory "watchdog-of-factory", "11.5.5, 11.7.6":
            "DTimer runs with the default of FSP_Watchdog, whatever the record says."

        // Power, FSP parameters, verify record
        PdoutAtPowerOn "pdout-at-power-on", "11.5.3 Table 40":
            "At power-on PDout_D is what it was at power-off."
        StartsAtPowerOn "starts-at-power-on", "11.5.3 Table 40 T20, A.2.10":
            "The SCL starts at power-on, without FSP_VerifyRecord."
        StartsOnProtocol "starts-on-protocol", "A.2.10":
            "The SCL starts once the protocol block was written."
        SclSurvivesPowerOff "scl-survives-power-off", "11.5.3 Table 40":
            "After a power cycle the SCL goes on where it was."
        BlocksLostAtPowerOff "blocks-lost-at-power-off", "11.7.6":
            "Stored authenticity and protocol block are those of the factory after a power cycle."
        DeviationStarts "deviation-starts", "11.5.7":
            "A deviating FSP_VerifyRecord raises its Event, and the SCL starts all the same."
        Authenticity1Unverified "authenticity-1-unverified", "A.2.1":
            "FSP_Authenticity_1 of the record is not compared."
        Authenticity2Unverified "authenticity-2-unverified", "A.2.1":
            "FSP_Authenticity_2 of the record is not compared."
        PortUnverified "port-unverified", "A.2.2":
            "FSP_Port of the record is not compared."
        AuthentCrcUnverified "authent-crc-unverified", "A.2.3":
            "FSP_AuthentCRC of the record is not checked."
        ProtParCrcUnverified "prot-par-crc-unverified", "A.2.9":
            "FSP_ProtParCRC of the record is not checked."
        VersionUnverified "version-unverified", "A.2.4":
            "FSP_ProtVersion of the record is not compared."
        ModeUnverified "mode-unverified", "A.2.5":
            "FSP_ProtMode of the record is not compared."
        WatchdogUnverified "watchdog-unverified", "A.2.6":
            "FSP_Watchdog of the record is used without a check."
        IoStructCrcUnverified "io-struct-crc-unverified", "A.2.10, A.2.7":
            "FSP_IO_StructCRC of the record is not compared."
        TechParCrcUnverified "tech-par-crc-unverified", "A.2.10, A.2.8":
            "FSP_TechParCRC of the record is not compared."
        CrcEventsSwapped "crc-events-swapped", "A.2.3, B.1 Table B.1":
            "The EventCodes for a wrong FSP_AuthentCRC and FSP_ProtParCRC are in each other's place."
        RecordReadable "record-readable", "A.1 Table A.1":
            "FSP_VerifyRecord can be read."
        RecordBySubindex "record-by-subindex", "A.2.10":
            "A write to a Subindex of FSP_VerifyRecord is taken."
        ParamDescCrcOfOtherEdition "param-desc-crc-of-other-edition", "A.1 Table A.1":
            "FSP_ParamDescCRC has the length of the other edition."
        ProtocolReadShort "protocol-read-short", "A.1 Table A.1":
            "The protocol block is read without its signature."
        TimeToReadyWritable "time-to-ready-writable", "A.1 Table A.1, iec2022":
            "FSP_TimeToReady can be written."
        StructureCountsOctets "structure-counts-octets", "A.2.7 Table A.4":
            "FSP_IO_StructCRC is held and checked over the number of octets in the place of TotalOfInBits."
        StructureCountsPadding "structure-counts-padding", "A.2.7 Table A.4":
            "FSP_IO_StructCRC is held and checked with the padding bits counted as Booleans."
        StructureTypesSwapped "structure-types-swapped", "A.2.7 Table A.4":
            "FSP_IO_StructCRC is held and checked with TotalOfInBits and TotalOfInInt16 in each other's place."
        PaddingNotZero "padding-not-zero", "C.2":
            "The padding bits of FS-PDin are sent as 1."
        AuthenticityReadReversed "authenticity-read-reversed", "A.1 Table A.1":
            "FSP_Authenticity_1 is read back least significant octet first."

        RecordOf24Octets "record-of-24-octets", "A.2.10":
            "An FSP_VerifyRecord with an octet too many is taken."
        RecordBitUnchecked "record-bit-unchecked", "11.5.7":
            "The least significant bit of FSP_AuthentCRC in the record is not compared."
        TestModeTakesAll "tech-par-crc-0-in-record-taken", "G.2":
            "A record with FSP_TechParCRC 0 starts the SCL whatever FSP_TechParCRC is stored."
        AuthenticityEventOfPort "authenticity-event-of-port", "B.1 Table B.1":
            "Another authenticity raises the EventCode of another port."
        EventsAsWarnings "events-as-warnings", "B.1 Table B.1":
            "Events at start-up are Warnings instead of Errors."
        WcdtWritable "wcdt-writable", "A.1 Table A.1, iec2022":
            "FSP_WCDT can be written."
        OfdtMissing "ofdt-missing", "A.1 Table A.1, iec2022":
            "There is no FSP_OFDT."
        MinShutDownTimeShort "min-shut-down-time-short", "A.1 Table A.1, iec2022":
            "FSP_MinShutDownTime is 500 ms."
        PasswordReadable "password-readable", "A.1 Table A.1, v1.1":
            "FS_Password can be read."
        ProfileMissing "profile-missing", "E.3.4":
            "ProfileCharacteristic does not name IO-Link Safety."
        AccessLocked "access-locked", "9.4.1":
            "Device Access Lock has bit 1 set."
        FactoryTechParCrc0 "factory-tech-par-crc-0", "G.1 Table G.1":
            "FSP_TechParCRC is 0 in the factory setting."
        ResetWhenArmed "reset-when-armed", "E.3.3, v1.1 E.3.2":
            "Reset commands are obeyed by an armed device."
        ResetKeepsAuthenticity "reset-keeps-authenticity", "E.3.3, v1.1 E.3.2":
            "The way back to the factory setting leaves the authenticity."
        ApplicationResetForgets "application-reset-forgets", "E.3.3, iec2022":
            "An application reset resets authenticity and protocol parameters."
        RestoreFactoryTaken "restore-factory-taken", "E.3.3, iec2022":
            "Restore factory settings of v1.1 is implemented."
        TechnologyUnverified "technology-unverified", "11.7.8, 10.4.3.1":
            "FSP_TechParCRC is compared with the stored value, not with the technology parameters it stands for."
        TechnologyForgotten "technology-forgotten", "10.4.3.1":
            "A technology parameter is answered as written and stays as it was."
        OssdeWithAlteredTechnology "ossde-with-altered-technology", "G.1 Table G.1":
            "OSSDe operation begins with technology parameters that FSP_TechParCRC was not made for."
        DownloadAdoptedInUse "download-adopted-in-use", "11.7.6":
            "A device in use adopts a Data Storage download."
        DownloadNotAdopted "download-not-adopted", "11.7.6":
            "A device from the factory ignores a Data Storage download."
        DownloadRefusedOtherwise "download-refused-otherwise", "9.4.1, iec2022":
            "The start of a download is refused with 0x8036 instead of 0x8022."

        // Lines without communication
        ReadyPulseShort "ready-pulse-499-us", "5.4":
            "The Ready pulse is 499 us wide."
        ReadyPulseLong "ready-pulse-1001-us", "5.4":
            "The Ready pulse is 1001 us wide."
        ReadyPulseLate "ready-pulse-after-5-s", "5.4":
            "The Ready pulse comes 5.001 s after power-on."
        ReadyPulseOnBothPins "ready-pulse-on-pin-2", "5.3.3":
            "The Ready pulse comes on I/Q as well."
        NoReadyPulse "no-ready-pulse", "7.3":
            "There is no Ready pulse."
        SecondReadyPulse "second-ready-pulse", "7.3":
            "A short second pulse follows the Ready pulse."
        OnInSelfTest "on-in-self-test", "5.3.3":
            "I/Q is on for a millisecond in the self-test."
        WakeUpLate "ready-for-wake-up-after-51-us", "5.4":
            "The device is ready for the wake-up 51 us after the Ready pulse."
        OssdeEarly "ossde-early", "5.4":
            "OSSDe operation begins 699 us (v1.1) or 1.0 s (iec2022) after the Ready pulse."
        OssdeNever "ossde-never", "5.3.3":
            "Without a wake-up there is no OSSDe operation."
        TestPulseLong "test-pulse-1001-us", "5.4":
            "A test pulse is 1001 us wide."
        TestPulsesDense "test-pulses-dense", "5.4":
            "Test pulses come every 9.9 ms (v1.1), or take more than a hundredth of their period (iec2022)."
        DiscrepancyLong "discrepancy-long", "5.4":
            "I/Q follows C/Q 3.001 ms (v1.1) or 1.001 ms (iec2022) later."
        DemandOnOneLine "demand-on-one-line", "5.3.3":
            "A demand switches C/Q alone."
        ShutDownLong "shut-down-long", "7.3":
            "After a power-off of less than 2 s there is no Ready pulse."
    }
}
