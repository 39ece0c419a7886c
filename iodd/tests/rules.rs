//! A sound IODD of our own for each edition, and for each rule an edit that breaks it: the rule is named with the line, and no other.

use Severity::{Error, Warning};
use fsct_iodd::{Finding, RULES, Reach, Report, Severity, check};
use fsct_protocol::Edition::{self, Iec2022, V1_1};
use std::collections::BTreeSet;

fn sound(edition: Edition) -> &'static str {
    match edition {
        V1_1 => include_str!("sound-v1.1.xml"),
        Iec2022 => include_str!("sound-iec2022.xml"),
    }
}

fn judged(text: &str, edition: Edition) -> Report {
    check(text.as_bytes(), Some(edition)).expect("the file is readable")
}

/// Findings the sound file has anyway: four octets of safety data with FSP_ProtMode 1, which 11.2 of v1.1 names.
fn given(edition: Edition) -> &'static [&'static str] {
    match edition {
        V1_1 => &["IODD-45"],
        Iec2022 => &[],
    }
}

/// A sound file, edited, breaks one rule.
struct Variation {
    rule: &'static str,
    edition: Edition,
    severity: Severity,
    /// What is replaced, each once, by what.
    edits: &'static [(&'static str, &'static str)],
    /// The first line with this text is the place of the finding.
    line: &'static str,
}

const fn breaks(
    rule: &'static str,
    edition: Edition,
    severity: Severity,
    edits: &'static [(&'static str, &'static str)],
    line: &'static str,
) -> Variation {
    Variation { rule, edition, severity, edits, line }
}

