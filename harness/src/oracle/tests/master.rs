//! One port of an FS-Master told line by line: `says` is an answer of the FS-Device and the SPDU that follows it.

use super::*;
use crate::oracle::{MasterOracle, Oracle};
use fsct_adapters::{Octets, Service};
use fsct_protocol::scl::State;
use rstest::rstest;

/// What the FS-Master shows: its SPDU, and its services at the gateway.
#[derive(Clone, Debug)]
pub struct Shown {
    pub control: (u8, u8, u8),
    pub pdout: [u8; 2],
    pub pdin: [u8; 2],
    pub sdset_s: bool,
    pub ch_f_ack_req_s: bool,
    pub good: bool,
}

/// SD both ways behind a fault: MCount, ChFAckReq.
pub fn fault(mcount: u8, ch_f_ack_req: u8) -> Shown {
    let (control, ch_f_ack_req_s) = ((mcount, 1, ch_f_ack_req), ch_f_ack_req == 1);
    Shown { control, pdout: [0; 2], pdin: [0; 2], sdset_s: true, ch_f_ack_req_s, good: false }
}

/// The first SPDU: T1, T2.
pub fn start() -> Shown {
    fault(0, 0)
}

/// PDout to an FS-Device that is still in SD.
pub fn half(mcount: u8) -> Shown {
    Shown { control: (mcount, 0, 0), pdout: PDOUT, ..fault(mcount, 0) }
}

/// PDout and PDin.
pub fn live(mcount: u8) -> Shown {
    Shown { pdin: PDIN, sdset_s: false, good: true, ..half(mcount) }
}

/// One port with an FS-Device.
pub struct Port {
    pub oracle: MasterOracle,
    pub at: u64,
}

fn octets(value: [u8; 2]) -> Octets {
    Octets::new(&value).expect("two octets")
}

/// A good answer.
pub fn answer(dcount_i: u8, sd_set: u8) -> Vec<u8> {
    d((dcount_i, sd_set, 0, 0), PDIN)
}

impl Port {
    /// Supplied, the preconditions of T1 not fulfilled.
    pub fn idle(setup: Setup) -> Port {
        let mut oracle = MasterOracle::new(setup);
        oracle.power(true);
        oracle.input(Service::PdoutM, &octets(PDOUT));
        Port { oracle, at: 0 }
    }

    /// They are: T1 may be taken.
    pub fn ready(setup: Setup) -> Port {
        let mut port = Port::idle(setup);
        port.oracle.parameterized(port.at);
        port
    }

    /// In regular operation, the SPDU with MCount 4 on its way.
    pub fn operating(setup: Setup) -> Port {
        let mut port = Port::ready(setup);
        assert_eq!(port.exchange(CYCLE, None, &start()), Ok(()));
        port.says(answer(7, 1), half(1));
        port.says(answer(6, 1), half(2));
        port.says(answer(5, 1), half(3));
        port.says(answer(4, 0), live(4));
        port
    }

    /// In state 7 with MCount 5 behind an answer that was hit.
    pub fn faulty(setup: Setup) -> Port {
        let mut port = Port::operating(setup);
        port.says(hit(answer(3, 0)), fault(5, 0));
        port
    }

    pub fn exchange(&mut self, after: u64, received: Option<&[u8]>, shown: &Shown) -> Result<(), Mismatch> {
        self.at += after;
        let (mcount, set_sd, ch_f_ack_req) = shown.control;
        let app = App {
            pdin_m: Octets::new(&shown.pdin),
            sdset_s: Some(shown.sdset_s),
            ch_f_ack_req_s: Some(shown.ch_f_ack_req_s),
            qualifier: Some(shown.good),
            ..App::default()
        };
        self.oracle.exchange(self.at, received, Some(&m(mcount, set_sd, ch_f_ack_req, shown.pdout)), &app)
    }

    #[track_caller]
    pub fn says(&mut self, answer: Vec<u8>, shown: Shown) {
        let verdict = self.exchange(CYCLE, Some(&answer), &shown);
        assert!(verdict.is_ok(), "{shown:?}: {verdict:?}");
    }

