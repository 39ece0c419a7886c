//! A DUT in operation with a conformant partner, and the actions carried out on it.

use super::action::{Action, Script, from_hex};
use super::finding::{Finding, Halt, Record};
use crate::campaign::{Bench, setup};
use crate::case::model::{From, Operator};
use crate::channel::Channel;
use crate::engine::{Engine, Judging};
use crate::library::Library;
use crate::oracle::{Mask, Setup};
use crate::partner::Partner;
use crate::profile::Profile;
use crate::session::Session;
use crate::tester::Tester;
use fsct_adapters::{Octets, Pco, Role, Service, Variant};
use fsct_protocol::spdu::{Pd, View, Wire, inv3, succ};
use fsct_reports::campaign::Counts;
use fsct_reports::record::{Execution, Verdict};
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::SeedableRng;
use std::cell::Cell;
use std::collections::{BTreeMap, VecDeque};
use std::sync::atomic::AtomicBool;

/// SPDUs remembered for repetition.
const REMEMBERED: usize = 16;
/// SCL cycles in which operation has to be back, beside two watchdogs (R-11.5.3-22, R-11.5.2-26).
const LIVENESS_CYCLES: u64 = 8;

/// What a campaign judges by.
#[derive(Copy, Clone)]
pub struct Target<'t> {
    /// Start conditions and tolerances.
    pub library: &'t Library,
    /// Profile in force.
    pub profile: &'t Profile,
    /// Tolerances in force.
    pub allowed: Mask,
    /// Set when the user asks to stop.
    pub interrupted: &'t AtomicBool,
}

/// What was done to a DUT.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Tally {
    /// Exchanges.
    pub exchanges: u64,
    /// Faults by class.
    pub faults: BTreeMap<&'static str, Counts>,
}

impl Tally {
    /// Adds another.
    pub fn add(&mut self, other: &Tally) {
        self.exchanges += other.exchanges;
        other.faults.iter().for_each(|(class, counts)| self.faults.entry(class).or_default().add(*counts));
    }

    /// All classes together.
    pub fn sum(&self) -> Counts {
        let mut sum = Counts::default();
        self.faults.values().for_each(|counts| sum.add(*counts));
        sum
    }
}

/// What came of a list of actions.
#[derive(Debug)]
pub struct Ran {
    /// What was done.
    pub tally: Tally,
    /// Why it did not come to its end, with the position of the action as in [`Record`].
    pub halt: Option<(usize, Halt)>,
    /// Record of a failure: for the file, and for the terminal.
    pub record: Option<(String, String)>,
}

