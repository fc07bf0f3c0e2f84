//! A step of the descent: sums over the derivatives of the outputs and the errors, and the normal equations that they make.
//!
//! They are gathered by the parameters of the equation, which all servos have in one order, and turned to the coordinates of the
//! search once a stretch.

use super::coordinates::Point;
use super::offsets::{OfRun, about_mean};
use crate::numerics::{backward_solve, cholesky, forward_solve};
use faer::Mat;
use servoid_dynamics::{Dual, PARAMETERS, Slopes};

/// Coordinates that a servo has at the most, those of further controllers among them.
pub(crate) const MOST: usize = 28;

/// Sums at one point of the search.
pub(super) struct Sums {
    /// Sum of the clipped squares of the errors.
    pub(super) cost: f64,
    /// J'WJ.
    pub(super) normal: Mat<f64>,
    /// J'We.
    pub(super) gradient: Vec<f64>,
    /// Those of the offsets of the runs, where runs have one each.
    pub(super) runs: Vec<OfRun>,
}

impl Sums {
    /// None, for `count` coordinates and the offsets of `runs` runs.
    pub(super) fn zero(count: usize, runs: usize) -> Self {
        Self {
            cost: 0.0,
            normal: Mat::zeros(count, count),
            gradient: vec![0.0; count],
            runs: vec![OfRun::zero(count); runs],
        }
    }

    /// Leaves the sums for offsets of the runs that are always at their best, about a mean that stays.
    pub(super) fn eliminate_runs(&mut self) {
        about_mean(&mut self.runs);
        for run in self.runs.iter().filter(|run| run.square > 0.0) {
            for (i, cross) in run.cross.iter().enumerate() {
                let share = cross / run.square;
                self.gradient[i] -= share * run.gradient;
                for (j, other) in run.cross.iter().enumerate() {
                    self.normal[(i, j)] -= share * other;
                }
            }
        }
    }

    /// The cost, infinite where the simulation failed.
    pub(super) fn finite_cost(&self) -> f64 {
        if self.cost.is_nan() {
            f64::INFINITY
        } else {
            self.cost
        }
    }
}

/// Derivatives of the parameters of the servo with a controller by the coordinates of `point`.
pub(super) fn by_coordinates(point: &Point, controller: usize) -> [[f64; MOST]; PARAMETERS] {
    let physics = point.physics(controller, |i, value| Dual::<MOST>::variable(value, i));
    physics.in_order().map(|parameter| parameter.slope)
}

/// [`Sums`] over a stretch, by the parameters of the servo.
#[derive(Default)]
pub(super) struct Products {
    /// J'WJ, of which the upper triangle counts.
    normal: [Slopes; PARAMETERS],
    /// J'We.
    gradient: Slopes,
}

impl Products {
    #[inline(always)]
    pub(super) fn add(&mut self, weight: f64, error: f64, slopes: &Slopes) {
        for i in 0..PARAMETERS {
            let weighted = weight * slopes[i];
            self.gradient[i] += weighted * error;
            // From a whole group of four on: the processor adds these together.
            let from = i / 4 * 4;
            for (sum, slope) in self.normal[i][from..].iter_mut().zip(&slopes[from..]) {
                *sum += weighted * slope;
            }
        }
    }

    /// Adds them by coordinates, of which `chain` has the derivatives of the parameters.
    pub(super) fn add_to(&self, sums: &mut Sums, chain: &[[f64; MOST]; PARAMETERS]) {
        let count = sums.gradient.len();
        for (p, by_p) in chain.iter().enumerate() {
            let mut row = [0.0; MOST];
            for (q, by_q) in chain.iter().enumerate() {
                let product = self.normal[p.min(q)][p.max(q)];
                for (sum, change) in row.iter_mut().zip(by_q) {
                    *sum += product * change;
                }
            }
            for (i, change) in by_p.iter().enumerate().take(count) {
                sums.gradient[i] += change * self.gradient[p];
                for (j, product) in row.iter().enumerate().take(count) {
                    sums.normal[(i, j)] += change * product;
                }
            }
        }
    }
}

/// Sums over a stretch of products with the derivative by the zero of the sensor, by the parameters of the servo.
#[derive(Default)]
pub(super) struct ProductsOfZero {
    square: f64,
    gradient: f64,
    cross: Slopes,
}

impl ProductsOfZero {
    /// A sample, with `weighted` the weight times the derivative by the zero.
    #[inline(always)]
    pub(super) fn add(&mut self, weighted: f64, by_zero: f64, error: f64, slopes: &Slopes) {
        self.square += weighted * by_zero;
        self.gradient += weighted * error;
        for (sum, slope) in self.cross.iter_mut().zip(slopes) {
            *sum += weighted * slope;
        }
    }

    /// Adds them by coordinates, of which `chain` has the derivatives of the parameters.
    pub(super) fn add_to(&self, run: &mut OfRun, chain: &[[f64; MOST]; PARAMETERS]) {
        run.square += self.square;
        run.gradient += self.gradient;
        for (product, by_parameter) in self.cross.iter().zip(chain) {
            for (sum, change) in run.cross.iter_mut().zip(by_parameter) {
                *sum += product * change;
            }
        }
    }
}

/// Solves (J'WJ + damping) step = J'We for the free coordinates.
pub(super) fn solve(sums: &Sums, free: &[usize], damping: f64) -> Option<Vec<f64>> {
    let largest = free
        .iter()
        .map(|&i| sums.normal[(i, i)])
        .fold(0.0, f64::max);
    let normal = Mat::from_fn(free.len(), free.len(), |i, j| {
        let entry = sums.normal[(free[i], free[j])];
        match i == j {
            true => entry * (1.0 + damping) + 1e-14 * largest,
            false => entry,
        }
    });
    let gradient: Vec<f64> = free.iter().map(|&i| sums.gradient[i]).collect();
    let lower = cholesky(&normal)?;
    Some(backward_solve(&lower, &forward_solve(&lower, &gradient)))
}
