//! A product in place of a machine of the tables: what was learnt of it from outside, with the counters filled in.
//!
//! What was learnt is relative to the counters on the line ("the next one"); here they have numbers. A product has no transitions that
//! can be seen, so its way is named by what reached it: an SPDU in error counts as the CommErr of T25, a good one as T22, and for an
//! FS-Master the acknowledgment that the tables ask for (T13, T11) is followed beside the product, whatever that does.

use crate::exchange::{Around, Fate, Leg, Offered, World, fates};
use crate::reading::{Reading, Reads};
use fsct_observed::{Mealy, Seen, Shown, Side, Subject, device, master};
use fsct_protocol::scl::{self, Path, State, T, Var};
use fsct_protocol::spdu::{Control, Status, inv3, succ};

/// An FS-Device: by the rows, or learnt.
#[derive(Copy, Clone, Debug, PartialEq, Eq, Hash)]
pub enum Device {
    /// That of Table 40.
    Rows(scl::Device),
    /// A product.
    Learned(Product),
}

/// An FS-Master: by the rows, or learnt.
#[derive(Copy, Clone, Debug, PartialEq, Eq, Hash)]
pub enum Master {
    /// That of Table 38.
    Rows(scl::Master),
    /// A product.
    Learned(Gateway),
}

/// A learnt FS-Device.
#[derive(Copy, Clone, Debug, PartialEq, Eq, Hash)]
pub struct Product {
    /// Its state; `None`: no power.
    at: Option<u16>,
    /// MCount of the SPDU answered last.
    previous: Option<u8>,
    /// It has answered, so its timer runs.
    answered: bool,
    status: Status,
    pdout: bool,
}

/// A learnt FS-Master.
#[derive(Copy, Clone, Debug, PartialEq, Eq, Hash)]
pub struct Gateway {
    at: u16,
    /// DCount_i of the answer taken last.
    previous: Option<u8>,
    /// It has sent a second SPDU, so its timer runs.
    started: bool,
    control: Control,
    pdout: bool,
    pdin: bool,
    owed: Owed,
}

/// The acknowledgment that the tables ask for.
#[derive(Copy, Clone, Debug, PartialEq, Eq, Hash)]
enum Owed {
    /// None: no fault.
    Nothing,
    /// There was a fault.
    All,
    /// There was a fault, and ChFAck_C has been seen at 0 since (ChFAck_C_e).
    Press,
}

impl From<scl::Device> for Device {
    fn from(device: scl::Device) -> Device {
        Device::Rows(device)
    }
}

impl From<scl::Master> for Master {
    fn from(master: scl::Master) -> Master {
        Master::Rows(master)
    }
}

impl From<Product> for Device {
    fn from(product: Product) -> Device {
        Device::Learned(product)
    }
}

impl From<Gateway> for Master {
    fn from(gateway: Gateway) -> Master {
        Master::Learned(gateway)
    }
}

impl Device {
    /// The state of Table 40. Of a product no more is told than 20, without power, 21, before its first answer, and 24.
    pub fn state(&self) -> State {
        match self {
            Device::Rows(device) => device.state(),
            Device::Learned(Product { at: None, .. }) => State(20),
            Device::Learned(Product { answered, .. }) => State(if *answered { 24 } else { 21 }),
        }
    }

    /// The status octet of the answer that stands.
    pub fn status(&self) -> Status {
        match self {
            Device::Rows(device) => device.status(),
            Device::Learned(product) => product.status,
        }
    }

    /// Whether process data (and not SD) go to the technology.
    pub fn uses_pdout(&self) -> bool {
        match self {
            Device::Rows(device) => device.uses_pdout(),
            Device::Learned(product) => product.pdout,
        }
    }

    /// A variable of the table; a product has none.
    pub fn get(&self, var: Var) -> u8 {
        match self {
            Device::Rows(device) => device.get(var),
            Device::Learned(_) => 0,
        }
    }

    /// The machine of the tables, if that is what it is.
    pub fn rows(&self) -> Option<&scl::Device> {
        match self {
            Device::Rows(device) => Some(device),
            Device::Learned(_) => None,
        }
    }

