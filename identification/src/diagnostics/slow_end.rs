//! Whether the response goes on beyond N as a slow end.
//!
//! A slow end of a few percent of the response is below the noise in every single lag beyond N, but not in all of them
//! together. So the input behind a slow lag of first order is offered to the regression beside all its parameters,
//!
//! ```text
//! D(z) (y - ŷ)(k) = γ D(z) w(k) + ε(k),     w(k) = ρ w(k-1) + (1 - ρ) u(k)
//! ```
//!
//! with a time constant of 2 N. The lags up to N take their share of w, and what is left is its end. A single
//! direction has the most power, and an end of any other time constant is much the same beyond N. w depends on the
//! input alone, so the reduction of the sum of squares over σ² has the χ² distribution of a score test where the
//! response is over.

use faer::Mat;
use serde::{Deserialize, Serialize};

use crate::data::Moments;
use crate::diagnostics::filtered_rows::{filtered, only, present, with_history};
use crate::diagnostics::simulation_error::Simulated;
use crate::estimation::{GlsFit, noise_filter};
use crate::numerics::{LaggedSums, chi_square_upper_tail, dot, times};

/// Time constant, in settling times.
const TIME_CONSTANT: f64 = 2.0;

/// Whether the response goes on beyond N.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct SlowEnd {
    /// Probability of an end at least as visible if there is none.
    pub p: f64,
    /// N that it was looked for beyond \[samples\].
    pub beyond: usize,
}

/// Tests the errors of `fit` in `runs`; `None` where the input does not show slow ends.
pub(crate) fn slow_end(runs: &[Simulated<'_>], moments: &Moments, fit: &GlsFit) -> Option<SlowEnd> {
    let lags = fit.coordinates.basis.settling();
    let d = noise_filter(&fit.ar);
    let gain: f64 = d.iter().sum();
    let mut sums = LaggedSums::new(lags, 1);
    let (mut own, mut with_offset, mut score) = (0.0, 0.0, 0.0);
    for run in runs {
        let history = lags + fit.ar.len();
        let input = with_history(&run.run, history, moments.centre.0);
        let rows = run
            .run
            .complete_rows(moments.input_lags(), moments.output_lags());
        let slow = behind_lag(&input[history..], TIME_CONSTANT * lags as f64);
        let slow = only(&rows, filtered(&slow, &d));
        // What runs differ by is no end of their common response.
        let errors: Vec<f64> = run.own_errors().iter().copied().map(present).collect();
        score += dot(&slow, &only(&rows, filtered(&errors, &d)));
        own += dot(&slow, &slow);
        with_offset += gain * slow.iter().sum::<f64>();
        sums.add(
            &filtered(&input, &d)[history + 1 - lags..],
            &[slow.as_slice()],
        );
    }
    let sums = sums.sums().remove(0);
    let by_lag = Mat::from_fn(lags, 1, |a, _| sums[a]);
    let by_coordinate = fit.coordinates.compress(by_lag);
    let mut cross = by_coordinate.col_as_slice(0).to_vec();
    cross.push(with_offset);
    let left = own - dot(&cross, &times(&fit.solution.inverse, &cross));
    // A millionth of new information is rounding.
    (left > 1e-6 * own).then(|| SlowEnd {
        p: chi_square_upper_tail(score * score / left / fit.variance, 1),
        beyond: lags,
    })
}

/// The input behind a lag of first order that rested at its first value.
fn behind_lag(input: &[f64], time_constant: f64) -> Vec<f64> {
    let keep = (-time_constant.recip()).exp();
    let mut state = input.first().copied().unwrap_or(0.0);
    let next = |u: &f64| {
        state = keep * state + (1.0 - keep) * u;
        state
    };
    input.iter().map(next).collect()
}
