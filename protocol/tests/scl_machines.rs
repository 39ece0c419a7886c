//! The rows are those of the tables, and whatever comes in, the machines stay in them.

use fsct_protocol::scl::device::{Readings, Received};
use fsct_protocol::scl::master::Answer;
use fsct_protocol::scl::{Device, Master, Path, Row, State, T, Var, device, master};
use fsct_protocol::spdu::{Control, Status};
use proptest::prelude::*;
use rstest::rstest;

fn edges(rows: &[Row]) -> Vec<(u8, u8, u8)> {
    rows.iter().map(|row| (row.id.0, row.source.0, row.target.0)).collect()
}

#[test]
fn table_38_has_these_transitions() {
    let expected = [
        (1, 0, 1),
        (2, 1, 2),
        (3, 2, 3),
        (4, 3, 4),
        (5, 4, 5),
        (6, 5, 3),
        (7, 3, 6),
        (8, 5, 6),
        (9, 6, 7),
        (10, 7, 8),
        (11, 8, 4),
        (12, 8, 6),
        (13, 8, 6),
        (14, 7, 6),
    ];
    assert_eq!(edges(&master::ROWS), expected);
}

#[test]
fn table_40_has_these_transitions() {
    let expected = [
        (20, 20, 21),
        (21, 21, 22),
        (22, 22, 23),
        (23, 23, 24),
        (24, 24, 22),
        (25, 22, 25),
        (26, 25, 26),
        (27, 26, 27),
        (28, 27, 23),
        (29, 27, 25),
        (29, 27, 25),
        (30, 26, 25),
        (31, 24, 25),
    ];
    assert_eq!(edges(&device::ROWS), expected);
}

/// What can happen to an FS-Device.
#[derive(Copy, Clone, Debug)]
enum Event {
    Spdu { mcount: u8, set_sd: bool, ch_f_ack_req: bool, intact: bool },
    Timeout,
    SdsetDs(bool),
}

fn event() -> impl Strategy<Value = Event> {
    prop_oneof![
        6 => (0u8..8, any::<bool>(), any::<bool>(), prop::bool::weighted(0.8))
            .prop_map(|(mcount, set_sd, ch_f_ack_req, intact)| Event::Spdu { mcount, set_sd, ch_f_ack_req, intact }),
        1 => Just(Event::Timeout),
        1 => any::<bool>().prop_map(Event::SdsetDs),
    ]
}

fn readings() -> impl Strategy<Value = Readings> {
    (any::<bool>(), any::<bool>(), any::<bool>()).prop_map(|(last_valid, jump_ignored, sequential)| Readings {
        last_valid,
        jump_ignored,
        sequential,
        ..Readings::default()
    })
}