    /// Its state as a chart names it.
    pub(crate) fn place(&self) -> String {
        match self {
            Device::Learned(Product { at: Some(at), .. }) => format!("q{at}"),
            _ => self.state().to_string(),
        }
    }
}

impl Master {
    /// The state of Table 38. Of a product it is what the tables ask for: 2 before the first answer, 7 behind a fault, 5.
    pub fn state(&self) -> State {
        match self {
            Master::Rows(master) => master.state(),
            Master::Learned(Gateway { started: false, .. }) => State(2),
            Master::Learned(Gateway { owed: Owed::Nothing, .. }) => State(5),
            Master::Learned(_) => State(7),
        }
    }

    /// The control octet of the SPDU that stands.
    pub fn control(&self) -> Control {
        match self {
            Master::Rows(master) => master.control(),
            Master::Learned(gateway) => gateway.control,
        }
    }

    /// Whether PDout (and not SDout) is sent.
    pub fn uses_pdout(&self) -> bool {
        match self {
            Master::Rows(master) => master.uses_pdout(),
            Master::Learned(gateway) => gateway.pdout,
        }
    }

    /// A variable of the table; of a product In, setSD and MCount, and ChFAck_C_e as the tables ask for it.
    pub fn get(&self, var: Var) -> u8 {
        match (self, var) {
            (Master::Rows(master), var) => master.get(var),
            (Master::Learned(gateway), Var::In) => gateway.pdin.into(),
            (Master::Learned(gateway), Var::SetSd) => gateway.control.set_sd.into(),
            (Master::Learned(gateway), Var::Mcount) => gateway.control.mcount,
            (Master::Learned(gateway), Var::ChFAckCe) => (gateway.owed == Owed::Press).into(),
            _ => 0,
        }
    }

    /// The machine of the tables, if that is what it is.
    pub fn rows(&self) -> Option<&scl::Master> {
        match self {
            Master::Rows(master) => Some(master),
            Master::Learned(_) => None,
        }
    }

    /// Its state as a chart names it.
    pub(crate) fn place(&self) -> String {
        match self {
            Master::Learned(gateway) => format!("q{}", gateway.at),
            Master::Rows(master) => master.state().to_string(),
        }
    }
}

/// Whether a machine can stand in for a side: every SPDU it sends is one that a partner can read.
///
/// # Errors
/// One sentence for the user.
pub fn can_stand_in(side: Side, machine: &Mealy<Seen>) -> Result<(), String> {
    let names = side.inputs();
    for (state, edges) in machine.states.iter().enumerate() {
        for (edge, input) in edges.iter().zip(&names) {
            let damaged =
                edge.output.shown().is_some_and(|shown| side.names(shown).contains(&fsct_observed::seen::NOT_INTACT));
            if damaged || matches!(edge.output, Seen::Astray(_)) {
                let told = side.told(edge.output);
                return Err(format!(
                    "state {state} answers {input} with what no partner takes ({told}), so there is nothing to prove"
                ));
            }
        }
    }
    Ok(())
}

/// The number of an input.
fn number<S: Subject>(input: S::Input) -> usize {
    S::INPUTS.iter().position(|(_, other)| *other == input).unwrap_or_default()
}

impl Product {
    /// Without power.
    pub(crate) const OFF: Product = Product {
        at: None,
        previous: None,
        answered: false,
        status: Status { dcount_i: 0, sd_set: false, d_comm_err: false, d_timeout: false },
        pdout: false,
    };

    fn edge(&mut self, machine: &Mealy<Seen>, input: device::Input) -> Seen {
        let edge = machine.edge(self.at.unwrap_or_default().into(), number::<device::Bench>(input));
        self.at = Some(edge.next as u16);
        if let Some(shown) = edge.output.shown() {
            self.pdout = shows(Side::Device, shown, "PDout_D");
        }
        edge.output
    }

    fn answer(&mut self, shown: Shown) {
        let show = |name| shows(Side::Device, shown, name);
        self.answered = true;
        self.status = Status {
            dcount_i: self.previous.map_or(0, inv3),
            sd_set: show("SDset"),
            d_comm_err: show("DCommErr"),
            d_timeout: show("DTimeout"),
        };
    }

