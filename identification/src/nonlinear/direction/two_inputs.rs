//! Generalised least squares with two inputs: the command, and the magnitude of its changes.
//!
//! Rows are y(k) = φ(k)'θ + ψ(k)'η + c + ε(k)/D(z) with filters φ of u and ψ of w(k) = |u(k) - u(k-1)|. As
//! with one input, the lagged moments of u, w and y suffice. They come from three passes of
//! [`MomentStream`] over the same rows.

use faer::Mat;

use crate::data::{MomentStream, Moments, Record, Run};
use crate::estimation::{Coordinates, FsfBasis, NoiseFit, best_order, lagged_filter, noise_filter};
use crate::numerics::{
    backward_solve, factorised, forward_solve, inverse_of_square, largest_difference, times,
};
use crate::options::{MAX_AUTO_ORDER, NoiseOrder};
use crate::thresholds::SEPARABLE;

/// Largest number of passes.
const PASSES: usize = 30;

/// Passes in which the noise order may change.
const FREE_ORDER_PASSES: usize = 6;

/// Largest change of a coefficient of D at convergence, far below its standard deviation.
const CONVERGED: f64 = 1e-6;

/// Inner products of the rows [u lags | w lags | 1 | y lags].
pub(crate) struct TwoInputMoments {
    products: Mat<f64>,
    lags: usize,
    outputs: usize,
    pub(crate) rows: usize,
    /// Values are relative to these u, w and y.
    pub(crate) centre: (f64, f64, f64),
    /// Sum of squares of the output about its mean.
    pub(crate) output_spread: f64,
}

impl TwoInputMoments {
    /// The moments for `settling` samples of history and noise up to the largest order.
    pub(crate) fn of_record(record: &Record, settling: usize) -> Self {
        let (lags, outputs) = (settling + MAX_AUTO_ORDER, MAX_AUTO_ORDER + 1);
        let stream = |outputs| MomentStream::new(record.sample_period_s(), lags, outputs);
        let (mut inputs, mut first, mut second) = (stream(lags), stream(outputs), stream(outputs));
        for stretch in record
            .runs()
            .iter()
            .flat_map(|run| stretches(run, lags, outputs))
        {
            let Stretch { u, w, y } = stretch;
            for (stream, input, output) in [
                (&mut inputs, &u, &w),
                (&mut first, &u, &y),
                (&mut second, &w, &y),
            ] {
                stream.begin_run(None);
                stream.push(input, output);
            }
        }
        let (inputs, first, second) = (inputs.moments(), first.moments(), second.moments());
        Self {
            products: assemble(&inputs, &first, &second),
            lags,
            outputs,
            rows: first.rows(),
            centre: (first.centre.0, second.centre.0, first.centre.1),
            output_spread: first.output_spread(),
        }
    }
}

impl TwoInputMoments {
    /// Lags of the command and the output that a row has: the oldest change needs one more command.
    pub(crate) fn row_lags(&self) -> (usize, usize) {
        (self.lags + 1, self.outputs)
    }
}

/// A stretch of samples with complete rows, with the history that they need.
struct Stretch {
    u: Vec<f64>,
    w: Vec<f64>,
    y: Vec<f64>,
}

fn stretches(run: &Run, lags: usize, outputs: usize) -> Vec<Stretch> {
    // The oldest w needs one more u.
    let spans = run.complete_rows(lags + 1, outputs);
    let stretch = |span: std::ops::Range<usize>| {
        let times = span.start as isize - (lags as isize - 1)..span.end as isize;
        let oldest = span.start + 1 - outputs;
        // Earlier outputs are not used in any row, so any number serves.
        let output = |k: isize| run.output()[usize::try_from(k).unwrap_or(0).max(oldest)];
        Stretch {
            u: times.clone().map(|k| run.input_at(k)).collect(),
            w: times
                .clone()
                .map(|k| (run.input_at(k) - run.input_at(k - 1)).abs())
                .collect(),
            y: times.map(output).collect(),
        }
    };
    spans.into_iter().map(stretch).collect()
}

