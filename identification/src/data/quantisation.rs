//! Quantisation: an allowance for sensor steps that are larger than the noise.
//!
//! A converter with steps of δ rounds. Noise of half a step or more dithers it: the rounding error is then
//! white, of variance δ²/12, and independent of the motion. Without dither the same position always has
//! the same error, and repetition does not average it out. At rest on a level u the output is wrong by up
//! to δ/2, and a gain fitted to such levels is wrong by up to
//!
//! ```text
//! (δ/2) sum |u - ū| / sum (u - ū)²
//! ```
//!
//! which for a square wave is δ over its height. Noise of standard deviation σ reduces this by the factor
//! exp(-2π²σ²/δ²) (the first harmonic of the sawtooth under normal dither; B. Widrow and I. Kollár,
//! *Quantization Noise*, 2008). Bounds from the scatter of the residuals do not contain this error, so the
//! allowance is added to them.

use serde::{Deserialize, Serialize};

use crate::data::record::Record;
use crate::thresholds::{DITHERED, MULTIPLE_WITHIN, MULTIPLES, OF_ROUNDING, ON_GRID, REPEATED};

/// Differences below this share of the range are the rounding of arithmetic.
const ARITHMETIC: f64 = 1e-9;

/// Radius that contains 99 % of a complex normal quantity, in standard deviations of its parts:
/// sqrt(-2 ln 0.01).
const RIPPLE: f64 = 3.03;

/// Samples examined for steps, which are the same throughout a record.
const EXAMINED: usize = 1 << 16;

/// The steps of a sensor whose noise does not dither them.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Quantisation {
    /// δ \[output\].
    pub step: f64,
    /// Root mean square of the residuals, in steps.
    pub residual: f64,
    /// Largest error of a gain from rounding \[output per input\].
    pub allowance: f64,
}

impl Quantisation {
    /// Of `record` with its residuals \[rms\]. `None` when the noise dithers or the output has no steps.
    pub fn of(record: &Record, residual: f64) -> Option<Self> {
        let step = sensor_step(record)?;
        let residual = residual / step;
        if residual >= DITHERED {
            return None;
        }
        let found = Self {
            step,
            residual,
            allowance: 0.0,
        };
        Some(Self {
            allowance: found.level_error() * leverage(record),
            ..found
        })
    }

    /// The largest error of a level of rest that the noise does not dither \[output\].
    pub(crate) fn level_error(&self) -> f64 {
        let dither = (self.residual * self.residual - OF_ROUNDING).max(0.0);
        0.5 * self.step * (-2.0 * std::f64::consts::PI.powi(2) * dither).exp()
    }
}

/// The step that the output is rounded to, if many samples equal the previous one.
pub(crate) fn sensor_step(record: &Record) -> Option<f64> {
    let runs = record.runs().iter();
    let differences: Vec<f64> = runs
        .flat_map(|run| run.output().windows(2).map(|pair| pair[1] - pair[0]))
        .take(EXAMINED)
        .filter(|difference| !difference.is_nan())
        .collect();
    let still = differences.len() - moved(&differences).count();
    match still as f64 >= REPEATED * differences.len() as f64 {
        true => common_step(&differences),
        false => None,
    }
}

/// The step of which `differences` are whole multiples; `None` where there is none.
pub(crate) fn common_step(differences: &[f64]) -> Option<f64> {
    let step = moved(differences).fold(f64::INFINITY, f64::min);
    let small = || {
        moved(differences)
            .map(|difference| difference / step)
            .filter(|steps| *steps < MULTIPLES)
    };
    let on_grid = small().filter(|steps| (steps - steps.round()).abs() < MULTIPLE_WITHIN);
    (step.is_finite() && on_grid.count() as f64 >= ON_GRID * small().count() as f64).then_some(step)
}

/// The sizes of those of `differences` that are no rounding of arithmetic.
fn moved(differences: &[f64]) -> impl Iterator<Item = f64> {
    let sizes = || differences.iter().map(|difference| difference.abs());
    let least = ARITHMETIC * sizes().fold(0.0, f64::max);
    sizes().filter(move |size| *size > least)
}

impl Quantisation {
    /// Largest error of G from rounding at `omega` \[rad/sample\], for a step response of `settling`
    /// samples. It has two parts: the error of the gain, and the transform of uniform, independent errors
    /// over the moving half of the response (`RIPPLE` standard deviations).
    pub fn allowance_at(&self, omega: f64, settling: usize) -> f64 {
        let moving = settling as f64 / 2.0;
        let change = 2.0 * (omega / 2.0).sin().abs();
        self.allowance * (1.0 + RIPPLE * change * (moving / 12.0).sqrt())
    }
}

/// sum |u - ū| / sum (u - ū)².
fn leverage(record: &Record) -> f64 {
    let inputs = || {
        let runs = record.runs().iter();
        runs.flat_map(|run| run.input())
            .copied()
            .filter(|u| !u.is_nan())
    };
    let mean = inputs().sum::<f64>() / inputs().count().max(1) as f64;
    let (sum, squares) = inputs().fold((0.0, 0.0), |(sum, squares): (f64, f64), u| {
        (sum + (u - mean).abs(), squares + (u - mean).powi(2))
    });
    if squares > 0.0 { sum / squares } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    /// A square wave of height 10 behind a lag, under uniform noise, in steps of 0.04.
    fn record(noise: f64) -> Record<'static> {
        let mut random = ChaCha8Rng::seed_from_u64(1);
        let input: Vec<f64> = (0..2000).map(|k| f64::from(k / 100 % 2) * 10.0).collect();
        let mut y = 0.0;
        let output: Vec<f64> = input
            .iter()
            .map(|u| {
                y += 0.1 * (u - y);
                let seen = y + noise * (random.random::<f64>() - 0.5);
                (seen / 0.04).round() * 0.04
            })
            .collect();
        Record::of_run(0.002, input, output).unwrap()
    }

    #[test]
    fn the_step_of_a_converter_is_found_and_costs_a_gain_its_share_of_the_height() {
        let found = Quantisation::of(&record(0.0), 0.01).unwrap();
        assert!((found.step - 0.04).abs() < 1e-9, "{found:?}");
        assert!((found.allowance - 0.004).abs() < 1e-6, "{found:?}");
    }

    #[test]
    fn noise_as_large_as_a_step_dithers() {
        assert_eq!(Quantisation::of(&record(0.1), 0.03), None);
    }

    #[test]
    fn an_output_without_steps_has_no_resolution() {
        let input: Vec<f64> = (0..500).map(|k| f64::from(k / 50 % 2)).collect();
        let output: Vec<f64> = (0..500).map(|k| (f64::from(k) * 0.37).sin()).collect();
        let record = Record::of_run(0.002, input, output).unwrap();
        assert_eq!(Quantisation::of(&record, 0.0), None);
    }
}
