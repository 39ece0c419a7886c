//! A case told in lines of text: why it ended as it did, what crossed the boundary around the finding, how to run it again.

use crate::decode::Side;
use crate::record::{CaseRecord, Entry, Reason, What};
use crate::summary::verdict_name;
use std::fmt::Write as _;

/// Entries shown up to and with the one that shows the finding.
const BEFORE: usize = 9;
/// Entries shown after it.
const AFTER: usize = 3;

/// The first reason in one sentence.
pub fn headline(reason: &Reason) -> String {
    let clause = if reason.clause.is_empty() { String::new() } else { format!("{}: ", reason.clause) };
    format!("{clause}expected {}; observed {}", reason.expected, reason.observed)
}

/// All that is needed to find the fault. Not escaped.
pub fn story(case: &CaseRecord, side: Side) -> String {
    let mut text = format!("{}\n{}\n", case.title, case.place);
    for record in &case.requirements {
        let _ = writeln!(text, "judges {} (clause {}, {})", record.id, record.clause, record.level);
    }
    for reason in &case.reasons {
        let step = case.steps.get(reason.step).map_or("", |step| step.text.as_str());
        let _ = writeln!(text, "\n{} [{}] at step {} ({step})", verdict_name(reason.verdict), reason.kind, reason.step);
        let clause = if reason.clause.is_empty() { "-" } else { &reason.clause };
        let _ = writeln!(text, "  clause   {clause}\n  expected {}\n  observed {}", reason.expected, reason.observed);
    }
    for (id, what) in &case.tolerances {
        let _ = writeln!(text, "\ntolerance {id}: {what}");
    }
    let around = around(case, side);
    if !around.is_empty() {
        let _ = write!(text, "\n{around}");
    }
    let _ = writeln!(text, "\nreplay: {}", case.replay);
    text
}

/// Position in the trace of the entry that shows the first finding, when there is such an entry.
pub fn shown(case: &CaseRecord) -> Option<usize> {
    case.reasons.iter().find_map(|reason| reason.entry).filter(|entry| *entry < case.trace.len())
}

/// The entries around the finding, decoded, the one that shows it marked; those at the end when none shows it. Not escaped.
pub fn around(case: &CaseRecord, side: Side) -> String {
    let entries = case.trace.len();
    let finding = shown(case);
    let upto = finding.map_or(entries, |entry| entry + 1);
    let (from, to) = (upto.saturating_sub(BEFORE), entries.min(upto + AFTER));
    let mut text = String::new();
    if from == to {
        return text;
    }
    let ports = Ports::of(case);
    let _ = writeln!(text, "entries {} to {to} of {entries}, > to the DUT, < from it:", from + 1);
    for (index, entry) in case.trace.iter().enumerate().take(to).skip(from) {
        let mark = if finding == Some(index) { "=>" } else { "  " };
        let _ = writeln!(text, "{mark} {:>11} ms  {}", milliseconds(entry.at), told(entry, case, side, ports));
    }
    text
}

/// `12.345`, from nanoseconds.
pub fn milliseconds(nanoseconds: u64) -> String {
    format!("{:.3}", nanoseconds as f64 / 1e6)
}

/// Which ports a case uses: one is named when it is another than 1, or when there are several.
#[derive(Copy, Clone, Debug)]
pub struct Ports {
    several: bool,
}

impl Ports {
    /// Those of a case. An FS-Master reports the services of every port at power-on: that alone is no use.
    pub fn of(case: &CaseRecord) -> Ports {
        let used = case.trace.iter().filter(|entry| !matches!(entry.what, What::Service { .. }));
        let mut ports = used.filter_map(|entry| port(&entry.what)).filter(|port| *port > 0);
        let first = ports.next();
        Ports { several: ports.any(|port| Some(port) != first) }
    }

    /// `port 2`, when the entry is on a port that has to be named; port 0 is the whole DUT.
    pub fn name(self, what: &What) -> Option<String> {
        match port(what)? {
            0 => Some("whole DUT".to_owned()),
            1 if !self.several => None,
            port => Some(format!("port {port}")),
        }
    }

    /// The text, behind the port it is about when that has to be named.
    pub fn behind(self, what: &What, text: &str) -> String {
        self.name(what).map_or_else(|| text.to_owned(), |port| format!("{port} · {text}"))
    }
}

const fn port(what: &What) -> Option<u8> {
    match what {
        What::Exchange { port, .. } | What::Set { port, .. } | What::Service { port, .. } | What::Port { port, .. } => {
            Some(*port)
        }
        What::Power { .. } | What::Acyclic { .. } | What::Smi { .. } | What::Event { .. } => None,
    }
}

/// What crossed the boundary, when it was no process data: one text, of a request through the SMI its result as a second.
pub fn notes(what: &What, ports: Ports) -> Vec<String> {
    let text = match what {
        What::Set { service, value, .. } => format!("{service} := {value}"),
        What::Service { service, value, .. } => format!("{service} = {value}"),
        What::Port { text, .. } => text.clone(),
        What::Smi { request, result } => return vec![request.clone(), result.clone()],
        What::Power { on } => format!("power {}", if *on { "on" } else { "off" }),
        What::Acyclic { request, answer } => format!("{request} {answer}"),
        What::Event { code, qualifier } => format!("Event 0x{code:04X} qualifier 0x{qualifier:02X}"),
        What::Exchange { .. } => String::new(),
    };
    vec![ports.behind(what, &text)]
}

/// Two directions, one below the other.
fn there_and_back(there: &str, back: &str) -> String {
    format!("> {there}\n{:19}< {back}", "")
}

fn told(entry: &Entry, case: &CaseRecord, side: Side, ports: Ports) -> String {
    let count = if entry.count > 1 { format!(" (x {})", entry.count) } else { String::new() };
    let via = if entry.via.is_empty() { String::new() } else { format!("  {}", entry.via.join(" ")) };
    let remark = if entry.note.is_empty() { String::new() } else { format!("  [{}]", entry.note) };
    let variant = &case.variant;
    match (&entry.what, notes(&entry.what, ports).as_slice()) {
        (what @ What::Exchange { sent, got, .. }, _) => {
            let sent = ports.behind(what, &side.sent(sent.as_deref(), variant));
            let got = ports.behind(what, &side.got(got.as_deref(), variant));
            there_and_back(&format!("{sent}{remark}{count}"), &format!("{got}{via}"))
        }
        (_, [request, result]) => there_and_back(&format!("{request}{remark}{count}"), &format!("{result}{via}")),
        (What::Port { dut, .. }, notes) => {
            format!("{} {}{count}{via}{remark}", if *dut { '<' } else { '>' }, notes.concat())
        }
        (_, notes) => format!("{}{count}{via}{remark}", notes.concat()),
    }
}
