//! What a case expects to see, and where.

use super::{RecordField, Transfer};
use fsct_adapters::{Mode, Role};

/// One thing to be seen.
#[derive(Clone, Debug)]
pub struct Expectation {
    /// Where to look.
    pub key: Key,
    /// What to see.
    pub value: Expected,
    /// The value as written.
    pub text: String,
}

/// Where to look.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Key {
    /// Counter of the answer.
    DcountI,
    /// SDset of the answer.
    SdSet,
    /// DCommErr of the answer.
    DcommErr,
    /// DTimeout of the answer.
    Dtimeout,
    /// Process data of the answer.
    Pdin,
    /// The FS I/O structure the profile declares.
    Structure,
    /// Counter of the SPDU of an FS-Master.
    Mcount,
    /// setSD of the SPDU.
    SetSd,
    /// ChFAckReq of the SPDU.
    ChFAckReq,
    /// Process data of the SPDU.
    Pdout,
    /// PortNum of the SPDU presented.
    PortNum,
    /// The reserved bits of its status or control octet.
    Reserved,
    /// The image as a whole.
    Image,
    /// What follows the SPDU in it.
    Nsr,
    /// Service PDout_D.
    PdoutD,
    /// Service setSD_DC.
    SetSdDc,
    /// Service ChFAckReq_DC.
    ChFAckReqDc,
    /// Service PDin_M.
    PdinM,
    /// Service SDset_S.
    SdsetS,
    /// Service ChFAckReq_S.
    ChFAckReqS,
    /// Service FAULTS_S.
    FaultsS,
    /// Qualifier of the process data.
    Qualifier,
    /// Mode an FS-Master commands.
    Mode,
    /// L+ of a port.
    PortPower,
    /// Level of C/Q.
    Cq,
    /// Level of I/Q.
    Iq,
    /// Wake-up pulses in this step.
    WakeUp,
    /// What was written to 0x4202 in this step.
    Record,
    /// What Data Storage came to in this step.
    DataStorage,
    /// Authenticity and protocol record of the virtual FS-Device.
    Stored,
    /// Answer to a read or write.
    Reply,
    /// Result of an SMI request.
    Result,
    /// RefArgBlockID of the result.
    Reference,
    /// ArgBlockLength of the result.
    Length,
    /// The ArgBlock of the result as a whole.
    Block,
    /// A field of it.
    Field(&'static str),
    /// EventCode seen in this step.
    Event,
    /// Type of the Events seen in this step.
    EventType,
}

const DEVICE: &[Role] = &[Role::Device];
const MASTER: &[Role] = &[Role::Master];
const BOTH: &[Role] = &[Role::Device, Role::Master];

impl Key {
    /// All keys as written in cases, and the side they are for; fields of ArgBlocks are `block.` and their name.
    pub const ALL: [(Key, &'static str, &'static [Role]); 37] = [
        (Key::DcountI, "DCount_i", DEVICE),
        (Key::SdSet, "SDset", DEVICE),
        (Key::DcommErr, "DCommErr", DEVICE),
        (Key::Dtimeout, "DTimeout", DEVICE),
        (Key::Pdin, "PDin", DEVICE),
        (Key::Structure, "FS_IO", DEVICE),
        (Key::Mcount, "MCount", MASTER),
        (Key::SetSd, "setSD", MASTER),
        (Key::ChFAckReq, "ChFAckReq", MASTER),
        (Key::Pdout, "PDout", MASTER),
        (Key::PortNum, "PortNum", BOTH),
        (Key::Reserved, "reserved", BOTH),
        (Key::Image, "image", BOTH),
        (Key::Nsr, "NSR", BOTH),
        (Key::PdoutD, "app.PDout_D", DEVICE),
        (Key::SetSdDc, "app.setSD_DC", DEVICE),
        (Key::ChFAckReqDc, "app.ChFAckReq_DC", DEVICE),
        (Key::PdinM, "app.PDin_M", MASTER),
        (Key::SdsetS, "app.SDset_S", MASTER),
        (Key::ChFAckReqS, "app.ChFAckReq_S", MASTER),
        (Key::FaultsS, "app.FAULTS_S", MASTER),
        (Key::Qualifier, "app.qualifier", MASTER),
        (Key::Mode, "mode", BOTH),
        (Key::PortPower, "L+", MASTER),
        (Key::Cq, "C/Q", DEVICE),
        (Key::Iq, "I/Q", DEVICE),
        (Key::WakeUp, "wake-up", MASTER),
        (Key::Record, "record", MASTER),
        (Key::DataStorage, "data-storage", MASTER),
        (Key::Stored, "stored", MASTER),
        (Key::Reply, "reply", DEVICE),
        (Key::Result, "result", MASTER),
        (Key::Reference, "RefArgBlockID", MASTER),
        (Key::Length, "ArgBlockLength", MASTER),
        (Key::Block, "block", MASTER),
        (Key::Event, "event", BOTH),
        (Key::EventType, "event.type", BOTH),
    ];