    /// What reaches it, in terms of what was learnt, and the counter in it. A wrong SPDU with the previous counter is old (A29).
    fn input(&self, fate: Fate, control: Control, sdset_ds: bool) -> (device::Input, Option<u8>) {
        let Control { mcount, set_sd, .. } = control;
        match fate {
            // Nothing is stored where a product stands in.
            Fate::Lost | Fate::Stored(_) => (device::Input::AllZero, None),
            Fate::Bad(mcount) if self.previous == Some(mcount) => (device::Input::Old, Some(mcount)),
            Fate::Bad(mcount) => (device::Input::Corrupt, Some(mcount)),
            Fate::Delivered if self.previous == Some(mcount) => (device::Input::Old, Some(mcount)),
            Fate::Delivered if mcount == self.previous.map_or(0, succ) => {
                (device::Input::Next { set_sd, sdset_ds }, Some(mcount))
            }
            Fate::Delivered if mcount == 0 => (device::Input::Zero, Some(mcount)),
            Fate::Delivered => (device::Input::Jump, Some(mcount)),
        }
    }

    fn take(&mut self, machine: &Mealy<Seen>, input: device::Input, mcount: Option<u8>) -> Path {
        let Seen::Answer(shown) = self.edge(machine, input) else { return Path::default() };
        self.previous = mcount.or(self.previous);
        self.answer(shown);
        let error = match input {
            device::Input::Corrupt | device::Input::Jump => true,
            device::Input::Old | device::Input::AllZero => self.status.d_comm_err,
            _ => false,
        };
        Path::of(&[T(if error { 25 } else { 22 })])
    }

    fn time_out(&mut self, machine: &Mealy<Seen>) -> Path {
        let Seen::Answer(shown) = self.edge(machine, device::Input::Timeout) else { return Path::default() };
        self.answer(shown);
        Path::of(&[T(31)])
    }
}

impl Gateway {
    /// The first SPDU is sent.
    pub(crate) const START: Gateway = Gateway {
        at: 0,
        previous: None,
        started: false,
        control: Control { mcount: 0, set_sd: true, ch_f_ack_req: false },
        pdout: false,
        pdin: false,
        owed: Owed::Nothing,
    };

    fn edge(&mut self, machine: &Mealy<Seen>, input: master::Input) -> Seen {
        let edge = machine.edge(self.at.into(), number::<master::Bench>(input));
        self.at = edge.next as u16;
        if let Some(shown) = edge.output.shown() {
            self.pdin = shows(Side::Master, shown, "PDin_M");
        }
        edge.output
    }

    fn send(&mut self, shown: Shown, mcount: u8) {
        let show = |name| shows(Side::Master, shown, name);
        self.started = true;
        self.control = Control { mcount, set_sd: show("setSD"), ch_f_ack_req: show("ChFAckReq") };
        self.pdout = show("PDout");
    }

    /// What reaches it, in terms of what was learnt, and the counter in it.
    fn input(&self, fate: Fate, returned: Option<Status>, ack: bool, set_sd: bool) -> (master::Input, Option<u8>) {
        let mirror = inv3(self.control.mcount);
        let other =
            |dcount_i| if self.previous == Some(dcount_i) { master::Input::Old } else { master::Input::Foreign };
        match (fate, returned) {
            (Fate::Bad(dcount_i), _) if dcount_i == mirror => (master::Input::Corrupt, Some(dcount_i)),
            (Fate::Bad(dcount_i), _) => (other(dcount_i), Some(dcount_i)),
            (Fate::Delivered, Some(Status { dcount_i, sd_set, d_comm_err, d_timeout })) => {
                let input = match () {
                    () if dcount_i != mirror => other(dcount_i),
                    () if d_comm_err => master::Input::DcommErr,
                    () if d_timeout => master::Input::Dtimeout,
                    () => master::Input::Good { sd_set, ack, set_sd },
                };
                (input, Some(dcount_i))
            }
            _ => (master::Input::AllZero, None),
        }
    }

