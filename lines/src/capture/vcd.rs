//! Value change dumps.

use super::bounded::Allowance;
use super::channels::{Channel, name_of, shown};
use super::resolution::{self, SECOND};
use super::{About, Format, LINES, MARK, Options, Resolution, SampleRate, Source, Step, bad};
use crate::vcd_writer::{UNCERTAINTY, WAKE_UP};
use crate::{Levels, RecordingError, WakeUps};
use std::io::{self, BufReader, Read};
use vcd::{Command, IdCode, ParseError, Parser, Value, VarType};

/// Octets of a header, and of the names it is kept as.
const HEADER: u64 = 1 << 20;
/// Octets of a change or a comment behind the header.
const CHANGE: u64 = 1 << 16;
/// Octets of the names of scopes around a channel.
const SCOPES: usize = 256;

type Stream = Box<dyn Read + Send>;

/// Reads the header and on to the first moment at which every line is known.
pub(super) fn open(mut stream: Stream, options: &Options) -> Result<(About, Reader), RecordingError> {
    let mut begin = Vec::new();
    (&mut stream).take(MARK.len() as u64).read_to_end(&mut begin).map_err(|error| bad(error.to_string()))?;
    if begin == MARK {
        begin.clear();
    }
    let stream: Stream = Box::new(io::Cursor::new(begin).chain(stream));
    let mut parser = Parser::new(Allowance::new(BufReader::new(stream)));
    parser.reader().allow(HEADER);
    let header = Header::read(&mut parser)?;
    let Some(tick_fs) = header.tick_fs else { return Err(bad("its header states no $timescale")) };
    let resolution = Resolution {
        step_fs: Some(tick_fs),
        rate: Resolution::agreed(header.rate, options.sample_rate)?,
        stated_ns: header.uncertainty_ns,
    };
    let channels: Vec<Channel> = header.variables.iter().map(|variable| variable.channel.clone()).collect();
    let places = options.channels.find(&channels)?;
    let mut ids = [None; 3];
    for (id, place) in ids.iter_mut().zip(places) {
        let Some(variable) = place.map(|place| &header.variables[place]) else { continue };
        if !variable.is_wire {
            return Err(bad(format!("{} is no single wire: export it bit by bit", shown(&variable.channel.path))));
        }
        *id = Some(variable.id);
    }
    let wake_ups = if header.wake_up.is_some() { WakeUps::Told } else { WakeUps::Pulses };
    let mut reader = Reader {
        parser,
        ids,
        wake_up: header.wake_up,
        tick_fs,
        origin: 0,
        time: None,
        levels: [None; 3],
        held: None,
        first: None,
    };
    let origin_fs = reader.begin()?;
    let channels = places.map(|place| place.map(|place| channels[place].path.clone()));
    Ok((About { format: Format::Vcd, resolution, channels, origin_fs, wake_ups }, reader))
}

struct Variable {
    channel: Channel,
    id: IdCode,
    is_wire: bool,
}

#[derive(Default)]
struct Header {
    tick_fs: Option<u128>,
    rate: Option<SampleRate>,
    uncertainty_ns: Option<u64>,
    variables: Vec<Variable>,
    wake_up: Option<IdCode>,
}

