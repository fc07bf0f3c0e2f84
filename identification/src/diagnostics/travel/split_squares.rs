//! What lines between two flat ends leave of the rests of a record, for many pairs of places.
//!
//! The sums up to each place give those between any two. They lose digits where nothing is left, so they say only which pairs are worth
//! a pass over all rests.

use super::rests::Rest;
use std::collections::BTreeMap;
use std::ops::{Range, Sub};

/// Part of a sum of squares that its rounding is far below.
const ROUNDING: f64 = 1e-9;

/// Number of rests, and the sums of their commands, outputs and products.
#[derive(Clone, Copy, Default)]
struct Sums {
    count: f64,
    u: f64,
    y: f64,
    uu: f64,
    uy: f64,
    yy: f64,
}

impl Sums {
    fn add(&mut self, u: f64, y: f64) {
        self.count += 1.0;
        self.u += u;
        self.y += y;
        self.uu += u * u;
        self.uy += u * y;
        self.yy += y * y;
    }
}

impl Sub for Sums {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        Self {
            count: self.count - other.count,
            u: self.u - other.u,
            y: self.y - other.y,
            uu: self.uu - other.uu,
            uy: self.uy - other.uy,
            yy: self.yy - other.yy,
        }
    }
}

/// The sums of each run up to each place, of values relative to the means of all.
pub(super) struct SplitSquares {
    up_to: BTreeMap<usize, Vec<Sums>>,
    all: Vec<Sums>,
    /// Sums of squares of all commands and outputs.
    total: (f64, f64),
}

impl SplitSquares {
    /// For lines between any two of `places`, the first and the last rest.
    pub(super) fn new(rests: &[Rest], places: &[usize]) -> Self {
        let count = rests.len() as f64;
        let mean = |of: fn(&Rest) -> f64| rests.iter().map(of).sum::<f64>() / count;
        let (command, output) = (mean(|rest| rest.command), mean(|rest| rest.output));
        let runs = rests.iter().map(|rest| rest.run + 1).max().unwrap_or(0);
        let (mut up_to, mut sums) = (BTreeMap::new(), vec![Sums::default(); runs]);
        let mut places = std::iter::once(&0).chain(places).peekable();
        for (k, rest) in rests.iter().enumerate() {
            if places.next_if(|place| **place == k).is_some() {
                up_to.insert(k, sums.clone());
            }
            sums[rest.run].add(rest.command - command, rest.output - output);
        }
        up_to.insert(rests.len(), sums.clone());
        let total = |of: fn(&Sums) -> f64| sums.iter().map(of).sum();
        Self {
            up_to,
            total: (total(|run| run.uu), total(|run| run.yy)),
            all: sums,
        }
    }

    /// The `lines` of which one leaves least, by the sum of squares about it and about the means of what is on either side of it.
    pub(super) fn least(&self, lines: Vec<Range<usize>>) -> Vec<Range<usize>> {
        let squares: Vec<f64> = lines.iter().map(|line| self.square(line)).collect();
        let known = squares.iter().copied().filter(|square| !square.is_nan());
        let limit = known.fold(f64::INFINITY, f64::min) + ROUNDING * self.total.1;
        let tried = lines.into_iter().zip(squares);
        let worth = tried.filter(|(_, square)| square.is_nan() || *square <= limit);
        worth.map(|(line, _)| line).collect()
    }

    /// The square that a line leaves; NaN where the sums do not say.
    fn square(&self, line: &Range<usize>) -> f64 {
        let (Some(before), Some(up_to)) = (self.up_to.get(&line.start), self.up_to.get(&line.end))
        else {
            return f64::NAN;
        };
        let of_line: Vec<Sums> = up_to.iter().zip(before).map(|(a, b)| *a - *b).collect();
        let after: Vec<Sums> = self.all.iter().zip(up_to).map(|(a, b)| *a - *b).collect();
        let known = || of_line.iter().filter(|run| run.count > 0.0);
        let about_mean = |of: fn(&Sums) -> [f64; 3]| -> f64 {
            let about = |run: &Sums| {
                let [square, a, b] = of(run);
                square - a * b / run.count
            };
            known().map(about).sum()
        };
        let spread = about_mean(|run| [run.uu, run.u, run.u]);
        let counts = known().map(|run| run.count - 1.0);
        // A line has a slope, and an offset in each run.
        if spread <= ROUNDING * self.total.0 || counts.sum::<f64>() <= 1.0 {
            return f64::NAN;
        }
        let slope = about_mean(|run| [run.uy, run.u, run.y]) / spread;
        let left = about_mean(|run| [run.yy, run.y, run.y]) - slope * slope * spread;
        let ends = [before, &after].map(|end| {
            let (mut count, mut sum, mut square) = (0.0, 0.0, 0.0);
            for (end, line) in end
                .iter()
                .zip(&of_line)
                .filter(|(_, line)| line.count > 0.0)
            {
                let offset = (line.y - slope * line.u) / line.count;
                count += end.count;
                sum += end.y - end.count * offset;
                square += end.yy - 2.0 * offset * end.y + end.count * offset * offset;
            }
            square - sum * sum / f64::max(count, 1.0)
        });
        left + ends[0] + ends[1]
    }
}
