//! The FSPortConfigList that a profile and a variant ask for, with the deviations of a case.

use crate::case::model::{Configure, Value};
use crate::oracle::Setup;
use crate::profile::Profile;
use fsct_adapters::Identity;
use fsct_protocol::Edition;
use fsct_protocol::fsp::{Authenticity, IoStructure, IoTotals, Protocol};
use fsct_protocol::smi::{FS_PORT_CONFIG_LIST, MIXEDSAFETYCOM, OSSDE, SAFETYCOM};

/// MinCycleTime of the virtual FS-Device in the coding of the base standard: 1 ms.
const MIN_CYCLE_TIME: u8 = 10;

/// The FS I/O structure of the virtual FS-Device: octets of eight Booleans each.
pub fn io_structure(setup: &Setup) -> IoStructure {
    let side = |pd: usize| IoTotals {
        range: setup.mode.spdu_octets(pd) as u8,
        bits: (8 * pd) as u8,
        octets: pd as u8,
        int16: 0,
        int32: 0,
    };
    IoStructure { version: 1, input: side(setup.pd_in), output: side(setup.pd_out) }
}

/// The 23 octets of an FSPortConfigList that make up the verify record.
pub fn verify_record(edition: Edition, list: &[u8]) -> &[u8] {
    let from = FS_PORT_CONFIG_LIST.field("FSP_Authenticity1").and_then(|field| field.offset(edition)).unwrap_or(0);
    list.get(from..).and_then(|rest| rest.get(..23)).unwrap_or_default()
}

/// The virtual FS-Device as the list describes it.
pub fn identity(setup: &Setup, profile: &Profile, nsr: (u8, u8)) -> Identity {
    Identity {
        revision_id: 0x11,
        com: 3,
        min_cycle_time: MIN_CYCLE_TIME,
        pd_in: setup.mode.spdu_octets(setup.pd_in) as u8 + nsr.0,
        pd_out: setup.mode.spdu_octets(setup.pd_out) as u8 + nsr.1,
        vendor_id: profile.vendor_id,
        device_id: profile.device_id,
    }
}

/// The list for a port. Signatures are computed over the values in it, deviating ones included, unless they deviate
/// themselves.
pub fn list(setup: &Setup, profile: &Profile, configure: &Configure) -> Vec<u8> {
    let edition = setup.edition;
    let mut list = vec![0; FS_PORT_CONFIG_LIST.length(edition)];
    let io = io_structure(setup);
    let mut values: Vec<(&str, u32)> = vec![
        ("ArgBlockID", FS_PORT_CONFIG_LIST.id(edition).unwrap_or(0).into()),
        ("PortMode", if configure.nsr == (0, 0) { SAFETYCOM.into() } else { MIXEDSAFETYCOM.into() }),
        ("Validation&Backup", 2),
        ("I/Q_behavior", 0),
        ("PortCycleTime", 0),
        ("VendorID", profile.vendor_id.into()),
        ("DeviceID", profile.device_id),
        ("InputDataLength", configure.nsr.0.into()),
        ("OutputDataLength", configure.nsr.1.into()),
        ("FSP_TimeToReady", (profile.time_to_ready_ms / 10) as u32),
        ("FSP_MinShutDownTime", (profile.min_shut_down_ms / 10) as u32),
        ("FSP_Authenticity1", profile.authenticity_1),
        ("FSP_Authenticity2", profile.authenticity_2),
        ("FSP_Port", setup.port.number().into()),
        ("FSP_ProtVersion", 1),
        ("FSP_ProtMode", setup.mode.code().into()),
        ("FSP_Watchdog", profile.watchdog_ms.into()),
        ("FSP_TechParCRC", profile.tech_par_crc),
        ("IO_DescVersion", io.version.into()),
        ("SPDUInLength", io.input.range.into()),
        ("TotalOfInBits", io.input.bits.into()),
        ("TotalOfInOctets", io.input.octets.into()),
        ("SPDUOutLength", io.output.range.into()),
        ("TotalOfOutBits", io.output.bits.into()),
        ("TotalOfOutOctets", io.output.octets.into()),
        ("FSP_IO_StructCRC", io.signature().into()),
    ];
    for (field, value) in &configure.set {
        let right = values.iter().find(|(name, _)| *name == field.name).map_or(0, |entry| entry.1);
        let value = deviating(*value, right);
        match values.iter_mut().find(|(name, _)| *name == field.name) {
            Some(entry) => entry.1 = value,
            None => values.push((field.name, value)),
        }
        if field.name == "PortMode" && value == u32::from(OSSDE) {
            values.push(("SPDUInLength", 1));
        }
    }
    let mut put = |name: &str, value: u32| {
        if let Some(field) = FS_PORT_CONFIG_LIST.field(name) {
            field.put(edition, &mut list, value);
        }
    };
    values.iter().for_each(|(name, value)| put(name, *value));
    let get = |name: &str| values.iter().rfind(|(known, _)| *known == name).map_or(0, |entry| entry.1);
    let authenticity = Authenticity {
        authenticity_1: get("FSP_Authenticity1"),
        authenticity_2: get("FSP_Authenticity2"),
        port: get("FSP_Port") as u8,
    };
    let protocol = Protocol {
        version: get("FSP_ProtVersion") as u8,
        mode: get("FSP_ProtMode") as u8,
        watchdog_ms: get("FSP_Watchdog") as u16,
        io_struct_crc: get("FSP_IO_StructCRC") as u16,
        tech_par_crc: get("FSP_TechParCRC"),
    };
    for (name, right) in [("FSP_AuthentCRC", authenticity.signature()), ("FSP_ProtParCRC", protocol.signature())] {
        let own = configure.set.iter().find(|(field, _)| field.name == name).map(|entry| entry.1);
        put(name, own.map_or(right.into(), |value| deviating(value, right.into())));
    }
    list
}

fn deviating(value: Value, right: u32) -> u32 {
    match value {
        Value::Number(number) => number,
        Value::Wrong => right ^ 1,
        Value::Profile => right,
    }
}

/// A field of a list.
pub fn field(edition: Edition, list: &[u8], name: &str) -> u32 {
    FS_PORT_CONFIG_LIST.field(name).and_then(|field| field.value(edition, list)).unwrap_or(0)
}
