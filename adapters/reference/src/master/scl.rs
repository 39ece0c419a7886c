//! The Safety Communication Layer of one port of an FS-Master (11.5.2), written by hand from the state figure and Table 38.
//!
//! Sans-IO: time comes in as an argument in nanoseconds, no clock is read here. Where the texts leave a choice:
//! - State 7 takes the mirrored answer only, state 5 any answer with another counter than the one before, state 2 any.
//! - An SPDU of all zeros is ignored in every state.
//! - SDset alone is no fault. ChFAck_C and setSD_C are looked at when a good answer is checked.
//! - MTimer has expired once FSP_Watchdog has passed; an answer received at that very instant comes after the expiry.

mod wire;

use super::MasterMutant;
use fsct_protocol::ProtMode;
use fsct_protocol::spdu::{Control, Emitted, Pd, Port, View};
use wire::{emitted, port_num_good, signature_good};

/// What the port configuration gives to the SCL.
#[derive(Copy, Clone, Debug)]
pub struct Config {
    /// FSP_ProtMode.
    pub mode: ProtMode,
    /// Octets of FS-PDin, received.
    pub pd_in: u8,
    /// Octets of FS-PDout, sent.
    pub pd_out: u8,
    /// FSP_Port.
    pub port: Port,
    /// FSP_Watchdog in milliseconds, 1..65535.
    pub watchdog_ms: u16,
    /// A deliberate fault.
    pub mutant: Option<MasterMutant>,
}

/// Input services (Table 28).
#[derive(Copy, Clone, Debug)]
pub struct Inputs {
    /// PDout_M: process data to send.
    pub pd_out: Pd,
    /// setSD_C: force safe data.
    pub set_sd_c: bool,
    /// ChFAck_C: acknowledgment by the operator.
    pub ch_f_ack_c: bool,
}

/// Output services (Table 28) and the qualifier (Table 42).
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Outputs {
    /// PDin_M: process data for the gateway.
    pub pd_in: Pd,
    /// SDset_S: safe data are in use.
    pub sd_set_s: bool,
    /// ChFAckReq_S: an acknowledgment is asked for.
    pub ch_f_ack_req_s: bool,
    /// FAULTS_S: a fault that has not been acknowledged yet.
    pub faults_s: bool,
    /// Qualifier: GOOD.
    pub qualifier: bool,
}

impl Outputs {
    /// The values before the SCL has started, for `pd_in` octets of process data.
    pub const fn initial(pd_in: u8) -> Outputs {
        Outputs {
            pd_in: Pd::safe(pd_in as usize),
            sd_set_s: true,
            ch_f_ack_req_s: false,
            faults_s: false,
            qualifier: false,
        }
    }
}

/// The states in which the machine rests.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
enum State {
    WaitOnResponse2,
    WaitOnResponse5,
    WaitOnResponse7,
}

/// The machine.
#[derive(Debug)]
pub struct Scl {
    config: Config,
    state: State,
    m_count: u8,
    set_sd: bool,
    ch_f_ack_req: bool,
    ch_f_ack_c_e: bool,
    /// DCount_i of the answer processed last.
    d_count_i: Option<u8>,
    m_timer: Option<u64>,
    /// ChFAck_C was 1 in regular operation; kept by the fault `press-in-operation-kept` alone.
    pressed_before: bool,
    spdu: Emitted,
    outputs: Outputs,
}

impl Scl {
    /// T1 and T2: the preconditions are fulfilled, the first SPDU stands.
    pub fn start(now: u64, config: Config) -> Scl {
        let is = |mutant: MasterMutant| config.mutant == Some(mutant);
        let mcount = u8::from(is(MasterMutant::FirstMcount1));
        let set_sd = !is(MasterMutant::FirstSpduWithoutSetSd);
        let mut scl = Scl {
            config,
            state: State::WaitOnResponse2,
            m_count: mcount,
            set_sd: true,
            ch_f_ack_req: false,
            ch_f_ack_c_e: false,
            d_count_i: None,
            m_timer: None,
            pressed_before: false,
            spdu: emitted(&config, Pd::safe(config.pd_out.into()), Control { mcount, set_sd, ch_f_ack_req: false }),
            outputs: Outputs::initial(config.pd_in),
        };
        scl.use_sd();
        scl.outputs.qualifier |= is(MasterMutant::QualifierGoodAtStart);
        if is(MasterMutant::MTimerFromStart) {
            scl.restart_m_timer(now);
        }
        scl
    }

