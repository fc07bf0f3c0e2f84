//! An offset of each run.
//!
//! The zero of a sensor may move between two runs of one servo. Offsets of runs are no coordinates: there may be dozens. A step of
//! the descent eliminates them from the normal equations, and the derivatives by which the covariance is computed are
//! those less what the offsets make up for (R. Frisch and F. V. Waugh 1933). The common offset is their mean, each run once, as
//! [elsewhere](crate::diagnostics): the offsets of the runs begin with the mean zero, and keep it.

use super::discrepancy::{self, WINDOWS};
use crate::diagnostics::differing_means;
use crate::servo_model::descent::coordinates::Point;
use crate::servo_model::descent::error_row::Row;
use crate::servo_model::descent::fit::Problem;
use crate::servo_model::descent::initial_state::find_starts;
use crate::servo_model::descent::offsets::{OfRun, about_mean};
use crate::servo_model::descent::step::MOST;
use crate::servo_model::stretches::Stretch;
use servoid_dynamics::{Grid, simulate};

/// Rounds in which offsets of runs are found: with an offset, the start of the run moves too.
const ROUNDS: usize = 3;

/// The offsets of the runs of a record from the errors of a servo that has none, if these differ by more than parts as long as
/// the servo settles do; else none.
pub(crate) fn of_errors(problem: &Problem<'_>, point: &Point) -> Vec<f64> {
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
pub(crate) fn find(point: &mut Point, stretches: &mut [Stretch], grid: &Grid, runs: usize) {
    point.run_offsets = vec![0.0; runs];
    for _ in 0..ROUNDS {
        find_starts(stretches, point, grid);
        let mut sums = vec![(0.0, 0.0); runs];
        for stretch in stretches.iter() {
            let servo = point.servo_of(stretch, |_, value| value);
            let sum = &mut sums[stretch.run];
            simulate(&servo, grid, &stretch.start, stretch.commands(), |k, y| {
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

/// Takes from the derivatives what differences between the offsets of `runs` runs make up for. Their mean stays: the common offset has a
/// derivative of its own.
pub(crate) fn eliminate(stretches: &[Stretch], rows: &mut [Vec<Row>], runs: usize) {
    let mut sums = vec![OfRun::zero(MOST); runs];
    for (stretch, rows) in stretches.iter().zip(rows.iter()) {
        let sum = &mut sums[stretch.run];
        for row in rows.iter().filter(|row| !row.error.is_nan()) {
            sum.square += row.by_zero * row.by_zero;
            for (sum, slope) in sum.cross.iter_mut().zip(row.slope) {
                *sum += slope * row.by_zero;
            }
        }
    }
    about_mean(&mut sums);
    for (stretch, rows) in stretches.iter().zip(rows) {
        let sum = &sums[stretch.run];
        for row in rows.iter_mut().filter(|row| !row.error.is_nan()) {
            for (slope, cross) in row.slope.iter_mut().zip(&sum.cross) {
                *slope -= row.by_zero * cross / sum.square;
            }
        }
    }
}
