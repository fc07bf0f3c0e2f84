//! What the numbers of the kernels, which are estimates themselves, add to the covariance (Laplace's approximation).
//!
//! It matters where the kernels come to describe the response almost entirely: that of a first order is a single exponential, and
//! its time constant is known as well as the data allow, and no better.

use crate::numerics::symmetric_eigen;
use faer::Mat;

use super::bfgs::Point;
use super::objective::Objective;

/// Half a step of the differences. The numbers are logarithms.
const STEP: f64 = 0.02;
/// Standard deviation of a number that the data say nothing about: a factor of twenty.
const UNKNOWN: f64 = 3.0;

/// Directions of the response, one in each column, of which each has one standard deviation of ε.
pub(super) fn directions(objective: &Objective<'_>, numbers: &[f64]) -> Option<Mat<f64>> {
    let size = numbers.len();
    let at = |k: usize, side: f64| {
        let mut moved = numbers.to_vec();
        moved[k] += side * STEP;
        let found = objective.at(&moved)?;
        Some((found.marginal.mean(), found.gradient()))
    };
    let (mut slopes, mut curvature) = (
        Mat::<f64>::zeros(objective.free.response.len(), size),
        Mat::<f64>::zeros(size, size),
    );
    for k in 0..size {
        let (above, below) = (at(k, 1.0)?, at(k, -1.0)?);
        for (i, (a, b)) in above.0.iter().zip(&below.0).enumerate() {
            slopes[(i, k)] = (a - b) / (2.0 * STEP);
        }
        for (i, (a, b)) in above.1.iter().zip(&below.1).enumerate() {
            // Of -ln of the likelihood, half of what the gradient is of; made symmetric.
            let half = (a - b) / (8.0 * STEP);
            curvature[(i, k)] += half;
            curvature[(k, i)] += half;
        }
    }
    let eigen = symmetric_eigen(&curvature)?;
    let scale = |k: usize| {
        let information = eigen.values[k].max(0.0) + UNKNOWN.powi(-2);
        information.sqrt().recip()
    };
    let rotated = slopes * &eigen.vectors;
    Some(Mat::from_fn(rotated.nrows(), size, |i, k| {
        rotated[(i, k)] * scale(k)
    }))
}
