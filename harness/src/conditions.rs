//! The conditions that decide what a machine does, each asked in one state, and which way each was decided.
//!
//! A condition counts as true or false only where everything else was such that this one decided: with the other outcome the
//! DUT would have had to do something else that can be seen from outside. What they mean, and the sides that cannot come, is told
//! in `testcases/coverage/*.yaml`.

use fsct_adapters::Role;
use fsct_protocol::scl::device::Received;
use fsct_protocol::scl::master::Answer;
use fsct_protocol::scl::{Device, Master, State, Var};
use fsct_protocol::spdu::{inv3, succ};

macro_rules! conditions {
    ($(#[$doc:meta])* $name:ident: $($variant:ident = $id:literal,)*) => {
        $(#[$doc])*
        #[derive(Copy, Clone, Debug, PartialEq, Eq)]
        #[expect(missing_docs, reason = "told in testcases/coverage")]
        pub enum $name { $($variant,)* }

        impl $name {
            /// Their ids, in order.
            pub const IDS: &'static [&'static str] = &[$($id,)*];
        }

        impl From<$name> for u8 {
            fn from(condition: $name) -> u8 {
                condition as u8
            }
        }
    };
}

conditions! {
    /// Those of Table 40; the timers last.
    OfDevice:
    Started = "D20-PRECONDITIONS",
    NotZero21 = "D21-NOT-ZERO",
    Signature22 = "D22-SIGNATURE",
    PortNum22 = "D22-PORTNUM",
    First22 = "D22-FIRST-0",
    Zero22 = "D22-MCOUNT-0",
    Next22 = "D22-MCOUNT-NEXT",
    SdCycles22 = "D22-SDCYCLES",
    SetSd22 = "D22-SETSD",
    SdsetDs23 = "D23-SDSET-DS",
    NotZero24 = "D24-NOT-ZERO",
    NotOld24 = "D24-NOT-OLD",
    NotZero26 = "D26-NOT-ZERO",
    NotOld26 = "D26-NOT-OLD",
    Signature27 = "D27-SIGNATURE",
    PortNum27 = "D27-PORTNUM",
    Zero27 = "D27-MCOUNT-0",
    Next27 = "D27-MCOUNT-NEXT",
    SdCycles27 = "D27-SDCYCLES",
    CommErr27 = "D27-COMMERR",
    CommErrCount27 = "D27-COMMERRCOUNT",
    TimeoutCount27 = "D27-TIMEOUTCOUNT",
    Timer21 = "DTIMER-21",
    Timer24 = "DTIMER-24",
    Timer26 = "DTIMER-26",
}

conditions! {
    /// Those of Table 38; the timers last.
    OfMaster:
    Started = "M0-PRECONDITIONS",
    NotZero2 = "M2-NOT-ZERO",
    Signature3 = "M3-SIGNATURE",
    PortNum3 = "M3-PORTNUM",
    Mirror3 = "M3-DCOUNT",
    Dtimeout3 = "M3-DTIMEOUT",
    DcommErr3 = "M3-DCOMMERR",
    Mtimeout3 = "M3-MTIMEOUT",
    Sdset3 = "M3-SDSET",
    SetSdC3 = "M3-SETSD-C",
    NotZero5 = "M5-NOT-ZERO",
    NotOld5 = "M5-NOT-OLD",
    NotZero7 = "M7-NOT-ZERO",
    Expected7 = "M7-EXPECTED",
    Signature8 = "M8-SIGNATURE",
    PortNum8 = "M8-PORTNUM",
    Mirror8 = "M8-DCOUNT",
    Dtimeout8 = "M8-DTIMEOUT",
    DcommErr8 = "M8-DCOMMERR",
    Mtimeout8 = "M8-MTIMEOUT",
    ChFAckC8 = "M8-CHFACK-C",
    ChFAckCe8 = "M8-CHFACK-C-E",
    Arm8 = "M8-ARM",
    Sdset8 = "M8-SDSET",
    SetSdC8 = "M8-SETSD-C",
    Timer2 = "MTIMER-2",
    Timer5 = "MTIMER-5",
    Timer7 = "MTIMER-7",
}

/// The ids of a role, in the order of the bits of [`Sides`].
pub const fn ids(role: Role) -> &'static [&'static str] {
    match role {
        Role::Device => OfDevice::IDS,
        Role::Master => OfMaster::IDS,
    }
}

