//! What an episode measures, and what it shows besides times.
//!
//! Nothing here knows a limit; the symbols are those of `testcases/limits.yaml`.

use crate::episode::{Episode, POWER_ON};
use crate::judge::{Bounds, Judged, Verdict, judge};
use crate::ossd::{Extremes, Ossd, TestPulses};
use std::fmt;

/// A quantity that is measured on the lines of a port.
#[derive(Copy, Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Quantity {
    /// Power-on to the rising edge of the Ready pulse (Table 7).
    TimeToReady,
    /// Width of the Ready pulse (Table 7).
    ReadyPulse,
    /// End of the Ready pulse to ready for wake-up (Table 7); told by a wake-up that was answered, or was not.
    ReadyForWakeUp,
    /// End of the Ready pulse to OSSD mode (Table 7): once to the first rising edge, once to both lines ON.
    ReadyToOssd,
    /// Width of a test pulse (Table 7): the narrowest and the widest of a line.
    TestPulse,
    /// From one test pulse to the next (Table 7 of v1.1): the shortest and the longest of a line.
    TestPulsePeriod,
    /// Width of a test pulse to the period it begins (Table 7 of iec2022), in parts of 1e9.
    TestPulseRatio,
    /// Test pulse of C/Q to the nearest one of I/Q (Table 7 of iec2022).
    TestPulseShift,
    /// Both outputs of an FS-Device at different levels (Table 7).
    Discrepancy,
    /// Discrepancy that an FS-Master port takes (Table 8); told by what the tester applied.
    PortDiscrepancy,
    /// Port power-on to port power-off without a wake-up: waiting time of state 10 (7.2).
    WaitForReady,
    /// Port power-off to power-on (T22; A.2.12).
    PowerOff,
    /// End of the last pulse on C/Q to the first wake-up (5.7, derived).
    ReadyToWakeUp,
    /// From one wake-up to the next (Figure 27): the shortest and the longest.
    WakeUpRetry,
    /// Wake-up to receive enable of the FS-Device (Figure 27); told by the first message that was answered.
    ReceiveEnable,
    /// FSP_Watchdog to the time-out of an FS-Device (A.2.6, 11.5.5); told by exchanges.
    DeviceWatchdog,
    /// FSP_Watchdog to the time-out of an FS-Master (A.2.6, 11.5.5); told by exchanges.
    MasterWatchdog,
    /// Power-on to the first valid process data of a non-safety application (5.8).
    FastStart,
    /// Power-on to the first valid safety data (5.8).
    FastStartSafety,
}

impl Quantity {
    /// All quantities with their symbols.
    pub const ALL: [(Quantity, &'static str); 19] = [
        (Quantity::TimeToReady, "t_2R"),
        (Quantity::ReadyPulse, "t_RP"),
        (Quantity::ReadyForWakeUp, "t_RW"),
        (Quantity::ReadyToOssd, "t_RO"),
        (Quantity::TestPulse, "t_i"),
        (Quantity::TestPulsePeriod, "T_p"),
        (Quantity::TestPulseRatio, "t_i/T_p"),
        (Quantity::TestPulseShift, "delta_t"),
        (Quantity::Discrepancy, "t_dis"),
        (Quantity::PortDiscrepancy, "t_disM"),
        (Quantity::WaitForReady, "t_wait"),
        (Quantity::PowerOff, "t_off"),
        (Quantity::ReadyToWakeUp, "t_WURQ"),
        (Quantity::WakeUpRetry, "T_DWU"),
        (Quantity::ReceiveEnable, "T_REN"),
        (Quantity::DeviceWatchdog, "DTimer"),
        (Quantity::MasterWatchdog, "MTimer"),
        (Quantity::FastStart, "t_start"),
        (Quantity::FastStartSafety, "t_start_FS"),
    ];

    /// Its symbol.
    pub fn symbol(self) -> &'static str {
        Quantity::ALL.into_iter().find(|entry| entry.0 == self).map_or("", |entry| entry.1)
    }

    /// The quantity with this symbol.
    pub fn from_symbol(symbol: &str) -> Option<Quantity> {
        Quantity::ALL.into_iter().find(|entry| entry.1 == symbol).map(|entry| entry.0)
    }

