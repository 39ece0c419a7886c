//! The gauntlet: every mutant of the reference DUTs against every case, the case judging alone, to see what each case is worth.

use crate::campaign::{Bench, Judges, Run};
use crate::complete;
use crate::library::Library;
use crate::plan::{Plan, Selection, plan};
use crate::problem::Problem;
use crate::profile::default_profile;
use fsct_adapters::{Dut, DutError, Role};
use fsct_reference::{FsDevice, FsMaster, MasterMutant, MasterOptions, Mutant, Options};
use fsct_reports::gauntlet::{Case, Matrix, Mutant as Row};
use fsct_reports::record::{CaseRecord, Reason, Verdict};
use std::collections::BTreeMap;
use std::convert::Infallible;
use std::num::NonZero;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};
use std::thread;

/// A deliberate fault of a reference DUT.
#[derive(Copy, Clone, Debug)]
enum Fault {
    Device(Mutant),
    Master(MasterMutant),
}

impl Fault {
    fn all(role: Role) -> Vec<Fault> {
        match role {
            Role::Device => Mutant::ALL.iter().copied().map(Fault::Device).collect(),
            Role::Master => MasterMutant::ALL.iter().copied().map(Fault::Master).collect(),
        }
    }

    fn row(self) -> Row {
        let (name, clause, about) = match self {
            Fault::Device(mutant) => (mutant.name(), mutant.clause(), mutant.about()),
            Fault::Master(mutant) => (mutant.name(), mutant.clause(), mutant.about()),
        };
        Row {
            name: name.to_owned(),
            clause: clause.to_owned(),
            about: about.to_owned(),
            killed_by: BTreeMap::new(),
            named_by: Vec::new(),
            oracle: None,
        }
    }

    fn dut(self) -> Box<dyn Dut> {
        match self {
            Fault::Device(mutant) => Box::new(FsDevice::new(Options { mutant: Some(mutant), ..Options::default() })),
            Fault::Master(mutant) => {
                Box::new(FsMaster::new(MasterOptions { mutant: Some(mutant), ..MasterOptions::default() }))
            }
        }
    }
}

/// Runs all cases for a role against all mutants of it, on all cores. `done` is called when a mutant is done with.
///
/// # Errors
/// The [`Problem`] of a plan, or one that says that the cases come without the profile.
pub fn matrix(library: &Library, role: Role, done: &(dyn Fn() + Sync)) -> Result<Matrix, Problem> {
    // Complete suites by themselves: they would kill for every other case, whatever that is worth.
    let others = library.suites.iter().filter(|suite| suite.group.as_deref() != Some(complete::GROUP));
    matrix_of(library, role, &others.map(|suite| suite.name.clone()).collect::<Vec<_>>(), 0, done)
}

/// As [`matrix`], with these suites or groups alone, as deep as said.
///
/// # Errors
/// As [`matrix`].
pub fn matrix_of(
    library: &Library,
    role: Role,
    suites: &[String],
    depth: u8,
    done: &(dyn Fn() + Sync),
) -> Result<Matrix, Problem> {
    let faults = Fault::all(role);
    let name = judged_by(role);
    let profile = library.profiles.get(&name).ok_or_else(|| {
        Problem::without_place(
            "profiles",
            format!("the cases come without the profile `{name}`, which the reference DUTs are judged by"),
        )
    })?;
    let bench = Bench::greet(match role {
        Role::Device => Box::new(FsDevice::new(Options::default())),
        Role::Master => Box::new(FsMaster::new(MasterOptions::default())),
    });
    let description = bench.map_err(|error| Problem::without_place("the reference", error.to_string()))?.description;
    let mut plan = Plan::default();
    if !suites.is_empty() {
        let selection = Selection { suites: suites.to_vec(), depth, ..Selection::default() };
        plan = self::plan(library, &selection, profile, &description)?;
        plan.cases.retain(|planned| planned.case.role == role);
    }
    let allowed = library.tolerances.in_force().union(profile.tolerate);
    let judged = |fault: Fault, judges: Judges| -> Vec<CaseRecord> {
        let interrupted = AtomicBool::new(false);
        let run = Run { library, profile, allowed, seed: 1, command: String::new(), interrupted: &interrupted, judges };
        let connect = || -> Result<Bench, DutError> { Bench::greet(fault.dut()) };
        let mut failed = Vec::new();
        let Ok(()) = run.execute(&plan, connect(), connect, |case| {
            failed.extend((case.verdict == Verdict::Fail).then_some(case));
            Ok::<(), Infallible>(())
        });
        failed
    };
    let rows: Mutex<Vec<Option<Row>>> = Mutex::new(vec![None; faults.len()]);
    let next = AtomicUsize::new(0);
    thread::scope(|scope| {
        for _ in 0..thread::available_parallelism().map_or(1, NonZero::get) {
            scope.spawn(|| {
                while let Some(fault) = {
                    let index = next.fetch_add(1, Ordering::Relaxed);
                    faults.get(index).map(|fault| (index, *fault))
                } {
                    let (index, fault) = fault;
                    let mut row = fault.row();
                    for case in judged(fault, Judges::CaseAlone) {
                        kill(&mut row, &case);
                    }
                    if row.named_by.is_empty() {
                        row.oracle = Some(!judged(fault, Judges::OracleAndCase).is_empty());
                    }
                    if let Some(slot) = rows.lock().unwrap_or_else(PoisonError::into_inner).get_mut(index) {
                        *slot = Some(row);
                    }
                    done();
                }
            });
        }
    });
    let mutants: Vec<Row> = rows.into_inner().unwrap_or_else(PoisonError::into_inner).into_iter().flatten().collect();
    let cases = cases(&plan, &mutants);
    Ok(Matrix { role: role.to_string(), mutants, cases })
}

