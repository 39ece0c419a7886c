//! IODD-02 to IODD-15: profile, base variables, names.

use super::{Check, counted, maybe, quoted};
use crate::model::{is_true, number};
use fsct_protocol::Edition;
use std::collections::HashSet;

/// The Indices FSP parameters own (Table A.1).
const RESERVED: std::ops::RangeInclusive<u64> = 0x4200..=0x42FF;
/// FSP_VerifyRecord.
const VERIFY_RECORD: u64 = 0x4202;

/// The base variables v1.1 demands (Table E.1) besides V_SystemCommand.
const MANDATORY: [&str; 8] = [
    "V_ProductID",
    "V_SerialNumber",
    "V_HardwareRevision",
    "V_FirmwareRevision",
    "V_ApplicationSpecificTag",
    "V_ErrorCount",
    "V_DeviceStatus",
    "V_DetailedDeviceStatus",
];
/// Those of them that the sample of the same document does without.
const DISPUTED: [&str; 3] = ["V_ProfileCharacteristic", "V_PDInputDescriptor", "V_PDOutputDescriptor"];

pub(super) fn check(check: &mut Check<'_, '_>) {
    features(check);
    defaults(check);
    indices(check);
    base_variables(check);
    commands(check);
    names(check);
}

fn features(check: &mut Check<'_, '_>) {
    let iodd = check.iodd;
    let (at, profiles, storage) = match &iodd.features {
        Some(features) => (features.at, features.profiles.as_slice(), features.data_storage),
        None => (iodd.at, [].as_slice(), None),
    };
    let names = |wanted| profiles.iter().any(|profile| number(profile) == Some(wanted));
    let found = format!("profileCharacteristic {}", quoted(&profiles.join(" ")));
    if !names(16385) {
        check.broken("IODD-02", at, &found, "16385 in it");
    }
    if !names(16384) {
        check.broken("IODD-03", at, &found, "16384 in it");
    }
    if names(0x8020) {
        check.broken("IODD-04", at, &found, "no 32800 in it");
    }
    if !is_true(storage) {
        check.broken("IODD-06", at, format!("dataStorage {}", maybe(storage)), "`true`");
    }
}

fn defaults(check: &mut Check<'_, '_>) {
    let iodd = check.iodd;
    for variable in iodd.variables.iter().filter(|variable| variable.access == "rw") {
        let given: HashSet<u64> =
            variable.infos.iter().filter(|info| info.default.is_some()).filter_map(|info| info.subindex).collect();
        let missing: Vec<u64> =
            variable.data.items.iter().filter_map(|item| item.subindex).filter(|item| !given.contains(item)).collect();
        // An array may give one default for all elements or one for each.
        let whole = variable.default.is_some() || (variable.data.kind == "ArrayT" && !given.is_empty());
        if variable.data.kind == "RecordT" && !missing.is_empty() {
            let list: Vec<String> = missing.iter().take(8).map(u64::to_string).collect();
            let found =
                format!("{} can be written and has no default for Subindex {}", quoted(variable.id), list.join(", "));
            check.broken("IODD-05", variable.at, found, "a RecordItemInfo with defaultValue for each item");
        } else if variable.data.kind != "RecordT" && !whole {
            let found = format!("{} can be written and has no default", quoted(variable.id));
            check.broken("IODD-05", variable.at, found, "defaultValue");
        }
    }
}

fn indices(check: &mut Check<'_, '_>) {
    let iodd = check.iodd;
    for (index, name) in [(16896, "V_FSP_Authenticity"), (16897, "V_FSP_Protocol")] {
        if iodd.variable(index).is_none() {
            check.broken("IODD-07", iodd.variables_at, format!("no variable at Index {index}"), name);
        }
    }
    let mut seen = HashSet::new();
    for variable in &iodd.variables {
        let Some(index) = variable.index.filter(|index| RESERVED.contains(index)) else { continue };
        let known = matches!(index, 16896 | 16897 | 16912..=16916);
        if index == VERIFY_RECORD {
            check.broken("IODD-09", variable.at, format!("{} at Index 16898", quoted(variable.id)), "no such variable");
        } else if !known {
            let found = format!("{} at Index {index}", quoted(variable.id));
            check.broken("IODD-10", variable.at, found, "an Index outside 16896 to 17151");
        } else if !seen.insert(index) {
            let found = format!("{} at Index {index}, where there is one already", quoted(variable.id));
            check.broken("IODD-10", variable.at, found, "one variable at this Index");
        }
    }
}

