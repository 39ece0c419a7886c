//! Sessions of sigrok, generated.

use super::tools::{levels, opened, refused, told, zip};
use fsct_lines::Recording;
use fsct_lines::capture::Format;
use rstest::rstest;

/// Metadata of a device with three probes.
fn metadata(rate: &str, unit: &str) -> String {
    format!(
        "[global]\nsigrok version=0.5.2\n\n[device 1]\ncapturefile=logic-1\ntotal probes=8\n{rate}\ntotal analog=0\n\
         probe1=D0\nprobe2=D1\nprobe3=D2\n{unit}\n"
    )
}

const ALL: &str = "L+=D0,C/Q=D1,I/Q=D2";

fn session(metadata: &str, chunks: &[(&str, &[u8])]) -> Vec<u8> {
    zip(&[&[("version", b"2".as_slice()), ("metadata", metadata.as_bytes())], chunks].concat())
}

#[test]
fn samples_go_on_from_chunk_to_chunk() {
    let sound = metadata("samplerate=24 MHz", "unitsize=1");
    let file = session(&sound, &[("logic-1-1", &[1, 1, 3]), ("logic-1-2", &[]), ("logic-1-3", &[0xFB, 6, 6])]);
    let mut capture = opened(&file, ALL, "").unwrap();
    assert_eq!((capture.format(), capture.uncertainty_ns()), (Format::Sigrok, 42));
    assert_eq!(capture.levels(), levels(true, false, false));
    assert_eq!(told(&mut capture), "c1@83 p0@166 i1@166");
    assert_eq!(capture.end(), 208);
    assert_eq!(
        capture.stated(),
        "sigrok session, sampled at 24 MHz as the file states: an edge may be off by 42 ns; L+ is `D0`; C/Q is `D1`; \
         I/Q is `D2`"
    );
}

#[test]
fn an_error_of_rounding_does_not_grow() {
    // 24 samples are 1000 ns.
    let mut samples = vec![0; 24_000_001];
    samples[24_000_000] = 2;
    let file = session(&metadata("samplerate=24 MHz", "unitsize=1"), &[("logic-1-1", &samples)]);
    assert_eq!(told(&mut opened(&file, ALL, "").unwrap()), "c1@1000000000");
}

#[rstest]
#[case::of_a_device_of_16_channels(&[0, 1, 0, 1, 2, 0, 2, 1, 0], "logic-1-1", "unitsize=2", true)]
#[case::of_the_first_format(&[0, 2, 2, 0], "logic-1", "unitsize=1", false)]
fn other_sessions(#[case] samples: &[u8], #[case] name: &str, #[case] unit: &str, #[case] cut: bool) {
    let file = session(&metadata("samplerate=1000000", unit), &[(name, samples)]);
    if cut {
        assert_eq!(refused(&file, ALL), "its samples end in the middle of one: they are cut off");
        let whole = session(&metadata("samplerate=1000000", unit), &[(name, &samples[..8])]);
        assert_eq!(told(&mut opened(&whole, ALL, "").unwrap()), "c1@2000");
    } else {
        assert_eq!(told(&mut opened(&file, ALL, "").unwrap()), "c1@1000 c0@3000");
    }
}

#[test]
fn a_sample_may_lie_in_two_chunks() {
    let file = session(
        &metadata("samplerate=1 MHz", "unitsize=2").replace("probe3=D2", "probe9=D8"),
        &[("logic-1-1", &[0, 0, 0]), ("logic-1-2", &[1, 0, 1])],
    );
    assert_eq!(told(&mut opened(&file, "I/Q=D8", "").unwrap()), "i1@1000");
}

#[test]
fn a_rate_that_is_missing_can_be_told() {
    let file = session(&metadata("", "unitsize=1"), &[("logic-1-1", &[0, 2])]);
    assert_eq!(refused(&file, ALL), "its metadata state no sample rate: give it, such as 24 MHz");
    assert_eq!(told(&mut opened(&file, ALL, "1 kHz").unwrap()), "c1@1000000");
}

#[rstest]
#[case::rate_0("samplerate=0 Hz", "unitsize=1", "a sample rate of 0 gives samples no time")]
#[case::rate_in_words("samplerate=fast", "unitsize=1", "`fast` is no sample rate, such as 24 MHz")]
#[case::unit_missing("samplerate=1 MHz", "", "its metadata state no unitsize from 1 to 64")]
#[case::unit_0("samplerate=1 MHz", "unitsize=0", "its metadata state no unitsize from 1 to 64")]
#[case::unit_huge("samplerate=1 MHz", "unitsize=1000000000", "its metadata state no unitsize from 1 to 64")]
#[case::two_devices(
    "samplerate=1 MHz",
    "unitsize=1\n[device 2]\ncapturefile=logic-2",
    "it holds the samples of more than one device"
)]
#[case::a_probe_beyond(
    "samplerate=1 MHz",
    "unitsize=1\nprobe9=X",
    "its metadata name a probe9 that does not fit into 1 octets"
)]
fn metadata_refused(#[case] rate: &str, #[case] unit: &str, #[case] expected: &str) {
    assert_eq!(refused(&session(&metadata(rate, unit), &[("logic-1-1", &[0, 2])]), ALL), expected);
}

