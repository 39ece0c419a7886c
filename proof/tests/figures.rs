//! The composition has as many states, holds and breaks the same, as an exploration written by somebody else in another language.
//!
//! The figures are those of that exploration: W = 4, any number of disturbed exchanges, power cycles of the FS-Device.

use fsct_proof::{Model, Outcome, PROPERTIES, Property, Reading, Timers, Timing, Verdict, prove, prove_all, reachable};
use fsct_protocol::Edition;
use rstest::rstest;

fn property(name: &str) -> &'static Property {
    PROPERTIES.iter().find(|property| property.name == name).expect("a property")
}

fn asked(model: &Model, name: &str) -> Outcome {
    prove(model, property(name)).expect("a model that can be explored")
}

/// Length of the shortest way to a violation; `None` where there is none.
fn shortest(model: &Model, name: &str) -> Option<usize> {
    match asked(model, name).verdict {
        Verdict::Holds => None,
        Verdict::Violated(lines) | Verdict::Tables(lines) | Verdict::LockUp(lines, _) => Some(lines.len()),
        Verdict::Unknown => panic!("{name} is unknown"),
    }
}

fn read(edition: Edition, readings: &[Reading]) -> Model {
    Model { readings: readings.to_vec(), ..Model::new(edition) }
}

const NEW: Edition = Edition::Iec2022;
const OLD: Edition = Edition::V1_1;

/// States; shortest violation of P2d in both timings; whether DTimeout may show more than twice; exchanges to operation in both
/// timings, `None` for a lock-up.
#[rstest]
#[case::default(NEW, &[], 16_389, None, true, [Some(12), Some(8)])]
#[case::v1_1(OLD, &[], 16_389, None, true, [Some(12), Some(8)])]
#[case::a31(OLD, &[Reading::FirstOne], 16_621, Some([12, 8]), true, [Some(12), Some(8)])]
#[case::a05(NEW, &[Reading::ZeroJudged], 16_389, None, true, [Some(12), Some(8)])]
#[case::a06_t10_not_old(NEW, &[Reading::NotOld], 76_213, None, true, [None, None])]
#[case::a06_t10_either(NEW, &[Reading::ExpectedOrNotOld], 76_213, None, true, [None, Some(8)])]
#[case::a06_t6_expected(NEW, &[Reading::Expected], 16_389, None, true, [Some(12), Some(8)])]
#[case::a08(NEW, &[Reading::PreviousValid], 38_118, None, true, [None, None])]
#[case::a16(NEW, &[Reading::MirrorValid], 39_333, None, true, [None, None])]
#[case::a08_a16(NEW, &[Reading::LastValid], 12_759, None, true, [Some(17), Some(12)])]
#[case::a09_exactly_next(NEW, &[Reading::ExactlyNext], 12_689, None, true, [None, None])]
#[case::a09_next_or_0(NEW, &[Reading::NextOrZero], 14_137, None, true, [Some(16), Some(12)])]
#[case::a13(NEW, &[Reading::ThreeCycles], 21_373, None, true, [Some(12), Some(8)])]
#[case::a20(NEW, &[Reading::SetSdDcKept], 15_685, None, true, [Some(12), Some(8)])]
#[case::a23(NEW, &[Reading::ZeroReloads], 16_185, None, true, [Some(12), Some(8)])]
#[case::a19(NEW, &[Reading::Sequential], 21_905, Some([12, 8]), false, [Some(12), Some(8)])]
#[case::a29(NEW, &[Reading::OldJudged], 76_743, None, true, [Some(12), Some(8)])]
#[case::a30(NEW, &[Reading::FirstExpected], 16_389, None, true, [Some(12), Some(8)])]
#[case::a37(NEW, &[Reading::TimerFirst], 14_918, None, true, [Some(12), Some(8)])]
fn each_reading(
    #[case] edition: Edition,
    #[case] readings: &[Reading],
    #[case] states: usize,
    #[case] restart: Option<[usize; 2]>,
    #[case] unlimited: bool,
    #[case] recovery: [Option<u8>; 2],
) {
    let pipelined = read(edition, readings);
    assert_eq!(reachable(&pipelined), Ok(states));
    let immediate = Model { timing: Timing::Immediate, ..pipelined.clone() };
    for (at, model) in [pipelined, immediate].iter().enumerate() {
        assert_eq!(shortest(model, "P2d"), restart.map(|lengths| lengths[at]));
        // The others are the same in both timings; where there are many states, `fsct prove --all` asks them.
        if model.timing == Timing::Pipelined && states < 30_000 {
            for name in ["P1-live", "P2", "P3", "P6-comm", "P7-live"] {
                assert_eq!(shortest(model, name), None, "{name}");
            }
            assert_eq!((shortest(model, "P4"), asked(model, "P4").worst), (None, 4));
            assert_eq!(shortest(model, "P6-further").is_some(), readings == [Reading::Sequential]);
        }
        assert_eq!(shortest(model, "P6-timeout").is_some(), unlimited);
        let outcome = asked(model, "P5");
        match recovery[at] {
            Some(exchanges) => assert_eq!((outcome.verdict, outcome.worst), (Verdict::Holds, exchanges)),
            None => assert!(matches!(outcome.verdict, Verdict::LockUp(_, repeats) if repeats > 0)),
        }
    }
}

