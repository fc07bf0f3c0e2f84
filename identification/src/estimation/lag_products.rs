//! Cross moments of a bank's filters at different lags.
//!
//! The normal equations for a noise filter D are combinations of
//!
//! ```text
//! P_ij = T' R[i:i+N, j:j+N] T,      i, j = 0..=d
//! ```
//!
//! Only P_00 is a product of large matrices. The columns of T are sines and cosines of whole periods
//! over N samples. With S_l = sum_b x(b) e^{-jlΩb}, a sequence x shifted by one sample therefore has
//!
//! ```text
//! S_l' = e^{jlΩ} (S_l + x(N) - x(0))
//! ```
//!
//! and every further P_ij follows from its neighbour by a rotation. Least squares for another D then only
//! adds small matrices.

use std::sync::Arc;

use faer::Mat;

use crate::data::Moments;
use crate::estimation::fsf_basis::FsfBasis;
use crate::numerics::dot;

/// Largest number of entries of all products together: 32 MB.
const MOST_ENTRIES: usize = 1 << 22;

/// P_ij for one bank, i, j = 0..=order.
pub(crate) struct LagProducts {
    basis: FsfBasis,
    /// Column by column: P_00, P_10, ...
    products: Vec<Mat<f64>>,
    order: usize,
}

impl LagProducts {
    /// For the bank with the impulse map `map`, up to the order that the moments have lags for. `None`
    /// when they would need too much memory.
    pub(crate) fn new(moments: &Moments, basis: FsfBasis, map: &Mat<f64>) -> Option<Arc<Self>> {
        let (n, settling) = (basis.frequencies(), basis.settling());
        let order = (moments.input_lags() - settling).min(moments.output_lags() - 1);
        if ((order + 1) * n).pow(2) > MOST_ENTRIES {
            return None;
        }
        let shift = LagShift::new(basis);
        let lags = settling + order;
        let uu = moments.uu.as_ref().submatrix(0, 0, lags, lags);
        // Columns of R at lag j through the filters: lags x n.
        let mut against = uu.submatrix(0, 0, lags, settling) * map;
        let mut products: Vec<Mat<f64>> = Vec::with_capacity((order + 1).pow(2));
        for j in 0..=order {
            let mut product = match j {
                0 => map.transpose() * against.as_ref().submatrix(0, 0, settling, n),
                j => products[j].transpose().to_owned(),
            };
            for i in 0..=order {
                products.push(product.clone());
                if i < order {
                    for k in 0..n {
                        let filter = against.col_as_slice(k);
                        shift.column(
                            product.col_as_slice_mut(k),
                            filter[i + settling] - filter[i],
                        );
                    }
                }
            }
            if j < order {
                let (leaving, entering) = (uu.col(j), uu.col(j + settling));
                shift.rows(&mut against, &(entering - leaving));
            }
        }
        Some(Arc::new(Self {
            basis,
            products,
            order,
        }))
    }

    /// Whether these are the products of a bank.
    pub(crate) fn are_of(&self, basis: &FsfBasis) -> bool {
        self.basis == *basis
    }

    /// P_ij.
    pub(crate) fn at(&self, i: usize, j: usize) -> &Mat<f64> {
        &self.products[j * (self.order + 1) + i]
    }

    /// sum_j d_j P_ij: n x n.
    pub(crate) fn filtered(&self, i: usize, d: &[f64]) -> Mat<f64> {
        self.combined(d.iter().enumerate().map(|(j, d)| (*d, self.at(i, j))))
    }

    /// sum_ij d_i d_j P_ij: n x n.
    pub(crate) fn twice_filtered(&self, d: &[f64]) -> Mat<f64> {
        let orders = 0..d.len();
        let pairs = orders
            .clone()
            .flat_map(|j| orders.clone().map(move |i| (i, j)));
        self.combined(pairs.map(|(i, j)| (d[i] * d[j], self.at(i, j))))
    }

