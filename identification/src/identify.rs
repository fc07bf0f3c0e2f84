//! From a record, or its moments, to a model.

use crate::advice::{self, Evidence};
use crate::basis::Basis;
use crate::curve::{self, CurveSpread};
use crate::error::Error;
use crate::explanation::Explanation;
use crate::factor::triangular_factor;
use crate::frequency::{self, FrequencyResponse, frequency_map};
use crate::gls::{self, GlsFit, GlsOptions, MAX_AUTO_ORDER};
use crate::linear::times;
use crate::matrix_serde::to_rows;
use crate::metrics::{Measured, Metrics};
use crate::model::{Fit, Model, SCHEMA, SelectedBy, Structure};
use crate::model_error::{self, BothEstimators, ModelErrors, Prediction};
use crate::moments::Moments;
use crate::nested::{BankCandidate, NestedBanks};
use crate::noise::Noise;
use crate::normal::{Coordinates, Information};
use crate::options::{Frequencies, NoiseOrder, Options, Settling};
use crate::record::Record;
use crate::residual::{self, INPUT_LAGS, Residuals, WHITENESS_SAMPLES};
use crate::runs::RunComparison;
use crate::step::StepResponse;
use crate::structure::{self, Choice};
use crate::timing::Timing;
use crate::truncation::{FIRST_ORDER, SECOND_ORDER, step_bias_bound};
use crate::validation::fit_percent;

/// Estimated relative error of an estimate through moments above which the rows themselves are
/// factorised.
const ACCURACY: f64 = 1e-8;

/// Rounding of the response per unit of the condition number: the largest seen against QR.
const ROUNDING: f64 = 50.0 * f64::EPSILON;

/// Condition number up to which moments are accurate enough.
pub(crate) const WELL_CONDITIONED: f64 = ACCURACY / ROUNDING;

/// Change of the noise model that counts as rest, in standard deviations that a coefficient has
/// at least, 1/sqrt(rows).
const REST: f64 = 1e-3;

