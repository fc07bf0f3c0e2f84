//! How runs of one servo differ among themselves.

use super::figure::{Band, Curve, Figure, Ink, Legend, Mark, Marks, Panel};
use crate::presentation::summary::{percent, probability};
use servoid_identification::diagnostics::{Difference, RunComparison, RunDifference};
use servoid_identification::results::{Model, StepBounds, pointwise_critical};

/// Each run's own step response less the mean of all, and gain, delay and offset of each run against
/// the common model. `alone` are models of single runs, all with the same settling time; fewer than
/// two give no panel of curves. `level` is that of the bounds, `None` where none can be given.
#[must_use]
pub fn run_scatter(
    name: &str,
    title: &str,
    compared: &RunComparison,
    alone: &[Model],
    level: Option<f64>,
    unit: Option<&str>,
) -> Figure {
    let mut panels = Vec::new();
    panels.extend(curves(alone, level));
    let offset = unit.map_or_else(|| "offset".to_owned(), |unit| format!("offset ({unit})"));
    let numbers: [(&str, f64, f64, Number); 3] = [
        ("gain (%)", 1.0, compared.gain_percent.p, |run| {
            run.gain_percent
        }),
        ("delay (ms)", 1e3, compared.delay_s.p, |run| run.delay_s),
        (&offset, 1.0, compared.offset.p, |run| run.offset),
    ];
    for (what, scale, p, of) in numbers {
        panels.push(number(what, compared, level, p, |run| {
            let Difference { value, sd } = of(run);
            (scale * value, sd.map(|sd| scale * sd))
        }));
    }
    Figure {
        name: name.into(),
        title: title.into(),
        panels,
    }
}

/// What the legend calls numbers whose errors are not noise.
const NO_BOUNDS: &str = "as estimated: no bounds can be given";

/// How to read a number of a run.
type Number = fn(&RunDifference) -> Difference;

fn number(
    what: &str,
    compared: &RunComparison,
    level: Option<f64>,
    p: f64,
    of: impl Fn(&RunDifference) -> (f64, Option<f64>),
) -> Panel {
    let critical = level.map(pointwise_critical);
    let mark = |run: &RunDifference| {
        let (value, sd) = of(run);
        Mark {
            x: run.run as f64,
            y: value,
            line: critical
                .zip(sd)
                .map(|(critical, sd)| (value - critical * sd, value + critical * sd)),
        }
    };
    let ends = [compared.runs.first(), compared.runs.last()];
    let zero = ends.into_iter().flatten().map(|run| (run.run as f64, 0.0));
    Panel {
        x_label: "run".into(),
        y_label: format!("run - all: {what}"),
        legend: Legend::Above,
        curves: vec![Curve::dashed("", Ink::Reference, zero)],
        marks: vec![Marks {
            name: level.map_or_else(
                || NO_BOUNDS.to_owned(),
                |level| {
                    format!(
                        "{} % for noise alone; no scatter: {}",
                        percent(level),
                        probability(Some(p))
                    )
                },
            ),
            ink: Ink::Measured,
            points: compared.runs.iter().map(mark).collect(),
        }],
        ..Panel::default()
    }
}

/// Step responses less their mean, in percent of the step. The band is where noise alone leaves one of
/// K runs: its own simultaneous bounds, narrower by sqrt(1 - 1/K) as it is part of the mean.
fn curves(alone: &[Model], level: Option<f64>) -> Option<Panel> {
    let points = alone.iter().map(|model| model.step.value.len()).min()?;
    let count = alone.len() as f64;
    if alone.len() < 2 || points == 0 {
        return None;
    }
    let mean_of = |of: &dyn Fn(&Model) -> f64| alone.iter().map(of).sum::<f64>() / count;
    let at = |curve: &[f64], m: usize| curve.get(m).copied().unwrap_or(f64::NAN);
    let gain = mean_of(&|model| at(&model.step.value, points - 1)).abs();
    let timing = alone.first()?.timing();
    // The mean of bounds is one only where each of them is.
    let bounds: Option<Vec<&StepBounds>> = alone
        .iter()
        .map(|model| model.step.bounds.valid())
        .collect();
    let band = |(level, bounds): (f64, Vec<&StepBounds>)| {
        let share = (1.0 - 1.0 / count).sqrt();
        let half_of = |bounds: &&StepBounds, m: usize| {
            let whole = &bounds.simultaneous;
            (at(&whole.upper, m) - at(&whole.lower, m)) / 2.0
        };
        let half = |m: usize| share * bounds.iter().map(|b| half_of(b, m)).sum::<f64>() / count;
        Band {
            name: format!("noise alone, the whole curve, {} %", percent(level)),
            ink: Ink::Reference,
            points: (0..points)
                .map(|m| (timing.seconds(m as f64), 100.0 * half(m) / gain))
                .map(|(time, half)| (time, -half, half))
                .collect(),
        }
    };
    let mean: Vec<f64> = (0..points)
        .map(|m| mean_of(&|model| at(&model.step.value, m)))
        .collect();
    let run = |(index, model): (usize, &Model)| {
        let difference = model.step.value.iter().zip(&mean).enumerate();
        let points =
            difference.map(|(m, (g, mean))| (timing.seconds(m as f64), 100.0 * (g - mean) / gain));
        Curve::solid(format!("run {}", index + 1), Ink::of_run(index), points)
    };
    Some(Panel {
        x_label: "time since the edge of the command (s)".into(),
        y_label: "run - mean (% of the step)".into(),
        legend: Legend::Above,
        bands: level.zip(bounds).map(band).into_iter().collect(),
        curves: alone.iter().enumerate().map(run).collect(),
        ..Panel::default()
    })
}
