//! ArgBlocks of the Standardized Master Interface as data: identifiers and fields per edition (clause 10.3).
//!
//! Offsets count octets from the beginning of the ArgBlock, its ArgBlockID included. Every value of more than one octet is
//! sent most significant octet first.

use crate::Edition;

/// A kind of ArgBlock with its ArgBlockID per edition (v1.1 Table 19, iec2022 Table 18).
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct ArgBlock {
    /// The standard's name.
    pub name: &'static str,
    /// ArgBlockID in v1.1 and in iec2022; `None` where the edition has none.
    pub ids: [Option<u16>; 2],
    /// Octets in v1.1 and in iec2022; 0 where it depends on its content.
    pub octets: [usize; 2],
    /// Its fields.
    pub fields: &'static [Field],
}

/// One field of an ArgBlock.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Field {
    /// The standard's name in iec2022.
    pub name: &'static str,
    /// Offset in v1.1 and in iec2022; `None` where the edition has none.
    pub offsets: [Option<u8>; 2],
    /// Octets.
    pub octets: u8,
}

const fn edition(edition: Edition) -> usize {
    match edition {
        Edition::V1_1 => 0,
        Edition::Iec2022 => 1,
    }
}

const fn field(name: &'static str, v1_1: u8, iec2022: u8, octets: u8) -> Field {
    Field { name, offsets: [Some(v1_1), Some(iec2022)], octets }
}

const fn only_v1_1(name: &'static str, offset: u8, octets: u8) -> Field {
    Field { name, offsets: [Some(offset), None], octets }
}

const fn only_iec2022(name: &'static str, offset: u8, octets: u8) -> Field {
    Field { name, offsets: [None, Some(offset)], octets }
}

impl Field {
    /// Offset in an edition.
    pub const fn offset(&self, of: Edition) -> Option<usize> {
        match self.offsets[edition(of)] {
            Some(offset) => Some(offset as usize),
            None => None,
        }
    }

    /// The value in a block of an edition; `None` where the edition has no such field or the block ends before it.
    pub fn value(&self, of: Edition, block: &[u8]) -> Option<u32> {
        let octets = block.get(self.offset(of)?..)?.get(..usize::from(self.octets))?;
        Some(octets.iter().fold(0, |value, octet| value << 8 | u32::from(*octet)))
    }

    /// Puts a value into a block of an edition; octets that do not fit are left out.
    pub fn put(&self, of: Edition, block: &mut [u8], value: u32) {
        let octets = usize::from(self.octets);
        let Some(place) = self.offset(of).and_then(|offset| block.get_mut(offset..)?.get_mut(..octets)) else { return };
        place.iter_mut().rev().zip(value.to_le_bytes()).for_each(|(octet, part)| *octet = part);
    }
}

impl ArgBlock {
    /// ArgBlockID in an edition.
    pub const fn id(&self, of: Edition) -> Option<u16> {
        self.ids[edition(of)]
    }

    /// Octets in an edition; 0 where that depends on the content.
    pub const fn length(&self, of: Edition) -> usize {
        self.octets[edition(of)]
    }

    /// The field of this name.
    pub fn field(&self, name: &str) -> Option<&'static Field> {
        self.fields.iter().find(|field| field.name == name)
    }

    /// The kind of block with this ArgBlockID in an edition.
    pub fn of_id(of: Edition, id: u16) -> Option<&'static ArgBlock> {
        ALL.iter().copied().find(|block| block.id(of) == Some(id))
    }
}

const ID: Field = field("ArgBlockID", 0, 0, 2);

