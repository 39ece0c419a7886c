//! `fsct campaign bits`.

mod table;

use super::{Choice, Common, Ground, NOTHING_RAN, USAGE, bench, fail, print, progress};
use crate::campaign::Bench;
use crate::injection::corruption::{Corruptions, Kind, MAX_ALL_BURSTS, MAX_BURST, MAX_FLIPS};
use crate::injection::exhaustive::{Outcome, Sweep};
use crate::injection::{Halt, Script, Target};
use crate::trace::hex;
use fsct_adapters::{Address, Offer, Role, Variant};
use fsct_reports::campaign;
use std::collections::BTreeMap;
use std::num::NonZero;
use std::ops::RangeInclusive;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc;
use std::thread;
use std::time::{Duration, Instant};
use table::Table;

/// Failures after which a campaign stops, and after which the corruptions of one kind at one length do.
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
    /// Of the bursts of one length at most so many, drawn at random
    #[arg(long, value_name = "N", requires = "bursts", value_parser = clap::value_parser!(u64).range(1..))]
    sample: Option<u64>,
    /// Only SPDUs of this many octets
    #[arg(long, value_name = "OCTETS")]
    length: Option<usize>,
    /// How many DUTs are reached at a time; a DUT of its own for each core where they are in process, else one
    #[arg(long, value_name = "N")]
    jobs: Option<NonZero<usize>>,
    #[command(flatten)]
    choice: Choice,
    #[command(flatten)]
    common: Common,
}

pub(super) fn range(text: &str) -> Result<RangeInclusive<usize>, String> {
    let (from, upto) = text.split_once("..").unwrap_or((text, text));
    let upto = upto.strip_prefix('=').unwrap_or(upto);
    let range = from.parse().ok().zip(upto.parse().ok()).map(|(from, upto)| from..=upto);
    range
        .filter(|range: &RangeInclusive<usize>| {
            *range.start() >= 1 && range.start() <= range.end() && *range.end() <= MAX_FLIPS
        })
        .ok_or_else(|| format!("1 to {MAX_FLIPS} bits are meant, such as 2 or 1..3"))
}

/// All corruptions of one kind at one length: what a worker does in one go. Its result depends on nothing else.
struct Unit {
    variant: Variant,
    length: usize,
    kind: Kind,
    corruptions: Corruptions,
}

/// What came of it.
struct Swept {
    outcome: Outcome,
    undetected: Vec<Found>,
    /// Why it did not come to its end.
    halt: Option<Halt>,
    took: Duration,
}

/// A corruption that was not detected, or operation that failed without one.
struct Found {
    /// The SPDU in hexadecimal.
    octets: String,
    /// The list that shows it.
    script: Script,
    /// Kind of the finding.
    kind: String,
}

/// Runs the command.
pub fn run(args: &Args) -> Result<u8, u8> {
    let kinds: Vec<Kind> = match args.bursts {
        Some(longest) if usize::from(longest) > MAX_ALL_BURSTS && args.sample.is_none() => {
            let sentence =
                format!("bursts of more than {MAX_ALL_BURSTS} bits are too many to try all, add --sample 100000");
            return Err(fail(USAGE, sentence));
        }
        Some(longest) => (1..=usize::from(longest)).map(Kind::Burst).collect(),
        None => args.flips.clone().map(Kind::Flips).collect(),
    };
    let (ground, first) = Ground::find(&args.common)?;
    let head = ground.head(campaign::BITS, args.choice.seed, &first);
    let target = ground.target()?;
    let units = units(args, &kinds, ground.profile.role, &first.description.offers);
    if units.is_empty() {
        return Err(fail(NOTHING_RAN, "the DUT offers no SPDU of the edition, mode and length asked for"));
    }
    let jobs = args.jobs.map_or_else(
        || match ground.address {
            Address::Inproc { .. } => thread::available_parallelism().map_or(1, NonZero::get),
            _ => 1,
        },
        NonZero::get,
    );
    let jobs = jobs.min(units.len());
    let bar = progress(units.iter().map(|unit| unit.corruptions.total()).sum());
    let mut table = Table::new();
    print(Table::HEAD);
    let sweep = |unit: &Unit, bench: &mut Option<Bench>, stop: &AtomicBool| {
        let mut done = 0;
        unit.sweep(&ground, &target, args.choice.seed, bench, |count| {
            bar.inc(count - done);
            done = count;
            !stop.load(Ordering::Relaxed)
        })
    };
    let found = in_order(&units, jobs, Some(first).filter(|_| jobs == 1), sweep, |unit, next, swept| {
        let found = table.take(unit, swept);
        if next.is_none_or(|next| next.length != unit.length || next.variant != unit.variant) || table.is_over() {
            bar.suspend(|| table.show_length());
        }
        (found, table.is_over())
    });
    bar.finish_and_clear();
    table.show_all();
    ground.write(campaign::FILE, &table.report(head, &found))?;
    for (number, found) in (1..).zip(&found) {
        print(format!("undetected: {}", found.octets));
        ground.tell(&target, &found.script, &found.kind, number)?;
    }
    table.conclude()
}

