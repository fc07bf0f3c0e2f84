//! Whether a servo of low order lacks a slow end.
//!
//! The end of a response is below the band that a sweep excites, or at its edge. All values of the estimate together show an end late, as it is in few of them; where it
//! is not seen, it is missing in the gain. So the errors are held against what an end of one time constant and then another would leave in them.

use super::levenberg_marquardt::Minimum;
use super::low_order::LowOrder;
use crate::numerics::{dot, normal_cdf, times};

/// The shortest time constant, in those of the servo's slowest pole: a shorter one is as a pole of its own.
const SHORTEST: f64 = 4.0;

/// The time constants, each twice the one before, up to `longest_s` \[s\].
pub(super) fn time_constants(servo: &LowOrder, longest_s: f64) -> Vec<f64> {
    let shortest = SHORTEST / servo.slowest_pole();
    std::iter::successors(Some(shortest), |time_constant| Some(2.0 * time_constant))
        .take_while(|time_constant| *time_constant <= longest_s)
        .collect()
}

/// The probability that errors of noise alone look as much like one of these slow ends: what each leaves in the whitened estimate is in `ends`. With Bonferroni's
/// correction; 1 where there are none.
pub(super) fn probability(minimum: &Minimum, ends: &[Vec<f64>]) -> f64 {
    let transposed = minimum.jacobian.transpose().to_owned();
    let deviation = |end: &Vec<f64>| {
        // What the parameters of the order take of it.
        let along = times(&transposed, end);
        let taken = dot(&along, &times(&minimum.covariance, &along));
        let left = dot(end, end) - taken;
        let is_seen = left > 1e-9 * dot(end, end);
        is_seen.then(|| dot(end, &minimum.residuals) / left.sqrt())
    };
    let deviations = ends.iter().filter_map(deviation);
    let largest = deviations.map(f64::abs).fold(0.0, f64::max);
    (2.0 * normal_cdf(-largest) * ends.len() as f64).min(1.0)
}
