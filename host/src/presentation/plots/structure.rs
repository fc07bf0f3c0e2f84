//! The choice of structure as a picture: a panel for each choice that was made from the data, and
//! what is left of the response at the end of the settling time.

use super::figure::{
    Band, Curve, Figure, Ink, Legend, Mark, Marks, Panel, SINCE_EDGE_LABEL, milliseconds,
};
use servoid_identification::diagnostics::{Bank, Choice, Explanation};
use servoid_identification::results::{Model, ParameterBounds, pointwise_critical};
use servoid_identification::thresholds::MARGIN;

/// Settling time, noise order, number of frequencies, and the tail.
#[must_use]
pub fn structure(name: &str, title: &str, explanation: &Explanation, model: &Model) -> Figure {
    let choice = explanation.settling.as_ref();
    let settling = choice.map(|choice| settling(choice, model));
    let mut panels: Vec<Panel> = settling.into_iter().chain(tail(model)).collect();
    if !explanation.noise_orders.is_empty() {
        panels.push(noise_order(explanation, model));
    }
    if explanation.frequencies.len() > 1 {
        panels.push(frequencies(explanation, model));
    }
    Figure::new(name, title, panels)
}

fn chosen(x: f64, y: f64) -> Vec<Marks> {
    vec![Marks {
        name: "chosen".into(),
        ink: Ink::Model,
        points: vec![Mark { x, y, line: None }],
    }]
}

fn settling(choice: &Choice, model: &Model) -> Panel {
    let needed = |detected: usize| MARGIN * detected as f64;
    let candidates = || choice.candidates.iter();
    let settling = model.structure.settling_samples;
    let found = candidates().find(|c| c.settling == settling);
    let measured = candidates().map(|c| (c.settling as f64, needed(c.detected)));
    let itself = candidates().map(|c| (c.settling as f64, c.settling as f64));
    Panel {
        curves: vec![
            Curve::solid(
                format!("{MARGIN} x the settling found with it"),
                Ink::Measured,
                measured,
            ),
            Curve::dashed("N itself: enough below it", Ink::Reference, itself),
        ],
        marks: found.map_or_else(Vec::new, |c| chosen(c.settling as f64, needed(c.detected))),
        ..Panel::new(
            "settling time N considered (samples)",
            "length needed (samples)",
            Legend::LowerRight,
        )
    }
}

/// The response in the second half of its settling time as its distance from the final value, with pointwise
/// bounds where they hold. `None` for a document that describes no filter bank.
fn tail(model: &Model) -> Option<Panel> {
    let step = &model.step.value;
    let (last, final_value) = (step.len().checked_sub(1)?, *step.last()?);
    let percent = |x: f64| 100.0 * x / final_value.abs();
    let timing = model.timing();
    let ms = |m: usize| milliseconds(timing.seconds(m as f64));
    let points: Vec<(usize, f64, f64)> = (last / 2..=last)
        .zip(step.iter().skip(last / 2))
        .map(|(m, value)| (m, ms(m), value - final_value))
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
        bands: model.bounds.valid().and_then(band).into_iter().collect(),
        curves: vec![
            Curve::solid("tail of the step response", Ink::Measured, distances),
            Curve::dashed("", Ink::Reference, points.iter().map(|&(_, t, _)| (t, 0.0))),
        ],
        ..Panel::new(
            SINCE_EDGE_LABEL,
            "still to go (% of the step)",
            Legend::UpperRight,
        )
    })
}

/// Half widths of the pointwise bounds of the distance of each sample from the last.
fn half_widths_to_last(model: &Model, bounds: &ParameterBounds) -> Option<Vec<f64>> {
    let map = model.basis().ok()?.step_map();
    let last = map.nrows().checked_sub(1)?;
    let critical = pointwise_critical(bounds.level);
    let half = |m: usize| {
        let q = (0..map.ncols()).map(|k| map[(m, k)] - map[(last, k)]);
        let q: Vec<f64> = q.collect();
        let product = |row: &Vec<f64>| row.iter().zip(&q).map(|(c, b)| c * b).sum::<f64>();
        let rows = bounds.covariance.iter().zip(&q);
        let variance: f64 = rows.map(|(row, a)| a * product(row)).sum();
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
        curves: vec![Curve::solid("Bayes' criterion", Ink::Measured, points)],
        marks: found.map_or_else(Vec::new, |c| chosen(c.order as f64, c.bic - best)),
        ..Panel::new(
            "noise order d",
            "BIC above the smallest",
            Legend::UpperRight,
        )
    }
}

/// Banks that exceed the best by more than this factor are not drawn: they would flatten the rest.
const WIDEST: f64 = 20.0;

/// The width of the band over n; in a model without bounds, the error of prediction.
fn frequencies(explanation: &Explanation, model: &Model) -> Panel {
    let has_bounds = model.bounds.valid().is_some();
    let of = |bank: &Bank| match has_bounds {
        true => bank.half_width(),
        false => Some(bank.gcv),
    };
    let all = explanation.frequencies.iter();
    let all = all.filter_map(|bank| Some((bank.frequencies as f64, of(bank)?, bank)));
    let least = all.clone().map(|(_, y, _)| y).fold(f64::INFINITY, f64::min);
    let drawn = all.filter(|(_, y, _)| *y <= WIDEST * least);
    let points = drawn.clone().map(|(n, y, _)| (n, y));
    let noise = drawn.filter_map(|(n, _, bank)| Some((n, bank.noise_half_width?)));
    let (title, curves) = match has_bounds {
        true => (
            "half width of the band",
            vec![
                Curve::solid("noise and what is left out", Ink::Measured, points.clone()),
                Curve::dashed("noise alone", Ink::Reference, noise),
            ],
        ),
        false => (
            "error of prediction",
            vec![Curve::solid(
                "cross-validation",
                Ink::Measured,
                points.clone(),
            )],
        ),
    };
    let mut found = points.filter(|(n, _)| *n == model.structure.frequencies as f64);
    Panel {
        curves,
        marks: found.next().map_or_else(Vec::new, |(n, y)| chosen(n, y)),
        ..Panel::new("number of frequencies n", title, Legend::UpperRight)
    }
}
