//! The known answers against a second implementation, bit by bit, that shares nothing with the codec; and the proof itself,
//! which has to see a falsified answer.

use fsct_vectors::{Crc, Direction, Hex, Vectors, load, parse, prove};
use rstest::rstest;
use std::collections::HashSet;

/// The register of Figures D.3 and D.5, one bit at a time.
fn register(crc: Crc, start: u64, octets: &[u8]) -> u64 {
    let (width, generator) = match crc {
        Crc::Crc16 => (16, 0x1_4EAB),
        Crc::Crc32 => (32, 0x1_F4AC_FB13),
    };
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

fn number(hex: &Hex) -> u64 {
    u64::from(hex.number())
}

fn vectors() -> Vectors {
    load().expect("the file is committed as it was proven")
}

#[test]
fn register_runs_and_printed_values() {
    let vectors = vectors();
    for one in &vectors.raw {
        assert_eq!(register(one.crc, one.seed.into(), &one.data.0), number(&one.signature), "{}", one.id);
    }
    for one in &vectors.printed {
        assert_eq!(register(one.crc, one.seed.into(), &one.data.0), number(&one.signature), "{}", one.id);
    }
}

#[test]
fn blocks_and_parameter_descriptions() {
    let vectors = vectors();
    let secured = |block: &fsct_vectors::Block| Some((block.secured.clone()?, block.signature.clone()?));
    let blocks: Vec<_> = vectors.blocks.iter().filter_map(|block| Some((block, secured(block)?))).collect();
    assert_eq!(blocks.len(), 21);
    for (block, (secured, signature)) in blocks {
        assert_eq!(register(Crc::Crc16, 0, &secured.0), number(&signature), "{}", block.id);
    }
    for one in &vectors.param_desc {
        let crc = if one.edition == "v1.1" { Crc::Crc16 } else { Crc::Crc32 };
        assert_eq!(register(crc, 0, &one.data.0), number(&one.signature), "{}", one.id);
    }
}

#[test]
fn spdus_of_every_section() {
    let vectors = vectors();
    let all = vectors.spdu.iter().chain(&vectors.zero_to_one).chain(&vectors.raw_one);
    let mut seen = 0;
    for one in all {
        let (Some(spdu), Some(fields)) = (&one.spdu, &one.fields) else { continue };
        seen += 1;
        let port = if one.dir == Direction::Out { fields.port } else { 255 - fields.port };
        let octet = match one.dir {
            Direction::Out => fields.mcount.unwrap() * 32 + fields.set_sd.unwrap() * 2 + fields.ch_f_ack_req.unwrap(),
            Direction::In => {
                fields.dcount_i.unwrap() * 32
                    + fields.sd_set.unwrap() * 4
                    + fields.d_comm_err.unwrap() * 2
                    + fields.d_timeout.unwrap()
            }
        };
        let secured = [fields.fs_pd.0.as_slice(), &[port, octet]].concat();
        let raw = register(one.crc, 1, &secured);
        let sent = if raw == 0 { 1 } else { raw };
        let digits = if one.crc == Crc::Crc16 { 6 } else { 4 };
        let expected = [secured.as_slice(), &sent.to_be_bytes()[digits..]].concat();
        assert_eq!(expected, spdu.0, "{}", one.id);
    }
    assert_eq!(seen, 172);
}

#[test]
fn where_no_spdu_with_a_computed_signature_of_0_is_said_to_exist_none_does() {
    let vectors = vectors();
    let statements: Vec<_> = vectors.zero_to_one.iter().filter(|one| one.spdu.is_none()).collect();
    assert_eq!(statements.len(), 6);
    for one in statements {
        let length = one.fs_pd_octets.expect("the size is named");
        let reserved = if one.dir == Direction::Out { 0b0001_1100 } else { 0b0001_1000 };
        // The signature is affine in the data: it is 0 where the data alone reach what the rest leaves.
        let reached: HashSet<u64> = (0..1u32 << (8 * length))
            .map(|data| register(one.crc, 0, &[&data.to_be_bytes()[4 - length..], &[0, 0]].concat()))
            .collect();
        for port in 1..=255u8 {
            let port = if one.dir == Direction::Out { port } else { !port };
            for octet in (0..=255u8).filter(|octet| octet & reserved == 0) {
                let rest = register(one.crc, 1, &[vec![0; length], vec![port, octet]].concat());
                assert!(!reached.contains(&rest), "{} port {port:02X} octet {octet:02X}", one.id);
            }
        }
    }
}

#[rstest]
#[case::raw(|vectors: &mut Vectors| vectors.raw[7].data.0.push(1))]
#[case::printed(|vectors: &mut Vectors| vectors.printed[0].signature.0[1] ^= 1)]
#[case::blocks(|vectors: &mut Vectors| vectors.blocks[9].block.as_mut().unwrap().0[3] ^= 1)]
#[case::param_desc(|vectors: &mut Vectors| vectors.param_desc[2].decimal += 1)]
#[case::spdu(|vectors: &mut Vectors| vectors.spdu[30].fields.as_mut().unwrap().port += 1)]
#[case::sequences(|vectors: &mut Vectors| vectors.sequences[0].messages[5].spdu.0[2] ^= 4)]
#[case::zero_to_one(|vectors: &mut Vectors| *vectors.zero_to_one[2].spdu.as_mut().unwrap().0.last_mut().unwrap() = 0)]
#[case::raw_one(|vectors: &mut Vectors| vectors.raw_one[0].fields.as_mut().unwrap().mcount = Some(1))]
#[case::receive(|vectors: &mut Vectors| vectors.receive[0].spdu.0[0] ^= 1)]
#[case::undetectable(|vectors: &mut Vectors| vectors.undetectable[0].pattern.0[0] ^= 0x81)]
#[case::tables(|vectors: &mut Vectors| vectors.tables.get_mut(&Crc::Crc32).unwrap()[3][1].0[2] ^= 0x10)]
#[case::check_values(|vectors: &mut Vectors| vectors.algorithms.get_mut(&Crc::Crc16).unwrap().check_seed1.0[0] ^= 1)]
fn a_falsified_answer_is_found(#[case] falsify: fn(&mut Vectors)) {
    let mut vectors = vectors();
    assert!(prove(&vectors).is_proven());
    assert_eq!(prove(&vectors).answers(), 354);
    falsify(&mut vectors);
    let score = prove(&vectors);
    let failed: usize = score.sections.iter().chain([&score.tables]).map(|section| section.failed.len()).sum();
    assert_eq!(failed, 1, "{score}");
}

#[test]
fn an_unknown_key_is_an_error() {
    let text = include_str!("../data/crc-vectors.yaml").replacen("decimal: 39464", "decimals: 39464", 1);
    assert!(parse(&text).is_err());
}
