//! A DUT at the other end of a stream of octets, whatever carries them.
//!
//! Two threads stand between the stream and its user: one writes requests, one reads pieces of at most 64 KiB into a
//! short queue. So neither a DUT that does not read nor one that does not stop writing can hold up the user, and what a
//! hostile DUT can make this program remember is bounded. A short request while none is unanswered cannot block, for
//! the stream is empty then: it is written at once, without the detour.

mod answers;

use crate::frame::{self, Decoder, Frame};
use crate::message::{self, Described, Hello, Limits, Malformed};
use crate::{Description, Dut, DutError, MAX_BATCH, Observation, Stimulus};
use answers::Answers;
pub use answers::{FLOOD_PER_STIMULUS, FLOOD_SLACK};
use std::collections::VecDeque;
use std::hash::{BuildHasher, Hasher, RandomState};
use std::io::{self, ErrorKind, Read, Write};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, SyncSender, channel, sync_channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

/// How long a DUT may take for each frame it answers, unless the address says otherwise.
pub const REPLY_TIMEOUT: Duration = Duration::from_secs(2);

/// Requests unanswered at any time, however many the DUT would take.
const MAX_REQUESTS: usize = 8;
/// Octets read at once.
const CHUNK: usize = 1 << 16;
/// A request of so many octets is written at once when nothing is unanswered: any stream takes it whole.
const SHORT: usize = 2_048;
/// On a line that can lose octets an unfinished frame is forgotten when nothing came for so long.
pub(crate) const LINE_SILENCE: Duration = Duration::from_millis(200);
/// How often hello is said on such a line before nobody counts as being there.
const HELLOS: usize = 3;
/// Pieces waiting between the reading thread and the user.
const CHUNKS: usize = 4;

/// Holds the other end of a stream.
pub trait Peer: Send {
    /// Ends the connection so that both threads of a [`StreamDut`] find their streams ended, and says how the other end
    /// fared: " (exit status 3)", with a leading space, or nothing. The stream for writing has been let go before.
    fn close(&mut self) -> String;

    /// As [`Peer::close`], when the DUT has failed and whatever it still sends is of no use: one that is busy sending
    /// finds out too.
    fn abort(&mut self) -> String {
        self.close()
    }
}

type Writer = Arc<Mutex<dyn Write + Send>>;

/// A DUT at the other end of a stream.
pub struct StreamDut {
    /// To the writing thread; `None` when the connection is ended.
    requests: Option<Sender<Vec<u8>>>,
    /// The stream for writing, shared with that thread; `None` when the connection is ended.
    writer: Option<Writer>,
    chunks: Receiver<Vec<u8>>,
    peer: Box<dyn Peer>,
    decoder: Decoder,
    timeout: Duration,
    limits: Limits,
    /// Of the next request.
    sequence: u8,
    payload: Vec<u8>,
    scratch: Vec<Observation>,
    failed: Option<DutError>,
    /// What one octet takes on a line that can lose some; `None`: a stream that loses nothing.
    line: Option<Duration>,
    /// What the requests sent since the latest answer take on that line.
    under_way: Duration,
}

/// A request without answer so far: its stimuli are `first..first + count` of the batch.
struct Pending {
    sequence: u8,
    first: usize,
    count: usize,
}

impl StreamDut {
    /// Talks to a DUT over a pair of streams; each frame it answers has to come within `timeout`.
    pub fn new(
        reader: impl Read + Send + 'static,
        writer: impl Write + Send + 'static,
        peer: Box<dyn Peer>,
        timeout: Duration,
    ) -> StreamDut {
        let (requests, to_write) = channel();
        let (to_user, chunks) = sync_channel(CHUNKS);
        let writer: Writer = Arc::new(Mutex::new(writer));
        let shared = writer.clone();
        thread::spawn(move || write_all(&shared, &to_write));
        thread::spawn(move || read_all(reader, &to_user));
        StreamDut {
            requests: Some(requests),
            writer: Some(writer),
            chunks,
            peer,
            decoder: Decoder::new(),
            timeout,
            limits: Limits::LEAST,
            sequence: 0,
            payload: Vec::new(),
            scratch: Vec::new(),
            failed: None,
            line: None,
            under_way: Duration::ZERO,
        }
    }

