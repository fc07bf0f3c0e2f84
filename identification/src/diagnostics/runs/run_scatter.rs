//! Scatter between runs of one servo, and the run that deviates.
//!
//! The model is that of all runs together. Each run has a gain, a delay and an offset relative to that
//! common model, from least squares of the run's D-filtered error on the simulated output, its slope and a
//! constant,
//!
//! ```text
//! D(z) (y - ŷ)(k) = D(z) [a ŷ_0(k) - τ (ŷ(k+1) - ŷ(k-1))/2 + b] + ε(k)
//! ```
//!
//! with ŷ_0 the output beyond the rest at the mean command of the runs. So b is the offset at that command. At command 0 it would be
//! mixed with the gain wherever commands are far from 0, as pulse widths are. The noise gives each quantity a standard deviation. Further variance
//! is the scatter between runs (method of moments, as for random effects). From three runs on the model's bounds contain how runs
//! differ ([`servo_mean`](crate::diagnostics::runs::servo_mean)).

use faer::Mat;
use serde::{Deserialize, Serialize};
use statrs::distribution::{ContinuousCDF, StudentsT};

use super::run_equations::RunEquations;
use crate::data::Run;
use crate::data::column::mean;
use crate::numerics::{
    backward_solve, chi_square_upper_tail, cholesky, dot, forward_solve, inverse_of_lower,
    normal_upper_quantile, student_critical,
};
use crate::results::Model;
use crate::thresholds::{RESIDUAL_SIGNIFICANCE, SCATTER_SIGNIFICANCE};

/// Gain, delay and offset.
const QUANTITIES: usize = 3;

/// One quantity of one run.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Difference {
    /// Difference from the common model.
    pub value: f64,
    /// Its standard deviation from the noise; `None` where the bounds of the model are withdrawn.
    pub sd: Option<f64>,
}

/// One run against the common model.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct RunDifference {
    /// Run, counted from 1.
    pub run: usize,
    /// Gain relative to that of the model \[%\].
    pub gain_percent: Difference,
    /// Additional delay \[s\].
    pub delay_s: Difference,
    /// Additional output at rest under the [mean command](RunComparison::mean_command) \[units of the output\].
    pub offset: Difference,
}

/// Scatter of one quantity between runs.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Scatter {
    /// Standard deviation between runs, beyond the noise.
    pub sd: f64,
    /// Probability of differences at least as large from the noise alone.
    pub p: f64,
}

/// A run and its distance from the others.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Deviation {
    /// Run, counted from 1.
    pub run: usize,
    /// Distance from the mean of the other runs, in standard deviations of a single run.
    pub distance: f64,
    /// Distance that chance exceeds in one of a hundred records.
    pub threshold: f64,
    /// Probability of a run at least as far from the others if all have the same distribution, at any
    /// scatter.
    #[serde(default = "certain")]
    pub p: f64,
}

fn certain() -> f64 {
    1.0
}

/// How the runs of a record compare.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RunComparison {
    /// Each run that is long enough.
    pub runs: Vec<RunDifference>,
    /// Scatter of the gain \[%\].
    pub gain_percent: Scatter,
    /// Scatter of the delay \[s\].
    pub delay_s: Scatter,
    /// Scatter of the offset.
    pub offset: Scatter,
    /// The command that offsets are stated at \[units of the input\]: the mean of all runs, by samples. Files without it state them at 0.
    #[serde(default)]
    pub mean_command: f64,
    /// The run that deviates most, if one deviates. It takes at least three runs.
    pub deviating: Option<Deviation>,
    /// The run farthest from the others, significant or not.
    #[serde(default)]
    pub farthest: Option<Deviation>,
}

