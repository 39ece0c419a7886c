//! A board on the other end of a pseudo-terminal, and what a bad line does to octets.

use crate::common::*;
use fsct_adapters::frame::{Decoder, Frame, encode};
use fsct_adapters::message::*;
use fsct_adapters::{Address, serve_stream};
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::{Rng, SeedableRng};
use serialport::{SerialPort, TTYPort};
use std::io::{self, ErrorKind, Read, Write};
use std::thread::{self, JoinHandle};
use std::time::Duration;

/// The master side of a line, and the address of the other.
pub fn line() -> (TTYPort, String) {
    let (mut master, slave) = TTYPort::pair().unwrap();
    master.set_timeout(PATIENT).unwrap();
    let path = slave.name().unwrap();
    // The other side stays open, so that a board may speak before anybody listens and harnesses may come and go.
    std::mem::forget(slave);
    (master, path)
}

pub fn address(path: &str, options: &str) -> Address {
    format!("serial:{path}?{options}").parse().unwrap()
}

/// A board written by hand.
pub struct Board {
    pub port: TTYPort,
    decoder: Decoder,
}

impl Board {
    pub fn new(port: TTYPort) -> Board {
        Board { port, decoder: Decoder::new() }
    }

    /// The next request.
    pub fn next(&mut self) -> Frame {
        let mut buffer = [0; 4096];
        loop {
            if let Some(frame) = self.decoder.next_frame() {
                return frame;
            }
            let count = self.port.read(&mut buffer).unwrap();
            self.decoder.push(&buffer[..count]);
        }
    }

    pub fn raw(&mut self, octets: &[u8]) {
        self.port.write_all(octets).unwrap();
    }

    pub fn send(&mut self, kind: u8, sequence: u8, payload: &[u8]) {
        self.raw(&encode(kind, sequence, payload).unwrap());
    }

    pub fn describe(&mut self, hello: &Frame) {
        assert_eq!(hello.kind, HELLO);
        self.send(DESCRIPTION, hello.sequence, &pack_description(&description(), Limits::LEAST));
    }

    /// Answers a request that causes nothing.
    pub fn nothing(&mut self, request: &Frame) {
        assert_eq!(request.kind, APPLY);
        self.send(OBSERVED, request.sequence, &[0]);
    }
}

/// Plays a board in a thread of its own, which gives back the line.
pub fn board(port: TTYPort, act: impl FnOnce(&mut Board) + Send + 'static) -> JoinHandle<TTYPort> {
    thread::spawn(move || {
        let mut board = Board::new(port);
        act(&mut board);
        board.port
    })
}

/// What a line does to octets: of 1000 so many are lost, repeated, changed, or held back until the next piece. Before
/// every so manieth piece there is noise, of octets that may look like the beginning of a frame.
#[derive(Copy, Clone, Debug, Default)]
pub struct Ailment {
    pub lost: u64,
    pub repeated: u64,
    pub changed: u64,
    pub held: u64,
    pub noise: u64,
}

/// A line whose schedule of faults is a function of its seed.
struct Ailing<P> {
    port: P,
    ailment: Ailment,
    rng: Pcg64Mcg,
    held: Vec<u8>,
}

impl<P> Ailing<P> {
    fn new(port: P, ailment: Ailment, seed: u64) -> Ailing<P> {
        Ailing { port, ailment, rng: Pcg64Mcg::seed_from_u64(seed), held: Vec::new() }
    }

    fn pass(&mut self, octets: &[u8]) -> Vec<u8> {
        let mut passed = std::mem::take(&mut self.held);
        let mut one_in = |times: u64, of: u64| self.rng.next_u64() % of < times;
        if self.ailment.noise > 0 && one_in(1, self.ailment.noise) {
            passed.extend([0xF5, 0x00, 0xF5, 0xC7, 0x82, 0xFF, 0x01, 0x10]);
        }
        let mut hold = false;
        for octet in octets {
            let (lost, repeated) = (one_in(self.ailment.lost, 1000), one_in(self.ailment.repeated, 1000));
            let octet = if one_in(self.ailment.changed, 1000) { octet ^ 0x10 } else { *octet };
            hold = hold || one_in(self.ailment.held, 1000);
            let onto = if hold { &mut self.held } else { &mut passed };
            onto.extend(std::iter::repeat_n(octet, usize::from(!lost) + usize::from(repeated)));
        }
        passed
    }
}

impl Read for Ailing<TTYPort> {
    fn read(&mut self, octets: &mut [u8]) -> io::Result<usize> {
        let mut buffer = [0; 512];
        loop {
            let count = self.port.read(&mut buffer)?;
            let passed = self.pass(&buffer[..count]);
            if !passed.is_empty() {
                octets[..passed.len()].copy_from_slice(&passed);
                return Ok(passed.len());
            }
        }
    }
}

impl Write for Ailing<TTYPort> {
    fn write(&mut self, octets: &[u8]) -> io::Result<usize> {
        let passed = self.pass(octets);
        self.port.write_all(&passed)?;
        Ok(octets.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// Serves mirrors on an ailing line until its master side hangs up.
pub fn ailing_board(port: TTYPort, ailment: Ailment, seed: u64) {
    thread::spawn(move || {
        let mut reading = port.try_clone_native().unwrap();
        reading.set_timeout(Duration::from_millis(200)).unwrap();
        let reader = Ailing::new(reading, ailment, seed);
        let writer = Ailing::new(port, ailment, !seed);
        let ended = serve_stream(reader, writer, Box::<Mirror>::default());
        assert!(ended.is_ok() || ended.is_err_and(|error| error.kind() != ErrorKind::TimedOut));
    });
}
