//! What a campaign found: the reason, and what crossed the boundary with every SPDU decoded.

use super::action::{Script, from_hex};
use crate::oracle::Setup;
use crate::session::Stop;
use fsct_adapters::Role;
use fsct_protocol::spdu::View;
use fsct_reports::record::{Entry, Reason, Verdict, What};
use serde::Serialize;

/// Entries of the trace that a record keeps, the last ones.
const KEPT: usize = 100;

/// A failure of the DUT.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Finding {
    /// Nested name: `oracle/DCommErr`, `liveness`, `injection/reaction`.
    pub kind: String,
    /// Clause in the edition at hand.
    pub clause: String,
    /// What was expected.
    pub expected: String,
    /// What was observed.
    pub observed: String,
}

/// Why a list of actions was not carried out to its end.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Halt {
    /// The DUT failed.
    Failure(Box<Finding>),
    /// Nothing can be said.
    Inconclusive(String),
    /// The DUT was not reached, or broke the contract.
    Bench(String),
    /// The user asked to stop.
    Interrupted,
}

impl From<Stop> for Halt {
    fn from(stop: Stop) -> Halt {
        match stop {
            Stop::Mismatch(found) if found.verdict == Verdict::Fail => Halt::Failure(Box::new(Finding {
                kind: format!("oracle/{}", found.kind),
                clause: found.clause,
                expected: found.expected,
                observed: found.observed,
            })),
            Stop::Mismatch(found) => Halt::Inconclusive(format!(
                "{}: expected {}, observed {}",
                found.clause, found.expected, found.observed
            )),
            Stop::Dut(error) => Halt::Bench(error.to_string()),
            Stop::Unserved(what) => Halt::Bench(what),
            Stop::Slipped(expected, observed) => Halt::Inconclusive(format!("{observed} instead of {expected}")),
            Stop::Interrupted => Halt::Interrupted,
        }
    }
}

impl Halt {
    /// Something that would be a failure had the exchanges reached the DUT in time.
    pub fn slipped(what: &str) -> Halt {
        Halt::Inconclusive(format!(
            "{what}, but exchanges reached the DUT more than half a MasterCycleTime late, so it is not held against it"
        ))
    }

    /// A start condition that was not reached: where a DUT that presents SPDUs contradicts the tables it fails; anything else says
    /// nothing.
    pub fn not_started(reason: Option<&Reason>, answers: bool) -> Halt {
        let Some(reason) = reason else { return Halt::Inconclusive("the DUT did not reach operation".to_owned()) };
        if answers && reason.verdict == Verdict::Fail && reason.kind.starts_with("oracle/") {
            return Halt::Failure(Box::new(Finding {
                kind: reason.kind.clone(),
                clause: reason.clause.clone(),
                expected: reason.expected.clone(),
                observed: reason.observed.clone(),
            }));
        }
        Halt::Inconclusive(format!(
            "the DUT did not reach operation, so nothing was tested: expected {}, observed {}",
            reason.expected, reason.observed
        ))
    }
}

/// The record of a failure. The same list on the same DUT gives the same octets.
#[derive(Debug, Serialize)]
pub struct Record<'r> {
    schema: &'static str,
    edition: &'static str,
    mode: &'static str,
    pd_out: u8,
    pd_in: u8,
    /// What was done.
    actions: &'r [super::Action],
    /// Position of the action that shows the failure, from 1; 0 is the start, one past the last the return to operation.
    failed_at: usize,
    #[serde(flatten)]
    finding: &'r Finding,
    /// The end of what crossed the boundary.
    trace: Vec<Told<'r>>,
}

#[derive(Debug, Serialize)]
struct Told<'r> {
    #[serde(flatten)]
    entry: &'r Entry,
    #[serde(skip_serializing_if = "String::is_empty")]
    sent_is: String,
    #[serde(skip_serializing_if = "String::is_empty")]
    got_is: String,
}

