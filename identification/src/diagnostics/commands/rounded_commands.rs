//! What rounding of commands may have done to them.
//!
//! While a command moves by d steps of δ, its rounding error goes through a sawtooth, whose
//!
//! ```text
//! E e(k) e(k+τ) = (δ²/12) (1 - 6 d (1 - d)),     d = |u(k+τ) - u(k)| / δ ≤ 1,
//! ```
//!
//! any phase of the sawtooth being as likely (B. Widrow and I. Kollár, *Quantization Noise*, 2008); of commands that are more than a step apart it is 0. A slow
//! motion is known between the middles of stretches that are a step apart.
//!
//! A command that is held until it goes elsewhere has one error for as long. What this does to a level is [not the bias of a regressor](crate::diagnostics::holds::level_scatter).

use super::command_errors::{CommandErrors, EXAMINED, LAGS};
use crate::data::{Run, common_step};
use crate::thresholds::ROUNDED_RANGE;

/// δ of the commands of `runs` \[input\]; `None` where they are on no grid, or on one that is too coarse to be one of rounding.
pub(super) fn step_of_commands(runs: &[&Run]) -> Option<f64> {
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

impl CommandErrors {
    /// Of `runs` whose commands may have been rounded to a `step`.
    pub(super) fn of_rounding(runs: &[&Run], step: f64) -> Self {
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
