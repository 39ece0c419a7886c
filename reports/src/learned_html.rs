//! `learned.html`: the machine of a DUT beside that of the tables, what differs marked.

use crate::html::{NAME, head};
use crate::learned::{Difference, Edge, Learned, Machine, Spdu};
use crate::text::short;
use maud::{DOCTYPE, Markup, html};
use std::collections::BTreeMap;

/// States drawn and listed at most.
const MOST: usize = 64;
/// Differences told.
const TOLD: usize = 40;
/// Of the drawing: width, distance of the layers, radius of a state.
const WIDTH: i32 = 560;
const LAYER: i32 = 96;
const RADIUS: i32 = 17;

/// Where a machine differs: its states, each with inputs.
type Marks = Vec<(usize, usize)>;

/// The page.
pub fn render(learned: &Learned) -> String {
    let Learned { dut, variant, machine, table, differences, .. } = learned;
    let title = format!("fsct learn: {}", short(&dut.product, NAME));
    let [own, theirs] = marks(learned);
    let side = if dut.role == "master" { "FS-Master" } else { "FS-Device" };
    let markup = html! {
        (DOCTYPE)
        html lang="en" {
            (head(&title, ""))
            body {
                main {
                    h1 { (title) }
                    p.soft { "The " (side) " as a tester sees it, learnt from its answers, beside the machine of the tables." }
                    (banner(learned))
                    dl {
                        dt { "DUT" } dd { (short(&dut.url, NAME)) }
                        dt { "Product" } dd { (short(&format!("{} {} {}", dut.vendor, dut.product, dut.version), NAME)) }
                        dt { "Variant" } dd { (short(&format!("{}, {}, PDout {}, PDin {}", variant.edition, variant.mode, variant.pd_out, variant.pd_in), NAME)) }
                        dt { "Asked" } dd { (learned.words) " words, " (learned.inputs_given) " inputs, seed " (learned.seed) }
                        dt { "Exact if" } dd { "it hides no more than " (learned.extra_states) " further state" @if learned.extra_states != 1 { "s" } ", and answers alike every time" }
                    }
                    (told(differences))
                    h2 { "Both machines" }
                    p.soft {
                        "A state stands as low as its shortest word is long. A thick line is the first way to a state, by its first input; a thin "
                        "one stands for every other input that leads there, and a pointer on it tells them. Red and dashed: what differs. Inputs "
                        "that stay where they are stand in the tables below."
                    }
                    div style="display:flex;flex-wrap:wrap" {
                        (drawing("tables", table, &learned.inputs, &theirs))
                        (drawing("DUT", machine, &learned.inputs, &own))
                    }
                    h2 { "DUT, input for input" }
                    (listed(machine, &learned.inputs, &own))
                    h2 { "Tables, input for input" }
                    (listed(table, &learned.inputs, &theirs))
                }
            }
        }
    };
    markup.into_string()
}

/// The places of the differences in the machine of the DUT, and in that of the tables.
fn marks(learned: &Learned) -> [Marks; 2] {
    let place = |difference: &Difference| {
        let last = difference.word.last()?;
        let input = learned.inputs.iter().position(|input| input == last)?;
        Some([(difference.states.0, input), (difference.states.1, input)])
    };
    let places: Vec<[(usize, usize); 2]> = learned.differences.iter().filter_map(place).collect();
    [0, 1].map(|side| places.iter().map(|places| places[side]).collect())
}

fn banner(learned: &Learned) -> Markup {
    let (class, said) = match (learned.differences.len(), &learned.bound) {
        (0, None) => ("pass", "✓ The machine of the tables".to_owned()),
        (0, Some(_)) => ("inconclusive", "? Not learnt to the end".to_owned()),
        (count, _) => ("fail", format!("✗ Differs in {count} place{}", if count == 1 { "" } else { "s" })),
    };
    html! {
        div class=(format!("banner {class}")) role="status" {
            strong { (said) }
            div {
                (learned.machine.states.len()) " states; the tables have " (learned.table.states.len())
                @if let Some(bound) = &learned.bound { ". Ended by a bound: " (short(bound, NAME)) }
            }
        }
    }
}

fn told(differences: &[Difference]) -> Markup {
    html! {
        @if !differences.is_empty() {
            h2 { "What differs" }
            div.scroll tabindex="0" role="group" aria-label="Differences" {
                table {
                    thead { tr { th { "Inputs from the start" } th { "Tables" } th { "DUT" } } }
                    tbody {
                        @for Difference { word, table, dut, .. } in differences.iter().take(TOLD) {
                            tr { td { (short(&word.join(", "), NAME)) } td { (short(table, NAME)) } td.fail { (short(dut, NAME)) } }
                        }
                    }
                }
            }
            @if differences.len() > TOLD { p.soft { (differences.len() - TOLD) " more are in learned.json." } }
        }
    }
}

/// What an edge shows, short.
fn shown(edge: &Edge) -> String {
    let names = edge.shows.as_ref().map(|names| names.join(" "));
    let names = names.map(|names| if names.is_empty() { "·".to_owned() } else { names });
    let text = match (edge.spdu, names) {
        (Spdu::Same, None) => "–".to_owned(),
        (Spdu::Same, Some(names)) => format!("no SPDU, {names}"),
        (Spdu::New, names) => names.unwrap_or_default(),
        (Spdu::OtherCounter, names) => format!("other counter, {}", names.unwrap_or_default()),
    };
    short(&text, NAME)
}

