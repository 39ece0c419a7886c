//! fsct: conformance tests for IO-Link Safety.
//!
//! load -> plan -> execute -> judge -> record. Each stage is a function from one plain type to the next.

pub mod annex_i;
pub mod campaign;
pub mod capture;
pub mod case;
pub mod channel;
pub mod cli;
pub mod conditions;
pub mod coverage;
pub mod engine;
pub mod expect;
pub mod gauntlet;
pub mod injection;
pub mod judging;
pub mod keeper;
pub mod learn;
pub mod ledger;
pub mod library;
pub mod limits;
pub mod lines;
pub mod link;
pub mod mapping;
pub mod matrix;
pub mod oracle;
pub mod parameterize;
pub mod partner;
pub mod plan;
pub mod portconfig;
pub mod problem;
pub mod profile;
pub mod scenario;
pub mod session;
pub mod specimen;
pub mod stopwatch;
pub mod structure;
pub mod tape;
pub mod technology;
pub mod tester;
pub mod tours;
pub mod trace;
pub mod tree;
pub mod walk;
pub mod yaml;
