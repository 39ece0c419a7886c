//! Episodes: what the lines of a port do from one power-on of L+ to the next (Figures 21 and 27).
//!
//! One machine for a DUT that tells its edges live and for a recording, in memory that does not grow. It knows no limits and
//! no roles: for an FS-Device the Ready pulse comes from the DUT and wake-up and L+ from the tester, for an FS-Master the
//! other way round. What edges cannot tell is left out, never guessed.

use crate::ossd::{Extremes, Ossd, Watch};
use crate::{Edge, Levels, Recording, RecordingError};
use fsct_adapters::Line;

/// Width of a wake-up pulse, in nanoseconds. From the base standard: it tells one apart and is never a limit.
pub const WAKE_UP: std::ops::RangeInclusive<u64> = 75_000..=85_000;

/// The most by which the width of a wake-up pulse may be uncertain where it has to be told from other pulses, in nanoseconds.
pub const MOST_BLUR: u64 = 20_000;

/// Quiet on C/Q around a wake-up pulse once there is communication, in nanoseconds. The octets of COM2 hold pulses of three
/// bits (78 us), but none without another edge within eleven bits (286 us).
const WAKE_UP_QUIET: u64 = 300_000;

/// Quiet on C/Q around a Ready pulse where there may be communication, in nanoseconds: more than an octet of COM1 (2.3 ms).
const READY_QUIET: u64 = 2_500_000;

/// The narrowest pulse taken for a Ready pulse where there may be communication, in nanoseconds.
const READY_LEAST: u64 = 250_000;

/// High for longer than this is ON and no pulse, in nanoseconds: ten times the widest Ready pulse. It counts where both
/// lines are high, or one after the Ready pulse.
const ON_AFTER: u64 = 10_000_000;

/// A line that is still high this long after L+ came is high on purpose, in nanoseconds (ramp of Figure 25, iec2022).
pub const POWER_ON: u64 = 5_000_000;

/// How wake-ups show.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum WakeUps {
    /// As edges of [`Line::WakeUp`]; C/Q does not carry them.
    Told,
    /// As pulses of [`WAKE_UP`] on C/Q.
    Pulses,
}

/// A high pulse.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Pulse {
    /// Rising edge, in nanoseconds.
    pub rise: u64,
    /// Falling edge, in nanoseconds; `None`: still high when the episode or its power ended.
    pub fall: Option<u64>,
}

/// Wake-ups of an episode.
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq)]
pub struct WakeUpsSeen {
    /// How many.
    pub count: u64,
    /// How many of them with no Ready pulse before.
    pub before_ready: u64,
    /// The first.
    pub first: Option<u64>,
    /// The last.
    pub last: Option<u64>,
    /// From one to the next (T_DWU of the base standard), in nanoseconds.
    pub apart: Option<Extremes>,
}

/// What I/Q did before the end of the Ready pulse, when it has to be OFF (5.3.3, Figure 21).
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq)]
pub struct IqBefore {
    /// Rising edges.
    pub pulses: u64,
    /// The first of them.
    pub first: Option<u64>,
    /// High when L+ came, until then; at most the time known.
    pub at_power_on: Option<u64>,
}

/// One power-on of the port and what followed. Times in nanoseconds on the clock of the recording.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Episode {
    /// 0 for the first.
    pub number: u64,
    /// From when on it is known: power-on, or the start of the recording.
    pub begin: u64,
    /// L+ comes; `None`: the recording does not show it.
    pub on: Option<u64>,
    /// L+ goes.
    pub off: Option<u64>,
    /// L+ comes again, which ends the episode.
    pub next_on: Option<u64>,
    /// Until when it is known.
    pub until: u64,
    /// Whether C/Q is in the recording.
    pub has_cq: bool,
    /// Whether I/Q is in the recording.
    pub has_iq: bool,
    /// The first high pulse on C/Q that is no wake-up.
    pub ready: Option<Pulse>,
    /// High pulses on C/Q after it that are neither wake-up nor OSSD mode, and the last of them.
    pub further: u64,
    /// See `further`.
    pub last_further: Option<Pulse>,
    /// I/Q until the Ready pulse is over.
    pub iq_before: IqBefore,
    /// The first rising edge on either line after the Ready pulse that is no wake-up (t_RO is measured to it).
    pub first_rise: Option<u64>,
    /// Wake-ups.
    pub wake_ups: WakeUpsSeen,
    /// The first edge on C/Q after a wake-up.
    pub communication: Option<u64>,
    /// OSSD mode, watched as long as no wake-up has come.
    pub ossd: Option<Ossd>,
}

