//! The start of a port step by step (7.2, clause 8), what is verified before its SCL starts (10.4.3.1), and what ends it.

use crate::bench::*;
use fsct_adapters::{Identity, Line, Mode, Octets, Response, Seen, Service, Source, Stimulus};
use fsct_protocol::Edition;
use fsct_reference::MasterOptions;
use rstest::rstest;

fn plain() -> MasterOptions {
    MasterOptions::default()
}

fn power(level: bool) -> Seen {
    Seen::Line { port: PORT, line: Line::Power, level }
}

fn mode(mode: Mode) -> Seen {
    Seen::Mode { port: PORT, mode }
}

fn wake_up() -> Seen {
    Seen::Line { port: PORT, line: Line::WakeUp, level: true }
}

// --- start ---

#[test]
fn power_on_reports_every_output_service_of_every_port() {
    let mut bench = Bench::idle(Iec2022, MasterOptions { ports: 3, ..plain() });
    bench.apply(Stimulus::Power(false));
    let seen = bench.apply(Stimulus::Power(true));
    let expected = (1..=3).flat_map(|port| {
        let bit = |service, value| Seen::Service { port, service, value: Octets::bit(value) };
        [
            Seen::Service { port, service: Service::PdinM, value: Octets::zero(1) },
            bit(Service::SdsetS, true),
            bit(Service::ChfackreqS, false),
            bit(Service::FaultsS, false),
            bit(Service::Qualifier, false),
        ]
    });
    assert_eq!(seen, expected.collect::<Vec<_>>());
}

#[rstest]
fn a_port_starts_step_by_step(#[values(V1_1, Iec2022)] edition: Edition, #[values(49, 50)] port_mode: u8) {
    let mut bench = Bench::idle(edition, plain());
    bench.list.port_mode = port_mode;
    bench.configure();
    assert_eq!(bench.last[0].seen, power(true), "it was off, so it goes on at once");
    bench.plug(Some(identity()));
    bench.drive(Line::Cq, true);
    bench.advance(600_000);
    bench.drive(Line::Cq, false);
    bench.advance(99_999);
    assert_eq!(bench.last, []);
    let list = bench.list.octets();
    let offset = if edition == V1_1 { 14 } else { 16 };
    let record = Some(list[offset..offset + 23].to_vec());
    let request = Seen::Request { port: PORT, index: 0x4202, subindex: 0, data: record };
    assert_eq!(bench.advance(1), [wake_up(), mode(Mode::Startup), mode(Mode::Preoperate), request]);
    bench.exchange(None);
    assert_eq!(bench.image(), None);
    bench.advance(1_000 * MS);
    assert_eq!(bench.respond(Response::Written), [mode(Mode::Operate)]);
    assert_eq!(bench.port_status_info(), 8);
    bench.expect_out(None, m(0).sd());
}

#[rstest]
#[case::written(Response::Written)]
#[case::refused(Response::Refused(0x8022))]
fn any_answer_to_the_record_leads_to_operate(#[case] answer: Response) {
    let mut bench = Bench::configured(List::new(Iec2022), plain());
    bench.plug(Some(identity()));
    bench.pulse(750_000);
    bench.respond(answer);
    assert_eq!(bench.modes(), [Mode::Startup, Mode::Preoperate, Mode::Operate]);
}

#[test]
fn no_answer_to_the_record_is_a_fault_of_the_port() {
    let mut bench = Bench::configured(List::new(Iec2022), plain());
    bench.plug(Some(identity()));
    bench.pulse(750_000);
    bench.advance(5_000 * MS);
    assert_eq!(bench.port_status_info(), 2);
    bench.respond(Response::Written);
    assert_eq!(bench.modes(), [Mode::Startup, Mode::Preoperate], "too late");
}

#[rstest]
#[case(499_999, false)]
#[case(500_000, true)]
#[case(1_000_000, true)]
#[case(1_000_001, false)]
fn a_ready_pulse_has_its_width(#[case] width_ns: u64, #[case] taken: bool) {
    let mut bench = Bench::configured(List::new(Iec2022), plain());
    bench.plug(Some(identity()));
    bench.pulse(width_ns);
    assert_eq!(bench.line(Line::WakeUp).len(), usize::from(taken));
    bench.pulse(700_000);
    assert_eq!(bench.line(Line::WakeUp).len(), 1, "another width does no harm to the next pulse");
}

