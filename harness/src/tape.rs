//! Writes the lines of a DUT that is served to a VCD, as a logic analyser at port 1 would see them.
//!
//! A wake-up is a pulse of 80 us on C/Q. Time only goes on: each connection brings a DUT whose clock begins anew, and each
//! variant (`Configure`) begins a case; either begins two seconds after what was written before, with all lines low. While one
//! connection is written another one is not.

use fsct_adapters::{Description, Dut, DutError, Line, Observation, Role, Seen, Stimulus};
use fsct_lines::{Edge, Levels, VcdWriter};
use std::fs::File;
use std::io::{self, BufWriter};
use std::path::Path;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Between two cases or connections.
const GAP_NS: u64 = 2_000_000_000;
/// Width of a wake-up.
const WAKE_UP_NS: u64 = 80_000;
/// Time that passes without an edge before it is written how far it has gone.
const TOLD_NS: u64 = 100_000_000;
/// The port whose lines are written.
const PORT: u8 = 1;

/// The file.
#[derive(Clone)]
pub struct Tape(Arc<Mutex<Written>>);

struct Written {
    writer: VcdWriter<BufWriter<File>>,
    /// Time of the file.
    now: u64,
    /// Until when the file says that time has gone.
    told: u64,
    /// L+, C/Q and I/Q as they are.
    levels: [bool; 3],
    /// The same as they are written: they differ while there is a wake-up.
    shown: [bool; 3],
    /// When the wake-up that is being written ends.
    wake_up_until: Option<u64>,
    /// A connection is being written.
    busy: bool,
}

impl Tape {
    /// A new file, whose times may be off by so much.
    ///
    /// # Errors
    /// What the system says when it cannot be written.
    pub fn create(path: &Path, uncertainty_ns: u64) -> io::Result<Tape> {
        let low = Levels { power: Some(false), cq: Some(false), iq: Some(false) };
        let mut writer = VcdWriter::of_levels(BufWriter::new(File::create(path)?), uncertainty_ns, low)?;
        writer.until(0)?;
        Ok(Tape(Arc::new(Mutex::new(Written {
            writer,
            now: 0,
            told: 0,
            levels: [false; 3],
            shown: [false; 3],
            wake_up_until: None,
            busy: false,
        }))))
    }

    /// A DUT whose lines are written as long as it lives.
    pub fn over(&self, dut: Box<dyn Dut>, role: Role) -> Box<dyn Dut> {
        let mut written = self.lock();
        let writes = !std::mem::replace(&mut written.busy, true);
        let zero = written.now;
        drop(written);
        if !writes {
            eprintln!("fsct: the lines of this connection are not written, for another one is open");
        }
        Box::new(Taped { dut, role, tape: self.clone(), writes, zero, now: 0 })
    }

    fn lock(&self) -> MutexGuard<'_, Written> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Written {
    /// Time goes on until `at`; a wake-up may end on the way.
    fn to(&mut self, at: u64) -> io::Result<()> {
        if let Some(until) = self.wake_up_until.filter(|until| *until <= at) {
            self.wake_up_until = None;
            self.now = self.now.max(until);
            self.show(1)?;
        }
        self.now = self.now.max(at);
        Ok(())
    }

    /// Writes a line as it is.
    fn show(&mut self, place: usize) -> io::Result<()> {
        let level = self.levels[place] != (place == 1 && self.wake_up_until.is_some());
        if self.shown[place] != level {
            self.shown[place] = level;
            self.told = self.now;
            let line = [Line::Power, Line::Cq, Line::Iq][place];
            self.writer.edge(&Edge { at: self.now, line, level })?;
        }
        Ok(())
    }

    fn edge(&mut self, at: u64, line: Line, level: bool) -> io::Result<()> {
        self.to(at)?;
        let place = match line {
            Line::WakeUp if level => {
                self.wake_up_until = Some(self.now + WAKE_UP_NS);
                1
            }
            Line::WakeUp => return Ok(()),
            Line::Power => 0,
            Line::Cq => 1,
            Line::Iq => 2,
        };
        if line != Line::WakeUp {
            self.levels[place] = level;
        }
        // A wake-up covers what happens meanwhile.
        if line == Line::WakeUp || place != 1 || self.wake_up_until.is_none() { self.show(place) } else { Ok(()) }
    }

    /// Lines are low, and there is a gap, unless nothing has happened yet. Gives the time from which the next case counts.
    fn anew(&mut self) -> io::Result<()> {
        self.to(self.now + if self.wake_up_until.is_some() { WAKE_UP_NS } else { 0 })?;
        self.levels = [false; 3];
        for place in [1, 2, 0] {
            self.show(place)?;
        }
        if self.now > 0 {
            self.now += GAP_NS;
        }
        self.flush()
    }

    fn flush(&mut self) -> io::Result<()> {
        self.told = self.now;
        self.writer.until(self.now)
    }
}

/// A DUT and the tape its lines are written to.
struct Taped {
    dut: Box<dyn Dut>,
    role: Role,
    tape: Tape,
    writes: bool,
    /// Time of the file at which the clock of the DUT was 0.
    zero: u64,
    /// Time of the clock of the DUT.
    now: u64,
}

impl Taped {
    fn write(&mut self, stimuli: &[Stimulus], observed: &[Observation]) -> io::Result<()> {
        let tape = self.tape.clone();
        let mut written = tape.lock();
        let before = written.told;
        let mut rest = observed;
        for (position, stimulus) in stimuli.iter().enumerate() {
            let count = rest.iter().take_while(|seen| seen.stimulus == position as u16).count();
            let (own, later) = rest.split_at_checked(count).unwrap_or((rest, &[]));
            rest = later;
            if matches!(stimulus, Stimulus::Configure(_)) {
                written.anew()?;
                self.zero = written.now.saturating_sub(self.now);
            }
            let began = self.now;
            for seen in own {
                self.now = self.now.max(seen.at);
                if let Seen::Line { port: PORT, line, level } = seen.seen {
                    written.edge(self.zero.saturating_add(seen.at), line, level)?;
                }
            }
            if let Stimulus::Advance { ns } = stimulus
                && own.iter().all(|seen| seen.seen != Seen::Unsupported)
            {
                // Observations of an advance are stamped within it or at its end.
                self.now = self.now.max(began.saturating_add(*ns));
            }
            if let (Stimulus::Power(false), Role::Master) = (stimulus, self.role) {
                // An FS-Master without supply supplies nobody, and has no time to say so.
                let at = self.zero.saturating_add(self.now);
                written.edge(at, Line::Power, false)?;
            }
        }
        let now = self.zero.saturating_add(self.now);
        written.to(now)?;
        // Edges are flushed at once, so that a killed process leaves them; time alone now and then.
        if written.told != before || written.now.saturating_sub(written.told) > TOLD_NS {
            written.flush()
        } else {
            Ok(())
        }
    }
}

impl Dut for Taped {
    fn hello(&mut self) -> Result<Description, DutError> {
        self.dut.hello()
    }

    fn apply(&mut self, stimuli: &[Stimulus], observed: &mut Vec<Observation>) -> Result<(), DutError> {
        let before = observed.len();
        let outcome = self.dut.apply(stimuli, observed);
        if self.writes
            && let Err(error) = self.write(stimuli, observed.get(before..).unwrap_or_default())
        {
            eprintln!("fsct: the lines are written no further: {error}");
            self.writes = false;
        }
        outcome
    }
}

impl Drop for Taped {
    fn drop(&mut self) {
        if self.writes {
            let mut written = self.tape.lock();
            let _ = written.anew();
            written.busy = false;
        }
    }
}
