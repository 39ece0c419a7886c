//! `fsct campaign`: errors by the million, and the shortest list of actions behind what fails.

mod bits;
mod noise;
mod random;
mod record;
mod replay;

use super::bench;
use super::run::{candidate_profile, given_profiles};
use super::{Cases, NOTHING_RAN, RIG, USAGE, fail, interruption, print, write};
use crate::campaign::{Bench, dut_info};
use crate::injection::shrink::shrink;
use crate::injection::{Halt, Ran, Script, Tally, Target};
use crate::library::Library;
use crate::profile::{Profile, default_profile};
use clap::Subcommand;
use fsct_adapters::{Address, Offer, Role};
use fsct_protocol::{Edition, ProtMode};
use fsct_reports::campaign::Head;
use fsct_reports::visible;
use std::io::IsTerminal;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

/// Exit code when nothing can be said.
const INCONCLUSIVE: u8 = 5;

/// Arguments of `fsct campaign`.
#[derive(clap::Args, Debug)]
pub struct Args {
    #[command(subcommand)]
    what: What,
}

#[derive(Subcommand, Debug)]
enum What {
    /// Every corruption of an SPDU with so many bits inverted, or every burst, sent to the DUT in operation
    Bits(bits::Args),
    /// Random faults of all classes between random inputs of the application
    Random(random::Args),
    /// Every corruption of FSP_VerifyRecord with so many bits inverted, each at a start-up of an armed FS-Device
    Record(record::Args),
    /// Noise on the way to the DUT: how often a corrupted SPDU is taken, beside the exact residual error probability of CRC-16
    Noise(noise::Args),
    /// Carry a list of actions out that a campaign has written
    Replay(replay::Args),
}

/// What every campaign is asked for.
#[derive(clap::Args, Debug)]
struct Common {
    /// Device under test, as for `fsct run`
    #[arg(long, value_name = "URL", default_value = "inproc:reference-device")]
    dut: String,
    /// Profile of the product: a name the binary carries, or a file
    #[arg(long, value_name = "PROFILE")]
    profile: Option<String>,
    /// Folder for what is written
    #[arg(long, value_name = "DIR", default_value = "fsct-campaign")]
    out: PathBuf,
    #[command(flatten)]
    cases: Cases,
}

/// What a campaign on variants of the DUT is asked for.
#[derive(clap::Args, Debug)]
struct Choice {
    /// Only this edition: v1.1 or iec2022
    #[arg(long)]
    edition: Option<Edition>,
    /// Only this mode: crc16 or crc32
    #[arg(long)]
    mode: Option<ProtMode>,
    /// Only this many octets of FS process data in the SPDU to the DUT
    #[arg(long, value_name = "N")]
    pd: Option<u8>,
    /// Seed that everything random derives from
    #[arg(long, default_value_t = 1)]
    seed: u64,
}

impl Choice {
    /// What of the offers of a DUT is chosen; the sizes with which an SPDU to the DUT can be had are cut to the one asked for.
    fn offers(&self, role: Role, offers: &[Offer]) -> Vec<Offer> {
        let chosen = |offer: &&Offer| {
            let range = if role == Role::Device { offer.pd_out } else { offer.pd_in };
            self.edition.is_none_or(|edition| edition == offer.edition)
                && self.mode.is_none_or(|mode| mode == offer.mode)
                && self.pd.is_none_or(|pd| (range.0..=range.1).contains(&pd))
        };
        offers.iter().filter(chosen).copied().collect()
    }
}

/// Runs the command; the result is the exit code.
pub fn run(args: &Args) -> u8 {
    let done = match &args.what {
        What::Bits(args) => bits::run(args),
        What::Random(args) => random::run(args),
        What::Record(args) => record::run(args),
        What::Noise(args) => noise::run(args),
        What::Replay(args) => replay::run(args),
    };
    done.unwrap_or_else(|code| code)
}

/// Everything a campaign stands on.
struct Ground {
    address: Address,
    url: String,
    library: Library,
    profile: Profile,
    /// As it was given.
    profile_option: Option<String>,
    out: PathBuf,
    interrupted: Arc<AtomicBool>,
}

impl Ground {
    /// Reaches the DUT and finds the profile for it.
    fn find(common: &Common) -> Result<(Ground, Bench), u8> {
        let library = common.cases.load()?;
        let names: Vec<String> = common.profile.iter().cloned().collect();
        let profiles = given_profiles(&names, &library)?;
        let address = bench::parse(&common.dut).map_err(|why| fail(USAGE, why))?;
        let first = bench::connect(&address).map_err(|error| fail(RIG, error))?;
        let role = first.description.role;
        let profile = candidate_profile(role, &profiles, &library)?.clone();
        if let Some(other) = profiles.iter().find(|profile| profile.role != role) {
            let sentence = format!("profile `{}` is for a {}, the DUT says it is a {role}", other.name, other.role);
            return Err(fail(USAGE, sentence));
        }
        let interrupted = interruption();
        let ground = Ground {
            address,
            url: common.dut.clone(),
            library,
            profile,
            profile_option: common.profile.clone(),
            out: common.out.clone(),
            interrupted,
        };
        Ok((ground, first))
    }

