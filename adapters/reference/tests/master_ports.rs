//! A port of the FS-Master: its start step by step in both editions, COMLOST, supply, and what survives a power cycle.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod master_common;

use fsct_adapters::{Dut, Line, Mode, Observation, Octets, Response, Seen, Service, SmiService, Stimulus};
use fsct_protocol::{Edition, ProtMode};
use fsct_reference::{FsMaster, MasterOptions};
use master_common::*;
use rstest::rstest;

fn is_result(seen: &Seen) -> bool {
    matches!(seen, Seen::Smi(_))
}

/// What was seen but for results of services.
fn happened(bench: &Bench) -> Vec<(u64, Seen)> {
    bench.timed().into_iter().filter(|(_, seen)| !is_result(seen)).collect()
}

fn power_mode(bench: &mut Bench, mode: u8, time: u16) -> bool {
    let id = if bench.variant.edition == Edition::V1_1 { 0x02 } else { 0x03 };
    let [high, low] = time.to_be_bytes();
    bench.smi(SmiService::PortPowerOffOn, PORT, &[0x70, id, mode, high, low]).positive
}

#[rstest]
fn a_port_starts_step_by_step(
    #[values(Edition::V1_1, Edition::Iec2022)] edition: Edition,
    #[values(49, 50)] port_mode: u8,
) {
    let list = List { port_mode, ..list(of(edition)) };
    let mut bench = Bench::factory(of(edition));
    bench.configure(&list);
    assert_eq!(happened(&bench), [(0, l_plus(true))]);
    assert_eq!(bench.info(), 0);
    bench.advance(S);
    bench.pulse(700 * US);
    assert_eq!(bench.last, []);
    bench.advance(100 * US - 1);
    assert_eq!(bench.last, []);
    bench.advance(1);
    let at = S + 800 * US;
    let startup = [wake_up(), mode(Mode::Startup), mode(Mode::Preoperate), record(&list)];
    assert_eq!(bench.timed(), startup.map(|seen| (at, seen)));
    bench.receive(None);
    assert_eq!(bench.image, None);
    bench.respond(Response::Written);
    assert_eq!(bench.seen(), [mode(Mode::Operate)]);
    assert_eq!((bench.info(), bench.diags()), (8, vec![]));
    bench.sends(m(0).sd(), SDin);
}

/// A Device that refuses the record is a matter of its own SCL.
#[rstest]
#[case(Response::Refused(0x8035))]
#[case(Response::Value(vec![1]))]
fn any_answer_to_the_record_leads_to_operate(#[case] response: Response) {
    let mut bench = Bench::factory(plain());
    bench.configure(&list(plain()));
    bench.start_up_to_record();
    bench.respond(response);
    assert_eq!(bench.seen(), [mode(Mode::Operate)]);
    assert_eq!(bench.info(), 8);
}

#[test]
fn no_answer_to_the_record_is_a_port_fault() {
    let mut bench = Bench::factory(plain());
    bench.configure(&list(plain()));
    bench.start_up_to_record();
    bench.advance(5 * S - 1);
    bench.advance(1);
    assert_eq!(bench.info(), 2);
    bench.respond(Response::Written);
    assert_eq!(bench.last, []);
    bench.receive(None);
    assert_eq!(bench.image, None);
}

#[rstest]
#[case::short(499_999, false)]
#[case::shortest(500_000, true)]
#[case::longest(1_000_000, true)]
#[case::long(1_000_001, false)]
fn the_width_of_the_ready_pulse(#[case] width: u64, #[case] good: bool) {
    let mut bench = Bench::factory(plain());
    bench.configure(&list(plain()));
    bench.pulse(width);
    bench.advance(100 * US);
    assert_eq!(bench.seen().contains(&wake_up()), good);
    if !good {
        bench.pulse(700 * US);
        bench.advance(100 * US);
        assert!(bench.seen().contains(&wake_up()), "the next one counts");
    }
}

#[test]
fn a_ready_pulse_on_iq_is_none() {
    let mut bench = Bench::factory(plain());
    bench.configure(&list(plain()));
    bench.drive(Line::Iq, true);
    bench.advance(700 * US);
    bench.drive(Line::Iq, false);
    bench.advance(MS);
    assert_eq!(bench.last, []);
}

/// v1.1: 5 s and 1 s; iec2022: FSP_TimeToReady and FSP_MinShutDownTime, here 3 s and 2 s.
#[rstest]
#[case(Edition::V1_1, 5 * S, S)]
#[case(Edition::Iec2022, 3 * S, 2 * S)]
fn without_ready_pulse_the_supply_is_cycled(#[case] edition: Edition, #[case] wait: u64, #[case] off: u64) {
    let mut bench = Bench::factory(of(edition));
    bench.configure(&list(of(edition)));
    bench.advance(wait - 1);
    assert_eq!(bench.last, []);
    bench.advance(wait + 2 * off + 1);
    let expected = [
        (wait, l_plus(false)),
        (wait + off, l_plus(true)),
        (2 * wait + off, l_plus(false)),
        (2 * (wait + off), l_plus(true)),
    ];
    assert_eq!(bench.timed(), expected);
    bench.pulse(700 * US);
    bench.advance(100 * US);
    assert!(bench.seen().contains(&wake_up()));
}