const VARIATIONS: &[Variation] = &[
    breaks("IODD-02", Iec2022, Error, &[("16384 16385", "16384")], "<Features"),
    breaks("IODD-02", V1_1, Error, &[("16384 16385", "16384")], "<Features"),
    breaks("IODD-03", Iec2022, Error, &[("16384 16385", "16385")], "<Features"),
    breaks("IODD-03", V1_1, Warning, &[("16384 16385", "16385")], "<Features"),
    breaks("IODD-04", Iec2022, Error, &[("16384 16385", "16384 16385 32800")], "<Features"),
    breaks("IODD-05", Iec2022, Error, &[(" defaultValue=\"50\"", "")], "V_Brightness"),
    breaks(
        "IODD-05",
        V1_1,
        Error,
        &[("<RecordItemInfo subindex=\"6\" defaultValue=\"0\"/>", "")],
        "\"V_FSP_Protocol\"",
    ),
    breaks("IODD-06", Iec2022, Warning, &[("dataStorage=\"true\"", "dataStorage=\"false\"")], "<Features"),
    breaks("IODD-09", V1_1, Error, &[("index=\"64\"", "index=\"16898\"")], "\"V_Brightness\""),
    breaks("IODD-09", Iec2022, Error, &[("index=\"64\"", "index=\"16898\"")], "\"V_Brightness\""),
    breaks("IODD-10", Iec2022, Error, &[("index=\"64\"", "index=\"17000\"")], "\"V_Brightness\""),
    breaks("IODD-10", Iec2022, Error, &[("index=\"64\"", "index=\"16916\"")], "\"V_Brightness\""),
    breaks("IODD-11", V1_1, Error, &[("<StdVariableRef id=\"V_ErrorCount\"/>", "")], "<VariableCollection"),
    breaks("IODD-11", V1_1, Error, &[("<StdVariableRef id=\"V_ProcessDataInput\"/>", "")], "<VariableCollection"),
    breaks(
        "IODD-11",
        V1_1,
        Error,
        &[("fixedLengthRestriction=\"32\"", "fixedLengthRestriction=\"8\"")],
        "fixedLengthRestriction",
    ),
    breaks("IODD-11", V1_1, Warning, &[("<StdVariableRef id=\"V_PDInputDescriptor\"/>", "")], "<VariableCollection"),
    breaks("IODD-11", V1_1, Warning, &[("V_DirectParameters_1", "V_DirectParameters_2")], "V_DirectParameters_2"),
    breaks("IODD-12", Iec2022, Error, &[("<StdSingleValueRef value=\"131\"/>", "")], "V_SystemCommand"),
    breaks(
        "IODD-12",
        Iec2022,
        Error,
        &[(
            "<StdSingleValueRef value=\"131\"/>",
            "<StdSingleValueRef value=\"131\"/><StdSingleValueRef value=\"130\"/>",
        )],
        "value=\"130\"",
    ),
    breaks("IODD-13", V1_1, Error, &[("value=\"130\"", "value=\"129\"")], "V_SystemCommand"),
    breaks("IODD-14", Iec2022, Error, &[("<StdVariableRef id=\"V_ProcessDataOutput\"/>", "")], "<VariableCollection"),
    breaks("IODD-15", V1_1, Error, &[("id=\"V_Brightness\"", "id=\"V_FSP_Brightness\"")], "id=\"V_FSP_Brightness\""),
    breaks("IODD-15", Iec2022, Error, &[("id=\"V_Brightness\"", "id=\"V_FSTBrightness\"")], "id=\"V_FSTBrightness\""),
    breaks(
        "IODD-16",
        Iec2022,
        Error,
        &[("subindex=\"2\" bitOffset=\"24\"", "subindex=\"2\" bitOffset=\"23\"")],
        "bitOffset=\"23\"",
    ),
    breaks(
        "IODD-16",
        V1_1,
        Error,
        &[("index=\"16896\" accessRights=\"rw\"", "index=\"16896\" accessRights=\"ro\"")],
        "index=\"16896\"",
    ),
    breaks(
        "IODD-17",
        Iec2022,
        Error,
        &[("subindex=\"3\" bitOffset=\"64\"", "subindex=\"3\" bitOffset=\"72\"")],
        "bitOffset=\"72\"",
    ),
    breaks(
        "IODD-17",
        V1_1,
        Error,
        &[("xsi:type=\"RecordT\" bitLength=\"96\"", "xsi:type=\"RecordT\" bitLength=\"95\"")],
        "\"D_FSP_Protocol\"",
    ),
    breaks(
        "IODD-18",
        Iec2022,
        Error,
        &[("bitLength=\"96\" subindexAccessSupported=\"false\"", "bitLength=\"96\" subindexAccessSupported=\"true\"")],
        "\"D_FSP_Protocol\"",
    ),
    breaks(
        "IODD-18",
        Iec2022,
        Error,
        &[("bitLength=\"48\" subindexAccessSupported=\"false\"", "bitLength=\"48\"")],
        "\"D_FSP_PDout\"",
    ),
    breaks(
        "IODD-19",
        Iec2022,
        Error,
        &[("subindex=\"3\" defaultValue=\"0\"", "subindex=\"3\" defaultValue=\"1\"")],
        "subindex=\"3\" defaultValue=\"1\"",
    ),
    breaks(
        "IODD-19",
        V1_1,
        Error,
        &[("subindex=\"5\" defaultValue=\"0\"", "subindex=\"5\" defaultValue=\"7\"")],
        "subindex=\"5\" defaultValue=\"7\"",
    ),
    breaks(
        "IODD-20",
        Iec2022,
        Error,
        &[("subindex=\"1\" defaultValue=\"1\"", "subindex=\"1\" defaultValue=\"0\"")],
        "\"V_FSP_Protocol\"+2",
    ),
    breaks(
        "IODD-20",
        V1_1,
        Error,
        &[("<SingleValue value=\"1\"/>", "<SingleValue value=\"0\"/>")],
        "subindex=\"1\" bitOffset=\"88\"",
    ),
    breaks(
        "IODD-21",
        Iec2022,
        Error,
        &[("<SingleValue value=\"2\"/>", "<SingleValue value=\"1\"/><SingleValue value=\"2\"/>")],
        "subindex=\"2\" bitOffset=\"80\"",
    ),
    breaks(
        "IODD-22",
        V1_1,
        Error,
        &[(
            "bitLength=\"8\"><SingleValue value=\"1\"/></SimpleDatatype>\n            <Name textId=\"TN_V_FSP_ProtMode\"",
            "bitLength=\"8\"><SingleValue value=\"3\"/></SimpleDatatype>\n            <Name textId=\"TN_V_FSP_ProtMode\"",
        )],
        "subindex=\"2\" bitOffset=\"80\"",
    ),
    breaks("IODD-23", Iec2022, Error, &[("lowerValue=\"100\"", "lowerValue=\"0\"")], "lowerValue"),
    breaks(
        "IODD-23",
        V1_1,
        Error,
        &[("subindex=\"3\" defaultValue=\"100\"", "subindex=\"3\" defaultValue=\"99\"")],
        "defaultValue=\"99\"",
    ),
    breaks(
        "IODD-23",
        V1_1,
        Error,
        &[("<ValueRange lowerValue=\"100\" upperValue=\"5000\"/>", "")],
        "subindex=\"3\" bitOffset=\"64\"",
    ),
    breaks("IODD-24", Iec2022, Error, &[("39464", "0")], "subindex=\"4\" defaultValue=\"0\"+9"),
    breaks("IODD-24", Iec2022, Warning, &[("39464", "39465")], "39465"),
    breaks("IODD-24", V1_1, Warning, &[("5115", "1")], "\"V_FSP_Protocol\"+5"),
    breaks(
        "IODD-25",
        Iec2022,
        Error,
        &[(
            "<SimpleDatatype xsi:type=\"UIntegerT\" bitLength=\"8\"/>",
            "<SimpleDatatype xsi:type=\"UIntegerT\" bitLength=\"8\"><ValueRange lowerValue=\"0\" upperValue=\"9\"/></SimpleDatatype>",
        )],
        "upperValue=\"9\"",
    ),
    breaks(
        "IODD-26",
        Iec2022,
        Error,
        &[("index=\"16914\" accessRights=\"ro\"", "index=\"16914\" accessRights=\"rw\"")],
        "16914",
    ),
    breaks(
        "IODD-27",
        V1_1,
        Error,
        &[("index=\"16914\" accessRights=\"ro\"", "index=\"16914\" accessRights=\"rw\"")],
        "16914",
    ),
    breaks(
        "IODD-28",
        Iec2022,
        Error,
        &[(
            "index=\"16912\" accessRights=\"ro\" defaultValue=\"20\"",
            "index=\"16912\" accessRights=\"ro\" defaultValue=\"0\"",
        )],
        "16912",
    ),
    breaks("IODD-29", Iec2022, Warning, &[("defaultValue=\"20\"", "defaultValue=\"501\"")], "16912"),
    breaks("IODD-30", Iec2022, Error, &[("defaultValue=\"150\"", "defaultValue=\"99\"")], "16913"),
    breaks("IODD-31", Iec2022, Error, &[("defaultValue=\"12\"", "defaultValue=\"32768\"")], "16915"),
    breaks("IODD-32", Iec2022, Error, &[("defaultValue=\"18\"", "defaultValue=\"0\"")], "16916"),
    breaks(
        "IODD-33",
        V1_1,
        Error,
        &[("index=\"16912\" accessRights=\"wo\"", "index=\"16912\" accessRights=\"rw\" defaultValue=\"x\"")],
        "16912",
    ),
    breaks("IODD-33", V1_1, Error, &[("encoding=\"US-ASCII\"", "encoding=\"UTF-8\"")], "16912"),
    breaks("IODD-33", V1_1, Warning, &[("id=\"V_FSP_Password\"", "id=\"V_FSP_PassWord\"")], "16912"),
    breaks(
        "IODD-34",
        Iec2022,
        Error,
        &[
            ("index=\"16912\" accessRights=\"ro\" defaultValue=\"20\"", "index=\"16912\" accessRights=\"wo\""),
            (
                "<Datatype xsi:type=\"UIntegerT\" bitLength=\"16\"/>",
                "<Datatype xsi:type=\"StringT\" fixedLength=\"32\" encoding=\"US-ASCII\"/>",
            ),
        ],
        "16912",
    ),
    breaks(
        "IODD-35",
        V1_1,
        Error,
        &[("xsi:type=\"RecordT\" bitLength=\"32\"", "xsi:type=\"OctetStringT\" fixedLength=\"4\"")],
        "\"D_PDout\"",
    ),
    breaks(
        "IODD-36",
        Iec2022,
        Error,
        &[("subindex=\"128\" bitOffset=\"0\"", "subindex=\"256\" bitOffset=\"0\"")],
        "subindex=\"256\"",
    ),
    breaks(
        "IODD-36",
        V1_1,
        Error,
        &[("subindex=\"128\" bitOffset=\"0\"", "subindex=\"0\" bitOffset=\"0\"")],
        "subindex=\"0\"",
    ),
    breaks(
        "IODD-37",
        Iec2022,
        Error,
        &[("subindex=\"128\" bitOffset=\"0\"", "subindex=\"128\" bitOffset=\"8\"")],
        "subindex=\"128\" bitOffset=\"8\"",
    ),
    breaks(
        "IODD-37",
        V1_1,
        Error,
        &[("subindex=\"127\" bitOffset=\"16\"", "subindex=\"127\" bitOffset=\"24\"")],
        "subindex=\"127\" bitOffset=\"24\"",
    ),
    breaks("IODD-37", V1_1, Error, &[("bitLength=\"80\"", "bitLength=\"88\"")], "bitOffset=\"79\""),
    breaks(
        "IODD-38",
        V1_1,
        Error,
        &[(
            "<SimpleDatatype xsi:type=\"IntegerT\" bitLength=\"16\"/>",
            "<SimpleDatatype xsi:type=\"UIntegerT\" bitLength=\"16\"/>",
        )],
        "subindex=\"14\" bitOffset",
    ),
    breaks("IODD-38", Iec2022, Error, SWAPPED, "subindex=\"14\" bitOffset"),
    breaks("IODD-38", V1_1, Warning, SWAPPED, "subindex=\"14\" bitOffset"),
    breaks(
        "IODD-39",
        Iec2022,
        Error,
        &[("subindex=\"13\" bitOffset=\"84\"", "subindex=\"13\" bitOffset=\"85\"")],
        "subindex=\"13\" bitOffset",
    ),
    breaks(
        "IODD-39",
        V1_1,
        Warning,
        &[("subindex=\"13\" bitOffset=\"68\"", "subindex=\"13\" bitOffset=\"69\"")],
        "subindex=\"13\" bitOffset",
    ),
    breaks(
        "IODD-40",
        Iec2022,
        Error,
        &[
            (
                "subindex=\"127\" bitOffset=\"0\">\n            <SimpleDatatype xsi:type=\"OctetStringT\" fixedLength=\"6\"",
                "subindex=\"127\" bitOffset=\"0\">\n            <SimpleDatatype xsi:type=\"OctetStringT\" fixedLength=\"4\"",
            ),
            ("bitLength=\"48\" subindexAccess", "bitLength=\"32\" subindexAccess"),
        ],
        "subindex=\"127\" bitOffset=\"0\"",
    ),
    breaks(
        "IODD-41",
        V1_1,
        Error,
        &[("<SimpleDatatype xsi:type=\"OctetStringT\" fixedLength=\"4\"/>", "")],
        "subindex=\"127\" bitOffset=\"16\"",
    ),
    breaks(
        "IODD-41",
        V1_1,
        Warning,
        &[
            (
                "subindex=\"127\" bitOffset=\"0\">\n            <SimpleDatatype xsi:type=\"OctetStringT\" fixedLength=\"4\"",
                "subindex=\"127\" bitOffset=\"0\">\n            <SimpleDatatype xsi:type=\"OctetStringT\" fixedLength=\"3\"",
            ),
            (
                "bitLength=\"32\">\n          <RecordItem subindex=\"127\"",
                "bitLength=\"24\">\n          <RecordItem subindex=\"127\"",
            ),
        ],
        "subindex=\"127\" bitOffset=\"0\"",
    ),
    breaks(
        "IODD-42",
        V1_1,
        Error,
        &[("<ProcessDataIn ", "<Condition variableId=\"V_Brightness\" value=\"1\"/><ProcessDataIn ")],
        "<Condition",
    ),
    breaks(
        "IODD-42",
        Iec2022,
        Warning,
        &[("<ProcessDataIn ", "<Condition variableId=\"V_Brightness\" value=\"1\"/><ProcessDataIn ")],
        "<Condition",
    ),
    breaks(
        "IODD-42",
        Iec2022,
        Error,
        &[("</ProcessDataCollection>", "<ProcessData id=\"P_Second\"/></ProcessDataCollection>")],
        "P_Second",
    ),
    breaks("IODD-43", Iec2022, Error, &[("id=\"P_ProcessData\"", "id=\"ProcessData\"")], "id=\"ProcessData\""),
    breaks("IODD-43", Iec2022, Error, &[("TN_V_FST_Beam_7\"", "TN_V_Beam_7\"")], "bitOffset=\"94\""),
    breaks("IODD-44", Iec2022, Error, &[(" displayFormat=\"Hex\"", "")], "<ProcessDataRecordItemInfo subindex=\"127\""),
    breaks(
        "IODD-45",
        Iec2022,
        Error,
        &[("id=\"PI_PDin\" bitLength=\"96\"", "id=\"PI_PDin\" bitLength=\"264\"")],
        "\"PI_PDin\" ",
    ),
    breaks(
        "IODD-45",
        V1_1,
        Error,
        &[
            (
                "<SimpleDatatype xsi:type=\"IntegerT\" bitLength=\"16\"/>",
                "<SimpleDatatype xsi:type=\"IntegerT\" bitLength=\"32\"/>",
            ),
            ("subindex=\"127\" bitOffset=\"16\"", "subindex=\"127\" bitOffset=\"0\""),
            ("subindex=\"14\" bitOffset=\"48\"", "subindex=\"14\" bitOffset=\"32\""),
            ("<RecordItem subindex=\"128\"", "<!-- <RecordItem subindex=\"128\""),
            ("<Description textId=\"TD_V_Soiling\"/>\n          </RecordItem>", "-->"),
        ],
        "\"D_PDin\"",
    ),
    breaks(
        "IODD-46",
        V1_1,
        Warning,
        &[
            (
                "subindex=\"127\" bitOffset=\"0\">\n            <SimpleDatatype xsi:type=\"OctetStringT\" fixedLength=\"4\"",
                "subindex=\"127\" bitOffset=\"0\">\n            <SimpleDatatype xsi:type=\"OctetStringT\" fixedLength=\"6\"",
            ),
            (
                "bitLength=\"32\">\n          <RecordItem subindex=\"127\"",
                "bitLength=\"48\">\n          <RecordItem subindex=\"127\"",
            ),
        ],
        "subindex=\"127\" bitOffset=\"0\"",
    ),
    breaks("IODD-47", Iec2022, Error, &[("1860635738", "1860635739")], "16914"),
    breaks("IODD-47", Iec2022, Error, &[("upperValue=\"5000\"", "upperValue=\"5001\"")], "16914"),
    breaks("IODD-47", V1_1, Error, &[("13807", "13808")], "16914"),
    breaks("IODD-50", Iec2022, Error, &[("code=\"45066\"", "code=\"6200\"")], "<EventCollection"),
    breaks("IODD-50", V1_1, Warning, &[("code=\"45060\"", "code=\"6200\"")], "<EventCollection"),
    breaks("IODD-51", V1_1, Error, &[("code=\"45058\" type=\"Error\"", "code=\"45058\" type=\"Warning\"")], "45058"),
    breaks(
        "IODD-51",
        Iec2022,
        Warning,
        &[("code=\"45057\" type=\"Warning\"", "code=\"45057\" type=\"Notification\"")],
        "45057",
    ),
    breaks("IODD-52", Iec2022, Error, &[("TN_EV_FSP_Incorrect_AuthentCRC", "TN_EV_FSP_AuthentCRC")], "45061"),
    breaks(
        "IODD-53",
        V1_1,
        Warning,
        &[("</EventCollection>", "<Event code=\"45066\" type=\"Error\"/></EventCollection>")],
        "45066",
    ),
    breaks(
        "IODD-53",
        Iec2022,
        Warning,
        &[("</EventCollection>", "<Event code=\"45311\" type=\"Error\"/></EventCollection>")],
        "45311",
    ),
    breaks(
        "IODD-54",
        Iec2022,
        Error,
        &[
            ("<MenuRef menuId=\"M_OR_FST_Param\"/>", ""),
            (
                "<MenuRef menuId=\"M_OMSR_FSP_Param_Aux\"/>",
                "<MenuRef menuId=\"M_OMSR_FSP_Param_Aux\"/><MenuRef menuId=\"M_OR_FST_Param\"/>",
            ),
        ],
        "<MenuRef menuId=\"M_OR_FST_Param\"/>",
    ),
    breaks(
        "IODD-55",
        Iec2022,
        Error,
        &[("id=\"M_OMSR_FSP_Param_Aux\"", "id=\"M_OMSR_FSP_Param_More\"")],
        "<MenuCollection",
    ),
    breaks(
        "IODD-56",
        Iec2022,
        Error,
        &[("<VariableRef variableId=\"V_DetailedDeviceStatus\"/>", "<VariableRef variableId=\"V_FST_Muting\"/>")],
        "M_MSR_Diag+2",
    ),
    breaks(
        "IODD-56",
        Iec2022,
        Error,
        &[(
            "<VariableRef variableId=\"V_FST_Muting\"/>",
            "<VariableRef variableId=\"V_FST_Muting\"/><VariableRef variableId=\"V_Brightness\"/>",
        )],
        "<VariableRef variableId=\"V_FST_Muting\"/>",
    ),
    breaks("IODD-57", Iec2022, Error, &[("<MenuRef menuId=\"M_OMSR_FSP_Param_Aux\"/>", "")], "<Menu id=\"M_OR_Param\""),
    breaks("IODD-57", Iec2022, Error, &[("<DiagnosisMenu menuId=\"M_OR_Diag\"/>", "")], "<ObserverRoleMenuSet"),
    breaks(
        "IODD-58",
        Iec2022,
        Error,
        &[(
            "variableId=\"V_FSP_Protocol\" subindex=\"5\" accessRightRestriction=\"ro\"",
            "variableId=\"V_FSP_Protocol\" subindex=\"5\"",
        )],
        "variableId=\"V_FSP_Protocol\" subindex=\"5\"",
    ),
    breaks(
        "IODD-59",
        Iec2022,
        Error,
        &[(
            "variableId=\"V_FSP_WCDT\" displayFormat=\"Dec.0\" offset=\"0.0\" gradient=\"1.0\"",
            "variableId=\"V_FSP_WCDT\" displayFormat=\"Dec.0\" offset=\"0.0\" gradient=\"10.0\"",
        )],
        "variableId=\"V_FSP_WCDT\"",
    ),
    breaks(
        "IODD-60",
        V1_1,
        Error,
        &[
            ("<MenuRef menuId=\"ME_SR_Param_Standard\"/>", ""),
            (
                "<MenuRef menuId=\"ME_SR_Param_FSP\"/>",
                "<MenuRef menuId=\"ME_SR_Param_FSP\"/><MenuRef menuId=\"ME_SR_Param_Standard\"/>",
            ),
        ],
        "<MenuRef menuId=\"ME_SR_Param_Standard\"/>",
    ),
    breaks(
        "IODD-60",
        V1_1,
        Error,
        &[
            ("<Menu id=\"ME_SR_Param_FST\"", "<Menu id=\"ME_SR_Technology\""),
            ("menuId=\"ME_SR_Param_FST\"", "menuId=\"ME_SR_Technology\""),
        ],
        "<Menu id=\"ME_SR_Technology\"",
    ),
    breaks(
        "IODD-61",
        V1_1,
        Warning,
        &[(
            "<VariableRef variableId=\"V_FSP_Protocol\" accessRightRestriction=\"ro\"/>",
            "<VariableRef variableId=\"V_FSP_Protocol\"/>",
        )],
        "<VariableRef variableId=\"V_FSP_Protocol\"/>",
    ),
    breaks(
        "IODD-62",
        Iec2022,
        Error,
        &[("<Text id=\"TN_V_FSP_Port\"", "<Text id=\"TN_V_FSP_port\"")],
        "<PrimaryLanguage",
    ),
    breaks("IODD-62", Iec2022, Warning, &[("FS Auxiliary Parameter", "More parameters")], "More parameters"),
];

