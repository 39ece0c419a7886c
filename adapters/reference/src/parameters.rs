//! The on-request data of the reference FS-Device: the Indices of Table A.1, the reset commands (E.3.3; v1.1: E.3.2)
//! and the checks at FSP_VerifyRecord.
//!
//! The authenticity and protocol blocks survive power cycles. The checks are the same whether FSP_TechParCRC is 0 or not:
//! 11.5.7 lets no deviating block start the SCL, and Table E.2 (v1.1: E.3) no default authenticity. An armed device compares
//! FSP_TechParCRC with the signature over its technology parameter as well.

use crate::Mutant;
use crate::storage::{self, Blocks, Transfer};
use crate::technology::{self, Technology};
use fsct_adapters::Variant;
use fsct_protocol::Edition;
use fsct_protocol::crc::{crc16, crc32};
use fsct_protocol::fsp::{Authenticity, INDEX_AUTHENTICITY, INDEX_PROTOCOL, INDEX_VERIFY, Protocol};
use fsct_protocol::spdu::Port;

/// ErrorTypes of the base standard: why a read or write is refused.
pub mod error_type {
    /// The Index does not exist.
    pub const INDEX_NOT_AVAILABLE: u16 = 0x8011;
    /// The Subindex does not exist.
    pub const SUBINDEX_NOT_AVAILABLE: u16 = 0x8012;
    /// The service is not available at the moment, because the device controls itself.
    pub const TEMPORARILY_UNAVAILABLE: u16 = 0x8022;
    /// Not readable, or not writable.
    pub const ACCESS_DENIED: u16 = 0x8023;
    /// A value is not permitted, or the signature of a block is wrong.
    pub const VALUE_OUT_OF_RANGE: u16 = 0x8030;
    /// More octets than the object has.
    pub const LENGTH_OVERRUN: u16 = 0x8033;
    /// Fewer octets than the object has.
    pub const LENGTH_UNDERRUN: u16 = 0x8034;
    /// The command does not exist.
    pub const FUNCTION_NOT_AVAILABLE: u16 = 0x8035;
    /// Not in this state of the device.
    pub const FUNCTION_UNAVAILABLE: u16 = 0x8036;
    /// No communication: the device has no power.
    pub const COM_ERR: u16 = 0x1000;
}

/// EventCodes of Table B.1 at start-up; all are Errors.
pub mod event_code {
    /// Unexpected authentication code.
    pub const AUTHENTICITY: u16 = 0xB003;
    /// Unexpected authentication port.
    pub const PORT: u16 = 0xB004;
    /// Incorrect FSP_AuthentCRC.
    pub const AUTHENT_CRC: u16 = 0xB005;
    /// Incorrect FSP_ProtParCRC; stands for a version, mode or watchdog other than the stored one too.
    pub const PROT_PAR_CRC: u16 = 0xB006;
    /// Incorrect FSP_TechParCRC.
    pub const TECH_PAR_CRC: u16 = 0xB007;
    /// Incorrect FSP_IO_StructCRC.
    pub const IO_STRUCT_CRC: u16 = 0xB008;
    /// Watchdog time out of specification.
    pub const WATCHDOG: u16 = 0xB009;
    /// No FSP_VerifyRecord received (iec2022).
    pub const NO_VERIFY_RECORD: u16 = 0xB00A;
}

/// Indices of Table A.1 beside those of the FSP records, and of the base standard.
mod index {
    /// SystemCommand.
    pub const SYSTEM_COMMAND: u16 = 0x0002;
    /// Device Access Lock.
    pub const ACCESS_LOCK: u16 = 0x000C;
    /// ProfileCharacteristic.
    pub const PROFILES: u16 = 0x000D;
    /// FS_Password (v1.1), FSP_TimeToReady (iec2022).
    pub const TIME_TO_READY: u16 = 0x4210;
    /// Reset_FS_Password (v1.1), FSP_MinShutDownTime (iec2022).
    pub const MIN_SHUT_DOWN_TIME: u16 = 0x4211;
    /// FSP_ParamDescCRC.
    pub const PARAM_DESC_CRC: u16 = 0x4212;
    /// FSP_WCDT (iec2022).
    pub const WCDT: u16 = 0x4213;
    /// FSP_OFDT (iec2022).
    pub const OFDT: u16 = 0x4214;
}

