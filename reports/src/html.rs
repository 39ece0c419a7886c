//! `report.html`: one file, readable without script and without network.

use crate::case_html::{self, Room};
use crate::complete;
use crate::coverage_html;
use crate::decode::Side;
use crate::duts::Duts;
use crate::evidence_html;
use crate::journal::Run;
use crate::machine::Machine;
use crate::matrix_html;
use crate::measured_html;
use crate::record::{CaseRecord, DutInfo, Execution, Verdict};
use crate::summary::Summary;
use crate::text::{short, visible as clean};
use maud::{DOCTYPE, Markup, PreEscaped, html};
use std::collections::BTreeMap;

/// How every page looks.
const STYLE: &str = include_str!("style.css");
/// Nothing is loaded from anywhere.
const POLICY: &str = "default-src 'none'; style-src 'unsafe-inline'; img-src data:";
/// Cases of one id shown in full when they did not pass.
const IN_FULL: usize = 3;
/// Octets that details may take of the page: those of cases that need a reader, then those of one case an id. With the
/// lists the page stays below 5 MB at 10 000 cases.
const ROOM: (usize, usize) = (2_000_000, 1_000_000);
/// Points of a sweep listed for one id.
pub const LISTED: usize = 120;
/// DUTs whose facts are shown.
const DUTS: usize = 16;
/// Characters of a name shown in headings and facts.
pub const NAME: usize = 120;

/// The head of a page that fetches nothing; `more`: style beside that of every page.
pub fn head(title: &str, more: &str) -> Markup {
    html! {
        head {
            meta charset="utf-8";
            meta http-equiv="Content-Security-Policy" content=(POLICY);
            meta name="viewport" content="width=device-width, initial-scale=1";
            title { (title) }
            style { (PreEscaped(STYLE)) (PreEscaped(more)) }
        }
    }
}

/// The report of a run.
pub fn render(run: &Run) -> String {
    let summary = Summary::of(run);
    let products = run.header.duts.iter().map(|dut| short(&dut.product, NAME)).filter(|product| !product.is_empty());
    let products = short(&products.take(DUTS).collect::<Vec<_>>().join(", "), 3 * NAME);
    let title = format!("fsct: {products}");
    let room = Room::new(Duts::of(&run.header), &run.header.scenarios);
    let markup = html! {
        (DOCTYPE)
        html lang="en" {
            (head(&title, ""))
            body {
                main {
                    h1 { "IO-Link Safety conformance" @if !products.is_empty() { ": " (products) } }
                    p.soft { "Evidence for an assessment, not a certificate. Made by fsct " (short(&run.header.fsct, NAME)) " from run.jsonl." }
                    (banner(&summary))
                    (incomplete(run, &summary))
                    (facts(run, &summary))
                    (differing(run, &summary))
                    (evidence_html::section(run))
                    (matrix_html::section(run, &summary))
                    (coverage(run, &summary))
                    (complete::section(&summary))
                    (tolerances(run, &summary))
                    (attention(run, &room))
                    (measured_html::section(run, &room))
                    (suites(run, &room))
                    (not_applicable(run))
                }
            }
        }
    };
    markup.into_string()
}

/// A verdict in a word with its sign, so that colour is never the only one, and its class.
pub fn word(case: &CaseRecord) -> (&'static str, &'static str) {
    match (case.execution, case.verdict) {
        (_, Verdict::Fail) => ("✗ fail", "fail"),
        (Execution::Ok, Verdict::Pass) => ("✓ pass", "pass"),
        (Execution::Ok, Verdict::NotApplicable) => ("– not applicable", "soft"),
        (Execution::Ok, Verdict::Remark) => ("● remark", "remark"),
        (Execution::Ok, Verdict::Inconclusive) => ("? inconclusive", "inconclusive"),
        (Execution::Aborted, _) if case.trace.is_empty() => ("! not begun", "not-begun"),
        _ => ("! not executed as meant", "error"),
    }
}