proptest! {
    #[test]
    fn an_fs_device_gives_out_process_data_only_when_it_may(readings in readings(), events in prop::collection::vec(event(), 1..80)) {
        let mut scl = Device::new(readings);
        scl.start();
        for event in events {
            match event {
                Event::SdsetDs(value) => scl.set_sdset_ds(value),
                Event::Timeout => {
                    let path = scl.expire();
                    if !path.is_empty() {
                        prop_assert!(!scl.uses_pdout() && scl.status().d_timeout && scl.status().sd_set);
                    }
                }
                Event::Spdu { mcount, set_sd, ch_f_ack_req, intact } => {
                    let good = intact && scl.counter_check(mcount);
                    let control = Control { mcount, set_sd, ch_f_ack_req };
                    let path = scl.receive(Received { control, intact });
                    if !path.is_empty() {
                        prop_assert!(!scl.uses_pdout() || good && !set_sd, "{path:?}");
                        prop_assert!(good || scl.status().d_comm_err && scl.status().sd_set);
                        prop_assert!(scl.timer_restarted());
                    }
                }
            }
            prop_assert!(matches!(scl.state().0, 21 | 24 | 26));
            prop_assert!(scl.get(Var::SdCycles) <= 3);
            prop_assert!(!(scl.uses_pdout() && scl.get(Var::SdCycles) > 0));
        }
    }

    #[test]
    fn an_fs_master_never_restarts_by_itself(events in prop::collection::vec((0u8..8, any::<u8>(), any::<bool>(), prop::bool::weighted(0.1)), 1..80)) {
        let mut scl = Master::new();
        scl.start();
        let mut faulted = false;
        for (dcount_i, bits, intact, timeout) in events {
            if timeout {
                faulted |= !scl.expire().is_empty();
            } else {
                let status = Status { dcount_i, sd_set: bits & 1 == 1, d_comm_err: bits & 14 == 2, d_timeout: bits & 112 == 16 };
                let path = scl.receive(Answer { status, intact });
                faulted |= path.iter().any(|t| matches!(t.0, 7 | 12));
            }
            // ChFAck_C stays 0: after a fault SD both ways, for ever.
            prop_assert!(!faulted || scl.control().set_sd && !scl.uses_pdout() && scl.get(Var::In) == 0);
            prop_assert!(matches!(scl.state().0, 2 | 5 | 7));
            prop_assert!(scl.control().mcount <= 7);
        }
    }
}

/// The answers of section 1 of the digest: SDset, DCommErr, DTimeout and PDout in use, answer by answer.
#[rstest]
#[case::start_up(&[], &[(0, true), (1, true), (2, true), (3, true)], &[(1, 0, 0, 0), (1, 0, 0, 0), (1, 0, 0, 0), (0, 0, 0, 1)])]
#[case::comm_err(&[0, 1, 2, 3], &[(4, false), (5, true), (6, true), (7, true), (1, true), (2, true)], &[(1, 1, 0, 0), (1, 1, 0, 0), (1, 0, 0, 0), (1, 0, 0, 0), (0, 0, 0, 0), (0, 0, 0, 1)])]
#[case::first_spdu_bad(&[], &[(0, false), (1, true), (2, true), (3, true), (4, true)], &[(1, 1, 1, 0), (1, 1, 0, 0), (1, 0, 0, 0), (1, 0, 0, 0), (0, 0, 0, 0)])]
#[case::mcount_0_in_operation(&[0, 1, 2, 3], &[(0, true), (1, true)], &[(0, 0, 0, 1), (0, 0, 0, 1)])]
fn answers_of_an_fs_device(#[case] before: &[u8], #[case] spdus: &[(u8, bool)], #[case] answers: &[(u8, u8, u8, u8)]) {
    let mut scl = Device::new(Readings::default());
    scl.start();
    let send = |scl: &mut Device, mcount, intact| {
        scl.receive(Received { control: Control { mcount, set_sd: false, ch_f_ack_req: false }, intact });
    };
    before.iter().for_each(|mcount| send(&mut scl, *mcount, true));
    for ((mcount, intact), expected) in spdus.iter().zip(answers) {
        send(&mut scl, *mcount, *intact);
        let status = scl.status();
        let found = (
            u8::from(status.sd_set),
            u8::from(status.d_comm_err),
            u8::from(status.d_timeout),
            u8::from(scl.uses_pdout()),
        );
        assert_eq!((status.dcount_i, found), (7 - mcount, *expected), "after MCount {mcount}");
    }
}

fn control(mcount: u8) -> Control {
    Control { mcount, set_sd: false, ch_f_ack_req: false }
}

fn good(mcount: u8) -> Received {
    Received { control: control(mcount), intact: true }
}

fn answer(dcount_i: u8) -> Answer {
    let status = Status { dcount_i, sd_set: false, d_comm_err: false, d_timeout: false };
    Answer { status, intact: true }
}

fn numbers(path: Path) -> Vec<u8> {
    path.iter().map(|t| t.0).collect()
}