impl Target<'_> {
    /// What the oracle of the first port is told.
    pub fn setup(&self, bench: &Bench, variant: Variant) -> Option<Setup> {
        setup(self.profile, self.allowed, &bench.description, variant, 0)
    }

    /// Switches the DUT on as this variant, brings it to operation, and hands it over.
    pub fn operate<R>(
        &self,
        bench: &mut Bench,
        variant: Variant,
        seed: u64,
        work: impl FnOnce(&mut Session<'_>, &mut Tester) -> R,
        ended: impl FnOnce(&mut Session<'_>),
    ) -> Result<R, Halt> {
        bench.configure(variant).map_err(|error| Halt::Bench(error.to_string()))?;
        let setups: Vec<Setup> = (0..bench.description.ports)
            .map_while(|index| setup(self.profile, self.allowed, &bench.description, variant, index))
            .collect();
        if setups.is_empty() {
            return Err(Halt::Bench("the DUT has no ports".to_owned()));
        }
        let rng = |port: u64| Pcg64Mcg::seed_from_u64(seed ^ port);
        let testers = (0..).zip(&setups).map(|(index, setup)| Tester::new(setup, rng(index))).collect();
        let mut problems = Vec::new();
        let start = self.library.start_steps(self.profile.role, "operate", &mut problems);
        if start.is_empty() || !problems.is_empty() {
            return Err(Halt::Inconclusive("there is no sound start condition `operate`".to_owned()));
        }
        let Bench { dut, description, .. } = bench;
        let mut session = Session::new(dut.as_mut(), description, self.profile, setups, self.interrupted);
        let judging = Judging {
            limits: &self.library.limits.limits,
            clauses: String::new(),
            demands: true,
            shown: self.library.tolerances.shown(),
        };
        let (outcome, mut testers) = Engine::new(&mut session, testers, judging).reach(&start, "operate");
        let reason = outcome.reasons.first();
        let went = match outcome.execution {
            Execution::Ok if outcome.verdict <= Verdict::Remark => Ok(()),
            Execution::Ok => Err(Halt::not_started(reason, answers(&session))),
            Execution::Aborted => Err(Halt::Interrupted),
            _ => Err(Halt::Bench(format!(
                "the DUT did not reach operation: {}",
                reason.map_or("no answer", |reason| reason.observed.as_str())
            ))),
        };
        let result = match (went, testers.first_mut()) {
            (Ok(()), Some(tester)) => Ok(work(&mut session, tester)),
            (Err(halt), _) => Err(halt),
            (Ok(()), None) => Err(Halt::Bench("the DUT has no ports".to_owned())),
        };
        ended(&mut session);
        result
    }

    /// Carries a list of actions out. The DUT is switched on for it, so nothing before it matters.
    pub fn perform(&self, bench: &mut Bench, script: &Script) -> Ran {
        let mut tally = Tally::default();
        let mut at = 0;
        let mut trace = Vec::new();
        let passed = Cell::new(false);
        let went = self.operate(
            bench,
            script.variant,
            script.seed,
            |session, tester| {
                let mut stage = Stage::new(session, tester, &mut tally);
                at = script.actions.len() + 1;
                stage.recover()?;
                for (number, action) in (1..).zip(&script.actions) {
                    at = number;
                    stage.act(action)?;
                }
                at = script.actions.len() + 1;
                let back = stage.recover();
                passed.set(back.is_ok());
                back
            },
            // Only what failed is told: to put a trace into words takes as long as many exchanges.
            |session| {
                if !passed.get() {
                    trace = session.told().entries;
                }
            },
        );
        let halt = match went {
            Ok(Ok(())) => None,
            Ok(Err(halt)) | Err(halt) => Some((at, halt)),
        };
        let record = match (&halt, self.setup(bench, script.variant)) {
            (Some((at, Halt::Failure(finding))), Some(setup)) => {
                let record = Record::new(script, *at, finding, &trace, &setup);
                Some((record.to_json(), record.to_text()))
            }
            _ => None,
        };
        Ran { tally, halt, record }
    }
}

/// Octets from elsewhere as the link carries them: the length of its process data never changes.
fn fitting(other: &[u8], own: &Octets) -> Option<Octets> {
    let mut octets = other.to_vec();
    octets.resize(own.as_slice().len(), 0);
    Octets::new(&octets)
}

/// Whether what the DUT presents is an SPDU of its own at all.
fn answers(session: &Session<'_>) -> bool {
    let setup = session.setup();
    let own = if setup.role == Role::Device { setup.port.inverted() } else { setup.port.number() };
    session.answer().is_some_and(|view| view.signature_matches(setup.reading) && view.port_num() == own)
}

/// What an action led to, as the oracle followed it.
#[derive(Copy, Clone, Default)]
struct Effect {
    processed: bool,
    expired: bool,
}

/// A DUT in operation and its partner.
pub struct Stage<'s, 'd> {
    session: &'s mut Session<'d>,
    tester: &'s mut Tester,
    partner: Partner,
    tally: &'s mut Tally,
    delivered: VecDeque<Octets>,
}

impl<'s, 'd> Stage<'s, 'd> {
    /// The partner takes over.
    pub fn new(session: &'s mut Session<'d>, tester: &'s mut Tester, tally: &'s mut Tally) -> Self {
        let partner = Partner::new(From::Next, Operator::Acknowledges, session, tester);
        Stage { session, tester, partner, tally, delivered: VecDeque::new() }
    }

    /// Until both sides operate, in the time the standard gives a DUT for it.
    ///
    /// # Errors
    /// [`Halt`]: a failure when the DUT does not come back.
    pub fn recover(&mut self) -> Result<(), Halt> {
        if self.session.serves(Pco::App) {
            let service = if self.session.role() == Role::Device { Service::SdsetDs } else { Service::SetsdC };
            self.session.set(service, Octets::bit(false))?;
        }
        let profile = self.session.profile;
        let exchanges = (LIVENESS_CYCLES + 2) * (profile.answer_latency + 1)
            + 2 * profile.watchdog_ns().div_ceil(profile.master_cycle_time_ns);
        self.session.slipped = false;
        for _ in 0..exchanges {
            if self.partner.operates(self.session, self.tester) {
                return Ok(());
            }
            self.good()?;
        }
        if self.partner.operates(self.session, self.tester) {
            return Ok(());
        }
        if self.session.slipped {
            return Err(Halt::slipped("no operation within 8 SCL cycles plus 2 FSP_Watchdog"));
        }
        let clause = match self.session.role() {
            Role::Device => "11.5.3 (R-11.5.3-22)",
            Role::Master => "11.5.2 (R-11.5.2-26)",
        };
        Err(Halt::Failure(Box::new(Finding {
            kind: "liveness".to_owned(),
            clause: clause.to_owned(),
            expected: format!("operation within 8 SCL cycles plus 2 FSP_Watchdog ({exchanges} exchanges)"),
            observed: "no operation".to_owned(),
        })))
    }

    fn good(&mut self) -> Result<(), Halt> {
        let octets = self.partner.octets();
        self.exchange(octets).map(|_| ())
    }

    fn exchange(&mut self, octets: Option<Octets>) -> Result<Effect, Halt> {
        self.tally.exchanges += 1;
        self.partner.exchange_instead(&mut Channel::new(None, None), self.session, self.tester, octets)?;
        if let Some(octets) = octets
            && self.delivered.front() != Some(&octets)
        {
            self.delivered.truncate(REMEMBERED - 1);
            self.delivered.push_front(octets);
        }
        let via = self.session.link().oracle.via();
        let took = |numbers: &[u8]| via.iter().any(|number| numbers.contains(number));
        Ok(match self.session.role() {
            Role::Device => Effect { processed: took(&[21, 24, 27]), expired: took(&[30, 31]) },
            Role::Master => Effect { processed: took(&[3, 6, 10]), expired: took(&[8, 14]) },
        })
    }

    /// One SCL cycle, in which the answer has the time that the profile gives it.
    fn cycle(&mut self, octets: Option<Octets>) -> Result<Effect, Halt> {
        let mut effect = Effect::default();
        for _ in 0..=self.session.profile.answer_latency {
            let next = self.exchange(octets)?;
            effect.processed |= next.processed;
            effect.expired |= next.expired;
        }
        Ok(effect)
    }

    /// Carries one action out.
    ///
    /// # Errors
    /// [`Halt`] when the list cannot go on.
    pub fn act(&mut self, action: &Action) -> Result<(), Halt> {
        let Some(class) = action.class() else { return self.act_without_fault(action) };
        self.session.margin.announce(class.to_owned());
        let fresh = self.partner.octets();
        let octets = fresh.and_then(|octets| self.falsified(action, octets));
        let valid = octets.is_some_and(|octets| self.is_valid(&octets));
        let cycles = match action {
            Action::Lose(cycles) | Action::Delay(cycles) => *cycles,
            _ => 1,
        };
        let mut effect = Effect::default();
        let mut went = Ok(());
        for _ in 0..cycles {
            match self.cycle(octets) {
                Ok(next) => {
                    effect.processed |= next.processed;
                    effect.expired |= next.expired;
                }
                Err(halt) => {
                    went = Err(halt);
                    break;
                }
            }
        }
        let counts = self.tally.faults.entry(class).or_default();
        counts.injected += 1;
        match (&went, effect) {
            (Err(_), _) => counts.failed += 1,
            (_, Effect { expired: true, .. }) => counts.detected += 1,
            (_, Effect { processed: false, .. }) => counts.dropped += 1,
            _ if valid => counts.valid += 1,
            _ => counts.detected += 1,
        }
        went
    }

    fn act_without_fault(&mut self, action: &Action) -> Result<(), Halt> {
        match action {
            Action::Good(count) => {
                let length = self.session.setup().pd_in;
                if let Partner::Device(keeper, _) = &mut self.partner {
                    keeper.pdin = Pd::new(&self.tester.pattern(length)).unwrap_or(keeper.pdin);
                }
                (0..*count).try_for_each(|_| self.good())
            }
            Action::Set(service, value) if self.session.serves(Pco::App) => {
                let value = from_hex(value).and_then(|octets| Octets::new(&octets));
                match (Service::from_name(service), value) {
                    (Some(service), Some(value)) => Ok(self.session.set(service, value)?),
                    _ => Err(Halt::Bench(format!("the list sets `{service}` to what it cannot be"))),
                }
            }
            _ => Ok(()),
        }
    }

    /// The SPDU the partner would send, with the fault. `None`: nothing arrives.
    fn falsified(&mut self, action: &Action, mut octets: Octets) -> Option<Octets> {
        let setup = self.session.setup().clone();
        let view = View::new(octets.as_slice(), setup.mode, setup.sent_pd()).ok()?;
        let pd = Pd::new(view.pd())?;
        let plain = Wire { pd, port_num: setup.sent_port(), octet: view.octet(), signature: None };
        let wire = match action {
            Action::Corrupt(bits) => {
                let mut falsified = octets.as_slice().to_vec();
                for bit in bits.iter().map(|bit| usize::from(*bit)) {
                    if let Some(octet) = falsified.get_mut(bit / 8) {
                        *octet ^= 0x80 >> (bit % 8);
                    }
                }
                return Octets::new(&falsified);
            }
            Action::Lose(_) => return None,
            Action::Delay(_) => return self.delivered.front().copied().or(Some(octets)),
            Action::Repeat(back) => {
                let place = usize::from(*back).min(self.delivered.len().saturating_sub(1));
                return self.delivered.get(place).copied().or(Some(octets));
            }
            Action::Insert(digits) => {
                return from_hex(digits).and_then(|other| fitting(&other, &octets)).or(Some(octets));
            }
            Action::LoopBack => {
                let image = self.session.link().image;
                return image.and_then(|image| fitting(image.as_slice(), &octets)).or(Some(octets));
            }
            Action::Sequence(ahead) => {
                let from_master = setup.role == Role::Device;
                let count = if from_master { view.counter() } else { inv3(view.counter()) };
                let count = (0..*ahead).fold(count, |count, _| succ(count));
                let count = if from_master { count } else { inv3(count) };
                Wire { octet: count << 5 | (view.octet() & 0x1F), ..plain }
            }
            Action::Masquerade(flags) => {
                let legal = if setup.role == Role::Device { 0b11 } else { 0b111 };
                let pd = Pd::new(&self.tester.pattern(setup.sent_pd()))?;
                Wire { pd, octet: (view.octet() & 0xE0) | (flags & legal), ..plain }
            }
            Action::OtherPort(further) => {
                let number = setup.port.number().checked_add(*further).unwrap_or(setup.port.number() ^ 1).max(1);
                Wire { port_num: if setup.role == Role::Device { number } else { !number }, ..plain }
            }
            Action::Good(_) | Action::Set(..) => return Some(octets),
        };
        octets = Octets::new(wire.emit(setup.mode, setup.reading).octets())?;
        Some(octets)
    }

    /// Whether the DUT has to take these octets: right signature, PortNum and counter.
    fn is_valid(&self, octets: &Octets) -> bool {
        let setup = self.session.setup();
        let Ok(view) = View::new(octets.as_slice(), setup.mode, setup.sent_pd()) else { return false };
        let shown = self.session.answer().map(|answer| inv3(answer.counter()));
        let counted = match (setup.role, shown) {
            (_, None) => false,
            (Role::Device, Some(previous)) => view.counter() == 0 || view.counter() == succ(previous),
            (Role::Master, Some(expected)) => view.counter() == expected,
        };
        counted && view.port_num() == setup.sent_port() && view.signature_matches(setup.reading)
    }
}
