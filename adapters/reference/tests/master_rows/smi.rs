//! The SMI services: ArgBlocks octet by octet per edition, errors in priority order (10.2, 10.3).

use crate::bench::*;
use fsct_adapters::smi::{error_info, job_error};
use fsct_adapters::{Identity, Mode, Octets, Response, Seen, Service, SmiRequest, SmiResult, SmiService, Stimulus};
use fsct_protocol::Edition;
use fsct_reference::MasterOptions;
use rstest::rstest;

fn idle(edition: Edition) -> Bench {
    Bench::idle(edition, MasterOptions::default())
}

/// The ExpArgBlockID of a service and the ArgBlock of a read, as Table 15 and Table 18 have them.
fn read(edition: Edition, expected: u16) -> (u16, &'static [u8]) {
    if edition == V1_1 { (0, &[]) } else { (expected, &VOID) }
}

#[track_caller]
fn expect_positive(result: &SmiResult, reference: u16, octets: &[u8]) {
    assert_eq!((result.positive, result.octets.as_slice(), result.reference), (true, octets, reference));
    assert_eq!(usize::from(result.length), octets.len());
}

#[track_caller]
fn expect_job_error(result: &SmiResult, expected: u16, error: u16) {
    let block = [0xFFFF, expected, error].map(u16::to_be_bytes).concat();
    assert_eq!((result.positive, result.octets.as_slice(), result.length), (false, block.as_slice(), 6), "{error:04X}");
}

#[track_caller]
fn expect_error_info(result: &SmiResult, error: u16) {
    assert_eq!((result.positive, result.octets.as_slice()), (false, error.to_be_bytes().as_slice()));
    assert_eq!((result.reference, result.length), (0, 0));
}

// --- blocks ---

#[rstest]
#[case(V1_1, &[0x00, 0x00], 0)]
#[case(Iec2022, &[0x00, 0x01], 0xFFF0)]
fn master_ident(#[case] edition: Edition, #[case] id: &[u8], #[case] reference: u16) {
    let mut bench = Bench::idle(edition, MasterOptions { ports: 3, ..MasterOptions::default() });
    let (expected, request) = read(edition, 0x0001);
    let result = bench.smi(SmiService::MasterIdentification, 0, expected, request);
    assert_eq!((&result.octets[..2], result.octets[8], result.octets[11], result.octets.len()), (id, 3, 3, 15));
    assert_eq!((result.reference, usize::from(result.length)), (reference, 15));
}

#[rstest]
fn the_configuration_reads_back_as_written(#[values(V1_1, Iec2022)] edition: Edition) {
    let mut bench = Bench::configured(List::new(edition), MasterOptions::default());
    let list = bench.list.octets();
    assert_eq!(list.len(), if edition == V1_1 { 48 } else { 50 });
    let (expected, request) = read(edition, 0x8100);
    let result = bench.smi(SmiService::ReadbackPortConfiguration, PORT, expected, request);
    expect_positive(&result, if edition == V1_1 { 0 } else { 0xFFF0 }, &list);
}

#[test]
fn a_positive_result_without_content_is_a_void_block() {
    let list = List::new(Iec2022).octets();
    let result = idle(Iec2022).smi(SmiService::PortConfiguration, PORT, 0xFFF0, &list);
    expect_positive(&result, 0x8100, &VOID);
    let list = List::new(V1_1).octets();
    let result = idle(V1_1).smi(SmiService::PortConfiguration, PORT, 0, &list);
    expect_positive(&result, 0, &[]);
}

#[test]
fn port_status_in_operate() {
    let mut bench = Bench::waiting_first(V1_1, None);
    assert_eq!(bench.status(), [0x90, 0x01, 8, 0, 0x11, 3, 10, 0, 0x04, 0xD2, 0, 0, 0x12, 0x34, 0]);
    let mut bench = Bench::waiting_first(Iec2022, None);
    assert_eq!(bench.status(), [0x91, 0x00, 8, 0, 0x11, 3, 10, 0, 0, 0x04, 0xD2, 0, 0, 0x12, 0x34, 0]);
}

