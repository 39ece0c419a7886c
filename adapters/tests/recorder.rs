//! What a recorder keeps of what crosses the boundary.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod common;

use common::*;
use fsct_adapters::{
    Answer, Description, Dut, DutError, Entry, Happened, Keep, Line, Mode, Observation, Octets, Recorder, Recording,
    Response, Seen, Service, SmiService, Source, Stimulus,
};

fn recorded(keep: Keep, batches: &[&[Stimulus]]) -> Recording {
    let mut recorder = Recorder::new(Mirror::default(), keep);
    for batch in batches {
        recorder.apply(batch, &mut Vec::new()).unwrap();
    }
    recorder.take()
}

fn entry(at: u64, count: u64, what: Happened) -> Entry {
    Entry { at, count, what }
}

fn swapped(sent: &[u8], got: Option<&[u8]>) -> Happened {
    Happened::Exchange { port: 1, sent: Some(octets(sent)), got: got.map(octets) }
}

fn advance(ns: u64) -> Stimulus {
    Stimulus::Advance { ns }
}

fn set_sd(on: bool) -> Happened {
    Happened::Service { port: 1, service: Service::SetsdDc, value: Octets::bit(on) }
}

#[test]
fn each_kind_has_its_entry() {
    let read = Stimulus::Read { index: 0x11, subindex: 0 };
    let write = Stimulus::Write { index: 1, subindex: 2, data: vec![3] };
    let set = Stimulus::Set { port: 1, service: Service::PdinD, value: octets(&[1]) };
    let other = Stimulus::Other { kind: 200, octets: vec![] };
    let batch = [
        Stimulus::Configure(variant()),
        Stimulus::Power(true),
        advance(5),
        exchange(&[1]),
        read.clone(),
        advance(2),
        write.clone(),
        set.clone(),
        other.clone(),
    ];
    let expected = [
        entry(0, 1, Happened::Configure(variant())),
        entry(0, 1, Happened::Power(true)),
        entry(5, 1, set_sd(true)),
        entry(5, 1, swapped(&[1], None)),
        entry(5, 1, Happened::Acyclic { request: read, answer: Answer::Refused(0x8011) }),
        entry(7, 1, Happened::Acyclic { request: write, answer: Answer::Written }),
        entry(7, 1, Happened::Event { code: 0x1800, qualifier: 0xF4 }),
        entry(7, 1, Happened::Unserved(set)),
        entry(7, 1, Happened::Unserved(other)),
    ];
    assert_eq!(recorded(Keep::default(), &[&batch]).head, expected);
}

#[test]
fn each_kind_of_an_fs_master_has_its_entry() {
    let plug = Stimulus::Plug { port: 2, device: Some(identity()) };
    let [high, low] = [true, false].map(|level| Stimulus::Drive { port: 2, line: Line::Cq, level });
    let respond = Stimulus::Respond { port: 2, response: Response::Written };
    let raise = Stimulus::Raise { port: 2, code: 0xB002, qualifier: 0x74 };
    let authenticity = Stimulus::Set { port: 0, service: Service::FscpAuthenticity, value: Octets::zero(8) };
    let batch =
        [plug.clone(), high.clone(), advance(700), low.clone(), respond.clone(), raise.clone(), authenticity.clone()];
    let saw = |at, seen| entry(at, 1, Happened::Saw(seen));
    let done = |at, stimulus| entry(at, 1, Happened::Done(stimulus));
    let expected = [
        done(0, plug),
        saw(0, Seen::Line { port: 2, line: Line::Power, level: true }),
        done(0, high),
        done(700, low),
        saw(700, Seen::Line { port: 2, line: Line::WakeUp, level: true }),
        saw(700, Seen::Mode { port: 2, mode: Mode::Preoperate }),
        saw(700, Seen::Request { port: 2, index: 0x4202, subindex: 0, data: Some(vec![0; 23]) }),
        done(700, respond),
        saw(700, Seen::Mode { port: 2, mode: Mode::Operate }),
        done(700, raise),
        saw(700, Seen::Indication { port: 2, source: Source::Device, qualifier: 0x74, code: 0xB002 }),
        entry(700, 1, Happened::Unserved(authenticity)),
    ];
    assert_eq!(recorded(Keep::default(), &[&batch]).head, expected);
}