const PROT_VERSION: u8 = 0x01;
const DEFAULT_WATCHDOG_MS: u16 = 100;
const WATCHDOG_RANGE_MS: (u16, u16) = (1, u16::MAX);
/// In units of 10 ms: 500 ms.
const TIME_TO_READY: u16 = 50;
/// In units of 10 ms: 1 s.
const MIN_SHUT_DOWN_TIME: u16 = 100;
const WCDT_MS: u16 = 10;
const OFDT_MS: u16 = 20;
const PASSWORD_OCTETS: usize = 32;
/// ProfileID of IO-Link Safety.
const PROFILE_ID: u16 = 0x4001;
/// Octets of each Subindex of 0x4200, from 1.
const AUTHENTICITY_ITEMS: [usize; 4] = [4, 4, 1, 2];
/// Octets of each Subindex of 0x4201, from 1.
const PROTOCOL_ITEMS: [usize; 6] = [1, 1, 2, 2, 4, 2];
const AUTHENTICITY_OCTETS: usize = 11;
const VERIFY_OCTETS: usize = 23;

/// What FSP_VerifyRecord gives to the SCL when it is as stored.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Verified {
    /// FSP_Port.
    pub port: Port,
    /// FSP_Watchdog in milliseconds, not 0.
    pub watchdog_ms: u16,
}

/// What a write that was carried out means to the rest of the device.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Written {
    /// A stored block was replaced: an earlier verification holds no more.
    Block,
    /// FSP_VerifyRecord is as stored.
    Verified(Verified),
    /// FSP_VerifyRecord deviates: the EventCode for its authenticity and the one for its protocol block.
    Deviating([Option<u16>; 2]),
    /// Nothing.
    Nothing,
}

/// The parameter memory.
#[derive(Clone, Debug)]
pub struct Parameters {
    variant: Variant,
    mutant: Option<Mutant>,
    authenticity: Authenticity,
    protocol: Protocol,
    technology: Technology,
    transfer: Transfer,
}

impl Parameters {
    /// The factory setting (Table G.1) of a device that is this variant.
    pub fn factory(variant: Variant, mutant: Option<Mutant>) -> Parameters {
        Parameters {
            variant,
            mutant,
            authenticity: Authenticity { authenticity_1: 0, authenticity_2: 0, port: 0 },
            protocol: Protocol {
                version: PROT_VERSION,
                mode: variant.mode.code(),
                watchdog_ms: DEFAULT_WATCHDOG_MS,
                io_struct_crc: io_struct_crc(variant, mutant),
                tech_par_crc: if mutant == Some(Mutant::FactoryTechParCrc0) {
                    0
                } else {
                    Technology::default().signature()
                },
            },
            technology: Technology::default(),
            transfer: Transfer::Inactive,
        }
    }

    /// Whether the technology parameter is the one FSP_TechParCRC was made for; in commissioning it always is.
    pub fn technology_fits(&self) -> bool {
        matches!(self.protocol.tech_par_crc, 0) || self.protocol.tech_par_crc == self.technology.signature()
    }

    /// The supply is gone: so is a transfer that was under way.
    pub fn power_off(&mut self) {
        self.transfer = Transfer::Inactive;
    }

