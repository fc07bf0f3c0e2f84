//! Tests of what the model leaves over.
//!
//! **Whiteness** (Ljung & Box 1978). If the noise model is right, the one-step errors ε are white,
//! and Q = sum_τ n_τ r_τ² over the autocorrelations at lags 1..h follows χ² with h-d degrees of
//! freedom. A small p means that the noise model is incomplete (a periodic disturbance, more orders,
//! a nonlinearity): bounds are then approximate.
//!
//! **Independence of the input** (a score test). If N is long enough and the servo linear, adding
//! further lags of the input explains nothing more: the reduction of the sum of squares by K extra
//! D-filtered lags, over σ², follows χ² with K degrees of freedom. A small p means that the response
//! is longer than N, has more detail than n frequencies, or is not linear.
//!
//! **Linearity**: see [`crate::diagnostics::linearity`], and [`crate::diagnostics::standstill_noise`] where the servo was recorded at rest too.

use faer::{Mat, Side};
use statrs::distribution::{ChiSquared, ContinuousCDF};

use crate::data::moments::Moments;
use crate::estimation::fsf_basis::dot;
use crate::estimation::least_squares::{
    Coordinates, NormalEquations, filtered_input_moments, solve_moments, with_one,
};
use crate::numerics::linear_algebra::times;

/// Lags of the whiteness test.
pub const WHITENESS_LAGS: usize = 25;

/// Samples at the beginning of a record that the whiteness test looks at: more would only make it find what does not
/// matter.
pub const WHITENESS_SAMPLES: usize = 100_000;

/// Extra lags of the input in the test of independence.
pub const INPUT_LAGS: usize = 10;

/// The p-value of Ljung and Box's test on one-step errors, one slice per run, NaN where missing.
/// `noise_order` coefficients have been fitted to them, and a response of `share` parameters per row.
///
/// The response takes p of n degrees of freedom out of the errors, and because its regressors are each
/// other's past, the same p out of every lagged product: with σ² = sum ε²/(n-p) the sum of
/// ε(k) ε(k-τ) has the variance (n-p) σ⁴. The usual n r² would be n/(n-p) times too large, which
/// matters when the response is long: at six rows a parameter white noise would fail in 6 % of
/// records at a level of 1 %.
#[must_use]
pub fn whiteness(errors: &[Vec<f64>], noise_order: usize, share: f64) -> Option<f64> {
    let present = errors.iter().flatten().filter(|error| !error.is_nan());
    let (count, square) = present.fold((0usize, 0.0), |(n, sum), e| (n + 1, sum + e * e));
    if count < 4 * WHITENESS_LAGS || square == 0.0 {
        return None;
    }
    let mean_square = square / count as f64;
    let runs: Vec<Present> = errors.iter().map(|run| Present::of(run)).collect();
    let statistic: f64 = (1..=WHITENESS_LAGS)
        .map(|lag| {
            let pairs: f64 = runs.iter().map(|run| run.pairs(lag)).sum();
            let sum: f64 = runs.iter().map(|run| run.lagged_product(lag)).sum();
            if pairs == 0.0 {
                return 0.0;
            }
            (1.0 - share) * sum * sum / (pairs * mean_square * mean_square)
        })
        .sum();
    upper_tail(statistic, WHITENESS_LAGS.saturating_sub(noise_order).max(1))
}

/// One run of errors from the first to the last that is there.
struct Present {
    /// 0 where one is missing.
    errors: Vec<f64>,
    /// 1 where one is there, 0 where it is missing; `None` when all are there.
    there: Option<Vec<f64>>,
}

impl Present {
    fn of(run: &[f64]) -> Self {
        let first = run.iter().position(|error| !error.is_nan()).unwrap_or(0);
        let last = run.iter().rposition(|error| !error.is_nan());
        let run = &run[first..last.map_or(first, |last| last + 1)];
        let there = |error: &f64| f64::from(u8::from(!error.is_nan()));
        Self {
            errors: run
                .iter()
                .map(|e| if e.is_nan() { 0.0 } else { *e })
                .collect(),
            there: run
                .iter()
                .any(|error| error.is_nan())
                .then(|| run.iter().map(there).collect()),
        }
    }

    /// Number of pairs a lag apart that are both there.
    fn pairs(&self, lag: usize) -> f64 {
        match &self.there {
            None => self.errors.len().saturating_sub(lag) as f64,
            Some(there) => dot(there.get(lag..).unwrap_or_default(), there),
        }
    }

    /// Sum of their products.
    fn lagged_product(&self, lag: usize) -> f64 {
        dot(self.errors.get(lag..).unwrap_or_default(), &self.errors)
    }
}

