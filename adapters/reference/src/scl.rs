//! The Safety Communication Layer of an FS-Device (11.5.3), written by hand from the state figure and Table 40.
//!
//! Sans-IO: time comes in as an argument in nanoseconds, no clock is read here. Where the texts leave a choice:
//! - T29 is read nested: CommErrCount and TimeoutCount are worked off in error-free cycles only.
//! - The previous SPDU is the one checked last, whatever the check said; DCount_i is the inverse of what was received.
//! - An SPDU of all zeros is ignored in every state.
//! - A jump of MCount is an error, not an old SPDU. The first SPDU must carry 0, in v1.1 as well.
//! - DTimer has expired once FSP_Watchdog has passed; an SPDU received at that very instant comes after the expiry.

mod actions;
mod wire;

use crate::Mutant;
use actions::Action;
use actions::Transition::{self, T22, T25, T28, T29, T30, T31};
use fsct_protocol::ProtMode;
use fsct_protocol::spdu::{Emitted, Pd, Port, Status, View};

/// What FSP parameterization gives to the SCL.
#[derive(Copy, Clone, Debug)]
pub struct Config {
    /// FSP_ProtMode.
    pub mode: ProtMode,
    /// Octets of FS-PDout, received.
    pub pd_out: u8,
    /// FSP_Port.
    pub port: Port,
    /// FSP_Watchdog in milliseconds, 1..65535.
    pub watchdog_ms: u16,
    /// A deliberate fault.
    pub mutant: Option<Mutant>,
}

/// Input services (Table 29).
#[derive(Copy, Clone, Debug)]
pub struct Inputs {
    /// PDin_D: process data to send.
    pub pd_in: Pd,
    /// SDset_DS: the technology is in its safe state.
    pub sd_set_ds: bool,
}

/// Output services (Table 29).
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Outputs {
    /// PDout_D: process data for the technology.
    pub pd_out: Pd,
    /// setSD_DC: take the safe state.
    pub set_sd_dc: bool,
    /// ChFAckReq_DC: an acknowledgment by the operator is awaited.
    pub ch_f_ack_req_dc: bool,
}

impl Outputs {
    /// The values at power-on, for `pd_out` octets of process data: SDout, all others 0.
    pub const fn initial(pd_out: u8) -> Outputs {
        Outputs { pd_out: Pd::safe(pd_out as usize), set_sd_dc: false, ch_f_ack_req_dc: false }
    }
}

/// The states in which the machine rests. CheckSPDU (22, 27) and PrepareResponse (23, 25) take no time: they are
/// functions of the same name.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum State {
    /// Parameterized, start of the system not finished.
    SystemStart20,
    /// The first SPDU is awaited without time limit.
    WaitOnSpdu21,
    /// The next SPDU is awaited in regular operation.
    WaitOnSpdu24,
    /// The next SPDU is awaited after a fault.
    WaitOnSpdu26,
}

/// The machine.
#[derive(Clone, Debug)]
pub struct Scl {
    config: Config,
    state: State,
    /// When DTimer expires; `None` while it does not run.
    d_timer: Option<u64>,
    /// MCount of the SPDU checked last.
    m_count: Option<u8>,
    sd_cycles: u8,
    comm_err_count: bool,
    timeout_count: bool,
    status: Status,
    outputs: Outputs,
    answer: Option<Emitted>,
    /// PDin_D in the answer.
    pd_in: Option<Pd>,
    /// The switch of a mutant that stays on.
    latched: bool,
}

impl Scl {
    /// The machine right after FSP parameterization, in SystemStart.
    pub fn new(config: Config) -> Scl {
        let mut scl = Scl {
            config,
            state: State::SystemStart20,
            d_timer: None,
            m_count: None,
            sd_cycles: 0,
            comm_err_count: config.mutant == Some(Mutant::CommErrCountStartsAt1),
            timeout_count: config.mutant == Some(Mutant::TimeoutCountStartsAt1),
            status: Status { d_timeout: true, ..Status::default() },
            outputs: Outputs::initial(config.pd_out),
            answer: None,
            pd_in: None,
            latched: false,
        };
        if !scl.is(Mutant::SdCyclesStartAt0) {
            scl.load_sd_cycles();
        }
        scl
    }

    /// T20: the start of the system is OK.
    pub fn system_start_ok(&mut self, now: u64) {
        if self.state == State::SystemStart20 {
            self.state = State::WaitOnSpdu21;
            if self.is(Mutant::DTimerRunsFromT20) {
                self.start_d_timer(now);
            }
        }
    }

    /// The state it rests in.
    pub const fn state(&self) -> State {
        self.state
    }

    /// The output services.
    pub const fn outputs(&self) -> &Outputs {
        &self.outputs
    }