    /// Reads an Index; Subindex 0 is the whole object.
    ///
    /// # Errors
    /// An ErrorType, see [`error_type`].
    pub fn read(&self, index: u16, subindex: u8) -> Result<Vec<u8>, u16> {
        let edition = self.variant.edition;
        match index {
            INDEX_AUTHENTICITY if self.is(Mutant::AuthenticityReadReversed) => {
                let authenticity_1 = self.authenticity.authenticity_1.swap_bytes();
                let reversed = Authenticity { authenticity_1, ..self.authenticity };
                item(&reversed.to_octets(), &AUTHENTICITY_ITEMS, subindex)
            }
            INDEX_AUTHENTICITY => item(&self.authenticity.to_octets(), &AUTHENTICITY_ITEMS, subindex),
            INDEX_PROTOCOL if self.is(Mutant::ProtocolReadShort) => {
                item(&self.protocol.to_octets()[..10], &PROTOCOL_ITEMS, subindex)
            }
            INDEX_PROTOCOL => item(&self.protocol.to_octets(), &PROTOCOL_ITEMS, subindex),
            INDEX_VERIFY if self.is(Mutant::RecordReadable) => {
                Ok([&self.authenticity.to_octets()[..], &self.protocol.to_octets()[..]].concat())
            }
            INDEX_VERIFY => Err(error_type::ACCESS_DENIED),
            index::PARAM_DESC_CRC => {
                let described =
                    param_desc(self.variant.mode.code(), WATCHDOG_RANGE_MS, io_struct_crc(self.variant, None));
                let short = (edition == Edition::V1_1) != self.is(Mutant::ParamDescCrcOfOtherEdition);
                match short {
                    true => item(&crc16(0, &described).to_be_bytes(), &[], subindex),
                    false => item(&crc32(0, &described).to_be_bytes(), &[], subindex),
                }
            }
            index::TIME_TO_READY if edition == Edition::V1_1 && self.is(Mutant::PasswordReadable) => {
                Ok(vec![0; PASSWORD_OCTETS])
            }
            index::TIME_TO_READY | index::MIN_SHUT_DOWN_TIME if edition == Edition::V1_1 => {
                Err(error_type::ACCESS_DENIED)
            }
            index::MIN_SHUT_DOWN_TIME if self.is(Mutant::MinShutDownTimeShort) => item(&[0, 50], &[], subindex),
            index::OFDT if self.is(Mutant::OfdtMissing) => Err(error_type::INDEX_NOT_AVAILABLE),
            index::TIME_TO_READY => item(&TIME_TO_READY.to_be_bytes(), &[], subindex),
            index::MIN_SHUT_DOWN_TIME => item(&MIN_SHUT_DOWN_TIME.to_be_bytes(), &[], subindex),
            index::WCDT if edition == Edition::Iec2022 => item(&WCDT_MS.to_be_bytes(), &[], subindex),
            index::OFDT if edition == Edition::Iec2022 => item(&OFDT_MS.to_be_bytes(), &[], subindex),
            storage::INDEX => self.transfer.read(subindex, &self.blocks()),
            technology::INDEX => item(&self.technology.0, &[4], subindex),
            index::SYSTEM_COMMAND => Err(error_type::ACCESS_DENIED),
            index::ACCESS_LOCK => item(&[0, if self.is(Mutant::AccessLocked) { 2 } else { 0 }], &[], subindex),
            index::PROFILES if self.is(Mutant::ProfileMissing) => item(&[0, 1], &[2], subindex),
            index::PROFILES => item(&PROFILE_ID.to_be_bytes(), &[2], subindex),
            _ => Err(error_type::INDEX_NOT_AVAILABLE),
        }
    }