impl<'r> Record<'r> {
    /// The record of what a list led to.
    pub fn new(script: &'r Script, failed_at: usize, finding: &'r Finding, trace: &'r [Entry], setup: &Setup) -> Self {
        let told = trace.iter().skip(trace.len().saturating_sub(KEPT)).map(|entry| {
            let (sent_is, got_is) = match &entry.what {
                What::Exchange { sent, got, .. } => {
                    (decoded(setup, sent.as_deref(), true), decoded(setup, got.as_deref(), false))
                }
                _ => (String::new(), String::new()),
            };
            Told { entry, sent_is, got_is }
        });
        Record {
            schema: "fsct-finding/1",
            edition: setup.edition.name(),
            mode: setup.mode.name(),
            pd_out: script.variant.pd_out,
            pd_in: script.variant.pd_in,
            actions: &script.actions,
            failed_at,
            finding,
            trace: told.collect(),
        }
    }

    /// The record as it is written.
    pub fn to_json(&self) -> String {
        serde_json::to_string_pretty(self).unwrap_or_default() + "\n"
    }

    /// The record for the terminal, with the last exchanges.
    pub fn to_text(&self) -> String {
        let Finding { kind, clause, expected, observed } = self.finding;
        let mut text = format!("  clause   {clause} [{kind}]\n  expected {expected}\n  observed {observed}\n");
        text += &format!("  {} with {}, PDout {}, PDin {} octets\n", self.edition, self.mode, self.pd_out, self.pd_in);
        text += &format!("  actions  {} behind the start of operation", self.actions.len());
        text += match self.failed_at {
            0 => ": it fails before the first\n",
            at if at > self.actions.len() => ": it fails on the way back to operation\n",
            _ => "\n",
        };
        for (number, action) in (1..).zip(self.actions) {
            let mark = if number == self.failed_at { ">" } else { " " };
            text += &format!("  {mark} {number:>3} {}\n", serde_json::to_string(action).unwrap_or_default());
        }
        for told in self.trace.iter().rev().take(8).rev() {
            let What::Exchange { sent, got, .. } = &told.entry.what else { continue };
            let (sent, got) = (sent.as_deref().unwrap_or("nothing"), got.as_deref().unwrap_or("nothing"));
            let ms = told.entry.at as f64 / 1e6;
            text += &format!("  {ms:>9.3} ms to the DUT   {sent} {}\n", told.sent_is);
            text += &format!("               from the DUT {got} {} {}\n", told.got_is, told.entry.via.join(" "));
        }
        text
    }
}

/// An SPDU in the words of Tables 31 and 32.
pub fn decoded(setup: &Setup, octets: Option<&str>, to_dut: bool) -> String {
    let Some(octets) = octets.and_then(from_hex) else { return String::new() };
    let pd = if to_dut { setup.sent_pd() } else { setup.image_pd() };
    let view = match View::new(&octets, setup.mode, pd) {
        Ok(view) if view.is_all_zero() => return "all octets 0".to_owned(),
        Ok(view) => view,
        Err(error) => return error.to_string(),
    };
    let from_master = to_dut == (setup.role == Role::Device);
    let bit = |bit: bool| u8::from(bit);
    let fields = if from_master {
        let c = view.control();
        format!("MCount {} setSD {} ChFAckReq {}", c.mcount, bit(c.set_sd), bit(c.ch_f_ack_req))
    } else {
        let s = view.status();
        let (sd, comm, time) = (bit(s.sd_set), bit(s.d_comm_err), bit(s.d_timeout));
        format!("DCount_i {} SDset {sd} DCommErr {comm} DTimeout {time}", s.dcount_i)
    };
    let own = if from_master { setup.port.number() } else { setup.port.inverted() };
    let port = if view.port_num() == own { String::new() } else { format!(" PortNum {:02X}", view.port_num()) };
    let signature = if view.signature_matches(setup.reading) { "" } else { " bad signature" };
    format!("{fields}{port}{signature}")
}