impl Header {
    /// Scopes are followed by hand: the parser's own header nests as deep as a file makes it.
    fn read(parser: &mut Parser<Allowance<BufReader<Stream>>>) -> Result<Header, RecordingError> {
        let mut header = Header::default();
        let mut scopes: Vec<usize> = Vec::new();
        let mut path = String::new();
        loop {
            match command(parser)? {
                None => return Err(bad("it ends within its header: it is cut off")),
                Some(Command::Enddefinitions) => return Ok(header),
                Some(Command::Timescale(quantity, unit)) => {
                    let tick = u128::from(quantity) * (SECOND / u128::from(unit.divisor()));
                    header.tick_fs = (tick > 0).then_some(tick);
                }
                Some(Command::Comment(text)) => header.comment(&text),
                Some(Command::ScopeDef(_, name)) => {
                    scopes.push(path.len());
                    path.push_str(&name);
                    path.push('.');
                    if path.len() > SCOPES {
                        return Err(located(parser, "its scopes are too deep or too long"));
                    }
                }
                Some(Command::Upscope) => {
                    let Some(outer) = scopes.pop() else {
                        return Err(located(parser, "a scope ends that has not begun"));
                    };
                    path.truncate(outer);
                }
                Some(Command::VarDef(kind, size, id, name, index)) => {
                    if kind == VarType::Event && name == WAKE_UP {
                        header.wake_up = Some(id);
                        continue;
                    }
                    let name = index.map_or(name.clone(), |index| format!("{name}{index}"));
                    let channel = Channel { path: format!("{path}{name}"), name };
                    let is_wire = size == 1 && is_wire(kind);
                    header.variables.push(Variable { channel, id, is_wire });
                }
                Some(Command::Date(_) | Command::Version(_)) => {}
                Some(_) => return Err(located(parser, "a change comes before $enddefinitions")),
            }
        }
    }

    /// libsigrok states the sample rate in a comment, [`crate::VcdWriter`] the uncertainty.
    fn comment(&mut self, text: &str) {
        if let Some((_, rate)) =
            text.strip_prefix("Acquisition with ").and_then(|text| text.split_once(" channels at "))
        {
            self.rate = rate.parse().ok();
        }
        if let Some(uncertainty) = text.strip_prefix(UNCERTAINTY).and_then(|text| text.strip_suffix(" ns")) {
            self.uncertainty_ns = uncertainty.trim().parse().ok();
        }
    }
}

/// A dump behind its header.
pub(super) struct Reader {
    parser: Parser<Allowance<BufReader<Stream>>>,
    ids: [Option<IdCode>; 3],
    wake_up: Option<IdCode>,
    tick_fs: u128,
    /// The time stamp that is time 0.
    origin: u64,
    time: Option<u64>,
    levels: [Option<bool>; 3],
    /// A command that was read too early.
    held: Option<Command>,
    first: Option<Step>,
}

impl Reader {
    /// Reads on until every line has a level and time moves on, or the first values are complete.
    fn begin(&mut self) -> Result<i128, RecordingError> {
        loop {
            let command = self.command()?;
            let known = self.ids.iter().zip(self.levels).all(|(id, level)| id.is_none() || level.is_some());
            match (command, self.time) {
                (command @ (Some(Command::Timestamp(_)) | None), Some(time)) if known => {
                    self.held = command;
                    self.origin = time;
                    break;
                }
                (Some(Command::End(_)), Some(time)) if known => {
                    self.origin = time;
                    break;
                }
                (Some(Command::Timestamp(time)), _) => self.to(time)?,
                (Some(Command::ChangeScalar(id, value)), _) => self.begin_with(id, Some(value)),
                (Some(Command::ChangeVector(id, values)), _) => {
                    self.begin_with(id, values.get(0).filter(|_| values.len() == 1));
                }
                (None, None) => return Err(bad("it has no time stamp behind its header")),
                (None, Some(_)) => {
                    let lines = LINES.iter().zip(self.ids).zip(self.levels);
                    let unknown = lines.filter(|((_, id), level)| id.is_some() && level.is_none());
                    let names: Vec<_> = unknown.map(|((line, _), _)| name_of(*line)).collect();
                    return Err(bad(format!("the lines never have levels all at once: {} has none", names.join(", "))));
                }
                _ => {}
            }
        }
        self.first = Some(self.now(false)?);
        let origin = u128::from(self.origin).checked_mul(self.tick_fs).and_then(|origin| i128::try_from(origin).ok());
        origin.ok_or_else(|| bad("its first time stamp is too late"))
    }

    fn begin_with(&mut self, id: IdCode, value: Option<Value>) {
        for (_, level) in self.ids.iter().zip(&mut self.levels).filter(|(known, _)| **known == Some(id)) {
            *level = value.and_then(level_of);
        }
    }

