//! What a case does to the lines of an FS-Device, and what it wants measured.

use super::{Engine, Stop};
use crate::case::model::{After, Wake, Wanted};
use fsct_adapters::{Line, Mode, Role, Stimulus};
use fsct_lines::{Answer, Claim, Given, Judged, Measured, Outside, Quantity, judge_looks};
use fsct_reports::measurement::{Counted, Measurement};
use fsct_reports::record::{Check, Verdict};

/// Steps while a Ready pulse is awaited: shorter than the shortest one that passes.
const COARSE_NS: u64 = 400_000;
/// Steps during it: half of t_RW.
const FINE_NS: u64 = 25_000;
/// A Ready pulse that comes later than this after its time is measured as missing.
const OVERDUE_NS: u64 = 100_000_000;
/// What a woken FS-Device may take until it answers: three transmission rates are tried.
const ANSWER_NS: u64 = 50_000_000;

impl Engine<'_, '_> {
    /// Lets time pass until the Ready pulse is over, or both outputs are ON; the time of that, unless it is overdue.
    pub(super) fn await_lines(&mut self, after: After) -> Result<Option<u64>, Stop> {
        let bound = |quantity: Quantity| {
            let limit = self.judging.limits.get(quantity.symbol())?;
            limit.bounds(self.session.setup().edition, |name| self.session.profile.declared(name))?.max
        };
        let ready = bound(Quantity::TimeToReady).unwrap_or(0) + OVERDUE_NS;
        let ossde = self.session.profile.ossde_within_ms * 1_000_000;
        let deadline = self.session.now + if after == After::Ossde { ready + ossde } else { ready };
        loop {
            let now = self.session.now;
            let lines = &mut self.session.link_mut().lines;
            let seen = match after {
                After::ReadyPulse => lines.ready(),
                After::Ossde => lines.both_on(now),
            };
            if seen.is_some() || now >= deadline {
                return Ok(seen);
            }
            let fine = after == After::ReadyPulse && lines.cq();
            self.session.pass(if fine { FINE_NS } else { COARSE_NS.min(deadline - now) })?;
        }
    }

    /// What was awaited did not come. A missing Ready pulse shows as its time; for OSSDe operation there is no other sign.
    pub(super) fn overdue(&mut self, after: After) {
        if after == After::Ossde {
            let within = fsct_reports::measurement::time(self.session.profile.ossde_within_ms * 1_000_000);
            let expected = format!("without a wake-up OSSDe operation within {within} of the Ready pulse");
            let verdict = if self.judging.demands { Verdict::Fail } else { Verdict::Remark };
            self.reason(verdict, "lines/OSSDe", "5.3.3, 5.7, Figure 21", &expected, "the outputs do not switch ON");
        }
    }

    /// A wake-up request so long after the end of the Ready pulse, which is awaited first.
    pub(super) fn wake(&mut self, wake: &Wake) -> Result<(), Stop> {
        let port = self.session.link().port;
        let Some(fall) = self.await_lines(After::ReadyPulse)? else { return Ok(()) };
        let due = fall + self.nanoseconds(wake.after).unsigned_abs();
        if let Some(rest) = due.checked_sub(self.session.now).filter(|rest| *rest > 0) {
            self.session.pass(rest)?;
        }
        self.session.act(Stimulus::Drive { port, line: Line::WakeUp, level: true })?;
        let woken_at = self.session.link().lines.woken_at().unwrap_or(self.session.now);
        let until = self.session.now + ANSWER_NS;
        while self.session.link().mode == Mode::Inactive && self.session.now < until {
            self.session.pass(ANSWER_NS / 50)?;
        }
        let answered = self.session.link().mode != Mode::Inactive;
        let uncertainty_ns = self.session.description.clock.uncertainty_ns;
        self.session.link_mut().lines.woken(woken_at, woken_at.saturating_sub(fall), answered, uncertainty_ns);
        Ok(())
    }

    /// Takes the values a step wants, judges each, and records it.
    pub(super) fn measure(&mut self, wanted: &[Wanted]) {
        for wanted in wanted {
            match wanted {
                Wanted::Quantity(quantity) => self.quantity(*quantity),
                Wanted::Claim(claim) => self.claim(*claim),
            }
        }
    }

