//! Two response curves and what lies between them, for all points at once.

use faer::Mat;

use crate::error::Error;
use crate::nonlinear::DirectionModel;
use crate::numerics::{dot, not_negative, simultaneous_critical, student_critical, times};
use crate::results::{Bounds, Model, farthest_within};

/// One or more response curves, one after the other.
#[derive(Debug, Clone)]
pub(crate) struct Curves {
    pub(crate) value: Vec<f64>,
    /// Points of each curve.
    pub(crate) points: usize,
    /// Their uncertainty, where bounds hold.
    pub(super) spread: Bounds<DifferenceSpread>,
}

/// The second moments of curves.
#[derive(Debug, Clone)]
pub(super) struct DifferenceSpread {
    pub(super) variance: Vec<f64>,
    /// Covariance of each point with the next; one fewer.
    neighbour: Vec<f64>,
    pub(super) degrees_of_freedom: f64,
    /// Bound of the errors that no variance contains.
    pub(super) bias: f64,
    /// Weights of the parameters in each point, a column for each, and those times the covariance.
    map: Mat<f64>,
    weighted: Mat<f64>,
}

impl Curves {
    /// The step response of a plain model, held at its final value up to `points` samples.
    pub(crate) fn of_model(model: &Model, points: usize) -> Result<Self, Error> {
        let map = model.basis()?.step_map();
        let map = held(&map, map.nrows(), points);
        let parameters = model.structure.frequencies + 1 + model.structure.noise_order;
        let degrees = (model.fit.samples_used as f64 - parameters as f64).max(1.0);
        let known = model.bounds.as_ref().zip(model.step.bounds.as_ref());
        Ok(Self {
            value: times(&map, &model.theta),
            points,
            spread: known.map(|(parameters, step)| {
                let covariance = parameters.covariance_matrix();
                DifferenceSpread::new(&map, &covariance, degrees, step.bias())
            }),
        })
    }

    /// Up and down response of a direction-split model, held at their final values up to `points` samples.
    pub(crate) fn of_split(model: &DirectionModel, points: usize) -> Self {
        let fit = &model.fit;
        let map = fit.curves_map();
        let map = held(&map, map.nrows() / 2, points);
        Self {
            value: times(&map, &fit.parameters),
            points,
            spread: model
                .level
                .map(|_| DifferenceSpread::new(&map, &fit.covariance, fit.degrees_of_freedom, 0.0)),
        }
    }

    /// How far each point is from the farthest of its curve that is up to `samples` away.
    fn reach_within(&self, samples: f64) -> Vec<f64> {
        let of_curve = |curve: &[f64]| -> Vec<f64> {
            let highest = farthest_within(samples, curve, f64::max);
            let lowest = farthest_within(samples, curve, f64::min);
            let ends = highest.into_iter().zip(lowest).zip(curve);
            ends.map(|((high, low), at)| (high - at).max(at - low))
                .collect()
        };
        self.value.chunks(self.points).flat_map(of_curve).collect()
    }

    /// The final value.
    pub(crate) fn gain(&self) -> f64 {
        self.value[self.points - 1]
    }
}

/// The rows of curves of `length` samples each, held at the last up to `points` samples.
fn held(map: &Mat<f64>, length: usize, points: usize) -> Mat<f64> {
    let curves = map.nrows() / length;
    Mat::from_fn(curves * points, map.ncols(), |row, column| {
        let (curve, sample) = (row / points, row % points);
        map[(curve * length + sample.min(length - 1), column)]
    })
}

impl DifferenceSpread {
    pub(super) fn new(
        map: &Mat<f64>,
        covariance: &Mat<f64>,
        degrees_of_freedom: f64,
        bias: f64,
    ) -> Self {
        let rows = map.transpose().to_owned();
        let weighted = covariance * &rows;
        let product = |i: usize, j: usize| dot(weighted.col_as_slice(i), rows.col_as_slice(j));
        Self {
            variance: (0..map.nrows())
                .map(|i| not_negative(product(i, i)))
                .collect(),
            neighbour: (1..map.nrows()).map(|i| product(i - 1, i)).collect(),
            degrees_of_freedom,
            bias,
            map: rows,
            weighted,
        }
    }

    /// Variance of the sum of the points of all curves, weighted.
    pub(super) fn variance_of(&self, weights: &[f64]) -> f64 {
        dot(&times(&self.map, weights), &times(&self.weighted, weights))
    }

    /// Variance of the changes from point to point of one curve, all added up; `which` are its points.
    pub(super) fn variance_of_changes(&self, which: std::ops::Range<usize>) -> f64 {
        let change = |m: usize| {
            let both = self.variance[m] + self.variance[m + 1];
            not_negative(both - 2.0 * self.neighbour[m])
        };
        (which.start..which.end.saturating_sub(1)).map(change).sum()
    }

    /// Half widths of the difference to another, for all points at once.
    fn half_widths(&self, other: &Self, level: f64) -> Vec<f64> {
        let count = self.variance.len();
        let sd: Vec<f64> = (0..count)
            .map(|m| (self.variance[m] + other.variance[m]).sqrt())
            .collect();
        let correlation: Vec<f64> = (1..count)
            .map(|m| match sd[m - 1] * sd[m] {
                scale if scale > 0.0 => {
                    ((self.neighbour[m - 1] + other.neighbour[m - 1]) / scale).clamp(-1.0, 1.0)
                }
                _ => 1.0,
            })
            .collect();
        let degrees = self.degrees_of_freedom.min(other.degrees_of_freedom);
        let q = student_critical(simultaneous_critical(&correlation, level), &[degrees])[0];
        let bias = self.bias + other.bias;
        sd.iter().map(|sd| q * sd + bias).collect()
    }
}

