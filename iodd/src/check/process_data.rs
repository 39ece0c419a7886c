//! IODD-35 to IODD-46: process data.

use super::{Check, counted, maybe, quoted};
use crate::model::{Data, Direction, Item};
use crate::serialise::totals;
use fsct_protocol::{Edition, ProtMode};
use std::collections::HashSet;

/// The Subindex of the safety code.
const CODE: u64 = 127;
/// Process data of the base standard, in bit.
const MOST_BITS: u64 = 256;
/// The shortest SPDU, in bit.
const LEAST_BITS: u64 = 32;

/// A direction with what the profile calls it.
struct Side<'s, 'a> {
    name: &'static str,
    direction: &'s Direction<'a>,
    output: bool,
}

pub(super) fn check(check: &mut Check<'_, '_>) {
    let iodd = check.iodd;
    if iodd.process_data.len() > 1 {
        let at = iodd.process_data.get(1).map_or(iodd.process_data_at, |second| second.at);
        check.broken("IODD-42", at, format!("{} process data structures", iodd.process_data.len()), "one");
    }
    let Some(pd) = check.process_data() else {
        return check.broken("IODD-35", iodd.process_data_at, "no process data", "PDin and PDout");
    };
    match pd.condition {
        Some(at) if check.is(Edition::V1_1) => check.broken("IODD-42", at, "a condition", "none"),
        Some(at) => check.doubtful("IODD-42", at, "a condition", "none, unless it switches scaling or units alone"),
        None => {}
    }
    if !pd.id.starts_with("P_") {
        check.broken("IODD-43", pd.at, format!("id {}", quoted(pd.id)), "`P_...`");
    }
    for (name, output, direction) in [("PDin", false, &pd.input), ("PDout", true, &pd.output)] {
        match direction {
            Some(direction) => side(check, &Side { name, direction, output }),
            None => check.broken("IODD-35", pd.at, format!("no {name}"), "a record, for the safety code at least"),
        }
    }
}

fn side(check: &mut Check<'_, '_>, side: &Side<'_, '_>) {
    let Side { name, direction, .. } = side;
    names(check, side);
    shown(check, side);
    let data = &direction.data;
    if let Some(bits) = direction.bits.max(data.bits).filter(|&bits| bits > MOST_BITS) {
        check.broken("IODD-45", direction.at, format!("{name} of {bits} bit"), "at most 256 (32 octets)");
    }
    if data.kind != "RecordT" {
        return check.broken(
            "IODD-35",
            data.place_or(direction.at),
            format!("{name} is {}", quoted(data.kind)),
            "RecordT",
        );
    }
    subindices(check, name, data);
    order(check, name, data);
    safety_types(check, name, data);
    booleans(check, name, data);
    code(check, side);
    size(check, name, data);
}

/// The items of safety data, by Subindex.
fn safety<'d, 'a>(data: &'d Data<'a>) -> Vec<&'d Item<'a>> {
    let safe = |item: &&Item<'_>| item.subindex.is_some_and(|subindex| (1..CODE).contains(&subindex));
    let mut items: Vec<_> = data.items.iter().filter(safe).collect();
    items.sort_by_key(|item| item.subindex);
    items
}

/// Bits an item fills.
fn width(item: &Item<'_>) -> Option<u64> {
    match item.data.kind {
        "BooleanT" => Some(1),
        _ => item.data.bits.or(item.data.fixed_length.and_then(|octets| octets.checked_mul(8))),
    }
}

/// The first bit of an item and the first beyond it.
fn span(item: &Item<'_>) -> Option<(u64, u64)> {
    let offset = item.offset?;
    Some((offset, offset.checked_add(width(item)?)?))
}

fn subindices(check: &mut Check<'_, '_>, name: &str, data: &Data<'_>) {
    let mut seen = HashSet::new();
    for item in &data.items {
        match item.subindex {
            Some(subindex @ 1..=255) if seen.insert(subindex) => {}
            Some(subindex @ 1..=255) => {
                check.broken(
                    "IODD-36",
                    item.at,
                    format!("{name}: Subindex {subindex} once more"),
                    "each Subindex once",
                );
            }
            other => {
                let expected = "1 to 126 for safety data, 127 for the safety code, 128 to 255 for the rest";
                check.broken("IODD-36", item.at, format!("{name}: Subindex {}", counted(other)), expected);
            }
        }
    }
}

