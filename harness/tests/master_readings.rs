//! The oracle against FS-Masters that read the open points of the standard in another way: what is tolerated is a remark
//! with its tolerance named, what locks up or restarts without acknowledgment fails.
//!
//! The FS-Masters here step the rows of Table 38 themselves, with one reading changed.

mod common;

use common::{library, run_with, story};
use fsct_adapters::{
    Clock, ClockKind, Description, Dut, DutError, Line, Mode, Observation, Octets, Pco, Role, Seen, Service, SmiResult,
    SmiService, Stimulus, Variant,
};
use fsct_harness::library::EVERYTHING;
use fsct_harness::plan::Selection;
use fsct_protocol::crc::Reading;
use fsct_protocol::scl::master::Answer;
use fsct_protocol::scl::{Master, State, Var};
use fsct_protocol::smi::FS_PORT_CONFIG_LIST;
use fsct_protocol::spdu::{OutSpdu, Pd, Port, Status, View};
use fsct_reports::record::{CaseRecord, Verdict};
use rstest::rstest;

/// How an FS-Master reads the standard.
#[derive(Copy, Clone, Debug, Default)]
struct Way {
    /// A05: an all-zero answer in state 7 with MCount 7 is judged.
    zero_judged: bool,
    /// A06: in state 7 the first foreign counter after a fault is looked at.
    one_foreign: bool,
    /// A06 "not old": in state 7 every counter but the previous one is looked at, and the previous one never.
    not_old: bool,
    /// A13: three SPDUs with SD go out before T11.
    three_sd: bool,
    /// A14: PDin_M is safe for one cycle more after T11.
    late_pdin: bool,
    /// A22: SDout while the FS-Device answers SDset 1.
    sdout: bool,
    /// A29: an error is found in an answer with the previous counter.
    old_errors_trip: bool,
    /// A fault is left without acknowledgment after ten good answers.
    impatient: bool,
    /// MTimer runs for a tenth longer than FSP_Watchdog.
    slow: bool,
}

struct TableMaster {
    way: Way,
    variant: Variant,
    now: u64,
    on: bool,
    list: Vec<u8>,
    operates: bool,
    scl: Option<Master>,
    deadline: Option<u64>,
    foreign: bool,
    sd: u8,
    good: u8,
    late: bool,
    sd_set: bool,
    pdout: Pd,
    pdin: Pd,
    ack: bool,
    set_sd: bool,
    /// Counter of the answer looked at last.
    last: Option<u8>,
}

const WATCHDOG_NS: u64 = 20_000_000;

impl TableMaster {
    fn new(way: Way) -> TableMaster {
        let variant = Variant { edition: EVERYTHING[0].edition, mode: EVERYTHING[0].mode, pd_out: 2, pd_in: 2 };
        TableMaster {
            way,
            variant,
            now: 0,
            on: false,
            list: Vec::new(),
            operates: false,
            scl: None,
            deadline: None,
            foreign: false,
            sd: 0,
            good: 0,
            late: false,
            sd_set: false,
            pdout: Pd::safe(2),
            pdin: Pd::safe(2),
            ack: false,
            set_sd: false,
            last: None,
        }
    }

    fn off(&mut self) {
        let (way, variant, now) = (self.way, self.variant, self.now);
        *self = TableMaster { variant, now, ..TableMaster::new(way) };
        (self.pdout, self.pdin) = (Pd::safe(variant.pd_out.into()), Pd::safe(variant.pd_in.into()));
    }

    fn restart(&mut self) {
        let late = if self.way.slow { WATCHDOG_NS / 4 } else { 0 };
        self.deadline = Some(self.now + WATCHDOG_NS + late);
    }

    fn expire(&mut self) {
        if let (Some(scl), Some(deadline)) = (&mut self.scl, self.deadline)
            && self.now >= deadline
            && scl.timer_runs()
        {
            scl.expire();
            self.sd = 1;
            self.restart();
        }
    }

