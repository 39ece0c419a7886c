//! The reference FS-Device and the dead devices against the rules of the DUT contract.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod common;

use common::*;
use fsct_adapters::{ClockKind, Dut, Line, Octets, Pco, Role, Seen, Service, Stimulus};
use fsct_protocol::{Edition, ProtMode};
use fsct_reference::{ConstantDevice, EchoDevice, FsDevice, Mutant, NullDevice, OptionError, Options};
use rstest::rstest;

fn devices() -> Vec<Box<dyn Dut>> {
    vec![
        Box::new(FsDevice::new(Options::default())),
        Box::<NullDevice>::default(),
        Box::<EchoDevice>::default(),
        Box::<ConstantDevice>::default(),
    ]
}

#[test]
fn they_all_describe_themselves_alike() {
    for mut device in devices() {
        let description = device.hello().unwrap();
        assert_eq!((description.role, description.ports), (Role::Device, 1));
        assert_eq!(description.pcos, [Pco::Power, Pco::Link, Pco::Acyclic, Pco::App, Pco::Line, Pco::Clock]);
        assert_eq!(description.clock.kind, ClockKind::Virtual);
        for edition in Edition::ALL {
            for mode in ProtMode::ALL {
                let covered = |pd| description.offers.iter().any(|offer| offer.covers(variant(edition, mode, pd)));
                assert!(covered(0) && covered(mode.max_pd() as u8));
                assert!(!covered(mode.max_pd() as u8 + 1));
            }
        }
    }
}

#[test]
fn they_all_answer_made_up_stimuli_unsupported() {
    let too_big = variant(Edition::V1_1, ProtMode::Crc16, 4);
    for device in devices() {
        let mut bench = Bench::around(device, plain());
        bench.apply(&[Stimulus::Configure(too_big)]);
        assert_eq!(bench.seen(), [Seen::Unsupported]);
        bench.power(true);
        bench.apply(&[Stimulus::Configure(plain())]);
        assert_eq!(bench.seen(), [Seen::Unsupported]);
        bench.apply(&[Stimulus::Other { kind: 200, octets: vec![1] }]);
        assert_eq!(bench.seen(), [Seen::Unsupported]);
        bench.set(Service::PdoutM, &[1]);
        assert_eq!(bench.seen(), [Seen::Unsupported]);
        bench.apply(&[Stimulus::Exchange { port: 2, octets: None }]);
        assert_eq!(bench.seen(), [Seen::Unsupported, Seen::Image { port: 2, octets: None }]);
    }
}

#[rstest]
#[case(Service::PdinD, &[1, 2])]
#[case(Service::PdinD, &[1, 2, 3, 4])]
#[case(Service::SdsetDs, &[])]
#[case(Service::SdsetDs, &[2])]
#[case(Service::SdsetDs, &[1, 0])]
#[case(Service::PdoutD, &[0, 0, 0])]
fn a_service_value_that_cannot_be_is_unsupported(#[case] service: Service, #[case] value: &[u8]) {
    let mut bench = Bench::factory(plain());
    bench.set(service, value);
    assert_eq!(bench.seen(), [Seen::Unsupported]);
}

#[test]
fn services_are_unsupported_without_power() {
    let mut bench = Bench::off(plain(), Options::default());
    bench.set(Service::PdinD, &[1, 2, 3]);
    assert_eq!(bench.seen(), [Seen::Unsupported]);
}

#[test]
fn power_on_reports_every_output_once() {
    let mut bench = Bench::off(plain(), Options::default());
    bench.power(true);
    let service = |service, value: &[u8]| Seen::Service { port: 1, service, value: Octets::new(value).unwrap() };
    let expected = [
        Seen::Line { port: 1, line: Line::Power, level: true },
        service(Service::PdoutD, &[0; 3]),
        service(Service::SetsdDc, &[0]),
        service(Service::ChfackreqDc, &[0]),
        service(Service::SclFault, &[0]),
    ];
    assert_eq!(bench.seen(), expected);
    bench.power(true);
    assert_eq!(bench.seen(), []);
}

#[test]
fn services_come_before_the_image_and_only_when_they_change() {
    let mut bench = Bench::operating(plain());
    let image = |bench: &Bench| Seen::Image { port: 1, octets: bench.image };
    bench.exchange(m(4).ack_req());
    let service = |service, value: &[u8]| Seen::Service { port: 1, service, value: Octets::new(value).unwrap() };
    let expected = [service(Service::PdoutD, &[0x54; 3]), service(Service::ChfackreqDc, &[1]), image(&bench)];
    assert_eq!(bench.seen(), expected);
    bench.exchange(m(5).data(0x54).ack_req());
    assert_eq!(bench.seen(), [image(&bench)]);
}

