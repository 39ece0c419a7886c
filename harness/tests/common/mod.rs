//! Runs the embedded suite on a DUT of the tests' choice.

use fsct_adapters::{Dut, DutError};
use fsct_harness::campaign::{Bench, Judges, Run};
use fsct_harness::library::Library;
use fsct_harness::plan::{Plan, Selection, plan, unreached};
use fsct_reports::record::CaseRecord;
use std::convert::Infallible;
use std::sync::atomic::AtomicBool;

/// The embedded library, or a panic that shows its problems.
pub fn library() -> Library {
    Library::embedded().unwrap_or_else(|problems| {
        let texts: Vec<String> = problems.iter().map(|problem| problem.render(false)).collect();
        panic!("{}", texts.join("\n"))
    })
}

/// Every case of a selection on fresh DUTs from `make`.
#[allow(dead_code, reason = "not every test needs the default profile")]
pub fn run(library: &Library, selection: &Selection, make: impl Fn() -> Box<dyn Dut>) -> Vec<CaseRecord> {
    run_with(library, selection, "reference-device", make)
}

/// The same with another profile.
#[allow(dead_code, reason = "not every test takes fresh DUTs")]
pub fn run_with(
    library: &Library,
    selection: &Selection,
    profile: &str,
    make: impl Fn() -> Box<dyn Dut>,
) -> Vec<CaseRecord> {
    run_on(library, selection, profile, || Bench::greet(make()))
}

/// The same on benches that are more than greeted.
pub fn run_on(
    library: &Library,
    selection: &Selection,
    profile: &str,
    connect: impl Fn() -> Result<Bench, DutError>,
) -> Vec<CaseRecord> {
    let profile = &library.profiles[profile];
    let bench = connect();
    let description = match &bench {
        Ok(bench) => bench.description.clone(),
        Err(_) => unreached(profile.role),
    };
    let plan: Plan<'_> = plan(library, selection, profile, &description).expect("a plan");
    let interrupted = AtomicBool::new(false);
    let run = Run {
        library,
        profile,
        allowed: library.tolerances.in_force().union(profile.tolerate),
        seed: 1,
        command: "fsct run".into(),
        interrupted: &interrupted,
        judges: Judges::default(),
    };
    let mut cases = Vec::new();
    let kept = run.execute(&plan, bench, connect, |case| {
        cases.push(case);
        Ok::<(), Infallible>(())
    });
    kept.expect("keeping a case cannot fail");
    cases
}

#[allow(dead_code, reason = "not every test tells it")]
/// What went wrong, to be read in a failing test.
pub fn story(cases: &[CaseRecord]) -> String {
    let mut text = String::new();
    for case in cases {
        text += &format!("{} {:?} {:?} {:?}\n", case.key, case.verdict, case.execution, case.tolerances);
        for reason in &case.reasons {
            text += &format!("  step {} {} [{}]\n", reason.step, reason.kind, reason.clause);
            text += &format!("    expected {}\n    observed {}\n", reason.expected, reason.observed);
        }
    }
    text
}
