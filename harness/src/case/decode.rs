//! From a YAML tree to typed steps. Every problem of a case is collected with its place.

use super::model::*;
use crate::problem::{Problem, Source, suggestion};
use crate::tree::{Fields, Placed};
use crate::yaml::{Node, Value};
use fsct_adapters::{Role, Service};
use fsct_lines::{Claim, Quantity};
use std::ops::Range;
use std::sync::Arc;

mod expect;
mod parameterize;
mod port;
mod spdu;

const BITS: &[(bool, &str)] = &[(false, "0"), (true, "1")];
const LINKS: &[(Meanwhile, &str)] =
    &[(Meanwhile::Repeat, "repeat"), (Meanwhile::Lost, "lost"), (Meanwhile::Zero, "zero")];
const FROM_MASTER: &[(From, &str)] =
    &[(From::Start, "start"), (From::Regular, "regular"), (From::Next, "next"), (From::Zero, "zero")];
const FROM_DEVICE: &[(From, &str)] = &[(From::Start, "start"), (From::Next, "regular")];
const OPERATORS: &[(Operator, &str)] = &[(Operator::Acknowledges, "acknowledges"), (Operator::Absent, "absent")];
const BACKS: &[(Back, &str)] = &[
    (Back::Corrupt, "corrupt"),
    (Back::Counter, "counter"),
    (Back::Foreign, "foreign"),
    (Back::Standard, "standard"),
    (Back::Echo, "echo"),
    (Back::Lost, "lost"),
    (Back::Late, "late"),
];
/// The words for the action of a step, and the side they are for.
const ACTIONS: [(&str, &[Role]); 19] = [
    ("exchange", &[Role::Device, Role::Master]),
    ("wait", &[Role::Device, Role::Master]),
    ("partner", &[Role::Device, Role::Master]),
    ("power", &[Role::Device, Role::Master]),
    ("parameterize", &[Role::Device]),
    ("write", &[Role::Device]),
    ("read", &[Role::Device]),
    ("data-storage", &[Role::Device]),
    ("technology", &[Role::Device]),
    ("app", &[Role::Device, Role::Master]),
    ("configure", &[Role::Master]),
    ("connect", &[Role::Master]),
    ("unplug", &[Role::Master]),
    ("smi", &[Role::Master]),
    ("drive", &[Role::Master]),
    ("pass", &[Role::Device, Role::Master]),
    ("wake", &[Role::Device]),
    ("raise", &[Role::Master]),
    ("look", &[Role::Device, Role::Master]),
];

/// Decodes the steps of a case or start condition; sweep variables have been replaced already.
pub fn steps(source: &Arc<Source>, role: Role, node: &Node, problems: &mut Vec<Problem>) -> Vec<Step> {
    let items = crate::tree::list(source, node, "`steps`", problems);
    items.iter().filter_map(|item| Decoder { source, role, problems }.step(item)).collect()
}

/// `N ago`: how many SPDUs or images before the last one.
fn ago(text: &str) -> Option<usize> {
    text.strip_suffix(" ago")?.parse().ok().filter(|count| *count < KEPT)
}

/// `t_RO.min`: an end of a limit.
fn limit(word: &str) -> Option<(Quantity, End)> {
    let (symbol, end) = word.rsplit_once('.')?;
    let end = [("min", End::Min), ("max", End::Max)].into_iter().find(|entry| entry.0 == end)?.1;
    Some((Quantity::from_symbol(symbol)?, end))
}

struct Decoder<'a> {
    source: &'a Arc<Source>,
    role: Role,
    problems: &'a mut Vec<Problem>,
}

