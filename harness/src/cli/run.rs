//! `fsct run`: judges a DUT and leaves the record and the reports.

use super::{Cases, RIG, USAGE, bench, colour, fail, interruption, print, show};
use crate::annex_i;
use crate::campaign::{Bench, Judges, Run, dut_info};
use crate::complete;
use crate::coverage::Coverage;
use crate::library::Library;
use crate::matrix::GROUP;
use crate::oracle::{Mask, Tolerances};
use crate::plan::{Plan, Selection, plan, unreached};
use crate::problem::suggestion;
use crate::profile::{Profile, default_profile};
use crate::yaml;
use fsct_adapters::{Address, ClockKind, Description, DutError, Offer, Role, Variant};
use fsct_iodd::Declaration;
use fsct_protocol::Edition;
use fsct_reports::record::{CaseRecord, DutInfo, Execution, Footer, Header, MatrixInfo, SCHEMA, ScenarioInfo, Verdict};
use fsct_reports::{Asked, Journal, Summary, visible};
use indicatif::{ProgressBar, ProgressStyle};
use std::collections::{BTreeMap, BTreeSet};
use std::io::IsTerminal;
use std::path::{Path, PathBuf};
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

/// Failures told on the terminal; the rest is in the reports.
const TOLD: usize = 10;

/// How deep a run goes on a virtual clock unless the user says so.
const DEPTH: u8 = 1;

/// Arguments of `fsct run`.
#[derive(clap::Args, Debug)]
pub struct Args {
    /// Names of suites, or files of cases; none: all suites
    #[arg(value_name = "SUITE")]
    suites: Vec<String>,
    /// Device under test: inproc:NAME, lib:PATH, exec:PROGRAM ARGS, tcp://HOST:PORT, unix:PATH or serial:PATH. Repeated, each
    /// is judged, and where two of one role differ is told. Without it the reference FS-Device and the reference FS-Master
    #[arg(long, value_name = "URL")]
    dut: Vec<String>,
    /// Profile of the product: a name the binary carries, or a file; one for each role. Without it reference-device or
    /// reference-master
    #[arg(long, value_name = "PROFILE")]
    profile: Vec<String>,
    /// IODD of the FS-Device: it is judged as what the file declares, and by whether it is what the file declares
    #[arg(long, value_name = "FILE")]
    iodd: Option<PathBuf>,
    /// Only this edition: v1.1 or iec2022
    #[arg(long)]
    edition: Option<Edition>,
    /// Only cases that match: a text in key or title (* for anything), suite:NAME, req:ID, covers:T25; may be repeated
    #[arg(long, value_name = "EXPR")]
    filter: Vec<String>,
    /// Part I of N of the cases
    #[arg(long, value_name = "I/N", value_parser = shard)]
    shard: Option<(usize, usize)>,
    /// Runs each case so often, `run=N` in its key
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=10_000))]
    repeat: u32,
    /// On a real clock, cases with an FSP_Watchdog above 1 s as well: they take minutes
    #[arg(long)]
    long: bool,
    /// How deep: 0, 1 or 2 states a DUT may have beyond the table, see docs/complete.md [default: 1, 0 on a real clock]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u8).range(0..=2))]
    depth: Option<u8>,
    /// Seed that everything random derives from
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Folder for record and reports
    #[arg(long, value_name = "DIR", default_value = "fsct-out")]
    out: PathBuf,
    /// Let pass what this tolerance describes (A09, ...)
    #[arg(long, value_name = "ID")]
    tolerate: Vec<String>,
    /// Fail what this tolerance would let pass; `all` for every one
    #[arg(long, value_name = "ID")]
    strict: Vec<String>,
    #[command(flatten)]
    cases: Cases,
}

fn shard(text: &str) -> Result<(usize, usize), String> {
    let parts = text.split_once('/').and_then(|(i, n)| Some((i.parse().ok()?, n.parse().ok()?)));
    parts.filter(|(i, n)| (1..=*n).contains(i)).ok_or_else(|| "a part such as 2/4 is meant".to_owned())
}

/// Runs the command; the result is the exit code.
pub fn run(args: &Args) -> u8 {
    execute(args).unwrap_or_else(|code| code)
}

/// Judged when the user names nothing.
const REFERENCE: [&str; 2] = ["inproc:reference-device", "inproc:reference-master"];

