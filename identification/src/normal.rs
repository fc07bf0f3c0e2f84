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

pub use coordinates::Coordinates;

use std::cell::RefCell;
use std::sync::Arc;

use faer::Mat;

use crate::basis::dot;
use crate::lag_products::LagProducts;
use crate::linear::{backward_solve, cholesky, condition, forward_solve, inverse_of_lower, times};
use crate::moments::Moments;

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
    /// the order of `template`'s lags (see [`crate::factor`]).
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

    /// E\[i,j\] = sum v(k-i) v(k-j), i, j = 0..=order, for v = y - h*u - offset (all relative to
    /// the centre).
    #[must_use]
    pub fn residual_moments(&self, impulse: &[f64], offset: f64, order: usize) -> Mat<f64> {
        match &self.factor {
            None => {
                let modelled = modelled_moments(&self.moments, impulse, order);
                residual_moments(&self.moments, impulse, offset, &modelled)
            }
            Some(factor) => {
                let (lags, n) = (self.moments.input_lags(), impulse.len());
                let combination = Mat::from_fn(factor.ncols(), order + 1, |row, i| match row {
                    row if row < lags && (i..i + n).contains(&row) => -impulse[row - i],
                    row if row == lags => -offset,
                    row if row == lags + 1 + i => 1.0,
                    _ => 0.0,
                });
                let residuals = factor * combination;
                residuals.transpose() * &residuals
            }
        }
    }
}

impl Information {
    /// [`Information::residual_moments`] of a response in `coordinates`, whose cross moments may be known.
    pub(crate) fn residual_moments_of(
        &self,
        coordinates: &Coordinates,
        response: &[f64],
        offset: f64,
        order: usize,
    ) -> Mat<f64> {
        let impulse = coordinates.impulse(response);
        match self.lag_products(coordinates) {
            Some(products) if self.factor.is_none() => {
                let size = order + 1;
                let modelled = Mat::from_fn(size, size, |i, j| products.quadratic(i, j, response));
                residual_moments(&self.moments, &impulse, offset, &modelled)
            }
            _ => self.residual_moments(&impulse, offset, order),
        }
    }
}

/// 1, d_1, ..., d_d.
pub(crate) fn with_one(ar: &[f64]) -> Vec<f64> {
    std::iter::once(1.0).chain(ar.iter().copied()).collect()
}

/// D-filtered normal equations A x = b with the offset as last parameter.
pub(crate) struct NormalEquations {
    pub(crate) a: Mat<f64>,
    pub(crate) b: Vec<f64>,
    /// Sum of squares of the filtered output.
    pub(crate) c: f64,
}

impl NormalEquations {
    pub(crate) fn new(moments: &Moments, coordinates: &Coordinates, ar: &[f64]) -> Self {
        let uu = filtered_input_moments(&moments.uu, coordinates.basis.settling(), &with_one(ar));
        let square = coordinates.square(uu.as_ref());
        Self::with_square(moments, coordinates, ar, square)
    }

    /// With the coordinates' part of A known.
    pub(crate) fn with_square(
        moments: &Moments,
        coordinates: &Coordinates,
        ar: &[f64],
        square: Mat<f64>,
    ) -> Self {
        let n = coordinates.basis.settling();
        let d = with_one(ar);
        let gain: f64 = d.iter().sum();
        // Columns: cross moments with the filtered output, and with the filtered offset.
        let mut edge = Mat::<f64>::zeros(n, 2);
        for (i, di) in d.iter().enumerate() {
            for (j, dj) in d.iter().enumerate() {
                let output = &moments.uy.col_as_slice(j)[i..];
                for (sum, uy) in edge.col_as_slice_mut(0).iter_mut().zip(output) {
                    *sum += di * dj * uy;
                }
            }
            for (sum, u) in edge.col_as_slice_mut(1).iter_mut().zip(&moments.u[i..]) {
                *sum += di * gain * u;
            }
        }
        let edge = coordinates.compress(edge);
        let p = coordinates.len();
        let mut a = Mat::zeros(p + 1, p + 1);
        a.as_mut().submatrix_mut(0, 0, p, p).copy_from(&square);
        for k in 0..p {
            a[(k, p)] = edge[(k, 1)];
            a[(p, k)] = edge[(k, 1)];
        }
        a[(p, p)] = gain * gain * moments.rows as f64;
        let mut b: Vec<f64> = (0..p).map(|k| edge[(k, 0)]).collect();
        b.push(gain * dot(&d, &moments.y));
        let c = d
            .iter()
            .enumerate()
            .map(|(i, di)| {
                di * d
                    .iter()
                    .enumerate()
                    .map(|(j, dj)| dj * moments.yy[(i, j)])
                    .sum::<f64>()
            })
            .sum();
        Self { a, b, c }
    }

    /// A with its diagonal scaled to one, and the scale.
    pub(crate) fn equilibrated(&self) -> (Mat<f64>, Vec<f64>) {
        let p = self.b.len();
        let scale: Vec<f64> = (0..p).map(|k| self.a[(k, k)].sqrt().recip()).collect();
        (
            Mat::from_fn(p, p, |i, j| self.a[(i, j)] * scale[i] * scale[j]),
            scale,
        )
    }
}

