//! The bench of these tests: plays the FS-Master against one device, line by line as the sequence charts do.
#![allow(dead_code, reason = "each test file uses its part")]

use fsct_adapters::{Dut, Observation, Octets, Seen, Service, Stimulus, Variant};
use fsct_protocol::crc::Reading;
use fsct_protocol::fsp::{Authenticity, INDEX_AUTHENTICITY, INDEX_PROTOCOL, INDEX_VERIFY, Protocol};
use fsct_protocol::spdu::{Control, Pd, Status, View, Wire};
use fsct_protocol::{Edition, ProtMode};
use fsct_reference::{FsDevice, Mutant, Options};

pub const MS: u64 = 1_000_000;
pub const WATCHDOG_MS: u16 = 100;
pub const WATCHDOG: u64 = WATCHDOG_MS as u64 * MS;
/// FSP_Port; not its own inverse shifted, and not 1, so that a fixed port shows.
pub const PORT: u8 = 5;

pub fn variant(edition: Edition, mode: ProtMode, pd: u8) -> Variant {
    Variant { edition, mode, pd_out: pd, pd_in: pd }
}

/// The variant where it does not matter.
pub fn plain() -> Variant {
    variant(Edition::Iec2022, ProtMode::Crc16, 3)
}

/// An SPDU from the FS-Master with live process data, no fault and nothing set.
#[derive(Copy, Clone, Debug)]
pub struct Out {
    pub m_count: u8,
    pub set_sd: bool,
    pub ack_req: bool,
    pub port: u8,
    pub data: u8,
    pub bad_crc: bool,
}

pub fn m(m_count: u8) -> Out {
    Out { m_count, set_sd: false, ack_req: false, port: PORT, data: 0x50 + m_count, bad_crc: false }
}

impl Out {
    /// setSD and SDout.
    pub fn sd(self) -> Out {
        Out { set_sd: true, data: 0, ..self }
    }
    pub fn set_sd(self) -> Out {
        Out { set_sd: true, ..self }
    }
    pub fn ack_req(self) -> Out {
        Out { ack_req: true, ..self }
    }
    pub fn port(self, port: u8) -> Out {
        Out { port, ..self }
    }
    pub fn data(self, data: u8) -> Out {
        Out { data, ..self }
    }
    /// Corrupted on the way.
    pub fn bad(self) -> Out {
        Out { bad_crc: true, ..self }
    }

    pub fn octets(self, variant: Variant) -> Octets {
        let control = Control { mcount: self.m_count, set_sd: self.set_sd, ch_f_ack_req: self.ack_req };
        let pd = Pd::new(&vec![self.data; variant.pd_out.into()]).unwrap();
        let wire = Wire { pd, port_num: self.port, octet: control.to_octet(), signature: None };
        let mut spdu = wire.emit(variant.mode, Reading::Preset);
        if self.bad_crc {
            *spdu.octets_mut().last_mut().unwrap() ^= 0x10;
        }
        Octets::new(spdu.octets()).unwrap()
    }
}

/// The status of an answer.
pub fn d(dcount_i: u8) -> Status {
    Status { dcount_i, ..Status::default() }
}

pub trait StatusLine {
    fn sd_set(self) -> Status;
    fn comm_err(self) -> Status;
    fn timeout(self) -> Status;
}

impl StatusLine for Status {
    fn sd_set(self) -> Status {
        Status { sd_set: true, ..self }
    }
    fn comm_err(self) -> Status {
        Status { d_comm_err: true, ..self }
    }
    fn timeout(self) -> Status {
        Status { d_timeout: true, ..self }
    }
}

/// What the technology gets.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Use {
    SDout,
    PDout,
}
pub use Use::{PDout, SDout};

pub struct Bench<D = FsDevice> {
    pub device: D,
    pub variant: Variant,
    /// Image of the last exchange.
    pub image: Option<Octets>,
    /// Everything observed during the last `apply`.
    pub last: Vec<Observation>,
    services: Vec<(Service, Octets)>,
    sent: u8,
}

