//! The ArgBlocks of the SMI, octet by octet per edition (10.3), written by hand in the order of the tables.

use super::MasterMutant;
use fsct_protocol::fsp::{Authenticity, Protocol};
use fsct_protocol::{Edition, ProtMode};

/// ArgBlockIDs (v1.1 Table 19, iec2022 Table 18).
pub mod id {
    use fsct_protocol::Edition;

    /// VoidBlock.
    pub const VOID: u16 = 0xFFF0;
    /// JobError.
    pub const JOB_ERROR: u16 = 0xFFFF;
    /// FSPDInOut.
    pub const FS_PD_IN_OUT: u16 = 0x1103;
    /// FSCPAuthenticity.
    pub const FSCP_AUTHENTICITY: u16 = 0x0101;

    /// One of two, by edition.
    pub const fn of(edition: Edition, v1_1: u16, iec2022: u16) -> u16 {
        match edition {
            Edition::V1_1 => v1_1,
            Edition::Iec2022 => iec2022,
        }
    }
}

/// PortModes of FSPortConfigList.
pub mod port_mode {
    use fsct_protocol::Edition;

    /// DEACTIVATED.
    pub const DEACTIVATED: u8 = 0;
    /// IOL_MANUAL.
    pub const IOL_MANUAL: u8 = 1;
    /// IOL_AUTOSTART.
    pub const IOL_AUTOSTART: u8 = 2;
    /// DI_C/Q.
    pub const DI_CQ: u8 = 3;
    /// DO_C/Q.
    pub const DO_CQ: u8 = 4;
    /// SAFETYCOM.
    pub const SAFETYCOM: u8 = 49;
    /// MIXEDSAFETYCOM.
    pub const MIXEDSAFETYCOM: u8 = 50;
    /// OSSDE.
    pub const OSSDE: u8 = 51;

    /// Whether an edition has this one.
    pub fn exists(edition: Edition, port_mode: u8) -> bool {
        match port_mode {
            DEACTIVATED | IOL_MANUAL | IOL_AUTOSTART | DI_CQ | SAFETYCOM | MIXEDSAFETYCOM | OSSDE => true,
            DO_CQ => edition == Edition::Iec2022,
            _ => false,
        }
    }
}

/// A port configuration as it was received.
#[derive(Clone, Debug)]
pub struct PortConfig {
    /// The whole FSPortConfigList.
    pub octets: Vec<u8>,
    /// PortMode.
    pub port_mode: u8,
    /// Validation&Backup.
    pub validation: u8,
    /// PortCycleTime in the coding of the base standard; 0 is as fast as possible.
    pub cycle_time: u8,
    /// VendorID.
    pub vendor_id: u16,
    /// DeviceID.
    pub device_id: u32,
    /// Non-safety input and output octets; `None` where the edition leaves them to the Device.
    pub nsr: Option<(u8, u8)>,
    /// How long to wait for the Ready pulse, in milliseconds.
    pub time_to_ready_ms: u64,
    /// How long the supply of the port stays off, in milliseconds.
    pub off_ms: u64,
    /// FSP_VerifyRecord.
    pub record: Vec<u8>,
    /// FSP_AuthentCRC is the signature of the authenticity.
    pub authent_crc_right: bool,
    /// FSP_ProtParCRC is the signature of the protocol parameters.
    pub prot_par_crc_right: bool,
    /// Its authenticity, whatever its signature says.
    pub authenticity: Authenticity,
    /// Its protocol parameters, whatever their signature says.
    pub protocol: Protocol,
    /// SPDUInLength.
    pub spdu_in: u8,
    /// SPDUOutLength.
    pub spdu_out: u8,
}

/// Reads a block from its beginning.
struct Reader<'a>(&'a [u8]);

impl<'a> Reader<'a> {
    fn take(&mut self, count: usize) -> &'a [u8] {
        let (taken, rest) = self.0.split_at_checked(count).unwrap_or((self.0, &[]));
        self.0 = rest;
        taken
    }

    fn number(&mut self, octets: usize) -> u32 {
        self.take(octets).iter().fold(0, |value, octet| value << 8 | u32::from(*octet))
    }

    fn octet(&mut self) -> u8 {
        self.number(1) as u8
    }
}

/// Octets of FSPortConfigList.
pub const fn config_octets(edition: Edition) -> usize {
    match edition {
        Edition::V1_1 => 48,
        Edition::Iec2022 => 50,
    }
}

impl PortConfig {
    /// The supply stays off at least so long before a restart, in milliseconds (Annex G).
    pub const LEAST_OFF_MS: u64 = 1_000;