    fn receive(&mut self, octets: &[u8]) {
        let (way, ack, set_sd) = (self.way, self.ack, self.set_sd);
        let Some(scl) = &mut self.scl else { return };
        let Ok(view) = View::new(octets, self.variant.mode, self.variant.pd_in.into()) else { return };
        let seven = scl.state() == State(7);
        let intact = view.signature_matches(Reading::Preset) && view.port_num() == 0xFE;
        let answer = match view.is_all_zero() {
            true if way.zero_judged && seven && scl.get(Var::Mcount) == 7 => {
                Answer { status: Status::default(), intact: false }
            }
            true => return,
            false => Answer { status: view.status(), intact },
        };
        let counter = answer.status.dcount_i;
        let old = self.last == Some(counter);
        let Some(scl) = &mut self.scl else { return };
        let takes = if way.not_old && seven { !old } else { scl.takes(counter) };
        let all_the_same = view.is_all_zero()
            || seven && way.one_foreign && !self.foreign
            || scl.state() == State(5) && !intact && way.old_errors_trip;
        if !takes && !all_the_same {
            return;
        }
        self.foreign |= seven && !takes;
        let held = way.three_sd && self.sd < 3 && scl.get(Var::ChFAckCe) == 1;
        scl.set_ch_f_ack_c(ack && !held);
        scl.set_set_sd_c(set_sd);
        if way.impatient && self.good >= 10 {
            scl.set_ch_f_ack_c(true);
        }
        let path = scl.process(answer);
        let taken = |number: u8| path.iter().any(|t| t.0 == number);
        let (regular, recovered, asked) = (taken(4) || taken(11), taken(11), taken(13));
        self.sd = if asked { self.sd + 1 } else { 1 };
        self.good = if asked { self.good + 1 } else { 0 };
        self.foreign &= !recovered;
        self.late = recovered && way.late_pdin;
        self.sd_set = answer.status.sd_set && regular;
        self.pdin = Pd::new(view.pd()).unwrap_or(Pd::safe(0));
        self.last = Some(counter);
        if self.scl.is_some_and(|scl| scl.timer_runs()) {
            self.restart();
        }
    }

    fn spdu(&self) -> Octets {
        let length = self.variant.mode.spdu_octets(self.variant.pd_out.into());
        let Some(scl) = self.scl else { return Octets::zero(length) };
        let live = scl.uses_pdout() && !(self.way.sdout && self.sd_set);
        let pd = if live { self.pdout } else { Pd::safe(self.variant.pd_out.into()) };
        let spdu = OutSpdu { pd, port: Port::ONE, control: scl.control() };
        Octets::new(spdu.wire().emit(self.variant.mode, Reading::Preset).octets()).expect("it fits")
    }

    fn report(&self, push: &mut dyn FnMut(Seen)) {
        let safe = Pd::safe(self.variant.pd_in.into());
        let (pdin, sdset, asked) = match &self.scl {
            None => (safe, true, false),
            Some(scl) => {
                let live = scl.get(Var::In) == 1 && !self.late;
                (
                    if live { self.pdin } else { safe },
                    scl.get(Var::SdsetS) == 1 || self.late,
                    scl.get(Var::ChFAckReqS) == 1,
                )
            }
        };
        let mut say = |service, value| push(Seen::Service { port: 1, service, value });
        say(Service::PdinM, Octets::new(pdin.octets()).expect("it fits"));
        say(Service::SdsetS, Octets::bit(sdset));
        say(Service::ChfackreqS, Octets::bit(asked));
        say(Service::Qualifier, Octets::bit(!sdset));
    }

    fn one(&mut self, stimulus: &Stimulus, push: &mut dyn FnMut(Seen)) {
        match stimulus {
            Stimulus::Configure(variant) => self.variant = *variant,
            Stimulus::Power(on) => {
                self.off();
                self.on = *on;
                self.report(push);
            }
            Stimulus::Set { service: Service::PdoutM, value, .. } => {
                self.pdout = Pd::new(value.as_slice()).expect("it fits");
            }
            Stimulus::Set { service: Service::ChfackC, value, .. } => self.ack = value.is_set(),
            Stimulus::Set { service: Service::SetsdC, value, .. } => self.set_sd = value.is_set(),
            Stimulus::Smi(request) => {
                if request.service == SmiService::PortConfiguration {
                    self.list = request.octets.clone();
                    (self.operates, self.scl) = (false, None);
                    push(Seen::Line { port: 1, line: Line::Power, level: true });
                }
                push(Seen::Smi(Box::new(SmiResult {
                    port: request.port,
                    client_id: request.client_id,
                    positive: true,
                    reference: 0,
                    length: 0,
                    octets: Vec::new(),
                })));
            }
            Stimulus::Drive { line: Line::Cq, level: false, .. } => {
                push(Seen::Line { port: 1, line: Line::WakeUp, level: true });
                push(Seen::Mode { port: 1, mode: Mode::Startup });
                push(Seen::Mode { port: 1, mode: Mode::Preoperate });
                let from = FS_PORT_CONFIG_LIST.field("FSP_Authenticity1").and_then(|f| f.offset(self.variant.edition));
                let record = self.list.get(from.expect("both have it")..).map(|rest| rest[..23].to_vec());
                push(Seen::Request { port: 1, index: 0x4202, subindex: 0, data: record });
            }
            Stimulus::Respond { .. } => {
                push(Seen::Mode { port: 1, mode: Mode::Operate });
                self.operates = true;
                // A Device that comes back finds the SCL where it was.
                self.scl.get_or_insert_with(|| {
                    let mut scl = Master::new();
                    scl.start();
                    scl
                });
                self.report(push);
            }
            Stimulus::Exchange { octets, .. } => {
                self.expire();
                if let Some(octets) = octets {
                    self.receive(octets.as_slice());
                }
                self.report(push);
                let octets = self.operates.then(|| self.spdu());
                push(Seen::Image { port: 1, octets });
            }
            Stimulus::Advance { ns } => {
                self.now += ns;
                self.expire();
            }
            Stimulus::Plug { device: None, .. } if self.operates => {
                self.operates = false;
                push(Seen::Mode { port: 1, mode: Mode::Inactive });
            }
            Stimulus::Set { .. } | Stimulus::Plug { .. } | Stimulus::Drive { .. } | Stimulus::Raise { .. } => {}
            _ => push(Seen::Unsupported),
        }
    }
}

