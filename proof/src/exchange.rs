//! One exchange of the black channel: what both machines may do in it, and why.
//!
//! The machines are those of `fsct_protocol::scl`; what stands here is the channel, the power, the operator and the timers.

use crate::learned::{self, Gateway, Product};
use crate::model::{Model, Reading, Timing};
use crate::search::Spread;
use fsct_protocol::scl::device::{Readings, Received};
use fsct_protocol::scl::master::Answer;
use fsct_protocol::scl::{Device, Master, Path, State, Var};
use fsct_protocol::spdu::{Control, Status, inv3, succ};
use std::collections::HashMap;
use std::hash::{BuildHasherDefault, Hash};
use std::rc::Rc;

/// What an exchange does to an image.
#[derive(Copy, Clone, Debug, PartialEq, Eq, Hash)]
pub enum Fate {
    /// It arrives.
    Delivered,
    /// Nothing arrives, or all zero, which counts the same.
    Lost,
    /// An SPDU that the checks find wrong, whatever its kind, arrives with these counter bits.
    Bad(u8),
}

/// What surrounds the machines in an exchange.
#[derive(Copy, Clone, Debug, PartialEq, Eq, Hash)]
pub enum Around {
    /// The channel may disturb, power and operator do as they like.
    Free,
    /// As `Free`, with setSD_C held.
    Demand,
    /// The link is healthy, the FS-Device has power, nobody demands, and the operator acknowledges as soon as ChFAck_C has been
    /// seen at 0.
    Willing,
}

impl Around {
    /// ChFAck_C and setSD_C as they may be; `armed`: ChFAck_C has been seen at 0.
    pub(crate) fn operator(self, armed: bool) -> impl Iterator<Item = (bool, bool)> {
        [(false, false), (true, false), (false, true), (true, true)].into_iter().filter(move |(pressed, demand)| {
            match self {
                Around::Free => true,
                Around::Demand => *demand,
                Around::Willing => !demand && *pressed == armed,
            }
        })
    }
}

/// A machine's way through one exchange.
#[derive(Copy, Clone, Debug)]
pub struct Leg {
    /// The machine behind it, by its number.
    pub to: u16,
    /// Exchanges its timer has run.
    pub timer: u8,
    /// Transitions taken.
    pub path: Path,
    /// What became of the image for it.
    pub fate: Fate,
    /// ChFAck_C (FS-Master) or SDset_DS (FS-Device) in this exchange.
    pub pressed: bool,
    /// setSD_C in this exchange (FS-Master).
    pub demand: bool,
}

/// Both machines and their timers between two exchanges.
#[derive(Copy, Clone, Debug, PartialEq, Eq, Hash)]
pub struct Joint {
    /// FS-Master, by its number.
    pub master: u16,
    /// FS-Device, by its number; one in state 20 has no power.
    pub device: u16,
    /// Exchanges since MTimer was started; 0 where it does not run.
    pub mtimer: u8,
    /// Exchanges since DTimer was started; 0 where it does not run.
    pub dtimer: u8,
}

/// What happened in one exchange.
#[derive(Copy, Clone, Debug)]
pub struct Step {
    /// How it ended.
    pub to: Joint,
    /// The FS-Device's way.
    pub device: Leg,
    /// The FS-Master's way.
    pub master: Leg,
}

impl Step {
    /// Whether the channel did something.
    pub fn disturbed(&self) -> bool {
        self.device.fate != Fate::Delivered || self.master.fate != Fate::Delivered
    }
}

/// Machines met so far, each with a number.
struct Met<M> {
    all: Vec<M>,
    numbers: HashMap<M, u16>,
}

impl<M: Copy + Eq + Hash> Met<M> {
    fn new() -> Met<M> {
        Met { all: Vec::new(), numbers: HashMap::new() }
    }

    /// The tables have some hundreds of machines. A product that has too many gets the last number again, and [`Met::is_full`].
    fn number(&mut self, machine: M) -> u16 {
        *self.numbers.entry(machine).or_insert_with(|| {
            self.all.push(machine);
            (self.all.len() - 1).min(u16::MAX.into()) as u16
        })
    }

