//! The state machines of the standard and the names their transitions have in records.

use crate::decode::Side;

/// A state machine a DUT has.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Machine {
    /// The safety communication layer of an FS-Device.
    FsDevice,
    /// The safety communication layer of an FS-Master, one a port.
    FsMaster,
    /// The OSSDe qualifier handler of an FS-Master (Table 43), one a port.
    Ossde,
}

impl Machine {
    /// All of them, in the order reports show them.
    pub const ALL: [Machine; 3] = [Machine::FsDevice, Machine::FsMaster, Machine::Ossde];

    /// Its name in reports.
    pub const fn title(self) -> &'static str {
        match self {
            Machine::FsDevice => "FS-Device",
            Machine::FsMaster => "FS-Master",
            Machine::Ossde => "OSSDe qualifier",
        }
    }

    /// The side that has it.
    pub const fn side(self) -> Side {
        match self {
            Machine::FsDevice => Side::Device,
            Machine::FsMaster | Machine::Ossde => Side::Master,
        }
    }

    /// Whether the goals of a role are about this machine: what follows what is told of the two SCLs.
    pub fn walks(self, role: &str) -> bool {
        matches!((self, role), (Machine::FsDevice, "device") | (Machine::FsMaster, "master"))
    }

    /// Its transitions in order. No two machines have one of the same name.
    pub fn transitions(self) -> Vec<String> {
        let (prefix, numbers) = match self {
            Machine::FsDevice => ("", 20..=31),
            Machine::FsMaster => ("", 1..=14),
            Machine::Ossde => ("OSSDe ", 1..=6),
        };
        numbers.map(|number| format!("{prefix}T{number}")).collect()
    }
}
