//! DTimer and MTimer: not before their window, not behind it, and either within it (A24).

use super::device::{Link, pdout, sd};
use super::master::{self, Port};
use super::*;
use crate::oracle::config::Window;
use rstest::rstest;

const SLACK: u64 = TICK + UNCERTAINTY;

#[rstest]
#[case::device(Role::Device, WATCHDOG - SLACK, WATCHDOG + SLACK + MARGIN)]
#[case::master(Role::Master, WATCHDOG - SLACK - CYCLE, WATCHDOG + SLACK + MARGIN)]
fn the_window_of_a_start(#[case] role: Role, #[case] earliest: u64, #[case] latest: u64) {
    let setup = strict(role);
    let (a, b) = (5 * CYCLE, 6 * CYCLE);
    assert_eq!(setup.watchdog(a, b), Window { earliest: a + earliest, latest: b + latest });
    // The next expiry counts from the one before, as far as the time of that is known.
    let expired = Window { earliest: 100 * CYCLE, latest: 105 * CYCLE };
    let again = |last_at, at| setup.watchdog_again(expired, last_at, at);
    let next = |from: u64, to: u64| Window { earliest: from + earliest, latest: to + latest };
    assert_eq!(again(90 * CYCLE, 110 * CYCLE), next(100 * CYCLE, 105 * CYCLE));
    assert_eq!(again(101 * CYCLE, 102 * CYCLE), next(101 * CYCLE, 102 * CYCLE));
    // It may still be on its way at the end of its window, and may have come several times behind it.
    let end = 105 * CYCLE + latest;
    assert_eq!(again(90 * CYCLE, end), next(100 * CYCLE, 105 * CYCLE));
    assert_eq!(again(90 * CYCLE, end + 1), Window { earliest: end + 1, latest: end + 1 + latest });
}

/// After this long without SPDUs the FS-Device shows T31 or does not.
fn device(after: u64, expired: bool) -> Result<(), Mismatch> {
    let mut link = Link::operating(strict(Role::Device));
    let shown = if expired { sd(4, 1, 0, 1) } else { pdout(4) };
    link.exchange(after, None, &shown)
}

/// After this long without answers the FS-Master shows T8 or does not.
fn master(after: u64, expired: bool) -> Result<(), Mismatch> {
    let mut port = Port::operating(strict(Role::Master));
    let shown = if expired { master::fault(0, 0) } else { master::live(4) };
    port.exchange(after, None, &shown)
}

#[rstest]
#[case::device(device, WATCHDOG - SLACK, "T31")]
#[case::master(master, WATCHDOG - SLACK - CYCLE, "T8")]
fn the_first_expiry(#[case] go: fn(u64, bool) -> Result<(), Mismatch>, #[case] earliest: u64, #[case] t: &str) {
    let latest = WATCHDOG + SLACK + MARGIN;
    for (after, expired) in [
        (earliest - 1, false),
        (earliest, false),
        (earliest, true),
        (latest, false),
        (latest, true),
        (latest + 1, true),
    ] {
        assert_eq!(go(after, expired), Ok(()), "{after} {expired}");
    }
    let early = refused(go(earliest - 1, true), "watchdog/early");
    let late = refused(go(latest + 1, false), "watchdog/late");
    for mismatch in [early, late] {
        assert!(mismatch.clause.starts_with("11.5.5") && mismatch.clause.contains(t), "{mismatch:?}");
    }
}

#[test]
fn the_second_expiry_of_an_fs_device() {
    let begin = || {
        let mut link = Link::operating(strict(Role::Device));
        assert_eq!(link.exchange(WATCHDOG, None, &sd(4, 1, 0, 1)), Ok(()));
        link.says(4, sd(3, 1, 0, 1));
        link.says(5, sd(2, 1, 0, 0));
        link
    };
    let expiry = refused(begin().exchange(WATCHDOG / 2, None, &sd(2, 1, 0, 1)), "DTimeout");
    assert!(expiry.expected.contains("DTimeout 0"), "{expiry:?}");
    assert_eq!(begin().exchange(WATCHDOG, None, &sd(2, 1, 0, 1)), Ok(()));
    let late = refused(begin().exchange(2 * WATCHDOG, None, &sd(2, 1, 0, 0)), "watchdog/late");
    assert!(late.clause.contains("T30"), "{late:?}");
}

#[test]
fn repetitions_do_not_restart_it_and_new_spdus_do() {
    let mut link = Link::operating(strict(Role::Device));
    for _ in 0..18 {
        link.says(3, pdout(4));
    }
    assert_eq!(link.exchange(2 * CYCLE, None, &sd(4, 1, 0, 1)), Ok(()));
    let mut link = Link::operating(strict(Role::Device));
    for _ in 0..12 {
        link.says(3, pdout(4));
    }
    link.says(4, pdout(3));
    refused(link.exchange(18 * CYCLE, None, &sd(3, 1, 0, 1)), "watchdog/early");
}

#[test]
fn no_timer_runs_before_the_first_spdu() {
    let mut link = Link::ready(strict(Role::Device));
    link.at += 10 * WATCHDOG;
    link.says(0, sd(7, 1, 0, 0));
    let mut port = Port::ready(strict(Role::Master));
    assert_eq!(port.exchange(CYCLE, None, &master::start()), Ok(()));
    assert_eq!(port.exchange(10 * WATCHDOG, None, &master::start()), Ok(()));
}

#[test]
fn an_expiry_and_an_spdu_at_once_come_in_any_order() {
    let next = m(4, 0, 0, PDOUT);
    let go = |shown| Link::operating(strict(Role::Device)).exchange(WATCHDOG, Some(&next), &shown);
    assert_eq!(go(pdout(3)), Ok(()));
    assert_eq!(go(sd(3, 1, 0, 1)), Ok(()));
    refused(go(pdout(4)), "DCount_i");
}

#[test]
fn what_differs_in_more_than_an_expiry_does_is_no_matter_of_the_watchdog() {
    refused(Link::operating(strict(Role::Device)).exchange(CYCLE, None, &sd(4, 1, 1, 1)), "DCommErr");
    refused(Link::operating(strict(Role::Device)).exchange(CYCLE, None, &sd(3, 1, 0, 1)), "DCount_i");
    let port = || Port::operating(strict(Role::Master));
    port().refuses(master::answer(3, 0), master::fault(0, 0), "MCount");
    refused(port().exchange(2 * WATCHDOG, None, &master::live(6)), "MCount");
}
