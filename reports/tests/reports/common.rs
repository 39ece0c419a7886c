//! Constructors of records, and a folder to keep one in.

use fsct_reports::record::*;
use fsct_reports::{Journal, Run};
use std::collections::BTreeMap;
use std::path::PathBuf;

pub const HOSTILE: &str = "<script>alert(1)</script> ]]> \u{0} \u{1b}[31m \u{fffe} \u{202e}gpj.exe \"quoted\" & 'more'";

pub fn header(planned: usize) -> Header {
    Header {
        schema: SCHEMA.into(),
        fsct: "0.0.0".into(),
        seed: 7,
        duts: vec![curtain()],
        planned,
        not_applicable: vec![("FSD-0999[edition=v1.1]".into(), "the DUT does not serve `app`".into())],
        tolerances: BTreeMap::from([("A19".into(), "T29 read sequentially (tolerated)".into())]),
        machines: Vec::new(),
        matrix: Vec::new(),
        evidence: None,
        scenarios: Vec::new(),
        complete: Vec::new(),
    }
}

/// An FS-Device.
pub fn curtain() -> DutInfo {
    DutInfo {
        url: "tcp://192.0.2.1:7000".into(),
        role: "device".into(),
        profile: "curtain".into(),
        vendor: "ACME".into(),
        product: "Curtain 3000".into(),
        version: "hw 1 sw 2".into(),
        pcos: vec!["power".into(), "link".into()],
        clock: "virtual".into(),
        resolution_ns: 1,
        ..DutInfo::default()
    }
}

/// An FS-Master.
pub fn gateway() -> DutInfo {
    DutInfo {
        url: "unix:/run/gateway".into(),
        role: "master".into(),
        profile: "gateway-of-8".into(),
        product: "Gateway 8".into(),
        version: "fw 9".into(),
        ..curtain()
    }
}

pub fn exchange(at_ms: u64, sent: &str, got: &str, via: &[&str], note: &str) -> Entry {
    Entry {
        at: at_ms * 1_000_000,
        count: 1,
        what: What::Exchange { port: 1, sent: Some(sent.into()), got: Some(got.into()) },
        via: via.iter().map(|t| (*t).to_owned()).collect(),
        note: note.into(),
    }
}

/// A case that passed: start-up of SEQ-POWERON, two exchanges.
pub fn passed(number: usize) -> CaseRecord {
    CaseRecord {
        key: format!("FSD-{number:04}[edition=iec2022,mode=crc16,pd=1]"),
        id: format!("FSD-{number:04}"),
        suite: "device-startup".into(),
        dut: 0,
        role: "device".into(),
        title: "Start-up of both sides".into(),
        scenario: String::new(),
        place: "testcases/suites/device-startup.yaml:4".into(),
        sweep: vec![("edition".into(), "iec2022".into()), ("mode".into(), "crc16".into()), ("pd".into(), "1".into())],
        variant: VariantInfo {
            edition: "iec2022".into(),
            mode: "crc16".into(),
            pd_out: 1,
            pd_in: 1,
            leading_octet: false,
        },
        requirements: vec![RequirementRef {
            id: "R-11.5.4.1-01".into(),
            clause: "11.5.4.1".into(),
            level: "shall".into(),
        }],
        verdict: Verdict::Pass,
        execution: Execution::Ok,
        reasons: Vec::new(),
        tolerances: BTreeMap::new(),
        open: Vec::new(),
        transitions: BTreeMap::from([("T21".into(), 1), ("T22".into(), 2)]),
        walked: Walked::default(),
        start: "waiting".into(),
        steps: vec![
            StepRecord {
                text: "start: waiting".into(),
                activities: Vec::new(),
                executed: true,
                entries: (0, 1),
                checks: Vec::new(),
            },
            StepRecord {
                text: "exchange: {MCount: 1}".into(),
                activities: Vec::new(),
                executed: true,
                entries: (1, 3),
                checks: vec![Check { key: "DCount_i".into(), expected: "6".into(), observed: "6".into(), met: true }],
            },
        ],
        measurements: Vec::new(),
        trace: vec![
            Entry { at: 0, count: 1, what: What::Power { on: true }, via: Vec::new(), note: String::new() },
            exchange(1, "0001029D56", "A5FEE46AF6", &["T20", "T21", "T22", "T23"], ""),
            exchange(2, "5A01205727", "A5FEC41933", &["T24", "T22", "T23"], ""),
        ],
        elided: 0,
        duration_ns: 2_000_000,
        replay: "fsct run --seed 7 --filter 'FSD-0001[..]'".into(),
    }
}

