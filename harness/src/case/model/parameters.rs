//! FSP parameterization as a case asks for it.

use super::Value;

/// FSP parameterization of an FS-Device, and how it is not as the profile says.
#[derive(Clone, Debug)]
pub struct Parameterize {
    /// Authenticity and protocol record are written.
    pub blocks: bool,
    /// The verify record is written.
    pub record: bool,
    /// FSP_TechParCRC is the one of armed operation in all of them.
    pub armed: bool,
    /// Fields of the verify record alone. Its signatures are computed over them.
    pub set: Vec<(&'static RecordField, Value)>,
    /// Whether the SCL has to start.
    pub starts: bool,
}

impl Default for Parameterize {
    fn default() -> Parameterize {
        Parameterize { blocks: true, record: true, armed: false, set: Vec::new(), starts: true }
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
