//! The two CRC signatures of IO-Link Safety (11.4.7, Annex D).
//!
//! Most significant bit first, no reflection, no final inversion, nothing appended. SPDUs start the register at 1,
//! parameter blocks at 0.

use crate::ProtMode;
use crc::{Algorithm, Crc, Table};

const CRC_16: Algorithm<u16> =
    Algorithm { width: 16, poly: 0x4EAB, init: 0, refin: false, refout: false, xorout: 0, check: 0xCEA5, residue: 0 };
const CRC_32: Algorithm<u32> = Algorithm {
    width: 32,
    poly: 0xF4AC_FB13,
    init: 0,
    refin: false,
    refout: false,
    xorout: 0,
    check: 0x6C9F_84A8,
    residue: 0,
};

static TABLE_16: Crc<u16, Table<1>> = Crc::<u16, Table<1>>::new(&CRC_16);
static TABLE_32: Crc<u32, Table<1>> = Crc::<u32, Table<1>>::new(&CRC_32);

/// CRC-16 (generator 0x4EAB) over `octets`, the register starting at `seed` (D.3.2).
pub fn crc16(seed: u16, octets: &[u8]) -> u16 {
    let mut digest = TABLE_16.digest_with_initial(seed);
    digest.update(octets);
    digest.finalize()
}

/// CRC-32 (generator 0xF4ACFB13) over `octets`, the register starting at `seed` (D.3.4).
pub fn crc32(seed: u32, octets: &[u8]) -> u32 {
    let mut digest = TABLE_32.digest_with_initial(seed);
    digest.update(octets);
    digest.finalize()
}

/// What the start value 1 of the SPDU signature means; the texts allow more than one reading (tolerances A02, A03).
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Reading {
    /// The register holds 1 before the first octet. The default.
    #[default]
    Preset,
    /// The register holds 0 and an octet 0x01 is fed first (A02).
    LeadingOctet,
    /// Register preset, and the signature field is fed as zero octets too (A03).
    FieldFed,
}

/// The signature of an SPDU over `secured` (FS process data, PortNum, control or status octet), in the low bits.
/// A computed 0 becomes 1 (11.4.7).
pub fn signature(mode: ProtMode, reading: Reading, secured: &[u8]) -> u32 {
    let one = |value: u32| if value == 0 { 1 } else { value };
    one(match (mode, reading) {
        (ProtMode::Crc16, Reading::Preset) => crc16(1, secured).into(),
        (ProtMode::Crc32, Reading::Preset) => crc32(1, secured),
        // A leading 01 fed into a register of 0 leaves the generator in the register.
        (ProtMode::Crc16, Reading::LeadingOctet) => crc16(0x4EAB, secured).into(),
        (ProtMode::Crc32, Reading::LeadingOctet) => crc32(0xF4AC_FB13, secured),
        (ProtMode::Crc16, Reading::FieldFed) => crc16(crc16(1, secured), &[0; 2]).into(),
        (ProtMode::Crc32, Reading::FieldFed) => crc32(crc32(1, secured), &[0; 4]),
    })
}
