//! Executes one case: start condition, steps, and the liveness check every case ends with.

mod gateway;
mod lines;
mod port;
mod reach;
mod storage;

use crate::case::model::*;
use crate::channel::Channel;
use crate::expect::{self, Before};
use crate::link::Link;
use crate::oracle::Mask;
use crate::parameterize;
use crate::partner::Partner;
use crate::profile::{Parameterization, Profile};
use crate::session::{Reply, Session, Stop};
use crate::stopwatch::Stopwatch;
use crate::tester::Tester;
use fsct_adapters::{DutError, Fault, Mode, Octets, Pco, Role, Service, Stimulus};
use fsct_lines::{Limits, Quantity};
use fsct_protocol::fsp::{INDEX_PROTOCOL, INDEX_VERIFY, Protocol};
use fsct_reports::measurement::Measurement;
use fsct_reports::record::{Execution, Reason, StepRecord, Verdict};

/// The bound of the liveness requirement (R-11.5.3-22): 8 SCL cycles plus 2 FSP_Watchdog.
const LIVENESS_SCL_CYCLES: u64 = 8;
/// Field of the verify record that the profile may declare.
const IO_STRUCT_CRC: &str = "FSP_IO_StructCRC";
/// How long an Event to a deviating verify record is waited for.
const EVENT_NS: u64 = 100_000_000;

/// What came of a case.
#[derive(Debug)]
pub struct Outcome {
    /// Conformance.
    pub verdict: Verdict,
    /// Execution.
    pub execution: Execution,
    /// Why.
    pub reasons: Vec<Reason>,
    /// When the exchange behind each reason was, counted from the beginning of the case.
    pub shown_at: Vec<u64>,
    /// Steps as executed.
    pub steps: Vec<StepRecord>,
    /// Values measured.
    pub measurements: Vec<Measurement>,
    /// The DUT was lost: the connection is of no further use.
    pub lost: bool,
}

/// How the expectations of a case weigh.
#[derive(Clone, Debug)]
pub struct Judging<'l> {
    /// Limits of measured values.
    pub limits: &'l Limits,
    /// Clauses of the requirements the case judges.
    pub clauses: String,
    /// Whether failing an expectation fails the case, or is a remark because nothing it judges is demanded.
    pub demands: bool,
    /// Tolerances whose use is shown as a remark.
    pub shown: Mask,
}

/// A case on its way.
pub struct Engine<'s, 'd> {
    session: &'s mut Session<'d>,
    /// One for each link.
    testers: Vec<Tester>,
    outcome: Outcome,
    judging: Judging<'s>,
    checks: usize,
    step: usize,
    /// Octets without safety relevance in and out, as configured last.
    nsr: (u8, u8),
    /// The Data Storage set that was copied last: Index, Subindex, value.
    set: Vec<(u16, u8, Vec<u8>)>,
    /// ClientID of the latest SMI request.
    client: u16,
}

impl<'s, 'd> Engine<'s, 'd> {
    /// Ready to begin.
    pub fn new(session: &'s mut Session<'d>, testers: Vec<Tester>, judging: Judging<'s>) -> Engine<'s, 'd> {
        let outcome = Outcome {
            verdict: Verdict::Pass,
            execution: Execution::Ok,
            reasons: Vec::new(),
            shown_at: Vec::new(),
            steps: Vec::new(),
            measurements: Vec::new(),
            lost: false,
        };
        Engine { session, testers, outcome, judging, checks: 0, step: 0, nsr: (0, 0), set: Vec::new(), client: 0 }
    }

