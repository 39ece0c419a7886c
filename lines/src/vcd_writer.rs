//! Recordings as VCD.

use crate::{Edge, Levels, Recording};
use fsct_adapters::Line;
use std::fmt;
use std::io::{self, Write};
use vcd::{IdCode, SimulationCommand, TimescaleUnit, VarType};

/// What the comment begins with that states how far an edge may be off.
pub(crate) const UNCERTAINTY: &str = "edges may be off by at most";
/// The name of the event that a wake-up is.
pub(crate) const WAKE_UP: &str = "wake-up";

/// Writes edges as a value change dump in nanoseconds: a wire for each line there is, and a wake-up as an event.
///
/// Neither a date nor a name of a machine is written, so the same edges give the same file.
pub struct VcdWriter<W: Write> {
    writer: vcd::Writer<W>,
    ids: [(Line, Option<IdCode>); 4],
    at: u64,
}

impl<W: Write> fmt::Debug for VcdWriter<W> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("VcdWriter").field("ids", &self.ids).field("at", &self.at).finish_non_exhaustive()
    }
}

impl<W: Write> VcdWriter<W> {
    /// Writes the header and the levels that `recording` begins with. It takes no edge.
    ///
    /// # Errors
    /// What the writing meets.
    pub fn new(writer: W, recording: &impl Recording) -> io::Result<VcdWriter<W>> {
        VcdWriter::begin(writer, recording.uncertainty_ns(), recording.levels(), true)
    }

    /// Like [`VcdWriter::new`] for lines as a logic analyser sees them: there is no event, for a wake-up is a pulse on C/Q.
    ///
    /// # Errors
    /// What the writing meets.
    pub fn of_levels(writer: W, uncertainty_ns: u64, levels: Levels) -> io::Result<VcdWriter<W>> {
        VcdWriter::begin(writer, uncertainty_ns, levels, false)
    }

    fn begin(writer: W, uncertainty_ns: u64, levels: Levels, event: bool) -> io::Result<VcdWriter<W>> {
        let mut writer = vcd::Writer::new(writer);
        writer.version("fsct")?;
        writer.comment(&format!("{UNCERTAINTY} {uncertainty_ns} ns"))?;
        writer.timescale(1, TimescaleUnit::NS)?;
        writer.add_module("port")?;
        let mut ids = Line::ALL.map(|(line, _, _)| (line, None));
        for ((line, id), (_, _, name)) in ids.iter_mut().zip(Line::ALL) {
            if *line == Line::WakeUp {
                *id = if event { Some(writer.add_var(VarType::Event, 1, WAKE_UP, None)?) } else { None };
            } else if levels.of(*line).is_some() {
                *id = Some(writer.add_wire(1, name)?);
            }
        }
        writer.upscope()?;
        writer.enddefinitions()?;
        writer.timestamp(0)?;
        writer.begin(SimulationCommand::Dumpvars)?;
        for (line, id) in ids {
            if let (Some(id), Some(level)) = (id, levels.of(line)) {
                writer.change_scalar(id, level)?;
            }
        }
        writer.end()?;
        Ok(VcdWriter { writer, ids, at: 0 })
    }

    /// Appends an edge.
    ///
    /// # Errors
    /// [`io::ErrorKind::InvalidInput`] when it is earlier than the one before or of a line that has no level; what the
    /// writing meets.
    pub fn edge(&mut self, edge: &Edge) -> io::Result<()> {
        let id = self.ids.iter().find(|(line, _)| *line == edge.line).and_then(|(_, id)| *id);
        let Some(id) = id else {
            let what = format!("{:?} had no level at the beginning, so it has no edge at {} ns", edge.line, edge.at);
            return Err(io::Error::new(io::ErrorKind::InvalidInput, what));
        };
        self.to(edge.at)?;
        self.writer.change_scalar(id, edge.level)
    }

    /// Writes until when the levels are known; more may follow.
    ///
    /// # Errors
    /// As with an edge.
    pub fn until(&mut self, end: u64) -> io::Result<()> {
        self.to(end)?;
        self.writer.flush()
    }

    /// Writes until when the levels are known.
    ///
    /// # Errors
    /// As with an edge.
    pub fn finish(mut self, end: u64) -> io::Result<()> {
        self.until(end)
    }

    fn to(&mut self, at: u64) -> io::Result<()> {
        if at < self.at {
            let what = format!("{at} ns is earlier than {} ns", self.at);
            return Err(io::Error::new(io::ErrorKind::InvalidInput, what));
        }
        if at > self.at {
            self.writer.timestamp(at)?;
            self.at = at;
        }
        Ok(())
    }
}
