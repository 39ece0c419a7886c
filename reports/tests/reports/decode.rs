//! SPDUs in words: what came, what is wrong with it, from either side.

use fsct_protocol::ProtMode;
use fsct_protocol::crc::{Reading, signature};
use fsct_reports::decode::Side;
use fsct_reports::record::VariantInfo;
use rstest::rstest;

fn crc16(pd: u8) -> VariantInfo {
    VariantInfo { edition: "iec2022".into(), mode: "crc16".into(), pd_out: pd, pd_in: pd, leading_octet: false }
}

#[rstest]
#[case::regular(Some("5A01205727"), "PDout 5A · PortNum 1 · MCount 1 · setSD 0 · ChFAckReq 0 · CRC ok")]
#[case::start(Some("0001029D56"), "PDout 00 · PortNum 1 · MCount 0 · setSD 1 · ChFAckReq 0 · CRC ok")]
#[case::falsified(
    Some("5A01205726"),
    "PDout 5A · PortNum 1 · MCount 1 · setSD 0 · ChFAckReq 0 · CRC wrong: 5726, computed 5727"
)]
#[case::other_port(
    Some("5AFF3C0000"),
    "PDout 5A · PortNum FF · MCount 1 · setSD 0 · ChFAckReq 0 · reserved bits 00011100 · CRC wrong: 0000, computed "
)]
#[case::non_safety_data_behind(
    Some("5A0120572711FF"),
    "PDout 5A · PortNum 1 · MCount 1 · setSD 0 · ChFAckReq 0 · CRC ok · then 11 FF"
)]
#[case::zero(Some("0000000000"), "all zero")]
#[case::lost(None, "lost")]
#[case::short(Some("5A01"), "2 octets, an SPDU has 5: 5A 01")]
#[case::short_and_zero(Some("0000"), "2 octets, an SPDU has 5: 00 00")]
#[case::nothing(Some(""), "no octets")]
#[case::half_an_octet(Some("5"), "no octets")]
#[case::no_hexadecimal(Some("<script>"), "no octets")]
#[case::no_ascii(Some("５Ａ０１"), "no octets")]
fn sent_to_an_fs_device(#[case] hex: Option<&str>, #[case] says: &str) {
    let told = Side::Device.sent(hex, &crc16(1));
    assert!(told.starts_with(says), "{told}");
    assert!(told == says || says.ends_with("computed "), "{told}");
}

#[rstest]
#[case::regular(
    Some("A5FEC41933"),
    "PDin A5 · PortNum FE (=1 inverted) · DCount_i 6 · SDset 1 · DCommErr 0 · DTimeout 0 · CRC ok"
)]
#[case::nothing(None, "no process data")]
fn presented_by_an_fs_device(#[case] hex: Option<&str>, #[case] says: &str) {
    assert_eq!(Side::Device.got(hex, &crc16(1)), says);
}

/// An SPDU of one octet of process data with a good signature, from its octets before the signature.
fn signed(secured: [u8; 3]) -> String {
    let [pd, port, octet] = secured;
    format!("{pd:02X}{port:02X}{octet:02X}{:04X}", signature(ProtMode::Crc16, Reading::Preset, &secured))
}

#[rstest]
#[case::none(0b000, "SDset 0 · DCommErr 0 · DTimeout 0 · CRC ok", "SDset 0")]
#[case::sdset(0b100, "SDset 1 · DCommErr 0 · DTimeout 0 · CRC ok", "SDset 1")]
#[case::dcommerr(0b010, "SDset 0 · DCommErr 1 · DTimeout 0 · CRC ok", "SDset 0 DCommErr")]
#[case::dtimeout(0b001, "SDset 0 · DCommErr 0 · DTimeout 1 · CRC ok", "SDset 0 DTimeout")]
#[case::all(0b111, "SDset 1 · DCommErr 1 · DTimeout 1 · CRC ok", "SDset 1 DCommErr DTimeout")]
#[case::reserved(0b0_1000, "SDset 0 · DCommErr 0 · DTimeout 0 · reserved bits 00001000 · CRC ok", "SDset 0")]
fn every_bit_of_the_status_octet_has_its_name(#[case] bits: u8, #[case] told: &str, #[case] label: &str) {
    let hex = signed([0xA5, 0xFE, 4 << 5 | bits]);
    let says = format!("PDin A5 · PortNum FE (=1 inverted) · DCount_i 4 · {told}");
    assert_eq!(Side::Device.got(Some(&hex), &crc16(1)), says);
    assert_eq!(Side::Device.got_label(Some(&hex), &crc16(1)), format!("DCount_i 4 {label} PD"));
}

