//! The oracle against FS-Devices that read the open points of the standard in another way: what is tolerated is a remark
//! with its tolerance named, what locks up or accepts wrong data fails.
//!
//! The devices here step the rows of Table 40 themselves, with one reading changed.

mod common;

use common::{library, run_with, story};
use fsct_adapters::{
    Clock, ClockKind, Description, Dut, DutError, Observation, Octets, Pco, Role, Seen, Service, Stimulus, Variant,
};
use fsct_harness::library::EVERYTHING;
use fsct_harness::plan::Selection;
use fsct_protocol::crc::Reading;
use fsct_protocol::scl::device::{Readings, Received};
use fsct_protocol::scl::{Device, State, Var};
use fsct_protocol::spdu::{InSpdu, Pd, Port, View, succ};
use fsct_reports::record::{CaseRecord, Verdict};
use rstest::rstest;

/// How a device reads the standard.
#[derive(Copy, Clone, Debug, Default)]
struct Way {
    readings: Readings,
    /// A09 "exactly +1": MCount 0 in operation is ignored.
    exactly_next: bool,
    /// A29: an error is found in an SPDU with the previous counter.
    old_errors_trip: bool,
    /// A31: the first SPDU may carry 1.
    first_may_be_1: bool,
    /// A08 alone: the previous SPDU is the last valid one, DCount_i is what was received.
    previous_valid_alone: bool,
    /// A18: an image that is not zero while waiting for the first SPDU.
    early_image: bool,
    /// A28: PDin is zero while SDset is 1.
    zero_with_sd_set: bool,
    /// A jump is taken as good.
    jumps_accepted: bool,
    /// Start value as a leading octet (A02).
    leading_octet: bool,
    /// Takes 5 ms to start its SCL.
    starts_late: bool,
    /// Its technology reports its safe state for two answers more than it has to.
    lingers: bool,
    /// Serves supply, link and clock alone, and starts its SCL by itself.
    link_only: bool,
}

struct TableDevice {
    way: Way,
    variant: Variant,
    now: u64,
    on: bool,
    scl: Option<Device>,
    starts_at: u64,
    lingering: u8,
    last_valid: Option<u8>,
    deadline: Option<u64>,
    pdin: Octets,
    received: Pd,
    answer: Option<Octets>,
    /// FSP_Watchdog of the verify record.
    watchdog_ns: u64,
}

/// FSP_Watchdog where nothing was written.
const WATCHDOG_NS: u64 = 20_000_000;

impl TableDevice {
    fn new(way: Way) -> TableDevice {
        let variant = Variant { edition: EVERYTHING[0].edition, mode: EVERYTHING[0].mode, pd_out: 2, pd_in: 2 };
        TableDevice {
            way,
            variant,
            now: 0,
            on: false,
            scl: None,
            starts_at: 0,
            lingering: 0,
            last_valid: None,
            deadline: None,
            pdin: Octets::zero(2),
            received: Pd::safe(2),
            answer: None,
            watchdog_ns: WATCHDOG_NS,
        }
    }

    fn start(&mut self) {
        let mut scl = Device::new(self.way.readings);
        scl.start();
        self.scl = Some(scl);
        self.starts_at = self.now + if self.way.starts_late { 5_000_000 } else { 0 };
    }

    fn reading(&self) -> Reading {
        if self.way.leading_octet { Reading::LeadingOctet } else { Reading::Preset }
    }

