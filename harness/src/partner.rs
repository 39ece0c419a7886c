//! The virtual FS-Master as a conformant partner: Table 38 interpreted, over the link as it is.

use crate::case::model::{From, Operator};
use crate::session::{Session, Stop};
use crate::tester::Tester;
use fsct_adapters::Octets;
use fsct_protocol::scl::master::Answer;
use fsct_protocol::scl::{Master, Var};
use fsct_protocol::spdu::{OutSpdu, Pd, succ};

/// A conformant FS-Master on the link.
pub struct Partner {
    master: Master,
    operator: Operator,
    /// When MTimer was started, in nanoseconds.
    timer: u64,
    octets: Option<Octets>,
}

impl Partner {
    /// Takes over from the scripted tester.
    pub fn new(from: From, operator: Operator, session: &Session<'_>, tester: &mut Tester) -> Partner {
        let master = match (from, tester.count) {
            (From::Start, _) | (_, None) => {
                let mut master = Master::new();
                master.start();
                master
            }
            (From::Next, Some(count)) => Master::after_fault(succ(count)),
            (From::Zero, _) => Master::after_fault(0),
        };
        let mut partner = Partner { master, operator, timer: session.now, octets: None };
        partner.emit(session, tester);
        partner
    }

    /// One exchange, and what the FS-Master makes of the answer.
    ///
    /// # Errors
    /// [`Stop`] when the case cannot go on.
    pub fn exchange(&mut self, session: &mut Session<'_>, tester: &mut Tester) -> Result<(), Stop> {
        session.exchange(self.octets)?;
        let setup = session.oracle.setup();
        let answer = session.answer().map(|view| Answer {
            status: view.status(),
            intact: view.signature_matches(setup.reading) && view.port_num() == setup.port.inverted(),
        });
        let asked = self.master.control().ch_f_ack_req;
        // Released until asked for, so that the change from 0 to 1 is seen.
        self.master.set_ch_f_ack_c(self.operator == Operator::Acknowledges && asked);
        let taken = answer.is_some_and(|answer| !self.master.receive(answer).is_empty());
        let expired = !taken
            && self.master.timer_runs()
            && session.now >= self.timer + session.oracle.setup().watchdog_ns
            && !self.master.expire().is_empty();
        if taken || expired {
            if self.master.timer_restarted() {
                self.timer = session.now;
            }
            self.emit(session, tester);
        }
        Ok(())
    }

    /// Regular operation as both sides see it: live data both ways, no error, no safe data.
    pub fn operates(&self, session: &Session<'_>, tester: &Tester) -> bool {
        let settled = session.answer().is_some_and(|view| {
            let status = view.status();
            !status.sd_set && !status.d_comm_err && !status.d_timeout
        });
        let live = |pdout: Octets| tester.pdout.is_safe() || pdout.as_slice().iter().any(|octet| *octet != 0);
        let live = session.app.pdout_d.is_none_or(live);
        self.master.state().0 == 5 && !self.master.control().set_sd && self.master.get(Var::In) == 1 && settled && live
    }

    fn emit(&mut self, session: &Session<'_>, tester: &mut Tester) {
        let setup = session.oracle.setup();
        let pd = if self.master.uses_pdout() {
            Pd::new(&tester.pattern(setup.pd_out)).unwrap_or(Pd::safe(setup.pd_out))
        } else {
            Pd::safe(setup.pd_out)
        };
        let spdu = OutSpdu { pd, port: setup.port, control: self.master.control() };
        self.octets = Octets::new(spdu.wire().emit(setup.mode, setup.reading).octets());
        tester.count = Some(spdu.control.mcount);
        tester.pdout = pd;
        tester.octets = self.octets;
        tester.first_copy = session.now + session.profile.master_cycle_time_ns;
    }
}