#[rstest]
#[case(Edition::V1_1, S)]
#[case(Edition::Iec2022, 2 * S)]
fn a_configuration_anew_cycles_the_supply_and_starts_another_scl(#[case] edition: Edition, #[case] off: u64) {
    let mut bench = Bench::after_fault(of(edition));
    let now = bench.last.last().unwrap().at;
    bench.configure(&list(of(edition)));
    let seen = happened(&bench);
    assert!(seen.contains(&(now, mode(Mode::Inactive))) && seen.contains(&(now, l_plus(false))));
    assert!(!bench.bit(Service::FaultsS) && bench.bit(Service::SdsetS));
    bench.advance(off - 1);
    assert_eq!(bench.last, []);
    bench.advance(1);
    assert_eq!(bench.timed(), [(now + off, l_plus(true))]);
    bench.start();
    bench.sends(m(0).sd(), SDin);
    bench.row(d(7).sd_set(), m(1), SDin);
}

#[test]
fn without_device_three_wake_ups_then_another_cycle() {
    let mut bench = Bench::factory(plain());
    bench.plug(None);
    bench.configure(&list(plain()));
    bench.start_up_to_record();
    let at = 800 * US;
    assert_eq!(bench.timed(), [(at, wake_up())]);
    bench.advance(3 * S);
    let expected = [
        (at + 50 * MS, wake_up()),
        (at + 100 * MS, wake_up()),
        (at + 100 * MS, l_plus(false)),
        (at + 100 * MS + 2 * S, l_plus(true)),
    ];
    assert_eq!(bench.timed(), expected);
    assert_eq!(bench.info(), 0);
}

#[test]
fn a_device_plugged_between_two_wake_ups_is_found() {
    let mut bench = Bench::factory(plain());
    bench.plug(None);
    bench.configure(&list(plain()));
    bench.start_up_to_record();
    bench.plug(Some(list(plain()).identity()));
    bench.advance(50 * MS);
    assert!(bench.seen().contains(&record(&list(plain()))));
}

/// The SCL is not started anew: it stays in its fault and asks for an acknowledgment.
#[rstest]
fn comlost_keeps_the_fault(#[values(Edition::V1_1, Edition::Iec2022)] edition: Edition) {
    let mut bench = Bench::operate(of(edition));
    let now = bench.last.last().unwrap().at;
    bench.plug(None);
    assert_eq!(bench.timed(), [(now, mode(Mode::Inactive)), (now, l_plus(false))]);
    bench.receive(None);
    assert_eq!(bench.image, None);
    bench.advance(WATCHDOG);
    assert!(bench.bit(Service::FaultsS) && !bench.bit(Service::Qualifier));
    bench.advance(2 * S);
    assert_eq!(bench.seen(), [l_plus(true)]);
    bench.plug(Some(list(of(edition)).identity()));
    bench.start_up_to_record();
    assert!(bench.seen().contains(&record(&list(of(edition)))));
    bench.respond(Response::Written);
    assert_eq!(bench.seen(), [mode(Mode::Operate)]);
    bench.sends(m(0).sd(), SDin);
    bench.row(d(7).sd_set(), m(1).sd().ack_req(), SDin);
    bench.ack(1);
    bench.row(d(6), m(2), PDin);
}

/// The SPDU of an SCL that goes on stands all the while, also behind a latency.
#[test]
fn comlost_with_latency_shows_no_zeros() {
    let mut bench = Bench::operate_with(plain(), MasterOptions { latency: 2, ..MasterOptions::default() });
    bench.plug(None);
    bench.advance(2 * S);
    bench.plug(Some(list(plain()).identity()));
    bench.start();
    for _ in 0..3 {
        bench.receive(None);
        assert!(bench.out().is_some());
    }
    assert_eq!(bench.out(), Some(m(0).sd()));
}

