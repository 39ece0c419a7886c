//! `report.html`: one file, readable without script and without network.

use crate::chart::chart;
use crate::journal::Run;
use crate::record::{CaseRecord, Execution, Reason, RequirementRef, Verdict};
use crate::summary::{Summary, execution_name, verdict_name};
use crate::text::visible as clean;
use maud::{DOCTYPE, Markup, PreEscaped, html};
use std::collections::BTreeMap;

const STYLE: &str = include_str!("style.css");
/// Nothing is loaded from anywhere.
const POLICY: &str = "default-src 'none'; style-src 'unsafe-inline'; img-src data:";
/// Cases of one id shown in full when they did not pass.
const IN_FULL: usize = 3;
/// Points of a sweep listed for one id.
const LISTED: usize = 120;

/// The report of a run.
pub fn render(run: &Run) -> String {
    let summary = Summary::of(run);
    let title = format!("fsct: {} {}", clean(&run.header.dut.product), clean(&run.header.dut.version));
    let markup = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta http-equiv="Content-Security-Policy" content=(POLICY);
                meta name="viewport" content="width=device-width, initial-scale=1";
                title { (title) }
                style { (PreEscaped(STYLE)) }
            }
            body {
                main {
                    h1 { "IO-Link Safety conformance: " (clean(&run.header.dut.product)) }
                    p.soft { "Evidence for an assessment, never a certificate. Made by fsct " (clean(&run.header.fsct)) " from run.jsonl." }
                    (banner(&summary))
                    (incomplete(run, &summary))
                    (facts(run, &summary))
                    (coverage(&summary))
                    (attention(run))
                    (suites(run))
                    (tolerances(run, &summary))
                    (not_applicable(run))
                }
            }
        }
    };
    markup.into_string()
}

/// A verdict in a word with its sign, so that colour is never the only one.
fn word(case: &CaseRecord) -> (&'static str, &'static str) {
    match (case.execution, case.verdict) {
        (Execution::Ok, Verdict::Pass | Verdict::NotApplicable) => ("✓ pass", "pass"),
        (Execution::Ok, Verdict::Remark) => ("● remark", "remark"),
        (_, Verdict::Fail) => ("✗ fail", "fail"),
        (Execution::Ok, _) => ("? inconclusive", "inconclusive"),
        _ => ("! not executed", "error"),
    }
}

fn banner(summary: &Summary) -> Markup {
    let (class, said) = match summary.exit_code() {
        0 => ("pass", "✓ Conformant in every case that ran"),
        1 => ("fail", "✗ Not conformant"),
        3 => ("error", "! Not all cases were executed as meant"),
        4 => ("error", "! Nothing ran"),
        _ => ("inconclusive", "? Inconclusive"),
    };
    let counts: Vec<String> = summary
        .verdicts
        .iter()
        .filter(|(_, count)| **count > 0)
        .map(|(name, count)| format!("{count} {name}"))
        .collect();
    html! {
        div class=(format!("banner {class}")) role="status" {
            strong { (said) }
            " · " (summary.cases) " cases: " (counts.join(", "))
        }
    }
}

fn incomplete(run: &Run, summary: &Summary) -> Markup {
    let interrupted = run.footer.as_ref().is_some_and(|footer| footer.interrupted);
    html! {
        @if summary.partial {
            p.fail {
                span.word { "This record is partial: " }
                (summary.cases) " of " (summary.planned) " cases are in it"
                @if interrupted { ", the user stopped the run" }
                @else if run.footer.is_none() { ", the run did not come to its end" }
                @if let Some(damage) = &run.damaged { " (" (clean(damage)) ")" }
                "."
            }
        }
    }
}

fn facts(run: &Run, summary: &Summary) -> Markup {
    let dut = &run.header.dut;
    html! {
        dl {
            dt { "Device under test" } dd { (clean(&dut.vendor)) " · " (clean(&dut.product)) " · " (clean(&dut.version)) " (in its own words)" }
            dt { "Address" } dd { code { (clean(&dut.url)) } }
            dt { "Role" } dd { (clean(&dut.role)) }
            dt { "Served" } dd { (clean(&dut.pcos.join(", "))) }
            dt { "Clock" } dd { (clean(&dut.clock)) ", resolution " (dut.resolution_ns) " ns, uncertainty ± " (dut.uncertainty_ns) " ns" }
            dt { "Offers" } dd { @for offer in &dut.offers { (clean(offer)) br; } }
            dt { "Profile" } dd { (clean(&run.header.profile)) }
            dt { "Seed" } dd { (summary.seed) }
            dt { "Not applicable" } dd { (summary.not_applicable) " cases" }
        }
    }
}

fn coverage(summary: &Summary) -> Markup {
    html! {
        h2 { "Transitions taken" }
        ul.cells {
            @for (name, count) in &summary.transitions {
                li.none[*count == 0] { span.word { (clean(name)) } " " @if *count == 0 { "never" } @else { (count) } }
            }
        }
    }
}

/// What needs a reader: failures first, then what is open, then remarks.
fn attention(run: &Run) -> Markup {
    let groups = [
        ("Failures", "fail"),
        ("Not executed as meant", "error"),
        ("Inconclusive", "inconclusive"),
        ("Remarks", "remark"),
    ];
    html! {
        @for (title, class) in groups {
            @let cases: Vec<&CaseRecord> = run.cases.iter().filter(|case| word(case).1 == class).collect();
            @if !cases.is_empty() {
                h2 { (title) " (" (cases.len()) ")" }
                (group(&cases))
            }
        }
    }
}