impl RunComparison {
    /// Compares `runs` with the model of all of them. `None` with fewer than two usable runs.
    #[must_use]
    pub fn of(model: &Model, runs: &[Run]) -> Option<Self> {
        if runs.len() < 2 {
            return None;
        }
        let commands: Vec<f64> = runs.iter().flat_map(|run| run.input()).copied().collect();
        let mean_command = mean(&commands)?;
        let numbered = runs.iter().zip(1..);
        let compared: Vec<Estimated> = numbered
            .filter_map(|(run, number)| Estimated::new(model, run, number, mean_command))
            .collect();
        if compared.len() < 2 {
            return None;
        }
        let [gain_percent, delay_s, offset] =
            [0, 1, 2].map(|index| scatter(compared.iter().map(|run| run.quantities[index])));
        let farthest = farthest(&compared);
        let has_bounds = model.bounds.valid().is_some();
        Some(Self {
            runs: compared.iter().map(|run| run.shown(has_bounds)).collect(),
            gain_percent,
            delay_s,
            offset,
            mean_command,
            deviating: farthest.filter(|run| run.distance > run.threshold),
            farthest,
        })
    }
}

impl RunComparison {
    /// Whether runs differ by more than chance.
    pub(crate) fn differ(&self) -> bool {
        let scatter = [self.gain_percent, self.delay_s, self.offset];
        scatter
            .iter()
            .any(|scatter| scatter.p < SCATTER_SIGNIFICANCE)
    }

    /// The variance of a quantity's mean over the runs, noise and scatter, from how runs differ; `None` where the model has no bounds
    /// or the record no noise.
    pub(crate) fn variance_of_mean(
        &self,
        of: impl Fn(&RunDifference) -> Difference,
    ) -> Option<f64> {
        let quantity = |run: &RunDifference| {
            let Difference { value, sd } = of(run);
            Some(RunQuantity { value, sd: sd? })
        };
        let values: Vec<RunQuantity> = self.runs.iter().map(quantity).collect::<Option<_>>()?;
        Some(RunSquares::of(&values)?.variance_of_mean())
    }
}

/// A quantity of a run against the common model.
#[derive(Clone, Copy)]
struct RunQuantity {
    value: f64,
    /// From the noise.
    sd: f64,
}

/// Gain \[%\], delay \[s\] and offset of one run.
struct Estimated {
    run: usize,
    quantities: [RunQuantity; QUANTITIES],
}

impl Estimated {
    /// `None` for a run that is too short or does not move.
    fn new(model: &Model, run: &Run, number: usize, mean_command: f64) -> Option<Self> {
        let simulated = model.simulate(run);
        let gain = model.step.value.last()?;
        let rest = model.offset + gain * mean_command;
        let moved = simulated.iter().map(|y| y - rest).collect();
        let around = |k: usize| (1..run.len().saturating_sub(1)).contains(&k);
        let slope = |k: usize| match around(k) {
            true => (simulated[k - 1] - simulated[k + 1]) / 2.0,
            false => f64::NAN,
        };
        let columns = [moved, (0..run.len()).map(slope).collect()];
        let band = model.band_estimate.as_ref();
        let ar = band.map_or(&model.noise.ar, |estimate| &estimate.ar);
        let equations = RunEquations::of(ar, run, &simulated, &columns)?;
        let RunEquations { normal, right, .. } = &equations;
        let scale: Vec<f64> = (0..QUANTITIES)
            .map(|i| normal[(i, i)].sqrt().recip())
            .collect();
        let scaled = Mat::from_fn(QUANTITIES, QUANTITIES, |i, j| {
            normal[(i, j)] * scale[i] * scale[j]
        });
        let lower = cholesky(&scaled)?;
        let right: Vec<f64> = right.iter().zip(&scale).map(|(r, s)| r * s).collect();
        let x = backward_solve(&lower, &forward_solve(&lower, &right));
        let inverse = inverse_of_lower(&lower);
        // The few frequencies of a model of a band are a picture, whose errors are no noise of the servo: they count as the run leaves them.
        let explained = dot(&x, &right);
        let sigma = match band {
            None => model.noise.sigma,
            Some(_) => {
                ((equations.square - explained) / (equations.rows - QUANTITIES) as f64).sqrt()
            }
        };
        let units = [100.0, model.sample_period_s, 1.0];
        Some(Self {
            run: number,
            quantities: std::array::from_fn(|i| RunQuantity {
                value: units[i] * x[i] * scale[i],
                sd: units[i] * sigma * scale[i] * inverse.col(i).norm_l2(),
            }),
        })
    }

