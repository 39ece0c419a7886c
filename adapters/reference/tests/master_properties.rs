//! What holds whatever is done to the FS-Master: the contract, and live process data only where Table 38 allows them.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod master_common;

use fsct_adapters::{Dut, Identity, Line, Octets, Response, Seen, Service, SmiRequest, SmiService, Stimulus, Variant};
use fsct_protocol::{Edition, ProtMode};
use fsct_reference::{ConstantMaster, EchoMaster, FsMaster, MasterMutant, MasterOptions, NullMaster};
use master_common::*;
use proptest::prelude::*;

fn octets(most: usize) -> impl Strategy<Value = Octets> {
    prop::collection::vec(any::<u8>(), 0..=most).prop_map(|octets| Octets::new(&octets).unwrap())
}

fn variants() -> impl Strategy<Value = Variant> {
    let sizes = prop_oneof![(Just(ProtMode::Crc16), 0..5u8, 0..5u8), (Just(ProtMode::Crc32), 0..27u8, 0..27u8)];
    (prop::sample::select(Edition::ALL.to_vec()), sizes).prop_map(|(edition, (mode, pd_out, pd_in))| Variant {
        edition,
        mode,
        pd_out,
        pd_in,
    })
}

fn identities() -> impl Strategy<Value = Identity> {
    let right = list(plain()).identity();
    prop_oneof![
        Just(right),
        (any::<[u8; 3]>(), 0..=40u8, 0..=40u8).prop_map(move |([com, min_cycle_time, id], pd_in, pd_out)| Identity {
            com,
            min_cycle_time,
            pd_in,
            pd_out,
            vendor_id: right.vendor_id,
            device_id: right.device_id ^ u32::from(id & 1),
            ..right
        }),
    ]
}

/// A configuration that is right but for a few octets.
fn lists() -> impl Strategy<Value = Vec<u8>> {
    let modes = prop::sample::select(vec![0, 1, 2, 3, 4, 49, 50, 51]);
    (any::<bool>(), modes, prop::collection::vec((2..50usize, any::<u8>()), 0..3)).prop_map(
        |(first, port_mode, changes)| {
            let edition = if first { Edition::V1_1 } else { Edition::Iec2022 };
            let spdu_in = if port_mode == 51 { 1 } else { 7 };
            let mut octets = List { port_mode, spdu_in, ..list(of(edition)) }.octets();
            for (position, value) in changes {
                if let Some(octet) = octets.get_mut(position) {
                    *octet = value;
                }
            }
            octets
        },
    )
}

fn requests() -> impl Strategy<Value = SmiRequest> {
    let services = prop::sample::select(SmiService::ALL.map(|entry| entry.0).to_vec());
    let expected = prop_oneof![Just(0xFFF0u16), Just(0x1103), Just(0x9100), Just(0x3000), any::<u16>()];
    let blocks = prop_oneof![
        3 => lists(),
        1 => Just(vec![0xFF, 0xF0]),
        1 => (0..4u8, any::<[u8; 2]>()).prop_map(|(mode, time)| vec![0x70, 0x03, mode, time[0], time[1]]),
        1 => (0..4u8, any::<[u8; 2]>()).prop_map(|(mode, time)| vec![0x70, 0x02, mode, time[0], time[1]]),
        1 => Just(vec![0x30, 0x00, 0, 1, 0, 5]),
        1 => Just(vec![0x30, 0x01, 0, 1, 0]),
        1 => Just([vec![0x01, 0x00], vec![0; 9]].concat()),
        1 => prop::collection::vec(any::<u8>(), 0..60),
    ];
    (services, 0..4u8, expected, blocks).prop_map(|(service, port, expected, octets)| {
        let service = match octets.first_chunk() {
            Some([0x80, 0x01] | [0x81, 0x00]) => SmiService::PortConfiguration,
            Some([0x70, 0x02 | 0x03]) => SmiService::PortPowerOffOn,
            _ => service,
        };
        let expected = if service == SmiService::PortConfiguration { 0xFFF0 } else { expected };
        SmiRequest { service, port, client_id: CLIENT, expected, octets }
    })
}

