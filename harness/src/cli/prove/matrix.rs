//! `fsct prove --matrix`: P1 to P5 for many readings, watchdogs and both timings, a row each.

use super::{UNKNOWN, VIOLATED};
use crate::cli::{fail, print, show};
use crate::library::Library;
use fsct_proof::{Failing, Machine, Model, Reading, Timing, failing_each, mixtures, read};
use serde_json::{Value, json};
use std::ops::RangeInclusive;

/// Which readings are in the matrix.
#[derive(Copy, Clone, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Which {
    /// The default, the readings a product may follow, each alone, and any combination of them
    Tolerated,
    /// Those, each of an FS-Master's with each of an FS-Device's, and the refused ones
    All,
}

const WATCHDOGS: RangeInclusive<u8> = 2..=6;

struct Row {
    name: String,
    /// No product may follow it, so that something is expected to fail.
    refused: bool,
    cells: Vec<Model>,
}

/// Runs the command; the result is the exit code: 1 when something fails that a product may follow.
pub fn run(which: Which, json: bool) -> u8 {
    let library = match Library::embedded() {
        Ok(library) => library,
        Err(problems) => return show(&problems),
    };
    let rows = rows(&library, which);
    let models: Vec<Model> = rows.iter().flat_map(|row| row.cells.clone()).collect();
    let mut found = match failing_each(&models) {
        Ok(found) => found.into_iter(),
        Err(sentence) => return fail(UNKNOWN, sentence),
    };
    let found: Vec<Vec<Option<Failing>>> =
        rows.iter().map(|row| found.by_ref().take(row.cells.len()).collect()).collect();
    let told: Vec<_> = rows.iter().zip(&found).collect();
    if json {
        print(Value::Array(told.iter().map(|(row, found)| document(row, found)).collect()));
    } else {
        print(format!("P1 to P5; {} compositions\n", models.len()));
        told.iter().for_each(|(row, found)| text(row, found));
    }
    let wrong = told.iter().any(|(row, found)| !row.refused && found.iter().any(Option::is_some));
    if wrong { VIOLATED } else { 0 }
}

fn cells(of: impl Fn(u8, Timing) -> Vec<Model>) -> Vec<Model> {
    let timings = [Timing::Pipelined, Timing::Immediate];
    WATCHDOGS
        .flat_map(|watchdog| timings.map(|timing| (watchdog, timing)))
        .flat_map(|(w, timing)| of(w, timing))
        .collect()
}

fn rows(library: &Library, which: Which) -> Vec<Row> {
    let row = |pair: [Option<Reading>; 2], refused| Row {
        name: named(pair),
        refused,
        cells: cells(|watchdog, timing| vec![read(pair, watchdog, timing)]),
    };
    let alone = |machine: Machine, reading: Reading| match machine {
        Machine::Master => [Some(reading), None],
        Machine::Device => [None, Some(reading)],
    };
    let mut rows = vec![row([None, None], false)];
    for known in library.readings.iter() {
        let refused = known.refused.is_some();
        if !refused || which == Which::All {
            rows.push(row(alone(known.machine, known.reading), refused));
        }
    }
    let may = Machine::ALL.map(|machine| library.readings.of_product(machine));
    if which == Which::All {
        let [masters, devices] = &may;
        let pairs = masters.iter().flat_map(|master| devices.iter().map(|device| [Some(*master), Some(*device)]));
        rows.extend(pairs.map(|pair| row(pair, false)));
    }
    let mixed = |watchdog, timing| mixtures([&may[0], &may[1]], watchdog, timing);
    rows.push(Row { name: "any combination".to_owned(), refused: false, cells: cells(mixed) });
    rows
}

fn named([master, device]: [Option<Reading>; 2]) -> String {
    match (master, device) {
        (None, None) => "default".to_owned(),
        (Some(master), None) => format!("FS-Master {master}"),
        (None, Some(device)) => format!("FS-Device {device}"),
        (Some(master), Some(device)) => format!("FS-Master {master}, FS-Device {device}"),
    }
}

fn text(row: &Row, found: &[Option<Failing>]) {
    let failing: Vec<String> = row
        .cells
        .iter()
        .zip(found)
        .filter_map(|(model, found)| {
            let Failing { timing, property, exchanges } = found.as_ref()?;
            Some(format!("{property} after {exchanges} (watchdog {}, timing {timing})", model.watchdog))
        })
        .collect();
    let verdict = match (failing.is_empty(), row.refused) {
        (true, false) => "holds".to_owned(),
        (true, true) => "refused, but nothing fails here".to_owned(),
        (false, true) => format!("refused: {}", failing.join(", ")),
        (false, false) => format!("FAILS: {}", failing.join(", ")),
    };
    print(format!("{:<52}  {verdict}", row.name));
}

fn document(row: &Row, found: &[Option<Failing>]) -> Value {
    let cell = |(model, found): (&Model, &Option<Failing>)| {
        json!({
            "watchdog": model.watchdog, "timing": model.timing.to_string(),
            "failing": found.as_ref().map(|failing| failing.property),
            "exchanges": found.as_ref().map(|failing| failing.exchanges),
        })
    };
    json!({
        "readings": row.name, "refused": row.refused,
        "cells": row.cells.iter().zip(found).map(cell).collect::<Vec<_>>(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashSet;

    /// Nothing is left out: each row has each watchdog in each timing, and each reading of a product has a row.
    #[test]
    fn the_rows_are_complete() {
        let library = Library::embedded().expect("cases that load");
        let tolerated = rows(&library, Which::Tolerated);
        let [masters, devices] = Machine::ALL.map(|machine| library.readings.of_product(machine).len());
        assert_eq!(tolerated.len(), 1 + masters + devices + 1);
        assert_eq!(rows(&library, Which::All).len(), 1 + library.readings.iter().count() + masters * devices + 1);
        for row in tolerated {
            let cells: HashSet<_> = row.cells.iter().map(|cell| (cell.watchdog, cell.timing.to_string())).collect();
            assert_eq!((cells.len(), row.refused), (2 * WATCHDOGS.count(), false), "{}", row.name);
        }
    }
}
