//! A chart as it is drawn.

use super::Chart;
use fsct_proof::{Fate, Line, Turn, Verdict};
use fsct_protocol::scl::{Path, State};
use fsct_reports::{Beside, Ladder, Rung, Way};

/// The chart with everything in it, what repeats included.
pub fn ladder(chart: &Chart<'_>, explored: &str) -> Ladder {
    let (lines, for_ever) = match &chart.outcome.verdict {
        Verdict::LockUp(lines, repeats) => (lines.as_slice(), *repeats),
        _ => (chart.lines, 0),
    };
    let property = chart.outcome.property;
    Ladder {
        title: format!("{}: {}", property.name, property.about),
        about: format!("{}. {explored}", chart.title()),
        rungs: lines.iter().map(rung).collect(),
        for_ever,
    }
}

fn rung(line: &Line) -> Rung {
    let turn = &line.turn;
    let back = match (turn.status, turn.back) {
        (None, Fate::Delivered | Fate::Lost) => Way::Nothing,
        (_, fate) => way(fate, turn.stored[1]),
    };
    // Nobody is there to take it.
    let there =
        if turn.powered() || turn.there != Fate::Delivered { way(turn.there, turn.stored[0]) } else { Way::Lost };
    Rung { spdu: line.sent(), there, answer: line.answered(), back, master: master(turn), device: device(turn) }
}

fn way(fate: Fate, stored: Option<u8>) -> Way {
    match fate {
        Fate::Delivered => Way::Arrives,
        Fate::Lost => Way::Lost,
        Fate::Bad(counter) => Way::Bad(counter),
        Fate::Stored(_) => Way::Stored(stored.unwrap_or_default()),
    }
}

fn transitions(path: &Path) -> String {
    path.iter().map(|t| t.to_string()).collect::<Vec<_>>().join(" ")
}

fn master(turn: &Turn) -> Beside {
    let asked = turn.master_path.iter().any(|t| t.0 == 10);
    let mut state = turn.master.state().to_string();
    if asked {
        state += if turn.ch_f_ack_c { " ChFAck_C=1" } else { " ChFAck_C=0" };
    }
    if turn.set_sd_c {
        state += " setSD_C=1";
    }
    Beside { transitions: transitions(&turn.master_path), state, live: turn.pdin().then_some("PDin_M"), off: false }
}

fn device(turn: &Turn) -> Beside {
    let off = !turn.powered();
    let mut state = match (off, turn.device_before.state() == State(20)) {
        (true, true) => "off".to_owned(),
        (true, false) => "power off".to_owned(),
        _ => turn.device.state().to_string(),
    };
    if turn.sdset_ds {
        state += " SDset_DS=1";
    }
    let live = turn.device.uses_pdout().then_some("PDout_D");
    Beside { transitions: transitions(&turn.device_path), state, live, off }
}