pub fn reason(verdict: Verdict, kind: &str, observed: &str) -> Reason {
    Reason {
        verdict,
        kind: kind.into(),
        clause: "11.5.3 Table 40 T25".into(),
        step: 1,
        entry: Some(2),
        expected: "DCommErr 1 (after T24 T25 T26)".into(),
        observed: observed.into(),
    }
}

pub fn failed(number: usize) -> CaseRecord {
    let mut case = passed(number);
    case.verdict = Verdict::Fail;
    case.reasons.push(reason(Verdict::Fail, "oracle/DCommErr", "DCommErr 0"));
    case.trace[2] = exchange(2, "5A01205726", "A5FEC41933", &["T24", "T25", "T26"], "bit 39 inverted");
    case.steps[1].checks[0] = Check { key: "DCommErr".into(), expected: "1".into(), observed: "0".into(), met: false };
    case
}

pub fn remarked(number: usize) -> CaseRecord {
    let mut case = passed(number);
    case.verdict = Verdict::Remark;
    case.tolerances.insert("A19".into(), "tolerated: T29 read sequentially".into());
    case
}

pub fn inconclusive(number: usize) -> CaseRecord {
    let mut case = passed(number);
    case.verdict = Verdict::Inconclusive;
    case.reasons.push(reason(Verdict::Inconclusive, "oracle/signature/A02", "signature CC6D"));
    case
}

pub fn lost(number: usize, execution: Execution) -> CaseRecord {
    let mut case = inconclusive(number);
    case.execution = execution;
    case.reasons = vec![reason(Verdict::Inconclusive, "dut/timeout", "the DUT gave no complete answer within 2s")];
    case
}

pub fn not_applicable(number: usize) -> CaseRecord {
    let mut case = passed(number);
    case.verdict = Verdict::NotApplicable;
    case.reasons.push(reason(Verdict::NotApplicable, "dut/unserved", "`app` is not served"));
    case
}

/// An entry that is no exchange.
pub fn entry(at_ms: u64, what: What, via: &[&str]) -> Entry {
    Entry { what, ..exchange(at_ms, "", "", via, "") }
}

/// Something that happened on a port.
pub fn on_port(at_ms: u64, port: u8, dut: bool, text: &str) -> Entry {
    entry(at_ms, What::Port { port, dut, text: text.into() }, &[])
}

/// A case of the second DUT of [`both`]: a port start, an exchange, a request through the SMI, and OSSDe on another port.
pub fn mastered(number: usize) -> CaseRecord {
    let smi = What::Smi {
        request: "SMI_FSMasterAccess port 0 01000000000000000000".into(),
        result: "Result(+) 01010000000100000002".into(),
    };
    let qualifier = What::Service { port: 2, service: "qualifier".into(), value: "01".into() };
    CaseRecord {
        key: format!("FSM-{number:04}[edition=iec2022,mode=crc16,pd=1]"),
        id: format!("FSM-{number:04}"),
        suite: "master-startup".into(),
        dut: 1,
        role: "master".into(),
        verdict: Verdict::Fail,
        reasons: vec![Reason { entry: Some(8), ..reason(Verdict::Fail, "expect/qualifier", "qualifier 1") }],
        transitions: BTreeMap::from([("T1".into(), 1), ("OSSDe T1".into(), 1), ("OSSDe T3".into(), 2)]),
        steps: Vec::new(),
        measurements: Vec::new(),
        trace: vec![
            on_port(0, 1, false, "Device connected: VendorID 0x0001, DeviceID 0x000002, COM3, 6 octets in, 6 out"),
            on_port(0, 1, true, "L+ on"),
            on_port(1, 1, true, "wake-up pulse"),
            on_port(2, 1, true, "writes 0x4202.0 = 00"),
            on_port(2, 1, false, "the Device answers: written"),
            exchange(3, "A5FEE46AF6", "0001029D56", &["T1"], ""),
            entry(4, smi, &[]),
            Entry { via: vec!["OSSDe T1".into(), "OSSDe T3".into()], ..on_port(5, 2, false, "I/Q driven low") },
            entry(5, qualifier, &["OSSDe T3"]),
        ],
        ..passed(number)
    }
}