    /// Whether it has no unit and is counted in parts of 1e9; otherwise it is a time in nanoseconds.
    pub fn is_ratio(self) -> bool {
        self == Quantity::TestPulseRatio
    }
}

impl fmt::Display for Quantity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.symbol())
    }
}

/// A measured value: it lies in `low..=high`, and each end may be off by the uncertainty. In nanoseconds, a ratio in parts
/// of 1e9.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Measured {
    /// What was measured.
    pub quantity: Quantity,
    /// It is at least this.
    pub low: u64,
    /// It is at most this; equal to `low` for a plain value, [`u64::MAX`] where the end was not seen.
    pub high: u64,
    /// How far either end may be off.
    pub uncertainty: u64,
    /// Where it begins on the clock of the recording, in nanoseconds.
    pub at: u64,
    /// Number of the episode.
    pub episode: u64,
}

impl Measured {
    /// Verdict and margin.
    pub fn judge(&self, bounds: Bounds) -> Judged {
        judge(self.low, self.high, self.uncertainty, bounds)
    }
}

/// Everything an episode measures; `uncertainty_ns` is that of a single edge, either way.
pub fn measure(episode: &Episode, uncertainty_ns: u64) -> Vec<Measured> {
    let mut list = List { values: Vec::new(), edge: uncertainty_ns, episode: episode.number };
    // Without a rising edge the value is at least the time looked at.
    let open = |end: Option<u64>| end.map_or((episode.powered_until(), true), |end| (end, false));
    if let Some(on) = episode.on.filter(|_| episode.has_cq) {
        // A wake-up too early leaves octets on C/Q that may hide the pulse.
        if episode.ready.is_some() || episode.wake_ups.count == 0 && episode.ossd.is_none() {
            list.time(Quantity::TimeToReady, on, open(episode.ready.map(|pulse| pulse.rise)));
        }
    }
    if let Some(pulse) = episode.ready {
        list.time(Quantity::ReadyPulse, pulse.rise, open(pulse.fall));
        if let (Some(fall), Some(ossd)) = (pulse.fall, &episode.ossd) {
            for end in [episode.first_rise, ossd.both_on].into_iter().flatten() {
                list.time(Quantity::ReadyToOssd, fall, (end, false));
            }
        }
    }
    if let Some(ossd) = &episode.ossd {
        list.ossd(ossd, episode.has_iq);
    }
    if let (Some(on), 0) = (episode.on, episode.wake_ups.count) {
        list.time(Quantity::WaitForReady, on, open(episode.off));
    }
    if let (Some(off), Some(next)) = (episode.off, episode.next_on) {
        list.time(Quantity::PowerOff, off, (next, false));
    }
    if let (Some(fall), Some(first)) = (episode.last_pulse().and_then(|pulse| pulse.fall), episode.wake_ups.first)
        && episode.wake_ups.before_ready == 0
    {
        list.time(Quantity::ReadyToWakeUp, fall, (first, false));
    }
    list.extremes(Quantity::WakeUpRetry, episode.wake_ups.apart);
    list.values
}

struct List {
    values: Vec<Measured>,
    edge: u64,
    episode: u64,
}

impl List {
    /// From one edge to another, or to an end that was not seen.
    fn time(&mut self, quantity: Quantity, from: u64, (to, open): (u64, bool)) {
        let low = to.saturating_sub(from);
        self.push(quantity, low, if open { u64::MAX } else { low }, from);
    }

    fn push(&mut self, quantity: Quantity, low: u64, high: u64, at: u64) {
        let uncertainty = self.edge.saturating_mul(2);
        self.values.push(Measured { quantity, low, high, uncertainty, at, episode: self.episode });
    }

    /// The smallest and the largest.
    fn extremes(&mut self, quantity: Quantity, extremes: Option<Extremes>) {
        let Some(Extremes { min, max, .. }) = extremes else { return };
        self.push(quantity, min.value, min.value, min.at);
        if max != min {
            self.push(quantity, max.value, max.value, max.at);
        }
    }

    fn ossd(&mut self, ossd: &Ossd, has_iq: bool) {
        self.pulses(&ossd.cq);
        if has_iq {
            self.pulses(&ossd.iq);
            self.extremes(Quantity::TestPulseShift, ossd.shift);
        }
        if let Some(longest) = ossd.discrepancy {
            self.push(Quantity::Discrepancy, longest.low, longest.high, longest.at);
        }
    }