    /// As [`StreamDut::new`], over a line that can lose, change and repeat octets, and on which each takes this long.
    /// The time the octets themselves take does not count as the DUT's.
    ///
    /// - An unfinished frame is forgotten after 200 ms of silence, and what it swallowed is searched for frames.
    /// - Hello is said three times before the DUT counts as absent; to answer it twice does no harm. Answers to anything
    ///   else, left from a connection before, are skipped until then. They cannot come later, for a DUT answers in order.
    /// - Stimuli are never repeated: what a lost answer leaves unknown is whether they were carried out. So the first
    ///   loss ends the connection.
    pub fn on_line(
        reader: impl Read + Send + 'static,
        writer: impl Write + Send + 'static,
        peer: Box<dyn Peer>,
        timeout: Duration,
        octet: Duration,
    ) -> StreamDut {
        let mut dut = StreamDut::new(reader, writer, peer, timeout);
        dut.line = Some(octet);
        // Another one than in the connection before, most likely, whoever made it.
        dut.sequence = RandomState::new().build_hasher().finish() as u8;
        dut
    }

    /// Does something unless the connection has failed before, and ends the connection when it fails now.
    fn unless_failed<T>(&mut self, act: impl FnOnce(&mut StreamDut) -> Result<T, DutError>) -> Result<T, DutError> {
        if let Some(error) = &self.failed {
            return Err(error.clone());
        }
        act(self).inspect_err(|error| {
            self.failed = Some(error.clone());
            self.let_go();
            self.peer.abort();
        })
    }

    fn hang_up(&mut self) -> String {
        self.let_go();
        self.peer.close()
    }

    /// Lets both threads come to their end: the one that has something to hand over finds nobody to take it.
    fn let_go(&mut self) {
        self.requests = None;
        self.writer = None;
        self.chunks = channel().1;
    }

    /// Sends a request; `alone`: none before it is unanswered.
    fn send(&mut self, kind: u8, payload: &[u8], alone: bool) -> Result<u8, DutError> {
        let sequence = self.sequence;
        self.sequence = sequence.wrapping_add(1);
        let octets =
            frame::encode(kind, sequence, payload).ok_or_else(|| too_long(payload.len(), frame::MAX_PAYLOAD))?;
        self.under_way += self.line.map_or(Duration::ZERO, |octet| octet * octets.len() as u32);
        // A stream that takes no more shows as an end of the other direction, or as silence.
        match (&self.writer, &self.requests) {
            (Some(writer), _) if alone && octets.len() <= SHORT && self.line.is_none() => {
                let _ = write(writer, &octets);
            }
            (_, Some(requests)) => {
                let _ = requests.send(octets);
            }
            _ => {}
        }
        Ok(sequence)
    }

    /// The answer to the request with this sequence number.
    fn answer(&mut self, kind: u8, sequence: u8) -> Result<Vec<u8>, DutError> {
        expect(self.receive()?, kind, sequence)
    }

    /// The answer to this hello.
    fn greeting(&mut self, sequence: u8) -> Result<Vec<u8>, DutError> {
        let begin = Instant::now();
        loop {
            let frame = self.receive()?;
            let stale = match frame.kind {
                message::OBSERVED => true,
                message::DESCRIPTION | message::ERROR => frame.sequence != sequence,
                _ => false,
            };
            if self.line.is_none() || !stale {
                return expect(frame, message::DESCRIPTION, sequence);
            }
            if begin.elapsed() > self.timeout {
                return Err(DutError::Timeout { after: self.timeout });
            }
        }
    }