#[rstest]
fn supply_by_service(#[values(Edition::V1_1, Edition::Iec2022)] edition: Edition) {
    let mut bench = Bench::operate(of(edition));
    let now = bench.last.last().unwrap().at;
    // Once off for 1.5 s.
    assert!(power_mode(&mut bench, 0, 1500));
    assert_eq!(happened(&bench), [(now, mode(Mode::Inactive)), (now, l_plus(false))]);
    bench.advance(1500 * MS);
    assert_eq!(bench.timed().last(), Some(&(now + 1500 * MS, l_plus(true))));
    assert!(bench.bit(Service::FaultsS), "MTimer ran on");
    bench.start();
    bench.row(d(7).sd_set(), m(1).sd().ack_req(), SDin);
    // Off for good, on for good.
    assert!(power_mode(&mut bench, 1, 0));
    assert_eq!(bench.info(), if edition == Edition::V1_1 { 0 } else { 254 });
    bench.advance(60 * S);
    assert!(!bench.seen().contains(&l_plus(true)));
    assert!(power_mode(&mut bench, 2, 0));
    assert_eq!(bench.seen()[..1], [l_plus(true)]);
    assert!(power_mode(&mut bench, 2, 0));
    assert_eq!(happened(&bench), []);
    bench.start();
    assert_eq!(bench.info(), 8);
}

/// A supply that comes back starts a port as what it is configured.
#[rstest]
#[case::not_configured(None, 1)]
#[case::deactivated(Some(0), 1)]
#[case::digital_input(Some(3), 5)]
#[case::digital_output(Some(4), 6)]
#[case::ossde(Some(51), 7)]
fn supply_by_service_where_nobody_communicates(#[case] port_mode: Option<u8>, #[case] info: u8) {
    let mut bench = Bench::factory(plain());
    if let Some(port_mode) = port_mode {
        bench.configure(&List { port_mode, spdu_in: 1, ..list(plain()) });
    }
    assert!(power_mode(&mut bench, 0, 1000));
    bench.advance(60 * S);
    let seen = bench.seen();
    assert!(seen.contains(&l_plus(true)), "{seen:?}");
    assert!(!seen.iter().any(|seen| matches!(seen, Seen::Mode { .. }) || *seen == wake_up()), "{seen:?}");
    assert_eq!(bench.info(), info);
}

/// No Ready pulse, no record, no SPDU.
#[rstest]
fn other_port_modes_start_as_the_base_standard_says(
    #[values(Edition::V1_1, Edition::Iec2022)] edition: Edition,
    #[values(1, 2)] port_mode: u8,
) {
    let list = List { port_mode, nsr: (2, 1), ..list(of(edition)) };
    let mut bench = Bench::factory(of(edition));
    bench.plug(Some(fsct_adapters::Identity { pd_in: 2, pd_out: 1, ..list.identity() }));
    bench.configure(&list);
    assert!(bench.seen().contains(&l_plus(true)));
    bench.advance(10 * MS);
    assert_eq!(bench.seen(), [wake_up(), mode(Mode::Startup), mode(Mode::Preoperate), mode(Mode::Operate)]);
    assert_eq!(bench.info(), 4);
    bench.receive(Octets::new(&[7, 8]));
    assert_eq!(bench.image, Some(Octets::zero(1)));
}

#[rstest]
#[case(0, 1, false)]
#[case(3, 5, true)]
#[case(4, 6, true)]
fn ports_without_communication(#[case] port_mode: u8, #[case] info: u8, #[case] on: bool) {
    let mut bench = Bench::factory(plain());
    bench.configure(&List { port_mode, ..list(plain()) });
    assert_eq!(bench.seen().contains(&l_plus(true)), on);
    bench.start_up_to_record();
    assert_eq!(bench.last, []);
    bench.receive(None);
    assert_eq!(bench.image, None);
    assert_eq!(bench.info(), info);
}

#[test]
fn deactivating_a_port_switches_it_off() {
    let mut bench = Bench::operate(plain());
    bench.configure(&List { port_mode: 0, ..list(plain()) });
    let seen = bench.seen();
    assert!(seen.contains(&mode(Mode::Inactive)) && seen.contains(&l_plus(false)));
    bench.advance(60 * S);
    assert_eq!(bench.last, []);
    assert!(bench.bit(Service::SdsetS));
}

#[test]
fn power_on_reports_every_output_of_every_port_once() {
    let mut bench = Bench::off(plain(), MasterOptions::default());
    bench.power(true);
    let expected: Vec<Seen> = (1..=2)
        .flat_map(|port| {
            let service =
                move |service, value: &[u8]| Seen::Service { port, service, value: Octets::new(value).unwrap() };
            [
                service(Service::PdinM, &[0; 3]),
                service(Service::SdsetS, &[1]),
                service(Service::ChfackreqS, &[0]),
                service(Service::FaultsS, &[0]),
                service(Service::Qualifier, &[0]),
            ]
        })
        .collect();
    assert_eq!(bench.seen(), expected);
    bench.power(true);
    assert_eq!(bench.seen(), []);
    assert_eq!(bench.info(), 1);
}

