//! Messages: what the payloads of frames say. `PROTOCOL.md` is this module for people who write a DUT.
//!
//! The harness asks with [`HELLO`] and [`APPLY`]; the DUT answers with [`DESCRIPTION`], [`OBSERVED`] or [`ERROR`].
//! Everything variable is a TLV: kind (one octet), length (two octets), value. Numbers are big endian.

mod description;
mod observation;
mod port;
mod stimulus;

pub use description::{Described, Limits, pack_description, unpack_description};
pub use observation::{pack_observed, unpack_observed};
pub use stimulus::{pack_apply, unpack_apply};

pub(crate) use description::edition_number;
pub(crate) use observation::unpack_seen;
pub(crate) use port::response_number;
pub(crate) use stimulus::kind;

/// The version of the messages this program speaks. Frames, [`HELLO`] and the first octet of [`DESCRIPTION`] are the
/// same in every version.
pub const VERSION: u8 = 1;

/// Type of the frame that opens a conversation: least and greatest version the harness speaks.
pub const HELLO: u8 = 0x01;
/// Type of the frame that carries stimuli.
pub const APPLY: u8 = 0x02;
/// Type of the answer to [`HELLO`].
pub const DESCRIPTION: u8 = 0x81;
/// Type of the answer to [`APPLY`]; several may answer one request.
pub const OBSERVED: u8 = 0x82;
/// Type of the answer to a frame the DUT can make nothing of: a text.
pub const ERROR: u8 = 0xFF;

/// The most octets of a text.
pub const MAX_TEXT: usize = 255;
/// Octets of payload every DUT takes, whatever it says of itself.
pub const MIN_PAYLOAD: usize = 512;

/// The most stimuli in one request: few enough for a DUT in real time to answer each within its time-out.
pub const MAX_STIMULI: usize = 256;

/// A payload that is no message of [`VERSION`].
#[derive(Copy, Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Malformed {
    /// It ends too early.
    #[error("the payload ends within {field}")]
    Short {
        /// Where.
        field: &'static str,
    },
    /// A number without meaning.
    #[error("{field} is {number}, which version {VERSION} does not know")]
    Number {
        /// Where.
        field: &'static str,
        /// Which.
        number: u8,
    },
    /// A value of a length it cannot have.
    #[error("{field} has {found} octets")]
    Length {
        /// Where.
        field: &'static str,
        /// Octets found.
        found: usize,
    },
    /// Something that has to be there.
    #[error("{field} is missing")]
    Missing {
        /// What.
        field: &'static str,
    },
    /// Something that may be there once.
    #[error("{field} is given twice")]
    Repeated {
        /// What.
        field: &'static str,
    },
    /// The number of stimuli is not as announced.
    #[error("{announced} stimuli are announced, {found} are there")]
    Count {
        /// Announced.
        announced: usize,
        /// Found.
        found: usize,
    },
}

/// The payload of [`HELLO`].
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Hello {
    /// Least version the harness speaks.
    pub min: u8,
    /// Greatest version the harness speaks.
    pub max: u8,
}

impl Hello {
    /// What this program says.
    pub const OURS: Hello = Hello { min: VERSION, max: VERSION };

    /// The payload.
    pub const fn pack(self) -> [u8; 2] {
        [self.min, self.max]
    }

    /// Reads a payload; octets that follow belong to later versions and are not looked at.
    ///
    /// # Errors
    /// [`Malformed::Short`].
    pub fn unpack(payload: &[u8]) -> Result<Hello, Malformed> {
        match payload {
            [min, max, ..] => Ok(Hello { min: *min, max: *max }),
            _ => Err(Malformed::Short { field: "the versions" }),
        }
    }

    /// Whether a version can be spoken.
    pub fn covers(self, version: u8) -> bool {
        (self.min..=self.max).contains(&version)
    }
}

/// The payload of [`ERROR`]: the text, cut to [`MAX_TEXT`] octets.
pub fn pack_error(text: &str) -> Vec<u8> {
    cut(text).as_bytes().to_vec()
}

/// The text of [`ERROR`], at most [`MAX_TEXT`] octets of it; what is no UTF-8 is replaced. Hostile: escape it.
pub fn unpack_error(payload: &[u8]) -> String {
    String::from_utf8_lossy(payload.get(..MAX_TEXT).unwrap_or(payload)).into_owned()
}

/// The text, cut to [`MAX_TEXT`] octets between two characters.
fn cut(text: &str) -> &str {
    let end = (0..=MAX_TEXT).rev().find(|end| text.is_char_boundary(*end)).unwrap_or(0);
    text.get(..end).unwrap_or(text)
}

/// Appends a TLV. A value that is too long is cut; who may have such a value looks at the length afterwards.
pub(crate) fn put(out: &mut Vec<u8>, kind: u8, parts: &[&[u8]]) {
    let length = parts.iter().map(|part| part.len()).sum::<usize>().min(usize::from(u16::MAX));
    let [high, low] = (length as u16).to_be_bytes();
    out.extend([kind, high, low]);
    out.extend(parts.iter().copied().flatten().take(length));
}

/// Reads a payload from its beginning.
struct Cursor<'a>(&'a [u8]);

impl<'a> Cursor<'a> {
    fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    fn take(&mut self, count: usize, field: &'static str) -> Result<&'a [u8], Malformed> {
        let (taken, rest) = self.0.split_at_checked(count).ok_or(Malformed::Short { field })?;
        self.0 = rest;
        Ok(taken)
    }

    fn array<const N: usize>(&mut self, field: &'static str) -> Result<[u8; N], Malformed> {
        let (taken, rest) = self.0.split_first_chunk::<N>().ok_or(Malformed::Short { field })?;
        self.0 = rest;
        Ok(*taken)
    }

    /// Kind and value of a TLV.
    fn tlv(&mut self, field: &'static str) -> Result<(u8, &'a [u8]), Malformed> {
        let [kind, high, low] = self.array(field)?;
        Ok((kind, self.take(u16::from_be_bytes([high, low]).into(), field)?))
    }
}
