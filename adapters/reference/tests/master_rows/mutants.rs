//! Each deliberate fault shows at the spot it is named after, and a start without faults is right all the same.

use crate::bench::*;
use fsct_adapters::{Mode, Response};
use fsct_reference::{MasterMutant, MasterOptions};
use rstest::rstest;
use std::collections::HashSet;

/// The SPDU an answer leads to.
fn led_to(bench: &mut Bench, answer: In) -> Vec<u8> {
    bench.step(answer);
    image(bench)
}

fn image(bench: &Bench) -> Vec<u8> {
    bench.image().unwrap().as_slice().to_vec()
}

fn spdu(out: Out) -> Vec<u8> {
    out.octets().as_slice().to_vec()
}

#[rstest]
#[case::restart_without_acknowledgment(
    MasterMutant::RestartWithoutAcknowledgment,
    |mutant| led_to(&mut Bench::after_fault(mutant), d(2)),
    spdu(m(6).sd().ack_req()),
    spdu(m(6))
)]
#[case::acknowledgment_as_level(
    MasterMutant::AcknowledgmentAsLevel,
    |mutant| {
        let mut bench = Bench::operate_mutant(4, mutant);
        bench.press();
        bench.step(d(3).bad());
        led_to(&mut bench, d(2))
    },
    spdu(m(6).sd().ack_req()),
    spdu(m(6))
)]
#[case::mcount_not_reset(
    MasterMutant::McountNotReset,
    |mutant| {
        let mut bench = Bench::after_timeout(mutant);
        bench.exchange(None);
        image(&bench)
    },
    spdu(m(0).sd()),
    spdu(m(5).sd())
)]
#[case::m_timer_restarted_by_repetitions(
    MasterMutant::MTimerRestartedByRepetitions,
    |mutant| {
        let mut bench = Bench::operate_mutant(4, mutant);
        bench.advance(WATCHDOG / 2);
        bench.exchange(Some(d(4).octets()));
        bench.advance(WATCHDOG / 2);
        bench.exchange(None);
        image(&bench)
    },
    spdu(m(0).sd()),
    spdu(m(4))
)]
#[case::plain_port_num_accepted(
    MasterMutant::PlainPortNumAccepted,
    |mutant| led_to(&mut Bench::operate_mutant(4, mutant), d(3).port_num(PORT)),
    spdu(m(5).sd()),
    spdu(m(5))
)]
#[case::d_timeout_ignored(
    MasterMutant::DTimeoutIgnored,
    |mutant| led_to(&mut Bench::operate_mutant(4, mutant), d(3).timeout()),
    spdu(m(5).sd()),
    spdu(m(5))
)]
#[case::pdin_live_while_sdset(
    MasterMutant::PdinLiveWhileSdset,
    |mutant| {
        let mut bench = Bench::operate_mutant(4, mutant);
        bench.step(d(3).sd_set());
        bench.services.pdin_m
    },
    vec![0],
    vec![LIVE_IN]
)]
#[case::qualifier_released_early(
    MasterMutant::QualifierReleasedEarly,
    |mutant| {
        let mut bench = Bench::after_fault(mutant);
        bench.step(d(2));
        vec![bench.services.qualifier.into()]
    },
    vec![0],
    vec![1]
)]
#[case::ch_f_ack_req_early(
    MasterMutant::ChFAckReqEarly,
    |mutant| image(&Bench::after_fault(mutant)),
    spdu(m(5).sd()),
    spdu(m(5).sd().ack_req())
)]
#[case::counter_7_to_0(
    MasterMutant::Counter7To0,
    |mutant| {
        let mut bench = Bench::operate_mutant(4, mutant);
        (1..=3).rev().for_each(|answer| bench.step(d(answer)));
        led_to(&mut bench, d(0))
    },
    spdu(m(1)),
    spdu(m(0))
)]
#[case::record_after_operate(
    MasterMutant::RecordAfterOperate,
    |mutant| {
        let mut bench = Bench::configured(List::new(Iec2022), with(mutant));
        bench.plug(Some(identity()));
        bench.pulse(750_000);
        bench.modes().into_iter().map(Mode::number).collect()
    },
    vec![1, 2],
    vec![1, 2, 3]
)]
#[case::wrong_arg_block_offset(
    MasterMutant::WrongArgBlockOffset,
    |mutant| {
        let mut bench = Bench::configured(List::new(Iec2022), with(mutant));
        bench.connect();
        bench.requests().remove(0).2.unwrap()
    },
    List::new(Iec2022).octets()[16..39].to_vec(),
    List::new(Iec2022).octets()[14..37].to_vec()
)]
fn a_mutant_differs_where_it_should(
    #[case] mutant: MasterMutant,
    #[case] shows: fn(Option<MasterMutant>) -> Vec<u8>,
    #[case] conformant: Vec<u8>,
    #[case] faulty: Vec<u8>,
) {
    assert_eq!(shows(None), conformant);
    assert_eq!(shows(Some(mutant)), faulty);
}

/// The rows of the start hold for each of them.
#[test]
fn without_faults_a_mutant_starts_like_any_other() {
    for mutant in MasterMutant::ALL {
        Bench::operate_mutant(6, Some(mutant));
    }
}

#[test]
fn the_offset_is_right_in_v1_1() {
    let mut bench = Bench::configured(List::new(V1_1), with(Some(MasterMutant::WrongArgBlockOffset)));
    bench.connect();
    assert_eq!(bench.requests()[0].2.as_deref(), Some(&List::new(V1_1).octets()[14..37]));
}

#[test]
fn every_mutant_has_a_name_a_clause_and_a_sentence() {
    let names: HashSet<_> = MasterMutant::ALL.map(MasterMutant::name).into_iter().collect();
    assert_eq!(names.len(), 12);
    for mutant in MasterMutant::ALL {
        assert_eq!(MasterMutant::from_name(mutant.name()), Some(mutant));
        assert!(!mutant.clause().is_empty() && mutant.about().ends_with('.'));
        let query = [("mutant".to_owned(), mutant.name().to_owned())];
        assert_eq!(MasterOptions::from_query(&query).unwrap().mutant, Some(mutant));
    }
}

#[test]
fn a_record_after_operate_is_answered_there() {
    let mut bench = Bench::configured(List::new(Iec2022), with(Some(MasterMutant::RecordAfterOperate)));
    bench.connect();
    assert_eq!((bench.requests().len(), bench.respond(Response::Written)), (1, vec![]));
}
