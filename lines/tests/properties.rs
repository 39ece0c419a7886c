//! Whatever the edges and the numbers are.

use fsct_adapters::Line;
use fsct_lines::{Bounds, Claim, Decoder, Edge, Episode, Given, Levels, Verdict, WakeUps, judge, judge_looks, measure};
use proptest::prelude::*;

fn bounds() -> impl Strategy<Value = Bounds> {
    let number = || prop_oneof![any::<u64>(), 0u64..3_000];
    (number(), number(), 0..4).prop_map(|(a, b, shape)| match shape {
        0 => Bounds { min: Some(a), max: None },
        1 => Bounds { min: None, max: Some(a) },
        2 => Bounds { min: Some(a), max: Some(b) },
        _ => Bounds { min: Some(a.min(b)), max: Some(a.max(b)) },
    })
}

/// Lengths that matter: around every threshold, and anything.
fn length() -> impl Strategy<Value = u64> {
    let around = prop::sample::select(vec![
        0,
        4_000,
        75_000,
        80_000,
        85_000,
        250_000,
        300_000,
        500_000,
        700_000,
        1_000_000,
        1_500_000,
        2_500_000,
        5_000_000,
        10_000_000,
        100_000_000,
        1_100_000_000,
    ]);
    prop_oneof![
        8 => (around, -2i64..=2).prop_map(|(length, off): (u64, i64)| length.saturating_add_signed(off)),
        1 => any::<u64>(),
    ]
}

fn level() -> impl Strategy<Value = Option<bool>> {
    any::<Option<bool>>()
}

fn start() -> impl Strategy<Value = Levels> {
    (level(), level(), level()).prop_map(|(power, cq, iq)| Levels { power, cq, iq })
}

fn steps() -> impl Strategy<Value = Vec<(u64, Line, bool)>> {
    let line = prop_oneof![
        1 => Just(Line::Power), 6 => Just(Line::Cq), 6 => Just(Line::Iq), 1 => Just(Line::WakeUp),
    ];
    prop::collection::vec((length(), line, any::<bool>()), 0..60)
}

