//! One test: what became of a case, in words.

use fsct_reports::decode::Side;
use fsct_reports::record::{CaseRecord, Execution, Verdict};
use fsct_reports::{execution_name, headline, story, verdict_name, visible};

/// What became of a test.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// As the standard asks.
    Passed,
    /// Passed, with something to be told.
    Remark(String),
    /// Not passed: all that is needed to find the fault.
    Failed(String),
    /// Not run: the term that excluded the case.
    NotApplicable(String),
}

impl Outcome {
    /// What a record means to a test.
    pub(crate) fn of(case: &CaseRecord) -> Outcome {
        match (case.execution, case.verdict) {
            (Execution::Ok, Verdict::Pass) => Outcome::Passed,
            (Execution::Ok, Verdict::Remark) => Outcome::Remark(visible(&remark(case))),
            _ => Outcome::Failed(visible(&format!("{}\n{}", sentence(case), story(case, Side::of(&case.role))))),
        }
    }
}

/// The verdict on both axes in one sentence.
fn sentence(case: &CaseRecord) -> String {
    let (word, meaning) = match (case.execution, case.verdict) {
        (Execution::Ok, Verdict::Fail) => (verdict_name(case.verdict), "the DUT is not as the standard asks"),
        (Execution::Ok, verdict) => {
            (verdict_name(verdict), "it can be said neither that the DUT passes nor that it fails")
        }
        (Execution::Timeout, _) => (execution_name(case.execution), "the DUT did not answer in time"),
        (Execution::DutError, _) => (execution_name(case.execution), "the DUT broke the contract of the adapter"),
        (Execution::RigError, _) => (execution_name(case.execution), "the DUT was not reached; it was not judged"),
        (Execution::ToolError, _) => (execution_name(case.execution), "fsct is at fault and not the DUT"),
        (Execution::Aborted, _) => (execution_name(case.execution), "stopped before the end"),
    };
    format!("{word}: {meaning}")
}

fn remark(case: &CaseRecord) -> String {
    let reasons = case.reasons.iter().map(headline);
    let tolerances = case.tolerances.iter().map(|(id, what)| format!("tolerance {id}: {what}"));
    let lines: Vec<String> = reasons.chain(tolerances).collect();
    format!("remark {}: {}", case.key, lines.join("\n  "))
}

/// One test, not run yet.
pub struct Test {
    /// Key of the case, or one of `fsct::library`, `fsct::profile`, `fsct::hello` and `fsct::plan`.
    pub name: String,
    /// `true`: the case does not apply.
    pub ignored: bool,
    run: Box<dyn FnOnce() -> Outcome + Send>,
}

impl Test {
    pub(crate) fn case(name: String, run: impl FnOnce() -> Outcome + Send + 'static) -> Test {
        Test { name, ignored: false, run: Box::new(run) }
    }

    pub(crate) fn not_applicable(name: String, term: String) -> Test {
        Test { name, ignored: true, run: Box::new(|| Outcome::NotApplicable(term)) }
    }

    /// Stands for all cases when none can be run.
    pub(crate) fn broken(name: &str, why: impl std::fmt::Display) -> Test {
        let why = visible(&why.to_string());
        Test::case(name.to_owned(), || Outcome::Failed(why))
    }

    /// Runs it.
    pub fn run(self) -> Outcome {
        (self.run)()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use fsct_reports::record::VariantInfo;

    fn ended(execution: Execution, verdict: Verdict) -> Outcome {
        Outcome::of(&CaseRecord {
            key: "FSD-0001[pd=3]".to_owned(),
            id: "FSD-0001".to_owned(),
            suite: "device".to_owned(),
            dut: 0,
            role: "device".to_owned(),
            title: "A case".to_owned(),
            scenario: String::new(),
            place: "device.yaml:1".to_owned(),
            sweep: Vec::new(),
            variant: VariantInfo::default(),
            requirements: Vec::new(),
            verdict,
            execution,
            reasons: Vec::new(),
            tolerances: [("A19".to_owned(), "another \u{1b}reading".to_owned())].into(),
            open: Vec::new(),
            transitions: [].into(),
            walked: Default::default(),
            start: "operate".to_owned(),
            steps: Vec::new(),
            measurements: Vec::new(),
            trace: Vec::new(),
            elided: 0,
            duration_ns: 0,
            replay: "cargo test".to_owned(),
        })
    }

    #[test]
    fn only_pass_and_remark_of_a_case_that_ran_are_ok() {
        assert_eq!(ended(Execution::Ok, Verdict::Pass), Outcome::Passed);
        let remark = "remark FSD-0001[pd=3]: tolerance A19: another \\u{1b}reading";
        assert_eq!(ended(Execution::Ok, Verdict::Remark), Outcome::Remark(remark.to_owned()));
        for (execution, verdict, word) in [
            (Execution::Ok, Verdict::Fail, "fail: "),
            (Execution::Ok, Verdict::Inconclusive, "inconclusive: "),
            (Execution::Timeout, Verdict::Pass, "timeout: "),
            (Execution::DutError, Verdict::Inconclusive, "dut-error: "),
            (Execution::RigError, Verdict::Inconclusive, "rig-error: "),
            (Execution::ToolError, Verdict::Pass, "tool-error: "),
            (Execution::Aborted, Verdict::Inconclusive, "aborted: "),
        ] {
            match ended(execution, verdict) {
                Outcome::Failed(text) => assert!(text.starts_with(word) && !text.contains('\u{1b}'), "{text}"),
                other => panic!("{execution:?} with {verdict:?} is {other:?}"),
            }
        }
    }
}
