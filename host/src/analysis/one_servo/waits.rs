//! A recording whose commands wait for pulses on a clock of their own, with its commands at these pulses.
//!
//! Rows do not say when pulses came, nor how long their frame is by the clock of the recording. A servo model says it: with its delay shorter by the mean wait, pulses are [looked for](crate::analysis::command_times::pulse_search)
//! with which it is closest. Where that takes most of its errors away, these were the waits.

use super::pulse_clock::{FittedPulses, PulseClock};
use crate::analysis::command_times::pulse_errors::{Predict, simulate_with_pulses};
use crate::analysis::command_times::pulse_frames::equal_hold;
use crate::analysis::command_times::pulse_search::{
    ClosestPulses, Lengths, OF_STATED, RESOLUTION, closest_pulses, least_error,
};
use crate::data::dataset::{Dataset, FRAME_S, command_changes};
use servoid_identification::results::{Bounds, Validation};
use servoid_identification::servo_model::{ServoModel, WaitsForPulses};
use servoid_identification::{Record, Run};

/// The share of what a servo lacks that it lacks at the most where each command waits for its pulse, found anew: errors that have another cause stay nearly as they are, or grow.
const LEFT: f64 = 0.5;

/// The share of its error that the servo at hand may have behind the pulses: it has waits in its figures, and may be off by as much as them. From far more no servo was found.
const LEFT_AT_FIRST: f64 = 1.2;

/// Changes of the command that a run has at the least: length and moment of its frame, and the delay, give fewer changes nearly any times.
const FEWEST_CHANGES: usize = 20;

/// How much of the delay of the servo at hand may be the wait \[s\]. Friction stands for waits, too: it is looked for without friction as well, whose delay may be too short then.
const SOONER_S: [f64; 4] = [0.01, 0.005, 0.0, -0.005];

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
    let change_often = data
        .record
        .runs()
        .iter()
        .all(|run| command_changes(run.input()).count() >= FEWEST_CHANGES);
    if !(about.commands_may_wait() && change_often) || model.covariance.valid().is_some() {
        return None;
    }
    let servos = [model.clone(), model.clone().without_friction()];
    let started = |servo: &ServoModel| SOONER_S.map(|sooner_s| servo.clone().sooner(sooner_s));
    let starts: Vec<ServoModel> = servos.iter().flat_map(started).collect();
    let looked_up = |servo: &ServoModel| {
        let errors = each_run(&data.record, servo, controllers, |_, run, predict| {
            least_error(run, FRAME_S, predict)
        })?;
        Some(rms_of_runs(&data.record, &errors))
    };
    let errors = starts
        .iter()
        .filter_map(|servo| Some((looked_up(servo)?, servo)));
    let (_, servo) = errors.min_by(|a, b| a.0.total_cmp(&b.0))?;
    let found = closest(&data.record, servo, controllers, FRAME_S)?;
    (found.rmse < LEFT_AT_FIRST * model.fit.rmse).then_some(found)
}

/// Whether the servo with commands at their pulses lacks so much less than that `of_rows` that these were waits.
pub(super) fn were_waits(at_pulses: &ServoModel, of_rows: &ServoModel) -> bool {
    let lacking = |model: &ServoModel| match model.covariance {
        Bounds::Valid(_) => 0.0,
        Bounds::Withdrawn(_) => model.fit.lacking.unwrap_or(model.fit.rmse),
    };
    at_pulses.fit.rmse < of_rows.fit.rmse && lacking(at_pulses) < LEFT * lacking(of_rows)
}

