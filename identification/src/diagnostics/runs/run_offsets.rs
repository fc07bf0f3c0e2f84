//! An offset of each run.
//!
//! Where runs of one servo rest at different positions, each run has an offset of its own in the regression. Their
//! estimates are taken out of the output, and the covariance of the response is that of the regression with a column for each
//! run,
//!
//! ```text
//! (A - C B^-1 C')^-1 = A^-1 + A^-1 C (B - C'A^-1 C)^-1 C'A^-1
//! ```
//!
//! with C the cross moments of the rows with the columns of all runs but the last, and B those columns' own. Where runs move about levels of their own, a
//! gain stands for some of their offsets, and the mean errors that it leaves are not all of them: beside the fit, whose errors are ε, the offsets are
//!
//! ```text
//! (B - C'A^-1 C)^-1 W'ε
//! ```
//!
//! with the columns W.

use faer::Mat;
use statrs::distribution::{ContinuousCDF, FisherSnedecor};

use super::common_offset::common_offset;
use crate::data::{Moments, Run};
use crate::diagnostics::residuals::filtered_rows::{filtered, only, present};
use crate::diagnostics::residuals::further_columns::FurtherColumns;
use crate::diagnostics::residuals::part_means::part_means;
use crate::diagnostics::residuals::simulation_error::Simulated;
use crate::estimation::{GlsFit, noise_filter};
use crate::numerics::{cholesky, inverse_of_square, times};
use crate::thresholds::RESIDUAL_SIGNIFICANCE;

/// What the offset of each run is above the [common one](common_offset) \[output\]; empty where runs do not differ beyond chance.
pub(crate) type RunOffsets = Vec<f64>;

/// A fit, beside which offsets are found together with its response.
pub(crate) struct Beside<'a> {
    /// Its errors to its own record.
    pub(crate) left: &'a [Simulated<'a>],
    /// The offsets that were taken out of that.
    pub(crate) taken_out: &'a [f64],
    pub(crate) moments: &'a Moments,
    pub(crate) fit: &'a GlsFit,
}

/// The offsets of `runs`, if they differ by more than parts of `settling` samples of one run do, or they are `wanted`. The errors of `runs` have all of them. Without one `beside` which they are found,
/// they are the means of these.
pub(crate) fn run_offsets(
    runs: &[Simulated<'_>],
    beside: Option<Beside<'_>>,
    settling: usize,
    wanted: bool,
) -> RunOffsets {
    let errors: Vec<&[f64]> = runs.iter().map(|run| run.errors.as_slice()).collect();
    let offsets = |means: &[f64]| {
        let joint = |beside: &Beside<'_>| {
            let more = offsets_left(beside)?.into_iter().enumerate();
            let before = |run: usize| beside.taken_out.get(run).copied().unwrap_or(0.0);
            Some(more.map(|(run, more)| before(run) + more).collect())
        };
        beside
            .as_ref()
            .and_then(joint)
            .unwrap_or_else(|| means.to_vec())
    };
    differing_offsets(&errors, settling, wanted, offsets)
}

/// What each run has more than the last one, by the errors that a fit leaves, for a regression with an offset of each. `None` where the response leaves nothing of them.
fn offsets_left(
    &Beside {
        left, moments, fit, ..
    }: &Beside<'_>,
) -> Option<Vec<f64>> {
    let (_, others) = left.split_last()?;
    let of_runs: Vec<Run> = others.iter().map(|run| run.run.clone()).collect();
    let beside = BesideFit::of(&of_runs, moments, fit)?;
    let d = noise_filter(&fit.ar);
    let gain: f64 = d.iter().sum();
    let score = |run: &Simulated<'_>| {
        let errors: Vec<f64> = run.errors.iter().copied().map(present).collect();
        let rows = (run.run).complete_rows(moments.input_lags(), moments.output_lags());
        gain * only(&rows, filtered(&errors, &d)).iter().sum::<f64>()
    };
    let scores: Vec<f64> = others.iter().map(score).collect();
    let mut more = times(&beside.inverse, &scores);
    more.push(0.0);
    Some(more)
}

/// What the mean of each of `runs` is above that of all, each run once, if they differ by more than parts of `settling` values of one run
/// do, or they are `wanted`; else none.
pub(crate) fn differing_means(runs: &[&[f64]], settling: usize, wanted: bool) -> Vec<f64> {
    differing_offsets(runs, settling, wanted, <[f64]>::to_vec)
}

