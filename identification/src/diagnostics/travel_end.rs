//! Whether the output stops at an angle within the range that is commanded, as at a mechanical stop.
//!
//! Where many strokes end there, no linear servo describes the record. The rests of held commands lie on a line, one end of which is flat:
//! commands that differ by a notable part of the range reach the same angle. That needs no model.
//!
//! Where one of several levels lies beyond the stop, that level falls short of the line through the others ([`super::end_level`]).
//!
//! Where few strokes do, their errors look like glitches, or like slow noise. There the model goes beyond the farthest that the output ever was,
//! and the output is at its farthest. A linear model has no stop; a servo model is given those that are found here.
//!
//! A sensor with large steps brings different commands to one reading anywhere: what is short by no more than its rounding is no stop.

use super::end_level::ShortLevel;
use super::simulation_error::{Simulated, one_step_errors, simulated_whole};
use crate::data::{
    EXACTLY, Hold, Moments, Record, Run, holds, last_quarter, mean_output, sensor_step,
};
use crate::estimation::GlsFit;
use crate::numerics::median;
use crate::thresholds::{STOP_GAIN, STOP_SAMPLES, STOP_SHARE, STOP_SIGNIFICANCE};

/// Different commands that must rest at the end, and elsewhere.
const FEWEST: (usize, usize) = (2, 3);

/// Commands at which the output rests at one angle, beside those at which it follows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct TravelEnd {
    /// Where it rests \[output\].
    pub(crate) rest: f64,
    /// The command from which on it does, and the last one \[input\].
    pub(crate) commands: (f64, f64),
    /// How many commands between the two rest there.
    pub(crate) count: usize,
}

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
        let step = sensor_step(record).unwrap_or_default();
        let runs = simulated_whole(record, moments, fit);
        let short = ShortLevel::both(&runs, fit.impulse().len(), (fit.theta()[0], step));
        if short.iter().any(Option::is_some) {
            return short.map(|found| {
                found.map(|found| Self {
                    rest: found.rest,
                    commands: (found.level, found.level),
                    count: 1,
                })
            });
        }
        if !is_linear {
            return [None; 2];
        }
        [1.0, -1.0].map(|sign| Touched::by(&runs, sign, (moments.centre.1, step)).end(fit))
    }

    /// The ends within the range of the commands that are held, by the rests alone.
    pub(crate) fn of_rests(record: &Record) -> [Option<Self>; 2] {
        let step = sensor_step(record).unwrap_or_default();
        let rests = rests_by_command(record);
        let reversed: Vec<_> = rests.iter().rev().copied().collect();
        [rests, reversed].map(|rests| flat_end(&rests, step))
    }
}