    #[track_caller]
    pub fn refuses(&mut self, answer: Vec<u8>, shown: Shown, kind: &str) -> Mismatch {
        refused(self.exchange(CYCLE, Some(&answer), &shown), kind)
    }

    pub fn acknowledges(&mut self, value: bool) {
        self.oracle.input(Service::ChfackC, &Octets::bit(value));
    }

    pub fn used(&self) -> Vec<u8> {
        self.oracle.set().used().iter().collect()
    }
}

#[test]
fn start_up_and_operation() {
    let mut port = Port::operating(strict(Role::Master));
    for mcount in [5, 6, 7, 1, 2] {
        let before = if mcount == 1 { 7 } else { mcount - 1 };
        port.says(answer(7 - before, 0), live(mcount));
    }
    assert_eq!(port.oracle.set().state(), Some(State(5)));
    let oracle = Oracle::Master(Box::new(port.oracle));
    assert_eq!(oracle.taken(), [(1, 1), (2, 1), (3, 1), (4, 9), (5, 9), (6, 8)]);
    assert_eq!(oracle.via(), [6, 4, 5, 0, 0, 0, 0, 0]);
    assert!(oracle.walked().pairs != 0 && oracle.used().is_empty() && !oracle.may_be_starting());
    assert_eq!(oracle.state(), Some(State(5)));
}

#[rstest]
#[case::not_counted("MCount", live(4))]
#[case::counted_twice("MCount", live(6))]
#[case::set_sd("setSD", Shown { control: (5, 1, 0), ..live(5) })]
#[case::ch_f_ack_req("ChFAckReq", Shown { control: (5, 0, 1), ..live(5) })]
#[case::sdout("PDout", Shown { pdout: [0; 2], ..live(5) })]
#[case::other_pdout("PDout", Shown { pdout: PDIN, ..live(5) })]
#[case::sdin("PDin_M", Shown { pdin: [0; 2], ..live(5) })]
#[case::other_pdin("PDin_M", Shown { pdin: PDOUT, ..live(5) })]
#[case::sdset_s("SDset_S", Shown { sdset_s: true, ..live(5) })]
#[case::ch_f_ack_req_s("ChFAckReq_S", Shown { ch_f_ack_req_s: true, ..live(5) })]
#[case::qualifier("qualifier", Shown { good: false, ..live(5) })]
#[case::all_safe("PDin_M", Shown { pdin: [0; 2], sdset_s: true, good: false, ..live(5) })]
fn operation_and_nothing_else(#[case] kind: &str, #[case] shown: Shown) {
    Port::operating(strict(Role::Master)).says(answer(3, 0), live(5));
    Port::operating(strict(Role::Master)).refuses(answer(3, 0), shown, kind);
}

#[rstest]
#[case::hit(hit(answer(3, 0)))]
#[case::not_mirrored(answer(1, 0))]
#[case::d_comm_err(d((3, 1, 1, 0), PDIN))]
#[case::d_timeout(d((3, 1, 0, 1), PDIN))]
#[case::port_number_not_inverted(d_of_port(3))]
fn a_fault_leads_to_sd_both_ways(#[case] bad: Vec<u8>) {
    Port::operating(strict(Role::Master)).says(bad.clone(), fault(5, 0));
    Port::operating(strict(Role::Master)).refuses(bad.clone(), live(5), "setSD");
    Port::operating(strict(Role::Master)).refuses(bad.clone(), Shown { pdout: PDOUT, ..fault(5, 0) }, "PDout");
    Port::operating(strict(Role::Master)).refuses(bad, Shown { pdin: PDIN, ..fault(5, 0) }, "PDin_M");
}

/// A good answer but for its PortNum: not inverted.
fn d_of_port(dcount_i: u8) -> Vec<u8> {
    let wire = fsct_protocol::spdu::Wire {
        pd: Pd::new(&PDIN).expect("two octets"),
        port_num: 1,
        octet: dcount_i << 5,
        signature: None,
    };
    wire.emit(ProtMode::Crc16, Reading::Preset).octets().to_vec()
}

