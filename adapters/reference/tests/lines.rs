//! The lines of the reference FS-Device as Figures 21 and 27 draw them.

use fsct_adapters::{Dut, Edition, Line, Mode, Observation, Octets, ProtMode, Seen, Service, Stimulus, Variant};
use fsct_reference::{FsDevice, Mutant, Options};
use rstest::rstest;

const US: u64 = 1_000;
const MS: u64 = 1_000 * US;

/// A device that has just got its supply.
struct Bench(FsDevice);

impl Bench {
    fn on(edition: Edition, options: Options) -> Bench {
        let mut bench = Bench(FsDevice::new(options));
        let variant = Variant { edition, mode: ProtMode::Crc16, pd_out: 3, pd_in: 3 };
        bench.apply(&[Stimulus::Configure(variant), Stimulus::Power(true)]);
        bench
    }

    fn with(edition: Edition, mutant: Mutant) -> Bench {
        Bench::on(edition, Options { mutant: Some(mutant), ..Options::default() })
    }

    fn apply(&mut self, stimuli: &[Stimulus]) -> Vec<Observation> {
        let mut observed = Vec::new();
        self.0.apply(stimuli, &mut observed).expect("the reference always answers");
        observed
    }

    /// What happens on the lines in the next `ns`, `100 000 C/Q 1` in microseconds.
    fn pass(&mut self, ns: u64) -> Vec<String> {
        edges(&self.apply(&[Stimulus::Advance { ns }]))
    }

    /// Whether the device answers after a wake-up.
    fn wake_up(&mut self) -> bool {
        let woken = self.apply(&[Stimulus::Drive { port: 1, line: Line::WakeUp, level: true }]);
        woken.iter().any(|seen| seen.seen == Seen::Mode { port: 1, mode: Mode::Startup })
    }

    fn demand(&mut self, demand: bool) -> Vec<String> {
        edges(&self.apply(&[Stimulus::Set { port: 1, service: Service::OssdeDemand, value: Octets::bit(demand) }]))
    }
}

fn edges(observed: &[Observation]) -> Vec<String> {
    let edge = |seen: &Observation| match seen.seen {
        Seen::Line { line, level, .. } => Some(format!("{} {line} {}", seen.at / US, u8::from(level))),
        _ => None,
    };
    observed.iter().filter_map(edge).collect()
}

#[rstest]
#[case(Edition::V1_1, 900)]
#[case(Edition::Iec2022, 1_200_000)]
fn without_a_wake_up_ossde_follows_the_ready_pulse(#[case] edition: Edition, #[case] t_ro_us: u64) {
    let mut bench = Bench::on(edition, Options::default());
    assert_eq!(bench.pass(101 * MS), ["100000 C/Q 1", "100750 C/Q 0"]);
    let on = 100_750 + t_ro_us;
    let expected = [
        (on, "C/Q 1"),
        (on + 200, "I/Q 1"),
        (on + 100_000, "C/Q 0"),
        (on + 100_500, "C/Q 1"),
        (on + 110_000, "I/Q 0"),
        (on + 110_500, "I/Q 1"),
    ];
    assert_eq!(bench.pass(t_ro_us * US + 111 * MS), expected.map(|(at, what)| format!("{at} {what}")));
    assert!(!bench.wake_up(), "only a power cycle brings it back");
}

#[rstest]
#[case::in_the_self_test(50 * MS, false)]
#[case::at_the_end_of_the_pulse(100_750 * US, false)]
#[case::just_before_ready(100_769 * US, false)]
#[case::ready(100_770 * US, true)]
#[case::t_rw(100_800 * US, true)]
#[case::just_before_ossde(101_649 * US, true)]
#[case::ossde(101_650 * US, false)]
fn a_wake_up_is_taken_between_ready_and_ossde(#[case] at: u64, #[case] answered: bool) {
    let mut bench = Bench::on(Edition::V1_1, Options::default());
    bench.pass(at);
    assert_eq!(bench.wake_up(), answered);
    assert_eq!(bench.pass(1_000 * MS).is_empty(), answered, "lines are silent in communication alone");
}

#[test]
fn process_data_without_a_wake_up_of_the_tester_find_the_device_woken() {
    let mut bench = Bench::on(Edition::V1_1, Options::default());
    let read = Stimulus::Read { index: 0x4201, subindex: 0 };
    assert!(bench.apply(std::slice::from_ref(&read)).iter().any(|seen| matches!(seen.seen, Seen::Value(_))));
    assert!(bench.pass(1_000 * MS).is_empty());
    let mut late = Bench::on(Edition::V1_1, Options::default());
    late.pass(1_000 * MS);
    assert!(!late.wake_up());
    assert!(late.apply(&[read]).iter().any(|seen| matches!(seen.seen, Seen::Refused { .. })));
}

