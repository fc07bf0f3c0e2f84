//! Whether estimates through moments are accurate enough.

use super::GlsFit;
use super::least_squares::RowInformation;
use crate::thresholds::MOMENT_ACCURACY;

/// Rounding of the response per unit of the condition number: the largest seen against QR.
const ROUNDING: f64 = 50.0 * f64::EPSILON;

/// Condition number up to which moments are accurate enough.
pub(crate) const WELL_CONDITIONED: f64 = MOMENT_ACCURACY / ROUNDING;

/// Whether rounding leaves a fit through moments as accurate as it has to be. The error is rounding times the
/// condition number for the response, and times the ratio of signal to noise for the noise, whose moments are
/// differences of much larger ones. The factors are the largest seen against QR.
pub(crate) fn is_accurate(information: &RowInformation, fit: &GlsFit) -> bool {
    let response = ROUNDING * fit.solution.condition;
    let noise = 10.0 * f64::EPSILON * information.moments.output_spread() / fit.solution.rss;
    response <= MOMENT_ACCURACY && noise <= MOMENT_ACCURACY
}