    /// Writes an Index; `operate` says that process data have been exchanged since power-on, from when on the FSP
    /// records stand. Blocks are written whole, and a refused write changes nothing.
    ///
    /// # Errors
    /// An ErrorType, see [`error_type`].
    pub fn write(&mut self, index: u16, subindex: u8, data: &[u8], operate: bool) -> Result<Written, u16> {
        match index {
            INDEX_AUTHENTICITY => {
                block(subindex, data, &AUTHENTICITY_ITEMS)?;
                before(operate)?;
                self.write_authenticity(data)
            }
            INDEX_PROTOCOL => {
                block(subindex, data, &PROTOCOL_ITEMS)?;
                before(operate)?;
                self.write_protocol(data)
            }
            INDEX_VERIFY if subindex != 0 && self.is(Mutant::RecordBySubindex) => Ok(Written::Nothing),
            INDEX_VERIFY => {
                whole(subindex)?;
                let most = if self.is(Mutant::RecordOf24Octets) { VERIFY_OCTETS + 1 } else { VERIFY_OCTETS };
                of_length(data, VERIFY_OCTETS, most)?;
                before(operate)?;
                let data = data.get(..VERIFY_OCTETS).unwrap_or(data);
                Ok(self.verify(data))
            }
            index::TIME_TO_READY | index::MIN_SHUT_DOWN_TIME if self.variant.edition == Edition::V1_1 => {
                // Passwords guard technology parameters, of which there are none: checked, not kept.
                whole(subindex)?;
                of_length(data, 1, PASSWORD_OCTETS)?;
                if data.is_ascii() { Ok(Written::Nothing) } else { Err(error_type::VALUE_OUT_OF_RANGE) }
            }
            index::TIME_TO_READY if self.is(Mutant::TimeToReadyWritable) => Ok(Written::Nothing),
            index::WCDT if self.is(Mutant::WcdtWritable) => Ok(Written::Nothing),
            storage::INDEX if subindex == 1 => {
                let (blocks, free) = (self.blocks(), self.back_to_box());
                let adopted = self.transfer.command(only(data)?, self.variant.edition, blocks, free);
                let adopted = adopted.map_err(|error| match error {
                    error_type::TEMPORARILY_UNAVAILABLE if self.is(Mutant::DownloadRefusedOtherwise) => {
                        error_type::FUNCTION_UNAVAILABLE
                    }
                    error => error,
                })?;
                Ok(adopted.map_or(Written::Nothing, |blocks| self.keep(blocks)))
            }
            technology::INDEX => {
                whole(subindex)?;
                of_length(data, 4, 4)?;
                let value = data.try_into().map_err(|_| error_type::LENGTH_UNDERRUN)?;
                if self.is(Mutant::TechnologyForgotten) {
                    return Ok(Written::Nothing);
                }
                Ok(self.take_without_restart(|blocks| blocks.technology = Technology(value)))
            }
            index::SYSTEM_COMMAND => {
                whole(subindex)?;
                self.reset(only(data)?)?;
                // A running SCL goes on with what was verified until the next start-up.
                Ok(if operate { Written::Nothing } else { Written::Block })
            }
            _ => {
                self.read(index, subindex)?;
                Err(error_type::ACCESS_DENIED)
            }
        }
    }

    fn write_authenticity(&mut self, data: &[u8]) -> Result<Written, u16> {
        let block = Authenticity::from_octets(data).map_err(|_| error_type::VALUE_OUT_OF_RANGE)?;
        // Port 0 is not accepted (A.2.2), except with authenticity 0: that resets the block for reuse elsewhere.
        if block.port == 0 && !unassigned(&block) {
            return Err(error_type::VALUE_OUT_OF_RANGE);
        }
        Ok(self.take(|blocks| blocks.authenticity = block))
    }

    fn write_protocol(&mut self, data: &[u8]) -> Result<Written, u16> {
        let block = Protocol::from_octets(data).map_err(|_| error_type::VALUE_OUT_OF_RANGE)?;
        if !self.supports(&block) || block.watchdog_ms == 0 {
            return Err(error_type::VALUE_OUT_OF_RANGE);
        }
        Ok(self.take(|blocks| blocks.protocol = block))
    }

    /// Puts a block where it belongs: into the memory, or into the download under way.
    fn take(&mut self, change: impl FnOnce(&mut Blocks)) -> Written {
        match &mut self.transfer {
            Transfer::Ignored => Written::Nothing,
            Transfer::Download(_) if self.mutant == Some(Mutant::DownloadNotAdopted) => Written::Nothing,
            Transfer::Download(blocks) => {
                change(blocks);
                Written::Nothing
            }
            Transfer::Inactive | Transfer::Upload => {
                let mut blocks = self.blocks();
                change(&mut blocks);
                self.keep(blocks)
            }
        }
    }

    /// The same for what a running SCL does not hang on: FST change at once.
    fn take_without_restart(&mut self, change: impl FnOnce(&mut Blocks)) -> Written {
        self.take(change);
        Written::Nothing
    }

    fn blocks(&self) -> Blocks {
        Blocks { authenticity: self.authenticity, protocol: self.protocol, technology: self.technology }
    }

    fn keep(&mut self, blocks: Blocks) -> Written {
        self.authenticity = blocks.authenticity;
        self.protocol = blocks.protocol;
        self.technology = blocks.technology;
        Written::Block
    }

