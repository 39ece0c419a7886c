//! A measured value beside its limits: what a ruler and a histogram have in common, and the ruler itself, in SVG.

use crate::measurement::Measurement;
use crate::record::Verdict;
use crate::text::short;
use maud::{Markup, html};

/// Characters of a symbol or a text of a measurement.
pub const NAME: usize = 160;
const WIDTH: f64 = 560.0;
/// Room left and right of the axis, for the label of a limit at its end.
const ASIDE: f64 = 90.0;

/// The sign and the class of a verdict, so that colour is never the only one.
pub const fn mark(verdict: Verdict) -> (&'static str, &'static str) {
    match verdict {
        Verdict::NotApplicable => ("–", "soft"),
        Verdict::Pass => ("✓", "pass"),
        Verdict::Remark => ("●", "remark"),
        Verdict::Inconclusive => ("?", "inconclusive"),
        Verdict::Fail => ("✗", "fail"),
    }
}

/// A linear axis on which limits, guard bands and values have room.
#[derive(Copy, Clone, Debug)]
pub struct Axis {
    from: f64,
    to: f64,
    left: f64,
    right: f64,
}

impl Axis {
    /// An axis for these values, which have equal limits, between two positions of the drawing.
    pub fn of<'m>(values: impl Iterator<Item = &'m Measurement>, left: f64, right: f64) -> Axis {
        let (mut from, mut to) = (f64::INFINITY, 0f64);
        for value in values {
            let off = value.uncertainty as f64;
            // What has no lower limit begins at nothing.
            let lowest = [Some(value.low), Some(value.min.unwrap_or(0))];
            let highest = [Some(value.high.unwrap_or(value.low)), value.max, value.min];
            from = lowest.into_iter().flatten().map(|it| it as f64 - off).fold(from, f64::min);
            to = highest.into_iter().flatten().map(|it| it as f64 + off).fold(to, f64::max);
        }
        let from = if from.is_finite() { from.max(0.0) } else { 0.0 };
        let aside = if to > from { (to - from) * 0.1 } else { (to * 0.1).max(1.0) };
        Axis { from: (from - aside).max(0.0), to: to + aside, left, right }
    }

    /// Where a value stands; never outside the drawing.
    pub fn x(self, value: f64) -> f64 {
        let part = ((value - self.from) / (self.to - self.from)).clamp(0.0, 1.0);
        tenth(self.left + part * (self.right - self.left))
    }

    /// Ends of the axis, in what the values are counted in.
    pub const fn ends(self) -> (f64, f64) {
        (self.from, self.to)
    }

    /// What is permitted, the guard band (limit ± uncertainty, dashed), and the limits with their values below.
    pub fn limits(self, value: &Measurement, uncertainty: u64, top: f64, bottom: f64) -> Markup {
        let x = |limit: Option<u64>, none: f64| limit.map_or(none, |limit| self.x(limit as f64));
        let (min, max) = (x(value.min, self.left), x(value.max, self.right));
        let off = uncertainty as f64;
        let height = bottom - top;
        let limits = [(value.min, "end", -5.0), (value.max, "start", 5.0)];
        let limits = limits.into_iter().filter_map(|(limit, anchor, aside)| Some((limit?, anchor, aside)));
        html! {
            @if value.min.is_some() || value.max.is_some() {
                rect.permitted x=(min) y=(top) width=(tenth((max - min).max(0.0))) height=(height) {}
            }
            @for (limit, anchor, aside) in limits {
                @let at = self.x(limit as f64);
                @if uncertainty > 0 {
                    @let (from, to) = (self.x(limit as f64 - off), self.x(limit as f64 + off));
                    rect.guard x=(from) y=(top) width=(tenth(to - from)) height=(height) {}
                }
                line.limit x1=(at) y1=(top - 5.0) x2=(at) y2=(bottom + 12.0) {}
                text.soft x=(at + aside) y=(bottom + 13.0) text-anchor=(anchor) { (value.show(limit)) }
            }
        }
    }
}

/// As exact as a drawing needs it.
pub fn tenth(position: f64) -> f64 {
    (position * 10.0).round() / 10.0
}

/// `t_RP 750 us (500 us to 1000 us)`.
pub fn told(value: &Measurement) -> String {
    format!("{} {} ({})", short(&value.symbol, NAME), value.value(), value.limits())
}

/// The value on a ruler with its limits: a circle passed, a cross failed, a diamond is anything else.
pub fn ruler(value: &Measurement) -> Markup {
    let axis = Axis::of(std::iter::once(value), ASIDE, WIDTH - ASIDE);
    let (_, class) = mark(value.verdict);
    let off = value.uncertainty as f64;
    let low = axis.x(value.low as f64);
    let high = value.high.map_or(WIDTH - ASIDE, |high| axis.x(high as f64));
    let outer = (axis.x(value.low as f64 - off), axis.x(value.high.map_or(f64::INFINITY, |high| high as f64 + off)));
    let (middle, y) = (tenth(low.midpoint(high)), 20.0);
    html! {
        svg.ruler role="img" viewBox=(format!("0 0 {WIDTH} 48")) {
            title { (told(value)) ": " (crate::summary::verdict_name(value.verdict)) }
            line.rule x1=(ASIDE) y1=(y) x2=(WIDTH - ASIDE) y2=(y) {}
            (axis.limits(value, value.uncertainty, 12.0, 28.0))
            g class=(format!("value {class}")) {
                @if value.uncertainty > 0 {
                    path.edge d=(format!("M{} {}v10m0 -5H{}m0 -5v10", outer.0, y - 5.0, outer.1)) {}
                }
                @if value.high != Some(value.low) {
                    rect.bar x=(low) y=(y - 3.0) width=(tenth((high - low).max(1.0))) height="6" {}
                }
                @if value.high.is_none() { path.edge d=(format!("M{high} {}l7 6l-7 6", y - 6.0)) {} }
                (sign(value.verdict, if value.high.is_none() { low } else { middle }, y))
            }
        }
    }
}

fn sign(verdict: Verdict, x: f64, y: f64) -> Markup {
    match verdict {
        Verdict::Pass | Verdict::NotApplicable => html! { circle cx=(x) cy=(y) r="5" {} },
        Verdict::Fail => {
            html! { path.edge.bold d=(format!("M{} {}l12 12m0 -12l-12 12", tenth(x - 6.0), y - 6.0)) {} }
        }
        Verdict::Remark | Verdict::Inconclusive => {
            html! { path d=(format!("M{x} {}l7 7l-7 7l-7 -7z", y - 7.0)) {} }
        }
    }
}
