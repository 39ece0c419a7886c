//! One exchange of the black channel: what both machines may do in it, and why.
//!
//! The machines are those of `fsct_protocol::scl`, read as `machine` says; what stands here is the channel, the power, the operator
//! and the timers.

use crate::learned::{self, Gateway, Product};
use crate::machine::{FsDevice, FsMaster, Shown};
use crate::model::{Model, Timers, Timing};
use crate::reading::{Machine, Reading, Reads};
use crate::search::Table;
use fsct_protocol::scl::device::Received;
use fsct_protocol::scl::master::Answer;
use fsct_protocol::scl::{Path, State, Var};
use fsct_protocol::spdu::{Control, Status};
use std::hash::Hash;
use std::sync::Arc;

/// What an exchange does to an image.
#[derive(Copy, Clone, Debug, PartialEq, Eq, Hash)]
pub enum Fate {
    /// It arrives.
    Delivered,
    /// Nothing arrives, or all zero, which counts the same.
    Lost,
    /// An SPDU that the checks find wrong, whatever its kind, arrives with these counter bits.
    Bad(u8),
    /// In its place arrives the image that was presented so many exchanges ago.
    Stored(u8),
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
    pub to: u32,
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
    pub master: u32,
    /// FS-Device, by its number; one in state 20 has no power.
    pub device: u32,
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
    numbers: Table<M, u32>,
}

impl<M: Copy + Eq + Hash> Met<M> {
    fn new() -> Met<M> {
        Met { all: Vec::new(), numbers: Table::default() }
    }

    fn number(&mut self, machine: M) -> u32 {
        *self.numbers.entry(machine).or_insert_with(|| {
            self.all.push(machine);
            (self.all.len() - 1) as u32
        })
    }
}

/// An FS-Master as it is followed: by the rows, or learnt.
#[derive(Copy, Clone, Debug, PartialEq, Eq, Hash)]
enum MasterSide {
    Rows(FsMaster),
    Learned(Gateway),
}

/// An FS-Device as it is followed.
#[derive(Copy, Clone, Debug, PartialEq, Eq, Hash)]
enum DeviceSide {
    Rows(FsDevice),
    Learned(Product),
}

type Memo<K> = Table<K, Arc<[Leg]>>;

/// The composition: knows what may happen in an exchange.
pub struct World {
    model: Model,
    master_ways: Vec<Reads>,
    device_ways: Vec<Reads>,
    /// State 7 remembers the previous counter.
    kept: bool,
    masters: Met<MasterSide>,
    devices: Met<DeviceSide>,
    master_legs: Memo<(u32, u8, Offered, Around)>,
    device_legs: Memo<(u32, u8, Offered, Around)>,
}

/// What may reach a machine in an exchange: the image presented now, and those that are stored.
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq, Hash)]
pub(crate) struct Offered {
    now: Option<u8>,
    before: Shown,
}

impl World {
    /// The machines that have numbers in a search: some hundreds, and as many times more as images are stored.
    pub(crate) const MACHINES: usize = 1 << 18;

    /// Nothing explored yet.
    pub fn new(model: &Model) -> World {
        World {
            model: model.clone(),
            master_ways: model.ways(Machine::Master),
            device_ways: model.ways(Machine::Device),
            kept: model.ways(Machine::Master).iter().any(|reads| FsMaster::remembers(*reads)),
            masters: Met::new(),
            devices: Met::new(),
            master_legs: Memo::default(),
            device_legs: Memo::default(),
        }
    }

    /// The same with fewer states: with A29 state 7 trips on anything wrong, so the previous counter it remembers there is never
    /// looked at. [`World::new`] counts the states as the exploration did that the figures are compared with.
    pub(crate) fn lean(model: &Model) -> World {
        let world = World::new(model);
        let kept = world.master_ways.iter().any(|reads| FsMaster::looks_back(*reads));
        World { kept, ..world }
    }

    /// What is explored.
    pub fn model(&self) -> &Model {
        &self.model
    }

    /// Whether there are more machines than numbers for them.
    pub(crate) fn is_full(&self) -> bool {
        self.masters.all.len().max(self.devices.all.len()) > World::MACHINES
    }