#[test]
fn a_pulse_on_i_q_is_no_ready_pulse() {
    let mut bench = Bench::configured(List::new(Iec2022), plain());
    bench.plug(Some(identity()));
    bench.drive(Line::Iq, true);
    bench.advance(700_000);
    bench.drive(Line::Iq, false);
    bench.advance(MS);
    assert_eq!(bench.line(Line::WakeUp), []);
}

/// L+ and the wake-up are the FS-Master's own: nobody else drives them.
#[rstest]
fn lines_of_the_fs_master_cannot_be_driven(#[values(Line::Power, Line::WakeUp)] line: Line) {
    let mut bench = Bench::configured(List::new(Iec2022), plain());
    bench.plug(Some(identity()));
    assert_eq!(bench.drive(line, true), [Seen::Unsupported]);
    bench.advance(700_000);
    assert_eq!(bench.drive(line, false), [Seen::Unsupported]);
    bench.advance(MS);
    assert_eq!(bench.line(Line::WakeUp), []);
}

/// Waiting time, off time, and all over again (T22).
#[rstest]
fn without_a_ready_pulse_the_supply_is_cycled(#[values(V1_1, Iec2022)] edition: Edition) {
    let mut bench = Bench::configured(List::new(edition), plain());
    let (wait, off) = bench.list.times();
    bench.advance(2 * (wait + off));
    let expected = [(0, true), (wait, false), (wait + off, true), (2 * wait + off, false), (2 * (wait + off), true)];
    assert_eq!(bench.line(Line::Power), expected);
    bench.connect();
    bench.expect_out(None, Out { data: 0, ..m(0).sd() });
}

#[rstest]
fn a_new_configuration_cycles_a_supply_that_is_on(#[values(V1_1, Iec2022)] edition: Edition) {
    let mut bench = Bench::configured(List::new(edition), plain());
    bench.connect();
    let now = bench.last.last().unwrap().at;
    bench.configure();
    let off = bench.list.times().1;
    bench.advance(off);
    assert_eq!(bench.line(Line::Power), [(0, true), (now, false), (now + off, true)]);
    assert_eq!(bench.modes().last(), Some(&Mode::Inactive));
}

#[test]
fn three_wake_ups_without_an_answer_end_in_a_new_cycle() {
    let mut bench = Bench::configured(List::new(Iec2022), plain());
    bench.drive(Line::Cq, true);
    bench.advance(700_000);
    bench.drive(Line::Cq, false);
    bench.advance(200 * MS);
    let first = 800_000;
    let wake_ups = [first, first + 50 * MS, first + 100 * MS].map(|at| (at, true));
    assert_eq!(bench.line(Line::WakeUp), wake_ups);
    assert_eq!(bench.line(Line::Power).last(), Some(&(first + 100 * MS, false)));
    assert_eq!(bench.modes(), []);
}

// --- identification ---

#[rstest]
#[case::vendor(|list: &mut List| list.vendor_id ^= 1)]
#[case::device(|list: &mut List| list.device_id ^= 1)]
#[case::cycle_time(|list: &mut List| list.cycle_time = 9)]
fn another_device_than_configured_stays_in_preoperate(
    #[case] change: fn(&mut List),
    #[values(V1_1, Iec2022)] edition: Edition,
    #[values(1, 2, 3, 4)] validation: u8,
) {
    let mut list = List { validation, ..List::new(edition) };
    change(&mut list);
    let mut bench = Bench::configured(list, plain());
    bench.connect();
    assert_eq!(bench.modes(), [Mode::Startup, Mode::Preoperate]);
    assert_eq!((bench.requests(), bench.port_events()), (vec![], vec![0x1803]));
    let status = bench.status();
    assert_eq!(status[2], 2);
    assert_eq!(status[status.len() - 2..], [0x18, 0x03], "a DiagEntry");
}

#[test]
fn without_validation_any_device_will_do() {
    let mut bench = Bench::configured(List { validation: 0, vendor_id: 1, ..List::new(Iec2022) }, plain());
    bench.connect();
    assert_eq!(bench.port_status_info(), 8);
}

// --- verification ---

