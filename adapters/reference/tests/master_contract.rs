//! The reference FS-Master and the dead masters against the rules of the DUT contract, and what can be asked of them.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod master_common;

use fsct_adapters::{ClockKind, Dut, Mode, Octets, Pco, Role, Seen, Service, SmiService, Stimulus};
use fsct_protocol::{Edition, ProtMode};
use fsct_reference::{ConstantMaster, EchoMaster, FsMaster, MasterMutant, MasterOptions, NullMaster, OptionError};
use master_common::*;
use rstest::rstest;

fn masters() -> Vec<Box<dyn Dut>> {
    vec![
        Box::new(FsMaster::new(MasterOptions::default())),
        Box::<NullMaster>::default(),
        Box::<EchoMaster>::default(),
        Box::<ConstantMaster>::default(),
    ]
}

#[test]
fn they_all_describe_themselves_alike() {
    for mut master in masters() {
        let description = master.hello().unwrap();
        assert_eq!((description.role, description.ports), (Role::Master, 2));
        assert_eq!(description.pcos, Pco::ALL);
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
    for master in masters() {
        let mut bench = Bench::around(master, plain());
        bench.apply(&[Stimulus::Configure(variant(Edition::V1_1, ProtMode::Crc16, 4))]);
        assert_eq!(bench.seen(), [Seen::Unsupported]);
        bench.power(true);
        for stimulus in [
            Stimulus::Configure(plain()),
            Stimulus::Other { kind: 200, octets: vec![1] },
            Stimulus::Read { index: 0x10, subindex: 0 },
            Stimulus::Write { index: 0x4202, subindex: 0, data: vec![0; 23] },
        ] {
            bench.apply(&[stimulus]);
            assert_eq!(bench.seen(), [Seen::Unsupported]);
        }
        bench.apply(&[Stimulus::Exchange { port: 3, octets: None }]);
        assert_eq!(bench.seen(), [Seen::Unsupported, Seen::Image { port: 3, octets: None }]);
    }
}

#[rstest]
#[case(PORT, Service::SetsdC, &[2])]
#[case(PORT, Service::ChfackC, &[])]
#[case(PORT, Service::ChfackC, &[0, 1])]
#[case(PORT, Service::PdinM, &[0, 0, 0])]
#[case(PORT, Service::PdinD, &[0, 0, 0])]
#[case(PORT, Service::FscpAuthenticity, &[0; 8])]
#[case(0, Service::FscpAuthenticity, &[0; 7])]
#[case(0, Service::SetsdC, &[1])]
fn a_service_value_that_cannot_be_is_unsupported(#[case] port: u8, #[case] service: Service, #[case] value: &[u8]) {
    let mut bench = Bench::operate(plain());
    bench.apply(&[Stimulus::Set { port, service, value: Octets::new(value).unwrap() }]);
    assert_eq!(bench.seen(), [Seen::Unsupported]);
}

/// What would be reported of a longer time has no end.
#[test]
fn time_has_an_end() {
    let mut bench = Bench::factory(plain());
    bench.configure(&list(plain()));
    for ns in [86_400 * S + 1, u64::MAX / 2, u64::MAX] {
        bench.advance(ns);
        assert_eq!(bench.seen(), [Seen::Unsupported]);
    }
    bench.advance(86_400 * S);
    assert!(!bench.seen().contains(&Seen::Unsupported));
}

#[test]
fn the_real_clock_runs_by_itself() {
    let options = MasterOptions { clock: ClockKind::Real, ..MasterOptions::default() };
    let mut bench = Bench::off(plain(), options);
    assert_eq!(bench.master.hello().unwrap().clock.kind, ClockKind::Real);
    bench.advance(1);
    assert_eq!(bench.seen(), [Seen::Unsupported]);
    bench.power(true);
    let first = bench.last.last().unwrap().at;
    bench.receive(None);
    assert!(bench.last.last().unwrap().at > first);
}

/// They get as far as a start needs, and differ in the image.
#[test]
fn the_dead_masters_present_nothing_an_echo_and_a_constant() {
    let spdu = d(7).octets(plain());
    let image = |master: Box<dyn Dut>| {
        let mut bench = Bench::around(master, plain());
        bench.receive(Some(spdu));
        assert_eq!(bench.image, None);
        bench.power(true);
        bench.plug(Some(list(plain()).identity()));
        let result = bench.smi(SmiService::PortConfiguration, PORT, &list(plain()).octets());
        assert!(result.positive && result.octets.is_empty());
        assert!(bench.seen().contains(&l_plus(true)));
        bench.pulse(700 * US);
        let modes = [Mode::Startup, Mode::Preoperate, Mode::Operate].map(mode);
        assert_eq!(bench.seen(), [&[wake_up()], &modes[..]].concat());
        bench.receive(Some(spdu));
        let first = bench.image.unwrap();
        bench.receive(None);
        assert_eq!(bench.image, Some(first));
        first
    };
    assert_eq!(image(Box::<NullMaster>::default()), Octets::zero(7));
    assert_eq!(image(Box::<EchoMaster>::default()), spdu);
    assert_eq!(image(Box::<ConstantMaster>::default()).as_slice()[..5], [0, 0, 0, PORT, 0x02]);
}

fn query(pairs: &[(&str, &str)]) -> Result<MasterOptions, OptionError> {
    let pairs: Vec<_> = pairs.iter().map(|(name, value)| (name.to_string(), value.to_string())).collect();
    MasterOptions::from_query(&pairs)
}

#[test]
fn options_of_the_address() {
    assert_eq!(query(&[]), Ok(MasterOptions::default()));
    let all = MasterOptions {
        mutant: Some(MasterMutant::Counter7To0),
        latency: 8,
        clock: ClockKind::Real,
        ports: 8,
        password: 0xCAFE,
        reset_password: u32::MAX,
    };
    let pairs = [
        ("clock", "real"),
        ("reset_password", "ffffffff"),
        ("ports", "8"),
        ("mutant", "counter-7-to-0"),
        ("password", "0000CAFE"),
        ("latency", "8"),
    ];
    assert_eq!(query(&pairs), Ok(all));
    for which in MasterMutant::ALL.iter().copied() {
        assert_eq!(query(&[("mutant", which.name())]), Ok(mutant(which)));
    }
}

#[rstest]
#[case(&[("port", "1")], r#"the reference DUT has no option "port", did you mean "ports"?"#)]
#[case(&[("mutant", "wrong-seed")], r#"the reference DUT has no mutant "wrong-seed", did you mean "A06-not-old"?"#)]
#[case(&[("ports", "0")], r#"the reference master has 1 to 8 ports, not "0""#)]
#[case(&[("ports", "9")], r#"the reference master has 1 to 8 ports, not "9""#)]
#[case(&[("password", "")], r#"a password of the reference master is up to 8 hexadecimal digits, not """#)]
#[case(&[("password", "+1")], r#"a password of the reference master is up to 8 hexadecimal digits, not "+1""#)]
#[case(&[("password", "000000001")], r#"a password of the reference master is up to 8 hexadecimal digits, not "000000001""#)]
#[case(&[("ports", "1"), ("ports", "1")], r#"the option "ports" of the reference DUT is given twice"#)]
fn options_that_cannot_be_understood(#[case] pairs: &[(&str, &str)], #[case] text: &str) {
    assert_eq!(query(pairs).unwrap_err().to_string(), text);
}
