//! The SMI of the FS-Master: ArgBlocks octet by octet in both editions, and what is refused, the first reason first.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod master_common;

use fsct_adapters::smi::{error_info, job_error};
use fsct_adapters::{Mode, Octets, Response, Seen, SmiResult, SmiService};
use fsct_protocol::Edition;
use fsct_reference::MasterOptions;
use master_common::*;
use rstest::rstest;

const VOID: [u8; 2] = [0xFF, 0xF0];
const EDITIONS: [Edition; 2] = [Edition::V1_1, Edition::Iec2022];

#[track_caller]
fn positive(result: &SmiResult, reference: u16, octets: &[u8]) {
    assert!(result.positive, "{result:02X?}");
    assert_eq!(result.octets, octets, "{:02X?}", result.octets);
    assert_eq!((result.reference, usize::from(result.length)), (reference, octets.len()));
}

#[track_caller]
fn refused(result: &SmiResult, edition: Edition, expected: u16, v1_1: u16, iec2022: u16) {
    assert!(!result.positive, "{result:02X?}");
    match edition {
        Edition::V1_1 => assert_eq!(result.octets, v1_1.to_be_bytes()),
        Edition::Iec2022 => {
            assert_eq!(result.octets, [0xFFFF, expected, iec2022].map(u16::to_be_bytes).concat());
            assert_eq!(result.length, 6);
        }
    }
}

/// A port that communicates and has two octets of other data in, one out.
fn mixed(edition: Edition) -> (Bench, List) {
    let list = List { port_mode: 50, nsr: (2, 1), ..list(of(edition)) };
    let mut bench = Bench::factory(of(edition));
    bench.plug(Some(list.identity()));
    bench.configure(&list);
    bench.start();
    (bench, list)
}

/// Type 3, as many ports as there are.
#[rstest]
#[case(Edition::V1_1, [0x00, 0x00], 0)]
#[case(Edition::Iec2022, [0x00, 0x01], 0xFFF0)]
fn master_ident(#[case] edition: Edition, #[case] id: [u8; 2], #[case] reference: u16) {
    let mut bench = Bench::off(of(edition), MasterOptions { ports: 3, ..MasterOptions::default() });
    bench.power(true);
    let void: &[u8] = if edition == Edition::V1_1 { &[] } else { &VOID };
    let result = bench.smi(SmiService::MasterIdentification, 0, void);
    assert!(result.positive);
    assert_eq!(result.reference, reference);
    assert_eq!(result.octets[..2], id);
    assert_eq!(result.octets[8], 3);
    assert_eq!(result.octets[11], 3);
    assert_eq!(result.octets.len(), 12 + 3);
}

#[rstest]
fn a_configuration_is_read_back_as_it_was(#[values(Edition::V1_1, Edition::Iec2022)] edition: Edition) {
    let mut bench = Bench::factory(of(edition));
    let list = list(of(edition)).octets();
    assert_eq!(list.len(), if edition == Edition::V1_1 { 48 } else { 50 });
    let result = bench.smi(SmiService::PortConfiguration, PORT, &list);
    match edition {
        Edition::V1_1 => positive(&result, 0, &[]),
        Edition::Iec2022 => positive(&result, 0x8100, &VOID),
    }
    let reference = if edition == Edition::V1_1 { 0 } else { 0xFFF0 };
    positive(&bench.read(SmiService::ReadbackPortConfiguration), reference, &list);
}

#[rstest]
fn a_port_without_configuration_reads_back_zeros(#[values(Edition::V1_1, Edition::Iec2022)] edition: Edition) {
    let (id, length) = if edition == Edition::V1_1 { ([0x80, 0x01], 48) } else { ([0x81, 0x00], 50) };
    let octets = Bench::factory(of(edition)).read(SmiService::ReadbackPortConfiguration).octets;
    assert_eq!((octets.len(), &octets[..2]), (length, &id[..]));
    assert!(octets[2..].iter().all(|octet| *octet == 0));
}

/// The slice of the verify record lies at 14 in v1.1, at 16 in iec2022.
#[rstest]
#[case(Edition::V1_1, 14)]
#[case(Edition::Iec2022, 16)]
fn the_record_is_a_slice_of_the_configuration(#[case] edition: Edition, #[case] offset: usize) {
    let mut bench = Bench::factory(of(edition));
    bench.configure(&list(of(edition)));
    bench.start_up_to_record();
    let slice = list(of(edition)).octets()[offset..offset + 23].to_vec();
    assert!(bench.seen().contains(&Seen::Request { port: PORT, index: 0x4202, subindex: 0, data: Some(slice) }));
}