/// Safety data at the top, the safety code right below their lowest octet, everything else below it.
fn order(check: &mut Check<'_, '_>, name: &str, data: &Data<'_>) {
    let Some(((lower, upper), code_at)) = data.item(CODE).and_then(|code| Some((span(code)?, code.at))) else { return };
    let Some(bits) = data.bits else { return };
    let safe: Vec<_> = safety(data).into_iter().filter_map(|item| Some((span(item)?, item.at))).collect();
    let top = safe.iter().max_by_key(|((_, end), _)| *end).map_or((upper, code_at), |&((_, end), at)| (end, at));
    if top.0.div_ceil(8) != bits.div_ceil(8) {
        let found = format!("{name}: the first safety octet ends at bit {}", top.0.div_ceil(8).saturating_mul(8));
        let expected = format!("at bit {bits}, the end of the record");
        // Of a safety code alone the clause does not speak, and the v1.1 sample leaves octets free above it.
        if safe.is_empty() {
            check.doubtful("IODD-37", top.1, found, expected);
        } else {
            check.broken("IODD-37", top.1, found, expected);
        }
    }
    if let Some(begin) = safe.iter().map(|((begin, _), _)| begin / 8 * 8).min().filter(|&begin| begin != upper) {
        let found = format!("{name}: the safety code ends at bit {upper}, the safety data begin at bit {begin}");
        check.broken("IODD-37", code_at, found, "the safety code right after the safety data");
    }
    for item in data.items.iter().filter(|item| item.subindex.is_some_and(|subindex| subindex > CODE)) {
        if let Some((_, end)) = span(item).filter(|&(_, end)| end > lower) {
            let found = format!("{name}: Subindex {} ends at bit {end}", counted(item.subindex));
            check.broken("IODD-37", item.at, found, format!("below the safety code, which begins at bit {lower}"));
        }
    }
}

fn safety_types(check: &mut Check<'_, '_>, name: &str, data: &Data<'_>) {
    let mut highest = 0;
    for item in safety(data) {
        let rank = match (item.data.kind, item.data.bits) {
            ("BooleanT", _) => 1,
            ("IntegerT", Some(16)) => 2,
            ("IntegerT", Some(32)) => 3,
            (kind, bits) => {
                let found =
                    format!("{name}: Subindex {} is {} of {} bit", counted(item.subindex), quoted(kind), counted(bits));
                check.broken("IODD-38", item.at, found, "BooleanT, IntegerT of 16 or of 32 bit");
                continue;
            }
        };
        if rank < highest {
            let found = format!("{name}: Subindex {} after a longer type", counted(item.subindex));
            let expected = "Booleans, then IntegerT 16, then IntegerT 32";
            if check.is(Edition::V1_1) {
                check.doubtful("IODD-38", item.at, found, expected);
            } else {
                check.broken("IODD-38", item.at, found, expected);
            }
        }
        highest = highest.max(rank);
    }
}

fn booleans(check: &mut Check<'_, '_>, name: &str, data: &Data<'_>) {
    let items = safety(data);
    let booleans: Vec<_> = items.iter().filter(|item| item.data.kind == "BooleanT").collect();
    let top = booleans.iter().filter_map(|item| item.offset).max().map_or(0, |offset| offset / 8);
    for (item, number) in booleans.into_iter().zip(0_u64..) {
        let wanted = top.checked_sub(number / 8).map(|octet| 8 * octet + number % 8);
        if item.offset != wanted {
            let found = format!("{name}: Boolean {} at offset {}", number + 1, counted(item.offset));
            return check.broken("IODD-39", item.at, found, format!("offset {}, without a gap", counted(wanted)));
        }
    }
    for item in items.iter().filter(|item| item.data.kind == "IntegerT") {
        if item.offset.is_some_and(|offset| offset % 8 != 0) {
            let found = format!("{name}: integer at offset {}", counted(item.offset));
            check.broken("IODD-39", item.at, found, "a multiple of 8");
        }
    }
}

