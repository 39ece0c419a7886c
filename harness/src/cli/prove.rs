//! `fsct prove`: what the tables of the SCL can and cannot do, over everything that a black channel, the power and an operator may do.

mod learned;
mod matrix;
mod tolerances;

use super::{Cases, RIG, USAGE, fail, print};
use crate::charts;
use fsct_proof::{
    Line, Model, Outcome, PROPERTIES, Property, Reading, Timers, Timing, Verdict, prove_all, reachable, text,
};
use fsct_protocol::Edition;
use fsct_reports::visible;
use learned::{Product, Products};
use serde_json::{Value, json};
use std::path::Path;
use std::path::PathBuf;
use std::time::Duration;

/// Exit code when something is violated that the tables do not allow by default.
const VIOLATED: u8 = 1;
/// Exit code when a search had to stop before its end.
const UNKNOWN: u8 = 5;

/// Options that `--tolerances` and `--matrix` choose themselves.
const OTHERS: [&str; 19] = [
    "device",
    "master",
    "emit",
    "svg",
    "edition",
    "readings",
    "master_readings",
    "device_readings",
    "mixed",
    "timing",
    "timers",
    "storing",
    "storing_answers",
    "faults",
    "no_power_cycles",
    "master_restart",
    "properties",
    "all",
    "most_states",
];

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
    /// A reading of the FS-Master alone; may be given more than once
    #[arg(long = "master-reading", value_name = "READING")]
    master_readings: Vec<Reading>,
    /// A reading of the FS-Device alone; may be given more than once
    #[arg(long = "device-reading", value_name = "READING")]
    device_readings: Vec<Reading>,
    /// In each exchange a machine follows whichever of its readings it likes, or none
    #[arg(long)]
    mixed: bool,
    /// FSP_Watchdog in exchanges, 2 to 15
    #[arg(long, default_value_t = 4, value_name = "EXCHANGES")]
    watchdog: u8,
    /// P: an exchange returns the answer made before it; I: the answer comes back in the same exchange
    #[arg(long, default_value = "P")]
    timing: Timing,
    /// counted: a timer expires after FSP_Watchdog; nd: a running timer may expire in any exchange
    #[arg(long, default_value = "counted")]
    timers: Timers,
    /// The channel stores SPDUs: one presented up to so many exchanges ago, 0 to 15, may reach the FS-Device
    #[arg(long, default_value_t = 0, value_name = "EXCHANGES")]
    storing: u8,
    /// The same for answers on their way to the FS-Master
    #[arg(long, default_value_t = 0, value_name = "EXCHANGES")]
    storing_answers: u8,
    /// Most disturbed exchanges: 0 to 14, or unlimited
    #[arg(long, default_value = "unlimited", value_name = "N")]
    faults: Faults,
    /// The FS-Device keeps its power once it has it
    #[arg(long)]
    no_power_cycles: bool,
    /// The FS-Master may start anew at any time
    #[arg(long)]
    master_restart: bool,
    /// A property, or the beginning of its name: P2d, P6; may be given more than once [default: all]
    #[arg(long = "property", value_name = "NAME")]
    properties: Vec<String>,
    /// The default and then every reading by itself; some of them are violated
    #[arg(long, conflicts_with_all = ["readings", "master_readings", "device_readings"])]
    all: bool,
    /// Which readings a product may follow: P1 to P5 for each against every partner that may be met
    #[arg(long, conflicts_with_all = OTHERS)]
    tolerances: bool,
    /// With --tolerances: as testcases/readings.yaml holds them
    #[arg(long, requires = "tolerances", conflicts_with = "json")]
    yaml: bool,
    /// P1 to P5 for many readings, watchdogs of 2 to 6 exchanges and both timings
    #[arg(long, value_name = "WHICH", conflicts_with_all = OTHERS, conflicts_with_all = ["watchdog", "tolerances"])]
    matrix: Option<matrix::Which>,
    /// Most states kept for one property; a state takes some 60 octets
    #[arg(long, default_value_t = Model::MOST_STATES, value_name = "N")]
    most_states: usize,
    /// One JSON document
    #[arg(long)]
    json: bool,
    /// Write every chart as a case into this file of cases, for `fsct run FILE`
    #[arg(long, value_name = "FILE", conflicts_with_all = BEYOND)]
    emit: Option<PathBuf>,
    /// Draw every chart into this SVG file
    #[arg(long, value_name = "FILE")]
    svg: Option<PathBuf>,
    #[command(flatten)]
    cases: Cases,
    #[command(flatten)]
    products: Products,
}

