//! Measured values in the reports: JUnit properties, rulers, histograms, timing diagrams.

use crate::common::*;
use fsct_reports::measurement::{Counted, Measurement};
use fsct_reports::record::*;
use fsct_reports::render;
use rstest::rstest;

const US: u64 = 1_000;

/// A Ready pulse of this width, 100 ms after power-on.
fn ready_pulse(width: u64, verdict: Verdict) -> Measurement {
    Measurement {
        symbol: "t_RP".into(),
        about: "Width of the Ready pulse".into(),
        clause: "5.4, Table 7".into(),
        step: 1,
        at_ns: 100_000 * US,
        counted: Counted::Nanoseconds,
        low: width,
        high: Some(width),
        uncertainty: US,
        min: Some(500 * US),
        max: Some(1_000 * US),
        margin: Some((width as i64 - 500_000).min(1_000_000 - width as i64)),
        verdict,
    }
}

/// A case with L+ on, the Ready pulse, and what was measured of it.
fn timed(number: usize, values: Vec<Measurement>) -> CaseRecord {
    let pulse = values.first().map_or(750 * US, |value| value.low);
    let at = |at: u64, text: &str| Entry { at, ..on_port(0, 1, true, text) };
    let trace = vec![at(0, "L+ on"), at(100_000 * US, "C/Q on"), at((100_000 * US).saturating_add(pulse), "C/Q off")];
    CaseRecord { measurements: values, trace, steps: Vec::new(), ..passed(number) }
}

fn reports(name: &str, cases: Vec<CaseRecord>) -> (String, String) {
    let folder = Folder::with(name, &run(cases));
    render(&folder.0).expect("the record is sound");
    (folder.text("junit.xml"), folder.text("report.html"))
}

fn part<'t>(text: &'t str, from: &str, to: &str) -> &'t str {
    let (_, text) = text.split_once(from).unwrap_or_else(|| panic!("{from}"));
    text.split_once(to).expect("its end").0
}

