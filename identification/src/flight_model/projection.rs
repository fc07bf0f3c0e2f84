//! What the estimator of a model makes of any linear servo.
//!
//! The estimate x = (Z_D'Z_D)^-1 Z_D' D y is linear in the output, and the output of a linear servo is
//! linear in its impulse response h. So is, therefore, what the estimator would have found if that
//! servo had been in the place of the real one, with everything that N too short and n too small do
//! to it:
//!
//! ```text
//! m(h) = P h,   P = (Z_D'Z_D)^-1 Z_D' D U,   U = [u(k), u(k-1), ...]
//! ```
//!
//! Comparing the estimate with m(h), not with h itself, makes truncation cancel exactly.

use faer::{Mat, Side};

use crate::data::moments::Moments;
use crate::data::record::{Record, Run};
use crate::error::Error;
use crate::estimation::fsf_basis::dot;
use crate::estimation::least_squares::{Coordinates, Information, filtered_input_moments};
use crate::numerics::linear_algebra::times;
use crate::results::model::Model;
use crate::results::validity::Bounds;

/// Length of h in settling times: N leaves a margin over the response, and twice N what is slower
/// than the data could show.
pub(crate) const LENGTH: usize = 2;

/// Directions of the covariance of less than this share of the largest are rounding.
const ROUNDING: f64 = 1e-10;

/// An estimate, whitened by its own covariance, and P to match.
pub(crate) struct Projection {
    /// Whitened estimate.
    estimate: Vec<f64>,
    /// Whitened P: rank x length.
    map: Mat<f64>,
    /// From h to step response by way of the estimator, N x length.
    step_map: Mat<f64>,
    /// Step response of the estimate.
    step: Vec<f64>,
    /// Whether the whitening is by the covariance of noise, so that lack of fit can be tested.
    pub(crate) is_tested: bool,
}

impl Projection {
    /// The projection onto the bank and noise filter of `model`, on the rows of `record` that it was
    /// identified from.
    pub(crate) fn new(record: &Record, model: &Model) -> Result<Self, Error> {
        let basis = model.basis()?;
        let ar = &model.noise.ar;
        let (n, order) = (basis.settling(), ar.len());
        let length = LENGTH * n;
        let moments = Moments::of_record(&with_history(record, n)?, length + order, order + 1);
        let refused = Error::NoHistory { history: n };
        let coordinates = Coordinates::new(basis);
        let information = Information::from_moments(moments);
        let solution = information.solve(&coordinates, ar).ok_or(refused.clone())?;
        let moments = &information.moments;
        let p = coordinates.len();
        let degrees = moments.rows as f64 - (p + 1 + order) as f64;
        if degrees < 1.0 {
            return Err(refused);
        }
        let d: Vec<f64> = std::iter::once(1.0).chain(ar.iter().copied()).collect();
        let gain: f64 = d.iter().sum();
        let products = filtered_input_moments(&moments.uu, length, &d);
        let products = products.as_ref().submatrix(0, 0, n, length);
        let products = match coordinates.impulse_map() {
            Some(map) => map.transpose() * products,
            None => products.to_owned(),
        };
        let offset: Vec<f64> = (0..length)
            .map(|b| gain * dot(&d, &moments.u[b..]))
            .collect();
        let right = Mat::from_fn(p + 1, length, |k, b| {
            if k < p { products[(k, b)] } else { offset[b] }
        });
        let full = &solution.inverse * right;
        let projection = full.as_ref().submatrix(0, 0, p, length).to_owned();
        let covariance = faer::Scale(solution.rss / degrees)
            * solution.inverse.as_ref().submatrix(0, 0, p, p).to_owned();
        let whitening = whitening(&covariance).ok_or(refused)?;
        let step = coordinates.step_map();
        Ok(Self {
            estimate: times(&whitening, solution.response()),
            map: &whitening * &projection,
            is_tested: true,
            step: times(&step, solution.response()),
            step_map: step * projection,
        })
    }

    /// The estimate, by the bank of `model`, of a servo that is at rest again after N samples. Its later
    /// motion is gathered in the last of them, as the model's own step response has it.
    pub(crate) fn of_model(model: &Model) -> Result<Self, Error> {
        let basis = model.basis()?;
        let (analysis, last) = (basis.analysis_map(), basis.settling() - 1);
        let projection = Mat::from_fn(analysis.nrows(), LENGTH * basis.settling(), |k, i| {
            analysis[(k, i.min(last))]
        });
        // Without a covariance all deviations count alike, relative to the gain.
        let size = model.theta.len();
        let covariance = match &model.bounds {
            Bounds::Valid(bounds) => bounds.covariance_matrix(),
            Bounds::Withdrawn(_) => {
                faer::Scale(model.theta[0].powi(2)) * Mat::<f64>::identity(size, size)
            }
        };
        let whitening = whitening(&covariance).ok_or(Error::NoResponse)?;
        Ok(Self {
            is_tested: model.bounds.valid().is_some(),
            estimate: times(&whitening, &model.theta),
            map: whitening * &projection,
            step: model.step.value.clone(),
            step_map: basis.step_map() * projection,
        })
    }

    /// Length of impulse responses.
    pub(crate) fn length(&self) -> usize {
        self.map.ncols()
    }

    /// Number of independent directions.
    pub(crate) fn rank(&self) -> usize {
        self.estimate.len()
    }

    /// Differences between the estimate and that of a servo, independent and of unit variance if
    /// that servo is the true one.
    pub(crate) fn residuals(&self, impulse: &[f64]) -> Vec<f64> {
        let projected = times(&self.map, impulse);
        self.estimate
            .iter()
            .zip(projected)
            .map(|(a, b)| a - b)
            .collect()
    }

    /// Largest difference of the step responses, relative to the gain.
    pub(crate) fn largest_error(&self, impulse: &[f64]) -> f64 {
        let projected = times(&self.step_map, impulse);
        let gain = self.step[self.step.len() - 1].abs();
        self.step
            .iter()
            .zip(projected)
            .map(|(a, b)| (a - b).abs() / gain)
            .fold(0.0, f64::max)
    }
}

/// The record with a stated history: responses longer than N feel an input that stood still before
/// the first sample. Rows that had no history of N samples stay out.
pub(crate) fn with_history(record: &Record, settling: usize) -> Result<Record, Error> {
    let runs = record.runs().iter().map(|run| {
        if run.input_at_rest().is_some() {
            return Ok(run.clone());
        }
        let first = run
            .input()
            .iter()
            .copied()
            .find(|u| !u.is_nan())
            .unwrap_or(0.0);
        let mut output = run.output().to_vec();
        let unknown = output.len().min(settling - 1);
        output[..unknown].fill(f64::NAN);
        Ok(Run::new(run.input(), output)?.with_input_at_rest(first))
    });
    Record::new(
        record.sample_period_s(),
        runs.collect::<Result<_, Error>>()?,
    )
}

/// W with W C W' = 1 over the directions of C that are not rounding.
pub(crate) fn whitening(covariance: &Mat<f64>) -> Option<Mat<f64>> {
    let eigen = covariance.self_adjoint_eigen(Side::Lower).ok()?;
    let size = covariance.nrows();
    let largest = (0..size).map(|i| eigen.S()[i]).fold(0.0, f64::max);
    let kept: Vec<usize> = (0..size)
        .filter(|&i| eigen.S()[i] > ROUNDING * largest)
        .collect();
    (largest > 0.0).then(|| {
        Mat::from_fn(kept.len(), size, |i, k| {
            eigen.U()[(k, kept[i])] / eigen.S()[kept[i]].sqrt()
        })
    })
}