/// Whether the id is that of a timer, with the sides `expired` and `restarted`, and not of a guard, `true` and `false`.
pub fn is_timer(id: &str) -> bool {
    id.contains("TIMER-")
}

/// Both sides of a condition by name.
pub fn sides(id: &str) -> [String; 2] {
    let words = if is_timer(id) { ["expired", "restarted"] } else { ["true", "false"] };
    words.map(|word| format!("{id} {word}"))
}

/// Which sides of the conditions of one machine were seen to decide.
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq, Hash)]
pub struct Sides(u64);

impl Sides {
    /// None.
    pub const NONE: Sides = Sides(0);

    /// This condition has decided, and how. Of a timer: it has expired, or it was restarted before that.
    pub fn set(&mut self, condition: impl Into<u8>, side: bool) {
        self.0 |= 1 << (2 * condition.into() + u8::from(!side));
    }

    /// Both together.
    #[must_use]
    pub const fn union(self, other: Sides) -> Sides {
        Sides(self.0 | other.0)
    }

    /// Their names by the ids of a role.
    pub fn names(self, role: Role) -> impl Iterator<Item = String> {
        let all = ids(role).iter().flat_map(|id| sides(id));
        all.enumerate().filter(move |(place, _)| self.0 >> place & 1 == 1).map(|(_, name)| name)
    }
}

/// The timer of a waiting state; `None` where it is not one.
pub fn timer(role: Role, state: State) -> Option<u8> {
    match (role, state.0) {
        (Role::Device, 24) => Some(OfDevice::Timer24.into()),
        (Role::Device, 26) => Some(OfDevice::Timer26.into()),
        (Role::Master, 5) => Some(OfMaster::Timer5.into()),
        (Role::Master, 7) => Some(OfMaster::Timer7.into()),
        _ => None,
    }
}

/// Whether the parts of the signature check are in order: the signature itself, then PortNum.
#[derive(Copy, Clone, Debug)]
pub struct Parts {
    /// The signature is right.
    pub signature: bool,
    /// PortNum is right.
    pub port_num: bool,
}

/// What the technology of an FS-Device shows or is asked.
#[derive(Copy, Clone, Debug)]
pub struct Technology {
    /// PDout_D and setSD_DC are seen.
    pub seen: bool,
    /// SDset_DS; `None` while it is not known which value the SCL has looked at.
    pub sdset_ds: Option<bool>,
}

/// An SPDU is taken by an FS-Device that waits as `before` says.
pub fn device(before: &Device, received: Received, parts: Parts, technology: Technology) -> Sides {
    use OfDevice::*;
    let mut sides = Sides::NONE;
    let first = before.state() == State(21);
    let fault = before.state() == State(26);
    let mcount = received.control.mcount;
    let (zero, next) = (mcount == 0, before.previous().is_some_and(|previous| mcount == succ(previous)));
    match before.state().0 {
        21 => sides.set(NotZero21, true),
        24 => [NotZero24, NotOld24].into_iter().for_each(|condition| sides.set(condition, true)),
        26 => [NotZero26, NotOld26].into_iter().for_each(|condition| sides.set(condition, true)),
        _ => return sides,
    }
    let Parts { signature, port_num } = parts;
    let counter = zero || next && !first;
    let valid = signature && port_num && counter;
    let cycles = before.get(Var::SdCycles);
    // With SD cycles left T29 follows whatever the checks say.
    if !fault || cycles == 0 {
        let [of_signature, of_port_num] = if fault { [Signature27, PortNum27] } else { [Signature22, PortNum22] };
        if port_num && counter {
            sides.set(of_signature, signature);
        }
        if signature && counter {
            sides.set(of_port_num, port_num);
        }
        if signature && port_num {
            let [of_zero, of_next] = if fault { [Zero27, Next27] } else { [Zero22, Next22] };
            match (first, zero, next) {
                (true, ..) => sides.set(First22, zero),
                (_, true, _) => sides.set(of_zero, true),
                (_, _, true) => sides.set(of_next, true),
                _ => [of_zero, of_next].into_iter().for_each(|condition| sides.set(condition, false)),
            }
        }
    }
    if fault {
        if cycles > 0 {
            sides.set(CommErr27, !valid);
        }
        if valid {
            sides.set(SdCycles27, cycles == 0);
        }
        if valid && cycles > 0 {
            sides.set(CommErrCount27, before.get(Var::CommErrCount) == 1);
            sides.set(TimeoutCount27, before.get(Var::TimeoutCount) == 1);
        }
    } else if valid {
        if !received.control.set_sd {
            sides.set(SdCycles22, cycles != 0);
        }
        if cycles == 0 && technology.seen {
            sides.set(SetSd22, received.control.set_sd);
        }
    }
    if let Some(sdset_ds) = technology.sdset_ds.filter(|_| valid && cycles == 0) {
        sides.set(SdsetDs23, sdset_ds);
    }
    sides
}

