//! The reference FS-Device as a [`Dut`]: power, link image, on-request data, application services and clock around
//! the [`Scl`].
//!
//! `Configure` makes it another device, fresh from the factory; a power cycle keeps the parameter memory and nothing
//! else. With both clocks an expiry of DTimer takes effect at the instant it was due, and before anything else that
//! happens at that instant.

use crate::lines::Lines;
use crate::parameters::{Parameters, Verified, Written, error_type, event_code};
use crate::scl::{Config, Inputs, Outputs, Scl};
use crate::{Mutant, Options};
use fsct_adapters::{
    Clock, ClockKind, Description, Dut, DutError, Line, Mode, Observation, Octets, Offer, Pco, Role, Seen, Service,
    Stimulus, Variant,
};
use fsct_protocol::spdu::{Pd, Port};
use fsct_protocol::{Edition, ProtMode};
use std::time::Instant;

/// The one port of an FS-Device.
pub(crate) const PORT: u8 = 1;

/// EventQualifier of an Error that appears, from the application of a device (base standard).
const ERROR_APPEARS: u8 = 0xF4;

/// EventQualifier of a Warning that appears.
const WARNING_APPEARS: u8 = 0xE4;

/// Edges told during one stimulus before test pulses are left out.
const EDGES_AT_ONCE: usize = 24;

/// How far a time stamp of the real clock may be off: a stimulus may wait that long inside the process.
pub(crate) const REAL_UNCERTAINTY_NS: u64 = 100_000;

/// What the device is before any `Configure`.
pub(crate) const DEFAULT_VARIANT: Variant =
    Variant { edition: Edition::Iec2022, mode: ProtMode::Crc16, pd_out: 3, pd_in: 3 };

/// The reference FS-Device.
#[derive(Debug)]
pub struct FsDevice {
    options: Options,
    variant: Variant,
    parameters: Parameters,
    /// `None` while the power is off.
    session: Option<Session>,
    /// What was before the power was switched off; only a mutant looks at it.
    before: Option<Session>,
    /// When the power was switched off, since the last `Configure`.
    off_since: Option<u64>,
    now: u64,
    /// Where the real clock began; `None` with a virtual clock.
    began: Option<Instant>,
}

/// What does not survive a power cycle.
#[derive(Debug)]
struct Session {
    lines: Lines,
    /// `None` until FSP_VerifyRecord was found as stored.
    scl: Option<Scl>,
    /// What a mutant keeps over a power cycle.
    kept: Option<Scl>,
    /// An FSP_VerifyRecord for the stored blocks was received, as stored or deviating.
    record_received: bool,
    /// Process data have been exchanged.
    operate: bool,
    inputs: Inputs,
    /// Outputs as last reported.
    outputs: Outputs,
    images: Pipeline,
}

impl FsDevice {
    /// A device with its power off, at time 0 of its clock.
    pub fn new(options: Options) -> FsDevice {
        FsDevice {
            options,
            variant: DEFAULT_VARIANT,
            parameters: Parameters::factory(DEFAULT_VARIANT, options.mutant),
            session: None,
            before: None,
            off_since: None,
            now: 0,
            began: (options.clock == ClockKind::Real).then(Instant::now),
        }
    }

    /// A device without fault or latency that lives in real time.
    pub fn real_time() -> FsDevice {
        FsDevice::new(Options { clock: ClockKind::Real, ..Options::default() })
    }

    fn carry_out(&mut self, stimulus: &Stimulus, seen: &mut Sink<'_>) {
        if let Some(began) = &self.began {
            self.advance_to(u64::try_from(began.elapsed().as_nanos()).unwrap_or(u64::MAX), seen);
        }
        seen.at = self.now;
        match stimulus {
            Stimulus::Configure(variant) => self.configure(*variant, seen),
            Stimulus::Power(true) => self.power_on(seen),
            Stimulus::Power(false) => self.power_off(seen),
            Stimulus::Exchange { port: PORT, octets } => self.exchange(octets.as_ref(), seen),
            Stimulus::Exchange { port, .. } => {
                seen.push(Seen::Unsupported);
                seen.push(Seen::Image { port: *port, octets: None });
            }
            Stimulus::Drive { port: PORT, line: Line::WakeUp, level: true } => self.wake_up(seen),
            Stimulus::Read { index, subindex } => seen.push(match self.read(*index, *subindex) {
                Ok(value) => Seen::Value(value),
                Err(error) => Seen::Refused { error },
            }),
            Stimulus::Write { index, subindex, data } => self.write(*index, *subindex, data, seen),
            Stimulus::Set { port: PORT, service: Service::OssdeDemand, value } => self.demand(value.is_set(), seen),
            Stimulus::Set { port: PORT, service, value } if self.set(*service, value) => {}
            Stimulus::Advance { ns } if self.began.is_none() => self.advance_to(self.now.saturating_add(*ns), seen),
            Stimulus::Set { .. } | Stimulus::Advance { .. } | Stimulus::Other { .. } => seen.push(Seen::Unsupported),
            Stimulus::Plug { .. }
            | Stimulus::Respond { .. }
            | Stimulus::Raise { .. }
            | Stimulus::Drive { .. }
            | Stimulus::Smi(_) => seen.push(Seen::Unsupported),
        }
    }

