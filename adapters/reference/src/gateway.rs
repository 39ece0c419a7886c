//! A gateway of a safety fieldbus with safe inputs that is no FS-Master: no SCL, no FS port mode. Only what its host sees is
//! modelled, by the facts of the profile `gateway-f-di-f-do` (mix module, two-channel inputs, equivalence).
//!
//! PDin_M, told alike of each port, is the input image of the safety module without status octet and trailer: values of the
//! inputs, their qualifiers, qualifiers of the outputs. Ports 1 to 4 are X1 to X4; C/Q is channel A (pin 4), I/Q channel B
//! (pin 2). What the handbook gives no figure for, the discrepancy time, is that of SDCI-FS.

use crate::catalogue::catalogue;
use crate::device::Sink;
use crate::options::{OptionError, names, nearest};
use fsct_adapters::{
    Clock, ClockKind, Description, Dut, DutError, Line, Observation, Octets, Offer, Pco, Role, Seen, Service, Source,
    Stimulus,
};
use fsct_protocol::{Edition, ProtMode};

catalogue! {
    /// One deliberate fault of the reference gateway; its clauses are sections of the handbook.
    pub enum GatewayMutant {
        QualifierInverted "qualifier-inverted", "13.5.1":
            "GOOD is sent as 0 and BAD as 1."
        QualifierFirst "qualifier-first", "9.3.1":
            "The qualifiers of the inputs stand before their values."
        ChannelsReversed "channels-reversed", "9.3.1":
            "The first port is in the most significant bits."
        OutputQualifierShifted "output-qualifier-shifted", "9.3.1":
            "The qualifiers of the outputs are in the upper half of their octet."
        PassivatesAll "passivates-all", "13.5.1":
            "A fault of one port makes every port BAD."
        PassivatesOneChannel "passivates-one-channel", "13.5.1, 9.2.2":
            "A fault of a two-channel port makes its first channel BAD alone."
        ValueKept "value-kept", "9.2.2":
            "A BAD port keeps the value it had."
        DiscrepancyUnseen "discrepancy-unseen", "9.2.2":
            "Unequal channels are the state of the first one, GOOD."
        DiscrepancySilent "discrepancy-silent", "13.1.5":
            "A discrepancy is not told."
        AckBitSet "ack-bit-set", "13.5.1":
            "The acknowledgment is asked for while a fault stands, though none is needed."
        StaysBad "stays-bad", "13.5.1":
            "A port is BAD until power-off once it was."
        OpenLineHigh "open-line-high", "17.6":
            "Two open lines are read as 1."
    }
}

const PORTS: usize = 4;
/// Power-on to safe inputs.
const START_NS: u64 = 11_500_000_000;
/// OFF pulses up to here are not seen.
const FILTER_NS: u64 = 1_000_000;
/// Unequal channels for longer are a fault.
const DISCREPANCY_NS: u64 = 3_000_000;
/// EventCode of a discrepancy, and its EventQualifier when it appears.
const DISCREPANCY: (u16, u8) = (0x0126, 0xF4);
/// F-DO X5 A to X6 B, all GOOD: their outputs are not modelled.
const OUTPUTS_GOOD: u8 = 0b1111;

/// How the gateway is to behave.
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq)]
pub struct GatewayOptions {
    /// `mutant=NAME`: a deliberate fault.
    pub mutant: Option<GatewayMutant>,
    /// `ack=operator`: not as the product, which returns by itself (`ack=auto`), but as 11.11.5 has it.
    pub operator: bool,
}

impl GatewayOptions {
    /// Reads the decoded pairs of a query, in any order.
    ///
    /// # Errors
    /// [`OptionError`] for the first pair that names no option, gives it a value it cannot have, or repeats it.
    pub fn from_query(query: &[(String, String)]) -> Result<GatewayOptions, OptionError> {
        let mut options = GatewayOptions::default();
        for (known, value) in names(query, ["mutant", "ack"])? {
            match (known, value) {
                ("mutant", value) => {
                    options.mutant =
                        Some(GatewayMutant::from_name(value).ok_or_else(|| OptionError::UnknownMutant {
                            given: value.to_owned(),
                            nearest: nearest(value, GatewayMutant::ALL.iter().map(|mutant| mutant.name())),
                        })?);
                }
                (_, "auto") => options.operator = false,
                (_, "operator") => options.operator = true,
                _ => return Err(OptionError::BadAck { given: value.to_owned() }),
            }
        }
        Ok(options)
    }
}

/// One channel behind its filter.
#[derive(Copy, Clone, Debug, Default)]
struct Channel {
    raw: bool,
    filtered: bool,
    due: Option<u64>,
}