fn code(check: &mut Check<'_, '_>, side: &Side<'_, '_>) {
    let Side { name, direction, output } = side;
    let data = &direction.data;
    let rule = if check.is(Edition::V1_1) { "IODD-41" } else { "IODD-40" };
    let Some(item) = data.item(CODE) else {
        let at = data.place_or(direction.at);
        return check.broken(rule, at, format!("{name}: no Subindex 127"), "the safety code, an OctetStringT");
    };
    let length = item.data.fixed_length.filter(|_| item.data.kind == "OctetStringT");
    let wanted = check.mode.map(|mode| mode.spdu_octets(0) as u64);
    let found = match length {
        Some(length) => format!("{name}: a safety code of {length} octets"),
        None if item.data.kind.is_empty() => format!("{name}: Subindex 127 has no data type"),
        None => {
            format!("{name}: Subindex 127 is {} of {} octets", quoted(item.data.kind), counted(item.data.fixed_length))
        }
    };
    let expected = match check.mode {
        Some(mode) => format!("an OctetStringT of {} octets with FSP_ProtMode {}", mode.spdu_octets(0), mode.code()),
        None => "an OctetStringT of 4 or 6 octets".to_owned(),
    };
    match (check.edition, length) {
        (Edition::Iec2022, Some(4 | 6)) if length == wanted || wanted.is_none() => {}
        (Edition::Iec2022, Some(6)) if *output => {
            check.doubtful(rule, item.at, found, format!("{expected}; the snippet prints 6 for PDout in any mode"));
        }
        (Edition::Iec2022, _) => check.broken(rule, item.at, found, expected),
        (Edition::V1_1, Some(4 | 6)) if length == wanted || wanted.is_none() => {}
        (Edition::V1_1, Some(4 | 6)) => check.broken("IODD-46", item.at, found, expected),
        (Edition::V1_1, Some(3 | 5)) => {
            check.doubtful(rule, item.at, found, "4 or 6, the length of 11.4.3; E.4.2 leaves PortNum out");
        }
        (Edition::V1_1, _) => check.broken(rule, item.at, found, "an OctetStringT of 4 or 6 octets"),
    }
}

fn size(check: &mut Check<'_, '_>, name: &str, data: &Data<'_>) {
    let Some((mode, octets)) = check.mode.zip(totals(data).map(|totals| usize::from(totals.range))) else { return };
    if octets <= mode.max_pd() {
        return;
    }
    let found = format!("{name}: {octets} octets of safety data with FSP_ProtMode {}", mode.code());
    let expected = format!("at most {}", mode.max_pd());
    // 11.2 of v1.1 names 4 and 26.
    let named = matches!((mode, octets), (ProtMode::Crc16, 4) | (ProtMode::Crc32, 26));
    if named && check.is(Edition::V1_1) {
        check.doubtful("IODD-45", data.at, found, format!("{expected} by A.2.5, though 11.2 names {octets}"));
    } else {
        check.broken("IODD-45", data.at, found, expected);
    }
}

fn names(check: &mut Check<'_, '_>, side: &Side<'_, '_>) {
    let Side { name, direction, output } = side;
    let data = &direction.data;
    let (id, record) = if *output { ("PO_PDout", "D_FSP_PDout") } else { ("PI_PDin", "D_FSP_PDin") };
    if !direction.id.starts_with(id) {
        check.broken("IODD-43", direction.at, format!("{name}: id {}", quoted(direction.id)), format!("`{id}...`"));
    }
    if !data.id.starts_with(record) {
        let found = format!("{name}: data type {}", quoted(data.id));
        check.broken("IODD-43", data.place_or(direction.at), found, format!("`{record}...`"));
    }
    if let Some(bits) = direction.bits.filter(|&bits| bits < LEAST_BITS) {
        check.broken("IODD-43", direction.at, format!("{name} of {bits} bit"), "at least 32, the shortest safety code");
    }
    for item in safety(data) {
        let texts = [(item.name, "TN_V_FST_"), (item.description.unwrap_or_default(), "TD_V_FST_")];
        let values = item.data.singles.iter().filter_map(|single| Some((single.name?, "TN_SV_FST_")));
        for (text, begin) in texts.into_iter().chain(values) {
            if !text.starts_with(begin) {
                let found = format!("{name}: Subindex {} with text {}", counted(item.subindex), quoted(text));
                check.broken("IODD-43", item.at, found, format!("`{begin}...`"));
            }
        }
    }
}

fn shown(check: &mut Check<'_, '_>, side: &Side<'_, '_>) {
    let Side { name, direction, .. } = side;
    let iodd = check.iodd;
    let Some(shown) = iodd.shown.iter().find(|shown| shown.id == direction.id) else {
        let found = format!("no ProcessDataRef to {}", quoted(direction.id));
        return check.broken("IODD-44", iodd.shown_at, found, format!("{name} with its safety code"));
    };
    match shown.items.iter().find(|(_, subindex, _)| *subindex == Some(CODE)) {
        Some((_, _, Some("Hex"))) => {}
        Some((at, _, format)) => {
            check.broken("IODD-44", *at, format!("{name}: Subindex 127 in format {}", maybe(*format)), "`Hex`");
        }
        None => check.broken(
            "IODD-44",
            shown.at,
            format!("{name}: Subindex 127 is not shown"),
            "Subindex 127 in format `Hex`",
        ),
    }
}
