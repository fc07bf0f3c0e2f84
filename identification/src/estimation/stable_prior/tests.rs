//! The fit under the prior against the slow way.

use super::bfgs::Point;
use super::evidence::{Free, Marginal};
use super::*;
use crate::numerics::{cholesky, inverse_of_square, mirror, times};
use approx::assert_relative_eq;

const SAMPLES: usize = 24;

fn covariance() -> Mat<f64> {
    Mat::from_fn(SAMPLES, SAMPLES, |i, j| {
        0.02 * 0.6f64.powi(i.abs_diff(j) as i32)
    })
}

fn response() -> Vec<f64> {
    (0..SAMPLES)
        .map(|k| (-(k as f64) / 5.0).exp() + 0.1 * (1.7 * k as f64).sin())
        .collect()
}

fn kernels() -> [Kernel; 2] {
    [[-1.0, 1.2, 2.0], [-4.0, 2.5, 3.0]].map(|numbers: [f64; 3]| Kernel::of(&numbers))
}

#[test]
fn the_kernel_is_its_formula() {
    let kernel = Kernel::of(&[0.3f64.ln(), 5f64.ln(), 8f64.ln()]);
    let mut found = Mat::<f64>::zeros(6, 6);
    kernel.entries(6).add_below(&mut found);
    mirror(&mut found);
    let (decay, likeness) = ((-1.0f64 / 5.0).exp(), (-1.0f64 / 8.0).exp());
    for (i, j) in [(0usize, 0usize), (2, 5), (5, 1)] {
        let (a, b) = (i as f64 + 1.0, j as f64 + 1.0);
        let expected = 0.3 * decay.powf((a + b) / 2.0) * likeness.powf((a - b).abs());
        assert_relative_eq!(found[(i, j)], expected, max_relative = 1e-12);
    }
}

#[test]
fn the_gradient_is_the_quotient_of_differences() {
    let (covariance, response) = (covariance(), response());
    let free = Free {
        response: &response,
        covariance: &covariance,
    };
    let numbers: Vec<f64> = kernels().iter().flat_map(Kernel::numbers).collect();
    let objective = Objective {
        free,
        slow_end: Some(SlowEndPrior { gain: 3.0 }),
    };
    let value = |numbers: &[f64]| objective.of_response(numbers).unwrap().value();
    let found = objective.of_response(&numbers).unwrap().gradient();
    for k in 0..numbers.len() {
        let at = |side: f64| {
            let mut moved = numbers.clone();
            moved[k] += side;
            value(&moved)
        };
        // Central differences with a step of 1e-5 are good to 1e-9 of the third derivative.
        let expected = (at(1e-5) - at(-1e-5)) / 2e-5;
        assert_relative_eq!(found[k], expected, max_relative = 1e-5, epsilon = 1e-6);
    }
}

/// As a row of the regression for each lag: (V^-1 + K^-1)^-1 V^-1 h, and its covariance.
#[test]
fn the_fit_is_that_of_least_squares_with_the_prior_as_rows() {
    let (covariance, response) = (covariance(), response());
    let free = Free {
        response: &response,
        covariance: &covariance,
    };
    let marginal = Marginal::of(&free, &kernels()).unwrap();
    let inverse = |matrix: &Mat<f64>| inverse_of_square(&cholesky(matrix).unwrap());
    let prior = marginal.prior();
    let expected = inverse(&(inverse(&covariance) + inverse(&prior)));
    let whiten = inverse_of_lower(&marginal.factor);
    // An offset that has nothing to do with the response, of variance 3.
    let bordered = Mat::from_fn(SAMPLES, SAMPLES + 1, |i, j| match j < SAMPLES {
        true => covariance[(i, j)],
        false => 0.0,
    });
    let found = posterior(&(&whiten * &prior), &(&whiten * &bordered), 3.0);
    assert_eq!(found[(SAMPLES, SAMPLES)], 3.0);
    let weighted = times(&inverse(&covariance), &response);
    let mean = times(&expected, &weighted);
    // K^-1 has a condition of some 1e5.
    for i in 0..SAMPLES {
        assert_relative_eq!(marginal.mean()[i], mean[i], epsilon = 1e-9);
        for j in 0..SAMPLES {
            assert_relative_eq!(found[(i, j)], expected[(i, j)], epsilon = 1e-9);
        }
    }
}