#[rstest]
#[case(2, 3_462, 16)]
#[case(3, 8_599, 18)]
#[case(4, 16_389, 20)]
#[case(6, 40_322, 24)]
#[case(8, 75_561, 28)]
#[case(10, 121_996, 33)]
fn sizes(#[case] watchdog: u8, #[case] states: usize, #[case] depth: usize) {
    let model = Model { watchdog, ..Model::new(NEW) };
    let outcome = asked(&model, "P7-live");
    assert_eq!((outcome.states, outcome.depth), (states, depth));
}

/// Without any disturbance the channel only carries the start and the wishes of the operator.
#[test]
fn the_smallest_model() {
    let model = Model { faults: Some(0), power_cycles: false, ..Model::new(NEW) };
    assert_eq!(reachable(&model), Ok(108));
}

/// The ages of accepted and of live data, and the time from a demand to SD: exact, not only bounds.
#[rstest]
fn bounds(
    #[values(2, 3, 4, 5)] watchdog: u8,
    #[values(Timing::Pipelined, Timing::Immediate)] timing: Timing,
    #[values(Reading::ReceptionFirst, Reading::TimerFirst)] order: Reading,
) {
    let model = Model { watchdog, timing, ..read(NEW, &[order]) };
    let early = u8::from(timing == Timing::Pipelined) + u8::from(order == Reading::TimerFirst);
    let late = 2 * watchdog - u8::from(timing == Timing::Pipelined) - 1 - u8::from(order == Reading::TimerFirst);
    // With a watchdog of one SCL cycle and the timer first nothing is ever live.
    if watchdog > 2 || timing == Timing::Immediate || order == Reading::ReceptionFirst {
        assert_eq!(asked(&model, "P1-taken").worst, watchdog - early);
        assert_eq!(asked(&model, "P1-live").worst, late);
        assert_eq!((asked(&model, "P8").verdict, asked(&model, "P8").worst), (Verdict::Holds, late));
    } else {
        assert_eq!(asked(&model, "P1-live").worst, 0);
    }
}

/// Exchanges to operation by watchdog, timing P and I, reception first and timer first.
#[rstest]
#[case(2, [Some(11), None], [Some(7), Some(10)])]
#[case(3, [Some(12), Some(15)], [Some(7), Some(8)])]
#[case(4, [Some(12), Some(12)], [Some(7), Some(8)])]
#[case(6, [Some(12), Some(12)], [Some(7), Some(8)])]
fn recovery(#[case] watchdog: u8, #[case] pipelined: [Option<u8>; 2], #[case] immediate: [Option<u8>; 2]) {
    for (timing, expected) in [(Timing::Pipelined, pipelined), (Timing::Immediate, immediate)] {
        for (order, expected) in [Reading::ReceptionFirst, Reading::TimerFirst].into_iter().zip(expected) {
            let outcome = asked(&Model { watchdog, timing, ..read(NEW, &[order]) }, "P5");
            let found = (outcome.verdict == Verdict::Holds).then_some(outcome.worst);
            assert_eq!(found, expected, "{timing} {order}");
        }
    }
}

