//! The SCL of the FS-Master: Table 38 as rows, states 1..8, transitions T1..T14 (11.5.2).

use super::{Action, Cond, Path, Row, State, T, Trigger, Var, Vars};
use crate::spdu::{Control, Status, inv3};
use Action::{If, Next, Restart, Set};
use Cond::{All, Any, Is, True};

const USE_SD: [Action; 2] = [Set(Var::In, 0), Set(Var::Out, 0)];
const COUNT: Action = Next(Var::Mcount);
const SELECT_IN: Action = If(
    Any(&[Is(Var::SdsetRx, 1), Is(Var::SetSdC, 1)]),
    &[Set(Var::In, 0), Set(Var::SdsetS, 1)],
    &[Set(Var::In, 1), Set(Var::SdsetS, 0)],
);
const SELECT_OUT: Action =
    If(Is(Var::SetSdC, 1), &[Set(Var::Out, 0), Set(Var::SetSd, 1)], &[Set(Var::Out, 1), Set(Var::SetSd, 0)]);
const DISARM: [Action; 3] = [Set(Var::ChFAckReq, 0), Set(Var::ChFAckReqS, 0), Set(Var::ChFAckCe, 0)];
const SD_SET: [Action; 2] = [Set(Var::SetSd, 1), Set(Var::SdsetS, 1)];
const ZERO: Action = Set(Var::Mcount, 0);

const fn row(id: u8, source: u8, target: u8, trigger: Trigger, guard: Cond, actions: &'static [Action]) -> Row {
    Row { id: T(id), source: State(source), target: State(target), trigger, guard, actions }
}

/// The transitions of Table 38.
pub static ROWS: [Row; 14] = [
    row(1, 0, 1, Trigger::Start, True, &[USE_SD[0], USE_SD[1], SD_SET[0], SD_SET[1], ZERO]),
    row(2, 1, 2, Trigger::Send, True, &[]),
    row(3, 2, 3, Trigger::Received, True, &[]),
    row(4, 3, 4, Trigger::Checked, Is(Var::Faults, 0), &[COUNT, SELECT_IN, SELECT_OUT]),
    row(5, 4, 5, Trigger::Send, True, &[Restart]),
    row(6, 5, 3, Trigger::Received, True, &[]),
    row(7, 3, 6, Trigger::Checked, Is(Var::Faults, 1), &[USE_SD[0], USE_SD[1], SD_SET[0], SD_SET[1], COUNT]),
    row(8, 5, 6, Trigger::Timeout, True, &[USE_SD[0], USE_SD[1], SD_SET[0], SD_SET[1], ZERO]),
    row(9, 6, 7, Trigger::Send, True, &[Restart]),
    row(10, 7, 8, Trigger::Received, True, &[]),
    row(
        11,
        8,
        4,
        Trigger::Checked,
        All(&[Is(Var::Faults, 0), Is(Var::ChFAckC, 1), Is(Var::ChFAckCe, 1)]),
        &[DISARM[0], DISARM[1], DISARM[2], COUNT, SELECT_IN, SELECT_OUT],
    ),
    row(
        12,
        8,
        6,
        Trigger::Checked,
        Is(Var::Faults, 1),
        &[DISARM[0], DISARM[1], DISARM[2], USE_SD[0], USE_SD[1], SD_SET[0], SD_SET[1], COUNT],
    ),
    row(
        13,
        8,
        6,
        Trigger::Checked,
        All(&[Is(Var::Faults, 0), Any(&[Is(Var::ChFAckC, 0), Is(Var::ChFAckCe, 0)])]),
        &[
            Set(Var::ChFAckReq, 1),
            Set(Var::ChFAckReqS, 1),
            If(Is(Var::ChFAckC, 0), &[Set(Var::ChFAckCe, 1)], &[]),
            USE_SD[0],
            USE_SD[1],
            SD_SET[0],
            SD_SET[1],
            COUNT,
        ],
    ),
    row(
        14,
        7,
        6,
        Trigger::Timeout,
        True,
        &[DISARM[0], DISARM[1], DISARM[2], USE_SD[0], USE_SD[1], SD_SET[0], SD_SET[1], ZERO],
    ),
];

/// What is known of an answer that is not all zero.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Answer {
    /// Its status octet.
    pub status: Status,
    /// Signature and inverted PortNum are right.
    pub intact: bool,
}

/// One SCL of an FS-Master between two answers.
#[derive(Copy, Clone, Debug, PartialEq, Eq, Hash)]
pub struct Master {
    state: State,
    vars: Vars,
    /// DCount_i of the answer processed last; `None` until the first one.
    previous: Option<u8>,
}

impl Default for Master {
    fn default() -> Self {
        Master::new()
    }
}

impl Master {
    /// Before T1, with the initial values of Table 38.
    pub const fn new() -> Master {
        Master { state: State(0), vars: Vars::ZERO, previous: None }
    }