/// One DUT of a run, reached or not.
struct Candidate<'a> {
    url: &'a str,
    address: Address,
    profile: &'a Profile,
    allowed: Mask,
    first: Result<Bench, DutError>,
    description: Description,
}

impl Candidate<'_> {
    fn info(&self) -> DutInfo {
        match &self.first {
            Ok(bench) => dut_info(self.url, self.profile, bench),
            // Of a DUT that was not reached nothing is known but where it should be.
            Err(_) => DutInfo {
                url: self.url.to_owned(),
                role: self.profile.role.to_string(),
                profile: self.profile.name.clone(),
                declared: self.profile.facts(),
                ..DutInfo::default()
            },
        }
    }
}

fn execute(args: &Args) -> Result<u8, u8> {
    let mut library = args.cases.load()?;
    let mut selection = Selection {
        suites: Vec::new(),
        filter: args.filter.clone(),
        edition: args.edition,
        shard: args.shard,
        repeat: args.repeat,
        long: args.long,
        depth: 0,
    };
    for suite in &args.suites {
        if is_file(suite) {
            let name = library.add_suite(Path::new(suite)).map_err(|problems| show(&problems))?;
            let problems = library.check();
            let own: Vec<_> = problems.into_iter().filter(|problem| problem.place().starts_with(suite)).collect();
            if !own.is_empty() {
                return Err(show(&own));
            }
            selection.suites.push(name);
        } else if library.names().any(|known| known == *suite) {
            selection.suites.push(suite.clone());
        } else {
            let help = suggestion(suite, library.names());
            return Err(fail(USAGE, format!("there is no suite `{suite}`; {help}")));
        }
    }
    let mut profiles = given_profiles(&args.profile, &library)?;
    let declaration = args.iodd.as_deref().map(|file| declared(file, args.edition)).transpose()?;
    if let Some(declaration) = &declaration {
        let own = candidate_profile(Role::Device, &profiles, &library)?.with_iodd(declaration.clone());
        profiles.retain(|profile| profile.role != Role::Device);
        profiles.push(own);
    }
    let urls: Vec<&str> = match args.dut.as_slice() {
        [] => {
            let chosen = |url: &&str| {
                profiles.is_empty() || profiles.iter().any(|profile| url.contains(&*profile.role.to_string()))
            };
            REFERENCE.into_iter().filter(chosen).collect()
        }
        given => given.iter().map(String::as_str).collect(),
    };
    let mut candidates = Vec::new();
    for url in urls {
        let mut found = candidate(args, url, &profiles, &library)?;
        if let Some(declaration) = declaration.as_ref().filter(|_| found.description.role == Role::Device) {
            found.description.offers = as_declared(&found.description.offers, declaration)?;
        }
        candidates.push(found);
    }
    if let Some(unused) =
        profiles.iter().find(|profile| candidates.iter().all(|other| other.profile.role != profile.role))
    {
        let roles: Vec<String> = candidates.iter().map(|candidate| candidate.description.role.to_string()).collect();
        let said = format!(
            "profile `{}` is for a {}, the DUT says it is a {}",
            unused.name,
            unused.role,
            roles.join(" and a ")
        );
        return Err(fail(USAGE, said));
    }
    let planned = |one: &Candidate<'_>| {
        let usual = if one.description.clock.kind == ClockKind::Real { 0 } else { DEPTH };
        let selection = Selection { depth: args.depth.unwrap_or(usual), ..selection.clone() };
        plan(&library, &selection, one.profile, &one.description).map_err(|problem| show(&[problem]))
    };
    let mut plans: Vec<Plan<'_>> = candidates.iter().map(planned).collect::<Result<_, _>>()?;
    if args.dut.is_empty() && plans.iter().any(|plan| !plan.cases.is_empty()) {
        // Nobody asked for a reference whose role no chosen case is for.
        let mut has_cases = plans.iter().map(|plan| !plan.cases.is_empty()).collect::<Vec<_>>().into_iter();
        candidates.retain(|_| has_cases.next().unwrap_or(true));
        plans.retain(|plan| !plan.cases.is_empty());
    }
    let claims_none = candidates.iter().filter(|one| one.profile.no_fs_port_mode);
    let no_fs_master: Vec<&str> = claims_none.map(|one| one.profile.name.as_str()).collect();
    let in_force = candidates.iter().fold(Mask::NONE, |mask, one| mask.union(one.allowed));
    let header = Header {
        schema: SCHEMA.to_owned(),
        fsct: env!("CARGO_PKG_VERSION").to_owned(),
        seed: args.seed,
        duts: candidates.iter().map(Candidate::info).collect(),
        planned: plans.iter().map(|plan| plan.cases.len()).sum(),
        not_applicable: plans.iter().flat_map(|plan| plan.not_applicable.clone()).collect(),
        tolerances: self::in_force(in_force, &library.tolerances),
        machines: library
            .coverage
            .values()
            .filter(|goals| candidates.iter().any(|one| one.profile.role == goals.role))
            .map(Coverage::info)
            .collect(),
        matrix: matrix(&library, &plans),
        evidence: library
            .annex_i
            .as_ref()
            .filter(|_| args.suites.iter().any(|suite| suite == annex_i::NAME))
            .map(|annex| annex.evidence(&library.ledger, |name| library.members(name))),
        scenarios: scenarios(&library, &plans),
        complete: plans.iter().enumerate().flat_map(|(dut, plan)| complete::planned(dut, plan)).collect(),
    };
    let interrupted = interruption();
    let bar = progress(header.planned);
    let mut told = Told { bar: &bar, failures: 0 };
    let mut taken = Vec::new();
    let written = (|| {
        let mut journal = Journal::create(&args.out)?;
        journal.header(&header)?;
        let mut cases = 0;
        for ((number, one), plan) in (0..).zip(candidates).zip(&plans) {
            let begin = Instant::now();
            let run = Run {
                library: &library,
                profile: one.profile,
                allowed: one.allowed,
                seed: args.seed,
                command: command(args, one.url, one.profile),
                interrupted: &interrupted,
                judges: Judges::default(),
            };
            run.execute(
                plan,
                one.first,
                || bench::connect(&one.address),
                |mut case| {
                    cases += 1;
                    case.dut = number;
                    told.case(&case);
                    journal.case(&case)
                },
            )?;
            taken.push((one.url, begin.elapsed()));
        }
        journal.footer(&Footer { cases, interrupted: interrupted.load(Ordering::Relaxed) })
    })();
    bar.finish_and_clear();
    written.map_err(|error| fail(RIG, format!("the record in {} cannot be written: {error}", args.out.display())))?;
    let summary = fsct_reports::render(&args.out).map_err(|error| fail(RIG, error))?;
    compare(&plans, &taken, &summary);
    conclude(args, &no_fs_master, &plans, &summary, interrupted.load(Ordering::Relaxed));
    Ok(summary.exit_code())
}

