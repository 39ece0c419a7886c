//! CSV of Saleae Logic, a row a change, and of sigrok, a row a sample.

use super::bounded::Lines;
use super::channels::{Channel, shown};
use super::resolution::{self, SECOND};
use super::{About, Format, MARK, Options, Resolution, SampleRate, Source, Step, bad};
use crate::{Levels, RecordingError, WakeUps};
use std::io::Read;

type Stream = Box<dyn Read + Send>;

/// Digits behind the point that are read: femtoseconds.
const DIGITS: usize = 15;

/// How the rows of a file tell their time.
enum Time {
    /// In a column of its own, in seconds; the first row and the latest, in femtoseconds.
    Seconds { first: i128, latest: i128 },
    /// By their number, from the first.
    Samples { rate: SampleRate, next: u64 },
}

/// The rows of a file.
pub(super) struct Reader {
    lines: Lines<Stream>,
    /// How many columns a row has.
    columns: usize,
    /// The columns of the lines.
    places: [Option<usize>; 3],
    time: Time,
    held: Option<Step>,
}

/// `head` is the beginning of the file, for the digits its times have.
pub(super) fn open_saleae(stream: Stream, head: &[u8], options: &Options) -> Result<(About, Reader), RecordingError> {
    let mut lines = Lines::new(stream);
    let header = lines.next()?.unwrap_or_default();
    let names = cells(header.trim_start_matches('\u{FEFF}'));
    let time: String =
        names.first().map(|time| time.chars().filter(|c| !c.is_whitespace()).collect()).unwrap_or_default();
    if !time.eq_ignore_ascii_case("time[s]") {
        let time = names.first().map(|time| shown(time)).unwrap_or_default();
        return Err(bad(format!("its first column is {time}, not `Time [s]`: export the times in seconds")));
    }
    let channels: Vec<Channel> = names[1..].iter().map(|name| Channel::plain(name)).collect();
    let found = options.channels.find(&channels)?;
    let mut reader = Reader {
        lines,
        columns: names.len(),
        places: found.map(|place| place.map(|place| place + 1)),
        time: Time::Seconds { first: 0, latest: 0 },
        held: None,
    };
    let origin_fs = reader.begin()?;
    let resolution = Resolution {
        step_fs: Some(step_of(head)),
        rate: Resolution::agreed(None, options.sample_rate)?,
        stated_ns: None,
    };
    let channels = found.map(|place| place.map(|place| channels[place].name.clone()));
    Ok((About { format: Format::SaleaeCsv, resolution, channels, origin_fs, wake_ups: WakeUps::Pulses }, reader))
}

/// The comments, which state the channels and the rate; then the rows, with or without a row of labels before them.
pub(super) fn open_sigrok(stream: Stream, options: &Options) -> Result<(About, Reader), RecordingError> {
    let mut lines = Lines::new(stream);
    let mut rate: Option<SampleRate> = None;
    let mut channels: Vec<Channel> = Vec::new();
    let row = loop {
        let Some(line) = lines.next()? else { return Err(bad("it holds comments only: it is cut off")) };
        let line = line.trim_start_matches('\u{FEFF}');
        if let Some(stated) = line.strip_prefix("META samplerate:") {
            rate = Some(stated.parse()?);
        } else if let Some(comment) = line.strip_prefix(';').map(str::trim) {
            if let Some(stated) = comment.strip_prefix("Samplerate:") {
                rate = Some(stated.parse()?);
            } else if let Some((_, names)) = comment.strip_prefix("Channels (").and_then(|text| text.split_once("):")) {
                channels = names.split(", ").map(|name| Channel::plain(name.trim())).collect();
            }
        } else if !line.trim().is_empty() {
            break line.to_owned();
        }
    };
    if channels.is_empty() {
        return Err(bad("its comments name no channels: export with the header"));
    }
    let rate = Resolution::agreed(rate, options.sample_rate)?;
    let Some((hertz, _)) = rate else { return Err(bad("its comments state no sample rate: give it, such as 24 MHz")) };
    let columns = cells(&row);
    if columns.len() != channels.len() {
        return Err(lines.bad(&format!(
            "there are {} columns for {} channels: export without times and triggers",
            columns.len(),
            channels.len()
        )));
    }
    let places = options.channels.find(&channels)?;
    let time = Time::Samples { rate: hertz, next: 0 };
    let mut reader = Reader { lines, columns: columns.len(), places, time, held: None };
    if columns.iter().all(|cell| matches!(cell.as_str(), "0" | "1")) {
        reader.held = reader.row(&row).map(Some)?;
    }
    let channels = places.map(|place| place.map(|place| channels[place].name.clone()));
    let resolution = Resolution { step_fs: None, rate, stated_ns: None };
    Ok((About { format: Format::SigrokCsv, resolution, channels, origin_fs: 0, wake_ups: WakeUps::Pulses }, reader))
}

