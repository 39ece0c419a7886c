//! What a DUT says of itself in the payload of [`DESCRIPTION`](super::DESCRIPTION): the version chosen, then TLVs.

use super::{Cursor, MAX_TEXT, MIN_PAYLOAD, Malformed, cut, put};
use crate::frame::MAX_PAYLOAD;
use crate::{Clock, ClockKind, Description, Offer, Pco, Role};
use fsct_protocol::{Edition, ProtMode};

const ROLE: u8 = 1;
const PORTS: u8 = 2;
const PCOS: u8 = 3;
const OFFER: u8 = 4;
const CLOCK: u8 = 5;
const VENDOR: u8 = 6;
const PRODUCT: u8 = 7;
const VERSION: u8 = 8;
const LIMITS: u8 = 9;

/// What a DUT can take at once.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Octets of payload, [`MIN_PAYLOAD`] to 65 535.
    pub payload: usize,
    /// Requests it can hold unanswered, at least 1.
    pub requests: u8,
}

impl Limits {
    /// The limits of a DUT that states none.
    pub const LEAST: Limits = Limits { payload: MIN_PAYLOAD, requests: 1 };
}

/// A payload of [`DESCRIPTION`](super::DESCRIPTION).
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Described {
    /// The DUT speaks our version.
    As(Description, Limits),
    /// The DUT speaks this version, which is not ours.
    Foreign(u8),
}

/// The number of an edition on the wire.
pub(crate) const fn edition_number(edition: Edition) -> u8 {
    match edition {
        Edition::V1_1 => 1,
        Edition::Iec2022 => 2,
    }
}

/// The edition with this number.
pub(super) fn edition(number: u8) -> Option<Edition> {
    Edition::ALL.into_iter().find(|edition| edition_number(*edition) == number)
}

/// The payload of an answer in our version.
pub fn pack_description(description: &Description, limits: Limits) -> Vec<u8> {
    let mut out = vec![super::VERSION];
    put(&mut out, ROLE, &[&[if description.role == Role::Device { 1 } else { 2 }]]);
    put(&mut out, PORTS, &[&[description.ports]]);
    let served = (0..).zip(Pco::ALL).filter(|(_, pco)| description.pcos.contains(pco));
    put(&mut out, PCOS, &[&[served.fold(0, |bits: u8, (bit, _)| bits | 1 << bit)]]);
    for offer in &description.offers {
        let ((out_min, out_max), (in_min, in_max)) = (offer.pd_out, offer.pd_in);
        let number = edition_number(offer.edition);
        put(&mut out, OFFER, &[&[number, offer.mode.code(), out_min, out_max, in_min, in_max]]);
    }
    let Clock { kind, resolution_ns, uncertainty_ns } = description.clock;
    let kind = if kind == ClockKind::Virtual { 1 } else { 2 };
    put(&mut out, CLOCK, &[&[kind], &resolution_ns.to_be_bytes(), &uncertainty_ns.to_be_bytes()]);
    put(&mut out, VENDOR, &[cut(&description.vendor).as_bytes()]);
    put(&mut out, PRODUCT, &[cut(&description.product).as_bytes()]);
    put(&mut out, VERSION, &[cut(&description.version).as_bytes()]);
    let payload = u16::try_from(limits.payload).unwrap_or(u16::MAX);
    put(&mut out, LIMITS, &[&payload.to_be_bytes(), &[limits.requests]]);
    out
}

