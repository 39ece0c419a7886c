//! Each mutant of the FS-Master shows in one of these tours, which a Device, an operator and an SMI client take; the table of
//! what is told where is the difference itself.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod master_common;

use fsct_adapters::{Line, Response, Seen, Service, SmiRequest, SmiService, Stimulus, Variant};
use fsct_protocol::crc::Reading;
use fsct_protocol::spdu::{Pd, Status, Wire};
use fsct_protocol::{Edition, ProtMode};
use fsct_reference::{MasterMutant, MasterOptions};
use master_common::*;

/// Everything seen from here on, step by step.
struct Tour {
    bench: Bench,
    all: Vec<(u64, Seen)>,
}

impl Tour {
    fn new(bench: Bench) -> Tour {
        let mut tour = Tour { bench, all: Vec::new() };
        tour.note();
        tour
    }
    fn note(&mut self) {
        self.all.extend(self.bench.timed());
    }
    fn answer(&mut self, answer: Answer) {
        self.bench.answer(answer);
        self.note();
    }
    fn lost(&mut self, ns: u64) {
        self.bench.advance(ns);
        self.note();
        self.bench.receive(None);
        self.note();
    }
    fn receive(&mut self, octets: &[u8]) {
        self.bench.receive(fsct_adapters::Octets::new(octets));
        self.note();
    }
    fn set(&mut self, service: Service, value: &[u8]) {
        self.bench.set(service, value);
        self.note();
    }
    fn smi(&mut self, service: SmiService, port: u8, expected: u16, octets: &[u8]) {
        let octets = octets.to_vec();
        self.bench.apply(&[Stimulus::Smi(Box::new(SmiRequest { service, port, client_id: CLIENT, expected, octets }))]);
        self.note();
    }
    fn drive(&mut self, cq: bool, iq: bool, ns: u64) {
        self.bench.drive(Line::Cq, cq);
        self.note();
        self.bench.drive(Line::Iq, iq);
        self.note();
        self.bench.advance(ns);
        self.note();
    }
}

fn waiting(variant: Variant, options: MasterOptions) -> Tour {
    Tour::new(Bench::waiting_first_with(variant, options))
}

fn operate(variant: Variant, options: MasterOptions) -> Tour {
    Tour::new(Bench::operate_with(variant, options))
}

/// Start, silence, zeros, all there is to SDset and setSD_C, and the watchdog.
fn regular(variant: Variant, options: MasterOptions) -> Vec<(u64, Seen)> {
    let mut tour = waiting(variant, options);
    tour.set(Service::PdoutM, &[1, 2, 3]);
    tour.lost(2 * WATCHDOG);
    tour.receive(&vec![0; variant.mode.spdu_octets(3)]);
    for answer in [d(7).sd_set(), d(6).sd_set(), d(5).sd_set(), d(4), d(3).sd_set(), d(3), d(2)] {
        tour.answer(answer);
    }
    tour.receive(&vec![0; variant.mode.spdu_octets(3)]);
    tour.answer(d(2).sd_set());
    tour.set(Service::SetsdC, &[1]);
    tour.answer(d(1));
    tour.set(Service::SetsdC, &[0]);
    tour.answer(d(0));
    tour.lost(WATCHDOG / 2);
    tour.answer(d(6));
    tour.lost(WATCHDOG - 1);
    tour.answer(d(6));
    tour.lost(1);
    tour.lost(3 * WATCHDOG);
    tour.answer(d(7));
    tour.all
}

/// Every kind of wrong answer, each in an operation of its own.
fn errors(variant: Variant, options: MasterOptions) -> Vec<(u64, Seen)> {
    let kinds = [
        d(3).bad(),
        d(3).port(PORT),
        d(3).port(!PORT ^ 0x80),
        d(1),
        d(3).comm_err(),
        d(3).timeout(),
        d(3).sd_set().comm_err(),
    ];
    kinds.into_iter().flat_map(|answer| acknowledged(operate(variant, options), answer)).collect()
}

