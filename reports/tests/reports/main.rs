//! Reports made from records: journal, summary and exit code, JUnit, HTML, with hostile text and cut-off files.

mod common;
mod compare;
mod coverage;
mod decode;
mod dossier;
mod journal;
mod measured;
mod plot;
mod rendered;
mod summary;