/// FSPortConfigList: 48 octets (v1.1 Table 22), 50 octets (iec2022 Table 21).
pub static FS_PORT_CONFIG_LIST: ArgBlock = ArgBlock {
    name: "FSPortConfigList",
    ids: [Some(0x8001), Some(0x8100)],
    octets: [48, 50],
    fields: &[
        ID,
        field("PortMode", 2, 2, 1),
        field("Validation&Backup", 3, 3, 1),
        field("I/Q_behavior", 4, 4, 1),
        field("PortCycleTime", 5, 5, 1),
        field("VendorID", 6, 6, 2),
        field("DeviceID", 8, 8, 4),
        only_v1_1("InputDataLength", 12, 1),
        only_v1_1("OutputDataLength", 13, 1),
        only_iec2022("FSP_TimeToReady", 12, 2),
        only_iec2022("FSP_MinShutDownTime", 14, 2),
        field("FSP_Authenticity1", 14, 16, 4),
        field("FSP_Authenticity2", 18, 20, 4),
        field("FSP_Port", 22, 24, 1),
        field("FSP_AuthentCRC", 23, 25, 2),
        field("FSP_ProtVersion", 25, 27, 1),
        field("FSP_ProtMode", 26, 28, 1),
        field("FSP_Watchdog", 27, 29, 2),
        field("FSP_IO_StructCRC", 29, 31, 2),
        field("FSP_TechParCRC", 31, 33, 4),
        field("FSP_ProtParCRC", 35, 37, 2),
        field("IO_DescVersion", 37, 39, 1),
        field("SPDUInLength", 38, 40, 1),
        field("TotalOfInBits", 39, 41, 1),
        field("TotalOfInOctets", 40, 42, 1),
        field("TotalOfInInt16", 41, 43, 1),
        field("TotalOfInInt32", 42, 44, 1),
        field("SPDUOutLength", 43, 45, 1),
        field("TotalOfOutBits", 44, 46, 1),
        field("TotalOfOutOctets", 45, 47, 1),
        field("TotalOfOutInt16", 46, 48, 1),
        field("TotalOfOutInt32", 47, 49, 1),
    ],
};

/// FSPortStatusList: 15 octets and 3 for each diagnosis entry (v1.1 Table 23), 16 and 3 (iec2022 Table 22).
pub static FS_PORT_STATUS_LIST: ArgBlock = ArgBlock {
    name: "FSPortStatusList",
    ids: [Some(0x9001), Some(0x9100)],
    octets: [0, 0],
    fields: &[
        ID,
        field("PortStatusInfo", 2, 2, 1),
        field("PortQualityInfo", 3, 3, 1),
        field("RevisionID", 4, 4, 1),
        field("TransmissionRate", 5, 5, 1),
        field("MasterCycleTime", 6, 6, 1),
        only_iec2022("InputDataLength", 7, 1),
        only_iec2022("OutputDataLength", 8, 1),
        field("VendorID", 8, 9, 2),
        field("DeviceID", 10, 11, 4),
        field("NumberOfDiags", 14, 15, 1),
        field("DiagEntry0.EventQualifier", 15, 16, 1),
        field("DiagEntry0.EventCode", 16, 17, 2),
        field("DiagEntry1.EventQualifier", 18, 19, 1),
        field("DiagEntry1.EventCode", 19, 20, 2),
    ],
};

/// FSMasterAccess: in v1.1 the authenticity (Table 20), in iec2022 the passwords (Table 19).
pub static FS_MASTER_ACCESS: ArgBlock = ArgBlock {
    name: "FSMasterAccess",
    ids: [Some(0x0001), Some(0x0100)],
    octets: [10, 11],
    fields: &[
        ID,
        only_v1_1("FSP_Authenticity1", 2, 4),
        only_v1_1("FSP_Authenticity2", 6, 4),
        only_iec2022("FSMasterPassword", 2, 4),
        only_iec2022("FSResetMasterPW", 6, 4),
        only_iec2022("FSUserRole", 10, 1),
    ],
};

/// FSCPAuthenticity: 10 octets (iec2022 Table 20).
pub static FSCP_AUTHENTICITY: ArgBlock = ArgBlock {
    name: "FSCPAuthenticity",
    ids: [None, Some(0x0101)],
    octets: [0, 10],
    fields: &[ID, only_iec2022("FSP_Authenticity1", 2, 4), only_iec2022("FSP_Authenticity2", 6, 4)],
};

/// PortPowerOffOn: 5 octets (v1.1 Table 21).
pub static PORT_POWER_OFF_ON: ArgBlock = ArgBlock {
    name: "PortPowerOffOn",
    ids: [Some(0x7002), Some(0x7003)],
    octets: [5, 5],
    fields: &[ID, field("PortPowerMode", 2, 2, 1), field("PowerOffTime", 3, 3, 2)],
};

/// MasterIdent; its layout is printed by the base standard.
pub static MASTER_IDENT: ArgBlock = ArgBlock {
    name: "MasterIdent",
    ids: [Some(0x0000), Some(0x0001)],
    octets: [0, 0],
    fields: &[
        ID,
        field("VendorID", 2, 2, 2),
        field("MasterID", 4, 4, 4),
        field("MasterType", 8, 8, 1),
        field("Features_1", 9, 9, 1),
        field("Features_2", 10, 10, 1),
        field("MaxNumberOfPorts", 11, 11, 1),
    ],
};

