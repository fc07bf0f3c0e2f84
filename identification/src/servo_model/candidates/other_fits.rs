//! Other fits to the same record, where no interval can be given.
//!
//! A single number would say more than the record does. Fits with other terms that predict as well, and fits to each fold of the
//! record alone, show how far the numbers go apart: the delay of an R/C servo was 49 ms by its odd runs, 65 ms by the even ones and
//! 27 ms by all.

use crate::servo_model::descent::coordinates::Point;
use crate::servo_model::descent::fit::Problem;
use crate::servo_model::descent::starting_values::{Shown, other_starts};
use crate::servo_model::stretches::{FOLDS, Stretch};
use rayon::prelude::*;

/// Steps of a descent to one fold.
const STEPS: usize = 12;

/// A relative gain below this ends the descent: the folds differ by much more.
const CONVERGED: f64 = 1e-3;

/// The servo of `point` fitted to each fold alone.
pub(super) fn fits_of_folds(
    problem: &Problem<'_>,
    point: &Point,
    shown: &Shown,
    fold_of: &[usize],
) -> Vec<Point> {
    let of_fold = |fold: usize| {
        let own = |stretch: &&Stretch| stretch.blocks().any(|block| fold_of[block] == fold);
        let stretches: Vec<Stretch> = problem.stretches.iter().filter(own).cloned().collect();
        if stretches.is_empty() {
            return None;
        }
        let alone = Problem {
            stretches: &stretches,
            used: &|block| fold_of[block] == fold,
            converged: CONVERGED,
            ..*problem
        };
        let (_, found) = alone.best_descent(other_starts(point, &alone, shown), STEPS);
        Some(found)
    };
    (0..FOLDS).into_par_iter().filter_map(of_fold).collect()
}