#[test]
fn an_acknowledgment_brings_operation_back() {
    let mut port = Port::faulty(strict(Role::Master));
    port.says(answer(2, 0), fault(6, 1));
    port.says(answer(1, 0), fault(7, 1));
    port.acknowledges(true);
    port.says(answer(0, 0), live(1));
    port.says(answer(6, 0), live(2));
    let taken = Oracle::Master(Box::new(port.oracle)).taken();
    assert_eq!(taken[6..], [(7, 1), (9, 3), (10, 3), (11, 1), (13, 2)]);
}

#[test]
fn no_restart_without_acknowledgment() {
    let mut port = Port::faulty(strict(Role::Master));
    port.says(answer(2, 0), fault(6, 1));
    port.refuses(answer(1, 0), live(7), "setSD");
    // An acknowledgment that stood before the fault is none: ChFAck_C has to be seen at 0.
    let mut port = Port::operating(strict(Role::Master));
    port.acknowledges(true);
    port.says(answer(3, 0), live(5));
    port.says(hit(answer(2, 0)), fault(6, 0));
    port.says(answer(1, 0), fault(7, 1));
    port.refuses(answer(0, 0), live(1), "setSD");
}

#[test]
fn a_short_acknowledgment_may_be_seen_or_missed() {
    let pulse = || {
        let mut port = Port::faulty(strict(Role::Master));
        port.says(answer(2, 0), fault(6, 1));
        port.acknowledges(true);
        port.acknowledges(false);
        port
    };
    let mut missed = pulse();
    missed.says(answer(1, 0), fault(7, 1));
    missed.refuses(answer(0, 0), live(1), "setSD");
    pulse().says(answer(1, 0), live(7));
}

#[test]
fn an_acknowledgment_and_a_fault_at_once() {
    let mut port = Port::faulty(strict(Role::Master));
    port.says(answer(2, 0), fault(6, 1));
    port.acknowledges(true);
    port.says(hit(answer(1, 0)), fault(7, 0));
    // It stands, but has not been seen at 0 since.
    port.says(answer(0, 0), fault(1, 1));
    port.refuses(answer(6, 0), live(2), "setSD");
}

#[test]
fn set_sd_c_gives_sd_both_ways_without_a_fault() {
    let set_sd = Shown { control: (5, 1, 0), pdout: [0; 2], pdin: [0; 2], sdset_s: true, good: false, ..live(5) };
    let asked = || {
        let mut port = Port::operating(strict(Role::Master));
        port.oracle.input(Service::SetsdC, &Octets::bit(true));
        port
    };
    let mut port = asked();
    port.says(answer(3, 0), set_sd);
    port.oracle.input(Service::SetsdC, &Octets::bit(false));
    port.says(answer(2, 0), live(6));
    let mut port = asked();
    // It came between two answers: it may have been looked at before.
    port.says(answer(3, 0), live(5));
    port.refuses(answer(2, 0), live(6), "setSD");
}

#[test]
fn sdset_of_the_answer_gives_sdin_and_leaves_pdout() {
    let mut port = Port::operating(strict(Role::Master));
    port.says(answer(3, 1), half(5));
    port.refuses(answer(2, 1), live(6), "PDin_M");
}

#[test]
fn an_spdu_carries_the_newest_pdout_or_the_one_before() {
    let with = |mcount, pdout| Shown { pdout, ..live(mcount) };
    let mut port = Port::operating(strict(Role::Master));
    port.oracle.input(Service::PdoutM, &octets([1, 1]));
    port.says(answer(3, 0), with(5, PDOUT));
    port.says(answer(2, 0), with(6, [1, 1]));
    let told = port.refuses(answer(1, 0), with(7, PDOUT), "PDout");
    assert_eq!((told.expected.as_str(), told.observed.as_str()), ("PDout 0101 (after T6 T4 T5)", "PDout 1234"));
}

