//! Sweeps: one case, many points. Editions, modes and sizes are matched against what the DUT offers.

use crate::problem::{Problem, Source};
use crate::tree::{self, Placed};
use crate::yaml::{Node, Value};
use fsct_adapters::{Offer, Variant};
use fsct_protocol::{Edition, ProtMode};
use std::ops::Range;
use std::sync::Arc;

/// More points than this are a mistake in the case.
const MAX_POINTS: usize = 20_000;
/// Axes that choose the variant of the DUT instead of a value in the steps.
const VARIANT: [&str; 5] = ["edition", "mode", "pd", "pd_out", "pd_in"];

/// The axis that takes the place of FSP_Watchdog of the profile, in milliseconds.
const WATCHDOG: &str = "FSP_Watchdog";

/// One variable of a sweep with its values as written.
#[derive(Clone, Debug)]
pub struct Axis {
    /// Its name; steps use it as `$name`.
    pub name: String,
    /// Values and words such as `each-bit`.
    values: Vec<Placed>,
    /// Place of the name.
    pub at: Range<usize>,
}

impl Axis {
    fn words(&self) -> Vec<String> {
        self.values.iter().map(|placed| placed.0.clone()).collect()
    }

    /// Whether it chooses edition, mode or sizes.
    fn is_variant(&self) -> bool {
        VARIANT.contains(&self.name.as_str())
    }

    /// Whether the steps need not name it: it says what the DUT is, or how it is parameterized.
    pub fn is_of_the_dut(&self) -> bool {
        self.is_variant() || self.name == WATCHDOG
    }
}

/// One point of a sweep.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Binding {
    /// What the DUT is to be.
    pub variant: Variant,
    /// Names and values in the order of the key.
    pub values: Vec<(String, String)>,
}

impl Binding {
    /// The value of a variable.
    pub fn value(&self, name: &str) -> Option<&str> {
        self.values.iter().find(|(known, _)| known == name).map(|(_, value)| value.as_str())
    }

    /// FSP_Watchdog in milliseconds, where the case chooses it.
    pub fn watchdog_ms(&self) -> Option<u16> {
        self.value(WATCHDOG).and_then(|ms| ms.parse().ok())
    }

    pub(crate) fn with(&self, name: &str, value: String) -> Binding {
        let mut point = self.clone();
        point.values.push((name.to_owned(), value));
        point
    }

    /// `[edition=iec2022,mode=crc16,pd=2]`; sizes that differ are `pd=OUT/IN`.
    pub fn key(&self) -> String {
        let pairs: Vec<String> = self.values.iter().map(|(name, value)| format!("{name}={value}")).collect();
        format!("[{}]", pairs.join(","))
    }
}

/// The points of a sweep a DUT can be judged at, and those it cannot with the term that excludes them.
#[derive(Clone, Debug, Default)]
pub struct Expansion {
    /// Points to run.
    pub points: Vec<Binding>,
    /// Points left out, with the term that excludes each.
    pub excluded: Vec<(Binding, String)>,
}

/// Reads `sweep`.
pub fn axes(source: &Arc<Source>, node: &Node, problems: &mut Vec<Problem>) -> Vec<Axis> {
    let Value::Map(entries) = &node.value else {
        problems.push(Problem::new(source, node.at.clone(), "`sweep` has to be a map of names and values"));
        return Vec::new();
    };
    let mut found = Vec::new();
    for (key, value) in entries {
        let values: Vec<Placed> = match &value.value {
            Value::List(items) => items.iter().filter_map(tree::scalar).collect(),
            _ => tree::scalar(value).into_iter().collect(),
        };
        if values.is_empty() {
            problems.push(Problem::new(source, value.at.clone(), format!("`{}` has no values", key.text)));
        }
        for (text, at) in &values {
            let known = match key.text.as_str() {
                "edition" => text.parse::<Edition>().is_ok(),
                "mode" => text.parse::<ProtMode>().is_ok(),
                "pd" | "pd_out" | "pd_in" => {
                    matches!(text.as_str(), "max" | "typical" | "each") || text.parse::<u8>().is_ok_and(|n| n <= 25)
                }
                WATCHDOG => text.parse::<u16>().is_ok_and(|ms| ms > 0),
                _ => !text.starts_with('$'),
            };
            if !known {
                let expected = match key.text.as_str() {
                    "edition" => "v1.1 or iec2022",
                    "mode" => "crc16 or crc32",
                    WATCHDOG => "1 to 65535 milliseconds",
                    _ => "0 to 25, typical, max or each",
                };
                problems.push(Problem::new(source, at.clone(), format!("`{text}` is no {}: {expected}", key.text)));
            }
        }
        found.push(Axis { name: key.text.clone(), values, at: key.at.clone() });
    }
    let has = |name: &str| found.iter().any(|axis: &Axis| axis.name == name);
    if has("pd") && (has("pd_out") || has("pd_in")) {
        problems.push(Problem::new(source, node.at.clone(), "`pd` sets both sizes; use it or `pd_out` and `pd_in`"));
    }
    found
}

