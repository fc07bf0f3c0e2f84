//! Correlations of a model's one-step errors with themselves and with the input.

use super::figure::{Band, Curve, Figure, Ink, Legend, Mark, Marks, Panel};
use crate::presentation::summary::probability;
use servoid_identification::Record;
use servoid_identification::diagnostics::{Correlogram, WHITENESS_LAGS};
use servoid_identification::results::Model;

/// Lags of the input shown before the present and beyond the settling time.
const AROUND: isize = 25;

/// Share of the lags that lie within their bound if the errors are noise.
const LEVEL: f64 = 0.99;

/// Both correlograms, with the p-values of the tests that belong to them in the legend. A record
/// without errors gives no panels.
#[must_use]
pub fn residuals(name: &str, title: &str, model: &Model, record: &Record) -> Figure {
    let beyond = model.structure.settling_samples as isize + AROUND;
    let tests = &model.residuals;
    let own = Correlogram::of_errors(model, record, 2 * WHITENESS_LAGS, LEVEL);
    let input = Correlogram::with_input(model, record, -AROUND..=beyond, LEVEL);
    let own = own.map(|found| panel(&found, "lag (samples)", "itself", tests.whiteness_p));
    let input = input.map(|found| {
        let x_label = "lag of the input behind the error (samples)";
        panel(&found, x_label, "the input", tests.input_correlation_p)
    });
    Figure::new(name, title, own.into_iter().chain(input).collect())
}

fn panel(found: &Correlogram, x_label: &str, with: &str, p: Option<f64>) -> Panel {
    let stem = |(&lag, &value): (&isize, &f64)| Mark {
        x: lag as f64,
        y: value,
        line: Some((value.min(0.0), value.max(0.0))),
    };
    let ends = [found.lags.first(), found.lags.last()];
    let ends: Vec<f64> = ends.into_iter().flatten().map(|&lag| lag as f64).collect();
    let bound = |&lag: &f64| (lag, -found.bound, found.bound);
    Panel {
        bands: vec![Band {
            name: format!(
                "{} % of each lag, if there is nothing to find",
                100.0 * LEVEL
            ),
            ink: Ink::Model,
            points: ends.iter().map(bound).collect(),
        }],
        curves: vec![Curve::dashed(
            "",
            Ink::Reference,
            ends.iter().map(|&lag| (lag, 0.0)),
        )],
        marks: vec![Marks {
            name: format!("one-step error with {with}, {}", probability(p)),
            ink: Ink::Measured,
            points: found.lags.iter().zip(&found.value).map(stem).collect(),
        }],
        ..Panel::new(x_label, "correlation", Legend::Above)
    }
}
