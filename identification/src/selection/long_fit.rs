//! One long fit that contains every shorter one.

use faer::Mat;

use super::long_fit_noise;
use super::settling_candidates::SettlingCandidate;
use super::settling_search::Search;
use crate::data::Moments;
use crate::estimation::{Coordinates, Edges, FsfBasis, lower_input_moments, noise_filter};
use crate::numerics::{backward_solve, dot, factorised, forward_solve, inverse_of_lower};
use crate::thresholds::{DETECTION, IMMATERIAL_TAIL};

/// Averages are taken over this part of the settling time.
const AVERAGED: usize = 8;

/// A complete bank at the longest settling time, factorised with the offset first and the lags
/// ascending, so that every shorter settling time is a prefix.
pub(crate) struct LongFit {
    pub(crate) settling: usize,
    pub(crate) ar: Vec<f64>,
    rows: usize,
    /// How often each error comes.
    repeats: f64,
    /// L^-1 b.
    projected: Vec<f64>,
    /// Sum of squares of the filtered output.
    total: f64,
    /// Smallest variance of ε that is taken seriously.
    floor: f64,
    /// F': column m+1 holds the weights of `projected` in the step response at m; (N+1) x (N+1).
    weights: Mat<f64>,
    /// Running sums of those columns, where averages are looked at.
    sums: Option<Mat<f64>>,
}

impl LongFit {
    /// `None` when the input does not excite all of it.
    pub(crate) fn new(search: &Search<'_>) -> Option<Self> {
        let (moments, settling) = (search.moments, search.longest);
        let basis = FsfBasis::full(settling).ok()?;
        let coordinates = Coordinates::new(basis);
        let (ar, factor) = long_fit_noise::alternate(
            moments,
            search.order,
            |ar| OffsetFirst::new(moments, &coordinates, ar),
            OffsetFirst::solution,
        )?;
        // Row j of L^-1 holds the weights of z_j in each parameter, the offset first; running sums over the lags make them the
        // weights in the step response.
        let mut weights = inverse_of_lower(&factor.lower);
        let mut sum = vec![0.0; settling + 1];
        for m in 0..settling {
            let scale = factor.scale[m + 1];
            for (sum, weight) in sum.iter_mut().zip(weights.col_as_slice_mut(m + 1)) {
                *sum += scale * *weight;
                *weight = *sum;
            }
        }
        let spread = moments.output_spread() / moments.rows.max(1) as f64;
        Some(Self {
            settling,
            ar,
            rows: moments.rows,
            repeats: search.repeats,
            projected: factor.projected,
            total: factor.total,
            floor: IMMATERIAL_TAIL * IMMATERIAL_TAIL * spread,
            weights,
            sums: None,
        })
    }

    /// The weights of `projected` in the step response at `m`.
    fn weights_at(&self, m: usize) -> &[f64] {
        self.weights.col_as_slice(m + 1)
    }

    /// Variance of ε for the settling time `n`, times the number of times that each comes.
    fn variance(&self, n: usize) -> f64 {
        let rss = self.total - self.projected[..=n].iter().map(|z| z * z).sum::<f64>();
        let dof = (self.rows as f64 - (n + 1 + self.ar.len()) as f64).max(1.0);
        self.repeats * (rss / dof).max(self.floor)
    }

    /// Looks for the end of the response in its averages too: under a smooth input the noise of a step
    /// response is a ripple, which hides a tail in every single sample but not in their mean.
    pub(crate) fn with_averages(self) -> Self {
        let mut sums = Mat::<f64>::zeros(self.settling + 1, self.settling);
        let mut sum = vec![0.0; self.settling + 1];
        for m in 0..self.settling {
            for (sum, weight) in sum.iter_mut().zip(self.weights_at(m)) {
                *sum += weight;
            }
            sums.col_as_slice_mut(m).copy_from_slice(&sum);
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
        let last = &self.weights_at(n - 1)[..=n];
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
        let weights = |m: usize| &self.weights_at(m)[..=n];
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
            let column = self.weights_at(m);
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
    fn new(moments: &Moments, coordinates: &Coordinates, ar: &[f64]) -> Option<Self> {
        let Edges {
            edge,
            offset_square,
            offset_output,
            c,
        } = Edges::new(moments, coordinates, ar);
        // The lower triangle is all that the factor needs.
        let settling = coordinates.basis.settling();
        let mut a = lower_input_moments(&moments.uu, settling, &noise_filter(ar), (1, 0));
        a[(0, 0)] = offset_square;
        a.col_as_slice_mut(0)[1..].copy_from_slice(edge.col_as_slice(1));
        let scale: Vec<f64> = (0..=settling).map(|k| a[(k, k)].sqrt().recip()).collect();
        for (k, of_column) in scale.iter().enumerate() {
            let below = &mut a.col_as_slice_mut(k)[k..];
            for (entry, of_row) in below.iter_mut().zip(&scale[k..]) {
                *entry *= of_column * of_row;
            }
        }
        let lower = factorised(a)?;
        let b = [offset_output]
            .into_iter()
            .chain(edge.col_as_slice(0).iter().copied());
        let b: Vec<f64> = b.zip(&scale).map(|(b, s)| b * s).collect();
        let projected = forward_solve(&lower, &b);
        Some(Self {
            lower,
            scale,
            projected,
            total: c,
        })
    }

    /// Impulse response and offset.
    fn solution(&self) -> (Vec<f64>, f64) {
        let x = backward_solve(&self.lower, &self.projected);
        let mut solution = x.iter().zip(&self.scale).map(|(x, s)| x * s);
        let offset = solution.next().unwrap_or(0.0);
        (solution.collect(), offset)
    }
}
