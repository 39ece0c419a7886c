//! One port of the reference FS-Master: its supply, the DL-mode handler with the Ready pulse (7.2), the Configuration Manager
//! with Data Storage and the verify record (clause 8). What it shows at the gateway is in `gateway`, what it verifies in `verify`.

mod gateway;
mod verify;

use super::MasterMutant;
use super::blocks::{PortConfig, port_mode};
use super::data_storage::{DataStorage, Next};
use super::ossde::Ossde;
use super::scl::{Inputs, Outputs, Scl};
use crate::device::{Pipeline, Sink};
use fsct_adapters::{Identity, Line, Mode, Octets, Response, Seen, Source};
use fsct_protocol::Edition;
use fsct_protocol::fsp::{INDEX_AUTHENTICITY, INDEX_VERIFY};
use fsct_protocol::spdu::Pd;

const MS: u64 = 1_000_000;
/// Width of a Ready pulse (Table 7).
const READY_PULSE_NS: std::ops::RangeInclusive<u64> = 500_000..=1_000_000;
/// From the end of the Ready pulse to the wake-up: behind tRW, before the least tRO of v1.1.
const WAKE_UP_NS: u64 = 100_000;
/// Between two wake-ups without an answer (base standard).
const WAKE_UP_RETRY_NS: u64 = 50 * MS;
const WAKE_UPS: u8 = 3;
/// How long the answer to on-request data is waited for.
const REQUEST_NS: u64 = 5_000 * MS;
/// EventQualifiers of the base standard: an Error of the port that appears.
const PORT_ERROR_APPEARS: u8 = 0xFC;
/// EventCode of iec2022 Table B.2: OSSD locked.
const OSSD_LOCKED: u16 = 0x20F0;
/// EventCode of the base standard: another Device than configured.
const INCORRECT_DEVICE: u16 = 0x1803;

/// How far the start of the port is.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
enum Phase {
    /// Nothing goes on: deactivated, or switched off for good.
    Rest,
    /// Supply off until then.
    Off { until: u64 },
    /// WaitOnReadyPulse_10, until then.
    WaitOnReadyPulse { until: u64, high_since: Option<u64> },
    /// EstablishCom_1: the next wake-up comes then.
    WakeUp { at: u64, done: u8 },
    /// DS_ParamManager_2: the answer to its request has to come until then.
    Storing { until: u64 },
    /// Send_VerifyRecord_9: the answer has to come until then.
    Record { until: u64 },
    /// PortFault_3.
    Fault,
    /// OPERATE; with the fault `record-after-operate` its record may still be open.
    Operate,
    /// Digital inputs or output, or OSSDe.
    Digital,
}

/// The port.
#[derive(Debug)]
pub struct PortUnit {
    number: u8,
    edition: Edition,
    mutant: Option<MasterMutant>,
    latency: u8,
    /// Its configuration, if it has one.
    pub config: Option<PortConfig>,
    phase: Phase,
    l_plus: bool,
    power_off_by_service: bool,
    device: Option<Identity>,
    mode: Mode,
    scl: Option<Scl>,
    ossde: Option<Ossde>,
    storage: DataStorage,
    /// With the fault `record-before-data-storage`: the record has been sent, Data Storage goes on.
    stored: bool,
    levels: (bool, bool),
    inputs: Inputs,
    outputs: Outputs,
    /// When the request that is open is given up.
    asked: Option<u64>,
    images: Pipeline,
    /// FSInBuffer.
    pub fs_in: Vec<u8>,
    /// InBuffer.
    pub nsr_in: Vec<u8>,
    /// OutBuffer.
    pub nsr_out: Vec<u8>,
    diags: Vec<(u8, u16)>,
}

impl PortUnit {
    /// A port without configuration, its supply off.
    pub fn new(number: u8, edition: Edition, pd_in: u8, latency: u8, mutant: Option<MasterMutant>) -> PortUnit {
        PortUnit {
            number,
            edition,
            mutant,
            latency,
            config: None,
            phase: Phase::Rest,
            l_plus: false,
            power_off_by_service: false,
            device: None,
            mode: Mode::Inactive,
            scl: None,
            ossde: None,
            storage: DataStorage::new(mutant),
            stored: false,
            levels: (false, false),
            inputs: Inputs { pd_out: Pd::safe(0), set_sd_c: false, ch_f_ack_c: false },
            outputs: Outputs::initial(pd_in),
            asked: None,
            images: Pipeline::new(Octets::default(), latency),
            fs_in: Vec::new(),
            nsr_in: Vec::new(),
            nsr_out: Vec::new(),
            diags: Vec::new(),
        }
    }

