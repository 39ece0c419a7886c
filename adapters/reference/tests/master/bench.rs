//! A reference FS-Master with an FS-Device on port 1, and lines that read like the charts of 11.5.4.

use fsct_adapters::{
    Dut, Identity, Line, Mode, Observation, Octets, Response, Seen, Service, SmiRequest, SmiResult, SmiService,
    Stimulus, Variant,
};
use fsct_protocol::crc::Reading;
use fsct_protocol::fsp::{Authenticity, IoStructure, IoTotals, Protocol};
use fsct_protocol::spdu::{InSpdu, Pd, Port, Status, View, inv3};
use fsct_protocol::{Edition, ProtMode};
use fsct_reference::{FsMaster, MasterOptions};

pub const MS: u64 = 1_000_000;
/// FSP_Watchdog of every bench here.
pub const WATCHDOG_MS: u16 = 20;
pub const VENDOR_ID: u16 = 0x04D2;
pub const DEVICE_ID: u32 = 0x00_1234;

/// The bench.
pub struct Bench {
    pub dut: FsMaster,
    pub edition: Edition,
    /// Everything seen since [`Bench::forget`].
    pub seen: Vec<Observation>,
    /// PDin_M, SDset_S, ChFAckReq_S, qualifier as reported last.
    pub pdin: Vec<u8>,
    pub sd_set_s: bool,
    pub ch_f_ack_req_s: bool,
    pub good: bool,
}

/// What an FS-Master presents.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Shown {
    pub mcount: u8,
    pub set_sd: bool,
    pub ch_f_ack_req: bool,
    pub safe: bool,
}

/// `shown(5, 1, 0)`: MCount, setSD, ChFAckReq; with setSD the data are safe.
pub fn shown(mcount: u8, set_sd: u8, ch_f_ack_req: u8) -> Shown {
    Shown { mcount, set_sd: set_sd == 1, ch_f_ack_req: ch_f_ack_req == 1, safe: set_sd == 1 }
}

impl Bench {
    /// Supplied, nothing configured.
    pub fn idle(edition: Edition, options: MasterOptions) -> Bench {
        let mut bench = Bench {
            dut: FsMaster::new(options),
            edition,
            seen: Vec::new(),
            pdin: Vec::new(),
            sd_set_s: false,
            ch_f_ack_req_s: false,
            good: true,
        };
        bench.apply(&[Stimulus::Configure(Variant { edition, mode: ProtMode::Crc16, pd_out: 1, pd_in: 1 })]);
        bench.apply(&[Stimulus::Power(true)]);
        bench
    }

    /// Port 1 in OPERATE, the first SPDU stands.
    pub fn waiting(edition: Edition, options: MasterOptions) -> Bench {
        let mut bench = Bench::idle(edition, options);
        bench.configure(bench.list());
        bench.connect();
        assert_eq!(bench.exchange(None), Some(shown(0, 1, 0)));
        bench
    }

    /// State 5: MCount 4 stands, live data both ways.
    pub fn operate(edition: Edition, options: MasterOptions) -> Bench {
        let mut bench = Bench::waiting(edition, options);
        bench.set(Service::PdoutM, Octets::new(&[0x5A]).expect("it fits"));
        for mcount in 1..=3 {
            assert_eq!(bench.answer(Status { sd_set: true, ..mirror(mcount - 1) }), shown(mcount, 0, 0));
        }
        assert_eq!(bench.answer(mirror(3)), shown(4, 0, 0));
        assert!(bench.good && !bench.sd_set_s && bench.pdin == [0xA5]);
        bench
    }

    /// State 7 after T7: MCount 5 stands.
    pub fn after_fault(edition: Edition, options: MasterOptions) -> Bench {
        let mut bench = Bench::operate(edition, options);
        assert_eq!(bench.falsified(mirror(4)), shown(5, 1, 0));
        bench
    }

    pub fn apply(&mut self, stimuli: &[Stimulus]) -> Vec<Seen> {
        let mut observed = Vec::new();
        self.dut.apply(stimuli, &mut observed).expect("it answers");
        for observation in &observed {
            match &observation.seen {
                Seen::Service { port: 1, service: Service::PdinM, value } => self.pdin = value.as_slice().to_vec(),
                Seen::Service { port: 1, service: Service::SdsetS, value } => self.sd_set_s = value.is_set(),
                Seen::Service { port: 1, service: Service::ChfackreqS, value } => self.ch_f_ack_req_s = value.is_set(),
                Seen::Service { port: 1, service: Service::Qualifier, value } => self.good = value.is_set(),
                _ => {}
            }
        }
        self.seen.extend(observed.clone());
        observed.into_iter().map(|observation| observation.seen).collect()
    }

    pub fn forget(&mut self) {
        self.seen.clear();
    }

    pub fn saw(&self, wanted: &Seen) -> bool {
        self.seen.iter().any(|observation| observation.seen == *wanted)
    }

    /// Modes port 1 has been commanded to.
    pub fn modes(&self) -> Vec<Mode> {
        let modes = self.seen.iter().filter_map(|observation| match observation.seen {
            Seen::Mode { port: 1, mode } => Some(mode),
            _ => None,
        });
        modes.collect()
    }

    pub fn pass(&mut self, ns: u64) {
        self.apply(&[Stimulus::Advance { ns }]);
    }

    pub fn set(&mut self, service: Service, value: Octets) {
        let port = if service == Service::FscpAuthenticity { 0 } else { 1 };
        assert_eq!(
            self.apply(&[Stimulus::Set { port, service, value }]).iter().filter(|s| **s == Seen::Unsupported).count(),
            0
        );
    }