impl Reader {
    /// Reads the first row, whose time is time 0.
    fn begin(&mut self) -> Result<i128, RecordingError> {
        let Some(row) = self.next_row()? else { return Err(bad("it holds no row behind its header")) };
        let time = row.split(',').next().unwrap_or_default().trim();
        let first = seconds(time).ok_or_else(|| self.lines.bad(&no_time(time)))?;
        self.time = Time::Seconds { first, latest: first };
        self.held = Some(self.row(&row)?);
        Ok(first)
    }

    fn next_row(&mut self) -> Result<Option<String>, RecordingError> {
        while let Some(line) = self.lines.next()? {
            if !line.trim().is_empty() {
                return Ok(Some(line.to_owned()));
            }
        }
        Ok(None)
    }

    fn row(&mut self, row: &str) -> Result<Step, RecordingError> {
        let mut levels = [None; 3];
        let mut columns = 0;
        let mut at = None;
        for (column, cell) in row.split(',').enumerate() {
            columns += 1;
            let cell = cell.trim();
            if column == 0
                && let Time::Seconds { first, latest } = &mut self.time
            {
                let now = seconds(cell).ok_or_else(|| self.lines.bad(&no_time(cell)))?;
                if now < *latest {
                    let (from, to) = (resolution::seconds(*latest), resolution::seconds(now));
                    return Err(self.lines.bad(&format!("time goes back from {from} to {to}")));
                }
                *latest = now;
                at = resolution::nanoseconds(*first, now);
            }
            for (_, level) in self.places.iter().zip(&mut levels).filter(|(place, _)| **place == Some(column)) {
                *level = match cell {
                    "0" => Some(false),
                    "1" => Some(true),
                    _ => return Err(self.lines.bad(&format!("{} is neither 0 nor 1", shown(cell)))),
                };
            }
        }
        if columns != self.columns {
            let what = format!("columns: {columns} instead of {}: it is cut off or none of the table", self.columns);
            return Err(self.lines.bad(&what));
        }
        if let Time::Samples { rate, next } = &mut self.time {
            at = rate.time_of(*next);
            *next += 1;
        }
        let at = at.ok_or_else(|| self.lines.bad("the time is too late to be counted in nanoseconds"))?;
        let [power, cq, iq] = levels;
        Ok(Step { at, levels: Levels { power, cq, iq }, wake_up: false })
    }
}

impl Source for Reader {
    fn step(&mut self) -> Result<Option<Step>, RecordingError> {
        if let Some(held) = self.held.take() {
            return Ok(Some(held));
        }
        match self.next_row()? {
            Some(row) => self.row(&row).map(Some),
            None => Ok(None),
        }
    }
}

fn no_time(cell: &str) -> String {
    format!("{} is no time in seconds, such as 0.000125", shown(cell))
}

/// The cells of a header. A name may be in quotes, with commas in it.
fn cells(header: &str) -> Vec<String> {
    let mut cells = vec![String::new()];
    let mut quoted = false;
    for c in header.chars() {
        match c {
            '"' => quoted = !quoted,
            ',' if !quoted => cells.push(String::new()),
            c => cells.last_mut().expect("there is one from the beginning").push(c),
        }
    }
    cells.iter().map(|cell| cell.trim().to_owned()).collect()
}

/// A decimal number of seconds in femtoseconds; finer digits are cut.
fn seconds(text: &str) -> Option<i128> {
    let (negative, text) = text.strip_prefix('-').map_or((false, text), |text| (true, text));
    let (whole, part) = text.split_once('.').unwrap_or((text, ""));
    if whole.is_empty() || whole.len() > 15 || !(whole.bytes().chain(part.bytes())).all(|c| c.is_ascii_digit()) {
        return None;
    }
    let part = &part[..part.len().min(DIGITS)];
    let time = whole.parse::<i128>().ok()? * SECOND as i128 + format!("{part:0<DIGITS$}").parse::<i128>().ok()?;
    Some(if negative { -time } else { time })
}

/// The step in which times are printed: that of the time with the most digits, for zeros at the end may not be printed.
fn step_of(head: &[u8]) -> u128 {
    let text = String::from_utf8_lossy(head.strip_prefix(MARK).unwrap_or(head)).into_owned();
    // The latest line may be cut, which does not make its time longer.
    let times = text.lines().skip(1).map(|line| line.split(',').next().unwrap_or_default().trim());
    let digits = times.filter_map(|time| time.split_once('.')).map(|(_, part)| part.len()).max().unwrap_or(0);
    SECOND / 10_u128.pow(u32::try_from(digits.min(DIGITS)).unwrap_or(0))
}