    fn target(&self) -> Result<Target<'_>, u8> {
        let allowed = self.profile.allowed(&self.library.tolerances, &[], &[]).map_err(|why| fail(USAGE, why))?;
        Ok(Target { library: &self.library, profile: &self.profile, allowed, interrupted: &self.interrupted })
    }

    /// What the document of a campaign says first.
    fn head(&self, schema: &str, seed: u64, bench: &Bench) -> Head {
        let dut = dut_info(&self.url, &self.profile, bench);
        Head { schema: schema.to_owned(), fsct: env!("CARGO_PKG_VERSION").to_owned(), seed, dut }
    }

    fn write(&self, name: &str, text: &str) -> Result<PathBuf, u8> {
        write(&self.out, name, text)
    }

    /// Carries a list out over a fresh connection.
    fn perform(&self, target: &Target<'_>, script: &Script) -> Ran {
        match bench::connect(&self.address) {
            Ok(mut bench) => target.perform(&mut bench, script),
            Err(error) => {
                Ran { tally: Tally::default(), halt: Some((0, Halt::Bench(error.to_string()))), record: None }
            }
        }
    }

    /// Shrinks what failed, and tells it with the line that repeats it. `number` counts the failures of a campaign from 1. No
    /// connection of the campaign may be left: there are DUTs that serve one at a time.
    fn tell(&self, target: &Target<'_>, script: &Script, kind: &str, number: usize) -> Result<(), u8> {
        let same = |ran: &Ran| matches!(&ran.halt, Some((_, Halt::Failure(finding))) if finding.kind == kind);
        let fails = |script: &Script| same(&self.perform(target, script));
        let suffix = if number == 1 { String::new() } else { format!("-{number}") };
        let again = self.perform(target, script);
        if !same(&again) {
            let path = self.write(&format!("actions{suffix}.jsonl"), &script.to_text())?;
            print(match again.halt {
                Some((_, Halt::Bench(why) | Halt::Inconclusive(why))) => {
                    format!("  it could not be tried again over a fresh connection: {}", visible(&why))
                }
                Some((_, Halt::Interrupted)) => "  it was not tried again: stopped by the user".to_owned(),
                Some((_, Halt::Failure(_))) | None => "  it did not fail so again over a fresh connection: what came \
                     before in the campaign matters, or the DUT varies"
                    .to_owned(),
            });
            print(format!("  actions  {}", path.display()));
            return Ok(());
        }
        let (shrunk, tries) = shrink(script, fails);
        let path = self.write(&format!("actions{suffix}.jsonl"), &shrunk.to_text())?;
        if let Some((json, text)) = self.perform(target, &shrunk).record {
            self.write(&format!("failure{suffix}.json"), &json)?;
            print(visible_lines(text.trim_end()));
        }
        print(format!("  shrunk   from {} actions to {} in {tries} tries", script.actions.len(), shrunk.actions.len()));
        print(format!("  replay   {}", self.replay(&path)));
        Ok(())
    }

    fn replay(&self, path: &Path) -> String {
        let mut line = format!("fsct campaign replay '{}' --dut '{}'", path.display(), self.url);
        if let Some(profile) = &self.profile_option
            && *profile != default_profile(self.profile.role)
        {
            line += &format!(" --profile '{profile}'");
        }
        line
    }

    /// The exit code for what ended a campaign, with one line on stderr; a failure is told elsewhere.
    fn ended(halt: &Halt) -> u8 {
        match halt {
            Halt::Failure(_) => 1,
            Halt::Inconclusive(why) => fail(INCONCLUSIVE, why),
            Halt::Bench(why) => fail(RIG, why),
            Halt::Interrupted => fail(RIG, "stopped by the user"),
        }
    }
}

/// Text of several lines, each made harmless.
fn visible_lines(text: &str) -> String {
    text.lines().map(visible).collect::<Vec<_>>().join("\n")
}

/// One line on a terminal: how much is done, how long it took and will take. Nothing elsewhere.
pub(super) fn progress(length: u64) -> indicatif::ProgressBar {
    if !std::io::stderr().is_terminal() {
        return indicatif::ProgressBar::hidden();
    }
    let style = indicatif::ProgressStyle::with_template(
        "{wide_bar} {human_pos} of {human_len} ({percent} %), {elapsed} and {eta} to go",
    );
    indicatif::ProgressBar::new(length).with_style(style.unwrap_or_else(|_| indicatif::ProgressStyle::default_bar()))
}
