//! The octet codecs: tables, round trips, an independent signature, and every small corruption.

use fsct_protocol::crc::{Reading, crc16, crc32, signature};
use fsct_protocol::fsp::{Authenticity, IoStructure, IoTotals, Protocol, RecordError, VerifyRecord, param_desc_crc};
use fsct_protocol::spdu::{Control, OutSpdu, Pd, Port, Status, View, Wire, inv3, succ};
use fsct_protocol::{Edition, ProtMode};
use proptest::prelude::*;
use rstest::rstest;

/// One bit at a time, as Figures D.3 and D.5 draw it.
fn bitwise(width: u32, generator: u64, start: u64, octets: &[u8]) -> u64 {
    let mut register = start;
    for octet in octets {
        for bit in (0..8).rev() {
            register = register << 1 ^ u64::from(octet >> bit & 1) << width;
            if register >> width & 1 == 1 {
                register ^= generator;
            }
        }
    }
    register
}

fn mode() -> impl Strategy<Value = ProtMode> {
    prop_oneof![Just(ProtMode::Crc16), Just(ProtMode::Crc32)]
}

proptest! {
    #[test]
    fn signatures_agree_with_a_bitwise_register(seed in any::<u32>(), octets in prop::collection::vec(any::<u8>(), 0..80)) {
        let start = u64::from(seed as u16);
        prop_assert_eq!(u64::from(crc16(seed as u16, &octets)), bitwise(16, 0x1_4EAB, start, &octets));
        prop_assert_eq!(u64::from(crc32(seed, &octets)), bitwise(32, 0x1_F4AC_FB13, seed.into(), &octets));
    }

    #[test]
    fn every_reading_of_the_start_value_is_what_it_says(octets in prop::collection::vec(any::<u8>(), 2..27)) {
        let one = |value: u64| if value == 0 { 1 } else { value };
        let led = [&[1], octets.as_slice()].concat();
        let fed = |zeros: usize| [octets.as_slice(), &vec![0; zeros]].concat();
        for (mode, width, generator, zeros) in [(ProtMode::Crc16, 16, 0x1_4EAB, 2), (ProtMode::Crc32, 32, 0x1_F4AC_FB13, 4)] {
            let of = |reading| u64::from(signature(mode, reading, &octets));
            prop_assert_eq!(of(Reading::Preset), one(bitwise(width, generator, 1, &octets)));
            prop_assert_eq!(of(Reading::LeadingOctet), one(bitwise(width, generator, 0, &led)));
            prop_assert_eq!(of(Reading::FieldFed), one(bitwise(width, generator, 1, &fed(zeros))));
        }
    }

    #[test]
    fn no_octets_make_the_codecs_panic(octets in prop::collection::vec(any::<u8>(), 0..64), mode in mode(), pd in 0usize..40) {
        if let Ok(view) = View::new(&octets, mode, pd) {
            prop_assert_eq!(view.pd().len(), pd);
            let _ = (view.control(), view.status(), view.is_all_zero(), view.signature_matches(Reading::Preset));
        } else {
            prop_assert!(octets.len() < mode.spdu_octets(pd));
        }
        let _ = (Authenticity::from_octets(&octets), Protocol::from_octets(&octets), VerifyRecord::from_octets(&octets));
        let _ = (VerifyRecord::split(&octets).is_ok(), Pd::new(&octets));
    }

    #[test]
    fn what_is_sent_is_what_is_read(mode in mode(), data in prop::collection::vec(any::<u8>(), 0..26), port_num in any::<u8>(), octet in any::<u8>()) {
        let data = &data[..data.len().min(mode.max_pd())];
        let wire = Wire { pd: Pd::new(data).expect("at most 25"), port_num, octet, signature: None };
        let emitted = wire.emit(mode, Reading::Preset);
        prop_assert_eq!(emitted.octets().len(), mode.spdu_octets(data.len()));
        let view = View::new(emitted.octets(), mode, data.len()).expect("it is long enough");
        prop_assert_eq!((view.pd(), view.port_num(), view.octet()), (data, port_num, octet));
        prop_assert!(view.signature_matches(Reading::Preset));
        prop_assert!(view.signature() != 0);
    }

    #[test]
    fn records_read_back_and_every_falsified_bit_is_found(a in any::<u32>(), b in any::<u32>(), port in any::<u8>(), watchdog_ms in any::<u16>(), io in any::<u16>(), tech in any::<u32>(), bit in 0usize..184) {
        let record = VerifyRecord {
            authenticity: Authenticity { authenticity_1: a, authenticity_2: b, port },
            protocol: Protocol { version: 1, mode: 2, watchdog_ms, io_struct_crc: io, tech_par_crc: tech },
        };
        let mut octets = record.to_octets();
        prop_assert_eq!(VerifyRecord::from_octets(&octets), Ok(record));
        octets[bit / 8] ^= 0x80 >> (bit % 8);
        let found = matches!(VerifyRecord::from_octets(&octets), Err(RecordError::Signature { .. }));
        prop_assert!(found);
    }
}

