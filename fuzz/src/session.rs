//! The harness against a DUT that answers anything: damaged, replayed, out of order, or sound and untrue.

use super::input::Input;
use fsct_adapters::frame::encode;
use fsct_adapters::message::{self, APPLY, DESCRIPTION, ERROR, HELLO, OBSERVED};
use fsct_adapters::{
    Description, Dut, DutError, FLOOD_PER_STIMULUS, FLOOD_SLACK, Fault, Identity, Line, MAX_RECORD, Observation,
    Octets, Peer, Response, Role, Seen, Service, SmiRequest, SmiService, Stimulus, StreamDut,
};
use std::io::{Cursor, sink};
use std::time::Duration;

/// Never waited for: the stream of answers ends.
const PATIENT: Duration = Duration::from_secs(60);
/// Stimuli of a request.
const MOST: usize = 8;
/// Octets of the stream of answers: enough for a flood of observations and for too much garbage.
const LONGEST: usize = 1 << 18;
/// Octets of a message to the user.
const MAX_SENTENCE: usize = 4_096;

/// The input is the stimuli, then a recipe of what the DUT answers to a hello and to these stimuli, given twice.
///
/// # Panics
/// When the harness takes for an answer what is none, or remembers more than an answer can have.
pub fn session(input: &[u8]) {
    let mut input = Input::new(input);
    let stimuli: Vec<Stimulus> = input.octets().iter().take(MOST).map(|number| stimulus(*number)).collect();
    let answers = answers(&mut input, &stimuli);
    let mut dut = StreamDut::new(Cursor::new(answers), sink(), Box::new(Gone), PATIENT);
    match dut.hello() {
        Ok(description) => check_description(&description),
        Err(error) => return check_error(&mut dut, &error),
    }
    for _ in 0..2 {
        let mut observed = Vec::new();
        let outcome = dut.apply(&stimuli, &mut observed);
        check_observed(&stimuli, &observed, outcome.is_ok());
        if let Err(error) = outcome {
            return check_error(&mut dut, &error);
        }
    }
}

/// The other end of a stream that ends by itself.
struct Gone;

impl Peer for Gone {
    fn close(&mut self) -> String {
        String::new()
    }
}

/// The DUT is to blame, in one line; and no answer is taken from it any more.
fn check_error(dut: &mut StreamDut, error: &DutError) {
    let text = error.to_string();
    assert_eq!(error.fault(), Fault::Dut, "{text}");
    assert!(!matches!(error, DutError::Timeout { .. }), "the stream has ended");
    assert!(text.len() < MAX_SENTENCE && !text.contains(char::is_control), "{text}");
    assert_eq!(dut.hello().as_ref(), Err(error));
    let mut observed = Vec::new();
    assert_eq!(dut.apply(&[Stimulus::Power(true)], &mut observed).as_ref(), Err(error));
    assert_eq!(observed, []);
}

fn check_description(description: &Description) {
    assert!(if description.role == Role::Device { description.ports == 1 } else { description.ports > 0 });
    assert!(!description.offers.is_empty());
    for offer in &description.offers {
        for (least, greatest) in [offer.pd_out, offer.pd_in] {
            assert!(least <= greatest && usize::from(greatest) <= offer.mode.max_pd());
        }
    }
    for text in [&description.vendor, &description.product, &description.version] {
        assert!(text.chars().count() <= message::MAX_TEXT);
    }
}

/// What is taken keeps to the contract; what was taken before an error keeps to as much of it as had come.
fn check_observed(stimuli: &[Stimulus], observed: &[Observation], complete: bool) {
    // At the worst each stimulus has a request of its own.
    assert!(observed.len() <= (FLOOD_PER_STIMULUS + FLOOD_SLACK) * stimuli.len().max(1));
    assert!(observed.is_sorted_by_key(|observation| observation.stimulus));
    assert!(observed.iter().all(|observation| usize::from(observation.stimulus) < stimuli.len()));
    let reached = observed.last().map_or(0, |observation| usize::from(observation.stimulus));
    for (position, stimulus) in stimuli.iter().enumerate() {
        let caused = observed.iter().filter(|observation| usize::from(observation.stimulus) == position);
        let caused: Vec<&Seen> = caused.map(|observation| &observation.seen).collect();
        check_caused(stimulus, &caused, complete || position < reached);
    }
    let mut payload = Vec::new();
    let packed = message::pack_observed(observed, usize::MAX, &mut payload);
    let mut unpacked = Vec::new();
    assert_eq!((packed, message::unpack_observed(&payload, &mut unpacked)), (observed.len(), Ok(false)));
    assert_eq!(unpacked, observed, "it is not what it looks like on the wire");
}