    /// The SPDU that stands.
    pub fn spdu(&self) -> &[u8] {
        self.spdu.octets()
    }

    /// The output services.
    pub const fn outputs(&self) -> &Outputs {
        &self.outputs
    }

    /// When MTimer expires; `None` while it does not run.
    pub const fn due(&self) -> Option<u64> {
        self.m_timer
    }

    /// MTimer has expired at this time: T8 or T14.
    pub fn expire(&mut self, now: u64) {
        if self.state == State::WaitOnResponse7 {
            // T14
            self.disarm(MasterMutant::ArmedAfterTimeout, MasterMutant::AskedAfterTimeout);
        }
        self.use_sd_but(MasterMutant::TimeoutKeepsPdin);
        if self.is(MasterMutant::McountNotReset) {
            self.next_m_count();
        } else {
            self.m_count = 0;
        }
        self.fault();
        self.send_exceptional(now);
    }

    /// Passes over expiries up to `to` that change nothing: T14 with nothing to withdraw. What is left of them shows the same.
    pub fn skip(&mut self, to: u64) {
        // A whole round of MCount, for the fault that goes on counting.
        let round = 7 * self.watchdog_ns();
        let idle = self.state == State::WaitOnResponse7 && !self.ch_f_ack_req && !self.ch_f_ack_c_e;
        if let (true, Some(due)) = (idle, self.m_timer) {
            self.m_timer = Some(due + to.saturating_sub(due) / round * round);
        }
    }

    /// An exchange in which nothing came from the FS-Device: no transition, the SPDU stands.
    pub fn missed(&mut self) {
        if self.is(MasterMutant::ExceptionalSpduCountsOn) && self.state == State::WaitOnResponse7 {
            self.next_m_count();
            self.send(Pd::safe(self.config.pd_out.into()));
        }
    }

    /// The SPDU as the FS-Device has sent it.
    pub fn received(&mut self, now: u64, octets: &[u8], inputs: &Inputs) {
        let Ok(answer) = View::new(octets, self.config.mode, self.config.pd_in.into()) else { return };
        let zero_checked = match self.state {
            State::WaitOnResponse2 => self.is(MasterMutant::AllZeroFirstAnswerChecked),
            State::WaitOnResponse5 => self.is(MasterMutant::AllZeroAnswerChecked),
            State::WaitOnResponse7 => false,
        };
        if answer.is_all_zero() && !zero_checked {
            return;
        }
        if self.is(MasterMutant::MTimerRestartedByRepetitions) && self.m_timer.is_some() {
            self.restart_m_timer(now);
        }
        let counter = answer.status().dcount_i;
        match self.state {
            State::WaitOnResponse2 => self.check_spdu_3(now, &answer, inputs),
            State::WaitOnResponse5 if self.taken_in_5(counter) => self.check_spdu_3(now, &answer, inputs),
            State::WaitOnResponse7 if self.taken_in_7(counter) => self.check_spdu_8(now, &answer, inputs),
            State::WaitOnResponse5 if self.is(MasterMutant::RepeatedDataPassedOn) => self.outputs.pd_in = data(&answer),
            _ => {}
        }
    }

    /// Guard of T6: not old.
    fn taken_in_5(&self, counter: u8) -> bool {
        match self.config.mutant {
            Some(MasterMutant::OldCounterChecked) => true,
            Some(MasterMutant::ForeignCounterWaitedOut) => self.mirrored(counter),
            _ => self.d_count_i != Some(counter),
        }
    }

    /// Guard of T10: expected.
    fn taken_in_7(&self, counter: u8) -> bool {
        let old = self.d_count_i == Some(counter);
        match self.config.mutant {
            Some(MasterMutant::OnlyNewCounterAfterFault) => self.mirrored(counter) && !old,
            Some(MasterMutant::NotOld) => !old,
            _ => self.mirrored(counter),
        }
    }

    fn mirrored(&self, counter: u8) -> bool {
        let expected = if self.is(MasterMutant::DcountNotInverted) { self.m_count } else { 7 - self.m_count };
        counter == expected
    }

