//! A whole run: connect, preflight, one case after the other, each recorded before the next begins.

use crate::case::Covered;
use crate::case::model::Step;
use crate::engine::{Engine, Judging, Outcome, execution};
use crate::library::Library;
use crate::oracle::{Mask, Setup};
use crate::plan::{Plan, Planned};
use crate::profile::Profile;
use crate::session::Session;
use crate::tester::Tester;
use fsct_adapters::{
    ClockKind, ClockProof, Description, Dut, DutError, Finding, Latency, MADE_UP, Observation, Pco, Seen, Stimulus,
    Variant, Watch,
};
use fsct_protocol::crc::Reading;
use fsct_protocol::spdu::Port;
use fsct_reports::record::{
    CaseRecord, ClockProofInfo, DutInfo, Execution, LatencyInfo, Reason, RequirementRef, StepRecord, VariantInfo,
    Verdict, Walked,
};
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::SeedableRng;
use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// After this many cases in a row before which the DUT was not reached or did not greet, the rest is not tried.
const UNREACHED: usize = 3;
/// After this many cases in a row in which the DUT was lost, the rest is not tried.
const LOST: usize = 25;
/// Round trips measured before the first case of a connection.
const ROUND_TRIPS: usize = 32;

/// A DUT that has said hello and passed the preflight.
pub struct Bench {
    /// The connection.
    pub dut: Box<dyn Dut>,
    /// What it says of itself; [`Bench::measure`] adds what the way to it is uncertain of.
    pub description: Description,
    /// How long the way to it and back takes, where that was measured.
    pub latency: Option<Latency>,
    /// What a loop-back made of what it states of its clock, where that was tried.
    pub proof: Option<ClockProof>,
}

impl Bench {
    /// Says hello and checks that the DUT tells what it does not serve: a made-up stimulus has to be answered unsupported.
    ///
    /// # Errors
    /// [`DutError`] when it does not.
    pub fn greet(mut dut: Box<dyn Dut>) -> Result<Bench, DutError> {
        let description = dut.hello()?;
        let mut observed = Vec::new();
        dut.apply(&[Stimulus::Other { kind: MADE_UP, octets: vec![0x5A] }], &mut observed)?;
        match observed.as_slice() {
            [Observation { seen: Seen::Unsupported, .. }] => Ok(Bench { dut, description, latency: None, proof: None }),
            _ => Err(DutError::Contract {
                what:
                    "a stimulus that does not exist was not answered `unsupported`, so its other answers mean nothing"
                        .to_owned(),
            }),
        }
    }

    /// Holds what the DUT states of its clock against a loop-back. A stamp of a real clock is trusted no further than was shown;
    /// when stamps contradict the statement no timed case is judged.
    ///
    /// # Errors
    /// [`DutError`] when a round trip fails.
    pub fn prove(mut self, watch: &mut dyn Watch) -> Result<Bench, DutError> {
        let proof = ClockProof::measure(self.dut.as_mut(), self.description.clock, watch)?;
        if self.description.clock.kind == ClockKind::Real {
            self.description.clock.uncertainty_ns = proof.uncertainty_ns();
        }
        self.proof = Some(proof);
        Ok(self)
    }

    /// Measures the way to the DUT and back. When its clock is real, what varies on that way adds to the uncertainty of
    /// its time stamps: stimuli are paced by this program and meet the DUT that much sooner or later.
    ///
    /// # Errors
    /// [`DutError`] when a round trip fails.
    pub fn measure(mut self) -> Result<Bench, DutError> {
        let latency = Latency::measure(self.dut.as_mut(), ROUND_TRIPS)?;
        let clock = &mut self.description.clock;
        if clock.kind == ClockKind::Real {
            clock.uncertainty_ns = clock.uncertainty_ns.saturating_add(nanoseconds(latency.uncertainty()));
        }
        self.latency = Some(latency);
        Ok(self)
    }

