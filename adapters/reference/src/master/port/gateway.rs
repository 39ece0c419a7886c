//! What a port shows at the gateway and to the SMI: process data exchange (10.5), the services of Table 28, its status.

use super::{Phase, PortUnit};
use crate::device::Sink;
use crate::master::MasterMutant;
use crate::master::blocks::{PortConfig, PortStatus, port_mode};
use crate::master::ossde::Ossde;
use crate::master::scl::Outputs;
use fsct_adapters::{Mode, Octets, Seen, Service, Source};
use fsct_protocol::Edition;
use fsct_protocol::spdu::Pd;

// EventQualifier of the base standard.
const MODE: u8 = 0xC0;
const MODE_APPEARS: u8 = 0xC0;
const MODE_DISAPPEARS: u8 = 0x80;
const TYPE: u8 = 0x30;
const TYPE_WARNING: u8 = 0x20;
const TYPE_ERROR: u8 = 0x30;

/// EventCodes of an FS-Device that are reserved in both editions (Table B.1).
const RESERVED_OF_DEVICE: std::ops::RangeInclusive<u16> = 0xB00B..=0xB0FF;

/// PortStatusInfo (10.3.5).
mod info {
    /// NO_DEVICE.
    pub(super) const NO_DEVICE: u8 = 0;
    /// DEACTIVATED.
    pub(super) const DEACTIVATED: u8 = 1;
    /// INCORRECT_DEVICE (v1.1), PORT_DIAG (iec2022).
    pub(super) const PORT_DIAG: u8 = 2;
    /// PREOPERATE (v1.1).
    pub(super) const PREOPERATE: u8 = 3;
    /// OPERATE.
    pub(super) const OPERATE: u8 = 4;
    /// DI_C/Q.
    pub(super) const DI_CQ: u8 = 5;
    /// DO_C/Q.
    pub(super) const DO_CQ: u8 = 6;
    /// OSSDE.
    pub(super) const OSSDE: u8 = 7;
    /// SPDU_EXCHANGE (v1.1), SCL_ENABLED (iec2022).
    pub(super) const SCL_ENABLED: u8 = 8;
    /// PORT_POWER_OFF (iec2022).
    pub(super) const PORT_POWER_OFF: u8 = 254;
}

impl PortUnit {
    /// The Device raises an Event.
    pub fn raise(&mut self, code: u16, qualifier: u8, seen: &mut Sink<'_>) {
        if !matches!(self.mode, Mode::Preoperate | Mode::Operate) {
            return;
        }
        if self.is(MasterMutant::DeviceEventDropped) {
            return;
        }
        let lasting = matches!(qualifier & TYPE, TYPE_WARNING | TYPE_ERROR);
        match qualifier & MODE {
            MODE_APPEARS if lasting => self.pend(qualifier, code),
            MODE_DISAPPEARS => self.diags.retain(|known| *known != (qualifier & !MODE | MODE_APPEARS, code)),
            _ => {}
        }
        seen.push(Seen::Indication { port: self.number, source: Source::Device, qualifier, code });
        if self.is(MasterMutant::ReservedEventEvaluated) && RESERVED_OF_DEVICE.contains(&code) {
            self.phase = Phase::Fault;
            self.set_mode(Mode::Preoperate, seen);
        }
    }

    /// A DiagEntry, once.
    pub(super) fn pend(&mut self, qualifier: u8, code: u16) {
        if !self.diags.contains(&(qualifier, code)) && !self.is(MasterMutant::DiagNotListed) {
            self.diags.push((qualifier, code));
        }
    }

    /// One exchange; `None` when no process data are exchanged.
    pub fn exchange(&mut self, now: u64, received: Option<&Octets>, seen: &mut Sink<'_>) -> Option<Octets> {
        if self.mode != Mode::Operate {
            return None;
        }
        let (spdu_in, _) = self.config.as_ref()?.spdu();
        // Process data of another length than configured are no message.
        let length = usize::from(spdu_in) + self.nsr_in.len();
        if let Some(octets) = received.map(Octets::as_slice).filter(|octets| octets.len() == length) {
            let before = self.is(MasterMutant::NsrBeforeSpdu);
            let (safety, other) = if before {
                let (other, safety) = octets.split_at_checked(self.nsr_in.len())?;
                (safety, other)
            } else {
                octets.split_at_checked(spdu_in.into())?
            };
            self.fs_in = safety.to_vec();
            self.nsr_in.iter_mut().zip(other).for_each(|(octet, new)| *octet = *new);
            if let Some(scl) = &mut self.scl {
                scl.received(now, safety, &self.inputs);
                self.show_scl(seen);
            }
        } else if let Some(scl) = &mut self.scl {
            scl.missed();
        }
        let mut image = [self.fs_out(), self.nsr_out.clone()];
        if self.is(MasterMutant::NsrBeforeSpdu) {
            image.reverse();
        }
        let image = image.concat();
        Some(self.images.pass(Octets::new(&image).unwrap_or_default()))
    }