    fn check_spdu_3(&mut self, now: u64, answer: &View<'_>, inputs: &Inputs) {
        if self.faults(answer) {
            // T7
            self.use_sd_but(MasterMutant::FaultKeepsPdin);
            self.set_sd = !self.is(MasterMutant::SetSdMissingAfterFault);
            match self.config.mutant {
                Some(MasterMutant::FaultKeepsMcount) => {}
                Some(MasterMutant::FaultResetsMcount) => self.m_count = 0,
                _ => self.next_m_count(),
            }
            self.fault();
            self.ch_f_ack_req = self.is(MasterMutant::ChFAckReqEarly);
            self.send_exceptional(now);
        } else {
            // T4
            self.pressed_before |= inputs.ch_f_ack_c && self.is(MasterMutant::PressInOperationKept);
            if !(self.is(MasterMutant::McountStandsWhileSdset) && answer.status().sd_set) {
                self.next_m_count();
            }
            self.send_regular(now, answer, inputs);
        }
    }

    fn check_spdu_8(&mut self, now: u64, answer: &View<'_>, inputs: &Inputs) {
        if self.faults(answer) {
            // T12
            self.disarm(MasterMutant::ArmedAfterFault, MasterMutant::AskedAfterFault);
            self.use_sd();
            self.next_m_count();
            self.fault();
            return self.send_exceptional(now);
        }
        let level = self.is(MasterMutant::AcknowledgmentAsLevel);
        let unasked = std::mem::take(&mut self.pressed_before) || self.is(MasterMutant::RestartWithoutAcknowledgment);
        let pressed = inputs.ch_f_ack_c != self.is(MasterMutant::AcknowledgmentOnFallingEdge);
        if unasked || pressed && (self.ch_f_ack_c_e || level) {
            // T11
            self.disarm(MasterMutant::ArmedAfterAcknowledgment, MasterMutant::AskedAfterAcknowledgment);
            self.outputs.faults_s = false;
            self.next_m_count();
            if self.is(MasterMutant::AcknowledgmentResetsMcount) {
                self.m_count = 1;
            }
            return self.send_regular(now, answer, inputs);
        }
        // T13
        self.ch_f_ack_req = !(self.is(MasterMutant::ChFAckReqBlinks) && self.ch_f_ack_req);
        self.outputs.ch_f_ack_req_s = !self.is(MasterMutant::ChFAckReqSMissing);
        if !pressed {
            self.ch_f_ack_c_e = true;
        }
        self.use_sd();
        self.set_sd = !self.is(MasterMutant::SetSdMissingWhileAsked);
        if self.is(MasterMutant::QualifierReleasedEarly) {
            self.outputs.qualifier = true;
        }
        self.next_m_count();
        self.send_exceptional(now);
    }

    /// The activities of CheckSPDU; the result is FAULTS.
    fn faults(&mut self, answer: &View<'_>) -> bool {
        let status = answer.status();
        self.d_count_i = Some(status.dcount_i);
        let counter_good = self.mirrored(status.dcount_i) || self.is(MasterMutant::CounterNotChecked);
        let good = signature_good(&self.config, answer) && port_num_good(&self.config, answer) && counter_good;
        let reported = match self.config.mutant {
            Some(MasterMutant::DTimeoutIgnored) => status.d_comm_err,
            Some(MasterMutant::DCommErrIgnored) => status.d_timeout,
            Some(MasterMutant::DCommErrNeedsSdset) => status.d_comm_err && status.sd_set || status.d_timeout,
            Some(MasterMutant::SdsetInOperationIsFault) => {
                status.d_comm_err || status.d_timeout || status.sd_set && !self.outputs.sd_set_s
            }
            Some(MasterMutant::SdsetIsFault) => status.d_comm_err || status.d_timeout || status.sd_set,
            _ => status.d_comm_err || status.d_timeout,
        };
        !good || reported
    }

