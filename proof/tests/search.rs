//! Our search meets as many states, in as many steps and layers, as that of stateright over the same exchanges.

mod stateright;

use crate::stateright::{Explored, explore};
use fsct_proof::{Model, PROPERTIES, Timing, prove, reachable};
use fsct_protocol::Edition;
use rstest::rstest;

#[rstest]
#[case::default(4, Timing::Pipelined)]
#[case::immediate(4, Timing::Immediate)]
#[case::long(6, Timing::Pipelined)]
fn as_stateright(#[case] watchdog: u8, #[case] timing: Timing) {
    let model = Model { watchdog, timing, ..Model::new(Edition::Iec2022) };
    // A property that holds and whose monitor remembers nothing, so that everything is met and nothing twice.
    let stateless = PROPERTIES.iter().find(|property| property.name == "P7-live").expect("a property");
    let ours = prove(&model, stateless).expect("a model that can be explored");
    let found = Explored { states: ours.states, steps: ours.steps, depth: ours.depth };
    assert_eq!(found, explore(&model));
    assert_eq!(reachable(&model), Ok(found.states));
}

#[test]
fn the_default_has_16_389_states() {
    assert_eq!(explore(&Model::new(Edition::Iec2022)).states, 16_389);
}
