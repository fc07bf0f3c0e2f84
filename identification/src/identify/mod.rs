//! From a record, or its moments, to a model.
//!
//! The story: [glitches and hum](undisturbed) are taken out; moments are collected in one pass, and the first [candidate](candidate) that they determine is
//! fitted by generalised least squares; [gates](gates) look at its errors and may put another one in its place; the
//! evidence decides whether bounds hold; the [responses](responses) get their [bounds](allowances) and the metrics
//! their intervals; tests and advice come last.

mod allowances;
mod assess;
mod candidate;
mod describe;
mod disturbances;
mod estimate;
mod expected;
mod fitted;
mod gates;
mod in_band;
mod own_fits;
mod plan;
mod prior;
mod responses;
mod slow_end_allowance;
mod task;
mod undisturbed;

use crate::data::{Moments, Record};
use crate::diagnostics::{Evidence, Explanation, RunComparison, Validity, gather_advice};
use crate::error::Error;
use crate::estimation::Excitation;
use crate::options::Options;
use crate::results::{Model, Reason};

use allowances::Allowances;
use candidate::Candidate;
use disturbances::Disturbances;
use fitted::Fitted;
use responses::Responses;
use slow_end_allowance::allowing_for_slow_end;
use task::Task;
use undisturbed::Undisturbed;

pub use expected::expected_model;

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
    explained(record, options, true, false)
}

/// [`identify_explained`] with the bounds of the runs of a record, for a comparison that counts their scatter itself. `may_go_on` where
/// a settling time in the options is that of another choice, beyond which the response may go on.
pub(crate) fn identify_runs(
    record: &Record,
    options: &Options,
    may_go_on: bool,
) -> Result<Identification, Error> {
    explained(record, options, false, may_go_on)
}

fn explained(
    record: &Record,
    options: &Options,
    of_servo: bool,
    may_go_on: bool,
) -> Result<Identification, Error> {
    options.check()?;
    record.check_columns()?;
    let request = Request {
        record,
        options,
        of_servo,
        may_go_on,
    };
    let found = request.found_of_servo(Undisturbed::of(record, options)?);
    // The search for smaller outliers goes on from the fit without the larger ones.
    let kept = (found.may_have_smaller_outliers()).then(|| found.clone());
    request.with_response(found, |first| {
        let Some(kept) = kept.filter(|_| first.asks_for_smaller_outliers()) else {
            return Ok(first.identification());
        };
        let found = kept.without_smaller_outliers(record, options)?;
        request.with_response(found, |last| Ok(last.identification()))
    })
}

/// What is asked for of a record.
struct Request<'a> {
    record: &'a Record<'a>,
    options: &'a Options,
    of_servo: bool,
    may_go_on: bool,
}

impl<'a> Request<'a> {
    /// A record as it was `found`, or without where its runs begin if that is elsewhere than later rests and what is left is linear: a servo that is not linear rests elsewhere again and again.
    fn found_of_servo(&self, found: Undisturbed<'a>) -> Undisturbed<'a> {
        let is_linear = |found: &Undisturbed<'_>| {
            let task = self.task(&found.record, &found.disturbances);
            let (candidate, estimate) = (found.candidate.clone(), found.estimate.clone());
            !Fitted::tested(&task, candidate, estimate).errors_follow_motion()
        };
        let without_start = found.without_start(self.record, self.options);
        without_start.filter(is_linear).unwrap_or(found)
    }

    /// What follows from the response of the record as it was `found`, or with all that may be errors of the model where these follow the
    /// motion: errors of a servo that is not linear are no disturbances.
    fn with_response(
        &self,
        found: Undisturbed<'a>,
        then: impl FnOnce(Response<'_>) -> Result<Identification, Error>,
    ) -> Result<Identification, Error> {
        let Undisturbed {
            record,
            disturbances,
            candidate,
            estimate,
        } = found;
        let task = self.task(&record, &disturbances);
        let fitted = Fitted::tested(&task, candidate, estimate);
        // A response that outlasts holds fits what is not linear, and invents disturbances where it cannot.
        let is_of_servo =
            |fitted: &Fitted| !fitted.errors_follow_motion() && fitted.outlasts_holds.is_none();
        let may_be_disturbances =
            |fitted: &Fitted| disturbances.is_without_errors() || is_of_servo(fitted);
        if may_be_disturbances(&fitted) {
            // Another settling time may show what the first hid.
            let response = Response::new(&task, fitted)?;
            if may_be_disturbances(&response.fitted) {
                return then(response);
            }
        }
        let whole = Undisturbed::with_errors(self.record, self.options, &disturbances)?;
        let task = self.task(&whole.record, &whole.disturbances);
        let fitted = Fitted::tested(&task, whole.candidate, whole.estimate);
        then(Response::new(&task, fitted)?)
    }

    fn task<'b>(&'b self, record: &'b Record<'b>, disturbances: &'b Disturbances) -> Task<'b> {
        Task {
            record: Some(record),
            recorded: Some(self.record),
            options: self.options,
            of_servo: self.of_servo,
            may_go_on: self.may_go_on,
            disturbances,
        }
    }
}

/// Identifies from moments alone, as saved or collected live. The settling time can be at most the
/// input lags less the noise order; residual tests that need the samples are left out, and so are
/// the fallback to QR and what the bounds allow for commands that were rounded, or measured with noise.
///
/// # Errors
/// As [`identify`]; also when the moments have too few lags for the options.
pub fn identify_moments(moments: &Moments, options: &Options) -> Result<Identification, Error> {
    options.check()?;
    let task = Task {
        record: None,
        recorded: None,
        options,
        of_servo: true,
        may_go_on: false,
        disturbances: &Disturbances::default(),
    };
    let fitted = Fitted::new(&task, Candidate::of_moments(moments, options)?)?;
    Ok(Response::new(&task, fitted)?.identification())
}

/// A response with its bounds, after all gates.
struct Response<'a> {
    task: &'a Task<'a>,
    samples: usize,
    fitted: Fitted,
    described: Described,
    runs: Option<RunComparison>,
}

