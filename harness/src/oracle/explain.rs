//! What the oracle says when no configuration explains an exchange: field by field against the one that came closest.

use super::config::{Config, Snapshot};
use super::setup::{App, Setup};
use fsct_protocol::ProtMode;
use fsct_protocol::crc::{Reading, crc16, crc32};
use fsct_protocol::scl::T;
use fsct_protocol::spdu::View;
use fsct_reports::record::Verdict;

/// An exchange that the tables do not allow.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Mismatch {
    /// Fail, or inconclusive where another reading of the standard explains it throughout (A02, A03).
    pub verdict: Verdict,
    /// Nested name of the finding: `signature`, `DCommErr`, `PDout_D`, `watchdog`.
    pub kind: String,
    /// Clause in the edition at hand, with table and transition.
    pub clause: String,
    /// What the nearest allowed answer would have been.
    pub expected: String,
    /// What was there.
    pub observed: String,
}

/// Answer octets that are no SPDU of the configured size, or carry a signature, PortNum or reserved bits that no
/// answer ever carries. `None`: nothing wrong with the form.
pub fn form(setup: &Setup, octets: &[u8]) -> Option<Mismatch> {
    let fail = |kind: &str, clause: &str, expected: String, observed: String| {
        Some(Mismatch { verdict: Verdict::Fail, kind: kind.into(), clause: clause.into(), expected, observed })
    };
    let view = match View::new(octets, setup.mode, setup.pd_in) {
        Ok(view) => view,
        Err(error) => {
            return fail(
                "length",
                "11.4.3",
                format!("an SPDU of {} octets", error.expected),
                format!("{} octets", error.found),
            );
        }
    };
    if !view.signature_matches(setup.reading) {
        return Some(signature(setup, &view, octets));
    }
    if view.port_num() != setup.port.inverted() {
        let plain = if view.port_num() == setup.port.number() { " (the port number, not inverted)" } else { "" };
        return fail(
            "PortNum",
            "11.4.5",
            format!("PortNum {:02X} (port {} inverted)", setup.port.inverted(), setup.port.number()),
            format!("PortNum {:02X}{plain}", view.port_num()),
        );
    }
    if view.octet() & 0b1_1000 != 0 {
        return fail(
            "reserved",
            "11.4.6 Table 32",
            "reserved bits 4 and 3 of Status&DCnt are 0".into(),
            format!("Status&DCnt {:02X}", view.octet()),
        );
    }
    None
}

fn signature(setup: &Setup, view: &View<'_>, octets: &[u8]) -> Mismatch {
    let digits = 2 * setup.mode.signature_octets();
    let secured = &octets[..setup.pd_in + 2];
    let plain = |seed: u32| match setup.mode {
        ProtMode::Crc16 => crc16(seed as u16, secured).into(),
        ProtMode::Crc32 => crc32(seed, secured),
    };
    let swapped = view.signature().swap_bytes() >> (32 - 4 * digits);
    let other = [(Reading::Preset, "A01"), (Reading::LeadingOctet, "A02"), (Reading::FieldFed, "A03")]
        .into_iter()
        .find(|(reading, _)| *reading != setup.reading && view.signature_matches(*reading));
    let (verdict, kind, hint) = match other {
        Some((_, id)) => (
            Verdict::Inconclusive,
            format!("signature/{id}"),
            format!("; it follows the other reading of the start value ({id}), state it in the profile"),
        ),
        None => {
            let hint = if view.signature() == plain(0) {
                "; it is the signature with start value 0"
            } else if view.signature() == plain(1) {
                "; a computed 0 has not been replaced by 1"
            } else if swapped == view.computed(setup.reading) {
                "; its octets are in reverse order"
            } else {
                ""
            };
            (Verdict::Fail, "signature".to_owned(), hint.to_owned())
        }
    };
    Mismatch {
        verdict,
        kind,
        clause: "11.4.7".into(),
        expected: format!("signature {:0digits$X} (start value 1)", view.computed(setup.reading)),
        observed: format!("signature {:0digits$X}{hint}", view.signature()),
    }
}

/// One field in which what was seen differs from what an answer would show.
struct Difference {
    field: &'static str,
    clause: String,
    expected: String,
    observed: String,
}

/// The mismatch against the configuration and answer that differ in the fewest fields.
pub fn nearest(
    setup: &Setup,
    configs: &[Config],
    exchange: u64,
    image: Option<View<'_>>,
    app: &App,
    pdin: impl Fn((u32, u32)) -> Vec<String>,
) -> Mismatch {
    let visible =
        |config: &'_ Config| config.visible(exchange, setup.latency).iter().rev().copied().collect::<Vec<_>>();
    let candidates = configs.iter().flat_map(|config| visible(config).into_iter().map(move |snap| (config, snap)));
    let best = candidates
        .map(|(config, snap)| (differences(setup, &snap, image, app, &pdin(snap.pdin)), config, snap))
        .filter(|(differences, ..)| !differences.is_empty())
        .min_by_key(|(differences, config, _)| (config.used.len(), differences.len()));
    let Some((differences, config, snap)) = best else {
        // Every field agrees, but the answer should have been gone by now: a new SPDU has not been answered.
        let newest = configs.first().map(|config| *config.newest());
        let path = newest.map(|snap| transition(snap.path.deciding())).unwrap_or_default();
        return Mismatch {
            verdict: Verdict::Fail,
            kind: "stale".into(),
            clause: format!("11.5.3 Table 40{path}"),
            expected: format!("a new answer within {} exchanges", setup.latency + 1),
            observed: "the answer before it".into(),
        };
    };
    let timing = timing(config, &snap, &differences);
    let (kind, clause) = timing.unwrap_or_else(|| {
        let first = differences.first();
        (first.map_or("image", |d| d.field).to_owned(), first.map_or_else(String::new, |d| d.clause.clone()))
    });
    let join = |text: fn(&Difference) -> &str| differences.iter().map(text).collect::<Vec<_>>().join(" · ");
    Mismatch {
        verdict: Verdict::Fail,
        kind,
        clause,
        expected: format!("{}{}", join(|d| &d.expected), after(&snap)),
        observed: join(|d| &d.observed),
    }
}

