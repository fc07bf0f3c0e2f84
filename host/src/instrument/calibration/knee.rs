//! A line that may break at a knee on each side, by least squares.

#![allow(
    clippy::indexing_slicing,
    reason = "each side has a column of the four"
)]

use super::least_squares::{Solution, least_squares};
use std::cmp::Ordering;

/// One side of neutral.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Side {
    /// Shorter pulses.
    Low,
    /// Longer pulses.
    High,
}

impl Side {
    /// Of offsets on this side.
    fn sign(self) -> f64 {
        match self {
            Self::Low => -1.0,
            Self::High => 1.0,
        }
    }

    /// The offset of the pulse farthest out on this side (µs).
    pub(super) fn outermost(self, points: &[(f64, f64)]) -> f64 {
        let outwards = points.iter().map(|point| self.sign() * point.0);
        self.sign() * outwards.fold(0.0, f64::max)
    }

    fn is_beyond(self, offset: f64, knee: f64) -> bool {
        self.sign() * offset > self.sign() * knee
    }

    /// The column of the slope beyond this side's knee in [`fit`].
    fn column(self) -> usize {
        2 + self as usize
    }
}

/// Where the line breaks on each [`Side`]: offsets from neutral (µs).
type Knees = [f64; 2];

fn with(mut knees: Knees, side: Side, at: f64) -> Knees {
    knees[side as usize] = at;
    knees
}

/// counts = zero + slope · clamp(x) + slope_low · min(x - low, 0) + slope_high · max(x - high, 0).
fn fit([low, high]: Knees, points: &[(f64, f64)]) -> Option<Solution> {
    let column = |of: &dyn Fn(f64) -> f64| points.iter().map(|point| of(point.0)).collect();
    let columns: [Vec<f64>; 4] = [
        column(&|_| 1.0),
        column(&|x| x.clamp(low, high)),
        column(&|x| (x - low).min(0.0)),
        column(&|x| (x - high).max(0.0)),
    ];
    let values: Vec<f64> = points.iter().map(|point| point.1).collect();
    least_squares(&columns, &values)
}

/// The column of the slope between the knees in [`fit`].
const SLOPE: usize = 1;

/// Numbers that are fitted: four coefficients and two knees.
const FITTED: f64 = 6.0;

/// What is no motion beside the scatter of readings, whatever that is (counts).
const COUNT: f64 = 1.0;

/// Knees are looked for in steps of so much (µs).
const GRID_US: f64 = 0.25;

/// A fitted line.
#[derive(Clone, Debug)]
pub(super) struct Line {
    /// At neutral (counts).
    pub zero: f64,
    /// Counts for a microsecond, between the knees.
    pub slope: f64,
    /// Standard error of `zero`, the knees given (counts).
    pub zero_se: f64,
    /// Standard error of `slope`, the knees given.
    pub slope_se: f64,
    /// Standard deviation of a reading around the line (counts).
    sigma: f64,
    /// Readings less the numbers that are fitted.
    pub degrees_of_freedom: f64,
    /// The reading farthest from the line (counts).
    pub largest_residual: f64,
    knees: Knees,
}

/// Where a line breaks, and what comes then.
#[derive(Clone, Copy, Debug)]
pub(super) struct Knee {
    /// Offset from neutral (µs).
    pub at: f64,
    /// Its interval (µs).
    pub interval: [f64; 2],
    /// The slope beyond it, as a part of the slope before it, at its smallest and largest: over all places
    /// in the interval.
    pub gain: [f64; 2],
    /// The mean of the readings beyond it (counts), and half the width of its interval.
    pub beyond: [f64; 2],
}

impl Line {
    /// The line through `points`, offsets from neutral (µs) and counts; `None` where there are too few of
    /// them, or too few pulses, to judge by.
    pub(super) fn through(points: &[(f64, f64)]) -> Option<Self> {
        let mut knees = [Side::Low, Side::High].map(|side| side.outermost(points));
        // Each side's best knee depends but slightly on the other one's.
        for side in [Side::High, Side::Low, Side::High, Side::Low] {
            let squares = |at: f64| Some((at, fit(with(knees, side, at), points)?.squares));
            let judged = places(points, side).filter_map(squares);
            let (best, _) = judged.min_by(|a, b| a.1.total_cmp(&b.1))?;
            knees[side as usize] = best;
        }
        let degrees_of_freedom = points.len() as f64 - FITTED;
        if degrees_of_freedom < FITTED {
            return None;
        }
        let fit = fit(knees, points)?;
        // However straight the line, readings are rounded.
        let variance = (fit.squares / degrees_of_freedom).max(super::sensor_scale::ROUNDING);
        let [zero, slope, ..] = fit.coefficients;
        let [zero_variance, slope_variance, ..] = fit.variances;
        Some(Self {
            zero,
            slope,
            zero_se: (variance * zero_variance).sqrt(),
            slope_se: (variance * slope_variance).sqrt(),
            sigma: variance.sqrt(),
            degrees_of_freedom,
            largest_residual: fit.largest_residual,
            knees,
        })
    }

