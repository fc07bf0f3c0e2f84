//! Whether the errors follow the command: a score test for what the equation does not have.
//!
//! Whatever the equation lacks, such as play, another filter or a load of another shape, leaves errors at certain times after the
//! command changes. Sums of these changes over a few stretches of time, as they are, by size and by size squared, are
//! added to the regression of the errors on the derivatives of the fit, all whitened by the noise model. If the
//! equation is right, the reduction of the sum of squares over σ² follows χ² with as many degrees of freedom
//! as there are sums (C. R. Rao 1948).

use super::coordinates::Point;
use super::stretches::Stretch;
use super::uncertainty::Uncertainty;
use crate::estimation::noise_filter;
use crate::numerics::{chi_square_upper_tail, cholesky, forward_solve};
use faer::Mat;
use servoid_dynamics::Grid;

/// Stretches of time after a change.
const BINS: usize = 8;

/// Columns: each stretch of time with the change, its size, and its square with the sign.
const COLUMNS: usize = 3 * BINS;

/// Time in which a servo settles at small signals \[1/ω\].
const SETTLING: f64 = 8.0;

/// The probability of errors that follow the command as much as these, if the equation is right. `None` where the
/// sums are combinations of the derivatives.
pub(super) fn p_value(
    stretches: &[Stretch],
    grid: &Grid,
    point: &Point,
    found: &Uncertainty,
) -> Option<f64> {
    let servo = point.physics(0, |_, value| value);
    let settling_s = servo.delay_s + SETTLING / servo.stiffness.sqrt();
    let settling = (settling_s / grid.period_s).ceil() as usize;
    let (d, rows, count) = (noise_filter(&found.ar), &found.rows, point.values.len());
    let width = settling.div_ceil(BINS).max(1);
    let all = count + COLUMNS;
    let mut normal = Mat::<f64>::zeros(all, all);
    let mut products = vec![0.0; all];
    for (stretch, rows) in stretches.iter().zip(rows) {
        let sums = sums(&stretch.input, width);
        let column = |k: usize, i: usize| {
            if i < count {
                rows[k].slope[i]
            } else {
                sums[k][i - count]
            }
        };
        for k in d.len() - 1..rows.len() {
            let late = |of: &dyn Fn(usize) -> f64| -> f64 {
                d.iter().enumerate().map(|(lag, d)| d * of(k - lag)).sum()
            };
            let error = late(&|k| rows[k].error);
            if error.is_nan() {
                continue;
            }
            let row: Vec<f64> = (0..all).map(|i| late(&|k| column(k, i))).collect();
            for i in 0..all {
                products[i] += row[i] * error;
                for j in 0..=i {
                    normal[(i, j)] += row[i] * row[j];
                }
            }
        }
    }
    reduction(&normal, &products, count)
        .map(|reduction| chi_square_upper_tail(reduction / (found.sigma * found.sigma), COLUMNS))
}

/// For each sample the sums of earlier changes of the command.
fn sums(input: &[f64], width: usize) -> Vec<[f64; COLUMNS]> {
    let mut sums = vec![[0.0; COLUMNS]; input.len()];
    for (k, pair) in input.windows(2).enumerate() {
        let change = pair[1] - pair[0];
        if change == 0.0 {
            continue;
        }
        let last = input.len().min(k + 1 + BINS * width);
        for (lag, sums) in sums[k + 1..last].iter_mut().enumerate() {
            let bin = 3 * (lag / width);
            sums[bin] += change;
            sums[bin + 1] += change.abs();
            sums[bin + 2] += change * change.abs();
        }
    }
    sums
}

/// What the columns after the first `count` take from the sum of squares beyond what these take. Columns are scaled to one
/// first; those that are not seen get a small pivot and take nothing.
fn reduction(normal: &Mat<f64>, products: &[f64], count: usize) -> Option<f64> {
    let size = normal.nrows();
    let scale: Vec<f64> = (0..size).map(|i| normal[(i, i)].sqrt()).collect();
    if scale[count..].contains(&0.0) {
        return None;
    }
    let safe = |i: usize| if scale[i] > 0.0 { scale[i] } else { 1.0 };
    let correlation = Mat::from_fn(size, size, |i, j| {
        let (low, high) = (i.min(j), i.max(j));
        let entry = normal[(high, low)] / (safe(low) * safe(high));
        if i == j { entry + PIVOT } else { entry }
    });
    let scaled: Vec<f64> = (0..size).map(|i| products[i] / safe(i)).collect();
    let lower = cholesky(&correlation)?;
    let own = forward_solve(&lower, &scaled);
    Some(own[count..].iter().map(|z| z * z).sum())
}

/// Added to each pivot, so that combinations of other columns take next to nothing.
const PIVOT: f64 = 1e-9;
