//! The options of a `serial:` address.

use crate::address::{AddressError, duration, quoted, split_words};
use std::fmt;
use std::time::Duration;

/// How to use the line to a board.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SerialOptions {
    /// Bits a second.
    pub baud: u32,
    /// Who may stop the other end, and how.
    pub flow: Flow,
    /// What is done to the board before each connection; `None`: nothing.
    pub reset: Option<Reset>,
    /// How long a port may be absent before it counts as unreachable; `None`: [`WAIT`](crate::WAIT).
    pub wait: Option<Duration>,
    /// Time-out of each answer.
    pub timeout: Option<Duration>,
}

impl Default for SerialOptions {
    /// 115200 bit/s and nothing else.
    fn default() -> SerialOptions {
        SerialOptions { baud: 115_200, flow: Flow::None, reset: None, wait: None, timeout: None }
    }
}

/// Flow control of a line. XON and XOFF are none of it: frames hold these octets too.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Flow {
    /// None: both ends are fast enough.
    None,
    /// RTS and CTS.
    Hardware,
}

/// How a board is made to begin anew.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Reset {
    /// DTR is let go for a moment and asserted again, as boards with a capacitor at DTR expect.
    Dtr,
    /// RTS is asserted for a moment and let go again, as boards whose reset follows RTS expect.
    Rts,
    /// A program that does it.
    Command {
        /// The program.
        program: String,
        /// Its arguments.
        args: Vec<String>,
    },
}

impl SerialOptions {
    /// From what stands behind the question mark of an address. A command is the last option, for it may hold anything.
    pub(crate) fn parse(query: &str) -> Result<SerialOptions, AddressError> {
        const COMMAND: &str = "reset-command=";
        let at = query.find(COMMAND).unwrap_or(query.len());
        let (pairs, command) = query.split_at(at);
        let pairs = pairs.strip_suffix('&').filter(|_| !command.is_empty()).unwrap_or(pairs);
        let pairs = pairs.split('&').filter(|pair| command.is_empty() || !pair.is_empty());
        let mut options = SerialOptions::default();
        let mut seen = Vec::new();
        for option in pairs.chain(Some(command).filter(|command| !command.is_empty())) {
            let owned = || option.to_owned();
            let (key, value) = option.split_once('=').ok_or_else(|| AddressError::SerialUnknown { option: owned() })?;
            // Both ways to reset are one option.
            let name = if key == "reset-command" { "reset" } else { key };
            if seen.contains(&name) {
                return Err(AddressError::SerialTwice { option: owned() });
            }
            seen.push(name);
            let unusable = |meant| AddressError::Serial { option: owned(), meant };
            let time = || duration(value).ok_or_else(|| AddressError::Timeout { given: value.to_owned() });
            match key {
                "baud" => {
                    let baud = value.parse().ok().filter(|baud| *baud > 0);
                    options.baud = baud.ok_or(unusable("baud=115200, in bits a second"))?;
                }
                "flow" => {
                    options.flow = match value {
                        "none" => Flow::None,
                        "hardware" => Flow::Hardware,
                        "software" => {
                            return Err(unusable(
                                "flow=none or flow=hardware, for frames hold the octets of XON and XOFF",
                            ));
                        }
                        _ => return Err(unusable("flow=none or flow=hardware")),
                    }
                }
                "reset" => {
                    options.reset = Some(match value {
                        "dtr" => Reset::Dtr,
                        "rts" => Reset::Rts,
                        _ => return Err(unusable("reset=dtr, reset=rts or reset-command=PROGRAM ARGS")),
                    })
                }
                "reset-command" => {
                    let words = split_words(value).ok().map(Vec::into_iter);
                    let program =
                        words.and_then(|mut words| Some((words.next().filter(|word| !word.is_empty())?, words)));
                    let (program, args) =
                        program.ok_or(unusable("reset-command=PROGRAM ARGS, each quotation mark with its partner"))?;
                    options.reset = Some(Reset::Command { program, args: args.collect() });
                }
                "wait" => options.wait = Some(time()?),
                "timeout" => options.timeout = Some(time()?),
                _ => return Err(AddressError::SerialUnknown { option: owned() }),
            }
        }
        if options.flow == Flow::Hardware && options.reset == Some(Reset::Rts) {
            let meant = "reset=dtr, for RTS belongs to flow=hardware";
            return Err(AddressError::Serial { option: "reset=rts".to_owned(), meant });
        }
        Ok(options)
    }
}

impl fmt::Display for SerialOptions {
    /// What differs from the default, with its question mark; a command is the last.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut options = Vec::new();
        if self.baud != SerialOptions::default().baud {
            options.push(format!("baud={}", self.baud));
        }
        match self.flow {
            Flow::None => {}
            Flow::Hardware => options.push("flow=hardware".to_owned()),
        }
        match &self.reset {
            Some(Reset::Dtr) => options.push("reset=dtr".to_owned()),
            Some(Reset::Rts) => options.push("reset=rts".to_owned()),
            Some(Reset::Command { .. }) | None => {}
        }
        options.extend(self.wait.map(|wait| format!("wait={}ms", wait.as_millis())));
        options.extend(self.timeout.map(|timeout| format!("timeout={}ms", timeout.as_millis())));
        if let Some(Reset::Command { program, args }) = &self.reset {
            let words: Vec<_> = std::iter::once(program).chain(args).map(|word| quoted(word)).collect();
            options.push(format!("reset-command={}", words.join(" ")));
        }
        match options.as_slice() {
            [] => Ok(()),
            options => write!(f, "?{}", options.join("&")),
        }
    }
}
