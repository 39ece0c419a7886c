//! Reading typed values out of a YAML tree: every problem of a file is collected, none stops the reading.

use crate::problem::{Problem, Source, suggestion};
use crate::yaml::{Node, Value};
use std::ops::Range;
use std::sync::Arc;

/// A text with its place.
pub type Placed = (String, Range<usize>);

/// The items of a list; a problem and nothing when it is none.
pub fn list<'n>(source: &Arc<Source>, node: &'n Node, what: &str, problems: &mut Vec<Problem>) -> &'n [Node] {
    match &node.value {
        Value::List(items) => items,
        _ => {
            problems.push(Problem::new(source, node.at.clone(), format!("{what} has to be a list")));
            &[]
        }
    }
}

/// The text of a scalar.
pub fn scalar(node: &Node) -> Option<Placed> {
    match &node.value {
        Value::Scalar(text) => Some((text.clone(), node.at.clone())),
        _ => None,
    }
}

/// A map being read key by key; what is left over at [`Fields::finish`] is unknown.
pub struct Fields<'n> {
    source: &'n Arc<Source>,
    at: Range<usize>,
    what: &'n str,
    entries: &'n [(crate::yaml::Key, Node)],
    known: Vec<&'static str>,
    problems: Vec<Problem>,
}

impl<'n> Fields<'n> {
    /// Begins with a map; anything else is a problem and reads as an empty map.
    pub fn new(source: &'n Arc<Source>, node: &'n Node, what: &'n str, problems: &mut Vec<Problem>) -> Fields<'n> {
        let entries: &[_] = match &node.value {
            Value::Map(entries) => entries,
            Value::Null => &[],
            _ => {
                problems.push(Problem::new(source, node.at.clone(), format!("{what} has to be a map of keys")));
                &[]
            }
        };
        let at = entries.first().map_or(node.at.clone(), |(key, _)| key.at.clone());
        Fields { source, at, what, entries, known: Vec::new(), problems: Vec::new() }
    }

    /// The value of a key, if it is there.
    pub fn get(&mut self, key: &'static str) -> Option<&'n Node> {
        self.known.push(key);
        self.entries.iter().find(|(name, _)| name.text == key).map(|(_, node)| node)
    }

    /// The text of a key that has to be there.
    pub fn text(&mut self, key: &'static str) -> Option<Placed> {
        let Some(node) = self.get(key) else {
            self.problems.push(Problem::new(self.source, self.at.clone(), format!("{} needs `{key}`", self.what)));
            return None;
        };
        self.scalar(key, node)
    }

    /// The text of a key that may be there.
    pub fn optional(&mut self, key: &'static str) -> Option<Placed> {
        let node = self.get(key)?;
        self.scalar(key, node)
    }

    /// One of a few words, for a key that has to be there.
    pub fn word<T: Copy>(&mut self, key: &'static str, words: &[(T, &'static str)]) -> Option<T> {
        let placed = self.text(key)?;
        self.choose(key, placed, words)
    }

    /// One of a few words, for a key that may be there.
    pub fn optional_word<T: Copy>(&mut self, key: &'static str, words: &[(T, &'static str)]) -> Option<T> {
        let placed = self.optional(key)?;
        self.choose(key, placed, words)
    }

    /// A number in a range, for a key that may be there.
    pub fn optional_number(&mut self, key: &'static str, range: std::ops::RangeInclusive<u64>) -> Option<u64> {
        let (text, at) = self.optional(key)?;
        let parsed = match text.strip_prefix("0x") {
            Some(hex) => u64::from_str_radix(hex, 16).ok(),
            None => text.parse().ok(),
        };
        let value = parsed.filter(|value| range.contains(value));
        if value.is_none() {
            let message = format!("`{key}` has to be a number from {} to {}, not `{text}`", range.start(), range.end());
            self.problems.push(Problem::new(self.source, at, message));
        }
        value
    }

    /// The texts of a list that may be there; a single text counts as a list of one.
    pub fn texts(&mut self, key: &'static str) -> Vec<Placed> {
        let Some(node) = self.get(key) else { return Vec::new() };
        match &node.value {
            Value::Scalar(text) => vec![(text.clone(), node.at.clone())],
            Value::List(items) => items.iter().filter_map(|item| self.scalar(key, item)).collect(),
            _ => {
                self.problems.push(Problem::new(self.source, node.at.clone(), format!("`{key}` has to be a list")));
                Vec::new()
            }
        }
    }

    /// The file being read.
    pub const fn source(&self) -> &'n Arc<Source> {
        self.source
    }

    /// Adds a problem found by the caller.
    pub fn problem(&mut self, at: Range<usize>, message: impl Into<String>) {
        self.problems.push(Problem::new(self.source, at, message));
    }

    /// Keys that nobody asked for are unknown; hands over all problems found.
    pub fn finish(self, problems: &mut Vec<Problem>) {
        problems.extend(self.problems);
        for (key, _) in self.entries {
            if !self.known.contains(&key.text.as_str()) {
                let message = format!("unknown key `{}` in {}", key.text, self.what);
                let help = suggestion(&key.text, self.known.iter().copied());
                problems.push(Problem::new(self.source, key.at.clone(), message).help(help));
            }
        }
    }

    fn scalar(&mut self, key: &str, node: &Node) -> Option<Placed> {
        let text = scalar(node);
        if text.is_none() {
            self.problems.push(Problem::new(self.source, node.at.clone(), format!("`{key}` has to be a single value")));
        }
        text
    }

    fn choose<T: Copy>(&mut self, key: &str, (text, at): Placed, words: &[(T, &'static str)]) -> Option<T> {
        let found = words.iter().find(|(_, word)| *word == text).map(|(value, _)| *value);
        if found.is_none() {
            let help = suggestion(&text, words.iter().map(|(_, word)| *word));
            self.problems.push(Problem::new(self.source, at, format!("`{text}` is no value of `{key}`")).help(help));
        }
        found
    }
}
