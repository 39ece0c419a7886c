//! FSP records: authenticity, protocol and verify record with their signatures (Annex A, Tables A.1 to A.4).
//!
//! Every value of more than one octet is sent most significant octet first. The signatures of these blocks start at 0
//! and keep a computed 0.

use crate::Edition;
use crate::crc::{crc16, crc32};
use core::fmt;

/// Index of the authenticity record: 11 octets, read and write.
pub const INDEX_AUTHENTICITY: u16 = 0x4200;
/// Index of the protocol record: 12 octets, read and write.
pub const INDEX_PROTOCOL: u16 = 0x4201;
/// Index of the verify record: 23 octets, written once per start-up in PREOPERATE, Subindex 0, never read.
pub const INDEX_VERIFY: u16 = 0x4202;
/// Index of FSP_ParamDescCRC: 2 octets in v1.1, 4 in iec2022, read only.
pub const INDEX_PARAM_DESC_CRC: u16 = 0x4212;

/// Octets that are no FSP record.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum RecordError {
    /// Another number of octets.
    Length {
        /// Octets of the record.
        expected: usize,
        /// Octets that were there.
        found: usize,
    },
    /// The signature of a block is wrong.
    Signature {
        /// Computed over the octets.
        expected: u16,
        /// Received.
        found: u16,
    },
}

impl fmt::Display for RecordError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            RecordError::Length { expected, found } => write!(f, "the record has {expected} octets, {found} are there"),
            RecordError::Signature { expected, found } => {
                write!(f, "the signature of the block is {expected:04X}, {found:04X} was sent")
            }
        }
    }
}

impl core::error::Error for RecordError {}

/// Whether the last two octets of a block are the CRC-16 of those before, started at 0.
fn check(block: &[u8]) -> Result<(), RecordError> {
    let Some((secured, sent)) = block.split_last_chunk::<2>() else {
        return Err(RecordError::Length { expected: 2, found: block.len() });
    };
    let (expected, found) = (crc16(0, secured), u16::from_be_bytes(*sent));
    if expected == found { Ok(()) } else { Err(RecordError::Signature { expected, found }) }
}

/// The octets as an array of the length a record has.
fn exactly<const N: usize>(octets: &[u8]) -> Result<&[u8; N], RecordError> {
    octets.try_into().map_err(|_| RecordError::Length { expected: N, found: octets.len() })
}

/// FSP_Authenticity (Index 0x4200, A.2.1 to A.2.3).
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq, Hash)]
pub struct Authenticity {
    /// FSP_Authenticity_1: A-Code of the FSCP.
    pub authenticity_1: u32,
    /// FSP_Authenticity_2: extended A-Code.
    pub authenticity_2: u32,
    /// FSP_Port: 1..255; 0 is "not assigned".
    pub port: u8,
}

impl Authenticity {
    /// Octets of the record, FSP_AuthentCRC included.
    pub const OCTETS: usize = 11;

    /// The record with its signature.
    pub fn to_octets(&self) -> [u8; Authenticity::OCTETS] {
        let [a, b, c, d] = self.authenticity_1.to_be_bytes();
        let [e, f, g, h] = self.authenticity_2.to_be_bytes();
        let [high, low] = self.signature().to_be_bytes();
        [a, b, c, d, e, f, g, h, self.port, high, low]
    }

    /// FSP_AuthentCRC: CRC-16 from 0 over the 9 octets of the values (A.2.3).
    pub fn signature(&self) -> u16 {
        let [a, b, c, d] = self.authenticity_1.to_be_bytes();
        let [e, f, g, h] = self.authenticity_2.to_be_bytes();
        crc16(0, &[a, b, c, d, e, f, g, h, self.port])
    }

    /// The values, whatever the signature says.
    ///
    /// # Errors
    /// [`RecordError::Length`].
    pub fn fields(octets: &[u8]) -> Result<Authenticity, RecordError> {
        let [a, b, c, d, e, f, g, h, port, _, _] = *exactly::<{ Authenticity::OCTETS }>(octets)?;
        Ok(Authenticity {
            authenticity_1: u32::from_be_bytes([a, b, c, d]),
            authenticity_2: u32::from_be_bytes([e, f, g, h]),
            port,
        })
    }

    /// The values of a record with right signature.
    ///
    /// # Errors
    /// [`RecordError`].
    pub fn from_octets(octets: &[u8]) -> Result<Authenticity, RecordError> {
        let fields = Authenticity::fields(octets)?;
        check(octets)?;
        Ok(fields)
    }
}

/// FSP_Protocol (Index 0x4201, A.2.4 to A.2.9).
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq, Hash)]
pub struct Protocol {
    /// FSP_ProtVersion: 1.
    pub version: u8,
    /// FSP_ProtMode as sent; [`crate::ProtMode::from_code`] reads it.
    pub mode: u8,
    /// FSP_Watchdog in milliseconds, 1..65535; 0 is not permitted.
    pub watchdog_ms: u16,
    /// FSP_IO_StructCRC.
    pub io_struct_crc: u16,
    /// FSP_TechParCRC; 0 means commissioning.
    pub tech_par_crc: u32,
}

