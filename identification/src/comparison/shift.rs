//! The equivalent delay shift: how much later the second servo moves, apart from how far it goes.
//!
//! With a and b the step responses of the two, each relative to its own final value, it is the shift
//! that brings the first closest to the second in the sense of least squares,
//!
//! ```text
//! s = argmin_s  sum_m (a(m - s) - b(m))²,      a = 0 before the edge, 1 after the settling time
//! ```
//!
//! over all samples m of all curves alike; samples on the steep part of a response decide it, as a
//! shift changes nothing where a response is flat. Between samples a is interpolated by cubic
//! convolution (Catmull-Rom). A servo that is slower without any more dead time has a shift too: the
//! remainder is given beside it.
//!
//! **The interval** is that of the implicit function: with J(s) half the sum and J'(s) = 0,
//!
//! ```text
//! ds/dx = -(∂J'/∂x) / J''      Var s = (ds/da)' Cov(a) (ds/da) + (ds/db)' Cov(b) (ds/db)
//! ```
//!
//! to which the bound of the errors that no variance contains is added as if it had the worst sign at every sample.

use crate::numerics::{not_negative, pointwise_critical, student_critical};
use crate::results::Interval;

use super::difference::Curves;

/// The definition, for readers of a document.
pub(super) const DEFINITION: &str = "the delay that brings the first step response closest to the \
    second, each relative to its own final value (least squares over all samples of the response, so \
    that the steep part decides); a slower servo has one without more dead time";

/// Places tried at the first look, on each side of none.
const PLACES: usize = 200;

/// Distance of the places tried at the second look \[samples\]: a quarter of the distance over which a
/// piece of the interpolation is one polynomial.
const CLOSE: f64 = 0.25;

/// Part of the squares of all changes from sample to sample that may be noise. With more, the shift is one at which noise meets noise, of which the implicit
/// function knows nothing. Evidence: the table of pairs that differ by a shift (`--example shifted_pairs`).
const MOST_NOISE: f64 = 0.2;

/// Halvings of the last bracket: it is at rounding then.
const HALVINGS: usize = 50;

/// How much later the second curves come.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Shift {
    /// \[samples\], positive when the second are later; empty when no shift within half the response
    /// is best, a final value may be zero, or noise decides it.
    pub(super) samples: Interval,
    /// What remains between the curves after the shift, at every sample; empty without a shift.
    pub(super) remains: Vec<Remains>,
}

/// What is left between two curves at a sample, of which one was shifted \[shares of the final value\].
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Remains {
    /// Their distance.
    pub(super) distance: f64,
    /// What of it the curve between its samples may make: all of it, where they are as far apart as the servo takes.
    pub(super) by_interpolation: f64,
}

impl Remains {
    /// What is left in any case.
    pub(super) fn surely(self) -> f64 {
        (self.distance - self.by_interpolation).max(0.0)
    }
}

/// The shift of the curves whose numbers are in `which`, all of them by the same.
pub(super) fn shift(a: &Curves, b: &Curves, which: std::ops::Range<usize>, level: f64) -> Shift {
    let shows = |curves: &Curves| {
        let noise = noise_of_changes(curves, which.clone());
        noise.is_none_or(|noise| noise <= MOST_NOISE)
    };
    let pair = Pair::new(a, b, which.clone(), level).filter(|_| shows(a) && shows(b));
    let Some((best, pair)) = pair.and_then(|pair| Some((pair.best()?, pair))) else {
        return Shift {
            samples: Interval::default(),
            remains: Vec::new(),
        };
    };
    let (of_a, of_b) = pair.gradients(best);
    let worst = |weights: &[f64], bias: f64| bias * weights.iter().map(|w| w.abs()).sum::<f64>();
    let half = a.spread.as_ref().zip(b.spread.as_ref()).map(|(a, b)| {
        let variance = a.variance_of(&of_a) + b.variance_of(&of_b);
        let degrees = a.degrees_of_freedom.min(b.degrees_of_freedom);
        let critical = student_critical(pointwise_critical(level), &[degrees])[0];
        critical * not_negative(variance).sqrt()
            + worst(&of_a, a.bias)
            + worst(&of_b, b.bias)
            + pair.interpolation_error(best)
    });
    Shift {
        samples: Interval::around(best, half.into_valid()),
        remains: pair.remains(best),
    }
}