    fn is_full(&self) -> bool {
        self.all.len() > u16::MAX.into()
    }
}

type Memo<K> = HashMap<K, Rc<[Leg]>, BuildHasherDefault<Spread>>;

/// The composition: knows what may happen in an exchange.
pub struct World {
    model: Model,
    masters: Met<learned::Master>,
    devices: Met<learned::Device>,
    master_legs: Memo<(u16, u8, Option<u8>, Around)>,
    device_legs: Memo<(u16, u8, u8, Around)>,
}

impl World {
    /// Nothing explored yet.
    pub fn new(model: &Model) -> World {
        World {
            model: model.clone(),
            masters: Met::new(),
            devices: Met::new(),
            master_legs: HashMap::default(),
            device_legs: HashMap::default(),
        }
    }

    /// What is explored.
    pub fn model(&self) -> &Model {
        &self.model
    }

    /// The beginning: FS-Master in state 2, FS-Device without power.
    pub fn start(&mut self) -> Joint {
        let mut master = Master::new();
        master.start();
        let master = match self.model.master {
            None => master.settled(false).into(),
            Some(_) => learned::Master::Learned(Gateway::START),
        };
        let off = match self.model.device {
            None => self.off().into(),
            Some(_) => learned::Device::Learned(Product::OFF),
        };
        Joint { master: self.masters.number(master), device: self.devices.number(off), mtimer: 0, dtimer: 0 }
    }

    /// Whether there are more machines than numbers: what was met last is not all different.
    pub(crate) fn is_full(&self) -> bool {
        self.masters.is_full() || self.devices.is_full()
    }

    fn off(&self) -> Device {
        Device::new(Readings {
            last_valid: self.model.reads(Reading::LastValid),
            previous_valid: self.model.reads(Reading::PreviousValid),
            mirror_valid: self.model.reads(Reading::MirrorValid),
            sequential: self.model.reads(Reading::Sequential),
            ..Readings::default()
        })
    }

    /// An FS-Master by its number.
    pub fn master(&self, number: u16) -> &learned::Master {
        &self.masters.all[usize::from(number)]
    }

    /// An FS-Device by its number.
    pub fn device(&self, number: u16) -> &learned::Device {
        &self.devices.all[usize::from(number)]
    }

    /// Everything that may happen in the next exchange, the undisturbed first, each outcome once.
    pub fn steps(&mut self, from: Joint, around: Around) -> Vec<Step> {
        let mut steps = Vec::new();
        let before = image(self.device(from.device));
        let pipelined = (self.model.timing == Timing::Pipelined).then(|| self.master_legs(from, before, around));
        for device in self.device_legs(from, around).iter() {
            let masters = pipelined.clone().unwrap_or_else(|| {
                let answer = image(self.device(device.to));
                self.master_legs(from, answer, around)
            });
            steps.extend(masters.iter().map(|master| {
                let to = Joint { master: master.to, device: device.to, mtimer: master.timer, dtimer: device.timer };
                Step { to, device: *device, master: *master }
            }));
        }
        steps
    }

    fn device_legs(&mut self, from: Joint, around: Around) -> Rc<[Leg]> {
        let control = self.master(from.master).control();
        let key = (from.device, from.dtimer, control.to_octet(), around);
        if let Some(legs) = self.device_legs.get(&key) {
            return Rc::clone(legs);
        }
        let after = match (*self.device(from.device), &self.model.device) {
            (learned::Device::Rows(device), _) => either(self.devices_after(device, from.dtimer, control, around)),
            (learned::Device::Learned(product), Some(machine)) => {
                either(self.products_after(machine, product, from.dtimer, control, around))
            }
            (learned::Device::Learned(_), None) => Vec::new(),
        };
        let legs: Rc<[Leg]> = distinct(after, |device| self.devices.number(device));
        self.device_legs.insert(key, Rc::clone(&legs));
        legs
    }

