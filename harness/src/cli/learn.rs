//! `fsct learn`: the machine of a DUT as a tester sees it, beside that of the tables.

use super::run::{candidate_profile, given_profiles};
use super::{Cases, RIG, USAGE, bench, fail, interruption, print, write};
use crate::campaign::dut_info;
use crate::learn::{Lab, Trouble, document, side, variant};
use fsct_observed::Side;
use fsct_observed::learn::{Asked, Bound, Bounds, Failure, Learned, Teacher, learn};
use fsct_observed::seen::Seen;
use fsct_protocol::crc::Reading;
use fsct_protocol::{Edition, ProtMode};
use fsct_reports::learned as file;
use fsct_reports::record::VariantInfo;
use fsct_reports::{learned_page, visible};
use std::path::{Path, PathBuf};

/// Exit code when the DUT differs from the tables.
const DIFFERS: u8 = 1;
/// Exit code when a bound ended the learning, or the DUT does not always answer alike.
const INCONCLUSIVE: u8 = 5;
/// Differences told on the terminal; the rest is in the file.
const TOLD: usize = 5;

/// Arguments of `fsct learn`.
#[derive(clap::Args, Debug)]
#[command(
    after_help = "Exit codes: 0 the machine is that of the tables; 1 it differs; 2 usage; 3 the DUT was lost; 5 a bound was hit \
                        before a difference, or the DUT answered the same inputs in two ways"
)]
pub struct Args {
    /// Device under test, as for `fsct run`
    #[arg(long, value_name = "URL")]
    dut: String,
    /// Profile of the product, as for `fsct run`
    #[arg(long, value_name = "PROFILE")]
    profile: Option<String>,
    /// Edition to learn: v1.1 or iec2022 [default: the later one the DUT offers]
    #[arg(long)]
    edition: Option<Edition>,
    /// Mode to learn: crc16 or crc32 [default: the first one the DUT offers]
    #[arg(long)]
    mode: Option<ProtMode>,
    /// States the DUT may hide behind those found: one more costs ten or fifteen times the inputs
    #[arg(long, value_name = "K", default_value_t = 1, value_parser = clap::value_parser!(u8).range(0..=4))]
    extra: u8,
    /// Most states
    #[arg(long, value_name = "N", default_value_t = 200)]
    most_states: usize,
    /// Most inputs
    #[arg(long, value_name = "N", default_value_t = 1_000_000)]
    most_inputs: u64,
    /// Seed of the process data
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Folder for learned.json and learned.html
    #[arg(long, value_name = "DIR", default_value = "fsct-learn")]
    out: PathBuf,
    #[command(flatten)]
    cases: Cases,
}

/// Runs the command; the result is the exit code.
pub fn run(args: &Args) -> u8 {
    execute(args).unwrap_or_else(|code| code)
}

fn execute(args: &Args) -> Result<u8, u8> {
    let library = args.cases.load()?;
    let profiles = given_profiles(args.profile.as_slice(), &library)?;
    let address = bench::parse(&args.dut).map_err(|why| fail(USAGE, why))?;
    let mut bench = bench::connect(&address).map_err(|error| fail(RIG, error))?;
    let profile = candidate_profile(bench.description.role, &profiles, &library)?;
    if let Some(contradiction) = profiles.iter().find_map(|profile| profile.contradicts(&bench.description)) {
        return Err(fail(USAGE, contradiction));
    }
    let variant = variant(&bench.description, profile, args.edition, args.mode).map_err(|why| fail(USAGE, why))?;
    let interrupted = interruption();
    let dut = dut_info(&args.dut, profile, &bench);
    let side = side(profile.role);
    let bounds = Bounds { extra: args.extra.into(), most_states: args.most_states, most_inputs: args.most_inputs };
    let mut lab = Lab::new(&library, profile, &interrupted, &mut bench, variant, args.seed).map_err(trouble)?;
    let table = side.table();
    let learned =
        learn(&mut lab, side.inputs().len(), bounds, Some(&table)).map_err(|failure| failed(side, &failure))?;
    let Learned { machine, bound, asked: Asked { words, inputs } } = learned;
    let bound = bound.map(|bound| match bound {
        Bound::States => format!("more than {} states (--most-states)", args.most_states),
        Bound::Inputs => format!("more than {} inputs (--most-inputs)", args.most_inputs),
    });
    print(format!("dut       {} · {}", visible(&dut.url), visible(&format!("{} {}", dut.product, dut.version))));
    print(format!("asked     {words} words, {inputs} inputs, each word from the start"));
    let Some(machine) = machine else {
        let bound = bound.unwrap_or_default();
        return Err(fail(INCONCLUSIVE, format!("{bound}: no machine explains what was seen so far")));
    };
    let mut differences = document::differences(side, &machine, &table);
    if bound.is_some() {
        // What was not learnt to the end may differ in what it supposes alone.
        let mut seen = Vec::new();
        for difference in differences {
            if confirmed(&mut lab, side, &difference)? {
                seen.push(difference);
            }
        }
        differences = seen;
    }
    let learned = file::Learned {
        schema: file::SCHEMA.to_owned(),
        dut,
        variant: VariantInfo {
            edition: variant.edition.name().to_owned(),
            mode: variant.mode.name().to_owned(),
            pd_out: variant.pd_out,
            pd_in: variant.pd_in,
            leading_octet: profile.reading == Reading::LeadingOctet,
        },
        seed: args.seed,
        extra_states: args.extra.into(),
        bound,
        words,
        inputs_given: inputs,
        inputs: side.inputs().into_iter().map(str::to_owned).collect(),
        outputs: side.outputs().iter().map(|name| (*name).to_owned()).collect(),
        machine: document::machine(side, &machine),
        table: document::machine(side, &table),
        differences,
    };
    write(&args.out, "learned.json", &(serde_json::to_string_pretty(&learned).unwrap_or_default() + "\n"))?;
    write(&args.out, "learned.html", &learned_page(&learned))?;
    Ok(tell(&learned, &args.out))
}

