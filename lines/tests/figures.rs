//! Waveforms like the figures of the standard, and what an episode makes of them.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use fsct_lines::{Answer, Chart, Claim, Episode, Given, Quantity, WakeUps, decode, measure};
use rstest::rstest;

const US: u64 = 1_000;
const MS: u64 = 1_000_000;
const S: u64 = 1_000_000_000;

/// Figure 27: Ready pulse, wake-up inside the window, octets.
const FIGURE_27: &str = "
    L+   _10ms ~3s
    C/Q  _2.01s ~700us _100us ~80us _600us ( ~4us _9us )x20 _300ms
    I/Q  _3.01s";

/// Figure 21: Ready pulse, no wake-up, OSSD mode with test pulses on both lines (Figure 19), demand.
const FIGURE_21: &str = "
    L+   _10ms ~9s
    C/Q  _2.01s ~700us _1.2s           ( ~99ms _1ms )x30 ~99ms _500ms    ~99ms ( _1ms ~99ms )x2
    I/Q  _2.01s _700us _1.2s _2us ~3ms ( ~99ms _1ms )x30 ~95.8ms _500ms    ~99ms ( _1ms ~99ms )x2";

fn episodes(text: &str, wake_ups: WakeUps) -> Vec<Episode> {
    let mut all = Vec::new();
    let mut chart = Chart::parse(text).unwrap();
    decode(&mut chart, wake_ups, |episode| all.push(episode.clone())).unwrap();
    all
}

fn one(text: &str, wake_ups: WakeUps) -> Episode {
    let all = episodes(text, wake_ups);
    assert_eq!(all.len(), 1, "{all:#?}");
    all.into_iter().next().unwrap()
}

/// All values of a quantity as low and high.
fn values(episode: &Episode, quantity: Quantity) -> Vec<(u64, u64)> {
    measure(episode, 0)
        .into_iter()
        .filter(|measured| measured.quantity == quantity)
        .map(|measured| (measured.low, measured.high))
        .collect()
}

fn exact(episode: &Episode, quantity: Quantity) -> Vec<u64> {
    values(episode, quantity)
        .into_iter()
        .map(|(low, high)| {
            assert_eq!(low, high, "{quantity}");
            low
        })
        .collect()
}

const OSSDE: Given =
    Given { uncertainty_ns: 0, ossde: true, ossd_not_before: Some(1_100_000_000), wait_at_most: Some(5_000_000_000) };

#[test]
fn figure_27_from_pulses() {
    let episode = one(FIGURE_27, WakeUps::Pulses);
    assert_eq!(exact(&episode, Quantity::TimeToReady), [2 * S]);
    assert_eq!(exact(&episode, Quantity::ReadyPulse), [700 * US]);
    assert_eq!(exact(&episode, Quantity::ReadyToWakeUp), [100 * US]);
    assert_eq!((episode.wake_ups.count, episode.wake_ups.before_ready, episode.further), (1, 0, 0));
    assert_eq!(episode.communication, Some(2_011_480 * US));
    assert_eq!(episode.ossd, None);
    assert_eq!(Claim::OneReadyPulse.ask(&episode, OSSDE), Answer::Holds);
    assert_eq!(Claim::IqOff.ask(&episode, OSSDE), Answer::Holds);
    assert_eq!(Claim::NoEarlyWakeUp.ask(&episode, OSSDE), Answer::Holds);
    assert_eq!(Claim::OffUntilOssd.ask(&episode, OSSDE), Answer::Unknown);
    assert_eq!(values(&episode, Quantity::WaitForReady), []);
}

#[test]
fn figure_27_told() {
    let told = "
        L+      _10ms ~3s
        C/Q     _2.01s ~700us _1s
        I/Q     _3.01s
        wake-up _2.0108s !";
    let episode = one(told, WakeUps::Told);
    let pulses = one(FIGURE_27, WakeUps::Pulses);
    assert_eq!(measure(&episode, 0), measure(&pulses, 0));
}

