//! The run record: what a run leaves on disk, one JSON object a line, and everything reports are made of.
//!
//! Line 1 is a [`Header`], then one [`CaseRecord`] a case, flushed when the case ends, and a [`Footer`] when the run came to its
//! end. A record without footer is valid and partial. Nothing here depends on wall time, so the same seed on a
//! virtual clock gives the same octets.

use crate::measurement::Measurement;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Version of this schema; the number changes when a reader of the old one would misread.
pub const SCHEMA: &str = "fsct-run/2";

/// One line of the journal.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Line {
    /// First line.
    Header(Box<Header>),
    /// A case.
    Case(Box<CaseRecord>),
    /// Last line of a complete run.
    Footer(Footer),
}

/// What the run was asked to do, and of what.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Header {
    /// [`SCHEMA`].
    pub schema: String,
    /// Version of fsct.
    pub fsct: String,
    /// The seed that everything random derives from.
    pub seed: u64,
    /// The devices under test, in the order they were judged; a case says by number which one it is about.
    #[serde(rename = "dut")]
    pub duts: Vec<DutInfo>,
    /// Number of expanded cases planned.
    pub planned: usize,
    /// Cases left out by the selection, with the term that excluded them: key, then reason.
    pub not_applicable: Vec<(String, String)>,
    /// Every tolerance in force: id (`A19`), then what it allows.
    pub tolerances: BTreeMap<String, String>,
    /// What each machine of the DUTs can be led through beyond single transitions.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub machines: Vec<MachineInfo>,
    /// The error matrix, one part a role, when cases of it were planned.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub matrix: Vec<MatrixInfo>,
    /// What Annex I of v1.1 asks for, when the run was made to support it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub evidence: Option<Evidence>,
    /// The scenarios of Annex G that planned cases are about.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub scenarios: Vec<ScenarioInfo>,
    /// Complete suites of which sequences were planned, each on one DUT.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub complete: Vec<CompleteInfo>,
}

/// A complete suite: a case whose points are sequences of inputs that together leave no wrong DUT.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct CompleteInfo {
    /// Number of the DUT.
    pub dut: usize,
    /// Role of the DUT.
    pub role: String,
    /// Suite of the case.
    pub suite: String,
    /// Id of the case.
    pub id: String,
    /// Edition and mode, `iec2022 crc16`.
    pub variant: String,
    /// Whether the value of a counter is part of the state.
    pub absolute: bool,
    /// States of the table that can be told apart.
    pub states: usize,
    /// States the DUT may have beyond these.
    pub extra: usize,
    /// Inputs there are.
    pub inputs: usize,
    /// Sequences of the whole suite.
    pub sequences: usize,
    /// Inputs of all sequences together.
    pub length: usize,
    /// Cases planned: fewer than sequences when a part was asked for, more when each runs several times.
    pub planned: usize,
}

/// A scenario or chart of Annex G, in the words of the suite.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct ScenarioInfo {
    /// Its id, `CH-G1`.
    pub id: String,
    /// What it is about.
    pub title: String,
    /// Edition, then the clause that has it there.
    pub clauses: Vec<(String, String)>,
    /// What happens, in order.
    pub activities: Vec<ActivityInfo>,
}

/// One thing that happens in a scenario.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct ActivityInfo {
    /// Its number; steps of cases name it.
    pub number: u16,
    /// The one edition that has it; empty: both.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub edition: String,
    /// Who does it: `operator`, `tool`, `master` or `device`.
    pub from: String,
    /// Who it is done to; empty: it happens within `from`.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub to: String,
    /// What is done.
    pub what: String,
    /// What is expected of it.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub then: String,
    /// Why no case reaches it: role of the DUT, then the reason.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub out_of_reach: BTreeMap<String, String>,
}

/// What a machine can be led through. Transitions and steps that follow each other are written one behind the other: `T24 T22`.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct MachineInfo {
    /// The role of a DUT that has it, `device` or `master`.
    pub role: String,
    /// Steps, each everything between two waiting states: name, then its transitions.
    pub steps: Vec<(String, String)>,
    /// Pairs of transitions.
    pub pairs: Goal,
    /// Triples of transitions.
    pub triples: Goal,
    /// Pairs of steps.
    pub step_pairs: Goal,
    /// What is asked in its states.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub conditions: Vec<ConditionInfo>,
    /// Both sides of every guard condition: `D22-SIGNATURE false`.
    #[serde(default, skip_serializing_if = "Goal::is_empty")]
    pub guards: Goal,
    /// Both sides of its timer in every waiting state: `DTIMER-24 expired`, `DTIMER-24 restarted`.
    #[serde(default, skip_serializing_if = "Goal::is_empty")]
    pub timers: Goal,
}

