//! Measured values in `report.html`: rulers in a case, and a histogram per limit over all cases.

use crate::case_html::Room;
use crate::histogram::{histogram, middle};
use crate::journal::Run;
use crate::measurement::{Counted, Measurement};
use crate::record::{CaseRecord, Verdict};
use crate::ruler::{NAME, mark, ruler, told};
use crate::text::short;
use crate::timing::timing;
use maud::{Markup, html};
use std::cmp::Reverse;
use std::collections::BTreeMap;

/// Rulers of one case, and limits with a histogram.
const RULERS: usize = 12;
const LIMITS: usize = 60;

/// The rulers of a case, those that need a reader first, and its timing diagram.
pub fn of_case(case: &CaseRecord) -> Markup {
    let mut values: Vec<&Measurement> = case.measurements.iter().collect();
    values.sort_by_key(|value| Reverse(value.verdict));
    html! {
        @if !values.is_empty() {
            ul.measured {
                @for value in values.iter().take(RULERS) {
                    @let (sign, class) = mark(value.verdict);
                    li {
                        div {
                            span class=(format!("word {class}")) { (sign) " " (told(value)) }
                            @if let Some(margin) = value.margin() { ", margin " (margin) }
                            span.soft { " · " (short(&value.about, NAME)) " · clause " (short(&value.clause, NAME)) }
                        }
                        (ruler(value))
                    }
                }
            }
            @if values.len() > RULERS { p.soft { (values.len() - RULERS) " more values are in run.jsonl; their histograms are under “Measured”." } }
        }
        (timing(case))
    }
}

type Limit<'r> = (&'r str, Option<u64>, Option<u64>, &'r str, Counted, usize);

/// Every limit that was measured against, with all its values.
pub fn section(run: &Run, room: &Room<'_>) -> Markup {
    let mut limits: BTreeMap<Limit<'_>, Vec<(&CaseRecord, &Measurement)>> = BTreeMap::new();
    for case in &run.cases {
        for value in &case.measurements {
            let limit = (value.symbol.as_str(), value.min, value.max, value.clause.as_str(), value.counted, case.dut);
            limits.entry(limit).or_default().push((case, value));
        }
    }
    html! {
        @if !limits.is_empty() {
            h2 { "Measured" }
            p.soft {
                "One histogram a limit. Vertical lines are the limits, the shaded field is what they permit; dashed is the guard band, "
                "the limit ± the uncertainty: nothing in it passes or fails."
            }
            @for values in limits.values().take(LIMITS) { (limit(values, room)) }
            @if limits.len() > LIMITS { p.soft { (limits.len() - LIMITS) " more limits are in run.jsonl." } }
        }
    }
}

fn limit(values: &[(&CaseRecord, &Measurement)], room: &Room<'_>) -> Markup {
    let Some((worst, value)) = values.iter().min_by_key(|(_, it)| (Reverse(it.verdict), it.margin.unwrap_or(i64::MAX)))
    else {
        return html! {};
    };
    let all: Vec<&Measurement> = values.iter().map(|(_, value)| *value).collect();
    let mut sorted: Vec<u64> = all.iter().map(|value| middle(value)).collect();
    sorted.sort_unstable();
    let median = sorted[(sorted.len() - 1) / 2];
    let smallest = all.iter().map(|value| value.low).min().unwrap_or(0);
    let largest = all.iter().map(|value| value.high.unwrap_or(value.low)).max().unwrap_or(0);
    let open = all.iter().filter(|value| value.high.is_none()).count();
    let off = |off: Option<u64>| off.map_or_else(String::new, |off| value.show(off));
    let least = off(all.iter().map(|value| value.uncertainty).min());
    let most = off(all.iter().map(|value| value.uncertainty).max());
    let uncertainty = if least == most { most } else { format!("{least} to {most}") };
    let mut verdicts: BTreeMap<Verdict, usize> = BTreeMap::new();
    all.iter().for_each(|value| *verdicts.entry(value.verdict).or_default() += 1);
    let counts: Vec<String> = verdicts
        .iter()
        .rev()
        .map(|(verdict, count)| format!("{} {count} {}", mark(*verdict).0, crate::summary::verdict_name(*verdict)))
        .collect();
    let heading = format!("{} {}", short(&value.symbol, NAME), value.limits());
    let about = format!(
        "{heading}: {} values, {} to {}, median {}; {}",
        all.len(),
        value.show(smallest),
        value.show(largest),
        value.show(median),
        counts.join(", ")
    );
    html! {
        section.limit {
            h3 { (heading) span.soft { " · clause " (short(&value.clause, NAME)) @if let Some(dut) = room.duts().of_case(worst) { " · " (dut) } } }
            p { (short(&value.about, NAME)) }
            dl {
                dt { "Values" } dd { (all.len()) ": " (counts.join(", ")) @if open > 0 { "; of " (open) " the end was not seen (dashed bars)" } }
                dt { "Smallest, median, largest" }
                dd { (value.show(smallest)) ", " (value.show(median)) ", " @if open > 0 { "at least " } (value.show(largest)) }
                dt { "Uncertainty" } dd { "± " (uncertainty) }
                dt { "Worst" }
                dd {
                    (value.value()) @if let Some(margin) = value.margin() { ", margin " (margin) }
                    " in " a href=(format!("#{}", room.anchor_of(worst))) { (short(&worst.key, NAME)) }
                }
            }
            div.scroll tabindex="0" role="group" aria-label={ "Histogram of " (heading) } { (histogram(&all, &about)) }
        }
    }
}
