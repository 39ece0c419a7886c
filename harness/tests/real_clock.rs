//! Real clocks: what a bench that comes late leaves open, and what a clock that is not what it says is worth.

mod common;

use common::{library, run_on, story};
use fsct_adapters::{Clock, ClockKind, Description, Dut, DutError, Line, Monotonic, Observation, Stimulus};
use fsct_harness::campaign::Bench;
use fsct_harness::plan::Selection;
use fsct_reference::{FsDevice, Options};
use fsct_reports::record::{CaseRecord, Execution, Verdict};
use std::time::Instant;

/// The reference FS-Device with a clock that runs by itself, and a way to it that is not what it should be.
struct OnABench {
    device: FsDevice,
    began: Instant,
    told_ns: u64,
    /// How much later than it should a wake-up request reaches it.
    wake_up_late_ns: u64,
    /// How far off every second time stamp is.
    off_ns: u64,
    stamps: u64,
}

impl OnABench {
    fn boxed(wake_up_late_ns: u64, off_ns: u64) -> Box<dyn Dut> {
        let device = FsDevice::new(Options::default());
        Box::new(OnABench { device, began: Instant::now(), told_ns: 0, wake_up_late_ns, off_ns, stamps: 0 })
    }
}

impl Dut for OnABench {
    fn hello(&mut self) -> Result<Description, DutError> {
        let clock = Clock { kind: ClockKind::Real, resolution_ns: 1, uncertainty_ns: 100_000 };
        Ok(Description { clock, ..self.device.hello()? })
    }

    fn apply(&mut self, stimuli: &[Stimulus], observed: &mut Vec<Observation>) -> Result<(), DutError> {
        for (position, stimulus) in (0..).zip(stimuli) {
            let late = match stimulus {
                Stimulus::Drive { line: Line::WakeUp, level: true, .. } => self.wake_up_late_ns,
                _ => 0,
            };
            let now = u64::try_from(self.began.elapsed().as_nanos()).expect("a test is short").max(self.told_ns) + late;
            let passed = Stimulus::Advance { ns: now - self.told_ns };
            self.told_ns = now;
            let before = observed.len();
            self.device.apply(&[passed, stimulus.clone()], observed)?;
            for observation in &mut observed[before..] {
                self.stamps += 1;
                observation.stimulus = position;
                observation.at += if self.stamps.is_multiple_of(2) { self.off_ns } else { 0 };
            }
        }
        Ok(())
    }
}

fn one(filter: &str, make: impl Fn() -> Box<dyn Dut>) -> CaseRecord {
    let selection = Selection { filter: vec![filter.to_owned(), "edition=v1.1".to_owned()], ..Selection::default() };
    let connect = || Bench::greet(make())?.prove(&mut Monotonic::default());
    let cases = run_on(&library(), &selection, "device-real-time", connect);
    assert_eq!(cases.len(), 1, "{}", story(&cases));
    cases.into_iter().next().expect("there is one")
}

/// 2 ms after the Ready pulse OSSDe operation may have begun (v1.1: 700 us), and nobody answers.
#[test]
fn a_wake_up_that_comes_too_late_is_held_against_nobody() {
    let case = one("FSD-1703", || OnABench::boxed(2_000_000, 0));
    let told = story(std::slice::from_ref(&case));
    assert_eq!((case.verdict, case.execution), (Verdict::Inconclusive, Execution::Ok), "{told}");
    assert_eq!(case.reasons.len(), 1, "{told}");
    assert_eq!(case.reasons[0].kind, "bench/slipped", "{told}");
}

/// Every second stamp 20 ms off, where 100 us are stated: the start-up ends in time by any of them, and nothing is said of it.
#[test]
fn a_contradicted_clock_earns_no_timing_verdict() {
    let case = one("FSD-1701", || OnABench::boxed(0, 20_000_000));
    let told = story(std::slice::from_ref(&case));
    assert_eq!(case.verdict, Verdict::Inconclusive, "{told}");
    assert!(case.reasons.iter().any(|reason| reason.kind == "dut/clock"), "{told}");
}
