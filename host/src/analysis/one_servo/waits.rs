//! A recording whose commands wait for pulses on a clock of their own, with its commands at these pulses.
//!
//! Rows do not say when pulses came, nor how long their frame is by the clock of the recording. A servo model says it: with its delay shorter by the mean wait, pulses are [looked for](crate::analysis::command_times::pulse_search)
//! with which it is closest. Where that takes most of its errors away, these were the waits.

use super::pulse_clock::{FittedPulses, PulseClock};
use crate::analysis::command_times::pulse_errors::{Predict, in_force, simulate_with_pulses};
use crate::analysis::command_times::pulse_search::{
    ClosestPulses, RESOLUTION, closest_pulses, least_error,
};
use crate::data::dataset::{Dataset, FRAME_S};
use servoid_identification::results::Validation;
use servoid_identification::servo_model::{ServoModel, WaitsForPulses};
use servoid_identification::{Record, Run};

/// The share of its error that a servo leaves at the most where each command waits for its pulse, found anew: errors that have another cause stay nearly as they are.
const LEFT: f64 = 0.5;

/// The same of the servo that has the waits in its figures, which hide a part of what pulses take away.
const LEFT_AT_FIRST: f64 = 0.8;

/// Lengths of frames about which pulses are looked for, the usual one first \[s\]: each search finds those within half a percent.
const FRAMES_S: [f64; 5] = [FRAME_S, 0.0198, 0.0202, 0.0196, 0.0204];

/// All pulses are tried so much sooner and later, with a delay that is as much longer or shorter \[s\]: nothing says how much of the delay of the servo at hand is the wait.
const SHIFT_S: f64 = 4e-3;

/// Steps of that to each side, and of one of these.
const SHIFTS: i32 = 40;
const SHIFTS_BESIDE: i32 = 5;

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
    let may_be_pulses = |frame_s: &f64| {
        let looked_up = each_run(&data.record, &servo, controllers, |_, run, predict| {
            Some(least_error(run, *frame_s, predict)?.1)
        });
        looked_up.is_some_and(|errors| rms_of_runs(&data.record, &errors) < least)
    };
    let frame_s = FRAMES_S.into_iter().find(may_be_pulses)?;
    let found = closest(&data.record, &servo, controllers, frame_s)?;
    (found.rmse < least).then_some(found)
}

/// Whether the servo with commands at their pulses leaves so much less of the errors of that `of_rows` that these were waits.
pub(super) fn were_waits(at_pulses: &ServoModel, of_rows: &ServoModel) -> bool {
    at_pulses.fit.rmse < LEFT * of_rows.fit.rmse
}

/// The record with the commands of each run at the pulses about every `frame_s` with which `servo` is closest. Runs may be of other loggers, and days: each has a length of its own.
pub(super) fn closest<'r>(
    record: &Record<'r>,
    servo: &ServoModel,
    controllers: &[usize],
    frame_s: f64,
) -> Option<AtPulses<'r>> {
    let found = each_run(record, servo, controllers, |_, run, predict| {
        closest_pulses(run, frame_s, predict)
    })?;
    let errors_at = |shift_s: f64| {
        let sooner = servo.clone().sooner(shift_s);
        each_run(record, &sooner, controllers, |number, run, predict| {
            let pulses = found.get(number)?.later(shift_s).pulses_of_first_run()?;
            let run = run.runs().first()?;
            let pairs = run.output().iter().copied();
            let judged = Validation::of_pairs(pairs.zip(predict(run, 0, pulses)?))?;
            Some(judged.rmse)
        })
    };
    let rmse_at = |shift_s: &f64| {
        let errors = errors_at(*shift_s);
        errors.map_or(f64::INFINITY, |errors| rms_of_runs(record, &errors))
    };
    let shift_s = least_of(rmse_at, 0.0, SHIFT_S, SHIFTS);
    let shift_s = least_of(rmse_at, shift_s, SHIFT_S / f64::from(SHIFTS), SHIFTS_BESIDE);
    let found: Vec<ClosestPulses> = found.iter().map(|found| found.later(shift_s)).collect();
    let sooner = servo.clone().sooner(shift_s);
    let rmse = rmse_at(&shift_s);
    let fitted = each_run(record, &sooner, controllers, |number, run, _| {
        let [frame_s, first_s] = found.get(number)?.pulses_of_first_run()?;
        let controller = controllers.get(number..=number).unwrap_or_default();
        let squares = |tried: &Run<'r>| {
            let of_run = record.try_with_runs(vec![tried.clone()]).ok()?;
            let judged = sooner.validate(&of_run, controller).ok()?;
            Some(judged.rmse.powi(2) * judged.samples_used as f64)
        };
        let clock = PulseClock { frame_s, first_s };
        let run = run.runs().first()?;
        Some(clock.fitted(run, record.sample_period_s(), (&squares, rmse.powi(2))))
    })?;
    let open = fitted
        .iter()
        .map(FittedPulses::open_shifts)
        .collect::<Option<Vec<_>>>()?;
    // The servo has one delay, and all pulses are so much sooner or later alike.
    let least = open.iter().map(|[least, _]| *least).reduce(f64::max)?;
    let most = open.iter().map(|[_, most]| *most).reduce(f64::min)?;
    let clocks = fitted
        .iter()
        .map(|fitted| fitted.later(f64::midpoint(least, most)));
    let clocks: Vec<PulseClock> = clocks.collect();
    let in_rows = |time_s: f64| time_s / record.sample_period_s();
    let runs = record.runs().iter().zip(&clocks).map(|(run, clock)| {
        let pulses = [clock.frame_s, clock.first_s].map(in_rows);
        in_force(run, record.sample_period_s(), pulses)
    });
    Some(AtPulses {
        record: record.try_with_runs(runs.collect::<Option<_>>()?).ok()?,
        waits: WaitsForPulses {
            frame_s: clocks.iter().map(|clock| clock.frame_s).sum::<f64>() / clocks.len() as f64,
            // Moments and length of the frame are known to a step of their search.
            delay_error_s: 0.5 * (most - least).abs() + 2.0 * RESOLUTION * frame_s,
        },
        rmse,
    })
}

/// The value with the least `of` it among those so many steps to each side of the `middle`, up to `reach` from it.
fn least_of(of: impl Fn(&f64) -> f64, middle: f64, reach: f64, steps: i32) -> f64 {
    let all = (-steps..=steps).map(|step| middle + reach * f64::from(step) / f64::from(steps));
    let found = all.map(|value| (of(&value), value));
    let least = found.min_by(|a, b| a.0.total_cmp(&b.0));
    least.map_or(middle, |(_, value)| value)
}

/// What `of` each run, with its number and as a record of its own, is with what `servo` predicts of it; `None` where a run has none.
fn each_run<'r, T>(
    record: &Record<'r>,
    servo: &ServoModel,
    controllers: &[usize],
    of: impl Fn(usize, &Record<'r>, Predict<'_, 'r>) -> Option<T>,
) -> Option<Vec<T>> {
    let of_run = |(number, run): (usize, &Run<'r>)| {
        let alone = record.try_with_runs(vec![run.clone()]).ok()?;
        let controller = controllers.get(number..=number).unwrap_or_default();
        of(number, &alone, &|run, _, pulses| {
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
