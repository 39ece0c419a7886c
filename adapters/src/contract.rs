//! The contract with a device under test: the harness hands over stimuli, the DUT answers with time-stamped
//! observations, in order. Everything that crosses this boundary is in this file, and in `port` and `smi` beside it for what
//! only an FS-Master has.
//!
//! Octets only: what they mean is the business of the harness.

mod port;
pub mod smi;

pub use port::{Identity, Line, Mode, Response, Source};
pub use smi::{SmiRequest, SmiResult, SmiService};

use crate::DutError;
use fsct_protocol::{Edition, ProtMode};
use std::fmt;

/// The most stimuli one [`Dut::apply`] can number: every position then fits [`Observation::stimulus`].
pub const MAX_BATCH: usize = 1 << 16;
/// The most octets of on-request data, by the base standard.
pub const MAX_RECORD: usize = 232;

/// A device under test, however it is reached.
pub trait Dut: Send {
    /// Says who it is and what it serves.
    ///
    /// # Errors
    /// [`DutError`] when no description came; the connection is then of no further use.
    fn hello(&mut self) -> Result<Description, DutError>;

    /// Carries out `stimuli` in order and appends what was observed, in order, to `observed`.
    ///
    /// Every [`Stimulus::Exchange`] yields exactly one [`Seen::Image`], the last observation of that stimulus. Every
    /// `Read` and `Write` yields one answer, every `Smi` one result. A stimulus that is not served yields
    /// [`Seen::Unsupported`], never nothing.
    ///
    /// Callers keep to [`MAX_BATCH`] stimuli; in a longer batch positions start again at 0 after every [`MAX_BATCH`].
    ///
    /// # Errors
    /// [`DutError`] when the answer did not come or was none; the connection is then of no further use.
    fn apply(&mut self, stimuli: &[Stimulus], observed: &mut Vec<Observation>) -> Result<(), DutError>;
}

impl<D: Dut + ?Sized> Dut for &mut D {
    fn hello(&mut self) -> Result<Description, DutError> {
        (**self).hello()
    }

    fn apply(&mut self, stimuli: &[Stimulus], observed: &mut Vec<Observation>) -> Result<(), DutError> {
        (**self).apply(stimuli, observed)
    }
}

impl<D: Dut + ?Sized> Dut for Box<D> {
    fn hello(&mut self) -> Result<Description, DutError> {
        (**self).hello()
    }

    fn apply(&mut self, stimuli: &[Stimulus], observed: &mut Vec<Observation>) -> Result<(), DutError> {
        (**self).apply(stimuli, observed)
    }
}

/// Up to 32 octets by value: a process data image or the value of a service.
#[derive(Copy, Clone, Default, PartialEq, Eq, Hash)]
pub struct Octets {
    octets: [u8; Octets::MAX],
    length: u8,
}

impl Octets {
    /// The most process data SDCI carries in one direction, in octets.
    pub const MAX: usize = 32;

    /// These octets; `None` when there are more than 32.
    pub fn new(octets: &[u8]) -> Option<Octets> {
        let mut out = Octets { octets: [0; Octets::MAX], length: octets.len() as u8 };
        out.octets.get_mut(..octets.len())?.copy_from_slice(octets);
        Some(out)
    }

    /// `length` octets of 0, at most 32.
    pub fn zero(length: usize) -> Octets {
        Octets { octets: [0; Octets::MAX], length: length.min(Octets::MAX) as u8 }
    }

    /// A service value of one bit: one octet, 0 or 1.
    pub fn bit(value: bool) -> Octets {
        let mut out = Octets::zero(1);
        out.octets[0] = value.into();
        out
    }

    /// The octets.
    pub fn as_slice(&self) -> &[u8] {
        &self.octets[..usize::from(self.length)]
    }

    /// Whether the first octet is not 0: the reading of a service value of one bit.
    pub fn is_set(&self) -> bool {
        self.length > 0 && self.octets[0] != 0
    }
}

impl fmt::Debug for Octets {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.as_slice().iter().try_for_each(|octet| write!(f, "{octet:02X}"))
    }
}