#[rstest]
fn port_status_before(#[values(V1_1, Iec2022)] edition: Edition) {
    assert_eq!(idle(edition).port_status_info(), 1, "DEACTIVATED");
    let mut bench = Bench::configured(List::new(edition), MasterOptions::default());
    let status = bench.status();
    assert_eq!((status[2], status[4], status[5]), (0, 0, 0), "NO_DEVICE");
}

/// SPDU and two non-safety octets in, one out.
fn mixed(edition: Edition) -> Bench {
    let list = List { port_mode: 50, nsr: (2, 1), ..List::new(edition) };
    let mut bench = Bench::configured(list, MasterOptions::default());
    bench.plug(Some(Identity { pd_in: 7, pd_out: 6, ..identity() }));
    bench.pulse(750_000);
    bench.respond(Response::Written);
    bench.set(Service::PdoutM, &[LIVE_OUT]);
    let input = [d(7).octets().as_slice(), &[0xBE, 0xEF]].concat();
    bench.exchange(Octets::new(&input));
    bench
}

#[rstest]
fn non_safety_data_stand_behind_the_spdu(#[values(V1_1, Iec2022)] edition: Edition) {
    let mut bench = mixed(edition);
    let (id, expected) = ([0x10, 0x02], if edition == V1_1 { 0 } else { 0xFFF0 });
    assert!(bench.smi(SmiService::PdOut, PORT, expected, &[id[0], id[1], 0x99]).positive);
    bench.exchange(None);
    assert_eq!(bench.image().unwrap().as_slice(), [m(1).octets().as_slice(), &[0x99]].concat());
    let (expected, request) = read(edition, 0x1001);
    assert_eq!(bench.smi(SmiService::PdIn, PORT, expected, request).octets, [0x10, 0x01, 0xBE, 0xEF]);
}

#[test]
fn fs_pd_in_out_is_a_snapshot_of_both_directions() {
    let mut bench = mixed(Iec2022);
    let result = bench.smi(SmiService::FsPdInOut, PORT, 0x1103, &VOID);
    let (spdu_in, spdu_out) = (d(7).octets(), m(1).octets());
    let (before, behind) = (&result.octets[..2], &result.octets[4..]);
    assert_eq!(before, [0x11, 0x03]);
    assert_eq!(behind, [&[7], spdu_in.as_slice(), &[0xBE, 0xEF, 6], spdu_out.as_slice(), &[0]].concat());
    assert_eq!((result.reference, usize::from(result.length)), (0xFFF0, 6 + 5 + 2 + 5 + 1));
}

#[test]
fn spdu_in_of_v1_1_is_the_fs_in_buffer() {
    let mut bench = Bench::waiting_first(V1_1, None);
    bench.row(d(7), m(1), PDin);
    let block = [&[0x10, 0x04], d(7).octets().as_slice()].concat();
    expect_positive(&bench.smi(SmiService::SpduIn, PORT, 0, &[]), 0, &block);
}

#[rstest]
#[case(V1_1, 0, &[0; 5], &[0x00, 0x01, 1, 2, 3, 4, 5, 6, 7, 8], 0)]
#[case(Iec2022, 0x0101, &[0x01, 0x00, 0, 0, 0, 0, 0, 0, 0, 0, 0], &[0x01, 0x01, 1, 2, 3, 4, 5, 6, 7, 8], 0x0100)]
fn fs_master_access(
    #[case] edition: Edition,
    #[case] expected: u16,
    #[case] request: &[u8],
    #[case] block: &[u8],
    #[case] reference: u16,
) {
    let mut bench = idle(edition);
    bench.set(Service::FscpAuthenticity, &[1, 2, 3, 4, 5, 6, 7, 8]);
    expect_positive(&bench.smi(SmiService::FsMasterAccess, 0, expected, request), reference, block);
}

// --- errors ---