/// A run that judged an FS-Device and an FS-Master.
pub fn both() -> Run {
    let mut run = run(vec![passed(1), failed(2), mastered(3)]);
    run.header.duts.push(gateway());
    run
}

/// A case with a long trace: lost and repeated exchanges, a fault near the end.
pub fn long(number: usize, entries: u64) -> CaseRecord {
    let mut case = failed(number);
    case.trace = (0..entries).map(|at| exchange(at, "5A01205727", "A5FEC41933", &["T24", "T22", "T23"], "")).collect();
    case.trace[0].count = 12;
    case.trace[1].what = What::Exchange { port: 1, sent: None, got: Some("A5FEC41933".into()) };
    case.steps[0].entries = (0, 1);
    case.steps[1].entries = (1, entries as usize);
    case.reasons[0].entry = Some(entries as usize - 2);
    case
}

pub fn hostile(number: usize) -> CaseRecord {
    let mut case = failed(number);
    case.reasons[0].observed = HOSTILE.into();
    case.title = HOSTILE.into();
    case.steps[1].text = HOSTILE.into();
    case.steps[1].checks[0].observed = HOSTILE.into();
    case.trace[2].note = HOSTILE.into();
    case.trace[2].via.push(HOSTILE.into());
    case.trace[0].what = What::Acyclic { request: HOSTILE.into(), answer: HOSTILE.into() };
    case.trace.push(on_port(3, 2, true, HOSTILE));
    case.trace.push(Entry { note: HOSTILE.into(), ..on_port(3, 1, false, HOSTILE) });
    case.trace.push(entry(3, What::Smi { request: HOSTILE.into(), result: HOSTILE.into() }, &[HOSTILE]));
    case.transitions.insert(HOSTILE.into(), 1);
    case.tolerances.insert(HOSTILE.into(), HOSTILE.into());
    case
}

pub fn run(cases: Vec<CaseRecord>) -> Run {
    let footer = Footer { cases: cases.len(), interrupted: false };
    Run { header: header(cases.len()), cases, footer: Some(footer), damaged: None }
}

/// A folder of its own for a test, gone when the test ends.
pub struct Folder(pub PathBuf);

impl Folder {
    pub fn new(name: &str) -> Folder {
        let path = std::env::temp_dir().join(format!("fsct-reports-{}-{name}", std::process::id()));
        std::fs::create_dir_all(&path).expect("the folder for temporary files can be written");
        Folder(path)
    }

    pub fn with(name: &str, run: &Run) -> Folder {
        let folder = Folder::new(name);
        let mut journal = Journal::create(&folder.0).expect("it can be written");
        journal.header(&run.header).expect("it can be written");
        run.cases.iter().for_each(|case| journal.case(case).expect("it can be written"));
        if let Some(footer) = &run.footer {
            journal.footer(footer).expect("it can be written");
        }
        folder
    }

    pub fn text(&self, name: &str) -> String {
        std::fs::read_to_string(self.0.join(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

pub fn everything() -> Run {
    run(vec![passed(1), failed(2), remarked(3), inconclusive(4), lost(5, Execution::Timeout)])
}
