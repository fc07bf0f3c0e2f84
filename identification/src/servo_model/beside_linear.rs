//! Linear models beside the servo model, in its own measure: the fit of parts of the record that each has not seen.
//!
//! The parts are the folds of the [ladder](crate::servo_model::terms::ladder). For each fold, every model is identified again from the record
//! without the outputs of the fold, with the structure or the terms that the whole record gave it. It is simulated from the input
//! alone and predicts the fold. A run that the servo model begins at rest at its first output begins so in a linear model. The
//! samples that count are those that all models predict: of a run that begins in motion, a linear model knows nothing for N samples.

use super::estimate::{ServoModelOptions, fit_watched};
use super::model::{LinearKind, LinearModelFit, LinearModels, ServoModel};
use super::search_progress::Watch;
use super::search_setup::{CLIP, longest_delay_s};
use crate::data::{Moments, Record, Run};
use crate::error::Error;
use crate::estimation::{Coordinates, accurate_fit};
use crate::nonlinear::{split_by_direction, split_with};
use crate::numerics::{causal_filter, square_about_mean};
use crate::options::NoiseOrder;
use crate::results::{Model, command_before, fit_percent};
use crate::servo_model::descent::coordinates::Point;
use crate::servo_model::descent::fit::{Problem, clipped_square};
use crate::servo_model::descent::initial_state::find_starts;
use crate::servo_model::descent::starting_values::Shown;
use crate::servo_model::stretches::{FOLDS, Stretch, stretches};
use servoid_dynamics::{Grid, simulate};

/// Steps of the descent without a fold, from the servo of the whole record.
const STEPS: usize = 20;

/// [`fit_watched`], with linear models beside it: `linear`, which was identified from the same record, and the direction-split
/// model of its structure.
///
/// # Errors
/// As [`fit_watched`].
pub fn fit_beside(
    record: &Record,
    linear: &Model,
    options: &ServoModelOptions,
    watch: &dyn Watch,
) -> Result<ServoModel, Error> {
    let servo = fit_watched(record, options, watch)?;
    let linear_models = Dealt::new(record, &options.controllers, &servo).compare(&servo, linear);
    Ok(ServoModel {
        linear_models,
        ..servo
    })
}

/// The output of each run of the record.
type Outputs = Vec<Vec<f64>>;

/// A record dealt to folds.
struct Dealt<'a> {
    record: &'a Record<'a>,
    stretches: Vec<Stretch>,
    fold_of: Vec<usize>,
    grid: Grid,
    /// Errors beyond this are clipped, as on the ladder \[units of the output\].
    clip: f64,
}

impl<'a> Dealt<'a> {
    /// As the ladder deals it, with the starts of `servo`.
    fn new(record: &'a Record<'a>, controllers: &[usize], servo: &ServoModel) -> Self {
        let (mut parts, fold_of) = stretches(record, controllers);
        let grid = servo.grid(record.timing());
        find_starts(&mut parts, &servo.point(), &grid);
        let shown = Shown::by(&parts, record.sample_period_s());
        Self {
            record,
            stretches: parts,
            fold_of,
            grid,
            clip: CLIP * shown.output_sd,
        }
    }

    /// All models on the samples that all predict; `None` where there is no linear model, or no such sample.
    fn compare(&self, servo: &ServoModel, linear: &Model) -> Option<LinearModels> {
        let by_servo = self.errors(|fold| Some(self.by_servo(servo.point(), fold)))?;
        let others = self.by_linear_models(linear);
        let predicted = |k: usize| others.iter().all(|(_, errors)| !errors[k].is_nan());
        let judged: Vec<bool> = (0..by_servo.len())
            .map(|k| !by_servo[k].is_nan() && predicted(k))
            .collect();
        let samples_used = judged.iter().filter(|judged| **judged).count();
        if others.is_empty() || samples_used == 0 {
            return None;
        }
        let of = |(kind, errors): &(LinearKind, Vec<f64>)| {
            Some(LinearModelFit {
                kind: *kind,
                held_out_percent: self.fit_percent(errors, &judged)?,
            })
        };
        Some(LinearModels {
            samples_used,
            servo_model_percent: self.fit_percent(&by_servo, &judged)?,
            models: others.iter().map(of).collect::<Option<_>>()?,
        })
    }

    /// The errors of the linear models that every fold determines.
    fn by_linear_models(&self, like: &Model) -> Vec<(LinearKind, Vec<f64>)> {
        let refitted = |refit: &dyn Fn(&Record) -> Option<Refit>| {
            self.errors(|fold| Some(self.by_refit(&refit(&self.without(fold)?)?)))
        };
        let linear = refitted(&|left| Refit::linear(left, like));
        let split = split_by_direction(self.record, like).ok();
        let split = split.and_then(|split| {
            let order = NoiseOrder::Order(split.noise_order);
            refitted(&|left| Refit::direction_split(left, like, order))
        });
        let linear = linear.map(|errors| (LinearKind::Linear, errors));
        let split = split.map(|errors| (LinearKind::DirectionSplit, errors));
        linear.into_iter().chain(split).collect()
    }

