//! Whether the output stops at an angle within the range that is commanded, as at a mechanical stop.
//!
//! Where many strokes end there, no linear servo describes the record. The rests of held commands lie on a line, one end of which is flat:
//! what is beyond the stop rests at the same angle, short of that line ([`super::flat_end`]). That needs no model.
//!
//! Where few strokes do, their errors look like glitches, or like slow noise. There the model goes beyond the farthest that the output ever was,
//! and the output is at its farthest. A linear model has no stop; a servo model is given those that are found here.
//!
//! A sensor with large steps brings different commands to one reading anywhere: what is short by no more than its rounding is no stop.

use super::flat_end::TravelEnd;
use super::simulation_error::{Simulated, one_step_errors, simulated_whole};
use crate::data::{Moments, Record, sensor_step};
use crate::estimation::GlsFit;
use crate::numerics::median;
use crate::thresholds::{STOP_SAMPLES, STOP_SIGNIFICANCE};

impl TravelEnd {
    /// The ends of the travel in a record that a linear servo describes, or in one that none does.
    pub(crate) fn both(
        record: &Record,
        is_linear: bool,
        (moments, fit): (&Moments, &GlsFit),
    ) -> [Option<Self>; 2] {
        let of_rests = Self::of_rests(record);
        if of_rests.iter().any(Option::is_some) {
            return of_rests;
        }
        if !is_linear {
            return [None; 2];
        }
        let step = sensor_step(record).unwrap_or_default();
        let runs = simulated_whole(record, moments, fit);
        let gain: f64 = fit.impulse().iter().sum();
        let offset = fit.solution.offset();
        let rest_under = |command: f64| gain * (command - moments.centre.0) + offset;
        [1.0, -1.0]
            .map(|sign| Touched::by(&runs, sign, (moments.centre.1, step), &rest_under).end(fit))
    }
}

/// What one of several runs is above the model: where the zero of the sensor moves, the model goes beyond the farthest output for that alone.
fn offset(run: &Simulated<'_>) -> f64 {
    let errors = run.errors.iter().filter(|error| !error.is_nan());
    let above = run
        .is_one_of_several()
        .then(|| median(errors.copied().collect()));
    above.flatten().unwrap_or_default()
}

/// The stretches in which the output is at its farthest, up or down, while the model goes beyond that.
struct Touched<'a> {
    runs: &'a [Simulated<'a>],
    /// Command and output of each.
    strokes: Vec<(f64, f64)>,
    /// How far the model goes beyond there, of each run; 0 elsewhere.
    beyond: Vec<Vec<f64>>,
}

impl<'a> Touched<'a> {
    /// Those up (`sign` 1) or down (-1). Outputs of the model count from `centre`, and the
    /// sensor has steps of `step`. The model rests at `rest_under` a command: where it only passes there, the servo may pass less.
    fn by(
        runs: &'a [Simulated<'a>],
        sign: f64,
        (centre, step): (f64, f64),
        rest_under: &dyn Fn(f64) -> f64,
    ) -> Self {
        let mut all = Self {
            runs,
            strokes: Vec::new(),
            beyond: Vec::new(),
        };
        for run in runs {
            let measured = run.run.output();
            let far = |far: f64, y: &f64| far.max(sign * y);
            let farthest = measured.iter().fold(f64::NEG_INFINITY, far);
            let nearest = measured
                .iter()
                .fold(f64::INFINITY, |near, y| near.min(sign * y));
            let notable = (NOTABLE * (farthest - nearest)).max(step);
            let zero = centre + offset(run);
            let beyond = |k: usize| {
                let passes = sign * run.output[k];
                let rests = sign * rest_under(run.run.input()[k]);
                passes.min(rests) + sign * zero - farthest
            };
            let mut samples: Vec<usize> = (0..measured.len())
                .filter(|k| beyond(*k) > notable)
                .collect();
            // The model of most records goes nowhere beyond their outputs.
            if !samples.is_empty() {
                let errors = run.errors.iter().filter(|error| !error.is_nan());
                let usual = median(errors.map(|error| error.abs()).collect()).unwrap_or_default();
                samples.retain(|k| sign * measured[*k] > farthest - FARTHEST * usual);
            }
            let stretches = samples.chunk_by(|before, after| *after == before + 1);
            let mut by_sample = vec![0.0; measured.len()];
            for stretch in stretches.filter(|stretch| stretch.len() >= STOP_SAMPLES) {
                let rests = stretch.iter().map(|k| measured[*k]).sum::<f64>();
                let commands = stretch.iter().map(|k| run.run.input()[*k]);
                let command = commands.reduce(|far, u| if sign * u > sign * far { u } else { far });
                let rest = rests / stretch.len() as f64;
                all.strokes.push((command.unwrap_or(f64::NAN), rest));
                for k in stretch {
                    by_sample[*k] = sign * beyond(*k);
                }
            }
            all.beyond.push(by_sample);
        }
        all
    }

    /// The end of the travel there, beyond chance.
    fn end(mut self, fit: &GlsFit) -> Option<TravelEnd> {
        if self.strokes.is_empty() || !self.is_beyond_chance(fit) {
            return None;
        }
        self.strokes.sort_by(|a, b| a.0.abs().total_cmp(&b.0.abs()));
        let (first, last) = (self.strokes.first()?, self.strokes.last()?);
        let rests = self.strokes.iter().map(|(_, rest)| rest);
        Some(TravelEnd {
            rest: rests.sum::<f64>() / self.strokes.len() as f64,
            commands: (first.0, last.0),
            count: self.strokes.len(),
        })
    }

    /// Whether the errors say that the output stays behind there: a score test of the regressor, one step ahead.
    fn is_beyond_chance(&self, fit: &GlsFit) -> bool {
        let (mut score, mut information) = (0.0, 0.0);
        for (run, beyond) in self.runs.iter().zip(&self.beyond) {
            let errors = one_step_errors(run.own_errors(), &fit.ar);
            let beyond = one_step_errors(beyond, &fit.ar);
            let known = errors
                .iter()
                .zip(&beyond)
                .filter(|(e, x)| !(**e * **x).is_nan());
            for (error, beyond) in known {
                score -= error * beyond;
                information += beyond * beyond;
            }
        }
        score > STOP_SIGNIFICANCE * (fit.variance * information).sqrt()
    }
}

/// How far the model must go beyond the farthest output, as a part of the range: rounding does so, too.
const NOTABLE: f64 = 1e-3;

/// Median errors within which outputs are at one angle: of Gaussian noise that is 0.67 standard deviations, and some hundred samples lie
/// within 4 on both sides.
const FARTHEST: f64 = 12.0;