    /// Whether nobody has assigned this device to a port yet.
    fn back_to_box(&self) -> bool {
        unassigned(&self.authenticity) && self.authenticity.port == 0 || self.is(Mutant::DownloadAdoptedInUse)
    }

    /// A SystemCommand: the resets of the edition, in commissioning alone. An application reset concerns the technology parameter.
    fn reset(&mut self, command: u8) -> Result<(), u16> {
        let all = match (self.variant.edition, command) {
            (Edition::V1_1, 0x82) | (Edition::Iec2022, 0x83) => true,
            (Edition::Iec2022, 0x82) if self.is(Mutant::RestoreFactoryTaken) => true,
            (Edition::Iec2022, 0x81) => self.is(Mutant::ApplicationResetForgets),
            _ => return Err(error_type::FUNCTION_NOT_AVAILABLE),
        };
        if self.protocol.tech_par_crc != 0 && !self.is(Mutant::ResetWhenArmed) {
            return Err(error_type::FUNCTION_UNAVAILABLE);
        }
        self.technology = Technology::default();
        if all {
            let authenticity = self.authenticity;
            *self = Parameters::factory(self.variant, self.mutant);
            if self.is(Mutant::ResetKeepsAuthenticity) {
                self.authenticity = authenticity;
            }
        }
        Ok(())
    }

    fn supports(&self, block: &Protocol) -> bool {
        block.version == PROT_VERSION && block.mode == self.variant.mode.code()
    }

    fn verify(&self, record: &[u8]) -> Written {
        let mut record = record.to_vec();
        if self.is(Mutant::RecordBitUnchecked)
            && let Some(octet) = record.get_mut(10)
        {
            *octet = *octet & !1 | self.authenticity.to_octets()[10] & 1;
        }
        let (authenticity, protocol) = record.split_at(AUTHENTICITY_OCTETS.min(record.len()));
        let port = self.verify_authenticity(authenticity);
        let watchdog_ms = self.verify_protocol(protocol);
        match (port, watchdog_ms) {
            (Ok(port), Ok(watchdog_ms)) => Written::Verified(Verified { port, watchdog_ms }),
            (port, watchdog_ms) => Written::Deviating([port.err(), watchdog_ms.err()]),
        }
    }

    /// FSP_Port of the record, or the EventCode of the first deviation.
    fn verify_authenticity(&self, octets: &[u8]) -> Result<Port, u16> {
        let crc_code = self.crc_events().0;
        let block = match Authenticity::from_octets(octets) {
            Err(_) if self.is(Mutant::AuthentCrcUnverified) => Authenticity::fields(octets).map_err(|_| crc_code)?,
            read => read.map_err(|_| crc_code)?,
        };
        let stored = &self.authenticity;
        let same = (block.authenticity_1 == stored.authenticity_1 || self.is(Mutant::Authenticity1Unverified))
            && (block.authenticity_2 == stored.authenticity_2 || self.is(Mutant::Authenticity2Unverified));
        let port_same = block.port == stored.port || self.is(Mutant::PortUnverified);
        match Port::new(stored.port).filter(|_| port_same) {
            _ if !same && self.is(Mutant::AuthenticityEventOfPort) => Err(event_code::PORT),
            _ if !same || unassigned(&block) => Err(event_code::AUTHENTICITY),
            Some(port) => Ok(port),
            None => Err(event_code::PORT),
        }
    }

    /// FSP_Watchdog of the record, or the EventCode of the first deviation.
    fn verify_protocol(&self, octets: &[u8]) -> Result<u16, u16> {
        let crc_code = self.crc_events().1;
        let block = match Protocol::from_octets(octets) {
            Err(_) if self.is(Mutant::ProtParCrcUnverified) => Protocol::fields(octets).map_err(|_| crc_code)?,
            read => read.map_err(|_| crc_code)?,
        };
        let watchdog_ms = if self.is(Mutant::WatchdogOfFactory) { DEFAULT_WATCHDOG_MS } else { block.watchdog_ms };
        let block = self.taken_as_stored(block);
        let checks = [
            (block.watchdog_ms != 0, event_code::WATCHDOG),
            (block.io_struct_crc == io_struct_crc(self.variant, self.mutant), event_code::IO_STRUCT_CRC),
            (block.tech_par_crc == self.protocol.tech_par_crc, event_code::TECH_PAR_CRC),
            (self.technology_fits() || self.is(Mutant::TechnologyUnverified), event_code::TECH_PAR_CRC),
            (self.supports(&block) && block == self.protocol, crc_code),
        ];
        match checks.into_iter().find(|(good, _)| !good) {
            None => Ok(watchdog_ms),
            Some((_, code)) => Err(code),
        }
    }