fn base_variables(check: &mut Check<'_, '_>) {
    let iodd = check.iodd;
    let referenced: HashSet<&str> = iodd.standard.iter().map(|variable| variable.id).collect();
    let absent = |id: &str| !referenced.contains(id);
    for id in ["V_ProcessDataInput", "V_ProcessDataOutput"].into_iter().filter(|id| absent(id)) {
        check.broken("IODD-14", iodd.variables_at, format!("no reference to {id}"), "StdVariableRef");
    }
    for id in MANDATORY.into_iter().filter(|id| absent(id)) {
        check.broken("IODD-11", iodd.variables_at, format!("no reference to {id}"), "StdVariableRef");
    }
    for id in DISPUTED.into_iter().filter(|id| absent(id)) {
        let found = format!("no reference to {id}");
        check.doubtful("IODD-11", iodd.variables_at, found, "StdVariableRef, though the sample has none either");
    }
    // A direction that carries the safety code alone may do without its variable.
    let carries = |direction: Option<&crate::model::Direction<'_>>| {
        direction.is_some_and(|direction| direction.data.items.iter().any(|item| item.subindex != Some(127)))
    };
    let pd = iodd.process_data.first();
    let sides = [
        ("V_ProcessDataInput", pd.and_then(|pd| pd.input.as_ref())),
        ("V_ProcessDataOutput", pd.and_then(|pd| pd.output.as_ref())),
    ];
    for (id, _) in sides.into_iter().filter(|(id, direction)| carries(*direction) && absent(id)) {
        check.broken(
            "IODD-11",
            iodd.variables_at,
            format!("no reference to {id}"),
            "StdVariableRef, because there are such data",
        );
    }
    for variable in &iodd.standard {
        let length = variable.fixed_length.and_then(number);
        if variable.id == "V_ApplicationSpecificTag" && length.is_some_and(|length| !(16..=32).contains(&length)) {
            let found = format!("V_ApplicationSpecificTag of {} octets", counted(length));
            check.broken("IODD-11", variable.at, found, "16 to 32");
        }
        if variable.id == "V_DirectParameters_2" {
            let found = "a reference to V_DirectParameters_2";
            check.doubtful("IODD-11", variable.at, found, "none, though the sample has one for the sake of a checker");
        }
    }
}

fn commands(check: &mut Check<'_, '_>) {
    let iodd = check.iodd;
    let (rule, wanted, refused): (_, &[u64], &[u64]) = match check.edition {
        Edition::V1_1 => ("IODD-13", &[130], &[]),
        Edition::Iec2022 => ("IODD-12", &[129, 131], &[128, 130]),
    };
    let Some(variable) = iodd.standard.iter().find(|variable| variable.id == "V_SystemCommand") else {
        return check.broken(rule, iodd.variables_at, "no reference to V_SystemCommand", "StdVariableRef");
    };
    for value in wanted {
        if !variable.values.iter().any(|(_, text)| number(text) == Some(*value)) {
            check.broken(rule, variable.at, format!("no system command {value}"), "StdSingleValueRef");
        }
    }
    for (at, text) in &variable.values {
        if number(text).is_some_and(|value| refused.contains(&value)) {
            check.broken(rule, *at, format!("system command {}", quoted(text)), "no such command");
        }
    }
}

fn names(check: &mut Check<'_, '_>) {
    let iodd = check.iodd;
    for variable in &iodd.variables {
        let safety = variable.index.is_some_and(|index| RESERVED.contains(&index));
        let fsp = variable.id.starts_with("V_FSP") && !safety;
        // V_FST_ names what the maker calls safe; without the underscore it is neither name.
        let fst = variable.id.starts_with("V_FST") && (safety || !variable.id.starts_with("V_FST_"));
        if fsp || fst {
            let found = format!("{} at Index {}", quoted(variable.id), counted(variable.index));
            check.broken(
                "IODD-15",
                variable.at,
                found,
                "V_FSP_... for FSP parameters alone, V_FST_... for technology safety parameters",
            );
        }
    }
}
