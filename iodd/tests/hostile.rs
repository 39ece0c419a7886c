//! Files made to harm: bounded time and memory, one sentence, nothing fetched, no panic.

use fsct_iodd::{MOST_OCTETS, Unreadable, check, octets_of};
use fsct_protocol::Edition;
use proptest::prelude::*;
use rstest::rstest;

const SOUND: &str = include_str!("sound-iec2022.xml");

fn refused(octets: &[u8]) -> String {
    check(octets, None).expect_err("no IODD").to_string()
}

#[rstest]
#[case::empty(b"", "an IODD is well-formed XML")]
#[case::no_xml(b"IODD", "an IODD is well-formed XML")]
#[case::open(b"<IODevice>", "an IODD is well-formed XML")]
#[case::other(b"<html/>", "its root element is `html`")]
#[case::utf_16(b"\xFF\xFE<\0I\0", "UTF-16")]
#[case::utf_16_without_mark(b"<\0I\0", "UTF-16")]
#[case::latin_1(b"<?xml version='1.0' encoding='ISO-8859-1'?><IODevice/>", "encoded in ISO-8859-1")]
#[case::octets(b"<IODevice>\n\xE4</IODevice>", "line 2: octets that are no UTF-8")]
#[case::bomb(b"<!DOCTYPE a [<!ENTITY a \"&b;&b;\"><!ENTITY b \"xxx\">]><IODevice>&a;</IODevice>", "DOCTYPE")]
#[case::external(
    b"<?xml version='1.0'?>\n<!DOCTYPE a SYSTEM 'http://example.invalid/a.dtd'><IODevice/>",
    "line 2: a document type"
)]
#[case::entity(b"<IODevice>&bomb;</IODevice>", "an IODD is well-formed XML")]
#[case::nothing_in_it(b"<IODevice/>", "nothing in it tells its edition")]
fn a_file_that_is_none_is_refused_with_a_sentence(#[case] octets: &[u8], #[case] sentence: &str) {
    let said = refused(octets);
    assert!(said.contains(sentence), "{said}");
    assert!(!said.contains('\n'), "{said}");
}

#[test]
fn a_mark_of_utf_8_is_no_fault() {
    let marked = format!("\u{FEFF}{SOUND}");
    assert_eq!(check(marked.as_bytes(), None).map(|report| report.findings), Ok(Vec::new()));
}

#[test]
fn a_hundred_thousand_nested_elements_are_refused() {
    let deep = format!("{}{}", "<a>".repeat(100_000), "</a>".repeat(100_000));
    assert_eq!(
        check(deep.as_bytes(), None),
        Err(Unreadable::Bounds { line: 1, what: "elements nested more than 64 deep" })
    );
}

#[test]
fn attributes_and_namespaces_are_bounded() {
    let attributes: String = (0..100_000).map(|number| format!(" a{number}=''")).collect();
    assert!(refused(format!("<IODevice{attributes}/>").as_bytes()).contains("more than 64 attributes"));
    let namespaces: String = (0..10_000).map(|number| format!("<a xmlns:n{number}='x'/>")).collect();
    assert!(refused(format!("<IODevice>{namespaces}</IODevice>").as_bytes()).contains("namespace"));
}

#[test]
fn a_file_beyond_the_bound_is_refused_unread() {
    let path = std::env::temp_dir().join(format!("fsct-iodd-large-{}", std::process::id()));
    // Sparse: nothing of it is ever written.
    std::fs::File::create(&path).and_then(|file| file.set_len(MOST_OCTETS * 1000)).expect("a file");
    let said = octets_of(&path);
    std::fs::remove_file(&path).expect("removed");
    assert_eq!(said, Err(Unreadable::TooLarge));
    assert_eq!(octets_of(&std::env::temp_dir()), Err(Unreadable::NoFile));
}

#[test]
fn findings_are_bounded() {
    let many = "<Variable id='V_FSP_X' index='1' accessRights='rw'/>".repeat(100_000);
    let text = SOUND.replacen("</VariableCollection>", &format!("{many}</VariableCollection>"), 1);
    assert_eq!(check(text.as_bytes(), None).expect("readable").findings.len(), 1000);
}

#[test]
fn two_editions_in_one_file_need_an_answer() {
    let text = SOUND.replacen(
        "<Datatype xsi:type=\"UIntegerT\" bitLength=\"32\"/>",
        "<Datatype xsi:type=\"UIntegerT\" bitLength=\"16\"/>",
        1,
    );
    let said = refused(text.as_bytes());
    assert!(said.contains("two editions at once: FSP_ParamDescCRC has 16 bit (v1.1), but"), "{said}");
    assert!(check(text.as_bytes(), Some(Edition::Iec2022)).is_ok());
}

proptest! {
    /// Octets of the sound file changed, removed and repeated: an answer, whatever it is.
    #[test]
    fn a_damaged_file_never_panics(
        changes in proptest::collection::vec((0..SOUND.len(), any::<u8>(), 0..3_u8), 1..12),
        edition in prop_oneof![Just(None), Just(Some(Edition::V1_1)), Just(Some(Edition::Iec2022))],
    ) {
        let mut octets = SOUND.as_bytes().to_vec();
        for (at, octet, kind) in changes {
            let at = at % octets.len();
            match kind {
                0 => octets[at] = octet,
                1 => { octets.remove(at); }
                _ => octets.insert(at, octet),
            }
        }
        let _ = check(&octets, edition);
    }

    /// Numbers and names of the sound file replaced, so that it stays XML and reaches every check.
    #[test]
    fn a_file_with_other_values_never_panics(
        changes in proptest::collection::vec((0..2000_usize, prop_oneof!["[0-9]{1,20}", "-[0-9]{1,3}", "[A-Za-z_]{0,8}"]), 1..40),
        edition in prop_oneof![Just(Edition::V1_1), Just(Edition::Iec2022)],
    ) {
        let mut parts: Vec<&str> = SOUND.split('"').collect();
        for (at, value) in &changes {
            // Odd parts stand between quotes; the first ones are the declaration and the namespaces.
            let at = 9 + 2 * at;
            if at < parts.len() - 1 {
                parts[at] = value;
            }
        }
        prop_assert!(check(parts.join("\"").as_bytes(), Some(edition)).is_ok());
    }
}
