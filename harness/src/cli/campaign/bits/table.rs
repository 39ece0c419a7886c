//! What came of a campaign on bits: a line a length, a report a machine can read, and the conclusion.

use super::super::{Ground, INCONCLUSIVE, fail, print};
use super::{FAILURES, Found, Swept, Unit};
use crate::injection::Halt;
use crate::injection::bound::upper_95;
use crate::injection::corruption::Kind;
use fsct_reports::campaign::{Bits, BitsRow, Counts, Head};
use std::time::{Duration, Instant};

/// A row with the time it took. The same campaign gives the same rows, so no row holds a time.
struct Timed {
    row: BitsRow,
    took: Duration,
}

/// All rows so far.
pub struct Table {
    rows: Vec<Timed>,
    /// Rows in the lines that are shown.
    shown: usize,
    undetected: usize,
    ended: Option<Halt>,
    begun: Instant,
}

impl Table {
    /// Names of the columns.
    pub const HEAD: &'static str =
        "edition  mode   octets bits          injected   detected  ignored  valid undetected  at most      time";

    /// Nothing yet.
    pub fn new() -> Table {
        Table { rows: Vec::new(), shown: 0, undetected: 0, ended: None, begun: Instant::now() }
    }

    /// Takes a row, and hands back what was found.
    pub fn take(&mut self, unit: &Unit, swept: Swept) -> Vec<Found> {
        let counts = swept.outcome.counts;
        let row = BitsRow {
            edition: unit.variant.edition.name().to_owned(),
            mode: unit.variant.mode.name().to_owned(),
            length: unit.length,
            bits: match unit.kind {
                Kind::Flips(flips) => flips.to_string(),
                Kind::Burst(burst) => format!("burst {burst}"),
            },
            counts,
            exchanges: swept.outcome.exchanges,
            undetected_fraction_at_most_95: bound(counts),
            complete: counts.injected == unit.corruptions.total(),
        };
        self.rows.push(Timed { row, took: swept.took });
        self.undetected += swept.undetected.len();
        self.ended = swept.halt;
        swept.undetected
    }

    /// Whether nothing more is to be done.
    pub fn is_over(&self) -> bool {
        self.ended.is_some() || self.undetected >= FAILURES
    }

    /// Shows the rows of a length in one line.
    pub fn show_length(&mut self) {
        let rows = &self.rows[self.shown..];
        self.shown = self.rows.len();
        let (Some(Timed { row: first, .. }), Some(Timed { row: last, .. })) = (rows.first(), rows.last()) else {
            return;
        };
        let bits = match last.bits.strip_prefix("burst ") {
            Some(longest) if first.bits != last.bits => format!("{}..{longest}", first.bits),
            None if first.bits != last.bits => format!("{}..{}", first.bits, last.bits),
            _ => first.bits.clone(),
        };
        let name = format!("{:<8} {:<6} {:>6} {bits:<11}", first.edition, first.mode, first.length);
        line(&name, sum(rows), rows.iter().map(|timed| timed.took).sum());
    }

    /// Shows all rows in one line.
    pub fn show_all(&self) {
        line(&format!("{:<34}", "all"), sum(&self.rows), self.begun.elapsed());
    }

    /// The report.
    pub fn report(&self, head: Head, found: &[Found]) -> String {
        let sum = sum(&self.rows);
        let report = Bits {
            head,
            had_to_be_detected: sum.detected + sum.failed,
            undetected_fraction_at_most_95: bound(sum),
            rows: self.rows.iter().map(|timed| timed.row.clone()).collect(),
            undetected: found.iter().map(|found| found.octets.clone()).collect(),
        };
        serde_json::to_string_pretty(&report).unwrap_or_default() + "\n"
    }

    /// Says what it comes to; the exit code.
    pub fn conclude(&self) -> Result<u8, u8> {
        let sum = sum(&self.rows);
        let exchanges: u64 = self.rows.iter().map(|timed| timed.row.exchanges).sum();
        print(
            "ignored: the counter is that of the SPDU before, so the DUT may not process it; its data were not taken either",
        );
        print(
            "at most: of such corruptions, in states and with data like those here, with 95 % confidence (Clopper-Pearson)",
        );
        if sum.valid > 0 {
            print(format!(
                "valid: {} corrupted SPDUs carry the right signature again, by design of the signature and not by fault of the DUT; not sent",
                sum.valid
            ));
        }
        if self.undetected > 0 {
            let stopped = if self.rows.iter().all(|timed| timed.row.complete) { "" } else { ", stopped there" };
            print(format!("fail: {} corruptions undetected of {}{stopped}", self.undetected, sum.injected));
            return Ok(1);
        }
        if let Some(halt) = &self.ended {
            return Err(Ground::ended(halt));
        }
        if sum.detected == 0 {
            return Err(fail(INCONCLUSIVE, "no corruption had to be detected: nothing was tested"));
        }
        print(format!("pass: {} corruptions in {exchanges} exchanges, none undetected", sum.injected));
        Ok(0)
    }
}

/// What could have gone undetected for all that is known.
fn bound(counts: Counts) -> f64 {
    upper_95(counts.failed, counts.detected + counts.failed)
}

fn sum(rows: &[Timed]) -> Counts {
    let mut sum = Counts::default();
    rows.iter().for_each(|timed| sum.add(timed.row.counts));
    sum
}

fn line(name: &str, counts: Counts, took: Duration) {
    let Counts { injected, detected, dropped, valid, failed } = counts;
    print(format!(
        "{name}{injected:>11}{detected:>11}{dropped:>9}{valid:>7}{failed:>11}{:>9.1e}{:>8.1} s",
        bound(counts),
        took.as_secs_f64()
    ));
}