    /// Runs start condition, steps and liveness check.
    pub fn run(mut self, start: &[Step], start_name: &str, steps: &[Step]) -> Outcome {
        let timed =
            |wanted: &Wanted| matches!(wanted, Wanted::Quantity(Quantity::DeviceWatchdog | Quantity::MasterWatchdog));
        if steps.iter().flat_map(|step| &step.measure).any(timed) {
            self.session.links.iter_mut().for_each(|link| link.stopwatch = Some(Stopwatch::default()));
        }
        let name = format!("start: {start_name}");
        let liveness = match self.session.role() {
            Role::Device => "liveness: a conformant FS-Master restores operation".to_owned(),
            Role::Master => "liveness: a conformant FS-Device and an operator restore operation".to_owned(),
        };
        let went = self.block(name, Vec::new(), |engine| engine.start(start)).and_then(|()| {
            for (index, step) in steps.iter().enumerate() {
                self.step = index + 1;
                self.block(step.text.clone(), step.activities.clone(), |engine| engine.step(step))?;
            }
            self.step = steps.len() + 1;
            self.block(liveness, Vec::new(), Engine::liveness)
        });
        if let Err(Stopped) = went {
            for step in steps.iter().skip(self.outcome.steps.len().saturating_sub(1)) {
                let (text, activities) = (step.text.clone(), step.activities.clone());
                let record = StepRecord { text, activities, executed: false, entries: (0, 0), checks: Vec::new() };
                self.outcome.steps.push(record);
            }
        }
        if self.checks == 0 && self.outcome.verdict == Verdict::Pass {
            self.reason(Verdict::Inconclusive, "nothing-checked", "", "at least one expectation judged", "none");
        }
        self.outcome
    }

    fn block(
        &mut self,
        text: String,
        activities: Vec<u16>,
        action: impl FnOnce(&mut Engine<'s, 'd>) -> Result<(), Stop>,
    ) -> Result<(), Stopped> {
        let first = self.session.recorded();
        let entries = (first, first);
        self.outcome.steps.push(StepRecord { text, activities, executed: true, entries, checks: Vec::new() });
        self.session.events.clear();
        self.session.links.iter_mut().for_each(Link::begin);
        let result = action(self);
        if let Some(record) = self.outcome.steps.last_mut() {
            record.entries.1 = self.session.recorded();
        }
        match result {
            Ok(()) if self.outcome.verdict == Verdict::Fail => Err(Stopped),
            Ok(()) => Ok(()),
            Err(stop) => {
                self.stopped(stop);
                Err(Stopped)
            }
        }
    }

    fn stopped(&mut self, stop: Stop) {
        match stop {
            Stop::Mismatch(found) => {
                let kind = format!("oracle/{}", found.kind);
                let clause = match self.step {
                    0 => found.clause,
                    _ => format!("{}; the case judges {}", found.clause, self.judging.clauses),
                };
                self.reason(found.verdict, &kind, &clause, &found.expected, &found.observed);
            }
            Stop::Unserved(what) => {
                self.outcome.execution = Execution::DutError;
                self.reason(Verdict::Inconclusive, "dut/unserved", "", "everything the DUT says it serves", &what);
            }
            Stop::Slipped(expected, observed) => {
                self.reason(Verdict::Inconclusive, "bench/slipped", "", &expected, &observed);
            }
            Stop::Interrupted => {
                self.outcome.execution = Execution::Aborted;
                self.reason(
                    Verdict::Inconclusive,
                    "interrupted",
                    "",
                    "the case runs to its end",
                    "stopped by the user",
                );
            }
            Stop::Dut(error) => {
                self.outcome.lost = true;
                let (execution, kind) = execution(&error);
                self.outcome.execution = execution;
                self.reason(Verdict::Inconclusive, kind, "", "an answer of the DUT", &error.to_string());
            }
        }
    }

    fn reason(&mut self, verdict: Verdict, kind: &str, clause: &str, expected: &str, observed: &str) {
        self.outcome.verdict = self.outcome.verdict.max(verdict);
        self.outcome.shown_at.push(self.session.last_exchange);
        self.outcome.reasons.push(Reason {
            verdict,
            kind: kind.to_owned(),
            clause: clause.to_owned(),
            step: self.step,
            entry: None,
            expected: expected.to_owned(),
            observed: observed.to_owned(),
        });
    }

    fn start(&mut self, steps: &[Step]) -> Result<(), Stop> {
        for step in steps {
            self.step(step)?;
            if self.outcome.verdict == Verdict::Fail {
                break;
            }
        }
        Ok(())
    }

