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
use crate::identify::own_fits::p_of_own_fits;
use crate::identify::task::Task;
use crate::selection::Choice;
use crate::thresholds::SCATTER_SIGNIFICANCE;

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
pub(in crate::identify) fn tested(task: &Task<'_>, fitted: &Fitted) -> Option<Feedback> {
    let estimate = &fitted.estimate;
    let (moments, fit) = (&estimate.information.moments, &estimate.fit);
    let record = task.record?;
    // Inputs to come are then those of the past, which the end of the response still answers.
    let repeats = |choice: &Choice| choice.repeats_after.is_some() && !choice.settled;
    if fitted.candidate.plan.choice.as_ref().is_some_and(repeats) {
        return None;
    }
    let runs = simulated(record, moments, fit);
    let found = feedback(record, &runs, moments, fit, at_once(fitted));
    // Where runs differ, inputs to come must explain their own fits, too.
    let apart = fitted.linearity.and_then(|found| found.runs);
    let differ = apart.is_some_and(|runs| runs.p < SCATTER_SIGNIFICANCE);
    let p_of = |task: &Task<'_>, fitted: &Fitted| Some(tested(task, fitted)?.p);
    let own = match found.is_followed() && differ {
        true => p_of_own_fits(task, fitted, p_of),
        false => None,
    };
    Some(Feedback {
        p: own.map_or(found.p, |p| p.max(found.p)),
        ..found
    })
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
    let first_point = map.as_ref().subrows(0, 1).to_owned();
    let variance = CurveVariance::of_fit(&estimate.information, &estimate.fit, &first_point);
    let largest = step.iter().fold(0.0, |most: f64, g| most.max(g.abs()));
    match (step.first(), step.last(), variance.sd.first()) {
        (Some(first), Some(last), Some(sd)) if *sd > 0.0 => {
            (first * (last - first).signum() / sd, first.abs() / largest)
        }
        _ => (0.0, 0.0),
    }
}
