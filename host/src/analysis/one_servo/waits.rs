//! A recording whose commands wait for pulses on a clock of their own, with its commands at these pulses.
//!
//! Rows do not say when pulses came, nor how long their frame is by the clock of the recording. A servo model says it: with its delay shorter by the mean wait, pulses are [looked for](crate::analysis::command_times::pulse_search)
//! with which it is closest. Where that takes most of its errors away, these were the waits.

use crate::analysis::command_times::pulse_errors::simulate_with_pulses;
use crate::analysis::command_times::pulse_search::{ClosestPulses, closest_pulses, least_error};
use crate::data::dataset::{Dataset, FRAME_S};
use servoid_identification::results::Reason;
use servoid_identification::servo_model::{ServoModel, WaitsForPulses};
use servoid_identification::{Record, Run};

/// The share of its error that a servo leaves at the most where each command waits for its pulse: errors that have another cause stay nearly as they are.
const LEFT: f64 = 0.5;

/// The same with errors that are looked up, at moments beside the right ones.
const LEFT_LOOKED_UP: f64 = 0.8;

/// Slopes of the moments along a run that are tried on each side, as parts of a frame from its middle to its ends: what the frame's length leaves open.
const SLOPES: i32 = 200;

/// A recording with its commands at their pulses.
pub(super) struct AtPulses<'r> {
    pub(super) record: Record<'r>,
    pub(super) waits: WaitsForPulses,
    /// The error (rms) of the servo that they were looked for with \[output\].
    rmse: f64,
}

/// That of `data`, where the errors of its `model`, with the controllers of the runs, show that commands waited.
pub(super) fn at_pulses<'r>(
    data: &Dataset<'r>,
    model: &ServoModel,
    controllers: &[usize],
) -> Option<AtPulses<'r>> {
    let about = &data.about;
    // Waits that all changes have in common are in no error.
    let may_wait = about.commands_may_wait() && !about.moving_command && about.common_wait_s == 0.0;
    if !may_wait || model.covariance.withdrawn() != Some(Reason::ErrorsNotNoise) {
        return None;
    }
    let servo = model.clone().sooner(0.5 * FRAME_S);
    let (frame_s, looked_up) = searched(&data.record, &servo, controllers, least_error)?;
    if looked_up > LEFT_LOOKED_UP * model.fit.rmse {
        return None;
    }
    let found = closest(&data.record, &servo, controllers, frame_s)?;
    (found.rmse < LEFT * model.fit.rmse).then_some(found)
}

/// The record with its commands at the pulses about every `frame_s` with which `servo` is closest.
pub(super) fn closest<'r>(
    record: &Record<'r>,
    servo: &ServoModel,
    controllers: &[usize],
    frame_s: f64,
) -> Option<AtPulses<'r>> {
    let found = searched(record, servo, controllers, |record, _, predict| {
        closest_pulses(record, frame_s, predict)
    })?;
    Some(AtPulses {
        record: found.in_force(record).ok()?,
        rmse: found.rmse,
        waits: WaitsForPulses {
            frame_s: found.frame_s,
            delay_error_s: delay_error_s(record, &found),
        },
    })
}

/// What a `search` for pulses finds about the usual frame.
fn searched<'r, T>(
    record: &Record<'r>,
    servo: &ServoModel,
    controllers: &[usize],
    search: impl Fn(
        &Record<'r>,
        f64,
        &dyn Fn(&Run<'r>, usize, [f64; 2]) -> Option<Vec<f64>>,
    ) -> Option<T>,
) -> Option<T> {
    let predict = |run: &Run<'r>, number: usize, pulses: [f64; 2]| {
        let pulses = pulses.map(|time_s| time_s / record.sample_period_s());
        let controller = controllers.get(number..=number).unwrap_or_default();
        simulate_with_pulses(servo, controller, record, run, pulses)
    };
    search(record, FRAME_S, &predict)
}

/// By how much all pulses may come sooner or later, at the most \[s\], each change with the same pulse as with those that were `found`: a delay that is longer or shorter by as much makes the same motion. Of several runs, the one
/// that allows for the least.
fn delay_error_s(record: &Record<'_>, found: &ClosestPulses) -> f64 {
    let runs = record.runs().iter().zip(&found.first_pulse_s);
    let of_runs = runs.filter_map(|(run, first_s)| {
        let pulses = [found.frame_s, (*first_s)?];
        Some(farthest_shift_s(run, record.sample_period_s(), pulses))
    });
    of_runs.reduce(f64::min).unwrap_or_default()
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
