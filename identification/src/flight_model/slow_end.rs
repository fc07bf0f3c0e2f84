//! Whether a servo of low order lacks a slow end, and what one that is not seen may change.
//!
//! The end of a response is below the band that a sweep excites, or at its edge. All values of the estimate together show an end late, as it is in few of them; where it
//! is not seen, it is missing in the gain. So the errors are held against what an end of one time constant and then another would leave in them, and intervals allow for
//! an end as large as the estimate leaves it room for.

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
    let seen = ends.iter().filter_map(|end| Seen::of(minimum, end));
    let largest = seen
        .map(|seen| (seen.share * seen.left.sqrt()).abs())
        .fold(0.0, f64::max);
    (2.0 * normal_cdf(-largest) * ends.len() as f64).min(1.0)
}

/// What slow ends may change of each parameter of `minimum`, the first of which is the gain, as a standard deviation: the mean square of an end of which nothing was known before
/// the record. Which time constant it has is not seen, and the one counts that changes most. Infinite where one is not seen at all.
pub(super) fn allowances(minimum: &Minimum, ends: &[Vec<f64>]) -> Vec<f64> {
    let mut largest = vec![0.0; minimum.parameters.len()];
    for end in ends {
        let Some(seen) = Seen::of(minimum, end) else {
            return vec![f64::INFINITY; largest.len()];
        };
        let size = (seen.share.powi(2) + 1.0 / seen.left).sqrt();
        for (k, (largest, taken)) in largest.iter_mut().zip(&seen.taken).enumerate() {
            // The end has the gain itself.
            let own = if k == 0 { minimum.parameters[0] } else { 0.0 };
            *largest = f64::max(*largest, size * (own - taken).abs());
        }
    }
    largest
}

/// The gain of `minimum` together with each of these slow ends, as it is with the end among the parameters: `critical` standard deviations to each side. `None` where one is not
/// seen at all.
pub(super) fn gains(minimum: &Minimum, ends: &[Vec<f64>], critical: f64) -> Option<Vec<[f64; 2]>> {
    let gain = minimum.parameters[0];
    let with = |end: &Vec<f64>| {
        let seen = Seen::of(minimum, end)?;
        let moved = gain - seen.taken[0];
        let sd = (minimum.covariance[(0, 0)] + moved.powi(2) / seen.left).sqrt();
        let found = gain + seen.share * moved;
        Some([found - critical * sd, found + critical * sd])
    };
    ends.iter().map(with).collect()
}

/// A slow end beside the parameters of an order.
struct Seen {
    /// Its part of the response, as estimated.
    share: f64,
    /// The square of what the parameters leave of it: the variance of the share is one over this.
    left: f64,
    /// By how much a share of one changes each of them.
    taken: Vec<f64>,
}

impl Seen {
    /// `None` of one of which they leave nothing.
    fn of(minimum: &Minimum, end: &[f64]) -> Option<Self> {
        let along = times(&minimum.jacobian.transpose().to_owned(), end);
        // The Jacobian is that of the errors: an end lowers them.
        let taken: Vec<f64> = times(&minimum.covariance, &along)
            .into_iter()
            .map(|taken| -taken)
            .collect();
        let left = dot(end, end) + dot(&along, &taken);
        (left > 1e-9 * dot(end, end)).then(|| Self {
            share: dot(end, &minimum.residuals) / left,
            left,
            taken,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;
    use faer::Mat;

    /// Nine tenths of a gain of one are there at once, and the rest is an end. The gain alone is too small then; together with the end it is one.
    #[test]
    fn the_gain_with_an_end_contains_the_end() {
        let (at_once, end) = ([1.0; 4], [0.25, 0.5, 0.75, 1.0]);
        let estimate: Vec<f64> = (0..4).map(|k| 0.9 * at_once[k] + 0.1 * end[k]).collect();
        let gain = estimate.iter().sum::<f64>() / 4.0;
        let residuals: Vec<f64> = estimate.iter().map(|value| value - gain).collect();
        let minimum = Minimum {
            parameters: vec![gain],
            sum_of_squares: dot(&residuals, &residuals),
            residuals,
            jacobian: Mat::from_fn(4, 1, |_, _| -1.0),
            covariance: Mat::from_fn(1, 1, |_, _| 0.25),
        };
        // As large as the whole response.
        let end: Vec<f64> = end.iter().map(|value| gain * value).collect();
        let [lower, upper] = gains(&minimum, &[end], 2.0).unwrap()[0];
        assert_relative_eq!(0.5 * (lower + upper), 1.0, max_relative = 1e-9);
        // By the least squares of both columns.
        let [aa, ab, bb] = [4.0, 2.5, 1.875];
        let variance: f64 = (bb + aa - 2.0 * ab) / (aa * bb - ab * ab);
        assert_relative_eq!(upper - lower, 4.0 * variance.sqrt(), max_relative = 1e-9);
        assert!(gain < 0.97);
    }
}