fn listed(machine: &Machine, inputs: &[String], marks: &Marks) -> Markup {
    html! {
        p.soft { "What is shown, and the state behind it; –: nothing new, ·: an SPDU with no flag set and SD." }
        div.scroll tabindex="0" role="group" aria-label="States and inputs" {
            table.matrix {
                thead { tr { th { "State" } @for input in inputs { th { (short(input, NAME)) } } } }
                tbody {
                    @for (state, edges) in machine.states.iter().enumerate().take(MOST) {
                        tr {
                            th scope="row" { (state) }
                            @for (input, edge) in edges.iter().enumerate() {
                                @if marks.contains(&(state, input)) { td.fail { "✗ " (shown(edge)) " → " (edge.next) } }
                                @else { td { (shown(edge)) " → " (edge.next) } }
                            }
                        }
                    }
                }
            }
        }
        (left_out(machine))
    }
}

fn left_out(machine: &Machine) -> Markup {
    let count = machine.states.len().saturating_sub(MOST);
    html! { @if count > 0 { p.soft { (count) " more states are in learned.json." } } }
}

/// Where each state stands, and by which state and input it is first reached.
struct Layout {
    places: BTreeMap<usize, (i32, i32)>,
    first: BTreeMap<usize, (usize, usize)>,
    height: i32,
}

impl Layout {
    /// Layers by the length of the shortest word; in a layer in the order in which they are met.
    fn of(machine: &Machine) -> Layout {
        let mut first = BTreeMap::new();
        let mut layers = vec![vec![0]];
        let mut known = vec![0];
        while let Some(layer) = layers.last().filter(|layer| !layer.is_empty()) {
            let mut next = Vec::new();
            for state in layer {
                for (input, edge) in machine.states.get(*state).into_iter().flatten().enumerate() {
                    if known.len() < MOST && !known.contains(&edge.next) {
                        known.push(edge.next);
                        next.push(edge.next);
                        first.insert(edge.next, (*state, input));
                    }
                }
            }
            layers.push(next);
        }
        layers.pop();
        let mut places = BTreeMap::new();
        for (layer, y) in layers.iter().zip((0..).map(|number| 52 + LAYER * number)) {
            let room = WIDTH / (layer.len() as i32 + 1);
            // A state does not stand right below another, so that lines do not hide behind it.
            let shift = if (y / LAYER) % 2 == 0 { 0 } else { room / 5 };
            places.extend(layer.iter().zip(1..).map(|(state, number)| (*state, (number * room + shift, y))));
        }
        Layout { places, first, height: 52 + LAYER * layers.len() as i32 - LAYER / 3 }
    }
}

fn drawing(name: &str, machine: &Machine, inputs: &[String], marks: &Marks) -> Markup {
    let layout = Layout::of(machine);
    // Every pair of states once, with the inputs that lead from the one to the other.
    let mut ways: BTreeMap<(usize, usize), Vec<usize>> = BTreeMap::new();
    for (state, edges) in machine.states.iter().enumerate() {
        for (input, edge) in edges.iter().enumerate().filter(|(_, edge)| edge.next != state) {
            ways.entry((state, edge.next)).or_default().push(input);
        }
    }
    let title = format!("Machine of the {name}");
    html! {
        div.scroll tabindex="0" role="group" aria-label=(title) {
            svg.messages role="img" viewBox=(format!("0 0 {WIDTH} {}", layout.height)) {
                title { (title) }
                text x=(WIDTH / 2) y="16" text-anchor="middle" { (name) }
                @for ((from, to), by) in &ways {
                    @if let (Some(one), Some(other)) = (layout.places.get(from), layout.places.get(to)) {
                        (way(*one, *other, by, inputs, layout.first.get(to).is_some_and(|first| first.0 == *from), differs(*from, by, marks)))
                    }
                }
                @for (state, (x, y)) in &layout.places {
                    @let different = marks.iter().any(|(marked, _)| marked == state);
                    circle.state.hit[different] cx=(x) cy=(y) r=(RADIUS) style="fill:var(--paper)" {}
                    text x=(x) y=(y + 4) text-anchor="middle" { (state) }
                }
                @for (state, (from, input)) in &layout.first {
                    @if let (Some(one), Some(other), Some(input)) = (layout.places.get(from), layout.places.get(state), inputs.get(*input)) {
                        text.soft x=((one.0 + 2 * other.0) / 3) y=((one.1 + 2 * other.1) / 3 - 6) text-anchor="middle" { (short(input, 24)) }
                    }
                }
            }
        }
        (left_out(machine))
    }
}

fn differs(state: usize, by: &[usize], marks: &Marks) -> bool {
    marks.iter().any(|(marked, input)| *marked == state && by.contains(input))
}

fn way(one: (i32, i32), other: (i32, i32), by: &[usize], inputs: &[String], first: bool, different: bool) -> Markup {
    let names: Vec<&str> = by.iter().filter_map(|input| inputs.get(*input)).map(String::as_str).collect();
    // Bent to one side, so that the ways there and back are two.
    let (dx, dy) = (other.0 - one.0, other.1 - one.1);
    let bend = if first { 0 } else { 6 };
    let (mx, my) = ((one.0 + other.0) / 2 - dy * bend / 40, (one.1 + other.1) / 2 + dx * bend / 40);
    let line = format!("M{} {}Q{mx} {my} {} {}", one.0, one.1, other.0, other.1);
    let style = format!("fill:none;stroke-width:{}", if first { "2" } else { "0.5" });
    html! {
        path.edge.hit[different] d=(line) style=(style) { title { (short(&names.join(", "), NAME)) } }
    }
}
