//! The product of this example: an FS-Device stack with an API of its own, as a vendor has one.
//!
//! To be short it is a thin shell around the reference FS-Device. Nothing here is made for fsct; what makes a DUT of it is
//! `tests/dut/mod.rs`.

use fsct_adapters::{Dut, Observation, Octets, Seen, Service, Stimulus};
use fsct_reference::{FsDevice, Options};
use std::collections::VecDeque;

/// Octets of FS process data, the same both ways.
pub const PROCESS_DATA: usize = 3;

/// What the stack tells the application.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Output {
    /// Process data for the actuators.
    Data(Vec<u8>),
    /// Go to the safe state.
    SafeState(bool),
    /// An operator has to acknowledge.
    AcknowledgePending(bool),
    /// The stack has found a fault.
    Fault(bool),
    /// An Event for the Master: code and qualifier.
    Event(u16, u8),
}

/// The stack.
#[derive(Debug)]
pub struct Stack {
    inside: FsDevice,
    outputs: VecDeque<(u64, Output)>,
}

impl Default for Stack {
    fn default() -> Stack {
        Stack { inside: FsDevice::new(Options::default()), outputs: VecDeque::new() }
    }
}

impl Stack {
    /// Supply on or off.
    pub fn supply(&mut self, on: bool) {
        self.call(Stimulus::Power(on));
    }

    /// One cycle of process data: what came, if anything came, and what goes.
    pub fn cycle(&mut self, received: Option<&[u8]>) -> Option<Vec<u8>> {
        let octets = received.and_then(Octets::new);
        match self.call(Stimulus::Exchange { port: 1, octets }) {
            Some(Seen::Image { octets, .. }) => octets.map(|octets| octets.as_slice().to_vec()),
            _ => None,
        }
    }

    /// Reads a parameter; an error is an ErrorType.
    pub fn read(&mut self, index: u16, subindex: u8) -> Result<Vec<u8>, u16> {
        match self.call(Stimulus::Read { index, subindex }) {
            Some(Seen::Value(value)) => Ok(value),
            Some(Seen::Refused { error }) => Err(error),
            _ => Err(0),
        }
    }

    /// Writes a parameter; an error is an ErrorType.
    pub fn write(&mut self, index: u16, subindex: u8, data: &[u8]) -> Result<(), u16> {
        match self.call(Stimulus::Write { index, subindex, data: data.to_vec() }) {
            Some(Seen::Refused { error }) => Err(error),
            _ => Ok(()),
        }
    }

    /// Data of the sensors for the FS-Master.
    pub fn set_inputs(&mut self, data: [u8; PROCESS_DATA]) {
        let value = Octets::new(&data).unwrap_or_default();
        self.call(Stimulus::Set { port: 1, service: Service::PdinD, value });
    }

    /// The application is in its safe state.
    pub fn set_safe(&mut self, safe: bool) {
        self.call(Stimulus::Set { port: 1, service: Service::SdsetDs, value: Octets::bit(safe) });
    }

    /// The timer interrupt, with the time since the last one.
    pub fn tick(&mut self, nanoseconds: u64) {
        self.call(Stimulus::Advance { ns: nanoseconds });
    }

    /// The oldest output nobody has taken, and when it came.
    pub fn output(&mut self) -> Option<(u64, Output)> {
        self.outputs.pop_front()
    }

    fn call(&mut self, stimulus: Stimulus) -> Option<Seen> {
        let mut seen = Vec::new();
        self.inside.apply(&[stimulus], &mut seen).ok()?;
        let mut answer = None;
        for Observation { at, seen, .. } in seen {
            let output = match seen {
                Seen::Service { service, value, .. } => {
                    let octets = value.as_slice();
                    let bit = octets == [1];
                    match service {
                        Service::PdoutD => Output::Data(octets.to_vec()),
                        Service::SetsdDc => Output::SafeState(bit),
                        Service::ChfackreqDc => Output::AcknowledgePending(bit),
                        _ => Output::Fault(bit),
                    }
                }
                Seen::Event { code, qualifier } => Output::Event(code, qualifier),
                other => {
                    answer = Some(other);
                    continue;
                }
            };
            self.outputs.push_back((at, output));
        }
        answer
    }
}