/// Which part of the squares of all changes from sample to sample is expected of noise, where that is known.
fn noise_of_changes(curves: &Curves, which: std::ops::Range<usize>) -> Option<f64> {
    let spread = curves.spread.valid()?;
    let of_curve = |curve: usize| {
        let points = curve * curves.points..(curve + 1) * curves.points;
        let values = &curves.value[points.clone()];
        let squares: f64 = values.windows(2).map(|g| (g[1] - g[0]).powi(2)).sum();
        [spread.variance_of_changes(points), squares]
    };
    let sum = which
        .map(of_curve)
        .fold([0.0; 2], |[a, b], [c, d]| [a + c, b + d]);
    Some(sum[0] / sum[1])
}

/// Two sets of curves, each relative to its final value.
struct Pair {
    a: Vec<f64>,
    b: Vec<f64>,
    /// Final values.
    gains: [Vec<f64>; 2],
    points: usize,
    /// Place of the first curve among all.
    first: usize,
    /// Number of values of all curves.
    total: usize,
}

impl Pair {
    /// `None` when a final value may be zero.
    fn new(a: &Curves, b: &Curves, which: std::ops::Range<usize>, level: f64) -> Option<Self> {
        let points = a.points;
        let finals = |curves: &Curves| -> Option<Vec<f64>> {
            let of = |curve: usize| {
                let last = (curve + 1) * points - 1;
                let gain = curves.value[last];
                let least = curves.spread.valid().map_or(0.0, |known| {
                    pointwise_critical(level) * known.variance[last].sqrt() + known.bias
                });
                (gain.abs() > least).then_some(gain)
            };
            which.clone().map(of).collect()
        };
        let gains = [finals(a)?, finals(b)?];
        let relative = |curves: &Curves, gains: &[f64]| {
            let of = |(curve, gain): (usize, &f64)| {
                let gain = *gain;
                let values = &curves.value[curve * points..(curve + 1) * points];
                values.iter().map(move |g| g / gain)
            };
            which.clone().zip(gains).flat_map(of).collect()
        };
        Some(Self {
            a: relative(a, &gains[0]),
            b: relative(b, &gains[1]),
            gains,
            points,
            first: which.start,
            total: a.value.len(),
        })
    }

    /// The best shift; `None` where it is none within half the response.
    fn best(&self) -> Option<f64> {
        let range = self.points as f64 / 2.0;
        let scan = |centre: f64, half: f64, places: usize| {
            let step = half / places as f64;
            let place = |k: i64| centre + k as f64 * step;
            let places = places as i64;
            let best = (-places..=places).map(place).min_by(|&s, &t| {
                let nearer = s.abs().total_cmp(&t.abs());
                self.distance(s).total_cmp(&self.distance(t)).then(nearer)
            });
            (best.unwrap_or(0.0), step)
        };
        let (rough, step) = scan(0.0, range, PLACES.min((range / CLOSE) as usize).max(1));
        let close = ((step / CLOSE).ceil() as usize).max(1);
        let (near, step) = scan(rough, step, close);
        let (mut low, mut high) = (near - step, near + step);
        if low < -range || high > range || !(self.slope(low) < 0.0 && self.slope(high) > 0.0) {
            return None;
        }
        for _ in 0..HALVINGS {
            let middle = f64::midpoint(low, high);
            if self.slope(middle) < 0.0 {
                low = middle;
            } else {
                high = middle;
            }
        }
        Some(f64::midpoint(low, high))
    }

    /// Shifted value, its first and second derivative by the shift, and what is left of the second
    /// curve, at every sample.
    fn at(&self, shift: f64) -> impl Iterator<Item = ([f64; 3], f64)> {
        (0..self.b.len()).map(move |place| {
            let (curve, m) = (place / self.points, place % self.points);
            let values = &self.a[curve * self.points..(curve + 1) * self.points];
            let around = Around::new(m as f64 - shift, self.points);
            let shifted = [0, 1, 2].map(|derivative| around.sum(values, derivative));
            (shifted, shifted[0] - self.b[place])
        })
    }