/// Share of rows that must be gained to make another pass over the data worth while.
const WORTHWHILE_ROWS: f64 = 0.01;

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
    let (plan, moments, extended) = match options.settling {
        Settling::Auto => {
            let longest = structure::longest_settling(record, options.longest_settling)?;
            let lags = longest + noise_lags(options.noise_order);
            let moments = Moments::of_record(record, lags, noise_lags(options.noise_order) + 1);
            let choice = structure::choose(&moments, longest, options.noise_order)?;
            let fitted = with_all_rows(record, &moments, choice.settling, options.noise_order);
            let beyond = choice.settling + noise_lags(options.noise_order) + INPUT_LAGS;
            let extended = if beyond <= moments.input_lags() {
                moments.truncated(beyond, moments.output_lags())
            } else {
                Moments::of_record(record, beyond, moments.output_lags())
            };
            (Plan::of_choice(choice, &fitted, options)?, fitted, extended)
        }
        Settling::Samples(settling) => {
            let lags = noise_lags(options.noise_order);
            let extended = Moments::of_record(record, settling + lags + INPUT_LAGS, lags + 1);
            let moments = extended.with_fewer_lags(record, settling + lags);
            let plan = Plan::for_settling(settling, &moments, options)?;
            (plan, moments, extended)
        }
    };
    let extended = Some(extended);
    Pipeline {
        record: Some(record),
        options,
        plan,
        moments,
        extended,
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
    let noise = noise_lags(options.noise_order).min(moments.output_lags() - 1);
    let available = moments.input_lags().saturating_sub(noise);
    let plan = match options.settling {
        Settling::Auto => {
            let longest = available - usize::from(available.is_multiple_of(2));
            let longest = longest.min(options.longest_settling.unwrap_or(longest));
            let choice = structure::choose(moments, longest, options.noise_order)?;
            Plan::of_choice(choice, moments, options)?
        }
        Settling::Samples(settling) if settling > available => {
            return Err(Error::LagMismatch {
                left: settling + noise,
                right: moments.input_lags(),
            });
        }
        Settling::Samples(settling) => Plan::for_settling(settling, moments, options)?,
    };
    let extended = Some(moments.clone());
    Pipeline {
        record: None,
        options,
        plan,
        moments: moments.clone(),
        extended,
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

/// The moments for the chosen settling time: over more rows than the choice could use, if that is
/// worth another pass.
fn with_all_rows(
    record: &Record,
    moments: &Moments,
    settling: usize,
    order: NoiseOrder,
) -> Moments {
    let (lags, outputs) = (settling + noise_lags(order), noise_lags(order) + 1);
    let rows = record.count_rows(lags, outputs) as f64;
    if rows > (1.0 + WORTHWHILE_ROWS) * moments.rows() as f64 {
        Moments::of_record(record, lags, outputs)
    } else {
        moments.truncated(lags, outputs)
    }
}

/// A decided structure.
struct Plan {
    basis: Basis,
    selected_by: SelectedBy,
    /// Roll-off assumed above the highest frequency.
    roll_off: i32,
    order: NoiseOrder,
    /// D to start from.
    start: Vec<f64>,
    choice: Option<Choice>,
    banks: Vec<BankCandidate>,
}

impl Plan {
    fn of_choice(choice: Choice, moments: &Moments, options: &Options) -> Result<Self, Error> {
        let mut plan = Self::for_frequencies(choice.settling, moments, options, &choice.ar)?;
        if let (Some(frequencies), Frequencies::Auto) = (choice.frequencies, options.frequencies) {
            plan.basis = Basis::new(choice.settling, frequencies)?;
        }
        plan.selected_by = match options.frequencies {
            Frequencies::Auto => SelectedBy::Auto,
            Frequencies::Narrow => SelectedBy::Narrow,
            Frequencies::Count(_) => SelectedBy::User,
        };
        plan.choice = Some(choice);
        Ok(plan)
    }

    fn for_settling(settling: usize, moments: &Moments, options: &Options) -> Result<Self, Error> {
        let needed = match options.frequencies {
            Frequencies::Count(frequencies) => Basis::new(settling, frequencies)?.frequencies(),
            _ => 1,
        };
        check_rows(moments, needed)?;
        let coordinates = Coordinates::new(Basis::full(settling)?);
        let start = match options.frequencies {
            Frequencies::Count(_) => Vec::new(),
            _ => {
                let information = Information::from_moments(moments.clone());
                let rough = GlsOptions {
                    order: options.noise_order,
                    tolerance: 1e-2,
                    max_iterations: 4,
                    corrected: false,
                    start: Vec::new(),
                };
                gls::fit(&information, &coordinates, &rough).map_or_else(Vec::new, |fit| fit.ar)
            }
        };
        let mut plan = Self::for_frequencies(settling, moments, options, &start)?;
        plan.selected_by = match options.frequencies {
            Frequencies::Narrow => SelectedBy::Narrow,
            _ => SelectedBy::User,
        };
        Ok(plan)
    }

    /// n for a settling time, and D to start from.
    fn for_frequencies(
        settling: usize,
        moments: &Moments,
        options: &Options,
        ar: &[f64],
    ) -> Result<Self, Error> {
        let mut plan = Self {
            basis: Basis::full(settling)?,
            selected_by: SelectedBy::User,
            roll_off: FIRST_ORDER,
            order: options.noise_order,
            start: ar.to_vec(),
            choice: None,
            banks: Vec::new(),
        };
        if let Frequencies::Count(frequencies) = options.frequencies {
            plan.basis = Basis::new(settling, frequencies)?;
            return Ok(plan);
        }
        let Some(scan) = NestedBanks::scan(moments, settling, ar, FIRST_ORDER) else {
            return Err(Error::NotExcited {
                asked: settling,
                excited: 1,
                highest_hz: 0.0,
            });
        };
        plan.banks.clone_from(&scan.candidates);
        if options.frequencies == Frequencies::Narrow {
            let narrow = 2 * scan.best_predictor().frequencies + 1;
            let largest = plan.basis.frequencies().min(scan.largest().frequencies);
            plan.basis = Basis::new(settling, narrow.min(largest))?;
            plan.roll_off = SECOND_ORDER;
        } else if structure::is_low_passed(&scan, settling) {
            plan.basis = Basis::new(settling, scan.narrowest().frequencies)?;
        }
        Ok(plan)
    }
}

/// At least two rows for each parameter: with fewer, the residuals say little about the noise.
fn check_rows(moments: &Moments, parameters: usize) -> Result<(), Error> {
    let needed = 2 * (parameters + 1) + moments.output_lags();
    if moments.rows() < needed {
        return Err(Error::TooFewSamples {
            usable: moments.rows(),
            history: moments.input_lags(),
            parameters: parameters + 1,
            needed,
        });
    }
    Ok(())
}

/// Everything that one identification works with.
struct Pipeline<'a> {
    record: Option<&'a Record>,
    options: &'a Options,
    plan: Plan,
    moments: Moments,
    /// Moments with further lags, for the test of independence.
    extended: Option<Moments>,
}

impl Pipeline<'_> {
    fn run(mut self) -> Result<Identification, Error> {
        check_rows(&self.moments, self.plan.basis.frequencies())?;
        let mut coordinates = Coordinates::new(self.plan.basis);
        let (mut information, mut fit) = self.estimate(&coordinates)?;
        let mut model_errors = None;
        if let Some(both) = BothEstimators::new(&information, &coordinates, &fit)
            && both.errors_are_not_noise()
        {
            let candidates = self.rank_by_prediction();
            if let Some(best) = candidates.first() {
                self.adopt(*best)?;
                coordinates = Coordinates::new(self.plan.basis);
                (information, fit) = self.estimate(&coordinates)?;
            }
            model_errors = Some(self.model_errors(&information, &coordinates, &both, candidates));
        }
        let omegas = frequency::grid(&coordinates);
        let responses = Responses::new(&information, &fit, &omegas);
        let theta = fit.theta();
        let n = theta.len();
        let covariance = fit.covariance().as_ref().submatrix(0, 0, n, n).to_owned();
        let sd: Vec<f64> = (0..n).map(|k| covariance[(k, k)].max(0.0).sqrt()).collect();
        let bias = step_bias_bound(&self.plan.basis, &theta, &sd, self.plan.roll_off);
        let period = self.moments.sample_period_s();
        let level = self.options.level;
        let value = coordinates.basis.step_response(&theta);
        let step = StepResponse::new(period, value, &responses.step, level, bias);
        let frequency = FrequencyResponse::new(
            period,
            &omegas,
            &responses.frequency_values,
            &responses.frequency,
            level,
        );
        let timing = Timing {
            sample_period_s: period,
            sample_phase_s: self.moments.sample_phase_s(),
        };
        let metrics = Metrics::new(&Measured {
            basis: &self.plan.basis,
            theta: &theta,
            covariance: &covariance,
            step: &step,
            timing,
        });
        let mut model = Model {
            schema: SCHEMA,
            sample_period_s: period,
            sample_phase_s: timing.sample_phase_s,
            structure: Structure {
                settling_samples: self.plan.basis.settling(),
                frequencies: n,
                noise_order: fit.ar.len(),
                selected_by: self.plan.selected_by,
            },
            theta,
            covariance: to_rows(&covariance),
            offset: fit.offset(&information),
            noise: Noise {
                ar: fit.ar.clone(),
                sigma: fit.variance.sqrt(),
            },
            metrics,
            step,
            frequency,
            fit: self.fit_from_moments(&information, &fit),
            residuals: Residuals::default(),
            iterations: fit.iterations,
            converged: fit.converged,
            advice: Vec::new(),
        };
        self.assess(&mut model, &coordinates, &fit);
        let explanation = Explanation {
            settling: self.plan.choice.take(),
            frequencies: std::mem::take(&mut self.plan.banks),
            noise_orders: fit.orders.clone(),
            path: information.path(),
            condition: fit.solution.condition,
            rows: information.rows(),
            degrees_of_freedom: responses.step.degrees_of_freedom.clone(),
            model_errors,
            runs: self
                .record
                .and_then(|record| RunComparison::of(&model, record.runs())),
        };
        model.advice = advice::gather(&Evidence {
            model: &model,
            explanation: &explanation,
            options: self.options,
            samples: self.moments.samples(),
        });
        Ok(Identification { model, explanation })
    }

    /// The fit, through moments if they are accurate enough, else through QR.
    fn estimate(&self, coordinates: &Coordinates) -> Result<(Information, GlsFit), Error> {
        let options = GlsOptions {
            order: self.plan.order,
            start: self.plan.start.clone(),
            tolerance: REST / (self.moments.rows() as f64).sqrt(),
            ..GlsOptions::default()
        };
        let fast = Information::from_moments(self.moments.clone());
        let fit = gls::fit(&fast, coordinates, &options);
        match (fit, self.record) {
            (Some(fit), None) => Ok((fast, fit)),
            (Some(fit), _) if relative_error(&fast, &fit) <= ACCURACY => Ok((fast, fit)),
            (_, Some(record)) => {
                let factor = triangular_factor(record, &self.moments);
                let accurate = Information::from_factor(&self.moments, factor);
                let options = GlsOptions {
                    start: Vec::new(),
                    ..options
                };
                match gls::fit(&accurate, coordinates, &options) {
                    Some(fit) => Ok((accurate, fit)),
                    None => Err(self.not_excited()),
                }
            }
            (None, None) => Err(self.not_excited()),
        }
    }

    /// Estimators by how well they predict parts of the record that they have not seen.
    fn rank_by_prediction(&self) -> Vec<Prediction> {
        let Some(record) = self.record else {
            return Vec::new();
        };
        let settling = self.plan.basis.settling();
        let settlings = match &self.plan.choice {
            None => vec![settling],
            Some(choice) => {
                let between = (settling as f64 * choice.longest as f64).sqrt() as usize | 1;
                let mut settlings = vec![settling, between, choice.longest];
                settlings.dedup();
                settlings
            }
        };
        let frequencies = match self.options.frequencies {
            Frequencies::Count(count) => Some(count),
            _ => None,
        };
        model_error::rank(record, &settlings, frequencies, self.options.noise_order)
    }

    /// Makes `best` the plan.
    fn adopt(&mut self, best: Prediction) -> Result<(), Error> {
        self.plan.basis = Basis::new(best.settling, best.frequencies)?;
        self.plan.start = Vec::new();
        if !best.generalised {
            self.plan.order = NoiseOrder::Order(0);
        }
        if let Some(record) = self.record {
            let lags = noise_lags(self.plan.order);
            self.moments = Moments::of_record(record, best.settling + lags, lags + 1);
            let beyond = best.settling + lags + INPUT_LAGS;
            self.extended = Some(Moments::of_record(record, beyond, lags + 1));
        }
        Ok(())
    }

    fn model_errors(
        &self,
        information: &Information,
        coordinates: &Coordinates,
        before: &BothEstimators,
        candidates: Vec<Prediction>,
    ) -> ModelErrors {
        let generalised = self.plan.order != NoiseOrder::Order(0);
        // The other estimator at the structure that was taken; with its own noise model if it has
        // one, which needs further lags.
        let other = if generalised {
            NoiseOrder::Order(0)
        } else {
            self.options.noise_order
        };
        let lags = noise_lags(other);
        let moments = match self.record {
            Some(record) => Moments::of_record(record, self.plan.basis.settling() + lags, lags + 1),
            None => information.moments.clone(),
        };
        let options = GlsOptions {
            order: other,
            ..GlsOptions::default()
        };
        let other = gls::fit(&Information::from_moments(moments), coordinates, &options);
        ModelErrors {
            least_squares_percent: before.least_squares_percent,
            generalised_percent: before.generalised_percent,
            candidates,
            other_step: other.map_or_else(Vec::new, |fit| {
                coordinates.basis.step_response(&fit.theta())
            }),
        }
    }

    fn not_excited(&self) -> Error {
        let basis = self.plan.basis;
        let scan = NestedBanks::scan(&self.moments, basis.settling(), &[], FIRST_ORDER);
        let excited = scan.map_or(1, |scan| scan.largest().frequencies);
        let highest = (excited / 2) as f64;
        let highest_hz = highest / (basis.settling() as f64 * self.moments.sample_period_s());
        Error::NotExcited {
            asked: basis.frequencies(),
            excited,
            highest_hz,
        }
    }

    /// The figures of merit that follow from the moments.
    fn fit_from_moments(&self, information: &Information, fit: &GlsFit) -> Fit {
        let error = information.residual_moments(&fit.impulse(), fit.solution.offset(), 0);
        let spread = information.moments.output_spread();
        let error = error[(0, 0)].max(0.0);
        Fit {
            simulation_percent: fit_percent(error, spread),
            one_step_percent: fit_percent(fit.solution.rss, spread),
            rmse: (error / information.rows() as f64).sqrt(),
            samples_used: information.rows(),
            samples_missing: self.moments.missing(),
        }
    }

    /// Residual tests; that of whiteness needs the samples.
    fn assess(&self, model: &mut Model, coordinates: &Coordinates, fit: &GlsFit) {
        if let Some(extended) = &self.extended {
            let information = Information::from_moments(extended.clone());
            model.residuals.input_correlation_p =
                residual::input_independence(&information, coordinates, &fit.ar);
        }
        let Some(record) = self.record else { return };
        let mut left = WHITENESS_SAMPLES;
        let mut errors = Vec::new();
        for run in record.runs() {
            let run = run.part(0..run.len().min(left));
            left -= run.len();
            errors.push(one_step_errors(
                run.output(),
                &model.simulate(&run),
                &fit.ar,
            ));
        }
        model.residuals.whiteness_p = residual::whiteness(&errors, fit.ar.len());
    }
}