impl Decoder<'_> {
    fn problem(&mut self, at: &Range<usize>, message: impl Into<String>) {
        self.problems.push(Problem::new(self.source, at.clone(), message));
    }

    fn step(&mut self, node: &Node) -> Option<Step> {
        let mut fields = Fields::new(self.source, node, "a step", self.problems);
        let words = || ACTIONS.iter().filter(|(_, roles)| roles.contains(&self.role)).map(|(word, _)| *word);
        let found: Vec<(&str, &Node)> =
            words().filter_map(|word| fields.get(word).map(|value| (word, value))).collect();
        let port = match self.role {
            Role::Device => None,
            Role::Master => fields.optional_number("port", 1..=255),
        };
        let expect = fields.get("expect");
        let remark = fields.get("remark");
        let measure = fields.get("measure");
        let noted = fields.optional("note").is_some();
        let numbers = fields.texts("activity");
        fields.finish(self.problems);
        let at = match &node.value {
            Value::Map(entries) => entries.first().map_or(node.at.clone(), |(key, _)| key.at.clone()),
            _ => node.at.clone(),
        };
        let action = match found.as_slice() {
            [(word, value)] => self.action(word, value)?,
            [] if expect.is_some() || remark.is_some() || measure.is_some() => Action::Look,
            [] => {
                let words = words().collect::<Vec<_>>().join(", ");
                self.problem(&at, format!("a step needs one of {words}"));
                return None;
            }
            [_, (second, value), ..] => {
                self.problem(&value.at, format!("a step does one thing; `{second}` belongs into a step of its own"));
                return None;
            }
        };
        let expect = expect.map(|node| self.expectations(node)).unwrap_or_default();
        let remark = remark.map(|node| self.expectations(node)).unwrap_or_default();
        let measure = measure.map(|node| self.wanted(node)).unwrap_or_default();
        let activities = numbers.into_iter().filter_map(|number| self.activity(number)).collect();
        let port = port.unwrap_or(1) as u8;
        Some(Step { activities, noted, text: crate::yaml::flow(node), at, port, action, expect, remark, measure })
    }

    fn activity(&mut self, (text, at): Placed) -> Option<u16> {
        let number = text.parse().ok().filter(|number| (1..=99).contains(number));
        if number.is_none() {
            self.problem(&at, format!("`{text}` is no number of an activity, from 1 to 99"));
        }
        number
    }

    fn action(&mut self, word: &str, node: &Node) -> Option<Action> {
        match word {
            "exchange" => Some(Action::Exchange(Box::new(self.exchange(node)))),
            "wait" => self.wait(node),
            "partner" => Some(self.partner(node)),
            "power" => self.word(node, &[(Action::Power(true), "on"), (Action::Power(false), "off")], "power"),
            "parameterize" => Some(Action::Parameterize(self.parameterize(node))),
            "write" | "read" => self.acyclic(word, node),
            "data-storage" => self
                .word(node, &[(Way::Upload, "upload"), (Way::Download, "download")], "data-storage")
                .map(Action::DataStorage),
            "technology" => self.word(
                node,
                &[(Action::Technology(true), "other"), (Action::Technology(false), "declared")],
                "technology",
            ),
            "app" => Some(self.app(node)),
            "configure" => Some(self.configure(node)),
            "connect" => self.connect(node),
            "unplug" => {
                Fields::new(self.source, node, "`unplug`", self.problems).finish(self.problems);
                Some(Action::Unplug)
            }
            "smi" => self.smi(node),
            "drive" => Some(self.drive(node)),
            "pass" => self.pass(node),
            "raise" => self.raise(node),
            "wake" => self.wake(node),
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
        let link = fields.optional_word("link", LINKS).unwrap_or(Meanwhile::Repeat);
        fields.finish(self.problems);
        let until = self.duration(until?)?;
        Some(Action::Wait(Wait { until, link }))
    }

    fn wake(&mut self, node: &Node) -> Option<Action> {
        let mut fields = Fields::new(self.source, node, "`wake`", self.problems);
        let after = fields.text("after");
        fields.finish(self.problems);
        Some(Action::Wake(Wake { after: self.duration(after?)? }))
    }

    /// `[t_RP, one-ready-pulse]`.
    fn wanted(&mut self, node: &Node) -> Vec<Wanted> {
        let items = crate::tree::list(self.source, node, "`measure`", self.problems);
        let words = || Quantity::ALL.iter().map(|entry| entry.1).chain(Claim::ALL.iter().map(|entry| entry.1));
        let mut found = Vec::new();
        for (text, at) in items.iter().filter_map(crate::tree::scalar) {
            let claim = || Claim::ALL.into_iter().find(|entry| entry.1 == text).map(|entry| Wanted::Claim(entry.0));
            match Quantity::from_symbol(&text).map(Wanted::Quantity).or_else(claim) {
                Some(wanted) => found.push(wanted),
                None => {
                    let help = suggestion(&text, words());
                    let message = format!("`{text}` is nothing that can be measured on the lines");
                    self.problems.push(Problem::new(self.source, at, message).help(help));
                }
            }
        }
        found
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
                "late" if open => sum.lates += amount,
                "guard" if open => sum.guards += amount,
                "ms" if open && number.is_some() => sum.ms += amount,
                "us" if open && number.is_some() => sum.us += amount,
                _ if open && sum.limit.is_none() && limit(word).is_some() => {
                    sum.limit = limit(word).map(|(quantity, end)| (amount, quantity, end));
                }
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
                "`{text}` is no duration, such as `2 FSP_Watchdog - 1 MasterCycleTime` (also `margin`, `late`, `guard`, `5 ms`, `900 us`, `t_RW.max`)"
            ),
        );
        None
    }

    fn partner(&mut self, node: &Node) -> Action {
        let mut fields = Fields::new(self.source, node, "`partner`", self.problems);
        let from = fields
            .optional_word("from", if self.role == Role::Device { FROM_MASTER } else { FROM_DEVICE })
            .unwrap_or(From::Next);
        let operator = fields.optional_word("operator", OPERATORS).unwrap_or(Operator::Acknowledges);
        let back = fields.optional("back");
        let back_for = fields.optional("for");
        let until = fields.get("until");
        let within = fields.optional("within");
        fields.finish(self.problems);
        if let (None, Some((_, at))) = (&back, &back_for) {
            self.problem(at, "`for` needs `back`: it says how long the way back is disturbed");
        }
        let back = back.and_then(|placed| self.back(placed));
        let back_for = back_for.and_then(|placed| self.duration(placed));
        let until = until.map(|node| self.expectations(node)).unwrap_or_default();
        let within = match within {
            Some(placed) if !placed.0.contains("SCL") => self.duration(placed).map(Within::Time),
            within => self.scl_cycles(within).map(Within::SclCycles),
        };
        Action::Partner(Partner { from, operator, back, back_for, until, within })
    }

    fn back(&mut self, (text, at): Placed) -> Option<Back> {
        let found = BACKS.iter().find(|(_, word)| *word == text).map(|(back, _)| *back);
        let found = found.or_else(|| ago(&text).filter(|count| *count > 0).map(Back::Ago));
        if found.is_none() {
            let help = suggestion(&text, BACKS.iter().map(|(_, word)| *word).chain(["1 ago"]));
            let message = format!("`{text}` is nothing that can happen on the way back");
            self.problems.push(Problem::new(self.source, at, message).help(help));
        }
        found
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
        let services: &[(Service, &'static str, bool)] = match self.role {
            Role::Device => &[
                (Service::PdinD, "PDin_D", false),
                (Service::SdsetDs, "SDset_DS", true),
                (Service::OssdeDemand, "OSSDe_demand", true),
            ],
            Role::Master => &[
                (Service::PdoutM, "PDout_M", false),
                (Service::SetsdC, "setSD_C", true),
                (Service::ChfackC, "ChFAck_C", true),
                (Service::FscpAuthenticity, "FSCP_Authenticity", false),
            ],
        };
        let (mut set, mut octets) = (Vec::new(), Vec::new());
        for (service, name, is_bit) in services {
            match is_bit {
                true => set.extend(fields.optional_word(name, BITS).map(|bit| (*service, Data::Bit(bit)))),
                false => octets.extend(fields.optional(name).map(|placed| (*service, placed))),
            }
        }
        fields.finish(self.problems);
        for (service, placed) in octets {
            set.extend(self.data(placed).map(|data| (service, data)));
        }
        if set.is_empty() {
            let names: Vec<String> = services.iter().map(|(_, name, _)| format!("`{name}`")).collect();
            self.problem(&node.at, format!("`app` needs {}", names.join(" or ")));
        }
        Action::App(set)
    }
}
