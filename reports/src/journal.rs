//! The journal: `run.jsonl`, one line at a time, flushed, so that nothing recorded is lost when a run ends early.

use crate::record::{CaseRecord, Footer, Header, Line, SCHEMA};
use serde::Serialize;
use std::fs::File;
use std::io::{self, BufRead, BufReader, BufWriter, Read, Write};
use std::path::Path;

/// Name of the journal in its folder.
pub const FILE: &str = "run.jsonl";
/// The longest line that is read, in octets.
const MAX_LINE: u64 = 64 << 20;

/// A [`Line`] that is lent, not owned.
#[derive(Serialize)]
#[serde(rename_all = "kebab-case")]
enum Written<'r> {
    Header(&'r Header),
    Case(&'r CaseRecord),
    Footer(&'r Footer),
}

/// A journal being written.
#[derive(Debug)]
pub struct Journal(BufWriter<File>);

impl Journal {
    /// Begins a journal in a folder, which is made if need be; one that is there already is begun anew.
    ///
    /// # Errors
    /// What the file system says.
    pub fn create(folder: &Path) -> io::Result<Journal> {
        std::fs::create_dir_all(folder)?;
        Ok(Journal(BufWriter::new(File::create(folder.join(FILE))?)))
    }

    /// The first line.
    ///
    /// # Errors
    /// What the file system says.
    pub fn header(&mut self, header: &Header) -> io::Result<()> {
        self.line(&Written::Header(header))
    }

    /// A case that has ended.
    ///
    /// # Errors
    /// What the file system says.
    pub fn case(&mut self, case: &CaseRecord) -> io::Result<()> {
        self.line(&Written::Case(case))
    }

    /// The last line.
    ///
    /// # Errors
    /// What the file system says.
    pub fn footer(&mut self, footer: &Footer) -> io::Result<()> {
        self.line(&Written::Footer(footer))
    }

    fn line(&mut self, line: &Written<'_>) -> io::Result<()> {
        serde_json::to_writer(&mut self.0, line)?;
        self.0.write_all(b"\n")?;
        self.0.flush()
    }
}

/// A record read back.
#[derive(Clone, Debug, PartialEq)]
pub struct Run {
    /// First line.
    pub header: Header,
    /// Cases in the order they ran.
    pub cases: Vec<CaseRecord>,
    /// Last line; `None`: the run did not come to its end.
    pub footer: Option<Footer>,
    /// What was wrong with the last line, when the run was cut off in the middle of writing it.
    pub damaged: Option<String>,
}

/// Why a record cannot be read.
#[derive(Debug, thiserror::Error)]
pub enum ReadError {
    /// What the file system says.
    #[error("{path} cannot be read: {error}")]
    Io {
        /// The file.
        path: String,
        /// Why.
        error: io::Error,
    },
    /// A line that is no line of a record.
    #[error("{path}:{line}: {what}; a record is never edited by hand, take the file as fsct wrote it")]
    Line {
        /// The file.
        path: String,
        /// Line, from 1.
        line: usize,
        /// What is wrong.
        what: String,
    },
    /// Another version of the schema.
    #[error("{path}: schema `{found}` is not known, this fsct reads `{SCHEMA}`; use the version of fsct that wrote it")]
    Schema {
        /// The file.
        path: String,
        /// The schema found.
        found: String,
    },
}

/// Reads the journal of a folder. A last line that was cut off is tolerated and stated.
///
/// # Errors
/// [`ReadError`].
pub fn read(folder: &Path) -> Result<Run, ReadError> {
    let path = folder.join(FILE);
    let name = path.display().to_string();
    let io = |error| ReadError::Io { path: name.clone(), error };
    let wrong = |line, what: String| ReadError::Line { path: name.clone(), line, what };
    let mut reader = BufReader::new(File::open(&path).map_err(io)?);
    let (mut header, mut cases, mut footer, mut damaged) = (None, Vec::new(), None, None);
    let mut octets = Vec::new();
    for number in 1.. {
        octets.clear();
        let length = reader.by_ref().take(MAX_LINE).read_until(b'\n', &mut octets).map_err(io)?;
        if length == 0 {
            break;
        }
        if length as u64 == MAX_LINE {
            return Err(wrong(number, format!("the line is longer than {MAX_LINE} octets")));
        }
        match (serde_json::from_slice(&octets), header.is_some()) {
            (Ok(Line::Header(found)), false) => {
                if found.schema != SCHEMA {
                    return Err(ReadError::Schema { path: name, found: found.schema });
                }
                header = Some(*found);
            }
            (Ok(Line::Case(case)), true) if footer.is_none() => cases.push(*case),
            (Ok(Line::Footer(found)), true) if footer.is_none() => footer = Some(found),
            (Ok(_), _) => return Err(wrong(number, "the line is not where it belongs".to_owned())),
            (Err(error), true) if octets.last() != Some(&b'\n') => {
                damaged = Some(format!("line {number} was cut off after {length} octets ({error})"));
                break;
            }
            (Err(error), _) => return Err(wrong(number, format!("the line is no line of a record ({error})"))),
        }
    }
    let header = header.ok_or_else(|| wrong(1, "the first line is missing".to_owned()))?;
    Ok(Run { header, cases, footer, damaged })
}
