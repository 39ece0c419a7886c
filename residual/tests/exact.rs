//! Counts against words written down one by one, and against figures that another program computed.

use fsct_protocol::crc::{crc16, crc32};
use fsct_residual::{
    BIT_ERROR, CRC_16, CRC_32, Code, Properness, Unsuitable, Verdict, Weights, distributions, dual_weights, macwilliams,
};
use proptest::prelude::*;
use rstest::rstest;
use std::collections::BTreeMap;

/// Rp as exact fractions, printed to 31 digits: `crc,octets,p,Rp`.
const PROBABILITIES: &str = include_str!("probabilities.csv");
/// `crc,octets,ones,dual_words,code_words`, nothing where both are 0.
const WEIGHTS: &str = include_str!("weights.csv");

fn of(code: Code, octets: usize) -> Weights {
    distributions(code, &[octets], &|_, _| ()).expect("a length there is").swap_remove(0)
}

fn counts(weights: &Weights) -> Vec<u64> {
    weights.code_weights().iter().map(|count| u64::try_from(count).expect("a small code")).collect()
}

fn code(name: &str) -> Code {
    if name == "crc16" { CRC_16 } else { CRC_32 }
}

/// Rows of a file without its heading, by what stands in the first two columns.
fn by_length(text: &'static str) -> BTreeMap<(&'static str, usize), Vec<Vec<&'static str>>> {
    let mut all = BTreeMap::new();
    for line in text.lines().skip(1) {
        let cells: Vec<&str> = line.split(',').collect();
        let rows: &mut Vec<_> = all.entry((cells[0], cells[1].parse().expect("octets"))).or_default();
        rows.push(cells[2..].to_vec());
    }
    all
}

/// The distribution in the file, dual code and code.
fn written(rows: &[Vec<&str>], octets: usize) -> (Vec<u64>, Vec<String>) {
    let (mut dual, mut words) = (vec![0; 8 * octets + 1], vec!["0".to_owned(); 8 * octets + 1]);
    for row in rows {
        let ones: usize = row[0].parse().expect("ones");
        (dual[ones], words[ones]) = (row[1].parse().expect("a count"), row[2].to_owned());
    }
    (dual, words)
}

/// The weights file where it has the length; enumeration elsewhere. CRC-32 of 31 octets would take a minute here.
fn weights(name: &str, octets: usize) -> Weights {
    match by_length(WEIGHTS).get(&(name, octets)) {
        Some(rows) => Weights::from_dual(code(name), octets, written(rows, octets).0).expect("2^width words"),
        None => of(code(name), octets),
    }
}

/// Code words by their ones, each made by the shift register bit by bit.
fn one_by_one(width: u32, polynomial: u32, octets: usize) -> Vec<u64> {
    let (bits, mut counts) = (8 * octets as u32, vec![0; 8 * octets + 1]);
    for data in 0u32..1 << (bits - width) {
        let mut register = 0u32;
        for bit in (0..bits - width).rev() {
            let out = (register >> (width - 1) ^ data >> bit) & 1;
            register = (register << 1 ^ if out == 1 { polynomial } else { 0 }) & (u32::MAX >> (32 - width));
        }
        counts[(data.count_ones() + register.count_ones()) as usize] += 1;
    }
    counts
}

/// Small enough to be written down one by one.
fn small_code() -> impl Strategy<Value = (u32, u32, usize)> {
    (2u32..=14, any::<u32>(), 1usize..=3)
        .prop_filter("some data, and not too much", |(width, _, octets)| {
            (1..=16).contains(&(8 * *octets as i64 - i64::from(*width)))
        })
        .prop_map(|(width, polynomial, octets)| (width, polynomial & (u32::MAX >> (32 - width)) | 1, octets))
}

proptest! {
    #[test]
    fn counts_are_those_of_the_words_one_by_one((width, polynomial, octets) in small_code()) {
        let code = Code::new(width, polynomial).expect("a code");
        let weights = of(code, octets);
        prop_assert_eq!(counts(&weights), one_by_one(width, polynomial, octets));
        let dual = dual_weights(code, octets).expect("a length");
        prop_assert_eq!(weights.dual_weights(), dual.iter().map(|count| (*count).into()).collect::<Vec<_>>());
    }

    #[test]
    fn macwilliams_leads_there_and_back((width, polynomial, octets) in small_code()) {
        let weights = of(Code::new(width, polynomial).expect("a code"), octets);
        let (words, dual) = (weights.code_weights(), weights.dual_weights());
        prop_assert_eq!(macwilliams(words, weights.bits() - width), dual);
        prop_assert_eq!(macwilliams(dual, width), words);
    }

    #[test]
    fn properness_is_what_a_walk_along_the_curve_shows((width, polynomial, octets) in small_code()) {
        let weights = of(Code::new(width, polynomial).expect("a code"), octets);
        let step = |p: f64| weights.residual(p + 1e-4) - weights.residual(p - 1e-4);
        match weights.properness() {
            Properness::Proper => {
                let falls = (1..4999).map(|number| f64::from(number) * 1e-4).find(|p| step(*p) < -1e-15);
                prop_assert_eq!(falls, None);
            }
            Properness::Falls(p) => prop_assert!(step(p) < 1e-15, "rises at {}", p),
            Properness::Undecided => (),
        }
    }

    #[test]
    fn many_lengths_at_once_are_each_alone(mut lengths in prop::collection::vec(3usize..=40, 1..6)) {
        lengths.dedup();
        let all = distributions(CRC_16, &lengths, &|_, _| ()).expect("lengths");
        let alone: Vec<_> = lengths.iter().map(|octets| of(CRC_16, *octets)).collect();
        prop_assert_eq!(all, alone);
    }
}

