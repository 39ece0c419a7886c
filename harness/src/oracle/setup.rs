//! What the oracle is told: bench and product beforehand, the application services with every exchange.

use super::Mask;
use fsct_adapters::Octets;
use fsct_protocol::crc::Reading;
use fsct_protocol::spdu::Port;
use fsct_protocol::{Edition, ProtMode};

/// What the oracle has to know of bench and product.
#[derive(Clone, Debug)]
pub struct Setup {
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

/// The output services of the application as reported last.
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
}
