//! The oracle for an FS-Device: Table 40 interpreted over everything a conformant product may be doing.

use super::config::{Config, Machine, Snapshot, Window};
use super::explain::{self, Mismatch, Words, hex};
use super::set::{self, Set};
use super::setup::{App, Setup};
use super::{Mask, explain_device};
use crate::conditions::{self, OfDevice, Parts, Sides, Technology};
use fsct_adapters::{Octets, Role, Service};
use fsct_protocol::Edition;
use fsct_protocol::scl::device::{Readings, Received};
use fsct_protocol::scl::{Device, Path, State, T, Var};
use fsct_protocol::spdu::{Pd, Status, View};

/// Bits of the status octet that a tolerance in force leaves free, with the tolerance; 0: judged.
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq)]
pub struct Free {
    /// SDset.
    pub sd_set: u8,
    /// DCommErr.
    pub d_comm_err: u8,
    /// DTimeout.
    pub d_timeout: u8,
}

/// What the DUT shows from a certain exchange on: its answer and its application services.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Answer {
    /// Exchange in which it was made.
    pub made: u64,
    /// `None` before the first answer: the image is all zero.
    pub status: Option<Status>,
    /// Status bits not judged here, by the tolerance that says so (0: judged).
    pub free: Free,
    /// Generations of PDin_D of which the answer may carry one.
    pub pdin: (u32, u32),
    /// PDout_D expected.
    pub pdout: Pd,
    /// setSD_DC expected; `None` where it is not judged (A20).
    pub set_sd_dc: Option<bool>,
    /// ChFAckReq_DC expected; `None` where it is not judged (A27).
    pub ch_f_ack_req_dc: Option<bool>,
    /// Transitions that made it.
    pub path: Path,
}

impl Machine for Device {
    const FIRST: u8 = 20;
    const START: State = State(20);
    const ROLE: Role = Role::Device;

    fn state(&self) -> State {
        Device::state(self)
    }

    fn erred(&self) -> bool {
        self.get(Var::CommErr) == 1
    }
}

impl Snapshot for Answer {
    fn made(&self) -> u64 {
        self.made
    }

    fn set_made(&mut self, exchange: u64) {
        self.made = exchange;
    }

    fn path(&self) -> Path {
        self.path
    }

    fn looks_like(&self, other: &Answer) -> bool {
        self.status == other.status
            && self.free == other.free
            && (self.pdin == other.pdin || self.pdin.1 == other.pdin.0 && other.pdin.0 == other.pdin.1)
            && self.pdout == other.pdout
            && self.set_sd_dc == other.set_sd_dc
            && self.ch_f_ack_req_dc == other.ch_f_ack_req_dc
    }

    fn renew(&mut self, later: &Answer) {
        self.pdin.1 = later.pdin.1;
        self.path = later.path;
    }
}

type DeviceConfig = Config<Device, Answer>;

#[derive(Copy, Clone, Debug, PartialEq, Eq)]
enum Phase {
    /// No supply: nothing is judged.
    Off,
    /// Supplied, FSP parameterization not done or refused: no answer may come.
    Idle,
    /// FSP parameterization accepted at this time: states 20 and on.
    Ready { since: u64 },
}

/// What the DUT received, when it is no repetition of nothing.
#[derive(Copy, Clone)]
enum Incoming {
    Zero,
    Spdu(Arrived),
}

/// A received SPDU that is not all zero.
#[derive(Copy, Clone)]
struct Arrived {
    received: Received,
    parts: Parts,
    pd: Pd,
}

/// The oracle.
#[derive(Debug)]
pub struct DeviceOracle {
    setup: Setup,
    phase: Phase,
    set: Set<Device, Answer>,
    /// Values of PDin_D since power-on; the generation counts them.
    pdin: Vec<Pd>,
    sdset_ds: bool,
    sdset_ds_changed: bool,
}

impl DeviceOracle {
    /// For a DUT without supply.
    pub fn new(setup: Setup) -> DeviceOracle {
        DeviceOracle {
            pdin: vec![Pd::safe(setup.pd_in)],
            setup,
            phase: Phase::Off,
            set: Set::new(),
            sdset_ds: false,
            sdset_ds_changed: false,
        }
    }

    /// What it judges by.
    pub const fn setup(&self) -> &Setup {
        &self.setup
    }

    /// Supply on or off. The machine of before is gone; its transitions and tolerances stay counted.
    pub fn power(&mut self, on: bool) {
        self.set.forget();
        self.pdin = vec![Pd::safe(self.setup.pd_in)];
        self.sdset_ds = false;
        self.sdset_ds_changed = false;
        self.phase = if on { Phase::Idle } else { Phase::Off };
    }

