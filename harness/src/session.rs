//! One case's hold on the DUT: stimuli go out, observations come in, the oracle sees every exchange.

mod batch;

pub use batch::Item;

use crate::campaign::nanoseconds;
use crate::conditions::Sides;
use crate::link::Link;
use crate::oracle::{Mask, Mismatch, Setup};
use crate::profile::Profile;
use crate::trace::{Margin, Told, hex};
use crate::walk::Walked;
use fsct_adapters::{
    ClockKind, Description, Dut, DutError, Keep, Line, MADE_UP, Mode, Observation, Octets, Pco, Recorder, Role, Seen,
    Service, SmiRequest, SmiResult, Stimulus,
};
use fsct_protocol::spdu::View;
use std::collections::BTreeMap;
use std::fmt;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Exchanges sent in one go where the answers do not decide what comes next.
const BATCH: usize = 8_192;

/// The most time that passes at once where an FS-Device tells its lines.
const LINES_NS: u64 = 50_000_000;

/// Why a case went no further.
#[derive(Clone, Debug)]
pub enum Stop {
    /// The oracle has no explanation.
    Mismatch(Mismatch),
    /// The DUT gave no usable answer.
    Dut(DutError),
    /// The DUT does not serve what the case needs.
    Unserved(String),
    /// The user asked to stop.
    Interrupted,
}

impl From<DutError> for Stop {
    fn from(error: DutError) -> Stop {
        Stop::Dut(error)
    }
}

impl From<Mismatch> for Stop {
    fn from(mismatch: Mismatch) -> Stop {
        Stop::Mismatch(mismatch)
    }
}

/// The answer to a read or write.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Reply {
    /// Value read.
    Value(Vec<u8>),
    /// Written.
    Written,
    /// Refused with this ErrorType.
    Refused(u16),
    /// Not served.
    Unsupported,
}

impl fmt::Display for Reply {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Reply::Value(data) => f.write_str(&hex(data)),
            Reply::Written => f.write_str("written"),
            Reply::Refused(error) => write!(f, "refused 0x{error:04X}"),
            Reply::Unsupported => f.write_str("unsupported"),
        }
    }
}

/// The hold.
pub struct Session<'d> {
    dut: Recorder<&'d mut dyn Dut>,
    /// What the DUT says of itself.
    pub description: &'d Description,
    /// Profile in force.
    pub profile: &'d Profile,
    /// The ports of the DUT: one link each.
    pub links: Vec<Link>,
    /// The link the case is about at the moment.
    current: usize,
    /// What stands beside the recording.
    pub margin: Margin,
    /// The clock of the DUT when the case began, once it is known.
    zero: Option<u64>,
    /// On a real clock: an exchange reached the DUT more than half a MasterCycleTime later than planned, so what a case
    /// expects of its timing cannot be held against the DUT.
    pub slipped: bool,
    /// On a real clock: when the latest exchange was, and how long after it the next one is meant to be.
    planned: Option<(u64, u64)>,
    /// Time of the latest exchange, counted from the beginning of the case.
    pub last_exchange: u64,
    interrupted: &'d AtomicBool,
    /// Nanoseconds on the clock of the DUT.
    pub now: u64,
    /// The latest time stamp, counted from the beginning of the case.
    stamp: u64,
    /// Zero point and next due time of a real clock.
    pace: Option<(Instant, Instant)>,
    /// Answer to the latest read or write.
    pub reply: Option<Reply>,
    /// The latest request through the SMI, and its result.
    pub smi: Option<(SmiRequest, Option<SmiResult>)>,
    /// EventCodes seen since the step began, each with its EventQualifier.
    pub events: Vec<(u16, u8)>,
    observed: Vec<Observation>,
}

