//! Recordings for tests, and what is in one.

use fsct_adapters::Line;
use fsct_lines::capture::{Capture, Options};
use fsct_lines::{Edge, Levels, Recording, RecordingError};
use std::collections::VecDeque;
use std::io::{Cursor, Write};
use zip::write::SimpleFileOptions;

/// All edges of a recording, and the error it ends with.
pub fn edges(recording: &mut impl Recording) -> (Vec<Edge>, Option<RecordingError>) {
    let mut edges = Vec::new();
    loop {
        match recording.next_edge() {
            Ok(Some(edge)) => edges.push(edge),
            Ok(None) => return (edges, None),
            Err(error) => return (edges, Some(error)),
        }
    }
}

/// The edges of a file that is sound, with letters for the lines: `p1@20` is L+ high at 20 ns.
pub fn told(recording: &mut impl Recording) -> String {
    let (edges, error) = edges(recording);
    assert_eq!(error, None);
    let words: Vec<_> = edges
        .iter()
        .map(|edge| {
            let line = match edge.line {
                Line::Power => 'p',
                Line::Cq => 'c',
                Line::Iq => 'i',
                Line::WakeUp => 'w',
            };
            format!("{line}{}@{}", u8::from(edge.level), edge.at)
        })
        .collect();
    words.join(" ")
}

/// A file with these mappings, such as `C/Q=D1`, and this sample rate, such as `24 MHz`.
pub fn opened(octets: &[u8], channels: &str, rate: &str) -> Result<Capture, RecordingError> {
    let channels = if channels.is_empty() { Ok(Default::default()) } else { channels.parse() };
    let sample_rate = if rate.is_empty() { None } else { Some(rate.parse()?) };
    Capture::from_source(Cursor::new(octets.to_vec()), &Options { channels: channels?, sample_rate })
}

/// The sentence with which a file is refused, at its beginning or later.
pub fn refused(octets: &[u8], channels: &str) -> String {
    match opened(octets, channels, "") {
        Err(error) => error.what,
        Ok(mut capture) => edges(&mut capture).1.expect("it is not refused").what,
    }
}

/// Levels of L+, C/Q and I/Q.
pub fn levels(power: bool, cq: bool, iq: bool) -> Levels {
    Levels { power: Some(power), cq: Some(cq), iq: Some(iq) }
}

/// A recording that is told.
#[derive(Clone, Debug)]
pub struct Told {
    pub levels: Levels,
    pub edges: VecDeque<Edge>,
    pub end: u64,
}

impl Recording for Told {
    fn levels(&self) -> Levels {
        self.levels
    }

    fn uncertainty_ns(&self) -> u64 {
        42
    }

    fn next_edge(&mut self) -> Result<Option<Edge>, RecordingError> {
        Ok(self.edges.pop_front())
    }

    fn end(&self) -> u64 {
        self.end
    }
}

/// A zip archive of these files.
pub fn zip(files: &[(&str, &[u8])]) -> Vec<u8> {
    let mut archive = zip::ZipWriter::new(Cursor::new(Vec::new()));
    for (name, octets) in files {
        archive.start_file(*name, SimpleFileOptions::default()).unwrap();
        archive.write_all(octets).unwrap();
    }
    archive.finish().unwrap().into_inner()
}