    fn receive(&mut self, octets: &[u8]) {
        let (way, reading, now) = (self.way, self.reading(), self.now);
        let Some(scl) = &mut self.scl else { return };
        let Ok(view) = View::new(octets, self.variant.mode, self.variant.pd_out.into()) else { return };
        if view.is_all_zero() || now < self.starts_at {
            return;
        }
        let control = view.control();
        let intact = view.signature_matches(reading) && view.port_num() == 1;
        let received = Received { control, intact };
        let first = scl.state() == State(21);
        let previous = if way.previous_valid_alone { self.last_valid } else { scl.previous() };
        let old = !first && previous == Some(control.mcount);
        let next = previous.is_some_and(|previous| control.mcount == succ(previous));
        let path = if old {
            if intact || !way.old_errors_trip {
                return;
            }
            scl.process(received, false)
        } else if !first && way.exactly_next && !next {
            return;
        } else if intact && (first && way.first_may_be_1 && control.mcount == 1 || !first && way.jumps_accepted) {
            scl.process(received, true)
        } else if way.previous_valid_alone {
            let valid = intact && (if first { control.mcount == 0 } else { control.mcount == 0 || next });
            scl.process(received, valid)
        } else {
            scl.receive(received)
        };
        if path.is_empty() {
            return;
        }
        if scl.get(Var::CommErr) == 0 {
            self.last_valid = Some(control.mcount);
        }
        self.received = Pd::new(view.pd()).expect("as long as before");
        self.deadline = Some(now + self.watchdog_ns);
        self.send();
    }

    fn expire(&mut self) {
        while let Some(deadline) = self.deadline.filter(|deadline| *deadline <= self.now) {
            if let Some(scl) = &mut self.scl {
                scl.expire();
            }
            self.deadline = Some(deadline + self.watchdog_ns);
            self.send();
        }
    }

    fn send(&mut self) {
        let Some(scl) = &self.scl else { return };
        let mut status = scl.status();
        if self.way.lingers {
            self.lingering = if status.sd_set { 2 } else { self.lingering.saturating_sub(1) };
            status.sd_set |= self.lingering > 0;
        }
        let pd = Pd::new(self.pdin.as_slice()).expect("at most 25 octets");
        let pd = if self.way.zero_with_sd_set && status.sd_set { Pd::safe(pd.octets().len()) } else { pd };
        let spdu = InSpdu { pd, port: Port::ONE, status };
        self.answer = Octets::new(spdu.wire().emit(self.variant.mode, self.reading()).octets());
    }

    fn image(&self) -> Octets {
        let length = self.variant.mode.spdu_octets(self.variant.pd_in.into());
        match (self.answer, &self.scl) {
            (Some(answer), _) => answer,
            (None, Some(_)) if self.way.early_image => Octets::new(&vec![0x55; length]).expect("at most 31"),
            _ => Octets::zero(length),
        }
    }

    fn services(&self) -> [(Service, Octets); 3] {
        let bit = |var| self.scl.is_some_and(|scl| self.answer.is_some() && scl.get(var) == 1);
        let live = self.scl.is_some_and(|scl| scl.uses_pdout());
        let safe = Pd::safe(self.variant.pd_out.into());
        let pdout = if live { self.received } else { safe };
        [
            (Service::PdoutD, Octets::new(pdout.octets()).expect("at most 25 octets")),
            (Service::SetsdDc, Octets::bit(bit(Var::SetSdDc))),
            (Service::ChfackreqDc, Octets::bit(bit(Var::ChFAckReqDc))),
        ]
    }
}

impl Dut for TableDevice {
    fn hello(&mut self) -> Result<Description, DutError> {
        Ok(Description {
            role: Role::Device,
            ports: 1,
            pcos: match self.way.link_only {
                true => vec![Pco::Power, Pco::Link, Pco::Clock],
                false => vec![Pco::Power, Pco::Link, Pco::Acyclic, Pco::App, Pco::Clock],
            },
            offers: EVERYTHING.to_vec(),
            clock: Clock { kind: ClockKind::Virtual, resolution_ns: 1, uncertainty_ns: 0 },
            vendor: "test".into(),
            product: format!("{:?}", self.way),
            version: String::new(),
        })
    }

