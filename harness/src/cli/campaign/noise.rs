//! `fsct campaign noise`: the measured residual error probability beside the exact one.

mod plot;

use super::{Common, Ground, INCONCLUSIVE, NOTHING_RAN, bench, fail, print, progress};
use crate::campaign::Bench;
use crate::injection::bound::interval;
use crate::injection::noise::{Noise, Tried, sweep};
use crate::injection::{Finding, Halt, Target};
use fsct_adapters::{Address, Role, Variant};
use fsct_protocol::{Edition, ProtMode};
use fsct_reports::campaign::{self, FILE, NOISE, NoiseRow};
use fsct_reports::visible;
use fsct_residual::{CRC_16, Weights, distributions};
use std::num::NonZero;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicU64, AtomicUsize, Ordering};
use std::thread;

/// Bit error probabilities where a million SPDUs show something.
const USUAL: [f64; 6] = [0.05, 0.1, 0.14, 0.2, 0.3, 0.5];
/// What each interval is meant to hold. With 24 of them one campaign in forty has a true value outside.
const CONFIDENCE: f64 = 0.999;

/// Arguments.
#[derive(clap::Args, Debug)]
pub struct Args {
    /// Probabilities that a bit is wrong, up to 0.5
    #[arg(long = "ber", value_name = "P,..", value_delimiter = ',', value_parser = probability, default_values_t = USUAL)]
    probabilities: Vec<f64>,
    /// SPDUs sent at each of them and each length
    #[arg(long, value_name = "N", default_value_t = 1_000_000, value_parser = clap::value_parser!(u64).range(1..))]
    spdus: u64,
    /// Only SPDUs of this many octets, 4 to 7
    #[arg(long, value_name = "OCTETS", value_parser = clap::value_parser!(u8).range(4..=7))]
    length: Option<u8>,
    /// Edition of the DUT; CRC-16 is the same in both
    #[arg(long, default_value = "iec2022")]
    edition: Edition,
    /// Seed that everything random derives from
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// How many DUTs are reached at a time; a DUT of its own for each core where they are in process, else one
    #[arg(long, value_name = "N")]
    jobs: Option<NonZero<usize>>,
    #[command(flatten)]
    common: Common,
}

fn probability(text: &str) -> Result<f64, String> {
    let found = text.parse().ok().filter(|p| *p > 0.0 && *p <= 0.5);
    found.ok_or_else(|| "a probability above 0 and up to 0.5 is meant, such as 0.1".to_owned())
}

/// One length at one bit error probability.
struct Point {
    variant: Variant,
    octets: usize,
    noise: Noise,
}

/// A point with what was measured.
fn row(point: &Point, tried: Tried, exact: f64) -> NoiseRow {
    let Tried { spdus, corrupted, undetected, exchanges } = tried;
    NoiseRow {
        octets: point.octets,
        bit_error_probability: point.noise.p,
        spdus,
        corrupted,
        undetected,
        exchanges,
        measured: undetected as f64 / spdus as f64,
        interval: interval(undetected, spdus, CONFIDENCE),
        exact,
    }
}

/// Runs the command.
pub fn run(args: &Args) -> Result<u8, u8> {
    let (ground, first) = Ground::find(&args.common)?;
    let target = ground.target()?;
    let points = points(args, ground.profile.role, &first);
    if points.is_empty() {
        let sentence =
            "the DUT offers no SPDU with CRC-16 of the edition and length asked for; with CRC-32 nothing would be seen";
        return Err(fail(NOTHING_RAN, sentence));
    }
    let mut octets: Vec<usize> = points.iter().map(|point| point.octets).collect();
    octets.dedup();
    let weights = distributions(CRC_16, &octets, &|_, _| {}).map_err(|why| fail(super::USAGE, why))?;
    let cores = match ground.address {
        Address::Inproc { .. } => thread::available_parallelism().map_or(1, NonZero::get),
        _ => 1,
    };
    let jobs = args.jobs.map_or(cores, NonZero::get).min(points.len());
    let head = ground.head(NOISE, args.seed, &first);
    let mut report = campaign::Noise { head, confidence: CONFIDENCE, rows: Vec::new(), failed: None };
    let swept = sweep_all(&ground, &target, &points, jobs, first);
    // One that was stopped because another one failed says nothing.
    let ended = points.iter().zip(&swept).filter_map(|(point, swept)| Some((point, swept.as_ref().err()?)));
    let halted = ended.min_by_key(|(_, halt)| **halt == Halt::Interrupted);
    print(COLUMNS);
    for (point, tried) in points.iter().zip(&swept).filter_map(|(point, swept)| Some((point, swept.as_ref().ok()?))) {
        let exact = weights.iter().find(|weights| weights.octets() == point.octets);
        let row = row(point, *tried, exact.map_or(f64::NAN, |weights| weights.residual(point.noise.p)));
        print(line(&row));
        report.rows.push(row);
    }
    match halted {
        Some((point, Halt::Failure(finding))) => {
            report.failed = Some(format!("expected {}, observed {}", finding.expected, finding.observed));
            write(&ground, &report, &weights)?;
            return Ok(failed(args, point, finding));
        }
        Some((_, halt)) => return Err(Ground::ended(halt)),
        None => {}
    }
    let plot = write(&ground, &report, &weights)?;
    print(format!("plot     {}", plot.display()));
    conclude(&report.rows)
}

