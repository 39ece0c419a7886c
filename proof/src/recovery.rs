//! P5: whatever has happened, a healthy link and a willing operator bring back operation.
//!
//! Every reachable state is looked at with [`Around::Willing`]: the state counts as recovering once all that may then follow
//! recovers. What is left in the end never needs to.

use crate::exchange::{Around, Joint, Step, World};
use crate::learned::{Device, Master};
use crate::search::{End, Found, Table, explore, steps_to};
use fsct_protocol::scl::{State, Var};

/// What was found about recovery.
pub struct Recovery {
    /// The search for the states; `worst` is the most exchanges to operation.
    pub found: Found,
    /// With a lock-up: how many steps of the way are undisturbed and repeat for ever, at its end.
    pub for_ever: Option<usize>,
}

/// Looks for the slowest recovery, and for lock-ups.
pub fn recovery(world: &mut World) -> Recovery {
    let (mut found, states) = explore(world, None);
    if let End::TooMany = found.end {
        return Recovery { found, for_ever: None };
    }
    let (mut joints, mut reached, mut numbers) = (Vec::new(), Vec::new(), Table::default());
    for state in 0..states.len() {
        numbers.entry(states.joint(state)).or_insert_with_key(|joint| {
            joints.push(*joint);
            reached.push(state);
            joints.len() - 1
        });
    }
    // Nothing undisturbed leads out of what is reachable, so every step has a number.
    let next: Vec<Vec<usize>> = joints
        .iter()
        .map(|joint| {
            world.steps(*joint, Around::Willing).iter().filter_map(|step| numbers.get(&step.to).copied()).collect()
        })
        .collect();
    let mut needed: Vec<Option<u8>> = joints
        .iter()
        .map(|joint| operates(&world.master(joint.master), &world.device(joint.device)).then_some(0))
        .collect();
    let mut open: Vec<usize> = (0..joints.len()).filter(|number| needed[*number].is_none()).collect();
    loop {
        let settled: Vec<(usize, u8)> = open
            .iter()
            .filter_map(|number| {
                let most = next[*number].iter().map(|to| needed[*to]).collect::<Option<Vec<_>>>()?.into_iter().max()?;
                Some((*number, most.saturating_add(1)))
            })
            .collect();
        if settled.is_empty() {
            break;
        }
        for (number, exchanges) in settled {
            needed[number] = Some(exchanges);
            found.worst = found.worst.max(exchanges);
        }
        open.retain(|number| needed[*number].is_none());
    }
    let Some(locked) = open.first().copied() else {
        return Recovery { found, for_ever: None };
    };
    let mut way = steps_to(world, &states, reached[locked]);
    let (tail, repeats) = tail(world, &joints, &numbers, &needed, locked);
    way.extend(tail);
    found.end = End::Beyond(way);
    Recovery { found, for_ever: Some(repeats) }
}

/// Undisturbed steps from a locked state until they repeat, and how many of them do.
fn tail(
    world: &mut World,
    joints: &[Joint],
    numbers: &Table<Joint, usize>,
    needed: &[Option<u8>],
    locked: usize,
) -> (Vec<Step>, usize) {
    let mut met = vec![locked];
    let mut steps: Vec<Step> = Vec::new();
    let mut at = locked;
    loop {
        let stuck = |step: &Step| numbers.get(&step.to).is_some_and(|number| needed[*number].is_none());
        let Some(step) = world.steps(joints[at], Around::Willing).into_iter().find(stuck) else { break };
        at = numbers.get(&step.to).copied().unwrap_or(locked);
        steps.push(step);
        if let Some(back) = met.iter().position(|number| *number == at) {
            return (steps, met.len() - back);
        }
        met.push(at);
    }
    (steps, 0)
}

/// Operation: both machines in their regular loops, process data in use both ways.
pub(crate) fn operates(master: &Master, device: &Device) -> bool {
    master.state() == State(5)
        && master.get(Var::In) == 1
        && master.get(Var::SetSd) == 0
        && device.state() == State(24)
        && device.uses_pdout()
        && !device.status().sd_set
}
