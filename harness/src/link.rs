//! One link of the DUT: an FS-Device has one, an FS-Master one for each port. What was seen on it, and its oracle.

use crate::case::model::KEPT;
use crate::keeper::Keeper;
use crate::lines::Lines;
use crate::oracle::{App, Mismatch, Oracle, OssdeOracle, Setup};
use crate::specimen::Memory;
use crate::stopwatch::Stopwatch;
use fsct_adapters::{Identity, Line, Mode, Octets, Role, Seen, Service};
use fsct_protocol::Edition;
use fsct_protocol::fsp::INDEX_VERIFY;
use fsct_protocol::smi::{FS_PORT_CONFIG_LIST, MIXEDSAFETYCOM, SAFETYCOM};
use fsct_protocol::spdu::View;
use std::collections::VecDeque;

/// On-request data that an FS-Master has sent to the Device and that is not answered yet.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Open {
    /// Index.
    pub index: u16,
    /// Subindex.
    pub subindex: u8,
    /// Value to write; `None`: a read.
    pub data: Option<Vec<u8>>,
}

/// The link.
#[derive(Debug)]
pub struct Link {
    /// Port, from 1.
    pub port: u8,
    /// Its oracle.
    pub oracle: Oracle,
    /// The image presented last.
    pub image: Option<Octets>,
    /// The images presented before it, the latest first.
    pub earlier: VecDeque<Option<Octets>>,
    /// What the DUT received last.
    pub sent: Option<Octets>,
    /// When the image last changed.
    pub changed_at: u64,
    /// Application services as reported last.
    pub app: App,
    /// PDin_D or PDout_M as set last.
    pub input: Octets,
    /// Mode the FS-Master commands.
    pub mode: Mode,
    /// L+.
    pub port_power: bool,
    /// Wake-up pulses since the step began.
    pub wake_ups: u32,
    /// On-request data not answered yet.
    pub open: Option<Open>,
    /// What was written to 0x4202 since the step began, with the mode it came in.
    pub records: Vec<(Mode, Vec<u8>)>,
    /// What the virtual FS-Device remembers, once one was connected.
    pub memory: Option<Memory>,
    /// Whether a case has said which FS-Device that is.
    pub chosen: bool,
    /// The FSPortConfigList in force.
    pub configured: Vec<u8>,
    /// Whether the SCL may start with it; `None`: nothing is judged.
    pub starts: Option<bool>,
    /// The Device that is connected; `None` when nobody knows.
    pub plugged: Option<Option<Identity>>,
    /// Levels driven on C/Q and I/Q.
    pub levels: (bool, bool),
    /// The oracle of the OSSDe qualifier handler, in that port mode.
    pub ossde: Option<OssdeOracle>,
    /// When the services of an OSSDe port changed last and have not been looked at.
    unsettled: Option<u64>,
    /// What happens on L+, C/Q and I/Q.
    pub lines: Lines,
    /// Times the watchdog of the DUT, in a case that wants it measured.
    pub stopwatch: Option<Stopwatch>,
    /// ChFAck_C as set last.
    pub ack: bool,
    /// The conformant FS-Device that keeps the port in operation while the case is about another.
    pub keeper: Option<Keeper>,
    /// The case alone judges: what the oracle cannot explain ends its part in the case and nothing else.
    pub case_alone: bool,
    /// That has come about: no reading explains the DUT, so none excuses it from what a case expects.
    pub unexplained: bool,
    /// The SCL is not judged: nobody can say whether it may start, or the oracle has no part in the case any more.
    unjudged: bool,
    /// OSSDe transitions of earlier configurations in the same case.
    ossde_before: [u64; 6],
}

impl Link {
    /// A link of a DUT without supply.
    pub fn new(port: u8, setup: Setup) -> Link {
        let length = if setup.role == Role::Device { setup.pd_in } else { setup.pd_out };
        Link {
            port,
            oracle: Oracle::new(setup),
            image: None,
            earlier: VecDeque::new(),
            sent: None,
            changed_at: 0,
            app: App::default(),
            input: Octets::zero(length),
            mode: Mode::Inactive,
            port_power: false,
            wake_ups: 0,
            open: None,
            records: Vec::new(),
            memory: None,
            chosen: false,
            configured: Vec::new(),
            starts: None,
            plugged: None,
            levels: (false, false),
            ossde: None,
            unsettled: None,
            lines: Lines::default(),
            stopwatch: None,
            ack: false,
            keeper: None,
            case_alone: false,
            unexplained: false,
            unjudged: false,
            ossde_before: [0; 6],
        }
    }

