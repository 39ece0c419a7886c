//! A DUT behind a pseudo-terminal: a serial line without hardware.

use crate::Dut;
use crate::listener::Shared;
use crate::serve::serve_stream;
use crate::stream::LINE_SILENCE;
use serialport::{SerialPort, TTYPort};
use std::io::{self, ErrorKind, Read, Write};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::thread;
use std::time::Duration;

/// How often it is looked whether somebody has opened the terminal.
const LOOK: Duration = Duration::from_millis(5);

/// A pseudo-terminal whose other end anybody may open.
#[derive(Debug)]
pub(crate) struct Pty {
    port: TTYPort,
    path: PathBuf,
}

impl Pty {
    pub(crate) fn open() -> io::Result<Pty> {
        let (mut port, other) = TTYPort::pair()?;
        port.set_timeout(LINE_SILENCE)?;
        let path = other.name().ok_or_else(|| io::Error::other("the terminal has no name"))?;
        // The other end is let go: reading here fails from now on until somebody opens it, and again when the last one
        // has closed it. That is how a harness is told from the next.
        Ok(Pty { port, path: path.into() })
    }

    pub(crate) fn path(&self) -> &Path {
        &self.path
    }

    /// Serves a fresh DUT to each harness that opens the terminal after the one before has closed it.
    pub(crate) fn serve(&self, shared: &Shared, make: &dyn Fn() -> Box<dyn Dut>) -> io::Result<()> {
        let stopped = || shared.lock().stopped;
        while !stopped() {
            let half = || Ok::<_, io::Error>(Half { port: self.port.try_clone_native()?, stopped: &stopped });
            let (reader, writer) = (half()?, half()?);
            // A DUT that panics is a board that resets itself: nothing is answered and a fresh one is there.
            let outcome = catch_unwind(AssertUnwindSafe(|| serve_stream(reader, writer, make())));
            if !matches!(outcome, Ok(Ok(()))) {
                thread::sleep(LOOK);
            }
        }
        Ok(())
    }
}

/// One direction of the terminal.
struct Half<'s> {
    port: TTYPort,
    stopped: &'s dyn Fn() -> bool,
}

impl Read for Half<'_> {
    /// That nothing came within [`LINE_SILENCE`] is an error of the kind `TimedOut`.
    fn read(&mut self, octets: &mut [u8]) -> io::Result<usize> {
        if (self.stopped)() { Ok(0) } else { self.port.read(octets) }
    }
}

impl Write for Half<'_> {
    fn write(&mut self, octets: &[u8]) -> io::Result<usize> {
        while !(self.stopped)() {
            match self.port.write(octets) {
                Err(error) if error.kind() == ErrorKind::TimedOut => {}
                outcome => return outcome,
            }
        }
        Ok(0)
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}
