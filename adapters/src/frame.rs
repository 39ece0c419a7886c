//! Frames: how messages are told apart on a stream of octets, and how a reader finds back after garbage.
//!
//! | octets | 2 | 1 | 1 | 2 | 0..65 535 | 4 |
//! |---|---|---|---|---|---|---|
//! | field | sync `F5 C7` | type | sequence | length of the payload | payload | CRC-32 of type to payload |
//!
//! Numbers are big endian. The CRC is CRC-32/ISO-HDLC, the one of Ethernet and zip. What a payload means is the
//! business of [`crate::message`].

use crc::{CRC_32_ISO_HDLC, Crc};
use std::fmt;

/// The two octets every frame begins with.
pub const SYNC: [u8; 2] = [0xF5, 0xC7];
/// The most octets a payload can have.
pub const MAX_PAYLOAD: usize = 0xFFFF;
/// Octets of a frame around its payload.
pub const OVERHEAD: usize = HEADER + 4;
/// A stream that shows more than this many octets of garbage between two frames carries no frames.
pub const MAX_GARBAGE: usize = 1 << 16;

const HEADER: usize = 6;
/// Octets of garbage kept to be shown.
const SAMPLE: usize = 16;

static CRC: Crc<u32> = Crc::<u32>::new(&CRC_32_ISO_HDLC);

/// One frame.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Frame {
    /// Type of the message.
    pub kind: u8,
    /// Sequence number; an answer carries that of its request.
    pub sequence: u8,
    /// The message itself.
    pub payload: Vec<u8>,
}

/// The octets of a frame; `None` when the payload has more than [`MAX_PAYLOAD`] octets.
pub fn encode(kind: u8, sequence: u8, payload: &[u8]) -> Option<Vec<u8>> {
    let [high, low] = u16::try_from(payload.len()).ok()?.to_be_bytes();
    let mut octets = Vec::with_capacity(payload.len() + OVERHEAD);
    octets.extend(SYNC);
    octets.extend([kind, sequence, high, low]);
    octets.extend(payload);
    let crc = octets.get(SYNC.len()..).map(checksum)?;
    octets.extend(crc.to_be_bytes());
    Some(octets)
}

/// CRC-32/ISO-HDLC; over `123456789` it is `CBF43926`.
pub fn checksum(octets: &[u8]) -> u32 {
    CRC.checksum(octets)
}

/// Finds the frames in a stream of octets, however it is cut into pieces.
#[derive(Debug, Default)]
pub struct Decoder {
    buffer: Vec<u8>,
    /// Octets of `buffer` already done with.
    done: usize,
    garbage: Garbage,
}

/// What stood between the latest frame and here and was none.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Garbage {
    /// Octets skipped in search of a frame.
    pub skipped: usize,
    /// Octets of frames whose CRC was wrong; they are searched for frames again.
    pub rejected: usize,
    /// The CRC computed and the CRC found in the latest of those.
    pub crc: Option<(u32, u32)>,
    /// The first octets skipped.
    pub sample: Vec<u8>,
}

impl Garbage {
    /// Whether there was none.
    pub fn is_empty(&self) -> bool {
        self.skipped == 0
    }

    /// Whether there was more than [`MAX_GARBAGE`]. Rejected frames count with their length, so that whoever sends
    /// headers over headers does not buy one checksum an octet.
    pub fn is_too_much(&self) -> bool {
        self.skipped.saturating_add(self.rejected) > MAX_GARBAGE
    }
}

impl fmt::Display for Garbage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} octets that are no frame, beginning \"{}\"", self.skipped, self.sample.escape_ascii())?;
        match self.crc {
            Some((right, found)) => write!(f, "; a frame had the CRC {found:08X} where {right:08X} is right"),
            None => Ok(()),
        }
    }
}