    /// As written in cases; a field of an ArgBlock by its name.
    pub fn name(self) -> &'static str {
        match self {
            Key::Field(name) => name,
            _ => Key::ALL.iter().find(|entry| entry.0 == self).map_or("", |entry| entry.1),
        }
    }

    /// Whether the oracle, which knows the tolerances in use, judges the same.
    pub const fn is_the_oracles(self) -> bool {
        !matches!(
            self,
            Key::Reply
                | Key::Structure
                | Key::Event
                | Key::EventType
                | Key::Nsr
                | Key::Mode
                | Key::PortPower
                | Key::Cq
                | Key::Iq
                | Key::WakeUp
                | Key::Record
                | Key::DataStorage
                | Key::Stored
                | Key::Result
                | Key::Reference
                | Key::Length
                | Key::Block
                | Key::Field(_)
        )
    }

    /// Clause that says what is to be seen there.
    pub fn clause(self) -> &'static str {
        match self {
            Key::DcountI => "11.4.6 Table 33",
            Key::SdSet | Key::DcommErr | Key::Dtimeout => "11.4.6 Table 32, 11.5.3 Table 40",
            Key::Pdin => "11.3.3 Table 29",
            Key::Structure => "12.1",
            Key::Mcount | Key::SetSd | Key::ChFAckReq => "11.4.6 Table 31, 11.5.2 Table 38",
            Key::Pdout => "11.3.2 Table 28",
            Key::PortNum => "11.4.5",
            Key::Reserved => "11.4.6 Tables 31 and 32",
            Key::Image => "11.4.7, 11.5",
            Key::Nsr => "10.5, 9.1.2",
            Key::PdoutD | Key::SetSdDc | Key::ChFAckReqDc => "11.3.3 Table 29",
            Key::PdinM | Key::SdsetS | Key::ChFAckReqS | Key::FaultsS => "11.3.2 Table 28",
            Key::Qualifier => "11.11.4 Table 42",
            Key::Mode | Key::PortPower | Key::WakeUp => "7.2 Table 10",
            Key::Cq | Key::Iq => "5.3.2.1 Table 4",
            Key::Record => "10.4.3.6, A.2.10",
            Key::DataStorage | Key::Stored => "9.4",
            Key::Reply => "A.1 Table A.1",
            Key::Result | Key::Reference | Key::Length => "10.2",
            Key::Block | Key::Field(_) => "10.3",
            Key::Event | Key::EventType => "Annex B",
        }
    }
}

/// What to see.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Expected {
    /// 0 or 1, a counter, an EventCode or ErrorType.
    Number(u32),
    /// The mirror of the counter sent last.
    Mirror,
    /// The MCount after the one before the step.
    Next,
    /// As it was before the step.
    Unchanged,
    /// The value given by the other side: PDout or PDin sent last, PDin_D or PDout_M set last.
    Live,
    /// All octets 0.
    Safe,
    /// 0 in the bits the declared structure leaves as padding.
    Padded,
    /// The protocol record with the FSP_IO_StructCRC of the declared structure.
    Structure,
    /// The other value of the technology parameter of the profile.
    OtherTechnology,
    /// All octets 0 or as before the step: nothing of what came is used.
    Withheld,
    /// An SPDU with right signature.
    Answer,
    /// A write carried out.
    Written,
    /// A read or write refused, whatever the ErrorType.
    Refused,
    /// These octets.
    Octets(Vec<u8>),
    /// So many octets, whichever.
    Count(usize),
    /// What the IODD given by `--iodd` declares of this object.
    Declared(Declared),
    /// A number from the first to the second, or a field of an FSP record that was read with such a number.
    Range(Option<&'static RecordField>, u32, u32),
    /// A list of entries, this one among them.
    Contains(Vec<u8>),
    /// Device Access Lock without the bits 0 and 1, or none at all.
    Unlocked,
    /// One of these EventCodes and no other; `true`: or none.
    Events(bool, Vec<u16>),
    /// EventQualifiers of one of these types (base standard: bits 5 and 4).
    Types(Vec<u8>),
    /// A mode.
    Mode(Mode),
    /// What was configured.
    Configured,
    /// What stands in the images of both directions.
    Snapshot,
    /// The length of what came.
    Right,
    /// EventCodes that Annex B does not reserve, or no Event at all.
    Unreserved,
    /// Nothing.
    None,
    /// One of these results.
    Results(Vec<Outcome>),
    /// Any number but this.
    Not(u32),
    /// One of these.
    Transfers(Vec<Transfer>),
}

/// Types of Events: bits 5 and 4 of an EventQualifier of the base standard.
pub const EVENT_TYPES: [(u8, &str); 3] = [(1, "Notification"), (2, "Warning"), (3, "Error")];

/// The result of a service.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// Result(+).
    Positive,
    /// Result(-), whatever the error.
    Negative,
    /// Result(-) with this error.
    Error(u16),
}

/// What an IODD declares and a product answers to a read.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Declared {
    /// Index 0x4201: version, mode and FSP_IO_StructCRC of its twelve octets; the rest is the user's.
    Protocol,
    /// Index 0x4210 (iec2022).
    TimeToReady,
    /// Index 0x4211 (iec2022).
    MinShutDownTime,
    /// Index 0x4212.
    ParamDescCrc,
    /// Index 0x4213 (iec2022).
    Wcdt,
    /// Index 0x4214 (iec2022).
    Ofdt,
}
