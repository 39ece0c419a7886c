//! The always-on oracle: beside a case's own expectations every exchange is compared with the tables of the standard.
//!
//! It keeps the *set* of configurations a conformant DUT may be in: races within the uncertainty of time stamps, answers that
//! take some exchanges to appear, readings that a tolerance allows. An exchange that no configuration explains is a
//! mismatch, told against the configuration that came closest.

mod config;
mod device;
mod explain;
mod explain_device;
mod explain_master;
mod master;
mod ossde;
pub mod readings;
mod set;
mod setup;
#[cfg(test)]
mod tests;
mod tolerance;

pub use device::DeviceOracle;
pub use explain::Mismatch;
pub use master::MasterOracle;
pub use ossde::OssdeOracle;
pub use readings::Readings;
pub use setup::{App, Setup};
pub use tolerance::{Mask, Stance, Tolerance, Tolerances};

use crate::conditions::Sides;
use crate::walk::Walked;
use fsct_adapters::{Octets, Role, Service};
use fsct_protocol::scl::State;

/// The oracle of one link, by the side the DUT is on.
#[derive(Debug)]
#[expect(clippy::large_enum_variant, reason = "one per link, made once and not moved in the exchanges")]
pub enum Oracle {
    /// The DUT is an FS-Device.
    Device(DeviceOracle),
    /// The DUT is an FS-Master: one of its ports.
    Master(Box<MasterOracle>),
}

impl Oracle {
    /// For a DUT without supply.
    pub fn new(setup: Setup) -> Oracle {
        match setup.role {
            Role::Device => Oracle::Device(DeviceOracle::new(setup)),
            Role::Master => Oracle::Master(Box::new(MasterOracle::new(setup))),
        }
    }

    /// What it judges by.
    pub const fn setup(&self) -> &Setup {
        match self {
            Oracle::Device(oracle) => oracle.setup(),
            Oracle::Master(oracle) => oracle.setup(),
        }
    }

    /// Supply on or off.
    pub fn power(&mut self, on: bool) {
        match self {
            Oracle::Device(oracle) => oracle.power(on),
            Oracle::Master(oracle) => oracle.power(on),
        }
    }

    /// The SCL may start from this time on.
    pub fn parameterized(&mut self, at: u64) {
        match self {
            Oracle::Device(oracle) => oracle.parameterized(at),
            Oracle::Master(oracle) => oracle.parameterized(at),
        }
    }

    /// An input service of the application was set.
    pub fn input(&mut self, service: Service, value: &Octets) {
        match self {
            Oracle::Device(oracle) => oracle.input(service, value),
            Oracle::Master(oracle) => oracle.input(service, value),
        }
    }

    /// One exchange: what the DUT received, the image it presented, and its application services afterwards.
    ///
    /// # Errors
    /// The [`Mismatch`] when no configuration explains it.
    pub fn exchange(
        &mut self,
        at: u64,
        received: Option<&[u8]>,
        image: Option<&[u8]>,
        app: &App,
    ) -> Result<(), Mismatch> {
        match self {
            Oracle::Device(oracle) => oracle.exchange(at, received, image, app),
            Oracle::Master(oracle) => oracle.exchange(at, received, image, app),
        }
    }

    /// How often each transition was taken, over the whole case.
    pub fn taken(&self) -> Vec<(u8, u64)> {
        let (first, taken) = match self {
            Oracle::Device(oracle) => (20, oracle.set().taken()),
            Oracle::Master(oracle) => (1, oracle.set().taken()),
        };
        (first..).zip(taken).filter(|(_, count)| *count > 0).collect()
    }

    /// What followed what, over the whole case.
    pub fn walked(&self) -> Walked {
        match self {
            Oracle::Device(oracle) => oracle.set().walked(),
            Oracle::Master(oracle) => oracle.set().walked(),
        }
    }

    /// Which way conditions decided, over the whole case.
    pub fn sides(&self) -> Sides {
        match self {
            Oracle::Device(oracle) => oracle.set().sides(),
            Oracle::Master(oracle) => oracle.set().sides(),
        }
    }

    /// Tolerances the DUT made use of, over the whole case.
    pub fn used(&self) -> Mask {
        match self {
            Oracle::Device(oracle) => oracle.set().used(),
            Oracle::Master(oracle) => oracle.set().used(),
        }
    }

    /// Transitions of the latest exchange by number, filled up with 0.
    pub fn via(&self) -> [u8; 8] {
        let mut taken = [0; 8];
        match self {
            Oracle::Device(oracle) => taken.iter_mut().zip(oracle.set().via()).for_each(|(slot, t)| *slot = t.0),
            Oracle::Master(oracle) => taken.iter_mut().zip(oracle.set().via()).for_each(|(slot, t)| *slot = t.0),
        }
        taken
    }

    /// Whether the SCL of the DUT may still be on its way to its first SPDU, or to state 21.
    pub fn may_be_starting(&self) -> bool {
        match self {
            Oracle::Device(oracle) => oracle.set().may_be_starting(),
            Oracle::Master(oracle) => oracle.set().may_be_starting(),
        }
    }

    /// The state the DUT is in as far as it can be told; `None` when no SCL runs.
    pub fn state(&self) -> Option<State> {
        match self {
            Oracle::Device(oracle) => oracle.set().state(),
            Oracle::Master(oracle) => oracle.set().state(),
        }
    }
}
