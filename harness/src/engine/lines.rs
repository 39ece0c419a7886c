//! What a case does to the lines of an FS-Device, and what it wants measured.

use super::{Engine, Stop};
use crate::case::model::{After, Wake, Wanted};
use crate::judging::{Asked, Finding, Judge};
use fsct_adapters::{Line, Mode, Stimulus};
use fsct_lines::{Claim, Measured, Quantity};
use fsct_reports::record::Verdict;

/// Steps while a Ready pulse is awaited: shorter than the shortest one that passes.
const COARSE_NS: u64 = 400_000;
/// Steps during it: half of t_RW.
const FINE_NS: u64 = 25_000;
/// A Ready pulse that comes later than this after its time is measured as missing.
const OVERDUE_NS: u64 = 100_000_000;
/// What a woken FS-Device may take until it answers: three transmission rates are tried.
const ANSWER_NS: u64 = 50_000_000;

impl<'s> Engine<'s, '_> {
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
            let (now, told) = (self.session.now, self.session.told_until());
            let lines = &mut self.session.link_mut().lines;
            let seen = match after {
                After::ReadyPulse => lines.ready(),
                After::Ossde => lines.both_on(told),
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
        let after_ns = woken_at.saturating_sub(fall);
        let limit = self.judging.limits.get(Quantity::ReadyToOssd.symbol());
        let ossde = limit.and_then(|limit| {
            limit.bounds(self.session.setup().edition, |name| self.session.profile.declared(name))?.min
        });
        if ossde.is_some_and(|least| after_ns + 2 * uncertainty_ns >= least) {
            // On a real clock the tester may be that late: OSSDe operation may have begun, and nobody has to answer any more.
            if !answered {
                let time = fsct_reports::measurement::time;
                return Err(Stop::Slipped(
                    format!(
                        "a wake-up request before OSSDe operation may begin, {} after the Ready pulse",
                        time(ossde.unwrap_or(0))
                    ),
                    format!("it was {} after it, ± {}, and was not answered", time(after_ns), time(2 * uncertainty_ns)),
                ));
            }
        } else {
            self.session.link_mut().lines.woken(woken_at, after_ns, answered, uncertainty_ns);
        }
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
        let (told, uncertainty_ns) = (self.session.told_until(), self.session.description.clock.uncertainty_ns);
        let values: Vec<Measured> = match quantity {
            Quantity::DeviceWatchdog | Quantity::MasterWatchdog => {
                let stopwatch = self.session.link().stopwatch.as_ref();
                stopwatch.and_then(|watch| watch.measured(quantity, uncertainty_ns)).into_iter().collect()
            }
            _ => self.session.link_mut().lines.measured(quantity, told, uncertainty_ns),
        };
        self.checks += 1;
        let ruled = match self.line_judge().quantity(quantity) {
            Ok(ruled) => ruled,
            Err(finding) => return self.found(&finding),
        };
        // A time that is still running says nothing unless it is too long already, or nothing else is known.
        let known = values.iter().any(|value| value.high != u64::MAX);
        let values: Vec<Measured> = values.into_iter().filter(|value| !known || !ruled.says_nothing(value)).collect();
        if values.is_empty() {
            if let Some(finding) = ruled.nothing("") {
                self.found(&finding);
            }
            return;
        }
        for value in values {
            let (measurement, finding) = ruled.value(&value, self.step);
            if let Some(finding) = finding {
                self.found(&finding);
            }
            self.outcome.measurements.push(measurement);
        }
    }

    fn claim(&mut self, claim: Claim) {
        let told = self.session.told_until();
        let judge = self.line_judge();
        let mut asked = Asked::default();
        for episode in self.session.link_mut().lines.episodes(told) {
            asked.ask(claim, &episode, judge.given());
        }
        self.checks += 1;
        let (check, finding) = asked.end(claim, &judge);
        if let Some(finding) = finding {
            self.found(&finding);
        }
        if let Some(record) = self.outcome.steps.last_mut() {
            record.checks.push(check);
        }
    }

    fn line_judge(&self) -> Judge<'s> {
        Judge {
            limits: self.judging.limits,
            edition: self.session.setup().edition,
            profile: self.session.profile,
            role: self.session.role(),
            uncertainty_ns: self.session.description.clock.uncertainty_ns,
            demands: self.judging.demands,
        }
    }

    fn found(&mut self, finding: &Finding) {
        let Finding { verdict, kind, clause, expected, observed } = finding;
        self.reason(*verdict, kind, clause, expected, observed);
    }
}
