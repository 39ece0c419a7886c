//! Drawings over logarithmic axes.

use fsct_reports::{Bound, Curve, Measured, Plot, plots};

fn plot() -> Plot {
    Plot {
        title: "<b>title</b>".to_owned(),
        axes: ("across & along".to_owned(), "up".to_owned()),
        x: (1e-2, 1.0),
        y: (1e-4, 1.0),
        curves: vec![Curve {
            number: "7".to_owned(),
            about: "the square".to_owned(),
            // The first lies below the drawing.
            points: vec![(1e-3, 1e-6), (1e-2, 1e-4), (1e-1, 1e-2), (1.0, 1.0)],
            mark: Some((1e-1, 1e-2)),
        }],
        bounds: vec![
            Bound { label: "limit".to_owned(), level: 1e-1, upto: 1.0 },
            Bound { label: "stated".to_owned(), level: 1e-2, upto: 1e-1 },
        ],
        measured: vec![
            Measured { about: "seen twice".to_owned(), at: 1e-1, value: 2e-2, interval: (1e-2, 3e-2) },
            // Nothing seen: the dot would lie below the drawing, the interval ends at its edge.
            Measured { about: "<never> seen".to_owned(), at: 1e-2, value: 0.0, interval: (0.0, 1e-3) },
        ],
    }
}

#[test]
fn curves_bounds_and_marks_stand_where_they_belong() {
    insta::assert_snapshot!(plots(&[plot()]).replace("><", ">\n<"));
}

#[test]
fn several_stand_below_each_other() {
    let drawn = plots(&[plot(), plot()]);
    assert!(drawn.contains("viewBox=\"0 0 860 940\"") && drawn.contains("translate(0 470)"), "{drawn}");
}
