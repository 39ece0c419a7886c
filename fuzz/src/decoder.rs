//! The frame decoder against a second one that is slow and obvious, however the stream is cut.

use super::input::Input;
use fsct_adapters::frame::{Decoder, Frame, MAX_GARBAGE, MAX_PAYLOAD, OVERHEAD, SYNC, encode};

/// Octets of a stream: enough for the longest frame and for too much garbage.
const LONGEST: usize = 1 << 17;

/// The input is the lengths of the pieces, then a recipe of a stream.
///
/// # Panics
/// When the decoder finds other frames than there are, or keeps more than one unfinished frame.
pub fn frame_decoder(input: &[u8]) {
    let mut input = Input::new(input);
    let cuts = input.octets();
    let stream = stream(&mut input);
    let expected = obvious(&stream);
    assert_eq!(decoded(&stream, &[]), expected, "in one piece");
    assert_eq!(decoded(&stream, &cuts), expected, "in pieces");
    found_behind_noise(&stream);
}

/// What a decoder makes of a stream.
#[derive(Debug, PartialEq, Eq)]
struct Decoded {
    frames: Vec<Frame>,
    /// Octets skipped and octets rejected since the latest frame; `None`: too many for any frame to follow.
    garbage: Option<(usize, usize)>,
}

fn decoded(stream: &[u8], cuts: &[u8]) -> Decoded {
    let mut decoder = Decoder::new();
    let mut frames = Vec::new();
    let mut cuts = cuts.iter().cycle();
    let mut rest = stream;
    while !rest.is_empty() {
        // A piece of 0 octets stands for a long one, so that many cuts do not take for ever.
        let length = cuts.next().map_or(rest.len(), |cut| if *cut == 0 { 10_000 } else { usize::from(*cut) });
        let (piece, later) = rest.split_at(length.min(rest.len()));
        rest = later;
        decoder.push(piece);
        frames.extend(std::iter::from_fn(|| decoder.next_frame()));
        if decoder.garbage().is_too_much() {
            break;
        }
        let held = decoder.held();
        assert!(held < piece.len() + MAX_PAYLOAD + OVERHEAD, "{held} octets are held");
    }
    let garbage = decoder.garbage();
    Decoded { frames, garbage: (!garbage.is_too_much()).then_some((garbage.skipped, garbage.rejected)) }
}

/// Every frame is looked for at every octet.
fn obvious(stream: &[u8]) -> Decoded {
    let mut frames = Vec::new();
    let (mut at, mut skipped, mut rejected) = (0, 0, 0);
    while skipped + rejected <= MAX_GARBAGE {
        let rest = &stream[at..];
        if rest.len() < 2 || rest[..2] != SYNC {
            if rest.is_empty() || rest == &SYNC[..1] {
                return Decoded { frames, garbage: Some((skipped, rejected)) };
            }
            (at, skipped) = (at + 1, skipped + 1);
            continue;
        }
        let length = rest.get(4..6).map_or(0, |length| usize::from(length[0]) << 8 | usize::from(length[1]));
        let Some(frame) = rest.get(..length + OVERHEAD) else {
            return Decoded { frames, garbage: Some((skipped, rejected)) };
        };
        let (secured, crc) = frame[2..].split_at(length + 4);
        if crc32(secured).to_be_bytes() == crc {
            frames.push(Frame { kind: frame[2], sequence: frame[3], payload: secured[4..].to_vec() });
            (at, skipped, rejected) = (at + frame.len(), 0, 0);
        } else {
            (at, skipped, rejected) = (at + 1, skipped + 1, rejected + frame.len());
        }
    }
    Decoded { frames, garbage: None }
}

/// The function of `PROTOCOL.md`, bit by bit.
fn crc32(octets: &[u8]) -> u32 {
    !octets.iter().fold(u32::MAX, |crc, octet| {
        (0..8).fold(crc ^ u32::from(*octet), |crc, _| crc >> 1 ^ (if crc & 1 == 1 { 0xEDB8_8320 } else { 0 }))
    })
}

/// Noise without a sync costs nothing but itself.
fn found_behind_noise(noise: &[u8]) {
    if noise.len() > MAX_GARBAGE || noise.windows(2).any(|pair| pair == SYNC) {
        return;
    }
    let payload = &noise[..noise.len().min(100)];
    let frame = encode(1, 2, payload).expect("it is short");
    let found = decoded(&[noise, &frame].concat(), &[]);
    assert_eq!(found.frames, [Frame { kind: 1, sequence: 2, payload: payload.to_vec() }]);
}

/// Cooks a stream by the recipe: raw octets, sound, damaged and long frames, runs of one octet, headers
/// without a frame.
fn stream(input: &mut Input<'_>) -> Vec<u8> {
    let mut stream = Vec::new();
    let mut latest = Vec::new();
    while !input.is_empty() && stream.len() < LONGEST {
        match input.octet() % 8 {
            0 => stream.extend(input.octets()),
            1 => {
                latest = encode(input.octet(), input.octet(), &input.octets()).expect("it is short");
                stream.extend(&latest);
            }
            2 => {
                latest = encode(input.octet(), input.octet(), &input.octets()).expect("it is short");
                let bit = usize::from(input.number()) % (8 * latest.len());
                latest[bit / 8] ^= 1 << (bit % 8);
                stream.extend(&latest);
            }
            3 => stream.extend(&latest),
            4 => stream.extend(&latest[..usize::from(input.octet()).min(latest.len())]),
            5 => stream.resize(stream.len() + usize::from(input.number() / 8), input.octet()),
            6 => {
                let payload = vec![input.octet(); usize::from(input.number())];
                stream.extend(encode(input.octet(), input.octet(), &payload).expect("it fits"));
            }
            _ => {
                stream.extend(SYNC);
                stream.extend([input.octet(), input.octet(), input.octet(), input.octet()]);
            }
        }
    }
    stream
}