    /// Waiting in state 7 for the answer to an exceptional SPDU with this counter: where a fault has left the machine.
    pub fn after_fault(mcount: u8) -> Master {
        let mut master = Master::new();
        master.vars.set(Var::SetSd, 1);
        master.vars.set(Var::SdsetS, 1);
        master.vars.set(Var::Mcount, mcount & 7);
        master.state = State(7);
        master
    }

    /// Waiting in state 5 for the answer to a regular SPDU with this counter, not 0; the SPDU before it has been answered.
    pub fn regular(mcount: u8) -> Master {
        let mut master = Master::new();
        master.vars.set(Var::In, 1);
        master.vars.set(Var::Out, 1);
        master.vars.set(Var::Mcount, mcount & 7);
        master.previous = Some(inv3(if mcount == 1 { 7 } else { mcount.wrapping_sub(1) & 7 }));
        master.state = State(5);
        master
    }

    /// T1, T2: the preconditions are fulfilled and the first SPDU is sent.
    pub fn start(&mut self) -> Path {
        self.run(&[Trigger::Start, Trigger::Send])
    }

    /// The state, always 0 or a waiting one: 2, 5 or 7.
    pub const fn state(&self) -> State {
        self.state
    }

    /// Whether an answer with this counter is taken: any in state 2, another than the previous in 5 (T6), the mirrored
    /// one in 7 (T10, A06).
    pub fn takes(&self, dcount_i: u8) -> bool {
        match self.state.0 {
            2 => true,
            5 => self.previous != Some(dcount_i),
            7 => dcount_i == inv3(self.vars.get(Var::Mcount)),
            _ => false,
        }
    }

    /// An answer that is not all zero is there: the checks and the next SPDU. Empty when it is left alone.
    pub fn receive(&mut self, answer: Answer) -> Path {
        if self.takes(answer.status.dcount_i) { self.process(answer) } else { Path::default() }
    }

    /// As [`Master::receive`], whatever the guards of T6 and T10 say: for the readings that look at an answer all the same
    /// (A05: all zero in state 7; A06: a foreign counter in state 7; A29: an error although the counter is old).
    pub fn process(&mut self, answer: Answer) -> Path {
        let Status { dcount_i, sd_set, d_comm_err, d_timeout } = answer.status;
        let mirrored = dcount_i == inv3(self.vars.get(Var::Mcount));
        let faults = !answer.intact || !mirrored || d_comm_err || d_timeout;
        self.previous = Some(dcount_i);
        self.vars.set(Var::SdsetRx, sd_set.into());
        self.vars.set(Var::Faults, faults.into());
        self.run(&[Trigger::Received, Trigger::Checked, Trigger::Send])
    }

    /// MTimer has expired: T8 or T14. Empty where no timer runs.
    pub fn expire(&mut self) -> Path {
        self.run(&[Trigger::Timeout, Trigger::Send])
    }

    /// Service ChFAck_C: acknowledgment by the operator.
    pub fn set_ch_f_ack_c(&mut self, value: bool) {
        self.vars.set(Var::ChFAckC, value.into());
    }

    /// Service setSD_C.
    pub fn set_set_sd_c(&mut self, value: bool) {
        self.vars.set(Var::SetSdC, value.into());
    }

    /// A variable of the table.
    pub const fn get(&self, var: Var) -> u8 {
        self.vars.get(var)
    }

    /// The control octet of the SPDU that stands.
    pub const fn control(&self) -> Control {
        Control {
            mcount: self.vars.get(Var::Mcount),
            set_sd: self.vars.is(Var::SetSd),
            ch_f_ack_req: self.vars.is(Var::ChFAckReq),
        }
    }

    /// Whether PDout (and not SDout) is sent.
    pub const fn uses_pdout(&self) -> bool {
        self.vars.is(Var::Out)
    }

    /// Whether the last step restarted MTimer.
    pub const fn timer_restarted(&self) -> bool {
        self.vars.is(Var::TimerRestarted)
    }

    /// Whether MTimer runs: in states 5 and 7.
    pub const fn timer_runs(&self) -> bool {
        matches!(self.state.0, 5 | 7)
    }

    /// DCount_i of the answer processed last; `None` before the first.
    pub const fn previous(&self) -> Option<u8> {
        self.previous
    }

    /// The same without the inputs of the last step: two machines that go on alike are then equal. State 7 looks at the expected
    /// counter alone, so it forgets the previous one unless that is `kept` for another reading of T10 (A06).
    #[must_use]
    pub fn settled(self, kept: bool) -> Master {
        let inputs = [Var::TimerRestarted, Var::ChFAckC, Var::SetSdC, Var::SdsetRx, Var::Faults];
        let previous = self.previous.filter(|_| kept || self.state != State(7));
        Master { vars: self.vars.without(&inputs), previous, ..self }
    }

    fn run(&mut self, triggers: &[Trigger]) -> Path {
        super::run(&ROWS, &mut self.state, &mut self.vars, triggers)
    }
}
