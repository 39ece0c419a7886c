//! Files that `sigrok-cli` writes, and what it makes of ours.

use super::filter::any_edges;
use super::tools::{Told, edges, levels};
use super::vcd_writer::written;
use fsct_adapters::Line;
use fsct_lines::capture::{Capture, Options, open};
use fsct_lines::{Edge, Recording};
use proptest::prelude::*;
use proptest::strategy::ValueTree as _;
use proptest::test_runner::TestRunner;
use rstest::rstest;
use std::path::{Path, PathBuf};
use std::process::Command;

/// A folder of its own, gone afterwards.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Folder {
        let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(format!("{}-{name}", std::process::id()));
        std::fs::create_dir_all(&path).unwrap();
        Folder(path)
    }

    fn file(&self, name: &str) -> String {
        self.0.join(name).display().to_string()
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

fn sigrok(arguments: &[&str]) -> Vec<u8> {
    let output = Command::new("sigrok-cli").args(arguments).output().expect("it was there a moment ago");
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    output.stdout
}

fn read(file: &str, channels: &str) -> Capture {
    let options = Options { channels: channels.parse().unwrap(), sample_rate: None };
    open(Path::new(file), &options).unwrap()
}

const DEMO: &str = "L+=D0,C/Q=D1,I/Q=D2";

/// The same samples as a session, as VCD and as CSV, at rates that are and are not whole nanoseconds.
#[rstest]
#[case("1m", 1_000)]
#[case("24m", 42)]
#[case("3", 333_333_334)]
fn the_same_samples_in_every_format_are_the_same_edges(#[case] rate: &str, #[case] uncertainty: u64) {
    if !fsct_c::there("sigrok-cli") {
        return;
    }
    let folder = Folder::new(&format!("demo-{rate}"));
    let (session, vcd, csv) = (folder.file("x.sr"), folder.file("x.vcd"), folder.file("x.csv"));
    let samples = if rate == "3" { "6" } else { "10000" };
    let config = format!("samplerate={rate}");
    sigrok(&["-d", "demo", "--config", &config, "--samples", samples, "-C", "D0,D1,D2", "-o", &session]);
    sigrok(&["-i", &session, "-O", "vcd", "-o", &vcd]);
    sigrok(&["-i", &session, "-O", "csv", "-o", &csv]);

    let mut expected = read(&session, DEMO);
    let (of_session, error) = edges(&mut expected);
    assert_eq!((error, expected.uncertainty_ns()), (None, uncertainty));
    assert!(of_session.len() >= 6, "{of_session:?}");

    let mut of_csv = read(&csv, DEMO);
    assert_eq!(of_csv.levels(), expected.levels());
    assert_eq!(edges(&mut of_csv), (of_session.clone(), None));
    assert_eq!((of_csv.uncertainty_ns(), of_csv.end()), (uncertainty, expected.end()));

    let mut of_vcd = read(&vcd, DEMO);
    assert_eq!(of_vcd.levels(), expected.levels());
    let (of_vcd_edges, error) = edges(&mut of_vcd);
    assert_eq!((error, of_vcd_edges.len()), (None, of_session.len()));
    let off = of_vcd.uncertainty_ns() - uncertainty;
    for (edge, other) in of_session.iter().zip(&of_vcd_edges) {
        assert_eq!((edge.line, edge.level), (other.line, other.level));
        assert!(edge.at.abs_diff(other.at) <= off.max(1), "{edge:?} {other:?}");
    }
}

/// The samples that sigrok reads itself, one by one.
#[test]
fn every_sample_of_a_session_is_as_sigrok_reads_it() {
    if !fsct_c::there("sigrok-cli") {
        return;
    }
    let folder = Folder::new("bits");
    let session = folder.file("x.sr");
    sigrok(&["-d", "demo", "--config", "samplerate=1m", "--samples", "20000", "-C", "D0,D1,D2", "-o", &session]);
    let samples = sigrok(&["-i", &session, "-O", "binary"]);
    assert_eq!(samples.len(), 20_000);
    let mut capture = read(&session, DEMO);
    let levels = capture.levels();
    let mut now = [levels.power, levels.cq, levels.iq].map(Option::unwrap);
    let (edges, _) = edges(&mut capture);
    let mut edges = edges.into_iter().peekable();
    for (number, sample) in samples.iter().enumerate() {
        while let Some(edge) = edges.next_if(|edge| edge.at == number as u64 * 1_000) {
            let place = Line::ALL.iter().position(|entry| entry.0 == edge.line).unwrap();
            now[place] = edge.level;
        }
        assert_eq!(now, [sample & 1, sample >> 1 & 1, sample >> 2 & 1].map(|bit| bit == 1), "sample {number}");
    }
    assert_eq!(edges.next(), None);
}

fn sigrok_agrees(folder: &Folder, recording: &Told) {
    let (vcd, session) = (folder.file("ours.vcd"), folder.file("ours.sr"));
    std::fs::write(&vcd, written(recording)).unwrap();
    sigrok(&["-I", "vcd", "-i", &vcd, "-o", &session]);
    let options = Options::default();
    let mut capture = open(Path::new(&session), &options).unwrap();
    assert_eq!(capture.levels(), recording.levels());
    // A sample a nanosecond shows no pulse without a width, and no event.
    let mut expected: Vec<Edge> = Vec::new();
    for edge in recording.edges.iter().filter(|edge| edge.line != Line::WakeUp) {
        match expected.iter().rposition(|before| before.line == edge.line && before.at == edge.at) {
            Some(place) => drop(expected.remove(place)),
            None => expected.push(*edge),
        }
    }
    expected.sort_by_key(|edge| (edge.at, edge.line));
    let (read, error) = edges(&mut capture);
    assert_eq!((read, error), (expected, None));
}

#[test]
fn sigrok_reads_what_we_write() {
    if !fsct_c::there("sigrok-cli") {
        return;
    }
    let folder = Folder::new("ours");
    let edge = |at, line, level| Edge { at, line, level };
    let edges = [
        edge(10, Line::Power, true),
        edge(25, Line::Cq, true),
        edge(25, Line::WakeUp, true),
        edge(26, Line::Iq, true),
        edge(500, Line::Cq, false),
    ];
    sigrok_agrees(&folder, &Told { levels: levels(false, false, false), edges: edges.into(), end: 1_000 });
    let mut runner = TestRunner::deterministic();
    for _ in 0..20 {
        let mut recording = any_edges().new_tree(&mut runner).unwrap().current();
        // The levels at time 0 are those of the first sample.
        recording.edges.iter_mut().for_each(|edge| edge.at += 1);
        recording.end += 1;
        sigrok_agrees(&folder, &recording);
    }
}