    fn receive(&mut self) -> Result<Frame, DutError> {
        let begin = Instant::now();
        let mut allowed = self.timeout + std::mem::take(&mut self.under_way);
        loop {
            if let Some(frame) = self.decoder.next_frame() {
                return Ok(frame);
            }
            if self.decoder.garbage().is_too_much() {
                return Err(self.no_frame(self.decoder.garbage().to_string()));
            }
            let left = allowed.saturating_sub(begin.elapsed());
            let wait = self.line.map_or(left, |_| left.min(LINE_SILENCE));
            match self.chunks.recv_timeout(wait) {
                Ok(chunk) => {
                    allowed += self.line.map_or(Duration::ZERO, |octet| octet * chunk.len() as u32);
                    self.decoder.push(&chunk);
                }
                Err(RecvTimeoutError::Timeout) => {
                    if self.line.is_some()
                        && let Some(frame) = self.decoder.next_frame_after_silence()
                    {
                        return Ok(frame);
                    }
                    if wait == left {
                        let after = self.timeout;
                        return Err(self.ended(DutError::Timeout { after }, &format!("then nothing within {after:?}")));
                    }
                }
                Err(RecvTimeoutError::Disconnected) => {
                    let how = self.hang_up();
                    let then = format!("then the end of the connection{how}");
                    let error = match self.line {
                        Some(_) => DutError::Line { what: "the port is gone".to_owned() },
                        None => DutError::Closed { how },
                    };
                    return Err(self.ended(error, &then));
                }
            }
        }
    }

    /// Why no more frames came: what came instead says more than that they did not come.
    fn ended(&self, error: DutError, then: &str) -> DutError {
        let garbage = self.decoder.garbage();
        if garbage.is_empty() { error } else { self.no_frame(format!("{garbage}, {then}")) }
    }

    /// Octets came that are no frame.
    fn no_frame(&self, what: String) -> DutError {
        match self.line {
            Some(_) => DutError::Line { what },
            None => DutError::Garbage { what },
        }
    }

    fn describe(&mut self) -> Result<Description, DutError> {
        let mut repeats = if self.line.is_some() { 1..HELLOS } else { 1..1 };
        let payload = loop {
            let sequence = self.send(message::HELLO, &Hello::OURS.pack(), true)?;
            match self.greeting(sequence) {
                Err(DutError::Timeout { .. } | DutError::Line { .. }) if repeats.next().is_some() => {}
                outcome => break outcome?,
            }
        };
        match message::unpack_description(&payload).map_err(malformed)? {
            Described::Foreign(theirs) => Err(DutError::Version { theirs, ours: message::VERSION }),
            Described::As(description, limits) => {
                answers::check_description(&description)?;
                self.limits = limits;
                Ok(description)
            }
        }
    }

    fn carry_out(&mut self, stimuli: &[Stimulus], observed: &mut Vec<Observation>) -> Result<(), DutError> {
        let most = usize::from(self.limits.requests).min(MAX_REQUESTS);
        let mut pending = VecDeque::with_capacity(most);
        let mut sent = 0;
        loop {
            while pending.len() < most
                && let Some(rest) = stimuli.get(sent..)
                && !rest.is_empty()
            {
                let request = self.request(rest, sent, pending.is_empty())?;
                sent += request.count;
                pending.push_back(request);
            }
            let Some(request) = pending.pop_front() else { return Ok(()) };
            self.collect(&request, stimuli, observed)?;
        }
    }

    fn request(&mut self, rest: &[Stimulus], first: usize, alone: bool) -> Result<Pending, DutError> {
        let mut payload = std::mem::take(&mut self.payload);
        let count = message::pack_apply(rest, self.limits.payload, message::MAX_STIMULI, &mut payload);
        let sequence = self.send(message::APPLY, &payload, alone);
        self.payload = payload;
        match count {
            0 => Err(DutError::Contract {
                what: format!("it takes {} octets at once, a stimulus has more", self.limits.payload),
            }),
            count => Ok(Pending { sequence: sequence?, first, count }),
        }
    }