#[test]
fn port_status_octet_by_octet() {
    // ID, info, quality, revision, rate, cycle time, reserved or lengths, VendorID, DeviceID, diags
    let (mut bench, _) = mixed(Edition::V1_1);
    let v1_1 = [0x90, 0x01, 8, 0, 0x11, 3, 20, 0, 0x01, 0x36, 0, 0x0A, 0xBC, 0xDE, 0];
    positive(&bench.read(SmiService::PortStatus), 0, &v1_1);
    let (mut bench, _) = mixed(Edition::Iec2022);
    let iec2022 = [0x91, 0x00, 8, 0, 0x11, 3, 20, 2, 1, 0x01, 0x36, 0, 0x0A, 0xBC, 0xDE, 0];
    positive(&bench.read(SmiService::PortStatus), 0xFFF0, &iec2022);
}

#[rstest]
#[case(Edition::V1_1, vec![0x90, 0x01, 1, 3, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0])]
#[case(Edition::Iec2022, vec![0x91, 0x00, 1, 3, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0])]
fn port_status_of_a_deactivated_port(#[case] edition: Edition, #[case] octets: Vec<u8>) {
    assert_eq!(Bench::factory(of(edition)).read(SmiService::PortStatus).octets, octets);
}

#[rstest]
fn port_status_with_two_diag_entries(#[values(Edition::V1_1, Edition::Iec2022)] edition: Edition) {
    let (mut bench, _) = mixed(edition);
    for (code, qualifier) in [(0xB002, 0xF4), (0x8CA0, 0xE4)] {
        bench.apply(&[fsct_adapters::Stimulus::Raise { port: PORT, code, qualifier }]);
    }
    let octets = bench.read(SmiService::PortStatus).octets;
    let from = if edition == Edition::V1_1 { 14 } else { 15 };
    assert_eq!(octets[from..], [2, 0xF4, 0xB0, 0x02, 0xE4, 0x8C, 0xA0]);
}

/// PQI, OE, then lengths and data: SPDU first, other data behind it.
#[test]
fn fs_pd_in_out_octet_by_octet() {
    let (mut bench, _) = mixed(Edition::Iec2022);
    let silent = [&[0x11, 0x03, 0, 1, 9][..], &[0; 9], &[8]].concat();
    bench.receive(None);
    let spdu = |bench: &Bench| bench.image.unwrap().as_slice()[..7].to_vec();
    let first = [silent, spdu(&bench), vec![0]].concat();
    positive(&bench.read(SmiService::FsPdInOut), 0xFFF0, &first);
    let answer = d(7).sd_set().octets(bench.variant);
    bench.receive(Octets::new(&[answer.as_slice(), &[0xA5, 0xC3]].concat()));
    assert!(bench.smi(SmiService::PdOut, PORT, &[0x10, 0x02, 0x77]).positive);
    let out = spdu(&bench);
    let head = [0x11, 0x03, 0, 1, 9];
    let next = [&head[..], answer.as_slice(), &[0xA5, 0xC3, 8], &out, &[0x77]].concat();
    positive(&bench.read(SmiService::FsPdInOut), 0xFFF0, &next);
    bench.receive(None);
    assert_eq!(bench.image.unwrap().as_slice(), [&out[..], &[0x77]].concat());
    positive(&bench.read(SmiService::PdIn), 0xFFF0, &[0x10, 0x01, 0xA5, 0xC3]);
    positive(&bench.read(SmiService::PdInOut), 0xFFF0, &[0x10, 0x03, 2, 0xA5, 0xC3, 1, 0x77]);
}

/// Zeros of the usual length where the SCL has not been started.
#[test]
fn fs_pd_in_out_without_scl() {
    let mut deviating = list(plain());
    deviating.protocol.watchdog_ms = 0;
    let mut bench = Bench::factory(plain());
    bench.configure(&deviating);
    bench.start();
    let expected = [&[0x11, 0x03, 0, 1, 7][..], &[0; 7], &[7], &[0; 7]].concat();
    assert_eq!(bench.read(SmiService::FsPdInOut).octets, expected);
}

