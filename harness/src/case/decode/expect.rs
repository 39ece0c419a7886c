//! What a step expects: keys and values by the side they are for.

use super::Decoder;
use crate::case::model::*;
use crate::problem::{Problem, suggestion};
use crate::yaml::{Node, Value};
use fsct_adapters::{Mode, Role};
use std::ops::Range;

impl Decoder<'_> {
    pub(super) fn expectations(&mut self, node: &Node) -> Vec<Expectation> {
        let Value::Map(entries) = &node.value else {
            self.problem(&node.at, "expectations have to be a map such as `{SDset: 1}`");
            return Vec::new();
        };
        let mut found = Vec::new();
        for (key, value) in entries {
            let Some(name) = self.key(&key.text) else {
                let known = Key::ALL.iter().filter(|(.., roles)| roles.contains(&self.role)).map(|entry| entry.1);
                let fields = block_fields().map(|field| format!("block.{field}"));
                let known: Vec<String> = known.map(str::to_owned).chain(fields).collect();
                let help = suggestion(&key.text, known.iter().map(String::as_str));
                let message = format!("unknown key `{}` in an expectation", key.text);
                self.problems.push(Problem::new(self.source, key.at.clone(), message).help(help));
                continue;
            };
            let Value::Scalar(text) = &value.value else {
                self.problem(&value.at, format!("`{}` has to be a single value", key.text));
                continue;
            };
            if let Some(expected) = self.expected(name, text, &value.at) {
                found.push(Expectation { key: name, value: expected, text: text.clone() });
            }
        }
        if entries.is_empty() {
            self.problem(&node.at, "an empty expectation checks nothing");
        }
        found
    }

    fn key(&self, text: &str) -> Option<Key> {
        if let Some(name) = text.strip_prefix("block.")
            && self.role == Role::Master
        {
            return block_fields().find(|field| *field == name).map(Key::Field);
        }
        Key::ALL.iter().find(|(_, name, roles)| *name == text && roles.contains(&self.role)).map(|entry| entry.0)
    }

    fn expected(&mut self, key: Key, text: &str, at: &Range<usize>) -> Option<Expected> {
        let number = match text.strip_prefix("0x") {
            Some(hex) => u32::from_str_radix(hex, 16).ok(),
            None => text.parse::<u32>().ok(),
        };
        if key == Key::Result {
            return self.results(text, at).map(Expected::Results);
        }
        if key == Key::DataStorage {
            return self.transfers(text, at).map(Expected::Transfers);
        }
        if matches!(key, Key::Field(_))
            && let Some(number) = text.strip_prefix("not ").and_then(|number| number.parse().ok())
        {
            return Some(Expected::Not(number));
        }
        if key == Key::EventType {
            return self.types(text, at).map(Expected::Types);
        }
        if key == Key::Event && text.contains(" or ") {
            return self.events(text, at);
        }
        if key == Key::Reply
            && let Some(expected) = reply(text)
        {
            return Some(expected);
        }
        let (words, most, octets) = values(key);
        let found = words.iter().find(|(_, word)| *word == text).map(|(value, _)| value.clone());
        let found = found.or_else(|| number.filter(|n| most.is_some_and(|most| *n <= most)).map(Expected::Number));
        let found = match (found, octets) {
            (None, true) if key == Key::Reply && text.starts_with("0x") => number.map(Expected::Number),
            (None, true) => return self.octets(text, at).map(Expected::Octets),
            (found, _) => found,
        };
        if found.is_none() {
            let mut known: Vec<String> = words.iter().map(|(_, word)| (*word).to_owned()).collect();
            known.extend(most.map(|most| format!("0 to {most}")));
            self.problem(at, format!("`{text}` is no value of `{}`: {}", key.name(), known.join(", ")));
        }
        found
    }

    /// EventCodes with ` or ` between, `none` among them.
    fn events(&mut self, text: &str, at: &Range<usize>) -> Option<Expected> {
        let codes: Option<Vec<u16>> = text
            .split(" or ")
            .filter(|word| *word != "none")
            .map(|word| u16::from_str_radix(word.strip_prefix("0x")?, 16).ok())
            .collect();
        if codes.is_none() {
            self.problem(
                at,
                format!("`{text}` is no value of `event`: EventCodes such as `0xB003 or 0xB005`, or `none`"),
            );
        }
        codes.map(|codes| Expected::Events(text.split(" or ").any(|word| word == "none"), codes))
    }

    /// Types of Events with ` or ` between.
    fn types(&mut self, text: &str, at: &Range<usize>) -> Option<Vec<u8>> {
        let types = text.split(" or ").map(|word| EVENT_TYPES.iter().find(|(_, known)| *known == word));
        let types: Option<Vec<u8>> = types.map(|found| found.map(|(number, _)| *number)).collect();
        if types.is_none() {
            let known = EVENT_TYPES.map(|(_, word)| word).join(", ");
            self.problem(at, format!("`{text}` is no value of `event.type`: {known}, several with ` or ` between"));
        }
        types
    }

    /// `positive`, `negative` or errors by name, several of them with ` or ` between.
    fn results(&mut self, text: &str, at: &Range<usize>) -> Option<Vec<Outcome>> {
        let mut found = Vec::new();
        for word in text.split(" or ") {
            let outcome = match word {
                "positive" => Outcome::Positive,
                "negative" => Outcome::Negative,
                name => match ERRORS.iter().find(|(_, known)| *known == name) {
                    Some((error, _)) => Outcome::Error(*error),
                    None => {
                        let known = ["positive", "negative"].into_iter().chain(ERRORS.iter().map(|entry| entry.1));
                        let help = suggestion(name, known);
                        let message = format!("`{name}` is no result of a service");
                        self.problems.push(Problem::new(self.source, at.clone(), message).help(help));
                        return None;
                    }
                },
            };
            found.push(outcome);
        }
        Some(found)
    }

    /// `none`, `upload`, `download` or `refused`, several of them with ` or ` between.
    fn transfers(&mut self, text: &str, at: &Range<usize>) -> Option<Vec<Transfer>> {
        let found: Option<Vec<Transfer>> = text
            .split(" or ")
            .map(|word| TRANSFERS.iter().find(|(_, known)| *known == word).map(|entry| entry.0))
            .collect();
        if found.is_none() {
            let known: Vec<&str> = TRANSFERS.iter().map(|entry| entry.1).collect();
            self.problem(at, format!("`{text}` is no value of `data-storage`: {}", known.join(", ")));
        }
        found
    }
}

