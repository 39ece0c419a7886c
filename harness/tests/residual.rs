//! `fsct crc --residual` as a user runs it.

mod cli;

use cli::{Folder, fsct};
use rstest::rstest;
use serde_json::Value;

/// Rp of another program, exact fractions: `crc,octets,p,Rp`.
const PROBABILITIES: &str = include_str!("../../residual/tests/probabilities.csv");

fn json(args: &[&str]) -> Value {
    let run = fsct(&[&["crc", "--residual", "--json"], args].concat());
    assert_eq!(run.code, 0, "{run:?}");
    serde_json::from_str(&run.out).expect("JSON")
}

#[test]
fn the_table_of_crc_16() {
    let run = fsct(&["crc", "--residual", "--mode", "crc16"]);
    assert_eq!(run.code, 0, "{run:?}");
    insta::assert_snapshot!(run.out);
}

#[test]
fn any_other_code_has_no_statements_to_hold() {
    let run = fsct(&["crc", "--residual", "--polynomial", "07", "--width", "8", "--octets", "2..4,12"]);
    assert_eq!(run.code, 0, "{run:?}");
    insta::assert_snapshot!(run.out);
}

#[rstest]
#[case("crc16", "3..8,11,12,16..18,79", 12)]
#[case("crc32", "5..7", 3)]
fn probabilities_have_twelve_digits(#[case] mode: &str, #[case] octets: &str, #[case] count: usize) {
    let all = json(&["--mode", mode, "--octets", octets]);
    let lengths = all["codes"][0]["lengths"].as_array().expect("lengths");
    assert_eq!(lengths.len(), count);
    for length in lengths {
        for told in length["residual"].as_array().expect("probabilities") {
            let (p, found) = (told[0].as_f64().expect("p"), told[1].as_f64().expect("Rp"));
            let begins = |line: &&str| {
                let cells: Vec<&str> = line.split(',').collect();
                cells[0] == mode
                    && cells[1].parse() == Ok(length["octets"].as_u64().expect("a number"))
                    && cells[2].parse() == Ok(p)
            };
            let line = PROBABILITIES.lines().find(begins).unwrap_or_else(|| panic!("{} at {p}", length["octets"]));
            let exact: f64 = line.rsplit(',').next().and_then(|cell| cell.parse().ok()).expect("Rp");
            assert!((found / exact - 1.0).abs() < 1e-12, "{line}: {found:e}");
        }
    }
}

#[test]
fn what_the_standard_states_is_told_apart_from_what_is() {
    let all = json(&["--mode", "crc16", "--octets", "7,8"]);
    let lengths = &all["codes"][0]["lengths"];
    let verdicts = |at: usize| {
        ["distance", "residual", "proper"].map(|of| lengths[at]["verdicts"][of].as_str().expect("a verdict"))
    };
    assert_eq!(verdicts(0), ["holds", "holds", "stated, but false"]);
    assert_eq!(verdicts(1), ["holds", "not stated, not so", "not stated, not so"]);
    assert_eq!(lengths[0]["ones_code_words_dual_words"][1], serde_json::json!([6, "1155", "0"]));
}

#[test]
fn a_drawing_holds_curves_and_bounds_and_fetches_nothing() {
    let folder = Folder::new("residual-svg");
    let file = folder.file("plot.svg", "");
    let run = fsct(&["crc", "--residual", "--mode", "crc16", "--octets", "4..7", "--svg", &file]);
    assert_eq!(run.code, 0, "{run:?}");
    let drawn = folder.text("plot.svg");
    assert_eq!(drawn.matches("class=\"curve\"").count(), 4);
    assert_eq!(drawn.matches("class=\"mark\"").count(), 2, "6 and 7 octets are not proper");
    for bound in [">2^-16<", ">D.2: below 9E-10 up to 7 octets<", "prefers-color-scheme: dark"] {
        assert!(drawn.contains(bound), "{bound}");
    }
    let foreign = drawn.replace("xmlns=\"http://www.w3.org/2000/svg\"", "");
    assert!(!["http", "url(", "href", "@import", "<script"].iter().any(|outside| foreign.contains(outside)));
}

#[rstest]
#[case(&["--octets", "4..7"], "a word has 5 to 128 octets with a signature of 32 bits")]
#[case(&["--octets", "0"], "1 to 128 octets are meant")]
#[case(&["--octets", "7..4"], "1 to 128 octets are meant")]
#[case(&["--octets", "1..99999999999999999999"], "1 to 128 octets are meant")]
#[case(&["--polynomial", "07"], "--width <BITS>")]
#[case(&["--polynomial", "+7", "--width", "8"], "up to eight hexadecimal digits")]
#[case(&["--polynomial", "4EAA", "--width", "16"], "is even")]
#[case(&["--polynomial", "4EAB", "--width", "8"], "has more than 8 bits")]
#[case(&["--polynomial", "1", "--width", "64"], "2 to 32 bits")]
#[case(&["00"], "cannot be used with")]
#[case(&["--block"], "cannot be used with")]
fn what_makes_no_sense_is_wrong_usage(#[case] args: &[&str], #[case] sentence: &str) {
    let run = fsct(&[&["crc", "--residual"], args].concat());
    assert_eq!((run.code, run.out.as_str()), (2, ""), "{run:?}");
    assert!(run.err.contains(sentence), "{}", run.err);
}

#[test]
fn a_drawing_that_cannot_be_written_is_told() {
    let folder = Folder::new("residual-no-svg");
    let run = fsct(&["crc", "--residual", "--mode", "crc16", "--svg", &format!("{}/no/plot.svg", folder.out())]);
    assert_eq!(run.code, 3, "{run:?}");
    assert!(run.err.contains("plot.svg cannot be written"), "{}", run.err);
}
