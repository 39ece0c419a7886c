//! What holds whatever is done to the device: the contract, and live process data only where Table 40 allows them.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod common;

use common::*;
use fsct_adapters::{Dut, Octets, Seen, Service, Stimulus, Variant};
use fsct_protocol::crc::Reading;
use fsct_protocol::spdu::View;
use fsct_protocol::{Edition, ProtMode};
use fsct_reference::{ConstantDevice, EchoDevice, FsDevice, Mutant, NullDevice, Options};
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

/// Anything the contract can express.
fn stimuli() -> impl Strategy<Value = Stimulus> {
    let services: Vec<_> = Service::ALL.into_iter().map(|entry| entry.0).collect();
    let indices = prop_oneof![0x41FEu16..0x4218, any::<u16>()];
    prop_oneof![
        variants().prop_map(Stimulus::Configure),
        any::<bool>().prop_map(Stimulus::Power),
        (0..3u8, prop::option::of(octets(32))).prop_map(|(port, octets)| Stimulus::Exchange { port, octets }),
        (indices.clone(), 0..9u8).prop_map(|(index, subindex)| Stimulus::Read { index, subindex }),
        (indices, 0..3u8, prop::collection::vec(any::<u8>(), 0..40))
            .prop_map(|(index, subindex, data)| Stimulus::Write { index, subindex, data }),
        (0..3u8, prop::sample::select(services), octets(32)).prop_map(|(port, service, value)| Stimulus::Set {
            port,
            service,
            value
        }),
        any::<u64>().prop_map(|ns| Stimulus::Advance { ns }),
        (any::<u8>(), prop::collection::vec(any::<u8>(), 0..4))
            .prop_map(|(kind, octets)| Stimulus::Other { kind, octets }),
    ]
}

fn options() -> impl Strategy<Value = Options> {
    // The way into operation reads the protocol record.
    let readable = Mutant::ALL.iter().copied().filter(|mutant| *mutant != Mutant::ProtocolReadShort);
    (prop::option::of(prop::sample::select(readable.collect::<Vec<_>>())), 0..=Options::MAX_LATENCY)
        .prop_map(|(mutant, latency)| Options { mutant, latency, ..Options::default() })
}

/// One image for an exchange, last; one answer for a read or write; nothing before its time.
fn contract_kept(device: &mut dyn Dut, stimuli: &[Stimulus]) {
    let mut observed = Vec::new();
    device.apply(stimuli, &mut observed).unwrap();
    assert!(observed.windows(2).all(|pair| (pair[0].stimulus, pair[0].at) <= (pair[1].stimulus, pair[1].at)));
    assert!(observed.windows(2).all(|pair| pair[0].at <= pair[1].at));
    for (position, stimulus) in stimuli.iter().enumerate() {
        let of_it = observed.iter().filter(|observation| usize::from(observation.stimulus) == position);
        let seen: Vec<_> = of_it.map(|observation| &observation.seen).collect();
        let count = |kind: fn(&Seen) -> bool| seen.iter().filter(|seen| kind(seen)).count();
        let images = count(|seen| matches!(seen, Seen::Image { .. }));
        let answers = count(|seen| matches!(seen, Seen::Value(_) | Seen::Written | Seen::Refused { .. }));
        match stimulus {
            Stimulus::Exchange { .. } => {
                assert_eq!((images, answers), (1, 0));
                assert!(matches!(seen.last(), Some(Seen::Image { .. })));
            }
            Stimulus::Read { .. } | Stimulus::Write { .. } => assert_eq!((images, answers), (0, 1)),
            Stimulus::Other { .. } => assert_eq!(seen, [&Seen::Unsupported]),
            _ => assert_eq!((images, answers), (0, 0)),
        }
    }
}

/// What a hostile master or channel may do in operation.
#[derive(Clone, Debug)]
enum Act {
    Next,
    NextSd,
    Repeat,
    Zero,
    Jump(u8),
    Flip(usize),
    Lost,
    AllZero,
    Noise(Octets),
    Wait(u64),
    SdSetDs(bool),
}

fn acts() -> impl Strategy<Value = Act> {
    prop_oneof![
        12 => Just(Act::Next),
        2 => Just(Act::NextSd),
        1 => Just(Act::Repeat),
        1 => Just(Act::Zero),
        1 => (0..8u8).prop_map(Act::Jump),
        2 => any::<usize>().prop_map(Act::Flip),
        1 => Just(Act::Lost),
        1 => Just(Act::AllZero),
        1 => octets(32).prop_map(Act::Noise),
        2 => (0..2 * WATCHDOG).prop_map(Act::Wait),
        1 => any::<bool>().prop_map(Act::SdSetDs),
    ]
}

