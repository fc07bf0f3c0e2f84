//! From a record, or its moments, to a model.
//!
//! The story: moments are collected in one pass and a structure is planned from them; the plan is
//! carried out by generalised least squares; what its errors say may change the plan; the
//! responses get their bands and the metrics their intervals; tests and advice come last.

mod assess;
mod collected;
mod estimate;
mod plan;
mod reselection;

pub(crate) use estimate::WELL_CONDITIONED;

use crate::data::moments::Moments;
use crate::data::quantisation::Quantisation;
use crate::data::record::Record;
use crate::data::timing::Timing;
use crate::diagnostics::advice::{self, Evidence};
use crate::diagnostics::explanation::Explanation;
use crate::diagnostics::initial_rest;
use crate::diagnostics::run_scatter::RunComparison;
use crate::diagnostics::validity;
use crate::error::Error;
use crate::estimation::excitation::Excitation;
use crate::estimation::gls::MAX_AUTO_ORDER;
use crate::estimation::noise_model::Noise;
use crate::estimation::truncation::Truncation;
use crate::estimation::variance::CurveVariance;
use crate::numerics::linear_algebra::times;
use crate::numerics::matrix_rows::to_rows;
use crate::options::{Frequencies, NoiseOrder, Options};
use crate::results::frequency_response::{self, FrequencyBounds, FrequencyResponse, frequency_map};
use crate::results::metrics::Metrics;
use crate::results::metrics::measured::Measured;
use crate::results::model::{Model, ParameterBounds, SCHEMA, Structure};
use crate::results::residuals::Residuals;
use crate::results::step_response::{Biases, StepBounds, StepResponse};
use crate::results::validity::Bounds;

use collected::Collected;
use estimate::Estimate;
use plan::{Plan, check_rows};
use reselection::Considered;

/// A model, and how it came about.
#[derive(Debug, Clone)]
pub struct Identification {
    /// The model.
    pub model: Model,
    /// What was considered and why this was chosen.
    pub explanation: Explanation,
}

/// Identifies the servo behind a record.
///
/// # Errors
/// One sentence that says what is missing: too few samples, no excitation, an option that does not
/// fit the data.
pub fn identify(record: &Record, options: &Options) -> Result<Model, Error> {
    identify_explained(record, options).map(|identification| identification.model)
}

/// [`identify`], with the choice of structure laid open.
///
/// # Errors
/// As [`identify`].
pub fn identify_explained(record: &Record, options: &Options) -> Result<Identification, Error> {
    options.check()?;
    let (collected, plan) = Collected::from_record(record, options)?;
    Pipeline {
        record: Some(record),
        options,
        plan,
        collected,
    }
    .run()
}

/// Identifies from moments alone, as saved or collected live. The settling time can be at most the
/// input lags less the noise order; residual tests that need the samples are left out, and so is
/// the fallback to QR.
///
/// # Errors
/// As [`identify`]; also when the moments have too few lags for the options.
pub fn identify_moments(moments: &Moments, options: &Options) -> Result<Identification, Error> {
    options.check()?;
    let (collected, plan) = Collected::from_moments(moments, options)?;
    Pipeline {
        record: None,
        options,
        plan,
        collected,
    }
    .run()
}

/// Lags that the noise model may need.
fn noise_lags(order: NoiseOrder) -> usize {
    match order {
        NoiseOrder::Auto => MAX_AUTO_ORDER,
        NoiseOrder::Order(order) => order,
    }
}

/// Everything that one identification works with.
struct Pipeline<'a> {
    record: Option<&'a Record>,
    options: &'a Options,
    plan: Plan,
    collected: Collected,
}

