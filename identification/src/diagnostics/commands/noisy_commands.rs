//! Noise in the column of a command that is held but for it.
//!
//! A command that was measured has noise that the servo was not sent. Over its holds, the column shows that noise by itself: second differences have its size,
//! whatever the levels are, and what is left beside the mean of each hold has its autocovariance. A command that moves smoothly, or noise that is the command,
//! has no holds that end with a change far beyond what is within them: a motion that takes four samples for five standard deviations goes on by 6.3 of them from
//! hold to hold. What is left within the holds of a smooth command, such as the tails of levels behind a lag, is smooth: its second differences are next to none. In coarse rows
//! those of a sweep or of sines are not, but its neighbours on both sides still say what a sample is. Where noise is correlated, or levels are near each other, holds show in the means of a few samples.

use faer::Mat;
use serde::{Deserialize, Serialize};

use super::command_errors::{CommandErrors, EXAMINED, LAGS};
use crate::data::{HELD, Hold, Run, holds};
use crate::diagnostics::residuals::residual_tests::ScoreTest;
use crate::numerics::{median, not_negative};
use crate::thresholds::{CHANGED_BEYOND_NOISE, HELD_BUT_FOR_NOISE, ROUGHNESS_OF_NOISE};

/// Noise in the column of a command that is held but for it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct CommandNoise {
    /// Its standard deviation at the most \[units of the input\]: where holds are short, levels that are near each other count as noise.
    pub sd: f64,
    /// By how many standard deviations of its noise the estimate is off at the most, whichever part of it is looked at, if the servo was not sent this noise;
    /// `None` where there are no bounds.
    pub shift: Option<f64>,
}

/// Samples of which means are taken to find holds. Means of more samples divide levels that are nearer.
const BLOCKS: [usize; 4] = [16, 8, 4, 1];

/// The median size of second differences of white noise, in its standard deviations: that of a normal variable times √6.
const SECOND_DIFFERENCE: f64 = 1.652;

/// Samples on either side that say what a smooth command is at a sample: those of as many sines do, exactly.
const NEIGHBOURS: usize = 4;

/// Lags as a part of the length of a hold, up to which autocovariances beside its mean show how uncertain that is.
const OF_HOLD: usize = 4;

/// What is within the holds of `runs` \[input\], those of each run in order; `None` where their commands are held without noise, or are not held.
pub(super) fn noisy_holds<'r>(runs: &[&'r Run]) -> Option<Vec<&'r [f64]>> {
    let columns: Vec<&[f64]> = runs.iter().map(|run| run.input()).collect();
    if second_difference(&columns)? == 0.0 {
        return None;
    }
    let sd = |held: &[&[f64]]| CommandErrors::of_noise(held, 1).sd();
    let is_rough = |held: &Vec<&[f64]>| {
        let least = ROUGHNESS_OF_NOISE * sd(held);
        second_difference(held).is_some_and(|size| size > SECOND_DIFFERENCE * least)
            && beyond_neighbours(held).is_none_or(|size| size > least)
    };
    let found = (BLOCKS.iter())
        .filter_map(|block| holds_of_means(runs, *block))
        .filter(is_rough);
    found.min_by(|a, b| sd(a).total_cmp(&sd(b)))
}

/// The same, where the means of each `block` of samples show holds.
fn holds_of_means<'r>(runs: &[&'r Run], block: usize) -> Option<Vec<&'r [f64]>> {
    let means: Vec<Run> = runs
        .iter()
        .map(|run| means(run, block))
        .collect::<Option<_>>()?;
    let columns: Vec<&[f64]> = means.iter().map(Run::input).collect();
    let sd = second_difference(&columns)? / SECOND_DIFFERENCE;
    let (mut changes, mut held) = (Vec::new(), Vec::new());
    for (run, means) in runs.iter().zip(&means) {
        let found = holds(means, HELD_BUT_FOR_NOISE * sd).into_iter();
        let long: Vec<Hold> = found.filter(|hold| hold.samples.len() >= HELD).collect();
        changes.extend(long.windows(2).filter_map(|pair| {
            let level = |hold: &Hold| mean(&means.input()[hold.samples.clone()]);
            let between = &means.input()[pair[0].samples.end..pair[1].samples.start];
            match between {
                // Behind a missing command, the level may be the same.
                _ if between.iter().any(|u| u.is_nan()) => None,
                // A change may be within a block.
                [] | [_] => Some((level(&pair[1]) - level(&pair[0])).abs()),
                _ => Some(0.0),
            }
        }));
        held.extend(long.iter().map(|hold| {
            // The blocks at both ends may have samples of the next hold.
            let end = block - 1;
            &run.input()[block * hold.samples.start + end..block * hold.samples.end - end]
        }));
    }
    (median(changes)? > CHANGED_BEYOND_NOISE * sd).then_some(held)
}

