//! Errors that go together: those of one answer, or of one level.
//!
//! Errors one step ahead that contain an effect γ_c of their cluster c, ε(k) = γ_c w(k) + independent errors, show the variance of γ by
//!
//! ```text
//! v = sum_c [(sum_k w ε)² - sum_k (w ε)²] / sum_c [(sum_k w²)² - sum_k w⁴],     k in cluster c.
//! ```
//!
//! Each bracket is a sum over all pairs of different members of a cluster, whose mean is 0 where errors are independent, be they even or not (a covariance of
//! clusters less that of single errors: Liang and Zeger 1986). Members are rows, or clusters of rows.

use crate::numerics::{chi_square_quantile, normal_upper_quantile};
use crate::thresholds::RESIDUAL_SIGNIFICANCE;

/// Sums over the members of a cluster.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Cluster {
    /// Of w ε.
    pub(super) product: f64,
    /// Of w².
    pub(super) weight: f64,
    squared_products: f64,
    pairs_of_products: f64,
    pairs_of_squared_products: f64,
    pairs_of_weights: f64,
}

impl Cluster {
    /// Adds a member: a row with its w ε and w², or a cluster of rows with the sums of these. Its pairs with those before it are added up as such: a square less the
    /// squares in it is rounding where a cluster has one member, or one that is far larger than the others.
    pub(super) fn add(&mut self, product: f64, weight: f64) {
        let squared = product.powi(2);
        self.pairs_of_products += 2.0 * self.product * product;
        self.pairs_of_squared_products += 2.0 * self.squared_products * squared;
        self.pairs_of_weights += 2.0 * self.weight * weight;
        self.product += product;
        self.weight += weight;
        self.squared_products += squared;
    }

    /// The rows of `weights` w and of errors, where both are there.
    pub(super) fn of_rows(weights: &[f64], errors: &[f64]) -> Self {
        let mut cluster = Self::default();
        for (weight, error) in weights.iter().zip(errors) {
            if !error.is_nan() {
                cluster.add(weight * error, weight * weight);
            }
        }
        cluster
    }
}

/// How effects scatter.
#[derive(Debug, Clone, Copy)]
pub(super) struct EffectScatter {
    /// Variance of an effect.
    pub(super) variance: f64,
    /// Number of equal clusters that would determine as much.
    pub(super) count: f64,
    /// Those that the fit has left.
    left: f64,
}

impl EffectScatter {
    /// Of the effects of `clusters`, of which the fit has taken as many as `fitted`; `None` where they do not scatter beyond chance, or where the
    /// fit has left less than one to show it.
    pub(super) fn of(clusters: &[Cluster], fitted: f64) -> Option<Self> {
        let sum = |of: fn(&Cluster) -> f64| clusters.iter().map(of).sum::<f64>();
        let pairs = sum(|c| c.pairs_of_products);
        let chance = sum(|c| c.pairs_of_squared_products);
        let count = sum(|c| c.weight).powi(2) / sum(|c| c.weight.powi(2));
        let left = count - fitted;
        let beyond_chance =
            pairs > normal_upper_quantile(RESIDUAL_SIGNIFICANCE) * (2.0 * chance).sqrt();
        if !beyond_chance || left < 1.0 {
            return None;
        }
        let own = sum(|c| c.pairs_of_weights);
        Some(Self {
            variance: pairs / own * count / left,
            count,
            left,
        })
    }

    /// Without so much of the variance.
    pub(super) fn without(self, variance: f64) -> Self {
        Self {
            variance: (self.variance - variance).max(0.0),
            ..self
        }
    }

    /// With the variance of a likely `cause`, where that is [larger](larger_of_cause).
    pub(super) fn or_of_cause(self, cause: f64) -> Self {
        Self {
            variance: larger_of_cause(self.variance, self.left, cause),
            ..self
        }
    }

    /// Variance of the estimate of the variance, relative to its square.
    pub(super) fn relative_variance(&self) -> f64 {
        2.0 / self.left
    }
}

/// The variance of a likely `cause`, where it is larger than the one `shown` by so many degrees of freedom and chance may have made that as small.
///
/// A handful of effects shows their variance badly. Bounds by what they show are then wide on average, but not where they show little by chance.
pub(super) fn larger_of_cause(shown: f64, degrees: f64, cause: f64) -> f64 {
    let degrees = degrees.floor();
    let smallest = chi_square_quantile(RESIDUAL_SIGNIFICANCE, degrees as usize) / degrees;
    match shown > smallest * cause {
        true => shown.max(cause),
        false => shown,
    }
}

#[cfg(test)]
mod tests {
    use super::{Cluster, EffectScatter};

    /// A command that changes with each sample has holds of one row each, but for where it stood still at first.
    #[test]
    fn clusters_without_pairs_show_no_scatter() {
        for seed in 1..200_u64 {
            let number = |k: u64| ((k * 7919 + seed * 104_729) % 1009) as f64 / 333.0 - 1.5;
            let still = Cluster::of_rows(&[0.0; 50], &[0.1; 50]);
            let clusters: Vec<Cluster> = (0..500)
                .map(|k| Cluster::of_rows(&[number(3 * k)], &[number(3 * k + 1)]))
                .chain([still])
                .collect();
            assert!(EffectScatter::of(&clusters, 1.0).is_none());
        }
    }
}