    /// Makes the DUT the variant a case needs, without supply.
    ///
    /// # Errors
    /// [`DutError`] when it does not take it.
    pub fn configure(&mut self, variant: Variant) -> Result<(), DutError> {
        let mut observed = Vec::new();
        let power = self.description.pcos.contains(&Pco::Power);
        let mut stimuli = Vec::new();
        if power {
            stimuli.push(Stimulus::Power(false));
        }
        stimuli.push(Stimulus::Configure(variant));
        self.dut.apply(&stimuli, &mut observed)?;
        let refused = observed
            .iter()
            .any(|seen| usize::from(seen.stimulus) == stimuli.len() - 1 && seen.seen == Seen::Unsupported);
        let only = self
            .description
            .offers
            .iter()
            .all(|offer| offer.pd_out.0 == offer.pd_out.1 && offer.pd_in.0 == offer.pd_in.1)
            && self.description.offers.len() == 1;
        if refused && !only {
            return Err(DutError::Contract { what: "a variant inside its offer was refused".to_owned() });
        }
        Ok(())
    }
}

/// Who has a say in a verdict.
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq)]
pub enum Judges {
    /// The oracle, at every exchange, and the expectations of the case.
    #[default]
    OracleAndCase,
    /// The expectations of the case alone: to see what a case is worth by itself. Nothing is judged so for a user. The oracle
    /// only tells which other readings, let pass, still explain what was seen.
    CaseAlone,
}

/// What a run needs to know.
pub struct Run<'r> {
    /// Cases, start conditions, ledger, tolerances.
    pub library: &'r Library,
    /// Profile in force.
    pub profile: &'r Profile,
    /// Tolerances in force.
    pub allowed: Mask,
    /// Seed everything random derives from.
    pub seed: u64,
    /// How to call fsct for one case again, without the filter.
    pub command: String,
    /// Set when the user asks to stop.
    pub interrupted: &'r AtomicBool,
    /// Who judges.
    pub judges: Judges,
}