impl Pipeline<'_> {
    fn run(mut self) -> Result<Identification, Error> {
        check_rows(&self.collected.moments, self.plan.basis.frequencies())?;
        let considered = self.estimate()?;
        let Considered {
            estimate,
            linearity,
            model_errors,
        } = &considered;
        let linear = model_errors.is_none() && !linearity.is_some_and(|found| found.is_rejected());
        // A bank that is left with the gain alone, of an input without steps, is no step response. It
        // may be what predicts best all the same, or have been asked for.
        let asked = matches!(self.options.frequencies, Frequencies::Count(_));
        if self.plan.basis.highest() == 0 && model_errors.is_none() && !asked {
            let excitation = Excitation::of(&estimate.information.moments);
            return Err(match excitation.is_smooth() {
                true => Error::NoDetail,
                false => Error::Unanswered,
            });
        }
        let responses = Responses::new(estimate);
        let truncation = self.truncation(estimate, &responses);
        let excitation = Excitation {
            bounded: !matches!(truncation, LeftOut::Anything),
            ..Excitation::of(&estimate.information.moments)
        };
        let resolution = self.resolution(estimate);
        let mut model = self.describe(estimate, &responses, truncation, resolution);
        model.residuals = self.residuals(&model, estimate, *linearity);
        let degrees_of_freedom = responses.step.degrees_of_freedom;
        let record = (excitation, resolution);
        let explanation = self.explain(&model, considered, degrees_of_freedom, record);
        model.linear = linear;
        model.metrics = validity::supported_metrics(&explanation, &model);
        let withdrawn = validity::reason_against_bounds(&explanation, &model);
        model.advice = advice::gather(&Evidence {
            model: &model,
            withdrawn,
            explanation: &explanation,
            options: self.options,
            samples: self.collected.moments.samples(),
        });
        if let Some(reason) = withdrawn {
            model.withdraw(reason);
        }
        Ok(Identification { model, explanation })
    }

    /// The model with its bands and metrics; tests of its residuals and advice are still to come.
    fn describe(
        &self,
        estimate: &Estimate,
        responses: &Responses,
        left_out: LeftOut,
        resolution: Option<Quantisation>,
    ) -> Model {
        let Estimate {
            information, fit, ..
        } = estimate;
        let (basis, level) = (&self.plan.basis, self.options.level);
        let timing = Timing {
            sample_period_s: self.collected.moments.sample_period_s(),
            sample_phase_s: self.collected.moments.sample_phase_s(),
        };
        let theta = fit.theta();
        let n = theta.len();
        let covariance = fit.covariance().as_ref().submatrix(0, 0, n, n).to_owned();
        let value = basis.step_response(&theta);
        let period = timing.sample_period_s;
        let (truncation, mut frequency_bias) = left_out.biases(&value, &responses.frequency_values);
        let rounding = resolution.map_or(0.0, |found| found.allowance);
        if let Some(found) = resolution {
            frequency_bias.resize(responses.omegas.len(), 0.0);
            for (bias, omega) in frequency_bias.iter_mut().zip(&responses.omegas) {
                *bias += found.allowance_at(*omega, basis.settling());
            }
        }
        let biases = Biases {
            truncation,
            rounding,
        };
        let step_bounds = StepBounds::new(&value, &responses.step, level, biases);
        let frequency_values = &responses.frequency_values;
        let frequency_bounds = FrequencyBounds::new(
            frequency_values,
            &responses.frequency,
            level,
            frequency_bias,
        );
        let omega_rad_s: Vec<f64> = responses.omegas.iter().map(|w| w / period).collect();
        let parameter_bounds = ParameterBounds {
            level,
            covariance: to_rows(&covariance),
        };
        let metrics = Metrics::new(&Measured {
            basis: *basis,
            theta: &theta,
            covariance,
            step: &value,
            step_bounds: &step_bounds,
            omega_rad_s: &omega_rad_s,
            frequency_bounds: &frequency_bounds,
            timing,
        });
        Model {
            schema: SCHEMA,
            sample_period_s: period,
            sample_phase_s: timing.sample_phase_s,
            structure: Structure {
                settling_samples: basis.settling(),
                frequencies: n,
                noise_order: fit.ar.len(),
                selected_by: self.plan.selected_by,
            },
            theta,
            bounds: Bounds::Valid(parameter_bounds),
            offset: fit.offset(information),
            noise: Noise {
                ar: fit.ar.clone(),
                sigma: fit.variance.sqrt(),
            },
            metrics,
            linear: true,
            step: StepResponse::new(period, value, Bounds::Valid(step_bounds)),
            frequency: FrequencyResponse::new(
                period,
                &responses.omegas,
                frequency_values,
                Bounds::Valid(frequency_bounds),
            ),
            fit: self.figures_of_merit(estimate),
            residuals: Residuals::default(),
            iterations: fit.iterations,
            converged: fit.converged,
            advice: Vec::new(),
        }
    }

    /// The steps of the sensor, where they are larger than the noise.
    fn resolution(&self, estimate: &Estimate) -> Option<Quantisation> {
        Quantisation::of(self.record?, self.figures_of_merit(estimate).rmse)
    }

    /// What the frequencies that the bank leaves out may do to the responses.
    fn truncation(&self, estimate: &Estimate, responses: &Responses) -> LeftOut {
        let Estimate {
            information, fit, ..
        } = estimate;
        let basis = &self.plan.basis;
        if basis.is_complete() {
            return LeftOut::Nothing;
        }
        let (theta, covariance) = (fit.theta(), fit.covariance());
        let sd: Vec<f64> = (0..theta.len())
            .map(|k| covariance[(k, k)].max(0.0).sqrt())
            .collect();
        Truncation::new(
            &information.moments,
            basis,
            &fit.ar,
            (&theta, &sd),
            self.plan.roll_off,
            &responses.omegas,
        )
        .map_or(LeftOut::Anything, LeftOut::Bounded)
    }

    fn explain(
        &mut self,
        model: &Model,
        considered: Considered,
        degrees_of_freedom: Vec<f64>,
        (excitation, resolution): (Excitation, Option<Quantisation>),
    ) -> Explanation {
        let Considered {
            estimate,
            linearity,
            model_errors,
        } = considered;
        Explanation {
            settling: self.plan.choice.take(),
            frequencies: std::mem::take(&mut self.plan.banks),
            noise_orders: estimate.fit.orders,
            path: estimate.information.path(),
            condition: estimate.fit.solution.condition,
            rows: estimate.information.rows(),
            degrees_of_freedom,
            model_errors,
            linearity,
            at_rest: self
                .record
                .and_then(|record| initial_rest::contradicted(record, model)),
            excitation: Some(excitation),
            resolution,
            runs: self
                .record
                .and_then(|record| RunComparison::of(model, record.runs())),
        }
    }
}

