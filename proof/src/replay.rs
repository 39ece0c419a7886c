//! A chart once more, with both machines reading the tables by default: the same channel, power and inputs. What it shows is
//! what a conformant DUT does where the machines of the chart went wrong.

use crate::chart::{Line, Turn};
use crate::exchange::{Fate, image};
use crate::model::{Model, Timing};
use crate::recovery::operates;
use fsct_protocol::scl::device::{Readings, Received};
use fsct_protocol::scl::master::Answer;
use fsct_protocol::scl::{Device, Master, Path, State, Var};
use fsct_protocol::spdu::{Control, Status};

/// Exchanges behind a chart at most: twice what recovery takes with the longest watchdog.
const MOST: usize = 80;

/// What surrounds both machines in an exchange.
#[derive(Copy, Clone)]
struct Given {
    there: Fate,
    back: Fate,
    powered: bool,
    sdset_ds: bool,
    ch_f_ack_c: bool,
    set_sd_c: bool,
    /// Timers that win against a reception in the same exchange (A37).
    expires: (bool, bool),
}

struct Play<'m> {
    model: &'m Model,
    master: Master,
    device: Device,
    mtimer: u8,
    dtimer: u8,
}

/// The exchanges of a chart with machines of the default readings. Behind them, where `on` says so, a healthy link and an operator
/// who acknowledges when asked, until both sides operate.
pub fn replay(model: &Model, chart: &[Line], on: bool) -> Vec<Turn> {
    let mut master = Master::new();
    master.start();
    let device = Device::new(Readings::default());
    let mut play = Play { model, master, device, mtimer: 0, dtimer: 0 };
    let mut turns: Vec<Turn> = chart.iter().map(|line| play.exchange(Given::from(&line.turn))).collect();
    while on && turns.len() < chart.len() + MOST && !operates(&play.master.into(), &play.device.into()) {
        let willing = Given::willing(play.master.get(Var::ChFAckCe) == 1);
        turns.push(play.exchange(willing));
    }
    turns
}

impl From<&Turn> for Given {
    fn from(turn: &Turn) -> Given {
        Given {
            there: turn.there,
            back: turn.back,
            powered: turn.powered(),
            sdset_ds: turn.sdset_ds,
            ch_f_ack_c: turn.ch_f_ack_c,
            set_sd_c: turn.set_sd_c,
            expires: (turn.master_expired(), turn.device_expired()),
        }
    }
}

impl Given {
    fn willing(ch_f_ack_c: bool) -> Given {
        let (there, back) = (Fate::Delivered, Fate::Delivered);
        Given { there, back, powered: true, sdset_ds: false, ch_f_ack_c, set_sd_c: false, expires: (false, false) }
    }
}

impl Play<'_> {
    fn exchange(&mut self, given: Given) -> Turn {
        let (master_before, device_before) = (self.master, self.device);
        let control = self.master.control();
        let device_path = self.device_takes(given, control);
        let answering = if self.model.timing == Timing::Pipelined { device_before } else { self.device };
        let status = image(&answering.into());
        let master_path = self.master_takes(given, status);
        Turn {
            control,
            pdout: master_before.uses_pdout(),
            there: given.there,
            status,
            back: given.back,
            stored: [None; 2],
            device_before: device_before.into(),
            device: self.device.into(),
            device_path,
            sdset_ds: given.sdset_ds,
            master_before: master_before.into(),
            master: self.master.into(),
            master_path,
            ch_f_ack_c: given.ch_f_ack_c,
            set_sd_c: given.set_sd_c,
        }
    }

    fn device_takes(&mut self, given: Given, control: Control) -> Path {
        match (given.powered, self.device.state() == State(20)) {
            (false, _) => {
                (self.device, self.dtimer) = (Device::new(Readings::default()), 0);
                return Path::default();
            }
            (true, true) => return self.device.start(),
            (true, false) => {}
        }
        self.device.set_sdset_ds(given.sdset_ds);
        let offered = match given.there {
            Fate::Delivered => Some(Received { control, intact: true }),
            Fate::Bad(mcount) => Some(Received { control: Control { mcount, ..control }, intact: false }),
            // A chart with stored images is no case (`fsct prove --emit` refuses them).
            Fate::Lost | Fate::Stored(_) => None,
        };
        let due = self.device.timer_runs() && self.dtimer + 1 >= self.model.watchdog;
        let mut taken = self.device;
        let mut path = offered.map_or_else(Path::default, |received| taken.receive(received));
        if due && (path.is_empty() || given.expires.1) {
            path = self.device.expire();
        } else if !path.is_empty() {
            self.device = taken;
        }
        self.dtimer = if path.is_empty() && self.device.timer_runs() { self.dtimer + 1 } else { 0 };
        path
    }

    fn master_takes(&mut self, given: Given, status: Option<Status>) -> Path {
        let offered = match (given.back, status) {
            (Fate::Delivered, Some(status)) => Some(Answer { status, intact: true }),
            (Fate::Bad(dcount_i), _) => {
                Some(Answer { status: Status { dcount_i, ..Status::default() }, intact: false })
            }
            (Fate::Delivered, None) | (Fate::Lost | Fate::Stored(_), _) => None,
        };
        let due = self.master.timer_runs() && self.mtimer + 1 >= self.model.watchdog;
        let mut taken = self.master;
        taken.set_ch_f_ack_c(given.ch_f_ack_c);
        taken.set_set_sd_c(given.set_sd_c);
        let mut path = offered.map_or_else(Path::default, |answer| taken.receive(answer));
        if due && (path.is_empty() || given.expires.0) {
            path = self.master.expire();
        } else if !path.is_empty() {
            self.master = taken;
        }
        self.mtimer = if path.is_empty() && self.master.timer_runs() { self.mtimer + 1 } else { 0 };
        path
    }
}
