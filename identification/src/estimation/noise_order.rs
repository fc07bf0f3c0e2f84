//! The order of the noise model, by Bayes' information criterion.

use super::noise_model::NoiseFit;
use faer::Mat;
use serde::{Deserialize, Serialize};

/// One order of the noise model with its criterion.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct OrderCandidate {
    /// d.
    pub order: usize,
    /// rows ln(RSS/rows) + d ln(rows): the smallest is chosen.
    pub bic: f64,
}

impl NoiseFit {
    /// Bayes' information criterion for orders 0..=max.
    pub(crate) fn candidates(&self, rows: usize) -> Vec<OrderCandidate> {
        let rows = rows as f64;
        (0..=self.highest_order())
            .map(|order| OrderCandidate {
                order,
                bic: rows * (self.rss(order).max(f64::MIN_POSITIVE) / rows).ln()
                    + order as f64 * rows.ln(),
            })
            .collect()
    }
}

/// The candidate with the smallest criterion.
pub(crate) fn best_order(candidates: &[OrderCandidate]) -> usize {
    candidates
        .iter()
        .min_by(|a, b| a.bic.total_cmp(&b.bic))
        .map_or(0, |candidate| candidate.order)
}

/// An autoregressive model of `count` samples of noise, from the sums of their products at the lags 0, 1, ..: its d_1..d_d, by
/// Bayes' criterion, and the standard deviation of the white noise behind it. Without noise, or with rounding alone, it is white.
pub(crate) fn autoregressive(products: &[f64], count: usize) -> (Vec<f64>, f64) {
    let moments = Mat::from_fn(products.len(), products.len(), |i, j| {
        products[i.abs_diff(j)]
    });
    let ar = NoiseFit::new(&moments, 0.0).map_or(Vec::new(), |fit| {
        fit.coefficients(best_order(&fit.candidates(count)))
    });
    let explained = ar.iter().zip(&products[1..]).map(|(d, r)| d * r);
    let left = products[0] + explained.sum::<f64>();
    (ar, (left / count.max(1) as f64).max(0.0).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exponentially_correlated_noise_is_of_first_order() {
        let moments = Mat::from_fn(4, 4, |i, j| 0.8f64.powi((i as i32 - j as i32).abs()) * 50.0);
        let fit = NoiseFit::new(&moments, 1.0).unwrap();
        assert_eq!(best_order(&fit.candidates(1000)), 1);
    }
}
