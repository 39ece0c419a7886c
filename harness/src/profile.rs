//! What a product declares (PICS and PIXIT) and the bench it stands on: `testcases/profiles/*.yaml`.

mod facts;

use crate::oracle::{Mask, Tolerances};
use crate::problem::{Problem, Source};
use crate::structure::Declared;
use crate::technology::{self, Technology};
use crate::tree::Fields;
use crate::yaml;
use fsct_adapters::{ClockKind, Description, Role};
use fsct_iodd::Declaration;
use fsct_protocol::ProtMode;
use fsct_protocol::crc::Reading;
use fsct_protocol::fsp::{Authenticity, INDEX_AUTHENTICITY, INDEX_PROTOCOL, INDEX_VERIFY, Protocol, VerifyRecord};
use fsct_protocol::spdu::Port;
use std::sync::Arc;

/// How the harness parameterizes an FS-Device.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Parameterization {
    /// Authenticity and protocol record are written, then the verify record.
    Commissioning,
    /// The product is commissioned already: only the verify record is written.
    VerifyRecord,
    /// The product starts its SCL by itself, with the values of this profile.
    None,
}

/// A profile.
#[derive(Clone, Debug)]
pub struct Profile {
    /// Its name.
    pub name: String,
    /// Side of the link the product is on.
    pub role: Role,
    /// Time between two exchanges, in nanoseconds.
    pub master_cycle_time_ns: u64,
    /// Exchanges an answer may take to appear after the SPDU was there.
    pub answer_latency: u64,
    /// FSP_Watchdog in milliseconds.
    pub watchdog_ms: u16,
    /// FSP_Port.
    pub port: Port,
    /// FSP_Authenticity_1.
    pub authenticity_1: u32,
    /// FSP_Authenticity_2.
    pub authenticity_2: u32,
    /// FSP_TechParCRC; 0 means commissioning.
    pub tech_par_crc: u32,
    /// FSP_TechParCRC of the technology parameters the product holds, for cases that arm it; 0: not told.
    pub tech_par_crc_armed: u32,
    /// FSMasterPassword of an FS-Master; 0 for none.
    pub password: u32,
    /// FSResetMasterPW of an FS-Master; 0 for none.
    pub reset_password: u32,
    /// VendorID of the virtual FS-Device on a port of an FS-Master.
    pub vendor_id: u16,
    /// DeviceID of the virtual FS-Device, three octets.
    pub device_id: u32,
    /// How late a watchdog may show, in MasterCycleTimes (A24).
    pub watchdog_margin: u64,
    /// Tick of the product's timer in microseconds (A24).
    pub timer_tick_us: u64,
    /// FSP_TimeToReady in milliseconds: of the product, or as an FS-Master is given it.
    pub time_to_ready_ms: u64,
    /// FSP_MinShutDownTime in milliseconds.
    pub min_shut_down_ms: u64,
    /// How long after its Ready pulse an FS-Device begins OSSDe operation, by its data sheet, in milliseconds.
    pub ossde_within_ms: u64,
    /// How late an FS-Master may end its waiting for a Ready pulse, in milliseconds (L03).
    pub ready_margin_ms: u64,
    /// How long the SCL may take to start after FSP parameterization, in milliseconds.
    pub scl_start_ms: u64,
    /// Reading of the start value of the signature (A02).
    pub reading: Reading,
    /// How the product is parameterized.
    pub parameterization: Parameterization,
    /// The product claims no FS_PortMode, so no SCL: it is a gateway of a safety fieldbus, no FS-Master.
    pub no_fs_port_mode: bool,
    /// FS I/O structure of an FS-Device; `None`: not declared.
    pub structure: Option<Declared>,
    /// A technology parameter of an FS-Device; `None`: not told.
    pub technology: Option<Technology>,
    /// Features of the product that some requirements are limited to, such as `ossde`.
    pub features: Vec<String>,
    /// What the product's IODD declares, when one was given.
    pub declaration: Option<Declaration>,
    /// Tolerances the profile adds.
    pub tolerate: Mask,
    /// Tolerances the profile takes away.
    pub strict: Mask,
}

/// Exchanges within a watchdog that are enough where nothing hinges on their number.
const EXCHANGES: u64 = 2_000;