    /// Reads an FSPortConfigList of the right length; `None` when a value lies outside its range.
    pub fn read(edition: Edition, octets: &[u8], mutant: Option<MasterMutant>) -> Option<PortConfig> {
        let mut reader = Reader(octets);
        let _id = reader.take(2);
        let port_mode = match (reader.octet(), mutant) {
            (unknown, Some(MasterMutant::UnknownPortModeIsSafetycom)) if !port_mode::exists(edition, unknown) => {
                port_mode::SAFETYCOM
            }
            (port_mode, _) => port_mode,
        };
        let validation = reader.octet();
        let iq_behavior = reader.octet();
        let cycle_time = reader.octet();
        let vendor_id = reader.number(2) as u16;
        let device_id = reader.number(4);
        let (nsr, time_to_ready, min_shut_down) = match edition {
            Edition::V1_1 => (Some((reader.octet(), reader.octet())), 500, 100),
            Edition::Iec2022 => (None, reader.number(2), reader.number(2)),
        };
        let mut record = match mutant {
            Some(MasterMutant::WrongArgBlockOffset) if edition == Edition::Iec2022 => octets.get(14..37)?.to_vec(),
            _ => reader.0.get(..23)?.to_vec(),
        };
        match mutant {
            Some(MasterMutant::RecordAuthenticityZero) => record.get_mut(..8)?.fill(0),
            Some(MasterMutant::RecordPortZero) => record.get_mut(8..9)?.fill(0),
            Some(MasterMutant::RecordWatchdogSwapped) => record.get_mut(13..15)?.reverse(),
            Some(MasterMutant::RecordTechParCrcZero) => record.get_mut(17..21)?.fill(0),
            _ => {}
        }
        let fields = reader.take(23);
        let (authenticity, protocol) = fields.split_at_checked(Authenticity::OCTETS)?;
        let authent_crc_right = Authenticity::from_octets(authenticity).is_ok();
        let prot_par_crc_right = Protocol::from_octets(protocol).is_ok();
        let authenticity = Authenticity::fields(authenticity).ok()?;
        let protocol = Protocol::fields(protocol).ok()?;
        let io_desc_version = reader.octet();
        let spdu_in = reader.octet();
        let _in_totals = reader.take(4);
        let spdu_out = reader.octet();
        let config = PortConfig {
            octets: octets.to_vec(),
            port_mode,
            validation,
            cycle_time,
            vendor_id,
            device_id,
            nsr,
            time_to_ready_ms: u64::from(time_to_ready) * 10,
            off_ms: (u64::from(min_shut_down) * 10).max(PortConfig::LEAST_OFF_MS),
            record,
            authent_crc_right,
            prot_par_crc_right,
            authenticity,
            protocol,
            spdu_in,
            spdu_out,
        };
        let times = (time_to_ready, min_shut_down);
        let plausible = config.in_range(edition, iq_behavior, io_desc_version, times, mutant);
        plausible.then_some(config)
    }

    /// What a PortMode does not care for may have any value. Whether the FSP parameters are right is for the start of the SCL.
    fn in_range(
        &self,
        edition: Edition,
        iq_behavior: u8,
        io_desc_version: u8,
        times: (u32, u32),
        mutant: Option<MasterMutant>,
    ) -> bool {
        use port_mode::*;
        let known = exists(edition, self.port_mode);
        let iq = match (self.port_mode, edition) {
            (DEACTIVATED | DI_CQ | DO_CQ, _) | (OSSDE, Edition::Iec2022) => true,
            (_, Edition::V1_1) => matches!(iq_behavior, 0 | 5),
            (_, Edition::Iec2022) => matches!(iq_behavior, 0 | 1 | 5),
        };
        let validated = matches!(self.port_mode, IOL_MANUAL | SAFETYCOM | MIXEDSAFETYCOM);
        let ids = !validated || self.vendor_id != 0 && (1..=0x00FF_FFFF).contains(&self.device_id);
        let backup = !validated || self.validation <= 4;
        let safety = self.is_safety();
        let (time_to_ready, min_shut_down) = times;
        let waits = !safety
            || edition == Edition::V1_1
            || (1..=0x7FFF).contains(&time_to_ready) && (100..=1000).contains(&min_shut_down);
        let (nsr_in, nsr_out) = self.nsr.unwrap_or((0, 0));
        let nsr = self.port_mode == DEACTIVATED || nsr_in <= 32 && nsr_out <= 32;
        let ossde = self.port_mode != OSSDE || self.spdu_in == 1;
        let described = !safety || io_desc_version == 1;
        let octets = if mutant == Some(MasterMutant::NsrLimit31) && edition == Edition::V1_1 { 31 } else { 32 };
        let lengths = !safety
            || (4..=31).contains(&self.spdu_in)
                && (4..=31).contains(&self.spdu_out)
                && u16::from(self.spdu_in) + u16::from(nsr_in) <= octets
                && u16::from(self.spdu_out) + u16::from(nsr_out) <= octets;
        let port = !safety || self.authenticity.port != 0;
        known && iq && ids && backup && waits && nsr && ossde && described && lengths && port
    }

