//! Data Storage of the reference FS-Device: Index 0x0003 of the base standard over the blocks 0x4200 and 0x4201 and the
//! technology parameter.
//!
//! A download is adopted only by a device whose authenticity and port are 0, and only at its end. One in use answers
//! its start with [`error_type::TEMPORARILY_UNAVAILABLE`] (iec2022, Table 13 T8), or takes and ignores it (v1.1, which
//! defines no code). An upload is always answered: arming needs it.

use crate::parameters::error_type;
use crate::technology::{self, Technology};
use fsct_protocol::Edition;
use fsct_protocol::crc::crc32;
use fsct_protocol::fsp::{Authenticity, INDEX_AUTHENTICITY, INDEX_PROTOCOL, Protocol};

/// Index of the Data Storage object.
pub const INDEX: u16 = 0x0003;

/// All of them with Index, Subindex and length of each.
const SIZE: u32 = (3 * 4 + Authenticity::OCTETS + Protocol::OCTETS + 4) as u32;

/// What one download or the device itself holds.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Blocks {
    /// Index 0x4200.
    pub authenticity: Authenticity,
    /// Index 0x4201.
    pub protocol: Protocol,
    /// The technology parameter.
    pub technology: Technology,
}

/// The transfer that is under way.
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq)]
pub enum Transfer {
    /// None.
    #[default]
    Inactive,
    /// The FS-Master reads.
    Upload,
    /// The FS-Master writes; these blocks are adopted at the end.
    Download(Blocks),
    /// The FS-Master writes to a device in use: nothing is kept.
    Ignored,
}

impl Transfer {
    /// Carries out DS_Command; the blocks to be adopted, if this was the end of a download.
    ///
    /// # Errors
    /// An ErrorType; the transfer is as before.
    pub fn command(
        &mut self,
        code: u8,
        edition: Edition,
        stored: Blocks,
        back_to_box: bool,
    ) -> Result<Option<Blocks>, u16> {
        let (next, adopted) = match (code, *self) {
            (0x01, _) => (Transfer::Upload, None),
            (0x02, Transfer::Upload) | (0x04, Transfer::Ignored) | (0x05, _) => (Transfer::Inactive, None),
            (0x03, _) if back_to_box => (Transfer::Download(stored), None),
            (0x03, _) if edition == Edition::V1_1 => (Transfer::Ignored, None),
            (0x03, _) => return Err(error_type::TEMPORARILY_UNAVAILABLE),
            (0x04, Transfer::Download(blocks)) => (Transfer::Inactive, Some(blocks)),
            (0x02 | 0x04, _) => return Err(error_type::FUNCTION_UNAVAILABLE),
            _ => return Err(error_type::VALUE_OUT_OF_RANGE),
        };
        *self = next;
        Ok(adopted)
    }

    /// Reads State_Property, Data_Storage_Size, Parameter_Checksum or Index_List.
    ///
    /// # Errors
    /// An ErrorType.
    pub fn read(&self, subindex: u8, stored: &Blocks) -> Result<Vec<u8>, u16> {
        match subindex {
            1 => Err(error_type::ACCESS_DENIED),
            2 => Ok(vec![match self {
                Transfer::Inactive => 0b000,
                Transfer::Upload => 0b010,
                Transfer::Download(_) | Transfer::Ignored => 0b100,
            }]),
            3 => Ok(SIZE.to_be_bytes().to_vec()),
            4 => {
                let (authenticity, protocol) = (stored.authenticity.to_octets(), stored.protocol.to_octets());
                let blocks = [&authenticity[..], &protocol[..], &stored.technology.0[..]].concat();
                Ok(crc32(0, &blocks).to_be_bytes().to_vec())
            }
            5 => {
                let [auth_1, auth_0] = INDEX_AUTHENTICITY.to_be_bytes();
                let [prot_1, prot_0] = INDEX_PROTOCOL.to_be_bytes();
                let [tech_1, tech_0] = technology::INDEX.to_be_bytes();
                // Ends with Index 0.
                Ok(vec![auth_1, auth_0, 0, prot_1, prot_0, 0, tech_1, tech_0, 0, 0, 0])
            }
            _ => Err(error_type::SUBINDEX_NOT_AVAILABLE),
        }
    }
}