    fn step(&mut self, step: &Step) -> Result<(), Stop> {
        self.turn_to(step.port)?;
        let before = Before::now(self.session);
        let reached = self.act(&step.action, &before)?;
        self.judge(&reached, &before, Verdict::Fail);
        self.judge(&step.expect, &before, Verdict::Fail);
        self.judge(&step.remark, &before, Verdict::Remark);
        self.measure(&step.measure);
        Ok(())
    }

    fn judge(&mut self, expectations: &[Expectation], before: &Before, verdict: Verdict) {
        for expectation in expectations {
            let Some(check) = expect::judge(expectation, before, self.session, self.tester()) else { continue };
            self.checks += 1;
            let weight = if self.judging.demands { verdict } else { Verdict::Remark };
            if !check.met
                && let Some(verdict) = self.weigh(expectation.key, weight)
            {
                let kind = format!("expect/{}", check.key);
                let text = |value: &str| format!("{} {value}", check.key);
                // A start condition is not what the case is about: there the clause is that of the field alone.
                let clause = match self.step {
                    0 => expectation.key.clause().to_owned(),
                    _ => format!("{} ({})", self.judging.clauses, expectation.key.clause()),
                };
                self.reason(verdict, &kind, &clause, &text(&check.expected), &text(&check.observed));
            }
            if let Some(record) = self.outcome.steps.last_mut() {
                record.checks.push(check);
            }
        }
    }

    /// What an expectation that is not met comes to. On a bench whose timing slipped it is inconclusive at most.
    ///
    /// Expectations are written for the default readings. Once the DUT has made use of a tolerance the oracle, which
    /// knows what else that allows, judges link and application alone: what a case expects there is a remark at most. Where
    /// the case alone judges that holds as long as such a reading explains everything seen.
    fn weigh(&self, key: Key, verdict: Verdict) -> Option<Verdict> {
        let link = self.session.link();
        let used = if link.unexplained { Mask::NONE } else { link.oracle.used() };
        // The oracle judges by the DUT's own time stamps; a case counts on its own timing.
        let verdict = if self.session.slipped { verdict.min(Verdict::Inconclusive) } else { verdict };
        match key {
            key if !key.is_the_oracles() => Some(verdict),
            _ if used.is_empty() => Some(verdict),
            _ if used.iter().any(|number| self.judging.shown.has(number)) => Some(Verdict::Remark),
            _ => None,
        }
    }

    /// Carries an action out; expectations of an `until` that was not reached come back to be judged.
    fn act(&mut self, action: &Action, before: &Before) -> Result<Vec<Expectation>, Stop> {
        match action {
            Action::Exchange(exchange) => return self.exchanges(exchange, before),
            Action::Wait(wait) => self.wait(wait)?,
            Action::Partner(partner) => return self.partner(partner, before),
            Action::Power(on) => self.power(*on)?,
            Action::Parameterize(asked) => self.parameterize(asked)?,
            Action::Write { index, subindex, data } => {
                self.acyclic(Stimulus::Write { index: *index, subindex: *subindex, data: data.clone() })?;
            }
            Action::Read { index, subindex } => {
                self.acyclic(Stimulus::Read { index: *index, subindex: *subindex })?;
            }
            Action::DataStorage(way) => self.copy(*way)?,
            Action::Technology(other) => self.technology(*other)?,
            Action::App(set) => self.app(set)?,
            Action::Configure(configure) => self.configure(configure)?,
            Action::Connect(connect) => self.connect(connect)?,
            Action::Unplug => self.unplug()?,
            Action::Smi(smi) => self.smi(smi)?,
            Action::Drive(levels) => self.drive(levels)?,
            Action::Pass { time, after } => {
                if let Some(after) = after
                    && self.await_lines(*after)?.is_none()
                {
                    self.overdue(*after);
                }
                let ns = self.nanoseconds(*time).unsigned_abs();
                self.session.pass(ns)?;
            }
            Action::Wake(wake) => self.wake(wake)?,
            Action::Raise { code, qualifier } => {
                let port = self.session.link().port;
                self.session.act(Stimulus::Raise { port, code: *code, qualifier: *qualifier })?;
            }
            Action::Look => {}
        }
        Ok(Vec::new())
    }