impl Dut for TableMaster {
    fn hello(&mut self) -> Result<Description, DutError> {
        Ok(Description {
            role: Role::Master,
            ports: 1,
            pcos: Pco::ALL.to_vec(),
            offers: EVERYTHING.to_vec(),
            clock: Clock { kind: ClockKind::Virtual, resolution_ns: 1, uncertainty_ns: 0 },
            vendor: String::new(),
            product: String::new(),
            version: String::new(),
        })
    }

    fn apply(&mut self, stimuli: &[Stimulus], observed: &mut Vec<Observation>) -> Result<(), DutError> {
        for (position, stimulus) in (0..).zip(stimuli) {
            let mut seen = Vec::new();
            self.one(stimulus, &mut |what| seen.push(what));
            observed.extend(seen.into_iter().map(|seen| Observation { stimulus: position, at: self.now, seen }));
        }
        Ok(())
    }
}

fn judged(way: Way) -> Vec<CaseRecord> {
    let selection = Selection { suites: vec!["scl-master".into()], ..Selection::default() };
    // The value of FSP_Watchdog is fixed here, so the case that changes it does not apply.
    let cases = run_with(&library(), &selection, "reference-master", || Box::new(TableMaster::new(way)));
    cases.into_iter().filter(|case| case.id != "FSM-0309").collect()
}

fn of(cases: &[CaseRecord], verdict: Verdict) -> Vec<CaseRecord> {
    cases.iter().filter(|case| case.verdict == verdict).cloned().collect()
}

#[test]
fn the_rows_of_the_table_conform() {
    let cases = judged(Way::default());
    assert!(cases.len() > 700);
    let others: Vec<CaseRecord> = cases.into_iter().filter(|case| case.verdict != Verdict::Pass).collect();
    assert!(others.is_empty(), "{}", story(&others));
}

#[rstest]
#[case::a06("A06", Way { one_foreign: true, ..Way::default() })]
#[case::a14("A14", Way { late_pdin: true, ..Way::default() })]
#[case::a29("A29", Way { old_errors_trip: true, ..Way::default() })]
fn another_reading_is_let_pass_and_shown(#[case] tolerance: &str, #[case] way: Way) {
    let cases = judged(way);
    let failed = of(&cases, Verdict::Fail);
    assert!(failed.is_empty(), "{}", story(&failed));
    let shown: Vec<&CaseRecord> = cases.iter().filter(|case| case.tolerances.contains_key(tolerance)).collect();
    assert!(!shown.is_empty(), "{tolerance} was never made use of");
    assert!(shown.iter().all(|case| case.verdict >= Verdict::Remark));
}

#[rstest]
#[case::a05(Way { zero_judged: true, ..Way::default() })]
#[case::a22(Way { sdout: true, ..Way::default() })]
fn another_reading_is_let_pass(#[case] way: Way) {
    let failed = of(&judged(way), Verdict::Fail);
    assert!(failed.is_empty(), "{}", story(&failed));
}

#[test]
fn three_spdus_with_sd_before_the_acknowledgment_counts_are_let_pass_by_the_oracle() {
    let failed = of(&judged(Way { three_sd: true, ..Way::default() }), Verdict::Fail);
    let oracle = failed.iter().filter(|case| case.reasons.iter().any(|reason| reason.kind.starts_with("oracle/")));
    let oracle: Vec<CaseRecord> = oracle.cloned().collect();
    assert!(oracle.is_empty(), "{}", story(&oracle));
}

#[rstest]
#[case::not_old("11.5.2", Way { not_old: true, ..Way::default() })]
#[case::impatient("11.5.2 Table 38", Way { impatient: true, ..Way::default() })]
#[case::slow("11.5.5", Way { slow: true, ..Way::default() })]
fn what_locks_up_restarts_by_itself_or_is_late_fails(#[case] clause: &str, #[case] way: Way) {
    let failed = of(&judged(way), Verdict::Fail);
    assert!(!failed.is_empty());
    let named = failed.iter().flat_map(|case| &case.reasons).any(|reason| reason.clause.contains(clause));
    assert!(named, "{}", story(&failed[..failed.len().min(10)]));
}
