//! `fsct capture`: judges the line cases by a file of a logic analyser.

use super::run::given_profiles;
use super::{Cases, RIG, USAGE, fail, print, show};
use crate::campaign::{Judges, Run};
use crate::capture;
use crate::oracle::Mask;
use crate::plan::{Selection, plan, unreached};
use crate::profile::Profile;
use fsct_lines::capture::{Capture, Channels, Options, SampleRate, open};
use fsct_protocol::Edition;
use fsct_reports::record::{DutInfo, Footer, Header, SCHEMA, Verdict};
use fsct_reports::{Journal, Summary, visible};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

/// The longest pulse a glitch filter may leave out, in nanoseconds: longer ones may be test pulses or wake-ups.
const MOST_GLITCH_NS: u64 = 10_000;

/// Arguments of `fsct capture`.
#[derive(clap::Args, Debug)]
pub struct Args {
    /// Recording of L+, C/Q and I/Q: VCD, sigrok session (.sr), CSV of sigrok or of Saleae Logic
    #[arg(value_name = "FILE")]
    file: PathBuf,
    /// Profile of the product: a name the binary carries, or a file; it says whether this is an FS-Device or an FS-Master
    #[arg(long, value_name = "PROFILE")]
    profile: String,
    /// Edition the product follows, v1.1 or iec2022; without it the limits of both are judged
    #[arg(long)]
    edition: Option<Edition>,
    /// Which channel is which line: L+=D0,C/Q=D1,I/Q=D2; without it by the names in the file
    #[arg(long, value_name = "MAP")]
    channels: Option<String>,
    /// Sample rate, for a file that does not state it: 24MHz
    #[arg(long, value_name = "RATE")]
    sample_rate: Option<String>,
    /// Leave out pulses shorter than this: 200ns or 1us, 10us at most; without it none
    #[arg(long, value_name = "TIME", value_parser = glitch)]
    glitch_filter: Option<u64>,
    /// Only cases that match, as with `fsct run`; may be repeated
    #[arg(long, value_name = "EXPR")]
    filter: Vec<String>,
    /// Folder for record and reports
    #[arg(long, value_name = "DIR", default_value = "fsct-out")]
    out: PathBuf,
    #[command(flatten)]
    cases: Cases,
}

fn glitch(text: &str) -> Result<u64, String> {
    let meant = || "a time such as 200ns or 1us is meant".to_owned();
    let (number, scale) = match (text.strip_suffix("ns"), text.strip_suffix("us")) {
        (Some(number), _) => (number, 1),
        (_, Some(number)) => (number, 1_000),
        _ => return Err(meant()),
    };
    let ns = number.trim().parse::<u64>().map_err(|_| meant())?.saturating_mul(scale);
    match ns {
        ns if ns <= MOST_GLITCH_NS => Ok(ns),
        _ => Err("longer than 10us it would leave out test pulses, and wake-ups next".to_owned()),
    }
}

/// Runs the command; the result is the exit code.
pub fn run(args: &Args) -> u8 {
    execute(args).unwrap_or_else(|code| code)
}

fn execute(args: &Args) -> Result<u8, u8> {
    let library = args.cases.load()?;
    let profiles = given_profiles(std::slice::from_ref(&args.profile), &library)?;
    let [profile] = profiles.as_slice() else { return Err(fail(USAGE, "one profile is needed")) };
    let recording = opened(args).map_err(|why| fail(USAGE, why))?;
    let glitch_ns = args.glitch_filter.unwrap_or(0);
    let mut info = info(args, profile, &recording);
    let selection = Selection { filter: args.filter.clone(), edition: args.edition, ..Selection::default() };
    // Nothing is asked of a DUT: what it serves does not matter.
    let planned = plan(&library, &selection, profile, &unreached(profile.role)).map_err(|problem| show(&[problem]))?;
    let planned = capture::line_cases(&library, planned);
    let outcome =
        capture::judge(&library, profile, &planned, recording, glitch_ns).map_err(|error| fail(USAGE, error))?;
    let filter = match glitch_ns {
        0 => "no glitch filter".to_owned(),
        ns => format!("pulses shorter than {ns} ns left out: {}", outcome.glitches),
    };
    info.version += &format!("; {filter}; {} episodes", outcome.episodes);
    let header = Header {
        schema: SCHEMA.to_owned(),
        fsct: env!("CARGO_PKG_VERSION").to_owned(),
        seed: 0,
        duts: vec![info],
        planned: outcome.judged.len(),
        not_applicable: outcome.not_applicable.clone(),
        tolerances: BTreeMap::new(),
        machines: Vec::new(),
        matrix: Vec::new(),
        evidence: None,
        scenarios: Vec::new(),
        complete: Vec::new(),
    };
    let interrupted = AtomicBool::new(false);
    let run = Run {
        library: &library,
        profile,
        allowed: Mask::NONE,
        seed: 0,
        command: String::new(),
        interrupted: &interrupted,
        judges: Judges::default(),
    };
    let written = (|| {
        let mut journal = Journal::create(&args.out)?;
        journal.header(&header)?;
        for judged in &outcome.judged {
            let mut record = run.blank(judged.planned);
            record.verdict = judged.verdict;
            record.reasons = judged.reasons.clone();
            record.steps = judged.steps.clone();
            record.measurements = judged.measurements.clone();
            record.start = "as recorded".to_owned();
            record.duration_ns = outcome.end;
            record.replay = replay(args, judged.planned.case.id.as_str(), judged.planned.binding.variant.edition);
            journal.case(&record)?;
        }
        journal.footer(&Footer { cases: outcome.judged.len(), interrupted: false })
    })();
    written.map_err(|error: std::io::Error| {
        fail(RIG, format!("the record in {} cannot be written: {error}", args.out.display()))
    })?;
    let summary = fsct_reports::render(&args.out).map_err(|error| fail(RIG, error))?;
    conclude(args, &outcome, &header, &summary);
    Ok(summary.exit_code())
}

