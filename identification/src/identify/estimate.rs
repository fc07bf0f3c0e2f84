//! The fit, through moments if they are accurate enough, else through QR.

use super::plan::Plan;
use crate::data::moments::Moments;
use crate::data::record::Record;
use crate::error::Error;
use crate::estimation::gls::{self, GlsFit, GlsOptions};
use crate::estimation::least_squares::{Coordinates, RowInformation};
use crate::estimation::nested_banks::NestedBanks;
use crate::estimation::qr::triangular_factor;
use crate::estimation::truncation::FIRST_ORDER;

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

/// A fit and what it was made from.
pub(super) struct Estimate {
    pub(super) coordinates: Coordinates,
    pub(super) information: RowInformation,
    pub(super) fit: GlsFit,
}

impl Estimate {
    /// By the plan, from moments; with the record at hand, QR can take over.
    pub(super) fn new(
        plan: &Plan,
        moments: &Moments,
        record: Option<&Record>,
    ) -> Result<Self, Error> {
        let coordinates = Coordinates::new(plan.basis);
        let options = GlsOptions {
            order: plan.order,
            start: plan.start.clone(),
            tolerance: REST / (moments.rows() as f64).sqrt(),
            ..GlsOptions::default()
        };
        let information = RowInformation::from_moments(moments.clone());
        let fast = gls::fit(&information, &coordinates, &options)
            .filter(|fit| record.is_none() || relative_error(&information, fit) <= ACCURACY);
        if let Some(fit) = fast {
            return Ok(Self {
                coordinates,
                information,
                fit,
            });
        }
        let Some(record) = record else {
            return Err(not_excited(plan, moments));
        };
        let information = RowInformation::from_factor(moments, triangular_factor(record, moments));
        let options = GlsOptions {
            start: Vec::new(),
            ..options
        };
        match gls::fit(&information, &coordinates, &options) {
            Some(fit) => Ok(Self {
                coordinates,
                information,
                fit,
            }),
            None => Err(not_excited(plan, moments)),
        }
    }
}

fn not_excited(plan: &Plan, moments: &Moments) -> Error {
    let basis = plan.basis;
    let scan = NestedBanks::scan(moments, basis.settling(), &[], FIRST_ORDER);
    let excited = scan.map_or(1, |scan| scan.excited());
    let highest = (excited / 2) as f64;
    let highest_hz = highest / (basis.settling() as f64 * moments.sample_period_s());
    Error::NotExcited {
        asked: basis.frequencies(),
        excited,
        highest_hz,
    }
}

/// Estimated relative error of a fit through moments: rounding times the condition number for the
/// response, and times the ratio of signal to noise for the noise, whose moments are differences
/// of much larger ones. The factors are the largest seen against QR.
fn relative_error(information: &RowInformation, fit: &GlsFit) -> f64 {
    let response = ROUNDING * fit.solution.condition;
    let noise = 10.0 * f64::EPSILON * information.moments.output_spread() / fit.solution.rss;
    if noise.is_nan() {
        f64::INFINITY
    } else {
        response.max(noise)
    }
}
