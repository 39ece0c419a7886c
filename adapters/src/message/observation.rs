//! Observations in the payload of [`OBSERVED`](super::OBSERVED): a flag octet, then stimulus, time and TLV of each.

use super::{Cursor, Malformed, put};
use crate::{Line, MAX_RECORD, Mode, Observation, Octets, Seen, Service, SmiResult, Source};

const IMAGE: u8 = 1;
const SERVICE: u8 = 2;
const VALUE: u8 = 3;
const WRITTEN: u8 = 4;
const REFUSED: u8 = 5;
const EVENT: u8 = 6;
const UNSUPPORTED: u8 = 7;
const MODE: u8 = 8;
const REQUEST: u8 = 9;
const LINE: u8 = 10;
const SMI: u8 = 11;
const INDICATION: u8 = 12;

/// Who an Event is from, in [`INDICATION`].
const DEVICE: u8 = 1;
const PORT: u8 = 2;

/// Bit 0 of the flags: more frames answer the same request.
const MORE: u8 = 1;

/// Writes as many of `observations` into `payload` as `limit` octets allow, and says how many these are. When they are
/// not all, the payload says that more will come.
pub fn pack_observed(observations: &[Observation], limit: usize, payload: &mut Vec<u8>) -> usize {
    payload.clear();
    payload.push(0);
    let mut packed = 0;
    for observation in observations {
        let before = payload.len();
        payload.extend(observation.stimulus.to_be_bytes());
        payload.extend(observation.at.to_be_bytes());
        put_seen(payload, &observation.seen);
        if payload.len() > limit {
            payload.truncate(before);
            break;
        }
        packed += 1;
    }
    if packed < observations.len()
        && let Some(flags) = payload.first_mut()
    {
        *flags = MORE;
    }
    packed
}

/// Appends the observations of a payload and says whether more will come.
///
/// # Errors
/// [`Malformed`]; what stood before the fault has been appended.
pub fn unpack_observed(payload: &[u8], observations: &mut Vec<Observation>) -> Result<bool, Malformed> {
    let mut cursor = Cursor(payload);
    let [flags] = cursor.array("the flags")?;
    while !cursor.is_empty() {
        let stimulus = u16::from_be_bytes(cursor.array("the stimulus of an observation")?);
        let at = u64::from_be_bytes(cursor.array("the time of an observation")?);
        let (kind, value) = cursor.tlv("an observation")?;
        observations.push(Observation { stimulus, at, seen: unpack_seen(kind, value)? });
    }
    Ok(flags & MORE != 0)
}

fn put_seen(out: &mut Vec<u8>, seen: &Seen) {
    match seen {
        Seen::Image { port, octets: None } => put(out, IMAGE, &[&[*port, 0]]),
        Seen::Image { port, octets: Some(octets) } => put(out, IMAGE, &[&[*port, 1], octets.as_slice()]),
        Seen::Service { port, service, value } => put(out, SERVICE, &[&[*port, service.number()], value.as_slice()]),
        Seen::Value(octets) => put(out, VALUE, &[octets]),
        Seen::Written => put(out, WRITTEN, &[]),
        Seen::Refused { error } => put(out, REFUSED, &[&error.to_be_bytes()]),
        Seen::Event { code, qualifier } => put(out, EVENT, &[&code.to_be_bytes(), &[*qualifier]]),
        Seen::Unsupported => put(out, UNSUPPORTED, &[]),
        Seen::Mode { port, mode } => put(out, MODE, &[&[*port, mode.number()]]),
        Seen::Request { port, index, subindex, data } => {
            let written = data.as_ref();
            let head = [*port, u8::from(written.is_some())];
            put(out, REQUEST, &[&head, &index.to_be_bytes(), &[*subindex], written.map_or(&[], Vec::as_slice)]);
        }
        Seen::Line { port, line, level } => put(out, LINE, &[&[*port, line.number(), u8::from(*level)]]),
        Seen::Smi(result) => {
            let SmiResult { port, client_id, positive, reference, length, octets } = result.as_ref();
            let numbers = [client_id.to_be_bytes(), reference.to_be_bytes(), length.to_be_bytes()];
            put(out, SMI, &[&[*port, u8::from(*positive)], numbers.as_flattened(), octets]);
        }
        Seen::Indication { port, source, qualifier, code } => {
            let source = if *source == Source::Device { DEVICE } else { PORT };
            put(out, INDICATION, &[&[*port, source, *qualifier], &code.to_be_bytes()]);
        }
    }
}

