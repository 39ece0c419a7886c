//! The rules, one row each: what a checker of IODDs has to know of both editions.
//!
//! The two editions exclude each other at several points, so each has its own column. A rule with a gap belongs to one edition alone.

use fsct_protocol::Edition;

/// How much a finding weighs.
#[derive(Copy, Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Severity {
    /// A recommendation, something derived, or a rule the documents contradict themselves.
    Warning,
    /// The IODD breaks what the edition demands.
    Error,
}

impl Severity {
    /// `warning` or `error`.
    pub const fn name(self) -> &'static str {
        match self {
            Severity::Warning => "warning",
            Severity::Error => "error",
        }
    }
}

/// Who can see whether a rule holds.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Reach {
    /// It is checked in the file.
    File,
    /// It holds whenever these rules hold.
    Others(&'static str),
    /// The file alone cannot show it, and why.
    Not(&'static str),
}

/// One rule.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Rule {
    /// `IODD-24`.
    pub id: &'static str,
    /// Weight in v1.1; `None`: no rule there.
    pub v1_1: Option<Severity>,
    /// Weight in iec2022; `None`: no rule there.
    pub iec2022: Option<Severity>,
    /// Where the standard says so; "snippet" is the XML fragment of iec2022 E.3.2, "sample" the sample IODD at the end of Annex E.
    pub clause: &'static str,
    /// The rule in our words.
    pub text: &'static str,
    /// Who can see it.
    pub reach: Reach,
}

impl Rule {
    /// Its weight in an edition.
    pub const fn severity(&self, edition: Edition) -> Option<Severity> {
        match edition {
            Edition::V1_1 => self.v1_1,
            Edition::Iec2022 => self.iec2022,
        }
    }
}

/// The rule of an id.
pub fn rule(id: &str) -> Option<&'static Rule> {
    RULES.iter().find(|rule| rule.id == id)
}

const E: Option<Severity> = Some(Severity::Error);
const W: Option<Severity> = Some(Severity::Warning);
const NO: Option<Severity> = None;

type Weight = Option<Severity>;

const fn checked(id: &'static str, v1_1: Weight, iec2022: Weight, clause: &'static str, text: &'static str) -> Rule {
    Rule { id, v1_1, iec2022, clause, text, reach: Reach::File }
}

const fn elsewhere(
    id: &'static str,
    weight: (Weight, Weight),
    clause: &'static str,
    text: &'static str,
    reach: Reach,
) -> Rule {
    Rule { id, v1_1: weight.0, iec2022: weight.1, clause, text, reach }
}

