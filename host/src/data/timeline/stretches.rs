//! The stretches that the rows of a table lie in, and the place of each row in its stretch.

use super::time_stamps::{Step, TimeColumn};
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

/// Sorts `rows` rows into runs, by a column of labels and a column of time as far as they are there.
pub fn stretches(rows: usize, time: Option<&TimeColumn>, labels: Option<&[f64]>) -> Vec<Stretch> {
    let mut found: Vec<Stretch> = Vec::new();
    let mut ahead = 0.0;
    for row in 0..rows {
        // Labels are compared by bits: they are names, and an empty cell (NaN) is one too.
        let same_label = row > 0
            && labels.is_none_or(|labels| {
                let label = |row: usize| labels.get(row).map(|label| label.to_bits());
                label(row) == label(row - 1)
            });
        let step = match time {
            _ if !same_label => Step::NewRun,
            Some(time) => time.step_before(row, &mut ahead),
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
    pub fn missing(&self) -> usize {
        self.samples
            .last()
            .map_or(0, |last| last + 1 - self.samples.len())
    }

    /// The rows' part of `column`, each value at its sample's place, NaN where a sample or its row is
    /// missing.
    pub fn place(&self, column: &[f64]) -> Vec<f64> {
        let mut placed = vec![f64::NAN; self.samples.last().map_or(0, |last| last + 1)];
        let values = column.get(self.rows.clone()).unwrap_or_default();
        for (&sample, &value) in self.samples.iter().zip(values) {
            if let Some(place) = placed.get_mut(sample) {
                *place = value;
            }
        }
        placed
    }
}