#[test]
fn what_is_no_answer_is_left_alone() {
    let mut port = Port::operating(strict(Role::Master));
    port.says(vec![0; 6], live(4));
    port.says(vec![1; 5], live(4));
    port.says(answer(4, 0), live(4));
    port.says(d((4, 0, 1, 1), [9, 9]), live(4));
    assert_eq!(port.exchange(CYCLE, None, &live(4)), Ok(()));
    port.says(answer(3, 0), live(5));
    let mut port = Port::faulty(strict(Role::Master));
    port.says(answer(5, 0), fault(5, 0));
    port.refuses(answer(5, 0), fault(6, 0), "MCount");
}

#[test]
fn what_stood_in_the_input_image_before_the_first_spdu_may_count_or_be_gone() {
    let first = |shown| Port::ready(strict(Role::Master)).exchange(CYCLE, Some(&answer(7, 1)), &shown);
    assert_eq!((first(start()), first(half(1))), (Ok(()), Ok(())));
    refused(first(half(2)), "MCount");
    let mut port = Port::ready(strict(Role::Master));
    port.says(vec![0; 6], start());
    port.refuses(vec![0; 6], half(1), "MCount");
}

#[rstest]
#[case::a05("MCount", &[5], 7, vec![(vec![0; 6], fault(1, 0))])]
#[case::a06("MCount", &[6], 5, vec![(answer(4, 0), fault(6, 0))])]
#[case::a14("PDin_M", &[14], 5, vec![(answer(2, 0), fault(6, 1)), (answer(1, 0), Shown { pdin: [0; 2], sdset_s: true, good: false, ..live(7) })])]
fn a_reading_behind_a_fault_is_taken_by_its_tolerance_alone(
    #[case] kind: &str,
    #[case] numbers: &[u8],
    #[case] from: u8,
    #[case] lines: Vec<(Vec<u8>, Shown)>,
) {
    let go = |setup| {
        let mut port = Port::faulty(setup);
        for mcount in 6..=from {
            port.says(answer(8 - mcount, 0), fault(mcount, 1));
        }
        let mut last = Ok(());
        for (index, (answer, shown)) in lines.iter().enumerate() {
            if index == 1 {
                port.acknowledges(true);
            }
            last = last.and(port.exchange(CYCLE, Some(answer), shown));
        }
        (last, port.used())
    };
    assert_eq!(go(tolerant(Role::Master, numbers)), (Ok(()), numbers.to_vec()));
    refused(go(strict(Role::Master)).0, kind);
    let others: Vec<u8> = (1..=38).filter(|number| !numbers.contains(number)).collect();
    refused(go(tolerant(Role::Master, &others)).0, kind);
}

#[test]
fn a06_one_foreign_counter_and_no_more() {
    let mut port = Port::faulty(tolerant(Role::Master, &[6]));
    port.says(answer(4, 0), fault(6, 0));
    port.refuses(answer(4, 0), fault(7, 0), "MCount");
    // Operation in between gives another.
    let mut port = Port::faulty(tolerant(Role::Master, &[6]));
    port.says(answer(4, 0), fault(6, 0));
    port.says(answer(1, 0), fault(7, 1));
    port.acknowledges(true);
    port.says(answer(0, 0), live(1));
    port.says(hit(answer(6, 0)), fault(2, 0));
    port.says(answer(4, 0), fault(3, 0));
}

#[test]
fn a13_three_spdus_with_sd_before_the_acknowledgment_counts() {
    let go = |allowed: &[u8], last: Shown| {
        let mut port = Port::faulty(tolerant(Role::Master, allowed));
        // It comes while the request does: seen at 0 and standing from then on.
        port.acknowledges(true);
        port.says(answer(2, 0), fault(6, 1));
        port.says(answer(1, 0), fault(7, 1));
        (port.exchange(CYCLE, Some(&answer(0, 0)), &last), port.used())
    };
    assert_eq!(go(&[13], live(1)), (Ok(()), vec![13]));
    refused(go(&[], live(1)).0, "setSD");
    // It may have been seen at 1 throughout.
    assert_eq!(go(&[], fault(1, 1)), (Ok(()), vec![]));
    let mut port = Port::faulty(strict(Role::Master));
    port.acknowledges(true);
    port.says(answer(2, 0), fault(6, 1));
    port.says(answer(1, 0), live(7));
}

