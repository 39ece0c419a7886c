//! The two signatures against the printed examples and the known answers.

use fsct_iodd::{Report, check};
use fsct_protocol::Edition::{self, Iec2022, V1_1};
use fsct_protocol::ProtMode;
use rstest::rstest;

fn text(edition: Edition) -> &'static str {
    match edition {
        V1_1 => include_str!("sound-v1.1.xml"),
        Iec2022 => include_str!("sound-iec2022.xml"),
    }
}

fn report(edition: Edition) -> Report {
    check(text(edition).as_bytes(), None).expect("readable")
}

#[rstest]
#[case::iec2022_table_e_4(Iec2022, 0x6EE7_0C5A, 0x9A28)]
#[case::v1_1_sample(V1_1, 0x35EF, 0x13FB)]
fn the_printed_signatures_come_out(#[case] edition: Edition, #[case] param_desc: u32, #[case] structure: u32) {
    let report = report(edition);
    assert_eq!(report.param_desc.map(|signature| signature.computed), Ok(param_desc));
    assert_eq!(report.structure.map(|signature| signature.computed), Ok(structure));
}

#[test]
fn the_structure_of_figure_a_2_has_its_eleven_octets() {
    let octets = report(Iec2022).structure.expect("the structure").octets;
    assert_eq!(octets, [0x01, 0x0A, 0x0D, 0x02, 0x01, 0x00, 0x06, 0, 0, 0, 0]);
}

/// Every known answer of the parameter description, written into a file: default and values of FSP_ProtMode, watchdog, structure signature.
#[test]
fn the_known_answers_come_out_of_files_too() {
    let vectors = fsct_vectors::load().expect("vectors");
    let mut proven = 0;
    for vector in vectors.param_desc.iter().filter(|vector| vector.version == 1) {
        let edition: Edition = vector.edition.parse().expect("an edition");
        let protocol = |subindex: u8, value: u32| {
            (format!("<RecordItemInfo subindex=\"{subindex}\" defaultValue="), format!("defaultValue=\"{value}\""))
        };
        let single: String = vector.modes.iter().map(|value| format!("<SingleValue value=\"{value}\"/>")).collect();
        let (lower, upper) = vector.watchdog_range;
        let range = format!("lowerValue=\"{lower}\" upperValue=\"{upper}\"");
        let at = text(edition).find("id=\"V_FSP_Protocol\"").expect("the record");
        let (types, defaults) = text(edition).split_at(at);
        let mut defaults = defaults.to_owned();
        for (begin, value) in [
            protocol(2, vector.mode.into()),
            protocol(3, vector.watchdog.into()),
            protocol(4, vector.io_struct_crc.into()),
        ] {
            let from = defaults.find(&begin).expect("the default");
            let to = from + defaults.get(from..).and_then(|rest| rest.find("/>")).expect("its end");
            defaults.replace_range(from..to, &format!("{}{}", begin.trim_end_matches("defaultValue="), value));
        }
        let mode = types.find("bitOffset=\"80\"").expect("the mode");
        let (before, after) = types.split_at(mode);
        let old = match edition {
            V1_1 => "<SingleValue value=\"1\"/>",
            Iec2022 => "<SingleValue value=\"2\"/>",
        };
        let types = format!(
            "{before}{}",
            after.replacen(old, &single, 1).replacen("lowerValue=\"100\" upperValue=\"5000\"", &range, 1)
        );
        let report = check(format!("{types}{defaults}").as_bytes(), Some(edition)).expect("readable");
        let signature = report.param_desc.expect("serialised");
        assert_eq!(signature.octets, vector.data.0, "{}", vector.id);
        proven += 1;
        assert_eq!(signature.computed, vector.decimal, "{}", vector.id);
    }
    assert!(proven >= 8, "{proven}");
}

#[test]
fn the_declaration_is_what_the_file_says() {
    let declared = report(Iec2022).declaration;
    assert_eq!(
        (declared.edition, declared.mode, declared.pd_in, declared.pd_out),
        (Iec2022, Some(ProtMode::Crc32), Some(4), Some(0))
    );
    assert_eq!((declared.watchdog, declared.watchdog_range), (Some(100), Some((100, 5000))));
    assert_eq!((declared.io_struct_crc, declared.param_desc_crc), (Some(39464), Some(1_860_635_738)));
    assert_eq!(
        (declared.time_to_ready, declared.min_shut_down_time, declared.wcdt, declared.ofdt),
        (Some(20), Some(150), Some(12), Some(18))
    );
    let declared = report(V1_1).declaration;
    assert_eq!((declared.mode, declared.time_to_ready, declared.wcdt), (Some(ProtMode::Crc16), None, None));
}
