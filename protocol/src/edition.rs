//! The two editions that count, and the two protocol modes both of them share.

use core::fmt;
use core::str::FromStr;

/// An edition of the IO-Link Safety specification.
///
/// A value wherever the editions could differ; the differences themselves stand in the tables that need them.
#[derive(Copy, Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Edition {
    /// IO-Link Safety System Extensions with SMI, V1.1.
    V1_1,
    /// IEC 61139-2:2022.
    Iec2022,
}

impl Edition {
    /// Both editions, the older first.
    pub const ALL: [Edition; 2] = [Edition::V1_1, Edition::Iec2022];

    /// The name used in cases, reports and on the command line.
    pub const fn name(self) -> &'static str {
        match self {
            Edition::V1_1 => "v1.1",
            Edition::Iec2022 => "iec2022",
        }
    }
}

impl fmt::Display for Edition {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// A text that names neither edition nor mode.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct UnknownName;

impl fmt::Display for UnknownName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("unknown name")
    }
}

impl core::error::Error for UnknownName {}

impl FromStr for Edition {
    type Err = UnknownName;

    fn from_str(text: &str) -> Result<Self, UnknownName> {
        Edition::ALL.into_iter().find(|edition| edition.name() == text).ok_or(UnknownName)
    }
}

/// FSP_ProtMode: which signature secures the SPDU, and with it how much process data fits (A.2.5).
#[derive(Copy, Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum ProtMode {
    /// 0x01: CRC-16, 0..3 octets of FS process data.
    Crc16,
    /// 0x02: CRC-32, 0..25 octets of FS process data.
    Crc32,
}

impl ProtMode {
    /// Both modes, the shorter signature first.
    pub const ALL: [ProtMode; 2] = [ProtMode::Crc16, ProtMode::Crc32];

    /// The name used in cases, reports and on the command line.
    pub const fn name(self) -> &'static str {
        match self {
            ProtMode::Crc16 => "crc16",
            ProtMode::Crc32 => "crc32",
        }
    }

    /// The value of FSP_ProtMode (A.2.5, one octet).
    pub const fn code(self) -> u8 {
        match self {
            ProtMode::Crc16 => 0x01,
            ProtMode::Crc32 => 0x02,
        }
    }

    /// The mode of a received FSP_ProtMode; `None` for the reserved values and the test mirrors.
    pub const fn from_code(code: u8) -> Option<ProtMode> {
        match code {
            0x01 => Some(ProtMode::Crc16),
            0x02 => Some(ProtMode::Crc32),
            _ => None,
        }
    }

    /// Octets of the signature: 2 or 4.
    pub const fn signature_octets(self) -> usize {
        match self {
            ProtMode::Crc16 => 2,
            ProtMode::Crc32 => 4,
        }
    }

    /// The most FS process data an SPDU carries in this mode, in octets (11.4.3).
    pub const fn max_pd(self) -> usize {
        match self {
            ProtMode::Crc16 => 3,
            ProtMode::Crc32 => 25,
        }
    }

    /// Length in octets of an SPDU with `pd` octets of FS process data: 4..7 or 6..31 (11.4.7).
    pub const fn spdu_octets(self, pd: usize) -> usize {
        pd + 2 + self.signature_octets()
    }
}

impl fmt::Display for ProtMode {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for ProtMode {
    type Err = UnknownName;

    fn from_str(text: &str) -> Result<Self, UnknownName> {
        ProtMode::ALL.into_iter().find(|mode| mode.name() == text).ok_or(UnknownName)
    }
}
