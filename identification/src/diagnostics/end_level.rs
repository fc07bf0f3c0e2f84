//! Whether the output falls short at the last of several levels, as at a stop that one level alone lies beyond.
//!
//! At rest a linear servo is a straight line of its levels, and errors of the model are one, too. A stop leaves the last level short of
//! the line through the others, at every visit. Where the ends fall short a little at a time, as with a linkage or a soft gain, a
//! polynomial describes the levels better; where levels are reached from both sides with friction or play,
//! others are as far from their line as the last.

use statrs::distribution::{ContinuousCDF, StudentsT};

use super::simulation_error::Simulated;
use crate::data::{EXACTLY, Hold, holds, last_quarter, mean_output};
use crate::numerics::{dot, square_about_mean};
use crate::thresholds::SHORT_LEVEL_SIGNIFICANCE;

/// Levels that a line and a stop beside it take at least: with three, a bend is a stop.
const FEWEST_LEVELS: usize = 4;

/// Visits of a level that is compared.
const FEWEST_VISITS: usize = 2;

/// The last level of one side, at which the output falls short.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct ShortLevel {
    /// The command \[input\].
    pub(super) level: f64,
    /// Mean of the output there \[output\].
    pub(super) rest: f64,
}

/// One visit of a level, at its end.
#[derive(Debug, Clone, Copy)]
struct Visit {
    level: f64,
    /// Mean output over the last quarter.
    rest: f64,
    /// Mean error of the model there, in the direction of the commands.
    error: f64,
}

impl ShortLevel {
    /// The levels at the ends of those that the runs visit for at least `settling` samples, where they fall short.
    /// `gain` has the sign of the servo's, and `step` is that of the sensor: levels that are short by no more are rounded.
    pub(super) fn both(
        runs: &[Simulated<'_>],
        settling: usize,
        (gain, step): (f64, f64),
    ) -> [Option<Self>; 2] {
        let mut visits: Vec<Visit> = runs
            .iter()
            .flat_map(|run| visits(run, settling, gain))
            .collect();
        visits.sort_by(|a, b| a.level.total_cmp(&b.level));
        let levels: Vec<&[Visit]> = visits.chunk_by(|a, b| a.level == b.level).collect();
        let (&[first, .., last], FEWEST_LEVELS..) = (levels.as_slice(), levels.len()) else {
            return [None; 2];
        };
        let is_short = |ends: &[&[Visit]]| is_short(&visits, ends, step);
        if is_short(&[last]) {
            [None, Some(Self::at(last))]
        } else if is_short(&[first]) {
            [Some(Self::at(first)), None]
        } else if levels.len() > FEWEST_LEVELS && is_short(&[first, last]) {
            [first, last].map(|end| Some(Self::at(end)))
        } else {
            [None; 2]
        }
    }

    fn at(end: &[Visit]) -> Self {
        let sum: f64 = end.iter().map(|visit| visit.rest).sum();
        Self {
            level: end[0].level,
            rest: sum / end.len() as f64,
        }
    }
}

/// The visits of one run that last long enough for the servo to arrive.
fn visits(simulated: &Simulated<'_>, settling: usize, gain: f64) -> Vec<Visit> {
    let run = &simulated.run;
    let visit = |hold: &Hold| {
        let last = last_quarter(&hold.samples);
        let errors = simulated.errors[last.clone()].iter();
        let (count, sum) = errors
            .filter(|error| !error.is_nan())
            .fold((0usize, 0.0), |(count, sum), error| {
                (count + 1, sum + error)
            });
        Some(Visit {
            level: hold.level,
            rest: mean_output(run, last)?,
            error: gain.signum() * sum / count as f64,
        })
    };
    holds(run, EXACTLY)
        .iter()
        .filter(|hold| hold.before.is_some() && hold.samples.len() >= settling)
        .filter_map(visit)
        .collect()
}

/// Whether all of `ends` fall short of the line through the other visits, beyond chance and beyond any of the others, and no
/// polynomial describes them better. Each must be short by more than `step`.
fn is_short(visits: &[Visit], ends: &[&[Visit]], step: f64) -> bool {
    let is_end = |visit: &Visit| ends.iter().any(|end| end[0].level == visit.level);
    let others: Vec<Visit> = (visits.iter().filter(|v| !is_end(v)).copied()).collect();
    let Some(line) = Line::through(&others) else {
        return false;
    };
    let are_short = ends
        .iter()
        .all(|end| end.len() >= FEWEST_VISITS && line.is_short_at(end, step));
    let by_stops = line.square + ends.iter().map(|end| about_mean(end)).sum::<f64>();
    // Two stops and a cubic bend are much alike.
    are_short && ends.len() as f64 * by_stops < square_beside_polynomial(visits)
}

fn about_mean(visits: &[Visit]) -> f64 {
    let errors: Vec<f64> = visits.iter().map(|visit| visit.error).collect();
    square_about_mean(&errors)
}

/// The line of errors over levels that fits some visits best.
struct Line {
    centre: f64,
    mean: f64,
    slope: f64,
    /// Sum of squares of the levels about their centre.
    spread: f64,
    count: f64,
    /// Sum of squares about the line.
    square: f64,
    /// The largest distance of a visit from it.
    largest: f64,
}

impl Line {
    /// `None` for levels that are all the same, and where no visit is left over.
    fn through(visits: &[Visit]) -> Option<Self> {
        let count = visits.len() as f64;
        let centre = visits.iter().map(|visit| visit.level).sum::<f64>() / count;
        let mean = visits.iter().map(|visit| visit.error).sum::<f64>() / count;
        let spread: f64 = visits.iter().map(|v| (v.level - centre).powi(2)).sum();
        let product: f64 = visits.iter().map(|v| (v.level - centre) * v.error).sum();
        let mut line = Self {
            centre,
            mean,
            slope: product / spread,
            spread,
            count,
            square: 0.0,
            largest: 0.0,
        };
        for visit in visits {
            let distance = line.error_beside(visit).abs();
            line.square += distance * distance;
            line.largest = line.largest.max(distance);
        }
        (spread > 0.0 && count > 2.0).then_some(line)
    }

