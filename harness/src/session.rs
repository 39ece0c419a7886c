//! One case's hold on the DUT: stimuli go out, observations come in, the oracle sees every exchange.

use crate::oracle::{App, DeviceOracle, Mismatch};
use crate::profile::Profile;
use crate::trace::{Margin, Told};
use fsct_adapters::{
    ClockKind, Description, Dut, DutError, Keep, Observation, Octets, Pco, Recorder, Seen, Service, Stimulus,
};
use fsct_protocol::spdu::View;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Exchanges sent in one go where the answers do not decide what comes next.
const BATCH: usize = 8_192;

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

/// The hold.
pub struct Session<'d> {
    dut: Recorder<&'d mut dyn Dut>,
    /// What the DUT says of itself.
    pub description: &'d Description,
    /// Profile in force.
    pub profile: &'d Profile,
    /// The oracle.
    pub oracle: DeviceOracle,
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
    /// Zero point and next due time of a real clock.
    pace: Option<(Instant, Instant)>,
    /// The image presented last.
    pub image: Option<Octets>,
    /// Application services as reported last.
    pub app: App,
    /// Answer to the latest read or write.
    pub reply: Option<Reply>,
    /// EventCodes seen since the step began.
    pub events: Vec<u16>,
    /// PDin_D as set last.
    pub pdin: Octets,
    observed: Vec<Observation>,
}