impl Episode {
    /// The last high pulse on C/Q before the first wake-up: the Ready pulse unless others followed it.
    pub fn last_pulse(&self) -> Option<Pulse> {
        self.last_further.or(self.ready)
    }

    /// Until when the port had power, as far as known.
    pub fn powered_until(&self) -> u64 {
        self.off.unwrap_or(self.until)
    }
}

#[derive(Clone, Debug, PartialEq, Eq)]
enum Phase {
    /// No power.
    Off,
    /// Power, nothing on C/Q yet.
    SelfTest,
    /// The Ready pulse is over, no wake-up, no OSSD mode.
    Waiting,
    /// After a wake-up (`true`), or somewhere in the life of a port (`false`): C/Q may carry octets.
    Talking(bool),
    /// OSSD mode.
    Ossd(Box<Watch>),
    /// OSSD mode was left by a wake-up; nothing is measured any more.
    Left,
}

/// A pulse that is what it looks like if nothing follows too soon.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
struct Candidate {
    rise: u64,
    fall: u64,
    /// A wake-up; otherwise a Ready pulse.
    wake_up: bool,
    /// I/Q was high during it.
    iq: bool,
    /// Rising edge of a pulse like a wake-up that followed a Ready pulse.
    woken: Option<u64>,
}

impl Candidate {
    fn quiet(&self) -> u64 {
        if self.wake_up || self.woken.is_some() { WAKE_UP_QUIET } else { READY_QUIET }
    }
}

/// The machine: edges in, episodes out.
#[derive(Clone, Debug)]
pub struct Decoder {
    wake_ups: WakeUps,
    /// How much narrower or wider than [`WAKE_UP`] a wake-up may look, in nanoseconds.
    blur: u64,
    now: u64,
    has_cq: bool,
    cq: bool,
    iq: Option<bool>,
    /// Since when a line is high, if its rising edge was seen in this episode.
    cq_rise: Option<u64>,
    iq_rise: Option<u64>,
    /// The last falling edge of I/Q in this episode.
    iq_fall: Option<u64>,
    /// The last edge on C/Q, or the begin of the episode.
    cq_edge: u64,
    /// The quiet before the current pulse on C/Q.
    quiet: u64,
    phase: Phase,
    candidate: Option<Candidate>,
    next: u64,
    episode: Option<Episode>,
}

impl Decoder {
    /// Begins at `start` with the levels there. With L+ low nothing is known before it comes; with L+ high, or not in the
    /// recording, the first episode begins here and whether this is a start-up shows later.
    pub fn new(start: u64, levels: Levels, wake_ups: WakeUps) -> Decoder {
        let mut decoder = Decoder {
            wake_ups,
            blur: 0,
            now: start,
            has_cq: levels.cq.is_some(),
            cq: levels.cq.unwrap_or(false),
            iq: levels.iq,
            cq_rise: None,
            iq_rise: None,
            iq_fall: None,
            cq_edge: start,
            quiet: 0,
            phase: Phase::Off,
            candidate: None,
            next: 0,
            episode: None,
        };
        if levels.power != Some(false) {
            decoder.begin(start, None);
            decoder.phase = Phase::Talking(false);
        }
        decoder
    }

    /// An edge may be off by so much either way, in nanoseconds, so wake-up pulses may look narrower or wider than they are.
    /// What counts as one grows by [`MOST_BLUR`] at the most.
    #[must_use]
    pub fn blurred(mut self, uncertainty_ns: u64) -> Decoder {
        self.blur = uncertainty_ns.saturating_mul(2).min(MOST_BLUR);
        self
    }

    /// The episode that is going on, as far as it is decided.
    pub fn current(&self) -> Option<&Episode> {
        self.episode.as_ref()
    }

    /// OSSD mode of the episode that is going on, as far as it is decided.
    pub fn ossd(&self) -> Option<&Ossd> {
        match &self.phase {
            Phase::Ossd(watch) => Some(&watch.seen),
            _ => self.episode.as_ref().and_then(|episode| episode.ossd.as_ref()),
        }
    }

    /// No edge has come until `now`. Never needed for a right result, only to see it sooner.
    pub fn advance(&mut self, now: u64) {
        let now = now.max(self.now);
        self.settle(now);
        self.now = now;
        if let Some(episode) = &mut self.episode {
            episode.until = now;
        }
    }

