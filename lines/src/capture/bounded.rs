//! Bounds on what is read in one piece.

use super::bad;
use crate::RecordingError;
use std::io::{self, BufRead, BufReader, Read, Seek};

/// A line of CSV: far more than a row of any logic analyser.
const LONGEST_LINE: usize = 1 << 16;

/// A stream that ends with an error once an allowance is used up.
pub(super) struct Allowance<R> {
    inner: R,
    left: u64,
}

impl<R> Allowance<R> {
    /// Nothing is allowed yet.
    pub fn new(inner: R) -> Allowance<R> {
        Allowance { inner, left: 0 }
    }

    /// From now on so many octets.
    pub fn allow(&mut self, octets: u64) {
        self.left = octets;
    }
}

impl<R: Read> Read for Allowance<R> {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        if self.left == 0 {
            return Err(io::Error::from(io::ErrorKind::FileTooLarge));
        }
        let most = usize::try_from(self.left).unwrap_or(usize::MAX).min(into.len());
        let count = self.inner.read(&mut into[..most])?;
        self.left -= count as u64;
        Ok(count)
    }
}

impl<R: BufRead> BufRead for Allowance<R> {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        if self.left == 0 {
            return Err(io::Error::from(io::ErrorKind::FileTooLarge));
        }
        let buffer = self.inner.fill_buf()?;
        let most = usize::try_from(self.left).unwrap_or(usize::MAX).min(buffer.len());
        Ok(&buffer[..most])
    }

    fn consume(&mut self, amount: usize) {
        self.left = self.left.saturating_sub(amount as u64);
        self.inner.consume(amount);
    }
}

impl<R: Seek> Seek for Allowance<R> {
    fn seek(&mut self, to: io::SeekFrom) -> io::Result<u64> {
        self.inner.seek(to)
    }
}

/// The lines of a text, one at a time.
pub(super) struct Lines<R> {
    stream: BufReader<R>,
    line: Vec<u8>,
    number: u64,
}

impl<R: Read> Lines<R> {
    pub fn new(stream: R) -> Lines<R> {
        Lines { stream: BufReader::new(stream), line: Vec::new(), number: 0 }
    }

    /// The next line without its end; `None` behind the last one.
    pub fn next(&mut self) -> Result<Option<&str>, RecordingError> {
        self.line.clear();
        self.number += 1;
        let mut stream = (&mut self.stream).take(LONGEST_LINE as u64 + 1);
        let count = stream.read_until(b'\n', &mut self.line).map_err(|error| self.bad(&error.to_string()))?;
        if count == 0 {
            return Ok(None);
        }
        if count > LONGEST_LINE {
            return Err(self.bad(&format!("it is longer than {LONGEST_LINE} octets")));
        }
        match std::str::from_utf8(&self.line) {
            Ok(line) => Ok(Some(line.trim_end_matches(['\n', '\r']))),
            Err(_) => Err(self.bad("it is no text in UTF-8")),
        }
    }

    /// An error in the latest line.
    pub fn bad(&self, what: &str) -> RecordingError {
        bad(format!("line {}: {what}", self.number))
    }
}
