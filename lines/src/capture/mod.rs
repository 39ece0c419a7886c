//! Files of logic analysers as [`Recording`]s.
//!
//! | Format | What it states about time | Uncertainty of an edge |
//! |---|---|---|
//! | VCD | tick (`$timescale`); libsigrok adds its sample rate in a comment, [`VcdWriter`](crate::VcdWriter) its uncertainty | the tick; with a rate, the sample period |
//! | sigrok session (`.sr`) | sample rate | the sample period |
//! | sigrok CSV | sample rate, in a comment | the sample period |
//! | Saleae CSV (Logic 1 and 2) | nothing but the printed times | the last printed digit; with a rate given by the user, the sample period besides |
//!
//! What a file is, is seen from its content; its name counts for nothing. A file is read as a stream: what is kept of it does
//! not grow with it.
//!
//! **Time 0** of a recording is the first moment at which every line is known; [`Capture::stated`] tells where in the file
//! that is when the file counts otherwise.
//!
//! **Unknown levels** (`x` and `z` of VCD) are no levels: before the first moment they are waited out, later they end the
//! recording with an error, for a judgement must not rest on them.

mod bounded;
mod channels;
mod csv;
mod resolution;
mod sigrok;
mod vcd;

use crate::{Edge, Levels, Recording, RecordingError, WakeUps};
pub use channels::Channels;
use fsct_adapters::Line;
pub use resolution::{Resolution, SampleRate, StatedBy};
use std::collections::VecDeque;
use std::fmt;
use std::fs::File;
use std::io::{Cursor, Read, Seek};
use std::path::Path;

/// How much of a file is looked at before it is read: what it is, and how CSV prints its times.
const HEAD: u64 = 1 << 16;

/// What a user says about a file.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Options {
    /// Which channel is which line.
    pub channels: Channels,
    /// The rate the lines were sampled at, for files that do not state it.
    pub sample_rate: Option<SampleRate>,
}

/// What a file is.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Format {
    /// Value change dump.
    Vcd,
    /// Session of sigrok, `.sr`.
    Sigrok,
    /// CSV as `sigrok-cli -O csv` writes it: a row a sample.
    SigrokCsv,
    /// CSV as Saleae Logic exports it: a row a change.
    SaleaeCsv,
}

impl fmt::Display for Format {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Format::Vcd => "VCD",
            Format::Sigrok => "sigrok session",
            Format::SigrokCsv => "CSV of sigrok",
            Format::SaleaeCsv => "CSV of Saleae Logic",
        })
    }
}

/// A file of a logic analyser.
pub struct Capture {
    /// The name of the file in errors.
    name: Option<String>,
    about: About,
    source: Box<dyn Source>,
    first: Levels,
    now: Levels,
    edges: VecDeque<Edge>,
    end: u64,
    outcome: Option<Result<(), RecordingError>>,
}

impl fmt::Debug for Capture {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Capture").field("name", &self.name).field("about", &self.about).finish_non_exhaustive()
    }
}

/// What is known of a file once its beginning is read.
#[derive(Clone, Debug)]
struct About {
    format: Format,
    resolution: Resolution,
    /// The names of the channels that are L+, C/Q and I/Q.
    channels: [Option<String>; 3],
    /// Time 0 of the recording on the clock of the file, in femtoseconds.
    origin_fs: i128,
    /// How wake-ups show.
    wake_ups: WakeUps,
}

/// How the lines are at a moment.
#[derive(Copy, Clone, Debug)]
struct Step {
    /// In nanoseconds since the first step.
    at: u64,
    levels: Levels,
    /// A wake-up, which is no level.
    wake_up: bool,
}

/// A file as it is read. The first step gives the levels at the beginning, at time 0.
trait Source: Send {
    /// The next moment of the file, whether a line changes or not; `None` at the end.
    fn step(&mut self) -> Result<Option<Step>, RecordingError>;
}

/// The lines that have levels, as [`Levels`] and mappings list them.
const LINES: [Line; 3] = [Line::Power, Line::Cq, Line::Iq];

/// A file of a logic analyser.
///
/// # Errors
/// [`RecordingError`] when it cannot be read, is none, is damaged at its beginning, or lacks a channel or a rate.
pub fn open(path: &Path, options: &Options) -> Result<Capture, RecordingError> {
    let name = path.display().to_string();
    let opened = File::open(path).map_err(|error| bad(error.to_string()));
    match opened.and_then(|file| Capture::from_source(file, options)) {
        Ok(capture) => Ok(Capture { name: Some(name), ..capture }),
        Err(error) => Err(bad(format!("{name}: {}", error.what))),
    }
}

