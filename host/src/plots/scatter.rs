//! How runs of one servo differ among themselves.

use super::figure::{Band, Curve, Figure, Ink, Legend, Mark, Marks, Panel};
use crate::summary::probability;
use servoid_identification::Model;
use servoid_identification::band::pointwise_critical;
use servoid_identification::runs::{Difference, RunComparison, RunDifference};
use servoid_identification::step::StepResponse;

/// Each run's own step response less the mean of all, and gain, delay and offset of each run against
/// the common model. `alone` are models of single runs, all with the same settling time; fewer than
/// two give no panel of curves.
#[must_use]
pub fn run_scatter(
    name: &str,
    title: &str,
    compared: &RunComparison,
    alone: &[Model],
    level: f64,
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
            (scale * value, scale * sd)
        }));
    }
    Figure {
        name: name.into(),
        title: title.into(),
        panels,
    }
}

/// How to read a number of a run.
type Number = fn(&RunDifference) -> Difference;

fn number(
    what: &str,
    compared: &RunComparison,
    level: f64,
    p: f64,
    of: impl Fn(&RunDifference) -> (f64, f64),
) -> Panel {
    let critical = pointwise_critical(level);
    let mark = |run: &RunDifference| {
        let (value, sd) = of(run);
        Mark {
            x: run.run as f64,
            y: value,
            line: Some((value - critical * sd, value + critical * sd)),
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
            name: format!(
                "{} % for noise alone; no scatter: {}",
                100.0 * level,
                probability(Some(p))
            ),
            ink: Ink::Measured,
            points: compared.runs.iter().map(mark).collect(),
        }],
        ..Panel::default()
    }
}

/// Step responses less their mean, in percent of the step. The band is where noise alone leaves one of
/// K runs: its own simultaneous bounds, narrower by sqrt(1 - 1/K) as it is part of the mean.
fn curves(alone: &[Model], level: f64) -> Option<Panel> {
    let points = alone.iter().map(|model| model.step.value.len()).min()?;
    let count = alone.len() as f64;
    if alone.len() < 2 || points == 0 {
        return None;
    }
    let mean_of = |of: &dyn Fn(&Model) -> f64| alone.iter().map(of).sum::<f64>() / count;
    let at = |curve: &[f64], m: usize| curve.get(m).copied().unwrap_or(f64::NAN);
    let gain = mean_of(&|model| at(&model.step.value, points - 1)).abs();
    let timing = alone.first()?.timing();
    let share = (1.0 - 1.0 / count).sqrt();
    let half_of =
        |step: &StepResponse, m: usize| at(&step.simultaneous.upper, m) - at(&step.value, m);
    let half = |m: usize| share * mean_of(&|model| half_of(&model.step, m));
    let band = (0..points).map(|m| {
        let half = 100.0 * half(m) / gain;
        (timing.seconds(m as f64), -half, half)
    });
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
        bands: vec![Band {
            name: format!("noise alone, the whole curve, {} %", 100.0 * level),
            ink: Ink::Reference,
            points: band.collect(),
        }],
        curves: alone.iter().enumerate().map(run).collect(),
        ..Panel::default()
    })
}
