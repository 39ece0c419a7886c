//! What an FS-Device drives on C/Q and I/Q while there is no communication: self-test, Ready pulse, readiness for the wake-up,
//! and OSSDe operation with its test pulses (5.3.3, 5.7, 7.3; Figures 19, 21 and 27).

use crate::Mutant;
use fsct_adapters::{Edition, Line};
use std::collections::VecDeque;

const US: u64 = 1_000;
const MS: u64 = 1_000 * US;

/// Power-on to Ready pulse.
const SELF_TEST_NS: u64 = 100 * MS;
/// End of the Ready pulse to readiness for the wake-up.
const READY_NS: u64 = 20 * US;
/// Width of a test pulse.
const TEST_PULSE_NS: u64 = 500 * US;
/// Time between two test pulses of a line.
const TEST_PERIOD_NS: u64 = 100 * MS;
/// Test pulse of I/Q after that of C/Q.
const SHIFT_NS: u64 = 10 * MS;
/// I/Q follows C/Q.
const SKEW_NS: u64 = 200 * US;

/// The lines of an FS-Device with supply.
#[derive(Clone, Debug)]
pub(crate) struct Lines {
    edition: Edition,
    mutant: Option<Mutant>,
    /// Edges that will come, in the order of time.
    script: VecDeque<(u64, Line, bool)>,
    levels: (bool, bool),
    phase: Phase,
    /// When the next round of test pulses begins.
    round: u64,
    demand: bool,
    /// No output is switched ON before the next power-on.
    locked: bool,
    /// The tester wakes the device up itself.
    woken_by_tester: bool,
}

#[derive(Copy, Clone, Debug, PartialEq, Eq)]
enum Phase {
    /// SelfTesting_5, then Idle_0: ready for the wake-up in this time.
    Start { ready: u64, ossde: u64 },
    /// The wake-up came too late, or never.
    Ossde,
    /// EstablishCom_1 and all that follows; the lines belong to communication.
    Communication,
}

impl Lines {
    /// Supply comes at `now` after it was away for `off_ns`, if it was there before; `pulse_ns` is the width of the Ready pulse.
    pub fn power_on(edition: Edition, pulse_ns: u64, mutant: Option<Mutant>, now: u64, off_ns: Option<u64>) -> Lines {
        let is = |other| mutant == Some(other);
        let pulse_ns = match mutant {
            Some(Mutant::ReadyPulseShort) => 499 * US,
            Some(Mutant::ReadyPulseLong) => 1_001 * US,
            _ => pulse_ns,
        };
        let rise = now.saturating_add(if is(Mutant::ReadyPulseLate) { 5_001 * MS } else { SELF_TEST_NS });
        let fall = rise.saturating_add(pulse_ns);
        let ready = fall.saturating_add(if is(Mutant::WakeUpLate) { 51 * US } else { READY_NS });
        let recovery = match (edition, mutant) {
            (Edition::V1_1, Some(Mutant::OssdeEarly)) => 699 * US,
            (Edition::V1_1, _) => 900 * US,
            (Edition::Iec2022, Some(Mutant::OssdeEarly)) => 1_000 * MS,
            (Edition::Iec2022, _) => 1_200 * MS,
        };
        let ossde = fall.saturating_add(recovery);
        let mut script = VecDeque::new();
        if is(Mutant::OnInSelfTest) {
            script.extend([(now.saturating_add(MS), Line::Iq, true), (now.saturating_add(2 * MS), Line::Iq, false)]);
        }
        let asleep = is(Mutant::ShutDownLong) && off_ns.is_some_and(|off| off < 2_000 * MS);
        if !is(Mutant::NoReadyPulse) && !asleep {
            script.push_back((rise, Line::Cq, true));
            if is(Mutant::ReadyPulseOnBothPins) {
                script.extend([(rise, Line::Iq, true), (fall, Line::Iq, false)]);
            }
            script.push_back((fall, Line::Cq, false));
        }
        if is(Mutant::SecondReadyPulse) {
            script.extend([
                (fall.saturating_add(200 * US), Line::Cq, true),
                (fall.saturating_add(300 * US), Line::Cq, false),
            ]);
        }
        let mut lines = Lines {
            edition,
            mutant,
            script,
            levels: (false, false),
            phase: Phase::Start { ready, ossde },
            round: ossde,
            demand: false,
            locked: false,
            woken_by_tester: false,
        };
        if !is(Mutant::OssdeNever) {
            lines.both(ossde, true);
        }
        lines
    }