    /// The block with what a mutant does not compare as it is stored.
    fn taken_as_stored(&self, block: Protocol) -> Protocol {
        let stored = self.protocol;
        match self.mutant {
            Some(Mutant::VersionUnverified) => Protocol { version: stored.version, ..block },
            Some(Mutant::ModeUnverified) => Protocol { mode: stored.mode, ..block },
            Some(Mutant::WatchdogUnverified) => Protocol { watchdog_ms: stored.watchdog_ms, ..block },
            Some(Mutant::IoStructCrcUnverified) => Protocol { io_struct_crc: stored.io_struct_crc, ..block },
            Some(Mutant::TestModeTakesAll) if block.tech_par_crc == 0 => {
                Protocol { tech_par_crc: stored.tech_par_crc, ..block }
            }
            Some(Mutant::TechParCrcUnverified) => Protocol { tech_par_crc: stored.tech_par_crc, ..block },
            _ => block,
        }
    }

    /// The EventCodes for a wrong FSP_AuthentCRC and a wrong FSP_ProtParCRC.
    fn crc_events(&self) -> (u16, u16) {
        let (authent, prot_par) = (event_code::AUTHENT_CRC, event_code::PROT_PAR_CRC);
        if self.is(Mutant::CrcEventsSwapped) { (prot_par, authent) } else { (authent, prot_par) }
    }

    /// The stored blocks as an FSP_VerifyRecord gives them to the SCL; `None` without a port.
    pub fn stored(&self) -> Option<Verified> {
        let port = Port::new(self.authenticity.port)?;
        Some(Verified { port, watchdog_ms: self.protocol.watchdog_ms })
    }

    fn is(&self, mutant: Mutant) -> bool {
        self.mutant == Some(mutant)
    }
}

fn unassigned(block: &Authenticity) -> bool {
    block.authenticity_1 == 0 && block.authenticity_2 == 0
}

/// The whole object for Subindex 0, one of its items for the others.
fn item(octets: &[u8], items: &[usize], subindex: u8) -> Result<Vec<u8>, u16> {
    let Some(before) = usize::from(subindex).checked_sub(1) else { return Ok(octets.to_vec()) };
    let length = items.get(before).ok_or(error_type::SUBINDEX_NOT_AVAILABLE)?;
    let start: usize = items.iter().take(before).sum();
    Ok(octets.iter().skip(start).take(*length).copied().collect())
}

/// Whether this is a write of a whole block made up of `items`.
fn block(subindex: u8, data: &[u8], items: &[usize]) -> Result<(), u16> {
    let octets = items.iter().sum();
    match usize::from(subindex) {
        0 => of_length(data, octets, octets),
        subindex if subindex <= items.len() => Err(error_type::ACCESS_DENIED),
        _ => Err(error_type::SUBINDEX_NOT_AVAILABLE),
    }
}

fn whole(subindex: u8) -> Result<(), u16> {
    if subindex == 0 { Ok(()) } else { Err(error_type::SUBINDEX_NOT_AVAILABLE) }
}

/// The one octet of a command.
fn only(data: &[u8]) -> Result<u8, u16> {
    of_length(data, 1, 1)?;
    data.first().copied().ok_or(error_type::LENGTH_UNDERRUN)
}

fn of_length(data: &[u8], least: usize, most: usize) -> Result<(), u16> {
    match data.len() {
        length if length < least => Err(error_type::LENGTH_UNDERRUN),
        length if length > most => Err(error_type::LENGTH_OVERRUN),
        _ => Ok(()),
    }
}