/// The feature of a profile that tells an FSP_TechParCRC other than 0.
const ARMED: &str = "armed";

/// The feature of a profile that was completed from an IODD.
const IODD: &str = "iodd";

/// Name of the profile a DUT is judged by when none is given.
pub fn default_profile(role: Role) -> String {
    format!("reference-{role}")
}

impl Profile {
    /// Reads a profile.
    ///
    /// # Errors
    /// Every problem of the file.
    pub fn parse(source: &Arc<Source>) -> Result<Profile, Vec<Problem>> {
        const ROLES: &[(Role, &str)] = &[(Role::Device, "device"), (Role::Master, "master")];
        const READINGS: &[(Reading, &str)] = &[(Reading::Preset, "preset"), (Reading::LeadingOctet, "leading-octet")];
        const WAYS: &[(Parameterization, &str)] = &[
            (Parameterization::Commissioning, "commissioning"),
            (Parameterization::VerifyRecord, "verify-record"),
            (Parameterization::None, "none"),
        ];
        let root = yaml::parse(source).map_err(|problem| vec![problem])?;
        let mut problems = Vec::new();
        let mut fields = Fields::new(source, &root, "a profile", &mut problems);
        let name = fields.text("profile");
        let _about = fields.optional("about");
        let role = fields.word("dut", ROLES);
        let mut number = |key, range, default| fields.optional_number(key, range).unwrap_or(default);
        let master_cycle_time_us = number("MasterCycleTime_us", 400..=132_800, 1_000);
        let answer_latency = number("answer_latency", 0..=8, 0);
        let watchdog_ms = number("FSP_Watchdog_ms", 1..=65_535, 20) as u16;
        let port = number("FSP_Port", 1..=255, 1) as u8;
        let authenticity_1 = number("FSP_Authenticity_1", 0..=0xFFFF_FFFF, 0x1122_3344) as u32;
        let authenticity_2 = number("FSP_Authenticity_2", 0..=0xFFFF_FFFF, 0) as u32;
        let tech_par_crc = number("FSP_TechParCRC", 0..=0xFFFF_FFFF, 0) as u32;
        let tech_par_crc_armed = number("FSP_TechParCRC_armed", 0..=0xFFFF_FFFF, 0) as u32;
        let password = number("FSMasterPassword", 0..=0xFFFF_FFFF, 0) as u32;
        let reset_password = number("FSResetMasterPW", 0..=0xFFFF_FFFF, 0) as u32;
        let vendor_id = number("VendorID", 1..=0xFFFF, 0x04D2) as u16;
        let device_id = number("DeviceID", 1..=0xFF_FFFF, 0x00_1234) as u32;
        let time_to_ready_ms = number("FSP_TimeToReady_ms", 10..=327_670, 5_000);
        let min_shut_down_ms = number("FSP_MinShutDownTime_ms", 1_000..=10_000, 1_000);
        let ossde_within_ms = number("OSSDe_within_ms", 1..=600_000, 10_000);
        let ready_margin_ms = number("ready_margin_ms", 0..=60_000, 100);
        let watchdog_margin = number("watchdog_margin", 0..=1_000, 2);
        let timer_tick_us = number("timer_tick_us", 0..=1_000_000, 0);
        let scl_start_ms = number("SCL_start_ms", 0..=60_000, 0);
        let reading = fields.optional_word("signature_start", READINGS).unwrap_or_default();
        let parameterization =
            fields.optional_word("parameterization", WAYS).unwrap_or(Parameterization::Commissioning);
        let mut features: Vec<String> = fields.texts("features").into_iter().map(|placed| placed.0).collect();
        if tech_par_crc != 0 || tech_par_crc_armed != 0 {
            features.push(ARMED.to_owned());
        }
        let no_fs_port_mode = fields.optional_word("FS_PortMode", &[(true, "none")]).unwrap_or(false);
        let mut of_structure = Vec::new();
        let structure = Declared::read(&mut fields, &mut of_structure);
        if role == Some(Role::Master) && structure.is_some() {
            fields.problem(root.at.clone(), "`FS_IO_in` and `FS_IO_out` are for an FS-Device");
        }
        let technology = Technology::read(&mut fields, &root.at);
        if role == Some(Role::Master) && technology.is_some() {
            fields.problem(root.at.clone(), "`FST_index`, `FST_value` and `FST_other` are for an FS-Device");
        }
        features.extend(technology.iter().map(|_| technology::FEATURE.to_owned()));
        if role == Some(Role::Device) && no_fs_port_mode {
            fields.problem(root.at.clone(), "`FS_PortMode` is for an FS-Master");
        }
        features.extend(structure.into_iter().flat_map(Declared::features).map(str::to_owned));
        let mut mask = |key| {
            let mut mask = Mask::NONE;
            for (text, at) in fields.texts(key) {
                match Tolerances::number(&text) {
                    Some(number) => mask = mask.with(number),
                    None => fields.problem(at, format!("`{text}` is no tolerance, A01 to A38 are")),
                }
            }
            mask
        };
        let tolerate = mask("tolerate");
        let strict = mask("strict");
        let watchdog_cycles = u64::from(watchdog_ms) * 1_000 / master_cycle_time_us;
        if watchdog_cycles <= answer_latency + 1 {
            let message = format!(
                "FSP_Watchdog of {watchdog_ms} ms is not longer than one SCL cycle ({} exchanges of {master_cycle_time_us} us)",
                answer_latency + 1
            );
            fields.problem(root.at.clone(), message);
        }
        fields.finish(&mut problems);
        problems.extend(of_structure);
        match (name, role, Port::new(port)) {
            (Some((name, _)), Some(role), Some(port)) if problems.is_empty() => Ok(Profile {
                name,
                role,
                master_cycle_time_ns: master_cycle_time_us * 1_000,
                answer_latency,
                watchdog_ms,
                port,
                authenticity_1,
                authenticity_2,
                tech_par_crc,
                tech_par_crc_armed,
                password,
                reset_password,
                vendor_id,
                device_id,
                time_to_ready_ms,
                min_shut_down_ms,
                ossde_within_ms,
                ready_margin_ms,
                watchdog_margin,
                timer_tick_us,
                scl_start_ms,
                reading,
                parameterization,
                no_fs_port_mode,
                structure,
                technology,
                features,
                declaration: None,
                tolerate,
                strict,
            }),
            _ => Err(problems),
        }
    }