    /// The FS-Master has been switched on: services are reported, a stored configuration starts.
    pub fn power_on(&mut self, now: u64, seen: &mut Sink<'_>) {
        self.report(None, seen);
        // In iec2022 a configuration for commissioning does not survive.
        let volatile = self.edition == Edition::Iec2022 && !self.is(MasterMutant::CommissioningKept);
        let stored =
            self.config.take().filter(|config| !(volatile && config.is_safety() && config.protocol.tech_par_crc == 0));
        if let Some(config) = stored {
            self.configure(now, config, seen);
        }
    }

    /// What does not survive a power cycle of the FS-Master.
    pub fn power_off(&mut self) {
        let config = self.config.take();
        let pd_in = self.outputs.pd_in.octets().len() as u8;
        let (device, storage) = (self.device, self.storage.clone());
        *self = PortUnit::new(self.number, self.edition, pd_in, self.latency, self.mutant);
        (self.config, self.device, self.storage) = (config, device, storage);
    }

    /// The port is as it came from the factory, `pd_in` octets of PDin_M; what is connected to it stays.
    pub fn forget(&mut self, pd_in: u8, seen: &mut Sink<'_>) {
        self.set_mode(Mode::Inactive, seen);
        self.supply(false, seen);
        let fresh = PortUnit::new(self.number, self.edition, pd_in, self.latency, self.mutant);
        let old = std::mem::replace(self, fresh);
        (self.device, self.levels, self.inputs) = (old.device, old.levels, old.inputs);
        self.outputs = old.outputs;
        self.show(Outputs::initial(pd_in), seen);
    }

    /// SMI_PortConfiguration: the port starts anew, with an SCL of its own.
    pub fn configure(&mut self, now: u64, config: PortConfig, seen: &mut Sink<'_>) {
        self.set_mode(Mode::Inactive, seen);
        (self.scl, self.ossde, self.power_off_by_service) = (None, None, false);
        self.diags.clear();
        let (pd_in, pd_out) = config.pd();
        if self.inputs.pd_out.octets().len() != usize::from(pd_out) {
            self.inputs.pd_out = Pd::safe(pd_out.into());
        }
        let (safety, off_ms) = (config.is_safety(), config.off_ms);
        self.storage.configure(&config);
        self.config = Some(config);
        self.clear_buffers((0, 0));
        self.show(Outputs::initial(pd_in), seen);
        if safety && self.l_plus {
            self.cycle(now, off_ms, seen);
        } else {
            self.start(now, seen);
        }
    }

    fn port_mode(&self) -> u8 {
        self.config.as_ref().map_or(port_mode::DEACTIVATED, |config| config.port_mode)
    }

    fn start(&mut self, now: u64, seen: &mut Sink<'_>) {
        match self.port_mode() {
            port_mode::SAFETYCOM | port_mode::MIXEDSAFETYCOM => self.wait_on_ready_pulse(now, seen),
            port_mode::IOL_MANUAL | port_mode::IOL_AUTOSTART if self.is(MasterMutant::WaitsOnPlainPort) => {
                self.wait_on_ready_pulse(now, seen);
            }
            port_mode::IOL_MANUAL | port_mode::IOL_AUTOSTART => {
                self.supply(true, seen);
                self.phase = Phase::WakeUp { at: now + MS, done: 0 };
            }
            mode @ (port_mode::OSSDE | port_mode::DI_CQ | port_mode::DO_CQ) => {
                self.supply(true, seen);
                self.phase = Phase::Digital;
                if mode == port_mode::OSSDE && self.ossde.is_none() {
                    self.ossde = Some(Ossde::new(now, self.levels, self.inputs.ch_f_ack_c, self.mutant));
                }
            }
            _ => {
                self.supply(false, seen);
                self.phase = Phase::Rest;
            }
        }
    }

    fn supply(&mut self, on: bool, seen: &mut Sink<'_>) {
        if self.l_plus != on {
            self.l_plus = on;
            seen.push(Seen::Line { port: self.number, line: Line::Power, level: on });
        }
    }