/// A condition of a machine: of a guard, of an action, or its timer.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct ConditionInfo {
    /// Its id.
    pub id: String,
    /// The state it is asked in.
    pub state: String,
    /// The transitions it decides.
    pub rows: String,
    /// What is asked.
    pub asks: String,
    /// Where the standard asks it.
    pub clause: String,
}

/// What can be walked of one kind, and what cannot.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Goal {
    /// Everything that can.
    pub feasible: Vec<String>,
    /// What the rows of the machine would allow but its guards rule out, with the reason.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub infeasible: Vec<(String, String)>,
}

impl Goal {
    fn is_empty(&self) -> bool {
        self.feasible.is_empty() && self.infeasible.is_empty()
    }
}

/// The error matrix for one role: which cases show what.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct MatrixInfo {
    /// `device` or `master`.
    pub role: String,
    /// Headings of the columns: direction and state.
    pub columns: Vec<String>,
    /// One row an error class.
    pub rows: Vec<MatrixRow>,
}

/// An error class of the matrix.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct MatrixRow {
    /// Its name.
    pub class: String,
    /// One cell a column.
    pub cells: Vec<MatrixCell>,
}

/// A cell of the matrix.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct MatrixCell {
    /// Ids of the cases that show it.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub cases: Vec<String>,
    /// Why there is none; empty where there are cases.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub none: String,
}

/// What Annex I of v1.1 asks for, with what supports it.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Evidence {
    /// Its items.
    pub items: Vec<EvidenceItem>,
    /// Statements of both editions by what is done about them: `tested`, `bench`, ...
    pub classes: BTreeMap<String, usize>,
}

/// An item of Annex I.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct EvidenceItem {
    /// The chapter of a dossier that answers it.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub chapter: String,
    /// Clause: `I.4`.
    pub clause: String,
    /// What it asks for.
    pub asks: String,
    /// Suites and groups whose cases support it, each with its suites.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub cases: Vec<(String, Vec<String>)>,
    /// Parts of the report that support it.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub figures: Vec<String>,
    /// Documents that support it, with what each says.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub documents: Vec<(String, String)>,
    /// What has to come from elsewhere.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub gaps: Vec<String>,
}

/// The device under test, in its own words and the words of the command line. Hostile text: escape it.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct DutInfo {
    /// Address as given on the command line.
    pub url: String,
    /// `device` or `master`.
    pub role: String,
    /// Name of the profile it was judged by.
    pub profile: String,
    /// Maker.
    pub vendor: String,
    /// Product.
    pub product: String,
    /// Versions.
    pub version: String,
    /// Points of control and observation served.
    pub pcos: Vec<String>,
    /// `virtual` or `real`.
    pub clock: String,
    /// Resolution of the clock in nanoseconds.
    pub resolution_ns: u64,
    /// Uncertainty of a time stamp in nanoseconds, that of the way to the DUT included where it was measured.
    pub uncertainty_ns: u64,
    /// How long the way to it and back took, where that was measured: on a serial line.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub round_trip: Option<LatencyInfo>,
    /// What a loop-back made of the statement about the clock.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub clock_proof: Option<ClockProofInfo>,
    /// What it can be configured as, one text an offer.
    pub offers: Vec<String>,
    /// What its profile declares (PICS and PIXIT): name in the standard's spelling, then value with unit.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub declared: Vec<(String, String)>,
}

/// The clock of a DUT held against a loop-back before the first case, in nanoseconds.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct ClockProofInfo {
    /// `proved`, `unproved` or `contradicted`.
    pub finding: String,
    /// Stamps looked at.
    pub stamps: usize,
    /// Uncertainty of a stamp that the DUT states.
    pub stated_ns: u64,
    /// How far off, either way, half of the stamps can have been at the most; of a virtual clock the worst of all.
    pub shown_ns: u64,
    /// How far off a stamp was at least; 0: nothing shows that any was.
    pub off_ns: u64,
    /// All steps between stamps are multiples of this; 0: there was none.
    pub step_ns: u64,
    /// Least and greatest drift against the clock of fsct that explains the stamps, in millionths; real clocks only.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub drift_ppm: Option<(i64, i64)>,
}

impl ClockProofInfo {
    /// One line for a reader. The finding is a text of the record: to be escaped where it is shown.
    pub fn said(&self) -> String {
        let drift = self.drift_ppm.map_or_else(String::new, |(low, high)| format!(", drift {low} to {high} ppm"));
        let off = if self.off_ns > 0 { format!(", off by {} ns or more", self.off_ns) } else { String::new() };
        format!(
            "{} by {} stamps: stated ± {} ns, shown ± {} ns{off}, steps of {} ns{drift}",
            self.finding, self.stamps, self.stated_ns, self.shown_ns, self.step_ns
        )
    }
}

