//! A prior of impulse responses that die out and are smooth, found from the data (empirical Bayes).
//!
//! The estimate of the complete bank, h with covariance V, is free: N numbers without any relation to each other. Every
//! servo's response dies out, and its neighbours resemble each other: h ~ N(0, K). The numbers of K maximise the marginal
//! likelihood of the free estimate, h ~ N(0, K + V), and the response is
//!
//! ```text
//! E = K (K + V)^-1 h,   covariance K - K (K + V)^-1 K = K (K + V)^-1 V
//! ```
//!
//! which is the least-squares estimate with the prior as a further row for each lag. The offset has no prior. K is the sum of a fast
//! kernel and a slow one: with a single one, a servo that creeps at the end has bands that miss it. A slow end of a few percent is
//! [expected](slow_kernel) before the data.
//!
//! Sources: T. Chen, H. Ohlsson and L. Ljung, Automatica 2012; G. Pillonetto, F. Dinuzzo, T. Chen, G. De Nicolao and L. Ljung,
//! Automatica 2014.

mod bfgs;
mod contradiction;
mod evidence;
mod kernel;
mod objective;
mod slow_kernel;
mod uncertain;

use faer::Mat;

use crate::estimation::GlsFit;
use crate::numerics::{dot, inverse_of_lower};
use bfgs::descend;
use contradiction::contradiction;
use evidence::{Free, kernels_of};
use kernel::Kernel;
use objective::{Evaluated, Objective};
use slow_kernel::SlowEndPrior;

/// Time constants from which the search sets out, as shares of N.
const DECAYS: [f64; 3] = [0.04, 0.1, 0.25];
/// How much longer neighbours resemble each other than the response lasts, at the start.
const LENGTH: f64 = 2.0;

/// A fit under the prior.
pub(crate) struct Regularised {
    /// Coordinates and offset.
    coordinates: Vec<f64>,
    /// Covariance of both, over the variance of ε.
    covariance: Mat<f64>,
    /// The kernels, fast and slow.
    kernels: Vec<Kernel>,
    /// The largest difference of the step responses with and without prior, in standard deviations.
    pub(crate) contradiction: f64,
}

impl Regularised {
    /// Of a fit to a complete bank. `None` where the prior's numbers cannot be found.
    pub(crate) fn of(fit: &GlsFit) -> Option<Self> {
        let size = fit.coordinates.len();
        let all = fit.noise_covariance();
        let covariance = all.as_ref().submatrix(0, 0, size, size).to_owned();
        let sd = fit.variance.sqrt();
        let response: Vec<f64> = fit.solution.response().iter().map(|h| h / sd).collect();
        let free = Free {
            response: &response,
            covariance: &covariance,
        };
        let (objective, numbers, lowest) = found_numbers(free)?;
        let marginal = lowest.marginal;
        let whiten = inverse_of_lower(&marginal.factor);
        let of_prior = &whiten * marginal.prior();
        let of_noise = &whiten * all.as_ref().submatrix(0, 0, size, size + 1);
        let mut posterior = posterior(&of_prior, &of_noise, all[(size, size)]);
        let directions = uncertain::directions(&objective, &numbers)?;
        let of_numbers = &directions * directions.transpose();
        for j in 0..size {
            for i in 0..size {
                posterior[(i, j)] += of_numbers[(i, j)];
            }
        }
        let mean = marginal.mean();
        let offset = dot(of_noise.col_as_slice(size), &marginal.whitened);
        let mut coordinates: Vec<f64> = mean.iter().map(|h| sd * h).collect();
        coordinates.push(fit.solution.offset() - sd * offset);
        Some(Self {
            contradiction: contradiction(&response, &mean, &of_noise),
            coordinates,
            covariance: posterior,
            kernels: kernels_of(&numbers),
        })
    }

    /// Time constants of the two kernels, the shorter first \[samples\].
    pub(crate) fn time_constants(&self) -> Vec<f64> {
        let mut all: Vec<f64> = self.kernels.iter().map(Kernel::time_constant).collect();
        all.sort_by(f64::total_cmp);
        all
    }

    /// The fit becomes that under the prior.
    pub(crate) fn carry_into(self, fit: &mut GlsFit) {
        fit.solution.coordinates = self.coordinates;
        fit.solution.inverse = self.covariance;
        fit.further.noise = None;
        fit.further.estimated.clear();
    }
}

/// K S^-1 V bordered by the offset, with L^-1 K in `of_prior` and L^-1 V, the offset's column last, in `of_noise`, S = L L'. The
/// variance of the offset is `offset` less what the response explains of it.
fn posterior(of_prior: &Mat<f64>, of_noise: &Mat<f64>, offset: f64) -> Mat<f64> {
    let size = of_prior.ncols();
    let block = of_prior.transpose() * of_noise;
    let last = of_noise.col_as_slice(size);
    Mat::from_fn(size + 1, size + 1, |i, j| match (i, j) {
        (i, j) if i < size && j < size => (block[(i, j)] + block[(j, i)]) / 2.0,
        (i, j) if i < size || j < size => block[(i.min(j), size)],
        _ => offset - dot(last, last),
    })
}

/// The objective, the numbers of the two kernels that minimise it, and what it is there.
fn found_numbers(free: Free<'_>) -> Option<(Objective<'_>, Vec<f64>, Evaluated)> {
    let mut objective = Objective {
        free,
        slow_end: None,
    };
    let starts = DECAYS.iter().map(|share| start(&objective.free, *share));
    let starts = starts.map(|kernel| (objective.of_one(&kernel), kernel));
    let (_, first) = starts.min_by(|a, b| a.0.total_cmp(&b.0))?;
    let (single, lowest) = descend(|numbers| objective.of_response(numbers), &first.numbers())?;
    let slow_end = SlowEndPrior {
        gain: lowest.marginal.mean().iter().sum(),
    };
    let fast = Kernel::of(&single);
    let both = [fast.numbers(), slow_end.expected(&fast).numbers()].concat();
    objective.slow_end = Some(slow_end);
    let (both, lowest) = descend(|numbers| objective.of_response(numbers), &both)?;
    Some((objective, both, lowest))
}

/// A kernel of this time constant, as large as the response.
fn start(free: &Free<'_>, share: f64) -> Kernel {
    let samples = free.response.len() as f64;
    let decay = share * samples;
    // The sum of the variances, decay c, is that of the squares of the response.
    let size = dot(free.response, free.response) / decay;
    Kernel {
        log_size: size.max(f64::MIN_POSITIVE).ln(),
        log_decay: decay.ln(),
        log_length: (LENGTH * decay).ln(),
    }
}

#[cfg(test)]
mod tests;