enum Found {
    /// A frame with a payload of this many octets begins here.
    Frame(usize),
    /// So many octets begin no frame.
    Skip(usize),
    /// A whole frame with a wrong CRC.
    Reject { octets: usize, right: u32, found: u32 },
    /// What is there may become a frame.
    Wait,
}

impl Decoder {
    /// A decoder that has seen nothing.
    pub fn new() -> Decoder {
        Decoder::default()
    }

    /// Takes the next octets of the stream. All frames are to be fetched before the next call, so that no more than
    /// one unfinished frame is ever kept.
    pub fn push(&mut self, octets: &[u8]) {
        self.buffer.drain(..self.done.min(self.buffer.len()));
        self.done = 0;
        self.buffer.extend_from_slice(octets);
    }

    /// The next frame; `None` when more octets are needed or there was too much garbage.
    pub fn next_frame(&mut self) -> Option<Frame> {
        while !self.garbage.is_too_much() {
            match look(self.buffer.get(self.done..)?) {
                Found::Wait => return None,
                Found::Skip(count) => self.skip(count),
                Found::Reject { octets, right, found } => {
                    self.garbage.rejected = self.garbage.rejected.saturating_add(octets);
                    self.garbage.crc = Some((right, found));
                    self.skip(1);
                }
                Found::Frame(length) => {
                    let frame = self.buffer.get(self.done..)?;
                    let frame = Frame {
                        kind: *frame.get(2)?,
                        sequence: *frame.get(3)?,
                        payload: frame.get(HEADER..HEADER + length)?.to_vec(),
                    };
                    self.done += length + OVERHEAD;
                    self.garbage = Garbage::default();
                    return Some(frame);
                }
            }
        }
        None
    }

    /// As [`Decoder::next_frame`], when nothing came for so long that an unfinished frame will not be finished: what
    /// only looked like the beginning of one is skipped, and the octets behind it are searched.
    pub fn next_frame_after_silence(&mut self) -> Option<Frame> {
        loop {
            let frame = self.next_frame();
            if frame.is_some() || self.done >= self.buffer.len() || self.garbage.is_too_much() {
                return frame;
            }
            self.skip(1);
        }
    }

    /// Octets remembered: when all frames have been fetched, fewer than the latest piece and one frame have.
    pub fn held(&self) -> usize {
        self.buffer.len()
    }

    /// What has been skipped since the latest frame.
    pub fn garbage(&self) -> &Garbage {
        &self.garbage
    }

    fn skip(&mut self, count: usize) {
        let skipped = self.buffer.iter().skip(self.done).take(count);
        let room = SAMPLE.saturating_sub(self.garbage.sample.len());
        self.garbage.sample.extend(skipped.take(room));
        self.garbage.skipped = self.garbage.skipped.saturating_add(count);
        self.done += count;
    }
}

/// What stands at the beginning of these octets.
fn look(octets: &[u8]) -> Found {
    let [first, second] = SYNC;
    match octets {
        [] => return Found::Wait,
        [a] if *a == first => return Found::Wait,
        [a, b, ..] if [*a, *b] == SYNC => {}
        [_, rest @ ..] => {
            let next = rest.iter().zip(rest.iter().skip(1).chain([&second]));
            let distance = next.take_while(|pair| (*pair.0, *pair.1) != (first, second)).count();
            return Found::Skip(1 + distance);
        }
    }
    let Some(([_, _, _, _, high, low], rest)) = octets.split_first_chunk::<HEADER>() else { return Found::Wait };
    let length = usize::from(u16::from_be_bytes([*high, *low]));
    let Some((payload, rest)) = rest.split_at_checked(length) else { return Found::Wait };
    let Some((sent, _)) = rest.split_first_chunk::<4>() else { return Found::Wait };
    let secured = octets.get(SYNC.len()..HEADER + payload.len()).unwrap_or_default();
    let (right, found) = (checksum(secured), u32::from_be_bytes(*sent));
    if right == found { Found::Frame(length) } else { Found::Reject { octets: length + OVERHEAD, right, found } }
}