    fn distance(&self, shift: f64) -> f64 {
        self.at(shift).map(|(_, left)| left * left).sum()
    }

    /// J'.
    fn slope(&self, shift: f64) -> f64 {
        self.at(shift)
            .map(|([_, first, _], left)| first * left)
            .sum()
    }

    /// By how much the curvature of the first curve changes before, across and behind the interval of samples in which it is interpolated at `place`.
    fn changes_of_curvature(&self, place: usize, shift: f64) -> [f64; 3] {
        let (curve, m) = (place / self.points, place % self.points);
        let around = Around::new(m as f64 - shift, self.points);
        let value = |k: i64| {
            let index = around.sample(k);
            index.map_or(0.0, |index| self.a[curve * self.points + index])
        };
        let bend = |k: i64| value(k - 1) - 2.0 * value(k) + value(k + 1);
        [0, 1, 2].map(|k| (bend(k) - bend(k - 1)).abs())
    }

    /// By how much the curve between samples may move the shift: at each sample a cubic may be wrong by an eighth of the change of curvature
    /// around it, and all have the worst sign.
    fn interpolation_error(&self, shift: f64) -> f64 {
        let (mut error, mut curvature) = (0.0, 0.0);
        for (place, ([_, first, _], _)) in self.at(shift).enumerate() {
            let [_, across, _] = self.changes_of_curvature(place, shift);
            error += first.abs() * across / 8.0;
            curvature += first * first;
        }
        if curvature > 0.0 {
            interpolated(shift) * error / curvature
        } else {
            0.0
        }
    }

    /// What remains after the shift. A curve that bends at a point between two samples, as the answer of a lag begins, is wrong by 3/16 of the bend
    /// there, which is the sum of the changes of curvature around it.
    fn remains(&self, shift: f64) -> Vec<Remains> {
        let part = interpolated(shift);
        let at = |(place, (_, left)): (usize, (_, f64))| {
            let changes = self.changes_of_curvature(place, shift);
            Remains {
                distance: left.abs(),
                by_interpolation: part * 3.0 / 16.0 * changes.iter().sum::<f64>(),
            }
        };
        self.at(shift).enumerate().map(at).collect()
    }

    /// ds/da and ds/db for the values of all curves, before they were made relative.
    fn gradients(&self, shift: f64) -> (Vec<f64>, Vec<f64>) {
        let curvature: f64 = self
            .at(shift)
            .map(|([_, first, second], left)| first * first + second * left)
            .sum();
        let mut of_a = vec![0.0; self.a.len()];
        let mut of_b = vec![0.0; self.b.len()];
        for (place, ([_, first, _], left)) in self.at(shift).enumerate() {
            let (curve, m) = (place / self.points, place % self.points);
            let around = Around::new(m as f64 - shift, self.points);
            for (index, weights) in around.weights() {
                of_a[curve * self.points + index] -=
                    (weights[1] * left + first * weights[0]) / curvature;
            }
            of_b[place] += first / curvature;
        }
        (
            self.of_absolute(&of_a, &self.a, &self.gains[0]),
            self.of_absolute(&of_b, &self.b, &self.gains[1]),
        )
    }

    /// From the gradient for relative values to the one for absolute values: the last value of a curve
    /// is also what all its values are divided by.
    fn of_absolute(&self, gradient: &[f64], relative: &[f64], gains: &[f64]) -> Vec<f64> {
        let mut all = vec![0.0; self.total];
        for (curve, gain) in gains.iter().enumerate() {
            let range = curve * self.points..(curve + 1) * self.points;
            let (gradient, relative) = (&gradient[range.clone()], &relative[range]);
            let start = (self.first + curve) * self.points;
            for (m, g) in gradient.iter().enumerate() {
                all[start + m] = g / gain;
            }
            let scaled: f64 = gradient.iter().zip(relative).map(|(g, r)| g * r).sum();
            all[start + self.points - 1] -= scaled / gain;
        }
        all
    }
}

