//! IODD-16 to IODD-34: the FSP variables, their types, defaults and allowed values.

use super::{Check, Signature, counted, maybe, quoted};
use crate::model::{Item, Variable, number};
use fsct_protocol::Edition;

/// An item as Table A.1 has it: Subindex, bit offset, bits.
type Shape = (u64, u64, u64);

const AUTHENTICITY: [Shape; 4] = [(1, 56, 32), (2, 24, 32), (3, 16, 8), (4, 0, 16)];
const PROTOCOL: [Shape; 6] = [(1, 88, 8), (2, 80, 8), (3, 64, 16), (4, 48, 16), (5, 16, 32), (6, 0, 16)];

pub(super) fn check(check: &mut Check<'_, '_>, structure: &Result<Signature, String>) {
    let authenticity = check.variable(16896);
    let protocol = check.variable(16897);
    if let Some(variable) = authenticity {
        record(check, "IODD-16", variable, "V_FSP_Authenticity", 88, &AUTHENTICITY);
        (1..=4).for_each(|subindex| zero(check, variable, subindex));
        unrestricted(check, variable, &[]);
    }
    if let Some(variable) = protocol {
        record(check, "IODD-17", variable, "V_FSP_Protocol", 96, &PROTOCOL);
        [5, 6].into_iter().for_each(|subindex| zero(check, variable, subindex));
        unrestricted(check, variable, &[1, 2, 3]);
        version(check, variable);
        mode(check, variable);
        watchdog(check, variable);
        struct_crc(check, variable, structure);
    }
    by_subindex(check);
    match check.edition {
        Edition::V1_1 => {
            single(check, "IODD-27", (16914, "V_FSP_ParamDescCRC", 16), 0..=0xFFFF);
            password(check, 16912, "V_FSP_Password");
            password(check, 16913, "V_FSP_Reset_Password");
        }
        Edition::Iec2022 => {
            single(check, "IODD-26", (16914, "V_FSP_ParamDescCRC", 32), 0..=0xFFFF_FFFF);
            single(check, "IODD-28", (16912, "V_FSP_TimeToReady", 16), 1..=32767);
            single(check, "IODD-30", (16913, "V_FSP_MinShutDownTime", 16), 100..=1000);
            single(check, "IODD-31", (16915, "V_FSP_WCDT", 16), 1..=32767);
            single(check, "IODD-32", (16916, "V_FSP_OFDT", 16), 1..=32767);
            times(check);
        }
    }
}

fn record(
    check: &mut Check<'_, '_>,
    rule: &'static str,
    variable: &Variable<'_>,
    id: &str,
    bits: u64,
    shapes: &[Shape],
) {
    let data = &variable.data;
    if variable.id != id {
        check.broken(rule, variable.at, format!("id {}", quoted(variable.id)), format!("`{id}`"));
    }
    if variable.access != "rw" {
        check.broken(rule, variable.at, format!("accessRights {}", quoted(variable.access)), "`rw`");
    }
    if data.kind != "RecordT" || data.bits != Some(bits) {
        let found = format!("{} of {} bit", quoted(data.kind), counted(data.bits));
        return check.broken(rule, data.place_or(variable.at), found, format!("RecordT of {bits} bit"));
    }
    for &(subindex, offset, width) in shapes {
        let expected = format!("UIntegerT of {width} bit at offset {offset}");
        let Some(item) = data.item(subindex) else {
            check.broken(rule, data.at, format!("no item with Subindex {subindex}"), expected);
            continue;
        };
        if item.offset != Some(offset) || item.data.kind != "UIntegerT" || item.data.bits != Some(width) {
            let (kind, bits) = (quoted(item.data.kind), counted(item.data.bits));
            let found = format!("Subindex {subindex}: {kind} of {bits} bit at offset {}", counted(item.offset));
            check.broken(rule, item.at, found, expected);
        }
    }
    if data.items.len() > shapes.len() {
        check.broken(rule, data.at, format!("{} items", data.items.len()), format!("{} items", shapes.len()));
    }
}

/// The place of an item's default, its text; the variable and nothing where there is none.
fn default<'a>(variable: &Variable<'a>, subindex: u64) -> (usize, Option<&'a str>) {
    variable.default_of(subindex).map_or((variable.at, None), |(at, text)| (at, Some(text)))
}

fn zero(check: &mut Check<'_, '_>, variable: &Variable<'_>, subindex: u64) {
    // A missing default is IODD-05.
    if let (at, Some(text)) = default(variable, subindex)
        && number(text) != Some(0)
    {
        check.broken("IODD-19", at, format!("default {} of Subindex {subindex}", quoted(text)), "0");
    }
}

