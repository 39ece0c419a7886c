//! From octets to an XML tree, within bounds: what a parser may cost is decided before it starts.

use fsct_protocol::Edition;
use roxmltree::{Document, ParsingOptions};
use std::fs::File;
use std::io::{ErrorKind, Read as _};
use std::path::Path;

/// The largest file that is read, in octets. IODDs are tens of kilobytes, large ones one or two megabytes.
pub const MOST_OCTETS: u64 = 16 << 20;
/// Nesting of elements; an IODD needs eleven levels.
const DEEPEST: usize = 64;
/// Attributes of one element; the parser compares each with all before it.
const MOST_ATTRIBUTES: usize = 64;
/// Namespace declarations of a file; the parser copies those of the parents.
const MOST_NAMESPACES: usize = 64;

/// Why a file cannot be judged.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Unreadable {
    /// The file system refuses.
    #[error("it cannot be read: {0}")]
    Io(String),
    /// A folder, a pipe or a device.
    #[error("it is no file; give the XML file of the IODD")]
    NoFile,
    /// Larger than [`MOST_OCTETS`].
    #[error("it has more than {} octets; an IODD is far smaller, is this the right file?", MOST_OCTETS)]
    TooLarge,
    /// An encoding the IODD schema does not know.
    #[error("it is encoded in {0}; an IODD is encoded in UTF-8, save it so")]
    Encoding(String),
    /// Octets that are no UTF-8.
    #[error("line {line}: octets that are no UTF-8; an IODD is encoded in UTF-8, save it so")]
    NotUtf8 {
        /// Where, from 1.
        line: usize,
    },
    /// A document type declaration, and with it entities.
    #[error(
        "line {line}: a document type declaration (DOCTYPE); an IODD has none, and entities are not followed: remove it"
    )]
    DocumentType {
        /// Where, from 1.
        line: usize,
    },
    /// Nested, or furnished with attributes or namespaces, beyond any IODD.
    #[error("line {line}: {what}; no IODD needs that")]
    Bounds {
        /// Where, from 1.
        line: usize,
        /// What there is too much of.
        what: &'static str,
    },
    /// No well-formed XML.
    #[error("{0}: an IODD is well-formed XML")]
    Xml(String),
    /// XML, but another document.
    #[error("its root element is `{0}`, not `IODevice`: this is no IODD; the language files of an IODD are not judged")]
    NoIodd(String),
    /// Nothing in it tells the edition.
    #[error(
        "nothing in it tells its edition (V_FSP_ParamDescCRC at Index 16914 has neither 16 nor 32 bit); give --edition v1.1 or iec2022"
    )]
    NoEdition,
    /// Its parts are of different editions.
    #[error("it is of two editions at once: {first}, but {second}; give --edition v1.1 or iec2022")]
    TwoEditions {
        /// What speaks for v1.1.
        first: String,
        /// What speaks for iec2022.
        second: String,
    },
}

impl Unreadable {
    /// Two sets of evidence against each other.
    pub(crate) fn two_editions(v1_1: &[String], iec2022: &[String]) -> Unreadable {
        let speak = |edition: Edition, facts: &[String]| format!("{} ({edition})", facts.join(", "));
        Unreadable::TwoEditions { first: speak(Edition::V1_1, v1_1), second: speak(Edition::Iec2022, iec2022) }
    }
}

/// The octets of a file, never more than [`MOST_OCTETS`] in memory.
///
/// # Errors
/// [`Unreadable::Io`], [`Unreadable::NoFile`], [`Unreadable::TooLarge`].
pub fn octets_of(path: &Path) -> Result<Vec<u8>, Unreadable> {
    let io = |error: std::io::Error| match error.kind() {
        ErrorKind::NotFound => Unreadable::Io("there is no such file".to_owned()),
        _ => Unreadable::Io(error.to_string()),
    };
    // Asked before it is opened: opening a pipe nobody writes to would wait for ever.
    let about = std::fs::metadata(path).map_err(io)?;
    if !about.is_file() {
        return Err(Unreadable::NoFile);
    }
    if about.len() > MOST_OCTETS {
        return Err(Unreadable::TooLarge);
    }
    let mut octets = Vec::new();
    File::open(path).map_err(io)?.take(MOST_OCTETS + 1).read_to_end(&mut octets).map_err(io)?;
    if octets.len() as u64 > MOST_OCTETS { Err(Unreadable::TooLarge) } else { Ok(octets) }
}

/// The text of a file in UTF-8, with or without its mark.
pub(crate) fn decode(octets: &[u8]) -> Result<&str, Unreadable> {
    if octets.len() as u64 > MOST_OCTETS {
        return Err(Unreadable::TooLarge);
    }
    if octets.starts_with(&[0xFF, 0xFE])
        || octets.starts_with(&[0xFE, 0xFF])
        || octets.iter().take(4).any(|&octet| octet == 0)
    {
        return Err(Unreadable::Encoding("UTF-16 or UTF-32".to_owned()));
    }
    if let Some(name) = declared(octets).filter(|name| !name.eq_ignore_ascii_case("utf-8")) {
        return Err(Unreadable::Encoding(name));
    }
    let text =
        std::str::from_utf8(octets).map_err(|error| Unreadable::NotUtf8 { line: line(octets, error.valid_up_to()) })?;
    Ok(text.strip_prefix('\u{FEFF}').unwrap_or(text))
}