#[rstest]
#[case(0, 7, 1)]
#[case(1, 6, 2)]
#[case(2, 5, 3)]
#[case(3, 4, 4)]
#[case(4, 3, 5)]
#[case(5, 2, 6)]
#[case(6, 1, 7)]
#[case(7, 0, 1)]
fn counters_of_table_33(#[case] mcount: u8, #[case] dcount_i: u8, #[case] next: u8) {
    assert_eq!((inv3(mcount), succ(mcount)), (dcount_i, next));
}

#[rstest]
#[case(Control { mcount: 0, set_sd: true, ch_f_ack_req: false }, 0x02)]
#[case(Control { mcount: 5, set_sd: false, ch_f_ack_req: false }, 0xA0)]
#[case(Control { mcount: 7, set_sd: true, ch_f_ack_req: true }, 0xE3)]
#[case(Control { mcount: 1, set_sd: false, ch_f_ack_req: true }, 0x21)]
fn control_octets_of_table_31(#[case] control: Control, #[case] octet: u8) {
    assert_eq!((control.to_octet(), Control::from_octet(octet)), (octet, control));
    assert_eq!(Control::from_octet(octet | 0b1_1100), control, "reserved bits are not looked at");
}

#[rstest]
#[case(Status { dcount_i: 7, sd_set: true, d_comm_err: false, d_timeout: false }, 0xE4)]
#[case(Status { dcount_i: 3, sd_set: true, d_comm_err: true, d_timeout: false }, 0x66)]
#[case(Status { dcount_i: 0, sd_set: true, d_comm_err: true, d_timeout: true }, 0x07)]
#[case(Status { dcount_i: 4, sd_set: false, d_comm_err: false, d_timeout: true }, 0x81)]
fn status_octets_of_table_32(#[case] status: Status, #[case] octet: u8) {
    assert_eq!((status.to_octet(), Status::from_octet(octet)), (octet, status));
    assert_eq!(Status::from_octet(octet | 0b1_1000), status, "reserved bits are not looked at");
}

#[rstest]
#[case(ProtMode::Crc16, &[0x5A], 3)]
#[case(ProtMode::Crc32, &[0x5A], 2)]
fn every_small_corruption_is_found(#[case] mode: ProtMode, #[case] pd: &[u8], #[case] most: usize) {
    let spdu = OutSpdu {
        pd: Pd::new(pd).expect("it fits"),
        port: Port::ONE,
        control: Control { mcount: 3, set_sd: false, ch_f_ack_req: false },
    };
    let sent = spdu.wire().emit(mode, Reading::Preset);
    let bits = 8 * sent.octets().len();
    let mut patterns: Vec<Vec<usize>> = (0..bits).map(|bit| vec![bit]).collect();
    let mut from = 0;
    for _ in 1..most {
        let upto = patterns.len();
        for index in from..upto {
            let last = patterns[index].last().copied().unwrap_or(0);
            let more = (last + 1..bits).map(|bit| [patterns[index].as_slice(), &[bit]].concat()).collect::<Vec<_>>();
            patterns.extend(more);
        }
        from = upto;
    }
    for pattern in patterns {
        let mut octets = sent;
        pattern.iter().for_each(|bit| octets.octets_mut()[bit / 8] ^= 0x80 >> (bit % 8));
        let view = View::new(octets.octets(), mode, pd.len()).expect("as long as before");
        assert!(!view.signature_matches(Reading::Preset), "{pattern:?}");
    }
}

/// The known blocks: authenticity, protocol, FSP_AuthentCRC, FSP_ProtParCRC.
#[rstest]
#[case::defaults((0, 0, 0), (2, 100, 0x9A28, 0), 0x0000, 0xFBB8)]
#[case::test_mode((0x1122_3344, 0x5566_7788, 1), (2, 100, 0x9A28, 0), 0x6484, 0xFBB8)]
#[case::armed((0x1122_3344, 0x5566_7788, 1), (2, 100, 0x9A28, 0x34FA_2C43), 0x6484, 0x86A8)]
#[case::crc_16((0x1122_3344, 0, 2), (1, 100, 0x13FB, 0x3AF2), 0x2CC5, 0x43C1)]
#[case::limits((0x1122_3344, 0x5566_7788, 1), (2, 0xFFFF, 0x9A28, 0xFFFF_FFFF), 0x6484, 0xB37A)]
#[case::signatures_of_0((0xD3AF, 0, 1), (2, 100, 0x9A28, 0x086C), 0x0000, 0x0000)]
fn signatures_of_known_blocks(
    #[case] (authenticity_1, authenticity_2, port): (u32, u32, u8),
    #[case] (mode, watchdog_ms, io_struct_crc, tech_par_crc): (u8, u16, u16, u32),
    #[case] authent: u16,
    #[case] prot_par: u16,
) {
    assert_eq!(Authenticity { authenticity_1, authenticity_2, port }.signature(), authent);
    assert_eq!(Protocol { version: 1, mode, watchdog_ms, io_struct_crc, tech_par_crc }.signature(), prot_par);
}

