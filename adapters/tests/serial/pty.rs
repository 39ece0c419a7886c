//! The other end: DUTs served on a pseudo-terminal.

use crate::apply;
use crate::common::*;
use fsct_adapters::{Address, Dut, DutError, Listener, Stimulus, Stop, connect, serve};
use std::thread::{self, JoinHandle};

struct Served {
    address: Address,
    stop: Stop,
    thread: Option<JoinHandle<std::io::Result<()>>>,
}

fn served() -> Served {
    let listener = Listener::pty().unwrap();
    let (address, stop) = (listener.address().unwrap(), listener.stop().unwrap());
    let thread = thread::spawn(move || serve(&listener, &|| Box::<Mirror>::default()));
    Served { address, stop, thread: Some(thread) }
}

impl Drop for Served {
    fn drop(&mut self) {
        self.stop.stop();
        if let Some(thread) = self.thread.take() {
            thread.join().unwrap().unwrap();
        }
    }
}

fn greeted(address: &Address) -> Box<dyn Dut> {
    let mut dut = connect(address).unwrap();
    assert_eq!(dut.hello(), Ok(description()));
    dut
}

#[test]
fn thousands_of_exchanges_in_one_go() {
    let server = served();
    let mut dut = greeted(&server.address);
    let stimuli: Vec<_> = (0..20_000u32).map(|number| exchange(&number.to_be_bytes())).collect();
    let observed = apply(dut.as_mut(), &stimuli).unwrap();
    assert!(observed == apply(&mut Mirror::default(), &stimuli).unwrap());
}

#[test]
fn a_harness_that_comes_later_has_a_fresh_dut() {
    let server = served();
    let advance = [Stimulus::Advance { ns: 5 }, exchange(&[2])];
    let fresh = apply(&mut Mirror::default(), &advance).unwrap();
    assert!(apply(greeted(&server.address).as_mut(), &advance).unwrap() == fresh);
    // A harness that is quicker than the server can look finds the board of the one before, as behind any line.
    let mut later = (0..100).map(|_| apply(greeted(&server.address).as_mut(), &advance).unwrap());
    assert!(later.any(|observed| observed == fresh));
}

#[test]
fn a_dut_that_panics_is_a_board_that_resets_itself() {
    let server = served();
    let Address::Serial { path, .. } = &server.address else { panic!("it is a line") };
    let hasty: Address = format!("serial:{}?{}", path.display(), crate::HASTY).parse().unwrap();
    let write = [Stimulus::Write { index: 0, subindex: 0, data: b"panic".to_vec() }];
    let error = apply(greeted(&hasty).as_mut(), &write).unwrap_err();
    assert!(matches!(error, DutError::Timeout { .. }), "{error:?}");
    let fresh = apply(&mut Mirror::default(), &[exchange(&[2])]).unwrap();
    assert_eq!(apply(greeted(&server.address).as_mut(), &[exchange(&[2])]), Ok(fresh));
}