    fn set_mode(&mut self, mode: Mode, seen: &mut Sink<'_>) {
        if mode == Mode::Inactive {
            self.asked = None;
        }
        if self.mode != mode {
            self.mode = mode;
            seen.push(Seen::Mode { port: self.number, mode });
        }
    }

    fn is(&self, mutant: MasterMutant) -> bool {
        self.mutant == Some(mutant)
    }

    fn cycle(&mut self, now: u64, off_ms: u64, seen: &mut Sink<'_>) {
        self.supply(self.l_plus && self.is(MasterMutant::SupplyStaysOn), seen);
        self.phase = Phase::Off { until: now + off_ms * MS };
    }

    fn wait_on_ready_pulse(&mut self, now: u64, seen: &mut Sink<'_>) {
        self.supply(true, seen);
        if self.is(MasterMutant::WakeUpBeforeReadyPulse) {
            self.phase = Phase::WakeUp { at: now + WAKE_UP_NS, done: 0 };
            return;
        }
        let unit = if self.is(MasterMutant::TimeToReadyTooShort) { 10 } else { 1 };
        let wait = self.config.as_ref().map_or(0, |config| config.time_to_ready_ms / unit);
        self.phase = Phase::WaitOnReadyPulse { until: now + wait * MS, high_since: self.levels.0.then_some(now) };
    }

    /// SMI_PortPowerOffOn.
    pub fn switch(&mut self, now: u64, on: bool, back_after_ms: Option<u64>, seen: &mut Sink<'_>) {
        if on {
            if !self.l_plus {
                self.restart(now, seen);
            }
            return;
        }
        self.set_mode(Mode::Inactive, seen);
        match back_after_ms {
            Some(ms) if !self.is(MasterMutant::PowerOffForGood) => self.cycle(now, ms, seen),
            _ => {
                self.power_off_by_service = true;
                self.supply(false, seen);
                self.phase = Phase::Rest;
            }
        }
    }

    /// The supply comes back: the port starts as it is configured, its SCL goes on. One that is deactivated has its supply
    /// because it was asked for, and nothing else.
    fn restart(&mut self, now: u64, seen: &mut Sink<'_>) {
        self.power_off_by_service = false;
        if self.port_mode() == port_mode::DEACTIVATED {
            self.supply(true, seen);
            self.phase = Phase::Rest;
        } else {
            self.start(now, seen);
        }
    }

    /// The Ready pulse did not come, nobody answered, or communication is lost: only a new supply cycle brings a new pulse.
    fn start_again(&mut self, now: u64, seen: &mut Sink<'_>) {
        let off_ms = self.config.as_ref().map_or(PortConfig::LEAST_OFF_MS, |config| config.off_ms);
        self.cycle(now, off_ms, seen);
    }

    /// A Device is connected, or none.
    pub fn plug(&mut self, now: u64, device: Option<Identity>, seen: &mut Sink<'_>) {
        self.device = device;
        let unnoticed = self.is(MasterMutant::ComlostUnnoticed);
        if self.device.is_none() && self.mode != Mode::Inactive && !unnoticed {
            // COMLOST
            if self.is(MasterMutant::SclAnewAfterComlost) {
                self.scl = None;
            }
            self.set_mode(Mode::Inactive, seen);
            self.start_again(now, seen);
        }
    }

    /// A level on C/Q or I/Q.
    pub fn drive(&mut self, now: u64, line: Line, level: bool) {
        if line == Line::Iq {
            self.levels.1 = level;
        } else {
            self.levels.0 = level;
        }
        if let Some(ossde) = &mut self.ossde {
            match line {
                Line::Iq => ossde.drive_iq(now, level),
                _ => ossde.drive_cq(now, level),
            }
        }
        if let (Phase::WaitOnReadyPulse { until, high_since }, Line::Cq) = (self.phase, line) {
            self.phase = match high_since {
                Some(since) if !level && READY_PULSE_NS.contains(&(now - since)) => {
                    Phase::WakeUp { at: now + WAKE_UP_NS, done: 0 }
                }
                _ => Phase::WaitOnReadyPulse { until, high_since: level.then_some(now) },
            };
        }
    }

