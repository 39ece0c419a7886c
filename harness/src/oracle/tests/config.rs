//! One configuration by itself: which of its answers may be seen, and when two configurations are one.

use super::*;
use crate::oracle::config::{Config, MAX_LATENCY, Machine, Snapshot, Window, merge};
use crate::oracle::device::{Answer, Free};
use crate::oracle::master::Spdu;
use crate::oracle::set::Set;
use fsct_protocol::scl::device::Readings;
use fsct_protocol::scl::{Device, Master, Path};
use fsct_reports::record::Verdict;

/// An answer with a name.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
struct Named {
    name: u8,
    made: u64,
    path: Path,
}

impl Snapshot for Named {
    fn made(&self) -> u64 {
        self.made
    }

    fn set_made(&mut self, exchange: u64) {
        self.made = exchange;
    }

    fn path(&self) -> Path {
        self.path
    }

    fn looks_like(&self, other: &Named) -> bool {
        self.name == other.name
    }

    fn renew(&mut self, later: &Named) {
        self.path = later.path;
    }
}

fn named(name: u8, made: u64) -> Named {
    Named { name, made, path: Path::default() }
}

/// State 24 with these answers, made in exchanges 0, 1, 2, ...
fn followed(names: &[u8]) -> Config<Device, Named> {
    let mut config = Config::new(Device::regular(3), named(names[0], 0), Pd::safe(2));
    for (made, name) in names.iter().enumerate().skip(1) {
        config.push(named(*name, made as u64));
    }
    config
}

fn names(config: &Config<Device, Named>) -> Vec<u8> {
    config.snapshots().iter().map(|answer| answer.name).collect()
}

/// Only this answer explains what is seen.
fn only(name: u8) -> impl Fn(&Named) -> Option<Mask> {
    move |answer| (answer.name == name).then_some(Mask::NONE)
}

fn any(_: &Named) -> Option<Mask> {
    Some(Mask::NONE)
}

#[test]
fn an_answer_that_looks_like_the_newest_takes_no_room() {
    let mut config = followed(&[1, 2]);
    let path = Device::regular(3).expire();
    config.push(Named { path, ..named(2, 7) });
    assert_eq!((names(&config), config.newest()), (vec![1, 2], &Named { path, ..named(2, 1) }));
    config.push(named(1, 8));
    assert_eq!((names(&config), config.newest().name), (vec![1, 2, 1], 1));
}

#[test]
fn the_oldest_is_forgotten_when_there_is_no_more_room() {
    let all: Vec<u8> = (0..MAX_LATENCY as u8 + 3).collect();
    let config = followed(&all);
    assert_eq!((names(&config), config.newest().name), (all[2..].to_vec(), all[all.len() - 1]));
}

#[test]
fn an_answer_shows_at_the_latest_behind_the_latency() {
    let config = followed(&[1, 2, 3]);
    let visible = |latency| config.visible(2, latency).iter().map(|answer| answer.name).collect::<Vec<_>>();
    assert_eq!((visible(0), visible(1), visible(2), visible(9)), (vec![3], vec![2, 3], vec![1, 2, 3], vec![1, 2, 3]));
    let seen = |name, latency| followed(&[1, 2, 3]).observe(2, latency, only(name), any);
    assert!(seen(3, 0) && !seen(2, 0) && seen(2, 1) && !seen(1, 1) && seen(1, 2));
}

#[test]
fn link_and_application_each_go_on_and_never_back() {
    let mut one = followed(&[1, 2, 3]);
    assert!(one.observe(2, 2, only(2), only(1)));
    assert_eq!(names(&one), [1, 2, 3], "the application may still show the first");
    assert!(!one.clone().observe(2, 2, only(1), any), "the link may not");
    assert!(one.observe(2, 2, only(2), only(3)));
    assert_eq!(names(&one), [2, 3]);
    assert!(!one.clone().observe(2, 2, any, only(2)));
    assert!(one.observe(2, 2, only(3), only(3)));
    assert_eq!(names(&one), [3]);
}

