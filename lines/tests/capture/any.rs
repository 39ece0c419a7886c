//! Every reader with files that are cut, damaged or something else.

use super::tools::{edges, opened, refused, zip};
use fsct_lines::Recording;
use fsct_lines::capture::{Options, open};
use proptest::prelude::*;
use rstest::rstest;
use std::path::PathBuf;

/// A sound file of each kind, with edges of C/Q.
fn sound() -> [Vec<u8>; 4] {
    let vcd = "$timescale 10 ns $end $scope module m $end $var wire 1 ! CQ $end $upscope $end $enddefinitions $end\n\
               #0 0!\n#10 1!\n#200 0!\n#3000\n";
    let saleae = "Time [s],A,CQ\n0.000000,0,0\n0.000001,1,1\n0.000030,1,0\n";
    let sigrok = "; Channels (1/1): CQ\n; Samplerate: 1 MHz\nlogic\n0\n1\n1\n0\n0\n";
    let metadata = "[device 1]\ncapturefile=logic-1\nsamplerate=1 MHz\nprobe1=CQ\nunitsize=1\n";
    let session = zip(&[("version", b"2"), ("metadata", metadata.as_bytes()), ("logic-1-1", b"\0\x01\x01\0\0")]);
    [vcd.into(), saleae.into(), sigrok.into(), session]
}

/// Reads what there is to its end; edges must be in order and within the recording.
fn survives(octets: &[u8]) -> bool {
    let Ok(mut capture) = opened(octets, "", "") else { return false };
    let (edges, error) = edges(&mut capture);
    assert!(edges.is_sorted_by_key(|edge| edge.at), "{edges:?}");
    assert!(edges.last().is_none_or(|edge| edge.at <= capture.end()), "{edges:?}");
    error.is_none()
}

#[test]
fn a_file_cut_anywhere_ends() {
    for file in sound() {
        assert!(survives(&file));
        for length in 0..file.len() {
            survives(&file[..length]);
        }
    }
}

#[test]
fn a_session_cut_anywhere_is_refused() {
    let [.., session] = sound();
    for length in 0..session.len() {
        assert!(!survives(&session[..length]), "{length} of {}", session.len());
    }
}

#[test]
fn an_error_stays() {
    let text = "Time [s],CQ\n0.0,0\n0.5,1\n0.2,0\n0.9,1\n";
    let mut capture = opened(text.as_bytes(), "", "").unwrap();
    assert_eq!(capture.next_edge().unwrap().unwrap().at, 500_000_000);
    let error = capture.next_edge().unwrap_err();
    assert_eq!(capture.next_edge(), Err(error));
}

proptest! {
    #[test]
    fn a_damaged_file_ends(kind in 0_usize..4, damage in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6)) {
        let mut file = sound()[kind].clone();
        for (place, octet) in damage {
            let place = place.index(file.len());
            file[place] = octet;
        }
        survives(&file);
    }

    #[test]
    fn any_text_ends(kind in 0_usize..3, text in "[ -~\n]{0,200}") {
        let begin = ["$timescale 1 ns $end ", "Time [s],CQ\n", "; Channels (1/1): CQ\n; Samplerate: 1 MHz\n"][kind];
        survives(format!("{begin}{text}").as_bytes());
    }
}

#[rstest]
#[case::empty(b"".as_slice(), "the file is empty")]
#[case::a_picture(
    b"\x89PNG\r\n\x1A\n",
    "this is no VCD, no sigrok session and no CSV of sigrok or Saleae Logic: it begins with `\u{FFFD}PNG\\r\\n\\u{1a}\\n`"
)]
#[case::a_letter(
    b"Dear Sir or Madam, here is what the analyser says",
    "this is no VCD, no sigrok session and no CSV of sigrok or Saleae Logic: it begins with `Dear Sir or Mada`"
)]
#[case::blanks(
    b"   \n",
    "this is no VCD, no sigrok session and no CSV of sigrok or Saleae Logic: it begins with `   \\n`"
)]
#[case::gzip(b"\x1F\x8B\x08\0", "this is compressed with gzip: unpack it first")]
#[case::binary(b"<SALEAE>\0\0\0\0", "this is a binary export of Saleae Logic: export CSV")]
fn other_files_are_refused(#[case] octets: &[u8], #[case] expected: &str) {
    assert_eq!(refused(octets, ""), expected);
}

/// A file beside the test programs.
fn stored(name: &str, octets: &[u8]) -> PathBuf {
    let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(format!("{}-{name}", std::process::id()));
    std::fs::write(&path, octets).unwrap();
    path
}

#[rstest]
#[case(0, "a.sr", "VCD")]
#[case(1, "a.vcd", "CSV of Saleae Logic")]
#[case(2, "saleae.csv", "CSV of sigrok")]
#[case(3, "b.csv", "sigrok session")]
fn a_wrong_label_misleads_nobody(#[case] kind: usize, #[case] name: &str, #[case] expected: &str) {
    let path = stored(name, &sound()[kind]);
    let capture = open(&path, &Options::default()).unwrap();
    assert_eq!(capture.format().to_string(), expected);
    std::fs::remove_file(path).unwrap();
}

#[test]
fn errors_name_the_file() {
    let path = stored("bad.csv", b"Time [s],CQ\n0.0,0\n0.5,2\n");
    let mut capture = open(&path, &Options::default()).unwrap();
    let error = capture.next_edge().unwrap_err().what;
    assert_eq!(error, format!("{}: line 3: `2` is neither 0 nor 1", path.display()));
    std::fs::write(&path, b"").unwrap();
    assert_eq!(open(&path, &Options::default()).unwrap_err().what, format!("{}: the file is empty", path.display()));
    std::fs::remove_file(&path).unwrap();
    let gone = open(&path, &Options::default()).unwrap_err().what;
    assert!(gone.starts_with(&format!("{}: No such file", path.display())), "{gone}");
    let folder = open(&PathBuf::from(env!("CARGO_TARGET_TMPDIR")), &Options::default()).unwrap_err().what;
    assert!(folder.contains("directory"), "{folder}");
}
