//! What fsct itself brings to a dossier: its ledger, cases and readings, and a self-test made there and then.

use crate::campaign::{Bench, Judges, Run};
use crate::ledger::Requirement;
use crate::library::Library;
use crate::plan::{Selection, plan};
use crate::profile::default_profile;
use fsct_adapters::{Dut, DutError, Role};
use fsct_reference::{FsDevice, FsMaster, MasterOptions, Options};
use fsct_reports::dossier::{KnownCase, Reading, SelfTest, Statement, Tool};
use fsct_reports::record::{Execution, Verdict};
use std::collections::{BTreeMap, BTreeSet};
use std::convert::Infallible;
use std::sync::atomic::AtomicBool;

/// Everything a dossier takes from the tool.
pub fn tool(library: &Library) -> Tool {
    let evidence = library.annex_i.as_ref().map(|annex| annex.evidence(&library.ledger, |name| library.members(name)));
    let items = evidence.map_or_else(Vec::new, |evidence| evidence.items);
    let reading = |entry: &crate::oracle::Tolerance| {
        let reading = Reading { name: entry.name.clone(), stance: entry.stance.to_string(), text: entry.text.clone() };
        (format!("A{:02}", entry.number), reading)
    };
    let case = |case: &crate::case::Case| KnownCase {
        id: case.id.clone(),
        suite: case.suite.clone(),
        role: case.role.to_string(),
        requirements: case.requirements.clone(),
    };
    Tool {
        version: env!("CARGO_PKG_VERSION").to_owned(),
        statements: library.ledger.iter().map(statement).collect(),
        cases: library.cases().map(case).collect(),
        readings: library.tolerances.iter().map(reading).collect(),
        members: items.iter().flat_map(|item| item.cases.clone()).collect::<BTreeMap<_, _>>(),
        items,
        self_test: vec![answers(), sound(library), second(library, Role::Device), second(library, Role::Master)],
    }
}

fn statement(requirement: &Requirement) -> Statement {
    Statement {
        id: requirement.id.clone(),
        clauses: requirement.clauses.clone(),
        dut: requirement.dut.clone(),
        level: requirement.level.name().to_owned(),
        class: requirement.class.name().to_owned(),
        text: requirement.text.clone(),
        why: requirement.why.clone().unwrap_or_default(),
    }
}

/// Known answers for the signatures.
fn answers() -> SelfTest {
    let (outcome, passed) = match fsct_vectors::load() {
        Ok(vectors) => {
            let score = fsct_vectors::prove(&vectors);
            let failed: usize = score.sections.iter().map(|section| section.failed.len()).sum();
            let outcome =
                format!("{} of {} known answers proven, tables included", score.answers() - failed, score.answers());
            (outcome, score.is_proven())
        }
        Err(error) => (error.to_string(), false),
    };
    SelfTest {
        what: "Known answers for the signatures".to_owned(),
        outcome,
        passed,
        command: "fsct vectors".to_owned(),
    }
}

/// Cases, ledger, limits and profiles agree with each other.
fn sound(library: &Library) -> SelfTest {
    let problems = library.check();
    let outcome = match problems.as_slice() {
        [] => format!(
            "{} cases, {} statements, {} limits: sound, and each agrees with the others",
            library.cases().count(),
            library.ledger.iter().count(),
            library.limits.limits.iter().count()
        ),
        [first, ..] => format!("{} problems, the first: {first}", problems.len()),
    };
    let passed = problems.is_empty();
    SelfTest { what: "Cases, ledger and limits".to_owned(), outcome, passed, command: "fsct check".to_owned() }
}

/// The oracle against the reference of a role, which is a second reading of the tables and shares none with it.
fn second(library: &Library, role: Role) -> SelfTest {
    let suite = format!("{role}-transitions");
    let command = format!("fsct run {suite} --dut inproc:reference-{role}");
    let (outcome, passed) = match judged(library, role, &suite) {
        Ok((cases, transitions, wrong)) => (
            format!("{cases} cases, {transitions} transitions taken, {wrong} cases not passed"),
            cases > 0 && wrong == 0,
        ),
        Err(why) => (why, false),
    };
    SelfTest { what: format!("Oracle against the reference {role}, a second implementation"), outcome, passed, command }
}

fn judged(library: &Library, role: Role, suite: &str) -> Result<(usize, usize, usize), String> {
    let reference = || -> Box<dyn Dut> {
        match role {
            Role::Device => Box::new(FsDevice::new(Options::default())),
            Role::Master => Box::new(FsMaster::new(MasterOptions::default())),
        }
    };
    let connect = || -> Result<Bench, DutError> { Bench::greet(reference()) };
    let name = default_profile(role);
    let profile = library.profiles.get(&name).ok_or_else(|| format!("the cases come without the profile `{name}`"))?;
    let first = connect().map_err(|error| error.to_string())?;
    let selection = Selection { suites: vec![suite.to_owned()], ..Selection::default() };
    let plan = plan(library, &selection, profile, &first.description).map_err(|problem| problem.to_string())?;
    let allowed = library.tolerances.in_force();
    let interrupted = AtomicBool::new(false);
    let run = Run {
        library,
        profile,
        allowed,
        seed: 1,
        command: String::new(),
        interrupted: &interrupted,
        judges: Judges::default(),
    };
    let (mut cases, mut wrong, mut taken) = (0, 0, BTreeSet::new());
    let Ok(()) = run.execute(&plan, Ok(first), connect, |case| {
        cases += 1;
        wrong += usize::from(case.execution != Execution::Ok || case.verdict > Verdict::Remark);
        taken.extend(case.transitions.into_keys());
        Ok::<(), Infallible>(())
    });
    Ok((cases, taken.len(), wrong))
}
