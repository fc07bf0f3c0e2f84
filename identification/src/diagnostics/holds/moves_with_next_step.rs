//! Whether a response whose output rests within holds moves when they end.
//!
//! A servo with play or friction answers a change of the command according to the change before, by little or much. Where holds differ in length, a linear model
//! describes that as a late part of its response, which begins after the shortest holds and is smeared over the others. A servo that creeps moves late,
//! too. But it is ever slower: from the second half of a hold to the end of its response it moves by no more in each sample than before. What moves by
//! more answers the next step.

use crate::estimation::{CurveVariance, GlsFit, RowInformation};
use crate::numerics::{dot, normal_upper_quantile};
use crate::thresholds::MISFIT_SIGNIFICANCE;
use std::ops::Range;

/// Whether the response of `fit` moves after holds of `hold` samples by more than a creep would, beyond chance, where the output rests within `rest` samples.
///
/// `rounding` is the largest error of the response that the steps of the sensor leave \[output per input\]. What a creep does after N is in the last samples of
/// the response, so that the lags move by more with each of the `changes`, too, which slow ends make of them, and the standard deviations of these.
pub(crate) fn moves_with_next_step(
    information: &RowInformation,
    fit: &GlsFit,
    (rest, hold): (usize, usize),
    rounding: f64,
    changes: &[(Vec<f64>, Vec<f64>)],
) -> bool {
    let step = fit.coordinates.basis.step_response(&fit.theta());
    let Some(weights) = beyond_creep(&step, rest, hold) else {
        return false;
    };
    let map = fit.coordinates.step_map();
    let contrast = faer::Mat::from_fn(1, map.ncols(), |_, j| dot(&weights, map.col_as_slice(j)));
    let sd = CurveVariance::of_fit(information, fit, &contrast).sd[0];
    let of_rounding: f64 = weights.iter().map(|weight| weight.abs() * rounding).sum();
    // Either way counts.
    let chance = normal_upper_quantile(0.5 * MISFIT_SIGNIFICANCE);
    let moves_more = |by: f64, sd: f64| by > chance * sd + of_rounding;
    let by = dot(&weights, &step);
    let mut beside_ends = changes.iter().map(|(change, sd_of_change)| {
        let of_end = dot(&weights, sd_of_change);
        moves_more(by + dot(&weights, change), sd.hypot(of_end))
    });
    moves_more(by, sd) && beside_ends.all(|more| more)
}

/// By how much a response moves from the second half of a hold to well behind it, less what it moves by in as long a time at the speed that it had from the
/// `rest` of the output to there, as weights of its samples. `None` where one of these times is not after the other.
///
/// Means are taken: the last samples of a response have what it does after them, too.
fn beyond_creep(step: &[f64], rest: usize, hold: usize) -> Option<Vec<f64>> {
    let windows = [
        rest / 2..rest,
        hold / 2..3 * hold / 4,
        (hold + step.len()) / 2..step.len(),
    ];
    let [early, late, after] = &windows;
    let in_order = early.end <= late.start && late.end <= after.start;
    if !in_order || windows.iter().any(Range::is_empty) {
        return None;
    }
    let middle = |samples: &Range<usize>| 0.5 * (samples.start + samples.end - 1) as f64;
    let mean = |samples: &Range<usize>| {
        let all = &step[samples.clone()];
        all.iter().sum::<f64>() / all.len() as f64
    };
    let creeps = (middle(after) - middle(late)) / (middle(late) - middle(early));
    let direction = (mean(after) - mean(late)).signum();
    let mut weights = vec![0.0; step.len()];
    for (samples, weight) in windows.iter().zip([creeps, -1.0 - creeps, 1.0]) {
        weights[samples.clone()].fill(direction * weight / samples.len() as f64);
    }
    Some(weights)
}

#[cfg(test)]
mod tests {
    use super::*;

    const HOLD: usize = 370;
    const REST: usize = 92;

    fn beyond(response: impl Fn(f64) -> f64) -> f64 {
        let step: Vec<f64> = (0..599).map(|m| response(m as f64)).collect();
        dot(&beyond_creep(&step, REST, HOLD).unwrap(), &step)
    }

    /// What has no motion late or moves evenly has none that is more.
    #[test]
    fn a_creep_of_any_lag_moves_by_no_more() {
        assert!(beyond(|_| 1.0).abs() < 1e-12);
        assert!(beyond(|m| m).abs() < 1e-9);
        for lag in [20.0, 50.0, 100.0, 300.0, 1e3, 1e4] {
            assert!(beyond(|m| -(-m / lag).exp()) < 1e-9, "{lag}");
            assert!(beyond(|m| 1.0 + (-m / lag).exp()) < 1e-9, "{lag}");
        }
    }

    #[test]
    fn what_moves_with_the_next_step_moves_by_more() {
        for share in [0.003, -0.003] {
            let later = |m: f64| 1.0 + share / (1.0 + (-(m - 370.0) / 20.0).exp());
            assert!((beyond(later) - 0.003).abs() < 1e-4, "{share}");
        }
    }

    #[test]
    fn a_rest_that_takes_more_than_half_a_hold_is_compared_with_nothing() {
        assert_eq!(beyond_creep(&[1.0; 599], 200, HOLD), None);
        assert_eq!(beyond_creep(&[1.0; 250], REST, HOLD), None);
        assert_eq!(beyond_creep(&[], 0, 0), None);
    }
}
