//! The basis of frequency sampling filters (FSF): an impulse response from its values at a few
//! frequencies.
//!
//! With Ω = 2π/N and q = (n-1)/2 the model is (Wang & Cluett 2000; Bitmead & Anderson 1981)
//!
//! ```text
//! G(z) = sum_{l=-q..q} G(e^{jlΩ}) H_l(z),   H_l(z) = (1/N) sum_{i=0..N-1} e^{jlΩi} z^-i          (1)
//! theta = [G0, Re G1, Im G1, ..., Re Gq, Im Gq]
//! h_i   = (T theta)_i,  T[i,0] = 1/N,  T[i,2l-1] = (2/N) cos(lΩi),  T[i,2l] = -(2/N) sin(lΩi)     (2)
//! g_m   = sum_{i<=m} h_i = Q(m)'theta                                                             (5)
//! Q(m)  = [(m+1)/N, 2 Re S(1,m), -2 Im S(1,m), ...],  S(l,m) = (1/N) (1-e^{jlΩ(m+1)})/(1-e^{jlΩ})
//! ```
//!
//! The sign of the sine terms is the physical one: `Im G` of a lag is negative. (With both signs inverted
//! the step response is the same, but the parameter is `-Im G`.) The filters are evaluated in their finite
//! form only. The recursive form has its poles on the unit circle, where rounding errors do not decay.
//!
//! With N odd and n = N the basis spans every impulse response of N samples. Q(N-1) is the first unit
//! vector: the last point of the step response *is* the gain G0.

use std::f64::consts::TAU;

use faer::Mat;
use serde::{Deserialize, Serialize};

use crate::error::Error;
use crate::numerics::{dot, running_sum};
use crate::options::LONGEST_SETTLING_BY_HAND;

/// The filter bank of n frequencies for a settling time of N samples.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct FsfBasis {
    settling: usize,
    frequencies: usize,
}

impl FsfBasis {
    /// A bank of `frequencies` (odd, at most `settling`) filters.
    ///
    /// # Errors
    /// A settling time below 3 samples, or a number of frequencies that is even or too large.
    pub fn new(settling: usize, frequencies: usize) -> Result<Self, Error> {
        if settling < 3 {
            return Err(Error::Settling {
                settling,
                longest: LONGEST_SETTLING_BY_HAND,
            });
        }
        if frequencies.is_multiple_of(2) || frequencies > settling {
            return Err(Error::Frequencies {
                frequencies,
                settling,
            });
        }
        Ok(Self {
            settling,
            frequencies,
        })
    }

    /// The largest bank for a settling time: n = N, or N-1 when N is even.
    ///
    /// # Errors
    /// A settling time below 3 samples.
    pub fn full(settling: usize) -> Result<Self, Error> {
        Self::new(settling, settling - usize::from(settling.is_multiple_of(2)))
    }

    /// N \[samples\].
    pub fn settling(&self) -> usize {
        self.settling
    }

    /// n.
    pub fn frequencies(&self) -> usize {
        self.frequencies
    }

    /// q = (n-1)/2: the index of the highest frequency.
    pub fn highest(&self) -> usize {
        (self.frequencies - 1) / 2
    }

    /// Whether the bank spans every impulse response of N samples.
    pub fn is_complete(&self) -> bool {
        self.frequencies == self.settling
    }

    /// Whether the bank omits at most the frequency N/2 of an even N.
    pub fn has_all_frequencies(&self) -> bool {
        self.frequencies + 1 >= self.settling
    }

    /// Ω = 2π/N \[rad/sample\].
    pub fn fundamental(&self) -> f64 {
        TAU / self.settling as f64
    }

    /// The highest frequency of the bank \[Hz\].
    pub fn highest_hz(&self, sample_period_s: f64) -> f64 {
        self.highest() as f64 / (self.settling as f64 * sample_period_s)
    }

    /// T of eq. (2): N x n, from parameters to impulse response.
    pub fn impulse_map(&self) -> Mat<f64> {
        let scale = 1.0 / self.settling as f64;
        let circle = Circle::new(self.settling);
        let mut map = Mat::zeros(self.settling, self.frequencies);
        map.col_as_slice_mut(0).fill(scale);
        for l in 1..=self.highest() {
            for (i, (sin, cos)) in circle.multiples(l).enumerate() {
                map[(i, 2 * l - 1)] = 2.0 * scale * cos;
                map[(i, 2 * l)] = -2.0 * scale * sin;
            }
        }
        map
    }

