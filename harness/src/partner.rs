//! A conformant partner on the link: an FS-Master by Table 38 on an FS-Device, an FS-Device by Table 40 on an FS-Master;
//! and the operator.

use crate::case::model::{From, Operator};
use crate::channel::Channel;
use crate::keeper::Keeper;
use crate::session::{Session, Stop};
use crate::tester::Tester;
use fsct_adapters::{Octets, Pco, Role, Service};
use fsct_protocol::scl::master::Answer;
use fsct_protocol::scl::{Master, Var};
use fsct_protocol::spdu::{OutSpdu, Pd, inv3, succ};

/// A conformant partner.
pub enum Partner {
    /// An FS-Master.
    Master(VirtualMaster),
    /// An FS-Device, and the operator at the gateway of the DUT.
    Device(Box<Keeper>, Gateway),
}

/// The operator at the gateway of an FS-Master: released until asked for, so that the change from 0 to 1 is seen.
pub struct Gateway {
    operator: Operator,
    pressed: bool,
    /// Exchanges since the button was released.
    released: u64,
}

/// A conformant FS-Master.
pub struct VirtualMaster {
    master: Master,
    operator: Operator,
    /// When MTimer was started, in nanoseconds.
    timer: u64,
    octets: Option<Octets>,
}

impl Partner {
    /// Takes over from the scripted tester.
    pub fn new(from: From, operator: Operator, session: &Session<'_>, tester: &mut Tester) -> Partner {
        let setup = session.setup();
        let gateway = Gateway { operator, pressed: false, released: 0 };
        match (setup.role, from, tester.answered) {
            (Role::Device, ..) => Partner::Master(VirtualMaster::new(from, operator, session, tester)),
            (Role::Master, From::Regular | From::Next | From::Zero, Some(answered)) => {
                let pdin = Pd::new(&tester.pattern(setup.pd_in)).unwrap_or(Pd::safe(setup.pd_in));
                Partner::Device(Box::new(Keeper::regular(setup, pdin, answered, session.now)), gateway)
            }
            (Role::Master, ..) => {
                let pdin = Pd::new(&tester.pattern(setup.pd_in)).unwrap_or(Pd::safe(setup.pd_in));
                Partner::Device(Box::new(Keeper::started(setup, pdin)), gateway)
            }
        }
    }

    /// One exchange, and what the partner makes of what reaches it over the way back.
    ///
    /// # Errors
    /// [`Stop`] when the case cannot go on.
    pub fn exchange(&mut self, back: &mut Channel, session: &mut Session<'_>, tester: &mut Tester) -> Result<(), Stop> {
        let octets = self.octets();
        self.exchange_instead(back, session, tester, octets)
    }

    /// What the partner presents.
    pub fn octets(&self) -> Option<Octets> {
        match self {
            Partner::Master(master) => master.octets,
            Partner::Device(keeper, _) => keeper.octets(),
        }
    }

    /// One exchange in which the DUT receives this, whatever the partner presents; and what the partner makes of what reaches it
    /// over the way back.
    ///
    /// # Errors
    /// [`Stop`] when the case cannot go on.
    pub fn exchange_instead(
        &mut self,
        back: &mut Channel,
        session: &mut Session<'_>,
        tester: &mut Tester,
        octets: Option<Octets>,
    ) -> Result<(), Stop> {
        if let Some(note) = back.note(session.now) {
            session.margin.announce(note);
        }
        match self {
            Partner::Master(master) => master.exchange(back, session, tester, octets),
            Partner::Device(keeper, gateway) => {
                gateway.operate(session)?;
                session.exchange(octets)?;
                let answered = keeper.answered();
                let octets = back
                    .pass(session.now, session.link(), tester, keeper.octets(), |counter| answered != Some(counter));
                keeper.received(session.now, octets.as_ref(), session.setup());
                tester.follow(keeper, session.now);
                Ok(())
            }
        }
    }

    /// Regular operation as both sides see it: live data both ways, no error, no safe data.
    pub fn operates(&self, session: &Session<'_>, tester: &Tester) -> bool {
        match self {
            Partner::Master(master) => master.operates(session, tester),
            Partner::Device(keeper, _) => {
                let app = &session.link().app;
                let control = session.answer().map(|view| view.control());
                let live = |pdin: Octets| pdin.as_slice() == keeper.sent().octets();
                control.is_some_and(|control| !control.set_sd && !control.ch_f_ack_req)
                    && app.sdset_s != Some(true)
                    && app.qualifier != Some(false)
                    && app.pdin_m.is_none_or(live)
                    && keeper.operates()
            }
        }
    }
}