    fn configure(&mut self, variant: Variant, seen: &mut Sink<'_>) {
        if self.session.is_some() || !offers().iter().any(|offer| offer.covers(variant)) {
            return seen.push(Seen::Unsupported);
        }
        self.variant = variant;
        self.parameters = Parameters::factory(variant, self.options.mutant);
        self.before = None;
        self.off_since = None;
    }

    fn power_on(&mut self, seen: &mut Sink<'_>) {
        if self.session.is_some() {
            return;
        }
        let off_ns = self.off_since.map(|since| self.now - since);
        let pulse_ns = u64::from(self.options.pulse_us) * 1_000;
        let mut lines = Lines::power_on(self.variant.edition, pulse_ns, self.options.mutant, self.now, off_ns);
        if !self.parameters.technology_fits() && self.options.mutant != Some(Mutant::OssdeWithAlteredTechnology) {
            lines.stay_off();
        }
        seen.push_line(Line::Power, true);
        let mut session = Session::new(self.variant, self.options, lines);
        match (self.options.mutant, self.before.take()) {
            (Some(Mutant::PdoutAtPowerOn), Some(before)) => session.outputs.pd_out = before.outputs.pd_out,
            (Some(Mutant::SclSurvivesPowerOff), Some(before)) => session.kept = before.scl.or(before.kept),
            (Some(Mutant::StartsAtPowerOn), _) => {
                let stored = self.parameters.stored().unwrap_or(Verified { port: Port::ONE, watchdog_ms: 1_000 });
                session.scl = Some(start(self.variant, stored, self.options.mutant, self.now));
            }
            _ => {}
        }
        session.report(None, seen);
        seen.push_service(Service::SclFault, Octets::bit(false));
        self.session = Some(session);
    }

    fn power_off(&mut self, seen: &mut Sink<'_>) {
        self.before = self.session.take();
        if let Some(session) = &self.before {
            let (cq, iq) = session.lines.levels();
            cq.then(|| seen.push_line(Line::Cq, false));
            iq.then(|| seen.push_line(Line::Iq, false));
            seen.push_line(Line::Power, false);
            self.off_since = Some(self.now);
        }
        self.parameters.power_off();
        if self.options.mutant == Some(Mutant::BlocksLostAtPowerOff) {
            self.parameters = Parameters::factory(self.variant, self.options.mutant);
        }
    }

    fn exchange(&mut self, received: Option<&Octets>, seen: &mut Sink<'_>) {
        let octets = awake(&mut self.session).map(|session| {
            if !session.operate {
                session.operate = true;
                if self.variant.edition == Edition::Iec2022 && !session.record_received {
                    seen.push_error(event_code::NO_VERIFY_RECORD);
                }
            }
            session.exchange(received, self.now, seen)
        });
        seen.push(Seen::Image { port: PORT, octets });
    }

    /// A pulse on C/Q by which the tester asks for communication.
    fn wake_up(&mut self, seen: &mut Sink<'_>) {
        let Some(session) = &mut self.session else { return seen.push(Seen::Unsupported) };
        seen.push_line(Line::WakeUp, true);
        if session.lines.wake_up(self.now) {
            seen.push(Seen::Mode { port: PORT, mode: Mode::Startup });
        }
    }

    fn read(&mut self, index: u16, subindex: u8) -> Result<Vec<u8>, u16> {
        if awake(&mut self.session).is_none() {
            return Err(error_type::COM_ERR);
        }
        self.parameters.read(index, subindex)
    }