fn assemble(inputs: &Moments, first: &Moments, second: &Moments) -> Mat<f64> {
    let (lags, outputs) = (first.input_lags(), first.output_lags());
    let size = 2 * lags + 1 + outputs;
    let mut products = Mat::zeros(size, size);
    let mut put = |row: usize, column: usize, value: f64| {
        products[(row, column)] = value;
        products[(column, row)] = value;
    };
    let (w, one, y) = (lags, 2 * lags, 2 * lags + 1);
    for a in 0..lags {
        for b in 0..lags {
            put(a, b, inputs.uu[(a, b)]);
            put(a, w + b, inputs.uy[(a, b)]);
            put(w + a, w + b, inputs.yy[(a, b)]);
        }
        for j in 0..outputs {
            put(a, y + j, first.uy[(a, j)]);
            put(w + a, y + j, second.uy[(a, j)]);
        }
        put(a, one, inputs.u[a]);
        put(w + a, one, inputs.y[a]);
    }
    for i in 0..outputs {
        for j in 0..outputs {
            put(y + i, y + j, first.yy[(i, j)]);
        }
        put(one, y + i, first.y[i]);
    }
    put(one, one, first.rows() as f64);
    products
}

/// A fit with two inputs.
pub(crate) struct TwoInputFit {
    /// Coordinates of the response to u, parameters of that to w, the offset about the centre.
    pub(crate) parameters: Vec<f64>,
    /// Their covariance.
    pub(crate) covariance: Mat<f64>,
    /// d_1..d_d.
    pub(crate) ar: Vec<f64>,
    /// Variance of ε.
    pub(crate) variance: f64,
    /// rows - parameters - d.
    pub(crate) degrees_of_freedom: f64,
    /// Sum of squares of the simulation error.
    pub(crate) error: f64,
}

/// Fits both responses and the noise; `None` when the rows do not determine them.
pub(crate) fn fit(
    moments: &TwoInputMoments,
    coordinates: &Coordinates,
    second: &FsfBasis,
    order: NoiseOrder,
) -> Option<TwoInputFit> {
    let problem = Problem::new(moments, coordinates, second);
    let max_order = order.highest().min(MAX_AUTO_ORDER);
    let mut ar = Vec::new();
    let mut solution = problem.solve(&ar)?;
    for pass in 0..PASSES {
        let errors = problem.residual_moments(&solution.parameters, max_order);
        let Some(noise) = NoiseFit::new(&errors, moments.output_spread) else {
            break; // The fit is exact: there is no noise to model.
        };
        let order = match order {
            NoiseOrder::Order(_) => max_order,
            NoiseOrder::Auto if pass >= FREE_ORDER_PASSES => ar.len(),
            NoiseOrder::Auto => best_order(&noise.candidates(moments.rows)),
        };
        let next = noise.coefficients(order);
        let moved = largest_difference(&ar, &next);
        ar = next;
        solution = problem.solve(&ar)?;
        if moved < CONVERGED {
            break;
        }
    }
    let count = solution.parameters.len();
    let degrees_of_freedom = moments.rows as f64 - (count + ar.len()) as f64;
    if degrees_of_freedom < 1.0 {
        return None;
    }
    let error = problem.residual_moments(&solution.parameters, 0)[(0, 0)];
    let variance = solution.rss / degrees_of_freedom;
    Some(TwoInputFit {
        covariance: faer::Scale(variance) * solution.inverse,
        variance,
        parameters: solution.parameters,
        ar,
        degrees_of_freedom,
        error: error.max(0.0),
    })
}

/// The least-squares problem of one pair of banks.
struct Problem<'a> {
    moments: &'a TwoInputMoments,
    coordinates: &'a Coordinates,
    /// From parameters of the second bank to its impulse response.
    second: Mat<f64>,
}

struct JointSolution {
    parameters: Vec<f64>,
    inverse: Mat<f64>,
    rss: f64,
}

