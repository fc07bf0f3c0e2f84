//! Interpolation at Chebyshev's points, for smooth functions that are expensive to evaluate.
//!
//! The points of the first kind x_k = cos((2k+1)π/2n), stretched to an interval, and the barycentric
//! form of the interpolant (Berrut & Trefethen, SIAM Review 2004, eqs (4.2) and (5.3)), which costs a division for
//! each node:
//!
//! ```text
//! p(x) = Σ_k [w_k / (x - x_k)] f(x_k) / Σ_k [w_k / (x - x_k)],   w_k = (-1)^k sin((2k+1)π/2n)
//! ```

use std::f64::consts::PI;

/// N interpolation nodes on an interval.
pub(crate) struct Chebyshev<const N: usize> {
    nodes: [f64; N],
    barycentric: [f64; N],
}

impl<const N: usize> Chebyshev<N> {
    /// From `low` to `high`.
    pub(crate) fn new(low: f64, high: f64) -> Self {
        let angle = |k: usize| PI * (k as f64 + 0.5) / N as f64;
        let sign = |k: usize| if k.is_multiple_of(2) { 1.0 } else { -1.0 };
        Self {
            nodes: std::array::from_fn(|k| low + (high - low) / 2.0 * (1.0 - angle(k).cos())),
            barycentric: std::array::from_fn(|k| sign(k) * angle(k).sin()),
        }
    }

    /// The nodes, ascending.
    pub(crate) fn nodes(&self) -> &[f64; N] {
        &self.nodes
    }

    /// The interpolant at `x` is the sum of the function's values at the nodes, with these weights.
    pub(crate) fn weights_at(&self, x: f64) -> [f64; N] {
        if let Some(hit) = self.nodes.iter().position(|node| *node == x) {
            return std::array::from_fn(|k| f64::from(u8::from(k == hit)));
        }
        let mut weights: [f64; N] =
            std::array::from_fn(|k| self.barycentric[k] / (x - self.nodes[k]));
        let scale = 1.0 / weights.iter().sum::<f64>();
        weights.iter_mut().for_each(|weight| *weight *= scale);
        weights
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_abs_diff_eq;

    #[test]
    fn polynomials_below_the_number_of_nodes_are_reproduced() {
        let chebyshev = Chebyshev::<6>::new(-0.3, 2.0);
        let f = |x: f64| 1.0 - x + 0.2 * x.powi(3) - 0.1 * x.powi(5);
        for k in 0..=100 {
            let x = -0.3 + 2.3 * f64::from(k) / 100.0;
            let weights = chebyshev.weights_at(x);
            let found: f64 = weights
                .iter()
                .zip(chebyshev.nodes())
                .map(|(w, x)| w * f(*x))
                .sum();
            // Values of order one.
            assert_abs_diff_eq!(found, f(x), epsilon = 1e-13);
        }
        for (k, node) in chebyshev.nodes().iter().enumerate() {
            assert_eq!(chebyshev.weights_at(*node)[k], 1.0);
        }
    }
}
