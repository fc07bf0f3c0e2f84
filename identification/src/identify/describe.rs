//! The model with its bounds and metrics, and the explanation of its structure.

use super::allowances::Allowances;
use super::assess::figures_of_merit;
use super::fitted::Fitted;
use super::responses::Responses;
use super::task::Task;
use crate::data::{Run, Timing};
use crate::diagnostics::{
    AllowedEnd, Bank, CommandNoise, Explanation, InexactCommands, PriorOutcome, Resolution,
    RunComparison, RunOffsets, ServoStopped, SlowServo, TimeFault, TravelEnd, Validity,
    ValidityEvidence, contradicted_rest, gain_drift, noise_of_commands,
};
use crate::estimation::{Excitation, Noise};
use crate::numerics::matrix_rows::to_rows;
use crate::results::{
    Bounds, FrequencyBounds, FrequencyResponse, MODEL_SCHEMA, Measured, MetricBounds, Metrics,
    Model, ParameterBounds, Residuals, SelectedBy, StepBounds, StepResponse, Structure,
};
use crate::selection::{hidden_end, longest_settling};
use crate::thresholds::UNSETTLED_END;

/// Whether bounds hold, decided before any are drawn.
pub(super) fn validity(
    task: &Task<'_>,
    fitted: &Fitted,
    responses: &Responses,
    allowances: &Allowances,
) -> Validity {
    let (plan, estimate) = (&fitted.candidate.plan, &fitted.estimate);
    let moments = &estimate.information.moments;
    let unsettled =
        fitted.slow_end.is_some() || still_moves(fitted, responses, allowances.step.rounding);
    let evidence = ValidityEvidence {
        basis: plan.basis,
        selected_by: plan.selected_by,
        sample_period_s: fitted.candidate.moments.sample_period_s(),
        misfit: fitted.misfit.as_ref(),
        excitation: excitation(fitted, allowances),
        quantised: allowances.quantisation.is_some(),
        unsettled,
        stopped: task.recorded.and_then(ServoStopped::of),
        time_fault: (task.recorded.zip(task.record))
            .and_then(|(recorded, record)| TimeFault::of(recorded, record, moments, &estimate.fit)),
        travel_ends: travel_ends(task, fitted),
        gain_drift: (task.record).and_then(|record| gain_drift(record, moments, &estimate.fit)),
        slow_servo: slow_servo(task, fitted, unsettled),
        end_is_unseen: fitted.end_is_unseen,
        closed_loop: is_closed_loop(fitted),
        // What a caller leaves out is in the errors, and inputs to come show it where they were planned.
        lags_are_mixed: (fitted.feedback).is_some_and(|found| {
            found.mixes_lags() && (found.smooth || plan.selected_by == SelectedBy::Auto)
        }),
        excited_by_errors: (fitted.inexact_commands)
            .filter(|found| found.shift.is_none())
            .map(|found| found.errors),
        gain: estimate.fit.theta()[0],
        step: &responses.step_values,
        truncation_bias: allowances.step.truncation,
    };
    Validity::new(&evidence, task.options.level)
}

/// A servo that is slower than the longest settling time, where something speaks against bounds.
fn slow_servo(task: &Task<'_>, fitted: &Fitted, unsettled: bool) -> Option<SlowServo> {
    let asked = (fitted.misfit.is_some() || unsettled) && !is_closed_loop(fitted);
    let record = task.recorded.filter(|_| asked)?;
    let longest = longest_settling(record, task.options.longest_settling).ok()?;
    SlowServo::of(record, longest)
}

fn travel_ends(task: &Task<'_>, fitted: &Fitted) -> [Option<TravelEnd>; 2] {
    let estimate = &fitted.estimate;
    let Some(recorded) = task.recorded else {
        return [None; 2];
    };
    let is_linear = is_linear(task, fitted);
    let mut no_errors = task.disturbances.that_are_no_errors();
    if !is_linear {
        // The mean error of a run in which the model is lost is no zero of a sensor: rests show that by themselves.
        no_errors.offsets = RunOffsets::default();
    }
    let record = no_errors.removed_from(recorded);
    let fit = (&estimate.information.moments, &estimate.fit);
    TravelEnd::both(&record, is_linear, fit)
}

/// Whether a linear servo describes the record.
fn is_linear(task: &Task<'_>, fitted: &Fitted) -> bool {
    let follows_motion = fitted.linearity.is_some_and(|found| found.is_rejected());
    let other_strokes = task.disturbances.outliers.other_strokes();
    // What moves where the output is seen at rest is an answer to the steps before.
    let moves_at_rest = fitted.candidate.moved_until().is_some();
    fitted.misfit.is_none() && !follows_motion && !other_strokes && !moves_at_rest
}

fn is_closed_loop(fitted: &Fitted) -> bool {
    let are_noise = fitted.misfit.is_none() && !fitted.errors_follow_motion();
    fitted
        .feedback
        .is_some_and(|found| found.is_evident() || (are_noise && found.is_found()))
}

/// Whether the response still moves when the longest N ends, by more than the steps of the sensor explain, up to `rounding`.
fn still_moves(fitted: &Fitted, responses: &Responses, rounding: f64) -> bool {
    let choice = fitted.candidate.plan.choice.as_ref();
    let Some(choice) = choice.filter(|choice| !choice.settled && fitted.misfit.is_none()) else {
        return false;
    };
    let Some((_, before_end)) = responses.step.sd.split_last() else {
        return false;
    };
    let sd = before_end.iter().copied().fold(0.0, f64::max);
    let size = fitted.estimate.fit.theta()[0].abs();
    let seen = choice.longest as f64 / choice.detected as f64;
    hidden_end((sd - rounding).max(0.0) / size, seen) > UNSETTLED_END
}