#[test]
fn figure_21() {
    let episode = one(FIGURE_21, WakeUps::Pulses);
    assert_eq!(exact(&episode, Quantity::ReadyToOssd), [1_200 * MS, 1_200 * MS + 2 * US]);
    assert_eq!(exact(&episode, Quantity::TestPulse), [MS, MS], "one value a line: all are equal");
    assert_eq!(exact(&episode, Quantity::TestPulsePeriod), [100 * MS, 100 * MS]);
    assert_eq!(exact(&episode, Quantity::TestPulseRatio), [10_000_000, 10_000_000], "1/100 exactly");
    // I/Q lags by 3.002 ms in the first run and leads by 198 us after the demand.
    assert_eq!(exact(&episode, Quantity::TestPulseShift), [198 * US, 3_002 * US]);
    assert_eq!(values(&episode, Quantity::Discrepancy), [(198 * US, 198 * US)]);
    let ossd = episode.ossd.unwrap();
    assert_eq!(ossd.demands, 1);
    assert_eq!(Claim::OffUntilOssd.ask(&episode, OSSDE), Answer::Holds);
    assert_eq!(Claim::OneReadyPulse.ask(&episode, OSSDE), Answer::Holds);
}

/// The rows of Table 7 at and beyond their limits.
#[rstest]
#[case::least("~500us _1.1s", 500 * US, 1_100 * MS)]
#[case::short("~499us _1.1s", 499 * US, 1_100 * MS)]
#[case::widest("~1000us _1.1s", 1_000 * US, 1_100 * MS)]
#[case::wide("~1001us _1s", 1_001 * US, 1_000 * MS)]
#[case::v1_1("~700us _700us", 700 * US, 700 * US)]
#[case::a_wide_pulse_is_still_one("~9ms _700us", 9 * MS, 700 * US)]
fn ready_pulse_and_what_follows(#[case] pulse: &str, #[case] width: u64, #[case] delay: u64) {
    let text = format!("L+ _1ms ~1s\nC/Q _2s {pulse} ~50ms _50ms\nI/Q _2s {} ~50ms _50ms", pulse.replace('~', "_"));
    let episode = one(&text, WakeUps::Pulses);
    assert_eq!(exact(&episode, Quantity::ReadyPulse), [width]);
    assert_eq!(exact(&episode, Quantity::ReadyToOssd), [delay, delay]);
    let off = Given { ossd_not_before: Some(1_100 * MS), ..OSSDE };
    let held = Claim::OffUntilOssd.ask(&episode, off) == Answer::Holds;
    assert_eq!(held, delay >= 1_100 * MS);
}

#[rstest]
#[case::on_pin_2_as_well("C/Q _2s ~700us _300ms", "I/Q _2s ~700us _300ms", true, false)]
#[case::on_pin_2_before("C/Q _2s ~700us _300ms", "I/Q _1s ~1us _300ms", true, false)]
#[case::on_pin_2_after("C/Q _2s ~700us _300ms", "I/Q _2.1s ~1us _300ms", false, false)]
#[case::two_pulses("C/Q _2s ~700us _50ms ~700us _300ms", "I/Q _3s", false, true)]
#[case::glitch_before("C/Q _1s ~3us _1s ~700us _300ms", "I/Q _3s", false, true)]
#[case::none_but_ossd("C/Q _2s ~700ms", "I/Q _2s ~700ms", true, true)]
fn other_pulses(#[case] cq: &str, #[case] iq: &str, #[case] iq_broken: bool, #[case] more_broken: bool) {
    let episode = one(&format!("L+ _1ms ~3s\n{cq}\n{iq}"), WakeUps::Pulses);
    let broken = |claim: Claim| matches!(claim.ask(&episode, OSSDE), Answer::Broken(_));
    assert_eq!(broken(Claim::IqOff), iq_broken, "{episode:#?}");
    assert_eq!(broken(Claim::OneReadyPulse), more_broken, "{episode:#?}");
}

#[test]
fn a_pulse_on_pin_2_after_the_ready_pulse_breaks_the_off_time() {
    let episode = one("L+ _1ms ~4s\nC/Q _2s ~700us _2s\nI/Q _2.1s ~1us _2s", WakeUps::Pulses);
    assert_eq!(Claim::OffUntilOssd.ask(&episode, OSSDE), Answer::Broken(2_100 * MS));
}