    /// The Device has answered the request that is open. What it says of the record is not looked at: a refused one shows in the
    /// SCL.
    pub fn respond(&mut self, now: u64, response: &Response, fscp: Option<[u8; 8]>, seen: &mut Sink<'_>) {
        self.asked = None;
        match self.phase {
            Phase::Storing { .. } => {
                let next = self.storage.answered(response);
                let without = self.is(MasterMutant::RefusedDownloadWithoutRecord);
                if without && matches!(response, Response::Refused(_)) && next == Next::Ready {
                    return self.operate(now, fscp, seen);
                }
                self.store(now, next, fscp, seen);
            }
            Phase::Record { .. } if self.is(MasterMutant::RecordBeforeDataStorage) && !self.stored => {
                self.stored = true;
                let next = self.config.as_ref().map_or(Next::Ready, |config| self.storage.start(config));
                self.store(now, next, fscp, seen);
            }
            Phase::Record { .. } => self.operate(now, fscp, seen),
            _ => {}
        }
    }

    /// What Data Storage comes to: its next request, the verify record (T17), or the end of the start (T6).
    fn store(&mut self, now: u64, next: Next, fscp: Option<[u8; 8]>, seen: &mut Sink<'_>) {
        match next {
            Next::Ask((index, subindex, data)) => {
                self.ask(now, index, subindex, data, seen);
                self.phase = Phase::Storing { until: now + REQUEST_NS };
            }
            Next::Ready if self.stored => self.operate(now, fscp, seen),
            Next::Ready => self.send_record(now, fscp, seen),
            Next::Fault => self.phase = Phase::Fault,
        }
    }

    /// When something happens next by itself.
    pub fn due(&self) -> Option<u64> {
        let phase = match self.phase {
            Phase::Off { until } | Phase::WaitOnReadyPulse { until, .. } => Some(until),
            Phase::Storing { until } | Phase::Record { until } => Some(until),
            Phase::WakeUp { at, .. } => Some(at),
            Phase::Rest | Phase::Fault | Phase::Operate | Phase::Digital => None,
        };
        let scl = self.scl.as_ref().and_then(Scl::due);
        let ossde = self.ossde.as_ref().and_then(Ossde::due);
        [phase, scl, ossde].into_iter().flatten().min()
    }

    /// Passes over what is due up to `to` and changes nothing.
    pub fn skip(&mut self, to: u64) {
        if let Some(scl) = &mut self.scl {
            scl.skip(to);
        }
    }

    /// What is due at this time is done.
    pub fn pass(&mut self, now: u64, fscp: Option<[u8; 8]>, seen: &mut Sink<'_>) {
        if let Some(scl) = &mut self.scl
            && scl.due().is_some_and(|due| due <= now)
        {
            scl.expire(now);
            self.show_scl(seen);
        }
        if let Some(ossde) = &mut self.ossde
            && ossde.due().is_some_and(|due| due <= now)
        {
            let fault = ossde.pass(now);
            self.show_ossde(seen);
            if fault && self.edition == Edition::Iec2022 {
                self.port_event(OSSD_LOCKED, seen);
            }
        }
        match self.phase {
            Phase::Off { until } if until <= now => self.restart(now, seen),
            Phase::WaitOnReadyPulse { until, .. } if until <= now => {
                self.phase = Phase::Rest;
                if !self.is(MasterMutant::NoSecondSupplyCycle) {
                    self.start_again(now, seen);
                }
            }
            Phase::WakeUp { at, done } if at <= now => self.wake_up(now, done, fscp, seen),
            Phase::Storing { until } | Phase::Record { until } if until <= now => self.phase = Phase::Fault,
            _ => {}
        }
    }

    fn wake_up(&mut self, now: u64, done: u8, fscp: Option<[u8; 8]>, seen: &mut Sink<'_>) {
        seen.push(Seen::Line { port: self.number, line: Line::WakeUp, level: true });
        let Some(device) = self.device else {
            if done + 1 < WAKE_UPS || self.is(MasterMutant::WakeUpForEver) {
                self.phase = Phase::WakeUp { at: now + WAKE_UP_RETRY_NS, done: done.saturating_add(1) };
            } else {
                self.start_again(now, seen);
            }
            return;
        };
        // What was pending belongs to the communication before.
        self.diags.clear();
        self.set_mode(Mode::Startup, seen);
        let Some(config) = &self.config else { return };
        let manual = config.port_mode != port_mode::IOL_AUTOSTART;
        let validated = manual && (1..=4).contains(&config.validation);
        let vendor_compared = !self.is(MasterMutant::VendorIdNotCompared);
        let other_vendor = vendor_compared && config.vendor_id != device.vendor_id;
        let other = validated && (other_vendor || config.device_id != device.device_id);
        let cycle_compared = manual && config.cycle_time != 0 && !self.is(MasterMutant::CycleTimeNotCompared);
        let too_fast = cycle_compared && config.cycle_time < device.min_cycle_time;
        if !self.is(MasterMutant::RecordInStartup) {
            self.set_mode(Mode::Preoperate, seen);
        }
        if other || too_fast {
            self.phase = Phase::Fault;
            return self.port_event(INCORRECT_DEVICE, seen);
        }
        self.stored = false;
        if self.is(MasterMutant::RecordBeforeDataStorage) {
            return self.send_record(now, fscp, seen);
        }
        let next = self.config.as_ref().map_or(Next::Ready, |config| self.storage.start(config));
        self.store(now, next, fscp, seen);
    }

