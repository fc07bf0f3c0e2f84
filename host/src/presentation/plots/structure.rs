//! The choice of structure as a picture: a panel for each choice that was made from the data, and
//! what is left of the response at the end of the settling time.

use super::figure::{Band, Curve, Figure, Ink, Legend, Mark, Marks, Panel};
use servoid_identification::diagnostics::{Choice, Explanation};
use servoid_identification::results::{Model, ParameterBounds, pointwise_critical};
use servoid_identification::thresholds::MARGIN;

/// Settling time, noise order, number of frequencies, and the tail.
#[must_use]
pub fn structure(name: &str, title: &str, explanation: &Explanation, model: &Model) -> Figure {
    let mut panels = Vec::new();
    panels.extend(
        explanation
            .settling
            .as_ref()
            .map(|choice| settling(choice, model)),
    );
    panels.extend(tail(model));
    if !explanation.noise_orders.is_empty() {
        panels.push(noise_order(explanation, model));
    }
    if explanation.frequencies.len() > 1 {
        panels.push(frequencies(explanation, model));
    }
    Figure {
        name: name.into(),
        title: title.into(),
        panels,
    }
}

fn chosen(x: f64, y: f64) -> Vec<Marks> {
    vec![Marks {
        name: "chosen".into(),
        ink: Ink::Model,
        points: vec![Mark { x, y, line: None }],
    }]
}

fn settling(choice: &Choice, model: &Model) -> Panel {
    let line = |of: &dyn Fn(usize, usize) -> f64| -> Vec<(f64, f64)> {
        let points = choice.candidates.iter();
        points
            .map(|c| (c.settling as f64, of(c.settling, c.detected)))
            .collect()
    };
    let settling = model.structure.settling_samples;
    let found = choice.candidates.iter().find(|c| c.settling == settling);
    Panel {
        x_label: "settling time N considered (samples)".into(),
        y_label: "length needed (samples)".into(),
        curves: vec![
            Curve::solid(
                format!("{MARGIN} x the settling found with it"),
                Ink::Measured,
                line(&|_, detected| MARGIN * detected as f64),
            ),
            Curve::dashed(
                "N itself: enough below it",
                Ink::Reference,
                line(&|n, _| n as f64),
            ),
        ],
        marks: found.map_or_else(Vec::new, |c| {
            chosen(c.settling as f64, MARGIN * c.detected as f64)
        }),
        ..Panel::default()
    }
}

/// The response in the second half of its settling time as its distance from the final value, with pointwise
/// bounds where they hold. `None` for a document that describes no filter bank.
fn tail(model: &Model) -> Option<Panel> {
    let step = &model.step.value;
    let (last, final_value) = (step.len().checked_sub(1)?, *step.last()?);
    let percent = |x: f64| 100.0 * x / final_value.abs();
    let timing = model.timing();
    let points: Vec<(usize, f64, f64)> = (last / 2..=last)
        .zip(step.iter().skip(last / 2))
        .map(|(m, value)| (m, timing.seconds(m as f64), value - final_value))
        .collect();
    let band = |bounds: &ParameterBounds| -> Option<Band> {
        let half = half_widths_to_last(model, bounds)?;
        let bound = |&(m, t, distance): &(usize, f64, f64)| {
            let half = half.get(m).copied().unwrap_or(f64::NAN);
            (t, percent(distance - half), percent(distance + half))
        };
        Some(Band {
            name: "each point, no motion left where 0 is inside".into(),
            ink: Ink::Measured,
            points: points.iter().map(bound).collect(),
        })
    };
    let distances = points.iter().map(|&(_, t, x)| (t, percent(x)));
    Some(Panel {
        x_label: "time since the edge of the command (s)".into(),
        y_label: "still to go (% of the step)".into(),
        legend: Legend::UpperRight,
        bands: model.bounds.valid().and_then(band).into_iter().collect(),
        curves: vec![
            Curve::solid("tail of the step response", Ink::Measured, distances),
            Curve::dashed("", Ink::Reference, points.iter().map(|&(_, t, _)| (t, 0.0))),
        ],
        ..Panel::default()
    })
}

