//! Sequence charts of the black channel as an SVG file of their own: FS-Master left, FS-Device right, one row for an exchange.
//! Drawn with the arrows of the charts in a report; readable on light and on dark, nothing fetched.

use crate::chart::{DEVICE, LABEL, MASTER, MIDDLE, WIDTH, arrow, cross};
use crate::plot::PALETTE;
use crate::text::{short, wrapped};
use maud::{Markup, PreEscaped, html};

/// Height of an exchange, and of what stands above the first one.
const ROW: i32 = 46;
const TOP: i32 = 92;
/// Height of the line above exchanges that repeat, and below the last one.
const REPEAT: i32 = 26;
const BOTTOM: i32 = 24;
/// Where in its row an exchange has led to.
const STATE: i32 = 22;
/// Characters of a title, of a label on an arrow, and of a line beside a lifeline.
const TITLE: usize = 112;
const ON_ARROW: usize = 60;
const BESIDE: usize = 34;
/// Charts drawn at most, and exchanges of one.
const CHARTS: usize = 500;
const EXCHANGES: usize = 500;

const STYLE: &str = "
.title { font-weight: 650; font-size: 14px; } .soft { fill: var(--soft); }
.paper { fill: var(--paper); } .life, .rule { stroke: var(--line); } .rule { stroke-dasharray: 4 4; }
path { stroke: var(--ink); fill: var(--ink); stroke-width: 1.2; }
.hit { stroke: var(--bound); fill: var(--bound); stroke-dasharray: 5 3; } .cross { stroke: var(--bound); stroke-width: 2; fill: none; }
.wrong { fill: var(--bound); } .live { fill: var(--curve); font-weight: 650; } .bar { fill: var(--curve); }
.off { fill: var(--mark); font-weight: 650; }
";

/// A chart.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Ladder {
    /// What it shows.
    pub title: String,
    /// What was explored.
    pub about: String,
    /// Its exchanges, in order.
    pub rungs: Vec<Rung>,
    /// How many of them, at the end, repeat for ever.
    pub for_ever: usize,
}

/// One exchange.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Rung {
    /// The SPDU.
    pub spdu: String,
    /// What becomes of it.
    pub there: Way,
    /// The answer.
    pub answer: String,
    /// What becomes of it.
    pub back: Way,
    /// The FS-Master behind it.
    pub master: Beside,
    /// The FS-Device behind it.
    pub device: Beside,
}

/// What becomes of an image on its way.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Way {
    /// There is none.
    Nothing,
    /// It arrives.
    Arrives,
    /// It is lost.
    Lost,
    /// It arrives falsified, with these counter bits.
    Bad(u8),
    /// A stored one arrives in its place, with these counter bits.
    Stored(u8),
}

/// A side behind an exchange.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Beside {
    /// Transitions taken.
    pub transitions: String,
    /// State and inputs; what is no power.
    pub state: String,
    /// Process data in use, by its name.
    pub live: Option<&'static str>,
    /// It has no power.
    pub off: bool,
}

/// The charts below each other, as an SVG document.
pub fn ladders(ladders: &[Ladder]) -> String {
    let ladders = ladders.get(..CHARTS).unwrap_or(ladders);
    let mut height = 0;
    let placed: Vec<(i32, &Ladder)> = ladders
        .iter()
        .map(|ladder| {
            let y = height;
            height += ladder.height();
            (y, ladder)
        })
        .collect();
    let markup = html! {
        svg xmlns="http://www.w3.org/2000/svg" role="img" viewBox=(format!("0 0 {WIDTH} {height}")) {
            title { (ladders.iter().map(|ladder| short(&ladder.title, TITLE)).collect::<Vec<_>>().join("; ")) }
            desc {
                "Each row is one exchange: the SPDU goes to the right, the answer to the left. A dashed arrow with a cross was "
                "falsified, one without a cross carries a stored image, one that ends in the middle was lost. Transitions and the state behind them stand beside the lifelines; "
                "a bar on a lifeline: process data is in use there."
            }
            style { (PreEscaped(PALETTE)) (PreEscaped(STYLE)) }
            rect.paper width=(WIDTH) height=(height) {}
            @for (y, ladder) in placed {
                g transform=(format!("translate(0 {y})")) { (ladder.drawn()) }
            }
        }
    };
    markup.into_string() + "\n"
}

