//! A mismatch of an FS-Master in words.

use super::config::{Config, Snapshot};
use super::explain::{Difference, Differences, bit, data, transition};
use super::master::{Port, Spdu};
use super::setup::{App, Setup};
use fsct_protocol::spdu::View;

/// Clause and table of the machine.
pub const TABLE: &str = "11.5.2 Table 38";

/// A change to MCount 0, or its absence, is a matter of MTimer when nothing else differs but what T8 and T14 do.
pub fn timing(
    exchange: u64,
    config: &Config<Port, Spdu>,
    snap: &Spdu,
    differences: &[Difference],
) -> Option<(String, String)> {
    let seen = differences.iter().find(|difference| difference.field == "MCount")?;
    let expired = snap.path.iter().any(|t| matches!(t.0, 8 | 14));
    let expiry = if config.machine.master.state().0 == 7 { "T14" } else { "T8" };
    // An SPDU made in this very exchange was made by an answer, not by the timer.
    let standing = snap.made() < exchange;
    let early = !expired && standing && config.timer.is_some() && seen.observed == "MCount 0";
    let before = |spdu: &Spdu| spdu.control.is_some_and(|c| format!("MCount {}", c.mcount) == seen.observed);
    let late = expired && seen.expected == "MCount 0" && config.snapshots().iter().any(before);
    match (early, late) {
        (true, _) => Some(("watchdog/early".into(), format!("11.5.5, {TABLE} {expiry} (FSP_Watchdog)"))),
        (_, true) => {
            let row = transition(snap.path.iter().find(|t| matches!(t.0, 8 | 14)));
            Some(("watchdog/late".into(), format!("11.5.5, 11.4.6, {TABLE}{row} (FSP_Watchdog)")))
        }
        _ => None,
    }
}

/// Image and services against an SPDU; `pdout` are the values of PDout it may carry, the likeliest first.
pub fn differences(
    setup: &Setup,
    snap: &Spdu,
    image: Option<View<'_>>,
    app: &App,
    pdout: &[String],
) -> Vec<Difference> {
    let mut found = Differences::default();
    let row = format!("{TABLE}{}", transition(snap.path.deciding()));
    match (snap.control, image) {
        (None, None) => {}
        (None, Some(view)) => {
            found.differ(
                "image",
                &format!("{TABLE} T1"),
                "all zero or none",
                format!("with MCount {}", view.counter()),
            );
        }
        (Some(control), None) => {
            found.differ("image", &row, format!("with MCount {}", control.mcount), "all zero or none");
        }
        (Some(expected), Some(view)) => {
            let seen = view.control();
            found.differ("MCount", &format!("11.4.6 Table 31, {row}"), expected.mcount, seen.mcount);
            found.differ("setSD", &row, bit(expected.set_sd), bit(seen.set_sd));
            found.differ("ChFAckReq", &format!("11.11.2, {row}"), bit(expected.ch_f_ack_req), bit(seen.ch_f_ack_req));
            let carried = data(view.pd());
            let free = carried == "safe" && snap.sdout != 0;
            if let Some(first) = pdout.first()
                && !pdout.contains(&carried)
                && !free
            {
                found.differ("PDout", &format!("11.3.2 Table 28, {row}"), first, carried);
            }
        }
    }
    if setup.app {
        let clause = format!("11.3.2 Table 28, {row}");
        if let Some(pdin) = &app.pdin_m {
            found.differ("PDin_M", &clause, data(snap.pdin.octets()), data(pdin.as_slice()));
        }
        if let Some(seen) = app.sdset_s {
            found.differ("SDset_S", &clause, bit(snap.sdset_s), bit(seen));
        }
        if let Some(seen) = app.ch_f_ack_req_s {
            found.differ("ChFAckReq_S", &clause, bit(snap.ch_f_ack_req_s), bit(seen));
        }
        if let Some(good) = app.qualifier {
            let word = |good: bool| if good { "GOOD" } else { "BAD" };
            found.differ("qualifier", &format!("11.11.4 Table 42, {row}"), word(!snap.sdset_s), word(good));
        }
    }
    found.0
}