/// What was received before belongs to another configuration.
#[test]
fn buffers_are_empty_after_a_configuration_anew() {
    let mut bench = Bench::operate(plain());
    bench.configure(&list(plain()));
    bench.advance(2 * S);
    bench.start();
    assert!(bench.read(SmiService::FsPdInOut).octets[5..12].iter().all(|octet| *octet == 0));
}

#[test]
fn spdu_in_and_out_of_v1_1() {
    let edition = Edition::V1_1;
    let mut bench = Bench::factory(of(edition));
    refused(&bench.read(SmiService::SpduIn), edition, 0, error_info::STATE_CONFLICT, 0);
    bench.configure(&list(of(edition)));
    refused(&bench.read(SmiService::SpduIn), edition, 0, error_info::NO_COM, 0);
    let spdu_out = [0x10, 0x05, 1, 2, 3, 4, 5, 6, 7];
    refused(&bench.smi(SmiService::SpduOut, PORT, &spdu_out), edition, 0, error_info::NO_COM, 0);
    bench.start();
    bench.answer(d(7).sd_set());
    let answer = d(7).sd_set().octets(bench.variant);
    positive(&bench.read(SmiService::SpduIn), 0, &[&[0x10, 0x04][..], answer.as_slice()].concat());
    refused(&bench.smi(SmiService::SpduOut, PORT, &spdu_out), edition, 0, error_info::STATE_CONFLICT, 0);
    refused(&bench.read(SmiService::FsPdInOut), edition, 0, error_info::STATE_CONFLICT, 0);
}

#[test]
fn spdu_in_and_out_are_internal_in_iec2022() {
    let mut bench = Bench::operate(plain());
    let code = job_error::SERVICE_NOT_SUPPORTED;
    refused(&bench.read(SmiService::SpduIn), plain().edition, 0x1101, 0, code);
    let spdu_out = [0x11, 0x02, 1, 2, 3, 4, 5, 6, 7];
    refused(&bench.smi(SmiService::SpduOut, PORT, &spdu_out), plain().edition, 0xFFF0, 0, code);
}

/// Port, ArgBlockID, length, content: of two errors the first counts.
#[rstest]
#[case::port_and_all(3, 0xFFF0, &[0x80, 0x01, 49], job_error::PORT_NUM_INVALID)]
#[case::port_0(0, 0xFFF0, &[0x80, 0x01, 49], job_error::PORT_NUM_INVALID)]
#[case::id_and_length(2, 0xFFF0, &[0x80, 0x01, 49], job_error::ARGBLOCK_NOT_SUPPORTED)]
#[case::no_id(2, 0xFFF0, &[0x81], job_error::ARGBLOCK_NOT_SUPPORTED)]
#[case::length_and_expected(2, 0x1234, &[0x81, 0x00, 48], job_error::ARGBLOCK_LENGTH_INVALID)]
fn port_configuration_is_refused(#[case] port: u8, #[case] expected: u16, #[case] octets: &[u8], #[case] error: u16) {
    let mut bench = Bench::factory(plain());
    let result = bench.request(SmiService::PortConfiguration, port, expected, octets).unwrap();
    refused(&result, plain().edition, expected, 0, error);
    let named = octets.first_chunk().map_or(0x8100, |id| u16::from_be_bytes(*id));
    assert_eq!(result.reference, named);
}

#[rstest]
#[case::port(1, 3, 0x8001, 48)]
#[case::id(1, 2, 0x8100, 48)]
#[case::length(1, 2, 0x8001, 47)]
#[case::content(1, 2, 0x8001, 48)]
fn v1_1_calls_them_out_of_range(#[case] error: u16, #[case] port: u8, #[case] id: u16, #[case] length: usize) {
    let mut bench = Bench::factory(of(Edition::V1_1));
    let mut octets = id.to_be_bytes().to_vec();
    octets.resize(length, 0xEE);
    let result = bench.smi(SmiService::PortConfiguration, port, &octets);
    refused(&result, Edition::V1_1, 0, error, 0);
    assert_eq!((result.reference, result.length), (0, 0));
}

#[test]
fn fs_pd_in_out_is_refused() {
    let mut bench = Bench::factory(plain());
    let mut ask = |port, expected, octets: &[u8]| {
        let octets = bench.request(SmiService::FsPdInOut, port, expected, octets).unwrap().octets;
        u16::from_be_bytes([octets[4], octets[5]])
    };
    assert_eq!(ask(9, 1, &[1]), job_error::PORT_NUM_INVALID);
    assert_eq!(ask(2, 1, &[0x11, 0x03]), job_error::ARGBLOCK_NOT_SUPPORTED);
    assert_eq!(ask(2, 1, &[0xFF, 0xF0, 0]), job_error::ARGBLOCK_LENGTH_INVALID);
    assert_eq!(ask(2, 1, &VOID), job_error::ARGBLOCK_INCONSISTENT);
    assert_eq!(ask(2, 0x1103, &VOID), job_error::DEVICE_NOT_IN_OPERATE);
}