/// Sum of squares that no response of `settling` samples can go below, from the rows behind `moments`; `None`
/// where they do not determine it.
pub(crate) fn least_squares_left(moments: &Moments, settling: usize) -> Option<f64> {
    let n = settling;
    let a = Mat::from_fn(n + 1, n + 1, |i, j| match (i, j) {
        (i, j) if i < n && j < n => moments.uu[(i, j)],
        (k, other) | (other, k) if k < n && other == n => moments.u[k],
        _ => moments.rows as f64,
    });
    let mut b = moments.uy.col_as_slice(0)[..n].to_vec();
    b.push(moments.y[0]);
    let equations = NormalEquations {
        a,
        b,
        c: moments.yy[(0, 0)],
    };
    let (scaled, scale) = equations.equilibrated();
    let right: Vec<f64> = equations.b.iter().zip(&scale).map(|(b, s)| b * s).collect();
    let projected = forward_solve(&cholesky(&scaled)?, &right);
    Some(equations.c - dot(&projected, &projected))
}

/// sum_ij d_i d_j R[i:i+N, j:j+N].
pub(crate) fn filtered_input_moments(uu: &Mat<f64>, n: usize, d: &[f64]) -> Mat<f64> {
    let mut once = Mat::<f64>::zeros(n, n + d.len() - 1);
    for b in 0..once.ncols() {
        let source = uu.col_as_slice(b);
        let target = once.col_as_slice_mut(b);
        for (i, di) in d.iter().enumerate() {
            for (target, source) in target.iter_mut().zip(&source[i..]) {
                *target += di * source;
            }
        }
    }
    let mut twice = Mat::<f64>::zeros(n, n);
    for b in 0..n {
        for (j, dj) in d.iter().enumerate() {
            let source = once.col_as_slice(b + j);
            for (target, source) in twice.col_as_slice_mut(b).iter_mut().zip(source) {
                *target += dj * source;
            }
        }
    }
    twice
}

/// Cholesky factor of equilibrated normal equations.
struct Factored {
    lower: Mat<f64>,
    scale: Vec<f64>,
}

impl Factored {
    fn new(equations: &NormalEquations) -> Option<Self> {
        let (scaled, scale) = equations.equilibrated();
        cholesky(&scaled).map(|lower| Self { lower, scale })
    }

    fn solve(&self, b: &[f64]) -> Vec<f64> {
        let b: Vec<f64> = b.iter().zip(&self.scale).map(|(b, s)| b * s).collect();
        let x = backward_solve(&self.lower, &forward_solve(&self.lower, &b));
        x.iter().zip(&self.scale).map(|(x, s)| x * s).collect()
    }

    /// A^-1 b with one step of refinement.
    fn refined(&self, equations: &NormalEquations) -> Vec<f64> {
        let mut x = self.solve(&equations.b);
        let product = times(&equations.a, &x);
        let left: Vec<f64> = equations
            .b
            .iter()
            .zip(&product)
            .map(|(b, ax)| b - ax)
            .collect();
        for (x, correction) in x.iter_mut().zip(self.solve(&left)) {
            *x += correction;
        }
        x
    }

    fn inverse(&self) -> Mat<f64> {
        let inverse_lower = inverse_of_lower(&self.lower);
        let mut inverse = inverse_lower.transpose() * &inverse_lower;
        for j in 0..self.scale.len() {
            for i in 0..self.scale.len() {
                inverse[(i, j)] *= self.scale[i] * self.scale[j];
            }
        }
        inverse
    }
}

pub(crate) fn solve_moments(equations: &NormalEquations) -> Option<Solution> {
    let factored = Factored::new(equations)?;
    let x = factored.refined(equations);
    // c - 2 b'x + x'A x: the error of x enters only in second order.
    let rss = equations.c - 2.0 * dot(&equations.b, &x) + dot(&x, &times(&equations.a, &x));
    let inverse = factored.inverse();
    let condition = centred_condition(&equations.a, &inverse);
    Some(Solution {
        coordinates: x,
        rss: rss.max(0.0),
        inverse,
        condition,
    })
}

/// Condition number of the coordinates' part of A after projecting the offset (last) out.
fn centred_condition(a: &Mat<f64>, inverse: &Mat<f64>) -> f64 {
    let p = a.nrows() - 1;
    let centred = Mat::from_fn(p, p, |i, j| a[(i, j)] - a[(i, p)] * a[(p, j)] / a[(p, p)]);
    let block = inverse.as_ref().submatrix(0, 0, p, p).to_owned();
    condition(&centred, &block)
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

/// sum of s(k-i) s(k-j), i, j = 0..=order, for the modelled output s = h*u.
fn modelled_moments(moments: &Moments, impulse: &[f64], order: usize) -> Mat<f64> {
    let n = impulse.len();
    // The modelled output of lag i against input lag b.
    let response = Mat::from_fn(n + order, order + 1, |b, i| {
        dot(impulse, &moments.uu.col_as_slice(b)[i..i + n])
    });
    Mat::from_fn(order + 1, order + 1, |i, j| {
        dot(impulse, &response.col_as_slice(i)[j..j + n])
    })
}

/// Moments of the residuals from those of the modelled output.
fn residual_moments(
    moments: &Moments,
    impulse: &[f64],
    offset: f64,
    modelled: &Mat<f64>,
) -> Mat<f64> {
    let n = impulse.len();
    let shifted = |values: &[f64], i: usize| dot(impulse, &values[i..i + n]);
    let output = |i: usize, j: usize| shifted(moments.uy.col_as_slice(j), i);
    let sum = |i: usize| moments.y[i] - shifted(&moments.u, i);
    let rows = moments.rows as f64;
    let mut e = Mat::zeros(modelled.nrows(), modelled.ncols());
    for i in 0..e.nrows() {
        for j in 0..=i {
            let value = moments.yy[(i, j)] - output(i, j) - output(j, i) + modelled[(i, j)]
                - offset * (sum(i) + sum(j))
                + rows * offset * offset;
            e[(i, j)] = value;
            e[(j, i)] = value;
        }
    }
    e
}