    /// The beginning: FS-Master in state 2, FS-Device without power.
    pub fn start(&mut self) -> Joint {
        let master = match self.model.master {
            None => MasterSide::Rows(FsMaster::started(Shown::default()).0),
            Some(_) => MasterSide::Learned(Gateway::START),
        };
        let device = match self.model.device {
            None => DeviceSide::Rows(self.off(Shown::default())),
            Some(_) => DeviceSide::Learned(Product::OFF),
        };
        Joint { master: self.masters.number(master), device: self.devices.number(device), mtimer: 0, dtimer: 0 }
    }

    fn off(&self, shown: Shown) -> FsDevice {
        FsDevice::off(self.device_ways.first().copied().unwrap_or_default(), shown)
    }

    /// An FS-Master by its number.
    pub fn master(&self, number: u32) -> learned::Master {
        match self.masters.all[number as usize] {
            MasterSide::Rows(master) => master.scl.into(),
            MasterSide::Learned(gateway) => gateway.into(),
        }
    }

    /// An FS-Device by its number.
    pub fn device(&self, number: u32) -> learned::Device {
        match self.devices.all[number as usize] {
            DeviceSide::Rows(device) => device.scl.into(),
            DeviceSide::Learned(product) => product.into(),
        }
    }

    /// The images that an FS-Master or FS-Device has presented; nothing is stored of a product.
    fn shown(&self, from: Joint, to: Machine) -> Shown {
        match (to, self.masters.all[from.master as usize], self.devices.all[from.device as usize]) {
            (Machine::Device, MasterSide::Rows(master), _) => master.shown,
            (Machine::Master, _, DeviceSide::Rows(device)) => device.shown,
            _ => Shown::default(),
        }
    }

    /// The counter bits of an SPDU (to the FS-Device) or answer that was presented so many exchanges ago.
    pub(crate) fn stored(&self, from: Joint, to: Machine, ago: u8) -> Option<u8> {
        self.shown(from, to).ago(ago).map(|octet| octet >> 5)
    }

    /// Everything that may happen in the next exchange, the undisturbed first, each outcome once.
    pub fn steps(&mut self, from: Joint, around: Around) -> Vec<Step> {
        let mut steps = Vec::new();
        let before = image(&self.device(from.device)).map(Status::to_octet);
        let stored = self.shown(from, Machine::Master);
        let pipelined = (self.model.timing == Timing::Pipelined)
            .then(|| self.master_legs(from, Offered { now: before, before: stored }, around));
        for device in self.device_legs(from, around).iter() {
            let masters = pipelined.clone().unwrap_or_else(|| {
                let now = image(&self.device(device.to)).map(Status::to_octet);
                self.master_legs(from, Offered { now, before: stored }, around)
            });
            steps.extend(masters.iter().map(|master| {
                let to = Joint { master: master.to, device: device.to, mtimer: master.timer, dtimer: device.timer };
                Step { to, device: *device, master: *master }
            }));
        }
        steps
    }

    fn device_legs(&mut self, from: Joint, around: Around) -> Arc<[Leg]> {
        let control = self.master(from.master).control();
        let offered = Offered { now: Some(control.to_octet()), before: self.shown(from, Machine::Device) };
        let key = (from.device, from.dtimer, offered, around);
        if let Some(legs) = self.device_legs.get(&key) {
            return Arc::clone(legs);
        }
        let after = match (self.devices.all[from.device as usize], &self.model.device) {
            (DeviceSide::Rows(device), _) => {
                either(self.devices_after(device, from.dtimer, offered, around), DeviceSide::Rows)
            }
            (DeviceSide::Learned(product), Some(machine)) => {
                either(self.products_after(machine, product, from.dtimer, control, around), DeviceSide::Learned)
            }
            (DeviceSide::Learned(_), None) => Vec::new(),
        };
        let legs: Arc<[Leg]> = distinct(after, |device| self.devices.number(device));
        self.device_legs.insert(key, Arc::clone(&legs));
        legs
    }