    fn combined<'a>(&self, terms: impl Iterator<Item = (f64, &'a Mat<f64>)>) -> Mat<f64> {
        let n = self.basis.frequencies();
        let mut sum = Mat::<f64>::zeros(n, n);
        for (factor, product) in terms {
            for k in 0..n {
                let column = sum.col_as_slice_mut(k).iter_mut();
                for (sum, product) in column.zip(product.col_as_slice(k)) {
                    *sum += factor * product;
                }
            }
        }
        sum
    }

    /// x' P_ij x.
    pub(crate) fn quadratic(&self, i: usize, j: usize, x: &[f64]) -> f64 {
        let product = self.at(i, j);
        x.iter()
            .enumerate()
            .map(|(k, xk)| xk * dot(x, product.col_as_slice(k)))
            .sum()
    }
}

/// Shifts a sequence by one sample, in its parameters.
struct LagShift {
    settling: f64,
    /// cos lΩ and sin lΩ, l = 1, 2, ...
    angles: Vec<(f64, f64)>,
}

impl LagShift {
    fn new(basis: FsfBasis) -> Self {
        let angle = |l: usize| {
            let (sin, cos) = (l as f64 * basis.fundamental()).sin_cos();
            (cos, sin)
        };
        Self {
            settling: basis.settling() as f64,
            angles: (1..=basis.highest()).map(angle).collect(),
        }
    }

    /// `parameters` T'x of x(0..N) become those of x(1..=N). `change` is x(N) - x(0).
    fn column(&self, parameters: &mut [f64], change: f64) {
        let change = change / self.settling;
        let Some((gain, pairs)) = parameters.split_first_mut() else {
            return;
        };
        *gain += change;
        for (pair, (cos, sin)) in pairs.chunks_exact_mut(2).zip(&self.angles) {
            let (re, im) = (pair[0] + 2.0 * change, pair[1]);
            pair[0] = cos * re - sin * im;
            pair[1] = sin * re + cos * im;
        }
    }

    /// The same for each row of a matrix.
    fn rows(&self, parameters: &mut Mat<f64>, change: &faer::Col<f64>) {
        let scale = 1.0 / self.settling;
        for row in 0..parameters.nrows() {
            parameters[(row, 0)] += scale * change[row];
        }
        for (l, (cos, sin)) in self.angles.iter().enumerate() {
            for row in 0..parameters.nrows() {
                let re = parameters[(row, 2 * l + 1)] + 2.0 * scale * change[row];
                let im = parameters[(row, 2 * l + 2)];
                parameters[(row, 2 * l + 1)] = cos * re - sin * im;
                parameters[(row, 2 * l + 2)] = sin * re + cos * im;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::Record;
    use crate::estimation::least_squares::{Coordinates, NormalEquations};
    use crate::estimation::noise_model::noise_filter;
    use approx::assert_relative_eq;

    #[test]
    fn equations_from_turned_products_are_those_from_whole_matrices() {
        let input: Vec<f64> = (0..900).map(|k| f64::from(k * k / 700 % 3)).collect();
        let output: Vec<f64> = input.iter().map(|u| 0.3 * u).collect();
        let record = Record::of_run(0.002, &input, &output).unwrap();
        let moments = Moments::of_record(&record, 44, 5);
        for (settling, frequencies) in [(40, 15), (40, 39), (39, 1)] {
            let basis = FsfBasis::new(settling, frequencies).unwrap();
            let coordinates = Coordinates::in_theta(basis);
            let products = LagProducts::new(&moments, basis, &basis.impulse_map()).unwrap();
            for ar in [vec![], vec![-0.9], vec![-1.5, 0.7, 0.1, -0.05]] {
                let d = noise_filter(&ar);
                let turned = products.twice_filtered(&d);
                let whole = NormalEquations::new(&moments, &coordinates, &ar).a;
                for i in 0..frequencies {
                    for j in 0..frequencies {
                        // Sums of a thousand products, averaged over the settling time.
                        assert_relative_eq!(
                            turned[(i, j)],
                            whole[(i, j)],
                            epsilon = 1e-13 * moments.uu[(0, 0)]
                        );
                    }
                }
            }
        }
    }
}
