//! An FS-Device told line by line: `says` is an SPDU and the answer to it, `refuses` one that must not be.

use super::*;
use crate::oracle::{DeviceOracle, Oracle};
use crate::walk::Graph;
use fsct_adapters::{Octets, Service};
use fsct_protocol::scl::State;
use rstest::rstest;

/// What the FS-Device shows.
#[derive(Clone, Debug)]
pub struct Shown {
    pub status: (u8, u8, u8, u8),
    pub pdin: [u8; 2],
    pub pdout: [u8; 2],
    pub set_sd_dc: bool,
    pub ch_f_ack_req_dc: bool,
}

/// SD goes to the technology.
pub fn sd(dcount_i: u8, sd_set: u8, d_comm_err: u8, d_timeout: u8) -> Shown {
    let status = (dcount_i, sd_set, d_comm_err, d_timeout);
    Shown { status, pdin: [0; 2], pdout: [0; 2], set_sd_dc: true, ch_f_ack_req_dc: false }
}

/// PDout goes to the technology.
pub fn pdout(dcount_i: u8) -> Shown {
    Shown { pdout: PDOUT, set_sd_dc: false, ..sd(dcount_i, 0, 0, 0) }
}

/// One link with an FS-Device.
pub struct Link {
    pub oracle: DeviceOracle,
    pub at: u64,
}

impl Link {
    /// Supplied, without FSP parameters.
    pub fn idle(setup: Setup) -> Link {
        let mut oracle = DeviceOracle::new(setup);
        oracle.power(true);
        Link { oracle, at: 0 }
    }

    /// With FSP parameters: state 20.
    pub fn ready(setup: Setup) -> Link {
        let mut link = Link::idle(setup);
        link.oracle.parameterized(link.at);
        link
    }

    /// In regular operation, MCount 3 answered last.
    pub fn operating(setup: Setup) -> Link {
        let mut link = Link::ready(setup);
        link.says(0, sd(7, 1, 0, 0));
        link.says(1, sd(6, 1, 0, 0));
        link.says(2, sd(5, 1, 0, 0));
        link.says(3, pdout(4));
        link
    }

    pub fn exchange(&mut self, after: u64, received: Option<&[u8]>, shown: &Shown) -> Result<(), Mismatch> {
        self.at += after;
        let app = App {
            pdout_d: Octets::new(&shown.pdout),
            set_sd_dc: Some(shown.set_sd_dc),
            ch_f_ack_req_dc: Some(shown.ch_f_ack_req_dc),
            ..App::default()
        };
        self.oracle.exchange(self.at, received, Some(&d(shown.status, shown.pdin)), &app)
    }

    #[track_caller]
    pub fn says(&mut self, mcount: u8, shown: Shown) {
        self.takes(&m(mcount, 0, 0, PDOUT), shown);
    }

    #[track_caller]
    pub fn takes(&mut self, spdu: &[u8], shown: Shown) {
        let verdict = self.exchange(CYCLE, Some(spdu), &shown);
        assert!(verdict.is_ok(), "{shown:?}: {verdict:?}");
    }

    #[track_caller]
    pub fn refuses(&mut self, spdu: &[u8], shown: Shown, kind: &str) -> Mismatch {
        refused(self.exchange(CYCLE, Some(spdu), &shown), kind)
    }

    pub fn used(&self) -> Vec<u8> {
        self.oracle.set().used().iter().collect()
    }
}

#[test]
fn start_up_with_three_sd_cycles() {
    let mut link = Link::operating(strict(Role::Device));
    for mcount in [4, 5, 6, 7, 1, 2] {
        link.says(mcount, pdout(7 - mcount));
    }
    assert_eq!(link.oracle.set().state(), Some(State(24)));
    let oracle = Oracle::Device(link.oracle);
    assert_eq!(oracle.taken(), [(20, 1), (21, 1), (22, 10), (23, 10), (24, 9)]);
    assert_eq!(oracle.via(), [24, 22, 23, 0, 0, 0, 0, 0]);
    assert!(oracle.walked().pairs != 0 && oracle.used().is_empty() && !oracle.may_be_starting());
}

