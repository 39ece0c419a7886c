//! Serves any [`Dut`] to harnesses: the other side of [`StreamDut`](crate::StreamDut).

use crate::frame::{self, Decoder, Frame};
use crate::listener::{Listener, Place, Shared};
use crate::message::{self, Hello, Limits, MAX_TEXT};
use crate::socket::Socket;
use crate::{Dut, DutError, Observation};
use std::io::{self, ErrorKind, Read, Write};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::thread;

/// Connections served at the same time; one more is told so and closed.
pub const MAX_CONNECTIONS: usize = 64;

/// What a served DUT takes at once.
const LIMITS: Limits = Limits { payload: frame::MAX_PAYLOAD, requests: 8 };
/// Octets of payload in one answer.
const ANSWER: usize = 1 << 14;
const CHUNK: usize = 1 << 16;

/// Serves a fresh DUT to each connection until [`Stop::stop`](crate::Stop::stop) or, on standard input, until its end.
/// Whatever a harness sends or a DUT does ends at most their own connection.
///
/// # Errors
/// What the system says when no more connections can be accepted.
pub fn serve(listener: &Listener, make: &(dyn Fn() -> Box<dyn Dut> + Sync)) -> io::Result<()> {
    let accept = || match &listener.place {
        Place::Tcp(listener) => listener.accept().map(|(stream, _)| {
            // Answers are small and waited for. A system that cannot do this still works.
            let _ = stream.set_nodelay(true);
            Socket::Tcp(stream)
        }),
        #[cfg(unix)]
        Place::Unix(listener, _) => listener.accept().map(|(stream, _)| Socket::Unix(stream)),
        _ => Err(io::Error::from(ErrorKind::Unsupported)),
    };
    match &listener.place {
        Place::Stdio => return serve_stream(io::stdin().lock(), io::stdout().lock(), make()),
        #[cfg(unix)]
        Place::Pty(pty) => return pty.serve(&listener.shared, make),
        _ => {}
    }
    thread::scope(|scope| {
        loop {
            let mut socket = match accept() {
                Ok(socket) => socket,
                Err(error) if matches!(error.kind(), ErrorKind::Interrupted | ErrorKind::ConnectionAborted) => continue,
                Err(error) => {
                    listener.shared.lock().connections.iter().flatten().for_each(Socket::shutdown);
                    return Err(error);
                }
            };
            let slot = match enter(&listener.shared, &socket) {
                Admission::Stopped => return Ok(()),
                Admission::Full => {
                    let text = format!("{MAX_CONNECTIONS} connections are open, which is the most");
                    let _ = socket.write_all(&answer(message::ERROR, 0, &message::pack_error(&text)));
                    socket.shutdown();
                    continue;
                }
                Admission::Slot(slot) => slot,
            };
            scope.spawn(move || {
                // A DUT that panics has ended its own connection.
                let _ = catch_unwind(AssertUnwindSafe(|| {
                    let reader = socket.try_clone()?;
                    serve_stream(reader, &mut socket, make())
                }));
                leave(&listener.shared, slot);
            });
        }
    })
}

/// Serves one DUT over a pair of streams until the harness ends the connection, or sends so much garbage that it is
/// none. A line that can lose octets says by an error of the kind `TimedOut` that none came for a while: an unfinished
/// frame is forgotten then.
///
/// # Errors
/// What the system says when the streams break.
pub fn serve_stream(mut reader: impl Read, mut writer: impl Write, dut: Box<dyn Dut>) -> io::Result<()> {
    let mut conversation = Conversation { dut, greeted: false, observed: Vec::new(), out: Vec::new() };
    let mut decoder = Decoder::new();
    let mut buffer = vec![0; CHUNK];
    loop {
        let silence = match reader.read(&mut buffer) {
            Ok(0) => return Ok(()),
            Ok(count) => {
                decoder.push(buffer.get(..count).unwrap_or_default());
                false
            }
            Err(error) if error.kind() == ErrorKind::Interrupted => continue,
            Err(error) if error.kind() == ErrorKind::TimedOut => true,
            Err(error) => return Err(error),
        };
        let next = if silence { Decoder::next_frame_after_silence } else { Decoder::next_frame };
        while let Some(frame) = next(&mut decoder) {
            conversation.take(&frame);
            writer.write_all(&conversation.out)?;
            conversation.out.clear();
        }
        writer.flush()?;
        if decoder.garbage().is_too_much() {
            writer.write_all(&answer(message::ERROR, 0, &message::pack_error(&decoder.garbage().to_string())))?;
            return writer.flush();
        }
    }
}

