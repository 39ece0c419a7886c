//! A mismatch of an FS-Device in words.

use super::config::Config;
use super::device::Answer;
use super::explain::{Difference, Differences, bit, data, hex, transition};
use super::setup::{App, Setup};
use fsct_protocol::scl::{Device, T};
use fsct_protocol::spdu::View;

/// Clause and table of the machine.
pub const TABLE: &str = "11.5.3 Table 40";

/// A difference in DTimeout alone means that the watchdog was late, early or not there.
pub fn timing(config: &Config<Device, Answer>, snap: &Answer, differences: &[Difference]) -> Option<(String, String)> {
    let about = |field: &str| differences.iter().any(|difference| difference.field == field);
    let moved = about("DCount_i") || about("DCommErr");
    let expired = snap.path.iter().any(|t| matches!(t.0, 30 | 31));
    let expiry = if config.machine.state().0 == 26 { "T30" } else { "T31" };
    let early = about("DTimeout") && !expired && !moved && config.timer.is_some() && about("SDset");
    let late = about("DTimeout") && expired && !moved;
    match (early, late) {
        (true, _) => Some(("watchdog/early".into(), format!("11.5.5, {TABLE} {expiry} (FSP_Watchdog)"))),
        (_, true) => {
            let last = snap.path.iter().find(|t| matches!(t.0, 30 | 31)).unwrap_or(T(31));
            Some(("watchdog/late".into(), format!("11.5.5, {TABLE} {last} (FSP_Watchdog)")))
        }
        _ => None,
    }
}

/// Image and services against an answer; `pdin` are the values of PDin it may carry, the likeliest first.
pub fn differences(
    setup: &Setup,
    snap: &Answer,
    image: Option<View<'_>>,
    app: &App,
    pdin: &[String],
) -> Vec<Difference> {
    let mut found = Differences::default();
    let row = format!("{TABLE}{}", transition(snap.path.deciding()));
    match (snap.status, image) {
        (None, None) => {}
        (None, Some(view)) => {
            found.differ("image", "11.5.4.3, 11.5.3", "all zero", format!("with DCount_i {}", view.counter()));
        }
        (Some(status), None) => {
            found.differ("image", &row, format!("with DCount_i {}", status.dcount_i), "all zero or none");
        }
        (Some(expected), Some(view)) => {
            let seen = view.status();
            found.differ("DCount_i", &format!("11.4.6 Table 33, {row}"), expected.dcount_i, seen.dcount_i);
            if snap.free.d_comm_err == 0 {
                found.differ("DCommErr", &row, bit(expected.d_comm_err), bit(seen.d_comm_err));
            }
            if snap.free.d_timeout == 0 {
                found.differ("DTimeout", &row, bit(expected.d_timeout), bit(seen.d_timeout));
            }
            if snap.free.sd_set == 0 {
                found.differ("SDset", &row, bit(expected.sd_set), bit(seen.sd_set));
            }
            if let Some(first) = pdin.first()
                && !pdin.contains(&hex(view.pd()))
            {
                found.differ("PDin", &format!("11.3.3 Table 29, {TABLE}"), first, hex(view.pd()));
            }
        }
    }
    if setup.app {
        let clause = format!("11.3.3 Table 29, {row}");
        if let Some(pdout) = &app.pdout_d {
            found.differ("PDout_D", &clause, data(snap.pdout.octets()), data(pdout.as_slice()));
        }
        if let (Some(expected), Some(seen)) = (snap.set_sd_dc, app.set_sd_dc) {
            found.differ("setSD_DC", &clause, bit(expected), bit(seen));
        }
        if let (Some(expected), Some(seen)) = (snap.ch_f_ack_req_dc, app.ch_f_ack_req_dc) {
            found.differ("ChFAckReq_DC", &clause, bit(expected), bit(seen));
        }
    }
    found.0
}
