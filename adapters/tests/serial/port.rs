//! Ports that are absent, busy, pulled and plugged in again, and resets.

use crate::board::*;
use crate::common::*;
use crate::{HASTY, LENIENT, apply, power};
use fsct_adapters::message::OBSERVED;
use fsct_adapters::{Dut, DutError, Fault, connect};
use serialport::{SerialPort, TTYPort};
use std::io::Write;
use std::os::unix::fs::symlink;
use std::path::PathBuf;
use std::thread;
use std::time::Duration;

/// A path of its own for a test, as udev gives a board one: it may lead to a port, or not.
struct Link(PathBuf);

impl Link {
    fn new(name: &str) -> Link {
        let path = std::env::temp_dir().join(format!("fsct-serial-{name}-{}", std::process::id()));
        let _ = std::fs::remove_file(&path);
        Link(path)
    }

    fn path(&self) -> &str {
        self.0.to_str().unwrap()
    }

    fn plug(&self) -> TTYPort {
        let (port, path) = line();
        symlink(path, &self.0).unwrap();
        port
    }

    fn unplug(&self) {
        std::fs::remove_file(&self.0).unwrap();
    }
}

impl Drop for Link {
    fn drop(&mut self) {
        let _ = std::fs::remove_file(&self.0);
    }
}

fn unreachable(path: &str, options: &str) -> String {
    let Err(error) = connect(&address(path, options)) else { panic!("{path} is there") };
    assert_eq!(error.fault(), Fault::Rig);
    error.to_string()
}

#[test]
fn an_absent_port_is_waited_for_and_no_longer() {
    let error = unreachable("no-such-port", "wait=1ms");
    let expected = "serial:no-such-port?wait=1ms cannot be reached: No such file or directory, for 1ms; is the DUT \
                    running and the address right?";
    assert_eq!(error, expected);
    let link = Link::new("absent");
    let (port, path) = line();
    let board = board(port, |board| {
        let hello = board.next();
        board.describe(&hello);
    });
    // The reset returns at once and takes effect later.
    let options = format!("{LENIENT}&wait=60s&reset-command=sh -c '(sleep 0.2; ln -s {path} {}) &'", link.path());
    assert_eq!(connect(&address(link.path(), &options)).unwrap().hello(), Ok(description()));
    board.join().unwrap();
}

#[test]
fn what_is_no_port_is_not_reachable() {
    let error = unreachable("Cargo.toml", "wait=1ms");
    assert!(error.contains("cannot be reached: "), "{error}");
}

#[test]
fn a_port_in_use_is_refused_and_free_as_soon_as_the_connection_ends() {
    let (port, path) = line();
    let first = connect(&address(&path, "wait=1ms")).unwrap();
    let error = unreachable(&path, "wait=1ms");
    assert!(error.contains("exclusive lock"), "{error}");
    drop(first);
    drop(connect(&address(&path, "wait=1ms")).unwrap());
    drop(port);
}

/// The reading thread has more to hand over than anybody will take when the connection ends.
#[test]
fn a_port_is_free_again_when_a_babbling_board_has_been_given_up() {
    let (port, path) = line();
    let board = board(port, |board| {
        let hello = board.next();
        board.describe(&hello);
        board.send(OBSERVED, hello.sequence, &[0]);
        // Until nothing on the way to the harness takes any more.
        board.port.set_timeout(Duration::from_millis(100)).unwrap();
        while board.port.write(&[b'y'; 1000]).is_ok() {}
    });
    let mut first = connect(&address(&path, LENIENT)).unwrap();
    first.hello().unwrap();
    let port = board.join().unwrap();
    let error = apply(first.as_mut(), &power()).unwrap_err();
    assert!(matches!(error, DutError::Contract { .. }), "{error:?}");
    // The first is still there, and of no further use.
    drop(connect(&address(&path, "wait=1ms")).unwrap());
    assert_eq!(apply(first.as_mut(), &power()), Err(error));
    drop(port);
}

#[test]
fn a_line_that_is_pulled_fails_and_is_waited_for() {
    let link = Link::new("pulled");
    let pulled = board(link.plug(), |board| {
        let hello = board.next();
        board.describe(&hello);
        board.next();
    });
    let mut dut = connect(&address(link.path(), LENIENT)).unwrap();
    dut.hello().unwrap();
    let waiting = thread::spawn(move || {
        // In the middle of a case.
        drop(pulled.join().unwrap());
    });
    let error = apply(dut.as_mut(), &power()).unwrap_err();
    assert_eq!(error, DutError::Line { what: "the port is gone".to_owned() });
    assert_eq!(error.fault(), Fault::Rig);
    waiting.join().unwrap();
    link.unplug();
    let again = address(link.path(), "wait=60s&timeout=20s");
    let connecting = thread::spawn(move || {
        let mut dut = connect(&again).unwrap();
        dut.hello().unwrap();
        apply(dut.as_mut(), &power())
    });
    let board = board(link.plug(), |board| {
        let hello = board.next();
        board.describe(&hello);
        let request = board.next();
        board.nothing(&request);
    });
    assert_eq!(connecting.join().unwrap(), Ok(vec![]));
    board.join().unwrap();
}

#[test]
fn a_program_may_reset_the_board_before_the_port_is_opened() {
    let link = Link::new("reset");
    let (port, path) = line();
    let board = board(port, |board| {
        let hello = board.next();
        board.describe(&hello);
    });
    let options = format!("{LENIENT}&reset-command=ln -s {path} {}", link.path());
    assert_eq!(connect(&address(link.path(), &options)).unwrap().hello(), Ok(description()));
    board.join().unwrap();
    let error = unreachable(link.path(), "reset-command=sh -c 'echo no probe >&2; exit 3'");
    let expected = r#"the reset by "sh" failed: (exit status: 3, its last words "no probe")"#;
    assert!(error.contains(expected), "{error}");
    let error = unreachable(link.path(), "reset-command=no-such-program");
    assert!(error.contains(r#"the reset by "no-such-program" failed: "#), "{error}");
}

/// A pseudo-terminal has no such lines, and says so.
#[test]
fn a_reset_that_is_not_possible_is_told() {
    let (port, path) = line();
    for options in ["reset=dtr&wait=1ms", "reset=rts&wait=1ms"] {
        let error = unreachable(&path, &format!("{options}&{HASTY}"));
        assert!(error.contains("cannot be reached: "), "{error}");
    }
    assert!(port.name().is_none());
}