/// What a sound IODD declares.
fn declared(file: &Path, edition: Option<Edition>) -> Result<Declaration, u8> {
    let name = file.display();
    let octets = fsct_iodd::octets_of(file).map_err(|why| fail(USAGE, format!("{name}: {why}")))?;
    let report = fsct_iodd::check(&octets, edition).map_err(|why| fail(USAGE, format!("{name}: {why}")))?;
    match report.is_sound() {
        true => Ok(report.declaration),
        false => Err(fail(
            USAGE,
            format!("{name} is not sound, so no product can be held against it; see `fsct iodd {name}`"),
        )),
    }
}

/// What a DUT offers, narrowed to the one product its IODD declares.
fn as_declared(offers: &[Offer], declaration: &Declaration) -> Result<Vec<Offer>, u8> {
    let Declaration { edition, mode, pd_in, pd_out, .. } = declaration;
    let (Some(mode), Some(pd_in), Some(pd_out)) = (*mode, *pd_in, *pd_out) else {
        return Err(fail(
            USAGE,
            "the IODD does not declare FSP_ProtMode and the length of the safety data; see `fsct iodd`",
        ));
    };
    let variant = Variant { edition: *edition, mode, pd_out, pd_in };
    let one = Offer { edition: *edition, mode, pd_out: (pd_out, pd_out), pd_in: (pd_in, pd_in) };
    match offers.iter().any(|offer| offer.covers(variant)) {
        true => Ok(vec![one]),
        false => Err(fail(
            USAGE,
            format!(
                "the IODD declares {edition} {mode} with {pd_in} octets in and {pd_out} out, which the DUT does not offer: is it \
                 that of another product?"
            ),
        )),
    }
}

