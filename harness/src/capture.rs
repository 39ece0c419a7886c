//! Judges the line cases by a recording instead of a DUT: episode by episode, in memory that does not grow with it.
//!
//! A case says by its steps what has to happen before it measures: `wake` is an episode with a wake-up, `pass` after OSSDe
//! one without. Every episode that fits is judged. What edges cannot tell is said and not guessed.

use crate::case::model::{Action, After, Step, Wanted};
use crate::judging::{Asked, Finding, Judge};
use crate::library::Library;
use crate::plan::{Plan, Planned};
use crate::profile::Profile;
use fsct_adapters::Line;
use fsct_lines::capture::Capture;
use fsct_lines::{
    Claim, Decoder, Episode, Filter, MOST_BLUR, Measured, Quantity, Recording, RecordingError, WakeUps, measure,
};
use fsct_reports::measurement::Measurement;
use fsct_reports::record::{Check, Reason, StepRecord, Verdict};
use std::collections::{BTreeMap, BTreeSet};

/// How many values of a quantity a case keeps for its record.
const KEPT: usize = 200;
/// The longest time over which wake-ups are one sequence, in nanoseconds: a new one comes after T_SD at the earliest.
const SEQUENCE_NS: u64 = 500_000_000;

/// What an episode has to be like.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
enum Fits {
    /// Any.
    Any,
    /// With a wake-up.
    Woken,
    /// Without one.
    NotWoken,
    /// With neither Ready pulse nor wake-up.
    NotReady,
}

impl Fits {
    fn fits(self, episode: &Episode) -> bool {
        let woken = episode.wake_ups.count > 0;
        match self {
            Fits::Any => true,
            Fits::Woken => woken,
            Fits::NotWoken => !woken,
            Fits::NotReady => !woken && episode.ready.is_none() && episode.ossd.is_none(),
        }
    }

    fn name(self) -> &'static str {
        match self {
            Fits::Any => "an episode",
            Fits::Woken => "an episode with a wake-up",
            Fits::NotWoken => "an episode without a wake-up",
            Fits::NotReady => "an episode with neither Ready pulse nor wake-up",
        }
    }
}

/// One step of a case that measures.
struct Moment<'c> {
    fits: Fits,
    episodes: u64,
    quantities: Vec<Values<'c>>,
    claims: Vec<(Claim, Asked)>,
}

/// The values of a quantity.
struct Values<'c> {
    quantity: Quantity,
    ruled: Result<crate::judging::Ruled<'c>, Finding>,
    kept: Vec<Measurement>,
    count: u64,
    least: Option<Measurement>,
    most: Option<Measurement>,
    /// The first finding of each verdict, and how many there were.
    findings: BTreeMap<Verdict, (Finding, u64)>,
}

impl Values<'_> {
    fn take(&mut self, value: &Measured, step: usize) {
        let Ok(ruled) = &self.ruled else { return };
        if ruled.says_nothing(value) {
            return;
        }
        let (measurement, finding) = ruled.value(value, step);
        self.count += 1;
        if let Some(finding) = finding {
            self.findings.entry(finding.verdict).and_modify(|seen| seen.1 += 1).or_insert((finding, 1));
        }
        if self.least.as_ref().is_none_or(|least| measurement.low < least.low) {
            self.least = Some(measurement.clone());
        }
        let high = |one: &Measurement| one.high.unwrap_or(u64::MAX);
        if self.most.as_ref().is_none_or(|most| high(&measurement) > high(most)) {
            self.most = Some(measurement.clone());
        }
        if self.kept.len() < KEPT {
            self.kept.push(measurement);
        }
    }
}

/// A case while the recording is read.
struct Watched<'c> {
    planned: &'c Planned<'c>,
    moments: Vec<Moment<'c>>,
    judge: Judge<'c>,
}