/// Has the units swept by so many workers, each with a DUT of its own; `taken` gets what came of them in their order, with the
/// unit behind each, and says what was found and whether that was the last one that counts.
fn in_order(
    units: &[Unit],
    jobs: usize,
    first: Option<Bench>,
    sweep: impl Fn(&Unit, &mut Option<Bench>, &AtomicBool) -> Swept + Sync,
    mut taken: impl FnMut(&Unit, Option<&Unit>, Swept) -> (Vec<Found>, bool),
) -> Vec<Found> {
    let mut all = Vec::new();
    let stop = AtomicBool::new(false);
    if jobs == 1 {
        let mut bench = first;
        for (index, unit) in units.iter().enumerate() {
            let (found, over) = taken(unit, units.get(index + 1), sweep(unit, &mut bench, &stop));
            all.extend(found);
            if over {
                break;
            }
        }
        return all;
    }
    let next = AtomicUsize::new(0);
    let (sender, receiver) = mpsc::channel();
    thread::scope(|scope| {
        for sender in vec![sender; jobs] {
            let (next, stop, sweep) = (&next, &stop, &sweep);
            scope.spawn(move || {
                let mut bench = None;
                while !stop.load(Ordering::Relaxed) {
                    let index = next.fetch_add(1, Ordering::Relaxed);
                    let Some(unit) = units.get(index) else { break };
                    if sender.send((index, sweep(unit, &mut bench, stop))).is_err() {
                        break;
                    }
                }
            });
        }
        let mut waiting = BTreeMap::new();
        let mut due = 0;
        for (index, swept) in receiver {
            waiting.insert(index, swept);
            while let Some((unit, swept)) = units.get(due).zip(waiting.remove(&due)) {
                due += 1;
                let (found, over) = taken(unit, units.get(due), swept);
                all.extend(found);
                if over {
                    stop.store(true, Ordering::Relaxed);
                    return;
                }
            }
        }
    });
    all
}

impl Unit {
    /// Sends the corruptions; `told` as for [`Sweep::run`].
    fn sweep(
        &self,
        ground: &Ground,
        target: &Target<'_>,
        seed: u64,
        bench: &mut Option<Bench>,
        mut told: impl FnMut(u64) -> bool,
    ) -> Swept {
        let begun = Instant::now();
        let mut sweep = Sweep::new(target, self.variant, self.corruptions.clone(), seed);
        let mut undetected = Vec::new();
        let mut halt = None;
        while halt.is_none() && !sweep.is_done() && undetected.len() < FAILURES {
            let ready = match bench.take() {
                Some(ready) => Ok(ready),
                None => bench::connect(&ground.address).map_err(|error| Halt::Bench(error.to_string())),
            };
            let mut ready = match ready {
                Ok(ready) => ready,
                Err(why) => {
                    halt = Some(why);
                    break;
                }
            };
            match sweep.run(&mut ready, &mut told) {
                Ok(None) => {}
                Ok(Some(found)) => undetected.push(Found {
                    octets: hex(found.octets.as_slice()),
                    script: found.script,
                    kind: found.finding.kind,
                }),
                Err(stopped) => {
                    if let Halt::Failure(finding) = &stopped {
                        // Before the first corruption, or on the way back behind one: the start alone is the list.
                        let script =
                            Script { role: target.profile.role, variant: self.variant, seed, actions: Vec::new() };
                        let octets = "none: operation itself fails".to_owned();
                        undetected.push(Found { octets, script, kind: finding.kind.clone() });
                    }
                    halt = Some(stopped);
                }
            }
            if !matches!(halt, Some(Halt::Bench(_))) {
                *bench = Some(ready);
            }
        }
        Swept { outcome: sweep.outcome, undetected, halt, took: begun.elapsed() }
    }
}

/// What there is to do, length by length.
fn units(args: &Args, kinds: &[Kind], role: Role, offers: &[Offer]) -> Vec<Unit> {
    let mut units = Vec::new();
    for variant in variants(args, role, offers) {
        let pd = if role == Role::Device { variant.pd_out } else { variant.pd_in };
        let length = variant.mode.spdu_octets(pd.into());
        for kind in kinds {
            let corruptions = match (kind, args.sample) {
                (Kind::Burst(burst), Some(number)) => Corruptions::drawn(*burst, length, number, args.choice.seed),
                _ => Corruptions::new(*kind, length),
            };
            if corruptions.total() > 0 {
                units.push(Unit { variant, length, kind: *kind, corruptions });
            }
        }
    }
    units
}

/// One variant for each edition, mode and SPDU length that the DUT offers, or those asked for.
fn variants(args: &Args, role: Role, offers: &[Offer]) -> Vec<Variant> {
    let offers = args.choice.offers(role, offers);
    let mut variants = Vec::new();
    for offer in &offers {
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