fn before(operate: bool) -> Result<(), u16> {
    if operate { Err(error_type::FUNCTION_UNAVAILABLE) } else { Ok(()) }
}

/// What of the last Boolean octet of FS-PDin this device leaves as padding.
pub const PADDING: u8 = 0b1110_0000;

/// Octets of FS-PDin with Booleans: from four octets on the last two are an IntegerT(16), so that four are Figure A.1.
pub const fn boolean_octets(pd_in: u8) -> u8 {
    if pd_in < 4 { pd_in } else { pd_in - 2 }
}

/// FSP_IO_StructCRC of this variant (A.2.7). FS-PDout is octets of eight Booleans each; of FS-PDin see [`boolean_octets`] and
/// [`PADDING`].
pub fn io_struct_crc(variant: Variant, mutant: Option<Mutant>) -> u16 {
    let range = |pd: u8| variant.mode.spdu_octets(pd.into()) as u8;
    let (pd_in, pd_out) = (variant.pd_in, variant.pd_out);
    let octets = boolean_octets(pd_in);
    let (bits, int16) = ((8 * octets).saturating_sub(3), (pd_in - octets) / 2);
    let (bits, int16) = match mutant {
        Some(Mutant::StructureCountsOctets) => (octets, int16),
        Some(Mutant::StructureCountsPadding) => (8 * octets, int16),
        Some(Mutant::StructureTypesSwapped) => (int16, bits),
        _ => (bits, int16),
    };
    crc16(0, &[1, range(pd_in), bits, octets, int16, 0, range(pd_out), 8 * pd_out, pd_out, 0, 0])
}

/// The description of both blocks as FSP_ParamDescCRC covers it (Figure E.1), for one mode and the default watchdog.
fn param_desc(mode: u8, watchdog_range_ms: (u16, u16), io_struct_crc: u16) -> [u8; 77] {
    const TYPE_8: u8 = 1;
    const TYPE_16: u8 = 2;
    const TYPE_32: u8 = 3;
    let [watchdog_1, watchdog_0] = DEFAULT_WATCHDOG_MS.to_be_bytes();
    let [least_1, least_0] = watchdog_range_ms.0.to_be_bytes();
    let [most_1, most_0] = watchdog_range_ms.1.to_be_bytes();
    let [struct_1, struct_0] = io_struct_crc.to_be_bytes();
    // Index and bit length; then of each item Subindex, bit offset, type, default and allowed values.
    #[rustfmt::skip]
    let described = [
        0x42, 0x00, 0, 88,
        1, 0, 56, TYPE_32, 0, 0, 0, 0,
        2, 0, 24, TYPE_32, 0, 0, 0, 0,
        3, 0, 16, TYPE_8, 0,
        4, 0, 0, TYPE_16, 0, 0,
        0x42, 0x01, 0, 96,
        1, 0, 88, TYPE_8, PROT_VERSION, PROT_VERSION,
        2, 0, 80, TYPE_8, mode, mode,
        3, 0, 64, TYPE_16, watchdog_1, watchdog_0, least_1, least_0, most_1, most_0,
        4, 0, 48, TYPE_16, struct_1, struct_0,
        5, 0, 16, TYPE_32, 0, 0, 0, 0,
        6, 0, 0, TYPE_16, 0, 0,
    ];
    described
}

#[cfg(test)]
mod tests {
    use super::*;
    use fsct_protocol::ProtMode;

    #[test]
    fn param_desc_crc_is_that_of_the_sample_iodds() {
        assert_eq!(crc32(0, &param_desc(2, (100, 5000), 0x9A28)), 1_860_635_738);
        assert_eq!(crc16(0, &param_desc(1, (100, 5000), 5115)), 13_807);
    }

    #[test]
    fn io_struct_crc_of_a_trailer_alone_and_of_figure_a_1() {
        let crc = |mode, pd_in| io_struct_crc(Variant { edition: Edition::V1_1, mode, pd_out: 0, pd_in }, None);
        assert_eq!(crc(ProtMode::Crc16, 0), 0xDEC1);
        assert_eq!(crc(ProtMode::Crc32, 0), 0x5712);
        assert_eq!(crc(ProtMode::Crc32, 4), 0x9A28);
    }
}
