//! A recording whose commands are where they took effect.
//!
//! Of commands that [wait for the next pulse](super::pulse_frames), each row gets the mean of the command in force from this row to the next. Behind a linear servo,
//! what errors are left to a model of such a record are noise. A limit of the speed, play and friction stay what they are.

use super::pulse_frames::{PulseFrames, TimedAnswer};
use servoid_identification::results::Reason;
use servoid_identification::{Identification, Options, Record, Run, identify, identify_explained};

/// A run whose commands wait for regular pulses.
pub(crate) struct RunInFrames {
    /// Its place among the runs.
    pub(crate) run: usize,
    pub(crate) answers: Vec<TimedAnswer>,
    pub(crate) frames: PulseFrames,
}

impl RunInFrames {
    /// The run with its commands at their pulses.
    fn at_pulses<'r>(&self, record: &Record<'r>) -> Option<Run<'r>> {
        let period_s = record.sample_period_s();
        let wait_rows = |row: usize| {
            let at_s = row as f64 * period_s;
            let answer = (self.answers).binary_search_by(|answer| answer.at_s.total_cmp(&at_s));
            let answer = answer.ok().and_then(|index| self.answers.get(index));
            self.frames.wait_s(at_s, answer.map(|answer| answer.late_s)) / period_s
        };
        at_pulses(record.runs().get(self.run)?, wait_rows)
    }
}

/// Whether no errors that follow the motion are left to a model of the `runs` with their commands at their pulses.
pub(crate) fn is_linear_at_pulses(
    record: &Record<'_>,
    runs: &[RunInFrames],
    options: &Options,
) -> bool {
    let moved: Option<Vec<Run>> = runs.iter().map(|run| run.at_pulses(record)).collect();
    let moved = moved.and_then(|runs| record.try_with_runs(runs).ok());
    moved.is_some_and(|moved| is_linear(&moved, options))
}

/// The same where commands of `record` are in force from their pulses on, within the rows.
pub(crate) fn is_linear_in_force(record: &Record<'_>, options: &Options) -> bool {
    in_means(record).is_some_and(|means| is_linear(&means, options))
}

/// What speaks against bounds of a linear model of such a record.
pub(crate) fn reason_in_force(record: &Record<'_>) -> Option<Reason> {
    let model = identify(&in_means(record)?, &Options::default()).ok()?;
    model.level().withdrawn()
}

/// The record with the mean of the command in force in each row.
fn in_means<'r>(record: &Record<'r>) -> Option<Record<'r>> {
    let period_s = record.sample_period_s();
    let runs = record.runs().iter().map(|run| with_means(run, period_s));
    record.try_with_runs(runs.collect::<Option<_>>()?).ok()
}

/// Whether no errors that follow the motion are left to a model of `record`.
fn is_linear(record: &Record<'_>, options: &Options) -> bool {
    let found = identify_explained(record, options).ok();
    found.is_some_and(|Identification { explanation, .. }| {
        let linearity = explanation.linearity;
        explanation.model_errors.is_none()
            && linearity.is_some_and(|found| !found.errors_follow_motion())
    })
}

/// The `run` with the mean of the command in force in each row.
fn with_means<'r>(run: &Run<'r>, period_s: f64) -> Option<Run<'r>> {
    let Some(late_s) = run.late_inputs() else {
        return Some(run.clone());
    };
    let mut before = run.input_at_rest().or(run.input().first().copied())?;
    let rows = run.input().iter().zip(late_s);
    let means = rows.map(|(input, late_s)| {
        let mean = input + (before - input) * late_s / period_s;
        before = *input;
        mean
    });
    let means: Vec<f64> = means.collect();
    run.with_input(means).ok()
}

/// The `run`, with a change of the command at each row taking effect so many rows later as `wait_rows` says.
pub(crate) fn at_pulses<'r>(run: &Run<'r>, wait_rows: impl Fn(usize) -> f64) -> Option<Run<'r>> {
    run.with_input(later(run.input(), wait_rows)).ok()
}

/// Commands whose changes at each row take effect so many rows later as `wait_rows` says.
fn later(commands: &[f64], wait_rows: impl Fn(usize) -> f64) -> Vec<f64> {
    let mut input = commands.to_vec();
    let pairs = commands.iter().zip(commands.iter().skip(1));
    for (row, (before, after)) in (1..).zip(pairs) {
        let change = after - before;
        if change.is_nan() || change == 0.0 {
            continue;
        }
        let mut wait = wait_rows(row);
        for value in input.iter_mut().skip(row) {
            if wait <= 0.0 {
                break;
            }
            *value -= change * wait.min(1.0);
            wait -= 1.0;
        }
    }
    input
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn commands_are_where_they_took_effect() {
        let run = Run::new(vec![0.0, 1.0, 1.0, 1.0, 3.0, 3.0, 3.0], vec![0.0; 7]).unwrap();
        let moved = at_pulses(&run, |row| if row == 1 { 1.25 } else { 0.5 }).unwrap();
        assert_eq!(moved.input(), [0.0, 0.0, 0.75, 1.0, 2.0, 3.0, 3.0]);
    }

    /// Of two commands within a frame, the servo sees the second.
    #[test]
    fn a_command_that_another_overtakes_is_never_in_force() {
        let run = Run::new(vec![0.0, 5.0, 1.0, 1.0, 1.0], vec![0.0; 5]).unwrap();
        let moved = at_pulses(&run, |row| 3.0 - row as f64).unwrap();
        assert_eq!(moved.input(), [0.0, 0.0, 0.0, 1.0, 1.0]);
    }
}
