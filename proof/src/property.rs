//! What has to hold, each property once, with the clause it comes from.
//!
//! A property watches the exchanges. Where the machines alone do not tell, it keeps a monitor: a small number that is part of the
//! explored state. It measures something in each exchange; it holds while the measure stays within its bound.

use crate::exchange::{Around, Joint, Step, taken_from_store};
use crate::learned::{Device, Master};
use crate::model::{Model, Timers, Timing};
use crate::reading::Machine;
use fsct_protocol::scl::{Path, State, Var};

/// One exchange as a property sees it.
pub struct Seen<'a> {
    /// What is explored.
    pub model: &'a Model,
    /// Timers before the exchange.
    pub from: Joint,
    /// The FS-Master had left state 2 before the exchange.
    pub started: bool,
    /// What happened.
    pub step: &'a Step,
    /// FS-Master behind the exchange.
    pub master: Master,
    /// FS-Device behind the exchange; in state 20 it has no power.
    pub device: Device,
}

impl Seen<'_> {
    fn device_took(&self, transitions: &[u8]) -> bool {
        took(&self.step.device.path, transitions)
    }

    fn master_took(&self, transitions: &[u8]) -> bool {
        took(&self.step.master.path, transitions)
    }

    /// PDout_D is live.
    fn pdout(&self) -> bool {
        self.device.uses_pdout()
    }

    /// PDin_M is live.
    fn pdin(&self) -> bool {
        self.master.get(Var::In) == 1
    }

    fn powered(&self) -> bool {
        self.device.state() != State(20)
    }

    /// T29 loads SDcycles in the error cycle alone.
    fn comm_err(&self) -> bool {
        self.device_took(&[25]) || self.device_took(&[29]) && self.device.get(Var::SdCycles) == 3
    }

    fn device_timeout(&self) -> bool {
        self.device_took(&[30, 31])
    }

    fn device_fault(&self) -> bool {
        self.comm_err() || self.device_timeout()
    }

    fn master_fault(&self) -> bool {
        self.master_took(&[7, 8, 12, 14])
    }

    /// An SPDU has led to a new answer.
    fn answered(&self) -> bool {
        self.device_took(&[22, 25, 28, 29])
    }

    /// T13 has seen ChFAck_C at 0.
    fn armed(&self) -> bool {
        self.master_took(&[13]) && self.master.get(Var::ChFAckCe) == 1
    }

    /// Exchanges since the SPDU was built that has reached the FS-Device.
    fn spdu_age(&self) -> u8 {
        self.from.mtimer + 1
    }

    /// Exchanges since the answer was built that has reached the FS-Master.
    fn answer_age(&self) -> u8 {
        match self.model.timing {
            Timing::Pipelined => self.from.dtimer + 1,
            Timing::Immediate => self.step.to.dtimer + 1,
        }
    }

    /// Whether an answer was counted as good that was built before the SPDU it seems to mirror was sent.
    fn outdated(&self) -> bool {
        // An immediate answer to an SPDU that has just arrived counts one exchange less than the SPDU itself.
        let outdated = match self.model.timing {
            Timing::Pipelined => self.answer_age() >= self.spdu_age(),
            Timing::Immediate => self.answer_age() > self.spdu_age(),
        };
        // T3 starts from state 2, where the FS-Master has sent no other SPDU yet.
        outdated && !self.master_took(&[3]) && self.master_took(&[4, 11, 13])
    }
}

fn took(path: &Path, transitions: &[u8]) -> bool {
    path.iter().any(|t| transitions.contains(&t.0))
}

/// What a property makes of an exchange.
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq)]
pub struct Watched {
    /// The monitor behind it.
    pub monitor: u16,
    /// Another monitor it may go on with: the inputs decide.
    pub fork: Option<u16>,
    /// What was measured.
    pub measure: u8,
}

/// Says what a property makes of an exchange, given its monitor before.
pub type Watch = fn(&Seen, u16) -> Watched;

/// A property of the composition.
#[derive(Debug)]
pub struct Property {
    /// Its name, `P1-taken`.
    pub name: &'static str,
    /// What it says, in one line.
    pub about: &'static str,
    /// Where it comes from.
    pub clause: &'static str,
    /// Whose machine decides it.
    pub machines: &'static [Machine],
    /// The measure, with its unit.
    pub measures: &'static str,
    /// The largest measure allowed.
    pub bound: fn(&Model) -> u8,
    /// Why the tables themselves go beyond the bound, in both editions and by default; such a property fails nobody.
    pub tables: Option<&'static str>,
    /// How it watches; recovery (P5) does not watch, it looks ahead.
    pub watch: Option<Watch>,
}

