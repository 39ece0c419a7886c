//! The oracle for a port in OSSDe mode: what the qualifier handler of Table 43 may do, judged by its services.
//!
//! It judges what must never be: safe data left without acknowledgment, ON without both lines, a request that does not belong.
//! That something has to happen is a matter of the cases, which know the response time of the product.

use super::explain::Mismatch;
use fsct_protocol::Edition;
use fsct_reports::record::Verdict;

/// Antivalence of this length is no fault in either edition (R-5.3.2.1-09, L09).
const NO_FAULT_NS: u64 = 1_000_000;
/// Up to this length it is none in v1.1; in iec2022 that is open (L09).
const TOLERANCE_NS: u64 = 3_000_000;

/// What the services of the port show.
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq)]
struct Shown {
    on: bool,
    good: bool,
    request: bool,
}

/// The oracle.
#[derive(Debug)]
pub struct OssdeOracle {
    edition: Edition,
    /// How late an OFF may show, in nanoseconds.
    response_ns: u64,
    /// State 1 to 4 of Figure 65 (v1.1: 66).
    state: u8,
    shown: Shown,
    /// As the services stand, not looked at yet.
    reported: Shown,
    lines: (bool, bool),
    /// When the lines were last both high.
    high_until: Option<u64>,
    antivalent_since: Option<u64>,
    /// The longest antivalence that has not been answered by a fault yet.
    longest: u64,
    ack: bool,
    /// A rising edge of AckQ came in state 4.
    edge: bool,
    taken: [u64; 6],
}

impl OssdeOracle {
    /// A port that has just been put into OSSDe mode.
    pub const fn new(edition: Edition, response_ns: u64) -> OssdeOracle {
        let nothing = Shown { on: false, good: false, request: false };
        OssdeOracle {
            edition,
            response_ns,
            state: 1,
            shown: nothing,
            reported: nothing,
            lines: (false, false),
            high_until: None,
            antivalent_since: None,
            longest: 0,
            ack: false,
            edge: false,
            taken: [0; 6],
        }
    }

    /// Levels on C/Q and I/Q from this time on.
    pub fn lines(&mut self, at: u64, cq: bool, iq: bool) {
        if self.lines == (true, true) && (cq, iq) != (true, true) {
            self.high_until = Some(at);
        }
        self.lines = (cq, iq);
        match (cq != iq, self.antivalent_since) {
            (true, None) => self.antivalent_since = Some(at),
            (false, Some(since)) => {
                self.longest = self.longest.max(at - since);
                self.antivalent_since = None;
            }
            _ => {}
        }
    }

    /// AckQ.
    pub fn ack(&mut self, value: bool) {
        self.edge |= value && !self.ack && self.state == 4;
        self.ack = value;
    }

    /// PDin_M: whether it says ON.
    pub fn on(&mut self, on: bool) {
        self.reported.on = on;
    }

    /// Qualifier: GOOD.
    pub fn good(&mut self, good: bool) {
        self.reported.good = good;
    }

    /// ChFAckReq_S.
    pub fn request(&mut self, request: bool) {
        self.reported.request = request;
    }

    fn antivalence(&self, at: u64) -> u64 {
        self.antivalent_since.map_or(self.longest, |since| self.longest.max(at.saturating_sub(since)))
    }

    /// Looks at what the services have come to by this time.
    ///
    /// # Errors
    /// The [`Mismatch`] when Table 43 has no transition for it.
    pub fn settle(&mut self, at: u64) -> Result<(), Mismatch> {
        let now = self.reported;
        let before = std::mem::replace(&mut self.shown, now);
        if now.on && !now.good {
            return fail("PDin_M", "", "SD while the qualifier is BAD", "PDin_M ON with BAD");
        }
        if now.on && self.lines != (true, true) {
            let since = self.high_until.unwrap_or(0);
            if at > since.saturating_add(self.response_ns) {
                let expected = "OFF: not both lines are high";
                return fail_at("OSSDe", "5.3.2.1, 5.6, 10.5", expected, "PDin_M ON");
            }
        }
        if now.good && now.request {
            return fail("ChFAckReq_S", " state 2", "ChFAckReq 0 with GOOD", "ChFAckReq 1");
        }
        if (now.good, now.request) != (before.good, before.request) {
            self.moved(at, now)?;
        }
        Ok(())
    }

    fn moved(&mut self, at: u64, now: Shown) -> Result<(), Mismatch> {
        let antivalence = self.antivalence(at);
        let still = self.antivalent_since.is_some_and(|since| at.saturating_sub(since) > TOLERANCE_NS);
        // A start with a fault shows nothing but that no GOOD comes: T2 has been taken when T4 follows.
        if self.state == 1 && (now.request || still) {
            self.take(2, 3);
        }
        match (self.state, now.good, now.request) {
            (1, true, false) => self.take(1, 2),
            (2, false, false) => {
                if antivalence <= NO_FAULT_NS {
                    let expected = "GOOD: no fault of the lines";
                    return fail("qualifier", " T3, 5.3.2.1", expected, "BAD without a fault that was given");
                }
                if antivalence <= TOLERANCE_NS && self.edition == Edition::V1_1 {
                    let expected = "GOOD: an antivalence of at most 3 ms is no fault";
                    return fail("qualifier", " T3, 5.3.2.1", expected, "BAD");
                }
                self.longest = 0;
                self.take(3, 3);
            }
            (3, false, true) if self.antivalent_since.is_none() => {
                self.longest = 0;
                self.edge = false;
                self.take(4, 4);
            }
            (3, false, true) => {
                return fail("ChFAckReq_S", " T4", "ChFAckReq 0: the fault is still there", "ChFAckReq 1");
            }
            (4, true, false) if self.edge => {
                self.edge = false;
                self.take(5, 2);
            }
            (4, false, false) => {
                self.longest = 0;
                self.take(6, 3);
            }
            (3 | 4, true, _) => {
                let expected = "BAD until a rising edge of AckQ in state 4: no restart without acknowledgment";
                return fail("qualifier", " T5", expected, "GOOD");
            }
            (_, good, request) => {
                let observed = format!("{} with ChFAckReq {}", word(good), u8::from(request));
                return fail("qualifier", "", &format!("what state {} shows", self.state), &observed);
            }
        }
        Ok(())
    }

    fn take(&mut self, transition: u8, target: u8) {
        if let Some(count) = self.taken.get_mut(usize::from(transition) - 1) {
            *count += 1;
        }
        self.state = target;
    }

    /// How often each of T1..T6 was taken.
    pub fn taken(&self) -> [u64; 6] {
        self.taken
    }
}

fn word(good: bool) -> &'static str {
    if good { "GOOD" } else { "BAD" }
}

fn fail(kind: &str, row: &str, expected: &str, observed: &str) -> Result<(), Mismatch> {
    fail_at(kind, &format!("11.11.5 Table 43{row}"), expected, observed)
}

fn fail_at(kind: &str, clause: &str, expected: &str, observed: &str) -> Result<(), Mismatch> {
    Err(Mismatch {
        verdict: Verdict::Fail,
        kind: kind.to_owned(),
        clause: clause.to_owned(),
        expected: expected.to_owned(),
        observed: observed.to_owned(),
    })
}
