//! The shortest ways, one test each, beside the counterexamples an exploration in another language printed (C1 to C10), and the
//! same charts with machines of the default readings.

use fsct_proof::{Fate, Line, Model, PROPERTIES, Reading, Timing, Turn, Verdict, prove, replay};
use fsct_protocol::Edition;
use fsct_protocol::scl::{Path, State, Var};
use fsct_protocol::spdu::inv3;
use rstest::rstest;

const NEW: Edition = Edition::Iec2022;

fn read(edition: Edition, readings: &[Reading]) -> Model {
    Model { readings: readings.to_vec(), ..Model::new(edition) }
}

/// The chart of a property, and how many exchanges of it repeat.
fn chart(model: &Model, name: &str) -> (Vec<Line>, usize) {
    let property = PROPERTIES.iter().find(|property| property.name == name).expect("a property");
    match prove(model, property).expect("a model that can be explored").verdict {
        Verdict::Violated(lines) | Verdict::Tables(lines) => (lines, 0),
        Verdict::LockUp(lines, repeats) => (lines, repeats),
        other => panic!("{name}: {other:?}"),
    }
}

fn took(path: &Path, numbers: &[u8]) -> bool {
    path.iter().any(|t| numbers.contains(&t.0))
}

fn locked(reading: Reading) -> (Vec<Turn>, Vec<Turn>) {
    let (lines, repeats) = chart(&read(NEW, &[reading]), "P5");
    let turns: Vec<Turn> = lines.iter().map(|line| line.turn).collect();
    let (way, tail) = turns.split_at(turns.len() - repeats);
    (way.to_vec(), tail.to_vec())
}

/// Printed with two lost SPDUs and T8, ten exchanges before the cycle. Ours needs five: one falsified first answer puts the
/// FS-Master one counter ahead just as well, without any expiry.
#[test]
fn c1_one_counter_behind_for_ever() {
    let (way, tail) = locked(Reading::NotOld);
    assert_eq!((way.len(), tail.len()), (5, 7));
    assert_eq!((way[1].back, way[1].master.state()), (Fate::Bad(0), State(7)));
    for turn in &tail {
        assert!(took(&turn.master_path, &[12]), "each answer is a fault: {turn:?}");
        let answered = turn.status.expect("an answer").dcount_i;
        assert!(answered != inv3(turn.control.mcount), "none is the mirror of what was sent: {turn:?}");
    }
}

/// As printed: a first SPDU with the counter bits 2, then MCount 0 is ignored for ever.
#[test]
fn c2_mcount_0_is_ignored_for_ever() {
    let (way, tail) = locked(Reading::ExactlyNext);
    assert_eq!((way.len(), tail.len()), (7, 4));
    assert_eq!(way[1].there, Fate::Bad(2));
    assert!(tail.iter().all(|turn| turn.control.mcount == 0 && !took(&turn.device_path, &[27])));
    assert!(
        tail.iter().any(|turn| took(&turn.device_path, &[30]))
            && tail.iter().any(|turn| took(&turn.master_path, &[14]))
    );
}

/// As printed: the first SPDU seen is 1, and nothing is ever valid. Two exchanges lead there.
#[test]
fn c3_nothing_valid_yet_for_ever() {
    let (way, tail) = locked(Reading::PreviousValid);
    assert_eq!((way.len(), tail.len()), (2, 14));
    let taken = way.iter().chain(&tail).find(|turn| took(&turn.device_path, &[21])).expect("a first SPDU");
    assert_eq!(taken.control.mcount, 1);
    assert!(tail.iter().all(|turn| turn.device.get(Var::DcommErr) == 1), "each SPDU is a CommErr");
}

/// Printed with 1 falsified and then counter bits 0. Ours takes one falsified image each way: bits 0 in the first SPDU do as well.
#[test]
fn c4_an_answer_of_before_for_ever() {
    let (way, tail) = locked(Reading::MirrorValid);
    assert_eq!((way.len(), tail.len()), (6, 4));
    assert_eq!((way[1].there, way[1].back), (Fate::Bad(0), Fate::Bad(0)));
    assert!(tail.iter().all(|turn| turn.control.mcount == 0 && turn.device.status().dcount_i == 0));
}

/// As long as printed, exchange by exchange.
#[test]
fn c5_a_power_cycle_passes_unnoticed() {
    let (lines, _) = chart(&read(Edition::V1_1, &[Reading::FirstOne]), "P2d");
    assert_eq!(lines.len(), 12);
    assert!(!lines[3].turn.powered() && lines[4].turn.powered());
    assert!(took(&lines[5].turn.device_path, &[21, 22]) && lines[5].turn.control.mcount == 1);
    assert!(lines[11].turn.device.uses_pdout());
    assert!(!lines.iter().any(|line| took(&line.turn.master_path, &[7, 8])), "the FS-Master finds no fault");
}

