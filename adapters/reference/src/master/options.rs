//! What can be asked of the reference FS-Master in its address: `inproc:reference-master?mutant=NAME&latency=2`.

use super::MasterMutant;
use crate::options::{OptionError, Options, clock, latency, names, nearest};
use fsct_adapters::ClockKind;

/// How the reference FS-Master is to behave.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct MasterOptions {
    /// `mutant=NAME`: a deliberate fault.
    pub mutant: Option<MasterMutant>,
    /// `latency=N`: exchanges until a new SPDU stands in the image, 0..[`Options::MAX_LATENCY`]. Services do not wait.
    pub latency: u8,
    /// `clock=virtual` or `clock=real`: moved by the harness alone, or time itself.
    pub clock: ClockKind,
    /// `ports=N`: number of ports, 1..8.
    pub ports: u8,
    /// `password=HEX`: FSMasterPassword, 0 for none (iec2022).
    pub password: u32,
    /// `reset_password=HEX`: FSResetMasterPW, 0 for none (iec2022).
    pub reset_password: u32,
}

impl Default for MasterOptions {
    fn default() -> MasterOptions {
        let Options { latency, clock, .. } = Options::default();
        MasterOptions { mutant: None, latency, clock, ports: 2, password: 0, reset_password: 0 }
    }
}

impl MasterOptions {
    /// The greatest number of ports.
    pub const MAX_PORTS: u8 = 8;

    const NAMES: [&'static str; 6] = ["mutant", "latency", "clock", "ports", "password", "reset_password"];

    /// Reads the decoded pairs of a query, in any order.
    ///
    /// # Errors
    /// [`OptionError`] for the first pair that names no option, gives it a value it cannot have, or repeats it.
    pub fn from_query(query: &[(String, String)]) -> Result<MasterOptions, OptionError> {
        let mut options = MasterOptions::default();
        for (known, value) in names(query, MasterOptions::NAMES)? {
            match known {
                "mutant" => options.mutant = Some(mutant(value)?),
                "latency" => options.latency = latency(value)?,
                "clock" => options.clock = clock(value)?,
                "ports" => {
                    let number = value.parse().ok().filter(|ports| (1..=MasterOptions::MAX_PORTS).contains(ports));
                    options.ports = number.ok_or_else(|| OptionError::BadPorts { given: value.to_owned() })?;
                }
                "password" => options.password = password(value)?,
                _ => options.reset_password = password(value)?,
            }
        }
        Ok(options)
    }
}

fn mutant(value: &str) -> Result<MasterMutant, OptionError> {
    MasterMutant::from_name(value).ok_or_else(|| OptionError::UnknownMutant {
        given: value.to_owned(),
        nearest: nearest(value, MasterMutant::ALL.iter().map(|mutant| mutant.name())),
    })
}

fn password(value: &str) -> Result<u32, OptionError> {
    let digits = value.len() <= 8 && value.bytes().all(|digit| digit.is_ascii_hexdigit());
    let number = u32::from_str_radix(value, 16).ok().filter(|_| digits);
    number.ok_or_else(|| OptionError::BadPassword { given: value.to_owned() })
}
