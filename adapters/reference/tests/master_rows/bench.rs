//! The bench of the FS-Master's tests: plays the FS-Device on one port, line by line as the sequence charts do.

use fsct_adapters::{
    Dut, Identity, Line, Mode, Observation, Octets, Response, Seen, Service, SmiRequest, SmiResult, SmiService, Source,
    Stimulus, Variant,
};
use fsct_protocol::crc::Reading;
use fsct_protocol::fsp::{Authenticity, IoStructure, IoTotals, Protocol};
use fsct_protocol::spdu::{Control, Pd, Status, Wire};
use fsct_protocol::{Edition, ProtMode};
use fsct_reference::{FsMaster, MasterMutant, MasterOptions};

pub const MS: u64 = 1_000_000;
pub const WATCHDOG_MS: u16 = 20;
pub const WATCHDOG: u64 = WATCHDOG_MS as u64 * MS;
/// The port, and FSP_Port: not 1, so that a fixed port shows.
pub const PORT: u8 = 2;
pub const VENDOR_ID: u16 = 0x04D2;
pub const DEVICE_ID: u32 = 0x00_1234;
/// What the FS-Device sends and what the gateway gives.
pub const LIVE_IN: u8 = 0xA5;
pub const LIVE_OUT: u8 = 0x5A;
pub const VOID: [u8; 2] = [0xFF, 0xF0];

pub use Edition::{Iec2022, V1_1};
pub use MasterIn::{PDin, SDin};

/// What is printed beside the lifeline of the FS-Master.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum MasterIn {
    SDin,
    PDin,
}

/// An SPDU from the FS-Device, live and without fault.
#[derive(Copy, Clone, Debug)]
pub struct In {
    pub status: Status,
    pub port_num: u8,
    pub bad_crc: bool,
}

pub fn d(dcount_i: u8) -> In {
    In { status: Status { dcount_i, ..Status::default() }, port_num: !PORT, bad_crc: false }
}

impl In {
    pub fn sd_set(mut self) -> In {
        self.status.sd_set = true;
        self
    }
    pub fn comm_err(mut self) -> In {
        self.status.d_comm_err = true;
        self.sd_set()
    }
    pub fn timeout(mut self) -> In {
        self.status.d_timeout = true;
        self.sd_set()
    }
    pub fn port_num(self, port_num: u8) -> In {
        In { port_num, ..self }
    }
    /// Corrupted on the way.
    pub fn bad(self) -> In {
        In { bad_crc: true, ..self }
    }
    pub fn octets(self) -> Octets {
        let wire = Wire {
            pd: Pd::new(&[LIVE_IN]).unwrap(),
            port_num: self.port_num,
            octet: self.status.to_octet(),
            signature: None,
        };
        let mut spdu = wire.emit(ProtMode::Crc16, Reading::Preset);
        if self.bad_crc {
            *spdu.octets_mut().last_mut().unwrap() ^= 1;
        }
        Octets::new(spdu.octets()).unwrap()
    }
}

/// An SPDU from the FS-Master with live process data.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Out {
    pub m_count: u8,
    pub set_sd: bool,
    pub ack_req: bool,
    pub data: u8,
}

pub fn m(m_count: u8) -> Out {
    Out { m_count, set_sd: false, ack_req: false, data: LIVE_OUT }
}

impl Out {
    /// setSD and SDout.
    pub fn sd(self) -> Out {
        Out { set_sd: true, data: 0, ..self }
    }
    pub fn ack_req(self) -> Out {
        Out { ack_req: true, ..self }
    }
    pub fn octets(self) -> Octets {
        let control = Control { mcount: self.m_count, set_sd: self.set_sd, ch_f_ack_req: self.ack_req };
        let wire =
            Wire { pd: Pd::new(&[self.data]).unwrap(), port_num: PORT, octet: control.to_octet(), signature: None };
        Octets::new(wire.emit(ProtMode::Crc16, Reading::Preset).octets()).unwrap()
    }
}

/// FSPortConfigList, field by field: SAFETYCOM, armed, one octet of process data each way.
#[derive(Copy, Clone, Debug)]
pub struct List {
    pub edition: Edition,
    pub port_mode: u8,
    pub validation: u8,
    pub iq_behavior: u8,
    pub cycle_time: u8,
    pub vendor_id: u16,
    pub device_id: u32,
    pub nsr: (u8, u8),
    pub time_to_ready: u16,
    pub min_shut_down: u16,
    pub authenticity: Authenticity,
    pub protocol: Protocol,
    pub spdu: (u8, u8),
}

