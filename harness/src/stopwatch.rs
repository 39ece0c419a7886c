//! DTimer and MTimer as a partner sees them: from the first copy of an SPDU to what tells that the other side has given up.

use crate::oracle::Setup;
use fsct_adapters::{Octets, Role, Service};
use fsct_lines::{Measured, Quantity};

/// Follows one link. All times in nanoseconds from the beginning of the case.
#[derive(Clone, Debug, Default)]
pub struct Stopwatch {
    /// When the SPDU that restarts the timer was first on the line.
    started: Option<u64>,
    /// The latest exchange.
    latest: u64,
    sent: Option<Octets>,
    image: Option<Octets>,
    timed_out: bool,
    /// When the application of the DUT was told to take the safe state.
    told: Option<u64>,
    expired: Option<Expired>,
}

/// A time-out that was seen.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
struct Expired {
    started: u64,
    /// The last exchange without it, and the first one with it.
    between: (u64, u64),
    told: Option<u64>,
}

impl Stopwatch {
    /// An exchange: what a DUT of this setup got and what it presents.
    pub fn exchange(&mut self, setup: &Setup, at: u64, sent: Option<Octets>, image: Option<Octets>) {
        let view = setup.view(image.as_ref());
        match setup.role {
            Role::Device => {
                if sent.is_some() && sent != self.sent {
                    self.started = Some(at);
                }
                let timed_out = view.is_some_and(|view| view.status().d_timeout);
                if timed_out && !self.timed_out {
                    self.expire(at);
                }
                self.timed_out = timed_out;
            }
            Role::Master => {
                if image != self.image {
                    // MCount is 0 at the start and after a time-out alone.
                    if view.is_some_and(|view| view.control().mcount == 0) {
                        self.expire(at);
                    }
                    self.started = Some(at);
                }
            }
        }
        self.sent = sent.or(self.sent);
        self.image = image;
        self.latest = at;
    }

    /// An output service of the application took a value.
    pub fn report(&mut self, service: Service, is_set: bool, at: u64) {
        if matches!(service, Service::SetsdDc | Service::SdsetS) {
            self.told = is_set.then_some(at);
        }
    }

    /// The latest time-out, as exactly as it was seen; an edge or stamp may be off by `uncertainty_ns` either way.
    pub fn measured(&self, quantity: Quantity, uncertainty_ns: u64) -> Option<Measured> {
        let Expired { started, between: (quiet, seen), told } = self.expired?;
        let (low, high) = match told.filter(|at| (quiet..=seen).contains(at)) {
            Some(at) => (at, at),
            None => (quiet, seen),
        };
        Some(Measured {
            quantity,
            low: low.saturating_sub(started),
            high: high.saturating_sub(started),
            uncertainty: 2 * uncertainty_ns,
            at: started,
            episode: 0,
        })
    }

    fn expire(&mut self, at: u64) {
        if let Some(started) = self.started {
            self.expired = Some(Expired { started, between: (self.latest, at), told: self.told });
        }
    }
}