type Change = fn(&mut List);

/// Values outside the tables change nothing. `true`: refused in v1.1, in iec2022.
#[rstest]
#[case::reserved_mode(|list: &mut List| list.port_mode = 5, true, true)]
#[case::manufacturer_mode(|list: &mut List| list.port_mode = 97, true, true)]
#[case::do_cq(|list: &mut List| list.port_mode = 4, true, false)]
#[case::validation(|list: &mut List| list.validation = 5, true, true)]
#[case::validation_of_autostart(|list: &mut List| (list.port_mode, list.validation) = (2, 9), false, false)]
#[case::iq_1(|list: &mut List| list.iq_behavior = 1, true, false)]
#[case::iq_2(|list: &mut List| list.iq_behavior = 2, true, true)]
#[case::iq_5(|list: &mut List| list.iq_behavior = 5, false, false)]
#[case::iq_of_di(|list: &mut List| (list.port_mode, list.iq_behavior) = (3, 7), false, false)]
#[case::iq_of_ossde(|list: &mut List| (list.port_mode, list.spdu_in, list.iq_behavior) = (51, 1, 7), true, false)]
#[case::vendor_id(|list: &mut List| list.vendor_id = 0, true, true)]
#[case::device_id(|list: &mut List| list.device_id = 0, true, true)]
#[case::device_id_of_four_octets(|list: &mut List| list.device_id = 0x0100_0000, true, true)]
#[case::ids_of_autostart(|list: &mut List| (list.port_mode, list.vendor_id, list.device_id) = (2, 0, 0), false, false)]
#[case::nsr_too_long(|list: &mut List| list.nsr = (26, 0), true, false)]
#[case::nsr_reserved_bits(|list: &mut List| list.nsr = (0, 0x81), true, false)]
#[case::nsr_of_a_digital_port(|list: &mut List| (list.port_mode, list.nsr) = (3, (33, 0)), true, false)]
#[case::no_time_to_ready(|list: &mut List| list.times.0 = 0, false, true)]
#[case::long_time_to_ready(|list: &mut List| list.times.0 = 0x8000, false, true)]
#[case::longest_time_to_ready(|list: &mut List| list.times.0 = 0x7FFF, false, false)]
#[case::short_shut_down(|list: &mut List| list.times.1 = 99, false, true)]
#[case::shortest_shut_down(|list: &mut List| list.times.1 = 100, false, false)]
#[case::longest_shut_down(|list: &mut List| list.times.1 = 1000, false, false)]
#[case::long_shut_down(|list: &mut List| list.times.1 = 1001, false, true)]
#[case::port_0(|list: &mut List| list.authenticity.port = 0, true, true)]
#[case::io_desc_version(|list: &mut List| list.io_desc_version = 2, true, true)]
#[case::spdu_in_3(|list: &mut List| list.spdu_in = 3, true, true)]
#[case::spdu_in_4(|list: &mut List| list.spdu_in = 4, false, false)]
#[case::spdu_out_32(|list: &mut List| list.spdu_out = 32, true, true)]
#[case::ossde_with_spdu(|list: &mut List| list.port_mode = 51, true, true)]
#[case::fsp_of_ossde(
    |list: &mut List| (list.port_mode, list.spdu_in, list.authenticity.port, list.io_desc_version) = (51, 1, 0, 9),
    false, false)]
fn ranges_of_a_configuration(
    #[values(Edition::V1_1, Edition::Iec2022)] edition: Edition,
    #[case] change: Change,
    #[case] v1_1: bool,
    #[case] iec2022: bool,
) {
    let mut other = list(of(edition));
    change(&mut other);
    let mut bench = Bench::operate(of(edition));
    let before = bench.read(SmiService::ReadbackPortConfiguration).octets;
    let result = bench.smi(SmiService::PortConfiguration, PORT, &other.octets());
    let is_refused = if edition == Edition::V1_1 { v1_1 } else { iec2022 };
    if !is_refused {
        assert!(result.positive, "{:02X?}", result.octets);
        return;
    }
    refused(&result, edition, 0xFFF0, error_info::OUT_OF_RANGE, job_error::ARGBLOCK_INCONSISTENT);
    assert_eq!(bench.last.len(), 1);
    assert_eq!(bench.read(SmiService::ReadbackPortConfiguration).octets, before);
    bench.row(d(3), m(5), PDin);
}

