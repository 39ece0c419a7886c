//! `junit.xml`: one test case an expanded case, for CI servers.
//!
//! A failure is a failure. Whatever else must not look green is an error: a case that was not executed as meant, and one
//! that stayed inconclusive. What does not apply is skipped, with the term that excluded it. Remarks pass.

use crate::decode::{in_spdu, out_spdu};
use crate::journal::Run;
use crate::record::{CaseRecord, Entry, Execution, Reason, VariantInfo, Verdict, What};
use crate::summary::{execution_name, verdict_name};
use crate::text::visible as clean;
use quick_junit::{NonSuccessKind, Property, Report, TestCase, TestCaseStatus, TestSuite};
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::time::Duration;

/// Entries of the trace shown with a failure.
const SHOWN: usize = 12;

/// The report as XML.
///
/// # Errors
/// What the writer says.
pub fn render(run: &Run) -> Result<String, quick_junit::SerializeError> {
    let mut suites: BTreeMap<&str, Vec<TestCase>> = BTreeMap::new();
    for case in &run.cases {
        suites.entry(&case.suite).or_default().push(test_case(case));
    }
    if !run.header.not_applicable.is_empty() {
        let skipped = run.header.not_applicable.iter().map(|(key, term)| {
            let mut status = TestCaseStatus::skipped();
            status.set_message(clean(term));
            let mut case = TestCase::new(clean(key), status);
            case.set_classname("not-applicable");
            case
        });
        suites.insert("not-applicable", skipped.collect());
    }
    let mut report = Report::new("fsct");
    for (name, cases) in suites {
        let mut suite = TestSuite::new(clean(name));
        suite.set_time(cases.iter().filter_map(|case| case.time).sum());
        suite.add_property(Property::new("seed", run.header.seed.to_string()));
        suite.add_property(Property::new("profile", clean(&run.header.profile)));
        suite.add_property(Property::new(
            "dut",
            clean(&format!("{} {}", run.header.dut.product, run.header.dut.version)),
        ));
        suite.add_property(Property::new("url", clean(&run.header.dut.url)));
        suite.add_test_cases(cases);
        report.add_test_suite(suite);
    }
    report.to_string()
}

fn test_case(case: &CaseRecord) -> TestCase {
    let mut test = TestCase::new(clean(&case.key), status(case));
    test.set_classname(clean(&format!("{}.{}.{}", case.suite, case.variant.edition, case.variant.mode)));
    test.set_time(Duration::from_nanos(case.duration_ns));
    let requirements: Vec<String> =
        case.requirements.iter().map(|record| format!("{} ({}, {})", record.id, record.clause, record.level)).collect();
    let transitions: Vec<String> = case.transitions.iter().map(|(name, count)| format!("{name} x{count}")).collect();
    let tolerances: Vec<&str> = case.tolerances.keys().map(String::as_str).collect();
    for (name, value) in [
        ("title", case.title.clone()),
        ("place", case.place.clone()),
        ("requirements", requirements.join(", ")),
        ("verdict", verdict_name(case.verdict).to_owned()),
        ("execution", execution_name(case.execution).to_owned()),
        ("transitions", transitions.join(", ")),
        ("tolerances", tolerances.join(", ")),
        ("replay", case.replay.clone()),
    ] {
        if !value.is_empty() {
            test.add_property(Property::new(name, clean(&value)));
        }
    }
    if case.verdict == Verdict::Remark {
        test.set_system_out(clean(&story(case)));
    }
    test
}

fn status(case: &CaseRecord) -> TestCaseStatus {
    let kind = match (case.execution, case.verdict) {
        (Execution::Ok, Verdict::Pass | Verdict::Remark) => return TestCaseStatus::success(),
        (Execution::Ok, Verdict::NotApplicable) => return TestCaseStatus::skipped(),
        (_, Verdict::Fail) => NonSuccessKind::Failure,
        _ => NonSuccessKind::Error,
    };
    let mut status = TestCaseStatus::non_success(kind);
    let first = case.reasons.first();
    status.set_type(match (case.execution, first) {
        (Execution::Ok, Some(reason)) if case.verdict == Verdict::Fail => clean(&reason.kind),
        (Execution::Ok, _) => "inconclusive".to_owned(),
        (execution, _) => execution_name(execution).to_owned(),
    });
    status.set_message(clean(&first.map_or_else(String::new, headline)));
    status.set_description(clean(&story(case)));
    status
}

fn headline(reason: &Reason) -> String {
    let clause = if reason.clause.is_empty() { String::new() } else { format!("{}: ", reason.clause) };
    format!("{clause}expected {}; observed {}", reason.expected, reason.observed)
}

/// All that is needed to find the fault, as text.
fn story(case: &CaseRecord) -> String {
    let mut text = format!("{}\n{}\n", case.title, case.place);
    for record in &case.requirements {
        let _ = writeln!(text, "judges {} (clause {}, {})", record.id, record.clause, record.level);
    }
    for reason in &case.reasons {
        let step = case.steps.get(reason.step).map_or("", |step| step.text.as_str());
        let _ = writeln!(text, "\n{} [{}] at step {} ({step})", verdict_name(reason.verdict), reason.kind, reason.step);
        let _ = writeln!(
            text,
            "  clause   {}\n  expected {}\n  observed {}",
            reason.clause, reason.expected, reason.observed
        );
    }
    for (id, what) in &case.tolerances {
        let _ = writeln!(text, "\ntolerance {id}: {what}");
    }
    let last = case.reasons.iter().find_map(|reason| reason.entry).map_or(case.trace.len(), |entry| entry + 1);
    let last = last.min(case.trace.len());
    let from = last.saturating_sub(SHOWN);
    if from < last {
        let _ = writeln!(text, "\nlast of {} entries:", case.trace.len());
    }
    for entry in &case.trace[from..last] {
        let _ = writeln!(text, "  {:>12.3} ms  {}", entry.at as f64 / 1e6, entry_text(entry, &case.variant));
    }
    let _ = writeln!(text, "\nreplay: {}", case.replay);
    text
}

fn entry_text(entry: &Entry, variant: &VariantInfo) -> String {
    let what = match &entry.what {
        What::Exchange { sent, got, .. } => {
            let sent = sent.as_ref().map_or_else(|| "lost".to_owned(), |hex| out_spdu(hex, variant));
            let got = got.as_ref().map_or_else(|| "nothing".to_owned(), |hex| in_spdu(hex, variant));
            format!("> {sent}\n                   < {got}")
        }
        What::Set { service, value } => format!("set {service} {value}"),
        What::Service { service, value } => format!("{service} {value}"),
        What::Power { on } => format!("power {}", if *on { "on" } else { "off" }),
        What::Acyclic { request, answer } => format!("{request} {answer}"),
        What::Event { code, qualifier } => format!("Event 0x{code:04X} qualifier 0x{qualifier:02X}"),
    };
    let count = if entry.count > 1 { format!(" (x{})", entry.count) } else { String::new() };
    let via = if entry.via.is_empty() { String::new() } else { format!("  {}", entry.via.join(" ")) };
    let note = if entry.note.is_empty() { String::new() } else { format!("  [{}]", entry.note) };
    format!("{what}{count}{via}{note}")
}