#[rstest]
#[case::first("SDset", 0, sd(7, 0, 0, 0))]
#[case::two_cycles_only("SDset", 2, Shown { status: (5, 0, 0, 0), ..sd(5, 1, 0, 0) })]
#[case::live_in_the_third("PDout_D", 2, Shown { pdout: PDOUT, ..sd(5, 1, 0, 0) })]
#[case::error("DCommErr", 1, sd(6, 1, 1, 0))]
#[case::timeout("DTimeout", 1, sd(6, 1, 0, 1))]
#[case::not_mirrored("DCount_i", 1, sd(1, 1, 0, 0))]
#[case::other_pdin("PDin", 1, Shown { pdin: PDIN, ..sd(6, 1, 0, 0) })]
#[case::set_sd_dc("setSD_DC", 1, Shown { set_sd_dc: false, ..sd(6, 1, 0, 0) })]
#[case::ch_f_ack_req_dc("ChFAckReq_DC", 1, Shown { ch_f_ack_req_dc: true, ..sd(6, 1, 0, 0) })]
fn start_up_and_nothing_else(#[case] kind: &str, #[case] mcount: u8, #[case] shown: Shown) {
    let mut link = Link::ready(strict(Role::Device));
    for before in 0..mcount {
        link.says(before, sd(7 - before, 1, 0, 0));
    }
    link.refuses(&m(mcount, 0, 0, PDOUT), shown, kind);
}

#[test]
fn a_crc_error_is_worked_off_in_five_answers() {
    let mut link = Link::operating(strict(Role::Device));
    link.takes(&hit(m(4, 0, 0, PDOUT)), sd(3, 1, 1, 0));
    link.says(5, sd(2, 1, 1, 0));
    link.says(6, sd(1, 1, 0, 0));
    link.says(7, sd(0, 1, 0, 0));
    // setSD_DC may be either at T28 (A20).
    link.says(1, sd(6, 0, 0, 0));
    link.says(2, pdout(5));
    let taken = Oracle::Device(link.oracle).taken();
    assert_eq!(taken[5..], [(25, 1), (26, 4), (27, 4), (28, 1), (29, 3)]);
}

#[rstest]
#[case::not_reported("DCommErr", 4, sd(3, 1, 0, 0))]
#[case::reported_once("DCommErr", 5, sd(2, 1, 0, 0))]
#[case::reported_for_ever("DCommErr", 6, sd(1, 1, 1, 0))]
#[case::two_sd_cycles("SDset", 7, sd(0, 0, 0, 0))]
#[case::live_at_t28("PDout_D", 1, Shown { pdout: PDOUT, ..sd(6, 0, 0, 0) })]
fn a_crc_error_and_nothing_else(#[case] kind: &str, #[case] mcount: u8, #[case] shown: Shown) {
    let mut link = Link::operating(strict(Role::Device));
    let good = [(5, sd(2, 1, 1, 0)), (6, sd(1, 1, 0, 0)), (7, sd(0, 1, 0, 0))];
    let bad = hit(m(4, 0, 0, PDOUT));
    if mcount == 4 {
        link.refuses(&bad, shown, kind);
        return;
    }
    link.takes(&bad, sd(3, 1, 1, 0));
    for (mcount, shown) in good.into_iter().take_while(|line| line.0 != mcount) {
        link.says(mcount, shown);
    }
    link.refuses(&m(mcount, 0, 0, PDOUT), shown, kind);
}

#[rstest]
#[case::signature(hit(m(4, 0, 0, PDOUT)))]
#[case::port_num(OutSpdu { pd: Pd::new(&PDOUT).unwrap(), port: Port::new(2).unwrap(), control: Control { mcount: 4, set_sd: false, ch_f_ack_req: false } }.wire().emit(ProtMode::Crc16, Reading::Preset).octets().to_vec())]
#[case::counter(m(6, 0, 0, PDOUT))]
fn what_the_checks_look_at_must_not_pass_unseen(#[case] spdu: Vec<u8>) {
    let mcount = spdu[3] >> 5;
    Link::operating(strict(Role::Device)).takes(&spdu, sd(7 - mcount, 1, 1, 0));
    let mut link = Link::operating(strict(Role::Device));
    link.refuses(&spdu, pdout(7 - mcount), "DCommErr");
}

#[test]
fn a_repetition_is_left_alone() {
    let mut link = Link::operating(strict(Role::Device));
    link.says(3, pdout(4));
    link.takes(&m(3, 0, 0, [0xAA, 0xAA]), pdout(4));
    link.refuses(&m(3, 0, 0, PDOUT), sd(4, 1, 1, 0), "DCommErr");
}