/// Anything the contract can express.
fn stimuli() -> impl Strategy<Value = Stimulus> {
    let services: Vec<_> = Service::ALL.into_iter().map(|entry| entry.0).collect();
    let lines: Vec<_> = Line::ALL.into_iter().map(|entry| entry.0).collect();
    let responses = prop_oneof![
        Just(Response::Written),
        any::<u16>().prop_map(Response::Refused),
        prop::collection::vec(any::<u8>(), 0..4).prop_map(Response::Value),
    ];
    let times = prop_oneof![0..2 * MS, 0..10 * S, Just(86_400 * S / 24), any::<u64>()];
    prop_oneof![
        1 => variants().prop_map(Stimulus::Configure),
        1 => any::<bool>().prop_map(Stimulus::Power),
        3 => (0..4u8, prop::option::of(octets(32))).prop_map(|(port, octets)| Stimulus::Exchange { port, octets }),
        1 => (0..4u8, prop::sample::select(services), octets(32)).prop_map(|(port, service, value)| Stimulus::Set {
            port,
            service,
            value
        }),
        2 => (0..4u8, prop::option::of(identities())).prop_map(|(port, device)| Stimulus::Plug { port, device }),
        2 => (0..4u8, responses).prop_map(|(port, response)| Stimulus::Respond { port, response }),
        1 => (0..4u8, any::<u16>(), any::<u8>())
            .prop_map(|(port, code, qualifier)| Stimulus::Raise { port, code, qualifier }),
        3 => (0..4u8, prop::sample::select(lines), any::<bool>())
            .prop_map(|(port, line, level)| Stimulus::Drive { port, line, level }),
        4 => requests().prop_map(|request| Stimulus::Smi(Box::new(request))),
        4 => times.prop_map(|ns| Stimulus::Advance { ns }),
        1 => (any::<u16>(), any::<u8>()).prop_map(|(index, subindex)| Stimulus::Read { index, subindex }),
        1 => (any::<u8>(), prop::collection::vec(any::<u8>(), 0..4))
            .prop_map(|(kind, octets)| Stimulus::Other { kind, octets }),
    ]
}

/// Any mutant but those whose results belong to no request: the bench refuses them.
fn options() -> impl Strategy<Value = MasterOptions> {
    let astray = [MasterMutant::ClientIdNotReturned, MasterMutant::ResultOfPort1];
    let mutants: Vec<MasterMutant> =
        MasterMutant::ALL.iter().copied().filter(|which| !astray.contains(which)).collect();
    (prop::option::of(prop::sample::select(mutants)), 0..=8u8, 1..=3u8)
        .prop_map(|(mutant, latency, ports)| MasterOptions { mutant, latency, ports, ..MasterOptions::default() })
}

/// One image for an exchange, last; one result for a request, last; nothing before its time; lines and modes change.
fn contract_kept(master: &mut dyn Dut, stimuli: &[Stimulus], whole: bool) {
    let mut observed = Vec::new();
    master.apply(stimuli, &mut observed).unwrap();
    assert!(observed.windows(2).all(|pair| (pair[0].stimulus, pair[0].at) <= (pair[1].stimulus, pair[1].at)));
    for (position, stimulus) in stimuli.iter().enumerate() {
        let of_it = observed.iter().filter(|observation| usize::from(observation.stimulus) == position);
        let seen: Vec<_> = of_it.map(|observation| &observation.seen).collect();
        let count = |kind: fn(&Seen) -> bool| seen.iter().filter(|seen| kind(seen)).count();
        let images = count(|seen| matches!(seen, Seen::Image { .. }));
        let results = count(|seen| matches!(seen, Seen::Smi(_)));
        match stimulus {
            Stimulus::Exchange { .. } => {
                assert_eq!((images, results), (1, 0));
                assert!(matches!(seen.last(), Some(Seen::Image { .. })));
            }
            Stimulus::Smi(_) => {
                assert_eq!(images, 0);
                assert!(matches!(seen.last(), Some(Seen::Smi(_) | Seen::Unsupported)));
                assert_eq!(results + count(|seen| matches!(seen, Seen::Unsupported)), 1);
            }
            Stimulus::Other { .. } | Stimulus::Read { .. } => assert_eq!(seen, [&Seen::Unsupported]),
            _ => assert_eq!((images, results), (0, 0)),
        }
    }
    if whole {
        changes_only(stimuli, &observed);
    }
}

