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
//!
//! A drive at its limit moves at a speed that goes with its supply, whatever a(s) is. There time itself runs faster from the onset t₀ of the
//! response on, and the step response changes by (t - t₀) dg/dt.

use crate::estimation::GlsFit;
use crate::numerics::{causal_filter, running_sum};

use super::delayed_response::slope_and_bend;

/// Gain, delay, spring, damping and speed.
pub(super) const CHANGES: usize = 5;

/// The change of the response with each quantity, in the coordinates of the fit.
pub(super) fn changes(fit: &GlsFit) -> [Vec<f64>; CHANGES] {
    let [slope, _] = slope_and_bend(fit);
    let [spring, damping, speed] =
        of_dynamics(&fit.impulse()).map(|impulse| fit.coordinates.of_impulse(&impulse));
    let gain = fit.solution.response().to_vec();
    [gain, slope, spring, damping, speed]
}

/// As impulse responses, for spring, damping and speed.
fn of_dynamics(impulse: &[f64]) -> [Vec<f64>; 3] {
    let step = running_sum(impulse);
    // The last element gathers what comes later, and stands for no time.
    let (Some((_, before)), Some(&last)) = (impulse.split_last(), step.last()) else {
        return [const { Vec::new() }; 3];
    };
    let onset = onset(&step);
    let twice: Vec<f64> = [before, &vec![0.0; impulse.len()]].concat();
    let squared = causal_filter(before, &twice, Some(0.0));
    let damping = earlier(&squared, onset, before.len());
    let spring = running_sum(&damping);
    let speed = faster(&step[..before.len()], onset);
    [(spring, last * last), (damping, 0.0), (speed, 0.0)]
        .map(|(change, at_rest)| differences(&[change, vec![at_rest]].concat()))
}

/// What time that runs faster from `onset` on changes of `step`.
fn faster(step: &[f64], onset: f64) -> Vec<f64> {
    let at = |m: usize| step.get(m).copied().unwrap_or(0.0);
    let change = |m: usize| match m + 1 < step.len() {
        true => (m as f64 - onset) * (at(m + 1) - at(m.wrapping_sub(1))) / 2.0,
        false => 0.0,
    };
    (0..step.len()).map(change).collect()
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
    use servoid_test_support::limited_drive::LimitedDrive;

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

    /// What each of the quantities changes, in the order of [`changes`].
    fn all_changes(base: &[f64]) -> Vec<Vec<f64>> {
        let slope = |m: usize| match (1..base.len() - 2).contains(&m) {
            true => base[m + 1] - base[m - 1],
            false => 0.0,
        };
        let gain_and_delay = [base.to_vec(), (0..base.len()).map(slope).collect()];
        let dynamics = of_dynamics(&differences(base)).map(|impulse| running_sum(&impulse));
        [gain_and_delay.as_slice(), &dynamics].concat()
    }

    fn difference(changed: &[f64], base: &[f64]) -> Vec<f64> {
        changed.iter().zip(base).map(|(c, b)| c - b).collect()
    }

    #[test]
    fn natural_frequency_and_damping_change_what_gain_delay_spring_and_damping_do() {
        let base = step(0.6, 50.0);
        let all = all_changes(&base);
        for changed in [step(0.61, 50.0), step(0.6, 51.0)] {
            let change = difference(&changed, &base);
            // A change of two per cent has a curvature of that order, too.
            assert!(left(&change, &all[..4]) < 0.03, "{}", left(&change, &all));
            assert!(left(&change, &all[..2]) > 0.4);
        }
    }

    /// Without the speed, a tenth of the change is left.
    #[test]
    fn a_limited_drive_of_another_supply_changes_what_speed_does() {
        let step = |drive: f64| -> Vec<f64> {
            let servo = LimitedDrive::new(1.0, 0.0133, drive);
            let at = |m: usize| servo.step(m as f64 * 0.005);
            (0..60).map(at).chain([1.0]).collect()
        };
        let base = step(1.0);
        let all = all_changes(&base);
        let change = difference(&step(1.02), &base);
        assert!(left(&change, &all) < 0.03, "{}", left(&change, &all));
        assert!(left(&change, &all[..4]) > 0.1);
    }
}
