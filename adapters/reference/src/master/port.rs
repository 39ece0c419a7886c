//! One port of the reference FS-Master: its supply, the DL-mode handler with the Ready pulse (7.2), the Configuration Manager
//! with the verify record (clause 8), its SCL or OSSDe block, and the services at the gateway.

use super::MasterMutant;
use super::blocks::{PortConfig, PortStatus, port_mode};
use super::ossde::Ossde;
use super::scl::{Config, Inputs, Outputs, Scl};
use crate::device::{Pipeline, Sink};
use fsct_adapters::{Identity, Line, Mode, Octets, Response, Seen, Service, Source};
use fsct_protocol::crc::crc16;
use fsct_protocol::fsp::INDEX_VERIFY;
use fsct_protocol::spdu::{Pd, Port};
use fsct_protocol::{Edition, ProtMode};

const MS: u64 = 1_000_000;
/// Width of a Ready pulse (Table 7).
const READY_PULSE_NS: std::ops::RangeInclusive<u64> = 500_000..=1_000_000;
/// From the end of the Ready pulse to the wake-up: behind tRW, before the least tRO of v1.1.
const WAKE_UP_NS: u64 = 100_000;
/// Between two wake-ups without an answer (base standard).
const WAKE_UP_RETRY_NS: u64 = 50 * MS;
const WAKE_UPS: u8 = 3;
/// How long the answer to the verify record is waited for.
const RECORD_NS: u64 = 5_000 * MS;
/// EventQualifiers of the base standard: an Error of the port that appears.
const PORT_ERROR_APPEARS: u8 = 0xFC;
/// EventQualifier bits: mode appears, and types Warning and Error.
const APPEARS: u8 = 0xC0;
/// EventCode of the base standard: another Device than configured.
const INCORRECT_DEVICE: u16 = 0x1803;