#[test]
fn a_repetition_is_old_and_any_other_counter_is_not() {
    let mut scl = Device::regular(3);
    assert_eq!(scl.previous(), Some(3));
    assert!(scl.is_old(3) && !scl.is_old(4) && !scl.is_old(0));
    assert!(scl.receive(good(3)).is_empty());
    assert_eq!((numbers(scl.receive(good(4))), scl.previous()), (vec![24, 22, 23], Some(4)));
    let mut first = Device::new(Readings::default());
    first.start();
    assert_eq!((first.is_old(0), first.previous()), (false, None));
}

#[test]
fn counter_check_of_table_40() {
    let scl = Device::regular(7);
    let taken: Vec<u8> = (0..8).filter(|mcount| scl.counter_check(*mcount)).collect();
    assert_eq!(taken, [0, 1]);
    assert_eq!(numbers(Device::regular(3).receive(good(5))), [24, 25, 26], "a jump is a CommErr");
}

#[test]
fn a09_leaves_jumps_alone_and_nothing_else() {
    let ignoring = || {
        let mut scl = Device::regular(3);
        scl.set_readings(Readings { jump_ignored: true, ..Readings::default() });
        scl
    };
    assert!(ignoring().receive(good(5)).is_empty());
    assert_eq!(numbers(ignoring().receive(good(4))), [24, 22, 23]);
    assert_eq!(numbers(ignoring().receive(good(0))), [24, 22, 23]);
    let hit = Received { intact: false, ..good(5) };
    assert_eq!(numbers(ignoring().receive(hit)), [24, 25, 26], "one that is hit is no jump");
    let mut first = Device::new(Readings { jump_ignored: true, ..Readings::default() });
    first.start();
    assert_eq!(numbers(first.receive(good(5))), [21, 25, 26], "the first SPDU is no jump");
}

#[test]
fn a19_is_taken_up_by_the_rows() {
    let mut scl = Device::regular(3);
    scl.set_readings(Readings { sequential: true, ..Readings::default() });
    assert_eq!((scl.get(Var::Sequential), scl.readings().sequential), (1, true));
}

#[test]
fn sdset_ds_shows_in_the_next_answer() {
    let mut scl = Device::regular(3);
    scl.set_sdset_ds(true);
    scl.receive(good(4));
    assert!(scl.status().sd_set && scl.uses_pdout());
}

#[test]
fn d_timer_runs_from_the_first_answer_on() {
    let mut scl = Device::new(Readings::default());
    assert!(!scl.timer_runs());
    scl.start();
    assert!(!scl.timer_runs());
    scl.receive(good(0));
    assert!(scl.timer_runs() && scl.timer_restarted());
    scl.receive(Received { intact: false, ..good(1) });
    assert!(scl.timer_runs() && scl.state() == State(26));
    let mut waiting = Device::new(Readings::default());
    waiting.start();
    assert!(!waiting.timer_restarted() && waiting.expire().is_empty());
}

#[test]
fn an_fs_device_in_regular_operation() {
    for (mcount, next) in [(3, 4), (7, 1), (3 + 8, 4)] {
        let mut scl = Device::regular(mcount);
        assert_eq!(scl.status(), answer(7 - (mcount & 7)).status);
        assert_eq!((scl.previous(), scl.get(Var::SetSdDc)), (Some(mcount & 7), 0));
        assert_eq!(numbers(scl.receive(good(next))), [24, 22, 23]);
        assert!(scl.uses_pdout() && !scl.status().sd_set);
    }
}

#[test]
fn an_fs_master_in_regular_operation() {
    for mcount in [1, 2, 7, 2 + 8] {
        let mut scl = Master::regular(mcount);
        let (own, before) = (mcount & 7, if mcount & 7 == 1 { 7 } else { (mcount & 7) - 1 });
        assert_eq!(
            (scl.state(), scl.control(), scl.uses_pdout(), scl.timer_runs()),
            (State(5), control(own), true, true)
        );
        assert!(!scl.takes(7 - before), "the answer before is old");
        assert_eq!(numbers(scl.receive(answer(7 - own))), [6, 4, 5]);
        assert_eq!((scl.get(Var::In), scl.uses_pdout(), scl.timer_restarted()), (1, true, true));
    }
}