impl Capture {
    /// What [`open`] does, with anything that can be read and searched.
    ///
    /// # Errors
    /// See [`open`].
    pub fn from_source<S: Read + Seek + Send + 'static>(
        mut source: S,
        options: &Options,
    ) -> Result<Capture, RecordingError> {
        let head = head(&mut source)?;
        if is_zip(&head) {
            let (about, reader) = sigrok::open(source, options)?;
            Capture::begin(about, Box::new(reader))
        } else {
            Capture::from_text(head, source, options)
        }
    }

    /// VCD or CSV from anything that can be read, such as a pipe.
    ///
    /// # Errors
    /// See [`open`]; and a `.sr` is refused, for it is read from its end.
    pub fn from_stream<R: Read + Send + 'static>(mut stream: R, options: &Options) -> Result<Capture, RecordingError> {
        let head = head(&mut stream)?;
        if is_zip(&head) {
            return Err(bad("a sigrok session cannot be read from a stream: store it in a file"));
        }
        Capture::from_text(head, stream, options)
    }

    fn from_text<R: Read + Send + 'static>(
        head: Vec<u8>,
        rest: R,
        options: &Options,
    ) -> Result<Capture, RecordingError> {
        let format = format_of(&head)?;
        let copy = head.clone();
        let stream = Box::new(Cursor::new(head).chain(rest));
        match format {
            Format::Vcd => {
                let (about, reader) = vcd::open(stream, options)?;
                Capture::begin(about, Box::new(reader))
            }
            Format::SaleaeCsv => {
                let (about, reader) = csv::open_saleae(stream, &copy, options)?;
                Capture::begin(about, Box::new(reader))
            }
            Format::SigrokCsv | Format::Sigrok => {
                let (about, reader) = csv::open_sigrok(stream, options)?;
                Capture::begin(about, Box::new(reader))
            }
        }
    }

    fn begin(about: About, mut source: Box<dyn Source>) -> Result<Capture, RecordingError> {
        let Some(step) = source.step()? else { return Err(bad("it holds no sample")) };
        Ok(Capture {
            name: None,
            about,
            source,
            first: step.levels,
            now: step.levels,
            edges: VecDeque::new(),
            end: step.at,
            outcome: None,
        })
    }

    /// What the file is.
    pub fn format(&self) -> Format {
        self.about.format
    }

    /// What the file or the user states about its times.
    pub fn resolution(&self) -> Resolution {
        self.about.resolution
    }

    /// The name of the channel that is this line.
    pub fn channel(&self, line: Line) -> Option<&str> {
        let place = LINES.iter().position(|known| *known == line)?;
        self.about.channels[place].as_deref()
    }

    /// How wake-ups show: as events where the file declares them, else as pulses on C/Q.
    pub fn wake_ups(&self) -> WakeUps {
        self.about.wake_ups
    }

    /// What the file is, how far its times can be trusted and which channel is which line, for a report.
    pub fn stated(&self) -> String {
        let About { format, resolution, origin_fs, .. } = &self.about;
        let mut text = format!("{format}, {resolution}: an edge may be off by {} ns", resolution.uncertainty_ns());
        if resolution.rate.is_none() && resolution.stated_ns.is_none() {
            text += ", or by the sample period if that is longer";
        }
        for (line, _, name) in Line::ALL {
            if let Some(channel) = self.channel(line) {
                text += &format!("; {name} is {}", channels::shown(channel));
            }
        }
        if *origin_fs != 0 {
            text += &format!("; time 0 is {} of the file", resolution::seconds(*origin_fs));
        }
        text
    }

    /// Takes the edges of a step.
    fn take(&mut self, step: Step) {
        for line in LINES {
            if let Some(level) = step.levels.of(line).filter(|_| step.levels.of(line) != self.now.of(line)) {
                self.edges.push_back(Edge { at: step.at, line, level });
            }
        }
        if step.wake_up {
            self.edges.push_back(Edge { at: step.at, line: Line::WakeUp, level: true });
        }
        self.now = step.levels;
        self.end = step.at;
    }
}

impl Recording for Capture {
    fn levels(&self) -> Levels {
        self.first
    }

    fn uncertainty_ns(&self) -> u64 {
        self.about.resolution.uncertainty_ns()
    }

    fn next_edge(&mut self) -> Result<Option<Edge>, RecordingError> {
        loop {
            if let Some(edge) = self.edges.pop_front() {
                return Ok(Some(edge));
            }
            if let Some(outcome) = &self.outcome {
                return outcome.clone().map(|()| None);
            }
            match self.source.step() {
                Ok(Some(step)) => self.take(step),
                Ok(None) => self.outcome = Some(Ok(())),
                Err(error) => {
                    let what = self.name.as_ref().map(|name| format!("{name}: {}", error.what));
                    self.outcome = Some(Err(what.map_or(error, bad)));
                }
            }
        }
    }

    fn end(&self) -> u64 {
        self.end
    }
}

fn bad(what: impl Into<String>) -> RecordingError {
    RecordingError { what: what.into() }
}

fn head(source: &mut impl Read) -> Result<Vec<u8>, RecordingError> {
    let mut head = Vec::new();
    source.take(HEAD).read_to_end(&mut head).map_err(|error| bad(error.to_string()))?;
    if head.is_empty() {
        return Err(bad("the file is empty"));
    }
    Ok(head)
}

/// The signature of an entry, or that of the end of an archive without one.
fn is_zip(head: &[u8]) -> bool {
    head.starts_with(b"PK\x03\x04") || head.starts_with(b"PK\x05\x06")
}

/// UTF-8's byte order mark, which some programs write in front of text.
const MARK: &[u8] = b"\xEF\xBB\xBF";

fn format_of(head: &[u8]) -> Result<Format, RecordingError> {
    let text = head.strip_prefix(MARK).unwrap_or(head).trim_ascii_start();
    let begins = |with: &[u8]| text.get(..with.len()).is_some_and(|begin| begin.eq_ignore_ascii_case(with));
    if begins(b"$") {
        Ok(Format::Vcd)
    } else if begins(b";") || begins(b"META samplerate:") {
        Ok(Format::SigrokCsv)
    } else if begins(b"Time") || begins(b"\"Time") {
        Ok(Format::SaleaeCsv)
    } else if begins(b"<SALEAE>") {
        Err(bad("this is a binary export of Saleae Logic: export CSV"))
    } else if begins(b"\x1F\x8B") {
        Err(bad("this is compressed with gzip: unpack it first"))
    } else {
        let begin = String::from_utf8_lossy(&head[..head.len().min(16)]).into_owned();
        Err(bad(format!(
            "this is no VCD, no sigrok session and no CSV of sigrok or Saleae Logic: it begins with {}",
            channels::shown(&begin)
        )))
    }
}
