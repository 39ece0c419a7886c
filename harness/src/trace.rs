//! What the record says of a case: the recording of what crossed the boundary, with the transitions the oracle saw and the
//! tester's notes beside it.

use fsct_adapters::{Answer, Happened, Line, MADE_UP, Octets, Recording, Response, Seen, Service, Stimulus};
use fsct_reports::record::{Entry, What};
use std::collections::VecDeque;

/// Margin notes kept: more than a recording keeps entries.
const NOTES: usize = 2_000;

/// What stands beside the exchanges of a recording, by the time of each.
#[derive(Debug, Default)]
pub struct Margin {
    notes: VecDeque<Note>,
    /// Notes of the beginning of a very long case; its middle is not kept.
    head: Vec<Note>,
    next: String,
}

#[derive(Clone, Debug)]
struct Note {
    at: u64,
    via: [u8; 8],
    text: String,
}

impl Margin {
    /// Says what the tester does on purpose with the next exchange.
    pub fn announce(&mut self, text: String) {
        self.next = text;
    }

    /// Notes the transitions the DUT took in the exchange at this time; `current`: on the link the tester announced for.
    pub fn exchange(&mut self, at: u64, taken: [u8; 8], current: bool) {
        let text = if current { std::mem::take(&mut self.next) } else { String::new() };
        if taken == [0; 8] && text.is_empty() {
            return;
        }
        let note = Note { at, via: taken, text };
        if self.head.len() < NOTES {
            return self.head.push(note);
        }
        if self.notes.len() == NOTES {
            self.notes.pop_front();
        }
        self.notes.push_back(note);
    }
}

/// A recording as entries of the record.
pub struct Told {
    /// The entries, times counted from the beginning of the case.
    pub entries: Vec<Entry>,
    /// Entries left out of the middle.
    pub elided: u64,
    head: usize,
}

impl Told {
    /// Tells a recording whose clock stood at `zero` when the case began.
    pub fn new(recording: &Recording, margin: Margin, zero: u64) -> Told {
        let mut entries: Vec<(u64, Entry)> = recording.entries().map(|entry| (entry.at, told(entry, zero))).collect();
        for note in margin.head.into_iter().chain(margin.notes) {
            // Equal exchanges are one entry, at the time of the first.
            let upto = entries.partition_point(|(at, _)| *at <= note.at);
            let exchange = entries[..upto].iter_mut().rfind(|(_, entry)| matches!(entry.what, What::Exchange { .. }));
            if let Some((_, entry)) = exchange {
                entry.via.extend(note.via.iter().take_while(|number| **number != 0).map(|number| format!("T{number}")));
                if entry.note.is_empty() {
                    entry.note = note.text;
                }
            }
        }
        Told {
            entries: entries.into_iter().map(|(_, entry)| entry).collect(),
            elided: recording.elided as u64,
            head: recording.head.len(),
        }
    }

    /// Where an entry of the recording stands now; one that was left out stands where the gap is.
    pub fn place(&self, entry: usize) -> usize {
        if entry < self.head { entry } else { entry.saturating_sub(self.elided as usize).max(self.head) }
    }

    /// The last exchange at or before this time of the case.
    pub fn exchange_at(&self, at: u64) -> Option<usize> {
        let upto = self.entries.partition_point(|entry| entry.at <= at);
        self.entries[..upto].iter().rposition(|entry| matches!(entry.what, What::Exchange { .. }))
    }
}

