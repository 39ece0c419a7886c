//! SMI services: ArgBlocks octet by octet per edition, and errors in their order (10.2, 10.3).

use crate::bench::*;
use fsct_adapters::smi::{error_info, job_error};
use fsct_adapters::{Octets, Service, SmiService};
use fsct_protocol::Edition;
use fsct_reference::MasterOptions;
use rstest::rstest;

const VOID: [u8; 2] = [0xFF, 0xF0];

fn idle(edition: Edition) -> Bench {
    Bench::idle(edition, MasterOptions::default())
}

#[test]
fn master_identification_says_fs_master() {
    let result = idle(Edition::Iec2022).smi(SmiService::MasterIdentification, 0, 0x0001, &VOID);
    assert!(result.positive && result.reference == 0xFFF0 && result.client_id == 0x4711);
    assert_eq!(result.octets, [0x00, 0x01, 0x04, 0xD2, 0, 0, 0, 1, 3, 0, 0, 2, 4, 4]);
    assert_eq!(usize::from(result.length), result.octets.len());
    assert_eq!(idle(Edition::V1_1).smi(SmiService::MasterIdentification, 0, 0, &[]).octets[..2], [0, 0]);
}

#[rstest]
#[case(Edition::V1_1, 0, &[0; 5], &[0x00, 0x01, 1, 2, 3, 4, 5, 6, 7, 8])]
#[case(Edition::Iec2022, 0x0101, &[0x01, 0x00, 0, 0, 0, 0, 0, 0, 0, 0, 0], &[0x01, 0x01, 1, 2, 3, 4, 5, 6, 7, 8])]
fn fs_master_access_delivers_the_authenticity(
    #[case] edition: Edition,
    #[case] expected: u16,
    #[case] request: &[u8],
    #[case] block: &[u8],
) {
    let mut bench = idle(edition);
    bench.set(Service::FscpAuthenticity, Octets::new(&[1, 2, 3, 4, 5, 6, 7, 8]).expect("it fits"));
    let result = bench.smi(SmiService::FsMasterAccess, 0, expected, request);
    assert!(result.positive);
    assert_eq!(result.octets, block);
    assert_eq!(result.length, 10);
}

#[rstest]
#[case::port(9, &[0x01, 0xFF, 0], 0, job_error::PORT_NUM_INVALID)]
#[case::id(1, &[0x01, 0xFF, 0], 0, job_error::ARGBLOCK_NOT_SUPPORTED)]
#[case::length(1, &[0x01, 0x00, 0, 0, 0, 0, 0, 0, 0, 0], 0, job_error::ARGBLOCK_LENGTH_INVALID)]
#[case::expected(1, &[0x01, 0x00, 0, 0, 0, 0, 0, 0, 0, 0, 0], 0x0100, job_error::ARGBLOCK_INCONSISTENT)]
#[case::password(1, &[0x01, 0x00, 0, 0, 0, 1, 0, 0, 0, 0, 0], 0x0101, job_error::ARGBLOCK_INCONSISTENT)]
fn errors_come_in_their_order(#[case] port: u8, #[case] request: &[u8], #[case] expected: u16, #[case] error: u16) {
    let result = idle(Edition::Iec2022).smi(SmiService::FsMasterAccess, port, expected, request);
    let [high, low] = error.to_be_bytes();
    let [expected_high, expected_low] = expected.to_be_bytes();
    assert!(!result.positive);
    assert_eq!(result.octets, [0xFF, 0xFF, expected_high, expected_low, high, low]);
    assert_eq!((result.length, result.port), (6, port));
}

#[test]
fn the_configuration_reads_back_as_it_was_written() {
    for (edition, octets) in [(Edition::V1_1, 48), (Edition::Iec2022, 50)] {
        let mut bench = idle(edition);
        let list = bench.list();
        assert_eq!(list.len(), octets);
        bench.configure(list.clone());
        let (expected, request) = if edition == Edition::V1_1 { (0, &[][..]) } else { (0x8100, &VOID[..]) };
        let result = bench.smi(SmiService::ReadbackPortConfiguration, 1, expected, request);
        assert_eq!(result.octets, list);
    }
}