    fn exchanges(&mut self, exchange: &Exchange, before: &Before) -> Result<Vec<Expectation>, Stop> {
        if exchange.until.is_empty() {
            for _ in 0..exchange.times {
                self.scl_cycle(exchange)?;
            }
            return Ok(Vec::new());
        }
        for _ in 0..exchange.within {
            self.scl_cycle(exchange)?;
            if self.hold(&exchange.until, before) {
                break;
            }
        }
        Ok(exchange.until.clone())
    }

    fn hold(&self, expectations: &[Expectation], before: &Before) -> bool {
        expectations
            .iter()
            .filter_map(|expectation| expect::judge(expectation, before, self.session, self.tester()))
            .all(|check| check.met)
    }

    /// One SCL cycle: the SPDU goes out in every exchange until it is answered.
    fn scl_cycle(&mut self, exchange: &Exchange) -> Result<(), Stop> {
        let echo = self.session.link().image;
        let shown = self.session.answer().map(|view| view.counter());
        let shown = shown.filter(|_| self.session.role() == Role::Master);
        if let Image::Ago(count) = exchange.image
            && self.tester().ago(count).is_none()
        {
            let observed = "no such SPDU was sent";
            self.reason(Verdict::Inconclusive, "case/ago", "", &format!("an SPDU sent {count} ago"), observed);
        }
        let (octets, note) = self.tester_mut().build(exchange, echo, shown);
        self.session.margin.announce(note);
        let started = self.session.now + self.session.profile.master_cycle_time_ns;
        if exchange.image == Image::Spdu && exchange.count != Count::Same {
            self.tester_mut().first_copy = started;
        }
        if let Some(repeat) = exchange.repeat {
            for _ in 0..repeat {
                self.session.exchange(octets)?;
            }
            return Ok(());
        }
        // The black channel repeats the SPDU until the answer mirrors it: for as long as the latency of the profile, and
        // while the SCL may still be starting (11.5.4.3), which it shows by nothing but an answer to something.
        let awaited = octets.is_some_and(|octets| octets.as_slice().iter().any(|octet| *octet != 0));
        for sent in 0.. {
            let starting = awaited && self.session.link().oracle.may_be_starting();
            if starting && self.session.role() == Role::Device {
                // Only the copy that the started SCL takes is the first one; its answer may still be on its way.
                let Profile { answer_latency, master_cycle_time_ns, .. } = self.session.profile;
                let taken = self.session.now + master_cycle_time_ns;
                self.tester_mut().first_copy = taken.saturating_sub(answer_latency * master_cycle_time_ns);
            }
            self.session.exchange(octets)?;
            let counter = self.session.answer().map(|view| view.counter());
            let answered = exchange.image == Image::Spdu
                && counter.is_some()
                && match self.session.role() {
                    Role::Device => counter == self.tester().mirror(),
                    Role::Master => counter != shown,
                };
            let starting = awaited && self.session.link().oracle.may_be_starting();
            if answered || sent >= self.session.profile.answer_latency && !starting {
                break;
            }
        }
        Ok(())
    }

    fn wait(&mut self, wait: &Wait) -> Result<(), Stop> {
        let octets = match wait.link {
            Meanwhile::Repeat => self.tester().octets,
            Meanwhile::Lost => None,
            Meanwhile::Zero => self.tester().octets.map(|octets| Octets::zero(octets.as_slice().len())),
        };
        let until = self.tester().first_copy.saturating_add_signed(self.nanoseconds(wait.until));
        self.session.exchange_until(until, octets)?;
        // An FS-Master whose MTimer has expired has sent a new SPDU: the next wait counts from there.
        let changed = self.session.link().changed_at;
        if self.session.role() == Role::Master && changed > self.tester().first_copy {
            self.tester_mut().first_copy = changed;
        }
        Ok(())
    }

