//! A trend of each run.
//!
//! Where the output drifts as the input does not explain, each run has a straight line of its own in the regression, about
//! the middle of the run. Estimates of the slopes are taken out of the output, fit and slopes in turns, and the covariance of the
//! response is that of the regression with a column for each run, as for [offsets](super::run_offsets).

use faer::Mat;
use statrs::distribution::{ContinuousCDF, FisherSnedecor};

use crate::data::{Moments, Run};
use crate::diagnostics::filtered_rows::{filtered, only};
use crate::diagnostics::simulation_error::Simulated;
use crate::estimation::{GlsFit, noise_filter};
use crate::numerics::{LaggedSums, cholesky, dot, inverse_of_square};
use crate::thresholds::DRIFT_SIGNIFICANCE;

/// The slope of each run \[output per sample\]; empty where there is none beyond chance.
pub(crate) type RunTrends = Vec<f64>;

/// Means of parts of so many settling times are taken as independent: noise that lasts longer is drift to any test.
const SETTLING_TIMES: usize = 2;

/// The slopes of `runs`, if they are beyond chance or `wanted`.
pub(crate) fn run_trends(runs: &[Simulated<'_>], settling: usize, wanted: bool) -> RunTrends {
    let parts: Vec<Vec<(f64, f64)>> = runs
        .iter()
        .map(|run| part_means(&run.errors, SETTLING_TIMES * settling))
        .collect();
    let (mut explained, mut left, mut count) = (0.0, 0.0, 0);
    let mut slopes = RunTrends::new();
    for parts in &parts {
        let mean = |of: fn(&(f64, f64)) -> f64| {
            parts.iter().map(of).sum::<f64>() / parts.len().max(1) as f64
        };
        let (at, level) = (mean(|p| p.0), mean(|p| p.1));
        let spread: f64 = parts.iter().map(|p| (p.0 - at).powi(2)).sum();
        let product: f64 = parts.iter().map(|p| (p.0 - at) * (p.1 - level)).sum();
        let slope = if spread > 0.0 { product / spread } else { 0.0 };
        explained += slope * product;
        let off = |p: &(f64, f64)| (p.1 - level - slope * (p.0 - at)).powi(2);
        left += parts.iter().map(off).sum::<f64>();
        count += parts.len();
        slopes.push(slope);
    }
    let degrees = (runs.len() as f64, count as f64 - 2.0 * runs.len() as f64);
    let drifts = degrees.1 >= 3.0
        && FisherSnedecor::new(degrees.0, degrees.1).is_ok_and(|f| {
            f.sf(explained / degrees.0 / (left / degrees.1)) < DRIFT_SIGNIFICANCE
        });
    match drifts || wanted {
        true => slopes,
        false => RunTrends::new(),
    }
}

/// Middles and means of stretches of `length` values, those with fewer than half of them left out.
fn part_means(values: &[f64], length: usize) -> Vec<(f64, f64)> {
    let mean = |(number, part): (usize, &[f64])| {
        let present = || part.iter().filter(|v| !v.is_nan());
        let count = present().count();
        let middle = (number * length) as f64 + part.len() as f64 / 2.0;
        (2 * count >= length).then(|| (middle, present().sum::<f64>() / count as f64))
    };
    values.chunks(length).enumerate().filter_map(mean).collect()
}

/// The trend of slope 1 of a run at sample `k`.
pub(crate) fn trend_at(run: &Run, k: usize) -> f64 {
    k as f64 - (run.len() as f64 - 1.0) / 2.0
}

/// The covariance of `fit` becomes that with a trend of each of `runs`.
pub(crate) fn allow_for_run_trends(runs: &[Run], moments: &Moments, fit: &mut GlsFit) {
    let d = noise_filter(&fit.ar);
    let gain: f64 = d.iter().sum();
    let lags = fit.coordinates.basis.settling();
    let mut columns = Vec::new();
    for run in runs {
        let centred = |k: isize| {
            let input = run.input_at(k) - moments.centre.0;
            if input.is_nan() { 0.0 } else { input }
        };
        let history = lags + fit.ar.len();
        let input: Vec<f64> = (-(history as isize)..run.len() as isize).map(centred).collect();
        let rows = run.complete_rows(moments.input_lags(), moments.output_lags());
        let trend: Vec<f64> = (0..run.len()).map(|k| trend_at(run, k)).collect();
        let trend = only(&rows, filtered(&trend, &d));
        let mut sums = LaggedSums::new(lags, 1);
        sums.add(&filtered(&input, &d)[history + 1 - lags..], &[&trend]);
        let sums = sums.sums().remove(0);
        let by_lag = Mat::from_fn(lags, 1, |a, _| sums[a]);
        let mut cross = fit.coordinates.compress(by_lag).col_as_slice(0).to_vec();
        cross.push(gain * trend.iter().sum::<f64>());
        columns.push((cross, dot(&trend, &trend)));
    }
    let size = columns.first().map_or(0, |(cross, _)| cross.len());
    let cross = Mat::from_fn(size, columns.len(), |i, r| columns[r].0[i]);
    let weighted = &fit.solution.inverse * &cross;
    let explained = cross.transpose() * &weighted;
    let left = Mat::from_fn(columns.len(), columns.len(), |i, j| {
        let own = if i == j { columns[i].1 } else { 0.0 };
        own - explained[(i, j)]
    });
    if let Some(lower) = cholesky(&left) {
        let more = &weighted * inverse_of_square(&lower) * weighted.transpose();
        fit.spread_further(1.0, Some(more));
    }
}