#[rstest]
#[case::no_chunk(&[], "it holds no sample")]
#[case::no_sample(&[("logic-1-1", b"".as_slice())], "it holds no sample")]
#[case::the_first_is_missing(&[("logic-1-2", b"\0".as_slice())],
    "chunk 2 of its samples comes after chunk 0: one is missing")]
#[case::one_is_missing(&[("logic-1-1", b"\0".as_slice()), ("logic-1-3", b"\0".as_slice())],
    "chunk 3 of its samples comes after chunk 1: one is missing")]
fn chunks_refused(#[case] chunks: &[(&str, &[u8])], #[case] expected: &str) {
    assert_eq!(refused(&session(&metadata("samplerate=1 MHz", "unitsize=1"), chunks), ALL), expected);
}

#[test]
fn archives_that_are_no_sessions_are_refused() {
    assert_eq!(
        refused(&zip(&[("meta.json", b"{}")]), ""),
        "this is a zip archive without `metadata`, so no sigrok session; from Saleae Logic export CSV"
    );
    assert_eq!(
        refused(&zip(&[]), ""),
        "this is a zip archive without `metadata`, so no sigrok session; from Saleae Logic export CSV"
    );
    let analog = metadata("samplerate=1 MHz", "").replace("capturefile=logic-1", "");
    let sentence = "its metadata name no capturefile: it holds no samples of logic channels";
    assert_eq!(refused(&session(&analog, &[]), ""), sentence);
    let long = "a".repeat(1 << 17);
    assert_eq!(refused(&session(&long, &[]), ""), "its metadata are longer than 65536 octets");
}

#[test]
fn a_damaged_chunk_ends_the_recording() {
    let samples: Vec<u8> = (0..=255).collect();
    let mut file = session(&metadata("samplerate=1 MHz", "unitsize=1"), &[("logic-1-1", &samples)]);
    let place =
        file.windows(4).position(|octets| octets == [2, 3, 4, 5]).expect("samples without repetition are stored");
    file[place] ^= 0x80;
    let sentence = refused(&file, ALL);
    assert!(sentence.starts_with("chunk 1 of its samples: "), "{sentence}");
}

/// A directory with this number of entries that all stand for the same octets.
fn entries_over_entries(count: u16) -> Vec<u8> {
    let noise: Vec<u8> =
        (0..5_000_u64).map(|number| (number.wrapping_mul(0x9E37_79B9_7F4A_7C15) >> 40) as u8).collect();
    let mut file = session(&metadata("samplerate=1 MHz", "unitsize=1"), &[("logic-1-1", &noise)]);
    let end = file.windows(4).rposition(|octets| octets == b"PK\x05\x06").unwrap();
    let entry = file.windows(4).rposition(|octets| octets == b"PK\x01\x02").unwrap();
    let mut announced = file.split_off(end);
    let entry = file[entry..].to_vec();
    let size = u32::from_le_bytes(announced[12..16].try_into().unwrap());
    for number in 0..count {
        let mut copy = entry.clone();
        let name = copy.len() - "logic-1-1".len();
        copy[name..].copy_from_slice(format!("l{number:08}").as_bytes());
        file.extend(copy);
    }
    announced[8..10].copy_from_slice(&(count + 3).to_le_bytes());
    announced[10..12].copy_from_slice(&(count + 3).to_le_bytes());
    announced[12..16].copy_from_slice(&(size + u32::from(count) * entry.len() as u32).to_le_bytes());
    file.extend(announced);
    file
}

#[test]
fn entries_that_overlap_are_refused() {
    assert!(opened(&entries_over_entries(0), ALL, "").is_ok());
    assert_eq!(refused(&entries_over_entries(30_000), ALL), "the entries of the zip archive overlap");
}

#[test]
fn a_directory_in_the_large_format_is_refused() {
    let mut file = session(&metadata("samplerate=1 MHz", "unitsize=1"), &[("logic-1-1", &[0, 2])]);
    let end = file.windows(4).rposition(|octets| octets == b"PK\x05\x06").unwrap();
    file.splice(end..end, b"PK\x06\x07".iter().copied().chain([0; 16]));
    assert_eq!(
        refused(&file, ALL),
        "the zip archive is in the format for more than 65535 entries or 4 GB, which is not read"
    );
}

#[test]
fn a_stream_cannot_be_a_session() {
    let file = session(&metadata("samplerate=1 MHz", "unitsize=1"), &[("logic-1-1", &[0, 2])]);
    let error = fsct_lines::capture::Capture::from_stream(std::io::Cursor::new(file), &Default::default()).unwrap_err();
    assert_eq!(error.what, "a sigrok session cannot be read from a stream: store it in a file");
}
