//! The steps that only a port of an FS-Master knows: configuration, start, lines, SMI.

use super::Decoder;
use crate::case::model::*;
use crate::problem::{Problem, suggestion};
use crate::tree::{self, Fields};
use crate::yaml::{self, Node};
use fsct_adapters::{Line, Role, SmiService};
use fsct_protocol::smi::FS_PORT_CONFIG_LIST;

const LEVELS: &[(bool, &str)] = &[(false, "0"), (true, "1")];
const ANSWERS: &[(Answered, &str)] =
    &[(Answered::Written, "written"), (Answered::Refused, "refused"), (Answered::Silent, "silent")];
const SPECIMENS: &[(Specimen, &str)] = &[
    (Specimen::Own, "own"),
    (Specimen::Factory, "factory"),
    (Specimen::Used, "used"),
    (Specimen::Moved, "moved"),
    (Specimen::Marked, "marked"),
    (Specimen::Broken, "broken"),
];
const RECORDS: &[(Assigned, &str)] = &[
    (Assigned::Authenticity, "authenticity"),
    (Assigned::Protocol, "protocol"),
    (Assigned::ProtocolTest, "protocol-test"),
];
const UNTIL: &[(Until, &str)] = &[
    (Until::Power, "L+"),
    (Until::WakeUp, "wake-up"),
    (Until::Preoperate, "PREOPERATE"),
    (Until::Record, "record"),
    (Until::Operate, "OPERATE"),
    (Until::Time, "time"),
];
/// What a start of a port may take at the most where a case says nothing: twice the longest off time, and what follows.
const WITHIN_MS: i64 = 25_000;
/// When a Ready pulse comes where a case says nothing.
const AFTER_MS: i64 = 10;
/// Width of a Ready pulse where a case says nothing: the middle of Table 7.
const PULSE_US: u64 = 750;

