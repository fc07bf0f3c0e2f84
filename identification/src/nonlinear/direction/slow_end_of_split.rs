//! The slow end that a direction-split model allows for: the same as for the plain one, beside the lags of both its inputs.

use faer::ColRef;

use super::split_fit::SplitFit;
use super::two_inputs::{TwoInputFit, TwoInputMoments};
use crate::data::{Quantisation, Record, Run};
use crate::diagnostics::{Regression, RegressionRun, SlowColumns, end_is_unseen};
use crate::estimation::{Coordinates, FsfBasis};
use crate::numerics::times;

/// The covariance of `split`, whose parameters are those of `fit`, grows by a slow end. Returns whether the input shows any.
pub(super) fn allow_for_slow_end(
    record: &Record,
    moments: &TwoInputMoments,
    (first, second): (&Coordinates, &FsfBasis),
    fit: &TwoInputFit,
    split: &mut SplitFit,
) -> bool {
    let lags = first.basis.settling();
    let rmse = (fit.error / moments.rows as f64).sqrt();
    let level_error = Quantisation::of(record, rmse).map_or(0.0, |found| found.level_error());
    let inverse = faer::Scale(fit.variance.recip()) * &fit.covariance;
    let regression = Regression {
        lags,
        row_lags: moments.row_lags(),
        centre: moments.centre.0,
        ar: &fit.ar,
        variance: fit.variance,
        level_error,
        inverse: &inverse,
    };
    let history = lags + fit.ar.len();
    let of_changes = second.impulse_map();
    let columns = SlowColumns::beside(
        &regression,
        (record.runs().iter()).map(|run| regression_run(run, history, moments.centre, split)),
        |by_input| {
            let mut cross = by_input[0].clone();
            cross.extend(times(&of_changes.transpose().to_owned(), &by_input[1]));
            cross
        },
    );
    if let Some(columns) = &columns {
        let moved = columns.allowance(1.0);
        let moved = ColRef::from_slice(&moved);
        split.covariance += faer::Scale(fit.variance) * (moved * moved.transpose());
    }
    !end_is_unseen(columns.as_ref(), split.gain())
}

fn regression_run<'a>(
    run: &'a Run<'a>,
    history: usize,
    centre: (f64, f64, f64),
    split: &SplitFit,
) -> RegressionRun<'a> {
    let present = |value: f64| if value.is_nan() { 0.0 } else { value };
    let times = || -(history as isize)..run.len() as isize;
    let change = |k: isize| (run.input_at(k) - run.input_at(k - 1)).abs();
    let simulated = split.simulate(run);
    let errors = run.output().iter().zip(&simulated);
    RegressionRun {
        run,
        inputs: vec![
            times()
                .map(|k| present(run.input_at(k) - centre.0))
                .collect(),
            times().map(|k| present(change(k) - centre.1)).collect(),
        ],
        errors: errors.map(|(y, s)| present(y - s)).collect(),
    }
}