    fn pulses(&mut self, pulses: &TestPulses) {
        self.extremes(Quantity::TestPulse, pulses.width);
        self.extremes(Quantity::TestPulsePeriod, pulses.period);
        if let Some(ratio) = pulses.ratio {
            let off = self.edge.saturating_mul(2);
            let (low, high) = parts(ratio.width, ratio.period);
            let (least, _) = parts(ratio.width.saturating_sub(off), ratio.period.saturating_add(off));
            let (_, most) = parts(ratio.width.saturating_add(off), ratio.period.saturating_sub(off));
            let uncertainty = (low - least.min(low)).max(most.max(high) - high);
            self.values.push(Measured {
                quantity: Quantity::TestPulseRatio,
                low,
                high,
                uncertainty,
                at: ratio.at,
                episode: self.episode,
            });
        }
    }
}

/// a / b in parts of 1e9, rounded down and up.
fn parts(a: u64, b: u64) -> (u64, u64) {
    let (a, b) = (u128::from(a) * 1_000_000_000, u128::from(b.max(1)));
    let narrow = |value: u128| u64::try_from(value).unwrap_or(u64::MAX);
    (narrow(a / b), narrow(a.div_ceil(b)))
}

/// Something an episode has to show that is no time.
#[derive(Copy, Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Claim {
    /// FS-Device with OSSDe: I/Q is OFF from power-on to the end of the Ready pulse (5.3.3, Figure 21).
    IqOff,
    /// FS-Device: one Ready pulse and no other pulse on C/Q before a wake-up or OSSD mode (5.3.3, 7.3).
    OneReadyPulse,
    /// FS-Device with OSSDe: both lines are OFF from the end of the Ready pulse for t_RO at least (Table 7, Figure 21).
    OffUntilOssd,
    /// FS-Master, safety port: no wake-up before a Ready pulse (7.2, T20 and T21).
    NoEarlyWakeUp,
    /// FS-Master, safety port: without a Ready pulse, L+ goes OFF and ON again (7.2, T22).
    PowerCycle,
}

/// What the claims need to know besides the lines.
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq)]
pub struct Given {
    /// How far an edge may be off either way, in nanoseconds.
    pub uncertainty_ns: u64,
    /// The FS-Device has OSSDe (feature level b or c); without it C/Q and I/Q may be switching signals.
    pub ossde: bool,
    /// The smallest t_RO permitted, in nanoseconds.
    pub ossd_not_before: Option<u64>,
    /// The longest waiting time for the Ready pulse with every margin, in nanoseconds.
    pub wait_at_most: Option<u64>,
}

/// What an episode says to a claim.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Answer {
    /// It is so.
    Holds,
    /// It is not so; where on the clock of the recording.
    Broken(u64),
    /// The episode does not tell.
    Unknown,
}

impl Claim {
    /// All claims with their names in cases and reports.
    pub const ALL: [(Claim, &'static str); 5] = [
        (Claim::IqOff, "iq-off-in-self-test"),
        (Claim::OneReadyPulse, "one-ready-pulse"),
        (Claim::OffUntilOssd, "off-until-ossd"),
        (Claim::NoEarlyWakeUp, "no-wake-up-before-ready"),
        (Claim::PowerCycle, "power-cycle"),
    ];

    /// Its name.
    pub fn name(self) -> &'static str {
        Claim::ALL.into_iter().find(|entry| entry.0 == self).map_or("", |entry| entry.1)
    }