impl Property {
    /// What surrounds the machines with this monitor: a demand that P8 waits on is held.
    pub(crate) fn around(&self, monitor: u16) -> Around {
        if self.name == "P8" && monitor != 0 { Around::Demand } else { Around::Free }
    }

    /// Why it is not asked of a model; `None`: it is.
    pub fn not_asked(&self, model: &Model) -> Option<&'static str> {
        let among = |names: &[&str]| names.contains(&self.name);
        if model.timers == Timers::Any && among(&["P1-taken", "P1-live", "P4", "P5", "P7-live", "P7-good", "P8"]) {
            return Some("it counts exchanges, and timers that may expire in any do not");
        }
        if model.stores() && among(&["P1-taken", "P1-live", "P7-live", "P7-good"]) {
            return Some("the age of a stored image is not followed");
        }
        (among(&["P7-order"]) && model.storing == 0)
            .then_some("without stored SPDUs (--storing) there is no other order")
    }
}

/// Every property, in order.
pub static PROPERTIES: [Property; 15] = [
    Property {
        name: "P1-taken",
        about: "process data put to use comes from an SPDU younger than one watchdog",
        clause: "11.5.5, Table 27 (unacceptable delay)",
        machines: &Machine::ALL,
        measures: "exchanges since it was built",
        bound: |model| model.watchdog - u8::from(model.timing == Timing::Pipelined),
        tables: None,
        watch: Some(age_taken),
    },
    Property {
        name: "P1-live",
        about: "process data in use is younger than two watchdogs",
        clause: "11.5.5",
        machines: &Machine::ALL,
        measures: "exchanges since its SPDU was built",
        bound: two_watchdogs,
        tables: None,
        watch: Some(age_live),
    },
    Property {
        name: "P2",
        about: "behind a fault the FS-Master sends and gives out SD until it has seen ChFAck_C at 0 and then at 1",
        clause: "11.5.2, Table 38 (T11, T13)",
        machines: &[Machine::Master],
        measures: "early restarts",
        bound: none,
        tables: None,
        watch: Some(restart_of_master),
    },
    Property {
        name: "P2d",
        about: "behind a fault or power cycle of the FS-Device its PDout_D is SD until a later acknowledgment",
        clause: "11.5.2, 11.5.3",
        machines: &[Machine::Device],
        measures: "early restarts",
        bound: none,
        tables: None,
        watch: Some(restart_of_device),
    },
    Property {
        name: "P3",
        about: "behind start and fault the FS-Device answers three times with SDset and SDout before PDout_D is live",
        clause: "11.5.3, Table 40 (SDcycles)",
        machines: &[Machine::Device],
        measures: "answers short of three",
        bound: none,
        tables: None,
        watch: Some(cycles_of_device),
    },
    Property {
        name: "P3-master",
        about: "behind a fault the FS-Master sends three SPDUs with SDout",
        clause: "11.4, Table 30",
        machines: &[Machine::Master],
        measures: "SPDUs short of three",
        bound: none,
        tables: Some(
            "T11 counts no cycles: two SPDUs with SDout are enough behind a fault of the FS-Master alone (A13)",
        ),
        watch: Some(cycles_of_master),
    },
    Property {
        name: "P4",
        about: "once a side has found a fault, the other side gives out SD within one watchdog",
        clause: "11.5.5, Tables 38 and 40",
        machines: &Machine::ALL,
        measures: "exchanges from detection to SD",
        bound: |model| model.watchdog,
        tables: None,
        watch: Some(reaction),
    },
    Property {
        name: "P5",
        about: "a healthy link and a willing operator bring back operation from everywhere",
        clause: "11.5.2, 11.5.3",
        machines: &Machine::ALL,
        measures: "exchanges to operation",
        bound: |_| u8::MAX,
        tables: None,
        watch: None,
    },
    Property {
        name: "P6-comm",
        about: "DCommErr is seen in one or two answers behind the latest error",
        clause: "11.5.3, Table 40 (CommErrCount)",
        machines: &[Machine::Device],
        measures: "answers with DCommErr",
        bound: |_| 2,
        tables: None,
        watch: Some(comm_err_visible),
    },
    Property {
        name: "P6-timeout",
        about: "DTimeout is seen in one or two answers behind the latest timeout",
        clause: "11.5.3, Table 40 (TimeoutCount)",
        machines: &[Machine::Device],
        measures: "answers with DTimeout",
        bound: |_| 2,
        tables: Some("T29 leaves DTimeout as it is in each cycle with an error (Table 40)"),
        watch: Some(timeout_visible),
    },
    Property {
        name: "P6-further",
        about: "an error or timeout is seen in at least one further answer",
        clause: "11.5.3, Table 40 (CommErrCount, TimeoutCount)",
        machines: &[Machine::Device],
        measures: "reports withheld",
        bound: none,
        tables: None,
        watch: Some(seen_further),
    },
    Property {
        name: "P7-live",
        about: "process data is never taken from an answer older than the SPDU it seems to mirror",
        clause: "11.5.2, Table 27 (incorrect sequence)",
        machines: &[Machine::Master],
        measures: "such answers in use",
        bound: none,
        tables: None,
        watch: Some(outdated_live),
    },
    Property {
        name: "P7-good",
        about: "an answer older than the SPDU it seems to mirror never counts as good",
        clause: "11.5.2, Table 27 (incorrect sequence)",
        machines: &[Machine::Master],
        measures: "such answers counted",
        bound: none,
        tables: Some(
            "the counter starts again with T8 and T14, so an answer from before may mirror the new SPDU (T10, Table 38)",
        ),
        watch: Some(outdated_good),
    },
    Property {
        name: "P7-order",
        about: "process data is never taken from an SPDU presented before another that the FS-Device has processed",
        clause: "11.5.3, Table 27 (incorrect sequence, unacceptable delay)",
        machines: &[Machine::Device],
        measures: "such SPDUs in use",
        bound: none,
        tables: None,
        watch: Some(disordered),
    },
    Property {
        name: "P8",
        about: "a demand brings PDout_D to SD within two watchdogs",
        clause: "11.5.5, H.4",
        machines: &Machine::ALL,
        measures: "exchanges with live PDout_D behind the demand",
        bound: two_watchdogs,
        tables: None,
        watch: Some(demand),
    },
];

