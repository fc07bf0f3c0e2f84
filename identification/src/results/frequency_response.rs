//! The frequency response and its bounds.
//!
//! At each frequency the estimate of G is a pair of normal quantities, so its uncertainty is an
//! ellipse in the complex plane. The bounds on the phase are the tangents from the origin to that
//! ellipse, which holds exactly at any ratio of signal to noise (Fieller's argument: for the true
//! direction, the part of the estimate across it has mean zero). The bounds on the magnitude are the
//! nearest and the farthest point of the ellipse; where the origin itself cannot be excluded, the
//! ellipse is the larger one of both parts jointly, and the lower bound is zero. What frequencies that
//! were left out may do (see [`crate::estimation::truncation`]) is a disc around each point of that region.

use std::f64::consts::{PI, TAU};

use faer::Mat;
use serde::{Deserialize, Serialize};

use crate::data::Timing;
use crate::estimation::{Coordinates, CurveVariance};
use crate::numerics::pointwise_critical;
use crate::options::LEVELS;
use crate::results::step_response::is_zero;
use crate::results::usable_numbers::{LARGEST, is_sized};
use crate::results::validity::Bounds;

/// Decibels that stand for a magnitude of zero.
pub const ZERO_DB: f64 = -300.0;

/// Coarse angles among which the extremes of an ellipse are looked for.
const STEPS: usize = 48;

/// Frequencies of the response in a document.
const POINTS: usize = 120;

/// The response at a row of frequencies.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FrequencyResponse {
    /// Frequencies \[rad/s\].
    pub omega_rad_s: Vec<f64>,
    /// Re G.
    pub re: Vec<f64>,
    /// Im G; a lag is negative.
    pub im: Vec<f64>,
    /// 20 log10 |G|.
    pub magnitude_db: Vec<f64>,
    /// Phase \[degrees\], continuous over frequency; a lag is negative.
    pub phase_deg: Vec<f64>,
    /// Its bounds, where they hold.
    #[serde(flatten)]
    pub bounds: Bounds<FrequencyBounds>,
}

/// Bounds of a frequency response, for each frequency by itself.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FrequencyBounds {
    /// Confidence level.
    pub level: f64,
    /// Lower bound of the magnitude; -300 dB stands for zero.
    pub magnitude_db_lower: Vec<f64>,
    /// Upper bound of the magnitude.
    pub magnitude_db_upper: Vec<f64>,
    /// Lower bound of the phase; 180 below it when any phase is possible.
    pub phase_deg_lower: Vec<f64>,
    /// Upper bound of the phase; 180 above it when any phase is possible.
    pub phase_deg_upper: Vec<f64>,
    /// Bound of the error of G, as a distance in the complex plane, from leaving out high frequencies and from
    /// the steps of the sensor, and in the response of the servo itself
    /// ([`Model::servo_response`](crate::results::Model::servo_response)) from higher frequencies that fold onto these; it is
    /// part of all bounds. Empty where there is none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub bias: Vec<f64>,
    /// How many times as wide as those of even noise of known size, with the same covariance of θ, the bounds are: Student's t, and of few runs that differ
    /// their own. With it, bounds at other frequencies follow from that covariance. Empty in documents from before this was kept.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub widening: Vec<f64>,
    /// How much earlier or later than it is taken for the output may have been recorded \[s\]; it is part of the bounds of the phase.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub delay_error_s: f64,
}

/// Frequencies \[rad/sample\] for a document: evenly spaced on a logarithmic scale from a tenth of
/// the fundamental to the highest frequency of the bank.
#[must_use]
pub(crate) fn frequency_grid(coordinates: &Coordinates) -> Vec<f64> {
    let basis = &coordinates.basis;
    let low = 0.1 * basis.fundamental();
    let high = basis.highest().max(1) as f64 * basis.fundamental();
    let ratio = (high / low).ln() / (POINTS - 1) as f64;
    (0..POINTS)
        .map(|k| low * (ratio * k as f64).exp())
        .collect()
}

