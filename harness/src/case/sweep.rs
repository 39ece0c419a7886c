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
    /// Whether it chooses edition, mode or sizes.
    pub fn is_variant(&self) -> bool {
        VARIANT.contains(&self.name.as_str())
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

    /// `[edition=iec2022,mode=crc16,pd=2]`.
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
                _ => !text.starts_with('$'),
            };
            if !known {
                let expected = match key.text.as_str() {
                    "edition" => "v1.1 or iec2022",
                    "mode" => "crc16 or crc32",
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
    let axis = |name: &str| axes.iter().find(|axis| axis.name == name);
    let texts = |name: &str, default: &[&str]| -> Vec<String> {
        match axis(name) {
            Some(axis) => axis.values.iter().map(|placed| placed.0.clone()).collect(),
            None => default.iter().map(|text| (*text).to_owned()).collect(),
        }
    };
    let mut expansion = Expansion::default();
    let sized = axis("pd_out").is_some() || axis("pd_in").is_some();
    for edition in texts("edition", &Edition::ALL.map(Edition::name)) {
        for mode in texts("mode", &ProtMode::ALL.map(ProtMode::name)) {
            let (Ok(edition), Ok(mode)) = (edition.parse::<Edition>(), mode.parse::<ProtMode>()) else { continue };
            let base = vec![("edition".to_owned(), edition.to_string()), ("mode".to_owned(), mode.to_string())];
            let Some(offer) = offers.iter().find(|offer| offer.edition == edition && offer.mode == mode) else {
                let point = Binding { variant: Variant { edition, mode, pd_out: 0, pd_in: 0 }, values: base };
                expansion.excluded.push((point, format!("the DUT does not offer {edition} with {mode}")));
                continue;
            };
            let sizes: Vec<(u8, u8, Vec<(String, String)>)> = if sized {
                let outs = sizes(&texts("pd_out", &["typical"]), offer.pd_out, mode);
                let ins = sizes(&texts("pd_in", &["typical"]), offer.pd_in, mode);
                outs.iter()
                    .flat_map(|out| ins.iter().map(move |input| (*out, *input)))
                    .map(|(o, i)| {
                        (o, i, vec![("pd_out".to_owned(), o.to_string()), ("pd_in".to_owned(), i.to_string())])
                    })
                    .collect()
            } else {
                let words = texts("pd", &["typical"]);
                let outs = sizes(&words, offer.pd_out, mode);
                let ins = sizes(&words, offer.pd_in, mode);
                // Products with sizes that differ take `max` and `typical` per direction.
                let count = outs.len().max(ins.len());
                (0..count)
                    .filter_map(|index| {
                        let out = *outs.get(index).or(outs.last())?;
                        let input = *ins.get(index).or(ins.last())?;
                        let text = if out == input { out.to_string() } else { format!("{out}/{input}") };
                        Some((out, input, vec![("pd".to_owned(), text)]))
                    })
                    .collect()
            };
            for (pd_out, pd_in, named) in sizes {
                let variant = Variant { edition, mode, pd_out, pd_in };
                let mut values = base.clone();
                values.extend(named);
                if !offer.covers(variant) {
                    let term = format!(
                        "the DUT offers PDout {}..{} and PDin {}..{} octets with {edition} and {mode}",
                        offer.pd_out.0, offer.pd_out.1, offer.pd_in.0, offer.pd_in.1
                    );
                    expansion.excluded.push((Binding { variant, values }, term));
                    continue;
                }
                let mut points = vec![values];
                for axis in axes.iter().filter(|axis| !axis.is_variant()) {
                    let choices = choices(axis, variant);
                    points = points
                        .iter()
                        .flat_map(|point| choices.iter().map(move |choice| with(point, &axis.name, choice)))
                        .collect();
                    if points.len() > MAX_POINTS {
                        let message = format!("the sweep has more than {MAX_POINTS} points");
                        return Err(Problem::new(source, axis.at.clone(), message));
                    }
                }
                expansion.points.extend(points.into_iter().map(|values| Binding { variant, values }));
            }
        }
    }
    Ok(expansion)
}

fn with(point: &[(String, String)], name: &str, value: &str) -> Vec<(String, String)> {
    let mut point = point.to_vec();
    point.push((name.to_owned(), value.to_owned()));
    point
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