fn check_caused(stimulus: &Stimulus, caused: &[&Seen], complete: bool) {
    let count = |which: fn(&Seen) -> bool| caused.iter().filter(|seen| which(seen)).count();
    let images = count(|seen| matches!(seen, Seen::Image { .. }));
    let values = count(|seen| matches!(seen, Seen::Value(_)));
    let written = count(|seen| matches!(seen, Seen::Written));
    let refused = count(|seen| matches!(seen, Seen::Refused { .. }));
    let results = count(|seen| matches!(seen, Seen::Smi(_)));
    let unsupported = count(|seen| matches!(seen, Seen::Unsupported));
    // An answer that is due, how many there are, and of the others how many.
    let (due, right, wrong) = match stimulus {
        Stimulus::Exchange { port, .. } => {
            assert!(caused.iter().all(|seen| !matches!(seen, Seen::Image { port: at, .. } if at != port)));
            assert!(images == 0 || matches!(caused.last(), Some(Seen::Image { .. })));
            assert!(unsupported <= 1);
            (true, images, values + written + refused + results)
        }
        Stimulus::Read { .. } => (true, values + refused + unsupported, images + written + results),
        Stimulus::Write { .. } => (true, written + refused + unsupported, images + values + results),
        Stimulus::Smi(_) => (true, results + unsupported, images + values + written + refused),
        _ => (false, unsupported, images + values + written + refused + results),
    };
    assert_eq!(wrong, 0, "{stimulus:?} caused {caused:?}");
    assert!(right <= 1 && (right == 1 || !due || !complete), "{stimulus:?} caused {caused:?}");
    for seen in caused {
        match seen {
            Seen::Line { line: Line::WakeUp, level, .. } => assert!(level),
            Seen::Value(data) | Seen::Request { data: Some(data), .. } => assert!(data.len() <= MAX_RECORD),
            _ => {}
        }
    }
}

/// One stimulus of each kind.
fn stimulus(number: u8) -> Stimulus {
    let port = 1 + number / 16 % 2;
    let octets = Octets::zero(usize::from(number / 32));
    let identity = Identity {
        revision_id: 0x11,
        com: 3,
        min_cycle_time: 10,
        pd_in: 7,
        pd_out: 7,
        vendor_id: 0x1234,
        device_id: 0x56_789A,
    };
    let request =
        SmiRequest { service: SmiService::PortStatus, port, client_id: 1, expected: 0x9100, octets: vec![0xFF, 0xF0] };
    match number % 16 {
        0 => Stimulus::Exchange { port, octets: None },
        1..=3 => Stimulus::Exchange { port, octets: Some(octets) },
        4 => Stimulus::Read { index: 0x4200, subindex: 0 },
        // Three of these are more than one request.
        5 => Stimulus::Write { index: 0x4200, subindex: 0, data: vec![number; MAX_RECORD] },
        6 => Stimulus::Power(port == 1),
        7 => Stimulus::Set { port, service: Service::SetsdC, value: octets },
        8 => Stimulus::Plug { port, device: Some(identity) },
        9 => Stimulus::Respond { port, response: Response::Written },
        10 => Stimulus::Raise { port, code: 0x1800, qualifier: 0xF4 },
        11 => Stimulus::Drive { port, line: Line::Cq, level: true },
        12 | 13 => Stimulus::Smi(Box::new(request)),
        14 => Stimulus::Advance { ns: 1_000_000 },
        _ => Stimulus::Other { kind: 200, octets: vec![number] },
    }
}