/// Reads a payload. Tags without meaning in our version are passed over; so is everything behind the version when it is
/// not ours.
///
/// # Errors
/// [`Malformed`].
pub fn unpack_description(payload: &[u8]) -> Result<Described, Malformed> {
    let mut cursor = Cursor(payload);
    let [version] = cursor.array("the version")?;
    if version != super::VERSION {
        return Ok(Described::Foreign(version));
    }
    let (mut role, mut ports, mut pcos, mut clock, mut limits) = (None, None, None, None, None);
    let (mut vendor, mut product, mut its_version) = (None, None, None);
    let mut offers = Vec::new();
    while !cursor.is_empty() {
        let (tag, value) = cursor.tlv("a part of the description")?;
        match tag {
            ROLE => once(&mut role, "the role", self::role(value)?)?,
            PORTS => once(&mut ports, "the number of ports", octet(value, "the number of ports")?)?,
            PCOS => once(&mut pcos, "the list of PCOs", octet(value, "the list of PCOs")?)?,
            OFFER => offers.push(offer(value)?),
            CLOCK => once(&mut clock, "the clock", self::clock(value)?)?,
            VENDOR => once(&mut vendor, "the vendor", text(value, "the vendor")?)?,
            PRODUCT => once(&mut product, "the product", text(value, "the product")?)?,
            VERSION => once(&mut its_version, "the product's version", text(value, "the product's version")?)?,
            LIMITS => once(&mut limits, "the part about limits", self::limits(value)?)?,
            _ => {}
        }
    }
    let missing = |field| Malformed::Missing { field };
    let pcos = pcos.ok_or(missing("the list of PCOs"))?;
    let description = Description {
        role: role.ok_or(missing("the role"))?,
        ports: ports.ok_or(missing("the number of ports"))?,
        pcos: (0..).zip(Pco::ALL).filter(|(bit, _)| pcos >> bit & 1 == 1).map(|(_, pco)| pco).collect(),
        offers,
        clock: clock.ok_or(missing("the clock"))?,
        vendor: vendor.unwrap_or_default(),
        product: product.unwrap_or_default(),
        version: its_version.unwrap_or_default(),
    };
    Ok(Described::As(description, limits.unwrap_or(Limits::LEAST)))
}

fn once<T>(slot: &mut Option<T>, field: &'static str, value: T) -> Result<(), Malformed> {
    match slot.replace(value) {
        None => Ok(()),
        Some(_) => Err(Malformed::Repeated { field }),
    }
}

fn octet(value: &[u8], field: &'static str) -> Result<u8, Malformed> {
    match value {
        [octet] => Ok(*octet),
        _ => Err(Malformed::Length { field, found: value.len() }),
    }
}

fn role(value: &[u8]) -> Result<Role, Malformed> {
    match octet(value, "the role")? {
        1 => Ok(Role::Device),
        2 => Ok(Role::Master),
        number => Err(Malformed::Number { field: "the role", number }),
    }
}

fn offer(value: &[u8]) -> Result<Offer, Malformed> {
    let [number, mode, out_min, out_max, in_min, in_max] =
        <[u8; 6]>::try_from(value).map_err(|_| Malformed::Length { field: "an offer", found: value.len() })?;
    Ok(Offer {
        edition: edition(number).ok_or(Malformed::Number { field: "the edition of an offer", number })?,
        mode: ProtMode::from_code(mode).ok_or(Malformed::Number { field: "the mode of an offer", number: mode })?,
        pd_out: (out_min, out_max),
        pd_in: (in_min, in_max),
    })
}

fn clock(value: &[u8]) -> Result<Clock, Malformed> {
    let mut cursor = Cursor(value);
    let [kind] = cursor.array("the clock")?;
    let kind = match kind {
        1 => ClockKind::Virtual,
        2 => ClockKind::Real,
        number => return Err(Malformed::Number { field: "the kind of the clock", number }),
    };
    let resolution_ns = u64::from_be_bytes(cursor.array("the clock")?);
    let uncertainty_ns = u64::from_be_bytes(cursor.array("the clock")?);
    if cursor.is_empty() {
        Ok(Clock { kind, resolution_ns, uncertainty_ns })
    } else {
        Err(Malformed::Length { field: "the clock", found: value.len() })
    }
}

fn text(value: &[u8], field: &'static str) -> Result<String, Malformed> {
    if value.len() > MAX_TEXT {
        return Err(Malformed::Length { field, found: value.len() });
    }
    Ok(String::from_utf8_lossy(value).into_owned())
}

fn limits(value: &[u8]) -> Result<Limits, Malformed> {
    match value {
        [high, low, requests] => Ok(Limits {
            payload: usize::from(u16::from_be_bytes([*high, *low])).clamp(MIN_PAYLOAD, MAX_PAYLOAD),
            requests: (*requests).max(1),
        }),
        _ => Err(Malformed::Length { field: "the part about limits", found: value.len() }),
    }
}