    fn apply(&mut self, stimuli: &[Stimulus], observed: &mut Vec<Observation>) -> Result<(), DutError> {
        for (position, stimulus) in stimuli.iter().enumerate() {
            let mut seen = Vec::new();
            match stimulus {
                Stimulus::Configure(variant) => {
                    self.variant = *variant;
                    self.pdin = Octets::zero(variant.pd_in.into());
                }
                Stimulus::Power(on) => {
                    *self = TableDevice { variant: self.variant, now: self.now, on: *on, ..TableDevice::new(self.way) };
                    self.pdin = Octets::zero(self.variant.pd_in.into());
                    self.received = Pd::safe(self.variant.pd_out.into());
                    if *on && self.way.link_only {
                        self.start();
                    }
                }
                Stimulus::Set { .. } | Stimulus::Read { .. } | Stimulus::Write { .. } if self.way.link_only => {
                    seen.push(Seen::Unsupported);
                }
                Stimulus::Advance { ns } => {
                    self.now += ns;
                    self.expire();
                }
                Stimulus::Set { service: Service::PdinD, value, .. } => self.pdin = *value,
                Stimulus::Set { service: Service::SdsetDs, value, .. } => {
                    if let Some(scl) = &mut self.scl {
                        scl.set_sdset_ds(value.is_set());
                    }
                }
                Stimulus::Read { .. } => seen.push(Seen::Value(vec![0; 12])),
                Stimulus::Write { index, data, .. } => {
                    if *index == 0x4202 {
                        let ms = data.get(13..15).map_or(0, |ms| u64::from(ms[0]) << 8 | u64::from(ms[1]));
                        self.watchdog_ns = ms * 1_000_000;
                        self.start();
                    }
                    seen.push(Seen::Written);
                }
                Stimulus::Exchange { octets, .. } => {
                    if let Some(octets) = octets {
                        self.receive(octets.as_slice());
                    }
                }
                _ => seen.push(Seen::Unsupported),
            }
            if self.on && !self.way.link_only {
                let service = |(service, value)| Seen::Service { port: 1, service, value };
                seen.extend(self.services().into_iter().map(service));
            }
            if let Stimulus::Exchange { .. } = stimulus {
                seen.push(Seen::Image { port: 1, octets: self.on.then(|| self.image()) });
            }
            let stimulus = position as u16;
            observed.extend(seen.into_iter().map(|seen| Observation { stimulus, at: self.now, seen }));
        }
        Ok(())
    }
}

fn judged(way: Way) -> Vec<CaseRecord> {
    let profile = if way.starts_late { "device-slow-start" } else { "reference-device" };
    let mut library = library();
    // The rows know nothing of parameters: any record starts the SCL here.
    const PARAMETERS: [&str; 4] =
        ["device-parameters", "device-indices", "device-data-storage", "device-verify-record"];
    library.suites.retain(|suite| !PARAMETERS.contains(&&*suite.name) && suite.group.as_deref() != Some("annex-g"));
    run_with(&library, &Selection::default(), profile, || Box::new(TableDevice::new(way)))
}

#[rstest]
#[case::at_once(false)]
#[case::delayed_start(true)]
fn the_rows_themselves_conform(#[case] starts_late: bool) {
    let way = Way { starts_late, ..Way::default() };
    let others: Vec<CaseRecord> = judged(way).into_iter().filter(|case| case.verdict != Verdict::Pass).collect();
    assert!(others.is_empty(), "{}", story(&others[..others.len().min(20)]));
}