/// The error matrix for the roles whose cases of it are planned.
fn matrix(library: &Library, plans: &[Plan<'_>]) -> Vec<MatrixInfo> {
    let cases = plans.iter().flat_map(|plan| &plan.cases).map(|planned| planned.case);
    let roles: Vec<Role> = cases.filter(|case| case.group.as_deref() == Some(GROUP)).map(|case| case.role).collect();
    library.matrix.as_ref().map_or_else(Vec::new, |matrix| matrix.info(&roles))
}

/// The scenarios that planned cases are about.
fn scenarios(library: &Library, plans: &[Plan<'_>]) -> Vec<ScenarioInfo> {
    let cases = plans.iter().flat_map(|plan| &plan.cases).map(|planned| planned.case);
    let wanted: BTreeSet<&str> = cases.filter_map(|case| Some(case.scenario.as_ref()?.0.as_str())).collect();
    library.scenarios.as_ref().map_or_else(Vec::new, |scenarios| scenarios.info(&wanted))
}

/// Reaches a DUT and finds the profile for its role.
fn candidate<'a>(
    args: &Args,
    url: &'a str,
    profiles: &'a [Profile],
    library: &'a Library,
) -> Result<Candidate<'a>, u8> {
    let address = bench::parse(url).map_err(|why| fail(USAGE, why))?;
    let first = bench::connect(&address);
    let role = match &first {
        Ok(bench) => bench.description.role,
        Err(error) => {
            eprintln!("fsct: {}", visible(&error.to_string()));
            profiles.first().map_or(Role::Device, |profile| profile.role)
        }
    };
    let profile = candidate_profile(role, profiles, library)?;
    let description = first.as_ref().map_or_else(|_| unreached(profile.role), |bench| bench.description.clone());
    let allowed = profile.allowed(&library.tolerances, &args.strict, &args.tolerate).map_err(|why| fail(USAGE, why))?;
    Ok(Candidate { url, address, profile, allowed, first, description })
}

/// The profiles that `--profile` names, one for each role at the most.
pub(super) fn given_profiles(names: &[String], library: &Library) -> Result<Vec<Profile>, u8> {
    let mut profiles: Vec<Profile> = Vec::new();
    for name in names {
        let found = profile(name, &library.profiles)?;
        if profiles.iter().any(|other| other.role == found.role) {
            return Err(fail(USAGE, format!("`--profile` is given twice for a {}", found.role)));
        }
        profiles.push(found);
    }
    Ok(profiles)
}

/// The profile a DUT of this role is judged by: the one given, or the default.
pub(super) fn candidate_profile<'a>(role: Role, given: &'a [Profile], library: &'a Library) -> Result<&'a Profile, u8> {
    let own = given.iter().find(|profile| profile.role == role);
    own.or_else(|| library.profiles.get(&default_profile(role)))
        .ok_or_else(|| fail(USAGE, format!("there is no profile for a {role}; give one by --profile")))
}

/// Whether a word on the command line is a file of cases and not the name of a suite.
fn is_file(suite: &str) -> bool {
    suite.ends_with(".yaml") || suite.ends_with(".yml")
}

fn profile(name: &str, known: &BTreeMap<String, Profile>) -> Result<Profile, u8> {
    if let Some(profile) = known.get(name) {
        return Ok(profile.clone());
    }
    let path = Path::new(name);
    if !path.exists() && path.extension().is_none() {
        let help = suggestion(name, known.keys().map(String::as_str));
        return Err(fail(USAGE, format!("there is no profile `{name}`; {help}")));
    }
    let source = yaml::load(path).map_err(|problem| show(&[problem]))?;
    Profile::parse(&source).map_err(|problems| show(&problems))
}

fn in_force(allowed: Mask, table: &Tolerances) -> BTreeMap<String, String> {
    let entries = allowed.iter().filter_map(|number| table.get(number));
    entries.map(|entry| (format!("A{:02}", entry.number), format!("{} ({})", entry.name, entry.stance))).collect()
}

