//! A scripted FS-Master and the technology in front of an FS-Device.

use super::Trouble;
use super::hand::Hand;
use fsct_adapters::{Octets, Service};
use fsct_observed::device::{Bench, Input};
use fsct_observed::seen::{NOT_INTACT, OTHER_DATA};
use fsct_observed::{Seen, Side, Subject};
use fsct_protocol::spdu::{Control, inv3, succ};

/// Does what a word says; what is seen of each input.
///
/// # Errors
/// [`Trouble`].
pub fn told(mut hand: Hand<'_, '_>, word: &[usize]) -> Result<Vec<Seen>, Trouble> {
    // MCount of the SPDU that was answered last.
    let mut previous = None;
    let inputs = word.iter().filter_map(|number| Bench::INPUTS.get(*number));
    inputs.map(|(_, input)| told_one(&mut hand, &mut previous, *input)).collect()
}

/// The part of the outputs that the technology is given.
#[derive(PartialEq, Eq)]
struct App {
    pdout: Option<Octets>,
    set_sd_dc: Option<bool>,
}

impl App {
    fn now(hand: &Hand<'_, '_>) -> App {
        let app = &hand.session().link().app;
        App { pdout: app.pdout_d, set_sd_dc: app.set_sd_dc }
    }
}

fn told_one(hand: &mut Hand<'_, '_>, previous: &mut Option<u8>, input: Input) -> Result<Seen, Trouble> {
    let before = App::now(hand);
    let (pd_in, pd_out) = (hand.session().setup().pd_in, hand.session().setup().pd_out);
    let (pdin, pdout) = (hand.pattern(pd_in), hand.pattern(pd_out));
    let sdset_ds = matches!(input, Input::Next { sdset_ds: true, .. });
    let sets = [(Service::PdinD, pdin), (Service::SdsetDs, Octets::bit(sdset_ds))];
    let next = previous.map_or(0, succ);
    let count = match input {
        Input::Next { .. } | Input::Corrupt => Some(next),
        Input::Zero if *previous == Some(0) => Some(next),
        Input::Zero => Some(0),
        Input::Jump => Some(succ(succ(next))),
        Input::Old => *previous,
        Input::AllZero | Input::Timeout => None,
    };
    let set_sd = matches!(input, Input::Next { set_sd: true, .. } | Input::Zero);
    let octets = match (input, count) {
        (Input::AllZero, _) => Some(hand.all_zero()),
        (_, Some(mcount)) => {
            let octet = Control { mcount, set_sd, ch_f_ack_req: false }.to_octet();
            hand.spdu(octet, pdout, input != Input::Corrupt)
        }
        (_, None) => None,
    };
    let changed = match input {
        Input::Timeout => hand.time_out(&sets)?,
        _ => hand.offer(&sets, octets)?,
    };
    if changed && count.is_some() {
        *previous = count;
    }
    Ok(seen(hand, changed, *previous, &before, (pdin, pdout)))
}

/// What is seen, given MCount of the SPDU answered last and the process data of this input.
fn seen(
    hand: &Hand<'_, '_>,
    changed: bool,
    previous: Option<u8>,
    before: &App,
    (pdin, pdout): (Octets, Octets),
) -> Seen {
    let app = App::now(hand);
    if !changed && app == *before {
        return Seen::Silent;
    }
    let (setup, view) = (hand.session().setup(), hand.session().answer());
    let mut names = Vec::new();
    let mut show = |name, holds: bool| names.extend(holds.then_some(name));
    let live = app.pdout.filter(|octets| octets.as_slice().iter().any(|octet| *octet != 0));
    show("PDout_D", live.is_some());
    show("setSD_DC", app.set_sd_dc == Some(true));
    let mut other_data = live.is_some_and(|live| live != pdout && (changed || Some(live) != before.pdout));
    let Some(view) = view.filter(|_| changed) else {
        show(OTHER_DATA, other_data);
        let shown = Side::Device.showing(&names);
        return if changed { Seen::Astray(shown) } else { Seen::Aside(shown) };
    };
    let status = view.status();
    show("SDset", status.sd_set);
    show("DCommErr", status.d_comm_err);
    show("DTimeout", status.d_timeout);
    other_data |= view.pd() != pdin.as_slice();
    show(OTHER_DATA, other_data);
    show(NOT_INTACT, !view.signature_matches(setup.reading) || view.port_num() != setup.port.inverted());
    let shown = Side::Device.showing(&names);
    if previous.map(inv3) == Some(status.dcount_i) { Seen::Answer(shown) } else { Seen::Astray(shown) }
}