impl Gateway {
    fn operate(&mut self, session: &mut Session<'_>) -> Result<(), Stop> {
        if !session.serves(Pco::App) {
            return Ok(());
        }
        let link = session.link();
        let asked = self.operator == Operator::Acknowledges && link.app.ch_f_ack_req_s == Some(true);
        // A good answer has to be checked while the button is released before pressing it counts (T13).
        let seen = self.released > session.profile.answer_latency + 1;
        match (link.ack, asked) {
            (true, asked) if !(self.pressed && asked) => {
                (self.pressed, self.released) = (false, 0);
                session.set(Service::ChfackC, Octets::bit(false))
            }
            (false, true) if seen => {
                self.pressed = true;
                session.set(Service::ChfackC, Octets::bit(true))
            }
            (false, _) => {
                self.released += 1;
                Ok(())
            }
            _ => Ok(()),
        }
    }
}

impl VirtualMaster {
    fn new(from: From, operator: Operator, session: &Session<'_>, tester: &mut Tester) -> VirtualMaster {
        let master = match (from, tester.count) {
            (From::Start, _) | (_, None) => {
                let mut master = Master::new();
                master.start();
                master
            }
            (From::Regular, Some(count)) => Master::regular(succ(count)),
            (From::Next, Some(count)) => Master::after_fault(succ(count)),
            (From::Zero, _) => Master::after_fault(0),
        };
        let mut partner = VirtualMaster { master, operator, timer: session.now, octets: None };
        partner.emit(session, tester);
        partner
    }

    fn exchange(
        &mut self,
        back: &mut Channel,
        session: &mut Session<'_>,
        tester: &mut Tester,
        octets: Option<Octets>,
    ) -> Result<(), Stop> {
        session.exchange(octets)?;
        let awaited = inv3(self.master.control().mcount);
        let octets = back.pass(session.now, session.link(), tester, self.octets, |counter| counter == awaited);
        let setup = session.setup();
        let answer = setup.view(octets.as_ref()).map(|view| Answer {
            status: view.status(),
            intact: view.signature_matches(setup.reading) && view.port_num() == setup.port.inverted(),
        });
        let asked = self.master.control().ch_f_ack_req;
        // Released until asked for, so that the change from 0 to 1 is seen.
        self.master.set_ch_f_ack_c(self.operator == Operator::Acknowledges && asked);
        let taken = answer.is_some_and(|answer| !self.master.receive(answer).is_empty());
        let expired = !taken
            && self.master.timer_runs()
            && session.now >= self.timer + setup.watchdog_ns
            && !self.master.expire().is_empty();
        if taken || expired {
            if self.master.timer_restarted() {
                self.timer = session.now;
            }
            self.emit(session, tester);
        }
        Ok(())
    }

    fn operates(&self, session: &Session<'_>, tester: &Tester) -> bool {
        let settled = session.answer().is_some_and(|view| {
            let status = view.status();
            !status.sd_set && !status.d_comm_err && !status.d_timeout
        });
        let live = |pdout: Octets| tester.pd.is_safe() || pdout.as_slice().iter().any(|octet| *octet != 0);
        let live = session.link().app.pdout_d.is_none_or(live);
        self.master.state().0 == 5 && !self.master.control().set_sd && self.master.get(Var::In) == 1 && settled && live
    }

    fn emit(&mut self, session: &Session<'_>, tester: &mut Tester) {
        let setup = session.setup();
        let pd = if self.master.uses_pdout() {
            Pd::new(&tester.pattern(setup.pd_out)).unwrap_or(Pd::safe(setup.pd_out))
        } else {
            Pd::safe(setup.pd_out)
        };
        let spdu = OutSpdu { pd, port: setup.port, control: self.master.control() };
        self.octets = Octets::new(spdu.wire().emit(setup.mode, setup.reading).octets());
        tester.count = Some(spdu.control.mcount);
        tester.pd = pd;
        tester.octets = self.octets;
        tester.remember(self.octets);
        tester.first_copy = session.now + session.profile.master_cycle_time_ns;
    }
}