/// What came of a case.
pub struct Judged<'c> {
    /// The case.
    pub planned: &'c Planned<'c>,
    /// Conformance.
    pub verdict: Verdict,
    /// Why.
    pub reasons: Vec<Reason>,
    /// What was looked at.
    pub steps: Vec<StepRecord>,
    /// Values: the first of each quantity, the smallest and the largest.
    pub measurements: Vec<Measurement>,
}

/// What came of a recording.
#[derive(Default)]
pub struct Outcome<'c> {
    /// Cases that were judged.
    pub judged: Vec<Judged<'c>>,
    /// Cases that were not: key, then why.
    pub not_applicable: Vec<(String, String)>,
    /// Episodes of the recording.
    pub episodes: u64,
    /// Pulses left out by the glitch filter.
    pub glitches: u64,
    /// Until when the recording goes, in nanoseconds.
    pub end: u64,
}

/// The cases of a plan that measure what lines show, once an edition: the values of a sweep are what a tester does, and a
/// recording has happened already.
pub fn line_cases<'l>(library: &Library, plan: Plan<'l>) -> Plan<'l> {
    let measures: BTreeSet<&str> = library
        .cases()
        .filter(|case| case.group.as_deref() == Some("timing") && case.suite.ends_with("-lines"))
        .map(|case| case.id.as_str())
        .collect();
    let mut seen = BTreeSet::new();
    let mut cases = Vec::new();
    for mut planned in plan.cases {
        let steps = planned.case.steps(&planned.binding, &mut Vec::new());
        let watchdog =
            |wanted: &Wanted| matches!(wanted, Wanted::Quantity(Quantity::DeviceWatchdog | Quantity::MasterWatchdog));
        let measures = steps.iter().flat_map(|step| &step.measure).any(|wanted| !watchdog(wanted));
        let edition = planned.binding.variant.edition;
        if measures && seen.insert((planned.case.id.clone(), edition.name())) {
            planned.key = format!("{}[edition={edition}]", planned.case.id);
            planned.binding.values.retain(|(name, _)| name == "edition");
            cases.push(planned);
        }
    }
    // What measures nothing is no line case, whether it applies or not.
    let not_applicable = plan.not_applicable.into_iter().filter(|(key, _)| measures.contains(id_of(key))).collect();
    Plan { cases, not_applicable }
}

fn id_of(key: &str) -> &str {
    key.split_once('[').map_or(key, |(id, _)| id)
}

/// Judges a recording by the cases of a plan.
///
/// # Errors
/// [`RecordingError`] when the recording cannot be read to its end: what is missing might be what fails.
pub fn judge<'c>(
    library: &'c Library,
    profile: &'c Profile,
    plan: &'c Plan<'c>,
    capture: Capture,
    glitch_ns: u64,
) -> Result<Outcome<'c>, RecordingError> {
    let wake_ups = capture.wake_ups();
    let uncertainty_ns = capture.uncertainty_ns();
    let channels = [Line::Power, Line::Cq, Line::Iq].map(|line| capture.channel(line).is_some());
    let mut outcome = Outcome { not_applicable: plan.not_applicable.clone(), ..Outcome::default() };
    let mut watched = Vec::new();
    for planned in &plan.cases {
        let records = planned.case.requirements.iter().filter_map(|id| library.ledger.get(id));
        let judge = Judge {
            limits: &library.limits.limits,
            edition: planned.binding.variant.edition,
            profile,
            role: profile.role,
            uncertainty_ns,
            demands: records.into_iter().any(|record| record.can_fail()),
        };
        match moments(&planned.case.steps(&planned.binding, &mut Vec::new()), &judge) {
            Ok(moments) => watched.push(Watched { planned, moments, judge }),
            Err(why) => outcome.not_applicable.push((planned.key.clone(), why)),
        }
    }
    let mut recording = Filter::new(capture, glitch_ns);
    let mut decoder = Decoder::new(0, recording.levels(), wake_ups).blurred(uncertainty_ns);
    while let Some(edge) = recording.next_edge()? {
        if let Some(episode) = decoder.edge(edge) {
            take(&mut watched, &mut outcome, &episode, uncertainty_ns);
        }
    }
    outcome.end = recording.end();
    if let Some(episode) = decoder.finish(outcome.end) {
        take(&mut watched, &mut outcome, &episode, uncertainty_ns);
    }
    outcome.glitches = recording.removed();
    let blurred = wake_ups == WakeUps::Pulses && uncertainty_ns.saturating_mul(2) > MOST_BLUR;
    for one in watched {
        if one.moments.iter().all(|moment| moment.episodes == 0) {
            let missing = one.moments.first().map_or("", |moment| moment.fits.name());
            outcome.not_applicable.push((one.planned.key.clone(), format!("the recording does not show {missing}")));
        } else {
            outcome.judged.push(one.end(channels, blurred));
        }
    }
    Ok(outcome)
}

