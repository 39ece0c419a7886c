//! FS I/O data against Annex C and Tables 34 to 36.

use fsct_protocol::ProtMode;
use fsct_protocol::fsp::IoStructure;
use fsct_protocol::io::{Category, IoValues, Terminal};
use proptest::prelude::*;
use rstest::rstest;

fn values(bits: u8, int16: u8, int32: u8) -> IoValues {
    IoValues { bits, int16, int32 }
}

/// FSP_IO_StructCRC a second time: the items of Table A.4 bit by bit through a division by 0x14EAB.
fn divided(mode: ProtMode, directions: [IoValues; 2]) -> u16 {
    let code = if mode == ProtMode::Crc16 { 4 } else { 6 };
    let mut items = vec![1u8];
    for IoValues { bits, int16, int32 } in directions {
        let filled = bits / 8 + u8::from(bits % 8 != 0);
        items.extend([filled + 2 * int16 + 4 * int32 + code, bits, filled, int16, int32]);
    }
    assert_eq!(items.len(), 11);
    let stream = items.iter().chain(&[0, 0]).flat_map(|octet| (0..8).rev().map(move |bit| u32::from(octet >> bit & 1)));
    let rest = stream.fold(0u32, |rest, bit| {
        let next = rest << 1 | bit;
        if next > 0xFFFF { next ^ 0x1_4EAB } else { next }
    });
    u16::try_from(rest).expect("16 bits")
}

/// Figure A.1 and the sample IODD, then a trailer alone in either mode.
#[rstest]
#[case::a(ProtMode::Crc32, values(13, 1, 0), 0x9A28)]
#[case::b(ProtMode::Crc32, values(0, 0, 0), 0x5712)]
#[case::c(ProtMode::Crc16, values(0, 0, 0), 0xDEC1)]
fn known_structures(#[case] mode: ProtMode, #[case] input: IoValues, #[case] crc: u16) {
    let structure = IoStructure::new(mode, input, IoValues::default()).expect("it fits");
    assert_eq!((structure.signature(), divided(mode, [input, IoValues::default()])), (crc, crc));
}

/// The sample IODD has four octets of data with the trailer of CRC-16, which the mode itself does not allow.
#[test]
fn the_structure_of_the_sample_iodd_does_not_fit_its_mode() {
    assert_eq!(divided(ProtMode::Crc16, [values(13, 1, 0), IoValues::default()]), 0x13FB);
    assert_eq!(IoStructure::new(ProtMode::Crc16, values(13, 1, 0), IoValues::default()), None);
}

#[rstest]
#[case::none(values(0, 0, 0), 0, None)]
#[case::one(values(1, 0, 0), 1, Some((0, 0xFE)))]
#[case::full(values(8, 0, 0), 1, None)]
#[case::figure_a_1(values(13, 1, 0), 4, Some((1, 0xE0)))]
#[case::seven_of_the_last(values(15, 0, 1), 6, Some((1, 0x80)))]
fn padding_is_the_rest_of_the_last_boolean_octet(
    #[case] values: IoValues,
    #[case] octets: usize,
    #[case] padding: Option<(usize, u8)>,
) {
    assert_eq!((values.octets(), values.padding()), (octets, padding));
    let mut data = vec![0xFF; octets];
    assert_eq!(values.padded(&data), padding.is_none());
    values.clear_padding(&mut data);
    assert!(values.padded(&data));
    let cleared: u32 = data.iter().map(|octet| octet.count_zeros()).sum();
    assert_eq!(cleared, padding.map_or(0, |(_, bits)| bits.count_ones()));
}

#[test]
fn the_example_of_annex_c() {
    let five = values(5, 0, 0);
    let mut data = [0];
    for (index, value) in (0..).zip([true, false, false, true, true]) {
        five.set_boolean(&mut data, index, value).expect("there are five");
    }
    assert_eq!(data, [0x19]);
    assert_eq!(five.set_boolean(&mut data, 5, true), None);
}

#[rstest]
#[case(i16::MIN, [0x80, 0x00])]
#[case(-1, [0xFF, 0xFF])]
#[case(0, [0, 0])]
#[case(1, [0, 1])]
#[case(i16::MAX, [0x7F, 0xFF])]
fn coding_of_integer_16(#[case] value: i16, #[case] octets: [u8; 2]) {
    let mut data = [0xAA; 3];
    values(1, 1, 0).set_int16(&mut data, 0, value).expect("there is one");
    assert_eq!(data, [0xAA, octets[0], octets[1]]);
}