/// A fault, a timeout and another fault while the acknowledgment is asked for, held and pressed.
fn acknowledged(mut tour: Tour, fault: Answer) -> Vec<(u64, Seen)> {
    tour.answer(fault);
    tour.answer(d(2));
    tour.answer(d(1).bad());
    tour.set(Service::ChfackC, &[1]);
    tour.answer(d(0));
    tour.set(Service::ChfackC, &[0]);
    tour.answer(d(6));
    tour.answer(d(5));
    tour.lost(WATCHDOG);
    tour.set(Service::ChfackC, &[1]);
    tour.answer(d(7));
    tour.set(Service::ChfackC, &[0]);
    tour.answer(d(6));
    tour.set(Service::ChfackC, &[1]);
    tour.answer(d(5));
    tour.answer(d(4));
    tour.answer(d(3).bad());
    tour.answer(d(2));
    tour.all
}

/// The timeout right behind MCount 1: its answer has the counter of before.
fn timeout_behind_1(variant: Variant, options: MasterOptions) -> Vec<(u64, Seen)> {
    let mut tour = waiting(variant, options);
    tour.answer(d(7).sd_set());
    tour.lost(WATCHDOG);
    tour.answer(d(7).sd_set());
    tour.all
}

/// Signatures of 0 both ways, at the greatest length, one whose upper half is wrong, and one with a reserved bit falsified.
fn signatures(variant: Variant, options: MasterOptions) -> Vec<(u64, Seen)> {
    let mut tour = operate(variant, options);
    let status = Status { dcount_i: 3, ..Status::default() }.to_octet();
    let (mode, length) = (variant.mode, usize::from(variant.pd_in));
    // Two octets of the data can bring about any signature of 16 bits.
    let signed = |pd: &[u8], port_num: u8, octet: u8| match mode {
        ProtMode::Crc16 => fsct_protocol::crc::crc16(1, &[pd, &[port_num, octet]].concat()).into(),
        ProtMode::Crc32 => fsct_protocol::crc::crc32(1, &[pd, &[port_num, octet]].concat()),
    };
    let zero = |port_num: u8, octet: u8| {
        (0..=u16::MAX).find_map(|data| {
            let mut pd = vec![0; length - 2];
            pd.extend(data.to_be_bytes());
            (signed(&pd, port_num, octet) == 0).then_some(pd)
        })
    };
    if let Some(pd) = zero(!PORT, status) {
        let wire = Wire { pd: Pd::new(&pd).unwrap(), port_num: !PORT, octet: status, signature: None };
        let emitted = wire.emit(mode, Reading::Preset);
        tour.receive(emitted.octets());
    }
    let falsified = |answer: Answer, back: usize, bit: u8| {
        let mut octets = answer.octets(variant).as_slice().to_vec();
        let at = octets.len() - mode.signature_octets() - back;
        octets[at] ^= bit;
        octets
    };
    tour.receive(&falsified(d(3), 0, 0x80));
    tour.receive(&falsified(d(2), 1, 0x08));
    tour.answer(d(2).bad());
    tour.all
}

/// An Event, loss of communication, switching off and on.
fn ports(variant: Variant, options: MasterOptions) -> Vec<(u64, Seen)> {
    let mut tour = operate(variant, options);
    for code in [0x5010, 0xB0FF] {
        tour.bench.apply(&[Stimulus::Raise { port: PORT, code, qualifier: 0xF4 }]);
        tour.note();
    }
    services(&mut tour);
    tour.bench.plug(None);
    tour.note();
    services(&mut tour);
    tour.bench.advance(2 * S);
    tour.note();
    tour.bench.plug(Some(list(variant).identity()));
    for step in [Bench::start_up_to_record, |bench: &mut Bench| bench.respond(Response::Written)] {
        step(&mut tour.bench);
        tour.note();
    }
    tour.answer(d(7).sd_set());
    let id: u16 = if variant.edition == Edition::V1_1 { 0x7002 } else { 0x7003 };
    tour.smi(SmiService::PortPowerOffOn, PORT, 0xFFF0, &[(id >> 8) as u8, id as u8, 0, 3, 0xE8]);
    tour.bench.advance(4 * S);
    tour.note();
    tour.bench.pulse(700 * US);
    tour.note();
    tour.bench.advance(20 * S);
    tour.note();
    tour.smi(SmiService::PortPowerOffOn, PORT, 0xFFF0, &[(id >> 8) as u8, id as u8, 0, 0xFF, 0xFF]);
    tour.all
}

