//! Parameters by simulation error: Levenberg-Marquardt with derivatives from dual numbers.
//!
//! The errors are those of the whole simulation, not of one step ahead, since prediction is what the model is for.
//! An error beyond a clip counts in proportion to its size (Huber), so that a lost run does not decide.

use super::coordinates::Point;
use super::stretches::Stretch;
use super::watch::Watch;
use crate::numerics::{backward_solve, cholesky, forward_solve};
use faer::Mat;
use servoid_dynamics::{Dual, Grid, simulate};

/// What is fitted.
#[derive(Clone, Copy)]
pub(super) struct Problem<'a> {
    pub(super) stretches: &'a [Stretch],
    pub(super) grid: Grid,
    /// Blocks that count.
    pub(super) used: &'a dyn Fn(usize) -> bool,
    /// Errors beyond this are clipped \[units of the output\].
    pub(super) clip: f64,
    /// \[s\].
    pub(super) longest_delay_s: f64,
    /// A relative gain below this ends the descent.
    pub(super) converged: f64,
    /// May end every descent.
    pub(super) watch: &'a dyn Watch,
}

/// Sums at one point of the search.
pub(super) struct Sums {
    /// Sum of the clipped squares of the errors.
    pub(super) cost: f64,
    /// J'WJ.
    pub(super) normal: Mat<f64>,
    /// J'We.
    pub(super) gradient: Vec<f64>,
}

impl Sums {
    /// The cost, infinite where the simulation failed.
    fn finite_cost(&self) -> f64 {
        if self.cost.is_nan() {
            f64::INFINITY
        } else {
            self.cost
        }
    }
}

