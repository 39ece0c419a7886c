//! Fixtures: a DUT simple enough to be known by heart, served or in place, and peers that misbehave.
#![allow(dead_code, reason = "each test binary uses its part")]
#![allow(clippy::unwrap_used, reason = "a test may panic")]

use fsct_adapters::{
    Address, Clock, ClockKind, Description, Dut, DutError, Identity, Line, Listener, Mode, Observation, Octets, Offer,
    Pco, Peer, Role, Seen, Service, SmiRequest, SmiResult, SmiService, Source, Stimulus, Stop, StreamDut, Variant,
    serve,
};
use fsct_protocol::{Edition, ProtMode};
use std::io::{Cursor, sink};
use std::net::{TcpListener, TcpStream};
use std::thread::{self, JoinHandle};
use std::time::Duration;

/// Short enough to wait for, where an answer never comes.
pub const SHORT: Duration = Duration::from_millis(250);
/// Long enough for any answer on a busy machine, where one comes.
pub const PATIENT: Duration = Duration::from_secs(20);

/// Presents what it received in the exchange before; an octet that is not 0 sets `setSD_DC` to its lowest bit.
#[derive(Debug, Default)]
pub struct Mirror {
    image: Option<Octets>,
    now: u64,
    set_sd: bool,
}

pub fn description() -> Description {
    Description {
        role: Role::Device,
        ports: 1,
        pcos: vec![Pco::Power, Pco::Link, Pco::Clock],
        offers: vec![Offer { edition: Edition::V1_1, mode: ProtMode::Crc16, pd_out: (0, 3), pd_in: (1, 2) }],
        clock: Clock { kind: ClockKind::Virtual, resolution_ns: 1000, uncertainty_ns: 0 },
        vendor: "a maker".to_owned(),
        product: "a mirror".to_owned(),
        version: "7".to_owned(),
    }
}

pub fn variant() -> Variant {
    Variant { edition: Edition::V1_1, mode: ProtMode::Crc16, pd_out: 3, pd_in: 2 }
}

pub fn octets(octets: &[u8]) -> Octets {
    Octets::new(octets).unwrap()
}

pub fn exchange(sent: &[u8]) -> Stimulus {
    Stimulus::Exchange { port: 1, octets: Some(octets(sent)) }
}

pub fn seen(stimulus: u16, at: u64, seen: Seen) -> Observation {
    Observation { stimulus, at, seen }
}

pub fn identity() -> Identity {
    Identity {
        revision_id: 0x11,
        com: 3,
        min_cycle_time: 10,
        pd_in: 7,
        pd_out: 7,
        vendor_id: 0x1234,
        device_id: 0x56_789A,
    }
}

/// Answered by a [`Mirror`] when it is for SMI_PortStatus.
pub fn smi(service: SmiService) -> Stimulus {
    Stimulus::Smi(Box::new(SmiRequest {
        service,
        port: 2,
        client_id: 0x0102,
        expected: 0x9100,
        octets: vec![0xFF, 0xF0],
    }))
}

/// What a [`Mirror`] says of a port: as long a list of diagnoses as there can be.
pub fn status(port: u8, client_id: u16) -> SmiResult {
    let octets = [&[0x91, 0x00][..], &[0xFF; 14 + 3 * 255]].concat();
    SmiResult { port, client_id, positive: true, reference: 0xFFF0, length: octets.len() as u16, octets }
}

impl Dut for Mirror {
    fn hello(&mut self) -> Result<Description, DutError> {
        Ok(description())
    }

