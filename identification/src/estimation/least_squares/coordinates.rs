//! The coordinates in which least squares is solved.

use faer::Mat;

use crate::estimation::fsf_basis::FsfBasis;
use crate::numerics::times;

/// The coordinates in which a bank is solved: the impulse response itself for a complete bank (T only
/// rotates it), θ for a smaller one.
#[derive(Clone)]
pub struct Coordinates {
    /// The bank.
    pub basis: FsfBasis,
    /// T, unless the bank is complete.
    pub(super) map: Option<Mat<f64>>,
}

impl Coordinates {
    /// Coordinates for `basis`.
    pub fn new(basis: FsfBasis) -> Self {
        Self {
            basis,
            map: (!basis.is_complete()).then(|| basis.impulse_map()),
        }
    }

    /// Coordinates θ, also for a complete bank.
    pub fn in_theta(basis: FsfBasis) -> Self {
        Self {
            basis,
            map: Some(basis.impulse_map()),
        }
    }

    /// Number of parameters without the offset.
    pub fn len(&self) -> usize {
        self.basis.frequencies()
    }

    /// The impulse response of a vector of coordinates.
    pub fn impulse(&self, coordinates: &[f64]) -> Vec<f64> {
        match &self.map {
            Some(map) => times(map, coordinates),
            None => coordinates.to_vec(),
        }
    }

    /// The coordinates of an impulse response, as far as the bank has it.
    pub fn of_impulse(&self, impulse: &[f64]) -> Vec<f64> {
        match &self.map {
            Some(_) => times(&self.basis.analysis_map(), impulse),
            None => impulse.to_vec(),
        }
    }

    /// From coordinates to step response: N x n.
    pub fn step_map(&self) -> Mat<f64> {
        match self.map {
            Some(_) => self.basis.step_map(),
            None => {
                let n = self.basis.settling();
                Mat::from_fn(n, n, |m, i| f64::from(u8::from(i <= m)))
            }
        }
    }

    /// From coordinates to θ: n x n, `None` when they are θ.
    pub fn theta_map(&self) -> Option<Mat<f64>> {
        self.map.is_none().then(|| self.basis.analysis_map())
    }

    /// T C T': the covariance of the impulse response from that of the coordinates.
    pub fn expand(&self, covariance: Mat<f64>) -> Mat<f64> {
        match &self.map {
            Some(map) => map * (covariance * map.transpose()),
            None => covariance,
        }
    }

    /// M T: columns of lags combined into columns of coordinates.
    pub(crate) fn combine(&self, matrix: Mat<f64>) -> Mat<f64> {
        match &self.map {
            Some(map) => matrix * map,
            None => matrix,
        }
    }

    /// T M: the impulse response of each column of coordinates.
    pub(crate) fn impulses(&self, matrix: Mat<f64>) -> Mat<f64> {
        match &self.map {
            Some(map) => map * matrix,
            None => matrix,
        }
    }

    /// From coordinates to impulse response, `None` when they are the impulse response.
    pub fn impulse_map(&self) -> Option<&Mat<f64>> {
        self.map.as_ref()
    }

    /// T'M T.
    pub(crate) fn square(&self, matrix: Mat<f64>) -> Mat<f64> {
        self.compress(self.combine(matrix))
    }

    /// T'M.
    pub(crate) fn compress(&self, matrix: Mat<f64>) -> Mat<f64> {
        match &self.map {
            Some(map) => map.transpose() * matrix,
            None => matrix,
        }
    }
}