    fn error_beside(&self, visit: &Visit) -> f64 {
        visit.error - self.mean - self.slope * (visit.level - self.centre)
    }

    /// Whether the visits of an end lie on the inner side of the line: each farther than any of the others, their mean beyond chance.
    fn is_short_at(&self, end: &[Visit], step: f64) -> bool {
        let outwards = (end[0].level - self.centre).signum();
        let short = || end.iter().map(|visit| -outwards * self.error_beside(visit));
        let visits = end.len() as f64;
        let mean = short().sum::<f64>() / visits;
        let leverage = 1.0 / self.count + (end[0].level - self.centre).powi(2) / self.spread;
        let sd = (self.square / (self.count - 2.0) * (1.0 / visits + leverage)).sqrt();
        let tail = StudentsT::new(0.0, 1.0, self.count - 2.0).map(|t| t.sf(mean / sd));
        mean > step
            && short().all(|short| short > self.largest)
            && tail.is_ok_and(|tail| tail < SHORT_LEVEL_SIGNIFICANCE)
    }
}

/// Sum of squares of the errors beside a cubic polynomial of the levels, or a parabola where four levels leave no more.
fn square_beside_polynomial(visits: &[Visit]) -> f64 {
    let levels = visits.chunk_by(|a, b| a.level == b.level).count();
    let degree = (levels - 2).min(3);
    let largest = visits.iter().map(|v| v.level.abs()).fold(0.0, f64::max);
    let mut left: Vec<f64> = visits.iter().map(|visit| visit.error).collect();
    let mut basis: Vec<Vec<f64>> = Vec::new();
    for power in 0..=degree {
        let powers = visits
            .iter()
            .map(|v| (v.level / largest).powi(power as i32));
        let mut column: Vec<f64> = powers.collect();
        for earlier in &basis {
            remove(&mut column, earlier);
        }
        remove(&mut left, &column);
        basis.push(column);
    }
    dot(&left, &left)
}

/// Takes the part along `direction` out of `values`.
fn remove(values: &mut [f64], direction: &[f64]) {
    let share = dot(values, direction) / dot(direction, direction);
    for (value, along) in values.iter_mut().zip(direction) {
        *value -= share * along;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    /// Six levels from -10 to 10 in random order, each visited six times; `error` has the level, the one before and noise within ±0.05.
    fn visits(seed: u64, error: impl Fn(f64, f64, f64) -> f64) -> Vec<Visit> {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let mut left: Vec<f64> = (0..36).map(|k| f64::from(k % 6) * 4.0 - 10.0).collect();
        let mut before = 0.0;
        let mut visits = Vec::new();
        while !left.is_empty() {
            let level = left.swap_remove(random.random_range(0..left.len()));
            let error = error(level, before, random.random_range(-0.05..0.05));
            let rest = level + error;
            visits.push(Visit { level, rest, error });
            before = level;
        }
        visits.sort_by(|a, b| a.level.total_cmp(&b.level));
        visits
    }

    /// Whether the last, the first or both levels fall short.
    fn is_found(visits: &[Visit]) -> [bool; 3] {
        let (first, last) = (&visits[..6], &visits[30..]);
        [&[last][..], &[first][..], &[first, last][..]].map(|ends| is_short(visits, ends, 0.0))
    }

    #[test]
    fn a_level_beyond_a_stop_falls_short_and_so_do_two() {
        // The gain of the model lies between that of the servo and that of the stop.
        let upper = visits(1, |level, _, noise| {
            0.02 * level - (level - 9.8).max(0.0) + noise
        });
        assert_eq!(is_found(&upper), [true, false, false]);
        let both = visits(2, |level, _, noise| level.clamp(-9.2, 9.2) - level + noise);
        assert_eq!(is_found(&both), [false, false, true]);
        // By 0.8: a sensor with steps of 0.5 shows it, one with steps of 1 may have rounded.
        let ends: [&[Visit]; 2] = [&both[30..], &both[..6]];
        assert!(is_short(&both, &ends, 0.5) && !is_short(&both, &ends, 1.0));
    }

    #[test]
    fn noise_play_and_gains_that_fall_are_no_stop() {
        type Curve = fn(f64, f64, f64) -> f64;
        let curves: [Curve; 5] = [
            |level, _, noise| 0.02 * level + noise,
            |level, _, noise| -0.01 * level * level + noise,
            |level, _, noise| -1e-3 * level.powi(3) + noise,
            |level, _, noise| 30.0 * (level / 30.0).sin() - level + noise,
            // Play or friction: short of the level from either side.
            |level, before, noise| 0.2 * (before - level).signum() + noise,
        ];
        for (number, curve) in curves.iter().enumerate() {
            for seed in 0..200 {
                let found = is_found(&visits(seed, curve));
                assert_eq!(found, [false; 3], "curve {number}, seed {seed}");
            }
        }
    }
}
