//! Commands that are not in their column as the servo got them.
//!
//! A column of commands that were [rounded](crate::diagnostics::commands::rounded_commands), or measured [with noise](crate::diagnostics::commands::noisy_commands), differs from what the servo got by e. The
//! regressors are the column's, so that
//!
//! ```text
//! E θ̂ - θ = -b,     b = A^-1 S θ = (A - S)^-1 S E θ̂,     S_ij = sum_k E D e(k-i) D e(k-j),
//! ```
//!
//! as by any errors in variables (W. A. Fuller, *Measurement Error Models*, 1987). In no record such a column looks different from one of commands that
//! are on a grid, or were sent with their noise, where the error is none. So b is no correction: it is one standard deviation of the estimate, along itself.
//! Runs whose commands are [stated to be exact](Run::with_exact_input) have no such error.
//!
//! Under a smooth command, rounding may be most of what excites the high frequencies, and so may be noise under any. There the estimate is next to 0 whatever
//! the servo does, and no number of it says by how much it is off.

use faer::Mat;

use super::command_errors::{CommandErrors, ErrorMoments};
use super::noisy_commands::noisy_holds;
use super::rounded_commands::step_of_commands;
use crate::data::{Record, Run};
use crate::estimation::GlsFit;
use crate::numerics::{dot, times};
use crate::thresholds::{NOISY_EXCITATION, ROUNDED_EXCITATION};

/// Of the sum that b is. Where errors are nine tenths of A, the whole sum is three times these, and bounds of 99 % have 2.6 to 4 of them; where they are
/// more, further ones would be noise.
const TERMS: usize = 4;

/// What may be wrong with commands.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Inexact {
    /// Rounding to steps of so much \[input\].
    Rounded(f64),
    /// Noise of this standard deviation \[input\].
    Noisy(f64),
}

impl Inexact {
    /// The share that these errors may have in what excites the part of the response that they change.
    fn largest_share(self) -> f64 {
        match self {
            Self::Rounded(_) => ROUNDED_EXCITATION,
            Self::Noisy(_) => NOISY_EXCITATION,
        }
    }
}

/// What that may have done to a response.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct InexactCommands {
    pub(crate) errors: Inexact,
    /// By how many standard deviations of the estimate it is off at the most, whichever part of it is looked at. `None` where errors are nearly all that
    /// excites the part that they change: nothing then says how far that is off.
    pub(crate) shift: Option<f64>,
}

/// Adds to the covariance of `fit`, which is of `record`, what errors of the commands may have made of the response.
pub(crate) fn allow_for_inexact_commands(
    record: &Record,
    fit: &mut GlsFit,
) -> Option<InexactCommands> {
    let (errors, sums) = errors_of_commands(record)?;
    let moments = ErrorMoments::of(&sums, fit);
    if fit.precision > 0.0 {
        fit.spread_further(1.0, Some(under_prior(&moments, fit)));
        return Some(InexactCommands {
            errors,
            shift: Some(0.0),
        });
    }
    let Some(bias) = bias(&moments, fit, errors.largest_share()) else {
        return Some(InexactCommands {
            errors,
            shift: None,
        });
    };
    let covariance = Mat::from_fn(bias.len(), bias.len(), |i, j| {
        bias[i] * bias[j] / fit.variance
    });
    let shift = shift(&bias, &moments, fit);
    fit.spread_further(1.0, Some(covariance));
    Some(InexactCommands {
        errors,
        shift: Some(shift),
    })
}

fn errors_of_commands(record: &Record) -> Option<(Inexact, CommandErrors)> {
    let runs = measured_runs(record);
    let rounding = step_of_commands(&runs).map(|step| {
        let errors = CommandErrors::of_rounding(&runs, step);
        (Inexact::Rounded(step), errors)
    });
    let Some(held) = noisy_holds(&runs) else {
        return rounding;
    };
    let noise = CommandErrors::of_noise(&held, runs.iter().map(|run| run.len()).sum());
    let kind = Inexact::Noisy(noise.sd());
    Some(match rounding {
        Some((_, rounding)) => (kind, noise.with(&rounding)),
        None => (kind, noise),
    })
}

/// Standard deviation of the noise within the holds of the command \[input\]; `None` where it has none, or is not held.
pub(crate) fn noise_of_commands(record: &Record) -> Option<f64> {
    let runs = measured_runs(record);
    let held = noisy_holds(&runs)?;
    Some(CommandErrors::of_noise(&held, 1).sd())
}

/// Those whose commands are not stated to be exact.
fn measured_runs<'r>(record: &'r Record) -> Vec<&'r Run<'r>> {
    let runs = record.runs().iter();
    runs.filter(|run| !run.has_exact_input()).collect()
}

/// b in the coordinates of `fit`, and 0 for the offset, since these errors move no mean: the first of the terms (A^-1 S)^k θ̂, k from 1, of its sum. `None`
/// where errors are more than `largest_share` of A along the first of them.
fn bias(moments: &ErrorMoments, fit: &GlsFit, largest_share: f64) -> Option<Vec<f64>> {
    let next = |score: &[f64]| {
        let mut moved = times(&fit.solution.inverse, &[score, &[0.0]].concat());
        moved.pop();
        moved
    };
    let first = next(&moments.times(fit.solution.response(), fit));
    let score = moments.times(&first, fit);
    let mut term = next(&score);
    // Cut at some lag, S may have small negative eigenvalues.
    if dot(&score, &term) > largest_share * dot(&score, &first).abs() {
        return None;
    }
    let mut sum = first;
    for _ in 1..TERMS {
        for (sum, term) in sum.iter_mut().zip(&term) {
            *sum += term;
        }
        term = next(&moments.times(&term, fit));
    }
    sum.push(0.0);
    Some(sum)
}

/// The covariance of b over the variance of ε, where θ has a prior with precision λ: A^-1 S S A^-1 / λ. What only errors of the commands excite is as
/// uncertain as it was before the record.
fn under_prior(moments: &ErrorMoments, fit: &GlsFit) -> Mat<f64> {
    let lags = fit.coordinates.len();
    let mut errors = Mat::<f64>::zeros(lags, lags);
    let mut unit = vec![0.0; lags];
    for lag in 0..lags {
        unit[lag] = 1.0;
        errors
            .col_as_slice_mut(lag)
            .copy_from_slice(&moments.times(&unit, fit));
        unit[lag] = 0.0;
    }
    let inverse = fit.solution.inverse.as_ref().subcols(0, lags);
    let shift = inverse * errors;
    faer::Scale(fit.precision.recip()) * (&shift * shift.transpose())
}

/// The largest of b along a direction over the standard deviation of noise there: √(b'A b), and A b = S (θ̂ + b).
fn shift(bias: &[f64], moments: &ErrorMoments, fit: &GlsFit) -> f64 {
    let response = fit.solution.response();
    let corrected: Vec<f64> = response.iter().zip(bias).map(|(a, b)| a + b).collect();
    let square = dot(&moments.times(&corrected, fit), &bias[..response.len()]);
    (square / fit.variance).max(0.0).sqrt()
}