/// Whether the DUT shows a difference when asked once more.
fn confirmed(lab: &mut Lab<'_>, side: Side, difference: &file::Difference) -> Result<bool, u8> {
    let inputs = side.inputs();
    let word: Vec<usize> =
        difference.word.iter().filter_map(|name| inputs.iter().position(|input| input == name)).collect();
    let seen = lab.ask(&word).map_err(trouble)?;
    Ok(seen.last().is_some_and(|seen| side.told(*seen) == difference.dut))
}

fn tell(learned: &file::Learned, out: &Path) -> u8 {
    let file::Learned { machine, table, differences, bound, extra_states, .. } = learned;
    print(format!("learnt    {} states; the tables have {}", machine.states.len(), table.states.len()));
    print(format!("written   {}, learned.html", out.join("learned.json").display()));
    let told = told(differences);
    for (number, (difference, also)) in (1..).zip(told.iter().take(TOLD)) {
        let file::Difference { word, table, dut, .. } = difference;
        let (last, before) = word.split_last().map_or((String::new(), String::new()), |(last, before)| {
            (last.clone(), if before.is_empty() { "the start".to_owned() } else { before.join(", ") })
        });
        print(format!("\n{number}. {last} behind {before}\n   tables  {table}\n   DUT     {dut}"));
        if !also.is_empty() {
            print(format!("   and otherwise than the tables to {} there", also.join(", ")));
        }
    }
    match (differences.len(), bound) {
        (0, Some(bound)) => fail(INCONCLUSIVE, format!("{bound}: nothing different was seen until then")),
        (0, None) => {
            print(format!(
                "equal: the DUT does what the tables say, if it hides no more than {extra_states} further state{}",
                if *extra_states == 1 { "" } else { "s" }
            ));
            0
        }
        (count, bound) => {
            let more = if told.len() > TOLD { "; more in learned.json" } else { "" };
            print(format!("\ndiffers in {count} place{}{more}", if count == 1 { "" } else { "s" }));
            if let Some(bound) = bound {
                print(format!("not learnt to the end: {bound}"));
            }
            DIFFERS
        }
    }
}

/// The first difference of each pair of states, with the other inputs that show one there.
fn told(differences: &[file::Difference]) -> Vec<(&file::Difference, Vec<&str>)> {
    let mut told: Vec<(&file::Difference, Vec<&str>)> = Vec::new();
    for difference in differences {
        match told.iter_mut().find(|(first, _)| first.states == difference.states) {
            Some((_, also)) => also.extend(difference.word.last().map(String::as_str)),
            None => told.push((difference, Vec::new())),
        }
    }
    told
}

fn trouble(trouble: Trouble) -> u8 {
    match trouble {
        Trouble::Short(_) | Trouble::Late => fail(USAGE, trouble),
        _ => fail(RIG, trouble),
    }
}

fn failed(side: Side, failure: &Failure<Seen, Trouble>) -> u8 {
    match failure {
        Failure::Teacher(why) => trouble(why.clone()),
        Failure::Contradiction { word, before, after } => {
            let inputs = side.inputs();
            let names: Vec<&str> = word.iter().filter_map(|input| inputs.get(*input).copied()).collect();
            let told = |seen: &[Seen]| seen.last().map_or(String::new(), |seen| side.told(*seen));
            fail(
                INCONCLUSIVE,
                format!(
                    "the DUT does not always answer alike, so nothing can be learnt of it\nfsct: to {} it answered at first: {}\nfsct: and \
                     later: {}",
                    names.join(", "),
                    told(before),
                    told(after)
                ),
            )
        }
    }
}
