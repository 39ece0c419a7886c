//! A way through the composition as a sequence chart: one line per exchange.

use crate::exchange::{Fate, Joint, Leg, Step, World, image};
use crate::learned::{Device, Master};
use crate::model::Timing;
use fsct_protocol::scl::{State, Var};
use fsct_protocol::spdu::{Control, Status};
use std::fmt::Write as _;

/// What one exchange shows.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Line {
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
    let timing = world.model().timing;
    steps
        .iter()
        .map(|step| {
            let (sender, before) = (world.master(from.master), world.device(from.device));
            let (master, device) = (world.master(step.to.master), world.device(step.to.device));
            let answering = if timing == Timing::Pipelined { before } else { device };
            let line = Line {
                spdu: fated(&spdu(sender), step.device.fate),
                device: device_side(device, &step.device, before),
                answer: fated(&image(answering).map_or("-".to_owned(), answer), step.master.fate),
                master: master_side(master, &step.master),
            };
            from = step.to;
            line
        })
        .collect()
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

fn spdu(master: &Master) -> String {
    let Control { mcount, set_sd, ch_f_ack_req } = master.control();
    let data = if master.uses_pdout() { "PDout" } else { "SDout" };
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

fn fated(image: &str, fate: Fate) -> String {
    match fate {
        Fate::Delivered => image.to_owned(),
        Fate::Lost => format!("{image} LOST"),
        Fate::Bad(counter) => format!("{image} BAD({counter})"),
    }
}

fn way(leg: &Leg) -> String {
    leg.path.iter().map(|t| format!("{t} ")).collect()
}

fn device_side(device: &Device, leg: &Leg, before: &Device) -> String {
    if device.state() == State(20) {
        return if before.state() == State(20) { "off".to_owned() } else { "power off".to_owned() };
    }
    let state = format!("{}{}", way(leg), device.place());
    let live = device.uses_pdout().then_some("PDout_D");
    words([Some(state.as_str()), leg.pressed.then_some("SDset_DS=1"), live, None])
}

fn master_side(master: &Master, leg: &Leg) -> String {
    let state = format!("{}{}", way(leg), master.place());
    let acknowledged = leg.path.iter().any(|t| matches!(t.0, 10 | 11 | 13)).then_some(if leg.pressed {
        "ChFAck_C=1"
    } else {
        "ChFAck_C=0"
    });
    let live = (master.get(Var::In) == 1).then_some("PDin_M");
    words([Some(state.as_str()), acknowledged, leg.demand.then_some("setSD_C=1"), live])
}

fn words(words: [Option<&str>; 4]) -> String {
    words.into_iter().flatten().collect::<Vec<_>>().join(" ")
}
