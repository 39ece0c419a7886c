//! The Indices of Table A.1, the checks at FSP_VerifyRecord with the Events of Table B.1, and what survives power off.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod common;

use common::*;
use fsct_adapters::{Seen, Service, Stimulus};
use fsct_protocol::fsp::{Authenticity, INDEX_AUTHENTICITY, INDEX_PROTOCOL, INDEX_VERIFY, Protocol, VerifyRecord};
use fsct_protocol::{Edition, ProtMode};
use fsct_reference::parameters::{error_type as refused, io_struct_crc};
use rstest::rstest;

/// The signature over the technology parameter of the factory.
const ARMED: u32 = 1;

fn commissioned(variant: fsct_adapters::Variant, tech_par_crc: u32) -> Bench {
    let mut bench = Bench::factory(variant);
    bench.commission(tech_par_crc);
    bench
}

fn starts(bench: &mut Bench) -> bool {
    bench.exchange(m(0).sd());
    bench.image.unwrap().as_slice().iter().any(|octet| *octet != 0)
}

#[test]
fn factory_setting() {
    let mut bench = Bench::factory(plain());
    assert_eq!(bench.read(INDEX_AUTHENTICITY, 0), Ok(vec![0; 11]));
    let protocol = bench.protocol();
    assert_eq!((protocol.version, protocol.mode), (1, 1));
    assert_eq!(protocol.io_struct_crc, io_struct_crc(plain(), None));
    assert_ne!((protocol.watchdog_ms, protocol.tech_par_crc), (0, 0));
}

#[rstest]
#[case(INDEX_AUTHENTICITY, 0, Ok("1122334455667788051083"))]
#[case(INDEX_AUTHENTICITY, 1, Ok("11223344"))]
#[case(INDEX_AUTHENTICITY, 2, Ok("55667788"))]
#[case(INDEX_AUTHENTICITY, 3, Ok("05"))]
#[case(INDEX_AUTHENTICITY, 5, Err(refused::SUBINDEX_NOT_AVAILABLE))]
#[case(INDEX_PROTOCOL, 1, Ok("01"))]
#[case(INDEX_PROTOCOL, 2, Ok("02"))]
#[case(INDEX_PROTOCOL, 3, Ok("0064"))]
#[case(INDEX_PROTOCOL, 5, Ok("00000001"))]
#[case(INDEX_PROTOCOL, 7, Err(refused::SUBINDEX_NOT_AVAILABLE))]
#[case(INDEX_VERIFY, 0, Err(refused::ACCESS_DENIED))]
#[case(0x4203, 0, Err(refused::INDEX_NOT_AVAILABLE))]
#[case(0x4215, 0, Err(refused::INDEX_NOT_AVAILABLE))]
#[case(0x0010, 0, Err(refused::INDEX_NOT_AVAILABLE))]
fn reads(#[case] index: u16, #[case] subindex: u8, #[case] expected: Result<&str, u16>) {
    let mut bench = commissioned(variant(Edition::Iec2022, ProtMode::Crc32, 4), ARMED);
    let read = bench.read(index, subindex).map(|value| value.iter().map(|o| format!("{o:02X}")).collect::<String>());
    assert_eq!(read, expected.map(str::to_owned));
}

#[test]
fn subindices_make_up_the_block() {
    let mut bench = commissioned(plain(), ARMED);
    for (index, items) in [(INDEX_AUTHENTICITY, 4), (INDEX_PROTOCOL, 6)] {
        let parts: Vec<u8> = (1..=items).flat_map(|subindex| bench.read(index, subindex).unwrap()).collect();
        assert_eq!(bench.read(index, 0), Ok(parts));
    }
}