/// What each row does wrong is wrong in the rows above it too: the first error counts.
#[rstest]
#[case::port(9, 0x7777, &[0x7F, 0xFF], job_error::PORT_NUM_INVALID)]
#[case::port_0(0, 0x7777, &[0x7F, 0xFF], job_error::PORT_NUM_INVALID)]
#[case::block(PORT, 0x7777, &[0x7F, 0xFF], job_error::ARGBLOCK_NOT_SUPPORTED)]
#[case::no_block(PORT, 0x7777, &[], job_error::ARGBLOCK_NOT_SUPPORTED)]
#[case::length(PORT, 0x7777, &[0xFF, 0xF0, 0], job_error::ARGBLOCK_LENGTH_INVALID)]
#[case::expected(PORT, 0x7777, &VOID, job_error::ARGBLOCK_INCONSISTENT)]
#[case::state(PORT, 0x1103, &VOID, job_error::DEVICE_NOT_IN_OPERATE)]
fn errors_in_priority_order(#[case] port: u8, #[case] expected: u16, #[case] request: &[u8], #[case] error: u16) {
    let result = idle(Iec2022).smi(SmiService::FsPdInOut, port, expected, request);
    expect_job_error(&result, expected, error);
}

#[rstest]
#[case::port_mode(2, &[5])]
#[case::reserved_port_mode(2, &[52])]
#[case::validation(3, &[5])]
#[case::iq_behavior(4, &[2])]
#[case::vendor_id(6, &[0, 0])]
#[case::device_id(8, &[0, 0, 0, 0])]
#[case::device_id_of_four_octets(8, &[1, 0, 0, 0])]
#[case::time_to_ready_0(12, &[0, 0])]
#[case::time_to_ready(12, &[0x80, 0])]
#[case::min_shut_down_short(14, &[0, 0x63])]
#[case::min_shut_down_long(14, &[0x03, 0xE9])]
#[case::fsp_port(24, &[0])]
#[case::io_desc_version(39, &[2])]
#[case::spdu_in(40, &[3])]
#[case::spdu_out(45, &[33])]
fn a_value_outside_its_range_changes_nothing(#[case] offset: usize, #[case] value: &[u8]) {
    let mut bench = Bench::operate(4);
    let before = bench.list.octets();
    let mut list = before.clone();
    list[offset..offset + value.len()].copy_from_slice(value);
    let result = bench.smi(SmiService::PortConfiguration, PORT, 0xFFF0, &list);
    expect_job_error(&result, 0xFFF0, job_error::ARGBLOCK_INCONSISTENT);
    assert_eq!(bench.last.len(), 1, "the port goes on");
    assert_eq!(bench.smi(SmiService::ReadbackPortConfiguration, PORT, 0x8100, &VOID).octets, before);
    bench.row(d(3), m(5), PDin);
}

#[test]
fn do_c_q_is_refused_in_v1_1() {
    let list = List { port_mode: 4, ..List::new(V1_1) }.octets();
    expect_error_info(&idle(V1_1).smi(SmiService::PortConfiguration, PORT, 0, &list), error_info::OUT_OF_RANGE);
}

#[rstest]
#[case::mode(3, 1_000)]
#[case::no_time(0, 0)]
fn port_power_off_on_has_its_ranges(#[case] mode: u8, #[case] time_ms: u16) {
    let mut bench = Bench::operate(4);
    expect_job_error(&bench.power_off_on(mode, time_ms), 0xFFF0, job_error::ARGBLOCK_INCONSISTENT);
    bench.row(d(3), m(5), PDin);
}

#[rstest]
fn spdu_services_belong_to_v1_1(#[values(SmiService::SpduIn, SmiService::SpduOut)] service: SmiService) {
    let mut bench = Bench::operate(4);
    let (expected, request) = match service {
        SmiService::SpduIn => (0x1101, VOID.to_vec()),
        _ => (0xFFF0, [&[0x11, 0x02], m(5).octets().as_slice()].concat()),
    };
    expect_job_error(&bench.smi(service, PORT, expected, &request), expected, job_error::SERVICE_NOT_SUPPORTED);
}

#[test]
fn spdu_services_of_v1_1_need_their_state() {
    let out = [&[0x10, 0x05], m(5).octets().as_slice()].concat();
    let mut bench = Bench::configured(List::new(V1_1), MasterOptions::default());
    expect_error_info(&bench.smi(SmiService::SpduIn, PORT, 0, &[]), error_info::NO_COM);
    let mut bench = Bench::waiting_first(V1_1, None);
    expect_error_info(&bench.smi(SmiService::SpduOut, PORT, 0, &out), error_info::STATE_CONFLICT);
    let mut bench = Bench::configured(List { port_mode: 1, ..List::new(V1_1) }, MasterOptions::default());
    expect_error_info(&bench.smi(SmiService::SpduIn, PORT, 0, &[]), error_info::STATE_CONFLICT);
}

