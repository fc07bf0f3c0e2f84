//! Nonlinear least squares for a handful of parameters (Levenberg 1944, Marquardt 1963).

use faer::Mat;

use crate::numerics::{backward_solve, cholesky, dot, forward_solve, inverse_of_square, times};

/// Largest number of steps. A good start needs about ten.
const STEPS: usize = 60;
/// Relative decrease of the sum of squares at which the search ends.
const CONVERGED: f64 = 1e-10;
/// Share of the largest square of a derivative below which a parameter is damped as if it had that: one that has no effect does not stop the search.
const FLAT: f64 = 1e-12;

/// A minimum.
#[derive(Clone)]
pub(crate) struct Minimum {
    pub(crate) parameters: Vec<f64>,
    pub(crate) sum_of_squares: f64,
    pub(crate) residuals: Vec<f64>,
    /// J.
    pub(crate) jacobian: Mat<f64>,
    /// (J'J)^-1.
    pub(crate) covariance: Mat<f64>,
}

/// Where a search ended.
pub(crate) struct Descent {
    pub(crate) parameters: Vec<f64>,
    pub(crate) sum_of_squares: f64,
    residuals: Vec<f64>,
}

/// Goes down |residuals(x)|² from `start` until a step lowers it by less than the share `converged`. Derivatives are central differences with the half steps `increments`.
/// What the residuals do not depend on stays where it is.
pub(crate) fn descend(
    residuals: &dyn Fn(&[f64]) -> Vec<f64>,
    start: &[f64],
    increments: &[f64],
    converged: f64,
) -> Descent {
    let square = |r: &[f64]| dot(r, r);
    let mut x = start.to_vec();
    let mut r = residuals(&x);
    let mut best = square(&r);
    let mut damping = 1e-3;
    for _ in 0..STEPS {
        let jacobian = jacobian(residuals, &x, increments);
        let gradient = times(&jacobian.transpose().to_owned(), &r);
        let normal = jacobian.transpose() * &jacobian;
        let largest = (0..x.len()).map(|k| normal[(k, k)]).fold(0.0, f64::max);
        let before = best;
        // Raise the damping until the step descends. After twelve decades the step is negligible.
        for _ in 0..12 {
            let mut damped = normal.clone();
            for k in 0..x.len() {
                damped[(k, k)] += damping * normal[(k, k)].max(FLAT * largest);
            }
            let Some(lower) = cholesky(&damped) else {
                damping *= 10.0;
                continue;
            };
            let step = backward_solve(&lower, &forward_solve(&lower, &gradient));
            let trial: Vec<f64> = x.iter().zip(&step).map(|(x, s)| x - s).collect();
            let trial_residuals = residuals(&trial);
            let value = square(&trial_residuals);
            if value < best {
                (x, r, best) = (trial, trial_residuals, value);
                damping = (damping / 10.0).max(1e-12);
                break;
            }
            damping *= 10.0;
        }
        if before - best <= converged * before {
            break;
        }
    }
    Descent {
        parameters: x,
        sum_of_squares: best,
        residuals: r,
    }
}

/// Minimises |residuals(x)|² from `start`. `None` when the residuals do not determine the parameters there.
fn minimise(
    residuals: &dyn Fn(&[f64]) -> Vec<f64>,
    start: &[f64],
    increments: &[f64],
) -> Option<Minimum> {
    let found = descend(residuals, start, increments, CONVERGED);
    if !found.sum_of_squares.is_finite() {
        return None;
    }
    let jacobian = jacobian(residuals, &found.parameters, increments);
    let lower = cholesky(&(jacobian.transpose() * &jacobian))?;
    Some(Minimum {
        parameters: found.parameters,
        sum_of_squares: found.sum_of_squares,
        residuals: found.residuals,
        jacobian,
        covariance: inverse_of_square(&lower),
    })
}

/// The lowest of the minima that are reached from `starts`, each with its increments.
pub(crate) fn best_minimum(
    residuals: &dyn Fn(&[f64]) -> Vec<f64>,
    starts: impl Iterator<Item = (Vec<f64>, Vec<f64>)>,
) -> Option<Minimum> {
    starts
        .filter_map(|(start, increments)| minimise(residuals, &start, &increments))
        .min_by(|a, b| a.sum_of_squares.total_cmp(&b.sum_of_squares))
}

fn jacobian(residuals: &dyn Fn(&[f64]) -> Vec<f64>, x: &[f64], increments: &[f64]) -> Mat<f64> {
    let columns: Vec<Vec<f64>> = (0..x.len())
        .map(|k| {
            let at = |side: f64| {
                let mut x = x.to_vec();
                x[k] += side * increments[k];
                residuals(&x)
            };
            at(1.0)
                .iter()
                .zip(at(-1.0))
                .map(|(a, b)| (a - b) / (2.0 * increments[k]))
                .collect()
        })
        .collect();
    Mat::from_fn(columns[0].len(), x.len(), |i, k| columns[k][i])
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_abs_diff_eq;

    #[test]
    fn a_decay_is_found_with_its_covariance() {
        let data: Vec<f64> = (0..20).map(|k| 3.0 * (-0.4 * f64::from(k)).exp()).collect();
        let residuals = |x: &[f64]| -> Vec<f64> {
            (0..20)
                .map(|k| data[k] - x[0] * (-x[1] * k as f64).exp())
                .collect()
        };
        let found = minimise(&residuals, &[1.0, 1.0], &[1e-5, 1e-5]).unwrap();
        assert_abs_diff_eq!(found.parameters[0], 3.0, epsilon = 1e-6);
        assert_abs_diff_eq!(found.parameters[1], 0.4, epsilon = 1e-6);
        // (J'J)^-1 of the exact derivatives.
        let j: Vec<(f64, f64)> = (0..20)
            .map(|k| {
                (
                    (-0.4 * f64::from(k)).exp(),
                    -3.0 * f64::from(k) * (-0.4 * f64::from(k)).exp(),
                )
            })
            .collect();
        let sum = |of: fn(&(f64, f64)) -> f64| j.iter().map(of).sum::<f64>();
        let (aa, ab, bb) = (sum(|j| j.0 * j.0), sum(|j| j.0 * j.1), sum(|j| j.1 * j.1));
        assert_abs_diff_eq!(
            found.covariance[(0, 0)],
            bb / (aa * bb - ab * ab),
            epsilon = 1e-5
        );
    }
}
