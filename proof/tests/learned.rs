//! A product in place of a side: that of the tables proves what the rows prove, a wrong one is found out.

use fsct_observed::{Mealy, Seen, Side};
use fsct_proof::{Line, Model, Outcome, PROPERTIES, Property, Timing, Verdict, can_stand_in, prove};
use fsct_protocol::Edition;
use rstest::rstest;
use std::sync::Arc;

fn model(watchdog: u8, timing: Timing) -> Model {
    Model { watchdog, timing, ..Model::new(Edition::Iec2022) }
}

fn asked(model: &Model, property: &'static Property) -> (String, u8) {
    let Outcome { verdict, worst, .. } = prove(model, property).expect("it can be explored");
    let verdict = match verdict {
        Verdict::Violated(lines) => format!("violated in {}", lines.len()),
        Verdict::Tables(lines) => format!("tables in {}", lines.len()),
        // How long the way there is hangs on which of many such states is met first.
        Verdict::LockUp(..) => "lock-up".to_owned(),
        Verdict::Holds => "holds".to_owned(),
        Verdict::Unknown => "unknown".to_owned(),
    };
    (verdict, worst)
}

#[rstest]
fn the_machines_of_the_tables_prove_what_the_rows_prove(
    #[values(Side::Device, Side::Master)] side: Side,
    #[values(Timing::Pipelined, Timing::Immediate)] timing: Timing,
) {
    let rows = model(2, timing);
    let table = Some(Arc::new(side.table()));
    let learned = match side {
        Side::Device => Model { device: table, ..rows.clone() },
        Side::Master => Model { master: table, ..rows.clone() },
    };
    for property in PROPERTIES.iter().filter(|property| property.not_asked(&rows).is_none()) {
        assert_eq!(asked(&learned, property), asked(&rows, property), "{}", property.name);
    }
}

/// The table's machine with one output changed where a state and an input give another.
fn altered(side: Side, of: Seen, to: Seen) -> Mealy<Seen> {
    let mut machine = side.table();
    let edges = machine.states.iter_mut().flatten().filter(|edge| edge.output == of);
    assert!(edges.map(|edge| edge.output = to).count() > 0, "the table answers so somewhere");
    machine
}

fn violated(model: &Model, name: &str) -> Vec<Line> {
    let property = PROPERTIES.iter().find(|property| property.name == name).expect("a property");
    match prove(model, property).expect("it can be explored").verdict {
        Verdict::Violated(lines) => lines,
        other => panic!("{name}: {other:?}"),
    }
}

#[test]
fn an_fs_master_that_goes_on_without_acknowledgment_is_found_out() {
    let show = |names: &[&str]| Seen::Answer(Side::Master.showing(names));
    let machine = altered(Side::Master, show(&["setSD", "ChFAckReq"]), show(&["PDout", "PDin_M"]));
    let model = Model { master: Some(Arc::new(machine)), ..model(4, Timing::Pipelined) };
    let lines = violated(&model, "P2");
    assert!(lines.last().is_some_and(|line| line.master.contains("T13 q")), "{lines:?}");
}

#[test]
fn an_fs_device_that_hides_an_error_is_found_out() {
    let show = |names: &[&str]| Seen::Answer(Side::Device.showing(names));
    let of = show(&["SDset", "DCommErr", "setSD_DC"]);
    let machine = altered(Side::Device, of, show(&["PDout_D"]));
    let model = Model { device: Some(Arc::new(machine)), ..model(4, Timing::Pipelined) };
    assert!(!violated(&model, "P2d").is_empty());
    assert!(!violated(&model, "P6-comm").is_empty());
}

#[test]
fn what_no_partner_reads_cannot_stand_in() {
    let table = Side::Device.table();
    assert_eq!(can_stand_in(Side::Device, &table), Ok(()));
    let mut astray = table;
    astray.states[0][0].output = Seen::Astray(Side::Device.showing(&["SDset"]));
    let why = can_stand_in(Side::Device, &astray).expect_err("no partner takes that");
    assert!(why.starts_with("state 0 answers NEXT with what no partner takes (answer with another counter"), "{why}");
}