fn banner(summary: &Summary) -> Markup {
    let (class, said) = match summary.exit_code() {
        0 => ("pass", "✓ Conformant in every case that ran"),
        1 => ("fail", "✗ Not conformant"),
        3 => ("error", "! Not everything was executed as meant"),
        4 => ("error", "! Nothing ran, so nothing is shown"),
        _ => ("inconclusive", "? Something stayed inconclusive"),
    };
    let counted = |counts: &BTreeMap<String, usize>, but: &str| {
        let counts = counts.iter().filter(|(name, count)| **count > 0 && *name != but);
        counts.map(|(name, count)| format!("{count} {name}")).collect::<Vec<_>>().join(", ")
    };
    let (verdicts, troubles) = (counted(&summary.verdicts, ""), counted(&summary.execution, "ok"));
    html! {
        div class=(format!("banner {class}")) role="status" {
            strong { (said) }
            div {
                (summary.cases) " cases"
                @if !verdicts.is_empty() { ": " (verdicts) }
                @if !troubles.is_empty() { " · execution: " (troubles) }
            }
        }
    }
}

fn incomplete(run: &Run, summary: &Summary) -> Markup {
    let interrupted = run.footer.as_ref().is_some_and(|footer| footer.interrupted);
    html! {
        @if summary.partial {
            p.fail {
                span.word { "! This record is partial: " }
                (summary.cases) " of " (summary.planned) " cases are in it"
                @if interrupted { ", the run was stopped by the user" }
                @else if run.footer.is_none() { ", the run did not come to its end" }
                @if let Some(damage) = &run.damaged { " (" (clean(damage)) ")" }
                "."
            }
        }
    }
}

fn facts(run: &Run, summary: &Summary) -> Markup {
    let duts = &run.header.duts;
    html! {
        dl {
            dt { "Seed" } dd { (summary.seed) }
            dt { "Cases" } dd { (summary.cases) " of " (summary.planned) " planned, " (summary.not_applicable) " more do not apply" }
        }
        @for (number, dut) in duts.iter().enumerate().take(DUTS) {
            h2 {
                @match Duts::of(&run.header).label(number) { None => "Device under test", Some(label) => (label) }
                ": " (role(&dut.role))
            }
            (facts_of(dut))
        }
        @if duts.len() > DUTS { p.soft { (duts.len() - DUTS) " more devices under test are in run.jsonl." } }
    }
}

/// What a DUT says of itself, and how it was reached.
fn facts_of(dut: &DutInfo) -> Markup {
    let name = |text: &str| short(text, NAME);
    let words = [&dut.vendor, &dut.product, &dut.version].map(|text| name(text));
    let own_words: Vec<String> = words.into_iter().filter(|text| !text.is_empty()).collect();
    html! {
        dl {
            dt { "Product" }
            // A DUT that was reached names its clock.
            @if dut.clock.is_empty() { dd { "not reached: nothing is known of it" } }
            @else { dd { (own_words.join(" · ")) span.soft { " in its own words" } } }
            dt { "Address" } dd { code { (short(&dut.url, 4 * NAME)) } }
            dt { "Role" } dd { (name(&dut.role)) }
            @if !dut.clock.is_empty() {
                dt { "Served" } dd { (short(&dut.pcos.join(", "), 4 * NAME)) }
                dt { "Clock" } dd { (name(&dut.clock)) ", resolution " (dut.resolution_ns) " ns, uncertainty ± " (dut.uncertainty_ns) " ns" }
                @if let Some(proof) = &dut.clock_proof {
                    dt { "Loop-back" } dd { (short(&proof.said(), 4 * NAME)) }
                }
                @if let Some(trip) = dut.round_trip {
                    dt { "Round trip" } dd { "median " (micro(trip.median_ns)) ", " (micro(trip.min_ns)) " to " (micro(trip.max_ns)) }
                }
            }
            @if !dut.offers.is_empty() {
                dt { "Offers" } dd { @for offer in dut.offers.iter().take(LISTED) { (name(offer)) br; } }
            }
            dt { "Profile" } dd { (name(&dut.profile)) }
        }
    }
}

