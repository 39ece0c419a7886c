//! The lines of a case over time, in SVG: L+, C/Q, I/Q and the wake-up, with what was measured and its limits.
//!
//! The time axis is not to scale: a pulse of microseconds stands beside a wait of seconds, so an interval is as wide as the
//! logarithm of its length, and the real times stand below.

use crate::measurement::{Counted, Measurement, time};
use crate::record::{CaseRecord, Entry, Verdict, What};
use crate::ruler::{mark, tenth, told};
use crate::text::short;
use maud::{Markup, html};

/// Instants shown, and lines and measured spans.
const MOST: usize = 18;
const LANES: usize = 8;
const SPANS: usize = 8;
/// Measured spans whose limits have a place of their own on the axis.
const LIMITED: usize = 3;
/// Instants at the beginning when what needs a reader is later.
const HEAD: usize = 6;
const WIDTH: f64 = 900.0;
const LEFT: f64 = 110.0;
const RIGHT: f64 = 880.0;
const TOP: f64 = 10.0;
const LANE: f64 = 34.0;
const SPAN: f64 = 26.0;
/// Names of lines as the record writes them.
const LINES: [&str; 3] = ["L+", "C/Q", "I/Q"];
const WAKE_UP: &str = "wake-up";

/// An edge, or a wake-up pulse.
struct Edge {
    at: u64,
    port: u8,
    line: &'static str,
    level: bool,
}

fn edge(entry: &Entry) -> Option<Edge> {
    let What::Port { port, text, .. } = &entry.what else {
        return None;
    };
    let (line, rest) = text.split_once(' ')?;
    let line = LINES.into_iter().chain([WAKE_UP]).find(|name| *name == line)?;
    let level = match rest {
        "on" | "driven high" | "pulse" => true,
        "off" | "driven low" => false,
        _ => return None,
    };
    Some(Edge { at: entry.at, port: *port, line, level })
}

/// One line of one port: its changes, or its pulses.
struct Lane {
    port: u8,
    line: &'static str,
    changes: Vec<(u64, bool)>,
}

fn lanes(case: &CaseRecord) -> Vec<Lane> {
    let mut lanes: Vec<Lane> = Vec::new();
    for Edge { at, port, line, level } in case.trace.iter().filter_map(edge) {
        let found = lanes.iter().position(|lane| lane.port == port && lane.line == line).unwrap_or_else(|| {
            lanes.push(Lane { port, line, changes: Vec::new() });
            lanes.len() - 1
        });
        let changes = &mut lanes[found].changes;
        let same = |last: &(u64, bool)| if line == WAKE_UP { last.0 == at } else { last.1 == level };
        // What the tester drives is what the DUT then sees: one edge.
        if !changes.last().is_some_and(same) {
            changes.push((at, level));
        }
    }
    let place = |line| LINES.iter().position(|name| *name == line).unwrap_or(LINES.len());
    lanes.sort_by_key(|lane| (lane.port, place(lane.line)));
    lanes
}

/// Instants that are shown, in order, and where they stand.
struct Axis {
    times: Vec<(u64, f64)>,
    /// The instant before which some are left out, and how many; behind all of them: at the end.
    gap: Option<(usize, usize)>,
}

impl Axis {
    fn of(mut all: Vec<u64>, reader: Option<u64>) -> Axis {
        all.sort_unstable();
        all.dedup();
        let count = all.len();
        let mut gap = None;
        if count > MOST {
            let wanted = reader.and_then(|at| all.iter().position(|time| *time == at)).unwrap_or(0);
            // The window ends behind what needs a reader.
            let upto = (wanted + 4).clamp(MOST, count);
            let head = if upto == MOST { MOST } else { HEAD };
            let window = all[upto - (MOST - head)..upto].to_vec();
            all.truncate(head);
            all.extend(window);
            gap = Some((head, count - MOST));
        }
        let weight = |pair: &[u64]| 2.0 + (pair[1].saturating_sub(pair[0]) as f64 / 1e3).max(1.0).log10();
        let sum: f64 = all.windows(2).map(weight).sum::<f64>().max(1.0);
        let mut x = LEFT + 14.0;
        let steps = std::iter::once(0.0).chain(all.windows(2).map(|pair| weight(pair) / sum * (RIGHT - 40.0 - x)));
        let steps: Vec<f64> = steps.collect();
        let place = |(time, step): (&u64, f64)| {
            x += step;
            (*time, tenth(x))
        };
        let times = all.iter().zip(steps).map(place).collect();
        Axis { times, gap }
    }

