//! `fsct campaign random`.

use super::{Choice, Common, Ground, NOTHING_RAN, fail, print, progress};
use crate::injection::bound::upper_95;
use crate::injection::random::Campaign;
use crate::injection::{Halt, Tally};
use fsct_reports::campaign::{Counts, FILE, RANDOM, Random};

/// Arguments.
#[derive(clap::Args, Debug)]
pub struct Args {
    /// Exchanges, at least
    #[arg(long, value_name = "N", default_value_t = 100_000)]
    exchanges: u64,
    /// Faults among them
    #[arg(long, value_name = "K", default_value_t = 10_000)]
    faults: u64,
    #[command(flatten)]
    choice: Choice,
    #[command(flatten)]
    common: Common,
}

/// Runs the command.
pub fn run(args: &Args) -> Result<u8, u8> {
    let (ground, mut bench) = Ground::find(&args.common)?;
    let head = ground.head(RANDOM, args.choice.seed, &bench);
    let target = ground.target()?;
    let offers = args.choice.offers(ground.profile.role, &bench.description.offers);
    if offers.is_empty() {
        return Err(fail(NOTHING_RAN, "the DUT offers nothing of the edition, mode and size asked for"));
    }
    let campaign = Campaign {
        exchanges: args.exchanges,
        faults: args.faults,
        seed: args.choice.seed,
        offers,
        pd: args.choice.pd,
        watchdog_cycles: ground.profile.watchdog_ns().div_ceil(ground.profile.master_cycle_time_ns),
    };
    let bar = progress(args.exchanges);
    let mut tally = Tally::default();
    let ended = campaign.run(&target, &mut bench, &mut tally, |exchanges| bar.set_position(exchanges));
    bar.finish_and_clear();
    drop(bench);
    let failed = matches!(&ended, Some((_, _, Halt::Failure(_))));
    let sum = tally.sum();
    // A failure stands for one fault that was not dealt with, whether a fault or a good SPDU showed it.
    let undetected = u64::from(failed);
    let trials = sum.detected + undetected;
    let bound = upper_95(undetected, trials);
    let report = Random {
        head,
        complete: ended.is_none(),
        episodes: campaign.episodes(),
        exchanges: tally.exchanges,
        faults: tally.faults.iter().map(|(class, counts)| ((*class).to_owned(), *counts)).collect(),
        had_to_be_detected: trials,
        undetected,
        undetected_fraction_at_most_95: bound,
    };
    let json = serde_json::to_string_pretty(&report).unwrap_or_default() + "\n";
    if tally.exchanges > 0 || failed {
        ground.write(FILE, &json)?;
        table(&tally, sum);
    }
    match ended {
        None => {
            if sum.detected == 0 {
                return Err(fail(
                    super::INCONCLUSIVE,
                    "no fault that has to be detected was injected: nothing was tested",
                ));
            }
            print(format!(
                "pass: {} exchanges, {} of {trials} faults detected that have to be",
                tally.exchanges, sum.detected
            ));
            print(format!(
                "at most {bound:.2e} of such faults go undetected, with 95 % confidence: were it more, a campaign like this would have \
                 shown more of them than it did in 19 of 20 cases (Clopper-Pearson)"
            ));
            Ok(0)
        }
        Some((script, at, halt @ Halt::Failure(_))) => {
            let Halt::Failure(finding) = &halt else { return Ok(1) };
            print(format!("fail: after {} exchanges", tally.exchanges));
            let mut failing = script.clone();
            failing.actions.truncate(at);
            ground.tell(&target, &failing, &finding.kind, 1)?;
            Ok(Ground::ended(&halt))
        }
        Some((_, _, halt)) => Err(Ground::ended(&halt)),
    }
}

fn table(tally: &Tally, sum: Counts) {
    print(format!(
        "{:<20}{:>10}{:>10}{:>10}{:>10}{:>8}",
        "fault", "injected", "detected", "ignored", "valid", "failed"
    ));
    for (class, counts) in tally.faults.iter().map(|(class, counts)| (*class, *counts)).chain([("all", sum)]) {
        let Counts { injected, detected, dropped, valid, failed } = counts;
        print(format!("{class:<20}{injected:>10}{detected:>10}{dropped:>10}{valid:>10}{failed:>8}"));
    }
    print(
        "ignored: lost, late or repeated without the watchdog expiring; valid: a right SPDU in its place, as no receiver can tell",
    );
}
