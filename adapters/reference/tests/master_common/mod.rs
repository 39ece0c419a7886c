//! The bench of the FS-Master's tests: plays the FS-Device, the wires and the SMI client of one port, line by line as the
//! sequence charts do.
#![allow(dead_code, reason = "each test file uses its part")]

mod list;

pub use list::{List, list};

use fsct_adapters::{
    Dut, Identity, Line, Mode, Observation, Octets, Response, Seen, Service, SmiRequest, SmiResult, SmiService,
    Stimulus, Variant,
};
use fsct_protocol::crc::Reading;
use fsct_protocol::spdu::{Control, Pd, Status, View, Wire};
use fsct_protocol::{Edition, ProtMode};
use fsct_reference::{FsMaster, MasterMutant, MasterOptions};

pub const US: u64 = 1_000;
pub const MS: u64 = 1_000_000;
pub const S: u64 = 1_000 * MS;
pub const WATCHDOG_MS: u16 = 100;
pub const WATCHDOG: u64 = WATCHDOG_MS as u64 * MS;
/// Port and FSP_Port; not 1, so that a fixed port shows.
pub const PORT: u8 = 2;
pub const CLIENT: u16 = 0x0C1D;
/// Value of each octet of PDin and PDout where they are live.
pub const PD_IN: u8 = 0x1B;
pub const PD_OUT: u8 = 0x5A;
pub const AUTHENTICITY: [u8; 8] = [0x11, 0x22, 0x33, 0x44, 0x55, 0x66, 0x77, 0x88];

pub fn variant(edition: Edition, mode: ProtMode, pd: u8) -> Variant {
    Variant { edition, mode, pd_out: pd, pd_in: pd }
}

/// The variant where it does not matter.
pub fn plain() -> Variant {
    variant(Edition::Iec2022, ProtMode::Crc16, 3)
}

pub fn of(edition: Edition) -> Variant {
    Variant { edition, ..plain() }
}

pub fn mutant(mutant: MasterMutant) -> MasterOptions {
    MasterOptions { mutant: Some(mutant), ..MasterOptions::default() }
}

/// An SPDU of the FS-Master with PDout_M.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Out {
    pub m_count: u8,
    pub set_sd: bool,
    pub ack_req: bool,
    pub data: u8,
}

pub fn m(m_count: u8) -> Out {
    Out { m_count, set_sd: false, ack_req: false, data: PD_OUT }
}

impl Out {
    /// setSD and SDout.
    pub fn sd(self) -> Out {
        Out { set_sd: true, data: 0, ..self }
    }
    pub fn ack_req(self) -> Out {
        Out { ack_req: true, ..self }
    }
}

/// An answer with live process data, no fault and nothing set.
#[derive(Copy, Clone, Debug)]
pub struct Answer {
    pub status: Status,
    pub port_num: u8,
    pub bad_crc: bool,
}

pub fn d(dcount_i: u8) -> Answer {
    Answer { status: Status { dcount_i, ..Status::default() }, port_num: !PORT, bad_crc: false }
}

impl Answer {
    pub fn sd_set(mut self) -> Answer {
        self.status.sd_set = true;
        self
    }
    pub fn comm_err(mut self) -> Answer {
        self.status.d_comm_err = true;
        self
    }
    pub fn timeout(mut self) -> Answer {
        self.status.d_timeout = true;
        self
    }
    pub fn port(self, port_num: u8) -> Answer {
        Answer { port_num, ..self }
    }
    /// Corrupted on the way.
    pub fn bad(self) -> Answer {
        Answer { bad_crc: true, ..self }
    }

    pub fn octets(self, variant: Variant) -> Octets {
        let pd = Pd::new(&vec![PD_IN; variant.pd_in.into()]).unwrap();
        let wire = Wire { pd, port_num: self.port_num, octet: self.status.to_octet(), signature: None };
        let mut spdu = wire.emit(variant.mode, Reading::Preset);
        if self.bad_crc {
            *spdu.octets_mut().last_mut().unwrap() ^= 0x10;
        }
        Octets::new(spdu.octets()).unwrap()
    }
}

/// What the gateway gets.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Use {
    SDin,
    PDin,
}
pub use Use::{PDin, SDin};