/// The encoding an XML declaration names.
fn declared(octets: &[u8]) -> Option<String> {
    let octets = octets.strip_prefix(&[0xEF, 0xBB, 0xBF]).unwrap_or(octets);
    let head = octets.strip_prefix(b"<?xml")?;
    let head = String::from_utf8_lossy(head.get(..head.len().min(200))?).into_owned();
    let (head, _) = head.split_once("?>")?;
    let (_, value) = head.split_once("encoding")?;
    let value = value.trim_start().strip_prefix('=')?.trim_start();
    let quote = value.chars().next().filter(|quote| ['"', '\''].contains(quote))?;
    value.get(1..)?.split(quote).next().map(str::to_owned)
}

/// The tree of a text that keeps the bounds.
pub(crate) fn parse(text: &str) -> Result<Document<'_>, Unreadable> {
    bounds(text)?;
    let options = ParsingOptions { allow_dtd: false, nodes_limit: 2_000_000, ..ParsingOptions::default() };
    Document::parse_with_options(text, options).map_err(|error| match error {
        roxmltree::Error::DtdDetected => Unreadable::DocumentType { line: 1 },
        error => Unreadable::Xml(error.to_string()),
    })
}

/// The bounds of nesting, attributes and namespaces. Looks at no more of XML than it takes to find the tags: whether they are well-formed,
/// the parser says.
fn bounds(text: &str) -> Result<(), Unreadable> {
    let too_much = |at: usize, what| Err(Unreadable::Bounds { line: line(text.as_bytes(), at), what });
    if let Some((at, _)) = text.match_indices("xmlns").nth(MOST_NAMESPACES) {
        return too_much(at, "more than 64 namespace declarations");
    }
    let mut depth = 0_usize;
    let mut at = 0;
    while let Some(tag) = text.get(at..).and_then(|rest| rest.find('<')).map(|found| at + found) {
        let rest = text.get(tag..).unwrap_or_default();
        let skip =
            [("<!--", "-->"), ("<![CDATA[", "]]>"), ("<?", "?>")].into_iter().find(|(open, _)| rest.starts_with(open));
        let length = if let Some((open, close)) = skip {
            match rest.get(open.len()..).and_then(|inner| inner.find(close)) {
                Some(found) => open.len() + found + close.len(),
                None => rest.len(),
            }
        } else if rest.starts_with("<!") {
            return Err(Unreadable::DocumentType { line: line(text.as_bytes(), tag) });
        } else {
            let (length, values) = tag_of(rest);
            if values > MOST_ATTRIBUTES {
                return too_much(tag, "an element with more than 64 attributes");
            }
            if rest.starts_with("</") {
                depth = depth.saturating_sub(1);
            } else if !rest.get(..length).is_some_and(|tag| tag.ends_with("/>")) {
                depth += 1;
            }
            if depth > DEEPEST {
                return too_much(tag, "elements nested more than 64 deep");
            }
            length
        };
        at = tag + length;
    }
    Ok(())
}

/// The length of the tag a text begins with, and how many quoted values it has.
fn tag_of(text: &str) -> (usize, usize) {
    let (mut quote, mut values) = (None, 0);
    for (at, octet) in text.bytes().enumerate() {
        match (quote, octet) {
            (None, b'>') => return (at + 1, values),
            (None, b'"' | b'\'') => (quote, values) = (Some(octet), values + 1),
            (Some(open), octet) if open == octet => quote = None,
            _ => {}
        }
    }
    (text.len(), values)
}

/// The line of an octet, from 1.
fn line(octets: &[u8], at: usize) -> usize {
    1 + octets.iter().take(at).filter(|&&octet| octet == b'\n').count()
}

/// Where the lines of a text begin.
pub(crate) struct Lines<'a> {
    text: &'a str,
    starts: Vec<usize>,
}

impl<'a> Lines<'a> {
    pub(crate) fn of(text: &'a str) -> Lines<'a> {
        let starts = std::iter::once(0).chain(text.match_indices('\n').map(|(at, _)| at + 1)).collect();
        Lines { text, starts }
    }

    /// Line and column, both from 1, the column in characters.
    pub(crate) fn place(&self, at: usize) -> (usize, usize) {
        let line = self.starts.partition_point(|&start| start <= at);
        let start = line.checked_sub(1).and_then(|line| self.starts.get(line)).copied().unwrap_or(0);
        (line, 1 + self.text.get(start..at).map_or(0, |before| before.chars().count()))
    }
}