    /// Takes the next edge; gives the episode that ended with it. An edge that is earlier than the last counts as simultaneous.
    pub fn edge(&mut self, edge: Edge) -> Option<Episode> {
        self.advance(edge.at);
        let at = self.now;
        match edge.line {
            Line::Power => return self.power(edge.level, at),
            Line::WakeUp => {
                if edge.level && self.wake_ups == WakeUps::Told {
                    self.told_wake_up(at);
                }
            }
            Line::Cq => {
                if self.has_cq && self.cq != edge.level {
                    self.cq = edge.level;
                    self.cq_changes(at);
                }
            }
            Line::Iq => {
                if self.iq.is_some_and(|level| level != edge.level) {
                    self.iq = Some(edge.level);
                    self.iq_changes(edge.level, at);
                }
            }
        }
        None
    }

    /// Nothing comes after `end`; gives the last episode.
    pub fn finish(mut self, end: u64) -> Option<Episode> {
        self.advance(end);
        let end = self.now;
        self.close(end);
        self.episode
    }

    fn begin(&mut self, at: u64, on: Option<u64>) {
        self.cq_rise = None;
        self.iq_rise = None;
        self.iq_fall = None;
        self.cq_edge = at;
        self.quiet = 0;
        self.candidate = None;
        self.phase = Phase::SelfTest;
        let mut iq_before = IqBefore::default();
        if on.is_some() && self.iq == Some(true) {
            iq_before.at_power_on = Some(at);
        }
        self.episode = Some(Episode {
            number: self.next,
            begin: at,
            on,
            off: None,
            next_on: None,
            until: at,
            has_cq: self.has_cq,
            has_iq: self.iq.is_some(),
            ready: None,
            further: 0,
            last_further: None,
            iq_before,
            first_rise: None,
            wake_ups: WakeUpsSeen::default(),
            communication: None,
            ossd: None,
        });
        self.next += 1;
    }

    fn power(&mut self, level: bool, at: u64) -> Option<Episode> {
        let off = self.phase == Phase::Off;
        match (level, off) {
            (true, true) => {
                let ended = self.episode.take().map(|mut episode| {
                    episode.next_on = Some(at);
                    episode
                });
                self.begin(at, Some(at));
                ended
            }
            (false, false) => {
                self.close(at);
                if let Some(episode) = &mut self.episode {
                    episode.off = Some(at);
                }
                None
            }
            _ => None,
        }
    }

    /// Power or recording end: what is open stays open.
    fn close(&mut self, at: u64) {
        self.candidate = None;
        match std::mem::replace(&mut self.phase, Phase::Off) {
            Phase::SelfTest => self.iq_high_until(at),
            Phase::Ossd(mut watch) => {
                watch.finish(at);
                if let Some(episode) = &mut self.episode {
                    episode.ossd = Some(watch.seen);
                }
            }
            _ => {}
        }
        self.cq_rise = None;
        self.iq_rise = None;
    }

    /// I/Q has been high since L+ came and is so until now.
    fn iq_high_until(&mut self, at: u64) {
        if self.iq == Some(true)
            && self.iq_rise.is_none()
            && let Some(until) = self.episode.as_mut().and_then(|episode| episode.iq_before.at_power_on.as_mut())
        {
            *until = at;
        }
    }

    /// Draws what follows from no edge having come until `now`.
    fn settle(&mut self, now: u64) {
        // What one thing leads to may be due as well.
        while self.due(now) {}
    }

    /// One step of it; whether the phase has changed.
    fn due(&mut self, now: u64) -> bool {
        let on = |since: u64| now.saturating_sub(since) > ON_AFTER;
        match &mut self.phase {
            Phase::Off | Phase::Left => {}
            Phase::Ossd(watch) => watch.settle(now),
            Phase::SelfTest => {
                if let (Some(cq), Some(iq)) = (self.cq_rise, self.iq_rise)
                    && on(cq.max(iq))
                {
                    return self.begin_ossd();
                }
                if let Some(rise) = self.cq_rise {
                    let told = self.wake_ups == WakeUps::Told;
                    if told || now.saturating_sub(rise) > *WAKE_UP.end() + self.blur {
                        self.set_ready(Pulse { rise, fall: None });
                    }
                }
            }
            Phase::Waiting => {
                if self.cq_rise.is_some_and(on) || self.iq_rise.is_some_and(on) {
                    return self.begin_ossd();
                }
            }
            Phase::Talking(woken) => {
                // Octets hold no high this long: both lines ON is OSSD mode. Not looked for after a wake-up.
                let since = self.cq_edge.max(self.iq_rise.unwrap_or(0));
                if !*woken && self.cq && self.iq == Some(true) && on(since) && self.candidate.is_none() {
                    self.phase = Phase::Ossd(Box::new(Watch::new(true, self.iq, since, since)));
                    return true;
                }
                if self.candidate.is_some_and(|it| now.saturating_sub(self.cq_edge) >= it.quiet()) {
                    self.accept();
                    return true;
                }
            }
        }
        false
    }