/// Half widths of the pointwise bounds of the distance of each sample from the last.
fn half_widths_to_last(model: &Model, bounds: &ParameterBounds) -> Option<Vec<f64>> {
    let map = model.basis().ok()?.step_map();
    let last = map.nrows().checked_sub(1)?;
    let critical = pointwise_critical(bounds.level);
    let half = |m: usize| {
        let q: Vec<f64> = (0..map.ncols())
            .map(|k| map[(m, k)] - map[(last, k)])
            .collect();
        let product = |row: &Vec<f64>| row.iter().zip(&q).map(|(c, b)| c * b).sum::<f64>();
        let variance: f64 = bounds
            .covariance
            .iter()
            .zip(&q)
            .map(|(row, a)| a * product(row))
            .sum();
        critical * variance.max(0.0).sqrt()
    };
    Some((0..=last).map(half).collect())
}

fn noise_order(explanation: &Explanation, model: &Model) -> Panel {
    let orders = &explanation.noise_orders;
    let best = orders.iter().map(|c| c.bic).fold(f64::INFINITY, f64::min);
    let points = orders.iter().map(|c| (c.order as f64, c.bic - best));
    let order = model.structure.noise_order;
    let found = orders.iter().find(|c| c.order == order);
    Panel {
        x_label: "noise order d".into(),
        y_label: "BIC above the smallest".into(),
        legend: Legend::UpperRight,
        curves: vec![Curve::solid("Bayes' criterion", Ink::Measured, points)],
        marks: found.map_or_else(Vec::new, |c| chosen(c.order as f64, c.bic - best)),
        ..Panel::default()
    }
}

/// Banks that exceed the best by more than this factor are not drawn: they would flatten the rest.
const WIDEST: f64 = 20.0;

/// The width of the band over n; without bounds, the error of predicting what was not seen.
fn frequencies(explanation: &Explanation, model: &Model) -> Panel {
    let n = model.structure.frequencies;
    let panel = |y_label: &str, curves: Vec<Curve>, at: &[(f64, f64)]| {
        let found = at.iter().find(|(count, _)| *count == n as f64);
        Panel {
            x_label: "number of frequencies n".into(),
            y_label: y_label.into(),
            legend: Legend::UpperRight,
            curves,
            marks: found.map_or_else(Vec::new, |(x, y)| chosen(*x, *y)),
            ..Panel::default()
        }
    };
    let banks = &explanation.frequencies;
    let widths: Vec<(f64, f64, f64)> = banks
        .iter()
        .filter_map(|bank| {
            Some((
                bank.frequencies as f64,
                bank.half_width()?,
                bank.noise_half_width?,
            ))
        })
        .collect();
    if widths.is_empty() {
        let least = banks
            .iter()
            .map(|bank| bank.gcv)
            .fold(f64::INFINITY, f64::min);
        let points: Vec<(f64, f64)> = banks
            .iter()
            .map(|bank| (bank.frequencies as f64, bank.gcv / least))
            .filter(|(_, error)| *error <= WIDEST)
            .collect();
        let curve = Curve::solid("cross-validation", Ink::Measured, points.iter().copied());
        return panel("prediction error, 1 = least", vec![curve], &points);
    }
    let narrowest = widths
        .iter()
        .map(|(_, half, _)| *half)
        .fold(f64::INFINITY, f64::min);
    let worth = || {
        widths
            .iter()
            .filter(|(_, half, _)| *half <= WIDEST * narrowest)
    };
    let whole: Vec<(f64, f64)> = worth().map(|(n, half, _)| (*n, *half)).collect();
    let noise = worth().map(|(n, _, noise)| (*n, *noise));
    let curves = vec![
        Curve::solid(
            "noise and what is left out",
            Ink::Measured,
            whole.iter().copied(),
        ),
        Curve::dashed("noise alone", Ink::Reference, noise),
    ];
    panel("half width of the band", curves, &whole)
}
