//! The forecast of a run.

use super::alternatives::{Alternative, alternatives};
use super::answerable_questions::{self, Answer};
use super::assumed_servo::noise_rms;
use super::band_width::{BandWidths, RunsNeeded};
use super::beyond_stops;
use super::error::PlanError;
use super::expectation::Expectation;
use super::motion::require_motion;
use super::needed_runs::Effort;
use super::request::PlanRequest;
use super::servo_quantities::ServoQuantities;
use super::spectrum::Spectrum;
use crate::data::recording::as_toml;
use crate::instrument::reference::{describe, seconds};
use serde::ser::SerializeStruct;
use serde::{Serialize, Serializer};
use servoid_identification::results::{Bounds, Metrics, Model, StepResponse, Withdrawn};

/// How many runs are tried for the wanted band: as many as are ever advised.
const EFFORT: Effort = Effort {
    simulations: 3,
    doublings: u32::MAX,
};

/// The forecast of a run.
#[derive(Clone, Debug, Serialize)]
pub struct Plan {
    /// The reference as in a recording's header.
    pub reference: toml::Table,
    /// The reference in words.
    pub description: String,
    /// That the assumed servo runs into a stop under it, and what to take instead.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub beyond_stops: Option<String>,
    /// Duration of the reference (s).
    pub reference_s: f64,
    /// Duration of one run, with its rest (s).
    pub run_s: f64,
    /// Number of runs.
    pub runs: usize,
    /// The servo that is assumed, in words.
    pub servo: String,
    /// Standard deviation of the noise that is assumed (deg).
    pub noise_deg: f64,
    /// Coefficients of the noise that is assumed, d_1..d_d of 1/D(z).
    pub noise_ar: Vec<f64>,
    /// N that identification will probably choose.
    pub settling_samples: usize,
    /// Number n of frequencies that identification will probably choose.
    pub frequencies: usize,
    /// The band of the step response, withdrawn where identification will give no bounds.
    #[serde(flatten, serialize_with = "as_band")]
    pub band: Bounds<BandWidths>,
    /// The metrics of the assumed servo with their expected intervals; `None` without a band.
    pub metrics: Option<Metrics>,
    /// The power of the reference by frequency.
    pub spectrum: Spectrum,
    /// The questions beside the linear response, answered or not.
    pub answers: Vec<Answer>,
    /// What a run will determine of the servo as a machine; `None` where nobody asked.
    pub servo_model: Option<ServoQuantities>,
    /// Whether all this holds for a linear servo only.
    pub only_if_linear: bool,
    /// Half width of the band that is wanted (percent of the step).
    pub wanted_percent: Option<f64>,
    /// The runs for it; `None` also where a reasonable number of runs does not reach it.
    pub needed: Option<RunsNeeded>,
    /// The most runs that were tried, and their band, where that does not reach the wanted one.
    pub closest: Option<RunsNeeded>,
    /// All references beside each other, the best first.
    pub alternatives: Vec<Alternative>,
    /// The assumed servo's response with the bounds that are to be expected.
    #[serde(skip)]
    pub step: StepResponse,
}

/// The bounds of a plan are called by their name, the band.
fn as_band<S: Serializer>(band: &Bounds<BandWidths>, serializer: S) -> Result<S::Ok, S::Error> {
    let mut fields = serializer.serialize_struct("Band", 2)?;
    fields.serialize_field("band", &band.valid())?;
    fields.serialize_field("withdrawn", &band.withdrawn().map(Withdrawn))?;
    fields.end()
}

impl Plan {
    /// Plans a run.
    ///
    /// # Errors
    /// The assumed servo stands still; or the error of identification after such a run: the reference is too short, or excites too
    /// little.
    pub fn of(request: &PlanRequest) -> Result<Self, PlanError> {
        require_motion(request)?;
        let expected = Expectation::of(request)?;
        let reference = &request.reference;
        let band = expected.band;
        let Model { noise, .. } = &request.assumed.model;
        let needed = band
            .valid()
            .and_then(|band| request.runs_needed(band, EFFORT));
        Ok(Self {
            reference: as_toml(reference),
            description: describe(reference, request.us_per_degree, request.assumed.train),
            beyond_stops: beyond_stops::in_words(request),
            reference_s: seconds(reference.frames(), request.assumed.train),
            run_s: request.run_s(),
            runs: request.runs,
            servo: request.assumed.name.clone(),
            noise_deg: noise_rms(noise),
            noise_ar: noise.ar.clone(),
            settling_samples: expected.model.structure.settling_samples,
            frequencies: expected.model.structure.frequencies,
            band,
            metrics: match band.valid() {
                Some(_) => expected
                    .model
                    .metrics_anew()
                    .map_err(PlanError::from)?
                    .into_valid(),
                None => None,
            },
            spectrum: Spectrum::of(request),
            answers: answerable_questions::of(&expected.example, &expected.record),
            servo_model: match request.servo_model {
                true => Some(ServoQuantities::of(request)?),
                false => None,
            },
            only_if_linear: request.relies_on_linearity(),
            wanted_percent: request.wanted_percent,
            needed: needed.and_then(Result::ok),
            closest: needed.and_then(Result::err),
            alternatives: alternatives(request, &expected, needed),
            step: expected.model.step,
        })
    }
}