#[rstest]
#[case::last_valid(Way { readings: Readings { last_valid: true, ..Readings::default() }, ..Way::default() }, &["A08", "A16"])]
#[case::jump_ignored(Way { readings: Readings { jump_ignored: true, ..Readings::default() }, ..Way::default() }, &["A09"])]
#[case::sequential(Way { readings: Readings { sequential: true, ..Readings::default() }, ..Way::default() }, &["A19"])]
#[case::old_errors_trip(Way { old_errors_trip: true, ..Way::default() }, &["A29"])]
#[case::first_may_be_1(Way { first_may_be_1: true, ..Way::default() }, &["A31"])]
#[case::early_image(Way { early_image: true, ..Way::default() }, &["A18"])]
#[case::zero_with_sd_set(Way { zero_with_sd_set: true, ..Way::default() }, &[])]
fn a_tolerated_reading_is_a_remark_with_its_name(#[case] way: Way, #[case] named: &[&str]) {
    // What iec2022 settles, it settles; and the chart of a restart without acknowledgment excuses nobody.
    let sequential = way.readings.sequential;
    let relevant = |case: &CaseRecord| {
        !(way.first_may_be_1 && case.variant.edition == "iec2022" || sequential && case.suite == "proof")
    };
    let cases: Vec<CaseRecord> = judged(way).into_iter().filter(relevant).collect();
    let worse: Vec<CaseRecord> = cases.iter().filter(|case| case.verdict > Verdict::Remark).cloned().collect();
    assert!(worse.is_empty(), "{}", story(&worse[..worse.len().min(20)]));
    for id in named {
        assert!(cases.iter().any(|case| case.tolerances.contains_key(*id)), "{id} is never named");
    }
    let others: Vec<&String> =
        cases.iter().flat_map(|case| case.tolerances.keys()).filter(|id| !named.contains(&id.as_str())).collect();
    assert!(others.is_empty(), "other tolerances are named: {others:?}");
}

/// The tolerance for A19 is one for an answer less with DCommErr or DTimeout, not for an error of which the FS-Master never hears.
#[test]
fn an_error_that_is_forgotten_is_no_matter_of_tolerance() {
    let selection = Selection { suites: vec!["proof".into()], ..Selection::default() };
    let of = |sequential| {
        let way = Way { readings: Readings { sequential, ..Readings::default() }, ..Way::default() };
        run_with(&library(), &selection, "reference-device", || Box::new(TableDevice::new(way)))
    };
    let (default, sequential) = (of(false), of(true));
    assert!(!default.is_empty() && default.iter().all(|case| case.verdict == Verdict::Pass), "{}", story(&default));
    assert!(sequential.iter().all(|case| case.verdict == Verdict::Fail), "{}", story(&sequential));
    assert!(
        sequential.iter().flat_map(|case| &case.reasons).all(|reason| reason.clause.contains("11.5.3 Table 40 T29"))
    );
}

#[rstest]
#[case::exactly_next(Way { exactly_next: true, ..Way::default() })]
#[case::previous_valid_alone(Way { previous_valid_alone: true, ..Way::default() })]
#[case::jumps_accepted(Way { jumps_accepted: true, ..Way::default() })]
#[case::first_may_be_1(Way { first_may_be_1: true, ..Way::default() })]
fn a_reading_that_locks_up_or_accepts_wrong_data_fails(#[case] way: Way) {
    let failed = judged(way).into_iter().filter(|case| case.verdict == Verdict::Fail).count();
    assert!(failed > 0, "{way:?} fails no case");
}

#[test]
fn the_other_reading_of_the_start_value_is_inconclusive_and_named() {
    let cases = judged(Way { leading_octet: true, ..Way::default() });
    let wrong: Vec<CaseRecord> = cases.iter().filter(|case| case.verdict != Verdict::Inconclusive).cloned().collect();
    assert!(wrong.is_empty(), "{}", story(&wrong[..wrong.len().min(20)]));
    assert!(cases.iter().any(|case| case.reasons.iter().any(|reason| reason.kind == "oracle/signature/A02")));
}

#[rstest]
#[case::at_once(false)]
#[case::lingering(true)]
fn a_device_that_serves_the_link_alone_is_judged_by_what_can_be_seen(#[case] lingers: bool) {
    let cases = judged(Way { link_only: true, lingers, ..Way::default() });
    let others: Vec<CaseRecord> = cases.iter().filter(|case| case.verdict != Verdict::Pass).cloned().collect();
    assert!(others.is_empty(), "{}", story(&others[..others.len().min(20)]));
    assert!(cases.len() > 900 && !cases.iter().any(|case| case.id == "FSD-0123"), "cases with SDset_DS do not apply");
    let wrong = judged(Way { link_only: true, jumps_accepted: true, ..Way::default() });
    assert!(wrong.iter().any(|case| case.verdict == Verdict::Fail));
}
