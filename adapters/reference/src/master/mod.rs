//! The reference FS-Master as a [`Dut`]: power, ports, SMI and clock around one SCL for each port.
//!
//! `Configure` makes it another FS-Master, fresh from the factory; a power cycle keeps the port configurations (in iec2022
//! not those for commissioning), their Data Storage and nothing else. Everything that is due takes effect at the instant it was due, and before
//! anything else that happens at that instant.

mod blocks;
mod data_storage;
mod dead;
mod mutant;
mod options;
mod ossde;
mod port;
mod scl;
mod smi;

pub use dead::{ConstantMaster, EchoMaster, NullMaster};
pub use mutant::MasterMutant;
pub use options::MasterOptions;

use crate::device::{DEFAULT_VARIANT, REAL_UNCERTAINTY_NS, Sink, offers};
use fsct_adapters::{
    Clock, ClockKind, Description, Dut, DutError, Line, Observation, Octets, Pco, Role, Seen, Service, Stimulus,
    Variant,
};
use port::PortUnit;
use std::time::Instant;

/// The most one [`Stimulus::Advance`] may be. A port without Ready pulse switches its supply again and again, each time two
/// observations: what a longer one is answered with has no end.
const MAX_ADVANCE_NS: u64 = 86_400_000_000_000;
/// Where the clock ends: no time that is due later than now can overflow.
const LAST_NS: u64 = u64::MAX / 2;

/// The reference FS-Master.
#[derive(Debug)]
pub struct FsMaster {
    options: MasterOptions,
    variant: Variant,
    ports: Vec<PortUnit>,
    powered: bool,
    /// What the upper-level system has given as authenticity.
    fscp: Option<[u8; 8]>,
    password: u32,
    now: u64,
    /// Where the real clock began; `None` with a virtual clock.
    began: Option<Instant>,
}

fn port_unit(number: u8, variant: Variant, options: MasterOptions) -> PortUnit {
    PortUnit::new(number, variant.edition, variant.pd_in, options.latency, options.mutant)
}

impl FsMaster {
    /// An FS-Master with its power off, at time 0 of its clock.
    pub fn new(options: MasterOptions) -> FsMaster {
        FsMaster {
            options,
            variant: DEFAULT_VARIANT,
            ports: (1..=options.ports).map(|number| port_unit(number, DEFAULT_VARIANT, options)).collect(),
            powered: false,
            fscp: None,
            password: options.password,
            now: 0,
            began: (options.clock == ClockKind::Real).then(Instant::now),
        }
    }

    fn carry_out(&mut self, stimulus: &Stimulus, seen: &mut Sink<'_>) {
        if let Some(began) = &self.began {
            self.advance_to(u64::try_from(began.elapsed().as_nanos()).unwrap_or(u64::MAX), seen);
        }
        seen.at = self.now;
        match stimulus {
            Stimulus::Configure(variant) => self.configure(*variant, seen),
            Stimulus::Power(on) => self.power(*on, seen),
            Stimulus::Advance { ns } if self.began.is_none() && *ns <= MAX_ADVANCE_NS && self.now + ns <= LAST_NS => {
                self.advance_to(self.now + ns, seen);
            }
            Stimulus::Exchange { port, octets } => {
                let now = self.now;
                let image = match self.port(*port) {
                    Some(unit) => unit.exchange(now, octets.as_ref(), seen),
                    None => {
                        seen.push(Seen::Unsupported);
                        None
                    }
                };
                seen.push(Seen::Image { port: *port, octets: image });
            }
            Stimulus::Set { port: 0, service: Service::FscpAuthenticity, value } if self.powered => {
                match <[u8; 8]>::try_from(value.as_slice()) {
                    Ok(authenticity) => self.fscp = Some(authenticity),
                    Err(_) => seen.push(Seen::Unsupported),
                }
            }
            Stimulus::Smi(request) if self.powered => self.smi(request, seen),
            Stimulus::Plug { .. }
            | Stimulus::Respond { .. }
            | Stimulus::Raise { .. }
            | Stimulus::Drive { .. }
            | Stimulus::Set { .. } => self.on_port(stimulus, seen),
            _ => seen.push(Seen::Unsupported),
        }
    }

