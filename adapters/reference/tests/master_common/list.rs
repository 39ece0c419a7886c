//! The FSPortConfigList of both editions, written in the order of its tables.

use super::{PORT, WATCHDOG_MS};
use fsct_adapters::{Identity, Variant};
use fsct_protocol::fsp::{Authenticity, Protocol};
use fsct_protocol::{Edition, ProtMode};

/// The values of an FSPortConfigList.
#[derive(Copy, Clone, Debug)]
pub struct List {
    pub edition: Edition,
    pub port_mode: u8,
    pub validation: u8,
    pub iq_behavior: u8,
    pub cycle_time: u8,
    pub vendor_id: u16,
    pub device_id: u32,
    /// v1.1: InputDataLength, OutputDataLength.
    pub nsr: (u8, u8),
    /// iec2022: FSP_TimeToReady, FSP_MinShutDownTime.
    pub times: (u16, u16),
    pub authenticity: Authenticity,
    pub protocol: Protocol,
    pub io_desc_version: u8,
    pub spdu_in: u8,
    pub spdu_out: u8,
}

/// SAFETYCOM, armed, right for a port of this variant.
pub fn list(variant: Variant) -> List {
    let mode = match variant.mode {
        ProtMode::Crc16 => 1,
        ProtMode::Crc32 => 2,
    };
    let spdu = |pd: u8| variant.mode.spdu_octets(pd.into()) as u8;
    List {
        edition: variant.edition,
        port_mode: 49,
        validation: 2,
        iq_behavior: 0,
        cycle_time: 0,
        vendor_id: 0x0136,
        device_id: 0x0A_BCDE,
        nsr: (0, 0),
        times: (300, 200),
        authenticity: Authenticity { authenticity_1: 0x1122_3344, authenticity_2: 0x5566_7788, port: PORT },
        protocol: Protocol {
            version: 1,
            mode,
            watchdog_ms: WATCHDOG_MS,
            io_struct_crc: 0x9A28,
            tech_par_crc: 0xCAFE_F00D,
        },
        io_desc_version: 1,
        spdu_in: spdu(variant.pd_in),
        spdu_out: spdu(variant.pd_out),
    }
}

impl List {
    pub fn record(&self) -> Vec<u8> {
        [self.authenticity.to_octets().as_slice(), &self.protocol.to_octets()].concat()
    }

    /// The ArgBlock, in the order of the table.
    pub fn octets(&self) -> Vec<u8> {
        let id: u16 = if self.edition == Edition::V1_1 { 0x8001 } else { 0x8100 };
        let mut out = id.to_be_bytes().to_vec();
        out.extend([self.port_mode, self.validation, self.iq_behavior, self.cycle_time]);
        out.extend(self.vendor_id.to_be_bytes());
        out.extend(self.device_id.to_be_bytes());
        match self.edition {
            Edition::V1_1 => out.extend([self.nsr.0, self.nsr.1]),
            Edition::Iec2022 => {
                out.extend(self.times.0.to_be_bytes());
                out.extend(self.times.1.to_be_bytes());
            }
        }
        out.extend(self.record());
        out.extend([self.io_desc_version, self.spdu_in, 13, 2, 1, 0, self.spdu_out, 0, 0, 0, 0]);
        out
    }

    pub fn identity(&self) -> Identity {
        Identity {
            revision_id: 0x11,
            com: 3,
            min_cycle_time: 20,
            pd_in: self.spdu_in + self.nsr.0,
            pd_out: self.spdu_out + self.nsr.1,
            vendor_id: self.vendor_id,
            device_id: self.device_id,
        }
    }
}