impl Bench {
    /// Fresh from the factory, power off.
    pub fn off(variant: Variant, options: Options) -> Bench {
        Bench::around(FsDevice::new(options), variant)
    }

    /// Powered, with factory settings.
    pub fn factory(variant: Variant) -> Bench {
        let mut bench = Bench::off(variant, Options::default());
        bench.power(true);
        bench
    }

    /// Commissioned, verified, in state 21.
    pub fn waiting_first_with(variant: Variant, options: Options) -> Bench {
        let mut bench = Bench::off(variant, options);
        bench.power(true);
        bench.commission(0);
        bench.verify();
        bench.set(Service::PdinD, &vec![0x1B; variant.pd_in.into()]);
        bench
    }

    pub fn waiting_first(variant: Variant) -> Bench {
        Bench::waiting_first_with(variant, Options::default())
    }

    /// State 24, MCount 0 to 3 done, SDcycles 0.
    pub fn operating_with(variant: Variant, options: Options) -> Bench {
        let mut bench = Bench::waiting_first_with(variant, options);
        bench.exchange(m(0).sd());
        (1..=3).for_each(|count| bench.exchange(m(count)));
        bench
    }

    pub fn operating(variant: Variant) -> Bench {
        let mut bench = Bench::operating_with(variant, Options::default());
        bench.expect(d(4), PDout);
        bench
    }

    /// State 26, MCount 4 arrived corrupted.
    pub fn after_comm_err(variant: Variant) -> Bench {
        let mut bench = Bench::operating(variant);
        bench.row(m(4).bad(), d(3).sd_set().comm_err(), SDout);
        bench
    }

    /// State 26, DTimer expired after MCount 3.
    pub fn after_timeout(variant: Variant) -> Bench {
        let mut bench = Bench::operating(variant);
        bench.advance(WATCHDOG);
        bench
    }

    pub fn mutant(mutant: Mutant) -> Options {
        Options { mutant: Some(mutant), ..Options::default() }
    }
}

impl<D: Dut> Bench<D> {
    /// A device of another kind, power off.
    pub fn around(device: D, variant: Variant) -> Bench<D> {
        let mut bench = Bench { device, variant, image: None, last: Vec::new(), services: Vec::new(), sent: 0 };
        bench.apply(&[Stimulus::Configure(variant)]);
        assert_eq!(bench.last, []);
        bench
    }

    pub fn apply(&mut self, stimuli: &[Stimulus]) {
        self.last.clear();
        self.device.apply(stimuli, &mut self.last).unwrap();
        for observation in &self.last {
            match &observation.seen {
                Seen::Image { octets, .. } => self.image = *octets,
                Seen::Service { service, value, .. } => {
                    self.services.retain(|(known, _)| known != service);
                    self.services.push((*service, *value));
                }
                _ => {}
            }
        }
    }

    pub fn seen(&self) -> Vec<Seen> {
        self.last.iter().map(|observation| observation.seen.clone()).collect()
    }