impl Decoder<'_> {
    pub(super) fn configure(&mut self, node: &Node) -> Action {
        let mut configure = Configure { starts: Some(true), ..Configure::default() };
        let yaml::Value::Map(entries) = &node.value else { return Action::Configure(configure) };
        for (key, value) in entries {
            let Some((text, at)) = tree::scalar(value) else {
                self.problem(&value.at, format!("`{}` has to be a single value", key.text));
                continue;
            };
            let number = number(&text);
            match (key.text.as_str(), number) {
                ("starts", _) => match text.as_str() {
                    "yes" => configure.starts = Some(true),
                    "no" => configure.starts = Some(false),
                    "open" => configure.starts = None,
                    _ => self.problem(&at, format!("`{text}` is no value of `starts`: yes, no or open")),
                },
                ("NSR_in", Some(octets @ 0..=32)) => configure.nsr.0 = octets as u8,
                ("NSR_out", Some(octets @ 0..=32)) => configure.nsr.1 = octets as u8,
                (name, _) => match FS_PORT_CONFIG_LIST.field(name) {
                    Some(field) => configure.set.extend(self.value(&text, &at).map(|value| (field, value))),
                    None => {
                        let known = FS_PORT_CONFIG_LIST.fields.iter().map(|field| field.name);
                        let help = suggestion(name, known.chain(["starts", "NSR_in", "NSR_out"]));
                        let message = format!("unknown field `{name}` of FSPortConfigList");
                        self.problems.push(Problem::new(self.source, key.at.clone(), message).help(help));
                    }
                },
            }
        }
        Action::Configure(configure)
    }

    pub(super) fn value(&mut self, text: &str, at: &std::ops::Range<usize>) -> Option<Value> {
        let value = match text {
            "wrong" => Some(Value::Wrong),
            "profile" => Some(Value::Profile),
            _ => number(text).map(Value::Number),
        };
        if value.is_none() {
            let known = "a number such as 49 or 0x1234, wrong, or profile";
            self.problem(at, format!("`{text}` is no value of a field: {known}"));
        }
        value
    }

    pub(super) fn connect(&mut self, node: &Node) -> Option<Action> {
        let mut fields = Fields::new(self.source, node, "`connect`", self.problems);
        let pulse = fields.optional("pulse_us");
        let after = fields.optional("after");
        let record = fields.optional_word("record", ANSWERS).unwrap_or(Answered::Written);
        let device = fields.optional_word("device", SPECIMENS);
        let vendor_id = fields.optional_number("VendorID", 0..=0xFFFF).map(|id| id as u16);
        let device_id = fields.optional_number("DeviceID", 0..=0xFF_FFFF).map(|id| id as u32);
        let until = fields.optional_word("until", UNTIL).unwrap_or(Until::Operate);
        let within = fields.optional("within");
        fields.finish(self.problems);
        let pulse_us = match pulse {
            None => Some(PULSE_US),
            Some((text, _)) if text == "none" => None,
            Some((text, at)) => match text.parse().ok().filter(|width| (1..=1_000_000).contains(width)) {
                Some(width) => Some(width),
                None => {
                    self.problem(&at, format!("`{text}` is no width of a Ready pulse in microseconds, nor none"));
                    None
                }
            },
        };
        let ms = |ms| Some(Duration { ms, ..Duration::default() });
        let after = after.map_or(ms(AFTER_MS), |text| self.duration(text))?;
        let within = within.map_or(ms(WITHIN_MS), |text| self.duration(text))?;
        Some(Action::Connect(Connect { pulse_us, after, record, device, vendor_id, device_id, until, within }))
    }

    pub(super) fn smi(&mut self, node: &Node) -> Option<Action> {
        let mut fields = Fields::new(self.source, node, "`smi`", self.problems);
        let service = fields.text("service");
        let port = fields.optional_number("port", 0..=255).map(|port| port as u8);
        let id = fields.optional_number("id", 0..=0xFFFF).map(|id| id as u16);
        let expected = fields.optional_number("expected", 0..=0xFFFF).map(|id| id as u16);
        let record = fields.optional_word("record", RECORDS);
        let octets = fields.optional("octets");
        let longer = fields.optional("longer");
        let set = fields.get("set");
        fields.finish(self.problems);
        let (name, at) = service?;
        let Some(service) = SmiService::from_name(&name) else {
            let help = suggestion(&name, SmiService::ALL.map(|entry| entry.2));
            self.problems.push(Problem::new(self.source, at, format!("`{name}` is no SMI service")).help(help));
            return None;
        };
        let octets = match octets {
            Some((text, at)) => Some(self.octets(&text, &at)?),
            None => None,
        };
        let longer = match longer {
            None => 0,
            Some((text, at)) => match text.parse::<i64>().ok().filter(|more| (-64..=64).contains(more)) {
                Some(more) => more,
                None => {
                    self.problem(&at, format!("`{text}` is no number of octets from -64 to 64"));
                    return None;
                }
            },
        };
        if record.is_some() && service != SmiService::DeviceWrite {
            self.problem(&node.at, "`record` goes with SMI_DeviceWrite alone");
        }
        let mut values = Vec::new();
        if let Some(node) = set {
            let yaml::Value::Map(entries) = &node.value else {
                self.problem(&node.at, "`set` has to be a map of fields");
                return None;
            };
            let known = blocks(service).0.map_or(&[][..], |block| block.fields);
            for (key, value) in entries {
                let Some((text, at)) = tree::scalar(value) else { continue };
                if !known.iter().any(|field| field.name == key.text) {
                    let help = suggestion(&key.text, known.iter().map(|field| field.name));
                    let message = format!("{service} has no field `{}`", key.text);
                    self.problems.push(Problem::new(self.source, key.at.clone(), message).help(help));
                    continue;
                }
                values.extend(self.value(&text, &at).map(|value| (key.text.clone(), value)));
            }
        }
        let smi = Smi { service, port, id, expected, set: values, record, octets, longer, at: node.at.clone() };
        Some(Action::Smi(Box::new(smi)))
    }

    pub(super) fn drive(&mut self, node: &Node) -> Action {
        let mut fields = Fields::new(self.source, node, "`drive`", self.problems);
        let cq = fields.optional_word("C/Q", LEVELS);
        let iq = fields.optional_word("I/Q", LEVELS);
        fields.finish(self.problems);
        if cq.is_none() && iq.is_none() {
            self.problem(&node.at, "`drive` needs `C/Q` or `I/Q`");
        }
        let levels = [(Line::Cq, cq), (Line::Iq, iq)];
        Action::Drive(levels.into_iter().filter_map(|(line, level)| Some((line, level?))).collect())
    }

    pub(super) fn pass(&mut self, node: &Node) -> Option<Action> {
        let mut fields = Fields::new(self.source, node, "`pass`", self.problems);
        const AFTER: &[(After, &str)] = &[(After::ReadyPulse, "Ready pulse"), (After::Ossde, "OSSDe")];
        let time = fields.text("time");
        let after = match self.role {
            Role::Device => fields.optional_word("after", AFTER),
            Role::Master => None,
        };
        fields.finish(self.problems);
        Some(Action::Pass { time: self.duration(time?)?, after })
    }

    pub(super) fn raise(&mut self, node: &Node) -> Option<Action> {
        let mut fields = Fields::new(self.source, node, "`raise`", self.problems);
        let code = fields.optional_number("code", 0..=0xFFFF);
        let qualifier = fields.optional_number("qualifier", 0..=0xFF).unwrap_or(0xF4) as u8;
        fields.finish(self.problems);
        let Some(code) = code else {
            self.problem(&node.at, "`raise` needs `code`, such as `code: 0xB000`");
            return None;
        };
        Some(Action::Raise { code: code as u16, qualifier })
    }
}

fn number(text: &str) -> Option<u32> {
    match text.strip_prefix("0x") {
        Some(hex) => u32::from_str_radix(hex, 16).ok(),
        None => text.parse().ok(),
    }
}
