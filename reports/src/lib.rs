//! The run record and everything rendered from it: a report is a function of a record on disk.

mod asked;
mod asked_html;
pub mod campaign;
mod case_html;
mod chart;
mod compare;
mod complete;
mod coverage;
mod coverage_html;
pub mod decode;
pub mod dossier;
mod duts;
mod evidence_html;
pub mod gauntlet;
mod histogram;
mod html;
mod journal;
mod junit;
mod ladder;
pub mod learned;
mod learned_html;
mod machine;
mod matrix_html;
mod measured_html;
pub mod measurement;
mod plot;
pub mod record;
mod ruler;
mod scenario_html;
mod story;
mod summary;
mod text;
mod timing;

pub use asked::Asked;
pub use compare::Differing;
pub use complete::Complete;
pub use coverage::{Coverage, Reached};
pub use journal::{FILE, Journal, ReadError, Reader, Run, read};
pub use ladder::{Beside, Ladder, Rung, Way, ladders};
pub use learned_html::render as learned_page;
pub use plot::{Bound, Curve, Measured, Plot, plots};
pub use story::{headline, story};
pub use summary::{Summary, execution_name, verdict_name};
pub use text::visible;

use std::io;
use std::path::Path;

/// Why reports cannot be made.
#[derive(Debug, thiserror::Error)]
pub enum RenderError {
    /// The record cannot be read.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// The XML writer failed.
    #[error("junit.xml cannot be made: {0}")]
    Junit(#[from] quick_junit::SerializeError),
    /// A report cannot be written.
    #[error("{path} cannot be written: {error}")]
    Write {
        /// The file.
        path: String,
        /// Why.
        error: io::Error,
    },
}

/// Makes every report of the record in a folder, beside it: `junit.xml`, `report.html`, `summary.json`.
///
/// # Errors
/// [`RenderError`].
pub fn render(folder: &Path) -> Result<Summary, RenderError> {
    let run = read(folder)?;
    let summary = Summary::of(&run);
    let mut json = serde_json::to_string_pretty(&summary).unwrap_or_default();
    json.push('\n');
    replace(folder, "junit.xml", &junit::render(&run)?)?;
    replace(folder, "report.html", &html::render(&run))?;
    replace(folder, "summary.json", &json)?;
    Ok(summary)
}

/// Writes a file as a whole or not at all.
fn replace(folder: &Path, name: &str, text: &str) -> Result<(), RenderError> {
    let (path, part) = (folder.join(name), folder.join(format!("{name}.part")));
    let failed = |error| RenderError::Write { path: path.display().to_string(), error };
    std::fs::write(&part, text).map_err(failed)?;
    std::fs::rename(&part, &path).map_err(failed)
}
