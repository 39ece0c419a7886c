//! Each of the first mutants of the FS-Master differs from the original where its sentence says, and the original is right there.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod master_common;

use fsct_adapters::{Mode, Octets, Seen, Service};
use fsct_protocol::Edition;
use fsct_reference::{MasterMutant, MasterOptions};
use master_common::*;

/// What `look` sees on the original and on the mutant.
fn seen<T>(which: MasterMutant, look: impl Fn(MasterOptions) -> T) -> (T, T) {
    (look(MasterOptions::default()), look(mutant(which)))
}

fn operate(options: MasterOptions) -> Bench {
    Bench::operate_with(plain(), options)
}

/// The SPDU behind each of these answers.
fn outs(bench: &mut Bench, answers: &[Answer]) -> Vec<Out> {
    let out = |answer: &Answer| {
        bench.answer(*answer);
        bench.out().expect("a right SPDU")
    };
    answers.iter().map(out).collect()
}

#[test]
fn names_are_unique_and_known() {
    assert!(MasterMutant::ALL.len() >= 60);
    for mutant in MasterMutant::ALL.iter().copied() {
        // Of two with the same name, one would not be found.
        assert_eq!(MasterMutant::from_name(mutant.name()), Some(mutant));
        assert!(!mutant.clause().is_empty() && mutant.about().ends_with('.'));
    }
    assert_eq!(MasterMutant::from_name("original"), None);
}

#[test]
fn restart_without_acknowledgment() {
    let (right, wrong) = seen(MasterMutant::RestartWithoutAcknowledgment, |options| {
        outs(&mut operate(options), &[d(3).bad(), d(2), d(1)])
    });
    assert_eq!(right, [m(5).sd(), m(6).sd().ack_req(), m(7).sd().ack_req()]);
    assert_eq!(wrong, [m(5).sd(), m(6), m(7)]);
}

#[test]
fn acknowledgment_as_level() {
    let (right, wrong) = seen(MasterMutant::AcknowledgmentAsLevel, |options| {
        let mut bench = operate(options);
        bench.ack(1);
        outs(&mut bench, &[d(3).bad(), d(2)])
    });
    assert_eq!(right, [m(5).sd(), m(6).sd().ack_req()]);
    assert_eq!(wrong, [m(5).sd(), m(6)]);
}

/// An edge acknowledges the mutant as well.
#[test]
fn acknowledgment_as_level_waits_for_the_level() {
    let mut bench = operate(mutant(MasterMutant::AcknowledgmentAsLevel));
    assert_eq!(outs(&mut bench, &[d(3).bad(), d(2)])[1], m(6).sd().ack_req());
    bench.ack(1);
    assert_eq!(outs(&mut bench, &[d(1)]), [m(7)]);
}

#[test]
fn mcount_not_reset() {
    let (right, wrong) = seen(MasterMutant::McountNotReset, |options| {
        let mut bench = operate(options);
        [(); 5].map(|()| {
            bench.advance(WATCHDOG);
            bench.receive(None);
            bench.out().unwrap().m_count
        })
    });
    assert_eq!(right, [0; 5]);
    assert_eq!(wrong, [5, 6, 7, 1, 2]);
}

/// Expiries that are passed over leave the counter where it would be.
#[test]
fn mcount_not_reset_counts_through_long_times() {
    for expiries in [1, 2, 7, 8, 9, 1000, 1003] {
        let mut bench = operate(mutant(MasterMutant::McountNotReset));
        bench.advance(expiries * WATCHDOG);
        bench.receive(None);
        assert_eq!(u64::from(bench.out().unwrap().m_count), (3 + expiries) % 7 + 1);
    }
}

#[test]
fn m_timer_restarted_by_repetitions() {
    let (right, wrong) = seen(MasterMutant::MTimerRestartedByRepetitions, |options| {
        let mut bench = operate(options);
        bench.advance(WATCHDOG - 1);
        bench.answer(d(4));
        bench.advance(1);
        bench.receive(None);
        bench.out().unwrap()
    });
    assert_eq!((right, wrong), (m(0).sd(), m(4)));
}

#[test]
fn plain_port_num_accepted() {
    let (right, wrong) =
        seen(MasterMutant::PlainPortNumAccepted, |options| outs(&mut operate(options), &[d(3).port(PORT), d(2)]));
    assert_eq!(right, [m(5).sd(), m(6).sd().ack_req()]);
    assert_eq!(wrong, [m(5), m(6)]);
}