/// A role of a record in the standard's words.
pub fn role(role: &str) -> String {
    match role {
        "device" => "FS-Device".to_owned(),
        "master" => "FS-Master".to_owned(),
        other => short(other, NAME),
    }
}

/// A short time in microseconds.
fn micro(ns: u64) -> String {
    format!("{} µs", ns / 1_000)
}

/// What several DUTs of one role came to, where that is not the same.
fn differing(run: &Run, summary: &Summary) -> Markup {
    let duts = Duts::of(&run.header);
    let label = |number| duts.label(number).unwrap_or_default();
    html! {
        @if let Some(compared) = summary.compared {
            h2 { "One case, every DUT" }
            @if summary.differing.is_empty() {
                p { "Each of the " (compared) " cases came to the same on every DUT of its role." }
            } @else {
                p { (summary.differing.len()) " of " (compared) " cases did not come to the same on every DUT of their role." }
                ul {
                    @for case in summary.differing.iter().take(LISTED) {
                        li {
                            code { (short(&case.key, 2 * NAME)) }
                            @for (number, outcome) in &case.outcomes { " · " (outcome) " on " (label(*number)) }
                        }
                    }
                }
                @if summary.differing.len() > LISTED {
                    p.soft { (summary.differing.len() - LISTED) " more are in summary.json." }
                }
            }
        }
    }
}

/// Verdicts in words with their classes, and how often each came.
pub fn counted<'c>(cases: impl Iterator<Item = &'c CaseRecord>) -> BTreeMap<(&'static str, &'static str), usize> {
    let mut counts = BTreeMap::new();
    cases.for_each(|case| *counts.entry(word(case)).or_default() += 1);
    counts
}

/// The transitions of every machine there is a DUT for, and what else a record may hold.
fn coverage(run: &Run, summary: &Summary) -> Markup {
    let count = |name: &String| summary.transitions.get(name).copied();
    let machines = Machine::ALL.map(|machine| (machine, machine.transitions()));
    let known = |name: &String| machines.iter().any(|(_, names)| names.contains(name));
    let others: Vec<String> = summary.transitions.keys().filter(|name| !known(name)).cloned().collect();
    let present = machines.iter().filter(|(_, names)| names.iter().any(|name| count(name).is_some()));
    html! {
        h2 { "Transitions" }
        @for (machine, names) in present {
            @let taken = names.iter().filter(|name| count(name).is_some_and(|count| count > 0)).count();
            h3 { (machine.title()) (together(machine.side(), summary)) }
            p { (taken) " of " (names.len()) " were taken" @if taken < names.len() { "; the others are marked “never”" } "." }
            (cells(names, count))
            (coverage_html::diagram(*machine, count))
            @if let Some(reached) = summary.coverage.iter().find(|reached| machine.walks(&reached.role)) {
                (coverage_html::in_a_row(reached, &run.header))
            }
        }
        @if !others.is_empty() {
            h3 { "Of no known machine" }
            (cells(&others, count))
        }
    }
}

/// Says that counts are over several DUTs.
pub fn together(side: Side, summary: &Summary) -> Markup {
    let duts = summary.duts.iter().filter(|dut| Side::of(&dut.role) == side).count();
    html! { @if duts > 1 { span.soft { " · " (duts) " DUTs together" } } }
}

fn cells(names: &[String], count: impl Fn(&String) -> Option<u64>) -> Markup {
    html! {
        ul.cells {
            @for name in names.iter().take(LISTED) {
                @let count = count(name).unwrap_or(0);
                li.none[count == 0] { span.word { (short(name, NAME)) } " " @if count == 0 { "never" } @else { "× " (count) } }
            }
        }
    }
}

