//! Measured fractions over the exact curves.

use super::CONFIDENCE;
use fsct_reports::campaign::NoiseRow;
use fsct_reports::{Bound, Curve, Measured, Plot, plots};
use fsct_residual::Weights;

/// The axes, and points of a curve.
const X: (f64, f64) = (0.01, 0.5);
const Y: (f64, f64) = (1e-8, 1e-3);
const POINTS: u32 = 200;

/// A drawing for each length.
pub fn svg(rows: &[NoiseRow], weights: &[Weights]) -> String {
    plots(&weights.iter().map(|weights| plot(weights, rows)).collect::<Vec<_>>())
}

fn plot(weights: &Weights, rows: &[NoiseRow]) -> Plot {
    let octets = weights.octets();
    let least = rows.iter().fold(X.0, |least, row| least.min(row.bit_error_probability));
    let step = (X.1 / least).powf(1.0 / f64::from(POINTS));
    let at = |number: u32| if number == POINTS { X.1 } else { least * step.powi(number as i32) };
    let curve = Curve {
        number: octets.to_string(),
        about: format!("{octets} octets: exact, from the weight distribution"),
        points: (0..=POINTS).map(|number| (at(number), weights.residual(at(number)))).collect(),
        mark: None,
    };
    let measured = rows.iter().filter(|row| row.octets == octets).map(|row| Measured {
        about: format!(
            "p = {}: {} undetected of {}; exact {:.4E}",
            row.bit_error_probability, row.undetected, row.spdus, row.exact
        ),
        at: row.bit_error_probability,
        value: row.measured,
        interval: row.interval,
    });
    Plot {
        title: format!("CRC-16, SPDU of {octets} octets: corrupted SPDUs that the DUT took"),
        axes: (
            "bit error probability".to_owned(),
            format!("line: exact Rp; dots: measured, with {} % interval", 100.0 * CONFIDENCE),
        ),
        x: (least, X.1),
        y: Y,
        curves: vec![curve],
        bounds: vec![Bound { label: "2^-16".to_owned(), level: weights.limit(), upto: X.1 }],
        measured: measured.collect(),
    }
}