/// From a power-on, each mode and the supply of each port is reported when it changes and not else.
fn changes_only(stimuli: &[Stimulus], observed: &[fsct_adapters::Observation]) {
    let mut ports = std::collections::HashMap::new();
    let mut powered = false;
    let mut observed = observed.iter().peekable();
    for (position, stimulus) in stimuli.iter().enumerate() {
        if let Stimulus::Power(on) = stimulus {
            if *on != powered {
                ports.clear();
            }
            powered = *on;
        }
        while let Some(next) = observed.next_if(|next| usize::from(next.stimulus) == position) {
            match &next.seen {
                Seen::Line { port, line: Line::Power, level } => {
                    assert_ne!(ports.insert((*port, "L+"), u8::from(*level)).unwrap_or(0), u8::from(*level));
                }
                Seen::Line { port, line: Line::WakeUp, level } => {
                    assert!(*level && ports.get(&(*port, "L+")) == Some(&1), "a wake-up without supply");
                }
                Seen::Mode { port, mode } => {
                    assert_ne!(ports.insert((*port, "mode"), mode.number()).unwrap_or(0), mode.number());
                }
                _ => {}
            }
        }
    }
}

/// What a hostile Device or channel may do in operation.
#[derive(Clone, Debug)]
enum Act {
    Mirror,
    MirrorSdSet,
    MirrorFault(u8),
    Any(u8),
    Flip(usize),
    Lost,
    AllZero,
    Noise(Octets),
    Wait(u64),
    Ack(bool),
    SetSdC(bool),
}

fn acts() -> impl Strategy<Value = Act> {
    prop_oneof![
        14 => Just(Act::Mirror),
        2 => Just(Act::MirrorSdSet),
        1 => (1..4u8).prop_map(Act::MirrorFault),
        1 => (0..8u8).prop_map(Act::Any),
        1 => any::<usize>().prop_map(Act::Flip),
        1 => Just(Act::Lost),
        1 => Just(Act::AllZero),
        1 => octets(32).prop_map(Act::Noise),
        1 => (0..2 * WATCHDOG).prop_map(Act::Wait),
        4 => any::<bool>().prop_map(Act::Ack),
        1 => any::<bool>().prop_map(Act::SetSdC),
    ]
}

fn flipped(octets: Octets, bit: usize) -> Octets {
    let mut flipped = octets.as_slice().to_vec();
    flipped[bit / 8] ^= 0x80 >> (bit % 8);
    Octets::new(&flipped).unwrap()
}