    fn shows(&self, at: u64) -> bool {
        self.times.iter().any(|(time, _)| *time == at)
    }

    /// Where a time stands, between the instants beside it.
    fn x(&self, at: u64) -> f64 {
        let next = self.times.partition_point(|(time, _)| *time < at);
        match (next.checked_sub(1).and_then(|before| self.times.get(before)), self.times.get(next)) {
            (_, Some((time, x))) if *time == at => *x,
            (Some((from, left)), Some((to, right))) => {
                tenth(left + (at - from) as f64 / (to - from) as f64 * (right - left))
            }
            (None, _) => LEFT,
            (_, None) => RIGHT,
        }
    }
}

/// The end of a measured time as far as it is known.
fn end(value: &Measurement) -> u64 {
    value.at_ns.saturating_add(value.high.unwrap_or(value.low))
}

/// The timing diagram of a case, nothing where its lines stayed as they were.
pub fn timing(case: &CaseRecord) -> Markup {
    let mut lanes = lanes(case);
    let edges: Vec<u64> = lanes.iter().flat_map(|lane| lane.changes.iter().map(|(at, _)| *at)).collect();
    if edges.iter().all(|at| Some(at) == edges.first()) {
        return html! {};
    }
    // Times of watchdogs run from exchange to exchange, not between edges.
    let at_edges = |value: &&Measurement| {
        value.counted == Counted::Nanoseconds
            && edges.contains(&value.at_ns)
            && (edges.contains(&end(value)) || value.high != Some(value.low))
    };
    let spans: Vec<&Measurement> = case.measurements.iter().filter(at_edges).collect();
    let reader = spans.iter().find(|value| value.verdict > Verdict::Pass).map(|value| end(value));
    let mut times = edges.clone();
    times.extend(spans.iter().map(|value| end(value)));
    // The limits of what needs a reader most are instants too, or a limit just missed would not be seen.
    let mut first = spans.clone();
    first.sort_by_key(|value| std::cmp::Reverse(value.verdict));
    let limits = |value: &&Measurement| [value.min, value.max].map(|it| it.map(|it| value.at_ns.saturating_add(it)));
    times.extend(first.iter().take(LIMITED).flat_map(limits).flatten());
    let axis = Axis::of(times, reader);
    let shown = |value: &&&Measurement| axis.shows(value.at_ns) && axis.shows(end(value));
    let mut spans: Vec<&Measurement> = spans.iter().filter(shown).copied().collect();
    spans.sort_by_key(|value| std::cmp::Reverse(value.verdict));
    spans.truncate(SPANS);
    spans.sort_by_key(|value| (value.at_ns, end(value)));
    let more_lanes = lanes.len().saturating_sub(LANES);
    lanes.truncate(LANES);
    let below = TOP + LANE * lanes.len() as f64;
    let height = below + 78.0 + SPAN * spans.len() as f64;
    html! {
        p.soft {
            "Lines over time, not to scale; shaded is what the limits of a measured time permit."
            @if let Some((_, left_out)) = axis.gap { " " (left_out) " instants are left out." }
            @if case.elided > 0 { " The record itself left out " (case.elided) " entries." }
            @if more_lanes > 0 { " " (more_lanes) " more lines are not drawn." }
        }
        div.scroll tabindex="0" role="group" aria-label="Timing diagram" {
            svg.timing role="img" viewBox=(format!("0 0 {WIDTH} {height}")) {
                title { "Lines of " (short(&case.key, 120)) " over time" }
                desc { (lanes.iter().map(|lane| told_lane(lane, &axis)).collect::<Vec<_>>().join("; ")) }
                @for (_, x) in &axis.times { line.grid x1=(x) y1=(TOP) x2=(x) y2=(height - 4.0) {} }
                @for (lane, number) in lanes.iter().zip(0..) { (drawn(lane, &axis, TOP + LANE * f64::from(number))) }
                @for (at, x) in &axis.times {
                    text x=(x) y=(below + 14.0) text-anchor="end" transform=(format!("rotate(-40 {x} {})", below + 14.0)) { (time(*at)) }
                }
                @if let Some((place, left_out)) = axis.gap {
                    @let x = axis.times.get(place).map_or(RIGHT - 14.0, |(_, x)| *x - 10.0);
                    text.soft x=(x) y=(below - 2.0) text-anchor="middle" { "⋯ " (left_out) }
                }
                @for (value, number) in spans.iter().zip(0..) { (span(value, &axis, below + 84.0 + SPAN * f64::from(number))) }
            }
        }
    }
}