    fn command(&mut self) -> Result<Option<Command>, RecordingError> {
        if let Some(held) = self.held.take() {
            return Ok(Some(held));
        }
        self.parser.reader().allow(CHANGE);
        command(&mut self.parser)
    }

    fn to(&mut self, time: u64) -> Result<(), RecordingError> {
        match self.time.replace(time) {
            Some(before) if time < before => {
                Err(located(&self.parser, &format!("time goes back from #{before} to #{time}")))
            }
            _ => Ok(()),
        }
    }

    fn now(&self, wake_up: bool) -> Result<Step, RecordingError> {
        let ticks = u128::from(self.time.unwrap_or(0) - self.origin);
        let span = ticks.checked_mul(self.tick_fs).and_then(|span| i128::try_from(span).ok());
        let at = span.and_then(|span| resolution::nanoseconds(0, span));
        let at = at.ok_or_else(|| located(&self.parser, "the time is too late to be counted in nanoseconds"))?;
        let [power, cq, iq] = self.levels;
        Ok(Step { at, levels: Levels { power, cq, iq }, wake_up })
    }

    /// A change of a channel; `None` when it is none of a line.
    fn change(&mut self, id: IdCode, value: Option<Value>) -> Result<Option<Step>, RecordingError> {
        if self.wake_up == Some(id) {
            return self.now(true).map(Some);
        }
        let Some(place) = self.ids.iter().position(|known| *known == Some(id)) else { return Ok(None) };
        let level = value.and_then(level_of);
        if level.is_none() {
            let what = format!("{} is neither 0 nor 1 any more at #{}", name_of(LINES[place]), self.time.unwrap_or(0));
            return Err(located(&self.parser, &what));
        }
        self.levels[place] = level;
        self.now(false).map(Some)
    }
}

impl Source for Reader {
    fn step(&mut self) -> Result<Option<Step>, RecordingError> {
        if let Some(first) = self.first.take() {
            return Ok(Some(first));
        }
        loop {
            let step = match self.command()? {
                None => return Ok(None),
                Some(Command::Timestamp(time)) => {
                    self.to(time)?;
                    Some(self.now(false)?)
                }
                Some(Command::ChangeScalar(id, value)) => self.change(id, Some(value))?,
                Some(Command::ChangeVector(id, values)) => {
                    self.change(id, values.get(0).filter(|_| values.len() == 1))?
                }
                Some(_) => None,
            };
            if step.is_some() {
                return Ok(step);
            }
        }
    }
}

/// Whether a variable has the levels of a line.
fn is_wire(kind: VarType) -> bool {
    use VarType::{Event, Integer, Parameter, Real, String, Time};
    !matches!(kind, Event | Integer | Parameter | Real | String | Time)
}

fn level_of(value: Value) -> Option<bool> {
    match value {
        Value::V0 => Some(false),
        Value::V1 => Some(true),
        Value::X | Value::Z => None,
    }
}

/// The next command, with errors in words.
fn command(parser: &mut Parser<Allowance<BufReader<Stream>>>) -> Result<Option<Command>, RecordingError> {
    let error = match parser.next().transpose() {
        Ok(command) => return Ok(command),
        Err(error) => error,
    };
    let what = match (error.kind(), error.get_ref().and_then(|inner| inner.downcast_ref::<ParseError>())) {
        // It names the line itself.
        (_, Some(inner)) => return Err(bad(format!("this is no sound VCD: {inner}"))),
        (io::ErrorKind::UnexpectedEof, _) => {
            "the file ends in the middle of a command or a line: it is cut off".to_owned()
        }
        (io::ErrorKind::FileTooLarge, _) => {
            "a command, or the whole header, is longer than any logic analyser writes".to_owned()
        }
        _ => error.to_string(),
    };
    Err(located(parser, &what))
}

fn located<R: io::BufRead>(parser: &Parser<R>, what: &str) -> RecordingError {
    bad(format!("line {}: {what}", parser.line()))
}
