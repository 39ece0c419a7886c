//! What holds whatever is done to an FS-Master: the contract, and process data at the gateway only while they are GOOD.

use crate::bench::*;
use fsct_adapters::{
    Dut, Identity, Line, Observation, Octets, Response, Seen, Service, SmiRequest, SmiService, Stimulus,
};
use fsct_reference::{ConstantMaster, EchoMaster, FsMaster, MasterMutant, MasterOptions, NullMaster};
use proptest::collection::vec;
use proptest::prelude::*;

fn octets(most: usize) -> impl Strategy<Value = Octets> {
    vec(any::<u8>(), 0..=most).prop_map(|octets| Octets::new(&octets).unwrap())
}

/// An answer that is mostly right.
fn answers() -> impl Strategy<Value = Octets> {
    (0..8u8, any::<[bool; 3]>(), prop::bool::weighted(0.1)).prop_map(|(count, [sd_set, comm_err, timeout], bad)| {
        let mut answer = d(count);
        answer.status.sd_set = sd_set;
        (answer.status.d_comm_err, answer.status.d_timeout) = (comm_err && bad, timeout && bad);
        if bad { answer.bad().octets() } else { answer.octets() }
    })
}

fn requests() -> impl Strategy<Value = SmiRequest> {
    let list = (any::<bool>(), 0..50usize, any::<u8>(), any::<bool>()).prop_map(|(v1_1, offset, value, whole)| {
        let mut list = List::new(if v1_1 { V1_1 } else { Iec2022 }).octets();
        if !whole {
            let at = offset.min(list.len() - 1);
            list[at] = value;
        }
        (SmiService::PortConfiguration, 0xFFF0, list)
    });
    let power = (0..4u8, any::<u16>()).prop_map(|(mode, time)| {
        let block = [&[0x70, 0x03, mode], time.to_be_bytes().as_slice()].concat();
        (SmiService::PortPowerOffOn, 0xFFF0, block)
    });
    let access = any::<[u8; 9]>()
        .prop_map(|content| (SmiService::FsMasterAccess, 0x0101, [[0x01, 0x00].as_slice(), &content].concat()));
    let any = (prop::sample::select(SmiService::ALL.to_vec()), any::<u16>(), vec(any::<u8>(), 0..60))
        .prop_map(|((service, _, _), expected, octets)| (service, expected, octets));
    (prop_oneof![3 => list, 1 => power, 1 => access, 3 => any], 0..4u8)
        .prop_map(|((service, expected, octets), port)| SmiRequest { service, port, client_id: 7, expected, octets })
}

/// Anything the contract can express.
fn stimuli() -> impl Strategy<Value = Stimulus> {
    let services: Vec<_> = Service::ALL.into_iter().map(|entry| entry.0).collect();
    let lines: Vec<_> = Line::ALL.into_iter().map(|entry| entry.0).collect();
    let anyone = (any::<[u8; 5]>(), any::<u16>(), any::<u32>()).prop_map(|(octets, vendor_id, device_id)| {
        let [revision_id, com, min_cycle_time, pd_in, pd_out] = octets;
        Identity { revision_id, com, min_cycle_time, pd_in, pd_out, vendor_id, device_id }
    });
    let devices = prop::option::of(prop_oneof![2 => Just(identity()), 1 => anyone]);
    let responses = prop_oneof![
        Just(Response::Written),
        any::<u16>().prop_map(Response::Refused),
        vec(any::<u8>(), 0..9).prop_map(Response::Value),
    ];
    let times = prop_oneof![Just(750_000), Just(WATCHDOG), 0..10 * WATCHDOG, 0..20_000 * MS, any::<u64>()];
    prop_oneof![
        1 => any::<bool>().prop_map(Stimulus::Power),
        4 => (1..4u8, prop::option::of(prop_oneof![octets(32), answers()]))
            .prop_map(|(port, octets)| Stimulus::Exchange { port, octets }),
        2 => (0..4u8, prop::sample::select(services), octets(9))
            .prop_map(|(port, service, value)| Stimulus::Set { port, service, value }),
        1 => (0..4u8, devices).prop_map(|(port, device)| Stimulus::Plug { port, device }),
        1 => (0..4u8, responses).prop_map(|(port, response)| Stimulus::Respond { port, response }),
        1 => (0..4u8, any::<u16>(), any::<u8>())
            .prop_map(|(port, code, qualifier)| Stimulus::Raise { port, code, qualifier }),
        3 => (0..4u8, prop::sample::select(lines), any::<bool>())
            .prop_map(|(port, line, level)| Stimulus::Drive { port, line, level }),
        2 => requests().prop_map(|request| Stimulus::Smi(Box::new(request))),
        3 => times.prop_map(|ns| Stimulus::Advance { ns }),
        1 => (any::<u8>(), vec(any::<u8>(), 0..4)).prop_map(|(kind, octets)| Stimulus::Other { kind, octets }),
        1 => (any::<u16>(), any::<u8>()).prop_map(|(index, subindex)| Stimulus::Read { index, subindex }),
    ]
}

