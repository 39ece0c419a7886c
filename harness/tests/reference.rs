//! The embedded reference FS-Device against the whole suite.

use fsct_harness::campaign::{Bench, Run};
use fsct_harness::library::Library;
use fsct_harness::plan::{Selection, plan};
use fsct_reference::{FsDevice, Options};
use fsct_reports::record::Verdict;
use std::convert::Infallible;
use std::sync::atomic::AtomicBool;

#[test]
fn the_reference_device_conforms() {
    let library = Library::embedded().unwrap_or_else(|problems| {
        panic!("{}", problems.iter().map(|p| p.render(false)).collect::<Vec<_>>().join("\n"))
    });
    let profile = &library.profiles["reference-device"];
    let connect = || Bench::greet(Box::new(FsDevice::new(Options::default())));
    let bench = connect().expect("the reference device answers");
    let plan = plan(&library, &Selection::default(), profile, &bench.description).expect("a plan");
    let interrupted = AtomicBool::new(false);
    let run = Run {
        library: &library,
        profile,
        allowed: library.tolerances.in_force(),
        seed: 1,
        command: "fsct run".into(),
        interrupted: &interrupted,
    };
    let mut cases = Vec::new();
    run.execute(&plan, Ok(bench), connect, |case| {
        cases.push(case);
        Ok::<(), Infallible>(())
    })
    .expect("infallible");
    for case in &cases {
        if case.verdict != Verdict::Pass {
            println!("{} {:?} {:?}", case.key, case.verdict, case.execution);
            for r in &case.reasons {
                println!("   step {} [{}] {} | {} | {}", r.step, r.kind, r.clause, r.expected, r.observed);
            }
            println!("   {:?}", case.tolerances);
        }
    }
    assert!(cases.len() >= 4);
    assert!(cases.iter().all(|case| case.verdict == Verdict::Pass));
}
