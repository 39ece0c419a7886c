//! A case beside the scenario of Annex G it leads the DUT through: activity by activity, what the standard has and what the
//! case did, with its messages between operator, tool, FS-Master and FS-Device.

use crate::decode::Side;
use crate::record::{ActivityInfo, CaseRecord, Entry, ScenarioInfo, StepRecord, What};
use crate::text::{short, visible as clean};
use maud::{Markup, html};

/// The sides of a scenario in the order of the charts, and where their lifelines are.
const LANES: [(&str, i32); 4] = [("operator", 40), ("tool", 130), ("master", 230), ("device", 380)];
const WIDTH: i32 = 430;
/// Height of one message.
const LINE: i32 = 30;
/// Messages of one activity.
const MESSAGES: usize = 12;
/// Characters of a message, and of any other text.
const LABEL: usize = 64;
const TEXT: usize = 400;
/// Activities of a scenario that are looked at, and above how many the table is closed at first.
const LISTED: usize = 100;
const OPEN: usize = 8;

/// How far a case got with an activity.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
enum Mark<'s> {
    /// Done, and something expected of it.
    Judged { met: bool },
    /// Done, nothing expected.
    Done,
    /// The case ended before.
    NotReached,
    /// No case can, for this reason.
    OutOfReach(&'s str),
    /// Another case does.
    Elsewhere,
    /// The DUT has no part in it.
    Foreign,
}

impl Mark<'_> {
    /// A sign and a word, and the class.
    const fn said(self) -> (&'static str, &'static str) {
        match self {
            Mark::Judged { met: true } => ("✓ judged", "pass"),
            Mark::Judged { met: false } => ("✗ judged", "fail"),
            Mark::Done => ("● done", "soft"),
            Mark::NotReached => ("– not reached", "soft"),
            Mark::OutOfReach(_) => ("○ out of reach", "soft"),
            Mark::Elsewhere => ("– not in this case", "soft"),
            Mark::Foreign => ("– not the DUT's", "soft"),
        }
    }
}

/// The case beside its scenario; nothing for a case without one.
pub fn beside(case: &CaseRecord, scenarios: &[ScenarioInfo]) -> Markup {
    let found = scenarios.iter().find(|scenario| !case.scenario.is_empty() && scenario.id == case.scenario);
    let Some(scenario) = found else { return html! {} };
    let edition = &case.variant.edition;
    let activities: Vec<&ActivityInfo> = scenario
        .activities
        .iter()
        .filter(|activity| activity.edition.is_empty() || activity.edition == *edition)
        .take(LISTED)
        .collect();
    let clause = scenario.clauses.iter().find(|(own, _)| own == edition).map_or("", |entry| entry.1.as_str());
    let judged = activities.iter().filter(|activity| matches!(mark(activity, case), Mark::Judged { .. })).count();
    html! {
        details open[activities.len() <= OPEN] {
            summary {
                (clean(&scenario.id)) ": " (short(&scenario.title, TEXT)) " (" (short(clause, TEXT)) "), "
                (judged) " of " (activities.len()) " activities judged"
            }
            div.scroll tabindex="0" role="group" aria-label={ "Scenario " (clean(&scenario.id)) } {
                table.scenario {
                    thead { tr { th { "This case" } th { "The standard" } } }
                    tbody { @for activity in &activities { (row(activity, case)) } }
                }
            }
        }
    }
}

fn steps_of<'c>(activity: &ActivityInfo, case: &'c CaseRecord) -> Vec<&'c StepRecord> {
    case.steps.iter().filter(|step| step.activities.contains(&activity.number)).collect()
}

fn mark<'s>(activity: &'s ActivityInfo, case: &CaseRecord) -> Mark<'s> {
    let steps = steps_of(activity, case);
    let mut checks = steps.iter().flat_map(|step| &step.checks).peekable();
    let reason = activity.out_of_reach.get(&case.role);
    match (steps.as_slice(), reason) {
        ([], Some(why)) => Mark::OutOfReach(why),
        ([], None) if activity.from != case.role && activity.to != case.role => Mark::Foreign,
        ([], None) => Mark::Elsewhere,
        (steps, _) if steps.iter().all(|step| !step.executed) => Mark::NotReached,
        _ if checks.peek().is_some() => Mark::Judged { met: checks.all(|check| check.met) },
        _ => Mark::Done,
    }
}