/// The EventCode of v1.1; iec2022 has 0x2000 in place of 0xB000.
#[rstest]
#[case::watchdog(|list: &mut List| list.protocol.watchdog_ms = 0, 0xB009)]
#[case::version(|list: &mut List| list.protocol.version = 2, 0xB006)]
#[case::mode(|list: &mut List| list.protocol.mode = 3, 0xB006)]
#[case::length_of_the_mode(|list: &mut List| list.spdu = (5, 8), 0xB006)]
#[case::length_of_the_other_mode(|list: &mut List| { list.protocol.mode = 2; list.spdu = (5, 6) }, 0xB006)]
fn one_wrong_item_keeps_the_scl_from_starting(
    #[case] change: fn(&mut List),
    #[case] code: u16,
    #[values(V1_1, Iec2022)] edition: Edition,
) {
    let mut list = List::new(edition);
    change(&mut list);
    let mut bench = Bench::configured(list, plain());
    bench.connect();
    expect_not_started(&mut bench, code);
}

#[rstest]
#[case::authent_crc(10, 0xB005)]
#[case::prot_par_crc(22, 0xB006)]
fn a_wrong_signature_keeps_the_scl_from_starting(
    #[case] octet_of_record: usize,
    #[case] code: u16,
    #[values(V1_1, Iec2022)] edition: Edition,
) {
    let mut bench = Bench::idle(edition, plain());
    let mut list = bench.list.octets();
    list[if edition == V1_1 { 14 } else { 16 } + octet_of_record] ^= 0x01;
    let (service, expected) = (fsct_adapters::SmiService::PortConfiguration, if edition == V1_1 { 0 } else { 0xFFF0 });
    assert!(bench.smi(service, PORT, expected, &list).positive, "found at the start of the SCL only");
    bench.connect();
    expect_not_started(&mut bench, code);
}

fn expect_not_started(bench: &mut Bench, code: u16) {
    let code = if bench.list.edition == V1_1 { code } else { code - 0xB000 + 0x2000 };
    let indication = |seen: &&Seen| matches!(seen, Seen::Indication { .. });
    let events: Vec<Seen> = bench.seen.iter().map(|o| &o.seen).filter(indication).cloned().collect();
    // Appears, Error, source FS-Master.
    assert_eq!(events, [Seen::Indication { port: PORT, source: Source::Port, qualifier: 0xFC, code }]);
    assert_eq!(bench.modes().last(), Some(&Mode::Operate), "the black channel works");
    bench.exchange(Some(d(7).octets()));
    let image = bench.image().unwrap();
    assert!(image.as_slice().iter().all(|octet| *octet == 0) && !image.as_slice().is_empty());
    assert!(bench.services.sdset_s && !bench.services.qualifier);
    let status = bench.status();
    assert_eq!(status[2], 4);
    let [high, low] = code.to_be_bytes();
    assert_eq!(status[status.len() - 4..], [1, 0xFC, high, low]);
}

#[rstest]
#[case::armed_v1_1(V1_1, 1, Some(0xB003))]
#[case::armed(Iec2022, 1, Some(0x2003))]
#[case::commissioning_v1_1(V1_1, 0, Some(0xB003))]
#[case::commissioning(Iec2022, 0, None)]
fn the_authenticity_is_that_of_the_fscp(
    #[case] edition: Edition,
    #[case] tech_par_crc: u32,
    #[case] event: Option<u16>,
) {
    let mut list = List::new(edition);
    list.protocol.tech_par_crc = tech_par_crc;
    for (fscp, event) in [([0x11, 0x22, 0x33, 0x44, 0x55, 0x66, 0x77, 0x88], None), ([0x11; 8], event)] {
        let mut bench = Bench::idle(edition, plain());
        bench.set(Service::FscpAuthenticity, &fscp);
        bench.list = list;
        bench.configure();
        bench.connect();
        assert_eq!(bench.port_events(), Vec::from_iter(event));
        assert_eq!(bench.port_status_info(), if event.is_none() { 8 } else { 4 });
    }
}

#[rstest]
#[case::v1_1(V1_1, Some(0xB004))]
#[case::iec2022(Iec2022, None)]
fn fsp_port_is_the_port_number_in_v1_1(#[case] edition: Edition, #[case] event: Option<u16>) {
    let mut list = List::new(edition);
    list.authenticity.port = 7;
    let mut bench = Bench::configured(list, plain());
    bench.connect();
    assert_eq!(bench.port_events(), Vec::from_iter(event));
    bench.exchange(None);
    assert_eq!(bench.image().unwrap().as_slice()[1], if event.is_none() { 7 } else { 0 }, "PortNum is FSP_Port");
}

// --- communication lost ---

