//! A case as the engine executes it: typed steps for one point of its sweep.

use fsct_adapters::{Line, Mode, Role, Service, SmiService, smi};
use fsct_protocol::smi::{ArgBlock, Field as BlockField};
use std::ops::Range;

/// One step.
#[derive(Clone, Debug)]
pub struct Step {
    /// The step as a line of the case language, sweep values filled in.
    pub text: String,
    /// Where it stands in its file.
    pub at: Range<usize>,
    /// Port of an FS-Master it is about, from 1.
    pub port: u8,
    /// What is done.
    pub action: Action,
    /// What has to be seen afterwards.
    pub expect: Vec<Expectation>,
    /// What should be seen afterwards; the contrary is a remark.
    pub remark: Vec<Expectation>,
}

/// What a step does.
#[derive(Clone, Debug)]
pub enum Action {
    /// SCL cycles with SPDUs written down in the case.
    Exchange(Box<Exchange>),
    /// Time passes; the link goes on as stated.
    Wait(Wait),
    /// A conformant partner takes over: an FS-Master on an FS-Device, an FS-Device on an FS-Master.
    Partner(Partner),
    /// Supply on or off.
    Power(bool),
    /// FSP parameterization from the profile: authenticity and protocol record, then the verify record.
    Parameterize(Parameterize),
    /// A write of on-request data.
    Write {
        /// Index.
        index: u16,
        /// Subindex.
        subindex: u8,
        /// Value.
        data: Vec<u8>,
    },
    /// A read of on-request data.
    Read {
        /// Index.
        index: u16,
        /// Subindex.
        subindex: u8,
    },
    /// Input services of the application.
    App(Vec<(Service, Data)>),
    /// SMI_PortConfiguration with the FSPortConfigList of the profile, and these deviations from it.
    Configure(Configure),
    /// A virtual FS-Device starts on the port: Ready pulse, wake-up, PREOPERATE, record, OPERATE.
    Connect(Connect),
    /// Nothing is connected to the port any more.
    Unplug,
    /// A request through the SMI.
    Smi(Box<Smi>),
    /// Levels on C/Q and I/Q.
    Drive(Vec<(Line, bool)>),
    /// Time passes; ports in operation go on.
    Pass(Duration),
    /// The Device on the port raises an Event.
    Raise {
        /// EventCode.
        code: u16,
        /// EventQualifier.
        qualifier: u8,
    },
    /// Nothing: only look.
    Look,
}

/// FSP parameterization of an FS-Device, and how it is not as the profile says.
#[derive(Clone, Debug)]
pub struct Parameterize {
    /// Authenticity and protocol record are written.
    pub blocks: bool,
    /// The verify record is written.
    pub record: bool,
    /// FSP_TechParCRC is the one of armed operation in all of them.
    pub armed: bool,
    /// Fields of the verify record alone. Its signatures are computed over them.
    pub set: Vec<(&'static RecordField, Value)>,
    /// Whether the SCL has to start.
    pub starts: bool,
}

impl Default for Parameterize {
    fn default() -> Parameterize {
        Parameterize { blocks: true, record: true, armed: false, set: Vec::new(), starts: true }
    }
}

/// A field of FSP_VerifyRecord.
#[derive(Debug, PartialEq, Eq)]
pub struct RecordField {
    /// Its name.
    pub name: &'static str,
    /// First octet, and the one behind the last.
    pub octets: (usize, usize),
}

impl RecordField {
    /// All of them in order.
    pub const ALL: [RecordField; 10] = [
        RecordField { name: "FSP_Authenticity_1", octets: (0, 4) },
        RecordField { name: "FSP_Authenticity_2", octets: (4, 8) },
        RecordField { name: "FSP_Port", octets: (8, 9) },
        RecordField { name: "FSP_AuthentCRC", octets: (9, 11) },
        RecordField { name: "FSP_ProtVersion", octets: (11, 12) },
        RecordField { name: "FSP_ProtMode", octets: (12, 13) },
        RecordField { name: "FSP_Watchdog", octets: (13, 15) },
        RecordField { name: "FSP_IO_StructCRC", octets: (15, 17) },
        RecordField { name: "FSP_TechParCRC", octets: (17, 21) },
        RecordField { name: "FSP_ProtParCRC", octets: (21, 23) },
    ];
}

/// The FSPortConfigList of the profile with deviations.
#[derive(Clone, Debug, Default)]
pub struct Configure {
    /// Fields that are not as the profile and the variant say. The signatures are computed over them.
    pub set: Vec<(&'static BlockField, Value)>,
    /// Octets of process data without safety relevance, in and out (MIXEDSAFETYCOM).
    pub nsr: (u8, u8),
    /// Whether the SCL of the port may start with this list; `None`: nobody says, and nothing is judged.
    pub starts: Option<bool>,
}

/// A value of a field of an ArgBlock.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Value {
    /// This one.
    Number(u32),
    /// The right one with its least significant bit inverted.
    Wrong,
    /// What the profile says: passwords.
    Profile,
}

/// How a virtual FS-Device starts on a port.
#[derive(Clone, Debug)]
pub struct Connect {
    /// Width of the Ready pulse in microseconds; `None`: no pulse.
    pub pulse_us: Option<u64>,
    /// When the Ready pulse comes, from L+ on.
    pub after: Duration,
    /// What the Device answers to the verify record.
    pub record: Answered,
    /// VendorID, where it is not the configured one.
    pub vendor_id: Option<u16>,
    /// DeviceID, where it is not the configured one.
    pub device_id: Option<u32>,
    /// How far it goes.
    pub until: Until,
    /// The most time for it.
    pub within: Duration,
}

/// What a Device answers to a write.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Answered {
    /// Written.
    Written,
    /// Refused: service temporarily not available, Device control.
    Refused,
    /// Nothing.
    Silent,
}

