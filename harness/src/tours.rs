//! Tours: short ways from power-on that together walk everything a machine can be led through.
//!
//! They are searched over the rows of `protocol`, with what a case can do to a DUT, and written as ordinary cases. The search is
//! deterministic: the same rows give the same cases.

pub mod device;
pub(crate) mod emit;
pub mod master;

pub use emit::{Told, emit};

use crate::walk::{Graph, Trail, Walked};
use fsct_adapters::Role;
use fsct_protocol::scl::Path;
use std::collections::{HashSet, VecDeque};
use std::hash::Hash;

/// A tour goes on to the next goal as long as it does not get longer than this.
const LENGTH: usize = 12;

/// A machine under test with the tester in front of it, in a waiting state.
pub trait Subject: Copy + Eq + Hash {
    /// What the tester can do.
    type Stimulus: Copy + PartialEq + 'static;

    /// The side the machine is on.
    const ROLE: Role;
    /// Everything the tester can do.
    const ALPHABET: &'static [Self::Stimulus];

    /// Where the cases begin, waiting for the first SPDU, and what was taken to get there.
    fn waiting() -> (Self, Path);

    /// Does it: the transitions this leads to, none when it is left alone, and whether the SPDU was in error.
    fn apply(&mut self, stimulus: Self::Stimulus) -> (Path, bool);
}

/// A machine on its way.
#[derive(Copy, Clone, PartialEq, Eq, Hash)]
struct Place<S> {
    subject: S,
    trail: Trail,
}

impl<S: Subject> Place<S> {
    fn begin() -> Place<S> {
        let (subject, path) = S::waiting();
        let mut trail = Trail::default();
        trail.went(Graph::role(S::ROLE), path, false);
        Place { subject, trail }
    }

    /// Where a stimulus leads, and what was walked on the way.
    fn after(&self, stimulus: S::Stimulus) -> (Place<S>, Walked) {
        let mut next = Place { subject: self.subject, trail: self.trail.afresh() };
        let (path, error) = next.subject.apply(stimulus);
        if !path.is_empty() {
            next.trail.went(Graph::role(S::ROLE), path, error);
        }
        let walked = next.trail.walked;
        next.trail = next.trail.afresh();
        (next, walked)
    }
}

/// Everything that can be walked: a search through every state the machine can get to.
pub fn feasible<S: Subject>() -> Walked {
    let first = Place::<S>::begin();
    let mut walked = first.trail.walked;
    let first = Place { trail: first.trail.afresh(), ..first };
    let mut known = HashSet::from([first]);
    let mut open = vec![first];
    while let Some(place) = open.pop() {
        for stimulus in S::ALPHABET {
            let (next, more) = place.after(*stimulus);
            walked = walked.union(more);
            if known.insert(next) {
                open.push(next);
            }
        }
    }
    walked
}

/// What can be walked by the machine of a role.
pub fn feasible_for(role: Role) -> Walked {
    match role {
        Role::Device => feasible::<device::Bench>(),
        Role::Master => feasible::<master::Bench>(),
    }
}

/// Tours that together walk everything that can be walked.
fn tours<S: Subject>() -> Vec<Vec<S::Stimulus>> {
    let goals = feasible::<S>();
    let mut walked = Place::<S>::begin().trail.walked;
    let mut uses = vec![0usize; S::ALPHABET.len()];
    let mut tours = Vec::new();
    while !goals.without(walked).is_empty() {
        let mut place = Place::<S>::begin();
        let mut tour = Vec::new();
        while let Some(way) = nearest(&place, goals.without(walked), &uses) {
            if !tour.is_empty() && tour.len() + way.len() > LENGTH {
                break;
            }
            for index in way {
                let (next, more) = place.after(S::ALPHABET[index]);
                (place, walked) = (next, walked.union(more));
                uses[index] += 1;
                tour.push(S::ALPHABET[index]);
            }
        }
        if tour.is_empty() {
            break;
        }
        tours.push(tour);
    }
    tours
}

/// The shortest way to something not walked yet, by places in the alphabet; of equal ones that of stimuli used least.
fn nearest<S: Subject>(from: &Place<S>, wanted: Walked, uses: &[usize]) -> Option<Vec<usize>> {
    let mut order: Vec<usize> = (0..uses.len()).collect();
    order.sort_by_key(|index| uses[*index]);
    let from = Place { trail: from.trail.afresh(), ..*from };
    let mut known = HashSet::from([from]);
    let mut open = VecDeque::from([(from, Vec::new())]);
    while let Some((place, way)) = open.pop_front() {
        for index in &order {
            let (next, more) = place.after(S::ALPHABET[*index]);
            if more.without(wanted) != more {
                return Some([way.as_slice(), &[*index]].concat());
            }
            if known.insert(next) {
                open.push_back((next, [way.as_slice(), &[*index]].concat()));
            }
        }
    }
    None
}
