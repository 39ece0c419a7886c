//! The start of a port step by step (7.2, clause 8, 10.4.3.1), and what its SCL verifies.

use crate::bench::*;
use fsct_adapters::{Line, Mode, Octets, Response, Seen, Service, SmiService, Source, Stimulus};
use fsct_protocol::Edition;
use fsct_reference::{MasterMutant, MasterOptions};
use rstest::rstest;

fn wake_ups(bench: &Bench) -> usize {
    bench.seen.iter().filter(|o| matches!(o.seen, Seen::Line { port: 1, line: Line::WakeUp, .. })).count()
}

#[rstest]
fn a_port_starts_step_by_step(#[values(Edition::V1_1, Edition::Iec2022)] edition: Edition) {
    let mut bench = Bench::idle(edition, MasterOptions::default());
    bench.forget();
    bench.configure(bench.list());
    assert!(bench.saw(&Seen::Line { port: 1, line: Line::Power, level: true }));
    bench.plug();
    bench.pass(100 * MS);
    assert_eq!((wake_ups(&bench), bench.modes()), (0, vec![]), "no wake-up without a Ready pulse");
    bench.pulse(750_000);
    assert_eq!((wake_ups(&bench), bench.modes()), (1, vec![Mode::Startup, Mode::Preoperate]));
    let record = Seen::Request { port: 1, index: 0x4202, subindex: 0, data: Some(bench.record()) };
    assert!(bench.saw(&record));
    assert_eq!(bench.exchange(None), None, "no process data before OPERATE");
    bench.apply(&[Stimulus::Respond { port: 1, response: Response::Written }]);
    assert_eq!(bench.modes().last(), Some(&Mode::Operate));
    assert_eq!(bench.exchange(None), Some(shown(0, 1, 0)));
    assert_eq!(bench.apply(&[Stimulus::Respond { port: 1, response: Response::Written }]), [Seen::Unsupported]);
}

#[rstest]
#[case(499_999, 0)]
#[case(500_000, 1)]
#[case(1_000_000, 1)]
#[case(1_000_001, 0)]
fn a_ready_pulse_has_a_width(#[case] width_ns: u64, #[case] served: usize) {
    let mut bench = Bench::idle(Edition::V1_1, MasterOptions::default());
    bench.configure(bench.list());
    bench.plug();
    bench.pulse(width_ns);
    assert_eq!(wake_ups(&bench), served);
}

#[test]
fn without_a_ready_pulse_the_supply_goes_through_another_cycle() {
    let mut bench = Bench::idle(Edition::V1_1, MasterOptions::default());
    bench.configure(bench.list());
    bench.pass(5_000 * MS - 1);
    let off = Seen::Line { port: 1, line: Line::Power, level: false };
    assert!(!bench.saw(&off));
    bench.pass(1);
    assert!(bench.saw(&off));
    bench.forget();
    bench.pass(1_000 * MS);
    assert!(bench.saw(&Seen::Line { port: 1, line: Line::Power, level: true }));
    bench.connect();
    assert_eq!(bench.exchange(None), Some(shown(0, 1, 0)));
}

/// Offsets from FSP_Authenticity1 on, and the EventCode as v1.1 numbers it.
#[rstest]
#[case::authent_crc(&[10], 0x05)]
#[case::prot_par_crc(&[22], 0x06)]
fn a_deviating_signature_never_starts_the_scl(
    #[case] wrong: &[usize],
    #[case] code: u16,
    #[values(Edition::V1_1, Edition::Iec2022)] edition: Edition,
) {
    let mut bench = Bench::idle(edition, MasterOptions::default());
    let mut list = bench.list();
    let from = if edition == Edition::V1_1 { 14 } else { 16 };
    wrong.iter().for_each(|offset| list[from + offset] ^= 1);
    bench.configure(list);
    bench.connect();
    assert_eq!(bench.exchange(None), None);
    let code = if edition == Edition::V1_1 { 0xB000 + code } else { 0x2000 + code };
    assert!(bench.saw(&Seen::Indication { port: 1, source: Source::Port, qualifier: 0xFC, code }));
    assert_eq!(bench.modes().last(), Some(&Mode::Operate), "the black channel runs all the same");
}