    fn write(&mut self, index: u16, subindex: u8, data: &[u8], seen: &mut Sink<'_>) {
        let Some(session) = awake(&mut self.session) else {
            return seen.push(Seen::Refused { error: error_type::COM_ERR });
        };
        let written = match self.parameters.write(index, subindex, data, session.operate) {
            Ok(written) => written,
            Err(error) => return seen.push(Seen::Refused { error }),
        };
        seen.push(Seen::Written);
        let start = |verified| start(self.variant, verified, self.options.mutant, self.now);
        let (scl, record_received) = match written {
            Written::Nothing => return,
            Written::Block if self.options.mutant == Some(Mutant::StartsOnProtocol) => {
                (self.parameters.stored().map(start), false)
            }
            Written::Block => (None, false),
            Written::Verified(verified) => (Some(session.kept.take().unwrap_or_else(|| start(verified))), true),
            Written::Deviating(events) => {
                let warn = self.options.mutant == Some(Mutant::EventsAsWarnings);
                let qualifier = if warn { WARNING_APPEARS } else { ERROR_APPEARS };
                events.into_iter().flatten().for_each(|code| seen.push(Seen::Event { code, qualifier }));
                let starts = self.options.mutant == Some(Mutant::DeviationStarts);
                (self.parameters.stored().filter(|_| starts).map(start), true)
            }
        };
        session.verified(scl, record_received);
    }

    /// Whether the service was taken.
    fn set(&mut self, service: Service, value: &Octets) -> bool {
        let Some(session) = &mut self.session else { return false };
        match (service, value.as_slice()) {
            (Service::PdinD, octets) if octets.len() == usize::from(self.variant.pd_in) => {
                Pd::new(octets).map(|pd| session.inputs.pd_in = pd).is_some()
            }
            (Service::SdsetDs, [bit @ (0 | 1)]) => {
                session.inputs.sd_set_ds = *bit == 1;
                true
            }
            _ => false,
        }
    }

    /// The safety function of the technology is demanded in OSSDe operation.
    fn demand(&mut self, demand: bool, seen: &mut Sink<'_>) {
        let Some(session) = &mut self.session else { return seen.push(Seen::Unsupported) };
        session.lines.demand(self.now, demand);
        session.drive(self.now, seen);
    }

    fn advance_to(&mut self, now: u64, seen: &mut Sink<'_>) {
        if let Some(session) = &mut self.session {
            session.drive(now, seen);
            session.expire(now, seen);
        }
        self.now = now;
    }
}

impl Dut for FsDevice {
    fn hello(&mut self) -> Result<Description, DutError> {
        let uncertainty_ns = if self.began.is_some() { REAL_UNCERTAINTY_NS } else { 0 };
        Ok(describe("reference FS-Device", Clock { kind: self.options.clock, resolution_ns: 1, uncertainty_ns }))
    }

    fn apply(&mut self, stimuli: &[Stimulus], observed: &mut Vec<Observation>) -> Result<(), DutError> {
        for (position, stimulus) in (0..).zip(stimuli) {
            self.carry_out(stimulus, &mut Sink { observed, stimulus: position, at: self.now });
        }
        Ok(())
    }
}

impl Session {
    fn new(variant: Variant, options: Options, lines: Lines) -> Session {
        Session {
            lines,
            scl: None,
            kept: None,
            record_received: false,
            operate: false,
            inputs: Inputs { pd_in: Pd::safe(variant.pd_in.into()), sd_set_ds: false },
            outputs: Outputs::initial(variant.pd_out),
            images: Pipeline::new(Octets::zero(variant.mode.spdu_octets(variant.pd_in.into())), options.latency),
        }
    }

    fn verified(&mut self, scl: Option<Scl>, record_received: bool) {
        self.scl = scl;
        self.record_received = record_received;
    }

    fn exchange(&mut self, received: Option<&Octets>, now: u64, seen: &mut Sink<'_>) -> Octets {
        let Some(scl) = &mut self.scl else { return self.images.silent };
        if let Some(octets) = received {
            scl.received(now, octets.as_slice(), &self.inputs);
        }
        let image = scl.answer().and_then(Octets::new).unwrap_or(self.images.silent);
        self.report_changes(seen);
        self.images.pass(image)
    }

    /// Edges that are due by `now`, as many as may be told at once.
    fn drive(&mut self, now: u64, seen: &mut Sink<'_>) {
        let mut told = 0;
        while let Some((at, line, level)) = self.lines.due(now) {
            seen.at = at;
            seen.push_line(line, level);
            told += 1;
            if told >= EDGES_AT_ONCE {
                self.lines.skip(now);
                if told >= 2 * EDGES_AT_ONCE {
                    break;
                }
            }
        }
    }

    fn expire(&mut self, now: u64, seen: &mut Sink<'_>) {
        let Some(scl) = &mut self.scl else { return };
        if let Some(due) = scl.expire(now, &self.inputs) {
            seen.at = due;
            self.report_changes(seen);
        }
    }