impl<'a> Response<'a> {
    fn new(task: &'a Task<'a>, first: Fitted) -> Result<Self, Error> {
        let samples = first.candidate.moments.samples();
        let fitted = gates::pass(task, first)?.with_honest_covariance(task);
        let mut fitted = allowing_for_slow_end(task, prior::under_prior(task, fitted));
        let mut described = Described::new(task, &fitted);
        let with_offsets = task
            .record
            .map_or_else(Vec::new, |record| task.disturbances.with_offsets(record));
        let runs = RunComparison::of(&described.model, &with_offsets);
        let differ = (with_offsets.as_slice(), runs.as_ref());
        if fitted.add_scatter(task, &described.model, differ) {
            described = Described::new(task, &fitted);
        }
        if described.model.level().valid().is_some() && !described.responses.have_variances() {
            return Err(Error::NoVariance);
        }
        Ok(Self {
            task,
            samples,
            fitted,
            described,
            runs,
        })
    }

    /// Whether smaller outliers have to go, too: there are larger ones, the servo is linear, and bounds hold.
    fn asks_for_smaller_outliers(&self) -> bool {
        let model = &self.described.model;
        !self.task.disturbances.outliers.taken_out.is_empty()
            && model.linear
            && model.bounds.valid().is_some()
    }

    /// With tests of the residuals and advice.
    fn identification(self) -> Identification {
        let Self {
            task,
            samples,
            mut fitted,
            mut described,
            runs,
        } = self;
        let in_band = (described.asks_for_band(&fitted))
            .then(|| in_band::of(task))
            .flatten();
        if in_band.is_some() && fitted.misfit.take().is_some() {
            // With all lags the errors are noise. Those of the few frequencies are what these leave out.
            described = Described::new(task, &fitted);
        }
        let Described {
            responses,
            allowances,
            validity,
            mut model,
        } = described;
        model.residuals = assess::residuals(task, &fitted, &model);
        let mut explanation =
            describe::explanation(task, fitted, &responses, &allowances, (&model, runs));
        if let Some(found) = in_band {
            found.carry_into(&mut model, &mut explanation);
            // By the noise that the band has: few frequencies have another one.
            let runs = task
                .record
                .map(|record| task.disturbances.with_offsets(record));
            explanation.runs = runs.and_then(|runs| RunComparison::of(&model, &runs));
        }
        model.advice = gather_advice(&Evidence {
            model: &model,
            validity: &validity,
            explanation: &explanation,
            options: task.options,
            recorded: task.recorded,
            samples,
        });
        Identification { model, explanation }
    }
}

/// A fit with its bounds.
struct Described {
    responses: Responses,
    allowances: Allowances,
    validity: Validity,
    model: Model,
}

impl Described {
    fn new(task: &Task<'_>, fitted: &Fitted) -> Self {
        let responses = Responses::new(&fitted.estimate);
        let allowances = Allowances::new(task, fitted, &responses);
        let validity = describe::validity(task, fitted, &responses, &allowances);
        Self {
            model: describe::model(task, fitted, &responses, &allowances, &validity),
            responses,
            allowances,
            validity,
        }
    }

    /// Whether there are no bounds because the input is too smooth to determine all of the response. It then may be too smooth to show whether errors are noise, too.
    fn asks_for_band(&self, fitted: &Fitted) -> bool {
        let may_be_smooth = matches!(
            self.model.level().withdrawn(),
            Some(Reason::InputUnexcited | Reason::ErrorsNotNoise)
        );
        may_be_smooth && Excitation::of(&fitted.estimate.information.moments).is_smooth()
    }
}