#[rstest]
#[case::operate(Mode::Operate)]
#[case::preoperate(Mode::Preoperate)]
fn com_lost_cycles_the_supply(#[case] from: Mode) {
    let mut bench = Bench::configured(List::new(Iec2022), plain());
    bench.plug(Some(identity()));
    bench.pulse(750_000);
    if from == Mode::Operate {
        bench.respond(Response::Written);
    }
    assert_eq!(bench.modes().last(), Some(&from));
    assert_eq!(bench.plug(None), [mode(Mode::Inactive), power(false)]);
    assert_eq!(bench.port_status_info(), 0);
    let off = bench.list.times().1;
    bench.advance(off - 1);
    assert_eq!(bench.last, []);
    assert_eq!(bench.advance(1), [power(true)]);
    bench.connect();
    assert_eq!(bench.port_status_info(), 8);
}

#[test]
fn com_lost_leaves_the_scl_in_fault_until_the_acknowledgment() {
    let mut bench = Bench::operate(4);
    bench.plug(None);
    bench.exchange(Some(d(3).octets()));
    assert_eq!(bench.image(), None);
    assert!(bench.services.qualifier, "MTimer still runs");
    bench.advance(WATCHDOG);
    assert!(bench.services.faults_s && !bench.services.qualifier, "T8");
    bench.advance(3_000 * MS);
    bench.connect();
    bench.expect_out(None, m(0).sd());
    bench.row(d(7).sd_set(), m(1).sd().ack_req(), SDin);
    bench.row(d(6).sd_set(), m(2).sd().ack_req(), SDin);
    bench.press();
    bench.row(d(5), m(3), PDin);
}

/// A Device that is only away while state 2 waits has missed nothing.
#[test]
fn com_lost_before_the_first_answer_is_no_fault() {
    let mut bench = Bench::waiting_first(Iec2022, None);
    bench.plug(None);
    bench.advance(3_000 * MS);
    bench.connect();
    bench.expect_out(None, m(0).sd());
    bench.row(d(7), m(1), PDin);
}

#[test]
fn a_new_configuration_makes_a_new_scl() {
    let mut bench = Bench::after_fault(None);
    bench.configure();
    let services = Services { pdin_m: vec![0], sdset_s: true, ..Services::default() };
    assert_eq!(bench.services, services);
    bench.advance(2_000 * MS);
    bench.connect();
    bench.expect_out(None, m(0).sd());
    bench.row(d(7).sd_set(), m(1), SDin);
    assert!(!bench.services.faults_s);
}

// --- supply by service ---

#[rstest]
fn port_power_off_on_once(#[values(V1_1, Iec2022)] edition: Edition) {
    let mut bench = Bench::waiting_first(edition, None);
    bench.row(d(7), m(1), PDin);
    assert!(bench.power_off_on(0, 1_500).positive);
    assert_eq!(bench.modes().last(), Some(&Mode::Inactive));
    bench.advance(1_500 * MS - 1);
    assert!(!bench.line(Line::Power).last().unwrap().1);
    bench.advance(1);
    assert!(bench.line(Line::Power).last().unwrap().1);
    bench.connect();
    bench.row(d(7).sd_set(), m(1).sd().ack_req(), SDin);
}

#[rstest]
#[case(V1_1, 0)]
#[case(Iec2022, 254)]
fn port_power_off_and_on(#[case] edition: Edition, #[case] status_off: u8) {
    let mut bench = Bench::waiting_first(edition, None);
    bench.power_off_on(1, 0);
    bench.advance(60_000 * MS);
    assert!(!bench.line(Line::Power).last().unwrap().1);
    assert_eq!(bench.port_status_info(), status_off);
    bench.power_off_on(2, 0);
    assert!(bench.line(Line::Power).last().unwrap().1);
    bench.connect();
    assert_eq!(bench.port_status_info(), 8);
}

/// Off for good, then off for a time: behind it the port is on, and says so.
#[test]
fn off_once_ends_off_for_good() {
    let mut bench = Bench::waiting_first(Iec2022, None);
    bench.power_off_on(1, 0);
    bench.power_off_on(0, 1_000);
    bench.advance(1_000 * MS);
    assert!(bench.line(Line::Power).last().unwrap().1);
    assert_eq!(bench.port_status_info(), 0, "no Device yet");
    bench.connect();
    assert_eq!(bench.port_status_info(), 8);
}

// --- power of the FS-Master ---

