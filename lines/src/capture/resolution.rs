//! How exact the times of a file are.

use super::bad;
use super::channels::shown;
use crate::RecordingError;
use std::fmt;
use std::num::NonZeroU64;
use std::str::FromStr;

/// Femtoseconds of a second.
pub(super) const SECOND: u128 = 1_000_000_000_000_000;
/// Femtoseconds of a nanosecond.
const NANOSECOND: u128 = 1_000_000;

/// How many samples a second were taken of each channel.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct SampleRate(NonZeroU64);

impl SampleRate {
    /// A rate in hertz; `None` for 0.
    pub fn new(hertz: u64) -> Option<SampleRate> {
        NonZeroU64::new(hertz).map(SampleRate)
    }

    /// In hertz.
    pub fn hertz(self) -> u64 {
        self.0.get()
    }

    /// When a sample was taken, in whole nanoseconds since sample 0. Each time is divided anew: an error of rounding does not
    /// grow with the samples. `None` beyond 584 years.
    pub fn time_of(self, sample: u64) -> Option<u64> {
        u64::try_from(u128::from(sample) * 1_000_000_000 / u128::from(self.hertz())).ok()
    }
}

impl FromStr for SampleRate {
    type Err = RecordingError;

    /// `24 MHz`, `12.5MHz`, `500 kHz`, `24000000`.
    fn from_str(text: &str) -> Result<SampleRate, RecordingError> {
        let text = text.trim();
        let refused = || bad(format!("{} is no sample rate, such as 24 MHz", shown(text)));
        let unit = text.find(|c: char| !c.is_ascii_digit() && c != '.').unwrap_or(text.len());
        let (number, unit) = text.split_at(unit);
        let unit = unit.trim().to_ascii_lowercase();
        let power = match unit.strip_suffix("hz").unwrap_or(&unit) {
            "" => 0,
            "k" => 3,
            "m" => 6,
            "g" => 9,
            _ => return Err(refused()),
        };
        let (whole, part) = number.split_once('.').unwrap_or((number, ""));
        let part = part.trim_end_matches('0');
        if part.len() > power || whole.is_empty() {
            return Err(refused());
        }
        let hertz = format!("{whole}{part:0<power$}").parse().map_err(|_| refused())?;
        SampleRate::new(hertz).ok_or_else(|| bad("a sample rate of 0 gives samples no time"))
    }
}

impl fmt::Display for SampleRate {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.hertz() {
            hertz if hertz % 1_000_000 == 0 => write!(f, "{} MHz", hertz / 1_000_000),
            hertz if hertz % 1_000 == 0 => write!(f, "{} kHz", hertz / 1_000),
            hertz => write!(f, "{hertz} Hz"),
        }
    }
}

/// Who states a sample rate.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum StatedBy {
    /// The file.
    File,
    /// The user.
    User,
}

/// What a file or its user states about its times.
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq)]
pub struct Resolution {
    /// The step in which times are written, in femtoseconds; `None`: samples are counted.
    pub step_fs: Option<u128>,
    /// The rate the lines were sampled at.
    pub rate: Option<(SampleRate, StatedBy)>,
    /// An uncertainty that is stated as such, in nanoseconds.
    pub stated_ns: Option<u64>,
}

impl Resolution {
    /// How far the time of an edge may be off, either way: an edge seen in a sample was anywhere since the sample before,
    /// and a time that the steps do not meet is up to a step off. At least the nanosecond that times are cut to, unless the
    /// file counts nanoseconds and states the uncertainty itself.
    pub fn uncertainty_ns(&self) -> u64 {
        if let (None, Some(stated), Some(step)) = (self.rate, self.stated_ns, self.step_fs)
            && step.is_multiple_of(NANOSECOND)
        {
            return stated;
        }
        let step = self.step_fs.unwrap_or(0);
        let femtoseconds = match self.rate {
            None => step,
            Some((rate, _)) => {
                let hertz = u128::from(rate.hertz());
                let period = SECOND.div_ceil(hertz);
                let met = step == 0 || (SECOND.is_multiple_of(hertz) && period.is_multiple_of(step));
                if met { period } else { period.saturating_add(step) }
            }
        };
        let nanoseconds = u64::try_from(femtoseconds.div_ceil(NANOSECOND)).unwrap_or(u64::MAX);
        nanoseconds.max(self.stated_ns.unwrap_or(0)).max(1)
    }

    /// The rate a file states and that of its user, which must not contradict each other.
    pub(super) fn agreed(
        file: Option<SampleRate>,
        user: Option<SampleRate>,
    ) -> Result<Option<(SampleRate, StatedBy)>, RecordingError> {
        match (file, user) {
            (Some(file), Some(user)) if file != user => {
                Err(bad(format!("the file states a sample rate of {file}, not of {user}")))
            }
            (Some(file), _) => Ok(Some((file, StatedBy::File))),
            (None, user) => Ok(user.map(|user| (user, StatedBy::User))),
        }
    }
}

impl fmt::Display for Resolution {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.rate {
            Some((rate, StatedBy::File)) => write!(f, "sampled at {rate} as the file states")?,
            Some((rate, StatedBy::User)) => write!(f, "sampled at {rate} as the user states")?,
            None if self.stated_ns.is_some() => write!(f, "an uncertainty as the file states")?,
            None => write!(f, "no sample rate stated")?,
        }
        match self.step_fs {
            Some(step) => write!(f, ", times in steps of {}", duration(step)),
            None => Ok(()),
        }
    }
}

/// A duration in the largest unit that keeps it whole.
fn duration(femtoseconds: u128) -> String {
    let units = [(15, "s"), (12, "ms"), (9, "us"), (6, "ns"), (3, "ps"), (0, "fs")];
    let whole = |power: &u32| femtoseconds.is_multiple_of(10_u128.pow(*power));
    let (power, unit) = units.into_iter().find(|(power, _)| whole(power)).unwrap_or((0, "fs"));
    format!("{} {unit}", femtoseconds / 10_u128.pow(power))
}

/// A time in seconds, without the zeros at its end.
pub(super) fn seconds(femtoseconds: i128) -> String {
    let sign = if femtoseconds < 0 { "-" } else { "" };
    let (whole, part) = (femtoseconds.unsigned_abs() / SECOND, femtoseconds.unsigned_abs() % SECOND);
    let text = format!("{sign}{whole}.{part:015}");
    format!("{} s", text.trim_end_matches('0').trim_end_matches('.'))
}

/// Whole nanoseconds from one time to another; an error when they go back or are too far.
pub(super) fn nanoseconds(from_fs: i128, to_fs: i128) -> Option<u64> {
    let span = u128::try_from(to_fs.checked_sub(from_fs)?).ok()?;
    u64::try_from(span / NANOSECOND).ok()
}
