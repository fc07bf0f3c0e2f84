//! An offset of each run.
//!
//! The zero of a sensor may move between two runs of one servo. Offsets of runs are no coordinates: there may be dozens. A step of
//! the descent eliminates them from the normal equations, and the derivatives by which the covariance is computed are
//! those less what the offsets make up for (R. Frisch and F. V. Waugh 1933). The common offset is their mean.

use super::coordinates::Point;
use super::descent_step::MOST;
use super::discrepancy::{self, WINDOWS};
use super::error_row::Row;
use super::fit::Problem;
use super::initial_state::find_starts;
use super::stretches::Stretch;
use crate::diagnostics::differing_means;
use servoid_dynamics::{Grid, simulate};

/// Rounds in which offsets of runs are found: with an offset, the start of the run moves too.
const ROUNDS: usize = 3;

/// The offsets of the runs of a record from the errors of a servo that has none, if these differ by more than parts as long as
/// the servo settles do; else none.
pub(super) fn of_errors(problem: &Problem<'_>, point: &Point) -> Vec<f64> {
    let settling = WINDOWS * discrepancy::window(point, &problem.grid);
    let runs = problem.stretches.iter().map(|stretch| stretch.run + 1);
    let mut errors = vec![Vec::new(); runs.max().unwrap_or(0)];
    for stretch in problem.stretches {
        let own = &mut errors[stretch.run];
        problem.each_error_of(stretch, point, |_, error| own.push(error));
    }
    let used: Vec<&[f64]> = errors
        .iter()
        .map(Vec::as_slice)
        .filter(|errors| !errors.is_empty())
        .collect();
    let mut found = differing_means(&used, settling, false).into_iter();
    match found.len() {
        0 => Vec::new(),
        // A run without a stretch that can be used has no errors.
        _ => (errors.iter())
            .map(|errors| (!errors.is_empty()).then(|| found.next()).flatten())
            .map(|offset| offset.unwrap_or(0.0))
            .collect(),
    }
}

/// Finds the offsets of `runs` runs that the servo `point` has not seen: those with which the mean of the errors of each is zero.
pub(super) fn find(point: &mut Point, stretches: &mut [Stretch], grid: &Grid, runs: usize) {
    point.run_offsets = vec![0.0; runs];
    for _ in 0..ROUNDS {
        find_starts(stretches, point, grid);
        let mut sums = vec![(0.0, 0.0); runs];
        for stretch in stretches.iter() {
            let servo = point.servo_of(stretch, |_, value| value);
            let sum = &mut sums[stretch.run];
            simulate(&servo, grid, &stretch.start, &stretch.input, |k, y| {
                let error = stretch.output[k] - y;
                if !error.is_nan() {
                    *sum = (sum.0 + error, sum.1 + 1.0);
                }
            });
        }
        for (offset, (sum, count)) in point.run_offsets.iter_mut().zip(sums) {
            *offset += if count > 0.0 { sum / count } else { 0.0 };
        }
    }
    find_starts(stretches, point, grid);
}

/// Takes from the derivatives what differences between the offsets of the runs make up for. `offset` is the place of the
/// common one, whose derivative in a run is that by the run's own.
pub(super) fn eliminate(stretches: &[Stretch], rows: &mut [Vec<Row>], offset: usize) {
    let runs = stretches.iter().map(|stretch| stretch.run + 1).max();
    let mut totals = vec![[0.0; MOST]; runs.unwrap_or(0)];
    for (stretch, rows) in stretches.iter().zip(rows.iter()) {
        let total = &mut totals[stretch.run];
        for row in rows.iter().filter(|row| !row.error.is_nan()) {
            for (total, slope) in total.iter_mut().zip(row.slope) {
                *total += slope * row.slope[offset];
            }
        }
    }
    let seen: Vec<&[f64; MOST]> = totals.iter().filter(|total| total[offset] > 0.0).collect();
    // The mean weighs all runs alike, so it is left to a run in proportion to 1 / its squares.
    let parts: f64 = seen.iter().map(|total| total[offset].recip()).sum();
    let of_mean: [f64; MOST] = std::array::from_fn(|i| {
        let own = seen.iter().map(|total| total[i] / total[offset]);
        own.sum::<f64>() / parts
    });
    for (stretch, rows) in stretches.iter().zip(rows) {
        let total = &totals[stretch.run];
        for row in rows.iter_mut().filter(|row| !row.error.is_nan()) {
            let by_offset = row.slope[offset];
            for (i, slope) in row.slope.iter_mut().enumerate() {
                *slope += by_offset * (of_mean[i] - total[i]) / total[offset];
            }
        }
    }
}