fn run(levels: Levels, steps: &[(u64, Line, bool)], wake_ups: WakeUps, looks: &[u64]) -> Vec<Episode> {
    let mut decoder = Decoder::new(0, levels, wake_ups);
    let mut all = Vec::new();
    let mut now = 0u64;
    for (index, (after, line, level)) in steps.iter().enumerate() {
        let at = now.saturating_add(*after);
        if let Some(look) = looks.get(index) {
            decoder.advance(now.saturating_add(look % (at - now).max(1)));
        }
        now = at;
        all.extend(decoder.edge(Edge { at, line: *line, level: *level }));
    }
    all.extend(decoder.finish(now.saturating_add(20_000_000)));
    all
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 4_000, failure_persistence: None, ..ProptestConfig::default() })]

    /// Looking in between changes nothing, and nothing panics.
    #[test]
    fn looks_change_nothing(
        levels in start(),
        steps in steps(),
        told in any::<bool>(),
        looks in prop::collection::vec(any::<u64>(), 60),
    ) {
        let wake_ups = if told { WakeUps::Told } else { WakeUps::Pulses };
        let plain = run(levels, &steps, wake_ups, &[]);
        let looked = run(levels, &steps, wake_ups, &looks);
        prop_assert_eq!(&plain, &looked);
        for episode in &plain {
            for measured in measure(episode, 100) {
                prop_assert!(measured.low <= measured.high);
            }
            for ossde in [false, true] {
                let given = Given { uncertainty_ns: 100, ossde, ossd_not_before: Some(700_000), wait_at_most: Some(1) };
                for (claim, _) in Claim::ALL {
                    claim.ask(episode, given);
                }
            }
        }
        for pair in plain.windows(2) {
            prop_assert_eq!(pair[0].next_on, pair[1].on);
        }
    }

    /// Without uncertainty a value passes between its limits, limits included, and fails elsewhere.
    #[test]
    fn exact_values(value in any::<u64>(), bounds in bounds()) {
        let inside = bounds.min.is_none_or(|min| value >= min) && bounds.max.is_none_or(|max| value <= max);
        let judged = judge(value, value, 0, bounds);
        prop_assert_eq!(judged.verdict, if inside { Verdict::Pass } else { Verdict::Fail });
        prop_assert_eq!(judged.margin.is_some_and(|margin| margin >= 0), inside);
    }

    /// Pass and fail hold for every value it could be; inconclusive has one of either kind.
    #[test]
    fn the_verdict_holds_for_every_value(
        low in 0u64..2_000, length in 0u64..200, uncertainty in 0u64..200, a in 0u64..2_000, b in 0u64..2_000,
    ) {
        let bounds = Bounds { min: Some(a.min(b)), max: Some(a.max(b)) };
        let judged = judge(low, low + length, uncertainty, bounds).verdict;
        let all = || low.saturating_sub(uncertainty)..=low + length + uncertainty;
        let inside = |value: u64| judge(value, value, 0, bounds).verdict == Verdict::Pass;
        match judged {
            Verdict::Pass => prop_assert!(all().all(inside)),
            Verdict::Fail => prop_assert!(!all().any(inside)),
            Verdict::Inconclusive => prop_assert!(all().any(inside) && !all().all(inside)),
        }
    }

    /// More uncertainty never makes a verdict firmer, and never turns it.
    #[test]
    fn uncertainty_only_softens(
        low in any::<u64>(), high in any::<u64>(), less in any::<u32>(), more in any::<u32>(), bounds in bounds(),
    ) {
        let (less, more) = (u64::from(less.min(more)), u64::from(less.max(more)));
        let (sure, unsure) = (judge(low, high, less, bounds).verdict, judge(low, high, more, bounds).verdict);
        prop_assert!(unsure == sure || unsure == Verdict::Inconclusive);
    }

    /// Values that could be the same are never judged pass and fail.
    #[test]
    fn overlapping_values_do_not_contradict(
        shared in 0u64..3_000, down in 0u64..3_000, up in 0u64..3_000, other in 0u64..300, u in 0u64..300,
        bounds in bounds(),
    ) {
        let (a, b) = (shared.saturating_sub(down), shared + other);
        let (c, d) = (shared.saturating_sub(other), shared + up);
        let pair = [judge(a, b, u, bounds).verdict, judge(c, d, u, bounds).verdict];
        prop_assert_eq!(judge(shared, shared, u, Bounds::default()).verdict, Verdict::Inconclusive);
        prop_assert!(!(pair.contains(&Verdict::Pass) && pair.contains(&Verdict::Fail)));
    }

    /// What looks cannot tell does not count against the DUT; what they can tell still does.
    #[test]
    fn looks_fail_like_values(
        low in any::<u64>(), high in any::<u64>(), u in any::<u32>(), apart in any::<u32>(), bounds in bounds(),
    ) {
        let strict = judge(low, high, u.into(), bounds);
        let looks = judge_looks(low, high, u.into(), apart.into(), bounds);
        prop_assert_eq!(strict.verdict == Verdict::Fail, looks.verdict == Verdict::Fail);
        prop_assert!(strict.verdict != Verdict::Pass || looks.verdict == Verdict::Pass);
        prop_assert_eq!(strict.margin, looks.margin);
    }
}

/// Table 7 permits 500 us and 1000 us themselves: exact, they pass; with an uncertainty nobody knows.
#[test]
fn an_exact_value_on_a_limit_passes() {
    let bounds = Bounds { min: Some(500), max: Some(1_000) };
    for (value, wanted) in [(499, Verdict::Fail), (500, Verdict::Pass), (1_000, Verdict::Pass), (1_001, Verdict::Fail)]
    {
        assert_eq!(judge(value, value, 0, bounds).verdict, wanted, "{value}");
        assert_eq!(judge(value, value, 1, bounds).verdict, Verdict::Inconclusive, "{value}");
    }
}
