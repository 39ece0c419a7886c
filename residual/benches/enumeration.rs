//! How long the dual code of CRC-32 takes, all SPDU lengths in one pass: `cargo bench -p fsct-residual`.
//!
//! Fails when a count differs from those that another program found, for the tests are too slow a build to do this.

use fsct_residual::{CRC_32, distributions};
use std::time::Instant;

/// `crc,octets,ones,dual_words,code_words`.
const WEIGHTS: &str = include_str!("../tests/weights.csv");

fn main() {
    let lengths: Vec<usize> = (5..=32).collect();
    let begun = Instant::now();
    let found = distributions(CRC_32, &lengths, &|_, _| ()).expect("lengths there are");
    println!("CRC-32, {} lengths from 5 to 32 octets: {:.1} s", lengths.len(), begun.elapsed().as_secs_f64());
    let mut compared = 0;
    for line in WEIGHTS.lines().filter(|line| line.starts_with("crc32,")) {
        let cells: Vec<&str> = line.split(',').collect();
        let [octets, ones] = [1, 2].map(|cell: usize| cells[cell].parse::<usize>().expect("a number"));
        let weights = found.iter().find(|weights| weights.octets() == octets).expect("a length that was counted");
        let counted = [&weights.dual_weights()[ones], &weights.code_weights()[ones]].map(ToString::to_string);
        assert_eq!(counted, [cells[3], cells[4]], "{octets} octets, {ones} ones");
        compared += 1;
    }
    assert!(compared > 200, "only {compared} counts were compared");
    println!("{compared} counts are those of another program");
}
