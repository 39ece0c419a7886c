//! The run record and everything rendered from it: a report is a function of a record on disk.

pub mod record;
