//! Up to which frequency the input has power.
//!
//! The changes of an input of steps have as much power at any frequency as at any other. Where they lack high
//! frequencies, because the input went through a filter or is made of sines, nothing determines the response
//! there: bounds become wide, settling is seen late, and in the end frequencies have to be left out.

use serde::{Deserialize, Serialize};

use crate::data::Moments;
use crate::thresholds::SMOOTH_SHARE;

/// Lags over which the changes of the input may be related to each other.
const LAGS: usize = 64;

/// Share of the power of the changes above the frequency that is named as its end.
const REST: f64 = 0.05;

/// Frequencies between zero and half the sampling rate among which that end is looked for.
const GRID: usize = 250;

/// Where the power of the input is.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Excitation {
    /// Share of the power of its changes above a quarter of the sampling rate.
    pub upper_share: f64,
    /// Above this frequency is a 20th of the power of its changes \[Hz\]; half the sampling rate where the
    /// input is not smooth.
    pub power_up_to_hz: f64,
    /// Whether the effect of left-out frequencies on the others has a bound; true where none are left out.
    pub bounded: bool,
}

impl Excitation {
    /// Of the input behind `moments`.
    pub fn of(moments: &Moments) -> Self {
        let power = Power::new(moments);
        let (grid, nyquist) = (GRID as f64, 0.5 / moments.sample_period_s());
        let upper_share = power.share_above(0.5);
        // An input of steps has no such end.
        let end = (1..GRID)
            .filter(|_| upper_share < SMOOTH_SHARE)
            .find(|&k| power.share_above(k as f64 / grid) < REST)
            .unwrap_or(GRID);
        Self {
            upper_share,
            power_up_to_hz: end as f64 / grid * nyquist,
            bounded: true,
        }
    }

    /// Whether the input lacks the power that edges have at high frequencies.
    pub fn is_smooth(&self) -> bool {
        self.upper_share < SMOOTH_SHARE
    }
}

/// Autocovariances of the changes of the input, tapered, relative to their variance.
struct Power {
    covariances: Vec<f64>,
}

impl Power {
    fn new(moments: &Moments) -> Self {
        let lags = LAGS.min(moments.input_lags().saturating_sub(2));
        let uu = |a: usize, b: usize| moments.uu[(a, b)];
        let of = |k: usize| uu(0, k) - uu(0, k + 1) - uu(1, k) + uu(1, k + 1);
        let variance = if lags > 0 { of(0) } else { 0.0 };
        let covariance = |k: usize| {
            let taper = 1.0 - k as f64 / (lags + 1) as f64;
            taper * of(k) / variance
        };
        Self {
            covariances: if variance > 0.0 {
                (1..lags).map(covariance).collect()
            } else {
                Vec::new()
            },
        }
    }

    /// Share of the power above a frequency, given as a share of half the sampling rate.
    fn share_above(&self, frequency: f64) -> f64 {
        let turn = std::f64::consts::PI * frequency;
        let sum: f64 = self
            .covariances
            .iter()
            .zip(1..)
            .map(|(r, k)| r * (turn * f64::from(k)).sin() / f64::from(k))
            .sum();
        (1.0 - frequency - 2.0 / std::f64::consts::PI * sum).clamp(0.0, 1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::Record;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;
    use std::f64::consts::TAU;

    fn of(input: &[f64]) -> Excitation {
        let record = Record::of_run(0.002, input, input).unwrap();
        Excitation::of(&Moments::of_record(&record, 100, 1))
    }

    fn filtered(input: &[f64], keep: f64) -> Vec<f64> {
        let follow = |state: &mut f64, u: &f64| {
            *state = keep * *state + (1.0 - keep) * u;
            Some(*state)
        };
        input.iter().scan(0.0, follow).collect()
    }

    #[test]
    fn edges_have_power_everywhere_and_filters_take_it_away() {
        // Random levels, held for 10 samples each: its edges are not related to each other.
        let mut random = ChaCha8Rng::seed_from_u64(8);
        let edges: Vec<f64> = (0..800)
            .flat_map(|_| std::iter::repeat_n(random.random::<f64>(), 10))
            .collect();
        let sharp = of(&edges);
        // 800 edges: their autocovariances scatter by 1/sqrt(800), six of them count, with 1/k.
        assert!((sharp.upper_share - 0.5).abs() < 0.03, "{sharp:?}");
        assert!(!sharp.is_smooth());
        let keep: f64 = 0.8;
        let smooth = of(&filtered(&edges, keep));
        // The changes are now 1/|1 - a e^{-jω}|², whose share above ω is 1 - (2/π) atan((1+a)/(1-a) tan(ω/2)).
        let exact = 1.0 - 2.0 / std::f64::consts::PI * ((1.0 + keep) / (1.0 - keep)).atan();
        assert!(
            (smooth.upper_share - exact).abs() < 0.02,
            "{smooth:?} {exact}"
        );
        assert!(smooth.is_smooth());
        let twice = of(&filtered(&filtered(&edges, keep), keep));
        assert!(twice.power_up_to_hz < smooth.power_up_to_hz);
    }

    #[test]
    fn a_sine_ends_where_it_is() {
        let sine: Vec<f64> = (0..4000)
            .map(|k| (TAU * 7.0 * 0.002 * f64::from(k)).sin())
            .collect();
        let found = of(&sine);
        // The taper over 64 lags of 2 ms blurs by some 8 Hz.
        assert!(
            found.is_smooth() && (4.0..25.0).contains(&found.power_up_to_hz),
            "{found:?}"
        );
    }
}