    pub fn events(&self) -> Vec<u16> {
        let code = |observation: &Observation| match observation.seen {
            Seen::Event { code, .. } => Some(code),
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
        self.apply(&[Stimulus::Set { port: 1, service, value: Octets::new(value).unwrap() }]);
    }

    #[track_caller]
    pub fn read(&mut self, index: u16, subindex: u8) -> Result<Vec<u8>, u16> {
        self.apply(&[Stimulus::Read { index, subindex }]);
        match self.seen().as_slice() {
            [Seen::Value(value)] => Ok(value.clone()),
            [Seen::Refused { error }] => Err(*error),
            other => panic!("a read was answered {other:?}"),
        }
    }

    #[track_caller]
    pub fn write(&mut self, index: u16, subindex: u8, data: &[u8]) -> Result<(), u16> {
        self.apply(&[Stimulus::Write { index, subindex, data: data.to_vec() }]);
        match self.last.first().map(|observation| &observation.seen) {
            Some(Seen::Written) => Ok(()),
            Some(Seen::Refused { error }) => Err(*error),
            other => panic!("a write was answered {other:?}"),
        }
    }

    /// Assigns authenticity, port and watchdog as a tool does.
    #[track_caller]
    pub fn commission(&mut self, tech_par_crc: u32) {
        self.write(INDEX_AUTHENTICITY, 0, &authenticity().to_octets()).unwrap();
        let protocol = Protocol { tech_par_crc, watchdog_ms: WATCHDOG_MS, ..self.protocol() };
        self.write(INDEX_PROTOCOL, 0, &protocol.to_octets()).unwrap();
    }

    /// The steps of commissioning and verification, whatever the answers hold.
    #[track_caller]
    pub fn commission_blindly(&mut self) {
        for (index, octets) in [(INDEX_AUTHENTICITY, 11), (INDEX_PROTOCOL, 12), (INDEX_VERIFY, 23)] {
            if index != INDEX_VERIFY {
                assert_eq!(self.read(index, 0).map(|value| value.len()), Ok(octets));
            }
            self.write(index, 0, &vec![0; octets]).unwrap();
        }
    }

    /// The stored protocol block.
    #[track_caller]
    pub fn protocol(&mut self) -> Protocol {
        Protocol::from_octets(&self.read(INDEX_PROTOCOL, 0).unwrap()).unwrap()
    }

    /// A verify record that agrees with the commissioned blocks.
    #[track_caller]
    pub fn record(&mut self) -> Vec<u8> {
        [&authenticity().to_octets()[..], &self.protocol().to_octets()[..]].concat()
    }

    #[track_caller]
    pub fn verify(&mut self) {
        let record = self.record();
        self.write(INDEX_VERIFY, 0, &record).unwrap();
    }

    pub fn exchange(&mut self, out: Out) {
        self.receive(Some(out.octets(self.variant)));
        self.sent = out.data;
    }

    pub fn receive(&mut self, octets: Option<Octets>) {
        self.apply(&[Stimulus::Exchange { port: 1, octets }]);
    }

    /// One exchange of a chart: sent, answered, handed to the technology.
    #[track_caller]
    pub fn row(&mut self, out: Out, status: Status, device_out: Use) {
        self.exchange(out);
        self.expect(status, device_out);
    }

    /// The image is a right answer with this status, and the technology gets this.
    #[track_caller]
    pub fn expect(&mut self, status: Status, device_out: Use) {
        assert_eq!(self.answer(), Some(status));
        let data = if device_out == SDout { 0 } else { self.sent };
        self.expect_service(Service::PdoutD, &vec![data; self.variant.pd_out.into()]);
    }

    /// The status of the image if that is a right SPDU with the PDin_D of this bench.
    pub fn answer(&self) -> Option<Status> {
        let image = self.image?;
        let spdu = View::new(image.as_slice(), self.variant.mode, self.variant.pd_in.into()).ok()?;
        let right = spdu.signature_matches(Reading::Preset)
            && spdu.port_num() == !PORT
            && spdu.pd().iter().all(|octet| *octet == 0x1B)
            && spdu.status().to_octet() == spdu.octet();
        right.then(|| spdu.status())
    }

    #[track_caller]
    pub fn expect_silence(&self) {
        let length = self.variant.mode.spdu_octets(self.variant.pd_in.into());
        assert_eq!(self.image, Some(Octets::zero(length)));
    }

    /// An exchange that changes nothing at all.
    #[track_caller]
    pub fn expect_ignored(&mut self, octets: Option<Octets>) {
        let (image, services) = (self.image, self.services.clone());
        self.receive(octets);
        assert_eq!(self.image, image);
        assert_eq!(self.services, services);
    }

    pub fn service(&self, service: Service) -> Option<Octets> {
        self.services.iter().find(|(known, _)| *known == service).map(|(_, value)| *value)
    }

    #[track_caller]
    pub fn expect_service(&self, service: Service, value: &[u8]) {
        assert_eq!(self.service(service), Octets::new(value), "{}", service.name());
    }
}

pub fn authenticity() -> Authenticity {
    Authenticity { authenticity_1: 0x1122_3344, authenticity_2: 0x5566_7788, port: PORT }
}
