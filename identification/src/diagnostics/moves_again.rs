//! Whether a response that has come to rest moves again a hold later.
//!
//! A servo with play, friction or a dead band answers a change of the command according to the change before. Where all holds are of one
//! length, a linear model of more lags than a hold describes that without an error: as a late part of the response, which begins with the
//! next change. Its bounds would be those of a response that no servo has. What has come to rest within a hold stays there, so motion after the
//! hold that is larger than in as long a time before its end shows such a servo.
//!
//! What is under way at the end of a hold shows nothing: a servo that rings and is held until just before its first peak, or into its dead time, moves
//! more afterwards, too.

use crate::estimation::{CurveVariance, GlsFit, RowInformation};
use crate::numerics::normal_upper_quantile;
use crate::thresholds::{
    ANSWERED_WITHIN_HOLD, MATERIAL_MISFIT_PERCENT, MISFIT_SIGNIFICANCE, MOVES_AT_REST,
};

/// The share of its largest value by which the response of `fit` moves again after `hold` samples; `None` where it does not beyond
/// chance, or by nothing that matters.
///
/// `rounding` is the largest error of the response that the steps of the sensor leave \[output per input\].
pub(crate) fn moves_again(
    information: &RowInformation,
    fit: &GlsFit,
    hold: usize,
    rounding: f64,
) -> Option<f64> {
    let step = fit.coordinates.basis.step_response(&fit.theta());
    let window = (hold / 2).min(step.len().saturating_sub(hold + 1));
    let from_hold = |m: &usize| (step[*m] - step[hold]).abs();
    let farthest = |samples: std::ops::Range<usize>| {
        samples.max_by(|a, b| from_hold(a).total_cmp(&from_hold(b)))
    };
    let before = farthest(hold - window..hold)?;
    let after = farthest(hold + 1..hold + window + 1)?;
    let larger_by = from_hold(&after) - from_hold(&before);
    let largest = step.iter().fold(0.0f64, |most, g| most.max(g.abs()));
    let is_answered = step[hold].abs() >= ANSWERED_WITHIN_HOLD * largest;
    if !is_answered || larger_by < MATERIAL_MISFIT_PERCENT / 100.0 * largest {
        return None;
    }
    let map = fit.coordinates.step_map();
    let signs = [after, before].map(|m| (step[m] - step[hold]).signum());
    let contrast = faer::Mat::from_fn(1, map.ncols(), |_, j| {
        signs[0] * (map[(after, j)] - map[(hold, j)])
            - signs[1] * (map[(before, j)] - map[(hold, j)])
    });
    let sd = CurveVariance::of_fit(information, fit, &contrast).sd[0];
    // The farthest of so many.
    let chance = normal_upper_quantile(MISFIT_SIGNIFICANCE / window as f64) * sd;
    // It moves either of the two.
    let chance = chance + 2.0 * rounding;
    let is_at_rest = from_hold(&before) <= MOVES_AT_REST * step[hold].abs() + chance;
    (is_at_rest && larger_by > chance).then(|| from_hold(&after) / largest)
}