    fn shown(&self, has_bounds: bool) -> RunDifference {
        let [gain_percent, delay_s, offset] = self.quantities.map(|found| Difference {
            value: found.value,
            sd: has_bounds.then_some(found.sd),
        });
        RunDifference {
            run: self.run,
            gain_percent,
            delay_s,
            offset,
        }
    }
}

/// How one quantity differs between runs, each with a weight of one over its variance from the noise.
struct RunSquares {
    runs: usize,
    /// Sum of the weighted squares about the weighted mean.
    q: f64,
    /// Sums of the weights and of their squares.
    weight: f64,
    squared_weight: f64,
}

impl RunSquares {
    /// `None` without noise: then there is no scale to compare with.
    fn of(values: &[RunQuantity]) -> Option<Self> {
        let weights: Vec<f64> = values.iter().map(|v| v.sd.powi(-2)).collect();
        let weight: f64 = weights.iter().sum();
        if !weight.is_finite() {
            return None;
        }
        let numbers: Vec<f64> = values.iter().map(|v| v.value).collect();
        let mean = dot(&weights, &numbers) / weight;
        let squares = numbers.iter().map(|x| (x - mean).powi(2));
        Some(Self {
            runs: values.len(),
            q: weights.iter().zip(squares).map(|(w, x)| w * x).sum(),
            weight,
            squared_weight: dot(&weights, &weights),
        })
    }

    /// The expectation of q for a scatter of one without noise.
    fn of_unit_scatter(&self) -> f64 {
        self.weight - self.squared_weight / self.weight
    }

    /// Method of moments: the excess of the weighted squares over their expectation.
    fn scatter(&self) -> Scatter {
        let degrees = self.runs - 1;
        let excess = (self.q - degrees as f64) / self.of_unit_scatter();
        Scatter {
            sd: excess.max(0.0).sqrt(),
            p: chi_square_upper_tail(self.q, degrees),
        }
    }

    /// The mean square of runs, of which their weighted mean has a share.
    fn variance_of_mean(&self) -> f64 {
        self.q / self.of_unit_scatter() * self.squared_weight / self.weight.powi(2)
    }
}

/// Scatter of a quantity; none without noise.
fn scatter(values: impl Iterator<Item = RunQuantity>) -> Scatter {
    let values: Vec<RunQuantity> = values.collect();
    RunSquares::of(&values).map_or(Scatter { sd: 0.0, p: 1.0 }, |found| found.scatter())
}