#[rstest]
#[case::none(0b00, "setSD 0 · ChFAckReq 0 · CRC ok", "setSD 0")]
#[case::set_sd(0b10, "setSD 1 · ChFAckReq 0 · CRC ok", "setSD 1")]
#[case::ch_f_ack_req(0b01, "setSD 0 · ChFAckReq 1 · CRC ok", "setSD 0 ChFAckReq")]
#[case::reserved(0b1_0000, "setSD 0 · ChFAckReq 0 · reserved bits 00010000 · CRC ok", "setSD 0")]
fn every_bit_of_the_control_octet_has_its_name(#[case] bits: u8, #[case] told: &str, #[case] label: &str) {
    let hex = signed([0x5A, 0x01, 3 << 5 | bits]);
    let says = format!("PDout 5A · PortNum 1 · MCount 3 · {told}");
    assert_eq!(Side::Device.sent(Some(&hex), &crc16(1)), says);
    assert_eq!(Side::Device.sent_label(Some(&hex), &crc16(1)), format!("MCount 3 {label} PD"));
}

#[test]
fn an_fs_master_presents_what_an_fs_device_is_sent() {
    assert_eq!(Side::Master.got(Some("5A01205727"), &crc16(1)), Side::Device.sent(Some("5A01205727"), &crc16(1)));
    assert_eq!(Side::Master.sent(Some("A5FEC41933"), &crc16(1)), Side::Device.got(Some("A5FEC41933"), &crc16(1)));
    assert_eq!(Side::of("master"), Side::Master);
}

#[rstest]
#[case::crc16(ProtMode::Crc16, "crc16", 4)]
#[case::crc32(ProtMode::Crc32, "crc32", 8)]
fn the_reading_of_the_start_value_decides_whether_a_signature_is_ok(
    #[case] mode: ProtMode,
    #[case] name: &str,
    #[case] digits: usize,
) {
    let secured = [0x5A, 0x11, 0x01, 0x20];
    let hex = format!("5A110120{:0digits$X}", signature(mode, Reading::LeadingOctet, &secured));
    let preset = VariantInfo { mode: name.into(), ..crc16(2) };
    let leading = VariantInfo { leading_octet: true, ..preset.clone() };
    assert!(
        Side::Device
            .sent(Some(&hex), &leading)
            .ends_with("PDout 5A 11 · PortNum 1 · MCount 1 · setSD 0 · ChFAckReq 0 · CRC ok")
    );
    assert!(Side::Device.sent(Some(&hex), &preset).contains("CRC wrong"));
}

#[rstest]
#[case::safe_data(Some("0001029D56"), "MCount 0 setSD 1 SD")]
#[case::process_data(Some("5A01205727"), "MCount 1 setSD 0 PD")]
#[case::falsified(Some("5A01205726"), "MCount 1 setSD 0 PD CRC wrong")]
#[case::zero(Some("0000000000"), "all zero")]
#[case::short(Some("5A01"), "2 octets, not 5")]
#[case::lost(None, "lost")]
fn short_labels_for_charts(#[case] hex: Option<&str>, #[case] says: &str) {
    assert_eq!(Side::Device.sent_label(hex, &crc16(1)), says);
}
