//! Two response curves and what lies between them, for all points at once.

use faer::Mat;

use crate::error::Error;
use crate::nonlinear::direction::DirectionModel;
use crate::numerics::critical_values::{simultaneous_critical, student_critical};
use crate::numerics::linear_algebra::times;
use crate::numerics::vectors::dot;
use crate::results::metrics::covariance_of;
use crate::results::model::Model;

/// One or more response curves, one after the other, with their second moments.
#[derive(Debug, Clone)]
pub(crate) struct Curves {
    pub(crate) value: Vec<f64>,
    pub(super) variance: Vec<f64>,
    /// Covariance of each point with the next; one fewer.
    neighbour: Vec<f64>,
    pub(super) degrees_of_freedom: f64,
    /// Bound of what no variance covers.
    pub(super) bias: f64,
    /// Points of each curve.
    pub(crate) points: usize,
    /// Weights of the parameters in each point, a column for each, and those times the covariance.
    map: Mat<f64>,
    weighted: Mat<f64>,
}

impl Curves {
    /// The step response of a plain model, held at its final value up to `points` samples.
    pub(crate) fn of_model(model: &Model, points: usize) -> Result<Self, Error> {
        let map = model.basis()?.step_map();
        let last = map.nrows() - 1;
        let map = Mat::from_fn(points, map.ncols(), |m, k| map[(m.min(last), k)]);
        let bias = model.step.bias();
        let parameters = model.structure.frequencies + 1 + model.structure.noise_order;
        let degrees = (model.fit.samples_used as f64 - parameters as f64).max(1.0);
        Ok(Self::new(
            &map,
            &model.theta,
            &covariance_of(model),
            degrees,
            bias,
            points,
        ))
    }

    /// Up and down response of a direction-split model.
    pub(crate) fn of_split(model: &DirectionModel) -> Self {
        let fit = &model.fit;
        let map = fit.curves_map();
        let points = map.nrows() / 2;
        Self::new(
            &map,
            &fit.parameters,
            &fit.covariance,
            fit.degrees_of_freedom,
            0.0,
            points,
        )
    }

    pub(super) fn new(
        map: &Mat<f64>,
        parameters: &[f64],
        covariance: &Mat<f64>,
        degrees_of_freedom: f64,
        bias: f64,
        points: usize,
    ) -> Self {
        let rows = map.transpose().to_owned();
        let weighted = covariance * &rows;
        let product = |i: usize, j: usize| dot(weighted.col_as_slice(i), rows.col_as_slice(j));
        Self {
            value: times(map, parameters),
            variance: (0..map.nrows()).map(|i| product(i, i).max(0.0)).collect(),
            neighbour: (1..map.nrows()).map(|i| product(i - 1, i)).collect(),
            degrees_of_freedom,
            bias,
            points,
            map: rows,
            weighted,
        }
    }

    /// Variance of the sum of the points of all curves, weighted.
    pub(super) fn variance_of(&self, weights: &[f64]) -> f64 {
        dot(&times(&self.map, weights), &times(&self.weighted, weights))
    }

    /// The final value.
    pub(crate) fn gain(&self) -> f64 {
        self.value[self.points - 1]
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

/// Second curves minus the first, relative to the gain of the first: all of them lie within their half
/// widths of these estimates at once with probability `level`, and so does the largest.
#[derive(Debug, Clone)]
pub(crate) struct Differences {
    value: Vec<f64>,
    half: Vec<f64>,
    points: usize,
}

impl Differences {
    pub(crate) fn of(a: &Curves, b: &Curves, level: f64) -> Self {
        let count = a.value.len();
        let sd: Vec<f64> = (0..count)
            .map(|m| (a.variance[m] + b.variance[m]).sqrt())
            .collect();
        let correlation: Vec<f64> = (1..count)
            .map(|m| {
                let scale = sd[m - 1] * sd[m];
                if scale > 0.0 {
                    ((a.neighbour[m - 1] + b.neighbour[m - 1]) / scale).clamp(-1.0, 1.0)
                } else {
                    1.0
                }
            })
            .collect();
        let degrees = a.degrees_of_freedom.min(b.degrees_of_freedom);
        let q = student_critical(simultaneous_critical(&correlation, level), &[degrees])[0];
        let (bias, gain) = (a.bias + b.bias, a.gain().abs());
        let both = a.value.iter().zip(&b.value);
        Self {
            value: both.map(|(a, b)| (b - a) / gain).collect(),
            half: sd.iter().map(|sd| (q * sd + bias) / gain).collect(),
            points: a.points,
        }
    }

    pub(crate) fn curves(&self) -> usize {
        self.value.len() / self.points
    }

    /// Differences and half widths of one curve.
    pub(crate) fn curve(&self, index: usize) -> (&[f64], &[f64]) {
        let range = index * self.points..(index + 1) * self.points;
        (&self.value[range.clone()], &self.half[range])
    }

    pub(crate) fn largest(&self) -> LargestDifference {
        let least = |m: usize| self.value[m].abs() - self.half[m];
        let surest = (0..self.value.len())
            .max_by(|&i, &j| least(i).total_cmp(&least(j)))
            .unwrap_or(0);
        let most = |(d, half): (&f64, &f64)| d.abs() + half;
        LargestDifference {
            at_least: least(surest),
            at_most: self
                .value
                .iter()
                .zip(&self.half)
                .map(most)
                .fold(0.0, f64::max),
            curve: surest / self.points,
            sample: surest % self.points,
        }
    }
}
