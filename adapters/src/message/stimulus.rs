//! Stimuli in the payload of [`APPLY`](super::APPLY): their number, then one TLV each.

use super::description::{edition, edition_number};
use super::port::{pack_identity, pack_response, unpack_identity, unpack_response};
use super::{Cursor, Malformed, put};
use crate::{Line, Octets, Service, SmiRequest, SmiService, Stimulus, Variant};
use fsct_protocol::ProtMode;

const CONFIGURE: u8 = 1;
const POWER: u8 = 2;
const EXCHANGE: u8 = 3;
const READ: u8 = 4;
const WRITE: u8 = 5;
const SET: u8 = 6;
const ADVANCE: u8 = 7;
const PLUG: u8 = 8;
const RESPOND: u8 = 9;
const RAISE: u8 = 10;
const DRIVE: u8 = 11;
const SMI: u8 = 12;

/// Writes as many of `stimuli` into `payload` as `limit` octets and `most` stimuli allow, and says how many these are;
/// 0 when not even the first fits.
pub fn pack_apply(stimuli: &[Stimulus], limit: usize, most: usize, payload: &mut Vec<u8>) -> usize {
    payload.clear();
    payload.extend([0; 2]);
    let mut packed: u16 = 0;
    for stimulus in stimuli.iter().take(most.min(usize::from(u16::MAX))) {
        let before = payload.len();
        put_stimulus(payload, stimulus);
        if payload.len() > limit {
            payload.truncate(before);
            break;
        }
        packed += 1;
    }
    payload.iter_mut().zip(packed.to_be_bytes()).for_each(|(octet, count)| *octet = count);
    packed.into()
}

/// The stimuli of a payload. One whose kind or value this version does not know becomes [`Stimulus::Other`], to be
/// answered `Unsupported`.
///
/// # Errors
/// [`Malformed`] when the TLVs do not end where the payload does, or are not as many as announced.
pub fn unpack_apply(payload: &[u8]) -> Result<Vec<Stimulus>, Malformed> {
    let mut cursor = Cursor(payload);
    let announced = usize::from(u16::from_be_bytes(cursor.array("the number of stimuli")?));
    // A TLV has three octets at least: an announcement alone reserves no memory.
    let mut stimuli = Vec::with_capacity(announced.min(payload.len() / 3));
    while !cursor.is_empty() {
        let (kind, value) = cursor.tlv("a stimulus")?;
        stimuli.push(known(kind, value).unwrap_or_else(|| Stimulus::Other { kind, octets: value.to_vec() }));
    }
    if stimuli.len() == announced { Ok(stimuli) } else { Err(Malformed::Count { announced, found: stimuli.len() }) }
}

/// The number of its kind.
pub(crate) const fn kind(stimulus: &Stimulus) -> u8 {
    match stimulus {
        Stimulus::Configure(_) => CONFIGURE,
        Stimulus::Power(_) => POWER,
        Stimulus::Exchange { .. } => EXCHANGE,
        Stimulus::Read { .. } => READ,
        Stimulus::Write { .. } => WRITE,
        Stimulus::Set { .. } => SET,
        Stimulus::Advance { .. } => ADVANCE,
        Stimulus::Plug { .. } => PLUG,
        Stimulus::Respond { .. } => RESPOND,
        Stimulus::Raise { .. } => RAISE,
        Stimulus::Drive { .. } => DRIVE,
        Stimulus::Smi(_) => SMI,
        Stimulus::Other { kind, .. } => *kind,
    }
}

