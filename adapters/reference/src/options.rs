//! What can be asked of the reference FS-Device in its address: `inproc:reference-device?mutant=NAME&latency=2`.

use crate::Mutant;
use fsct_adapters::ClockKind;

/// How the reference FS-Device is to behave.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Options {
    /// `mutant=NAME`: a deliberate fault.
    pub mutant: Option<Mutant>,
    /// `latency=N`: exchanges until an answer stands in the image, 0..[`Options::MAX_LATENCY`]. Services do not wait.
    pub latency: u8,
    /// `clock=virtual` or `clock=real`: moved by the harness alone, or time itself.
    pub clock: ClockKind,
    /// `pulse_us=N`: width of the Ready pulse in microseconds, 1..10 000.
    pub pulse_us: u16,
}

impl Default for Options {
    fn default() -> Options {
        Options { mutant: None, latency: 0, clock: ClockKind::Virtual, pulse_us: 750 }
    }
}

/// An option that cannot be understood. Each text is one sentence and quotes what was given.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum OptionError {
    /// No option of this name.
    #[error("the reference DUT has no option {given:?}, did you mean {nearest:?}?")]
    UnknownOption {
        /// What was given.
        given: String,
        /// The known name most like it.
        nearest: &'static str,
    },
    /// No mutant of this name.
    #[error("the reference DUT has no mutant {given:?}, did you mean {nearest:?}?")]
    UnknownMutant {
        /// What was given.
        given: String,
        /// The known name most like it.
        nearest: &'static str,
    },
    /// No clock of this name.
    #[error("the reference DUT has no clock {given:?}, did you mean {nearest:?}?")]
    UnknownClock {
        /// What was given.
        given: String,
        /// The known name most like it.
        nearest: &'static str,
    },
    /// A latency that is no number or too great.
    #[error("the latency of the reference DUT is a number of exchanges from 0 to {max}, not {given:?}", max = Options::MAX_LATENCY)]
    BadLatency {
        /// What was given.
        given: String,
    },
    /// A Ready pulse it cannot give.
    #[error("the Ready pulse of the reference device is 1 to {max} microseconds wide, not {given:?}", max = Options::MAX_PULSE_US)]
    BadPulse {
        /// What was given.
        given: String,
    },
    /// A number of ports it cannot have.
    #[error("the reference master has 1 to {max} ports, not {given:?}", max = crate::MasterOptions::MAX_PORTS)]
    BadPorts {
        /// What was given.
        given: String,
    },
    /// A password that is no number.
    #[error("a password of the reference master is up to 8 hexadecimal digits, not {given:?}")]
    BadPassword {
        /// What was given.
        given: String,
    },
    /// A way of acknowledgment there is not.
    #[error("the reference gateway has ack=auto and ack=operator, not {given:?}")]
    BadAck {
        /// What was given.
        given: String,
    },
    /// The same option twice.
    #[error("the option {name:?} of the reference DUT is given twice")]
    Repeated {
        /// Which.
        name: &'static str,
    },
}

impl Options {
    /// The greatest latency in exchanges.
    pub const MAX_LATENCY: u8 = 8;

    /// The widest Ready pulse in microseconds.
    pub const MAX_PULSE_US: u16 = 10_000;

    const NAMES: [&'static str; 4] = ["mutant", "latency", "clock", "pulse_us"];
    pub(crate) const CLOCKS: [&'static str; 2] = ["virtual", "real"];

    /// Reads the decoded pairs of a query, in any order.
    ///
    /// # Errors
    /// [`OptionError`] for the first pair that names no option, gives it a value it cannot have, or repeats it.
    pub fn from_query(query: &[(String, String)]) -> Result<Options, OptionError> {
        let mut options = Options::default();
        for (known, value) in names(query, Options::NAMES)? {
            match known {
                "mutant" => options.mutant = Some(mutant(value)?),
                "latency" => options.latency = latency(value)?,
                "pulse_us" => options.pulse_us = pulse_us(value)?,
                _ => options.clock = clock(value)?,
            }
        }
        Ok(options)
    }
}

/// The pairs of a query with names that are known and stand there once.
pub(crate) fn names<'q, const N: usize>(
    query: &'q [(String, String)],
    all: [&'static str; N],
) -> Result<Vec<(&'static str, &'q str)>, OptionError> {
    let mut given: Vec<(&'static str, &'q str)> = Vec::new();
    for (name, value) in query {
        let Some(known) = all.into_iter().find(|known| known == name) else {
            return Err(OptionError::UnknownOption { given: name.clone(), nearest: nearest(name, all) });
        };
        if given.iter().any(|(name, _)| *name == known) {
            return Err(OptionError::Repeated { name: known });
        }
        given.push((known, value));
    }
    Ok(given)
}

fn mutant(value: &str) -> Result<Mutant, OptionError> {
    Mutant::from_name(value).ok_or_else(|| OptionError::UnknownMutant {
        given: value.to_owned(),
        nearest: nearest(value, Mutant::ALL.iter().map(|mutant| mutant.name())),
    })
}

pub(crate) fn latency(value: &str) -> Result<u8, OptionError> {
    let number = value.parse().ok().filter(|number| *number <= Options::MAX_LATENCY);
    number.ok_or_else(|| OptionError::BadLatency { given: value.to_owned() })
}

fn pulse_us(value: &str) -> Result<u16, OptionError> {
    let width = value.parse().ok().filter(|width| (1..=Options::MAX_PULSE_US).contains(width));
    width.ok_or_else(|| OptionError::BadPulse { given: value.to_owned() })
}

pub(crate) fn clock(value: &str) -> Result<ClockKind, OptionError> {
    match value {
        "virtual" => Ok(ClockKind::Virtual),
        "real" => Ok(ClockKind::Real),
        _ => Err(OptionError::UnknownClock { given: value.to_owned(), nearest: nearest(value, Options::CLOCKS) }),
    }
}

pub(crate) fn nearest(given: &str, known: impl IntoIterator<Item = &'static str>) -> &'static str {
    known.into_iter().min_by_key(|name| strsim::damerau_levenshtein(given, name)).unwrap_or_default()
}
