//! The oracle for one port of an FS-Master: Table 38 interpreted over everything a conformant product may be doing, the
//! services at the gateway included.

use super::config::{Config, Machine, Snapshot, Window};
use super::explain::{self, Mismatch, Words, data};
use super::set::{self, Set};
use super::setup::{App, Setup};
use super::{Mask, explain_master};
use crate::conditions::{self, OfMaster, Parts, Sides};
use fsct_adapters::{Octets, Role, Service};
use fsct_protocol::scl::master::Answer;
use fsct_protocol::scl::{Master, Path, State, T, Var};
use fsct_protocol::spdu::{Control, Pd, View};

/// SPDUs with SD that the text asks for after a fault (A13).
const SD_CYCLES: u8 = 3;

/// An SPDU of the FS-Master, and what its gateway services show with it.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Spdu {
    /// Exchange in which it was made.
    pub made: u64,
    /// `None` before the first SPDU: the image is all zero, or there is none.
    pub control: Option<Control>,
    /// Generations of PDout_M of which the SPDU may carry one; `None`: SDout.
    pub pdout: Option<(u32, u32)>,
    /// Tolerance in force by which SDout may be sent in place of PDout; 0: none.
    pub sdout: u8,
    /// PDin_M expected.
    pub pdin: Pd,
    /// SDset_S expected; the qualifier is GOOD when it is 0.
    pub sdset_s: bool,
    /// Tolerance in force by which PDin_M and SDset_S may still be those of the safe state; 0: none.
    pub late: u8,
    /// ChFAckReq_S expected.
    pub ch_f_ack_req_s: bool,
    /// Transitions that made it.
    pub path: Path,
}

impl Snapshot for Spdu {
    fn made(&self) -> u64 {
        self.made
    }

    fn set_made(&mut self, exchange: u64) {
        self.made = exchange;
    }

    fn path(&self) -> Path {
        self.path
    }

    fn looks_like(&self, other: &Spdu) -> bool {
        Spdu { made: 0, path: Path::default(), ..*self } == Spdu { made: 0, path: Path::default(), ..*other }
    }

    fn renew(&mut self, later: &Spdu) {
        self.path = later.path;
    }
}

/// Values an input service may have had since it was looked at last: bit 0 for 0, bit 1 for 1.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
struct Seen(u8);

impl Seen {
    const fn only(value: bool) -> Seen {
        Seen(1 << value as u8)
    }

    const fn and(self, value: bool) -> Seen {
        Seen(self.0 | 1 << value as u8)
    }

    fn values(self) -> impl Iterator<Item = bool> {
        [true, false].into_iter().filter(move |value| self.0 >> u8::from(*value) & 1 == 1)
    }
}

/// The machine of the tables with what a product may know besides.
#[derive(Copy, Clone, Debug, PartialEq)]
pub struct Port {
    /// Table 38.
    pub master: Master,
    ack: Seen,
    set_sd: Seen,
    /// SPDUs with SD sent since the latest fault.
    sd: u8,
    /// A foreign counter has been looked at in state 7 since the latest T11 (A06).
    foreign: bool,
}

impl Machine for Port {
    const FIRST: u8 = 1;
    const START: State = State(0);
    const ROLE: Role = Role::Master;

    fn state(&self) -> State {
        self.master.state()
    }

    fn erred(&self) -> bool {
        self.master.get(Var::Faults) == 1
    }
}

type MasterConfig = Config<Port, Spdu>;

#[derive(Copy, Clone, Debug, PartialEq, Eq)]
enum Phase {
    /// No supply: nothing is judged.
    Off,
    /// The preconditions of T1 are not fulfilled: no SPDU may come.
    Idle,
    /// They are since this time: states 1 and on.
    Ready { since: u64 },
}

/// What the DUT received, when it is no repetition of nothing.
#[derive(Copy, Clone)]
enum Incoming {
    Zero,
    Answer(Arrived),
}

