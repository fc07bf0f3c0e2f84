//! Whether the errors hold what the equation does not have, by [score tests](crate::servo_model::uncertainty::score_test).
//!
//! Whatever is missing, such as another filter or a load of another shape, leaves errors at certain times after the command
//! changes: sums of these changes over a few stretches of time, as they are, by size and by size squared.

use super::covariance::Uncertainty;
use super::discrepancy::WINDOWS;
use super::score_test::score_test;
use crate::servo_model::descent::coordinates::Point;
use crate::servo_model::stretches::Stretch;

/// Columns: each stretch of time with the change, its size, and its square with the sign.
const OF_COMMAND: usize = 3 * WINDOWS;

/// Whether the errors follow the command beyond chance.
pub(super) fn follows_command(stretches: &[Stretch], point: &Point, found: &Uncertainty) -> bool {
    let columns: Vec<Vec<[f64; OF_COMMAND]>> = stretches
        .iter()
        .map(|stretch| sums(&stretch.input, found.window))
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
    score_test(&found.rows, point.values.len(), columns, noise)
        .is_some_and(|score| score.is_beyond_chance())
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
