//! What a case does at a port of an FS-Master: configuration, start, requests through the SMI.

use super::Duration;
use fsct_adapters::{SmiService, smi};
use fsct_protocol::smi::{ArgBlock, Field as BlockField};
use std::ops::Range;

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
    /// Which FS-Device it is; `None`: the one that is there, or one as configured.
    pub device: Option<Specimen>,
    /// VendorID, where it is not the configured one.
    pub vendor_id: Option<u16>,
    /// DeviceID, where it is not the configured one.
    pub device_id: Option<u32>,
    /// How far it goes.
    pub until: Until,
    /// The most time for it.
    pub within: Duration,
}

/// A virtual FS-Device by what it remembers.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Specimen {
    /// It holds the records the port is configured with.
    Own,
    /// As it came from the factory: authenticity and port 0.
    Factory,
    /// In use elsewhere: another authenticity.
    Used,
    /// From another port of the same FS-Master.
    Moved,
    /// As configured, its technology parameter changed since, and asking for an upload.
    Marked,
    /// As configured; its Data Storage fails.
    Broken,
}

/// What Data Storage comes to.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Transfer {
    /// Nothing is copied.
    None,
    /// The whole set goes to the FS-Master, before the verify record.
    Upload,
    /// The whole set goes to the FS-Device, before the verify record.
    Download,
    /// The FS-Device does not take the set.
    Refused,
}

/// A record that a tool writes to the FS-Device.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Assigned {
    /// The authenticity record of the profile.
    Authenticity,
    /// The protocol record with FSP_TechParCRC of the profile.
    Protocol,
    /// The protocol record with FSP_TechParCRC 0.
    ProtocolTest,
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
    /// SMI_DeviceWrite of this record.
    pub record: Option<Assigned>,
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