    fn nanoseconds(&self, duration: Duration) -> i64 {
        let profile = self.session.profile;
        // Late enough for an expiry to show, and one exchange more to see that it does not.
        let late =
            profile.margin_ns() as i64 + (profile.answer_latency as i64 + 1) * profile.master_cycle_time_ns as i64;
        let limit = duration.limit.and_then(|(times, quantity, end)| {
            let limit = self.judging.limits.get(quantity.symbol())?;
            let bounds = limit.bounds(self.session.setup().edition, |name| profile.declared(name))?;
            let bound = if end == End::Min { bounds.min } else { bounds.max };
            Some(times * i64::try_from(bound?).ok()?)
        });
        duration.watchdogs * profile.watchdog_ns() as i64
            + limit.unwrap_or(0)
            + duration.lates * profile.margin_ns() as i64
            + duration.cycles * profile.master_cycle_time_ns as i64
            + duration.margins * late
            + duration.guards * (profile.timer_tick_us * 1_000 + self.session.description.clock.uncertainty_ns) as i64
            + duration.ms * 1_000_000
            + duration.us * 1_000
    }

    fn partner(&mut self, wanted: &super::case::model::Partner, before: &Before) -> Result<Vec<Expectation>, Stop> {
        let exchanges = match wanted.within {
            Some(Within::SclCycles(cycles)) => u64::from(cycles) * (self.session.profile.answer_latency + 1),
            Some(Within::Time(duration)) => {
                self.nanoseconds(duration).unsigned_abs().div_ceil(self.session.profile.master_cycle_time_ns)
            }
            None => self.liveness_exchanges(),
        };
        let exchanges = if wanted.from == From::Start && wanted.within.is_some() {
            exchanges + self.starting_exchanges()
        } else {
            exchanges
        };
        let index = usize::from(self.session.link().port) - 1;
        let until = wanted.back_for.map(|duration| self.session.now.saturating_add_signed(self.nanoseconds(duration)));
        let mut back = Channel::new(wanted.back, until);
        let Some(tester) = self.testers.get_mut(index) else { return Ok(Vec::new()) };
        let mut partner = Partner::new(wanted.from, wanted.operator, self.session, tester);
        for _ in 0..exchanges {
            let Some(tester) = self.testers.get_mut(index) else { break };
            partner.exchange(&mut back, self.session, tester)?;
            let reached = match wanted.until.is_empty() {
                true => wanted.within.is_none() && partner.operates(self.session, self.tester()),
                false => self.hold(&wanted.until, before),
            };
            if reached {
                break;
            }
        }
        if wanted.until.is_empty() && wanted.within.is_none() {
            self.operating(&partner, exchanges);
        }
        Ok(wanted.until.clone())
    }

    fn operating(&mut self, partner: &Partner, exchanges: u64) {
        self.checks += 1;
        let met = partner.operates(self.session, self.tester());
        let expected = format!("operation within 8 SCL cycles plus 2 FSP_Watchdog ({exchanges} exchanges)");
        let observed = if met { "operation" } else { "no operation" };
        if !met {
            let clause = match self.session.role() {
                Role::Device => "11.5.3 (R-11.5.3-22)",
                Role::Master => "11.5.2 (R-11.5.2-26)",
            };
            let found = self.situation();
            self.reason(Verdict::Fail, "liveness", clause, &expected, &format!("no operation: {found}"));
        }
        if let Some(record) = self.outcome.steps.last_mut() {
            record.checks.push(fsct_reports::record::Check {
                key: "operation".to_owned(),
                expected,
                observed: observed.to_owned(),
                met,
            });
        }
    }

    fn situation(&self) -> String {
        let Some(view) = self.session.answer() else { return "no SPDU of the SCL".to_owned() };
        match self.session.role() {
            Role::Device => {
                let s = view.status();
                let bits = [s.sd_set, s.d_comm_err, s.d_timeout].map(u8::from);
                format!("DCount_i {} SDset {} DCommErr {} DTimeout {}", s.dcount_i, bits[0], bits[1], bits[2])
            }
            Role::Master => {
                let c = view.control();
                let app = &self.session.link().app;
                let bit = |value: Option<bool>| value.map_or("-", |value| if value { "1" } else { "0" });
                format!(
                    "MCount {} setSD {} ChFAckReq {} · SDset_S {} qualifier {}",
                    c.mcount,
                    u8::from(c.set_sd),
                    u8::from(c.ch_f_ack_req),
                    bit(app.sdset_s),
                    bit(app.qualifier)
                )
            }
        }
    }

