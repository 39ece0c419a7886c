//! Machines and differences as `learned.json` holds them.

use fsct_observed::{Difference, Edge, Mealy, Seen, Side, compared};
use fsct_reports::learned as file;

/// A machine as it stands in the file.
pub fn machine(side: Side, machine: &Mealy<Seen>) -> file::Machine {
    let edge = |edge: &Edge<Seen>| file::Edge {
        spdu: match edge.output {
            Seen::Silent | Seen::Aside(_) => file::Spdu::Same,
            Seen::Answer(_) => file::Spdu::New,
            Seen::Astray(_) => file::Spdu::OtherCounter,
        },
        shows: edge.output.shown().map(|shown| side.names(shown).into_iter().map(str::to_owned).collect()),
        next: edge.next,
    };
    file::Machine { states: machine.states.iter().map(|edges| edges.iter().map(edge).collect()).collect() }
}

/// The differences from the machine of the tables.
pub fn differences(side: Side, machine: &Mealy<Seen>, table: &Mealy<Seen>) -> Vec<file::Difference> {
    let inputs = side.inputs();
    let differences = compared(machine, table);
    let told = differences.into_iter().filter_map(|Difference { word, at }| {
        let last = *word.last()?;
        Some(file::Difference {
            word: word.iter().filter_map(|input| inputs.get(*input)).map(|name| (*name).to_owned()).collect(),
            states: at,
            table: side.told(table.edge(at.1, last).output),
            dut: side.told(machine.edge(at.0, last).output),
        })
    });
    told.collect()
}

/// The machine of a file.
///
/// # Errors
/// One sentence for the user about what does not fit.
pub fn read(file: &file::Learned) -> Result<(Side, Mealy<Seen>), String> {
    if file.schema != file::SCHEMA {
        return Err(format!("it is no learned machine: its schema is `{}`, not `{}`", file.schema, file::SCHEMA));
    }
    let side = match file.dut.role.as_str() {
        "device" => Side::Device,
        "master" => Side::Master,
        other => return Err(format!("its DUT is a `{other}`; device and master are known")),
    };
    let inputs = side.inputs();
    if file.inputs != inputs {
        return Err(format!("its inputs are not {}", inputs.join(", ")));
    }
    let states = &file.machine.states;
    if states.is_empty() {
        return Err("its machine has no state".to_owned());
    }
    let edge = |at: usize, edge: &file::Edge| {
        if edge.next >= states.len() {
            return Err(format!("state {at} leads to state {}, of {} states", edge.next, states.len()));
        }
        let names: Vec<&str> = edge.shows.iter().flatten().map(String::as_str).collect();
        if let Some(unknown) = names.iter().find(|name| !side.outputs().contains(name)) {
            return Err(format!("state {at} shows `{unknown}`; {} are known", side.outputs().join(", ")));
        }
        let shown = side.showing(&names);
        let output = match (edge.spdu, &edge.shows) {
            (file::Spdu::Same, None) => Seen::Silent,
            (file::Spdu::Same, Some(_)) => Seen::Aside(shown),
            (file::Spdu::New, _) => Seen::Answer(shown),
            (file::Spdu::OtherCounter, _) => Seen::Astray(shown),
        };
        Ok(Edge { output, next: edge.next })
    };
    let state = |(at, edges): (usize, &Vec<file::Edge>)| {
        if edges.len() != inputs.len() {
            return Err(format!("state {at} has {} edges, of {} inputs", edges.len(), inputs.len()));
        }
        edges.iter().map(|one| edge(at, one)).collect()
    };
    Ok((side, Mealy { states: states.iter().enumerate().map(state).collect::<Result<_, _>>()? }))
}