fn conclude(rows: &[NoiseRow]) -> Result<u8, u8> {
    let spdus: u64 = rows.iter().map(|row| row.spdus).sum();
    let undetected: u64 = rows.iter().map(|row| row.undetected).sum();
    print(format!("interval: holds the true value with {} % confidence (Clopper-Pearson)", 100.0 * CONFIDENCE));
    print("undetected: the signature that arrives is right again, by chance and not by fault of the DUT");
    let outside = rows.iter().filter(|row| !row.agrees()).count();
    if outside > 0 {
        let sentence = format!(
            "{outside} of {} exact values lie outside their interval though the DUT judged each SPDU by its signature; another \
             --seed tells whether that was chance",
            rows.len()
        );
        return Err(fail(INCONCLUSIVE, sentence));
    }
    if undetected == 0 {
        let sentence = "no corrupted SPDU carried a right signature, so nothing was measured; raise --spdus";
        return Err(fail(INCONCLUSIVE, sentence));
    }
    print(format!(
        "pass: {spdus} noisy SPDUs, each judged as its signature asks; {undetected} undetected, as often as the exact values say"
    ));
    Ok(0)
}

fn failed(args: &Args, point: &Point, finding: &Finding) -> u8 {
    print(format!("  {} octets at p = {}", point.octets, point.noise.p));
    print(format!("  clause   {} [{}]", visible(&finding.clause), visible(&finding.kind)));
    print(format!("  expected {}", visible(&finding.expected)));
    print(format!("  observed {}", visible(&finding.observed)));
    let (Args { spdus, seed, edition, .. }, dut) = (args, &args.common.dut);
    let (octets, p) = (point.octets, point.noise.p);
    let profile = args.common.profile.as_ref().map_or(String::new(), |profile| format!(" --profile '{profile}'"));
    print(format!(
        "  again    fsct campaign noise --length {octets} --ber {p} --spdus {spdus} --seed {seed} --edition {edition} --dut '{dut}'{profile}"
    ));
    print("fail: a noisy SPDU was not judged by its signature");
    1
}

/// Every length that the DUT offers with CRC-16, at every probability.
fn points(args: &Args, role: Role, bench: &Bench) -> Vec<Point> {
    let offers = &bench.description.offers;
    let offer = offers.iter().find(|offer| offer.mode == ProtMode::Crc16 && offer.edition == args.edition);
    let Some(offer) = offer else { return Vec::new() };
    let range = if role == Role::Device { offer.pd_out } else { offer.pd_in };
    let mut points = Vec::new();
    for pd in range.0..=range.1 {
        let octets = offer.mode.spdu_octets(pd.into());
        if args.length.is_some_and(|length| usize::from(length) != octets) {
            continue;
        }
        let variant = Variant {
            edition: offer.edition,
            mode: offer.mode,
            pd_out: pd.clamp(offer.pd_out.0, offer.pd_out.1),
            pd_in: pd.clamp(offer.pd_in.0, offer.pd_in.1),
        };
        for p in &args.probabilities {
            // A stream of its own for each point, whatever else is asked for.
            let seed = args.seed ^ p.to_bits().rotate_left(7) ^ (octets as u64) << 48;
            points.push(Point { variant, octets, noise: Noise { p: *p, spdus: args.spdus, seed } });
        }
    }
    points
}

/// All points, by so many workers with a DUT of their own; the results come in the order of the points.
fn sweep_all(
    ground: &Ground,
    target: &Target<'_>,
    points: &[Point],
    jobs: usize,
    first: Bench,
) -> Vec<Result<Tried, Halt>> {
    let bar = progress(points.iter().map(|point| point.noise.spdus).sum());
    let (next, done, stop) = (AtomicUsize::new(0), AtomicU64::new(0), AtomicBool::new(false));
    let first = Mutex::new(Some(first));
    let results: Vec<Mutex<Option<Result<Tried, Halt>>>> = points.iter().map(|_| Mutex::new(None)).collect();
    let work = || {
        let mut bench = first.lock().ok().and_then(|mut first| first.take());
        while let Some((point, result)) = {
            let at = next.fetch_add(1, Ordering::Relaxed);
            points.get(at).zip(results.get(at))
        } {
            let ready = bench.take().map_or_else(|| bench::connect(&ground.address), Ok);
            let swept = ready.map_err(|error| Halt::Bench(error.to_string())).and_then(|mut ready| {
                let mut before = 0;
                let swept = sweep(target, &mut ready, point.variant, point.noise, |count| {
                    bar.set_position(done.fetch_add(count - before, Ordering::Relaxed) + count - before);
                    before = count;
                    !stop.load(Ordering::Relaxed)
                });
                bench = swept.is_ok().then_some(ready);
                swept
            });
            stop.fetch_or(swept.is_err(), Ordering::Relaxed);
            if let Ok(mut result) = result.lock() {
                *result = Some(swept);
            }
        }
    };
    thread::scope(|scope| (0..jobs).for_each(|_| drop(scope.spawn(work))));
    bar.finish_and_clear();
    let swept = results.into_iter().map(|result| result.into_inner().ok().flatten().unwrap_or(Err(Halt::Interrupted)));
    swept.collect()
}

const COLUMNS: &str = "octets      p      SPDUs  corrupted undetected   measured  interval              exact";

fn line(row: &NoiseRow) -> String {
    let NoiseRow { octets, bit_error_probability: p, spdus, corrupted, undetected, measured, exact, .. } = row;
    let ((low, high), outside) = (row.interval, if row.agrees() { "" } else { "  outside" });
    format!(
        "{octets:>6} {p:>6} {spdus:>10} {corrupted:>10} {undetected:>10} {measured:>10.2E}  {low:>8.2E} to {high:>8.2E} {exact:>10.4E}{outside}"
    )
}

fn write(ground: &Ground, report: &campaign::Noise, weights: &[Weights]) -> Result<std::path::PathBuf, u8> {
    let text = serde_json::to_string_pretty(report).unwrap_or_default() + "\n";
    ground.write(FILE, &text)?;
    ground.write("noise.svg", &plot::svg(&report.rows, weights))
}
