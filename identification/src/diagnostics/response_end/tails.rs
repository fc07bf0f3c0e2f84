//! What the response does after N, as a sum of slow ends.
//!
//! Bounds of a thousandth of a response miss what even a small end does to it: an end of 3 % with a third of N as its time constant has .15 % left after N.
//! So beside the lags up to N stand columns with the input behind lags of first order that begin after N,
//!
//! ```text
//! D(z) y(k) = D(z) (sum_{i<N} h(i) u(k-i) + c + sum_j γ_j w_j(k)) + ε(k),     w_j(k) = ρ_j w_j(k-1) + (1 - ρ_j) u(k-N)
//! ```
//!
//! with time constants that are twice as long from one to the next, so that their sums come near any smooth end. With x_j = (Z'Z)^-1 Z'w_j the γ are a
//! regression of the errors on what the lags leave of the columns, S = W'W - W'Z x, and the lags change by -x γ (Frisch and Waugh, 1933). Each γ has the prior
//! of the gain: mean 0, and a standard deviation that narrows nothing that the record determines.

use faer::Mat;

use super::slow_end::{PERIODS_LOOKED_FOR, behind_lag, rate};
use crate::data::{Moments, Run, repetition};
use crate::diagnostics::residuals::filtered_rows::{filtered, only, present, with_history};
use crate::diagnostics::residuals::further_columns::FurtherColumns;
use crate::diagnostics::residuals::simulation_error::Simulated;
use crate::estimation::{GlsFit, noise_filter};
use crate::numerics::{dot, factorised, inverse_of_square, times};

/// Time constants, in N: a shorter end has nothing left after N, and a longer one is a drift.
const TIME_CONSTANTS: [f64; 6] = [0.125, 0.25, 0.5, 1.0, 2.0, 4.0];

/// The ends of a response, beside the lags of a fit.
pub(crate) struct Tails {
    /// N.
    lags: usize,
    /// ρ of each.
    rates: Vec<f64>,
    /// (Z'Z)^-1 Z'w, the offset last: (p+1) x ends.
    shared: Mat<f64>,
    /// γ \[output per input\].
    gains: Vec<f64>,
    /// Covariance of γ in even noise.
    covariance: Mat<f64>,
}