    /// Supply of the DUT on or off.
    pub fn power(&mut self, on: bool) {
        self.oracle.power(on);
        self.app = App::default();
        self.input = Octets::zero(self.input.as_slice().len());
        self.image = None;
        (self.mode, self.port_power, self.open) = (Mode::Inactive, false, None);
        self.leave_ossde();
        self.keeper = None;
        (self.unjudged, self.ack) = (false, false);
        self.levels = (false, false);
    }

    /// A step begins.
    pub fn begin(&mut self) {
        self.wake_ups = 0;
        self.records.clear();
        self.memory.iter_mut().for_each(Memory::begin);
    }

    /// An input service is set.
    pub fn set(&mut self, service: Service, value: Octets) {
        self.oracle.input(service, &value);
        match service {
            Service::PdinD | Service::PdoutM => self.input = value,
            Service::ChfackC => {
                self.ack = value.is_set();
                if let Some(ossde) = &mut self.ossde {
                    ossde.ack(value.is_set());
                }
            }
            _ => {}
        }
    }

    /// An output service took a value at this time of the case.
    pub fn report(&mut self, service: Service, value: Octets, at: u64) {
        self.app.report(service, value);
        if let Some(stopwatch) = &mut self.stopwatch {
            stopwatch.report(service, value.is_set(), at);
        }
        let Some(ossde) = &mut self.ossde else { return };
        match service {
            Service::PdinM => ossde.on(value.as_slice().first().is_some_and(|octet| octet & 0b11 == 0b11)),
            Service::Qualifier => ossde.good(value.is_set()),
            Service::ChfackreqS => ossde.request(value.is_set()),
            _ => return,
        }
        self.unsettled = Some(at);
    }

    /// Looks at what the services of an OSSDe port have come to, unless more may come at the same instant.
    ///
    /// # Errors
    /// The [`Mismatch`] when Table 43 does not allow it.
    pub fn settle(&mut self, upto: u64) -> Result<(), Mismatch> {
        match (&mut self.ossde, self.unsettled) {
            (Some(ossde), Some(at)) if at < upto => {
                self.unsettled = None;
                let outcome = ossde.settle(at);
                self.heed(outcome)
            }
            _ => Ok(()),
        }
    }

    /// What the oracle says, if it has a say.
    fn heed(&mut self, outcome: Result<(), Mismatch>) -> Result<(), Mismatch> {
        if outcome.is_err() && self.case_alone {
            (self.unjudged, self.unexplained) = (true, true);
            self.leave_ossde();
            return Ok(());
        }
        outcome
    }

    /// One exchange: what the DUT received and what it presented.
    ///
    /// # Errors
    /// The [`Mismatch`] when no conformant DUT would.
    pub fn exchange(&mut self, at: u64, sent: Option<&Octets>, image: Option<Octets>) -> Result<(), Mismatch> {
        if image != self.image {
            self.changed_at = at;
            self.earlier.truncate(KEPT - 1);
            self.earlier.push_front(self.image);
        }
        self.image = image;
        self.sent = sent.copied().or(self.sent);
        if let Some(keeper) = &mut self.keeper {
            keeper.received(at, self.image.as_ref(), self.oracle.setup());
        }
        if self.unjudged {
            return Ok(());
        }
        let (sent, image) = (sent.map(Octets::as_slice), self.image.as_ref().map(Octets::as_slice));
        let outcome = self.oracle.exchange(at, sent, image, &self.app);
        self.heed(outcome)
    }