/// Rows for Re G and Im G at each frequency \[rad/sample\], in the coordinates of a fit: 2f x n.
#[must_use]
pub fn frequency_map(coordinates: &Coordinates, omegas: &[f64]) -> Mat<f64> {
    if coordinates.impulse_map().is_some() {
        let rows: Vec<_> = omegas
            .iter()
            .map(|&omega| coordinates.basis.frequency_rows(omega))
            .collect();
        return Mat::from_fn(2 * omegas.len(), coordinates.len(), |k, i| {
            let (re, im) = &rows[k / 2];
            if k % 2 == 0 { re[i] } else { im[i] }
        });
    }
    let mut map = Mat::zeros(2 * omegas.len(), coordinates.len());
    for (k, omega) in omegas.iter().enumerate() {
        // Turned on step by step: after N steps the error is N roundings.
        let (sin, cos) = omega.sin_cos();
        let mut point = (1.0, 0.0);
        for i in 0..coordinates.len() {
            map[(2 * k, i)] = point.0;
            map[(2 * k + 1, i)] = -point.1;
            point = (point.0 * cos - point.1 * sin, point.0 * sin + point.1 * cos);
        }
    }
    map
}

impl FrequencyResponse {
    /// The response with `values`, which alternate between Re G and Im G at `omegas` \[rad/sample\].
    #[must_use]
    pub(crate) fn new(
        sample_period_s: f64,
        omegas: &[f64],
        values: &[f64],
        bounds: Bounds<FrequencyBounds>,
    ) -> Self {
        let points = || values.chunks_exact(2).map(|point| (point[0], point[1]));
        Self {
            omega_rad_s: omegas.iter().map(|omega| omega / sample_period_s).collect(),
            re: points().map(|(re, _)| re).collect(),
            im: points().map(|(_, im)| im).collect(),
            magnitude_db: points().map(|(re, im)| decibels(re.hypot(im))).collect(),
            phase_deg: continuous_phase(values),
            bounds,
        }
    }

    /// The response of the servo itself, from that of its samples: freed of their hold and phase.
    #[must_use]
    pub fn freed_of_hold(mut self, timing: Timing) -> Self {
        let (mut magnitudes, mut phases) =
            (vec![&mut self.magnitude_db], vec![&mut self.phase_deg]);
        if let Bounds::Valid(bounds) = &mut self.bounds {
            magnitudes.extend([
                &mut bounds.magnitude_db_lower,
                &mut bounds.magnitude_db_upper,
            ]);
            phases.extend([&mut bounds.phase_deg_lower, &mut bounds.phase_deg_upper]);
            for (bias, omega) in bounds.bias.iter_mut().zip(&self.omega_rad_s) {
                *bias *= timing.magnitude_factor(*omega);
            }
        }
        for (k, &omega) in self.omega_rad_s.iter().enumerate() {
            let (factor, lead) = (timing.magnitude_factor(omega), timing.phase_lead(omega));
            let (sin, cos) = lead.sin_cos();
            let (re, im) = (self.re[k], self.im[k]);
            self.re[k] = factor * (re * cos - im * sin);
            self.im[k] = factor * (re * sin + im * cos);
            for magnitude in magnitudes.iter_mut().map(|all| &mut all[k]) {
                if *magnitude > ZERO_DB {
                    *magnitude += 20.0 * factor.log10();
                }
            }
            for phase in &mut phases {
                phase[k] += lead.to_degrees();
            }
        }
        self
    }

    /// Whether all of it is of one length, with numbers that can be computed with.
    pub(super) fn is_consistent(&self) -> bool {
        let sized = |values: &[f64]| is_sized(values, self.omega_rad_s.len());
        let bounds = self.bounds.valid().is_none_or(|bounds| {
            LEVELS.contains(&bounds.level)
                && [&bounds.magnitude_db_lower, &bounds.magnitude_db_upper]
                    .into_iter()
                    .chain([&bounds.phase_deg_lower, &bounds.phase_deg_upper])
                    .all(|values| sized(values))
                && (bounds.bias.is_empty() || sized(&bounds.bias))
                && (bounds.widening.is_empty() || sized(&bounds.widening))
                && bounds.widening.iter().all(|times| *times >= 1.0)
                && bounds.bias.iter().all(|bias| *bias >= 0.0)
                && (0.0..=LARGEST).contains(&bounds.delay_error_s)
        });
        bounds
            && [&self.omega_rad_s, &self.re, &self.im]
                .into_iter()
                .chain([&self.magnitude_db, &self.phase_deg])
                .all(|values| sized(values))
    }
}

impl FrequencyBounds {
    /// The same at `omega_rad_s` for output that may have been recorded up to `seconds` earlier or later.
    #[must_use]
    pub(crate) fn with_delay_error(mut self, omega_rad_s: &[f64], seconds: f64) -> Self {
        for (k, omega) in omega_rad_s.iter().enumerate() {
            let turned = (omega * seconds).to_degrees();
            self.phase_deg_lower[k] -= turned;
            self.phase_deg_upper[k] += turned;
        }
        self.delay_error_s += seconds;
        self
    }

