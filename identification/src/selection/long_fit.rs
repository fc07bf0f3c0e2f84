//! One long fit that contains every shorter one.

use faer::Mat;

use super::long_fit_noise;
use super::settling_choice::SettlingCandidate;
use crate::data::Moments;
use crate::estimation::{Coordinates, FsfBasis, NormalEquations};
use crate::numerics::{backward_solve, dot, factorised, forward_solve, inverse_of_lower};
use crate::options::NoiseOrder;
use crate::thresholds::{DETECTION, IMMATERIAL_TAIL};

/// Averages are taken over this part of the settling time.
const AVERAGED: usize = 8;

/// A complete bank at the longest settling time, factorised with the offset first and the lags
/// ascending, so that every shorter settling time is a prefix.
pub(crate) struct LongFit {
    pub(crate) settling: usize,
    pub(crate) ar: Vec<f64>,
    rows: usize,
    /// L^-1 b.
    projected: Vec<f64>,
    /// Sum of squares of the filtered output.
    total: f64,
    /// Smallest variance of ε that is taken seriously.
    floor: f64,
    /// F': column m holds the weights of `projected` in the step response at m; (N+1) x N.
    weights: Mat<f64>,
    /// Running sums of those columns, where averages are looked at.
    sums: Option<Mat<f64>>,
}

impl LongFit {
    /// `None` when the input does not excite all of it.
    pub(crate) fn new(moments: &Moments, settling: usize, order: NoiseOrder) -> Option<Self> {
        let basis = FsfBasis::full(settling).ok()?;
        let coordinates = Coordinates::new(basis);
        let factorised =
            |ar: &[f64]| OffsetFirst::new(&NormalEquations::new(moments, &coordinates, ar));
        let ar = long_fit_noise::alternate(moments, order, |ar| {
            let solution = factorised(ar)?.solution();
            Some((solution[1..].to_vec(), solution[0]))
        })?;
        let factor = factorised(&ar)?;
        let inverse = inverse_of_lower(&factor.lower);
        // Row j of L^-1 holds the weights of z_j in each parameter; running sums over the lags
        // make them the weights in the step response.
        let mut weights = Mat::<f64>::zeros(settling + 1, settling);
        let mut sum = vec![0.0; settling + 1];
        for m in 0..settling {
            let scale = factor.scale[m + 1];
            for (sum, weight) in sum.iter_mut().zip(inverse.col_as_slice(m + 1)) {
                *sum += scale * weight;
            }
            weights.col_as_slice_mut(m).copy_from_slice(&sum);
        }
        let spread = moments.output_spread() / moments.rows.max(1) as f64;
        Some(Self {
            settling,
            ar,
            rows: moments.rows,
            projected: factor.projected,
            total: factor.total,
            floor: IMMATERIAL_TAIL * IMMATERIAL_TAIL * spread,
            weights,
            sums: None,
        })
    }

    /// Variance of ε for the settling time `n`.
    fn variance(&self, n: usize) -> f64 {
        let rss = self.total - self.projected[..=n].iter().map(|z| z * z).sum::<f64>();
        let dof = (self.rows as f64 - (n + 1 + self.ar.len()) as f64).max(1.0);
        (rss / dof).max(self.floor)
    }

    /// Looks for the end of the response in its averages too: under a smooth input the noise of a step
    /// response is a ripple, which hides a tail in every single sample but not in their mean.
    pub(crate) fn with_averages(self) -> Self {
        let mut sums = self.weights.clone();
        for m in 1..self.settling {
            for j in 0..=self.settling {
                let before = sums[(j, m - 1)];
                sums[(j, m)] += before;
            }
        }
        Self {
            sums: Some(sums),
            ..self
        }
    }

    /// The middle of the last stretch whose average is not yet the final value of settling time `n`.
    fn moving_on_average(&self, n: usize, sigma: f64) -> Option<usize> {
        let sums = self.sums.as_ref()?;
        let z = &self.projected[..=n];
        let last = &self.weights.col_as_slice(n - 1)[..=n];
        let end = dot(last, z);
        let width = n / AVERAGED;
        let share = (width as f64).recip();
        let from = (0..n - 1 - width).rev().find(|&m| {
            let (before, after) = (sums.col_as_slice(m), sums.col_as_slice(m + width));
            let (mut value, mut variance) = (-end, 0.0);
            for j in 0..=n {
                let weight = share * (after[j] - before[j]);
                value += weight * z[j];
                variance += (weight - last[j]).powi(2);
            }
            value.abs() > DETECTION * sigma * variance.sqrt()
        });
        from.map(|m| m + 1 + width / 2)
    }