    /// The self-test found that OSSDe operation would not be safe: the outputs stay OFF.
    pub fn stay_off(&mut self) {
        let Phase::Start { ossde, .. } = self.phase else { return };
        self.script.retain(|edge| edge.0 < ossde);
        self.locked = true;
    }

    /// The next edge that is due by `now`.
    pub fn due(&mut self, now: u64) -> Option<(u64, Line, bool)> {
        if self.phase == Phase::Communication {
            return None;
        }
        if let Phase::Start { ossde, .. } = self.phase
            && ossde <= now
            && self.script.front().is_none_or(|edge| edge.0 >= ossde)
        {
            self.phase = Phase::Ossde;
        }
        if self.script.is_empty()
            && self.phase == Phase::Ossde
            && !self.demand
            && !self.locked
            && self.mutant != Some(Mutant::OssdeNever)
        {
            self.test_pulses();
        }
        let edge = *self.script.front().filter(|edge| edge.0 <= now)?;
        self.script.pop_front();
        let level = if edge.1 == Line::Iq { &mut self.levels.1 } else { &mut self.levels.0 };
        *level = edge.2;
        Some(edge)
    }

    /// Leaves out the test pulses that were due until `now`: nobody can be told of as many as fit into a long time.
    pub fn skip(&mut self, now: u64) {
        if self.phase == Phase::Ossde && self.levels == (true, true) {
            self.script.clear();
            self.round = now;
        }
    }

    /// A wake-up request. Whether the device answers the messages that follow.
    pub fn wake_up(&mut self, now: u64) -> bool {
        self.woken_by_tester = true;
        match self.phase {
            Phase::Start { ready, ossde }
                if ready <= now && (now < ossde || self.mutant == Some(Mutant::OssdeNever)) =>
            {
                self.communicate();
                true
            }
            _ => false,
        }
    }

    /// On-request or process data are asked for. Without a wake-up by the tester the base system has seen to it.
    pub fn answers(&mut self) -> bool {
        if !self.woken_by_tester {
            self.communicate();
        }
        self.phase == Phase::Communication
    }

    /// The safety function is demanded, or no more.
    pub fn demand(&mut self, now: u64, demand: bool) {
        if self.demand != demand {
            self.demand = demand;
            if self.phase == Phase::Ossde && !self.locked && self.mutant != Some(Mutant::OssdeNever) {
                self.script.clear();
                self.both(now, !demand);
            }
        }
    }

    /// The levels of C/Q and I/Q.
    pub fn levels(&self) -> (bool, bool) {
        self.levels
    }

    fn communicate(&mut self) {
        self.phase = Phase::Communication;
        self.script.clear();
    }

    /// Both outputs change, one after the other.
    fn both(&mut self, at: u64, level: bool) {
        let skew = match (self.mutant, self.edition) {
            (Some(Mutant::DiscrepancyLong), Edition::V1_1) => 3_001 * US,
            (Some(Mutant::DiscrepancyLong), Edition::Iec2022) => 1_001 * US,
            _ => SKEW_NS,
        };
        let second = self.mutant != Some(Mutant::DemandOnOneLine) || level;
        self.script.push_back((at, Line::Cq, level));
        self.script.extend(second.then_some((at.saturating_add(skew), Line::Iq, level)));
        self.round = at;
    }

    /// One test pulse on each line.
    fn test_pulses(&mut self) {
        let width = if self.mutant == Some(Mutant::TestPulseLong) { 1_001 * US } else { TEST_PULSE_NS };
        let period = match (self.mutant, self.edition) {
            (Some(Mutant::TestPulsesDense), Edition::V1_1) => 9_900 * US,
            (Some(Mutant::TestPulsesDense), Edition::Iec2022) => 49 * MS,
            (Some(Mutant::TestPulseLong), _) => 2 * TEST_PERIOD_NS,
            _ => TEST_PERIOD_NS,
        };
        self.round = self.round.saturating_add(period);
        let shift = SHIFT_NS.min(period / 2);
        let pulse = |line, from: u64| [(from, line, false), (from.saturating_add(width), line, true)];
        self.script.extend(pulse(Line::Cq, self.round));
        self.script.extend(pulse(Line::Iq, self.round.saturating_add(shift)));
    }
}
