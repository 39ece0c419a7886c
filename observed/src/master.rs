//! An FS-Master in front of a tester that plays FS-Device, operator and gateway.

use crate::{Counted, Subject};
use fsct_protocol::scl::master::Answer;
use fsct_protocol::scl::{Master, Var};
use fsct_protocol::spdu::{Control, Status, inv3, succ};

/// An answer with what the gateway sets meanwhile, or none for too long. What is not named is 0.
#[derive(Copy, Clone, Debug, PartialEq, Eq, Hash)]
pub enum Input {
    /// The mirrored counter.
    Good {
        /// SDset.
        sd_set: bool,
        /// ChFAck_C while the answer is evaluated.
        ack: bool,
        /// setSD_C while the answer is evaluated.
        set_sd: bool,
    },
    /// The FS-Device reports a timeout, with SDset.
    Dtimeout,
    /// The FS-Device reports a CommErr, with SDset.
    DcommErr,
    /// The mirrored counter, a wrong signature.
    Corrupt,
    /// A counter that neither mirrors nor is the previous one.
    Foreign,
    /// The counter of the answer before.
    Old,
    /// All octets 0.
    AllZero,
    /// No new answer until FSP_Watchdog has expired; in state 2 for longer than that.
    Timeout,
}

/// What comes of it: a new SPDU, and with it what the gateway is given.
#[derive(Copy, Clone, Debug, PartialEq, Eq, Hash)]
pub struct Output {
    /// setSD.
    pub set_sd: bool,
    /// ChFAckReq, and ChFAckReq_S with it.
    pub ch_f_ack_req: bool,
    /// PDout is live in the SPDU.
    pub pdout: bool,
    /// PDin_M is live.
    pub pdin: bool,
}

/// The machine, and the counter of the answer before.
#[derive(Copy, Clone, Debug, PartialEq, Eq, Hash)]
pub struct Bench {
    /// The machine.
    pub master: Master,
    /// DCount_i of the answer that was taken last.
    pub given: Option<u8>,
}

impl Bench {
    /// The first SPDU is sent, no answer yet.
    pub fn waiting() -> Bench {
        let mut master = Master::new();
        master.start();
        Bench { master: master.settled(true), given: None }
    }

    /// What stands: the SPDU, and what the gateway is given.
    pub fn output(&self) -> Output {
        let Control { set_sd, ch_f_ack_req, .. } = self.master.control();
        Output { set_sd, ch_f_ack_req, pdout: self.master.uses_pdout(), pdin: self.master.get(Var::In) == 1 }
    }
}

const fn good(sd_set: bool, ack: bool, set_sd: bool) -> Input {
    Input::Good { sd_set, ack, set_sd }
}

impl Subject for Bench {
    type Input = Input;
    type Output = Option<Output>;

    const INPUTS: &'static [(&'static str, Input)] = &[
        ("GOOD", good(false, false, false)),
        ("GOOD+ack", good(false, true, false)),
        ("GOOD+setSD_C", good(false, false, true)),
        ("GOOD+ack+setSD_C", good(false, true, true)),
        ("SDSET", good(true, false, false)),
        ("SDSET+ack", good(true, true, false)),
        ("SDSET+setSD_C", good(true, false, true)),
        ("SDSET+ack+setSD_C", good(true, true, true)),
        ("DTO", Input::Dtimeout),
        ("DCE", Input::DcommErr),
        ("BADCRC", Input::Corrupt),
        ("FOREIGN", Input::Foreign),
        ("OLD", Input::Old),
        ("ZERO", Input::AllZero),
        ("TIMEOUT", Input::Timeout),
    ];

    fn apply(&mut self, input: Input) -> Option<Output> {
        let Bench { master, given } = self;
        let mcount = master.control().mcount;
        let mirrored = Status { dcount_i: inv3(mcount), sd_set: false, d_comm_err: false, d_timeout: false };
        let (ack, set_sd) = match input {
            Input::Good { ack, set_sd, .. } => (ack, set_sd),
            _ => (false, false),
        };
        master.set_ch_f_ack_c(ack);
        master.set_set_sd_c(set_sd);
        let answer = |status| Some(Answer { status, intact: true });
        let answered = match input {
            Input::Good { sd_set, .. } => answer(Status { sd_set, ..mirrored }),
            Input::Dtimeout => answer(Status { sd_set: true, d_timeout: true, ..mirrored }),
            Input::DcommErr => answer(Status { sd_set: true, d_comm_err: true, ..mirrored }),
            Input::Corrupt => Some(Answer { status: mirrored, intact: false }),
            Input::Foreign => answer(Status { dcount_i: inv3(succ(succ(mcount))), ..mirrored }),
            // After T8 with MCount 1 the previous counter mirrors the new one: there is nothing old to send.
            Input::Old => given
                .filter(|dcount_i| *dcount_i != mirrored.dcount_i)
                .and_then(|dcount_i| answer(Status { dcount_i, ..mirrored })),
            Input::AllZero | Input::Timeout => None,
        };
        let path = match (input, answered) {
            (Input::Timeout, _) => master.expire(),
            (_, Some(answer)) => master.receive(answer),
            (_, None) => Default::default(),
        };
        if !path.is_empty() {
            *given = master.previous();
        }
        *master = master.settled(true);
        (!path.is_empty()).then(|| self.output())
    }
}

impl Counted for Bench {
    type Seen = Output;

    fn counter(&self) -> u8 {
        self.master.control().mcount
    }
}
