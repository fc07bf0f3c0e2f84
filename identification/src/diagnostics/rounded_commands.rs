//! Commands that were rounded where they were written.
//!
//! A column of commands in steps of δ differs from what the servo got by e. The regressors are the column's, so that
//!
//! ```text
//! E θ̂ - θ = -b,     b = A^-1 S θ = (A - S)^-1 S E θ̂,     S_ij = sum_k E D e(k-i) D e(k-j),
//! ```
//!
//! as by any errors in variables (W. A. Fuller, *Measurement Error Models*, 1987). In no record such a column looks different from one of commands that
//! are on a grid, where the error is none. So b is no correction: it is one standard deviation of the estimate, along itself. Runs whose commands are
//! [stated to be exact](Run::with_exact_input) have no such error.
//!
//! Under a smooth command, rounding may be most of what excites the high frequencies. There the estimate is next to 0 whatever the servo does, and no
//! number of it says by how much it is off.
//!
//! While a command moves by d steps, its rounding error goes through a sawtooth, whose
//!
//! ```text
//! E e(k) e(k+τ) = (δ²/12) (1 - 6 d (1 - d)),     d = |u(k+τ) - u(k)| / δ ≤ 1,
//! ```
//!
//! any phase of the sawtooth being as likely (B. Widrow and I. Kollár, *Quantization Noise*, 2008); of commands that are more than a step apart it is 0. A slow
//! motion is known between the middles of stretches that are a step apart.
//!
//! A command that is held until it goes elsewhere has one error for as long. What this does to a level is [not the bias of a regressor](super::level_scatter).

use faer::Mat;

use crate::data::{Record, Run, common_step};
use crate::estimation::{GlsFit, noise_filter};
use crate::numerics::{dot, times};
use crate::thresholds::{ROUNDED_EXCITATION, ROUNDED_RANGE};

/// Lags at which errors are compared. What they have in common farther apart is that of a level.
const LAGS: usize = 16;

/// Samples that are looked at.
const EXAMINED: usize = 1 << 16;

/// Of the sum that b is. Where rounding is nine tenths of A, the whole sum is three times these, and bounds of 99 % have 2.6 to 4 of them; where it is
/// more, further ones would be noise.
const TERMS: usize = 4;

/// Adds to the covariance of `fit`, which is of `record`, what rounding of the commands may have made of the response. The step of the commands, where
/// it is nearly all that excites the part of the response that it changes: nothing then says how far the estimate is off.
pub(crate) fn allow_for_rounded_commands(record: &Record, fit: &mut GlsFit) -> Option<f64> {
    let runs = record.runs().iter().filter(|run| !run.has_exact_input());
    let runs: Vec<&Run> = runs.collect();
    let step = step_of_commands(&runs)?;
    let moments = RoundingMoments::of(&RoundingErrors::of(&runs, step), fit);
    let Some(bias) = bias(&moments, fit) else {
        return Some(step);
    };
    let covariance = Mat::from_fn(bias.len(), bias.len(), |i, j| {
        bias[i] * bias[j] / fit.variance
    });
    fit.spread_further(1.0, Some(covariance));
    None
}

/// b in the coordinates of `fit`, and 0 for the offset, since rounding moves no mean: the first of the terms (A^-1 S)^k θ̂, k from 1, of its sum. `None`
/// where rounding is nearly all of A along the first of them.
fn bias(moments: &RoundingMoments, fit: &GlsFit) -> Option<Vec<f64>> {
    let next = |score: &[f64]| {
        let mut moved = times(&fit.solution.inverse, &[score, &[0.0]].concat());
        moved.pop();
        moved
    };
    let first = next(&moments.times(fit.solution.response(), fit));
    let score = moments.times(&first, fit);
    let mut term = next(&score);
    // Cut at some lag, S may have small negative eigenvalues.
    if dot(&score, &term) > ROUNDED_EXCITATION * dot(&score, &first).abs() {
        return None;
    }
    let mut sum = first;
    for _ in 1..TERMS {
        for (sum, term) in sum.iter_mut().zip(&term) {
            *sum += term;
        }
        term = next(&moments.times(&term, fit));
    }
    sum.push(0.0);
    Some(sum)
}

/// S, of errors behind D at lags that are as far apart as a place in `filtered`.
struct RoundingMoments {
    filtered: Vec<f64>,
    /// Errors one step ahead that are smaller than rounding makes them show less of it.
    share: f64,
}

impl RoundingMoments {
    fn of(errors: &RoundingErrors, fit: &GlsFit) -> Self {
        let d = noise_filter(&fit.ar);
        let of_filter = |lag: usize| d.iter().zip(d.iter().skip(lag)).map(|(a, b)| a * b).sum();
        let of_filter: Vec<f64> = (0..d.len()).map(of_filter).collect();
        let mut found = Self {
            filtered: both_sides(&errors.near, &of_filter),
            share: 1.0,
        };
        let impulse = fit.impulse();
        let gain = impulse.iter().sum::<f64>() * d.iter().sum::<f64>();
        let squares = dot(&found.by_lag(&impulse), &impulse) + errors.far * gain * gain;
        found.share = (fit.variance * errors.samples / squares).min(1.0);
        found
    }

