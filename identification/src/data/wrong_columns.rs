//! Columns that cannot be the command and the motion of a servo.

use crate::data::record::{Record, Run};
use crate::error::Error;

impl<'a> Record<'a> {
    /// Requires columns that can be a command and a motion.
    ///
    /// # Errors
    /// The two are swapped; the output stands still in every run, or counts the samples.
    pub(crate) fn check_columns(&self) -> Result<(), Error> {
        if let Some(levels) = self.levels_of_swapped_columns() {
            return Err(Error::Swapped { levels });
        }
        if self.output_stands_still_in_runs() {
            return Err(Error::StillInRuns);
        }
        match self.output_counts_samples() {
            true => Err(Error::CountsSamples),
            false => Ok(()),
        }
    }

    /// The number of values of the output, where it has so few and the input so many that the two must be swapped.
    fn levels_of_swapped_columns(&self) -> Option<usize> {
        /// A staircase has two levels, and one before it.
        const FEW: usize = 3;
        const MANY: usize = 20;
        let count = |column: for<'r> fn(&'r Run<'a>) -> &'r [f64], most: usize| {
            let mut values = std::collections::HashSet::new();
            let mut all = self.runs().iter().flat_map(column).filter(|v| !v.is_nan());
            while values.len() <= most
                && let Some(value) = all.next()
            {
                values.insert(value.to_bits());
            }
            values.len()
        };
        let levels = count(Run::output, FEW);
        let swapped =
            levels <= FEW && count(Run::input, MANY) > MANY && self.output_jumps_over_its_range();
        swapped.then_some(levels)
    }

    /// Whether the output goes from one end of its range to the other in one sample: references do, and no motion does.
    fn output_jumps_over_its_range(&self) -> bool {
        let outputs = || self.runs().iter().map(Run::output);
        let all = || outputs().flatten().filter(|y| !y.is_nan());
        let range = all().fold(f64::MIN, |a, b| a.max(*b)) - all().fold(f64::MAX, |a, b| a.min(*b));
        outputs().any(|output| output.windows(2).any(|w| (w[1] - w[0]).abs() >= range))
    }

    /// Whether the input changes from run to run alone, and what it was before them is not stated.
    pub(crate) fn steps_before_runs(&self) -> bool {
        self.steps_within_first(0)
    }

    /// Whether the input changes within the first `rows` of each run alone, and what it was before the runs is not stated.
    pub(crate) fn steps_within_first(&self, rows: usize) -> bool {
        let unknown = |run: &Run| run.input_at_rest().is_none();
        self.runs().iter().all(|run| {
            let later = run.input().get(rows..).unwrap_or_default();
            unknown(run) && stands_still(later)
        })
    }

    /// Whether the output changes from run to run alone, while the input moves.
    fn output_stands_still_in_runs(&self) -> bool {
        self.runs().iter().all(|run| stands_still(run.output()))
            && !self.runs().iter().all(|run| stands_still(run.input()))
    }

    /// Whether the output counts the samples: a straight line in every run, as a column of time or of numbers is, while the input is
    /// none. No servo moves so.
    fn output_counts_samples(&self) -> bool {
        /// A single stroke at full speed can be as straight for so long.
        const LONG: usize = 100;
        self.samples() >= LONG
            && self.runs().iter().all(|run| is_straight(run.output()))
            && !self.runs().iter().all(|run| is_straight(run.input()))
    }
}

/// Whether a column is a straight line from its first value to its last, to a thousandth of the way between them: times are rounded,
/// and scatter.
fn is_straight(column: &[f64]) -> bool {
    let mut known = column.iter().enumerate().filter(|(_, y)| !y.is_nan());
    let (Some((from, first)), Some((to, last))) = (known.next(), known.next_back()) else {
        return false;
    };
    let slope = (last - first) / (to - from) as f64;
    let near = |(k, value): (usize, &f64)| {
        (value - first - slope * (k - from) as f64).abs() <= 1e-3 * (last - first).abs()
    };
    slope != 0.0 && known.all(near)
}

/// Whether all values that are there are one.
fn stands_still(values: &[f64]) -> bool {
    let mut known = values.iter().filter(|value| !value.is_nan());
    let first = known.next();
    known.all(|value| Some(value) == first)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_column_of_time_is_no_motion() {
        let steps: Vec<f64> = (0..200).map(|k| f64::from(k / 50 % 2)).collect();
        let times: Vec<f64> = (0..200)
            .map(|k| 0.02 * f64::from(k) + 1e-4 * f64::from(k % 3))
            .collect();
        let counts = |output: &[f64]| {
            Record::of_run(0.02, &steps, output)
                .unwrap()
                .output_counts_samples()
        };
        assert!(counts(&times));
        // A servo at the limit of its speed.
        let limited: Vec<f64> = steps
            .iter()
            .scan(0.0, |y, u: &f64| {
                *y += (u - *y).clamp(-0.02, 0.02);
                Some(*y)
            })
            .collect();
        assert!(!counts(&limited));
        // The exchanged columns have a finding of their own.
        assert!(
            !Record::of_run(0.02, &times, &times)
                .unwrap()
                .output_counts_samples()
        );
    }
}