    /// The SPDU sent last; `None` before the first, when all octets sent are 0.
    pub fn answer(&self) -> Option<&[u8]> {
        self.answer.as_ref().map(Emitted::octets)
    }

    /// T30, T31: lets DTimer expire if it was due by `now`; the result is the instant of the first expiry since then.
    ///
    /// Every further expiry up to `now` is T30 with the same services, so they are done in one step, however many.
    pub fn expire(&mut self, now: u64, inputs: &Inputs) -> Option<u64> {
        let due = self.d_timer.filter(|due| *due <= now)?;
        let transition = if self.state == State::WaitOnSpdu26 { T30 } else { T31 };
        if self.is(if transition == T30 { Mutant::T30Missing } else { Mutant::T31Missing }) {
            return None;
        }
        self.use_sd(transition);
        if self.carries_out(transition, Action::DTimeout) {
            self.status.d_timeout = true;
        }
        if self.carries_out(transition, Action::TimeoutCount) {
            self.timeout_count = true;
        }
        if self.carries_out(transition, Action::SdCycles) {
            self.load_sd_cycles();
        }
        self.start_d_timer(now - (now - due) % self.d_timer_ns());
        match self.config.mutant {
            Some(Mutant::TimeoutResetsDCount) => self.status.dcount_i = 7,
            Some(Mutant::TimeoutForgetsCounter) => self.m_count = None,
            _ => self.mirror_m_count(transition),
        }
        self.prepare_response_25(inputs);
        Some(due)
    }

    /// T21, T24, T27: octets arrived at `now`. Octets too short for an SPDU, an SPDU of all zeros and an old SPDU
    /// change nothing; what follows the SPDU is non-safety data.
    pub fn received(&mut self, now: u64, octets: &[u8], inputs: &Inputs) {
        let Ok(spdu) = View::new(octets, self.config.mode, self.config.pd_out.into()) else { return };
        if spdu.is_all_zero() && !self.checks_all_zero(now) {
            return;
        }
        let zero_old = self.is(Mutant::ZeroOldAfterTimeout) && self.status.d_timeout && spdu.counter() == 0;
        let left_alone =
            self.is(Mutant::ExactlyOne) && self.m_count.map(|previous| previous % 7 + 1) != Some(spdu.counter());
        let not_old = self.m_count != Some(spdu.counter()) && !zero_old && !left_alone;
        match self.state {
            State::WaitOnSpdu21 => self.check_spdu_22(now, octets, &spdu, inputs),
            State::WaitOnSpdu24 if not_old => self.check_spdu_22(now, octets, &spdu, inputs),
            State::WaitOnSpdu26 if not_old => self.check_spdu_27(now, octets, &spdu, inputs),
            State::WaitOnSpdu24 | State::WaitOnSpdu26 => self.old(now, octets, &spdu, inputs),
            State::SystemStart20 => {}
        }
    }

    /// An SPDU of all zeros; `true` if it is checked.
    fn checks_all_zero(&mut self, now: u64) -> bool {
        match (self.config.mutant, self.state) {
            (Some(Mutant::AllZeroFirst), State::WaitOnSpdu21)
            | (Some(Mutant::AllZeroInOperation), State::WaitOnSpdu24)
            | (Some(Mutant::AllZeroAfterFault), State::WaitOnSpdu26) => return true,
            (Some(Mutant::AllZeroRestartsDTimer), _) if self.d_timer.is_some() => self.start_d_timer(now),
            _ => {}
        }
        false
    }

    /// An SPDU with the previous counter: nothing happens.
    fn old(&mut self, now: u64, octets: &[u8], spdu: &View<'_>, inputs: &Inputs) {
        match (self.config.mutant, self.state) {
            (Some(Mutant::OldTakenInOperation), State::WaitOnSpdu24) => self.check_spdu_22(now, octets, spdu, inputs),
            (Some(Mutant::OldTakenAfterFault), State::WaitOnSpdu26) => self.check_spdu_27(now, octets, spdu, inputs),
            (Some(Mutant::OldChangesPdout), State::WaitOnSpdu24) => self.outputs.pd_out = self.received_pd(spdu),
            (Some(Mutant::OldChangesPdin), State::WaitOnSpdu24) => self.prepare_response_23(inputs),
            (Some(Mutant::OldRestartsDTimer), _) => self.start_d_timer(now),
            (Some(Mutant::OldCountsSdCycle), State::WaitOnSpdu26) => self.sd_cycles = self.sd_cycles.saturating_sub(1),
            _ => {}
        }
    }

