//! `fsct campaign record`.

use super::{Choice, Common, Ground, INCONCLUSIVE, NOTHING_RAN, USAGE, fail, print, progress};
use crate::injection::corruption::{Corruptions, Kind};
use crate::injection::record::{Tried, sweep};
use crate::trace::hex;
use fsct_adapters::{Role, Variant};
use fsct_protocol::fsp::VerifyRecord;
use fsct_reports::campaign::{FILE, RECORDS, Records, RecordsRow};
use fsct_reports::visible;
use std::ops::RangeInclusive;

/// Arguments.
#[derive(clap::Args, Debug)]
pub struct Args {
    /// How many bits of the record are inverted: 2, or 1..2; each pattern is a start-up of the FS-Device
    #[arg(long, value_name = "FROM..TO", value_parser = super::bits::range, default_value = "1..2")]
    flips: RangeInclusive<usize>,
    #[command(flatten)]
    choice: Choice,
    #[command(flatten)]
    common: Common,
}

/// Runs the command.
pub fn run(args: &Args) -> Result<u8, u8> {
    let (ground, mut bench) = Ground::find(&args.common)?;
    if ground.profile.role != Role::Device {
        return Err(fail(USAGE, "FSP_VerifyRecord is written to an FS-Device"));
    }
    if ground.profile.armed_tech_par_crc() == 0 {
        return Err(fail(
            USAGE,
            format!(
                "profile `{}` does not say FSP_TechParCRC_armed: only an armed FS-Device has to check everything",
                ground.profile.name
            ),
        ));
    }
    let target = ground.target()?;
    let variants: Vec<Variant> = args
        .choice
        .offers(Role::Device, &bench.description.offers)
        .iter()
        .map(|offer| {
            let pd = args.choice.pd.unwrap_or(2).clamp(offer.pd_out.0, offer.pd_out.1);
            let pd_in = pd.clamp(offer.pd_in.0, offer.pd_in.1);
            Variant { edition: offer.edition, mode: offer.mode, pd_out: pd, pd_in }
        })
        .collect();
    if variants.is_empty() {
        return Err(fail(NOTHING_RAN, "the DUT offers nothing of the edition and mode asked for"));
    }
    let head = ground.head(RECORDS, args.choice.seed, &bench);
    let mut report = Records { head, complete: false, rows: Vec::new() };
    let mut records = 0;
    for variant in variants {
        for flips in args.flips.clone() {
            let corruptions = Corruptions::new(Kind::Flips(flips), VerifyRecord::OCTETS);
            let bar = progress(corruptions.total());
            let went = sweep(&target, &mut bench, variant, corruptions, args.choice.seed, |done| {
                bar.set_position(done);
                true
            });
            bar.finish_and_clear();
            let name = format!("{} {} {flips} of 184 bits", variant.edition, variant.mode);
            let (Tried { records: tried, refused }, started) = went.map_err(|halt| Ground::ended(&halt))?;
            records += tried;
            print(format!("{name}: {tried} records, {refused} of them refused"));
            let record = started.as_ref().map(|started| hex(&started.record));
            report.rows.push(RecordsRow { variant: name, flips, records: tried, refused, failed: record });
            if let Some(started) = started {
                print(format!("  record   {}", hex(&started.record)));
                print(format!("  clause   {}", visible(&started.finding.clause)));
                print(format!("  expected {}", visible(&started.finding.expected)));
                print(format!("  observed {}", visible(&started.finding.observed)));
                write(&ground, &report)?;
                print(format!("fail: at record {records}"));
                return Ok(1);
            }
        }
    }
    report.complete = true;
    write(&ground, &report)?;
    if records == 0 {
        return Err(fail(INCONCLUSIVE, "no record was tried"));
    }
    print(format!("pass: {records} falsified records, none starts the SCL; the right one does"));
    Ok(0)
}

fn write(ground: &Ground, report: &Records) -> Result<(), u8> {
    let text = serde_json::to_string_pretty(report).unwrap_or_default() + "\n";
    ground.write(FILE, &text).map(|_| ())
}
