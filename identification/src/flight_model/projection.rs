//! The estimate that the estimator of a model would make of any linear servo.
//!
//! The estimate x = (Z_D'Z_D)^-1 Z_D' D y is linear in the output, and the output of a linear servo is
//! linear in its impulse response h. The estimate of a servo with the response h is therefore linear in
//! h, with every effect of a short N and a small n included:
//!
//! ```text
//! m(h) = P h,   P = (Z_D'Z_D)^-1 Z_D' D U,   U = [u(k), u(k-1), ...]
//! ```
//!
//! The estimate is compared with m(h), not with h, so that truncation cancels exactly.

use faer::Mat;

use super::identified_response::{IdentifiedResponse, IdentifiedStep};
use crate::data::{Moments, Record, Run};
use crate::error::Error;
use crate::estimation::{Coordinates, RowInformation, filtered_input_moments, noise_filter};
use crate::numerics::{dot, not_negative, pointwise_critical, symmetric_eigen, times};
use crate::results::{Bounds, Model, StepBounds};

/// Length of h in settling times. N leaves a margin over the response; a response that is longer than
/// twice N is too slow for the data to show.
pub(crate) const LENGTH: usize = 2;

/// Directions of the covariance of less than this share of the largest are rounding.
const ROUNDING: f64 = 1e-10;

/// An estimate, whitened by its own covariance, and the whitened P.
pub(crate) struct Projection {
    /// Whitened estimate.
    pub(super) estimate: Vec<f64>,
    /// Whitened P: rank x length.
    pub(super) map: Mat<f64>,
    /// What was identified by it.
    pub(super) identified: IdentifiedResponse,
}

impl Projection {
    /// For parameters estimated with `covariance`, of which `projection` is P. The step response of the
    /// estimate is `curve`, `to_curve` maps parameters to it. `None` when the covariance has no
    /// direction above rounding.
    pub(crate) fn new(
        parameters: &[f64],
        covariance: &Mat<f64>,
        projection: &Mat<f64>,
        (curve, to_curve): (Vec<f64>, Mat<f64>),
    ) -> Option<Self> {
        let whitening = whitening(covariance)?;
        let spread = &to_curve * covariance;
        let sd = |m: usize| {
            let products = (0..spread.ncols()).map(|k| spread[(m, k)] * to_curve[(m, k)]);
            not_negative(products.sum()).sqrt()
        };
        let step = IdentifiedStep {
            sd: (0..curve.len()).map(sd).collect(),
            curve,
            map: to_curve * projection,
        };
        Some(Self {
            estimate: times(&whitening, parameters),
            map: whitening * projection,
            identified: IdentifiedResponse::Step(step),
        })
    }

    /// For the bank and noise filter of `model`, on the rows of `record` that it was identified from.
    pub(crate) fn of_record(record: &Record, model: &Model) -> Result<Self, Error> {
        let basis = model.basis()?;
        let ar = &model.noise.ar;
        let (n, order) = (basis.settling(), ar.len());
        let length = LENGTH * n;
        let moments = Moments::of_record(&with_history(record, n)?, length + order, order + 1);
        let refused = Error::NoHistory { history: n };
        let coordinates = Coordinates::new(basis);
        let information = RowInformation::from_moments(moments);
        let solution = information.solve(&coordinates, ar).ok_or(refused.clone())?;
        let moments = &information.moments;
        let p = coordinates.len();
        let degrees = moments.rows as f64 - (p + 1 + order) as f64;
        if degrees < 1.0 {
            return Err(refused);
        }
        let d = noise_filter(ar);
        let gain: f64 = d.iter().sum();
        let products = filtered_input_moments(&moments.uu, length, &d);
        let products = products.as_ref().submatrix(0, 0, n, length).to_owned();
        let products = coordinates.compress(products);
        let right = Mat::from_fn(p + 1, length, |k, b| {
            if k < p {
                products[(k, b)]
            } else {
                gain * dot(&d, &moments.u[b..])
            }
        });
        let full = &solution.inverse * right;
        let projection = full.as_ref().submatrix(0, 0, p, length).to_owned();
        let covariance = faer::Scale(solution.rss / degrees)
            * solution.inverse.as_ref().submatrix(0, 0, p, p).to_owned();
        let step = coordinates.step_map();
        let curve = times(&step, solution.response());
        Self::new(solution.response(), &covariance, &projection, (curve, step)).ok_or(refused)
    }

