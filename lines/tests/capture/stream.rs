//! Files larger than memory, made while they are read.

use super::tools::zip;
use fsct_lines::Recording;
use fsct_lines::capture::{Capture, Options};
use rstest::rstest;
use std::io::{self, Read};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// A text of a header and endless rows, and how much of it was read.
struct Endless {
    row: fn(u64) -> String,
    next: u64,
    ready: Vec<u8>,
    left: u64,
    read: Arc<AtomicU64>,
}

impl Read for Endless {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        if self.ready.is_empty() && self.left > 0 {
            for _ in 0..1_000 {
                self.ready.extend((self.row)(self.next).bytes());
                self.next += 1;
            }
            self.left = self.left.saturating_sub(self.ready.len() as u64);
        }
        let count = self.ready.as_slice().read(into)?;
        self.ready.drain(..count);
        self.read.fetch_add(count as u64, Ordering::Relaxed);
        Ok(count)
    }
}

const VCD: &str =
    "$timescale 1 us $end $scope module m $end $var wire 1 ! CQ $end $upscope $end $enddefinitions $end\n";
const SALEAE: &str = "Time [s],CQ\n";
const SIGROK: &str = "; Channels (1/1): CQ\n; Samplerate: 1 MHz\nlogic\n";

fn vcd_row(number: u64) -> String {
    format!("#{number} {}!\n", number % 2)
}

fn saleae_row(number: u64) -> String {
    format!("{}.{:06},{}\n", number / 1_000_000, number % 1_000_000, number % 2)
}

fn sigrok_row(number: u64) -> String {
    format!("{}\n", number % 2)
}

/// An edge for each row behind the first, and never much more read than told.
fn streams(header: &str, row: fn(u64) -> String, octets: u64) -> u64 {
    let read = Arc::new(AtomicU64::new(0));
    let text = Endless { row, next: 0, ready: header.into(), left: octets, read: Arc::clone(&read) };
    let mut capture = Capture::from_stream(text, &Options::default()).unwrap();
    let mut edges = 0;
    let mut told = header.len() as u64 + row(0).len() as u64;
    while let Some(edge) = capture.next_edge().unwrap() {
        edges += 1;
        assert_eq!((edge.at, edge.level), (edges * 1_000, edges % 2 == 1));
        told += row(edges).len() as u64;
        let ahead = read.load(Ordering::Relaxed).saturating_sub(told);
        assert!(ahead <= 1 << 17, "{ahead} octets are read and not told");
    }
    assert!(read.load(Ordering::Relaxed) >= octets);
    edges
}

#[rstest]
#[case::vcd(VCD, vcd_row)]
#[case::saleae(SALEAE, saleae_row)]
#[case::sigrok(SIGROK, sigrok_row)]
fn no_more_is_read_than_is_told(#[case] header: &str, #[case] row: fn(u64) -> String) {
    assert!(streams(header, row, 1 << 22) > 100_000);
}

#[rstest]
#[case::vcd(VCD, vcd_row)]
#[case::saleae(SALEAE, saleae_row)]
#[case::sigrok(SIGROK, sigrok_row)]
#[ignore = "reads 2 GB"]
fn two_gigabytes_take_no_memory(#[case] header: &str, #[case] row: fn(u64) -> String) {
    streams(header, row, 1 << 31);
    within_memory();
}

/// Samples of a minute at 36 MHz, in an archive of 2 MB.
#[test]
#[ignore = "reads 2 GB"]
fn a_session_of_two_gigabytes_takes_no_memory() {
    let metadata = "[device 1]\ncapturefile=logic-1\nsamplerate=36 MHz\nprobe1=CQ\nunitsize=1\n";
    let chunk = vec![0; 1 << 24];
    let names: Vec<String> = (1..=128).map(|number| format!("logic-1-{number}")).collect();
    let chunks = names.iter().map(|name| (name.as_str(), chunk.as_slice()));
    let files: Vec<_> =
        [("version", b"2".as_slice()), ("metadata", metadata.as_bytes())].into_iter().chain(chunks).collect();
    let file = io::Cursor::new(zip(&files));
    let mut capture = Capture::from_source(file, &Options::default()).unwrap();
    assert_eq!(capture.next_edge(), Ok(None));
    assert_eq!(capture.end(), ((1_u64 << 31) - 1) * 1_000 / 36);
    within_memory();
}

/// No more than 100 MB were ever taken, by all tests of this process.
fn within_memory() {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let most = status.lines().find_map(|line| line.strip_prefix("VmHWM:")).unwrap_or("0 kB");
    let kilobytes: u64 = most.trim().trim_end_matches(" kB").parse().unwrap();
    println!("{kilobytes} kB at most");
    assert!(kilobytes < 100_000, "{kilobytes} kB");
}