proptest! {
    #[test]
    fn the_contract_is_kept(options in options(), stimuli in prop::collection::vec(stimuli(), 0..60)) {
        contract_kept(&mut FsDevice::new(options), &stimuli);
    }

    #[test]
    fn the_contract_is_kept_in_operation(options in options(), stimuli in prop::collection::vec(stimuli(), 0..60)) {
        let mut bench = Bench::operating_with(plain(), options);
        contract_kept(&mut bench.device, &stimuli);
    }

    #[test]
    fn the_contract_is_kept_by_the_dead(stimuli in prop::collection::vec(stimuli(), 0..60)) {
        contract_kept(&mut NullDevice::default(), &stimuli);
        contract_kept(&mut EchoDevice::default(), &stimuli);
        contract_kept(&mut ConstantDevice::default(), &stimuli);
    }

    /// Live process data are those of an SPDU without fault or setSD, behind three such answers since the last fault.
    #[test]
    fn process_data_are_safe_unless_all_is_well(acts in prop::collection::vec(acts(), 0..120)) {
        let mut bench = Bench::waiting_first(plain());
        let mut count = 7;
        let mut answers_since_fault = 0;
        let mut counter = None;
        for act in acts {
            let next = if count == 7 { 1 } else { count + 1 };
            let first = bench.image.is_none_or(|image| image.as_slice().iter().all(|octet| *octet == 0));
            let next = if first { 0 } else { next };
            let out = match act {
                Act::Next => m(next),
                Act::NextSd => m(next).set_sd(),
                Act::Repeat => m(count),
                Act::Zero => m(0),
                Act::Jump(jump) => m(jump),
                _ => m(next),
            };
            let mut received = Some(out.octets(plain()));
            match &act {
                Act::Flip(bit) => received = received.map(|octets| flipped(octets, bit % 56)),
                Act::Lost => received = None,
                Act::AllZero => received = Some(Octets::zero(7)),
                Act::Noise(octets) => received = Some(*octets),
                Act::Wait(ns) => {
                    bench.advance(*ns);
                    received = None;
                }
                Act::SdSetDs(on) => {
                    bench.set(Service::SdsetDs, &[u8::from(*on)]);
                    received = None;
                }
                _ => {}
            }
            bench.receive(received);

            let live = bench.service(Service::PdoutD) != Octets::new(&[0; 3]);
            let Some(status) = bench.answer() else {
                prop_assert!(!live, "live before the first answer");
                continue;
            };
            let is_new = counter.replace(status.dcount_i) != Some(status.dcount_i);
            count = 7 - status.dcount_i;
            if status.d_comm_err || status.d_timeout {
                answers_since_fault = 0;
            }
            let changed = bench.last.iter().any(
                |observation| matches!(observation.seen, Seen::Service { service: Service::PdoutD, .. }));
            if live && changed {
                let octets = received.unwrap();
                let spdu = View::new(octets.as_slice(), ProtMode::Crc16, 3).unwrap();
                prop_assert!(spdu.signature_matches(Reading::Preset) && spdu.port_num() == PORT);
                prop_assert!(!spdu.control().set_sd);
                prop_assert_eq!(bench.service(Service::PdoutD), Octets::new(spdu.pd()));
            }
            if live {
                prop_assert!(!status.d_comm_err && !status.d_timeout);
                prop_assert!(answers_since_fault >= 3, "only {} good answers before", answers_since_fault);
            }
            if is_new && !(status.d_comm_err || status.d_timeout) {
                answers_since_fault += 1;
            }
        }
    }

    /// Whatever happened, a conformant partner gets the device back into operation within eight cycles.
    #[test]
    fn operation_returns(acts in prop::collection::vec(acts(), 0..40)) {
        let mut bench = Bench::operating(plain());
        for act in acts {
            match act {
                Act::Wait(ns) => bench.advance(ns),
                Act::Noise(octets) => bench.receive(Some(octets)),
                Act::Flip(bit) => bench.receive(Some(flipped(m(4).octets(plain()), bit % 56))),
                Act::Jump(count) => bench.exchange(m(count)),
                _ => bench.receive(None),
            }
        }
        for count in [0, 1, 2, 3, 4, 5, 6, 7] {
            bench.exchange(m(count));
        }
        bench.expect(d(0), PDout);
    }
}

fn flipped(octets: Octets, bit: usize) -> Octets {
    let mut flipped = octets.as_slice().to_vec();
    flipped[bit / 8] ^= 0x80 >> (bit % 8);
    Octets::new(&flipped).unwrap()
}