/// Fewer octets of PDout_M than of PDin_M.
fn sizes(variant: Variant, options: MasterOptions) -> Vec<(u64, Seen)> {
    operate(Variant { pd_out: 1, ..variant }, options).all
}

/// Each service with a right and some wrong requests.
fn services(tour: &mut Tour) {
    let v1_1 = tour.bench.variant.edition == Edition::V1_1;
    let void: &[u8] = if v1_1 { &[] } else { &[0xFF, 0xF0] };
    for (service, expected) in [
        (SmiService::MasterIdentification, 0x0001),
        (SmiService::ReadbackPortConfiguration, 0x8100),
        (SmiService::PortStatus, 0x9100),
        (SmiService::FsPdInOut, 0x1103),
        (SmiService::SpduIn, 0x1101),
    ] {
        tour.smi(service, PORT, expected, void);
        tour.smi(service, 9, expected, void);
        tour.smi(service, PORT, 0xFFF0, void);
        tour.smi(service, PORT, expected, &[void, &[0]].concat());
        tour.smi(service, PORT, expected, &[0x12, 0x34]);
        tour.smi(service, PORT, expected, &[0x12, 0x34, 0x56]);
    }
    let access = if v1_1 { vec![0; 5] } else { [vec![1, 0], vec![0; 9]].concat() };
    tour.smi(SmiService::FsMasterAccess, 0, 0x0101, &access);
}

/// The start of a port with these fields changed in its configuration, on a Device of another VendorID too.
fn starts(variant: Variant, options: MasterOptions) -> Vec<(u64, Seen)> {
    let mut all = Vec::new();
    for index in 0..11 {
        let mut wanted = list(variant);
        match index {
            1 => wanted.authenticity.authenticity_2 ^= 1,
            2 => wanted.authenticity.port = 1,
            3 => wanted.protocol.watchdog_ms = 0,
            4 => wanted.protocol.version = 2,
            7 => wanted.cycle_time = wanted.identity().min_cycle_time - 1,
            8 => wanted.port_mode = 5,
            9 => wanted.vendor_id = 0,
            10 => (wanted.port_mode, wanted.nsr) = (50, (32 - wanted.spdu_in, 32 - wanted.spdu_out)),
            _ => {}
        }
        let mut octets = wanted.octets();
        let record = if variant.edition == Edition::V1_1 { 14 } else { 16 };
        match index {
            5 => octets[record + 10] ^= 1,
            6 => octets[record + 22] ^= 1,
            _ => {}
        }
        let mut tour = Tour::new(Bench::factory_with(variant, options));
        tour.bench.fscp(AUTHENTICITY);
        tour.smi(SmiService::PortConfiguration, PORT, 0xFFF0, &octets);
        tour.bench.start_up_to_record();
        tour.note();
        tour.bench.respond(Response::Written);
        tour.note();
        tour.answer(d(7).sd_set());
        tour.lost(WATCHDOG);
        all.extend(tour.all);
    }
    let mut identity = list(variant).identity();
    identity.vendor_id ^= 1;
    let mut wanted = list(variant);
    wanted.validation = 2;
    let mut tour = Tour::new(Bench::factory_with(variant, options));
    tour.bench.plug(Some(identity));
    tour.smi(SmiService::PortConfiguration, PORT, 0xFFF0, &wanted.octets());
    tour.bench.start_up_to_record();
    tour.note();
    all.extend(tour.all);
    all
}

/// A Ready pulse and nobody who answers the wake-up, and a port without safety that gets no pulse.
fn unanswered(variant: Variant, options: MasterOptions) -> Vec<(u64, Seen)> {
    let mut tour = Tour::new(Bench::factory_with(variant, options));
    tour.bench.plug(None);
    tour.smi(SmiService::PortConfiguration, PORT, 0xFFF0, &list(variant).octets());
    tour.drive(true, false, 750 * US);
    tour.drive(false, false, 400 * MS);
    let mut all = tour.all;
    let mut wanted = list(variant);
    (wanted.port_mode, wanted.validation) = (2, 0);
    let mut tour = Tour::new(Bench::factory_with(variant, options));
    tour.smi(SmiService::PortConfiguration, PORT, 0xFFF0, &wanted.octets());
    tour.drive(false, false, 100 * MS);
    all.extend(tour.all);
    all
}

