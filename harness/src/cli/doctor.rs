//! `fsct doctor`: reaches a DUT, says what it is and how fast it answers, and which suites apply to it: the first command on a
//! new bench.

use super::run::{candidate_profile, given_profiles};
use super::{Cases, RIG, USAGE, bench, fail, print, show};
use crate::campaign::{Bench, dut_info, nanoseconds};
use crate::library::Library;
use crate::plan::{Selection, plan};
use crate::profile::Profile;
use fsct_adapters::{ClockKind, Description, DutError, Fault, Latency, Pco, Role};
use fsct_reports::record::DutInfo;
use fsct_reports::visible;
use serde::Serialize;
use std::collections::BTreeMap;
use std::time::{Duration, Instant};

/// Round trips measured.
const TRIPS: usize = 200;

/// Arguments of `fsct doctor`.
#[derive(clap::Args, Debug)]
pub struct Args {
    /// Device under test, as for `fsct run`
    #[arg(long, value_name = "URL")]
    dut: String,
    /// Profile of the product, as for `fsct run`
    #[arg(long, value_name = "PROFILE")]
    profile: Option<String>,
    /// For programs
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    cases: Cases,
}

/// All there is to say of a DUT without judging it. Times are in nanoseconds.
#[derive(Serialize)]
struct Diagnosis {
    dut: DutInfo,
    ports: u8,
    not_served: Vec<&'static str>,
    hello_ns: u64,
    latency_ns: Trips,
    suites: Vec<Suite>,
    advice: Vec<String>,
}

#[derive(Serialize)]
struct Trips {
    min: u64,
    median: u64,
    p99: u64,
    max: u64,
}

/// How much of a suite applies.
#[derive(Serialize)]
struct Suite {
    suite: String,
    applies: usize,
    /// Why others do not, with their number.
    not_applicable: BTreeMap<String, usize>,
}

/// Runs the command; the result is the exit code.
pub fn run(args: &Args) -> u8 {
    execute(args).unwrap_or_else(|code| code)
}

fn execute(args: &Args) -> Result<u8, u8> {
    let library = args.cases.load()?;
    let profiles = given_profiles(args.profile.as_slice(), &library)?;
    let address = bench::parse(&args.dut).map_err(|why| fail(USAGE, why))?;
    let begin = Instant::now();
    let reached = bench::connect(&address);
    let hello = begin.elapsed();
    let mut bench = reached.map_err(|error| no_dut(&error))?;
    let latency = Latency::measure(bench.dut.as_mut(), TRIPS).map_err(|error| no_dut(&error))?;
    let Bench { description, .. } = &bench;
    let profile = candidate_profile(description.role, &profiles, &library)?;
    if let Some(contradiction) = profiles.iter().find_map(|profile| profile.contradicts(description)) {
        return Err(fail(USAGE, contradiction));
    }
    let diagnosis = Diagnosis {
        dut: dut_info(&args.dut, profile, &bench),
        ports: description.ports,
        not_served: Pco::ALL.into_iter().filter(|pco| !description.pcos.contains(pco)).map(Pco::name).collect(),
        hello_ns: nanoseconds(hello),
        latency_ns: Trips {
            min: nanoseconds(latency.min),
            median: nanoseconds(latency.median),
            p99: nanoseconds(latency.p99),
            max: nanoseconds(latency.max),
        },
        suites: suites(&library, profile, description)?,
        advice: advice(profile, description, &latency),
    };
    if args.json {
        print(serde_json::to_string_pretty(&diagnosis).map_err(|error| fail(RIG, error))?);
    } else {
        tell(&diagnosis, description, hello, &latency);
    }
    Ok(0)
}

/// Whose fault it is that there is nothing to say.
fn no_dut(error: &DutError) -> u8 {
    let whose = match error.fault() {
        Fault::Rig => "the rig: nothing has been said to the DUT yet",
        Fault::Dut => "the DUT or its adapter: it was reached, PROTOCOL.md says what it should have answered",
    };
    fail(RIG, format!("{error}\nfsct: look at {whose}"))
}