/// Printed in operation, 25 exchanges. The table beside it says 12, as ours: two errors in a row at the start, the answers to the
/// first lost, and the second is forgotten before one arrives.
#[test]
fn c6_a_second_error_is_forgotten() {
    let (lines, _) = chart(&read(NEW, &[Reading::Sequential]), "P2d");
    assert_eq!(lines.len(), 12);
    let wrong = lines.iter().filter(|line| matches!(line.turn.there, Fate::Bad(_))).count();
    assert_eq!(wrong, 2);
    assert!(!lines.iter().any(|line| took(&line.turn.master_path, &[7, 8, 12])), "the FS-Master hears of neither");
    assert!(lines[11].turn.device.uses_pdout());
}

/// As long as printed: the eighth exchange shows DTimeout for the third time.
#[test]
fn c7_dtimeout_in_a_third_answer() {
    let (lines, _) = chart(&Model::new(NEW), "P6-timeout");
    assert_eq!(lines.len(), 8);
    let shown = lines.iter().filter(|line| line.turn.device.status().d_timeout && !line.turn.device_path.is_empty());
    assert_eq!(shown.filter(|line| line.turn.device.state() == State(26)).count(), 3);
}

/// As long as printed.
#[test]
fn c8_two_spdus_with_sd_after_a_master_only_fault() {
    let (lines, _) = chart(&Model::new(NEW), "P3-master");
    assert_eq!(lines.len(), 6);
    assert!(took(&lines[1].turn.master_path, &[7]) && took(&lines[5].turn.master_path, &[11]));
}

/// Printed for a watchdog of three and immediate answers, seven exchanges. Ours, four and pipelined, needs one more.
#[rstest]
#[case(4, Timing::Pipelined, 8)]
#[case(3, Timing::Immediate, 7)]
fn c10_an_answer_to_an_earlier_spdu(#[case] watchdog: u8, #[case] timing: Timing, #[case] exchanges: usize) {
    let (lines, _) = chart(&Model { watchdog, timing, ..Model::new(NEW) }, "P7-good");
    assert_eq!(lines.len(), exchanges);
    assert!(
        lines.iter().any(|line| line.turn.back == Fate::Bad(7)) && took(&lines[exchanges - 1].turn.master_path, &[13])
    );
}

/// What the tables themselves allow happens once more, exchange by exchange.
#[rstest]
fn a_chart_of_the_tables_is_replayed_as_it_was(
    #[values("P3-master", "P6-timeout", "P7-good")] name: &str,
    #[values(Timing::Pipelined, Timing::Immediate)] timing: Timing,
) {
    let model = Model { timing, ..Model::new(NEW) };
    let (lines, _) = chart(&model, name);
    let texts = |lines: &[Line]| {
        lines
            .iter()
            .map(|line| (line.spdu.clone(), line.device.clone(), line.answer.clone(), line.master.clone()))
            .collect::<Vec<_>>()
    };
    let again: Vec<Line> = replay(&model, &lines, false).into_iter().map(Line::from).collect();
    assert_eq!(texts(&again), texts(&lines));
}

/// By default no fault is followed by live data without a later acknowledgment, whatever broke the other reading; and operation
/// comes back.
#[rstest]
fn by_default_the_same_disturbances_do_no_harm(
    #[values((NEW, Reading::Sequential), (Edition::V1_1, Reading::FirstOne))] (edition, reading): (Edition, Reading),
    #[values(Timing::Pipelined, Timing::Immediate)] timing: Timing,
) {
    let model = Model { timing, ..read(edition, &[reading]) };
    let (lines, _) = chart(&model, "P2d");
    let turns = replay(&model, &lines, true);
    // 0: no fault; 1: one; 2: and ChFAck_C has been seen at 0 since.
    let (mut open, mut faults) = (0, 0);
    for turn in &turns {
        if took(&turn.device_path, &[25, 30, 31]) || !turn.powered() && turn.master_before.state() != State(2) {
            (open, faults) = (1, faults + 1);
        } else if open == 1 && took(&turn.master_path, &[13]) && turn.master.get(Var::ChFAckCe) == 1 {
            open = 2;
        } else if open == 2 && took(&turn.master_path, &[11]) {
            open = 0;
        }
        assert!(open == 0 || !turn.device.uses_pdout(), "{turn:?}");
    }
    let last = turns.last().expect("exchanges");
    assert!(faults > 0 && last.device.uses_pdout() && last.pdin(), "{last:?}");
}
