//! `fsct campaign bits`.

use super::{Choice, Common, Ground, NOTHING_RAN, bench, fail, print, progress};
use crate::injection::corruption::{Kind, MAX_BURST, MAX_FLIPS};
use crate::injection::exhaustive::{Outcome, Sweep};
use crate::injection::stage::Counts;
use crate::injection::{Halt, Target};
use crate::trace::hex;
use fsct_adapters::{Offer, Role, Variant};
use serde::Serialize;
use std::ops::RangeInclusive;

/// Failures after which a campaign stops.
const FAILURES: usize = 5;

/// Arguments.
#[derive(clap::Args, Debug)]
pub struct Args {
    /// How many bits are inverted: 2, or 1..3
    #[arg(long, value_name = "FROM..TO", value_parser = range, default_value = "1..3")]
    flips: RangeInclusive<usize>,
    /// In place of it: every burst of up to this many bits
    #[arg(long, value_name = "BITS", value_parser = clap::value_parser!(u16).range(1..=MAX_BURST as i64))]
    bursts: Option<u16>,
    /// Only SPDUs of this many octets
    #[arg(long, value_name = "OCTETS")]
    length: Option<usize>,
    #[command(flatten)]
    choice: Choice,
    #[command(flatten)]
    common: Common,
}

fn range(text: &str) -> Result<RangeInclusive<usize>, String> {
    let (from, upto) = text.split_once("..").unwrap_or((text, text));
    let upto = upto.strip_prefix('=').unwrap_or(upto);
    let range = from.parse().ok().zip(upto.parse().ok()).map(|(from, upto)| from..=upto);
    range
        .filter(|range: &RangeInclusive<usize>| {
            *range.start() >= 1 && range.start() <= range.end() && *range.end() <= MAX_FLIPS
        })
        .ok_or_else(|| format!("1 to {MAX_FLIPS} bits are meant, such as 2 or 1..3"))
}

#[derive(Serialize)]
struct Row {
    edition: &'static str,
    mode: &'static str,
    length: usize,
    bits: String,
    #[serde(flatten)]
    counts: Counts,
    exchanges: u64,
    complete: bool,
}

#[derive(Serialize)]
struct Report<'r> {
    schema: &'static str,
    seed: u64,
    rows: &'r [Row],
    undetected: &'r [String],
}

/// Runs the command.
pub fn run(args: &Args) -> Result<u8, u8> {
    let (ground, first) = Ground::find(&args.common)?;
    let target = ground.target()?;
    let role = ground.profile.role;
    let variants = variants(args, role, &first.description.offers);
    if variants.is_empty() {
        return Err(fail(NOTHING_RAN, "the DUT offers no SPDU of the edition, mode and length asked for"));
    }
    let kinds: Vec<Kind> = match args.bursts {
        Some(longest) => (1..=usize::from(longest)).map(Kind::Burst).collect(),
        None => args.flips.clone().map(Kind::Flips).collect(),
    };
    let length = |variant: &Variant| {
        let pd = if role == Role::Device { variant.pd_out } else { variant.pd_in };
        variant.mode.spdu_octets(pd.into())
    };
    let total = variants.iter().flat_map(|variant| kinds.iter().map(move |kind| kind.count(length(variant)))).sum();
    let bar = progress(total);
    print(format!(
        "{:<8} {:<6} {:>6} {:<10}{:>11}{:>11}{:>9}{:>7}{:>11}",
        "edition", "mode", "octets", "bits", "injected", "detected", "ignored", "valid", "undetected"
    ));
    let mut rows = Vec::new();
    let mut undetected = Vec::new();
    let mut bench = Some(first);
    let mut ended = None;
    'variants: for variant in &variants {
        for kind in kinds.iter().filter(|kind| kind.count(length(variant)) > 0) {
            let mut one = One { ground: &ground, target: &target, undetected: &mut undetected };
            let done = rows.iter().map(|row: &Row| row.counts.injected).sum::<u64>();
            let before = one.undetected.len();
            let (outcome, halt) =
                one.sweep(args, *variant, *kind, &mut bench, |count| bar.set_position(done + count))?;
            let row = Row {
                edition: variant.edition.name(),
                mode: variant.mode.name(),
                length: length(variant),
                bits: match kind {
                    Kind::Flips(flips) => flips.to_string(),
                    Kind::Burst(burst) => format!("burst {burst}"),
                },
                counts: outcome.counts,
                exchanges: outcome.exchanges,
                complete: outcome.counts.injected == kind.count(length(variant)),
            };
            bar.suspend(|| show(&row));
            rows.push(row);
            for (number, (octets, script, kind)) in (1..).zip(&undetected).skip(before) {
                bar.suspend(|| {
                    print(format!("undetected: {octets}"));
                    ground.tell(&target, script, kind, number)
                })?;
            }
            ended = halt;
            if ended.is_some() || undetected.len() >= FAILURES {
                break 'variants;
            }
        }
    }
    bar.finish_and_clear();
    let octets: Vec<String> = undetected.iter().map(|(octets, ..)| octets.clone()).collect();
    let report = Report { schema: "fsct-campaign-bits/1", seed: args.choice.seed, rows: &rows, undetected: &octets };
    ground.write("campaign.json", &(serde_json::to_string_pretty(&report).unwrap_or_default() + "\n"))?;
    conclude(&rows, undetected.len(), ended.as_ref())
}

