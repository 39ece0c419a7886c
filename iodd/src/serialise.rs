//! The octets behind the two signatures of an IODD: the parameter description (Figure E.1) and the FS I/O structure (Table A.4).

use crate::model::{Data, Iodd, ProcessData, Variable, number};
use fsct_protocol::ProtMode;
use fsct_protocol::fsp::{INDEX_AUTHENTICITY, INDEX_PROTOCOL, IoStructure, IoTotals};

/// The parameter description of Index 16896 and 16897 as octets (Figure E.1). Defaults and allowed values stand in it where the file gives them.
///
/// # Errors
/// What keeps the file from being serialised.
pub(crate) fn param_desc(iodd: &Iodd<'_>) -> Result<Vec<u8>, String> {
    let mut octets = Vec::new();
    for index in [INDEX_AUTHENTICITY, INDEX_PROTOCOL] {
        let variable = iodd.variable(index.into()).ok_or(format!("Index {index} is not described"))?;
        record(index, variable, &mut octets).map_err(|reason| format!("Index {index}: {reason}"))?;
    }
    Ok(octets)
}

fn record(index: u16, variable: &Variable<'_>, octets: &mut Vec<u8>) -> Result<(), String> {
    let data = &variable.data;
    octets.extend(index.to_be_bytes());
    octets.extend(short(data.bits).ok_or("its record has no bit length of 16 bit")?.to_be_bytes());
    let mut items: Vec<_> = data.items.iter().collect();
    if items.is_empty() || items.len() > 255 {
        return Err(format!("its record has {} items", items.len()));
    }
    items.sort_by_key(|item| item.subindex);
    for item in items {
        let subindex = item.subindex.and_then(|value| u8::try_from(value).ok()).ok_or("an item without Subindex")?;
        let width = match (item.data.kind, item.data.bits) {
            ("UIntegerT", Some(8)) => 1,
            ("UIntegerT", Some(16)) => 2,
            ("UIntegerT", Some(32)) => 4,
            _ => return Err(format!("Subindex {subindex} is no UIntegerT of 8, 16 or 32 bit")),
        };
        octets.push(subindex);
        octets.extend(short(item.offset).ok_or(format!("Subindex {subindex} has no bit offset"))?.to_be_bytes());
        octets.push(match width {
            1 => 1,
            2 => 2,
            _ => 3,
        });
        let given = variable.default_of(subindex.into()).map(|(_, value)| value);
        for value in given.map(number).into_iter().chain(allowed(&item.data)) {
            let value = value.filter(|&value| value < 1 << (8 * width));
            let value = value.ok_or(format!("a value of Subindex {subindex} does not fit into {width} octets"))?;
            octets.extend(value.to_be_bytes().iter().skip(8 - width));
        }
    }
    Ok(())
}

/// The allowed values of an item in the order of Figure E.1.
fn allowed(data: &Data<'_>) -> Vec<Option<u64>> {
    let mut values: Vec<_> = data.singles.iter().map(|single| number(single.value)).collect();
    values.sort();
    values.extend(data.ranges.iter().flat_map(|range| [number(range.lower), number(range.upper)]));
    values
}

fn short(value: Option<u64>) -> Option<u16> {
    value.and_then(|value| u16::try_from(value).ok())
}

/// Octets of FS process data of one direction: Booleans filled up to octets, then the integers. `None` with another type.
pub(crate) fn totals(data: &Data<'_>) -> Option<IoTotals> {
    let (mut bits, mut int16, mut int32) = (0_u8, 0_u8, 0_u8);
    for item in data.items.iter().filter(|item| item.subindex.is_some_and(|subindex| (1..=126).contains(&subindex))) {
        let count = match (item.data.kind, item.data.bits) {
            ("BooleanT", _) => &mut bits,
            ("IntegerT", Some(16)) => &mut int16,
            ("IntegerT", Some(32)) => &mut int32,
            _ => return None,
        };
        *count = count.checked_add(1)?;
    }
    let octets = bits.div_ceil(8);
    let range = u16::from(octets) + 2 * u16::from(int16) + 4 * u16::from(int32);
    Some(IoTotals { range: u8::try_from(range).ok()?, bits, octets, int16, int32 })
}

/// The FS I/O structure: the totals of both directions, each range with the safety code of the mode.
///
/// # Errors
/// What the file does not tell.
pub(crate) fn structure(process_data: Option<&ProcessData<'_>>, mode: Option<ProtMode>) -> Result<IoStructure, String> {
    let mode = mode.ok_or("the default of FSP_ProtMode is neither 1 nor 2")?;
    let process_data = process_data.ok_or("no process data are described")?;
    let side = |direction: Option<&crate::model::Direction<'_>>, name: &str| {
        let direction = direction.ok_or(format!("{name} is not described"))?;
        let totals = totals(&direction.data)
            .ok_or(format!("{name} has safety data other than BooleanT, IntegerT 16 and IntegerT 32, or too many"))?;
        let range = usize::from(totals.range) + mode.spdu_octets(0);
        Ok::<IoTotals, String>(IoTotals {
            range: u8::try_from(range).map_err(|_| format!("{name} is too long"))?,
            ..totals
        })
    };
    Ok(IoStructure {
        version: 1,
        input: side(process_data.input.as_ref(), "PDin")?,
        output: side(process_data.output.as_ref(), "PDout")?,
    })
}

/// The eleven octets of a structure in the order of Table A.4.
pub(crate) fn structure_octets(structure: &IoStructure) -> Vec<u8> {
    let side = |totals: IoTotals| [totals.range, totals.bits, totals.octets, totals.int16, totals.int32];
    std::iter::once(structure.version).chain(side(structure.input)).chain(side(structure.output)).collect()
}