fn tolerances(run: &Run, summary: &Summary) -> Markup {
    let known = &run.header.tolerances;
    html! {
        h2 { "Tolerances" }
        p { "What is let pass where the standard is silent or contradicts itself: " (known.len()) " in force, " (summary.tolerances.len()) " made use of." }
        @if !summary.tolerances.is_empty() {
            div.scroll tabindex="0" role="group" aria-label="Tolerances made use of" {
                table {
                    thead { tr { th scope="col" { "Made use of" } th scope="col" { "What is let pass" } th.number scope="col" { "Cases" } } }
                    @for (id, count) in &summary.tolerances {
                        tr {
                            th scope="row" { "● " (clean(id)) }
                            td { @match known.get(id) { Some(text) => (clean(text)), None => "not among those in force" } }
                            td.number { (count) }
                        }
                    }
                }
            }
        }
        @if !known.is_empty() {
            details {
                summary { "All " (known.len()) " in force" }
                dl { @for (id, text) in known { dt { (clean(id)) } dd { (clean(text)) } } }
            }
        }
    }
}

/// What needs a reader: failures first, then what was not executed, what is open, and remarks.
fn attention(run: &Run, room: &Room<'_>) -> Markup {
    room.add(ROOM.0);
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
                (group(&cases, room))
            }
        }
        (not_begun(run))
    }
}

/// Cases that were never tried have nothing to show but why; one line a reason, or they would bury the others.
fn not_begun(run: &Run) -> Markup {
    let duts = Duts::of(&run.header);
    let mut reasons: BTreeMap<(Option<String>, String), Vec<&str>> = BTreeMap::new();
    for case in run.cases.iter().filter(|case| word(case).1 == "not-begun") {
        let why = case.reasons.first().map_or("no reason is recorded", |reason| &reason.observed);
        reasons.entry((duts.of_case(case), short(why, 2 * NAME))).or_default().push(&case.key);
    }
    html! {
        @if !reasons.is_empty() {
            h2 { "Not begun (" (reasons.values().map(Vec::len).sum::<usize>()) ")" }
            @for ((dut, why), keys) in &reasons {
                details {
                    summary { span.word.not-begun { "! " (keys.len()) " cases" } (of(dut.as_deref())) ": " (why) }
                    p.keys { (listed(keys.iter().copied())) }
                }
            }
        }
    }
}

/// Says which DUT, when there is a choice.
fn of(dut: Option<&str>) -> Markup {
    html! { @if let Some(dut) = dut { " · " (dut) } }
}