impl Channel {
    fn drive(&mut self, now: u64, level: bool) {
        if level != self.raw {
            self.raw = level;
            self.due = (level != self.filtered).then_some(now + FILTER_NS);
        }
    }

    fn pass(&mut self, now: u64) {
        if self.due.is_some_and(|due| due <= now) {
            self.filtered = self.raw;
            self.due = None;
        }
    }
}

/// A two-channel input.
#[derive(Copy, Clone, Debug, Default)]
struct Input {
    channels: [Channel; 2],
    /// When channels that differ are a fault.
    discrepancy_due: Option<u64>,
    fault: bool,
    /// With `ack=operator`: the fault has gone and nobody acknowledged.
    awaits: bool,
    ack: bool,
    /// Value while GOOD, for the mutant that keeps it.
    last: bool,
}

impl Input {
    fn due(&self) -> Option<u64> {
        self.channels.iter().map(|channel| channel.due).chain([self.discrepancy_due]).flatten().min()
    }

    fn equal(&self) -> bool {
        self.channels[0].filtered == self.channels[1].filtered
    }
}

/// What the host sees.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
struct Shown {
    image: [u8; 3],
    /// Of each port: GOOD, and acknowledgment asked for.
    ports: [(bool, bool); PORTS],
}

/// The gateway.
#[derive(Debug)]
pub struct Gateway {
    options: GatewayOptions,
    now: u64,
    /// When its inputs are read, while it has supply.
    ready_at: Option<u64>,
    inputs: [Input; PORTS],
    shown: Option<Shown>,
}

impl Gateway {
    /// A gateway with its power off, at time 0 of its clock.
    pub fn new(options: GatewayOptions) -> Gateway {
        Gateway { options, now: 0, ready_at: None, inputs: [Input::default(); PORTS], shown: None }
    }

    fn is(&self, mutant: GatewayMutant) -> bool {
        self.options.mutant == Some(mutant)
    }

    fn carry_out(&mut self, stimulus: &Stimulus, seen: &mut Sink<'_>) {
        match stimulus {
            // It has one variant alone.
            Stimulus::Configure(variant) if offers().iter().any(|offer| offer.covers(*variant)) => {}
            Stimulus::Power(true) => {
                self.ready_at = self.ready_at.or(Some(self.now + START_NS));
                self.inputs.iter_mut().for_each(|input| input.discrepancy_due = None);
            }
            Stimulus::Power(false) => {
                (self.ready_at, self.shown) = (None, None);
                for input in &mut self.inputs {
                    *input = Input { channels: input.channels, ..Input::default() };
                }
            }
            Stimulus::Drive { port, line: line @ (Line::Cq | Line::Iq), level } => {
                let channel = usize::from(*line == Line::Iq);
                match self.input(*port).and_then(|input| input.channels.get_mut(channel)) {
                    Some(channel) => channel.drive(seen.at, *level),
                    None => seen.push(Seen::Unsupported),
                }
            }
            Stimulus::Set { port, service: Service::ChfackC, value } => match self.input(*port) {
                Some(input) => {
                    let rising = value.is_set() && !input.ack;
                    input.ack = value.is_set();
                    input.awaits &= !rising;
                }
                None => seen.push(Seen::Unsupported),
            },
            Stimulus::Advance { ns } => return self.advance_to(self.now.saturating_add(*ns), seen),
            _ => return seen.push(Seen::Unsupported),
        }
        self.evaluate(seen);
    }

    fn input(&mut self, port: u8) -> Option<&mut Input> {
        self.inputs.get_mut(usize::from(port).checked_sub(1)?)
    }

    fn advance_to(&mut self, until: u64, seen: &mut Sink<'_>) {
        while let Some(due) =
            self.inputs.iter().filter_map(Input::due).chain(self.ready_at).filter(|due| *due > self.now).min()
            && due <= until
        {
            self.now = due;
            seen.at = due;
            self.evaluate(seen);
        }
        self.now = until;
        seen.at = until;
        self.evaluate(seen);
    }

