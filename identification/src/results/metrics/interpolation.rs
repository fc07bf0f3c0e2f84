//! Between samples: what interpolation of a crossing may be wrong by.

use super::crossing::Crossing;
use super::crossings_and_peak::{AtLevels, LEVELS, Shape};
use super::sample_uncertainty::Weights;

/// Samples in the rise below which a cubic through four samples no longer follows the curve between
/// them.
pub(super) const COARSE: f64 = 4.0;

/// How much farther than that of a lag which begins with a corner a crossing may be, as a factor on its distance.
const CORNER: f64 = 1.25;

/// Share of the gain below which a response may not have begun.
const BEGUN: f64 = 0.02;

/// What interpolation may be wrong by \[samples\], at each crossing of a curve.
///
/// Nothing is known of the curve between its samples; the difference of several interpolations shows how much
/// that may matter. With x the crossing of the cubic, x1 that of the straight line, x2 and
/// x3 those of the two parabolas, and r samples from 10 to 90 %,
///
/// ```text
/// e = 3 min(1, (4/r)²) |x - x1| + 2 max(|x - x2|, |x - x3|)
/// ```
///
/// Over 6000 second-order servos (damping 0.3 to 1.5, rise of 1.5 to 60 samples, any dead time) the
/// true crossings lay within e in 98 to 100 %, by level and length of the rise. With 20 samples in the
/// rise e is about a hundredth of a sample. Where the response had not begun at the sample before, a
/// dead time may end anywhere up to the crossing's other neighbour: then e reaches to the farther of
/// the two, again by the share min(1, (4/r)²). There the response may also begin with a corner, which no sampling is fine enough for: a
/// lag through the samples m and m + 1 that follow the crossing, carried back to the level, crosses it at x4, and e is at least
/// 1.25 |x - x4|. Over 9000 lags of first, second and third order (time constants of half a sample to twenty, any dead time) the true
/// crossings of 5 and 10 % then lay within e in all; without it, in 81 % of those of first order with 8 to 16 samples in the rise.
pub(crate) fn interpolation_errors(curve: &[f64], shape: &Shape) -> AtLevels<f64> {
    let coarseness = coarseness(shape);
    let error = |crossing: f64, share: f64| {
        // The sample that follows the crossing; none where there is no crossing.
        let m = (crossing.floor() as usize).saturating_add(1);
        if !crossing.is_finite() || m >= curve.len() {
            return 0.0;
        }
        let around = Crossing::new(curve, m, share * shape.gain);
        let at = crossing - (m - 1) as f64;
        let line = (at - around.linear()).abs();
        let parabola = around.parabolas().map(|x| (at - x).abs());
        let error = 3.0 * coarseness * line + 2.0 * parabola[0].max(parabola[1]);
        match curve[m - 1] > BEGUN * shape.gain {
            true => error,
            false => {
                let of_corner = CORNER * (at - lag_crossing(curve, m, shape.gain, share)).abs();
                error.max(coarseness * at.max(1.0 - at)).max(of_corner)
            }
        }
    };
    AtLevels {
        delay: error(shape.crossings.delay, LEVELS.delay),
        tenth: error(shape.crossings.tenth, LEVELS.tenth),
        half: error(shape.crossings.half, LEVELS.half),
        ninety: error(shape.crossings.ninety, LEVELS.ninety),
    }
}

/// min(1, (4/r)²) of a rise of r samples: the share of a sample by which the curve between samples may have gone another way.
pub(crate) fn coarseness(shape: &Shape) -> f64 {
    let share = (COARSE / shape.crossings.rise()).powi(2);
    // Without a rise nothing is known of it.
    if share.is_nan() { 1.0 } else { share.min(1.0) }
}

/// Where a lag through the samples m and m + 1, which began between m - 1 and m, passes `share` of the gain, counted from m - 1; the middle
/// where none passes through them.
fn lag_crossing(curve: &[f64], m: usize, gain: f64, share: f64) -> f64 {
    let left = |k: usize| curve.get(k).map(|value| 1.0 - value / gain);
    let Some((here, next)) = left(m).zip(left(m + 1)) else {
        return 0.5;
    };
    let falls = next / here;
    match here > 0.0 && falls > 0.0 && falls < 1.0 {
        true => (1.0 + ((1.0 - share) / here).ln() / falls.ln()).clamp(0.0, 1.0),
        false => 0.5,
    }
}

