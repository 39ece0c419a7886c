//! The SPDUs of a case as a sequence chart in SVG: as the standard draws them, FS-Master left, FS-Device right.

use crate::decode::Side;
use crate::record::{CaseRecord, Entry, What};
use crate::story::{Ports, milliseconds, notes, shown};
use crate::text::{short, visible, wrapped};
use maud::{Markup, html};

/// Rows shown at most; of a longer trace some in the middle are left out, and the chart says so.
const MOST: usize = 60;
/// Of these, rows at the beginning; the others end soon after the finding.
const HEAD: usize = 16;
/// Rows after the finding.
const AFTER: usize = 6;
pub(crate) const WIDTH: i32 = 900;
pub(crate) const MASTER: i32 = 190;
pub(crate) const DEVICE: i32 = 640;
pub(crate) const MIDDLE: i32 = (MASTER + DEVICE) / 2;
pub(crate) const LABEL: i32 = MASTER + 12;
const TOP: i32 = 44;
/// Characters of a line in a box, and the width of the box: right of the right lifeline, and between the two.
const NARROW: (usize, i32) = (32, WIDTH - DEVICE - 8);
const WIDE: (usize, i32) = (58, DEVICE - MASTER - 12);
/// Lines of one text in a box, and how far they are apart.
const LINES: usize = 3;
const LINE: i32 = 14;

/// One line of the chart.
enum Row<'c> {
    Step(String),
    /// An entry, and whether it shows the finding.
    Entry(&'c Entry, bool),
    Gap(u64),
}

/// What is the same for all rows.
struct Frame<'c> {
    case: &'c CaseRecord,
    side: Side,
    ports: Ports,
}

impl Frame<'_> {
    fn height(&self, row: &Row<'_>) -> i32 {
        match row {
            Row::Entry(Entry { what: What::Exchange { .. }, .. }, _) => 46,
            Row::Entry(entry, _) => {
                let boxed = self.boxed(entry);
                // What stands beside a box begins below the mark of a finding and may have two lines.
                boxed.height().max(if boxed.beside.is_empty() { 0 } else { 46 })
            }
            Row::Step(_) | Row::Gap(_) => 24,
        }
    }
}

/// The chart of a case.
pub fn chart(case: &CaseRecord, side: Side) -> Markup {
    let frame = Frame { case, side, ports: Ports::of(case) };
    let rows = rows(case);
    let mut height = TOP;
    let placed: Vec<(i32, &Row<'_>)> = rows
        .iter()
        .map(|row| {
            let y = height;
            height += frame.height(row);
            (y, row)
        })
        .collect();
    let height = height + 16;
    let title = format!("Sequence of {}", visible(&case.key));
    let (master, device) = match side {
        Side::Device => ("FS-Master (tester)", "FS-Device (DUT)"),
        Side::Master => ("FS-Master (DUT)", "FS-Device (tester)"),
    };
    html! {
        div.scroll tabindex="0" role="group" aria-label="Sequence chart" {
            svg role="img" viewBox=(format!("0 0 {WIDTH} {height}")) {
                title { (title) }
                desc {
                    "Exchanges between " (master) " and " (device) ", in order of time. A cross on an arrow: falsified; at its end: lost. "
                    "A box holds what is no process data, at the side that did it or was asked. "
                    "Transitions of the DUT stand beside its lifeline."
                }
                text x=(MASTER) y="16" text-anchor="middle" { (master) }
                text x=(DEVICE) y="16" text-anchor="middle" { (device) }
                line.life x1=(MASTER) y1="24" x2=(MASTER) y2=(height - 8) {}
                line.life x1=(DEVICE) y1="24" x2=(DEVICE) y2=(height - 8) {}
                @for (y, row) in placed { (frame.drawn(row, y)) }
            }
        }
    }
}

fn rows(case: &CaseRecord) -> Vec<Row<'_>> {
    let mut rows = Vec::new();
    let shown = shown(case);
    let mut finding = None;
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
        if shown == Some(index) {
            finding = Some(rows.len());
        }
        rows.push(Row::Entry(entry, shown == Some(index)));
    }
    without_middle(rows, finding, case.elided)
}