    /// Filters, discrepancy and faults as they are now, and what of it is to be told.
    fn evaluate(&mut self, seen: &mut Sink<'_>) {
        let (now, operator) = (self.now, self.options.operator);
        let (unseen, stays) = (self.is(GatewayMutant::DiscrepancyUnseen), self.is(GatewayMutant::StaysBad));
        let ready = self.ready_at.is_some_and(|at| at <= now);
        for (port, input) in (1..).zip(&mut self.inputs) {
            input.channels.iter_mut().for_each(|channel| channel.pass(now));
            if input.equal() || !ready || unseen {
                input.discrepancy_due = None;
                input.awaits |= input.fault && operator;
                input.fault &= stays;
            } else {
                let due = *input.discrepancy_due.get_or_insert(now + DISCREPANCY_NS);
                if due <= now && !input.fault {
                    input.fault = true;
                    if self.options.mutant != Some(GatewayMutant::DiscrepancySilent) {
                        let (code, qualifier) = DISCREPANCY;
                        seen.push(Seen::Indication { port, source: Source::Port, qualifier, code });
                    }
                }
            }
        }
        if self.ready_at.is_some() {
            self.tell(ready, seen);
        }
    }

    fn tell(&mut self, ready: bool, seen: &mut Sink<'_>) {
        let mut values = 0u8;
        let mut qualifiers = 0u8;
        let mut ports = [(false, false); PORTS];
        let any_fault = self.inputs.iter().any(|input| input.fault);
        let all = self.is(GatewayMutant::PassivatesAll) && any_fault;
        let (kept, open) = (self.is(GatewayMutant::ValueKept), self.is(GatewayMutant::OpenLineHigh));
        let (one, asks) = (self.is(GatewayMutant::PassivatesOneChannel), self.is(GatewayMutant::AckBitSet));
        let operator = self.options.operator;
        for ((index, input), port) in (0..).zip(&mut self.inputs).zip(&mut ports) {
            let good = ready && !input.fault && !input.awaits && !all;
            let [a, b] = input.channels.map(|channel| channel.filtered);
            // While the channels differ for a moment the value is that of the lower one.
            let on = (a && (b || self.options.mutant == Some(GatewayMutant::DiscrepancyUnseen))) || (open && !a && !b);
            if good && input.equal() {
                input.last = on;
            }
            let value = if good { on } else { kept && input.last };
            let both = 0b11 << (2 * index);
            values |= if value { both } else { 0 };
            qualifiers |= match (good, one && ready) {
                (true, _) => both,
                (false, true) => 0b10 << (2 * index),
                (false, false) => 0,
            };
            let request = (operator && input.awaits && !input.fault) || (asks && input.fault);
            *port = (good, request);
        }
        let mut outputs = if ready { OUTPUTS_GOOD } else { 0 };
        match self.options.mutant {
            Some(GatewayMutant::QualifierInverted) => {
                qualifiers = !qualifiers;
                ports.iter_mut().for_each(|port| port.0 = !port.0);
            }
            Some(GatewayMutant::QualifierFirst) => (values, qualifiers) = (qualifiers, values),
            Some(GatewayMutant::ChannelsReversed) => {
                (values, qualifiers) = (values.reverse_bits(), qualifiers.reverse_bits());
            }
            Some(GatewayMutant::OutputQualifierShifted) => outputs <<= 4,
            _ => {}
        }
        let now = Shown { image: [values, qualifiers, outputs], ports };
        if self.shown.replace(now) == Some(now) {
            return;
        }
        for (port, (good, request)) in (1..).zip(ports) {
            let mut tell = |service, value| seen.push(Seen::Service { port, service, value });
            tell(Service::PdinM, Octets::new(&now.image).unwrap_or_default());
            tell(Service::Qualifier, Octets::bit(good));
            tell(Service::ChfackreqS, Octets::bit(request));
        }
    }
}

impl Dut for Gateway {
    fn hello(&mut self) -> Result<Description, DutError> {
        Ok(Description {
            role: Role::Master,
            ports: PORTS as u8,
            pcos: vec![Pco::Power, Pco::App, Pco::Line, Pco::Clock],
            offers: offers().to_vec(),
            clock: Clock { kind: ClockKind::Virtual, resolution_ns: 1, uncertainty_ns: 0 },
            vendor: "fsct".to_owned(),
            product: "reference gateway, no FS-Master".to_owned(),
            version: env!("CARGO_PKG_VERSION").to_owned(),
        })
    }

    fn apply(&mut self, stimuli: &[Stimulus], observed: &mut Vec<Observation>) -> Result<(), DutError> {
        for (position, stimulus) in (0..).zip(stimuli) {
            self.carry_out(stimulus, &mut Sink { observed, stimulus: position, at: self.now });
        }
        Ok(())
    }
}

/// The contract wants an edition and sizes: those its handbook is compared with, and the input image.
fn offers() -> [Offer; 2] {
    [Edition::V1_1, Edition::Iec2022].map(|edition| Offer {
        edition,
        mode: ProtMode::Crc16,
        pd_out: (1, 1),
        pd_in: (3, 3),
    })
}