/// Options whose charts are no cases: no DUT is led through what the standard excludes, what no one clock does, or what one product did.
const BEYOND: [&str; 9] = [
    "storing",
    "storing_answers",
    "master_restart",
    "timers",
    "mixed",
    "master_readings",
    "device_readings",
    "device",
    "master",
];

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
    if let Some(which) = args.matrix {
        return matrix::run(which, args.json);
    }
    if args.tolerances {
        let form = match (args.json, args.yaml) {
            (true, _) => tolerances::Form::Json,
            (false, true) => tolerances::Form::Yaml,
            (false, false) => tolerances::Form::Text,
        };
        return tolerances::run(args.watchdog, form);
    }
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
            match write(args, &proven) {
                Ok(()) => {
                    proven.iter().flat_map(|(.., outcomes)| outcomes).map(|(outcome, _)| code(outcome)).fold(0, worse)
                }
                Err(code) => code,
            }
        }
        Err(sentence) => fail(USAGE, sentence),
    }
}

/// Every chart as a case and as a drawing, as asked for. Without a chart nothing is written: an empty suite would only look like one.
fn write(args: &Args, proven: &[Proven]) -> Result<(), u8> {
    let charted = charted(proven);
    if let Some(file) = &args.emit {
        let library = args.cases.load()?;
        put(file, charts::emit(&charted, &library.coverage, &command(args)))?;
    }
    match &args.svg {
        Some(file) => put(file, charts::draw(&charted, described)),
        None => Ok(()),
    }
}

fn put(file: &Path, text: Option<String>) -> Result<(), u8> {
    match text.map(|text| std::fs::write(file, text)) {
        None => {
            let holds = format!("nothing is violated, so there is no chart to write to {}", file.display());
            eprintln!("fsct: {}", visible(&holds));
            Ok(())
        }
        Some(Ok(())) => Ok(()),
        Some(Err(error)) => Err(fail(RIG, format!("{} cannot be written: {error}", file.display()))),
    }
}

fn charted(proven: &[Proven]) -> Vec<(&Model, &Outcome)> {
    proven.iter().flat_map(|(model, _, outcomes)| outcomes.iter().map(move |(outcome, _)| (model, outcome))).collect()
}

