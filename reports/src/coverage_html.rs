//! How far a machine was led, for `report.html`: its state diagram with counts, and what was never taken in a row.

use crate::asked_html;
use crate::coverage::{Coverage, Reached};
use crate::machine::Machine;
use crate::record::Header;
use crate::text::{short, visible as clean};
use maud::{Markup, html};

/// Characters of a name.
const NAME: usize = 120;
/// Names listed of one kind.
const LISTED: usize = 120;
const WIDTH: i32 = 900;
const HEIGHT: i32 = 450;
/// Radius of a state.
const RADIUS: f64 = 21.0;

/// A state of a diagram: its number, whether the machine waits in it, and where it stands.
type State = (u8, bool, (f64, f64));
/// An edge: number of the transition, from, to, how far it bows, and how far its label is off the middle.
type Edge = (u8, u8, u8, (f64, f64), (f64, f64));

/// Both machines have the same shape: a way in, a regular loop above, an exceptional one inside.
const DEVICE: (&[State], &[Edge]) = (
    &[
        (20, false, (50.0, 110.0)),
        (21, true, (170.0, 110.0)),
        (22, false, (300.0, 110.0)),
        (23, false, (560.0, 165.0)),
        (24, true, (790.0, 110.0)),
        (25, false, (500.0, 400.0)),
        (26, true, (670.0, 310.0)),
        (27, false, (500.0, 250.0)),
    ],
    &[
        (20, 20, 21, (0.0, 0.0), (0.0, -32.0)),
        (21, 21, 22, (0.0, 0.0), (0.0, -32.0)),
        (22, 22, 23, (0.0, 0.0), (0.0, 0.0)),
        (23, 23, 24, (0.0, 0.0), (0.0, 0.0)),
        (24, 24, 22, (0.0, -170.0), (0.0, 0.0)),
        (25, 22, 25, (-100.0, 80.0), (0.0, 0.0)),
        (26, 25, 26, (-20.0, -30.0), (12.0, 0.0)),
        (27, 26, 27, (0.0, 0.0), (10.0, -6.0)),
        (28, 27, 23, (0.0, 0.0), (0.0, 0.0)),
        (29, 27, 25, (0.0, 0.0), (0.0, 0.0)),
        (30, 26, 25, (30.0, 60.0), (20.0, 4.0)),
        (31, 24, 25, (150.0, 250.0), (10.0, 0.0)),
    ],
);
const MASTER: (&[State], &[Edge]) = (
    &[
        (0, false, (36.0, 110.0)),
        (1, false, (124.0, 110.0)),
        (2, true, (212.0, 110.0)),
        (3, false, (300.0, 110.0)),
        (4, false, (560.0, 165.0)),
        (5, true, (790.0, 110.0)),
        (6, false, (500.0, 400.0)),
        (7, true, (670.0, 310.0)),
        (8, false, (500.0, 250.0)),
    ],
    &[
        (1, 0, 1, (0.0, 0.0), (0.0, -32.0)),
        (2, 1, 2, (0.0, 0.0), (0.0, -32.0)),
        (3, 2, 3, (0.0, 0.0), (0.0, -32.0)),
        (4, 3, 4, (0.0, 0.0), (0.0, 0.0)),
        (5, 4, 5, (0.0, 0.0), (0.0, 0.0)),
        (6, 5, 3, (0.0, -170.0), (0.0, 0.0)),
        (7, 3, 6, (-100.0, 80.0), (0.0, 0.0)),
        (8, 5, 6, (150.0, 250.0), (10.0, 0.0)),
        (9, 6, 7, (-20.0, -30.0), (12.0, 0.0)),
        (10, 7, 8, (0.0, 0.0), (10.0, -6.0)),
        (11, 8, 4, (0.0, 0.0), (0.0, 0.0)),
        (12, 8, 6, (-60.0, 0.0), (-14.0, 10.0)),
        (13, 8, 6, (40.0, 0.0), (20.0, -26.0)),
        (14, 7, 6, (30.0, 60.0), (20.0, 4.0)),
    ],
);

/// The state diagram of a machine with the count of each transition; nothing for a machine without one.
pub fn diagram(machine: Machine, count: impl Fn(&String) -> Option<u64>) -> Markup {
    let (states, edges) = match machine {
        Machine::FsDevice => DEVICE,
        Machine::FsMaster => MASTER,
        Machine::Ossde => return html! {},
    };
    let counted = |number: u8| count(&format!("T{number}")).unwrap_or(0);
    let at = |wanted: u8| states.iter().find(|(number, ..)| *number == wanted).map_or((0.0, 0.0), |(.., at)| *at);
    let said = |number: u8| match counted(number) {
        0 => format!("T{number} never"),
        count => format!("T{number} × {count}"),
    };
    let words: Vec<String> =
        edges.iter().map(|(number, from, to, ..)| format!("from {from} to {to}: {}", said(*number))).collect();
    html! {
        div.scroll tabindex="0" role="group" aria-label=(format!("State diagram of the {}", machine.title())) {
            svg viewBox=(format!("0 0 {WIDTH} {HEIGHT}")) role="img" {
                title { "States of the " (machine.title()) " and how often each transition was taken" }
                desc { (words.join("; ")) }
                @for (number, from, to, bow, off) in edges {
                    @let curve = Curve::of(at(*from), at(*to), *bow);
                    @let never = counted(*number) == 0;
                    path.edge.hit[never] d=(curve.line()) {}
                    path.hit[never] d=(curve.head()) {}
                    @let (x, y) = curve.middle();
                    @let label = said(*number);
                    @let half = 4.0 * label.chars().count() as f64;
                    rect.under x=(whole(x + off.0 - half)) y=(whole(y + off.1 - 9.0)) width=(whole(2.0 * half)) height="18" {}
                    text.wrong[never] x=(whole(x + off.0)) y=(whole(y + off.1 + 4.0)) text-anchor="middle" { (label) }
                }
                @for (number, waits, (x, y)) in states {
                    circle.state cx=(x) cy=(y) r=(RADIUS) {}
                    @if *waits { circle.state cx=(x) cy=(y) r=(RADIUS - 4.0) {} }
                    text x=(x) y=(y + 4.0) text-anchor="middle" { (number) }
                }
            }
        }
        p.soft { "In a state with two rings the machine waits for an SPDU or for its timer; a dashed transition was never taken." }
    }
}

