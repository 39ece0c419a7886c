//! The virtual FS-Device as a conformant partner: Table 40 interpreted, over the link as it is.

use crate::oracle::Setup;
use fsct_adapters::Octets;
use fsct_protocol::scl::device::{Readings, Received};
use fsct_protocol::scl::{Device, State};
use fsct_protocol::spdu::{InSpdu, Pd, View};

/// A conformant FS-Device on one port of an FS-Master.
#[derive(Clone, Debug)]
pub struct Keeper {
    device: Device,
    /// When DTimer was started, in nanoseconds.
    timer: u64,
    /// PDin it sends from the next answer on.
    pub pdin: Pd,
    sent: Pd,
    octets: Option<Octets>,
}

impl Keeper {
    /// An FS-Device that waits for its first SPDU.
    pub fn started(setup: &Setup, pdin: Pd) -> Keeper {
        let mut device = Device::new(Readings::default());
        device.start();
        let zero = Octets::zero(setup.mode.spdu_octets(setup.pd_in));
        Keeper { device, timer: 0, pdin, sent: Pd::safe(setup.pd_in), octets: Some(zero) }
    }

    /// An FS-Device in regular operation that has answered this MCount last.
    pub fn regular(setup: &Setup, pdin: Pd, mcount: u8, now: u64) -> Keeper {
        let mut keeper =
            Keeper { device: Device::regular(mcount), timer: now, pdin, sent: Pd::safe(setup.pd_in), octets: None };
        keeper.emit(setup);
        keeper
    }

    /// What it presents.
    pub fn octets(&self) -> Option<Octets> {
        self.octets
    }

    /// PDin of what it presents.
    pub fn sent(&self) -> Pd {
        self.sent
    }

    /// MCount it has answered last; `None` before the first SPDU.
    pub fn answered(&self) -> Option<u8> {
        self.device.previous()
    }

    /// Regular operation as the FS-Device sees it.
    pub fn operates(&self) -> bool {
        self.device.state() == State(24) && !self.device.status().sd_set && self.device.uses_pdout()
    }

    /// What the FS-Master presents has reached it.
    pub fn received(&mut self, now: u64, image: Option<&Octets>, setup: &Setup) {
        let view = image.and_then(|octets| View::new(octets.as_slice(), setup.mode, setup.pd_out).ok());
        let view = view.filter(|view| !view.is_all_zero());
        let taken = view.is_some_and(|view| {
            let intact = view.signature_matches(setup.reading) && view.port_num() == setup.port.number();
            !self.device.receive(Received { control: view.control(), intact }).is_empty()
        });
        let expired = !taken
            && self.device.timer_runs()
            && now >= self.timer + setup.watchdog_ns
            && !self.device.expire().is_empty();
        if taken || expired {
            self.timer = now;
            self.emit(setup);
        }
    }

    fn emit(&mut self, setup: &Setup) {
        self.sent = self.pdin;
        let spdu = InSpdu { pd: self.pdin, port: setup.port, status: self.device.status() };
        self.octets = Octets::new(spdu.wire().emit(setup.mode, setup.reading).octets());
    }
}
