//! What the oracle is told: bench and product beforehand, the application services with every exchange.

use super::Mask;
use super::config::Window;
use fsct_adapters::{Octets, Role, Service};
use fsct_protocol::crc::Reading;
use fsct_protocol::spdu::{Port, View};
use fsct_protocol::{Edition, ProtMode};

/// What the oracle has to know of bench and product.
#[derive(Clone, Debug)]
pub struct Setup {
    /// Side of the link the DUT is on.
    pub role: Role,
    /// Edition judged.
    pub edition: Edition,
    /// Signature in use.
    pub mode: ProtMode,
    /// FS-PDout in octets.
    pub pd_out: usize,
    /// FS-PDin in octets.
    pub pd_in: usize,
    /// FSP_Port.
    pub port: Port,
    /// Reading of the start value (PIXIT, A02).
    pub reading: Reading,
    /// MasterCycleTime in nanoseconds.
    pub cycle_ns: u64,
    /// FSP_Watchdog in nanoseconds.
    pub watchdog_ns: u64,
    /// Tick of the product's timer in nanoseconds: widens the window on both ends (A24).
    pub tick_ns: u64,
    /// How late an expiry may show, in nanoseconds (A24).
    pub margin_ns: u64,
    /// Uncertainty of a time stamp in nanoseconds.
    pub uncertainty_ns: u64,
    /// Exchanges an answer may take to appear.
    pub latency: u64,
    /// How long after FSP parameterization the SCL may take to start, in nanoseconds.
    pub scl_start_ns: u64,
    /// Tolerances in force.
    pub allowed: Mask,
    /// The application services can be observed.
    pub app: bool,
}

impl Setup {
    /// FS process data in an image of the DUT, in octets.
    pub const fn image_pd(&self) -> usize {
        match self.role {
            Role::Device => self.pd_in,
            Role::Master => self.pd_out,
        }
    }

    /// An image of the DUT read as an SPDU; `None` when it is none, too short or all zero.
    pub fn view<'i>(&self, image: Option<&'i Octets>) -> Option<View<'i>> {
        let view = View::new(image?.as_slice(), self.mode, self.image_pd()).ok()?;
        (!view.is_all_zero()).then_some(view)
    }

    /// FS process data in what the DUT is sent, in octets.
    pub const fn sent_pd(&self) -> usize {
        match self.role {
            Role::Device => self.pd_out,
            Role::Master => self.pd_in,
        }
    }

    /// The PortNum octet of what the DUT is sent.
    pub const fn sent_port(&self) -> u8 {
        match self.role {
            Role::Device => self.port.number(),
            Role::Master => self.port.inverted(),
        }
    }

    /// When the watchdog of the DUT expires that was started between these times (A24). MTimer of an FS-Master starts when the
    /// SPDU is handed over: on the line it may expire up to one MasterCycleTime early.
    pub const fn watchdog(&self, started_earliest: u64, started_latest: u64) -> Window {
        let slack = self.tick_ns + self.uncertainty_ns;
        let early = match self.role {
            Role::Device => slack,
            Role::Master => slack + self.cycle_ns,
        };
        Window {
            earliest: (started_earliest + self.watchdog_ns).saturating_sub(early),
            latest: started_latest + self.watchdog_ns + slack + self.margin_ns,
        }
    }

    /// When it expires again after it expired in this window, seen at `at` and not yet at `last_at`.
    pub fn watchdog_again(&self, expired: Window, last_at: u64, at: u64) -> Window {
        let next = self.watchdog(expired.earliest.max(last_at), expired.latest.min(at));
        if next.latest >= at {
            return next;
        }
        // Several expiries since the last exchange: they look like one, and the next may come any time.
        Window { earliest: at, latest: self.watchdog(at, at).latest }
    }
}

/// The output services of the application as reported last: those of Table 29 or those of Table 28.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct App {
    /// PDout_D.
    pub pdout_d: Option<Octets>,
    /// setSD_DC.
    pub set_sd_dc: Option<bool>,
    /// ChFAckReq_DC.
    pub ch_f_ack_req_dc: Option<bool>,
    /// SCL_Fault.
    pub scl_fault: Option<bool>,
    /// PDin_M.
    pub pdin_m: Option<Octets>,
    /// SDset_S.
    pub sdset_s: Option<bool>,
    /// ChFAckReq_S.
    pub ch_f_ack_req_s: Option<bool>,
    /// FAULTS_S.
    pub faults_s: Option<bool>,
    /// Qualifier: GOOD.
    pub qualifier: Option<bool>,
}

impl App {
    /// An output service took a value.
    pub fn report(&mut self, service: Service, value: Octets) {
        let bit = Some(value.is_set());
        match service {
            Service::PdoutD => self.pdout_d = Some(value),
            Service::SetsdDc => self.set_sd_dc = bit,
            Service::ChfackreqDc => self.ch_f_ack_req_dc = bit,
            Service::SclFault => self.scl_fault = bit,
            Service::PdinM => self.pdin_m = Some(value),
            Service::SdsetS => self.sdset_s = bit,
            Service::ChfackreqS => self.ch_f_ack_req_s = bit,
            Service::FaultsS => self.faults_s = bit,
            Service::Qualifier => self.qualifier = bit,
            Service::PdinD
            | Service::SdsetDs
            | Service::OssdeDemand
            | Service::PdoutM
            | Service::SetsdC
            | Service::ChfackC
            | Service::FscpAuthenticity => {}
        }
    }
}
