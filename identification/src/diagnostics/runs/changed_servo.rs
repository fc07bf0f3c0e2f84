//! What a change of the servo makes of its response.
//!
//! A servo G = exp(-s τ) b/a(s) with another supply has another gain, delay, spring and damping. The last two are the coefficients of 1 and of
//! s in a(s), and
//!
//! ```text
//! ∂G/∂a_i = -sⁱ exp(-s τ) b/a(s)² ∝ sⁱ exp(s τ) G(s)²
//! ```
//!
//! So the response to an impulse convolved with itself, and τ earlier, is what damping changes of the response to a step; the sum of that
//! is what the spring changes. Both are known without a(s), of whatever order, and the noise of single samples is averaged out.

use crate::estimation::GlsFit;
use crate::numerics::{causal_filter, running_sum};

use super::delayed_response::slope_and_bend;

/// Gain, delay, spring and damping.
pub(super) const CHANGES: usize = 4;

/// The change of the response with each quantity, in the coordinates of the fit.
pub(super) fn changes(fit: &GlsFit) -> [Vec<f64>; CHANGES] {
    let [slope, _] = slope_and_bend(fit);
    let [spring, damping] =
        of_dynamics(&fit.impulse()).map(|impulse| fit.coordinates.of_impulse(&impulse));
    [fit.solution.response().to_vec(), slope, spring, damping]
}

/// As impulse responses, for spring and damping.
fn of_dynamics(impulse: &[f64]) -> [Vec<f64>; 2] {
    let step = running_sum(impulse);
    // The last element gathers what comes later, and stands for no time.
    let (Some((_, before)), Some(&last)) = (impulse.split_last(), step.last()) else {
        return [Vec::new(), Vec::new()];
    };
    let twice: Vec<f64> = [before, &vec![0.0; impulse.len()]].concat();
    let squared = causal_filter(before, &twice, Some(0.0));
    let damping = earlier(&squared, onset(&step), before.len());
    let mut spring = running_sum(&damping);
    spring.push(last * last);
    [
        differences(&spring),
        differences(&[damping, vec![0.0]].concat()),
    ]
}

/// The share of the final value at which a response has begun.
const BEGUN: f64 = 0.05;

/// When a step response begins to rise, between samples: before it has half of its final value.
fn onset(step: &[f64]) -> f64 {
    let last = step[step.len() - 1];
    let Some(half) = step.iter().position(|g| g / last >= 0.5) else {
        return 0.0;
    };
    let below = step[..half].iter().rposition(|g| g / last < BEGUN);
    below.map_or(0.0, |m| {
        let [before, after] = [m, m + 1].map(|m| step[m] / last);
        m as f64 + (BEGUN - before) / (after - before)
    })
}

/// The first `samples` of the line through `values` from `start` on.
fn earlier(values: &[f64], start: f64, samples: usize) -> Vec<f64> {
    let (whole, part) = (start as usize, start.fract());
    let at = |k: usize| values.get(k).copied().unwrap_or(0.0);
    (whole..whole + samples)
        .map(|k| (1.0 - part) * at(k) + part * at(k + 1))
        .collect()
}

fn differences(step: &[f64]) -> Vec<f64> {
    let before = std::iter::once(&0.0).chain(step);
    step.iter().zip(before).map(|(g, b)| g - b).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numerics::dot;

    /// Of a second-order servo behind 13.3 ms, sampled each 5 ms, and its final value.
    fn step(zeta: f64, omega: f64) -> Vec<f64> {
        let damped = omega * (1.0f64 - zeta * zeta).sqrt();
        let at = |m: usize| {
            let t = (m as f64 * 0.005 - 0.0133).max(0.0);
            let (sin, cos) = (damped * t).sin_cos();
            1.0 - (-zeta * omega * t).exp() * (cos + zeta * omega / damped * sin)
        };
        (0..60).map(at).chain([1.0]).collect()
    }

    /// The share of `values` that no combination of `columns` has.
    fn left(values: &[f64], columns: &[Vec<f64>]) -> f64 {
        let mut rest = values.to_vec();
        let mut before: Vec<Vec<f64>> = Vec::new();
        for column in columns {
            let mut own = column.clone();
            for of in before.iter().map(Vec::as_slice) {
                take(&mut own, of);
            }
            take(&mut rest, &own);
            before.push(own);
        }
        (dot(&rest, &rest) / dot(values, values)).sqrt()
    }

    fn take(from: &mut [f64], of: &[f64]) {
        let share = dot(from, of) / dot(of, of);
        from.iter_mut().zip(of).for_each(|(x, y)| *x -= share * y);
    }

    #[test]
    fn natural_frequency_and_damping_change_what_gain_delay_spring_and_damping_do() {
        let base = step(0.6, 50.0);
        let slope = |m: usize| match (1..base.len() - 2).contains(&m) {
            true => base[m + 1] - base[m - 1],
            false => 0.0,
        };
        let gain_and_delay = [base.clone(), (0..base.len()).map(slope).collect()];
        let dynamics = of_dynamics(&differences(&base)).map(|impulse| running_sum(&impulse));
        let all = [gain_and_delay.clone(), dynamics].concat();
        for changed in [step(0.61, 50.0), step(0.6, 51.0)] {
            let change: Vec<f64> = changed.iter().zip(&base).map(|(c, b)| c - b).collect();
            // A change of two per cent has a curvature of that order, too.
            assert!(left(&change, &all) < 0.03, "{}", left(&change, &all));
            assert!(left(&change, &gain_and_delay) > 0.4);
        }
    }
}