/// Keeps the beginning and a window that ends soon after the finding, or at the end when there is none.
fn without_middle(mut rows: Vec<Row<'_>>, finding: Option<usize>, elided: u64) -> Vec<Row<'_>> {
    let all = rows.len();
    if all <= MOST && elided == 0 {
        return rows;
    }
    let head = HEAD.min(all);
    let upto = finding.map_or(all, |row| row.saturating_add(1 + AFTER).clamp(MOST.min(all), all));
    let from = upto.saturating_sub(MOST - head).max(head);
    let tail = rows.split_off(upto);
    let window = rows.split_off(from);
    rows.truncate(head);
    if from > head || elided > 0 {
        rows.push(Row::Gap(((from - head) as u64).saturating_add(elided)));
    }
    rows.extend(window);
    if !tail.is_empty() {
        rows.push(Row::Gap(tail.len() as u64));
    }
    rows
}

impl Frame<'_> {
    fn drawn(&self, row: &Row<'_>, y: i32) -> Markup {
        match row {
            Row::Step(text) => html! {
                line.rule x1="0" y1=(y + 4) x2=(WIDTH) y2=(y + 4) {}
                text.soft x="0" y=(y + 18) { (short(text, 118)) }
            },
            Row::Gap(count) => html! {
                text.soft x=(MIDDLE) y=(y + 17) text-anchor="middle" { "⋮ " (count) " lines left out; what was kept is in run.jsonl" }
            },
            Row::Entry(entry, finding) => html! {
                @if *finding { (marked(y, self.height(row))) }
                @match &entry.what {
                    What::Exchange { sent, got, .. } => (self.exchange(entry, sent.as_deref(), got.as_deref(), y)),
                    _ => (self.boxed(entry).drawn(entry.at, y, self.side)),
                }
            },
        }
    }

    /// Two arrows: to the DUT, and from it.
    fn exchange(&self, entry: &Entry, sent: Option<&str>, got: Option<&str>, y: i32) -> Markup {
        let (side, variant) = (self.side, &self.case.variant);
        let (there, back) = (y + 18, y + 38);
        let wrong = sent.is_none() || !entry.note.is_empty();
        let label = self.ports.behind(&entry.what, &side.sent_label(sent, variant));
        let label = if entry.note.is_empty() { label } else { format!("{label} · {}", entry.note) };
        let answer = self.ports.behind(&entry.what, &side.got_label(got, variant));
        // The tester stands left of an FS-Device and right of an FS-Master.
        let (tester, dut) = (lifeline(side, false), lifeline(side, true));
        let way = if dut > tester { 1 } else { -1 };
        html! {
            text.soft x="0" y=(there) { (milliseconds(entry.at)) " ms" }
            @if entry.count > 1 { text x="0" y=(back) { "x " (entry.count) } }
            @if sent.is_none() {
                path.hit d=(format!("M{tester} {there}H{MIDDLE}")) {}
                (cross(MIDDLE, there))
            } @else if wrong {
                path.hit d=(arrow(tester, dut, there)) {}
                (cross(dut - 26 * way, there))
            } @else {
                path d=(arrow(tester, dut, there)) {}
            }
            @if wrong { text.wrong x=(LABEL) y=(there - 4) { (short(&label, 60)) } }
            @else { text x=(LABEL) y=(there - 4) { (short(&label, 60)) } }
            @if got.is_some() { path d=(arrow(dut, tester, back)) {} }
            text x=(LABEL) y=(back - 4) { (short(&answer, 60)) }
            @if !entry.via.is_empty() { (beside(&entry.via, there + 10, side)) }
        }
    }

    /// What is no exchange, as a box.
    fn boxed<'e>(&self, entry: &'e Entry) -> Boxed<'e> {
        // What is set, switched or asked happens at the DUT; on a port both sides act.
        let x = match entry.what {
            What::Port { dut, .. } => lifeline(self.side, dut),
            _ => lifeline(self.side, true),
        };
        // Right of the right lifeline there is no room beside a box.
        let inside = x == DEVICE && self.side == Side::Device;
        let mut texts = notes(&entry.what, self.ports);
        if let Some(last) = texts.last_mut() {
            if inside && !entry.via.is_empty() {
                *last = format!("{last} {}", entry.via.join(" "));
            }
            if entry.count > 1 {
                *last = format!("{last} x {}", entry.count);
            }
            if !entry.note.is_empty() {
                *last = format!("{last} · {}", entry.note);
            }
        }
        // Between the lifelines there is room for wider texts.
        let most = if x == MASTER && texts.iter().any(|text| text.chars().count() > NARROW.0) { WIDE } else { NARROW };
        let lines = texts.iter().flat_map(|text| wrapped(text, most.0, LINES)).collect();
        Boxed { x, width: most.1, lines, beside: if inside { &[] } else { &entry.via } }
    }
}