/// Which part of what an interpolation may be wrong by a curve is, that is shifted by so many samples: where a sample meets a sample nothing is
/// interpolated.
fn interpolated(shift: f64) -> f64 {
    (shift - shift.floor()).min(shift.ceil() - shift).min(0.25) / 0.25
}

/// The four samples around a place between samples.
struct Around {
    /// Sample before the place; may lie outside of the curve.
    before: i64,
    /// Way from there to the next, 0 to 1.
    part: f64,
    points: usize,
}

impl Around {
    fn new(place: f64, points: usize) -> Self {
        Self {
            before: place.floor() as i64,
            part: place - place.floor(),
            points,
        }
    }

    /// Samples and their weights in the value and in its derivatives by the shift: nothing before the
    /// edge, the final value after the end.
    fn weights(&self) -> impl Iterator<Item = (usize, [f64; 3])> {
        let t = self.part;
        let value = [
            t * (t * (2.0 - t) - 1.0) / 2.0,
            t * t * (3.0 * t - 5.0) / 2.0 + 1.0,
            t * (t * (4.0 - 3.0 * t) + 1.0) / 2.0,
            t * t * (t - 1.0) / 2.0,
        ];
        // The place moves back as the shift grows.
        let first = [
            -(t * (4.0 - 3.0 * t) - 1.0) / 2.0,
            -t * (9.0 * t - 10.0) / 2.0,
            -(t * (8.0 - 9.0 * t) + 1.0) / 2.0,
            -t * (3.0 * t - 2.0) / 2.0,
        ];
        let second = [2.0 - 3.0 * t, 9.0 * t - 5.0, 4.0 - 9.0 * t, 3.0 * t - 1.0];
        (0..4).filter_map(move |k| {
            let index = self.sample(k as i64 - 1)?;
            Some((index, [value[k], first[k], second[k]]))
        })
    }

    /// The sample that lies `k` behind the one before the place: the last after the end, and none before the edge.
    fn sample(&self, k: i64) -> Option<usize> {
        usize::try_from((self.before + k).min(self.points as i64 - 1)).ok()
    }

    fn sum(&self, values: &[f64], derivative: usize) -> f64 {
        self.weights()
            .map(|(index, weights)| weights[derivative] * values[index])
            .sum()
    }
}

#[cfg(test)]
mod tests {
    use super::super::difference::DifferenceSpread;
    use super::*;
    use crate::results::Bounds;
    use approx::assert_abs_diff_eq;
    use faer::Mat;

    /// Curves that are their own parameters, each known to `sd`.
    fn curves(values: &[f64], points: usize, sd: f64) -> Curves {
        let size = values.len();
        let unit = Mat::<f64>::identity(size, size);
        let covariance = Mat::from_fn(size, size, |i, k| if i == k { sd * sd } else { 0.0 });
        Curves {
            value: values.to_vec(),
            points,
            spread: Bounds::Valid(DifferenceSpread::new(&unit, &covariance, 1e6, 0.0)),
        }
    }

    fn rising(gain: f64, delay: f64, lag: f64) -> Vec<f64> {
        (0..120)
            .map(|m| ((f64::from(m) - delay) / lag).max(0.0))
            .map(|t| gain * (1.0 - (1.0 + t) * (-t).exp()))
            .collect()
    }

    #[test]
    fn a_pure_delay_is_found_whatever_the_gain() {
        let (a, b) = (rising(1.0, 12.3, 6.0), rising(0.7, 15.8, 6.0));
        let found = shift(&curves(&a, 120, 1e-3), &curves(&b, 120, 1e-3), 0..1, 0.99);
        // Interpolation of a curve with a kink in its curvature, 2e-3 samples at worst.
        assert_abs_diff_eq!(found.samples.value.unwrap(), 3.5, epsilon = 2e-3);
        assert!(found.remains.iter().all(|left| left.distance < 1e-3));
        let back = shift(&curves(&b, 120, 1e-3), &curves(&a, 120, 1e-3), 0..1, 0.99);
        assert_abs_diff_eq!(back.samples.value.unwrap(), -3.5, epsilon = 2e-3);
    }

