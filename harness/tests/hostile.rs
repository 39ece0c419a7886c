//! Whatever a DUT answers, the tool itself does not fail: no panic, no tool error, an end to every case.

mod common;

use common::{library, run, story};
use fsct_adapters::{Description, Dut, DutError, Observation, Octets, Seen, Service, Stimulus};
use fsct_harness::plan::Selection;
use fsct_reference::{FsDevice, Options};
use fsct_reports::record::{CaseRecord, Execution};
use proptest::prelude::*;

/// The reference FS-Device, until it begins to lie.
struct Liar {
    device: FsDevice,
    lies: Vec<(Vec<u8>, u8)>,
    honest: usize,
    told: usize,
}

impl Dut for Liar {
    fn hello(&mut self) -> Result<Description, DutError> {
        self.device.hello()
    }

    fn apply(&mut self, stimuli: &[Stimulus], observed: &mut Vec<Observation>) -> Result<(), DutError> {
        let from = observed.len();
        self.device.apply(stimuli, observed)?;
        for observation in observed.iter_mut().skip(from) {
            self.told += 1;
            if self.told <= self.honest || self.lies.is_empty() {
                continue;
            }
            let (octets, way) = &self.lies[self.told % self.lies.len()];
            let value = Octets::new(&octets[..octets.len().min(Octets::MAX)]).unwrap_or_default();
            match (&mut observation.seen, way % 6) {
                (Seen::Image { octets, .. }, 0..=2) => *octets = Some(value),
                (Seen::Image { octets, .. }, 3) => *octets = None,
                (Seen::Service { value: own, .. }, 0..=3) => *own = value,
                (Seen::Value(data), _) => data.clone_from(octets),
                (Seen::Written, 4) => observation.seen = Seen::Refused { error: 0x8030 },
                (_, 5) => observation.at = observation.at.wrapping_mul(0x9E37_79B9),
                (Seen::Service { service, .. }, _) => *service = Service::FaultsS,
                _ => {}
            }
        }
        Ok(())
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 48, ..ProptestConfig::default() })]
    #[test]
    fn no_answer_makes_the_tool_fail(
        lies in prop::collection::vec((prop::collection::vec(any::<u8>(), 0..40), any::<u8>()), 0..12),
        honest in 0usize..80,
    ) {
        let selection = Selection { filter: vec!["FSD-0*".into(), "crc16".into(), "iec2022".into()], ..Selection::default() };
        let make = || -> Box<dyn Dut> {
            Box::new(Liar { device: FsDevice::new(Options::default()), lies: lies.clone(), honest, told: 0 })
        };
        let cases = run(&library(), &selection, make);
        let failed: Vec<CaseRecord> =
            cases.iter().filter(|case| case.execution == Execution::ToolError).cloned().collect();
        prop_assert!(cases.len() > 100);
        prop_assert!(failed.is_empty(), "{}", story(&failed));
    }
}
