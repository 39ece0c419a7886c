//! A port in OSSDe mode: input filter, discrepancy, and the qualifier handler of 11.11.5 (Table 43), by hand from the figure.

use super::MasterMutant;

/// A line counts as changed once it has been stable for this long: test pulses are shorter (Table 8).
const FILTER_NS: u64 = 1_000_000;
/// Filtered lines may differ for this long (Table 8).
const DISCREPANCY_NS: u64 = 3_000_000;
/// When the port diagnosis of state 1 is done.
const FIRST_CHECK_NS: u64 = 5_000_000;

/// States of the qualifier handler.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
enum State {
    PortOssdeCheck1,
    OssdeOkGood2,
    OssdeFaultBad3,
    NoFaultAwaitAckQ4,
}

/// One input behind its filter.
#[derive(Copy, Clone, Debug, Default)]
struct Input {
    raw: bool,
    filtered: bool,
    /// When a change of `raw` counts.
    due: Option<u64>,
}

impl Input {
    fn drive(&mut self, now: u64, level: bool, filter_ns: u64) {
        if level == self.raw {
            return;
        }
        self.raw = level;
        self.due = (level != self.filtered).then_some(now + filter_ns);
    }

    fn pass(&mut self, now: u64) {
        if self.due.is_some_and(|due| due <= now) {
            self.filtered = self.raw;
            self.due = None;
        }
    }
}

/// What the services of the port show.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Outputs {
    /// Process data in use and both lines on.
    pub on: bool,
    /// Qualifier: GOOD.
    pub qualifier: bool,
    /// ChFAckReq.
    pub ch_f_ack_req: bool,
}

/// The port.
#[derive(Debug)]
pub struct Ossde {
    state: State,
    cq: Input,
    iq: Input,
    /// When an antivalence becomes a fault.
    discrepancy_due: Option<u64>,
    fault: bool,
    first_check_due: Option<u64>,
    ack_q: bool,
    mutant: Option<MasterMutant>,
}

impl Ossde {
    /// Put into OSSDe mode with these levels on C/Q and I/Q.
    pub fn new(now: u64, (cq, iq): (bool, bool), ack_q: bool, mutant: Option<MasterMutant>) -> Ossde {
        let input = |raw: bool| Input { raw, filtered: raw, due: None };
        let mut ossde = Ossde {
            state: State::PortOssdeCheck1,
            cq: input(cq),
            iq: input(iq),
            discrepancy_due: None,
            fault: false,
            first_check_due: Some(now + FIRST_CHECK_NS),
            ack_q,
            mutant,
        };
        ossde.diagnose(now);
        ossde
    }

    /// A level on C/Q.
    pub fn drive_cq(&mut self, now: u64, level: bool) {
        self.cq.drive(now, level, self.filter_ns());
    }

    /// A level on I/Q.
    pub fn drive_iq(&mut self, now: u64, level: bool) {
        self.iq.drive(now, level, self.filter_ns());
    }

    fn is(&self, mutant: MasterMutant) -> bool {
        self.mutant == Some(mutant)
    }

    fn filter_ns(&self) -> u64 {
        if self.is(MasterMutant::OssdeNoFilter) { 0 } else { FILTER_NS }
    }

    /// AckQ: its rising edge acknowledges a fault that has gone.
    pub fn ack_q(&mut self, value: bool) {
        let rising = value && !self.ack_q;
        self.ack_q = value;
        if rising && self.state == State::NoFaultAwaitAckQ4 {
            // T5
            self.state = State::OssdeOkGood2;
        }
    }

    /// When something happens next by itself.
    pub fn due(&self) -> Option<u64> {
        [self.cq.due, self.iq.due, self.discrepancy_due, self.first_check_due].into_iter().flatten().min()
    }

    /// What is due by now is done; `true` when a fault has just appeared: T2, T3 or T6.
    pub fn pass(&mut self, now: u64) -> bool {
        self.cq.pass(now);
        self.iq.pass(now);
        self.diagnose(now);
        let faulty = self.fault;
        let before = self.state;
        if self.first_check_due.is_some_and(|due| due <= now) {
            self.first_check_due = None;
        }
        self.state = match self.state {
            // An antivalence that may still end is no result yet.
            State::PortOssdeCheck1 if self.first_check_due.is_some() || self.discrepancy_due.is_some() => {
                State::PortOssdeCheck1
            }
            State::PortOssdeCheck1 if faulty && self.is(MasterMutant::OssdeAskedWhileFault) => State::NoFaultAwaitAckQ4,
            State::PortOssdeCheck1 if faulty => State::OssdeFaultBad3,
            State::PortOssdeCheck1 if self.is(MasterMutant::OssdeStartWantsAcknowledgment) => State::NoFaultAwaitAckQ4,
            State::PortOssdeCheck1 => State::OssdeOkGood2,
            State::OssdeOkGood2 if self.is(MasterMutant::OssdeFaultMissed) => State::OssdeOkGood2,
            State::NoFaultAwaitAckQ4 if self.is(MasterMutant::OssdeRequestStands) => State::NoFaultAwaitAckQ4,
            State::OssdeOkGood2 | State::NoFaultAwaitAckQ4 if faulty => State::OssdeFaultBad3,
            State::OssdeFaultBad3 if !faulty && self.is(MasterMutant::OssdeRestartByItself) => State::OssdeOkGood2,
            State::OssdeFaultBad3 if !faulty && self.ack_q && self.is(MasterMutant::OssdeAcknowledgmentAsLevel) => {
                State::OssdeOkGood2
            }
            State::OssdeFaultBad3 if !faulty => State::NoFaultAwaitAckQ4,
            state => state,
        };
        self.state == State::OssdeFaultBad3 && before != State::OssdeFaultBad3
    }

    fn diagnose(&mut self, now: u64) {
        if self.cq.filtered == self.iq.filtered {
            self.discrepancy_due = None;
            self.fault = false;
            return;
        }
        match self.discrepancy_due {
            None if !self.fault => self.discrepancy_due = Some(now + self.discrepancy_ns()),
            Some(due) if due <= now => {
                self.discrepancy_due = None;
                self.fault = true;
            }
            _ => {}
        }
    }

    fn discrepancy_ns(&self) -> u64 {
        if self.is(MasterMutant::OssdeDiscrepancyTooShort) { 1_000_000 } else { DISCREPANCY_NS }
    }

    /// Octet 0 of FSInBuffer: bit 0 is C/Q, bit 1 is I/Q, as they are (10.5).
    pub fn image(&self) -> u8 {
        u8::from(self.cq.raw) | u8::from(self.iq.raw) << 1
    }

    /// What the services show.
    pub fn outputs(&self) -> Outputs {
        let good = self.state == State::OssdeOkGood2;
        let both = self.cq.filtered && self.iq.filtered;
        let one = self.cq.filtered || self.iq.filtered;
        Outputs {
            on: good && (both || one && self.is(MasterMutant::OssdeOneLineIsOn)),
            qualifier: good,
            ch_f_ack_req: self.state == State::NoFaultAwaitAckQ4,
        }
    }
}