/// Cases by id and DUT.
fn by_id<'c>(cases: impl Iterator<Item = &'c CaseRecord>) -> BTreeMap<(&'c str, usize), Vec<&'c CaseRecord>> {
    let mut by_id: BTreeMap<(&str, usize), Vec<&CaseRecord>> = BTreeMap::new();
    cases.for_each(|case| by_id.entry((&case.id, case.dut)).or_default().push(case));
    by_id
}

fn group(cases: &[&CaseRecord], room: &Room<'_>) -> Markup {
    let mut shown = Vec::new();
    let mut unshown: Vec<String> = Vec::new();
    for ((id, dut), cases) in by_id(cases.iter().copied()) {
        let first = cases.iter().take(IN_FULL).map_while(|case| case_html::full(case, room));
        let first: Vec<Markup> = first.collect();
        let others = cases.get(first.len()..).unwrap_or_default();
        if first.is_empty() {
            let on = room.duts().label(dut).map_or_else(String::new, |dut| format!(" on {dut}"));
            unshown.extend(others.iter().map(|case| format!("{}{on}", short(&case.key, NAME))));
        } else {
            shown.push((id, dut, first, others.to_vec()));
        }
    }
    html! {
        @for (id, dut, first, others) in &shown {
            @for case in first { (case) }
            @if !others.is_empty() {
                details {
                    summary { (others.len()) " more of " (clean(id)) " like these" (of(room.duts().label(*dut).as_deref())) }
                    p.keys { (keys(others)) }
                }
            }
        }
        @if !unshown.is_empty() {
            details {
                summary { (unshown.len()) " more, not shown to keep this page small; all of them are in run.jsonl" }
                p.keys { (listed(unshown.iter().map(String::as_str))) }
            }
        }
    }
}

fn suites(run: &Run, room: &Room<'_>) -> Markup {
    let mut suites: BTreeMap<&str, Vec<&CaseRecord>> = BTreeMap::new();
    run.cases.iter().for_each(|case| suites.entry(&case.suite).or_default().push(case));
    room.add(ROOM.1);
    html! {
        h2 { "All cases" }
        @for (suite, cases) in &suites {
            h3 { (clean(suite)) span.soft { " · " (cases.len()) " cases" } }
            @for ((id, dut), cases) in by_id(cases.iter().copied()) { (row(id, dut, &cases, room)) }
        }
    }
}

/// An id on a DUT: verdicts, points, and one of its cases, the first that is not shown above.
fn row(id: &str, dut: usize, cases: &[&CaseRecord], room: &Room<'_>) -> Markup {
    let counts = counted(cases.iter().copied());
    let title = cases.first().map_or_else(String::new, |case| short(&case.title, NAME));
    let heading = html! {
        span.word id=(case_html::anchor(id, dut)) { (clean(id)) } " " (title) (of(room.duts().label(dut).as_deref()))
        @for ((said, class), count) in &counts { " · " span class=(class) { (said) " × " (count) } }
    };
    let details = html! {
        @if let Some(case) = cases.first() { p.soft { "Judges " (case_html::requirements(case)) " · " (clean(&case.place)) } }
        p.keys { (keys(cases)) }
    };
    match room.take(details) {
        None => html! { p { (heading) } },
        Some(details) => html! {
            details {
                summary { (heading) }
                (details)
                @match cases.iter().find(|case| matches!(word(case).1, "pass" | "soft")) {
                    None => p { "None of its cases passed; see above." },
                    Some(case) => {
                        @match case_html::body(case, room) {
                            None => p { "Steps and chart are left out to keep this page small; they are in run.jsonl." },
                            Some(body) => { p { "Shown: " code { (short(&case.key, 2 * NAME)) } } (body) }
                        }
                    }
                }
            }
        },
    }
}

/// As many texts as a page can carry.
fn listed<'t>(texts: impl ExactSizeIterator<Item = &'t str>) -> String {
    let more = texts.len().saturating_sub(LISTED);
    let text = texts.take(LISTED).map(|text| short(text, NAME)).collect::<Vec<_>>().join(", ");
    if more > 0 { format!("{text} and {more} more, all in run.jsonl") } else { text }
}

/// The points of a sweep with their verdicts when those differ, compactly.
fn keys(cases: &[&CaseRecord]) -> String {
    let mixed = cases.iter().any(|case| Some(word(case)) != cases.first().map(|first| word(first)));
    let point = |case: &&CaseRecord| {
        let point = case.sweep.iter().map(|(_, value)| value.as_str()).collect::<Vec<_>>().join(" ");
        let point = if point.is_empty() { case.key.clone() } else { point };
        if mixed { format!("{} {point}", word(case).0.split(' ').next().unwrap_or_default()) } else { point }
    };
    let names = cases.first().map_or_else(Vec::new, |case| case.sweep.iter().map(|(name, _)| name.as_str()).collect());
    let mut text = if names.is_empty() { String::new() } else { format!("{}: ", short(&names.join(" "), NAME)) };
    let points: Vec<String> = cases.iter().map(point).collect();
    text += &listed(points.iter().map(String::as_str));
    text
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
                    p.keys { (listed(keys.iter().copied())) }
                }
            }
        }
    }
}