/// FSPDInOut (iec2022 Table 25); what follows InputDataLength depends on the lengths.
pub static FS_PD_IN_OUT: ArgBlock = ArgBlock {
    name: "FSPDInOut",
    ids: [None, Some(0x1103)],
    octets: [0, 0],
    fields: &[ID, only_iec2022("PQI", 2, 1), only_iec2022("OE", 3, 1), only_iec2022("InputDataLength", 4, 1)],
};

/// SPDUIn: the SPDU from offset 2 on (v1.1 Table 24, iec2022 Table 23).
pub static SPDU_IN: ArgBlock =
    ArgBlock { name: "SPDUIn", ids: [Some(0x1004), Some(0x1101)], octets: [0, 0], fields: &[ID] };

/// SPDUOut: the SPDU from offset 2 on (v1.1 Table 25, iec2022 Table 24).
pub static SPDU_OUT: ArgBlock =
    ArgBlock { name: "SPDUOut", ids: [Some(0x1005), Some(0x1102)], octets: [0, 0], fields: &[ID] };

/// PDIn: data without safety relevance.
pub static PD_IN: ArgBlock =
    ArgBlock { name: "PDIn", ids: [Some(0x1001), Some(0x1001)], octets: [0, 0], fields: &[ID] };

/// PDOut: data without safety relevance.
pub static PD_OUT: ArgBlock =
    ArgBlock { name: "PDOut", ids: [Some(0x1002), Some(0x1002)], octets: [0, 0], fields: &[ID] };

/// PDInOut: data without safety relevance.
pub static PD_IN_OUT: ArgBlock =
    ArgBlock { name: "PDInOut", ids: [Some(0x1003), Some(0x1003)], octets: [0, 0], fields: &[ID] };

/// DS_Data: the back-up object.
pub static DS_DATA: ArgBlock =
    ArgBlock { name: "DS_Data", ids: [Some(0x7000), Some(0x7000)], octets: [0, 0], fields: &[ID] };

/// On-request data written, and read as a result (base standard).
pub static ON_REQUEST_DATA: ArgBlock = ArgBlock {
    name: "On-requestData",
    ids: [Some(0x3000), Some(0x3000)],
    octets: [0, 0],
    fields: &[ID, field("Index", 2, 2, 2), field("Subindex", 4, 4, 1)],
};

/// Request for on-request data (base standard).
pub static ON_REQUEST_READ: ArgBlock = ArgBlock {
    name: "On-requestDataRead",
    ids: [Some(0x3001), Some(0x3001)],
    octets: [5, 5],
    fields: &[ID, field("Index", 2, 2, 2), field("Subindex", 4, 4, 1)],
};

/// VoidBlock: no content (iec2022).
pub static VOID_BLOCK: ArgBlock =
    ArgBlock { name: "VoidBlock", ids: [None, Some(0xFFF0)], octets: [0, 2], fields: &[ID] };

/// JobError: what a Result(-) carries (iec2022; base standard).
pub static JOB_ERROR: ArgBlock = ArgBlock {
    name: "JobError",
    ids: [None, Some(0xFFFF)],
    octets: [0, 6],
    fields: &[ID, only_iec2022("ExpArgBlockID", 2, 2), only_iec2022("ErrorType", 4, 2)],
};

/// Every kind of ArgBlock.
pub static ALL: [&ArgBlock; 17] = [
    &FS_PORT_CONFIG_LIST,
    &FS_PORT_STATUS_LIST,
    &FS_MASTER_ACCESS,
    &FSCP_AUTHENTICITY,
    &PORT_POWER_OFF_ON,
    &MASTER_IDENT,
    &FS_PD_IN_OUT,
    &SPDU_IN,
    &SPDU_OUT,
    &PD_IN,
    &PD_OUT,
    &PD_IN_OUT,
    &DS_DATA,
    &ON_REQUEST_DATA,
    &ON_REQUEST_READ,
    &VOID_BLOCK,
    &JOB_ERROR,
];

/// PortMode SAFETYCOM.
pub const SAFETYCOM: u8 = 49;
/// PortMode MIXEDSAFETYCOM.
pub const MIXEDSAFETYCOM: u8 = 50;
/// PortMode OSSDE.
pub const OSSDE: u8 = 51;
