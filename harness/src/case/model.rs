//! A case as the engine executes it: typed steps for one point of its sweep.

use fsct_adapters::Service;
use std::ops::Range;

/// One step.
#[derive(Clone, Debug)]
pub struct Step {
    /// The step as a line of the case language, sweep values filled in.
    pub text: String,
    /// Where it stands in its file.
    pub at: Range<usize>,
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
    /// A conformant FS-Master takes over.
    Partner(Partner),
    /// Supply on or off.
    Power(bool),
    /// FSP parameterization from the profile: authenticity and protocol record, then the verify record.
    Parameterize,
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
    /// Nothing: only look.
    Look,
}

/// The SPDU of an exchange and how often it goes out.
#[derive(Clone, Debug)]
pub struct Exchange {
    /// MCount.
    pub mcount: Count,
    /// setSD.
    pub set_sd: bool,
    /// ChFAckReq.
    pub ch_f_ack_req: bool,
    /// FS-PDout.
    pub pdout: Data,
    /// PortNum.
    pub port_num: PortNum,
    /// Reserved bits 4..2 of Control&MCnt, 0..7.
    pub reserved: u8,
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
    /// Exactly this many link exchanges with the same octets, whatever the DUT answers.
    pub repeat: Option<u32>,
}

/// Which counter an SPDU carries.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Count {
    /// The one after the SPDU sent last; 0 when none was sent.
    Next,
    /// That of the SPDU sent last.
    Same,
    /// The next one, counted on by this many more.
    Jump(u8),
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
}

/// The PortNum octet of an SPDU.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum PortNum {
    /// FSP_Port.
    Own,
    /// FSP_Port inverted, as an answer has it.
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
    /// Control octet before PortNum.
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
    /// setSD and ChFAckReq: the bits of the control octet beside the counter.
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
    /// These octets.
    Exactly(Vec<u8>),
}

/// Time that passes.
#[derive(Clone, Debug)]
pub struct Wait {
    /// Until this long after the first copy of the SPDU sent last.
    pub until: Duration,
    /// What the link does meanwhile.
    pub link: Link,
}

/// What the link does while time passes.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Link {
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
}

/// A conformant FS-Master takes over.
#[derive(Clone, Debug)]
pub struct Partner {
    /// Where it begins.
    pub from: From,
    /// What the operator does.
    pub operator: Operator,
    /// It goes on until all of these hold; empty: until regular operation.
    pub until: Vec<Expectation>,
    /// The most SCL cycles; `None`: the bound of the liveness requirement, 8 SCL cycles plus 2 FSP_Watchdog.
    pub within: Option<u32>,
}

/// Where a partner begins.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum From {
    /// T1: a new start.
    Start,
    /// After a fault it has seen: the counter goes on (T7).
    Next,
    /// After a timeout it has seen: the counter is 0 (T8, T14).
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
    /// The image as a whole.
    Image,
    /// Service PDout_D.
    PdoutD,
    /// Service setSD_DC.
    SetSdDc,
    /// Service ChFAckReq_DC.
    ChFAckReqDc,
    /// Answer to a read or write.
    Reply,
    /// EventCode seen in this step.
    Event,
}

impl Key {
    /// All keys as written in cases.
    pub const ALL: [(Key, &'static str); 11] = [
        (Key::DcountI, "DCount_i"),
        (Key::SdSet, "SDset"),
        (Key::DcommErr, "DCommErr"),
        (Key::Dtimeout, "DTimeout"),
        (Key::Pdin, "PDin"),
        (Key::Image, "image"),
        (Key::PdoutD, "app.PDout_D"),
        (Key::SetSdDc, "app.setSD_DC"),
        (Key::ChFAckReqDc, "app.ChFAckReq_DC"),
        (Key::Reply, "reply"),
        (Key::Event, "event"),
    ];

    /// As written in cases.
    pub fn name(self) -> &'static str {
        Key::ALL.iter().find(|entry| entry.0 == self).map_or("", |entry| entry.1)
    }

    /// Clause that says what is to be seen there.
    pub fn clause(self) -> &'static str {
        match self {
            Key::DcountI => "11.4.6 Table 33",
            Key::SdSet | Key::DcommErr | Key::Dtimeout => "11.4.6 Table 32, 11.5.3 Table 40",
            Key::Pdin => "11.3.3 Table 29",
            Key::Image => "11.5.3",
            Key::PdoutD | Key::SetSdDc | Key::ChFAckReqDc => "11.3.3 Table 29",
            Key::Reply => "A.1 Table A.1",
            Key::Event => "B.1 Table B.1",
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
    /// As it was before the step.
    Unchanged,
    /// The value given by the other side: PDout sent last, PDin_D set last.
    Live,
    /// All octets 0.
    Safe,
    /// An answer of the SCL, with right signature.
    Answer,
    /// A write carried out.
    Written,
    /// A read or write refused, whatever the ErrorType.
    Refused,
    /// These octets.
    Octets(Vec<u8>),
}