enum Admission {
    Stopped,
    Full,
    Slot(usize),
}

fn enter(shared: &Shared, socket: &Socket) -> Admission {
    let mut open = shared.lock();
    if open.stopped {
        return Admission::Stopped;
    }
    let slot = open.connections.iter().position(Option::is_none).unwrap_or(open.connections.len());
    if slot >= MAX_CONNECTIONS {
        return Admission::Full;
    }
    let clone = match socket.try_clone() {
        Ok(clone) => clone,
        Err(_) => return Admission::Full,
    };
    match open.connections.get_mut(slot) {
        Some(free) => *free = Some(clone),
        None => open.connections.push(Some(clone)),
    }
    Admission::Slot(slot)
}

fn leave(shared: &Shared, slot: usize) {
    if let Some(socket) = shared.lock().connections.get_mut(slot).and_then(Option::take) {
        socket.shutdown();
    }
}

/// One harness and its DUT.
struct Conversation {
    dut: Box<dyn Dut>,
    /// A version has been agreed on.
    greeted: bool,
    observed: Vec<Observation>,
    /// Frames to be sent.
    out: Vec<u8>,
}

impl Conversation {
    fn take(&mut self, frame: &Frame) {
        let outcome = match frame.kind {
            message::HELLO => self.hello(frame),
            message::APPLY if !self.greeted => Err("stimuli came before a hello".to_owned()),
            message::APPLY => self.apply(frame),
            unknown => Err(format!("unknown message {unknown:02X}")),
        };
        if let Err(text) = outcome {
            self.answer(message::ERROR, frame.sequence, &message::pack_error(&text));
        }
    }

    fn answer(&mut self, kind: u8, sequence: u8, payload: &[u8]) {
        self.out.extend(answer(kind, sequence, payload));
    }

    fn hello(&mut self, frame: &Frame) -> Result<(), String> {
        let asked = Hello::unpack(&frame.payload).map_err(|error| error.to_string())?;
        self.greeted = asked.covers(message::VERSION);
        let payload = if self.greeted {
            message::pack_description(&self.dut.hello().map_err(said)?, LIMITS)
        } else {
            vec![message::VERSION]
        };
        if payload.len() > frame::MAX_PAYLOAD {
            return Err("the description is too long".to_owned());
        }
        self.answer(message::DESCRIPTION, frame.sequence, &payload);
        Ok(())
    }

    fn apply(&mut self, frame: &Frame) -> Result<(), String> {
        let stimuli = message::unpack_apply(&frame.payload).map_err(|error| error.to_string())?;
        let mut observed = std::mem::take(&mut self.observed);
        observed.clear();
        let outcome = self.dut.apply(&stimuli, &mut observed).map_err(said);
        let answered = outcome.and_then(|()| self.observed(frame.sequence, &observed));
        self.observed = observed;
        answered
    }

    fn observed(&mut self, sequence: u8, observed: &[Observation]) -> Result<(), String> {
        let mut payload = Vec::new();
        let mut rest = observed;
        loop {
            let packed = message::pack_observed(rest, ANSWER, &mut payload);
            if packed == 0 && !rest.is_empty() {
                return Err(format!("an observation has more than {ANSWER} octets"));
            }
            self.answer(message::OBSERVED, sequence, &payload);
            rest = rest.get(packed..).unwrap_or_default();
            if rest.is_empty() {
                return Ok(());
            }
        }
    }
}

/// An error in the words of the DUT: whoever reads them adds again that it broke the contract.
fn said(error: DutError) -> String {
    match error {
        DutError::Contract { what } => what,
        error => error.to_string(),
    }
}

/// The octets of an answer. Payloads are kept short enough; were one not, there would be no answer.
fn answer(kind: u8, sequence: u8, payload: &[u8]) -> Vec<u8> {
    debug_assert!(payload.len() <= frame::MAX_PAYLOAD && (kind != message::ERROR || payload.len() <= MAX_TEXT));
    frame::encode(kind, sequence, payload).unwrap_or_default()
}