    fn liveness_exchanges(&self) -> u64 {
        let profile = self.session.profile;
        LIVENESS_SCL_CYCLES * (profile.answer_latency + 1)
            + 2 * profile.watchdog_ns().div_ceil(profile.master_cycle_time_ns)
            + self.starting_exchanges()
    }

    /// What the SCL may take to start.
    fn starting_exchanges(&self) -> u64 {
        let profile = self.session.profile;
        profile.scl_start_ms * 1_000_000 / profile.master_cycle_time_ns
    }

    fn tester(&self) -> &Tester {
        // There is one for each link, and the session is at one of them.
        &self.testers[usize::from(self.session.link().port) - 1]
    }

    fn tester_mut(&mut self) -> &mut Tester {
        &mut self.testers[usize::from(self.session.link().port) - 1]
    }

    /// Every case ends here: the link is restored, a conformant partner takes over, an operator acknowledges, and the DUT has
    /// to operate. A DUT that is switched off or was never started is started first. So no case passes on a DUT that does
    /// nothing.
    fn liveness(&mut self) -> Result<(), Stop> {
        if self.session.profile.no_fs_port_mode {
            return self.gateway_lives();
        }
        let running = self.session.link().oracle.state().is_some()
            && (self.session.role() == Role::Device || self.session.mode() == Mode::Operate);
        if running {
            if self.session.serves(Pco::App) {
                let service = match self.session.role() {
                    Role::Device => Service::SdsetDs,
                    Role::Master => Service::SetsdC,
                };
                self.session.set(service, Octets::bit(false))?;
            }
        } else {
            if self.session.serves(Pco::Power) {
                self.power(false)?;
                self.power(true)?;
            }
            match self.session.role() {
                Role::Device => self.parameterize(&Parameterize::default())?,
                Role::Master => self.bring_up()?,
            }
            if self.outcome.verdict == Verdict::Fail {
                return Ok(());
            }
        }
        let from = if running && self.tester().count.is_some() { From::Next } else { From::Start };
        let wanted = super::case::model::Partner {
            from,
            operator: Operator::Acknowledges,
            back: None,
            back_for: None,
            until: Vec::new(),
            within: None,
        };
        self.partner(&wanted, &Before::default())?;
        Ok(())
    }

    fn power(&mut self, on: bool) -> Result<(), Stop> {
        self.testers.iter_mut().for_each(Tester::restart);
        if self.session.serves(Pco::Power) { self.session.power(on) } else { Ok(()) }
    }

    fn app(&mut self, set: &[(Service, Data)]) -> Result<(), Stop> {
        if !self.session.serves(Pco::App) {
            // Start conditions do without; a case that needs it is not planned.
            return Ok(());
        }
        for (service, data) in set {
            let value = match data {
                Data::Bit(bit) => Octets::bit(*bit),
                Data::Exactly(octets) if *service == Service::FscpAuthenticity => port::fscp_authenticity(octets),
                _ if *service == Service::FscpAuthenticity => self.own_authenticity(),
                data => {
                    let setup = self.session.setup();
                    // For a signature of 0 in the next answer: its PortNum and status octet are known.
                    let (trailer, length) = match setup.role {
                        Role::Device => {
                            let next = self.tester().count.map_or(0, fsct_protocol::spdu::succ);
                            ([setup.port.inverted(), fsct_protocol::spdu::inv3(next) << 5], setup.pd_in)
                        }
                        Role::Master => {
                            let next =
                                self.session.answer().map_or(0, |view| fsct_protocol::spdu::succ(view.counter()));
                            ([setup.port.number(), next << 5], setup.pd_out)
                        }
                    };
                    let mut octets = self.tester_mut().data(data, length, &trailer).octets().to_vec();
                    // A technology with this structure has nothing to put there.
                    if let Some(structure) = self.session.profile.structure
                        && *service == Service::PdinD
                        && structure.input.octets() == length
                    {
                        structure.input.clear_padding(&mut octets);
                    }
                    Octets::new(&octets).unwrap_or_default()
                }
            };
            self.session.set(*service, value)?;
        }
        Ok(())
    }

