//! The last descent: the parameters of chosen terms.

use super::coordinates::Point;
use super::fit::Problem;
use super::initial_state::find_starts;
use crate::servo_model::search_progress::Watch;
use crate::servo_model::stretches::Stretch;
use servoid_dynamics::Grid;

/// Steps of it.
pub(crate) const STEPS: usize = 30;

/// How the parameters of given terms are fitted.
#[derive(Clone, Copy)]
pub(crate) struct Descent<'w> {
    /// Of the integration.
    pub(crate) grid: Grid,
    /// Errors beyond this are clipped \[units of the output\].
    pub(crate) clip: f64,
    /// \[s\].
    pub(crate) longest_delay_s: f64,
    /// A relative gain below this ends a descent.
    pub(crate) converged: f64,
    pub(crate) watch: &'w dyn Watch,
}

impl<'w> Descent<'w> {
    pub(crate) fn problem<'a>(&self, stretches: &'a [Stretch]) -> Problem<'a>
    where
        'w: 'a,
    {
        Problem {
            stretches,
            grid: self.grid,
            used: &|_| true,
            clip: self.clip,
            longest_delay_s: self.longest_delay_s,
            converged: self.converged,
            watch: self.watch,
        }
    }

    /// The minimum, with the starts of the stretches found anew.
    pub(crate) fn polished(&self, parts: &mut [Stretch], mut point: Point) -> Point {
        for _ in 0..2 {
            find_starts(parts, &point, &self.grid);
            self.problem(parts).descend(&mut point, STEPS);
        }
        if point.terms.friction || point.terms.dead_band || point.terms.play {
            self.problem(parts).descend_around(&mut point, STEPS);
        }
        point
    }
}