    fn check_spdu_22(&mut self, now: u64, octets: &[u8], spdu: &View<'_>, inputs: &Inputs) {
        let first = self.state == State::WaitOnSpdu21;
        let comm_err = self.checked(octets, spdu) && !(first && self.is(Mutant::FirstSpduUnchecked));
        if comm_err {
            self.restart_d_timer(T25, now);
            self.mirror_m_count(T25);
            self.use_sd(T25);
            self.report_comm_err(T25);
            self.prepare_response_25(inputs);
            match self.config.mutant {
                Some(Mutant::T25StopsDTimer) => self.d_timer = None,
                Some(Mutant::T26ReturnsTo24) => self.state = State::WaitOnSpdu24,
                _ => {}
            }
        } else {
            if !(first && self.is(Mutant::FirstSpduStartsNoDTimer)) {
                self.restart_d_timer(T22, now);
            }
            self.mirror_m_count(T22);
            self.status.d_comm_err = false;
            if !(self.is(Mutant::DTimeoutInFirstAnswers) && self.sd_cycles != 0) {
                self.clear_d_timeout();
            }
            if self.is(Mutant::ZeroReloadsSdCycles) && !first && spdu.counter() == 0 {
                self.load_sd_cycles();
            }
            if self.sd_cycles != 0 {
                self.use_sd(T22);
                self.count_sd_cycle(spdu);
            } else {
                self.outputs.pd_out = self.received_pd(spdu);
                self.outputs.set_sd_dc = false;
                self.status.sd_set = false;
            }
            self.obey_set_sd(self.control(spdu).set_sd);
            self.prepare_response_23(inputs);
        }
    }

    /// The received setSD, as T22 looks at it.
    fn obey_set_sd(&mut self, set_sd: bool) {
        self.latched |= set_sd && self.is(Mutant::SetSdLatched);
        if !(set_sd || self.latched) || self.is(Mutant::SetSdIgnored) {
            return;
        }
        if !self.is(Mutant::SetSdKeepsPdout) {
            self.use_sd_out();
        }
        if !self.is(Mutant::SetSdDcMissing) {
            self.outputs.set_sd_dc = true;
        }
        if self.is(Mutant::SetSdLoadsSdCycles) {
            self.load_sd_cycles();
        }
    }

    fn check_spdu_27(&mut self, now: u64, octets: &[u8], spdu: &View<'_>, inputs: &Inputs) {
        let last = if self.is(Mutant::T28OneEarly) { 1 } else { 0 };
        let worked_off = self.sd_cycles <= last;
        let comm_err = self.checked(octets, spdu)
            && !self.is(if worked_off { Mutant::T28IgnoresCommErr } else { Mutant::T29IgnoresCommErr });
        if comm_err || !worked_off {
            self.restart_d_timer(T29, now);
            self.mirror_m_count(T29);
            self.use_sd(T29);
            if comm_err {
                self.report_comm_err(T29);
                if self.is(Mutant::Sequential) {
                    self.report_once_more();
                }
            } else {
                self.count_sd_cycle(spdu);
                self.report_once_more();
            }
            if self.is(Mutant::T29ClearsSetSdDc) {
                self.outputs.set_sd_dc = false;
            }
            self.prepare_response_25(inputs);
        } else {
            self.restart_d_timer(T28, now);
            self.mirror_m_count(T28);
            self.use_sd_out();
            self.outputs.set_sd_dc = false;
            if self.carries_out(T28, Action::SdSet) {
                self.status.sd_set = false;
            }
            self.status.d_comm_err = false;
            self.clear_d_timeout();
            self.latched &= !self.is(Mutant::SetSdLatched);
            if self.is(Mutant::T28PdoutLive) {
                self.outputs.pd_out = self.received_pd(spdu);
            }
            self.prepare_response_23(inputs);
            if self.is(Mutant::T28ReturnsTo26) {
                self.state = State::WaitOnSpdu26;
            }
        }
    }

    /// T29 without an error: DCommErr and DTimeout once more, if they were set.
    fn report_once_more(&mut self) {
        self.status.d_comm_err = self.comm_err_count;
        self.comm_err_count &= self.is(Mutant::T29KeepsCommErrCount);
        if self.timeout_count {
            self.status.d_timeout = true;
        } else {
            self.clear_d_timeout();
        }
        self.timeout_count &= self.is(Mutant::T29KeepsTimeoutCount);
    }

    /// T23. SDset_DS acts on the answer being sent.
    fn prepare_response_23(&mut self, inputs: &Inputs) {
        self.latched |= inputs.sd_set_ds && self.is(Mutant::SdSetDsLatched);
        let sd_set_ds = match self.config.mutant {
            Some(Mutant::SdSetDsIgnored) => false,
            Some(Mutant::SdSetDsLatched) => self.latched,
            _ => inputs.sd_set_ds,
        };
        if sd_set_ds && self.is(Mutant::SdSetDsAsFault) {
            self.use_sd_out();
        }
        let sd_set = self.status.sd_set && !self.is(Mutant::SdSetDsReplaces);
        self.send_spdu(Status { sd_set: sd_set || sd_set_ds, ..self.status }, inputs);
        self.state = State::WaitOnSpdu24;
    }