impl List {
    pub fn new(edition: Edition) -> List {
        let io = IoTotals { range: 5, bits: 8, octets: 1, int16: 0, int32: 0 };
        let structure = IoStructure { version: 1, input: io, output: io };
        List {
            edition,
            port_mode: 49,
            validation: 2,
            iq_behavior: 0,
            cycle_time: 0,
            vendor_id: VENDOR_ID,
            device_id: DEVICE_ID,
            nsr: (0, 0),
            time_to_ready: 300,
            min_shut_down: 200,
            authenticity: Authenticity { authenticity_1: 0x1122_3344, authenticity_2: 0x5566_7788, port: PORT },
            protocol: Protocol {
                version: 1,
                mode: 1,
                watchdog_ms: WATCHDOG_MS,
                io_struct_crc: structure.signature(),
                tech_par_crc: 0xCAFE_F00D,
            },
            spdu: (5, 5),
        }
    }

    /// In the order of v1.1 Table 22 and iec2022 Table 21.
    pub fn octets(&self) -> Vec<u8> {
        let mut list = if self.edition == V1_1 { vec![0x80, 0x01] } else { vec![0x81, 0x00] };
        list.extend([self.port_mode, self.validation, self.iq_behavior, self.cycle_time]);
        list.extend(self.vendor_id.to_be_bytes());
        list.extend(self.device_id.to_be_bytes());
        if self.edition == V1_1 {
            list.extend([self.nsr.0, self.nsr.1]);
        } else {
            list.extend(self.time_to_ready.to_be_bytes());
            list.extend(self.min_shut_down.to_be_bytes());
        }
        list.extend(self.authenticity.to_octets());
        list.extend(self.protocol.to_octets());
        list.extend([1, self.spdu.0, 8, 1, 0, 0, self.spdu.1, 8, 1, 0, 0]);
        list
    }

    /// How long a port waits for the Ready pulse, and how long its supply stays off.
    pub fn times(&self) -> (u64, u64) {
        match self.edition {
            V1_1 => (5_000 * MS, 1_000 * MS),
            Iec2022 => (u64::from(self.time_to_ready) * 10 * MS, u64::from(self.min_shut_down) * 10 * MS),
        }
    }
}

pub fn identity() -> Identity {
    Identity {
        revision_id: 0x11,
        com: 3,
        min_cycle_time: 10,
        pd_in: 5,
        pd_out: 5,
        vendor_id: VENDOR_ID,
        device_id: DEVICE_ID,
    }
}

pub fn with(mutant: Option<MasterMutant>) -> MasterOptions {
    MasterOptions { mutant, ..MasterOptions::default() }
}

/// The output services of the port as reported last.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Services {
    pub pdin_m: Vec<u8>,
    pub sdset_s: bool,
    pub chfackreq_s: bool,
    pub faults_s: bool,
    pub qualifier: bool,
}

/// One FS-Master and what is connected to its port.
pub struct Bench {
    pub master: FsMaster,
    pub list: List,
    pub services: Services,
    /// What the last stimulus yielded.
    pub last: Vec<Observation>,
    /// What all of them did.
    pub seen: Vec<Observation>,
}

impl Bench {
    /// Power on, no port configured.
    pub fn idle(edition: Edition, options: MasterOptions) -> Bench {
        let mut bench = Bench {
            master: FsMaster::new(options),
            list: List::new(edition),
            services: Services::default(),
            last: Vec::new(),
            seen: Vec::new(),
        };
        bench.apply(Stimulus::Configure(Variant { edition, mode: ProtMode::Crc16, pd_out: 1, pd_in: 1 }));
        bench.apply(Stimulus::Power(true));
        bench
    }

    /// Configured as `list` says, supply on: the Ready pulse is waited for.
    pub fn configured(list: List, options: MasterOptions) -> Bench {
        let mut bench = Bench::idle(list.edition, options);
        bench.list = list;
        bench.configure();
        bench
    }

    /// State 2: the first SPDU stands.
    pub fn waiting_first(edition: Edition, mutant: Option<MasterMutant>) -> Bench {
        let mut bench = Bench::configured(List::new(edition), with(mutant));
        bench.connect();
        bench.set(Service::PdoutM, &[LIVE_OUT]);
        bench.expect_out(None, m(0).sd());
        bench
    }

