//! What the FS-Master verifies of a port, the Device first, then its own parameters; EventCodes and DiagEntries.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod master_common;

use fsct_adapters::{Mode, Octets, Response, Seen, Service, SmiService, Source, Stimulus};
use fsct_protocol::Edition;
use master_common::*;
use rstest::rstest;

const ERROR: u8 = 0xFC;

fn port_event(code: u16) -> Seen {
    Seen::Indication { port: PORT, source: Source::Port, qualifier: ERROR, code }
}

#[rstest]
#[case::vendor(|list: &mut List| list.vendor_id += 1)]
#[case::device(|list: &mut List| list.device_id += 1)]
#[case::cycle_time(|list: &mut List| list.cycle_time = 19)]
fn another_device_than_configured_stays_in_preoperate(
    #[values(Edition::V1_1, Edition::Iec2022)] edition: Edition,
    #[case] change: fn(&mut List),
) {
    let mut other = list(of(edition));
    change(&mut other);
    let mut bench = Bench::factory(of(edition));
    bench.configure(&other);
    bench.start_up_to_record();
    assert_eq!(bench.seen(), [wake_up(), mode(Mode::Startup), mode(Mode::Preoperate), port_event(0x1803)]);
    assert_eq!((bench.info(), bench.diags()), (2, vec![(ERROR, 0x1803)]));
    bench.advance(60 * S);
    assert_eq!(bench.last, []);
    // The right one instead.
    bench.plug(None);
    bench.advance(2 * S);
    let right = List { cycle_time: 20, ..other };
    bench.plug(Some(fsct_adapters::Identity { min_cycle_time: 19, ..right.identity() }));
    bench.start();
    assert_eq!((bench.info(), bench.diags()), (8, vec![]));
}

#[test]
fn validation_0_checks_no_device() {
    let mut bench = Bench::factory(plain());
    bench.configure(&List { validation: 0, device_id: 1, ..list(plain()) });
    bench.start();
    assert_eq!(bench.info(), 8);
}

type Change = fn(&mut List);

/// Table B.2: EventCode per edition; 0 where the SCL starts.
#[rstest]
#[case::watchdog(|list: &mut List| list.protocol.watchdog_ms = 0, 0xB009, 0x2009)]
#[case::version(|list: &mut List| list.protocol.version = 2, 0xB006, 0x2006)]
#[case::mode(|list: &mut List| list.protocol.mode = 3, 0xB006, 0x2006)]
#[case::spdu_out(|list: &mut List| list.spdu_out = 8, 0xB006, 0x2006)]
#[case::authenticity(|list: &mut List| list.authenticity.authenticity_2 ^= 1, 0xB003, 0x2003)]
#[case::authenticity_in_commissioning(
    |list: &mut List| (list.authenticity.authenticity_1, list.protocol.tech_par_crc) = (0, 0), 0xB003, 0)]
#[case::port(|list: &mut List| list.authenticity.port = 1, 0xB004, 0)]
#[case::commissioning(|list: &mut List| list.protocol.tech_par_crc = 0, 0, 0)]
fn what_the_scl_of_the_master_verifies(
    #[values(Edition::V1_1, Edition::Iec2022)] edition: Edition,
    #[case] change: Change,
    #[case] v1_1: u16,
    #[case] iec2022: u16,
) {
    let mut deviating = list(of(edition));
    change(&mut deviating);
    let mut bench = Bench::factory(of(edition));
    bench.fscp(AUTHENTICITY);
    bench.configure(&deviating);
    bench.start();
    let code = if edition == Edition::V1_1 { v1_1 } else { iec2022 };
    if code == 0 {
        assert_eq!((bench.seen(), bench.info()), (vec![mode(Mode::Operate)], 8));
        return;
    }
    assert_eq!(bench.seen(), [mode(Mode::Operate), port_event(code)]);
    assert_eq!((bench.info(), bench.diags()), (4, vec![(ERROR, code)]));
    // All octets 0 where the SPDU would be.
    bench.answer(d(7));
    assert_eq!(bench.seen().len(), 1);
    assert_eq!(bench.image, Some(Octets::zero(deviating.spdu_out.into())));
}

