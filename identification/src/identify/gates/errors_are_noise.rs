//! Gate: are the errors noise?
//!
//! Protects: bounds that whitening has made too narrow, and step responses that it has bent.
//!
//! If not, bounds lose their level, and structure and estimator are those that predict best the parts of the
//! record that they have not seen. Where no part predicts another, the first estimator is kept unless plain least
//! squares simulates the record better. Then the settling time, which was detected by the same weights, is
//! not to be trusted either, and the longest that the record supports is taken, if its input determines that.

use super::input_is_free;
use crate::data::{Moments, share_held};
use crate::diagnostics::{
    BothEstimators, Feedback, Misfit, MisfitEvidence, Prediction, explained_by_output,
    followed_after, rank, settlings, unexcited_above_hz,
};
use crate::error::Error;
use crate::estimation::{FsfBasis, GlsFit, GlsOptions, RowInformation};
use crate::identify::candidate::Candidate;
use crate::identify::estimate::Estimate;
use crate::identify::fitted::Fitted;
use crate::identify::task::Task;
use crate::options::{Frequencies, NoiseOrder};
use crate::selection::longest_for_prediction;

/// Plain least squares: the noise is not modelled.
const PLAIN: NoiseOrder = NoiseOrder::Order(0);

pub(super) fn pass(task: &Task<'_>, fitted: Fitted) -> Result<Fitted, Error> {
    let (linearity, outlasts_holds) = (fitted.linearity, fitted.outlasts_holds);
    let suspect = linearity
        .is_some_and(|found| found.errors_follow_motion() || found.between_runs().is_some());
    let (information, fit) = (&fitted.estimate.information, &fitted.estimate.fit);
    let Some(both) = BothEstimators::new(information, fit, suspect) else {
        return Ok(fitted);
    };
    let of_errors = || both.evidence(linearity, || share_followed(task, &fitted.estimate));
    let moves_again = fitted.moves_again.map(MisfitEvidence::MovesAgain);
    let stated = (fitted.stated_beyond_hold).map(MisfitEvidence::StatedBeyondHold);
    let beyond_holds = outlasts_holds.map(MisfitEvidence::OutlastsHolds);
    let Some(evidence) = (stated.or(moves_again)).or_else(of_errors).or(beyond_holds) else {
        return Ok(fitted);
    };
    let feedback = input_is_free::tested(task, &fitted).map(|found| Feedback {
        explained: task.recorded.and_then(explained_by_output),
        ..found
    });
    let predictions = rank_by_prediction(task, &fitted);
    let (candidate, estimate) = match predictions.first() {
        Some(best) => fit_again(task, best_predictor(task, &fitted.candidate, *best)?)?,
        None => better_at_simulation(task, fitted, &both)?,
    };
    let misfit = Misfit {
        least_squares_percent: both.least_squares_percent,
        generalised_percent: both.generalised_percent,
        candidates: predictions,
        other_step: other_step(task, &candidate, &estimate),
        unexcited_above_hz: unexcited_above_hz(
            &estimate.information.moments,
            &estimate.coordinates,
        ),
        evidence,
    };
    Ok(Fitted {
        linearity,
        outlasts_holds,
        misfit: Some(misfit),
        feedback,
        ..Fitted::untested(candidate, estimate)
    })
}

/// The share of the input's steps that are held until the servo has followed.
fn share_followed(task: &Task<'_>, estimate: &Estimate) -> f64 {
    let basis = estimate.coordinates.basis;
    let followed = followed_after(&basis.step_response(&estimate.fit.theta()));
    task.record
        .map_or(1.0, |record| share_held(record, followed))
}

/// Structures and estimators by how well they predict parts of the record that they have not seen.
fn rank_by_prediction(task: &Task<'_>, fitted: &Fitted) -> Vec<Prediction> {
    let Some(record) = task.record else {
        return Vec::new();
    };
    let (options, candidate) = (task.options, &fitted.candidate);
    let settling = candidate.plan.basis.settling();
    let tried = match &candidate.plan.choice {
        None => vec![settling],
        // What comes after a hold predicts equal holds alone.
        Some(choice) if fitted.rests_within_holds() => settlings(settling, choice.longest),
        Some(choice) => {
            let longest = longest_for_prediction(record, options.longest_settling);
            settlings(settling, longest.max(choice.longest))
        }
    };
    let frequencies = match options.frequencies {
        Frequencies::Count(count) => Some(count),
        _ => None,
    };
    rank(record, &tried, frequencies, options.noise_order)
}

fn best_predictor(
    task: &Task<'_>,
    candidate: &Candidate,
    best: Prediction,
) -> Result<Candidate, Error> {
    let basis = FsfBasis::new(best.settling, best.frequencies)?;
    let order = if best.generalised {
        candidate.plan.order
    } else {
        PLAIN
    };
    Ok(candidate.with(task, basis, order))
}

/// Of the estimator that simulates the record better, where no part of it predicts another.
fn better_at_simulation(
    task: &Task<'_>,
    fitted: Fitted,
    both: &BothEstimators,
) -> Result<(Candidate, Estimate), Error> {
    let Fitted {
        candidate,
        estimate,
        ..
    } = fitted;
    if both.generalised_percent >= both.least_squares_percent {
        return Ok((candidate, estimate));
    }
    if let Some(choice) = &candidate.plan.choice
        && candidate.plan.basis.is_complete()
    {
        let longest = candidate.with(task, FsfBasis::full(choice.longest)?, PLAIN);
        if let Ok(longest) = fit_again(task, longest) {
            return Ok(longest);
        }
    }
    fit_again(task, candidate.with(task, both.plain_basis, PLAIN))
}

fn fit_again(task: &Task<'_>, candidate: Candidate) -> Result<(Candidate, Estimate), Error> {
    let estimate = Estimate::new(&candidate.plan, &candidate.moments, task.record)?;
    Ok((candidate, estimate))
}

/// The step response by the other estimator at the structure that was taken; with its own noise model if it
/// has one, which needs further lags.
fn other_step(task: &Task<'_>, candidate: &Candidate, adopted: &Estimate) -> Vec<f64> {
    let order = match candidate.plan.order {
        PLAIN => task.options.noise_order,
        _ => PLAIN,
    };
    let coordinates = &adopted.coordinates;
    let lags = order.highest();
    let moments = match task.record {
        Some(record) => Moments::of_record(record, coordinates.basis.settling() + lags, lags + 1),
        None => adopted.information.moments.clone(),
    };
    let options = GlsOptions {
        order,
        ..GlsOptions::default()
    };
    GlsFit::of(
        &RowInformation::from_moments(moments),
        coordinates,
        &options,
    )
    .map_or_else(Vec::new, |fit| {
        coordinates.basis.step_response(&fit.theta())
    })
}