/// How far the start of a port goes.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Until {
    /// L+ is on.
    Power,
    /// The wake-up pulse has come.
    WakeUp,
    /// PREOPERATE.
    Preoperate,
    /// The verify record has come.
    Record,
    /// OPERATE.
    Operate,
    /// For the whole time.
    Time,
}

/// A request through the SMI.
#[derive(Clone, Debug)]
pub struct Smi {
    /// Which service.
    pub service: SmiService,
    /// PortNumber, where it is not that of the step.
    pub port: Option<u8>,
    /// ArgBlockID of the request, where it is not that of the service.
    pub id: Option<u16>,
    /// ExpArgBlockID, where it is not that of the service.
    pub expected: Option<u16>,
    /// Fields of the request.
    pub set: Vec<(String, Value)>,
    /// Octets behind the ArgBlockID in place of fields.
    pub octets: Option<Vec<u8>>,
    /// Octets more (or fewer) at the end of the request.
    pub longer: i64,
    /// Where the text stands that names fields.
    pub at: Range<usize>,
}

/// The ArgBlock of a request and the one that comes back (Table 15 of both editions).
pub fn blocks(service: SmiService) -> (Option<&'static ArgBlock>, Option<&'static ArgBlock>) {
    use fsct_protocol::smi::*;
    let void = Some(&VOID_BLOCK);
    match service {
        SmiService::MasterIdentification => (void, Some(&MASTER_IDENT)),
        SmiService::FsMasterAccess => (Some(&FS_MASTER_ACCESS), Some(&FSCP_AUTHENTICITY)),
        SmiService::PortConfiguration => (Some(&FS_PORT_CONFIG_LIST), void),
        SmiService::ReadbackPortConfiguration => (void, Some(&FS_PORT_CONFIG_LIST)),
        SmiService::PortStatus => (void, Some(&FS_PORT_STATUS_LIST)),
        SmiService::DsToParServ => (void, Some(&DS_DATA)),
        SmiService::ParServToDs => (Some(&DS_DATA), void),
        SmiService::DeviceWrite => (Some(&ON_REQUEST_DATA), void),
        SmiService::DeviceRead => (Some(&ON_REQUEST_READ), Some(&ON_REQUEST_DATA)),
        SmiService::PortPowerOffOn => (Some(&PORT_POWER_OFF_ON), void),
        SmiService::PdIn => (void, Some(&PD_IN)),
        SmiService::PdOut => (Some(&PD_OUT), void),
        SmiService::PdInOut => (void, Some(&PD_IN_OUT)),
        SmiService::SpduIn => (void, Some(&SPDU_IN)),
        SmiService::SpduOut => (Some(&SPDU_OUT), void),
        SmiService::FsPdInOut => (void, Some(&FS_PD_IN_OUT)),
        SmiService::PdInIq | SmiService::PdOutIq => (void, void),
    }
}

