//! Residuals: correlations of its one-step errors with themselves and with the input.

use super::figure::{Band, Curve, Figure, Ink, Legend, Mark, Marks, Panel};
use crate::presentation::summary::probability;
use servoid_identification::Record;
use servoid_identification::diagnostics::{Correlogram, WHITENESS_LAGS};
use servoid_identification::results::Model;

/// Lags of the input looked at before the present and beyond the settling time.
const AROUND: isize = 25;

/// Share of the lags that lie within their bound if the errors are noise.
const LEVEL: f64 = 0.99;

/// Both correlograms, with the p-values of the tests that belong to them in the legend. A record
/// without errors to look at gives no panels.
#[must_use]
pub fn residuals(name: &str, title: &str, model: &Model, record: &Record) -> Figure {
    let beyond = model.structure.settling_samples as isize + AROUND;
    let p = |p: Option<f64>| format!(", {}", probability(p));
    let tests = &model.residuals;
    let own = Correlogram::of_errors(model, record, 2 * WHITENESS_LAGS, LEVEL);
    let input = Correlogram::with_input(model, record, -AROUND..=beyond, LEVEL);
    let panels = [
        own.map(|found| {
            panel(
                &found,
                "lag (samples)",
                &format!("one-step error with itself{}", p(tests.whiteness_p)),
            )
        }),
        input.map(|found| {
            panel(
                &found,
                "lag of the input behind the error (samples)",
                &format!(
                    "one-step error with the input{}",
                    p(tests.input_correlation_p)
                ),
            )
        }),
    ];
    Figure {
        name: name.into(),
        title: title.into(),
        panels: panels.into_iter().flatten().collect(),
    }
}

fn panel(found: &Correlogram, x_label: &str, name: &str) -> Panel {
    let stem = |(&lag, &value): (&isize, &f64)| Mark {
        x: lag as f64,
        y: value,
        line: Some((value.min(0.0), value.max(0.0))),
    };
    let ends = [found.lags.first(), found.lags.last()];
    let ends: Vec<f64> = ends.into_iter().flatten().map(|&lag| lag as f64).collect();
    Panel {
        x_label: x_label.into(),
        y_label: "correlation".into(),
        legend: Legend::Above,
        bands: vec![Band {
            name: format!(
                "{} % of each lag, if there is nothing to find",
                100.0 * LEVEL
            ),
            ink: Ink::Model,
            points: ends
                .iter()
                .map(|&lag| (lag, -found.bound, found.bound))
                .collect(),
        }],
        curves: vec![Curve::dashed(
            "",
            Ink::Reference,
            ends.iter().map(|&lag| (lag, 0.0)),
        )],
        marks: vec![Marks {
            name: name.into(),
            ink: Ink::Measured,
            points: found.lags.iter().zip(&found.value).map(stem).collect(),
        }],
        ..Panel::default()
    }
}
