//! The SPDUs of a case as a sequence chart in SVG: as the standard draws them, FS-Master left, FS-Device right.

use crate::decode::{in_label, out_label};
use crate::record::{CaseRecord, Entry, What};
use crate::text::visible;
use maud::{Markup, html};

/// Rows shown at most; of a longer trace the middle is left out, and the chart says so.
const MOST: usize = 60;
const WIDTH: i32 = 900;
const MASTER: i32 = 190;
const DEVICE: i32 = 640;
const TOP: i32 = 44;

/// One line of the chart.
enum Row<'c> {
    Step(String),
    Entry(&'c Entry),
    Gap(u64),
}

impl Row<'_> {
    const fn height(&self) -> i32 {
        match self {
            Row::Entry(Entry { what: What::Exchange { .. }, .. }) => 46,
            _ => 24,
        }
    }
}

/// The chart of a case.
pub fn chart(case: &CaseRecord) -> Markup {
    let rows = rows(case);
    let mut height = TOP;
    let placed: Vec<(i32, &Row<'_>)> = rows
        .iter()
        .map(|row| {
            let y = height;
            height += row.height();
            (y, row)
        })
        .collect();
    let height = height + 16;
    let title = format!("Sequence of {}", visible(&case.key));
    html! {
        div.scroll {
            svg role="img" viewBox=(format!("0 0 {WIDTH} {height}")) {
                title { (title) }
                desc { "Exchanges between the FS-Master, played by the tester, and the FS-Device under test, in order of time." }
                text x=(MASTER) y="16" text-anchor="middle" { "FS-Master (tester)" }
                text x=(DEVICE) y="16" text-anchor="middle" { "FS-Device (DUT)" }
                line.life x1=(MASTER) y1="24" x2=(MASTER) y2=(height - 8) {}
                line.life x1=(DEVICE) y1="24" x2=(DEVICE) y2=(height - 8) {}
                @for (y, row) in placed { (drawn(row, y, case)) }
            }
        }
    }
}

fn rows(case: &CaseRecord) -> Vec<Row<'_>> {
    let mut rows = Vec::new();
    for (index, entry) in case.trace.iter().enumerate() {
        for (number, step) in case.steps.iter().enumerate().filter(|(_, step)| step.executed && step.entries.0 == index)
        {
            if step.entries.1 > step.entries.0 {
                rows.push(Row::Step(match number {
                    0 => step.text.clone(),
                    number => format!("{number}  {}", step.text),
                }));
            }
        }
        rows.push(Row::Entry(entry));
    }
    let left_out = rows.len().saturating_sub(MOST);
    if left_out > 0 || case.elided > 0 {
        let head = MOST.min(rows.len()) / 3;
        let tail = rows.split_off(head + left_out);
        rows.truncate(head);
        rows.push(Row::Gap(left_out as u64 + case.elided));
        rows.extend(tail);
    }
    rows
}

fn drawn(row: &Row<'_>, y: i32, case: &CaseRecord) -> Markup {
    match row {
        Row::Step(text) => html! {
            line.rule x1="0" y1=(y + 4) x2=(WIDTH) y2=(y + 4) {}
            text.soft x="0" y=(y + 18) { (short(text, 118)) }
        },
        Row::Gap(count) => html! {
            text.soft x=((MASTER + DEVICE) / 2) y=(y + 17) text-anchor="middle" { (count) " lines left out; all that was kept is in run.jsonl" }
        },
        Row::Entry(entry) => match &entry.what {
            What::Exchange { sent, got, .. } => exchange(entry, sent.as_deref(), got.as_deref(), y, case),
            other => note(entry.at, other, y),
        },
    }
}

fn exchange(entry: &Entry, sent: Option<&str>, got: Option<&str>, y: i32, case: &CaseRecord) -> Markup {
    let (there, back) = (y + 18, y + 38);
    let wrong = !entry.note.is_empty();
    let label = sent.map_or_else(|| "lost".to_owned(), |hex| out_label(hex, &case.variant));
    let label = if wrong && sent.is_some() { format!("{label} · {}", entry.note) } else { label };
    let answer = got.map_or_else(|| "no process data".to_owned(), |hex| in_label(hex, &case.variant));
    let end = if sent.is_some() { DEVICE } else { (MASTER + DEVICE) / 2 };
    html! {
        text.soft x="0" y=(there) { (format!("{:.3} ms", entry.at as f64 / 1e6)) }
        @if entry.count > 1 { text.soft x="0" y=(back) { "x " (entry.count) } }
        line.hit[wrong] x1=(MASTER) y1=(there) x2=(end) y2=(there) {}
        @if sent.is_some() { (head(end, there, -1, wrong)) }
        @if wrong { (cross(end - 26, there)) }
        text.wrong[wrong] x=(MASTER + 12) y=(there - 4) { (short(&label, 60)) }
        @if got.is_some() {
            line x1=(DEVICE) y1=(back) x2=(MASTER) y2=(back) {}
            (head(MASTER, back, 1, false))
        }
        text x=(MASTER + 12) y=(back - 4) { (short(&answer, 60)) }
        @if !entry.via.is_empty() { text.soft x=(DEVICE + 10) y=(there + 10) { (visible(&entry.via.join(" "))) } }
    }
}

fn head(x: i32, y: i32, way: i32, hit: bool) -> Markup {
    html! { path.head.hit[hit] d=(format!("M{x} {y} l{} -4 v8 z", way * 9)) {} }
}

fn cross(x: i32, y: i32) -> Markup {
    html! { path.hit d=(format!("M{} {} l10 10 m0 -10 l-10 10", x - 5, y - 5)) {} }
}

fn note(at: u64, what: &What, y: i32) -> Markup {
    let text = match what {
        What::Set { service, value } => format!("{service} := {value}"),
        What::Service { service, value } => format!("{service} = {value}"),
        What::Power { on: true } => "power on".to_owned(),
        What::Power { on: false } => "power off".to_owned(),
        What::Acyclic { request, answer } => format!("{request} {answer}"),
        What::Event { code, .. } => format!("Event 0x{code:04X}"),
        What::Exchange { .. } => String::new(),
    };
    html! {
        text.soft x="0" y=(y + 16) { (format!("{:.3} ms", at as f64 / 1e6)) }
        rect x=(DEVICE + 6) y=(y + 3) width=(WIDTH - DEVICE - 8) height="18" rx="3" {}
        text x=(DEVICE + 12) y=(y + 16) { (short(&text, 32)) }
    }
}

/// At most so many characters, with a sign that some were left out, none of them hostile.
fn short(text: &str, most: usize) -> String {
    let text = visible(text);
    if text.chars().count() <= most {
        return text;
    }
    text.chars().take(most - 1).chain(['…']).collect()
}