/// Two octets of data without safety relevance.
fn mixed(variant: Variant, options: MasterOptions) -> Vec<(u64, Seen)> {
    let mut tour = Tour::new(Bench::factory_with(variant, options));
    let mut wanted = list(variant);
    (wanted.port_mode, wanted.nsr) = (50, (2, 2));
    tour.bench.plug(Some(fsct_adapters::Identity {
        pd_in: wanted.spdu_in + 2,
        pd_out: wanted.spdu_out + 2,
        ..wanted.identity()
    }));
    tour.smi(SmiService::PortConfiguration, PORT, 0xFFF0, &wanted.octets());
    tour.bench.start();
    tour.note();
    tour.bench.receive(None);
    tour.note();
    tour.all
}

/// A start of the port in which the Device answers Data Storage: whether it asks for an upload, its checksum, and the ErrorType of
/// DS_Command, if it fails.
fn stored(tour: &mut Tour, flag: bool, checksum: u8, fails: Option<u16>) {
    tour.bench.start_up_to_record();
    // No start asks for more than this.
    for _ in 0..20 {
        tour.note();
        let asked = tour.bench.last.iter().rev().find_map(|observation| match &observation.seen {
            Seen::Request { index, subindex, data, .. } => Some((*index, *subindex, data.is_some())),
            _ => None,
        });
        let Some(asked) = asked else { return };
        tour.bench.respond(match (asked, fails) {
            ((0x0003, 1, true), Some(error)) => Response::Refused(error),
            ((_, _, true), _) => Response::Written,
            ((0x0003, 2, _), _) => Response::Value(vec![u8::from(flag) << 7]),
            ((0x0003, 4, _), _) => Response::Value(vec![checksum; 4]),
            ((0x0003, 5, _), _) => Response::Value(vec![0x42, 0x00, 0, 0x42, 0x01, 0, 0, 0]),
            _ => Response::Value(vec![1, 2, 3]),
        });
    }
}

/// Data Storage at every level, for commissioning, with another Device, refused, failed, and over a power cycle.
fn storage(variant: Variant, options: MasterOptions) -> Vec<(u64, Seen)> {
    let mut tour = Tour::new(Bench::factory_with(variant, options));
    let at = |validation: u8| List { validation, ..list(variant) };
    let configured = |tour: &mut Tour, list: List| {
        tour.smi(SmiService::PortConfiguration, PORT, 0xFFF0, &list.octets());
        tour.bench.plug(None);
        tour.bench.plug(Some(list.identity()));
        tour.bench.advance(12 * S);
        tour.note();
    };
    let commissioning = |validation: u8| {
        let mut list = at(validation);
        list.protocol.tech_par_crc = 0;
        list
    };
    configured(&mut tour, at(3));
    stored(&mut tour, false, 1, None);
    configured(&mut tour, at(4));
    stored(&mut tour, true, 2, Some(0x8022));
    configured(&mut tour, at(3));
    stored(&mut tour, false, 2, None);
    configured(&mut tour, List { device_id: 7, ..at(3) });
    stored(&mut tour, false, 1, None);
    configured(&mut tour, List { device_id: 8, ..at(3) });
    stored(&mut tour, false, 1, Some(0x8000));
    configured(&mut tour, at(2));
    tour.bench.start_up_to_record();
    tour.smi(SmiService::PortStatus, PORT, if variant.edition == Edition::V1_1 { 0 } else { 0x9100 }, &[0xFF, 0xF0]);
    configured(&mut tour, commissioning(3));
    stored(&mut tour, false, 1, None);
    tour.bench.power(false);
    tour.bench.power(true);
    tour.note();
    tour.all
}

