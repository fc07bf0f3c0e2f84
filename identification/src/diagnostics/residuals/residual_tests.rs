//! Tests of the residuals.
//!
//! **Whiteness** (Ljung & Box 1978). If the noise model is right, the one-step errors ε are white. The
//! statistic Q = sum_τ n_τ r_τ² over the autocorrelations at lags 1..h then follows χ² with h-d degrees of
//! freedom. A small p means that the noise model is incomplete (a periodic disturbance, a higher order, a
//! nonlinearity). Bounds are then approximate.
//!
//! **Independence of the input** (a score test). If N is long enough and the servo linear, further lags of
//! the input explain nothing more. The reduction of the sum of squares by K extra D-filtered lags, over σ²,
//! then follows χ² with K degrees of freedom. A small p means that the response is longer than N, has more
//! detail than n frequencies, or is not linear.
//!
//! **Linearity** is tested in [`crate::diagnostics::linearity`], and in
//! [`crate::diagnostics::noise::standstill_noise`] for a servo that was recorded at rest too.

use faer::Mat;

use super::filtered_rows::present;
use crate::data::Moments;
use crate::estimation::{
    Coordinates, NormalEquations, filtered_input_moments, noise_filter, solve_moments,
};
use crate::numerics::{chi_square_upper_tail, dot, symmetric_eigen, times};

/// Lags of the whiteness test.
pub const WHITENESS_LAGS: usize = 25;

/// Samples that the whiteness test uses, from the beginning of a record. With more it would find
/// irrelevant departures.
pub const WHITENESS_SAMPLES: usize = 100_000;

/// Extra lags of the input in the test of independence.
pub const INPUT_LAGS: usize = 10;

/// The p-value of Ljung and Box's test on one-step errors, one slice per run, NaN where missing.
/// `noise_order` coefficients were fitted to them, and a response of `share` parameters per row.
///
/// The response takes p of n degrees of freedom from the errors. Its regressors are shifts of each other, so
/// it takes the same p from every lagged product: with σ² = sum ε²/(n-p) the sum of ε(k) ε(k-τ) has the
/// variance (n-p) σ⁴. The usual n r² would be too large by n/(n-p). That matters for a long response: at
/// six rows a parameter, white noise would fail in 6 % of records at a level of 1 %.
#[must_use]
pub fn whiteness(errors: &[Vec<f64>], noise_order: usize, share: f64) -> Option<f64> {
    let present = errors.iter().flatten().filter(|error| !error.is_nan());
    let (count, square) = present.fold((0usize, 0.0), |(n, sum), e| (n + 1, sum + e * e));
    if count < 4 * WHITENESS_LAGS || square == 0.0 {
        return None;
    }
    let mean_square = square / count as f64;
    let runs: Vec<KnownErrors> = errors.iter().map(|run| KnownErrors::of(run)).collect();
    let statistic: f64 = (1..=WHITENESS_LAGS)
        .map(|lag| {
            let (pairs, sum) = runs
                .iter()
                .map(|run| run.pairs(lag))
                .fold((0.0, 0.0), |all, run| (all.0 + run.0, all.1 + run.1));
            if pairs == 0.0 {
                return 0.0;
            }
            (1.0 - share) * sum * sum / (pairs * mean_square * mean_square)
        })
        .sum();
    let degrees = WHITENESS_LAGS.saturating_sub(noise_order).max(1);
    Some(chi_square_upper_tail(statistic, degrees))
}

/// The errors of one run, from the first to the last known one.
struct KnownErrors {
    /// 0 where missing.
    errors: Vec<f64>,
    /// 1 where known, 0 where missing.
    known: Vec<f64>,
}

impl KnownErrors {
    fn of(run: &[f64]) -> Self {
        let first = run.iter().position(|error| !error.is_nan()).unwrap_or(0);
        let last = run.iter().rposition(|error| !error.is_nan());
        let run = &run[first..last.map_or(first, |last| last + 1)];
        let known = |error: &f64| f64::from(u8::from(!error.is_nan()));
        Self {
            errors: run.iter().copied().map(present).collect(),
            known: run.iter().map(known).collect(),
        }
    }

    /// Number of known pairs at a lag, and the sum of their products.
    fn pairs(&self, lag: usize) -> (f64, f64) {
        let lagged = |values: &[f64]| dot(values.get(lag..).unwrap_or_default(), values);
        (lagged(&self.known), lagged(&self.errors))
    }
}

/// The p-value of the test of independence, for the noise filter `ar`. `None` when the moments have no
/// further lags, or further lags are combinations of the others.
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
    let d = noise_filter(ar);
    let gain: f64 = d.iter().sum();
    let uu = filtered_input_moments(&moments.uu, n + beyond, &d);
    let square = coordinates.square(uu.as_ref().submatrix(0, 0, n, n).to_owned());
    let equations = NormalEquations::with_square(moments, coordinates, ar, &square);
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
    let by_coordinate = coordinates.combine(by_lag);
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
    let statistic = found.reduction / variance;
    Some(chi_square_upper_tail(statistic, found.degrees))
}

/// The score test of further regressors, from their moments alone.
pub(crate) struct ScoreTest {
    /// Reduction of the sum of squares.
    pub(crate) reduction: f64,
    /// Number of independent directions.
    pub(crate) degrees: usize,
    /// Coefficients of the further regressors.
    pub(crate) coefficients: Vec<f64>,
}

impl ScoreTest {
    /// For regressors with the second moments `own`, of which the fitted regressors leave `left` unexplained,
    /// and their products `score` with the residuals. Directions with nothing but rounding left are
    /// omitted; `None` when there are no others.
    pub(crate) fn new(left: &Mat<f64>, own: &Mat<f64>, score: &[f64]) -> Option<Self> {
        let k = score.len();
        if (0..k).any(|i| !own[(i, i)].is_finite()) {
            return None;
        }
        // A regressor that is zero throughout, such as the speed at rest, has no direction.
        let scale_of = |square: f64| {
            if square > 0.0 {
                square.sqrt().recip()
            } else {
                0.0
            }
        };
        let scale: Vec<f64> = (0..k).map(|i| scale_of(own[(i, i)])).collect();
        let scaled = Mat::from_fn(k, k, |i, j| left[(i, j)] * scale[i] * scale[j]);
        let eigen = symmetric_eigen(&scaled)?;
        let scaled_score: Vec<f64> = score.iter().zip(&scale).map(|(s, c)| s * c).collect();
        let turned = times(&eigen.vectors.transpose().to_owned(), &scaled_score);
        // A direction with less than a millionth of new information carries rounding only.
        let kept: Vec<usize> = (0..k).filter(|&i| eigen.values[i] > 1e-6).collect();
        let coefficients = (0..k)
            .map(|j| {
                let along = |&i: &usize| eigen.vectors[(j, i)] * turned[i] / eigen.values[i];
                scale[j] * kept.iter().map(along).sum::<f64>()
            })
            .collect();
        (!kept.is_empty()).then(|| Self {
            reduction: kept
                .iter()
                .map(|&i| turned[i] * turned[i] / eigen.values[i])
                .sum(),
            degrees: kept.len(),
            coefficients,
        })
    }
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