    fn report_changes(&mut self, seen: &mut Sink<'_>) {
        let Some(scl) = &self.scl else { return };
        let new = *scl.outputs();
        if new != self.outputs {
            let old = std::mem::replace(&mut self.outputs, new);
            self.report(Some(&old), seen);
        }
    }

    /// Reports each output that is not as in `old`, or all of them.
    fn report(&self, old: Option<&Outputs>, seen: &mut Sink<'_>) {
        let new = &self.outputs;
        if old.is_none_or(|old| old.pd_out != new.pd_out) {
            seen.push_service(Service::PdoutD, Octets::new(new.pd_out.octets()).unwrap_or_default());
        }
        if old.is_none_or(|old| old.set_sd_dc != new.set_sd_dc) {
            seen.push_service(Service::SetsdDc, Octets::bit(new.set_sd_dc));
        }
        if old.is_none_or(|old| old.ch_f_ack_req_dc != new.ch_f_ack_req_dc) {
            seen.push_service(Service::ChfackreqDc, Octets::bit(new.ch_f_ack_req_dc));
        }
    }
}

/// The answer image on its way to the line: what is put in comes out `latency` exchanges later, zeros before.
#[derive(Debug)]
pub(crate) struct Pipeline {
    /// The image of a device whose SCL does not send.
    silent: Octets,
    images: [Octets; Options::MAX_LATENCY as usize],
    latency: usize,
    next: usize,
}

impl Pipeline {
    pub(crate) fn new(silent: Octets, latency: u8) -> Pipeline {
        Pipeline { silent, images: [silent; Options::MAX_LATENCY as usize], latency: latency.into(), next: 0 }
    }

    pub(crate) fn pass(&mut self, image: Octets) -> Octets {
        let latency = self.latency;
        match self.images.get_mut(..latency).and_then(|used| used.get_mut(self.next)) {
            None => image,
            Some(oldest) => {
                self.next = (self.next + 1) % latency;
                std::mem::replace(oldest, image)
            }
        }
    }
}

/// Where observations go, with the stimulus and the time they belong to.
pub(crate) struct Sink<'a> {
    pub(crate) observed: &'a mut Vec<Observation>,
    pub(crate) stimulus: u16,
    pub(crate) at: u64,
}

impl Sink<'_> {
    pub(crate) fn push(&mut self, seen: Seen) {
        self.observed.push(Observation { stimulus: self.stimulus, at: self.at, seen });
    }

    pub(crate) fn push_service(&mut self, service: Service, value: Octets) {
        self.push(Seen::Service { port: PORT, service, value });
    }

    fn push_line(&mut self, line: Line, level: bool) {
        self.push(Seen::Line { port: PORT, line, level });
    }

    fn push_error(&mut self, code: u16) {
        self.push(Seen::Event { code, qualifier: ERROR_APPEARS });
    }
}

/// The session of a device that communicates.
fn awake(session: &mut Option<Session>) -> Option<&mut Session> {
    session.as_mut().and_then(|session| session.lines.answers().then_some(session))
}

/// FSP parameterization of the SCL. This device is ready as soon as its parameters are: T20 follows at once.
fn start(variant: Variant, verified: Verified, mutant: Option<Mutant>, now: u64) -> Scl {
    let mut scl = Scl::new(Config {
        mode: variant.mode,
        pd_out: variant.pd_out,
        port: verified.port,
        watchdog_ms: verified.watchdog_ms,
        mutant,
    });
    scl.system_start_ok(now);
    scl
}

/// What this crate's devices say of themselves.
pub(crate) fn describe(product: &str, clock: Clock) -> Description {
    Description {
        role: Role::Device,
        ports: 1,
        pcos: vec![Pco::Power, Pco::Link, Pco::Acyclic, Pco::App, Pco::Line, Pco::Clock],
        offers: offers().to_vec(),
        clock,
        vendor: "fsct".to_owned(),
        product: product.to_owned(),
        version: env!("CARGO_PKG_VERSION").to_owned(),
    }
}

/// Both editions, both modes, every size.
pub(crate) fn offers() -> [Offer; 4] {
    let offer = |edition, mode: ProtMode| {
        let sizes = (0, mode.max_pd() as u8);
        Offer { edition, mode, pd_out: sizes, pd_in: sizes }
    };
    [
        offer(Edition::V1_1, ProtMode::Crc16),
        offer(Edition::V1_1, ProtMode::Crc32),
        offer(Edition::Iec2022, ProtMode::Crc16),
        offer(Edition::Iec2022, ProtMode::Crc32),
    ]
}