fn none(_: &Model) -> u8 {
    0
}

fn two_watchdogs(model: &Model) -> u8 {
    2 * model.watchdog - if model.timing == Timing::Pipelined { 2 } else { 1 }
}

fn measure(measure: u8) -> Watched {
    Watched { measure, ..Watched::default() }
}

fn age_taken(seen: &Seen, _: u16) -> Watched {
    let spdu = if seen.pdout() && seen.device_took(&[22]) { seen.spdu_age() } else { 0 };
    let answer =
        if seen.pdin() && seen.master_took(&[4, 11]) && !seen.master_took(&[3]) { seen.answer_age() } else { 0 };
    measure(spdu.max(answer))
}

/// The monitor holds the ages of what both sides have in use, an octet each.
fn age_live(seen: &Seen, monitor: u16) -> Watched {
    let [pdout, pdin] = monitor.to_le_bytes();
    let age = |live: bool, new: bool, taken: u8, before: u8| match (live, new) {
        (false, _) => 0,
        (true, true) => taken,
        (true, false) => before + 1,
    };
    let pdout = age(seen.pdout(), seen.device_took(&[22]), seen.spdu_age(), pdout);
    let pdin = age(seen.pdin(), seen.master_took(&[4, 11]), seen.answer_age(), pdin);
    Watched { monitor: u16::from_le_bytes([pdout, pdin]), fork: None, measure: pdout.max(pdin) }
}

/// Monitors of P2 and P2d: no fault; a fault; a fault, and ChFAck_C has been seen at 0 since.
const CLEAN: u16 = 0;
const FAULT: u16 = 1;
const RELEASED: u16 = 2;

fn acknowledged(seen: &Seen, monitor: u16) -> u16 {
    match monitor {
        FAULT if seen.armed() => RELEASED,
        RELEASED if seen.master_took(&[11]) => CLEAN,
        other => other,
    }
}

fn restart_of_master(seen: &Seen, monitor: u16) -> Watched {
    let monitor = if seen.master_fault() { FAULT } else { acknowledged(seen, monitor) };
    let restarted = seen.pdin() || seen.master.get(Var::SetSd) == 0;
    Watched { monitor, fork: None, measure: (monitor != CLEAN && restarted).into() }
}

/// A power cycle while the FS-Master waits in state 2 takes earlier faults along: no data has been in use yet.
fn restart_of_device(seen: &Seen, monitor: u16) -> Watched {
    let monitor = match (seen.powered(), seen.started) {
        (false, false) => CLEAN,
        (false, true) => FAULT,
        (true, _) if seen.device_fault() => FAULT,
        (true, _) => acknowledged(seen, monitor),
    };
    Watched { monitor, fork: None, measure: (monitor != CLEAN && seen.pdout()).into() }
}