/// Both lines of an OSSDe port: pulses, skews, faults, and the acknowledgment held and pressed.
fn ossde(variant: Variant, options: MasterOptions) -> Vec<(u64, Seen)> {
    let mut all = Vec::new();
    for first in [(true, true), (true, false)] {
        let mut tour = Tour::new(Bench::factory_with(variant, options));
        tour.drive(first.0, first.1, 0);
        let mut wanted = list(variant);
        (wanted.port_mode, wanted.spdu_in) = (51, 1);
        tour.smi(SmiService::PortConfiguration, PORT, 0xFFF0, &wanted.octets());
        tour.lost(10 * MS);
        tour.drive(true, true, 10 * MS);
        tour.drive(false, true, 900 * US);
        tour.drive(true, true, 10 * MS);
        tour.drive(false, true, 2 * MS);
        tour.drive(false, true, MS + 500 * US);
        tour.drive(true, true, 10 * MS);
        tour.drive(true, false, 10 * MS);
        tour.set(Service::ChfackC, &[1]);
        tour.drive(true, true, 10 * MS);
        tour.drive(true, false, 10 * MS);
        tour.set(Service::ChfackC, &[0]);
        tour.drive(true, true, 10 * MS);
        tour.set(Service::ChfackC, &[1]);
        all.extend(tour.all);
    }
    all
}

/// Whose results the bench itself refuses: they belong to no request.
const LEADS_ASTRAY: [MasterMutant; 2] = [MasterMutant::ClientIdNotReturned, MasterMutant::ResultOfPort1];

#[test]
fn a_result_may_lead_astray() {
    let back = |options: MasterOptions| {
        let mut tour = Tour::new(Bench::factory_with(plain(), options));
        tour.smi(SmiService::PortStatus, PORT, 0x9100, &[0xFF, 0xF0]);
        match tour.all.pop() {
            Some((_, Seen::Smi(result))) => (result.port, result.client_id),
            _ => panic!("no result"),
        }
    };
    assert_eq!(back(MasterOptions::default()), (PORT, CLIENT));
    assert_eq!(LEADS_ASTRAY.map(|which| back(mutant(which))), [(PORT, 0), (1, CLIENT)]);
}

/// No list of the bench is taken by it.
const TAKES_NO_LIST: MasterMutant = MasterMutant::ConfigLengthOfOtherEdition;

#[test]
fn a_list_has_the_length_of_its_edition() {
    for edition in [Edition::V1_1, Edition::Iec2022] {
        let variant = of(edition);
        let taken = |options: MasterOptions, octets: &[u8]| {
            Bench::factory_with(variant, options).smi(SmiService::PortConfiguration, PORT, octets).positive
        };
        let right = list(variant).octets();
        let mut other = right.clone();
        other.resize(if edition == Edition::V1_1 { 50 } else { 48 }, 0);
        let of_length = |options: MasterOptions| (taken(options, &right), taken(options, &other));
        assert_eq!(of_length(MasterOptions::default()), (true, false), "{edition}");
        assert_eq!(of_length(mutant(TAKES_NO_LIST)), (false, true), "{edition}");
    }
}

#[test]
fn each_mutant_shows() {
    type Look = fn(Variant, MasterOptions) -> Vec<(u64, Seen)>;
    let looks: [Look; 11] =
        [regular, errors, timeout_behind_1, signatures, ports, sizes, starts, mixed, ossde, unanswered, storage];
    let variants = |look: usize| {
        let pd = |mode: ProtMode| if look == 3 { mode.max_pd() as u8 } else { 3 };
        let of = move |edition, mode: ProtMode| variant(edition, mode, pd(mode));
        [Edition::V1_1, Edition::Iec2022]
            .map(|edition| [ProtMode::Crc16, ProtMode::Crc32].map(|mode| of(edition, mode)))
    };
    let right: Vec<Vec<(u64, Seen)>> = (0..looks.len())
        .flat_map(|look| variants(look).concat().into_iter().map(move |variant| (look, variant)))
        .map(|(look, variant)| looks[look](variant, MasterOptions::default()))
        .collect();
    let hidden: Vec<&str> = MasterMutant::ALL
        .iter()
        .filter(|which| !LEADS_ASTRAY.contains(which) && **which != TAKES_NO_LIST)
        .filter(|which| {
            let wrong = (0..looks.len())
                .flat_map(|look| variants(look).concat().into_iter().map(move |variant| (look, variant)))
                .map(|(look, variant)| looks[look](variant, mutant(**which)));
            right.iter().zip(wrong).all(|(right, wrong)| *right == wrong)
        })
        .map(|which| which.name())
        .collect();
    assert_eq!(hidden, [""; 0]);
}
