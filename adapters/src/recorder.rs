//! A wrapper that keeps what crosses the boundary to a DUT: flat entries in order, equal exchanges counted, and of very
//! many the first and the last.

use crate::{
    Description, Dut, DutError, MADE_UP, Observation, Octets, Seen, Service, SmiRequest, SmiResult, Stimulus, Variant,
};
use std::collections::VecDeque;

/// How many entries are kept; what stands between head and tail is counted and forgotten.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Keep {
    /// The first so many.
    pub head: usize,
    /// The last so many.
    pub tail: usize,
}

impl Default for Keep {
    fn default() -> Keep {
        Keep { head: 200, tail: 200 }
    }
}

/// One thing that crossed the boundary.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Entry {
    /// When, in nanoseconds on the clock of the DUT; of counted exchanges the first.
    pub at: u64,
    /// How many times in a row: exchanges with equal octets both ways that caused nothing else. Advances between
    /// them do not show.
    pub count: u64,
    /// What.
    pub what: Happened,
}

/// What crossed the boundary.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Happened {
    /// The DUT was told what to be.
    Configure(Variant),
    /// Supply on or off.
    Power(bool),
    /// Process data, after everything the exchange caused.
    Exchange {
        /// Port, from 1.
        port: u8,
        /// What the DUT received; `None`: lost.
        sent: Option<Octets>,
        /// What it presented; `None`: no process data.
        got: Option<Octets>,
    },
    /// An input service of the application was set.
    Set {
        /// Port, from 1; 0 for the whole DUT.
        port: u8,
        /// Which.
        service: Service,
        /// To what.
        value: Octets,
    },
    /// An output service of the application took a value.
    Service {
        /// Port, from 1.
        port: u8,
        /// Which.
        service: Service,
        /// Which value.
        value: Octets,
    },
    /// On-request data.
    Acyclic {
        /// [`Stimulus::Read`] or [`Stimulus::Write`].
        request: Stimulus,
        /// What the DUT answered.
        answer: Answer,
    },
    /// An Event.
    Event {
        /// EventCode.
        code: u16,
        /// EventQualifier.
        qualifier: u8,
    },
    /// What is connected to a port did something: [`Stimulus::Plug`], `Respond`, `Raise` or `Drive`.
    Done(Stimulus),
    /// An FS-Master did something on a port: [`Seen::Mode`], `Request`, `Line` or `Indication`.
    Saw(Seen),
    /// A request through the SMI; `None`: not served.
    Smi {
        /// The request.
        request: Box<SmiRequest>,
        /// What it came to.
        result: Option<Box<SmiResult>>,
    },
    /// A stimulus other than a read, a write or an SMI request was not served.
    Unserved(Stimulus),
}

/// The answer to a read or write.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Answer {
    /// Value read.
    Value(Vec<u8>),
    /// Written.
    Written,
    /// Refused with this ErrorType.
    Refused(u16),
    /// Not served.
    Unsupported,
}

/// What was recorded, in order.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Recording {
    /// The first entries.
    pub head: Vec<Entry>,
    /// Entries left out between head and tail.
    pub elided: usize,
    /// The last entries.
    pub tail: VecDeque<Entry>,
}

impl Recording {
    /// Number of entries, those left out included.
    pub fn len(&self) -> usize {
        self.head.len() + self.elided + self.tail.len()
    }

    /// Whether nothing was recorded.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The entries that were kept.
    pub fn entries(&self) -> impl Iterator<Item = &Entry> {
        self.head.iter().chain(&self.tail)
    }

    fn last_mut(&mut self) -> Option<&mut Entry> {
        // Behind elided entries the last of the head is not the last.
        if self.elided > 0 { self.tail.back_mut() } else { self.tail.back_mut().or(self.head.last_mut()) }
    }

    fn push(&mut self, keep: Keep, entry: Entry) {
        if self.head.len() < keep.head {
            return self.head.push(entry);
        }
        self.tail.push_back(entry);
        if self.tail.len() > keep.tail {
            self.tail.pop_front();
            self.elided += 1;
        }
    }
}

/// Records what goes through it to another DUT.
#[derive(Clone, Debug)]
pub struct Recorder<D> {
    dut: D,
    keep: Keep,
    recording: Recording,
    /// Where the clock of the DUT stands, as far as stimuli and observations tell.
    now: u64,
}

impl<D: Dut> Recorder<D> {
    /// Records a DUT.
    pub fn new(dut: D, keep: Keep) -> Recorder<D> {
        Recorder { dut, keep, recording: Recording::default(), now: 0 }
    }

    /// What was recorded since the latest `take`.
    pub fn take(&mut self) -> Recording {
        std::mem::take(&mut self.recording)
    }