/// In iec2022 a configuration with FSP_TechParCRC 0 is for commissioning and is gone.
#[rstest]
#[case(Edition::V1_1, 0, true)]
#[case(Edition::V1_1, 1, true)]
#[case(Edition::Iec2022, 0, false)]
#[case(Edition::Iec2022, 1, true)]
fn what_survives_a_power_cycle(#[case] edition: Edition, #[case] tech_par_crc: u32, #[case] kept: bool) {
    let mut stored = list(of(edition));
    stored.protocol.tech_par_crc = tech_par_crc;
    let mut bench = Bench::factory(of(edition));
    bench.configure(&stored);
    bench.start();
    bench.power(false);
    bench.power(true);
    assert_eq!(bench.seen().contains(&l_plus(true)), kept);
    assert_eq!(bench.info(), u8::from(!kept));
    if kept {
        bench.start();
        assert_eq!(bench.info(), 8, "the Device stays plugged");
    }
}

#[test]
fn configure_makes_it_fresh_and_needs_power_off() {
    let mut bench = Bench::operate(plain());
    bench.apply(&[Stimulus::Configure(plain())]);
    assert_eq!(bench.seen(), [Seen::Unsupported]);
    bench.power(false);
    bench.apply(&[Stimulus::Configure(variant(Edition::V1_1, ProtMode::Crc16, 4))]);
    assert_eq!(bench.seen(), [Seen::Unsupported]);
    bench.apply(&[Stimulus::Configure(variant(Edition::V1_1, ProtMode::Crc32, 6))]);
    assert_eq!(bench.seen(), []);
    bench.variant = of(Edition::V1_1);
    bench.power(true);
    bench.expect_service(Service::PdinM, &[0; 6]);
    assert_eq!(bench.info(), 1);
}

/// One port is none of the other's business.
#[test]
fn ports_are_independent() {
    let mut bench = Bench::operate(plain());
    for stimulus in [
        Stimulus::Plug { port: 1, device: None },
        Stimulus::Drive { port: 1, line: Line::Cq, level: true },
        Stimulus::Set { port: 1, service: Service::SetsdC, value: Octets::bit(true) },
    ] {
        bench.apply(&[stimulus]);
        assert_eq!(bench.seen(), []);
    }
    bench.apply(&[Stimulus::Exchange { port: 1, octets: None }]);
    assert_eq!(bench.seen(), [Seen::Image { port: 1, octets: None }]);
    bench.row(d(3), m(5), PDin);
}

#[rstest]
#[case(0)]
#[case(3)]
fn a_port_that_is_not_there(#[case] port: u8) {
    let mut bench = Bench::operate(plain());
    bench.apply(&[Stimulus::Exchange { port, octets: None }]);
    assert_eq!(bench.seen(), [Seen::Unsupported, Seen::Image { port, octets: None }]);
    bench.apply(&[Stimulus::Drive { port, line: Line::Cq, level: true }]);
    assert_eq!(bench.seen(), [Seen::Unsupported]);
}

#[test]
fn without_power_there_are_no_ports() {
    let mut bench = Bench::off(plain(), MasterOptions::default());
    bench.plug(None);
    assert_eq!(bench.seen(), [Seen::Unsupported]);
    bench.receive(None);
    assert_eq!(bench.seen(), [Seen::Unsupported, Seen::Image { port: PORT, octets: None }]);
    assert_eq!(bench.request(SmiService::PortStatus, PORT, 0x9100, &[0xFF, 0xF0]), None);
    assert_eq!(bench.seen(), [Seen::Unsupported]);
}

/// Off for good, then off for a time: behind it the port is on, and says so.
#[test]
fn off_once_ends_off_for_good() {
    let mut bench = Bench::waiting_first(of(Edition::Iec2022));
    assert!(power_mode(&mut bench, 1, 0));
    assert_eq!(bench.info(), 254);
    assert!(power_mode(&mut bench, 0, 1_000));
    bench.advance(1_000 * MS);
    assert!(bench.seen().contains(&l_plus(true)));
    assert_eq!(bench.info(), 0, "no Device yet");
}

/// L+ and the wake-up are the FS-Master's own: nothing drives them from outside.
#[rstest]
fn only_the_data_lines_can_be_driven(#[values(Line::Power, Line::WakeUp)] line: Line) {
    let mut bench = Bench::waiting_first(plain());
    bench.drive(line, true);
    assert_eq!(bench.seen(), [Seen::Unsupported]);
}

#[test]
fn what_is_driven_comes_back_with_its_time() {
    let mut master = FsMaster::new(MasterOptions::default());
    let mut seen = Vec::new();
    let drive = Stimulus::Drive { port: 1, line: Line::Cq, level: true };
    master.apply(&[Stimulus::Power(true), Stimulus::Advance { ns: 7 * US }, drive], &mut seen).unwrap();
    let back = Observation { stimulus: 2, at: 7 * US, seen: Seen::Line { port: 1, line: Line::Cq, level: true } };
    assert_eq!(seen.last(), Some(&back));
}
