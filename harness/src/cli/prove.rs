//! `fsct prove`: what the tables of the SCL can and cannot do, over everything that a black channel, the power and an operator may do.

mod learned;

use super::{USAGE, fail, print};
use fsct_proof::{Line, Model, Outcome, PROPERTIES, Property, Reading, Timing, Verdict, prove_all, reachable, text};
use fsct_protocol::Edition;
use fsct_reports::visible;
use learned::{Product, Products};
use serde_json::{Value, json};
use std::time::Duration;

/// Exit code when something is violated that the tables do not allow by default.
const VIOLATED: u8 = 1;
/// Exit code when a search had to stop before its end.
const UNKNOWN: u8 = 5;

/// Arguments of `fsct prove`.
#[derive(clap::Args, Debug)]
#[command(
    after_help = "Exit codes: 0 every property asked for holds, or goes no further than the tables of both editions allow by default \
                  (\"tables\"); 1 one is violated; 2 usage; 5 more states than --most-states"
)]
pub struct Args {
    /// Edition of the tables: v1.1 or iec2022
    #[arg(long, default_value = "iec2022")]
    edition: Edition,
    /// A reading other than the default, such as A19=sequential; may be given more than once
    #[arg(long = "reading", value_name = "READING")]
    readings: Vec<Reading>,
    /// FSP_Watchdog in exchanges, 2 to 15
    #[arg(long, default_value_t = 4, value_name = "EXCHANGES")]
    watchdog: u8,
    /// P: an exchange returns the answer made before it; I: the answer comes back in the same exchange
    #[arg(long, default_value = "P")]
    timing: Timing,
    /// Most disturbed exchanges: 0 to 14, or unlimited
    #[arg(long, default_value = "unlimited", value_name = "N")]
    faults: Faults,
    /// The FS-Device keeps its power once it has it
    #[arg(long)]
    no_power_cycles: bool,
    /// A property, or the beginning of its name: P2d, P6; may be given more than once [default: all]
    #[arg(long = "property", value_name = "NAME")]
    properties: Vec<String>,
    /// The default and then every reading by itself; some of them are violated
    #[arg(long, conflicts_with = "readings")]
    all: bool,
    /// Most states kept for one property; a state takes some 60 octets
    #[arg(long, default_value_t = Model::MOST_STATES, value_name = "N")]
    most_states: usize,
    /// One JSON document
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    products: Products,
}

/// A number of disturbed exchanges.
#[derive(Copy, Clone, Debug)]
struct Faults(Option<u8>);

impl std::str::FromStr for Faults {
    type Err = String;

    fn from_str(text: &str) -> Result<Faults, String> {
        match (text, text.parse()) {
            ("unlimited", _) => Ok(Faults(None)),
            (_, Ok(count)) => Ok(Faults(Some(count))),
            _ => Err("a number from 0 to 14 or `unlimited` is expected".to_owned()),
        }
    }
}

/// What stands in for the FS-Device, and for the FS-Master.
type Both = (Option<Product>, Option<Product>);
type Proven = (Model, usize, Vec<(Outcome, Duration)>);

/// Runs the command; the result is the exit code.
pub fn run(args: &Args) -> u8 {
    let products = match args.products.read() {
        Ok(products) => products,
        Err(sentence) => return fail(USAGE, sentence),
    };
    match prove(args, &products) {
        Ok(proven) => {
            if args.json {
                print(Value::Array(proven.iter().map(|proven| document(proven, &products)).collect()));
            } else {
                introduce(&products);
                proven.iter().for_each(show);
            }
            proven.iter().flat_map(|(.., outcomes)| outcomes).map(|(outcome, _)| code(outcome)).fold(0, worse)
        }
        Err(sentence) => fail(USAGE, sentence),
    }
}

/// A violation outweighs what is not known.
fn worse(code: u8, other: u8) -> u8 {
    if code == VIOLATED || other == VIOLATED { VIOLATED } else { code.max(other) }
}

fn code(outcome: &Outcome) -> u8 {
    match outcome.verdict {
        Verdict::Holds | Verdict::Tables(_) => 0,
        Verdict::Violated(_) | Verdict::LockUp(..) => VIOLATED,
        Verdict::Unknown => UNKNOWN,
    }
}

fn prove(args: &Args, (device, master): &Both) -> Result<Vec<Proven>, String> {
    let properties = properties(&args.properties)?;
    let model = Model {
        readings: args.readings.clone(),
        watchdog: args.watchdog,
        timing: args.timing,
        faults: args.faults.0,
        power_cycles: !args.no_power_cycles,
        most_states: args.most_states,
        device: device.as_ref().map(|product| product.machine.clone()),
        master: master.as_ref().map(|product| product.machine.clone()),
        ..Model::new(args.edition)
    };
    let mut models = vec![model.clone()];
    if args.all {
        let each = Reading::ALL.into_iter().map(|reading| Model { readings: vec![reading], ..model.clone() });
        models.extend(each.map(|model| {
            let edition = if model.reads(Reading::FirstOne) { Edition::V1_1 } else { model.edition };
            Model { edition, ..model }
        }));
    }
    models.into_iter().map(|model| Ok((model.clone(), reachable(&model)?, prove_all(&model, &properties)?))).collect()
}