proptest! {
    #[test]
    fn the_contract_is_kept(options in options(), stimuli in prop::collection::vec(stimuli(), 0..80)) {
        let mut powered = vec![Stimulus::Power(true)];
        powered.extend(stimuli);
        contract_kept(&mut FsMaster::new(options), &powered, true);
    }

    #[test]
    fn the_contract_is_kept_in_operation(options in options(), stimuli in prop::collection::vec(stimuli(), 0..60)) {
        let options = MasterOptions { ports: 2, ..options };
        // This one takes no list of the bench, so it comes to no operation.
        let mut bench = match options.mutant {
            Some(MasterMutant::ConfigLengthOfOtherEdition) => Bench::factory_with(plain(), options),
            _ => Bench::operate_with(plain(), options),
        };
        contract_kept(&mut bench.master, &stimuli, false);
    }

    #[test]
    fn the_contract_is_kept_by_the_dead(stimuli in prop::collection::vec(stimuli(), 0..60)) {
        contract_kept(&mut NullMaster::default(), &stimuli, false);
        contract_kept(&mut EchoMaster::default(), &stimuli, false);
        contract_kept(&mut ConstantMaster::default(), &stimuli, false);
    }

    /// Live PDin_M is that of a good answer, GOOD goes with it, and behind a fault an edge of ChFAck_C came first.
    #[test]
    fn process_data_are_safe_unless_all_is_well(acts in prop::collection::vec(acts(), 0..150)) {
        let mut bench = Bench::operate(plain());
        // `armed`: a good answer was checked with ChFAck_C 0 while an acknowledgment was asked for.
        let (mut level, mut armed) = (false, false);
        for act in acts {
            let mirrored = 7 - bench.out().unwrap().m_count;
            let mut received = Some(d(mirrored).octets(plain()));
            match &act {
                Act::MirrorSdSet => received = Some(d(mirrored).sd_set().octets(plain())),
                Act::MirrorFault(bits) => {
                    let answer = if bits & 1 != 0 { d(mirrored).comm_err() } else { d(mirrored) };
                    received = Some(if bits & 2 != 0 { answer.timeout() } else { answer }.octets(plain()));
                }
                Act::Any(counter) => received = Some(d(*counter).octets(plain())),
                Act::Flip(bit) => received = received.map(|octets| flipped(octets, bit % 56)),
                Act::Lost => received = None,
                Act::AllZero => received = Some(Octets::zero(7)),
                Act::Noise(octets) => received = Some(*octets),
                Act::Wait(ns) => {
                    bench.advance(*ns);
                    received = None;
                }
                Act::Ack(on) => {
                    bench.ack(u8::from(*on));
                    level = *on;
                    received = None;
                }
                Act::SetSdC(on) => {
                    bench.set(Service::SetsdC, &[u8::from(*on)]);
                    received = None;
                }
                Act::Mirror => {}
            }
            let faults_before = bench.bit(Service::FaultsS);
            armed = armed && bench.bit(Service::ChfackreqS);
            bench.receive(received);

            let out = bench.out();
            prop_assert!(out.is_some(), "always a right SPDU");
            let (faults, sd_set) = (bench.bit(Service::FaultsS), bench.bit(Service::SdsetS));
            prop_assert_eq!(bench.bit(Service::Qualifier), !(faults || sd_set));
            let live = bench.service(Service::PdinM) == Octets::new(&[PD_IN; 3]);
            prop_assert_eq!(live, !sd_set);
            prop_assert!(!faults || (sd_set && out.unwrap().set_sd && out.unwrap().data == 0));
            prop_assert!(!out.unwrap().set_sd || out.unwrap().data == 0);
            prop_assert_eq!(bench.bit(Service::ChfackreqS), out.unwrap().ack_req);
            if faults_before && !faults {
                prop_assert!(level && armed, "restarted without an edge while it was asked for");
            }
            let good = [d(mirrored), d(mirrored).sd_set()].map(|answer| Some(answer.octets(plain())));
            armed = bench.bit(Service::ChfackreqS) && (armed || good.contains(&received) && !level);
        }
    }

    /// Whatever happened, a conformant partner and an acknowledgment lead back into operation.
    #[test]
    fn operation_returns(acts in prop::collection::vec(acts(), 0..60)) {
        let mut bench = Bench::operate(plain());
        for act in acts {
            match act {
                Act::Wait(ns) => bench.advance(ns),
                Act::Noise(octets) => bench.receive(Some(octets)),
                Act::Flip(bit) => bench.receive(Some(flipped(d(3).octets(plain()), bit % 56))),
                Act::Any(counter) => bench.answer(d(counter)),
                Act::Ack(on) => bench.ack(u8::from(on)),
                Act::SetSdC(on) => bench.set(Service::SetsdC, &[u8::from(on)]),
                _ => bench.receive(None),
            }
        }
        bench.set(Service::SetsdC, &[0]);
        bench.advance(WATCHDOG);
        bench.receive(None);
        for level in [0, 0, 1, 1] {
            bench.ack(level);
            let mirrored = 7 - bench.out().unwrap().m_count;
            bench.answer(d(mirrored));
        }
        prop_assert!(bench.bit(Service::Qualifier));
    }
}