/// The command line that leads back to a case.
fn command(args: &Args, url: &str, profile: &Profile) -> String {
    let mut command = "fsct run".to_owned();
    for file in args.suites.iter().filter(|suite| is_file(suite)) {
        command += &format!(" '{file}'");
    }
    command += &format!(" --dut '{url}'");
    if profile.name != default_profile(profile.role) {
        // As it was given: a file is not called by the name inside it.
        let given = args.profile.iter().find(|given| given.as_str() == profile.name || args.profile.len() == 1);
        command += &format!(" --profile '{}'", given.unwrap_or(&profile.name));
    }
    if let Some(file) = args.iodd.as_ref().filter(|_| profile.role == Role::Device) {
        command += &format!(" --iodd '{}'", file.display());
    }
    if let Some(folder) = &args.cases.folder {
        command += &format!(" --cases '{}'", folder.display());
    }
    if args.repeat > 1 {
        command += &format!(" --repeat {}", args.repeat);
    }
    if args.long {
        command += " --long";
    }
    if let Some(depth) = args.depth {
        command += &format!(" --depth {depth}");
    }
    for id in &args.strict {
        command += &format!(" --strict {id}");
    }
    for id in &args.tolerate {
        command += &format!(" --tolerate {id}");
    }
    command
}

fn progress(cases: usize) -> ProgressBar {
    if !std::io::stderr().is_terminal() {
        return ProgressBar::hidden();
    }
    let bar = ProgressBar::new(cases as u64);
    if let Ok(style) = ProgressStyle::with_template("{bar:30} {pos}/{len} {msg}") {
        bar.set_style(style);
    }
    bar
}

/// Tells failures as they happen.
struct Told<'b> {
    bar: &'b ProgressBar,
    failures: usize,
}

impl Told<'_> {
    fn case(&mut self, case: &CaseRecord) {
        self.bar.inc(1);
        if case.verdict < Verdict::Inconclusive && case.execution == Execution::Ok {
            return;
        }
        self.failures += 1;
        if self.failures > TOLD {
            return;
        }
        let word = match (case.execution, case.verdict) {
            (Execution::Ok, Verdict::Fail) => "fail",
            (Execution::Ok, _) => "inconclusive",
            (Execution::Timeout, _) => "timeout",
            (Execution::DutError, _) => "dut-error",
            (Execution::RigError, _) => "rig-error",
            (Execution::ToolError, _) => "tool-error",
            (Execution::Aborted, _) => "aborted",
        };
        let mut text = format!("{word} {}  {}\n", case.key, case.title);
        if let Some(reason) = case.reasons.first() {
            let step = case.steps.get(reason.step).map_or(String::new(), |step| format!(" ({})", step.text));
            if !reason.clause.is_empty() {
                text += &format!("  clause   {} [{}]\n", reason.clause, reason.kind);
            }
            text += &format!(
                "  step {}{step}\n  expected {}\n  observed {}\n",
                reason.step, reason.expected, reason.observed
            );
        }
        text += &format!("  replay   {}", case.replay);
        if self.failures == TOLD {
            text += "\n  (further ones are in the reports)";
        }
        self.bar.suspend(|| eprintln!("{}", visible(&text)));
    }
}

