//! From a YAML tree to typed steps. Every problem of a case is collected with its place.

use super::model::*;
use crate::problem::{Problem, Source, suggestion};
use crate::tree::{Fields, Placed};
use crate::yaml::{Node, Value};
use fsct_adapters::Service;
use std::ops::Range;
use std::sync::Arc;

const BITS: &[(bool, &str)] = &[(false, "0"), (true, "1")];
const SIGNATURES: &[(Signature, &str)] = &[
    (Signature::Good, "good"),
    (Signature::Zero, "zero"),
    (Signature::Inverted, "inverted"),
    (Signature::StartZero, "start-0"),
    (Signature::Reversed, "reversed"),
    (Signature::Order, "control-first"),
];
const FIELDS: &[(Field, &str)] =
    &[(Field::Data, "data"), (Field::PortNum, "PortNum"), (Field::Control, "control"), (Field::Signature, "signature")];
const LINKS: &[(Link, &str)] = &[(Link::Repeat, "repeat"), (Link::Lost, "lost"), (Link::Zero, "zero")];
const FROM: &[(From, &str)] = &[(From::Start, "start"), (From::Next, "next"), (From::Zero, "zero")];
const OPERATORS: &[(Operator, &str)] = &[(Operator::Acknowledges, "acknowledges"), (Operator::Absent, "absent")];
/// The words for the action of a step.
pub const ACTIONS: [&str; 9] = ["exchange", "wait", "partner", "power", "parameterize", "write", "read", "app", "look"];

/// Decodes the steps of a case or start condition; sweep variables have been replaced already.
pub fn steps(source: &Arc<Source>, node: &Node, problems: &mut Vec<Problem>) -> Vec<Step> {
    let items = crate::tree::list(source, node, "`steps`", problems);
    items.iter().filter_map(|item| Decoder { source, problems }.step(item)).collect()
}

struct Decoder<'a> {
    source: &'a Arc<Source>,
    problems: &'a mut Vec<Problem>,
}

