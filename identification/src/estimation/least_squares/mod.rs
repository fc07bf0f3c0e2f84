//! Least squares on D-filtered rows, from information whose size does not depend on the record.
//!
//! For a bank with impulse map T and a noise filter D the rows D(z)[φ', 1] and D(z)y have
//!
//! ```text
//! A = sum_ij d_i d_j T' R[i:i+N, j:j+N] T     b = sum_ij d_i d_j T' r[i:i+N, j]     c = d' Y d
//! ```
//!
//! and the residuals v of a solution h = Tθ, c have the moments E\[i,j\] that the noise model needs.
//! Two forms of the same information are kept apart:
//!
//! * **moments** (the fast path): inner products of the rows, solved by an equilibrated Cholesky
//!   factorisation. Its error grows with the condition number of A.
//! * **factor** (the fallback): the triangular factor of the rows themselves by blocked QR. Its
//!   error grows with the square root of that, at the price of a slower pass over the data.

mod coordinates;
mod normal_equations;
mod residual_moments;

pub use coordinates::Coordinates;
pub(crate) use normal_equations::{
    NormalEquations, filtered_input_moments, least_squares_left, solve_moments, with_one,
};

use std::cell::RefCell;
use std::sync::Arc;

use faer::Mat;

use crate::data::moments::Moments;
use crate::estimation::lag_products::LagProducts;
use crate::numerics::linear_algebra::{backward_solve, inverse_of_lower};
use normal_equations::{Factored, centred_condition};

/// Which arithmetic an estimate went through.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Path {
    /// Normal equations from lagged moments.
    Moments,
    /// Triangular factor of the rows.
    Qr,
}

/// The rows of a record in compressed form.
#[derive(Clone)]
pub struct Information {
    /// Inner products.
    pub moments: Moments,
    /// Triangular factor of Z = [u lags | 1 | y lags], when the moments are not accurate enough.
    factor: Option<Mat<f64>>,
    /// Those of the bank that was solved for last.
    lag_products: RefCell<Option<Arc<LagProducts>>>,
}

/// A least-squares solution.
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
    #[must_use]
    pub fn offset(&self) -> f64 {
        self.coordinates[self.coordinates.len() - 1]
    }

    /// The coordinates of the response.
    #[must_use]
    pub fn response(&self) -> &[f64] {
        &self.coordinates[..self.coordinates.len() - 1]
    }
}

impl Information {
    /// The fast form.
    #[must_use]
    pub fn from_moments(moments: Moments) -> Self {
        Self {
            moments,
            factor: None,
            lag_products: RefCell::default(),
        }
    }

    /// The accurate form: `factor` is upper triangular with factor'factor = Z'Z, its columns in
    /// the order of `template`'s lags (see [`crate::estimation::qr`]).
    #[must_use]
    pub fn from_factor(template: &Moments, factor: Mat<f64>) -> Self {
        let moments = Moments::from_products(template, &(factor.transpose() * &factor));
        Self {
            moments,
            factor: Some(factor),
            lag_products: RefCell::default(),
        }
    }

    /// Which form it is.
    #[must_use]
    pub fn path(&self) -> Path {
        if self.factor.is_some() {
            Path::Qr
        } else {
            Path::Moments
        }
    }

    /// Rows behind the information.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.moments.rows()
    }

    /// Least squares with the noise filter 1 + ar_1 z^-1 + ...; `None` when the rows do not
    /// determine the parameters.
    #[must_use]
    pub fn solve(&self, coordinates: &Coordinates, ar: &[f64]) -> Option<Solution> {
        match &self.factor {
            None => solve_moments(&self.equations(coordinates, ar)),
            Some(factor) => solve_factor(factor, &self.moments, coordinates, ar),
        }
    }

    /// The coordinates and offset of [`Information::solve`] alone, without their covariance.
    #[must_use]
    pub(crate) fn solve_coordinates(
        &self,
        coordinates: &Coordinates,
        ar: &[f64],
    ) -> Option<Vec<f64>> {
        if self.factor.is_some() {
            return self
                .solve(coordinates, ar)
                .map(|solution| solution.coordinates);
        }
        let equations = self.equations(coordinates, ar);
        Factored::new(&equations).map(|factored| factored.refined(&equations))
    }

    fn equations(&self, coordinates: &Coordinates, ar: &[f64]) -> NormalEquations {
        match self.lag_products(coordinates) {
            Some(products) => {
                let square = products.twice_filtered(&with_one(ar));
                NormalEquations::with_square(&self.moments, coordinates, ar, square)
            }
            None => NormalEquations::new(&self.moments, coordinates, ar),
        }
    }

    /// The cross moments of the bank's filters, kept for the next noise filter; `None` for a
    /// complete bank, whose coordinates are its impulse response, and for one that is too large.
    pub(crate) fn lag_products(&self, coordinates: &Coordinates) -> Option<Arc<LagProducts>> {
        let map = coordinates.map.as_ref()?;
        let mut kept = self.lag_products.borrow_mut();
        let known = kept.take().filter(|known| known.are_of(&coordinates.basis));
        *kept = known.or_else(|| LagProducts::new(&self.moments, coordinates.basis, map));
        kept.clone()
    }
}

fn solve_factor(
    factor: &Mat<f64>,
    moments: &Moments,
    coordinates: &Coordinates,
    ar: &[f64],
) -> Option<Solution> {
    let (lags, n, p) = (
        moments.input_lags(),
        coordinates.basis.settling(),
        coordinates.len(),
    );
    let d = with_one(ar);
    let mut impulse = Mat::zeros(lags, n);
    for a in 0..n {
        for (i, di) in d.iter().enumerate() {
            impulse[(a + i, a)] = *di;
        }
    }
    let filtered = match &coordinates.map {
        Some(map) => impulse * map,
        None => impulse,
    };
    // Columns: the filtered regressor, the filtered offset, the filtered output.
    let gain: f64 = d.iter().sum();
    let combination = Mat::from_fn(factor.ncols(), p + 2, |row, k| match (row, k) {
        (row, k) if row < lags && k < p => filtered[(row, k)],
        (row, k) if row == lags && k == p => gain,
        (row, k) if row > lags && k == p + 1 => d.get(row - lags - 1).copied().unwrap_or(0.0),
        _ => 0.0,
    });
    let qr = (factor * combination).qr();
    let r = qr.thin_R().to_owned();
    let triangle = r.as_ref().submatrix(0, 0, p + 1, p + 1).to_owned();
    if (0..=p).any(|k| {
        let norm = triangle.col(k).norm_l2();
        // A column that is a combination of the earlier ones to nine digits carries rounding only.
        norm.is_nan() || triangle[(k, k)].abs() <= 1e-10 * norm
    }) {
        return None;
    }
    let lower = triangle.transpose().to_owned();
    let right: Vec<f64> = (0..=p).map(|k| r[(k, p + 1)]).collect();
    let x = backward_solve(&lower, &right);
    let inverse_lower = inverse_of_lower(&lower);
    let inverse = inverse_lower.transpose() * &inverse_lower;
    let a = triangle.transpose() * &triangle;
    let condition = centred_condition(&a, &inverse);
    let rss = if r.nrows() > p + 1 {
        r[(p + 1, p + 1)].powi(2)
    } else {
        0.0
    };
    Some(Solution {
        coordinates: x,
        rss,
        inverse,
        condition,
    })
}
