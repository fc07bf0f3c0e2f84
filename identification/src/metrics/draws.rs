//! Draws of the response from the covariance of its fit, and what the figures make of them.
//!
//! Only the samples that a figure can depend on are drawn ([`Windows`]), jointly, from one factor of
//! their covariance. Draws come in pairs z, -z, which serve both tails alike.

use faer::Mat;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

use super::bands::{Crossing, bandwidth, quarter_turn};
use super::shape::{Interpolation, SETTLED, Shape, Windows, bump};
use super::{Interval, Measured, Metrics};
use crate::band::{normal_upper_quantile, pointwise_critical};
use crate::basis::dot;

/// Seed of the draws: the same record always gives the same intervals.
pub(crate) const SEED: u64 = 20_250_917;

/// Draws beyond each bound. With k of them the probability outside a bound is known to 1/sqrt(k)
/// of itself: a fifth for 25, so that "99 %" is between 98.8 and 99.2 %.
const BEYOND: f64 = 25.0;

/// Level up to which bounds are quantiles of draws; further out they are extended as a normal
/// distribution's, for the number of draws would grow without limit.
const DRAWN_LEVEL: f64 = 0.99;

/// Pairs of draws for a level.
pub(crate) fn pairs(level: f64) -> usize {
    (BEYOND / (1.0 - level.min(DRAWN_LEVEL))).ceil() as usize
}