fn unrestricted(check: &mut Check<'_, '_>, variable: &Variable<'_>, but: &[u64]) {
    for item in variable.data.items.iter().filter(|item| item.subindex.is_none_or(|subindex| !but.contains(&subindex)))
    {
        let place =
            item.data.singles.first().map(|single| single.at).or(item.data.ranges.first().map(|range| range.at));
        if let Some(at) = place {
            let found = format!("allowed values of Subindex {}", counted(item.subindex));
            check.broken("IODD-25", at, found, "none: every value of the type is allowed");
        }
    }
}

/// The single values of an item as a list.
fn allowed(item: &Item<'_>) -> String {
    let values: Vec<&str> = item.data.singles.iter().take(8).map(|single| single.value).collect();
    match (values.is_empty(), item.data.ranges.is_empty()) {
        (true, true) => "no allowed values".to_owned(),
        (true, false) => "a range of allowed values".to_owned(),
        (false, true) => format!("allowed values {}", quoted(&values.join(" "))),
        (false, false) => format!("allowed values {} and a range", quoted(&values.join(" "))),
    }
}

/// The single values of an item, `None` when one is no number or there is a range.
fn singles(item: &Item<'_>) -> Option<Vec<u64>> {
    let values = item.data.singles.iter().map(|single| number(single.value)).collect::<Option<Vec<_>>>()?;
    item.data.ranges.is_empty().then_some(values)
}

fn version(check: &mut Check<'_, '_>, variable: &Variable<'_>) {
    let Some(item) = variable.data.item(1) else { return };
    if singles(item).as_deref() != Some(&[1]) {
        check.broken("IODD-20", item.at, format!("FSP_ProtVersion: {}", allowed(item)), "the single value 1");
    }
    let (at, text) = default(variable, 1);
    if text.and_then(number) != Some(1) {
        check.broken("IODD-20", at, format!("FSP_ProtVersion: default {}", maybe(text)), "1");
    }
}

fn mode(check: &mut Check<'_, '_>, variable: &Variable<'_>) {
    let Some(item) = variable.data.item(2) else { return };
    let (rule, most, expected) = match check.edition {
        Edition::V1_1 => ("IODD-22", 2, "the single values 1, 2 or both"),
        Edition::Iec2022 => ("IODD-21", 1, "one single value, 1 or 2"),
    };
    let values = singles(item).filter(|values| {
        (1..=most).contains(&values.len())
            && values.iter().all(|value| [1, 2].contains(value))
            && values.iter().collect::<std::collections::HashSet<_>>().len() == values.len()
    });
    let (at, text) = default(variable, 2);
    match values {
        None => check.broken(rule, item.at, format!("FSP_ProtMode: {}", allowed(item)), expected),
        Some(values) if !text.and_then(number).is_some_and(|value| values.contains(&value)) => {
            check.broken(rule, at, format!("FSP_ProtMode: default {}", maybe(text)), "an allowed value");
        }
        Some(_) => {}
    }
}

fn watchdog(check: &mut Check<'_, '_>, variable: &Variable<'_>) {
    let Some(item) = variable.data.item(3) else { return };
    let [range] = item.data.ranges.as_slice() else {
        let found = format!("FSP_Watchdog: {} ranges", item.data.ranges.len());
        return check.broken("IODD-23", item.at, found, "one range of allowed values");
    };
    if let Some(single) = item.data.singles.first() {
        check.broken("IODD-23", single.at, "FSP_Watchdog: a single value", "one range of allowed values");
    }
    let least_upper = if check.is(Edition::Iec2022) { 2 } else { 1 };
    let bounds = number(range.lower).zip(number(range.upper));
    let found = || format!("{} to {}", quoted(range.lower), quoted(range.upper));
    match bounds {
        Some((lower, upper)) if lower >= 1 && (least_upper..=65535).contains(&upper) && lower <= upper => {
            let (at, text) = default(variable, 3);
            if !text.and_then(number).is_some_and(|value| (lower..=upper).contains(&value)) {
                let found = format!("FSP_Watchdog: default {}", maybe(text));
                check.broken("IODD-23", at, found, format!("{lower} to {upper}"));
            }
        }
        _ => check.broken(
            "IODD-23",
            range.at,
            format!("FSP_Watchdog: range {}", found()),
            "a range within 1 to 65535 (ms)",
        ),
    }
}

