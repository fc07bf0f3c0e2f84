//! The rate limit that comes closest to a drive that must first build up speed.

use super::trial_command::Trial;

/// Rates that are tried: the top speed, and shares of it down to this.
const LOWEST_SHARE: f64 = 0.05;

/// How many rates are tried, each by the same factor below the last: 3 %.
const TRIED: usize = 100;

/// A rate limit beside a servo.
#[derive(Clone, Copy)]
pub(super) struct RateFit {
    /// The rate as a share of the top speed.
    pub share: f64,
    /// The root mean square of the difference.
    pub difference: f64,
}

/// The share of the top speed that, as a rate limit, gives the least mean square of the difference from `exact`; `respond` has the
/// positions for a share. In strokes that end before the drive reaches its top speed it is well below 1. It may be below the highest speed
/// that the servo reached: a limit acts from the beginning of a stroke to its end, and the mean over the stroke counts.
pub(super) fn best_share(
    trial: &Trial,
    exact: &[f64],
    respond: impl Fn(f64) -> Vec<f64>,
) -> RateFit {
    let shares = (0..TRIED).map(|k| LOWEST_SHARE.powf(k as f64 / (TRIED - 1) as f64));
    let tried = shares.map(|share| RateFit {
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
