//! A scripted FS-Device, the operator and the gateway in front of an FS-Master.

use super::Trouble;
use super::hand::Hand;
use fsct_adapters::{Octets, Service};
use fsct_observed::master::{Bench, Input};
use fsct_observed::seen::{NOT_INTACT, OTHER_DATA};
use fsct_observed::{Seen, Side, Subject};
use fsct_protocol::spdu::{Status, inv3, succ};

/// Does what a word says; what is seen of each input.
///
/// # Errors
/// [`Trouble`].
pub fn told(mut hand: Hand<'_, '_>, word: &[usize]) -> Result<Vec<Seen>, Trouble> {
    // DCount_i of the answer that was taken last.
    let mut given = None;
    let inputs = word.iter().filter_map(|number| Bench::INPUTS.get(*number));
    inputs.map(|(_, input)| told_one(&mut hand, &mut given, *input)).collect()
}

fn told_one(hand: &mut Hand<'_, '_>, given: &mut Option<u8>, input: Input) -> Result<Seen, Trouble> {
    let before = hand.session().link().app.pdin_m;
    let (pd_in, pd_out) = (hand.session().setup().pd_in, hand.session().setup().pd_out);
    let (pdin, pdout) = (hand.pattern(pd_in), hand.pattern(pd_out));
    let mcount = hand.session().answer().map_or(0, |view| view.counter());
    let mirrored = Status { dcount_i: inv3(mcount), ..Status::default() };
    let (ack, set_sd) = match input {
        Input::Good { ack, set_sd, .. } => (ack, set_sd),
        _ => (false, false),
    };
    let status = match input {
        Input::Good { sd_set, .. } => Some(Status { sd_set, ..mirrored }),
        Input::Dtimeout => Some(Status { sd_set: true, d_timeout: true, ..mirrored }),
        Input::DcommErr => Some(Status { sd_set: true, d_comm_err: true, ..mirrored }),
        Input::Corrupt => Some(mirrored),
        Input::Foreign => Some(Status { dcount_i: inv3(succ(succ(mcount))), ..mirrored }),
        Input::Old => {
            given.filter(|dcount_i| *dcount_i != mirrored.dcount_i).map(|dcount_i| Status { dcount_i, ..mirrored })
        }
        Input::AllZero | Input::Timeout => None,
    };
    let octets = match (input, status) {
        (Input::AllZero, _) => Some(hand.all_zero()),
        (_, status) => status.and_then(|status| hand.spdu(status.to_octet(), pdin, input != Input::Corrupt)),
    };
    let sets = [(Service::ChfackC, Octets::bit(ack)), (Service::SetsdC, Octets::bit(set_sd)), (Service::PdoutM, pdout)];
    let changed = match input {
        Input::Timeout => hand.time_out(&sets)?,
        _ => hand.offer(&sets, octets)?,
    };
    if changed && let Some(Status { dcount_i, .. }) = status {
        *given = Some(dcount_i);
    }
    // MCount 0 that stands behind a timeout counts as new, for nobody can see whether it is.
    let awaited = if input == Input::Timeout { 0 } else { succ(mcount) };
    let stands = hand.session().answer().is_some_and(|view| view.counter() == 0);
    let new = changed || input == Input::Timeout && stands;
    Ok(seen(hand, new, awaited, before, (pdin, pdout)))
}

/// What is seen, given the MCount that has to follow and the process data of this input.
fn seen(hand: &Hand<'_, '_>, new: bool, awaited: u8, before: Option<Octets>, (pdin, pdout): (Octets, Octets)) -> Seen {
    let (setup, view) = (hand.session().setup(), hand.session().answer());
    let app = hand.session().link().app.pdin_m;
    if !new && app == before {
        return Seen::Silent;
    }
    let mut names = Vec::new();
    let mut show = |name, holds: bool| names.extend(holds.then_some(name));
    let is_live = |octets: &[u8]| octets.iter().any(|octet| *octet != 0);
    let live = app.filter(|octets| is_live(octets.as_slice()));
    show("PDin_M", live.is_some());
    let mut other_data = live.is_some_and(|live| live != pdin && (new || Some(live) != before));
    let Some(view) = view.filter(|_| new) else {
        show(OTHER_DATA, other_data);
        let shown = Side::Master.showing(&names);
        return if new { Seen::Astray(shown) } else { Seen::Aside(shown) };
    };
    let control = view.control();
    show("setSD", control.set_sd);
    show("ChFAckReq", control.ch_f_ack_req);
    show("PDout", is_live(view.pd()));
    other_data |= is_live(view.pd()) && view.pd() != pdout.as_slice();
    show(OTHER_DATA, other_data);
    show(NOT_INTACT, !view.signature_matches(setup.reading) || view.port_num() != setup.port.number());
    let shown = Side::Master.showing(&names);
    if control.mcount == awaited { Seen::Answer(shown) } else { Seen::Astray(shown) }
}