/// A difference in DTimeout alone means that the watchdog was late, early or not there.
fn timing(config: &Config, snap: &Snapshot, differences: &[Difference]) -> Option<(String, String)> {
    let about = |field: &str| differences.iter().any(|difference| difference.field == field);
    let moved = about("DCount_i") || about("DCommErr");
    let expired = snap.path.iter().any(|t| matches!(t.0, 30 | 31));
    let expiry = if config.device.state().0 == 26 { "T30" } else { "T31" };
    let early = about("DTimeout") && !expired && !moved && config.timer.is_some() && about("SDset");
    let late = about("DTimeout") && expired && !moved;
    match (early, late) {
        (true, _) => Some(("watchdog/early".into(), format!("11.5.5, 11.5.3 Table 40 {expiry} (FSP_Watchdog)"))),
        (_, true) => {
            let last = snap.path.iter().find(|t| matches!(t.0, 30 | 31)).unwrap_or(T(31));
            Some(("watchdog/late".into(), format!("11.5.5, 11.5.3 Table 40 {last} (FSP_Watchdog)")))
        }
        _ => None,
    }
}

fn differences(setup: &Setup, snap: &Snapshot, image: Option<View<'_>>, app: &App, pdin: &[String]) -> Vec<Difference> {
    let mut found = Vec::new();
    let row = format!("11.5.3 Table 40{}", transition(snap.path.deciding()));
    let mut differ = |field, clause: String, expected: String, observed: String| {
        if expected != observed {
            let name = |value: String| format!("{field} {value}");
            found.push(Difference { field, clause, expected: name(expected), observed: name(observed) });
        }
    };
    let bit = |value: bool| u8::from(value).to_string();
    match (snap.status, image) {
        (None, None) => {}
        (None, Some(view)) => {
            differ("image", "11.5.4.3, 11.5.3".into(), "all zero".into(), format!("with DCount_i {}", view.counter()));
        }
        (Some(status), None) => {
            differ("image", row.clone(), format!("with DCount_i {}", status.dcount_i), "all zero or none".into());
        }
        (Some(expected), Some(view)) => {
            let seen = view.status();
            differ(
                "DCount_i",
                format!("11.4.6 Table 33, {row}"),
                expected.dcount_i.to_string(),
                seen.dcount_i.to_string(),
            );
            if snap.free.d_comm_err == 0 {
                differ("DCommErr", row.clone(), bit(expected.d_comm_err), bit(seen.d_comm_err));
            }
            if snap.free.d_timeout == 0 {
                differ("DTimeout", row.clone(), bit(expected.d_timeout), bit(seen.d_timeout));
            }
            if snap.free.sd_set == 0 {
                differ("SDset", row.clone(), bit(expected.sd_set), bit(seen.sd_set));
            }
            if let Some(first) = pdin.first()
                && !pdin.contains(&hex(view.pd()))
            {
                differ("PDin", "11.3.3 Table 29, 11.5.3 Table 40".into(), first.clone(), hex(view.pd()));
            }
        }
    }
    if setup.app {
        let state = |octets: &[u8]| if octets.iter().all(|octet| *octet == 0) { "safe".into() } else { hex(octets) };
        let clause = format!("11.3.3 Table 29, {row}");
        if let Some(pdout) = &app.pdout_d {
            differ("PDout_D", clause.clone(), state(snap.pdout.octets()), state(pdout.as_slice()));
        }
        if let (Some(expected), Some(seen)) = (snap.set_sd_dc, app.set_sd_dc) {
            differ("setSD_DC", clause.clone(), bit(expected), bit(seen));
        }
        if let (Some(expected), Some(seen)) = (snap.ch_f_ack_req_dc, app.ch_f_ack_req_dc) {
            differ("ChFAckReq_DC", clause, bit(expected), bit(seen));
        }
    }
    found
}

fn transition(t: Option<T>) -> String {
    t.map(|t| format!(" {t}")).unwrap_or_default()
}

fn after(snap: &Snapshot) -> String {
    let path: Vec<String> = snap.path.iter().map(|t| t.to_string()).collect();
    if path.is_empty() { String::new() } else { format!(" (after {})", path.join(" ")) }
}

/// Octets as upper-case hexadecimal; `-` for none.
pub fn hex(octets: &[u8]) -> String {
    if octets.is_empty() {
        return "-".into();
    }
    octets.iter().map(|octet| format!("{octet:02X}")).collect()
}
