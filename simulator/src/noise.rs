//! Noise of the measured angle.
//!
//! ```text
//!  per sample (2 ms)   white of standard deviation 0.02 deg
//!                    + v(k) = 1.5 v(k-1) - 0.7 v(k-2) + 0.015 deg · normal     (sd 0.0446 deg)
//! ```
//!
//! A sample is the sum of [`OVERSAMPLING`] conversions within less than a tenth of a millisecond.
//! The autoregressive part is slow (sensor, linkage) and the same in all of them. The white part is
//! that of conversions: independent from one to the next with `√K · 0.02 deg`, so that their mean
//! has the 0.02 deg that are stated for a sample. At 0.04 deg it is about one step of the ADC
//! (0.0366 deg) and so dithers it: the mean of four conversions is finer than one. With one
//! value for all four, the quantisation error of the recorded angle would be 0.0106 deg rms instead
//! of about half.

use crate::random::{Stream, stream};
use crate::sensor::{OVERSAMPLING, SampleNoise};
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use rand_distr::StandardNormal;

/// Standard deviation of the white part of a sample (deg).
const WHITE_SD: f64 = 0.02;
/// Standard deviation of the drive of the autoregressive part (deg).
const DRIVE_SD: f64 = 0.015;
/// v(k) = `AR`\[0\] v(k-1) + `AR`\[1\] v(k-2) + drive.
const AR: [f64; 2] = [1.5, -0.7];
/// Samples until the autoregressive part has forgotten that it began at 0: its poles have
/// magnitude √0.7, and √0.7^200 = 3e-16.
const SETTLING: usize = 200;

/// How much noise.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum NoiseKind {
    /// White and autoregressive.
    #[default]
    Full,
    /// The white part alone.
    White,
    /// None; the ADC still rounds.
    None,
}

/// A source of noise.
#[derive(Clone, Debug)]
pub struct Noise {
    kind: NoiseKind,
    white: ChaCha8Rng,
    coloured: ChaCha8Rng,
    /// v(k-1), v(k-2).
    past: [f64; 2],
}

impl Noise {
    /// The noise of `seed`, stationary from the first sample on.
    pub fn new(kind: NoiseKind, seed: u64) -> Self {
        let mut noise = Self {
            kind,
            white: stream(seed, Stream::White),
            coloured: stream(seed, Stream::Coloured),
            past: [0.0; 2],
        };
        for _ in 0..SETTLING {
            noise.next_coloured();
        }
        noise
    }

    fn next_coloured(&mut self) -> f64 {
        let drive = DRIVE_SD * self.coloured.sample::<f64, _>(StandardNormal);
        let v = AR[0] * self.past[0] + AR[1] * self.past[1] + drive;
        self.past = [v, self.past[0]];
        v
    }

    /// The noise of the next sample.
    pub fn next_sample(&mut self) -> SampleNoise {
        if self.kind == NoiseKind::None {
            return SampleNoise::default();
        }
        let sd = WHITE_SD * (OVERSAMPLING as f64).sqrt();
        SampleNoise {
            conversions: std::array::from_fn(|_| sd * self.white.sample::<f64, _>(StandardNormal)),
            shared: match self.kind {
                NoiseKind::Full => self.next_coloured(),
                NoiseKind::White | NoiseKind::None => 0.0,
            },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SAMPLES: usize = 200_000;

    fn mean_square(values: impl Iterator<Item = f64>) -> f64 {
        values.map(|v| v * v).sum::<f64>() / SAMPLES as f64
    }

    /// Autocovariances of an AR(2) process by the Yule-Walker equations, by hand:
    /// r0 = σ² (1-b) / ((1+b) ((1-b)² - a²)), r1 = a r0 / (1-b).
    #[test]
    fn the_coloured_part_has_the_variance_of_its_equation() {
        let (a, b) = (1.5, -0.7);
        let r0 = 0.015f64.powi(2) * (1.0 - b) / ((1.0 + b) * ((1.0 - b).powi(2) - a * a));
        let r1 = a * r0 / (1.0 - b);
        let mut noise = Noise::new(NoiseKind::Full, 11);
        let v: Vec<f64> = (0..SAMPLES).map(|_| noise.next_sample().shared).collect();
        let found0 = mean_square(v.iter().copied());
        let found1 = v.windows(2).map(|w| w[0] * w[1]).sum::<f64>() / SAMPLES as f64;
        // Relative variance of the estimate: 2/n Σ ρ(k)² over all lags, and that sum is 4.16 here:
        // a standard deviation of 0.65 %. 3 % is more than four of them; r1 scatters alike.
        assert!((found0 / r0 - 1.0).abs() < 0.03, "{found0} for {r0}");
        assert!((found1 / r1 - 1.0).abs() < 0.03, "{found1} for {r1}");
    }

    #[test]
    fn the_white_part_of_a_sample_has_the_stated_deviation() {
        let mut noise = Noise::new(NoiseKind::White, 12);
        let found = mean_square((0..SAMPLES).map(|_| {
            let sample = noise.next_sample();
            assert_eq!(sample.shared, 0.0);
            sample.conversions.iter().sum::<f64>() / OVERSAMPLING as f64
        }));
        // sd of a variance of normals: √(2/n) = 0.3 %; 1.5 % is five of them.
        assert!((found / 0.02f64.powi(2) - 1.0).abs() < 0.015, "{found}");
    }

    #[test]
    fn the_seed_alone_decides_and_the_parts_do_not_disturb_each_other() {
        let take = |kind, seed| {
            let mut noise = Noise::new(kind, seed);
            std::array::from_fn::<SampleNoise, 5, _>(|_| noise.next_sample())
        };
        assert_eq!(take(NoiseKind::Full, 3), take(NoiseKind::Full, 3));
        assert_ne!(take(NoiseKind::Full, 3), take(NoiseKind::Full, 4));
        assert_eq!(
            take(NoiseKind::Full, 3).map(|s| s.conversions),
            take(NoiseKind::White, 3).map(|s| s.conversions)
        );
        assert_eq!(take(NoiseKind::None, 3), [SampleNoise::default(); 5]);
    }
}
