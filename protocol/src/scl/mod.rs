//! The state machines of the safety communication layer as rows of data (11.5.2, 11.5.3), and what steps them.
//!
//! A row reads like a row of Table 38 or Table 40. [`step`] is the whole interpreter; [`device`] and [`master`] hold the rows and
//! the little that stands around the tables: when a received SPDU counts as old and what the checks look at.

pub mod device;
pub mod master;

pub use device::Device;
pub use master::Master;

use core::fmt;

/// A transition of Table 38 (T1..T14) or Table 40 (T20..T31), by its number.
#[derive(Copy, Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct T(pub u8);

impl fmt::Display for T {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "T{}", self.0)
    }
}

/// A state of either machine, by its number in the figures; 0 is the pseudo state before power-on.
#[derive(Copy, Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct State(pub u8);

impl fmt::Display for State {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.0)
    }
}

/// What makes a machine look for a transition.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Trigger {
    /// Preconditions fulfilled (T1) or system start OK (T20).
    Start,
    /// The prepared SPDU is sent.
    Send,
    /// An SPDU that is not all zero is available.
    Received,
    /// The checks of states 3, 8, 22 and 27 are done.
    Checked,
    /// MTimer or DTimer has expired.
    Timeout,
}

/// A variable of the tables. `...Rx` are fields of the SPDU received last.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Var {
    // Both machines
    /// Process data in use towards the FS-Device: 0 = SDout, 1 = PDout.
    Out,
    /// Process data in use towards the FS-Master: 0 = SDin, 1 = PDin (FS-Master), PDin_D (FS-Device).
    In,
    /// The timer has been restarted in this step.
    TimerRestarted,
    // FS-Master
    /// MCount.
    Mcount,
    /// setSD.
    SetSd,
    /// ChFAckReq.
    ChFAckReq,
    /// Service SDset_S.
    SdsetS,
    /// Service ChFAckReq_S.
    ChFAckReqS,
    /// ChFAck_C_e: the acknowledgment has been seen at 0.
    ChFAckCe,
    /// Service ChFAck_C.
    ChFAckC,
    /// Service setSD_C.
    SetSdC,
    /// SDset of the answer.
    SdsetRx,
    /// FAULTS: timeout or error on either side.
    Faults,
    // FS-Device
    /// DCount_i.
    DcountI,
    /// SDset.
    Sdset,
    /// DCommErr.
    DcommErr,
    /// DTimeout.
    Dtimeout,
    /// SDcycles, 0..3.
    SdCycles,
    /// CommErrCount, 0..1.
    CommErrCount,
    /// TimeoutCount, 0..1.
    TimeoutCount,
    /// Service setSD_DC.
    SetSdDc,
    /// Service ChFAckReq_DC.
    ChFAckReqDc,
    /// Service SDset_DS.
    SdsetDs,
    /// setSD of the SPDU.
    SetSdRx,
    /// MCount_inv: inverse of the MCount received last.
    McountInv,
    /// CommErr: CRC, PortNum or counter wrong.
    CommErr,
    /// 1: T29 is read with the last two conditions not nested under "no CommErr" (tolerance A19).
    Sequential,
    /// 1: T28 leaves setSD_DC alone while setSD is 1 (A20).
    SetSdDcKept,
}

const VARS: usize = Var::SetSdDcKept as usize + 1;

/// The variables of one machine. All start at 0; the machines set what the tables start otherwise.
#[derive(Copy, Clone, Debug, PartialEq, Eq, Hash)]
pub struct Vars([u8; VARS]);

impl Vars {
    /// Every variable 0.
    pub const ZERO: Vars = Vars([0; VARS]);

    /// The value of a variable.
    pub const fn get(&self, var: Var) -> u8 {
        self.0[var as usize]
    }

    /// Whether a variable of one bit is 1.
    pub const fn is(&self, var: Var) -> bool {
        self.get(var) != 0
    }

    /// Gives a variable a value.
    pub const fn set(&mut self, var: Var, value: u8) {
        self.0[var as usize] = value;
    }

    /// The same with these variables 0.
    fn without(mut self, vars: &[Var]) -> Vars {
        vars.iter().for_each(|var| self.set(*var, 0));
        self
    }
}