impl Decoder<'_> {
    fn problem(&mut self, at: &Range<usize>, message: impl Into<String>) {
        self.problems.push(Problem::new(self.source, at.clone(), message));
    }

    fn step(&mut self, node: &Node) -> Option<Step> {
        let mut fields = Fields::new(self.source, node, "a step", self.problems);
        let found: Vec<(&str, &Node)> =
            ACTIONS.iter().filter_map(|word| fields.get(word).map(|value| (*word, value))).collect();
        let expect = fields.get("expect");
        let remark = fields.get("remark");
        let _note = fields.optional("note");
        fields.finish(self.problems);
        let at = match &node.value {
            Value::Map(entries) => entries.first().map_or(node.at.clone(), |(key, _)| key.at.clone()),
            _ => node.at.clone(),
        };
        let action = match found.as_slice() {
            [(word, value)] => self.action(word, value)?,
            [] if expect.is_some() || remark.is_some() => Action::Look,
            [] => {
                self.problem(&at, format!("a step needs one of {}", ACTIONS.join(", ")));
                return None;
            }
            [_, (second, value), ..] => {
                self.problem(&value.at, format!("a step does one thing; `{second}` belongs into a step of its own"));
                return None;
            }
        };
        let expect = expect.map(|node| self.expectations(node)).unwrap_or_default();
        let remark = remark.map(|node| self.expectations(node)).unwrap_or_default();
        Some(Step { text: crate::yaml::flow(node), at, action, expect, remark })
    }

    fn action(&mut self, word: &str, node: &Node) -> Option<Action> {
        match word {
            "exchange" => Some(Action::Exchange(Box::new(self.exchange(node)))),
            "wait" => self.wait(node),
            "partner" => Some(self.partner(node)),
            "power" => self.word(node, &[(Action::Power(true), "on"), (Action::Power(false), "off")], "power"),
            "parameterize" => {
                Fields::new(self.source, node, "`parameterize`", self.problems).finish(self.problems);
                Some(Action::Parameterize)
            }
            "write" | "read" => self.acyclic(word, node),
            "app" => Some(self.app(node)),
            _ => {
                Fields::new(self.source, node, "`look`", self.problems).finish(self.problems);
                Some(Action::Look)
            }
        }
    }

    fn word<T: Clone>(&mut self, node: &Node, words: &[(T, &str)], what: &str) -> Option<T> {
        let text = match &node.value {
            Value::Scalar(text) => text.as_str(),
            _ => "",
        };
        let found = words.iter().find(|(_, word)| *word == text).map(|(value, _)| value.clone());
        if found.is_none() {
            let help = suggestion(text, words.iter().map(|(_, word)| *word));
            let message = format!("`{text}` is no value of `{what}`");
            self.problems.push(Problem::new(self.source, node.at.clone(), message).help(help));
        }
        found
    }

    fn exchange(&mut self, node: &Node) -> Exchange {
        let mut fields = Fields::new(self.source, node, "`exchange`", self.problems);
        let mcount = fields.optional("MCount");
        let set_sd = fields.optional_word("setSD", BITS).unwrap_or(false);
        let ch_f_ack_req = fields.optional_word("ChFAckReq", BITS).unwrap_or(false);
        let pdout = fields.optional("PDout");
        let port_num = fields.optional("PortNum");
        let reserved = fields.optional_number("reserved", 0..=7).unwrap_or(0) as u8;
        let signature = fields.optional_word("signature", SIGNATURES).unwrap_or(Signature::Good);
        let corrupt = fields.texts("corrupt");
        let image = fields.optional("image");
        let times = fields.optional_number("times", 1..=10_000_000);
        let repeat = fields.optional_number("repeat", 1..=1_000_000).map(|count| count as u32);
        let until = fields.get("until");
        let within = fields.optional("within");
        fields.finish(self.problems);
        if times.is_some() && (until.is_some() || repeat.is_some()) || (repeat.is_some() && until.is_some()) {
            self.problem(&node.at, "`times`, `repeat` and `until` exclude each other");
        }
        let until_at = until.map(|node| node.at.clone());
        let until = until.map(|node| self.expectations(node)).unwrap_or_default();
        let within = self.scl_cycles(within);
        if let (Some(at), None) = (&until_at, within) {
            self.problem(at, "`until` needs `within`, such as `within: 2 SCL cycles`");
        }
        Exchange {
            mcount: mcount.and_then(|text| self.count(text)).unwrap_or(Count::Next),
            set_sd,
            ch_f_ack_req,
            pdout: pdout.and_then(|text| self.data(text)).unwrap_or(Data::Pattern),
            port_num: port_num.and_then(|text| self.port_num(text)).unwrap_or(PortNum::Own),
            reserved,
            signature,
            corrupt: self.corrupt(corrupt),
            image: image.and_then(|text| self.image(text)).unwrap_or(Image::Spdu),
            times: times.unwrap_or(1) as u32,
            until,
            within: within.unwrap_or(1),
            repeat,
        }
    }

    fn count(&mut self, (text, at): Placed) -> Option<Count> {
        match text.as_str() {
            "next" => Some(Count::Next),
            "same" => Some(Count::Same),
            _ => {
                let jump = text.strip_prefix('+').and_then(|more| more.parse().ok()).map(Count::Jump);
                let exact = text.parse().ok().filter(|count| *count <= 7).map(Count::Exactly);
                let found = jump.or(exact);
                if found.is_none() {
                    self.problem(&at, format!("`{text}` is no MCount: next, same, +1 and so on, or 0 to 7"));
                }
                found
            }
        }
    }

    fn data(&mut self, (text, at): Placed) -> Option<Data> {
        match text.as_str() {
            "pattern" => Some(Data::Pattern),
            "safe" => Some(Data::Safe),
            "same" => Some(Data::Same),
            "zero-signature" => Some(Data::ZeroSignature),
            _ => self.octets(&text, &at).map(Data::Exactly),
        }
    }

    fn octets(&mut self, text: &str, at: &Range<usize>) -> Option<Vec<u8>> {
        let digits: Option<Vec<u8>> = text
            .chars()
            .filter(|c| !c.is_whitespace() && *c != '_')
            .map(|c| c.to_digit(16).map(|digit| digit as u8))
            .collect();
        let octets = digits
            .filter(|digits| digits.len() % 2 == 0 && digits.len() <= 464)
            .map(|digits| digits.chunks_exact(2).map(|pair| pair[0] << 4 | pair[1]).collect());
        if octets.is_none() {
            self.problem(at, format!("`{text}` is neither a known word nor hexadecimal octets such as `5A 01`"));
        }
        octets
    }

    fn port_num(&mut self, (text, at): Placed) -> Option<PortNum> {
        match text.as_str() {
            "own" => Some(PortNum::Own),
            "inverted" => Some(PortNum::Inverted),
            "foreign" => Some(PortNum::Foreign),
            _ => match text.parse() {
                Ok(octet) => Some(PortNum::Exactly(octet)),
                Err(_) => {
                    self.problem(&at, format!("`{text}` is no PortNum: own, inverted, foreign, or 0 to 255"));
                    None
                }
            },
        }
    }

    fn corrupt(&mut self, texts: Vec<Placed>) -> Corrupt {
        if let [(text, _)] = texts.as_slice()
            && let Some((field, _)) = FIELDS.iter().find(|(_, word)| word == text)
        {
            return Corrupt::Field(*field);
        }
        let mut bits = Vec::new();
        for (text, at) in texts {
            match text.parse::<usize>() {
                Ok(bit) if bit < 8 * 31 => bits.push(bit),
                _ => {
                    let help = suggestion(&text, FIELDS.iter().map(|(_, word)| *word));
                    let message = format!("`{text}` is neither a bit (0 to 247) nor a field");
                    self.problems.push(Problem::new(self.source, at, message).help(help));
                }
            }
        }
        if bits.is_empty() { Corrupt::Nothing } else { Corrupt::Bits(bits) }
    }

    fn image(&mut self, (text, at): Placed) -> Option<Image> {
        match text.as_str() {
            "SPDU" => Some(Image::Spdu),
            "zero" => Some(Image::Zero),
            "lost" => Some(Image::Lost),
            "echo" => Some(Image::Echo),
            "standard" => Some(Image::Standard),
            _ => self.octets(&text, &at).map(Image::Exactly),
        }
    }

    fn scl_cycles(&mut self, placed: Option<Placed>) -> Option<u32> {
        let (text, at) = placed?;
        let number = text.strip_suffix("SCL cycles").or_else(|| text.strip_suffix("SCL cycle"));
        let cycles =
            number.and_then(|number| number.trim().parse().ok()).filter(|cycles| (1..=100_000).contains(cycles));
        if cycles.is_none() {
            self.problem(&at, format!("`{text}` is no number of SCL cycles, such as `2 SCL cycles`"));
        }
        cycles
    }

    fn wait(&mut self, node: &Node) -> Option<Action> {
        let mut fields = Fields::new(self.source, node, "`wait`", self.problems);
        let until = fields.text("until");
        let link = fields.optional_word("link", LINKS).unwrap_or(Link::Repeat);
        fields.finish(self.problems);
        let until = self.duration(until?)?;
        Some(Action::Wait(Wait { until, link }))
    }

    fn duration(&mut self, (text, at): Placed) -> Option<Duration> {
        let mut sum = Duration::default();
        let spaced = text.replace('+', " + ").replace('-', " - ");
        let mut sign = 1;
        let mut number = None;
        let mut open = true;
        for word in spaced.split_whitespace() {
            let amount = sign * number.unwrap_or(1);
            match word {
                "+" | "-" if !open => {
                    sign = if word == "-" { -1 } else { 1 };
                    (number, open) = (None, true);
                    continue;
                }
                "FSP_Watchdog" if open => sum.watchdogs += amount,
                "MasterCycleTime" if open => sum.cycles += amount,
                "margin" if open => sum.margins += amount,
                "guard" if open => sum.guards += amount,
                "ms" if open && number.is_some() => sum.ms += amount,
                _ => match word.parse::<i64>() {
                    Ok(value) if open && number.is_none() && (0..=1_000_000).contains(&value) => {
                        number = Some(value);
                        continue;
                    }
                    _ => return self.no_duration(&text, &at),
                },
            }
            open = false;
        }
        if open { self.no_duration(&text, &at) } else { Some(sum) }
    }

    fn no_duration(&mut self, text: &str, at: &Range<usize>) -> Option<Duration> {
        self.problem(
            at,
            format!(
                "`{text}` is no duration, such as `2 FSP_Watchdog - 1 MasterCycleTime` (also `margin`, `guard`, `5 ms`)"
            ),
        );
        None
    }

    fn partner(&mut self, node: &Node) -> Action {
        let mut fields = Fields::new(self.source, node, "`partner`", self.problems);
        let from = fields.optional_word("from", FROM).unwrap_or(From::Next);
        let operator = fields.optional_word("operator", OPERATORS).unwrap_or(Operator::Acknowledges);
        let until = fields.get("until");
        let within = fields.optional("within");
        fields.finish(self.problems);
        let until = until.map(|node| self.expectations(node)).unwrap_or_default();
        Action::Partner(Partner { from, operator, until, within: self.scl_cycles(within) })
    }

    fn acyclic(&mut self, word: &str, node: &Node) -> Option<Action> {
        let mut fields =
            Fields::new(self.source, node, if word == "read" { "`read`" } else { "`write`" }, self.problems);
        let index = fields.optional_number("index", 0..=0xFFFF);
        let subindex = fields.optional_number("subindex", 0..=255).unwrap_or(0) as u8;
        let data = if word == "write" { fields.text("data") } else { None };
        fields.finish(self.problems);
        let Some(index) = index else {
            self.problem(&node.at, format!("`{word}` needs `index`, such as `index: 0x4202`"));
            return None;
        };
        let index = index as u16;
        match data {
            None => Some(Action::Read { index, subindex }),
            Some((text, at)) => self.octets(&text, &at).map(|data| Action::Write { index, subindex, data }),
        }
    }

    fn app(&mut self, node: &Node) -> Action {
        let mut fields = Fields::new(self.source, node, "`app`", self.problems);
        let pdin = fields.optional("PDin_D");
        let sdset = fields.optional_word("SDset_DS", BITS);
        fields.finish(self.problems);
        let mut set = Vec::new();
        set.extend(pdin.and_then(|placed| self.data(placed)).map(|data| (Service::PdinD, data)));
        set.extend(sdset.map(|bit| (Service::SdsetDs, Data::Bit(bit))));
        if set.is_empty() {
            self.problem(&node.at, "`app` needs `PDin_D` or `SDset_DS`");
        }
        Action::App(set)
    }

    fn expectations(&mut self, node: &Node) -> Vec<Expectation> {
        let Value::Map(entries) = &node.value else {
            self.problem(&node.at, "expectations have to be a map such as `{SDset: 1}`");
            return Vec::new();
        };
        let mut found = Vec::new();
        for (key, value) in entries {
            let Some((name, _)) = Key::ALL.iter().find(|(_, name)| *name == key.text) else {
                let help = suggestion(&key.text, Key::ALL.iter().map(|(_, name)| *name));
                let message = format!("unknown key `{}` in an expectation", key.text);
                self.problems.push(Problem::new(self.source, key.at.clone(), message).help(help));
                continue;
            };
            let Value::Scalar(text) = &value.value else {
                self.problem(&value.at, format!("`{}` has to be a single value", key.text));
                continue;
            };
            if let Some(expected) = self.expected(*name, text, &value.at) {
                found.push(Expectation { key: *name, value: expected, text: text.clone() });
            }
        }
        if entries.is_empty() {
            self.problem(&node.at, "an empty expectation checks nothing");
        }
        found
    }

    fn expected(&mut self, key: Key, text: &str, at: &Range<usize>) -> Option<Expected> {
        let number = match text.strip_prefix("0x") {
            Some(hex) => u32::from_str_radix(hex, 16).ok(),
            None => text.parse::<u32>().ok(),
        };
        let words: &[(Expected, &str)] = match key {
            Key::DcountI => &[(Expected::Mirror, "mirror"), (Expected::Unchanged, "unchanged")],
            Key::SdSet | Key::DcommErr | Key::Dtimeout | Key::SetSdDc | Key::ChFAckReqDc | Key::Event => &[],
            Key::Pdin => &[(Expected::Live, "live"), (Expected::Safe, "safe")],
            Key::Image => &[(Expected::Safe, "zero"), (Expected::Unchanged, "unchanged"), (Expected::Answer, "answer")],
            Key::PdoutD => &[(Expected::Live, "live"), (Expected::Safe, "safe"), (Expected::Unchanged, "unchanged")],
            Key::Reply => &[(Expected::Written, "written"), (Expected::Refused, "refused")],
        };
        let most = match key {
            Key::DcountI => Some(7),
            Key::SdSet | Key::DcommErr | Key::Dtimeout | Key::SetSdDc | Key::ChFAckReqDc => Some(1),
            Key::Event => Some(0xFFFF),
            _ => None,
        };
        let octets = matches!(key, Key::Pdin | Key::PdoutD | Key::Reply);
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
}