    /// The same with errors of G of up to `bias` beside those in the bounds, one for each frequency.
    #[must_use]
    pub(crate) fn with_bias(mut self, bias: &[f64]) -> Self {
        let magnitude = |db: f64| 10f64.powf(db / 20.0);
        for (k, bias) in bias.iter().enumerate() {
            let nearest = magnitude(self.magnitude_db_lower[k]);
            let half = (self.phase_deg_upper[k] - self.phase_deg_lower[k]) / 2.0;
            let middle = self.phase_deg_lower[k] + half;
            let (half, _) = with_disc((half.to_radians(), PI), *bias, || nearest);
            self.phase_deg_lower[k] = middle - half.to_degrees();
            self.phase_deg_upper[k] = middle + half.to_degrees();
            self.magnitude_db_lower[k] = decibels((nearest - bias).max(0.0));
            self.magnitude_db_upper[k] = decibels(magnitude(self.magnitude_db_upper[k]) + bias);
        }
        self.bias = bias.to_vec();
        self
    }

    /// The same beside the errors that the bounds allow for already.
    #[must_use]
    pub(crate) fn with_further_bias(self, extra: &[f64]) -> Self {
        let before = self.bias.clone();
        let mut found = self.with_bias(extra);
        for (sum, before) in found.bias.iter_mut().zip(before) {
            *sum += before;
        }
        found
    }

    /// The half widths of magnitude \[dB\] and phase \[degrees\]: means and largest over the frequencies.
    #[must_use]
    pub fn half_widths(&self) -> [(f64, f64); 2] {
        let of = |lower: &[f64], upper: &[f64]| {
            let halves = || lower.iter().zip(upper).map(|(l, u)| (u - l) / 2.0);
            let count = lower.len().max(1) as f64;
            (halves().sum::<f64>() / count, halves().fold(0.0, f64::max))
        };
        [
            of(&self.magnitude_db_lower, &self.magnitude_db_upper),
            of(&self.phase_deg_lower, &self.phase_deg_upper),
        ]
    }

    /// Draws the bounds around `values`, which alternate between Re G and Im G, as do the entries of `spread`.
    /// `bias` bounds the other errors of G; it is empty where there are none.
    #[must_use]
    pub(crate) fn new(values: &[f64], spread: &CurveVariance, level: f64, bias: Vec<f64>) -> Self {
        let normal = pointwise_critical(level);
        let single = spread.critical(normal);
        // The quotient of two rounded numbers may fall short of one.
        let widening =
            (single.chunks_exact(2)).map(|pair| (pair[0].max(pair[1]) / normal).max(1.0));
        // Radius of the joint region of two normal quantities: -2 ln(1 - level), squared.
        let joint = (-2.0 * (1.0 - level).ln()).sqrt();
        let joint = spread.critical(joint);
        let mut bounds = Self {
            level,
            magnitude_db_lower: Vec::new(),
            magnitude_db_upper: Vec::new(),
            phase_deg_lower: Vec::new(),
            phase_deg_upper: Vec::new(),
            bias,
            widening: widening.collect(),
            delay_error_s: 0.0,
        };
        for (k, phase) in continuous_phase(values).into_iter().enumerate() {
            let region = Ellipse::new(
                (values[2 * k], values[2 * k + 1]),
                (spread.sd[2 * k], spread.sd[2 * k + 1]),
                spread.neighbour_correlation[2 * k],
            );
            let radius = |critical: &[f64]| critical[2 * k].max(critical[2 * k + 1]);
            let (single, joint) = (radius(&single), radius(&joint));
            let excluded = region.distance_of_origin() > joint;
            let (nearest, high) = region.magnitudes(if excluded { single } else { joint });
            let bias = bounds.bias.get(k).copied().unwrap_or(0.0);
            let low = match excluded {
                true => (nearest - bias).max(0.0),
                false => 0.0,
            };
            bounds.magnitude_db_lower.push(decibels(low));
            bounds.magnitude_db_upper.push(decibels(high + bias));
            let nearest = || match excluded {
                true => nearest,
                false => region.magnitudes(single).0,
            };
            let (below, above) = with_disc(region.phase_margins(single), bias, nearest);
            bounds.phase_deg_lower.push(phase - below.to_degrees());
            bounds.phase_deg_upper.push(phase + above.to_degrees());
        }
        bounds
    }

