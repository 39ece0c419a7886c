//! One case in `report.html`: its reasons, the SPDUs around the finding, its steps and its sequence chart, within the room
//! the page has.

use crate::chart::chart;
use crate::decode::Side;
use crate::duts::Duts;
use crate::html::word;
use crate::measured_html::of_case;
use crate::record::{CaseRecord, Reason, RequirementRef, ScenarioInfo};
use crate::scenario_html::beside;
use crate::story::around;
use crate::summary::{execution_name, verdict_name};
use crate::text::{short, visible as clean};
use maud::{Markup, html};
use std::cell::{Cell, RefCell};
use std::collections::BTreeSet;

/// Characters of one text, say an observation.
const TEXT: usize = 600;
/// Steps listed, and checks of one step.
const LISTED: usize = 80;

/// What is left of the page, and what is the same for all cases.
pub struct Room<'r> {
    left: Cell<usize>,
    duts: Duts<'r>,
    scenarios: &'r [ScenarioInfo],
    /// Anchors of the cases shown in full.
    full: RefCell<BTreeSet<String>>,
}

impl<'r> Room<'r> {
    /// A page without room yet, about these DUTs and scenarios.
    pub fn new(duts: Duts<'r>, scenarios: &'r [ScenarioInfo]) -> Room<'r> {
        Room { left: Cell::new(0), duts, scenarios, full: RefCell::default() }
    }

    /// The DUTs of the run.
    pub const fn duts(&self) -> Duts<'r> {
        self.duts
    }

    /// So many octets more.
    pub fn add(&self, octets: usize) {
        self.left.set(self.left.get().saturating_add(octets));
    }

    /// Where a reader finds a case: itself when it is shown in full, or what is said of its id.
    pub fn anchor_of(&self, case: &CaseRecord) -> String {
        let own = anchor(&case.key, case.dut);
        if self.full.borrow().contains(&own) { own } else { anchor(&case.id, case.dut) }
    }

    /// The markup when there is room for it.
    pub fn take(&self, markup: Markup) -> Option<Markup> {
        self.left.set(self.left.get().checked_sub(markup.0.len())?);
        Some(markup)
    }
}

/// A place in the page for a key or an id on a DUT.
pub fn anchor(name: &str, dut: usize) -> String {
    let plain = |c: char| if c.is_ascii_alphanumeric() || "-._".contains(c) { c } else { '_' };
    let name: String = name.chars().take(TEXT).map(plain).collect();
    format!("case-{dut}-{name}")
}

/// A case that needs a reader; `None` when there is no room left even without steps and chart.
pub fn full(case: &CaseRecord, room: &Room<'_>) -> Option<Markup> {
    let (said, class) = word(case);
    let around = around(case, Side::of(&case.role));
    let told = room.take(html! {
        h3 { span class=(format!("word {class}")) { (said) } " " (clean(&case.id)) ": " (short(&case.title, TEXT)) }
        p.soft { code { (short(&case.key, TEXT)) } " · " (clean(&case.place)) " · execution: " (execution_name(case.execution)) }
        @if let Some(dut) = room.duts.of_case(case) { p { "On " (dut) } }
        p { "Judges " (requirements(case)) }
        @for reason in &case.reasons { (why(reason, case)) }
        @for (id, text) in &case.tolerances { p.remark { span.word { "● " (clean(id)) } " " (short(text, TEXT)) } }
        (of_case(case))
        @if !around.is_empty() { pre tabindex="0" { (clean(&around)) } }
        p { "Run it again:" }
        pre.replay tabindex="0" { (clean(&case.replay)) }
    })?;
    let id = anchor(&case.key, case.dut);
    room.full.borrow_mut().insert(id.clone());
    Some(html! {
        section.case id=(id) {
            (told)
            details {
                summary { "Steps and sequence chart" }
                (in_order(case, room).unwrap_or_else(|| html! { p.soft { "Left out to keep this page small; all of it is in run.jsonl." } }))
            }
        }
    })
}

/// `R-11.5.4.1-01 (clause 11.5.4.1, shall)`, all of them.
pub fn requirements(case: &CaseRecord) -> String {
    let of = |record: &RequirementRef| clean(&format!("{} (clause {}, {})", record.id, record.clause, record.level));
    case.requirements.iter().map(of).collect::<Vec<_>>().join(", ")
}

/// What was measured, steps with their checks, and the chart; `None` when there is no room for them.
pub fn body(case: &CaseRecord, room: &Room<'_>) -> Option<Markup> {
    let measured = room.take(of_case(case))?;
    let in_order = in_order(case, room)?;
    Some(html! { (measured) (in_order) })
}

fn in_order(case: &CaseRecord, room: &Room<'_>) -> Option<Markup> {
    room.take(html! {
        (beside(case, room.scenarios))
        (steps(case))
        @if !case.trace.is_empty() { (chart(case, Side::of(&case.role))) }
    })
}

fn why(reason: &Reason, case: &CaseRecord) -> Markup {
    html! {
        dl.why {
            dt { (verdict_name(reason.verdict)) }
            dd { (clean(&reason.kind)) @if !reason.clause.is_empty() { " · clause " (clean(&reason.clause)) } }
            dt { "at step " (reason.step) }
            dd { @if let Some(step) = case.steps.get(reason.step) { code { (short(&step.text, TEXT)) } } }
            dt { "expected" } dd { (short(&reason.expected, TEXT)) }
            dt { "observed" } dd { span.word { (short(&reason.observed, TEXT)) } }
        }
    }
}

fn steps(case: &CaseRecord) -> Markup {
    html! {
        ol.steps start="0" {
            @for step in case.steps.iter().take(LISTED) {
                li {
                    code { (short(&step.text, TEXT)) }
                    @if !step.executed { " " span.soft { "(not reached)" } }
                    @if !step.checks.is_empty() {
                        ul.checks {
                            @for check in step.checks.iter().take(LISTED) {
                                @if check.met { li { "✓ " (clean(&check.key)) " " (short(&check.observed, TEXT)) } }
                                @else {
                                    li.fail { "✗ " (clean(&check.key)) " " (short(&check.observed, TEXT)) ", not " (short(&check.expected, TEXT)) }
                                }
                            }
                        }
                    }
                }
            }
        }
        @if case.steps.len() > LISTED { p.soft { (case.steps.len() - LISTED) " more steps are in run.jsonl." } }
    }
}