    /// This profile with another FSP_Watchdog, and a MasterCycleTime that fits into it: at most two fifths. Where the tester
    /// moves the clock exchanges may also come more slowly, some thousands to the watchdog, for its instant is exact anyway.
    pub fn with_watchdog(&self, watchdog_ms: u16, clock: ClockKind) -> Profile {
        let watchdog_us = u64::from(watchdog_ms) * 1_000;
        let least_us = if clock == ClockKind::Virtual { watchdog_us / EXCHANGES } else { 0 };
        let master_cycle_time_ns = self
            .master_cycle_time_ns
            .max(least_us * 1_000)
            .min(watchdog_us * 1_000 / 5 * 2 / (self.answer_latency + 1));
        Profile { watchdog_ms, master_cycle_time_ns, ..self.clone() }
    }

    /// This profile with what the product's IODD declares: its times in place of those here.
    pub fn with_iodd(&self, declaration: Declaration) -> Profile {
        let ms = |tens: Option<u16>, own: u64| tens.map_or(own, |tens| u64::from(tens) * 10);
        let mut features = self.features.clone();
        features.push(IODD.to_owned());
        Profile {
            time_to_ready_ms: ms(declaration.time_to_ready, self.time_to_ready_ms),
            min_shut_down_ms: ms(declaration.min_shut_down_time, self.min_shut_down_ms),
            features,
            declaration: Some(declaration),
            ..self.clone()
        }
    }

    /// FSP_Watchdog in nanoseconds.
    pub fn watchdog_ns(&self) -> u64 {
        u64::from(self.watchdog_ms) * 1_000_000
    }

