//! The Standardized Master Interface (SMI) as octets: services, requests and results (clause 10 of both editions).

use std::fmt;

/// A service of Table 15 in which the FS-Master is the receiver.
#[derive(Copy, Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum SmiService {
    /// SMI_MasterIdentification.
    MasterIdentification,
    /// SMI_FSMasterAccess.
    FsMasterAccess,
    /// SMI_PortConfiguration.
    PortConfiguration,
    /// SMI_ReadbackPortConfiguration.
    ReadbackPortConfiguration,
    /// SMI_PortStatus.
    PortStatus,
    /// SMI_DSToParServ (v1.1: SMI_DSBackupToParServ).
    DsToParServ,
    /// SMI_ParServToDS (v1.1: SMI_DSRestoreFromParServ).
    ParServToDs,
    /// SMI_DeviceWrite.
    DeviceWrite,
    /// SMI_DeviceRead.
    DeviceRead,
    /// SMI_PortPowerOffOn (v1.1: SMI_PortCmd with CMD 1).
    PortPowerOffOn,
    /// SMI_PDIn.
    PdIn,
    /// SMI_PDOut.
    PdOut,
    /// SMI_PDInOut.
    PdInOut,
    /// SMI_SPDUIn.
    SpduIn,
    /// SMI_SPDUOut.
    SpduOut,
    /// SMI_FSPDInOut (iec2022).
    FsPdInOut,
    /// SMI_PDInIQ.
    PdInIq,
    /// SMI_PDOutIQ.
    PdOutIq,
}

impl SmiService {
    /// All services with their numbers in `PROTOCOL.md` and the standard's spelling in iec2022.
    pub const ALL: [(SmiService, u8, &'static str); 18] = [
        (SmiService::MasterIdentification, 1, "SMI_MasterIdentification"),
        (SmiService::FsMasterAccess, 2, "SMI_FSMasterAccess"),
        (SmiService::PortConfiguration, 3, "SMI_PortConfiguration"),
        (SmiService::ReadbackPortConfiguration, 4, "SMI_ReadbackPortConfiguration"),
        (SmiService::PortStatus, 5, "SMI_PortStatus"),
        (SmiService::DsToParServ, 6, "SMI_DSToParServ"),
        (SmiService::ParServToDs, 7, "SMI_ParServToDS"),
        (SmiService::DeviceWrite, 8, "SMI_DeviceWrite"),
        (SmiService::DeviceRead, 9, "SMI_DeviceRead"),
        (SmiService::PortPowerOffOn, 10, "SMI_PortPowerOffOn"),
        (SmiService::PdIn, 11, "SMI_PDIn"),
        (SmiService::PdOut, 12, "SMI_PDOut"),
        (SmiService::PdInOut, 13, "SMI_PDInOut"),
        (SmiService::SpduIn, 14, "SMI_SPDUIn"),
        (SmiService::SpduOut, 15, "SMI_SPDUOut"),
        (SmiService::FsPdInOut, 16, "SMI_FSPDInOut"),
        (SmiService::PdInIq, 17, "SMI_PDInIQ"),
        (SmiService::PdOutIq, 18, "SMI_PDOutIQ"),
    ];

    /// The number of the service in `PROTOCOL.md`.
    pub fn number(self) -> u8 {
        SmiService::ALL.into_iter().find(|entry| entry.0 == self).map_or(0, |entry| entry.1)
    }

    /// The service with this number.
    pub fn from_number(number: u8) -> Option<SmiService> {
        SmiService::ALL.into_iter().find(|entry| entry.1 == number).map(|entry| entry.0)
    }

    /// The service the standard spells so.
    pub fn from_name(name: &str) -> Option<SmiService> {
        SmiService::ALL.into_iter().find(|entry| entry.2 == name).map(|entry| entry.0)
    }
}

impl fmt::Display for SmiService {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(SmiService::ALL.into_iter().find(|entry| entry.0 == *self).map_or("", |entry| entry.2))
    }
}

/// A request to the FS-Master.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct SmiRequest {
    /// Which service.
    pub service: SmiService,
    /// PortNumber; 0 for a service of the whole FS-Master.
    pub port: u8,
    /// ClientID, to come back in the result.
    pub client_id: u16,
    /// ExpArgBlockID; 0 in v1.1, which has none.
    pub expected: u16,
    /// The ArgBlock with its ArgBlockID in front, most significant octets first. Empty where the edition asks for none. For
    /// SMI_FSMasterAccess in v1.1 the arguments in their place: UserRole (1), FSMasterPassword (4).
    pub octets: Vec<u8>,
}

/// What a service came to.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct SmiResult {
    /// PortNumber as it came back.
    pub port: u8,
    /// ClientID as it came back.
    pub client_id: u16,
    /// Result(+) or Result(-).
    pub positive: bool,
    /// RefArgBlockID; 0 in v1.1, which has none.
    pub reference: u16,
    /// ArgBlockLength as the FS-Master states it; 0 where the edition gives none.
    pub length: u16,
    /// The ArgBlock with its ArgBlockID in front; JobError 0xFFFF in a Result(-) of iec2022. In a Result(-) of v1.1 two octets:
    /// ErrorInfo, numbered as in [`error_info`].
    pub octets: Vec<u8>,
}

/// ErrorInfo of v1.1. That edition names the values and gives no numbers; these are the contract's own.
pub mod error_info {
    /// OUT_OF_RANGE.
    pub const OUT_OF_RANGE: u16 = 1;
    /// STATE_CONFLICT.
    pub const STATE_CONFLICT: u16 = 2;
    /// NO_COM.
    pub const NO_COM: u16 = 3;
}

/// Error types of the SMI as JobError carries them (base standard; neither edition prints the numbers).
pub mod job_error {
    /// ARGBLOCK_NOT_SUPPORTED.
    pub const ARGBLOCK_NOT_SUPPORTED: u16 = 0x4001;
    /// ARGBLOCK_INCONSISTENT.
    pub const ARGBLOCK_INCONSISTENT: u16 = 0x4002;
    /// DEVICE_NOT_ACCESSIBLE.
    pub const DEVICE_NOT_ACCESSIBLE: u16 = 0x4003;
    /// SERVICE_NOT_SUPPORTED.
    pub const SERVICE_NOT_SUPPORTED: u16 = 0x4004;
    /// DEVICE_NOT_IN_OPERATE.
    pub const DEVICE_NOT_IN_OPERATE: u16 = 0x4005;
    /// MEMORY_OVERRUN.
    pub const MEMORY_OVERRUN: u16 = 0x4006;
    /// PORT_NUM_INVALID.
    pub const PORT_NUM_INVALID: u16 = 0x4011;
    /// ARGBLOCK_LENGTH_INVALID.
    pub const ARGBLOCK_LENGTH_INVALID: u16 = 0x4034;
    /// SERVICE_TEMP_UNAVAILABLE.
    pub const SERVICE_TEMP_UNAVAILABLE: u16 = 0x4036;
}