#[test]
fn a13_is_three_spdus_and_no_more() {
    let mut port = Port::faulty(tolerant(Role::Master, &[13]));
    port.says(answer(2, 0), fault(6, 1));
    port.acknowledges(true);
    // It may have come too late to be seen.
    port.says(answer(1, 0), fault(7, 1));
    port.refuses(answer(0, 0), fault(1, 1), "setSD");
    // One that stood before the fault is still none.
    let mut port = Port::operating(tolerant(Role::Master, &[13]));
    port.acknowledges(true);
    port.says(answer(3, 0), live(5));
    port.says(hit(answer(2, 0)), fault(6, 0));
    port.says(answer(1, 0), fault(7, 1));
    port.refuses(answer(0, 0), live(1), "setSD");
}

#[rstest]
#[case::pdin_alone(Shown { pdin: [0; 2], ..live(7) })]
#[case::good(Shown { pdin: [0; 2], sdset_s: true, ..live(7) })]
#[case::live(Shown { sdset_s: true, good: false, ..live(7) })]
fn a14_is_the_safe_state_and_nothing_between(#[case] shown: Shown) {
    let mut port = Port::faulty(tolerant(Role::Master, &[14]));
    port.says(answer(2, 0), fault(6, 1));
    port.acknowledges(true);
    assert!(port.exchange(CYCLE, Some(&answer(1, 0)), &shown).is_err());
}

#[test]
fn a14_is_about_the_spdu_of_t11_alone() {
    let safe = |mcount| Shown { pdin: [0; 2], sdset_s: true, good: false, ..live(mcount) };
    Port::operating(tolerant(Role::Master, &[14])).refuses(answer(3, 0), safe(5), "PDin_M");
}

#[test]
fn an_spdu_may_be_late_by_the_latency_and_never_goes_back() {
    let late = |latency| Port::operating(Setup { latency, ..strict(Role::Master) });
    let next = || answer(3, 0);
    let mut port = late(2);
    port.says(next(), live(4));
    port.says(next(), live(4));
    port.refuses(next(), live(4), "MCount");
    let mut port = late(2);
    port.says(next(), live(4));
    port.says(next(), live(5));
    port.refuses(next(), live(4), "MCount");
}

#[test]
fn a22_sdout_while_the_fs_device_is_in_sd() {
    let sdout = |mcount| Shown { pdout: [0; 2], ..half(mcount) };
    let begin = |allowed: &[u8]| {
        let mut port = Port::ready(tolerant(Role::Master, allowed));
        assert_eq!(port.exchange(CYCLE, None, &start()), Ok(()));
        port.says(answer(7, 1), half(1));
        port
    };
    let mut port = begin(&[22]);
    port.says(answer(6, 1), sdout(2));
    assert_eq!(port.used(), [22]);
    port.says(answer(5, 0), live(3));
    port.refuses(answer(4, 0), Shown { pdout: [0; 2], ..live(4) }, "PDout");
    begin(&[]).refuses(answer(6, 1), sdout(2), "PDout");
    begin(&[14]).refuses(answer(6, 1), sdout(2), "PDout");
    let told = begin(&[22]).refuses(answer(6, 1), Shown { pdout: PDIN, ..half(2) }, "PDout");
    assert_eq!(told.observed, "PDout 5678");
}

#[test]
fn a29_an_error_in_a_repetition() {
    let go = |allowed: &[u8], bad: Vec<u8>| {
        let mut port = Port::operating(tolerant(Role::Master, allowed));
        (port.exchange(CYCLE, Some(&bad), &fault(5, 0)), port.used())
    };
    assert_eq!(go(&[29], hit(answer(4, 0))), (Ok(()), vec![29]));
    refused(go(&[], hit(answer(4, 0))).0, "MCount");
    refused(go(&[29], answer(4, 0)).0, "MCount");
}