    fn devices_after(&self, device: FsDevice, timer: u8, offered: Offered, around: Around) -> Vec<(FsDevice, Leg)> {
        let mut after = Vec::new();
        let leg = |path, fate, pressed, timer| Leg { to: 0, timer, path, fate, pressed, demand: false };
        let free = around != Around::Willing;
        if device.scl.state() == State(20) {
            let mut on = device;
            let path = on.scl.start();
            after.push((self.presented(device, on), leg(path, Fate::Delivered, false, 0)));
            if free {
                after.push((self.presented(device, device), leg(Path::default(), Fate::Delivered, false, 0)));
            }
            return after;
        }
        for reads in self.choice(&self.device_ways, device.scl.state()) {
            for fate in fates(free, offered) {
                for pressed in [false, true].into_iter().filter(|pressed| free || !pressed) {
                    let mut taken = device;
                    taken.scl.set_sdset_ds(pressed);
                    let path = match arriving(fate, offered) {
                        Some((octet, intact)) => {
                            let control = Control::from_octet(octet);
                            taken.receive(Received { control, intact }, *reads)
                        }
                        None => taken.receive_zero(*reads),
                    };
                    self.settle(
                        (device, device.scl.timer_runs(), timer, *reads),
                        (taken, path),
                        |device: &mut FsDevice| {
                            device.scl.set_sdset_ds(pressed);
                            device.scl.expire()
                        },
                        |to: FsDevice, path, timer| {
                            after.push((self.presented(device, to.settled()), leg(path, fate, pressed, timer)));
                        },
                    );
                }
            }
        }
        if free && self.model.power_cycles {
            let off = self.presented(device, self.off(device.shown));
            after.push((off, leg(Path::default(), Fate::Delivered, false, 0)));
        }
        after
    }

    /// The ways a machine chooses from in this state: of those that differ in what makes no difference here, one.
    fn choice<'a>(&self, ways: &'a [Reads], state: State) -> impl Iterator<Item = &'a Reads> {
        let mixed = self.model.mixed;
        ways.iter().filter(move |reads| !mixed || reads.matter_in(state))
    }

    /// The image of this exchange goes to the store.
    fn presented(&self, before: FsDevice, after: FsDevice) -> FsDevice {
        let presenting = if self.model.timing == Timing::Pipelined { before } else { after };
        let now = image(&presenting.scl.into()).map(Status::to_octet);
        FsDevice { shown: before.shown.then(now, self.model.storing_answers), ..after }
    }

    fn master_legs(&mut self, from: Joint, returned: Offered, around: Around) -> Arc<[Leg]> {
        let key = (from.master, from.mtimer, returned, around);
        if let Some(legs) = self.master_legs.get(&key) {
            return Arc::clone(legs);
        }
        let after = match (self.masters.all[from.master as usize], &self.model.master) {
            (MasterSide::Rows(master), _) => {
                either(self.masters_after(master, from.mtimer, returned, around), MasterSide::Rows)
            }
            (MasterSide::Learned(gateway), Some(machine)) => {
                let status = returned.now.map(Status::from_octet);
                either(self.gateways_after(machine, gateway, from.mtimer, status, around), MasterSide::Learned)
            }
            (MasterSide::Learned(_), None) => Vec::new(),
        };
        let legs: Arc<[Leg]> = distinct(after, |master| self.masters.number(master));
        self.master_legs.insert(key, Arc::clone(&legs));
        legs
    }

    fn masters_after(&self, master: FsMaster, timer: u8, returned: Offered, around: Around) -> Vec<(FsMaster, Leg)> {
        let mut after = Vec::new();
        let armed = master.scl.get(Var::ChFAckCe) == 1;
        let shown = master.shown.then(Some(master.scl.control().to_octet()), self.model.storing);
        for reads in self.choice(&self.master_ways, master.scl.state()) {
            for fate in fates(around != Around::Willing, returned) {
                for (pressed, demand) in around.operator(armed) {
                    let mut taken = master;
                    taken.scl.set_set_sd_c(demand);
                    let path = match arriving(fate, returned) {
                        Some((octet, intact)) => {
                            taken.receive(Answer { status: Status::from_octet(octet), intact }, pressed, *reads)
                        }
                        None => taken.receive_zero(pressed, *reads),
                    };
                    self.settle(
                        (master, master.scl.timer_runs(), timer, *reads),
                        (taken, path),
                        FsMaster::expire,
                        |master: FsMaster, path, timer| {
                            let leg = Leg { to: 0, timer, path, fate, pressed, demand };
                            after.push((master.settled(self.kept, shown), leg));
                        },
                    );
                }
            }
        }
        if self.model.master_restart && around != Around::Willing {
            let (anew, path) = FsMaster::started(shown);
            let leg =
                Leg { to: 0, timer: 0, path, fate: Fate::Delivered, pressed: false, demand: around == Around::Demand };
            after.push((anew, leg));
        }
        after
    }

    /// Reception against timer (A37): which of both the machine follows, or both where either may win.
    pub(crate) fn settle<M: Copy>(
        &self,
        (machine, runs, timer, reads): (M, bool, u8, Reads),
        (taken, path): (M, Path),
        expire: impl Fn(&mut M) -> Path,
        mut follow: impl FnMut(M, Path, u8),
    ) {
        let counted = self.model.timers == Timers::Counted;
        let due = runs && (!counted || timer + 1 >= self.model.watchdog);
        let received = !path.is_empty();
        // A product may go elsewhere without a new SPDU.
        let machine = if received { machine } else { taken };
        if received && !(due && counted && reads.has(Reading::TimerFirst)) {
            follow(taken, path, 0);
        }
        if due && !(received && reads.has(Reading::ReceptionFirst)) {
            let mut expired = machine;
            let path = expire(&mut expired);
            follow(expired, path, 0);
        }
        if !(received || due && counted) {
            follow(machine, path, if runs && counted { timer + 1 } else { 0 });
        }
    }
}

