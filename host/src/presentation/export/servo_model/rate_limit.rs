//! The rate limit that comes closest to a drive that must first build up speed.

use super::trial_command::Trial;

/// Each rate that is tried is this part of the last.
pub(super) const FACTOR: f64 = 0.97;

/// A rate limit beside a servo.
#[derive(Clone, Copy)]
pub(super) struct RateFit {
    /// The rate as a share of the top speed.
    pub share: f64,
    /// The root mean square of the difference.
    pub difference: f64,
}

/// The share of the top speed that, as a rate limit, gives the least mean square of the difference from `exact`; `respond` has the
/// positions for a share of the speed `top`, which may be none. In strokes that end before the drive reaches its top speed it is well below 1. It may be below the highest speed
/// that the servo reached: a limit acts from the beginning of a stroke to its end, and the mean over the stroke counts.
pub(super) fn best_share(
    trial: &Trial,
    exact: &[f64],
    top: Option<f64>,
    respond: impl Fn(f64) -> Vec<f64>,
) -> RateFit {
    let tried = shares(trial, top).map(|share| RateFit {
        share,
        difference: trial.root_mean_square(&respond(share), exact),
    });
    let full = RateFit {
        share: 1.0,
        difference: f64::INFINITY,
    };
    tried
        .min_by(|a, b| a.difference.total_cmp(&b.difference))
        .unwrap_or(full)
}

/// The shares that are tried: from the top speed down to the rate at which the largest stroke takes the whole time of a level. A top
/// speed that the recording does not determine may be a thousand times what any stroke shows, so it begins no higher than one stroke in a
/// step. Without a top speed there is the whole one alone.
fn shares(trial: &Trial, top: Option<f64>) -> impl Iterator<Item = f64> {
    let of_step = top.map_or(1.0, |top| trial.largest_stroke() / trial.step_s / top);
    let quickest = of_step.min(1.0);
    let slowest = top.map_or(1.0, |_| of_step / trial.steps_per_level as f64);
    std::iter::successors(Some(quickest), |share| Some(FACTOR * share))
        .take_while(move |share| *share == quickest || *share >= slowest)
}