fn options() -> impl Strategy<Value = MasterOptions> {
    let mutants = prop::option::of(prop::sample::select(MasterMutant::ALL.to_vec()));
    (mutants, 0..=8u8, 1..=3u8, any::<[bool; 2]>()).prop_map(|(mutant, latency, ports, [password, reset])| {
        MasterOptions {
            mutant,
            latency,
            ports,
            password: password.into(),
            reset_password: u32::from(reset) * 2,
            ..MasterOptions::default()
        }
    })
}

/// One image for an exchange, last; one result for a request; nothing before its time.
fn contract_kept(master: &mut dyn Dut, stimuli: &[Stimulus]) -> Vec<Observation> {
    let mut observed = Vec::new();
    master.apply(stimuli, &mut observed).unwrap();
    assert!(observed.windows(2).all(|pair| pair[0].stimulus <= pair[1].stimulus && pair[0].at <= pair[1].at));
    for (position, stimulus) in stimuli.iter().enumerate() {
        let own: Vec<&Seen> =
            observed.iter().filter(|o| usize::from(o.stimulus) == position).map(|o| &o.seen).collect();
        let count = |of: fn(&Seen) -> bool| own.iter().filter(|seen| of(seen)).count();
        let images = count(|seen| matches!(seen, Seen::Image { .. }));
        match stimulus {
            Stimulus::Exchange { .. } => assert!(images == 1 && matches!(own.last(), Some(Seen::Image { .. }))),
            Stimulus::Smi(_) => assert_eq!(count(|seen| matches!(seen, Seen::Smi(_) | Seen::Unsupported)), 1),
            Stimulus::Read { .. } | Stimulus::Other { .. } => assert_eq!(own, [&Seen::Unsupported]),
            _ => assert_eq!(images, 0),
        }
    }
    observed
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(192))]

    #[test]
    fn nothing_makes_it_fail(options in options(), stimuli in vec(stimuli(), 1..60), edition in prop::bool::ANY) {
        let edition = if edition { V1_1 } else { Iec2022 };
        let mut bench = Bench::idle(edition, options);
        if options.ports >= PORT {
            bench.configure();
            bench.connect();
        }
        contract_kept(&mut bench.master, &stimuli);
    }

    #[test]
    fn a_factory_fresh_one_does_not_fail_either(options in options(), stimuli in vec(stimuli(), 1..60)) {
        contract_kept(&mut FsMaster::new(options), &stimuli);
    }

    #[test]
    fn those_that_only_look_like_one_keep_the_contract(stimuli in vec(stimuli(), 1..40)) {
        let dead: [Box<dyn Dut>; 3] =
            [Box::new(NullMaster::default()), Box::new(EchoMaster::default()), Box::new(ConstantMaster::default())];
        for mut master in dead {
            contract_kept(&mut *master, &stimuli);
        }
    }

    /// PDin_M other than 0 only while the qualifier is GOOD, and GOOD only without fault and without SDset_S.
    #[test]
    fn live_data_are_good_data(stimuli in vec(stimuli(), 1..80)) {
        let mut bench = Bench::operate(4);
        for stimulus in stimuli {
            bench.apply(stimulus);
            let services = bench.services.clone();
            prop_assert!(services.qualifier || services.pdin_m.iter().all(|octet| *octet == 0));
            prop_assert_eq!(services.qualifier && (services.faults_s || services.sdset_s), false);
        }
    }

    /// After a fault GOOD comes only behind a ChFAck_C that goes from 0 to 1, or a new configuration or power-on.
    #[test]
    fn no_restart_without_acknowledgment(answers in vec(answers(), 1..80), times in vec(0..2 * WATCHDOG, 80)) {
        let mut bench = Bench::after_fault(None);
        for (answer, ns) in answers.into_iter().zip(times) {
            bench.advance(ns);
            bench.exchange(Some(answer));
            prop_assert!(!bench.services.qualifier && bench.services.faults_s);
        }
    }

    /// One long advance is as good as many short ones.
    #[test]
    fn time_may_be_cut_anywhere(cuts in vec(1..3_000 * MS, 1..20)) {
        let run = |pieces: &[u64]| {
            let mut bench = Bench::operate(4);
            bench.plug(None);
            bench.seen.clear();
            pieces.iter().for_each(|ns| { bench.advance(*ns); });
            bench.seen.iter().map(|o| (o.at, o.seen.clone())).collect::<Vec<_>>()
        };
        prop_assert_eq!(run(&cuts), run(&[cuts.iter().sum()]));
    }
}