#[test]
fn expiry_in_state_7_takes_the_request_back() {
    let mut port = Port::faulty(strict(Role::Master));
    port.says(answer(2, 0), fault(6, 1));
    assert_eq!(port.exchange(WATCHDOG, None, &fault(0, 0)), Ok(()));
    port.says(answer(7, 0), fault(1, 1));
    let mut port = Port::faulty(strict(Role::Master));
    port.says(answer(2, 0), fault(6, 1));
    refused(port.exchange(2 * WATCHDOG, None, &fault(6, 1)), "watchdog/late");
}

#[test]
fn without_supply_nothing_and_before_t1_no_spdu() {
    let app = |pdin, good| App { pdin_m: Octets::new(pdin), qualifier: Some(good), ..nothing() };
    let (safe, spdu) = (app(&[0; 2], false), m(0, 1, 0, [0; 2]));
    let mut off = MasterOracle::new(strict(Role::Master));
    assert_eq!(off.exchange(1, None, Some(&spdu), &app(&PDIN, true)), Ok(()));
    let mut idle = Port::idle(strict(Role::Master)).oracle;
    assert_eq!(idle.exchange(1, None, Some(&[0; 6]), &safe), Ok(()));
    assert_eq!(idle.exchange(1, None, Some(&[0, 0, 0, 0, 0, 0, 0x77]), &safe), Ok(()), "non-safety data");
    refused(idle.exchange(2, None, Some(&spdu), &safe), "idle");
    refused(idle.exchange(2, None, Some(&[1]), &safe), "idle");
    refused(idle.exchange(3, None, None, &app(&PDIN, false)), "PDin_M");
    refused(idle.exchange(4, None, None, &app(&[0; 2], true)), "qualifier");
}

#[test]
fn a_stopped_scl_is_idle_and_supply_off_begins_anew() {
    let mut port = Port::operating(strict(Role::Master));
    port.acknowledges(true);
    port.oracle.input(Service::SetsdC, &Octets::bit(true));
    port.oracle.parameterized(port.at);
    assert_eq!(port.oracle.set().state(), Some(State(5)), "a running one goes on");
    port.oracle.stop();
    assert_eq!(port.oracle.set().state(), None);
    refused(port.exchange(CYCLE, None, &live(5)), "idle");
    port.oracle.power(false);
    port.oracle.stop();
    assert_eq!(port.exchange(CYCLE, None, &live(5)), Ok(()), "without supply nothing is judged");
    port.oracle.power(true);
    port.oracle.parameterized(port.at);
    assert!(port.oracle.set().may_be_starting());
    assert_eq!(port.exchange(CYCLE, None, &start()), Ok(()));
    // The inputs are 0 again, and PDout_M safe.
    port.says(answer(7, 1), Shown { pdout: [0; 2], ..half(1) });
    assert_eq!(Oracle::Master(Box::new(port.oracle)).taken()[0], (1, 2));
}

#[test]
fn the_scl_may_take_its_time_to_start_and_no_longer() {
    let silent = |port: &mut Port| {
        port.at += CYCLE;
        port.oracle.exchange(port.at, None, Some(&[0; 6]), &nothing())
    };
    let mut port = Port::ready(Setup { scl_start_ns: 3 * CYCLE, ..strict(Role::Master) });
    assert_eq!((silent(&mut port), silent(&mut port)), (Ok(()), Ok(())));
    refused(silent(&mut port), "image");
}

#[test]
fn without_upper_tester_the_link_alone_is_judged() {
    let mut port = Port::operating(Setup { app: false, ..strict(Role::Master) });
    port.says(answer(3, 0), Shown { pdout: [9, 9], pdin: [9, 9], sdset_s: true, good: false, ..live(5) });
    port.says(hit(answer(2, 0)), Shown { pdin: [9, 9], good: true, ..fault(6, 0) });
    port.refuses(answer(1, 0), Shown { pdout: PDOUT, ..fault(7, 1) }, "PDout");
    let mut port = Port::operating(Setup { app: false, ..strict(Role::Master) });
    let told = port.refuses(answer(3, 0), Shown { pdout: [9, 9], ..live(6) }, "MCount");
    assert_eq!(told.observed, "MCount 6");
}
