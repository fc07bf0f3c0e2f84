//! Runs that begin elsewhere than where the servo comes to rest later under the same command.
//!
//! Play and friction leave a servo on the side from which it came. A run that begins at rest begins on a side that nobody recorded, and its first stroke is as much
//! longer or shorter. With d the distance, h the step response and G its final value, its output is that of the model and
//!
//! ```text
//! d (1 - h(k - c) / G)     with the first change of the command at sample c,     d before it,
//! ```
//!
//! a [column of each run](crate::diagnostics::residuals::run_columns) beside the regression. Where the command has two levels, a response that goes on for long after the servo rests explains d
//! as well, and has another final value.

use serde::{Deserialize, Serialize};

use crate::data::{Moments, Record, Run};
use crate::diagnostics::residuals::run_columns::RunColumns;
use crate::diagnostics::residuals::simulation_error::simulated_whole;
use crate::estimation::GlsFit;
use crate::numerics::{chi_square_upper_tail, dot};
use crate::thresholds::START_SIGNIFICANCE;

/// That runs begin elsewhere, which is left out of them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct StartElsewhere {
    /// The samples of each run before its command first changes; 0 where it does not begin at rest.
    pub samples: Vec<usize>,
    /// The largest distance of a run from where the servo comes to rest later \[output\].
    pub distance: f64,
    /// The probability of distances as large of runs that begin where the servo comes to rest later.
    pub chance: f64,
}

impl StartElsewhere {
    /// By a fit to `record`; `None` where the distances are not beyond chance.
    pub(crate) fn of(record: &Record<'_>, moments: &Moments, fit: &GlsFit) -> Option<Self> {
        let remaining = remaining(&fit.impulse())?;
        let simulated = simulated_whole(record, moments, fit);
        let begun: Vec<_> = (simulated.iter())
            .map(|run| (run, before_change(&run.run)))
            .filter(|(_, samples)| *samples > 0)
            .collect();
        let columns = begun
            .iter()
            .map(|(run, samples)| (&run.run, column(&run.run, *samples, &remaining)));
        let columns = RunColumns::new(columns, moments, fit)?;
        let scores = columns.scores(begun.iter().map(|(run, _)| *run), fit);
        let distances = columns.coefficients(&scores);
        let square = dot(&scores, &distances) / fit.variance;
        let chance = chi_square_upper_tail(square, distances.len());
        let distance = distances
            .into_iter()
            .max_by(|a, b| a.abs().total_cmp(&b.abs()))?;
        (chance < START_SIGNIFICANCE).then_some(Self {
            samples: record.runs().iter().map(before_change).collect(),
            distance,
            chance,
        })
    }

    /// Number of samples before the first changes.
    pub(crate) fn count(&self) -> usize {
        self.samples.iter().sum()
    }

    /// The runs from their first change on, after which nothing is known of what was before.
    pub(crate) fn left_out_of<'a>(&self, runs: &[Run<'a>]) -> Vec<Run<'a>> {
        let of_run = |(run, samples): (&Run<'a>, &usize)| match samples {
            0 => run.clone(),
            samples => run.without_start(*samples),
        };
        runs.iter().zip(&self.samples).map(of_run).collect()
    }
}

/// The samples of a run that begins at rest before its command first changes.
fn before_change(run: &Run<'_>) -> usize {
    let rest = run.input_at_rest();
    let change = run
        .input()
        .iter()
        .position(|u| rest.is_some_and(|rest| *u != rest));
    change.unwrap_or(0)
}

/// 1 - h/G of an impulse response.
fn remaining(impulse: &[f64]) -> Option<Vec<f64>> {
    let gain: f64 = impulse.iter().sum();
    let left = impulse.iter().scan(gain, |left, h| {
        *left -= h;
        Some(*left / gain)
    });
    (gain != 0.0).then(|| left.collect())
}

/// The column of a run that begins at rest, with these samples before its first change.
fn column(run: &Run<'_>, samples: usize, remaining: &[f64]) -> Vec<f64> {
    let before = std::iter::repeat_n(1.0, samples);
    let after = remaining.iter().copied().chain(std::iter::repeat(0.0));
    before.chain(after).take(run.len()).collect()
}