/// PortStatusInfo (10.3.5).
pub mod info {
    /// NO_DEVICE.
    pub const NO_DEVICE: u8 = 0;
    /// DEACTIVATED.
    pub const DEACTIVATED: u8 = 1;
    /// INCORRECT_DEVICE (v1.1), PORT_DIAG (iec2022).
    pub const PORT_DIAG: u8 = 2;
    /// PREOPERATE (v1.1).
    pub const PREOPERATE: u8 = 3;
    /// OPERATE.
    pub const OPERATE: u8 = 4;
    /// DI_C/Q.
    pub const DI_CQ: u8 = 5;
    /// DO_C/Q.
    pub const DO_CQ: u8 = 6;
    /// OSSDE.
    pub const OSSDE: u8 = 7;
    /// SPDU_EXCHANGE (v1.1), SCL_ENABLED (iec2022).
    pub const SCL_ENABLED: u8 = 8;
    /// PORT_POWER_OFF (iec2022).
    pub const PORT_POWER_OFF: u8 = 254;
}

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
    /// On-request data for the Device are not answered yet.
    asked: bool,
    mode: Mode,
    scl: Option<Scl>,
    ossde: Option<Ossde>,
    levels: (bool, bool),
    inputs: Inputs,
    outputs: Outputs,
    images: Pipeline,
    /// Safety part of the input image.
    pub fs_in: Vec<u8>,
    /// Non-safety part of the input image.
    pub nsr_in: Vec<u8>,
    /// Non-safety part of the output image.
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
            asked: false,
            mode: Mode::Inactive,
            scl: None,
            ossde: None,
            levels: (false, false),
            inputs: Inputs { pd_out: Pd::safe(0), set_sd_c: false, ch_f_ack_c: false },
            outputs: Outputs::initial(pd_in),
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
        let volatile = self.edition == Edition::Iec2022;
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
        let device = self.device;
        *self = PortUnit::new(self.number, self.edition, pd_in, self.latency, self.mutant);
        (self.config, self.device) = (config, device);
    }

    /// SMI_PortConfiguration: the port starts anew, with an SCL of its own.
    pub fn configure(&mut self, now: u64, config: PortConfig, seen: &mut Sink<'_>) {
        self.set_mode(Mode::Inactive, seen);
        (self.scl, self.ossde, self.power_off_by_service) = (None, None, false);
        self.diags.clear();
        let (mode, off_ms) = (config.port_mode, config.off_ms);
        let pd = |spdu: u8| match ProtMode::from_code(config.protocol.mode) {
            Some(mode) => spdu.saturating_sub(mode.spdu_octets(0) as u8),
            None => 0,
        };
        let (pd_in, pd_out) = if mode == port_mode::OSSDE { (1, 0) } else { (pd(config.spdu_in), pd(config.spdu_out)) };
        if self.inputs.pd_out.octets().len() != usize::from(pd_out) {
            self.inputs.pd_out = Pd::safe(pd_out.into());
        }
        self.images = Pipeline::new(Octets::zero(config.spdu_out.into()), self.latency);
        self.nsr_out = vec![0; config.nsr.unwrap_or((0, 0)).1.into()];
        self.config = Some(config);
        self.show(Outputs::initial(pd_in), seen);
        match mode {
            port_mode::SAFETYCOM | port_mode::MIXEDSAFETYCOM if self.l_plus => self.cycle(now, off_ms, seen),
            port_mode::SAFETYCOM | port_mode::MIXEDSAFETYCOM => self.wait_on_ready_pulse(now, seen),
            port_mode::IOL_MANUAL | port_mode::IOL_AUTOSTART => {
                self.supply(true, seen);
                self.phase = Phase::WakeUp { at: now + MS, done: 0 };
            }
            port_mode::OSSDE => {
                self.supply(true, seen);
                self.phase = Phase::Digital;
                self.ossde = Some(Ossde::new(now, self.levels.0, self.levels.1, self.inputs.ch_f_ack_c));
            }
            port_mode::DI_CQ | port_mode::DO_CQ => {
                self.supply(true, seen);
                self.phase = Phase::Digital;
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
        if self.mode != mode {
            self.asked &= mode != Mode::Inactive;
            self.mode = mode;
            seen.push(Seen::Mode { port: self.number, mode });
        }
    }

    fn cycle(&mut self, now: u64, off_ms: u64, seen: &mut Sink<'_>) {
        self.supply(false, seen);
        self.phase = Phase::Off { until: now + off_ms * MS };
    }

    fn wait_on_ready_pulse(&mut self, now: u64, seen: &mut Sink<'_>) {
        self.supply(true, seen);
        let wait = self.config.as_ref().map_or(0, |config| config.time_to_ready_ms);
        self.phase = Phase::WaitOnReadyPulse { until: now + wait * MS, high_since: self.levels.0.then_some(now) };
    }

    /// SMI_PortPowerOffOn.
    pub fn switch(&mut self, now: u64, on: bool, back_after_ms: Option<u64>, seen: &mut Sink<'_>) {
        if on {
            self.power_off_by_service = false;
            if !self.l_plus {
                self.restart(now, seen);
            }
            return;
        }
        self.set_mode(Mode::Inactive, seen);
        match back_after_ms {
            Some(ms) => self.cycle(now, ms, seen),
            None => {
                self.power_off_by_service = true;
                self.supply(false, seen);
                self.phase = Phase::Rest;
            }
        }
    }

    /// The supply comes back: the port starts as it is configured, its SCL goes on.
    fn restart(&mut self, now: u64, seen: &mut Sink<'_>) {
        match self.config.as_ref().map(PortConfig::is_safety) {
            Some(true) => self.wait_on_ready_pulse(now, seen),
            Some(false) => {
                self.supply(true, seen);
                self.phase = match self.ossde {
                    Some(_) => Phase::Digital,
                    None => Phase::WakeUp { at: now + MS, done: 0 },
                };
            }
            None => {}
        }
    }

    /// A Device is connected, or none.
    pub fn plug(&mut self, now: u64, device: Option<Identity>, seen: &mut Sink<'_>) {
        self.device = device;
        if self.device.is_none() && self.mode != Mode::Inactive {
            // COMLOST: only a new supply cycle brings a new Ready pulse.
            self.set_mode(Mode::Inactive, seen);
            let off_ms = self.config.as_ref().map_or(1_000, |config| config.off_ms);
            self.cycle(now, off_ms, seen);
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

    /// The Device has answered what was sent last.
    pub fn respond(&mut self, now: u64, _response: &Response, fscp: Option<[u8; 8]>, seen: &mut Sink<'_>) {
        if !std::mem::take(&mut self.asked) {
            return seen.push(Seen::Unsupported);
        }
        // Table 12 does not say what a refusal leads to: the record has been sent.
        if matches!(self.phase, Phase::Record { .. }) {
            self.operate(now, fscp, seen);
        }
    }

    /// When something happens next by itself.
    pub fn due(&self) -> Option<u64> {
        let phase = match self.phase {
            Phase::Off { until } | Phase::WaitOnReadyPulse { until, .. } | Phase::Record { until } => Some(until),
            Phase::WakeUp { at, .. } => Some(at),
            Phase::Rest | Phase::Fault | Phase::Operate | Phase::Digital => None,
        };
        let scl = self.scl.as_ref().and_then(Scl::due);
        let ossde = self.ossde.as_ref().and_then(Ossde::due);
        [phase, scl, ossde].into_iter().flatten().min()
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
                self.port_event(0x20F0, seen);
            }
        }
        match self.phase {
            Phase::Off { until } if until <= now => self.restart(now, seen),
            Phase::WaitOnReadyPulse { until, .. } if until <= now => {
                let off_ms = self.config.as_ref().map_or(1_000, |config| config.off_ms);
                self.cycle(now, off_ms, seen);
            }
            Phase::WakeUp { at, done } if at <= now => self.wake_up(now, done, fscp, seen),
            Phase::Record { until } if until <= now => self.phase = Phase::Fault,
            _ => {}
        }
    }

    fn wake_up(&mut self, now: u64, done: u8, fscp: Option<[u8; 8]>, seen: &mut Sink<'_>) {
        seen.push(Seen::Line { port: self.number, line: Line::WakeUp, level: true });
        let Some(device) = self.device else {
            if done + 1 < WAKE_UPS {
                self.phase = Phase::WakeUp { at: now + WAKE_UP_RETRY_NS, done: done + 1 };
            } else {
                let off_ms = self.config.as_ref().map_or(1_000, |config| config.off_ms);
                self.cycle(now, off_ms, seen);
            }
            return;
        };
        self.set_mode(Mode::Startup, seen);
        let Some(config) = &self.config else { return };
        let manual = config.port_mode != port_mode::IOL_AUTOSTART;
        let validated = manual && (1..=4).contains(&config.validation);
        let other = validated && (config.vendor_id, config.device_id) != (device.vendor_id, device.device_id);
        let too_fast = manual && config.cycle_time != 0 && config.cycle_time < device.min_cycle_time;
        let (safety, record) = (config.is_safety(), config.record.clone());
        self.set_mode(Mode::Preoperate, seen);
        if other || too_fast {
            self.phase = Phase::Fault;
            return self.port_event(INCORRECT_DEVICE, seen);
        }
        if !safety || self.mutant == Some(MasterMutant::RecordAfterOperate) {
            self.operate(now, fscp, seen);
            if safety {
                self.send_record(record, seen);
            }
            return;
        }
        self.send_record(record, seen);
        self.phase = Phase::Record { until: now + RECORD_NS };
    }

    fn send_record(&mut self, record: Vec<u8>, seen: &mut Sink<'_>) {
        self.asked = true;
        seen.push(Seen::Request { port: self.number, index: INDEX_VERIFY, subindex: 0, data: Some(record) });
    }

    fn operate(&mut self, _now: u64, fscp: Option<[u8; 8]>, seen: &mut Sink<'_>) {
        self.phase = Phase::Operate;
        self.set_mode(Mode::Operate, seen);
        let Some(config) = &self.config else { return };
        if let (Some(device), None) = (&self.device, config.nsr) {
            let spdu = if config.is_safety() { (config.spdu_in, config.spdu_out) } else { (0, 0) };
            self.nsr_out = vec![0; device.pd_out.saturating_sub(spdu.1).into()];
        }
        if !config.is_safety() || self.scl.is_some() {
            return;
        }
        match self.verify(config, fscp) {
            Ok(config) => {
                self.scl = Some(Scl::start(config));
                self.show_scl(seen);
            }
            Err(code) => self.port_event(code, seen),
        }
    }

    /// What the SCL of the FS-Master verifies before it starts (10.4.3.1, Table B.2): the EventCode of the first deviation.
    fn verify(&self, config: &PortConfig, fscp: Option<[u8; 8]>) -> Result<Config, u16> {
        let code = |number: u16| if self.edition == Edition::V1_1 { 0xB000 + number } else { 0x2000 + number };
        let record = &config.record;
        let signed = |from: usize, to: usize| {
            let sent =
                record.get(to..to + 2).map(|sent| sent.iter().fold(0, |value, octet| value << 8 | u16::from(*octet)));
            record.get(from..to).map(|octets| crc16(0, octets)) == sent
        };
        let armed = config.protocol.tech_par_crc != 0;
        let mut own = config.authenticity.authenticity_1.to_be_bytes().to_vec();
        own.extend(config.authenticity.authenticity_2.to_be_bytes());
        let authentic = fscp.is_none_or(|fscp| own == fscp);
        if !signed(0, 9) {
            return Err(code(5));
        }
        if !signed(11, 21) {
            return Err(code(6));
        }
        if config.protocol.watchdog_ms == 0 {
            return Err(code(9));
        }
        if (armed || self.edition == Edition::V1_1) && !authentic {
            return Err(code(3));
        }
        if self.edition == Edition::V1_1 && config.authenticity.port != self.number {
            return Err(code(4));
        }
        let mode = ProtMode::from_code(config.protocol.mode).filter(|_| config.protocol.version == 1).ok_or(code(6))?;
        let pd = |spdu: u8| {
            let pd = usize::from(spdu).checked_sub(mode.spdu_octets(0)).filter(|pd| *pd <= mode.max_pd());
            pd.map(|pd| pd as u8).ok_or(code(6))
        };
        Ok(Config {
            mode,
            pd_in: pd(config.spdu_in)?,
            pd_out: pd(config.spdu_out)?,
            port: Port::new(config.authenticity.port).ok_or(code(6))?,
            watchdog_ms: config.protocol.watchdog_ms,
            mutant: self.mutant,
        })
    }

    fn port_event(&mut self, code: u16, seen: &mut Sink<'_>) {
        self.diags.push((PORT_ERROR_APPEARS, code));
        seen.push(Seen::Indication { port: self.number, source: Source::Port, qualifier: PORT_ERROR_APPEARS, code });
    }

    /// The Device raises an Event.
    pub fn raise(&mut self, code: u16, qualifier: u8, seen: &mut Sink<'_>) {
        if matches!(self.mode, Mode::Preoperate | Mode::Operate) {
            if qualifier & APPEARS == APPEARS && qualifier & 0x20 != 0 {
                self.diags.push((qualifier, code));
            }
            seen.push(Seen::Indication { port: self.number, source: Source::Device, qualifier, code });
        }
    }

    /// One exchange; `None` when no process data are exchanged.
    pub fn exchange(&mut self, now: u64, received: Option<&Octets>, seen: &mut Sink<'_>) -> Option<Octets> {
        if self.mode != Mode::Operate {
            return None;
        }
        let config = self.config.as_ref()?;
        let (spdu_in, spdu_out) =
            if config.is_safety() { (config.spdu_in.into(), usize::from(config.spdu_out)) } else { (0, 0) };
        if let Some(octets) = received {
            let (safety, other) = octets.as_slice().split_at_checked(spdu_in).unwrap_or((octets.as_slice(), &[]));
            (self.fs_in, self.nsr_in) = (safety.to_vec(), other.to_vec());
            if let Some(scl) = &mut self.scl
                && safety.len() == spdu_in
            {
                scl.received(now, safety, &self.inputs);
                self.show_scl(seen);
            }
        }
        let mut image = self.scl.as_ref().map_or_else(|| vec![0; spdu_out], |scl| scl.spdu().to_vec());
        image.extend(&self.nsr_out);
        Some(self.images.pass(Octets::new(&image).unwrap_or_default()))
    }

    /// Whether an input service was taken.
    pub fn set(&mut self, service: Service, value: &Octets, seen: &mut Sink<'_>) -> bool {
        match (service, value.as_slice()) {
            (Service::PdoutM, octets) => match Pd::new(octets) {
                Some(pd) => self.inputs.pd_out = pd,
                None => return false,
            },
            (Service::SetsdC, [bit @ (0 | 1)]) => self.inputs.set_sd_c = *bit == 1,
            (Service::ChfackC, [bit @ (0 | 1)]) => {
                self.inputs.ch_f_ack_c = *bit == 1;
                if let Some(ossde) = &mut self.ossde {
                    ossde.ack_q(*bit == 1);
                    self.show_ossde(seen);
                }
            }
            _ => return false,
        }
        true
    }

    fn show_scl(&mut self, seen: &mut Sink<'_>) {
        if let Some(outputs) = self.scl.as_ref().map(|scl| *scl.outputs()) {
            self.show(outputs, seen);
        }
    }

    fn show_ossde(&mut self, seen: &mut Sink<'_>) {
        let Some(shown) = self.ossde.as_ref().map(Ossde::outputs) else { return };
        let outputs = Outputs {
            pd_in: Pd::new(&[if shown.on { 0b11 } else { 0 }]).unwrap_or(Pd::safe(1)),
            sd_set_s: !shown.qualifier,
            ch_f_ack_req_s: shown.ch_f_ack_req,
            faults_s: false,
            qualifier: shown.qualifier,
        };
        self.show(outputs, seen);
    }

    fn show(&mut self, outputs: Outputs, seen: &mut Sink<'_>) {
        if outputs != self.outputs {
            let old = std::mem::replace(&mut self.outputs, outputs);
            self.report(Some(&old), seen);
        }
    }

    /// Reports each output that is not as in `old`, or all of them.
    fn report(&self, old: Option<&Outputs>, seen: &mut Sink<'_>) {
        let new = &self.outputs;
        let mut push = |service, value| seen.push(Seen::Service { port: self.number, service, value });
        if old.is_none_or(|old| old.pd_in != new.pd_in) {
            push(Service::PdinM, Octets::new(new.pd_in.octets()).unwrap_or_default());
        }
        for (service, value, before) in [
            (Service::SdsetS, new.sd_set_s, old.map(|old| old.sd_set_s)),
            (Service::ChfackreqS, new.ch_f_ack_req_s, old.map(|old| old.ch_f_ack_req_s)),
            (Service::FaultsS, new.faults_s, old.map(|old| old.faults_s)),
            (Service::Qualifier, new.qualifier, old.map(|old| old.qualifier)),
        ] {
            if before != Some(value) {
                push(service, Octets::bit(value));
            }
        }
    }

    /// What SMI_PortStatus reports.
    pub fn status(&self) -> PortStatus {
        let communicates = self.mode != Mode::Inactive;
        let config = self.config.as_ref();
        let mode = config.map_or(port_mode::DEACTIVATED, |config| config.port_mode);
        let info = match (self.phase, self.mode) {
            _ if mode == port_mode::DEACTIVATED => info::DEACTIVATED,
            _ if self.power_off_by_service && self.edition == Edition::Iec2022 => info::PORT_POWER_OFF,
            (Phase::Digital, _) => match mode {
                port_mode::OSSDE => info::OSSDE,
                port_mode::DO_CQ => info::DO_CQ,
                _ => info::DI_CQ,
            },
            (Phase::Fault, _) => info::PORT_DIAG,
            (Phase::Operate, _) if self.scl.is_some() => info::SCL_ENABLED,
            (Phase::Operate, _) => info::OPERATE,
            (_, Mode::Preoperate) if self.edition == Edition::V1_1 => info::PREOPERATE,
            (_, Mode::Preoperate) => info::PORT_DIAG,
            _ => info::NO_DEVICE,
        };
        let nsr = self.device.filter(|_| communicates).zip(config).map_or((0, 0), |(device, config)| {
            let spdu = if config.is_safety() { (config.spdu_in, config.spdu_out) } else { (0, 0) };
            (device.pd_in.saturating_sub(spdu.0), device.pd_out.saturating_sub(spdu.1))
        });
        PortStatus {
            info,
            quality: if self.mode == Mode::Operate { 0 } else { 0b11 },
            revision_id: self.device.filter(|_| communicates).map_or(0, |device| device.revision_id),
            transmission_rate: self.device.filter(|_| communicates).map_or(0, |device| device.com),
            master_cycle_time: self.device.filter(|_| communicates).map_or(0, |device| device.min_cycle_time),
            nsr,
            vendor_id: config.map_or(0, |config| config.vendor_id),
            device_id: config.map_or(0, |config| config.device_id),
            diags: self.diags.clone(),
        }
    }

    /// Whether on-request data for the Device are not answered yet.
    pub const fn is_asked(&self) -> bool {
        self.asked
    }

    /// Mode of the Device on the port.
    pub const fn mode(&self) -> Mode {
        self.mode
    }

    /// Whether an SCL runs.
    pub const fn has_scl(&self) -> bool {
        self.scl.is_some()
    }

    /// Octet 0 of FSInBuffer in OSSDe mode.
    pub fn ossde_image(&self) -> Option<u8> {
        self.ossde.as_ref().map(Ossde::image)
    }

    /// The safety part of the output image.
    pub fn fs_out(&self) -> Vec<u8> {
        self.scl.as_ref().map_or_else(Vec::new, |scl| scl.spdu().to_vec())
    }

    /// On-request data for the Device on behalf of an SMI client.
    pub fn ask(&mut self, index: u16, subindex: u8, data: Option<Vec<u8>>, seen: &mut Sink<'_>) {
        self.asked = true;
        seen.push(Seen::Request { port: self.number, index, subindex, data });
    }
}