    fn cq_changes(&mut self, at: u64) {
        if self.cq {
            self.quiet = at.saturating_sub(self.cq_edge);
        }
        self.cq_edge = at;
        let rise = if self.cq { self.cq_rise.replace(at) } else { self.cq_rise.take() };
        match &mut self.phase {
            Phase::Off | Phase::Left => {}
            Phase::Ossd(watch) => watch.edge(Line::Cq, self.cq, at),
            Phase::SelfTest => {
                if let Some(rise) = rise {
                    self.self_test_pulse(rise, at);
                }
            }
            Phase::Waiting => match rise {
                Some(rise) => self.waiting_pulse(rise, at),
                None => {
                    if self.iq == Some(true) {
                        self.begin_ossd();
                    }
                }
            },
            Phase::Talking(woken) => {
                if *woken && let Some(episode) = &mut self.episode {
                    episode.communication.get_or_insert(at);
                }
                match (rise, self.episode.as_mut().and_then(|episode| episode.ready.as_mut())) {
                    // The wake-up came while the Ready pulse was still running.
                    (Some(rise), Some(ready)) if ready.rise == rise => ready.fall = Some(at),
                    (Some(rise), _) => self.talking_pulse(rise, at),
                    _ => {}
                }
            }
        }
    }

    fn iq_changes(&mut self, level: bool, at: u64) {
        let was = self.iq_rise;
        self.iq_rise = level.then_some(at);
        if !level {
            self.iq_fall = Some(at);
        }
        match &mut self.phase {
            Phase::Ossd(watch) => watch.edge(Line::Iq, level, at),
            Phase::SelfTest => {
                if let Some(episode) = &mut self.episode {
                    if level {
                        episode.iq_before.pulses += 1;
                        episode.iq_before.first.get_or_insert(at);
                    } else if was.is_none() {
                        episode.iq_before.at_power_on = Some(at);
                    }
                }
            }
            Phase::Waiting if level => {
                self.first_rise(at);
                if self.cq {
                    self.begin_ossd();
                }
            }
            _ => {}
        }
    }

    fn is_wake_up(&self, rise: u64, fall: u64) -> bool {
        let width = fall.saturating_sub(rise);
        let (least, most) = (*WAKE_UP.start() - self.blur, *WAKE_UP.end() + self.blur);
        self.wake_ups == WakeUps::Pulses && (least..=most).contains(&width)
    }

    fn self_test_pulse(&mut self, rise: u64, fall: u64) {
        if self.is_wake_up(rise, fall) {
            self.wake_up(rise);
        } else {
            self.iq_high_until(fall);
            self.set_ready(Pulse { rise, fall: Some(fall) });
            self.phase = Phase::Waiting;
        }
    }

    fn waiting_pulse(&mut self, rise: u64, fall: u64) {
        if self.is_wake_up(rise, fall) {
            self.wake_up(rise);
        } else {
            self.first_rise(rise);
            if let Some(episode) = &mut self.episode {
                episode.further += 1;
                episode.last_further = Some(Pulse { rise, fall: Some(fall) });
            }
        }
    }

    /// A pulse where there may be octets: what it is depends on the quiet around it.
    fn talking_pulse(&mut self, rise: u64, fall: u64) {
        let wake_up = self.is_wake_up(rise, fall);
        if let Some(ready) = self.candidate.take() {
            // A wake-up may follow a Ready pulse at once. Anything else so soon, and both belong to octets.
            if !ready.wake_up && ready.woken.is_none() && wake_up {
                self.candidate = Some(Candidate { woken: Some(rise), ..ready });
            }
            return;
        }
        let no_ready = self.episode.as_ref().is_some_and(|episode| episode.ready.is_none());
        let ready = no_ready && fall.saturating_sub(rise) >= READY_LEAST && self.quiet >= READY_QUIET;
        if (wake_up && self.quiet >= WAKE_UP_QUIET) || ready {
            let iq = self.iq == Some(true) || self.iq_fall.is_some_and(|iq| iq > rise);
            self.candidate = Some(Candidate { rise, fall, wake_up, iq, woken: None });
        }
    }

