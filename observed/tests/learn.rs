//! Machines are learnt exactly, within bounds, and one that varies is found out.

use fsct_observed::learn::{Bound, Bounds, Failure, Teacher, learn};
use fsct_observed::{Edge, Mealy, Subject, device, master, observed};
use fsct_protocol::scl::device::Readings;
use proptest::prelude::*;
use std::convert::Infallible;
use std::hash::Hash;

const BOUNDS: Bounds = Bounds { extra: 1, most_states: 100, most_inputs: 1_000_000 };

/// A machine that answers by its table.
struct Table<O>(Mealy<O>);

impl<O: Copy + Eq + Hash> Teacher for Table<O> {
    type Output = O;
    type Error = Infallible;

    fn ask(&mut self, word: &[usize]) -> Result<Vec<O>, Infallible> {
        Ok(self.0.run(0, word).0)
    }
}

fn taught<O: Copy + Eq + Hash + std::fmt::Debug>(machine: &Mealy<O>, bounds: Bounds) -> Mealy<O> {
    let learned = learn(&mut Table(machine.clone()), machine.inputs(), bounds, None).expect("it answers alike");
    assert_eq!(learned.bound, None);
    learned.machine.expect("no bound was hit")
}

fn machine(states: usize, inputs: usize) -> impl Strategy<Value = Mealy<u8>> {
    let edge = (0..2u8, 0..states).prop_map(|(output, next)| Edge { output, next });
    prop::collection::vec(prop::collection::vec(edge, inputs), states).prop_map(|states| Mealy { states }.minimal())
}

proptest! {
    /// With as many extra states as it could hide, a machine is found exactly.
    #[test]
    fn any_machine_is_learnt_exactly(machine in (1..6usize, 1..4usize).prop_flat_map(|(states, inputs)| machine(states, inputs))) {
        let bounds = Bounds { extra: machine.states.len() - 1, ..BOUNDS };
        prop_assert_eq!(taught(&machine, bounds), machine);
    }
}

#[test]
fn the_machines_of_the_tables_are_learnt() {
    let device = observed(device::Bench::waiting(Readings::default()));
    assert_eq!(taught(&device, BOUNDS), device);
    let master = observed(master::Bench::waiting());
    assert_eq!(taught(&master, Bounds { extra: 0, ..BOUNDS }), master);
}

/// Shows itself at the twentieth input alone.
fn ring() -> Mealy<bool> {
    let states = (0..20).map(|at| vec![Edge { output: at == 19, next: (at + 1) % 20 }]).collect();
    Mealy { states }
}

#[test]
fn a_state_too_many_ends_it() {
    let bounds = Bounds { extra: 20, most_states: 10, ..BOUNDS };
    let learned = learn(&mut Table(ring()), 1, bounds, None).expect("it answers alike");
    assert_eq!(learned.bound, Some(Bound::States));
    assert_eq!(learned.machine.map(|machine| machine.states.len()), Some(1));
    assert_eq!(taught(&ring(), Bounds { extra: 20, ..BOUNDS }), ring());
}

#[test]
fn an_input_too_many_ends_it() {
    let device = observed(device::Bench::waiting(Readings::default()));
    let bounds = Bounds { most_inputs: 500, ..BOUNDS };
    let learned = learn(&mut Table(device.clone()), device.inputs(), bounds, None).expect("it answers alike");
    assert_eq!((learned.bound, learned.machine), (Some(Bound::Inputs), None));
    assert!(learned.asked.inputs <= 500);
}

#[test]
fn what_too_few_extra_states_hide_is_not_found() {
    assert_eq!(taught(&ring(), Bounds { extra: 3, ..BOUNDS }).states.len(), 1);
}

/// Forgets what it showed, once.
struct Varying(u32);

impl Teacher for Varying {
    type Output = bool;
    type Error = Infallible;

    fn ask(&mut self, word: &[usize]) -> Result<Vec<bool>, Infallible> {
        self.0 += 1;
        Ok(word.iter().map(|_| self.0 == 5).collect())
    }
}

#[test]
fn a_machine_that_varies_contradicts_itself() {
    match learn(&mut Varying(0), 3, BOUNDS, None) {
        Err(Failure::Contradiction { before, after, .. }) => assert_ne!(before, after),
        other => panic!("{other:?}"),
    }
}

struct Silent;

impl Teacher for Silent {
    type Output = bool;
    type Error = &'static str;

    fn ask(&mut self, _: &[usize]) -> Result<Vec<bool>, &'static str> {
        Err("lost")
    }
}

#[test]
fn a_teacher_that_is_lost_ends_it() {
    assert_eq!(learn(&mut Silent, 2, BOUNDS, None), Err(Failure::Teacher("lost")));
}

#[test]
fn what_is_expected_is_looked_for_where_too_few_extra_states_hide_it() {
    let bounds = Bounds { extra: 0, ..BOUNDS };
    let learned = learn(&mut Table(ring()), 1, bounds, Some(&ring())).expect("it answers alike");
    assert_eq!(learned.machine, Some(ring()));
    // Where it is not what is expected, it is what it is.
    let device = observed(device::Bench::waiting(Readings::default()));
    let sequential = observed(device::Bench::waiting(Readings { sequential: true, ..Readings::default() }));
    let learned = learn(&mut Table(sequential.clone()), 10, bounds, Some(&device)).expect("it answers alike");
    assert_eq!(learned.machine, Some(sequential));
}

#[test]
fn words_are_few() {
    let device = observed(device::Bench::waiting(Readings::default()));
    let learned =
        learn(&mut Table(device.clone()), device::Bench::INPUTS.len(), BOUNDS, None).expect("it answers alike");
    assert!(learned.asked.words < 10_000, "{:?}", learned.asked);
}