    /// n x N, from an impulse response of N samples to parameters (the discrete Fourier transform
    /// at the frequencies of the bank). Inverse of [`FsfBasis::impulse_map`] when the bank is complete.
    pub fn analysis_map(&self) -> Mat<f64> {
        let circle = Circle::new(self.settling);
        let mut map = Mat::zeros(self.frequencies, self.settling);
        for i in 0..self.settling {
            let column = map.col_as_slice_mut(i);
            column[0] = 1.0;
            let pairs = column[1..].chunks_exact_mut(2);
            for (pair, (sin, cos)) in pairs.zip(circle.multiples(i).skip(1)) {
                pair[0] = cos;
                pair[1] = -sin;
            }
        }
        map
    }

    /// Rows Q(m)', m = 0..N-1, of eq. (5): N x n, from parameters to step response.
    pub fn step_map(&self) -> Mat<f64> {
        let mut map = self.impulse_map();
        for j in 0..self.frequencies {
            for i in 1..self.settling {
                map[(i, j)] += map[(i - 1, j)];
            }
        }
        map
    }

    /// Columns Q(m) of eq. (5) for the samples `points` alone: n x points.
    pub fn step_rows(&self, points: &[usize]) -> Mat<f64> {
        let n = self.settling;
        // S(l,m) = sin(lΩ(m+1)/2) e^{jlΩm/2} / (N sin(lΩ/2)): multiples of the angle π/N.
        let half = Circle::new(2 * n);
        Mat::from_fn(self.frequencies, points.len(), |j, k| {
            let (l, m) = (j.div_ceil(2), points[k]);
            if l == 0 {
                return (m + 1) as f64 / n as f64;
            }
            let size = 2.0 * half.sin(l * (m + 1)) / (n as f64 * half.sin(l));
            match j % 2 {
                1 => size * half.cos(l * m),
                _ => -size * half.sin(l * m),
            }
        })
    }

    /// The impulse response T θ (N samples).
    pub fn impulse_response(&self, theta: &[f64]) -> Vec<f64> {
        let circle = Circle::new(self.settling);
        let scale = 1.0 / self.settling as f64;
        (0..self.settling)
            .map(|i| {
                let pairs = theta[1..].chunks_exact(2).zip(circle.multiples(i).skip(1));
                let pairs = pairs.map(|(pair, (sin, cos))| pair[0] * cos - pair[1] * sin);
                scale * (theta[0] + 2.0 * pairs.sum::<f64>())
            })
            .collect()
    }

    /// The step response Q(m)'θ, m = 0..N-1, to a unit step at sample 0.
    pub fn step_response(&self, theta: &[f64]) -> Vec<f64> {
        running_sum(&self.impulse_response(theta))
    }

    /// |S(l,m)| = |sin(lΩ(m+1)/2) / (N sin(lΩ/2))| for each frequency l = 1..=N/2 (outer) and m = 0..N-1
    /// (inner): the largest contribution of a unit of |G_l| to the step response.
    pub fn step_kernel_magnitudes(&self) -> Vec<Vec<f64>> {
        let n = self.settling;
        // |sin(πk/N)| has the period N.
        let half: Vec<f64> = (0..n)
            .map(|k| (std::f64::consts::PI * k as f64 / n as f64).sin())
            .collect();
        (1..=n / 2)
            .map(|l| {
                let scale = 1.0 / (half[l] * n as f64);
                (1..=n).map(|m| half[l * m % n] * scale).collect()
            })
            .collect()
    }

