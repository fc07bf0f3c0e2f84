//! The servos that a record may come from: the best one, those that it does not distinguish from it, and whether intervals hold.

mod friction_speed;
pub(super) mod other_fits;
pub(super) mod other_valleys;

use crate::results::{Bounds, Reason};
use crate::servo_model::descent::chosen_terms::{Descent, STEPS};
use crate::servo_model::descent::coordinates::Point;
use crate::servo_model::descent::fit::Problem;
use crate::servo_model::descent::starting_values::{Shown, other_starts};
use crate::servo_model::stretches::Stretch;
use crate::servo_model::terms::ladder::Climbed;
use crate::servo_model::uncertainty::covariance::{Uncertainty, uncertainty};
use crate::servo_model::uncertainty::possible_servo::PossibleServo;
use crate::servo_model::uncertainty::validity::against;
use crate::thresholds::{SERVO_ALTERNATIVE, SERVO_LACK_OF_FIT};
use friction_speed::{is_next_to, shows_friction_at_rest, with_its_speed};
use other_fits::fits_of_folds;
use other_valleys::{with_quick_drive, with_soft_drive, with_unequal_limits};
use rayon::prelude::*;

/// A relative gain below this ends the descent to the best servo.
const FINE: f64 = 1e-7;

/// What a record says of its servo.
pub(super) struct Candidates {
    /// The level of intervals, if they hold.
    pub(super) level: Bounds<f64>,
    /// The best servo, and those that the record does not distinguish from it.
    pub(super) possible: Vec<PossibleServo>,
    /// Those of other fits, where intervals do not hold.
    pub(super) other_fits: Vec<Point>,
    /// The uncertainty of the best one.
    pub(super) found: Uncertainty,
}

impl Candidates {
    /// Finds them in `parts`, whose starts are found anew.
    pub(super) fn of(
        parts: &mut Vec<Stretch>,
        fold_of: &[usize],
        shown: &Shown,
        climbed: &Climbed,
        descent: &Descent<'_>,
        level: Bounds<f64>,
    ) -> Self {
        let best = polished(parts, fold_of, shown, &climbed.best().fit, descent);
        let with_its_speed = with_its_speed(parts, descent, best, fold_of.len());
        let (best, found) = (with_its_speed.point, with_its_speed.found);
        let level = level.unless(against(parts, &best, &found));
        let problem = descent.problem(parts);
        let mut candidates = Self {
            level,
            possible: vec![found.servo_at(best.clone())],
            other_fits: Vec::new(),
            found,
        };
        let mut others = with_other_terms(&problem, climbed);
        if candidates.level.valid().is_some() {
            candidates.add_those_outside_of_the_terms(
                &problem,
                (&best, with_its_speed.others),
                fold_of.len(),
            );
            others.extend(candidates.soft_drive(&problem, &best, climbed, fold_of.len()));
            // With the covariance of the best: its own knows no end of how quick the drive may be.
            let quick = with_quick_drive(&problem, &best, fold_of.len());
            let quick = quick.map(|point| candidates.found.servo_at(point));
            candidates.possible.extend(quick);
        }
        let of = |point: Point| uncertainty(&problem, &point, fold_of.len()).servo_at(point);
        let others: Vec<PossibleServo> = others.into_par_iter().map(of).collect();
        let others = others.into_iter();
        candidates
            .possible
            .extend(others.filter(PossibleServo::shows_its_load));
        if candidates.level.withdrawn().is_some() {
            let members = candidates.possible[1..].iter();
            let members = members.map(|servo| servo.point.clone());
            let of_folds = fits_of_folds(&problem, &best, shown, fold_of);
            candidates.other_fits = members.chain(of_folds).collect();
        }
        candidates
    }

    /// Servos that the ladder does not try: possible ones where they fit as well, and the end of the level where they fit better.
    fn add_those_outside_of_the_terms(
        &mut self,
        problem: &Problem<'_>,
        (best, of_other_speeds): (&Point, Vec<Point>),
        blocks: usize,
    ) {
        let with_its_own = |point: Point| (uncertainty(problem, &point, blocks), point);
        let period_s = problem.grid.period_s;
        let of_other_speeds =
            of_other_speeds
                .into_iter()
                .map(with_its_own)
                .filter(|(other, point)| {
                    shows_friction_at_rest(problem.stretches, point, other, period_s)
                });
        let unequal = with_unequal_limits(problem, best)
            .into_iter()
            .map(with_its_own);
        for (other, point) in of_other_speeds.chain(unequal) {
            let is_better = self.found.is_beaten_by(&other, SERVO_LACK_OF_FIT);
            self.level = self
                .level
                .unless(is_better.then_some(Reason::ErrorsNotNoise));
            if is_next_to(best, &point) || !other.is_beaten_by(&self.found, SERVO_ALTERNATIVE) {
                self.possible.push(other.servo_at(point));
            }
        }
    }

    fn soft_drive(
        &self,
        problem: &Problem<'_>,
        best: &Point,
        climbed: &Climbed,
        blocks: usize,
    ) -> Option<Point> {
        let linear = &climbed.linear()?.fit;
        with_soft_drive(problem, best, linear, &self.found.motion.simulated, blocks)
    }
}

/// The best servo with the terms of `from`, in `parts`, whose starts are found anew, and its uncertainty.
pub(super) fn polished(
    parts: &mut [Stretch],
    fold_of: &[usize],
    shown: &Shown,
    from: &Point,
    descent: &Descent<'_>,
) -> (Point, Uncertainty) {
    let starts = other_starts(from, &descent.problem(parts), shown);
    let (_, from) = descent.problem(parts).best_descent(starts, STEPS);
    let fine = Descent {
        converged: FINE,
        ..*descent
    };
    let best = fine.polished(parts, from);
    let found = uncertainty(&fine.problem(parts), &best, fold_of.len());
    (best, found)
}

/// The servos with other terms that predict as well.
fn with_other_terms(problem: &Problem<'_>, climbed: &Climbed) -> Vec<Point> {
    let descended = |rung: &usize| {
        let mut point = climbed.tried[*rung].fit.clone();
        problem.descend(&mut point, STEPS);
        point
    };
    climbed.others.par_iter().map(descended).collect()
}