impl Tails {
    /// Beside the complete bank of `fit`, from its errors in `runs`; `prior_sd` is that of each γ. `None` where moments are not accurate enough.
    pub(crate) fn beside(
        runs: &[Simulated<'_>],
        moments: &Moments,
        fit: &GlsFit,
        prior_sd: f64,
    ) -> Option<Self> {
        const ENDS: usize = TIME_CONSTANTS.len();
        let lags = fit.coordinates.basis.settling();
        let d = noise_filter(&fit.ar);
        let time_constants = TIME_CONSTANTS.map(|times| times * lags as f64);
        let mut columns = FurtherColumns::new(fit, ENDS);
        let mut own = Mat::<f64>::zeros(ENDS, ENDS);
        let mut score = vec![0.0; ENDS];
        for simulated in runs {
            let run = &simulated.run;
            let rows = run.complete_rows(moments.input_lags(), moments.output_lags());
            let period = repetition::of(run, PERIODS_LOOKED_FOR * lags);
            let column = |time_constant: f64| {
                let behind = behind_lag(run, time_constant, moments.centre.0, period);
                only(
                    &rows,
                    filtered(&later(run, behind, lags, moments.centre.0), &d),
                )
            };
            let slow = time_constants.map(column);
            let errors: Vec<f64> = simulated
                .own_errors()
                .iter()
                .copied()
                .map(present)
                .collect();
            let errors = filtered(&errors, &d);
            for i in 0..ENDS {
                score[i] += dot(&slow[i], &errors);
                for j in 0..ENDS {
                    own[(i, j)] += dot(&slow[i], &slow[j]);
                }
            }
            let input = with_history(run, lags + fit.ar.len(), moments.centre.0);
            let places: Vec<usize> = (0..ENDS).collect();
            let slow: Vec<&[f64]> = slow.iter().map(Vec::as_slice).collect();
            columns.add(&filtered(&input, &d), &places, &slow);
        }
        let cross = columns.cross_moments();
        let shared = &fit.solution.inverse * &cross;
        let mut left = own - cross.transpose() * &shared;
        for k in 0..ENDS {
            left[(k, k)] += fit.variance / prior_sd.powi(2);
        }
        let inverse = inverse_of(&left)?;
        Some(Self {
            lags,
            rates: time_constants.map(rate).to_vec(),
            shared,
            gains: times(&inverse, &score),
            covariance: faer::Scale(fit.variance) * inverse,
        })
    }

    /// By how much γ changes Re G and Im G in turn at `omegas` \[rad/sample\], `map` having these of the lags: 2f x ends.
    pub(crate) fn functions(&self, map: &Mat<f64>, omegas: &[f64]) -> Mat<f64> {
        let lags = map.ncols();
        let by_lags = map * self.shared.as_ref().subrows(0, lags);
        Mat::from_fn(map.nrows(), self.rates.len(), |i, k| {
            let (re, im) = end_at(omegas[i / 2], self.rates[k], self.lags);
            let own = if i % 2 == 0 { re } else { im };
            own - by_lags[(i, k)]
        })
    }

    /// γ.
    pub(crate) fn gains(&self) -> &[f64] {
        &self.gains
    }

    /// The covariance of γ.
    pub(crate) fn covariance(&self) -> &Mat<f64> {
        &self.covariance
    }
}

/// The response at `omega` of a lag that keeps `rate` of its state from sample to sample and begins `lags` samples late.
fn end_at(omega: f64, rate: f64, lags: usize) -> (f64, f64) {
    // (1 - ρ) e^{-jωN} / (1 - ρ e^{-jω}).
    let (sin, cos) = omega.sin_cos();
    let (below_re, below_im) = (1.0 - rate * cos, rate * sin);
    let (late_sin, late_cos) = (omega * lags as f64).sin_cos();
    let scale = (1.0 - rate) / (below_re * below_re + below_im * below_im);
    (
        scale * (late_cos * below_re - late_sin * below_im),
        -scale * (late_sin * below_re + late_cos * below_im),
    )
}

/// `values` so many samples later, at rest before.
fn later(run: &Run, values: Vec<f64>, samples: usize, centre: f64) -> Vec<f64> {
    let first = values.first().copied().unwrap_or(0.0);
    let before = run.input_at_rest().map_or(first, |u| u - centre);
    let count = values.len();
    let mut late = vec![before; samples.min(count)];
    late.extend(values.into_iter().take(count.saturating_sub(samples)));
    late
}

/// The inverse of a symmetric matrix; `None` where it is not positive.
fn inverse_of(matrix: &Mat<f64>) -> Option<Mat<f64>> {
    let count = matrix.nrows();
    let positive = (0..count).all(|k| matrix[(k, k)] > 0.0);
    let scale: Vec<f64> = (0..count).map(|k| matrix[(k, k)].sqrt().recip()).collect();
    let scaled =
        |of: &Mat<f64>| Mat::from_fn(count, count, |i, j| scale[i] * of[(i, j)] * scale[j]);
    let lower = factorised(scaled(matrix)).filter(|_| positive)?;
    Some(scaled(&inverse_of_square(&lower)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_response_of_an_end_is_the_sum_over_its_samples() {
        let (omega, rate, lags) = (0.3_f64, 0.9_f64, 7_usize);
        let (mut re, mut im) = (0.0, 0.0);
        for i in 0..400 {
            let value = (1.0 - rate) * rate.powi(i);
            let turn = omega * (lags as f64 + f64::from(i));
            re += value * turn.cos();
            im -= value * turn.sin();
        }
        let found = end_at(omega, rate, lags);
        assert!((found.0 - re).abs() < 1e-12 && (found.1 - im).abs() < 1e-12);
        assert!((end_at(0.0, rate, lags).0 - 1.0).abs() < 1e-12);
    }
}
