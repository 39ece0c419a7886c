//! A start condition alone, for campaigns that go on from there by themselves.

use super::{Engine, Outcome};
use crate::case::model::Step;
use crate::tester::Tester;

impl Engine<'_, '_> {
    /// Runs a start condition and gives the testers back with what they sent last. The outcome is a pass only when every
    /// expectation of the start condition was met.
    pub fn reach(mut self, start: &[Step], name: &str) -> (Outcome, Vec<Tester>) {
        // A stop stands in the outcome.
        let _ = self.block(format!("start: {name}"), Vec::new(), |engine| engine.start(start));
        (self.outcome, self.testers)
    }
}