/// Bounds of the largest difference between two sets of curves, relative to the gain of the first.
#[derive(Debug, Clone, Copy)]
pub(crate) struct LargestDifference {
    /// The largest difference is at least this; negative when there may be none.
    pub(crate) at_least: f64,
    pub(crate) at_most: f64,
    /// Curve and point \[samples\] at which the difference is surest.
    pub(crate) curve: usize,
    pub(crate) sample: usize,
}

/// Scales tried to each side of the one that is stated: with 20 % to each side, the next is 0.02 % of the step away.
const SCALES: i32 = 1000;

/// Second curves minus the first, relative to the gain of the first.
#[derive(Debug, Clone)]
pub(crate) struct Differences {
    value: Vec<f64>,
    /// All differences lie within their half widths of these estimates at once with the probability of the
    /// level, and so does the largest.
    half: Bounds<Vec<f64>>,
    /// By how much each of them moves where the scale of the second curves is off by as much as it may be; `half` contains that.
    scale: Vec<f64>,
    points: usize,
    /// Final value of the first curves, without its sign.
    gain: f64,
}

impl Differences {
    /// Of the recordings: the bounds are those of the noise.
    pub(crate) fn of(a: &Curves, b: &Curves, level: f64) -> Self {
        let gain = a.gain().abs();
        let both = a.value.iter().zip(&b.value);
        let spreads = a.spread.as_ref().zip(b.spread.as_ref());
        Self {
            value: both.map(|(a, b)| (b - a) / gain).collect(),
            half: spreads.map(|(a, b)| {
                let half = a.half_widths(b, level).into_iter();
                half.map(|half| half / gain).collect()
            }),
            scale: vec![0.0; a.value.len()],
            points: a.points,
            gain,
        }
    }

    /// Of the servos behind the recordings: the differences `value` of the means of their runs, whose half widths `of_runs`
    /// count where they are larger than those of the noise.
    pub(super) fn of_servos(self, value: &[f64], of_runs: &[f64]) -> Self {
        let gain = self.gain;
        let wider = |(noise, runs): (f64, &f64)| noise.max(runs / gain);
        Self {
            value: value.iter().map(|d| d / gain).collect(),
            half: self
                .half
                .map(|half| half.into_iter().zip(of_runs).map(wider).collect()),
            ..self
        }
    }

    /// The same for sides whose times may be off from each other by up to `samples`: each half width contains how far either curve goes
    /// within that time.
    pub(super) fn with_delay_error(self, [a, b]: [&Curves; 2], samples: f64) -> Self {
        if samples == 0.0 {
            return self;
        }
        let gain = self.gain;
        let further = |(half, (a, b)): (f64, (f64, f64))| half + a.max(b) / gain;
        let reaches = a
            .reach_within(samples)
            .into_iter()
            .zip(b.reach_within(samples));
        Self {
            half: (self.half).map(|half| half.into_iter().zip(reaches).map(further).collect()),
            ..self
        }
    }

    /// The same where the scale of the second curves may be off from that of the first by `share` of it.
    pub(super) fn with_scale_error(self, b: &Curves, share: f64) -> Self {
        let gain = self.gain;
        let scale: Vec<f64> = b.value.iter().map(|b| share * b / gain).collect();
        // The errors of the second curves are as much larger as these may be.
        let further = |(half, scale): (f64, &f64)| (1.0 + share) * half + scale.abs();
        Self {
            half: (self.half).map(|half| half.into_iter().zip(&scale).map(further).collect()),
            scale,
            ..self
        }
    }

    pub(crate) fn curves(&self) -> usize {
        self.value.len() / self.points
    }

    /// Differences and half widths of one curve.
    pub(crate) fn curve(&self, index: usize) -> (&[f64], Bounds<&[f64]>) {
        let range = index * self.points..(index + 1) * self.points;
        let half = self.half.as_ref().map(|half| &half[range.clone()]);
        (&self.value[range], half)
    }

    /// The least that the largest difference may be, and the point where that is surest. One scale moves all points together: at each that is possible,
    /// some point shows the most.
    fn least_of_any_scale(&self, half: &[f64]) -> (f64, usize) {
        let of_scale = |part: f64| {
            let least = |m: usize| {
                (self.value[m] + part * self.scale[m]).abs() - (half[m] - self.scale[m].abs())
            };
            let all = (0..self.value.len()).map(|m| (least(m), m));
            all.max_by(|(a, _), (b, _)| a.total_cmp(b))
                .unwrap_or((0.0, 0))
        };
        if self.scale.iter().all(|scale| *scale == 0.0) {
            return of_scale(0.0);
        }
        let parts = (-SCALES..=SCALES).map(|k| f64::from(k) / f64::from(SCALES));
        parts
            .map(of_scale)
            .min_by(|(a, _), (b, _)| a.total_cmp(b))
            .unwrap_or((0.0, 0))
    }

    pub(crate) fn largest(&self) -> Bounds<LargestDifference> {
        self.half.as_ref().map(|half| {
            let (at_least, surest) = self.least_of_any_scale(half);
            let most = |(d, half): (&f64, &f64)| d.abs() + half;
            LargestDifference {
                at_least,
                at_most: self.value.iter().zip(half).map(most).fold(0.0, f64::max),
                curve: surest / self.points,
                sample: surest % self.points,
            }
        })
    }
}