const TRANSFERS: &[(Transfer, &str)] = &[
    (Transfer::None, "none"),
    (Transfer::Upload, "upload"),
    (Transfer::Download, "download"),
    (Transfer::Refused, "refused"),
];

/// `4 octets`, `1 to 32767`, `FSP_TechParCRC 1 to 65535` or `contains 40 01`; `None`: something else.
fn reply(text: &str) -> Option<Expected> {
    if let Some(octets) = text.strip_suffix(" octets") {
        return octets.parse().ok().map(Expected::Count);
    }
    if let Some(entry) = text.strip_prefix("contains ") {
        let octets: Option<Vec<u8>> = entry.split(' ').map(|octet| u8::from_str_radix(octet, 16).ok()).collect();
        return octets.map(Expected::Contains);
    }
    let (least, most) = text.split_once(" to ")?;
    let (field, least) = match least.rsplit_once(' ') {
        Some((name, least)) => (Some(RecordField::ALL.iter().find(|field| field.name == name)?), least),
        None => (None, least),
    };
    Some(Expected::Range(field, least.parse().ok()?, most.parse().ok()?))
}

type Words = &'static [(Expected, &'static str)];

/// The words a key takes, the greatest number, and whether octets will do.
fn values(key: Key) -> (Words, Option<u32>, bool) {
    const BITS: Option<u32> = Some(1);
    match key {
        Key::DcountI => (&[(Expected::Mirror, "mirror"), (Expected::Unchanged, "unchanged")], Some(7), false),
        Key::Mcount => (&[(Expected::Next, "next"), (Expected::Unchanged, "unchanged")], Some(7), false),
        Key::SdSet | Key::DcommErr | Key::Dtimeout | Key::SetSdDc | Key::ChFAckReqDc => (&[], BITS, false),
        Key::SetSd
        | Key::ChFAckReq
        | Key::SdsetS
        | Key::ChFAckReqS
        | Key::FaultsS
        | Key::PortPower
        | Key::Cq
        | Key::Iq => (&[], BITS, false),
        Key::Qualifier => (&[(Expected::Number(1), "GOOD"), (Expected::Number(0), "BAD")], None, false),
        Key::Pdin => (&[(Expected::Live, "live"), (Expected::Safe, "safe"), (Expected::Padded, "padded")], None, true),
        Key::Pdout => (&[(Expected::Live, "live"), (Expected::Safe, "safe")], None, true),
        Key::Structure => (&[(Expected::Count(16), "words")], None, false),
        Key::PortNum => (&[(Expected::Right, "right")], Some(0xFF), false),
        Key::Reserved => (&[], Some(0xFF), false),
        Key::Image => {
            (&[(Expected::Safe, "zero"), (Expected::Unchanged, "unchanged"), (Expected::Answer, "answer")], None, false)
        }
        Key::PdinM => {
            (&[(Expected::Live, "live"), (Expected::Safe, "safe"), (Expected::Unchanged, "unchanged")], None, true)
        }
        Key::PdoutD => (
            &[
                (Expected::Live, "live"),
                (Expected::Safe, "safe"),
                (Expected::Unchanged, "unchanged"),
                (Expected::Withheld, "withheld"),
            ],
            None,
            true,
        ),
        Key::Mode => (
            &[
                (Expected::Mode(Mode::Inactive), "INACTIVE"),
                (Expected::Mode(Mode::Startup), "STARTUP"),
                (Expected::Mode(Mode::Preoperate), "PREOPERATE"),
                (Expected::Mode(Mode::Operate), "OPERATE"),
            ],
            None,
            false,
        ),
        Key::WakeUp => (&[], Some(1_000), false),
        Key::Record => (
            &[(Expected::Configured, "configured"), (Expected::None, "none"), (Expected::Right, "before OPERATE")],
            None,
            true,
        ),
        Key::Reply => (
            &[
                (Expected::Written, "written"),
                (Expected::Refused, "refused"),
                (Expected::Configured, "authenticity"),
                (Expected::Structure, "structure"),
                (Expected::OtherTechnology, "other"),
                (Expected::Declared(Declared::Protocol), "iodd.FSP_Protocol"),
                (Expected::Declared(Declared::TimeToReady), "iodd.FSP_TimeToReady"),
                (Expected::Declared(Declared::MinShutDownTime), "iodd.FSP_MinShutDownTime"),
                (Expected::Declared(Declared::ParamDescCrc), "iodd.FSP_ParamDescCRC"),
                (Expected::Declared(Declared::Wcdt), "iodd.FSP_WCDT"),
                (Expected::Declared(Declared::Ofdt), "iodd.FSP_OFDT"),
                (Expected::Unlocked, "unlocked"),
            ],
            None,
            true,
        ),
        Key::Event => (&[(Expected::None, "none"), (Expected::Unreserved, "unreserved")], Some(0xFFFF), false),
        Key::Length => (&[(Expected::Right, "right")], Some(0xFFFF), false),
        Key::Reference => (&[], Some(0xFFFF), false),
        Key::Nsr => (&[], None, true),
        Key::Block => (
            &[(Expected::Configured, "configured"), (Expected::Snapshot, "snapshot"), (Expected::None, "none")],
            None,
            true,
        ),
        Key::Field(_) => (&[(Expected::Configured, "configured")], Some(u32::MAX), false),
        Key::Stored => (&[(Expected::Configured, "configured"), (Expected::Unchanged, "unchanged")], None, false),
        Key::Result | Key::DataStorage | Key::EventType => (&[], None, false),
    }
}

/// The names of the fields of all ArgBlocks.
fn block_fields() -> impl Iterator<Item = &'static str> {
    fsct_protocol::smi::ALL.into_iter().flat_map(|block| block.fields.iter().map(|field| field.name))
}