#[rstest]
#[case::three_words_of_data("crc16", 3)]
#[case("crc16", 7)]
#[case("crc16", 16)]
#[case("crc32", 6)]
#[case("crc32", 7)]
fn enumeration_gives_the_distributions_of_another_program(#[case] name: &str, #[case] octets: usize) {
    let files = by_length(WEIGHTS);
    let (dual, words) = written(&files[&(name, octets)], octets);
    let weights = of(code(name), octets);
    assert_eq!(weights.dual_weights(), dual.into_iter().map(Into::into).collect::<Vec<_>>());
    assert_eq!(weights.code_weights().iter().map(ToString::to_string).collect::<Vec<_>>(), words);
}

#[test]
fn thirty_one_octets_of_crc_32_follow_from_their_dual_weights() {
    let (dual, words) = written(&by_length(WEIGHTS)[&("crc32", 31)], 31);
    let weights = Weights::from_dual(CRC_32, 31, dual).expect("2^32 words");
    assert_eq!(weights.code_weights().iter().map(ToString::to_string).collect::<Vec<_>>(), words);
    assert_eq!(weights.distance(), (8, &146_644u32.into()));
    assert_eq!(weights.properness(), Properness::Proper);
}

/// The signatures themselves have these distributions, so the polynomials stand in both places.
#[rstest]
#[case(4, |data: &[u8]| crc16(0, data).into(), 2, CRC_16)]
#[case(6, |data: &[u8]| crc32(0, data), 4, CRC_32)]
fn the_signatures_of_spdus_have_these_weights(
    #[case] octets: usize,
    #[case] signature: impl Fn(&[u8]) -> u32,
    #[case] width: usize,
    #[case] code: Code,
) {
    let mut expected = vec![0; 8 * octets + 1];
    for data in 0u32..1 << (8 * (octets - width)) {
        let ones = data.count_ones() + signature(&data.to_be_bytes()[4 + width - octets..]).count_ones();
        expected[ones as usize] += 1;
    }
    assert_eq!(counts(&of(code, octets)), expected);
}

#[test]
fn residual_error_has_twelve_digits() {
    let mut compared = 0;
    for ((name, octets), rows) in by_length(PROBABILITIES) {
        let weights = weights(name, octets);
        for row in rows {
            let (p, exact): (f64, f64) = (row[0].parse().expect("p"), row[1].parse().expect("Rp"));
            let off = (weights.residual(p) - exact) / exact;
            assert!(off.abs() < 1e-12, "{name}, {octets} octets, p = {p}: off by {off:e}");
            compared += 1;
        }
    }
    assert_eq!(compared, 16 * 17, "sixteen lengths, seventeen probabilities each");
}

#[rstest]
#[case("crc16", 5, None)]
#[case("crc16", 6, Some((0.2785, 1.526_120e-5)))]
#[case("crc16", 7, Some((0.2482, 1.526_105e-5)))]
#[case("crc16", 8, Some((0.2577, 1.525_885e-5)))]
#[case("crc16", 9, None)]
#[case("crc16", 17, None)]
#[case("crc32", 5, None)]
#[case("crc32", 6, Some((0.2602, 2.604_614e-10)))]
#[case("crc32", 7, Some((0.2414, 2.419_042e-10)))]
fn where_properness_fails(#[case] name: &str, #[case] octets: usize, #[case] expected: Option<(f64, f64)>) {
    let weights = weights(name, octets);
    let Some((at, highest)) = expected else {
        assert_eq!((weights.properness(), weights.hump()), (Properness::Proper, None));
        return;
    };
    assert!(matches!(weights.properness(), Properness::Falls(_)));
    let hump = weights.hump().expect("it falls from somewhere");
    assert!((hump.at - at).abs() < 1e-4 && (hump.highest / highest - 1.0).abs() < 1e-6, "{hump:?}");
    let (below, above) = (weights.residual(hump.from - 1e-6), weights.residual(hump.from + 1e-6));
    assert!(below < weights.limit() && above > weights.limit(), "{hump:?}");
}