    fn on_port(&mut self, stimulus: &Stimulus, seen: &mut Sink<'_>) {
        let (now, fscp) = (self.now, self.fscp);
        let number = match stimulus {
            Stimulus::Plug { port, .. }
            | Stimulus::Respond { port, .. }
            | Stimulus::Raise { port, .. }
            | Stimulus::Drive { port, .. }
            | Stimulus::Set { port, .. } => *port,
            _ => 0,
        };
        let Some(unit) = self.port(number) else { return seen.push(Seen::Unsupported) };
        match stimulus {
            Stimulus::Plug { device, .. } => unit.plug(now, *device, seen),
            Stimulus::Respond { response, .. } => unit.respond(now, response, fscp, seen),
            Stimulus::Raise { code, qualifier, .. } => unit.raise(*code, *qualifier, seen),
            Stimulus::Drive { line: line @ (Line::Cq | Line::Iq), level, .. } => {
                seen.push(Seen::Line { port: number, line: *line, level: *level });
                unit.drive(now, *line, *level);
            }
            Stimulus::Set { service, value, .. } if unit.set(*service, value, seen) => {}
            _ => seen.push(Seen::Unsupported),
        }
    }

    /// The port of a number, while the power is on.
    fn port(&mut self, number: u8) -> Option<&mut PortUnit> {
        let index = usize::from(number).checked_sub(1)?;
        self.ports.get_mut(index).filter(|_| self.powered)
    }

    fn configure(&mut self, variant: Variant, seen: &mut Sink<'_>) {
        if self.powered || !offers().iter().any(|offer| offer.covers(variant)) {
            return seen.push(Seen::Unsupported);
        }
        self.variant = variant;
        self.fscp = None;
        self.password = self.options.password;
        self.ports = (1..=self.options.ports).map(|number| port_unit(number, variant, self.options)).collect();
    }

    fn power(&mut self, on: bool, seen: &mut Sink<'_>) {
        match (on, self.powered) {
            (true, false) => {
                let now = self.now;
                self.ports.iter_mut().for_each(|port| port.power_on(now, seen));
            }
            (false, true) => self.ports.iter_mut().for_each(PortUnit::power_off),
            _ => {}
        }
        self.powered = on;
    }

    fn advance_to(&mut self, to: u64, seen: &mut Sink<'_>) {
        let fscp = self.fscp;
        while self.powered {
            self.ports.iter_mut().for_each(|port| port.skip(to));
            let next = self.ports.iter_mut().filter_map(|port| Some((port.due()?, port)));
            let Some((due, port)) = next.min_by_key(|(due, _)| *due).filter(|(due, _)| *due <= to) else { break };
            seen.at = due.max(self.now);
            port.pass(due, fscp, seen);
        }
        self.now = self.now.max(to);
    }
}

impl Dut for FsMaster {
    fn hello(&mut self) -> Result<Description, DutError> {
        let uncertainty_ns = if self.began.is_some() { REAL_UNCERTAINTY_NS } else { 0 };
        let clock = Clock { kind: self.options.clock, resolution_ns: 1, uncertainty_ns };
        Ok(describe("reference FS-Master", self.options.ports, clock))
    }

    fn apply(&mut self, stimuli: &[Stimulus], observed: &mut Vec<Observation>) -> Result<(), DutError> {
        for (position, stimulus) in (0..).zip(stimuli) {
            self.carry_out(stimulus, &mut Sink { observed, stimulus: position, at: self.now });
        }
        Ok(())
    }
}

/// What this crate's FS-Masters say of themselves.
fn describe(product: &str, ports: u8, clock: Clock) -> Description {
    Description {
        role: Role::Master,
        ports,
        pcos: Pco::ALL.to_vec(),
        offers: offers().to_vec(),
        clock,
        vendor: "fsct".to_owned(),
        product: product.to_owned(),
        version: env!("CARGO_PKG_VERSION").to_owned(),
    }
}

/// The image of an FS-Master that only looks like one is as long as its SPDU.
fn image_octets(variant: Variant) -> Octets {
    Octets::zero(variant.mode.spdu_octets(variant.pd_out.into()))
}