/// Which side of the link the DUT is.
#[derive(Copy, Clone, Debug, PartialEq, Eq, Hash)]
pub enum Role {
    /// FS-Device: the harness plays the FS-Master.
    Device,
    /// FS-Master: the harness plays the FS-Devices.
    Master,
}

impl fmt::Display for Role {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Role::Device => "device",
            Role::Master => "master",
        })
    }
}

/// A point of control and observation.
#[derive(Copy, Clone, Debug, PartialEq, Eq, Hash)]
pub enum Pco {
    /// Supply of the DUT.
    Power,
    /// Cyclic process data: the black channel.
    Link,
    /// On-request data and Events.
    Acyclic,
    /// Application services of Tables 28 and 29: the upper tester.
    App,
    /// Levels on C/Q (pin 4) and I/Q (pin 2).
    Line,
    /// The clock of the DUT.
    Clock,
}

impl Pco {
    /// All of them, in the order of their numbers in `PROTOCOL.md`.
    pub const ALL: [Pco; 6] = [Pco::Power, Pco::Link, Pco::Acyclic, Pco::App, Pco::Line, Pco::Clock];

    /// The name used in cases and reports.
    pub const fn name(self) -> &'static str {
        match self {
            Pco::Power => "power",
            Pco::Link => "link",
            Pco::Acyclic => "acyclic",
            Pco::App => "app",
            Pco::Line => "line",
            Pco::Clock => "clock",
        }
    }
}

/// What a DUT says of itself.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Description {
    /// FS-Device or FS-Master.
    pub role: Role,
    /// Ports with a link; 1 for an FS-Device.
    pub ports: u8,
    /// The points of control and observation really served.
    pub pcos: Vec<Pco>,
    /// What the DUT can be configured as; a product as sold has one entry with fixed sizes.
    pub offers: Vec<Offer>,
    /// Its clock.
    pub clock: Clock,
    /// Maker, in the maker's words: hostile text, to be escaped wherever it is shown.
    pub vendor: String,
    /// Product, in the maker's words.
    pub product: String,
    /// Versions of hardware and software, in the maker's words.
    pub version: String,
}

/// One edition and mode the DUT implements, with the process data sizes it can have there.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Offer {
    /// Edition implemented.
    pub edition: Edition,
    /// FSP_ProtMode implemented.
    pub mode: ProtMode,
    /// Least and greatest number of FS-PDout octets.
    pub pd_out: (u8, u8),
    /// Least and greatest number of FS-PDin octets.
    pub pd_in: (u8, u8),
}

impl Offer {
    /// Whether `variant` lies inside this offer.
    pub fn covers(&self, variant: Variant) -> bool {
        let inside = |range: (u8, u8), value: u8| (range.0..=range.1).contains(&value);
        self.edition == variant.edition
            && self.mode == variant.mode
            && inside(self.pd_out, variant.pd_out)
            && inside(self.pd_in, variant.pd_in)
    }
}

/// What the DUT is to be for the next case: one point of an [`Offer`].
#[derive(Copy, Clone, Debug, PartialEq, Eq, Hash)]
pub struct Variant {
    /// Edition to follow.
    pub edition: Edition,
    /// FSP_ProtMode to use.
    pub mode: ProtMode,
    /// Octets of FS-PDout.
    pub pd_out: u8,
    /// Octets of FS-PDin.
    pub pd_in: u8,
}

/// The clock behind a DUT's time stamps.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Clock {
    /// Moved by [`Stimulus::Advance`] alone, or running by itself.
    pub kind: ClockKind,
    /// Smallest step in nanoseconds.
    pub resolution_ns: u64,
    /// How far a time stamp may be off, in nanoseconds, either way.
    pub uncertainty_ns: u64,
}

/// Who moves a clock.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum ClockKind {
    /// The harness, by [`Stimulus::Advance`].
    Virtual,
    /// Time itself.
    Real,
}