    /// The two rows that map parameters to Re G and Im G at `omega` \[rad/sample\], any value:
    /// G = sum_i e^{-jωi} (Tθ)_i. A lag has negative phase.
    pub fn frequency_rows(&self, omega: f64) -> (Vec<f64>, Vec<f64>) {
        let n = self.settling as f64;
        let mut re = vec![0.0; self.frequencies];
        let mut im = vec![0.0; self.frequencies];
        let (turn_sin, turn_cos) = (n * omega).sin_cos();
        let (sin, cos) = omega.sin_cos();
        let (step_sin, step_cos) = self.fundamental().sin_cos();
        // H_l(e^{jω}) = (1/N) (1 - e^{-jNω}) / (1 - e^{j(lΩ-ω)}): the numerator is common to all l.
        let numerator = ((1.0 - turn_cos) / n, turn_sin / n);
        let filter = |l: usize, c: f64, s: f64, sign: f64| {
            let s = sign * s;
            let denominator = (1.0 - (c * cos + s * sin), -(s * cos - c * sin));
            let square = denominator.0.powi(2) + denominator.1.powi(2);
            // Near the filter's own frequency both vanish. Dirichlet's form avoids the cancellation.
            if square < 1e-4 {
                return dirichlet(self.settling, sign * l as f64 * self.fundamental() - omega);
            }
            (
                (numerator.0 * denominator.0 + numerator.1 * denominator.1) / square,
                (numerator.1 * denominator.0 - numerator.0 * denominator.1) / square,
            )
        };
        (re[0], im[0]) = filter(0, 1.0, 0.0, 1.0);
        // G is the sum over +-l of G_l H_l, with G_-l the conjugate of G_l. cos lΩ and sin lΩ come from
        // a recursive rotation, whose error after n steps is n roundings.
        let (mut c, mut s) = (1.0, 0.0);
        for l in 1..=self.highest() {
            (c, s) = (c * step_cos - s * step_sin, c * step_sin + s * step_cos);
            let (plus, minus) = (filter(l, c, s, 1.0), filter(l, c, s, -1.0));
            re[2 * l - 1] = plus.0 + minus.0;
            im[2 * l - 1] = plus.1 + minus.1;
            // j (H_l - H_-l)
            re[2 * l] = -(plus.1 - minus.1);
            im[2 * l] = plus.0 - minus.0;
        }
        (re, im)
    }

    /// G at each of `omegas` \[rad/sample\] as (real, imaginary), summed over the impulse response.
    pub fn frequency_responses(&self, theta: &[f64], omegas: &[f64]) -> Vec<(f64, f64)> {
        const TOGETHER: usize = 8;
        let impulse = self.impulse_response(theta);
        let mut responses = Vec::with_capacity(omegas.len());
        for omegas in omegas.chunks(TOGETHER) {
            // e^{jωi} by recursive rotation, several frequencies at once. The error after N steps is N
            // roundings.
            let (mut c, mut s) = ([1.0; TOGETHER], [0.0; TOGETHER]);
            let (mut re, mut im) = ([0.0; TOGETHER], [0.0; TOGETHER]);
            let (mut cos, mut sin) = ([1.0; TOGETHER], [0.0; TOGETHER]);
            for ((sin, cos), omega) in sin.iter_mut().zip(&mut cos).zip(omegas) {
                (*sin, *cos) = omega.sin_cos();
            }
            for h in &impulse {
                for k in 0..TOGETHER {
                    re[k] += h * c[k];
                    im[k] -= h * s[k];
                    (c[k], s[k]) = (c[k] * cos[k] - s[k] * sin[k], c[k] * sin[k] + s[k] * cos[k]);
                }
            }
            responses.extend(re.into_iter().zip(im).take(omegas.len()));
        }
        responses
    }

    /// G at `omega` \[rad/sample\] as (real, imaginary).
    pub fn frequency_response(&self, theta: &[f64], omega: f64) -> (f64, f64) {
        let (re, im) = self.frequency_rows(omega);
        (dot(&re, theta), dot(&im, theta))
    }
}

/// (1/N) sum_{i<N} e^{jxi} as (real, imaginary).
fn dirichlet(n: usize, x: f64) -> (f64, f64) {
    let half = x / 2.0;
    let count = n as f64;
    // At a multiple of 2π the quotient is 0/0. Below 1e-9 its limit is exact to rounding.
    let amplitude = if half.sin().abs() < 1e-9 {
        (half * count).cos() / half.cos()
    } else {
        (half * count).sin() / (half.sin() * count)
    };
    let (sin, cos) = (half * (count - 1.0)).sin_cos();
    (amplitude * cos, amplitude * sin)
}

/// Table of sin and cos of 2πk/N: exact reduction for any k.
pub(crate) struct Circle {
    points: Vec<(f64, f64)>,
}

impl Circle {
    pub(crate) fn new(n: usize) -> Self {
        Self {
            points: (0..n)
                .map(|k| (TAU * k as f64 / n as f64).sin_cos())
                .collect(),
        }
    }

    /// (sin, cos) of the angles 0, l, 2l, ... (N-1)l, for l up to N.
    pub(crate) fn multiples(&self, l: usize) -> impl Iterator<Item = (f64, f64)> {
        let n = self.points.len();
        std::iter::successors(Some(0), move |k| {
            let next = k + l;
            Some(if next < n { next } else { next - n })
        })
        .take(n)
        .map(|k| self.points[k])
    }