    /// SPDUInLength and SPDUOutLength where an SPDU is exchanged; else none.
    pub const fn spdu(&self) -> (u8, u8) {
        if self.is_safety() { (self.spdu_in, self.spdu_out) } else { (0, 0) }
    }

    /// Octets of PDin_M and PDout_M.
    pub fn pd(&self) -> (u8, u8) {
        let code = self.protocol.mode;
        let shortest = ProtMode::from_code(code).map_or(usize::MAX, |mode| mode.spdu_octets(0));
        let pd = |spdu: u8| usize::from(spdu).saturating_sub(shortest).min(ProtMode::Crc32.max_pd()) as u8;
        match self.port_mode {
            port_mode::OSSDE => (1, 0),
            _ => (pd(self.spdu().0), pd(self.spdu().1)),
        }
    }

    /// SAFETYCOM or MIXEDSAFETYCOM.
    pub const fn is_safety(&self) -> bool {
        matches!(self.port_mode, port_mode::SAFETYCOM | port_mode::MIXEDSAFETYCOM)
    }
}

/// What FSPortStatusList reports.
#[derive(Clone, Debug, Default)]
pub struct PortStatus {
    /// PortStatusInfo.
    pub info: u8,
    /// PortQualityInfo: bit 0 input invalid, bit 1 output invalid.
    pub quality: u8,
    /// RevisionID; 0 without communication.
    pub revision_id: u8,
    /// Transmission rate.
    pub transmission_rate: u8,
    /// MasterCycleTime.
    pub master_cycle_time: u8,
    /// Non-safety octets in and out.
    pub nsr: (u8, u8),
    /// VendorID.
    pub vendor_id: u16,
    /// DeviceID.
    pub device_id: u32,
    /// EventQualifier and EventCode of what is pending.
    pub diags: Vec<(u8, u16)>,
}

impl PortStatus {
    /// The ArgBlock.
    pub fn to_octets(&self, edition: Edition) -> Vec<u8> {
        let mut out = id::of(edition, 0x9001, 0x9100).to_be_bytes().to_vec();
        out.extend([self.info, self.quality, self.revision_id, self.transmission_rate, self.master_cycle_time]);
        match edition {
            Edition::V1_1 => out.push(0),
            Edition::Iec2022 => out.extend([self.nsr.0, self.nsr.1]),
        }
        out.extend(self.vendor_id.to_be_bytes());
        out.extend(self.device_id.to_be_bytes());
        out.push(self.diags.len().min(255) as u8);
        for (qualifier, code) in self.diags.iter().take(255) {
            out.push(*qualifier);
            out.extend(code.to_be_bytes());
        }
        out
    }
}

/// The authenticity the upper-level system has given: FSMasterAccess in v1.1, FSCPAuthenticity in iec2022.
pub fn authenticity(edition: Edition, fscp: [u8; 8]) -> Vec<u8> {
    [id::of(edition, 0x0001, id::FSCP_AUTHENTICITY).to_be_bytes().as_slice(), &fscp].concat()
}

/// MasterIdent (base standard): an FS-Master with so many ports.
pub fn master_ident(edition: Edition, ports: u8, mutant: Option<MasterMutant>) -> Vec<u8> {
    const VENDOR_ID: u16 = 0x04D2;
    const MASTER_ID: u32 = 1;
    const MASTER: u8 = 1;
    const FS_MASTER: u8 = 3;
    const PORT_TYPE_FS_WITH_OSSDE: u8 = 4;
    let mut out = id::of(edition, 0x0000, 0x0001).to_be_bytes().to_vec();
    out.extend(VENDOR_ID.to_be_bytes());
    out.extend(MASTER_ID.to_be_bytes());
    let master_type = if mutant == Some(MasterMutant::MasterTypeOfBase) { MASTER } else { FS_MASTER };
    out.extend([master_type, 0, 0, ports]);
    out.extend((0..ports).map(|_| PORT_TYPE_FS_WITH_OSSDE));
    out
}