    fn apply(&mut self, stimuli: &[Stimulus], observed: &mut Vec<Observation>) -> Result<(), DutError> {
        for (position, stimulus) in stimuli.iter().enumerate() {
            let mut push = |seen| observed.push(Observation { stimulus: position as u16, at: self.now, seen });
            match stimulus {
                Stimulus::Exchange { port, octets } => {
                    let set_sd = octets.is_some_and(|octets| octets.as_slice().first().is_some_and(|o| o & 1 == 1));
                    if set_sd != self.set_sd {
                        self.set_sd = set_sd;
                        push(Seen::Service { port: *port, service: Service::SetsdDc, value: Octets::bit(set_sd) });
                    }
                    push(Seen::Image { port: *port, octets: std::mem::replace(&mut self.image, *octets) });
                }
                Stimulus::Advance { ns } => self.now += ns,
                Stimulus::Power(_) | Stimulus::Configure(_) => {}
                Stimulus::Read { index: 0x10, .. } => push(Seen::Value(vec![0x4D; 232])),
                Stimulus::Read { .. } => push(Seen::Refused { error: 0x8011 }),
                Stimulus::Write { data, .. } if data == b"panic" => panic!("the DUT panics on demand"),
                Stimulus::Write { data, .. } if data == b"fail" => {
                    return Err(DutError::Contract { what: "the DUT fails on demand".to_owned() });
                }
                Stimulus::Write { .. } => {
                    push(Seen::Written);
                    push(Seen::Event { code: 0x1800, qualifier: 0xF4 });
                }
                // What only an FS-Master has: enough of one to see each of its observations.
                Stimulus::Plug { port, device } => {
                    push(Seen::Line { port: *port, line: Line::Power, level: device.is_some() });
                }
                Stimulus::Drive { port, line: Line::Cq, level: false } => {
                    push(Seen::Line { port: *port, line: Line::WakeUp, level: true });
                    push(Seen::Mode { port: *port, mode: Mode::Preoperate });
                    push(Seen::Request { port: *port, index: 0x4202, subindex: 0, data: Some(vec![0; 23]) });
                }
                Stimulus::Drive { line: Line::Cq | Line::Iq, .. } => {}
                Stimulus::Respond { port, .. } => push(Seen::Mode { port: *port, mode: Mode::Operate }),
                Stimulus::Raise { port, code, qualifier } => {
                    let (source, qualifier) = (Source::Device, *qualifier);
                    push(Seen::Indication { port: *port, source, qualifier, code: *code });
                }
                Stimulus::Smi(request) if request.service == SmiService::PortStatus => {
                    push(Seen::Smi(Box::new(status(request.port, request.client_id))));
                }
                Stimulus::Set { .. } | Stimulus::Other { .. } | Stimulus::Drive { .. } | Stimulus::Smi(_) => {
                    push(Seen::Unsupported);
                }
            }
        }
        Ok(())
    }
}

/// A server of mirrors that ends with this value.
pub struct Served {
    pub address: Address,
    pub stop: Stop,
    thread: Option<JoinHandle<std::io::Result<()>>>,
}

pub fn served(address: &str) -> Served {
    let listener = Listener::bind(&address.parse().unwrap()).unwrap();
    let (address, stop) = (listener.address().unwrap(), listener.stop().unwrap());
    let thread = thread::spawn(move || serve(&listener, &|| Box::<Mirror>::default()));
    Served { address, stop, thread: Some(thread) }
}

impl Drop for Served {
    fn drop(&mut self) {
        self.stop.stop();
        if let Some(thread) = self.thread.take() {
            thread.join().unwrap().unwrap();
        }
    }
}

/// The other end of a stream in memory.
pub struct Gone;

impl Peer for Gone {
    fn close(&mut self) -> String {
        String::new()
    }
}

/// A DUT that says these octets, whatever it is asked, and is gone.
pub fn says(octets: Vec<u8>) -> StreamDut {
    StreamDut::new(Cursor::new(octets), sink(), Box::new(Gone), PATIENT)
}

/// A peer that treats its first connection like this.
pub fn peer(act: impl FnOnce(TcpStream) + Send + 'static) -> Address {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = format!("tcp://{}", listener.local_addr().unwrap());
    thread::spawn(move || act(listener.accept().unwrap().0));
    address.parse().unwrap()
}