/// The profile of the references: for the FS-Device one that declares its FS I/O structure, so that cases about it run.
fn judged_by(role: Role) -> String {
    match role {
        Role::Device => "device-io-structure".to_owned(),
        Role::Master => default_profile(role),
    }
}

/// What begins the kinds of reasons that are the expectations of a case.
const OWN: [&str; 4] = ["expect/", "measure/", "lines/", "liveness"];

/// A case that failed kills when an expectation in one of its own steps did, which a partner that has to come to operation is
/// one of; where things start and whether they go on afterwards is no business of a single case.
fn kill(row: &mut Row, case: &CaseRecord) {
    // Step 0 is the start condition; the liveness check has a step of its own only where the case came that far.
    let own = |reason: &&Reason| {
        let step = case.steps.get(reason.step).filter(|step| !step.text.starts_with("liveness:"));
        let expected = OWN.iter().any(|kind| reason.kind.starts_with(kind));
        reason.verdict == Verdict::Fail && expected && reason.step > 0 && step.is_some()
    };
    let Some(reason) = case.reasons.iter().find(own) else { return };
    *row.killed_by.entry(case.id.clone()).or_default() += 1;
    if !row.named_by.contains(&case.id) && names(&reason.clause, &row.clause) {
        row.named_by.push(case.id.clone());
    }
}

/// Whether one of the clauses in a text is that of a mutant, whatever table or transition either adds.
fn names(text: &str, clause: &str) -> bool {
    let section = clause.split([' ', ',']).next().unwrap_or_default();
    text.split(|letter: char| !letter.is_ascii_alphanumeric() && letter != '.').any(|word| word == section)
}

fn cases(plan: &Plan<'_>, mutants: &[Row]) -> Vec<Case> {
    let mut cases: Vec<Case> = Vec::new();
    for planned in &plan.cases {
        let case = planned.case;
        if cases.iter().all(|known| known.id != case.id) {
            let kills = mutants.iter().filter(|mutant| mutant.killed_by.contains_key(&case.id)).count();
            cases.push(Case { id: case.id.clone(), suite: case.suite.clone(), title: case.title.clone(), kills });
        }
    }
    cases
}

#[cfg(test)]
mod tests {
    use super::names;
    use rstest::rstest;

    #[rstest]
    #[case("11.5.3 Table 40 T25 (11.4.6)", "11.5.3 Table 40 T22", true)]
    #[case("11.5.3, 11.5.5 (Table 29)", "11.5.5", true)]
    #[case("11.4.10", "11.4.1", false)]
    #[case("11.4.1.2", "11.4.1", false)]
    #[case("", "11.4.1", false)]
    fn a_clause_is_named_by_its_section(#[case] text: &str, #[case] clause: &str, #[case] named: bool) {
        assert_eq!(names(text, clause), named);
    }
}