#[test]
fn without_ossde_pins_may_switch() {
    let episode = one("L+ _1ms ~4s\nC/Q _2s ~700us _20ms ~5ms _20ms ~8ms _2s\nI/Q _1s ~1us _3s", WakeUps::Pulses);
    let level_a = Given { ossde: false, ..OSSDE };
    for (claim, _) in Claim::ALL {
        assert!(!matches!(claim.ask(&episode, level_a), Answer::Broken(_)), "{claim:?}");
    }
}

#[rstest]
#[case::comes_up_with_the_supply("I/Q ~3ms _3s", Answer::Unknown)]
#[case::stays("I/Q ~30ms _3s", Answer::Broken(MS))]
fn high_at_power_on(#[case] iq: &str, #[case] expected: Answer) {
    let episode = one(&format!("L+ _1ms ~3s\nC/Q _2s ~700us _300ms\n{iq}"), WakeUps::Pulses);
    assert_eq!(Claim::IqOff.ask(&episode, OSSDE), expected);
}

#[test]
fn no_ready_pulse_is_at_least_the_time_looked_at() {
    let episode = one("L+ _1s ~6s\nC/Q _7s\nI/Q _7s", WakeUps::Pulses);
    assert_eq!(values(&episode, Quantity::TimeToReady), [(6 * S, u64::MAX)]);
    assert_eq!(values(&episode, Quantity::WaitForReady), [(6 * S, u64::MAX)]);
    assert_eq!(Claim::PowerCycle.ask(&episode, OSSDE), Answer::Broken(6 * S));
    let later = Given { wait_at_most: Some(6 * S), ..OSSDE };
    assert_eq!(Claim::PowerCycle.ask(&episode, later), Answer::Unknown);
}

#[test]
fn power_cycle_after_the_time_out() {
    let all = episodes("L+ _1s ~5s _1.2s ~3s\nC/Q _8.2s ~800us _60us ~80us _1s\nI/Q _9s", WakeUps::Pulses);
    assert_eq!(all.len(), 2);
    assert_eq!(exact(&all[0], Quantity::WaitForReady), [5 * S]);
    assert_eq!(exact(&all[0], Quantity::PowerOff), [1_200 * MS]);
    assert_eq!(Claim::PowerCycle.ask(&all[0], OSSDE), Answer::Holds);
    assert_eq!(exact(&all[1], Quantity::TimeToReady), [S]);
    assert_eq!(Claim::NoEarlyWakeUp.ask(&all[1], OSSDE), Answer::Holds);
}

#[test]
fn wake_up_before_the_ready_pulse() {
    // Octets of COM3, COM2 and COM1 follow it; the Ready pulse stands alone afterwards.
    let octets = "_600us ( ~4us _9us )x9 _1ms ( ~78us _26us )x5 _1ms ( ~833us _208us )x2";
    let text = format!("L+ _10ms ~3s\nC/Q _1s ~80us {octets} _900ms ~700us _60us ~80us _1s\nI/Q _3s");
    let episode = one(&text, WakeUps::Pulses);
    assert_eq!(Claim::NoEarlyWakeUp.ask(&episode, OSSDE), Answer::Broken(S));
    assert_eq!((episode.wake_ups.count, episode.wake_ups.before_ready), (2, 1));
    assert_eq!(exact(&episode, Quantity::ReadyPulse), [700 * US]);
    assert_eq!(values(&episode, Quantity::ReadyToWakeUp), [], "the first wake-up has no pulse before it");
    let unanswered = one("L+ _10ms ~3s\nC/Q _1s ~80us _300ms ~700us _60us ~80us _1s\nI/Q _3s", WakeUps::Pulses);
    assert_eq!(unanswered.communication, None, "neither Ready pulse nor wake-up is an octet");
    let octets_only = one(&format!("L+ _10ms ~3s\nC/Q _1s ~80us {octets} _1s\nI/Q _3s"), WakeUps::Pulses);
    assert_eq!(values(&octets_only, Quantity::TimeToReady), [], "octets may have hidden it");
}

#[test]
fn wake_up_while_the_ready_pulse_is_running() {
    let episode = one("L+ _1ms ~3s\nC/Q _2s ~900us _1s\nI/Q _3s\nwake-up _2.0003s !", WakeUps::Told);
    assert_eq!(exact(&episode, Quantity::ReadyPulse), [900 * US]);
    assert_eq!(exact(&episode, Quantity::ReadyToWakeUp), [0]);
    assert_eq!(Claim::NoEarlyWakeUp.ask(&episode, OSSDE), Answer::Holds);
}