    /// S times a vector of the coordinates of `fit`.
    fn times(&self, coordinates: &[f64], fit: &GlsFit) -> Vec<f64> {
        let by_lag = self.by_lag(&fit.coordinates.impulse(coordinates));
        let by_lag = Mat::from_fn(by_lag.len(), 1, |i, _| by_lag[i]);
        let compressed = fit.coordinates.compress(by_lag);
        compressed.col(0).iter().copied().collect()
    }

    /// S times an impulse response.
    fn by_lag(&self, impulse: &[f64]) -> Vec<f64> {
        let (lags, reach) = (impulse.len(), self.filtered.len());
        let at = |i: usize| {
            let near = i.saturating_sub(reach - 1)..lags.min(i + reach);
            let sum: f64 = near
                .map(|j| self.filtered[i.abs_diff(j)] * impulse[j])
                .sum();
            self.share * sum
        };
        (0..lags).map(at).collect()
    }
}

/// δ of the commands of `runs` \[input\]; `None` where they are on no grid, or on one that is too coarse to be one of rounding.
fn step_of_commands(runs: &[&Run]) -> Option<f64> {
    let inputs = || runs.iter().flat_map(|run| run.input());
    let known = || inputs().copied().filter(|u| !u.is_nan());
    let range = known().reduce(f64::max)? - known().reduce(f64::min)?;
    let changes: Vec<f64> = runs
        .iter()
        .flat_map(|run| run.input().windows(2).map(|pair| pair[1] - pair[0]))
        .filter(|change| !change.is_nan())
        .take(EXAMINED)
        .collect();
    common_step(&changes).filter(|step| *step <= ROUNDED_RANGE * range)
}

/// Sums over the samples of E e(k) e(k+τ) \[input²\].
struct RoundingErrors {
    /// Of each τ, less `far`.
    near: Vec<f64>,
    /// What errors far apart have in common.
    far: f64,
    samples: f64,
}

impl RoundingErrors {
    fn of(runs: &[&Run], step: f64) -> Self {
        let mut sums = vec![0.0; LAGS + 1];
        let (mut seen, mut samples) = (0, 0);
        for run in runs {
            samples += run.len();
            if seen < EXAMINED {
                seen += run.len().min(EXAMINED);
                let motion = motion(run, step);
                for (lag, sum) in sums.iter_mut().enumerate() {
                    let pairs = motion.iter().zip(motion.iter().skip(lag));
                    let apart = pairs.map(|(a, b)| (b - a).abs()).filter(|d| *d < 1.0);
                    *sum += apart.map(|d| 1.0 - 6.0 * d * (1.0 - d)).sum::<f64>();
                }
            }
        }
        let samples = samples as f64;
        let scale = step * step / 12.0 * samples / seen as f64;
        let far = scale * sums.pop().unwrap_or(0.0);
        Self {
            near: sums.iter().map(|sum| scale * sum - far).collect(),
            far,
            samples,
        }
    }
}

/// The commands of the first samples of `run` in steps, on straight lines between the middles of stretches that are a step apart.
fn motion(run: &Run, step: f64) -> Vec<f64> {
    let first = run.input().iter().take(EXAMINED);
    let input: Vec<f64> = first.map(|u| u / step).collect();
    let stretches: Vec<&[f64]> = input.chunk_by(|a, b| a == b).collect();
    let mut motion = Vec::with_capacity(input.len());
    for (index, stretch) in stretches.iter().enumerate() {
        let half = stretch.len() as f64 / 2.0;
        // Steps for each sample, from the middle of the stretch to that of its neighbour.
        let slope = |other: Option<&&[f64]>| {
            let near = other.filter(|other| (other[0] - stretch[0]).abs() < 1.5);
            near.map_or(0.0, |other| {
                (other[0] - stretch[0]) / (half + other.len() as f64 / 2.0)
            })
        };
        let before = -slope(
            index
                .checked_sub(1)
                .and_then(|before| stretches.get(before)),
        );
        let after = slope(stretches.get(index + 1));
        motion.extend((0..stretch.len()).map(|k| {
            let from_middle = k as f64 + 0.5 - half;
            stretch[0] + from_middle * if from_middle < 0.0 { before } else { after }
        }));
    }
    motion
}

/// The convolution of two even functions, of each lag that has any, from 0 on.
fn both_sides(a: &[f64], b: &[f64]) -> Vec<f64> {
    let at = |values: &[f64], lag: usize| values.get(lag).copied().unwrap_or(0.0);
    let lags = a.len() + b.len() - 1;
    let value = |lag: usize| -> f64 {
        let first = b.iter().enumerate();
        first
            .map(|(k, b)| match k {
                0 => b * at(a, lag),
                _ => b * (at(a, lag.abs_diff(k)) + at(a, lag + k)),
            })
            .sum()
    };
    (0..lags).map(value).collect()
}
