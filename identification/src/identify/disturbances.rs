//! What is in a record beside the servo and its noise: glitches, hum, offsets of runs.

use crate::data::{Record, Run};
use crate::diagnostics::{
    HumLine, LevelEffects, Outliers, RunOffsets, RunTrends, StartElsewhere, TakenOut,
    without_offsets_and_trends,
};
use crate::numerics::largest_difference;

/// What was taken out of a record.
#[derive(Debug, Clone, Default)]
pub(super) struct Disturbances {
    pub(super) outliers: Outliers,
    pub(super) hum: Vec<HumLine>,
    /// Offsets of the runs from the common one, where they differ.
    pub(super) offsets: RunOffsets,
    /// The slopes of the runs, where they drift.
    pub(super) trends: RunTrends,
    /// How far levels are off, where that looked like a response beyond the usual hold.
    pub(super) levels: LevelEffects,
    /// That runs begin elsewhere, where that is left out.
    pub(super) start: Option<StartElsewhere>,
}

impl Disturbances {
    pub(super) fn are_as(&self, other: &Self) -> bool {
        /// Change of an amplitude that changes no bound.
        const SMALL: f64 = 0.02;
        let close = |(a, b): (&HumLine, &HumLine)| {
            (a.amplitude() - b.amplitude()).abs() <= SMALL * a.amplitude()
        };
        /// As of a slope, whose lever is the whole run.
        const SMALL_SLOPE: f64 = 1e-4;
        let alike = |mine: &[f64], theirs: &[f64], small: f64| {
            mine.len() == theirs.len()
                && largest_difference(mine, theirs)
                    <= small * mine.iter().fold(0.0, |a: f64, b| a.max(b.abs()))
        };
        self.outliers.taken_out == other.outliers.taken_out
            && self.hum.len() == other.hum.len()
            && self.hum.iter().zip(&other.hum).all(close)
            && alike(&self.offsets, &other.offsets, SMALL)
            && alike(&self.trends, &other.trends, SMALL_SLOPE)
    }

    /// Whether nothing was taken out that could be an error of the model.
    pub(super) fn is_without_errors(&self) -> bool {
        self.outliers.taken_out.is_empty() && self.hum.is_empty() && self.levels.is_empty()
    }

    /// Whether something was taken out of runs as wholes.
    pub(super) fn is_of_runs(&self) -> bool {
        !self.offsets.is_empty() || !self.trends.is_empty()
    }

    /// Those that no error of a model is: the offsets and trends of runs, spikes, and where runs begin.
    pub(super) fn that_are_no_errors(&self) -> Self {
        Self {
            start: self.start.clone(),
            offsets: self.offsets.clone(),
            trends: self.trends.clone(),
            outliers: self.outliers.of_shape(),
            ..Self::default()
        }
    }

    /// Whether nothing was taken out.
    pub(super) fn is_empty(&self) -> bool {
        self.is_without_errors() && !self.is_of_runs() && self.start.is_none()
    }

    /// Number of samples that were taken out.
    pub(super) fn count(&self) -> usize {
        self.outliers.count() + self.start.as_ref().map_or(0, StartElsewhere::count)
    }

    /// The runs of a record that they were taken out of, with their offsets again.
    pub(super) fn with_offsets<'a>(&self, record: &Record<'a>) -> Vec<Run<'a>> {
        let runs = record.runs().iter().enumerate();
        runs.map(|(index, run)| match self.offsets.get(index) {
            Some(offset) => run.with_output(run.output().iter().map(|y| y + offset).collect()),
            None => run.clone(),
        })
        .collect()
    }

    /// `record` without them.
    pub(super) fn removed_from<'a>(&self, record: &Record<'a>) -> Record<'a> {
        if self.is_empty() {
            return record.clone();
        }
        let record = self.levels.put_right(record);
        let record = without_offsets_and_trends(&record, &self.offsets, &self.trends);
        let mut runs: Vec<Run<'a>> = match &self.start {
            Some(start) => start.left_out_of(record.runs()),
            None => record.runs().to_vec(),
        };
        for (index, run) in runs.iter_mut().enumerate() {
            let hum = |k: usize| self.hum.iter().map(|line| line.at(index, k)).sum::<f64>();
            let values = (0..).zip(run.output());
            let mut output: Vec<f64> = values.map(|(k, y)| y - hum(k)).collect();
            TakenOut::blank(&self.outliers.taken_out, index, &mut output);
            *run = run.with_output(output);
        }
        record.with_runs(runs)
    }
}