impl Run<'_> {
    /// Runs a plan; `record` gets each case as it ends. `connect` makes a fresh connection, the first one may be given.
    ///
    /// # Errors
    /// What `record` returns, at once.
    pub fn execute<E>(
        &self,
        plan: &Plan<'_>,
        first: Result<Bench, DutError>,
        mut connect: impl FnMut() -> Result<Bench, DutError>,
        mut record: impl FnMut(CaseRecord) -> Result<(), E>,
    ) -> Result<(), E> {
        let mut first = Some(first);
        let mut bench = None;
        let (mut unreached, mut lost) = (0, 0);
        for planned in &plan.cases {
            if self.interrupted.load(Ordering::Relaxed) {
                break;
            }
            if unreached >= UNREACHED || lost >= LOST {
                let why = format!("not tried: the DUT was lost in {} cases in a row", unreached.max(lost));
                record(self.not_run(planned, Execution::Aborted, "dut/given-up", &why))?;
                continue;
            }
            let ready = match bench.take() {
                Some(bench) => Ok(bench),
                None => first.take().unwrap_or_else(&mut connect),
            };
            let ready = ready.and_then(|mut bench: Bench| {
                bench.configure(planned.binding.variant)?;
                Ok(bench)
            });
            match ready {
                Ok(mut ready) => {
                    unreached = 0;
                    let (case, is_lost) = self.case(planned, &mut ready);
                    lost = if is_lost { lost + 1 } else { 0 };
                    bench = (!is_lost).then_some(ready);
                    record(case)?;
                }
                Err(error) => {
                    unreached += 1;
                    let (execution, kind) = execution(&error);
                    record(self.not_run(planned, execution, kind, &error.to_string()))?;
                }
            }
        }
        Ok(())
    }

    /// One case on a configured DUT; `true`: the connection is of no further use.
    fn case(&self, planned: &Planned<'_>, bench: &mut Bench) -> (CaseRecord, bool) {
        let mut problems = Vec::new();
        let start = self.library.start_steps(planned.case.role, &planned.case.start, &mut problems);
        let steps = planned.case.steps(&planned.binding, &mut problems);
        if let Some(problem) = problems.first() {
            return (self.not_run(planned, Execution::ToolError, "tool/case", &problem.to_string()), false);
        }
        if let Some(proof) = bench.proof.filter(|proof| proof.finding == Finding::Contradicted)
            && steps.iter().any(Step::is_timed)
        {
            let why = format!("its time stamps contradict what it states of its clock: {}", proof_info(&proof).said());
            return (self.not_run(planned, Execution::DutError, "dut/clock", &why), false);
        }
        let profile = planned.profile(self.profile, bench.description.clock.kind);
        let variant = planned.binding.variant;
        let allowed = planned.case.strict.iter().fold(self.allowed, Mask::without);
        let setups: Vec<Setup> = (0..bench.description.ports)
            .map_while(|index| setup(&profile, allowed, &bench.description, variant, index))
            .collect();
        let seed = |port: u64| Pcg64Mcg::seed_from_u64(self.seed ^ hash(&planned.key) ^ port);
        let testers = (0..).zip(&setups).map(|(index, setup)| Tester::new(setup, seed(index))).collect();
        if setups.is_empty() {
            return (self.not_run(planned, Execution::DutError, "dut/contract", "the DUT has no ports"), false);
        }
        let Bench { dut, description, .. } = bench;
        let mut session = Session::new(dut.as_mut(), description, &profile, setups, self.interrupted);
        session.links.iter_mut().for_each(|link| link.case_alone = self.judges == Judges::CaseAlone);
        let judging = Judging {
            limits: &self.library.limits.limits,
            clauses: self.clauses(planned),
            demands: self.demands(planned),
            shown: self.library.tolerances.shown(),
        };
        let ran = catch_unwind(AssertUnwindSafe(|| {
            Engine::new(&mut session, testers, judging).run(&start, &planned.case.start, &steps)
        }));
        match ran {
            Ok(outcome) => {
                let lost = outcome.lost;
                (self.record(planned, outcome, session), lost)
            }
            Err(panic) => {
                let text = panic.downcast_ref::<&str>().map(|text| (*text).to_owned());
                let text = text.or_else(|| panic.downcast_ref::<String>().cloned()).unwrap_or_default();
                let why = format!("a fault of fsct itself, please report it: {text}");
                (self.not_run(planned, Execution::ToolError, "tool/panic", &why), true)
            }
        }
    }

    /// Whether anything a case judges is demanded: only then its own expectations can fail a product.
    fn demands(&self, planned: &Planned<'_>) -> bool {
        planned.case.requirements.iter().filter_map(|id| self.library.ledger.get(id)).any(|record| record.can_fail())
    }

    fn clauses(&self, planned: &Planned<'_>) -> String {
        let mut clauses = Vec::new();
        for record in planned.case.requirements.iter().filter_map(|id| self.library.ledger.get(id)) {
            let clause = record.clause(planned.binding.variant.edition);
            if !clauses.contains(&clause) {
                clauses.push(clause);
            }
        }
        clauses.join(", ")
    }

    fn record(&self, planned: &Planned<'_>, mut outcome: Outcome, mut session: Session<'_>) -> CaseRecord {
        let taken = session.taken();
        let name = |covered: &Covered| covered.to_string();
        let missed: Vec<String> =
            planned.case.covers.iter().map(name).filter(|name| !taken.contains_key(name)).collect();
        let shown = self.library.tolerances.shown();
        let used = session.used();
        if outcome.verdict < Verdict::Inconclusive && outcome.execution == Execution::Ok && !missed.is_empty() {
            // Another reading, let pass, may lead past a transition.
            let other = used.iter().any(|number| shown.has(number));
            let verdict = if other { Verdict::Remark } else { Verdict::Inconclusive };
            outcome.verdict = outcome.verdict.max(verdict);
            outcome.reasons.push(Reason {
                verdict,
                kind: "covers".to_owned(),
                clause: String::new(),
                step: outcome.steps.len().saturating_sub(1),
                entry: None,
                expected: format!("the DUT takes {}", missed.join(", ")),
                observed: "it did not, so the case did not show what it is for".to_owned(),
            });
        }
        let mut tolerances = BTreeMap::new();
        for number in used.iter().filter(|number| shown.has(*number)) {
            let text = self
                .library
                .tolerances
                .get(number)
                .map_or(String::new(), |entry| format!("{}: {} ({})", entry.stance, entry.name, entry.text));
            tolerances.insert(format!("A{number:02}"), text);
        }
        if !tolerances.is_empty() {
            outcome.verdict = outcome.verdict.max(Verdict::Remark);
        }
        let duration_ns = session.now;
        let told = session.told();
        for (reason, at) in outcome.reasons.iter_mut().zip(&outcome.shown_at) {
            reason.entry = told.exchange_at(*at);
        }
        for step in &mut outcome.steps {
            step.entries = (told.place(step.entries.0), told.place(step.entries.1));
        }
        let mut record = self.blank(planned);
        record.verdict = outcome.verdict;
        record.execution = outcome.execution;
        record.reasons = outcome.reasons;
        record.tolerances = tolerances;
        if planned.case.complete.is_some() {
            let open = used.iter().filter(|number| !shown.has(*number));
            record.open = open.map(|number| format!("A{number:02}")).collect();
        }
        record.transitions = taken;
        if let Some(coverage) = self.library.coverage.get(&planned.case.role.to_string()) {
            record.walked = coverage.names(session.walked(), session.sides());
        }
        record.steps = outcome.steps;
        record.measurements = outcome.measurements;
        record.elided = told.elided;
        record.trace = told.entries;
        record.duration_ns = duration_ns;
        record
    }

    fn not_run(&self, planned: &Planned<'_>, execution: Execution, kind: &str, why: &str) -> CaseRecord {
        let mut record = self.blank(planned);
        record.verdict = Verdict::Inconclusive;
        record.execution = execution;
        record.reasons.push(Reason {
            verdict: Verdict::Inconclusive,
            kind: kind.to_owned(),
            clause: String::new(),
            step: 0,
            entry: None,
            expected: "the case is executed".to_owned(),
            observed: why.to_owned(),
        });
        record.steps.push(StepRecord {
            text: format!("start: {}", planned.case.start),
            activities: Vec::new(),
            executed: false,
            entries: (0, 0),
            checks: Vec::new(),
        });
        record
    }

    /// The record of a case before anything has come of it.
    pub fn blank(&self, planned: &Planned<'_>) -> CaseRecord {
        let Planned { case, binding, key } = planned;
        let edition = binding.variant.edition;
        let requirements = case
            .requirements
            .iter()
            .filter_map(|id| self.library.ledger.get(id))
            .map(|record| RequirementRef {
                id: record.id.clone(),
                clause: record.clause(edition).to_owned(),
                level: record.level.name().to_owned(),
            })
            .collect();
        CaseRecord {
            key: key.clone(),
            id: case.id.clone(),
            suite: case.suite.clone(),
            dut: 0,
            role: case.role.to_string(),
            title: case.title.clone(),
            scenario: case.scenario.as_ref().map(|placed| placed.0.clone()).unwrap_or_default(),
            place: case.place(),
            sweep: binding.values.clone(),
            variant: VariantInfo {
                edition: edition.name().to_owned(),
                mode: binding.variant.mode.name().to_owned(),
                pd_out: binding.variant.pd_out,
                pd_in: binding.variant.pd_in,
                leading_octet: self.profile.reading == Reading::LeadingOctet,
            },
            requirements,
            verdict: Verdict::Pass,
            execution: Execution::Ok,
            reasons: Vec::new(),
            tolerances: BTreeMap::new(),
            open: Vec::new(),
            transitions: BTreeMap::new(),
            walked: Walked::default(),
            start: case.start.clone(),
            steps: Vec::new(),
            measurements: Vec::new(),
            trace: Vec::new(),
            elided: 0,
            duration_ns: 0,
            replay: format!("{} --seed {} --filter '{key}'", self.command, self.seed),
        }
    }
}

