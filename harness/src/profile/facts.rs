//! What a profile declares, as a record shows it. Passwords stay out of records.

use super::{Parameterization, Profile};
use crate::oracle::Mask;
use fsct_adapters::Role;
use fsct_iodd::Declaration;
use fsct_protocol::crc::Reading;

impl Profile {
    /// Names in the standard's spelling or that of the profile, with values and units, in the order of the profile.
    pub fn facts(&self) -> Vec<(String, String)> {
        let mut facts: Vec<(&str, String)> = vec![
            ("MasterCycleTime", format!("{} µs", self.master_cycle_time_ns / 1_000)),
            ("Answer latency", format!("{} exchanges", self.answer_latency)),
            ("FSP_Watchdog", format!("{} ms", self.watchdog_ms)),
            ("FSP_Port", self.port.number().to_string()),
            ("FSP_Authenticity_1, _2", format!("0x{:08X}, 0x{:08X}", self.authenticity_1, self.authenticity_2)),
            ("FSP_TechParCRC", format!("0x{:08X}", self.tech_par_crc)),
        ];
        if self.tech_par_crc_armed != 0 {
            facts.push(("FSP_TechParCRC, armed", format!("0x{:08X}", self.tech_par_crc_armed)));
        }
        facts.push(("FSP_TimeToReady", format!("{} ms", self.time_to_ready_ms)));
        facts.push(("FSP_MinShutDownTime", format!("{} ms", self.min_shut_down_ms)));
        match self.role {
            Role::Device => facts.push(("OSSDe operation begins within", format!("{} ms", self.ossde_within_ms))),
            Role::Master => {
                facts.push(("Ready pulse may be missed by", format!("{} ms", self.ready_margin_ms)));
                let ids = format!("0x{:04X}, 0x{:06X}", self.vendor_id, self.device_id);
                facts.push(("VendorID, DeviceID of the partner", ids));
            }
        }
        facts.push(("Watchdog margin (A24)", format!("{} MasterCycleTimes", self.watchdog_margin)));
        facts.push(("Timer tick (A24)", format!("{} µs", self.timer_tick_us)));
        facts.push(("SCL starts within", format!("{} ms", self.scl_start_ms)));
        let reading = match self.reading {
            Reading::Preset => "preset of the register",
            Reading::LeadingOctet => "a leading octet (A02)",
            Reading::FieldFed => "preset, with the signature field fed as zero octets (A03)",
        };
        facts.push(("Start value of the signature", reading.to_owned()));
        let way = match self.parameterization {
            Parameterization::Commissioning => "authenticity, protocol and verify record are written",
            Parameterization::VerifyRecord => "the verify record is written",
            Parameterization::None => "none, the product starts by itself",
        };
        facts.push(("Parameterization", way.to_owned()));
        facts.push(("Features", if self.features.is_empty() { "none".to_owned() } else { self.features.join(", ") }));
        if let Some(structure) = self.structure {
            let (out, input) = structure.sizes();
            facts.push(("FS I/O structure", format!("{out} octets of FS-PDout, {input} of FS-PDin")));
        }
        if let Some(technology) = &self.technology {
            facts.push(("Technology parameter", format!("Index 0x{:04X}", technology.index)));
        }
        if self.no_fs_port_mode {
            facts.push(("FS_PortMode", "none is claimed".to_owned()));
        }
        for (name, mask) in [("Tolerated beside the usual", self.tolerate), ("Not tolerated", self.strict)] {
            if !mask.is_empty() {
                facts.push((name, ids(mask)));
            }
        }
        if let Some(declaration) = &self.declaration {
            facts.push(("IODD", declared(declaration)));
        }
        facts.into_iter().map(|(name, value)| (name.to_owned(), value)).collect()
    }
}

fn ids(mask: Mask) -> String {
    mask.iter().map(|number| format!("A{number:02}")).collect::<Vec<_>>().join(", ")
}

/// What the IODD of the product declares, in one line.
fn declared(declaration: &Declaration) -> String {
    let mut said = vec![format!("edition {}", declaration.edition)];
    said.extend(declaration.mode.map(|mode| format!("FSP_ProtMode {mode}")));
    said.extend(declaration.pd_out.map(|octets| format!("{octets} octets of FS-PDout")));
    said.extend(declaration.pd_in.map(|octets| format!("{octets} octets of FS-PDin")));
    said.extend(declaration.watchdog.map(|ms| format!("FSP_Watchdog {ms} ms")));
    said.extend(declaration.watchdog_range.map(|(least, most)| format!("{least} to {most} ms allowed")));
    said.extend(declaration.io_struct_crc.map(|crc| format!("FSP_IO_StructCRC 0x{crc:04X}")));
    said.extend(declaration.param_desc_crc.map(|crc| format!("FSP_ParamDescCRC 0x{crc:X}")));
    said.extend(declaration.time_to_ready.map(|tens| format!("FSP_TimeToReady {} ms", u32::from(tens) * 10)));
    said.extend(declaration.min_shut_down_time.map(|tens| format!("FSP_MinShutDownTime {} ms", u32::from(tens) * 10)));
    said.extend(declaration.wcdt.map(|ms| format!("FSP_WCDT {ms} ms")));
    said.extend(declaration.ofdt.map(|ms| format!("FSP_OFDT {ms} ms")));
    said.join(", ")
}
