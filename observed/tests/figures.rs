//! How many states can be told apart from outside.

use fsct_observed::{Subject, device, master, observed};
use fsct_protocol::scl::device::Readings;

#[test]
fn the_fs_device_has_fourteen_states_and_ten_inputs() {
    assert_eq!(device::Bench::INPUTS.len(), 10);
    assert_eq!(observed(device::Bench::waiting(Readings::default())).states.len(), 14);
}

#[test]
fn read_sequentially_one_less() {
    let readings = Readings { sequential: true, ..Readings::default() };
    assert_eq!(observed(device::Bench::waiting(readings)).states.len(), 13);
}

#[test]
fn the_fs_master_has_four_states_and_fifteen_inputs() {
    assert_eq!(master::Bench::INPUTS.len(), 15);
    assert_eq!(observed(master::Bench::waiting()).states.len(), 4);
}
