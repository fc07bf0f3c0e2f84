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
    let found = MotionAfterHold::of(&step, hold)?;
    if found.larger_by < MATERIAL_MISFIT_PERCENT / 100.0 * found.largest {
        return None;
    }
    let (before, after) = (found.before, found.after);
    let map = fit.coordinates.step_map();
    let signs = [after, before].map(|m| (step[m] - step[hold]).signum());
    let contrast = faer::Mat::from_fn(1, map.ncols(), |_, j| {
        signs[0] * (map[(after, j)] - map[(hold, j)])
            - signs[1] * (map[(before, j)] - map[(hold, j)])
    });
    let sd = CurveVariance::of_fit(information, fit, &contrast).sd[0];
    // The farthest of so many. The steps of the sensor move either of the two.
    let chance =
        normal_upper_quantile(MISFIT_SIGNIFICANCE / found.window as f64) * sd + 2.0 * rounding;
    let shown = found.larger_by > chance && found.is_from_rest(&step, chance);
    shown.then(|| (step[after] - step[hold]).abs() / found.largest)
}

/// How a step response moves around the end of a hold.
struct MotionAfterHold {
    hold: usize,
    /// Samples before and after the end that are looked at.
    window: usize,
    /// Where it is farthest from where it is at the end, before and after.
    before: usize,
    after: usize,
    /// By how much it is farther after the end.
    larger_by: f64,
    /// Its largest value.
    largest: f64,
}

impl MotionAfterHold {
    /// `None` where the response is over with the hold.
    fn of(step: &[f64], hold: usize) -> Option<Self> {
        let window = (hold / 2).min(step.len().saturating_sub(hold + 1));
        let from_hold = |m: &usize| (step[*m] - step[hold]).abs();
        let farthest = |samples: std::ops::Range<usize>| {
            samples.max_by(|a, b| from_hold(a).total_cmp(&from_hold(b)))
        };
        let before = farthest(hold - window..hold)?;
        let after = farthest(hold + 1..hold + window + 1)?;
        Some(Self {
            hold,
            window,
            before,
            after,
            larger_by: from_hold(&after) - from_hold(&before),
            largest: step.iter().fold(0.0, |most, g| most.max(g.abs())),
        })
    }

    /// Whether it has come to rest within the hold, but for `chance`.
    fn is_from_rest(&self, step: &[f64], chance: f64) -> bool {
        let at_end = step[self.hold];
        let moved = (step[self.before] - at_end).abs();
        at_end.abs() >= ANSWERED_WITHIN_HOLD * self.largest
            && moved <= MOVES_AT_REST * at_end.abs() + chance
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A servo of 40 rad/s in rows of 2 ms that answers after `delay` samples.
    fn ringing(damping: f64, delay: usize) -> Vec<f64> {
        let damped = (1.0 - damping * damping).sqrt();
        let at = |k: usize| {
            let angle = 40.0 * 0.002 * k.saturating_sub(delay) as f64;
            let (sin, cos) = (damped * angle).sin_cos();
            1.0 - (-damping * angle).exp() * (cos + damping / damped * sin)
        };
        (0..600).map(at).collect()
    }

    #[test]
    fn nothing_that_rings_moves_again_from_rest_whatever_the_hold() {
        for damping in [0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.35, 0.4, 0.5, 0.6] {
            for delay in [0, 5, 10, 25, 50] {
                let step = ringing(damping, delay);
                for hold in 5..350 {
                    let found = MotionAfterHold::of(&step, hold).unwrap();
                    let moves = found.larger_by > MATERIAL_MISFIT_PERCENT / 100.0 * found.largest;
                    let again = moves && found.is_from_rest(&step, 0.0);
                    assert!(!again, "{damping}, {delay}, {hold}");
                }
            }
        }
    }

    #[test]
    fn what_rests_and_moves_a_hold_later_moves_again() {
        let mut step = ringing(0.6, 5);
        for (k, g) in step.iter_mut().enumerate().skip(205) {
            *g += 0.05 * (1.0 - (-((k - 205) as f64) / 10.0).exp());
        }
        let found = MotionAfterHold::of(&step, 200).unwrap();
        assert!(found.larger_by > 0.03 && found.is_from_rest(&step, 0.0));
    }
}