#[test]
fn junit_has_value_limit_margin_and_uncertainty_by_symbol() {
    let open = Measurement { high: None, margin: None, ..ready_pulse(600 * US, Verdict::Inconclusive) };
    let values = vec![ready_pulse(750 * US, Verdict::Pass), ready_pulse(499 * US, Verdict::Fail), open];
    let (xml, _) = reports("measured-junit", vec![timed(1, values)]);
    for (name, value) in [
        ("t_RP", "750 us"),
        ("t_RP.limit", "500 us to 1000 us"),
        ("t_RP.margin", "250 us"),
        ("t_RP.uncertainty", "1 us"),
        ("t_RP#2", "499 us"),
        ("t_RP#2.margin", "-1 us"),
        ("t_RP#3", "more than 600 us"),
    ] {
        assert!(xml.contains(&format!(r#"<property name="{name}" value="{value}"/>"#)), "{name}: {xml}");
    }
    assert!(!xml.contains("t_RP#3.margin"));
}

#[rstest]
#[case::passed(750 * US, Verdict::Pass, "<circle", "✓ t_RP 750 us ± 1 us (500 us to 1000 us)")]
#[case::failed(499 * US, Verdict::Fail, "edge bold", "✗ t_RP 499 us ± 1 us (500 us to 1000 us)")]
fn a_ruler_shows_limits_guard_band_and_value(
    #[case] width: u64,
    #[case] verdict: Verdict,
    #[case] sign: &str,
    #[case] says: &str,
) {
    let (_, html) = reports(&format!("ruler-{width}"), vec![timed(1, vec![ready_pulse(width, verdict)])]);
    let ruler = part(&html, r#"<svg class="ruler""#, "</svg>");
    assert_eq!(ruler.matches(r#"class="limit""#).count(), 2, "{ruler}");
    assert_eq!(ruler.matches(r#"class="guard""#).count(), 2, "{ruler}");
    assert!(ruler.contains(sign) && html.contains(says), "{ruler}");
}

#[test]
fn a_histogram_counts_all_values_of_a_limit_and_leads_to_the_worst() {
    let mut cases: Vec<CaseRecord> =
        (1..=200).map(|number| timed(number, vec![ready_pulse((600 + number as u64) * US, Verdict::Pass)])).collect();
    cases.push(CaseRecord {
        verdict: Verdict::Fail,
        reasons: failed(1).reasons,
        ..timed(300, vec![ready_pulse(1_002 * US, Verdict::Fail)])
    });
    let (_, html) = reports("histogram", cases);
    let section = part(&html, "<h2>Measured</h2>", "<h2>");
    assert!(section.contains("201: ✗ 1 fail, ✓ 200 pass"), "{section}");
    assert!(section.contains("601 us, 701 us, 1002 us") && section.contains("margin -2 us"), "{section}");
    let target = part(section, "href=\"#", "\"");
    assert!(target.contains("FSD-0300") && html.contains(&format!("id=\"{target}\"")), "{target}");
    let bars = part(section, r#"<svg class="histogram""#, "</svg>");
    assert_eq!(bars.matches(r#"class="value fail""#).count(), 1);
    assert!(bars.matches(r#"class="value pass""#).count() > 5, "{bars}");
}

#[test]
fn a_timing_diagram_draws_the_lines_and_the_measured_time() {
    let (_, html) = reports("timing", vec![timed(1, vec![ready_pulse(750 * US, Verdict::Pass)])]);
    let drawn = part(&html, r#"<svg class="timing""#, "</svg>");
    assert!(drawn.contains("L+ on at 0 s; C/Q on at 100 ms, off at 100.75 ms"), "{drawn}");
    assert!(drawn.contains("✓ t_RP 750 us ± 1 us (500 us to 1000 us)"), "{drawn}");
    // A limit just missed has a place of its own.
    let (_, missed) = reports("missed", vec![timed(1, vec![ready_pulse(499 * US, Verdict::Fail)])]);
    let missed = part(&missed, r#"<svg class="timing""#, "</svg>");
    assert_eq!(missed.matches(r#"class="limit""#).count(), 2, "{missed}");
    assert!(missed.contains(">100.499 ms<") && missed.contains(">100.5 ms<"), "{missed}");
    let (_, still) = reports("still", vec![passed(1)]);
    assert!(!still.contains(r#"<svg class="timing""#) && !still.contains("<h2>Measured</h2>"));
}

#[test]
fn thousands_of_test_pulses_are_a_diagram_of_a_few_and_say_so() {
    let mut case = timed(1, vec![ready_pulse(750 * US, Verdict::Pass)]);
    case.trace.extend((0..5_000).map(|n| on_port(200 + n, 1, true, if n % 2 == 0 { "C/Q on" } else { "C/Q off" })));
    let (_, html) = reports("pulses", vec![case]);
    let drawn = part(&html, r#"<svg class="timing""#, "</svg>");
    assert!(drawn.len() < 8_000, "{}", drawn.len());
    assert!(html.contains("4987 instants are left out"));
}

#[test]
fn hostile_names_and_odd_numbers_do_no_harm() {
    let odd = Measurement {
        symbol: HOSTILE.into(),
        about: HOSTILE.into(),
        clause: HOSTILE.into(),
        at_ns: 0,
        low: u64::MAX,
        high: None,
        uncertainty: u64::MAX,
        margin: Some(i64::MIN),
        ..ready_pulse(0, Verdict::Fail)
    };
    let nothing =
        Measurement { low: 0, high: Some(0), uncertainty: 0, min: None, max: None, margin: None, ..odd.clone() };
    let mut case = timed(1, vec![odd, nothing]);
    case.trace[0].at = 0;
    let (xml, html) = reports("odd-values", vec![case]);
    for text in [xml, html] {
        assert!(!text.contains("<script") && !text.contains(['\u{1b}', '\u{202e}']) && !text.contains("NaN"));
    }
}