fn take(watched: &mut [Watched<'_>], outcome: &mut Outcome<'_>, episode: &Episode, uncertainty_ns: u64) {
    outcome.episodes += 1;
    let values = measure(episode, uncertainty_ns);
    let sequence = episode.wake_ups.first.zip(episode.wake_ups.last).is_some_and(|(a, b)| b - a <= SEQUENCE_NS);
    for one in watched {
        for (number, moment) in (1..).zip(&mut one.moments) {
            if !moment.fits.fits(episode) {
                continue;
            }
            moment.episodes += 1;
            for wanted in &mut moment.quantities {
                // Later wake-ups may begin anew what has ended, so they are no retries.
                if wanted.quantity == Quantity::WakeUpRetry && !sequence {
                    continue;
                }
                let quantity = wanted.quantity;
                for value in values.iter().filter(|value| value.quantity == quantity) {
                    wanted.take(value, number);
                }
            }
            for (claim, asked) in &mut moment.claims {
                asked.ask(*claim, episode, one.judge.given());
            }
        }
    }
}

/// The steps of a case that measure, with what has to happen before.
///
/// # Errors
/// Why edges do not tell what the case needs.
fn moments<'c>(steps: &[Step], judge: &Judge<'c>) -> Result<Vec<Moment<'c>>, String> {
    let mut fits = Fits::Any;
    let mut moments = Vec::new();
    let mut untold = None;
    for step in steps {
        match &step.action {
            Action::Power(_) => fits = Fits::Any,
            Action::Pass { after: Some(After::Ossde), .. } => fits = Fits::NotWoken,
            Action::Wake(_) => fits = Fits::Woken,
            Action::Connect(connect) if connect.pulse_us.is_none() => fits = Fits::NotReady,
            Action::Connect(_) | Action::Drive(_) => fits = Fits::Woken,
            Action::Pass { .. } | Action::Configure(_) | Action::Look => {}
            _ => untold = Some(format!("edges do not show `{}`", step.text)),
        }
        if step.measure.is_empty() {
            continue;
        }
        if let Some(why) = untold {
            return Err(why);
        }
        let mut moment = Moment { fits, episodes: 0, quantities: Vec::new(), claims: Vec::new() };
        for wanted in &step.measure {
            match *wanted {
                Wanted::Quantity(Quantity::WaitForReady | Quantity::PowerOff) | Wanted::Claim(Claim::PowerCycle) => {
                    return Err(
                        "edges do not tell why L+ goes OFF: because a Ready pulse is missing, or because it was asked for"
                            .to_owned(),
                    );
                }
                Wanted::Quantity(Quantity::ReadyForWakeUp) => {
                    return Err(
                        "t_RW is told by an answer to the wake-up, and edges do not tell who answers".to_owned()
                    );
                }
                Wanted::Quantity(quantity) => moment.quantities.push(Values {
                    quantity,
                    ruled: judge.quantity(quantity),
                    kept: Vec::new(),
                    count: 0,
                    least: None,
                    most: None,
                    findings: BTreeMap::new(),
                }),
                Wanted::Claim(claim) => moment.claims.push((claim, Asked::default())),
            }
        }
        moments.push(moment);
    }
    Ok(moments)
}