    fn acyclic(&mut self, request: Stimulus) -> Result<(), Stop> {
        if !self.session.serves(Pco::Acyclic) {
            return Err(Stop::Unserved("on-request data".to_owned()));
        }
        let verify = matches!(&request, Stimulus::Write { index: INDEX_VERIFY, .. });
        self.session.acyclic(request)?;
        if verify && self.session.reply == Some(Reply::Written) {
            let now = self.session.now;
            self.session.link_mut().oracle.parameterized(now);
        }
        Ok(())
    }

    fn parameterize(&mut self, asked: &Parameterize) -> Result<(), Stop> {
        let profile = self.session.profile;
        let now = self.session.now;
        self.tester_mut().first_copy = now;
        if profile.parameterization == Parameterization::None || !self.session.serves(Pco::Acyclic) {
            self.session.link_mut().oracle.parameterized(now);
            return Ok(());
        }
        let of_profile =
            |(field, value): &(&RecordField, Value)| field.name == IO_STRUCT_CRC && *value == Value::Profile;
        let declared = profile.structure.filter(|_| asked.set.iter().any(of_profile));
        let io_struct_crc = match declared.and_then(|structure| structure.signature(self.session.setup().mode)) {
            Some(computed) => computed,
            None => self.io_struct_crc()?,
        };
        for (index, data) in parameterize::records(profile, asked, self.session.setup().mode, io_struct_crc) {
            self.session.acyclic(Stimulus::Write { index, subindex: 0, data })?;
            let written = self.session.reply == Some(Reply::Written);
            if index == INDEX_VERIFY && asked.starts != Starts::Yes {
                // Taken with an Event or refused, and a product may take its time to raise it.
                self.session.pass(EVENT_NS)?;
                if asked.starts == Starts::Open {
                    // So far ahead that a start is never overdue.
                    self.session.link_mut().oracle.parameterized(u64::MAX / 2);
                }
            } else if !written {
                let expected = format!("record 0x{index:04X} written");
                let observed = self.session.replied();
                self.reason(Verdict::Inconclusive, "start/parameterization", "A.1 Table A.1", &expected, &observed);
                return Err(Stop::Unserved(format!("the write of record 0x{index:04X} was not carried out")));
            } else if index == INDEX_VERIFY {
                let now = self.session.now;
                self.session.link_mut().oracle.parameterized(now);
            }
        }
        Ok(())
    }

    /// FSP_IO_StructCRC is the maker's: the DUT tells it. The whole record is read, for a product need not serve its Subindices.
    fn io_struct_crc(&mut self) -> Result<u16, Stop> {
        self.acyclic(Stimulus::Read { index: INDEX_PROTOCOL, subindex: 0 })?;
        let told = match &self.session.reply {
            Some(Reply::Value(data)) => Protocol::fields(data).ok(),
            _ => None,
        };
        told.map(|protocol| protocol.io_struct_crc).ok_or_else(|| {
            let replied = self.session.replied();
            Stop::Unserved(format!("the protocol record 0x4201 with FSP_IO_StructCRC could not be read: {replied}"))
        })
    }
}

/// Marker: the case has come to its end early, the outcome says why.
struct Stopped;

/// The execution axis for an error of the DUT, with the kind of the reason.
pub fn execution(error: &DutError) -> (Execution, &'static str) {
    match (error, error.fault()) {
        (DutError::Timeout { .. }, _) => (Execution::Timeout, "dut/timeout"),
        (DutError::Line { .. }, _) => (Execution::RigError, "rig/line"),
        (_, Fault::Rig) => (Execution::RigError, "rig/unreachable"),
        _ => (Execution::DutError, "dut/contract"),
    }
}