/// FNV-1a of a text: one seed per case that does not depend on the other cases.
fn hash(text: &str) -> u64 {
    text.bytes().fold(0xCBF2_9CE4_8422_2325, |hash, octet| (hash ^ u64::from(octet)).wrapping_mul(0x0100_0000_01B3))
}

pub(crate) fn nanoseconds(duration: Duration) -> u64 {
    u64::try_from(duration.as_nanos()).unwrap_or(u64::MAX)
}

/// What the oracle of a port is told, ports counted from 0; `None` when the port cannot have a number.
pub fn setup(
    profile: &Profile,
    allowed: Mask,
    description: &Description,
    variant: Variant,
    index: u8,
) -> Option<Setup> {
    let Variant { edition, mode, pd_out, pd_in } = variant;
    let port = Port::new(profile.port.number().checked_add(index)?)?;
    Some(Setup {
        role: profile.role,
        edition,
        mode,
        pd_out: pd_out.into(),
        pd_in: pd_in.into(),
        port,
        reading: profile.reading,
        cycle_ns: profile.master_cycle_time_ns,
        watchdog_ns: profile.watchdog_ns(),
        tick_ns: profile.timer_tick_us * 1_000,
        margin_ns: profile.margin_ns(),
        uncertainty_ns: description.clock.uncertainty_ns,
        latency: profile.answer_latency,
        scl_start_ns: profile.scl_start_ms * 1_000_000,
        allowed,
        app: description.pcos.contains(&Pco::App),
    })
}

