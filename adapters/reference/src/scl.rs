//! The Safety Communication Layer of an FS-Device (11.5.3), written by hand from the state figure and Table 40.
//!
//! Sans-IO: time comes in as an argument in nanoseconds, no clock is read here. Where the texts leave a choice:
//! - T29 is read nested: CommErrCount and TimeoutCount are worked off in error-free cycles only.
//! - The previous SPDU is the one checked last, whatever the check said; DCount_i is the inverse of what was received.
//! - An SPDU of all zeros is ignored in every state.
//! - A jump of MCount is an error, not an old SPDU. The first SPDU must carry 0, in v1.1 as well.
//! - DTimer has expired once FSP_Watchdog has passed; an SPDU received at that very instant comes after the expiry.

use crate::Mutant;
use fsct_protocol::ProtMode;
use fsct_protocol::crc::{Reading, crc16, crc32};
use fsct_protocol::spdu::{Control, Emitted, Pd, Port, Status, View, Wire};

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
            comm_err_count: false,
            timeout_count: false,
            status: Status { d_timeout: true, ..Status::default() },
            outputs: Outputs::initial(config.pd_out),
            answer: None,
        };
        scl.load_sd_cycles();
        scl
    }

    /// T20: the start of the system is OK.
    pub fn system_start_ok(&mut self) {
        if self.state == State::SystemStart20 {
            self.state = State::WaitOnSpdu21;
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
        self.use_sd();
        self.status.d_timeout = true;
        self.timeout_count = true;
        self.load_sd_cycles();
        self.restart_d_timer(now - (now - due) % self.d_timer_ns());
        self.mirror_m_count();
        self.prepare_response_25(inputs);
        Some(due)
    }

    /// T21, T24, T27: octets arrived at `now`. Octets too short for an SPDU, an SPDU of all zeros and an old SPDU
    /// change nothing; what follows the SPDU is non-safety data.
    pub fn received(&mut self, now: u64, octets: &[u8], inputs: &Inputs) {
        let Ok(spdu) = View::new(octets, self.config.mode, self.config.pd_out.into()) else { return };
        if spdu.is_all_zero() {
            return;
        }
        let not_old = self.m_count != Some(spdu.counter());
        match self.state {
            State::WaitOnSpdu21 => self.check_spdu_22(now, octets, &spdu, inputs),
            State::WaitOnSpdu24 if not_old => self.check_spdu_22(now, octets, &spdu, inputs),
            State::WaitOnSpdu26 if not_old => self.check_spdu_27(now, octets, &spdu, inputs),
            State::SystemStart20 | State::WaitOnSpdu24 | State::WaitOnSpdu26 => {}
        }
    }

    fn check_spdu_22(&mut self, now: u64, octets: &[u8], spdu: &View<'_>, inputs: &Inputs) {
        let comm_err = self.checked(octets, spdu);
        self.restart_d_timer(now);
        self.mirror_m_count();
        if comm_err {
            // T25
            self.use_sd();
            self.status.d_comm_err = true;
            self.comm_err_count = true;
            self.load_sd_cycles();
            self.prepare_response_25(inputs);
        } else {
            // T22
            self.status.d_comm_err = false;
            self.clear_d_timeout();
            if self.sd_cycles != 0 {
                self.use_sd();
                self.count_sd_cycle(spdu);
            } else {
                self.outputs.pd_out = received_pd(spdu);
                self.outputs.set_sd_dc = false;
                self.status.sd_set = false;
            }
            if spdu.control().set_sd && !self.is(Mutant::SetSdIgnored) {
                self.use_sd_out();
                self.outputs.set_sd_dc = true;
            }
            self.prepare_response_23(inputs);
        }
    }

    fn check_spdu_27(&mut self, now: u64, octets: &[u8], spdu: &View<'_>, inputs: &Inputs) {
        let comm_err = self.checked(octets, spdu);
        self.restart_d_timer(now);
        self.mirror_m_count();
        if comm_err || self.sd_cycles > 0 {
            // T29
            self.use_sd();
            if comm_err {
                self.status.d_comm_err = true;
                self.comm_err_count = true;
                self.load_sd_cycles();
            } else {
                self.count_sd_cycle(spdu);
                self.status.d_comm_err = std::mem::take(&mut self.comm_err_count);
                if std::mem::take(&mut self.timeout_count) {
                    self.status.d_timeout = true;
                } else {
                    self.clear_d_timeout();
                }
            }
            self.prepare_response_25(inputs);
        } else {
            // T28
            self.use_sd_out();
            self.outputs.set_sd_dc = false;
            self.status.sd_set = false;
            self.status.d_comm_err = false;
            self.clear_d_timeout();
            self.prepare_response_23(inputs);
        }
    }

    /// T23. SDset_DS acts on the answer being sent.
    fn prepare_response_23(&mut self, inputs: &Inputs) {
        let status = Status { sd_set: self.status.sd_set || inputs.sd_set_ds, ..self.status };
        self.send_spdu(status, inputs);
        self.state = State::WaitOnSpdu24;
    }

    /// T26.
    fn prepare_response_25(&mut self, inputs: &Inputs) {
        self.send_spdu(self.status, inputs);
        self.state = State::WaitOnSpdu26;
    }

    /// The activities of CheckSPDU; the result is CommErr.
    fn checked(&mut self, octets: &[u8], spdu: &View<'_>) -> bool {
        let control = Control::from_octet(spdu.octet());
        let previous = self.m_count.replace(control.mcount);
        self.outputs.ch_f_ack_req_dc = control.ch_f_ack_req;

        let counter_good = match previous {
            _ if self.is(Mutant::CounterCheckMissing) => true,
            _ if control.mcount == 0 => true,
            None => false,
            Some(7) => control.mcount == 1,
            Some(previous) => control.mcount == previous + 1,
        };
        let port_good = spdu.port_num() == self.config.port.number();
        let secured = octets.get(..spdu.pd().len() + 2).unwrap_or_default();
        !(counter_good && port_good && self.signature(secured) == spdu.signature())
    }

    fn send_spdu(&mut self, mut status: Status, inputs: &Inputs) {
        if self.is(Mutant::DCommErrNeverReported) {
            status.d_comm_err = false;
        }
        let port = self.config.port;
        let wire = Wire {
            pd: inputs.pd_in,
            port_num: if self.is(Mutant::PortNotInverted) { port.number() } else { port.inverted() },
            octet: status.to_octet(),
            signature: Some(0),
        };
        let mut spdu = wire.emit(self.config.mode, Reading::Preset);
        let octets = spdu.octets_mut();
        let length = self.config.mode.signature_octets();
        if let Some((secured, sent)) = octets.split_at_mut_checked(octets.len().saturating_sub(length)) {
            let signature = self.signature(secured).to_be_bytes();
            sent.copy_from_slice(&signature[signature.len() - length..]);
        }
        self.answer = Some(spdu);
    }

    /// The signature over `secured`: start value 1, a result of 0 becomes 1 (11.4.7).
    fn signature(&self, secured: &[u8]) -> u32 {
        let wrong_seed = self.is(Mutant::WrongSeed);
        let computed = match self.config.mode {
            ProtMode::Crc16 => crc16(if wrong_seed { 0 } else { 1 }, secured).into(),
            ProtMode::Crc32 => crc32(if wrong_seed { 0 } else { 1 }, secured),
        };
        if computed == 0 && !self.is(Mutant::ZeroNotReplaced) { 1 } else { computed }
    }

    fn use_sd(&mut self) {
        self.use_sd_out();
        self.outputs.set_sd_dc = true;
        self.status.sd_set = true;
    }

    fn use_sd_out(&mut self) {
        self.outputs.pd_out = Pd::safe(self.config.pd_out.into());
    }

    fn load_sd_cycles(&mut self) {
        self.sd_cycles = if self.is(Mutant::SdCycles2) { 2 } else { 3 };
    }

    fn count_sd_cycle(&mut self, spdu: &View<'_>) {
        self.sd_cycles = self.sd_cycles.saturating_sub(1);
        if self.is(Mutant::PdoutLiveDuringSdCycles) {
            self.outputs.pd_out = received_pd(spdu);
        }
    }

    fn clear_d_timeout(&mut self) {
        // The initial DTimeout is cleared all the same, or the fault would show without any timeout.
        if !(self.is(Mutant::DTimeoutNeverCleared) && self.answer.is_some()) {
            self.status.d_timeout = false;
        }
    }

    /// DCount_i = MCount_inv, the inverse of the MCount received last.
    fn mirror_m_count(&mut self) {
        self.status.dcount_i = 7 - self.m_count.unwrap_or(0).min(7);
    }

    fn restart_d_timer(&mut self, now: u64) {
        self.d_timer = Some(now.saturating_add(self.d_timer_ns()));
    }

    /// FSP_Watchdog in nanoseconds, never 0.
    fn d_timer_ns(&self) -> u64 {
        let factor = if self.is(Mutant::WatchdogDoubled) { 2 } else { 1 };
        factor * u64::from(self.config.watchdog_ms.max(1)) * 1_000_000
    }

    fn is(&self, mutant: Mutant) -> bool {
        self.config.mutant == Some(mutant)
    }
}

fn received_pd(spdu: &View<'_>) -> Pd {
    Pd::new(spdu.pd()).unwrap_or(Pd::safe(spdu.pd().len()))
}
