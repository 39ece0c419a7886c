//! How the tests of both references look at what became of the cases.

use fsct_reports::record::{CaseRecord, Verdict};

/// The cases with any other verdict than pass.
pub fn not_passed(cases: Vec<CaseRecord>) -> Vec<CaseRecord> {
    cases.into_iter().filter(|case| case.verdict != Verdict::Pass).collect()
}

/// The first case that failed and its first reason, for a snapshot.
pub fn first_failure(mutant: &str, cases: &[CaseRecord]) -> String {
    let failed = cases.iter().find(|case| case.verdict == Verdict::Fail).expect("it fails");
    let reason = failed.reasons.first().expect("with a reason");
    format!(
        "{mutant}\n  {} step {} [{}]\n  clause {}\n  expected {}\n  observed {}",
        failed.key, reason.step, reason.kind, reason.clause, reason.expected, reason.observed
    )
}