    /// What was recorded so far.
    pub fn recording(&self) -> &Recording {
        &self.recording
    }

    /// The DUT itself.
    pub fn into_inner(self) -> D {
        self.dut
    }

    /// Records a stimulus with all it caused.
    fn record(&mut self, stimulus: &Stimulus, observed: &[Observation]) {
        let served = !observed.iter().any(|observation| observation.seen == Seen::Unsupported);
        match stimulus {
            Stimulus::Read { .. } | Stimulus::Write { .. } | Stimulus::Smi(_) => {}
            // Asked again and again while time passes on a real clock: it serves nobody and only brings what has happened.
            Stimulus::Other { kind: MADE_UP, .. } => self.counted(self.now, Happened::Unserved(stimulus.clone())),
            _ if !served => self.push(self.now, Happened::Unserved(stimulus.clone())),
            Stimulus::Configure(variant) => self.push(self.now, Happened::Configure(*variant)),
            Stimulus::Power(on) => self.push(self.now, Happened::Power(*on)),
            Stimulus::Set { port, service, value } => {
                self.push(self.now, Happened::Set { port: *port, service: *service, value: *value });
            }
            Stimulus::Plug { .. } | Stimulus::Respond { .. } | Stimulus::Raise { .. } | Stimulus::Drive { .. } => {
                self.push(self.now, Happened::Done(stimulus.clone()));
            }
            Stimulus::Advance { ns } => self.now = self.now.saturating_add(*ns),
            Stimulus::Exchange { .. } | Stimulus::Other { .. } => {}
        }
        for observation in observed {
            self.now = self.now.max(observation.at);
            self.record_seen(stimulus, observation);
        }
    }

    fn record_seen(&mut self, stimulus: &Stimulus, observation: &Observation) {
        let at = observation.at;
        let answer = match &observation.seen {
            Seen::Image { port, octets: got } => {
                let sent = if let Stimulus::Exchange { octets, .. } = stimulus { *octets } else { None };
                return self.counted(at, Happened::Exchange { port: *port, sent, got: *got });
            }
            Seen::Service { port, service, value } => {
                return self.push(at, Happened::Service { port: *port, service: *service, value: *value });
            }
            Seen::Event { code, qualifier } => {
                return self.push(at, Happened::Event { code: *code, qualifier: *qualifier });
            }
            seen @ (Seen::Mode { .. } | Seen::Request { .. } | Seen::Line { .. } | Seen::Indication { .. }) => {
                return self.push(at, Happened::Saw(seen.clone()));
            }
            Seen::Smi(result) => return self.smi(at, stimulus, Some(result.clone())),
            Seen::Unsupported if matches!(stimulus, Stimulus::Smi(_)) => return self.smi(at, stimulus, None),
            Seen::Value(octets) => Answer::Value(octets.clone()),
            Seen::Written => Answer::Written,
            Seen::Refused { error } => Answer::Refused(*error),
            Seen::Unsupported => Answer::Unsupported,
        };
        if matches!(stimulus, Stimulus::Read { .. } | Stimulus::Write { .. }) {
            self.push(at, Happened::Acyclic { request: stimulus.clone(), answer });
        }
    }

    fn smi(&mut self, at: u64, stimulus: &Stimulus, result: Option<Box<SmiResult>>) {
        if let Stimulus::Smi(request) = stimulus {
            self.push(at, Happened::Smi { request: request.clone(), result });
        }
    }

    /// What is the same as the entry before adds to its count.
    fn counted(&mut self, at: u64, what: Happened) {
        match self.recording.last_mut() {
            Some(last) if last.what == what => last.count += 1,
            _ => self.push(at, what),
        }
    }

    fn push(&mut self, at: u64, what: Happened) {
        self.recording.push(self.keep, Entry { at, count: 1, what });
    }
}

impl<D: Dut> Dut for Recorder<D> {
    fn hello(&mut self) -> Result<Description, DutError> {
        self.dut.hello()
    }

    /// Records what was observed before an error, too.
    fn apply(&mut self, stimuli: &[Stimulus], observed: &mut Vec<Observation>) -> Result<(), DutError> {
        let before = observed.len();
        let outcome = self.dut.apply(stimuli, observed);
        let mut rest = observed.get(before..).unwrap_or_default();
        for (position, stimulus) in stimuli.iter().enumerate() {
            if rest.is_empty() && outcome.is_err() {
                break;
            }
            // The low 16 bits: positions start again after `MAX_BATCH`.
            let caused = rest.iter().take_while(|observation| observation.stimulus == position as u16).count();
            let (these, later) = rest.split_at_checked(caused).unwrap_or((rest, &[]));
            self.record(stimulus, these);
            rest = later;
        }
        outcome
    }
}