    /// State 5: `m_count` stands, start-up of the FS-Device is over, data are live both ways.
    pub fn operate_mutant(m_count: u8, mutant: Option<MasterMutant>) -> Bench {
        let mut bench = Bench::waiting_first(Iec2022, mutant);
        for (answer, out) in [(7, 1), (6, 2), (5, 3)] {
            bench.step(d(answer).sd_set());
            assert_eq!(bench.image(), Some(m(out).octets()));
        }
        bench.row(d(4), m(4), PDin);
        for standing in [4, 5, 6, 7, 1, 2].into_iter().take_while(|standing| *standing != m_count) {
            bench.row(d(7 - standing), m(standing % 7 + 1), PDin);
        }
        bench
    }

    pub fn operate(m_count: u8) -> Bench {
        Bench::operate_mutant(m_count, None)
    }

    /// State 7 behind T7: MCount 5 stands.
    pub fn after_fault(mutant: Option<MasterMutant>) -> Bench {
        let mut bench = Bench::operate_mutant(4, mutant);
        bench.step(d(3).bad());
        bench
    }

    /// State 7 behind T8: MCount 0 stands, its MTimer has just begun.
    pub fn after_timeout(mutant: Option<MasterMutant>) -> Bench {
        let mut bench = Bench::operate_mutant(4, mutant);
        bench.advance(WATCHDOG);
        bench
    }

    pub fn apply(&mut self, stimulus: Stimulus) -> Vec<Seen> {
        self.last.clear();
        self.master.apply(&[stimulus], &mut self.last).unwrap();
        for observation in &self.last {
            if let Seen::Service { port: PORT, service, value } = &observation.seen {
                match service {
                    Service::PdinM => self.services.pdin_m = value.as_slice().to_vec(),
                    Service::SdsetS => self.services.sdset_s = value.is_set(),
                    Service::ChfackreqS => self.services.chfackreq_s = value.is_set(),
                    Service::FaultsS => self.services.faults_s = value.is_set(),
                    Service::Qualifier => self.services.qualifier = value.is_set(),
                    other => panic!("{other:?} is no output of an FS-Master"),
                }
            }
        }
        self.seen.extend(self.last.clone());
        self.last.iter().map(|observation| observation.seen.clone()).collect()
    }

    pub fn advance(&mut self, ns: u64) -> Vec<Seen> {
        self.apply(Stimulus::Advance { ns })
    }

    pub fn set(&mut self, service: Service, value: &[u8]) {
        let port = if service == Service::FscpAuthenticity { 0 } else { PORT };
        let seen = self.apply(Stimulus::Set { port, service, value: Octets::new(value).unwrap() });
        assert!(!seen.contains(&Seen::Unsupported), "{service:?}");
    }

    pub fn press(&mut self) {
        self.set(Service::ChfackC, &[1]);
    }

    pub fn release(&mut self) {
        self.set(Service::ChfackC, &[0]);
    }

    // --- cyclic ---

    pub fn exchange(&mut self, octets: Option<Octets>) {
        self.apply(Stimulus::Exchange { port: PORT, octets });
    }

    /// The image presented in the last exchange.
    pub fn image(&self) -> Option<Octets> {
        match self.last.last().map(|observation| &observation.seen) {
            Some(Seen::Image { port: PORT, octets }) => *octets,
            other => panic!("an image is the last of an exchange, not {other:?}"),
        }
    }

    /// A millisecond passes, then the answer comes.
    pub fn step(&mut self, answer: In) {
        self.advance(MS);
        self.exchange(Some(answer.octets()));
    }

    pub fn expect_out(&mut self, answer: Option<In>, out: Out) {
        self.exchange(answer.map(In::octets));
        assert_eq!(self.image(), Some(out.octets()), "{out:?}");
    }

    /// A row of a chart: the answer, the SPDU it leads to, and what the gateway gets.
    pub fn row(&mut self, answer: In, out: Out, master_in: MasterIn) {
        self.step(answer);
        assert_eq!(self.image(), Some(out.octets()), "{answer:?} leads to {out:?}");
        let live = master_in == PDin;
        let data = if live { LIVE_IN } else { 0 };
        let Services { pdin_m, sdset_s, qualifier, .. } = &self.services;
        assert_eq!((pdin_m.as_slice(), *sdset_s, *qualifier), ([data].as_slice(), !live, live), "{answer:?}");
    }

