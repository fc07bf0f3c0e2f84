//! A straight line of rests in the middle, and an end at one angle on one side of it or on both.

use super::rests::Rest;
use crate::diagnostics::runs::common_offset::common_offset;
use crate::numerics::{dot, square_about_mean};
use crate::thresholds::{RESIDUAL_SIGNIFICANCE, SHORT_LEVEL_SIGNIFICANCE, STOP_GAIN, STOP_SHORT};
use statrs::distribution::{ContinuousCDF, FisherSnedecor, StudentsT};
use std::ops::Range;

/// Rests at a flat end.
const FEWEST_AT_END: usize = 2;

/// A line in the middle of the rests, and what is beyond it at rest at one angle.
pub(super) struct Split {
    /// The rests of the line.
    pub(super) inner: Range<usize>,
    slope: f64,
    /// Mean command and output, and count, of the rests of the line in each run.
    runs: Vec<(f64, f64, f64)>,
    /// Sum of squares of the commands about these means.
    spread: f64,
    /// The way of the output along the line.
    way: f64,
    /// Sum of squares about the line, and the largest distance from it.
    of_line: f64,
    largest: f64,
    /// Sum of squares about the line and about the means of the ends.
    pub(super) square: f64,
}

impl Split {
    /// `None` where the line is not determined, or no rest is left over.
    pub(super) fn of(rests: &[Rest], inner: Range<usize>) -> Option<Self> {
        let line = rests.get(inner.clone())?;
        let (first, last) = (line.first()?, line.last()?);
        let runs = 1 + rests.iter().map(|rest| rest.run).max()?;
        let mut sums = vec![(0.0, 0.0, 0.0); runs];
        for rest in line {
            let sum = &mut sums[rest.run];
            *sum = (sum.0 + rest.command, sum.1 + rest.output, sum.2 + 1.0);
        }
        let runs: Vec<(f64, f64, f64)> = sums.iter().map(|(u, y, n)| (u / n, y / n, *n)).collect();
        let (mut spread, mut product) = (0.0, 0.0);
        for rest in line {
            let (u, y, _) = runs[rest.run];
            spread += (rest.command - u).powi(2);
            product += (rest.command - u) * (rest.output - y);
        }
        let mut split = Self {
            inner,
            slope: product / spread,
            way: (product / spread * (last.command - first.command)).abs(),
            runs,
            spread,
            of_line: 0.0,
            largest: 0.0,
            square: 0.0,
        };
        for rest in line {
            let distance = split.beside_line(rest).abs();
            split.of_line += distance * distance;
            split.largest = split.largest.max(distance);
        }
        let ends = [0, 1].map(|side| split.about_mean(rests, side));
        split.square = split.of_line + ends[0] + ends[1];
        (spread > 0.0 && split.degrees() > 0.0).then_some(split)
    }

    /// Degrees of freedom that the line leaves.
    fn degrees(&self) -> f64 {
        let used = self.runs.iter().filter(|(_, _, count)| *count > 0.0);
        self.inner.len() as f64 - used.count() as f64 - 1.0
    }

    /// Output above the line; NaN in a run of which the line has no rest.
    fn beside_line(&self, rest: &Rest) -> f64 {
        let (u, y, _) = self.runs[rest.run];
        rest.output - y - self.slope * (rest.command - u)
    }

    /// Output above that of the line under command 0.
    fn beside_run(&self, rest: &Rest) -> f64 {
        let (u, y, _) = self.runs[rest.run];
        rest.output - y + self.slope * u
    }

