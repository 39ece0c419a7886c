//! What the FS-Masters of this crate say of themselves, their options, and what they do not serve.

use crate::bench::*;
use fsct_adapters::{
    ClockKind, Dut, Identity, Line, Mode, Octets, Pco, Response, Role, Seen, SmiRequest, SmiService, Stimulus,
};
use fsct_protocol::ProtMode;
use fsct_protocol::fsp::Protocol;
use fsct_reference::{ConstantMaster, EchoMaster, FsMaster, MasterOptions, NullMaster};
use rstest::rstest;

fn query(pairs: &[(&str, &str)]) -> Result<MasterOptions, String> {
    let pairs: Vec<_> = pairs.iter().map(|(name, value)| ((*name).to_owned(), (*value).to_owned())).collect();
    MasterOptions::from_query(&pairs).map_err(|error| error.to_string())
}

#[test]
fn description() {
    let mut master = FsMaster::new(query(&[("ports", "8")]).unwrap());
    let description = master.hello().unwrap();
    assert_eq!((description.role, description.ports), (Role::Master, 8));
    assert_eq!(description.pcos, Pco::ALL);
    let offers: Vec<_> = description.offers.iter().map(|o| (o.edition, o.mode, o.pd_out, o.pd_in)).collect();
    for edition in [V1_1, Iec2022] {
        assert!(offers.contains(&(edition, ProtMode::Crc16, (0, 3), (0, 3))));
        assert!(offers.contains(&(edition, ProtMode::Crc32, (0, 25), (0, 25))));
    }
    assert_eq!(offers.len(), 4);
    assert_eq!((description.clock.kind, description.clock.uncertainty_ns), (ClockKind::Virtual, 0));
}

#[test]
fn options() {
    let defaults = query(&[]).unwrap();
    assert_eq!((defaults.ports, defaults.latency, defaults.password, defaults.reset_password), (2, 0, 0, 0));
    let given = query(&[
        ("password", "0a0B0c0D"),
        ("reset_password", "1"),
        ("ports", "1"),
        ("latency", "8"),
        ("clock", "real"),
        ("mutant", "counter-7-to-0"),
    ]);
    let given = given.unwrap();
    assert_eq!((given.password, given.reset_password), (0x0A0B_0C0D, 1));
    assert_eq!((given.ports, given.latency, given.clock), (1, 8, ClockKind::Real));
}

#[rstest]
#[case(&[("ports", "0")], "0")]
#[case(&[("ports", "9")], "9")]
#[case(&[("password", "123456789")], "123456789")]
#[case(&[("password", "+1")], "+1")]
#[case(&[("password", "")], "")]
#[case(&[("latency", "9")], "9")]
#[case(&[("mutant", "counter-7-to-1")], "counter-7-to-0")]
#[case(&[("port", "1")], "ports")]
#[case(&[("ports", "1"), ("ports", "1")], "twice")]
fn options_that_cannot_be_understood(#[case] pairs: &[(&str, &str)], #[case] quoted: &str) {
    let text = query(pairs).unwrap_err();
    assert!(text.contains(quoted), "{text}");
}

/// SPDUs of both modes, of every length.
#[rstest]
fn the_spdu_has_the_length_of_its_mode(#[values((1, 0), (1, 3), (2, 0), (2, 25))] mode_and_pd: (u8, u8)) {
    let (mode, pd) = mode_and_pd;
    let length = pd + if mode == 1 { 4 } else { 6 };
    let mut list = List { spdu: (length, length), ..List::new(Iec2022) };
    list.protocol = Protocol { mode, ..list.protocol };
    let mut bench = Bench::configured(list, MasterOptions::default());
    bench.plug(Some(Identity { pd_in: length, pd_out: length, ..identity() }));
    bench.pulse(750_000);
    bench.respond(Response::Written);
    bench.exchange(None);
    let image = bench.image().unwrap();
    assert_eq!(image.as_slice().len(), usize::from(length));
    assert_eq!((bench.port_status_info(), bench.services.pdin_m.len()), (8, usize::from(pd)));
}

