//! The result of least squares.

use faer::Mat;

/// A least-squares solution.
#[derive(Clone)]
pub struct Solution {
    /// Coordinates, then the offset relative to the centre of the moments.
    pub coordinates: Vec<f64>,
    /// Sum of squares of the filtered residuals.
    pub rss: f64,
    /// (Z_D'Z_D)^-1 for the coordinates and the offset: times the noise variance, the covariance.
    pub inverse: Mat<f64>,
    /// 1-norm condition number of the coordinates' part of A, the offset projected out.
    pub condition: f64,
}

impl Solution {
    /// The offset relative to the centre of the moments.
    pub fn offset(&self) -> f64 {
        self.coordinates[self.coordinates.len() - 1]
    }

    /// The coordinates of the response.
    pub fn response(&self) -> &[f64] {
        &self.coordinates[..self.coordinates.len() - 1]
    }
}