    /// Nothing new is presented.
    pub fn expect_still(&mut self, answer: In, out: Out) {
        let before = self.services.clone();
        self.step(answer);
        assert_eq!((self.image(), &self.services), (Some(out.octets()), &before), "{answer:?} is ignored");
    }

    // --- port ---

    pub fn configure(&mut self) {
        let (list, expected) = (self.list.octets(), if self.list.edition == V1_1 { 0 } else { 0xFFF0 });
        assert!(self.smi(SmiService::PortConfiguration, PORT, expected, &list).positive);
    }

    pub fn plug(&mut self, device: Option<Identity>) -> Vec<Seen> {
        self.apply(Stimulus::Plug { port: PORT, device })
    }

    pub fn drive(&mut self, line: Line, level: bool) -> Vec<Seen> {
        self.apply(Stimulus::Drive { port: PORT, line, level })
    }

    /// A Ready pulse, and time for the wake-up.
    pub fn pulse(&mut self, width_ns: u64) {
        self.drive(Line::Cq, true);
        self.advance(width_ns);
        self.drive(Line::Cq, false);
        self.advance(MS);
    }

    pub fn respond(&mut self, response: Response) -> Vec<Seen> {
        self.apply(Stimulus::Respond { port: PORT, response })
    }

    /// Device, Ready pulse, verify record.
    pub fn connect(&mut self) {
        self.plug(Some(identity()));
        self.pulse(750_000);
        self.respond(Response::Written);
    }

    /// The modes commanded since power-on.
    pub fn modes(&self) -> Vec<Mode> {
        let mode = |observation: &Observation| match observation.seen {
            Seen::Mode { port: PORT, mode } => Some(mode),
            _ => None,
        };
        self.seen.iter().filter_map(mode).collect()
    }

    /// Levels of a line since power-on, each with its time.
    pub fn line(&self, wanted: Line) -> Vec<(u64, bool)> {
        let change = |observation: &Observation| match observation.seen {
            Seen::Line { port: PORT, line, level } if line == wanted => Some((observation.at, level)),
            _ => None,
        };
        self.seen.iter().filter_map(change).collect()
    }

    pub fn requests(&self) -> Vec<(u16, u8, Option<Vec<u8>>)> {
        let request = |observation: &Observation| match &observation.seen {
            Seen::Request { port: PORT, index, subindex, data } => Some((*index, *subindex, data.clone())),
            _ => None,
        };
        self.seen.iter().filter_map(request).collect()
    }

    /// EventCodes of SMI_PortEvent.
    pub fn port_events(&self) -> Vec<u16> {
        let event = |observation: &Observation| match observation.seen {
            Seen::Indication { port: PORT, source: Source::Port, code, .. } => Some(code),
            _ => None,
        };
        self.seen.iter().filter_map(event).collect()
    }

    // --- SMI ---

    pub fn smi(&mut self, service: SmiService, port: u8, expected: u16, octets: &[u8]) -> SmiResult {
        let request = SmiRequest { service, port, client_id: 0x4711, expected, octets: octets.to_vec() };
        let seen = self.apply(Stimulus::Smi(Box::new(request)));
        let mut results =
            seen.into_iter().filter_map(|seen| if let Seen::Smi(result) = seen { Some(*result) } else { None });
        let result = results.next().unwrap();
        assert_eq!((results.next(), result.client_id, result.port), (None, 0x4711, port));
        result
    }

    pub fn status(&mut self) -> Vec<u8> {
        let (expected, octets): (u16, &[u8]) = if self.list.edition == V1_1 { (0, &[]) } else { (0x9100, &VOID) };
        self.smi(SmiService::PortStatus, PORT, expected, octets).octets
    }

    /// PortStatusInfo.
    pub fn port_status_info(&mut self) -> u8 {
        self.status()[2]
    }

    pub fn power_off_on(&mut self, mode: u8, time_ms: u16) -> SmiResult {
        let (id, expected) = if self.list.edition == V1_1 { (0x7002u16, 0) } else { (0x7003, 0xFFF0) };
        let block = [id.to_be_bytes().as_slice(), &[mode], &time_ms.to_be_bytes()].concat();
        self.smi(SmiService::PortPowerOffOn, PORT, expected, &block)
    }
}