/// Round trips to a DUT, measured before the first case, in nanoseconds.
#[derive(Copy, Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct LatencyInfo {
    /// The shortest.
    pub min_ns: u64,
    /// Half of them took no longer.
    pub median_ns: u64,
    /// 99 of 100 took no longer.
    pub p99_ns: u64,
    /// The longest.
    pub max_ns: u64,
}

/// Conformance axis of a verdict, best first. Verdicts only worsen.
#[derive(Copy, Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// Does not apply to this DUT.
    NotApplicable,
    /// As the standard asks.
    Pass,
    /// A should-level statement not met, or a tolerance made use of.
    Remark,
    /// Neither pass nor fail can be said.
    Inconclusive,
    /// Not as the standard asks.
    Fail,
}

/// Execution axis of a verdict: did the case run as meant, and if not, who is at fault.
#[derive(Copy, Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Execution {
    /// Ran as meant.
    Ok,
    /// The DUT did not answer in time.
    Timeout,
    /// The DUT broke the contract of the adapter.
    DutError,
    /// Cable, port, path: the DUT was not reached.
    RigError,
    /// A fault of fsct itself.
    ToolError,
    /// Stopped before its end, or not begun.
    Aborted,
}

/// Why a verdict is what it is. The first reason of a case decides, later ones only add.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Reason {
    /// Verdict this reason leads to.
    pub verdict: Verdict,
    /// What kind of finding, as nested names a waiver can match: `oracle/signature`, `expect/DCommErr`, `liveness`,
    /// `dut/timeout`.
    pub kind: String,
    /// Clause of the standard in the edition of the case, with table or transition: `11.5.3 Table 40 T25`.
    pub clause: String,
    /// Step of the case, from 1; 0 is the start condition, one past the last is the liveness check at the end.
    pub step: usize,
    /// Position in the trace of the exchange that shows it.
    pub entry: Option<usize>,
    /// What was expected, as text.
    pub expected: String,
    /// What was observed, as text (may hold text from the DUT: escape it).
    pub observed: String,
}

/// One executed case.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CaseRecord {
    /// Unique: id and sweep, `FSD-0231[edition=iec2022,mode=crc16,pd=3,flip=17]`.
    pub key: String,
    /// Stable id.
    pub id: String,
    /// Suite it stands in.
    pub suite: String,
    /// Number of the DUT in the header, from 0.
    pub dut: usize,
    /// Role of the DUT, `device` or `master`: needed to decode the trace.
    pub role: String,
    /// What it shows.
    pub title: String,
    /// The scenario of Annex G it leads the DUT through; empty: none.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub scenario: String,
    /// File and line of the case.
    pub place: String,
    /// Values of the sweep, in order of the key.
    pub sweep: Vec<(String, String)>,
    /// Edition, mode and sizes in force: needed to decode the trace.
    pub variant: VariantInfo,
    /// Requirements it judges.
    pub requirements: Vec<RequirementRef>,
    /// Conformance.
    pub verdict: Verdict,
    /// Execution.
    pub execution: Execution,
    /// Why; empty for a plain pass.
    pub reasons: Vec<Reason>,
    /// Tolerances made use of: id, then what happened.
    pub tolerances: BTreeMap<String, String>,
    /// In a case of a complete suite: tolerances about what is open that were made use of, so that not everything was as the
    /// table has it.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub open: Vec<String>,
    /// Transitions the DUT went through, `T22` to count.
    pub transitions: BTreeMap<String, u64>,
    /// What of its machine followed what, each once.
    #[serde(default, skip_serializing_if = "Walked::is_empty")]
    pub walked: Walked,
    /// Start condition.
    pub start: String,
    /// Steps with their expectations; index 0 is the start condition, the last is the liveness check.
    pub steps: Vec<StepRecord>,
    /// Values measured in it.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub measurements: Vec<Measurement>,
    /// What crossed the boundary, in order.
    pub trace: Vec<Entry>,
    /// Entries left out of the middle of the trace because it was too long.
    pub elided: u64,
    /// Duration on the clock of the DUT, in nanoseconds.
    pub duration_ns: u64,
    /// Command line that runs this case alone.
    pub replay: String,
}

