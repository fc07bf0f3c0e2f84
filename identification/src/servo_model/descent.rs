//! The last descent: the parameters of chosen terms.

use super::coordinates::Point;
use super::fit::Problem;
use super::initial_state::find_starts;
use super::search_progress::Watch;
use super::stretches::Stretch;
use servoid_dynamics::Grid;

/// Steps of it.
pub(super) const STEPS: usize = 30;

/// How the parameters of given terms are fitted.
#[derive(Clone, Copy)]
pub(super) struct Descent<'w> {
    /// Of the integration.
    pub(super) grid: Grid,
    /// Errors beyond this are clipped \[units of the output\].
    pub(super) clip: f64,
    /// \[s\].
    pub(super) longest_delay_s: f64,
    /// A relative gain below this ends a descent.
    pub(super) converged: f64,
    pub(super) watch: &'w dyn Watch,
}

impl<'w> Descent<'w> {
    pub(super) fn problem<'a>(&self, stretches: &'a [Stretch]) -> Problem<'a>
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
    pub(super) fn polished(&self, parts: &mut [Stretch], mut point: Point) -> Point {
        for _ in 0..2 {
            find_starts(parts, &point, &self.grid);
            self.problem(parts).descend(&mut point, STEPS);
        }
        if point.terms.friction || point.terms.dead_band {
            self.problem(parts).descend_around(&mut point, STEPS);
        }
        point
    }
}
