//! Between the structs of the header and the types of the contract. Numbers and lengths are judged where those of the
//! octet streams are: an observation and a description take the way over the octets of `PROTOCOL.md`.

use super::abi;
use crate::message::{self, Described, Malformed};
use crate::{Description, Response, Seen, SmiRequest, Stimulus, Variant};
use std::ffi::{CStr, c_char};
use std::{ptr, slice};

/// A stimulus for the library; `octets` holds what it points to.
pub(super) fn stimulus(stimulus: &Stimulus, octets: &mut Vec<u8>) -> abi::Stimulus {
    let mut raw = abi::Stimulus {
        kind: message::kind(stimulus),
        port: 0,
        number: 0,
        flag: 0,
        subindex: 0,
        index: 0,
        code: 0,
        client_id: 0,
        block_id: 0,
        length: 0,
        octets: ptr::null(),
        ns: 0,
        variant: abi::Offer::default(),
        identity: abi::Identity::default(),
    };
    match stimulus {
        Stimulus::Configure(Variant { edition, mode, pd_out, pd_in }) => {
            raw.variant = abi::Offer {
                edition: message::edition_number(*edition),
                mode: mode.code(),
                pd_out_min: *pd_out,
                pd_out_max: *pd_out,
                pd_in_min: *pd_in,
                pd_in_max: *pd_in,
            };
        }
        Stimulus::Power(on) => raw.flag = (*on).into(),
        Stimulus::Exchange { port, octets: received } => {
            raw.port = *port;
            raw.flag = received.is_some().into();
            octets.extend(received.iter().flat_map(|received| received.as_slice()));
        }
        Stimulus::Read { index, subindex } => (raw.index, raw.subindex) = (*index, *subindex),
        Stimulus::Write { index, subindex, data } => {
            (raw.index, raw.subindex) = (*index, *subindex);
            octets.extend(data);
        }
        Stimulus::Set { port, service, value } => {
            (raw.port, raw.number) = (*port, service.number());
            octets.extend(value.as_slice());
        }
        Stimulus::Advance { ns } => raw.ns = *ns,
        Stimulus::Plug { port, device } => {
            (raw.port, raw.flag) = (*port, device.is_some().into());
            if let Some(device) = device {
                raw.identity = abi::Identity {
                    revision_id: device.revision_id,
                    com: device.com,
                    min_cycle_time: device.min_cycle_time,
                    pd_in: device.pd_in,
                    pd_out: device.pd_out,
                    vendor_id: device.vendor_id,
                    device_id: device.device_id,
                };
            }
        }
        Stimulus::Respond { port, response } => {
            (raw.port, raw.number) = (*port, message::response_number(response));
            match response {
                Response::Value(value) => octets.extend(value),
                Response::Written => {}
                Response::Refused(error) => raw.code = *error,
            }
        }
        Stimulus::Raise { port, code, qualifier } => {
            (raw.port, raw.code, raw.number) = (*port, *code, *qualifier);
        }
        Stimulus::Drive { port, line, level } => {
            (raw.port, raw.number, raw.flag) = (*port, line.number(), (*level).into());
        }
        Stimulus::Smi(request) => {
            let SmiRequest { service, port, client_id, expected, octets: block } = request.as_ref();
            (raw.number, raw.port) = (service.number(), *port);
            (raw.client_id, raw.block_id) = (*client_id, *expected);
            octets.extend(block);
        }
        Stimulus::Other { octets: value, .. } => octets.extend(value),
    }
    // What comes over a stream is shorter than a frame.
    octets.truncate(usize::from(u16::MAX));
    (raw.octets, raw.length) = (octets.as_ptr(), octets.len() as u16);
    raw
}

/// What the library saw, and when.
///
/// # Safety
/// `raw.octets` has `raw.length` octets, unless it is null.
pub(super) unsafe fn seen(raw: &abi::Observation) -> Result<(u64, Seen), Malformed> {
    let octets = match raw.length {
        0 => &[],
        _ if raw.octets.is_null() => {
            return Err(Malformed::Missing { field: "what octets of an observation points to" });
        }
        // SAFETY: not null, and of this length by the caller's word.
        length => unsafe { slice::from_raw_parts(raw.octets, length.into()) },
    };
    let (code, index) = (raw.code.to_be_bytes(), raw.index.to_be_bytes());
    let numbers = [raw.client_id.to_be_bytes(), raw.block_id.to_be_bytes(), raw.block_length.to_be_bytes()];
    let value = match raw.kind {
        1 | 9 if raw.flag == 0 && !octets.is_empty() => {
            return Err(Malformed::Length { field: "an observation of nothing", found: octets.len() });
        }
        1 => [&[raw.port, raw.flag], octets].concat(),
        2 => [&[raw.port, raw.number], octets].concat(),
        3 => octets.to_vec(),
        5 => code.to_vec(),
        6 => [&code[..], &[raw.number]].concat(),
        8 => vec![raw.port, raw.number],
        9 => [&[raw.port, raw.flag], &index[..], &[raw.subindex], octets].concat(),
        10 => vec![raw.port, raw.number, raw.flag],
        11 => [&[raw.port, raw.flag], numbers.as_flattened(), octets].concat(),
        12 => [&[raw.port, raw.flag, raw.number], &code[..]].concat(),
        _ => Vec::new(),
    };
    Ok((raw.ns, message::unpack_seen(raw.kind, &value)?))
}

/// What the library says of itself.
///
/// # Safety
/// Each text ends with 0, and `raw.offers` has `raw.offer_count` entries, unless they are null.
pub(super) unsafe fn description(raw: &abi::Description) -> Result<Description, Malformed> {
    let offers = match raw.offer_count {
        0 => &[],
        _ if raw.offers.is_null() => return Err(Malformed::Missing { field: "what offers points to" }),
        count if count > MAX_OFFERS => return Err(Malformed::Length { field: "the list of offers", found: count }),
        // SAFETY: not null, and of this length by the caller's word.
        count => unsafe { slice::from_raw_parts(raw.offers, count) },
    };
    let mut payload = vec![message::VERSION];
    let mut put = |tag, value: &[u8]| message::put(&mut payload, tag, &[value]);
    put(1, &[raw.role]);
    put(2, &[raw.ports]);
    put(3, &[raw.pcos]);
    for offer in offers {
        let abi::Offer { edition, mode, pd_out_min, pd_out_max, pd_in_min, pd_in_max } = *offer;
        put(4, &[edition, mode, pd_out_min, pd_out_max, pd_in_min, pd_in_max]);
    }
    put(5, &[&[raw.clock], &raw.resolution_ns.to_be_bytes()[..], &raw.uncertainty_ns.to_be_bytes()].concat());
    // SAFETY: texts by the caller's word.
    unsafe {
        put(6, text(raw.vendor));
        put(7, text(raw.product));
        put(8, text(raw.version));
    }
    match message::unpack_description(&payload)? {
        Described::As(description, _) => Ok(description),
        Described::Foreign(number) => Err(Malformed::Number { field: "the version", number }),
    }
}

/// More offers than any product has; what says so is no list.
const MAX_OFFERS: usize = 1 << 10;

/// The octets of a text without the closing 0; a null pointer is an empty text.
unsafe fn text<'t>(text: *const c_char) -> &'t [u8] {
    match text.is_null() {
        true => &[],
        // SAFETY: not null, and ends with 0 by the caller's word.
        false => unsafe { CStr::from_ptr(text) }.to_bytes(),
    }
}
