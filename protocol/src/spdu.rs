//! Safety PDUs (11.4.3, C.5): the *view* over received octets, the *repr* in which illegal states cannot be built,
//! and the *wire* form that can express any illegal frame on purpose.
//!
//! In order of transmission: FS process data, PortNum, Control&MCnt or Status&DCnt, signature (most significant octet
//! first). The FS-Device sends PortNum inverted.

use crate::ProtMode;
use crate::crc::{Reading, signature};
use core::fmt;

/// The longest SPDU in octets: 25 of process data, PortNum, control octet, CRC-32.
pub const MAX_SPDU: usize = 31;
/// The most FS process data in octets, over both modes.
pub const MAX_PD: usize = 25;

/// The mirror of a 3-bit counter: DCount_i for a given MCount (Table 33). Only the low 3 bits count.
pub const fn inv3(count: u8) -> u8 {
    !count & 0b111
}

/// The MCount that follows: 1..7 round, 0 only as a start (11.4.6).
pub const fn succ(count: u8) -> u8 {
    if count >= 7 { 1 } else { count + 1 }
}

/// Control&MCnt, the octet from FS-Master to FS-Device (Table 31), reserved bits apart.
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq, Hash)]
pub struct Control {
    /// Sequence counter, 0..7; bits 7..5.
    pub mcount: u8,
    /// The FS-Device shall use SDout; bit 1.
    pub set_sd: bool,
    /// An acknowledgment by the operator is awaited; bit 0.
    pub ch_f_ack_req: bool,
}

impl Control {
    /// The fields of a received octet; reserved bits are not looked at.
    pub const fn from_octet(octet: u8) -> Control {
        Control { mcount: octet >> 5, set_sd: octet & 0b10 != 0, ch_f_ack_req: octet & 1 != 0 }
    }

    /// The octet with reserved bits 0.
    pub const fn to_octet(self) -> u8 {
        (self.mcount << 5) | ((self.set_sd as u8) << 1) | self.ch_f_ack_req as u8
    }
}

/// Status&DCnt, the octet from FS-Device to FS-Master (Table 32), reserved bits apart.
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq, Hash)]
pub struct Status {
    /// Mirrored sequence counter, 0..7; bits 7..5.
    pub dcount_i: u8,
    /// The FS-Device uses or sends SD; bit 2.
    pub sd_set: bool,
    /// The FS-Device found a CRC, counter or port error; bit 1.
    pub d_comm_err: bool,
    /// The watchdog of the FS-Device has expired; bit 0.
    pub d_timeout: bool,
}

impl Status {
    /// The fields of a received octet; reserved bits are not looked at.
    pub const fn from_octet(octet: u8) -> Status {
        Status {
            dcount_i: octet >> 5,
            sd_set: octet & 0b100 != 0,
            d_comm_err: octet & 0b10 != 0,
            d_timeout: octet & 1 != 0,
        }
    }

    /// The octet with reserved bits 0.
    pub const fn to_octet(self) -> u8 {
        (self.dcount_i << 5) | ((self.sd_set as u8) << 2) | ((self.d_comm_err as u8) << 1) | self.d_timeout as u8
    }
}

/// Octets that are not as long as the SPDU they should hold.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct LengthError {
    /// Octets an SPDU of this mode and size has.
    pub expected: usize,
    /// Octets that were there.
    pub found: usize,
}

impl fmt::Display for LengthError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "an SPDU of {} octets was expected, {} are there", self.expected, self.found)
    }
}

impl core::error::Error for LengthError {}

/// Received octets read as an SPDU. The length is checked once, here; nothing else can go wrong.
#[derive(Copy, Clone, Debug)]
pub struct View<'a> {
    mode: ProtMode,
    secured: &'a [u8],
    pd: &'a [u8],
    port_num: u8,
    octet: u8,
    signature: u32,
}

impl<'a> View<'a> {
    /// Reads an SPDU with `pd` octets of FS process data from the front of `octets`; what follows it is non-safety data.
    ///
    /// # Errors
    /// [`LengthError`] when fewer octets are there.
    pub fn new(octets: &'a [u8], mode: ProtMode, pd: usize) -> Result<View<'a>, LengthError> {
        let short = LengthError { expected: mode.spdu_octets(pd), found: octets.len() };
        let (secured, rest) = octets.split_at_checked(pd + 2).ok_or(short)?;
        let sent = rest.get(..mode.signature_octets()).ok_or(short)?;
        let [pd @ .., port_num, octet] = secured else { return Err(short) };
        let signature = sent.iter().fold(0, |value, octet| value << 8 | u32::from(*octet));
        Ok(View { mode, secured, pd, port_num: *port_num, octet: *octet, signature })
    }

    /// The FS process data.
    pub const fn pd(&self) -> &'a [u8] {
        self.pd
    }

    /// The PortNum octet as received (inverted in answers).
    pub const fn port_num(&self) -> u8 {
        self.port_num
    }

    /// The control or status octet as received, reserved bits included.
    pub const fn octet(&self) -> u8 {
        self.octet
    }

    /// The control octet of an output SPDU.
    pub const fn control(&self) -> Control {
        Control::from_octet(self.octet)
    }

    /// The status octet of an input SPDU.
    pub const fn status(&self) -> Status {
        Status::from_octet(self.octet)
    }

    /// The counter bits: MCount or DCount_i.
    pub const fn counter(&self) -> u8 {
        self.octet >> 5
    }

