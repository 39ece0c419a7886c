//! What crossed the boundary in one case, as it goes into the record: equal exchanges are counted, and of a very long case
//! the middle is left out and said so.

use crate::session::Reply;
use fsct_adapters::{Octets, Service, Stimulus};
use fsct_protocol::scl::T;
use fsct_reports::record::{Entry, What};
use std::collections::VecDeque;

const HEAD: usize = 200;
const TAIL: usize = 200;

/// The trace of a case.
#[derive(Debug, Default)]
pub struct Trace {
    head: Vec<Row>,
    tail: VecDeque<Row>,
    elided: usize,
    note: String,
}

/// One row, kept as it came: text is made when the case is recorded.
#[derive(Clone, Debug, PartialEq)]
struct Row {
    at: u64,
    count: u64,
    what: Happened,
    via: [u8; 8],
    note: String,
}

#[derive(Clone, Debug, PartialEq)]
enum Happened {
    Exchange { sent: Option<Octets>, got: Option<Octets> },
    Set { service: Service, value: Octets },
    Service { service: Service, value: Octets },
    Power(bool),
    Acyclic { request: String, answer: String },
    Event { code: u16, qualifier: u8 },
}

impl Trace {
    /// Says what the tester does on purpose with the next exchange.
    pub fn note(&mut self, note: String) {
        self.note = note;
    }

    /// Number of rows so far, those left out included.
    pub fn len(&self) -> usize {
        self.head.len() + self.elided + self.tail.len()
    }

    /// Whether nothing has happened yet.
    pub fn is_empty(&self) -> bool {
        self.head.is_empty()
    }

    /// A stimulus that shows by itself: supply and application inputs.
    pub fn stimulus(&mut self, at: u64, stimulus: &Stimulus) {
        match stimulus {
            Stimulus::Power(on) => self.push(at, Happened::Power(*on)),
            Stimulus::Set { service, value, .. } => {
                self.push(at, Happened::Set { service: *service, value: *value });
            }
            _ => {}
        }
    }

    /// An exchange with the transitions the DUT took.
    pub fn exchange(&mut self, at: u64, sent: Option<&[u8]>, got: Option<&[u8]>, via: impl Iterator<Item = T>) {
        let mut taken = [0; 8];
        taken.iter_mut().zip(via).for_each(|(slot, t)| *slot = t.0);
        let what = Happened::Exchange { sent: sent.and_then(Octets::new), got: got.and_then(Octets::new) };
        let note = std::mem::take(&mut self.note);
        let last = self.tail.back_mut().or(self.head.last_mut());
        if let Some(last) = last
            && last.what == what
            && taken == [0; 8]
            && note.is_empty()
        {
            last.count += 1;
            return;
        }
        self.put(Row { at, count: 1, what, via: taken, note });
    }

    /// An application service reported by the DUT.
    pub fn service(&mut self, at: u64, service: Service, value: &Octets) {
        self.push(at, Happened::Service { service, value: *value });
    }

    /// The answer to a read or write.
    pub fn reply(&mut self, at: u64, request: &Stimulus, reply: &Reply) {
        let answer = match reply {
            Reply::Value(data) => format!("= {}", hex(data)),
            Reply::Written => "written".to_owned(),
            Reply::Refused(error) => format!("refused 0x{error:04X}"),
            Reply::Unsupported => "unsupported".to_owned(),
        };
        self.push(at, Happened::Acyclic { request: name(request), answer });
    }

    /// An Event.
    pub fn event(&mut self, at: u64, code: u16, qualifier: u8) {
        self.push(at, Happened::Event { code, qualifier });
    }

    fn push(&mut self, at: u64, what: Happened) {
        self.put(Row { at, count: 1, what, via: [0; 8], note: String::new() });
    }

    fn put(&mut self, row: Row) {
        if self.head.len() < HEAD {
            return self.head.push(row);
        }
        if self.tail.len() == TAIL {
            self.tail.pop_front();
            self.elided += 1;
        }
        self.tail.push_back(row);
    }

    /// The entries for the record, how many were left out, and where a row has gone: the position of each row before
    /// and after leaving out.
    pub fn into_entries(self) -> (Vec<Entry>, u64, impl Fn(usize) -> usize) {
        let (elided, head) = (self.elided, self.head.len());
        let entries = self.head.into_iter().chain(self.tail).map(entry).collect();
        (entries, elided as u64, move |row: usize| if row < head { row } else { row.saturating_sub(elided).max(head) })
    }
}

fn entry(row: Row) -> Entry {
    let what = match row.what {
        Happened::Exchange { sent, got } => What::Exchange {
            port: 1,
            sent: sent.map(|octets| hex(octets.as_slice())),
            got: got.map(|octets| hex(octets.as_slice())),
        },
        Happened::Set { service, value } => {
            What::Set { service: service.name().to_owned(), value: hex(value.as_slice()) }
        }
        Happened::Service { service, value } => {
            What::Service { service: service.name().to_owned(), value: hex(value.as_slice()) }
        }
        Happened::Power(on) => What::Power { on },
        Happened::Acyclic { request, answer } => What::Acyclic { request, answer },
        Happened::Event { code, qualifier } => What::Event { code, qualifier },
    };
    let via = row.via.iter().take_while(|number| **number != 0).map(|number| format!("T{number}")).collect();
    Entry { at: row.at, count: row.count, what, via, note: row.note }
}

/// A stimulus in words.
pub fn name(stimulus: &Stimulus) -> String {
    match stimulus {
        Stimulus::Configure(variant) => {
            format!("{} with {}, {}/{} octets", variant.edition, variant.mode, variant.pd_out, variant.pd_in)
        }
        Stimulus::Power(on) => format!("power {}", if *on { "on" } else { "off" }),
        Stimulus::Exchange { .. } => "exchanges".to_owned(),
        Stimulus::Read { index, subindex } => format!("read 0x{index:04X}.{subindex}"),
        Stimulus::Write { index, subindex, data } => format!("write 0x{index:04X}.{subindex} = {}", hex(data)),
        Stimulus::Set { service, .. } => service.name().to_owned(),
        Stimulus::Advance { .. } => "a virtual clock".to_owned(),
        Stimulus::Other { kind, .. } => format!("stimulus kind {kind}"),
    }
}

/// Octets as upper-case hexadecimal.
pub fn hex(octets: &[u8]) -> String {
    octets.iter().map(|octet| format!("{octet:02X}")).collect()
}