#[test]
fn ossd_mode_without_a_ready_pulse() {
    for (iq, on) in [("_2s", 2 * S), ("_2.001s", 2_001 * MS)] {
        let episode = one(&format!("L+ _1ms ~3s\nC/Q _2s ~700ms\nI/Q {iq} ~700ms"), WakeUps::Pulses);
        assert_eq!(values(&episode, Quantity::ReadyPulse), []);
        assert_eq!(values(&episode, Quantity::TimeToReady), []);
        assert_eq!(episode.ossd.map(|ossd| ossd.both_on), Some(Some(on)));
    }
}

#[test]
fn retries_are_told_from_octets() {
    // COM2: three low bits are as wide as a wake-up, at the head and at the tail of an octet.
    let octets = "_600us ~78us _26us ~26us _156us ~26us _26us ~78us";
    let text = format!(
        "L+ _10ms ~3s\nC/Q _1s ~700us _100us ~80us {octets} _40ms ~80us {octets} _35ms ~80us {octets} _1s\nI/Q _3s"
    );
    let episode = one(&text, WakeUps::Pulses);
    assert_eq!(episode.wake_ups.count, 3, "{episode:#?}");
    assert_eq!(exact(&episode, Quantity::WakeUpRetry), [36_096 * US, 41_096 * US]);
}

/// A recording without L+, or one that begins with it: it may begin anywhere in the life of a port.
#[rstest]
#[case::start_up("C/Q _2s ~700us _100us ~80us _600us ( ~4us _9us )x20 _300ms", Some(700 * US), 1)]
#[case::nothing_after("C/Q _2s ~499us _100ms", Some(499 * US), 0)]
#[case::lone_octet("C/Q _3ms ~104us _500ms", None, 0)]
#[case::com3("C/Q _1ms ( ~4us _9us ~30us _9us )x500 _1s", None, 0)]
#[case::com2("C/Q _3ms ( ~260us _52us ~78us _26us _26us ~26us _5ms )x50", None, 0)]
#[case::com1("C/Q _3ms ( ~625us _208us ~2080us _300us ~208us _20ms )x50", None, 0)]
fn without_power(#[case] cq: &str, #[case] width: Option<u64>, #[case] wake_ups: u64) {
    for power in ["", "L+ ~1s\n"] {
        let episode = one(&format!("{power}{cq}\nI/Q _1s"), WakeUps::Pulses);
        let expected: Vec<u64> = width.into_iter().collect();
        assert_eq!(exact(&episode, Quantity::ReadyPulse), expected);
        assert_eq!(episode.wake_ups.count, wake_ups);
        assert_eq!(values(&episode, Quantity::TimeToReady), []);
        assert_eq!(values(&episode, Quantity::PowerOff), []);
        assert_eq!(Claim::IqOff.ask(&episode, OSSDE), Answer::Unknown, "not all of the self-test was seen");
    }
}

#[test]
fn ossd_mode_soon_after_the_ready_pulse_without_power() {
    let episode = one("C/Q _2s ~700us _900us ~20ms _500us ~20ms\nI/Q _2.0015s ~40ms", WakeUps::Pulses);
    assert_eq!(exact(&episode, Quantity::ReadyToOssd), [800 * US, 900 * US]);
    assert_eq!(exact(&episode, Quantity::TestPulse), [500 * US]);
    let pin_2 = one("C/Q _2s ~700us _2s\nI/Q _2.0017s ~4ms _1s", WakeUps::Pulses);
    assert_eq!(pin_2.first_rise, Some(2_001_700 * US));
}

#[test]
fn the_ratio_is_that_of_the_worst_pulse() {
    let episode = ossd("~80ms _1ms ~9ms _100us ~40ms _1s", "~130ms _1s");
    assert!(exact(&episode, Quantity::TestPulseRatio).contains(&100_000_000), "1 ms of 10 ms");
}