    #[test]
    fn what_a_shift_leaves_between_far_samples_is_no_difference() {
        // A lag of one sample bends where its answer begins, anywhere between two samples.
        let lag = |delay: f64, slower: f64| -> Vec<f64> {
            let answer = |t: f64| 1.0 - (-t.max(0.0) / slower).exp();
            (0..60).map(|m| answer(f64::from(m) - delay)).collect()
        };
        let first = lag(5.0, 1.0);
        let remains = |second: &[f64]| {
            let found = shift(
                &curves(&first, 60, 1e-3),
                &curves(second, 60, 1e-3),
                0..1,
                0.99,
            );
            let most = |of: fn(&Remains) -> f64| found.remains.iter().map(of).fold(0.0, f64::max);
            [most(|left| left.distance), most(|left| left.surely())]
        };
        for tenths in 1..10 {
            let [distance, surely] = remains(&lag(8.0 + f64::from(tenths) / 10.0, 1.0));
            assert!(
                distance > 0.01 && surely < 0.01,
                "{tenths}: {distance} {surely}"
            );
        }
        let [_, surely] = remains(&lag(8.0, 3.0));
        assert!(surely > 0.1, "{surely}");
    }

    #[test]
    fn the_gradient_is_that_of_differences() {
        let two = |one: Vec<f64>, other: Vec<f64>| [one, other].concat();
        let a = two(rising(1.0, 10.0, 5.0), rising(0.9, 12.0, 7.0));
        let b = two(rising(0.8, 13.4, 6.0), rising(0.7, 11.1, 9.0));
        let best = |a: &[f64], b: &[f64]| {
            let (a, b) = (curves(a, 120, 1e-3), curves(b, 120, 1e-3));
            Pair::new(&a, &b, 0..2, 0.99).unwrap().best().unwrap()
        };
        let known = curves(&a, 120, 1e-3);
        let pair = Pair::new(&known, &curves(&b, 120, 1e-3), 0..2, 0.99).unwrap();
        let (of_a, of_b) = pair.gradients(best(&a, &b));
        let by_difference = |values: &[f64], m: usize, of: &dyn Fn(&[f64]) -> f64| {
            let moved = |by: f64| {
                let mut moved = values.to_vec();
                moved[m] += by;
                of(&moved)
            };
            (moved(1e-5) - moved(-1e-5)) / 2e-5
        };
        for m in [5, 14, 20, 60, 119, 130, 140, 239] {
            let numeric = by_difference(&a, m, &|a| best(a, &b));
            assert_abs_diff_eq!(of_a[m], numeric, epsilon = 1e-6);
            let numeric = by_difference(&b, m, &|b| best(&a, b));
            assert_abs_diff_eq!(of_b[m], numeric, epsilon = 1e-6);
        }
    }

    #[test]
    fn where_noise_is_most_of_what_changes_there_is_no_shift() {
        let (a, b) = (rising(1.0, 12.3, 6.0), rising(1.0, 15.8, 6.0));
        let found = |sd_a: f64, sd_b: f64| {
            let found = shift(&curves(&a, 120, sd_a), &curves(&b, 120, sd_b), 0..1, 0.99);
            found.samples.value.is_some()
        };
        assert!(found(1e-3, 1e-3) && found(1e-3, 4e-3));
        assert!(!found(1e-3, 0.05) && !found(0.05, 1e-3));
    }

    #[test]
    fn without_a_final_value_there_is_no_shift() {
        let a = rising(1.0, 10.0, 5.0);
        let nothing = vec![0.001; 120];
        let found = shift(
            &curves(&a, 120, 1e-3),
            &curves(&nothing, 120, 1e-3),
            0..1,
            0.99,
        );
        assert_eq!((found.samples.value, found.remains), (None, Vec::new()));
    }
}
