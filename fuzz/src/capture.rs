//! Files that are recordings, or nearly. This file uses no more than `fsct_lines` and `zip`, for `lines/tests/corpus.rs`
//! includes it.

use fsct_lines::capture::{Capture, Options};
use fsct_lines::{Filter, Recording, RecordingError};
use std::io::{Cursor, Write as _};

/// What a sentence may be long at most: it shows some names of channels.
const MAX_SENTENCE: usize = 4_096;
/// Pulses that the filter leaves out.
const MIN_NS: u64 = 1_000;

/// The input is a file. One that begins with `[` is the metadata of a session of sigrok and, behind an octet 0, its samples in
/// two chunks, for a fuzzer does not come by a checksum.
///
/// # Panics
/// When edges come out of order or behind the end, do not change a level, or when an error is a long story.
pub fn capture(input: &[u8]) {
    let file = if input.starts_with(b"[") { session(input) } else { input.to_vec() };
    if let Some(capture) = opened(&file) {
        follow(capture);
    }
    if let Some(capture) = opened(&file) {
        follow(Filter::new(capture, MIN_NS));
    }
}

fn opened(file: &[u8]) -> Option<Capture> {
    match Capture::from_source(Cursor::new(file.to_vec()), &Options::default()) {
        Ok(capture) => {
            assert!(capture.stated().len() < MAX_SENTENCE, "{}", capture.stated());
            Some(capture)
        }
        Err(error) => {
            check(&error);
            None
        }
    }
}

fn follow(mut recording: impl Recording) {
    let levels = recording.levels();
    let mut now = [levels.power, levels.cq, levels.iq];
    let mut at = 0;
    loop {
        match recording.next_edge() {
            Ok(Some(edge)) => {
                assert!(at <= edge.at, "{edge:?} comes after {at} ns");
                at = edge.at;
                let place = usize::from(edge.line.number()) - 1;
                if let Some(level) = now.get_mut(place) {
                    assert_eq!(level.replace(edge.level), Some(!edge.level), "{edge:?} changes nothing");
                }
            }
            Ok(None) => break,
            Err(error) => return check(&error),
        }
    }
    assert!(at <= recording.end(), "an edge at {at} ns of {} ns", recording.end());
}

fn check(error: &RecordingError) {
    assert!(!error.what.is_empty() && error.what.len() < MAX_SENTENCE, "{}", error.what);
    assert!(!error.what.chars().any(char::is_control), "{:?}", error.what);
}

fn session(input: &[u8]) -> Vec<u8> {
    let end = input.iter().position(|octet| *octet == 0).unwrap_or(input.len());
    let (metadata, samples) = (&input[..end], input.get(end + 1..).unwrap_or_default());
    let (first, second) = samples.split_at(samples.len() / 2);
    let mut archive = zip::ZipWriter::new(Cursor::new(Vec::new()));
    for (name, octets) in [("metadata", metadata), ("logic-1-1", first), ("logic-1-2", second)] {
        archive.start_file(name, zip::write::SimpleFileOptions::default()).expect("the name is sound");
        archive.write_all(octets).expect("there is memory");
    }
    archive.finish().expect("there is memory").into_inner()
}