    /// The error of each sample of the stretches by the model that has not seen its fold. NaN where the output is missing or
    /// not predicted. `None` where a fold has no model.
    fn errors(&self, predicted: impl Fn(usize) -> Option<Outputs>) -> Option<Vec<f64>> {
        let by_fold: Vec<Outputs> = (0..FOLDS).map(predicted).collect::<Option<_>>()?;
        let of_stretch = |part: &Stretch| -> Vec<f64> {
            let error = |(k, y): (usize, &f64)| {
                let fold = self.fold_of[part.block(k)];
                y - by_fold[fold][part.run][part.first + k]
            };
            part.output.iter().enumerate().map(error).collect()
        };
        Some(self.stretches.iter().flat_map(of_stretch).collect())
    }

    /// 100 (1 - |e| / |y - mean y|) over the samples judged, with errors clipped; `None` where a simulation grew without limit.
    fn fit_percent(&self, errors: &[f64], judged: &[bool]) -> Option<f64> {
        let outputs = self.stretches.iter().flat_map(|part| &part.output);
        let judged_only = |(value, judged): (&f64, &bool)| judged.then_some(*value);
        let outputs: Vec<f64> = outputs.zip(judged).filter_map(judged_only).collect();
        let errors = errors.iter().zip(judged).filter_map(judged_only);
        let error = errors.map(|error| clipped_square(error, self.clip)).sum();
        Some(fit_percent(error, square_about_mean(&outputs))).filter(|percent| percent.is_finite())
    }

    /// The record without the outputs of a fold; `None` where nothing is left to identify.
    fn without(&self, fold: usize) -> Option<Record<'a>> {
        let runs = self.record.runs().iter();
        let mut outputs: Outputs = runs.map(|run| run.output().to_vec()).collect();
        for part in &self.stretches {
            for k in 0..part.output.len() {
                if self.fold_of[part.block(k)] == fold {
                    outputs[part.run][part.first + k] = f64::NAN;
                }
            }
        }
        let runs = self.record.runs().iter().zip(outputs);
        let runs = runs.map(|(run, output)| run.with_output(output)).collect();
        let left = Record::new(self.record.sample_period_s(), runs).ok()?;
        Some(left.with_sample_phase(self.record.sample_phase_s()))
    }

    /// What a linear model predicts. A run that the servo model begins at rest begins so here, too.
    fn by_refit(&self, refit: &Refit) -> Outputs {
        let mut runs = self.record.runs().to_vec();
        for part in &self.stretches {
            let run = &mut runs[part.run];
            let begins_at_rest = part.first == 0 && part.start.rate == 0.0;
            if begins_at_rest
                && run.input_at_rest().is_none()
                && let Some(before) = command_before(run, &refit.step, refit.offset)
            {
                *run = run.clone().with_input_at_rest(before);
            }
        }
        runs.iter().map(&refit.simulate).collect()
    }

    /// What the servo predicts that is found again without a fold, from that of the whole record.
    fn by_servo(&self, mut point: Point, fold: usize) -> Outputs {
        let seen = |block: usize| self.fold_of[block] != fold;
        let problem = Problem {
            stretches: &self.stretches,
            grid: self.grid,
            used: &seen,
            clip: self.clip,
            longest_delay_s: longest_delay_s(self.record.sample_period_s()),
            converged: 1e-5,
            watch: &(),
        };
        problem.descend(&mut point, STEPS);
        let runs = self.record.runs().iter();
        let mut outputs: Outputs = runs.map(|run| vec![f64::NAN; run.len()]).collect();
        for part in &self.stretches {
            let physics = point.servo_of(part, |_, value| value);
            let output = &mut outputs[part.run][part.first..];
            simulate(
                &physics,
                &self.grid,
                &part.start,
                part.commands(),
                |k, y| output[k] = y,
            );
        }
        outputs
    }
}

/// The output of a run, from its input.
type Simulation = dyn Fn(&Run) -> Vec<f64>;

/// A linear model that was identified again.
struct Refit {
    /// Response to a unit step, the mean of both directions.
    step: Vec<f64>,
    offset: f64,
    simulate: Box<Simulation>,
}

impl Refit {
    /// The linear model of the structure of `like`, from `left`; `None` where that does not determine it.
    fn linear(left: &Record, like: &Model) -> Option<Self> {
        let basis = like.basis().ok()?;
        let order = like.structure.noise_order;
        let moments = Moments::of_record(left, basis.settling() + order, order + 1);
        // The noise leaves at least one degree of freedom.
        if moments.rows() < basis.frequencies() + order + 2 {
            return None;
        }
        let (coordinates, order) = (Coordinates::new(basis), NoiseOrder::Order(order));
        let (information, fit) =
            accurate_fit(&moments, Some(left), &coordinates, order, &like.noise.ar)?;
        let (impulse, offset) = (fit.impulse(), fit.offset(&information));
        Some(Self {
            step: basis.step_response(&fit.theta()),
            offset,
            simulate: Box::new(move |run| {
                let output = causal_filter(&impulse, run.input(), run.input_at_rest());
                output.into_iter().map(|y| y + offset).collect()
            }),
        })
    }

    /// The same of the direction-split model with the noise order `order`.
    fn direction_split(left: &Record, like: &Model, order: NoiseOrder) -> Option<Self> {
        let found = split_with(left, like.basis().ok()?, order, like.level(), |_| false).ok()?;
        Some(Self {
            step: found.mean_step(),
            offset: found.offset(),
            simulate: Box::new(move |run| found.simulate(run)),
        })
    }
}