#[test]
fn the_distance_is_that_of_table_d_1() {
    for octets in [3, 4, 5, 6, 7, 8, 11, 12, 13, 16, 17, 79] {
        let expected = match octets {
            3 => 8,
            4..=16 => 6,
            17..=31 => 4,
            _ => 2,
        };
        assert_eq!(of(CRC_16, octets).distance().0, expected, "{octets} octets");
    }
}

#[test]
fn what_is_detected_and_what_is_not_are_all_errors() {
    let weights = of(CRC_16, 7);
    for p in [1e-9, 1e-3, 0.01, 0.3] {
        let wrong = -(56.0 * f64::ln_1p(-p)).exp_m1();
        assert!((weights.detected(p) + weights.residual(p) - wrong).abs() < 1e-15, "p = {p}");
    }
    assert!((weights.detected(1e-9) / 56e-9 - 1.0).abs() < 1e-6);
    assert_eq!(
        (weights.residual(0.0), weights.residual(-0.1).is_nan(), weights.residual(f64::NAN).is_nan()),
        (0.0, true, true)
    );
}

#[rstest]
#[case(1, 1, "a signature has 2 to 32 bits here, not 1")]
#[case(33, 1, "a signature has 2 to 32 bits here, not 33")]
#[case(16, 0x1_4EAB, "polynomial 0x14EAB has more than 16 bits; write it without its highest term")]
#[case(
    16,
    0x4EAA,
    "polynomial 0x4EAA is even: a generator has the term 1; write it with its highest term left out, not reflected"
)]
fn no_code(#[case] width: u32, #[case] polynomial: u32, #[case] sentence: &str) {
    assert_eq!(Code::new(width, polynomial).expect_err("no code").to_string(), sentence);
}

#[rstest]
#[case(2)]
#[case(129)]
#[case(0)]
fn no_length(#[case] octets: usize) {
    let expected = Unsuitable::Length { octets, least: 3, width: 16 };
    assert_eq!(distributions(CRC_16, &[7, octets], &|_, _| ()), Err(expected));
    assert_eq!(dual_weights(CRC_16, octets), Err(expected));
    assert_eq!(Weights::from_dual(CRC_16, octets, vec![1 << 16]), None);
}

/// The longest: counts up to 2^1008, and nothing leaves the range of the sums.
#[test]
fn the_longest_word_is_possible() {
    let weights = of(CRC_16, 128);
    assert_eq!(weights.code_weights().iter().sum::<num_bigint::BigUint>().bits(), 1024 - 16 + 1);
    let half = weights.residual(0.5);
    assert!((half / weights.limit() - 1.0).abs() < 1e-12, "{half:e}");
}

/// The rates are those at the largest bit error probability to be assumed; not so where Rp falls before it.
#[rstest]
#[case("crc16", 7, true)]
#[case("crc32", 31, true)]
#[case("crc16", 79, false)]
fn rates_are_those_of_the_worst_bit_error_probability(#[case] name: &str, #[case] octets: usize, #[case] last: bool) {
    let weights = weights(name, octets);
    let (residual, detected) = (weights.residual(BIT_ERROR), weights.detected(BIT_ERROR));
    for (rate, at_last) in [
        (weights.unmonitored_rate(), residual * 3.6e6),
        (weights.monitored_rate(), residual / detected / 10.0),
        (weights.block_rate(), residual / 24.0),
    ] {
        assert!(
            if last { (rate / at_last - 1.0).abs() < 1e-12 } else { rate > 2.0 * at_last },
            "{rate:e}, {at_last:e}"
        );
    }
}

#[rstest]
#[case("crc16", 7, [Verdict::Holds, Verdict::Holds, Verdict::Broken])]
#[case("crc16", 5, [Verdict::Holds, Verdict::Holds, Verdict::Holds])]
#[case("crc16", 16, [Verdict::Holds, Verdict::Beyond, Verdict::Within])]
#[case("crc16", 17, [Verdict::Beyond, Verdict::Beyond, Verdict::Within])]
#[case("crc32", 31, [Verdict::Holds, Verdict::Within, Verdict::Holds])]
fn statements_beside_what_is(#[case] name: &str, #[case] octets: usize, #[case] expected: [Verdict; 3]) {
    let weights = weights(name, octets);
    let claim = code(name).claim().expect("a code of the standard");
    let properness = claim.of_properness(octets, weights.properness());
    assert_eq!([claim.of_distance(&weights), claim.of_residual(&weights), properness], expected);
}
