//! The bounds of the servo's mean, from three runs on.
//!
//! From run to run a servo changes, with its supply, its temperature and the phase of its clock. The model of R runs has the mean. The error of run
//! r on what [gain, delay, spring, damping and speed](crate::diagnostics::runs::changed_servo) change, b_j, is q_rj; these are made independent of each other under the noise,
//! and what the noise of R runs determines together is one. So a run moves the mean by d_r = sum_j b_j q_rj, and the covariance of its response
//! is that of the noise and
//!
//! ```text
//! R/(R-1) sum_r d_r d_rᵀ + m_t b bᵀ,    b_k = (x_{k-1} - 2 x_k + x_{k+1})/2
//! ```
//!
//! at R - 1 degrees of freedom. The slope of the model is itself that of a response which came too late or too early, and at a kink another one
//! holds a sample later: b, with m_t the variance of the mean of R delays, is half the difference of the slopes before and after a sample.
//!
//! Where the d_r of few runs happen to be small, as at a time at which what they differ by passes zero, a bound counts the quantities one by
//! one, sum_j b_j b_jᵀ sum_r q_rj²: what is not linear in them is of that size there, and a curve as a whole is off along each.
//!
//! No test decides whether they scatter: one that finds nothing in strong noise leaves a scatter as large as the noise
//! out. Nor is the noise subtracted: Student's t holds for the whole mean square of a few runs, and not for what is left
//! of it. The price is that noise along the b_j counts twice. It is why there are five of them only: along all that a response may be, three runs
//! would widen the bounds of noise fourfold. Two runs show that they differ, but not by how much runs do.

use faer::Mat;

use super::changed_servo::{CHANGES, changes};
use super::delayed_response::slope_and_bend;
use super::run_equations::RunEquations;
use super::run_scatter::RunComparison;
use crate::data::Run;
use crate::estimation::{GlsFit, RunSpread};
use crate::numerics::{causal_filter, dot};
use crate::results::Model;
use crate::thresholds::RUNS_FOR_MEAN;

/// Adds to the covariance of `fit`, which is that of `model`, how `runs` differ; whether they are enough to say.
pub(crate) fn allow_for_scatter(
    model: &Model,
    runs: &[Run<'_>],
    compared: &RunComparison,
    fit: &mut GlsFit,
) -> bool {
    fit.further.runs = spread(model, runs, compared, fit);
    fit.further.runs.is_some()
}

fn spread(
    model: &Model,
    runs: &[Run<'_>],
    compared: &RunComparison,
    fit: &GlsFit,
) -> Option<RunSpread> {
    let delay_s = compared.variance_of_mean(|run| run.delay_s)?.sqrt();
    let changes = changes(fit);
    let equations: Vec<RunEquations> = (runs.iter())
        .filter_map(|run| equations(model, run, fit, &changes))
        .collect();
    if equations.len() < RUNS_FOR_MEAN {
        return None;
    }
    let total = equations
        .iter()
        .fold(Mat::zeros(CHANGES, CHANGES), |sum, run| sum + &run.normal);
    let independent = orthonormal(&total);
    let moved = moved_means(&equations, &independent)?;
    // What runs differ by moves no offset.
    let changes = Mat::from_fn(changes[0].len() + 1, CHANGES, |i, j| {
        changes[j].get(i).copied().unwrap_or(0.0)
    });
    let along = changes * independent;
    let quantity = |j: usize| moved.row(j).norm_l2();
    let [_, bend] = slope_and_bend(fit);
    let late = delay_s / model.sample_period_s;
    let with_bend = |each: &Mat<f64>| {
        let count = each.ncols();
        Mat::from_fn(each.nrows(), count + 1, |i, k| match k < count {
            true => each[(i, k)] / fit.variance.sqrt(),
            false => bend.get(i).map_or(0.0, |b| late * b / fit.variance.sqrt()),
        })
    };
    Some(RunSpread {
        directions: with_bend(&(&along * &moved)),
        quantities: with_bend(&Mat::from_fn(along.nrows(), along.ncols(), |i, j| {
            along[(i, j)] * quantity(j)
        })),
        degrees: (equations.len() - 1) as f64,
    })
}

/// Of a run's errors on the changes of its output.
fn equations(
    model: &Model,
    run: &Run,
    fit: &GlsFit,
    changes: &[Vec<f64>; CHANGES],
) -> Option<RunEquations> {
    let columns = changes.each_ref().map(|change| {
        let impulse = fit.coordinates.impulse(change);
        causal_filter(&impulse, run.input(), run.input_at_rest())
    });
    let found = RunEquations::of(&model.noise.ar, run, &model.simulate(run), &columns)?;
    Some(found.without_constant())
}

/// The share of itself that a change must have beside the ones before: of a servo without dynamics, all but the delay are the gain.
const OF_ITS_OWN: f64 = 1e-6;

/// Combinations of the changes, one in each column, that are independent and of unit length by these products (Gram and Schmidt).
fn orthonormal(products: &Mat<f64>) -> Mat<f64> {
    let size = products.nrows();
    let times = |x: &[f64]| -> Vec<f64> {
        (0..size)
            .map(|i| dot(products.col_as_slice(i), x))
            .collect()
    };
    let mut kept: Vec<Vec<f64>> = Vec::new();
    for j in 0..size {
        let mut own: Vec<f64> = (0..size).map(|i| f64::from(u8::from(i == j))).collect();
        for earlier in &kept {
            let share = dot(&times(&own), earlier);
            own.iter_mut()
                .zip(earlier)
                .for_each(|(x, e)| *x -= share * e);
        }
        let square = dot(&times(&own), &own);
        if square > OF_ITS_OWN * products[(j, j)] {
            kept.push(own.iter().map(|x| x / square.sqrt()).collect());
        }
    }
    Mat::from_fn(size, kept.len(), |i, k| kept[k][i])
}

/// By how much each run, in a column, moves the mean of each quantity; with a factor that makes their squares the variance of the mean. `None`
/// where a single run determines a quantity.
fn moved_means(equations: &[RunEquations], independent: &Mat<f64>) -> Option<Mat<f64>> {
    let quantities = independent.ncols();
    let weights: Vec<Mat<f64>> = (equations.iter())
        .map(|run| independent.transpose() * (&run.normal * independent))
        .collect();
    let mut moved = Mat::from_fn(quantities, equations.len(), |j, r| {
        dot(independent.col_as_slice(j), &equations[r].right)
    });
    // Rows with gaps, and offsets of runs, leave the model a little beside their mean.
    let mean: Vec<f64> = (0..quantities).map(|j| moved.row(j).sum()).collect();
    for (r, weight) in weights.iter().enumerate() {
        for j in 0..quantities {
            moved[(j, r)] -= dot(weight.col_as_slice(j), &mean);
        }
    }
    for j in 0..quantities {
        // Of equal runs R/(R-1). One that says next to nothing of a quantity is none.
        let shares: f64 = weights.iter().map(|weight| weight[(j, j)].powi(2)).sum();
        let factor = (1.0 - shares).recip().sqrt();
        for r in 0..equations.len() {
            moved[(j, r)] *= factor;
        }
    }
    moved.is_all_finite().then_some(moved)
}