/// The interval of a figure from its value and its draws (which are put into another order).
pub(crate) fn interval_of(value: f64, draws: &mut [f64], level: f64) -> Interval {
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

/// The figures of a response and of its draws.
pub(crate) struct MetricDraws {
    /// Of the estimate.
    pub(crate) nominal: Shape,
    /// Of each draw.
    pub(crate) shapes: Vec<Shape>,
    pub(crate) bandwidth: Crossing,
    pub(crate) quarter_turn: Crossing,
    spread: Spread,
    windows: Windows,
    /// The response, turned so that its gain is positive.
    curve: Vec<f64>,
}

/// Second moments of the step response.
struct Spread {
    /// Standard deviation of each sample, widened by Student's t.
    sd: Vec<f64>,
    /// Covariance of each sample with the last, widened alike.
    with_last: Vec<f64>,
    /// Largest widening.
    widest: f64,
}

impl MetricDraws {
    pub(crate) fn new(measured: &Measured<'_>, seed: u64) -> Self {
        let (step, level) = (measured.step, measured.step.pointwise.level);
        let last = step.value.len() - 1;
        let sign = step.value[last].signum();
        let curve: Vec<f64> = step.value.iter().map(|value| sign * value).collect();
        let map = measured.basis.step_map().transpose().to_owned();
        let weighted = measured.covariance * &map;
        let widening = widening(measured);
        let covariance = |i: usize, j: usize| {
            widening[i] * widening[j] * dot(weighted.col_as_slice(i), map.col_as_slice(j))
        };
        let spread = Spread {
            sd: (0..=last)
                .map(|m| covariance(m, m).max(0.0).sqrt())
                .collect(),
            with_last: (0..=last).map(|m| covariance(m, last)).collect(),
            widest: widening.iter().copied().fold(1.0, f64::max),
        };
        let windows = Windows::new(&curve, &spread.sd);
        let points = &windows.points;
        let size = points.len();
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let deviations = {
            let part = Mat::from_fn(size, size, |i, j| covariance(points[i], points[j]));
            let mut normals = Mat::<f64>::zeros(size, pairs(level));
            for k in 0..normals.ncols() {
                for z in normals.col_as_slice_mut(k) {
                    *z = StandardNormal.sample(&mut random);
                }
            }
            semidefinite_factor(&part) * normals
        };
        let mut drawn = curve.clone();
        let mut shapes = Vec::with_capacity(2 * deviations.ncols());
        for k in 0..deviations.ncols() {
            for side in [1.0, -1.0] {
                for (&m, deviation) in points.iter().zip(deviations.col_as_slice(k)) {
                    drawn[m] = curve[m] + side * deviation;
                }
                shapes.push(windows.read(&drawn));
            }
        }
        Self {
            nominal: windows.read(&curve),
            shapes,
            bandwidth: bandwidth(measured, spread.widest, &mut random),
            quarter_turn: quarter_turn(measured, spread.widest, &mut random),
            spread,
            windows,
            curve,
        }
    }

    /// A figure of each draw.
    pub(crate) fn figure(&self, of: impl Fn(&Shape) -> f64) -> Vec<f64> {
        self.shapes.iter().map(of).collect()
    }

    pub(crate) fn metrics(&self, measured: &Measured<'_>, dc_gain: Interval) -> Metrics {
        let (timing, level) = (measured.timing, measured.step.pointwise.level);
        let bias = self.effect_of_bias(measured.step.truncation_bias);
        let smooth = |of: fn(&Shape) -> f64, bias: (f64, f64)| {
            let interval = interval_of(of(&self.nominal), &mut self.figure(of), level);
            widened(interval, bias)
        };
        // No response comes before its edge, whatever a wide interval says.
        let seconds = |samples: f64| timing.seconds(samples).max(0.0);
        let time = |interval: Interval| in_seconds(interval, seconds);
        let between = Interpolation::new(&self.curve, &self.nominal);
        let crossing = |of: fn(&Shape) -> f64, error: f64| {
            time(widened(smooth(of, bias.of(of)), (-error, error)))
        };
        let rise = {
            let (early, late) = (bias.of(|s| s.tenth), bias.of(|s| s.ninety));
            let error = between.tenth + between.ninety;
            let noise = smooth(Shape::rise, (late.0 - early.1, late.1 - early.0));
            widened(noise, (-error, error))
        };
        Metrics {
            dc_gain,
            rise_time_s: in_seconds(rise, |samples| samples * timing.sample_period_s),
            settling_time_s: time(self.settling(measured, level)),
            overshoot_percent: percent(self.overshoot(measured, level)),
            delay_s: crossing(|shape| shape.delay, between.delay),
            t50_s: crossing(|shape| shape.half, between.half),
            bandwidth_rad_s: self.bandwidth.interval(level),
            phase_minus_90_rad_s: self.quarter_turn.interval(level),
        }
    }

    /// How far the figures move when the whole response but its final value is off by `bias`.
    fn effect_of_bias(&self, bias: f64) -> BiasEffect {
        let moved = |side: f64| {
            let last = self.curve.len() - 1;
            let shifted: Vec<f64> = self.curve[..last]
                .iter()
                .map(|value| value + side * bias)
                .chain([self.curve[last]])
                .collect();
            Windows::new(&shifted, &self.spread.sd).read(&shifted)
        };
        let nominal = self.nominal;
        BiasEffect {
            nominal,
            moved: if bias > 0.0 {
                [moved(1.0), moved(-1.0)]
            } else {
                [nominal; 2]
            },
        }
    }

    /// Highest point above the final value, relative to it.
    fn overshoot(&self, measured: &Measured<'_>, level: f64) -> Interval {
        let last = self.curve.len() - 1;
        let gain = self.curve[last];
        let sd = |m: usize| self.sd_over(m, 1.0);
        let value = self.nominal.overshoot;
        let peak = (0..last)
            .max_by(|&a, &b| self.curve[a].total_cmp(&self.curve[b]))
            .unwrap_or(0);
        let bias = measured.step.truncation_bias / gain;
        let critical = Critical::new(level, self.windows.tops());
        let edge = |factor: f64, side: f64| {
            (0..last)
                .map(|m| self.curve[m] - gain + side * factor * sd(m))
                .fold(f64::NEG_INFINITY, f64::max)
                / gain
        };
        let between = bump(&self.curve, peak, last) / gain;
        Interval::new(
            value,
            (edge(critical.all, -1.0) - bias).max(0.0),
            (edge(critical.one, 1.0) + between + bias).max(0.0),
        )
    }

    /// When the response last leaves its band, in samples.
    fn settling(&self, measured: &Measured<'_>, level: f64) -> Interval {
        let last = self.curve.len() - 1;
        let gain = self.curve[last];
        let bias = measured.step.truncation_bias;
        let critical = Critical::new(level, self.windows.doubtful());
        let last_with = |factor: f64| {
            (0..last).rfind(|&m| {
                [1.0, -1.0].iter().any(|side| {
                    let edge = 1.0 + side * SETTLED;
                    let over = side * (self.curve[m] - edge * gain);
                    over + factor * self.sd_over(m, edge) + factor.signum() * bias > 0.0
                })
            })
        };
        let value = self.nominal.settling;
        let lower = last_with(-critical.all).map_or(0.0, |m| m as f64);
        let upper = match last_with(critical.one) {
            None => 0.0,
            Some(m) if m + 2 >= last => f64::INFINITY,
            Some(m) => (m + 1) as f64,
        };
        // Draws are smooth only where a single crossing can be the last one: the response closes in
        // on its final value over the whole bracket.
        let closes_in = || {
            let away = |m: usize| (self.curve[m] - gain).abs();
            (lower as usize..upper as usize).all(|m| away(m + 1) < away(m))
        };
        if bias == 0.0 && upper.is_finite() && closes_in() {
            interval_of(value, &mut self.figure(|shape| shape.settling), level)
        } else {
            Interval::new(value, lower, upper)
        }
    }

    /// Standard deviation of a sample minus `share` of the final value.
    fn sd_over(&self, m: usize, share: f64) -> f64 {
        let last = self.curve.len() - 1;
        let own = self.spread.sd[m].powi(2) + (share * self.spread.sd[last]).powi(2);
        (own - 2.0 * share * self.spread.with_last[m])
            .max(0.0)
            .sqrt()
    }
}

/// Critical values of one sample, and of as many as there are.
struct Critical {
    one: f64,
    all: f64,
}

impl Critical {
    /// Each end of the interval may be wrong with half of 1 - `level`.
    fn new(level: f64, samples: usize) -> Self {
        let tail = (1.0 - level) / 2.0;
        Self {
            one: normal_upper_quantile(tail),
            all: normal_upper_quantile(tail / samples as f64),
        }
    }
}

/// Figures with the whole response moved up and down.
struct BiasEffect {
    nominal: Shape,
    moved: [Shape; 2],
}

impl BiasEffect {
    /// Most negative and most positive change of a figure.
    fn of(&self, figure: impl Fn(&Shape) -> f64) -> (f64, f64) {
        let at = figure(&self.nominal);
        let change = self.moved.map(|shape| figure(&shape) - at);
        // What is not there in the estimate has no interval to widen.
        if !at.is_finite() {
            return (0.0, 0.0);
        }
        (
            change[0].min(change[1]).min(0.0),
            change[0].max(change[1]).max(0.0),
        )
    }
}

/// Student's widening of each sample, as in the band.
fn widening(measured: &Measured<'_>) -> Vec<f64> {
    let step = measured.step;
    let normal = pointwise_critical(step.pointwise.level);
    step.sd
        .iter()
        .zip(step.pointwise.upper.iter().zip(&step.pointwise.lower))
        .map(|(sd, (upper, lower))| {
            let half = (upper - lower) / 2.0 - step.truncation_bias;
            // The quotient of two rounded numbers may fall short of one.
            if *sd > 0.0 {
                (half / (normal * sd)).max(1.0)
            } else {
                1.0
            }
        })
        .collect()
}

fn widened(interval: Interval, (below, above): (f64, f64)) -> Interval {
    Interval {
        value: interval.value,
        lower: interval.lower.map(|lower| lower + below),
        upper: interval
            .upper
            .map(|upper| upper + above)
            .filter(|upper| upper.is_finite()),
    }
}

fn in_seconds(interval: Interval, of: impl Fn(f64) -> f64) -> Interval {
    Interval {
        value: interval.value.map(&of),
        lower: interval.lower.map(&of),
        upper: interval.upper.map(&of),
    }
}

fn percent(interval: Interval) -> Interval {
    in_seconds(interval, |share| 100.0 * share)
}

/// Lower triangular F with FF' = the matrix, which may be singular: directions that are rounding
/// are left out.
pub(crate) fn semidefinite_factor(matrix: &Mat<f64>) -> Mat<f64> {
    let size = matrix.nrows();
    // Rows of F as columns, for contiguous inner products.
    let mut rows = Mat::<f64>::zeros(size, size);
    for i in 0..size {
        for j in 0..=i {
            let known = dot(&rows.col_as_slice(i)[..j], &rows.col_as_slice(j)[..j]);
            let left = matrix[(i, j)] - known;
            rows[(j, i)] = if i == j {
                // Differences of squares: below this share of the variance nothing is left of it.
                if left > 1e-12 * matrix[(i, i)] {
                    left.sqrt()
                } else {
                    0.0
                }
            } else if rows[(j, j)] > 0.0 {
                left / rows[(j, j)]
            } else {
                0.0
            };
        }
    }
    rows.transpose().to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_abs_diff_eq;

    #[test]
    fn the_factor_of_a_singular_covariance_reproduces_it() {
        // Rank two in four dimensions.
        let basis = Mat::from_fn(4, 2, |i, k| ((i * 3 + k * 5) as f64 * 0.7).sin());
        let matrix = &basis * basis.transpose();
        let factor = semidefinite_factor(&matrix);
        let product = &factor * factor.transpose();
        for i in 0..4 {
            for j in 0..4 {
                // Directions of a millionth of a standard deviation may be left out.
                assert_abs_diff_eq!(product[(i, j)], matrix[(i, j)], epsilon = 1e-6);
            }
        }
    }

    #[test]
    fn intervals_of_normal_draws_are_those_of_the_distribution_at_any_level() {
        for level in [0.9, 0.99, 0.9999] {
            let mut random = ChaCha8Rng::seed_from_u64(3);
            let count = 2 * pairs(level);
            let mut draws: Vec<f64> = (0..count)
                .map(|_| StandardNormal.sample(&mut random))
                .collect();
            let interval = interval_of(0.0, &mut draws, level);
            let exact = pointwise_critical(level);
            // sd of a quantile with 25 draws beyond it: about 8 % at 99 %.
            assert_abs_diff_eq!(interval.upper.unwrap(), exact, epsilon = 0.25 * exact);
            assert_abs_diff_eq!(interval.lower.unwrap(), -exact, epsilon = 0.25 * exact);
        }
        assert_eq!(pairs(0.99), 2500);
    }
}