#[test]
fn while_the_power_is_off_there_are_no_ports() {
    let mut bench = Bench::configured(List::new(Iec2022), MasterOptions::default());
    bench.apply(Stimulus::Power(false));
    assert_eq!(bench.plug(Some(identity())), [Seen::Unsupported]);
    assert_eq!(bench.drive(Line::Cq, true), [Seen::Unsupported]);
    assert_eq!(bench.respond(Response::Written), [Seen::Unsupported]);
    assert_eq!(bench.apply(Stimulus::Raise { port: PORT, code: 1, qualifier: 0xF4 }), [Seen::Unsupported]);
    let request = SmiRequest {
        service: SmiService::PortStatus,
        port: PORT,
        client_id: 1,
        expected: 0x9100,
        octets: VOID.to_vec(),
    };
    assert_eq!(bench.apply(Stimulus::Smi(Box::new(request))), [Seen::Unsupported]);
    assert_eq!(bench.advance(WATCHDOG), []);
}

/// As on the line: an answer that nobody waits for is lost.
#[test]
fn an_answer_that_nobody_waits_for_is_lost() {
    let mut bench = Bench::operate(4);
    assert_eq!(bench.respond(Response::Written), []);
    bench.row(d(3), m(5), PDin);
}

/// What was plugged stays plugged, what was driven is low again.
#[test]
fn a_power_cycle_keeps_what_is_plugged() {
    let mut bench = Bench::operate(4);
    bench.drive(Line::Cq, true);
    bench.apply(Stimulus::Power(false));
    bench.apply(Stimulus::Power(true));
    bench.advance(700_000);
    bench.drive(Line::Cq, false);
    bench.advance(MS);
    assert_eq!(bench.modes().last(), Some(&Mode::Operate), "no Ready pulse, and no start");
    bench.pulse(700_000);
    assert_eq!(bench.modes().last(), Some(&Mode::Preoperate));
}

#[test]
fn a_real_clock_is_not_advanced() {
    let mut bench = Bench::idle(Iec2022, MasterOptions { clock: ClockKind::Real, ..MasterOptions::default() });
    assert_eq!(bench.advance(1), [Seen::Unsupported]);
}

/// Null, Echo, Constant: the image behind what was received.
#[test]
fn those_that_only_look_like_one() {
    let first = |port: u8| {
        let control = fsct_protocol::spdu::Control { mcount: 0, set_sd: true, ch_f_ack_req: false };
        let octet = control.to_octet();
        let pd = fsct_protocol::spdu::Pd::safe(1);
        let wire = fsct_protocol::spdu::Wire { pd, port_num: port, octet, signature: None };
        Octets::new(wire.emit(ProtMode::Crc16, fsct_protocol::crc::Reading::Preset).octets()).unwrap()
    };
    let received = Octets::new(&[1, 2, 3, 4, 5, 6, 7]).unwrap();
    let echo = Octets::new(&[1, 2, 3, 4, 5]).unwrap();
    let dead: [(Box<dyn Dut>, Octets); 3] = [
        (Box::new(NullMaster::default()), Octets::zero(5)),
        (Box::new(EchoMaster::default()), echo),
        (Box::new(ConstantMaster::default()), first(2)),
    ];
    for (mut master, expected) in dead {
        let variant = fsct_adapters::Variant { edition: V1_1, mode: ProtMode::Crc16, pd_out: 1, pd_in: 1 };
        let (mut start, mut observed) = (Vec::new(), Vec::new());
        master.apply(&[Stimulus::Configure(variant), Stimulus::Power(true)], &mut start).unwrap();
        let exchange = Stimulus::Exchange { port: PORT, octets: Some(received) };
        master.apply(&[exchange], &mut observed).unwrap();
        assert_eq!(observed[0].seen, Seen::Image { port: PORT, octets: Some(expected) });
        assert_eq!(master.hello().unwrap().role, Role::Master);
    }
}
