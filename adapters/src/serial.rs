//! A DUT behind a serial line: opening the port, resetting the board, and letting go of the port again.
//!
//! What a line can do to frames, and how they are found again, is the business of [`StreamDut`].

#[cfg(target_os = "linux")]
mod low_latency;
mod options;
#[cfg(unix)]
pub(crate) mod pty;

use crate::StreamDut;
use crate::process;
use crate::stream::Peer;
pub use options::{Flow, Reset, SerialOptions};
use serialport::{ClearBuffer, FlowControl, SerialPort};
use std::io::{self, ErrorKind, Read, Write};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread;
use std::time::{Duration, Instant};

/// How long a serial port may be absent, busy or out of order before it counts as unreachable, unless its address says
/// otherwise: a board that is plugged in again, or comes back from a reset, is there by then.
pub const WAIT: Duration = Duration::from_secs(5);

/// How often an absent port is looked for.
const LOOK: Duration = Duration::from_millis(50);
/// How long a pulse that resets a board lasts.
const PULSE: Duration = Duration::from_millis(100);
/// How long a program that resets a board may take.
const RESET: Duration = Duration::from_secs(30);
/// How soon a reader or writer heeds that the connection has ended.
const HEED: Duration = Duration::from_millis(20);
/// How long ending a connection may take.
const CLOSE: Duration = Duration::from_secs(1);
/// Octets written at once: what any driver takes that says it takes some.
const PIECE: usize = 256;

type Port = Box<dyn SerialPort>;

/// Opens the line and stands ready to talk. An absent port is waited for, however often it was there before.
pub(crate) fn connect(path: &Path, options: &SerialOptions, reply: Duration) -> io::Result<StreamDut> {
    if let Some(Reset::Command { program, args }) = &options.reset {
        // Before the port is opened: switching a board off and on takes its port away.
        process::run(program, args, RESET)
            .map_err(|error| io::Error::new(error.kind(), format!("the reset by {program:?} failed: {error}")))?;
    }
    let port = wait_for(options.wait.unwrap_or(WAIT), || open(path, options))?;
    let stop = Arc::new(AtomicBool::new(false));
    let (open, closed) = channel();
    let half = |port| Half { port, stop: Arc::clone(&stop), _open: open.clone() };
    let (reader, writer) = (half(port.try_clone()?), half(port.try_clone()?));
    let cable = Cable { port: Some(port), stop, closed };
    // One start bit, eight bits, one stop bit.
    let octet = Duration::from_secs(10) / options.baud.max(1);
    Ok(StreamDut::on_line(reader, writer, Box::new(cable), reply, octet))
}

fn wait_for(wait: Duration, mut open: impl FnMut() -> io::Result<Port>) -> io::Result<Port> {
    let begin = Instant::now();
    loop {
        match open() {
            Err(_) if begin.elapsed() < wait => thread::sleep(LOOK.min(wait.saturating_sub(begin.elapsed()))),
            outcome => return outcome.map_err(|error| io::Error::new(error.kind(), format!("{error}, for {wait:?}"))),
        }
    }
}

/// Opens the port for this program alone, resets the board by its lines and forgets what came before.
fn open(path: &Path, options: &SerialOptions) -> io::Result<Port> {
    let flow = match options.flow {
        Flow::None => FlowControl::None,
        Flow::Hardware => FlowControl::Hardware,
    };
    let port = serialport::new(path.to_string_lossy(), options.baud).flow_control(flow).timeout(HEED).open_native()?;
    #[cfg(target_os = "linux")]
    low_latency::ask(&port);
    let mut port: Port = Box::new(port);
    match options.reset {
        Some(Reset::Dtr) => {
            port.write_data_terminal_ready(false)?;
            thread::sleep(PULSE);
            port.write_data_terminal_ready(true)?;
        }
        Some(Reset::Rts) => {
            port.write_request_to_send(true)?;
            thread::sleep(PULSE);
            port.write_request_to_send(false)?;
        }
        Some(Reset::Command { .. }) | None => {}
    }
    port.clear(ClearBuffer::All)?;
    Ok(port)
}

/// One direction of an open port, as long as the connection lasts.
struct Half {
    port: Port,
    stop: Arc<AtomicBool>,
    /// Its end says that this direction holds the port no longer.
    _open: Sender<()>,
}

impl Half {
    fn stopped(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }
}

impl Read for Half {
    fn read(&mut self, octets: &mut [u8]) -> io::Result<usize> {
        while !self.stopped() {
            match self.port.read(octets) {
                Err(error) if error.kind() == ErrorKind::TimedOut => {}
                outcome => return outcome,
            }
        }
        Ok(0)
    }
}

impl Write for Half {
    fn write(&mut self, octets: &[u8]) -> io::Result<usize> {
        let piece = octets.get(..PIECE).unwrap_or(octets);
        while !self.stopped() {
            match self.port.write(piece) {
                Err(error) if error.kind() == ErrorKind::TimedOut => {}
                outcome => return outcome,
            }
        }
        Ok(0)
    }

    /// Nothing is kept here, and nobody waits until the last bit has left.
    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// Holds an open port.
struct Cable {
    /// `None` when the connection has ended.
    port: Option<Port>,
    stop: Arc<AtomicBool>,
    /// Ends when both directions have let go of the port.
    closed: Receiver<()>,
}

impl Peer for Cable {
    /// Returns when nobody holds the port any more: it is opened for one program at a time, and a reader left behind
    /// would take octets from the next connection.
    fn close(&mut self) -> String {
        self.stop.store(true, Ordering::Relaxed);
        if let Some(port) = self.port.take() {
            // What nobody will read, and what a board that has stopped the line will not take.
            let _ = port.clear(ClearBuffer::All);
            let _ = self.closed.recv_timeout(CLOSE);
        }
        String::new()
    }
}