/// The weights of the samples in the value of a curve at a place between samples, less `share` of
/// its last: the cubic of [`Crossing`] in Lagrange's form.
pub(crate) fn weights_at(place: f64, last: usize, share: f64) -> Weights {
    let next = (place as usize + 1).min(last);
    let t = place - (next - 1) as f64;
    let before = -t * (t - 1.0) * (t - 2.0) / 6.0;
    let mut inner = [
        (t + 1.0) * (t - 1.0) * (t - 2.0) / 2.0,
        -(t + 1.0) * t * (t - 2.0) / 2.0,
    ];
    let after = (t + 1.0) * t * (t - 1.0) / 6.0;
    let mut weights = [(0, 0.0); 5];
    if next >= 2 {
        weights[0] = (next - 2, before);
    }
    if next + 1 < last {
        weights[3] = (next + 1, after);
    } else {
        inner = [inner[0] - after, inner[1] + 2.0 * after];
    }
    weights[1] = (next - 1, inner[0]);
    weights[2] = (next, inner[1]);
    weights[4] = (last, -share);
    weights
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::results::metrics::crossings_and_peak::tests::response;
    use crate::results::metrics::crossings_and_peak::{Crossings, Windows};
    use approx::assert_abs_diff_eq;

    #[test]
    fn weights_give_the_value_of_the_cubic_that_crossings_are_read_from() {
        let curve = response(0.5);
        let last = curve.len() - 1;
        let shape = Windows::new(&curve, &vec![1e-9; curve.len()]).read(&curve);
        let value = |place: f64, share: f64| -> f64 {
            weights_at(place, last, share)
                .iter()
                .map(|&(m, weight)| weight * curve[m])
                .sum()
        };
        let Crossings { delay, half, .. } = shape.crossings;
        // Crossings are found to a billionth of the slope.
        assert_abs_diff_eq!(value(delay, LEVELS.delay), 0.0, epsilon = 1e-9);
        assert_abs_diff_eq!(value(half, LEVELS.half), 0.0, epsilon = 1e-9);
        for m in [0, 1, 2, 70, last - 2, last - 1] {
            assert_abs_diff_eq!(value(m as f64, 0.0), curve[m], epsilon = 1e-15);
        }
    }

    #[test]
    fn where_there_is_no_crossing_there_is_no_error() {
        let curve = response(0.5);
        let mut shape = Windows::new(&curve, &vec![1e-9; curve.len()]).read(&curve);
        for none in [f64::INFINITY, f64::NAN] {
            shape.crossings.delay = none;
            assert_eq!(interpolation_errors(&curve, &shape).delay, 0.0);
        }
    }

    /// A first-order lag whose dead time ends between samples: the delay lies where no cubic can
    /// find it, and the error shows it; sampled finely, there is no error to speak of.
    #[test]
    fn crossings_between_coarse_samples_are_as_uncertain_as_they_are() {
        let read = |lag: f64, dead: f64, samples: usize| {
            let response = |m: usize| 1.0 - (-(m as f64 - dead).max(0.0) / lag).exp();
            let curve: Vec<f64> = (0..samples).map(response).chain([1.0]).collect();
            let shape = Windows::new(&curve, &vec![1e-9; curve.len()]).read(&curve);
            let error = interpolation_errors(&curve, &shape);
            let truth = |share: f64| dead - lag * (1.0 - share).ln();
            for (x, e, share) in [
                (shape.crossings.delay, error.delay, 0.05),
                (shape.crossings.half, error.half, 0.5),
                (shape.crossings.ninety, error.ninety, 0.9),
            ] {
                assert!(
                    (x - truth(share)).abs() <= e,
                    "{share}: {x} +- {e}, truth {}",
                    truth(share)
                );
            }
            error
        };
        for tenth in 0..10 {
            let dead = 3.0 + 0.1 * f64::from(tenth);
            assert!(read(1.0, dead, 30).delay > 0.05);
            assert!(read(20.0, dead, 300).half < 0.01);
            // In steps that a cubic would follow, were it not for the corner.
            for lag in [2.0, 3.0, 4.5, 6.0] {
                read(lag, dead, 100);
            }
        }
    }
}