fn row(activity: &ActivityInfo, case: &CaseRecord) -> Markup {
    let mark = mark(activity, case);
    let (said, class) = mark.said();
    let steps = steps_of(activity, case);
    let sides = if activity.to.is_empty() {
        clean(&activity.from)
    } else {
        format!("{} → {}", clean(&activity.from), clean(&activity.to))
    };
    html! {
        tr {
            td {
                @for step in &steps {
                    p { code { (short(&step.text, TEXT)) } }
                    @match step.activities.first() {
                        Some(first) if *first != activity.number => p.soft { "The same step as for activity " (first) "." },
                        _ => (messages(step, case)),
                    }
                    @if !step.checks.is_empty() && step.activities.last() == Some(&activity.number) {
                        ul.checks {
                            @for check in step.checks.iter().take(LISTED) {
                                @if check.met { li { "✓ " (clean(&check.key)) " " (short(&check.observed, TEXT)) } }
                                @else { li.fail { "✗ " (clean(&check.key)) " " (short(&check.observed, TEXT)) ", not " (short(&check.expected, TEXT)) } }
                            }
                        }
                    }
                }
            }
            td {
                p { b { (activity.number) } " " span.soft { (sides) } }
                p { (short(&activity.what, TEXT)) }
                @if !activity.then.is_empty() { p.soft { "Then: " (short(&activity.then, TEXT)) } }
                p { span class={ "word " (class) } { (said) } @if let Mark::OutOfReach(why) = mark { ": " (short(why, TEXT)) } }
            }
        }
    }
}

/// One message between two sides.
struct Message {
    from: usize,
    to: usize,
    /// It has an answer.
    both: bool,
    text: String,
}

/// What crossed the boundary in a step, as messages between the sides.
fn messages(step: &StepRecord, case: &CaseRecord) -> Markup {
    let entries = case.trace.get(step.entries.0..step.entries.1.max(step.entries.0)).unwrap_or_default();
    let mut shown: Vec<Message> = Vec::new();
    let (mut exchanges, mut more) = (0_u64, 0_usize);
    for entry in entries {
        if matches!(entry.what, What::Exchange { .. }) {
            exchanges = exchanges.saturating_add(entry.count);
        } else if let Some(message) = message(entry, Side::of(&case.role)) {
            if shown.len() < MESSAGES { shown.push(message) } else { more += 1 }
        }
    }
    if exchanges > 0 {
        let (master, device) = (lane("master"), lane("device"));
        shown.push(Message {
            from: master,
            to: device,
            both: true,
            text: format!("process data, {exchanges} exchanges"),
        });
    }
    if shown.is_empty() {
        return html! {};
    }
    let height = 24 + LINE * shown.len() as i32;
    html! {
        svg.messages role="img" viewBox=(format!("0 0 {WIDTH} {height}")) {
            title { "Messages of this step" }
            @for (name, x) in LANES {
                text.soft x=(x) y="12" text-anchor="middle" { (name) }
                line.life x1=(x) y1="18" x2=(x) y2=(height) {}
            }
            @for (message, number) in shown.iter().zip(0..) { (drawn(message, 24 + LINE * number)) }
        }
        @if more > 0 { p.soft { (more) " more messages are in the chart below." } }
    }
}

fn lane(name: &str) -> usize {
    LANES.iter().position(|(known, _)| *known == name).unwrap_or(0)
}

fn message(entry: &Entry, side: Side) -> Option<Message> {
    let (master, device) = (lane("master"), lane("device"));
    let dut = if side == Side::Master { master } else { device };
    let one_way = |from, to, text: String| Message { from, to, both: false, text };
    Some(match &entry.what {
        What::Smi { request, result } => {
            Message { from: lane("tool"), to: master, both: true, text: format!("{request}: {result}") }
        }
        What::Acyclic { request, answer } => {
            Message { from: master, to: device, both: true, text: format!("{request} {answer}") }
        }
        What::Port { dut: own, text, .. } => {
            let (there, back) = if (side == Side::Master) == *own { (master, device) } else { (device, master) };
            one_way(there, back, text.clone())
        }
        What::Power { on } => one_way(lane("operator"), dut, format!("supply {}", if *on { "on" } else { "off" })),
        What::Set { service, value, .. } => one_way(lane("operator"), dut, format!("{service} := {value}")),
        What::Event { code, .. } => one_way(device, master, format!("Event 0x{code:04X}")),
        What::Service { .. } | What::Exchange { .. } => return None,
    })
}