#[test]
fn observations_name_their_stimulus() {
    let mut bench = Bench::waiting_first(plain());
    let exchange = |out: Out| Stimulus::Exchange { port: 1, octets: Some(out.octets(plain())) };
    bench.apply(&[Stimulus::Advance { ns: 5 }, exchange(m(0).sd()), Stimulus::Advance { ns: 6 }, exchange(m(1))]);
    let places: Vec<_> = bench.last.iter().map(|observation| (observation.stimulus, observation.at)).collect();
    assert_eq!(places, [(1, 5), (1, 5), (3, 11)]);
}

#[test]
fn the_real_clock_runs_by_itself() {
    let mut bench = Bench::around(FsDevice::real_time(), plain());
    assert_eq!(bench.device.hello().unwrap().clock.kind, ClockKind::Real);
    bench.advance(1);
    assert_eq!(bench.seen(), [Seen::Unsupported]);
    bench.power(true);
    bench.commission(0);
    bench.verify();
    bench.set(Service::PdinD, &[0x1B; 3]);
    bench.exchange(m(0).sd());
    assert_eq!(bench.answer(), Some(d(7).sd_set()));
    let first = bench.last.last().map(|observation| observation.at);
    bench.receive(None);
    assert!(bench.last.last().map(|observation| observation.at) > first);
}

#[test]
fn the_dead_devices_present_nothing_an_echo_and_a_constant() {
    let long = variant(Edition::Iec2022, ProtMode::Crc32, 4);
    let spdu = m(1).octets(long);
    let image = |device: Box<dyn Dut>| {
        let mut bench = Bench::around(device, long);
        bench.receive(Some(spdu));
        assert_eq!(bench.image, None);
        bench.power(true);
        bench.commission_blindly();
        bench.receive(Some(spdu));
        let first = bench.image.unwrap();
        bench.receive(None);
        assert_eq!(bench.image, Some(first));
        first
    };
    assert_eq!(image(Box::<NullDevice>::default()), Octets::zero(10));
    assert_eq!(image(Box::<EchoDevice>::default()), spdu);
    let constant = image(Box::<ConstantDevice>::default());
    assert_eq!(constant.as_slice()[..6], [0, 0, 0, 0, 0xFE, 0xE4]);
}

fn query(pairs: &[(&str, &str)]) -> Result<Options, OptionError> {
    let pairs: Vec<_> = pairs.iter().map(|(name, value)| (name.to_string(), value.to_string())).collect();
    Options::from_query(&pairs)
}

#[test]
fn options_of_the_address() {
    assert_eq!(query(&[]), Ok(Options::default()));
    let all = Options { mutant: Some(Mutant::WrongSeed), latency: 8, clock: ClockKind::Real, pulse_us: 500 };
    let pairs = [("clock", "real"), ("mutant", "wrong-seed"), ("pulse_us", "500"), ("latency", "8")];
    assert_eq!(query(&pairs), Ok(all));
    for mutant in Mutant::ALL.iter().copied() {
        assert_eq!(query(&[("mutant", mutant.name())]), Ok(Bench::mutant(mutant)));
    }
}

#[rstest]
#[case(&[("mutants", "x")], r#"the reference DUT has no option "mutants", did you mean "mutant"?"#)]
#[case(&[("mutant", "wrongseed")], r#"the reference DUT has no mutant "wrongseed", did you mean "wrong-seed"?"#)]
#[case(&[("clock", "reel")], r#"the reference DUT has no clock "reel", did you mean "real"?"#)]
#[case(&[("latency", "9")], r#"the latency of the reference DUT is a number of exchanges from 0 to 8, not "9""#)]
#[case(&[("latency", "-1\n")], r#"the latency of the reference DUT is a number of exchanges from 0 to 8, not "-1\n""#)]
#[case(&[("pulse_us", "0")], r#"the Ready pulse of the reference device is 1 to 10000 microseconds wide, not "0""#)]
#[case(&[("latency", "1"), ("latency", "1")], r#"the option "latency" of the reference DUT is given twice"#)]
fn options_that_cannot_be_understood(#[case] pairs: &[(&str, &str)], #[case] text: &str) {
    assert_eq!(query(pairs).unwrap_err().to_string(), text);
}