/// An answer that is not all zero.
#[derive(Copy, Clone)]
struct Arrived {
    answer: Answer,
    /// `None` where no check was due.
    parts: Option<Parts>,
    pd: Pd,
}

/// The oracle of one port.
#[derive(Debug)]
pub struct MasterOracle {
    setup: Setup,
    phase: Phase,
    set: Set<Port, Spdu>,
    /// Values of PDout_M since power-on; the generation counts them.
    pdout: Vec<Pd>,
    ack: bool,
    set_sd: bool,
}

impl MasterOracle {
    /// For a DUT without supply.
    pub fn new(setup: Setup) -> MasterOracle {
        MasterOracle {
            pdout: vec![Pd::safe(setup.pd_out)],
            setup,
            phase: Phase::Off,
            set: Set::new(),
            ack: false,
            set_sd: false,
        }
    }

    /// What it judges by.
    pub const fn setup(&self) -> &Setup {
        &self.setup
    }

    /// Supply on or off. The machine of before is gone; its transitions and tolerances stay counted.
    pub fn power(&mut self, on: bool) {
        self.stop();
        self.pdout = vec![Pd::safe(self.setup.pd_out)];
        (self.ack, self.set_sd) = (false, false);
        self.phase = if on { Phase::Idle } else { Phase::Off };
    }

    /// The SCL instance is gone: supply off, or the port configured anew.
    pub fn stop(&mut self) {
        self.set.forget();
        if self.phase != Phase::Off {
            self.phase = Phase::Idle;
        }
    }

    /// The preconditions of T1 are fulfilled: the SCL may start. A running one goes on.
    pub fn parameterized(&mut self, at: u64) {
        if matches!(self.phase, Phase::Ready { .. }) {
            return;
        }
        self.phase = Phase::Ready { since: at };
        let safe = Pd::safe(self.setup.pd_in);
        let idle = Spdu {
            made: self.set.exchange,
            control: None,
            pdout: None,
            sdout: 0,
            pdin: safe,
            sdset_s: true,
            late: 0,
            ch_f_ack_req_s: false,
            path: Path::default(),
        };
        let (ack, set_sd) = (Seen::only(self.ack), Seen::only(self.set_sd));
        let port = Port { master: Master::new(), ack, set_sd, sd: 0, foreign: false };
        self.set.begin(port, idle, safe);
    }

    /// An input service of the gateway was set.
    pub fn input(&mut self, service: Service, value: &Octets) {
        match service {
            Service::PdoutM => self.pdout.extend(Pd::new(value.as_slice())),
            Service::ChfackC => {
                self.ack = value.is_set();
                self.set.machines().for_each(|port| port.ack = port.ack.and(value.is_set()));
            }
            Service::SetsdC => {
                self.set_sd = value.is_set();
                self.set.machines().for_each(|port| port.set_sd = port.set_sd.and(value.is_set()));
            }
            _ => {}
        }
    }

    /// One exchange: what the DUT received, the image it presented, and its services afterwards.
    ///
    /// # Errors
    /// The [`Mismatch`] when no configuration explains it.
    pub fn exchange(
        &mut self,
        at: u64,
        received: Option<&[u8]>,
        image: Option<&[u8]>,
        app: &App,
    ) -> Result<(), Mismatch> {
        self.set.exchange += 1;
        let image = image.filter(|octets| octets.iter().any(|octet| *octet != 0));
        match self.phase {
            Phase::Off => return Ok(()),
            Phase::Idle => {
                let verdict = self.idle(image, app);
                if verdict.is_ok() {
                    let mut sides = Sides::NONE;
                    sides.set(OfMaster::Started, false);
                    self.set.idle(sides);
                }
                return verdict;
            }
            Phase::Ready { .. } => {}
        }
        let incoming = received.and_then(|octets| self.read(octets));
        let (mut before, mut stepped) = self.set.open();
        for config in before.drain(..) {
            let expire = |config: &mut MasterConfig, window| self.expire(config, at, window);
            set::timed(config, at, expire, |config| self.receive(config, at, incoming, &mut stepped));
        }
        self.set.last_at = at;
        let verdict = self.observe(&mut stepped, image, app);
        self.set.close(before, stepped);
        verdict
    }