    fn take(&mut self, machine: &Mealy<Seen>, input: master::Input, dcount_i: Option<u8>) -> Path {
        let Seen::Answer(shown) = self.edge(machine, input) else { return Path::default() };
        let first = !self.started;
        self.previous = dcount_i.or(self.previous);
        self.send(shown, succ(self.control.mcount));
        let transition = match (self.owed, input) {
            (Owed::Nothing, master::Input::Good { .. }) => 4,
            (Owed::Press, master::Input::Good { ack: true, .. }) => {
                self.owed = Owed::Nothing;
                11
            }
            (Owed::All, master::Input::Good { ack: true, .. }) => 13,
            (_, master::Input::Good { .. }) => {
                self.owed = Owed::Press;
                13
            }
            (owed, _) => {
                self.owed = Owed::All;
                if owed == Owed::Nothing { 7 } else { 12 }
            }
        };
        if first { Path::of(&[T(3), T(transition)]) } else { Path::of(&[T(transition)]) }
    }

    fn time_out(&mut self, machine: &Mealy<Seen>) -> Path {
        let Seen::Answer(shown) = self.edge(machine, master::Input::Timeout) else { return Path::default() };
        self.send(shown, 0);
        let transition = if self.owed == Owed::Nothing { 8 } else { 14 };
        self.owed = Owed::All;
        Path::of(&[T(transition)])
    }
}

fn shows(side: Side, shown: Shown, name: &str) -> bool {
    side.showing(&[name]).0 & shown.0 != 0
}

impl World {
    /// Of the readings those that a product has as well: which of timer and reception wins (A37).
    fn order(&self) -> Reads {
        let orders = [Reading::TimerFirst, Reading::ReceptionFirst].into_iter();
        orders.filter(|reading| self.model().reads(*reading)).fold(Reads::default(), Reads::with)
    }

    /// Everything a learnt FS-Device may do in an exchange.
    pub(crate) fn products_after(
        &self,
        machine: &Mealy<Seen>,
        product: Product,
        timer: u8,
        control: Control,
        around: Around,
    ) -> Vec<(Product, Leg)> {
        let free = around != Around::Willing;
        let leg = |path, fate, pressed, timer| Leg { to: 0, timer, path, fate, pressed, demand: false };
        let undisturbed = |path| leg(path, Fate::Delivered, false, 0);
        if product.at.is_none() {
            let on = (Product { at: Some(0), ..product }, undisturbed(Path::of(&[T(20)])));
            return [on].into_iter().chain(free.then_some((product, undisturbed(Path::default())))).collect();
        }
        let mut after = Vec::new();
        for fate in fates(free, Offered::default()) {
            for pressed in [false, true].into_iter().filter(|pressed| free || !pressed) {
                let mut taken = product;
                let (input, mcount) = product.input(fate, control, pressed);
                let path = taken.take(machine, input, mcount);
                self.settle(
                    (product, product.answered, timer, self.order()),
                    (taken, path),
                    |product| product.time_out(machine),
                    |product, path, timer| after.push((product, leg(path, fate, pressed, timer))),
                );
            }
        }
        if free && self.model().power_cycles {
            after.push((Product::OFF, undisturbed(Path::default())));
        }
        after
    }

    /// Everything a learnt FS-Master may do in an exchange.
    pub(crate) fn gateways_after(
        &self,
        machine: &Mealy<Seen>,
        gateway: Gateway,
        timer: u8,
        returned: Option<Status>,
        around: Around,
    ) -> Vec<(Gateway, Leg)> {
        let mut after = Vec::new();
        for fate in fates(around != Around::Willing, Offered::default()) {
            for (pressed, demand) in around.operator(gateway.owed == Owed::Press) {
                let mut taken = gateway;
                let (input, dcount_i) = gateway.input(fate, returned, pressed, demand);
                let path = taken.take(machine, input, dcount_i);
                self.settle(
                    (gateway, gateway.started, timer, self.order()),
                    (taken, path),
                    |gateway| gateway.time_out(machine),
                    |gateway, path, timer| {
                        after.push((gateway, Leg { to: 0, timer, path, fate, pressed, demand }));
                    },
                );
            }
        }
        after
    }
}