impl Problem<'_> {
    /// Sum of the clipped squares of the errors, or what is above `most` where it exceeds that: the rest does not matter then.
    fn cost_below(&self, point: &Point, most: f64) -> f64 {
        let mut cost = 0.0;
        for stretch in self.stretches {
            self.each_error_of(stretch, point, |_, error| {
                cost += clipped_square(error, self.clip)
            });
            if cost.is_nan() || cost > most {
                return f64::INFINITY;
            }
        }
        cost
    }

    /// Hands block and error of each sample that counts to `each`.
    pub(super) fn each_error(&self, point: &Point, mut each: impl FnMut(usize, f64)) {
        for stretch in self.stretches {
            self.each_error_of(stretch, point, &mut each);
        }
    }

    fn each_error_of(&self, stretch: &Stretch, point: &Point, mut each: impl FnMut(usize, f64)) {
        let physics = point.physics(stretch.controller, |_, value| value);
        simulate(
            &physics,
            &self.grid,
            &stretch.start,
            &stretch.input,
            |k, y| {
                let measured = stretch.output[k];
                let block = stretch.block(k);
                if !measured.is_nan() && (self.used)(block) {
                    each(block, measured - y);
                }
            },
        );
    }

    /// The sums at `point`, in numbers that carry as many derivatives as it has coordinates.
    fn sums(&self, point: &Point) -> Sums {
        match point.values.len() {
            0..=8 => self.sums_of::<8>(point),
            9..=12 => self.sums_of::<12>(point),
            13..=16 => self.sums_of::<16>(point),
            _ => self.sums_of::<MOST>(point),
        }
    }

    fn sums_of<const W: usize>(&self, point: &Point) -> Sums {
        let count = point.values.len();
        let (mut normal, mut gradient) = ([[0.0; W]; W], [0.0; W]);
        let mut cost = 0.0;
        self.each_slope::<W>(point, |_, _, error, slope| {
            let weight = huber_weight(error, self.clip);
            cost += clipped_square(error, self.clip);
            for i in 0..W {
                let weighted = weight * slope[i];
                gradient[i] += weighted * error;
                for j in 0..W {
                    normal[i][j] += weighted * slope[j];
                }
            }
        });
        Sums {
            cost,
            normal: Mat::from_fn(count, count, |i, j| normal[i][j]),
            gradient: gradient[..count].to_vec(),
        }
    }

    /// Hands stretch, sample, error and the derivatives of the output to `each`.
    pub(super) fn each_slope<const W: usize>(
        &self,
        point: &Point,
        mut each: impl FnMut(usize, usize, f64, &[f64; W]),
    ) {
        for (s, stretch) in self.stretches.iter().enumerate() {
            let physics =
                point.physics(stretch.controller, |i, value| Dual::<W>::variable(value, i));
            let start = stretch.start.lifted();
            simulate(&physics, &self.grid, &start, &stretch.input, |k, y| {
                let measured = stretch.output[k];
                if !measured.is_nan() && (self.used)(stretch.block(k)) {
                    each(s, k, measured - y.value, &y.slope);
                }
            });
        }
    }

    /// The best of the minima below several starts, and its cost: short descents from all, and a long one from the lowest.
    pub(super) fn best_descent(&self, starts: Vec<Point>, iterations: usize) -> (f64, Point) {
        let first = match starts.len() {
            1 => 0,
            _ => FIRST_STEPS,
        };
        let descents = starts.into_iter().map(|mut point| {
            let cost = match first {
                0 => f64::INFINITY,
                steps => self.descend(&mut point, steps),
            };
            (cost, point)
        });
        let lowest = descents.min_by(|a, b| a.0.total_cmp(&b.0));
        let (cost, mut point) = lowest.expect("there is a start");
        let lower = self.descend(&mut point, iterations - first);
        (cost.min(lower), point)
    }

    /// Moves `point` downhill, `iterations` times at the most. Returns its cost.
    pub(super) fn descend(&self, point: &mut Point, iterations: usize) -> f64 {
        let mut cost = f64::INFINITY;
        let mut damping = 1e-2;
        for _ in 0..iterations {
            if self.watch.ends() {
                break;
            }
            let sums = self.sums(point);
            cost = sums.finite_cost();
            let Some((next, lower)) = self.step(point, &sums, cost, &mut damping) else {
                break;
            };
            let gained = cost - lower;
            (*point, cost) = (next, lower);
            if gained < self.converged * cost {
                break;
            }
        }
        cost
    }

    /// The next point, and its cost, if one is lower.
    fn step(
        &self,
        point: &Point,
        sums: &Sums,
        cost: f64,
        damping: &mut f64,
    ) -> Option<(Point, f64)> {
        let free = self.free(point, &sums.gradient);
        for _ in 0..ATTEMPTS {
            if let Some(step) = solve(sums, &free, *damping) {
                let hoped: f64 = free
                    .iter()
                    .zip(&step)
                    .map(|(&i, s)| sums.gradient[i] * s)
                    .sum();
                if hoped < self.converged * cost {
                    return None;
                }
                let next = self.moved(point, &free, &step);
                let lower = self.cost_below(&next, cost);
                if lower < cost {
                    *damping = (*damping * 0.1).max(1e-10);
                    return Some((next, lower));
                }
            }
            *damping *= 10.0;
        }
        None
    }

    /// Coordinates that the gradient does not push beyond their range.
    fn free(&self, point: &Point, gradient: &[f64]) -> Vec<usize> {
        let inside = |i: &usize| {
            let (low, high) = point.coordinates[*i].range(self.longest_delay_s);
            let (value, downhill) = (point.values[*i], gradient[*i]);
            !(value <= low && downhill < 0.0 || value >= high && downhill > 0.0)
        };
        (0..point.values.len()).filter(inside).collect()
    }

    fn moved(&self, point: &Point, free: &[usize], step: &[f64]) -> Point {
        let mut next = point.clone();
        for (&i, change) in free.iter().zip(step) {
            let coordinate = point.coordinates[i];
            let change = match coordinate.is_logarithm() {
                true => change.clamp(-1.0, 1.0),
                false => *change,
            };
            let (low, high) = coordinate.range(self.longest_delay_s);
            next.values[i] = (next.values[i] + change).clamp(low, high);
        }
        next
    }
}

/// Coordinates that a servo has at the most, those of further controllers among them.
pub(super) const MOST: usize = 28;

/// Dampings that are tried for one step.
const ATTEMPTS: usize = 6;

/// Steps of each descent before the lowest of several is continued.
const FIRST_STEPS: usize = 6;

/// Solves (J'WJ + damping) step = J'We for the free coordinates.
fn solve(sums: &Sums, free: &[usize], damping: f64) -> Option<Vec<f64>> {
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

/// The square of an error, beyond the clip in proportion to its size.
pub(super) fn clipped_square(error: f64, clip: f64) -> f64 {
    let size = error.abs();
    if size < clip {
        size * size
    } else {
        2.0 * clip * size - clip * clip
    }
}

fn huber_weight(error: f64, clip: f64) -> f64 {
    let size = error.abs();
    if size < clip { 1.0 } else { clip / size }
}