#[test]
fn d_timeout_ignored() {
    let (right, wrong) =
        seen(MasterMutant::DTimeoutIgnored, |options| outs(&mut operate(options), &[d(3).sd_set().timeout()]));
    assert_eq!((right, wrong), (vec![m(5).sd()], vec![m(5)]));
}

#[test]
fn pdin_live_while_sdset() {
    let (right, wrong) = seen(MasterMutant::PdinLiveWhileSdset, |options| {
        let mut bench = operate(options);
        bench.answer(d(3).sd_set());
        (bench.bit(Service::SdsetS), bench.service(Service::PdinM))
    });
    assert_eq!(right, (true, Octets::new(&[0; 3])));
    assert_eq!(wrong, (true, Octets::new(&[PD_IN; 3])));
}

#[test]
fn qualifier_released_early() {
    let (right, wrong) = seen(MasterMutant::QualifierReleasedEarly, |options| {
        let mut bench = operate(options);
        [d(3).bad(), d(2), d(1)].map(|answer| {
            bench.answer(answer);
            bench.bit(Service::Qualifier)
        })
    });
    assert_eq!((right, wrong), ([false; 3], [false, true, true]));
}

#[test]
fn ch_f_ack_req_early() {
    let (right, wrong) = seen(MasterMutant::ChFAckReqEarly, |options| outs(&mut operate(options), &[d(3).bad(), d(2)]));
    assert_eq!(right, [m(5).sd(), m(6).sd().ack_req()]);
    assert_eq!(wrong, [m(5).sd().ack_req(), m(6).sd().ack_req()]);
}

#[test]
fn counter_7_to_0() {
    let (right, wrong) = seen(MasterMutant::Counter7To0, |options| {
        outs(&mut operate(options), &[d(3), d(2), d(1), d(0)]).last().unwrap().m_count
    });
    assert_eq!((right, wrong), (1, 0));
}

#[test]
fn record_after_operate() {
    let (right, wrong) = seen(MasterMutant::RecordAfterOperate, |options| {
        let mut bench = Bench::factory_with(plain(), options);
        bench.configure(&list(plain()));
        bench.start_up_to_record();
        bench.seen()
    });
    let start = [wake_up(), mode(Mode::Startup), mode(Mode::Preoperate)];
    assert_eq!(right, [&start[..], &[record(&list(plain()))]].concat());
    assert_eq!(wrong, [&start[..], &[mode(Mode::Operate), record(&list(plain()))]].concat());
}

/// The record alone is wrong; the FS-Master itself verifies the right one.
#[test]
fn wrong_arg_block_offset() {
    for edition in [Edition::V1_1, Edition::Iec2022] {
        let (right, wrong) = seen(MasterMutant::WrongArgBlockOffset, |options| {
            let mut bench = Bench::factory_with(of(edition), options);
            bench.configure(&list(of(edition)));
            bench.start_up_to_record();
            let data = bench.seen().into_iter().find_map(|seen| match seen {
                Seen::Request { data, .. } => data,
                _ => None,
            });
            bench.respond(fsct_adapters::Response::Written);
            (data.unwrap(), bench.info())
        });
        assert_eq!(right, (list(of(edition)).record(), 8));
        let slice = match edition {
            Edition::V1_1 => right.0.clone(),
            Edition::Iec2022 => list(of(edition)).octets()[14..37].to_vec(),
        };
        assert_eq!(wrong, (slice, 8));
    }
}

/// A mutant is wrong in one thing; a start and regular operation show none but its own. Of the further ones, many are about the
/// start itself; `master_catalogue.rs` looks at them.
#[test]
fn most_mutants_start_up_like_the_original() {
    use MasterMutant::{PdinLiveWhileSdset, RecordAfterOperate, WrongArgBlockOffset};
    for which in MasterMutant::ALL.iter().copied().take(12) {
        let (right, wrong) = seen(which, |options| {
            let mut bench = Bench::factory_with(plain(), options);
            bench.configure(&list(plain()));
            bench.start_up_to_record();
            let mut all = bench.seen();
            bench.respond(fsct_adapters::Response::Written);
            all.extend(bench.seen());
            for answer in [d(7).sd_set(), d(6).sd_set(), d(5).sd_set(), d(4), d(3), d(2)] {
                bench.answer(answer);
                all.extend(bench.seen());
            }
            all
        });
        let shows = matches!(which, PdinLiveWhileSdset | RecordAfterOperate | WrongArgBlockOffset);
        assert_eq!(right != wrong, shows, "{which}");
    }
}
