//! What a complete suite shows once all its sequences have passed, in three sentences to quote; or why it shows nothing.

use crate::html::{LISTED, NAME, role};
use crate::record::{CaseRecord, CompleteInfo, Execution, Header, Verdict};
use crate::summary::Summary;
use crate::text::short;
use maud::{Markup, html};
use serde::Serialize;
use std::collections::BTreeSet;

/// What came of a complete suite on one DUT.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Complete {
    /// The suite.
    #[serde(flatten)]
    pub suite: CompleteInfo,
    /// Cases that passed.
    pub passed: usize,
    /// Cases that failed.
    pub failed: usize,
    /// Tolerances made use of in it.
    pub tolerances: BTreeSet<String>,
    /// What is shown, on which assumptions, and where it ends; one sentence alone when nothing is shown.
    pub claim: Vec<String>,
}

impl Complete {
    /// Those of a header, nothing seen yet.
    pub fn begin(header: &Header) -> Vec<Complete> {
        let begun = |suite: &CompleteInfo| Complete {
            suite: suite.clone(),
            passed: 0,
            failed: 0,
            tolerances: BTreeSet::new(),
            claim: Vec::new(),
        };
        header.complete.iter().map(begun).collect()
    }

    /// Counts a case, if it is one of it.
    pub fn add(&mut self, case: &CaseRecord) {
        if case.dut != self.suite.dut || case.id != self.suite.id {
            return;
        }
        let as_expected = matches!(case.verdict, Verdict::Pass | Verdict::Remark);
        self.passed += usize::from(as_expected && case.execution == Execution::Ok);
        self.failed += usize::from(case.verdict == Verdict::Fail);
        self.tolerances.extend(case.tolerances.keys().chain(&case.open).cloned());
    }

    /// Concludes, when all cases have been counted.
    pub fn end(&mut self) {
        self.claim = match self.is_shown() {
            true => vec![self.shown(), self.assumed(), self.limited()],
            false => vec![self.why_not()],
        };
    }

    /// Whether every sequence of the suite passed, and without a tolerance.
    pub fn is_shown(&self) -> bool {
        let CompleteInfo { sequences, planned, .. } = self.suite;
        sequences > 0 && planned >= sequences && self.passed == planned && self.tolerances.is_empty()
    }

    fn name(&self) -> String {
        role(&self.suite.role)
    }

    fn table(&self) -> &'static str {
        if self.suite.role == "device" { "Table 40" } else { "Table 38" }
    }

    fn shown(&self) -> String {
        let CompleteInfo { sequences, length, inputs, states, extra, variant, .. } = &self.suite;
        let (name, table, most) = (self.name(), self.table(), states + extra);
        format!(
            "This {name} ({}) answered all {sequences} sequences of a complete suite, {length} inputs in all, as {table} has it: to any \
             sequence of the {inputs} inputs, however long, it answers as the {states} states of {table} that can be told apart, or \
             else it has more than {most} states.",
            short(variant, NAME)
        )
    }

    fn assumed(&self) -> String {
        let counters = match self.suite.absolute {
            true => "",
            false => {
                " that treats a counter by what it is to the one before (next, 0, the same, another) and not by its value,"
            }
        };
        let start = if self.suite.role == "device" {
            "supply off and on and FSP parameterization"
        } else {
            "supply off and on, configuration and start of the port"
        };
        format!(
            "This rests on a DUT that is deterministic,{counters} that {start} bring back to the same state, and whose timer runs for \
             FSP_Watchdog of the profile; and on the outputs looked at: the SPDU with counter and flags, which process data are live or \
             SD, and the services of the application, but for what a tolerance leaves free ({}) and the oracle cannot tell.",
            if self.suite.role == "device" { "A20, A27" } else { "A12, A13" }
        )
    }

    fn limited(&self) -> String {
        "It says nothing of what these inputs do not vary: values of process data, PortNum, any corruption but one bit of the signature, \
         times other than FSP_Watchdog, FSP parameters, Data Storage, lines and the SMI; nor of more states than that, nor of faults \
         of hardware."
            .to_owned()
    }

    fn why_not(&self) -> String {
        let CompleteInfo { sequences, planned, .. } = self.suite;
        let used: Vec<String> = self.tolerances.iter().take(LISTED).map(|id| short(id, NAME)).collect();
        if self.failed > 0 {
            return format!(
                "{} of {planned} sequences failed: this is no {} of {}.",
                self.failed,
                self.name(),
                self.table()
            );
        }
        if planned < sequences {
            return format!(
                "Only {planned} of {sequences} sequences were asked for, and a part shows nothing of the rest."
            );
        }
        if self.passed < planned {
            return format!("{} of {planned} sequences came to a verdict, which is not all.", self.passed);
        }
        format!(
            "All {planned} sequences passed, but with use of {}: where its answers are not those of {}, its states were not told apart \
             either, so that nothing is claimed beyond the sequences.",
            used.join(", "),
            self.table()
        )
    }

    /// The claim of a line.
    pub fn said(&self) -> String {
        let CompleteInfo { id, sequences, states, extra, absolute, .. } = &self.suite;
        let counters = if *absolute { "counters absolute" } else { "counters relative" };
        match self.is_shown() {
            true => format!(
                "{}: complete for {states} states and {extra} more, {counters}: {sequences} sequences passed",
                short(id, NAME)
            ),
            false => format!("{}: not complete. {}", short(id, NAME), self.why_not()),
        }
    }
}

/// The part of the report.
pub fn section(summary: &Summary) -> Markup {
    html! {
        @if !summary.complete.is_empty() { h2 { "Complete suites" } }
        (claims(summary))
    }
}

/// What each suite shows.
pub fn claims(summary: &Summary) -> Markup {
    html! {
        @for suite in summary.complete.iter().take(LISTED) {
            h3 {
                span.word { @if suite.is_shown() { "✓ " } @else { "– " } (short(&suite.suite.id, NAME)) }
                " · " (suite.name()) " · " (suite.suite.states) " states and " (suite.suite.extra) " more · counters "
                @if suite.suite.absolute { "absolute" } @else { "relative" }
            }
            @for sentence in &suite.claim { p { (sentence) } }
        }
    }
}