// --- passwords ---

fn access(bench: &mut Bench, password: u32, reset: u32) -> SmiResult {
    let request = [&[0x01, 0x00], password.to_be_bytes().as_slice(), &reset.to_be_bytes(), &[0]].concat();
    bench.smi(SmiService::FsMasterAccess, 0, 0x0101, &request)
}

#[test]
fn passwords() {
    let options = MasterOptions { password: 0x0A0B_0C0D, reset_password: 0x0102_0304, ..MasterOptions::default() };
    let mut bench = Bench::configured(List::new(Iec2022), options);
    bench.connect();
    expect_job_error(&access(&mut bench, 0, 0), 0x0101, job_error::ARGBLOCK_INCONSISTENT);
    expect_job_error(&access(&mut bench, 0, 0x0102_0305), 0x0101, job_error::ARGBLOCK_INCONSISTENT);
    assert!(access(&mut bench, 0x0A0B_0C0D, 0).positive);
    assert_eq!(bench.port_status_info(), 8, "nothing has changed");
    assert!(access(&mut bench, 0, 0x0102_0304).positive);
    assert_eq!((bench.port_status_info(), bench.modes().last()), (1, Some(&Mode::Inactive)));
    assert!(access(&mut bench, 0, 0).positive, "back to the default");
}

#[test]
fn without_a_reset_password_nothing_is_reset() {
    let mut bench = Bench::operate(4);
    assert!(access(&mut bench, 0, 0).positive);
    bench.row(d(3), m(5), PDin);
}

// --- on-request data ---

#[test]
fn device_write_sends_a_request_and_is_positive_at_once() {
    let mut bench = Bench::operate(4);
    let block = [0x30, 0x00, 0x00, 0x18, 0x00, b'T', b'a', b'g'];
    let result = bench.smi(SmiService::DeviceWrite, PORT, 0xFFF0, &block);
    expect_positive(&result, 0x3000, &VOID);
    assert_eq!(bench.requests().last(), Some(&(0x0018, 0, Some(b"Tag".to_vec()))));
    let result = bench.smi(SmiService::DeviceWrite, PORT, 0xFFF0, &block);
    expect_job_error(&result, 0xFFF0, job_error::SERVICE_TEMP_UNAVAILABLE);
    bench.respond(Response::Written);
    assert!(bench.smi(SmiService::DeviceWrite, PORT, 0xFFF0, &block).positive);
}

#[rstest]
#[case(SmiService::DeviceWrite, 0xFFF0, &[0x30, 0x00, 0x00, 0x18, 0x00, 1])]
#[case(SmiService::DeviceRead, 0x3000, &[0x30, 0x01, 0x00, 0x10, 0x00])]
fn without_a_device_there_are_no_on_request_data(
    #[case] service: SmiService,
    #[case] expected: u16,
    #[case] request: &[u8],
) {
    let mut bench = Bench::configured(List::new(Iec2022), MasterOptions::default());
    expect_job_error(&bench.smi(service, PORT, expected, request), expected, job_error::DEVICE_NOT_ACCESSIBLE);
    assert_eq!(bench.requests(), []);
}

/// The value comes with a later stimulus and cannot be part of this result.
#[test]
fn device_read_asks_the_device_and_has_no_result_to_wait_for() {
    let mut bench = Bench::operate(4);
    let request = SmiRequest {
        service: SmiService::DeviceRead,
        port: PORT,
        client_id: 1,
        expected: 0x3000,
        octets: vec![0x30, 0x01, 0x00, 0x10, 0x00],
    };
    let seen = bench.apply(Stimulus::Smi(Box::new(request)));
    let asked = Seen::Request { port: PORT, index: 0x0010, subindex: 0, data: None };
    assert_eq!(seen, [asked, Seen::Unsupported]);
    assert_eq!(bench.respond(Response::Value(b"fsct".to_vec())), []);
}