/// What left-out frequencies may do.
enum LeftOut {
    /// There are none.
    Nothing,
    /// As much as this.
    Bounded(Truncation),
    /// Nothing bounds it.
    Anything,
}

impl LeftOut {
    /// Bounds of the error of a step response and of a frequency response, real and imaginary parts in turn.
    /// What nothing bounds is taken to be as large as the response itself: then any phase is possible.
    fn biases(self, step: &[f64], frequency: &[f64]) -> (f64, Vec<f64>) {
        let largest = |values: &[f64]| values.iter().fold(0.0f64, |a, x| a.max(x.abs()));
        match self {
            Self::Nothing => (0.0, Vec::new()),
            Self::Bounded(truncation) => (truncation.step, truncation.frequency),
            Self::Anything => {
                let points = frequency.len() / 2;
                // Twice the larger of two parts is more than their length.
                (largest(step), vec![2.0 * largest(frequency); points])
            }
        }
    }
}

/// Values and spreads of the step and frequency responses.
struct Responses {
    step: CurveVariance,
    /// Frequencies \[rad/sample\].
    omegas: Vec<f64>,
    frequency: CurveVariance,
    frequency_values: Vec<f64>,
}

impl Responses {
    fn new(estimate: &Estimate) -> Self {
        let Estimate {
            coordinates,
            information,
            fit,
        } = estimate;
        let omegas = frequency_response::grid(coordinates);
        let map = frequency_map(coordinates, &omegas);
        Self {
            step: CurveVariance::of_fit(information, fit, &coordinates.step_map()),
            frequency: CurveVariance::of_fit(information, fit, &map),
            frequency_values: times(&map, fit.solution.response()),
            omegas,
        }
    }
}
