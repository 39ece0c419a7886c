//! Three FS-Masters without a Safety Communication Layer, for tests of the harness itself: no suite may pass one of them.
//!
//! They describe themselves like the reference FS-Master, say Result(+) to every service, start a port whatever it is
//! configured as, and differ in the image they present. Made-up stimuli are answered unsupported.

use super::{describe, image_octets};
use crate::dead::resized;
use crate::device::{DEFAULT_VARIANT, Sink, offers};
use fsct_adapters::{
    Clock, ClockKind, Description, Dut, DutError, Line, Mode, Observation, Octets, Seen, Service, SmiResult,
    SmiService, Stimulus, Variant,
};
use fsct_protocol::crc::Reading;
use fsct_protocol::spdu::{Control, OutSpdu, Pd, Port};

const PORTS: u8 = 2;

/// Its image is all zeros.
#[derive(Debug, Default)]
pub struct NullMaster(Shell);

/// Its image is what it received last, cut or filled up with zeros to the length of its SPDU.
#[derive(Debug, Default)]
pub struct EchoMaster {
    shell: Shell,
    received: Octets,
}

/// Its image is the right first SPDU, for ever.
#[derive(Debug, Default)]
pub struct ConstantMaster(Shell);

impl Dut for NullMaster {
    fn hello(&mut self) -> Result<Description, DutError> {
        Ok(self.0.describe("null master"))
    }

    fn apply(&mut self, stimuli: &[Stimulus], observed: &mut Vec<Observation>) -> Result<(), DutError> {
        self.0.apply(stimuli, observed, |_, _, variant| image_octets(variant));
        Ok(())
    }
}

impl Dut for EchoMaster {
    fn hello(&mut self) -> Result<Description, DutError> {
        Ok(self.shell.describe("echo master"))
    }

    fn apply(&mut self, stimuli: &[Stimulus], observed: &mut Vec<Observation>) -> Result<(), DutError> {
        self.shell.apply(stimuli, observed, |_, received, variant| {
            self.received = received.copied().unwrap_or(self.received);
            resized(&self.received, image_octets(variant).as_slice().len())
        });
        Ok(())
    }
}

impl Dut for ConstantMaster {
    fn hello(&mut self) -> Result<Description, DutError> {
        Ok(self.0.describe("constant master"))
    }

    fn apply(&mut self, stimuli: &[Stimulus], observed: &mut Vec<Observation>) -> Result<(), DutError> {
        self.0.apply(stimuli, observed, |port, _, variant| {
            let control = Control { mcount: 0, set_sd: true, ch_f_ack_req: false };
            let port = Port::new(port).unwrap_or(Port::ONE);
            let spdu = OutSpdu { pd: Pd::safe(variant.pd_out.into()), port, control };
            Octets::new(spdu.wire().emit(variant.mode, Reading::Preset).octets()).unwrap_or_default()
        });
        Ok(())
    }
}

/// All of an FS-Master but its images.
#[derive(Debug)]
struct Shell {
    variant: Variant,
    powered: bool,
    now: u64,
}

impl Default for Shell {
    fn default() -> Shell {
        Shell { variant: DEFAULT_VARIANT, powered: false, now: 0 }
    }
}

impl Shell {
    fn describe(&self, product: &str) -> Description {
        describe(product, PORTS, Clock { kind: ClockKind::Virtual, resolution_ns: 1, uncertainty_ns: 0 })
    }

    fn apply(
        &mut self,
        stimuli: &[Stimulus],
        observed: &mut Vec<Observation>,
        mut image: impl FnMut(u8, Option<&Octets>, Variant) -> Octets,
    ) {
        for (position, stimulus) in (0..).zip(stimuli) {
            let mut seen = Sink { observed, stimulus: position, at: self.now };
            match stimulus {
                Stimulus::Configure(variant) if !self.powered && offers().iter().any(|o| o.covers(*variant)) => {
                    self.variant = *variant;
                }
                Stimulus::Power(on) => self.power(*on, &mut seen),
                Stimulus::Exchange { port, .. } if !(1..=PORTS).contains(port) => {
                    seen.push(Seen::Unsupported);
                    seen.push(Seen::Image { port: *port, octets: None });
                }
                Stimulus::Exchange { port, octets } => {
                    let octets = self.powered.then(|| image(*port, octets.as_ref(), self.variant));
                    seen.push(Seen::Image { port: *port, octets });
                }
                Stimulus::Smi(request) => {
                    if request.service == SmiService::PortConfiguration {
                        seen.push(Seen::Line { port: request.port, line: Line::Power, level: true });
                    }
                    seen.push(Seen::Smi(Box::new(SmiResult {
                        port: request.port,
                        client_id: request.client_id,
                        positive: true,
                        reference: 0,
                        length: 0,
                        octets: Vec::new(),
                    })));
                }
                Stimulus::Drive { port, level: false, .. } => {
                    seen.push(Seen::Line { port: *port, line: Line::WakeUp, level: true });
                    for mode in [Mode::Startup, Mode::Preoperate, Mode::Operate] {
                        seen.push(Seen::Mode { port: *port, mode });
                    }
                }
                Stimulus::Set { .. }
                | Stimulus::Plug { .. }
                | Stimulus::Drive { .. }
                | Stimulus::Respond { .. }
                | Stimulus::Raise { .. } => {}
                Stimulus::Advance { ns } => self.now = self.now.saturating_add(*ns),
                _ => seen.push(Seen::Unsupported),
            }
        }
    }

    fn power(&mut self, on: bool, seen: &mut Sink<'_>) {
        if on && !self.powered {
            for port in 1..=PORTS {
                let mut push = |service, value| seen.push(Seen::Service { port, service, value });
                push(Service::PdinM, Octets::zero(self.variant.pd_in.into()));
                push(Service::SdsetS, Octets::bit(true));
                for service in [Service::ChfackreqS, Service::FaultsS, Service::Qualifier] {
                    push(service, Octets::bit(false));
                }
            }
        }
        self.powered = on;
    }
}
