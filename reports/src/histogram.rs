//! How values of one limit are spread, in SVG, with the limit and its guard band.

use crate::measurement::Measurement;
use crate::record::Verdict;
use crate::ruler::{Axis, tenth};
use maud::{Markup, html};

const BINS: usize = 48;
const WIDTH: f64 = 760.0;
const ASIDE: f64 = 90.0;
/// Of the highest bar, and where bars stand.
const HIGHEST: f64 = 96.0;
const FLOOR: f64 = 124.0;
/// Bars that have their count above them; of more only the highest has.
const COUNTED: usize = 12;

/// How many values of each kind stand in a bar, the worst at the bottom.
#[derive(Copy, Clone, Default)]
struct Bin([u64; 4]);

impl Bin {
    const CLASSES: [&'static str; 4] = ["fail", "inconclusive", "pass", "open"];

    const fn of(value: &Measurement) -> usize {
        match (value.verdict, value.high) {
            (Verdict::Fail, _) => 0,
            (Verdict::Inconclusive, _) => 1,
            (_, Some(_)) => 2,
            // Ended before its end was seen: longer than shown.
            (_, None) => 3,
        }
    }

    fn count(self) -> u64 {
        self.0.iter().sum()
    }
}

/// Where a value stands: in the middle of what it may be, at its beginning when the end is not known.
pub fn middle(value: &Measurement) -> u64 {
    value.low.midpoint(value.high.unwrap_or(value.low))
}

/// The values, all with the same limits; `about` says in words what can be seen.
pub fn histogram(values: &[&Measurement], about: &str) -> Markup {
    let axis = Axis::of(values.iter().copied(), ASIDE, WIDTH - ASIDE);
    let (from, to) = axis.ends();
    let width = (to - from) / BINS as f64;
    let mut bins = [Bin::default(); BINS];
    for value in values {
        let number = ((middle(value) as f64 - from) / width) as usize;
        bins[number.min(BINS - 1)].0[Bin::of(value)] += 1;
    }
    let highest = bins.iter().map(|bin| bin.count()).max().unwrap_or(0).max(1);
    let all = bins.iter().filter(|bin| bin.count() > 0).count() <= COUNTED;
    let uncertainty = values.iter().map(|value| value.uncertainty).max().unwrap_or(0);
    let mut labelled = false;
    html! {
        svg.histogram role="img" viewBox=(format!("0 0 {WIDTH} 152")) {
            title { (about) }
            @if let Some(first) = values.first() { (axis.limits(first, uncertainty, FLOOR - HIGHEST - 8.0, FLOOR)) }
            line x1=(ASIDE) y1=(FLOOR) x2=(WIDTH - ASIDE) y2=(FLOOR) {}
            @for (number, bin) in bins.iter().enumerate().filter(|(_, bin)| bin.count() > 0) {
                @let left = axis.x(from + width * number as f64);
                @let right = axis.x(from + width * (number + 1) as f64);
                @for (top, height, class) in stacked(*bin, highest) {
                    rect class=(format!("value {class}")) x=(left) y=(top) width=(tenth(right - left - 1.0)) height=(height) {}
                }
                @if all || (bin.count() == highest && !std::mem::replace(&mut labelled, true)) {
                    @let top = FLOOR - bin.count() as f64 / highest as f64 * HIGHEST - 5.0;
                    text x=(tenth(left.midpoint(right))) y=(tenth(top)) text-anchor="middle" { (bin.count()) }
                }
            }
        }
    }
}

/// Top, height and class of each part of a bar.
fn stacked(bin: Bin, highest: u64) -> Vec<(f64, f64, &'static str)> {
    let mut floor = FLOOR;
    let parts = bin.0.into_iter().zip(Bin::CLASSES).filter(|(count, _)| *count > 0);
    parts
        .map(|(count, class)| {
            let height = count as f64 / highest as f64 * HIGHEST;
            floor -= height;
            (tenth(floor), tenth(height), class)
        })
        .collect()
}