impl<'d> Session<'d> {
    /// A hold on a DUT without supply.
    pub fn new(
        dut: &'d mut dyn Dut,
        description: &'d Description,
        profile: &'d Profile,
        oracle: DeviceOracle,
        interrupted: &'d AtomicBool,
    ) -> Session<'d> {
        let pdin = Octets::zero(oracle.setup().pd_in);
        let start = Instant::now();
        Session {
            dut: Recorder::new(dut, Keep::default()),
            description,
            profile,
            oracle,
            margin: Margin::default(),
            zero: None,
            slipped: false,
            planned: None,
            last_exchange: 0,
            interrupted,
            now: 0,
            pace: (description.clock.kind == ClockKind::Real).then_some((start, start)),
            image: None,
            app: App::default(),
            reply: None,
            events: Vec::new(),
            pdin,
            observed: Vec::new(),
        }
    }

    /// Whether the DUT serves a point of control and observation.
    pub fn serves(&self, pco: Pco) -> bool {
        self.description.pcos.contains(&pco)
    }

    /// Supply on or off; `false`: the DUT does not serve it.
    ///
    /// # Errors
    /// [`Stop`] when the case cannot go on.
    pub fn power(&mut self, on: bool) -> Result<(), Stop> {
        self.oracle.power(on);
        self.app = App::default();
        self.pdin = Octets::zero(self.oracle.setup().pd_in);
        self.image = None;
        self.apply(&[Stimulus::Power(on)])
    }

    /// Sets an input service of the application.
    ///
    /// # Errors
    /// [`Stop`] when the case cannot go on.
    pub fn set(&mut self, service: Service, value: Octets) -> Result<(), Stop> {
        self.oracle.input(service, &value);
        if service == Service::PdinD {
            self.pdin = value;
        }
        self.apply(&[Stimulus::Set { port: 1, service, value }])
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
        let exchange = Stimulus::Exchange { port: 1, octets };
        match self.wait_for_turn(ns) {
            true => {
                self.planned = self.planned.map(|(last, _)| (last, ns));
                self.apply(&[exchange])
            }
            false => self.apply(&[Stimulus::Advance { ns }, exchange]),
        }
    }

    /// Exchanges with the same octets until this time on the clock of the DUT, the last one exactly then.
    ///
    /// # Errors
    /// [`Stop`] when the case cannot go on.
    pub fn exchange_until(&mut self, until: u64, octets: Option<Octets>) -> Result<(), Stop> {
        let cycle = self.profile.master_cycle_time_ns;
        while self.now < until {
            if self.pace.is_some() {
                self.exchange_after(cycle.min(until - self.now), octets)?;
                continue;
            }
            let mut batch = Vec::with_capacity(2 * BATCH);
            let mut at = self.now;
            while at < until && batch.len() < 2 * BATCH {
                let ns = cycle.min(until - at);
                at += ns;
                batch.push(Stimulus::Advance { ns });
                batch.push(Stimulus::Exchange { port: 1, octets });
            }
            self.apply(&batch)?;
        }
        Ok(())
    }

    /// On a real clock: sleeps until the next exchange is due. `false` on a virtual one.
    fn wait_for_turn(&mut self, ns: u64) -> bool {
        let Some((_, due)) = &mut self.pace else { return false };
        let now = Instant::now();
        *due += Duration::from_nanos(ns);
        match due.checked_duration_since(now) {
            Some(rest) => std::thread::sleep(rest),
            // Behind: go on from here instead of hurrying after.
            None => *due = now,
        }
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
            while let Some((observation, later)) = rest.split_first()
                && usize::from(observation.stimulus) == index
            {
                rest = later;
                self.digest_one(stimulus, observation)?;
            }
        }
        Ok(())
    }

    fn digest_one(&mut self, stimulus: &Stimulus, observation: &Observation) -> Result<(), Stop> {
        let zero = *self.zero.get_or_insert(observation.at.saturating_sub(self.now));
        let at = match &self.pace {
            // On a virtual clock the harness knows the time; stamps only tell when within an advance.
            None => self.now,
            Some((zero, _)) => {
                self.now = zero.elapsed().as_nanos() as u64;
                observation.at
            }
        };
        match &observation.seen {
            Seen::Image { octets, .. } => {
                let Stimulus::Exchange { octets: sent, .. } = stimulus else { return Ok(()) };
                self.image = *octets;
                let sent = sent.as_ref().map(Octets::as_slice);
                let image = octets.as_ref().map(Octets::as_slice);
                let verdict = self.oracle.exchange(at, sent, image, &self.app);
                self.last_exchange = observation.at.saturating_sub(zero);
                if self.pace.is_some() {
                    let slack = self.profile.master_cycle_time_ns / 2;
                    self.slipped |= self.planned.is_some_and(|(last, ns)| at > last + ns + slack);
                    self.planned = Some((at, 0));
                }
                self.margin.exchange(observation.at, self.oracle.via());
                verdict?;
            }
            Seen::Service { service, value, .. } => match service {
                Service::PdoutD => self.app.pdout_d = Some(*value),
                Service::SetsdDc => self.app.set_sd_dc = Some(value.is_set()),
                Service::ChfackreqDc => self.app.ch_f_ack_req_dc = Some(value.is_set()),
                Service::SclFault => self.app.scl_fault = Some(value.is_set()),
                _ => {}
            },
            Seen::Value(data) => self.reply = Some(Reply::Value(data.clone())),
            Seen::Written => self.reply = Some(Reply::Written),
            Seen::Refused { error } => self.reply = Some(Reply::Refused(*error)),
            Seen::Event { code, .. } => {
                self.events.push(*code);
            }
            Seen::Mode { .. } | Seen::Request { .. } | Seen::Line { .. } | Seen::Smi(_) | Seen::Indication { .. } => {}
            Seen::Unsupported => match stimulus {
                Stimulus::Read { .. } | Stimulus::Write { .. } => self.reply = Some(Reply::Unsupported),
                Stimulus::Other { .. } => {}
                other => return Err(Stop::Unserved(format!("the DUT does not serve {}", crate::trace::name(other)))),
            },
        }
        Ok(())
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
        let setup = self.oracle.setup();
        let view = View::new(self.image.as_ref()?.as_slice(), setup.mode, setup.pd_in).ok()?;
        (!view.is_all_zero()).then_some(view)
    }
}
