//! The moments: adding and removing rows, fewer lags.

use faer::Mat;
use serde::{Deserialize, Serialize};

use crate::data::record::Run;
use crate::numerics::add_outer_product;

/// Lagged moments of the complete rows of a record.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Moments {
    pub(super) sample_period_s: f64,
    #[serde(default)]
    pub(super) sample_phase_s: f64,
    /// Values are relative to this input and output.
    pub(crate) centre: (f64, f64),
    pub(crate) rows: usize,
    pub(super) samples: usize,
    pub(super) missing: usize,
    #[serde(with = "crate::numerics::matrix_rows")]
    pub(crate) uu: Mat<f64>,
    #[serde(with = "crate::numerics::matrix_rows")]
    pub(crate) uy: Mat<f64>,
    #[serde(with = "crate::numerics::matrix_rows")]
    pub(crate) yy: Mat<f64>,
    pub(crate) u: Vec<f64>,
    pub(crate) y: Vec<f64>,
}

impl Moments {
    /// L: lags of the input.
    pub fn input_lags(&self) -> usize {
        self.uu.nrows()
    }

    /// J: lags of the output, the present sample included.
    pub fn output_lags(&self) -> usize {
        self.yy.nrows()
    }

    /// Number of complete rows.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Samples seen, missing ones included.
    pub fn samples(&self) -> usize {
        self.samples
    }

    /// Samples that lacked the input or the output.
    pub fn missing(&self) -> usize {
        self.missing
    }

    /// Time between samples \[s\].
    pub fn sample_period_s(&self) -> f64 {
        self.sample_period_s
    }

    /// Time from an edge of the input to the first sample that counts as after it \[s\].
    pub fn sample_phase_s(&self) -> f64 {
        self.sample_phase_s
    }

    /// Sum of squares of the output about its mean.
    pub fn output_spread(&self) -> f64 {
        (self.yy[(0, 0)] - self.y[0] * self.y[0] / self.rows.max(1) as f64).max(0.0)
    }

    /// Adds one row.
    pub(super) fn add_row(&mut self, run: &Run, k: usize) {
        let inputs: Vec<f64> = (0..self.input_lags())
            .map(|a| run.input_at(k as isize - a as isize) - self.centre.0)
            .collect();
        let outputs: Vec<f64> = (0..self.output_lags())
            .map(|j| run.output()[k - j] - self.centre.1)
            .collect();
        add_outer_product(&mut self.uu, &inputs, &inputs, 1.0);
        add_outer_product(&mut self.uy, &inputs, &outputs, 1.0);
        add_outer_product(&mut self.yy, &outputs, &outputs, 1.0);
        let sums = self
            .u
            .iter_mut()
            .zip(&inputs)
            .chain(self.y.iter_mut().zip(&outputs));
        sums.for_each(|(sum, value)| *sum += value);
        self.rows += 1;
    }

    /// Adds the rows of `part`, which has the same lags and centre.
    pub(crate) fn add(&mut self, part: &Self) {
        debug_assert_eq!(self.centre, part.centre);
        self.accumulate(part, 1.0);
    }

    /// Removes the rows of `part`, which has the same lags and centre.
    pub(crate) fn without(&self, part: &Self) -> Self {
        debug_assert_eq!(self.centre, part.centre);
        let mut rest = self.clone();
        rest.accumulate(part, -1.0);
        rest
    }

    fn accumulate(&mut self, other: &Self, sign: f64) {
        self.uu += faer::Scale(sign) * &other.uu;
        self.uy += faer::Scale(sign) * &other.uy;
        self.yy += faer::Scale(sign) * &other.yy;
        for (sum, value) in self
            .u
            .iter_mut()
            .zip(&other.u)
            .chain(self.y.iter_mut().zip(&other.y))
        {
            *sum += sign * value;
        }
        let count = |mine: usize, theirs| {
            if sign > 0.0 {
                mine + theirs
            } else {
                mine - theirs
            }
        };
        self.rows = count(self.rows, other.rows);
        self.samples = count(self.samples, other.samples);
        self.missing = count(self.missing, other.missing);
    }

    /// The moments of fewer lags over the same rows.
    pub(crate) fn truncated(&self, input_lags: usize, output_lags: usize) -> Self {
        let part = |matrix: &Mat<f64>, rows, columns| {
            matrix.as_ref().submatrix(0, 0, rows, columns).to_owned()
        };
        Self {
            uu: part(&self.uu, input_lags, input_lags),
            uy: part(&self.uy, input_lags, output_lags),
            yy: part(&self.yy, output_lags, output_lags),
            u: self.u[..input_lags].to_vec(),
            y: self.y[..output_lags].to_vec(),
            ..*self
        }
    }

    /// The moments in Z'Z, the inner products of the columns of Z = [u(k)..u(k-L+1) | 1 | y(k)..y(k-J+1)].
    pub(crate) fn from_products(template: &Self, products: &Mat<f64>) -> Self {
        let (l, j) = (template.input_lags(), template.output_lags());
        let part = |row, column, rows, columns| {
            products
                .as_ref()
                .submatrix(row, column, rows, columns)
                .to_owned()
        };
        Self {
            uu: part(0, 0, l, l),
            uy: part(0, l + 1, l, j),
            yy: part(l + 1, l + 1, j, j),
            u: (0..l).map(|a| products[(l, a)]).collect(),
            y: (0..j).map(|a| products[(l, l + 1 + a)]).collect(),
            ..*template
        }
    }
}