/// A bowed line from one state to another.
struct Curve {
    from: (f64, f64),
    by: (f64, f64),
    to: (f64, f64),
}

impl Curve {
    fn of(from: (f64, f64), to: (f64, f64), bow: (f64, f64)) -> Curve {
        let by = ((from.0 + to.0) / 2.0 + bow.0, (from.1 + to.1) / 2.0 + bow.1);
        Curve { from: towards(from, by, RADIUS), by, to: towards(to, by, RADIUS + 1.0) }
    }

    fn line(&self) -> String {
        let Curve { from, by, to } = self;
        let [a, b, c, d, e, f] = [from.0, from.1, by.0, by.1, to.0, to.1].map(whole);
        format!("M{a} {b}Q{c} {d} {e} {f}")
    }

    /// The head of the arrow.
    fn head(&self) -> String {
        let back = towards(self.to, self.by, 9.0);
        let (dx, dy) = ((self.to.0 - back.0) * 0.4, (self.to.1 - back.1) * 0.4);
        let [a, b, c, d, e, f] = [self.to.0, self.to.1, back.0 - dy, back.1 + dx, back.0 + dy, back.1 - dx]
            .map(|value| format!("{value:.1}"));
        format!("M{a} {b}L{c} {d}L{e} {f}Z")
    }

    fn middle(&self) -> (f64, f64) {
        let middle = |from: f64, by: f64, to: f64| (from + 2.0 * by + to) / 4.0;
        (middle(self.from.0, self.by.0, self.to.0), middle(self.from.1, self.by.1, self.to.1))
    }
}

/// The point this far from one towards another.
fn towards(from: (f64, f64), to: (f64, f64), distance: f64) -> (f64, f64) {
    let (dx, dy) = (to.0 - from.0, to.1 - from.1);
    let length = dx.hypot(dy).max(1.0);
    (from.0 + dx / length * distance, from.1 + dy / length * distance)
}

fn whole(value: f64) -> i32 {
    value.round() as i32
}

/// What was taken in a row, of what can be.
pub fn in_a_row(coverage: &Coverage, header: &Header) -> Markup {
    let machine = header.machines.iter().find(|machine| machine.role == coverage.role);
    let steps = machine.map(|machine| &machine.steps);
    html! {
        ul {
            @for (kind, reached) in coverage.kinds() {
                li { (reached.said()) " " (kind) " were taken" (missing(reached)) }
            }
        }
        @for (kind, reached) in coverage.kinds() {
            @for (name, said) in reached.contradicting.iter().take(LISTED) {
                p.fail { span.word { "✗ Taken although it cannot be: " } code { (short(name, NAME)) } " of the " (kind) ", " (short(said, 2 * NAME)) ". Either the goals or what was observed is wrong." }
            }
        }
        @if let (Some(asked), Some(machine)) = (&coverage.asked, machine) { (asked_html::table(asked, machine)) }
        details {
            summary { "Pairs of steps, with the number of cases that took them" }
            (pairs_of_steps(coverage, steps.map_or(&[][..], Vec::as_slice)))
        }
    }
}

/// Pairs of steps, with the number of cases that took them, below what the steps are.
pub fn pairs_of_steps(coverage: &Coverage, steps: &[(String, String)]) -> Markup {
    html! {
        @if !steps.is_empty() {
            p.soft { "A step is everything between two waiting states: " @for (name, taken) in steps.iter().take(LISTED) { (short(name, NAME)) " = " (short(taken, NAME)) "; " } }
        }
        ul.cells {
            @for (name, count) in coverage.step_pairs.cases.iter().take(LISTED) {
                li.none[*count == 0] { span.word { (short(name, NAME)) } " " @if *count == 0 { "never" } @else { "in " (count) } }
            }
        }
    }
}

fn missing(reached: &Reached) -> Markup {
    html! {
        @if !reached.missing.is_empty() {
            "; never: "
            @for (place, name) in reached.missing.iter().take(LISTED).enumerate() {
                @if place > 0 { ", " }
                code { (clean(&short(name, NAME))) }
            }
        }
    }
}