#[rstest]
#[case::authent_crc(9, 0xB005, 0x2005)]
#[case::authenticity(0, 0xB005, 0x2005)]
#[case::prot_par_crc(21, 0xB006, 0x2006)]
#[case::watchdog(14, 0xB006, 0x2006)]
fn signatures_of_the_record_are_verified(
    #[values(Edition::V1_1, Edition::Iec2022)] edition: Edition,
    #[case] octet: usize,
    #[case] v1_1: u16,
    #[case] iec2022: u16,
) {
    let (record, code) = if edition == Edition::V1_1 { (14, v1_1) } else { (16, iec2022) };
    let mut octets = list(of(edition)).octets();
    octets[record + octet] ^= 0x40;
    let mut bench = Bench::factory(of(edition));
    assert!(bench.smi(SmiService::PortConfiguration, PORT, &octets).positive);
    bench.start_up_to_record();
    let sent = Seen::Request { port: PORT, index: 0x4202, subindex: 0, data: Some(octets[record..][..23].to_vec()) };
    assert!(bench.seen().contains(&sent));
    bench.respond(Response::Written);
    assert_eq!(bench.events(), [code]);
}

#[test]
fn without_authenticity_from_above_there_is_nothing_to_compare_with() {
    let mut bench = Bench::factory(of(Edition::V1_1));
    bench.configure(&list(of(Edition::V1_1)));
    bench.start();
    assert_eq!(bench.info(), 8);
}

/// iec2022: FSP_Port is what goes out as PortNum.
#[test]
fn port_num_is_fsp_port() {
    let mut other = list(plain());
    other.authenticity.port = 0xC3;
    let mut bench = Bench::factory(plain());
    bench.configure(&other);
    bench.start();
    bench.answer(d(7).sd_set().port(!0xC3));
    assert_eq!(bench.image.unwrap().as_slice()[3], 0xC3);
    assert!(!bench.bit(Service::FaultsS));
}

#[rstest]
#[case::manual(1, true)]
#[case::autostart(2, false)]
fn autostart_takes_any_device(#[case] port_mode: u8, #[case] validated: bool) {
    let mut bench = Bench::factory(plain());
    bench.configure(&List { port_mode, vendor_id: 9, ..list(plain()) });
    bench.advance(10 * MS);
    assert_eq!(bench.events(), if validated { vec![0x1803] } else { vec![] });
}

/// Appearing Errors and Warnings are pending, until they disappear or the Device starts anew.
#[test]
fn events_of_the_device() {
    let mut bench = Bench::operate(plain());
    let raise = |bench: &mut Bench, code, qualifier| {
        bench.apply(&[Stimulus::Raise { port: PORT, code, qualifier }]);
        assert_eq!(bench.seen(), [Seen::Indication { port: PORT, source: Source::Device, qualifier, code }]);
    };
    raise(&mut bench, 0xB003, 0xF4);
    raise(&mut bench, 0xB003, 0xF4);
    raise(&mut bench, 0x8CA0, 0xE4);
    raise(&mut bench, 0x8CA1, 0xD4);
    raise(&mut bench, 0xB000, 0x54);
    assert_eq!(bench.diags(), [(0xF4, 0xB003), (0xE4, 0x8CA0)]);
    raise(&mut bench, 0x8CA0, 0xA4);
    assert_eq!(bench.diags(), [(0xF4, 0xB003)]);
    bench.plug(None);
    bench.apply(&[Stimulus::Raise { port: PORT, code: 1, qualifier: 0xF4 }]);
    assert_eq!(bench.seen(), []);
    bench.advance(2 * S);
    bench.plug(Some(list(plain()).identity()));
    bench.start();
    assert_eq!(bench.diags(), []);
}