/// Sequences a DUT went through in a case, by the names of a [`MachineInfo`].
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Walked {
    /// Pairs of transitions.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub pairs: Vec<String>,
    /// Triples of transitions.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub triples: Vec<String>,
    /// Pairs of steps.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub step_pairs: Vec<String>,
    /// Sides of guard conditions that decided.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub guards: Vec<String>,
    /// Sides of timers that were seen.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub timers: Vec<String>,
}

impl Walked {
    fn is_empty(&self) -> bool {
        [&self.pairs, &self.triples, &self.step_pairs, &self.guards, &self.timers].into_iter().all(Vec::is_empty)
    }
}

/// Edition, mode and process data sizes of a case.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct VariantInfo {
    /// `v1.1` or `iec2022`.
    pub edition: String,
    /// `crc16` or `crc32`.
    pub mode: String,
    /// Octets of FS-PDout.
    pub pd_out: u8,
    /// Octets of FS-PDin.
    pub pd_in: u8,
    /// `true` when PIXIT says that the start value of the signature is a leading octet (A02).
    pub leading_octet: bool,
}

/// A requirement a case refers to.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct RequirementRef {
    /// Id in the ledger.
    pub id: String,
    /// Clause in the edition of the case.
    pub clause: String,
    /// `shall`, `should`, `may` or `fact`.
    pub level: String,
}

/// One step of a case.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct StepRecord {
    /// What was done, as a line of the case language.
    pub text: String,
    /// The activities of the scenario it is about.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub activities: Vec<u16>,
    /// Whether the step was reached.
    pub executed: bool,
    /// First and one past the last entry of the trace that belong to it.
    pub entries: (usize, usize),
    /// Its expectations, as far as they were judged.
    pub checks: Vec<Check>,
}

/// One judged expectation.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Check {
    /// What was looked at: `SDset`, `app.PDout_D`.
    pub key: String,
    /// Value asked for.
    pub expected: String,
    /// Value found.
    pub observed: String,
    /// Whether they agree.
    pub met: bool,
}

/// One thing that crossed the boundary to the DUT. Octets are upper-case hexadecimal without spaces.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Entry {
    /// Nanoseconds on the clock of the DUT.
    pub at: u64,
    /// How many times in a row; equal exchanges that caused nothing else are counted, not repeated.
    #[serde(default = "one", skip_serializing_if = "is_one")]
    pub count: u64,
    /// What.
    pub what: What,
    /// Transitions of the DUT at this point, in order: `["T24", "T22", "T23"]`.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub via: Vec<String>,
    /// What the tester did on purpose here: "bit 17 inverted"; empty for the usual.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub note: String,
}

fn one() -> u64 {
    1
}

fn is_one(count: &u64) -> bool {
    *count == 1
}

fn first() -> u8 {
    1
}

fn is_first(port: &u8) -> bool {
    *port == 1
}

/// What crossed the boundary.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum What {
    /// Process data: what the DUT received (`None`: lost) and what it presented (`None`: no process data).
    Exchange {
        /// Port, from 1.
        port: u8,
        /// To the DUT.
        sent: Option<String>,
        /// From the DUT.
        got: Option<String>,
    },
    /// Application service set by the upper tester.
    Set {
        /// Port, from 1; 0 for the whole DUT.
        #[serde(default = "first", skip_serializing_if = "is_first")]
        port: u8,
        /// The standard's spelling.
        service: String,
        /// Hexadecimal.
        value: String,
    },
    /// Application service reported by the DUT.
    Service {
        /// Port, from 1.
        #[serde(default = "first", skip_serializing_if = "is_first")]
        port: u8,
        /// The standard's spelling.
        service: String,
        /// Hexadecimal.
        value: String,
    },
    /// Supply.
    Power {
        /// On or off.
        on: bool,
    },
    /// On-request data with the answer.
    Acyclic {
        /// `read 0x4201.0` or `write 0x4202.0 = 00..`.
        request: String,
        /// `= 00..`, `written`, `refused 0x8030`, `unsupported`.
        answer: String,
    },
    /// What happened on a port of an FS-Master beside process data: lines, modes, on-request data, Events.
    Port {
        /// Port, from 1.
        port: u8,
        /// Done by the DUT and not by what is connected to it.
        dut: bool,
        /// In words, with names and numbers of the standard.
        text: String,
    },
    /// A request through the SMI.
    Smi {
        /// Service, port and ArgBlock in words.
        request: String,
        /// Result(+) or Result(-) with its ArgBlock in words.
        result: String,
    },
    /// An Event.
    Event {
        /// EventCode.
        code: u16,
        /// EventQualifier.
        qualifier: u8,
    },
}

/// The end of a complete run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Footer {
    /// Expanded cases recorded.
    pub cases: usize,
    /// `true` when the run was stopped by the user.
    pub interrupted: bool,
}