/// What is no exchange: lines in a box at a lifeline.
struct Boxed<'e> {
    x: i32,
    width: i32,
    lines: Vec<String>,
    /// Transitions, at the lifeline of the DUT.
    beside: &'e [String],
}

impl Boxed<'_> {
    /// Of its row.
    fn height(&self) -> i32 {
        24 + LINE * (self.lines.len().max(1) as i32 - 1)
    }

    fn drawn(&self, at: u64, y: i32, side: Side) -> Markup {
        html! {
            text.soft x="0" y=(y + 16) { (milliseconds(at)) " ms" }
            rect x=(self.x + 6) y=(y + 3) width=(self.width) height=(self.height() - 6) rx="3" {}
            @for (line, number) in self.lines.iter().zip(0..) { text x=(self.x + 12) y=(y + 16 + LINE * number) { (line) } }
            @if !self.beside.is_empty() { (beside(self.beside, y + 28, side)) }
        }
    }
}

/// Where a side stands: the DUT, or the tester.
const fn lifeline(side: Side, dut: bool) -> i32 {
    match (side, dut) {
        (Side::Device, true) | (Side::Master, false) => DEVICE,
        (Side::Device, false) | (Side::Master, true) => MASTER,
    }
}

/// The row that shows the finding.
fn marked(y: i32, height: i32) -> Markup {
    html! {
        rect.mark x="0" y=(y + 1) width=(WIDTH) height=(height - 2) rx="3" {}
        text.wrong x="116" y=(y + 18) { "finding" }
    }
}

/// Transitions at the lifeline of the DUT, on its far side.
fn beside(via: &[String], y: i32, side: Side) -> Markup {
    match side {
        Side::Device => html! { text.soft x=(DEVICE + 10) y=(y) { (short(&via.join(" "), 34)) } },
        Side::Master => html! {
            // The name of a transition may be two words, which stay on one line.
            @let names: Vec<String> = via.iter().map(|name| name.replace(' ', "\u{A0}")).collect();
            @for (line, number) in wrapped(&names.join(" "), 14, 2).iter().zip(0..) {
                text.soft x=(MASTER - 6) y=(y + 12 * number) text-anchor="end" { (line) }
            }
        },
    }
}

/// A line and its tip in one path; the tip is a part of its own, or the line would be filled up to it.
pub(crate) fn arrow(from: i32, to: i32, y: i32) -> String {
    let back = if to > from { -9 } else { 9 };
    format!("M{from} {y}H{to}M{to} {y}l{back} -4v8z")
}

/// What says falsified on an arrow, and lost at its end.
pub(crate) fn cross(x: i32, y: i32) -> Markup {
    html! { path.cross d=(format!("M{} {} l10 10m0 -10l-10 10", x - 5, y - 5)) {} }
}
