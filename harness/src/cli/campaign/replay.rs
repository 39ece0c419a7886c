//! `fsct campaign replay`.

use super::{Common, Ground, RIG, USAGE, fail, print, visible_lines};
use crate::injection::{Halt, Ran, Script};
use std::path::PathBuf;

/// Arguments.
#[derive(clap::Args, Debug)]
pub struct Args {
    /// List of actions
    #[arg(value_name = "FILE")]
    file: PathBuf,
    #[command(flatten)]
    common: Common,
}

/// The longest file that is read, in octets.
const LONGEST: u64 = 16 << 20;

/// Runs the command.
pub fn run(args: &Args) -> Result<u8, u8> {
    let name = args.file.display();
    let length = std::fs::metadata(&args.file).map(|found| found.len());
    if length.is_ok_and(|length| length > LONGEST) {
        return Err(fail(USAGE, format!("{name} is longer than a list of actions can be")));
    }
    let text =
        std::fs::read_to_string(&args.file).map_err(|error| fail(USAGE, format!("{name} cannot be read: {error}")))?;
    let script = Script::parse(&text).map_err(|why| fail(USAGE, format!("{name}: {why}")))?;
    let (ground, mut bench) = Ground::find(&args.common)?;
    if ground.profile.role != script.role {
        let sentence = format!("the list is for a {}, the DUT says it is a {}", script.role, ground.profile.role);
        return Err(fail(USAGE, sentence));
    }
    if !bench.description.offers.iter().any(|offer| offer.covers(script.variant)) {
        return Err(fail(USAGE, "the DUT does not offer the edition, mode and sizes of the list"));
    }
    let target = ground.target()?;
    let Ran { tally, halt, record } = target.perform(&mut bench, &script);
    match (halt, record) {
        (None, _) => {
            print(format!("pass: {} actions, {} exchanges", script.actions.len(), tally.exchanges));
            Ok(0)
        }
        (Some((_, halt @ Halt::Failure(_))), Some((json, text))) => {
            let path = ground.write("failure.json", &json)?;
            print("fail:");
            print(visible_lines(text.trim_end()));
            print(format!("  record   {}", path.display()));
            Ok(Ground::ended(&halt))
        }
        (Some((_, Halt::Failure(_))), None) => Err(fail(RIG, "the record of the failure could not be made")),
        (Some((_, halt)), _) => Err(Ground::ended(&halt)),
    }
}