pub struct Bench<D = FsMaster> {
    pub master: D,
    pub variant: Variant,
    /// Image of the last exchange.
    pub image: Option<Octets>,
    /// Everything observed during the last `apply`.
    pub last: Vec<Observation>,
    services: Vec<(u8, Service, Octets)>,
}

impl Bench {
    /// Fresh from the factory, power off.
    pub fn off(variant: Variant, options: MasterOptions) -> Bench {
        Bench::around(FsMaster::new(options), variant)
    }

    /// Powered, no port configured, a right Device on the port.
    pub fn factory_with(variant: Variant, options: MasterOptions) -> Bench {
        let mut bench = Bench::off(variant, options);
        bench.power(true);
        bench.plug(Some(list(variant).identity()));
        bench
    }

    pub fn factory(variant: Variant) -> Bench {
        Bench::factory_with(variant, MasterOptions::default())
    }

    /// State 2: the first SPDU stands.
    pub fn waiting_first_with(variant: Variant, options: MasterOptions) -> Bench {
        let mut bench = Bench::factory_with(variant, options);
        bench.fscp(AUTHENTICITY);
        bench.configure(&list(variant));
        bench.start();
        bench.set(Service::PdoutM, &vec![PD_OUT; variant.pd_out.into()]);
        bench
    }

    pub fn waiting_first(variant: Variant) -> Bench {
        Bench::waiting_first_with(variant, MasterOptions::default())
    }

    /// State 5: MCount 0 to 3 answered, 4 stands.
    pub fn operate_with(variant: Variant, options: MasterOptions) -> Bench {
        let mut bench = Bench::waiting_first_with(variant, options);
        for answer in [d(7).sd_set(), d(6).sd_set(), d(5).sd_set(), d(4)] {
            bench.answer(answer);
        }
        bench
    }

    pub fn operate(variant: Variant) -> Bench {
        let bench = Bench::operate_with(variant, MasterOptions::default());
        bench.expect(m(4), PDin);
        bench
    }

    /// State 7: the answer to MCount 4 arrived corrupted, 5 stands.
    pub fn after_fault(variant: Variant) -> Bench {
        let mut bench = Bench::operate(variant);
        bench.row(d(3).bad(), m(5).sd(), SDin);
        bench
    }

    /// State 7: no answer to MCount 4, 0 stands.
    pub fn after_timeout(variant: Variant) -> Bench {
        let mut bench = Bench::operate(variant);
        bench.advance(WATCHDOG);
        bench.sends(m(0).sd(), SDin);
        bench
    }
}

impl<D: Dut> Bench<D> {
    /// A master of another kind, power off.
    pub fn around(master: D, variant: Variant) -> Bench<D> {
        let mut bench = Bench { master, variant, image: None, last: Vec::new(), services: Vec::new() };
        bench.apply(&[Stimulus::Configure(variant)]);
        assert_eq!(bench.last, []);
        bench
    }

    pub fn apply(&mut self, stimuli: &[Stimulus]) {
        self.last.clear();
        self.master.apply(stimuli, &mut self.last).unwrap();
        // What is driven comes back with its time stamp and says nothing of the FS-Master.
        self.last.retain(|observation| !matches!(observation.seen, Seen::Line { line: Line::Cq | Line::Iq, .. }));
        for observation in &self.last {
            match &observation.seen {
                Seen::Image { octets, .. } => self.image = *octets,
                Seen::Service { port, service, value } => {
                    self.services.retain(|known| (known.0, known.1) != (*port, *service));
                    self.services.push((*port, *service, *value));
                }
                _ => {}
            }
        }
    }

    pub fn seen(&self) -> Vec<Seen> {
        self.last.iter().map(|observation| observation.seen.clone()).collect()
    }

    /// What was seen and when.
    pub fn timed(&self) -> Vec<(u64, Seen)> {
        self.last.iter().map(|observation| (observation.at, observation.seen.clone())).collect()
    }

    /// EventCodes indicated.
    pub fn events(&self) -> Vec<u16> {
        let code = |observation: &Observation| match observation.seen {
            Seen::Indication { code, .. } => Some(code),
            _ => None,
        };
        self.last.iter().filter_map(code).collect()
    }