#[rstest]
#[case(Edition::V1_1, 0x4210, Err(refused::ACCESS_DENIED))]
#[case(Edition::V1_1, 0x4211, Err(refused::ACCESS_DENIED))]
#[case(Edition::V1_1, 0x4212, Ok(2))]
#[case(Edition::V1_1, 0x4213, Err(refused::INDEX_NOT_AVAILABLE))]
#[case(Edition::V1_1, 0x4214, Err(refused::INDEX_NOT_AVAILABLE))]
#[case(Edition::Iec2022, 0x4210, Ok(2))]
#[case(Edition::Iec2022, 0x4211, Ok(2))]
#[case(Edition::Iec2022, 0x4212, Ok(4))]
#[case(Edition::Iec2022, 0x4213, Ok(2))]
#[case(Edition::Iec2022, 0x4214, Ok(2))]
fn auxiliary_indices(#[case] edition: Edition, #[case] index: u16, #[case] octets: Result<usize, u16>) {
    let mut bench = Bench::factory(variant(edition, ProtMode::Crc16, 3));
    assert_eq!(bench.read(index, 0).map(|value| value.len()), octets);
    let password = edition == Edition::V1_1 && index < 0x4212;
    let written = match octets {
        Err(refused::INDEX_NOT_AVAILABLE) => Err(refused::INDEX_NOT_AVAILABLE),
        _ if password => Ok(()),
        _ => Err(refused::ACCESS_DENIED),
    };
    assert_eq!(bench.write(index, 0, b"xx"), written);
    assert!(bench.read(index, 1).is_err());
    if password {
        assert_eq!(bench.write(index, 0, &[b'x'; 32]), Ok(()));
        assert_eq!(bench.write(index, 0, &[b'x'; 33]), Err(refused::LENGTH_OVERRUN));
        assert_eq!(bench.write(index, 0, &[]), Err(refused::LENGTH_UNDERRUN));
        assert_eq!(bench.write(index, 0, &[0xFF]), Err(refused::VALUE_OUT_OF_RANGE));
        assert_eq!(bench.write(index, 1, b"x"), Err(refused::SUBINDEX_NOT_AVAILABLE));
    }
}

#[test]
fn blocks_are_written_whole_or_not_at_all() {
    let mut bench = commissioned(plain(), 0);
    for index in [INDEX_AUTHENTICITY, INDEX_PROTOCOL] {
        let stored = bench.read(index, 0).unwrap();
        let longer = [&stored[..], &[0]].concat();
        assert_eq!(bench.write(index, 0, &longer), Err(refused::LENGTH_OVERRUN));
        assert_eq!(bench.write(index, 0, &stored[1..]), Err(refused::LENGTH_UNDERRUN));
        assert_eq!(bench.write(index, 1, &stored[..4]), Err(refused::ACCESS_DENIED));
        assert_eq!(bench.write(index, 9, &stored[..4]), Err(refused::SUBINDEX_NOT_AVAILABLE));
        for bit in 0..stored.len() * 8 {
            let mut bad = stored.clone();
            bad[bit / 8] ^= 1 << (bit % 8);
            assert_eq!(bench.write(index, 0, &bad), Err(refused::VALUE_OUT_OF_RANGE), "bit {bit}");
        }
        assert_eq!(bench.read(index, 0), Ok(stored));
    }
}

#[rstest]
#[case::port_0(Authenticity { port: 0, ..authenticity() }, Err(refused::VALUE_OUT_OF_RANGE))]
#[case::reset(Authenticity { authenticity_1: 0, authenticity_2: 0, port: 0 }, Ok(()))]
#[case::other_port(Authenticity { port: 255, ..authenticity() }, Ok(()))]
fn authenticity_values(#[case] block: Authenticity, #[case] expected: Result<(), u16>) {
    let mut bench = commissioned(plain(), 0);
    assert_eq!(bench.write(INDEX_AUTHENTICITY, 0, &block.to_octets()), expected);
}

#[rstest]
#[case::version_0(|block: &mut Protocol| block.version = 0, Err(refused::VALUE_OUT_OF_RANGE))]
#[case::version_2(|block: &mut Protocol| block.version = 2, Err(refused::VALUE_OUT_OF_RANGE))]
#[case::mode_0(|block: &mut Protocol| block.mode = 0, Err(refused::VALUE_OUT_OF_RANGE))]
#[case::other_mode(|block: &mut Protocol| block.mode = 2, Err(refused::VALUE_OUT_OF_RANGE))]
#[case::watchdog_0(|block: &mut Protocol| block.watchdog_ms = 0, Err(refused::VALUE_OUT_OF_RANGE))]
#[case::watchdog_least(|block: &mut Protocol| block.watchdog_ms = 1, Ok(()))]
#[case::watchdog_most(|block: &mut Protocol| block.watchdog_ms = 65_535, Ok(()))]
#[case::tech_par_crc(|block: &mut Protocol| block.tech_par_crc = u32::MAX, Ok(()))]
fn protocol_values(#[case] change: fn(&mut Protocol), #[case] expected: Result<(), u16>) {
    let mut bench = commissioned(plain(), 0);
    let mut block = bench.protocol();
    change(&mut block);
    assert_eq!(bench.write(INDEX_PROTOCOL, 0, &block.to_octets()), expected);
}