fn excitation(fitted: &Fitted, allowances: &Allowances) -> Excitation {
    Excitation {
        bounded: allowances.bounded,
        ..Excitation::of(&fitted.estimate.information.moments)
    }
}

/// The model without tests of its residuals and advice.
pub(super) fn model(
    task: &Task<'_>,
    fitted: &Fitted,
    responses: &Responses,
    allowances: &Allowances,
    validity: &Validity,
) -> Model {
    let (plan, moments) = (&fitted.candidate.plan, &fitted.candidate.moments);
    let (information, fit) = (&fitted.estimate.information, &fitted.estimate.fit);
    let (basis, level) = (&plan.basis, task.options.level);
    let timing = Timing {
        sample_period_s: moments.sample_period_s(),
        sample_phase_s: moments.sample_phase_s(),
    };
    let period = timing.sample_period_s;
    let theta = fit.theta();
    let n = theta.len();
    let covariance = fit.covariance().as_ref().submatrix(0, 0, n, n).to_owned();
    let step_bounds = StepBounds::new(
        &responses.step_values,
        &responses.step,
        level,
        allowances.step,
    );
    let frequency_bounds = FrequencyBounds::new(
        &responses.frequency_values,
        &responses.frequency,
        level,
        allowances.frequency.clone(),
    );
    let omega_rad_s: Vec<f64> = responses.omegas.iter().map(|w| w / period).collect();
    let rows = to_rows(&covariance);
    let measured = Measured {
        basis: *basis,
        theta: &theta,
        covariance,
        step: &responses.step_values,
        step_bounds: &step_bounds,
        omega_rad_s: &omega_rad_s,
        frequency_bounds: &frequency_bounds,
        timing,
    };
    let metrics = Metrics::new(
        &measured,
        validity.level.map(|level| MetricBounds { level }),
    );
    let metrics = validity.supported(metrics);
    Model {
        schema: MODEL_SCHEMA,
        sample_period_s: period,
        sample_phase_s: timing.sample_phase_s,
        structure: Structure {
            settling_samples: basis.settling(),
            frequencies: n,
            noise_order: fit.ar.len(),
            selected_by: plan.selected_by,
        },
        theta,
        bounds: validity.level.map(|level| ParameterBounds {
            level,
            covariance: rows,
        }),
        offset: fit.offset(information),
        run_offsets: task.disturbances.offsets.clone(),
        run_slopes: (task.disturbances.trends.iter())
            .map(|slope| slope / period)
            .collect(),
        noise: Noise {
            ar: fit.ar.clone(),
            sigma: fit.variance.sqrt(),
        },
        metrics,
        linear: is_linear(task, fitted),
        step: StepResponse::new(
            period,
            responses.step_values.clone(),
            validity.level.map(|_| step_bounds),
        ),
        frequency: FrequencyResponse::new(
            period,
            &responses.omegas,
            &responses.frequency_values,
            validity.level.map(|_| frequency_bounds),
        ),
        band_estimate: None,
        fit: figures_of_merit(fitted, task.disturbances.count()),
        residuals: Residuals::default(),
        iterations: fit.iterations,
        converged: fit.converged,
        stops: validity.stops(),
        advice: Vec::new(),
    }
}

/// The change of the output over each run that was taken out as a trend.
fn drift(task: &Task<'_>) -> Vec<f64> {
    let runs = task.record.map_or(&[][..], |record| record.runs());
    let over = |(slope, run): (&f64, &Run)| slope * (run.len() as f64 - 1.0);
    task.disturbances
        .trends
        .iter()
        .zip(runs)
        .map(over)
        .collect()
}

/// How the model came about.
pub(super) fn explanation(
    task: &Task<'_>,
    fitted: Fitted,
    responses: &Responses,
    allowances: &Allowances,
    (model, runs): (&Model, Option<RunComparison>),
) -> Explanation {
    let excitation = excitation(&fitted, allowances);
    let (plan, estimate) = (fitted.candidate.plan, fitted.estimate);
    let information = &estimate.information;
    let level = model.level();
    Explanation {
        settling: plan.choice,
        frequencies: plan
            .banks
            .iter()
            .map(|bank| Bank::new(bank, level))
            .collect(),
        noise_orders: estimate.fit.orders,
        path: information.path(),
        condition: estimate.fit.solution.condition,
        rows: information.rows(),
        degrees_of_freedom: level
            .valid()
            .map(|_| responses.step.degrees_of_freedom.clone()),
        model_errors: fitted.misfit,
        linearity: fitted.linearity,
        at_rest: task
            .record
            .and_then(|record| contradicted_rest(record, model)),
        start: task.disturbances.start.clone(),
        excitation: Some(excitation),
        resolution: allowances
            .quantisation
            .map(|found| Resolution::new(&found, level)),
        taken_out: task.disturbances.outliers.taken_out.clone(),
        hum: (task.disturbances.hum.iter())
            .map(|line| line.described(model.sample_period_s))
            .collect(),
        command_noise: command_noise(task, fitted.inexact_commands, level),
        drift: drift(task),
        uneven_noise: fitted.uneven,
        hold_scatter: fitted.hold_scatter,
        slow_end: fitted.slow_end,
        allowed_end: (fitted.allowed_end).map(|found| AllowedEnd::new(found, level)),
        feedback: fitted.feedback,
        prior: fitted
            .prior
            .map(|outcome| PriorOutcome::beside(outcome, level)),
        runs,
    }
}

fn command_noise(
    task: &Task<'_>,
    allowed_for: Option<InexactCommands>,
    level: Bounds<f64>,
) -> Option<CommandNoise> {
    let sd = noise_of_commands(task.recorded?)?;
    let shift = level.valid().and_then(|_| allowed_for?.shift);
    Some(CommandNoise { sd, shift })
}
