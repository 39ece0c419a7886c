//! Which channel of a file is which line.

use super::{LINES, bad};
use crate::RecordingError;
use fsct_adapters::Line;
use std::fmt::Write as _;
use std::str::FromStr;

/// How many channels an error lists.
const LISTED: usize = 16;
/// How much of a name an error shows.
const SHOWN: usize = 40;

/// Which channel is L+, C/Q and I/Q.
///
/// Written as `L+=D0,C/Q=D1`. A channel is told by its name, by its name behind those of its scopes (`top.port.CQ`), or by
/// the number of a channel named `1`, `D1`, `CH1` or `Channel 1`. A line that is not told is the channel that is called after
/// it or after its pin: `L+`, `L_plus`, `power` or `pin1`; `C/Q`, `CQ` or `pin4`; `I/Q`, `IQ` or `pin2`, in capitals or not.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Channels {
    told: [Option<String>; 3],
}

impl FromStr for Channels {
    type Err = RecordingError;

    fn from_str(text: &str) -> Result<Channels, RecordingError> {
        let mut channels = Channels::default();
        for entry in text.split(',') {
            let Some((line, channel)) = entry.split_once('=') else {
                return Err(bad(format!("{} is no line and channel, such as C/Q=D1", shown(entry))));
            };
            let line = line.trim();
            let Some(place) = called_like(line) else {
                return Err(bad(format!("{} is no line: there are L+, C/Q and I/Q", shown(line))));
            };
            let channel = channel.trim();
            if channel.is_empty() {
                return Err(bad(format!("no channel is told for {line}")));
            }
            if channels.told[place].replace(channel.to_owned()).is_some() {
                return Err(bad(format!("{line} is told twice")));
            }
        }
        Ok(channels)
    }
}

/// A channel of a file.
#[derive(Clone, Debug)]
pub(super) struct Channel {
    /// Its name.
    pub name: String,
    /// Its name behind those of its scopes.
    pub path: String,
}

impl Channel {
    /// A channel without a scope.
    pub fn plain(name: &str) -> Channel {
        Channel { name: name.to_owned(), path: name.to_owned() }
    }
}

impl Channels {
    /// The places of the channels that are L+, C/Q and I/Q.
    pub(super) fn find(&self, there: &[Channel]) -> Result<[Option<usize>; 3], RecordingError> {
        let mut places = [None; 3];
        for (place, told) in self.told.iter().enumerate() {
            let line = name_of(LINES[place]);
            places[place] = match told {
                Some(told) => match by_name(told, there).as_slice() {
                    [] => {
                        return Err(bad(format!(
                            "there is no channel {} to be {line}: {}",
                            shown(told),
                            list(there.iter().map(|channel| &channel.path))
                        )));
                    }
                    found => Some(only(line, found, there)?),
                },
                None => match called(place, there).as_slice() {
                    [] => None,
                    found => Some(only(line, found, there)?),
                },
            };
            if let (Some(found), Some(other)) =
                (places[place], places[..place].iter().position(|at| *at == places[place]))
            {
                let other = name_of(LINES[other]);
                return Err(bad(format!("{} cannot be both {other} and {line}", shown(&there[found].path))));
            }
        }
        if places == [None; 3] {
            return Err(bad(format!(
                "no channel is called L+, C/Q or I/Q, so tell which they are, such as C/Q=D1: {}",
                list(there.iter().map(|channel| &channel.path))
            )));
        }
        Ok(places)
    }
}

/// The channels a user means, by the first way that gives any.
fn by_name(told: &str, there: &[Channel]) -> Vec<usize> {
    let all = |fits: &dyn Fn(&Channel) -> bool| -> Vec<usize> {
        there.iter().enumerate().filter(|(_, channel)| fits(channel)).map(|(place, _)| place).collect()
    };
    let exactly = all(&|channel| channel.path == told || channel.name == told);
    if !exactly.is_empty() {
        return exactly;
    }
    let capitals = all(&|channel| channel.path.eq_ignore_ascii_case(told) || channel.name.eq_ignore_ascii_case(told));
    match told.parse::<u32>() {
        Ok(number) if capitals.is_empty() => all(&|channel| number_of(&channel.name) == Some(number)),
        _ => capitals,
    }
}

/// The number of a channel that nobody has named.
fn number_of(name: &str) -> Option<u32> {
    let name = name.to_ascii_lowercase();
    let number = ["channel", "ch", "d"].iter().find_map(|kind| name.strip_prefix(kind)).unwrap_or(&name);
    number.trim().parse().ok()
}

/// The channels that bear the name of a line.
fn called(place: usize, there: &[Channel]) -> Vec<usize> {
    let channels = there.iter().enumerate();
    channels.filter(|(_, channel)| called_like(&channel.name) == Some(place)).map(|(at, _)| at).collect()
}

/// The line a name stands for.
fn called_like(name: &str) -> Option<usize> {
    let plain: String =
        name.chars().filter(|c| !matches!(c, ' ' | '_' | '-' | '/')).flat_map(char::to_lowercase).collect();
    match plain.as_str() {
        "l+" | "lplus" | "power" | "pin1" => Some(0),
        "cq" | "pin4" => Some(1),
        "iq" | "pin2" => Some(2),
        _ => None,
    }
}

fn only(line: &str, found: &[usize], there: &[Channel]) -> Result<usize, RecordingError> {
    match found {
        [one] => Ok(*one),
        _ => Err(bad(format!(
            "more than one channel may be {line}, so tell which it is: {}",
            list(found.iter().map(|place| &there[*place].path))
        ))),
    }
}

/// The name of a line in texts.
pub(super) fn name_of(line: Line) -> &'static str {
    Line::ALL.into_iter().find(|entry| entry.0 == line).map_or("", |entry| entry.2)
}

fn list<'a>(names: impl ExactSizeIterator<Item = &'a String>) -> String {
    let count = names.len();
    let mut text = String::from(if count == 0 { "there is none" } else { "there are " });
    for (place, name) in names.take(LISTED).enumerate() {
        text += if place == 0 { "" } else { ", " };
        text += &shown(name);
    }
    if count > LISTED {
        let _ = write!(text, " and {} more", count - LISTED);
    }
    text
}

/// A name from a file, fit to be shown.
pub(super) fn shown(name: &str) -> String {
    let begin: String = name.chars().take(SHOWN).collect();
    let more = if begin.len() < name.len() { "…" } else { "" };
    format!("`{}{more}`", begin.escape_debug())
}
