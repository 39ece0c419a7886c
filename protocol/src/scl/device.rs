//! The SCL of the FS-Device: Table 40 as rows, states 20..27, transitions T20..T31 (11.5.3).
//!
//! Both editions print the same rows; the counter check of the first SPDU is the one difference, see [`Device::receive`].

use super::{Action, Cond, Path, Row, State, T, Trigger, Var, Vars};
use crate::spdu::{Control, Status, inv3, succ};
use Action::{Copy, Down, If, Restart, Set};
use Cond::{All, Any, Is, Not, True};

/// SD for the technology, and the answer says so.
const SDOUT: Action = Set(Var::Out, 0);
const PDOUT: Action = Set(Var::Out, 1);
const PDIN_D: Action = Set(Var::In, 1);
const MIRROR: Action = Copy(Var::DcountI, Var::McountInv);

const TIMEOUT: &[Action] = &[
    PDIN_D,
    SDOUT,
    Set(Var::SetSdDc, 1),
    Set(Var::Sdset, 1),
    Set(Var::Dtimeout, 1),
    Set(Var::TimeoutCount, 1),
    Set(Var::SdCycles, 3),
    Restart,
    MIRROR,
];

const WORK_OFF_COMM_ERR: Action =
    If(Is(Var::CommErrCount, 1), &[Set(Var::DcommErr, 1), Set(Var::CommErrCount, 0)], &[Set(Var::DcommErr, 0)]);
const WORK_OFF_TIMEOUT: Action =
    If(Is(Var::TimeoutCount, 1), &[Set(Var::Dtimeout, 1), Set(Var::TimeoutCount, 0)], &[Set(Var::Dtimeout, 0)]);
const NEW_COMM_ERR: &[Action] = &[Set(Var::DcommErr, 1), Set(Var::CommErrCount, 1), Set(Var::SdCycles, 3)];

const fn row(id: u8, source: u8, target: u8, trigger: Trigger, guard: Cond, actions: &'static [Action]) -> Row {
    Row { id: T(id), source: State(source), target: State(target), trigger, guard, actions }
}

const BUSY: Cond = Any(&[Is(Var::CommErr, 1), Not(Var::SdCycles, 0)]);

/// The transitions of Table 40. T29 stands twice: nested and, where [`Var::Sequential`] is 1, sequential (A19).
pub static ROWS: [Row; 13] = [
    row(20, 20, 21, Trigger::Start, True, &[]),
    row(21, 21, 22, Trigger::Received, True, &[]),
    row(
        22,
        22,
        23,
        Trigger::Checked,
        Is(Var::CommErr, 0),
        &[
            PDIN_D,
            Set(Var::DcommErr, 0),
            Set(Var::Dtimeout, 0),
            MIRROR,
            Restart,
            If(
                Not(Var::SdCycles, 0),
                &[SDOUT, Set(Var::SetSdDc, 1), Set(Var::Sdset, 1), Down(Var::SdCycles)],
                &[PDOUT, Set(Var::SetSdDc, 0), Set(Var::Sdset, 0)],
            ),
            If(Is(Var::SetSdRx, 1), &[SDOUT, Set(Var::SetSdDc, 1)], &[]),
        ],
    ),
    row(23, 23, 24, Trigger::Send, True, &[If(Is(Var::SdsetDs, 1), &[Set(Var::Sdset, 1)], &[])]),
    row(24, 24, 22, Trigger::Received, True, &[]),
    row(
        25,
        22,
        25,
        Trigger::Checked,
        Is(Var::CommErr, 1),
        &[
            PDIN_D,
            SDOUT,
            Set(Var::SetSdDc, 1),
            Set(Var::Sdset, 1),
            Set(Var::DcommErr, 1),
            Set(Var::CommErrCount, 1),
            MIRROR,
            Set(Var::SdCycles, 3),
            Restart,
        ],
    ),
    row(26, 25, 26, Trigger::Send, True, &[]),
    row(27, 26, 27, Trigger::Received, True, &[]),
    row(
        28,
        27,
        23,
        Trigger::Checked,
        All(&[Is(Var::CommErr, 0), Is(Var::SdCycles, 0)]),
        &[
            PDIN_D,
            SDOUT,
            If(All(&[Is(Var::SetSdDcKept, 1), Is(Var::SetSdRx, 1)]), &[], &[Set(Var::SetSdDc, 0)]),
            Set(Var::Sdset, 0),
            MIRROR,
            Set(Var::DcommErr, 0),
            Set(Var::Dtimeout, 0),
            Restart,
        ],
    ),
    row(
        29,
        27,
        25,
        Trigger::Checked,
        All(&[BUSY, Is(Var::Sequential, 0)]),
        &[
            PDIN_D,
            SDOUT,
            Set(Var::SetSdDc, 1),
            Set(Var::Sdset, 1),
            MIRROR,
            Restart,
            If(Is(Var::CommErr, 1), NEW_COMM_ERR, &[Down(Var::SdCycles), WORK_OFF_COMM_ERR, WORK_OFF_TIMEOUT]),
        ],
    ),
    row(
        29,
        27,
        25,
        Trigger::Checked,
        All(&[BUSY, Is(Var::Sequential, 1)]),
        &[
            PDIN_D,
            SDOUT,
            Set(Var::SetSdDc, 1),
            Set(Var::Sdset, 1),
            MIRROR,
            Restart,
            If(Is(Var::CommErr, 1), NEW_COMM_ERR, &[Down(Var::SdCycles)]),
            WORK_OFF_COMM_ERR,
            WORK_OFF_TIMEOUT,
        ],
    ),
    row(30, 26, 25, Trigger::Timeout, True, TIMEOUT),
    row(31, 24, 25, Trigger::Timeout, True, TIMEOUT),
];

