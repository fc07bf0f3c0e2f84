//! Samples that were taken out of a record.

use serde::{Deserialize, Serialize};

use crate::data::Record;

/// Neighbouring samples that were taken out.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct TakenOut {
    /// Run, counted from 1.
    pub run: usize,
    /// First sample, counted from 0.
    pub sample: usize,
    /// Number of samples.
    pub samples: usize,
    /// Whether it has the shape of a glitch: a single sample that leaves the course of both sides. Anything else may be an error
    /// of a linear model.
    #[serde(default)]
    pub spike: bool,
    /// Whether it belongs to a stroke of a size that few others in the recording have, which the servo answers differently: no glitch, but a servo
    /// that is not linear.
    #[serde(default)]
    pub other_stroke: bool,
}

impl TakenOut {
    /// `record` without the spikes of what was taken out.
    #[must_use]
    pub fn without_spikes<'a>(taken_out: &[Self], record: &Record<'a>) -> Record<'a> {
        let spikes: Vec<Self> = taken_out
            .iter()
            .copied()
            .filter(|found| found.spike)
            .collect();
        Self::without(&spikes, record)
    }

    /// `record` without the samples that were taken out.
    pub(crate) fn without<'a>(taken_out: &[Self], record: &Record<'a>) -> Record<'a> {
        if taken_out.is_empty() {
            return record.clone();
        }
        let runs = record.runs().iter().enumerate().map(|(index, run)| {
            let mut output = run.output().to_vec();
            Self::blank(taken_out, index, &mut output);
            run.with_output(output)
        });
        record.with_runs(runs.collect())
    }

    /// Makes these samples of a run, counted from 0, missing ones.
    pub(crate) fn blank(taken_out: &[Self], run: usize, output: &mut [f64]) {
        for found in taken_out.iter().filter(|found| found.run == run + 1) {
            output[found.sample..found.sample + found.samples].fill(f64::NAN);
        }
    }
}
