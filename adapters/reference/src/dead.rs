//! Three devices without a Safety Communication Layer, for tests of the harness itself: no suite may pass one of them.
//!
//! They describe themselves like the reference FS-Device, accept every sensible stimulus, carry out none, and differ
//! in the image they present. Made-up stimuli are answered unsupported.

use crate::device::{DEFAULT_VARIANT, PORT, Sink, describe, offers};
use fsct_adapters::{
    Clock, ClockKind, Description, Dut, DutError, Observation, Octets, Seen, Service, Stimulus, Variant,
};
use fsct_protocol::crc::Reading;
use fsct_protocol::spdu::{InSpdu, Pd, Port, Status};

/// Its image is all zeros.
#[derive(Debug, Default)]
pub struct NullDevice(Shell);

/// Its image is what it received last, cut or filled up with zeros to the length of its SPDU.
#[derive(Debug, Default)]
pub struct EchoDevice {
    shell: Shell,
    received: Octets,
}

/// Its image is the right answer to the first SPDU on port 1, for ever.
#[derive(Debug, Default)]
pub struct ConstantDevice(Shell);

impl Dut for NullDevice {
    fn hello(&mut self) -> Result<Description, DutError> {
        Ok(self.0.describe("null device"))
    }

    fn apply(&mut self, stimuli: &[Stimulus], observed: &mut Vec<Observation>) -> Result<(), DutError> {
        self.0.apply(stimuli, observed, |_, variant| Octets::zero(image_octets(variant)));
        Ok(())
    }
}

impl Dut for EchoDevice {
    fn hello(&mut self) -> Result<Description, DutError> {
        Ok(self.shell.describe("echo device"))
    }

    fn apply(&mut self, stimuli: &[Stimulus], observed: &mut Vec<Observation>) -> Result<(), DutError> {
        self.shell.apply(stimuli, observed, |received, variant| {
            self.received = received.copied().unwrap_or(self.received);
            resized(&self.received, image_octets(variant))
        });
        Ok(())
    }
}

impl Dut for ConstantDevice {
    fn hello(&mut self) -> Result<Description, DutError> {
        Ok(self.0.describe("constant device"))
    }

    fn apply(&mut self, stimuli: &[Stimulus], observed: &mut Vec<Observation>) -> Result<(), DutError> {
        self.0.apply(stimuli, observed, |_, variant| {
            let status = Status { dcount_i: 7, sd_set: true, ..Status::default() };
            let spdu = InSpdu { pd: Pd::safe(variant.pd_in.into()), port: Port::ONE, status };
            Octets::new(spdu.wire().emit(variant.mode, Reading::Preset).octets()).unwrap_or_default()
        });
        Ok(())
    }
}

/// The octets cut or filled up with zeros to this length; none when it is longer than octets can be.
pub(crate) fn resized(octets: &Octets, length: usize) -> Octets {
    let mut all = [0; Octets::MAX];
    all.iter_mut().zip(octets.as_slice()).for_each(|(to, from)| *to = *from);
    all.get(..length).and_then(Octets::new).unwrap_or_default()
}

fn image_octets(variant: Variant) -> usize {
    variant.mode.spdu_octets(variant.pd_in.into())
}

/// All of a device but its link.
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
        describe(product, Clock { kind: ClockKind::Virtual, resolution_ns: 1, uncertainty_ns: 0 })
    }

    fn apply(
        &mut self,
        stimuli: &[Stimulus],
        observed: &mut Vec<Observation>,
        mut image: impl FnMut(Option<&Octets>, Variant) -> Octets,
    ) {
        for (position, stimulus) in (0..).zip(stimuli) {
            let mut seen = Sink { observed, stimulus: position, at: self.now };
            match stimulus {
                Stimulus::Configure(variant) if !self.powered && offers().iter().any(|o| o.covers(*variant)) => {
                    self.variant = *variant;
                }
                Stimulus::Power(on) => self.power(*on, &mut seen),
                Stimulus::Exchange { port: PORT, octets } => {
                    let octets = self.powered.then(|| image(octets.as_ref(), self.variant));
                    seen.push(Seen::Image { port: PORT, octets });
                }
                Stimulus::Exchange { port, .. } => {
                    seen.push(Seen::Unsupported);
                    seen.push(Seen::Image { port: *port, octets: None });
                }
                Stimulus::Read { index, .. } => seen.push(Seen::Value(vec![0; object_octets(*index)])),
                Stimulus::Write { .. } => seen.push(Seen::Written),
                Stimulus::Set { port: PORT, service: Service::PdinD | Service::SdsetDs, .. } => {}
                Stimulus::Advance { ns } => self.now = self.now.saturating_add(*ns),
                _ => seen.push(Seen::Unsupported),
            }
        }
    }

    fn power(&mut self, on: bool, seen: &mut Sink<'_>) {
        if on && !self.powered {
            seen.push_service(Service::PdoutD, Octets::zero(self.variant.pd_out.into()));
            for service in [Service::SetsdDc, Service::ChfackreqDc, Service::SclFault] {
                seen.push_service(service, Octets::bit(false));
            }
        }
        self.powered = on;
    }
}

/// Length of the FSP blocks, so that commissioning gets through; 2 for everything else.
fn object_octets(index: u16) -> usize {
    match index {
        0x4200 => 11,
        0x4201 => 12,
        _ => 2,
    }
}