/// ε(k) = D(z) (y - y_sim)(k); NaN where a value or its history is missing.
fn one_step_errors(output: &[f64], simulated: &[f64], ar: &[f64]) -> Vec<f64> {
    let error: Vec<f64> = output.iter().zip(simulated).map(|(y, s)| y - s).collect();
    let order = ar.len();
    let mut filtered = vec![f64::NAN; error.len().min(order)];
    filtered.extend(error.windows(order + 1).map(|window| {
        let (past, now) = window.split_at(order);
        now[0] + past.iter().rev().zip(ar).map(|(v, d)| d * v).sum::<f64>()
    }));
    filtered
}

/// Estimated relative error of a fit through moments: rounding times the condition number for the
/// response, and times the ratio of signal to noise for the noise, whose moments are differences
/// of much larger ones. The factors are the largest seen against QR.
fn relative_error(information: &Information, fit: &GlsFit) -> f64 {
    let response = ROUNDING * fit.solution.condition;
    let noise = 10.0 * f64::EPSILON * information.moments.output_spread() / fit.solution.rss;
    if noise.is_nan() {
        f64::INFINITY
    } else {
        response.max(noise)
    }
}

/// Values and spreads of the step and frequency responses.
struct Responses {
    step: CurveSpread,
    frequency: CurveSpread,
    frequency_values: Vec<f64>,
}

impl Responses {
    fn new(information: &Information, fit: &GlsFit, omegas: &[f64]) -> Self {
        let map = frequency_map(&fit.coordinates, omegas);
        Self {
            step: curve::spread(information, fit, &fit.coordinates.step_map()),
            frequency: curve::spread(information, fit, &map),
            frequency_values: times(&map, fit.solution.response()),
        }
    }
}