    /// [`FrequencyBounds::widening`] at `omega`, of the response at the frequencies `known` \[rad/s\]: the larger one of its neighbours. `None` where it was not kept.
    pub(crate) fn widening_at(&self, known: &[f64], omega: f64) -> Option<f64> {
        let highest = self.widening.len().checked_sub(1)?;
        let next = known.partition_point(|known| *known < omega).min(highest);
        Some(self.widening[next].max(self.widening[next.saturating_sub(1)]))
    }

    /// [`FrequencyBounds::bias`] at `omega`, of the response at the frequencies `known` \[rad/s\]. Above the
    /// highest frequency kept only |G| itself has a bound.
    pub(crate) fn bias_at(&self, known: &[f64], omega: f64) -> f64 {
        let Some(highest) = self.bias.len().checked_sub(1) else {
            return 0.0;
        };
        let next = known.partition_point(|known| *known < omega);
        if next > highest {
            let largest = 10f64.powf(self.magnitude_db_upper[highest] / 20.0);
            return 2.0 * largest;
        }
        self.bias[next].max(self.bias[next.saturating_sub(1)])
    }
}

/// The phase of Re G and Im G in turn \[degrees\], each on the branch next to the one before.
fn continuous_phase(values: &[f64]) -> Vec<f64> {
    let mut previous = 0.0;
    let next = |point: &[f64]| {
        let phase = point[1].atan2(point[0]).to_degrees();
        previous = phase + 360.0 * ((previous - phase) / 360.0_f64).round();
        previous
    };
    values.chunks_exact(2).map(next).collect()
}

fn decibels(magnitude: f64) -> f64 {
    (20.0 * magnitude.log10()).max(ZERO_DB)
}

/// The uncertainty of a complex number.
struct Ellipse {
    centre: (f64, f64),
    /// Half axes for a radius of one, and the direction of the first.
    axes: (f64, f64),
    direction: f64,
}

impl Ellipse {
    fn new(centre: (f64, f64), sd: (f64, f64), correlation: f64) -> Self {
        let (xx, yy) = (sd.0 * sd.0, sd.1 * sd.1);
        let xy = correlation * sd.0 * sd.1;
        let (mean, difference) = ((xx + yy) / 2.0, (xx - yy) / 2.0);
        let radius = difference.hypot(xy);
        Self {
            centre,
            axes: ((mean + radius).sqrt(), (mean - radius).max(0.0).sqrt()),
            direction: 0.5 * xy.atan2(difference),
        }
    }

    /// The centre in the coordinates of the axes.
    fn turned(&self) -> (f64, f64) {
        let (sin, cos) = self.direction.sin_cos();
        let (x, y) = self.centre;
        (cos * x + sin * y, cos * y - sin * x)
    }

    /// Standard deviations from the centre to the origin.
    fn distance_of_origin(&self) -> f64 {
        let (x, y) = self.turned();
        let part = |x: f64, axis: f64| match (x == 0.0, axis > 0.0) {
            (true, _) => 0.0,
            (false, true) => x / axis,
            (false, false) => f64::INFINITY,
        };
        part(x, self.axes.0).hypot(part(y, self.axes.1))
    }

    /// Nearest and farthest distance from the origin of the ellipse of `radius`.
    fn magnitudes(&self, radius: f64) -> (f64, f64) {
        let (x, y) = self.turned();
        let (a, b) = (radius * self.axes.0, radius * self.axes.1);
        let square = |(sin, cos): (f64, f64)| (x + a * cos).powi(2) + (y + b * sin).powi(2);
        let angle_of = |k: usize| TAU * k as f64 / STEPS as f64;
        let coarse: [f64; STEPS] = std::array::from_fn(|k| square(angle_of(k).sin_cos()));
        let by_distance = |i: &usize, k: &usize| coarse[*i].total_cmp(&coarse[*k]);
        let nearest = (0..STEPS).min_by(by_distance).unwrap_or(0);
        // Of equals the first.
        let farthest = (0..STEPS).rev().max_by(by_distance).unwrap_or(0);
        // Newton's rule on the derivative of the squared distance, from the best of the coarse
        // angles; a step against the curvature or beyond the next angle is not taken.
        let refined = |k: usize, sign: f64| {
            let mut angle = angle_of(k);
            let mut point = angle.sin_cos();
            for _ in 0..6 {
                let (sin, cos) = point;
                let slope = b * cos * (y + b * sin) - a * sin * (x + a * cos);
                let curvature = b * b * cos * cos - b * sin * (y + b * sin) + a * a * sin * sin
                    - a * cos * (x + a * cos);
                let step = -slope / curvature;
                if sign * curvature <= 0.0 || step.abs() > TAU / STEPS as f64 {
                    break;
                }
                angle += step;
                point = angle.sin_cos();
                // At an extreme the distance changes with the square of the angle.
                if step.abs() < 1e-8 {
                    break;
                }
            }
            square(point).sqrt()
        };
        (refined(nearest, 1.0), refined(farthest, -1.0))
    }