#[test]
fn an_fs_master_behind_a_fault() {
    for mcount in [0, 4, 7, 4 + 8] {
        let scl = Master::after_fault(mcount);
        let expected = Control { mcount: mcount & 7, set_sd: true, ch_f_ack_req: false };
        assert_eq!((scl.state(), scl.control(), scl.get(Var::SdsetS)), (State(7), expected, 1));
        assert!(!scl.uses_pdout() && scl.timer_runs());
        let taken: Vec<u8> = (0..8).filter(|dcount_i| scl.takes(*dcount_i)).collect();
        assert_eq!(taken, [7 - (mcount & 7)], "the mirrored one alone (T10)");
    }
}

#[test]
fn m_timer_does_not_run_before_the_first_answer() {
    let mut scl = Master::new();
    assert!(!scl.timer_runs() && !scl.takes(7) && scl.receive(answer(7)).is_empty());
    scl.start();
    assert!(!scl.timer_runs() && !scl.timer_restarted() && scl.takes(3));
}

#[test]
fn set_sd_c_gives_sd_without_a_fault() {
    let mut scl = Master::regular(3);
    scl.set_set_sd_c(true);
    assert_eq!(numbers(scl.receive(answer(4))), [6, 4, 5]);
    assert!(scl.control().set_sd && !scl.uses_pdout() && scl.get(Var::In) == 0);
}

#[test]
fn the_row_that_decides_an_answer_is_not_the_one_that_sends_it() {
    assert_eq!(Device::regular(3).receive(good(4)).deciding(), Some(T(22)));
    assert_eq!(Master::regular(3).receive(answer(4)).deciding(), Some(T(4)));
    assert_eq!((Path::default().deciding(), State(24).to_string()), (None, "24".into()));
}

#[test]
fn settled_machines_differ_only_in_what_matters_later() {
    let (mut pressed, free) = (Master::regular(3), Master::regular(3));
    pressed.set_ch_f_ack_c(true);
    pressed.set_set_sd_c(true);
    assert_ne!(pressed, free);
    assert_eq!(pressed.settled(false), free.settled(false));
    assert_eq!(pressed.settled(false).previous(), Some(5));
    pressed.expire();
    assert_eq!((pressed.settled(false).previous(), pressed.settled(true).previous()), (None, Some(5)));
    let (mut asked, device) = (Device::regular(3), Device::regular(3));
    asked.set_sdset_ds(true);
    assert_ne!(asked, device);
    assert_eq!(asked.settled(), device.settled());
}

/// 2 arrives as 5 with a bad signature, then as it was sent: which counter the answer mirrors, and whether the second is a jump.
#[rstest]
#[case::processed(Readings::default(), 2, true)]
#[case::previous_valid(Readings { previous_valid: true, ..Readings::default() }, 2, false)]
#[case::mirror_valid(Readings { mirror_valid: true, ..Readings::default() }, 6, true)]
#[case::last_valid(Readings { last_valid: true, ..Readings::default() }, 6, false)]
fn what_a_wrong_spdu_leaves_behind(#[case] readings: Readings, #[case] dcount_i: u8, #[case] jump: bool) {
    let mut scl = Device::new(readings);
    scl.start();
    let spdu = |mcount, intact| Received { control: Control { mcount, set_sd: false, ch_f_ack_req: false }, intact };
    for mcount in [0, 1] {
        scl.receive(spdu(mcount, true));
    }
    scl.receive(spdu(5, false));
    assert_eq!(scl.status().dcount_i, dcount_i);
    scl.receive(spdu(2, true));
    assert_eq!(scl.get(Var::CommErr) == 1, jump);
}
