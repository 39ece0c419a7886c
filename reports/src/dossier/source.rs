//! The files a dossier is made from: found, read, and named by their hash. Nothing is judged here.

use super::document::{PROOF, Proof, RESIDUAL, Residual};
use crate::campaign::{self, BITS, Bits, NOISE, Noise, RANDOM, RECORDS, Random, Records};
use crate::gauntlet::{self, Gauntlet};
use crate::journal::{self, ReadError, Reader};
use crate::record::{CaseRecord, Execution, Header, SCHEMA, Verdict};
use serde::de::DeserializeOwned;
use serde_json::Value;
use sha2::{Digest, Sha256};
use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};

/// The largest document that is read beside journals, in octets.
const MAX_DOCUMENT: u64 = 64 << 20;

/// Files that are looked for in a folder, with the command that leaves each.
pub const KNOWN: [(&str, &str); 5] = [
    (journal::FILE, "fsct run --dut URL --out DIR"),
    (campaign::FILE, "fsct campaign random --dut URL --out DIR"),
    (gauntlet::FILE, "fsct gauntlet --out DIR"),
    ("prove.json", "fsct prove --json > DIR/prove.json"),
    ("residual.json", "fsct crc --residual --json > DIR/residual.json"),
];

/// A file and what it holds.
#[derive(Clone, Debug)]
pub struct Source {
    /// As it was found.
    pub path: PathBuf,
    /// SHA-256 of its octets, in hexadecimal.
    pub sha256: String,
    /// Version of fsct that wrote it.
    pub fsct: String,
    /// Seed, where chance had a part in it.
    pub seed: Option<u64>,
    /// What it holds.
    pub piece: Piece,
}

/// What a record holds. A new kind of record gets a variant here, its schema where documents are read, and the chapter that shows it.
#[derive(Clone, Debug)]
pub enum Piece {
    /// `fsct run` or `fsct capture`.
    Run(Box<Recorded>),
    /// `fsct campaign bits`.
    Bits(Bits),
    /// `fsct campaign random`.
    Random(Random),
    /// `fsct campaign record`.
    Records(Records),
    /// `fsct campaign noise`.
    Noise(Noise),
    /// `fsct gauntlet`.
    Gauntlet(Gauntlet),
    /// `fsct prove --json`.
    Proof(Vec<Proof>),
    /// `fsct crc --residual --json`.
    Residual(Residual),
}

/// A run as far as a dossier needs it: no traces, and steps of cases that need a reader alone.
#[derive(Clone, Debug)]
pub struct Recorded {
    /// First line.
    pub header: Header,
    /// Cases in the order they ran.
    pub cases: Vec<CaseRecord>,
    /// Why it is not whole; empty: it is.
    pub partial: String,
}

/// Why a file cannot be part of a dossier.
#[derive(Debug, thiserror::Error)]
pub enum SourceError {
    /// What the file system says.
    #[error("{path} cannot be read: {error}; give the folder or the file that fsct wrote")]
    Io {
        /// The file.
        path: String,
        /// Why.
        error: io::Error,
    },
    /// A journal that cannot be read.
    #[error(transparent)]
    Journal(#[from] ReadError),
    /// Nothing in a folder.
    #[error("{path} holds no record ({}); the first one is made by `fsct run --dut URL --out {path}`", names())]
    Empty {
        /// The folder.
        path: String,
    },
    /// A file that is none.
    #[error("{path}: {what}; make it again with `{command}`")]
    Document {
        /// The file.
        path: String,
        /// What is wrong.
        what: String,
        /// What makes a sound one.
        command: &'static str,
    },
}

fn names() -> String {
    KNOWN.map(|(name, _)| name).join(", ")
}

/// Reads every record of these files and folders. One that is given twice, or a copy of one, counts once.
///
/// # Errors
/// [`SourceError`] of the first that is missing or damaged.
pub fn read(paths: &[PathBuf]) -> Result<Vec<Source>, SourceError> {
    let mut sources: Vec<Source> = Vec::new();
    for path in paths {
        let files = if path.is_dir() { known(path) } else { vec![path.clone()] };
        if files.is_empty() {
            return Err(SourceError::Empty { path: path.display().to_string() });
        }
        for file in files {
            let sha256 = hash(&file)?;
            if sources.iter().all(|source| source.sha256 != sha256) {
                sources.push(Source::read(&file, sha256)?);
            }
        }
    }
    Ok(sources)
}

fn known(folder: &Path) -> Vec<PathBuf> {
    KNOWN.iter().map(|(name, _)| folder.join(name)).filter(|file| file.exists()).collect()
}

impl Source {
    fn read(path: &Path, sha256: String) -> Result<Source, SourceError> {
        // A document ends like its kind; everything else is held to be a journal, whose reader says what is wrong.
        if path.extension().is_some_and(|ending| ending == "json") {
            return document(path, sha256);
        }
        let recorded = recorded(path)?;
        let (fsct, seed) = (recorded.header.fsct.clone(), Some(recorded.header.seed));
        Ok(Source { path: path.to_owned(), sha256, fsct, seed, piece: Piece::Run(Box::new(recorded)) })
    }