/// What is known of a received SPDU that is not all zero.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Received {
    /// Its control octet.
    pub control: Control,
    /// Signature and PortNum are right.
    pub intact: bool,
}

/// Readings of the tables that a product may follow throughout; the defaults are `false`.
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq, Hash)]
pub struct Readings {
    /// A08 and A16: "previous SPDU" and DCount_i are those of the last valid SPDU, not of the last processed one.
    pub last_valid: bool,
    /// A08 alone: "previous SPDU" is the last valid one. With it operation may never return, so no product may follow it.
    pub previous_valid: bool,
    /// A16 alone: DCount_i is that of the last valid SPDU. With it operation may never return, so no product may follow it.
    pub mirror_valid: bool,
    /// A09: a counter that is neither 0 nor the next one is ignored instead of being a CommErr.
    pub jump_ignored: bool,
    /// A19: T29 works off CommErrCount and TimeoutCount in the error cycle too.
    pub sequential: bool,
    /// A20: T28 leaves setSD_DC alone while setSD is 1.
    pub set_sd_dc_kept: bool,
    /// A23: a valid MCount 0 loads SDcycles.
    pub zero_reloads: bool,
}

/// One SCL of an FS-Device between two SPDUs.
#[derive(Copy, Clone, Debug, PartialEq, Eq, Hash)]
pub struct Device {
    state: State,
    vars: Vars,
    /// MCount of the previous SPDU; `None` until the first one.
    previous: Option<u8>,
    readings: Readings,
}

impl Device {
    /// State 20 after FSP parameterization, with the initial values of Table 40.
    pub fn new(readings: Readings) -> Device {
        let mut vars = Vars::ZERO;
        vars.set(Var::SdCycles, 3);
        vars.set(Var::Dtimeout, 1);
        vars.set(Var::SetSdDc, 1);
        let mut device = Device { state: State(20), vars, previous: None, readings };
        device.set_readings(readings);
        device
    }

    /// State 24 without a fault, all SD cycles worked off: regular operation in which this MCount was the last.
    pub fn regular(mcount: u8) -> Device {
        let mut device = Device::new(Readings::default());
        device.vars.set(Var::SdCycles, 0);
        device.vars.set(Var::Dtimeout, 0);
        device.vars.set(Var::SetSdDc, 0);
        device.vars.set(Var::McountInv, inv3(mcount));
        device.vars.set(Var::DcountI, inv3(mcount));
        device.previous = Some(mcount & 7);
        device.state = State(24);
        device
    }

    /// T20: the system start is OK.
    pub fn start(&mut self) -> Path {
        self.run(&[Trigger::Start])
    }

    /// The state, always a waiting one: 20, 21, 24 or 26.
    pub const fn state(&self) -> State {
        self.state
    }

    /// Whether an SPDU with this counter is the previous one once more, to be left alone.
    pub fn is_old(&self, mcount: u8) -> bool {
        self.state != State(21) && self.previous == Some(mcount)
    }