    /// How far the phase may lie below and above that of the centre \[rad\]; π when any phase is
    /// possible.
    fn phase_margins(&self, radius: f64) -> (f64, f64) {
        if self.distance_of_origin() <= radius {
            return (PI, PI);
        }
        // Scaled so that the ellipse is a circle of `radius`, tangents from the origin are at
        // equal angles to the centre; scaled back, they are the bounds.
        let (x, y) = self.turned();
        let (a, b) = self.axes;
        let centre = y.atan2(x);
        if a == 0.0 {
            return (0.0, 0.0);
        }
        let b = b.max(1e-9 * a);
        let (x, y) = (x / a, y / b);
        let half = (radius / x.hypot(y)).asin();
        let bound = |side: f64| {
            let (sin, cos) = (y.atan2(x) + side * half).sin_cos();
            let difference = (b * sin).atan2(a * cos) - centre;
            let turns = (difference / TAU).round();
            (difference - turns * TAU).abs()
        };
        (bound(-1.0), bound(1.0))
    }
}

/// Margins of the phase with a disc of radius `bias` around each point of a region whose point nearest to
/// the origin is `nearest` from it.
fn with_disc(margins: (f64, f64), bias: f64, nearest: impl Fn() -> f64) -> (f64, f64) {
    if bias == 0.0 || margins.0 >= PI {
        return margins;
    }
    let share = bias / nearest();
    if share >= 1.0 {
        return (PI, PI);
    }
    let further = share.asin();
    ((margins.0 + further).min(PI), (margins.1 + further).min(PI))
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_abs_diff_eq;

    #[test]
    fn a_round_uncertainty_gives_the_plain_geometry() {
        let region = Ellipse::new((3.0, 4.0), (0.5, 0.5), 0.0);
        assert_abs_diff_eq!(region.distance_of_origin(), 10.0, epsilon = 1e-12);
        let (low, high) = region.magnitudes(2.0);
        assert_abs_diff_eq!(low, 4.0, epsilon = 1e-9);
        assert_abs_diff_eq!(high, 6.0, epsilon = 1e-9);
        let (below, above) = region.phase_margins(2.0);
        assert_abs_diff_eq!(below, 0.2f64.asin(), epsilon = 1e-12);
        assert_abs_diff_eq!(above, 0.2f64.asin(), epsilon = 1e-12);
        assert_eq!(region.phase_margins(10.1).0, PI);
    }

    #[test]
    fn bounds_of_a_slanted_ellipse_are_those_of_its_outline() {
        let (sd, correlation, radius) = ((0.3, 0.1), 0.8, 2.5758);
        let centre = (-1.0, 0.6);
        let region = Ellipse::new(centre, sd, correlation);
        let (mut low, mut high) = (f64::INFINITY, 0.0f64);
        let (mut below, mut above) = (0.0f64, 0.0f64);
        let at = centre.1.atan2(centre.0);
        for k in 0..200_000 {
            let (sin, cos) = (f64::from(k) * TAU / 200_000.0).sin_cos();
            // Cholesky factor of the covariance maps the circle to the ellipse.
            let x = centre.0 + radius * sd.0 * cos;
            let y = centre.1
                + radius * sd.1 * (correlation * cos + (1.0f64 - correlation.powi(2)).sqrt() * sin);
            low = low.min(x.hypot(y));
            high = high.max(x.hypot(y));
            let turn = y.atan2(x) - at;
            let turn = turn - TAU * (turn / TAU).round();
            below = below.max(-turn);
            above = above.max(turn);
        }
        let magnitudes = region.magnitudes(radius);
        let margins = region.phase_margins(radius);
        // 200 000 points around the outline.
        assert_abs_diff_eq!(magnitudes.0, low, epsilon = 1e-6);
        assert_abs_diff_eq!(magnitudes.1, high, epsilon = 1e-6);
        assert_abs_diff_eq!(margins.0, below, epsilon = 1e-6);
        assert_abs_diff_eq!(margins.1, above, epsilon = 1e-6);
    }
}