    /// For a servo whose response is over after N samples, from the bank of `model` alone. The response
    /// after N samples is gathered in the last of them, as in the model's own step response.
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
        let curve = (model.step.value.clone(), basis.step_map());
        Self::new(&model.theta, &covariance, &projection, curve).ok_or(Error::NoResponse)
    }

    /// Length of impulse responses.
    pub(crate) fn length(&self) -> usize {
        self.map.ncols()
    }

    /// Number of independent directions.
    pub(crate) fn rank(&self) -> usize {
        self.estimate.len()
    }

    /// By how much the bounds of the step response of `model` are wider than those of even noise: at its end, where the gain is, and where they are most
    /// during the rise, where the other parameters are. Runs that differ, noise that is not even, commands with errors, steps of the sensor and slow ends are
    /// in those. 1 without bounds; in a band that is in the whitening.
    pub(crate) fn beyond_even_noise(&self, model: &Model) -> [f64; 2] {
        let step = match &self.identified {
            IdentifiedResponse::Step(step) => step,
            IdentifiedResponse::Band(_) => return [1.0; 2],
        };
        let Bounds::Valid(bounds) = &model.step.bounds else {
            return [1.0; 2];
        };
        let critical = pointwise_critical(bounds.level);
        // Few runs, and slow noise, have wider bounds for a standard deviation. At its end the response is flat, so no error of a delay is in that.
        let last = step.curve.len() - 1;
        let wider = (half_width_at_end(bounds) / (critical * bounds.sd[last])).max(1.0);
        let ratio = |m: usize| {
            let sd = wider * bounds.sd[m] + bounds.rounding_bias / critical;
            Some(sd / step.sd[m]).filter(|ratio| ratio.is_finite())
        };
        let rises = |m: &usize| (0.05..0.95).contains(&(step.curve[*m] / step.curve[last]));
        let in_rise = (0..last).filter(rises).filter_map(ratio);
        [ratio(last).unwrap_or(1.0), in_rise.fold(1.0, f64::max)]
    }

    /// The variance that the end of the step response of `model` has beside that of even noise; `None` in a band, and without bounds.
    pub(crate) fn variance_beside_even_noise(&self, model: &Model) -> Option<f64> {
        let IdentifiedResponse::Step(step) = &self.identified else {
            return None;
        };
        let bounds = model.step.bounds.valid()?;
        let sd = half_width_at_end(bounds) / pointwise_critical(bounds.level);
        Some((sd * sd - step.sd.last()?.powi(2)).max(0.0))
    }

    /// Whether it is of the response in a band.
    pub(super) fn is_of_band(&self) -> bool {
        matches!(self.identified, IdentifiedResponse::Band(_))
    }

    /// What a response `impulse` makes of the whitened estimate.
    pub(super) fn projected(&self, impulse: &[f64]) -> Vec<f64> {
        times(&self.map, impulse)
    }

    /// Differences between the estimate and the projection of a servo with the response `impulse`. They
    /// are independent and of unit variance if that servo is the true one.
    pub(crate) fn residuals(&self, impulse: &[f64]) -> Vec<f64> {
        let projected = self.projected(impulse);
        self.estimate
            .iter()
            .zip(projected)
            .map(|(a, b)| a - b)
            .collect()
    }

    /// Largest difference between the response that was identified and that of such a servo, as a share of the gain.
    pub(crate) fn largest_difference(&self, impulse: &[f64]) -> f64 {
        self.identified.largest_difference(impulse)
    }
}

/// Half the width of the bound at the end of a step response, without the biases in it.
fn half_width_at_end(bounds: &StepBounds) -> f64 {
    let ends = (bounds.pointwise.lower.last()).zip(bounds.pointwise.upper.last());
    let half = ends.map_or(0.0, |(lower, upper)| (upper - lower) / 2.0);
    half - bounds.truncation_bias - bounds.rounding_bias
}

/// The record with a stated history: before the first sample the input stood still, which only responses
/// longer than N depend on. Rows without a history of N samples stay out.
pub(crate) fn with_history<'a>(record: &'a Record, settling: usize) -> Result<Record<'a>, Error> {
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
fn whitening(covariance: &Mat<f64>) -> Option<Mat<f64>> {
    let eigen = symmetric_eigen(covariance)?;
    let size = covariance.nrows();
    let largest = eigen.values.iter().copied().fold(0.0, f64::max);
    let kept: Vec<usize> = (0..size)
        .filter(|&i| eigen.values[i] > ROUNDING * largest)
        .collect();
    (largest > 0.0).then(|| {
        Mat::from_fn(kept.len(), size, |i, k| {
            eigen.vectors[(k, kept[i])] / eigen.values[kept[i]].sqrt()
        })
    })
}
