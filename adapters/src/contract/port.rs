//! What the base system does on a port of an FS-Master: lines, modes, and the on-request data the FS-Master sends.
//!
//! The harness plays everything that is connected to a port. How bits travel on the line is not part of the contract: the
//! adapter says which Device answers, and reports what the FS-Master makes of it.

use std::fmt;

/// A line of a port, and what is special about it.
#[derive(Copy, Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Line {
    /// L+ (pin 1): supply of the port, switched by the FS-Master.
    Power,
    /// C/Q (pin 4): Ready pulse, OSSDe 1.
    Cq,
    /// I/Q (pin 2): OSSDe 2.
    Iq,
    /// Wake-up pulse of the FS-Master on C/Q; its level is always 1.
    WakeUp,
}

impl Line {
    /// All lines with their numbers in `PROTOCOL.md` and their names in cases and reports.
    pub const ALL: [(Line, u8, &'static str); 4] =
        [(Line::Power, 1, "L+"), (Line::Cq, 2, "C/Q"), (Line::Iq, 3, "I/Q"), (Line::WakeUp, 4, "wake-up")];

    /// The number of the line in `PROTOCOL.md`.
    pub fn number(self) -> u8 {
        Line::ALL.into_iter().find(|entry| entry.0 == self).map_or(0, |entry| entry.1)
    }

    /// The line with this number.
    pub fn from_number(number: u8) -> Option<Line> {
        Line::ALL.into_iter().find(|entry| entry.1 == number).map(|entry| entry.0)
    }
}

impl fmt::Display for Line {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(Line::ALL.into_iter().find(|entry| entry.0 == *self).map_or("", |entry| entry.2))
    }
}

/// State of the Device on a port, as the FS-Master commands it (base standard).
#[derive(Copy, Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Mode {
    /// No communication.
    Inactive,
    /// STARTUP: identification.
    Startup,
    /// PREOPERATE: on-request data only.
    Preoperate,
    /// OPERATE: process data and on-request data.
    Operate,
}

impl Mode {
    /// All modes with their numbers in `PROTOCOL.md` and the standard's spelling.
    pub const ALL: [(Mode, u8, &'static str); 4] = [
        (Mode::Inactive, 0, "INACTIVE"),
        (Mode::Startup, 1, "STARTUP"),
        (Mode::Preoperate, 2, "PREOPERATE"),
        (Mode::Operate, 3, "OPERATE"),
    ];

    /// The number of the mode in `PROTOCOL.md`.
    pub fn number(self) -> u8 {
        Mode::ALL.into_iter().find(|entry| entry.0 == self).map_or(0, |entry| entry.1)
    }

    /// The mode with this number.
    pub fn from_number(number: u8) -> Option<Mode> {
        Mode::ALL.into_iter().find(|entry| entry.1 == number).map(|entry| entry.0)
    }
}

impl fmt::Display for Mode {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(Mode::ALL.into_iter().find(|entry| entry.0 == *self).map_or("", |entry| entry.2))
    }
}

/// What a Device says of itself on its Direct Parameter page, and how fast (base standard).
#[derive(Copy, Clone, Debug, PartialEq, Eq, Hash)]
pub struct Identity {
    /// RevisionID; 0x11 is V1.1.
    pub revision_id: u8,
    /// Transmission rate: 1 to 3 for COM1 to COM3.
    pub com: u8,
    /// MinCycleTime in the coding of the base standard.
    pub min_cycle_time: u8,
    /// Octets of process data in, SPDU included.
    pub pd_in: u8,
    /// Octets of process data out, SPDU included.
    pub pd_out: u8,
    /// VendorID.
    pub vendor_id: u16,
    /// DeviceID, three octets.
    pub device_id: u32,
}

/// The answer of a Device to on-request data.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum Response {
    /// Value read, at most 232 octets.
    Value(Vec<u8>),
    /// Written.
    Written,
    /// Refused with this ErrorType: ErrorCode in the high, AdditionalCode in the low octet.
    Refused(u16),
}

/// Who an Event that the FS-Master indicates is from.
#[derive(Copy, Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Source {
    /// The Device on the port: SMI_DeviceEvent.
    Device,
    /// The port itself: SMI_PortEvent.
    Port,
}

impl fmt::Display for Source {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Source::Device => "SMI_DeviceEvent",
            Source::Port => "SMI_PortEvent",
        })
    }
}
