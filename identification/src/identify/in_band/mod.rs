//! The frequency response within the band that a smooth input excites.
//!
//! A sweep or a sum of sines determines the response at its own frequencies, and nothing else of it. The bank of a few frequencies that is the model then is a
//! picture, without bounds: what it leaves out is in its errors. Here all lags up to the longest N are kept, and the directions that the input does not excite
//! are made proper by a prior of the lags, independent and with a standard deviation as large as the spread of the output over that of the input: |G| has √N times
//! that, so the prior narrows nothing that the record determines. What follows N is a sum of [slow ends](crate::diagnostics::Tails). The covariance of both is that
//! of the noise and of the prior together (Tikhonov's regularisation as Bayes' estimate), so bounds are as wide as the prior where the input has no power, and
//! the band is where they are not.
//!
//! A smooth input determines the response in its band within each run, so each of several runs has a response there. From run to run the servo changes, and noise moves them as well: from
//! three runs on the response is their mean, with the covariance of both, whatever it is that changes. Noise counts once more beside it, because what all runs share, as the prior's part, is
//! not in how they differ.
//!
//! The errors are then noise, if the servo is linear: the tests of other records decide that here, too.

mod points;
mod whole_response;

use super::allowances::Allowances;
use super::candidate::Candidate;
use super::describe;
use super::estimate::Estimate;
use super::fitted::Fitted;
use super::gates::input_is_free;
use super::own_fits::combined;
use super::plan::{Plan, check_rows};
use super::responses::Responses;
use super::task::Task;
use crate::data::{Moments, Record, Timing};
use crate::diagnostics::{
    BothEstimators, Explanation, INPUT_LAGS, Linearity, Simulated, comes_back, lowest_excited,
    one_step_errors, simulated, whiteness,
};
use crate::estimation::{Coordinates, FIRST_ORDER, FsfBasis, GlsFit, GlsOptions, RowInformation};
use crate::options::{Frequencies, Settling};
use crate::results::{BandEstimate, FrequencyResponse, Metrics, Model, Residuals, SelectedBy};
use crate::selection::{longest_settling, odd_at_most};
use crate::thresholds::{
    MISFIT_SIGNIFICANCE, MOMENT_ACCURACY, RUNS_FOR_MEAN, WHITENING_COST_POINTS,
};
use points::Points;
use whole_response::WholeResponse;

/// Share of the squares of the errors that rounding of the moments may be, for tests of the errors: what is as uncertain as the prior is off by a hundredth of that.
/// Bounds ask for [`MOMENT_ACCURACY`].
const ROUNDED_ERRORS: f64 = 1e-5;

/// Fits, each with the variance of the one before, from a hundredth of the output.
const FITS: usize = 3;

/// What is known of a servo under an input that excites a band: with all lags its errors are noise.
pub(super) struct InBand {
    residuals: Residuals,
    linearity: Option<Linearity>,
    /// `None` where no octave has narrow bounds, as between the lines of a few sines, or where they would not hold for another reason.
    band: Option<Band>,
}

/// The response in the band, with bounds.
struct Band {
    frequency: FrequencyResponse,
    estimate: BandEstimate,
    metrics: Metrics,
}

/// What all lags show; `None` where their errors are not noise either, or the structure was chosen by hand. Of three runs and more bounds are those of the
/// servo's mean, as elsewhere, and errors are those of each run by itself: of runs that differ, those of their common response follow the motion.
pub(super) fn of(task: &Task<'_>) -> Option<InBand> {
    let automatic =
        task.options.settling == Settling::Auto && task.options.frequencies == Frequencies::Auto;
    let record = task.record.filter(|_| automatic)?;
    let fitted = fitted(task, record)?;
    if record.runs().len() < RUNS_FOR_MEAN {
        return Some(InBand {
            residuals: tests(record, &fitted)?,
            linearity: fitted.linearity,
            band: Band::of(task, record, fitted, &[]),
        });
    }
    let alone: Vec<Record<'_>> = record.each_run().collect();
    let own: Vec<Fitted> = (alone.iter())
        .map(|alone| fitted_alone(task, alone))
        .collect::<Option<_>>()?;
    let found: Vec<Residuals> = (alone.iter().zip(&own))
        .map(|(alone, own)| tests(alone, own))
        .collect::<Option<_>>()?;
    let own: Vec<WholeResponse> = (alone.iter().zip(own))
        .map(|(alone, own)| WholeResponse::new(alone, own.estimate))
        .collect::<Option<_>>()?;
    Some(InBand {
        residuals: of_runs(&found)?,
        linearity: fitted
            .linearity
            .filter(|found| !found.errors_follow_motion()),
        band: Band::of(task, record, fitted, &own),
    })
}