    /// Schema of what it holds.
    pub const fn schema(&self) -> &'static str {
        match self.piece {
            Piece::Run(_) => SCHEMA,
            Piece::Bits(_) => BITS,
            Piece::Random(_) => RANDOM,
            Piece::Records(_) => RECORDS,
            Piece::Noise(_) => NOISE,
            Piece::Gauntlet(_) => gauntlet::SCHEMA,
            Piece::Proof(_) => PROOF,
            Piece::Residual(_) => RESIDUAL,
        }
    }
}

fn hash(path: &Path) -> Result<String, SourceError> {
    let failed = |error| SourceError::Io { path: path.display().to_string(), error };
    let mut file = File::open(path).map_err(failed)?;
    let mut hash = Sha256::new();
    let mut octets = vec![0; 64 << 10];
    loop {
        match file.read(&mut octets).map_err(failed)? {
            0 => break,
            read => hash.update(octets.get(..read).unwrap_or_default()),
        }
    }
    Ok(hash.finalize().iter().map(|octet| format!("{octet:02x}")).collect())
}

fn recorded(path: &Path) -> Result<Recorded, SourceError> {
    let mut reader = Reader::open_file(path)?;
    let cases: Vec<CaseRecord> = reader.by_ref().map(|case| case.map(slim)).collect::<Result<_, _>>()?;
    let partial = match (reader.damaged(), reader.footer()) {
        (Some(damage), _) => damage.to_owned(),
        (None, None) => "the run did not come to its end".to_owned(),
        (None, Some(footer)) if footer.interrupted => "the run was stopped by the user".to_owned(),
        (None, Some(_)) if cases.len() < reader.header().planned => {
            format!("{} of {} cases are in it", cases.len(), reader.header().planned)
        }
        (None, Some(_)) => String::new(),
    };
    Ok(Recorded { header: reader.header().clone(), cases, partial })
}

/// A case without what a dossier does not show. Whether there was a trace at all tells an aborted case from one never begun.
fn slim(mut case: CaseRecord) -> CaseRecord {
    case.trace.truncate(1);
    if case.execution == Execution::Ok && case.verdict <= Verdict::Pass {
        case.steps = Vec::new();
    }
    case.steps.iter_mut().for_each(|step| step.checks = Vec::new());
    case
}

fn document(path: &Path, sha256: String) -> Result<Source, SourceError> {
    let failed = |error| SourceError::Io { path: path.display().to_string(), error };
    let mut text = String::new();
    File::open(path).and_then(|file| file.take(MAX_DOCUMENT).read_to_string(&mut text)).map_err(failed)?;
    let wrong = |what: String| SourceError::Document { path: path.display().to_string(), what, command: made_by(path) };
    let value: Value =
        serde_json::from_str(&text).map_err(|error| wrong(format!("it is no whole JSON document ({error})")))?;
    let first = value.get(0).unwrap_or(&value);
    let schema = first.get("schema").and_then(Value::as_str).unwrap_or_default().to_owned();
    let read = match schema.as_str() {
        BITS => as_is(value).map(Piece::Bits),
        RANDOM => as_is(value).map(Piece::Random),
        RECORDS => as_is(value).map(Piece::Records),
        NOISE => as_is(value).map(Piece::Noise),
        gauntlet::SCHEMA => as_is(value).map(Piece::Gauntlet),
        PROOF => as_is(value).map(Piece::Proof),
        RESIDUAL => as_is(value).map(Piece::Residual),
        "" => return Err(wrong("it states no schema, so it is no record of this fsct".to_owned())),
        other => return Err(wrong(format!("this fsct reads no record of the schema `{other}`"))),
    };
    let piece = read.map_err(|error| wrong(format!("it is no sound record of the schema `{schema}` ({error})")))?;
    let (fsct, seed) = match &piece {
        Piece::Bits(Bits { head, .. })
        | Piece::Random(Random { head, .. })
        | Piece::Records(Records { head, .. })
        | Piece::Noise(Noise { head, .. }) => (head.fsct.clone(), Some(head.seed)),
        Piece::Gauntlet(gauntlet) => (gauntlet.fsct.clone(), None),
        Piece::Proof(proofs) => (proofs.first().map_or_else(String::new, |proof| proof.fsct.clone()), None),
        Piece::Residual(residual) => (residual.fsct.clone(), None),
        Piece::Run(_) => (String::new(), None),
    };
    Ok(Source { path: path.to_owned(), sha256, fsct, seed, piece })
}

fn as_is<T: DeserializeOwned>(value: Value) -> serde_json::Result<T> {
    serde_json::from_value(value)
}

/// The command that makes a file of this name.
fn made_by(path: &Path) -> &'static str {
    let name = path.file_name().and_then(|name| name.to_str()).unwrap_or_default();
    KNOWN.iter().find(|(known, _)| *known == name).map_or(KNOWN[0].1, |(_, command)| command)
}