#[rstest]
fn a_matching_record_starts_the_scl(
    #[values(Edition::V1_1, Edition::Iec2022)] edition: Edition,
    #[values(0, ARMED)] tech_par_crc: u32,
) {
    let mut bench = commissioned(variant(edition, ProtMode::Crc32, 4), tech_par_crc);
    bench.verify();
    assert_eq!(bench.seen(), [Seen::Written]);
    assert!(starts(&mut bench));
}

/// Every element of the record in turn, armed or not: no start, and the Event of Table B.1.
#[rstest]
#[case::authenticity_1(|record: &mut VerifyRecord| record.authenticity.authenticity_1 ^= 1, 0xB003)]
#[case::authenticity_2(|record: &mut VerifyRecord| record.authenticity.authenticity_2 ^= 1, 0xB003)]
#[case::port(|record: &mut VerifyRecord| record.authenticity.port ^= 2, 0xB004)]
#[case::port_0(|record: &mut VerifyRecord| record.authenticity.port = 0, 0xB004)]
#[case::version(|record: &mut VerifyRecord| record.protocol.version = 2, 0xB006)]
#[case::mode(|record: &mut VerifyRecord| record.protocol.mode = 3, 0xB006)]
#[case::other_watchdog(|record: &mut VerifyRecord| record.protocol.watchdog_ms += 1, 0xB006)]
#[case::tech_par_crc(|record: &mut VerifyRecord| record.protocol.tech_par_crc ^= 0x8000_0001, 0xB007)]
#[case::io_struct_crc(|record: &mut VerifyRecord| record.protocol.io_struct_crc ^= 1, 0xB008)]
#[case::watchdog_0(|record: &mut VerifyRecord| record.protocol.watchdog_ms = 0, 0xB009)]
fn a_deviating_element_starts_nothing(
    #[case] change: fn(&mut VerifyRecord),
    #[case] event: u16,
    #[values(0, ARMED)] tech_par_crc: u32,
) {
    let mut bench = commissioned(plain(), tech_par_crc);
    let mut record = VerifyRecord { authenticity: authenticity(), protocol: bench.protocol() };
    change(&mut record);
    assert_eq!(bench.write(INDEX_VERIFY, 0, &record.to_octets()), Ok(()));
    assert_eq!(bench.seen(), [Seen::Written, Seen::Event { code: event, qualifier: 0xF4 }]);
    assert!(!starts(&mut bench));
    bench.expect_service(Service::PdoutD, &[0; 3]);
}

/// Every bit of the record: a block whose signature is wrong is not looked at any further.
#[rstest]
fn a_corrupted_record_starts_nothing(#[values(0, ARMED)] tech_par_crc: u32) {
    let mut bench = commissioned(plain(), tech_par_crc);
    let record = bench.record();
    for bit in 0..record.len() * 8 {
        let mut bad = record.clone();
        bad[bit / 8] ^= 1 << (bit % 8);
        bench.write(INDEX_VERIFY, 0, &bad).unwrap();
        assert_eq!(bench.events(), [if bit < 88 { 0xB005 } else { 0xB006 }], "bit {bit}");
    }
    assert!(!starts(&mut bench));
}

/// Figure G.1: the first start of a factory device on a port set up for commissioning.
#[test]
fn a_factory_device_does_not_start() {
    let mut bench = Bench::factory(plain());
    let record =
        [&bench.read(INDEX_AUTHENTICITY, 0).unwrap()[..], &bench.read(INDEX_PROTOCOL, 0).unwrap()[..]].concat();
    bench.write(INDEX_VERIFY, 0, &record).unwrap();
    assert_eq!(bench.events(), [0xB003]);
    assert!(!starts(&mut bench));
}

