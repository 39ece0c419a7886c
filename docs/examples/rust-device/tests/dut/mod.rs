//! The adapter: what fsct does to a DUT becomes calls of the stack, what the stack says becomes observations.

use fsct_conformance::adapters::{
    Clock, ClockKind, Description, Dut, DutError, Edition, Observation, Octets, Offer, Pco, ProtMode, Role, Seen,
    Service, Stimulus,
};
use rust_device::{Output, PROCESS_DATA, Stack};

/// The product on its test bench: the stack, and the time that fsct lets pass.
#[derive(Default)]
pub struct MyDevice {
    stack: Stack,
    now: u64,
}

impl Dut for MyDevice {
    fn hello(&mut self) -> Result<Description, DutError> {
        let size = (PROCESS_DATA as u8, PROCESS_DATA as u8);
        Ok(Description {
            role: Role::Device,
            ports: 1,
            pcos: vec![Pco::Power, Pco::Link, Pco::Acyclic, Pco::App, Pco::Clock],
            offers: vec![Offer { edition: Edition::Iec2022, mode: ProtMode::Crc16, pd_out: size, pd_in: size }],
            clock: Clock { kind: ClockKind::Virtual, resolution_ns: 1, uncertainty_ns: 0 },
            vendor: "Example Safety".to_owned(),
            product: "MyDevice".to_owned(),
            version: env!("CARGO_PKG_VERSION").to_owned(),
        })
    }

    fn apply(&mut self, stimuli: &[Stimulus], observed: &mut Vec<Observation>) -> Result<(), DutError> {
        for (stimulus, done) in (0..).zip(stimuli) {
            let answer = self.carry_out(done);
            while let Some((at, output)) = self.stack.output() {
                observed.push(Observation { stimulus, at, seen: seen(output) });
            }
            observed.extend(answer.map(|seen| Observation { stimulus, at: self.now, seen }));
        }
        Ok(())
    }
}

impl MyDevice {
    /// What the contract wants as an answer, when it wants one.
    fn carry_out(&mut self, stimulus: &Stimulus) -> Option<Seen> {
        match stimulus {
            Stimulus::Power(on) => self.stack.supply(*on),
            Stimulus::Advance { ns } => {
                self.now += ns;
                self.stack.tick(*ns);
            }
            Stimulus::Set { service: Service::SdsetDs, value, .. } => self.stack.set_safe(value.as_slice() == [1]),
            Stimulus::Set { service: Service::PdinD, value, .. } => match value.as_slice().try_into() {
                Ok(data) => self.stack.set_inputs(data),
                Err(_) => return Some(Seen::Unsupported),
            },
            Stimulus::Exchange { port, octets } => {
                let image = self.stack.cycle(octets.as_ref().map(Octets::as_slice));
                return Some(Seen::Image { port: *port, octets: image.and_then(|image| Octets::new(&image)) });
            }
            Stimulus::Read { index, subindex } => {
                let read = self.stack.read(*index, *subindex);
                return Some(read.map_or_else(|error| Seen::Refused { error }, Seen::Value));
            }
            Stimulus::Write { index, subindex, data } => {
                let written = self.stack.write(*index, *subindex, data);
                return Some(written.map_or_else(|error| Seen::Refused { error }, |()| Seen::Written));
            }
            // Also Configure: this product is one thing only.
            _ => return Some(Seen::Unsupported),
        }
        None
    }
}

fn seen(output: Output) -> Seen {
    let bit = |service, value| Seen::Service { port: 1, service, value: Octets::bit(value) };
    match output {
        Output::Data(data) => {
            Seen::Service { port: 1, service: Service::PdoutD, value: Octets::new(&data).unwrap_or_default() }
        }
        Output::SafeState(value) => bit(Service::SetsdDc, value),
        Output::AcknowledgePending(value) => bit(Service::ChfackreqDc, value),
        Output::Fault(value) => bit(Service::SclFault, value),
        Output::Event(code, qualifier) => Seen::Event { code, qualifier },
    }
}
