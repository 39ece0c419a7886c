//! What is written is what is read.

use super::filter::any_edges;
use super::tools::{Told, edges, levels, opened};
use fsct_adapters::Line;
use fsct_lines::{Edge, Levels, Recording, VcdWriter};
use proptest::prelude::*;
use std::io::ErrorKind;

/// A recording as VCD.
pub fn written(recording: &Told) -> Vec<u8> {
    let mut file = Vec::new();
    let mut writer = VcdWriter::new(&mut file, recording).unwrap();
    for edge in &recording.edges {
        writer.edge(edge).unwrap();
    }
    writer.finish(recording.end).unwrap();
    file
}

proptest! {
    #[test]
    fn a_dump_is_read_back(recording in any_edges()) {
        let file = written(&recording);
        let mut capture = opened(&file, "", "").unwrap();
        let (read, error) = edges(&mut capture);
        prop_assert_eq!(error, None);
        prop_assert_eq!(read, Vec::from(recording.edges.clone()));
        prop_assert_eq!(capture.levels(), recording.levels());
        prop_assert_eq!(capture.end(), recording.end);
        prop_assert_eq!(capture.uncertainty_ns(), recording.uncertainty_ns());
    }
}

#[test]
fn a_dump_has_a_tick_of_1_ns_and_no_date() {
    let edges = [Edge { at: 7, line: Line::Iq, level: true }, Edge { at: 7, line: Line::WakeUp, level: true }];
    let levels = Levels { power: Some(true), cq: None, iq: Some(false) };
    let file = written(&Told { levels, edges: edges.into(), end: 20 });
    let expected = "$version\n    fsct\n$end\n$comment\n    edges may be off by at most 42 ns\n$end\n$timescale 1 ns $end\n\
                    $scope module port $end\n$var wire 1 ! L+ $end\n$var wire 1 \" I/Q $end\n$var event 1 # wake-up $end\n\
                    $upscope $end\n$enddefinitions $end\n#0\n$dumpvars\n1!\n0\"\n$end\n#7\n1\"\n1#\n#20\n";
    assert_eq!(String::from_utf8(file).unwrap(), expected);
}

#[test]
fn edges_that_cannot_be_are_refused() {
    let recording = Told { levels: Levels { cq: None, ..levels(true, false, true) }, edges: [].into(), end: 0 };
    let mut writer = VcdWriter::new(Vec::new(), &recording).unwrap();
    let edge = |at, line| Edge { at, line, level: true };
    assert_eq!(writer.edge(&edge(5, Line::Cq)).unwrap_err().kind(), ErrorKind::InvalidInput);
    writer.edge(&edge(5, Line::Iq)).unwrap();
    assert_eq!(writer.edge(&edge(4, Line::Iq)).unwrap_err().to_string(), "4 ns is earlier than 5 ns");
    assert_eq!(writer.finish(4).unwrap_err().kind(), ErrorKind::InvalidInput);
}