/// Results of a service that a case can name: the errors of both editions.
pub const ERRORS: [(u16, &str); 12] = [
    (smi::job_error::ARGBLOCK_NOT_SUPPORTED, "ARGBLOCK_NOT_SUPPORTED"),
    (smi::job_error::ARGBLOCK_INCONSISTENT, "ARGBLOCK_INCONSISTENT"),
    (smi::job_error::DEVICE_NOT_ACCESSIBLE, "DEVICE_NOT_ACCESSIBLE"),
    (smi::job_error::SERVICE_NOT_SUPPORTED, "SERVICE_NOT_SUPPORTED"),
    (smi::job_error::DEVICE_NOT_IN_OPERATE, "DEVICE_NOT_IN_OPERATE"),
    (smi::job_error::MEMORY_OVERRUN, "MEMORY_OVERRUN"),
    (smi::job_error::PORT_NUM_INVALID, "PORT_NUM_INVALID"),
    (smi::job_error::ARGBLOCK_LENGTH_INVALID, "ARGBLOCK_LENGTH_INVALID"),
    (smi::job_error::SERVICE_TEMP_UNAVAILABLE, "SERVICE_TEMP_UNAVAILABLE"),
    (smi::error_info::OUT_OF_RANGE, "OUT_OF_RANGE"),
    (smi::error_info::STATE_CONFLICT, "STATE_CONFLICT"),
    (smi::error_info::NO_COM, "NO_COM"),
];

/// The SPDU of an exchange and how often it goes out.
#[derive(Clone, Debug)]
pub struct Exchange {
    /// MCount or DCount_i.
    pub count: Count,
    /// The bits of the control or status octet below the counter, reserved ones included.
    pub bits: u8,
    /// FS-PDout or FS-PDin.
    pub pd: Data,
    /// PortNum.
    pub port_num: PortNum,
    /// How the signature comes about.
    pub signature: Signature,
    /// Bits falsified after the signature has been made.
    pub corrupt: Corrupt,
    /// What takes the place of the SPDU.
    pub image: Image,
    /// How many SCL cycles.
    pub times: u32,
    /// SCL cycles go on until all of these hold.
    pub until: Vec<Expectation>,
    /// The most SCL cycles for `until`.
    pub within: u32,
    /// Octets without safety relevance behind the SPDU.
    pub nsr: Vec<u8>,
    /// Exactly this many link exchanges with the same octets, whatever the DUT answers.
    pub repeat: Option<u32>,
}

/// Which counter an SPDU carries.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Count {
    /// To an FS-Device the one after the SPDU sent last, 0 when none was sent; to an FS-Master the mirror of the MCount
    /// that stands.
    Next,
    /// That of the SPDU sent last.
    Same,
    /// As `Next`, counted on by this many more.
    Jump(u8),
    /// As `Next`, with this bit of the three inverted, 0 the least significant; the signature is made over it.
    Bit(u8),
    /// This one.
    Exactly(u8),
}

/// Process data.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Data {
    /// New octets other than 0 from the seed of the case.
    Pattern,
    /// All 0.
    Safe,
    /// Those sent last.
    Same,
    /// Octets for which the computed signature is 0.
    ZeroSignature,
    /// These octets, filled up with 0 in front.
    Exactly(Vec<u8>),
    /// A service of one bit.
    Bit(bool),
    /// What the profile says (FSCP_Authenticity).
    Profile,
}

/// The PortNum octet of an SPDU.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum PortNum {
    /// The right one: FSP_Port, inverted in an answer.
    Own,
    /// Its inverse.
    Inverted,
    /// Another port of the same FS-Master.
    Foreign,
    /// This octet.
    Exactly(u8),
}

/// How a signature comes about.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Signature {
    /// As the standard says.
    Good,
    /// All octets 0.
    Zero,
    /// Every bit inverted.
    Inverted,
    /// Start value 0.
    StartZero,
    /// Octets in reverse order.
    Reversed,
    /// Control or status octet before PortNum.
    Order,
}

/// Bits falsified on the way.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Corrupt {
    /// None.
    Nothing,
    /// These bits; 0 is the most significant bit of the first octet.
    Bits(Vec<usize>),
    /// One bit of a field, chosen by the seed.
    Field(Field),
}

/// A field of an SPDU.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Field {
    /// FS process data; the signature where there are none.
    Data,
    /// PortNum.
    PortNum,
    /// The bits of the control or status octet beside the counter and the reserved ones.
    Control,
    /// Signature.
    Signature,
}

/// What the DUT receives.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Image {
    /// The SPDU.
    Spdu,
    /// All octets 0.
    Zero,
    /// Nothing.
    Lost,
    /// The DUT's own answer (loop-back).
    Echo,
    /// Standard process data from the seed.
    Standard,
    /// The SPDU that was sent this many SPDUs before the last one, octet for octet.
    Ago(usize),
    /// These octets.
    Exactly(Vec<u8>),
}

/// What a partner receives in place of the SPDU the DUT has made for it.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Back {
    /// It, with one bit of the signature falsified.
    Corrupt,
    /// It, with a counter two further and a signature over it.
    Counter,
    /// It, with the PortNum of another port of the same FS-Master and a signature over it.
    Foreign,
    /// Standard process data whose octet in the place of the counter reads as the one awaited.
    Standard,
    /// What the partner sends itself (loop-back).
    Echo,
    /// Nothing.
    Lost,
    /// Nothing, and it afterwards.
    Late,
    /// The image the DUT presented this many images before it.
    Ago(usize),
}

