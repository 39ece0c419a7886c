//! A chart as the steps of a case for an FS-Master: answers, expiries, the inputs of the operator.

use super::told;
use crate::tours::emit::{Told, wait};
use crate::tours::master::expected;
use fsct_proof::{Fate, Turn};
use fsct_protocol::scl::Var;
use fsct_protocol::spdu::Status;

/// What happens to the FS-Master, and what it has to do.
pub fn steps(turns: &[Turn]) -> Vec<Told> {
    let mut steps = vec![told("app: {PDout_M: pattern}".to_owned(), Vec::new())];
    // What arrived last, and how: the same once more is nothing new.
    let mut last = None;
    let mut expiries = 0;
    let (mut acked, mut stopped) = (false, false);
    for turn in turns {
        if turn.master_expired() {
            // An SPDU that looks like the one before does not show when it was made: the wait counts from the one seen first.
            expiries = if turn.master_before.control() == turn.master.control() { expiries + 1 } else { 1 };
            let expect = asked(turn);
            steps.push(Told { path: turn.master_path, ..told(wait(expiries, "lost"), expect) });
            continue;
        }
        let arrived = match (turn.back, turn.status) {
            (Fate::Delivered, Some(status)) => (status, true),
            (Fate::Bad(dcount_i), _) => (Status { dcount_i, ..Status::default() }, false),
            (Fate::Delivered, None) | (Fate::Lost | Fate::Stored(_), _) => continue,
        };
        if turn.master_path.is_empty() {
            if last != Some(arrived) {
                let expect = vec!["MCount: unchanged".to_owned(), "app.PDin_M: unchanged".to_owned()];
                steps.push(told(exchange(arrived, ", repeat: 1"), expect));
                last = Some(arrived);
            }
            continue;
        }
        (last, expiries) = (Some(arrived), 0);
        let mut inputs = Vec::new();
        if acked != turn.ch_f_ack_c {
            acked = turn.ch_f_ack_c;
            inputs.push(format!("ChFAck_C: {}", u8::from(acked)));
        }
        if stopped != turn.set_sd_c {
            stopped = turn.set_sd_c;
            inputs.push(format!("setSD_C: {}", u8::from(stopped)));
        }
        let before = if inputs.is_empty() { Vec::new() } else { vec![format!("app: {{{}}}", inputs.join(", "))] };
        let expect = asked(turn);
        let error = turn.master.get(Var::Faults) == 1;
        steps.push(Told { before, action: exchange(arrived, ""), expect, path: turn.master_path, error });
    }
    if acked || stopped {
        steps.push(told("app: {ChFAck_C: 0, setSD_C: 0}".to_owned(), Vec::new()));
    }
    steps
}

/// What the tables ask of the FS-Master; a case is made of their machines alone.
fn asked(turn: &Turn) -> Vec<String> {
    turn.master.rows().map_or_else(Vec::new, |master| expected(master, &turn.master_path, false))
}

fn exchange((status, intact): (Status, bool), more: &str) -> String {
    let mut fields = format!("DCount_i: {}", status.dcount_i);
    for (name, set) in [("SDset", status.sd_set), ("DCommErr", status.d_comm_err), ("DTimeout", status.d_timeout)] {
        if set {
            fields += &format!(", {name}: 1");
        }
    }
    if !intact {
        fields += ", corrupt: signature";
    }
    format!("exchange: {{{fields}{more}}}")
}
