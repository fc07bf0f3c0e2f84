//! The rows of a record as an information matrix or its triangular factor.

use std::cell::RefCell;
use std::sync::Arc;

use faer::Mat;

use super::coordinates::Coordinates;
use super::normal_equations::{Factored, NormalEquations, solve_moments};
use super::solution::Solution;
use super::triangular::solve_factor;
use crate::data::Moments;
use crate::estimation::lag_products::LagProducts;
use crate::estimation::noise_model::noise_filter;
use crate::numerics::dot;

/// The arithmetic behind an estimate.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Solver {
    /// Normal equations from lagged moments.
    Moments,
    /// Triangular factor of the rows.
    Qr,
}

/// The information of all rows: inner products, or their triangular factor. Its size does not depend on
/// the length of the record.
#[derive(Clone)]
pub struct RowInformation {
    /// Inner products.
    pub moments: Moments,
    /// Triangular factor of Z = [u lags | 1 | y lags], when the moments are not accurate enough.
    pub(super) factor: Option<Mat<f64>>,
    /// What is known of each lag of a complete bank beside the rows: the variance of ε over that of a prior; 0 where nothing is.
    precision: f64,
    /// Those of the bank solved last.
    lag_products: RefCell<Option<Arc<LagProducts>>>,
}

impl RowInformation {
    /// The fast form.
    pub fn from_moments(moments: Moments) -> Self {
        Self {
            moments,
            factor: None,
            precision: 0.0,
            lag_products: RefCell::default(),
        }
    }

    /// Moments, and a prior of every lag of a complete bank: independent, with mean 0, and a variance that is that of ε over `precision`.
    pub(crate) fn under_prior(moments: Moments, precision: f64) -> Self {
        Self {
            precision,
            ..Self::from_moments(moments)
        }
    }

    /// The precision of that prior; 0 where there is none.
    pub(crate) fn precision(&self) -> f64 {
        self.precision
    }

    /// The accurate form: `factor` is upper triangular with factor'factor = Z'Z, its columns in
    /// the order of `template`'s lags (see [`crate::estimation::qr`]).
    pub fn from_factor(template: &Moments, factor: Mat<f64>) -> Self {
        let moments = Moments::from_products(template, &(factor.transpose() * &factor));
        Self {
            moments,
            factor: Some(factor),
            precision: 0.0,
            lag_products: RefCell::default(),
        }
    }

    /// Which form it is.
    pub fn path(&self) -> Solver {
        if self.factor.is_some() {
            Solver::Qr
        } else {
            Solver::Moments
        }
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.moments.rows()
    }

    /// Least squares with the noise filter 1 + ar_1 z^-1 + ...; `None` when the rows do not
    /// determine the parameters.
    pub fn solve(&self, coordinates: &Coordinates, ar: &[f64]) -> Option<Solution> {
        match &self.factor {
            None => {
                let mut found = solve_moments(&self.equations(coordinates, ar))?;
                // The part of the prior is none of the rows.
                let squares = dot(found.response(), found.response());
                found.rss = (found.rss - self.precision * squares).max(0.0);
                Some(found)
            }
            Some(factor) => solve_factor(factor, &self.moments, coordinates, ar),
        }
    }

    /// The coordinates and offset of [`RowInformation::solve`], without their covariance.
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
                let square = products.twice_filtered(&noise_filter(ar));
                NormalEquations::with_square(&self.moments, coordinates, ar, &square)
            }
            None => {
                let mut equations = NormalEquations::new(&self.moments, coordinates, ar);
                for k in 0..coordinates.len() {
                    equations.a[(k, k)] += self.precision;
                }
                equations
            }
        }
    }

    /// The cross moments of the bank's filters, kept for the next noise filter. `None` for a complete bank,
    /// whose coordinates are its impulse response, and for a bank that is too large.
    pub(crate) fn lag_products(&self, coordinates: &Coordinates) -> Option<Arc<LagProducts>> {
        let map = coordinates.map.as_ref()?;
        let mut kept = self.lag_products.borrow_mut();
        let known = kept.take().filter(|known| known.are_of(&coordinates.basis));
        *kept = known.or_else(|| LagProducts::new(&self.moments, coordinates.basis, map));
        kept.clone()
    }
}