fn cycles_of_device(seen: &Seen, monitor: u16) -> Watched {
    let safe = seen.answered() && !seen.pdout() && seen.device.status().sd_set;
    let monitor = if seen.device_fault() || !seen.powered() { 0 } else { (monitor + u16::from(safe)).min(3) };
    Watched { monitor, fork: None, measure: if seen.pdout() { 3 - monitor as u8 } else { 0 } }
}

/// The monitor says how many SPDUs with setSD are short of three; the start asks for none.
fn cycles_of_master(seen: &Seen, monitor: u16) -> Watched {
    let short = if seen.master_fault() { 2 } else { monitor.saturating_sub(seen.master_took(&[13]).into()) };
    Watched { monitor: short, fork: None, measure: if seen.master.get(Var::SetSd) == 0 { short as u8 } else { 0 } }
}

/// The monitor holds, an octet for each side, how long it is live behind a fault that the other has found, plus one.
fn reaction(seen: &Seen, monitor: u16) -> Watched {
    let [pdin, pdout] = monitor.to_le_bytes();
    let late = |live: bool, found: bool, before: u8| match (live, found, before) {
        (false, ..) | (true, false, 0) => 0,
        (true, true, 0) => 1,
        (true, _, before) => before + 1,
    };
    let pdin = late(seen.pdin(), seen.device_fault(), pdin);
    let pdout = late(seen.pdout(), seen.master_fault(), pdout);
    Watched { monitor: u16::from_le_bytes([pdin, pdout]), fork: None, measure: pdin.max(pdout) }
}

/// The monitor counts the answers since the event that show the bit, until one does not.
fn visible(event: bool, shown: bool, seen: &Seen, monitor: u16) -> Watched {
    let monitor = match (event, monitor) {
        _ if !seen.powered() => 0,
        (true, _) => 1,
        (false, 0) => 0,
        (false, count) if seen.answered() => {
            if shown {
                (count + 1).min(3)
            } else {
                0
            }
        }
        (false, count) => count,
    };
    Watched { monitor, fork: None, measure: if event && !shown { u8::MAX } else { monitor as u8 } }
}

fn comm_err_visible(seen: &Seen, monitor: u16) -> Watched {
    visible(seen.comm_err(), seen.device.status().d_comm_err, seen, monitor)
}

fn timeout_visible(seen: &Seen, monitor: u16) -> Watched {
    visible(seen.device_timeout(), seen.device.status().d_timeout, seen, monitor)
}

/// The monitor says whether DCommErr (1) and DTimeout (2) have to be seen in the next answer.
fn seen_further(seen: &Seen, monitor: u16) -> Watched {
    let status = seen.device.status();
    let shown = u16::from(status.d_comm_err) | u16::from(status.d_timeout) << 1;
    let withheld = seen.answered() && monitor & !shown != 0;
    let left = if seen.answered() || !seen.powered() { 0 } else { monitor };
    let new = u16::from(seen.comm_err()) | u16::from(seen.device_timeout()) << 1;
    Watched { monitor: left | new, fork: None, measure: withheld.into() }
}

fn outdated_live(seen: &Seen, _: u16) -> Watched {
    measure((seen.outdated() && seen.pdin()).into())
}

fn outdated_good(seen: &Seen, _: u16) -> Watched {
    measure(seen.outdated().into())
}

/// The monitor says how many exchanges ago the SPDU was presented that the FS-Device has processed last; 0: none since power-on.
fn disordered(seen: &Seen, monitor: u16) -> Watched {
    let ago = taken_from_store(&seen.step.device).map_or(0, u16::from);
    let next = match (seen.powered(), seen.answered(), monitor) {
        (false, ..) | (true, false, 0) => 0,
        (true, true, _) => ago + 1,
        (true, false, monitor) => (monitor + 1).min(31),
    };
    let earlier = monitor != 0 && ago > monitor;
    Watched { monitor: next, fork: None, measure: (earlier && seen.device_took(&[22]) && seen.pdout()).into() }
}

/// The monitor counts the exchanges since setSD_C is held, from 1 on; 0: not yet.
fn demand(seen: &Seen, monitor: u16) -> Watched {
    if monitor == 0 {
        return Watched { monitor: 0, fork: Some(1), measure: 0 };
    }
    let next = (monitor + 1).min(u16::from(2 * seen.model.watchdog + 1));
    Watched { monitor: next, fork: None, measure: if seen.pdout() { monitor as u8 } else { 0 } }
}