/// All rules in order.
pub static RULES: &[Rule] = &[
    // General.
    elsewhere(
        "IODD-01",
        (E, E),
        "E.5.1",
        "there is one IODD for each DeviceID",
        Reach::Not("other IODDs of the maker would have to be known"),
    ),
    checked("IODD-02", E, E, "E.3.4 (v1.1 E.3.3), sample", "the profile characteristic names 16385, IO-Link Safety"),
    checked(
        "IODD-03",
        W,
        E,
        "E.3.1, snippet (v1.1: sample)",
        "the profile characteristic names 16384, the Common Profile",
    ),
    checked(
        "IODD-04",
        E,
        E,
        "E.3.4 (v1.1 E.3.3)",
        "the profile characteristic does not name 32800 (0x8020), which is reserved",
    ),
    checked(
        "IODD-05",
        E,
        E,
        "E.3.1",
        "every variable that can be read and written has a default, in a record every item",
    ),
    checked("IODD-06", W, W, "E.5.7, sample", "Data Storage is declared, because FSP parameters are part of it"),
    checked("IODD-07", E, E, "E.5.7", "Authenticity and protocol parameters are described as variables"),
    elsewhere(
        "IODD-08",
        (E, E),
        "E.5.7",
        "FST parameters are described",
        Reach::Not("which technology parameters a product has, the file alone does not tell"),
    ),
    checked("IODD-09", E, E, "A.2.10, snippet", "Index 16898, FSP_VerifyRecord, is not described"),
    checked("IODD-10", NO, E, "A.1, snippet", "the maker puts no variable of his own at Index 16896 to 17151"),
    checked(
        "IODD-11",
        E,
        NO,
        "Table E.1, E.3.4",
        "the mandatory and conditional variables of the base standard are referenced",
    ),
    checked("IODD-12", NO, E, "Table E.1, snippet", "the system commands 129 and 131 are offered, 128 and 130 are not"),
    checked("IODD-13", E, NO, "Table E.2", "the system command 130 is offered"),
    checked("IODD-14", NO, E, "E.3.5, snippet", "V_ProcessDataInput and V_ProcessDataOutput are referenced"),
    checked(
        "IODD-15",
        E,
        E,
        "E.4.1",
        "V_FSP_ begins the names of protocol safety variables alone, V_FST_ those of technology safety variables",
    ),
    // FSP variables.
    checked(
        "IODD-16",
        E,
        E,
        "Table A.1, snippet, sample",
        "Index 16896 is V_FSP_Authenticity, read and write, a record of 88 bit with four items",
    ),
    checked(
        "IODD-17",
        E,
        E,
        "Table A.1, snippet, sample",
        "Index 16897 is V_FSP_Protocol, read and write, a record of 96 bit with six items",
    ),
    checked("IODD-18", NO, E, "snippet", "the FSP records and the process data do not support access by Subindex"),
    checked(
        "IODD-19",
        E,
        E,
        "E.5.2",
        "the defaults of the authenticity record, FSP_TechParCRC and FSP_ProtParCRC are 0",
    ),
    checked("IODD-20", E, E, "A.2.4, snippet, sample", "FSP_ProtVersion allows 1 alone and has it as default"),
    checked("IODD-21", NO, E, "A.2.5, snippet", "FSP_ProtMode allows one value, 1 or 2, and has it as default"),
    checked("IODD-22", E, NO, "A.2.5, sample", "FSP_ProtMode allows 1, 2 or both, and has one of them as default"),
    checked(
        "IODD-23",
        E,
        E,
        "A.2.6, snippet, sample",
        "FSP_Watchdog has one range within 1 to 65535 with the default in it",
    ),
    checked(
        "IODD-24",
        W,
        E,
        "A.2.7, E.5.5, snippet",
        "the default of FSP_IO_StructCRC is not 0 and (a warning) that of the process data description",
    ),
    checked(
        "IODD-25",
        E,
        E,
        "Table E.3 (v1.1 Table E.4)",
        "no allowed values are given for the other items of the two records",
    ),
    checked(
        "IODD-26",
        NO,
        E,
        "A.2.15, snippet",
        "Index 16914 is V_FSP_ParamDescCRC, read only, UIntegerT of 32 bit, with a default",
    ),
    checked(
        "IODD-27",
        E,
        NO,
        "A.2.13, sample",
        "Index 16914 is V_FSP_ParamDescCRC, read only, UIntegerT of 16 bit, with a default",
    ),
    checked(
        "IODD-28",
        NO,
        E,
        "A.2.11, snippet",
        "Index 16912 is V_FSP_TimeToReady, read only, UIntegerT of 16 bit, default 1 to 32767",
    ),
    checked("IODD-29", NO, W, "A.2.11", "FSP_TimeToReady is at most 500 (5 s); more restricts the FS-Master"),
    checked(
        "IODD-30",
        NO,
        E,
        "A.2.12, snippet",
        "Index 16913 is V_FSP_MinShutDownTime, read only, UIntegerT of 16 bit, default 100 to 1000",
    ),
    checked(
        "IODD-31",
        NO,
        E,
        "A.2.13, snippet",
        "Index 16915 is V_FSP_WCDT, read only, UIntegerT of 16 bit, default 1 to 32767",
    ),
    checked(
        "IODD-32",
        NO,
        E,
        "A.2.14, snippet",
        "Index 16916 is V_FSP_OFDT, read only, UIntegerT of 16 bit, default 1 to 32767",
    ),
    checked(
        "IODD-33",
        E,
        NO,
        "Table A.1, A.2.11, A.2.12",
        "Index 16912 and 16913 are the passwords: write only, StringT of 32 octets ASCII (names: a warning)",
    ),
    checked("IODD-34", NO, E, "Table A.1, snippet", "the passwords of v1.1 do not appear"),
    // Process data.
    checked("IODD-35", E, E, "E.4.2", "PDin and PDout are each one record"),
    checked("IODD-36", E, E, "E.4.2", "the items of process data have Subindex 1 to 255, each once"),
    checked(
        "IODD-37",
        E,
        E,
        "E.4.2, 11.4.3",
        "safety data begin at the highest bit offset, the safety code follows, then non-safety data",
    ),
    checked(
        "IODD-38",
        E,
        E,
        "11.4.9 (v1.1 11.4.8), snippet",
        "safety data are BooleanT, IntegerT 16 and IntegerT 32, in this order (order in v1.1: a warning)",
    ),
    checked(
        "IODD-39",
        W,
        E,
        "snippet, sample",
        "Booleans stand without gaps from the lowest bit of an octet up, integers on octet borders",
    ),
    checked(
        "IODD-40",
        NO,
        E,
        "E.4.2, snippet",
        "Subindex 127 of PDin and PDout is an OctetStringT of 4 octets with FSP_ProtMode 1, 6 with 2",
    ),
    checked(
        "IODD-41",
        E,
        NO,
        "E.4.2, 11.4.3",
        "Subindex 127 of PDin and PDout is an OctetStringT of 4 or 6 octets (3 or 5: a warning)",
    ),
    checked("IODD-42", E, E, "E.4.2", "there is one process data structure, chosen by no condition"),
    checked(
        "IODD-43",
        NO,
        E,
        "snippet",
        "process data, their records and the texts of safety items have the names of the profile, and at least 32 bit",
    ),
    checked("IODD-44", NO, E, "snippet", "the user interface shows PDin and PDout, Subindex 127 in hexadecimal"),
    checked(
        "IODD-45",
        E,
        E,
        "A.2.5, 11.4.4",
        "safety data have at most 3 octets with FSP_ProtMode 1, 25 with 2; process data at most 32",
    ),
    checked(
        "IODD-46",
        W,
        NO,
        "A.2.5, 11.4.3",
        "the safety code has the length that FSP_ProtMode asks for, in both directions",
    ),
    // Parameter description.
    checked(
        "IODD-47",
        E,
        E,
        "E.5.1, Figure E.1",
        "the default of FSP_ParamDescCRC is the signature over the parameter description",
    ),
    elsewhere(
        "IODD-48",
        (E, E),
        "Table E.4 (v1.1 Table E.5)",
        "the octets of the parameter description that the standard fixes have the printed values",
        Reach::Others("IODD-16, IODD-17, IODD-19, IODD-20 and IODD-25 fix each of these octets by what it means"),
    ),
    elsewhere(
        "IODD-49",
        (E, E),
        "11.7.2, E.5.6",
        "the FS-Master Tool computes the signature when it opens or imports an IODD and reports a difference",
        Reach::Not("a demand on the FS-Master Tool; IODD-47 is the same comparison"),
    ),
    // Events.
    checked("IODD-50", W, E, "B.1, snippet, sample", "the Events 45056 to 45065 are declared, in iec2022 45066 too"),
    checked(
        "IODD-51",
        E,
        E,
        "Table B.1, snippet, sample",
        "45056 and 45057 are warnings (notifications: a warning), the others errors",
    ),
    checked("IODD-52", NO, E, "snippet", "the Events have the text ids of the profile"),
    checked("IODD-53", W, W, "Table B.1", "no reserved Event code up to 45311 is declared"),
    // Menus.
    checked("IODD-54", NO, E, "E.4.3", "the headings stand in the order FS Technology, FS Protocol, FS Auxiliary"),
    checked(
        "IODD-55",
        NO,
        E,
        "E.4.3",
        "the menus of FS parameters have their ids; those of FST parameters exist when there are such parameters",
    ),
    checked("IODD-56", NO, E, "E.4.3", "FST and FSP variables stand in their own menus, and nothing else there"),
    checked(
        "IODD-57",
        NO,
        E,
        "E.4.3, snippet",
        "the roles have the menus of the profile, which lead to the FS parameters",
    ),
    checked(
        "IODD-58",
        NO,
        E,
        "snippet",
        "the protocol menus show the ten items of both records, to the observer read only, the watchdog in ms",
    ),
    checked("IODD-59", NO, E, "snippet", "the auxiliary menu shows the four times in ms"),
    checked("IODD-60", E, NO, "E.4.3", "the headings stand in the order Standard, FST, FSP in menus named so"),
    checked("IODD-61", W, NO, "sample", "observer and maintenance see FSP and FST parameters read only"),
    checked(
        "IODD-62",
        NO,
        E,
        "snippet",
        "the primary language is English and has the texts of the profile (wording of the headings: a warning)",
    ),
    elsewhere(
        "IODD-63",
        (W, W),
        "E.4.3, E.4.4",
        "tools show headings for safety and non-safety data in yellow, and equal names for equal data",
        Reach::Not("a demand on tools; an IODD carries no colours"),
    ),
];
