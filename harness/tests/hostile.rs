//! Whatever a DUT answers, the tool itself does not fail: no panic, no tool error, an end to every case.

mod common;

use common::{library, run_with, story};
use fsct_adapters::{Description, Dut, DutError, Line, Mode, Observation, Octets, Seen, Service, Stimulus};
use fsct_harness::plan::Selection;
use fsct_reference::{FsDevice, FsMaster, MasterOptions, Options};
use fsct_reports::record::{CaseRecord, Execution};
use proptest::prelude::*;

/// A reference, until it begins to lie.
struct Liar {
    dut: Box<dyn Dut>,
    lies: Vec<(Vec<u8>, u8)>,
    honest: usize,
    told: usize,
}

impl Dut for Liar {
    fn hello(&mut self) -> Result<Description, DutError> {
        self.dut.hello()
    }

    fn apply(&mut self, stimuli: &[Stimulus], observed: &mut Vec<Observation>) -> Result<(), DutError> {
        let from = observed.len();
        self.dut.apply(stimuli, observed)?;
        for observation in observed.iter_mut().skip(from) {
            self.told += 1;
            if self.told > self.honest && !self.lies.is_empty() {
                let (octets, way) = &self.lies[self.told % self.lies.len()];
                lie(observation, octets, *way);
            }
        }
        Ok(())
    }
}

fn lie(observation: &mut Observation, octets: &[u8], way: u8) {
    let value = Octets::new(&octets[..octets.len().min(Octets::MAX)]).unwrap_or_default();
    let number = u16::from_be_bytes([way, octets.len() as u8]);
    match (&mut observation.seen, way % 6) {
        (Seen::Image { octets, .. }, 0..=2) => *octets = Some(value),
        (Seen::Image { octets, .. }, 3) => *octets = None,
        (Seen::Service { value: own, .. }, 0..=3) => *own = value,
        (Seen::Value(data), _) => *data = octets.to_vec(),
        (Seen::Written, 4) => observation.seen = Seen::Refused { error: 0x8030 },
        (_, 5) => observation.at = observation.at.wrapping_mul(0x9E37_79B9),
        (Seen::Service { service, .. }, _) => *service = Service::FaultsS,
        // What only an FS-Master says.
        (Seen::Mode { mode, .. }, 0..=3) => *mode = Mode::ALL[usize::from(way / 6) % Mode::ALL.len()].0,
        (Seen::Line { line, .. }, 0..=1) => *line = if *line == Line::Power { Line::Cq } else { Line::Power },
        (Seen::Line { level, .. }, 2) => *level = true,
        (Seen::Request { data, .. }, 0) => *data = None,
        (Seen::Request { data, .. }, 1..=2) => *data = Some(octets.to_vec()),
        (Seen::Request { index, .. }, 3) => *index = number,
        (Seen::Indication { code, .. }, _) => *code = number,
        (Seen::Smi(result), 0..=1) => result.octets = octets.to_vec(),
        (Seen::Smi(result), 2) => result.positive = !result.positive,
        (Seen::Smi(result), 3) => (result.reference, result.length) = (number, number),
        (Seen::Smi(result), 4) => (result.client_id, result.port) = (number, way),
        (Seen::Mode { port, .. } | Seen::Line { port, .. } | Seen::Request { port, .. }, 4) => *port = way % 3,
        _ => {}
    }
}

/// Lies, and after how many observations they begin.
fn lies() -> impl Strategy<Value = (Vec<(Vec<u8>, u8)>, usize)> {
    let lie = (prop::collection::vec(any::<u8>(), 0..40), any::<u8>());
    (prop::collection::vec(lie, 0..12), 0usize..80)
}

/// Every case of a filter ends without a fault of the tool.
fn ends_well(filter: &str, profile: &str, make: impl Fn() -> Box<dyn Dut>) -> Result<(), TestCaseError> {
    let selection = Selection { filter: vec![filter.into(), "crc16".into(), "iec2022".into()], ..Selection::default() };
    let cases = run_with(&library(), &selection, profile, make);
    let failed: Vec<CaseRecord> = cases.iter().filter(|case| case.execution == Execution::ToolError).cloned().collect();
    prop_assert!(cases.len() > 100, "{} cases", cases.len());
    prop_assert!(failed.is_empty(), "{}", story(&failed));
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 48, ..ProptestConfig::default() })]

    #[test]
    fn no_answer_of_a_device_makes_the_tool_fail((lies, honest) in lies()) {
        let device = || Box::new(FsDevice::new(Options::default()));
        ends_well("FSD-0*", "reference-device", || {
            Box::new(Liar { dut: device(), lies: lies.clone(), honest, told: 0 })
        })?;
    }
}

proptest! {
    // A case of an FS-Master takes some ten times as long.
    #![proptest_config(ProptestConfig { cases: 12, ..ProptestConfig::default() })]

    #[test]
    fn no_answer_of_a_master_makes_the_tool_fail((lies, honest) in lies()) {
        let master = || Box::new(FsMaster::new(MasterOptions::default()));
        ends_well("FSM-0*", "reference-master", || {
            Box::new(Liar { dut: master(), lies: lies.clone(), honest, told: 0 })
        })?;
    }
}