#[rstest]
#[case::no_such_mode(&[3, 0, 0], true)]
#[case::once_for_no_time(&[0, 0, 0], true)]
#[case::too_short(&[1, 0], true)]
#[case::too_long(&[1, 0, 0, 0], true)]
#[case::once(&[0, 0, 1], false)]
fn port_power_off_on(
    #[values(Edition::V1_1, Edition::Iec2022)] edition: Edition,
    #[case] content: &[u8],
    #[case] is_refused: bool,
) {
    let mut bench = Bench::operate(of(edition));
    let id: u16 = if edition == Edition::V1_1 { 0x7002 } else { 0x7003 };
    let result = bench.smi(SmiService::PortPowerOffOn, PORT, &[&id.to_be_bytes(), content].concat());
    assert_eq!(result.positive, !is_refused);
    assert_eq!(bench.seen().contains(&l_plus(false)), !is_refused);
}

#[test]
fn pd_out_wants_its_length_and_operate() {
    let edition = Edition::Iec2022;
    let (mut bench, _) = mixed(edition);
    let wrong = bench.smi(SmiService::PdOut, PORT, &[0x10, 0x02, 1, 2]);
    refused(&wrong, edition, 0xFFF0, 0, job_error::ARGBLOCK_LENGTH_INVALID);
    bench.plug(None);
    for service in [SmiService::PdIn, SmiService::PdInOut, SmiService::FsPdInOut] {
        let expected = bench.read(service);
        assert_eq!(expected.octets[4..], job_error::DEVICE_NOT_IN_OPERATE.to_be_bytes());
    }
}

#[rstest]
fn device_write_goes_out_at_once(#[values(Edition::V1_1, Edition::Iec2022)] edition: Edition) {
    let mut bench = Bench::factory(of(edition));
    let write = [0x30, 0x00, 0x00, 0x24, 3, 0xAB, 0xCD];
    let result = bench.smi(SmiService::DeviceWrite, PORT, &write);
    refused(&result, edition, 0xFFF0, error_info::NO_COM, job_error::DEVICE_NOT_ACCESSIBLE);
    bench.configure(&list(of(edition)));
    bench.start();
    assert!(bench.smi(SmiService::DeviceWrite, PORT, &write).positive);
    let request = Seen::Request { port: PORT, index: 0x24, subindex: 3, data: Some(vec![0xAB, 0xCD]) };
    assert_eq!(bench.seen()[..1], [request]);
}

/// One request at a time: until the answer, until it is given up, or until communication is lost.
#[test]
fn one_request_is_open_at_a_time() {
    let write = [0x30, 0x00, 0x00, 0x24, 0, 1];
    let mut bench = Bench::factory(plain());
    bench.configure(&list(plain()));
    bench.start_up_to_record();
    let busy = |bench: &mut Bench| {
        let result = bench.smi(SmiService::DeviceWrite, PORT, &write);
        refused(&result, plain().edition, 0xFFF0, 0, job_error::SERVICE_TEMP_UNAVAILABLE);
        assert_eq!(bench.last.len(), 1);
    };
    let accepted = |bench: &mut Bench| assert!(bench.smi(SmiService::DeviceWrite, PORT, &write).positive);
    busy(&mut bench);
    bench.respond(Response::Written);
    assert_eq!(bench.seen(), [mode(Mode::Operate)]);
    accepted(&mut bench);
    busy(&mut bench);
    bench.respond(Response::Refused(0x8011));
    accepted(&mut bench);
    bench.advance(5 * S - 1);
    busy(&mut bench);
    bench.advance(1);
    accepted(&mut bench);
    bench.plug(None);
    bench.advance(2 * S);
    bench.plug(Some(list(plain()).identity()));
    bench.start_up_to_record();
    assert!(bench.seen().contains(&record(&list(plain()))));
}

