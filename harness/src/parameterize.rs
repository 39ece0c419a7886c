//! FSP parameterization of an FS-Device as a case asks for it: the records of the profile, and how the verify record
//! deviates from them.

use crate::case::model::{Blocks, Parameterize, RecordField, Sent, Value};
use crate::profile::Profile;
use fsct_protocol::ProtMode;
use fsct_protocol::crc::crc16;
use fsct_protocol::fsp::{INDEX_AUTHENTICITY, INDEX_VERIFY, VerifyRecord};

/// The fields that are computed over the others.
const SIGNATURES: [&str; 2] = ["FSP_AuthentCRC", "FSP_ProtParCRC"];

/// The records to be written, in order.
pub fn records(profile: &Profile, asked: &Parameterize, mode: ProtMode, io_struct_crc: u16) -> Vec<(u16, Vec<u8>)> {
    let tech_par_crc = if asked.armed { profile.armed_tech_par_crc() } else { profile.tech_par_crc };
    let mut records = profile.records(mode, io_struct_crc, tech_par_crc);
    records.retain(|(index, _)| match *index {
        INDEX_VERIFY => asked.record != Sent::None,
        INDEX_AUTHENTICITY => asked.blocks == Blocks::Written,
        _ => asked.blocks != Blocks::Kept,
    });
    for (_, record) in records.iter_mut().filter(|(index, _)| *index == INDEX_VERIFY) {
        deviate(record, &asked.set);
        if asked.record == Sent::Swapped {
            for field in &RecordField::ALL {
                record.get_mut(field.octets.0..field.octets.1).into_iter().for_each(<[u8]>::reverse);
            }
        }
        corrupt(record, &asked.corrupt);
        record.resize(record.len().saturating_add_signed(asked.longer.into()), 0);
    }
    records
}

fn deviate(record: &mut [u8], set: &[(&'static RecordField, Value)]) {
    let (signatures, values): (Vec<_>, Vec<_>) =
        set.iter().copied().partition(|(field, _)| SIGNATURES.contains(&field.name));
    values.into_iter().for_each(|(field, value)| put(record, field, value));
    for (covered, signature) in [(0..9, 9..11), (11..21, 21..VerifyRecord::OCTETS)] {
        let computed = record.get(covered).map(|octets| crc16(0, octets).to_be_bytes());
        if let (Some(field), Some(computed)) = (record.get_mut(signature), computed) {
            field.copy_from_slice(&computed);
        }
    }
    signatures.into_iter().for_each(|(field, value)| put(record, field, value));
}

/// Inverts these bits.
pub fn corrupt(record: &mut [u8], bits: &[usize]) {
    for bit in bits {
        record.get_mut(bit / 8).into_iter().for_each(|octet| *octet ^= 0x80 >> (bit % 8));
    }
}

fn put(record: &mut [u8], field: &RecordField, value: Value) {
    let Some(octets) = record.get_mut(field.octets.0..field.octets.1) else { return };
    match value {
        Value::Number(number) => {
            let number = number.to_be_bytes();
            octets.iter_mut().rev().zip(number.iter().rev()).for_each(|(octet, value)| *octet = *value);
        }
        Value::Wrong => octets.last_mut().into_iter().for_each(|octet| *octet ^= 1),
        Value::Profile => {}
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use fsct_protocol::fsp::{Authenticity, Protocol};

    fn field(name: &str) -> &'static RecordField {
        RecordField::ALL.iter().find(|field| field.name == name).expect("a field of the verify record")
    }

    fn record() -> Vec<u8> {
        let authenticity = Authenticity { authenticity_1: 0x1122_3344, authenticity_2: 0, port: 1 };
        let protocol = Protocol { version: 1, mode: 1, watchdog_ms: 20, io_struct_crc: 0x1234, tech_par_crc: 7 };
        VerifyRecord { authenticity, protocol }.to_octets().to_vec()
    }

    #[test]
    fn a_deviation_has_a_right_signature() {
        let mut deviating = record();
        deviate(&mut deviating, &[(field("FSP_Port"), Value::Number(200)), (field("FSP_Watchdog"), Value::Wrong)]);
        assert_eq!(Authenticity::from_octets(&deviating[..11]).map(|block| block.port), Ok(200));
        assert_eq!(Protocol::from_octets(&deviating[11..]).map(|block| block.watchdog_ms), Ok(21));
    }

    #[test]
    fn bits_are_counted_from_the_most_significant() {
        let mut falsified = record();
        corrupt(&mut falsified, &[0, 183, 400]);
        assert_eq!((falsified[0], falsified[22]), (record()[0] ^ 0x80, record()[22] ^ 1));
    }

    #[test]
    fn a_wrong_signature_is_the_only_deviation() {
        let mut deviating = record();
        deviate(&mut deviating, &[(field("FSP_ProtParCRC"), Value::Wrong)]);
        let changed: Vec<usize> = (0..23).filter(|at| deviating[*at] != record()[*at]).collect();
        assert_eq!(changed, [22]);
    }
}
