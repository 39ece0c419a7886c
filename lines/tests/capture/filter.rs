//! Glitches left out.

use super::tools::{Told, edges, levels, told};
use fsct_adapters::Line;
use fsct_lines::{Edge, Filter, Recording};
use proptest::prelude::*;
use rstest::rstest;

/// A recording from words such as `c1@20`; all lines begin low.
fn recording(words: &str) -> Told {
    let edge = |word: &str| {
        let (line, at) = word.split_once('@').unwrap();
        let (line, level) = line.split_at(1);
        let line = match line {
            "p" => Line::Power,
            "c" => Line::Cq,
            "i" => Line::Iq,
            _ => Line::WakeUp,
        };
        Edge { at: at.parse().unwrap(), line, level: level == "1" }
    };
    Told { levels: levels(false, false, false), edges: words.split_whitespace().map(edge).collect(), end: 1_000 }
}

#[rstest]
#[case::none("c1@10 c0@20", "c1@10 c0@20", 0)]
#[case::one_ns_too_short("c1@10 c0@19", "", 1)]
#[case::low_as_well("c1@10 c0@100 c1@105", "c1@10", 1)]
#[case::bouncing("c1@10 c0@11 c1@13", "c1@13", 1)]
#[case::bouncing_away("c1@10 c0@11 c1@13 c0@14", "", 2)]
#[case::no_width("c1@10 c0@10", "", 1)]
#[case::the_end_cuts_no_pulse("c1@995", "c1@995", 0)]
#[case::the_beginning_is_no_pulse("c1@5 c0@50", "c1@5 c0@50", 0)]
#[case::lines_apart("p1@10 c1@12 i1@14 c0@15 i0@40", "p1@10 i1@14 i0@40", 1)]
#[case::order_kept("c1@10 i1@15 i0@16 c0@30 i1@31", "c1@10 c0@30 i1@31", 1)]
#[case::wake_ups_are_no_pulses("c1@10 w1@12 w1@13 c0@14", "w1@12 w1@13", 1)]
fn pulses_shorter_than_10_ns(#[case] words: &str, #[case] expected: &str, #[case] removed: u64) {
    let mut filter = Filter::new(recording(words), 10);
    assert_eq!(told(&mut filter), expected);
    assert_eq!(filter.removed(), removed);
    assert_eq!(filter.stated(), format!("pulses shorter than 10 ns are left out: {removed} so far"));
    assert_eq!((filter.min_ns(), filter.end(), filter.uncertainty_ns()), (10, 1_000, 42));
}

#[test]
fn a_filter_of_0_ns_leaves_out_nothing() {
    let words = "c1@10 c0@10 p1@10";
    assert_eq!(told(&mut Filter::new(recording(words), 0)), words);
}

#[test]
fn what_waits_is_bounded() {
    let words: String = (0..2_000).map(|at| format!("w1@{at} ")).collect();
    let (_, error) = edges(&mut Filter::new(recording(&format!("c1@0 {words}")), 5_000));
    assert_eq!(error.unwrap().what, "there are more than 1024 wake-ups within 5000 ns at 1023 ns");
}

/// Edges that change a level, and wake-ups.
pub fn any_edges() -> impl Strategy<Value = Told> {
    prop::collection::vec((0_u64..30, 0_usize..4), 0..60).prop_map(|steps| {
        let mut now = [false; 4];
        let mut at = 0;
        let edges = steps.into_iter().map(|(after, line)| {
            at += after;
            now[line] = !now[line] || line == 3;
            Edge { at, line: Line::ALL[line].0, level: now[line] }
        });
        let edges = edges.collect();
        Told { levels: levels(false, false, false), edges, end: at + 5 }
    })
}

/// All edges at once, line by line.
fn obvious(told: &Told, min_ns: u64) -> Vec<Edge> {
    let mut kept: Vec<(usize, Edge)> = Vec::new();
    for (line, _, _) in Line::ALL {
        let mut of_line: Vec<(usize, Edge)> = Vec::new();
        for (place, edge) in told.edges.iter().enumerate().filter(|(_, edge)| edge.line == line) {
            match of_line.last() {
                Some((_, before)) if line != Line::WakeUp && edge.at - before.at < min_ns => drop(of_line.pop()),
                _ => of_line.push((place, *edge)),
            }
        }
        kept.extend(of_line);
    }
    kept.sort_by_key(|(place, _)| *place);
    kept.into_iter().map(|(_, edge)| edge).collect()
}

proptest! {
    #[test]
    fn a_stream_is_filtered_as_a_whole_is(recording in any_edges(), min_ns in 0_u64..60) {
        let mut filter = Filter::new(recording.clone(), min_ns);
        let (filtered, error) = edges(&mut filter);
        prop_assert_eq!(error, None);
        prop_assert_eq!(&filtered, &obvious(&recording, min_ns));
        prop_assert_eq!(filter.removed() as usize * 2, recording.edges.len() - filtered.len());
    }
}