/// The same of the `offsets` that follow from these means.
fn differing_offsets(
    runs: &[&[f64]],
    settling: usize,
    wanted: bool,
    offsets: impl Fn(&[f64]) -> Vec<f64>,
) -> Vec<f64> {
    let parts: Vec<Vec<f64>> = runs
        .iter()
        .map(|run| part_means(run, settling))
        .map(|parts| parts.into_iter().map(|(_, mean)| mean).collect())
        .collect();
    if runs.len() < 2 || parts.iter().any(Vec::is_empty) {
        return Vec::new();
    }
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    let means: Vec<f64> = parts.iter().map(|parts| mean(parts)).collect();
    let count: usize = parts.iter().map(Vec::len).sum();
    let of_parts = mean(&parts.concat());
    let offsets = offsets(&means);
    // What columns of the offsets explain: the products of their estimates with the means.
    let between: f64 = (parts.iter().zip(&means).zip(&offsets))
        .map(|((parts, mean), offset)| parts.len() as f64 * (mean - of_parts) * offset)
        .sum();
    let within: f64 = (parts.iter().zip(&means))
        .flat_map(|(parts, mean)| parts.iter().map(move |part| (part - mean).powi(2)))
        .sum();
    let degrees = ((runs.len() - 1) as f64, (count - runs.len()) as f64);
    // Without errors there is no ratio of their sums.
    let differ = within > 0.0
        && FisherSnedecor::new(degrees.0, degrees.1).is_ok_and(|f| {
            f.sf(between / degrees.0 / (within / degrees.1)) < RESIDUAL_SIGNIFICANCE
        });
    match common_offset(&offsets).filter(|_| differ || wanted) {
        Some(common) => offsets.iter().map(|offset| offset - common).collect(),
        None => Vec::new(),
    }
}

/// The covariance of `fit` becomes that with an offset of each of `runs`.
pub(crate) fn allow_for_run_offsets(runs: &[Run], moments: &Moments, fit: &mut GlsFit) {
    let beside = BesideFit::of(&runs[..runs.len() - 1], moments, fit);
    if let Some(BesideFit { weighted, inverse }) = beside {
        let more = &weighted * inverse * weighted.transpose();
        fit.spread_further(1.0, Some(more));
    }
}

/// The offsets of all runs but the last beside a fit.
struct BesideFit {
    /// A^-1 C.
    weighted: Mat<f64>,
    /// (B - C'A^-1 C)^-1.
    inverse: Mat<f64>,
}

impl BesideFit {
    /// `None` where the response leaves nothing of them.
    fn of(runs: &[Run], moments: &Moments, fit: &GlsFit) -> Option<Self> {
        let Columns { cross, own } = Columns::of(runs, moments, fit);
        let weighted = &fit.solution.inverse * &cross;
        let explained = cross.transpose() * &weighted;
        let left = Mat::from_fn(own.len(), own.len(), |i, j| {
            let own = if i == j { own[i] } else { 0.0 };
            own - explained[(i, j)]
        });
        Some(Self {
            weighted,
            inverse: inverse_of_square(&cholesky(&left)?),
        })
    }
}

/// The columns of the offsets beside the regression, behind the noise filter: D(1) in each row of a run.
struct Columns {
    /// C.
    cross: Mat<f64>,
    /// The diagonal of B, which has nothing else.
    own: Vec<f64>,
}

impl Columns {
    /// A column for each of `runs`. It is the same number in each row, so no products need be summed.
    fn of(runs: &[Run], moments: &Moments, fit: &GlsFit) -> Self {
        let d = noise_filter(&fit.ar);
        let gain: f64 = d.iter().sum();
        let lags = fit.coordinates.basis.settling() + fit.ar.len();
        let mut columns = FurtherColumns::new(fit, runs.len());
        let mut own = Vec::new();
        for (place, run) in runs.iter().enumerate() {
            let (totals, rows) = lagged_totals(run, moments, lags);
            let behind = |totals: &[f64]| d.iter().zip(totals).map(|(d, sum)| gain * d * sum).sum();
            let by_lag: Vec<f64> = totals.windows(d.len()).map(behind).collect();
            columns.add_sums(place, &by_lag, gain * gain * rows);
            own.push(gain * gain * rows);
        }
        Self {
            cross: columns.cross_moments(),
            own,
        }
    }
}

/// sum u(k-a) over the rows of a run, a = 0..lags, relative to the centre; and the number of rows.
fn lagged_totals(run: &Run, moments: &Moments, lags: usize) -> (Vec<f64>, f64) {
    let mut totals = vec![0.0; lags];
    let mut count = 0.0;
    let at = |k: isize| run.input_at(k) - moments.centre.0;
    for rows in run.complete_rows(moments.input_lags(), moments.output_lags()) {
        count += rows.len() as f64;
        let (start, end) = (rows.start as isize, rows.end as isize);
        let mut total: f64 = (start..end).map(at).sum();
        for (a, sum) in totals.iter_mut().enumerate() {
            *sum += total;
            let a = a as isize + 1;
            if a < lags as isize {
                total += at(start - a) - at(end - a);
            }
        }
    }
    (totals, count)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnostics::residuals::further_columns::row_by_row::{
        fitted, require_close, summed,
    };

    #[test]
    fn the_columns_of_offsets_are_those_that_rows_make() {
        let (record, moments, fit) = fitted();
        let gain: f64 = noise_filter(&fit.ar).iter().sum();
        let found = Columns::of(record.runs(), &moments, &fit);
        let column =
            |of_run: usize| move |run: usize, _: usize| f64::from(u8::from(run == of_run)) * gain;
        for (run, own) in found.own.iter().enumerate() {
            let slow = summed(&record, &moments, &fit, column(run));
            require_close(found.cross.col_as_slice(run), &slow.cross);
            require_close(&[*own], &[slow.own]);
        }
    }
}