/// Something done to the DUT.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Stimulus {
    /// Be this variant from the next power-on; legal only while the power is off.
    Configure(Variant),
    /// Supply on or off.
    Power(bool),
    /// One process data exchange on a port. The DUT receives the octets, or nothing (`None`: lost), and presents its
    /// image. The first exchange after power-on marks the change to OPERATE.
    Exchange {
        /// Port, from 1.
        port: u8,
        /// What the DUT receives.
        octets: Option<Octets>,
    },
    /// Read on-request data.
    Read {
        /// Index.
        index: u16,
        /// Subindex; 0 is the whole record.
        subindex: u8,
    },
    /// Write on-request data.
    Write {
        /// Index.
        index: u16,
        /// Subindex; 0 is the whole record.
        subindex: u8,
        /// Value, at most 232 octets.
        data: Vec<u8>,
    },
    /// Set an input service of the application.
    Set {
        /// Port, from 1; 0 for a service of the whole DUT.
        port: u8,
        /// Which service.
        service: Service,
        /// Process data, or one octet 0 or 1.
        value: Octets,
    },
    /// FS-Master only: this Device is connected to a port and answers, or (`None`) nothing is.
    Plug {
        /// Port, from 1.
        port: u8,
        /// What is connected.
        device: Option<Identity>,
    },
    /// FS-Master only: the connected Device answers the [`Seen::Request`] that is open on the port.
    Respond {
        /// Port, from 1.
        port: u8,
        /// Its answer.
        response: Response,
    },
    /// FS-Master only: the connected Device raises an Event.
    Raise {
        /// Port, from 1.
        port: u8,
        /// EventCode.
        code: u16,
        /// EventQualifier of the base standard: mode, type, source, instance.
        qualifier: u8,
    },
    /// A level on C/Q or I/Q, driven by what is connected to the DUT.
    Drive {
        /// Port, from 1.
        port: u8,
        /// Which line.
        line: Line,
        /// High or low.
        level: bool,
    },
    /// FS-Master only: a request through the SMI.
    Smi(Box<SmiRequest>),
    /// Move a virtual clock.
    Advance {
        /// Nanoseconds.
        ns: u64,
    },
    /// A kind of stimulus this version of the contract does not know; to be answered [`Seen::Unsupported`].
    Other {
        /// Number of the kind in `PROTOCOL.md`.
        kind: u8,
        /// Value, at most 255 octets.
        octets: Vec<u8>,
    },
}

/// An application service of Table 28 (FS-Master) or Table 29 (FS-Device).
#[derive(Copy, Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Service {
    /// FS-Device input: process data to send.
    PdinD,
    /// FS-Device input: the technology has reached its safe state.
    SdsetDs,
    /// FS-Device output: process data for the technology.
    PdoutD,
    /// FS-Device output: take the safe state.
    SetsdDc,
    /// FS-Device output: an acknowledgment is pending.
    ChfackreqDc,
    /// FS-Device output: fault found by the SCL.
    SclFault,
    /// FS-Device input: the safety function is demanded, so that OSSDe outputs switch off (5.3.3).
    OssdeDemand,
    /// FS-Master input: process data to send.
    PdoutM,
    /// FS-Master input: force safe data.
    SetsdC,
    /// FS-Master input: acknowledgment by the operator.
    ChfackC,
    /// FS-Master output: process data for the gateway.
    PdinM,
    /// FS-Master output: safe data are in use.
    SdsetS,
    /// FS-Master output: an acknowledgment is asked for.
    ChfackreqS,
    /// FS-Master output: faults.
    FaultsS,
    /// FS-Master output: qualifier of the process data, 1 = GOOD.
    Qualifier,
    /// FS-Master input, for the whole DUT: the authenticity that the upper-level FSCP has given it, A-Code and extended
    /// A-Code of four octets each.
    FscpAuthenticity,
}

