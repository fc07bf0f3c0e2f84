//! How runs of one servo differ among themselves.

use super::figure::{
    Band, Curve, Figure, Ink, Legend, Mark, Marks, Panel, SINCE_EDGE_LABEL, milliseconds, with_unit,
};
use crate::presentation::summary::{percent, probability};
use servoid_identification::diagnostics::{Difference, RunComparison, RunDifference};
use servoid_identification::results::{Model, StepBounds, pointwise_critical};

/// Each run's own step response less the mean of all, and gain, delay and offset at the mean command of each run
/// against the common model. `alone` are models of single runs, all with the same settling time; fewer than
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
    let number = |what: &str, scale: f64, p: f64, of: fn(&RunDifference) -> Difference| {
        number(what, compared, level, p, |run| {
            let Difference { value, sd } = of(run);
            (scale * value, sd.map(|sd| scale * sd))
        })
    };
    let panels = [
        number("gain (%)", 1.0, compared.gain_percent.p, |run| {
            run.gain_percent
        }),
        number("delay (ms)", 1e3, compared.delay_s.p, |run| run.delay_s),
        number(
            &with_unit("offset at the mean command", unit),
            1.0,
            compared.offset.p,
            |run| run.offset,
        ),
    ];
    Figure::new(
        name,
        title,
        curves(alone, level).into_iter().chain(panels).collect(),
    )
}

fn number(
    what: &str,
    compared: &RunComparison,
    level: Option<f64>,
    p: f64,
    of: impl Fn(&RunDifference) -> (f64, Option<f64>),
) -> Panel {
    let critical = level.map(pointwise_critical);
    let mark = |run: &RunDifference| {
        let (y, sd) = of(run);
        let interval = |(critical, sd): (f64, f64)| (y - critical * sd, y + critical * sd);
        let line = critical.zip(sd).map(interval);
        Mark {
            x: run.run as f64,
            y,
            line,
        }
    };
    let name = match level.map(percent) {
        Some(level) => format!(
            "{level} % for noise alone; no scatter: {}",
            probability(Some(p))
        ),
        None => "as estimated: no bounds can be given".to_owned(),
    };
    let ends = [compared.runs.first(), compared.runs.last()];
    let zero = ends.into_iter().flatten().map(|run| (run.run as f64, 0.0));
    let points = compared.runs.iter().map(mark).collect();
    Panel {
        curves: vec![Curve::dashed("", Ink::Reference, zero)],
        marks: vec![Marks {
            name,
            ink: Ink::Measured,
            points,
        }],
        ..Panel::new("run", format!("run - all: {what}"), Legend::Above)
    }
}

/// Colours of the runs; from the sixth on they come again.
const RUNS: [Ink; 5] = [
    Ink::Measured,
    Ink::Model,
    Ink::SecondModel,
    Ink::Third,
    Ink::Fourth,
];

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
    let bounds = alone.iter().map(|model| model.step.bounds.valid());
    let bounds: Option<Vec<&StepBounds>> = bounds.collect();
    let band = |(level, bounds): (f64, Vec<&StepBounds>)| {
        let share = (1.0 - 1.0 / count).sqrt();
        let half_of = |bounds: &&StepBounds, m: usize| {
            let whole = &bounds.simultaneous;
            (at(&whole.upper, m) - at(&whole.lower, m)) / 2.0
        };
        let point = |m: usize| {
            let half = share * bounds.iter().map(|b| half_of(b, m)).sum::<f64>() / count;
            let half = 100.0 * half / gain;
            (milliseconds(timing.seconds(m as f64)), -half, half)
        };
        Band {
            name: format!("noise alone, the whole curve, {} %", percent(level)),
            ink: Ink::Reference,
            points: (0..points).map(point).collect(),
        }
    };
    let mean = (0..points).map(|m| mean_of(&|model| at(&model.step.value, m)));
    let mean: Vec<f64> = mean.collect();
    let run = |((model, ink), number): ((&Model, &Ink), usize)| {
        let difference = model.step.value.iter().zip(&mean).zip(0..);
        let percent = |((g, mean), m)| {
            (
                milliseconds(timing.seconds(f64::from(m))),
                100.0 * (g - mean) / gain,
            )
        };
        Curve::solid(format!("run {number}"), *ink, difference.map(percent))
    };
    let runs = alone.iter().zip(RUNS.iter().cycle()).zip(1..);
    Some(Panel {
        bands: level.zip(bounds).map(band).into_iter().collect(),
        curves: runs.map(run).collect(),
        ..Panel::new(
            SINCE_EDGE_LABEL,
            "run - mean (% of the step)",
            Legend::Above,
        )
    })
}