    /// Counter_check (Table 40): 0, or the one after the previous. The first SPDU has to carry 0 (iec2022; for v1.1 the
    /// default, A31).
    pub fn counter_check(&self, mcount: u8) -> bool {
        mcount == 0 || self.previous.is_some_and(|previous| mcount == succ(previous))
    }

    /// An SPDU that is not all zero is there: T21, T24 or T27, the checks, and the answer. Empty when it is left alone.
    pub fn receive(&mut self, received: Received) -> Path {
        let mcount = received.control.mcount;
        if self.is_old(mcount) || (self.readings.jump_ignored && self.is_jump(received)) {
            return Path::default();
        }
        self.process(received, received.intact && self.counter_check(mcount))
    }

    /// As [`Device::receive`], with the outcome of the checks given: for the readings that only concern one SPDU
    /// (A29: an error is found although the counter is old; A31: the first SPDU may carry 1).
    pub fn process(&mut self, received: Received, valid: bool) -> Path {
        if self.state == State(20) {
            return Path::default();
        }
        let mcount = received.control.mcount;
        let Readings { last_valid, previous_valid, mirror_valid, zero_reloads, .. } = self.readings;
        if valid || !(last_valid || previous_valid) {
            self.previous = Some(mcount);
        }
        if valid || !(last_valid || mirror_valid) {
            self.vars.set(Var::McountInv, inv3(mcount));
        }
        if valid && zero_reloads && mcount == 0 {
            self.vars.set(Var::SdCycles, 3);
        }
        self.vars.set(Var::CommErr, (!valid).into());
        self.vars.set(Var::SetSdRx, received.control.set_sd.into());
        self.vars.set(Var::ChFAckReqDc, received.control.ch_f_ack_req.into());
        self.run(&[Trigger::Received, Trigger::Checked, Trigger::Send])
    }

    fn is_jump(&self, received: Received) -> bool {
        self.state != State(21) && received.intact && !self.counter_check(received.control.mcount)
    }

    /// DTimer has expired: T31 or T30. Empty where no timer runs.
    pub fn expire(&mut self) -> Path {
        self.run(&[Trigger::Timeout, Trigger::Send])
    }

    /// Service SDset_DS, looked at by T23.
    pub fn set_sdset_ds(&mut self, value: bool) {
        self.vars.set(Var::SdsetDs, value.into());
    }

    /// Changes the readings followed from here on.
    pub fn set_readings(&mut self, readings: Readings) {
        self.readings = readings;
        self.vars.set(Var::Sequential, readings.sequential.into());
        self.vars.set(Var::SetSdDcKept, readings.set_sd_dc_kept.into());
    }

    /// The readings followed.
    pub const fn readings(&self) -> Readings {
        self.readings
    }

    /// A variable of the table.
    pub const fn get(&self, var: Var) -> u8 {
        self.vars.get(var)
    }

    /// Counter of the SPDU processed last; `None` before the first.
    pub const fn previous(&self) -> Option<u8> {
        self.previous
    }

    /// The status octet of the answer that stands. Meaningless in states 20 and 21, where nothing has been sent.
    pub const fn status(&self) -> Status {
        Status {
            dcount_i: self.vars.get(Var::DcountI),
            sd_set: self.vars.is(Var::Sdset),
            d_comm_err: self.vars.is(Var::DcommErr),
            d_timeout: self.vars.is(Var::Dtimeout),
        }
    }

    /// Whether PDout (and not SDout) goes to the technology.
    pub const fn uses_pdout(&self) -> bool {
        self.vars.is(Var::Out)
    }

    /// Whether the last step restarted DTimer.
    pub const fn timer_restarted(&self) -> bool {
        self.vars.is(Var::TimerRestarted)
    }

    /// Whether DTimer runs: in states 24 and 26.
    pub const fn timer_runs(&self) -> bool {
        matches!(self.state.0, 24 | 26)
    }

    /// The same without the inputs of the last step: two machines that go on alike are then equal.
    #[must_use]
    pub fn settled(self) -> Device {
        let inputs = [Var::TimerRestarted, Var::SdsetDs, Var::SetSdRx, Var::ChFAckReqDc, Var::CommErr];
        Device { vars: self.vars.without(&inputs), ..self }
    }

    fn run(&mut self, triggers: &[Trigger]) -> Path {
        super::run(&ROWS, &mut self.state, &mut self.vars, triggers)
    }
}