    /// The settling times of `grid`, ascending, with their detected ends.
    pub(crate) fn candidates(&self, grid: &[usize]) -> impl Iterator<Item = SettlingCandidate> {
        let contradictions = self.contradictions(grid);
        grid.iter().zip(contradictions).map(|(&n, contradiction)| {
            let sigma = self.variance(n).sqrt();
            let detected = self.moving_until(n, sigma).map_or(1, |m| m + 2);
            SettlingCandidate::new(n, detected, contradiction / sigma, self.settling)
        })
    }

    /// The last sample at which the response of settling time `n` is not yet at its final value.
    fn moving_until(&self, n: usize, sigma: f64) -> Option<usize> {
        let weights = |m: usize| &self.weights.col_as_slice(m)[..=n];
        let z = &self.projected[..=n];
        let last = weights(n - 1);
        let end = dot(last, z);
        let moving = (0..n - 1).rev().find(|&m| {
            let column = weights(m);
            let variance: f64 = column.iter().zip(last).map(|(a, b)| (a - b).powi(2)).sum();
            (dot(column, z) - end).abs() > DETECTION * sigma * variance.sqrt()
        });
        moving.max(self.moving_on_average(n, sigma))
    }

    /// The largest difference between this step response and that of each settling time of `grid`,
    /// ascending, in standard deviations for σ = 1. A shorter one lacks the parts of the lags beyond it, so
    /// one pass from the longest to the shortest gives them all.
    fn contradictions(&self, grid: &[usize]) -> Vec<f64> {
        let mut largest = vec![0.0f64; grid.len()];
        for m in 0..self.settling {
            let column = self.weights.col_as_slice(m);
            let (mut difference, mut variance) = (0.0, 0.0);
            let mut end = self.settling + 1;
            for (largest, n) in largest.iter_mut().zip(grid).rev() {
                let lags = n + 1..end;
                let beyond = &column[lags.clone()];
                difference += dot(beyond, &self.projected[lags]);
                variance += dot(beyond, beyond);
                end = n + 1;
                if variance > 0.0 {
                    *largest = largest.max(difference.abs() / variance.sqrt());
                }
            }
        }
        largest
    }
}

/// Equilibrated Cholesky factor with the offset first.
struct OffsetFirst {
    lower: Mat<f64>,
    scale: Vec<f64>,
    projected: Vec<f64>,
    total: f64,
}

impl OffsetFirst {
    fn new(equations: &NormalEquations) -> Option<Self> {
        let a = &equations.a;
        let last = a.nrows() - 1;
        let original = |k: usize| if k == 0 { last } else { k - 1 };
        let scale = |k: usize| a[(original(k), original(k))].sqrt().recip();
        let scale: Vec<f64> = (0..=last).map(scale).collect();
        // The lower triangle is all that the factor needs.
        let mut turned = Mat::<f64>::zeros(last + 1, last + 1);
        turned[(0, 0)] = 1.0;
        let edge = &a.col_as_slice(last)[..last];
        for ((target, entry), s) in
            (turned.col_as_slice_mut(0)[1..].iter_mut().zip(edge)).zip(&scale[1..])
        {
            *target = scale[0] * s * entry;
        }
        for k in 1..=last {
            let source = &a.col_as_slice(k - 1)[k - 1..last];
            let target = &mut turned.col_as_slice_mut(k)[k..];
            for ((target, entry), s) in target.iter_mut().zip(source).zip(&scale[k..]) {
                *target = scale[k] * s * entry;
            }
        }
        let lower = factorised(turned)?;
        let b: Vec<f64> = (0..=last)
            .map(|k| equations.b[original(k)] * scale[k])
            .collect();
        let projected = forward_solve(&lower, &b);
        Some(Self {
            lower,
            scale,
            projected,
            total: equations.c,
        })
    }

    /// Offset, then the impulse response.
    fn solution(&self) -> Vec<f64> {
        let x = backward_solve(&self.lower, &self.projected);
        x.iter().zip(&self.scale).map(|(x, s)| x * s).collect()
    }
}