/// The shortest ways of the tables themselves: two SD SPDUs behind a fault, DTimeout in a third answer.
#[rstest]
#[case("P3-master", 6)]
#[case("P6-timeout", 8)]
fn what_the_tables_allow(#[case] name: &str, #[case] exchanges: usize) {
    assert_eq!(shortest(&Model::new(NEW), name), Some(exchanges));
    assert!(matches!(asked(&Model::new(NEW), name).verdict, Verdict::Tables(_)));
}

/// Whether properties are asked together or one by one makes no difference.
#[test]
fn together_as_one_by_one() {
    let model = Model { faults: Some(2), ..Model::new(NEW) };
    let all: Vec<_> = PROPERTIES.iter().filter(|property| property.not_asked(&model).is_none()).collect();
    let together = prove_all(&model, &all).expect("a model that can be explored");
    for ((outcome, _), property) in together.iter().zip(all) {
        let alone = asked(&model, property.name);
        assert_eq!((outcome.property.name, &outcome.verdict), (property.name, &alone.verdict));
        assert_eq!((outcome.states, outcome.steps, outcome.worst), (alone.states, alone.steps, alone.worst));
    }
}

/// Whatever the watchdogs are: nothing counts exchanges.
#[rstest]
#[case(&[], None)]
#[case(&[Reading::Sequential], Some("P2d"))]
fn timers_without_time(#[case] readings: &[Reading], #[case] violated: Option<&str>) {
    let model = Model { timers: Timers::Any, ..read(NEW, readings) };
    for name in ["P2", "P2d", "P3"] {
        assert_eq!(shortest(&model, name).is_some(), violated == Some(name), "{name}");
    }
    assert!(reachable(&model) < reachable(&read(NEW, readings)));
}

#[test]
fn an_spdu_delayed_across_a_resynchronisation_is_taken() {
    let model = Model { watchdog: 3, storing: 2, ..Model::new(NEW) };
    assert_eq!(shortest(&model, "P7-order"), Some(8));
}

/// Seven cycles on, the counter is the next once more.
#[rstest]
#[case(Timing::Pipelined, 12)]
#[case(Timing::Immediate, 7)]
fn an_spdu_delayed_by_a_round_of_the_counter_is_taken(#[case] timing: Timing, #[case] exchanges: u8) {
    let order = |storing| {
        let model = Model { timing, storing, faults: Some(1), power_cycles: false, ..Model::new(NEW) };
        shortest(&model, "P7-order").is_some()
    };
    assert_eq!((order(exchanges - 1), order(exchanges)), (false, true));
}

/// An answer from before the restart, in state 2.
#[test]
fn a_restart_of_the_master_takes_a_fault_along() {
    let model = Model { master_restart: true, ..Model::new(NEW) };
    assert_eq!(shortest(&model, "P2d"), Some(8));
    assert_eq!(shortest(&Model::new(NEW), "P2d"), None);
}

/// What holds for a machine that changes its readings as it likes holds for each; what fails for one fails there as well.
#[test]
fn a_mixture_has_the_ways_of_each_of_its_readings() {
    let mixed = |readings: &[Reading]| Model { mixed: true, ..read(NEW, readings) };
    let harmless = [Reading::SetSdDcKept, Reading::ZeroReloads, Reading::FirstExpected, Reading::Expected];
    assert_eq!(shortest(&mixed(&harmless), "P2d"), None);
    let one_more = [&harmless[..], &[Reading::Sequential]].concat();
    assert_eq!(shortest(&mixed(&one_more), "P2d"), Some(12));
    for reading in harmless {
        assert!(reachable(&read(NEW, &[reading])) <= reachable(&mixed(&harmless)), "{reading}");
    }
}

#[test]
fn three_cycles_are_three_spdus_with_sd() {
    assert_eq!(shortest(&read(NEW, &[Reading::ThreeCycles]), "P3-master"), None);
}
