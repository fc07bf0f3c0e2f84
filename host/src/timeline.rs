//! Where the rows of a table lie in time: which run each belongs to, and which sample of it each is.
//!
//! A column of time says where rows are missing and where another run begins; taking such rows for
//! neighbours would shift every sample behind them.

use std::ops::Range;

/// Rows that belong together.
#[derive(Clone, Debug, PartialEq)]
pub struct Stretch {
    /// Which rows.
    pub rows: Range<usize>,
    /// Whether it goes on with the run of the stretch before it, behind a long gap: then what the
    /// input was before its first row is not known, even where it is for beginnings of runs.
    pub continues: bool,
    /// Which sample of the run each row is, rising from 0; a number left out is a missing sample.
    pub samples: Vec<usize>,
}

/// The longest gap that is filled with missing samples; beyond it, the rows after it stand apart. A
/// servo has forgotten by then what was before the gap, and a time that is far off must not decide
/// how much memory is taken.
const LONGEST_GAP: f64 = 1000.0;

/// A column of time whose steps are nearly all equal.
#[derive(Clone, Debug, PartialEq)]
pub struct TimeColumn {
    times: Vec<f64>,
    step: f64,
}

impl TimeColumn {
    /// Takes a column for one of time if at least 19 of 20 of its steps are within 5 % of the
    /// middle one.
    #[must_use]
    pub fn new(times: Vec<f64>) -> Option<Self> {
        let mut steps: Vec<f64> = times
            .windows(2)
            .map(|w| w[1] - w[0])
            .filter(|step| *step > 0.0)
            .collect();
        if steps.is_empty() {
            return None;
        }
        let middle = steps.len() / 2;
        let step = *steps.select_nth_unstable_by(middle, f64::total_cmp).1;
        let even = steps
            .iter()
            .filter(|&&s| (s / step - 1.0).abs() < 0.05)
            .count();
        (even * 20 >= times.len().saturating_sub(1) * 19).then_some(Self { times, step })
    }

    /// The middle step, freed of the rounding noise that differences of written times carry: 0.02
    /// comes back as 0.020000000000003126.
    #[must_use]
    pub fn step(&self) -> f64 {
        let rounded = (self.step * 1e6).round() / 1e6;
        if rounded > 0.0 { rounded } else { self.step }
    }

    fn step_before(&self, row: usize) -> Step {
        let steps = (self.times[row] - self.times[row - 1]) / self.step;
        if steps <= 0.0 {
            Step::NewRun
        } else if steps >= LONGEST_GAP {
            Step::LongGap
        } else {
            // An empty cell (NaN, which becomes 0) says nothing of gaps.
            Step::Samples((steps.round() as usize).max(1))
        }
    }
}

/// What lies between a row and the row before it.
enum Step {
    /// So many samples.
    Samples(usize),
    /// More samples than are worth counting.
    LongGap,
    /// The beginning of another run.
    NewRun,
}

/// Sorts `rows` rows into runs, by a column of labels and a column of time as far as they are there.
///
/// ```
/// use servoid::timeline::{TimeColumn, stretches};
/// let mut times: Vec<f64> = (0..60).map(|k| 0.01 * f64::from(k)).collect();
/// times.remove(30); // a row is missing
/// times.extend([0.0, 0.01]); // another run
/// let column = TimeColumn::new(times.clone());
/// let found = stretches(times.len(), column.as_ref(), None);
/// assert_eq!(found.len(), 2);
/// assert_eq!(found[0].samples[29..31], [29, 31]);
/// assert_eq!(found[1].rows, 59..61);
/// ```
#[must_use]
pub fn stretches(rows: usize, time: Option<&TimeColumn>, labels: Option<&[f64]>) -> Vec<Stretch> {
    let mut found: Vec<Stretch> = Vec::new();
    for row in 0..rows {
        // Labels are compared by bits: they are names, and an empty cell (NaN) is one too.
        let same_label = row > 0
            && labels.is_none_or(|labels| labels[row].to_bits() == labels[row - 1].to_bits());
        let step = match time {
            _ if !same_label => Step::NewRun,
            Some(time) => time.step_before(row),
            None => Step::Samples(1),
        };
        match (step, found.last_mut()) {
            (Step::Samples(count), Some(stretch)) => {
                let last = stretch.samples.last().copied().unwrap_or(0);
                stretch.samples.push(last + count);
                stretch.rows.end = row + 1;
            }
            (step, _) => found.push(Stretch {
                rows: row..row + 1,
                continues: matches!(step, Step::LongGap),
                samples: vec![0],
            }),
        }
    }
    found
}

impl Stretch {
    /// Samples without a row.
    #[must_use]
    pub fn missing(&self) -> usize {
        self.samples
            .last()
            .map_or(0, |last| last + 1 - self.samples.len())
    }

    /// The rows' part of `column`, each value at its sample's place, NaN where a sample is missing.
    ///
    /// # Panics
    /// When `column` has fewer rows than the table.
    #[must_use]
    pub fn place(&self, column: &[f64]) -> Vec<f64> {
        let mut placed = vec![f64::NAN; self.samples.last().map_or(0, |last| last + 1)];
        for (&sample, &value) in self.samples.iter().zip(&column[self.rows.clone()]) {
            placed[sample] = value;
        }
        placed
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn even(count: u32) -> Vec<f64> {
        (0..count).map(|k| 0.02 * f64::from(k)).collect()
    }

    #[test]
    fn a_gap_keeps_its_place_and_a_jump_back_is_another_run() {
        let mut times = even(100);
        times.drain(50..70);
        times.extend(even(40));
        let column = TimeColumn::new(times.clone()).unwrap();
        assert_eq!(column.step(), 0.02);
        let found = stretches(times.len(), Some(&column), None);
        assert_eq!(found.len(), 2);
        assert_eq!((found[0].rows.clone(), found[0].missing()), (0..80, 20));
        assert_eq!((found[1].rows.clone(), found[1].missing()), (80..120, 0));
        let placed = found[0].place(&times);
        assert_eq!(placed.len(), 100);
        assert!(placed[49] == times[49] && placed[55].is_nan() && placed[70] == times[50]);
    }

    #[test]
    fn a_year_of_gap_takes_no_memory() {
        let mut times = even(100);
        times.push(3e7);
        let column = TimeColumn::new(times.clone()).unwrap();
        let found = stretches(times.len(), Some(&column), None);
        assert_eq!(found.len(), 2);
        assert!(!found[0].continues && found[1].continues);
    }

    #[test]
    fn uneven_steps_are_no_time() {
        assert_eq!(TimeColumn::new(vec![]), None);
        assert_eq!(TimeColumn::new(vec![1.0, 1.0, 1.0]), None);
        assert_eq!(
            TimeColumn::new((0..50).map(|k| f64::from(k * k)).collect()),
            None
        );
    }

    #[test]
    fn labels_part_runs_even_where_time_goes_on() {
        let column = TimeColumn::new(even(6)).unwrap();
        let labels = [1.0, 1.0, 2.0, 2.0, f64::NAN, f64::NAN];
        let rows: Vec<_> = stretches(6, Some(&column), Some(&labels))
            .into_iter()
            .map(|s| s.rows)
            .collect();
        assert_eq!(rows, [0..2, 2..4, 4..6]);
    }
}