    /// The rests of one end, of runs that the line has.
    pub(super) fn beyond<'r>(&self, rests: &'r [Rest], side: usize) -> Vec<&'r Rest> {
        let end = match side {
            0 => &rests[..self.inner.start],
            _ => &rests[self.inner.end..],
        };
        let is_known = |rest: &&Rest| self.runs[rest.run].2 > 0.0;
        end.iter().filter(is_known).collect()
    }

    fn about_mean(&self, rests: &[Rest], side: usize) -> f64 {
        let outputs = self.beyond(rests, side).into_iter();
        let outputs: Vec<f64> = outputs.map(|rest| self.beside_run(rest)).collect();
        match outputs.len() {
            0 => 0.0,
            _ => square_about_mean(&outputs),
        }
    }

    /// Whether the ends that there are lie short of the line at one angle, and no polynomial describes the rests better.
    pub(super) fn is_flat(&self, rests: &[Rest], step: f64) -> bool {
        let ends = [0, 1].map(|side| self.beyond(rests, side));
        let is_end = |side: usize| ends[side].is_empty() || self.is_short(&ends[side], side, step);
        let count = ends.iter().filter(|end| !end.is_empty()).count();
        // Two stops and a cubic bend are much alike.
        is_end(0) && is_end(1) && count as f64 * self.square < square_beside_polynomial(rests)
    }

    /// Whether the rests of an end lie on the inner side of the line: those of the last command each farther than any of the line, their
    /// mean beyond chance and beyond rounding; and do not follow the command.
    fn is_short(&self, end: &[&Rest], side: usize, step: f64) -> bool {
        let outwards = if side == 0 { -1.0 } else { 1.0 } * self.slope.signum();
        let short = |rest: &&Rest| -outwards * self.beside_line(rest);
        let count = end.len() as f64;
        let mean = end.iter().map(short).sum::<f64>() / count;
        // Of the mean of the line there: its offset in each run, and its slope.
        let (mut by_offsets, mut arm) = (0.0, 0.0);
        for (run, (u, _, known)) in self.runs.iter().enumerate() {
            let own = end.iter().filter(|rest| rest.run == run);
            let (n, sum) = own.fold((0.0, 0.0), |(n, sum), rest| {
                (n + 1.0, sum + rest.command - u)
            });
            if n > 0.0 {
                by_offsets += (n / count).powi(2) / known;
                arm += sum / count;
            }
        }
        let leverage = 1.0 / count + by_offsets + arm * arm / self.spread;
        let sd = (self.of_line / self.degrees() * leverage).sqrt();
        let student = StudentsT::new(0.0, 1.0, self.degrees());
        // A line through one command has no slope, and what lies beside it no chance.
        let beyond = Some(mean / sd).filter(|beyond| !beyond.is_nan());
        let tail = beyond.zip(student.ok()).map(|(beyond, t)| t.sf(beyond));
        let extreme = end[if side == 0 { 0 } else { end.len() - 1 }].command;
        let mut at_extreme = end.iter().filter(|rest| rest.command == extreme);
        end.len() >= FEWEST_AT_END
            && mean > step.max(STOP_SHORT * self.way)
            && at_extreme.all(|rest| short(rest) > self.largest)
            && (self.slope_of(end) / self.slope).abs() < STOP_GAIN
            && tail.is_some_and(|tail| tail < SHORT_LEVEL_SIGNIFICANCE)
    }

    /// Slope of some rests; 0 of a single command.
    fn slope_of(&self, end: &[&Rest]) -> f64 {
        let mean = end.iter().map(|rest| rest.command).sum::<f64>() / end.len() as f64;
        let (mut spread, mut product) = (0.0, 0.0);
        for rest in end {
            spread += (rest.command - mean).powi(2);
            product += (rest.command - mean) * self.beside_run(rest);
        }
        if spread > 0.0 { product / spread } else { 0.0 }
    }

    /// What the offset of each run is above the [common one](common_offset) where they differ beyond chance, else 0: what friction makes of the mean of a few rests
    /// is no zero of the sensor that moved.
    pub(super) fn moved(&self) -> Option<Vec<f64>> {
        let offset = |(u, y, _): &(f64, f64, f64)| y - self.slope * u;
        let used = || self.runs.iter().filter(|(_, _, count)| *count > 0.0);
        let common = common_offset(&used().map(offset).collect::<Vec<_>>())?;
        let all: f64 = used().map(|run| run.2).sum();
        let mean = used().map(|run| run.2 * offset(run)).sum::<f64>() / all;
        let between: f64 = used().map(|run| run.2 * (offset(run) - mean).powi(2)).sum();
        let freedom = (used().count() as f64 - 1.0, self.degrees());
        let ratio = between / freedom.0 / (self.of_line / freedom.1);
        let f = FisherSnedecor::new(freedom.0, freedom.1);
        let differ = f.is_ok_and(|f| f.sf(ratio) < RESIDUAL_SIGNIFICANCE);
        let above = |run: &(f64, f64, f64)| if differ { offset(run) - common } else { 0.0 };
        Some(self.runs.iter().map(above).collect())
    }
}

/// Sum of squares beside a cubic polynomial of the commands with an offset of each run, or a parabola where four commands leave no more.
fn square_beside_polynomial(rests: &[Rest]) -> f64 {
    let degree = commands(rests).saturating_sub(2).min(3);
    let largest = rests
        .iter()
        .map(|rest| rest.command.abs())
        .fold(0.0, f64::max);
    let runs = rests.iter().map(|rest| rest.run + 1).max().unwrap_or(0);
    let of_run = |run: usize| {
        rests
            .iter()
            .map(move |rest| f64::from(rest.run == run))
            .collect()
    };
    let of_power = |power: usize| {
        let powers = rests
            .iter()
            .map(|rest| (rest.command / largest).powi(power as i32));
        powers.collect()
    };
    let columns: Vec<Vec<f64>> = (0..runs)
        .map(of_run)
        .chain((1..=degree).map(of_power))
        .collect();
    let mut left: Vec<f64> = rests.iter().map(|rest| rest.output).collect();
    let mut basis: Vec<Vec<f64>> = Vec::new();
    for mut column in columns {
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
    let square = dot(direction, direction);
    let share = if square > 0.0 {
        dot(values, direction) / square
    } else {
        0.0
    };
    for (value, along) in values.iter_mut().zip(direction) {
        *value -= share * along;
    }
}

/// Number of different commands, among rests by the command.
fn commands(rests: &[Rest]) -> usize {
    rests.chunk_by(|a, b| a.command == b.command).count()
}
