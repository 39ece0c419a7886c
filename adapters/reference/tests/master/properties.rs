//! Nothing that crosses the contract makes the reference FS-Master fail, and it keeps to the contract.

use crate::bench::Bench;
use fsct_adapters::{Dut, Identity, Line, Octets, Response, Seen, Service, SmiRequest, SmiService, Stimulus};
use fsct_protocol::Edition;
use fsct_reference::MasterOptions;
use proptest::collection::vec;
use proptest::prelude::*;

fn octets() -> impl Strategy<Value = Octets> {
    vec(any::<u8>(), 0..=32).prop_map(|octets| Octets::new(&octets).expect("it fits"))
}

fn stimulus() -> impl Strategy<Value = Stimulus> {
    let identity = any::<(u8, u8, u8, u8, u8, u16, u32)>().prop_map(|t| Identity {
        revision_id: t.0,
        com: t.1,
        min_cycle_time: t.2,
        pd_in: t.3,
        pd_out: t.4,
        vendor_id: t.5,
        device_id: t.6,
    });
    prop_oneof![
        any::<bool>().prop_map(Stimulus::Power),
        (0..4u8, proptest::option::of(octets())).prop_map(|(port, octets)| Stimulus::Exchange { port, octets }),
        (0..4u8, 0..Service::ALL.len(), octets()).prop_map(|(port, at, value)| Stimulus::Set {
            port,
            service: Service::ALL[at].0,
            value
        }),
        (0..4u8, proptest::option::of(identity)).prop_map(|(port, device)| Stimulus::Plug { port, device }),
        (0..4u8, any::<u16>()).prop_map(|(port, e)| Stimulus::Respond { port, response: Response::Refused(e) }),
        (0..4u8, any::<u16>(), any::<u8>()).prop_map(|(port, code, qualifier)| Stimulus::Raise {
            port,
            code,
            qualifier
        }),
        (0..4u8, 0..Line::ALL.len(), any::<bool>()).prop_map(|(port, at, level)| Stimulus::Drive {
            port,
            line: Line::ALL[at].0,
            level
        }),
        (0..SmiService::ALL.len(), 0..4u8, any::<u16>(), vec(any::<u8>(), 0..60)).prop_map(
            |(at, port, expected, octets)| {
                let service = SmiService::ALL[at].0;
                Stimulus::Smi(Box::new(SmiRequest { service, port, client_id: 1, expected, octets }))
            }
        ),
        (0..10_000_000_000u64).prop_map(|ns| Stimulus::Advance { ns }),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(128))]

    #[test]
    fn any_stimuli_are_answered_as_the_contract_asks(stimuli in vec(stimulus(), 1..80), v1_1 in any::<bool>()) {
        let edition = if v1_1 { Edition::V1_1 } else { Edition::Iec2022 };
        let mut bench = Bench::operate(edition, MasterOptions::default());
        let mut observed = Vec::new();
        bench.dut.apply(&stimuli, &mut observed).expect("it answers");
        for (position, stimulus) in stimuli.iter().enumerate() {
            let own: Vec<&Seen> =
                observed.iter().filter(|o| usize::from(o.stimulus) == position).map(|o| &o.seen).collect();
            let count = |of: fn(&Seen) -> bool| own.iter().filter(|seen| of(seen)).count();
            match stimulus {
                Stimulus::Exchange { .. } => prop_assert_eq!(count(|seen| matches!(seen, Seen::Image { .. })), 1),
                Stimulus::Smi(_) => {
                    prop_assert_eq!(count(|seen| matches!(seen, Seen::Smi(_) | Seen::Unsupported)), 1);
                }
                _ => prop_assert_eq!(count(|seen| matches!(seen, Seen::Image { .. } | Seen::Smi(_))), 0),
            }
        }
        prop_assert!(observed.is_sorted_by_key(|o| (o.stimulus, o.at)));
    }

    /// Whatever is exchanged, process data reach the gateway only while the qualifier is GOOD.
    #[test]
    fn pdin_m_is_safe_while_the_qualifier_is_bad(images in vec(octets(), 1..60)) {
        let mut bench = Bench::operate(Edition::Iec2022, MasterOptions::default());
        for octets in images {
            bench.exchange(Some(octets));
            prop_assert!(bench.good || bench.pdin.iter().all(|octet| *octet == 0));
        }
    }
}
