//! A case told in lines of text: why it ended as it did, what crossed the boundary around the finding, how to run it again.

use crate::decode::Side;
use crate::record::{CaseRecord, Entry, Reason, VariantInfo, What};
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
    let _ = writeln!(text, "entries {} to {to} of {entries}, > to the DUT, < from it:", from + 1);
    for (index, entry) in case.trace.iter().enumerate().take(to).skip(from) {
        let mark = if finding == Some(index) { "=>" } else { "  " };
        let _ = writeln!(text, "{mark} {:>11} ms  {}", milliseconds(entry.at), told(entry, &case.variant, side));
    }
    text
}

/// `12.345`, from nanoseconds.
pub fn milliseconds(nanoseconds: u64) -> String {
    format!("{:.3}", nanoseconds as f64 / 1e6)
}

/// What crossed the boundary, when it was no process data.
pub fn note(what: &What) -> String {
    match what {
        What::Set { port: 1, service, value } => format!("{service} := {value}"),
        What::Set { port, service, value } => format!("port {port}: {service} := {value}"),
        What::Service { port: 1, service, value } => format!("{service} = {value}"),
        What::Service { port, service, value } => format!("port {port}: {service} = {value}"),
        What::Port { port, text, .. } => format!("port {port}: {text}"),
        What::Smi { request, result } => format!("{request} -> {result}"),
        What::Power { on } => format!("power {}", if *on { "on" } else { "off" }),
        What::Acyclic { request, answer } => format!("{request} {answer}"),
        What::Event { code, qualifier } => format!("Event 0x{code:04X} qualifier 0x{qualifier:02X}"),
        What::Exchange { .. } => String::new(),
    }
}

fn told(entry: &Entry, variant: &VariantInfo, side: Side) -> String {
    let count = if entry.count > 1 { format!(" (x {})", entry.count) } else { String::new() };
    let via = if entry.via.is_empty() { String::new() } else { format!("  {}", entry.via.join(" ")) };
    let remark = if entry.note.is_empty() { String::new() } else { format!("  [{}]", entry.note) };
    match &entry.what {
        What::Exchange { sent, got, .. } => {
            let (sent, got) = (side.sent(sent.as_deref(), variant), side.got(got.as_deref(), variant));
            format!("> {sent}{remark}{count}\n{:19}< {got}{via}", "")
        }
        other => format!("{}{count}{via}{remark}", note(other)),
    }
}
