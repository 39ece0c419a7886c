//! What a number of trials without, or with few, events says about the probability of the event.

/// Upper end of the one-sided 95 % Clopper-Pearson interval for `events` in `trials`: were the probability higher, so few
/// events would be seen in less than one campaign of twenty. Without events and with many trials it is close to 3 / trials
/// (the rule of three). Without trials nothing is known: 1.
pub fn upper_95(events: u64, trials: u64) -> f64 {
    const ALPHA: f64 = 0.05;
    if events >= trials {
        return 1.0;
    }
    if events == 0 {
        return -(ALPHA.ln() / trials as f64).exp_m1();
    }
    least(|p| at_most(events, trials, p) <= ALPHA)
}

/// Both ends of the Clopper-Pearson interval for `events` in `trials` that holds the probability with this `confidence`, 0 to 1.
pub fn interval(events: u64, trials: u64, confidence: f64) -> (f64, f64) {
    let beyond = (1.0 - confidence) / 2.0;
    let low = if events == 0 { 0.0 } else { least(|p| 1.0 - at_most(events - 1, trials, p) > beyond) };
    let high = if events >= trials { 1.0 } else { least(|p| at_most(events, trials, p) <= beyond) };
    (low, high)
}

/// The least probability of which this is true; once true it stays so.
fn least(is_true: impl Fn(f64) -> bool) -> f64 {
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        if is_true(middle) { high = middle } else { low = middle }
    }
    high
}

/// Probability of at most `events` in `trials` when each has probability `p`, strictly between 0 and 1.
fn at_most(events: u64, trials: u64, p: f64) -> f64 {
    let n = trials as f64;
    // In logarithms: the first term underflows long before the sum does.
    let mut term = n * (-p).ln_1p();
    let mut sum = term.exp();
    for k in 0..events {
        term += ((n - k as f64) / (k as f64 + 1.0)).ln() + p.ln() - (-p).ln_1p();
        sum += term.exp();
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::{interval, upper_95};
    use rstest::rstest;

    /// Values of the exact interval: 1 - 0.05^(1/n) without events, and tables of the binomial distribution.
    #[rstest]
    #[case(0, 10, 0.258_866)]
    #[case(0, 1_000_000, 2.995_728e-6)]
    #[case(1, 10, 0.394_163)]
    #[case(2, 100, 0.061_621)]
    #[case(3, 1_000_000, 7.753_6e-6)]
    #[case(0, 0, 1.0)]
    #[case(5, 5, 1.0)]
    fn the_bound_is_exact(#[case] events: u64, #[case] trials: u64, #[case] expected: f64) {
        let found = upper_95(events, trials);
        assert!((found / expected - 1.0).abs() < 1e-4, "{found}");
    }

    /// Values of tables of the exact interval; without events 1 - 0.025^(1/n).
    #[rstest]
    #[case(0, 100, 0.0, 0.036_216_7)]
    #[case(5, 100, 0.016_431_9, 0.112_834_9)]
    #[case(15, 1_000_000, 8.395_5e-6, 2.474_0e-5)]
    #[case(10, 10, 0.691_502_9, 1.0)]
    fn both_ends_are_exact(#[case] events: u64, #[case] trials: u64, #[case] low: f64, #[case] high: f64) {
        let found = interval(events, trials, 0.95);
        let near = |found: f64, expected: f64| (found - expected).abs() <= 1e-4 * expected;
        assert!(near(found.0, low) && near(found.1, high), "{found:?}");
    }
}