/// The run farthest from the others. Each quantity is compared with the spread of the others (at least
/// their noise) by Student's t, with Bonferroni's correction over runs and quantities.
///
/// Only the other runs show how much runs of this servo scatter. The clock of a servo alone can scatter them
/// by fifty times the noise, and three of four then agree by chance surprisingly often. With four runs it
/// therefore takes 35 standard deviations of the others to call the fourth deviating, with five runs 16. No
/// test that holds at every scatter needs less.
fn farthest(runs: &[Estimated]) -> Option<Deviation> {
    let others = runs.len() - 1;
    if others < 2 {
        return None;
    }
    let share = RESIDUAL_SIGNIFICANCE / (2 * QUANTITIES * runs.len()) as f64;
    let degrees = (others - 1) as f64;
    let threshold = student_critical(normal_upper_quantile(share), &[degrees])[0];
    let distance = |r: usize, index: usize| {
        let others = runs.iter().filter(|other| other.run != runs[r].run);
        let rest: Vec<RunQuantity> = others.map(|other| other.quantities[index]).collect();
        let count = rest.len() as f64;
        let mean = rest.iter().map(|v| v.value).sum::<f64>() / count;
        let spread = rest.iter().map(|v| (v.value - mean).powi(2)).sum::<f64>() / degrees;
        let noise = rest.iter().map(|v| v.sd.powi(2)).sum::<f64>() / count;
        let own = runs[r].quantities[index];
        let variance = spread.max(noise) / count + spread.max(own.sd.powi(2));
        if variance > 0.0 {
            (own.value - mean).abs() / variance.sqrt()
        } else {
            0.0
        }
    };
    let largest = |r: usize| {
        (0..QUANTITIES)
            .map(|index| distance(r, index))
            .fold(0.0, f64::max)
    };
    let (run, distance) = (0..runs.len())
        .map(|r| (r, largest(r)))
        .max_by(|a, b| a.1.total_cmp(&b.1))?;
    let tests = (2 * QUANTITIES * runs.len()) as f64;
    let p = StudentsT::new(0.0, 1.0, degrees).map_or(1.0, |t| tests * t.sf(distance));
    Some(Deviation {
        run: runs[run].run,
        distance,
        threshold,
        p: p.clamp(0.0, 1.0),
    })
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;

    use super::*;
    use crate::{Options, Record, identify_explained};
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;
    use rand_distr::StandardNormal;

    /// Gains that differ by 0.2 % move the output at a pulse width of 0 by three times as much as the zeros of the runs differ.
    #[test]
    fn a_gain_that_scatters_is_no_offset_of_commands_far_from_zero() {
        const ZEROS: [f64; 4] = [0.001, -0.001, 0.0005, -0.0005];
        const GAINS: [f64; 4] = [1.002, 1.002, 0.998, 0.998];
        let mut random = ChaCha8Rng::seed_from_u64(5);
        let run = |(gain, zero): (f64, f64)| {
            let mut level = 1500.0;
            let mut position = 0.0;
            let rows = (0..1200).map(|k| {
                if k % 15 == 0 {
                    level = f64::from(random.random_range(1350..1651));
                }
                position += 0.3 * (0.0017 * gain * (level - 1500.0) - position);
                let noise: f64 = random.sample(StandardNormal);
                (level, position + zero + 1e-4 * noise)
            });
            let (input, output): (Vec<f64>, Vec<f64>) = rows.unzip();
            Run::new(input, output).unwrap()
        };
        let runs = GAINS.into_iter().zip(ZEROS).map(run).collect();
        let record = Record::new(0.01, runs).unwrap();
        let found = identify_explained(&record, &Options::default()).unwrap();
        let found = found.explanation.runs.unwrap();
        let middle = found.mean_command;
        assert!((1400.0..1600.0).contains(&middle), "{middle}");
        for (run, (gain, zero)) in found.runs.iter().zip(GAINS.into_iter().zip(ZEROS)) {
            let there = zero + 0.0017 * (gain - 1.0) * (middle - 1500.0);
            assert!((run.offset.value - there).abs() < 1e-4, "{run:?} {there}");
        }
    }

    #[test]
    fn the_variance_of_the_mean_is_that_of_equal_runs_over_their_number() {
        let values = |sd: f64| [1.0, 2.0, 3.0, 6.0].map(|value| RunQuantity { value, sd });
        let spread = |values: &[RunQuantity]| RunSquares::of(values).unwrap().variance_of_mean();
        // Of 1, 2, 3 and 6 the mean is 3 and the squares about it are 14.
        let expected = 14.0 / 3.0 / 4.0;
        for sd in [0.01, 1.0, 100.0] {
            assert_relative_eq!(spread(&values(sd)), expected, max_relative = 1e-9);
        }
        // A run that says next to nothing has no share in the mean.
        let dull = RunQuantity {
            value: 40.0,
            sd: 1e5,
        };
        let with_dull = [values(1.0).as_slice(), &[dull]].concat();
        assert_relative_eq!(spread(&with_dull), expected, max_relative = 1e-6);
    }
}