/// The command that makes these cases, without what is the default.
fn command(args: &Args) -> String {
    let mut command = "fsct prove".to_owned();
    let mut add = |name: &str, value: &str| {
        command += &format!(" --{name}");
        if !value.is_empty() {
            command += &format!(" {value}");
        }
    };
    let default = Model::new(args.edition);
    if args.edition != Edition::Iec2022 {
        add("edition", args.edition.name());
    }
    args.readings.iter().for_each(|reading| add("reading", reading.name()));
    if args.watchdog != default.watchdog {
        add("watchdog", &args.watchdog.to_string());
    }
    if args.timing != default.timing {
        add("timing", &args.timing.to_string());
    }
    if let Some(count) = args.faults.0 {
        add("faults", &count.to_string());
    }
    if args.no_power_cycles {
        add("no-power-cycles", "");
    }
    args.properties.iter().for_each(|property| add("property", property));
    if args.all {
        add("all", "");
    }
    add("emit", "");
    command
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
    let model = Model {
        readings: args.readings.clone(),
        master_readings: args.master_readings.clone(),
        device_readings: args.device_readings.clone(),
        mixed: args.mixed,
        watchdog: args.watchdog,
        timing: args.timing,
        timers: args.timers,
        storing: args.storing,
        storing_answers: args.storing_answers,
        master_restart: args.master_restart,
        faults: args.faults.0,
        power_cycles: !args.no_power_cycles,
        most_states: args.most_states,
        device: device.as_ref().map(|product| product.machine.clone()),
        master: master.as_ref().map(|product| product.machine.clone()),
        ..Model::new(args.edition)
    };
    let properties = properties(&args.properties, &model)?;
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

/// Those named, or all that can be asked of the model.
fn properties(names: &[String], model: &Model) -> Result<Vec<&'static Property>, String> {
    let named = |property: &Property, name: &str| {
        property.name.strip_prefix(name).is_some_and(|rest| rest.is_empty() || rest.starts_with('-'))
    };
    if let Some(unknown) = names.iter().find(|name| !PROPERTIES.iter().any(|property| named(property, name))) {
        let known: Vec<_> = PROPERTIES.iter().map(|property| property.name).collect();
        return Err(format!("`{unknown}` is no property; these are: {}", known.join(", ")));
    }
    let wanted = |property: &&Property| {
        let alone = names.iter().any(|name| name == property.name);
        alone
            || property.not_asked(model).is_none()
                && (names.is_empty() || names.iter().any(|name| named(property, name)))
    };
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
    let readings = readings(model);
    let readings = if readings.is_empty() { "default readings".to_owned() } else { readings.join(", ") };
    let readings = if model.mixed { format!("any mixture of {readings}") } else { readings };
    let faults = match model.faults {
        None => "any number of disturbed exchanges".to_owned(),
        Some(1) => "1 disturbed exchange at most".to_owned(),
        Some(count) => format!("{count} disturbed exchanges at most"),
    };
    let power = if model.power_cycles { "power cycles of the FS-Device" } else { "no power cycles" };
    let Model { edition, watchdog, timing, storing, storing_answers, .. } = model;
    let mut more = String::new();
    for (stored, what) in [(*storing, "SPDUs"), (*storing_answers, "answers")] {
        if stored > 0 {
            more += &format!(", {what} stored for {stored} exchanges");
        }
    }
    if model.master_restart {
        more += ", restarts of the FS-Master";
    }
    if model.timers == Timers::Any {
        return format!(
            "edition {edition}, {readings}, timers that expire at any time, timing {timing}, {faults}, {power}{more}"
        );
    }
    format!(
        "edition {edition}, {readings}, FSP_Watchdog of {watchdog} exchanges, timing {timing}, {faults}, {power}{more}"
    )
}

fn readings(model: &Model) -> Vec<String> {
    let both = model.readings.iter().map(ToString::to_string);
    let masters = model.master_readings.iter().map(|reading| format!("FS-Master {reading}"));
    let devices = model.device_readings.iter().map(|reading| format!("FS-Device {reading}"));
    both.chain(masters).chain(devices).collect()
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
        "schema": fsct_reports::dossier::PROOF,
        "fsct": env!("CARGO_PKG_VERSION"),
        "edition": model.edition.name(),
        "readings": readings(model),
        "mixed": model.mixed,
        "watchdog": model.watchdog,
        "timing": model.timing.to_string(),
        "timers": model.timers.to_string(),
        "storing": model.storing,
        "storing_answers": model.storing_answers,
        "faults": model.faults,
        "power_cycles": model.power_cycles,
        "master_restart": model.master_restart,
        "device": device.as_ref().map(|product| &product.name),
        "master": master.as_ref().map(|product| &product.name),
        "states": states,
        "properties": outcomes.iter().map(|(one, _)| outcome(one)).collect::<Vec<_>>(),
    })
}