fn told(entry: &fsct_adapters::Entry, zero: u64) -> Entry {
    let octets = |octets: &Octets| hex(octets.as_slice());
    let service = |service: &Service| service.name().to_owned();
    let what = match &entry.what {
        Happened::Exchange { port, sent, got } => {
            What::Exchange { port: *port, sent: sent.as_ref().map(octets), got: got.as_ref().map(octets) }
        }
        Happened::Set { port, service: which, value } => {
            What::Set { port: *port, service: service(which), value: octets(value) }
        }
        Happened::Service { port, service: which, value } => {
            What::Service { port: *port, service: service(which), value: octets(value) }
        }
        Happened::Done(stimulus) => What::Port { port: port(stimulus), dut: false, text: name(stimulus) },
        Happened::Saw(seen) => told_of_port(seen),
        Happened::Smi { request, result } => What::Smi {
            request: format!("{} port {} {}", request.service, request.port, hex(&request.octets)),
            result: match result {
                None => "unsupported".to_owned(),
                Some(result) => {
                    format!("Result({}) {}", if result.positive { "+" } else { "-" }, hex(&result.octets))
                }
            },
        },
        Happened::Power(on) => What::Power { on: *on },
        Happened::Acyclic { request, answer } => What::Acyclic {
            request: name(request),
            answer: match answer {
                Answer::Value(data) => format!("= {}", hex(data)),
                Answer::Written => "written".to_owned(),
                Answer::Refused(error) => format!("refused 0x{error:04X}"),
                Answer::Unsupported => "unsupported".to_owned(),
            },
        },
        Happened::Event { code, qualifier } => What::Event { code: *code, qualifier: *qualifier },
        Happened::Configure(variant) => {
            What::Acyclic { request: name(&Stimulus::Configure(*variant)), answer: "done".to_owned() }
        }
        Happened::Unserved(stimulus) => What::Acyclic { request: name(stimulus), answer: "unsupported".to_owned() },
    };
    Entry { at: entry.at.saturating_sub(zero), count: entry.count, what, via: Vec::new(), note: String::new() }
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
        Stimulus::Plug { device: None, .. } => "nothing connected".to_owned(),
        Stimulus::Plug { device: Some(identity), .. } => format!(
            "Device connected: VendorID 0x{:04X}, DeviceID 0x{:06X}, COM{}, {} octets in, {} out",
            identity.vendor_id, identity.device_id, identity.com, identity.pd_in, identity.pd_out
        ),
        Stimulus::Respond { response, .. } => match response {
            Response::Value(value) => format!("the Device answers {}", hex(value)),
            Response::Written => "the Device answers: written".to_owned(),
            Response::Refused(error) => format!("the Device refuses with 0x{error:04X}"),
        },
        Stimulus::Raise { code, qualifier, .. } => {
            format!("the Device raises Event 0x{code:04X} qualifier 0x{qualifier:02X}")
        }
        Stimulus::Drive { line, level, .. } => format!("{line} driven {}", if *level { "high" } else { "low" }),
        Stimulus::Smi(request) => request.service.to_string(),
        Stimulus::Other { kind: MADE_UP, .. } => "a look at what has happened".to_owned(),
        Stimulus::Other { kind, .. } => format!("stimulus kind {kind}"),
    }
}

fn port(stimulus: &Stimulus) -> u8 {
    match stimulus {
        Stimulus::Plug { port, .. }
        | Stimulus::Respond { port, .. }
        | Stimulus::Raise { port, .. }
        | Stimulus::Drive { port, .. } => *port,
        _ => 0,
    }
}

fn told_of_port(seen: &Seen) -> What {
    let (port, text) = match seen {
        Seen::Mode { port, mode } => (*port, mode.to_string()),
        Seen::Request { port, index, subindex, data: None } => (*port, format!("reads 0x{index:04X}.{subindex}")),
        Seen::Request { port, index, subindex, data: Some(data) } => {
            (*port, format!("writes 0x{index:04X}.{subindex} = {}", hex(data)))
        }
        Seen::Line { port, line: Line::WakeUp, .. } => (*port, "wake-up pulse".to_owned()),
        Seen::Line { port, line, level } => (*port, format!("{line} {}", if *level { "on" } else { "off" })),
        Seen::Indication { port, source, qualifier, code } => {
            (*port, format!("{source} 0x{code:04X} qualifier 0x{qualifier:02X}"))
        }
        _ => (0, String::new()),
    };
    What::Port { port, dut: true, text }
}

/// Octets as upper-case hexadecimal.
pub fn hex(octets: &[u8]) -> String {
    octets.iter().map(|octet| format!("{octet:02X}")).collect()
}