/// The image an FS-Device presents: all zero before its first answer.
pub fn image(device: &learned::Device) -> Option<Status> {
    (device.state().0 > 21).then(|| device.status())
}

/// What the channel may do: an image that stood without a change until now is the one presented now, and not stored.
pub(crate) fn fates(faulty: bool, offered: Offered) -> impl Iterator<Item = Fate> {
    let bad = (0..8).map(Fate::Bad);
    let disturbed = [Fate::Lost].into_iter().chain(bad).chain(offered.before.others(offered.now).map(Fate::Stored));
    [Fate::Delivered].into_iter().chain(disturbed.filter(move |_| faulty))
}

/// The control or status octet that arrives, and whether the checks find it right; `None`: nothing, or all zero.
fn arriving(fate: Fate, offered: Offered) -> Option<(u8, bool)> {
    match fate {
        Fate::Delivered => offered.now.map(|octet| (octet, true)),
        Fate::Lost => None,
        Fate::Bad(counter) => Some((offered.now.unwrap_or_default() & 0x1F | counter << 5, false)),
        Fate::Stored(ago) => offered.before.ago(ago).map(|octet| (octet, true)),
    }
}

/// Machines of one kind as machines of either.
fn either<M, E>(after: Vec<(M, Leg)>, kind: impl Fn(M) -> E) -> Vec<(E, Leg)> {
    after.into_iter().map(|(machine, leg)| (kind(machine), leg)).collect()
}

/// Each outcome once: the first way to it stays, so that an undisturbed one is preferred. A machine that goes another way to the
/// same place is another outcome, for the properties look at the way, and so is one that took a stored image.
fn distinct<M: Eq>(after: Vec<(M, Leg)>, mut number: impl FnMut(M) -> u32) -> Arc<[Leg]> {
    let outcome = |leg: &Leg| (leg.timer, leg.path, taken_from_store(leg));
    let mut first: Vec<(M, Leg)> = Vec::new();
    for (machine, leg) in after {
        if !first.iter().any(|(known, way)| outcome(way) == outcome(&leg) && *known == machine) {
            first.push((machine, leg));
        }
    }
    first.into_iter().map(|(machine, leg)| Leg { to: number(machine), ..leg }).collect()
}

/// How many exchanges ago the image was presented that a machine has processed, where it is a stored one.
pub(crate) fn taken_from_store(leg: &Leg) -> Option<u8> {
    let timeout = leg.path.iter().any(|t| matches!(t.0, 8 | 14 | 30 | 31));
    match leg.fate {
        Fate::Stored(ago) if !leg.path.is_empty() && !timeout => Some(ago),
        _ => None,
    }
}