    /// Whether an input service was taken.
    pub fn set(&mut self, service: Service, value: &Octets, seen: &mut Sink<'_>) -> bool {
        match (service, value.as_slice()) {
            (Service::PdoutM, octets) => {
                // How many octets there are is known once the port is configured.
                let safety = self.config.as_ref().is_some_and(PortConfig::is_safety);
                let fits = !safety || octets.len() == self.inputs.pd_out.octets().len();
                match Pd::new(octets) {
                    Some(pd) if fits => self.inputs.pd_out = pd,
                    _ => return false,
                }
            }
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

    pub(super) fn show_scl(&mut self, seen: &mut Sink<'_>) {
        let Some(mut outputs) = self.scl.as_ref().map(|scl| *scl.outputs()) else { return };
        outputs.pd_in = self.delivered(outputs.pd_in);
        let fault = outputs.faults_s && !self.outputs.faults_s;
        self.show(outputs, seen);
        if fault && self.is(MasterMutant::ReservedEventUsed) {
            let reserved = if self.edition == Edition::V1_1 { 0xB00A } else { 0x200A };
            self.port_event(reserved, seen);
        }
    }

    /// PDin_M as the gateway gets it from the SCL.
    fn delivered(&self, pd_in: Pd) -> Pd {
        let mut octets = pd_in.octets().to_vec();
        match self.mutant {
            Some(MasterMutant::PdinCutAt16) => octets.iter_mut().skip(16).for_each(|octet| *octet = 0),
            Some(MasterMutant::PdinOfPdoutLength) => octets.resize(self.inputs.pd_out.octets().len(), 0),
            _ => return pd_in,
        }
        Pd::new(&octets).unwrap_or(pd_in)
    }

    pub(super) fn show_ossde(&mut self, seen: &mut Sink<'_>) {
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

    pub(super) fn show(&mut self, outputs: Outputs, seen: &mut Sink<'_>) {
        if outputs != self.outputs {
            let old = std::mem::replace(&mut self.outputs, outputs);
            self.report(Some(&old), seen);
        }
    }

    /// Reports each output that is not as in `old`, or all of them.
    pub(super) fn report(&self, old: Option<&Outputs>, seen: &mut Sink<'_>) {
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
            (Phase::Operate, _) if self.scl.is_some() && !self.is(MasterMutant::SclStatusOperate) => info::SCL_ENABLED,
            (Phase::Operate, _) => info::OPERATE,
            (_, Mode::Preoperate) if self.is(MasterMutant::SclStatusInPreoperate) => info::SCL_ENABLED,
            (_, Mode::Preoperate) if self.edition == Edition::V1_1 => info::PREOPERATE,
            (_, Mode::Preoperate) => info::PORT_DIAG,
            _ => info::NO_DEVICE,
        };
        let device = self.device.filter(|_| communicates);
        let nsr = device.zip(config).map_or((0, 0), |(device, config)| {
            let (spdu_in, spdu_out) = config.spdu();
            (device.pd_in.saturating_sub(spdu_in), device.pd_out.saturating_sub(spdu_out))
        });
        // The PortModes that validate nothing know the Device only from itself.
        let ids = match (device, config) {
            (Some(device), _) => (device.vendor_id, device.device_id),
            (None, Some(config)) => (config.vendor_id, config.device_id),
            (None, None) => (0, 0),
        };
        PortStatus {
            info,
            quality: if self.mode == Mode::Operate { 0 } else { 0b11 },
            revision_id: device.map_or(0, |device| device.revision_id),
            transmission_rate: device.map_or(0, |device| device.com),
            master_cycle_time: device.map_or(0, |device| device.min_cycle_time),
            nsr,
            vendor_id: ids.0,
            device_id: ids.1,
            diags: self.diags.clone(),
        }
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

    /// The safety part of the output image: all zeros while no SCL sends.
    pub fn fs_out(&self) -> Vec<u8> {
        let silent = || vec![0; self.config.as_ref().map_or(0, |config| config.spdu().1).into()];
        self.scl.as_ref().map_or_else(silent, |scl| scl.spdu().to_vec())
    }
}