    /// State 4, T5: process data or SD as the answer and setSD_C ask.
    fn send_regular(&mut self, now: u64, answer: &View<'_>, inputs: &Inputs) {
        let pd_in = data(answer);
        let sd_set = answer.status().sd_set && !self.is(MasterMutant::SdsetIgnored);
        if sd_set || inputs.set_sd_c {
            self.outputs.sd_set_s = inputs.set_sd_c || !self.is(MasterMutant::SdsetNotReported);
            self.outputs.pd_in = Pd::safe(self.config.pd_in.into());
            if self.is(MasterMutant::PdinLiveWhileSdset) {
                self.outputs.pd_in = pd_in;
            }
        } else {
            self.outputs.sd_set_s = false;
            self.outputs.pd_in = pd_in;
        }
        self.set_sd = inputs.set_sd_c && !self.is(MasterMutant::SetSdBitMissing);
        self.qualify();
        let safe = inputs.set_sd_c && !self.is(MasterMutant::PdoutLiveWhileSetSd);
        self.send(if safe { Pd::safe(self.config.pd_out.into()) } else { inputs.pd_out });
        if !(self.is(MasterMutant::MTimerStartedOnce) && self.m_timer.is_some()) {
            self.restart_m_timer(now);
        }
        self.state = State::WaitOnResponse5;
    }

    /// State 6, T9: SD.
    fn send_exceptional(&mut self, now: u64) {
        let safe = Pd::safe(self.config.pd_out.into());
        let before = self.spdu.octets().get(..self.config.pd_out.into()).and_then(Pd::new).unwrap_or(safe);
        self.send(if self.is(MasterMutant::ExceptionalSpduWithData) { before } else { safe });
        self.restart_m_timer(now);
        if self.is(MasterMutant::MTimerStoppedAfterFault) {
            self.m_timer = None;
        }
        self.state = State::WaitOnResponse7;
    }

    fn send(&mut self, pd_out: Pd) {
        let control = Control { mcount: self.m_count, set_sd: self.set_sd, ch_f_ack_req: self.ch_f_ack_req };
        self.spdu = emitted(&self.config, pd_out, control);
    }

    fn use_sd(&mut self) {
        self.set_sd = true;
        self.outputs.sd_set_s = true;
        self.outputs.pd_in = Pd::safe(self.config.pd_in.into());
        self.qualify();
    }

    /// SD is in use; `keeps` is the fault that leaves PDin_M as it is.
    fn use_sd_but(&mut self, keeps: MasterMutant) {
        let before = self.outputs.pd_in;
        self.use_sd();
        if self.is(keeps) {
            self.outputs.pd_in = before;
        }
    }

    fn fault(&mut self) {
        self.outputs.faults_s = true;
        self.qualify();
    }

    /// GOOD when neither FAULTS_S nor SDset_S says otherwise (11.11.4).
    fn qualify(&mut self) {
        let sd = self.outputs.sd_set_s && !self.is(MasterMutant::QualifierIgnoresSdset);
        self.outputs.qualifier = !(self.outputs.faults_s || sd);
    }

    /// No acknowledgment is asked for or prepared; the faults that leave one of the two standing.
    fn disarm(&mut self, armed: MasterMutant, asked: MasterMutant) {
        if !self.is(asked) {
            self.ch_f_ack_req = false;
            self.outputs.ch_f_ack_req_s = false;
        }
        if !self.is(armed) {
            self.ch_f_ack_c_e = false;
        }
    }

    fn next_m_count(&mut self) {
        self.m_count = match self.m_count {
            7 if self.is(MasterMutant::Counter7To0) => 0,
            7 => 1,
            count => count + 1,
        };
    }

    fn restart_m_timer(&mut self, now: u64) {
        self.m_timer = Some(now + self.watchdog_ns());
    }

    fn watchdog_ns(&self) -> u64 {
        let ns = |ms: u16| u64::from(ms.max(1)) * 1_000_000;
        let ms = self.config.watchdog_ms;
        match self.config.mutant {
            Some(MasterMutant::WatchdogEarly) => ns(ms) / 4 * 3,
            Some(MasterMutant::WatchdogLate) => ns(ms) / 4 * 5,
            Some(MasterMutant::WatchdogOctetsSwapped) => ns(ms.swap_bytes()),
            _ => ns(ms),
        }
    }

    fn is(&self, mutant: MasterMutant) -> bool {
        self.config.mutant == Some(mutant)
    }
}

/// The process data of an answer.
fn data(answer: &View<'_>) -> Pd {
    Pd::new(answer.pd()).unwrap_or(Pd::safe(answer.pd().len()))
}
