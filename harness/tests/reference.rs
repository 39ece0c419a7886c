//! The embedded reference FS-Device conforms, at every answer latency; its mutants and dead devices do not.

mod common;
mod references;

use common::{library, run, run_with, story};
use fsct_adapters::{Description, Dut, DutError, Observation, Seen, Stimulus};
use fsct_harness::plan::Selection;
use fsct_reference::{ConstantDevice, EchoDevice, FsDevice, Mutant, NullDevice, Options};
use fsct_reports::record::{CaseRecord, Verdict};
use references::{first_failure, not_passed};
use rstest::rstest;

fn reference(options: Options) -> Box<dyn Dut> {
    Box::new(FsDevice::new(options))
}

#[test]
fn the_reference_device_conforms_and_takes_every_transition() {
    let cases = run(&library(), &Selection::default(), || reference(Options::default()));
    for number in 20..=31 {
        let transition = format!("T{number}");
        assert!(cases.iter().any(|case| case.transitions.contains_key(&transition)), "{transition} was never taken");
    }
    for wanted in [
        "edition=v1.1,mode=crc16",
        "edition=v1.1,mode=crc32",
        "edition=iec2022,mode=crc16",
        "edition=iec2022,mode=crc32",
    ] {
        assert!(cases.iter().any(|case| case.key.contains(wanted)), "{wanted} was never run");
    }
    let others = not_passed(cases);
    assert!(others.is_empty(), "{}", story(&others));
}

/// A product whose FSP records are only to be had as a whole, as the IODD of iec2022 declares them.
struct WholeRecords(FsDevice);

impl Dut for WholeRecords {
    fn hello(&mut self) -> Result<Description, DutError> {
        self.0.hello()
    }

    fn apply(&mut self, stimuli: &[Stimulus], observed: &mut Vec<Observation>) -> Result<(), DutError> {
        let from = observed.len();
        self.0.apply(stimuli, observed)?;
        for observation in observed.iter_mut().skip(from) {
            let asked = stimuli.get(usize::from(observation.stimulus));
            if matches!((asked, &observation.seen), (Some(Stimulus::Read { subindex: 1.., .. }), Seen::Value(_))) {
                observation.seen = Seen::Refused { error: 0x8012 };
            }
        }
        Ok(())
    }
}

#[test]
fn a_product_need_not_serve_subindices() {
    let make = || -> Box<dyn Dut> { Box::new(WholeRecords(FsDevice::new(Options::default()))) };
    let selection = Selection { filter: vec!["FSD-02".into()], ..Selection::default() };
    let others = not_passed(run(&library(), &selection, make));
    assert!(others.is_empty(), "{}", story(&others));
}

#[rstest]
#[case("device-late-1", 1)]
#[case("device-late-3", 3)]
fn an_answer_may_take_some_exchanges(#[case] profile: &str, #[case] latency: u8) {
    let make = || reference(Options { latency, ..Options::default() });
    let others = not_passed(run_with(&library(), &Selection::default(), profile, make));
    assert!(others.is_empty(), "{}", story(&others));
}

#[rstest]
#[case(Mutant::WrongSeed, "11.4.7")]
#[case(Mutant::ZeroNotReplaced, "11.4.7")]
#[case(Mutant::PortNotInverted, "11.4.5")]
#[case(Mutant::CounterCheckMissing, "11.5.3 Table 40 T25")]
#[case(Mutant::SdCycles2, "11.5.3 Table 40 T22")]
#[case(Mutant::DTimeoutNeverCleared, "11.5.3 Table 40 T29")]
#[case(Mutant::PdoutLiveDuringSdCycles, "11.3.3 Table 29, 11.5.3 Table 40 T22")]
#[case(Mutant::WatchdogDoubled, "11.5.5")]
#[case(Mutant::DCommErrNeverReported, "11.5.3 Table 40 T25")]
#[case(Mutant::SetSdIgnored, "11.5.3 Table 40 T22")]
fn each_mutant_fails_and_the_clause_is_named(#[case] mutant: Mutant, #[case] clause: &str) {
    let make = || reference(Options { mutant: Some(mutant), ..Options::default() });
    let failed: Vec<CaseRecord> =
        run(&library(), &Selection::default(), make).into_iter().filter(|case| case.verdict == Verdict::Fail).collect();
    assert!(!failed.is_empty(), "{} fails no case", mutant.name());
    let named = |case: &&CaseRecord| case.reasons.first().is_some_and(|reason| reason.clause.contains(clause));
    assert!(failed.iter().filter(named).count() > 0, "{}: {}", mutant.name(), story(&failed[..failed.len().min(20)]));
}

#[test]
fn a_failure_tells_what_the_matter_is() {
    let library = library();
    // The first ten of the catalogue, which have one of each kind.
    let told: Vec<String> = Mutant::ALL[..10]
        .iter()
        .copied()
        .map(|mutant| {
            let make = || reference(Options { mutant: Some(mutant), ..Options::default() });
            let cases = run(&library, &Selection::default(), make);
            first_failure(mutant.name(), &cases)
        })
        .collect();
    insta::assert_snapshot!(told.join("\n"));
}

#[rstest]
#[case::null(|| Box::<NullDevice>::default() as Box<dyn Dut>)]
#[case::echo(|| Box::<EchoDevice>::default() as Box<dyn Dut>)]
#[case::constant(|| Box::<ConstantDevice>::default() as Box<dyn Dut>)]
fn a_dead_device_passes_no_case(#[case] make: fn() -> Box<dyn Dut>) {
    let cases = run(&library(), &Selection::default(), make);
    assert!(!cases.is_empty());
    let passed: Vec<CaseRecord> = cases.into_iter().filter(|case| case.verdict <= Verdict::Remark).collect();
    assert!(passed.is_empty(), "{}", story(&passed));
}