/// The run of the means of each `block` of samples of its input.
fn means(run: &Run, block: usize) -> Option<Run<'static>> {
    let blocks = run.input().chunks_exact(block);
    let means: Vec<f64> = blocks.take(EXAMINED).map(mean).collect();
    Run::new(means.clone(), means).ok()
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// The median size of the second differences of `columns`.
fn second_difference(columns: &[&[f64]]) -> Option<f64> {
    let of = |column: &&[f64]| -> Vec<f64> {
        let triples = column.windows(3);
        let sizes = triples.map(|u| (u[2] - 2.0 * u[1] + u[0]).abs());
        sizes.filter(|size| !size.is_nan()).collect()
    };
    median(columns.iter().flat_map(of).collect())
}

/// Standard deviation of what neighbours on both sides, each pair with a weight of its own in each hold, do not say of the samples of `held`; `None` where holds
/// are too short to show that.
fn beyond_neighbours(held: &[&[f64]]) -> Option<f64> {
    let (mut square, mut free) = (0.0, 0);
    for part in held.iter().filter(|part| part.len() > 4 * NEIGHBOURS) {
        let mean = mean(part);
        let rows = part.windows(2 * NEIGHBOURS + 1).map(|window| {
            let about_mean = |k: usize| window[k] - mean;
            let pair = |j: usize| about_mean(NEIGHBOURS - j) + about_mean(NEIGHBOURS + j);
            let pairs: Vec<f64> = (1..=NEIGHBOURS).map(pair).collect();
            (pairs, about_mean(NEIGHBOURS))
        });
        let mut moments = Mat::<f64>::zeros(NEIGHBOURS, NEIGHBOURS);
        let mut score = [0.0; NEIGHBOURS];
        for (pairs, u) in rows {
            square += u * u;
            free += 1;
            for (i, of_pair) in pairs.iter().enumerate() {
                score[i] += of_pair * u;
                for (j, other) in pairs.iter().enumerate() {
                    moments[(i, j)] += of_pair * other;
                }
            }
        }
        if let Some(said) = ScoreTest::new(&moments, &moments, &score) {
            square -= said.reduction;
            free -= said.degrees;
        }
    }
    (free > 0).then(|| not_negative(square / free as f64).sqrt())
}

impl CommandErrors {
    /// Of noise whose values within each hold are `held`, in so many `samples`.
    pub(super) fn of_noise(held: &[&[f64]], samples: usize) -> Self {
        let [mut sums, mut pairs] = [[0.0; LAGS]; 2];
        let mut known = 0;
        for part in held {
            known += part.len();
            let mean = mean(part);
            let left: Vec<f64> = part.iter().map(|u| u - mean).collect();
            for (lag, (sum, pairs)) in sums.iter_mut().zip(&mut pairs).enumerate() {
                let products = left.iter().zip(left.iter().skip(lag));
                *sum += products.map(|(a, b)| a * b).sum::<f64>();
                *pairs += left.len().saturating_sub(lag) as f64;
            }
        }
        let beside_means: Vec<f64> = (sums.iter().zip(pairs))
            .map(|(sum, pairs)| sum / f64::max(pairs, 1.0))
            .collect();
        let of_means = variance_of_means(&beside_means, known as f64 / held.len() as f64);
        let samples = samples as f64;
        Self {
            near: (beside_means.iter())
                .map(|of_lag| samples * (of_lag + of_means))
                .collect(),
            far: 0.0,
            samples,
        }
    }

    /// Standard deviation of one of them \[input\].
    pub(super) fn sd(&self) -> f64 {
        (self.near[0] / self.samples).sqrt()
    }
}

