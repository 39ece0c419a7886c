//! Holds what lines have shown against the limits: the same for a case on a DUT and for a recording. Values in, measurements
//! and findings out; nothing here knows where the values come from.

use crate::profile::Profile;
use fsct_adapters::Role;
use fsct_lines::{
    Answer, Bounds, Claim, Episode, Given, Judged, Limit, Limits, Measured, Outside, Quantity, Row, judge_looks,
};
use fsct_protocol::Edition;
use fsct_reports::measurement::{Counted, Measurement};
use fsct_reports::record::{Check, Verdict};

/// What values and claims are judged by.
#[derive(Copy, Clone, Debug)]
pub struct Judge<'j> {
    /// All limits.
    pub limits: &'j Limits,
    /// The edition whose limits count.
    pub edition: Edition,
    /// What the product declares.
    pub profile: &'j Profile,
    /// Which side the DUT is.
    pub role: Role,
    /// How far an edge may be off either way, in nanoseconds.
    pub uncertainty_ns: u64,
    /// Whether a value outside fails, or is a remark because nothing the case judges is demanded.
    pub demands: bool,
}

/// Something that is not as it has to be, or not known.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Finding {
    /// What it comes to.
    pub verdict: Verdict,
    /// Its kind, as in a record.
    pub kind: String,
    /// Clause.
    pub clause: String,
    /// What was expected.
    pub expected: String,
    /// What was observed.
    pub observed: String,
}

/// A quantity with the limit it is held against.
#[derive(Copy, Clone, Debug)]
pub struct Ruled<'j> {
    judge: Judge<'j>,
    quantity: Quantity,
    limit: &'j Limit,
    row: &'j Row,
    bounds: Bounds,
}

impl<'j> Judge<'j> {
    fn bounds(&self, quantity: Quantity) -> Option<Bounds> {
        let limit = self.limits.get(quantity.symbol())?;
        limit.bounds(self.edition, |name| self.profile.declared(name))
    }

    /// The limit of a quantity.
    ///
    /// # Errors
    /// A [`Finding`] where the edition has none.
    pub fn quantity(&self, quantity: Quantity) -> Result<Ruled<'j>, Finding> {
        let symbol = quantity.symbol();
        let limit = self.limits.get(symbol);
        let Some((limit, row)) = limit.and_then(|limit| limit.row(self.edition).map(|row| (limit, row))) else {
            return Err(Finding {
                verdict: Verdict::Inconclusive,
                kind: "case/limit".to_owned(),
                clause: String::new(),
                expected: format!("a limit {symbol}"),
                observed: format!("{} has no such limit", self.edition),
            });
        };
        let bounds = self.bounds(quantity).unwrap_or_default();
        Ok(Ruled { judge: *self, quantity, limit, row, bounds })
    }

    /// What a claim needs to know.
    pub fn given(&self) -> Given {
        Given {
            uncertainty_ns: self.uncertainty_ns,
            ossde: self.role == Role::Master || self.profile.features.iter().any(|feature| feature == "ossde"),
            ossd_not_before: self.bounds(Quantity::ReadyToOssd).and_then(|bounds| bounds.min),
            wait_at_most: self.bounds(Quantity::WaitForReady).and_then(|bounds| bounds.max),
        }
    }

    fn weighs(&self, verdict: Verdict) -> Verdict {
        if self.demands { verdict } else { verdict.min(Verdict::Remark) }
    }
}

