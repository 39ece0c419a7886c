//! The journal: `run.jsonl`, one line at a time, flushed, so that nothing recorded is lost when a run ends early.

use crate::record::{CaseRecord, Footer, Header, Line, SCHEMA};
use serde::{Deserialize, Serialize};
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
    #[error(
        "{path}: the record has schema `{found}`, this fsct reads `{SCHEMA}`; use the version of fsct that wrote it"
    )]
    Schema {
        /// The file.
        path: String,
        /// The schema found.
        found: String,
    },
}

/// A journal being read, case by case: an iterator over the cases in the order they ran, flat in memory however long the
/// run was. Footer and damage are known once it has come to its end.
#[derive(Debug)]
pub struct Reader {
    lines: Lines,
    header: Header,
    footer: Option<Footer>,
    damaged: Option<String>,
    ended: bool,
}

impl Reader {
    /// Opens the journal of a folder and reads its header.
    ///
    /// # Errors
    /// [`ReadError`] when there is no file, or its first line is no header of this schema.
    pub fn open(folder: &Path) -> Result<Reader, ReadError> {
        Reader::open_file(&folder.join(FILE))
    }

    /// Opens a journal by its own name and reads its header.
    ///
    /// # Errors
    /// As [`Reader::open`].
    pub fn open_file(file: &Path) -> Result<Reader, ReadError> {
        let mut lines = Lines::open(file)?;
        if !lines.advance()? {
            return Err(lines.wrong("the first line is missing".to_owned()));
        }
        // The schema comes first: a header of another version need not have the fields of this one.
        if let Ok(Stated { header: Schema { schema } }) = serde_json::from_slice(&lines.octets)
            && schema != SCHEMA
        {
            return Err(ReadError::Schema { path: lines.path, found: schema });
        }
        match lines.parsed()? {
            Line::Header(header) => Ok(Reader { lines, header: *header, footer: None, damaged: None, ended: false }),
            _ => Err(lines.misplaced()),
        }
    }

    /// The first line.
    pub const fn header(&self) -> &Header {
        &self.header
    }

    /// The last line; `None` before the end, and when the run did not come to its end.
    pub const fn footer(&self) -> Option<&Footer> {
        self.footer.as_ref()
    }

    /// What is wrong with the last line, when it was cut off.
    pub fn damaged(&self) -> Option<&str> {
        self.damaged.as_deref()
    }

    /// The next case; `None` at the end, cut off or not.
    fn case(&mut self) -> Result<Option<CaseRecord>, ReadError> {
        while self.lines.advance()? {
            match self.lines.parsed() {
                Ok(Line::Case(case)) if self.footer.is_none() => return Ok(Some(*case)),
                Ok(Line::Footer(footer)) if self.footer.is_none() => self.footer = Some(footer),
                Ok(_) => return Err(self.lines.misplaced()),
                Err(error) if self.lines.is_whole() => return Err(error),
                Err(_) => {
                    let (number, length) = (self.lines.number, self.lines.octets.len());
                    self.damaged = Some(format!("line {number} was cut off after {length} octets"));
                }
            }
        }
        Ok(None)
    }
}

impl Iterator for Reader {
    type Item = Result<CaseRecord, ReadError>;

    /// The next case. After an error or the end there is nothing more.
    fn next(&mut self) -> Option<Self::Item> {
        if self.ended {
            return None;
        }
        let next = self.case().transpose();
        self.ended = !matches!(next, Some(Ok(_)));
        next
    }
}

/// The lines of a journal, one at a time.
#[derive(Debug)]
struct Lines {
    file: BufReader<File>,
    path: String,
    /// Number of the line read last, from 1.
    number: usize,
    /// That line, with its end if it has one.
    octets: Vec<u8>,
}

impl Lines {
    fn open(file: &Path) -> Result<Lines, ReadError> {
        let path = file.display().to_string();
        match File::open(file) {
            Ok(file) => Ok(Lines { file: BufReader::new(file), path, number: 0, octets: Vec::new() }),
            Err(error) => Err(ReadError::Io { path, error }),
        }
    }

    /// Reads the next line; `false` at the end of the file.
    fn advance(&mut self) -> Result<bool, ReadError> {
        self.octets.clear();
        self.number += 1;
        let read = self.file.by_ref().take(MAX_LINE).read_until(b'\n', &mut self.octets);
        read.map_err(|error| ReadError::Io { path: self.path.clone(), error })?;
        if self.octets.len() as u64 == MAX_LINE && !self.is_whole() {
            return Err(self.wrong(format!("the line is longer than {MAX_LINE} octets")));
        }
        Ok(!self.octets.is_empty())
    }

    fn is_whole(&self) -> bool {
        self.octets.last() == Some(&b'\n')
    }

    fn parsed(&self) -> Result<Line, ReadError> {
        serde_json::from_slice(&self.octets)
            .map_err(|error| self.wrong(format!("the line is no line of a record ({error})")))
    }

    fn misplaced(&self) -> ReadError {
        self.wrong("the line is not where it belongs: a header first, then cases, a footer last".to_owned())
    }

    fn wrong(&self, what: String) -> ReadError {
        ReadError::Line { path: self.path.clone(), line: self.number, what }
    }
}

/// As much of a first line as every version of the schema has.
#[derive(Deserialize)]
struct Stated {
    header: Schema,
}

/// See [`Stated`].
#[derive(Deserialize)]
struct Schema {
    schema: String,
}

/// Reads the journal of a folder as a whole. A last line that was cut off is tolerated and stated.
///
/// # Errors
/// [`ReadError`].
pub fn read(folder: &Path) -> Result<Run, ReadError> {
    let mut reader = Reader::open(folder)?;
    let cases = reader.by_ref().collect::<Result<_, _>>()?;
    Ok(Run { header: reader.header, cases, footer: reader.footer, damaged: reader.damaged })
}
