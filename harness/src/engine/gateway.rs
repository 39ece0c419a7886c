//! The end of a case on a gateway that is no FS-Master: no partner can restore its operation, healthy inputs have to.

use super::Engine;
use crate::session::Stop;
use fsct_adapters::{Line, Pco};
use fsct_reports::record::{Check, Verdict};

/// Where the inputs are looked at beyond the time the profile states, in nanoseconds.
const LATER_NS: u64 = 1_000_000_000;

impl Engine<'_, '_> {
    /// Supply off and on, every input low: within FSP_TimeToReady_ms of the profile every port has to be GOOD.
    pub(super) fn gateway_lives(&mut self) -> Result<(), Stop> {
        let ports: Vec<u8> = self.session.links.iter().map(|link| link.port).collect();
        if self.session.serves(Pco::Power) {
            self.power(false)?;
        }
        for port in &ports {
            self.turn_to(*port)?;
            self.drive(&[(Line::Cq, false), (Line::Iq, false)])?;
        }
        self.power(true)?;
        self.session.pass(self.session.profile.time_to_ready_ms * 1_000_000 + LATER_NS)?;
        let bad: Vec<String> = (self.session.links.iter())
            .filter(|link| link.app.qualifier != Some(true))
            .map(|link| format!("port {} is not GOOD", link.port))
            .collect();
        let observed = if bad.is_empty() { "every port is GOOD".to_owned() } else { bad.join(", ") };
        let check = Check {
            key: "app.qualifier".to_owned(),
            expected: "every port is GOOD".to_owned(),
            observed: observed.clone(),
            met: bad.is_empty(),
        };
        self.checks += 1;
        if let Some(record) = self.outcome.steps.last_mut() {
            record.checks.push(check);
        }
        if !bad.is_empty() {
            let clauses = self.judging.clauses.clone();
            let expected = "with healthy inputs every port is GOOD after power-on";
            self.reason(Verdict::Fail, "liveness", &clauses, expected, &observed);
        }
        Ok(())
    }
}