#[rstest]
#[case::v1_1_commissioning(V1_1, 0, true)]
#[case::v1_1_armed(V1_1, 1, true)]
#[case::armed(Iec2022, 1, true)]
#[case::commissioning_is_volatile(Iec2022, 0, false)]
fn a_configuration_survives_a_power_cycle(#[case] edition: Edition, #[case] tech_par_crc: u32, #[case] kept: bool) {
    let mut list = List::new(edition);
    list.protocol.tech_par_crc = tech_par_crc;
    let mut bench = Bench::configured(list, plain());
    bench.connect();
    assert_eq!(bench.port_status_info(), 8);
    bench.apply(Stimulus::Power(false));
    bench.exchange(None);
    assert_eq!(bench.image(), None);
    let seen = bench.apply(Stimulus::Power(true));
    assert_eq!(seen.contains(&power(true)), kept);
    assert_eq!(bench.port_status_info(), if kept { 0 } else { 1 });
}

#[test]
fn configure_makes_it_fresh_from_the_factory() {
    let mut bench = Bench::configured(List::new(V1_1), plain());
    let variant = fsct_adapters::Variant { edition: V1_1, mode: fsct_protocol::ProtMode::Crc16, pd_out: 1, pd_in: 1 };
    assert_eq!(bench.apply(Stimulus::Configure(variant)), [Seen::Unsupported], "the power is on");
    bench.apply(Stimulus::Power(false));
    assert_eq!(bench.apply(Stimulus::Configure(variant)), []);
    assert!(!bench.apply(Stimulus::Power(true)).contains(&power(true)));
}

// --- the other PortModes ---

#[rstest]
#[case::manual(1)]
#[case::autostart(2)]
fn non_safety_modes_need_neither_ready_pulse_nor_record(#[case] port_mode: u8) {
    let mut bench = Bench::configured(List { port_mode, ..List::new(Iec2022) }, plain());
    bench.plug(Some(Identity { pd_in: 2, pd_out: 1, ..identity() }));
    bench.advance(100 * MS);
    assert_eq!(bench.modes(), [Mode::Startup, Mode::Preoperate, Mode::Operate]);
    assert_eq!((bench.requests(), bench.port_status_info()), (vec![], 4));
    bench.exchange(Octets::new(&[7, 8]));
    assert_eq!(bench.image(), Some(Octets::zero(1)), "non-safety data only");
}

#[test]
fn autostart_cares_for_no_identity() {
    let list = List { port_mode: 2, vendor_id: 0, device_id: 0, validation: 99, ..List::new(Iec2022) };
    let mut bench = Bench::configured(list, plain());
    bench.plug(Some(identity()));
    bench.advance(100 * MS);
    assert_eq!(bench.port_status_info(), 4);
}

#[rstest]
#[case::deactivated(0, 1, false)]
#[case::di(3, 5, true)]
#[case::do_(4, 6, true)]
fn modes_without_communication(#[case] port_mode: u8, #[case] status: u8, #[case] supplied: bool) {
    let mut bench = Bench::configured(List { port_mode, ..List::new(Iec2022) }, plain());
    bench.plug(Some(identity()));
    bench.pulse(750_000);
    assert_eq!((bench.modes(), bench.port_status_info()), (vec![], status));
    assert_eq!(bench.line(Line::Power).last().is_some_and(|(_, level)| *level), supplied);
}

#[test]
fn a_port_that_is_not_there_has_no_image() {
    let mut bench = Bench::operate(4);
    for port in [0, 3] {
        let seen = bench.apply(Stimulus::Exchange { port, octets: None });
        assert_eq!(seen, [Seen::Unsupported, Seen::Image { port, octets: None }]);
    }
}

#[test]
fn an_event_of_the_device_is_indicated() {
    let mut bench = Bench::operate(4);
    // Appears, Error, source Device.
    let seen = bench.apply(Stimulus::Raise { port: PORT, code: 0xB003, qualifier: 0xF4 });
    assert_eq!(seen, [Seen::Indication { port: PORT, source: Source::Device, qualifier: 0xF4, code: 0xB003 }]);
    assert_eq!(bench.status()[15..], [1, 0xF4, 0xB0, 0x03]);
    bench.apply(Stimulus::Raise { port: PORT, code: 0xB003, qualifier: 0xB4 });
    assert_eq!(bench.status()[15..], [0], "disappeared");
    bench.apply(Stimulus::Raise { port: PORT, code: 0xB000, qualifier: 0x54 });
    assert_eq!(bench.status()[15..], [0], "a Notification is over at once");
}