fn name(lane: &Lane) -> String {
    if lane.port == 1 { lane.line.to_owned() } else { format!("port {} {}", lane.port, lane.line) }
}

fn told_lane(lane: &Lane, axis: &Axis) -> String {
    let shown = lane.changes.iter().filter(|(at, _)| axis.shows(*at)).take(3 * MOST);
    let word = |level| {
        if lane.line == WAKE_UP {
            "at"
        } else if level {
            "on at"
        } else {
            "off at"
        }
    };
    let changes: Vec<String> = shown.map(|(at, level)| format!("{} {}", word(*level), time(*at))).collect();
    format!("{} {}", name(lane), changes.join(", "))
}

fn drawn(lane: &Lane, axis: &Axis, top: f64) -> Markup {
    let y = |level: bool| if level { top + 6.0 } else { top + 26.0 };
    let pulses = lane.line == WAKE_UP;
    let before = !pulses && lane.changes.first().is_some_and(|(_, level)| !level);
    let mut path = format!("M{LEFT} {}", y(before));
    let (mut aside, mut last) = (0.0, None);
    for (at, level) in lane.changes.iter().filter(|(at, _)| axis.shows(*at)).take(3 * MOST) {
        // Edges of one instant stand beside each other.
        aside = if last == Some(*at) { aside + 3.0 } else { 0.0 };
        last = Some(*at);
        let x = tenth(axis.x(*at) + aside);
        path += &if pulses { format!("H{x}V{}h4V{}", y(true), y(false)) } else { format!("H{x}V{}", y(*level)) };
    }
    path += &format!("H{RIGHT}");
    html! {
        text x="4" y=(top + 21.0) { (name(lane)) }
        path.wave d=(path) {}
    }
}

/// A measured time as a dimension arrow, with what its limits permit.
fn span(value: &Measurement, axis: &Axis, y: f64) -> Markup {
    let (_, class) = mark(value.verdict);
    let (from, to) = (axis.x(value.at_ns), axis.x(end(value)));
    let limit = |limit: u64| axis.x(value.at_ns.saturating_add(limit));
    let permitted = (value.min.map_or(from, limit), value.max.map_or(RIGHT, limit));
    let (x, anchor) = if from.midpoint(to) < 0.4 * WIDTH { (to + 8.0, "start") } else { (from - 8.0, "end") };
    html! {
        @if value.min.is_some() || value.max.is_some() {
            rect.permitted x=(permitted.0) y=(y - 7.0) width=(tenth((permitted.1 - permitted.0).max(0.0))) height="14" {}
        }
        @for at in [value.min, value.max].into_iter().flatten().map(limit).filter(|x| *x < RIGHT) { line.limit x1=(at) y1=(y - 8.0) x2=(at) y2=(y + 8.0) {} }
        g class=(format!("value {class}")) {
            path d=(format!("M{from} {y}H{to}M{from} {y}l6 -3v6z")) {}
            @if value.high.is_some() { path d=(format!("M{to} {y}l-6 -3v6z")) {} }
            @else { path.edge d=(format!("M{to} {y}h8m-4 -4l4 4l-4 4")) {} }
        }
        text x=(x) y=(y + 4.0) text-anchor=(anchor) { (mark(value.verdict).0) " " (told(value)) }
    }
}