    /// The claim in words.
    pub fn about(self) -> &'static str {
        match self {
            Claim::IqOff => "I/Q is OFF from power-on to the end of the Ready pulse",
            Claim::OneReadyPulse => "one Ready pulse on C/Q, and no other pulse before a wake-up or OSSD mode",
            Claim::OffUntilOssd => "both lines are OFF from the end of the Ready pulse for t_RO at least",
            Claim::NoEarlyWakeUp => "no wake-up before the Ready pulse",
            Claim::PowerCycle => "without a Ready pulse L+ goes OFF and ON again",
        }
    }

    /// Clause it is from.
    pub fn clause(self) -> &'static str {
        match self {
            Claim::IqOff => "5.3.3, Figure 21",
            Claim::OneReadyPulse => "5.3.3, 7.3 Table 11 T13",
            Claim::OffUntilOssd => "5.4 Table 7, Figure 21",
            Claim::NoEarlyWakeUp => "7.2 Table 10 T20 and T21",
            Claim::PowerCycle => "7.2 Table 10 T22",
        }
    }

    /// What the episode says to it.
    pub fn ask(self, episode: &Episode, given: Given) -> Answer {
        match self {
            Claim::IqOff => iq_off(episode, given),
            Claim::OneReadyPulse => one_ready_pulse(episode, given),
            Claim::OffUntilOssd => off_until_ossd(episode, given),
            Claim::NoEarlyWakeUp => no_early_wake_up(episode),
            Claim::PowerCycle => power_cycle(episode, given),
        }
    }
}

fn iq_off(episode: &Episode, given: Given) -> Answer {
    let before = episode.iq_before;
    if !given.ossde || !episode.has_iq {
        return Answer::Unknown;
    }
    if let Some(first) = before.first {
        return Answer::Broken(first);
    }
    if let (Some(until), Some(on)) = (before.at_power_on, episode.on) {
        // What is high only while the supply comes up says nothing.
        return if until.saturating_sub(on) > POWER_ON { Answer::Broken(on) } else { Answer::Unknown };
    }
    match (episode.on, episode.ready.and_then(|pulse| pulse.fall)) {
        (Some(_), Some(_)) => Answer::Holds,
        _ => Answer::Unknown,
    }
}

fn one_ready_pulse(episode: &Episode, given: Given) -> Answer {
    if !episode.has_cq {
        return Answer::Unknown;
    }
    match (episode.ready, episode.last_further) {
        (_, Some(further)) if given.ossde => Answer::Broken(further.rise),
        (_, Some(_)) => Answer::Unknown,
        (Some(pulse), None) if episode.on.is_some() && pulse.fall.is_some() => Answer::Holds,
        // OSSD mode from power-on on.
        (None, None) if given.ossde && episode.on.is_some() => {
            match (episode.ossd.and(episode.first_rise), episode.wake_ups.count) {
                (Some(rise), 0) => Answer::Broken(rise),
                _ => Answer::Unknown,
            }
        }
        _ => Answer::Unknown,
    }
}

fn off_until_ossd(episode: &Episode, given: Given) -> Answer {
    let fall = episode.ready.and_then(|pulse| pulse.fall);
    let (true, Some(fall), Some(min)) = (given.ossde && episode.has_iq, fall, given.ossd_not_before) else {
        return Answer::Unknown;
    };
    let seen = episode.first_rise.or(episode.wake_ups.first).unwrap_or(episode.powered_until());
    let length = seen.saturating_sub(fall);
    let judged = judge(length, length, given.uncertainty_ns.saturating_mul(2), Bounds { min: Some(min), max: None });
    match (judged.verdict, episode.first_rise) {
        (Verdict::Pass, _) => Answer::Holds,
        (Verdict::Fail, Some(rise)) => Answer::Broken(rise),
        _ => Answer::Unknown,
    }
}

fn no_early_wake_up(episode: &Episode) -> Answer {
    match (episode.on, episode.wake_ups.first) {
        (Some(_), Some(first)) if episode.wake_ups.before_ready > 0 && episode.has_cq => Answer::Broken(first),
        (_, Some(_)) if episode.wake_ups.before_ready == 0 => Answer::Holds,
        _ => Answer::Unknown,
    }
}

fn power_cycle(episode: &Episode, given: Given) -> Answer {
    if episode.ready.is_some() || episode.wake_ups.count > 0 || !episode.has_cq {
        return Answer::Unknown;
    }
    match (episode.on, episode.off, episode.next_on) {
        (Some(_), Some(_), Some(_)) => Answer::Holds,
        (Some(on), None, _) => {
            let waited = episode.until.saturating_sub(on).saturating_sub(given.uncertainty_ns.saturating_mul(2));
            match given.wait_at_most {
                Some(longest) if waited > longest => Answer::Broken(on.saturating_add(longest)),
                _ => Answer::Unknown,
            }
        }
        _ => Answer::Unknown,
    }
}