#[test]
fn a_stored_structure_other_than_the_implemented_one_does_not_start() {
    let mut bench = commissioned(plain(), ARMED);
    let block = Protocol { io_struct_crc: 0x1234, ..bench.protocol() };
    bench.write(INDEX_PROTOCOL, 0, &block.to_octets()).unwrap();
    bench.verify();
    assert_eq!(bench.events(), [0xB008]);
    assert!(!starts(&mut bench));
}

#[rstest]
#[case(Edition::V1_1, &[])]
#[case(Edition::Iec2022, &[0xB00A])]
fn no_record_at_all(#[case] edition: Edition, #[case] events: &[u16]) {
    let mut bench = commissioned(variant(edition, ProtMode::Crc16, 3), 0);
    assert!(!starts(&mut bench));
    assert_eq!(bench.events(), events);
    assert!(matches!(bench.seen().last(), Some(Seen::Image { .. })));
    bench.exchange(m(1));
    assert_eq!(bench.events(), [0; 0]);
}

#[test]
fn the_record_is_written_as_one_before_operate() {
    let mut bench = commissioned(plain(), 0);
    let record = bench.record();
    let longer = [&record[..], &[0]].concat();
    assert_eq!(bench.write(INDEX_VERIFY, 1, &record[..4]), Err(refused::SUBINDEX_NOT_AVAILABLE));
    assert_eq!(bench.write(INDEX_VERIFY, 0, &record[1..]), Err(refused::LENGTH_UNDERRUN));
    assert_eq!(bench.write(INDEX_VERIFY, 0, &longer), Err(refused::LENGTH_OVERRUN));
    assert!(!starts(&mut bench));
    assert_eq!(bench.write(INDEX_VERIFY, 0, &record), Err(refused::FUNCTION_UNAVAILABLE));
    assert_eq!(bench.write(INDEX_AUTHENTICITY, 0, &record[..11]), Err(refused::FUNCTION_UNAVAILABLE));
    assert_eq!(bench.write(INDEX_PROTOCOL, 0, &record[11..]), Err(refused::FUNCTION_UNAVAILABLE));
}

#[test]
fn the_last_record_counts_and_a_rewritten_block_asks_for_another() {
    let mut bench = commissioned(plain(), 0);
    bench.verify();
    bench.write(INDEX_AUTHENTICITY, 0, &authenticity().to_octets()).unwrap();
    assert!(!starts(&mut bench));

    bench.power(false);
    bench.power(true);
    let mut bad = bench.record();
    bad[0] ^= 1;
    bench.write(INDEX_VERIFY, 0, &bad).unwrap();
    bench.verify();
    assert!(starts(&mut bench));
}

#[test]
fn blocks_survive_power_off_and_nothing_else_does() {
    let mut bench = commissioned(plain(), ARMED);
    let record = bench.record();
    bench.verify();
    bench.set(Service::PdinD, &[9, 9, 9]);
    bench.set(Service::SdsetDs, &[1]);
    bench.power(false);
    bench.power(true);
    assert_eq!(bench.record(), record);
    assert_eq!(bench.read(INDEX_AUTHENTICITY, 0).unwrap(), record[..11]);
    bench.write(INDEX_VERIFY, 0, &record).unwrap();
    (0..=3).for_each(|count| bench.exchange(m(count)));
    assert_eq!(bench.image.unwrap().as_slice()[..5], [0, 0, 0, !PORT, d(4).to_octet()]);
}

#[test]
fn configure_is_a_new_device() {
    let mut bench = commissioned(plain(), 0);
    bench.power(false);
    bench.apply(&[Stimulus::Configure(plain()), Stimulus::Power(true)]);
    assert_eq!(bench.read(INDEX_AUTHENTICITY, 0), Ok(vec![0; 11]));
}

#[test]
fn without_power_nothing_is_read_or_written() {
    let mut bench = Bench::off(plain(), Default::default());
    assert_eq!(bench.read(INDEX_PROTOCOL, 0), Err(refused::COM_ERR));
    assert_eq!(bench.write(INDEX_AUTHENTICITY, 0, &authenticity().to_octets()), Err(refused::COM_ERR));
}
