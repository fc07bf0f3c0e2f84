//! What is in a record beside the servo and its noise, and the record without it: glitches, hum, offsets of runs.
//!
//! All are found in the errors of a fit, and a fit is better without them. So fit and search take turns until the
//! search finds the same again.

use super::candidate::Candidate;
use super::estimate::Estimate;
use crate::data::{Quantisation, Record, Run};
use crate::diagnostics::{
    HumLine, Outliers, RunOffsets, hum, outliers, run_offsets, simulated_whole, square,
};
use crate::error::Error;
use crate::numerics::largest_difference;
use crate::options::Options;

/// Turns of fit and search.
const TURNS: usize = 5;

/// What was taken out of a record.
#[derive(Debug, Clone, Default)]
pub(super) struct Disturbances {
    pub(super) outliers: Outliers,
    pub(super) hum: Vec<HumLine>,
    /// Offsets of the runs from the common one, where they differ.
    pub(super) offsets: RunOffsets,
}

impl Disturbances {
    fn are_as(&self, other: &Self) -> bool {
        /// Change of an amplitude that changes no bound.
        const SMALL: f64 = 0.02;
        let close = |(a, b): (&HumLine, &HumLine)| {
            (a.amplitude() - b.amplitude()).abs() <= SMALL * a.amplitude()
        };
        self.outliers.taken_out == other.outliers.taken_out
            && self.hum.len() == other.hum.len()
            && self.hum.iter().zip(&other.hum).all(close)
            && self.offsets.len() == other.offsets.len()
            && largest_difference(&self.offsets, &other.offsets)
                <= SMALL * self.offsets.iter().fold(0.0, |a: f64, b| a.max(b.abs()))
    }

    /// The runs of a record that they were taken out of, with their offsets again.
    pub(super) fn with_offsets(&self, record: &Record) -> Vec<Run> {
        let runs = record.runs().iter().enumerate();
        runs.map(|(index, run)| match self.offsets.get(index) {
            Some(offset) => run.with_output(run.output().iter().map(|y| y + offset).collect()),
            None => run.clone(),
        })
        .collect()
    }

    /// `record` without them.
    fn removed_from(&self, record: &Record) -> Record {
        if self.hum.is_empty() && self.outliers.taken_out.is_empty() && self.offsets.is_empty() {
            return record.clone();
        }
        let mut runs: Vec<Run> = record.runs().to_vec();
        for (index, run) in runs.iter_mut().enumerate() {
            let hum = |k: usize| self.hum.iter().map(|line| line.at(index, k)).sum::<f64>();
            let offset = self.offsets.get(index).copied().unwrap_or(0.0);
            let values = (0..).zip(run.output());
            let mut output: Vec<f64> = values.map(|(k, y)| y - hum(k) - offset).collect();
            for found in self
                .outliers
                .taken_out
                .iter()
                .filter(|found| found.run == index + 1)
            {
                output[found.sample..found.sample + found.samples].fill(f64::NAN);
            }
            *run = run.with_output(output);
        }
        record.with_runs(runs)
    }
}

/// A record without its disturbances, and the fit to it.
pub(super) struct Undisturbed {
    pub(super) record: Record,
    pub(super) disturbances: Disturbances,
    pub(super) candidate: Candidate,
    pub(super) estimate: Estimate,
}

impl Undisturbed {
    pub(super) fn of(record: &Record, options: &Options) -> Result<Self, Error> {
        let complete = record.with_held_inputs();
        let mut found = Self::without(Disturbances::default(), &complete, options)?;
        for _ in 0..TURNS {
            let next = found.searched(&complete);
            if found.disturbances.are_as(&next) {
                break;
            }
            let Ok(again) = Self::without(next, &complete, options) else {
                break;
            };
            found = again;
        }
        if found.disturbances.outliers.provisional {
            let disturbances = Disturbances {
                outliers: Outliers::default(),
                ..found.disturbances
            };
            return Self::without(disturbances, &complete, options);
        }
        Ok(found)
    }

    fn without(
        disturbances: Disturbances,
        complete: &Record,
        options: &Options,
    ) -> Result<Self, Error> {
        let record = disturbances.removed_from(complete);
        let candidate = Candidate::of_record(&record, options)?;
        let estimate = Estimate::new(&candidate.plan, &candidate.moments, Some(&record))?;
        Ok(Self {
            record,
            disturbances,
            candidate,
            estimate,
        })
    }

    /// The disturbances of `complete` in its errors.
    fn searched(&self, complete: &Record) -> Disturbances {
        let Estimate {
            information, fit, ..
        } = &self.estimate;
        let moments = &information.moments;
        let settling = self.candidate.plan.basis.settling();
        let mut next = Disturbances {
            outliers: self.disturbances.outliers.clone(),
            ..Disturbances::default()
        };
        let runs = next.removed_from(complete);
        next.offsets = run_offsets(&simulated_whole(&runs, moments, fit), settling);
        let runs = next.removed_from(complete);
        let rmse = (square(information, fit) / information.rows() as f64).sqrt();
        let step = Quantisation::of(complete, rmse).map_or(0.0, |found| found.step);
        // Rounding without dither repeats itself with the reference.
        if step == 0.0 {
            next.hum = hum(&simulated_whole(&runs, moments, fit));
        }
        next.outliers = Outliers::default();
        let runs = next.removed_from(complete);
        next.outliers = outliers(&simulated_whole(&runs, moments, fit), moments, fit, step);
        next
    }
}
