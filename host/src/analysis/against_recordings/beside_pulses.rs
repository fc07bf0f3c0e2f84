//! Commands that a recording has within a row of a pulse, which may have met this pulse or the next.
//!
//! A row says of a command's moment that it is between two rows. Where a pulse comes between them, the servo may have got it a whole frame sooner or later
//! than the recording has it; of rows of 2 ms and frames of 20 ms these are a tenth of all commands. What that makes of a prediction is found by commands of one row sooner and later
//! with the same pulses.

use crate::analysis::command_times::pulse_errors::Predict;
use crate::analysis::command_times::pulse_search::ClosestPulses;
use servoid_identification::{Record, Run};

/// How far predictions of `record` with the pulses `found` are from those with all commands a row sooner or later (rms), whichever is farther. `None` where nothing is predicted.
pub(super) fn rms_beside_pulses<'r>(
    record: &Record<'r>,
    found: &ClosestPulses,
    predict: Predict<'_, 'r>,
) -> Option<f64> {
    let predicted = |rows: isize| -> Option<Vec<Option<Vec<f64>>>> {
        let moved = record.runs().iter().map(|run| moved(run, rows));
        let moved = moved.collect::<Option<Vec<Run>>>()?;
        let with_pulses = moved.iter().zip(&found.first_pulse_s).enumerate();
        let predicted = with_pulses.map(|(number, (run, first_s))| {
            first_s.and_then(|first_s| predict(run, number, [found.frame_s, first_s]))
        });
        Some(predicted.collect())
    };
    let as_recorded = predicted(0)?;
    let farther = |rows: isize| {
        let other = predicted(rows)?;
        let runs = as_recorded.iter().zip(&other);
        let known = runs.filter_map(|(a, b)| a.as_ref().zip(b.as_ref()));
        let squares = known.flat_map(|(a, b)| a.iter().zip(b).map(|(a, b)| (a - b).powi(2)));
        let known: Vec<f64> = squares.filter(|square| square.is_finite()).collect();
        let mean = known.iter().sum::<f64>() / known.len() as f64;
        mean.is_finite().then(|| mean.sqrt())
    };
    [-1, 1].into_iter().filter_map(farther).reduce(f64::max)
}

/// The run with its commands so many rows later.
fn moved<'r>(run: &Run<'r>, rows: isize) -> Option<Run<'r>> {
    let last = run.len().checked_sub(1)?;
    let from = |k: usize| k.saturating_add_signed(-rows).min(last);
    let input: Option<_> = (0..run.len())
        .map(|k| run.input().get(from(k)).copied())
        .collect();
    run.with_input(input?).ok()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::command_times::pulse_errors::with_pulses;

    /// Levels of 50 rows of 2 ms, the first so many rows shorter.
    fn found(shorter: usize) -> f64 {
        let input: Vec<f64> = (shorter..2000).map(|k| [0.0, 8.0][k / 50 % 2]).collect();
        let record = Record::of_run(0.002, input.clone(), input).unwrap();
        let pulses = ClosestPulses {
            frame_s: 0.02,
            frame_step_s: 1e-6,
            first_pulse_s: vec![Some(0.0)],
            rmse: 0.0,
            rmse_as_stated: 0.0,
            largest_rmse: 0.0,
        };
        let follow = |run: &Run<'_>, _: usize, pulses: [f64; 2]| {
            let held = with_pulses(run, pulses.map(|time_s| time_s / 0.002))?;
            Some(held.input().to_vec())
        };
        rms_beside_pulses(&record, &pulses, &follow).unwrap()
    }

    /// A frame of ten rows in each level of 50.
    #[test]
    fn commands_at_a_pulse_may_have_met_the_next() {
        let all = 8.0 * (10.0f64 / 50.0).sqrt();
        assert!((found(0) - all).abs() < 0.02 * all, "{}", found(0));
        assert!((found(9) - all).abs() < 0.02 * all, "{}", found(9));
        assert_eq!(found(5), 0.0);
    }
}