    fn devices_after(&self, device: Device, timer: u8, control: Control, around: Around) -> Vec<(Device, Leg)> {
        let mut after = Vec::new();
        let leg = |path, fate, pressed, timer| Leg { to: 0, timer, path, fate, pressed, demand: false };
        let powered = device.state() != State(20);
        let free = around != Around::Willing;
        if !powered {
            let mut on = device;
            let path = on.start();
            after.push((on, leg(path, Fate::Delivered, false, 0)));
            if free {
                after.push((device, leg(Path::default(), Fate::Delivered, false, 0)));
            }
            return after;
        }
        for fate in fates(free) {
            for pressed in [false, true].into_iter().filter(|pressed| free || !pressed) {
                let offered = match fate {
                    Fate::Delivered => Some(Received { control, intact: true }),
                    Fate::Bad(mcount) => Some(Received { control: Control { mcount, ..control }, intact: false }),
                    Fate::Lost => (device.state() == State(24) && self.model.reads(Reading::ZeroJudged))
                        .then_some(Received { control: Control::default(), intact: false }),
                };
                let mut taken = device;
                taken.set_sdset_ds(pressed);
                let path = offered.map_or_else(Path::default, |received| self.device_receives(&mut taken, received));
                self.settle(
                    (device, device.timer_runs(), timer),
                    (taken, path),
                    |device: &mut Device| {
                        device.set_sdset_ds(pressed);
                        device.expire()
                    },
                    |device, path, timer| after.push((device.settled(), leg(path, fate, pressed, timer))),
                );
            }
        }
        if free && self.model.power_cycles {
            after.push((self.off(), leg(Path::default(), Fate::Delivered, false, 0)));
        }
        after
    }

    /// T21, T24, T27 with the readings that say which SPDU is looked at.
    fn device_receives(&self, device: &mut Device, received: Received) -> Path {
        let Received { control: Control { mcount, .. }, intact } = received;
        let first = device.state() == State(21);
        let next = device.previous().map(succ) == Some(mcount);
        let valid =
            intact && (device.counter_check(mcount) || first && mcount == 1 && self.model.reads(Reading::FirstOne));
        let left_alone = !first
            && (self.model.reads(Reading::ExactlyNext) && !next
                || self.model.reads(Reading::NextOrZero) && !next && mcount != 0
                || device.is_old(mcount) && (intact || !self.model.reads(Reading::OldJudged)));
        if left_alone { Path::default() } else { device.process(received, valid) }
    }

    fn master_legs(&mut self, from: Joint, returned: Option<Status>, around: Around) -> Rc<[Leg]> {
        let key = (from.master, from.mtimer, returned.map(Status::to_octet), around);
        if let Some(legs) = self.master_legs.get(&key) {
            return Rc::clone(legs);
        }
        let after = match (*self.master(from.master), &self.model.master) {
            (learned::Master::Rows(master), _) => either(self.masters_after(master, from.mtimer, returned, around)),
            (learned::Master::Learned(gateway), Some(machine)) => {
                either(self.gateways_after(machine, gateway, from.mtimer, returned, around))
            }
            (learned::Master::Learned(_), None) => Vec::new(),
        };
        let legs: Rc<[Leg]> = distinct(after, |master| self.masters.number(master));
        self.master_legs.insert(key, Rc::clone(&legs));
        legs
    }

