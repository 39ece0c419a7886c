//! Lines of a port over time: L+ (pin 1), C/Q (pin 4), I/Q (pin 2).
//!
//! A [`Recording`] gives [`Edge`]s in the order of time, whether it is a file of a logic analyser or a DUT that tells them
//! live; nothing here keeps them, so a recording may be longer than memory. A [`Decoder`] cuts them into [`Episode`]s, one a
//! power-on; [`measure`] takes the times out of an episode, a [`Claim`] what is no time; [`judge`] holds a value against
//! the [`Limits`] of an edition.

pub mod capture;
mod chart;
mod edge;
mod episode;
mod filter;
mod judge;
mod limit;
mod measure;
mod ossd;
mod vcd_writer;

pub use chart::{Chart, ChartError};
pub use edge::{Edge, Levels, Recording, RecordingError};
pub use episode::{Decoder, Episode, IqBefore, MOST_BLUR, POWER_ON, Pulse, WAKE_UP, WakeUps, WakeUpsSeen, decode};
pub use filter::Filter;
pub use judge::{Bounds, Judged, Verdict, judge, judge_looks};
pub use limit::{Limit, Limits, Outside, Row, Subject, Unit, Verify};
pub use measure::{Answer, Claim, Given, Measured, Quantity, measure};
pub use ossd::{ALONE_AFTER, Discrepancy, Extremes, OFF_AFTER, Ossd, Ratio, Seen, TestPulses};
pub use vcd_writer::VcdWriter;