/// An SPDU is left alone by an FS-Device: one of all zero, or one with this counter.
pub fn left_alone_by_device(before: &Device, mcount: Option<u8>) -> Sides {
    use OfDevice::*;
    let mut sides = Sides::NONE;
    // Another guard would leave it alone too, or nothing would change: with a counter of 0 that is old.
    if before.is_old(0) && mcount.is_none_or(|mcount| mcount == 0) {
        return sides;
    }
    let condition = match (before.state().0, mcount) {
        (21, None) => NotZero21,
        (24, None) => NotZero24,
        (26, None) => NotZero26,
        (24, Some(_)) => NotOld24,
        (26, Some(_)) => NotOld26,
        _ => return sides,
    };
    sides.set(condition, false);
    sides
}

/// An answer is taken by an FS-Master that waits as `before` says, with the inputs it looks at; `app`: PDin_M is seen.
pub fn master(before: &Master, answer: Answer, parts: Parts, app: bool) -> Sides {
    use OfMaster::*;
    let mut sides = Sides::NONE;
    let again = before.state() == State(7);
    match before.state().0 {
        2 => sides.set(NotZero2, true),
        5 => [NotZero5, NotOld5].into_iter().for_each(|condition| sides.set(condition, true)),
        7 => [NotZero7, Expected7].into_iter().for_each(|condition| sides.set(condition, true)),
        _ => return sides,
    }
    let status = answer.status;
    let mirror = status.dcount_i == inv3(before.get(Var::Mcount));
    let checks = [parts.signature, parts.port_num, mirror, !status.d_timeout, !status.d_comm_err];
    let asked = if again {
        [Signature8, PortNum8, Mirror8, Dtimeout8, DcommErr8]
    } else {
        [Signature3, PortNum3, Mirror3, Dtimeout3, DcommErr3]
    };
    for (place, (check, condition)) in checks.into_iter().zip(asked).enumerate() {
        let others = checks.iter().enumerate().all(|(other, right)| other == place || *right);
        if others {
            // The bits of the status octet are faults when they are set.
            sides.set(condition, if place < 3 { check } else { !check });
        }
    }
    if !checks.into_iter().all(|right| right) {
        return sides;
    }
    sides.set(if again { Mtimeout8 } else { Mtimeout3 }, false);
    let is = |var| before.get(var) == 1;
    let (ack, armed) = (is(Var::ChFAckC), is(Var::ChFAckCe));
    if again {
        if armed {
            sides.set(ChFAckC8, ack);
        } else {
            sides.set(Arm8, !ack);
        }
        if ack {
            sides.set(ChFAckCe8, armed);
        }
    }
    if !again || ack && armed {
        let [of_sdset, of_set_sd] = if again { [Sdset8, SetSdC8] } else { [Sdset3, SetSdC3] };
        sides.set(of_set_sd, is(Var::SetSdC));
        if app && !is(Var::SetSdC) {
            sides.set(of_sdset, status.sd_set);
        }
    }
    sides
}

/// An answer is left alone by an FS-Master: one of all zero, or one with another counter than it waits for.
pub fn left_alone_by_master(before: &Master, zero: bool) -> Sides {
    use OfMaster::*;
    let mut sides = Sides::NONE;
    let condition = match (before.state().0, zero) {
        // Another guard would leave it alone too.
        (5 | 7, true) if !before.takes(0) => return sides,
        (2, true) => NotZero2,
        (5, true) => NotZero5,
        (7, true) => NotZero7,
        (5, false) => NotOld5,
        (7, false) => Expected7,
        _ => return sides,
    };
    sides.set(condition, false);
    sides
}
