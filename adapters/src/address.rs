//! Addresses: how a command line says where the DUT is.
//!
//! | address | reaches |
//! |---|---|
//! | `inproc:NAME[?key=value&..]` | a DUT inside this program |
//! | `exec:PROGRAM ARGS..` | a child process on its standard input and output |
//! | `lib:PATH[?timeout=500ms]` | a shared library, in a child process |
//! | `tcp://HOST:PORT[?timeout=500ms]` | a socket |
//! | `unix:PATH[?timeout=500ms]` | a local socket |
//! | `serial:PATH[?baud=115200&..]` | a board behind a serial line, see [`SerialOptions`] |

use crate::SerialOptions;
use std::fmt;
use std::path::PathBuf;
use std::str::FromStr;
use std::time::Duration;

/// Where a DUT is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Address {
    /// Inside this program.
    Inproc {
        /// Its name.
        name: String,
        /// Options, in the order given.
        query: Vec<(String, String)>,
    },
    /// A program to be started.
    Exec {
        /// The program: a path, or a name to be looked for as a shell does.
        program: String,
        /// Its arguments.
        args: Vec<String>,
    },
    /// A shared library.
    Lib {
        /// Its path, without `?`.
        path: PathBuf,
        /// Time-out of each answer.
        timeout: Option<Duration>,
    },
    /// A TCP socket.
    Tcp {
        /// Name or number of the host, without the brackets of an IPv6 address.
        host: String,
        /// Port; 0 lets a listener choose one.
        port: u16,
        /// Time-out of each answer.
        timeout: Option<Duration>,
    },
    /// A socket in the file system.
    Unix {
        /// Its path, without `?`.
        path: PathBuf,
        /// Time-out of each answer.
        timeout: Option<Duration>,
    },
    /// A board behind a serial line.
    Serial {
        /// Path or name of the port, without `?`.
        path: PathBuf,
        /// How to use it.
        options: SerialOptions,
    },
}

/// A text that is no address. Each message is one sentence and quotes what was given.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum AddressError {
    /// It begins with no known scheme.
    #[error(
        "{given:?} begins with no way to reach a DUT (inproc:, lib:, exec:, tcp://, unix: or serial:), did you mean {nearest}?"
    )]
    UnknownScheme {
        /// The address.
        given: String,
        /// The known scheme most like its beginning.
        nearest: &'static str,
    },
    /// A part that has to be there.
    #[error("{given:?} lacks {what}")]
    Missing {
        /// The address.
        given: String,
        /// What: "a port".
        what: &'static str,
    },
    /// A port that is none.
    #[error("{port:?} is no port from 0 to 65535")]
    Port {
        /// The port.
        port: String,
    },
    /// A quotation mark without its partner.
    #[error("{given:?} has a quotation mark {mark} without its partner")]
    Quote {
        /// The address.
        given: String,
        /// `'` or `"`.
        mark: char,
    },
    /// An option the scheme does not have, or one that is no `key=value`.
    #[error("{option:?} is no option of this address, which has only timeout=..")]
    Option {
        /// The option.
        option: String,
    },
    /// An option a serial line does not have.
    #[error("{option:?} is no option of a serial line, which has baud, flow, reset, reset-command, wait and timeout")]
    SerialUnknown {
        /// The option.
        option: String,
    },
    /// An option of a serial line that is given once more.
    #[error("{option:?} is one option too many, a serial line takes each once and one way to reset")]
    SerialTwice {
        /// The option.
        option: String,
    },
    /// An option of a serial line that cannot be made use of.
    #[error("{option:?} is not usable, write {meant}")]
    Serial {
        /// The option.
        option: String,
        /// What can be written.
        meant: &'static str,
    },
    /// A time-out that is none.
    #[error("{given:?} is no time-out; write it as 500ms or 2s, from 1ms to {MAX_TIMEOUT_S}s")]
    Timeout {
        /// The time-out.
        given: String,
    },
}

const MAX_TIMEOUT_S: u64 = 3600;
const SCHEMES: [&str; 6] = ["inproc:", "lib:", "exec:", "tcp://", "unix:", "serial:"];

impl FromStr for Address {
    type Err = AddressError;

