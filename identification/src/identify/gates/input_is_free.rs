//! Gate: is the input independent of the noise?
//!
//! Protects: bounds from recordings in closed loop, where the estimate is a mixture of the servo and the inverse of the
//! controller, and its bounds are narrow.
//!
//! If not, bounds lose their level: no other candidate of this record is better. Where errors are no noise the fit that was tested
//! as noise is asked, and for the response at lag 0 alone: the errors of a servo that is not linear are related to what a
//! planned reference does next.

use crate::diagnostics::{Feedback, feedback, simulated};
use crate::error::Error;
use crate::estimation::CurveVariance;
use crate::identify::fitted::Fitted;
use crate::identify::task::Task;

pub(super) fn pass(task: &Task<'_>, fitted: Fitted) -> Result<Fitted, Error> {
    if fitted.misfit.is_some() {
        return Ok(fitted);
    }
    Ok(Fitted {
        feedback: tested(task, &fitted),
        ..fitted
    })
}

/// What the errors of a fit show of feedback.
pub(super) fn tested(task: &Task<'_>, fitted: &Fitted) -> Option<Feedback> {
    let estimate = &fitted.estimate;
    let (moments, fit) = (&estimate.information.moments, &estimate.fit);
    let record = task.record?;
    let runs = simulated(record, moments, fit);
    Some(feedback(record, &runs, moments, fit, at_once(fitted)))
}

/// The response at lag 0: in standard deviations, positive in the direction of what follows, and as a share of the largest
/// value; 0 where frequencies are left out, because all lags share what they lack.
fn at_once(fitted: &Fitted) -> (f64, f64) {
    let estimate = &fitted.estimate;
    let basis = estimate.coordinates.basis;
    if !basis.is_complete() {
        return (0.0, 0.0);
    }
    let step = basis.step_response(&estimate.fit.theta());
    let map = estimate.coordinates.step_map();
    let variance = CurveVariance::of_fit(&estimate.information, &estimate.fit, &map);
    let largest = step.iter().fold(0.0, |most: f64, g| most.max(g.abs()));
    match (step.first(), step.last(), variance.sd.first()) {
        (Some(first), Some(last), Some(sd)) if *sd > 0.0 => {
            (first * (last - first).signum() / sd, first.abs() / largest)
        }
        _ => (0.0, 0.0),
    }
}