impl<'a> Problem<'a> {
    fn new(moments: &'a TwoInputMoments, coordinates: &'a Coordinates, second: &FsfBasis) -> Self {
        Self {
            moments,
            coordinates,
            second: second.impulse_map(),
        }
    }

    /// Least squares on the rows filtered by 1 + ar_1 z^-1 + ...
    fn solve(&self, ar: &[f64]) -> Option<JointSolution> {
        let combination = self.filtered_columns(ar);
        let gram = combination.transpose() * (&self.moments.products * &combination);
        let p = gram.nrows() - 1;
        let scale: Vec<f64> = (0..p).map(|k| gram[(k, k)].sqrt().recip()).collect();
        if scale.iter().any(|scale| !scale.is_finite()) {
            return None;
        }
        let scaled = Mat::from_fn(p, p, |i, j| gram[(i, j)] * scale[i] * scale[j]);
        let lower = factorised(scaled)?;
        // A column that is a combination of the others to five digits is undetermined.
        if (0..p).any(|k| lower[(k, k)] < SEPARABLE) {
            return None;
        }
        let right: Vec<f64> = (0..p).map(|k| gram[(k, p)] * scale[k]).collect();
        let projected = forward_solve(&lower, &right);
        let solved = backward_solve(&lower, &projected);
        let inverse = inverse_of_square(&lower);
        Some(JointSolution {
            parameters: solved.iter().zip(&scale).map(|(x, s)| x * s).collect(),
            inverse: Mat::from_fn(p, p, |i, j| inverse[(i, j)] * scale[i] * scale[j]),
            rss: (gram[(p, p)] - projected.iter().map(|z| z * z).sum::<f64>()).max(0.0),
        })
    }

    /// From filtered columns (bank of u, bank of w, offset, output) to lags: one column each.
    fn filtered_columns(&self, ar: &[f64]) -> Mat<f64> {
        let lags = self.moments.lags;
        let d = noise_filter(ar);
        let settling = self.coordinates.basis.settling();
        let filter = lagged_filter(lags, settling, &d);
        let second = &filter * &self.second;
        let first = self.coordinates.combine(filter);
        let (n, n2) = (first.ncols(), second.ncols());
        let gain: f64 = d.iter().sum();
        Mat::from_fn(2 * lags + 1 + self.moments.outputs, n + n2 + 2, |row, k| {
            let column = match k {
                k if k < n => return if row < lags { first[(row, k)] } else { 0.0 },
                k if k < n + n2 => {
                    let there = (lags..2 * lags).contains(&row);
                    return if there {
                        second[(row - lags, k - n)]
                    } else {
                        0.0
                    };
                }
                k => k - n - n2,
            };
            match (column, row.checked_sub(2 * lags)) {
                (0, Some(0)) => gain,
                (1, Some(row)) if row >= 1 => d.get(row - 1).copied().unwrap_or(0.0),
                _ => 0.0,
            }
        })
    }

    /// E[i,j] = sum v(k-i) v(k-j) of the residuals v, i, j = 0..=order.
    fn residual_moments(&self, parameters: &[f64], order: usize) -> Mat<f64> {
        let (lags, n) = (self.moments.lags, self.coordinates.len());
        let n2 = self.second.ncols();
        let first = self.coordinates.impulse(&parameters[..n]);
        let second = times(&self.second, &parameters[n..n + n2]);
        let offset = parameters[n + n2];
        let combination = Mat::from_fn(self.moments.products.nrows(), order + 1, |row, i| {
            let lag = |row: usize, response: &[f64]| {
                row.checked_sub(i)
                    .and_then(|a| response.get(a))
                    .map_or(0.0, |h| -h)
            };
            match row {
                row if row < lags => lag(row, &first),
                row if row < 2 * lags => lag(row - lags, &second),
                row if row == 2 * lags => -offset,
                row => f64::from(u8::from(row == 2 * lags + 1 + i)),
            }
        });
        combination.transpose() * (&self.moments.products * &combination)
    }
}