    fn from_str(text: &str) -> Result<Address, AddressError> {
        let missing = |what| AddressError::Missing { given: text.to_owned(), what };
        let known = SCHEMES.into_iter().find_map(|scheme| Some((scheme, text.strip_prefix(scheme)?)));
        match known {
            Some(("inproc:", rest)) => {
                let (name, query) = split_query(rest)?;
                if name.is_empty() {
                    return Err(missing("the name of a DUT"));
                }
                Ok(Address::Inproc { name: name.to_owned(), query })
            }
            Some(("exec:", rest)) => {
                let mut words =
                    split_words(rest).map_err(|mark| AddressError::Quote { given: text.to_owned(), mark })?.into_iter();
                let program = words.next().filter(|word| !word.is_empty()).ok_or(missing("a program"))?;
                Ok(Address::Exec { program, args: words.collect() })
            }
            Some(("tcp://", rest)) => {
                let (place, query) = split_query(rest)?;
                // The colons of an IPv6 address are inside brackets.
                let (host, port) = match place.strip_prefix('[') {
                    Some(rest) => rest.split_once("]:").ok_or(missing("a port"))?,
                    None => place.rsplit_once(':').ok_or(missing("a port"))?,
                };
                if host.is_empty() {
                    return Err(missing("a host"));
                }
                let port = port.parse().map_err(|_| AddressError::Port { port: port.to_owned() })?;
                Ok(Address::Tcp { host: host.to_owned(), port, timeout: timeout(query)? })
            }
            Some(("unix:", rest)) => {
                let (path, query) = split_query(rest)?;
                if path.is_empty() {
                    return Err(missing("a path"));
                }
                Ok(Address::Unix { path: PathBuf::from(path), timeout: timeout(query)? })
            }
            Some(("lib:", rest)) => {
                let (path, query) = split_query(rest)?;
                if path.is_empty() {
                    return Err(missing("a path"));
                }
                Ok(Address::Lib { path: PathBuf::from(path), timeout: timeout(query)? })
            }
            Some(("serial:", rest)) => {
                let (path, query) = rest.split_once('?').map_or((rest, None), |(path, query)| (path, Some(query)));
                if path.is_empty() {
                    return Err(missing("the path of a port"));
                }
                let options = query.map(SerialOptions::parse).transpose()?.unwrap_or_default();
                Ok(Address::Serial { path: PathBuf::from(path), options })
            }
            _ => {
                let begin = text.split_inclusive("//").next().unwrap_or_default();
                let begin = begin.split_inclusive(':').next().filter(|_| !begin.ends_with("//")).unwrap_or(begin);
                let nearest = SCHEMES.into_iter().min_by_key(|scheme| strsim::damerau_levenshtein(begin, scheme));
                Err(AddressError::UnknownScheme { given: text.to_owned(), nearest: nearest.unwrap_or_default() })
            }
        }
    }
}

impl fmt::Display for Address {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Address::Inproc { name, query } => {
                write!(f, "inproc:{name}")?;
                let marks = std::iter::once('?').chain(std::iter::repeat('&'));
                query.iter().zip(marks).try_for_each(|((key, value), mark)| write!(f, "{mark}{key}={value}"))
            }
            Address::Exec { program, args } => {
                write!(f, "exec:{}", quoted(program))?;
                args.iter().try_for_each(|arg| write!(f, " {}", quoted(arg)))
            }
            Address::Lib { path, timeout } => {
                write!(f, "lib:{}", path.display())?;
                write_timeout(f, *timeout)
            }
            Address::Tcp { host, port, timeout } => {
                if host.contains(':') {
                    write!(f, "tcp://[{host}]:{port}")?;
                } else {
                    write!(f, "tcp://{host}:{port}")?;
                }
                write_timeout(f, *timeout)
            }
            Address::Unix { path, timeout } => {
                write!(f, "unix:{}", path.display())?;
                write_timeout(f, *timeout)
            }
            Address::Serial { path, options } => write!(f, "serial:{}{options}", path.display()),
        }
    }
}

fn write_timeout(f: &mut fmt::Formatter<'_>, timeout: Option<Duration>) -> fmt::Result {
    timeout.map_or(Ok(()), |timeout| write!(f, "?timeout={}ms", timeout.as_millis()))
}

type Query = Vec<(String, String)>;

/// What stands before `?`, and the pairs behind it.
fn split_query(text: &str) -> Result<(&str, Query), AddressError> {
    let Some((before, query)) = text.split_once('?') else { return Ok((text, Vec::new())) };
    let pair = |option: &str| match option.split_once('=') {
        Some((key, value)) if !key.is_empty() => Ok((key.to_owned(), value.to_owned())),
        _ => Err(AddressError::Option { option: option.to_owned() }),
    };
    Ok((before, query.split('&').map(pair).collect::<Result<_, _>>()?))
}

/// The time-out of a query that may hold nothing else.
fn timeout(query: Query) -> Result<Option<Duration>, AddressError> {
    let mut timeout = None;
    for (key, value) in query {
        if key != "timeout" || timeout.is_some() {
            return Err(AddressError::Option { option: format!("{key}={value}") });
        }
        timeout = Some(duration(&value).ok_or(AddressError::Timeout { given: value })?);
    }
    Ok(timeout)
}

pub(crate) fn duration(text: &str) -> Option<Duration> {
    let (number, unit) = match text.strip_suffix("ms") {
        Some(number) => (number, Duration::from_millis as fn(u64) -> Duration),
        None => (text.strip_suffix('s')?, Duration::from_secs as fn(u64) -> Duration),
    };
    let duration = unit(number.parse().ok()?);
    (Duration::from_millis(1)..=Duration::from_secs(MAX_TIMEOUT_S)).contains(&duration).then_some(duration)
}

/// Splits at blanks; what stands between `'` or between `"` is taken as it is. The fault is a mark without partner.
pub(crate) fn split_words(text: &str) -> Result<Vec<String>, char> {
    let mut words = Vec::new();
    let mut word: Option<String> = None;
    let mut inside = None;
    for letter in text.chars() {
        match (inside, letter) {
            (Some(mark), _) if mark == letter => inside = None,
            (Some(_), _) => word.get_or_insert_default().push(letter),
            (None, '\'' | '"') => {
                inside = Some(letter);
                word.get_or_insert_default();
            }
            (None, _) if letter.is_ascii_whitespace() => words.extend(word.take()),
            (None, _) => word.get_or_insert_default().push(letter),
        }
    }
    words.extend(word);
    inside.map_or(Ok(words), Err)
}

/// The word so that [`split_words`] gives it back.
pub(crate) fn quoted(word: &str) -> String {
    if !word.is_empty() && !word.contains(|letter: char| letter.is_ascii_whitespace() || "'\"".contains(letter)) {
        return word.to_owned();
    }
    word.split('\'').map(|part| format!("'{part}'")).collect::<Vec<_>>().join("\"'\"")
}