/// Subindex 13 and 14 change places in the type order: an integer before the last Boolean.
const SWAPPED: &[(&str, &str)] = &[
    ("<RecordItem subindex=\"13\"", "<RecordItem subindex=\"x\""),
    ("<RecordItem subindex=\"14\"", "<RecordItem subindex=\"13\""),
    ("<RecordItem subindex=\"x\"", "<RecordItem subindex=\"14\""),
];

/// The text after its edits.
fn edited(variation: &Variation) -> String {
    variation.edits.iter().fold(sound(variation.edition).to_owned(), |text, (from, to)| {
        assert!(text.contains(from), "{}: `{from}` is not in the file", variation.rule);
        text.replacen(from, to, 1)
    })
}

/// The text with the two signatures put right, so that an edit breaks the rule it is meant for and not these.
fn signed(text: String, edition: Edition) -> String {
    let (structure, param_desc) = match edition {
        V1_1 => ("defaultValue=\"5115\"", "defaultValue=\"13807\""),
        Iec2022 => ("defaultValue=\"39464\"", "defaultValue=\"1860635738\""),
    };
    let text = match judged(&text, edition).structure {
        Ok(signature) => text.replacen(structure, &format!("defaultValue=\"{}\"", signature.computed), 1),
        Err(_) => text,
    };
    match judged(&text, edition).param_desc {
        Ok(signature) => text.replacen(param_desc, &format!("defaultValue=\"{}\"", signature.computed), 1),
        Err(_) => text,
    }
}