    /// T26.
    fn prepare_response_25(&mut self, inputs: &Inputs) {
        self.send_spdu(self.status, inputs);
        self.state = State::WaitOnSpdu26;
    }

    /// The activities of CheckSPDU; the result is CommErr.
    fn checked(&mut self, octets: &[u8], spdu: &View<'_>) -> bool {
        let control = self.control(spdu);
        let previous = self.m_count.replace(control.mcount);
        self.outputs.ch_f_ack_req_dc = match self.config.mutant {
            Some(Mutant::AckReqIgnored) => false,
            Some(Mutant::AckReqLatched) => self.outputs.ch_f_ack_req_dc || control.ch_f_ack_req,
            Some(Mutant::AckReqInOperationOnly) if self.state == State::WaitOnSpdu26 => self.outputs.ch_f_ack_req_dc,
            _ => control.ch_f_ack_req,
        };
        let good =
            self.counter_good(previous, control.mcount) && self.port_good(spdu) && self.signature_good(octets, spdu);
        if self.is(Mutant::PreviousIsLastGood) {
            self.status.dcount_i = 7 - control.mcount;
            self.m_count = if good { self.m_count } else { previous };
        }
        !good
    }

    fn use_sd(&mut self, transition: Transition) {
        if self.carries_out(transition, Action::PdOut) {
            self.use_sd_out();
        }
        if self.carries_out(transition, Action::SetSdDc) {
            self.outputs.set_sd_dc = true;
        }
        if self.carries_out(transition, Action::SdSet) {
            self.status.sd_set = true;
        }
    }

    fn use_sd_out(&mut self) {
        self.outputs.pd_out = Pd::safe(self.config.pd_out.into());
    }

    fn report_comm_err(&mut self, transition: Transition) {
        if self.carries_out(transition, Action::DCommErr) {
            self.status.d_comm_err = true;
        }
        if self.carries_out(transition, Action::CommErrCount) {
            self.comm_err_count = true;
        }
        if self.carries_out(transition, Action::SdCycles) {
            self.load_sd_cycles();
        }
    }

    fn load_sd_cycles(&mut self) {
        self.sd_cycles = match self.config.mutant {
            Some(Mutant::SdCycles2) => 2,
            Some(Mutant::SdCycles4) => 4,
            _ => 3,
        };
    }

    fn count_sd_cycle(&mut self, spdu: &View<'_>) {
        self.sd_cycles = self.sd_cycles.saturating_sub(1);
        if self.is(Mutant::PdoutLiveDuringSdCycles) {
            self.outputs.pd_out = self.received_pd(spdu);
        }
    }

    fn clear_d_timeout(&mut self) {
        // The initial DTimeout is cleared all the same, or the fault would show without any timeout.
        if !(self.is(Mutant::DTimeoutNeverCleared) && self.answer.is_some()) {
            self.status.d_timeout = false;
        }
    }

    /// DCount_i = MCount_inv, the inverse of the MCount received last.
    fn mirror_m_count(&mut self, transition: Transition) {
        if self.carries_out(transition, Action::DCount) && !self.is(Mutant::PreviousIsLastGood) {
            self.status.dcount_i = 7 - self.m_count.unwrap_or(0).min(7);
        }
    }

    fn restart_d_timer(&mut self, transition: Transition, now: u64) {
        if self.carries_out(transition, Action::DTimer) {
            self.start_d_timer(now);
        }
    }

    fn start_d_timer(&mut self, now: u64) {
        self.d_timer = Some(now.saturating_add(self.d_timer_ns()));
    }

    /// FSP_Watchdog in nanoseconds, never 0.
    fn d_timer_ns(&self) -> u64 {
        const MS: u64 = 1_000_000;
        let ms = match self.config.mutant {
            Some(Mutant::WatchdogOctetsSwapped) => self.config.watchdog_ms.swap_bytes(),
            _ => self.config.watchdog_ms,
        };
        let ns = u64::from(ms.max(1)) * MS;
        match self.config.mutant {
            Some(Mutant::WatchdogDoubled) => 2 * ns,
            Some(Mutant::WatchdogEarly) => ns.saturating_sub(MS).max(MS),
            Some(Mutant::WatchdogOneCycleLate) => ns + MS,
            Some(Mutant::WatchdogLate) => ns + 5 * MS,
            _ => ns,
        }
    }

    /// Whether the transition does this; only a mutant leaves an action out.
    fn carries_out(&self, transition: Transition, action: Action) -> bool {
        self.config.mutant.and_then(actions::left_out) != Some((transition, action))
    }

    fn is(&self, mutant: Mutant) -> bool {
        self.config.mutant == Some(mutant)
    }
}