    pub fn power(&mut self, on: bool) {
        self.apply(&[Stimulus::Power(on)]);
    }

    pub fn advance(&mut self, ns: u64) {
        self.apply(&[Stimulus::Advance { ns }]);
    }

    pub fn set(&mut self, service: Service, value: &[u8]) {
        self.apply(&[Stimulus::Set { port: PORT, service, value: Octets::new(value).unwrap() }]);
    }

    pub fn ack(&mut self, level: u8) {
        self.set(Service::ChfackC, &[level]);
    }

    pub fn fscp(&mut self, authenticity: [u8; 8]) {
        let value = Octets::new(&authenticity).unwrap();
        self.apply(&[Stimulus::Set { port: 0, service: Service::FscpAuthenticity, value }]);
        assert_eq!(self.last, []);
    }

    pub fn plug(&mut self, device: Option<Identity>) {
        self.apply(&[Stimulus::Plug { port: PORT, device }]);
    }

    pub fn drive(&mut self, line: Line, level: bool) {
        self.apply(&[Stimulus::Drive { port: PORT, line, level }]);
    }

    pub fn respond(&mut self, response: Response) {
        self.apply(&[Stimulus::Respond { port: PORT, response }]);
    }

    /// C/Q high for so long.
    pub fn pulse(&mut self, ns: u64) {
        self.drive(Line::Cq, true);
        self.advance(ns);
        self.drive(Line::Cq, false);
    }

    /// The steps of a port start up to the verify record.
    pub fn start_up_to_record(&mut self) {
        self.pulse(700 * US);
        self.advance(100 * US);
    }

    /// All steps of a port start.
    pub fn start(&mut self) {
        self.start_up_to_record();
        self.respond(Response::Written);
    }

    #[track_caller]
    pub fn configure(&mut self, list: &List) {
        let result = self.smi(SmiService::PortConfiguration, PORT, &list.octets());
        assert!(result.positive, "{:02X?}", result.octets);
    }

    /// A request with the ExpArgBlockID that the edition wants.
    #[track_caller]
    pub fn smi(&mut self, service: SmiService, port: u8, octets: &[u8]) -> SmiResult {
        let expected = match (self.variant.edition, service) {
            (Edition::V1_1, _) => 0,
            (_, SmiService::MasterIdentification) => 0x0001,
            (_, SmiService::FsMasterAccess) => 0x0101,
            (_, SmiService::ReadbackPortConfiguration) => 0x8100,
            (_, SmiService::PortStatus) => 0x9100,
            (_, SmiService::DsToParServ) => 0x7000,
            (_, SmiService::DeviceRead) => 0x3000,
            (_, SmiService::PdIn) => 0x1001,
            (_, SmiService::PdInOut) => 0x1003,
            (_, SmiService::SpduIn) => 0x1101,
            (_, SmiService::FsPdInOut) => 0x1103,
            (_, SmiService::PdInIq) => 0x1FFE,
            _ => 0xFFF0,
        };
        self.request(service, port, expected, octets).expect("one result")
    }

    /// A read, with VoidBlock where the edition has one.
    #[track_caller]
    pub fn read(&mut self, service: SmiService) -> SmiResult {
        let void: &[u8] = if self.variant.edition == Edition::V1_1 { &[] } else { &[0xFF, 0xF0] };
        self.smi(service, PORT, void)
    }

    /// The one result of a request; `None` where it is unsupported.
    #[track_caller]
    pub fn request(&mut self, service: SmiService, port: u8, expected: u16, octets: &[u8]) -> Option<SmiResult> {
        let octets = octets.to_vec();
        self.apply(&[Stimulus::Smi(Box::new(SmiRequest { service, port, client_id: CLIENT, expected, octets }))]);
        let mut results = self.last.iter().filter_map(|observation| match &observation.seen {
            Seen::Smi(result) => Some(result.as_ref().clone()),
            _ => None,
        });
        let result = results.next()?;
        assert_eq!(results.next(), None);
        assert_eq!((result.port, result.client_id), (port, CLIENT));
        Some(result)
    }

