//! Metrics of seeded draws of a response: where several samples may be the one at which a level is
//! passed, the distribution of a crossing has no formula.
//!
//! Only the samples that a metric can depend on are drawn, jointly, from one factor of their
//! covariance. Draws come in pairs z, -z, which serve both tails alike.

use faer::Mat;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

use super::interval::Interval;
use super::sample_uncertainty::{Joint, semidefinite_factor};
use crate::numerics::pointwise_critical;

/// Seed of the draws: the same record always gives the same intervals.
const SEED: u64 = 20_250_917;

/// Draws beyond each bound. With k of them the probability outside a bound is known to 1/sqrt(k)
/// of itself: a fifth for 25, so that "99 %" is between 98.8 and 99.2 %.
const BEYOND: f64 = 25.0;

/// Level up to which bounds are quantiles of draws; further out they are extended as a normal
/// distribution's, for the number of draws would grow without limit.
const DRAWN_LEVEL: f64 = 0.99;

/// Pairs of draws for a level.
fn pairs(level: f64) -> usize {
    (BEYOND / (1.0 - level.min(DRAWN_LEVEL))).ceil() as usize
}

/// Metrics of draws of `curve` about the samples of `joint`, for an interval of `level`: draws of
/// each metric that `read` gives.
pub(crate) fn of_curve<const K: usize>(
    curve: &[f64],
    joint: &Joint,
    level: f64,
    read: impl Fn(&[f64]) -> [f64; K],
) -> [Vec<f64>; K] {
    let mut random = ChaCha8Rng::seed_from_u64(SEED);
    let mut normals = Mat::<f64>::zeros(joint.points.len(), pairs(level));
    for k in 0..normals.ncols() {
        for z in normals.col_as_slice_mut(k) {
            *z = StandardNormal.sample(&mut random);
        }
    }
    let deviations = semidefinite_factor(&joint.covariance) * normals;
    let mut drawn = curve.to_vec();
    let mut metrics = [const { Vec::new() }; K];
    for k in 0..deviations.ncols() {
        for side in [1.0, -1.0] {
            for (&m, deviation) in joint.points.iter().zip(deviations.col_as_slice(k)) {
                drawn[m] = curve[m] + side * deviation;
            }
            for (metric, value) in metrics.iter_mut().zip(read(&drawn)) {
                metric.push(value);
            }
        }
    }
    metrics
}

/// The interval of a metric from its value and its draws.
pub(crate) fn interval_of(value: f64, mut draws: Vec<f64>, level: f64) -> Interval {
    if !value.is_finite() || draws.is_empty() {
        return Interval::new(value, f64::INFINITY, f64::INFINITY);
    }
    let drawn = level.min(DRAWN_LEVEL);
    let beyond = (draws.len() as f64 * (1.0 - drawn) / 2.0) as usize;
    let last = draws.len() - 1;
    let mut at = |k: usize| *draws.select_nth_unstable_by(k, f64::total_cmp).1;
    let (low, high) = (at(beyond.min(last)), at(last - beyond.min(last)));
    let stretch = pointwise_critical(level) / pointwise_critical(drawn);
    Interval::new(
        value,
        value - stretch * (value - low),
        value + stretch * (high - value),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_abs_diff_eq;

    #[test]
    fn intervals_of_normal_draws_are_those_of_the_distribution_at_any_level() {
        for level in [0.9, 0.99, 0.9999] {
            let mut random = ChaCha8Rng::seed_from_u64(3);
            let count = 2 * pairs(level);
            let draws: Vec<f64> = (0..count)
                .map(|_| StandardNormal.sample(&mut random))
                .collect();
            let interval = interval_of(0.0, draws, level);
            let exact = pointwise_critical(level);
            // sd of a quantile with 25 draws beyond it: about 8 % at 99 %.
            assert_abs_diff_eq!(interval.upper.unwrap(), exact, epsilon = 0.25 * exact);
            assert_abs_diff_eq!(interval.lower.unwrap(), -exact, epsilon = 0.25 * exact);
        }
        assert_eq!(pairs(0.99), 2500);
    }
}