#[test]
fn names_read_back() {
    for edition in Edition::ALL {
        assert_eq!(edition.name().parse(), Ok(edition));
    }
    for mode in ProtMode::ALL {
        assert_eq!(mode.name().parse(), Ok(mode));
        assert_eq!(ProtMode::from_code(mode.code()), Some(mode));
    }
    assert_eq!((Edition::V1_1.to_string(), ProtMode::Crc32.to_string()), ("v1.1".into(), "crc32".into()));
    let unknown = "crc8".parse::<ProtMode>().map_err(|unknown| unknown.to_string());
    assert_eq!(unknown, Err("unknown name".into()));
    assert!("v1.2".parse::<Edition>().is_err() && ProtMode::from_code(0xF9).is_none());
}

#[test]
fn so_much_process_data_fits() {
    assert_eq!((ProtMode::Crc16.max_pd(), ProtMode::Crc32.max_pd()), (3, 25));
    assert_eq!((Pd::safe(25).octets().len(), Pd::safe(26).octets().len()), (25, 25));
    assert!(Pd::new(&[1; 25]).is_some() && Pd::new(&[1; 26]).is_none());
}

#[test]
fn safe_data_are_all_0() {
    let pd = |octets: &[u8]| Pd::new(octets).expect("it fits");
    assert!(Pd::safe(2).is_safe() && pd(&[0, 0]).is_safe() && pd(&[]).is_safe());
    assert!(!pd(&[0, 1]).is_safe());
    assert_eq!(format!("{:?}", pd(&[0x0A, 0xB0])), "0AB0");
}

#[test]
fn the_fs_device_sends_the_port_number_inverted() {
    let port = Port::new(5).expect("not 0");
    assert_eq!((port.number(), port.inverted(), Port::new(0)), (5, 0xFA, None));
}

#[test]
fn an_spdu_of_all_zero_is_one_in_every_octet() {
    let zero = [0; 6];
    assert!(View::new(&zero, ProtMode::Crc16, 2).expect("six octets").is_all_zero());
    for at in 0..6 {
        let mut octets = zero;
        octets[at] = 1;
        assert!(!View::new(&octets, ProtMode::Crc16, 2).expect("six octets").is_all_zero(), "octet {at}");
    }
}

#[test]
fn fields_of_a_view() {
    let view = View::new(&[0x5A, 0xFE, 0xA2, 0x12, 0x34], ProtMode::Crc16, 1).expect("five octets");
    assert_eq!((view.counter(), view.signature()), (5, 0x1234));
    let wire = Wire { pd: Pd::safe(0), port_num: 0xFE, octet: 0xA2, signature: Some(0x1234) };
    assert_eq!(format!("{:?}", wire.emit(ProtMode::Crc16, Reading::Preset)), "FEA21234");
    let short = View::new(&[1; 5], ProtMode::Crc16, 2).expect_err("one too few");
    assert_eq!(short.to_string(), "an SPDU of 6 octets was expected, 5 are there");
}

/// Figure A.1 and the sample IODD of E.5.8.
#[rstest]
#[case((10, 13, 2, 1), 6, 0x9A28)]
#[case((8, 13, 2, 1), 4, 0x13FB)]
fn signatures_of_known_io_structures(
    #[case] (range, bits, octets, int16): (u8, u8, u8, u8),
    #[case] output: u8,
    #[case] crc: u16,
) {
    let input = IoTotals { range, bits, octets, int16, int32: 0 };
    let output = IoTotals { range: output, ..IoTotals::default() };
    assert_eq!(IoStructure { version: 1, input, output }.signature(), crc);
}

#[test]
fn a_parameter_description_has_the_signature_of_its_edition() {
    let text = b"FST_";
    assert_eq!(u64::from(param_desc_crc(Edition::V1_1, text)), bitwise(16, 0x1_4EAB, 0, text));
    assert_eq!(u64::from(param_desc_crc(Edition::Iec2022, text)), bitwise(32, 0x1_F4AC_FB13, 0, text));
}

#[test]
fn a_wrong_record_says_what_is_wrong() {
    let length = VerifyRecord::from_octets(&[0; 4]).expect_err("too short").to_string();
    assert!(length.ends_with("4 are there"), "{length}");
    let mut octets = VerifyRecord {
        authenticity: Authenticity { authenticity_1: 0, authenticity_2: 0, port: 0 },
        protocol: Protocol { version: 1, mode: 2, watchdog_ms: 100, io_struct_crc: 0x9A28, tech_par_crc: 0 },
    }
    .to_octets();
    octets[0] = 1;
    let signature = VerifyRecord::from_octets(&octets).expect_err("falsified").to_string();
    assert!(signature.ends_with("0000 was sent"), "{signature}");
}