/// The loop-back for the record.
fn proof_info(proof: &ClockProof) -> ClockProofInfo {
    let ClockProof { finding, stamps, stated_ns, shown_ns, off_ns, step_ns, drift_ppm } = *proof;
    let finding = match finding {
        Finding::Proved => "proved",
        Finding::Unproved => "unproved",
        Finding::Contradicted => "contradicted",
    };
    ClockProofInfo { finding: finding.to_owned(), stamps, stated_ns, shown_ns, off_ns, step_ns, drift_ppm }
}

/// What the DUT says of itself, and what was measured of the way to it, for the record.
pub fn dut_info(url: &str, profile: &Profile, bench: &Bench) -> DutInfo {
    let description = &bench.description;
    DutInfo {
        url: url.to_owned(),
        role: description.role.to_string(),
        profile: profile.name.clone(),
        vendor: description.vendor.clone(),
        product: description.product.clone(),
        version: description.version.clone(),
        pcos: description.pcos.iter().map(|pco| pco.name().to_owned()).collect(),
        clock: match description.clock.kind {
            ClockKind::Virtual => "virtual".to_owned(),
            ClockKind::Real => "real".to_owned(),
        },
        resolution_ns: description.clock.resolution_ns,
        uncertainty_ns: description.clock.uncertainty_ns,
        round_trip: bench.latency.map(|latency| LatencyInfo {
            min_ns: nanoseconds(latency.min),
            median_ns: nanoseconds(latency.median),
            p99_ns: nanoseconds(latency.p99),
            max_ns: nanoseconds(latency.max),
        }),
        clock_proof: bench.proof.as_ref().map(proof_info),
        offers: description
            .offers
            .iter()
            .map(|offer| {
                format!(
                    "{} with {}, PDout {}..{}, PDin {}..{}",
                    offer.edition, offer.mode, offer.pd_out.0, offer.pd_out.1, offer.pd_in.0, offer.pd_in.1
                )
            })
            .collect(),
        declared: profile.facts(),
    }
}