#[test]
fn values_outside_their_ranges_change_nothing() {
    let mut bench = idle(Edition::Iec2022);
    bench.configure(bench.list());
    for (offset, value) in [(2, 5), (2, 52), (3, 5), (4, 2), (14, 0xFF), (24, 0), (40, 3)] {
        let mut list = bench.list();
        list[offset] = value;
        let result = bench.smi(SmiService::PortConfiguration, 1, 0xFFF0, &list);
        assert!(!result.positive, "octet {offset} = {value}");
    }
    let list = bench.list();
    assert_eq!(bench.smi(SmiService::ReadbackPortConfiguration, 1, 0x8100, &VOID).octets, list);
}

#[test]
fn the_status_list_is_laid_out_as_its_edition_prints_it() {
    let mut bench = Bench::operate(Edition::V1_1, MasterOptions::default());
    let v1_1 = bench.smi(SmiService::PortStatus, 1, 0, &[]).octets;
    assert_eq!(v1_1, [0x90, 0x01, 8, 0, 0x11, 3, 10, 0, 0x04, 0xD2, 0, 0, 0x12, 0x34, 0]);
    let mut bench = Bench::operate(Edition::Iec2022, MasterOptions::default());
    let iec = bench.smi(SmiService::PortStatus, 1, 0x9100, &VOID).octets;
    assert_eq!(iec, [0x91, 0x00, 8, 0, 0x11, 3, 10, 0, 0, 0x04, 0xD2, 0, 0, 0x12, 0x34, 0]);
}

#[test]
fn fs_pd_in_out_holds_both_directions() {
    let mut bench = Bench::operate(Edition::Iec2022, MasterOptions::default());
    let input = spdu(mirror(3), 0xA5);
    let result = bench.smi(SmiService::FsPdInOut, 1, 0x1103, &VOID);
    assert_eq!(result.octets[..5], [0x11, 0x03, 0, 1, 5]);
    assert_eq!(&result.octets[5..10], input.as_slice());
    assert_eq!((result.octets[10], result.octets.len()), (5, 16));
    let mut idle = idle(Edition::Iec2022);
    let refused = idle.smi(SmiService::FsPdInOut, 1, 0x1103, &VOID);
    assert_eq!(refused.octets[4..], job_error::DEVICE_NOT_IN_OPERATE.to_be_bytes());
}

#[test]
fn spdu_in_is_for_v1_1() {
    let mut bench = Bench::operate(Edition::V1_1, MasterOptions::default());
    let result = bench.smi(SmiService::SpduIn, 1, 0, &[]);
    assert_eq!(result.octets[..2], [0x10, 0x04]);
    assert_eq!(&result.octets[2..], spdu(mirror(3), 0xA5).as_slice());
    let mut bench = idle(Edition::V1_1);
    assert_eq!(bench.smi(SmiService::SpduOut, 1, 0, &[0x10, 0x05, 0]).octets, error_info::STATE_CONFLICT.to_be_bytes());
    let mut bench = Bench::operate(Edition::Iec2022, MasterOptions::default());
    assert!(!bench.smi(SmiService::SpduIn, 1, 0x1101, &VOID).positive);
}

#[test]
fn the_reset_password_clears_project_and_password() {
    let options = MasterOptions { password: 0x0A0B_0C0D, reset_password: 0x0102_0304, ..MasterOptions::default() };
    let mut bench = Bench::idle(Edition::Iec2022, options);
    bench.configure(bench.list());
    let mut access = |password: [u8; 4], reset: [u8; 4]| {
        let request = [&[0x01, 0x00], password.as_slice(), &reset, &[0]].concat();
        bench.smi(SmiService::FsMasterAccess, 0, 0x0101, &request).positive
    };
    assert!(!access([0; 4], [0; 4]));
    assert!(access([0x0A, 0x0B, 0x0C, 0x0D], [0; 4]));
    assert!(!access([0; 4], [1, 2, 3, 5]));
    assert!(access([0; 4], [1, 2, 3, 4]));
    assert!(access([0; 4], [0; 4]), "no password any more");
    assert_eq!(bench.smi(SmiService::PortStatus, 1, 0x9100, &VOID).octets.get(2), Some(&1), "DEACTIVATED");
}
