//! The slow, obvious estimator that the fast one is tested against.
//!
//! Every row of the regression is written out, least squares goes through QR on those rows, and D
//! is fitted to the residuals sample by sample. Time and memory grow with rows times parameters
//! squared. The results are those of the generalised least squares of moments without its correction for the
//! fitted parameters.

use faer::Mat;
use faer::linalg::solvers::{DenseSolveCore, SolveLstsqCore};

use crate::data::{Record, Run};
use crate::estimation::FsfBasis;

/// A fit by explicit rows.
pub struct DirectFit {
    /// θ.
    pub theta: Vec<f64>,
    /// c.
    pub offset: f64,
    /// d_1..d_d.
    pub ar: Vec<f64>,
    /// Covariance of θ and offset, (n+1) x (n+1).
    pub covariance: Mat<f64>,
    /// RSS / (rows - n - 1 - d).
    pub variance: f64,
    /// Rows used.
    pub rows: usize,
}

/// One stretch of complete rows, the first `order` of which only serve as history of D.
struct Stretch {
    regressor: Mat<f64>,
    output: Vec<f64>,
}

/// Fits a bank and a noise model of fixed order by alternating least squares on explicit rows.
pub fn fit(record: &Record, basis: FsfBasis, order: usize, passes: usize) -> DirectFit {
    let stretches = explicit_rows(record, basis, order);
    let mut ar = vec![0.0; order];
    for _ in 0..passes {
        let (x, _) = least_squares(&stretches, &ar);
        ar = fit_noise(&stretches, &x, order);
    }
    let (x, filtered) = least_squares(&stretches, &ar);
    let rows = filtered.0.nrows();
    let p = basis.frequencies() + 1;
    let rss: f64 = (0..rows)
        .map(|i| {
            let fitted: f64 = (0..p).map(|j| filtered.0[(i, j)] * x[j]).sum();
            (filtered.1[i] - fitted).powi(2)
        })
        .sum();
    let variance = rss / (rows - p - order) as f64;
    let triangle = filtered.0.qr().thin_R().to_owned();
    let inverse = triangle.partial_piv_lu().inverse();
    DirectFit {
        theta: x[..p - 1].to_vec(),
        offset: x[p - 1],
        ar,
        covariance: faer::Scale(variance) * (&inverse * inverse.transpose()),
        variance,
        rows,
    }
}

fn explicit_rows(record: &Record, basis: FsfBasis, order: usize) -> Vec<Stretch> {
    let n = basis.settling();
    let map = basis.impulse_map();
    let mut stretches = Vec::new();
    for run in record.runs() {
        for span in run.complete_rows(n + order, order + 1) {
            let first = span.start - order;
            let rows = span.end - first;
            let lags = Mat::from_fn(rows, n, |i, a| input_at(run, first + i, a));
            let filters = lags * &map;
            let p = basis.frequencies();
            stretches.push(Stretch {
                regressor: Mat::from_fn(
                    rows,
                    p + 1,
                    |i, j| {
                        if j < p { filters[(i, j)] } else { 1.0 }
                    },
                ),
                output: run.output()[first..span.end].to_vec(),
            });
        }
    }
    stretches
}

/// The input `lag` samples before sample `k`, which may lie before the run.
fn input_at(run: &Run, k: usize, lag: usize) -> f64 {
    match k.checked_sub(lag) {
        Some(k) => run.input()[k],
        None => run.input_at_rest().unwrap_or(f64::NAN),
    }
}

fn least_squares(stretches: &[Stretch], ar: &[f64]) -> (Vec<f64>, (Mat<f64>, Vec<f64>)) {
    let order = ar.len();
    let p = stretches[0].regressor.ncols();
    let rows: usize = stretches
        .iter()
        .map(|stretch| stretch.output.len() - order)
        .sum();
    let mut regressor = Mat::zeros(rows, p);
    let mut output = Vec::with_capacity(rows);
    for stretch in stretches {
        for k in order..stretch.output.len() {
            let filtered = |value: &dyn Fn(usize) -> f64| {
                value(k) + (1..=order).map(|i| ar[i - 1] * value(k - i)).sum::<f64>()
            };
            for j in 0..p {
                regressor[(output.len(), j)] = filtered(&|k| stretch.regressor[(k, j)]);
            }
            output.push(filtered(&|k| stretch.output[k]));
        }
    }
    let x = solve_by_qr(&regressor, &output);
    (x, (regressor, output))
}

fn fit_noise(stretches: &[Stretch], x: &[f64], order: usize) -> Vec<f64> {
    if order == 0 {
        return Vec::new();
    }
    let mut past = Vec::new();
    let mut now = Vec::new();
    for stretch in stretches {
        let error: Vec<f64> = (0..stretch.output.len())
            .map(|k| {
                let fitted: f64 = (0..x.len()).map(|j| stretch.regressor[(k, j)] * x[j]).sum();
                stretch.output[k] - fitted
            })
            .collect();
        for k in order..error.len() {
            past.push((1..=order).map(|i| -error[k - i]).collect::<Vec<_>>());
            now.push(error[k]);
        }
    }
    let past = Mat::from_fn(past.len(), order, |i, j| past[i][j]);
    solve_by_qr(&past, &now)
}

fn solve_by_qr(matrix: &Mat<f64>, right: &[f64]) -> Vec<f64> {
    let mut solution = Mat::from_fn(right.len(), 1, |i, _| right[i]);
    matrix
        .qr()
        .solve_lstsq_in_place_with_conj(faer::Conj::No, solution.as_mut());
    solution.col_as_slice(0)[..matrix.ncols()].to_vec()
}
