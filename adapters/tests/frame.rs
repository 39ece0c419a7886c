//! Frames on a stream: cut anywhere, among garbage, corrupted.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

use fsct_adapters::frame::{Decoder, Frame, MAX_GARBAGE, MAX_PAYLOAD, OVERHEAD, SYNC, checksum, encode};
use proptest::collection::vec;
use proptest::prelude::*;

fn frames() -> impl Strategy<Value = Vec<Frame>> {
    let frame = (any::<u8>(), any::<u8>(), vec(any::<u8>(), 0..100));
    vec(frame.prop_map(|(kind, sequence, payload)| Frame { kind, sequence, payload }), 0..8)
}

fn octets_of(frame: &Frame) -> Vec<u8> {
    encode(frame.kind, frame.sequence, &frame.payload).unwrap()
}

fn decode(chunks: &[&[u8]]) -> Vec<Frame> {
    let mut decoder = Decoder::new();
    let mut frames = Vec::new();
    for chunk in chunks {
        decoder.push(chunk);
        while let Some(frame) = decoder.next_frame() {
            frames.push(frame);
        }
    }
    frames
}

#[test]
fn the_checksum_is_that_of_ethernet() {
    assert_eq!(checksum(b"123456789"), 0xCBF4_3926);
}

#[test]
fn a_payload_has_65535_octets_at_most() {
    let octets = encode(1, 2, &[0; MAX_PAYLOAD]).unwrap();
    assert_eq!(octets.len(), MAX_PAYLOAD + OVERHEAD);
    assert_eq!(decode(&[&octets])[0].payload.len(), MAX_PAYLOAD);
    assert_eq!(encode(1, 2, &[0; MAX_PAYLOAD + 1]), None);
}

#[test]
fn a_sync_octet_too_many_costs_nothing() {
    let frame = Frame { kind: 1, sequence: 2, payload: vec![3] };
    let octets = [&SYNC[..1], &octets_of(&frame)].concat();
    assert_eq!(decode(&[&octets]), [frame]);
}

#[test]
fn a_corrupted_frame_is_searched_for_frames() {
    let inner = Frame { kind: 0x82, sequence: 9, payload: vec![1, 2, 3] };
    let mut outer = octets_of(&Frame { kind: 1, sequence: 2, payload: octets_of(&inner) });
    *outer.last_mut().unwrap() ^= 1;
    assert_eq!(decode(&[&outer]), [inner]);
}

#[test]
fn garbage_says_what_it_was() {
    let mut octets = b"boot\x07 ok\n".to_vec();
    octets.extend(encode(0x82, 0, b"x").unwrap());
    let end = octets.len();
    octets[end - 4..].copy_from_slice(&[0xDE, 0xAD, 0xBE, 0xEF]);
    let mut decoder = Decoder::new();
    decoder.push(&octets);
    assert_eq!(decoder.next_frame(), None);
    let right = checksum(&octets[11..end - 4]);
    let text = format!(
        "20 octets that are no frame, beginning \"boot\\x07 ok\\n\\xf5\\xc7\\x82\\x00\\x00\\x01x\"; \
         a frame had the CRC DEADBEEF where {right:08X} is right"
    );
    assert_eq!(decoder.garbage().to_string(), text);
}

#[test]
fn a_frame_makes_garbage_forgotten() {
    let mut decoder = Decoder::new();
    decoder.push(&[0; MAX_GARBAGE]);
    assert_eq!(decoder.next_frame(), None);
    assert!(!decoder.garbage().is_too_much());
    decoder.push(&encode(1, 1, &[]).unwrap());
    assert!(decoder.next_frame().is_some());
    assert!(decoder.garbage().is_empty());
}

#[test]
fn after_too_much_garbage_there_are_no_frames() {
    let mut decoder = Decoder::new();
    decoder.push(&[0; MAX_GARBAGE + 1]);
    assert_eq!(decoder.next_frame(), None);
    assert!(decoder.garbage().is_too_much());
    decoder.push(&encode(1, 1, &[]).unwrap());
    assert_eq!(decoder.next_frame(), None);
}

#[test]
fn headers_over_headers_do_not_cost_a_checksum_an_octet() {
    let header = [SYNC[0], SYNC[1], 1, 1, 0x70, 0x00];
    let octets = header.repeat(20_000);
    let mut decoder = Decoder::new();
    decoder.push(&octets);
    assert_eq!(decoder.next_frame(), None);
    let garbage = decoder.garbage();
    assert!(garbage.is_too_much());
    assert!(garbage.rejected <= MAX_GARBAGE + MAX_PAYLOAD + OVERHEAD, "{} octets were checked", garbage.rejected);
}

proptest! {
    #[test]
    fn frames_survive_any_cutting(frames in frames(), cuts in vec(any::<prop::sample::Index>(), 0..20)) {
        let stream = frames.iter().flat_map(octets_of).collect::<Vec<_>>();
        let mut at: Vec<_> = cuts.iter().map(|cut| cut.index(stream.len() + 1)).chain([0, stream.len()]).collect();
        at.sort_unstable();
        let chunks: Vec<_> = at.windows(2).map(|ends| &stream[ends[0]..ends[1]]).collect();
        prop_assert_eq!(decode(&chunks), frames);
    }

    #[test]
    fn frames_are_found_behind_garbage(frames in frames(), garbage in vec(any::<u8>(), 0..50)) {
        // What looks like a header swallows what follows until its announced length has passed.
        prop_assume!(!garbage.windows(2).any(|pair| pair == SYNC));
        let stream: Vec<u8> = frames.iter().flat_map(|frame| [garbage.clone(), octets_of(frame)].concat()).collect();
        prop_assert_eq!(decode(&[&stream]), frames);
    }

    #[test]
    fn no_octets_are_too_wild(chunks in vec(vec(prop_oneof![any::<u8>(), prop::sample::select(&[0xF5, 0xC7, 0, 1][..])], 0..60), 0..20)) {
        let chunks: Vec<_> = chunks.iter().map(Vec::as_slice).collect();
        decode(&chunks);
    }

    #[test]
    fn a_corrupted_frame_is_never_accepted(
        payload in vec(any::<u8>(), 0..100),
        flip in 1u8..,
        at in any::<prop::sample::Index>(),
    ) {
        let mut octets = encode(0x82, 7, &payload).unwrap();
        let at = at.index(octets.len());
        octets[at] ^= flip;
        prop_assert_eq!(decode(&[&octets]), []);
    }
}

#[test]
fn after_a_silence_what_looked_like_a_frame_is_searched_for_frames() {
    let frame = Frame { kind: 1, sequence: 2, payload: vec![3; 9] };
    let whole = encode(1, 2, &[3; 9]).unwrap();
    let trap = [0xF5, 0xC7, 0x82, 0, 0xFF, 0xFF];
    let mut decoder = Decoder::new();
    decoder.push(&[&trap[..], &whole, &trap[..4], &whole[..8]].concat());
    assert_eq!(decoder.next_frame(), None);
    assert_eq!(decoder.next_frame_after_silence(), Some(frame.clone()));
    assert_eq!(decoder.garbage().skipped, 0);
    assert_eq!(decoder.next_frame_after_silence(), None);
    assert_eq!(decoder.garbage().skipped, 12);
    // Nothing of it is left in the way of the next.
    decoder.push(&whole);
    assert_eq!(decoder.next_frame(), Some(frame));
    assert_eq!(decoder.next_frame_after_silence(), None);
}
