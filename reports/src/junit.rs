//! `junit.xml`: one test case an expanded case, for CI servers.
//!
//! A failure is a failure. Whatever else must not look green is an error: a case that was not executed as meant (its type
//! says how), and one that stayed open (type `inconclusive`). What does not apply is skipped, with the term that excluded
//! it. Remarks pass, and say why in their output. No time of day is written: the same record gives the same octets.
//!
//! A suite names in its properties `profile`, `dut`, `url` the DUTs its cases are about, one after the other; in a run of several
//! DUTs each test case has a property `dut` too, with the same text.
//!
//! What a complete suite shows, or why it shows nothing, stands in a property `claim FSD-2402` of its suite.
//!
//! What was measured stands in properties named by its symbol: `t_RP`, `t_RP.limit`, `t_RP.margin`, `t_RP.uncertainty`; of a
//! second value of the same symbol `t_RP#2`, `t_RP#2.limit` and so on.

use crate::decode::Side;
use crate::duts::Duts;
use crate::journal::Run;
use crate::record::{CaseRecord, Execution, Header, Verdict};
use crate::story::{headline, story};
use crate::summary::{Summary, execution_name, verdict_name};
use crate::text::{short, visible as clean};
use quick_junit::{NonSuccessKind, Property, Report, SerializeError, TestCase, TestCaseStatus, TestSuite};
use std::collections::{BTreeMap, BTreeSet};
use std::time::Duration;

/// Characters of a failure's message; the body has it all.
const MESSAGE: usize = 300;
/// Suite of what the selection left out.
const LEFT_OUT: &str = "not-applicable";

/// The report as XML.
///
/// # Errors
/// What the writer says.
pub fn render(run: &Run) -> Result<String, SerializeError> {
    let duts = Duts::of(&run.header);
    let summary = Summary::of(run);
    let mut suites: BTreeMap<&str, Suite> = BTreeMap::new();
    for case in &run.cases {
        let suite = suites.entry(&case.suite).or_default();
        suite.cases.push(test_case(case, &run.header));
        suite.duts.insert(case.dut);
    }
    for (key, term) in &run.header.not_applicable {
        let suite = suites.entry(LEFT_OUT).or_default();
        suite.cases.push(left_out(key, term));
        // Of several DUTs the record does not say which one a case was left out for.
        if run.header.duts.len() == 1 {
            suite.duts.insert(0);
        }
    }
    let mut report = Report::new("fsct");
    let mut names = BTreeSet::new();
    for (name, Suite { mut cases, duts: meant }) in suites {
        cases.iter_mut().for_each(|case| make_unique(case, &mut names));
        let mut suite = TestSuite::new(clean(name));
        suite.set_time(cases.iter().filter_map(|case| case.time).fold(Duration::ZERO, Duration::saturating_add));
        suite.add_property(Property::new("seed", run.header.seed.to_string()));
        meant.into_iter().flat_map(|number| properties(number, duts)).for_each(|(name, value)| {
            suite.add_property(Property::new(name, clean(&value)));
        });
        for complete in summary.complete.iter().filter(|complete| complete.suite.suite == name) {
            let of = duts.label(complete.suite.dut).map_or_else(String::new, |dut| format!(" {dut}"));
            let claim = format!("claim {}{of}", complete.suite.id);
            suite.add_property(Property::new(clean(&claim), clean(&complete.claim.join(" "))));
        }
        suite.add_test_cases(cases);
        report.add_test_suite(suite);
    }
    report.to_string()
}

/// Cases of a suite, and the DUTs they are about.
#[derive(Default)]
struct Suite {
    cases: Vec<TestCase>,
    duts: BTreeSet<usize>,
}

/// What a suite says of a DUT its cases are about.
fn properties(number: usize, duts: Duts<'_>) -> Vec<(&'static str, String)> {
    let named = ("dut", dut_name(number, duts));
    match duts.get(number) {
        None => vec![named],
        Some(dut) => vec![("profile", dut.profile.clone()), named, ("url", dut.url.clone())],
    }
}

/// Product and version; behind the number of the DUT when there are several.
fn dut_name(number: usize, duts: Duts<'_>) -> String {
    let words = duts.get(number).map(|dut| format!("{} {}", dut.product, dut.version)).unwrap_or_default();
    match (duts.label(number), words.trim()) {
        (None, words) => words.to_owned(),
        (Some(label), "") => label,
        (Some(_), words) => format!("DUT {}: {words}", number.saturating_add(1)),
    }
}