#[test]
fn a_request_through_the_smi_is_one_entry_with_its_result() {
    let (served, unserved) = (smi(SmiService::PortStatus), smi(SmiService::PdOutIq));
    let told = |stimulus: &Stimulus, result| match stimulus {
        Stimulus::Smi(request) => Happened::Smi { request: request.clone(), result },
        _ => unreachable!("it is a request"),
    };
    let expected = [
        entry(3, 1, told(&served, Some(Box::new(status(2, 0x0102))))),
        entry(3, 1, told(&served, Some(Box::new(status(2, 0x0102))))),
        entry(3, 1, told(&unserved, None)),
    ];
    assert_eq!(recorded(Keep::default(), &[&[advance(3), served.clone(), served, unserved]]).head, expected);
}

#[test]
fn what_is_done_to_a_port_in_vain_is_unserved() {
    let vain = Stimulus::Drive { port: 1, line: Line::Power, level: true };
    assert_eq!(recorded(Keep::default(), &[std::slice::from_ref(&vain)]).head, [entry(0, 1, Happened::Unserved(vain))]);
}

#[test]
fn equal_exchanges_that_cause_nothing_are_counted() {
    let two = [advance(1), exchange(&[2]), advance(1), exchange(&[2])];
    let expected = [
        entry(1, 1, swapped(&[2], None)),
        entry(2, 4, swapped(&[2], Some(&[2]))),
        entry(6, 1, set_sd(true)),
        entry(6, 1, swapped(&[1], Some(&[2]))),
        entry(6, 1, swapped(&[1], Some(&[1]))),
    ];
    let recording = recorded(
        Keep::default(),
        &[&two, &two, &[advance(1), exchange(&[2]), advance(1), exchange(&[1]), exchange(&[1])]],
    );
    assert_eq!(recording.head, expected);
}

#[test]
fn other_octets_and_what_stands_between_end_a_count() {
    let power = Stimulus::Power(true);
    let recording =
        recorded(Keep::default(), &[&[exchange(&[2]), exchange(&[2]), power, exchange(&[2]), exchange(&[4])]]);
    let expected = [
        entry(0, 1, swapped(&[2], None)),
        entry(0, 1, swapped(&[2], Some(&[2]))),
        entry(0, 1, Happened::Power(true)),
        entry(0, 1, swapped(&[2], Some(&[2]))),
        entry(0, 1, swapped(&[4], Some(&[2]))),
    ];
    assert_eq!(recording.head, expected);
}

#[test]
fn the_middle_of_many_is_left_out() {
    let batch: Vec<_> = (0..10u64).flat_map(|at| [advance(1), exchange(&[2 * at as u8])]).collect();
    let kept = |head, tail| {
        let recording = recorded(Keep { head, tail }, &[&batch]);
        assert_eq!((recording.len(), recording.is_empty()), (10, false));
        (recording.entries().map(|entry| entry.at).collect::<Vec<_>>(), recording.elided)
    };
    assert_eq!(kept(3, 2), (vec![1, 2, 3, 9, 10], 5));
    assert_eq!(kept(3, 7), ((1..=10).collect(), 0));
    assert_eq!(kept(3, 0), (vec![1, 2, 3], 7));
    assert_eq!(kept(0, 2), (vec![9, 10], 8));
    assert_eq!(kept(0, 0), (vec![], 10));
}

#[test]
fn an_exchange_behind_the_gap_is_not_counted_before_it() {
    let keep = Keep { head: 1, tail: 0 };
    let recording = recorded(keep, &[&[exchange(&[2]), Stimulus::Power(true), exchange(&[2])]]);
    assert_eq!((recording.head[0].count, recording.elided), (1, 2));
}

#[test]
fn taking_begins_anew_and_keeps_the_time() {
    let mut recorder = Recorder::new(Mirror::default(), Keep::default());
    recorder.apply(&[advance(9), exchange(&[2])], &mut Vec::new()).unwrap();
    assert_eq!(recorder.take().len(), 1);
    assert!(recorder.recording().is_empty());
    recorder.apply(&[Stimulus::Power(false)], &mut Vec::new()).unwrap();
    assert_eq!(recorder.take().head, [entry(9, 1, Happened::Power(false))]);
}

/// Answers one exchange and breaks off.
struct Breaking;

impl Dut for Breaking {
    fn hello(&mut self) -> Result<Description, DutError> {
        Ok(description())
    }

    fn apply(&mut self, stimuli: &[Stimulus], observed: &mut Vec<Observation>) -> Result<(), DutError> {
        Mirror::default().apply(&stimuli[..1], observed)?;
        Err(DutError::Closed { how: String::new() })
    }
}

#[test]
fn what_was_observed_before_an_error_is_recorded() {
    let mut recorder = Recorder::new(Breaking, Keep::default());
    recorder.apply(&[exchange(&[2]), exchange(&[4])], &mut Vec::new()).unwrap_err();
    assert_eq!(recorder.take().head, [entry(0, 1, swapped(&[2], None))]);
}