fn properties(names: &[String]) -> Result<Vec<&'static Property>, String> {
    let named = |property: &Property, name: &str| {
        property.name.strip_prefix(name).is_some_and(|rest| rest.is_empty() || rest.starts_with('-'))
    };
    if let Some(unknown) = names.iter().find(|name| !PROPERTIES.iter().any(|property| named(property, name))) {
        let known: Vec<_> = PROPERTIES.iter().map(|property| property.name).collect();
        return Err(format!("`{unknown}` is no property; these are: {}", known.join(", ")));
    }
    let wanted = |property: &&Property| names.is_empty() || names.iter().any(|name| named(property, name));
    Ok(PROPERTIES.iter().filter(wanted).collect())
}

/// The products of which something is proven, in their own words.
fn introduce((device, master): &Both) {
    for (role, product) in [("FS-Device", device), ("FS-Master", master)] {
        if let Some(Product { name, machine }) = product {
            print(format!("{role} as learnt: {} ({} states)", visible(name), machine.states.len()));
        }
    }
}

fn show((model, states, outcomes): &Proven) {
    print(format!("{}\n{states} states are reachable\n", described(model)));
    print(row(["property", "verdict", "found", "bound", "states", "depth", "time", "memory"]));
    for (outcome, time) in outcomes {
        let bound = outcome.bound.map_or("-".to_owned(), |bound| bound.to_string());
        print(row([
            outcome.property.name,
            word(&outcome.verdict),
            &outcome.worst.to_string(),
            &bound,
            &outcome.states.to_string(),
            &outcome.depth.to_string(),
            &format!("{} ms", time.as_millis()),
            &format!("{} KiB", outcome.octets.div_ceil(1024)),
        ]));
    }
    print("");
    outcomes.iter().for_each(|(outcome, _)| explain(outcome));
}

fn row([property, verdict, found, bound, states, depth, time, memory]: [&str; 8]) -> String {
    format!("{property:<11} {verdict:<9} {found:>5} {bound:>5} {states:>9} {depth:>5} {time:>9} {memory:>11}")
}

fn word(verdict: &Verdict) -> &'static str {
    match verdict {
        Verdict::Holds => "holds",
        Verdict::Violated(_) => "violated",
        Verdict::Tables(_) => "tables",
        Verdict::LockUp(..) => "lock-up",
        Verdict::Unknown => "unknown",
    }
}

/// What does not simply hold, with a shortest way to see it.
fn explain(outcome: &Outcome) {
    let Property { name, about, clause, tables, .. } = outcome.property;
    let (why, chart) = match &outcome.verdict {
        Verdict::Holds => return,
        Verdict::Violated(lines) => ("Violated".to_owned(), text(lines, None)),
        Verdict::Tables(lines) => {
            (format!("Allowed by the tables of both editions: {}", tables.unwrap_or_default()), text(lines, None))
        }
        Verdict::LockUp(lines, repeats) => ("Operation may never return".to_owned(), text(lines, Some(*repeats))),
        Verdict::Unknown => ("Not known: there are more states than --most-states allows".to_owned(), String::new()),
    };
    print(format!("{name}: {about} ({clause})\n{why}.\n{chart}"));
}

fn described(model: &Model) -> String {
    let readings: Vec<_> = model.readings.iter().map(|reading| reading.name()).collect();
    let readings = if readings.is_empty() { "default readings".to_owned() } else { readings.join(", ") };
    let faults = match model.faults {
        None => "any number of disturbed exchanges".to_owned(),
        Some(1) => "1 disturbed exchange at most".to_owned(),
        Some(count) => format!("{count} disturbed exchanges at most"),
    };
    let power = if model.power_cycles { "power cycles of the FS-Device" } else { "no power cycles" };
    let Model { edition, watchdog, timing, .. } = model;
    format!("edition {edition}, {readings}, FSP_Watchdog of {watchdog} exchanges, timing {timing}, {faults}, {power}")
}

fn document((model, states, outcomes): &Proven, (device, master): &Both) -> Value {
    let line =
        |line: &Line| json!({"spdu": line.spdu, "device": line.device, "answer": line.answer, "master": line.master});
    let lines = |lines: &[Line]| lines.iter().map(line).collect::<Vec<_>>();
    let outcome = |outcome: &Outcome| {
        let (chart, repeats) = match &outcome.verdict {
            Verdict::Violated(chart) | Verdict::Tables(chart) => (lines(chart), None),
            Verdict::LockUp(chart, repeats) => (lines(chart), Some(repeats)),
            Verdict::Holds | Verdict::Unknown => (Vec::new(), None),
        };
        let Property { name, about, clause, measures, tables, .. } = outcome.property;
        json!({
            "property": name, "about": about, "clause": clause, "verdict": word(&outcome.verdict), "tables": tables,
            "measures": measures, "found": outcome.worst, "bound": outcome.bound,
            "states": outcome.states, "steps": outcome.steps, "depth": outcome.depth,
            "chart": chart, "repeats": repeats,
        })
    };
    json!({
        "edition": model.edition.name(),
        "readings": model.readings.iter().map(|reading| reading.name()).collect::<Vec<_>>(),
        "watchdog": model.watchdog,
        "timing": model.timing.to_string(),
        "faults": model.faults,
        "power_cycles": model.power_cycles,
        "device": device.as_ref().map(|product| &product.name),
        "master": master.as_ref().map(|product| &product.name),
        "states": states,
        "properties": outcomes.iter().map(|(one, _)| outcome(one)).collect::<Vec<_>>(),
    })
}