    fn idle(&self, image: Option<&[u8]>, app: &App) -> Result<(), Mismatch> {
        let fail = |kind, clause, expected, observed| Err(Mismatch::fail(kind, clause, expected, observed));
        let spdu =
            image.and_then(|octets| octets.get(..self.setup.mode.spdu_octets(self.setup.pd_out)).or(Some(octets)));
        if let Some(octets) = spdu.filter(|octets| octets.iter().any(|octet| *octet != 0)) {
            let expected = "no SPDU, or one of all zero: the preconditions of T1 are not fulfilled";
            return fail("idle", "11.5.2 Table 38 T1, 11.5.7", expected, explain::hex(octets));
        }
        if let Some(pdin) = app.pdin_m.filter(|pdin| pdin.as_slice().iter().any(|octet| *octet != 0)) {
            let expected = "PDin_M safe: the SCL has not been started";
            return fail("PDin_M", "11.3.2 Table 28, 11.5.2", expected, data(pdin.as_slice()));
        }
        match app.qualifier {
            Some(true) => {
                let expected = "qualifier BAD: the SCL has not been started";
                fail("qualifier", "11.11.4 Table 42", expected, "GOOD".to_owned())
            }
            _ => Ok(()),
        }
    }

    fn read(&self, octets: &[u8]) -> Option<Incoming> {
        let view = View::new(octets, self.setup.mode, self.setup.pd_in).ok()?;
        if view.is_all_zero() {
            return Some(Incoming::Zero);
        }
        let parts = Parts {
            signature: view.signature_matches(self.setup.reading),
            port_num: view.port_num() == self.setup.port.inverted(),
        };
        let answer = Answer { status: view.status(), intact: parts.signature && parts.port_num };
        Some(Incoming::Answer(Arrived { answer, parts: Some(parts), pd: Pd::new(view.pd())? }))
    }

    fn expire(&self, config: &mut MasterConfig, at: u64, window: Window) {
        let state = config.machine.master.state();
        let path = config.machine.master.expire();
        config.expired(state, self.setup.watchdog_again(window, self.set.last_at, at));
        config.machine.sd = 1;
        self.send(config, path, false);
    }

    fn receive(&self, mut config: MasterConfig, at: u64, incoming: Option<Incoming>, out: &mut Vec<MasterConfig>) {
        if config.machine.master.state() == State(0) {
            let Phase::Ready { since } = self.phase else { return };
            if at < since + self.setup.scl_start_ns {
                out.push(config);
            }
            let path = config.machine.master.start();
            config.sides.set(OfMaster::Started, true);
            self.send(&mut config, path, false);
            // What stood in the input image before the first SPDU may be looked at behind it (A30), or is gone by then.
            if let Some(Incoming::Answer(..)) = incoming {
                out.push(config);
            }
        }
        let state = config.machine.master.state();
        let arrived = match incoming {
            None => return out.push(config),
            Some(Incoming::Zero) => {
                if state == State(7) && config.machine.master.get(Var::Mcount) == 7 && self.allows(5) {
                    let zero = Answer { status: Default::default(), intact: false };
                    let arrived = Arrived { answer: zero, parts: None, pd: Pd::safe(self.setup.pd_in) };
                    self.check(with(config, 5), at, arrived, out);
                }
                config.sides = config.sides.union(conditions::left_alone_by_master(&config.machine.master, true));
                return out.push(config);
            }
            Some(Incoming::Answer(arrived)) => arrived,
        };
        if config.machine.master.takes(arrived.answer.status.dcount_i) {
            return self.check(config, at, arrived, out);
        }
        match state.0 {
            7 if self.allows(6) && !config.machine.foreign => {
                let mut looked = with(config, 6);
                looked.machine.foreign = true;
                self.check(looked, at, arrived, out);
            }
            5 if !arrived.answer.intact && self.allows(29) => self.check(with(config, 29), at, arrived, out),
            _ => {}
        }
        config.sides = config.sides.union(conditions::left_alone_by_master(&config.machine.master, false));
        out.push(config);
    }