/// How long each DUT took, and where several of one role did not come to the same.
fn compare(plans: &[Plan<'_>], taken: &[(&str, Duration)], summary: &Summary) {
    if taken.len() > 1 {
        for ((url, time), plan) in taken.iter().zip(plans) {
            print(format!("{:>5} cases in {:6.2} s  {}", plan.cases.len(), time.as_secs_f64(), visible(url)));
        }
    }
    match (summary.compared, summary.differing.as_slice()) {
        (None, _) => {}
        (Some(compared), []) => print(format!("{compared} cases came to the same on every DUT")),
        (Some(compared), differing) => {
            print(format!("{} of {compared} cases did not come to the same on every DUT:", differing.len()));
            for case in differing.iter().take(TOLD) {
                let url = |number: usize| taken.get(number).map_or("", |(url, _)| *url);
                let outcomes: Vec<String> = case
                    .outcomes
                    .iter()
                    .map(|(number, outcome)| format!("{outcome} on {}", visible(url(*number))))
                    .collect();
                print(format!("  {}: {}", case.key, outcomes.join(", ")));
            }
        }
    }
}

/// What was taken in a row, in a few words.
fn walked(summary: &Summary) -> String {
    let told = summary.coverage.iter().filter(|_| summary.cases > 0);
    let said: Vec<String> = told
        .map(|one| {
            let (triples, steps) = (one.triples.said(), one.step_pairs.said());
            let asked = one.asked.as_ref().map_or_else(String::new, |asked| format!(", {}", asked.said()));
            format!(" · {}: {triples} triples, {steps} step pairs{asked}", one.role)
        })
        .collect();
    said.concat()
}

/// What can be taken in a row and was not, as long as that is a short list; and what cannot be and was.
fn in_a_row(summary: &Summary) {
    for one in summary.coverage.iter().filter(|_| summary.cases > 0) {
        for (kind, reached) in one.kinds() {
            if (1..=TOLD).contains(&reached.missing.len()) {
                print(format!("{kind} not taken by the {}: {}", one.role, reached.missing.join(", ")));
            }
            for (name, said) in &reached.contradicting {
                let name = visible(name);
                print(format!("CONTRADICTION: the {} took `{name}` of the {kind}, {}", one.role, visible(said)));
            }
        }
        if let Some(asked) = &one.asked {
            self::asked(&one.role, asked);
        }
    }
}

/// The sides of conditions and timers that were not seen, as long as that is a short list; and those that cannot be and were.
fn asked(role: &str, asked: &Asked) {
    for (kind, reached) in asked.kinds() {
        if reached.missing.len() > TOLD {
            print(format!("{} sides of {kind} not seen of the {role}: the report names them", reached.missing.len()));
        } else {
            for side in &reached.missing {
                let near = asked.nearest.get(side);
                let near = near.map_or_else(String::new, |key| format!("; nearest is {}", visible(key)));
                print(format!("not seen of the {role}: {}{near}", visible(side)));
            }
        }
        for (side, said) in &reached.contradicting {
            print(format!("CONTRADICTION: the {role} had `{}` of the {kind}, {}", visible(side), visible(said)));
        }
    }
}

fn conclude(args: &Args, no_fs_master: &[&str], plans: &[Plan<'_>], summary: &Summary, interrupted: bool) {
    let coloured = colour(std::io::stdout().is_terminal());
    let mut suites: BTreeMap<&str, usize> = BTreeMap::new();
    let cases = plans.iter().flat_map(|plan| &plan.cases);
    cases.for_each(|planned| *suites.entry(&planned.case.suite).or_default() += 1);
    for (suite, count) in suites {
        print(format!("{suite:<22} {count:>5} cases"));
    }
    let counts: Vec<String> = summary
        .verdicts
        .iter()
        .filter(|(_, count)| **count > 0)
        .map(|(verdict, count)| format!(", {count} {verdict}"))
        .collect();
    let coverage = match (summary.cases, summary.not_taken().as_slice()) {
        (0, _) => String::new(),
        (_, []) => " · every transition taken".to_owned(),
        (_, names) => format!(" · not taken: {}", names.join(" ")),
    };
    let coverage = coverage + &walked(summary);
    let verdict = match summary.exit_code() {
        0 => "conformant",
        1 => "not conformant",
        3 => "rig or tool error",
        4 => "nothing ran",
        _ => "inconclusive",
    };
    let (bold, plain) = if coloured { ("\x1b[1m", "\x1b[0m") } else { ("", "") };
    print(format!(
        "{bold}{verdict}{plain}: {} cases{}{coverage} · seed {}",
        summary.cases,
        counts.concat(),
        summary.seed
    ));
    in_a_row(summary);
    summary.complete.iter().for_each(|suite| print(visible(&suite.said())));
    let not_applicable: usize = plans.iter().map(|plan| plan.not_applicable.len()).sum();
    if not_applicable > 0 {
        print(format!("{not_applicable} not applicable, with the reason in the report"));
    }
    for name in no_fs_master {
        print(format!("`{name}` claims no FS_PortMode: nothing above is a verdict on a clause of SDCI-FS"));
    }
    if summary.cases == 0 {
        // Nothing ran: the terms are all there is to say.
        let mut terms: BTreeMap<&str, usize> = BTreeMap::new();
        let left_out = plans.iter().flat_map(|plan| &plan.not_applicable);
        left_out.for_each(|(_, term)| *terms.entry(term).or_default() += 1);
        terms.iter().take(TOLD).for_each(|(term, count)| print(format!("  {count} cases: {term}")));
    }
    if interrupted {
        print("stopped by the user: the record is valid and partial");
    }
    print(format!("report: {}", args.out.join("report.html").display()));
    if args.dut.is_empty() {
        print("judged was what this program carries; your own next: fsct doctor --dut URL, then fsct run --dut URL");
    }
}