    /// What a limit takes from a parameter or a declaration of the product, in the unit of its row in `limits.yaml`; `None`:
    /// nothing is declared.
    pub fn declared(&self, name: &str) -> Option<f64> {
        let ms = |ns: u64| ns as f64 / 1e6;
        let tick_ns = self.timer_tick_us * 1_000;
        // MTimer starts when the SPDU is handed over, up to one MasterCycleTime before it is on the line (A24).
        let early_ns = tick_ns + if self.role == Role::Master { self.master_cycle_time_ns } else { 0 };
        let late_ns = tick_ns + self.margin_ns() + self.answer_latency * self.master_cycle_time_ns;
        let wait_s = |ready_ms: u64| (ready_ms + self.ready_margin_ms) as f64 / 1e3;
        match name {
            "FSP_Watchdog" => Some(ms(self.watchdog_ns().saturating_sub(early_ns))),
            "FSP_Watchdog and margin" => Some(ms(self.watchdog_ns() + late_ns)),
            "FSP_TimeToReady" => Some(self.time_to_ready_ms as f64 / 1e3),
            "FSP_TimeToReady and margin" => Some(wait_s(self.time_to_ready_ms)),
            "5 s and margin" => Some(wait_s(5_000)),
            "FSP_MinShutDownTime" => Some(self.min_shut_down_ms as f64 / 1e3),
            _ => None,
        }
    }

    /// Margin of A24 in nanoseconds.
    pub fn margin_ns(&self) -> u64 {
        self.watchdog_margin * self.master_cycle_time_ns
    }

    /// The authenticity record.
    pub const fn authenticity(&self) -> Authenticity {
        Authenticity {
            authenticity_1: self.authenticity_1,
            authenticity_2: self.authenticity_2,
            port: self.port.number(),
        }
    }

    /// FSP_TechParCRC in armed operation; 0 when the profile does not tell it.
    pub const fn armed_tech_par_crc(&self) -> u32 {
        if self.tech_par_crc == 0 { self.tech_par_crc_armed } else { self.tech_par_crc }
    }

    /// The FSP records that start a product in this mode, in the order they are written; FSP_IO_StructCRC is the maker's.
    pub fn records(&self, mode: ProtMode, io_struct_crc: u16, tech_par_crc: u32) -> Vec<(u16, Vec<u8>)> {
        let authenticity = self.authenticity();
        let protocol =
            Protocol { version: 1, mode: mode.code(), watchdog_ms: self.watchdog_ms, io_struct_crc, tech_par_crc };
        let verify = (INDEX_VERIFY, VerifyRecord { authenticity, protocol }.to_octets().to_vec());
        match self.parameterization {
            Parameterization::Commissioning => vec![
                (INDEX_AUTHENTICITY, authenticity.to_octets().to_vec()),
                (INDEX_PROTOCOL, protocol.to_octets().to_vec()),
                verify,
            ],
            Parameterization::VerifyRecord => vec![verify],
            Parameterization::None => Vec::new(),
        }
    }

    /// The tolerances in force: those of the table, as this profile and then the user change them; `all` strict is none.
    ///
    /// # Errors
    /// One sentence for the user about an id that is none.
    pub fn allowed(&self, table: &Tolerances, strict: &[String], tolerate: &[String]) -> Result<Mask, String> {
        let number = |id: &String| {
            Tolerances::number(id)
                .ok_or_else(|| format!("`{id}` is no tolerance, A01 to A38 are; see `fsct explain A19`"))
        };
        let mut allowed = table.in_force().union(self.tolerate);
        self.strict.iter().for_each(|number| allowed = allowed.without(number));
        for id in strict {
            match id.as_str() {
                "all" => allowed = Mask::NONE,
                _ => allowed = allowed.without(number(id)?),
            }
        }
        for id in tolerate {
            allowed = allowed.with(number(id)?);
        }
        Ok(allowed)
    }

    /// What contradicts what the DUT says of itself; empty when they agree.
    pub fn contradicts(&self, description: &Description) -> Option<String> {
        if self.role != description.role {
            let (name, role) = (&self.name, self.role);
            return Some(format!("profile `{name}` is for a {role}, the DUT says it is a {}", description.role));
        }
        let structure = self.structure.filter(|structure| !structure.fits(description))?;
        let ((out, input), name) = (structure.sizes(), &self.name);
        Some(format!(
            "profile `{name}` declares {out} octets of FS-PDout and {input} of FS-PDin, which the DUT does not offer"
        ))
    }
}
