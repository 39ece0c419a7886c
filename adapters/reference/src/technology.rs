//! The one technology parameter (FST) of the reference FS-Device, and its signature FSP_TechParCRC (A.2.8).

use fsct_protocol::crc::crc32;

/// Index of the parameter: the first that is free for makers.
pub const INDEX: u16 = 0x0040;

/// The parameter: four octets, all 0 from the factory.
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq)]
pub struct Technology(pub [u8; 4]);

impl Technology {
    /// CRC-32 over the parameter; 0 becomes 1, because 0 means commissioning.
    pub fn signature(self) -> u32 {
        crc32(0, &self.0).max(1)
    }
}

#[cfg(test)]
mod tests {
    use super::Technology;

    #[test]
    fn a_signature_of_0_becomes_1_and_another_value_has_another() {
        assert_eq!(Technology::default().signature(), 1);
        assert!(Technology([0, 0, 0, 7]).signature() > 1);
    }
}
