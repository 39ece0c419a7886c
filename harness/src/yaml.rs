//! YAML as a tree in which every key and value knows its place in the file. The one room that knows the YAML library.
//!
//! Input is hostile: size, depth, nodes and aliases are bounded before anything is built.

use crate::problem::{Problem, Source};
use serde::de::{Deserialize, Deserializer, MapAccess, SeqAccess, Visitor};
use serde_saphyr::Spanned;
use std::fmt;
use std::ops::Range;
use std::path::Path;
use std::sync::Arc;

/// The largest file that is read at all, in octets.
pub const MAX_FILE: u64 = 4 << 20;
const MAX_NODES: usize = 400_000;
const MAX_DEPTH: usize = 64;

/// A value and where it stands.
#[derive(Clone, Debug)]
pub struct Node {
    /// Octets of the file it covers; empty at its first octet for lists and maps.
    pub at: Range<usize>,
    /// The value.
    pub value: Value,
}

/// A YAML value. Scalars keep the text of the file: `0012` is not 12.
#[derive(Clone, Debug)]
pub enum Value {
    /// Text, number or truth value, as written.
    Scalar(String),
    /// List.
    List(Vec<Node>),
    /// Map, in the order of the file; keys occur once.
    Map(Vec<(Key, Node)>),
    /// Nothing, or `~`.
    Null,
}

/// A key of a map and where it stands.
#[derive(Clone, Debug)]
pub struct Key {
    /// Octets of the file it covers.
    pub at: Range<usize>,
    /// Its text.
    pub text: String,
}

/// Reads a file for [`parse`].
///
/// # Errors
/// A [`Problem`] when the file cannot be read, is longer than [`MAX_FILE`] or not UTF-8.
pub fn load(path: &Path) -> Result<Arc<Source>, Problem> {
    let name = path.display().to_string();
    let failed = |why: String| Problem::without_place(&name, why);
    let size = std::fs::metadata(path).map_err(|error| failed(format!("cannot be read: {error}")))?.len();
    if size > MAX_FILE {
        return Err(failed(format!("has {size} octets; fsct reads YAML files of at most {MAX_FILE}, split it")));
    }
    let octets = std::fs::read(path).map_err(|error| failed(format!("cannot be read: {error}")))?;
    let text = String::from_utf8(octets)
        .map_err(|error| failed(format!("is not UTF-8 at octet {}", error.utf8_error().valid_up_to())))?;
    Ok(Arc::new(Source { name, text }))
}

/// Builds the tree of one document.
///
/// # Errors
/// A [`Problem`] at the place where the text is no YAML, repeats a key or exceeds a bound.
pub fn parse(source: &Arc<Source>) -> Result<Node, Problem> {
    let budget = serde_saphyr::budget! {
        max_nodes: MAX_NODES,
        max_events: 3 * MAX_NODES,
        max_depth: MAX_DEPTH,
        max_aliases: 1_000,
        max_total_scalar_bytes: MAX_FILE as usize,
        max_documents: 1,
    };
    let options = serde_saphyr::options! { budget: budget, strict_booleans: true };
    let raw: Spanned<Raw> = serde_saphyr::from_str_with_options(&source.text, options).map_err(|error| {
        let place = error.location().and_then(|place| {
            let span = place.span();
            let exact = span.byte_offset().zip(span.byte_len());
            let exact = exact.map(|(start, length)| start as usize..(start + length) as usize);
            exact.or_else(|| octet(&source.text, place.line(), place.column()).map(|at| at..at))
        });
        let text = error.without_snippet().to_string();
        let text = text.rsplit_once(" at line ").map_or(text.as_str(), |(text, _)| text);
        let text = text.split(", set DuplicateKeyPolicy").next().unwrap_or(text);
        let text = match text {
            "recursion limit exceeded" => "is nested too deeply",
            other => other,
        };
        match place {
            Some(at) => Problem::new(source, at, text),
            None => Problem::without_place(&source.name, text.to_owned()),
        }
    })?;
    Ok(place(raw, &source.text))
}