/// A run by a fit of its own.
fn fitted_alone(task: &Task<'_>, alone: &Record<'_>) -> Option<Fitted> {
    let task = Task {
        record: Some(alone),
        ..*task
    };
    fitted(&task, alone)
}

/// Tests of several runs together; `None` where these find what no single one does.
fn of_runs(found: &[Residuals]) -> Option<Residuals> {
    let all = |p: fn(&Residuals) -> Option<f64>| -> Option<f64> {
        combined(&found.iter().filter_map(p).collect::<Vec<f64>>())
    };
    let most = |percent: fn(&Residuals) -> Option<f64>| -> Option<f64> {
        found.iter().filter_map(percent).reduce(f64::max)
    };
    let (whiteness_p, linearity_p) = (all(|run| run.whiteness_p), all(|run| run.linearity_p));
    let is_noise = is_chance(whiteness_p) && is_chance(linearity_p);
    is_noise.then(|| Residuals {
        input_correlation_p: None,
        whiteness_p,
        linearity_p,
        beyond_linear_percent: most(|run| run.beyond_linear_percent),
        rest_p: all(|run| run.rest_p),
        beyond_rest_percent: most(|run| run.beyond_rest_percent),
    })
}

impl Band {
    /// `None` where bounds would not hold, or are wide.
    fn of(
        task: &Task<'_>,
        record: &Record<'_>,
        fitted: Fitted,
        own: &[WholeResponse],
    ) -> Option<Self> {
        let Estimate {
            information, fit, ..
        } = &fitted.estimate;
        if !is_accurate(information, fit, MOMENT_ACCURACY) {
            return None;
        }
        let feedback = input_is_free::tested(task, &fitted);
        let fitted = Fitted { feedback, ..fitted }.with_honest_covariance(task);
        let responses = Responses::new(&fitted.estimate);
        let allowances = Allowances::new(task, &fitted, &responses);
        let validity = describe::validity(task, &fitted, &responses, &allowances);
        let claimed = validity.level;
        let level = *claimed.valid()?;
        let whole = WholeResponse::new(record, fitted.estimate)?;
        let points = Points::in_band(&whole, own, level, lowest_excited(record)?)?;
        let Estimate {
            information, fit, ..
        } = &whole.estimate;
        let timing = Timing {
            sample_period_s: information.moments.sample_period_s(),
            sample_phase_s: information.moments.sample_phase_s(),
        };
        Some(Self {
            frequency: points.frequency_response(timing, claimed),
            estimate: BandEstimate {
                settling_samples: fit.coordinates.basis.settling(),
                ar: fit.ar.clone(),
                precision: fit.precision,
                beyond_even_noise: points.beyond_even_noise(),
                slopes: task.disturbances.trends.to_vec(),
            },
            metrics: points.metrics(timing, claimed),
        })
    }
}

impl InBand {
    /// Into the model that is a picture of the same record, whose errors were not noise for what it left out.
    pub(super) fn carry_into(self, model: &mut Model, explanation: &mut Explanation) {
        model.residuals = self.residuals;
        model.linear = true;
        explanation.model_errors = None;
        explanation.linearity = self.linearity;
        if let Some(band) = self.band {
            model.frequency = band.frequency;
            model.band_estimate = Some(band.estimate);
            model.metrics = band.metrics;
        }
    }
}

/// The longest N of the longest run: a longer one, as runs together would have, distinguishes frequencies that each run passes within a few cycles. But of an input that comes
/// back no more than half of the time until then: lines of a sum of sines say nothing of frequencies between them to a longer one.
fn settling(record: &Record<'_>, cap: Option<usize>) -> Option<usize> {
    let of_run = |alone: Record<'_>| longest_settling(&alone, cap).ok();
    let longest = record.each_run().filter_map(of_run).max()?;
    let back = comes_back(record, 2 * longest);
    Some(back.map_or(longest, |back| odd_at_most(back / 2).min(longest)))
}