    /// The signature as received, in the low 16 or 32 bits.
    pub const fn signature(&self) -> u32 {
        self.signature
    }

    /// The signature these octets should carry under `reading`.
    pub fn computed(&self, reading: Reading) -> u32 {
        signature(self.mode, reading, self.secured)
    }

    /// Whether the received signature is the computed one under `reading`.
    pub fn signature_matches(&self, reading: Reading) -> bool {
        self.computed(reading) == self.signature
    }

    /// Whether every octet of the SPDU is 0; such an SPDU is ignored (11.5.3).
    pub fn is_all_zero(&self) -> bool {
        self.signature == 0 && self.secured.iter().all(|octet| *octet == 0)
    }
}

/// FSP_Port: the port number an SPDU carries, 1..255.
#[derive(Copy, Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Port(core::num::NonZeroU8);

impl Port {
    /// The first port.
    pub const ONE: Port = Port(core::num::NonZeroU8::MIN);

    /// A port number; `None` for 0, which means "not assigned" (A.2.2).
    pub const fn new(number: u8) -> Option<Port> {
        match core::num::NonZeroU8::new(number) {
            Some(number) => Some(Port(number)),
            None => None,
        }
    }

    /// The number, as the FS-Master sends it.
    pub const fn number(self) -> u8 {
        self.0.get()
    }

    /// The bitwise inverse, as the FS-Device sends it (11.4.5).
    pub const fn inverted(self) -> u8 {
        !self.0.get()
    }
}

/// FS process data of 0..25 octets, by value.
#[derive(Copy, Clone, PartialEq, Eq, Hash)]
pub struct Pd {
    octets: [u8; MAX_PD],
    length: u8,
}

impl Pd {
    /// Safe data: `length` octets of 0, at most 25.
    pub const fn safe(length: usize) -> Pd {
        let length = if length > MAX_PD { MAX_PD } else { length };
        Pd { octets: [0; MAX_PD], length: length as u8 }
    }

    /// These octets; `None` when there are more than 25.
    pub fn new(octets: &[u8]) -> Option<Pd> {
        let mut pd = Pd::safe(octets.len());
        pd.octets.get_mut(..octets.len())?.copy_from_slice(octets);
        Some(pd)
    }

    /// The octets.
    pub fn octets(&self) -> &[u8] {
        &self.octets[..usize::from(self.length)]
    }

    /// Whether all octets are 0, as safe data are. Data of length 0 always are.
    pub fn is_safe(&self) -> bool {
        self.octets().iter().all(|octet| *octet == 0)
    }
}

impl fmt::Debug for Pd {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.octets().iter().try_for_each(|octet| write!(f, "{octet:02X}"))
    }
}

/// A legal SPDU from FS-Master to FS-Device.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct OutSpdu {
    /// FS-PDout.
    pub pd: Pd,
    /// FSP_Port.
    pub port: Port,
    /// Control&MCnt.
    pub control: Control,
}

/// A legal SPDU from FS-Device to FS-Master.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct InSpdu {
    /// FS-PDin.
    pub pd: Pd,
    /// FSP_Port; sent inverted.
    pub port: Port,
    /// Status&DCnt.
    pub status: Status,
}

impl OutSpdu {
    /// The same SPDU in a form that can be falsified.
    pub fn wire(&self) -> Wire {
        Wire { pd: self.pd, port_num: self.port.number(), octet: self.control.to_octet(), signature: None }
    }
}

impl InSpdu {
    /// The same SPDU in a form that can be falsified.
    pub fn wire(&self) -> Wire {
        Wire { pd: self.pd, port_num: self.port.inverted(), octet: self.status.to_octet(), signature: None }
    }
}

/// Any SPDU that fits the line, legal or not.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Wire {
    /// FS process data.
    pub pd: Pd,
    /// The PortNum octet as sent.
    pub port_num: u8,
    /// The control or status octet as sent, reserved bits included.
    pub octet: u8,
    /// A signature to send in place of the computed one, in the low 16 or 32 bits.
    pub signature: Option<u32>,
}

impl Wire {
    /// The octets on the line.
    pub fn emit(&self, mode: ProtMode, reading: Reading) -> Emitted {
        let mut out = Emitted { octets: [0; MAX_SPDU], length: 0 };
        out.push(self.pd.octets());
        out.push(&[self.port_num, self.octet]);
        let sent = self.signature.unwrap_or_else(|| signature(mode, reading, out.octets()));
        out.push(&sent.to_be_bytes()[4 - mode.signature_octets()..]);
        out
    }
}

/// An SPDU as octets on the line.
#[derive(Copy, Clone, PartialEq, Eq)]
pub struct Emitted {
    octets: [u8; MAX_SPDU],
    length: usize,
}

impl Emitted {
    /// The octets in order of transmission.
    pub fn octets(&self) -> &[u8] {
        &self.octets[..self.length]
    }

    /// The octets, to be falsified.
    pub fn octets_mut(&mut self) -> &mut [u8] {
        &mut self.octets[..self.length]
    }

    fn push(&mut self, octets: &[u8]) {
        let end = self.length + octets.len();
        if let Some(room) = self.octets.get_mut(self.length..end) {
            room.copy_from_slice(octets);
            self.length = end;
        }
    }
}

impl fmt::Debug for Emitted {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.octets().iter().try_for_each(|octet| write!(f, "{octet:02X}"))
    }
}