    fn quantity(&mut self, quantity: Quantity) {
        let (now, uncertainty_ns) = (self.session.now, self.session.description.clock.uncertainty_ns);
        let values: Vec<Measured> = match quantity {
            Quantity::DeviceWatchdog | Quantity::MasterWatchdog => {
                let stopwatch = self.session.link().stopwatch.as_ref();
                stopwatch.and_then(|watch| watch.measured(quantity, uncertainty_ns)).into_iter().collect()
            }
            _ => self.session.link_mut().lines.measured(quantity, now, uncertainty_ns),
        };
        self.checks += 1;
        let symbol = quantity.symbol();
        let edition = self.session.setup().edition;
        let profile = self.session.profile;
        let Some((limit, row)) =
            self.judging.limits.get(symbol).and_then(|limit| limit.row(edition).map(|row| (limit, row)))
        else {
            let observed = format!("{edition} has no such limit");
            return self.reason(Verdict::Inconclusive, "case/limit", "", &format!("a limit {symbol}"), &observed);
        };
        let bounds = limit.bounds(edition, |name| profile.declared(name)).unwrap_or_default();
        let outside = limit.outside(edition);
        let what = format!("{symbol}: {}", limit.about);
        // A time that is still running says nothing unless it is too long already.
        let known = values.iter().any(|value| value.high != u64::MAX);
        let too_long = |value: &Measured| value.judge(bounds).verdict == fsct_lines::Verdict::Fail;
        let values: Vec<Measured> =
            values.into_iter().filter(|value| !known || value.high != u64::MAX || too_long(value)).collect();
        if values.is_empty() && outside != Outside::Fail {
            // A value nobody has to have.
            return;
        }
        if values.is_empty() {
            return self.reason(
                Verdict::Inconclusive,
                &format!("measure/{symbol}"),
                &row.clause,
                &what,
                "nothing that could be measured",
            );
        }
        for value in values {
            let judged = match quantity {
                Quantity::DeviceWatchdog | Quantity::MasterWatchdog => {
                    // What the application tells is no look.
                    let apart = if value.low == value.high { 0 } else { profile.master_cycle_time_ns };
                    judge_looks(value.low, value.high, value.uncertainty, apart, bounds)
                }
                _ => value.judge(bounds),
            };
            let verdict = weigh(judged, outside);
            let measurement = Measurement {
                symbol: symbol.to_owned(),
                about: limit.about.clone(),
                clause: row.clause.clone(),
                step: self.step,
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
            if verdict > Verdict::Pass {
                let expected = format!("{what}, {}", measurement.limits());
                let observed = measurement.value();
                let verdict = if self.judging.demands { verdict } else { verdict.min(Verdict::Remark) };
                self.reason(verdict, &format!("measure/{symbol}"), &row.clause, &expected, &observed);
            }
            self.outcome.measurements.push(measurement);
        }
    }

    fn claim(&mut self, claim: Claim) {
        let now = self.session.now;
        let edition = self.session.setup().edition;
        let profile = self.session.profile;
        let bounds = |quantity: Quantity| {
            let limit = self.judging.limits.get(quantity.symbol())?;
            limit.bounds(edition, |name| profile.declared(name))
        };
        let given = Given {
            uncertainty_ns: self.session.description.clock.uncertainty_ns,
            ossde: self.session.role() == Role::Master || profile.features.iter().any(|feature| feature == "ossde"),
            ossd_not_before: bounds(Quantity::ReadyToOssd).and_then(|bounds| bounds.min),
            wait_at_most: bounds(Quantity::WaitForReady).and_then(|bounds| bounds.max),
        };
        let answers: Vec<Answer> =
            self.session.link_mut().lines.episodes(now).iter().map(|episode| claim.ask(episode, given)).collect();
        self.checks += 1;
        let broken = answers.iter().find_map(|answer| match answer {
            Answer::Broken(at) => Some(*at),
            _ => None,
        });
        let holds = broken.is_none() && answers.contains(&Answer::Holds);
        let observed = match broken {
            Some(at) => format!("not so at {}", fsct_reports::measurement::time(at)),
            None if holds => "so".to_owned(),
            None => "not seen".to_owned(),
        };
        if !holds {
            let verdict = if broken.is_some() { Verdict::Fail } else { Verdict::Inconclusive };
            let verdict = if self.judging.demands { verdict } else { verdict.min(Verdict::Remark) };
            self.reason(verdict, &format!("lines/{}", claim.name()), claim.clause(), claim.about(), &observed);
        }
        if let Some(record) = self.outcome.steps.last_mut() {
            let expected = claim.about().to_owned();
            record.checks.push(Check { key: claim.name().to_owned(), expected, observed, met: holds });
        }
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