impl Ladder {
    fn rungs(&self) -> &[Rung] {
        self.rungs.get(..EXCHANGES).unwrap_or(&self.rungs)
    }

    /// The first exchange that repeats.
    fn repeats(&self) -> Option<usize> {
        (self.for_ever > 0).then(|| self.rungs.len().saturating_sub(self.for_ever))
    }

    /// Where an exchange begins.
    fn at(&self, number: usize) -> i32 {
        let below = self.repeats().is_some_and(|from| number >= from);
        TOP + ROW * number as i32 + if below { REPEAT } else { 0 }
    }

    fn height(&self) -> i32 {
        self.at(self.rungs().len()) + BOTTOM
    }

    fn drawn(&self) -> Markup {
        let bottom = self.at(self.rungs().len());
        html! {
            text.title x="12" y="24" { (short(&self.title, TITLE)) }
            @for (line, number) in wrapped(&self.about, TITLE, 2).iter().zip(0..) {
                text.soft x="12" y=(42 + 15 * number) { (line) }
            }
            text x=(MASTER) y="78" text-anchor="middle" { "FS-Master" }
            text x=(DEVICE) y="78" text-anchor="middle" { "FS-Device" }
            line.life x1=(MASTER) y1="84" x2=(MASTER) y2=(bottom + STATE) {}
            line.life x1=(DEVICE) y1="84" x2=(DEVICE) y2=(bottom + STATE) {}
            @if let Some(from) = self.repeats() {
                @let y = self.at(from) - REPEAT;
                line.rule x1="12" y1=(y + 6) x2=(WIDTH - 12) y2=(y + 6) {}
                text.soft x="12" y=(y + 21) { "for ever:" }
            }
            @for (number, rung) in self.rungs().iter().enumerate() { (rung.drawn(number + 1, self.at(number))) }
        }
    }
}

impl Rung {
    fn drawn(&self, number: usize, y: i32) -> Markup {
        html! {
            text.soft x="12" y=(y + 18) { (number) }
            @if self.master.live.is_some() { rect.bar x=(MASTER - 2) y=(y + STATE) width="4" height=(ROW) {} }
            @if self.device.live.is_some() { rect.bar x=(DEVICE - 2) y=(y + STATE) width="4" height=(ROW) {} }
            (crossing(&self.spdu, self.there, (MASTER, DEVICE), y + 18))
            (crossing(&self.answer, self.back, (DEVICE, MASTER), y + 38))
            (beside(&self.master, MASTER - 10, "end", y + STATE))
            (beside(&self.device, DEVICE + 10, "start", y + STATE))
        }
    }
}

/// An arrow and what it carries.
fn crossing(text: &str, way: Way, (from, to): (i32, i32), y: i32) -> Markup {
    let label = match way {
        Way::Nothing => return html! { text.soft x=(LABEL) y=(y - 4) { (short(text, ON_ARROW)) } },
        Way::Arrives => short(text, ON_ARROW),
        Way::Lost => short(&format!("{text} LOST"), ON_ARROW),
        Way::Bad(counter) => short(&format!("{text} BAD({counter})"), ON_ARROW),
        Way::Stored(counter) => short(&format!("{text} STORED({counter})"), ON_ARROW),
    };
    html! {
        @match way {
            Way::Lost => { path.hit d=(format!("M{from} {y}H{MIDDLE}")) {} (cross(MIDDLE, y)) },
            Way::Bad(_) => { path.hit d=(arrow(from, to, y)) {} (cross(DEVICE - 26, y)) },
            Way::Stored(_) => path.hit d=(arrow(from, to, y)) {},
            _ => path d=(arrow(from, to, y)) {},
        }
        @if way == Way::Arrives { text x=(LABEL) y=(y - 4) { (label) } }
        @else { text.wrong x=(LABEL) y=(y - 4) { (label) } }
    }
}