#[test]
fn mcount_0_in_operation_is_taken_once() {
    let mut link = Link::operating(strict(Role::Device));
    link.says(0, pdout(7));
    link.says(0, pdout(7));
    link.says(1, pdout(6));
}

#[test]
fn spdus_of_all_zero_and_too_short_are_none() {
    let mut link = Link::operating(strict(Role::Device));
    link.takes(&[0; 6], pdout(4));
    link.takes(&[0x12, 0x34, 1], pdout(4));
    let verdict = link.exchange(CYCLE, None, &pdout(4));
    assert_eq!(verdict, Ok(()));
    link.says(4, pdout(3));
}

#[test]
fn set_sd_gives_sd_without_sdset() {
    let mut link = Link::operating(strict(Role::Device));
    link.takes(&m(4, 1, 1, [0; 2]), Shown { ch_f_ack_req_dc: true, ..sd(3, 0, 0, 0) });
    link.says(5, pdout(2));
    link.refuses(&m(6, 1, 0, PDOUT), Shown { pdout: PDOUT, ..sd(1, 0, 0, 0) }, "PDout_D");
}

#[test]
fn an_answer_carries_the_newest_pdin_or_the_one_before() {
    let given = |value: [u8; 2]| Octets::new(&value).expect("two octets");
    let with = |dcount_i, pdin| Shown { pdin, ..pdout(dcount_i) };
    let mut link = Link::operating(strict(Role::Device));
    link.oracle.input(Service::PdinD, &given(PDIN));
    link.says(4, with(3, PDIN));
    link.oracle.input(Service::PdinD, &given([1, 1]));
    link.says(5, with(2, PDIN));
    link.says(6, with(1, [1, 1]));
    let mismatch = link.refuses(&m(7, 0, 0, PDOUT), with(0, PDIN), "PDin");
    assert_eq!(
        (mismatch.expected.as_str(), mismatch.observed.as_str()),
        ("PDin 0101 (after T24 T22 T23)", "PDin 5678")
    );
}

#[test]
fn sdset_ds_shows_at_the_latest_in_the_second_answer() {
    let with = |dcount_i| Shown { status: (dcount_i, 1, 0, 0), ..pdout(dcount_i) };
    let mut link = Link::operating(tolerant(Role::Device, &[21]));
    link.oracle.input(Service::SdsetDs, &Octets::bit(true));
    link.says(4, pdout(3));
    link.says(5, with(2));
    link.oracle.input(Service::SdsetDs, &Octets::bit(true));
    link.refuses(&m(6, 0, 0, PDOUT), pdout(1), "SDset");

    // A repetition is no new answer.
    let mut link = Link::operating(tolerant(Role::Device, &[21]));
    link.oracle.input(Service::SdsetDs, &Octets::bit(true));
    link.says(3, pdout(4));
    link.says(4, pdout(3));

    let mut link = Link::operating(strict(Role::Device));
    link.oracle.input(Service::SdsetDs, &Octets::bit(true));
    link.refuses(&m(4, 0, 0, PDOUT), pdout(3), "SDset");
}

#[test]
fn without_supply_nothing_is_judged() {
    let mut oracle = DeviceOracle::new(strict(Role::Device));
    let live = App { pdout_d: Octets::new(&PDOUT), ..nothing() };
    assert_eq!(oracle.exchange(1, None, Some(&[0xFF; 6]), &live), Ok(()));
}

#[test]
fn before_fsp_parameterization_nothing_is_answered() {
    let safe = App { pdout_d: Octets::new(&[0; 2]), ..nothing() };
    let live = App { pdout_d: Octets::new(&PDOUT), ..nothing() };
    let mut link = Link::idle(strict(Role::Device));
    let first = m(0, 0, 0, PDOUT);
    assert_eq!(link.oracle.exchange(1, Some(&first), Some(&[0; 6]), &safe), Ok(()));
    assert_eq!(link.oracle.exchange(2, Some(&first), None, &nothing()), Ok(()));
    refused(link.oracle.exchange(3, Some(&first), Some(&d((7, 1, 0, 0), [0; 2])), &safe), "idle");
    refused(link.oracle.exchange(4, Some(&first), None, &live), "PDout_D");
}