fn drawn(message: &Message, y: i32) -> Markup {
    let x = |lane: usize| LANES.get(lane).map_or(0, |entry| entry.1);
    let (from, to, at) = (x(message.from), x(message.to), y + 18);
    let tip = |at: i32, x: i32, from: i32| {
        let back = if x > from { -7 } else { 7 };
        format!("M{x} {at}l{back} -4v8z")
    };
    html! {
        text x="4" y=(y + 10) { (short(&message.text, LABEL)) }
        path d=(format!("M{from} {at}H{to}{}", tip(at, to, from))) {}
        @if message.both { path d=(tip(at, from, to)) {} }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeMap;

    fn activity(number: u16, from: &str, to: &str) -> ActivityInfo {
        ActivityInfo {
            number,
            from: from.into(),
            to: to.into(),
            what: format!("what {number}"),
            ..ActivityInfo::default()
        }
    }

    fn step(activities: &[u16], executed: bool, met: Option<bool>) -> StepRecord {
        let check =
            |met| crate::record::Check { key: "mode".into(), expected: "OPERATE".into(), observed: "<b>".into(), met };
        StepRecord {
            text: "smi: {}".into(),
            activities: activities.to_vec(),
            executed,
            entries: (0, 0),
            checks: met.map(check).into_iter().collect(),
        }
    }

    fn case(steps: Vec<StepRecord>) -> CaseRecord {
        let line = r#"{"key":"FSM-2001[]","id":"FSM-2001","suite":"s","dut":0,"role":"master","title":"t","scenario":"CH-G1","place":"p",
            "sweep":[],"variant":{"edition":"v1.1","mode":"crc16","pd_out":1,"pd_in":1,"leading_octet":false},"requirements":[],
            "verdict":"pass","execution":"ok","reasons":[],"tolerances":{},"transitions":{},"start":"idle","steps":[],"trace":[],
            "elided":0,"duration_ns":0,"replay":""}"#;
        CaseRecord { steps, ..serde_json::from_str(line).expect("a case") }
    }

    #[test]
    fn an_activity_is_marked_by_what_the_case_did() {
        let case = case(vec![
            step(&[1, 2], true, Some(true)),
            step(&[3], true, None),
            step(&[4], false, None),
            step(&[5], true, Some(false)),
        ]);
        let marks: Vec<_> = (1..=6).map(|number| mark(&activity(number, "tool", "master"), &case).said().0).collect();
        assert_eq!(marks, ["✓ judged", "✓ judged", "● done", "– not reached", "✗ judged", "– not in this case"]);
        assert_eq!(mark(&activity(9, "device", ""), &case), Mark::Foreign);
        let why = BTreeMap::from([("master".to_owned(), "a person does it".to_owned())]);
        let away = ActivityInfo { out_of_reach: why, ..activity(9, "operator", "master") };
        assert_eq!(mark(&away, &case), Mark::OutOfReach("a person does it"));
    }

    #[test]
    fn only_the_activities_of_the_edition_are_shown_and_texts_are_escaped() {
        let other = ActivityInfo { edition: "iec2022".into(), ..activity(2, "tool", "master") };
        let scenario = ScenarioInfo {
            id: "CH-G1".into(),
            title: "<i>".into(),
            clauses: vec![("v1.1".into(), "Figure G.1".into())],
            activities: vec![activity(1, "tool", "master"), other],
        };
        let page = beside(&case(vec![step(&[1], true, Some(true))]), &[scenario]).into_string();
        assert!(page.contains("1 of 1 activities judged") && page.contains("Figure G.1"), "{page}");
        assert!(page.contains("&lt;i&gt;") && page.contains("&lt;b&gt;") && !page.contains("what 2"), "{page}");
        assert!(beside(&CaseRecord { scenario: String::new(), ..case(Vec::new()) }, &[]).into_string().is_empty());
    }
}
