//! Each mutant differs from the original where its sentence says, and the original is right there.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod common;

use common::*;
use fsct_adapters::{Octets, Service};
use fsct_protocol::ProtMode;
use fsct_protocol::crc::crc16;
use fsct_protocol::spdu::Status;
use fsct_reference::{Mutant, Options};

/// What `look` sees on the original and on the mutant.
fn seen<T>(mutant: Mutant, look: impl Fn(Options) -> T) -> (T, T) {
    (look(Options::default()), look(Bench::mutant(mutant)))
}

fn operating(options: Options) -> Bench {
    Bench::operating_with(plain(), options)
}

fn status(bench: &Bench) -> Status {
    bench.answer().expect("a right answer")
}

/// Process data that give `secured` the signature 0 before it becomes 1.
fn data_for_zero(port_num: u8, octet: u8) -> [u8; 3] {
    let data = |n: u32| [(n >> 16) as u8, (n >> 8) as u8, n as u8];
    let zero = |n: &u32| crc16(1, &[&data(*n)[..], &[port_num, octet]].concat()) == 0;
    data((0..1 << 24).find(zero).unwrap())
}

#[test]
fn names_are_unique_and_known() {
    for mutant in Mutant::ALL.iter().copied() {
        assert_eq!(Mutant::from_name(mutant.name()), Some(mutant));
        assert!(!mutant.clause().is_empty() && mutant.about().ends_with('.'));
    }
    assert_eq!(Mutant::from_name("original"), None);
}

#[test]
fn wrong_seed() {
    let (right, wrong) = seen(Mutant::WrongSeed, |options| {
        let mut bench = Bench::waiting_first_with(plain(), options);
        bench.exchange(m(0).sd());
        bench.answer()
    });
    assert_eq!(right, Some(d(7).sd_set()));
    assert_eq!(wrong, None);
}

#[test]
fn zero_not_replaced_on_receiving() {
    let data = data_for_zero(PORT, 4 << 5);
    let spdu = Octets::new(&[&data[..], &[PORT, 4 << 5, 0, 1]].concat());
    let (right, wrong) = seen(Mutant::ZeroNotReplaced, |options| {
        let mut bench = operating(options);
        bench.receive(spdu);
        status(&bench)
    });
    assert_eq!(right, d(3));
    assert_eq!(wrong, d(3).sd_set().comm_err());
}

#[test]
fn zero_not_replaced_on_sending() {
    let data = data_for_zero(!PORT, d(3).to_octet());
    let (right, wrong) = seen(Mutant::ZeroNotReplaced, |options| {
        let mut bench = operating(options);
        bench.set(Service::PdinD, &data);
        bench.exchange(m(4));
        bench.image.unwrap().as_slice()[5..].to_vec()
    });
    assert_eq!(right, [0, 1]);
    assert_eq!(wrong, [0, 0]);
}

#[test]
fn port_not_inverted() {
    let (right, wrong) = seen(Mutant::PortNotInverted, |options| operating(options).image.unwrap().as_slice()[3]);
    assert_eq!((right, wrong), (!PORT, PORT));
}

#[test]
fn counter_check_missing() {
    let (right, wrong) = seen(Mutant::CounterCheckMissing, |options| {
        let mut bench = operating(options);
        bench.exchange(m(6));
        status(&bench)
    });
    assert_eq!(right, d(1).sd_set().comm_err());
    assert_eq!(wrong, d(1));
}

#[test]
fn sd_cycles_2_at_the_start_and_after_a_fault() {
    let (right, wrong) = seen(Mutant::SdCycles2, |options| {
        let mut bench = Bench::waiting_first_with(plain(), options);
        [m(0).sd(), m(1), m(2), m(3), m(4).bad(), m(5), m(6), m(7)].map(|out| {
            bench.exchange(out);
            status(&bench).sd_set
        })
    });
    assert_eq!(right, [true, true, true, false, true, true, true, true]);
    assert_eq!(wrong, [true, true, false, false, true, true, true, false]);
}

#[test]
fn d_timeout_never_cleared() {
    let (right, wrong) = seen(Mutant::DTimeoutNeverCleared, |options| {
        let mut bench = operating(options);
        let before = status(&bench).d_timeout;
        bench.advance(WATCHDOG);
        (4..=7).for_each(|count| bench.exchange(m(count)));
        (before, status(&bench).d_timeout)
    });
    assert_eq!((right, wrong), ((false, false), (false, true)));
}

#[test]
fn pdout_live_during_sd_cycles() {
    let (right, wrong) = seen(Mutant::PdoutLiveDuringSdCycles, |options| {
        let mut bench = Bench::waiting_first_with(plain(), options);
        [m(0), m(1), m(2).bad(), m(3), m(4)].map(|out| {
            bench.exchange(out);
            bench.service(Service::PdoutD) == Octets::new(&[out.data; 3])
        })
    });
    assert_eq!(right, [false; 5]);
    assert_eq!(wrong, [true, true, false, true, true]);
}

#[test]
fn watchdog_doubled() {
    let (right, wrong) = seen(Mutant::WatchdogDoubled, |options| {
        let mut bench = operating(options);
        [WATCHDOG, WATCHDOG - 1, 1].map(|ns| {
            bench.advance(ns);
            bench.receive(None);
            status(&bench).d_timeout
        })
    });
    assert_eq!(right, [true, true, true]);
    assert_eq!(wrong, [false, false, true]);
}

#[test]
fn d_comm_err_never_reported() {
    let (right, wrong) = seen(Mutant::DCommErrNeverReported, |options| {
        let mut bench = operating(options);
        bench.exchange(m(4).bad());
        status(&bench)
    });
    assert_eq!(right, d(3).sd_set().comm_err());
    assert_eq!(wrong, d(3).sd_set());
}

#[test]
fn set_sd_ignored() {
    let (right, wrong) = seen(Mutant::SetSdIgnored, |options| {
        let mut bench = operating(options);
        bench.exchange(m(4).set_sd());
        (bench.service(Service::SetsdDc), bench.service(Service::PdoutD))
    });
    assert_eq!(right, (Octets::new(&[1]), Octets::new(&[0; 3])));
    assert_eq!(wrong, (Octets::new(&[0]), Octets::new(&[0x54; 3])));
}

/// A mutant is wrong in one thing; this start-up shows none of the others.
#[test]
fn most_mutants_start_up_like_the_original() {
    use Mutant::{PdoutLiveDuringSdCycles, PortNotInverted, SdCycles2, WrongSeed};
    for mutant in Mutant::ALL.iter().copied() {
        let (right, wrong) = seen(mutant, |options| {
            let mut bench = Bench::waiting_first_with(variant(plain().edition, ProtMode::Crc32, 6), options);
            [m(0).sd(), m(1), m(2), m(3), m(4)].map(|out| {
                bench.exchange(out);
                (bench.answer(), bench.service(Service::PdoutD))
            })
        });
        let shows = matches!(mutant, WrongSeed | PortNotInverted | SdCycles2 | PdoutLiveDuringSdCycles);
        assert_eq!(right != wrong, shows, "{mutant}");
    }
}
