//! Delta debugging: the shortest list of actions that still fails in the same way.

use super::action::{Action, Script};

/// Lists tried at the most.
pub const TRIES: usize = 600;

/// Leaves out of a failing list what is not needed, and makes the rest simpler; `fails` carries a list out on a fresh DUT. The
/// list itself has been seen to fail. Also says how many lists were tried.
pub fn shrink(script: &Script, mut fails: impl FnMut(&Script) -> bool) -> (Script, usize) {
    let mut tries = 0;
    let mut best = script.clone();
    let mut still = |actions: Vec<Action>, best: &mut Script, tries: &mut usize| {
        if *tries >= TRIES {
            return false;
        }
        *tries += 1;
        let candidate = Script { actions, ..best.clone() };
        let fails = fails(&candidate);
        if fails {
            *best = candidate;
        }
        fails
    };
    let mut parts = 2;
    while !best.actions.is_empty() {
        let size = best.actions.len().div_ceil(parts);
        let mut reduced = false;
        let mut from = 0;
        while from < best.actions.len() {
            let upto = (from + size).min(best.actions.len());
            let mut rest = best.actions.clone();
            rest.drain(from..upto);
            if still(rest, &mut best, &mut tries) {
                reduced = true;
            } else {
                from = upto;
            }
        }
        if tries >= TRIES || size == 1 && !reduced {
            break;
        }
        parts = if reduced { 2 } else { (2 * parts).min(best.actions.len()) };
    }
    let mut place = 0;
    while place < best.actions.len() {
        let simpler = best.actions[place].simpler();
        let reduced = simpler.into_iter().any(|action| {
            let mut actions = best.actions.clone();
            actions[place] = action;
            still(actions, &mut best, &mut tries)
        });
        if !reduced {
            place += 1;
        }
    }
    (best, tries)
}

#[cfg(test)]
mod tests {
    use super::*;
    use fsct_adapters::{Role, Variant};
    use fsct_protocol::{Edition, ProtMode};

    fn script(actions: Vec<Action>) -> Script {
        let variant = Variant { edition: Edition::V1_1, mode: ProtMode::Crc16, pd_out: 1, pd_in: 1 };
        Script { role: Role::Device, variant, seed: 1, actions }
    }

    #[test]
    fn what_matters_is_left() {
        let mut actions: Vec<Action> = (0..200).map(|_| Action::Good(9)).collect();
        actions[40] = Action::Corrupt(vec![1, 2, 3]);
        actions[150] = Action::Lose(30);
        let fails = |script: &Script| {
            let corrupts = |action: &Action| matches!(action, Action::Corrupt(bits) if bits.contains(&2));
            let first = script.actions.iter().position(corrupts);
            let last = script.actions.iter().rposition(|action| matches!(action, Action::Lose(n) if *n > 19));
            first.is_some_and(|first| last.is_some_and(|last| first < last))
        };
        let (shrunk, tries) = shrink(&script(actions), fails);
        assert_eq!(shrunk.actions, [Action::Corrupt(vec![2]), Action::Lose(20)]);
        assert!(tries < TRIES);
    }

    #[test]
    fn a_list_that_always_fails_shrinks_to_nothing() {
        assert!(shrink(&script(vec![Action::LoopBack; 50]), |_| true).0.actions.is_empty());
    }

    #[test]
    fn the_number_of_tries_is_bounded() {
        let mut tried = 0;
        let all = script(vec![Action::Good(1000); 2000]);
        shrink(&all, |script| {
            tried += 1;
            script.actions.len() == 2000
        });
        assert!(tried <= TRIES);
    }
}
