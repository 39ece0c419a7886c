//! What a tester sees of a product, which need not be what the tables allow; and both machines of the tables in these terms.

use crate::{Mealy, Subject, device, master};
use fsct_protocol::scl::device::Readings;

/// The side of the link a machine is on.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Side {
    /// FS-Device.
    Device,
    /// FS-Master.
    Master,
}

/// Process data that nobody gave are in use, or in the SPDU.
pub const OTHER_DATA: &str = "other data";
/// Signature or PortNum of the SPDU is wrong.
pub const NOT_INTACT: &str = "not intact";

const OF_DEVICE: &[&str] = &["SDset", "DCommErr", "DTimeout", "PDout_D", "setSD_DC", OTHER_DATA, NOT_INTACT];
const OF_MASTER: &[&str] = &["setSD", "ChFAckReq", "PDout", "PDin_M", OTHER_DATA, NOT_INTACT];

/// What is shown, each as a bit: those of [`Side::outputs`], the first of them the least significant.
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq, Hash)]
pub struct Shown(pub u8);

/// What is seen of an input.
#[derive(Copy, Clone, Debug, PartialEq, Eq, Hash)]
pub enum Seen {
    /// Nothing new.
    Silent,
    /// No new SPDU, but the application is given something else.
    Aside(Shown),
    /// A new SPDU with the counter that has to follow.
    Answer(Shown),
    /// A new SPDU with another counter.
    Astray(Shown),
}

impl Seen {
    /// What is shown; `None`: nothing new.
    pub const fn shown(self) -> Option<Shown> {
        match self {
            Seen::Silent => None,
            Seen::Aside(shown) | Seen::Answer(shown) | Seen::Astray(shown) => Some(shown),
        }
    }
}

impl Side {
    /// Names of the inputs, in the order of their numbers.
    pub fn inputs(self) -> Vec<&'static str> {
        match self {
            Side::Device => device::Bench::INPUTS.iter().map(|(name, _)| *name).collect(),
            Side::Master => master::Bench::INPUTS.iter().map(|(name, _)| *name).collect(),
        }
    }

    /// Names of what may be shown. PDout_D, PDout and PDin_M say that process data are live there, not SD.
    pub const fn outputs(self) -> &'static [&'static str] {
        match self {
            Side::Device => OF_DEVICE,
            Side::Master => OF_MASTER,
        }
    }

    /// What is shown when exactly these are; names it does not have count for nothing.
    pub fn showing(self, names: &[&str]) -> Shown {
        let bits = (0..).zip(self.outputs()).filter(|(_, name)| names.contains(name)).map(|(bit, _)| 1 << bit);
        Shown(bits.sum())
    }

    /// The names of what is shown.
    pub fn names(self, shown: Shown) -> Vec<&'static str> {
        (0..).zip(self.outputs()).filter(|(bit, _)| shown.0 >> bit & 1 == 1).map(|(_, name)| *name).collect()
    }

    /// What is seen, in words.
    pub fn told(self, seen: Seen) -> String {
        let Some(shown) = seen.shown() else { return "nothing new".to_owned() };
        let names = self.names(shown);
        let bit = |name: &&str| format!("{name} {}", u8::from(names.contains(name)));
        let data = |name: &&str| format!("{name} {}", if names.contains(name) { "live" } else { "safe" });
        let words = |words: Vec<String>| words.join(", ");
        let (spdu, link, app) = match self {
            Side::Device => (
                "answer",
                words(["SDset", "DCommErr", "DTimeout"].iter().map(bit).collect()),
                words(vec![data(&"PDout_D"), bit(&"setSD_DC")]),
            ),
            Side::Master => ("SPDU", words(vec![bit(&"setSD"), bit(&"ChFAckReq"), data(&"PDout")]), data(&"PDin_M")),
        };
        let marks: String = [OTHER_DATA, NOT_INTACT]
            .iter()
            .filter(|mark| names.contains(mark))
            .map(|mark| format!("; {mark}"))
            .collect();
        match seen {
            Seen::Aside(_) => format!("no new {spdu}, but {app}{marks}"),
            Seen::Astray(_) => format!("{spdu} with another counter: {link}; {app}{marks}"),
            Seen::Silent | Seen::Answer(_) => format!("{spdu}: {link}; {app}{marks}"),
        }
    }

    /// The machine of the tables, read by default, with states that look alike merged.
    ///
    /// An FS-Master with MCount 0 that times out sends the same SPDU once more, which nobody can see; so where MCount 0 stands behind
    /// TIMEOUT it counts as new. That makes state 2, which waits without limit, look alike there.
    pub fn table(self) -> Mealy<Seen> {
        match self {
            Side::Device => machine(device::Bench::waiting(Readings::default()), |_, _, output| {
                output.map_or(Seen::Silent, |output| Seen::Answer(of_device(output)))
            }),
            Side::Master => machine(master::Bench::waiting(), |bench: &master::Bench, input, output| match output {
                Some(output) => Seen::Answer(of_master(output)),
                None if input == master::Input::Timeout && bench.master.control().mcount == 0 => {
                    Seen::Answer(of_master(bench.output()))
                }
                None => Seen::Silent,
            }),
        }
    }
}

fn machine<S: Subject>(start: S, seen: impl Fn(&S, S::Input, S::Output) -> Seen) -> Mealy<Seen> {
    Mealy::explored(start, S::INPUTS.len(), |subject: &S, number| {
        let mut next = *subject;
        let input = S::INPUTS[number].1;
        let output = next.apply(input);
        (seen(&next, input, output), next)
    })
    .minimal()
}

fn of_device(output: device::Output) -> Shown {
    let device::Output { sd_set, d_comm_err, d_timeout, pdout, set_sd_dc } = output;
    bits(&[sd_set, d_comm_err, d_timeout, pdout, set_sd_dc])
}

fn of_master(output: master::Output) -> Shown {
    let master::Output { set_sd, ch_f_ack_req, pdout, pdin } = output;
    bits(&[set_sd, ch_f_ack_req, pdout, pdin])
}

fn bits(values: &[bool]) -> Shown {
    Shown((0..).zip(values).map(|(bit, value)| u8::from(*value) << bit).sum())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tester_tells_fourteen_and_four_states_apart() {
        assert_eq!(Side::Device.table().states.len(), 14);
        assert_eq!(Side::Master.table().states.len(), 4);
    }

    #[test]
    fn names_and_bits_are_the_same() {
        let shown = Side::Device.showing(&["SDset", "PDout_D"]);
        assert_eq!(shown, Shown(0b1001));
        assert_eq!(Side::Device.names(shown), ["SDset", "PDout_D"]);
        assert_eq!(of_master(master::Bench::waiting().output()), Side::Master.showing(&["setSD"]));
    }
}
