//! The uncertainty of the samples of a step response, alone and jointly.
//!
//! Every sample is widened by Student's t as the band is, so that normal quantiles of a widened
//! response are Student's of the response itself.

use faer::Mat;

use super::measured::Measured;
use crate::numerics::{dot, not_negative, pointwise_critical};

/// Second moments of a step response.
pub(crate) struct SampleSpread<'a> {
    measured: &'a Measured<'a>,
    /// Factor on the deviations of each sample.
    widening: Vec<f64>,
    /// Standard deviation of each sample.
    pub(crate) sd: Vec<f64>,
    /// Covariance of each sample with the last.
    with_last: Vec<f64>,
}

impl<'a> SampleSpread<'a> {
    pub(crate) fn new(measured: &'a Measured<'a>) -> Self {
        let widening = widening(measured);
        let last = widening.len() - 1;
        let sd = measured.step_bounds.sd.iter().zip(&widening);
        // The last sample is G0 itself, the first parameter.
        let with_gain = measured.covariance.col_as_slice(0);
        let with_last = measured.basis.step_response(with_gain);
        Self {
            sd: sd.map(|(sd, factor)| sd * factor).collect(),
            with_last: with_last
                .iter()
                .zip(&widening)
                .map(|(covariance, factor)| covariance * factor * widening[last])
                .collect(),
            widening,
            measured,
        }
    }

    /// Largest widening.
    pub(crate) fn widest(&self) -> f64 {
        self.widening.iter().copied().fold(1.0, f64::max)
    }

    /// Standard deviation of sample `m` minus `share` of the final value.
    pub(crate) fn sd_over(&self, m: usize, share: f64) -> f64 {
        let own = self.sd[m].powi(2) + (share * self.sd[self.sd.len() - 1]).powi(2);
        not_negative(own - 2.0 * share * self.with_last[m]).sqrt()
    }

    /// Covariance of the samples `points`.
    pub(crate) fn covariance(&self, points: &[usize]) -> Mat<f64> {
        let mut rows = self.measured.basis.step_rows(points);
        for (k, &m) in points.iter().enumerate() {
            for entry in rows.col_as_slice_mut(k) {
                *entry *= self.widening[m];
            }
        }
        rows.transpose() * (&self.measured.covariance * &rows)
    }
}

/// Student's widening of each sample.
fn widening(measured: &Measured<'_>) -> Vec<f64> {
    let step = measured.step_bounds;
    let normal = pointwise_critical(step.level);
    step.sd
        .iter()
        .zip(step.pointwise.upper.iter().zip(&step.pointwise.lower))
        .map(|(sd, (upper, lower))| {
            let half = (upper - lower) / 2.0 - step.bias();
            // The quotient of two rounded numbers may fall short of one.
            if *sd > 0.0 {
                (half / (normal * sd)).max(1.0)
            } else {
                1.0
            }
        })
        .collect()
}

/// A weighted sum of at most five samples: weights of the four around a place between samples, and
/// of the last.
pub(crate) type Weights = [(usize, f64); 5];

/// Some samples of a curve and their covariance.
pub(crate) struct Joint {
    /// Which samples, ascending.
    pub(crate) points: Vec<usize>,
    pub(crate) covariance: Mat<f64>,
    /// Place of each sample of the curve among the points.
    place: Vec<Option<usize>>,
}

impl Joint {
    pub(crate) fn new(spread: &SampleSpread<'_>, points: Vec<usize>) -> Self {
        let mut place = vec![None; spread.sd.len()];
        for (k, &m) in points.iter().enumerate() {
            place[m] = Some(k);
        }
        Self {
            covariance: spread.covariance(&points),
            points,
            place,
        }
    }

    /// Covariance of two weighted sums; `None` when a sample is not among the points.
    pub(crate) fn covariance_of(&self, a: &Weights, b: &Weights) -> Option<f64> {
        let weights = |sum: &Weights| {
            let mut placed = [(0, 0.0); 5];
            for (placed, &(m, weight)) in placed.iter_mut().zip(sum) {
                *placed = match weight {
                    0.0 => (0, 0.0),
                    weight => (self.place[m]?, weight),
                };
            }
            Some(placed)
        };
        let (a, b) = (weights(a)?, weights(b)?);
        let with_b = |i: usize| -> f64 {
            b.iter()
                .map(|&(j, weight)| weight * self.covariance[(j, i)])
                .sum()
        };
        Some(a.iter().map(|&(i, weight)| weight * with_b(i)).sum())
    }

    /// Standard deviation of a weighted sum; `None` when a sample is not among the points.
    pub(crate) fn sd_of(&self, sum: &Weights) -> Option<f64> {
        Some(not_negative(self.covariance_of(sum, sum)?).sqrt())
    }
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
}