/// Expands a sweep for a DUT that offers this. Without `edition`, `mode` or size in the sweep every edition and mode offered
/// is run at a typical size.
///
/// # Errors
/// A [`Problem`] when there are too many points.
pub fn expand(source: &Arc<Source>, axes: &[Axis], offers: &[Offer]) -> Result<Expansion, Problem> {
    let mut expansion = Expansion::default();
    let words = |name: &str, all: [&str; 2]| match axes.iter().find(|axis| axis.name == name) {
        Some(axis) => axis.words(),
        None => all.map(str::to_owned).to_vec(),
    };
    for edition in words("edition", Edition::ALL.map(Edition::name)) {
        for mode in words("mode", ProtMode::ALL.map(ProtMode::name)) {
            let (Ok(edition), Ok(mode)) = (edition.parse::<Edition>(), mode.parse::<ProtMode>()) else { continue };
            let values = vec![("edition".to_owned(), edition.to_string()), ("mode".to_owned(), mode.to_string())];
            match offers.iter().find(|offer| offer.edition == edition && offer.mode == mode) {
                Some(offer) => sized(axes, offer, &values, &mut expansion),
                None => {
                    let variant = Variant { edition, mode, pd_out: 0, pd_in: 0 };
                    let term = format!("the DUT does not offer {edition} with {mode}");
                    expansion.excluded.push((Binding { variant, values }, term));
                }
            }
        }
    }
    for axis in axes.iter().filter(|axis| !axis.is_variant()) {
        let points = std::mem::take(&mut expansion.points);
        expansion.points = points
            .iter()
            .flat_map(|point| {
                choices(axis, point.variant).into_iter().map(move |choice| point.with(&axis.name, choice))
            })
            .collect();
        if expansion.points.len() > MAX_POINTS {
            let message = format!("the sweep has more than {MAX_POINTS} points");
            return Err(Problem::new(source, axis.at.clone(), message));
        }
    }
    Ok(expansion)
}

/// The points of one offer: one for each pair of sizes in the sweep.
fn sized(axes: &[Axis], offer: &Offer, values: &[(String, String)], expansion: &mut Expansion) {
    let axis = |name: &str| axes.iter().find(|axis| axis.name == name).map(Axis::words);
    let typical = || vec!["typical".to_owned()];
    let Offer { edition, mode, .. } = *offer;
    let pairs: Vec<(u8, u8)> = match (axis("pd_out"), axis("pd_in")) {
        (None, None) => {
            let words = axis("pd").unwrap_or_else(typical);
            let (outs, ins) = (sizes(&words, offer.pd_out, mode), sizes(&words, offer.pd_in, mode));
            // A product whose directions differ in size takes `max` and `typical` of each.
            let at = |sizes: &[u8], index: usize| sizes.get(index).or(sizes.last()).copied();
            (0..outs.len().max(ins.len())).filter_map(|index| Some((at(&outs, index)?, at(&ins, index)?))).collect()
        }
        (outs, ins) => {
            let outs = sizes(&outs.unwrap_or_else(typical), offer.pd_out, mode);
            let ins = sizes(&ins.unwrap_or_else(typical), offer.pd_in, mode);
            outs.iter().flat_map(|out| ins.iter().map(move |input| (*out, *input))).collect()
        }
    };
    for (pd_out, pd_in) in pairs {
        let variant = Variant { edition, mode, pd_out, pd_in };
        let size = if pd_out == pd_in { pd_out.to_string() } else { format!("{pd_out}/{pd_in}") };
        let point = Binding { variant, values: values.to_vec() }.with("pd", size);
        if offer.covers(variant) {
            expansion.points.push(point);
        } else {
            let ((a, b), (c, d)) = (offer.pd_out, offer.pd_in);
            let term = format!("the DUT offers PDout {a}..{b} and PDin {c}..{d} octets with {edition} and {mode}");
            expansion.excluded.push((point, term));
        }
    }
}

fn sizes(words: &[String], (least, most): (u8, u8), mode: ProtMode) -> Vec<u8> {
    let mut found: Vec<u8> = Vec::new();
    for word in words {
        match word.as_str() {
            "max" => found.push(most),
            "typical" => found.push((if mode == ProtMode::Crc16 { 2u8 } else { 6 }).clamp(least, most)),
            "each" => found.extend(least..=most),
            number => found.extend(number.parse::<u8>().ok()),
        }
    }
    let mut unique = Vec::new();
    for size in found {
        if !unique.contains(&size) {
            unique.push(size);
        }
    }
    unique
}

/// The values of an axis: `each-bit` are the bits of the SPDU to the DUT, `0..7` all numbers of a range.
fn choices(axis: &Axis, variant: Variant) -> Vec<String> {
    let bits = 8 * variant.mode.spdu_octets(usize::from(variant.pd_out));
    let mut found = Vec::new();
    for (text, _) in &axis.values {
        if text == "each-bit" {
            found.extend((0..bits).map(|bit| bit.to_string()));
            continue;
        }
        let range = text.split_once("..").and_then(|(a, b)| Some((a.parse::<u32>().ok()?, b.parse::<u32>().ok()?)));
        match range {
            Some((from, to)) if to >= from && to - from < 10_000 => found.extend((from..=to).map(|n| n.to_string())),
            _ => found.push(text.clone()),
        }
    }
    found
}