#[test]
fn a_recording_of_ossd_mode_alone() {
    let pulses = "( ~19ms _200us )x50 ~10ms";
    let episode = one(&format!("C/Q {pulses}\nI/Q ~5ms {pulses}"), WakeUps::Pulses);
    assert_eq!(exact(&episode, Quantity::TestPulse), [200 * US, 200 * US]);
    assert_eq!(exact(&episode, Quantity::TestPulsePeriod), [19_200 * US, 19_200 * US]);
    assert_eq!(exact(&episode, Quantity::TestPulseShift), [5 * MS]);
    assert_eq!(episode.ready, None);
    assert_eq!(values(&episode, Quantity::ReadyToOssd), []);
}

/// Both lines in OSSD mode after a start-up, with what follows the first 300 ms.
fn ossd(cq: &str, iq: &str) -> Episode {
    let start = "_2s ~700us _1.1s ( ~49.5ms _500us )x6";
    let low = start.replace("~700us", "_700us");
    one(&format!("L+ _1ms ~9s\nC/Q {start} {cq}\nI/Q {low} {iq}"), WakeUps::Pulses)
}

#[rstest]
#[case::together("~10ms _1s", "~10ms _1s", (0, 0))]
#[case::skew("~10ms _1s", "~10.9ms _1s", (900 * US, 900 * US))]
#[case::too_much("~10ms _1s", "~13.1ms _1s", (3_100 * US, 3_100 * US))]
#[case::with_a_running_pulse("~49.5ms _1s", "~50.7ms _1s", (700 * US, 1_200 * US))]
#[case::returning("~10ms _1s ~1s", "~10ms _1.001s ~1s", (MS, MS))]
#[case::antivalent_for_good("~10ms _3s", "~3s", (5_590_300 * US, 5_590_300 * US))]
#[case::blip_while_off("~10ms _100ms ~2ms _1s", "~10ms _1s", (2 * MS, 2 * MS))]
fn discrepancy(#[case] cq: &str, #[case] iq: &str, #[case] expected: (u64, u64)) {
    let episode = ossd(cq, iq);
    assert_eq!(values(&episode, Quantity::Discrepancy), [expected]);
    assert_eq!(exact(&episode, Quantity::TestPulse), [500 * US, 500 * US], "no OFF is taken for a test pulse");
}

#[rstest]
#[case::at_the_limit("~10ms _1ms ~30ms _1s", MS)]
#[case::too_wide("~10ms _1001us ~30ms _1s", 1_001 * US)]
#[case::far_too_wide("~10ms _4ms ~30ms _1s", 4 * MS)]
fn widest_test_pulse(#[case] cq: &str, #[case] width: u64) {
    let alone = ossd(cq, "~60ms _1s");
    assert!(exact(&alone, Quantity::TestPulse).contains(&width));
    if width <= 1_500 * US {
        let both = ossd(cq, cq);
        assert_eq!(exact(&both, Quantity::TestPulse), [500 * US, width, 500 * US, width]);
    }
}

#[test]
fn a_wake_up_in_ossd_mode_ends_the_measuring() {
    let text = "L+ _1ms ~9s\nC/Q _2s ~700us _1.1s ~30ms _7ms ~30ms _1s\nI/Q _3.1007s ~1s\nwake-up _3.12s !";
    let episode = one(text, WakeUps::Told);
    assert_eq!(values(&episode, Quantity::TestPulse), []);
    assert_eq!(values(&episode, Quantity::Discrepancy), [(0, 0)]);
    assert_eq!(episode.wake_ups.count, 1);
}

#[test]
fn uncertainty_of_a_ratio_and_of_a_width() {
    let episode = one(FIGURE_21, WakeUps::Pulses);
    let all = measure(&episode, 1_000);
    let width = all.iter().find(|measured| measured.quantity == Quantity::ReadyPulse).unwrap();
    assert_eq!(width.uncertainty, 2_000, "two edges");
    let ratio = all.iter().find(|measured| measured.quantity == Quantity::TestPulseRatio).unwrap();
    // (1000 us + 2 us) / (100 ms - 2 us)
    assert_eq!(ratio.uncertainty, 20_201);
}

#[test]
fn symbols_are_unique() {
    for (quantity, symbol) in Quantity::ALL {
        assert_eq!(Quantity::from_symbol(symbol), Some(quantity));
    }
}