/// The line of a text, from 1; `text+2` is two lines further down.
fn line_of(text: &str, needle: &str) -> usize {
    let (needle, further) = match needle.rsplit_once('+') {
        Some((needle, further)) => (needle, further.parse().expect("a number of lines")),
        None => (needle, 0),
    };
    1 + further + text.lines().position(|line| line.contains(needle)).expect("the place of the finding")
}

#[test]
fn each_rule_is_broken_by_its_edit_and_no_other_is() {
    let mut wrong = Vec::new();
    for variation in VARIATIONS {
        let text = edited(variation);
        let text = if variation.rule == "IODD-47" { text } else { signed(text, variation.edition) };
        let report = judged(&text, variation.edition);
        let others: Vec<&Finding> = report
            .findings
            .iter()
            .filter(|found| found.rule != variation.rule && !given(variation.edition).contains(&found.rule))
            .collect();
        let line = line_of(&text, variation.line);
        let hit = report
            .findings
            .iter()
            .any(|found| found.rule == variation.rule && found.severity == variation.severity && found.line == line);
        let sound = report.is_sound() == (variation.severity == Warning);
        if !hit || !sound || !others.is_empty() {
            wrong.push(format!(
                "{} {} {:?}, line {line}: {:#?}",
                variation.rule, variation.edition, variation.edits, report.findings
            ));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n\n"));
}

#[test]
fn every_rule_the_file_shows_has_an_edit_that_breaks_it() {
    let broken: BTreeSet<&str> = VARIATIONS.iter().map(|variation| variation.rule).chain(["IODD-07"]).collect();
    for rule in RULES {
        assert_eq!(broken.contains(rule.id), rule.reach == Reach::File, "{}", rule.id);
    }
}

/// Without one of the records nothing can be signed: the rule never comes alone.
#[test]
fn a_missing_record_is_named_together_with_the_signature_that_needs_it() {
    let text = sound(Iec2022).replacen("index=\"16896\"", "index=\"70\"", 1);
    let rules: Vec<&str> = judged(&text, Iec2022).findings.iter().map(|found| found.rule).collect();
    assert_eq!(rules, ["IODD-07", "IODD-15", "IODD-47"]);
}

#[test]
fn the_ids_of_the_rules_run_from_1_to_63() {
    let ids: Vec<String> = RULES.iter().map(|rule| rule.id.to_owned()).collect();
    assert_eq!(ids, (1..=63).map(|number| format!("IODD-{number:02}")).collect::<Vec<_>>());
}

#[test]
fn the_sound_files_are_sound_and_tell_their_edition() {
    for edition in Edition::ALL {
        let report = check(sound(edition).as_bytes(), None).expect("readable");
        let rules: Vec<&str> = report.findings.iter().map(|found| found.rule).collect();
        assert_eq!((report.edition, report.is_sound(), rules.as_slice()), (edition, true, given(edition)));
    }
}

#[test]
fn the_iodd_of_the_reference_device_is_sound() {
    let report = check(include_bytes!("reference-device.xml"), None).expect("readable");
    assert_eq!(report.findings, []);
    assert_eq!((report.declaration.pd_in, report.declaration.pd_out), (Some(1), Some(0)));
}
