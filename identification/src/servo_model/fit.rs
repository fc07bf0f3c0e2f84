//! Parameters by simulation error: Levenberg-Marquardt with exact derivatives.
//!
//! The errors are those of the whole simulation, not of one step ahead, since prediction is what the model is for.
//! An error beyond a clip counts in proportion to its size (Huber), so that a lost run does not decide.

use super::coordinates::{Coordinate, Point};
use super::descent_of_offsets::{OfRun, move_offsets};
use super::descent_step::{MOST, Products, Sums, by_coordinates, solve};
use super::search_progress::Watch;
use super::stretches::Stretch;
use servoid_dynamics::{Grid, Slopes, simulate, simulate_with_slopes};

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

    /// Sum of the clipped squares of the errors in each of `blocks` blocks.
    pub(super) fn by_block(&self, point: &Point, blocks: usize) -> Vec<f64> {
        let mut costs = vec![0.0; blocks];
        self.each_error(point, |block, error| {
            let square = clipped_square(error, self.clip);
            costs[block] += if square.is_nan() {
                f64::INFINITY
            } else {
                square
            };
        });
        costs
    }

    /// Hands block and error of each sample that counts to `each`.
    pub(super) fn each_error(&self, point: &Point, mut each: impl FnMut(usize, f64)) {
        for stretch in self.stretches {
            self.each_error_of(stretch, point, &mut each);
        }
    }

    /// The same of one stretch.
    pub(super) fn each_error_of(
        &self,
        stretch: &Stretch,
        point: &Point,
        mut each: impl FnMut(usize, f64),
    ) {
        let physics = point.servo_of(stretch, |_, value| value);
        let (grid, start) = (&self.grid, &stretch.start);
        simulate(&physics, grid, start, &stretch.input, |k, y| {
            let measured = stretch.output[k];
            let block = stretch.block(k);
            if !measured.is_nan() && (self.used)(block) {
                each(block, measured - y);
            }
        });
    }

    /// The sums at `point`.
    fn sums(&self, point: &Point) -> Sums {
        let mut sums = Sums::zero(point.values.len(), point.run_offsets.len());
        for stretch in self.stretches {
            let mut products = Products::default();
            self.each_parameter_slope(stretch, point, |_, error, slopes| {
                sums.cost += clipped_square(error, self.clip);
                products.add(huber_weight(error, self.clip), error, slopes);
            });
            let chain = by_coordinates(point, stretch.controller);
            products.add_to(&mut sums, &chain);
            if let Some(run) = sums.runs.get_mut(stretch.run) {
                products.add_to_run(run, &chain);
            }
        }
        sums.eliminate_runs();
        sums
    }

    /// Hands sample, error and the derivatives of the output by the parameters of the servo to `each`.
    fn each_parameter_slope(
        &self,
        stretch: &Stretch,
        point: &Point,
        mut each: impl FnMut(usize, f64, &Slopes),
    ) {
        let physics = point.servo_of(stretch, |_, value| value);
        let (grid, start) = (&self.grid, &stretch.start);
        simulate_with_slopes(&physics, grid, start, &stretch.input, |k, y, slopes| {
            let measured = stretch.output[k];
            if !measured.is_nan() && (self.used)(stretch.block(k)) {
                each(k, measured - y, slopes);
            }
        });
    }

    /// Hands stretch, sample, error and the derivatives of the output by the coordinates to `each`.
    pub(super) fn each_slope(
        &self,
        point: &Point,
        mut each: impl FnMut(usize, usize, f64, &[f64; MOST]),
    ) {
        for (s, stretch) in self.stretches.iter().enumerate() {
            let chain = by_coordinates(point, stretch.controller);
            self.each_parameter_slope(stretch, point, |k, error, slopes| {
                let mut by_coordinate = [0.0; MOST];
                for (slope, of_parameter) in slopes.iter().zip(&chain) {
                    for (sum, change) in by_coordinate.iter_mut().zip(of_parameter) {
                        *sum += slope * change;
                    }
                }
                each(s, k, error, &by_coordinate);
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

    /// Moves `point` on to lower minima near it. Where the shaft may stick, the surface has many: a few hundredths of friction
    /// further, it rests elsewhere.
    pub(super) fn descend_around(&self, point: &mut Point, iterations: usize) {
        let mut cost = self.descend(point, iterations);
        for corner in 0..CORNERS {
            let mut other = self.corner(point, corner);
            let lower = self.descend(&mut other, CORNER_STEPS);
            if lower < cost {
                (*point, cost) = (other, lower);
            }
        }
        self.descend(point, iterations);
    }

    /// A corner of the box of [`BOX`] about `point`. The signs are those of Walsh's functions, which are orthogonal.
    fn corner(&self, point: &Point, corner: usize) -> Point {
        let mut other = point.clone();
        for (i, value) in other.values.iter_mut().enumerate() {
            let negative = (corner & (i + 1)).count_ones() % 2 == 1;
            let change = if negative { -BOX } else { BOX };
            let coordinate = point.coordinates[i];
            *value += match coordinate.is_logarithm() {
                true => change,
                false => change * *value,
            };
            let (low, high) = coordinate.range(self.longest_delay_s);
            *value = value.clamp(low, high);
        }
        other
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
                let by_runs: f64 = sums.runs.iter().map(OfRun::gain).sum();
                let hoped: f64 = free
                    .iter()
                    .zip(&step)
                    .map(|(&i, s)| sums.gradient[i] * s)
                    .sum();
                if hoped + by_runs < self.converged * cost {
                    return None;
                }
                let next = self.moved(point, sums, (&free, &step));
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

    /// Coordinates that the gradient does not push beyond their range. Where each run has an offset, these hold the common one.
    fn free(&self, point: &Point, gradient: &[f64]) -> Vec<usize> {
        let inside = |i: &usize| {
            let (low, high) = point.coordinates[*i].range(self.longest_delay_s);
            let (value, downhill) = (point.values[*i], gradient[*i]);
            let inside = !(value <= low && downhill < 0.0 || value >= high && downhill > 0.0);
            let own = !point.run_offsets.is_empty();
            inside && !(own && point.coordinates[*i] == Coordinate::Offset)
        };
        (0..point.values.len()).filter(inside).collect()
    }

    fn moved(&self, point: &Point, sums: &Sums, (free, step): (&[usize], &[f64])) -> Point {
        let mut next = point.clone();
        for (&i, change) in free.iter().zip(step) {
            let coordinate = point.coordinates[i];
            let (low, high) = coordinate.range(self.longest_delay_s);
            next.values[i] = coordinate.moved(next.values[i], *change).clamp(low, high);
        }
        let changes = next.values.iter().zip(&point.values);
        let changes: Vec<f64> = changes.map(|(new, old)| new - old).collect();
        move_offsets(&mut next, &sums.runs, &changes);
        next
    }
}

/// Dampings that are tried for one step.
const ATTEMPTS: usize = 6;

/// Steps of each descent before the lowest of several is continued.
const FIRST_STEPS: usize = 6;

/// Half the width of the box from whose corners minima near one are looked for, in logarithms and as a share of other values; how
/// many corners, and steps from each. Eight corners of this size found what 30 draws did: from fits that predicted another
/// recording to 75 and 88 %, for a change in the last digit, to one of 89 %.
const BOX: f64 = 0.05;
const CORNERS: usize = 8;
const CORNER_STEPS: usize = 10;

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