    /// The neighbouring offsets on a side between which the servo stops moving (µs): the outermost two between which it moves by more than
    /// `share` of what it does between the knees, or the next two if it moves there by more than readings of one level differ. Both are wider
    /// by that difference, which hides as much motion.
    pub(super) fn last_motion(
        &self,
        points: &[(f64, f64)],
        side: Side,
        share: f64,
    ) -> Option<[f64; 2]> {
        let outwards = |point: &&(f64, f64)| point.0 == 0.0 || side.is_beyond(point.0, 0.0);
        let mut levels: Vec<(f64, f64)> = points.iter().filter(outwards).copied().collect();
        levels.sort_by(|a, b| {
            (a.0.abs(), a.1)
                .partial_cmp(&(b.0.abs(), b.1))
                .unwrap_or(Ordering::Equal)
        });
        let mean = |level: &[(f64, f64)]| {
            let sum: f64 = level.iter().map(|point| point.1).sum();
            (level[0].0, sum / level.len() as f64)
        };
        let apart = |level: &[(f64, f64)]| level[level.len() - 1].1 - level[0].1;
        let visited = || levels.chunk_by(|a, b| a.0 == b.0);
        let scatter = visited().map(apart).fold(0.0, f64::max);
        let levels: Vec<(f64, f64)> = visited().map(mean).collect();
        let moves = |pair: &&[(f64, f64)]| {
            (pair[1].1 - pair[0].1).abs() > share * (self.slope * (pair[1].0 - pair[0].0)).abs()
        };
        let last = levels.windows(2).rposition(|pair| moves(&pair))?;
        let (inner, outer) = (levels[last], levels[last + 1]);
        let hidden = scatter + COUNT;
        let goes_on = |next: &&(f64, f64)| (next.1 - outer.1).abs() > hidden;
        let [from, to] = match levels.get(last + 2).filter(goes_on) {
            Some(next) => [outer.0, next.0],
            None => [inner.0, outer.0],
        };
        let wider = (to - from).signum() * hidden / self.slope.abs();
        Some([from - wider, to + wider])
    }

    /// Counts at an offset between the knees (µs).
    pub(super) fn at(&self, offset: f64) -> f64 {
        self.zero + self.slope * offset
    }

    /// The knee of one side, if the line without it is worse by more than scatter explains: F(2, ν), for it
    /// has a place and a slope. `t` is Student's t for the level that is wanted, whose square is F(1, ν).
    pub(super) fn knee(
        &self,
        points: &[(f64, f64)],
        side: Side,
        level: f64,
        t: f64,
    ) -> Option<Knee> {
        let fit = |at: f64| fit(with(self.knees, side, at), points);
        let at = self.knees[side as usize];
        let least = fit(at)?.squares;
        let half = self.degrees_of_freedom / 2.0;
        // The quantile of F(2, ν) has a closed form: ν/2 (α^(-2/ν) - 1).
        let quantile = half * ((1.0 - level).powf(-1.0 / half) - 1.0);
        let unexplained = 2.0 * quantile * self.sigma.powi(2);
        if fit(side.outermost(points))?.squares <= least + unexplained {
            return None;
        }
        let bound = least + (t * self.sigma).powi(2);
        let (mut interval, mut gain) = ([at; 2], [f64::INFINITY, f64::NEG_INFINITY]);
        for place in places(points, side) {
            let Some(fit) = fit(place).filter(|fit| fit.squares <= bound) else {
                continue;
            };
            // The bound lies between this place and the next.
            interval = [
                interval[0].min(place - GRID_US),
                interval[1].max(place + GRID_US),
            ];
            let slope = fit.coefficients[SLOPE];
            let ratio = fit.coefficients[side.column()] / slope;
            let half = t * self.sigma * fit.variances[side.column()].sqrt() / slope.abs();
            gain = [gain[0].min(ratio - half), gain[1].max(ratio + half)];
        }
        let beyond = || points.iter().filter(|point| side.is_beyond(point.0, at));
        let count = beyond().count().max(1) as f64;
        let mean = beyond().map(|point| point.1).sum::<f64>() / count;
        Some(Knee {
            at,
            interval,
            gain,
            beyond: [mean, t * self.sigma / count.sqrt()],
        })
    }
}

/// Where a knee may be: from the first level out, for a line needs two.
fn places(points: &[(f64, f64)], side: Side) -> impl Iterator<Item = f64> {
    let outermost = side.outermost(points).abs();
    let levels = points.iter().filter(|point| side.is_beyond(point.0, 0.0));
    let first = levels.map(|point| point.0.abs()).fold(outermost, f64::min);
    let steps = ((outermost - first) / GRID_US) as u32;
    (0..=steps).map(move |step| side.sign() * (outermost - f64::from(step) * GRID_US))
}