fn suites(library: &Library, profile: &Profile, description: &Description) -> Result<Vec<Suite>, u8> {
    let of: BTreeMap<&str, &str> = library.cases().map(|case| (case.id.as_str(), case.suite.as_str())).collect();
    // Whoever names suites is told of those for the other role too.
    let named = Selection { suites: library.names().map(str::to_owned).collect(), ..Selection::default() };
    let plan = plan(library, &named, profile, description).map_err(|problem| show(&[problem]))?;
    let applying = plan.cases.iter().map(|planned| (planned.case.suite.as_str(), None));
    let left_out = plan.not_applicable.into_iter().map(|(key, term)| {
        let id = key.split('[').next().unwrap_or_default();
        (of.get(id).copied().unwrap_or_default(), Some(term))
    });
    let mut suites: BTreeMap<&str, Suite> = BTreeMap::new();
    for (name, term) in applying.chain(left_out) {
        let suite = suites.entry(name).or_insert_with(|| Suite {
            suite: name.to_owned(),
            applies: 0,
            not_applicable: BTreeMap::new(),
        });
        match term {
            None => suite.applies += 1,
            Some(term) => *suite.not_applicable.entry(term).or_default() += 1,
        }
    }
    Ok(suites.into_values().collect())
}

/// What will go wrong if it stays as it is.
fn advice(profile: &Profile, description: &Description, latency: &Latency) -> Vec<String> {
    let mut advice = Vec::new();
    let cycle = Duration::from_nanos(profile.master_cycle_time_ns);
    if description.clock.kind == ClockKind::Real && latency.p99 > cycle {
        advice.push(format!(
            "an answer takes longer ({:.1?}) than the MasterCycleTime of profile `{}` ({cycle:.1?}): raise \
             MasterCycleTime_us or cases will be inconclusive",
            latency.p99, profile.name
        ));
    }
    if description.role == Role::Device && !description.pcos.contains(&Pco::App) {
        advice
            .push("without `app` nothing can be said of what reaches the application: serve it if you can".to_owned());
    }
    advice
}

fn tell(diagnosis: &Diagnosis, description: &Description, hello: Duration, latency: &Latency) {
    let row = |name: &str, text: String| print(format!("{name:<9} {}", visible(&text)));
    let Diagnosis { dut, .. } = diagnosis;
    let role = match description.role {
        Role::Device => "FS-Device",
        Role::Master => "FS-Master",
    };
    let own_words: Vec<&str> = [&dut.vendor, &dut.product, &dut.version].map(String::as_str).into();
    let own_words: Vec<&str> = own_words.into_iter().filter(|text| !text.is_empty()).collect();
    row("dut", format!("{}, reached in {hello:.1?}", dut.url));
    row("role", format!("{role}, {} port{}", description.ports, if description.ports == 1 { "" } else { "s" }));
    row("product", format!("{} (in its own words)", own_words.join(" · ")));
    let missing = match diagnosis.not_served.as_slice() {
        [] => String::new(),
        names => format!("; not {}", names.join(", ")),
    };
    row("serves", format!("{}{missing}", dut.pcos.join(", ")));
    row(
        "clock",
        format!("{}, resolution {} ns, uncertainty ± {} ns", dut.clock, dut.resolution_ns, dut.uncertainty_ns),
    );
    if let Some(proof) = &dut.clock_proof {
        row("loop-back", proof.said());
    }
    dut.offers.iter().for_each(|offer| row("offers", offer.clone()));
    row(
        "latency",
        format!(
            "min {:.1?}, median {:.1?}, p99 {:.1?}, max {:.1?} over {TRIPS} round trips",
            latency.min, latency.median, latency.p99, latency.max
        ),
    );
    row("liveness", "a made-up stimulus is answered `unsupported`, as it has to be".to_owned());
    row("profile", dut.profile.clone());
    // Suites that are left out as a whole for the same reason are told together.
    let mut none: BTreeMap<&str, (usize, usize)> = BTreeMap::new();
    for suite in &diagnosis.suites {
        let left_out: usize = suite.not_applicable.values().sum();
        let count = match (suite.applies, suite.not_applicable.first_key_value()) {
            (0, Some((term, count))) if *count == left_out => {
                let (suites, cases) = none.entry(term).or_default();
                (*suites, *cases) = (*suites + 1, *cases + count);
                continue;
            }
            (applies, None) => format!("{applies} cases apply"),
            (applies, Some(_)) => format!("{applies} of {} cases apply", applies + left_out),
        };
        row("suite", format!("{:<22} {count}", suite.suite));
        for (term, count) in &suite.not_applicable {
            row("", format!("{:<22} {count} do not: {term}", ""));
        }
    }
    for (term, (suites, cases)) in none {
        row("suites", format!("{suites} more do not apply ({cases} cases): {term}"));
    }
    diagnosis.advice.iter().for_each(|text| row("advice", text.clone()));
}
