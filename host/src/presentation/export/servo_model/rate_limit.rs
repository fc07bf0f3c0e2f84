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
    /// The sum of the squares of the difference.
    pub squares: f64,
}

/// The share of the top speed that, as a rate limit, gives the least squares of the difference from `exact`; `respond` has the
/// positions for a share. In strokes that end before the drive reaches its top speed it is well below 1.
pub(super) fn best_share(
    trial: &Trial,
    exact: &[f64],
    respond: impl Fn(f64) -> Vec<f64>,
) -> RateFit {
    let squares = |share: f64| -> f64 {
        let found = respond(share);
        let pairs = found.iter().zip(exact).skip(trial.steps_per_level);
        pairs.map(|(a, b)| (a - b) * (a - b)).sum()
    };
    let shares = (0..TRIED).map(|k| LOWEST_SHARE.powf(k as f64 / (TRIED - 1) as f64));
    let tried = shares.map(|share| RateFit {
        share,
        squares: squares(share),
    });
    let full = RateFit {
        share: 1.0,
        squares: f64::INFINITY,
    };
    tried
        .min_by(|a, b| a.squares.total_cmp(&b.squares))
        .unwrap_or(full)
}