    /// The octets as they go out: behind a bare SPDU the non-safety data of the plugged Device follow as 0, because the length
    /// of its process data never changes.
    pub fn whole(&self, octets: Option<Octets>) -> Option<Octets> {
        let (Some(spdu), Some(Some(device))) = (octets, &self.plugged) else { return octets };
        let setup = self.oracle.setup();
        let missing = usize::from(device.pd_in).saturating_sub(spdu.as_slice().len());
        if spdu.as_slice().len() != setup.mode.spdu_octets(setup.sent_pd()) || missing == 0 {
            return octets;
        }
        let zeros = vec![0; missing];
        Octets::new(&[spdu.as_slice(), &zeros].concat())
    }

    /// An exchange at this time of the case, for a watchdog that is timed.
    pub fn time(&mut self, at: u64, sent: Option<Octets>, image: Option<Octets>) {
        if let Some(stopwatch) = &mut self.stopwatch {
            stopwatch.exchange(self.oracle.setup(), at, sent, image);
        }
    }

    /// Something of the base system.
    pub fn base(&mut self, at: u64, seen: &Seen) {
        match seen {
            Seen::Mode { mode, .. } => {
                self.mode = *mode;
                self.image = None;
                if *mode == Mode::Operate {
                    match self.starts {
                        Some(true) => self.oracle.parameterized(at),
                        Some(false) => {}
                        None => self.unjudged = true,
                    }
                }
            }
            Seen::Request { index, subindex, data, .. } => {
                if *index == INDEX_VERIFY
                    && let Some(data) = data
                {
                    self.records.push((self.mode, data.clone()));
                }
                self.open = Some(Open { index: *index, subindex: *subindex, data: data.clone() });
            }
            Seen::Line { line: Line::Power, level, .. } => self.port_power = *level,
            Seen::Line { line: Line::WakeUp, .. } => self.wake_ups += 1,
            _ => {}
        }
    }

    /// The port is configured anew: its SCL is gone.
    pub fn configure(&mut self, list: Vec<u8>, starts: Option<bool>) {
        self.configured = list;
        self.starts = starts;
        self.unjudged = false;
        if let Oracle::Master(oracle) = &mut self.oracle {
            oracle.stop();
        }
    }

    /// Whether the port is configured as SAFETYCOM or MIXEDSAFETYCOM.
    pub fn is_safety(&self) -> bool {
        let edition = self.oracle.setup().edition;
        let at = FS_PORT_CONFIG_LIST.field("PortMode").and_then(|field| field.offset(edition));
        let mode = at.and_then(|at| self.configured.get(at));
        mode.is_some_and(|mode| [SAFETYCOM, MIXEDSAFETYCOM].contains(mode))
    }

    /// The port is in OSSDe mode no more.
    pub fn leave_ossde(&mut self) {
        for (number, count) in self.ossde_taken().collect::<Vec<_>>() {
            if let Some(sum) = self.ossde_before.get_mut(usize::from(number) - 1) {
                *sum = count;
            }
        }
        (self.ossde, self.unsettled) = (None, None);
    }

    /// How often each of T1..T6 of Table 43 was taken, over the whole case.
    pub fn ossde_taken(&self) -> impl Iterator<Item = (u8, u64)> + '_ {
        let now = self.ossde.as_ref().map_or([0; 6], OssdeOracle::taken);
        (1..).zip(self.ossde_before.into_iter().zip(now).map(|(before, now)| before + now)).filter(|entry| entry.1 > 0)
    }

    /// The port is in OSSDe mode from this time on, with these levels on its lines.
    pub fn enter_ossde(&mut self, edition: Edition, response_ns: u64, at: u64, levels: (bool, bool)) {
        self.leave_ossde();
        let mut ossde = OssdeOracle::new(edition, response_ns);
        ossde.lines(at, levels.0, levels.1);
        ossde.ack(self.ack);
        self.ossde = Some(ossde);
    }

    /// Whether a conformant FS-Device keeps the port in operation.
    pub fn is_kept(&self) -> bool {
        self.keeper.is_some() && self.mode == Mode::Operate
    }

    /// What that FS-Device presents.
    pub fn kept_octets(&self) -> Option<Octets> {
        self.keeper.as_ref().and_then(Keeper::octets)
    }

    /// The image presented last, read as an SPDU; `None` when it is none, too short or all zero.
    pub fn answer(&self) -> Option<View<'_>> {
        self.oracle.setup().view(self.image.as_ref())
    }
}