#[rstest]
#[case(i32::MIN, [0x80, 0, 0, 0])]
#[case(-1, [0xFF; 4])]
#[case(1, [0, 0, 0, 1])]
#[case(i32::MAX, [0x7F, 0xFF, 0xFF, 0xFF])]
fn coding_of_integer_32(#[case] value: i32, #[case] octets: [u8; 4]) {
    let mut data = [0; 6];
    values(0, 1, 1).set_int32(&mut data, 0, value).expect("there is one");
    assert_eq!((data[..2].to_vec(), data[2..].to_vec()), (vec![0, 0], octets.to_vec()));
}

/// Rules 4 to 8 of Table 35 in the order of Table 36.
#[rstest]
#[case::di_and_do(values(8, 0, 0), values(4, 0, 0), 3, &[(Category::Di, 7, (1, 7)), (Category::Do, 3, (2, 3))])]
#[case::more_than_an_octet(values(9, 0, 0), values(0, 0, 0), 4, &[(Category::Di, 8, (3, 0))])]
#[case::outputs_alone(values(0, 0, 0), values(2, 1, 1), 2, &[(Category::Do, 0, (0, 0)), (Category::Ao, 1, (1, 1))])]
#[case::all(values(1, 1, 0), values(1, 0, 1), 7,
    &[(Category::Di, 0, (3, 0)), (Category::Ai, 0, (4, 0)), (Category::Do, 0, (5, 0)), (Category::Ao, 0, (6, 0))])]
fn qualifiers_of_a_terminal(
    #[case] input: IoValues,
    #[case] output: IoValues,
    #[case] octets: usize,
    #[case] places: &[(Category, usize, (usize, u8))],
) {
    let terminal = Terminal { input, output };
    assert_eq!(terminal.octets(), octets);
    for (category, index, place) in places {
        assert_eq!(terminal.qualifier(*category, *index), Some(*place), "{category:?} {index}");
    }
    assert_eq!(terminal.qualifier(Category::Ai, 9), None);
}

/// Counts that fit into the longest SPDU.
fn any_values() -> impl Strategy<Value = IoValues> {
    (0..=200u8, 0..=12u8, 0..=6u8)
        .prop_map(|(bits, int16, int32)| values(bits, int16, int32))
        .prop_filter("too long", |values| values.octets() <= ProtMode::Crc32.max_pd())
}

proptest! {
    #[test]
    fn structure_crc_is_that_of_the_division(input in any_values(), output in any_values()) {
        let structure = IoStructure::new(ProtMode::Crc32, input, output).expect("it fits");
        prop_assert_eq!(structure.signature(), divided(ProtMode::Crc32, [input, output]));
    }

    /// What is put in comes out, wherever it stands, and no value touches another or the padding.
    #[test]
    fn values_come_back(values in any_values(), seed in any::<u64>()) {
        let of = |place: u64| seed.rotate_left((place % 64) as u32) ^ place.wrapping_mul(0x9E37_79B9_7F4A_7C15);
        let mut data = vec![0; values.octets()];
        for index in 0..values.bits { values.set_boolean(&mut data, index, of(index.into()) & 1 == 1).expect("one"); }
        for index in 0..values.int16 { values.set_int16(&mut data, index, of(index.into()) as i16).expect("one"); }
        for index in 0..values.int32 { values.set_int32(&mut data, index, of(index.into()) as i32).expect("one"); }
        prop_assert!(values.padded(&data));
        for index in 0..values.bits { prop_assert_eq!(values.boolean(&data, index), Some(of(index.into()) & 1 == 1)); }
        for index in 0..values.int16 { prop_assert_eq!(values.int16(&data, index), Some(of(index.into()) as i16)); }
        for index in 0..values.int32 { prop_assert_eq!(values.int32(&data, index), Some(of(index.into()) as i32)); }
        prop_assert_eq!(values.boolean(&data, values.bits), None);
        prop_assert_eq!(values.int16(&data, values.int16), None);
        prop_assert_eq!(values.int32(&data, values.int32), None);
    }

    /// Octets of any length are read without a panic.
    #[test]
    fn short_data_have_no_values(values in any_values(), data in proptest::collection::vec(any::<u8>(), 0..4), index: u8) {
        let _ = (values.boolean(&data, index), values.int16(&data, index), values.int32(&data, index), values.padded(&data));
    }
}