    /// PortStatusInfo.
    #[track_caller]
    pub fn info(&mut self) -> u8 {
        self.read(SmiService::PortStatus).octets[2]
    }

    /// EventQualifiers and EventCodes of the DiagEntries.
    #[track_caller]
    pub fn diags(&mut self) -> Vec<(u8, u16)> {
        let octets = self.read(SmiService::PortStatus).octets;
        let from = if self.variant.edition == Edition::V1_1 { 15 } else { 16 };
        assert_eq!(octets.len(), from + 3 * usize::from(octets[from - 1]));
        octets[from..].chunks(3).map(|entry| (entry[0], u16::from_be_bytes([entry[1], entry[2]]))).collect()
    }

    pub fn receive(&mut self, octets: Option<Octets>) {
        self.apply(&[Stimulus::Exchange { port: PORT, octets }]);
    }

    pub fn answer(&mut self, answer: Answer) {
        self.receive(Some(answer.octets(self.variant)));
    }

    /// One exchange of a chart: the answer, the SPDU behind it, what the gateway gets.
    #[track_caller]
    pub fn row(&mut self, answer: Answer, out: Out, gateway: Use) {
        self.answer(answer);
        self.expect(out, gateway);
    }

    /// An exchange in which nothing came.
    #[track_caller]
    pub fn sends(&mut self, out: Out, gateway: Use) {
        self.receive(None);
        self.expect(out, gateway);
    }

    /// The image is a right SPDU of this kind, and the services go with it.
    #[track_caller]
    pub fn expect(&self, out: Out, gateway: Use) {
        assert_eq!(self.out(), Some(out));
        let data = if gateway == SDin { 0 } else { PD_IN };
        self.expect_service(Service::PdinM, &vec![data; self.variant.pd_in.into()]);
        self.expect_service(Service::SdsetS, &[u8::from(gateway == SDin)]);
        self.expect_service(Service::ChfackreqS, &[u8::from(out.ack_req)]);
        let bad = self.bit(Service::FaultsS) || self.bit(Service::SdsetS);
        self.expect_service(Service::Qualifier, &[u8::from(!bad)]);
    }

    /// The image as an SPDU, if it is a right one with the same octet all over its process data.
    pub fn out(&self) -> Option<Out> {
        let image = self.image?;
        let spdu = View::new(image.as_slice(), self.variant.mode, self.variant.pd_out.into()).ok()?;
        let Control { mcount, set_sd, ch_f_ack_req } = spdu.control();
        let data = spdu.pd().first().copied().unwrap_or(if set_sd { 0 } else { PD_OUT });
        let right = spdu.signature_matches(Reading::Preset)
            && spdu.port_num() == PORT
            && spdu.pd().iter().all(|octet| *octet == data)
            && spdu.control().to_octet() == spdu.octet();
        right.then_some(Out { m_count: mcount, set_sd, ack_req: ch_f_ack_req, data })
    }

    /// An exchange that changes nothing at all.
    #[track_caller]
    pub fn expect_ignored(&mut self, octets: Option<Octets>) {
        self.receive(None);
        let before = self.image;
        self.receive(octets);
        assert_eq!(self.seen(), [Seen::Image { port: PORT, octets: before }]);
    }

    pub fn service(&self, service: Service) -> Option<Octets> {
        self.services.iter().find(|known| (known.0, known.1) == (PORT, service)).map(|known| known.2)
    }

    pub fn bit(&self, service: Service) -> bool {
        self.service(service).is_some_and(|value| value.is_set())
    }

    #[track_caller]
    pub fn expect_service(&self, service: Service, value: &[u8]) {
        assert_eq!(self.service(service), Octets::new(value), "{}", service.name());
    }
}

pub fn l_plus(level: bool) -> Seen {
    Seen::Line { port: PORT, line: Line::Power, level }
}

pub fn wake_up() -> Seen {
    Seen::Line { port: PORT, line: Line::WakeUp, level: true }
}

pub fn mode(mode: Mode) -> Seen {
    Seen::Mode { port: PORT, mode }
}

pub fn record(list: &List) -> Seen {
    Seen::Request { port: PORT, index: 0x4202, subindex: 0, data: Some(list.record()) }
}
