//! Whether the output stops at an angle within the range that is commanded, as at a mechanical stop.
//!
//! Where many strokes end there, no linear servo describes the record. The rests of held commands lie on a line, one end of which is flat:
//! what is beyond the stop rests at the same angle, short of that line ([`crate::diagnostics::travel::flat_end`]). That needs no model.
//!
//! Where few strokes do, their errors look like glitches, or like slow noise. There the model goes beyond the farthest that the output ever was,
//! and the output is at its farthest. A linear model has no stop; a servo model is given those that are found here.
//!
//! A sensor with large steps brings different commands to one reading anywhere: what is short by no more than its rounding is no stop.

use super::flat_end::TravelEnd;
use super::rests::{Rest, rests, rests_with_outputs_of};
use crate::data::column::span;
use crate::data::{Moments, Record, sensor_step};
use crate::diagnostics::residuals::simulation_error::{
    Simulated, one_step_errors, simulated_whole,
};
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
        if !is_linear {
            return Self::of_rests(record);
        }
        let runs = simulated_whole(record, moments, fit);
        let model = StaticLine {
            gain: fit.impulse().iter().sum(),
            offset: fit.solution.offset(),
            centre: moments.centre,
            settling: fit.coordinates.basis.settling(),
        };
        let of_rests = Self::of_rests(record);
        if of_rests.iter().any(Option::is_some) {
            let still = rests_with_outputs_of(record, &model.without_motion(record, &runs));
            let seen = rests(record);
            let is_stop = |end: &Self| {
                model.short_of(&still, end) > LEFT_AT_REST * model.short_of(&seen, end)
            };
            let stops = of_rests.map(|end| end.filter(is_stop));
            if stops.iter().any(Option::is_some) {
                return stops;
            }
        }
        let step = sensor_step(record).unwrap_or_default();
        [1.0, -1.0].map(|sign| Touched::by(&runs, sign, step, &model).end(fit, model.gain))
    }
}

/// What is left of an end, as a share, where the servo is at rest there: of one that is the motion of a linear servo the model takes most.
const LEFT_AT_REST: f64 = 0.5;

/// Where the model rests. Inputs and outputs of it count from `centre`.
struct StaticLine {
    gain: f64,
    offset: f64,
    centre: (f64, f64),
    /// Samples after which it does.
    settling: usize,
}

impl StaticLine {
    fn under(&self, command: f64) -> f64 {
        self.gain * (command - self.centre.0) + self.offset
    }

    /// How far the `rests` under the commands of an `end` are from where the model rests, on average.
    fn short_of(&self, rests: &[Rest], end: &TravelEnd) -> f64 {
        let (first, last) = end.commands;
        let there = first.min(last)..=first.max(last);
        let of_end = rests.iter().filter(|rest| there.contains(&rest.command));
        let (sum, count) = of_end.fold((0.0, 0.0), |(sum, count), rest| {
            let short = self.under(rest.command) + self.centre.1 - rest.output;
            (sum + short, count + 1.0)
        });
        f64::abs(sum / count)
    }

    /// `record` as if the model was at rest under each command: a linear servo that still rings or creeps when a hold ends is not where it would rest.
    fn without_motion<'r>(&self, record: &Record<'r>, runs: &[Simulated<'_>]) -> Record<'r> {
        let still = |run: &Simulated<'_>| {
            let commands = run.run.input().iter();
            let pairs = commands.zip(&run.errors);
            pairs
                .map(|(command, error)| self.under(*command) + self.centre.1 + error)
                .collect()
        };
        let runs = (record.runs().iter().zip(runs)).map(|(run, by)| run.with_output(still(by)));
        record.with_runs(runs.collect())
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

/// The strokes in which the output is at its farthest, up or down, while the model goes beyond that.
struct Touched<'a> {
    runs: &'a [Simulated<'a>],
    strokes: Vec<Stroke>,
    /// How far the model goes beyond there, of each run; 0 elsewhere.
    beyond: Vec<Vec<f64>>,
}

/// One of the strokes that end there.
struct Stroke {
    /// The outermost one before its end.
    command: f64,
    /// Mean output.
    rest: f64,
    /// How far the model goes beyond the farthest output.
    short: f64,
}