    /// Send_VerifyRecord_9 on a safety port, OPERATE on any other (T5).
    fn send_record(&mut self, now: u64, fscp: Option<[u8; 8]>, seen: &mut Sink<'_>) {
        let Some(config) = &self.config else { return };
        let (safety, record) = (config.is_safety(), config.record.clone());
        let again = self.is(MasterMutant::RecordAtFirstStartOnly) && self.scl.is_some();
        if !safety || again || self.is(MasterMutant::RecordMissing) {
            return self.operate(now, fscp, seen);
        }
        if self.is(MasterMutant::RecordAfterOperate) {
            self.operate(now, fscp, seen);
            return self.ask(now, INDEX_VERIFY, 0, Some(record), seen);
        }
        let index = if self.is(MasterMutant::RecordToAuthenticity) { INDEX_AUTHENTICITY } else { INDEX_VERIFY };
        self.ask(now, index, 0, Some(record), seen);
        self.phase = Phase::Record { until: now + REQUEST_NS };
    }

    /// On-request data for the Device.
    pub fn ask(&mut self, now: u64, index: u16, subindex: u8, data: Option<Vec<u8>>, seen: &mut Sink<'_>) {
        self.asked = Some(now + REQUEST_NS);
        seen.push(Seen::Request { port: self.number, index, subindex, data });
    }

    /// Whether a request is open: the next one has to wait.
    pub fn is_asking(&self, now: u64) -> bool {
        self.asked.is_some_and(|until| now < until)
    }

    fn operate(&mut self, now: u64, fscp: Option<[u8; 8]>, seen: &mut Sink<'_>) {
        self.phase = Phase::Operate;
        self.set_mode(Mode::Operate, seen);
        let Some(config) = &self.config else { return };
        let (spdu_in, spdu_out) = config.spdu();
        let of_device = self
            .device
            .map_or((0, 0), |device| (device.pd_in.saturating_sub(spdu_in), device.pd_out.saturating_sub(spdu_out)));
        let nsr = config.nsr.unwrap_or(of_device);
        let start = config.is_safety() && self.scl.is_none();
        let verified = start.then(|| verify::verify(self.edition, self.number, config, fscp, self.mutant));
        // The SPDU of an SCL that goes on stands all the while.
        if self.scl.is_none() {
            self.clear_buffers(nsr);
        }
        match verified {
            Some(Ok(verified)) => {
                self.scl = Some(Scl::start(now, verified.config(self.mutant)));
                self.show_scl(seen);
            }
            Some(Err(_)) if self.is(MasterMutant::VerifyEventMissing) => {}
            Some(Err(code)) => self.port_event(code, seen),
            None => {}
        }
    }

    /// The buffers of clause 10.5 hold zeros, so many of them non-safety octets.
    fn clear_buffers(&mut self, nsr: (u8, u8)) {
        let (spdu_in, spdu_out) = self.config.as_ref().map_or((0, 0), PortConfig::spdu);
        self.fs_in = vec![0; spdu_in.into()];
        self.nsr_in = vec![0; nsr.0.into()];
        self.nsr_out = vec![0; nsr.1.into()];
        self.images = Pipeline::new(Octets::zero(usize::from(spdu_out) + self.nsr_out.len()), self.latency);
    }

    fn port_event(&mut self, code: u16, seen: &mut Sink<'_>) {
        self.pend(PORT_ERROR_APPEARS, code);
        seen.push(Seen::Indication { port: self.number, source: Source::Port, qualifier: PORT_ERROR_APPEARS, code });
    }
}
