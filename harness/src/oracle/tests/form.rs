//! Images that no SPDU of this side ever looks like, and what is said of them.

use super::device::Link;
use super::master::Port as MasterPort;
use super::*;
use fsct_protocol::crc::{crc16, crc32};
use fsct_protocol::spdu::{View, Wire};
use fsct_reports::record::Verdict;
use rstest::rstest;

/// An image as the DUT of a role would send it, with PortNum and control or status octet of choice.
fn image(port_num: u8, octet: u8, signature: Option<u32>, reading: Reading) -> Vec<u8> {
    let wire = Wire { pd: Pd::safe(2), port_num, octet, signature };
    wire.emit(ProtMode::Crc16, reading).octets().to_vec()
}

fn shown(role: Role, image: &[u8]) -> Result<(), Mismatch> {
    match role {
        Role::Device => {
            let mut link = Link::ready(strict(role));
            link.oracle.exchange(CYCLE, Some(&m(0, 0, 0, PDOUT)), Some(image), &nothing())
        }
        Role::Master => MasterPort::ready(strict(role)).oracle.exchange(CYCLE, None, Some(image), &nothing()),
    }
}

#[rstest]
#[case::device(Role::Device, 0xFE, 0xE4)]
#[case::master(Role::Master, 0x01, 0x02)]
fn the_right_form_is_taken(#[case] role: Role, #[case] port_num: u8, #[case] octet: u8) {
    let image = image(port_num, octet, None, Reading::Preset);
    assert_eq!(shown(role, &image), Ok(()));
    assert_eq!(shown(role, &[image.as_slice(), &[0x55]].concat()), Ok(()), "non-safety data follow");
    let short = refused(shown(role, &image[..5]), "length");
    assert_eq!((short.expected.as_str(), short.observed.as_str()), ("an SPDU of 6 octets", "5 octets"));
}

#[rstest]
#[case::device_not_inverted(
    Role::Device,
    0x01,
    0xE4,
    "PortNum FE (port 1 inverted)",
    "PortNum 01 (the port number, not inverted)"
)]
#[case::device_other(Role::Device, 0x02, 0xE4, "PortNum FE (port 1 inverted)", "PortNum 02")]
#[case::master_inverted(Role::Master, 0xFE, 0x02, "PortNum 01 (port 1)", "PortNum FE (the port number inverted)")]
#[case::master_other(Role::Master, 0x02, 0x02, "PortNum 01 (port 1)", "PortNum 02")]
fn a_wrong_port_num_is_told(
    #[case] role: Role,
    #[case] port_num: u8,
    #[case] octet: u8,
    #[case] expected: &str,
    #[case] observed: &str,
) {
    let told = refused(shown(role, &image(port_num, octet, None, Reading::Preset)), "PortNum");
    assert_eq!((told.expected.as_str(), told.observed.as_str()), (expected, observed));
}

#[rstest]
#[case::device_bit_3(Role::Device, 0xFE, 0xEC, "Status&DCnt EC", "11.4.6 Table 32")]
#[case::device_bit_4(Role::Device, 0xFE, 0xF4, "Status&DCnt F4", "11.4.6 Table 32")]
#[case::master_bit_2(Role::Master, 0x01, 0x06, "Control&MCnt 06", "11.4.6 Table 31")]
#[case::master_bit_4(Role::Master, 0x01, 0x12, "Control&MCnt 12", "11.4.6 Table 31")]
fn reserved_bits(
    #[case] role: Role,
    #[case] port_num: u8,
    #[case] octet: u8,
    #[case] observed: &str,
    #[case] table: &str,
) {
    let told = refused(shown(role, &image(port_num, octet, None, Reading::Preset)), "reserved");
    assert_eq!((told.observed.as_str(), told.clause.as_str()), (observed, table));
}

#[test]
fn a_wrong_signature_is_told_by_what_it_may_be() {
    let right = image(0xFE, 0xE4, None, Reading::Preset);
    let seed_0 = u32::from(crc16(0, &right[..4]));
    let swapped = u32::from(u16::from_be_bytes([right[4], right[5]]).swap_bytes());
    for (signature, hint) in
        [(seed_0, "it is the signature with start value 0"), (swapped, "its octets are in reverse order"), (0xFFFF, "")]
    {
        let told = refused(shown(Role::Device, &image(0xFE, 0xE4, Some(signature), Reading::Preset)), "signature");
        assert_eq!(told.verdict, Verdict::Fail);
        let text = if hint.is_empty() { String::new() } else { format!("; {hint}") };
        assert_eq!(told.observed, format!("signature {signature:04X}{text}"));
        assert!(told.expected.starts_with(&format!("signature {:02X}{:02X}", right[4], right[5])), "{told:?}");
    }
}

#[rstest]
#[case(ProtMode::Crc16)]
#[case(ProtMode::Crc32)]
fn hints_hold_for_both_signatures(#[case] mode: ProtMode) {
    let setup = Setup { mode, pd_in: 3, ..strict(Role::Device) };
    let wire = Wire { pd: Pd::new(&[1, 2, 3]).unwrap(), port_num: 0xFE, octet: 0xE4, signature: None };
    let right = wire.emit(mode, Reading::Preset);
    let view = View::new(right.octets(), mode, 3).unwrap();
    assert_eq!(crate::oracle::explain::form(&setup, right.octets()), None);
    let swapped = view.signature().swap_bytes() >> (32 - 8 * mode.signature_octets());
    let told = |signature: u32| {
        let falsified = Wire { signature: Some(signature), ..wire }.emit(mode, Reading::Preset);
        crate::oracle::explain::form(&setup, falsified.octets()).expect("it is wrong")
    };
    let secured = &right.octets()[..5];
    let seed_0 = if mode == ProtMode::Crc16 { crc16(0, secured).into() } else { crc32(0, secured) };
    assert!(told(seed_0).observed.ends_with("it is the signature with start value 0"));
    assert!(told(swapped).observed.ends_with("its octets are in reverse order"));
    assert!(told(view.signature() ^ 1).observed.len() == "signature ".len() + 2 * mode.signature_octets());
}

#[test]
fn a_computed_0_that_is_not_replaced_is_named() {
    let setup = strict(Role::Device);
    let zero = (0..=0xFFFFu16)
        .map(|pd| Wire { pd: Pd::new(&pd.to_be_bytes()).unwrap(), port_num: 0xFE, octet: 0xE4, signature: None })
        .find(|wire| crc16(1, &wire.emit(ProtMode::Crc16, Reading::Preset).octets()[..4]) == 0)
        .expect("one of them has the signature 0");
    let sent = Wire { signature: Some(0), ..zero }.emit(ProtMode::Crc16, Reading::Preset);
    let told = crate::oracle::explain::form(&setup, sent.octets()).expect("it is wrong");
    assert_eq!(told.observed, "signature 0000; a computed 0 has not been replaced by 1");
}

#[rstest]
#[case(Reading::LeadingOctet, "signature/A02")]
#[case(Reading::FieldFed, "signature/A03")]
fn another_reading_of_the_start_value_is_inconclusive(#[case] reading: Reading, #[case] kind: &str) {
    let told = refused(shown(Role::Device, &image(0xFE, 0xE4, None, reading)), kind);
    assert_eq!(told.verdict, Verdict::Inconclusive);
    let setup = Setup { reading, ..strict(Role::Device) };
    assert_eq!(crate::oracle::explain::form(&setup, &image(0xFE, 0xE4, None, reading)), None);
    let told = crate::oracle::explain::form(&setup, &image(0xFE, 0xE4, None, Reading::Preset)).expect("not that one");
    assert_eq!(told.kind, "signature/A01");
}
