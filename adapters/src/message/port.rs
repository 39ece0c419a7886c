//! What stands inside the stimuli for a port of an FS-Master: a Device's identity and its answer.

use crate::{Identity, Response};

const VALUE: u8 = 1;
const WRITTEN: u8 = 2;
const REFUSED: u8 = 3;

/// RevisionID, COM, MinCycleTime, octets in, octets out, VendorID (2), DeviceID (3).
pub(super) fn pack_identity(identity: &Identity) -> [u8; 10] {
    let Identity { revision_id, com, min_cycle_time, pd_in, pd_out, vendor_id, device_id } = *identity;
    let ([vendor_1, vendor_0], [_, device_2, device_1, device_0]) = (vendor_id.to_be_bytes(), device_id.to_be_bytes());
    [revision_id, com, min_cycle_time, pd_in, pd_out, vendor_1, vendor_0, device_2, device_1, device_0]
}

/// The identity in these octets; `None` when they are too few or too many.
pub(super) fn unpack_identity(octets: &[u8]) -> Option<Identity> {
    let [revision_id, com, min_cycle_time, pd_in, pd_out, vendor_1, vendor_0, device_2, device_1, device_0] =
        <[u8; 10]>::try_from(octets).ok()?;
    Some(Identity {
        revision_id,
        com,
        min_cycle_time,
        pd_in,
        pd_out,
        vendor_id: u16::from_be_bytes([vendor_1, vendor_0]),
        device_id: u32::from_be_bytes([0, device_2, device_1, device_0]),
    })
}

/// The number of an answer.
pub(crate) const fn response_number(response: &Response) -> u8 {
    match response {
        Response::Value(_) => VALUE,
        Response::Written => WRITTEN,
        Response::Refused(_) => REFUSED,
    }
}

/// Number, then the value or the ErrorType.
pub(super) fn pack_response(response: &Response) -> Vec<u8> {
    let mut octets = vec![response_number(response)];
    match response {
        Response::Value(value) => octets.extend(value),
        Response::Written => {}
        Response::Refused(error) => octets.extend(error.to_be_bytes()),
    }
    octets
}

/// The answer in these octets; `None` when they are none.
pub(super) fn unpack_response(octets: &[u8]) -> Option<Response> {
    match octets {
        [VALUE, value @ ..] => Some(Response::Value(value.to_vec())),
        [WRITTEN] => Some(Response::Written),
        [REFUSED, high, low] => Some(Response::Refused(u16::from_be_bytes([*high, *low]))),
        _ => None,
    }
}