/// A condition of a guard or of an action.
#[derive(Copy, Clone, Debug)]
pub enum Cond {
    /// Always true.
    True,
    /// The variable has this value.
    Is(Var, u8),
    /// The variable has another value.
    Not(Var, u8),
    /// All of these.
    All(&'static [Cond]),
    /// At least one of these.
    Any(&'static [Cond]),
}

impl Cond {
    fn holds(&self, vars: &Vars) -> bool {
        match self {
            Cond::True => true,
            Cond::Is(var, value) => vars.get(*var) == *value,
            Cond::Not(var, value) => vars.get(*var) != *value,
            Cond::All(all) => all.iter().all(|cond| cond.holds(vars)),
            Cond::Any(any) => any.iter().any(|cond| cond.holds(vars)),
        }
    }
}

/// An action of a transition.
#[derive(Copy, Clone, Debug)]
pub enum Action {
    /// Give a variable a value.
    Set(Var, u8),
    /// Give a variable the value of another.
    Copy(Var, Var),
    /// Count MCount on: 1..7 round.
    Next(Var),
    /// Count down by one; stays at 0.
    Down(Var),
    /// Load the timer with FSP_Watchdog and start it.
    Restart,
    /// One list of actions or the other.
    If(Cond, &'static [Action], &'static [Action]),
}

/// One transition: a row of the table.
#[derive(Copy, Clone, Debug)]
pub struct Row {
    /// Its number.
    pub id: T,
    /// State it leaves.
    pub source: State,
    /// State it enters.
    pub target: State,
    /// What makes it be looked at.
    pub trigger: Trigger,
    /// Guard.
    pub guard: Cond,
    /// Actions, carried out top to bottom.
    pub actions: &'static [Action],
}

/// Steps a machine: the first row that leaves `state` on `trigger` with a true guard is carried out and returned.
/// `None`: the machine stays where it is.
pub fn step(rows: &'static [Row], state: State, trigger: Trigger, vars: &mut Vars) -> Option<&'static Row> {
    let row = rows.iter().find(|row| row.source == state && row.trigger == trigger && row.guard.holds(vars))?;
    carry_out(row.actions, vars);
    Some(row)
}

fn carry_out(actions: &'static [Action], vars: &mut Vars) {
    for action in actions {
        match action {
            Action::Set(var, value) => vars.set(*var, *value),
            Action::Copy(var, from) => vars.set(*var, vars.get(*from)),
            Action::Next(var) => vars.set(*var, crate::spdu::succ(vars.get(*var))),
            Action::Down(var) => vars.set(*var, vars.get(*var).saturating_sub(1)),
            Action::Restart => vars.set(Var::TimerRestarted, 1),
            Action::If(cond, then, otherwise) => {
                carry_out(if cond.holds(vars) { then } else { otherwise }, vars);
            }
        }
    }
}

/// Steps a machine through `triggers`, as far as there are transitions: from one waiting state to the next.
fn run(rows: &'static [Row], state: &mut State, vars: &mut Vars, triggers: &[Trigger]) -> Path {
    let mut path = Path::default();
    vars.set(Var::TimerRestarted, 0);
    for trigger in triggers {
        let Some(row) = step(rows, *state, *trigger, vars) else { break };
        *state = row.target;
        path.push(row.id);
    }
    path
}

/// Transitions taken in one go, in order: at most four between two waiting states.
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq, Hash)]
pub struct Path {
    taken: [u8; 4],
    length: u8,
}

impl Path {
    /// These transitions; of more than four the first four.
    pub fn of(transitions: &[T]) -> Path {
        let mut path = Path::default();
        transitions.iter().for_each(|id| path.push(*id));
        path
    }

    /// The transitions, in order.
    pub fn iter(&self) -> impl Iterator<Item = T> + '_ {
        self.taken.iter().take(usize::from(self.length)).map(|number| T(*number))
    }

    /// The last transition but the sending one: the row that decided the answer.
    pub fn deciding(&self) -> Option<T> {
        self.iter().filter(|t| !matches!(t.0, 2 | 5 | 9 | 23 | 26)).last()
    }

    /// Whether nothing happened.
    pub const fn is_empty(&self) -> bool {
        self.length == 0
    }

    fn push(&mut self, id: T) {
        if let Some(slot) = self.taken.get_mut(usize::from(self.length)) {
            *slot = id.0;
            self.length += 1;
        }
    }
}