fn conclude(rows: &[Row], undetected: usize, ended: Option<&Halt>) -> Result<u8, u8> {
    let mut sum = Counts::default();
    rows.iter().for_each(|row| sum.add(row.counts));
    let exchanges: u64 = rows.iter().map(|row| row.exchanges).sum();
    print(
        "ignored: the counter is that of the SPDU before, so the DUT may not process it; its data were not taken either",
    );
    if sum.valid > 0 {
        print(format!(
            "valid: {} corrupted SPDUs carry the right signature again, by design of the signature and not by fault of the DUT; not sent",
            sum.valid
        ));
    }
    if undetected > 0 {
        let stopped = if rows.iter().all(|row| row.complete) { "" } else { ", stopped there" };
        print(format!("fail: {undetected} corruptions undetected of {}{stopped}", sum.injected));
        return Ok(1);
    }
    if let Some(halt) = ended {
        return Err(Ground::ended(halt));
    }
    if sum.detected == 0 {
        return Err(fail(super::INCONCLUSIVE, "no corruption had to be detected: nothing was tested"));
    }
    print(format!("pass: {} corruptions in {exchanges} exchanges, none undetected", sum.injected));
    Ok(0)
}

fn show(row: &Row) {
    let Counts { injected, detected, dropped, valid, failed } = row.counts;
    print(format!(
        "{:<8} {:<6} {:>6} {:<10}{injected:>11}{detected:>11}{dropped:>9}{valid:>7}{failed:>11}",
        row.edition, row.mode, row.length, row.bits
    ));
}

/// One variant for each SPDU length; of the editions the DUT offers the latest, unless another is asked for.
fn variants(args: &Args, role: Role, offers: &[Offer]) -> Vec<Variant> {
    let offers = args.choice.offers(role, offers);
    let edition = offers.iter().map(|offer| offer.edition).max();
    let mut variants = Vec::new();
    for offer in offers.iter().filter(|offer| Some(offer.edition) == edition) {
        let range = if role == Role::Device { offer.pd_out } else { offer.pd_in };
        for pd in range.0..=range.1 {
            let variant = Variant {
                edition: offer.edition,
                mode: offer.mode,
                pd_out: pd.clamp(offer.pd_out.0, offer.pd_out.1),
                pd_in: pd.clamp(offer.pd_in.0, offer.pd_in.1),
            };
            let length = offer.mode.spdu_octets(pd.into());
            if args.choice.pd.is_none_or(|only| only == pd) && args.length.is_none_or(|only| only == length) {
                variants.push(variant);
            }
        }
    }
    variants
}

/// One kind of corruption at one length.
struct One<'o> {
    ground: &'o Ground,
    target: &'o Target<'o>,
    /// The SPDU in hexadecimal, the list that shows it, the kind of finding.
    undetected: &'o mut Vec<(String, crate::injection::Script, String)>,
}

impl One<'_> {
    fn sweep(
        &mut self,
        args: &Args,
        variant: Variant,
        kind: Kind,
        bench: &mut Option<crate::campaign::Bench>,
        told: impl Fn(u64),
    ) -> Result<(Outcome, Option<Halt>), u8> {
        let mut sweep = Sweep::new(self.target, variant, kind, args.choice.seed);
        while !sweep.is_done() && self.undetected.len() < FAILURES {
            let mut ready = match bench.take() {
                Some(ready) => ready,
                None => bench::connect(&self.ground.address).map_err(|error| fail(super::RIG, error))?,
            };
            match sweep.run(&mut ready, &told) {
                Ok(None) => {}
                Ok(Some(found)) => {
                    self.undetected.push((hex(found.octets.as_slice()), found.script, found.finding.kind));
                }
                Err(Halt::Failure(finding)) => {
                    // Before the first corruption, or on the way back behind one: the start alone is the list.
                    let script = crate::injection::Script {
                        role: self.ground.profile.role,
                        variant,
                        seed: args.choice.seed,
                        actions: Vec::new(),
                    };
                    self.undetected.push(("none: operation itself fails".to_owned(), script, finding.kind.clone()));
                    return Ok((sweep.outcome, Some(Halt::Failure(finding))));
                }
                Err(halt) => return Ok((sweep.outcome, Some(halt))),
            }
            *bench = Some(ready);
        }
        Ok((sweep.outcome, None))
    }
}