impl<'d> Session<'d> {
    /// A hold on a DUT without supply.
    pub fn new(
        dut: &'d mut dyn Dut,
        description: &'d Description,
        profile: &'d Profile,
        setups: Vec<Setup>,
        interrupted: &'d AtomicBool,
    ) -> Session<'d> {
        let links = (1..).zip(setups).map(|(port, setup)| Link::new(port, setup)).collect();
        let start = Instant::now();
        Session {
            dut: Recorder::new(dut, Keep::default()),
            description,
            profile,
            links,
            current: 0,
            margin: Margin::default(),
            zero: None,
            slipped: false,
            planned: None,
            last_exchange: 0,
            interrupted,
            now: 0,
            stamp: 0,
            pace: (description.clock.kind == ClockKind::Real).then_some((start, start)),
            reply: None,
            smi: None,
            events: Vec::new(),
            observed: Vec::new(),
        }
    }

    /// Whether the DUT serves a point of control and observation.
    pub fn serves(&self, pco: Pco) -> bool {
        self.description.pcos.contains(&pco)
    }

    /// Until when everything the DUT has done is known: on a real clock it tells what happened meanwhile with its next answer.
    pub fn told_until(&self) -> u64 {
        if self.pace.is_some() { self.stamp } else { self.now }
    }

    /// The link the case is about at the moment.
    pub fn link(&self) -> &Link {
        // There is one link at least, and `current` is one of them.
        &self.links[self.current]
    }

    /// The same, to be changed.
    pub fn link_mut(&mut self) -> &mut Link {
        &mut self.links[self.current]
    }

    /// Turns to another port; `false` when the DUT has no such port.
    pub fn turn_to(&mut self, port: u8) -> bool {
        let found = self.links.iter().position(|link| link.port == port);
        self.current = found.unwrap_or(self.current);
        found.is_some()
    }

    /// What the oracle of the link judges by.
    pub fn setup(&self) -> &Setup {
        self.link().oracle.setup()
    }

    /// Which side of the link the DUT is on.
    pub const fn role(&self) -> Role {
        self.description.role
    }

    /// Supply on or off.
    ///
    /// # Errors
    /// [`Stop`] when the case cannot go on.
    pub fn power(&mut self, on: bool) -> Result<(), Stop> {
        self.links.iter_mut().for_each(|link| link.power(on));
        self.apply(&[Stimulus::Power(on)])
    }

    /// Sets an input service of the application, on the link or (FSCP_Authenticity) for the whole DUT.
    ///
    /// # Errors
    /// [`Stop`] when the case cannot go on.
    pub fn set(&mut self, service: Service, value: Octets) -> Result<(), Stop> {
        self.link_mut().set(service, value);
        let port = if service == Service::FscpAuthenticity { 0 } else { self.link().port };
        self.apply(&[Stimulus::Set { port, service, value }])
    }

    /// Does something to a port; what it leads to stands in the link.
    ///
    /// # Errors
    /// [`Stop`] when the case cannot go on.
    pub fn act(&mut self, stimulus: Stimulus) -> Result<(), Stop> {
        self.apply(&[stimulus])
    }

    /// A request through the SMI; the result stands in `smi`.
    ///
    /// # Errors
    /// [`Stop`] when the case cannot go on.
    pub fn request(&mut self, request: SmiRequest) -> Result<(), Stop> {
        self.smi = Some((request.clone(), None));
        self.apply(&[Stimulus::Smi(Box::new(request))])
    }

    /// Time passes without an exchange on the link; other ports in operation go on.
    ///
    /// # Errors
    /// [`Stop`] when the case cannot go on.
    pub fn pass(&mut self, ns: u64) -> Result<(), Stop> {
        let until = self.now + ns;
        while self.now < until {
            let kept = self.kept();
            let rest = until - self.now;
            let part = match self.role() {
                _ if kept => rest.min(self.profile.master_cycle_time_ns),
                // Test pulses in between are as many observations, and those of one stimulus are bounded.
                Role::Device if self.serves(Pco::Line) => rest.min(LINES_NS),
                _ => rest,
            };
            let mut stimuli = Vec::new();
            if !self.wait_for_turn(part) {
                stimuli.push(Stimulus::Advance { ns: part });
            }
            self.keep(&mut stimuli);
            if stimuli.is_empty() {
                // On a real clock time passes by itself; what the DUT has done meanwhile comes with the next stimulus, and one
                // that does not exist does nothing else.
                stimuli.push(Stimulus::Other { kind: MADE_UP, octets: Vec::new() });
            }
            self.apply(&stimuli)?;
        }
        Ok(())
    }

    /// Whether a port other than the current one is in operation.
    fn kept(&self) -> bool {
        self.links.len() > 1 && (0..).zip(&self.links).any(|(index, link)| index != self.current && link.is_kept())
    }

    /// The exchanges of the other ports in operation.
    fn keep(&mut self, stimuli: &mut Vec<Stimulus>) {
        if self.kept() {
            let others = (0..).zip(&self.links).filter(|(index, link)| *index != self.current && link.is_kept());
            stimuli.extend(
                others.map(|(_, link)| Stimulus::Exchange { port: link.port, octets: link.whole(link.kept_octets()) }),
            );
        }
    }

    /// Reads or writes on-request data; the answer stands in `reply`.
    ///
    /// # Errors
    /// [`Stop`] when the case cannot go on.
    pub fn acyclic(&mut self, request: Stimulus) -> Result<(), Stop> {
        self.reply = None;
        self.apply(&[request])
    }

    /// One exchange one MasterCycleTime after the one before.
    ///
    /// # Errors
    /// [`Stop`] when the case cannot go on.
    pub fn exchange(&mut self, octets: Option<Octets>) -> Result<(), Stop> {
        self.exchange_after(self.profile.master_cycle_time_ns, octets)
    }

    /// One exchange this many nanoseconds after the one before.
    ///
    /// # Errors
    /// [`Stop`] when the case cannot go on.
    pub fn exchange_after(&mut self, ns: u64, octets: Option<Octets>) -> Result<(), Stop> {
        let exchange = Stimulus::Exchange { port: self.link().port, octets: self.link().whole(octets) };
        let paced = self.wait_for_turn(ns);
        if paced {
            self.planned = self.planned.map(|(last, _)| (last, ns));
        }
        match (paced, self.kept()) {
            (true, false) => self.apply(&[exchange]),
            (false, false) => self.apply(&[Stimulus::Advance { ns }, exchange]),
            (_, true) => {
                let mut stimuli = Vec::new();
                if !paced {
                    stimuli.push(Stimulus::Advance { ns });
                }
                stimuli.push(exchange);
                self.keep(&mut stimuli);
                self.apply(&stimuli)
            }
        }
    }

    /// Exchanges with the same octets until this time on the clock of the DUT, the last one exactly then.
    ///
    /// # Errors
    /// [`Stop`] when the case cannot go on.
    pub fn exchange_until(&mut self, until: u64, octets: Option<Octets>) -> Result<(), Stop> {
        let cycle = self.profile.master_cycle_time_ns;
        while self.now < until {
            if self.pace.is_some() || self.kept() {
                self.exchange_after(cycle.min(until - self.now), octets)?;
                continue;
            }
            let mut batch = Vec::with_capacity(2 * BATCH);
            let (port, octets) = (self.link().port, self.link().whole(octets));
            let mut at = self.now;
            while at < until && batch.len() < 2 * BATCH {
                let ns = cycle.min(until - at);
                at += ns;
                batch.push(Stimulus::Advance { ns });
                batch.push(Stimulus::Exchange { port, octets });
            }
            self.apply(&batch)?;
        }
        Ok(())
    }

    /// On a real clock: sleeps until the next exchange is due. `false` on a virtual one.
    fn wait_for_turn(&mut self, ns: u64) -> bool {
        let Some((zero, due)) = &mut self.pace else { return false };
        let now = Instant::now();
        *due += Duration::from_nanos(ns);
        match due.checked_duration_since(now) {
            Some(rest) => std::thread::sleep(rest),
            // Behind: go on from here instead of hurrying after.
            None => *due = now,
        }
        // When it was due and not when the answer came: an answer may be late that was given in time.
        self.now = nanoseconds(due.saturating_duration_since(*zero));
        true
    }

    fn apply(&mut self, stimuli: &[Stimulus]) -> Result<(), Stop> {
        if self.interrupted.load(Ordering::Relaxed) {
            return Err(Stop::Interrupted);
        }
        let mut observed = std::mem::take(&mut self.observed);
        observed.clear();
        let result = self.dut.apply(stimuli, &mut observed);
        let outcome = self.digest(stimuli, &observed);
        self.observed = observed;
        // What did come is looked at first: an error after a mismatch does not hide it.
        outcome?;
        result?;
        Ok(())
    }

    fn digest(&mut self, stimuli: &[Stimulus], observed: &[Observation]) -> Result<(), Stop> {
        let mut rest = observed;
        for (index, stimulus) in stimuli.iter().enumerate() {
            if let (Stimulus::Advance { ns }, None) = (stimulus, &self.pace) {
                self.now += ns;
            }
            self.drive(index, stimulus, rest);
            while let Some((observation, later)) = rest.split_first()
                && usize::from(observation.stimulus) == index
            {
                if self.links.iter().any(|link| link.ossde.is_some()) {
                    self.settle(observation.at.saturating_sub(self.zero.unwrap_or(0)))?;
                }
                rest = later;
                self.digest_one(stimulus, observation)?;
            }
        }
        if self.links.iter().any(|link| link.ossde.is_some()) {
            self.settle(u64::MAX)?;
        }
        Ok(())
    }

    /// What the tester does to a line, unless the DUT tells it, with its own time stamp.
    fn drive(&mut self, index: usize, stimulus: &Stimulus, observed: &[Observation]) {
        let (port, line, level) = match *stimulus {
            Stimulus::Drive { port, line, level } => (port, line, level),
            Stimulus::Power(level) if self.role() == Role::Device => (1, Line::Power, level),
            _ => return,
        };
        let told = observed.iter().take_while(|observation| usize::from(observation.stimulus) == index).any(
            |observation| matches!(observation.seen, Seen::Line { port: p, line: l, .. } if p == port && l == line),
        );
        let now = self.now;
        if let Some(link) = self.links.iter_mut().find(|link| link.port == port && !told) {
            link.lines.edge(now, line, level);
        }
    }

    fn digest_one(&mut self, stimulus: &Stimulus, observation: &Observation) -> Result<(), Stop> {
        let zero = *self.zero.get_or_insert(observation.at.saturating_sub(self.now));
        self.stamp = self.stamp.max(observation.at.saturating_sub(zero));
        let at = match &self.pace {
            // On a virtual clock the harness knows the time; stamps only tell when within an advance.
            None => self.now,
            // Counted from the beginning of the case, as everything a case waits for.
            Some(_) => observation.at.saturating_sub(zero),
        };
        match &observation.seen {
            Seen::Image { port, octets } => {
                let Stimulus::Exchange { octets: sent, .. } = stimulus else { return Ok(()) };
                let current = self.link().port == *port;
                let Some(link) = self.links.iter_mut().find(|link| link.port == *port) else { return Ok(()) };
                link.time(observation.at.saturating_sub(zero), *sent, *octets);
                let verdict = link.exchange(at, sent.as_ref(), *octets);
                let via = link.oracle.via();
                self.last_exchange = observation.at.saturating_sub(zero);
                if self.pace.is_some() && current {
                    let slack = self.profile.master_cycle_time_ns / 2;
                    self.slipped |= self.planned.is_some_and(|(last, ns)| at > last + ns + slack);
                    self.planned = Some((at, 0));
                }
                self.margin.exchange(observation.at, via, current);
                verdict?;
            }
            Seen::Service { port, service, value } => {
                if let Some(link) = self.links.iter_mut().find(|link| link.port == *port) {
                    link.report(*service, *value, observation.at.saturating_sub(zero));
                }
            }
            Seen::Mode { port, .. } | Seen::Request { port, .. } | Seen::Line { port, .. } => {
                match self.links.iter_mut().find(|link| link.port == *port) {
                    Some(link) => {
                        if let Seen::Line { line, level, .. } = observation.seen {
                            link.lines.edge(observation.at.saturating_sub(zero), line, level);
                        }
                        link.base(at, &observation.seen);
                    }
                    None => {
                        let what = format!("an observation on port {port}, of {} ports", self.links.len());
                        return Err(Stop::Dut(DutError::Contract { what }));
                    }
                }
            }
            Seen::Indication { code, qualifier, .. } => self.events.push((*code, *qualifier)),
            Seen::Smi(result) => {
                if let Some((_, slot)) = &mut self.smi {
                    *slot = Some((**result).clone());
                }
            }
            Seen::Value(data) => self.reply = Some(Reply::Value(data.clone())),
            Seen::Written => self.reply = Some(Reply::Written),
            Seen::Refused { error } => self.reply = Some(Reply::Refused(*error)),
            Seen::Event { code, qualifier } => self.events.push((*code, *qualifier)),
            Seen::Unsupported => match stimulus {
                Stimulus::Read { .. } | Stimulus::Write { .. } => self.reply = Some(Reply::Unsupported),
                Stimulus::Other { .. } | Stimulus::Smi(_) => {}
                // An FS-Master without an upper-level system; what needs one is a matter of the profile.
                Stimulus::Set { service: Service::FscpAuthenticity, .. } => {}
                other => return Err(Stop::Unserved(format!("the DUT does not serve {}", crate::trace::name(other)))),
            },
        }
        Ok(())
    }

    /// The answer to the latest read or write, in words.
    pub fn replied(&self) -> String {
        self.reply.as_ref().map_or_else(|| "no answer".to_owned(), Reply::to_string)
    }

    /// Entries recorded so far.
    pub fn recorded(&self) -> usize {
        self.dut.recording().len()
    }

    /// What crossed the boundary in this case.
    pub fn told(&mut self) -> Told {
        Told::new(&self.dut.take(), std::mem::take(&mut self.margin), self.zero.unwrap_or(0))
    }

    /// The image presented last, read as an SPDU; `None` when it is none, too short or all zero.
    pub fn answer(&self) -> Option<View<'_>> {
        self.link().answer()
    }

    /// Looks at what services of OSSDe ports have come to before this observation.
    fn settle(&mut self, upto: u64) -> Result<(), Stop> {
        for link in &mut self.links {
            link.settle(upto)?;
        }
        Ok(())
    }

    /// The mode an FS-Master commands on the link.
    pub fn mode(&self) -> Mode {
        self.link().mode
    }

    /// How often each transition was taken on any port, by the names of the record.
    pub fn taken(&mut self) -> BTreeMap<String, u64> {
        let (role, now) = (self.role(), self.told_until());
        let mut sum = BTreeMap::new();
        for link in &mut self.links {
            // Only a port with safety waits for a Ready pulse.
            let safety = role == Role::Device || link.is_safety();
            let lines = link.lines.taken(role, now).filter(|_| safety);
            let lines: Vec<_> = lines.map(|(number, count)| (format!("DL T{number}"), count)).collect();
            let scl = link.oracle.taken().into_iter().map(|(number, count)| (format!("T{number}"), count));
            let ossde = link.ossde_taken().map(|(number, count)| (format!("OSSDe T{number}"), count));
            scl.chain(ossde).chain(lines).for_each(|(name, count)| *sum.entry(name).or_default() += count);
        }
        sum
    }

    /// What followed what on any port.
    pub fn walked(&self) -> Walked {
        self.links.iter().fold(Walked::default(), |walked, link| walked.union(link.oracle.walked()))
    }

    /// Which way conditions decided on any port.
    pub fn sides(&self) -> Sides {
        self.links.iter().fold(Sides::NONE, |sides, link| sides.union(link.oracle.sides()))
    }

    /// Tolerances the DUT made use of on any port.
    pub fn used(&self) -> Mask {
        self.links.iter().fold(Mask::NONE, |mask, link| mask.union(link.oracle.used()))
    }
}