/// Cooks the answers by the recipe. The upper half of each step is the sequence number of its frame.
fn answers(input: &mut Input<'_>, stimuli: &[Stimulus]) -> Vec<u8> {
    let mut frames: Vec<Vec<u8>> = Vec::new();
    let mut room = LONGEST;
    while !input.is_empty() && room > 0 {
        let step = input.octet();
        let sequence = step / 16;
        let framed = |kind, payload: &[u8]| encode(kind, sequence, payload).unwrap_or_default();
        match step % 16 {
            0 => frames.push(framed(DESCRIPTION, &sound_description(input.octet()))),
            1 => frames.push(framed(DESCRIPTION, &description(input))),
            2 => frames.push(framed(OBSERVED, &sound_observations(stimuli))),
            3 | 4 => frames.push(framed(OBSERVED, &observations(input))),
            5 => frames.push(framed(ERROR, &input.octets())),
            6 => frames
                .push(framed([HELLO, APPLY, DESCRIPTION, OBSERVED][usize::from(input.octet() % 4)], &input.octets())),
            7 => frames.push(framed(input.octet(), &input.octets())),
            8 => frames.push(input.octets()),
            // The same frame again, or an earlier one.
            9 => {
                let back = usize::from(input.octet());
                let index = frames.len().saturating_sub(1 + back);
                frames.extend(frames.get(index).cloned());
            }
            // So many times, for floods.
            10 => {
                let times = usize::from(input.number() % 2_048);
                let latest = frames.last().cloned().unwrap_or_default();
                frames.extend(std::iter::repeat_n(latest.clone(), times.min(room / latest.len().max(1))));
            }
            11 => {
                if let [.., one, other] = frames.as_mut_slice() {
                    std::mem::swap(one, other);
                }
            }
            12 => change(frames.last_mut(), input, true),
            13 => change(frames.last_mut(), input, false),
            14 => {
                let count = usize::from(input.octet());
                frames.last_mut().into_iter().for_each(|frame| frame.truncate(count));
            }
            _ => frames.push(vec![input.octet(); usize::from(input.number()).min(room)]),
        }
        room = LONGEST.saturating_sub(frames.iter().map(Vec::len).sum());
    }
    frames.concat()
}

/// Changes one octet of a frame; `secured`: its CRC is right afterwards.
fn change(frame: Option<&mut Vec<u8>>, input: &mut Input<'_>, secured: bool) {
    let (at, by) = (usize::from(input.octet()), input.octet());
    let Some(frame) = frame else { return };
    if secured {
        let end = frame.len().saturating_sub(4);
        let payload = frame.get_mut(6..end).unwrap_or_default();
        let count = payload.len().max(1);
        payload.iter_mut().skip(at % count).take(1).for_each(|octet| *octet ^= by);
        let (kind, sequence, payload) = (frame.get(2), frame.get(3), frame.get(6..end));
        if let (Some(kind), Some(sequence), Some(payload)) = (kind, sequence, payload) {
            *frame = encode(*kind, *sequence, payload).unwrap_or_default();
        }
    } else {
        let count = frame.len().max(1);
        frame.iter_mut().skip(at % count).take(1).for_each(|octet| *octet ^= by);
    }
}

fn put(out: &mut Vec<u8>, kind: u8, value: &[u8]) {
    out.push(kind);
    out.extend((value.len() as u16).to_be_bytes());
    out.extend(value);
}

/// An FS-Device or an FS-Master, with or without limits.
fn sound_description(number: u8) -> Vec<u8> {
    let mut out = vec![message::VERSION];
    let master = number % 2;
    put(&mut out, 1, &[1 + master]);
    put(&mut out, 2, &[1 + master]);
    put(&mut out, 3, &[0x3F]);
    put(&mut out, 4, &[2, 1, 0, 3, 0, 3]);
    put(&mut out, 5, &[[1].as_slice(), &[0; 16]].concat());
    if number & 2 == 2 {
        put(&mut out, 9, &[2, 0, number / 4]);
    }
    out
}

/// TLVs as the input has them.
fn description(input: &mut Input<'_>) -> Vec<u8> {
    let mut out = vec![message::VERSION];
    for _ in 0..input.octet() % 16 {
        put(&mut out, input.octet() % 12, &input.octets());
    }
    out
}

/// What is due, and a little more.
fn sound_observations(stimuli: &[Stimulus]) -> Vec<u8> {
    let mut observations = Vec::new();
    for (position, stimulus) in (0..).zip(stimuli) {
        let mut see = |seen| observations.push(Observation { stimulus: position, at: 1_000, seen });
        match stimulus {
            Stimulus::Exchange { port, octets } => {
                see(Seen::Service { port: *port, service: Service::SetsdDc, value: Octets::bit(true) });
                see(Seen::Image { port: *port, octets: *octets });
            }
            Stimulus::Read { .. } => see(Seen::Value(vec![0x4D; MAX_RECORD])),
            Stimulus::Write { .. } => see(Seen::Written),
            Stimulus::Smi(_) | Stimulus::Other { .. } => see(Seen::Unsupported),
            _ => {}
        }
    }
    let mut payload = Vec::new();
    message::pack_observed(&observations, usize::MAX, &mut payload);
    payload
}

/// Observations as the input has them.
fn observations(input: &mut Input<'_>) -> Vec<u8> {
    let head = input.octet();
    let mut out = vec![head / 128];
    for _ in 0..head % 16 {
        out.extend([0, input.octet() % 16, 0, 0, 0, 0, 0, 0, 0, input.octet()]);
        put(&mut out, input.octet() % 16, &input.octets());
    }
    out
}