    /// An answer is checked: one way for every value the inputs may have been seen at.
    fn check(&self, config: MasterConfig, at: u64, arrived: Arrived, out: &mut Vec<MasterConfig>) {
        let before = out.len();
        for ack in config.machine.ack.values() {
            for set_sd in config.machine.set_sd.values() {
                let way = self.checked(config, at, arrived, (ack, set_sd));
                let recovers = way.via.iter().any(|path| path.iter().any(|t| t == T(11)));
                if recovers && config.machine.sd < SD_CYCLES && self.allows(13) {
                    // The acknowledgment stays armed while three SPDUs with SD go out.
                    let mut waits = self.checked(with(config, 13), at, arrived, (false, set_sd));
                    waits.sides = config.sides;
                    out.push(waits);
                }
                if !out[before..].iter().any(|other| same(other, &way)) {
                    out.push(way);
                }
            }
        }
    }

    fn checked(&self, mut config: MasterConfig, at: u64, arrived: Arrived, seen: (bool, bool)) -> MasterConfig {
        let Arrived { answer, parts, pd } = arrived;
        let (ack, set_sd) = seen;
        let port = &mut config.machine;
        port.master.set_ch_f_ack_c(ack);
        port.master.set_set_sd_c(set_sd);
        let state = port.master.state();
        if let Some(parts) = parts.filter(|_| port.master.takes(answer.status.dcount_i)) {
            let decided = conditions::master(&port.master, answer, parts, self.setup.app);
            config.sides = config.sides.union(decided);
        }
        let path = port.master.process(answer);
        (port.ack, port.set_sd) = (Seen::only(self.ack), Seen::only(self.set_sd));
        let taken = |number| path.iter().any(|t| t == T(number));
        match (taken(13), taken(7) || taken(12), taken(11)) {
            (true, ..) => port.sd = (port.sd + 1).min(SD_CYCLES),
            (_, true, _) => port.sd = 1,
            (_, _, true) => port.foreign = false,
            _ => {}
        }
        config.received = pd;
        let window = config.machine.master.timer_runs().then(|| self.setup.watchdog(at, at));
        config.restart(state, window);
        self.send(&mut config, path, answer.status.sd_set);
        config
    }

    fn send(&self, config: &mut MasterConfig, path: Path, sd_set: bool) {
        config.took(path);
        let master = &config.machine.master;
        let is = |var| master.get(var) == 1;
        let newest = self.pdout.len().saturating_sub(1) as u32;
        let earlier = config.newest().pdout.map_or(newest.saturating_sub(1), |range| range.1);
        let recovered = path.iter().any(|t| t == T(11));
        let in_force = |number: u8| if self.allows(number) { number } else { 0 };
        let snapshot = Spdu {
            made: self.set.exchange,
            control: Some(master.control()),
            pdout: is(Var::Out).then_some((earlier.min(newest), newest)),
            sdout: if is(Var::Out) && sd_set { in_force(22) } else { 0 },
            pdin: if is(Var::In) { config.received } else { Pd::safe(self.setup.pd_in) },
            sdset_s: is(Var::SdsetS),
            late: if recovered && is(Var::In) { in_force(14) } else { 0 },
            ch_f_ack_req_s: is(Var::ChFAckReqS),
            path,
        };
        config.push(snapshot);
    }