    /// Nothing has followed the candidate too soon: it is what it looked like.
    fn accept(&mut self) {
        let (Some(it), Some(episode)) = (self.candidate.take(), &mut self.episode) else { return };
        if episode.communication == Some(it.rise) {
            episode.communication = None;
        }
        if it.wake_up {
            return self.wake_up(it.rise);
        }
        if it.iq {
            episode.iq_before.pulses += 1;
            episode.iq_before.first.get_or_insert(it.rise);
        }
        self.set_ready(Pulse { rise: it.rise, fall: Some(it.fall) });
        self.phase = Phase::Waiting;
        if let Some(rise) = it.woken {
            return self.wake_up(rise);
        }
        // What came meanwhile.
        if let Some(rise) = self.iq_rise.filter(|rise| *rise > it.fall) {
            self.first_rise(rise);
        }
        if self.cq && self.iq == Some(true) {
            self.begin_ossd();
        }
    }

    fn told_wake_up(&mut self, at: u64) {
        if self.candidate.is_some_and(|it| !it.wake_up) {
            self.accept();
        }
        // A Ready pulse that is still running has begun before it.
        if let (Phase::SelfTest, Some(rise)) = (&self.phase, self.cq_rise) {
            self.set_ready(Pulse { rise, fall: None });
        }
        if self.phase != Phase::Off {
            self.wake_up(at);
        }
    }

    fn wake_up(&mut self, at: u64) {
        let Some(episode) = &mut self.episode else { return };
        let seen = &mut episode.wake_ups;
        seen.count += 1;
        seen.before_ready += u64::from(episode.ready.is_none());
        if let Some(last) = seen.last {
            Extremes::add(&mut seen.apart, at.saturating_sub(last), last);
        }
        seen.first.get_or_insert(at);
        seen.last = Some(at);
        match std::mem::replace(&mut self.phase, Phase::Talking(true)) {
            Phase::Ossd(mut watch) => {
                watch.settle(at);
                episode.ossd = Some(watch.seen);
                self.phase = Phase::Left;
            }
            Phase::Left => self.phase = Phase::Left,
            _ => {}
        }
    }

    fn set_ready(&mut self, pulse: Pulse) {
        if let Some(episode) = &mut self.episode {
            episode.ready = Some(pulse);
        }
    }

    fn first_rise(&mut self, at: u64) {
        if let Some(episode) = &mut self.episode {
            episode.first_rise = Some(episode.first_rise.map_or(at, |known| known.min(at)));
        }
    }

    /// OSSD mode has begun: both lines are high, or one has been for long. Always true.
    fn begin_ossd(&mut self) -> bool {
        let mut earliest = 0;
        if let Some(episode) = &mut self.episode {
            match episode.ready {
                // What looked like a Ready pulse was the first output going ON.
                Some(Pulse { fall: None, .. }) => episode.ready = None,
                Some(Pulse { fall: Some(fall), .. }) => earliest = fall,
                None => {}
            }
            earliest = earliest.max(episode.begin);
        }
        let rise = |rise: Option<u64>| rise.map(|rise| rise.max(earliest));
        let (cq, iq) = (rise(self.cq_rise), rise(self.iq_rise));
        let first = cq.into_iter().chain(iq).min().unwrap_or(earliest);
        let last = cq.into_iter().chain(iq).max().unwrap_or(earliest);
        self.first_rise(first);
        self.phase = Phase::Ossd(Box::new(Watch::new(self.cq, self.iq, first, last)));
        true
    }
}

/// Decodes a whole recording, which begins at 0, one episode after the other.
///
/// # Errors
/// [`RecordingError`] when the recording cannot be read on; the episodes before were given.
pub fn decode(
    recording: &mut dyn Recording,
    wake_ups: WakeUps,
    mut each: impl FnMut(&Episode),
) -> Result<(), RecordingError> {
    let mut decoder = Decoder::new(0, recording.levels(), wake_ups).blurred(recording.uncertainty_ns());
    while let Some(edge) = recording.next_edge()? {
        if let Some(episode) = decoder.edge(edge) {
            each(&episode);
        }
    }
    if let Some(episode) = decoder.finish(recording.end()) {
        each(&episode);
    }
    Ok(())
}
