//! What the oracle says when no configuration explains an exchange: field by field against the one that came closest.

use super::config::{Config, Machine, Snapshot};
use super::setup::Setup;
use fsct_adapters::Role;
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

impl Mismatch {
    /// One that fails the DUT.
    pub fn fail(kind: &str, clause: &str, expected: &str, observed: String) -> Mismatch {
        let (kind, clause, expected) = (kind.to_owned(), clause.to_owned(), expected.to_owned());
        Mismatch { verdict: Verdict::Fail, kind, clause, expected, observed }
    }
}

/// Octets of an image that are no SPDU of the configured size, or carry a signature, PortNum or reserved bits that no
/// SPDU of this side ever carries. `None`: nothing wrong with the form.
pub fn form(setup: &Setup, octets: &[u8]) -> Option<Mismatch> {
    let fail = |kind: &str, clause: &str, expected: String, observed: String| {
        Some(Mismatch { verdict: Verdict::Fail, kind: kind.into(), clause: clause.into(), expected, observed })
    };
    let view = match View::new(octets, setup.mode, setup.image_pd()) {
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
    let (own, way, other, confused) = match setup.role {
        Role::Device => (setup.port.inverted(), " inverted", setup.port.number(), " (the port number, not inverted)"),
        Role::Master => (setup.port.number(), "", setup.port.inverted(), " (the port number inverted)"),
    };
    if view.port_num() != own {
        let confused = if view.port_num() == other { confused } else { "" };
        return fail(
            "PortNum",
            "11.4.5",
            format!("PortNum {own:02X} (port {}{way})", setup.port.number()),
            format!("PortNum {:02X}{confused}", view.port_num()),
        );
    }
    let (reserved, bits, octet, table) = match setup.role {
        Role::Device => (0b1_1000, "4 and 3", "Status&DCnt", "11.4.6 Table 32"),
        Role::Master => (0b1_1100, "4 to 2", "Control&MCnt", "11.4.6 Table 31"),
    };
    if view.octet() & reserved != 0 {
        return fail(
            "reserved",
            table,
            format!("reserved bits {bits} of {octet} are 0"),
            format!("{octet} {:02X}", view.octet()),
        );
    }
    None
}

fn signature(setup: &Setup, view: &View<'_>, octets: &[u8]) -> Mismatch {
    let digits = 2 * setup.mode.signature_octets();
    let secured = &octets[..setup.image_pd() + 2];
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

/// One field in which what was seen differs from what an SPDU would show.
pub struct Difference {
    /// The standard's name.
    pub field: &'static str,
    /// Clause that says what is to be seen.
    pub clause: String,
    /// With the name in front.
    pub expected: String,
    /// With the name in front.
    pub observed: String,
}

/// The differences of one SPDU, as they are found.
#[derive(Default)]
pub struct Differences(pub Vec<Difference>);

impl Differences {
    /// Adds a field if what was seen is not what was expected.
    pub fn differ(&mut self, field: &'static str, clause: &str, expected: impl ToString, observed: impl ToString) {
        let (expected, observed) = (expected.to_string(), observed.to_string());
        if expected != observed {
            let name = |value: String| format!("{field} {value}");
            let clause = clause.to_owned();
            self.0.push(Difference { field, clause, expected: name(expected), observed: name(observed) });
        }
    }
}

/// What tells one kind of DUT apart from another when a mismatch is put into words.
pub struct Words<'w, M, S> {
    /// Clause and table of its machine.
    pub table: &'static str,
    /// What is seen, against a snapshot.
    pub differences: &'w dyn Fn(&S) -> Vec<Difference>,
    /// Kind and clause of a mismatch that is a matter of the watchdog alone.
    #[expect(clippy::type_complexity, reason = "said once, here")]
    pub timing: &'w dyn Fn(&Config<M, S>, &S, &[Difference]) -> Option<(String, String)>,
}

/// The mismatch against the configuration and SPDU that differ in the fewest fields.
pub fn nearest<M: Machine, S: Snapshot>(
    configs: &[Config<M, S>],
    exchange: u64,
    latency: u64,
    words: &Words<'_, M, S>,
) -> Mismatch {
    let candidates = configs
        .iter()
        .flat_map(|config| config.visible(exchange, latency).iter().rev().map(move |snapshot| (config, *snapshot)));
    let best = candidates
        .map(|(config, snapshot)| ((words.differences)(&snapshot), config, snapshot))
        .filter(|(differences, ..)| !differences.is_empty())
        .min_by_key(|(differences, config, _)| (config.used.len(), differences.len()));
    let Some((differences, config, snapshot)) = best else {
        // Every field agrees, but the SPDU should have been gone by now: a new one has not been answered.
        let path = configs.first().map(|config| transition(config.newest().path().deciding())).unwrap_or_default();
        return Mismatch {
            verdict: Verdict::Fail,
            kind: "stale".into(),
            clause: format!("{}{path}", words.table),
            expected: format!("a new SPDU within {} exchanges", latency + 1),
            observed: "the one before it".into(),
        };
    };
    let timing = (words.timing)(config, &snapshot, &differences);
    let (kind, clause) = timing.unwrap_or_else(|| {
        let first = differences.first();
        (first.map_or("image", |d| d.field).to_owned(), first.map_or_else(String::new, |d| d.clause.clone()))
    });
    let join = |text: fn(&Difference) -> &str| differences.iter().map(text).collect::<Vec<_>>().join(" · ");
    Mismatch {
        verdict: Verdict::Fail,
        kind,
        clause,
        expected: format!("{}{}", join(|d| &d.expected), after(&snapshot)),
        observed: join(|d| &d.observed),
    }
}

/// ` T25`, or nothing.
pub fn transition(t: Option<T>) -> String {
    t.map(|t| format!(" {t}")).unwrap_or_default()
}

fn after<S: Snapshot>(snapshot: &S) -> String {
    let path: Vec<String> = snapshot.path().iter().map(|t| t.to_string()).collect();
    if path.is_empty() { String::new() } else { format!(" (after {})", path.join(" ")) }
}

/// A bit as it is written.
pub fn bit(value: bool) -> u8 {
    value.into()
}

/// Octets as upper-case hexadecimal; `-` for none.
pub fn hex(octets: &[u8]) -> String {
    if octets.is_empty() {
        return "-".into();
    }
    octets.iter().map(|octet| format!("{octet:02X}")).collect()
}

/// Process data in words: `safe`, or the octets.
pub fn data(octets: &[u8]) -> String {
    if octets.iter().all(|octet| *octet == 0) { "safe".into() } else { hex(octets) }
}