/// The recording, with everything about its times known.
fn opened(args: &Args) -> Result<Capture, String> {
    let channels: Channels = match &args.channels {
        Some(text) => text.parse().map_err(|error: fsct_lines::RecordingError| error.to_string())?,
        None => Channels::default(),
    };
    let sample_rate: Option<SampleRate> = match &args.sample_rate {
        Some(text) => Some(text.parse().map_err(|error: fsct_lines::RecordingError| error.to_string())?),
        None => None,
    };
    let capture = open(&args.file, &Options { channels, sample_rate }).map_err(|error| error.to_string())?;
    let resolution = capture.resolution();
    if resolution.rate.is_none() && resolution.stated_ns.is_none() {
        return Err(format!(
            "{}: the file does not state how far its times may be off: give its sample rate, such as --sample-rate 24MHz",
            args.file.display()
        ));
    }
    Ok(capture)
}

/// The recording in the place of a DUT.
fn info(args: &Args, profile: &Profile, capture: &Capture) -> DutInfo {
    use fsct_lines::Recording as _;
    let size = std::fs::metadata(&args.file).map_or(0, |data| data.len());
    DutInfo {
        url: args.file.display().to_string(),
        role: profile.role.to_string(),
        profile: profile.name.clone(),
        product: format!("recording of a {}", profile.role),
        version: format!("{} octets, {}", size, capture.stated()),
        pcos: vec!["line".to_owned()],
        clock: "recorded".to_owned(),
        resolution_ns: capture.uncertainty_ns(),
        uncertainty_ns: capture.uncertainty_ns(),
        declared: profile.facts(),
        ..DutInfo::default()
    }
}

fn replay(args: &Args, id: &str, edition: Edition) -> String {
    let quoted = |path: &Path| format!("'{}'", path.display());
    let mut text = format!("fsct capture {} --profile '{}' --edition {edition}", quoted(&args.file), args.profile);
    for (name, value) in [("channels", &args.channels), ("sample-rate", &args.sample_rate)] {
        if let Some(value) = value {
            text += &format!(" --{name} '{value}'");
        }
    }
    if let Some(ns) = args.glitch_filter {
        text += &format!(" --glitch-filter {ns}ns");
    }
    if let Some(folder) = &args.cases.folder {
        text += &format!(" --cases {}", quoted(folder));
    }
    text + &format!(" --filter {id}")
}

fn conclude(args: &Args, outcome: &capture::Outcome<'_>, header: &Header, summary: &Summary) {
    for dut in &header.duts {
        print(format!("{}: {}", visible(&dut.url), visible(&dut.version)));
        if dut.role == "master" {
            print(
                "the port is taken for one with safety (SAFETYCOM or MIXEDSAFETYCOM): others wait for no Ready pulse",
            );
        }
    }
    for judged in &outcome.judged {
        let word = fsct_reports::verdict_name(judged.verdict);
        print(format!("{word:<14} {}  {}", judged.planned.key, judged.planned.case.title));
        if let Some(reason) = judged.reasons.first() {
            print(format!("  expected {}\n  observed {}", visible(&reason.expected), visible(&reason.observed)));
        }
    }
    for (key, why) in &outcome.not_applicable {
        print(format!("not applicable {}: {}", visible(key), visible(why)));
    }
    let counts: Vec<String> = summary
        .verdicts
        .iter()
        .filter(|(_, count)| **count > 0)
        .map(|(verdict, count)| format!(", {count} {verdict}"))
        .collect();
    let verdict = match summary.exit_code() {
        0 => "conformant, as far as the recording shows",
        1 => "not conformant",
        4 => "nothing judged",
        _ => "inconclusive",
    };
    let inconclusive = summary.count(Verdict::Inconclusive);
    let more = if inconclusive > 0 { " (reasons above and in the report)" } else { "" };
    print(format!("{verdict}: {} cases{}{more}", summary.cases, counts.concat()));
    print(format!("report: {}", args.out.join("report.html").display()));
}