#[test]
fn a_tolerance_counts_where_nothing_else_explains_what_is_seen() {
    let by = |needs: fn(u8) -> Option<Mask>| {
        let mut config = followed(&[1, 2]);
        assert!(config.observe(1, 1, |answer| needs(answer.name), any));
        config.used
    };
    let five = Mask::NONE.with(5);
    assert_eq!(by(|name| Some(if name == 1 { Mask::NONE.with(5) } else { Mask::NONE })), Mask::NONE);
    assert_eq!(by(|name| Some(if name == 2 { Mask::NONE.with(5) } else { Mask::NONE })), Mask::NONE);
    assert_eq!(by(|name| (name == 1).then(|| Mask::NONE.with(5))), five);
    let mut both = followed(&[1]);
    assert!(both.observe(1, 0, |_| Some(Mask::NONE.with(5)), |_| Some(Mask::NONE.with(6))));
    assert_eq!(both.used, five.with(6));
}

#[test]
fn configurations_with_the_same_future_are_one() {
    let (mut few, mut many) = (followed(&[1, 2]), followed(&[1, 2]));
    few.used = Mask::NONE.with(5);
    many.used = Mask::NONE.with(6).with(7);
    let mut configs = vec![many, few];
    merge(&mut configs);
    assert_eq!(configs.len(), 1);
    assert_eq!(configs[0].used, few.used, "the one with fewer tolerances stays");
    let mut three = vec![few, many, few];
    merge(&mut three);
    assert_eq!(three.len(), 1);
    let mut one = vec![few];
    merge(&mut one);
    assert_eq!(one.len(), 1);
}

#[test]
fn configurations_with_another_future_stay_apart() {
    let own = followed(&[1, 2]);
    let apart = |change: fn(&mut Config<Device, Named>)| {
        let mut other = own;
        change(&mut other);
        let mut configs = vec![own, other];
        merge(&mut configs);
        configs.len() == 2 && !own.clone().absorb(&other)
    };
    assert!(!apart(|_| {}));
    assert!(apart(|other| other.machine = Device::regular(4)), "machine");
    assert!(apart(|other| other.decided = Mask::NONE.with(9)), "readings decided");
    assert!(apart(|other| other.received = Pd::safe(1)), "process data");
    assert!(apart(|other| other.timer = Some(Window { earliest: 1, latest: 2 })), "timer");
    assert!(apart(|other| other.push(named(3, 2))), "answers");
    assert!(apart(|other| *other = followed(&[1, 3])), "other answers");
    assert!(apart(|other| assert!(other.observe(1, 1, only(2), only(1)))), "shown on the link");
    assert!(apart(|other| assert!(other.observe(1, 1, only(1), only(2)))), "reported by the application");
    // With fewer tolerances the machine may be the same and the timer another.
    assert!(!apart(|other| other.used = Mask::NONE.with(5)));
}

#[test]
fn timers_that_may_expire_at_once_are_one() {
    let with = |earliest, latest, used: &[u8]| {
        let mut config = followed(&[1]);
        config.timer = Some(Window { earliest, latest });
        config.used = used.iter().fold(Mask::NONE, |mask, number| mask.with(*number));
        config
    };
    let joined = |mut own: Config<Device, Named>, other: Config<Device, Named>| {
        own.absorb(&other).then_some(own.timer.expect("it runs"))
    };
    let both = Some(Window { earliest: 10, latest: 30 });
    assert_eq!(joined(with(10, 20, &[]), with(20, 30, &[])), both, "they touch");
    assert_eq!(joined(with(20, 30, &[]), with(10, 20, &[])), both);
    assert_eq!(joined(with(10, 30, &[]), with(15, 20, &[])), both);
    assert_eq!(joined(with(10, 19, &[]), with(20, 30, &[])), None, "they do not");
    assert_eq!(joined(with(20, 30, &[]), with(10, 19, &[])), None);
    assert_eq!(joined(with(10, 19, &[29]), with(20, 30, &[29])), both, "any repetition may have restarted it (A29)");
    assert_eq!(joined(with(10, 20, &[5]), with(20, 30, &[])), None, "the tolerance would be lost");
    assert_eq!(joined(with(10, 20, &[29]), with(20, 30, &[])), None);
    let mut own = with(10, 20, &[]);
    let mut late = with(15, 30, &[]);
    late.push(named(2, 9));
    own.push(named(2, 4));
    assert!(own.absorb(&late));
    assert_eq!(own.newest().made, 9, "the later of two answers that look alike");
}