    fn collect(
        &mut self,
        request: &Pending,
        stimuli: &[Stimulus],
        observed: &mut Vec<Observation>,
    ) -> Result<(), DutError> {
        let asked = stimuli.get(request.first..).and_then(|rest| rest.get(..request.count)).unwrap_or_default();
        let mut answers = Answers::to(asked, request.first);
        loop {
            let payload = self.answer(message::OBSERVED, request.sequence)?;
            self.scratch.clear();
            let more = message::unpack_observed(&payload, &mut self.scratch);
            if self.scratch.is_empty() && more == Ok(true) {
                return Err(DutError::Contract {
                    what: "a frame announces more observations and holds none".to_owned(),
                });
            }
            for mut observation in self.scratch.drain(..) {
                answers.take(&observation)?;
                let position = request.first + usize::from(observation.stimulus);
                observation.stimulus = (position % MAX_BATCH) as u16;
                observed.push(observation);
            }
            if !more.map_err(malformed)? {
                return answers.end();
            }
        }
    }
}

impl Dut for StreamDut {
    fn hello(&mut self) -> Result<Description, DutError> {
        self.unless_failed(StreamDut::describe)
    }

    fn apply(&mut self, stimuli: &[Stimulus], observed: &mut Vec<Observation>) -> Result<(), DutError> {
        self.unless_failed(|dut| dut.carry_out(stimuli, observed))
    }
}

impl Drop for StreamDut {
    fn drop(&mut self) {
        self.hang_up();
    }
}

/// The payload of a frame that has to be this answer.
fn expect(frame: Frame, kind: u8, sequence: u8) -> Result<Vec<u8>, DutError> {
    let contract = |what| Err(DutError::Contract { what });
    match frame.kind {
        message::ERROR => contract(format!("it reported {:?}", message::unpack_error(&frame.payload))),
        message::DESCRIPTION | message::OBSERVED if frame.kind != kind => {
            contract(format!("it answered message {:02X} where {kind:02X} is due", frame.kind))
        }
        message::DESCRIPTION | message::OBSERVED if frame.sequence != sequence => {
            contract(format!("it answered sequence number {} where {sequence} is due", frame.sequence))
        }
        message::DESCRIPTION | message::OBSERVED => Ok(frame.payload),
        message::HELLO | message::APPLY => {
            Err(DutError::Garbage { what: format!("message {:02X}, which only a harness sends", frame.kind) })
        }
        unknown => Err(DutError::Garbage { what: format!("unknown message {unknown:02X}") }),
    }
}

fn malformed(error: Malformed) -> DutError {
    DutError::Garbage { what: error.to_string() }
}

fn too_long(found: usize, limit: usize) -> DutError {
    DutError::Contract { what: format!("a message of {found} octets does not fit into {limit}") }
}

fn write(writer: &Mutex<dyn Write + Send>, octets: &[u8]) -> io::Result<()> {
    let mut writer = writer.lock().unwrap_or_else(PoisonError::into_inner);
    writer.write_all(octets)?;
    writer.flush()
}

fn write_all(writer: &Mutex<dyn Write + Send>, requests: &Receiver<Vec<u8>>) {
    while let Ok(octets) = requests.recv() {
        if write(writer, &octets).is_err() {
            return;
        }
    }
}

fn read_all(mut reader: impl Read, chunks: &SyncSender<Vec<u8>>) {
    let mut buffer = vec![0; CHUNK];
    loop {
        let chunk = match reader.read(&mut buffer) {
            Ok(count) => buffer.get(..count).unwrap_or_default(),
            Err(error) if error.kind() == ErrorKind::Interrupted => continue,
            Err(_) => return,
        };
        if chunk.is_empty() || chunks.send(chunk.to_vec()).is_err() {
            return;
        }
    }
}
