//! A recording whose commands wait for pulses on a clock of their own, with its commands at these pulses.
//!
//! Rows do not say when pulses came, nor how long their frame is by the clock of the recording. A servo model says it: with its delay shorter by the mean wait, pulses are [looked for](crate::analysis::command_times::pulse_search)
//! with which it is closest. Where that takes most of its errors away, these were the waits.

use crate::analysis::command_times::pulse_errors::{Predict, simulate_with_pulses};
use crate::analysis::command_times::pulse_search::{ClosestPulses, closest_pulses, least_error};
use crate::data::dataset::{Dataset, FRAME_S};
use servoid_identification::servo_model::{ServoModel, WaitsForPulses};
use servoid_identification::{Record, Run};

/// The share of its error that a servo leaves at the most where each command waits for its pulse, found anew: errors that have another cause stay nearly as they are.
const LEFT: f64 = 0.5;

/// The same of the servo that has the waits in its figures, which hide a part of what pulses take away.
const LEFT_AT_FIRST: f64 = 0.8;

/// Slopes of the moments along a run that are tried on each side, as parts of a frame from its middle to its ends: what the frame's length leaves open.
const SLOPES: i32 = 200;

/// A recording with its commands at their pulses.
pub(super) struct AtPulses<'r> {
    pub(super) record: Record<'r>,
    pub(super) waits: WaitsForPulses,
    /// The error (rms) of the servo that they were looked for with \[output\].
    rmse: f64,
}

/// That of `data`, where the errors of its `model`, with the controllers of the runs, may be those of commands that waited.
pub(super) fn at_pulses<'r>(
    data: &Dataset<'r>,
    model: &ServoModel,
    controllers: &[usize],
) -> Option<AtPulses<'r>> {
    let about = &data.about;
    // Waits that all changes have in common are in no error.
    let may_wait = about.commands_may_wait() && !about.moving_command && about.common_wait_s == 0.0;
    if !may_wait || model.covariance.valid().is_some() {
        return None;
    }
    let servo = model.clone().sooner(0.5 * FRAME_S);
    let least = LEFT_AT_FIRST * model.fit.rmse;
    let looked_up = each_run(&data.record, &servo, controllers, |run, predict| {
        Some(least_error(run, FRAME_S, predict)?.1)
    })?;
    let may_be_pulses = rms_of_runs(&data.record, &looked_up) < least;
    let found = may_be_pulses.then(|| closest(&data.record, &servo, controllers))??;
    (found.rmse < least).then_some(found)
}

/// Whether the servo with commands at their pulses leaves so much less of the errors of that `of_rows` that these were waits.
pub(super) fn were_waits(at_pulses: &ServoModel, of_rows: &ServoModel) -> bool {
    at_pulses.fit.rmse < LEFT * of_rows.fit.rmse
}

/// The record with the commands of each run at the pulses about every 20 ms with which `servo` is closest. Runs may be of other loggers, and days: each has a length of its own.
pub(super) fn closest<'r>(
    record: &Record<'r>,
    servo: &ServoModel,
    controllers: &[usize],
) -> Option<AtPulses<'r>> {
    let found = each_run(record, servo, controllers, |run, predict| {
        let found = closest_pulses(run, FRAME_S, predict)?;
        let in_force = found.in_force(run).ok()?.runs().first()?.clone();
        let delay_error_s = delay_error_s(run, &found);
        Some((in_force, found.rmse, found.frame_s, delay_error_s))
    })?;
    let errors: Vec<f64> = found.iter().map(|(_, rmse, ..)| *rmse).collect();
    let frames_s = found.iter().map(|(_, _, frame_s, _)| frame_s);
    let delay_errors_s = found.iter().map(|(.., delay_error_s)| *delay_error_s);
    let waits = WaitsForPulses {
        frame_s: frames_s.sum::<f64>() / found.len() as f64,
        // The servo has one delay: the run that leaves the least open bounds it.
        delay_error_s: delay_errors_s.reduce(f64::min)?,
    };
    let rmse = rms_of_runs(record, &errors);
    let runs = found.into_iter().map(|(run, ..)| run).collect();
    Some(AtPulses {
        record: record.try_with_runs(runs).ok()?,
        waits,
        rmse,
    })
}

/// What `of` each run, as a record of its own, is with what `servo` predicts of it; `None` where a run has none.
fn each_run<'r, T>(
    record: &Record<'r>,
    servo: &ServoModel,
    controllers: &[usize],
    of: impl Fn(&Record<'r>, Predict<'_, 'r>) -> Option<T>,
) -> Option<Vec<T>> {
    let of_run = |(number, run): (usize, &Run<'r>)| {
        let alone = record.try_with_runs(vec![run.clone()]).ok()?;
        let controller = controllers.get(number..=number).unwrap_or_default();
        of(&alone, &|run, _, pulses| {
            let pulses = pulses.map(|time_s| time_s / record.sample_period_s());
            simulate_with_pulses(servo, controller, &alone, run, pulses)
        })
    };
    record.runs().iter().enumerate().map(of_run).collect()
}

/// The root mean square of errors over all runs, from those of each.
fn rms_of_runs(record: &Record, errors: &[f64]) -> f64 {
    let samples = |run: &Run| run.output().iter().filter(|y| !y.is_nan()).count() as f64;
    let both = record.runs().iter().map(samples).zip(errors);
    let (squares, all) = both.fold((0.0, 0.0), |(squares, all), (samples, error)| {
        (squares + samples * error * error, all + samples)
    });
    (squares / all).sqrt()
}

/// By how much all pulses may come sooner or later, at the most \[s\], each change of a run with the same pulse as with those that were `found`: a delay that is longer or shorter by as much makes the same motion.
fn delay_error_s(record: &Record<'_>, found: &ClosestPulses) -> f64 {
    let mut runs = record.runs().iter().zip(&found.first_pulse_s);
    let of_run = runs.next().and_then(|(run, first_s)| {
        let pulses = [found.frame_s, (*first_s)?];
        Some(farthest_shift_s(run, record.sample_period_s(), pulses))
    });
    of_run.unwrap_or_default()
}

fn farthest_shift_s(run: &Run<'_>, period_s: f64, [frame_s, first_s]: [f64; 2]) -> f64 {
    let pairs = run.input().iter().zip(run.input().iter().skip(1));
    let changes = (1..)
        .zip(pairs)
        .filter(|(_, (before, after))| (*after - *before).abs() > 0.0);
    let half_s = 0.5 * run.len() as f64 * period_s;
    // Where along the run from -1 to 1, and the wait.
    let waits: Vec<(f64, f64)> = changes
        .map(|(row, _)| {
            let at_s = f64::from(row) * period_s;
            (at_s / half_s - 1.0, (first_s - at_s).rem_euclid(frame_s))
        })
        .collect();
    let farthest = |slope: i32| {
        let slope_s = frame_s * f64::from(slope) / f64::from(SLOPES);
        let sooner = waits.iter().map(|(along, wait)| -wait - slope_s * along);
        let later = waits
            .iter()
            .map(|(along, wait)| frame_s - wait - slope_s * along);
        let ends = [sooner.reduce(f64::max)?, later.reduce(f64::min)?];
        (ends[0] < ends[1]).then(|| ends[1].max(-ends[0]))
    };
    (-SLOPES..=SLOPES).filter_map(farthest).fold(0.0, f64::max)
}