impl Service {
    /// All services with their numbers in `PROTOCOL.md` and the standard's spelling.
    pub const ALL: [(Service, u8, &'static str); 16] = [
        (Service::PdinD, 1, "PDin_D"),
        (Service::SdsetDs, 2, "SDset_DS"),
        (Service::PdoutD, 3, "PDout_D"),
        (Service::SetsdDc, 4, "setSD_DC"),
        (Service::ChfackreqDc, 5, "ChFAckReq_DC"),
        (Service::SclFault, 6, "SCL_Fault"),
        (Service::OssdeDemand, 7, "OSSDe_demand"),
        (Service::PdoutM, 17, "PDout_M"),
        (Service::SetsdC, 18, "setSD_C"),
        (Service::ChfackC, 19, "ChFAck_C"),
        (Service::PdinM, 20, "PDin_M"),
        (Service::SdsetS, 21, "SDset_S"),
        (Service::ChfackreqS, 22, "ChFAckReq_S"),
        (Service::FaultsS, 23, "FAULTS_S"),
        (Service::Qualifier, 24, "qualifier"),
        (Service::FscpAuthenticity, 25, "FSCP_Authenticity"),
    ];

    /// The number of the service in `PROTOCOL.md`.
    pub fn number(self) -> u8 {
        Service::ALL.into_iter().find(|entry| entry.0 == self).map_or(0, |entry| entry.1)
    }

    /// The service with this number.
    pub fn from_number(number: u8) -> Option<Service> {
        Service::ALL.into_iter().find(|entry| entry.1 == number).map(|entry| entry.0)
    }

    /// The standard's spelling.
    pub fn name(self) -> &'static str {
        Service::ALL.into_iter().find(|entry| entry.0 == self).map_or("", |entry| entry.2)
    }

    /// The service the standard spells so.
    pub fn from_name(name: &str) -> Option<Service> {
        Service::ALL.into_iter().find(|entry| entry.2 == name).map(|entry| entry.0)
    }
}

/// Something seen at the DUT.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Observation {
    /// Position in the batch of the stimulus during which it was seen, from 0.
    pub stimulus: u16,
    /// When, in nanoseconds on the clock of the DUT.
    pub at: u64,
    /// What.
    pub seen: Seen,
}

/// What was seen.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Seen {
    /// The image the DUT presents in this exchange; `None` when it sent no process data.
    Image {
        /// Port, from 1.
        port: u8,
        /// What the DUT presents.
        octets: Option<Octets>,
    },
    /// An output service of the application took this value. Reported at power-on and at every change, before the
    /// image of the exchange that caused it.
    Service {
        /// Port, from 1.
        port: u8,
        /// Which service.
        service: Service,
        /// Process data, or one octet 0 or 1.
        value: Octets,
    },
    /// Answer to a read.
    Value(Vec<u8>),
    /// A write was carried out.
    Written,
    /// A read or write was refused.
    Refused {
        /// ErrorType of the base standard: ErrorCode in the high, AdditionalCode in the low octet.
        error: u16,
    },
    /// FS-Master only: the mode it commands on a port has changed.
    Mode {
        /// Port, from 1.
        port: u8,
        /// The new one.
        mode: Mode,
    },
    /// FS-Master only: on-request data for the Device on a port. Open until [`Stimulus::Respond`]; one at a time.
    Request {
        /// Port, from 1.
        port: u8,
        /// Index.
        index: u16,
        /// Subindex; 0 is the whole record.
        subindex: u8,
        /// Value to write; `None`: a read.
        data: Option<Vec<u8>>,
    },
    /// The DUT has changed a line: [`Line::Power`] and [`Line::WakeUp`] of an FS-Master, C/Q and I/Q of an FS-Device.
    Line {
        /// Port, from 1.
        port: u8,
        /// Which line.
        line: Line,
        /// High or low.
        level: bool,
    },
    /// FS-Master only: result of an SMI request, exactly one for each.
    Smi(Box<SmiResult>),
    /// FS-Master only: SMI_DeviceEvent or SMI_PortEvent.
    Indication {
        /// Port, from 1.
        port: u8,
        /// Device or port.
        source: Source,
        /// EventQualifier of the base standard: mode, type, source, instance.
        qualifier: u8,
        /// EventCode (Tables B.1 and B.2).
        code: u16,
    },
    /// An Event of the DUT.
    Event {
        /// EventCode (Annex B).
        code: u16,
        /// EventQualifier of the base standard: mode, type, source, instance.
        qualifier: u8,
    },
    /// The stimulus is not served.
    Unsupported,
}
