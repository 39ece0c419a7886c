//! A case as the engine executes it: typed steps for one point of its sweep.

mod expect;
mod parameters;
mod port;
mod spdu;

pub use expect::{Declared, EVENT_TYPES, Expectation, Expected, Key, Outcome};
use fsct_adapters::{Line, Service};
use fsct_lines::{Claim, Quantity};
pub use parameters::{Blocks, Parameterize, RecordField, Sent, Starts};
pub use port::{Answered, Assigned, Configure, Connect, ERRORS, Smi, Specimen, Transfer, Until, Value, blocks};
pub use spdu::{Back, Corrupt, Count, Data, Exchange, Field, Image, KEPT, PortNum, Signature};
use std::ops::Range;

/// One step.
#[derive(Clone, Debug)]
pub struct Step {
    /// The step as a line of the case language, sweep values filled in.
    pub text: String,
    /// Where it stands in its file.
    pub at: Range<usize>,
    /// Activities of the scenario of its case that it is about.
    pub activities: Vec<u16>,
    /// Whether a note for the reader stands at it.
    pub noted: bool,
    /// Port of an FS-Master it is about, from 1.
    pub port: u8,
    /// What is done.
    pub action: Action,
    /// What has to be seen afterwards.
    pub expect: Vec<Expectation>,
    /// What should be seen afterwards; the contrary is a remark.
    pub remark: Vec<Expectation>,
    /// What has to be measured by now, and to lie within its limits.
    pub measure: Vec<Wanted>,
}

impl Step {
    /// Whether what it shows depends on time: waits, what is done to lines, and measurements.
    pub fn is_timed(&self) -> bool {
        !self.measure.is_empty() || matches!(self.action, Action::Wait(_) | Action::Pass { .. } | Action::Wake(_))
    }
}

/// Something a step wants measured.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Wanted {
    /// A value that has limits.
    Quantity(Quantity),
    /// Something that is so or is not.
    Claim(Claim),
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
    /// Data Storage as an FS-Master does it.
    DataStorage(Way),
    /// A write of the technology parameter of the profile; `true`: of its other value.
    Technology(bool),
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
    Pass {
        /// So long.
        time: Duration,
        /// From when on, on the lines of an FS-Device; `None`: from now on.
        after: Option<After>,
    },
    /// A wake-up request to an FS-Device after its Ready pulse.
    Wake(Wake),
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

/// Time that passes.
#[derive(Clone, Debug)]
pub struct Wait {
    /// Until this long after the first copy of the SPDU sent last.
    pub until: Duration,
    /// What the link does meanwhile.
    pub link: Meanwhile,
}

/// Which way Data Storage copies.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Way {
    /// From the FS-Device to the tester, which keeps the set.
    Upload,
    /// The set that is kept into the FS-Device.
    Download,
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

/// What is awaited on the lines of an FS-Device.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum After {
    /// The end of the Ready pulse.
    ReadyPulse,
    /// Both outputs ON.
    Ossde,
}

/// A wake-up request.
#[derive(Copy, Clone, Debug)]
pub struct Wake {
    /// So long after the end of the Ready pulse.
    pub after: Duration,
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
    /// Multiples of how late an expiry may show, without an exchange to see it.
    pub lates: i64,
    /// A multiple of the smallest or largest value of a limit, of one limit at most.
    pub limit: Option<(i64, Quantity, End)>,
    /// Multiples of the guard band: tick of the product's timer plus uncertainty of a time stamp.
    pub guards: i64,
    /// Milliseconds.
    pub ms: i64,
    /// Microseconds.
    pub us: i64,
}

/// An end of a limit.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum End {
    /// The smallest value permitted.
    Min,
    /// The largest value permitted.
    Max,
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