fn group(cases: &[&CaseRecord]) -> Markup {
    let mut by_id: BTreeMap<&str, Vec<&CaseRecord>> = BTreeMap::new();
    cases.iter().for_each(|case| by_id.entry(&case.id).or_default().push(case));
    html! {
        @for (id, cases) in by_id {
            @for case in cases.iter().take(IN_FULL) {
                section.case { (full(case)) }
            }
            @if cases.len() > IN_FULL {
                p.soft { (cases.len() - IN_FULL) " more of " (clean(id)) " like these:" }
                p.keys { (keys(&cases[IN_FULL..])) }
            }
        }
    }
}

fn full(case: &CaseRecord) -> Markup {
    let (said, class) = word(case);
    html! {
        h3 { span class=(format!("word {class}")) { (said) } " " (clean(&case.id)) ": " (clean(&case.title)) }
        p.soft { code { (clean(&case.key)) } " · " (clean(&case.place)) " · " (execution_name(case.execution)) }
        p { "Judges " (requirements(case)) }
        @for reason in &case.reasons { (why(reason, case)) }
        @for (id, text) in &case.tolerances { p.remark { span.word { (clean(id)) } " " (clean(text)) } }
        (body(case))
        p { "Run it again:" }
        pre { (clean(&case.replay)) }
    }
}

fn requirements(case: &CaseRecord) -> String {
    let of = |record: &RequirementRef| clean(&format!("{} (clause {}, {})", record.id, record.clause, record.level));
    case.requirements.iter().map(of).collect::<Vec<_>>().join(", ")
}

fn why(reason: &Reason, case: &CaseRecord) -> Markup {
    html! {
        dl {
            dt { (verdict_name(reason.verdict)) } dd { (clean(&reason.kind)) @if !reason.clause.is_empty() { " · clause " (clean(&reason.clause)) } }
            dt { "at step " (reason.step) } dd { @if let Some(step) = case.steps.get(reason.step) { code { (clean(&step.text)) } } }
            dt { "expected" } dd { (clean(&reason.expected)) }
            dt { "observed" } dd { span.word { (clean(&reason.observed)) } }
        }
    }
}

/// Steps with their checks, and the chart.
fn body(case: &CaseRecord) -> Markup {
    html! {
        ol.steps start="0" {
            @for step in &case.steps {
                li {
                    code { (clean(&step.text)) }
                    @if !step.executed { " " span.soft { "(not reached)" } }
                    ul.checks {
                        @for check in &step.checks {
                            @if check.met { li { "✓ " (clean(&check.key)) " " (clean(&check.observed)) } }
                            @else { li.fail { "✗ " (clean(&check.key)) " " (clean(&check.observed)) ", not " (clean(&check.expected)) } }
                        }
                    }
                }
            }
        }
        @if !case.trace.is_empty() { (chart(case)) }
    }
}

fn suites(run: &Run) -> Markup {
    let mut suites: BTreeMap<&str, BTreeMap<&str, Vec<&CaseRecord>>> = BTreeMap::new();
    for case in &run.cases {
        suites.entry(&case.suite).or_default().entry(&case.id).or_default().push(case);
    }
    html! {
        h2 { "All cases" }
        @for (suite, ids) in &suites {
            h3 { (clean(suite)) }
            @for (id, cases) in ids { (row(id, cases)) }
        }
    }
}

fn row(id: &str, cases: &[&CaseRecord]) -> Markup {
    let mut counts: BTreeMap<(&str, &str), usize> = BTreeMap::new();
    cases.iter().for_each(|case| *counts.entry(word(case)).or_default() += 1);
    html! {
        details {
            summary {
                span.word { (clean(id)) } " "
                @if let Some(case) = cases.first() { (clean(&case.title)) }
                @for ((said, class), count) in &counts { " · " span class=(class) { (said) @if *count > 1 { " x " (count) } } }
            }
            @if let Some(case) = cases.first() {
                p.soft { "Judges " (requirements(case)) " · " (clean(&case.place)) }
                p.keys { (keys(cases)) }
                p { "Shown: " code { (clean(&case.key)) } }
                (body(case))
            }
        }
    }
}

/// The points of a sweep, compactly.
fn keys(cases: &[&CaseRecord]) -> String {
    let point = |case: &&CaseRecord| case.sweep.iter().map(|(_, value)| clean(value)).collect::<Vec<_>>().join(" ");
    let mut text = cases.iter().take(LISTED).map(point).collect::<Vec<_>>().join(", ");
    if cases.len() > LISTED {
        text += &format!(" and {} more, all in run.jsonl", cases.len() - LISTED);
    }
    text
}

fn tolerances(run: &Run, summary: &Summary) -> Markup {
    html! {
        h2 { "Tolerances in force" }
        p { "Where the standard is silent or contradicts itself. Those made use of are shown with the number of cases." }
        div.scroll {
            table {
                tr { th { "Id" } th { "What is let pass" } th.number { "Cases" } }
                @for (id, text) in &run.header.tolerances {
                    tr {
                        td { (clean(id)) } td { (clean(text)) }
                        td.number { @match summary.tolerances.get(id) { Some(count) => { span.word { (count) } }, None => "–" } }
                    }
                }
            }
        }
    }
}

fn not_applicable(run: &Run) -> Markup {
    let mut terms: BTreeMap<&str, Vec<&str>> = BTreeMap::new();
    run.header.not_applicable.iter().for_each(|(key, term)| terms.entry(term).or_default().push(key));
    html! {
        @if !terms.is_empty() {
            h2 { "Not applicable (" (run.header.not_applicable.len()) ")" }
            @for (term, keys) in &terms {
                details {
                    summary { (keys.len()) " cases: " (clean(term)) }
                    p.keys { (clean(&keys.iter().take(LISTED).copied().collect::<Vec<_>>().join(", "))) }
                }
            }
        }
    }
}