#[test]
fn the_authenticity_has_to_be_that_of_the_upper_level_system() {
    let mut bench = Bench::idle(Edition::Iec2022, MasterOptions::default());
    bench.set(Service::FscpAuthenticity, Octets::new(&[0x11, 0x22, 0x33, 0x45, 0, 0, 0, 0]).expect("it fits"));
    bench.configure(bench.list());
    bench.connect();
    assert_eq!(bench.exchange(None), None);
    assert!(bench.saw(&Seen::Indication { port: 1, source: Source::Port, qualifier: 0xFC, code: 0x2003 }));
}

#[test]
fn a_lost_device_leaves_the_scl_in_fault_until_the_acknowledgment() {
    let mut bench = Bench::operate(Edition::Iec2022, MasterOptions::default());
    bench.apply(&[Stimulus::Plug { port: 1, device: None }]);
    assert_eq!(bench.exchange(None), None);
    bench.pass(30 * MS);
    assert!(!bench.good && bench.sd_set_s, "MTimer has expired");
    bench.pass(2_000 * MS);
    bench.connect();
    assert_eq!(bench.exchange(None), Some(shown(0, 1, 0)), "the SCL goes on where it was");
    assert_eq!(bench.answer(mirror(0)), shown(1, 1, 1));
}

#[test]
fn a_new_configuration_is_a_new_start() {
    let mut bench = Bench::operate(Edition::Iec2022, MasterOptions::default());
    bench.configure(bench.list());
    bench.pass(2_000 * MS);
    bench.connect();
    assert_eq!(bench.exchange(None), Some(shown(0, 1, 0)));
    assert_eq!(bench.answer(mirror(0)), shown(1, 0, 0), "T4: no acknowledgment at a start");
}

#[test]
fn configurations_survive_a_power_cycle_but_for_commissioning_in_iec2022() {
    for (edition, tech_par_crc, survives) in [
        (Edition::V1_1, 0u32, true),
        (Edition::V1_1, 1, true),
        (Edition::Iec2022, 1, true),
        (Edition::Iec2022, 0, false),
    ] {
        let mut bench = Bench::idle(edition, MasterOptions::default());
        let mut list = bench.list();
        let at = if edition == Edition::V1_1 { 31 } else { 33 };
        list[at..at + 4].copy_from_slice(&tech_par_crc.to_be_bytes());
        bench.configure(list);
        bench.apply(&[Stimulus::Power(false)]);
        bench.forget();
        bench.apply(&[Stimulus::Power(true)]);
        assert_eq!(
            bench.saw(&Seen::Line { port: 1, line: Line::Power, level: true }),
            survives,
            "{edition} {tech_par_crc}"
        );
    }
}

#[test]
fn another_device_than_configured_is_a_fault_of_the_port() {
    let mut bench = Bench::idle(Edition::Iec2022, MasterOptions::default());
    let mut list = bench.list();
    list[7] ^= 1;
    bench.configure(list);
    bench.connect();
    assert_eq!(bench.modes(), [Mode::Startup, Mode::Preoperate]);
    let status = bench.smi(SmiService::PortStatus, 1, 0x9100, &[0xFF, 0xF0]);
    assert_eq!(status.octets.get(2), Some(&2));
}

#[test]
fn mutants_of_the_record() {
    let options = |mutant| MasterOptions { mutant: Some(mutant), ..MasterOptions::default() };
    let mut bench = Bench::idle(Edition::Iec2022, options(MasterMutant::WrongArgBlockOffset));
    bench.configure(bench.list());
    bench.plug();
    bench.pulse(750_000);
    let wrong = bench.list()[14..37].to_vec();
    assert!(bench.saw(&Seen::Request { port: 1, index: 0x4202, subindex: 0, data: Some(wrong) }));
    let mut bench = Bench::idle(Edition::Iec2022, options(MasterMutant::RecordAfterOperate));
    bench.configure(bench.list());
    bench.plug();
    bench.pulse(750_000);
    assert_eq!(bench.modes(), [Mode::Startup, Mode::Preoperate, Mode::Operate]);
}