    fn masters_after(&self, master: Master, timer: u8, returned: Option<Status>, around: Around) -> Vec<(Master, Leg)> {
        let mut after = Vec::new();
        let armed = master.get(Var::ChFAckCe) == 1;
        let kept = [Reading::NotOld, Reading::ExpectedOrNotOld, Reading::OldJudged]
            .iter()
            .any(|reading| self.model.reads(*reading));
        for fate in fates(around != Around::Willing) {
            for (pressed, demand) in around.operator(armed) {
                let bad = |dcount_i| Answer { status: Status { dcount_i, ..Status::default() }, intact: false };
                let offered = match (fate, returned) {
                    (Fate::Delivered, Some(status)) => Some(Answer { status, intact: true }),
                    (Fate::Bad(dcount_i), _) => Some(bad(dcount_i)),
                    (Fate::Delivered, None) | (Fate::Lost, _) => {
                        (master.state() == State(7) && self.model.reads(Reading::ZeroJudged)).then_some(bad(0))
                    }
                };
                let mut taken = master;
                taken.set_ch_f_ack_c(pressed);
                taken.set_set_sd_c(demand);
                let path = offered
                    .filter(|answer| self.master_takes(&master, *answer))
                    .map_or_else(Path::default, |answer| taken.process(answer));
                self.settle(
                    (master, master.timer_runs(), timer),
                    (taken, path),
                    Master::expire,
                    |master, path, timer| {
                        let leg = Leg { to: 0, timer, path, fate, pressed, demand };
                        after.push((master.settled(kept), leg));
                    },
                );
            }
        }
        after
    }

    /// T3, T6, T10 with the readings that say which answer is looked at.
    fn master_takes(&self, master: &Master, answer: Answer) -> bool {
        let reads = |reading| self.model.reads(reading);
        let dcount_i = answer.status.dcount_i;
        let expected = dcount_i == inv3(master.get(Var::Mcount));
        let not_old = master.previous() != Some(dcount_i);
        match master.state().0 {
            2 if reads(Reading::FirstExpected) => expected,
            5 | 7 if !answer.intact && reads(Reading::OldJudged) => true,
            5 if reads(Reading::Expected) => expected && not_old,
            7 if reads(Reading::NotOld) => not_old,
            7 if reads(Reading::ExpectedOrNotOld) => expected || not_old,
            _ => master.takes(dcount_i),
        }
    }

    /// Reception against timer (A37): which of both the machine follows, or both where either may win.
    pub(crate) fn settle<M: Copy>(
        &self,
        (machine, runs, timer): (M, bool, u8),
        (taken, path): (M, Path),
        expire: impl Fn(&mut M) -> Path,
        mut follow: impl FnMut(M, Path, u8),
    ) {
        let due = runs && timer + 1 >= self.model.watchdog;
        let received = !path.is_empty();
        // A product may go elsewhere without a new SPDU.
        let machine = if received { machine } else { taken };
        if received && !(due && self.model.reads(Reading::TimerFirst)) {
            follow(taken, path, 0);
        }
        if due && !(received && self.model.reads(Reading::ReceptionFirst)) {
            let mut expired = machine;
            let path = expire(&mut expired);
            follow(expired, path, 0);
        }
        if !received && !due {
            follow(machine, path, if runs { timer + 1 } else { 0 });
        }
    }
}

/// The image an FS-Device presents: all zero before its first answer.
pub fn image(device: &learned::Device) -> Option<Status> {
    (device.state().0 > 21).then(|| device.status())
}

pub(crate) fn fates(faulty: bool) -> impl Iterator<Item = Fate> {
    let disturbed = [Fate::Lost].into_iter().chain((0..8).map(Fate::Bad));
    [Fate::Delivered].into_iter().chain(disturbed.filter(move |_| faulty))
}

/// Machines of one kind as machines of either.
fn either<M: Into<E>, E>(after: Vec<(M, Leg)>) -> Vec<(E, Leg)> {
    after.into_iter().map(|(machine, leg)| (machine.into(), leg)).collect()
}

/// Each outcome once: the first way to it stays, so that an undisturbed one is preferred. A machine that goes another way to the
/// same place is another outcome, for the properties look at the way.
fn distinct<M>(after: Vec<(M, Leg)>, mut number: impl FnMut(M) -> u16) -> Rc<[Leg]> {
    let mut legs: Vec<Leg> = Vec::new();
    for (machine, leg) in after {
        let leg = Leg { to: number(machine), ..leg };
        if !legs.iter().any(|known| (known.to, known.timer, known.path) == (leg.to, leg.timer, leg.path)) {
            legs.push(leg);
        }
    }
    legs.into()
}