/// The observation of this kind with this value.
pub(crate) fn unpack_seen(kind: u8, value: &[u8]) -> Result<Seen, Malformed> {
    let length = |field| Malformed::Length { field, found: value.len() };
    let octets = |octets, field| Octets::new(octets).ok_or(length(field));
    match (kind, value) {
        (IMAGE, [port, 0]) => Ok(Seen::Image { port: *port, octets: None }),
        (IMAGE, [port, 1, image @ ..]) => Ok(Seen::Image { port: *port, octets: Some(octets(image, "an image")?) }),
        (IMAGE, [_, number, ..]) if *number > 1 => {
            Err(Malformed::Number { field: "the presence of an image", number: *number })
        }
        (IMAGE, _) => Err(length("an image")),
        (SERVICE, [port, number, value @ ..]) => {
            let unknown = Malformed::Number { field: "a service", number: *number };
            let service = Service::from_number(*number).ok_or(unknown)?;
            Ok(Seen::Service { port: *port, service, value: octets(value, "a service")? })
        }
        (SERVICE, _) => Err(length("a service")),
        (VALUE, value) if value.len() > MAX_RECORD => Err(length("a value read")),
        (VALUE, value) => Ok(Seen::Value(value.to_vec())),
        (WRITTEN, []) => Ok(Seen::Written),
        (WRITTEN, _) => Err(length("the answer to a write")),
        (REFUSED, [high, low]) => Ok(Seen::Refused { error: u16::from_be_bytes([*high, *low]) }),
        (REFUSED, _) => Err(length("a refusal")),
        (EVENT, [high, low, qualifier]) => {
            Ok(Seen::Event { code: u16::from_be_bytes([*high, *low]), qualifier: *qualifier })
        }
        (EVENT, _) => Err(length("an Event")),
        (UNSUPPORTED, []) => Ok(Seen::Unsupported),
        (UNSUPPORTED, _) => Err(length("an answer \"unsupported\"")),
        (MODE, [port, number]) => {
            let unknown = Malformed::Number { field: "a mode", number: *number };
            Ok(Seen::Mode { port: *port, mode: Mode::from_number(*number).ok_or(unknown)? })
        }
        (MODE, _) => Err(length("a mode")),
        (REQUEST, [port, write, high, low, subindex, data @ ..]) => {
            let write = bit(*write, "the direction of on-request data")?;
            if !write && !data.is_empty() {
                return Err(length("a read of on-request data"));
            }
            // Any number of these may come with a stimulus, and the harness remembers them.
            if data.len() > MAX_RECORD {
                return Err(length("a write of on-request data"));
            }
            let index = u16::from_be_bytes([*high, *low]);
            Ok(Seen::Request { port: *port, index, subindex: *subindex, data: write.then(|| data.to_vec()) })
        }
        (REQUEST, _) => Err(length("on-request data")),
        (LINE, [port, number, level]) => {
            let unknown = Malformed::Number { field: "a line", number: *number };
            let line = Line::from_number(*number).ok_or(unknown)?;
            Ok(Seen::Line { port: *port, line, level: bit(*level, "the level of a line")? })
        }
        (LINE, _) => Err(length("a line")),
        (SMI, [port, positive, client_1, client_0, reference_1, reference_0, length_1, length_0, octets @ ..]) => {
            Ok(Seen::Smi(Box::new(SmiResult {
                port: *port,
                client_id: u16::from_be_bytes([*client_1, *client_0]),
                positive: bit(*positive, "the sign of a result")?,
                reference: u16::from_be_bytes([*reference_1, *reference_0]),
                length: u16::from_be_bytes([*length_1, *length_0]),
                octets: octets.to_vec(),
            })))
        }
        (SMI, _) => Err(length("the result of an SMI service")),
        (INDICATION, [port, number, qualifier, high, low]) => {
            let source = match *number {
                DEVICE => Source::Device,
                PORT => Source::Port,
                number => return Err(Malformed::Number { field: "the source of an Event", number }),
            };
            Ok(Seen::Indication { port: *port, source, qualifier: *qualifier, code: u16::from_be_bytes([*high, *low]) })
        }
        (INDICATION, _) => Err(length("an Event indicated by an FS-Master")),
        (number, _) => Err(Malformed::Number { field: "the kind of an observation", number }),
    }
}

/// An octet that is 0 or 1.
fn bit(number: u8, field: &'static str) -> Result<bool, Malformed> {
    match number {
        0 => Ok(false),
        1 => Ok(true),
        number => Err(Malformed::Number { field, number }),
    }
}