/// Where the output rests under the lowest and the highest command that is held until it does; `None` where fewer than two are.
pub(crate) fn extreme_rests(record: &Record) -> Option<[f64; 2]> {
    match *rests_by_command(record).as_slice() {
        [first, .., last] => Some([first.1, last.1]),
        _ => None,
    }
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
    /// sensor has steps of `step`.
    fn by(runs: &'a [Simulated<'a>], sign: f64, (centre, step): (f64, f64)) -> Self {
        let mut all = Self {
            runs,
            strokes: Vec::new(),
            beyond: Vec::new(),
        };
        for run in runs {
            let measured = run.run.output();
            let errors = run.errors.iter().filter(|error| !error.is_nan());
            let usual = median(errors.map(|error| error.abs()).collect()).unwrap_or_default();
            let far = |far: f64, y: &f64| far.max(sign * y);
            let farthest = measured.iter().fold(f64::NEG_INFINITY, far);
            let nearest = measured
                .iter()
                .fold(f64::INFINITY, |near, y| near.min(sign * y));
            let notable = (NOTABLE * (farthest - nearest)).max(step);
            let beyond = |k: usize| sign * (run.output[k] + centre) - farthest;
            let is_there = |k: &usize| {
                beyond(*k) > notable && sign * measured[*k] > farthest - FARTHEST * usual
            };
            let samples: Vec<usize> = (0..measured.len()).filter(is_there).collect();
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
        if !self.is_beyond_chance(fit) {
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

/// Share of the range of the commands over which the others must follow: a few neighbours show no slope.
const LINE: f64 = 0.25;

/// Command and mean output of the holds in which the output comes to rest: the two halves of the last quarter agree, beside the way there.
fn rests_of(run: &Run<'_>) -> Vec<(f64, f64)> {
    let at_rest = |hold: &Hold| {
        let last = last_quarter(&hold.samples);
        let middle = last.start + last.len() / 2;
        let [first, second] =
            [last.start..middle, middle..last.end].map(|part| mean_output(run, part));
        let (first, second) = first.zip(second)?;
        let start = run.output()[hold.samples.start];
        let way = (second - start).abs();
        let is_at_rest = (second - first).abs() < STOP_GAIN * way;
        (hold.before.is_some() && is_at_rest).then_some((hold.level, 0.5 * (first + second)))
    };
    holds(run, EXACTLY)
        .iter()
        .filter(|hold| last_quarter(&hold.samples).len() > 1)
        .filter_map(at_rest)
        .collect()
}

/// Command and mean rest, one point for each command, by the command.
fn rests_by_command(record: &Record) -> Vec<(f64, f64)> {
    let mut rests: Vec<(f64, f64)> = record.runs().iter().flat_map(rests_of).collect();
    rests.sort_by(|a, b| a.0.total_cmp(&b.0));
    let of = |group: &[(f64, f64)]| {
        let sum: f64 = group.iter().map(|(_, rest)| rest).sum();
        (group[0].0, sum / group.len() as f64)
    };
    rests.chunk_by(|a, b| a.0 == b.0).map(of).collect()
}

/// The flat end of a line of points, which is their last part: it follows the command less than [`STOP_GAIN`] of how the others do, and
/// is short of where they would go by more than [`STOP_SHARE`] of the range. Rests are known to half a step of the sensor, and where the line
/// goes to so much less as it is short.
fn flat_end(points: &[(f64, f64)], step: f64) -> Option<TravelEnd> {
    let (first, last) = (points.first()?, points.last()?);
    let is_flat = |from: &usize| {
        let (line, end) = points.split_at(*from);
        let span = (last.0 - end[0].0).abs();
        let rests = end.iter().map(|(_, rest)| *rest);
        let (low, high) = rests.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), rest| {
            (low.min(rest), high.max(rest))
        });
        let (start, stop) = (line[0], line[line.len() - 1]);
        let gain = (stop.1 - start.1) / (stop.0 - start.0);
        let is_line = (stop.0 - start.0).abs() > LINE * (last.0 - first.0).abs();
        let short_by = (start.1 + gain * (last.0 - start.0) - last.1).abs();
        let rounding = step * ((last.0 - start.0) / (stop.0 - start.0)).abs();
        let range = (gain * (last.0 - first.0)).abs();
        let play = STOP_GAIN * gain.abs() * span;
        // No other command takes it farther.
        let side = (gain * (last.0 - first.0)).signum();
        let is_farthest = line.iter().all(|(_, rest)| side * (rest - last.1) < play);
        is_line && high - low < play && short_by > rounding + STOP_SHARE * range && is_farthest
    };
    let mut all = FEWEST.1..=points.len().checked_sub(FEWEST.0)?;
    let from = all.find(is_flat)?;
    let end = &points[from..];
    Some(TravelEnd {
        rest: end.iter().map(|(_, rest)| rest).sum::<f64>() / end.len() as f64,
        commands: (end[0].0, last.0),
        count: end.len(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    /// A lag of 10 samples under random levels that are held for 100, whose output has its ends at `ends`.
    fn found(ends: (f64, f64), follows: impl Fn(f64) -> f64) -> Option<TravelEnd> {
        let mut random = ChaCha8Rng::seed_from_u64(3);
        let levels: Vec<f64> = (0..40).map(|_| random.random_range(-20.0..20.0)).collect();
        let input: Vec<f64> = levels.iter().flat_map(|level| [*level; 100]).collect();
        let mut y = 0.0;
        let output: Vec<f64> = input
            .iter()
            .map(|u| {
                y += (follows(*u) - y) / 10.0;
                y = f64::clamp(y, ends.0, ends.1);
                y + random.random_range(-0.1..0.1)
            })
            .collect();
        let ends = TravelEnd::of_rests(&Record::of_run(0.01, &input, &output).unwrap());
        ends.into_iter().flatten().next()
    }

    /// Random levels behind a lag under noise, of a servo that moves freely or stops at 12, in steps of the sensor. None of the 40 free servos
    /// may be found, since what rounding can do is bounded; of those that stop at three fifths of the range all are, in steps of 2.
    #[test]
    fn a_coarse_sensor_is_no_stop() {
        let rounded = |seed: u64, step: f64, end: f64| {
            let mut random = ChaCha8Rng::seed_from_u64(seed);
            let levels: Vec<f64> = (0..60).map(|_| random.random_range(-20.0..20.0)).collect();
            let input: Vec<f64> = levels.iter().flat_map(|level| [*level; 50]).collect();
            let mut y = 0.0;
            let mut seen = |u: &f64| {
                y = f64::min(y + (u - y) / 5.0, end);
                ((y + random.random_range(-0.1..0.1)) / step).round() * step
            };
            let output: Vec<f64> = input.iter().map(&mut seen).collect();
            let record = Record::of_run(0.01, &input, &output).unwrap();
            TravelEnd::of_rests(&record).into_iter().flatten().next()
        };
        for seed in 0..10 {
            for step in [2.0, 3.0, 4.0, 5.0] {
                assert_eq!(rounded(seed, step, 99.0), None, "seed {seed}, step {step}");
            }
            assert!(rounded(seed, 2.0, 12.0).is_some(), "seed {seed}");
        }
    }

    #[test]
    fn a_stop_within_the_range_is_found_at_either_end_and_none_is_elsewhere() {
        let none = (f64::NEG_INFINITY, f64::INFINITY);
        let upper = found((-40.0, 12.0), |u| u).unwrap();
        assert!((upper.rest - 12.0).abs() < 0.05, "{upper:?}");
        assert!(upper.commands.0 > 12.0 && upper.commands.1 > 17.0 && upper.count >= 5);
        let lower = found((-6.0, 40.0), |u| 0.5 * u).unwrap_or_else(|| panic!("a lower stop"));
        assert!(
            (lower.rest + 6.0).abs() < 0.05 && lower.commands.1 < -17.0,
            "{lower:?}"
        );
        assert_eq!(found(none, |u| u), None);
        // A gain that falls to a third, and a dead band of 2 units.
        assert_eq!(
            found(none, |u| if u > 10.0 { 10.0 + (u - 10.0) / 3.0 } else { u }),
            None
        );
        assert_eq!(found(none, |u| (u / 2.0).round() * 2.0), None);
    }
}
