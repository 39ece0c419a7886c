//! A chart as the steps of a case for an FS-Device: SPDUs, expiries, power, SDset_DS.

use super::told;
use crate::tours::device::expected;
use crate::tours::emit::{Told, wait};
use fsct_proof::{Fate, Turn};
use fsct_protocol::scl::{State, Var};
use fsct_protocol::spdu::{Control, inv3};

/// What happens to the FS-Device, and what it has to do.
pub fn steps(turns: &[Turn]) -> Vec<Told> {
    let mut steps: Vec<Told> = Vec::new();
    // What arrived last, and how: the same once more is nothing new.
    let mut last = None;
    let (mut expiries, mut sdset_ds, mut powered) = (0, false, true);
    for turn in turns {
        let was_powered = turn.device_before.state() != State(20);
        if !turn.powered() {
            if was_powered {
                steps.push(told("power: \"off\"".to_owned(), Vec::new()));
                (last, sdset_ds, powered) = (None, false, false);
            }
            continue;
        }
        if !was_powered {
            if !powered {
                let before = vec!["power: \"on\"".to_owned()];
                let expect = vec!["app.PDout_D: safe".to_owned()];
                let path = turn.device_path;
                steps.push(Told { before, action: "parameterize: {}".to_owned(), expect, path, error: false });
                powered = true;
            }
            continue;
        }
        if turn.device_expired() {
            expiries += 1;
            let expect = asked(turn);
            steps.push(Told { path: turn.device_path, ..told(wait(expiries, "lost"), expect) });
            continue;
        }
        let arrived = match turn.there {
            Fate::Delivered => (turn.control, true),
            Fate::Bad(mcount) => (Control { mcount, ..turn.control }, false),
            Fate::Lost | Fate::Stored(_) => continue,
        };
        if turn.device_path.is_empty() {
            if last != Some(arrived) {
                let expect = vec!["DCount_i: unchanged".to_owned(), "app.PDout_D: unchanged".to_owned()];
                steps.push(told(exchange(turn, arrived, ", repeat: 1"), expect));
                last = Some(arrived);
            }
            continue;
        }
        (last, expiries) = (Some(arrived), 0);
        let mut before = Vec::new();
        if sdset_ds != turn.sdset_ds {
            sdset_ds = turn.sdset_ds;
            before.push(format!("app: {{SDset_DS: {}}}", u8::from(sdset_ds)));
        }
        // Where the answer before has this counter already, a DUT that answers late cannot be told from one that has answered.
        let told_apart =
            turn.device_before.state() == State(21) || turn.device_before.status().dcount_i != inv3(arrived.0.mcount);
        let expect = match told_apart {
            true => asked(turn),
            false => Vec::new(),
        };
        let error = turn.device.get(Var::CommErr) == 1;
        steps.push(Told { before, action: exchange(turn, arrived, ""), expect, path: turn.device_path, error });
    }
    if !powered {
        let before = vec!["power: \"on\"".to_owned()];
        steps.push(Told { before, ..told("parameterize: {}".to_owned(), Vec::new()) });
    }
    steps
}

/// What the tables ask of the FS-Device; a case is made of their machines alone.
fn asked(turn: &Turn) -> Vec<String> {
    let rows = turn.device_before.rows().zip(turn.device.rows());
    rows.map_or_else(Vec::new, |(before, device)| expected(before, device, &turn.device_path, false))
}

fn exchange(turn: &Turn, (control, intact): (Control, bool), more: &str) -> String {
    let mut fields = format!("MCount: {}", control.mcount);
    if control.set_sd {
        fields += ", setSD: 1";
    }
    if control.ch_f_ack_req {
        fields += ", ChFAckReq: 1";
    }
    if !turn.pdout {
        fields += ", PDout: safe";
    }
    if !intact {
        fields += ", corrupt: signature";
    }
    format!("exchange: {{{fields}{more}}}")
}