impl Ruled<'_> {
    /// Whether a value is a time still running that says nothing: one that is not too long yet.
    pub fn says_nothing(&self, value: &Measured) -> bool {
        value.high == u64::MAX && value.judge(self.bounds).verdict != fsct_lines::Verdict::Fail
    }

    /// Nothing was measured; `why` where that is known. `None` for a value nobody has to have.
    pub fn nothing(&self, why: &str) -> Option<Finding> {
        (self.limit.outside(self.judge.edition) == Outside::Fail).then(|| Finding {
            verdict: Verdict::Inconclusive,
            kind: format!("measure/{}", self.limit.symbol),
            clause: self.row.clause.clone(),
            expected: self.what(),
            observed: if why.is_empty() { "nothing that could be measured".to_owned() } else { why.to_owned() },
        })
    }

    fn what(&self) -> String {
        format!("{}: {}", self.limit.symbol, self.limit.about)
    }

    /// Judges a value; a finding where it does not simply pass.
    pub fn value(&self, value: &Measured, step: usize) -> (Measurement, Option<Finding>) {
        let Ruled { judge, quantity, limit, row, bounds } = self;
        let judged = match quantity {
            Quantity::DeviceWatchdog | Quantity::MasterWatchdog => {
                // What the application tells is no look.
                let apart = if value.low == value.high { 0 } else { judge.profile.master_cycle_time_ns };
                judge_looks(value.low, value.high, value.uncertainty, apart, *bounds)
            }
            _ => value.judge(*bounds),
        };
        let verdict = weigh(judged, limit.outside(judge.edition));
        let measurement = Measurement {
            symbol: limit.symbol.clone(),
            about: limit.about.clone(),
            clause: row.clause.clone(),
            step,
            at_ns: value.at,
            counted: if quantity.is_ratio() { Counted::PartsPerBillion } else { Counted::Nanoseconds },
            low: value.low,
            high: (value.high != u64::MAX).then_some(value.high),
            uncertainty: value.uncertainty,
            min: bounds.min,
            max: bounds.max,
            margin: judged.margin,
            verdict,
        };
        let finding = (verdict > Verdict::Pass).then(|| Finding {
            verdict: judge.weighs(verdict),
            kind: format!("measure/{}", limit.symbol),
            clause: row.clause.clone(),
            expected: format!("{}, {}", self.what(), measurement.limits()),
            observed: measurement.value(),
        });
        (measurement, finding)
    }
}

/// What episodes have said to a claim.
#[derive(Copy, Clone, Debug, Default)]
pub struct Asked {
    broken: Option<u64>,
    holds: bool,
}

impl Asked {
    /// Asks one more episode.
    pub fn ask(&mut self, claim: Claim, episode: &Episode, given: Given) {
        match claim.ask(episode, given) {
            Answer::Broken(at) => {
                self.broken.get_or_insert(at);
            }
            Answer::Holds => self.holds = true,
            Answer::Unknown => {}
        }
    }

    /// What it comes to: a check, and a finding where the claim does not hold.
    pub fn end(&self, claim: Claim, judge: &Judge<'_>) -> (Check, Option<Finding>) {
        let met = self.broken.is_none() && self.holds;
        let observed = match self.broken {
            Some(at) => format!("not so at {}", fsct_reports::measurement::time(at)),
            None if met => "so".to_owned(),
            None => "not seen".to_owned(),
        };
        let verdict = if self.broken.is_some() { Verdict::Fail } else { Verdict::Inconclusive };
        let finding = (!met).then(|| Finding {
            verdict: judge.weighs(verdict),
            kind: format!("lines/{}", claim.name()),
            clause: claim.clause().to_owned(),
            expected: claim.about().to_owned(),
            observed: observed.clone(),
        });
        (Check { key: claim.name().to_owned(), expected: claim.about().to_owned(), observed, met }, finding)
    }
}

/// What a judged value comes to for the DUT.
fn weigh(judged: Judged, outside: Outside) -> Verdict {
    match (judged.verdict, outside) {
        (fsct_lines::Verdict::Pass, _) | (_, Outside::Recorded) => Verdict::Pass,
        (fsct_lines::Verdict::Fail, Outside::Fail) => Verdict::Fail,
        (fsct_lines::Verdict::Fail, Outside::Remark) => Verdict::Remark,
        (fsct_lines::Verdict::Inconclusive, Outside::Remark) => Verdict::Remark,
        (fsct_lines::Verdict::Inconclusive, Outside::Fail) => Verdict::Inconclusive,
    }
}