impl<'c> Watched<'c> {
    fn end(self, channels: [bool; 3], blurred: bool) -> Judged<'c> {
        let Watched { planned, moments, judge } = self;
        let step = |text: String, executed, checks| StepRecord {
            text,
            activities: Vec::new(),
            executed,
            entries: (0, 0),
            checks,
        };
        let mut steps = vec![step("start: as recorded".to_owned(), true, Vec::new())];
        let mut reasons = Vec::new();
        let mut measurements = Vec::new();
        let names = ["L+", "C/Q", "I/Q"];
        let lacking: Vec<&str> = names.into_iter().zip(channels).filter(|(_, is)| !is).map(|(name, _)| name).collect();
        let lacking = match lacking.as_slice() {
            [] => String::new(),
            lines => format!("nothing that could be measured: {} is not in the recording", lines.join(" and ")),
        };
        for (number, moment) in (1..).zip(moments) {
            let mut add = |finding: &Finding, count: u64| {
                let more = if count > 1 { format!(" and {} more", count - 1) } else { String::new() };
                let (verdict, observed) = if blurred && finding.verdict != Verdict::Remark {
                    (
                        Verdict::Inconclusive,
                        format!("{}, but the sample period does not tell a wake-up", finding.observed),
                    )
                } else {
                    (finding.verdict, finding.observed.clone())
                };
                reasons.push(Reason {
                    verdict,
                    kind: finding.kind.clone(),
                    clause: finding.clause.clone(),
                    step: number,
                    entry: None,
                    expected: finding.expected.clone(),
                    observed: observed + &more,
                });
            };
            let name = moment.fits.name();
            let mut checks: Vec<Check> = Vec::new();
            if moment.episodes == 0 {
                let finding = Finding {
                    verdict: Verdict::Inconclusive,
                    kind: "capture/episode".to_owned(),
                    clause: String::new(),
                    expected: name.to_owned(),
                    observed: "the recording does not show one".to_owned(),
                };
                add(&finding, 1);
            }
            for values in moment.quantities.into_iter().filter(|_| moment.episodes > 0) {
                let Values { ruled, mut kept, count, least, most, findings, .. } = values;
                match ruled {
                    Err(finding) => add(&finding, 1),
                    Ok(ruled) if count == 0 => ruled.nothing(&lacking).iter().for_each(|finding| add(finding, 1)),
                    Ok(_) => findings.values().rev().for_each(|(finding, count)| add(finding, *count)),
                }
                for extreme in [least, most].into_iter().flatten() {
                    if !kept.contains(&extreme) {
                        kept.push(extreme);
                    }
                }
                measurements.append(&mut kept);
            }
            for (claim, asked) in moment.claims.iter().filter(|_| moment.episodes > 0) {
                let (check, finding) = asked.end(*claim, &judge);
                checks.push(check);
                if let Some(finding) = finding {
                    add(&finding, 1);
                }
            }
            steps.push(step(format!("{name}: {} of them", moment.episodes), moment.episodes > 0, checks));
        }
        if blurred {
            reasons.push(Reason {
                verdict: Verdict::Inconclusive,
                kind: "capture/sample-period".to_owned(),
                clause: String::new(),
                step: 0,
                entry: None,
                expected: "a sample period that tells a wake-up pulse of 80 us from others".to_owned(),
                observed: "a longer one".to_owned(),
            });
        }
        // The worst one decides, and the first reason is the one that does.
        reasons.sort_by_key(|reason| std::cmp::Reverse(reason.verdict));
        let verdict = reasons.iter().map(|reason| reason.verdict).max().unwrap_or(Verdict::Pass);
        Judged { planned, verdict, reasons, steps, measurements }
    }
}