#[test]
fn more_configurations_than_can_be_followed_are_inconclusive() {
    let mut set = Set::<Device, Named>::new();
    set.begin(Device::new(Readings::default()), named(0, 0), Pd::safe(2));
    let observe = |count: u8| {
        let mut stepped: Vec<_> = (0..count).map(|name| followed(&[name])).collect();
        let verdict = set.observe(&mut stepped, 0, any, any, |_| panic!("all explain it"));
        verdict.map(|()| stepped.len())
    };
    assert_eq!(observe(64), Ok(64));
    let told = observe(65).expect_err("one too many");
    assert_eq!((told.verdict, told.observed.as_str()), (Verdict::Inconclusive, "65"));
    // Those that do not explain it are gone.
    let mut stepped: Vec<_> = (0..64).map(|name| followed(&[name])).collect();
    assert_eq!(set.observe(&mut stepped, 0, only(63), any, |_| panic!("the last explains it")), Ok(()));
    assert_eq!(stepped.iter().map(names).collect::<Vec<_>>(), [[63]]);
}

#[test]
fn answers_of_an_fs_device_that_no_observer_can_tell_apart() {
    let own = Answer {
        made: 1,
        status: Some(Status::default()),
        free: Free::default(),
        pdin: (1, 2),
        pdout: Pd::safe(2),
        set_sd_dc: Some(false),
        ch_f_ack_req_dc: Some(false),
        path: Path::default(),
    };
    let path = Device::regular(3).expire();
    assert!(own.looks_like(&Answer { made: 2, path, ..own }));
    for other in [
        Answer { status: None, ..own },
        Answer { free: Free { sd_set: 11, ..Free::default() }, ..own },
        Answer { pdin: (2, 3), ..own },
        Answer { pdin: (3, 3), ..own },
        Answer { pdout: Pd::safe(1), ..own },
        Answer { set_sd_dc: None, ..own },
        Answer { ch_f_ack_req_dc: None, ..own },
    ] {
        assert!(!own.looks_like(&other), "{other:?}");
    }
    // PDin may be the older of two in the first, the newer in both.
    let settled = Answer { pdin: (2, 2), made: 5, path, ..own };
    assert!(own.looks_like(&settled) && !settled.looks_like(&own));
    let mut renewed = Answer { pdin: (1, 1), ..own };
    renewed.renew(&settled);
    assert_eq!(renewed, Answer { pdin: (1, 2), path, ..own });
    renewed.set_made(7);
    assert_eq!((renewed.made(), Snapshot::path(&renewed)), (7, path));
}

#[test]
fn spdus_of_an_fs_master_that_no_observer_can_tell_apart() {
    let mut own = master_spdu();
    let path = Master::regular(3).expire();
    let later = Spdu { path, ..own };
    assert!(own.looks_like(&later));
    own.renew(&later);
    own.set_made(7);
    assert_eq!((own.made(), Snapshot::path(&own)), (7, path));
    assert!(own.looks_like(&master_spdu()) && master_spdu().looks_like(&own));
    for other in [
        Spdu { control: None, ..own },
        Spdu { pdout: None, ..own },
        Spdu { sdout: 22, ..own },
        Spdu { pdin: Pd::safe(1), ..own },
        Spdu { sdset_s: true, ..own },
        Spdu { late: 14, ..own },
        Spdu { ch_f_ack_req_s: true, ..own },
    ] {
        assert!(!own.looks_like(&other), "{other:?}");
    }
}

fn master_spdu() -> Spdu {
    let mut port = master::Port::operating(strict(Role::Master));
    port.says(master::answer(3, 0), master::live(5));
    *port.oracle.set().best().expect("one is followed").newest()
}

#[test]
fn the_machines_say_what_they_are() {
    assert_eq!((Device::FIRST, Device::START.0, Device::ROLE), (20, 20, Role::Device));
    assert_eq!(Machine::state(&Device::regular(3)).0, 24);
}