    pub fn press(&mut self, pressed: bool) {
        self.set(Service::ChfackC, Octets::bit(pressed));
    }

    pub fn drive(&mut self, line: Line, level: bool) {
        self.apply(&[Stimulus::Drive { port: 1, line, level }]);
    }

    /// FSPortConfigList of this edition for one octet of process data each way, armed, octet by octet.
    pub fn list(&self) -> Vec<u8> {
        let io = IoTotals { range: 5, bits: 8, octets: 1, int16: 0, int32: 0 };
        let structure = IoStructure { version: 1, input: io, output: io };
        let authenticity = Authenticity { authenticity_1: 0x1122_3344, authenticity_2: 0, port: 1 };
        let protocol = Protocol {
            version: 1,
            mode: 1,
            watchdog_ms: WATCHDOG_MS,
            io_struct_crc: structure.signature(),
            tech_par_crc: 0xCAFE_F00D,
        };
        let mut list = match self.edition {
            Edition::V1_1 => vec![0x80, 0x01],
            Edition::Iec2022 => vec![0x81, 0x00],
        };
        list.extend([49, 2, 0, 0]);
        list.extend(VENDOR_ID.to_be_bytes());
        list.extend(DEVICE_ID.to_be_bytes());
        match self.edition {
            Edition::V1_1 => list.extend([0, 0]),
            Edition::Iec2022 => list.extend([0x01, 0xF4, 0x00, 0x64]),
        }
        list.extend(authenticity.to_octets());
        list.extend(protocol.to_octets());
        list.extend([1, 5, 8, 1, 0, 0, 5, 8, 1, 0, 0]);
        list
    }

    /// The 23 octets of the list that make up the verify record.
    pub fn record(&self) -> Vec<u8> {
        let from = if self.edition == Edition::V1_1 { 14 } else { 16 };
        self.list()[from..from + 23].to_vec()
    }

    pub fn smi(&mut self, service: SmiService, port: u8, expected: u16, octets: &[u8]) -> SmiResult {
        let request = SmiRequest { service, port, client_id: 0x4711, expected, octets: octets.to_vec() };
        let seen = self.apply(&[Stimulus::Smi(Box::new(request))]);
        let results: Vec<SmiResult> = seen
            .into_iter()
            .filter_map(|seen| match seen {
                Seen::Smi(result) => Some(*result),
                _ => None,
            })
            .collect();
        assert_eq!(results.len(), 1, "exactly one result");
        results.into_iter().next().expect("one")
    }

    pub fn configure(&mut self, list: Vec<u8>) {
        let expected = if self.edition == Edition::V1_1 { 0 } else { 0xFFF0 };
        assert!(self.smi(SmiService::PortConfiguration, 1, expected, &list).positive);
    }

    pub fn plug(&mut self) {
        let device = Identity {
            revision_id: 0x11,
            com: 3,
            min_cycle_time: 10,
            pd_in: 5,
            pd_out: 5,
            vendor_id: VENDOR_ID,
            device_id: DEVICE_ID,
        };
        self.apply(&[Stimulus::Plug { port: 1, device: Some(device) }]);
    }

    pub fn pulse(&mut self, width_ns: u64) {
        self.drive(Line::Cq, true);
        self.pass(width_ns);
        self.drive(Line::Cq, false);
        self.pass(MS);
    }

    /// Device, Ready pulse, and the answer to the record.
    pub fn connect(&mut self) {
        self.plug();
        self.pulse(750_000);
        self.apply(&[Stimulus::Respond { port: 1, response: Response::Written }]);
    }

    /// One exchange a millisecond after the one before.
    pub fn exchange(&mut self, octets: Option<Octets>) -> Option<Shown> {
        let seen = self.apply(&[Stimulus::Advance { ns: MS }, Stimulus::Exchange { port: 1, octets }]);
        let image = seen.into_iter().rev().find_map(|seen| match seen {
            Seen::Image { port: 1, octets } => Some(octets),
            _ => None,
        });
        let image = image.expect("exactly one image")?;
        let view = View::new(image.as_slice(), ProtMode::Crc16, 1).expect("an SPDU");
        if view.is_all_zero() {
            return None;
        }
        assert!(view.signature_matches(Reading::Preset) && view.port_num() == 1);
        let control = view.control();
        let safe = view.pd() == [0];
        Some(Shown { mcount: control.mcount, set_sd: control.set_sd, ch_f_ack_req: control.ch_f_ack_req, safe })
    }

    /// An answer with process data A5.
    pub fn answer(&mut self, status: Status) -> Shown {
        self.exchange(Some(spdu(status, 0xA5))).expect("an SPDU")
    }

    /// The same with its last bit inverted.
    pub fn falsified(&mut self, status: Status) -> Shown {
        let mut octets = spdu(status, 0xA5).as_slice().to_vec();
        if let Some(last) = octets.last_mut() {
            *last ^= 1;
        }
        self.exchange(Octets::new(&octets)).expect("an SPDU")
    }

    /// Nothing comes for so many exchanges.
    pub fn silence(&mut self, exchanges: u16) -> Shown {
        let mut last = None;
        for _ in 0..exchanges {
            last = self.exchange(None);
        }
        last.expect("an SPDU")
    }
}

/// The status octet of a conformant answer to an SPDU with this counter.
pub fn mirror(mcount: u8) -> Status {
    Status { dcount_i: inv3(mcount), ..Status::default() }
}

pub fn spdu(status: Status, pd: u8) -> Octets {
    let spdu = InSpdu { pd: Pd::new(&[pd]).expect("it fits"), port: Port::ONE, status };
    Octets::new(spdu.wire().emit(ProtMode::Crc16, Reading::Preset).octets()).expect("it fits")
}