/// Variance of the mean of `length` samples whose autocovariances beside their mean are these: each lacks it.
fn variance_of_means(beside_mean: &[f64], length: f64) -> f64 {
    let reach = (length as usize / OF_HOLD).clamp(1, beside_mean.len());
    let sum = 2.0 * beside_mean[..reach].iter().sum::<f64>() - beside_mean[0];
    let lags = (2 * reach - 1) as f64;
    (sum / (length - lags)).max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;
    use rand_distr::StandardNormal;

    const SAMPLES: usize = 10_000;

    /// `command` with noise of a standard deviation `sd`, of which each value remembers `memory` of the last.
    fn column(command: impl Fn(usize) -> f64, sd: f64, memory: f64) -> Vec<f64> {
        let mut random = ChaCha8Rng::seed_from_u64(5);
        let new = sd * (1.0 - memory * memory).sqrt();
        let mut noise = 0.0;
        (0..SAMPLES)
            .map(|k| {
                noise = memory * noise + new * random.sample::<f64, _>(StandardNormal);
                command(k) + noise
            })
            .collect()
    }

    /// The errors of a column, of one sample.
    fn errors(input: Vec<f64>) -> Option<CommandErrors> {
        let run = Run::new(input.clone(), input).unwrap();
        let runs = [&run];
        let held = noisy_holds(&runs)?;
        Some(CommandErrors::of_noise(&held, 1))
    }

    /// Eleven levels of ±5, up and down, each held for 100 samples.
    fn stairs(k: usize) -> f64 {
        let place = k / 100 % 20;
        place.min(20 - place) as f64 - 5.0
    }

    /// Some thousand of them.
    fn level(hold: usize) -> f64 {
        (hold * 7919 % 1009) as f64 / 100.0 - 5.0
    }

    #[test]
    fn the_noise_of_held_commands_has_its_autocovariance() {
        for (sd, memory) in [(0.01, 0.0), (0.1, 0.0), (0.3, 0.0), (0.1, 0.8)] {
            let found = errors(column(stairs, sd, memory)).unwrap();
            let wanted = |lag: i32| sd * sd * memory.powi(lag);
            for (lag, found) in (0..).zip(&found.near) {
                let error = (found - wanted(lag)).abs();
                // Where a step is three standard deviations, a few samples of the next level pass for noise.
                assert!(error < 0.2 * sd * sd, "{sd} {memory} {lag} {found}");
            }
        }
        // Holds of a few samples.
        let found = errors(column(|k| level(k / 8), 0.03, 0.0)).unwrap();
        assert!((found.sd() / 0.03 - 1.0).abs() < 0.05, "{}", found.sd());
    }

    #[test]
    fn commands_without_noise_or_without_holds_have_none() {
        assert!(errors(column(stairs, 0.0, 0.0)).is_none());
        let mut at = 0.0;
        let mut behind_a_lag = |k: usize| {
            at += 0.2 * (level(k / 40) - at);
            at
        };
        assert!(errors((0..SAMPLES).map(&mut behind_a_lag).collect()).is_none());
        let sweep = |k: usize| 5.0 * (1e-5 * (k * k) as f64).sin();
        assert!(errors(column(sweep, 0.0, 0.0)).is_none());
        // From .3 to 11.7 Hz in rows of 20 ms.
        let coarse_sweep = |k: usize| {
            let t = 0.02 * k as f64;
            10.0 * (std::f64::consts::TAU * (0.3 + 0.095 * t) * t).sin()
        };
        let of_a_minute = column(coarse_sweep, 0.0, 0.0)[..3000].to_vec();
        assert!(errors(of_a_minute).is_none());
        let at_once = |k: usize| if level(k) > 0.0 { 5.0 } else { -5.0 };
        let in_fours = |k: usize| at_once(k / 4);
        let sine = |k: usize| 5.0 * (0.01 * k as f64).sin();
        let slow_sine = |k: usize| 5.0 * (0.001 * k as f64).sin();
        for sd in [0.0, 0.03, 0.1, 0.3] {
            for (name, input) in [
                ("noise", column(|_| 0.0, sd, 0.0)),
                ("slow noise", column(|_| 0.0, sd, 0.95)),
                ("noise of each sample", column(level, sd, 0.0)),
                ("binary noise", column(at_once, sd, 0.0)),
                ("sine", column(sine, sd, 0.0)),
                ("slow sine", column(slow_sine, sd, 0.0)),
            ] {
                assert!(errors(input).is_none(), "{name} {sd}");
            }
        }
        assert!(errors(column(in_fours, 0.0, 0.0)).is_none());
    }

    #[test]
    fn missing_commands_end_holds() {
        let mut input = column(stairs, 0.1, 0.0);
        for k in (0..SAMPLES).step_by(37) {
            input[k] = f64::NAN;
        }
        let found = errors(input).unwrap();
        assert!((found.sd() / 0.1 - 1.0).abs() < 0.05, "{}", found.sd());
    }
}