/// Transitions, and below them the state.
fn beside(side: &Beside, x: i32, anchor: &str, y: i32) -> Markup {
    html! {
        text.soft x=(x) y=(y) text-anchor=(anchor) { (short(&side.transitions, BESIDE)) }
        @if side.off { text.off x=(x) y=(y + 14) text-anchor=(anchor) { (short(&side.state, BESIDE)) } }
        @else {
            text x=(x) y=(y + 14) text-anchor=(anchor) {
                (short(&side.state, BESIDE))
                @if let Some(live) = side.live { " " tspan.live { (live) } }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rstest::rstest;

    fn side(live: Option<&'static str>) -> Beside {
        Beside { transitions: "T24 T22 T23".to_owned(), state: "24".to_owned(), live, off: false }
    }

    fn rung(there: Way, live: Option<&'static str>) -> Rung {
        let (spdu, answer) = ("4 PDout".to_owned(), "3".to_owned());
        Rung { spdu, there, answer, back: Way::Arrives, master: side(None), device: side(live) }
    }

    fn drawn(rungs: Vec<Rung>, for_ever: usize) -> String {
        ladders(&[Ladder { title: "a < b".to_owned(), about: String::new(), rungs, for_ever }])
    }

    #[rstest]
    #[case::arrives(Way::Arrives, "4 PDout", 0, 0)]
    #[case::lost(Way::Lost, "4 PDout LOST", 1, 1)]
    #[case::falsified(Way::Bad(5), "4 PDout BAD(5)", 1, 1)]
    #[case::stored(Way::Stored(1), "4 PDout STORED(1)", 1, 0)]
    #[case::nothing(Way::Nothing, "4 PDout", 0, 0)]
    fn what_becomes_of_an_spdu_is_drawn(
        #[case] way: Way,
        #[case] label: &str,
        #[case] dashed: usize,
        #[case] crosses: usize,
    ) {
        let svg = drawn(vec![rung(way, None)], 0);
        assert!(svg.contains(&format!(">{label}</text>")), "{svg}");
        assert_eq!(svg.matches("class=\"hit\"").count(), dashed);
        assert_eq!(svg.matches("class=\"cross\"").count(), crosses);
        let ends_in_the_middle = svg.contains(&format!("H{MIDDLE}\""));
        assert_eq!(ends_in_the_middle, way == Way::Lost);
    }

    #[test]
    fn data_in_use_is_a_bar_and_a_word() {
        let svg = drawn(vec![rung(Way::Arrives, Some("PDout_D"))], 0);
        assert_eq!((svg.matches("class=\"bar\"").count(), svg.matches(">PDout_D<").count()), (1, 1));
        assert_eq!(drawn(vec![rung(Way::Arrives, None)], 0).matches("class=\"bar\"").count(), 0);
    }

    #[test]
    fn what_repeats_stands_below_a_line() {
        let rungs = || vec![rung(Way::Arrives, None); 3];
        assert!(drawn(rungs(), 2).contains("for ever:") && !drawn(rungs(), 0).contains("for ever:"));
    }

    #[test]
    fn texts_are_escaped_and_bounded() {
        let hostile = Rung { spdu: "<script>\u{202E}".to_owned() + &"x".repeat(9_000), ..rung(Way::Arrives, None) };
        let svg = drawn(vec![hostile; 2_000], 0);
        assert!(!svg.contains("<script>") && !svg.contains('\u{202E}') && svg.contains("a &lt; b"));
        assert!(svg.len() < 1_000_000, "{} octets", svg.len());
    }
}
