//! The rate limit that comes closest to a drive that must first build up speed.

use super::trial_command::Trial;

/// Rates that are tried: the top speed, and shares of it down to this.
const LOWEST_SHARE: f64 = 0.05;

/// How many rates are tried, each by the same factor below the last: 3 %.
const TRIED: usize = 100;

/// The share of the top speed that, as a rate limit, gives the least squares of the difference from `exact`; `respond` has the
/// positions for a share. In strokes that end before the drive reaches its top speed it is well below 1.
pub(super) fn best_share(trial: &Trial, exact: &[f64], respond: impl Fn(f64) -> Vec<f64>) -> f64 {
    let squares = |share: f64| -> f64 {
        let found = respond(share);
        let pairs = found.iter().zip(exact).skip(trial.steps_per_level);
        pairs.map(|(a, b)| (a - b) * (a - b)).sum()
    };
    let shares = (0..TRIED).map(|k| LOWEST_SHARE.powf(k as f64 / (TRIED - 1) as f64));
    let tried = shares.map(|share| (squares(share), share));
    tried
        .min_by(|a, b| a.0.total_cmp(&b.0))
        .map_or(1.0, |best| best.1)
}