fn struct_crc(check: &mut Check<'_, '_>, variable: &Variable<'_>, structure: &Result<Signature, String>) {
    let (at, text) = default(variable, 4);
    let value = text.and_then(number);
    if !value.is_some_and(|value| (1..=65535).contains(&value)) {
        check.broken("IODD-24", at, format!("FSP_IO_StructCRC: default {}", maybe(text)), "1 to 65535");
    } else if let Ok(signature) = structure
        && value != Some(signature.computed.into())
    {
        let expected = format!("{}, the signature over the process data description", signature.computed);
        check.doubtful("IODD-24", at, format!("FSP_IO_StructCRC: default {}", maybe(text)), expected);
    }
}

fn by_subindex(check: &mut Check<'_, '_>) {
    let pd = check.process_data();
    let records = [
        check.variable(16896).map(|variable| (&variable.data, variable.at)),
        check.variable(16897).map(|variable| (&variable.data, variable.at)),
        pd.and_then(|pd| pd.input.as_ref()).map(|direction| (&direction.data, direction.at)),
        pd.and_then(|pd| pd.output.as_ref()).map(|direction| (&direction.data, direction.at)),
    ];
    for (data, at) in records.into_iter().flatten().filter(|(data, _)| data.kind == "RecordT") {
        if !matches!(data.subindex_access.map(str::trim), Some("false" | "0")) {
            let found = format!("subindexAccessSupported {}", maybe(data.subindex_access));
            check.broken("IODD-18", data.place_or(at), found, "`false`; without it `true` is meant");
        }
    }
}

/// A variable of one value that can only be read.
fn single(
    check: &mut Check<'_, '_>,
    rule: &'static str,
    (index, id, bits): (u64, &str, u64),
    values: std::ops::RangeInclusive<u64>,
) {
    let Some(variable) = check.variable(index) else {
        let at = check.iodd.variables_at;
        return check.broken(rule, at, format!("no variable at Index {index}"), format!("`{id}`"));
    };
    if check.is(Edition::Iec2022) && is_password(variable) {
        return check.broken(
            "IODD-34",
            variable.at,
            format!("{} at Index {index}, a password of v1.1", quoted(variable.id)),
            format!("`{id}`"),
        );
    }
    if variable.id != id {
        check.broken(rule, variable.at, format!("id {}", quoted(variable.id)), format!("`{id}`"));
    }
    if variable.access != "ro" {
        check.broken(rule, variable.at, format!("{id}: accessRights {}", quoted(variable.access)), "`ro`");
    }
    if variable.data.kind != "UIntegerT" || variable.data.bits != Some(bits) {
        let found = format!("{id}: {} of {} bit", quoted(variable.data.kind), counted(variable.data.bits));
        check.broken(rule, variable.at, found, format!("UIntegerT of {bits} bit"));
    }
    if !variable.default.and_then(number).is_some_and(|value| values.contains(&value)) {
        let found = format!("{id}: default {}", maybe(variable.default));
        check.broken(rule, variable.at, found, format!("{} to {}", values.start(), values.end()));
    }
}

/// Whether a variable is one of the passwords of v1.1, by name or by kind.
fn is_password(variable: &Variable<'_>) -> bool {
    variable.access == "wo" && variable.data.kind == "StringT"
}

/// FSP_TimeToReady has units of 10 ms: 500 is 5 s.
fn times(check: &mut Check<'_, '_>) {
    if let Some(variable) = check.variable(16912)
        && variable.default.and_then(number).is_some_and(|value| (501..=32767).contains(&value))
    {
        let found = format!("V_FSP_TimeToReady: default {}", maybe(variable.default));
        check.broken("IODD-29", variable.at, found, "at most 500 (5 s); an FS-Master may drop functions beyond it");
    }
}

fn password(check: &mut Check<'_, '_>, index: u64, id: &str) {
    let Some(variable) = check.variable(index) else {
        let at = check.iodd.variables_at;
        return check.broken("IODD-33", at, format!("no variable at Index {index}"), format!("`{id}`"));
    };
    if variable.access != "wo" {
        check.broken("IODD-33", variable.at, format!("accessRights {}", quoted(variable.access)), "`wo`");
    }
    let data = &variable.data;
    if data.kind != "StringT" || data.fixed_length != Some(32) || data.encoding != "US-ASCII" {
        let (kind, length) = (quoted(data.kind), counted(data.fixed_length));
        let found = format!("{kind} of {length} octets in {}", quoted(data.encoding));
        check.broken("IODD-33", variable.at, found, "StringT of 32 octets in US-ASCII");
    }
    if variable.id != id {
        check.doubtful(
            "IODD-33",
            variable.at,
            format!("id {}", quoted(variable.id)),
            format!("`{id}`, as the sample has it"),
        );
    }
}