/// The octet at a line and column, both from 1.
fn octet(text: &str, line: u64, column: u64) -> Option<usize> {
    let (line, column) = (usize::try_from(line).ok()?.checked_sub(1)?, usize::try_from(column).ok()?.checked_sub(1)?);
    let start: usize = text.split_inclusive('\n').take(line).map(str::len).sum();
    let rest = text.get(start..)?;
    Some(start + rest.char_indices().nth(column).map_or(rest.len(), |(at, _)| at))
}

fn place(raw: Spanned<Raw>, text: &str) -> Node {
    let at = range(&raw.referenced);
    let value = match raw.value {
        Raw::Text(text) => Value::Scalar(text),
        // Numbers and truth values: the text of the file, not what a parser made of it.
        Raw::Literal(parsed) => Value::Scalar(text.get(range(&raw.defined)).map_or(parsed, str::to_owned)),
        Raw::Null => Value::Null,
        Raw::List(items) => Value::List(items.into_iter().map(|item| place(item, text)).collect()),
        Raw::Map(entries) => Value::Map(
            entries
                .into_iter()
                .map(|(key, value)| (Key { at: range(&key.referenced), text: key.value }, place(value, text)))
                .collect(),
        ),
    };
    Node { at, value }
}

fn range(place: &serde_saphyr::Location) -> Range<usize> {
    let start = place.span().byte_offset().unwrap_or(0) as usize;
    start..start + place.span().byte_len().unwrap_or(0) as usize
}

enum Raw {
    Text(String),
    Literal(String),
    List(Vec<Spanned<Raw>>),
    Map(Vec<(Spanned<String>, Spanned<Raw>)>),
    Null,
}

impl<'de> Deserialize<'de> for Raw {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(AnyValue)
    }
}

struct AnyValue;

impl<'de> Visitor<'de> for AnyValue {
    type Value = Raw;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a value")
    }

    fn visit_str<E>(self, text: &str) -> Result<Raw, E> {
        Ok(Raw::Text(text.to_owned()))
    }

    fn visit_bool<E>(self, value: bool) -> Result<Raw, E> {
        Ok(Raw::Literal(value.to_string()))
    }

    fn visit_i64<E>(self, value: i64) -> Result<Raw, E> {
        Ok(Raw::Literal(value.to_string()))
    }

    fn visit_u64<E>(self, value: u64) -> Result<Raw, E> {
        Ok(Raw::Literal(value.to_string()))
    }

    fn visit_i128<E>(self, value: i128) -> Result<Raw, E> {
        Ok(Raw::Literal(value.to_string()))
    }

    fn visit_u128<E>(self, value: u128) -> Result<Raw, E> {
        Ok(Raw::Literal(value.to_string()))
    }

    fn visit_f64<E>(self, value: f64) -> Result<Raw, E> {
        Ok(Raw::Literal(value.to_string()))
    }

    fn visit_unit<E>(self) -> Result<Raw, E> {
        Ok(Raw::Null)
    }

    fn visit_none<E>(self) -> Result<Raw, E> {
        Ok(Raw::Null)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut items: A) -> Result<Raw, A::Error> {
        let mut list = Vec::new();
        while let Some(item) = items.next_element()? {
            list.push(item);
        }
        Ok(Raw::List(list))
    }

    fn visit_map<A: MapAccess<'de>>(self, mut entries: A) -> Result<Raw, A::Error> {
        let mut map = Vec::new();
        while let Some(entry) = entries.next_entry()? {
            map.push(entry);
        }
        Ok(Raw::Map(map))
    }
}

/// The tree on one line, as YAML in flow style: `exchange: {corrupt: 17}`.
pub fn flow(node: &Node) -> String {
    match &node.value {
        Value::Map(entries) => join(entries, ", "),
        _ => inline(node),
    }
}

fn inline(node: &Node) -> String {
    match &node.value {
        Value::Scalar(text) => text.clone(),
        Value::Null => "{}".to_owned(),
        Value::List(items) => format!("[{}]", items.iter().map(inline).collect::<Vec<_>>().join(", ")),
        Value::Map(entries) => format!("{{{}}}", join(entries, ", ")),
    }
}

fn join(entries: &[(Key, Node)], between: &str) -> String {
    let pairs: Vec<String> = entries.iter().map(|(key, node)| format!("{}: {}", key.text, inline(node))).collect();
    pairs.join(between)
}