#[test]
fn the_scl_may_take_its_time_to_start_and_no_longer() {
    let setup = || Setup { scl_start_ns: 3 * CYCLE, ..strict(Role::Device) };
    let silent = |link: &mut Link| {
        link.at += CYCLE;
        let spdu = m(0, 0, 0, PDOUT);
        let safe = App { pdout_d: Octets::new(&[0; 2]), ..nothing() };
        link.oracle.exchange(link.at, Some(&spdu), Some(&[0; 6]), &safe)
    };
    let mut link = Link::ready(setup());
    assert!(link.oracle.set().may_be_starting());
    assert_eq!((silent(&mut link), silent(&mut link)), (Ok(()), Ok(())));
    assert!(link.oracle.set().may_be_starting());
    refused(silent(&mut link), "image");
    let mut link = Link::ready(setup());
    assert_eq!(silent(&mut link), Ok(()));
    link.says(0, sd(7, 1, 0, 0));
}

#[test]
fn an_answer_may_be_late_by_the_latency_and_never_goes_back() {
    let late = |latency| Link::operating(Setup { latency, ..strict(Role::Device) });
    let mut link = late(2);
    let next = m(4, 0, 0, PDOUT);
    link.takes(&next, pdout(4));
    link.takes(&next, pdout(4));
    let mismatch = link.refuses(&next, pdout(4), "DCount_i");
    assert!(mismatch.expected.starts_with("DCount_i 3"), "{mismatch:?}");
    let mut link = late(2);
    link.takes(&next, pdout(4));
    link.takes(&next, pdout(3));
    link.refuses(&next, pdout(4), "DCount_i");
}

#[test]
fn supply_off_and_on_begins_anew_and_what_was_taken_stays_counted() {
    let mut link = Link::operating(strict(Role::Device));
    link.oracle.input(Service::PdinD, &Octets::new(&PDIN).expect("two octets"));
    link.oracle.input(Service::SdsetDs, &Octets::bit(true));
    link.oracle.power(false);
    assert_eq!(link.oracle.set().state(), None);
    link.oracle.power(true);
    link.oracle.parameterized(link.at);
    for mcount in 0..3 {
        link.says(mcount, sd(7 - mcount, 1, 0, 0));
    }
    link.says(3, pdout(4));
    let oracle = Oracle::Device(link.oracle);
    assert_eq!(oracle.taken(), [(20, 2), (21, 2), (22, 8), (23, 8), (24, 6)]);
}

#[test]
fn without_upper_tester_the_link_alone_is_judged() {
    let mut link = Link::operating(Setup { app: false, ..tolerant(Role::Device, &[11]) });
    link.says(4, Shown { pdin: PDIN, set_sd_dc: true, ..sd(3, 0, 0, 0) });
    link.says(5, Shown { status: (2, 1, 0, 0), ..pdout(2) });
    let mismatch = link.refuses(&m(6, 0, 0, PDOUT), Shown { status: (1, 0, 1, 0), pdin: PDIN, ..pdout(1) }, "DCommErr");
    assert!(!mismatch.observed.contains("PDin"), "{mismatch:?}");
}

/// Pairs of steps walked, as transitions with the outcome of the checks where those do not tell.
fn walked(link: &Link) -> Vec<String> {
    let graph = Graph::role(Role::Device);
    let walked = link.oracle.set().walked().step_pairs;
    let step = |place: u8| {
        let step = &graph.steps[usize::from(place)];
        let taken: Vec<String> = step.taken.iter().map(|t| t.to_string()).collect();
        format!("{}{}", taken.join(" "), step.error.map_or("", |error| if error { " bad" } else { " good" }))
    };
    let pairs = graph.step_pairs.iter().enumerate().filter(|(at, _)| walked >> at & 1 == 1);
    pairs.map(|(_, [first, second])| format!("{}, {}", step(*first), step(*second))).collect()
}

#[test]
fn an_error_while_errors_are_worked_off_is_a_way_of_its_own() {
    let error = |second: Vec<u8>| {
        let mut link = Link::operating(strict(Role::Device));
        link.takes(&hit(m(4, 0, 0, PDOUT)), sd(3, 1, 1, 0));
        link.takes(&second, sd(2, 1, 1, 0));
        walked(&link)
    };
    let (bad, good) = (error(hit(m(5, 0, 0, PDOUT))), error(m(5, 0, 0, PDOUT)));
    assert!(bad.contains(&"T24 T25 T26, T27 T29 T26 bad".to_owned()), "{bad:?}");
    assert!(good.contains(&"T24 T25 T26, T27 T29 T26 good".to_owned()), "{good:?}");
    assert!(bad.iter().filter(|pair| good.contains(pair)).all(|pair| !pair.contains("T29")));
}