/// Images and SPDUs that are kept for `N ago`.
pub const KEPT: usize = 8;

/// Time that passes.
#[derive(Clone, Debug)]
pub struct Wait {
    /// Until this long after the first copy of the SPDU sent last.
    pub until: Duration,
    /// What the link does meanwhile.
    pub link: Meanwhile,
}

/// What the link does while time passes.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Meanwhile {
    /// Goes on with the octets sent last.
    Repeat,
    /// Delivers nothing.
    Lost,
    /// Delivers all octets 0.
    Zero,
}

/// A duration in symbols: a sum of multiples.
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq)]
pub struct Duration {
    /// Multiples of FSP_Watchdog.
    pub watchdogs: i64,
    /// Multiples of MasterCycleTime.
    pub cycles: i64,
    /// Multiples of the margin of A24: how late an expiry may show, and one exchange to see whether it did.
    pub margins: i64,
    /// Multiples of the guard band: tick of the product's timer plus uncertainty of a time stamp.
    pub guards: i64,
    /// Milliseconds.
    pub ms: i64,
    /// Microseconds.
    pub us: i64,
}

/// A conformant FS-Master takes over.
#[derive(Clone, Debug)]
pub struct Partner {
    /// Where it begins.
    pub from: From,
    /// What the operator does.
    pub operator: Operator,
    /// What is disturbed on the way back to it.
    pub back: Option<Back>,
    /// How long it is disturbed; `None`: once, the first SPDU made for it.
    pub back_for: Option<Duration>,
    /// It goes on until all of these hold; empty: until regular operation.
    pub until: Vec<Expectation>,
    /// The most there is time for; `None`: the bound of the liveness requirement, 8 SCL cycles plus 2 FSP_Watchdog.
    pub within: Option<Within>,
}

/// How long something goes on at the most.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Within {
    /// So many SCL cycles.
    SclCycles(u32),
    /// So long.
    Time(Duration),
}

/// Where a partner begins.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum From {
    /// A new start: T1, or state 21.
    Start,
    /// An FS-Master in regular operation: the counter goes on (T4).
    Regular,
    /// An FS-Master after a fault it has seen: the counter goes on (T7). An FS-Device in regular operation.
    Next,
    /// An FS-Master after a timeout it has seen: the counter is 0 (T8, T14).
    Zero,
}

/// What the operator does.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Operator {
    /// Acknowledges when asked, having released before.
    Acknowledges,
    /// Never acknowledges.
    Absent,
}

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
    /// Wake-up pulses in this step.
    WakeUp,
    /// What was written to 0x4202 in this step.
    Record,
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
}

const DEVICE: &[Role] = &[Role::Device];
const MASTER: &[Role] = &[Role::Master];
const BOTH: &[Role] = &[Role::Device, Role::Master];

impl Key {
    /// All keys as written in cases, and the side they are for; fields of ArgBlocks are `block.` and their name.
    pub const ALL: [(Key, &'static str, &'static [Role]); 31] = [
        (Key::DcountI, "DCount_i", DEVICE),
        (Key::SdSet, "SDset", DEVICE),
        (Key::DcommErr, "DCommErr", DEVICE),
        (Key::Dtimeout, "DTimeout", DEVICE),
        (Key::Pdin, "PDin", DEVICE),
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
        (Key::Mode, "mode", MASTER),
        (Key::PortPower, "L+", MASTER),
        (Key::WakeUp, "wake-up", MASTER),
        (Key::Record, "record", MASTER),
        (Key::Reply, "reply", DEVICE),
        (Key::Result, "result", MASTER),
        (Key::Reference, "RefArgBlockID", MASTER),
        (Key::Length, "ArgBlockLength", MASTER),
        (Key::Block, "block", MASTER),
        (Key::Event, "event", BOTH),
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
                | Key::Event
                | Key::Nsr
                | Key::Mode
                | Key::PortPower
                | Key::WakeUp
                | Key::Record
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
            Key::Record => "10.4.3.6, A.2.10",
            Key::Reply => "A.1 Table A.1",
            Key::Result | Key::Reference | Key::Length => "10.2",
            Key::Block | Key::Field(_) => "10.3",
            Key::Event => "Annex B",
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
    /// A mode.
    Mode(Mode),
    /// What was configured.
    Configured,
    /// What stands in the images of both directions.
    Snapshot,
    /// The length of what came.
    Right,
    /// Nothing.
    None,
    /// One of these results.
    Results(Vec<Outcome>),
}

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