/// All lags up to that N under their prior.
fn fitted(task: &Task<'_>, record: &Record<'_>) -> Option<Fitted> {
    let options = task.options;
    let settling = settling(record, options.longest_settling)?;
    let lags = options.noise_order.highest();
    let extended = Moments::of_record(record, settling + lags + INPUT_LAGS, lags + 1);
    let moments = extended.with_fewer_lags(record, settling + lags);
    let basis = FsfBasis::full(settling).ok()?;
    check_rows(&moments, basis.frequencies()).ok()?;
    let rows = moments.rows() as f64;
    let of_input = moments.uu[(0, 0)] - moments.u[0].powi(2) / rows;
    let prior_variance = moments.output_spread() / of_input;
    let coordinates = Coordinates::new(basis);
    let mut variance = 1e-4 * moments.output_spread() / rows;
    let mut start = Vec::new();
    let mut found = None;
    for _ in 0..FITS {
        let precision = variance / prior_variance;
        let information = RowInformation::under_prior(moments.clone(), precision);
        let options = GlsOptions {
            order: options.noise_order,
            tolerance: 1e-3 / rows.sqrt(),
            start,
            ..GlsOptions::default()
        };
        let fit = GlsFit::of(&information, &coordinates, &options)?;
        (variance, start) = (fit.variance, fit.ar.clone());
        found = Some((information, fit));
    }
    let (information, fit) =
        found.filter(|(information, fit)| is_accurate(information, fit, ROUNDED_ERRORS))?;
    let plan = Plan {
        basis,
        selected_by: SelectedBy::Auto,
        roll_off: FIRST_ORDER,
        order: options.noise_order,
        start: Vec::new(),
        choice: None,
        banks: Vec::new(),
    };
    let candidate = Candidate {
        plan,
        moments,
        extended,
    };
    let estimate = Estimate {
        coordinates,
        information,
        fit,
    };
    Some(Fitted::tested(task, candidate, estimate))
}

/// Whether the prior, and the noise by this `share`, are above the rounding of the moments.
fn is_accurate(information: &RowInformation, fit: &GlsFit, share: f64) -> bool {
    let moments = &information.moments;
    let trace: f64 = (0..fit.coordinates.len()).map(|k| moments.uu[(k, k)]).sum();
    let of_noise = 10.0 * f64::EPSILON * moments.output_spread() / fit.solution.rss;
    10.0 * f64::EPSILON * trace <= fit.precision && of_noise <= share
}

/// The errors one step ahead of the rows that the fit rests on; NaN elsewhere. Those before the first of them follow from lags that it does not determine.
fn errors_of_rows(run: &Simulated<'_>, information: &RowInformation, fit: &GlsFit) -> Vec<f64> {
    let moments = &information.moments;
    let rows = (run.run).complete_rows(moments.input_lags(), moments.output_lags());
    let errors = one_step_errors(&run.errors, &fit.ar);
    let mut kept = vec![f64::NAN; errors.len()];
    for row in rows {
        kept[row.clone()].copy_from_slice(&errors[row]);
    }
    kept
}

fn is_chance(p: Option<f64>) -> bool {
    p.is_none_or(|p| p >= MISFIT_SIGNIFICANCE)
}

/// Tests of the errors, where they are noise. A band of a thousandth is narrower than what counts as a servo that is not linear elsewhere, so every
/// finding that is beyond chance counts.
fn tests(record: &Record<'_>, fitted: &Fitted) -> Option<Residuals> {
    let Estimate {
        information, fit, ..
    } = &fitted.estimate;
    let both = BothEstimators::new(information, fit, false)?;
    let whitening = both.least_squares_percent - both.generalised_percent;
    let runs = simulated(record, &information.moments, fit);
    let errors: Vec<Vec<f64>> = (runs.iter())
        .map(|run| errors_of_rows(run, information, fit))
        .collect();
    let share = 1.0 - fit.degrees_of_freedom() / fit.rows as f64;
    let whiteness_p = whiteness(&errors, fit.ar.len(), share);
    let linearity = fitted.linearity;
    let rest = linearity.and_then(|found| found.rest);
    let noise = whitening <= WHITENING_COST_POINTS
        && is_chance(whiteness_p)
        && is_chance(linearity.map(|found| found.p))
        && is_chance(linearity.and_then(|found| Some(found.runs?.p)))
        && linearity.is_none_or(|found| !found.errors_follow_motion());
    noise.then(|| Residuals {
        input_correlation_p: None,
        whiteness_p,
        linearity_p: linearity.map(|found| found.p),
        beyond_linear_percent: linearity.map(|found| found.misfit_percent),
        rest_p: rest.map(|found| found.p),
        beyond_rest_percent: rest.map(|found| found.misfit_percent),
    })
}
