//! FSP parameterization as a case asks for it.

use super::Value;

/// FSP parameterization of an FS-Device, and how it is not as the profile says.
#[derive(Clone, Debug)]
pub struct Parameterize {
    /// What is written of authenticity and protocol record.
    pub blocks: Blocks,
    /// How the verify record is written.
    pub record: Sent,
    /// FSP_TechParCRC is the one of armed operation in all of them.
    pub armed: bool,
    /// Fields of the verify record alone. Its signatures are computed over them.
    pub set: Vec<(&'static RecordField, Value)>,
    /// Bits of the verify record that are inverted in the end, 0 is the most significant one of its first octet.
    pub corrupt: Vec<usize>,
    /// Octets too many behind the verify record, or too few.
    pub longer: i8,
    /// Whether the SCL has to start.
    pub starts: Starts,
}

/// What is written of the stored blocks.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Blocks {
    /// Both.
    Written,
    /// The protocol record alone.
    Protocol,
    /// Neither.
    Kept,
}

/// How the verify record goes out.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Sent {
    /// As it should.
    Written,
    /// Every value least significant octet first, signatures computed before.
    Swapped,
    /// Not at all.
    None,
}

/// What a record means to the SCL.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Starts {
    /// It has to start.
    Yes,
    /// It must not.
    No,
    /// The documents leave it open: it may, at any time.
    Open,
}

impl Default for Parameterize {
    fn default() -> Parameterize {
        Parameterize {
            blocks: Blocks::Written,
            record: Sent::Written,
            armed: false,
            set: Vec::new(),
            corrupt: Vec::new(),
            longer: 0,
            starts: Starts::Yes,
        }
    }
}

/// A field of FSP_VerifyRecord.
#[derive(Debug, PartialEq, Eq)]
pub struct RecordField {
    /// Its name.
    pub name: &'static str,
    /// First octet, and the one behind the last.
    pub octets: (usize, usize),
}

impl RecordField {
    /// All of them in order.
    pub const ALL: [RecordField; 10] = [
        RecordField { name: "FSP_Authenticity_1", octets: (0, 4) },
        RecordField { name: "FSP_Authenticity_2", octets: (4, 8) },
        RecordField { name: "FSP_Port", octets: (8, 9) },
        RecordField { name: "FSP_AuthentCRC", octets: (9, 11) },
        RecordField { name: "FSP_ProtVersion", octets: (11, 12) },
        RecordField { name: "FSP_ProtMode", octets: (12, 13) },
        RecordField { name: "FSP_Watchdog", octets: (13, 15) },
        RecordField { name: "FSP_IO_StructCRC", octets: (15, 17) },
        RecordField { name: "FSP_TechParCRC", octets: (17, 21) },
        RecordField { name: "FSP_ProtParCRC", octets: (21, 23) },
    ];
}
