//! A way through the composition as a sequence chart: one line per exchange.

use crate::exchange::{Fate, Joint, Step, World, image};
use crate::learned::{Device, Master};
use crate::model::Timing;
use crate::reading::Machine;
use fsct_protocol::scl::{Path, State, Var};
use fsct_protocol::spdu::{Control, Status};
use std::fmt::Write as _;

/// One exchange: what crossed, what became of it, and both machines behind it.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Turn {
    /// Control&MCnt of the SPDU that the FS-Master presents.
    pub control: Control,
    /// Whether that SPDU carries process data.
    pub pdout: bool,
    /// What becomes of it.
    pub there: Fate,
    /// Status&DCnt of the answer that the FS-Device presents; `None`: all zero.
    pub status: Option<Status>,
    /// What becomes of it.
    pub back: Fate,
    /// Counter bits of the stored images that arrive in place of SPDU and answer, where that is what becomes of them.
    pub stored: [Option<u8>; 2],
    /// FS-Device before the exchange; in state 20 it has no power.
    pub device_before: Device,
    /// FS-Device behind it.
    pub device: Device,
    /// Transitions of the FS-Device.
    pub device_path: Path,
    /// SDset_DS.
    pub sdset_ds: bool,
    /// FS-Master before the exchange.
    pub master_before: Master,
    /// FS-Master behind it.
    pub master: Master,
    /// Transitions of the FS-Master.
    pub master_path: Path,
    /// ChFAck_C.
    pub ch_f_ack_c: bool,
    /// setSD_C.
    pub set_sd_c: bool,
}

impl Turn {
    /// The FS-Device has power behind the exchange.
    pub fn powered(&self) -> bool {
        self.device.state() != State(20)
    }

    /// DTimer has expired.
    pub fn device_expired(&self) -> bool {
        self.device_path.iter().any(|t| matches!(t.0, 30 | 31))
    }

    /// MTimer has expired.
    pub fn master_expired(&self) -> bool {
        self.master_path.iter().any(|t| matches!(t.0, 8 | 14))
    }

    /// Process data is in use at the FS-Master.
    pub fn pdin(&self) -> bool {
        self.master.get(Var::In) == 1
    }
}

/// What one exchange shows.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Line {
    /// The same as values.
    pub turn: Turn,
    /// The SPDU of the FS-Master and what became of it: MCount, setSD, ChFAckReq, process data.
    pub spdu: String,
    /// Transitions and state of the FS-Device, its inputs, and what it gives out.
    pub device: String,
    /// The answer and what became of it: DCount_i, SDset, DCommErr, DTimeout.
    pub answer: String,
    /// Transitions and state of the FS-Master, its inputs, and what it gives out.
    pub master: String,
}

/// The lines of a way from the start.
pub(crate) fn lines(world: &mut World, steps: &[Step]) -> Vec<Line> {
    let mut from: Joint = world.start();
    steps
        .iter()
        .map(|step| {
            let line = Line::from(turn(world, from, step));
            from = step.to;
            line
        })
        .collect()
}

fn turn(world: &World, from: Joint, step: &Step) -> Turn {
    let (master_before, device_before) = (world.master(from.master), world.device(from.device));
    let (master, device) = (world.master(step.to.master), world.device(step.to.device));
    let answering = if world.model().timing == Timing::Pipelined { &device_before } else { &device };
    Turn {
        control: master_before.control(),
        pdout: master_before.uses_pdout(),
        there: step.device.fate,
        status: image(answering),
        back: step.master.fate,
        stored: [(Machine::Device, step.device.fate), (Machine::Master, step.master.fate)].map(
            |(to, fate)| match fate {
                Fate::Stored(ago) => world.stored(from, to, ago),
                _ => None,
            },
        ),
        device_before,
        device,
        device_path: step.device.path,
        sdset_ds: step.device.pressed,
        master_before,
        master,
        master_path: step.master.path,
        ch_f_ack_c: step.master.pressed,
        set_sd_c: step.master.demand,
    }
}

impl Line {
    /// The SPDU as it was sent: MCount, setSD, ChFAckReq, process data.
    pub fn sent(&self) -> String {
        spdu(&self.turn)
    }

    /// The answer as it was sent: DCount_i, SDset, DCommErr, DTimeout; `-` is all zero.
    pub fn answered(&self) -> String {
        self.turn.status.map_or("-".to_owned(), answer)
    }
}