impl<'a> Touched<'a> {
    /// Those up (`sign` 1) or down (-1), of a sensor with steps of `step`.
    fn by(runs: &'a [Simulated<'a>], sign: f64, step: f64, model: &StaticLine) -> Self {
        let mut all = Self {
            runs,
            strokes: Vec::new(),
            beyond: Vec::new(),
        };
        for run in runs {
            let side = OneSide::new(run, sign, model);
            let touching = side.touching(step);
            let mut by_sample = vec![0.0; run.output.len()];
            for k in &touching {
                by_sample[*k] = sign * side.beyond(*k);
            }
            all.beyond.push(by_sample);
            // Noise breaks a stroke in pieces; between two strokes the model comes back.
            let is_beyond = |from: usize, to: usize| (from..to).all(|k| side.beyond(k) > 0.0);
            let strokes = touching.chunk_by(|before, after| is_beyond(*before, *after));
            all.strokes
                .extend(strokes.map(|stroke| side.stroke(stroke)));
        }
        all
    }

    /// The end of the travel there, beyond chance, where a stroke of the command is `gain` times as large at rest.
    fn end(mut self, fit: &GlsFit, gain: f64) -> Option<TravelEnd> {
        if self.strokes.is_empty() || !self.is_beyond_chance(fit) {
            return None;
        }
        self.strokes
            .sort_by(|a, b| a.command.abs().total_cmp(&b.command.abs()));
        let (first, last) = (self.strokes.first()?, self.strokes.last()?);
        let rests = self.strokes.iter().map(|stroke| stroke.rest);
        Some(TravelEnd {
            rest: rests.sum::<f64>() / self.strokes.len() as f64,
            commands: (first.command, last.command),
            count: self.strokes.len(),
            is_shown: are_apart(&self.strokes, gain),
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

/// Whether the commands of strokes to one angle are as far apart as an end asks for, where a stroke of the command is `gain` times as large at rest. A dead band,
/// or friction, leaves strokes to one command short by as much.
fn are_apart(strokes: &[Stroke], gain: f64) -> bool {
    let commands = || strokes.iter().map(|stroke| gain * stroke.command);
    let short = (strokes.iter()).fold(0.0, |most, stroke| stroke.short.max(most));
    span(commands()).is_some_and(|apart| apart > APART * short)
}

/// One side of the motion in one run: outputs up (`sign` 1) or down (-1).
struct OneSide<'a> {
    run: &'a Simulated<'a>,
    sign: f64,
    model: &'a StaticLine,
    /// What the output of the run counts from.
    zero: f64,
    /// The farthest output and the nearest one, times the sign.
    farthest: f64,
    nearest: f64,
}

impl<'a> OneSide<'a> {
    fn new(run: &'a Simulated<'a>, sign: f64, model: &'a StaticLine) -> Self {
        let outputs = || run.run.output().iter().map(|y| sign * y);
        Self {
            run,
            sign,
            model,
            zero: model.centre.1 + offset(run),
            farthest: outputs().fold(f64::NEG_INFINITY, f64::max),
            nearest: outputs().fold(f64::INFINITY, f64::min),
        }
    }

    /// How far the model goes beyond the farthest output in sample `k`. Where it only passes there and rests elsewhere, the servo may pass less.
    fn beyond(&self, k: usize) -> f64 {
        let passes = self.sign * self.run.output[k];
        let rests = self.sign * self.model.under(self.run.run.input()[k]);
        passes.min(rests) + self.sign * self.zero - self.farthest
    }

    /// Samples of stretches in which the output is at its farthest, while the model is beyond it.
    fn touching(&self, step: f64) -> Vec<usize> {
        let measured = self.run.run.output();
        let notable = (NOTABLE * (self.farthest - self.nearest)).max(step);
        let mut samples: Vec<usize> = (0..measured.len())
            .filter(|k| self.beyond(*k) > notable)
            .collect();
        // The model of most records goes nowhere beyond their outputs.
        if !samples.is_empty() {
            let errors = self.run.errors.iter().filter(|error| !error.is_nan());
            let usual = median(errors.map(|error| error.abs()).collect()).unwrap_or_default();
            samples.retain(|k| self.sign * measured[*k] > self.farthest - FARTHEST * usual);
        }
        let stretches = samples.chunk_by(|before, after| *after == before + 1);
        let long = stretches.filter(|stretch| stretch.len() >= STOP_SAMPLES);
        long.flatten().copied().collect()
    }

    /// The stroke that ends in these samples.
    fn stroke(&self, samples: &[usize]) -> Stroke {
        let rests = samples.iter().map(|k| self.run.run.output()[*k]);
        let towards = self.sign * self.model.gain;
        let outermost = |far: f64, u: f64| if towards * u > towards * far { u } else { far };
        // The command goes ahead of the model.
        let first = samples[0].saturating_sub(self.model.settling);
        let commands = &self.run.run.input()[first..=samples[samples.len() - 1]];
        Stroke {
            command: commands
                .iter()
                .copied()
                .reduce(outermost)
                .unwrap_or(f64::NAN),
            rest: rests.sum::<f64>() / samples.len() as f64,
            short: samples.iter().map(|k| self.beyond(*k)).fold(0.0, f64::max),
        }
    }
}

/// How far the model must go beyond the farthest output, as a part of the range: rounding does so, too.
const NOTABLE: f64 = 1e-3;

/// The commands of strokes that end at a stop are so many times as far apart as the farthest of them goes beyond, at the least.
const APART: f64 = 0.5;

/// Median errors within which outputs are at one angle: of Gaussian noise that is 0.67 standard deviations, and some hundred samples lie
/// within 4 on both sides.
const FARTHEST: f64 = 12.0;

#[cfg(test)]
mod tests {
    use super::{Stroke, are_apart};

    #[test]
    fn commands_that_differ_show_an_end_and_one_shows_none() {
        let strokes = |commands: &[f64], end: f64| -> Vec<Stroke> {
            let stroke = |command: &f64| Stroke {
                command: *command,
                rest: end,
                short: 0.5 * command - end,
            };
            commands.iter().map(stroke).collect()
        };
        assert!(are_apart(&strokes(&[9.2, 10.0, 9.7], 4.5), 0.5));
        // A dead band of 0.2 under a sine, as rounded as its command.
        assert!(!are_apart(&strokes(&[10.0, 9.99, 10.0], 4.9), 0.5));
        assert!(!are_apart(&strokes(&[10.0], 4.5), 0.5));
    }
}