/// The p-value of the test of independence, for the noise filter `ar`; `None` when the moments
/// have no further lags, or further lags carry nothing new.
#[must_use]
pub fn input_independence(moments: &Moments, coordinates: &Coordinates, ar: &[f64]) -> Option<f64> {
    let (n, order) = (coordinates.basis.settling(), ar.len());
    let beyond = moments.input_lags().checked_sub(n + order)?.min(INPUT_LAGS);
    let mut lags: Vec<usize> = (n..n + beyond).collect();
    if !coordinates.basis.is_complete() {
        lags.extend((0..n).step_by(n.div_ceil(INPUT_LAGS)));
    }
    if lags.is_empty() {
        return None;
    }
    let d = with_one(ar);
    let gain: f64 = d.iter().sum();
    let uu = filtered_input_moments(&moments.uu, n + beyond, &d);
    let square = coordinates.square(uu.as_ref().submatrix(0, 0, n, n));
    let equations = NormalEquations::with_square(moments, coordinates, ar, square);
    let solution = solve_moments(&equations)?;
    let impulse = coordinates.impulse(solution.response());
    let rows = moments.rows as f64;
    let filtered = |values: &dyn Fn(usize) -> f64, lag: usize| -> f64 {
        d.iter()
            .enumerate()
            .map(|(i, di)| di * values(lag + i))
            .sum()
    };
    let with_output = |lag: usize| {
        d.iter()
            .enumerate()
            .map(|(j, dj)| dj * filtered(&|a| moments.uy[(a, j)], lag))
            .sum::<f64>()
    };
    let with_offset = |lag: usize| gain * filtered(&|a| moments.u[a], lag);
    let score: Vec<f64> = lags
        .iter()
        .map(|&lag| {
            // uu is symmetric.
            let modelled = dot(&impulse, uu.col_as_slice(lag));
            with_output(lag) - modelled - with_offset(lag) * solution.offset()
        })
        .collect();
    // Cross moments of the extra lags with the regressors, in coordinates, offset last.
    let p = coordinates.len();
    let by_lag = Mat::from_fn(lags.len(), n, |k, b| uu[(lags[k], b)]);
    let by_coordinate = match coordinates.impulse_map() {
        Some(map) => by_lag * map,
        None => by_lag,
    };
    let cross = Mat::from_fn(lags.len(), p + 1, |k, j| {
        if j < p {
            by_coordinate[(k, j)]
        } else {
            with_offset(lags[k])
        }
    });
    let own = Mat::from_fn(lags.len(), lags.len(), |k, l| uu[(lags[k], lags[l])]);
    let left = &own - &cross * &solution.inverse * cross.transpose();
    let variance = solution.rss / (rows - (p + 1 + order) as f64).max(1.0);
    let found = ScoreTest::new(&left, &own, &score)?;
    upper_tail(found.reduction / variance, found.degrees)
}

/// What further regressors explain: the score test, from the moments of these regressors alone.
pub(crate) struct ScoreTest {
    /// By how much they reduce the sum of squares.
    pub(crate) reduction: f64,
    /// In how many directions.
    pub(crate) degrees: usize,
    /// Their coefficients.
    pub(crate) coefficients: Vec<f64>,
}

impl ScoreTest {
    /// Of regressors with the second moments `own`, of which the regressors before them leave
    /// `left`, and the products `score` with the residuals. Directions of which rounding alone is
    /// left are passed over; `None` when there are no others.
    pub(crate) fn new(left: &Mat<f64>, own: &Mat<f64>, score: &[f64]) -> Option<Self> {
        let k = score.len();
        if (0..k).any(|i| !own[(i, i)].is_finite()) {
            return None;
        }
        // What is zero all along, such as the speed of a run that rests, is no direction.
        let scale_of = |square: f64| {
            if square > 0.0 {
                square.sqrt().recip()
            } else {
                0.0
            }
        };
        let scale: Vec<f64> = (0..k).map(|i| scale_of(own[(i, i)])).collect();
        let scaled = Mat::from_fn(k, k, |i, j| left[(i, j)] * scale[i] * scale[j]);
        let eigen = scaled.self_adjoint_eigen(Side::Lower).ok()?;
        let scaled_score: Vec<f64> = score.iter().zip(&scale).map(|(s, c)| s * c).collect();
        let turned = times(&eigen.U().transpose().to_owned(), &scaled_score);
        // A direction of which less than a millionth is new to the regressors carries rounding only.
        let kept: Vec<usize> = (0..k).filter(|&i| eigen.S()[i] > 1e-6).collect();
        let coefficients = (0..k)
            .map(|j| {
                let along = |&i: &usize| eigen.U()[(j, i)] * turned[i] / eigen.S()[i];
                scale[j] * kept.iter().map(along).sum::<f64>()
            })
            .collect();
        (!kept.is_empty()).then(|| Self {
            reduction: kept
                .iter()
                .map(|&i| turned[i] * turned[i] / eigen.S()[i])
                .sum(),
            degrees: kept.len(),
            coefficients,
        })
    }
}

fn upper_tail(statistic: f64, degrees: usize) -> Option<f64> {
    let chi = ChiSquared::new(degrees as f64).ok()?;
    Some(chi.sf(statistic).clamp(0.0, 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};

    #[test]
    fn white_errors_pass_and_coloured_ones_fail() {
        let mut random = rand_chacha::ChaCha8Rng::seed_from_u64(5);
        let runs = 400;
        let mut rejected = 0;
        for _ in 0..runs {
            let mut errors: Vec<f64> = (0..500)
                .map(|_| StandardNormal.sample(&mut random))
                .collect();
            errors[100] = f64::NAN;
            rejected += usize::from(whiteness(&[errors], 0, 0.0).unwrap() < 0.05);
        }
        // 5 % of 400 with a standard deviation of 1.1 %.
        let share = rejected as f64 / f64::from(runs);
        assert!((0.015..0.085).contains(&share), "{share}");
        let slow: Vec<f64> = (0..500)
            .scan(0.0, |x, _| {
                let e: f64 = StandardNormal.sample(&mut random);
                *x = 0.3 * *x + e;
                Some(*x)
            })
            .collect();
        assert!(whiteness(&[slow], 0, 0.0).unwrap() < 1e-3);
    }
}
