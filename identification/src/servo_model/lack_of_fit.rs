//! Whether the errors hold what the equation does not have: score tests.
//!
//! Columns that such a thing would leave are added to the regression of the errors on the derivatives of the fit, all
//! whitened by the noise at rest. If the equation is right, the reduction of the sum of squares over σ² follows χ² with
//! as many degrees of freedom as there are columns (C. R. Rao 1948).
//!
//! Whatever is missing, such as another filter or a load of another shape, leaves errors at certain times after the command
//! changes: sums of these changes over a few stretches of time, as they are, by size and by size squared. Play in the gears leaves
//! errors that change their sign where the motion turns round; one width stands for all, since small play has one shape.

use super::coordinates::Point;
use super::discrepancy::WINDOWS;
use super::noise_at_rest::NoiseAtRest;
use super::stretches::Stretch;
use super::uncertainty::Uncertainty;
use crate::numerics::{chi_square_upper_tail, cholesky, forward_solve};
use crate::thresholds::SERVO_LACK_OF_FIT;
use faer::Mat;

/// Columns: each stretch of time with the change, its size, and its square with the sign.
const OF_COMMAND: usize = 3 * WINDOWS;

/// Width of the play, from one end to the other, as a share of the range of the motion.
const PLAY: f64 = 0.01;

/// Whether the errors follow the command beyond chance.
pub(super) fn follows_command(stretches: &[Stretch], point: &Point, found: &Uncertainty) -> bool {
    let columns: Vec<Vec<[f64; OF_COMMAND]>> = stretches
        .iter()
        .map(|stretch| sums(&stretch.input, found.window))
        .collect();
    beyond_chance(point, found, &columns)
}

/// Whether the errors are those of play in the gears, beyond chance.
pub(super) fn has_play(point: &Point, found: &Uncertainty) -> bool {
    let outputs = || found.motion.simulated.iter().flatten().copied();
    let range = outputs().fold(f64::MIN, f64::max) - outputs().fold(f64::MAX, f64::min);
    let columns: Vec<Vec<[f64; 1]>> = found
        .motion
        .simulated
        .iter()
        .map(|output| play(output, PLAY * range))
        .collect();
    beyond_chance(point, found, &columns)
}

/// Whether `columns`, by stretch and sample, explain more of the errors than chance does.
fn beyond_chance<const N: usize>(
    point: &Point,
    found: &Uncertainty,
    columns: &[Vec<[f64; N]>],
) -> bool {
    let Some(noise) = &found.at_rest else {
        return false;
    };
    let count = point.values.len();
    let (normal, products) = whitened_products(found, noise, columns, count);
    reduction(&normal, &products, count).is_some_and(|reduction| {
        chi_square_upper_tail(reduction / (noise.sigma * noise.sigma), N) < SERVO_LACK_OF_FIT
    })
}

/// Products of the whitened columns, those of the derivatives first, with each other and with the errors.
fn whitened_products<const N: usize>(
    found: &Uncertainty,
    noise: &NoiseAtRest,
    columns: &[Vec<[f64; N]>],
    count: usize,
) -> (Mat<f64>, Vec<f64>) {
    let (d, all) = (&noise.filter, count + N);
    let mut normal = Mat::<f64>::zeros(all, all);
    let mut products = vec![0.0; all];
    for (rows, columns) in found.rows.iter().zip(columns) {
        let column = |k: usize, i: usize| match i.checked_sub(count) {
            None => rows[k].slope[i],
            Some(added) => columns[k][added],
        };
        for k in d.len() - 1..rows.len() {
            let white = |of: &dyn Fn(usize) -> f64| -> f64 {
                d.iter().enumerate().map(|(lag, d)| d * of(k - lag)).sum()
            };
            let error = white(&|k| rows[k].error);
            if error.is_nan() {
                continue;
            }
            let row: Vec<f64> = (0..all).map(|i| white(&|k| column(k, i))).collect();
            for i in 0..all {
                products[i] += row[i] * error;
                for j in 0..=i {
                    normal[(i, j)] += row[i] * row[j];
                }
            }
        }
    }
    (normal, products)
}

/// For each sample the sums of earlier changes of the command, over windows of `window` samples.
fn sums(input: &[f64], window: usize) -> Vec<[f64; OF_COMMAND]> {
    let mut sums = vec![[0.0; OF_COMMAND]; input.len()];
    for (k, pair) in input.windows(2).enumerate() {
        let change = pair[1] - pair[0];
        if change == 0.0 {
            continue;
        }
        let last = input.len().min(k + 1 + WINDOWS * window);
        for (lag, sums) in sums[k + 1..last].iter_mut().enumerate() {
            let first = 3 * (lag / window);
            sums[first] += change;
            sums[first + 1] += change.abs();
            sums[first + 2] += change * change.abs();
        }
    }
    sums
}

/// For each sample how far play of a width lets the measured output lag behind, from the middle of the play on. Where no output was
/// measured, it stands still.
fn play(output: &[f64], width: f64) -> Vec<[f64; 1]> {
    let first = output.iter().find(|y| !y.is_nan());
    let mut behind = first.copied().unwrap_or(0.0);
    let lag = |y: &f64| {
        if y.is_nan() {
            return [0.0];
        }
        behind = behind.clamp(y - 0.5 * width, y + 0.5 * width);
        [behind - y]
    };
    output.iter().map(lag).collect()
}

/// What the columns after the first `count` take from the sum of squares beyond what these take. Columns are scaled to one
/// first; those that are not seen get a small pivot and take nothing.
fn reduction(normal: &Mat<f64>, products: &[f64], count: usize) -> Option<f64> {
    let size = normal.nrows();
    let scale = |i: usize| match normal[(i, i)].sqrt() {
        0.0 => 1.0,
        scale => scale,
    };
    let correlation = Mat::from_fn(size, size, |i, j| {
        let (low, high) = (i.min(j), i.max(j));
        let entry = normal[(high, low)] / (scale(low) * scale(high));
        if i == j { entry + PIVOT } else { entry }
    });
    let scaled: Vec<f64> = (0..size).map(|i| products[i] / scale(i)).collect();
    let lower = cholesky(&correlation)?;
    let own = forward_solve(&lower, &scaled);
    Some(own[count..].iter().map(|z| z * z).sum())
}

/// Added to each pivot, so that combinations of other columns take next to nothing.
const PIVOT: f64 = 1e-9;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn play_lags_behind_by_half_its_width_after_a_turn() {
        let there_and_back = [0.0, 1.0, 2.0, 1.9, 1.0, f64::NAN, 0.0];
        let lag: Vec<f64> = play(&there_and_back, 0.4)
            .iter()
            .map(|[lag]| *lag)
            .collect();
        let exact = [0.0, -0.2, -0.2, -0.1, 0.2, 0.0, 0.2];
        for (lag, exact) in lag.iter().zip(exact) {
            assert!((lag - exact).abs() < 1e-12, "{lag} {exact}");
        }
    }
}