impl Protocol {
    /// Octets of the record, FSP_ProtParCRC included.
    pub const OCTETS: usize = 12;

    fn secured(&self) -> [u8; 10] {
        let [a, b] = self.watchdog_ms.to_be_bytes();
        let [c, d] = self.io_struct_crc.to_be_bytes();
        let [e, f, g, h] = self.tech_par_crc.to_be_bytes();
        [self.version, self.mode, a, b, c, d, e, f, g, h]
    }

    /// The record with its signature.
    pub fn to_octets(&self) -> [u8; Protocol::OCTETS] {
        let [a, b, c, d, e, f, g, h, i, j] = self.secured();
        let [high, low] = self.signature().to_be_bytes();
        [a, b, c, d, e, f, g, h, i, j, high, low]
    }

    /// FSP_ProtParCRC: CRC-16 from 0 over the 10 octets of the values (A.2.9).
    pub fn signature(&self) -> u16 {
        crc16(0, &self.secured())
    }

    /// The values, whatever the signature says.
    ///
    /// # Errors
    /// [`RecordError::Length`].
    pub fn fields(octets: &[u8]) -> Result<Protocol, RecordError> {
        let [version, mode, a, b, c, d, e, f, g, h, _, _] = *exactly::<{ Protocol::OCTETS }>(octets)?;
        Ok(Protocol {
            version,
            mode,
            watchdog_ms: u16::from_be_bytes([a, b]),
            io_struct_crc: u16::from_be_bytes([c, d]),
            tech_par_crc: u32::from_be_bytes([e, f, g, h]),
        })
    }

    /// The values of a record with right signature.
    ///
    /// # Errors
    /// [`RecordError`].
    pub fn from_octets(octets: &[u8]) -> Result<Protocol, RecordError> {
        let fields = Protocol::fields(octets)?;
        check(octets)?;
        Ok(fields)
    }
}

/// FSP_VerifyRecord (Index 0x4202, A.2.10): authenticity and protocol record in a row.
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq, Hash)]
pub struct VerifyRecord {
    /// Octets 0..10.
    pub authenticity: Authenticity,
    /// Octets 11..22.
    pub protocol: Protocol,
}

impl VerifyRecord {
    /// Octets of the record.
    pub const OCTETS: usize = Authenticity::OCTETS + Protocol::OCTETS;

    /// The record with both signatures.
    pub fn to_octets(&self) -> [u8; VerifyRecord::OCTETS] {
        let mut octets = [0; VerifyRecord::OCTETS];
        let parts = self.authenticity.to_octets().into_iter().chain(self.protocol.to_octets());
        octets.iter_mut().zip(parts).for_each(|(octet, part)| *octet = part);
        octets
    }

    /// The octets of the two blocks.
    ///
    /// # Errors
    /// [`RecordError::Length`].
    pub fn split(octets: &[u8]) -> Result<(&[u8], &[u8]), RecordError> {
        exactly::<{ VerifyRecord::OCTETS }>(octets)?;
        let short = RecordError::Length { expected: VerifyRecord::OCTETS, found: octets.len() };
        octets.split_at_checked(Authenticity::OCTETS).ok_or(short)
    }

    /// The values of a record with right signatures.
    ///
    /// # Errors
    /// [`RecordError`]; the authenticity block is checked first.
    pub fn from_octets(octets: &[u8]) -> Result<VerifyRecord, RecordError> {
        let (authenticity, protocol) = VerifyRecord::split(octets)?;
        Ok(VerifyRecord {
            authenticity: Authenticity::from_octets(authenticity)?,
            protocol: Protocol::from_octets(protocol)?,
        })
    }
}

/// The FS I/O structure description (Table A.4).
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq, Hash)]
pub struct IoStructure {
    /// IO_DescVersion: 1.
    pub version: u8,
    /// Towards the FS-Master.
    pub input: IoTotals,
    /// Towards the FS-Device.
    pub output: IoTotals,
}

/// One direction of the FS I/O structure.
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq, Hash)]
pub struct IoTotals {
    /// Length of the SPDU in octets.
    pub range: u8,
    /// Number of BooleanT values.
    pub bits: u8,
    /// Octets that hold them.
    pub octets: u8,
    /// Number of IntegerT(16) values.
    pub int16: u8,
    /// Number of IntegerT(32) values.
    pub int32: u8,
}

impl IoStructure {
    /// FSP_IO_StructCRC: CRC-16 from 0 over the 11 items in the order of Table A.4 (A.2.7).
    pub fn signature(&self) -> u16 {
        let side = |t: IoTotals| [t.range, t.bits, t.octets, t.int16, t.int32];
        let ([a, b, c, d, e], [f, g, h, i, j]) = (side(self.input), side(self.output));
        crc16(0, &[self.version, a, b, c, d, e, f, g, h, i, j])
    }
}

/// FSP_ParamDescCRC over the serialised parameter description (E.5.1): CRC-16 in v1.1, CRC-32 in iec2022.
pub fn param_desc_crc(edition: Edition, serialised: &[u8]) -> u32 {
    match edition {
        Edition::V1_1 => crc16(0, serialised).into(),
        Edition::Iec2022 => crc32(0, serialised),
    }
}
