//! A DUT that is a child process: started, its standard error read, and ended with everything it started.

use crate::stream::Peer;
use std::collections::VecDeque;
use std::io::{self, Read};
use std::process::{Child, ChildStderr, ChildStdin, ChildStdout, Command, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

/// How long a process may take to end by itself once its standard input has ended.
const GRACE: Duration = Duration::from_millis(200);
/// How often it is looked whether a process has ended.
const LOOK: Duration = Duration::from_millis(5);
/// Octets of standard error kept.
const KEPT: usize = 4096;
/// Letters of the last line that are shown.
const SHOWN: usize = 200;

/// A running child process.
pub(crate) struct Process {
    child: Child,
    last_words: Arc<Mutex<VecDeque<u8>>>,
    /// Ends when standard error does.
    stderr: Receiver<()>,
    /// How it ended, once it has.
    how: Option<String>,
}

impl Process {
    /// Starts a program, in a process group of its own where the system has such.
    pub(crate) fn start(program: &str, args: &[String]) -> io::Result<(ChildStdout, ChildStdin, Process)> {
        let mut command = Command::new(program);
        command.args(args).stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
        #[cfg(unix)]
        std::os::unix::process::CommandExt::process_group(&mut command, 0);
        let mut child = command.spawn()?;
        let pipes = (child.stdout.take(), child.stdin.take(), child.stderr.take());
        let (ended, stderr) = channel();
        let last_words = Arc::default();
        let process = Process { child, last_words: Arc::clone(&last_words), stderr, how: None };
        // Asked for above, they are there; were they not, dropping `process` would end it.
        let (Some(stdout), Some(stdin), Some(stderr)) = pipes else {
            return Err(io::Error::other("the process has no pipes"));
        };
        thread::spawn(move || keep_last(stderr, &last_words, ended));
        Ok((stdout, stdin, process))
    }

    fn end(&mut self) -> String {
        // Whoever heeds the end of the standard input ends in order, and has said its last words then.
        let running = self.stderr.recv_timeout(GRACE) == Err(RecvTimeoutError::Timeout);
        self.kill();
        let status = match self.child.wait() {
            _ if running => "it was still running and has been killed".to_owned(),
            Ok(status) => status.to_string(),
            Err(error) => error.to_string(),
        };
        self.with_last_words(&status)
    }

    /// How it ended, as [`Peer::close`] says it.
    fn with_last_words(&self, status: &str) -> String {
        match self.last_line() {
            Some(line) => format!(" ({status}, its last words \"{line}\")"),
            None => format!(" ({status})"),
        }
    }

    /// Ends the process and its process group. The number of the group cannot have passed to others: the process is
    /// waited for only afterwards.
    fn kill(&mut self) {
        #[cfg(unix)]
        {
            let group = format!("kill -s KILL -- -{}", self.child.id());
            let quiet = || Stdio::null();
            let _ =
                Command::new("/bin/sh").args(["-c", &group]).stdin(quiet()).stdout(quiet()).stderr(quiet()).status();
        }
        let _ = self.child.kill();
    }

    /// The last line of standard error that is not blank, escaped.
    fn last_line(&self) -> Option<String> {
        let kept = self.last_words.lock().unwrap_or_else(PoisonError::into_inner);
        let (head, tail) = kept.as_slices();
        let text = String::from_utf8_lossy(&[head, tail].concat()).into_owned();
        let line = text.lines().rev().map(str::trim).find(|line| !line.is_empty())?;
        Some(line.chars().take(SHOWN).flat_map(char::escape_debug).collect())
    }
}

impl Peer for Process {
    fn close(&mut self) -> String {
        if self.how.is_none() {
            self.how = Some(self.end());
        }
        self.how.clone().unwrap_or_default()
    }
}

impl Drop for Process {
    fn drop(&mut self) {
        self.close();
    }
}

/// Runs a program to its end, which has to come in time and to be a success; the error says how it ended. What it leaves
/// running is its own matter.
pub(crate) fn run(program: &str, args: &[String], within: Duration) -> io::Result<()> {
    let (mut stdout, stdin, mut process) = Process::start(program, args)?;
    drop(stdin);
    thread::spawn(move || io::copy(&mut stdout, &mut io::sink()));
    let begin = Instant::now();
    while begin.elapsed() < within {
        match process.child.try_wait()? {
            None => thread::sleep(LOOK),
            Some(status) => {
                // Nobody waits for it any more, so nobody may end it either.
                process.how = Some(String::new());
                if status.success() {
                    return Ok(());
                }
                let _ = process.stderr.recv_timeout(GRACE);
                return Err(io::Error::other(process.with_last_words(&status.to_string()).trim().to_owned()));
            }
        }
    }
    Err(io::Error::new(io::ErrorKind::TimedOut, process.close().trim().to_owned()))
}

/// Reads to the end and keeps the latest octets. `_ended` says by its end that there will be no more.
fn keep_last(mut stderr: ChildStderr, kept: &Mutex<VecDeque<u8>>, _ended: Sender<()>) {
    let mut buffer = [0; 1024];
    while let Ok(count @ 1..) = stderr.read(&mut buffer) {
        let mut kept = kept.lock().unwrap_or_else(PoisonError::into_inner);
        kept.extend(buffer.iter().take(count));
        let surplus = kept.len().saturating_sub(KEPT);
        kept.drain(..surplus);
    }
}