impl From<Turn> for Line {
    fn from(turn: Turn) -> Line {
        Line {
            turn,
            spdu: fated(&spdu(&turn), turn.there, turn.stored[0]),
            device: device_side(&turn),
            answer: fated(&turn.status.map_or("-".to_owned(), answer), turn.back, turn.stored[1]),
            master: master_side(&turn),
        }
    }
}

/// Lines as text, in columns, numbered from 1. The last `for_ever` of them repeat.
pub fn text(lines: &[Line], for_ever: Option<usize>) -> String {
    let heads = ["SPDU", "FS-Device", "answer", "FS-Master"];
    let columns = |line: &Line| [line.spdu.clone(), line.device.clone(), line.answer.clone(), line.master.clone()];
    let rows: Vec<[String; 4]> = lines.iter().map(columns).collect();
    let width = |column: usize| {
        let longest = rows.iter().filter_map(|row| row.get(column)).map(String::len).max();
        longest.unwrap_or_default().max(heads.get(column).map_or(0, |head| head.len()))
    };
    let widths = [0, 1, 2, 3].map(width);
    let mut out = String::new();
    let mut put = |x: &str, row: [&str; 4]| {
        let mut line = format!("{x:>4}");
        for (text, width) in row.iter().zip(widths) {
            let _ = write!(line, "  {text:<width$}");
        }
        out += line.trim_end();
        out.push('\n');
    };
    put("x", heads);
    let repeated = lines.len() - for_ever.unwrap_or_default().min(lines.len());
    for (at, row) in rows.iter().enumerate() {
        if for_ever.is_some() && at == repeated {
            put("", ["for ever:", "", "", ""]);
        }
        let [spdu, device, answer, master] = row;
        put(&(at + 1).to_string(), [spdu, device, answer, master]);
    }
    out
}

fn spdu(turn: &Turn) -> String {
    let Control { mcount, set_sd, ch_f_ack_req } = turn.control;
    let data = if turn.pdout { "PDout" } else { "SDout" };
    words([
        Some(mcount.to_string().as_str()),
        set_sd.then_some("setSD"),
        ch_f_ack_req.then_some("ChFAckReq"),
        Some(data),
    ])
}

fn answer(status: Status) -> String {
    let Status { dcount_i, sd_set, d_comm_err, d_timeout } = status;
    words([
        Some(dcount_i.to_string().as_str()),
        sd_set.then_some("SDset"),
        d_comm_err.then_some("DCommErr"),
        d_timeout.then_some("DTimeout"),
    ])
}

/// `stored` is the counter of the image that arrives in place of this one.
fn fated(image: &str, fate: Fate, stored: Option<u8>) -> String {
    match fate {
        Fate::Delivered => image.to_owned(),
        Fate::Lost => format!("{image} LOST"),
        Fate::Bad(counter) => format!("{image} BAD({counter})"),
        Fate::Stored(ago) => format!("{image} STORED({} of {ago} before)", stored.unwrap_or_default()),
    }
}

fn way(path: &Path) -> String {
    path.iter().map(|t| format!("{t} ")).collect()
}

fn device_side(turn: &Turn) -> String {
    if !turn.powered() {
        return if turn.device_before.state() == State(20) { "off".to_owned() } else { "power off".to_owned() };
    }
    let state = format!("{}{}", way(&turn.device_path), turn.device.place());
    let live = turn.device.uses_pdout().then_some("PDout_D");
    words([Some(state.as_str()), turn.sdset_ds.then_some("SDset_DS=1"), live, None])
}

fn master_side(turn: &Turn) -> String {
    let state = format!("{}{}", way(&turn.master_path), turn.master.place());
    // A product's T10 is not seen.
    let acknowledged = turn.master_path.iter().any(|t| matches!(t.0, 10 | 11 | 13)).then_some(if turn.ch_f_ack_c {
        "ChFAck_C=1"
    } else {
        "ChFAck_C=0"
    });
    let live = turn.pdin().then_some("PDin_M");
    words([Some(state.as_str()), acknowledged, turn.set_sd_c.then_some("setSD_C=1"), live])
}

fn words(words: [Option<&str>; 4]) -> String {
    words.into_iter().flatten().collect::<Vec<_>>().join(" ")
}