    fn cos(&self, k: usize) -> f64 {
        self.points[k % self.points.len()].1
    }
    fn sin(&self, k: usize) -> f64 {
        self.points[k % self.points.len()].0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_abs_diff_eq;

    fn theta(n: usize) -> Vec<f64> {
        (0..n)
            .map(|j| 0.7 / (1.0 + j as f64) * if j % 2 == 0 { -1.0 } else { 1.0 })
            .collect()
    }

    #[test]
    fn rows_of_single_samples_are_those_of_the_whole_map() {
        let basis = FsfBasis::new(40, 15).unwrap();
        let (rows, map) = (basis.step_rows(&[3, 39]), basis.step_map());
        assert!((0..15).all(|j| (rows[(j, 0)] - map[(3, j)]).abs() < 1e-14));
        assert!((0..15).all(|j| (rows[(j, 1)] - map[(39, j)]).abs() < 1e-14));
    }

    #[test]
    fn the_response_at_a_bin_is_the_parameter_and_a_delay_lags() {
        let basis = FsfBasis::new(40, 15).unwrap();
        let theta = theta(15);
        for l in 0..=basis.highest() {
            let (re, im) = basis.frequency_response(&theta, l as f64 * basis.fundamental());
            let expected = if l == 0 {
                (theta[0], 0.0)
            } else {
                (theta[2 * l - 1], theta[2 * l])
            };
            // A sum of 40 products of order one.
            assert_abs_diff_eq!(re, expected.0, epsilon = 1e-13);
            assert_abs_diff_eq!(im, expected.1, epsilon = 1e-13);
        }
        // A pure delay of three samples: h = e_3, phase -3 omega.
        let full = FsfBasis::full(41).unwrap();
        let analysis = full.analysis_map();
        let delay: Vec<f64> = (0..41).map(|j| analysis[(j, 3)]).collect();
        for omega in [0.01, 0.3, 1.0] {
            let (re, im) = full.frequency_response(&delay, omega);
            assert_abs_diff_eq!(im.atan2(re), -3.0 * omega, epsilon = 1e-12);
        }
    }

    #[test]
    fn closed_forms_agree_with_the_sums_they_stand_for() {
        let basis = FsfBasis::new(30, 11).unwrap();
        let theta = theta(11);
        let (map, step) = (basis.impulse_map(), basis.step_map());
        let impulse = basis.impulse_response(&theta);
        let response = basis.step_response(&theta);
        let kernels = basis.step_kernel_magnitudes();
        for m in 0..30 {
            let row = |map: &Mat<f64>| (0..11).map(|j| map[(m, j)] * theta[j]).sum::<f64>();
            assert_abs_diff_eq!(impulse[m], row(&map), epsilon = 1e-14);
            assert_abs_diff_eq!(response[m], row(&step), epsilon = 1e-14);
            for l in 1..=5 {
                let magnitude = step[(m, 2 * l - 1)].hypot(step[(m, 2 * l)]) / 2.0;
                assert_abs_diff_eq!(kernels[l - 1][m], magnitude, epsilon = 1e-14);
            }
        }
        assert_abs_diff_eq!(response[29], theta[0], epsilon = 1e-13);
        for omega in [0.0, 0.05, 1.234, 3.0] {
            let direct = impulse
                .iter()
                .enumerate()
                .fold((0.0, 0.0), |(re, im), (i, h)| {
                    let (sin, cos) = (omega * i as f64).sin_cos();
                    (re + h * cos, im - h * sin)
                });
            let (re, im) = basis.frequency_response(&theta, omega);
            assert_abs_diff_eq!(re, direct.0, epsilon = 1e-13);
            assert_abs_diff_eq!(im, direct.1, epsilon = 1e-13);
            let together = basis.frequency_responses(&theta, &[omega; 11]);
            assert_eq!(together.len(), 11);
            assert_abs_diff_eq!(together[10].0, direct.0, epsilon = 1e-13);
            assert_abs_diff_eq!(together[10].1, direct.1, epsilon = 1e-13);
        }
    }

    #[test]
    fn a_complete_bank_loses_nothing() {
        let basis = FsfBasis::full(21).unwrap();
        let round_trip = basis.analysis_map() * basis.impulse_map();
        for i in 0..21 {
            for j in 0..21 {
                assert_abs_diff_eq!(
                    round_trip[(i, j)],
                    f64::from(u8::from(i == j)),
                    epsilon = 1e-14
                );
            }
        }
    }
}