#[test]
fn a_demand_switches_both_off_and_ends_test_pulses() {
    let mut bench = Bench::on(Edition::V1_1, Options::default());
    bench.pass(150 * MS);
    assert_eq!(bench.demand(true), ["150000 C/Q 0"]);
    assert_eq!(bench.pass(500 * MS), ["150200 I/Q 0"]);
    assert_eq!(bench.demand(false), ["650000 C/Q 1"]);
    assert_eq!(bench.pass(100 * MS), ["650200 I/Q 1", "750000 C/Q 0"]);
}

#[rstest]
#[case(Mutant::ReadyPulseShort, Edition::V1_1, &["100000 C/Q 1", "100499 C/Q 0"])]
#[case(Mutant::ReadyPulseLong, Edition::V1_1, &["100000 C/Q 1", "101001 C/Q 0"])]
#[case(Mutant::ReadyPulseOnBothPins, Edition::V1_1, &["100000 C/Q 1", "100000 I/Q 1", "100750 I/Q 0", "100750 C/Q 0"])]
#[case(Mutant::OnInSelfTest, Edition::V1_1, &["1000 I/Q 1", "2000 I/Q 0", "100000 C/Q 1", "100750 C/Q 0"])]
#[case(Mutant::NoReadyPulse, Edition::V1_1, &[])]
#[case(Mutant::SecondReadyPulse, Edition::V1_1, &["100000 C/Q 1", "100750 C/Q 0", "100950 C/Q 1", "101050 C/Q 0"])]
fn mutants_of_the_ready_pulse(#[case] mutant: Mutant, #[case] edition: Edition, #[case] expected: &[&str]) {
    assert_eq!(Bench::with(edition, mutant).pass(101_200 * US), expected);
}

#[rstest]
#[case(Mutant::OssdeEarly, Edition::V1_1, "101449 C/Q 1")]
#[case(Mutant::OssdeEarly, Edition::Iec2022, "1100750 C/Q 1")]
#[case(Mutant::DiscrepancyLong, Edition::V1_1, "104651 I/Q 1")]
#[case(Mutant::DiscrepancyLong, Edition::Iec2022, "1301751 I/Q 1")]
#[case(Mutant::TestPulseLong, Edition::V1_1, "302651 C/Q 1")]
#[case(Mutant::TestPulsesDense, Edition::V1_1, "111550 C/Q 0")]
#[case(Mutant::ReadyPulseLate, Edition::V1_1, "5001000 C/Q 1")]
fn mutants_of_ossde_operation(#[case] mutant: Mutant, #[case] edition: Edition, #[case] edge: &str) {
    let seen = Bench::with(edition, mutant).pass(6_000 * MS);
    assert!(seen.iter().any(|line| line == edge), "{edge} is not in {:?}", &seen[..seen.len().min(12)]);
}

#[rstest]
#[case(None, 1_000, true)]
#[case(Some(Mutant::ShutDownLong), 1_000, false)]
#[case(Some(Mutant::ShutDownLong), 2_000, true)]
fn after_a_power_cycle_there_is_a_ready_pulse(
    #[case] mutant: Option<Mutant>,
    #[case] off_ms: u64,
    #[case] pulse: bool,
) {
    let mut bench = Bench::on(Edition::Iec2022, Options { mutant, ..Options::default() });
    bench.pass(200 * MS);
    bench.apply(&[Stimulus::Power(false), Stimulus::Advance { ns: off_ms * MS }, Stimulus::Power(true)]);
    assert_eq!(bench.pass(200 * MS).len(), if pulse { 2 } else { 0 });
}

#[test]
fn power_off_takes_the_levels_along() {
    let mut bench = Bench::on(Edition::V1_1, Options::default());
    bench.pass(150 * MS);
    assert_eq!(edges(&bench.apply(&[Stimulus::Power(false)])), ["150000 C/Q 0", "150000 I/Q 0", "150000 L+ 0"]);
}

#[test]
fn a_long_time_shows_the_first_test_pulses_and_goes_on_after_it() {
    let mut bench = Bench::on(Edition::V1_1, Options::default());
    let seen = bench.pass(3_600_000 * MS);
    assert!((20..=64).contains(&seen.len()), "{}", seen.len());
    assert_eq!(bench.pass(101 * MS), ["3600100000 C/Q 0", "3600100500 C/Q 1"]);
}
