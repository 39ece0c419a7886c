//! Data Storage and the reset commands: what a device from the factory adopts, and what one in use keeps.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod common;

use common::*;
use fsct_adapters::{Service, Variant};
use fsct_protocol::fsp::{INDEX_AUTHENTICITY, INDEX_PROTOCOL};
use fsct_protocol::{Edition, ProtMode};
use fsct_reference::parameters::error_type as refused;
use rstest::rstest;

/// The signature over the technology parameter of the factory.
const ARMED: u32 = 1;
const SYSTEM_COMMAND: u16 = 0x0002;
const STORAGE: u16 = 0x0003;

fn of(edition: Edition) -> Variant {
    variant(edition, ProtMode::Crc16, 3)
}

fn command(bench: &mut Bench, code: u8) -> Result<(), u16> {
    bench.write(STORAGE, 1, &[code])
}

fn blocks(bench: &mut Bench) -> [Vec<u8>; 2] {
    [bench.read(INDEX_AUTHENTICITY, 0).unwrap(), bench.read(INDEX_PROTOCOL, 0).unwrap()]
}

/// The blocks of an armed device of the same type.
fn stored_set(variant: Variant) -> [Vec<u8>; 2] {
    let mut other = Bench::factory(variant);
    other.commission(ARMED);
    blocks(&mut other)
}

fn write_set(bench: &mut Bench, [authenticity, protocol]: &[Vec<u8>; 2]) {
    bench.write(INDEX_AUTHENTICITY, 0, authenticity).unwrap();
    bench.write(INDEX_PROTOCOL, 0, protocol).unwrap();
}

#[rstest]
fn a_device_from_the_factory_adopts_a_download_at_its_end(#[values(Edition::V1_1, Edition::Iec2022)] edition: Edition) {
    let set = stored_set(of(edition));
    let mut bench = Bench::factory(of(edition));
    let factory = blocks(&mut bench);
    command(&mut bench, 0x03).unwrap();
    assert_eq!(bench.read(STORAGE, 2), Ok(vec![0b100]));
    write_set(&mut bench, &set);
    assert_eq!(blocks(&mut bench), factory);
    command(&mut bench, 0x04).unwrap();
    assert_eq!((blocks(&mut bench), bench.read(STORAGE, 2)), (set, Ok(vec![0])));
    bench.verify();
    bench.set(Service::PdinD, &[0x1B; 3]);
    bench.exchange(m(0).sd());
    assert_eq!(bench.answer(), Some(d(7).sd_set()));
}

#[rstest]
#[case::break_off(|bench: &mut Bench| command(bench, 0x05).unwrap())]
#[case::power(|bench: &mut Bench| { bench.power(false); bench.power(true); })]
fn a_download_without_end_leaves_nothing(#[case] stop: fn(&mut Bench)) {
    let set = stored_set(plain());
    let mut bench = Bench::factory(plain());
    let factory = blocks(&mut bench);
    command(&mut bench, 0x03).unwrap();
    write_set(&mut bench, &set);
    stop(&mut bench);
    assert_eq!(command(&mut bench, 0x04), Err(refused::FUNCTION_UNAVAILABLE));
    assert_eq!(blocks(&mut bench), factory);
}

#[rstest]
#[case(Edition::V1_1, Ok(()))]
#[case(Edition::Iec2022, Err(refused::TEMPORARILY_UNAVAILABLE))]
fn a_device_in_use_keeps_what_it_has(#[case] edition: Edition, #[case] start: Result<(), u16>) {
    let set = stored_set(of(edition));
    let mut bench = Bench::factory(of(edition));
    bench.commission(0);
    let kept = blocks(&mut bench);
    assert_eq!(command(&mut bench, 0x03), start);
    if start.is_ok() {
        write_set(&mut bench, &set);
        command(&mut bench, 0x04).unwrap();
    }
    assert_eq!(blocks(&mut bench), kept);
}

#[test]
fn an_armed_device_is_uploaded() {
    let mut bench = Bench::factory(plain());
    bench.commission(ARMED);
    command(&mut bench, 0x01).unwrap();
    assert_eq!(bench.read(STORAGE, 2), Ok(vec![0b010]));
    assert_eq!(bench.read(STORAGE, 5), Ok(vec![0x42, 0x00, 0, 0x42, 0x01, 0, 0x00, 0x40, 0, 0, 0]));
    assert_eq!(bench.read(STORAGE, 3), Ok(vec![0, 0, 0, 39]));
    let checksum = bench.read(STORAGE, 4).unwrap();
    command(&mut bench, 0x02).unwrap();
    bench.commission(ARMED + 1);
    assert_ne!(bench.read(STORAGE, 4), Ok(checksum));
}

#[rstest]
#[case(1, &[0x00], refused::VALUE_OUT_OF_RANGE)]
#[case(1, &[0x06], refused::VALUE_OUT_OF_RANGE)]
#[case(1, &[0x02], refused::FUNCTION_UNAVAILABLE)]
#[case(1, &[0x03, 0x03], refused::LENGTH_OVERRUN)]
#[case(1, &[], refused::LENGTH_UNDERRUN)]
#[case(2, &[0x03], refused::ACCESS_DENIED)]
#[case(6, &[0x03], refused::SUBINDEX_NOT_AVAILABLE)]
fn other_writes_are_refused(#[case] subindex: u8, #[case] data: &[u8], #[case] error: u16) {
    let mut bench = Bench::factory(plain());
    assert_eq!(bench.write(STORAGE, subindex, data), Err(error));
    assert_eq!(bench.read(STORAGE, 2), Ok(vec![0]));
}

#[rstest]
#[case(Edition::V1_1, 0x82, Some(true))]
#[case(Edition::V1_1, 0x81, None)]
#[case(Edition::V1_1, 0x83, None)]
#[case(Edition::Iec2022, 0x80, None)]
#[case(Edition::Iec2022, 0x81, Some(false))]
#[case(Edition::Iec2022, 0x82, None)]
#[case(Edition::Iec2022, 0x83, Some(true))]
fn reset_commands(#[case] edition: Edition, #[case] code: u8, #[case] to_the_factory: Option<bool>) {
    let mut bench = Bench::factory(of(edition));
    let factory = blocks(&mut bench);
    bench.commission(ARMED);
    let armed = blocks(&mut bench);
    let expected =
        if to_the_factory.is_some() { refused::FUNCTION_UNAVAILABLE } else { refused::FUNCTION_NOT_AVAILABLE };
    assert_eq!(bench.write(SYSTEM_COMMAND, 0, &[code]), Err(expected));
    assert_eq!(blocks(&mut bench), armed);

    bench.commission(0);
    let commissioned = blocks(&mut bench);
    assert_eq!(bench.write(SYSTEM_COMMAND, 0, &[code]).is_ok(), to_the_factory.is_some());
    assert_eq!(blocks(&mut bench), if to_the_factory == Some(true) { factory } else { commissioned });
}

#[test]
fn profile_and_access_lock() {
    let mut bench = Bench::factory(plain());
    assert_eq!(bench.read(0x000C, 0), Ok(vec![0, 0]));
    assert_eq!(bench.read(0x000D, 0), Ok(vec![0x40, 0x01]));
    assert_eq!(bench.write(0x000D, 0, &[0, 0]), Err(refused::ACCESS_DENIED));
}
