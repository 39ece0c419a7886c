//! The Safety Communication Layer of one port of an FS-Master (11.5.2), written by hand from the state figure and Table 38.
//!
//! Sans-IO: time comes in as an argument in nanoseconds, no clock is read here. Where the texts leave a choice:
//! - State 7 takes the mirrored answer only, state 5 any answer with another counter than the one before, state 2 any.
//! - An SPDU of all zeros is ignored in every state.
//! - SDset alone is no fault. ChFAck_C and setSD_C are looked at when a good answer is checked.
//! - MTimer has expired once FSP_Watchdog has passed; an answer received at that very instant comes after the expiry.

use super::MasterMutant;
use fsct_protocol::ProtMode;
use fsct_protocol::crc::Reading;
use fsct_protocol::spdu::{Control, Emitted, Pd, Port, View, Wire};

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
    spdu: Emitted,
    outputs: Outputs,
}

impl Scl {
    /// T1 and T2: the preconditions are fulfilled, the first SPDU stands.
    pub fn start(config: Config) -> Scl {
        let mut scl = Scl {
            config,
            state: State::WaitOnResponse2,
            m_count: 0,
            set_sd: true,
            ch_f_ack_req: false,
            ch_f_ack_c_e: false,
            d_count_i: None,
            m_timer: None,
            spdu: emitted(
                &config,
                Pd::safe(config.pd_out.into()),
                Control { mcount: 0, set_sd: true, ch_f_ack_req: false },
            ),
            outputs: Outputs::initial(config.pd_in),
        };
        scl.use_sd();
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
            self.disarm();
        }
        self.use_sd();
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

    /// The SPDU as the FS-Device has sent it.
    pub fn received(&mut self, now: u64, octets: &[u8], inputs: &Inputs) {
        let Ok(answer) = View::new(octets, self.config.mode, self.config.pd_in.into()) else { return };
        if answer.is_all_zero() {
            return;
        }
        if self.is(MasterMutant::MTimerRestartedByRepetitions) && self.m_timer.is_some() {
            self.restart_m_timer(now);
        }
        let counter = answer.status().dcount_i;
        match self.state {
            State::WaitOnResponse2 => self.check_spdu_3(now, &answer, inputs),
            State::WaitOnResponse5 if self.d_count_i != Some(counter) => self.check_spdu_3(now, &answer, inputs),
            State::WaitOnResponse7 if counter == 7 - self.m_count => self.check_spdu_8(now, &answer, inputs),
            _ => {}
        }
    }

    fn check_spdu_3(&mut self, now: u64, answer: &View<'_>, inputs: &Inputs) {
        if self.faults(answer) {
            // T7
            self.use_sd();
            self.next_m_count();
            self.fault();
            self.ch_f_ack_req = self.is(MasterMutant::ChFAckReqEarly);
            self.send_exceptional(now);
        } else {
            // T4
            self.next_m_count();
            self.send_regular(now, answer, inputs);
        }
    }

    fn check_spdu_8(&mut self, now: u64, answer: &View<'_>, inputs: &Inputs) {
        if self.faults(answer) {
            // T12
            self.disarm();
            self.use_sd();
            self.next_m_count();
            self.fault();
            return self.send_exceptional(now);
        }
        let level = self.is(MasterMutant::AcknowledgmentAsLevel);
        let unasked = self.is(MasterMutant::RestartWithoutAcknowledgment);
        if unasked || inputs.ch_f_ack_c && (self.ch_f_ack_c_e || level) {
            // T11
            self.disarm();
            self.outputs.faults_s = false;
            self.next_m_count();
            return self.send_regular(now, answer, inputs);
        }
        // T13
        self.ch_f_ack_req = true;
        self.outputs.ch_f_ack_req_s = true;
        if !inputs.ch_f_ack_c {
            self.ch_f_ack_c_e = true;
        }
        self.use_sd();
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
        let port = self.config.port;
        let port_good = answer.port_num() == port.inverted()
            || self.is(MasterMutant::PlainPortNumAccepted) && answer.port_num() == port.number();
        let m_comm_err =
            !(answer.signature_matches(Reading::Preset) && port_good && status.dcount_i == 7 - self.m_count);
        m_comm_err || status.d_comm_err || status.d_timeout && !self.is(MasterMutant::DTimeoutIgnored)
    }

    /// State 4, T5: process data or SD as the answer and setSD_C ask.
    fn send_regular(&mut self, now: u64, answer: &View<'_>, inputs: &Inputs) {
        let pd_in = Pd::new(answer.pd()).unwrap_or(Pd::safe(answer.pd().len()));
        if answer.status().sd_set || inputs.set_sd_c {
            self.outputs.sd_set_s = true;
            self.outputs.pd_in = Pd::safe(self.config.pd_in.into());
            if self.is(MasterMutant::PdinLiveWhileSdset) {
                self.outputs.pd_in = pd_in;
            }
        } else {
            self.outputs.sd_set_s = false;
            self.outputs.pd_in = pd_in;
        }
        self.set_sd = inputs.set_sd_c;
        self.qualify();
        let pd_out = if inputs.set_sd_c { Pd::safe(self.config.pd_out.into()) } else { inputs.pd_out };
        self.send(pd_out);
        self.restart_m_timer(now);
        self.state = State::WaitOnResponse5;
    }

    /// State 6, T9: SD.
    fn send_exceptional(&mut self, now: u64) {
        self.send(Pd::safe(self.config.pd_out.into()));
        self.restart_m_timer(now);
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

    fn fault(&mut self) {
        self.outputs.faults_s = true;
        self.qualify();
    }

    /// GOOD when neither FAULTS_S nor SDset_S says otherwise (11.11.4).
    fn qualify(&mut self) {
        self.outputs.qualifier = !(self.outputs.faults_s || self.outputs.sd_set_s);
    }

    fn disarm(&mut self) {
        self.ch_f_ack_req = false;
        self.outputs.ch_f_ack_req_s = false;
        self.ch_f_ack_c_e = false;
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
        u64::from(self.config.watchdog_ms.max(1)) * 1_000_000
    }

    fn is(&self, mutant: MasterMutant) -> bool {
        self.config.mutant == Some(mutant)
    }
}

fn emitted(config: &Config, pd: Pd, control: Control) -> Emitted {
    let wire = Wire { pd, port_num: config.port.number(), octet: control.to_octet(), signature: None };
    wire.emit(config.mode, Reading::Preset)
}