/// Consumers keep only the first of equal names, so a key that stands twice in a record is numbered.
fn make_unique(case: &mut TestCase, names: &mut BTreeSet<(String, String)>) {
    let class = case.classname.as_ref().map_or_else(String::new, |class| class.as_str().to_owned());
    let name = case.name.as_str().to_owned();
    let mut candidate = name.clone();
    let mut number = 1;
    while !names.insert((class.clone(), candidate.clone())) {
        number += 1;
        candidate = format!("{name} #{number}");
    }
    case.name = candidate.into();
}

fn left_out(key: &str, term: &str) -> TestCase {
    let mut status = TestCaseStatus::skipped();
    status.set_message(clean(term));
    let mut case = TestCase::new(clean(key), status);
    case.set_classname(LEFT_OUT);
    case
}

fn test_case(case: &CaseRecord, header: &Header) -> TestCase {
    let side = Side::of(&case.role);
    let mut test = TestCase::new(clean(&case.key), status(case, side));
    test.set_classname(clean(&format!("{}.{}.{}", case.suite, case.variant.edition, case.variant.mode)));
    test.set_time(Duration::from_nanos(case.duration_ns));
    let requirements = case.requirements.iter().map(|it| format!("{} (clause {}, {})", it.id, it.clause, it.level));
    let sweep = case.sweep.iter().map(|(name, value)| format!("{name}={value}"));
    let transitions = case.transitions.iter().map(|(name, count)| format!("{name} x {count}"));
    let duts = Duts::of(header);
    for (name, value) in [
        ("dut", duts.label(case.dut).map_or_else(String::new, |_| dut_name(case.dut, duts))),
        ("title", case.title.clone()),
        ("place", case.place.clone()),
        ("requirements", joined(requirements)),
        ("sweep", joined(sweep)),
        ("verdict", verdict_name(case.verdict).to_owned()),
        ("execution", execution_name(case.execution).to_owned()),
        ("transitions", joined(transitions)),
        ("tolerances", joined(case.tolerances.keys().cloned())),
        ("seed", header.seed.to_string()),
        ("replay", case.replay.clone()),
    ] {
        if !value.is_empty() {
            test.add_property(Property::new(name, clean(&value)));
        }
    }
    for (name, value) in measured(case) {
        test.add_property(Property::new(clean(&name), clean(&value)));
    }
    if case.verdict == Verdict::Remark {
        test.set_system_out(clean(&story(case, side)));
    }
    test
}

/// Names and values of what was measured; consumers keep only one of equal names.
fn measured(case: &CaseRecord) -> Vec<(String, String)> {
    let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
    let mut all = Vec::new();
    for value in &case.measurements {
        let count = counts.entry(&value.symbol).or_default();
        *count += 1;
        let name = if *count == 1 { value.symbol.clone() } else { format!("{}#{count}", value.symbol) };
        all.push((name.clone(), value.plain()));
        all.push((format!("{name}.limit"), value.limits()));
        all.extend(value.margin().map(|margin| (format!("{name}.margin"), margin)));
        all.push((format!("{name}.uncertainty"), value.show(value.uncertainty)));
    }
    all
}

fn joined(parts: impl Iterator<Item = String>) -> String {
    parts.collect::<Vec<_>>().join(", ")
}

fn status(case: &CaseRecord, side: Side) -> TestCaseStatus {
    let first = case.reasons.first();
    let message = first.map_or_else(String::new, |reason| short(&headline(reason), MESSAGE));
    let (kind, class) = match (case.execution, case.verdict) {
        (Execution::Ok, Verdict::Pass | Verdict::Remark) => return TestCaseStatus::success(),
        (Execution::Ok, Verdict::NotApplicable) => {
            let mut status = TestCaseStatus::skipped();
            status.set_message(message);
            return status;
        }
        (Execution::Ok, Verdict::Fail) => {
            (NonSuccessKind::Failure, first.map_or_else(|| "fail".to_owned(), |reason| clean(&reason.kind)))
        }
        (Execution::Ok, Verdict::Inconclusive) => (NonSuccessKind::Error, "inconclusive".to_owned()),
        (execution, Verdict::Fail) => (NonSuccessKind::Failure, execution_name(execution).to_owned()),
        (execution, _) => (NonSuccessKind::Error, execution_name(execution).to_owned()),
    };
    let mut status = TestCaseStatus::non_success(kind);
    status.set_type(class);
    status.set_message(message);
    status.set_description(clean(&story(case, side)));
    status
}