    /// The FSP parameterization has been accepted: the SCL may start.
    pub fn parameterized(&mut self, at: u64) {
        self.phase = Phase::Ready { since: at };
        let safe = Pd::safe(self.setup.pd_out);
        let idle = Answer {
            made: self.set.exchange,
            status: None,
            free: Free::default(),
            pdin: (0, 0),
            pdout: safe,
            set_sd_dc: None,
            ch_f_ack_req_dc: None,
            path: Path::default(),
        };
        self.set.begin(Device::new(Readings::default()), idle, safe);
    }

    /// An input service of the application was set.
    pub fn input(&mut self, service: Service, value: &Octets) {
        match service {
            Service::PdinD => self.pdin.extend(Pd::new(value.as_slice())),
            Service::SdsetDs => {
                self.sdset_ds_changed |= self.sdset_ds != value.is_set();
                self.sdset_ds = value.is_set();
            }
            _ => {}
        }
    }

    /// One exchange: what the DUT received, the image it presented, and its application services afterwards.
    ///
    /// # Errors
    /// The [`Mismatch`] when no configuration explains it. The set stays as it was before, so nothing further can be judged.
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
                if verdict.is_ok() && matches!(received.and_then(|octets| self.read(octets)), Some(Incoming::Spdu(_))) {
                    let mut sides = Sides::NONE;
                    sides.set(OfDevice::Started, false);
                    self.set.idle(sides);
                }
                return verdict;
            }
            Phase::Ready { .. } => {}
        }
        let incoming = received.and_then(|octets| self.read(octets));
        let (mut before, mut stepped) = self.set.open();
        for config in before.drain(..) {
            let expire = |config: &mut DeviceConfig, window| self.expire(config, at, window);
            set::timed(config, at, expire, |config| self.receive(config, at, incoming, &mut stepped));
        }
        if matches!(incoming, Some(Incoming::Spdu(_))) && stepped.iter().any(|config| !config.via[0].is_empty()) {
            self.sdset_ds_changed = false;
        }
        self.set.last_at = at;
        let verdict = self.observe(&mut stepped, image, app);
        self.set.close(before, stepped);
        verdict
    }

    fn idle(&self, image: Option<&[u8]>, app: &App) -> Result<(), Mismatch> {
        let fail = |kind, clause, expected, observed| Err(Mismatch::fail(kind, clause, expected, observed));
        if let Some(octets) = image {
            return fail("idle", "11.5.3, 11.5.7", "an image of all zero: the SCL has not been started", hex(octets));
        }
        match app.pdout_d {
            Some(pdout) if pdout.as_slice().iter().any(|octet| *octet != 0) => {
                fail("PDout_D", "11.4.1, 11.5.3", "PDout_D safe: the SCL has not been started", hex(pdout.as_slice()))
            }
            _ => Ok(()),
        }
    }

    fn read(&self, octets: &[u8]) -> Option<Incoming> {
        let view = View::new(octets, self.setup.mode, self.setup.pd_out).ok()?;
        if view.is_all_zero() {
            return Some(Incoming::Zero);
        }
        let parts = Parts {
            signature: view.signature_matches(self.setup.reading),
            port_num: view.port_num() == self.setup.port.number(),
        };
        let received = Received { control: view.control(), intact: parts.signature && parts.port_num };
        Some(Incoming::Spdu(Arrived { received, parts, pd: Pd::new(view.pd())? }))
    }

    fn expire(&self, config: &mut DeviceConfig, at: u64, window: Window) {
        let had_comm_err = config.machine.get(Var::DcommErr) == 1;
        let state = config.machine.state();
        let path = config.machine.expire();
        config.expired(state, self.setup.watchdog_again(window, self.set.last_at, at));
        let mut free = Free::default();
        // In state 24 it never stands: this is T30.
        if had_comm_err {
            free.d_comm_err = 33;
        }
        config.took(path);
        self.answer(config, free, path, config.newest().ch_f_ack_req_dc);
    }

    fn receive(&self, mut config: DeviceConfig, at: u64, incoming: Option<Incoming>, out: &mut Vec<DeviceConfig>) {
        let incoming = match incoming {
            None => return out.push(config),
            Some(Incoming::Zero) => {
                let Phase::Ready { since } = self.phase else { return };
                if config.machine.state() == State(20) && at >= since + self.setup.scl_start_ns {
                    // By now it waits in state 21.
                    config.sides.set(OfDevice::NotZero21, false);
                }
                config.sides = config.sides.union(conditions::left_alone_by_device(&config.machine, None));
                return out.push(config);
            }
            Some(Incoming::Spdu(arrived)) => arrived,
        };
        let Received { control, intact } = incoming.received;
        if config.machine.state() == State(20) {
            let Phase::Ready { since } = self.phase else { return };
            if at < since + self.setup.scl_start_ns {
                out.push(config);
            }
            let path = config.machine.start();
            config.took(path);
            config.sides.set(OfDevice::Started, true);
        }
        if config.machine.is_old(control.mcount) {
            if !intact && self.allows(29) {
                let mut tripped = config;
                tripped.used = tripped.used.with(29);
                self.process(&mut tripped, at, incoming, false);
                out.push(tripped);
            }
            let alone = conditions::left_alone_by_device(&config.machine, Some(control.mcount));
            config.sides = config.sides.union(alone);
            return out.push(config);
        }
        let first = config.machine.state() == State(21);
        if intact && config.machine.counter_check(control.mcount) {
            self.process(&mut config, at, incoming, true);
            return out.push(config);
        }
        if first && intact && control.mcount == 1 && self.setup.edition == Edition::V1_1 && self.allows(31) {
            let mut accepted = config;
            accepted.used = accepted.used.with(31);
            self.process(&mut accepted, at, incoming, true);
            out.push(accepted);
        }
        if intact && !first {
            // A jump.
            if config.machine.readings().jump_ignored {
                return out.push(config);
            }
            if let Some(ignored) = self.decide(&mut config, 9, |readings| readings.jump_ignored = true) {
                out.push(ignored);
            }
        }
        let mut ways = [Some(config), None, None, None];
        if let Some(way) = ways[0].as_mut() {
            let other = self.decide(way, 8, |readings| readings.last_valid = true);
            ways[1] = other;
        }
        if config.machine.state() == State(26) {
            for index in 0..2 {
                let other = match ways[index].as_mut() {
                    Some(way) => self.decide(way, 19, |readings| readings.sequential = true),
                    None => None,
                };
                ways[index + 2] = other;
            }
        }
        for mut way in ways.into_iter().flatten() {
            self.process(&mut way, at, incoming, false);
            out.push(way);
        }
    }

    /// The first time a reading matters, both are followed; from then on each keeps to its own.
    fn decide(&self, config: &mut DeviceConfig, number: u8, read: impl Fn(&mut Readings)) -> Option<DeviceConfig> {
        if config.decided.has(number) {
            return None;
        }
        config.decided = config.decided.with(number);
        if !self.allows(number) {
            return None;
        }
        let mut other = *config;
        let mut readings = other.machine.readings();
        read(&mut readings);
        other.machine.set_readings(readings);
        other.used = other.used.with(number);
        if number == 8 {
            other.used = other.used.with(16);
        }
        Some(other)
    }

    fn process(&self, config: &mut DeviceConfig, at: u64, incoming: Arrived, valid: bool) {
        self.decided(config, incoming, valid);
        let state = config.machine.state();
        let first = state == State(21);
        config.machine.set_sdset_ds(self.sdset_ds);
        let path = config.machine.process(incoming.received, valid);
        config.received = incoming.pd;
        config.restart(state, Some(self.setup.watchdog(at, at)));
        let mut free = Free::default();
        let status = config.machine.status();
        // The technology may report its safe state by SDset_DS; without upper tester nobody knows when.
        if valid && !status.sd_set && (incoming.received.control.set_sd || !self.setup.app) {
            free.sd_set = 11;
        }
        if valid && self.sdset_ds_changed {
            free.sd_set = 21;
        }
        if !valid && status.d_timeout {
            free.d_timeout = if first { 32 } else { 33 };
        }
        config.took(path);
        let asked = valid.then_some(incoming.received.control.ch_f_ack_req);
        self.answer(config, free, path, asked);
    }

    /// Notes what decided, where nothing but the tables did.
    fn decided(&self, config: &mut DeviceConfig, incoming: Arrived, valid: bool) {
        let Arrived { received, parts, .. } = incoming;
        let mcount = received.control.mcount;
        let machine = &config.machine;
        if machine.is_old(mcount) || valid != (received.intact && machine.counter_check(mcount)) {
            return;
        }
        let known = self.setup.app && !self.sdset_ds_changed;
        let technology = Technology { seen: self.setup.app, sdset_ds: known.then_some(self.sdset_ds) };
        config.sides = config.sides.union(conditions::device(machine, received, parts, technology));
    }

    fn answer(&self, config: &mut DeviceConfig, free: Free, path: Path, asked: Option<bool>) {
        let pdout = if config.machine.uses_pdout() { config.received } else { Pd::safe(self.setup.pd_out) };
        let leaves_fault = path.iter().any(|t| t == T(28));
        let newest = self.pdin.len().saturating_sub(1) as u32;
        let in_force = |number: u8| if self.allows(number) { number } else { 0 };
        let snapshot = Answer {
            made: self.set.exchange,
            status: Some(config.machine.status()),
            free: Free {
                sd_set: in_force(free.sd_set),
                d_comm_err: in_force(free.d_comm_err),
                d_timeout: in_force(free.d_timeout),
            },
            pdin: (config.newest().pdin.1, newest),
            pdout,
            set_sd_dc: (!leaves_fault).then_some(config.machine.get(Var::SetSdDc) == 1),
            ch_f_ack_req_dc: asked,
            path,
        };
        config.push(snapshot);
    }

    fn observe(&self, stepped: &mut Vec<DeviceConfig>, image: Option<&[u8]>, app: &App) -> Result<(), Mismatch> {
        let malformed = image.and_then(|octets| explain::form(&self.setup, octets));
        let view = image.and_then(|octets| View::new(octets, self.setup.mode, self.setup.pd_in).ok());
        let link = |snapshot: &Answer| match (&snapshot.status, image) {
            (None, None) => Some(Mask::NONE),
            (None, Some(_)) => self.allows(18).then(|| Mask::NONE.with(18)),
            (Some(_), None) => None,
            (Some(_), Some(_)) if malformed.is_some() => None,
            (Some(_), Some(_)) => self.explains(snapshot, view?),
        };
        let services = |snapshot: &Answer| self.reported(snapshot, app).then_some(Mask::NONE);
        let tell = |configs: &[DeviceConfig]| {
            let view = view.filter(|_| malformed.is_none());
            malformed.clone().unwrap_or_else(|| {
                let differences = |snap: &Answer| {
                    explain_device::differences(&self.setup, snap, view, app, &self.pdin_texts(snap.pdin))
                };
                let words =
                    Words { table: explain_device::TABLE, differences: &differences, timing: &explain_device::timing };
                explain::nearest(configs, self.set.exchange, self.setup.latency, &words)
            })
        };
        self.set.observe(stepped, self.setup.latency, link, services, tell)
    }

    fn explains(&self, snapshot: &Answer, view: View<'_>) -> Option<Mask> {
        let expected = snapshot.status?;
        let seen = view.status();
        if seen.dcount_i != expected.dcount_i {
            return None;
        }
        let mut used = Mask::NONE;
        for (expected, seen, free) in [
            (expected.sd_set, seen.sd_set, snapshot.free.sd_set),
            (expected.d_comm_err, seen.d_comm_err, snapshot.free.d_comm_err),
            (expected.d_timeout, seen.d_timeout, snapshot.free.d_timeout),
        ] {
            if expected != seen {
                if free == 0 {
                    return None;
                }
                used = used.with(free);
            }
        }
        if self.setup.app {
            let (from, to) = snapshot.pdin;
            let sent = self.pdin.get(from as usize..=to as usize).unwrap_or_default();
            if !sent.iter().any(|pd| pd.octets() == view.pd()) {
                let zero = view.pd().iter().all(|octet| *octet == 0);
                if !(zero && seen.sd_set && self.allows(28)) {
                    return None;
                }
                used = used.with(28);
            }
        }
        Some(used)
    }

    fn reported(&self, snapshot: &Answer, app: &App) -> bool {
        let agrees = |expected: Option<bool>, seen: Option<bool>| match (expected, seen) {
            (Some(expected), Some(seen)) => expected == seen,
            _ => true,
        };
        !self.setup.app
            || (app.pdout_d.is_none_or(|pdout| pdout.as_slice() == snapshot.pdout.octets())
                && agrees(snapshot.set_sd_dc, app.set_sd_dc)
                && agrees(snapshot.ch_f_ack_req_dc, app.ch_f_ack_req_dc))
    }

    /// PDin values an answer may carry, as text, the likeliest first; empty when it is not judged.
    fn pdin_texts(&self, (from, to): (u32, u32)) -> Vec<String> {
        if !self.setup.app {
            return Vec::new();
        }
        let range = self.pdin.get(from as usize..=to as usize).unwrap_or_default();
        range.iter().rev().map(|pd| hex(pd.octets())).collect()
    }

    fn allows(&self, number: u8) -> bool {
        self.setup.allowed.has(number)
    }

    /// What is followed.
    pub const fn set(&self) -> &Set<Device, Answer> {
        &self.set
    }
}