/// The value can only come from the Device, and a result that waits is not part of the contract.
#[test]
fn device_read_goes_out_and_has_no_result() {
    let read = [0x30, 0x01, 0x00, 0x10, 0];
    let mut bench = Bench::factory(plain());
    let result = bench.smi(SmiService::DeviceRead, PORT, &read);
    refused(&result, plain().edition, 0x3000, 0, job_error::DEVICE_NOT_ACCESSIBLE);
    bench.configure(&list(plain()));
    bench.start();
    assert_eq!(bench.request(SmiService::DeviceRead, PORT, 0x3000, &read), None);
    let request = Seen::Request { port: PORT, index: 0x10, subindex: 0, data: None };
    assert_eq!(bench.seen(), [request, Seen::Unsupported]);
    bench.respond(Response::Value(vec![1, 2, 3]));
    assert_eq!(bench.seen(), []);
}

const PASSWORDS: MasterOptions = MasterOptions {
    mutant: None,
    latency: 0,
    clock: fsct_adapters::ClockKind::Virtual,
    ports: 2,
    password: 0x1122_3344,
    reset_password: 0x5566_7788,
};

fn access(password: u32, reset: u32) -> Vec<u8> {
    [&[0x01, 0x00][..], &password.to_be_bytes(), &reset.to_be_bytes(), &[0]].concat()
}

#[test]
fn access_returns_the_authenticity() {
    let expected = |id: [u8; 2]| [&id[..], &AUTHENTICITY].concat();
    let mut bench = Bench::factory(plain());
    assert_eq!(bench.smi(SmiService::FsMasterAccess, 0, &access(0, 0)).octets, [&[0x01, 0x01][..], &[0; 8]].concat());
    bench.fscp(AUTHENTICITY);
    positive(&bench.smi(SmiService::FsMasterAccess, 0, &access(0, 0)), 0x0100, &expected([0x01, 0x01]));
    // v1.1: UserRole and FSMasterPassword, both reserved.
    let mut bench = Bench::factory(of(Edition::V1_1));
    bench.fscp(AUTHENTICITY);
    positive(&bench.smi(SmiService::FsMasterAccess, 0, &[1, 9, 9, 9, 9]), 0, &expected([0x00, 0x01]));
    let short = bench.smi(SmiService::FsMasterAccess, 0, &[1, 9, 9, 9]);
    refused(&short, Edition::V1_1, 0, error_info::OUT_OF_RANGE, 0);
}

#[test]
fn access_needs_the_password() {
    let mut bench = Bench::factory_with(plain(), PASSWORDS);
    assert!(bench.smi(SmiService::FsMasterAccess, 0, &access(0x1122_3344, 0)).positive);
    for (password, reset) in [(0, 0), (0x1122_3345, 0), (0, 0x5566_7789)] {
        let result = bench.smi(SmiService::FsMasterAccess, 0, &access(password, reset));
        refused(&result, plain().edition, 0x0101, 0, job_error::ARGBLOCK_INCONSISTENT);
    }
}

/// The project is gone, what is plugged stays, and all of it is seen.
#[test]
fn the_reset_password_resets() {
    let mut bench = Bench::operate_with(plain(), PASSWORDS);
    let now = bench.last.last().unwrap().at;
    assert!(bench.smi(SmiService::FsMasterAccess, 0, &access(0, 0x5566_7788)).positive);
    let timed = bench.timed();
    assert!(timed.contains(&(now, mode(Mode::Inactive))) && timed.contains(&(now, l_plus(false))));
    assert!(!bench.bit(fsct_adapters::Service::Qualifier));
    assert_eq!(bench.info(), 1);
    assert!(bench.smi(SmiService::FsMasterAccess, 0, &access(0, 0)).positive, "the default password");
    bench.advance(60 * S);
    assert_eq!(bench.last, []);
    bench.configure(&list(plain()));
    bench.start();
    assert_eq!(bench.info(), 8);
}

/// A reset password of 0 is none.
#[test]
fn without_reset_password_nothing_is_reset() {
    let mut bench = Bench::operate(plain());
    assert!(bench.smi(SmiService::FsMasterAccess, 0, &access(0, 0)).positive);
    bench.row(d(3), m(5), PDin);
}

/// One result for each, whatever the service.
#[rstest]
fn every_service_is_answered(#[values(0, 1, 2, 3)] port: u8) {
    for edition in EDITIONS {
        for (service, ..) in SmiService::ALL {
            let mut bench = Bench::operate(of(edition));
            bench.respond(Response::Written);
            for octets in [&[][..], &VOID, &[0x30, 0x00, 0, 1, 0], &[0; 50]] {
                bench.smi(service, port, octets);
            }
        }
    }
}