    fn observe(&self, stepped: &mut Vec<MasterConfig>, image: Option<&[u8]>, app: &App) -> Result<(), Mismatch> {
        let malformed = image.and_then(|octets| explain::form(&self.setup, octets));
        let view = image.and_then(|octets| View::new(octets, self.setup.mode, self.setup.pd_out).ok());
        let link = |snapshot: &Spdu| match (&snapshot.control, image) {
            (None, None) => Some(Mask::NONE),
            (None, Some(_)) | (Some(_), None) => None,
            (Some(_), Some(_)) if malformed.is_some() => None,
            (Some(_), Some(_)) => self.explains(snapshot, view?),
        };
        let services = |snapshot: &Spdu| self.reported(snapshot, app);
        let tell = |configs: &[MasterConfig]| {
            let view = view.filter(|_| malformed.is_none());
            malformed.clone().unwrap_or_else(|| {
                let differences = |snap: &Spdu| {
                    explain_master::differences(&self.setup, snap, view, app, &self.pdout_texts(snap.pdout))
                };
                let timing = |config: &MasterConfig, snap: &Spdu, differences: &[explain::Difference]| {
                    explain_master::timing(self.set.exchange, config, snap, differences)
                };
                let words = Words { table: explain_master::TABLE, differences: &differences, timing: &timing };
                explain::nearest(configs, self.set.exchange, self.setup.latency, &words)
            })
        };
        self.set.observe(stepped, self.setup.latency, link, services, tell)
    }

    fn explains(&self, snapshot: &Spdu, view: View<'_>) -> Option<Mask> {
        if view.control() != snapshot.control? {
            return None;
        }
        let zero = view.pd().iter().all(|octet| *octet == 0);
        match snapshot.pdout {
            None => zero.then_some(Mask::NONE),
            // Without upper tester nobody knows what the gateway gave.
            Some(_) if !self.setup.app => Some(Mask::NONE),
            Some((from, to)) => {
                let given = self.pdout.get(from as usize..=to as usize).unwrap_or_default();
                if given.iter().any(|pd| pd.octets() == view.pd()) {
                    return Some(Mask::NONE);
                }
                (zero && snapshot.sdout != 0).then(|| Mask::NONE.with(snapshot.sdout))
            }
        }
    }

    fn reported(&self, snapshot: &Spdu, app: &App) -> Option<Mask> {
        if !self.setup.app {
            return Some(Mask::NONE);
        }
        let agrees = |expected: bool, seen: Option<bool>| seen.is_none_or(|seen| seen == expected);
        let safe = app.pdin_m.is_none_or(|pdin| pdin.as_slice().iter().all(|octet| *octet == 0));
        if !agrees(snapshot.ch_f_ack_req_s, app.ch_f_ack_req_s) {
            return None;
        }
        let live = app.pdin_m.is_none_or(|pdin| pdin.as_slice() == snapshot.pdin.octets())
            && agrees(snapshot.sdset_s, app.sdset_s)
            && agrees(!snapshot.sdset_s, app.qualifier);
        if live {
            return Some(Mask::NONE);
        }
        let late = safe && agrees(true, app.sdset_s) && agrees(false, app.qualifier);
        (late && snapshot.late != 0).then(|| Mask::NONE.with(snapshot.late))
    }

    /// PDout values an SPDU may carry, as text, the likeliest first; empty when it is not judged.
    fn pdout_texts(&self, range: Option<(u32, u32)>) -> Vec<String> {
        match range {
            None => vec![data(&[])],
            Some(_) if !self.setup.app => Vec::new(),
            Some((from, to)) => {
                let range = self.pdout.get(from as usize..=to as usize).unwrap_or_default();
                range.iter().rev().map(|pd| data(pd.octets())).collect()
            }
        }
    }

    fn allows(&self, number: u8) -> bool {
        self.setup.allowed.has(number)
    }

    /// What is followed.
    pub const fn set(&self) -> &Set<Port, Spdu> {
        &self.set
    }
}

fn with(mut config: MasterConfig, tolerance: u8) -> MasterConfig {
    config.used = config.used.with(tolerance);
    config
}

/// Whether two ways of the same check lead to the same.
fn same(one: &MasterConfig, other: &MasterConfig) -> bool {
    one.machine == other.machine && one.used == other.used && one.newest().looks_like(other.newest())
}