/// The record with the commands of each run at the pulses about every `frame_s` with which `servo` is closest. Runs may be of other loggers, and days: each has a length of its own.
pub(super) fn closest<'r>(
    record: &Record<'r>,
    servo: &ServoModel,
    controllers: &[usize],
    frame_s: f64,
) -> Option<AtPulses<'r>> {
    let found = each_run(record, servo, controllers, |_, run, predict| {
        closest_pulses(run, (frame_s, Lengths::Any), predict)
    })?;
    let (shift_s, rmse) = closest_shift(record, servo, controllers, &found);
    let found: Vec<ClosestPulses> = found.iter().map(|found| found.later(shift_s)).collect();
    let sooner = servo.clone().sooner(shift_s);
    // Moments and length of the frame are known to a step of their search each, and the least and the most shift to two of both.
    let step_s = 2.0 * RESOLUTION * frame_s;
    let apart_s = 2.0 * step_s;
    let fitted = fitted(record, &sooner, controllers, (&found, rmse), apart_s)?;
    let [least, most] = open_to_all(&fitted, apart_s)?;
    let later_s = f64::midpoint(least, most);
    let runs = record.runs().iter().zip(&fitted);
    let runs = runs.map(|(run, fitted)| fitted.in_force(run, record.sample_period_s(), later_s));
    let frames_s: Vec<f64> = fitted.iter().map(FittedPulses::frame_s).collect();
    Some(AtPulses {
        record: record.try_with_runs(runs.collect::<Option<_>>()?).ok()?,
        waits: WaitsForPulses {
            frame_s: frames_s.iter().sum::<f64>() / frames_s.len() as f64,
            delay_error_s: 0.5 * (most - least).abs() + step_s,
            length_is_open: is_open(record, frame_s),
        },
        rmse,
    })
}

/// Whether holds of one length end alike with frames of several of the lengths that are tried: with one frame more in a hold, or less.
fn is_open(record: &Record, frame_s: f64) -> bool {
    let hold_s = equal_hold(record).map(|rows| rows as f64 * record.sample_period_s());
    hold_s.is_some_and(|hold_s| frame_s / hold_s < 2.0 * OF_STATED)
}

/// By how much later the pulses that were `found` of each run come where `servo`, with a delay that is as much shorter, is closest to the record \[s\], and its error (rms) then \[output\].
fn closest_shift(
    record: &Record,
    servo: &ServoModel,
    controllers: &[usize],
    found: &[ClosestPulses],
) -> (f64, f64) {
    let rmse_at = |shift_s: &f64| {
        let sooner = servo.clone().sooner(*shift_s);
        let errors = each_run(record, &sooner, controllers, |number, run, predict| {
            let pulses = found.get(number)?.later(*shift_s).pulses_of_first_run()?;
            let run = run.runs().first()?;
            let pairs = run.output().iter().copied();
            let judged = Validation::of_pairs(pairs.zip(predict(run, 0, pulses)?))?;
            Some(judged.rmse)
        });
        errors.map_or(f64::INFINITY, |errors| rms_of_runs(record, &errors))
    };
    let shift_s = least_of(rmse_at, 0.0, SHIFT_S, SHIFTS);
    let shift_s = least_of(rmse_at, shift_s, SHIFT_S / f64::from(SHIFTS), SHIFTS_BESIDE);
    (shift_s, rmse_at(&shift_s))
}

/// The pulses that were `found` of each run, with its changes at those with which `servo` follows the motion; `rmse` is its error with the pulses as they were found.
fn fitted(
    record: &Record,
    servo: &ServoModel,
    controllers: &[usize],
    (found, rmse): (&[ClosestPulses], f64),
    apart_s: f64,
) -> Option<Vec<FittedPulses>> {
    each_run(record, servo, controllers, |number, run, _| {
        let [frame_s, first_s] = found.get(number)?.pulses_of_first_run()?;
        let controller = controllers.get(number..=number).unwrap_or_default();
        let squares = |tried: &Run| {
            let of_run = record.try_with_runs(vec![tried.clone()]).ok()?;
            let judged = servo.validate(&of_run, controller).ok()?;
            Some(judged.rmse.powi(2) * judged.samples_used as f64)
        };
        let clock = PulseClock { frame_s, first_s };
        let run = run.runs().first()?;
        Some(clock.fitted(
            run,
            record.sample_period_s(),
            (&squares, rmse.powi(2)),
            apart_s,
        ))
    })
}

/// How much later the pulses of all runs may come, as [of one](FittedPulses::open_shifts) \[s\]: the servo has one delay, and all are so much sooner or later alike.
fn open_to_all(fitted: &[FittedPulses], apart_s: f64) -> Option<[f64; 2]> {
    let of_runs = fitted.iter().map(|fitted| fitted.open_shifts(apart_s));
    let of_runs: Vec<[f64; 2]> = of_runs.collect::<Option<_>>()?;
    let open_to_both = |[a, b]: [f64; 2], [c, d]: [f64; 2]| [a.max(c), b.min(d)];
    let open = of_runs.into_iter().reduce(open_to_both);
    open.filter(|[least, most]| *least < most + apart_s)
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
