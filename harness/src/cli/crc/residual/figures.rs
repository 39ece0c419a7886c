//! A survey as JSON and as a drawing.

use super::{Found, Survey, name};
use fsct_reports::dossier::RESIDUAL;
use fsct_reports::{Bound, Curve, Plot, plots};
use fsct_residual::{BIT_ERROR, BLOCKS_PER_HOUR, MONITOR_HOURS, PER_HOUR, Properness, SHARE};
use serde_json::{Value, json};

/// Bit error probabilities that Rp is told at.
const TOLD: [f64; 17] =
    [1e-6, 1e-5, 1e-4, 1e-3, 2e-3, 5e-3, 0.01, 0.02, 0.05, 0.1, 0.12, 0.14, 0.2, 0.25, 0.3, 0.4, 0.5];
/// The axis of Figures D.1 and D.2, and points of a curve.
const AXIS: (f64, f64) = (1e-5, 0.5);
const POINTS: u32 = 400;
/// How far below the limit 2^-width the drawing goes.
const BELOW: f64 = 1e-16;

pub fn json(surveys: &[Survey]) -> Value {
    let codes = surveys.iter().map(|survey| {
        let stated = survey.code.claim().map(|claim| {
            json!({
                "distance": {"bits": claim.distance.0, "at_least": claim.distance.1},
                "residual": {"octets": claim.residual.0, "below": claim.residual.1},
                "proper": {"octets": claim.proper},
            })
        });
        json!({
            "width": survey.code.width(),
            "polynomial": format!("0x{:X}", survey.code.polynomial()),
            "stated": stated,
            "lengths": survey.found.iter().map(length).collect::<Vec<_>>(),
        })
    });
    json!({
        "schema": RESIDUAL,
        "fsct": env!("CARGO_PKG_VERSION"),
        "assumed": {
            "bit_error_probability": BIT_ERROR, "spdus_per_hour": PER_HOUR, "hours_per_detected_error": MONITOR_HOURS,
            "blocks_per_hour": BLOCKS_PER_HOUR, "share_per_hour": SHARE,
        },
        "codes": codes.collect::<Vec<_>>(),
    })
}

/// Counts of words are strings, for they leave the range of JSON numbers.
fn length(Found { weights, properness, hump }: &Found) -> Value {
    let (distance, words) = weights.distance();
    let counts = weights.code_weights().iter().zip(weights.dual_weights()).enumerate();
    let counts = counts.filter(|(_, (words, dual))| words.bits() + dual.bits() > 0);
    let counts = counts.map(|(ones, (words, dual))| json!([ones, words.to_string(), dual.to_string()]));
    let verdicts = weights.code().claim().map(|claim| {
        json!({
            "distance": claim.of_distance(weights).name(),
            "residual": claim.of_residual(weights).name(),
            "proper": claim.of_properness(weights.octets(), *properness).name(),
        })
    });
    json!({
        "octets": weights.octets(),
        "distance": distance,
        "words_at_distance": words.to_string(),
        "residual": TOLD.map(|p| [p, weights.residual(p)]),
        "proper": match properness {
            Properness::Proper => Some(true),
            Properness::Falls(_) => Some(false),
            Properness::Undecided => None,
        },
        "hump": hump.map(|hump| json!({"p": hump.at, "residual": hump.highest, "above_limit_from_p": hump.from})),
        "unmonitored_per_hour": weights.unmonitored_rate(),
        "monitored_per_hour": weights.monitored_rate(),
        "block_per_hour": weights.block_rate(),
        "verdicts": verdicts,
        "ones_code_words_dual_words": counts.collect::<Vec<_>>(),
    })
}

pub fn svg(surveys: &[Survey]) -> String {
    plots(&surveys.iter().map(plot).collect::<Vec<_>>())
}

fn plot(survey: &Survey) -> Plot {
    let width = survey.code.width();
    let limit = (-f64::from(width)).exp2();
    let highest = 10f64.powf(limit.log10().ceil() + 1.0);
    let mut bounds = vec![Bound { label: format!("2^-{width}"), level: limit, upto: AXIS.1 }];
    bounds.extend(survey.code.claim().map(|claim| {
        let (octets, bound) = claim.residual;
        Bound { label: format!("D.2: below {bound:E} up to {octets} octets"), level: bound, upto: BIT_ERROR }
    }));
    Plot {
        title: format!("{}: residual error probability", name(survey.code)),
        axes: (
            "bit error probability".to_owned(),
            "Rp; a number is the octets of a word, a dot the highest Rp".to_owned(),
        ),
        x: AXIS,
        y: (highest * BELOW, highest),
        curves: survey.found.iter().map(curve).collect(),
        bounds,
        measured: Vec::new(),
    }
}

fn curve(Found { weights, hump, .. }: &Found) -> Curve {
    let step = (AXIS.1 / AXIS.0).powf(1.0 / f64::from(POINTS));
    let point = |number: u32| {
        // The last one exactly, or rounding could put it off the axis.
        let p = if number == POINTS { AXIS.1 } else { AXIS.0 * step.powi(number as i32) };
        (p, weights.residual(p))
    };
    let octets = weights.octets();
    Curve {
        number: octets.to_string(),
        about: format!(
            "{octets} octets: {:.3E} at p = 1E-2, distance {}",
            weights.residual(BIT_ERROR),
            weights.distance().0
        ),
        points: (0..=POINTS).map(point).collect(),
        mark: hump.map(|hump| (hump.at, hump.highest)),
    }
}