fn put_stimulus(out: &mut Vec<u8>, stimulus: &Stimulus) {
    let mut put = |value: &[&[u8]]| put(out, kind(stimulus), value);
    match stimulus {
        Stimulus::Configure(Variant { edition, mode, pd_out, pd_in }) => {
            put(&[&[edition_number(*edition), mode.code(), *pd_out, *pd_in]]);
        }
        Stimulus::Power(on) => put(&[&[u8::from(*on)]]),
        Stimulus::Exchange { port, octets: None } => put(&[&[*port, 0]]),
        Stimulus::Exchange { port, octets: Some(octets) } => put(&[&[*port, 1], octets.as_slice()]),
        Stimulus::Read { index, subindex } => put(&[&index.to_be_bytes(), &[*subindex]]),
        Stimulus::Write { index, subindex, data } => put(&[&index.to_be_bytes(), &[*subindex], data]),
        Stimulus::Set { port, service, value } => put(&[&[*port, service.number()], value.as_slice()]),
        Stimulus::Advance { ns } => put(&[&ns.to_be_bytes()]),
        Stimulus::Plug { port, device: None } => put(&[&[*port]]),
        Stimulus::Plug { port, device: Some(identity) } => put(&[&[*port], &pack_identity(identity)]),
        Stimulus::Respond { port, response } => put(&[&[*port], &pack_response(response)]),
        Stimulus::Raise { port, code, qualifier } => put(&[&[*port], &code.to_be_bytes(), &[*qualifier]]),
        Stimulus::Drive { port, line, level } => put(&[&[*port, line.number(), u8::from(*level)]]),
        Stimulus::Smi(request) => {
            let SmiRequest { service, port, client_id, expected, octets } = request.as_ref();
            let head = [service.number(), *port];
            put(&[&head, &client_id.to_be_bytes(), &expected.to_be_bytes(), octets]);
        }
        Stimulus::Other { octets, .. } => put(&[octets]),
    }
}

fn known(kind: u8, value: &[u8]) -> Option<Stimulus> {
    Some(match (kind, value) {
        (CONFIGURE, [number, mode, pd_out, pd_in]) => Stimulus::Configure(Variant {
            edition: edition(*number)?,
            mode: ProtMode::from_code(*mode)?,
            pd_out: *pd_out,
            pd_in: *pd_in,
        }),
        (POWER, [on @ (0 | 1)]) => Stimulus::Power(*on == 1),
        (EXCHANGE, [port, 0]) => Stimulus::Exchange { port: *port, octets: None },
        (EXCHANGE, [port, 1, octets @ ..]) => Stimulus::Exchange { port: *port, octets: Some(Octets::new(octets)?) },
        (READ, [high, low, subindex]) => {
            Stimulus::Read { index: u16::from_be_bytes([*high, *low]), subindex: *subindex }
        }
        (WRITE, [high, low, subindex, data @ ..]) => {
            Stimulus::Write { index: u16::from_be_bytes([*high, *low]), subindex: *subindex, data: data.to_vec() }
        }
        (SET, [port, service, value @ ..]) => {
            Stimulus::Set { port: *port, service: Service::from_number(*service)?, value: Octets::new(value)? }
        }
        (PLUG, [port]) => Stimulus::Plug { port: *port, device: None },
        (PLUG, [port, identity @ ..]) => Stimulus::Plug { port: *port, device: Some(unpack_identity(identity)?) },
        (RESPOND, [port, response @ ..]) => Stimulus::Respond { port: *port, response: unpack_response(response)? },
        (RAISE, [port, high, low, qualifier]) => {
            Stimulus::Raise { port: *port, code: u16::from_be_bytes([*high, *low]), qualifier: *qualifier }
        }
        (DRIVE, [port, line, level @ (0 | 1)]) => {
            Stimulus::Drive { port: *port, line: Line::from_number(*line)?, level: *level == 1 }
        }
        (SMI, [service, port, client_1, client_0, expected_1, expected_0, octets @ ..]) => {
            Stimulus::Smi(Box::new(SmiRequest {
                service: SmiService::from_number(*service)?,
                port: *port,
                client_id: u16::from_be_bytes([*client_1, *client_0]),
                expected: u16::from_be_bytes([*expected_1, *expected_0]),
                octets: octets.to_vec(),
            }))
        }
        (ADVANCE, ns) => Stimulus::Advance { ns: u64::from_be_bytes(ns.try_into().ok()?) },
        _ => return None,
    })
}
