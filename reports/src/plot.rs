//! Curves over two logarithmic axes, as an SVG file of its own: readable on light and on dark, nothing fetched.

use crate::ruler::tenth;
use crate::text::short;
use maud::{Markup, PreEscaped, html};

const WIDTH: f64 = 860.0;
const HEIGHT: f64 = 470.0;
const LEFT: f64 = 64.0;
const RIGHT: f64 = 30.0;
const TOP: f64 = 44.0;
const BOTTOM: f64 = 52.0;
/// Characters of a label.
const LABEL: usize = 80;
/// Room that the label at a curve needs.
const ROOM: f64 = 22.0;

/// Colours and letters of drawings that are files of their own.
pub(crate) const PALETTE: &str = "
svg { --ink: #1c2430; --soft: #5b6675; --line: #d5dbe3; --paper: #fff; --curve: #0b5cad; --bound: #b3261e; --mark: #8a6100; }
@media (prefers-color-scheme: dark) {
  svg { --ink: #e4e9f0; --soft: #9aa6b5; --line: #37414e; --paper: #14191f; --curve: #7fb8f0; --bound: #ff8a80; --mark: #e0b252; }
}
text { font: 12px ui-monospace, 'DejaVu Sans Mono', monospace; fill: var(--ink); }
";

const STYLE: &str = "
.title { font-weight: 650; font-size: 14px; } .soft { fill: var(--soft); }
.paper { fill: var(--paper); } .grid { stroke: var(--line); } .frame { fill: none; stroke: var(--soft); }
.curve { fill: none; stroke: var(--curve); stroke-width: 1.3; }
.bound { fill: none; stroke: var(--bound); stroke-width: 1.6; stroke-dasharray: 7 4; } text.bound { stroke: none; fill: var(--bound); }
.number { fill: var(--curve); paint-order: stroke; stroke: var(--paper); stroke-width: 4px; }
.mark { fill: var(--mark); stroke: none; }
.measured path { fill: none; stroke: var(--ink); } .measured circle { fill: var(--ink); }
";

/// One drawing: curves with the bounds they are held against.
#[derive(Clone, Debug, PartialEq)]
pub struct Plot {
    /// What is seen.
    pub title: String,
    /// Names of the horizontal and the vertical axis.
    pub axes: (String, String),
    /// Ends of the horizontal axis, above 0.
    pub x: (f64, f64),
    /// Ends of the vertical axis, above 0; what lies outside is not drawn.
    pub y: (f64, f64),
    /// The curves.
    pub curves: Vec<Curve>,
    /// Dashed lines.
    pub bounds: Vec<Bound>,
    /// What was measured.
    pub measured: Vec<Measured>,
}

/// A curve.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// In short, beside the curve where there is room.
    pub number: String,
    /// In full, shown when pointed at.
    pub about: String,
    /// From left to right.
    pub points: Vec<(f64, f64)>,
    /// A place that deserves a dot.
    pub mark: Option<(f64, f64)>,
}

/// A measured value with the interval that holds the true one.
#[derive(Clone, Debug, PartialEq)]
pub struct Measured {
    /// In full, shown when pointed at.
    pub about: String,
    /// Where on the horizontal axis.
    pub at: f64,
    /// The value; nothing is drawn of one outside the drawing but its interval.
    pub value: f64,
    /// The interval.
    pub interval: (f64, f64),
}

/// A level that holds from the left end up to `upto`.
#[derive(Clone, Debug, PartialEq)]
pub struct Bound {
    /// What it is.
    pub label: String,
    /// The value.
    pub level: f64,
    /// Where it ends, with a drop line if that is inside the drawing.
    pub upto: f64,
}

/// The plots below each other, as an SVG document.
pub fn plots(plots: &[Plot]) -> String {
    let height = HEIGHT * plots.len() as f64;
    let markup = html! {
        svg xmlns="http://www.w3.org/2000/svg" role="img" viewBox=(format!("0 0 {WIDTH} {height}")) {
            title { (plots.iter().map(|plot| short(&plot.title, LABEL)).collect::<Vec<_>>().join("; ")) }
            style { (PreEscaped(PALETTE)) (PreEscaped(STYLE)) }
            rect.paper width=(WIDTH) height=(height) {}
            @for (number, plot) in plots.iter().enumerate() {
                g transform=(format!("translate(0 {})", HEIGHT * number as f64)) { (plot.draw()) }
            }
        }
    };
    markup.into_string() + "\n"
}

impl Plot {
    fn place(&self, (x, y): (f64, f64)) -> (f64, f64) {
        let part = |value: f64, (from, to): (f64, f64)| (value.log10() - from.log10()) / (to.log10() - from.log10());
        let across = LEFT + part(x, self.x) * (WIDTH - LEFT - RIGHT);
        let up = HEIGHT - BOTTOM - part(y, self.y) * (HEIGHT - TOP - BOTTOM);
        (tenth(across), tenth(up))
    }

    fn draw(&self) -> Markup {
        let ((left, bottom), (right, top)) = (self.place((self.x.0, self.y.0)), self.place((self.x.1, self.y.1)));
        html! {
            text.title x=(LEFT) y="24" { (short(&self.title, LABEL)) }
            @for power in decades(self.x) {
                @let (x, _) = self.place((10f64.powi(power), self.y.0));
                line.grid x1=(x) y1=(top) x2=(x) y2=(bottom) {}
                text.soft x=(x) y=(bottom + 17.0) text-anchor="middle" { "1E" (power) }
            }
            @for power in decades(self.y) {
                @let (_, y) = self.place((self.x.0, 10f64.powi(power)));
                line.grid x1=(left) y1=(y) x2=(right) y2=(y) {}
                @if power % 2 == 0 { text.soft x=(left - 6.0) y=(y + 4.0) text-anchor="end" { "1E" (power) } }
            }
            rect.frame x=(left) y=(top) width=(tenth(right - left)) height=(tenth(bottom - top)) {}
            text.soft x=(tenth(left.midpoint(right))) y=(bottom + 38.0) text-anchor="middle" { (short(&self.axes.0, LABEL)) }
            text.soft x=(left + 6.0) y=(top + 16.0) { (short(&self.axes.1, LABEL)) }
            @for curve in &self.curves { (self.curve(curve)) }
            @for bound in &self.bounds { (self.bound(bound)) }
            @for measured in &self.measured { (self.measured(measured)) }
            (self.numbers())
        }
    }

    fn visible<'c>(&self, curve: &'c Curve) -> impl Iterator<Item = (f64, f64)> + use<'_, 'c> {
        let inside = |(value, (from, to)): (f64, (f64, f64))| (from..=to).contains(&value);
        curve.points.iter().copied().filter(move |(x, y)| inside((*x, self.x)) && inside((*y, self.y)))
    }

    fn curve(&self, curve: &Curve) -> Markup {
        let points: Vec<String> =
            self.visible(curve).map(|point| self.place(point)).map(|(x, y)| format!("{x} {y}")).collect();
        html! {
            @if points.len() > 1 {
                path.curve d=(format!("M{}", points.join("L"))) { title { (short(&curve.about, 2 * LABEL)) } }
            }
            @if let Some((x, y)) = curve.mark.map(|mark| self.place(mark)) {
                circle.mark cx=(x) cy=(y) r="3" { title { (short(&curve.about, 2 * LABEL)) } }
            }
        }
    }

    fn bound(&self, bound: &Bound) -> Markup {
        let ((left, y), (right, bottom)) =
            (self.place((self.x.0, bound.level)), self.place((bound.upto.min(self.x.1), self.y.0)));
        // A label below a level that ends, above one that does not: two near each other stay readable.
        let ends = bound.upto < self.x.1;
        let (drop, beside) = if ends { (format!("V{bottom}"), 14.0) } else { (String::new(), -5.0) };
        html! {
            path.bound d=(format!("M{left} {y}H{right}{drop}")) {}
            text.bound x=(left + 6.0) y=(tenth(y + beside)) { (short(&bound.label, LABEL)) }
        }
    }

    fn measured(&self, measured: &Measured) -> Markup {
        let inside = |value: f64| value.clamp(self.y.0, self.y.1);
        let (low, high) = (inside(measured.interval.0), inside(measured.interval.1));
        let ((x, bottom), (_, top)) = (self.place((measured.at, low)), self.place((measured.at, high)));
        let (left, right) = (tenth(x - 3.0), tenth(x + 3.0));
        html! {
            g.measured {
                title { (short(&measured.about, 2 * LABEL)) }
                path d=(format!("M{left} {bottom}H{right}M{x} {bottom}V{top}M{left} {top}H{right}")) {}
                @if inside(measured.value) == measured.value {
                    @let (_, y) = self.place((measured.at, measured.value));
                    circle cx=(x) cy=(y) r="2.5" {}
                }
            }
        }
    }

    /// Beside the lower end of each curve, left out where another number is too near.
    fn numbers(&self) -> Markup {
        let ends = self.curves.iter().filter_map(|curve| Some((self.place(self.visible(curve).next()?), curve)));
        let mut ends: Vec<_> = ends.collect();
        ends.sort_by(|one, other| one.0.0.total_cmp(&other.0.0));
        let mut free = f64::NEG_INFINITY;
        ends.retain(|((x, _), _)| {
            let fits = *x >= free;
            if fits {
                free = x + ROOM;
            }
            fits
        });
        html! {
            @for ((x, y), curve) in ends {
                text.number x=(x) y=(tenth(y - 6.0)) text-anchor="middle" { (short(&curve.number, LABEL)) }
            }
        }
    }
}

/// The powers of ten on an axis.
fn decades((from, to): (f64, f64)) -> std::ops::RangeInclusive<i32> {
    from.log10().ceil() as i32..=to.log10().floor() as i32
}
